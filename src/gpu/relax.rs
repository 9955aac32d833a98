//! Relaxation on the device: the twin of [`crate::mosaic::relax`].

use super::grid::{GridBuffers, GridKernels};
use super::{Access, Bindable, Buffer, Gpu, GpuError, Kernel, Program};
use crate::compute::{ComputeError, Ground};
use crate::field::{Complex, Field};
use crate::mosaic::neighbours::{self, SLOTS};
use crate::mosaic::{Relaxation, Tile};
use crate::surface::{NONE, Surface};
use bytemuck::{Pod, Zeroable};

/// `Triangle` in `shaders/relax.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Triangle {
    /// The vertices.
    pub corners: [u32; 3],
    /// The opposite half-edge of each half-edge; all bits set where it may not be crossed.
    pub beyond: [u32; 3],
}

/// The kernels of neighbour lists and of one step, compiled once per device.
#[derive(Debug)]
pub struct RelaxKernels {
    neighbours: Program,
    list: Kernel,
    program: Program,
    relax: Kernel,
}

impl RelaxKernels {
    /// Compiles the kernels.
    ///
    /// # Errors
    /// What the driver makes of it.
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        use Access::{Read, Uniform, Write};
        let source = include_str!("../../shaders/neighbours.wgsl");
        let neighbours = Program::new(gpu, "neighbours", source, &[Uniform, Read, Read, Read, Write])?;
        let source = include_str!("../../shaders/relax.wgsl");
        let program = Program::new(gpu, "relax", source, &[Uniform, Read, Read, Read, Read, Read, Write, Uniform])?;
        let (list, relax) = (neighbours.kernel(gpu, "list")?, program.kernel(gpu, "relax")?);
        Ok(Self { neighbours, list, program, relax })
    }
}

/// A surface with its field, in the device's memory.
pub(super) struct GpuGround<'a> {
    gpu: &'a Gpu,
    grid: &'a GridKernels,
    kernels: &'a RelaxKernels,
    points: Buffer<[f32; 4]>,
    triangles: Buffer<Triangle>,
    crosses: Buffer<[Complex; 3]>,
}

impl<'a> GpuGround<'a> {
    pub fn new(
        gpu: &'a Gpu,
        grid: &'a GridKernels,
        kernels: &'a RelaxKernels,
        surface: &Surface,
        field: &Field,
    ) -> Result<Self, GpuError> {
        let size = |v: u32| field.sizes().at_vertex(v);
        let points: Vec<[f32; 4]> = surface.points.iter().zip(0..).map(|(p, v)| [p.x, p.y, p.z, size(v)]).collect();
        let beyond = |h: u32| if surface.features().is_feature(h) { NONE } else { surface.twins[h as usize] };
        let triangles: Vec<Triangle> = (0u32..)
            .zip(&surface.triangles)
            .map(|(t, &corners)| Triangle { corners, beyond: [0, 1, 2].map(|k| beyond(3 * t + k)) })
            .collect();
        Ok(Self {
            points: gpu.upload("the surface's points", &points)?,
            triangles: gpu.upload("the surface's triangles", &triangles)?,
            crosses: gpu.upload("the crosses in the triangles", field.in_triangles())?,
            gpu,
            grid,
            kernels,
        })
    }

    /// All steps go to the device in one submission; only the last one's tiles come back.
    fn steps(&self, tiles: &[Tile], relaxation: &Relaxation) -> Result<Vec<Tile>, GpuError> {
        let grid = GridBuffers::new::<Tile>(self.gpu, tiles.len(), relaxation.cell)?;
        let mut now = self.gpu.upload("the tiles", tiles)?;
        let mut then = self.gpu.upload("the tiles", tiles)?;
        let lists = self.gpu.zeros::<[u32; SLOTS]>("the neighbour lists", tiles.len())?;
        let scale = self.gpu.uniform("the scale of the tiles' sizes", relaxation.scale)?;
        let mut recording = self.gpu.record();
        for step in 0..relaxation.steps {
            if step.is_multiple_of(neighbours::STEPS) {
                grid.record(self.gpu, self.grid, &mut recording, &now)?;
                let inputs: [&dyn Bindable; 5] = [&grid.settings, &now, &grid.starts, &grid.ids, &lists];
                recording.dispatch(&self.kernels.list, &self.kernels.neighbours.bind(self.gpu, &inputs)?, tiles.len());
            }
            let Self { points, triangles, crosses, .. } = self;
            let buffers: [&dyn Bindable; 8] = [&grid.settings, &now, &lists, points, triangles, crosses, &then, &scale];
            recording.dispatch(&self.kernels.relax, &self.kernels.program.bind(self.gpu, &buffers)?, tiles.len());
            std::mem::swap(&mut now, &mut then);
        }
        recording.submit()?;
        self.gpu.read(&now)
    }
}

impl Ground for GpuGround<'_> {
    fn relax(&self, tiles: &[Tile], relaxation: &Relaxation) -> Result<Vec<Tile>, ComputeError> {
        Ok(self.steps(tiles, relaxation)?)
    }
}
