//! What is known of the vertices of a finished mesh: their exact points, their kinds and the direction of the cross.
//!
//! # Practice
//! The mesh is made in f32 over the bounding box. Here a vertex is put back onto the input's own coordinates: onto its vertex, its
//! feature edge or its triangle. So a corner of the input keeps its coordinates bit for bit, and vertices on a plane of the input
//! lie on it to the rounding of f64.

use super::objective::Context;
use super::surface_mesh::SurfaceMesh;
use super::vertex::{Place, Vertex};
use crate::mosaic::{FeaturePoint, Mosaic};
use crate::surface::{NONE, Projected, Surface};
use glam::DVec3;
use rayon::prelude::*;

/// A share of the way along an edge nearer to an end than this is at the end.
const AT_END: f64 = 1e-6;
/// The largest distance that a vertex is moved, in diagonals: some ten roundings of f32.
const ROUNDING: f64 = 1e-6;

/// What a vertex lies on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum VertexKind {
    /// No feature.
    #[default]
    Free = 0,
    /// A boundary of the surface.
    Boundary = 1,
    /// A feature curve inside the surface.
    Feature = 2,
    /// A corner of features or boundaries.
    Corner = 3,
}

/// What is known of a vertex of a finished mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct VertexAttributes {
    /// What it lies on.
    pub kind: VertexKind,
    /// A unit tangent direction of the cross; rough on features.
    pub direction: [f64; 3],
}

/// The points, in model units, and the attributes of the vertices of a compacted mesh.
pub(crate) fn attributes(context: &Context, mesh: &SurfaceMesh, mosaic: &Mosaic) -> Vec<([f64; 3], VertexAttributes)> {
    let vertices = mesh.vertices().par_iter().with_min_len(256);
    let mut known: Vec<_> = vertices.map(|vertex| attributes_of(context, vertex, mosaic)).collect();
    let projected = |(vertex, (_, known)): (&Vertex, &([f64; 3], VertexAttributes))| Projected {
        point: vertex.point,
        normal: vertex.normal,
        is_on_feature: matches!(known.kind, VertexKind::Boundary | VertexKind::Feature),
    };
    let places = context.surface.projected(&mesh.vertices().iter().zip(&known).map(projected).collect::<Vec<_>>());
    let is_kept = mesh.vertices().iter().map(|vertex| vertex.is_kept);
    for (((point, known), place), is_kept) in known.iter_mut().zip(places.into_iter().flatten()).zip(is_kept) {
        if let Some(place) = place.filter(|_| known.kind != VertexKind::Corner && !is_kept) {
            *point = place;
        }
    }
    known
}

fn attributes_of(context: &Context, vertex: &Vertex, mosaic: &Mosaic) -> ([f64; 3], VertexAttributes) {
    let surface = context.surface;
    let sample = mosaic.feature_samples.get(vertex.origin as usize).map(|sample| sample.point);
    let near = |triangle: u32| match triangle {
        NONE => context.orientation.triangles().nearest(vertex.point).0,
        triangle => triangle,
    };
    let triangle = near(vertex.triangles[0]);
    let (point, kind) = match (vertex.place, sample) {
        (_, Some(FeaturePoint::Vertex(v))) if vertex.is_kept => {
            let is_corner = surface.features().is_corner(v);
            (surface.model_point(v), if is_corner { VertexKind::Corner } else { VertexKind::Boundary })
        }
        (Place::OnCurve { curve, s }, _) => {
            let line = context.curve(curve);
            let s = line.wrapped(s);
            let k = line.segment(s);
            let length = line.arcs[k + 1] - line.arcs[k];
            let share = if length > 0.0 { (s - line.arcs[k]) / length } else { 0.0 };
            let h = line.half_edges[k];
            let share = if surface.origin(h) == line.vertices[k] { share } else { 1.0 - share };
            let kind = if surface.twin(h).is_none() { VertexKind::Boundary } else { VertexKind::Feature };
            (on_edge(surface, h, share), kind)
        }
        (Place::Corner, Some(FeaturePoint::Vertex(v))) => {
            let is_corner = surface.features().is_corner(v);
            (surface.model_point(v), if is_corner { VertexKind::Corner } else { VertexKind::Feature })
        }
        (Place::Corner, Some(FeaturePoint::Edge(h, share))) => (on_edge(surface, h, share), VertexKind::Feature),
        (Place::Corner, None) => (on_triangle(surface, triangle, vertex.point), VertexKind::Corner),
        (Place::Free, _) => {
            let [first, second] = vertex.triangles;
            let shared =
                (0..3).map(|k| 3 * first + k).find(|&h| surface.twin(h).is_some_and(|twin| twin / 3 == second));
            let point = match shared.filter(|_| first != second) {
                Some(h) => on_edge(surface, h, share_of(surface, h, vertex.point)),
                None => on_triangle(surface, triangle, vertex.point),
            };
            (point, VertexKind::Free)
        }
    };
    let given = surface.frame().to_model(vertex.point.into());
    let is_near = DVec3::from(given).distance(point.into()) <= ROUNDING * surface.frame().diagonal;
    let attributes = VertexAttributes { kind, direction: vertex.axis.into() };
    (if is_near { point } else { given }, attributes)
}

/// The point at a share of the way along a half-edge, in model units.
fn on_edge(surface: &Surface, half_edge: u32, share: f64) -> [f64; 3] {
    match share {
        ..AT_END => surface.model_point(surface.origin(half_edge)),
        share if share > 1.0 - AT_END => surface.model_point(surface.target(half_edge)),
        share => surface.model_point_on(half_edge, share),
    }
}

/// The share of the way along a half-edge to the nearest point of it.
fn share_of(surface: &Surface, half_edge: u32, point: DVec3) -> f64 {
    let [a, b] = [surface.origin(half_edge), surface.target(half_edge)].map(|v| DVec3::from(surface.point(v)));
    (point - a).dot(b - a) / (b - a).length_squared().max(f64::MIN_POSITIVE)
}

/// The point of a triangle with the barycentric coordinates of a unit-sized point, none of them negative, in model units.
fn on_triangle(surface: &Surface, triangle: u32, point: DVec3) -> [f64; 3] {
    let corners = surface.triangles[triangle as usize];
    let [a, b, c] = corners.map(|v| DVec3::from(surface.point(v)));
    let normal = (b - a).cross(c - a);
    let weight = |p: DVec3, q: DVec3| (q - p).cross(point - p).dot(normal).max(0.0);
    let weights = [weight(b, c), weight(c, a), weight(a, b)];
    let sum: f64 = weights.iter().sum();
    let [a, b, c] = corners.map(|v| DVec3::from(surface.model_point(v)));
    if sum > 0.0 { (a + (b - a) * (weights[1] / sum) + (c - a) * (weights[2] / sum)).into() } else { a.into() }
}
