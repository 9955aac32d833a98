//! The kernels of `shaders/smooth.wgsl`: residuals and Jacobi sweeps.

use super::{Access, Bindable, Gpu, GpuError, Kernel, Program, Recording};
use bytemuck::{Pod, Zeroable};

/// `Sweep` in `shaders/smooth.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Sweep {
    /// The number of unknowns on the level.
    pub count: u32,
    /// The damping: the share of the residual, over the diagonal, that a value is moved by.
    pub step: f32,
}

/// The kernels, compiled once per device.
#[derive(Debug)]
pub(super) struct SmoothKernels {
    program: Program,
    pub residual: Kernel,
    pub first_sweep: Kernel,
    pub sweep: Kernel,
    pub remainder: Kernel,
    pub apply: Kernel,
    pub normalised_sweep: Kernel,
}

impl SmoothKernels {
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        use Access::{Read, Uniform, Write};
        let source = include_str!("../../shaders/smooth.wgsl");
        let program = Program::new(gpu, "smooth", source, &[Uniform, Read, Read, Read, Read, Read, Write])?;
        Ok(Self {
            residual: program.kernel(gpu, "residual")?,
            first_sweep: program.kernel(gpu, "first_sweep")?,
            sweep: program.kernel(gpu, "sweep_again")?,
            remainder: program.kernel(gpu, "remainder")?,
            apply: program.kernel(gpu, "apply")?,
            normalised_sweep: program.kernel(gpu, "normalised_sweep")?,
            program,
        })
    }

    /// Records one of the kernels; `buffers` in the order of the shader's bindings.
    pub fn record(
        &self,
        gpu: &Gpu,
        recording: &mut Recording,
        kernel: &Kernel,
        buffers: [&dyn Bindable; 7],
        unknowns: usize,
    ) -> Result<(), GpuError> {
        recording.dispatch(kernel, &self.program.bind(gpu, &buffers)?, unknowns);
        Ok(())
    }
}
