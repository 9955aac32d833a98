//! The choice of the backend of the heavy stages.

use super::output::warn;
use anyhow::Context;
use clap::{Args, ValueEnum};
use quadmosaic::Mesher;
use quadmosaic::options::threads;

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
    /// Threads on the CPU, up to 1024; 0: as many as there are cores
    ///
    /// No more are started than there are cores. The result is the same for any number
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = threads, help_heading = "Machine")]
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

    /// The mesher on the wanted backend; the name of an adapter asks for a GPU.
    ///
    /// # Errors
    /// Where there is no such adapter, it cannot be opened, or it refuses the kernels.
    pub fn mesher(&self) -> anyhow::Result<Mesher> {
        let adapter = self.adapter.as_deref();
        if adapter.is_some() && self.backend == Choice::Cpu {
            warn(["--adapter had no effect with --backend cpu".to_owned()]);
        }
        Ok(match self.backend {
            Choice::Cpu => Mesher::cpu(),
            Choice::Auto if adapter.is_none() => Mesher::auto()?,
            Choice::Auto | Choice::Gpu => Mesher::gpu(adapter)?,
        })
    }
}
