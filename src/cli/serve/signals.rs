//! Signals that end the program.

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;
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

/// The signals since the start: Ctrl-C and SIGTERM.
pub struct Signals {
    last: Arc<AtomicUsize>,
}

impl Signals {
    /// Listens for signals. The first is told; a second one ends the program at once.
    ///
    /// # Errors
    /// Where the operating system takes no handler.
    pub fn listen() -> io::Result<Self> {
        let (last, is_second) = (Arc::new(AtomicUsize::new(0)), Arc::new(AtomicBool::new(false)));
        for signal in [SIGINT, SIGTERM] {
            flag::register_conditional_shutdown(signal, 128 + signal, is_second.clone())?;
            flag::register(signal, is_second.clone())?;
            flag::register_usize(signal, last.clone(), signal.unsigned_abs() as usize)?;
        }
        Ok(Self { last })
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
