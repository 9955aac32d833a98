//! The kernels of `shaders/transfer.wgsl`: values carried between a level and the next coarser one.

use super::{Access, Bindable, Gpu, GpuError, Kernel, Program, Recording};
use bytemuck::{Pod, Zeroable};

/// `Transfer` in `shaders/transfer.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Transfer {
    /// The number of unknowns on the finer level.
    pub fine: u32,
    /// On the coarser one.
    pub coarse: u32,
}

/// The kernels, compiled once per device.
#[derive(Debug)]
pub(super) struct TransferKernels {
    program: Program,
    pub prolong: Kernel,
    pub correct: Kernel,
    pub gather: Kernel,
}

impl TransferKernels {
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        use Access::{Read, Uniform, Write};
        let source = include_str!("../../shaders/transfer.wgsl");
        let program = Program::new(gpu, "transfer", source, &[Uniform, Read, Read, Read, Read, Read, Write])?;
        Ok(Self {
            prolong: program.kernel(gpu, "prolong")?,
            correct: program.kernel(gpu, "correct")?,
            gather: program.kernel(gpu, "gather")?,
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
        invocations: usize,
    ) -> Result<(), GpuError> {
        recording.dispatch(kernel, &self.program.bind(gpu, &buffers)?, invocations);
        Ok(())
    }
}
