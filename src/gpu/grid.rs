//! The kernels of `shaders/grid.wgsl`: the neighbour grid.

use bytemuck::{Pod, Zeroable};

use super::{Access, Buffer, Gpu, GpuError, Kernel, Program, Recording, WORKGROUP};
use crate::compute::bucket_count;

/// `Grid` in `shaders/common.wgsl`: how points fall into buckets.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct GridSettings {
    /// The number of points.
    pub count: u32,
    /// The length of a point's record, in 16 bytes.
    pub stride: u32,
    /// The number of buckets, a power of two, less one.
    pub mask: u32,
    /// Cells per unit of length.
    pub per_unit: f32,
}

/// The grid's kernels, compiled once per device.
#[derive(Debug)]
pub struct GridKernels {
    program: Program,
    count: Kernel,
    scan_blocks: Kernel,
    scan_sums: Kernel,
    add_sums: Kernel,
    scatter: Kernel,
    order: Kernel,
}

impl GridKernels {
    /// Compiles the kernels.
    ///
    /// # Errors
    ///
    /// What the driver makes of them.
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        use Access::{Read, Uniform, Write};
        let source = include_str!("../../shaders/grid.wgsl");
        let program = Program::new(gpu, "grid", source, &[Uniform, Read, Write, Write, Write, Write])?;
        let kernel = |entry_point| program.kernel(gpu, entry_point);
        Ok(Self {
            count: kernel("count")?,
            scan_blocks: kernel("scan_blocks")?,
            scan_sums: kernel("scan_sums")?,
            add_sums: kernel("add_sums")?,
            scatter: kernel("scatter")?,
            order: kernel("order")?,
            program,
        })
    }
}

/// The grid of one set of points, in the device's memory.
#[derive(Debug)]
pub struct GridBuffers {
    /// `Grid` in `shaders/common.wgsl`.
    pub settings: Buffer<GridSettings>,
    /// Where each bucket begins in `ids`, and after the last one the number of points.
    pub starts: Buffer<u32>,
    /// The points' numbers, sorted by bucket, then by number.
    pub ids: Buffer<u32>,
    cursors: Buffer<u32>,
    block_sums: Buffer<u32>,
    count: usize,
}

impl GridBuffers {
    /// Memory for `count` points whose records of type `T` begin with the position (three `f32`), in cells of side
    /// `cell`.
    ///
    /// # Errors
    ///
    /// [`GpuError::BufferTooLarge`], [`GpuError::OutOfMemory`], or what became of the device.
    pub fn new<T: Pod>(gpu: &Gpu, count: usize, cell: f32) -> Result<Self, GpuError> {
        const { assert!(size_of::<T>().is_multiple_of(16), "the kernels read positions as vec4<f32>") };
        let buckets = bucket_count(count);
        let settings = GridSettings {
            count: count as u32,
            stride: (size_of::<T>() / 16) as u32,
            mask: buckets - 1,
            per_unit: 1.0 / cell,
        };
        Ok(Self {
            settings: gpu.uniform("the grid's settings", settings)?,
            starts: gpu.zeros("the grid's starts", buckets as usize + 1)?,
            ids: gpu.zeros("the grid's ids", count)?,
            cursors: gpu.zeros("the grid's cursors", buckets as usize)?,
            block_sums: gpu.zeros("the grid's block sums", (buckets / WORKGROUP) as usize)?,
            count,
        })
    }

    /// Records the sorting of `points`, for whatever is recorded after it to use.
    ///
    /// # Errors
    ///
    /// [`GpuError::Rejected`], or what became of the device.
    pub fn record<T: Pod>(
        &self,
        gpu: &Gpu,
        kernels: &GridKernels,
        recording: &mut Recording,
        points: &Buffer<T>,
    ) -> Result<(), GpuError> {
        let bindings = kernels
            .program
            .bind(gpu, &[&self.settings, points, &self.cursors, &self.block_sums, &self.starts, &self.ids])?;
        let (points, buckets) = (self.count, self.cursors.len());
        recording.clear(&self.cursors);
        recording.dispatch(&kernels.count, &bindings, points);
        recording.dispatch(&kernels.scan_blocks, &bindings, buckets);
        recording.dispatch(&kernels.scan_sums, &bindings, 1);
        recording.dispatch(&kernels.add_sums, &bindings, buckets);
        recording.dispatch(&kernels.scatter, &bindings, points);
        recording.dispatch(&kernels.order, &bindings, buckets);
        Ok(())
    }
}
