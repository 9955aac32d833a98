//! Progress of a run, its cancellation and its time limit.
//!
//! # Practice
//! Long loops ask [`Progress::is_cancelled`] once an element, from any thread: it calls the user's function only where that was not
//! called for [`INTERVAL`]. A cancelled loop ends early and leaves valid data; the next [`Progress::report`] is the error. A run whose time
//! is over is cancelled likewise, but not in the stage [`Stage::Finish`], which a mesh needs.

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

/// The items up to where the run is cancelled.
pub(crate) fn until_cancelled<'a, T>(
    items: impl Iterator<Item = T> + 'a,
    is_cancelled: &'a IsCancelled,
) -> impl Iterator<Item = T> + 'a {
    let is_wanted = |(k, _): &(usize, T)| !(k.is_multiple_of(ASKED_EVERY) && is_cancelled());
    items.enumerate().take_while(is_wanted).map(|(_, item)| item)
}

/// The time between two calls of the user's function within a stage.
const INTERVAL: Duration = Duration::from_millis(10);

/// A run whose time was over before its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Late {
    /// The time that it had.
    pub limit: Duration,
    /// The stage that it was in.
    pub stage: Stage,
    /// The time that this stage had taken.
    pub taken: Duration,
}

/// The progress of one run.
pub(crate) struct Progress<'a> {
    watch: &'a Watch<'a>,
    limit: Option<Duration>,
    started: Instant,
    /// The time of the last call, in microseconds after the start.
    called: AtomicU64,
    state: Mutex<State>,
    is_cancelled: AtomicBool,
}

struct State {
    stage: Stage,
    share: f32,
    /// The beginning of the stage.
    begun: Instant,
    /// Where the time was over first; `None` where the user cancelled the run.
    late: Option<Late>,
}

impl<'a> Progress<'a> {
    pub fn new(watch: &'a Watch<'a>) -> Self {
        let started = Instant::now();
        Self {
            watch,
            limit: None,
            started,
            called: AtomicU64::new(0),
            state: Mutex::new(State { stage: Stage::Surface, share: 0.0, begun: started, late: None }),
            is_cancelled: AtomicBool::new(false),
        }
    }

    /// The same progress for a run that may take so long from its start.
    pub fn within(self, limit: Option<Duration>) -> Self {
        Self { limit, ..self }
    }

    /// Where the time was over first; `None` where it was not, or the user cancelled the run.
    pub fn late(&self) -> Option<Late> {
        self.state().late
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Reports the share of a stage that is done.
    pub fn report(&self, stage: Stage, share: f32) -> Result<(), Cancelled> {
        let mut state = self.state();
        let State { begun, late, .. } = *state;
        let begun = if state.stage == stage { begun } else { Instant::now() };
        *state = State { stage, share, begun, late };
        if stage == Stage::Finish && late.is_some() {
            self.is_cancelled.store(false, Ordering::Relaxed);
        }
        self.call(state);
        self.check()
    }

    /// Reports the share of the present stage that is done.
    pub fn advance(&self, share: f32) {
        let mut state = self.state();
        state.share = share;
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

    fn call(&self, mut state: MutexGuard<State>) {
        let State { stage, share, begun, .. } = *state;
        if !self.is_cancelled.load(Ordering::Relaxed) {
            let is_broken = (self.watch)(stage, share).is_break();
            let over = self.limit.filter(|limit| stage != Stage::Finish && self.started.elapsed() >= *limit);
            match over {
                _ if is_broken => state.late = None,
                Some(limit) => _ = state.late.get_or_insert(Late { limit, stage, taken: begun.elapsed() }),
                None => {}
            }
            self.is_cancelled.store(is_broken || over.is_some(), Ordering::Relaxed);
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
    fn loops_ask_once_in_so_many_items_and_end_where_the_run_is_cancelled() {
        let asked = AtomicUsize::new(0);
        let passed = |last: usize| {
            asked.store(0, Ordering::Relaxed);
            let is_cancelled = || asked.fetch_add(1, Ordering::Relaxed) >= last;
            until_cancelled(0..10 * ASKED_EVERY, &is_cancelled).count()
        };
        assert_eq!((passed(usize::MAX), asked.load(Ordering::Relaxed)), (10 * ASKED_EVERY, 10));
        assert_eq!([passed(0), passed(3)], [0, 3 * ASKED_EVERY]);
    }

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
