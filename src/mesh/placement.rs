//! The placement of a given mesh on a surface.
//!
//! # Practice
//! Use this for meshes from files. A mesh of this program knows its places.

use super::incidence::{sides, undirected};
use super::objective::Context;
use super::surface_mesh::SurfaceMesh;
use super::vertex::{Place, Vertex};
use super::{Mesh, Metric};
use crate::surface::NONE;
use crate::surface::nearest::{Simplices, nearest_on_segment};
use glam::DVec3;
use rustc_hash::{FxHashMap, FxHashSet};

/// A vertex nearer to a feature curve or a corner lies on it, unit-sized: some hundred roundings of f32.
const ON_FEATURE: f64 = 1e-5;
/// The number of faces at a regular vertex.
const REGULAR: u8 = 4;

impl SurfaceMesh {
    /// A mesh, in model units, on the surface of a context. Vertices on feature curves and corners are found; the others lie
    /// where the nearest triangle is. Edges between neighbours on a curve are feature edges. Tiles count as squares.
    ///
    /// Faces of fewer than three sides, and those that name a vertex twice or one that is missing, are left out. A vertex
    /// that is not finite stays where it is.
    pub fn of(context: &Context, mesh: &Mesh) -> Self {
        let surface = context.surface;
        let curves = surface.features().curves();
        let segments: Vec<(u32, usize)> =
            (0..).zip(curves).flat_map(|(id, curve)| (0..curve.half_edges.len()).map(move |k| (id, k))).collect();
        let ends = |&(curve, k): &(u32, usize)| {
            let vertices = &curves[curve as usize].vertices;
            [vertices[k], vertices[k + 1]].map(|v| DVec3::from(surface.point(v)))
        };
        let tree = Simplices::<2>::new(segments.iter().map(ends));
        let corners: Vec<DVec3> = surface.features().corners().map(|v| DVec3::from(surface.point(v))).collect();
        let mut on_curves: FxHashMap<u32, Vec<(f64, u32)>> = FxHashMap::default();
        let mut vertices = Vec::with_capacity(mesh.points.len());
        for (v, &point) in (0..).zip(&mesh.points) {
            let point = DVec3::from(surface.frame().to_unit(point));
            let triangle = context.orientation.triangles().nearest(point).0;
            let normal = if triangle == NONE { DVec3::Z } else { surface.normal(triangle as usize).as_dvec3() };
            let (mut place, mut triangles) = (Place::Free, [triangle; 2]);
            if triangle == NONE {
                // It is not finite.
                place = Place::Corner;
            } else if corners.iter().any(|corner| corner.distance(point) < ON_FEATURE) {
                (place, triangles) = (Place::Corner, [NONE; 2]);
            } else if let Some((_, found)) = tree.nearest(point).filter(|(distance, _)| *distance < ON_FEATURE) {
                let (curve, k) = segments[found.id as usize];
                let line = &curves[curve as usize];
                let s = line.arcs[k]
                    + found.corners[0].distance(nearest_on_segment(point, found.corners[0], found.corners[1]));
                let h = line.half_edges[k];
                triangles = [h / 3, surface.twin(h).unwrap_or(h) / 3];
                place = if context.is_shared(curve) { Place::Corner } else { Place::OnCurve { curve, s } };
                on_curves.entry(curve).or_default().push((s, v));
            }
            let axis = normal.any_orthonormal_vector();
            vertices.push(Vertex {
                point,
                place,
                triangles,
                normal,
                axis,
                valence: REGULAR,
                is_kept: false,
                origin: v,
            });
        }
        let is_whole = |face: &&[u32]| {
            let is_wrong = |k: usize| face[..k].contains(&face[k]) || face[k] as usize >= vertices.len();
            face.len() >= 3 && !(0..face.len()).any(is_wrong)
        };
        let faces: Vec<Vec<u32>> = mesh.faces().filter(is_whole).map(<[u32]>::to_vec).collect();
        let edges: FxHashSet<[u32; 2]> = faces.iter().flat_map(|face| sides(face)).map(undirected).collect();
        let mut features = FxHashMap::default();
        for (id, curve) in (0..).zip(curves) {
            let mut along = on_curves.remove(&id).unwrap_or_default();
            let tips = [(0.0, curve.vertices[0]), (curve.length(), curve.vertices[curve.vertices.len() - 1])];
            let at = |v: u32| DVec3::from(surface.point(v));
            let near = |tip: u32| vertices.iter().position(|vertex| vertex.point.distance(at(tip)) < ON_FEATURE);
            if !curve.closed {
                along.extend(tips.iter().filter_map(|&(s, tip)| Some((s, near(tip)? as u32))));
            }
            along.sort_by(|a, b| a.0.total_cmp(&b.0));
            let round = along.first().copied().filter(|_| curve.closed && along.len() > 2);
            let chain: Vec<u32> = along.iter().chain(&round).map(|&(_, v)| v).collect();
            let pairs = chain.windows(2).map(|pair| undirected([pair[0], pair[1]]));
            features.extend(pairs.filter(|pair| edges.contains(pair)).map(|pair| (pair, id)));
        }
        Self::new(vertices, &faces, features, Metric::default())
    }

    /// The compacted mesh, in the model units of the surface.
    pub fn in_model_units(&self, context: &Context) -> Mesh {
        self.compacted().to_mesh().placed(context.surface.frame())
    }
}
