//! Moving: whether a press moves or grows, seen in what frames differ by from the average that it was fitted to.
//!
//! Along its response and slopes, three numbers of some hundred, a press shows far smaller changes than in all of them
//! together (chi square with three degrees of freedom). They are averaged over some frames, where the average is one of many.

use super::{
    spot::UNKNOWNS,
    sums::{Block, Side},
    system::System,
};

/// Differences are averaged over this share of the frames that the average has.
pub(super) const PART: f32 = 16.0;
/// A press moves from here on: chi square with three degrees of freedom is larger in one still frame of a thousand.
const MOVES: f32 = 16.3;

/// A mean of differences.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Moving {
    /// Of the spot whose response and slopes they are along.
    key: Option<u16>,
    mean: Side,
    /// Variance of the frames' part of it, that of one frame being 1.
    variance: f32,
}

impl Moving {
    /// Forgets all.
    pub(super) fn restart(&mut self) {
        self.key = None;
    }

    /// Takes in the sums of what a frame differs by with the response and slopes of a spot, which have these sums with each
    /// other, as this part of the mean; says whether that is more than noise does, the average's variance being this.
    pub(super) fn take(&mut self, key: u16, side: &Side, block: &Block, part: f32, variance: f32) -> bool {
        let part = if self.key == Some(key) { part } else { 1.0 };
        self.key = Some(key);
        self.variance =
            if part < 1.0 { (1.0 - part) * (1.0 - part) * self.variance + part * part } else { 1.0 };
        for (mean, value) in self.mean.iter_mut().zip(side) {
            *mean += part * (value - *mean);
        }
        let moves = explained(&self.mean, block) > MOVES * (self.variance + variance);
        if moves {
            self.restart();
        }
        moves
    }
}

/// What response and slopes explain of data whose sums with them are these, in units of one frame's variance.
fn explained(side: &Side, block: &Block) -> f32 {
    let mut system = System { count: UNKNOWNS, ..System::default() };
    system.right[..UNKNOWNS].copy_from_slice(side);
    for (row, values) in system.matrix.iter_mut().zip(block) {
        row[..UNKNOWNS].copy_from_slice(values);
    }
    if !system.factor() {
        return 0.0;
    }
    system.solution().iter().zip(side).map(|(x, b)| x * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{Rng, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    /// Response and slopes that are at right angles, of these sizes.
    const BLOCK: Block = [[4.0, 0.0, 0.0], [0.0, 9.0, 0.0], [0.0, 0.0, 1.0]];

    /// How many of so many frames a press seems to move in that changes by `change` deviations of one frame along its
    /// first slope, beside an average of `frames`.
    fn moves(frames: f32, change: f32, count: usize) -> usize {
        let mut random = Pcg64Mcg::seed_from_u64(11);
        let mut normal = || (0..12).map(|_| random.random_range(-0.5_f32..0.5)).sum::<f32>();
        let (mut moving, variance) = (Moving::default(), 1.0 / (2.0 * frames));
        let mut of_average: [f32; 3] = [0.0; 3];
        (0..count)
            .filter(|frame| {
                if frame % 100 == 0 {
                    of_average = [(); 3].map(|()| variance.sqrt() * normal());
                }
                let noise = of_average.map(|average| normal() - average);
                let side = [2.0 * noise[0], 3.0 * (change + noise[1]), noise[2]];
                moving.take(7, &side, &BLOCK, (PART / frames).min(1.0), variance)
            })
            .count()
    }

    #[test]
    fn a_press_that_rests_hardly_ever_moves() {
        for frames in [2.0, 10.0, 80.0] {
            let wrong = moves(frames, 0.0, 20_000);
            assert!(wrong < 60, "{wrong} of 20,000, {frames} frames averaged");
        }
    }

    #[test]
    fn many_frames_show_a_smaller_move_than_few() {
        // 5 deviations in one frame.
        assert!(moves(10.0, 6.0, 1) == 1 && moves(80.0, 6.0, 1) == 1);
        // 2 deviations in one are 6 over nine.
        assert!(moves(80.0, 2.5, 40) >= 2, "{}", moves(80.0, 2.5, 40));
        assert!(moves(10.0, 1.0, 40) <= 1, "{}", moves(10.0, 1.0, 40));
    }

    #[test]
    fn another_spot_starts_anew() {
        let mut moving = Moving::default();
        let side = [0.0, 3.0 * 3.5, 0.0];
        assert!(!moving.take(1, &side, &BLOCK, 0.2, 0.01));
        assert!(!moving.take(2, &[0.0; 3], &BLOCK, 0.2, 0.01));
        assert_eq!((moving.mean, moving.variance), ([0.0; 3], 1.0));
    }
}
