//! Progress on standard error; nothing at all where that is not a terminal.

use indicatif::{ProgressBar, ProgressStyle};
use std::time::Duration;

/// A spinner with a message, for work of unknown length.
pub(super) fn spinner() -> ProgressBar {
    let spinner = ProgressBar::new_spinner();
    spinner.enable_steady_tick(Duration::from_millis(100));
    spinner
}

/// A bar for `length` bytes being sent.
pub(super) fn sending(length: usize) -> ProgressBar {
    let style = ProgressStyle::with_template("sending {bar:40} {bytes} of {total_bytes}");
    ProgressBar::new(length as u64).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}

/// A bar for things that are counted; its message says what they are.
pub(super) fn counting() -> ProgressBar {
    let style = ProgressStyle::with_template("{msg} {bar:40} {pos} of {len}");
    ProgressBar::new(0).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}
