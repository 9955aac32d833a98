//! Smoothing of the field up to the finest level; the twin of `shaders/smooth.wgsl`, `transfer.wgsl` and
//! `conjugate.wgsl`.
//!
//! # Theory
//! Each level's equations are solved by conjugate gradients, from the coarser level's crosses on; what makes the residual
//! a good way to go is one V-cycle over the coarser levels (Braess 1995). Where the equations draw crosses to what they
//! were, this is a step of diffusion (Viertel and Osting 2019), elsewhere the answer of a linear problem. At last all
//! crosses are made unit numbers in a few sweeps.
//!
//! # Practice
//! Sums are written term by term, `s + a * b - c * d`: lavapipe (Mesa 22.3.6) takes `s + (a * b - c * d)` apart in just that
//! way, and would give other bits than Rust. A sum over all unknowns is a tree of blocks.
//!
//! The linear problem's energy above its least on an M6 wing of 1,000,000 triangles, in shares of what it begins with; work
//! on all levels is counted in sweeps of the finest (`energy_against_sweeps_on_a_million_triangles` prints the table):
//!
//! | sweeps | with the hierarchy | sweeps alone |
//! |---|---|---|
//! | 16 | - | 2e-1 |
//! | 32 | 1e-4 | 1.4e-1 |
//! | 64 | 1.2e-6 | 1.0e-1 |
//! | 128 | 2e-9 | 6.7e-2 |
//! | 512 | - | 3.1e-2 |
//! | 2048 | - | 1.3e-2 |
//!
//! On two cores the million triangles' field takes 1.1 s: sectors 0.15, hierarchy 0.3, this 0.6.
//!
//! Between two sides of a square guided 30 degrees apart the field is within 0.05 degrees of the harmonic one at 64 cells a
//! side, and 0.3 at 24, where the normalising sweeps show.

use super::{Complex, Hierarchy, Level};
use rayon::prelude::*;
use std::convert::Infallible;

/// Steps of the sweeps before and after a correction, in shares of a row's diagonal: Chebyshev's for eigenvalues from 0.5
/// to 2, the rough part of the spectrum.
pub const STEPS: [f32; 2] = [0.562, 1.389];
/// Pairs of sweeps in place of a correction on the coarsest level.
pub const COARSEST_PAIRS: u32 = 8;
/// Steps of conjugate gradients that a level's equations get.
pub const DESCENTS: u32 = 6;
/// Sweeps on the finest level that normalise: they round off what the lifting of short crosses left. They are a heat flow
/// of the angle, and many of them would replace the linear solution by the one whose angle is harmonic.
pub const UNIT_SWEEPS: u32 = 10;
/// The step of those.
pub const UNIT_STEP: f32 = 0.75;

/// Crosses at least this long are drawn to themselves as they are, shorter ones to this length. Halfway between two
/// constraints 30 degrees apart a linear solution is 0.5 long, and shorter only where they contradict each other more or
/// are faint.
pub const HEARD: f32 = 0.45;
/// Values shorter than this have no direction.
pub const LEAST_LENGTH: f32 = 1e-18;

/// Numbers that are added up at a time.
pub const BLOCK: usize = 256;
/// Fewer values than this are not worth another thread.
const GRAIN: usize = 2048;

/// What the smoothing is made of. A level has crosses, their residual, and a correction of them.
pub trait Steps {
    /// Why a step fails.
    type Error;

    /// The crosses become the coarser level's, read in the frames of this one; fixed ones stay.
    fn prolong(&mut self, depth: usize) -> Result<(), Self::Error>;

    /// The residual of the crosses, where anchors draw them to themselves.
    fn begin(&mut self, depth: usize) -> Result<(), Self::Error>;

    /// A first sweep for the correction, from zero.
    fn first_sweep(&mut self, depth: usize, step: f32) -> Result<(), Self::Error>;

    /// A sweep for the correction.
    fn sweep(&mut self, depth: usize, step: f32) -> Result<(), Self::Error>;

    /// The coarser level's residual becomes what the correction leaves of this one's.
    fn restrict(&mut self, depth: usize) -> Result<(), Self::Error>;

    /// The coarser level's correction is added to this one's.
    fn correct(&mut self, depth: usize) -> Result<(), Self::Error>;

    /// Goes along the correction, made conjugate to the ways before, to the least energy; descents are numbered from 0.
    fn descend(&mut self, depth: usize, number: u32) -> Result<(), Self::Error>;

    /// A sweep of the crosses themselves, normalised.
    fn flow(&mut self, depth: usize, step: f32) -> Result<(), Self::Error>;
}

/// How much is done on the way up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pace {
    /// Descents on each level.
    pub descents: u32,
    /// Sweeps that normalise on each level but the finest.
    pub flows: u32,
    /// On the finest.
    pub last_flows: u32,
}

impl Pace {
    /// The pace of the cross field, whose answer is that of a linear problem.
    pub const FIELD: Self = Self { descents: DESCENTS, flows: 0, last_flows: UNIT_SWEEPS };
}

/// Smooths the values of all levels finer than the hierarchy's start.
///
/// # Errors
/// Where a step fails.
pub fn schedule<S: Steps>(steps: &mut S, hierarchy: &Hierarchy) -> Result<(), S::Error> {
    let pace = hierarchy.pace;
    for depth in (0..hierarchy.start).rev() {
        steps.prolong(depth)?;
        if pace.descents > 0 {
            solve(steps, depth, hierarchy.levels.len(), pace.descents)?;
        }
        if depth > 0 {
            (0..pace.flows).try_for_each(|_| steps.flow(depth, UNIT_STEP))?;
        }
    }
    (0..pace.last_flows).try_for_each(|_| steps.flow(0, UNIT_STEP))
}

/// Solves a level's equations by so many descents.
pub(super) fn solve<S: Steps>(steps: &mut S, depth: usize, levels: usize, descents: u32) -> Result<(), S::Error> {
    steps.begin(depth)?;
    (0..descents).try_for_each(|number| {
        cycle(steps, depth, levels)?;
        steps.descend(depth, number)
    })
}

/// One V-cycle for the correction. Its sweeps are mirrored, so that it is a symmetric map of the residual.
fn cycle<S: Steps>(steps: &mut S, depth: usize, levels: usize) -> Result<(), S::Error> {
    let [first, second] = STEPS;
    steps.first_sweep(depth, first)?;
    steps.sweep(depth, second)?;
    if depth + 1 == levels {
        return (1..COARSEST_PAIRS).try_for_each(|_| {
            steps.sweep(depth, first)?;
            steps.sweep(depth, second)
        });
    }
    steps.restrict(depth)?;
    cycle(steps, depth + 1, levels)?;
    steps.correct(depth)?;
    steps.sweep(depth, second)?;
    steps.sweep(depth, first)
}

/// The crosses of the finest level, unit length.
pub fn smooth(hierarchy: &Hierarchy) -> Vec<Complex> {
    let mut work = Work::new(&hierarchy.levels);
    if let Some(state) = work.states.get_mut(hierarchy.start) {
        state.crosses.clone_from(&hierarchy.crosses);
    }
    // On one of rayon's threads: from outside each of the many short loops would wait for one to wake.
    rayon::scope(|_| {
        let Ok(()) = schedule(&mut work, hierarchy);
    });
    work.states.swap_remove(0).crosses
}

/// Values of one level after so many normalising sweeps.
pub(crate) fn flowed(level: &Level, values: Vec<Complex>, sweeps: u32) -> Vec<Complex> {
    let levels = std::slice::from_ref(level);
    let mut work = Work::new(levels);
    work.states[0].crosses = values;
    for _ in 0..sweeps {
        let Ok(()) = work.flow(0, UNIT_STEP);
    }
    work.states.swap_remove(0).crosses
}

/// What is computed on one level.
#[derive(Clone, Debug, Default)]
pub(super) struct State {
    pub crosses: Vec<Complex>,
    residual: Vec<Complex>,
    correction: Vec<Complex>,
    /// Where sweeps write.
    spare: Vec<Complex>,
    /// The way of the last descent.
    way: Vec<Complex>,
    /// What the equations make of the way.
    image: Vec<Complex>,
    /// Residual times correction, at the last descent.
    slope: f32,
}

/// The levels and what is computed on them.
pub(super) struct Work<'a> {
    levels: &'a [Level],
    pub states: Vec<State>,
}

impl<'a> Work<'a> {
    /// Crosses are what is fixed, and zero elsewhere.
    pub fn new(levels: &'a [Level]) -> Self {
        let state = |level: &Level| {
            let zeros = || vec![[0.0, 0.0]; level.len()];
            State {
                crosses: level.fixed_crosses(),
                residual: zeros(),
                correction: zeros(),
                spare: zeros(),
                way: zeros(),
                image: zeros(),
                slope: 0.0,
            }
        };
        Self { levels, states: levels.iter().map(state).collect() }
    }

    /// This level's state, and the coarser one's.
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

impl Steps for Work<'_> {
    type Error = Infallible;

    fn prolong(&mut self, depth: usize) -> Result<(), Infallible> {
        let level = &self.levels[depth];
        let (state, coarser) = self.two(depth);
        change(
            &mut state.crosses,
            |i, z| if level.is_fixed(i) { z } else { carried([0.0, 0.0], level, &coarser.crosses, i) },
        );
        Ok(())
    }

    fn begin(&mut self, depth: usize) -> Result<(), Infallible> {
        let (level, state) = (&self.levels[depth], &mut self.states[depth]);
        each(&mut state.residual, |i| unsettled(level, &state.crosses, i));
        Ok(())
    }

    fn first_sweep(&mut self, depth: usize, step: f32) -> Result<(), Infallible> {
        let (level, state) = (&self.levels[depth], &mut self.states[depth]);
        each(&mut state.correction, |i| stepped([0.0, 0.0], level, state.residual[i], i, step));
        Ok(())
    }

    fn sweep(&mut self, depth: usize, step: f32) -> Result<(), Infallible> {
        let (level, state) = (&self.levels[depth], &mut self.states[depth]);
        let (y, r) = (&state.correction, &state.residual);
        each(&mut state.spare, |i| stepped(y[i], level, left(r[i], level, y, i), i, step));
        std::mem::swap(&mut state.correction, &mut state.spare);
        Ok(())
    }

    fn restrict(&mut self, depth: usize) -> Result<(), Infallible> {
        let level = &self.levels[depth];
        let (state, coarser) = self.two(depth);
        let (y, r) = (&state.correction, &state.residual);
        each(&mut coarser.residual, |family| gathered(level, family, |i| left(r[i], level, y, i)));
        Ok(())
    }

    fn correct(&mut self, depth: usize) -> Result<(), Infallible> {
        let level = &self.levels[depth];
        let (state, coarser) = self.two(depth);
        change(
            &mut state.correction,
            |i, y| if level.is_fixed(i) { y } else { carried(y, level, &coarser.correction, i) },
        );
        Ok(())
    }

    fn descend(&mut self, depth: usize, number: u32) -> Result<(), Infallible> {
        let (level, state) = (&self.levels[depth], &mut self.states[depth]);
        let slope = product(&state.residual, &state.correction);
        let share = if number > 0 && state.slope > 0.0 { slope / state.slope } else { 0.0 };
        state.slope = slope;
        let y = &state.correction;
        change(&mut state.way, |i, p| [y[i][0] + share * p[0], y[i][1] + share * p[1]]);
        let p = &state.way;
        each(&mut state.image, |i| applied(level, p, i));
        let bend = product(p, &state.image);
        let length = if bend > 0.0 { slope / bend } else { 0.0 };
        let q = &state.image;
        change(&mut state.crosses, |i, z| [z[0] + length * p[i][0], z[1] + length * p[i][1]]);
        change(&mut state.residual, |i, r| [r[0] - length * q[i][0], r[1] - length * q[i][1]]);
        Ok(())
    }

    fn flow(&mut self, depth: usize, step: f32) -> Result<(), Infallible> {
        let (level, state) = (&self.levels[depth], &mut self.states[depth]);
        let z = &state.crosses;
        each(&mut state.spare, |i| normalised(stepped(z[i], level, unsettled(level, z, i), i, step)));
        std::mem::swap(&mut state.crosses, &mut state.spare);
        Ok(())
    }
}

/// What is left of `wanted` once a row has got its part; nothing on a fixed one.
fn left(wanted: Complex, level: &Level, values: &[Complex], i: usize) -> Complex {
    let diagonal = level.rows[i].diagonal;
    if diagonal == 0.0 {
        return [0.0, 0.0];
    }
    let z = values[i];
    let [mut x, mut y] = [wanted[0] - diagonal * z[0], wanted[1] - diagonal * z[1]];
    for link in level.links_of(i) {
        let (w, z) = (link.weight, values[link.index()]);
        let z = [z[0], if link.is_mirrored() { -z[1] } else { z[1] }];
        x = x + w[0] * z[0] - w[1] * z[1];
        y = y + w[0] * z[1] + w[1] * z[0];
    }
    [x, y]
}

/// What the equations make of values.
fn applied(level: &Level, values: &[Complex], i: usize) -> Complex {
    let [x, y] = left([0.0, 0.0], level, values, i);
    [-x, -y]
}

/// The residual of crosses whose anchors draw them to what they are.
fn unsettled(level: &Level, crosses: &[Complex], i: usize) -> Complex {
    let (pull, anchor) = (level.pulls[i], level.rows[i].anchor);
    let z = lifted(crosses[i]);
    left([pull[0] + anchor * z[0], pull[1] + anchor * z[1]], level, crosses, i)
}

/// A value moved by a step of its residual.
fn stepped(z: Complex, level: &Level, residual: Complex, i: usize, step: f32) -> Complex {
    let diagonal = level.rows[i].diagonal;
    if diagonal == 0.0 {
        return z;
    }
    let factor = step / diagonal;
    [z[0] + factor * residual[0], z[1] + factor * residual[1]]
}

fn length(z: Complex) -> f32 {
    (z[0] * z[0] + z[1] * z[1]).sqrt()
}

/// At least as long as what is heard.
pub(super) fn lifted(z: Complex) -> Complex {
    let length = length(z);
    if length > LEAST_LENGTH && length < HEARD { [z[0] / length * HEARD, z[1] / length * HEARD] } else { z }
}

pub(super) fn normalised(z: Complex) -> Complex {
    let length = length(z);
    if length > LEAST_LENGTH { [z[0] / length, z[1] / length] } else { z }
}

/// The sum of what a family's members have, in its frame.
fn gathered(level: &Level, family: usize, value: impl Fn(usize) -> Complex) -> Complex {
    let [mut x, mut y] = [0.0, 0.0];
    for &i in level.members_of(family) {
        let r = value(i as usize);
        // The turn reads the family's value in the member's frame; its conjugate leads back.
        let parent = level.parents[i as usize];
        let t = parent.weight;
        x = x + t[0] * r[0] + t[1] * r[1];
        let r = if parent.is_mirrored() { [-r[0], -r[1]] } else { r };
        y = y + t[0] * r[1] - t[1] * r[0];
    }
    [x, y]
}

/// A value, and what its parent's adds to it.
fn carried(z: Complex, level: &Level, coarse: &[Complex], i: usize) -> Complex {
    let parent = level.parents[i];
    let (t, c) = (parent.weight, coarse[parent.index()]);
    let c = [c[0], if parent.is_mirrored() { -c[1] } else { c[1] }];
    [z[0] + t[0] * c[0] - t[1] * c[1], z[1] + t[0] * c[1] + t[1] * c[0]]
}

/// The scalar product.
fn product(a: &[Complex], b: &[Complex]) -> f32 {
    let terms = |(a, b): (&[Complex], &[Complex])| {
        let mut terms = [0.0; BLOCK];
        for ((term, a), b) in terms.iter_mut().zip(a).zip(b) {
            *term = a[0] * b[0] + a[1] * b[1];
        }
        tree(terms)
    };
    let mut sums: Vec<f32> = if a.len() <= GRAIN {
        a.chunks(BLOCK).zip(b.chunks(BLOCK)).map(terms).collect()
    } else {
        a.par_chunks(BLOCK).zip(b.par_chunks(BLOCK)).with_min_len(GRAIN / BLOCK).map(terms).collect()
    };
    while sums.len() > 1 {
        sums = sums
            .chunks(BLOCK)
            .map(|chunk| {
                let mut terms = [0.0; BLOCK];
                terms[..chunk.len()].copy_from_slice(chunk);
                tree(terms)
            })
            .collect();
    }
    sums.first().copied().unwrap_or(0.0)
}

/// The sum of a block: the second half is added to the first, and so on.
fn tree(mut terms: [f32; BLOCK]) -> f32 {
    let mut half = BLOCK / 2;
    while half > 0 {
        let (first, second) = terms.split_at_mut(half);
        for (a, b) in first.iter_mut().zip(second) {
            *a += *b;
        }
        half /= 2;
    }
    terms[0]
}

#[cfg(test)]
mod tests;
