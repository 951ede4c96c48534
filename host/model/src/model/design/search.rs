//! Search: exchanges electrodes, and their order, as long as a press stands out better for it.

use super::candidates::Candidates;
use crate::{
    jacobian::jacobian,
    metrics::detectability::{Frame, Sought, significances},
    model::root_mean_square,
    stimulation::first_of_pairs,
};
use dermatome_shared::stimulation::{Driven, pattern};
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// How much the deafest places count: the mean of d' to the power of minus this is made small.
const POWER: i32 = 8;
/// A round that gains less than this is the last.
const GAIN: f64 = 1.003;
/// Most rounds.
const ROUNDS: usize = 12;
/// Starts that are searched from.
const STARTS: usize = 2;
/// After the first round an electrode moves no further than this, in roots of the skin's area.
const REACH: f64 = 0.2;

/// A choice of candidates in the order in which the pattern goes round, and how many of them further pairs reach.
#[derive(Clone, Debug)]
pub(super) struct Choice {
    pub(super) order: Vec<usize>,
    pub(super) distance: u8,
    score: f64,
}

pub(super) struct Search<'a> {
    candidates: &'a Candidates,
    electrodes: usize,
    sought: Sought,
    judged: AtomicUsize,
}

impl<'a> Search<'a> {
    pub(super) fn new(candidates: &'a Candidates, electrodes: usize, sought: Sought) -> Self {
        Self { candidates, electrodes, sought, judged: AtomicUsize::new(0) }
    }

    /// How many choices were judged.
    pub(super) fn judged(&self) -> usize {
        self.judged.load(Ordering::Relaxed)
    }

    /// The best choice found; none where there is no room.
    pub(super) fn run(&self) -> Option<Choice> {
        let inside = (0..=self.electrodes).step_by((self.electrodes / 8).max(1));
        let starts = inside.filter_map(|inside| self.start(inside));
        let mut starts: Vec<_> = starts.filter_map(|order| self.with_best_distance(&order)).collect();
        starts.sort_by(|a, b| b.score.total_cmp(&a.score));
        let ends = starts.into_iter().take(STARTS).map(|start| self.climb(start));
        ends.max_by(|a, b| a.score.total_cmp(&b.score))
    }

    fn climb(&self, mut choice: Choice) -> Choice {
        for round in 0..ROUNDS {
            let before = choice.score;
            let reach = if round == 0 { f64::INFINITY } else { REACH * self.candidates.area.sqrt() };
            for electrode in 0..self.electrodes {
                let moves = self.moves(choice.order[electrode], electrode, reach);
                choice = self.better(choice, moves);
            }
            choice = self.better(choice, self.swaps());
            choice = self
                .with_best_distance(&choice.order)
                .filter(|new| new.score > choice.score)
                .unwrap_or(choice);
            if choice.score < GAIN * before {
                break;
            }
        }
        choice
    }

    /// The best of the choice and of some changes of it.
    fn better(&self, choice: Choice, changes: Vec<Change>) -> Choice {
        let changed = changes.into_par_iter().filter_map(|change| {
            let order = self.changed(&choice.order, change)?;
            Some(self.judge(order, choice.distance))
        });
        let best = changed.max_by(|a, b| a.score.total_cmp(&b.score));
        best.filter(|best| best.score > choice.score).unwrap_or(choice)
    }

    fn moves(&self, from: usize, electrode: usize, reach: f64) -> Vec<Change> {
        let positions = &self.candidates.positions;
        let near = (0..positions.len()).filter(|&to| (positions[to] - positions[from]).norm() <= reach);
        near.filter(|&to| to != from).map(|to| Change::Move { electrode, to }).collect()
    }

    fn swaps(&self) -> Vec<Change> {
        let pairs = (0..self.electrodes).flat_map(|b| (0..b).map(move |a| [a, b]));
        pairs.flat_map(|pair| [Change::Swap(pair), Change::Reverse(pair)]).collect()
    }

    fn changed(&self, order: &[usize], change: Change) -> Option<Vec<usize>> {
        let mut order = order.to_vec();
        match change {
            Change::Move { electrode, to } => {
                let mut others = order.iter().enumerate().filter(|(other, _)| *other != electrode);
                if !others.all(|(_, &other)| self.candidates.are_apart(other, to)) {
                    return None;
                }
                order[electrode] = to;
            }
            Change::Swap([a, b]) => order.swap(a, b),
            Change::Reverse([a, b]) => order[a..=b].reverse(),
        }
        Some(order)
    }

    /// Electrodes spread over the inside, so many, and along the rim, the others; by their angle round the middle.
    fn start(&self, inside: usize) -> Option<Vec<usize>> {
        let Candidates { on_rim, positions, .. } = self.candidates;
        let rim = self.electrodes - inside;
        let along = (0..rim).map(|n| n * on_rim / rim);
        let mut chosen: Vec<usize> = if *on_rim > 0 { along.collect() } else { Vec::new() };
        if chosen.len() < rim {
            return None;
        }
        for _ in 0..inside {
            // Behind the rim's, the one farthest from all chosen; the first where none is.
            let distance = |a: usize| {
                let away = chosen.iter().map(|&b| (positions[a] - positions[b]).norm());
                away.fold(f64::INFINITY, f64::min)
            };
            chosen.push((*on_rim..positions.len()).max_by(|&a, &b| distance(a).total_cmp(&distance(b)))?);
        }
        let is_apart =
            |(n, &a): (usize, &usize)| chosen[..n].iter().all(|&b| self.candidates.are_apart(a, b));
        if !chosen.iter().enumerate().all(is_apart) {
            return None;
        }
        let middle =
            positions.iter().map(|p| p.coords).sum::<nalgebra::Vector3<f64>>() / positions.len() as f64;
        let angle = |candidate: usize| {
            let way = positions[candidate].coords - middle;
            way.x.atan2(way.y)
        };
        chosen.sort_by(|&a, &b| angle(a).total_cmp(&angle(b)));
        Some(chosen)
    }

    fn with_best_distance(&self, order: &[usize]) -> Option<Choice> {
        let distances: Vec<u8> = (1..(self.electrodes / 2) as u8).filter(|&d| self.reaches_all(d)).collect();
        let judged = distances.into_par_iter().map(|distance| self.judge(order.to_vec(), distance));
        judged.max_by(|a, b| a.score.total_cmp(&b.score))
    }

    /// Whether pairs that reach so far hang together: else what lies between their sets is not measured, and the rank
    /// is less than so many electrodes allow.
    fn reaches_all(&self, distance: u8) -> bool {
        let gcd = |mut a: usize, mut b: usize| {
            while b > 0 {
                (a, b) = (b, a % b);
            }
            a
        };
        gcd(self.electrodes, usize::from(distance)) == 1
    }

    /// Scores a choice by its d', smoothed least.
    fn judge(&self, order: Vec<usize>, distance: u8) -> Choice {
        self.judged.fetch_add(1, Ordering::Relaxed);
        let Candidates { mesh, fields, pixels, presses, .. } = self.candidates;
        let all: Vec<_> = pattern(order.len() as u8, distance, distance, Driven::Skipped).collect();
        let steps = first_of_pairs(&all);
        let fields = fields.only(&order);
        let voltages = fields.voltages(&steps);
        let frame = Frame {
            jacobian: &jacobian(mesh, &fields, &steps, pixels),
            step_counts: &vec![1.0; steps.len()],
            step_size: root_mean_square(&voltages),
            voltages: &voltages,
        };
        let all = significances(presses, &frame, self.sought.snr_db);
        let mean = all.iter().map(|d| d.powi(-POWER)).sum::<f64>() / all.len() as f64;
        Choice { order, distance, score: mean.powf(-1.0 / f64::from(POWER)) }
    }
}

/// One change of a choice.
#[derive(Clone, Copy)]
enum Change {
    /// An electrode goes to another candidate.
    Move { electrode: usize, to: usize },
    /// Two change places in the order.
    Swap([usize; 2]),
    /// All from one to another are passed the other way round.
    Reverse([usize; 2]),
}
