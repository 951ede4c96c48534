//! Order of a file's measurements: which of them belongs to which step of the model.
//!
//! A file may number its electrodes from another one, or the other way round, and list the sense
//! pairs of each drive in another order. An [`Arrangement`] says how; its index map finds for each
//! step of the model the file's measurement.

use dermatome_shared::stimulation::Step;
use serde::Serialize;
use std::collections::{HashMap, HashSet, VecDeque};

/// Order of the sense pairs inside each drive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum SenseOrder {
    /// By electrode number, as in EIDORS: the canonical order.
    #[default]
    Absolute,
    /// From the electrode where current leaves, and round from there, as with EIDORS' `rotate_meas`: a frame of the
    /// pattern's steps begins each drive with the first pair behind that electrode which the pattern measures, a full
    /// square with the one that begins at that electrode.
    Relative,
}

/// How a file's electrodes and measurements map onto the model's.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize)]
pub struct Arrangement {
    /// Order in which the file lists the sense pairs of a drive.
    #[serde(rename = "order")]
    pub sense: SenseOrder,
    /// Electrode of the model that is the file's electrode 0.
    pub rotation: u8,
    /// Whether the file's electrode numbers run the other way round.
    pub mirrored: bool,
}

/// Where a step's measurement lies in a frame of the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FileIndex {
    /// Index of the measurement.
    pub index: usize,
    /// Whether the file's pairs give the opposite sign of the model's step.
    pub flipped: bool,
}

/// Why a file's measurements cannot be mapped onto the model's steps.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum OrderError {
    /// Frames of the wrong length.
    #[error(
        "frames hold {found} measurements each; for this skin allowed are {steps} (its drive pattern) \
         and {square} (every drive with every sense pair)"
    )]
    Length {
        /// Measurements in a frame of the file.
        found: usize,
        /// Steps of the model.
        steps: usize,
        /// Electrodes squared.
        square: usize,
    },
    /// A rotation by more than once round.
    #[error("rotation is {rotation}, allowed are 0 to {}", electrodes.saturating_sub(1))]
    Rotation {
        /// The rotation asked for.
        rotation: u8,
        /// Electrodes of the model.
        electrodes: u8,
    },
    /// A step of the model that no electrodes can do.
    #[error("step {step} of the skin does not name pairs of two different electrodes below {electrodes}")]
    Step {
        /// Index of the step.
        step: usize,
        /// Electrodes of the model.
        electrodes: u8,
    },
    /// A drive pattern that does not look the same from every electrode.
    #[error(
        "the skin's drive pattern is not the same from every electrode: turned by {arrangement:?} it \
         lacks step {step}"
    )]
    NotCyclic {
        /// Index of the step.
        step: usize,
        /// The arrangement.
        arrangement: Arrangement,
    },
    /// Two steps that would lie in the same place of a square.
    #[error("step {step} has the drive and the sense electrode of another step: a full square is ambiguous")]
    SharedPlace {
        /// Index of the step.
        step: usize,
    },
}

impl Arrangement {
    /// Every arrangement of a skin with so many electrodes.
    pub fn all(electrodes: u8) -> impl Iterator<Item = Self> {
        [SenseOrder::Absolute, SenseOrder::Relative].into_iter().flat_map(move |sense| {
            (0..electrodes)
                .flat_map(move |rotation| [false, true].map(|mirrored| Self { sense, rotation, mirrored }))
        })
    }

    /// For each step of the model the file's measurement: `[step]`, no index twice.
    ///
    /// Files hold either the model's steps, or the full square `[drive][sense]` of all electrodes, in
    /// which row k is the drive whose current leaves at electrode k; of that, pairs that touch a
    /// driven electrode are dropped.
    pub fn index_map(
        &self,
        steps: &[Step],
        electrodes: u8,
        file_measurements: usize,
    ) -> Result<Vec<FileIndex>, OrderError> {
        let indices = self.file_indices(steps, electrodes, file_measurements)?;
        let mut file = FileSteps::new(self, steps, electrodes, &indices);
        let find = |(step, pairs): (usize, &Step)| {
            file.take(*pairs).ok_or(OrderError::NotCyclic { step, arrangement: *self })
        };
        steps.iter().enumerate().map(find).collect()
    }

    /// The model's number of a file's electrode.
    pub(super) fn on_model(&self, electrode: u8, electrodes: u8) -> u8 {
        let (k, n) = (u16::from(electrode), u16::from(electrodes));
        let k = if self.mirrored { n - k } else { k };
        ((k + u16::from(self.rotation)) % n) as u8
    }

    /// Where each of the file's own steps lies: `[step, in the file's electrode numbers]`.
    pub(super) fn file_indices(
        &self,
        steps: &[Step],
        electrodes: u8,
        found: usize,
    ) -> Result<Vec<usize>, OrderError> {
        if self.rotation >= electrodes {
            return Err(OrderError::Rotation { rotation: self.rotation, electrodes });
        }
        if let Some(step) = steps.iter().position(|step| !step.is_valid(electrodes)) {
            return Err(OrderError::Step { step, electrodes });
        }
        let square = usize::from(electrodes) * usize::from(electrodes);
        match self.sense {
            _ if found != steps.len() && found != square => {
                Err(OrderError::Length { found, steps: steps.len(), square })
            }
            SenseOrder::Absolute if found == steps.len() => Ok((0..found).collect()),
            SenseOrder::Relative if found == steps.len() => Ok(relative_indices(steps, electrodes)),
            sense => square_indices(steps, electrodes, sense),
        }
    }
}

/// The file's steps by the model's electrode numbers, each handed out once.
struct FileSteps {
    indices: HashMap<[u8; 4], VecDeque<usize>>,
}

impl FileSteps {
    fn new(arrangement: &Arrangement, steps: &[Step], electrodes: u8, indices: &[usize]) -> Self {
        let mut by_pairs: HashMap<_, VecDeque<usize>> = HashMap::new();
        for (step, &index) in steps.iter().zip(indices) {
            let pairs = step.to_bytes().map(|electrode| arrangement.on_model(electrode, electrodes));
            by_pairs.entry(pairs).or_default().push_back(index);
        }
        Self { indices: by_pairs }
    }

    /// The measurement between the same pairs, preferably driven in the same direction: an opposite
    /// pattern drives each pair both ways.
    fn take(&mut self, step: Step) -> Option<FileIndex> {
        let [a, b, c, d] = step.to_bytes();
        let directions =
            [([a, b, c, d], false), ([a, b, d, c], true), ([b, a, d, c], false), ([b, a, c, d], true)];
        directions.into_iter().find_map(|(pairs, flipped)| {
            let index = self.indices.get_mut(&pairs)?.pop_front()?;
            Some(FileIndex { index, flipped })
        })
    }
}

/// Electrodes from the one where current leaves to the sense pair's first, going round.
fn offset(step: &Step, electrodes: u8) -> u8 {
    let ahead = u16::from(step.sense_plus) + u16::from(electrodes) - u16::from(step.drive_minus);
    (ahead % u16::from(electrodes)) as u8
}

fn relative_indices(steps: &[Step], electrodes: u8) -> Vec<usize> {
    let mut by_offset: Vec<usize> = Vec::with_capacity(steps.len());
    for drive in drives(steps) {
        let start = by_offset.len();
        by_offset.extend(start..start + drive.len());
        by_offset[start..].sort_by_key(|&step| offset(&steps[step], electrodes));
    }
    let mut indices = vec![0; steps.len()];
    for (index, &step) in by_offset.iter().enumerate() {
        indices[step] = index;
    }
    indices
}

fn square_indices(steps: &[Step], electrodes: u8, sense: SenseOrder) -> Result<Vec<usize>, OrderError> {
    let mut indices = Vec::with_capacity(steps.len());
    let mut taken = HashSet::with_capacity(steps.len());
    for drive in drives(steps) {
        for step in drive {
            let column = match sense {
                SenseOrder::Absolute => step.sense_plus,
                SenseOrder::Relative => offset(step, electrodes),
            };
            let index = usize::from(step.drive_minus) * usize::from(electrodes) + usize::from(column);
            if !taken.insert(index) {
                return Err(OrderError::SharedPlace { step: indices.len() });
            }
            indices.push(index);
        }
    }
    Ok(indices)
}

/// Runs of steps with the same drive.
fn drives(steps: &[Step]) -> impl Iterator<Item = &[Step]> {
    steps.chunk_by(|a, b| a.drive_plus == b.drive_plus && a.drive_minus == b.drive_minus)
}

#[cfg(test)]
mod tests {
    use super::*;
    use dermatome_shared::stimulation::{Driven, pattern};
    use proptest::prelude::*;

    fn adjacent() -> Vec<Step> {
        pattern(16, 1, 1, Driven::Skipped).collect()
    }

    fn arrangement(relative: bool, rotation: u8, mirrored: bool) -> Arrangement {
        let sense = if relative { SenseOrder::Relative } else { SenseOrder::Absolute };
        Arrangement { sense, rotation, mirrored }
    }

    #[test]
    fn canonical_files_keep_their_order() {
        let map = Arrangement::default().index_map(&adjacent(), 16, 208).unwrap();
        assert!(
            map.iter().enumerate().all(|(step, found)| *found == FileIndex { index: step, flipped: false })
        );
    }

    #[test]
    fn a_full_square_drops_the_driven_pairs() {
        let map = Arrangement::default().index_map(&adjacent(), 16, 256).unwrap();
        // Drive 0 uses electrodes 0 and 1: pairs 15, 0 and 1 touch them.
        assert_eq!(map[..3].iter().map(|found| found.index).collect::<Vec<_>>(), [2, 3, 4]);
        assert_eq!(map[13].index, 16 + 3);
        let relative = arrangement(true, 0, false).index_map(&adjacent(), 16, 256).unwrap();
        assert_eq!(relative[0].index, 2);
        // Drive 3 (4 to 3): pair 3 itself comes first, pair 0 after 12 others.
        let step = adjacent().iter().position(|s| s.drive_minus == 3 && s.sense_plus == 0).unwrap();
        assert_eq!(relative[step].index, 3 * 16 + 13);
    }

    #[test]
    fn relative_order_starts_behind_the_driven_pair() {
        let steps = adjacent();
        let map = arrangement(true, 0, false).index_map(&steps, 16, 208).unwrap();
        let first_of_drive_3 = map.iter().position(|found| found.index == 3 * 13).unwrap();
        assert_eq!(steps[first_of_drive_3].to_bytes(), [4, 3, 5, 6]);
        let last_of_drive_3 = map.iter().position(|found| found.index == 3 * 13 + 12).unwrap();
        assert_eq!(steps[last_of_drive_3].to_bytes(), [4, 3, 1, 2]);
    }

    #[test]
    fn rotation_names_the_electrode_that_the_file_calls_zero() {
        let steps = adjacent();
        let map = arrangement(false, 3, false).index_map(&steps, 16, 208).unwrap();
        let first = map.iter().position(|found| found.index == 0).unwrap();
        assert_eq!(steps[first].to_bytes(), [4, 3, 5, 6]);
    }

    #[test]
    fn mirrored_opposite_drives_keep_their_direction_and_flip_the_sense_pairs() {
        let steps: Vec<_> = pattern(16, 8, 1, Driven::Skipped).collect();
        let map = arrangement(false, 0, true).index_map(&steps, 16, 192).unwrap();
        assert!(map.iter().all(|found| found.flipped));
        let adjacent = arrangement(false, 0, true).index_map(&adjacent(), 16, 208).unwrap();
        assert!(adjacent.iter().all(|found| !found.flipped), "both pairs turn round");
    }

    #[test]
    fn wrong_lengths_name_the_allowed_ones() {
        let error = Arrangement::default().index_map(&adjacent(), 16, 240).unwrap_err().to_string();
        assert!(error.contains("240") && error.contains("208") && error.contains("256"), "{error}");
    }

    #[test]
    fn impossible_requests_are_refused() {
        let error = arrangement(false, 16, false).index_map(&adjacent(), 16, 208).unwrap_err();
        assert_eq!(error.to_string(), "rotation is 16, allowed are 0 to 15");
        let few = &adjacent()[..20];
        assert!(matches!(
            arrangement(false, 3, false).index_map(few, 16, 20),
            Err(OrderError::NotCyclic { step: 0, .. })
        ));
        assert!(matches!(Arrangement::default().index_map(few, 2, 20), Err(OrderError::Step { .. })));
        assert!(matches!(Arrangement::default().index_map(&[], 0, 0), Err(OrderError::Rotation { .. })));
        let shared = [[1, 0, 2, 3], [1, 0, 2, 4]].map(Step::from_bytes);
        assert_eq!(
            Arrangement::default().index_map(&shared, 16, 256).unwrap_err(),
            OrderError::SharedPlace { step: 1 }
        );
    }

    #[test]
    fn with_driven_electrodes_measured_a_frame_is_the_full_square() {
        let steps: Vec<_> = pattern(16, 1, 1, Driven::Measured).collect();
        let map = Arrangement::default().index_map(&steps, 16, 256).unwrap();
        assert!(map.iter().enumerate().all(|(step, found)| found.index == step && !found.flipped));
        // Relative order begins with the driven pair itself.
        let map = arrangement(true, 0, false).index_map(&steps, 16, 256).unwrap();
        let first_of_drive_3 = map.iter().position(|found| found.index == 3 * 16).unwrap();
        assert_eq!(steps[first_of_drive_3].to_bytes(), [4, 3, 3, 4]);
    }

    #[test]
    fn a_table_keeps_its_order_and_has_no_other() {
        let steps = [[1, 0, 2, 3], [1, 0, 4, 3], [5, 2, 0, 1]].map(Step::from_bytes);
        let map = Arrangement::default().index_map(&steps, 6, 3).unwrap();
        assert_eq!(map.iter().map(|found| found.index).collect::<Vec<_>>(), [0, 1, 2]);
        let square = Arrangement::default().index_map(&steps, 6, 36).unwrap();
        assert_eq!(square.iter().map(|found| found.index).collect::<Vec<_>>(), [2, 4, 12]);
        let turned = arrangement(false, 1, false).index_map(&steps, 6, 3);
        assert!(matches!(turned, Err(OrderError::NotCyclic { step: 0, .. })), "{turned:?}");
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(100))]

        #[test]
        fn the_index_map_is_a_permutation(
            electrodes in prop_oneof![8 => 5_u8..=16, 1 => 17_u8..=64, 1 => 240_u8..=250],
            distance: u8,
            skip: bool,
            rotation: u8,
            relative: bool,
            mirrored: bool,
            square: bool,
            measured: bool,
        ) {
            let distance = 1 + distance % (electrodes / 2);
            let driven = if measured { Driven::Measured } else { Driven::Skipped };
            let steps: Vec<_> = pattern(electrodes, distance, if skip { distance } else { 1 }, driven).collect();
            let measurements = if square { usize::from(electrodes).pow(2) } else { steps.len() };
            let arrangement = arrangement(relative, rotation % electrodes, mirrored);
            let map = arrangement.index_map(&steps, electrodes, measurements).unwrap();
            let mut indices: Vec<_> = map.iter().map(|found| found.index).collect();
            indices.sort_unstable();
            indices.dedup();
            prop_assert_eq!(indices.len(), steps.len());
            prop_assert!(indices.iter().all(|&index| index < measurements));
        }
    }
}
