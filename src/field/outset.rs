//! Where the smoothing sets out from: the crosses of a coarse level, and which of them constraints decide.
//!
//! # Theory
//! Where constraints are near, the field is the answer of the linear problem: harmonic interpolation. Far from them, or
//! where they contradict each other, that answer fades: it is short, its direction says little, and its angle turns
//! fastest there. So where it is shorter than [`HEARD`] the crosses are found by diffusion that restores their length
//! (Viertel and Osting 2019): they are anchored to themselves, and solved for again and again. Where no constraint is
//! heard at all, the surface's own bending is what they begin with: on a torus that is a field without singularities,
//! which no diffusion finds from elsewhere, for curvature holds pairs of singularities on its outer and its inner side
//! apart; on fish_blub, spot and anchor without features it led to less energy too. A sphere bends alike everywhere, and its
//! field begins with the noise of its triangles.
//!
//! # Practice
//! All this is done on the finest level of at most [`OUTSET`] unknowns, where it costs little; what is tangled there stays
//! so on all finer ones. It is done on the CPU whatever the backend.

use super::Complex;
use super::hierarchy::{Level, modulus};
use super::smooth::{DESCENTS, HEARD, Steps, UNIT_STEP, Work, lifted, normalised, solve};

/// Unknowns of the level that the smoothing sets out from.
pub(super) const OUTSET: usize = 8_000;
/// Shorter answers of the linear problem are none: the roundings of a level's sums.
const SILENT: f32 = 1e-4;
/// Normalising sweeps on each level.
const FLOWS: u32 = 10;
/// How often they are repeated on the coarsest.
const COARSEST_ROUNDS: u32 = 20;
/// Steps of diffusion.
const DIFFUSIONS: u32 = 6;
/// The descents of each; anchors make its equations easy.
const DIFFUSION_DESCENTS: u32 = 4;
/// How much faster crosses that are not heard are drawn to themselves than the others.
const HOLD: f32 = 2000.0;

/// The crosses of level `start`; anchors are set on all levels. `bends` is the cross along the surface's bending, or zero.
pub(super) fn outset(levels: &mut [Level], start: usize, bends: &[Complex]) -> Vec<Complex> {
    let linear = ascended(levels, start, |work, depth| {
        let Ok(()) = solve(work, depth, levels.len(), DESCENTS);
    });
    let flowing = ascended(levels, start, |work, depth| {
        let coarsest = depth + 1 == levels.len();
        if coarsest {
            let Ok(()) = solve(work, depth, levels.len(), DESCENTS);
        }
        for _ in 0..if coarsest { FLOWS * COARSEST_ROUNDS } else { FLOWS } {
            let Ok(()) = work.flow(depth, UNIT_STEP);
        }
    });
    let crosses = linear.iter().zip(flowing).zip(bends).map(|((&linear, flowing), &bend)| match modulus(linear) {
        heard if heard >= HEARD => linear,
        faint if faint > SILENT => lifted(flowing),
        _ => normalised(bend),
    });
    let crosses: Vec<Complex> = crosses.collect();
    hold(levels, start, linear.iter().map(|&z| modulus(z) < HEARD).collect());

    let mut work = Work::new(levels);
    work.states[start].crosses = crosses;
    for _ in 0..DIFFUSIONS {
        let Ok(()) = solve(&mut work, start, levels.len(), DIFFUSION_DESCENTS);
    }
    work.states.swap_remove(start).crosses
}

/// The crosses of level `start`, from the coarsest on, once `settle` has worked on each level.
fn ascended(levels: &[Level], start: usize, settle: impl Fn(&mut Work, usize)) -> Vec<Complex> {
    let mut work = Work::new(levels);
    for depth in (start..levels.len()).rev() {
        if depth + 1 < levels.len() {
            let Ok(()) = work.prolong(depth);
        }
        settle(&mut work, depth);
    }
    work.states.swap_remove(start).crosses
}

/// Strengthens the anchors of the unknowns of level `start` that are `free`, and of their like on all levels.
fn hold(levels: &mut [Level], start: usize, free: Vec<bool>) {
    let mut shares: Vec<f32> = free.iter().map(|&free| f32::from(free)).collect();
    let at_start = shares.clone();
    for level in &mut levels[start..] {
        level.hold(HOLD, &shares);
        let mean = |members: &[u32]| members.iter().map(|&i| shares[i as usize]).sum::<f32>() / members.len() as f32;
        shares = (0..level.family_count()).map(|family| mean(level.members_of(family))).collect();
    }
    shares = at_start;
    for level in levels[..start].iter_mut().rev() {
        shares = level.parents.iter().map(|parent| shares[parent.neighbour as usize]).collect();
        level.hold(HOLD, &shares);
    }
}
