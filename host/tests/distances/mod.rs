//! Distances between presses on curved skins: those through space make a covariance, those along the skin do not.

use crate::{
    Odd, SLEEVE, cut,
    peers::{self, Features},
    shipped,
};
use dermatome::{
    inverse::targets::half_side,
    learn::presses::Presses,
    mesh::{Mesh, place::nearest_node, refine},
};
use faer::{Mat, Scale, Side, linalg::solvers::Solve};
use nalgebra::Point3;
use std::{cmp::Reverse, collections::BinaryHeap};

/// Distances along the edges of a finer mesh, m: `[press][press]`.
fn along(mesh: &Mesh, places: &[Point3<f64>]) -> Mat<f64> {
    let fine = refine(mesh);
    let mut next = vec![Vec::new(); fine.nodes.len()];
    for [a, b, c] in &fine.elements {
        for (from, to) in [(a, b), (b, c), (c, a), (b, a), (c, b), (a, c)] {
            next[*from].push((*to, (fine.nodes[*from] - fine.nodes[*to]).norm()));
        }
    }
    let at: Vec<usize> = places.iter().map(|&place| nearest_node(&fine.nodes, place).0).collect();
    let mut distances = Mat::zeros(places.len(), places.len());
    for (press, &from) in at.iter().enumerate() {
        let mut best = vec![f64::INFINITY; fine.nodes.len()];
        // Distances in nanometres are whole numbers in order.
        let mut open = BinaryHeap::from([(Reverse(0_u64), from)]);
        best[from] = 0.0;
        while let Some((Reverse(reached), node)) = open.pop() {
            if reached as f64 * 1e-9 > best[node] + 2e-9 {
                continue;
            }
            for &(to, length) in &next[node] {
                if best[node] + length < best[to] {
                    best[to] = best[node] + length;
                    open.push((Reverse((best[to] * 1e9) as u64), to));
                }
            }
        }
        at.iter().enumerate().for_each(|(other, &to)| distances[(press, other)] = best[to]);
    }
    Mat::from_fn(places.len(), places.len(), |i, j| (distances[(i, j)] + distances[(j, i)]) / 2.0)
}

fn through(places: &[Point3<f64>]) -> Mat<f64> {
    Mat::from_fn(places.len(), places.len(), |i, j| (places[i] - places[j]).norm())
}

/// Matern 3/2, as `learn` takes it.
fn covariance(distances: &Mat<f64>, reach: f64) -> Mat<f64> {
    Mat::from_fn(distances.nrows(), distances.ncols(), |i, j| {
        let away = 3f64.sqrt() * distances[(i, j)] / reach;
        (1.0 + away) * (-away).exp()
    })
}

/// Smallest eigenvalue of the covariances of all reaches that `learn` tries, as shares of half the larger side.
fn least_eigenvalue(distances: &Mat<f64>, half: f64) -> f64 {
    let of = |reach: f64| covariance(distances, reach * half).self_adjoint_eigenvalues(Side::Lower).unwrap();
    [0.3, 0.6, 1.2, 2.4].into_iter().flat_map(of).fold(f64::INFINITY, f64::min)
}

/// Share of the presses' squares that the others do not tell, of the reach and noise that tell most.
fn missed(presses: &Presses, distances: &Mat<f64>, half: f64) -> f64 {
    let usual = peers::usual(presses);
    let rows = peers::features(presses, &usual, Features::Direction);
    let count = presses.count();
    let of = |reach: f64, noise: f64| {
        let system = covariance(distances, reach * half) + Mat::<f64>::identity(count, count) * Scale(noise);
        let inverse = system.partial_piv_lu().solve(Mat::<f64>::identity(count, count));
        let told = &inverse * &rows;
        (0..count).map(|i| told.row(i).squared_norm_l2() / inverse[(i, i)].powi(2)).sum::<f64>()
            / count as f64
    };
    let all = [0.3, 0.6, 1.2, 2.4]
        .into_iter()
        .flat_map(|reach| [0.01, 0.03, 0.1, 0.3].map(|noise| of(reach, noise)));
    all.fold(f64::INFINITY, f64::min)
}

#[test]
fn distances_through_space_make_a_covariance_and_those_along_the_skin_do_not() {
    println!(
        "not told by the others: through space, along edges, along great circles; least eigenvalue of the same"
    );
    for (name, skin) in
        [("hemisphere-210mm", shipped("hemisphere-210mm")), ("sleeve with a gap", cut(&SLEEVE))]
    {
        let Odd { model, presses, .. } = Odd::new(&skin, 100, 1);
        let half = half_side(&model.mesh);
        let (through, along) = (through(&presses.places), along(&model.mesh, &presses.places));
        let circle =
            Mat::from_fn(100, 100, |i, j| 2.0 * half * (through[(i, j)] / 2.0 / half).min(1.0).asin());
        let of = [&through, &along, &circle];
        let (missed, least) =
            (of.map(|it| missed(&presses, it, half)), of.map(|it| least_eigenvalue(it, half)));
        println!("{name:<20} {missed:.3?}  {}", least.map(|least| format!("{least:.1e}")).join(" "));
        assert!(least[0] > 0.0 && least[1] < -1e-2, "{name}: {least:?}");
        assert!(missed[0] < missed[1], "{name}: {missed:?}");
        if name == "hemisphere-210mm" {
            assert!(least[2] < -1e-3 && missed[0] < 1.01 * missed[2], "{least:?} {missed:?}");
        }
    }
}
