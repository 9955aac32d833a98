//! The singularities of a field as reports have them: those of the whole surface.

use super::Singularity;
use crate::field::{Field, SingularityLocation};
use crate::pipeline::Symmetric;
use crate::surface::Surface;
use rustc_hash::FxHashSet;

/// A singularity of the whole surface.
#[derive(Clone, Copy)]
pub(super) struct Found {
    /// In model units.
    pub at: [f64; 3],
    /// The index in quarters of a full turn.
    pub quarters: i32,
    /// Whether it is a corner of features.
    pub on_feature: bool,
    /// Whether it lies inside the surface, not on a boundary.
    pub is_inside: bool,
}

impl From<Found> for Singularity {
    fn from(found: Found) -> Self {
        Self { at: found.at, index: f64::from(found.quarters) / 4.0, on_feature: found.on_feature }
    }
}

/// The singularities of a field on a surface; where the surface is a half, those of the whole.
pub(super) fn singularities(surface: &Surface, field: &Field, symmetry: Option<&Symmetric>) -> Vec<Found> {
    let open: Vec<[u32; 2]> = (0..3 * surface.triangle_count() as u32)
        .filter(|&h| surface.twin(h).is_none())
        .map(|h| [surface.origin(h), surface.target(h)])
        .collect();
    let is_on_plane =
        |v: u32| symmetry.is_some_and(|known| known.plane.height(surface.model_point(v)).abs() <= known.tolerance());
    // The boundary of the whole surface is not on the plane.
    let own = open.into_iter().filter(|ends| !ends.iter().all(|&v| is_on_plane(v)));
    let open: FxHashSet<u32> = own.flatten().collect();
    let one = |found: &crate::field::Singularity| {
        let at = surface.frame().to_model(found.position);
        let corner = match found.location {
            SingularityLocation::Corner(v) => Some(v),
            SingularityLocation::Triangle(_) => None,
        };
        let is_open = corner.is_some_and(|v| open.contains(&v));
        let own = Found { at, quarters: found.quarters, on_feature: corner.is_some(), is_inside: !is_open };
        let Some(Symmetric { plane, .. }) = symmetry else { return vec![own] };
        if !corner.is_some_and(is_on_plane) {
            return vec![own, Found { at: plane.image(at), ..own }];
        }
        // Two sectors of 90 degrees on a boundary are regular. Twice as many sectors are four where the vertex is inside, and two
        // where the whole surface has its boundary there.
        let quarters = 2 * found.quarters - if is_open { 2 } else { 0 };
        if quarters == 0 { Vec::new() } else { vec![Found { quarters, ..own }] }
    };
    field.singularities(surface).iter().flat_map(one).collect()
}
