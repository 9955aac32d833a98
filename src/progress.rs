//! Progress of a run, and its cancellation.
//!
//! # Practice
//! Long loops ask [`Progress::is_cancelled`] once an element, from any thread: it calls the user's function only where that was not
//! called for [`INTERVAL`]. A cancelled loop ends early and leaves valid data; the next [`Progress::begin`] is the error.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use thiserror::Error;

/// A stage of the method, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Welding, orientation, adjacency, features.
    Surface,
    /// The cross field.
    Field,
    /// Laying and relaxing tiles.
    Mosaic,
    /// Triangulating the tiles and choosing edges.
    Connect,
    /// Filling holes.
    Fill,
    /// Optimising the connectivity: pairing triangles, recutting poor quads.
    Connectivity,
    /// Relocating vertices, and untangling faults.
    Relocate,
    /// Regions, joining of sheets, comparison with the surface.
    Finish,
}

impl Stage {
    /// All of them, in order.
    pub const ALL: [Self; 8] = [
        Self::Surface,
        Self::Field,
        Self::Mosaic,
        Self::Connect,
        Self::Fill,
        Self::Connectivity,
        Self::Relocate,
        Self::Finish,
    ];

    /// Its name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Surface => "surface",
            Self::Field => "field",
            Self::Mosaic => "mosaic",
            Self::Connect => "connect",
            Self::Fill => "fill",
            Self::Connectivity => "connectivity",
            Self::Relocate => "relocate",
            Self::Finish => "finish",
        }
    }
}

/// Receives a stage and the share of it that is done, from 0 to 1; [`ControlFlow::Break`] cancels the run. It is called from any of
/// the run's threads, one call at a time.
pub type Watch<'a> = dyn Fn(Stage, f32) -> ControlFlow<()> + Sync + 'a;

/// A [`Watch`] that never cancels.
pub fn unwatched(_: Stage, _: f32) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// The run was cancelled by its progress function.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("the run was cancelled")]
pub struct Cancelled;

/// Whether a run is cancelled: what loops ask. Cancelled, they end early and leave valid data.
pub(crate) type IsCancelled<'a> = dyn Fn() -> bool + Sync + 'a;

/// Cheap loops ask once in so many elements.
pub(crate) const ASKED_EVERY: usize = 1024;

/// The time between two calls of the user's function within a stage.
const INTERVAL: Duration = Duration::from_millis(10);

/// The progress of one run.
pub(crate) struct Progress<'a> {
    watch: &'a Watch<'a>,
    started: Instant,
    /// The time of the last call, in microseconds after the start.
    called: AtomicU64,
    state: Mutex<(Stage, f32)>,
    is_cancelled: AtomicBool,
}

impl<'a> Progress<'a> {
    pub fn new(watch: &'a Watch<'a>) -> Self {
        Self {
            watch,
            started: Instant::now(),
            called: AtomicU64::new(0),
            state: Mutex::new((Stage::Surface, 0.0)),
            is_cancelled: AtomicBool::new(false),
        }
    }

    /// Reports the share of a stage that is done.
    pub fn report(&self, stage: Stage, share: f32) -> Result<(), Cancelled> {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        *state = (stage, share);
        self.call(state);
        self.check()
    }

    /// Reports the share of the present stage that is done.
    pub fn advance(&self, share: f32) {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        state.1 = share;
        self.call(state);
    }

    /// Asks the user's function again, where that was not called for a while.
    pub fn check(&self) -> Result<(), Cancelled> {
        if self.is_cancelled() { Err(Cancelled) } else { Ok(()) }
    }

    /// As [`Progress::check`]; once it is true it stays so.
    pub fn is_cancelled(&self) -> bool {
        let since = self.now().saturating_sub(self.called.load(Ordering::Relaxed));
        if since > INTERVAL.as_micros() as u64
            && let Ok(state) = self.state.try_lock()
        {
            self.call(state);
        }
        self.is_cancelled.load(Ordering::Relaxed)
    }

    fn now(&self) -> u64 {
        self.started.elapsed().as_micros() as u64
    }

    fn call(&self, state: MutexGuard<(Stage, f32)>) {
        let (stage, share) = *state;
        if !self.is_cancelled.load(Ordering::Relaxed) && (self.watch)(stage, share).is_break() {
            self.is_cancelled.store(true, Ordering::Relaxed);
        }
        self.called.store(self.now(), Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayon::prelude::*;
    use std::sync::atomic::AtomicUsize;

    #[test]
    fn the_function_is_called_once_an_interval_and_not_after_a_break() {
        let calls = AtomicUsize::new(0);
        let watch = |_, share: f32| {
            calls.fetch_add(1, Ordering::Relaxed);
            if share > 0.5 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let progress = Progress::new(&watch);
        assert_eq!(progress.report(Stage::Field, 0.0), Ok(()));
        let found = (0..100_000).into_par_iter().filter(|_| progress.is_cancelled()).count();
        let intervals = progress.started.elapsed().as_millis() as usize / 10;
        assert!(found == 0 && calls.load(Ordering::Relaxed) <= 2 + intervals, "{calls:?} calls");
        assert_eq!(progress.report(Stage::Field, 1.0), Err(Cancelled));
        let before = calls.load(Ordering::Relaxed);
        std::thread::sleep(2 * INTERVAL);
        assert!(progress.is_cancelled() && progress.report(Stage::Mosaic, 0.0).is_err());
        assert_eq!(calls.load(Ordering::Relaxed), before);
    }
}
