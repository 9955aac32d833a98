//! Runs beside the interpreter: on which machine, with which progress.

use crate::error::of_value;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use quadmosaic::options::{self, ValueError};
use quadmosaic::pipeline::{Stage, Watch};
use quadmosaic::{Mesher, PipelineError};
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, OnceLock, PoisonError};
use std::time::Duration;
use std::{process, thread};

/// The time between two looks at the signals.
const PATIENCE: Duration = Duration::from_millis(50);

/// The meshers that were made, by process, backend and adapter: a process makes each once, as a forked one has no device of a GPU.
static MESHERS: Mutex<BTreeMap<Key, Arc<Mesher>>> = Mutex::new(BTreeMap::new());

type Key = (u32, String, Option<String>);

/// The first process that used the common threads. One that is forked from it has none of them, and would wait for them for ever.
static OWNER: OnceLock<u32> = OnceLock::new();

/// Does work on so many threads, 0: on the common ones, or on as many of its own in a forked process.
pub fn on_threads<T: Send>(count: usize, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    if count == 0 && *OWNER.get_or_init(process::id) == process::id() {
        return Ok(work());
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build();
    Ok(pool.map_err(|error| PyRuntimeError::new_err(error.to_string()))?.install(work))
}

/// The backend, the adapter and the number of threads.
#[derive(FromPyObject)]
pub struct Machine(String, Option<String>, String);

impl Machine {
    /// The mesher.
    pub fn mesher(&self, py: Python<'_>) -> PyResult<Arc<Mesher>> {
        let Self(backend, adapter, _) = self;
        py.detach(|| {
            let mut meshers = MESHERS.lock().unwrap_or_else(PoisonError::into_inner);
            let key = (process::id(), backend.clone(), adapter.clone());
            if let Some(mesher) = meshers.get(&key) {
                return Ok(mesher.clone());
            }
            let made = match backend.as_str() {
                "cpu" => Ok(Mesher::cpu()),
                "auto" if adapter.is_none() => Mesher::auto(),
                "auto" | "gpu" => Mesher::gpu(adapter.as_deref()),
                other => {
                    let fault = ValueError::Word(&["auto", "cpu", "gpu"]);
                    return Err(of_value(format!("invalid value '{other}' for backend: {fault}")));
                }
            };
            let made = Arc::new(made.map_err(|error| PyRuntimeError::new_err(error.to_string()))?);
            meshers.insert(key, made.clone());
            Ok(made)
        })
    }

    /// Does work on the wanted number of threads.
    pub fn on_threads<T: Send>(
        &self,
        work: impl FnOnce() -> Result<T, PipelineError> + Send,
    ) -> PyResult<Result<T, PipelineError>> {
        let threads = &self.2;
        let count = options::threads(threads);
        let count = count.map_err(|fault| of_value(format!("invalid value '{threads}' for threads: {fault}")))?;
        on_threads(count, work)
    }
}

/// What the run and the interpreter's thread tell each other.
#[derive(Default)]
struct Shared {
    news: Mutex<News>,
    changed: Condvar,
    is_cancelled: AtomicBool,
}

#[derive(Default)]
struct News {
    latest: Option<(Stage, f32)>,
    is_done: bool,
}

impl Shared {
    fn tell(&self, change: impl FnOnce(&mut News)) {
        change(&mut self.news.lock().unwrap_or_else(PoisonError::into_inner));
        self.changed.notify_one();
    }

    /// The news, or nothing new after a while.
    fn wait(&self) -> News {
        let news = self.news.lock().unwrap_or_else(PoisonError::into_inner);
        let is_old = |news: &mut News| news.latest.is_none() && !news.is_done;
        let waited = self.changed.wait_timeout_while(news, PATIENCE, is_old);
        let mut news = waited.unwrap_or_else(PoisonError::into_inner).0;
        News { latest: news.latest.take(), is_done: news.is_done }
    }
}

/// Does work on a thread of its own. This one calls the progress function and looks at the signals meanwhile; where either raises, the
/// work is cancelled.
pub fn watched<T: Send>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&Watch) -> T + Send,
) -> PyResult<T> {
    let shared = &Shared::default();
    let is_told = progress.is_some();
    let watch = move |stage, share| {
        if is_told {
            shared.tell(|news| news.latest = Some((stage, share)));
        }
        if shared.is_cancelled.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let mut raised = None;
    let done = thread::scope(|scope| {
        let worker = scope.spawn(move || {
            let done = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| work(&watch)));
            shared.tell(|news| news.is_done = true);
            done
        });
        loop {
            let news = py.detach(|| shared.wait());
            if raised.is_none()
                && let Err(error) = tell(py, progress, news.latest)
            {
                raised = Some(error);
                shared.is_cancelled.store(true, Ordering::Relaxed);
            }
            if news.is_done {
                break py.detach(|| worker.join());
            }
        }
    });
    match (raised, done) {
        (Some(error), _) => Err(error),
        (None, Ok(Ok(done))) => Ok(done),
        (None, _) => {
            Err(PyRuntimeError::new_err("the mesher failed; this is a defect, please report it with the surface"))
        }
    }
}

/// Calls the progress function with the news, and looks at the signals.
fn tell(py: Python<'_>, progress: Option<&Bound<'_, PyAny>>, latest: Option<(Stage, f32)>) -> PyResult<()> {
    py.check_signals()?;
    let (Some(progress), Some((stage, share))) = (progress, latest) else { return Ok(()) };
    let answer = progress.call1((stage.name(), share))?;
    match answer.extract::<bool>() {
        Ok(false) => Err(crate::error::Cancelled::new_err("the run was cancelled")),
        _ => Ok(()),
    }
}
