//! Smoothing of the field, from the coarsest level to the finest; the twin of `shaders/smooth.wgsl`.
//!
//! # Practice
//! Sums are written term by term, `s + a * b - c * d`: lavapipe (Mesa 22.3.6) takes `s + (a * b - c * d)` apart in just that
//! way, and would give other bits than Rust.

use super::{Complex, Hierarchy, Level};
use rayon::prelude::*;

/// Sweeps on each level before the values are normalised in every sweep: they solve a linear problem.
pub const LINEAR_SWEEPS: u32 = 20;
/// Sweeps on each level that normalise: they place the singularities.
pub const UNIT_SWEEPS: u32 = 10;
/// The sweeps of both kinds are repeated this often on the coarsest level, where they cost nothing: what is tangled there
/// stays so on all others.
pub const COARSEST_ROUNDS: u32 = 10;

/// Values shorter than this are left as they are by a normalising sweep.
pub const LEAST_LENGTH: f32 = 1e-12;

/// The crosses of the finest level, unit length.
pub fn smooth(hierarchy: &Hierarchy) -> Vec<Complex> {
    let mut values: Vec<Complex> = Vec::new();
    for (depth, level) in hierarchy.levels.iter().enumerate().rev() {
        let coarsest = depth + 1 == hierarchy.levels.len();
        values = if coarsest { seed(level) } else { prolong(level, &values) };
        let [linear, unit] = sweeps(hierarchy.constrained, coarsest);
        for number in 0..linear + unit {
            values = sweep(level, &values, number >= linear);
        }
    }
    values
}

/// How many sweeps a level gets that solve a linear problem, and then how many that normalise.
pub fn sweeps(constrained: bool, coarsest: bool) -> [u32; 2] {
    let rounds = if coarsest { COARSEST_ROUNDS } else { 1 };
    [if constrained { LINEAR_SWEEPS * rounds } else { 0 }, UNIT_SWEEPS * rounds]
}

/// First values on the coarsest level: the pulls, and where there are none the frames' own axes.
pub fn seed(level: &Level) -> Vec<Complex> {
    level.pulls.iter().map(|&p| if p == [0.0, 0.0] { [1.0, 0.0] } else { p }).collect()
}

/// A coarser level's values, read in the frames of this one.
pub fn prolong(level: &Level, coarse: &[Complex]) -> Vec<Complex> {
    (0..level.len())
        .into_par_iter()
        .map(|i| {
            let (t, z) = (level.turns[i], coarse[level.parents[i] as usize]);
            [t[0] * z[0] - t[1] * z[1], t[0] * z[1] + t[1] * z[0]]
        })
        .collect()
}

/// One Jacobi sweep; `unit`: each value is normalised.
pub fn sweep(level: &Level, values: &[Complex], unit: bool) -> Vec<Complex> {
    (0..level.len())
        .into_par_iter()
        .map(|i| {
            let [mut x, mut y] = level.pulls[i];
            for e in level.starts[i] as usize..level.starts[i + 1] as usize {
                let (w, z) = (level.weights[e], values[level.neighbours[e] as usize]);
                x = x + w[0] * z[0] - w[1] * z[1];
                y = y + w[0] * z[1] + w[1] * z[0];
            }
            if unit {
                let length = (x * x + y * y).sqrt();
                if length > LEAST_LENGTH {
                    return [x / length, y / length];
                }
            }
            [x, y]
        })
        .collect()
}
