//! Handle: what is done to the skin and to the front end while the emulated board measures, and what is true there.

use super::{
    error::WorldError,
    expected::{Carrier, Response},
    fault::{Fault, stuck},
    multiplexers::selected,
    network::{MINUS, Network, PLUS},
    parameters::Analogue,
    skin::{LEADS, SkinNetwork, Touch, ring},
};
use crate::chip::time::Time;
use dermatome::{
    simulate::{Press, Script, ScriptedSheet, material::Material},
    skin::Skin,
};
use num_complex::Complex64;
use std::sync::{
    Arc, Mutex, MutexGuard, PoisonError,
    atomic::{AtomicU64, Ordering},
};

/// Drift changes the sheet in steps of this share.
const DRIFT_STEP: f64 = 1e-4;
/// A script moves its fingers this often.
const SCRIPT_STEP: Time = Time::from_millis(50);
/// Multiplexers that are off for longer are not between two words of a scan.
const PAUSE: Time = Time::from_millis(1);
/// A sheet does not drift beyond these shares of its conductivity.
const DRIFT_RANGE: [f64; 2] = [0.05, 20.0];

/// What an analogue world is made of. Clones share the skin's mesh, so that many boards are cheap.
#[derive(Clone, Debug)]
pub struct Setup {
    /// The skin.
    pub skin: Arc<Skin>,
    /// The front end.
    pub analogue: Analogue,
    /// Capacitance beside the resistance of each contact, F per metre of electrode.
    pub contact_capacitance: f64,
    /// Seed of noise and of differences between switches.
    pub seed: u64,
    /// Whether there is noise from the start.
    pub noise: bool,
    network: Arc<SkinNetwork>,
}

impl Setup {
    /// A skin, which is meshed now, behind a front end, with noise.
    pub fn new(
        skin: Skin,
        analogue: Analogue,
        contact_capacitance: f64,
        seed: u64,
    ) -> Result<Self, WorldError> {
        let electrodes = skin.electrodes.count;
        if usize::from(electrodes) > LEADS {
            return Err(WorldError::Electrodes { name: skin.name, electrodes });
        }
        let network = skin_at(&skin, contact_capacitance, skin.drive.frequency, 0.0)?;
        Ok(Self { skin: Arc::new(skin), analogue, contact_capacitance, seed, noise: true, network })
    }

    /// The front end of the board of that number, drawn from the parts' tolerances, before the same skin.
    #[must_use]
    pub fn drawn(&self, number: u64) -> Self {
        Self { analogue: self.analogue.drawn(number), seed: number, ..self.clone() }
    }

    /// The same front end before another skin.
    pub fn with_skin(&self, skin: Skin) -> Result<Self, WorldError> {
        let other = Self::new(skin, self.analogue.clone(), self.contact_capacitance, self.seed)?;
        Ok(Self { noise: self.noise, ..other })
    }
}

/// A handle; all its clones mean the same world.
#[derive(Clone, Debug)]
pub struct WorldHandle(Arc<Shared>);

#[derive(Debug)]
struct Shared {
    setup: Arc<Setup>,
    /// Counts changes.
    version: AtomicU64,
    state: Mutex<State>,
    network: Mutex<Option<(u64, Arc<Network>)>>,
    drive: Mutex<DriveRecord>,
}

/// What the DAC has put out since this was taken last.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DriveRecord {
    /// Times at which its code changed.
    pub changes: u64,
    /// Code less 2048, half the range, over time: s.
    pub area: f64,
    /// Time covered, s.
    pub time: f64,
    /// Largest difference from one code to the next.
    pub largest_step: u16,
    /// Whether the multiplexers were enabled at any time.
    pub enabled: bool,
    /// Whether the source's range began or ended to change while they were.
    pub ranged_while_enabled: bool,
    /// Largest current of the source, of its full one, when they were enabled after a pause of a millisecond.
    pub first_current: f64,
    enabled_now: bool,
    disabled_at: Time,
    last: Option<(u16, Time)>,
}

impl DriveRecord {
    fn add(&mut self, code: u16, at: Time) {
        let (before, since) = self.last.replace((code, at)).unwrap_or((code, at));
        let time = at.since(since).seconds();
        self.changes += 1;
        self.area += (f64::from(before) - 2048.0) * time;
        self.time += time;
        self.largest_step = self.largest_step.max(code.abs_diff(before));
    }
}

#[derive(Debug)]
struct State {
    conditions: Conditions,
    skin: Arc<SkinNetwork>,
    frequency: f64,
    /// By which share the skin is longer along x than it was made.
    stretch: f64,
    drift: Drift,
    /// The sheet's, so that pressures and forces change it.
    material: Option<Material>,
    script: Option<Playing>,
    now: Time,
}

/// A script and the sheet that it presses.
#[derive(Debug)]
struct Playing {
    script: Script,
    since: Time,
    sheet: Option<ScriptedSheet>,
    /// Step that the fingers are at.
    step: Option<u64>,
}

/// How things are.
#[derive(Clone, Debug, PartialEq)]
pub struct Conditions {
    /// Fingers on the skin.
    pub touch: Touch,
    /// Conductivity of the sheet over the skin file's.
    pub scale: f64,
    /// Noise, over that of the parts.
    pub noise: f64,
    /// Temperature of the chip, degrees Celsius.
    pub temperature: f64,
    /// What is broken.
    pub faults: Vec<Fault>,
    /// Resistors between neighbouring leads, ohm, in place of the skin and its leads.
    pub plug: Option<[f64; LEADS]>,
    /// Whether the current source is in its small range.
    pub in_small_range: bool,
}

#[derive(Clone, Copy, Debug)]
struct Drift {
    per_minute: f64,
    since: Time,
    from: f64,
}

impl WorldHandle {
    /// A world without fingers or faults.
    #[must_use]
    pub fn new(setup: impl Into<Arc<Setup>>) -> Self {
        let setup = setup.into();
        let conditions = Conditions {
            touch: Touch::default(),
            scale: 1.0,
            noise: f64::from(u8::from(setup.noise)),
            temperature: 30.0,
            faults: Vec::new(),
            plug: None,
            in_small_range: true,
        };
        let state = State {
            conditions,
            skin: setup.network.clone(),
            frequency: setup.skin.drive.frequency,
            stretch: 0.0,
            drift: Drift { per_minute: 0.0, since: Time::ZERO, from: 1.0 },
            material: None,
            script: None,
            now: Time::ZERO,
        };
        let (version, state) = (AtomicU64::new(1), Mutex::new(state));
        Self(Arc::new(Shared { setup, version, state, network: Mutex::default(), drive: Mutex::default() }))
    }

    /// What it is made of.
    #[must_use]
    pub fn setup(&self) -> &Setup {
        &self.0.setup
    }

    /// How things are.
    #[must_use]
    pub fn conditions(&self) -> Conditions {
        self.state().conditions.clone()
    }

    /// These fingers, and no others, press the skin from now on.
    pub fn press(&self, presses: &[Press]) {
        self.change(|state| {
            state.script = None;
            state.conditions.touch = Touch { presses: presses.to_vec(), conductivity: None };
        });
    }

    /// Fingers follow a script from now on, on a sheet that was never pressed.
    pub fn run_script(&self, script: Script) {
        self.change(|state| {
            let sheet =
                state.material.clone().map(|material| ScriptedSheet::new(material, self.0.setup.seed));
            state.script = Some(Playing { script, since: state.now, sheet, step: None });
            state.play();
        });
    }

    /// Makes the sheet of a material, so that pressures and forces of the scripts that follow change it.
    pub fn set_material(&self, material: Material) {
        self.change(|state| state.material = Some(material));
    }

    /// From now on the sheet's conductivity grows by this share of the skin file's in each minute.
    pub fn drift(&self, per_minute: f64) {
        self.change(|state| {
            state.drift = Drift { per_minute, since: state.now, from: state.conditions.scale };
        });
    }

    /// Makes the noise so many times that of the parts; 0 for none.
    pub fn noise(&self, times: f64) {
        self.change(|state| state.conditions.noise = times);
    }

    /// The chip's temperature, degrees Celsius.
    pub fn temperature(&self, celsius: f64) {
        self.change(|state| state.conditions.temperature = celsius);
    }

    /// Something breaks, as well as what is broken already.
    pub fn inject(&self, fault: Fault) -> Result<(), WorldError> {
        fault.check()?;
        self.change(|state| state.conditions.faults.push(fault));
        Ok(())
    }

    /// Resistors in a ring, ohm, take the place of the skin and its leads; `[lead]` is between that one and the next.
    pub fn plug(&self, ohms: Option<[f64; LEADS]>) {
        self.change(|state| state.conditions.plug = ohms);
    }

    /// The current source is in its small range, or in its large one.
    pub fn set_small_range(&self, is_small: bool) {
        if self.conditions().in_small_range != is_small {
            self.change(|state| state.conditions.in_small_range = is_small);
        }
    }

    /// The front end, with the source in the range in which it is.
    pub(super) fn analogue(&self) -> Analogue {
        self.0.setup.analogue.in_range(self.conditions().in_small_range)
    }

    /// Everything is mended.
    pub fn mend(&self) {
        self.change(|state| state.conditions.faults.clear());
    }

    /// Carrier's frequency, Hz, at which capacitance of sheet and contacts is taken; the skin file's unless
    /// somebody says otherwise.
    pub fn set_frequency(&self, frequency: f64) -> Result<(), WorldError> {
        if !(1e3..=1e6).contains(&frequency) {
            let (value, allowed) = (format!("{frequency} Hz"), "1e3 to 1e6 Hz".to_owned());
            return Err(WorldError::Value { field: "frequency", value, allowed });
        }
        let stretch = self.state().stretch;
        self.lay_out(frequency, stretch)
    }

    /// The skin, with its electrodes, is longer along x by this share from now on; 0 for as it was made.
    pub fn stretch(&self, by: f64) -> Result<(), WorldError> {
        let frequency = self.frequency();
        self.lay_out(frequency, by)
    }

    fn lay_out(&self, frequency: f64, stretch: f64) -> Result<(), WorldError> {
        let setup = &self.0.setup;
        let skin = skin_at(&setup.skin, setup.contact_capacitance, frequency, stretch)?;
        self.change(|state| (state.skin, state.frequency, state.stretch) = (skin, frequency, stretch));
        Ok(())
    }

    /// Carrier's frequency, Hz.
    #[must_use]
    pub fn frequency(&self) -> f64 {
        self.state().frequency
    }

    /// Voltage between the amplifier's inputs per ampere of the current source at the carrier's frequency,
    /// with this word at the multiplexers: skin, contacts, switches, strays, faults; ohm.
    #[must_use]
    pub fn truth(&self, word: u16) -> Complex64 {
        let word = stuck(word, &self.conditions().faults);
        let voltages = self.network().phasors(selected(word), self.frequency());
        voltages[PLUS] - voltages[MINUS]
    }

    /// The same for the skin alone: nothing but its forward model, no stray and no fault.
    #[must_use]
    pub fn skin_truth(&self, word: u16) -> Complex64 {
        let (skin, conditions) = {
            let state = self.state();
            (state.skin.clone(), state.conditions.clone())
        };
        skin.transfer(&conditions.touch, conditions.scale, selected(word))
    }

    /// What a lock-in finds at the converter, V: twice the mean of samples times e^(-j omega t), t counted
    /// from the first word of the DAC's table. No noise, no limits.
    #[must_use]
    pub fn expected(&self, word: u16, gain: f64, carrier: &Carrier) -> Complex64 {
        self.response(word, carrier).demodulated(&self.analogue(), gain, carrier)
    }

    /// What the circuit makes of a carrier, whatever its amplitude and the gain.
    #[must_use]
    pub fn response(&self, word: u16, carrier: &Carrier) -> Response {
        let word = stuck(word, &self.conditions().faults);
        Response::new(&self.network(), &self.analogue(), word, carrier)
    }

    /// What the DAC has put out since this was taken last.
    pub fn take_drive_record(&self) -> DriveRecord {
        let mut record = self.0.drive.lock().unwrap_or_else(PoisonError::into_inner);
        let DriveRecord { last, enabled_now, disabled_at, .. } = *record;
        let next =
            DriveRecord { last, enabled_now, disabled_at, enabled: enabled_now, ..DriveRecord::default() };
        std::mem::replace(&mut *record, next)
    }

    /// The multiplexers are enabled, or not; `current` is the source's, of its full one.
    pub(super) fn record_enable(&self, enabled: bool, current: f64, at: Time) {
        let mut record = self.0.drive.lock().unwrap_or_else(PoisonError::into_inner);
        if enabled && !record.enabled_now && at >= record.disabled_at + PAUSE {
            record.first_current = record.first_current.max(current.abs());
        }
        if record.enabled_now && !enabled {
            record.disabled_at = at;
        }
        record.enabled_now = enabled;
        record.enabled |= enabled;
    }

    /// The switch of the source's range begins or ends to move.
    pub(super) fn record_range(&self) {
        let mut record = self.0.drive.lock().unwrap_or_else(PoisonError::into_inner);
        record.ranged_while_enabled |= record.enabled_now;
    }

    /// The DAC puts out a code.
    pub(super) fn record(&self, code: u16, at: Time) {
        self.0.drive.lock().unwrap_or_else(PoisonError::into_inner).add(code, at);
    }

    /// Counts changes; a world that has seen this number is up to date.
    pub(super) fn version(&self) -> u64 {
        self.0.version.load(Ordering::Acquire)
    }

    /// The network of how things are.
    pub(super) fn network(&self) -> Arc<Network> {
        let version = self.version();
        let mut latest = self.0.network.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((known, network)) = latest.as_ref()
            && *known == version
        {
            return network.clone();
        }
        let (skin, conditions, frequency) = {
            let state = self.state();
            (state.skin.clone(), state.conditions.clone(), state.frequency)
        };
        let setup = &self.0.setup;
        let faults = &conditions.faults;
        let analogue = setup.analogue.in_range(conditions.in_small_range);
        let network = if let Some(ohms) = conditions.plug {
            let analogue = analogue.without_leads();
            Network::new(&analogue, &ring(&ohms), faults, frequency, setup.seed)
        } else {
            let admittance = skin.admittance(&conditions.touch, conditions.scale);
            Network::new(&analogue, &admittance, faults, frequency, setup.seed)
        };
        let network = Arc::new(network);
        *latest = Some((version, network.clone()));
        network
    }

    /// Time has come so far: drift and script go on.
    pub(super) fn pass(&self, now: Time) {
        let mut state = self.state();
        state.now = now;
        let (scale, moves) = (state.drifted(), state.play());
        let drifts = scale != state.conditions.scale;
        state.conditions.scale = scale;
        if drifts || moves {
            self.0.version.fetch_add(1, Ordering::AcqRel);
        }
    }

    fn change(&self, change: impl FnOnce(&mut State)) {
        let mut state = self.state();
        change(&mut state);
        self.0.version.fetch_add(1, Ordering::AcqRel);
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.0.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl State {
    fn drifted(&self) -> f64 {
        if self.drift.per_minute == 0.0 {
            return self.conditions.scale;
        }
        let minutes = self.now.since(self.drift.since).seconds() / 60.0;
        let scale = self.drift.from + self.drift.per_minute * minutes;
        let [low, high] = DRIFT_RANGE;
        ((scale / DRIFT_STEP).round() * DRIFT_STEP).clamp(low, high)
    }

    /// Takes the fingers to where the script has them by now; says whether anything changed.
    fn play(&mut self) -> bool {
        let Some(Playing { script, since, sheet, step }) = &mut self.script else { return false };
        let now = self.now.since(*since).periods(SCRIPT_STEP);
        if step.replace(now) == Some(now) {
            return false;
        }
        let time = (SCRIPT_STEP * now).seconds();
        let presses = script.presses(time);
        let touch = match sheet {
            Some(sheet) => self.skin.touch(sheet, presses, time),
            None => Touch { presses, conductivity: None },
        };
        let changed = touch != self.conditions.touch;
        self.conditions.touch = touch;
        changed
    }
}

fn skin_at(
    skin: &Skin,
    capacitance: f64,
    frequency: f64,
    stretch: f64,
) -> Result<Arc<SkinNetwork>, WorldError> {
    let network = SkinNetwork::new(skin, capacitance, frequency, stretch);
    network.map(Arc::new).map_err(|error| WorldError::Skin { name: skin.name.clone(), error })
}
