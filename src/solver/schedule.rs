//! The order of the kernels: from the level with the initial solution to the finest.
//!
//! # Practice
//! Sums of all levels' work and figures of convergence: docs/experiments.md, solver.

use crate::compute::{ComputeError, Multigrid};

/// The damping of the sweeps before and after a correction, as shares of a row's diagonal: Chebyshev's for eigenvalues from
/// 0.5 to 2, the rough part of the spectrum.
const STEPS: [f32; 2] = [0.562, 1.389];
/// Pairs of sweeps in place of a correction on the coarsest level.
const COARSEST_PAIRS: u32 = 8;
/// Iterations of conjugate gradients on each level of the field's problem.
pub(crate) const ITERATIONS: u32 = 6;
/// Normalised sweeps on the finest level: they round off what the lengthening of short values left. They are a heat flow of
/// the angle, and many of them would replace the linear solution by the one whose angle is harmonic.
pub(crate) const NORMALISED_SWEEPS: u32 = 10;
/// The damping of normalised sweeps.
pub(crate) const SWEEP_STEP: f32 = 0.75;

/// How much is done on the way to the finest level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Schedule {
    /// Iterations of conjugate gradients on each level.
    pub iterations: u32,
    /// Normalised sweeps on each level but the finest.
    pub sweeps: u32,
    /// Normalised sweeps on the finest.
    pub last_sweeps: u32,
}

impl Schedule {
    /// Solves all levels finer than `start`, of `levels` in all.
    pub fn run(self, multigrid: &mut dyn Multigrid, start: usize, levels: usize) -> Result<(), ComputeError> {
        for depth in (0..start).rev() {
            multigrid.prolong(depth)?;
            if self.iterations > 0 {
                solve(multigrid, depth, levels, self.iterations)?;
            }
            if depth > 0 {
                (0..self.sweeps).try_for_each(|_| multigrid.normalised_sweep(depth, SWEEP_STEP))?;
            }
        }
        (0..self.last_sweeps).try_for_each(|_| multigrid.normalised_sweep(0, SWEEP_STEP))
    }
}

/// Solves a level's equations by so many iterations of conjugate gradients.
pub(crate) fn solve(
    multigrid: &mut dyn Multigrid,
    depth: usize,
    levels: usize,
    iterations: u32,
) -> Result<(), ComputeError> {
    multigrid.residual(depth)?;
    (0..iterations).try_for_each(|number| {
        cycle(multigrid, depth, levels)?;
        multigrid.descend(depth, number)
    })
}

/// One V-cycle for the correction. Its sweeps are mirrored, so that it is a symmetric map of the residual.
pub(crate) fn cycle(multigrid: &mut dyn Multigrid, depth: usize, levels: usize) -> Result<(), ComputeError> {
    let [first, second] = STEPS;
    multigrid.first_sweep(depth, first)?;
    multigrid.sweep(depth, second)?;
    if depth + 1 == levels {
        return (1..COARSEST_PAIRS).try_for_each(|_| {
            multigrid.sweep(depth, first)?;
            multigrid.sweep(depth, second)
        });
    }
    multigrid.restrict(depth)?;
    cycle(multigrid, depth + 1, levels)?;
    multigrid.correct(depth)?;
    multigrid.sweep(depth, second)?;
    multigrid.sweep(depth, first)
}
