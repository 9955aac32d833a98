//! Multigrid and conjugate gradients on the device.
//!
//! # Practice
//! Steps are recorded, and go to the device in one submission when values are asked for.

use super::conjugate::{ConjugateKernels, Descent};
use super::smooth::{SmoothKernels, Sweep};
use super::transfer::{Transfer, TransferKernels};
use super::{Bindable, Buffer, Gpu, GpuError, Kernel, Recording};
use crate::compute::{Complex, ComputeError, Level, Link, Multigrid, Row};

/// The kernels, compiled once per device.
#[derive(Debug)]
pub(super) struct MultigridKernels {
    smooth: SmoothKernels,
    transfer: TransferKernels,
    conjugate: ConjugateKernels,
}

impl MultigridKernels {
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        Ok(Self {
            smooth: SmoothKernels::new(gpu)?,
            transfer: TransferKernels::new(gpu)?,
            conjugate: ConjugateKernels::new(gpu)?,
        })
    }
}

/// A vector that is read and written in turns.
struct Pair {
    buffers: [Buffer<Complex>; 2],
    /// The buffer with the present values.
    present: usize,
}

impl Pair {
    fn present(&self) -> &Buffer<Complex> {
        &self.buffers[self.present]
    }

    fn spare(&self) -> &Buffer<Complex> {
        &self.buffers[1 - self.present]
    }

    /// After the spare buffer was written to.
    fn swap(&mut self) {
        self.present = 1 - self.present;
    }
}

/// One level in the device's memory.
struct LevelBuffers {
    count: usize,
    rows: Buffer<Row>,
    links: Buffer<Link>,
    right_hand_side: Buffer<Complex>,
    parents: Buffer<Link>,
    aggregate_starts: Buffer<u32>,
    members: Buffer<u32>,
    transfer: Buffer<Transfer>,
    /// The settings of sweeps, by their damping; the first ones are those of kernels without any.
    sweeps: Vec<(f32, Buffer<Sweep>)>,
    values: Pair,
    correction: Pair,
    residual: Buffer<Complex>,
    /// What conjugate gradients need, once they are asked for.
    descent: Option<Descent>,
}

impl LevelBuffers {
    fn new(gpu: &Gpu, level: &Level, values: &[Complex]) -> Result<Self, GpuError> {
        let count = level.len();
        let zeros = || gpu.zeros("a vector of unknowns", count);
        let transfer = Transfer { fine: count as u32, coarse: level.aggregate_count() as u32 };
        let mut buffers = Self {
            count,
            rows: gpu.upload("the equations' rows", &level.rows)?,
            links: gpu.upload("the equations' links", &level.links)?,
            right_hand_side: gpu.upload("the equations' right-hand side", &level.right_hand_side)?,
            parents: gpu.upload("the unknowns' aggregates", &level.parents)?,
            aggregate_starts: gpu.upload("the starts of aggregates", &level.aggregate_starts)?,
            members: gpu.upload("the members of aggregates", &level.members)?,
            transfer: gpu.uniform("two levels' sizes", transfer)?,
            sweeps: Vec::new(),
            values: Pair { buffers: [gpu.upload("the values", values)?, zeros()?], present: 0 },
            correction: Pair { buffers: [zeros()?, zeros()?], present: 0 },
            residual: zeros()?,
            descent: None,
        };
        buffers.settings(gpu, 0.0)?;
        Ok(buffers)
    }

    /// The settings of a sweep with this damping.
    fn settings(&mut self, gpu: &Gpu, step: f32) -> Result<Buffer<Sweep>, GpuError> {
        if let Some((_, settings)) = self.sweeps.iter().find(|sweep| sweep.0 == step) {
            return Ok(settings.clone());
        }
        let settings = gpu.uniform("a sweep's settings", Sweep { count: self.count as u32, step })?;
        self.sweeps.push((step, settings.clone()));
        Ok(settings)
    }
}

/// A recording of kernels.
struct Recorder<'a> {
    gpu: &'a Gpu,
    kernels: &'a MultigridKernels,
    recording: Recording<'a>,
}

impl Recorder<'_> {
    /// Records a kernel of `shaders/smooth.wgsl`.
    fn smooth(
        &mut self,
        kernel: &Kernel,
        level: &LevelBuffers,
        settings: &Buffer<Sweep>,
        [wanted, values, result]: [&Buffer<Complex>; 3],
    ) -> Result<(), GpuError> {
        let LevelBuffers { rows, links, right_hand_side, .. } = level;
        let buffers: [&dyn Bindable; 7] = [settings, rows, links, right_hand_side, wanted, values, result];
        self.kernels.smooth.record(self.gpu, &mut self.recording, kernel, buffers, level.count)
    }

    /// Records a kernel of `shaders/transfer.wgsl` between a level and the next coarser one.
    fn transfer(
        &mut self,
        kernel: &Kernel,
        level: &LevelBuffers,
        [values, result]: [&Buffer<Complex>; 2],
        invocations: usize,
    ) -> Result<(), GpuError> {
        let LevelBuffers { transfer, rows, parents, aggregate_starts, members, .. } = level;
        let buffers: [&dyn Bindable; 7] = [transfer, rows, parents, aggregate_starts, members, values, result];
        self.kernels.transfer.record(self.gpu, &mut self.recording, kernel, buffers, invocations)
    }
}

/// The levels, and the steps recorded for them.
pub(super) struct GpuMultigrid<'a> {
    recorder: Recorder<'a>,
    levels: Vec<LevelBuffers>,
}

impl<'a> GpuMultigrid<'a> {
    pub fn new(
        gpu: &'a Gpu,
        kernels: &'a MultigridKernels,
        levels: &[Level],
        start: usize,
        values: &[Complex],
    ) -> Result<Self, GpuError> {
        let buffers = |(depth, level): (usize, &Level)| {
            if depth == start {
                LevelBuffers::new(gpu, level, values)
            } else {
                LevelBuffers::new(gpu, level, &level.fixed_values())
            }
        };
        let levels = levels.iter().enumerate().map(buffers).collect::<Result<_, _>>()?;
        Ok(Self { recorder: Recorder { gpu, kernels, recording: gpu.record() }, levels })
    }
}

impl Multigrid for GpuMultigrid<'_> {
    fn prolong(&mut self, depth: usize) -> Result<(), ComputeError> {
        let (level, coarser) = (&self.levels[depth], &self.levels[depth + 1]);
        let buffers = [coarser.values.present(), level.values.present()];
        Ok(self.recorder.transfer(&self.recorder.kernels.transfer.prolong, level, buffers, level.count)?)
    }

    fn residual(&mut self, depth: usize) -> Result<(), ComputeError> {
        let level = &self.levels[depth];
        let buffers = [level.values.present(), level.values.present(), &level.residual];
        let kernel = &self.recorder.kernels.smooth.residual;
        Ok(self.recorder.smooth(kernel, level, &level.sweeps[0].1, buffers)?)
    }

    fn first_sweep(&mut self, depth: usize, step: f32) -> Result<(), ComputeError> {
        let settings = self.levels[depth].settings(self.recorder.gpu, step)?;
        let level = &self.levels[depth];
        let buffers = [&level.residual, &level.residual, level.correction.present()];
        Ok(self.recorder.smooth(&self.recorder.kernels.smooth.first_sweep, level, &settings, buffers)?)
    }

    fn sweep(&mut self, depth: usize, step: f32) -> Result<(), ComputeError> {
        let settings = self.levels[depth].settings(self.recorder.gpu, step)?;
        let level = &self.levels[depth];
        let buffers = [&level.residual, level.correction.present(), level.correction.spare()];
        self.recorder.smooth(&self.recorder.kernels.smooth.sweep, level, &settings, buffers)?;
        self.levels[depth].correction.swap();
        Ok(())
    }

    fn restrict(&mut self, depth: usize) -> Result<(), ComputeError> {
        let (level, coarser) = (&self.levels[depth], &self.levels[depth + 1]);
        let (y, spare) = (level.correction.present(), level.correction.spare());
        let MultigridKernels { smooth, transfer, .. } = self.recorder.kernels;
        self.recorder.smooth(&smooth.remainder, level, &level.sweeps[0].1, [&level.residual, y, spare])?;
        Ok(self.recorder.transfer(&transfer.gather, level, [spare, &coarser.residual], coarser.count)?)
    }

    fn correct(&mut self, depth: usize) -> Result<(), ComputeError> {
        let (level, coarser) = (&self.levels[depth], &self.levels[depth + 1]);
        let buffers = [coarser.correction.present(), level.correction.present()];
        Ok(self.recorder.transfer(&self.recorder.kernels.transfer.correct, level, buffers, level.count)?)
    }

    fn descend(&mut self, depth: usize, number: u32) -> Result<(), ComputeError> {
        let Recorder { gpu, kernels, .. } = self.recorder;
        if self.levels[depth].descent.is_none() {
            self.levels[depth].descent = Some(Descent::new(gpu, self.levels[depth].count)?);
        }
        let level = &self.levels[depth];
        let Some(descent) = &level.descent else { return Ok(()) };
        let (values, correction) = (level.values.present(), level.correction.present());
        kernels.conjugate.update_direction(
            gpu,
            &mut self.recorder.recording,
            descent,
            &level.residual,
            correction,
            number,
        )?;
        let buffers = [&level.residual, &descent.direction, &descent.image];
        self.recorder.smooth(&kernels.smooth.apply, level, &level.sweeps[0].1, buffers)?;
        kernels.conjugate.advance(gpu, &mut self.recorder.recording, descent, values, &level.residual, number)?;
        Ok(())
    }

    fn normalised_sweep(&mut self, depth: usize, step: f32) -> Result<(), ComputeError> {
        let settings = self.levels[depth].settings(self.recorder.gpu, step)?;
        let level = &self.levels[depth];
        let buffers = [level.values.present(), level.values.present(), level.values.spare()];
        self.recorder.smooth(&self.recorder.kernels.smooth.normalised_sweep, level, &settings, buffers)?;
        self.levels[depth].values.swap();
        Ok(())
    }

    fn values(&mut self, depth: usize) -> Result<Vec<Complex>, ComputeError> {
        let gpu = self.recorder.gpu;
        std::mem::replace(&mut self.recorder.recording, gpu.record()).submit()?;
        Ok(gpu.read(self.levels[depth].values.present())?)
    }
}
