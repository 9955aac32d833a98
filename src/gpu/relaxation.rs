//! The relaxation of tiles on the device.

use super::grid::{GridBuffers, GridKernels};
use super::neighbours::NeighbourKernels;
use super::relax::RelaxKernels;
use super::{Bindable, Buffer, Gpu, GpuError};
use crate::compute::{
    Complex, ComputeError, LIST_LENGTH, LIST_STEPS, Relaxation, RelaxationContext, RelaxationSurface, Tile, Triangle,
};

/// The kernels, compiled once per device.
#[derive(Debug)]
pub(super) struct RelaxationKernels {
    grid: GridKernels,
    neighbours: NeighbourKernels,
    relax: RelaxKernels,
}

impl RelaxationKernels {
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        Ok(Self {
            grid: GridKernels::new(gpu)?,
            neighbours: NeighbourKernels::new(gpu)?,
            relax: RelaxKernels::new(gpu)?,
        })
    }
}

/// A surface in the device's memory.
pub(super) struct GpuRelaxation<'a> {
    gpu: &'a Gpu,
    kernels: &'a RelaxationKernels,
    points: Buffer<[f32; 4]>,
    triangles: Buffer<Triangle>,
    crosses: Buffer<[Complex; 3]>,
}

impl<'a> GpuRelaxation<'a> {
    pub fn new(gpu: &'a Gpu, kernels: &'a RelaxationKernels, surface: &RelaxationSurface) -> Result<Self, GpuError> {
        Ok(Self {
            points: gpu.upload("the surface's points", &surface.points)?,
            triangles: gpu.upload("the surface's triangles", &surface.triangles)?,
            crosses: gpu.upload("the crosses in the triangles", &surface.crosses)?,
            gpu,
            kernels,
        })
    }

    /// All steps go to the device in one submission; only the last one's tiles come back.
    fn steps(&self, tiles: &[Tile], relaxation: &Relaxation) -> Result<Vec<Tile>, GpuError> {
        let Self { gpu, kernels, points, triangles, crosses } = self;
        let count = tiles.len();
        let grid = GridBuffers::new::<Tile>(gpu, count, relaxation.cell)?;
        let mut now = gpu.upload("the tiles", tiles)?;
        let mut then = gpu.upload("the tiles", tiles)?;
        let lists = gpu.zeros::<[u32; LIST_LENGTH]>("the neighbour lists", count)?;
        let scale = gpu.uniform("the scale of the tiles' sizes", relaxation.scale)?;
        let mut recording = gpu.record();
        for step in 0..relaxation.steps {
            if step.is_multiple_of(LIST_STEPS) {
                grid.record(gpu, &kernels.grid, &mut recording, &now)?;
                let buffers: [&dyn Bindable; 5] = [&grid.settings, &now, &grid.starts, &grid.ids, &lists];
                kernels.neighbours.record(gpu, &mut recording, buffers, count)?;
            }
            let buffers: [&dyn Bindable; 8] = [&grid.settings, &now, &lists, points, triangles, crosses, &then, &scale];
            kernels.relax.record(gpu, &mut recording, buffers, count)?;
            std::mem::swap(&mut now, &mut then);
        }
        recording.submit()?;
        gpu.read(&now)
    }
}

impl RelaxationContext for GpuRelaxation<'_> {
    fn relax(&self, tiles: &[Tile], relaxation: &Relaxation) -> Result<Vec<Tile>, ComputeError> {
        Ok(self.steps(tiles, relaxation)?)
    }
}
