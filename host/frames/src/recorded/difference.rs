//! Difference data from recorded frames of any kind.
//!
//! With reference r, frame v and model voltage m of one step:
//!
//! ```text
//! dv = Re((v - r) conj(r)) / |r| * sign(m)
//! ```
//!
//! This is the change along the reference's own direction, with the model's sign. It is right for
//! magnitudes without sign (r > 0: v - r), for real data of either polarity (a voltmeter connected
//! the other way round changes the sign of v and of r, which cancels), and for complex data, whose
//! phase, common or not, the reference takes away. A change across the reference's direction
//! (of phase alone) is left out. The direction in which the file senses a pair cancels as well.

use super::order::FileIndex;
use num_complex::Complex64;

/// Difference data in the file's unit: `[step]`. `reference` and `frame` are in the file's order; a
/// step whose reference is zero, a dead measurement, gives 0.
#[must_use]
pub fn difference(
    reference: &[Complex64],
    frame: &[Complex64],
    map: &[FileIndex],
    model: &[f64],
) -> Vec<f64> {
    let of_step = |(place, voltage): (&FileIndex, &f64)| {
        let (r, v) = (reference[place.index], frame[place.index]);
        direction(r).map_or(0.0, |direction| ((v - r) * direction.conj()).re * voltage.signum())
    };
    map.iter().zip(model).map(of_step).collect()
}

/// Magnitudes of the reference with the model's sign, in the file's unit: `[step]`.
#[must_use]
pub fn signed_reference(reference: &[Complex64], map: &[FileIndex], model: &[f64]) -> Vec<f64> {
    let of_step = |(place, voltage): (&FileIndex, &f64)| reference[place.index].norm() * voltage.signum();
    map.iter().zip(model).map(of_step).collect()
}

/// The number of length 1 in the direction of `value`; `None` for zero.
fn direction(value: Complex64) -> Option<Complex64> {
    let norm = value.norm();
    (norm > 0.0).then(|| value / norm)
}

#[cfg(test)]
mod tests {
    use super::*;

    const MODEL: [f64; 3] = [2.0, -4.0, 1.0];
    const REFERENCE: [f64; 3] = [2.0, -4.0, 1.0];
    const FRAME: [f64; 3] = [2.5, -3.0, 0.5];

    fn identity() -> Vec<FileIndex> {
        (0..3).map(|index| FileIndex { index, flipped: false }).collect()
    }

    /// Difference after both frames pass through the same instrument.
    fn through(instrument: impl Fn(usize, f64) -> Complex64) -> Vec<f64> {
        let measure = |frame: [f64; 3]| [0, 1, 2].map(|m| instrument(m, frame[m]));
        difference(&measure(REFERENCE), &measure(FRAME), &identity(), &MODEL)
    }

    #[test]
    fn every_kind_of_instrument_gives_the_same_difference() {
        let exact = [0.5, 1.0, -0.5];
        assert_eq!(through(|_, v| v.into()), exact);
        assert_eq!(through(|_, v| v.abs().into()), exact, "magnitudes");
        assert_eq!(through(|_, v| (-v).into()), exact, "reversed voltmeter");
        assert_eq!(through(|m, v| if m == 1 { (-v).into() } else { v.into() }), exact, "one pair reversed");
        let turned = through(|_, v| Complex64::from_polar(1.0, 2.5) * v);
        assert!(turned.iter().zip(exact).all(|(turned, exact)| (turned - exact).abs() < 1e-12));
    }

    #[test]
    fn a_dead_measurement_gives_no_difference() {
        let reference = [0.0, -4.0, 1.0].map(Complex64::from);
        let frame = [7.0, -4.0, 1.0].map(Complex64::from);
        assert_eq!(difference(&reference, &frame, &identity(), &MODEL), [0.0, 0.0, 0.0]);
    }

    #[test]
    fn the_reference_gets_the_models_signs() {
        let reference = [2.0, 4.0, -1.0].map(Complex64::from);
        assert_eq!(signed_reference(&reference, &identity(), &MODEL), [2.0, -4.0, 1.0]);
    }
}
