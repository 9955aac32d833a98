//! The kernels on the device, as a backend.

use super::multigrid::{GpuMultigrid, MultigridKernels};
use super::relaxation::{GpuRelaxation, RelaxationKernels};
use super::{Gpu, GpuError};
use crate::compute::{Backend, Complex, ComputeError, Level, Multigrid, RelaxationContext, RelaxationSurface};

/// The name of this backend in reports.
const NAME: &str = "gpu";

/// A device with all kernels compiled.
#[derive(Debug)]
pub struct GpuBackend {
    gpu: Gpu,
    multigrid: MultigridKernels,
    relaxation: RelaxationKernels,
}

impl GpuBackend {
    /// Compiles the kernels.
    ///
    /// # Errors
    /// What the driver makes of them.
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        Ok(Self { gpu: gpu.clone(), multigrid: MultigridKernels::new(gpu)?, relaxation: RelaxationKernels::new(gpu)? })
    }
}

impl From<GpuError> for ComputeError {
    fn from(error: GpuError) -> Self {
        Self::Failed { backend: NAME, source: error.into() }
    }
}

impl Backend for GpuBackend {
    fn name(&self) -> &'static str {
        NAME
    }

    fn adapter(&self) -> String {
        self.gpu.adapter().name.clone()
    }

    fn multigrid<'a>(
        &'a self,
        levels: &'a [Level],
        start: usize,
        values: &[Complex],
    ) -> Result<Box<dyn Multigrid + 'a>, ComputeError> {
        Ok(Box::new(GpuMultigrid::new(&self.gpu, &self.multigrid, levels, start, values)?))
    }

    fn relaxation<'a>(
        &'a self,
        surface: &'a RelaxationSurface,
    ) -> Result<Box<dyn RelaxationContext + 'a>, ComputeError> {
        Ok(Box::new(GpuRelaxation::new(&self.gpu, &self.relaxation, surface)?))
    }
}
