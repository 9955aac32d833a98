//! Coarsening by aggregation.
//!
//! # Theory
//! Strongly linked unknowns become one, read in the frame of the first among them; links between aggregates are the sums of
//! their members' links in those frames, a Galerkin product with a unitary prolongation. So a coarse level is a problem of
//! the same kind: the same sweep works on it, and constraints live on every level.
//!
//! Values that are constant on each aggregate jump between aggregates, and their energy is too large by the aggregates'
//! width: coarse links are weakened by [`STIFFNESS`] (Braess 1995), constraints and masses are not.

use super::problem::{Gathered, Problem, Terms, gather, level};
use crate::compute::{Level, Link, add, modulus, modulus_squared, scaled};

/// No aggregate yet.
const NONE: u32 = u32::MAX;
/// Levels stop shrinking at this many unknowns.
const COARSEST: usize = 32;
/// An aggregate's members beside its first.
const MEMBERS: usize = 3;
/// The factor of coarse links. Aggregates of four are two wide, and a half would be exact for the smoothest values; but near
/// constraints it corrects too much. (docs/experiments.md, solver)
const STIFFNESS: f32 = 0.65;

/// The levels of a problem, finest first, and the guesses on the finest level of at most `most` unknowns, or on the coarsest.
pub(super) fn coarsen(problem: Problem, most: usize) -> (Vec<Level>, usize, Vec<[f32; 2]>) {
    let Problem { level: mut current, mut terms } = problem;
    let mut levels = Vec::new();
    let mut start = None;
    loop {
        let is_coarsest = current.len() <= COARSEST || !aggregate(&mut current);
        if start.is_none() && (is_coarsest || current.len() <= most) {
            start = Some((levels.len(), terms.iter().map(|terms| terms.guess).collect()));
        }
        if is_coarsest {
            levels.push(current);
            break;
        }
        let coarser;
        (coarser, terms) = coarsened(&current, &terms);
        levels.push(std::mem::replace(&mut current, coarser));
    }
    let (start, guesses) = start.unwrap_or_default();
    (levels, start, guesses)
}

/// Groups each unknown with its strongest free neighbours of the same kind; `false`: that hardly makes them fewer.
fn aggregate(level: &mut Level) -> bool {
    let count = level.len();
    level.parents = vec![Link { neighbour: NONE, weight: [1.0, 0.0] }; count];
    level.aggregate_starts = Vec::with_capacity(count / 2);
    level.members = Vec::with_capacity(count);
    for i in 0..count {
        if level.parents[i].neighbour != NONE {
            continue;
        }
        let aggregate = level.aggregate_starts.len() as u32;
        level.aggregate_starts.push(level.members.len() as u32);
        level.parents[i].neighbour = aggregate;
        level.members.push(i as u32);
        // The strongest first, of equals the first; ids as modulus squared and the place in the row.
        let mut strongest = [(0.0, usize::MAX); MEMBERS];
        let own = level.rows[i].start as usize..level.rows[i + 1].start as usize;
        for e in own {
            let link = level.links[e];
            let j = link.index();
            if level.parents[j].neighbour == NONE && level.is_fixed(j) == level.is_fixed(i) {
                let mut here = (modulus_squared(link.weight), e);
                for place in &mut strongest {
                    if here.0 > place.0 {
                        std::mem::swap(&mut here, place);
                    }
                }
            }
        }
        for (squared, e) in strongest.into_iter().filter(|strong| strong.1 != usize::MAX) {
            let link = level.links[e];
            let parent = &mut level.parents[link.index()];
            if parent.neighbour == NONE {
                let modulus = squared.sqrt();
                // The link reads j in i's frame; its adjoint reads i's value in j's.
                let back = link.back(aggregate);
                *parent = Link { weight: back.weight.map(|x| x / modulus), ..back };
                level.members.push(link.index() as u32);
            }
        }
    }
    let shrinks = level.aggregate_starts.len() * 10 < count * 9;
    if shrinks {
        level.aggregate_starts.push(count as u32);
    } else {
        (level.parents, level.aggregate_starts, level.members) = Default::default();
    }
    shrinks
}

/// The level whose unknowns are the aggregates.
fn coarsened(fine: &Level, terms: &[Terms]) -> (Level, Vec<Terms>) {
    let Gathered { rows, starts, links } = gather(fine.aggregate_count(), |a, links| {
        let own = links.len();
        let mut total = Terms { fixed: true, ..Terms::default() };
        let mut right_hand_side = [0.0, 0.0];
        let mut moduli = 0.0;
        for &i in fine.members_of(a) {
            let i = i as usize;
            let back = fine.parents[i].back(0);
            for link in fine.links_of(i) {
                let parent = back.after(link).after(&fine.parents[link.index()]);
                let weight = scaled(parent.weight, STIFFNESS);
                if parent.index() == a {
                    // A mirrored value is as often against itself as with it.
                    let along = if parent.is_mirrored() { 0.0 } else { weight[0] };
                    total.curvature += (modulus(weight) - along).max(0.0);
                } else {
                    moduli += modulus(weight);
                    match links[own..].iter_mut().find(|link| link.neighbour == parent.neighbour) {
                        Some(link) => link.weight = add(link.weight, weight),
                        None => links.push(Link { neighbour: parent.neighbour, weight }),
                    }
                }
            }
            right_hand_side = add(right_hand_side, back.of(fine.right_hand_side[i]));
            total.curvature += terms[i].curvature * STIFFNESS;
            total.constraint += terms[i].constraint;
            total.mass += terms[i].mass;
            total.fixed &= terms[i].fixed;
            total.guess = add(total.guess, back.of(terms[i].guess));
        }
        total.curvature += (moduli - links[own..].iter().map(|link| modulus(link.weight)).sum::<f32>()).max(0.0);
        if total.fixed {
            let length = modulus(right_hand_side);
            right_hand_side = if length > 1e-6 {
                right_hand_side.map(|x| x / length)
            } else {
                fine.right_hand_side[fine.members_of(a)[0] as usize]
            };
        }
        (total, right_hand_side)
    });
    let (terms, right_hand_side): (Vec<_>, Vec<_>) = rows.into_iter().unzip();
    (level(&terms, &starts, links, right_hand_side), terms)
}
