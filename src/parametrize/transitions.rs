//! From one vertex of the surface to the next, in tile sides along the cross.

use crate::field::Field;
use crate::field::matching::{Passage, axes};
use crate::surface::{Surface, next};
use rayon::prelude::*;

/// The way along a half-edge.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Transition {
    /// In tile sides, along the axis of the sector that it leaves and across it.
    pub by: [f64; 2],
    /// Quarter turns, counter-clockwise, that the axis there is turned by when it is read in the frame of the sector that
    /// the half-edge leads to.
    pub quarters: u32,
}

impl Transition {
    /// A vector in the frame where the way begins, read in that where it ends.
    pub fn forth(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        [[u, v], [-v, u], [-u, -v], [v, -u]][self.quarters as usize % 4]
    }

    /// A vector in the frame where the way ends, read in that where it begins.
    pub fn back(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        [[u, v], [v, -u], [-u, -v], [-v, u]][self.quarters as usize % 4]
    }
}

/// By how much the cross turns along each half-edge, in radians.
pub fn turning(field: &Field) -> Vec<f64> {
    let (sectors, axes) = (field.sectors(), axes(field.sectors(), field.crosses()));
    (0..sectors.of_corner.len() as u32).into_par_iter().map(|h| Passage::along(sectors, &axes, h).turn).collect()
}

/// The ways along all half-edges, for tiles whose mean side at each vertex is `side`, stretched as the field says.
pub fn transitions(surface: &Surface, field: &Field, side: impl Fn(u32) -> f64 + Sync) -> Vec<Transition> {
    let (sectors, axes) = (field.sectors(), axes(field.sectors(), field.crosses()));
    let stretch = field.stretch().map(|stretch| stretch.along_axes(&axes));
    // By what tile sides are longer along the axis of a corner's sector; across it they are as much shorter.
    let log = |corner: u32| stretch.as_ref().map_or(0.0, |logs| logs[sectors.of_corner[corner as usize] as usize]);
    let way = |h: u32| {
        let passage = Passage::along(sectors, &axes, h);
        let (s, c) = (passage.leaving - passage.turn / 2.0).sin_cos();
        let here = log(h);
        let there = if passage.swaps() { -log(next(h)) } else { log(next(h)) };
        let sides = |sign: f64| {
            let [here, there] = [sign * here, sign * there].map(|log| (-log).exp());
            let per_unit = (here / side(surface.origin(h)) + there / side(surface.target(h))) / 2.0;
            surface.length(h) * per_unit
        };
        Transition { by: [sides(1.0) * c, sides(-1.0) * s], quarters: passage.quarters.rem_euclid(4.0) as u32 }
    };
    (0..3 * surface.triangle_count() as u32).into_par_iter().map(way).collect()
}
