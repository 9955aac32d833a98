//! Signals that end the program.

use quadmosaic::export::discard_drafts;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::low_level::{exit, unregister};
use signal_hook::{SigId, flag};
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;
use std::time::Duration;
use thiserror::Error;

/// The time between two looks for a signal.
const PAUSE: Duration = Duration::from_millis(50);

/// A signal ended the program.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[error("the program was ended by signal {0}")]
pub struct Stopped(u8);

impl Stopped {
    /// The exit code, as shells have it.
    pub fn code(self) -> u8 {
        128 + self.0
    }
}

/// From now on Ctrl-C and SIGTERM end the program at once, but for the removal of files that are not complete. A file that grows too large
/// is an error of its writer.
///
/// # Errors
/// Where the operating system takes no handler, or the thread that waits cannot be started.
pub fn end_by_signals() -> io::Result<()> {
    #[cfg(unix)]
    flag::register(signal_hook::consts::SIGXFSZ, Arc::default())?;
    let signals = Signals::listen()?;
    thread::Builder::new().name("signals".to_owned()).spawn(move || {
        let stopped = signals.wait();
        discard_drafts();
        exit(stopped.code().into())
    })?;
    Ok(())
}

/// The signals since the start: Ctrl-C and SIGTERM.
pub struct Signals {
    last: Arc<AtomicUsize>,
    handlers: Vec<SigId>,
}

impl Signals {
    /// Listens for signals. The first is told; a second one ends the program at once.
    ///
    /// # Errors
    /// Where the operating system takes no handler.
    pub fn listen() -> io::Result<Self> {
        let mut signals = Self { last: Arc::new(AtomicUsize::new(0)), handlers: Vec::new() };
        let is_second = Arc::new(AtomicBool::new(false));
        for signal in [SIGINT, SIGTERM] {
            signals.handlers.extend([
                flag::register_conditional_shutdown(signal, 128 + signal, is_second.clone())?,
                flag::register(signal, is_second.clone())?,
                flag::register_usize(signal, signals.last.clone(), signal.unsigned_abs() as usize)?,
            ]);
        }
        Ok(signals)
    }

    /// The signal that came, if one did.
    pub fn stopped(&self) -> Option<Stopped> {
        let last = u8::try_from(self.last.load(Ordering::Relaxed)).unwrap_or_default();
        (last != 0).then_some(Stopped(last))
    }

    /// Waits for a signal.
    pub fn wait(&self) -> Stopped {
        loop {
            if let Some(stopped) = self.stopped() {
                return stopped;
            }
            thread::sleep(PAUSE);
        }
    }
}

impl Drop for Signals {
    fn drop(&mut self) {
        self.handlers.drain(..).for_each(|handler| {
            unregister(handler);
        });
    }
}
