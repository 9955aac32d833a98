//! From one vertex of the surface to the next, in tile sides along the cross.

use crate::field::{Field, Sectors};
use crate::surface::{Surface, next};
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};

/// The way along a half-edge.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Way {
    /// In tile sides, along the axis of the sector that it leaves and across it.
    pub by: [f64; 2],
    /// Quarter turns, counter-clockwise, that the axis there is turned by when it is read in the frame of the sector that
    /// the half-edge leads to.
    pub quarters: u32,
}

impl Way {
    /// A vector in the frame where the way begins, read in that where it ends.
    pub fn forth(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        [[u, v], [-v, u], [-u, -v], [v, -u]][self.quarters as usize % 4]
    }

    /// A vector in the frame where the way ends, read in that where it begins.
    pub fn back(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        [[u, v], [v, -u], [-u, -v], [-v, u]][self.quarters as usize % 4]
    }
}

/// One direction of each sector's cross, in radians from its direction zero; on a feature that is direction zero itself.
pub fn axes(field: &Field) -> Vec<f64> {
    let on_feature = |sector: usize| field.sectors().quarters[sector] > 0;
    let axis = |z: &[f32; 2]| f64::from(z[1]).atan2(f64::from(z[0])) / 4.0;
    field.crosses().iter().enumerate().map(|(s, z)| if on_feature(s) { 0.0 } else { axis(z) }).collect()
}

/// By how much the cross turns along a half-edge, in radians, counter-clockwise, and how many quarters its axis is turned
/// by when it is read in the frame of the sector at the end; with the half-edge's angle from the axis where it begins.
fn turn_along(sectors: &Sectors, axes: &[f64], h: u32) -> [f64; 3] {
    let [from, to] = [h, next(h)].map(|corner| sectors.of_corner[corner as usize] as usize);
    let leaving = sectors.direction(h, 0.0) - axes[from];
    let arriving = sectors.direction(next(h), sectors.corner_angle(next(h))) + PI - axes[to];
    let quarters = ((arriving - leaving) / FRAC_PI_2).round();
    [leaving - arriving + quarters * FRAC_PI_2, quarters, leaving]
}

/// By how much the cross turns along each half-edge, in radians.
pub fn turning(field: &Field) -> Vec<f64> {
    let (sectors, axes) = (field.sectors(), axes(field));
    (0..sectors.of_corner.len() as u32).into_par_iter().map(|h| turn_along(sectors, &axes, h)[0]).collect()
}

/// The ways along all half-edges, for tiles whose side at each vertex is `side`.
pub fn ways(surface: &Surface, sectors: &Sectors, axes: &[f64], side: impl Fn(u32) -> f64 + Sync) -> Vec<Way> {
    let way = |h: u32| {
        let [turn, quarters, leaving] = turn_along(sectors, axes, h);
        let (s, c) = (leaving - turn / 2.0).sin_cos();
        let per_unit = (1.0 / side(surface.origin(h)) + 1.0 / side(surface.target(h))) / 2.0;
        let sides = surface.length(h) * per_unit;
        Way { by: [sides * c, sides * s], quarters: quarters.rem_euclid(4.0) as u32 }
    };
    (0..3 * surface.triangle_count() as u32).into_par_iter().map(way).collect()
}
