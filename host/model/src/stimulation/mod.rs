//! Stimulation: which steps make a frame, and how many of them tell something new.

mod combination;
mod report;

pub use combination::{Stimulation, first_of_pairs};
pub use report::{
    PatternReport, Repeated, Repetition, STEP_COLUMNS, pairs_alike, patterns_of_length, repetition, report,
    table_csv,
};
