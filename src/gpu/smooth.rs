//! Smoothing of the field on the device: the twin of [`crate::field::smooth`].

use super::conjugate::{ConjugateKernels, Descent};
use super::{Access, Bindable, Buffer, Gpu, GpuError, Kernel, Program, Recording};
use crate::field::smooth::{STEPS, Steps, UNIT_STEP, schedule};
use crate::field::{Complex, Hierarchy, Link, Row};
use bytemuck::{Pod, Zeroable};

/// `Sweep` in `shaders/smooth.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Sweep {
    /// The number of unknowns on the level.
    pub count: u32,
    /// The share of the residual, over the diagonal, that a value is moved by.
    pub step: f32,
}

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
pub struct SmoothKernels {
    equations: Program,
    begin: Kernel,
    first_sweep: Kernel,
    sweep: Kernel,
    leave: Kernel,
    apply: Kernel,
    flow: Kernel,
    transfer: Program,
    prolong: Kernel,
    correct: Kernel,
    gather: Kernel,
    conjugate: ConjugateKernels,
}

impl SmoothKernels {
    /// Compiles the kernels.
    ///
    /// # Errors
    /// What the driver makes of them.
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        use Access::{Read, Uniform, Write};
        let access = [Uniform, Read, Read, Read, Read, Read, Write];
        let equations = Program::new(gpu, "smooth", include_str!("../../shaders/smooth.wgsl"), &access)?;
        let transfer = Program::new(gpu, "transfer", include_str!("../../shaders/transfer.wgsl"), &access)?;
        Ok(Self {
            begin: equations.kernel(gpu, "begin")?,
            first_sweep: equations.kernel(gpu, "sweep_first")?,
            sweep: equations.kernel(gpu, "sweep_again")?,
            leave: equations.kernel(gpu, "leave")?,
            apply: equations.kernel(gpu, "apply")?,
            flow: equations.kernel(gpu, "flow")?,
            equations,
            prolong: transfer.kernel(gpu, "prolong")?,
            correct: transfer.kernel(gpu, "correct")?,
            gather: transfer.kernel(gpu, "gather")?,
            transfer,
            conjugate: ConjugateKernels::new(gpu)?,
        })
    }

    /// The crosses of the finest level; everything goes to the device in one submission.
    pub(super) fn smooth(&self, gpu: &Gpu, hierarchy: &Hierarchy) -> Result<Vec<Complex>, GpuError> {
        let levels: Vec<LevelBuffers> = (0..hierarchy.levels.len())
            .map(|depth| LevelBuffers::new(gpu, hierarchy, depth))
            .collect::<Result<_, _>>()?;
        let place = vec![Place::default(); levels.len()];
        let mut run = Run { gpu, kernels: self, recording: gpu.record(), levels: &levels, place };
        schedule(&mut run, hierarchy)?;
        let Run { recording, place, .. } = run;
        recording.submit()?;
        gpu.read(&levels[0].crosses[place[0].crosses])
    }
}

/// One level in the device's memory.
struct LevelBuffers {
    count: usize,
    rows: Buffer<Row>,
    links: Buffer<Link>,
    pulls: Buffer<Complex>,
    parents: Buffer<Link>,
    families: Buffer<u32>,
    members: Buffer<u32>,
    transfer: Buffer<Transfer>,
    /// Sweeps by their steps.
    sweeps: Vec<(f32, Buffer<Sweep>)>,
    /// What sweeps read and what they write, in turns.
    crosses: [Buffer<Complex>; 2],
    correction: [Buffer<Complex>; 2],
    residual: Buffer<Complex>,
    /// What conjugate gradients need, on levels that are solved.
    descent: Option<Descent>,
}

impl LevelBuffers {
    fn new(gpu: &Gpu, hierarchy: &Hierarchy, depth: usize) -> Result<Self, GpuError> {
        let level = &hierarchy.levels[depth];
        let count = level.len();
        let zeros = || gpu.zeros("what the field is computed with", count);
        let sweep = |step| {
            let settings = Sweep { count: count as u32, step };
            Ok((step, gpu.uniform("the sweep's settings", settings)?))
        };
        let crosses = if depth == hierarchy.start { &hierarchy.crosses } else { &level.fixed_crosses() };
        Ok(Self {
            count,
            rows: gpu.upload("the field's equations", &level.rows)?,
            links: gpu.upload("the field's links", &level.links)?,
            pulls: gpu.upload("the field's constraints", &level.pulls)?,
            parents: gpu.upload("the field's coarser level", &level.parents)?,
            families: gpu.upload("the field's families", &level.families)?,
            members: gpu.upload("the field's families' members", &level.members)?,
            transfer: gpu
                .uniform("two levels' sizes", Transfer { fine: count as u32, coarse: level.family_count() as u32 })?,
            sweeps: STEPS.into_iter().chain([UNIT_STEP]).map(sweep).collect::<Result<_, GpuError>>()?,
            crosses: [gpu.upload("the crosses", crosses)?, zeros()?],
            correction: [zeros()?, zeros()?],
            residual: zeros()?,
            descent: (depth < hierarchy.start && hierarchy.pace.descents > 0)
                .then(|| Descent::new(gpu, count))
                .transpose()?,
        })
    }
}

/// Which of a level's two buffers hold the present values.
#[derive(Clone, Copy, Debug, Default)]
struct Place {
    crosses: usize,
    correction: usize,
}

/// A recording of the smoothing.
struct Run<'a> {
    gpu: &'a Gpu,
    kernels: &'a SmoothKernels,
    recording: Recording<'a>,
    levels: &'a [LevelBuffers],
    place: Vec<Place>,
}

impl<'a> Run<'a> {
    /// A level, and where its values are.
    fn at(&self, depth: usize) -> (&'a LevelBuffers, Place) {
        (&self.levels[depth], self.place[depth])
    }

    /// Records a kernel of `shaders/smooth.wgsl`. One without a step reads none of the settings but the count.
    fn equations(
        &mut self,
        kernel: &Kernel,
        level: &LevelBuffers,
        step: Option<f32>,
        [wanted, values, made]: [&Buffer<Complex>; 3],
    ) -> Result<(), GpuError> {
        let sweep = level.sweeps.iter().find(|sweep| Some(sweep.0) == step).unwrap_or(&level.sweeps[0]);
        let buffers: [&dyn Bindable; 7] = [&sweep.1, &level.rows, &level.links, &level.pulls, wanted, values, made];
        let bindings = self.kernels.equations.bind(self.gpu, &buffers)?;
        self.recording.dispatch(kernel, &bindings, level.count);
        Ok(())
    }

    /// Records a kernel of `shaders/transfer.wgsl` between a level and the next coarser one.
    fn transfer(
        &mut self,
        kernel: &Kernel,
        level: &LevelBuffers,
        [values, made]: [&Buffer<Complex>; 2],
        invocations: usize,
    ) -> Result<(), GpuError> {
        let buffers: [&dyn Bindable; 7] =
            [&level.transfer, &level.rows, &level.parents, &level.families, &level.members, values, made];
        let bindings = self.kernels.transfer.bind(self.gpu, &buffers)?;
        self.recording.dispatch(kernel, &bindings, invocations);
        Ok(())
    }
}

impl Steps for Run<'_> {
    type Error = GpuError;

    fn prolong(&mut self, depth: usize) -> Result<(), GpuError> {
        let ((level, place), (coarser, there)) = (self.at(depth), self.at(depth + 1));
        let buffers = [&coarser.crosses[there.crosses], &level.crosses[place.crosses]];
        self.transfer(&self.kernels.prolong, level, buffers, level.count)
    }

    fn begin(&mut self, depth: usize) -> Result<(), GpuError> {
        let (level, place) = self.at(depth);
        let crosses = &level.crosses[place.crosses];
        self.equations(&self.kernels.begin, level, None, [crosses, crosses, &level.residual])
    }

    fn first_sweep(&mut self, depth: usize, step: f32) -> Result<(), GpuError> {
        let (level, place) = self.at(depth);
        let made = &level.correction[place.correction];
        self.equations(&self.kernels.first_sweep, level, Some(step), [&level.residual, &level.residual, made])
    }

    fn sweep(&mut self, depth: usize, step: f32) -> Result<(), GpuError> {
        let (level, place) = self.at(depth);
        let [now, then] = [place.correction, 1 - place.correction].map(|i| &level.correction[i]);
        self.place[depth].correction = 1 - place.correction;
        self.equations(&self.kernels.sweep, level, Some(step), [&level.residual, now, then])
    }

    fn restrict(&mut self, depth: usize) -> Result<(), GpuError> {
        let ((level, place), (coarser, _)) = (self.at(depth), self.at(depth + 1));
        let [now, spare] = [place.correction, 1 - place.correction].map(|i| &level.correction[i]);
        self.equations(&self.kernels.leave, level, None, [&level.residual, now, spare])?;
        self.transfer(&self.kernels.gather, level, [spare, &coarser.residual], coarser.count)
    }

    fn correct(&mut self, depth: usize) -> Result<(), GpuError> {
        let ((level, place), (coarser, there)) = (self.at(depth), self.at(depth + 1));
        let buffers = [&coarser.correction[there.correction], &level.correction[place.correction]];
        self.transfer(&self.kernels.correct, level, buffers, level.count)
    }

    fn descend(&mut self, depth: usize, number: u32) -> Result<(), GpuError> {
        let (level, place) = self.at(depth);
        let Some(descent) = &level.descent else { return Ok(()) };
        let (crosses, correction) = (&level.crosses[place.crosses], &level.correction[place.correction]);
        let (gpu, conjugate) = (self.gpu, &self.kernels.conjugate);
        conjugate.turn(gpu, &mut self.recording, descent, &level.residual, correction, number)?;
        self.equations(&self.kernels.apply, level, None, [&level.residual, &descent.way, &descent.image])?;
        conjugate.advance(gpu, &mut self.recording, descent, crosses, &level.residual, number)
    }

    fn flow(&mut self, depth: usize, step: f32) -> Result<(), GpuError> {
        let (level, place) = self.at(depth);
        let [now, then] = [place.crosses, 1 - place.crosses].map(|i| &level.crosses[i]);
        self.place[depth].crosses = 1 - place.crosses;
        self.equations(&self.kernels.flow, level, Some(step), [now, now, then])
    }
}
