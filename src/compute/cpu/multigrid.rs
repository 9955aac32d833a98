//! Multigrid and conjugate gradients on the CPU.

use super::conjugate::{GRAIN, product};
use super::smooth::{applied, remainder, residual, stepped};
use super::transfer::{gathered, interpolated};
use crate::compute::{Complex, ComputeError, Level, Multigrid, normalised};
use rayon::prelude::*;

/// What is computed on one level.
#[derive(Clone, Debug, Default)]
pub(crate) struct State {
    pub values: Vec<Complex>,
    pub residual: Vec<Complex>,
    pub correction: Vec<Complex>,
    /// Where sweeps write.
    spare: Vec<Complex>,
    /// The direction `p` of conjugate gradients.
    direction: Vec<Complex>,
    /// `A p`.
    image: Vec<Complex>,
    /// `r.z`, the residual times the correction, at the last step.
    r_z: f32,
}

/// The levels and what is computed on them.
pub(crate) struct CpuMultigrid<'a> {
    pub levels: &'a [Level],
    pub states: Vec<State>,
}

impl<'a> CpuMultigrid<'a> {
    /// Level `start` has these values; the others have those of their fixed unknowns, and zero elsewhere.
    pub fn new(levels: &'a [Level], start: usize, values: &[Complex]) -> Self {
        let state = |(depth, level): (usize, &Level)| {
            let zeros = || vec![[0.0, 0.0]; level.len()];
            State {
                values: if depth == start { values.to_vec() } else { level.fixed_values() },
                residual: zeros(),
                correction: zeros(),
                spare: zeros(),
                direction: zeros(),
                image: zeros(),
                r_z: 0.0,
            }
        };
        Self { levels, states: levels.iter().enumerate().map(state).collect() }
    }

    /// This level's state, and the next coarser one's.
    fn two(&mut self, depth: usize) -> (&mut State, &mut State) {
        let (finer, coarser) = self.states.split_at_mut(depth + 1);
        (&mut finer[depth], &mut coarser[0])
    }
}

/// Sets each value.
fn each(values: &mut [Complex], value: impl Fn(usize) -> Complex + Sync) {
    change(values, |i, _| value(i));
}

/// Changes each value.
fn change(values: &mut [Complex], changed: impl Fn(usize, Complex) -> Complex + Sync) {
    let change = |(i, z): (usize, &mut Complex)| *z = changed(i, *z);
    if values.len() <= GRAIN {
        values.iter_mut().enumerate().for_each(change);
    } else {
        values.par_iter_mut().with_min_len(GRAIN).enumerate().for_each(change);
    }
}

impl Multigrid for CpuMultigrid<'_> {
    fn prolong(&mut self, depth: usize) -> Result<(), ComputeError> {
        let level = &self.levels[depth];
        let (state, coarser) = self.two(depth);
        change(&mut state.values, |i, z| {
            if level.is_fixed(i) { z } else { interpolated([0.0, 0.0], level, &coarser.values, i) }
        });
        Ok(())
    }

    fn residual(&mut self, depth: usize) -> Result<(), ComputeError> {
        let (level, state) = (&self.levels[depth], &mut self.states[depth]);
        each(&mut state.residual, |i| residual(level, &state.values, i));
        Ok(())
    }

    fn first_sweep(&mut self, depth: usize, step: f32) -> Result<(), ComputeError> {
        let (level, state) = (&self.levels[depth], &mut self.states[depth]);
        each(&mut state.correction, |i| stepped([0.0, 0.0], level, state.residual[i], i, step));
        Ok(())
    }

    fn sweep(&mut self, depth: usize, step: f32) -> Result<(), ComputeError> {
        let (level, state) = (&self.levels[depth], &mut self.states[depth]);
        let (y, r) = (&state.correction, &state.residual);
        each(&mut state.spare, |i| stepped(y[i], level, remainder(r[i], level, y, i), i, step));
        std::mem::swap(&mut state.correction, &mut state.spare);
        Ok(())
    }

    fn restrict(&mut self, depth: usize) -> Result<(), ComputeError> {
        let level = &self.levels[depth];
        let (state, coarser) = self.two(depth);
        let (y, r) = (&state.correction, &state.residual);
        each(&mut coarser.residual, |aggregate| gathered(level, aggregate, |i| remainder(r[i], level, y, i)));
        Ok(())
    }

    fn correct(&mut self, depth: usize) -> Result<(), ComputeError> {
        let level = &self.levels[depth];
        let (state, coarser) = self.two(depth);
        change(&mut state.correction, |i, y| {
            if level.is_fixed(i) { y } else { interpolated(y, level, &coarser.correction, i) }
        });
        Ok(())
    }

    fn descend(&mut self, depth: usize, number: u32) -> Result<(), ComputeError> {
        let (level, state) = (&self.levels[depth], &mut self.states[depth]);
        let r_z = product(&state.residual, &state.correction);
        let beta = if number > 0 && state.r_z > 0.0 { r_z / state.r_z } else { 0.0 };
        state.r_z = r_z;
        let y = &state.correction;
        change(&mut state.direction, |i, p| [y[i][0] + beta * p[0], y[i][1] + beta * p[1]]);
        let p = &state.direction;
        each(&mut state.image, |i| applied(level, p, i));
        let p_ap = product(p, &state.image);
        let alpha = if p_ap > 0.0 { r_z / p_ap } else { 0.0 };
        let q = &state.image;
        change(&mut state.values, |i, z| [z[0] + alpha * p[i][0], z[1] + alpha * p[i][1]]);
        change(&mut state.residual, |i, r| [r[0] - alpha * q[i][0], r[1] - alpha * q[i][1]]);
        Ok(())
    }

    fn normalised_sweep(&mut self, depth: usize, step: f32) -> Result<(), ComputeError> {
        let (level, state) = (&self.levels[depth], &mut self.states[depth]);
        let z = &state.values;
        each(&mut state.spare, |i| normalised(stepped(z[i], level, residual(level, z, i), i, step)));
        std::mem::swap(&mut state.values, &mut state.spare);
        Ok(())
    }

    fn values(&mut self, depth: usize) -> Result<Vec<Complex>, ComputeError> {
        Ok(self.states[depth].values.clone())
    }
}
