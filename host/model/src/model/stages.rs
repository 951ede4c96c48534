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

/// Does something and says how long it took.
pub(super) fn timed<R>(name: &'static str, stage: impl FnOnce() -> R) -> (R, Stage) {
    let since = Instant::now();
    let result = stage();
    (result, Stage { name, time: since.elapsed() })
}

/// Times stages. Those that run side by side add up to more than they took together.
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

    pub(super) fn end(&mut self) {
        if let Some((name, since)) = self.running.take() {
            let time = since.elapsed();
            log::debug!("model, {name}: {:.3} s", time.as_secs_f64());
            self.done.push(Stage { name, time });
        }
    }

    /// Notes a stage that was timed by itself.
    pub(super) fn take<R>(&mut self, (result, stage): (R, Stage)) -> R {
        self.done.push(stage);
        result
    }

    pub(super) fn finish(mut self) -> Vec<Stage> {
        self.end();
        self.done
    }
}
