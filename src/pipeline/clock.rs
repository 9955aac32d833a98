//! The times of stages, and their progress.

use crate::progress::{Cancelled, Progress, Stage};
use std::time::{Duration, Instant};

/// Measures the times of stages and reports their progress.
pub(super) struct Clock<'a> {
    pub(super) progress: &'a Progress<'a>,
    times: Vec<(Stage, Duration)>,
    started: Instant,
}

impl<'a> Clock<'a> {
    pub(super) fn new(progress: &'a Progress<'a>) -> Self {
        Self { progress, times: Vec::new(), started: Instant::now() }
    }

    pub(super) fn begin(&mut self, stage: Stage) -> Result<(), Cancelled> {
        self.end();
        self.times.push((stage, Duration::ZERO));
        self.progress.report(stage, 0.0)
    }

    /// As [`begin`](Self::begin), for a stage that improves a mesh that is there already: where the time is over, its loops end at once,
    /// but the run goes on.
    pub(super) fn begin_improving(&mut self, stage: Stage) -> Result<(), Cancelled> {
        let begun = self.begin(stage);
        if self.progress.late().is_some() { Ok(()) } else { begun }
    }

    fn end(&mut self) {
        let now = Instant::now();
        if let Some((_, time)) = self.times.last_mut() {
            *time = now - self.started;
            self.progress.advance(1.0);
        }
        self.started = now;
    }

    pub(super) fn finish(mut self) -> Result<Vec<(Stage, Duration)>, Cancelled> {
        self.end();
        self.progress.check()?;
        Ok(self.times)
    }
}
