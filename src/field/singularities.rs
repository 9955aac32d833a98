//! Singularities: points around which the field turns.
//!
//! # Theory
//! Around a triangle the differences of the crosses along its edges and the excess of its scaled angles sum to a number of
//! quarter turns: the index, in quarters, of the singularity inside. Angles are scaled so that all curvature lies in triangles,
//! except at corners of features. There a vertex has a multiple of 90 degrees, and its index is the difference to 360 degrees
//! (to 180 on a boundary). By Poincaré and Hopf all indices sum to the Euler characteristic, on an open surface too, since the
//! field follows its boundary.

use super::Sectors;
use crate::compute::Complex;
use crate::surface::{Surface, next};
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};

/// Where a singularity is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SingularityLocation {
    /// In this triangle, where the field has no direction.
    Triangle(u32),
    /// At this vertex, a corner of features, where each side has a direction of its own.
    Corner(u32),
}

/// A point around which the field turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Singularity {
    /// Where it is.
    pub location: SingularityLocation,
    /// The triangle's centre, or the vertex, in unit-sized coordinates.
    pub position: [f64; 3],
    /// The turn of the field around it, in quarters of a full turn: positive where rows bend around it, as at a cube's corner.
    pub quarters: i32,
}

impl Singularity {
    /// The index: the turn of the field around it, in full turns.
    pub fn index(&self) -> f64 {
        f64::from(self.quarters) / 4.0
    }
}

/// The singularities of triangles, then those of corners, each in order.
pub(super) fn find(surface: &Surface, sectors: &Sectors, crosses: &[Complex]) -> Vec<Singularity> {
    let in_triangles = (0..surface.triangle_count() as u32)
        .into_par_iter()
        .map(|triangle| (triangle, quarters_in(surface, sectors, crosses, triangle)))
        .filter(|&(_, quarters)| quarters != 0)
        .map(|(triangle, quarters)| {
            let [a, b, c] = surface.corners(triangle as usize).map(|p| p.as_dvec3());
            Singularity {
                location: SingularityLocation::Triangle(triangle),
                position: ((a + b + c) / 3.0).into(),
                quarters,
            }
        });
    let mut all: Vec<Singularity> = in_triangles.collect();
    all.extend(at_corners(surface, sectors));
    all
}

fn quarters_in(surface: &Surface, sectors: &Sectors, crosses: &[Complex], triangle: u32) -> i32 {
    let half_edges = 3 * triangle..3 * triangle + 3;
    let scaled: f64 =
        half_edges.clone().map(|h| sectors.direction(h, sectors.corner_angle(h)) - sectors.direction(h, 0.0)).sum();
    let turned: f64 = half_edges
        .map(|h| match surface.twin(h) {
            // A difference of just an eighth of a turn must be read alike from both sides.
            Some(twin) if twin < h && !surface.features().is_feature(h) => -difference(sectors, crosses, twin),
            _ => difference(sectors, crosses, h),
        })
        .sum();
    ((turned + scaled - PI) / FRAC_PI_2).round() as i32
}

/// How far the field turns from the origin of a half-edge to its end, at most an eighth of a turn.
fn difference(sectors: &Sectors, crosses: &[Complex], half_edge: u32) -> f64 {
    let angle = |corner: u32| {
        let [x, y] = crosses[sectors.of_corner[corner as usize] as usize].map(f64::from);
        y.atan2(x) / 4.0
    };
    let turn = angle(next(half_edge)) + sectors.transport(half_edge) - angle(half_edge);
    turn - (turn / FRAC_PI_2).round() * FRAC_PI_2
}

fn at_corners(surface: &Surface, sectors: &Sectors) -> Vec<Singularity> {
    let mut on_boundary = vec![false; surface.vertex_count()];
    for h in (0..3 * surface.triangle_count() as u32).filter(|&h| surface.twin(h).is_none()) {
        on_boundary[surface.origin(h) as usize] = true;
        on_boundary[surface.target(h) as usize] = true;
    }
    let quarters = |vertex: u32| {
        let here: i32 =
            sectors.of_vertex(vertex).iter().map(|&sector| i32::from(sectors.quarters[sector as usize])).sum();
        match here {
            // A corner for the sake of another sheet's features, itself without any.
            0 => 0,
            _ if on_boundary[vertex as usize] => 2 - here,
            _ => 4 - here,
        }
    };
    let corners = surface.features().corners().chain(sectors.absorbing().iter().copied());
    let corners = corners.map(|vertex| (vertex, quarters(vertex)));
    corners
        .filter(|&(_, quarters)| quarters != 0)
        .map(|(vertex, quarters)| {
            let position = surface.points[vertex as usize].as_dvec3().into();
            Singularity { location: SingularityLocation::Corner(vertex), position, quarters }
        })
        .collect()
}
