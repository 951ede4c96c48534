//! Damped least squares for a few unknowns (Levenberg 1944, Marquardt 1963).
//!
//! A step solves (J'J with its diagonal raised) change = J' left. It is taken if it lowers the sum of squares; if not,
//! the diagonal is raised more and the step is tried again, shorter and nearer to the steepest descent.

use nalgebra::{DMatrix, DVector};

/// What is fitted to what.
pub trait Problem {
    /// A point of the search, with what it explains.
    type State;
    /// Why a point has no value.
    type Error;

    /// Data that this point leaves unexplained: `[datum]`.
    fn left(&self, state: &Self::State) -> DVector<f64>;

    /// Sum of the squares of what is left.
    fn square(&self, state: &Self::State) -> f64;

    /// d explained / d unknown: `[datum][unknown]`.
    fn slopes(&self, state: &Self::State) -> Result<DMatrix<f64>, Self::Error>;

    /// The point behind a step, kept in bounds: `[unknown]`.
    fn moved(&self, state: &Self::State, change: &DVector<f64>) -> Result<Self::State, Self::Error>;
}

/// How the damping goes, and when the search ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Schedule {
    /// Damping of the first step, as a share of the diagonal.
    pub first: f64,
    /// It is multiplied by this where a step does not help.
    pub rise: f64,
    /// It is divided by this where one does.
    pub fall: f64,
    /// It falls no lower.
    pub least: f64,
    /// No step helps once it is above this.
    pub most: f64,
    /// Added to the diagonal whatever the damping.
    pub ridge: f64,
    /// Most steps.
    pub steps: usize,
    /// Most attempts at one step.
    pub attempts: usize,
    /// Most attempts at all steps together.
    pub attempts_in_all: usize,
    /// A step is the last if it lowers the sum of squares by less.
    pub enough: f64,
    /// A step is the last if it lowers the sum of squares by less than this share of it.
    pub enough_share: f64,
}

impl Default for Schedule {
    /// Ends only where no step helps.
    fn default() -> Self {
        Self {
            first: 1e-3,
            rise: 10.0,
            fall: 10.0,
            least: f64::EPSILON,
            most: 1e8,
            ridge: 0.0,
            steps: usize::MAX,
            attempts: usize::MAX,
            attempts_in_all: usize::MAX,
            enough: 0.0,
            enough_share: 0.0,
        }
    }
}

/// Where a search ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fitted<State> {
    /// The best point.
    pub state: State,
    /// Steps that led there.
    pub steps: usize,
}

/// Steps from `start` until none helps or the schedule ends.
pub fn minimise<P: Problem>(
    problem: &P,
    start: P::State,
    schedule: &Schedule,
) -> Result<Fitted<P::State>, P::Error> {
    let mut search = Search { schedule, damping: schedule.first, attempts: 0 };
    let mut state = start;
    for step in 0..schedule.steps {
        let Some(next) = search.step(problem, &state)? else { return Ok(Fitted { state, steps: step }) };
        let (before, after) = (problem.square(&state), problem.square(&next));
        state = next;
        if before - after < schedule.enough || after > (1.0 - schedule.enough_share) * before {
            return Ok(Fitted { state, steps: step + 1 });
        }
    }
    Ok(Fitted { state, steps: schedule.steps })
}

struct Search<'a> {
    schedule: &'a Schedule,
    damping: f64,
    /// Made so far, at all steps.
    attempts: usize,
}

impl Search<'_> {
    /// The point behind one step; none if no step helps.
    fn step<P: Problem>(&mut self, problem: &P, state: &P::State) -> Result<Option<P::State>, P::Error> {
        let slopes = problem.slopes(state)?;
        let (normal, descent) = (slopes.tr_mul(&slopes), slopes.tr_mul(&problem.left(state)));
        let left = self.schedule.attempts_in_all - self.attempts;
        for _ in 0..self.schedule.attempts.min(left) {
            self.attempts += 1;
            if let Some(factor) = self.raised(&normal).cholesky() {
                let next = problem.moved(state, &factor.solve(&descent))?;
                if problem.square(&next) < problem.square(state) {
                    self.damping = (self.damping / self.schedule.fall).max(self.schedule.least);
                    return Ok(Some(next));
                }
            }
            self.damping *= self.schedule.rise;
            if self.damping > self.schedule.most {
                break;
            }
        }
        Ok(None)
    }

    fn raised(&self, normal: &DMatrix<f64>) -> DMatrix<f64> {
        let mut raised = normal.clone();
        for i in 0..raised.nrows() {
            raised[(i, i)] = raised[(i, i)] * (1.0 + self.damping) + self.schedule.ridge;
        }
        raised
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    /// Rosenbrock's valley: its least value is 0, at (1, 1).
    struct Valley;

    impl Problem for Valley {
        type State = [f64; 2];
        type Error = Infallible;

        fn left(&self, &[x, y]: &[f64; 2]) -> DVector<f64> {
            DVector::from_vec(vec![-10.0 * (y - x * x), x - 1.0])
        }

        fn square(&self, state: &[f64; 2]) -> f64 {
            self.left(state).norm_squared()
        }

        fn slopes(&self, &[x, _]: &[f64; 2]) -> Result<DMatrix<f64>, Infallible> {
            Ok(DMatrix::from_row_slice(2, 2, &[-20.0 * x, 10.0, -1.0, 0.0]))
        }

        fn moved(&self, state: &[f64; 2], change: &DVector<f64>) -> Result<[f64; 2], Infallible> {
            Ok([state[0] + change[0], state[1] + change[1]])
        }
    }

    #[test]
    fn a_bent_valley_is_followed_to_its_end() {
        let Ok(Fitted { state, steps }) = minimise(&Valley, [-1.2, 1.0], &Schedule::default());
        assert!((state[0] - 1.0).abs() < 1e-9 && (state[1] - 1.0).abs() < 1e-9, "{state:?} after {steps}");
    }

    #[test]
    fn a_search_ends_where_the_schedule_says() {
        let square = |schedule: &Schedule| {
            let Ok(fitted) = minimise(&Valley, [-1.2, 1.0], schedule);
            (fitted.steps, Valley.square(&fitted.state))
        };
        let (steps, after_two) = square(&Schedule { steps: 2, ..Schedule::default() });
        assert_eq!(steps, 2);
        let (steps, after_one) = square(&Schedule { enough: 1e9, ..Schedule::default() });
        assert_eq!(steps, 1);
        assert!(after_two < after_one && after_one < Valley.square(&[-1.2, 1.0]));
        assert_eq!(square(&Schedule { enough_share: 1.0, ..Schedule::default() }).0, 1);
        assert_eq!(square(&Schedule { attempts_in_all: 0, ..Schedule::default() }).0, 0);
    }
}
