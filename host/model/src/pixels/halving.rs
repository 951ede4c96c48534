//! Halving: places divided along the longest extent of each part, again and again.

use nalgebra::Point3;
use std::cmp::Ordering;

/// Places in parts of about equal number.
pub(crate) struct Halves {
    /// Indices of the places, part after part; in a part in no particular order.
    places: Vec<usize>,
    sizes: Vec<usize>,
}

impl Halves {
    /// Divides places into `count` parts, at most as many as there are; neighbouring parts were halved last.
    pub(crate) fn new(centres: &[Point3<f64>], count: usize) -> Self {
        let mut halves = Self { places: (0..centres.len()).collect(), sizes: vec![0; count] };
        halve(centres, &mut halves.places, &mut halves.sizes);
        halves
    }

    /// The places of each part.
    pub(crate) fn parts(&self) -> impl Iterator<Item = &[usize]> {
        let mut left = self.places.as_slice();
        self.sizes.iter().map(move |&size| {
            let (part, rest) = left.split_at(size);
            left = rest;
            part
        })
    }
}

/// Sorts places into as many parts as there are `sizes`, which it sets.
fn halve(centres: &[Point3<f64>], part: &mut [usize], sizes: &mut [usize]) {
    let count = sizes.len();
    if count < 2 {
        sizes.fill(part.len());
        return;
    }
    let left = count / 2;
    let middle = (part.len() * left / count).clamp(left, part.len() - (count - left));
    let axis = longest_axis(centres, part);
    part.select_nth_unstable_by(middle, |&a, &b| {
        centres[a][axis].total_cmp(&centres[b][axis]).then(a.cmp(&b))
    });
    let ((part, right), (sizes, of_right)) = (part.split_at_mut(middle), sizes.split_at_mut(left));
    rayon::join(|| halve(centres, part, sizes), || halve(centres, right, of_right));
}

/// The last one, where several are as long.
fn longest_axis(centres: &[Point3<f64>], part: &[usize]) -> usize {
    let mut extents = [(f64::INFINITY, f64::NEG_INFINITY); 3];
    for &place in part {
        for ((low, high), &x) in extents.iter_mut().zip(&centres[place].coords) {
            (*low, *high) = (low.min(x), high.max(x));
        }
    }
    let longer = |a: &usize, b: &usize| -> Ordering {
        let extent = |axis: usize| extents[axis].1 - extents[axis].0;
        extent(*a).total_cmp(&extent(*b))
    };
    (0..3).max_by(longer).unwrap_or(0)
}
