//! The choice of the backend of the heavy stages.

use super::numbers::up_to;
use anyhow::Context;
use clap::{Args, ValueEnum};
use quadmosaic::compute::{Backend, Cpu};
use quadmosaic::gpu::{Gpu, GpuBackend, adapters};

/// The wanted backend.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Choice {
    /// A hardware GPU where there is one, else the CPU
    #[default]
    Auto,
    /// The CPU, on all threads
    Cpu,
    /// The best GPU adapter, a software one too
    Gpu,
}

/// The arguments of the backend.
#[derive(Args)]
pub struct Machine {
    /// The backend of the heavy stages
    #[arg(long, value_enum, default_value_t, help_heading = "Machine")]
    backend: Choice,
    /// The GPU whose name contains this text (see `quadmosaic devices`)
    #[arg(long, value_name = "NAME", help_heading = "Machine")]
    adapter: Option<String>,
    /// Threads on the CPU, up to 1024; 0: as many as there are cores. The result is the same for any number
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = up_to::<1024>, help_heading = "Machine")]
    threads: usize,
}

impl Machine {
    /// Starts the wanted number of threads.
    ///
    /// # Errors
    /// Where they cannot be started.
    pub fn start_threads(&self) -> anyhow::Result<()> {
        rayon::ThreadPoolBuilder::new()
            .num_threads(self.threads)
            .build_global()
            .context("the threads cannot be started; ask for fewer with --threads")
    }

    /// Opens the wanted device.
    ///
    /// # Errors
    /// As [`Device::open`].
    pub fn open(&self) -> anyhow::Result<Device> {
        Device::open(self.backend, self.adapter.as_deref())
    }
}

/// The device of the heavy stages.
pub enum Device {
    Cpu,
    Gpu(Gpu),
}

impl Device {
    /// Opens the wanted device; the name of an adapter asks for a GPU.
    ///
    /// # Errors
    /// Where there is no such adapter, or it cannot be opened.
    fn open(choice: Choice, adapter: Option<&str>) -> anyhow::Result<Self> {
        let gpu = match choice {
            Choice::Gpu => true,
            Choice::Cpu => false,
            Choice::Auto => adapter.is_some() || adapters().iter().any(|adapter| adapter.hardware),
        };
        if gpu { Ok(Self::Gpu(Gpu::open(adapter)?)) } else { Ok(Self::Cpu) }
    }

    /// The backend on it.
    ///
    /// # Errors
    /// Where the device refuses the kernels.
    pub fn backend(&self) -> anyhow::Result<Box<dyn Backend + '_>> {
        Ok(match self {
            Self::Cpu => Box::new(Cpu),
            Self::Gpu(gpu) => Box::new(GpuBackend::new(gpu)?),
        })
    }
}
