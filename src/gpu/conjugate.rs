//! The kernels of `shaders/conjugate.wgsl`: the scalar products and the vectors of conjugate gradients.

use super::{Access, Buffer, Gpu, GpuError, Kernel, Program, Recording, WORKGROUP};
use crate::compute::Complex;
use bytemuck::{Pod, Zeroable};

/// `Sum` in `shaders/conjugate.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Sum {
    /// The number of values, or of sums that are summed up.
    pub count: u32,
    /// Where the sums that are read begin, or the place of a ratio's numerator.
    pub numerator: u32,
    /// The place of a ratio's denominator.
    pub denominator: u32,
    /// Where sums are written to.
    pub to: u32,
}

/// The places of `r.z`, the residual times the correction, at this step and at the one before in turns.
const R_Z: [u32; 2] = [0, 1];
/// The place of `p.Ap`.
const P_AP: u32 = 2;
/// A place that stays zero, and so does a ratio to it.
const ZERO: u32 = 3;
/// The sums of blocks.
const BLOCKS: u32 = 4;

/// The kernels, compiled once per device.
#[derive(Debug)]
pub(super) struct ConjugateKernels {
    program: Program,
    multiply: Kernel,
    total: Kernel,
    direction: Kernel,
    advance: Kernel,
    retreat: Kernel,
}

/// What a level that is solved has in the device's memory.
pub(super) struct Descent {
    count: usize,
    /// The direction `p`.
    pub direction: Buffer<Complex>,
    /// `A p`.
    pub image: Buffer<Complex>,
    sums: Buffer<f32>,
    /// Bound where a kernel changes nothing.
    idle: Buffer<Complex>,
    /// The sums that end at each of the two `r.z` and at `p.Ap`, each with the number of its terms.
    products: [Vec<(usize, Buffer<Sum>)>; 3],
    /// `beta`: zero at the first step, then the ratio of each `r.z` to the other.
    betas: [Buffer<Sum>; 3],
    /// `alpha`: the ratio of each `r.z` to `p.Ap`.
    alphas: [Buffer<Sum>; 2],
}

impl Descent {
    pub fn new(gpu: &Gpu, count: usize) -> Result<Self, GpuError> {
        let sum = |sum: Sum| gpu.uniform("a sum's places", sum);
        let steps = tree(count);
        let product = |slot: u32| -> Result<Vec<(usize, Buffer<Sum>)>, GpuError> {
            let last = steps.len() - 1;
            let place = |(i, step): (usize, &Sum)| {
                Ok((step.count as usize, sum(if i == last { Sum { to: slot, ..*step } } else { *step })?))
            };
            steps.iter().enumerate().map(place).collect()
        };
        let ratio = |numerator, denominator| sum(Sum { count: count as u32, numerator, denominator, to: 0 });
        let [even, odd] = R_Z;
        let places = steps.iter().map(|step| step.to as usize + step.count.div_ceil(WORKGROUP) as usize).max();
        Ok(Self {
            count,
            direction: gpu.zeros("the direction of conjugate gradients", count)?,
            image: gpu.zeros("the direction's image", count)?,
            sums: gpu.zeros("sums over the unknowns", places.unwrap_or(0).max(BLOCKS as usize))?,
            idle: gpu.zeros("nothing", 1)?,
            products: [product(even)?, product(odd)?, product(P_AP)?],
            betas: [ratio(even, ZERO)?, ratio(odd, even)?, ratio(even, odd)?],
            alphas: [ratio(even, P_AP)?, ratio(odd, P_AP)?],
        })
    }
}

/// The steps of a sum over `count` values: blocks, then blocks of their sums, until there is one.
fn tree(count: usize) -> Vec<Sum> {
    let mut step = Sum { count: count as u32, numerator: 0, denominator: ZERO, to: BLOCKS };
    let mut steps = vec![step];
    while step.count > WORKGROUP {
        let blocks = step.count.div_ceil(WORKGROUP);
        step = Sum { count: blocks, numerator: step.to, denominator: ZERO, to: step.to + blocks };
        steps.push(step);
    }
    steps
}

impl ConjugateKernels {
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        use Access::{Read, Uniform, Write};
        let source = include_str!("../../shaders/conjugate.wgsl");
        let program = Program::new(gpu, "conjugate", source, &[Uniform, Read, Read, Write, Write])?;
        Ok(Self {
            multiply: program.kernel(gpu, "multiply")?,
            total: program.kernel(gpu, "total")?,
            direction: program.kernel(gpu, "direction")?,
            advance: program.kernel(gpu, "advance")?,
            retreat: program.kernel(gpu, "retreat")?,
            program,
        })
    }

    /// Makes the correction conjugate to the directions before: the direction of step `number`.
    pub fn update_direction(
        &self,
        gpu: &Gpu,
        recording: &mut Recording,
        descent: &Descent,
        residual: &Buffer<Complex>,
        correction: &Buffer<Complex>,
        number: u32,
    ) -> Result<(), GpuError> {
        self.product(gpu, recording, descent, [residual, correction], number as usize % 2)?;
        let beta = &descent.betas[if number == 0 { 0 } else { 2 - number as usize % 2 }];
        let bindings = self.program.bind(gpu, &[beta, correction, residual, &descent.direction, &descent.sums])?;
        recording.dispatch(&self.direction, &bindings, descent.count);
        Ok(())
    }

    /// Goes along the direction, whose image is known, to the least energy.
    pub fn advance(
        &self,
        gpu: &Gpu,
        recording: &mut Recording,
        descent: &Descent,
        values: &Buffer<Complex>,
        residual: &Buffer<Complex>,
        number: u32,
    ) -> Result<(), GpuError> {
        let (direction, image) = (&descent.direction, &descent.image);
        self.product(gpu, recording, descent, [direction, image], 2)?;
        let alpha = &descent.alphas[number as usize % 2];
        for (kernel, along, changed) in [(&self.advance, direction, values), (&self.retreat, image, residual)] {
            let bindings = self.program.bind(gpu, &[alpha, along, along, changed, &descent.sums])?;
            recording.dispatch(kernel, &bindings, descent.count);
        }
        Ok(())
    }

    fn product(
        &self,
        gpu: &Gpu,
        recording: &mut Recording,
        descent: &Descent,
        [first, second]: [&Buffer<Complex>; 2],
        slot: usize,
    ) -> Result<(), GpuError> {
        for (step, (count, sum)) in descent.products[slot].iter().enumerate() {
            let bindings = self.program.bind(gpu, &[sum, first, second, &descent.idle, &descent.sums])?;
            recording.dispatch(if step == 0 { &self.multiply } else { &self.total }, &bindings, *count);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sum_reads_what_was_written_before_it() {
        for count in [1, 256, 257, 65_536, 65_537, 20_000_000] {
            let steps = tree(count);
            assert_eq!(steps[0].count as usize, count);
            for pair in steps.windows(2) {
                assert_eq!(pair[1].numerator, pair[0].to);
                assert_eq!(pair[1].count, pair[0].count.div_ceil(WORKGROUP));
                assert!(pair[1].to >= pair[0].to + pair[1].count, "what is read is not written over");
            }
            assert!(steps.last().is_some_and(|last| last.count <= WORKGROUP));
        }
    }
}
