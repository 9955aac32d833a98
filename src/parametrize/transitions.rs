//! Transitions: how the coordinates pass along a half-edge.

use crate::field::Field;
use crate::field::matching::{Matching, axes};
use crate::surface::{Surface, next};
use rayon::prelude::*;

/// The transition along a half-edge.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Transition {
    /// The wanted difference of the coordinates, in tile sides, along the axis of the sector where the half-edge begins and
    /// across it.
    pub wanted: [f64; 2],
    /// The matching: quarter turns, counter-clockwise, that this axis is turned by in the frame of the sector where the
    /// half-edge ends.
    pub quarters: u32,
}

impl Transition {
    /// A vector of the frame where the half-edge begins, in the frame where it ends.
    pub fn forward(&self, vector: [f64; 2]) -> [f64; 2] {
        turned(vector, self.quarters)
    }

    /// A vector of the frame where the half-edge ends, in the frame where it begins.
    pub fn back(&self, vector: [f64; 2]) -> [f64; 2] {
        turned(vector, 4 - self.quarters % 4)
    }
}

/// A vector turned by quarters, counter-clockwise.
pub(super) fn turned([u, v]: [f64; 2], quarters: u32) -> [f64; 2] {
    [[u, v], [-v, u], [-u, -v], [v, -u]][quarters as usize % 4]
}

/// By how much the cross turns along each half-edge, in radians.
pub fn turning(field: &Field) -> Vec<f64> {
    let (sectors, axes) = (field.sectors(), axes(field.sectors(), field.crosses()));
    (0..sectors.of_corner.len() as u32).into_par_iter().map(|h| Matching::along(sectors, &axes, h).turn).collect()
}

/// The transitions along all half-edges, for tiles whose mean side at each vertex is `side`, stretched as the field says.
pub fn transitions(surface: &Surface, field: &Field, side: impl Fn(u32) -> f64 + Sync) -> Vec<Transition> {
    let (sectors, axes) = (field.sectors(), axes(field.sectors(), field.crosses()));
    let stretch = field.stretch().map(|stretch| stretch.along_axes(&axes));
    // The logarithm of a tile's side along the axis over the mean side; across the axis it has the other sign.
    let log = |corner: u32| stretch.as_ref().map_or(0.0, |logs| logs[sectors.of_corner[corner as usize] as usize]);
    let transition = |h: u32| {
        let matching = Matching::along(sectors, &axes, h);
        let (s, c) = (matching.leaving - matching.turn / 2.0).sin_cos();
        let here = log(h);
        let there = if matching.swaps() { -log(next(h)) } else { log(next(h)) };
        let sides = |sign: f64| {
            let [here, there] = [sign * here, sign * there].map(|log| (-log).exp());
            let per_unit = (here / side(surface.origin(h)) + there / side(surface.target(h))) / 2.0;
            surface.length(h) * per_unit
        };
        Transition { wanted: [sides(1.0) * c, sides(-1.0) * s], quarters: matching.quarters.rem_euclid(4.0) as u32 }
    };
    (0..3 * surface.triangle_count() as u32).into_par_iter().map(transition).collect()
}
