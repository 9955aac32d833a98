//! The kernel of `shaders/relax.wgsl`: one step of relaxation.

use super::{Access, Bindable, Gpu, GpuError, Kernel, Program, Recording};

/// The kernel, compiled once per device.
#[derive(Debug)]
pub(super) struct RelaxKernels {
    program: Program,
    relax: Kernel,
}

impl RelaxKernels {
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        use Access::{Read, Uniform, Write};
        let source = include_str!("../../shaders/relax.wgsl");
        let program = Program::new(gpu, "relax", source, &[Uniform, Read, Read, Read, Read, Read, Write, Uniform])?;
        Ok(Self { relax: program.kernel(gpu, "relax")?, program })
    }

    /// Records the kernel; `buffers` in the order of the shader's bindings.
    pub fn record(
        &self,
        gpu: &Gpu,
        recording: &mut Recording,
        buffers: [&dyn Bindable; 8],
        tiles: usize,
    ) -> Result<(), GpuError> {
        recording.dispatch(&self.relax, &self.program.bind(gpu, &buffers)?, tiles);
        Ok(())
    }
}
