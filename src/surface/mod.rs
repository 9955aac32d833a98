//! The input: triangles read or generated, welded, oriented, with adjacency and features.
//!
//! # Practice
//! Coordinates come in as f64, are recentred and divided by the diagonal of their bounding box, and are f32 from then
//! on; [`Frame`] puts the transform back in f64 on writing. So a surface far from the origin, or very small or large,
//! meshes as its recentred, unit-sized copy does.

mod adjacency;
pub mod examples;
mod features;
pub mod load;
mod polygon;
mod regions;
mod walk;
mod weld;

pub use features::{Curve, FeatureOptions, Features};
pub use regions::Regions;
pub(crate) use walk::{WALK_EDGES, next_corner, previous_corner, walk};
pub use weld::Repairs;

use crate::geometry::{cross, dot, unit};
use glam::{DVec3, Vec3};
use thiserror::Error;

/// No half-edge, triangle or vertex.
pub const NONE: u32 = u32::MAX;

/// Triangles as a file or a generator gives them: not welded, not oriented, in model units.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Soup {
    /// Corner positions, in model units.
    pub points: Vec<[f64; 3]>,
    /// Indices into `points`, three a triangle.
    pub triangles: Vec<[u32; 3]>,
    /// Which named part each triangle belongs to.
    pub regions: Regions,
}

/// The map between model units and the unit-sized coordinates that the mesher computes in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Centre of the model's bounding box, in model units.
    pub centre: [f64; 3],
    /// Diagonal of the model's bounding box, in model units.
    pub diagonal: f64,
}

impl Frame {
    /// From model units to unit-sized coordinates.
    pub fn to_unit(&self, point: [f64; 3]) -> [f64; 3] {
        ((DVec3::from(point) - DVec3::from(self.centre)) / self.diagonal).into()
    }

    /// From unit-sized coordinates to model units.
    pub fn to_model(&self, point: [f64; 3]) -> [f64; 3] {
        (DVec3::from(point) * self.diagonal + DVec3::from(self.centre)).into()
    }
}

/// Why a soup of triangles is no surface that can be meshed.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum SurfaceError {
    /// There is nothing to mesh.
    #[error("the surface has no triangle of non-zero area ({given} given); check that the file holds faces")]
    Empty {
        /// Triangles that were given.
        given: usize,
    },
    /// An edge has more than two triangles.
    #[error(
        "{count} edges have more than two triangles, the first between {from:?} and {to:?}; \
         remove inner walls or split the model into manifold parts"
    )]
    NonManifoldEdge {
        /// How many such edges there are.
        count: usize,
        /// One end of the first, in model units.
        from: [f64; 3],
        /// Its other end.
        to: [f64; 3],
    },
    /// The triangles of one component cannot be oriented alike.
    #[error("the surface is not orientable: a one-sided strip passes triangle {triangle} at {at:?}; cut it open there")]
    NotOrientable {
        /// A triangle, counted from 0 in the order of the file, where the two orientations meet.
        triangle: usize,
        /// Its first corner, in model units.
        at: [f64; 3],
    },
    /// An index points past the last point.
    #[error("triangle {triangle} uses point {index}, but there are only {points} points")]
    IndexOutOfRange {
        /// The triangle, counted from 0.
        triangle: usize,
        /// The index that it uses.
        index: u32,
        /// The number of points.
        points: usize,
    },
    /// A coordinate is NaN or infinite, or the extent overflows.
    #[error("point {point} has a coordinate that is not finite or too large to compute with")]
    NotFinite {
        /// The point, counted from 0.
        point: usize,
    },
}

/// A welded, consistently oriented, manifold triangle surface with adjacency and features, in unit-sized coordinates.
///
/// Half-edge `3 t + k` runs from corner `k` of triangle `t` to corner `k + 1`.
#[derive(Clone, Debug)]
pub struct Surface {
    pub(crate) points: Vec<Vec3>,
    pub(crate) triangles: Vec<[u32; 3]>,
    /// The opposite half-edge of each half-edge; [`NONE`] on the boundary.
    pub(crate) twins: Vec<u32>,
    features: Features,
    frame: Frame,
    repairs: Repairs,
}

impl Surface {
    /// Welds, cleans and orients the soup and finds its features.
    ///
    /// # Errors
    /// Where nothing is left to mesh, or where the triangles are not an orientable manifold.
    pub fn new(soup: &Soup, options: &FeatureOptions) -> Result<Self, SurfaceError> {
        let (frame, points, mut triangles, mut repairs) = weld::weld(soup)?;
        let mut positions = points;
        let twins = adjacency::orient(&mut positions, &mut triangles, &frame, &mut repairs)?;
        let mut surface = Self { points: positions, triangles, twins, features: Features::default(), frame, repairs };
        surface.features = Features::find(&surface, options);
        Ok(surface)
    }

    /// The map from model units.
    pub fn frame(&self) -> &Frame {
        &self.frame
    }

    /// What was mended on the way in.
    pub fn repairs(&self) -> &Repairs {
        &self.repairs
    }

    /// Feature edges, curves and corners.
    pub fn features(&self) -> &Features {
        &self.features
    }

    /// The number of triangles.
    pub fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// The number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.points.len()
    }

    /// The area, in unit-sized coordinates.
    pub fn area(&self) -> f64 {
        (0..self.triangles.len()).map(|t| f64::from(self.double_area(t)) / 2.0).sum()
    }

    /// The length of all open boundaries, in unit-sized coordinates.
    pub fn boundary_length(&self) -> f64 {
        (0..self.twins.len() as u32).filter(|&h| self.twins[h as usize] == NONE).map(|h| self.length(h)).sum()
    }

    pub(crate) fn double_area(&self, triangle: usize) -> f32 {
        let [a, b, c] = self.corners(triangle);
        let n = cross(b - a, c - a);
        dot(n, n).sqrt()
    }

    pub(crate) fn corners(&self, triangle: usize) -> [Vec3; 3] {
        self.triangles[triangle].map(|v| self.points[v as usize])
    }

    /// The unit normal of a triangle.
    pub(crate) fn normal(&self, triangle: usize) -> Vec3 {
        let [a, b, c] = self.corners(triangle);
        unit(cross(b - a, c - a))
    }

    pub(crate) fn origin(&self, half_edge: u32) -> u32 {
        self.triangles[half_edge as usize / 3][half_edge as usize % 3]
    }

    pub(crate) fn target(&self, half_edge: u32) -> u32 {
        self.origin(next(half_edge))
    }

    pub(crate) fn twin(&self, half_edge: u32) -> Option<u32> {
        Some(self.twins[half_edge as usize]).filter(|&twin| twin != NONE)
    }

    /// The length of a half-edge, in f64.
    pub(crate) fn length(&self, half_edge: u32) -> f64 {
        let [a, b] = [self.origin(half_edge), self.target(half_edge)].map(|v| self.points[v as usize].as_dvec3());
        a.distance(b)
    }
}

/// The half-edge after this one in its triangle.
pub(crate) fn next(half_edge: u32) -> u32 {
    if half_edge % 3 == 2 { half_edge - 2 } else { half_edge + 1 }
}

/// The half-edge before this one in its triangle.
pub(crate) fn previous(half_edge: u32) -> u32 {
    if half_edge.is_multiple_of(3) { half_edge + 2 } else { half_edge - 1 }
}
