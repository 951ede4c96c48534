//! Stages: how long each part of making a model took.

use std::time::{Duration, Instant};

/// How long one stage took.
#[derive(Clone, Debug)]
pub struct Stage {
    /// Name of the stage.
    pub name: &'static str,
    /// Wall time.
    pub time: Duration,
}

/// Times stages that follow each other.
#[derive(Default)]
pub(super) struct StageClock {
    running: Option<(&'static str, Instant)>,
    done: Vec<Stage>,
}

impl StageClock {
    pub(super) fn begin(&mut self, name: &'static str) -> &'static str {
        self.end();
        self.running = Some((name, Instant::now()));
        name
    }

    fn end(&mut self) {
        if let Some((name, since)) = self.running.take() {
            self.done.push(Stage { name, time: since.elapsed() });
        }
    }

    pub(super) fn finish(mut self) -> Vec<Stage> {
        self.end();
        self.done
    }
}
