//! Corners of the current source: bridge resistors, op-amps, leads, skins and ranges at their ends.
//!
//! Each test builds a deck with many copies of the source, which differ in their corner only, and gives the worst
//! figure of all. Loops are cut at the output of U2 before its output resistance, where nothing loads the cut, with all
//! other loops closed: so one loop gain holds both the bridge and what keeps the output at 0 V.

use crate::ngspice::{Figures, folder};
use std::{array, fmt::Write};

/// Gain-bandwidths and second poles of all op-amps, as shares of the typical ones; assumed, no datasheet has limits.
const OPAMPS: [(f64, f64); 4] = [(0.7, 0.7), (0.7, 1.4), (1.3, 0.7), (1.3, 1.4)];
/// Ends of the tolerances of R1 to R4 with the smallest and the greatest output resistance.
const BRIDGES: [[i8; 4]; 2] = [[1, -1, -1, 1], [-1, 1, 1, -1]];
/// Leads of nothing to 1 nF.
const LEADS: [&str; 4] = ["0", "10p", "100p", "1n"];
/// Skins of 10 ohm to 100 kohm per square, and none.
const SKINS: [&str; 6] = ["5", "900", "10k", "100k", "300k", "1e12"];
/// Wiring of the multiplexer's common pin with that pin, more than it will have, F.
const WIRING: &str = "60p";
/// Copies in one run; ngspice slows down with more.
const COPIES: usize = 24;
/// Most that may flow once the strays have discharged: 1 mA and 5 %.
pub(crate) const LIMIT: f64 = 1.05e-3;

/// A copy of the source.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Corner {
    bridge: [i8; 4],
    opamps: (f64, f64),
    range: u8,
    leads: &'static str,
    skin: &'static str,
}

impl Corner {
    /// The copy with this number, whose ports are `in`, `outN`, `driveN` and `madeN`.
    fn copy(&self, number: usize, input: &str, offset: &str) -> String {
        let [up1, up2, up3, up4] = self.bridge;
        let (g, p) = self.opamps;
        let range = self.range;
        format!(
            "X{number} {input} out{number} drive{number} made{number} cut_source up1={up1} up2={up2} up3={up3} \
             up4={up4} g={g} p={p} range={range} offset={offset}\n"
        )
    }

    /// Leads and skin behind a closed switch of the multiplexer.
    fn load(&self, number: usize) -> String {
        let (leads, skin) = (self.leads, self.skin);
        format!(
            "Ron{number} out{number} lead{number} 200\nClead{number} lead{number} 0 {leads}\n\
             Rskin{number} lead{number} 0 {skin}\n"
        )
    }
}

/// All corners of these lists, in both ranges.
fn corners(
    bridges: &[[i8; 4]],
    opamps: &[(f64, f64)],
    leads: &[&'static str],
    skins: &[&'static str],
) -> Vec<Corner> {
    let mut all = Vec::new();
    for range in [1, 0] {
        for &bridge in bridges {
            for &opamps in opamps {
                for &leads in leads {
                    all.extend(skins.iter().map(|&skin| Corner { bridge, opamps, range, leads, skin }));
                }
            }
        }
    }
    all
}

/// Each of R1 to R4 at either end.
fn every_bridge() -> Vec<[i8; 4]> {
    (0..16_u8).map(|bits| array::from_fn(|place| if bits >> place & 1 == 0 { -1 } else { 1 })).collect()
}

/// Runs copies of the source in decks of some: `copy` gives the netlist of one, `measure` the lines that print its
/// figures, named with its number. Each corner with its figures, in the order of `names`.
fn run<const N: usize>(
    parts: &str,
    corners: &[Corner],
    analysis: &str,
    names: [&str; N],
    copy: impl Fn(usize, &Corner) -> String,
    measure: impl Fn(usize) -> String,
) -> Option<Vec<(Corner, [f64; N])>> {
    let mut found = Vec::new();
    for chunk in corners.chunks(COPIES) {
        let mut deck =
            format!("* Corners\n.include {0}/{parts}\n.include {0}/source.inc\n", folder().display());
        chunk.iter().enumerate().for_each(|(number, corner)| deck += &copy(number, corner));
        write!(deck, ".options noinit\n.control\nset noaskquit\nset numdgt=9\n{analysis}\n").unwrap();
        (0..chunk.len()).for_each(|number| deck += &measure(number));
        deck += "quit\n.endc\n.end\n";
        let name = format!("{}-{}-{parts}.cir", std::thread::current().name().unwrap_or("deck"), found.len());
        let figures = Figures::of_text(&name.replace("::", "-"), &deck)?;
        let get = |number| names.map(|name| figures.get(&format!("{name}_{number}")));
        found.extend(chunk.iter().enumerate().map(|(number, corner)| (*corner, get(number))));
    }
    Some(found)
}

/// Least of a figure over all corners, with its corner.
fn least<const N: usize>(found: &[(Corner, [f64; N])], place: usize) -> (f64, Corner) {
    let all = found.iter().map(|(corner, figures)| (figures[place], *corner));
    all.min_by(|a, b| a.0.total_cmp(&b.0)).expect("a corner")
}

/// Greatest of a figure over all corners.
fn greatest<const N: usize>(found: &[(Corner, [f64; N])], place: usize) -> f64 {
    found.iter().map(|(_, figures)| figures[place]).max_by(f64::total_cmp).expect("a corner")
}

/// Worst loop gain over all corners.
#[derive(Debug)]
pub(crate) struct Margins {
    /// Least distance of the phase from -180 degrees where the gain is 1, degrees.
    pub(crate) phase: (f64, Corner),
    /// Least distance of the gain from 1, either way, where the phase is -180 degrees, dB.
    pub(crate) gain: (f64, Corner),
    /// Least distance of the loop gain from -1.
    pub(crate) distance: (f64, Corner),
    /// Turns of the loop gain around -1, degrees: 0 where the closed loop is stable.
    pub(crate) turns: f64,
}

/// Loop gains from 10 mHz to 1 GHz with every load.
pub(crate) fn margins(parts: &str) -> Option<Margins> {
    let corners = corners(&BRIDGES, &OPAMPS, &LEADS, &SKINS);
    let copy = |number: usize, corner: &Corner| {
        let cut = format!("Vcut{number} drive{number} 0 dc 0 ac 1\n");
        corner.copy(number, "0", "0") + &cut + &corner.load(number)
    };
    let measure = |number| {
        format!(
            "let loop = -v(made{number})\nlet size = 20 * log10(mag(loop))\nlet angle = abs(ph(loop)) * 180 / pi\n\
             let phase = vecmin(180 - angle + 1000 * (abs(size) gt 0.6))\n\
             let gain = vecmin(abs(size) + 1000 * (angle lt 176))\nlet distance = vecmin(mag(1 + loop))\n\
             let turn = cph(1 + loop) * 180 / pi\nlet turns = abs(turn[length(turn) - 1] - turn[0])\n\
             echo figure phase_{number} $&phase\necho figure gain_{number} $&gain\n\
             echo figure distance_{number} $&distance\necho figure turns_{number} $&turns\n"
        )
    };
    let names = ["phase", "gain", "distance", "turns"];
    let found = run(parts, &corners, "ac dec 20 0.01 1g", names, copy, measure)?;
    Some(Margins {
        phase: least(&found, 0),
        gain: least(&found, 1),
        distance: least(&found, 2),
        turns: greatest(&found, 3),
    })
}

/// Output admittance over all corners, each of R1 to R4 at either end for itself.
#[derive(Debug)]
pub(crate) struct Admittance {
    /// Least conductance from 1 to 100 kHz, S, in the ranges of 1 mA and 29 uA. Above, the switch's capacitance makes that of
    /// 29 uA negative beside its own susceptance.
    pub(crate) conductance: [f64; 2],
    /// Least of the greater of conductance and susceptance up to 1 GHz, as a share of the admittance: positive where no
    /// resistor and capacitor in parallel can be an oscillator with it.
    pub(crate) damping: f64,
}

/// Output admittances with nothing connected.
pub(crate) fn admittance(parts: &str) -> Option<Admittance> {
    let corners = corners(&every_bridge(), &OPAMPS, &LEADS[..1], &SKINS[..1]);
    let copy = |number: usize, corner: &Corner| {
        let whole =
            format!("E{number} drive{number} 0 made{number} 0 1\nI{number} 0 out{number} dc 0 ac 1\n");
        corner.copy(number, "0", "0") + &whole
    };
    let measure = |number| {
        format!(
            "let y = 1 / v(out{number})\nlet g = real(y)\nlet b = imag(y)\n\
             let conductance = vecmin(g + (real(frequency) lt 990) + (real(frequency) gt 101k))\n\
             let damping = vecmin((g + b + abs(g - b)) / 2 / mag(y))\n\
             echo figure conductance_{number} $&conductance\necho figure damping_{number} $&damping\n"
        )
    };
    let found = run(parts, &corners, "ac dec 10 0.01 1g", ["conductance", "damping"], copy, measure)?;
    let (one, other) = found.split_at(found.len() / 2);
    Some(Admittance { conductance: [least(one, 0).0, least(other, 0).0], damping: least(&found, 1).0 })
}

/// What is left of a kick while idle, over all corners, as a share of the kick: of U2's voltage, 18 to 20 ms after 10 pC
/// into the open output.
pub(crate) fn kick(parts: &str) -> Option<f64> {
    let corners = corners(&BRIDGES, &OPAMPS, &["1p", WIRING, "1n"], &["0"]);
    let copy = |number: usize, corner: &Corner| {
        let leads = corner.leads;
        let circuit = format!(
            "E{number} drive{number} 0 made{number} 0 1\nC{number} out{number} 0 {leads}\n\
             I{number} 0 out{number} pulse(0 1u 100u 1u 1u 10u 1)\n"
        );
        corner.copy(number, "0", "{worst_offset}") + &circuit
    };
    let measure = |number| {
        format!(
            "let swing = abs(v(made{number}) - v(made{number})[0])\n\
             let left = vecmax(swing * (time gt 18m)) / vecmax(swing)\necho figure left_{number} $&left\n"
        )
    };
    let found = run(parts, &corners, "tran 1u 20m 0 20u", ["left"], copy, measure)?;
    Some(greatest(&found, 0))
}

/// Greatest currents through the skin while a switch of the multiplexer opens and closes at full amplitude.
#[derive(Debug)]
pub(crate) struct Currents {
    /// From half a microsecond after the switch has closed, A.
    pub(crate) lasting: f64,
    /// What flows above [`LIMIT`] after one closing, C.
    pub(crate) charge: f64,
    /// For how long more than that flows, s.
    pub(crate) time: f64,
    /// While the strays discharge, A.
    pub(crate) peak: f64,
}

/// With the greatest output resistance, which gives the greatest current. Closings every 23.3 us for 12.1 us, at 12.5 kHz, where the current is greatest: at ten phases of the sine.
pub(crate) fn currents(parts: &str) -> Option<Currents> {
    let corners = corners(&BRIDGES[1..], &[OPAMPS[0], OPAMPS[2]], &["1p", "1n"], &["5", "900", "100k"]);
    let found = run(
        parts,
        &corners,
        "tran 50n 320u 40u 50n",
        ["lasting", "charge", "time", "peak"],
        switched,
        switched_figures,
    )?;
    Some(Currents {
        lasting: greatest(&found, 0),
        charge: greatest(&found, 1),
        time: greatest(&found, 2),
        peak: greatest(&found, 3),
    })
}

/// A source with full amplitude before a switch that opens and closes; integrators that start again at each closing.
fn switched(number: usize, corner: &Corner) -> String {
    let common = "\
        Vfull full 0 dc 0 sin(0 {full} 12.5k)\nVclose close 0 dc 0 pulse(0 1 60u 1n 1n 12.1u 23.3u)\n\
        Vopen open 0 dc 1 pulse(1 0 60u 1n 1n 12.1u 23.3u)\nVlate late 0 dc 0 pulse(0 1 60.5u 1n 1n 11.5u 23.3u)\n\
        .model multiplexer sw(vt=0.5 vh=0.1 ron=200 roff=1e12)\n.model reset sw(vt=0.5 vh=0.1 ron=1 roff=1e12)\n";
    let (leads, skin) = (corner.leads, corner.skin);
    let n = number;
    let circuit = format!(
        "E{n} drive{n} 0 made{n} 0 1\nCwiring{n} out{n} 0 {WIRING}\nSclose{n} out{n} lead{n} close 0 multiplexer\n\
         Clead{n} lead{n} 0 {leads}\nRskin{n} lead{n} foot{n} {skin}\nVskin{n} foot{n} 0 0\n\
         Bcharge{n} 0 charge{n} I = max(abs(i(Vskin{n})) - {LIMIT}, 0) * 1e6\nCcharge{n} charge{n} 0 1u\n\
         Scharge{n} charge{n} 0 open 0 reset\nBtime{n} 0 time{n} I = abs(i(Vskin{n})) > {LIMIT} ? 1 : 0\n\
         Ctime{n} time{n} 0 1u\nStime{n} time{n} 0 open 0 reset\nBlate{n} late{n} 0 V = abs(i(Vskin{n})) * v(late)\n"
    );
    let first = if number == 0 { common } else { "" };
    first.to_owned() + &corner.copy(number, "full", "{worst_offset}") + &circuit
}

/// Volts of the integrators are picocoulombs and microseconds.
fn switched_figures(number: usize) -> String {
    format!(
        "let lasting = vecmax(v(late{number}))\nlet charge = vecmax(v(charge{number})) * 1e-12\n\
         let time_above = vecmax(v(time{number})) * 1e-6\nlet peak = vecmax(abs(i(vskin{number})))\n\
         echo figure lasting_{number} $&lasting\necho figure charge_{number} $&charge\n\
         echo figure time_{number} $&time_above\necho figure peak_{number} $&peak\n"
    )
}
