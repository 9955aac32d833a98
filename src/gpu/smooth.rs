//! Smoothing of the field on the device: the twin of [`crate::field::smooth`].

use super::{Access, Buffer, Gpu, GpuError, Kernel, Program, Recording};
use crate::field::smooth::{seed, sweeps};
use crate::field::{Complex, Hierarchy, Level};
use bytemuck::{Pod, Zeroable};

/// `Sweep` in `shaders/smooth.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Sweep {
    /// The number of unknowns on the level.
    pub count: u32,
    /// 1: each value is normalised.
    pub unit: u32,
}

/// `Link` and `Parent` in `shaders/smooth.wgsl`: an unknown, and the factor that it is read with.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Link {
    /// The unknown.
    pub neighbour: u32,
    /// The factor.
    pub weight: Complex,
}

/// The kernels, compiled once per device.
#[derive(Debug)]
pub struct SmoothKernels {
    program: Program,
    sweep: Kernel,
    prolong: Kernel,
}

/// One level in the device's memory.
struct LevelBuffers {
    count: usize,
    linear: Buffer<Sweep>,
    unit: Buffer<Sweep>,
    starts: Buffer<u32>,
    links: Buffer<Link>,
    pulls: Buffer<Complex>,
    parents: Buffer<Link>,
}

impl LevelBuffers {
    fn new(gpu: &Gpu, level: &Level) -> Result<Self, GpuError> {
        let join = |(&neighbour, &weight)| Link { neighbour, weight };
        let links: Vec<Link> = level.neighbours.iter().zip(&level.weights).map(join).collect();
        let parents: Vec<Link> = level.parents.iter().zip(&level.turns).map(join).collect();
        let sweep = |unit| gpu.uniform("the sweep's settings", Sweep { count: level.len() as u32, unit });
        Ok(Self {
            count: level.len(),
            linear: sweep(0)?,
            unit: sweep(1)?,
            starts: gpu.upload("where the field's links start", &level.starts)?,
            links: gpu.upload("the field's links", &links)?,
            pulls: gpu.upload("the field's constraints", &level.pulls)?,
            parents: gpu.upload("the field's coarser level", &parents)?,
        })
    }
}

impl SmoothKernels {
    /// Compiles the kernels.
    ///
    /// # Errors
    /// What the driver makes of them.
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        use Access::{Read, Uniform, Write};
        let source = include_str!("../../shaders/smooth.wgsl");
        let program = Program::new(gpu, "smooth", source, &[Uniform, Read, Read, Read, Read, Read, Write])?;
        let (sweep, prolong) = (program.kernel(gpu, "smooth_once")?, program.kernel(gpu, "prolong")?);
        Ok(Self { program, sweep, prolong })
    }

    /// The crosses of the finest level; all sweeps on all levels go to the device in one submission.
    pub(super) fn smooth(&self, gpu: &Gpu, hierarchy: &Hierarchy) -> Result<Vec<Complex>, GpuError> {
        let Some((coarsest, finer)) = hierarchy.levels.split_last() else { return Ok(Vec::new()) };
        let mut recording = gpu.record();
        let plan = |coarsest| sweeps(hierarchy.constrained, coarsest);
        let seeds = gpu.upload("the coarsest crosses", &seed(coarsest))?;
        let mut values = self.sweeps(gpu, &mut recording, &LevelBuffers::new(gpu, coarsest)?, seeds, plan(true))?;
        for level in finer.iter().rev() {
            let level = LevelBuffers::new(gpu, level)?;
            let fine = gpu.zeros("the crosses", level.count)?;
            self.dispatch(gpu, &mut recording, &self.prolong, &level, &level.unit, &values, &fine)?;
            values = self.sweeps(gpu, &mut recording, &level, fine, plan(false))?;
        }
        recording.submit()?;
        gpu.read(&values)
    }

    fn sweeps(
        &self,
        gpu: &Gpu,
        recording: &mut Recording,
        level: &LevelBuffers,
        mut now: Buffer<Complex>,
        [linear, unit]: [u32; 2],
    ) -> Result<Buffer<Complex>, GpuError> {
        let mut then = gpu.zeros("the crosses", level.count)?;
        for sweep in 0..linear + unit {
            let settings = if sweep < linear { &level.linear } else { &level.unit };
            self.dispatch(gpu, recording, &self.sweep, level, settings, &now, &then)?;
            std::mem::swap(&mut now, &mut then);
        }
        Ok(now)
    }

    #[expect(clippy::too_many_arguments, reason = "a dispatch names every buffer that it binds")]
    fn dispatch(
        &self,
        gpu: &Gpu,
        recording: &mut Recording,
        kernel: &Kernel,
        level: &LevelBuffers,
        settings: &Buffer<Sweep>,
        from: &Buffer<Complex>,
        to: &Buffer<Complex>,
    ) -> Result<(), GpuError> {
        let bindings =
            self.program.bind(gpu, &[settings, &level.starts, &level.links, &level.pulls, &level.parents, from, to])?;
        recording.dispatch(kernel, &bindings, level.count);
        Ok(())
    }
}
