//! Runs: one at the same time, its progress, and the last mesh.

use super::meshing::{Meshing, Product};
use crate::cli::sentence;
use quadmosaic::pipeline::{Options, PipelineError, Stage};
use serde::Serialize;
use std::io;
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use thiserror::Error;

/// Why no run begins.
#[derive(Debug, Error)]
pub enum RunError {
    #[error("a run is under way; wait for its end, or cancel it")]
    Busy,
    #[error("the run cannot be started: {0}")]
    NoThread(#[from] io::Error),
}

/// How the last run goes or went.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "state", rename_all = "lowercase")]
pub enum Progress {
    Running {
        stage: &'static str,
        /// The share of the stage that is done, from 0 to 1.
        share: f32,
    },
    Done,
    Cancelled,
    Failed {
        message: String,
    },
}

/// The runs of a server.
pub struct Runs {
    meshing: Meshing,
    state: Mutex<State>,
    is_cancelled: AtomicBool,
}

struct State {
    progress: Progress,
    product: Product,
    /// Whether no run begins any more.
    is_ended: bool,
    thread: Option<JoinHandle<()>>,
}

impl Runs {
    /// No run yet; there is a mesh already.
    pub fn new(meshing: Meshing, product: Product) -> Arc<Self> {
        let state = State { progress: Progress::Done, product, is_ended: false, thread: None };
        Arc::new(Self { meshing, state: Mutex::new(state), is_cancelled: AtomicBool::new(false) })
    }

    pub fn meshing(&self) -> &Meshing {
        &self.meshing
    }

    /// Begins a run.
    ///
    /// # Errors
    /// Where another one is under way.
    pub fn start(self: &Arc<Self>, options: Options) -> Result<(), RunError> {
        let mut state = self.lock();
        if state.is_ended || matches!(state.progress, Progress::Running { .. }) {
            return Err(RunError::Busy);
        }
        self.is_cancelled.store(false, Ordering::Relaxed);
        let runs = self.clone();
        state.thread = Some(thread::Builder::new().name("run".to_owned()).spawn(move || runs.run(&options))?);
        state.progress = Progress::Running { stage: Stage::Surface.name(), share: 0.0 };
        Ok(())
    }

    /// Cancels the run, where there is one; the mesh before stays.
    pub fn cancel(&self) {
        self.is_cancelled.store(true, Ordering::Relaxed);
    }

    pub fn progress(&self) -> Progress {
        self.lock().progress.clone()
    }

    /// The last mesh.
    pub fn product(&self) -> Product {
        self.lock().product.clone()
    }

    /// Cancels the run, and waits for its end; no other one begins.
    pub fn end(&self) {
        let mut state = self.lock();
        state.is_ended = true;
        let thread = state.thread.take();
        drop(state);
        self.cancel();
        if let Some(thread) = thread {
            let _ = thread.join();
        }
    }

    fn run(&self, options: &Options) {
        let watch = |stage: Stage, share| {
            self.lock().progress = Progress::Running { stage: stage.name(), share };
            if self.is_cancelled.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        // A fault of the program must not leave a run under way for ever.
        let made = catch_unwind(AssertUnwindSafe(|| self.meshing.make(options, &watch)));
        let mut state = self.lock();
        state.progress = match made {
            Ok(Ok(product)) => {
                state.product = product;
                Progress::Done
            }
            Ok(Err(error)) if matches!(error.downcast_ref(), Some(PipelineError::Cancelled(_))) => Progress::Cancelled,
            Ok(Err(error)) => Progress::Failed { message: sentence(&error) },
            Err(_) => Progress::Failed {
                message: "the run ended by a fault of the program, which it told where it was started".to_owned(),
            },
        };
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
