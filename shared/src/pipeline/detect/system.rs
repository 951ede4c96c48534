//! Normal equations of a fit, and their Cholesky factor.

use super::MAX_UNKNOWNS;

/// By unknown.
pub(super) type Unknowns = [f32; MAX_UNKNOWNS];

/// A symmetric, positive definite matrix, of which the lower triangle is used, and a right side.
#[derive(Default)]
pub(super) struct System {
    pub(super) matrix: [Unknowns; MAX_UNKNOWNS],
    pub(super) right: Unknowns,
    pub(super) count: usize,
}

impl System {
    /// Replaces the matrix by its factor, lower triangle; says whether there is one.
    pub(super) fn factor(&mut self) -> bool {
        for i in 0..self.count {
            for j in 0..=i {
                let known: f32 = (0..j).map(|k| self.matrix[i][k] * self.matrix[j][k]).sum();
                let rest = self.matrix[i][j] - known;
                if i == j {
                    if rest.is_nan() || rest <= 1e-6 * self.matrix[i][i] {
                        return false;
                    }
                    self.matrix[i][i] = libm::sqrtf(rest);
                } else {
                    self.matrix[i][j] = rest / self.matrix[j][j];
                }
            }
        }
        true
    }

    /// Solution for the right side, by the factor.
    pub(super) fn solution(&self) -> Unknowns {
        let mut x = self.right;
        self.forward(&mut x, 0);
        for i in (0..self.count).rev() {
            let known: f32 = (i + 1..self.count).map(|k| self.matrix[k][i] * x[k]).sum();
            x[i] = (x[i] - known) / self.matrix[i][i];
        }
        x
    }

    /// Variance of an unknown: an entry of the inverse's diagonal.
    pub(super) fn variance(&self, unknown: usize) -> f32 {
        let mut unit = [0.0; MAX_UNKNOWNS];
        unit[unknown] = 1.0;
        self.forward(&mut unit, unknown);
        unit[unknown..self.count].iter().map(|part| part * part).sum()
    }

    /// Goes down the factor; what lies above the first is zero.
    fn forward(&self, x: &mut Unknowns, first: usize) {
        for i in first..self.count {
            let known: f32 = (first..i).map(|k| self.matrix[i][k] * x[k]).sum();
            x[i] = (x[i] - known) / self.matrix[i][i];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn system() -> System {
        let mut system = System { count: 3, ..System::default() };
        system.right[..3].copy_from_slice(&[2.0, 15.0, 18.0]);
        for (row, values) in [[4.0, 0.0, 0.0], [2.0, 5.0, 0.0], [-2.0, 1.0, 6.0]].into_iter().enumerate() {
            system.matrix[row][..3].copy_from_slice(&values);
        }
        system
    }

    #[test]
    fn solution_and_variances_are_those_of_the_inverse() {
        let mut system = system();
        assert!(system.factor());
        let x = system.solution();
        // 4 a + 2 b - 2 c = 2, 2 a + 5 b + c = 15, -2 a + b + 6 c = 18.
        for (value, expected) in x.iter().zip([1.0, 2.0, 3.0]) {
            assert!((value - expected).abs() < 1e-5, "{x:?}");
        }
        // The determinant is 64; the minors on the diagonal 29, 20 and 16.
        for (unknown, minor) in [29.0, 20.0, 16.0].into_iter().enumerate() {
            assert!((system.variance(unknown) - minor / 64.0).abs() < 1e-6, "{unknown}");
        }
    }

    #[test]
    fn what_cannot_be_told_apart_has_no_factor() {
        let mut system = system();
        system.matrix[1] = [0.0; MAX_UNKNOWNS];
        system.matrix[1][..2].copy_from_slice(&[2.0, 1.0]);
        assert!(!system.factor());
    }
}
