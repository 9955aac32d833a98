//! Alignment with curvature, where neither a guide nor a feature constrains the field.
//!
//! # Theory
//! Rows along principal directions bend least out of their plane, and their quads are flat. The weight of the constraint is
//! `weight (|k1| - |k2|)^2` per area, `k1` and `k2` the principal curvatures. Where they are equal, as on a sphere, a plane and a
//! symmetric saddle, it is zero. The field's energy, the square of its gradient, has the same unit, so that `weight` has no unit
//! and does not depend on the size of the model or of its triangles. On a cylinder of radius `R` a deviation decays over the
//! length `R / sqrt(weight)`.

use super::Sectors;
use super::constraints::{DirectionConstraint, angle_along};
use crate::surface::Surface;
use crate::surface::curvature::{curvatures, radius_of_tile};
use rayon::prelude::*;

/// The width of a tile without a given side, in typical edges.
const EDGES: f64 = 5.0;

/// How the field is drawn to principal directions of curvature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Align {
    /// How strongly; 1: over lengths of the radius of curvature. 0: not.
    pub weight: f64,
    /// Side of the tiles at whose scale the surface's bending counts, in model units; `None`: five typical edges.
    pub side: Option<f64>,
}

/// The constraints of curvature on sectors that are whole and in none of the `others`.
pub(super) fn constraints(
    surface: &Surface,
    sectors: &Sectors,
    align: &Align,
    others: &[DirectionConstraint],
) -> Vec<DirectionConstraint> {
    if align.weight <= 0.0 {
        return Vec::new();
    }
    let mut constrained: Vec<bool> = sectors.quarters.iter().map(|&quarters| quarters > 0).collect();
    others.iter().for_each(|other| constrained[other.sector as usize] = true);
    // The edge of an equilateral triangle of the mean area.
    let edge = || (surface.area() / surface.triangle_count() as f64 * 4.0 / 3f64.sqrt()).sqrt();
    let side = align.side.map_or_else(|| EDGES * edge(), |side| side / surface.frame().diagonal);
    let curvatures = curvatures(surface, radius_of_tile(side));
    (0..sectors.count() as u32)
        .into_par_iter()
        .filter(|&sector| !constrained[sector as usize])
        .filter_map(|sector| {
            let curvature = &curvatures[surface.origin(sectors.first_corner[sector as usize]) as usize];
            let angle = angle_along(surface, sectors, sector, curvature.directions[0])?;
            let anisotropy = curvature.values[0].abs() - curvature.values[1].abs();
            Some(DirectionConstraint { sector, angle, density: Some(align.weight * anisotropy.powi(2)) })
        })
        .collect()
}
