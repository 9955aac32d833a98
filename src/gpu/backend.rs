//! The stages that have a kernel, on the device.

use super::grid::GridKernels;
use super::relax::{GpuGround, RelaxKernels};
use super::smooth::SmoothKernels;
use super::{Gpu, GpuError};
use crate::compute::{Backend, ComputeError, Ground};
use crate::field::{Complex, Field, Hierarchy};
use crate::surface::Surface;

/// The name of this backend in reports.
const NAME: &str = "gpu";

/// A device with all kernels compiled.
#[derive(Debug)]
pub struct GpuBackend<'gpu> {
    gpu: &'gpu Gpu,
    grid: GridKernels,
    relax: RelaxKernels,
    smooth: SmoothKernels,
}

impl<'gpu> GpuBackend<'gpu> {
    /// Compiles the kernels.
    ///
    /// # Errors
    /// What the driver makes of them.
    pub fn new(gpu: &'gpu Gpu) -> Result<Self, GpuError> {
        Ok(Self { gpu, grid: GridKernels::new(gpu)?, relax: RelaxKernels::new(gpu)?, smooth: SmoothKernels::new(gpu)? })
    }
}

impl From<GpuError> for ComputeError {
    fn from(error: GpuError) -> Self {
        Self { backend: NAME, reason: error.to_string() }
    }
}

impl Backend for GpuBackend<'_> {
    fn name(&self) -> &'static str {
        NAME
    }

    fn adapter(&self) -> String {
        self.gpu.adapter().name.clone()
    }

    fn smooth(&self, hierarchy: &Hierarchy) -> Result<Vec<Complex>, ComputeError> {
        Ok(self.smooth.smooth(self.gpu, hierarchy)?)
    }

    fn ground<'a>(&'a self, surface: &'a Surface, field: &'a Field) -> Result<Box<dyn Ground + 'a>, ComputeError> {
        Ok(Box::new(GpuGround::new(self.gpu, &self.grid, &self.relax, surface, field)?))
    }
}
