//! Cases of sensing: what the board measures of the skin in its world, how fast, and what it says when
//! something breaks.

mod faults;
mod presses;
mod reflex;
mod session;
mod sheets;
mod soak;
mod speed;
mod traced;
mod trim;

pub use soak::{Soaked, soak};

use super::{Case, Failure, ensure, next_with};
use crate::{
    chip::{time::Time, trace::Event as TraceEvent},
    machine::Machine,
    rig::{Capability, Rig},
    world::readings::FULL_DRIVE_CODES,
};
use dermatome::link::{Link, Subscription};
use dermatome_shared::{
    drive::Drive,
    protocol::{Request, Selection},
    scan::{multiplexer_word, test_step},
};
use num_complex::Complex64;
use session::{Session, front_end, stamps, tare};

/// What every frame says about the board and its skin.
const HEALTH: Selection =
    Selection { images: 0, contacts: 0, measurements: 0, health: 1, scope: 0, scope_slot: 0 };
/// Resistance of a contact of the rig's skin, ohm: 0.18 ohm m over 11 mm.
const CONTACT: f64 = 16.4;

/// What every case of sensing needs.
const NEEDS: &[Capability] = &[Capability::VirtualTime];

pub(super) const CASES: &[Case] = &[
    Case {
        name: "a press held for ten minutes of drift is still reported, with its force",
        needs: NEEDS,
        run: presses::long,
    },
    Case { name: "demodulated voltages are those of the circuit", needs: NEEDS, run: voltages },
    Case {
        name: "a board of other parts is trimmed, and keeps its trim",
        needs: NEEDS,
        run: trim::drawn_board,
    },
    Case { name: "contact impedances are those of the circuit", needs: NEEDS, run: contact_impedances },
    Case { name: "signal to noise of the board's own chain", needs: NEEDS, run: signal_to_noise },
    Case { name: "sheets of 10 ohm to 100 kohm per square keep 60 dB", needs: NEEDS, run: sheets::all },
    Case {
        name: "the current starts, changes and stops without a jump and without DC",
        needs: NEEDS,
        run: current,
    },
    Case {
        name: "208 measurements at 50 kHz make 150 images a second",
        needs: NEEDS,
        run: speed::measured_twice,
    },
    Case {
        name: "104 measurements at 100 kHz make 400 images a second",
        needs: NEEDS,
        run: speed::measured_once,
    },
    Case { name: "the same with contacts found in the voltages", needs: NEEDS, run: speed::in_voltages },
    Case {
        name: "flash, static memory and stack stay within their limits",
        needs: NEEDS,
        run: speed::memory,
    },
    Case {
        name: "every broken electrode, line, converter and source is flagged within two frames",
        needs: NEEDS,
        run: faults::all,
    },
    Case {
        name: "where the DMA comes too late, the scan begins anew and a frame says so",
        needs: NEEDS,
        run: faults::late,
    },
    Case {
        name: "the current flows for a host that reads, and no longer than 30 s for one that has gone",
        needs: NEEDS,
        run: host_gone,
    },
    Case {
        name: "a press lets its pin fall within a millisecond of the scan's end, with no host, and so does what blinds",
        needs: NEEDS,
        run: reflex::falls_in_time,
    },
    Case { name: "a press is found where it is", needs: NEEDS, run: presses::in_image },
    Case {
        name: "a fingertip is found in the voltages, as the host finds it",
        needs: NEEDS,
        run: presses::in_voltages,
    },
];

/// Compares what the board makes of a quiet skin with the circuit solved at the carrier's frequency.
fn voltages(rig: &Rig) -> Result<String, Failure> {
    /// s.
    const SETTLING: f64 = 10e-6;
    /// Largest voltage that the converter takes at gain 1, V between electrodes.
    const FULL_SCALE: f64 = 1.65 / 19.93;
    let mut lines = Vec::new();
    for frequency in [12.5e3, 20e3, 50e3, 100e3, 200e3] {
        let (session, mut link) = Session::open(rig, |skin| {
            skin.drive.frequency = frequency;
            skin.drive.settling = SETTLING * frequency;
        })?;
        session.world.noise(0.0);
        tare(&mut link, 2)?;
        let current = f64::from(front_end(&mut link)?.1.amplitude);
        let measured = session::voltages(&mut link, 1)?.remove(0);
        let truth = |word| session.world.truth(word) * current;
        let words = session.patch().steps().map(multiplexer_word);
        let errors: Vec<Complex64> =
            words.zip(&measured).map(|(word, [re, im])| Complex64::new(*re, *im) - truth(word)).collect();
        let worst = |part: fn(&Complex64) -> f64| errors.iter().map(part).fold(0.0, f64::max) / FULL_SCALE;
        let [real, imaginary] = [worst(|error| error.re.abs()), worst(|error| error.im.abs())];
        lines.push(format!("{} kHz {:.3} % ({:.3} %)", frequency / 1e3, 100.0 * real, 100.0 * imaginary));
        ensure(real <= 1e-3, || format!("off by {:.3} % of full scale at {frequency} Hz", 100.0 * real))?;
    }
    Ok(format!("worst channel in phase (in quadrature), of the converter's range: {}", lines.join(", ")))
}

/// Compares contact impedances with those of the circuit, and with the contacts' own, which leads and the sheet's
/// model keep apart.
fn contact_impedances(rig: &Rig) -> Result<String, Failure> {
    let mut lines = Vec::new();
    for frequency in [12.5e3, 50e3, 100e3] {
        let (session, mut link) = Session::open(rig, |skin| {
            skin.drive.frequency = frequency;
            // At 1 mA the amplifier clips the tests.
            skin.drive.amplitude = 0.25e-3;
        })?;
        session.world.noise(0.0);
        tare(&mut link, 2)?;
        let mut stream = link.subscribe(HEALTH)?;
        let (_, report) = next_with(&mut stream, |frame| frame.health)?;
        let header = session.patch().header;
        let (mut of_circuit, mut of_contact) = (0.0_f64, 0.0_f64);
        for (electrode, (&ohms, &sheet)) in
            report.health.contact_impedance.iter().zip(&header.test_resistances).enumerate()
        {
            let word = multiplexer_word(test_step(electrode as u8, header.electrodes));
            let truth = session.world.truth(word);
            let expected = truth.norm_sqr() / truth.re - f64::from(sheet);
            of_circuit = of_circuit.max((f64::from(ohms) - expected).abs());
            of_contact = of_contact.max((f64::from(ohms) - CONTACT).abs());
        }
        ensure(of_circuit < 0.5, || format!("off by {of_circuit:.2} ohm at {frequency} Hz"))?;
        ensure(of_contact < 6.0, || format!("{of_contact:.2} ohm from {CONTACT} at {frequency} Hz"))?;
        lines.push(format!("{} kHz {of_circuit:.2} ({of_contact:.1}) ohm", frequency / 1e3));
    }
    Ok(format!("off by at most (from the contacts' own {CONTACT}): {}", lines.join(", ")))
}

/// Of 208 measurements at 50 kHz.
fn signal_to_noise(rig: &Rig) -> Result<String, Failure> {
    let (_, mut link) = Session::open(rig, |skin| skin.drive.frame_rate = 1000.0)?;
    tare(&mut link, 2)?;
    let frames = session::voltages(&mut link, 100)?;
    let ratios = session::signal_to_noise(&frames);
    let (worst, median) = (ratios[0], ratios[ratios.len() / 2]);
    ensure(median >= 64.0, || format!("median {median:.1} dB, worst channel {worst:.1} dB"))?;
    Ok(format!("median {median:.1} dB, worst channel {worst:.1} dB of {} (50 kHz, one period)", ratios.len()))
}

/// Most DC, of the crest.
const MOST_DC: f64 = 2e-3;

/// After this a board listens, whose source has not settled yet.
const BOOT_TIME: Time = Time::from_millis(80);
/// Most current, of the range's full one, that flows as the switches close.
const MOST_AT_FIRST: f64 = 0.05;

/// Mean of the code, less the middle, over the crest: from its integral over time.
fn dc(area: f64, time: f64) -> f64 {
    (area / time / FULL_DRIVE_CODES).abs()
}

/// Watches every code of the DAC through starts, changes and a stop.
fn current(rig: &Rig) -> Result<String, Failure> {
    let (session, mut link) = Session::open(rig, |_| ())?;
    let mut stream = link.subscribe(HEALTH)?;
    let usual = front_end(stream.link())?.1;
    next_with(&mut stream, |frame| frame.health)?;
    let first = session.world.take_drive_record();
    ensure(dc(first.area, first.time) <= MOST_DC, || {
        format!("{first:?} from switching on to the first scan")
    })?;
    let (jump, dc, rest) = worst_of_changes(&session, &mut stream, usual)?;
    ensure(jump <= 1.0, || format!("a step is {jump:.2} times what a cosine and a rise do"))?;
    ensure(dc <= MOST_DC, || format!("{:.3} % of the crest is DC", 100.0 * dc))?;
    stream.stop()?;
    // A tare that the last drive began ends by itself.
    ensure_off(&session, 2000, "while nothing is asked for")?;
    for (accident, happen) in
        [("a fault", Machine::inject_fault as fn(&mut Machine)), ("a hang", Machine::hang)]
    {
        let mut stream = link.subscribe(HEALTH)?;
        next_with(&mut stream, |frame| frame.health)?;
        session.board.with(happen);
        // The watchdog takes two seconds at most. Nobody tells the board to stop before.
        ensure_off(&session, 2500, &format!("after {accident}"))?;
        drop(stream);
        link = session.reconnect()?;
    }
    let start = first_current(&session)?;
    let rest = rest.max(start);
    ensure(rest <= MOST_AT_FIRST, || format!("{:.1} % of full current as the switches close", 100.0 * rest))?;
    Ok(format!(
        "largest step {jump:.2} of a cosine's, DC {:.3} % of the crest, at most {:.1} % of full current as the switches \
         close, off when idle, after a fault and after a hang",
        100.0 * dc,
        100.0 * rest
    ))
}

/// A host asks for frames as soon as the board has power and hears it: what the source has left of the DAC's start as the switches close,
/// of its full current.
fn first_current(session: &Session) -> Result<f64, Failure> {
    session.board.with(Machine::cut_power)?;
    session.run(BOOT_TIME)?;
    session.world.take_drive_record();
    let mut link = session.reconnect()?;
    let mut stream = link.subscribe(HEALTH)?;
    next_with(&mut stream, |frame| frame.health)?;
    Ok(session.world.take_drive_record().first_current)
}

/// Drives the skin in other ways one after the other, in both ranges. The largest change of the code from word to word,
/// over what a cosine and a rise do, the largest mean over the crest, and the largest current as the switches close.
fn worst_of_changes(
    session: &Session,
    stream: &mut Subscription<'_>,
    usual: Drive,
) -> Result<(f64, f64, f64), Failure> {
    let mut worst = (0.0_f64, 0.0_f64, 0.0_f64);
    let mut before = f64::INFINITY;
    for (frequency, amplitude) in
        [(12.5e3, 1e-3), (200e3, 2e-5), (20e3, 1e-4), (50e3, 2.5e-5), (50e3, 1e-3), (100e3, 0.9e-3)]
    {
        let drive = Drive { frequency, amplitude, ..usual };
        stream.link().request(&Request::Drive(Some(drive)))?;
        for _ in 0..2 {
            next_with(stream, |frame| frame.health)?;
        }
        let record = session.world.take_drive_record();
        ensure(record.enabled, || "the multiplexers are not enabled in a scan".to_owned())?;
        let is_small = session.world.conditions().in_small_range;
        ensure(is_small == (amplitude < 29e-6), || format!("the wrong range for {amplitude} A"))?;
        ensure(!record.ranged_while_enabled, || {
            "the range changes while the multiplexers are on".to_owned()
        })?;
        let words = 1e6 / f64::from(frequency);
        // Both this drive and the one before have put out codes: what the faster cosine does from word to word,
        // and one step of a rise.
        let cosine = 2.0 * FULL_DRIVE_CODES * (std::f64::consts::PI / words.min(before)).sin();
        before = words;
        let jump = f64::from(record.largest_step) / (cosine + FULL_DRIVE_CODES / 8.0);
        worst =
            (worst.0.max(jump), worst.1.max(dc(record.area, record.time)), worst.2.max(record.first_current));
    }
    Ok(worst)
}

/// After so many milliseconds, the DAC's code stays and the multiplexers are disabled.
fn ensure_off(session: &Session, millis: u64, when: &str) -> Result<(), Failure> {
    session.run(Time::from_millis(millis))?;
    session.world.take_drive_record();
    session.run(Time::from_millis(100))?;
    let record = session.world.take_drive_record();
    ensure(record.changes == 0 && !record.enabled, || format!("{record:?} {when}"))
}

/// A host reads for 45 s of the board's time, and then goes without a word.
fn host_gone(rig: &Rig) -> Result<String, Failure> {
    const FRAME_RATE: f64 = 2.0;
    let (session, mut link) = Session::open(rig, |skin| skin.drive.frame_rate = FRAME_RATE)?;
    tare(&mut link, 2)?;
    let streaming = |link: &mut Link| Ok::<bool, Failure>(link.info()?.streaming.any());
    let mut stream = link.subscribe(Selection { contacts: 1, ..Selection::default() })?;
    stamps(&mut stream, (45.0 * FRAME_RATE) as usize)?;
    ensure(streaming(stream.link())?, || "the stream ended while the host read".to_owned())?;
    std::mem::forget(stream);
    let scanned = |seconds: u64| -> Result<bool, Failure> {
        session.board.with(|machine| machine.chip(|chip| drop(chip.trace.take())));
        session.run(Time::from_millis(1000 * seconds))?;
        let events = session.board.with(|machine| machine.chip(|chip| chip.trace.take()));
        Ok(events.iter().any(|(_, event)| matches!(event, TraceEvent::Pins { port: 'B', .. })))
    };
    session.run(Time::from_millis(19_000))?;
    ensure(scanned(2)?, || "the current stopped within 19 s".to_owned())?;
    session.run(Time::from_millis(11_000))?;
    ensure(!scanned(5)?, || "the multiplexers still switch after 32 s".to_owned())?;
    ensure(!streaming(&mut link)?, || "the board says that it streams".to_owned())?;
    Ok(String::new())
}
