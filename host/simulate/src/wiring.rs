//! Wiring: what lies between a skin's electrodes and its board, and what goes wrong there.
//!
//! The true skin is reduced to the admittance between its electrodes; faults change that as they change a circuit. The
//! current source and the inputs are those of a board: a source that finds no way gives no more than its compliance, and
//! an input without electrode floats to ground.

use crate::{instrument::ScanTable, truth::TrueSkin};
use dermatome_shared::stimulation::Step;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex64;
use std::{
    collections::{HashMap, HashSet},
    fmt,
    str::FromStr,
};

/// Resistance of a short between two leads, ohm.
const SHORT: f64 = 1.0;
/// Resistance of a closed switch of the multiplexers, ohm.
const SWITCH: f64 = 200.0;
/// From a lead to ground, S: a multiplexer's open switches.
const LEAK: f64 = 1e-10;
/// Largest voltage of the current source, V; of a skin that needs more without any fault, twice what it needs, as the range
/// of a simulated converter fits its skin, too.
const COMPLIANCE: f64 = 3.2;

/// One thing that is wrong; electrodes count from 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fault {
    /// An electrode without contact.
    Open(u8),
    /// Two leads connected.
    Shorted(u8, u8),
    /// A resistance in one lead, ohm, beside its contact.
    Contact(u8, f64),
    /// Two wires exchanged.
    Exchanged(u8, u8),
}

/// A fault, and from when on it is there: seconds into the script.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimedFault {
    /// What is wrong.
    pub fault: Fault,
    /// Since when; `None` from the start, the tare included.
    pub from: Option<f64>,
}

/// Why a text is no fault.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{text}` is no fault: {reason} (allowed are open:ELECTRODE, short:ELECTRODE-ELECTRODE, contact:ELECTRODE+OHMS and \
     exchanged:ELECTRODE-ELECTRODE, from the start or with @TIME behind them, like open:3@8s; electrodes count from 1)"
)]
pub struct FaultError {
    text: String,
    reason: String,
}

impl Fault {
    /// Electrodes it is about, from 0.
    #[must_use]
    pub fn electrodes(&self) -> Vec<u8> {
        match *self {
            Self::Open(electrode) | Self::Contact(electrode, _) => vec![electrode],
            Self::Shorted(a, b) | Self::Exchanged(a, b) => vec![a, b],
        }
    }
}

impl FromStr for TimedFault {
    type Err = FaultError;

    fn from_str(text: &str) -> Result<Self, FaultError> {
        parse(text).map_err(|reason| FaultError { text: text.to_owned(), reason })
    }
}

fn parse(text: &str) -> Result<TimedFault, String> {
    let (what, time) = text.split_once('@').map_or((text, None), |(what, time)| (what, Some(time)));
    let (kind, place) = what.split_once(':').ok_or("it has no `:`")?;
    let fault = match kind {
        "open" => Fault::Open(electrode(place)?),
        "short" => pair(place).map(|[a, b]| Fault::Shorted(a, b))?,
        "exchanged" => pair(place).map(|[a, b]| Fault::Exchanged(a, b))?,
        "contact" => {
            let (which, ohms) =
                place.split_once('+').ok_or_else(|| format!("`{place}` is not like 3+500"))?;
            let found = ohms.parse().ok().filter(|ohms: &f64| ohms.is_finite() && *ohms > 0.0);
            Fault::Contact(electrode(which)?, found.ok_or_else(|| format!("`{ohms}` are no ohms above 0"))?)
        }
        _ => return Err(format!("`{kind}` is unknown")),
    };
    let seconds = |time: &str| {
        let number = time.strip_suffix('s').and_then(|number| number.parse().ok());
        let allowed = number.filter(|seconds: &f64| seconds.is_finite() && *seconds >= 0.0);
        allowed.ok_or_else(|| format!("`{time}` is no time like 8s"))
    };
    Ok(TimedFault { fault, from: time.map(seconds).transpose()? })
}

fn electrode(text: &str) -> Result<u8, String> {
    let number = text.parse().ok().filter(|number: &u8| *number > 0);
    number.map(|number| number - 1).ok_or_else(|| format!("`{text}` is no electrode"))
}

fn pair(text: &str) -> Result<[u8; 2], String> {
    let (a, b) = text.split_once('-').ok_or_else(|| format!("`{text}` is no pair like 3-4"))?;
    let pair = [electrode(a)?, electrode(b)?];
    if pair[0] == pair[1] {
        return Err("a pair is two different electrodes".to_owned());
    }
    Ok(pair)
}

impl fmt::Display for Fault {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Open(electrode) => write!(formatter, "open:{}", electrode + 1),
            Self::Shorted(a, b) => write!(formatter, "short:{}-{}", a + 1, b + 1),
            Self::Contact(electrode, ohms) => write!(formatter, "contact:{}+{ohms}", electrode + 1),
            Self::Exchanged(a, b) => write!(formatter, "exchanged:{}-{}", a + 1, b + 1),
        }
    }
}

/// What a scan meets on a sheet of this relative conductivity, `[element]`, where wires have these faults: phasors at unit
/// current and conductivity, `[slot]`. They depend on the current, as its source has an end; `sheet_conductivity` is in
/// S per square.
#[must_use]
pub fn phasors(
    truth: &TrueSkin,
    conductivity: &[f64],
    table: &ScanTable,
    sheet_conductivity: f64,
    faults: &[Fault],
) -> Vec<Complex64> {
    let ohms = 1.0 / sheet_conductivity;
    let in_ohms = |row: &Vec<Complex64>| row.iter().map(|impedance| impedance * ohms).collect();
    let transfer = truth.transfer_at(conductivity, table.drive.frequency.into());
    let transfer: Vec<Vec<_>> = transfer.iter().map(in_ohms).collect();
    let current = f64::from(table.drive.amplitude);
    let slots = table.slots();
    let needed = Wiring::new(&transfer, &[]).largest_of_source(&slots, current);
    let compliance = COMPLIANCE.max(2.0 * needed);
    let volts = Wiring { compliance, ..Wiring::new(&transfer, faults) }.volts(&slots, current);
    volts.into_iter().map(|volts| volts / (ohms * current)).collect()
}

/// A skin with its wires.
#[derive(Clone, Debug)]
pub struct Wiring {
    /// Between leads and ground, without switches, S: `[lead][lead]`.
    admittance: DMatrix<Complex64>,
    /// Which lead the board's channel is connected to: `[channel]`.
    leads: Vec<usize>,
    /// Largest voltage of the source, V.
    compliance: f64,
}

impl Wiring {
    /// The wiring of a skin of these transfer impedances, ohm, `[electrode][electrode driven]`, each against any one
    /// node ([`crate::TrueSkin::transfer`]); faults of electrodes that it lacks change nothing.
    #[must_use]
    pub fn new(transfer: &[Vec<Complex64>], faults: &[Fault]) -> Self {
        let leads = (0..transfer.len()).collect();
        let mut wiring = Self { admittance: admittance(transfer), leads, compliance: COMPLIANCE };
        let has = |electrode: &u8| usize::from(*electrode) < transfer.len();
        for fault in faults.iter().filter(|fault| fault.electrodes().iter().all(has)) {
            wiring.suffer(*fault);
        }
        for lead in 0..wiring.leads.len() {
            wiring.admittance[(lead, lead)] += LEAK;
        }
        wiring
    }

    fn suffer(&mut self, fault: Fault) {
        match fault {
            Fault::Open(electrode) => self.insert_resistance(electrode.into(), f64::INFINITY),
            Fault::Contact(electrode, ohms) => self.insert_resistance(electrode.into(), ohms),
            Fault::Exchanged(a, b) => self.leads.swap(a.into(), b.into()),
            Fault::Shorted(a, b) => {
                let (a, b) = (usize::from(a), usize::from(b));
                let siemens = Complex64::from(1.0 / SHORT);
                for (row, col, sign) in [(a, a, 1.0), (b, b, 1.0), (a, b, -1.0), (b, a, -1.0)] {
                    self.admittance[(row, col)] += siemens * sign;
                }
            }
        }
    }

    /// A resistance, ohm, between a lead and all that it was connected to; infinite takes it off.
    fn insert_resistance(&mut self, lead: usize, ohms: f64) {
        let (own, conductance) = (self.admittance[(lead, lead)], 1.0 / ohms);
        let inner = own + conductance;
        if inner == Complex64::default() {
            return;
        }
        let row = self.admittance.row(lead).clone_owned();
        self.admittance -= row.transpose() * &row / inner;
        for other in 0..self.leads.len() {
            let value = if other == lead { own } else { row[other] } * conductance / inner;
            (self.admittance[(lead, other)], self.admittance[(other, lead)]) = (value, value);
        }
    }

    /// Voltages, V, of a source of this current, A: `[step]`.
    #[must_use]
    pub fn volts(&self, steps: &[Step], current: f64) -> Vec<Complex64> {
        let mut driven: HashMap<[usize; 2], DVector<Complex64>> = HashMap::new();
        let voltage = |step: &Step| {
            let [plus, minus, high, low] = step.to_bytes().map(|channel| self.leads[usize::from(channel)]);
            let volts = driven.entry([plus, minus]).or_insert_with(|| {
                let (volts, of_source) = self.driven(plus, minus, current);
                volts * Complex64::from((self.compliance / of_source).min(1.0))
            });
            volts[high] - volts[low]
        };
        steps.iter().map(voltage).collect()
    }

    /// Largest voltage, V, that a source of this current, A, would need for these steps.
    fn largest_of_source(&self, steps: &[Step], current: f64) -> f64 {
        let drives: HashSet<[usize; 2]> =
            steps.iter().map(|step| [step.drive_plus, step.drive_minus].map(usize::from)).collect();
        let needed = |[plus, minus]: [usize; 2]| self.driven(plus, minus, current).1;
        drives.into_iter().map(needed).fold(0.0, f64::max)
    }

    /// Voltage of each lead, V, with a current, A, into one and out of another, which is at ground; and that of the source.
    fn driven(&self, plus: usize, minus: usize, current: f64) -> (DVector<Complex64>, f64) {
        let mut admittance = self.admittance.clone();
        admittance[(minus, minus)] += 1.0 / SWITCH;
        let mut into = DVector::zeros(self.leads.len());
        into[plus] = Complex64::from(current);
        let volts = admittance.lu().solve(&into).expect("each lead leaks to ground");
        let of_source = volts[plus].norm() + current * SWITCH;
        (volts, of_source)
    }
}

/// Current into each electrode by the voltage of each, S, of a skin without a ground: `[electrode][electrode]`.
fn admittance(transfer: &[Vec<Complex64>]) -> DMatrix<Complex64> {
    let count = transfer.len();
    let last = count - 1;
    let against_last = DMatrix::from_fn(last, last, |at, driven| {
        transfer[at][driven] - transfer[last][driven] - transfer[at][last] + transfer[last][last]
    });
    let inner = against_last.try_inverse().expect("electrodes on one skin have impedances of full rank");
    let mut all = DMatrix::zeros(count, count);
    all.view_mut((0, 0), (last, last)).copy_from(&inner);
    for at in 0..last {
        let sum = inner.row(at).sum();
        (all[(at, last)], all[(last, at)]) = (-sum, -sum);
        all[(last, last)] += sum;
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use dermatome_model::skin::Skin;
    use std::path::Path;

    const CURRENT: f64 = 1e-5;

    struct Trial {
        skin: Skin,
        transfer: Vec<Vec<Complex64>>,
    }

    impl Trial {
        fn new() -> Self {
            let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../models/square-50mm/skin.toml");
            let skin = Skin::load(Path::new(file)).unwrap().made().unwrap();
            let truth = TrueSkin::new(&skin).unwrap();
            let ohms = 1.0 / skin.material.sheet_conductivity;
            let relative = truth.transfer(&truth.conductivity(&[]));
            let transfer = relative.iter().map(|row| row.iter().map(|z| z * ohms).collect()).collect();
            Self { skin, transfer }
        }

        /// Voltages of all steps, and of the electrodes' tests.
        fn volts(&self, faults: &[Fault]) -> (Vec<f64>, Vec<f64>) {
            let wiring = Wiring::new(&self.transfer, faults);
            let tests: Vec<Step> = (0..16).map(|e| dermatome_shared::scan::test_step(e, 16)).collect();
            let of = |steps: &[Step]| wiring.volts(steps, CURRENT).iter().map(|volts| volts.re).collect();
            (of(&self.skin.steps()), of(&tests))
        }
    }

    #[test]
    fn without_faults_they_are_the_skins_voltages() {
        let trial = Trial::new();
        let (volts, _) = trial.volts(&[]);
        let truth = TrueSkin::new(&trial.skin).unwrap();
        let relative = truth.voltages(&truth.conductivity(&[]), &trial.skin.steps());
        let largest = volts.iter().fold(0.0_f64, |most, volts| most.max(volts.abs()));
        for (volts, relative) in volts.iter().zip(relative) {
            let expected = relative * CURRENT / trial.skin.material.sheet_conductivity;
            assert!((volts - expected).abs() < 1e-3 * largest, "{volts} {expected}");
        }
    }

    #[test]
    fn a_resistance_in_a_lead_adds_its_voltage_to_its_own_test_alone() {
        let trial = Trial::new();
        let ((healthy, tests), (volts, with)) = (trial.volts(&[]), trial.volts(&[Fault::Contact(6, 500.0)]));
        for (electrode, (before, after)) in tests.iter().zip(&with).enumerate() {
            let expected = if electrode == 6 { 500.0 * CURRENT } else { 0.0 };
            assert!((after - before - expected).abs() < 1e-4, "{electrode}: {before} {after}");
        }
        let change: f64 = healthy.iter().zip(&volts).map(|(a, b)| (a - b).abs()).sum();
        assert!(change < 0.1 * healthy.iter().map(|volts| volts.abs()).sum::<f64>(), "{change}");
    }

    #[test]
    fn an_open_lead_takes_the_source_to_its_end_and_a_short_takes_the_voltage_between() {
        let trial = Trial::new();
        let (_, tests) = trial.volts(&[Fault::Open(3)]);
        assert!(tests[2].abs() < 1e-3 && tests[3].abs() > 1.0, "{tests:?}");
        let (_, shorted) = trial.volts(&[Fault::Shorted(3, 4)]);
        let (_, healthy) = trial.volts(&[]);
        assert!(shorted[3].abs() < 0.1 * healthy[3].abs(), "{shorted:?}");
    }

    #[test]
    fn exchanged_wires_exchange_what_is_measured_through_them() {
        let trial = Trial::new();
        let steps = trial.skin.steps();
        let of = |faults: &[Fault], step: [u8; 4]| {
            Wiring::new(&trial.transfer, faults).volts(&[Step::from_bytes(step)], CURRENT)[0]
        };
        assert!(steps.len() > 100);
        let (exchanged, straight) = (of(&[Fault::Exchanged(4, 9)], [0, 4, 9, 12]), of(&[], [0, 9, 4, 12]));
        assert!((exchanged - straight).norm() < 1e-9);
    }

    #[test]
    fn faults_are_read_as_they_are_written() {
        for text in ["open:3", "short:3-4", "contact:16+500", "exchanged:5-6"] {
            let read: TimedFault = text.parse().unwrap();
            assert_eq!((read.fault.to_string().as_str(), read.from), (text, None));
            let later: TimedFault = format!("{text}@2.5s").parse().unwrap();
            assert_eq!(later, TimedFault { from: Some(2.5), ..read });
        }
        for (text, part) in [
            ("open", "no `:`"),
            ("open:0", "no electrode"),
            ("open:3@8", "no time"),
            ("open:3@-1s", "no time"),
            ("short:3", "no pair"),
            ("short:3-3", "two different"),
            ("contact:3+nan", "no ohms"),
            ("contact:3", "not like"),
            ("boom:3", "unknown"),
        ] {
            let error = text.parse::<TimedFault>().unwrap_err().to_string();
            assert!(error.contains(part) && error.contains(text) && error.contains("allowed"), "{error}");
        }
    }
}
