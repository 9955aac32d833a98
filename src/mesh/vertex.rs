//! Vertices on the surface: where they are, and where a walk over it leads.

use crate::surface::{Surface, WALK_EDGES, walk};
use glam::DVec3;

/// The number of faces at a regular vertex.
pub(crate) const REGULAR: u8 = 4;

/// The place of a vertex on the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// Off all features: it may move over the surface.
    Free,
    /// On a feature curve: it may move along the curve.
    OnCurve {
        /// The curve, by its index in [`Features::curves`](crate::surface::Features::curves).
        curve: u32,
        /// The arc length from the curve's first vertex, unit-sized.
        s: f64,
    },
    /// Fixed: a corner of features, a point that several sheets share, or a vertex that the topology needs.
    Corner,
}

/// A vertex of a [`SurfaceMesh`](super::SurfaceMesh).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertex {
    /// Unit-sized coordinates.
    pub(crate) point: DVec3,
    /// Its place on the surface.
    pub place: Place,
    /// The triangles of the surface on the two sides of its curve; twice the same where it is free or on a boundary, and
    /// `u32::MAX` where more than two sides meet.
    pub triangles: [u32; 2],
    /// Unit normal of the surface; rough on features.
    pub(crate) normal: DVec3,
    /// A unit tangent direction of the cross; rough on features.
    pub(crate) axis: DVec3,
    /// Its wanted valence, in faces: 4, and on features one for each right angle.
    pub valence: u8,
    /// Whether it is a vertex of a boundary that the mesh keeps: it stays, and so do the boundary edges between two such vertices.
    pub is_kept: bool,
    /// Its vertex in the triangulation; `u32::MAX` for a vertex that an edit has added.
    pub origin: u32,
}

impl Vertex {
    /// Its unit-sized coordinates.
    pub fn coordinates(&self) -> [f64; 3] {
        self.point.into()
    }

    /// Whether it lies off all features.
    pub fn is_free(&self) -> bool {
        self.place == Place::Free
    }
}

/// A position on the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Position {
    pub point: DVec3,
    pub place: Place,
    /// See [`Vertex::triangles`].
    pub triangles: [u32; 2],
}

impl From<&Vertex> for Position {
    fn from(vertex: &Vertex) -> Self {
        Self { point: vertex.point, place: vertex.place, triangles: vertex.triangles }
    }
}

/// The end of the straight walk over the surface from a point of a triangle towards another point. It does not cross features.
pub(crate) fn walked(surface: &Surface, triangle: u32, from: DVec3, to: DVec3) -> Position {
    let barrier = |h| surface.features().is_feature(h);
    let normal = surface.normal(triangle as usize).as_dvec3();
    let way = to - from;
    let way = way - normal * normal.dot(way);
    let foot = walk(surface, barrier, triangle, from.as_vec3(), way.as_vec3(), WALK_EDGES);
    Position { point: foot.position.as_dvec3(), place: Place::Free, triangles: [foot.triangle; 2] }
}
