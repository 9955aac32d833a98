//! The errors of the GPU backend.

use thiserror::Error;

/// Why the GPU backend could not do what it was asked.
#[derive(Clone, Debug, Error)]
#[non_exhaustive]
pub enum GpuError {
    /// No adapter at all.
    #[error(
        "no GPU adapter found; install a driver for the GPU, or the software one \
         (on Debian and Ubuntu: `apt-get install mesa-vulkan-drivers libvulkan1`), or use the CPU backend"
    )]
    NoAdapter,
    /// Adapters exist, but none has the wanted text in its name.
    #[error("no GPU adapter has \"{wanted}\" in its name; there are: {}", .found.join(", "))]
    NoMatch {
        /// The text that was asked for.
        wanted: String,
        /// The names of the adapters that exist.
        found: Vec<String>,
    },
    /// The driver refused to open the adapter.
    #[error("the GPU adapter \"{adapter}\" could not be opened: {reason}; choose another adapter or the CPU backend")]
    Request {
        /// The adapter's name.
        adapter: String,
        /// The driver's words.
        reason: String,
    },
    /// A buffer larger than any device is sure to hold.
    #[error(
        "the GPU buffer for {what} needs {needed} bytes, and {allowed} are allowed; mesh fewer tiles or use the CPU"
    )]
    BufferTooLarge {
        /// What the buffer holds.
        what: String,
        /// Bytes needed.
        needed: u64,
        /// Bytes allowed by the device's limits.
        allowed: u64,
    },
    /// The device ran out of memory.
    #[error("the GPU is out of memory ({what}); close other programs, mesh fewer tiles or use the CPU backend")]
    OutOfMemory {
        /// What was being done.
        what: String,
    },
    /// The driver rejected a kernel or a command: a defect of this program or of the driver.
    #[error("the GPU rejected {what}: {reason}; this is a defect, please report it with the adapter's name")]
    Rejected {
        /// What was being done.
        what: String,
        /// The driver's words.
        reason: String,
    },
    /// The device went away (driver reset, removal). It stays lost: open another [`Gpu`](super::Gpu).
    #[error("the GPU was lost: {reason}; run again, or use the CPU backend")]
    Lost {
        /// The driver's words.
        reason: String,
    },
    /// A result could not be mapped into the program's memory.
    #[error("the GPU's {what} could not be read back")]
    Map {
        /// What the buffer holds.
        what: String,
    },
    /// The device took longer than any batch should.
    #[error(
        "the GPU did not answer within {seconds} s; it hangs or is far too slow for this batch: use the CPU backend"
    )]
    Timeout {
        /// How long was waited, in seconds.
        seconds: u64,
    },
}
