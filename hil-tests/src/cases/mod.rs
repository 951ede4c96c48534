//! Cases: what a board with our firmware must do. Each sees a rig and nothing else.

mod bus;
mod can;
mod crash;
mod line;
mod log;
mod pipeline;
mod power;
mod sensing;
mod upload;
mod usb;

pub use power::{Found, cut_full_size};
pub use sensing::{Soaked, soak};

use crate::machine::Halt;
use crate::rig::{Capability, Rig, RigError};
use dermatome::{
    link::{self, Link, LinkError, ScanFrame, Subscription, UploadError},
    simulate::port::OpenError,
};
use dermatome_shared::{patch::PatchView, protocol::FrameStamp, restart::Restart};
use std::{thread, time::Duration};

/// Longest that a case waits for something, in the host's time.
const TIMEOUT: Duration = Duration::from_secs(60);

/// One case.
#[derive(Clone, Copy)]
pub struct Case {
    /// What it shows, as a sentence.
    pub name: &'static str,
    /// What the rig must be able to do.
    pub needs: &'static [Capability],
    /// Runs it; gives what was measured, if anything was.
    pub run: fn(&Rig) -> Result<String, Failure>,
}

/// Why a case failed.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// The board did something else than it must.
    #[error("{0}")]
    Wrong(String),
    /// The link failed.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// The board cannot be reached.
    #[error(transparent)]
    Open(#[from] OpenError),
    /// An upload failed.
    #[error(transparent)]
    Upload(#[from] UploadError),
    /// The emulated board cannot go on.
    #[error(transparent)]
    Halt(#[from] Halt),
    /// There is no board.
    #[error(transparent)]
    Rig(#[from] RigError),
}

impl Failure {
    /// Something that has no variant of its own went wrong.
    fn wrong(what: impl Into<Box<dyn std::error::Error>>) -> Self {
        Self::Wrong(what.into().to_string())
    }
}

/// Those of boards on one line.
#[must_use]
pub fn on_a_bus() -> Vec<Case> {
    bus::CASES.to_vec()
}

/// Those of boards on one CAN bus.
#[must_use]
pub fn on_can() -> Vec<Case> {
    can::CASES.to_vec()
}

/// Those of a board on USB.
#[must_use]
pub fn on_usb() -> Vec<Case> {
    usb::CASES.to_vec()
}

/// All cases of one board, in the order in which they run.
#[must_use]
pub fn all() -> Vec<Case> {
    // Those that take longest first, so that the cores that share them end together.
    [line::CASES, power::CASES, pipeline::CASES, sensing::CASES, upload::CASES, crash::CASES, log::CASES]
        .concat()
}

/// The case fails unless this is so.
fn ensure(is_so: bool, otherwise: impl FnOnce() -> String) -> Result<(), Failure> {
    if is_so { Ok(()) } else { Err(Failure::Wrong(otherwise())) }
}

/// The next frame; silence is a failure.
fn next_frame(stream: &mut Subscription<'_>) -> Result<ScanFrame, Failure> {
    stream.next(TIMEOUT)?.ok_or_else(|| Failure::wrong("no frame comes any more"))
}

/// Of the next frame that has it, what `part` takes; and that frame's stamp.
fn next_with<T>(
    stream: &mut Subscription<'_>,
    mut part: impl FnMut(ScanFrame) -> Option<T>,
) -> Result<(FrameStamp, T), Failure> {
    for _ in 0..100_000 {
        let frame = next_frame(stream)?;
        if let Some(found) = frame.at.zip(part(frame)) {
            return Ok(found);
        }
    }
    Err(Failure::wrong("the frame that was waited for does not come"))
}

/// No event is lost.
fn ensure_complete(stream: &mut Subscription<'_>) -> Result<(), Failure> {
    let lost = stream.link().events_lost();
    ensure(lost == 0, || format!("{lost} events are lost"))
}

/// The board answers, and has been up since it was started like this.
fn ensure_up(link: &mut Link, started_after: &Restart) -> Result<(), Failure> {
    let info = link.info()?;
    ensure(info.started_after == *started_after, || format!("it started after {:?}", info.started_after))
}

/// All boards at these addresses take patches at once, each another one: no request and no reply is taken for another
/// board's.
fn ensure_uploads_at_once(
    addresses: [u8; 4],
    link: impl Fn(u8) -> Result<Link, LinkError> + Sync,
) -> Result<(), Failure> {
    let patches = [0, 1, 2, 3].map(|seed| patches::patch(36, true, 20 + seed));
    let upload = |address: u8, patch: &[u8]| -> Result<(), Failure> {
        link::upload(&mut link(address)?, patch, |_| ())?;
        Ok(())
    };
    thread::scope(|scope| {
        let uploads: Vec<_> = addresses
            .into_iter()
            .zip(&patches)
            .map(|(address, patch)| {
                let upload = &upload;
                scope.spawn(move || upload(address, patch))
            })
            .collect();
        uploads.into_iter().try_for_each(|upload| upload.join().expect("an upload panicked"))
    })?;
    for (address, patch) in addresses.into_iter().zip(&patches) {
        let held = link(address)?.info()?.patch.map(|patch| patch.crc);
        let sent = PatchView::open(patch).map_err(Failure::wrong)?.crc();
        ensure(held == Some(sent), || format!("address {address} holds {held:x?}, not {sent:08x}"))?;
    }
    Ok(())
}

/// Patches for cases.
mod patches {
    use super::Failure;
    use dermatome::{model::Model, patch::matrix::FixedMatrix, quantize, skin::Skin};
    use dermatome_shared::{
        MAX_PATCH_BYTES,
        calibration::Calibration,
        drive::Drive,
        image::{Geometry, PixelGrid},
        patch::{
            CombinedInto, Difference, PatchContents, PatchHeader, PatchView,
            matrix::{MOST_OF_ROW, MatrixLayout},
            reflexes::ReflexTables,
        },
        stimulation::{Driven, Step, pattern},
        units::RelativeConductivity,
    };
    use rand::{Rng, SeedableRng, seq::SliceRandom};
    use rand_pcg::Pcg64;
    use std::{ops::Range, path::Path};

    /// Cells on each side of the grid.
    const SIDE: u8 = 32;

    /// A valid patch of 16 electrodes with the first `pixels` of 32 x 32 pixels and 208 measurements
    /// (104 if `combined`), all else random.
    pub(super) fn patch(pixels: usize, combined: bool, seed: u64) -> Vec<u8> {
        with(pixels, combined, seed, 14..18, pixels.div_ceil(3))
    }

    /// The same as large as can be: all pixels come from the data.
    pub(super) fn large(pixels: usize, seed: u64) -> Vec<u8> {
        with(pixels, true, seed, 14..18, pixels)
    }

    /// A patch with rows of these exponents, of which small ones make values that saturate, and so many pixels from data.
    pub(super) fn with(
        pixels: usize,
        combined: bool,
        seed: u64,
        exponents: Range<i8>,
        from_data: usize,
    ) -> Vec<u8> {
        let mut random = Pcg64::seed_from_u64(seed);
        let steps: Vec<Step> = pattern(16, 1, 1, Driven::Skipped).collect();
        let combination = if combined { reciprocal(&steps) } else { each(steps.len()) };
        let measurements = if combined { steps.len() / 2 } else { steps.len() };
        let grid = PixelGrid { columns: SIDE, rows: SIDE, pitch: 0.005, left: -0.1, top: 0.1 };
        let geometry = Geometry::first_cells(grid, pixels);
        let (places, neighbours) = geometry.tables();
        let header = PatchHeader {
            skin: "random".try_into().unwrap_or_default(),
            electrodes: 16,
            steps: steps.len() as u16,
            measurements: measurements as u16,
            pixels: pixels as u16,
            difference: if random.random() { Difference::Plain } else { Difference::Normalised },
            neighbours: neighbours.len() as u16,
            surface: geometry.scale(),
            grid: Some(grid),
            drive: Drive::new(50e3, 1e-3, 100.0),
            contact_threshold: RelativeConductivity(1 << 14),
            drift_time: 0.0,
            calibration: Calibration::default(),
            test_resistances: Default::default(),
            play_operators: 0,
            reflexes: 0,
            reflex_rows: 0,
            matrix: MatrixLayout::default(),
            detection: Default::default(),
        };
        let exponents = (0..from_data).map(|_| random.random_range(exponents.clone())).collect();
        let matrix = matrix(&mut random, pixels, measurements, exponents);
        let header = PatchHeader { matrix: matrix.tables().layout(), ..header };
        let contents = PatchContents {
            play_operators: &[],
            reflexes: ReflexTables::default(),
            header: &header,
            steps: &steps,
            combination: &combination,
            pixels: &places,
            neighbours: &neighbours,
            matrix: matrix.tables(),
            places: Default::default(),
        };
        let mut bytes = vec![0; MAX_PATCH_BYTES];
        let length = contents.write(&mut bytes).expect("a patch of this size fits");
        bytes.truncate(length);
        PatchView::validate(&bytes).expect("the patch is valid");
        bytes
    }

    /// That of a skin in `models/`.
    pub(super) fn shipped(name: &str) -> Result<Vec<u8>, Failure> {
        let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
        let skin = Skin::load(&models.join(name).join("skin.toml")).map_err(Failure::wrong)?;
        let skin = skin.made().map_err(Failure::wrong)?;
        let model = Model::build(&skin, |_| ()).map_err(Failure::wrong)?;
        quantize::patch(&skin, &model).map_err(Failure::wrong)
    }

    /// Pixels from the data, one for each exponent, and the others interpolated, some from interpolated ones, in any
    /// order.
    fn matrix(random: &mut Pcg64, pixels: usize, measurements: usize, exponents: Vec<i8>) -> FixedMatrix {
        let mut mantissas = |count: usize, largest: i16| -> Vec<i16> {
            (0..count).map(|_| random.random_range(-largest..=largest)).collect()
        };
        let from_data = exponents.len();
        let rows = mantissas(from_data * measurements, 32_767);
        let mut steps = Vec::new();
        let mut known = from_data;
        while known < pixels {
            let (outputs, inputs) = ((pixels - known).min(5 + known % 40), known.min(4 + known % 70));
            steps.push((
                known,
                inputs,
                mantissas(outputs * inputs, (MOST_OF_ROW as usize / inputs).min(32_767) as i16),
            ));
            known += outputs;
        }
        let columns = (0..measurements).map(|_| random.random_range(-9..=9)).collect();
        let mut matrix = FixedMatrix::from_data(columns, exponents, &rows);
        for (known, inputs, rows) in steps {
            let inputs: Vec<u16> = (0..inputs).map(|_| random.random_range(0..known as u16)).collect();
            matrix.interpolate(&inputs, &rows);
        }
        let mut order: Vec<usize> = (0..pixels).collect();
        order.shuffle(random);
        matrix.in_order(&order)
    }

    fn each(steps: usize) -> Vec<CombinedInto> {
        (0..steps).map(|step| CombinedInto { measurement: step as u16, flipped: false }).collect()
    }

    /// Steps with drive and sense exchanged go together, subtracted where one pair is turned round.
    fn reciprocal(steps: &[Step]) -> Vec<CombinedInto> {
        let mut targets: Vec<CombinedInto> = Vec::new();
        let mut measurements = 0;
        for (place, step) in steps.iter().enumerate() {
            let exchanged = |other: &Step| {
                let [a, b, c, d] = other.to_bytes();
                let plus = [[c, d, a, b], [d, c, b, a]].contains(&step.to_bytes());
                let minus = [[d, c, a, b], [c, d, b, a]].contains(&step.to_bytes());
                (plus || minus).then_some(minus)
            };
            let first =
                steps[..place].iter().enumerate().find_map(|(first, other)| Some((first, exchanged(other)?)));
            let target = match first {
                Some((first, flipped)) => CombinedInto { flipped, ..targets[first] },
                None => {
                    measurements += 1;
                    CombinedInto { measurement: measurements - 1, flipped: false }
                }
            };
            targets.push(target);
        }
        targets
    }
}
