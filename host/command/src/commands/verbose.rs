//! `--verbose`: what a command does, step by step, on standard error.

use dermatome_link::words::escaped_lines;
use log::{LevelFilter, Log, Metadata, Record};
use std::time::Instant;

/// Tells the steps of this program's own crates, each with the time since the start.
struct Steps {
    start: Instant,
}

/// From here on, steps are told.
pub(super) fn begin() {
    let told = log::set_boxed_logger(Box::new(Steps { start: Instant::now() }));
    if told.is_ok() {
        log::set_max_level(LevelFilter::Debug);
    }
}

impl Log for Steps {
    fn enabled(&self, metadata: &Metadata<'_>) -> bool {
        metadata.target().starts_with("dermatome")
    }

    fn log(&self, record: &Record<'_>) {
        if self.enabled(record.metadata()) {
            let words = escaped_lines(&record.args().to_string());
            eprintln!("[{:9.3} s] {words}", self.start.elapsed().as_secs_f64());
        }
    }

    fn flush(&self) {}
}
