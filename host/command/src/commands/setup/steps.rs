//! Steps: what is looked at, one after the other.

use super::{
    SmallestPress, State, Step,
    bench::{Bench, Built},
    order, presses,
};
use crate::commands::{
    board::advised,
    check::{examine, print_electrodes},
    check_skin::Model as Untouched,
    drive, interrupt, patch_id,
    tare::tare_within,
};
use anyhow::Context;
use dermatome_frames::recorded::order::Arrangement;
use dermatome_link::{
    LinkErrorKind,
    health::{Finding, FittedCurrent, fit_current},
    silence_timeout, tare_timeout,
};
use dermatome_model::metrics::detectability::Sought;
use dermatome_shared::{
    drive::Drive,
    protocol::{FrameSource, PROTOCOL_VERSION},
    reference::DEFAULT_TARE_FRAMES,
};
use nalgebra::Point2;

/// Signal-to-noise ratio below which single presses drown, dB.
const LOW_SNR_DB: f64 = 40.0;
/// A tare may take so many times as long as the frame rate says: an emulated board on a busy machine does.
const PATIENCE: u32 = 4;
/// What takes the place of a signal-to-noise ratio without noise, dB.
const NO_NOISE_DB: f64 = 200.0;

/// Does one step; says whether the next one can follow.
type Do = fn(&mut Bench<'_>) -> anyhow::Result<bool>;

const STEPS: [(&str, Do); 8] = [
    ("board", board),
    ("patch", patch),
    ("current", current),
    ("electrodes", electrodes),
    ("model", model),
    ("noise", noise),
    ("tare", tare),
    ("presses", presses),
];

/// Does all steps, until one cannot be followed by the next, or Ctrl-C comes.
pub(super) fn all(bench: &mut Bench<'_>) -> anyhow::Result<()> {
    for (number, (_, step)) in STEPS.iter().enumerate() {
        if interrupt::requested() || !step(bench)? {
            let left = STEPS.iter().skip(number).map(|(name, _)| *name);
            let done: Vec<_> = bench.steps.iter().map(|step| step.step).collect();
            left.filter(|name| !done.contains(name))
                .for_each(|name| bench.tell(Step::new(name, State::Skipped, "not reached")));
            break;
        }
    }
    Ok(())
}

fn board(bench: &mut Bench<'_>) -> anyhow::Result<bool> {
    let (port, identity) = (bench.link.port().to_owned(), bench.link.identity().clone());
    let info = bench.link.info()?;
    let measured = format!(
        "{} at {port}, firmware {}, protocol {PROTOCOL_VERSION}, {} electrodes",
        identity.board, identity.firmware, info.electrodes
    );
    let step = match info.frame_source {
        FrameSource::Synthetic => Step::wrong(
            "board",
            measured,
            "its frames are synthetic, numbers without meaning",
            "program the firmware of a board that can measure",
        ),
        _ if info.electrodes < bench.skin.electrodes.count => Step::wrong(
            "board",
            measured,
            format!("the skin has {} electrodes", bench.skin.electrodes.count),
            "a board with as many, or another skin file",
        ),
        _ => Step::new("board", State::Ok, measured),
    };
    let is_fine = step.state == State::Ok;
    bench.tell(step);
    Ok(is_fine)
}

/// Whether the board's patch is the skin's; what is missing or another skin's is built and flashed.
fn patch(bench: &mut Bench<'_>) -> anyhow::Result<bool> {
    let Built { crc, .. } = *bench.built()?;
    let there = bench.link.info()?.patch;
    bench.on_board = there.as_ref().map(|patch| patch.crc);
    let Some(there) = &there else {
        return replace(bench, "the board holds no patch", false);
    };
    if there.crc == crc {
        bench.tell(Step::new("patch", State::Ok, format!("`{}`, id {}", there.skin, patch_id(crc))));
        return Ok(true);
    }
    let is_of_skin = there.skin.as_str() == bench.skin.name && bench.link.steps()? == bench.skin.steps();
    let other = format!(
        "the board's patch {} of `{}` is not what {} gives",
        patch_id(there.crc),
        there.skin,
        bench.in_file()
    );
    if !bench.link.is_calibrated()? {
        return replace(bench, &other, is_of_skin);
    }
    let step = if is_of_skin {
        let measured = format!("`{}`, id {}, calibrated: kept", there.skin, patch_id(there.crc));
        Step::new("patch", State::Ok, measured)
    } else {
        let advice = "flash a patch of this skin; it was calibrated and is not replaced unasked";
        Step::wrong("patch", other.as_str(), "another skin's patch is on the board", advice)
    };
    bench.tell(step);
    Ok(is_of_skin)
}

/// Flashes the skin's patch, unless the person would rather not; one that fits may then stay.
fn replace(bench: &mut Bench<'_>, why: &str, fits: bool) -> anyhow::Result<bool> {
    if !bench.person.says_yes(&format!("{why}: flash the skin's own?"))? {
        if fits && !interrupt::requested() {
            bench.tell(Step::new("patch", State::Ok, format!("{why}, and has its name and steps: kept")));
            return Ok(true);
        }
        let refused = Step::wrong("patch", why, "not replaced", "`dermatome build`, then `dermatome flash`");
        let stopped = || Step::new("patch", State::Skipped, why);
        bench.tell(if interrupt::requested() { stopped() } else { refused });
        return Ok(false);
    }
    bench.flash()?;
    let Built { patch, crc, .. } = bench.built()?;
    let measured = format!("{why}; flashed {} bytes, id {}", patch.len(), patch_id(*crc));
    bench.tell(Step::new("patch", State::Mended, measured));
    Ok(true)
}

/// A current that is too large for voltages or tests is halved until it is not, in the patch as well.
fn current(bench: &mut Bench<'_>) -> anyhow::Result<bool> {
    let patch = bench.patch()?;
    let (timeout, front_end) = (silence_timeout(&patch), bench.link.info()?.front_end);
    let fitted = fit_current(&mut bench.link, patch.drive, timeout, || !interrupt::requested())?;
    let Some(FittedCurrent { before, amplitude, clips }) = fitted else { return Ok(false) };
    let measured = drive::line(&Drive { amplitude, ..patch.drive }, front_end.as_ref());
    if clips {
        let what = "voltages clip, however small the current";
        let advice = "look at one with `dermatome scope`; check the amplifier, its gain and its supply";
        bench.tell(Step::wrong("current", measured, what, advice));
        return Ok(false);
    }
    bench.amplitude = Some(amplitude);
    if amplitude == before {
        bench.tell(Step::new("current", State::Ok, measured));
        return Ok(true);
    }
    let lower = format!(
        "voltages or the electrodes' tests clip at {:.4} mA, not at {:.4} mA",
        1e3 * before,
        1e3 * amplitude
    );
    if bench.may_replace()? && bench.person.says_yes(&format!("{lower}: keep that in the patch?"))? {
        bench.lower_current(amplitude)?;
        bench.tell(Step::new("current", State::Mended, format!("{lower}: {measured}")));
    } else {
        let advice = format!(
            "set `drive.amplitude` = \"{:.4} mA\" in the skin file: this one lasts until the next patch or restart",
            1e3 * amplitude
        );
        bench.tell(Step::wrong("current", measured, lower, advice));
    }
    Ok(true)
}

/// Contacts of the electrodes, and what the board says of itself.
fn electrodes(bench: &mut Bench<'_>) -> anyhow::Result<bool> {
    loop {
        let Some(step) = look(bench)? else { return Ok(false) };
        let is_fine = step.state == State::Ok;
        bench.tell(step);
        if is_fine || bench.compared.is_some() {
            return Ok(true);
        }
        if bench.person.is_nobody() || !bench.person.says_yes("mended; look again?")? {
            return Ok(false);
        }
    }
}

/// Watches some frames, and compares them with the model where electrodes and current are sound; none where Ctrl-C comes.
fn look(bench: &mut Bench<'_>) -> anyhow::Result<Option<Step>> {
    let patch = bench.patch()?;
    let untouched = Untouched::of_skin(&bench.args.skin, bench.skin.clone())?;
    untouched.check_steps(&mut bench.link, &patch)?;
    let Some(examined) = examine(&mut bench.link, &patch, Some(&untouched), bench.args.frames.into())? else {
        return Ok(None);
    };
    let diagnosis = examined.diagnosis;
    bench.compared = examined.model;
    let of_model = bench.compared.as_ref().map_or(&[][..], |compared| &compared.findings);
    let own = diagnosis.findings.iter().filter(|finding| !of_model.contains(finding));
    let findings: Vec<Finding> = own.cloned().collect();
    if !findings.is_empty() {
        print_electrodes(&diagnosis.electrodes);
    }
    let ohms = diagnosis.electrodes.iter().filter_map(|electrode| electrode.contact_impedance_ohm);
    let (least, most) = ohms.fold((f32::INFINITY, 0.0_f32), |(a, b), ohms| (a.min(ohms), b.max(ohms)));
    let count = diagnosis.electrodes.len();
    let contacts = match (findings.is_empty(), least.is_finite()) {
        // The table above has them.
        (false, _) => format!("{count} electrodes"),
        (true, true) => format!("{count} electrodes, contacts of {least:.1} to {most:.1} ohm"),
        (true, false) => "contacts not measured".to_owned(),
    };
    let rate =
        diagnosis.frames_per_second.map_or(String::new(), |rate| format!(", {rate:.1} frames a second"));
    Ok(Some(Step::found("electrodes", contacts + &rate, findings)))
}

/// What the untouched skin measures against what its file says; wires in an order that the skin's shape tells are mended.
fn model(bench: &mut Bench<'_>) -> anyhow::Result<bool> {
    let before = told_of_model(bench);
    let order = bench.compared.as_ref().and_then(|compared| compared.order);
    let Some(order) = order.filter(|order| order.sense == Arrangement::default().sense) else {
        bench.tell(before);
        return Ok(true);
    };
    before.print();
    if let Some(finding) = bench.reorder(&order)? {
        bench.tell(Step::found("model", before.measured, vec![finding]));
        return Ok(true);
    }
    let Some(step) = look(bench)? else { return Ok(false) };
    let after = told_of_model(bench);
    if step.state != State::Ok {
        bench.tell(step);
    }
    let is_mended = after.state == State::Ok;
    let measured = format!("{}; {}", order::told(&order), after.measured);
    bench.tell(Step { state: if is_mended { State::Mended } else { State::Wrong }, measured, ..after });
    Ok(true)
}

fn told_of_model(bench: &Bench<'_>) -> Step {
    let Some(compared) = &bench.compared else {
        return Step::new("model", State::Skipped, "not compared");
    };
    let rows: Vec<_> = compared.rows().into_iter().map(|(name, value)| format!("{name} {value}")).collect();
    Step::found("model", rows.join("; "), compared.findings.clone())
}

/// Noise of the measurements, and the smallest press that it lets through.
fn noise(bench: &mut Bench<'_>) -> anyhow::Result<bool> {
    let Some(compared) = &bench.compared else {
        bench.tell(Step::new("noise", State::Skipped, "not measured"));
        return Ok(true);
    };
    let snr_db = compared.snr_db.unwrap_or(NO_NOISE_DB);
    let found = bench.built()?.smallest_press(snr_db);
    (bench.snr_db, bench.smallest_press) = (Some(snr_db), Some(found));
    let change =
        |percent: Option<f64>| percent.map_or("none".to_owned(), |percent| format!("{percent:.1} %"));
    let measured = format!(
        "{snr_db:.1} dB; the smallest finger of {:.1} mm radius that one frame shows changes the sheet by {}, at the worst \
         place by {}",
        found.radius_mm,
        change(found.median_change_percent),
        change(found.worst_change_percent)
    );
    let step = if snr_db < LOW_SNR_DB {
        let what = format!("below {LOW_SNR_DB} dB single presses drown");
        let advice =
            "a larger `drive.amplitude`, a longer `drive.integration`, shorter leads, and a quiet supply";
        Step::wrong("noise", measured, what, advice)
    } else {
        Step::new("noise", State::Ok, measured)
    };
    bench.tell(step);
    Ok(true)
}

impl Built {
    /// The smallest finger, of 4 % of the skin's size, that one frame of this signal-to-noise ratio, dB, shows.
    fn smallest_press(&self, snr_db: f64) -> SmallestPress {
        let finger = Sought::finger(self.model.pixels.larger_side(), snr_db);
        let mut smallest: Vec<f64> =
            self.model.detectability(&finger).places.iter().map(|place| place.smallest).collect();
        smallest.sort_by(f64::total_cmp);
        // The inverse of `strength_of`.
        let change = |strength: Option<&f64>| {
            strength
                .filter(|strength| **strength < 2.0)
                .map(|strength| 100.0 * 2.0 * strength / (2.0 - strength))
        };
        SmallestPress {
            radius_mm: 1e3 * finger.radius,
            median_change_percent: change(smallest.get(smallest.len() / 2)),
            worst_change_percent: change(smallest.last()),
        }
    }
}

/// Averages the untouched skin.
fn tare(bench: &mut Bench<'_>) -> anyhow::Result<bool> {
    if !bench.person.says_yes("nothing touches the skin?")? {
        let advice = "lift it, and run this once more";
        bench.tell(Step::wrong("tare", "not averaged", "something touches the skin", advice));
        return Ok(false);
    }
    let patch = bench.patch()?;
    let timeout = PATIENCE * tare_timeout(&patch, DEFAULT_TARE_FRAMES);
    match tare_within(&mut bench.link, DEFAULT_TARE_FRAMES, timeout) {
        Ok(()) => {
            let measured = format!("averaged {DEFAULT_TARE_FRAMES} frames");
            bench.tell(Step::new("tare", State::Ok, measured));
            Ok(true)
        }
        Err(error) if matches!(error.kind, LinkErrorKind::NoTare { .. }) => {
            let advice = "mend what the electrodes' step says, and see that nothing moves on the skin";
            bench.tell(Step::wrong("tare", "not averaged", error.to_string(), advice));
            Ok(false)
        }
        Err(error) => Err(advised(error)),
    }
}

/// Two presses beside electrodes tell turn and mirror of the wires, which no measurement of a round skin does.
fn presses(bench: &mut Bench<'_>) -> anyhow::Result<bool> {
    if bench.args.press_within().is_none() {
        bench.tell(Step::new(
            "presses",
            State::Skipped,
            "so the order of the wires on a round skin is not known",
        ));
        return Ok(true);
    }
    let asked = [0, order::second(bench.skin.electrodes.count)];
    let centres = bench.skin.shape.electrode_centres();
    let places = asked.map(|electrode| centres[electrode].xy());
    let Some(seen) = press(bench, places, asked)? else { return Ok(true) };
    let found = order::of_presses(seen, bench.skin.electrodes.count);
    let told = format!(
        "pressed beside electrodes {} and {}, seen beside {} and {}",
        asked[0] + 1,
        asked[1] + 1,
        seen[0] + 1,
        seen[1] + 1
    );
    match found {
        Some(order) if order == Arrangement::default() => {
            bench.tell(Step::new("presses", State::Ok, told));
            Ok(true)
        }
        Some(order) => correct(bench, places, &told, &order),
        None => {
            let what = "no turn and no mirror of the wires does that";
            let advice = "press nearer to the two electrodes; if it stays, two wires are exchanged";
            bench.tell(Step::wrong("presses", told, what, advice));
            Ok(true)
        }
    }
}

/// Corrects the order, and lets it be shown by two more presses at the same places.
fn correct(
    bench: &mut Bench<'_>,
    places: [Point2<f64>; 2],
    told: &str,
    order: &Arrangement,
) -> anyhow::Result<bool> {
    say!("{told}: {}", order::told(order));
    if let Some(finding) = bench.reorder(order)? {
        bench.tell(Step::found("presses", told, vec![finding]));
        return Ok(true);
    }
    if !tare(bench)? {
        bench.tell(Step::wrong("presses", told, "not shown by a press", "tare, and press again"));
        return Ok(false);
    }
    let centres = bench.skin.shape.electrode_centres();
    let expected = places.map(|place| order::nearest(&centres, place).map_or(0, |(electrode, _)| electrode));
    let Some(seen) = press(bench, places, expected)? else { return Ok(true) };
    let step = if seen == expected {
        Step::new("presses", State::Mended, format!("{told}; {}; now seen where pressed", order::told(order)))
    } else {
        let what = format!("still seen beside electrodes {} and {}", seen[0] + 1, seen[1] + 1);
        Step::wrong("presses", told, what, "press nearer to the two places, and run this once more")
    };
    bench.tell(step);
    Ok(true)
}

/// Asks for presses at two places, beside these electrodes (from 0), and gives the electrodes beside which they are seen;
/// none where they do not come, which is told.
fn press(
    bench: &mut Bench<'_>,
    places: [Point2<f64>; 2],
    electrodes: [usize; 2],
) -> anyhow::Result<Option<[usize; 2]>> {
    let Some(within) = bench.args.press_within() else { return Ok(None) };
    let silence = silence_timeout(&bench.patch()?);
    let announce = |number: usize| {
        let lift = if number > 0 { "lift, then press" } else { "press" };
        let [x, y] = [places[number].x * 1e3, places[number].y * 1e3];
        say!("{lift} near electrode {} (x {x:.0}, y {y:.0} mm)", electrodes[number] + 1);
    };
    let seen = presses::watch(&mut bench.link, places.len(), within, silence, announce)
        .map_err(advised)
        .context("while waiting for a press")?;
    let centres = bench.skin.shape.electrode_centres();
    let beside: Vec<usize> =
        seen.iter().filter_map(|&at| order::nearest(&centres, at)).map(|(electrode, _)| electrode).collect();
    if let [first, second] = beside[..] {
        return Ok(Some([first, second]));
    }
    if !interrupt::requested() {
        let what = format!("{} of 2 presses came within {} s each", beside.len(), within.as_secs());
        let advice = "press harder, nearer to the electrode; `dermatome stream` shows what the board sees";
        bench.tell(Step::wrong("presses", "waited for presses", what, advice));
    }
    Ok(None)
}
