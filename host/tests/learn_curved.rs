//! `learn` on curved skins that their model does not know, beside the built patch and regressions on the same presses.
#![cfg(unix)]

mod peers;
mod program;

use dermatome::{
    learn::{
        Request, Strength,
        judge::judge_board,
        learn,
        presses::{Positions, Presses, Recording},
    },
    inverse::targets::half_side,
    mesh::{Mesh, neighbours::boundary_edges, place::nearest_node, refine, triangle},
    model::Model,
    pixels::samples,
    quantize,
    recorded::{order::Arrangement, read::Frames},
    simulate::TrueSkin,
    skin::Skin,
};
use dermatome_shared::patch::PatchView;
use faer::{Mat, Scale, Side, linalg::solvers::Solve};
use nalgebra::{Point3, Vector3};
use num_complex::Complex64;
use peers::{Features, median, regression, some_of};
use program::Desk;
use rand::{Rng, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use std::{cmp::Reverse, collections::BinaryHeap, f64::consts::TAU, path::Path};

/// Presses that nothing is learnt from.
const JUDGED: usize = 80;

fn normal(random: &mut Pcg64Mcg) -> f64 {
    StandardNormal.sample(random)
}

fn shipped(name: &str) -> Skin {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../models/{name}/skin.toml"));
    Skin::load(&file).unwrap().made().unwrap()
}

/// A bent tube that narrows, mm, as STL.
fn tube() -> Vec<u8> {
    let (rings, around, bend) = (40, 72, 0.6_f64);
    let at = |i: usize, j: usize| {
        let (share, turn) = (i as f64 / rings as f64, TAU * (j % around) as f64 / around as f64);
        let (angle, radius) = (bend * share, 55.0 - 17.0 * share);
        let centre = Vector3::new(1.0 - angle.cos(), 0.0, angle.sin()) * (260.0 / bend);
        let across = Vector3::new(angle.cos(), 0.0, -angle.sin());
        centre + (across * turn.cos() + Vector3::y() * turn.sin()) * radius
    };
    let mut bytes = vec![0; 80];
    bytes.extend(((2 * rings * around) as u32).to_le_bytes());
    for (i, j) in (0..rings).flat_map(|i| (0..around).map(move |j| (i, j))) {
        for corners in [[(i, j), (i, j + 1), (i + 1, j + 1)], [(i, j), (i + 1, j + 1), (i + 1, j)]] {
            bytes.extend([0; 12]);
            let corners = corners.map(|(i, j)| at(i, j));
            corners.iter().flat_map(|it| it.iter()).for_each(|it| bytes.extend((*it as f32).to_le_bytes()));
            bytes.extend([0; 2]);
        }
    }
    bytes
}

/// Reaches round half of such a tube.
const SIDE: [&str; 2] = ["--radius", "75"];
/// Reaches round all of it but for a gap, across which places are near in space and far along the skin.
const SLEEVE: [&str; 4] = ["--between-planes", "0,0,1,60,170", "--between-planes", "1,0,0,-100,55"];

/// A skin cut out of such a tube.
fn cut(region: &[&str]) -> Skin {
    let desk = Desk::empty();
    desk.write("forearm.stl", tube());
    let command = ["cut", "forearm.stl", "--unit", "mm", "--around", "-45,0,110", "--out", "skin", "--edge-length", "4"];
    desk.run(&[&command[..], region].concat()).success();
    Skin::load(&desk.path("skin/skin.toml")).unwrap().made().unwrap()
}

/// A random point of a mesh, no nearer to its rim than `rim`, m, and the normal there.
fn place(mesh: &Mesh, rim: f64, random: &mut Pcg64Mcg) -> (Point3<f64>, Vector3<f64>) {
    let areas: Vec<f64> = (0..mesh.elements.len()).map(|element| triangle::area(mesh.corners(element))).collect();
    let all: f64 = areas.iter().sum();
    let edge = boundary_edges(&mesh.elements);
    loop {
        let mut left = random.random::<f64>() * all;
        let element = areas.iter().position(|area| {
            left -= area;
            left <= 0.0
        });
        let Some(element) = element else { continue };
        let [a, b, c] = mesh.corners(element);
        let (u, v): (f64, f64) = (random.random(), random.random());
        let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
        let place = a + (b - a) * u + (c - a) * v;
        if edge.iter().flatten().all(|&node| (mesh.nodes[node] - place).norm() > rim) {
            return (place, triangle::normal([a, b, c]));
        }
    }
}

/// Presses of a finger at random places of a skin that is unlike its model, at 60 dB, recorded up to 3 mm off it.
fn recording(skin: &Skin, count: usize, seed: u64) -> Recording {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let contacts: Vec<Complex64> = (0..usize::from(skin.electrodes.count))
        .map(|_| Complex64::from(0.18 * normal(&mut random).exp()))
        .collect();
    let truth = TrueSkin::with_contacts(skin, &contacts, skin.drive.frequency).unwrap();
    let (mesh, steps) = (truth.mesh(), skin.steps());
    let size = half_side(mesh);
    let spots: Vec<(Point3<f64>, f64)> = (0..12)
        .map(|_| (place(mesh, 0.0, &mut random).0, if random.random() { 1.1 } else { -1.1 }))
        .collect();
    let middles: Vec<Point3<f64>> =
        (0..mesh.elements.len()).map(|element| triangle::centroid(mesh.corners(element))).collect();
    let of_sheet = |middle: &Point3<f64>| {
        let near = |(spot, height): &(Point3<f64>, f64)| {
            height * (-(middle - spot).norm_squared() / (0.3 * size).powi(2)).exp()
        };
        spots.iter().map(near).sum::<f64>().clamp(-1.1, 1.1).exp()
    };
    let sheet: Vec<f64> = middles.iter().map(of_sheet).collect();
    let gains: Vec<f64> = steps.iter().map(|_| (0.2 * normal(&mut random)).exp()).collect();
    let measure = |conductivity: &[f64], random: &mut Pcg64Mcg| -> Vec<Complex64> {
        let voltages = truth.voltages(conductivity, &steps);
        let noise = (voltages.iter().map(|v| v * v).sum::<f64>() / voltages.len() as f64).sqrt() * 1e-3;
        let value = |(v, gain): (&f64, &f64)| Complex64::from(gain * v + noise * normal(random));
        voltages.iter().zip(&gains).map(value).collect()
    };
    let unpressed = measure(&sheet, &mut random);
    let radius = 0.08 * size;
    let (mut values, mut positions) = (Vec::new(), Vec::new());
    for _ in 0..count {
        let (at, outwards) = place(mesh, radius, &mut random);
        let depth = 0.5 * 3f64.powf(random.random());
        let under = |point: Point3<f64>| (1.0 - ((point - at).norm() / radius).powi(2)).max(0.0).sqrt();
        let pressed = |(element, (sheet, middle)): (usize, (&f64, &Point3<f64>))| {
            if (middle - at).norm() > 2.0 * radius {
                return *sheet;
            }
            let (sum, points) = samples(mesh.corners(element))
                .fold((0.0, 0.0), |(sum, points), point| (sum + under(point), points + 1.0));
            sheet * (1.0 + depth * sum / points)
        };
        let conductivity: Vec<f64> = sheet.iter().zip(&middles).enumerate().map(pressed).collect();
        values.extend(measure(&conductivity, &mut random));
        positions.push((at + outwards * random.random_range(-0.003..0.003)).into());
    }
    let frames = |values, frames| Frames { values, frames, measurements: steps.len(), complex: false };
    Recording {
        pressed: frames(values, count),
        unpressed: frames(unpressed, 1),
        positions: Positions::InSpace(positions),
        forces: None,
    }
}

/// Median and 90 % error, mm.
type Figures = [f64; 2];

fn figures(mut errors: Vec<f64>) -> Figures {
    errors.sort_by(f64::total_cmp);
    [0.5, 0.9].map(|share: f64| errors[(share * (errors.len() - 1) as f64).round() as usize])
}

/// Of held-out presses.
struct Compared {
    learnt: Figures,
    built: Figures,
    ridge: Figures,
    kernel: Figures,
    /// Share of presses that the learnt patch shows as another number of contacts than one.
    not_one: f64,
}

fn compared(skin: &Skin, model: &Model, presses: &Presses, count: usize) -> Compared {
    let judged = some_of(presses, 0..JUDGED);
    let taught = some_of(presses, JUDGED..JUDGED + count);
    let request = Request { test_share: 0.0, seed: 1, strength: Strength::Response };
    let learnt = learn(skin, model, &taught, &request).unwrap();
    let all: Vec<usize> = (0..JUDGED).collect();
    let errors = |model: &Model, patch: &[u8]| {
        judge_board(model, &PatchView::validate(patch).unwrap(), &judged, &all).unwrap().errors()
    };
    let (of_learnt, of_built) = (errors(&learnt.model, &learnt.patch), errors(model, &quantize::patch(skin, model).unwrap()));
    let lay = |told: Point3<f64>| model.mesh.nearest(told);
    let ridges = [Features::Linear, Features::Direction, Features::Logarithm]
        .map(|kind| figures(regression(&taught, &judged, kind, false, lay)));
    Compared {
        learnt: [of_learnt.median_mm, of_learnt.ninth_decile_mm],
        built: [of_built.median_mm, of_built.ninth_decile_mm],
        ridge: ridges.into_iter().min_by(|a, b| a[0].total_cmp(&b[0])).unwrap(),
        kernel: figures(regression(&taught, &judged, Features::Direction, true, lay)),
        not_one: (of_learnt.seconds + of_learnt.missed) as f64 / JUDGED as f64,
    }
}

#[test]
fn dev_sweep() {
    let seeds: Vec<u64> = std::env::var("SEEDS").unwrap_or("1,2".into()).split(',').map(|s| s.parse().unwrap()).collect();
    let counts: Vec<usize> = std::env::var("COUNTS").unwrap_or("50,100,200".into()).split(',').map(|s| s.parse().unwrap()).collect();
    let only = std::env::var("SKIN").unwrap_or_default();
    for (name, skin) in [("hemisphere-210mm", shipped("hemisphere-210mm")), ("hemisphere-210mm-designed", shipped("hemisphere-210mm-designed")), ("side of a tube", cut(&SIDE)), ("sleeve with a gap", cut(&SLEEVE))] {
        if !only.is_empty() && only != name { continue; }
        let model = Model::build(&skin, |_| ()).unwrap();
        let all: Vec<Presses> = seeds.iter().map(|&seed| recording(&skin, JUDGED + counts.iter().max().unwrap(), seed).on(&model, &Arrangement::default()).unwrap()).collect();
        println!("{name} {:?}", all[0].off);
        for &count in &counts {
            for (presses, seed) in all.iter().zip(&seeds) {
                let start = std::time::Instant::now();
                let c = compared(&skin, &model, presses, count);
                println!("{name:<26} {count:>4} seed {seed:>3} learnt {:.1?} built {:.1?} ridge {:.1?} kernel {:.1?} not one {:.3} {:.1?}", c.learnt, c.built, c.ridge, c.kernel, c.not_one, start.elapsed());
            }
        }
    }
    let _ = median([1.0].into_iter());
}

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
        (0..count).map(|i| told.row(i).squared_norm_l2() / inverse[(i, i)].powi(2)).sum::<f64>() / count as f64
    };
    let all = [0.3, 0.6, 1.2, 2.4].into_iter().flat_map(|reach| [0.01, 0.03, 0.1, 0.3].map(|noise| of(reach, noise)));
    all.fold(f64::INFINITY, f64::min)
}

#[test]
fn distances_through_space_make_a_covariance_and_those_along_the_skin_do_not() {
    for (name, skin) in [("hemisphere-210mm", shipped("hemisphere-210mm")), ("hemisphere-210mm-designed", shipped("hemisphere-210mm-designed")), ("side of a tube", cut(&SIDE)), ("sleeve with a gap", cut(&SLEEVE))] {
        let model = Model::build(&skin, |_| ()).unwrap();
        let half = half_side(&model.mesh);
        for seed in [1, 2] {
        let presses = recording(&skin, 120, seed).on(&model, &Arrangement::default()).unwrap();
        let (through, along) = (through(&presses.places), along(&model.mesh, &presses.places));
        let circle = Mat::from_fn(120, 120, |i, j| 0.21 * (through[(i, j)] / 0.21).min(1.0).asin());
        println!("{name:<26} missed through {:.4} along {:.4} circle {:.4}; least eigenvalue {:.1e} {:.1e} {:.1e}", missed(&presses, &through, half), missed(&presses, &along, half), missed(&presses, &circle, half), least_eigenvalue(&through, half), least_eigenvalue(&along, half), least_eigenvalue(&circle, half));
        }
    }
}
