//! Drive: how current flows through a skin and voltage is sensed.

use crate::stimulation::{Stimulation, first_of_pairs};
use dermatome_shared::{
    drive::{self, Component, Gain},
    stimulation::{Driven, Step, pattern},
};

/// How current flows and voltage is sensed.
#[derive(Clone, Debug, PartialEq)]
pub struct Drive {
    /// Which pairs drive and sense.
    pub pattern: Pattern,
    /// What becomes of reciprocal steps.
    pub reciprocal: Reciprocal,
    /// Carrier frequency, Hz.
    pub frequency: f64,
    /// Current amplitude, A.
    pub amplitude: f64,
    /// Frames per second.
    pub frame_rate: f64,
    /// By how much the in-phase reference lags the current, degrees.
    pub phase: f64,
    /// Carrier periods between switching and measuring.
    pub settling: f64,
    /// Carrier periods over which a voltage is measured.
    pub integration: u8,
    /// Gain of the programmable amplifier.
    pub gain: Gain,
    /// Which part of a voltage goes into the image.
    pub component: Component,
}

impl Drive {
    /// Stimulation table on so many electrodes: `[step]`, in canonical order.
    #[must_use]
    pub fn steps(&self, electrodes: u8) -> Vec<Step> {
        let steps = match &self.pattern {
            Pattern::Cyclic { drive_distance, sense_distance, driven } => {
                pattern(electrodes, *drive_distance, *sense_distance, *driven).collect()
            }
            Pattern::Table(steps) => steps.clone(),
        };
        if self.reciprocal == Reciprocal::Once { first_of_pairs(&steps) } else { steps }
    }

    /// The same with what becomes of each step; reciprocal steps share a measurement if the skin says so.
    #[must_use]
    pub fn stimulation(&self, electrodes: u8) -> Stimulation {
        let steps = self.steps(electrodes);
        match self.reciprocal {
            Reciprocal::Combined => Stimulation::combined(steps),
            Reciprocal::Kept | Reciprocal::Once => Stimulation::separate(steps),
        }
    }

    /// As boards know it.
    #[must_use]
    pub fn for_board(&self) -> drive::Drive {
        drive::Drive {
            frequency: self.frequency as f32,
            amplitude: self.amplitude as f32,
            frame_rate: self.frame_rate as f32,
            phase: self.phase as f32,
            settling: self.settling as f32,
            integration: self.integration,
            gain: self.gain,
            component: self.component,
        }
    }
}

/// What becomes of reciprocal steps: those with drive and sense pairs exchanged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reciprocal {
    /// Both are measured and averaged into one measurement.
    Combined,
    /// Both are measured, each a measurement of its own.
    Kept,
    /// Only the first of them is measured.
    Once,
}

/// Which pairs drive and sense.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Pattern {
    /// The same from every electrode.
    Cyclic {
        /// Electrodes from one end of the driven pair to the other: 1 is adjacent.
        drive_distance: u8,
        /// The same for the sensing pair.
        sense_distance: u8,
        /// Whether pairs that touch a driven electrode are measured too.
        driven: Driven,
    },
    /// A table of steps, in the order given.
    Table(Vec<Step>),
}
