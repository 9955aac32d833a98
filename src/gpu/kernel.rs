//! Kernels, their bindings, and batches of dispatches.

use super::{Buffer, Gpu, GpuError};

/// Invocations in a workgroup of every kernel.
pub const WORKGROUP: u32 = crate::compute::WORKGROUP as u32;

/// What the kernels of a [`Program`] do with one of their bindings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// `var<uniform>`
    Uniform,
    /// `var<storage, read>`
    Read,
    /// `var<storage, read_write>`
    Write,
}

impl Access {
    fn layout_entry(self, binding: usize) -> wgpu::BindGroupLayoutEntry {
        let ty = match self {
            Self::Uniform => wgpu::BufferBindingType::Uniform,
            Self::Read => wgpu::BufferBindingType::Storage { read_only: true },
            Self::Write => wgpu::BufferBindingType::Storage { read_only: false },
        };
        wgpu::BindGroupLayoutEntry {
            binding: binding as u32,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
            count: None,
        }
    }
}

/// One file of kernels that share their bindings.
#[derive(Debug)]
pub struct Program {
    name: String,
    module: wgpu::ShaderModule,
    bindings: wgpu::BindGroupLayout,
    layout: wgpu::PipelineLayout,
}

impl Program {
    /// Reads `source`, WGSL that follows after `shaders/common.wgsl`; `access` lists its bindings in their order.
    ///
    /// # Errors
    ///
    /// [`GpuError::Rejected`] where the source is not valid.
    pub fn new(gpu: &Gpu, name: &str, source: &str, access: &[Access]) -> Result<Self, GpuError> {
        let joined = [include_str!("../../shaders/common.wgsl"), source].join("\n");
        let entries: Vec<_> = access.iter().enumerate().map(|(binding, access)| access.layout_entry(binding)).collect();
        gpu.guarded(name, || {
            // With checks of bounds and loops: they cost no time that can be measured (docs/experiments.md, solver).
            let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(name),
                source: wgpu::ShaderSource::Wgsl(joined.into()),
            });
            let bindings = gpu
                .device
                .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(name), entries: &entries });
            let layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some(name),
                bind_group_layouts: &[Some(&bindings)],
                ..Default::default()
            });
            Self { name: name.to_owned(), module, bindings, layout }
        })
    }

    /// Compiles the kernel with this entry point.
    ///
    /// # Errors
    ///
    /// [`GpuError::Rejected`] where there is no such entry point, or its bindings are not those of the program.
    pub fn kernel(&self, gpu: &Gpu, entry_point: &str) -> Result<Kernel, GpuError> {
        let label = format!("{}: {entry_point}", self.name);
        let pipeline = gpu.guarded(&label, || {
            gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(&label),
                layout: Some(&self.layout),
                module: &self.module,
                entry_point: Some(entry_point),
                compilation_options: wgpu::PipelineCompilationOptions {
                    // Our kernels write workgroup memory before they read it.
                    zero_initialize_workgroup_memory: false,
                    ..Default::default()
                },
                cache: None,
            })
        })?;
        Ok(Kernel { pipeline })
    }

    /// Binds buffers, in the order of the program's bindings.
    ///
    /// # Errors
    ///
    /// [`GpuError::Rejected`] where they do not fit the bindings.
    pub fn bind(&self, gpu: &Gpu, buffers: &[&dyn Bindable]) -> Result<Bindings, GpuError> {
        let entries: Vec<_> = buffers
            .iter()
            .enumerate()
            .map(|(binding, buffer)| wgpu::BindGroupEntry { binding: binding as u32, resource: buffer.resource() })
            .collect();
        let group = gpu.guarded(&self.name, || {
            gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some(&self.name),
                layout: &self.bindings,
                entries: &entries,
            })
        })?;
        Ok(Bindings { group })
    }
}

/// A buffer of any record type.
pub trait Bindable: sealed::Resource {}

impl<T> Bindable for Buffer<T> {}

mod sealed {
    pub trait Resource {
        fn resource(&self) -> wgpu::BindingResource<'_>;
    }

    impl<T> Resource for super::Buffer<T> {
        fn resource(&self) -> wgpu::BindingResource<'_> {
            self.raw.as_entire_binding()
        }
    }
}

/// A compiled kernel.
#[derive(Clone, Debug)]
pub struct Kernel {
    pipeline: wgpu::ComputePipeline,
}

/// Buffers bound in the order of a [`Program`]'s bindings.
#[derive(Clone, Debug)]
pub struct Bindings {
    group: wgpu::BindGroup,
}

/// Dispatches that go to the device together; each sees what those before it wrote.
#[derive(Debug)]
pub struct Recording<'gpu> {
    gpu: &'gpu Gpu,
    encoder: wgpu::CommandEncoder,
}

impl Gpu {
    /// Starts a batch.
    pub fn record(&self) -> Recording<'_> {
        Recording { gpu: self, encoder: self.device.create_command_encoder(&Default::default()) }
    }
}

impl Recording<'_> {
    /// Runs `kernel` with at least `invocations` invocations, in workgroups of [`WORKGROUP`].
    ///
    /// Above 65,535 workgroups the dispatch is two-dimensional: kernels take their number from `invocation_of` in
    /// `shaders/common.wgsl`, and return where it is past their last record.
    pub fn dispatch(&mut self, kernel: &Kernel, bindings: &Bindings, invocations: usize) {
        let [x, y] = workgroups(invocations);
        let mut pass = self.encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&kernel.pipeline);
        pass.set_bind_group(0, &bindings.group, &[]);
        pass.dispatch_workgroups(x, y, 1);
    }

    /// Sets all bytes of a buffer to zero.
    pub fn clear<T>(&mut self, buffer: &Buffer<T>) {
        self.encoder.clear_buffer(&buffer.raw, 0, None);
    }

    /// Copies a buffer's records to another of the same length.
    pub fn copy<T>(&mut self, from: &Buffer<T>, to: &Buffer<T>) {
        self.encoder.copy_buffer_to_buffer(&from.raw, 0, &to.raw, 0, None);
    }

    /// Hands the batch to the device, and does not wait for it.
    ///
    /// # Errors
    ///
    /// [`GpuError::Rejected`] where a dispatch or a copy does not fit its buffers, or what became of the device.
    pub fn submit(self) -> Result<(), GpuError> {
        self.gpu.guarded("a batch of kernels", || {
            self.gpu.queue.submit([self.encoder.finish()]);
        })
    }
}

/// The dispatch, in workgroups, that covers this many invocations.
fn workgroups(invocations: usize) -> [u32; 2] {
    let most = wgpu::Limits::default().max_compute_workgroups_per_dimension as usize;
    let groups = invocations.div_ceil(WORKGROUP as usize);
    let rows = groups.div_ceil(most).max(1);
    [groups.div_ceil(rows) as u32, rows as u32]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn workgroups_cover_every_count_within_the_limits() {
        for invocations in [0, 1, 256, 257, 65_535 * 256, 65_535 * 256 + 1, 1 << 30] {
            let [x, y] = workgroups(invocations);
            assert!(x <= 65_535 && y <= 65_535, "{invocations}");
            let covered = x as usize * y as usize * WORKGROUP as usize;
            assert!(covered >= invocations && covered < invocations + 256 * (y as usize + 1), "{invocations}");
        }
    }
}
