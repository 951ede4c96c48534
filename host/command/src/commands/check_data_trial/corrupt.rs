//! Frames spoilt on purpose, each in one way, as an instrument, its wires, or whoever stored them would have done it.
//!
//! Exchanged wires add up voltages that were measured: that between two electrodes is the sum of the pairs between
//! them. Pairs that were not measured, because they touch a driven electrode, are as the model says at the frame's
//! gain.

use super::judge::{Wrong, alike};
use dermatome_frames::recorded::{
    check::{
        Expected,
        reading::Misplacement,
        wiring::{Exchange, Role},
    },
    order::{Arrangement, SenseOrder},
    read::Frames,
    statistics::median,
};
use dermatome_shared::stimulation::Step;
use num_complex::Complex64;
use rand::Rng;
use rand_pcg::Pcg64Mcg;

pub(super) type Spoilt = (&'static str, Wrong, Frames);

/// Distances round a pattern that looks the same from every electrode.
#[derive(Clone, Copy)]
struct Cyclic {
    n: usize,
    drive: usize,
    sense: usize,
}

/// All drives with all sense pairs of each frame, signed: `[frame][drive][sense]`.
#[derive(Clone)]
struct Whole<'a> {
    expected: &'a Expected,
    cyclic: Cyclic,
    /// Whether the file holds the full square.
    square: bool,
    complex: bool,
    /// Whether the instrument records magnitudes only.
    magnitudes: bool,
    values: Vec<Vec<Complex64>>,
}

/// Everything that is tried on these frames.
pub(super) fn corruptions(
    expected: &Expected,
    frames: &Frames,
    used: Arrangement,
    random: &mut Pcg64Mcg,
) -> Vec<Spoilt> {
    let mut spoilt = Vec::new();
    let plain = used == Arrangement::default();
    if let Some(whole) = Whole::of(expected, frames).filter(|_| plain) {
        orders(&whole, &mut spoilt);
        misplaced(&whole, random, &mut spoilt);
        wires(&whole, random, &mut spoilt);
        pairs(&whole, random, &mut spoilt);
        squares(&whole, &mut spoilt);
        electrodes(&whole, random, &mut spoilt);
    }
    offsets(expected, frames, &mut spoilt);
    signal(expected, frames, used, &mut spoilt);
    spoilt
}

fn orders(whole: &Whole<'_>, spoilt: &mut Vec<Spoilt>) {
    let relative = Arrangement { sense: SenseOrder::Relative, ..Arrangement::default() };
    spoilt.push((
        "sense pairs counted from the driven one",
        Wrong::Order(relative),
        whole.in_order(relative, whole.square),
    ));
    if !whole.square {
        spoilt.push((
            "full square counted from the driven pair",
            Wrong::Order(relative),
            whole.in_order(relative, true),
        ));
        let mut empty = whole.clone();
        empty.clear_unmeasured();
        spoilt.push((
            "full square counted from the driven pair",
            Wrong::Order(relative),
            empty.in_order(relative, true),
        ));
    }
    for (rotation, mirrored) in [(1, false), (0, true), (3, true)] {
        let made = Arrangement { rotation, mirrored, ..Arrangement::default() };
        if !whole.magnitudes && !alike(whole.expected, made, Arrangement::default()) {
            spoilt.push(("electrodes numbered otherwise", Wrong::Order(made), whole.turned(made)));
        }
    }
}

fn misplaced(whole: &Whole<'_>, random: &mut Pcg64Mcg, spoilt: &mut Vec<Spoilt>) {
    let good = whole.file(whole.square);
    let length = good.measurements;
    let rows = whole.cyclic.n;
    let per_row = length / rows;
    for by in [1, per_row / 2, per_row, random.random_range(1..length), length - 1] {
        let wrong = Wrong::Misplaced(vec![Misplacement::Shifted(by)]);
        spoilt.push(("values shifted", wrong, moved(&good, |place| (place + by) % length)));
    }
    let next = random.random_range(0..rows - 1);
    let mut chosen = vec![[next, next + 1]];
    chosen.extend((0..2).map(|_| two(rows, random).map(usize::from)));
    for [a, b] in chosen {
        let wrong = Wrong::Misplaced(vec![Misplacement::Rows([a, b])]);
        let place = |place: usize| match place / per_row {
            row if row == a => b * per_row + place % per_row,
            row if row == b => a * per_row + place % per_row,
            _ => place,
        };
        spoilt.push(("rows exchanged", wrong, moved(&good, place)));
    }
}

fn wires(whole: &Whole<'_>, random: &mut Pcg64Mcg, spoilt: &mut Vec<Spoilt>) {
    let n = whole.cyclic.n;
    let next = random.random_range(0..n as u8 - 1);
    for (role, kind) in [
        (Role::Both, "electrodes exchanged"),
        (Role::Drive, "drive wires exchanged"),
        (Role::Sense, "sense wires exchanged"),
    ] {
        let chosen = [[next, next + 1], two(n, random), two(n, random)];
        for electrodes in chosen {
            let exchange = Exchange { electrodes, role };
            if let Some(exchanged) = whole.exchanged(exchange) {
                spoilt.push((kind, Wrong::Exchanged(exchange), exchanged.file(whole.square)));
            }
        }
    }
}

fn pairs(whole: &Whole<'_>, random: &mut Pcg64Mcg, spoilt: &mut Vec<Spoilt>) {
    let Cyclic { n, drive, sense } = whole.cyclic;
    let pair = |k: usize, drives: bool| {
        let [a, b] = if drives { [(k + drive) % n, k] } else { [k, (k + sense) % n] };
        [a as u8, b as u8]
    };
    for (drives, gain) in [(false, 1.3), (false, 1.3), (false, 0.7), (true, 1.3)] {
        let k = random.random_range(0..n);
        let wrong = Wrong::Gain { pair: pair(k, drives), drives, gain };
        let kind = if drives { "a drive pair's gain" } else { "a sense pair's gain" };
        spoilt.push((kind, wrong, whole.times(k, drives, gain).file(whole.square)));
    }
    if !whole.magnitudes {
        for drives in [false, true] {
            let k = random.random_range(0..n);
            let wrong = Wrong::Reversed { pair: pair(k, drives), drives };
            let kind = if drives { "a drive pair reversed" } else { "a sense pair reversed" };
            spoilt.push((kind, wrong, whole.times(k, drives, -1.0).file(whole.square)));
        }
    }
}

fn squares(whole: &Whole<'_>, spoilt: &mut Vec<Spoilt>) {
    let n = whole.cyclic.n;
    let transpose = |frames: &Frames| moved(frames, |place| place % n * n + place / n);
    if whole.cyclic.drive != whole.cyclic.sense {
        let wrong = Wrong::Misplaced(vec![Misplacement::Transposed]);
        spoilt.push(("square transposed", wrong, transpose(&whole.file(true))));
    }
    if let Some(potentials) = whole.potentials().filter(|_| !whole.magnitudes) {
        let frames = potentials.file(true);
        spoilt.push(("potentials", Wrong::Potentials, frames.clone()));
        spoilt.push(("potentials, square transposed", Wrong::TransposedPotentials, transpose(&frames)));
    }
}

fn electrodes(whole: &Whole<'_>, random: &mut Pcg64Mcg, spoilt: &mut Vec<Spoilt>) {
    let n = whole.cyclic.n;
    for _ in 0..2 {
        let electrode = random.random_range(0..n);
        spoilt.push((
            "an electrode open",
            Wrong::Open(electrode as u8),
            whole.open(electrode, random).file(whole.square),
        ));
    }
    if whole.values.len() >= 10 {
        let electrode = random.random_range(0..n);
        let noisy = whole.noisy(electrode, random);
        spoilt.push(("an electrode noisy", Wrong::Noisy(electrode as u8), noisy.file(whole.square)));
    }
}

/// Shares of the median magnitude.
const OFFSETS: [f64; 5] = [0.5, 1.0, 2.0, 3.0, -1.0];

fn offsets(expected: &Expected, frames: &Frames, spoilt: &mut Vec<Spoilt>) {
    let Ok(map) =
        Arrangement::default().index_map(&expected.steps, expected.electrodes(), frames.measurements)
    else {
        return;
    };
    let mean = frames.mean();
    let size = median(map.iter().map(|place| mean[place.index].norm()));
    // Magnitudes have no room below zero.
    let magnitudes = frames.values.iter().all(|value| value.im == 0.0 && value.re >= 0.0);
    for share in OFFSETS.into_iter().filter(|share| *share > 0.0 || !magnitudes) {
        spoilt.push(("an offset", Wrong::Offset(share * size), frames.clone().minus(-share * size)));
    }
}

fn signal(expected: &Expected, frames: &Frames, used: Arrangement, spoilt: &mut Vec<Spoilt>) {
    let Ok(map) = used.index_map(&expected.steps, expected.electrodes(), frames.measurements) else { return };
    if frames.frames < 5 {
        return;
    }
    let measured = frames.iter().flat_map(|frame| map.iter().map(|place| frame[place.index].re.abs()));
    let largest = measured.fold(0.0, f64::max);
    let limit = 0.8 * largest;
    let mut clipped = frames.clone();
    clipped.values.iter_mut().for_each(|value| value.re = value.re.clamp(-limit, limit));
    spoilt.push(("values clipped", Wrong::Clipped, clipped));
    let mut repeated = frames.clone();
    let length = frames.measurements;
    repeated.values.copy_within(length..2 * length, 2 * length);
    spoilt.push(("frames repeated", Wrong::Repeated, repeated));
}

/// Two different numbers below n, the lower one first.
fn two(n: usize, random: &mut Pcg64Mcg) -> [u8; 2] {
    let a = random.random_range(0..n as u8);
    let b = (a + random.random_range(1..n as u8)) % n as u8;
    [a.min(b), a.max(b)]
}

/// Frames with the value of each place in another one.
fn moved(frames: &Frames, to: impl Fn(usize) -> usize) -> Frames {
    let mut moved = frames.clone();
    for (moved, frame) in moved.values.chunks_exact_mut(frames.measurements).zip(frames.iter()) {
        frame.iter().enumerate().for_each(|(place, value)| moved[to(place)] = *value);
    }
    moved
}

impl<'a> Whole<'a> {
    /// Of a pattern that looks the same from every electrode.
    fn of(expected: &'a Expected, frames: &Frames) -> Option<Self> {
        let cyclic = Cyclic::of(expected)?;
        let n = cyclic.n;
        let map = Arrangement::default()
            .index_map(&expected.steps, expected.electrodes(), frames.measurements)
            .ok()?;
        let model: Vec<f64> = expected.steps.iter().map(|&step| expected.voltage(step)).collect();
        let magnitudes = frames.values.iter().all(|value| value.im == 0.0 && value.re >= 0.0)
            && model.iter().any(|&m| m < 0.0);
        let square = frames.measurements == n * n;
        let gain = gain(&frames.mean(), &map.iter().map(|place| place.index).collect::<Vec<_>>(), &model);
        let of_frame = |frame: &[Complex64]| -> Vec<Complex64> {
            let mut whole: Vec<Complex64> =
                (0..n * n).map(|place| gain * expected.voltage(cyclic.step(place / n, place % n))).collect();
            for ((step, place), m) in expected.steps.iter().zip(&map).zip(&model) {
                let sign = if magnitudes { m.signum() } else { 1.0 };
                whole[usize::from(step.drive_minus) * n + usize::from(step.sense_plus)] =
                    frame[place.index] * sign;
            }
            for (row, values) in whole.chunks_exact_mut(n).enumerate() {
                close(values, |column| expected.steps.contains(&cyclic.step(row, column)));
            }
            whole
        };
        let values = frames.iter().map(of_frame).collect();
        Some(Self { expected, cyclic, square, complex: frames.complex, magnitudes, values })
    }

    /// As a file holds them, in canonical order.
    fn file(&self, square: bool) -> Frames {
        self.in_order(Arrangement::default(), square)
    }

    fn in_order(&self, arrangement: Arrangement, square: bool) -> Frames {
        let n = self.cyclic.n;
        let of_frame = |whole: &Vec<Complex64>| -> Vec<Complex64> {
            let stored = |value: Complex64| if self.magnitudes { value.norm().into() } else { value };
            let relative = arrangement.sense == SenseOrder::Relative;
            let column = |row: usize, column: usize| if relative { (row + column) % n } else { column };
            let places = (0..n * n).map(|place| (place / n, column(place / n, place % n)));
            let is_kept = |&(row, column): &(usize, usize)| square || self.is_measured(row, column);
            places.filter(is_kept).map(|(row, column)| stored(whole[row * n + column])).collect()
        };
        let values: Vec<Complex64> = self.values.iter().flat_map(of_frame).collect();
        let frames = self.values.len();
        Frames { measurements: values.len() / frames, values, frames, complex: self.complex }
    }

    fn is_measured(&self, row: usize, column: usize) -> bool {
        let step = self.cyclic.step(row, column);
        self.expected.steps.contains(&step)
    }

    fn clear_unmeasured(&mut self) {
        let n = self.cyclic.n;
        let unmeasured: Vec<usize> =
            (0..n * n).filter(|place| !self.is_measured(place / n, place % n)).collect();
        for whole in &mut self.values {
            unmeasured.iter().for_each(|&place| whole[place] = Complex64::ZERO);
        }
    }

    /// As an instrument would record it that numbers its electrodes otherwise.
    fn turned(&self, made: Arrangement) -> Frames {
        let n = self.cyclic.n;
        let on_skin = |k: usize| {
            let k = if made.mirrored { n - k } else { k };
            (k + usize::from(made.rotation)) % n
        };
        let mut turned = self.clone();
        for (turned, whole) in turned.values.iter_mut().zip(&self.values) {
            for (place, turned) in turned.iter_mut().enumerate() {
                let Step { drive_plus, drive_minus, sense_plus, sense_minus } =
                    self.cyclic.step(place / n, place % n);
                let [dp, dm, sp, sm] =
                    [drive_plus, drive_minus, sense_plus, sense_minus].map(|e| on_skin(e.into()));
                // Mirrored pairs lie the other way round.
                let ahead = |a: usize, b: usize| (b + n - a) % n;
                let (row, drive_sign) =
                    if ahead(dm, dp) == self.cyclic.drive { (dm, 1.0) } else { (dp, -1.0) };
                let (column, sense_sign) =
                    if ahead(sp, sm) == self.cyclic.sense { (sp, 1.0) } else { (sm, -1.0) };
                *turned = whole[row * n + column] * drive_sign * sense_sign;
            }
        }
        turned.file(self.square)
    }

    /// With wires exchanged; `None` if the pairs do not add up to those.
    fn exchanged(&self, exchange: Exchange) -> Option<Self> {
        let Cyclic { n, drive, sense } = self.cyclic;
        let [a, b] = exchange.electrodes.map(usize::from);
        let wire = |k: usize| {
            if k == a {
                b
            } else if k == b {
                a
            } else {
                k
            }
        };
        let mut exchanged = self.clone();
        if exchange.role != Role::Drive {
            let sums: Option<Vec<_>> =
                (0..n).map(|k| chain(wire(k), wire((k + sense) % n), sense, n)).collect();
            let sums = sums?;
            for whole in &mut exchanged.values {
                for row in whole.chunks_exact_mut(n) {
                    let old = row.to_vec();
                    for (value, sum) in row.iter_mut().zip(&sums) {
                        *value = sum.iter().map(|&(pair, sign)| old[pair] * sign).sum();
                    }
                }
            }
        }
        if exchange.role != Role::Sense {
            let sums: Option<Vec<_>> =
                (0..n).map(|k| chain(wire(k), wire((k + drive) % n), drive, n)).collect();
            let sums = sums?;
            for whole in &mut exchanged.values {
                let old = whole.clone();
                for place in 0..n * n {
                    let sum = sums[place / n].iter();
                    whole[place] = sum.map(|&(row, sign)| old[row * n + place % n] * sign).sum();
                }
            }
        }
        Some(exchanged)
    }

    /// With a pair's values, in all of its row or column, times a factor.
    fn times(&self, k: usize, drives: bool, factor: f64) -> Self {
        let n = self.cyclic.n;
        let mut times = self.clone();
        let is_of_pair = |place: usize| if drives { place / n == k } else { place % n == k };
        for whole in &mut times.values {
            (0..n * n).filter(|&place| is_of_pair(place)).for_each(|place| whole[place] *= factor);
        }
        times
    }

    /// Potentials of electrodes instead of differences: `[drive][electrode]`.
    fn potentials(&self) -> Option<Self> {
        let Cyclic { n, sense, .. } = self.cyclic;
        let sums: Option<Vec<_>> = (0..n).map(|k| chain(k, 0, sense, n)).collect();
        let sums = sums?;
        let mut potentials = self.clone();
        for whole in &mut potentials.values {
            for row in whole.chunks_exact_mut(n) {
                let old = row.to_vec();
                let against_first =
                    sums.iter().map(|sum| sum.iter().map(|&(pair, sign)| old[pair] * sign).sum());
                let against_first: Vec<Complex64> = against_first.collect();
                let mean: Complex64 = against_first.iter().sum::<Complex64>() / n as f64;
                row.iter_mut().zip(against_first).for_each(|(value, potential)| *value = potential - mean);
            }
        }
        Some(potentials)
    }

    /// With an electrode without contact: driven it leaves noise, sensed it picks up anything.
    fn open(&self, electrode: usize, random: &mut Pcg64Mcg) -> Self {
        let n = self.cyclic.n;
        let mut open = self.clone();
        let size = median(open.values[0].iter().map(|value| value.norm()));
        for whole in &mut open.values {
            for (place, value) in whole.iter_mut().enumerate() {
                let step = self.cyclic.step(place / n, place % n);
                let is = |a: u8, b: u8| usize::from(a) == electrode || usize::from(b) == electrode;
                let of = if is(step.drive_plus, step.drive_minus) {
                    1e-3
                } else if is(step.sense_plus, step.sense_minus) {
                    10.0
                } else {
                    continue;
                };
                *value = Complex64::from(of * size * random.random_range(-1.0..1.0));
            }
        }
        open
    }

    /// With a contact that crackles.
    fn noisy(&self, electrode: usize, random: &mut Pcg64Mcg) -> Self {
        let n = self.cyclic.n;
        let mut noisy = self.clone();
        let size = median(noisy.values[0].iter().map(|value| value.norm()));
        for whole in &mut noisy.values {
            for (place, value) in whole.iter_mut().enumerate() {
                if self.cyclic.step(place / n, place % n).to_bytes().map(usize::from).contains(&electrode) {
                    *value += size * random.random_range(-0.5..0.5);
                }
            }
        }
        noisy
    }
}

impl Cyclic {
    /// Drive k from electrode k, the same distances everywhere.
    fn of(expected: &Expected) -> Option<Self> {
        let n = usize::from(expected.electrodes());
        let ahead = |a: u8, b: u8| (usize::from(b) + n - usize::from(a)) % n;
        let first = expected.steps.first()?;
        let cyclic = Self {
            n,
            drive: ahead(first.drive_minus, first.drive_plus),
            sense: ahead(first.sense_plus, first.sense_minus),
        };
        let same = |step: &Step| *step == cyclic.step(step.drive_minus.into(), step.sense_plus.into());
        let in_order = expected.steps.is_sorted_by_key(|step| (step.drive_minus, step.sense_plus));
        let rows = expected.steps.len().is_multiple_of(n);
        (in_order && rows && expected.steps.iter().all(same)).then_some(cyclic)
    }

    fn step(self, row: usize, column: usize) -> Step {
        let at = |k: usize| (k % self.n) as u8;
        Step {
            drive_plus: at(row + self.drive),
            drive_minus: at(row),
            sense_plus: at(column),
            sense_minus: at(column + self.sense),
        }
    }
}

/// Pairs (k, k + distance), with signs, whose differences add up to that from one electrode to another.
fn chain(from: usize, to: usize, distance: usize, n: usize) -> Option<Vec<(usize, f64)>> {
    let ahead = (0..n).find(|&count| (from + count * distance) % n == to)?;
    let around = (0..=n).skip(1).find(|&count| (count * distance).is_multiple_of(n))?;
    if ahead * 2 <= around {
        Some((0..ahead).map(|count| ((from + count * distance) % n, 1.0)).collect())
    } else {
        let back = around - ahead;
        Some((1..=back).map(|count| ((from + (around - count) * distance) % n, -1.0)).collect())
    }
}

/// Makes the voltages round a drive add up to zero by those that were not measured.
fn close(row: &mut [Complex64], is_measured: impl Fn(usize) -> bool) {
    let sum: Complex64 = row.iter().sum();
    let open: Vec<usize> = (0..row.len()).filter(|&column| !is_measured(column)).collect();
    let size: f64 = open.iter().map(|&column| row[column].norm()).sum();
    open.iter().filter(|_| size > 0.0).for_each(|&column| row[column] -= sum * (row[column].norm() / size));
}

/// Factor from the model to a frame.
fn gain(mean: &[Complex64], places: &[usize], model: &[f64]) -> Complex64 {
    let size = median(places.iter().zip(model).map(|(&place, m)| (mean[place] / m).norm()));
    let along: Complex64 = places.iter().zip(model).map(|(&place, m)| mean[place] * *m).sum();
    let along =
        if mean.iter().all(|value| value.im == 0.0 && value.re >= 0.0) { Complex64::ONE } else { along };
    Complex64::from_polar(size, along.arg())
}
