//! The simulated skin: presses -> conductivity -> true voltages -> noisy codes.
//!
//! Its front end is a board's in outline: a code is a 4096th of a step of a 12-bit converter at gain
//! 1, whose range leaves room for the largest voltage at full current. Each scan has one gain, and
//! the lock-in's 16 bits at that gain; tests of electrodes have gain 1.

use crate::{
    converter::Converter,
    instrument::{Instrument, ScanTable},
    material::Material,
    noise::{self, Noise},
    script::{Hand, Script},
    sheet::ScriptedSheet,
    truth::TrueSkin,
    wiring::{self, Fault, TimedFault},
};
use dermatome_model::{indenter::Press, model::ModelError, skin::Skin};
use dermatome_shared::{
    acquire::FrontEnd,
    drive::Drive,
    frame::{ElectrodeTest, Frame},
    protocol::{MAX_SCOPE_SAMPLES, SlotSamples},
    scan::{Timing, test_step},
    stimulation::Step,
};
use num_complex::Complex64;
use rand::SeedableRng;
use rand_distr::{Distribution, Normal};
use rand_pcg::Pcg64Mcg;

/// A skin being pressed by a script.
#[derive(Debug)]
pub struct SimulatedSkin {
    truth: TrueSkin,
    script: Script,
    /// Presses beside the script.
    hand: Hand,
    /// What of the sheet's changes follows from pressure over time.
    worn: Option<ScriptedSheet>,
    faults: Vec<TimedFault>,
    noise: Noise,
    /// Noise of what goes into images, and of all else: so that the first does not depend on the second.
    random: [Pcg64Mcg; 2],
    /// S per square.
    sheet_conductivity: f64,
    /// The skin file's.
    drive: Drive,
    front_end: FrontEnd,
    /// Voltages and noise of the running scan, found on its first frame.
    untouched: Option<Untouched>,
}

#[derive(Clone, Debug)]
struct Untouched {
    table: ScanTable,
    /// At unit current and conductivity: `[slot]`.
    phasors: Vec<Complex64>,
    converter: Converter,
    /// Noise of a voltage, V.
    noise: f64,
}

impl SimulatedSkin {
    /// Meshes the skin; ready to be scanned.
    pub fn new(skin: &Skin, script: Script, noise: Noise) -> Result<Self, ModelError> {
        let truth = TrueSkin::new(skin)?;
        let drive = skin.drive.for_board();
        let electrodes = skin.electrodes.count;
        let tests = (0..electrodes).map(|electrode| test_step(electrode, electrodes));
        let slots: Vec<Step> = skin.steps().into_iter().chain(tests).collect();
        let largest = largest(&truth.phasors(&truth.conductivity(&[]), &slots, skin.drive.frequency));
        let largest_ohms = largest / skin.material.sheet_conductivity;
        Ok(Self {
            truth,
            script,
            hand: Hand::default(),
            worn: None,
            faults: Vec::new(),
            noise,
            random: random(noise.seed),
            sheet_conductivity: skin.material.sheet_conductivity,
            front_end: Converter::front_end(&drive, largest_ohms),
            drive,
            untouched: None,
        })
    }

    /// Makes the sheet of a material, so that pressures and forces change it.
    #[must_use]
    pub fn of_material(self, material: Material) -> Self {
        Self { worn: Some(ScriptedSheet::new(material, self.noise.seed)), ..self }
    }

    /// Lets a hand press it as well, while there is a script to be played.
    #[must_use]
    pub fn pressed_by(self, hand: Hand) -> Self {
        Self { hand, ..self }
    }

    /// Wires it with these faults.
    #[must_use]
    pub fn with_faults(self, faults: Vec<TimedFault>) -> Self {
        Self { faults, ..self }
    }

    /// Elements of the simulation's own mesh.
    #[must_use]
    pub fn elements(&self) -> usize {
        self.truth.mesh().elements.len()
    }

    /// What a scan sees of a sheet of this relative conductivity, `[element]` of [`Self::truth`]: phasors at
    /// unit current and conductivity, `[slot]`.
    #[must_use]
    pub fn solve(&self, table: &ScanTable, conductivity: &[f64]) -> Vec<Complex64> {
        self.truth.phasors(conductivity, &table.slots(), table.drive.frequency.into())
    }

    /// The same where wires have these faults. They depend on the current, as its source has an end.
    #[must_use]
    pub fn solve_wired(&self, table: &ScanTable, conductivity: &[f64], faults: &[Fault]) -> Vec<Complex64> {
        wiring::phasors(&self.truth, conductivity, table, self.sheet_conductivity, faults)
    }

    /// One scan of these phasors, with noise and converter; without number and time.
    pub fn read(&mut self, table: &ScanTable, phasors: &[Complex64]) -> Frame {
        let untouched = self.untouched_under(table);
        let volts = self.volts(table, phasors);
        untouched.read(&volts, &mut self.random)
    }

    /// So many scans of them whose noise follows from a number above zero: in any order, on many threads.
    #[must_use]
    pub fn read_numbered(
        &self,
        table: &ScanTable,
        phasors: &[Complex64],
        count: u16,
        number: u64,
    ) -> Vec<Frame> {
        let untouched = self.untouched_by(table);
        let volts = self.volts(table, phasors);
        let mut random = random(noise::seed_of(self.noise.seed, number));
        (0..count).map(|_| untouched.read(&volts, &mut random)).collect()
    }

    /// In-phase voltages under these presses: `[step]`, at unit current and conductivity.
    #[must_use]
    pub fn voltages(&self, steps: &[Step], presses: &[Press]) -> Vec<f64> {
        self.truth.voltages(&self.truth.conductivity(presses), steps)
    }

    /// The true skin.
    #[must_use]
    pub fn truth(&self) -> &TrueSkin {
        &self.truth
    }

    /// Other noise from now on, from its seed's first number.
    pub fn change_noise(&mut self, noise: Noise) {
        self.noise = noise;
        self.random = random(noise.seed);
        self.untouched = None;
    }

    /// Volts at the drive's current, turned by its phase: `[slot]`.
    fn volts(&self, table: &ScanTable, phasors: &[Complex64]) -> Vec<Complex64> {
        let amplitude = f64::from(table.drive.amplitude) / self.sheet_conductivity;
        let scale = Complex64::from_polar(amplitude, f64::from(table.drive.phase).to_radians());
        phasors.iter().map(|phasor| phasor * scale).collect()
    }

    fn phasors_at(&mut self, table: &ScanTable, script_time: Option<f64>) -> Vec<Complex64> {
        let is_there =
            |fault: &&TimedFault| fault.from.is_none_or(|from| script_time.is_some_and(|now| now >= from));
        let faults: Vec<_> = self.faults.iter().filter(is_there).map(|timed| timed.fault).collect();
        match self.conductivity(script_time) {
            conductivity if !faults.is_empty() => {
                let conductivity = conductivity.unwrap_or_else(|| self.truth.conductivity(&[]));
                self.solve_wired(table, &conductivity, &faults)
            }
            Some(conductivity) => self.solve(table, &conductivity),
            None => self.untouched_under(table).phasors,
        }
    }

    /// Relative conductivity of each element at a time of the script; `None` where it is all 1.
    fn conductivity(&mut self, script_time: Option<f64>) -> Option<Vec<f64>> {
        let now = |time| [self.script.presses(time), self.hand.presses()].concat();
        let presses = script_time.map(now).unwrap_or_default();
        match &mut self.worn {
            None => (!presses.is_empty()).then(|| self.truth.conductivity(&presses)),
            Some(worn) => Some(worn.conductivity(&self.truth, &presses, script_time?)),
        }
    }

    /// Voltages, gain and noise of a scan, found once, as a board finds its gains.
    fn untouched_under(&mut self, table: &ScanTable) -> Untouched {
        let untouched = self.untouched_by(table);
        self.untouched.insert(untouched).clone()
    }

    /// The same, found anew where it is not known.
    fn untouched_by(&self, table: &ScanTable) -> Untouched {
        if let Some(untouched) = self.untouched.as_ref().filter(|untouched| untouched.table == *table) {
            return untouched.clone();
        }
        let phasors = self.solve(table, &self.truth.conductivity(&[]));
        let steps = &phasors[..table.steps.len()];
        let ohms = |relative: f64| relative / self.sheet_conductivity;
        let integration = f64::from(self.drive.integration) / f64::from(table.drive.integration);
        let noise = ohms(noise::root_mean_square(steps.iter().map(|voltage| voltage.re)))
            * f64::from(self.drive.amplitude)
            * noise::share(self.noise.snr_db)
            * integration.sqrt();
        let largest_volts = ohms(largest(steps)) * f64::from(table.drive.amplitude);
        let converter = Converter::new(&self.front_end, table.drive.gain, largest_volts);
        Untouched { table: table.clone(), phasors, converter, noise }
    }
}

impl Untouched {
    /// One scan of these voltages, `[slot]`, with noise and converter; without number and time.
    fn read(&self, volts: &[Complex64], [of_images, of_others]: &mut [Pcg64Mcg; 2]) -> Frame {
        let normal = Normal::new(0.0, self.noise).expect("a standard deviation is finite and not negative");
        let mut frame = Frame::default();
        let (steps, tests) = volts.split_at(self.table.steps.len());
        for (step, &voltage) in steps.iter().enumerate() {
            let noise = Complex64::new(normal.sample(of_images), normal.sample(of_others));
            let reading = self.converter.read(voltage + noise);
            // A frame holds a code for each step that a patch may have.
            let _ = frame.codes.push(reading.part(self.table.drive.component));
            let _ = frame.quadrature.push(reading.imaginary);
            if reading.is_clipped {
                frame.clipped.insert(step);
            }
        }
        let at_gain_one = self.converter.with_gain(1.0);
        for &voltage in tests {
            let noise = Complex64::new(normal.sample(of_others), normal.sample(of_others));
            let reading = at_gain_one.read(voltage + noise);
            let _ = frame.tests.push(ElectrodeTest {
                in_phase: reading.real,
                quadrature: reading.imaginary,
                is_clipped: reading.is_clipped,
            });
        }
        frame
    }
}

impl Instrument for SimulatedSkin {
    fn scan(&mut self, table: &ScanTable, script_time: Option<f64>) -> Frame {
        let phasors = self.phasors_at(table, script_time);
        self.read(table, &phasors)
    }

    fn front_end(&self) -> Option<FrontEnd> {
        Some(self.front_end)
    }

    /// What the converter sees during one slot.
    fn samples(
        &mut self,
        table: &ScanTable,
        slot: u16,
        timing: Timing,
        script_time: Option<f64>,
    ) -> Option<SlotSamples> {
        let phasors = self.phasors_at(table, script_time);
        let untouched = self.untouched_under(table);
        let volts = self.volts(table, &phasors);
        let now = *volts.get(usize::from(slot))?;
        let before = volts[(usize::from(slot) + volts.len() - 1) % volts.len()];
        // The lock-in averages the noise of its samples.
        let noise = untouched.noise * (f64::from(timing.integration) / 2.0).sqrt();
        let normal = Normal::new(0.0, noise).ok()?;
        let mut noise = || normal.sample(&mut self.random[1]);
        let (gain, samples) =
            untouched.converter.samples([before, now], timing, table.drive.gain, &mut noise);
        let samples = samples.into_iter().take(MAX_SCOPE_SAMPLES).collect();
        Some(SlotSamples { slot, gain, settling: timing.settling, samples })
    }
}

/// Random numbers of what goes into images, and of all else.
fn random(seed: u64) -> [Pcg64Mcg; 2] {
    [seed, !seed].map(Pcg64Mcg::seed_from_u64)
}

fn largest(phasors: &[Complex64]) -> f64 {
    phasors.iter().fold(0.0, |max, phasor| max.max(phasor.norm()))
}
