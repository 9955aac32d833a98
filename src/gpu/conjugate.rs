//! Conjugate gradients on the device: the scalar products and the vectors of `descend` in [`crate::field::smooth`].

use super::{Access, Buffer, Gpu, GpuError, Kernel, Program, Recording, WORKGROUP};
use crate::field::Complex;
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

/// Places of sums: residual times correction, at this descent and at the one before in turns.
const SLOPES: [u32; 2] = [0, 1];
/// Way times image.
const BEND: u32 = 2;
/// Nothing: stays zero, and so does a ratio to it.
const ZERO: u32 = 3;
/// The sums of blocks.
const BLOCKS: u32 = 4;

/// The kernels, compiled once per device.
#[derive(Debug)]
pub(super) struct ConjugateKernels {
    program: Program,
    multiply: Kernel,
    total: Kernel,
    turn: Kernel,
    advance: Kernel,
    retreat: Kernel,
}

/// What a level that is solved has in the device's memory.
pub(super) struct Descent {
    count: usize,
    /// The way of the last descent.
    pub way: Buffer<Complex>,
    /// What the equations make of it.
    pub image: Buffer<Complex>,
    sums: Buffer<f32>,
    /// Bound where a kernel changes nothing.
    idle: Buffer<Complex>,
    /// The sums that end at each of the two slopes and at the bend, with what they sum up.
    products: [Vec<(usize, Buffer<Sum>)>; 3],
    /// The ratio of the first slope to nothing, and of each slope to the other.
    shares: [Buffer<Sum>; 3],
    /// The ratio of each slope to the bend.
    lengths: [Buffer<Sum>; 2],
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
        let [even, odd] = SLOPES;
        let places = steps.iter().map(|step| step.to as usize + step.count.div_ceil(WORKGROUP) as usize).max();
        Ok(Self {
            count,
            way: gpu.zeros("the field's way", count)?,
            image: gpu.zeros("the way's image", count)?,
            sums: gpu.zeros("sums over the field", places.unwrap_or(0).max(BLOCKS as usize))?,
            idle: gpu.zeros("nothing", 1)?,
            products: [product(even)?, product(odd)?, product(BEND)?],
            shares: [ratio(even, ZERO)?, ratio(odd, even)?, ratio(even, odd)?],
            lengths: [ratio(even, BEND)?, ratio(odd, BEND)?],
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
            turn: program.kernel(gpu, "turn")?,
            advance: program.kernel(gpu, "advance")?,
            retreat: program.kernel(gpu, "retreat")?,
            program,
        })
    }

    /// Makes the correction conjugate to the ways before: descent `number`'s way.
    pub fn turn(
        &self,
        gpu: &Gpu,
        recording: &mut Recording,
        descent: &Descent,
        residual: &Buffer<Complex>,
        correction: &Buffer<Complex>,
        number: u32,
    ) -> Result<(), GpuError> {
        self.product(gpu, recording, descent, [residual, correction], number as usize % 2)?;
        let share = &descent.shares[if number == 0 { 0 } else { 2 - number as usize % 2 }];
        let bindings = self.program.bind(gpu, &[share, correction, residual, &descent.way, &descent.sums])?;
        recording.dispatch(&self.turn, &bindings, descent.count);
        Ok(())
    }

    /// Goes along the way, whose image is known, to the least energy.
    pub fn advance(
        &self,
        gpu: &Gpu,
        recording: &mut Recording,
        descent: &Descent,
        crosses: &Buffer<Complex>,
        residual: &Buffer<Complex>,
        number: u32,
    ) -> Result<(), GpuError> {
        let (way, image) = (&descent.way, &descent.image);
        self.product(gpu, recording, descent, [way, image], 2)?;
        let length = &descent.lengths[number as usize % 2];
        for (kernel, along, changed) in [(&self.advance, way, crosses), (&self.retreat, image, residual)] {
            let bindings = self.program.bind(gpu, &[length, along, along, changed, &descent.sums])?;
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
