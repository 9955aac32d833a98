//! The kernel of `shaders/neighbours.wgsl`: neighbour lists.

use super::{Access, Bindable, Gpu, GpuError, Kernel, Program, Recording};

/// The kernel, compiled once per device.
#[derive(Debug)]
pub(super) struct NeighbourKernels {
    program: Program,
    list: Kernel,
}

impl NeighbourKernels {
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        use Access::{Read, Uniform, Write};
        let source = include_str!("../../shaders/neighbours.wgsl");
        let program = Program::new(gpu, "neighbours", source, &[Uniform, Read, Read, Read, Write])?;
        Ok(Self { list: program.kernel(gpu, "list")?, program })
    }

    /// Records the kernel; `buffers` in the order of the shader's bindings.
    pub fn record(
        &self,
        gpu: &Gpu,
        recording: &mut Recording,
        buffers: [&dyn Bindable; 5],
        tiles: usize,
    ) -> Result<(), GpuError> {
        recording.dispatch(&self.list, &self.program.bind(gpu, &buffers)?, tiles);
        Ok(())
    }
}
