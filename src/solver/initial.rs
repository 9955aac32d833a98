//! Initial solutions on a coarse level, computed on the CPU.

use super::schedule::{ITERATIONS, SWEEP_STEP, solve};
use crate::compute::cpu::CpuMultigrid;
use crate::compute::{Complex, ComputeError, Level, Multigrid, TARGET_LENGTH, modulus, normalised, target};

/// Shorter solutions of the linear problem are none: the roundings of a level's sums.
const NEGLIGIBLE_SOLUTION: f32 = 1e-4;
/// Normalised sweeps on each level.
const SWEEPS: u32 = 10;
/// How often they are repeated on the coarsest.
const COARSEST_ROUNDS: u32 = 20;
/// Steps of diffusion.
const DIFFUSIONS: u32 = 6;
/// The iterations of each; mass terms make its equations easy.
const DIFFUSION_ITERATIONS: u32 = 4;
/// The factor of the mass terms of values that constraints do not decide.
const MASS_FACTOR: f32 = 2000.0;

/// Where constraints are near, the linear problem's solution on level `start`; elsewhere values by diffusion.
///
/// # Theory
/// Where constraints are far away or contradict each other the linear solution is short: its direction is uncertain, and its
/// angle turns fastest there. Where it is shorter than [`TARGET_LENGTH`], the values come from diffusion that restores
/// their length (Viertel and Osting 2019): mass terms draw them to themselves, and they are solved for again and again. Where
/// the linear solution is zero, diffusion begins with the `guesses`.
///
/// Mass terms are set on all levels.
pub(super) fn diffused(levels: &mut [Level], start: usize, guesses: &[Complex]) -> Result<Vec<Complex>, ComputeError> {
    let linear = ascended(levels, start, |multigrid, depth| solve(multigrid, depth, levels.len(), ITERATIONS))?;
    let swept = ascended(levels, start, |multigrid, depth| {
        let is_coarsest = depth + 1 == levels.len();
        if is_coarsest {
            solve(multigrid, depth, levels.len(), ITERATIONS)?;
        }
        let sweeps = if is_coarsest { SWEEPS * COARSEST_ROUNDS } else { SWEEPS };
        (0..sweeps).try_for_each(|_| multigrid.normalised_sweep(depth, SWEEP_STEP))
    })?;
    let values = linear.iter().zip(swept).zip(guesses).map(|((&linear, swept), &guess)| match modulus(linear) {
        length if length >= TARGET_LENGTH => linear,
        length if length > NEGLIGIBLE_SOLUTION => target(swept),
        _ => normalised(guess),
    });
    let values: Vec<Complex> = values.collect();
    strengthen_masses(levels, start, linear.iter().map(|&z| modulus(z) < TARGET_LENGTH).collect());

    let mut multigrid = CpuMultigrid::new(levels, start, &values);
    (0..DIFFUSIONS).try_for_each(|_| solve(&mut multigrid, start, levels.len(), DIFFUSION_ITERATIONS))?;
    multigrid.values(start)
}

/// Unit values of one level that spread from fixed ones, and where nothing is fixed, from the first unknown; then so many
/// normalised sweeps.
pub(super) fn spread(level: &Level, sweeps: u32) -> Result<Vec<Complex>, ComputeError> {
    let mut values = level.fixed_values();
    let is_open = |value: &Complex| *value == [0.0, 0.0];
    let mut left = level.len();
    loop {
        let open = values.iter().filter(|value| is_open(value)).count();
        if open == 0 {
            return swept(level, &values, sweeps);
        }
        if open == left
            && let Some(value) = values.iter_mut().find(|value| is_open(value))
        {
            *value = [1.0, 0.0];
        }
        left = open;
        values = swept(level, &values, 1)?;
    }
}

/// Values of one level after so many normalised sweeps.
fn swept(level: &Level, values: &[Complex], sweeps: u32) -> Result<Vec<Complex>, ComputeError> {
    let mut multigrid = CpuMultigrid::new(std::slice::from_ref(level), 0, values);
    (0..sweeps).try_for_each(|_| multigrid.normalised_sweep(0, SWEEP_STEP))?;
    multigrid.values(0)
}

/// The values of level `start`, after `work` on each level from the coarsest on.
fn ascended(
    levels: &[Level],
    start: usize,
    work: impl Fn(&mut CpuMultigrid, usize) -> Result<(), ComputeError>,
) -> Result<Vec<Complex>, ComputeError> {
    let coarsest = levels.len() - 1;
    let mut multigrid = CpuMultigrid::new(levels, coarsest, &levels[coarsest].fixed_values());
    for depth in (start..levels.len()).rev() {
        if depth < coarsest {
            multigrid.prolong(depth)?;
        }
        work(&mut multigrid, depth)?;
    }
    multigrid.values(start)
}

/// Strengthens the mass terms of the `free` unknowns of level `start`, and of those that they stand for on all levels.
fn strengthen_masses(levels: &mut [Level], start: usize, free: Vec<bool>) {
    let mut shares: Vec<f32> = free.iter().map(|&free| f32::from(free)).collect();
    let at_start = shares.clone();
    for level in &mut levels[start..] {
        strengthen(level, &shares);
        let mean = |members: &[u32]| members.iter().map(|&i| shares[i as usize]).sum::<f32>() / members.len() as f32;
        shares = (0..level.aggregate_count()).map(|aggregate| mean(level.members_of(aggregate))).collect();
    }
    shares = at_start;
    for level in levels[..start].iter_mut().rev() {
        shares = level.parents.iter().map(|parent| shares[parent.neighbour as usize]).collect();
        strengthen(level, &shares);
    }
}

/// Multiplies mass terms, by [`MASS_FACTOR`] where the share is 1.
fn strengthen(level: &mut Level, shares: &[f32]) {
    for (row, share) in level.rows.iter_mut().zip(shares) {
        if row.diagonal > 0.0 {
            let more = row.mass * (MASS_FACTOR - 1.0) * share;
            row.mass += more;
            row.diagonal += more;
        }
    }
}
