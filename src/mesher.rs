//! A backend that is made once and meshes many surfaces.

use crate::compute::{Backend, Cpu};
#[cfg(feature = "gpu")]
use crate::gpu::{Gpu, GpuBackend, GpuError, adapters, can_have_hardware};
use crate::pipeline::{Options, Outcome, PipelineError, Watch, run, unwatched};
use crate::report::Report;
use crate::surface::Soup;

/// Meshes surfaces on one backend.
///
/// # Practice
/// Make one and keep it: on a GPU the kernels are compiled once. Several threads may use it at the same time; each gets the mesh that
/// it would get alone.
pub struct Mesher {
    backend: Box<dyn Backend>,
}

impl Mesher {
    /// On the CPU, on the threads of rayon's pool.
    pub fn cpu() -> Self {
        Self { backend: Box::new(Cpu) }
    }

    /// On the best GPU, a software one too, whose name contains `adapter`.
    ///
    /// # Errors
    /// Where there is no such adapter, it cannot be opened, or it refuses the kernels.
    #[cfg(feature = "gpu")]
    pub fn gpu(adapter: Option<&str>) -> Result<Self, GpuError> {
        Ok(Self { backend: Box::new(GpuBackend::new(&Gpu::open(adapter)?)?) })
    }

    /// On a hardware GPU where there is one, else on the CPU.
    ///
    /// # Errors
    /// Where the GPU cannot be opened, or it refuses the kernels.
    #[cfg(feature = "gpu")]
    pub fn auto() -> Result<Self, GpuError> {
        let has_hardware = can_have_hardware() && adapters().iter().any(|adapter| adapter.hardware);
        if has_hardware { Self::gpu(None) } else { Ok(Self::cpu()) }
    }

    /// The backend.
    pub fn backend(&self) -> &dyn Backend {
        &*self.backend
    }

    /// Meshes a soup of triangles.
    ///
    /// # Errors
    /// As [`run`].
    pub fn mesh(&self, soup: &Soup, options: &Options) -> Result<Outcome, PipelineError> {
        run(soup, options, self.backend(), &unwatched)
    }

    /// As [`Mesher::mesh`]; `watch` receives the progress and can cancel the run.
    ///
    /// # Errors
    /// As [`run`].
    pub fn mesh_watched(&self, soup: &Soup, options: &Options, watch: &Watch) -> Result<Outcome, PipelineError> {
        run(soup, options, self.backend(), watch)
    }

    /// The report on a mesh that this mesher has made of the surface called `name`.
    pub fn report(&self, name: &str, options: &Options, outcome: &Outcome) -> Report {
        Report::new(name, options, self.backend(), outcome)
    }
}
