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
        self.end()?;
        self.times.push((stage, Duration::ZERO));
        self.progress.report(stage, 0.0)
    }

    fn end(&mut self) -> Result<(), Cancelled> {
        let now = Instant::now();
        if let Some((stage, time)) = self.times.last_mut() {
            *time = now - self.started;
            self.progress.report(*stage, 1.0)?;
        }
        self.started = now;
        Ok(())
    }

    pub(super) fn finish(mut self) -> Result<Vec<(Stage, Duration)>, Cancelled> {
        self.end()?;
        Ok(self.times)
    }
}
