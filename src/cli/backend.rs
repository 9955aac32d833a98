//! The choice of where the heavy stages run.

use clap::ValueEnum;
use quadmosaic::compute::{Backend, Cpu};
use quadmosaic::gpu::{Gpu, GpuBackend, adapters};

/// What the user asked for.
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

/// What the heavy stages run on.
pub enum Device {
    Cpu,
    Gpu(Gpu),
}

impl Device {
    /// Opens what was asked for; naming an adapter asks for a GPU.
    ///
    /// # Errors
    /// Where there is no such adapter, or it cannot be opened.
    pub fn open(choice: Choice, adapter: Option<&str>) -> anyhow::Result<Self> {
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
