//! Report on a stimulation table: how many of its steps tell something new.
//!
//! On a linear reciprocal body the electrodes form a network with the symmetric impedance matrix Z,
//! and a step that drives d and senses s (each +1 and -1 on two electrodes) reads d'Zs. What it
//! measures is therefore the symmetric bilinear form (d s' + s d') / 2, restricted to currents and
//! voltages that sum to zero: of n electrodes there are n (n - 1) / 2 independent ones. The rank of
//! a table is the rank of its forms.
//!
//! The rank is exact: forms have integer entries, and are eliminated modulo the prime 2^61 - 1. A
//! prime can only make a rank too small, and only if it divides a determinant.

use dermatome_shared::stimulation::{Driven, Reciprocity, Step, pattern};
use serde::Serialize;
use std::collections::{BTreeSet, HashMap, hash_map::Entry};

/// Header of a stimulation table in a CSV file; its electrodes count from 0.
pub const STEP_COLUMNS: [&str; 4] = ["drive_plus", "drive_minus", "sense_plus", "sense_minus"];

/// What a stimulation table holds. Steps and electrodes count from 0.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct PatternReport {
    /// Number of steps.
    pub steps: usize,
    /// Different measurements: steps that differ only in direction, or in which pair drives, are one.
    pub distinct: usize,
    /// Linearly independent measurements.
    pub rank: usize,
    /// The largest rank that so many electrodes allow.
    pub largest_rank: usize,
    /// Steps that measure what an earlier one does.
    pub repeated: Vec<Repeated>,
    /// Steps that repeat none, but are linear combinations of earlier ones.
    pub dependent: Vec<usize>,
    /// Electrodes through which no current ever flows.
    pub never_driven: Vec<u8>,
    /// Electrodes whose potential is never sensed.
    pub never_sensed: Vec<u8>,
}

/// A step that measures what an earlier one does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Repeated {
    /// The step.
    pub step: usize,
    /// The first step that measures the same.
    pub of: usize,
    /// How the two differ.
    pub kind: Repetition,
}

/// How two steps that measure the same differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Repetition {
    /// Not at all.
    Identical,
    /// One or both pairs are the other way round.
    Reversed,
    /// The drive pair of one is the sense pair of the other.
    Reciprocal,
}

/// Looks at a stimulation table of a skin with so many electrodes.
#[must_use]
pub fn report(steps: &[Step], electrodes: u8) -> PatternReport {
    let mut first: HashMap<[[u8; 2]; 2], usize> = HashMap::new();
    let mut elimination = Elimination::default();
    let (mut repeated, mut dependent) = (Vec::new(), Vec::new());
    for (step, pairs) in steps.iter().enumerate() {
        match first.entry(pairs.reciprocity().pairs) {
            Entry::Occupied(known) => {
                let of = *known.get();
                repeated.push(Repeated { step, of, kind: repetition(steps[of], *pairs) });
            }
            Entry::Vacant(new) => {
                new.insert(step);
                if !elimination.add(form(*pairs, electrodes)) {
                    dependent.push(step);
                }
            }
        }
    }
    let n = usize::from(electrodes);
    let unused = |pair: fn(&Step) -> [u8; 2]| {
        let used: BTreeSet<u8> = steps.iter().flat_map(pair).collect();
        (0..electrodes).filter(|electrode| !used.contains(electrode)).collect()
    };
    PatternReport {
        steps: steps.len(),
        distinct: first.len(),
        rank: elimination.pivots.len(),
        largest_rank: n * n.saturating_sub(1) / 2,
        repeated,
        dependent,
        never_driven: unused(|step| [step.drive_plus, step.drive_minus]),
        never_sensed: unused(|step| [step.sense_plus, step.sense_minus]),
    }
}

/// A stimulation table as CSV, with the columns [`STEP_COLUMNS`] and electrodes from 0: what
/// `drive.table` in a skin file reads.
#[must_use]
pub fn table_csv(steps: &[Step]) -> String {
    let mut text = STEP_COLUMNS.join(",") + "\n";
    for step in steps {
        text += &(step.to_bytes().map(|electrode| electrode.to_string()).join(",") + "\n");
    }
    text
}

/// Stimulation patterns with so many steps, as a skin file's `[drive]` names them.
#[must_use]
pub fn patterns_of_length(electrodes: u8, steps: usize) -> Vec<String> {
    // Each skip-N has as many steps as adjacent.
    let distances = [
        (1, "`drive.pattern` = \"adjacent\" or \"skip-N\""),
        (electrodes / 2, "`drive.pattern` = \"opposite\""),
    ];
    let kinds = [(Driven::Skipped, ""), (Driven::Measured, " and `drive.driven` = \"measured\"")];
    let named = distances.into_iter().flat_map(|distance| kinds.map(|kind| (distance, kind)));
    named
        .filter(|&((drive, _), (driven, _))| pattern(electrodes, drive, 1, driven).count() == steps)
        .map(|((_, name), (_, words))| format!("{name}{words}"))
        .collect()
}

/// How two steps that measure the same differ.
#[must_use]
pub fn repetition(a: Step, b: Step) -> Repetition {
    let drive = |step: Step| {
        let mut pair = [step.drive_plus, step.drive_minus];
        pair.sort_unstable();
        pair
    };
    match () {
        () if a == b => Repetition::Identical,
        () if drive(a) == drive(b) => Repetition::Reversed,
        () => Repetition::Reciprocal,
    }
}

/// Pairs of steps that measure the same, in the order of the later one: the first step with that
/// measurement, the later one, and whether they read opposite signs.
pub fn pairs_alike(steps: &[Step]) -> impl Iterator<Item = (usize, usize, bool)> + '_ {
    let mut first: HashMap<[[u8; 2]; 2], (usize, Reciprocity)> = HashMap::new();
    steps.iter().enumerate().filter_map(move |(step, pairs)| {
        let this = pairs.reciprocity();
        match first.entry(this.pairs) {
            Entry::Occupied(known) => {
                let (of, other) = *known.get();
                Some((of, step, this.flipped != other.flipped))
            }
            Entry::Vacant(new) => {
                new.insert((step, this));
                None
            }
        }
    })
}

/// Twice the form of a step, lower half without the last electrode: zero-sum vectors are known by
/// their other entries. Places ascend; values are modulo [`PRIME`].
fn form(step: Step, electrodes: u8) -> Vec<(usize, u64)> {
    let last = usize::from(electrodes) - 1;
    let [dp, dm, sp, sm] = step.to_bytes().map(usize::from);
    let mut entries: HashMap<usize, i64> = HashMap::new();
    for (a, d) in [(dp, 1), (dm, -1)] {
        for (b, s) in [(sp, 1), (sm, -1)] {
            if a != last && b != last {
                let (high, low) = (a.max(b), a.min(b));
                *entries.entry(high * (high + 1) / 2 + low).or_default() +=
                    if a == b { 2 * d * s } else { d * s };
            }
        }
    }
    let residue = |value: i64| value.rem_euclid(PRIME as i64) as u64;
    let mut row: Vec<_> = entries
        .into_iter()
        .filter(|&(_, value)| value != 0)
        .map(|(at, value)| (at, residue(value)))
        .collect();
    row.sort_unstable();
    row
}

/// 2^61 - 1.
const PRIME: u64 = (1 << 61) - 1;

fn times(a: u64, b: u64) -> u64 {
    (u128::from(a) * u128::from(b) % u128::from(PRIME)) as u64
}

/// Fermat: a^(p - 2) is 1 / a.
fn inverse(a: u64) -> u64 {
    let (mut power, mut result, mut exponent) = (a, 1, PRIME - 2);
    while exponent > 0 {
        if exponent & 1 == 1 {
            result = times(result, power);
        }
        power = times(power, power);
        exponent >>= 1;
    }
    result
}

/// Rows in echelon form: by the place of their last entry, which is 1.
#[derive(Default)]
struct Elimination {
    pivots: HashMap<usize, Vec<(usize, u64)>>,
}

impl Elimination {
    /// Adds a row; whether it was independent of those before.
    fn add(&mut self, mut row: Vec<(usize, u64)>) -> bool {
        while let Some(&(place, value)) = row.last() {
            match self.pivots.entry(place) {
                Entry::Occupied(pivot) => row = minus_multiple(&row, pivot.get(), value),
                Entry::Vacant(free) => {
                    let scale = inverse(value);
                    row.iter_mut().for_each(|(_, value)| *value = times(*value, scale));
                    free.insert(row);
                    return true;
                }
            }
        }
        false
    }
}

/// a - factor b, sparse.
fn minus_multiple(a: &[(usize, u64)], b: &[(usize, u64)], factor: u64) -> Vec<(usize, u64)> {
    let negated = PRIME - factor;
    let (mut i, mut j) = (0, 0);
    let mut sum = Vec::with_capacity(a.len() + b.len());
    while i < a.len() || j < b.len() {
        let place = a.get(i).map_or(usize::MAX, |e| e.0).min(b.get(j).map_or(usize::MAX, |e| e.0));
        let mut value = 0;
        if let Some(entry) = a.get(i).filter(|entry| entry.0 == place) {
            value = entry.1;
            i += 1;
        }
        if let Some(entry) = b.get(j).filter(|entry| entry.0 == place) {
            value = (value + times(negated, entry.1)) % PRIME;
            j += 1;
        }
        if value != 0 {
            sum.push((place, value));
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use faer::Mat;
    use proptest::prelude::*;
    use rand::{Rng, SeedableRng};

    fn of(electrodes: u8, drive: u8, sense: u8, driven: Driven) -> PatternReport {
        report(&pattern(electrodes, drive, sense, driven).collect::<Vec<_>>(), electrodes)
    }

    /// Rank of the readings of random reciprocal networks, `[step][network]`.
    fn numerical_rank(steps: &[Step], electrodes: u8, seed: u64) -> usize {
        let mut random = rand_pcg::Pcg64::seed_from_u64(seed);
        let n = usize::from(electrodes);
        let networks: Vec<Mat<f64>> = (0..n * n / 2)
            .map(|_| {
                let half = Mat::from_fn(n, n, |_, _| random.random_range(-1.0..1.0));
                &half + half.transpose()
            })
            .collect();
        let reading = |step: &Step, z: &Mat<f64>| {
            let [dp, dm, sp, sm] = step.to_bytes().map(usize::from);
            z[(sp, dp)] - z[(sp, dm)] - z[(sm, dp)] + z[(sm, dm)]
        };
        let readings = Mat::from_fn(steps.len(), networks.len(), |step, network| {
            reading(&steps[step], &networks[network])
        });
        let singular = readings.singular_values().unwrap();
        singular.iter().filter(|&&value| value > 1e-9 * singular[0]).count()
    }

    #[test]
    fn steps_distinct_measurements_and_rank_of_the_usual_patterns() {
        // Electrodes, drive distance, sense distance; skipped and measured on driven electrodes.
        let table = [
            ((16, 1, 1), [208, 104, 104], [256, 136, 120]),
            ((16, 8, 1), [192, 96, 76], [256, 128, 92]),
            ((16, 2, 2), [208, 104, 89], [256, 136, 105]),
            ((16, 3, 3), [208, 104, 104], [256, 136, 120]),
            ((16, 4, 4), [208, 104, 62], [256, 136, 78]),
            ((8, 1, 1), [40, 20, 20], [64, 36, 28]),
            ((8, 4, 1), [32, 16, 14], [64, 32, 22]),
            ((32, 1, 1), [928, 464, 464], [1024, 528, 496]),
        ];
        for ((electrodes, drive, sense), skipped, measured) in table {
            for (driven, expected) in [(Driven::Skipped, skipped), (Driven::Measured, measured)] {
                let report = of(electrodes, drive, sense, driven);
                let found = [report.steps, report.distinct, report.rank];
                assert_eq!(found, expected, "{electrodes} {drive} {sense} {driven:?}");
                assert_eq!(report.repeated.len(), report.steps - report.distinct);
                assert_eq!(report.dependent.len(), report.distinct - report.rank);
            }
        }
    }

    #[test]
    fn a_table_is_told_what_repeats_what_and_which_electrodes_idle() {
        let steps = [[0, 1, 2, 3], [2, 3, 0, 1], [1, 0, 2, 3], [0, 1, 2, 3], [0, 1, 3, 4], [4, 2, 1, 0]]
            .map(Step::from_bytes);
        let report = report(&steps, 6);
        let repeated = |step, of, kind| Repeated { step, of, kind };
        assert_eq!(
            report.repeated,
            [
                repeated(1, 0, Repetition::Reciprocal),
                repeated(2, 0, Repetition::Reversed),
                repeated(3, 0, Repetition::Identical)
            ]
        );
        assert_eq!(report.dependent, [5], "2-3 and 3-4 make 2-4");
        assert_eq!((report.distinct, report.rank, report.largest_rank), (3, 2, 15));
        assert_eq!((report.never_driven, report.never_sensed), (vec![5], vec![5]));
    }

    #[test]
    fn pairs_alike_know_the_sign() {
        let steps = [[0, 1, 2, 3], [3, 2, 0, 1], [1, 0, 3, 2]].map(Step::from_bytes);
        assert_eq!(pairs_alike(&steps).collect::<Vec<_>>(), [(0, 1, true), (0, 2, false)]);
    }

    #[test]
    fn the_largest_pattern_is_reported_too() {
        let report = of(250, 2, 1, Driven::Measured);
        assert_eq!(report.steps, 62_500);
        assert!(report.rank > 31_000 && report.rank <= report.largest_rank, "{}", report.rank);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(40))]

        #[test]
        fn the_rank_is_that_of_readings_of_random_networks(
            electrodes in 4_u8..=10,
            rows in prop::collection::vec(any::<[u8; 4]>(), 1..60),
            seed: u64,
        ) {
            let steps: Vec<_> = rows
                .iter()
                .map(|row| Step::from_bytes(row.map(|electrode| electrode % electrodes)))
                .filter(|step| step.is_valid(electrodes))
                .collect();
            prop_assume!(!steps.is_empty());
            prop_assert_eq!(report(&steps, electrodes).rank, numerical_rank(&steps, electrodes, seed));
        }
    }
}
