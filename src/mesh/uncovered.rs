//! The points of a surface that a mesh misses.
//!
//! # Theory
//! The vertices and the middles of the triangles of the surface are compared with the mesh, whose polygons are fans of triangles. Most
//! have a vertex of the mesh nearby; the distance of the others is measured.

use super::Mesh;
use super::incidence::sides;
use crate::geometry::cells_around;
use crate::surface::Surface;
use crate::surface::nearest::{Simplices, squared_distance};
use glam::{DVec3, IVec3};
use rayon::prelude::*;
use rustc_hash::FxHashMap;

/// A part of the surface that is farther from the mesh than this is missing, in mean edge lengths of the mesh.
pub(super) const UNCOVERED: f64 = 1.0;
/// So many points are compared with all faces; for more a tree pays.
const FEW: usize = 16;

/// A vertex or the middle of a triangle of a surface that is missing in a mesh.
#[derive(Clone, Copy)]
pub(super) struct UncoveredPoint {
    /// Its distance from the mesh, unit-sized.
    pub distance: f64,
    /// The mean edge length of the mesh, unit-sized.
    pub edge: f64,
    pub point: DVec3,
    /// The number of the vertex, or that of the triangle after all vertices.
    id: usize,
}

impl UncoveredPoint {
    /// A triangle of the surface that has it.
    pub fn triangle(&self, surface: &Surface) -> u32 {
        let has = |corners: &[u32; 3]| corners.contains(&(self.id as u32));
        let of_middle = self.id.checked_sub(surface.vertex_count());
        of_middle.or_else(|| surface.triangles.iter().position(has)).unwrap_or_default() as u32
    }
}

/// The points of a surface that are missing in a unit-sized mesh that was made of it, the farthest first.
pub(super) fn uncovered_points(mesh: &Mesh, surface: &Surface) -> Vec<UncoveredPoint> {
    let lengths = || mesh.faces().flat_map(sides).map(|[a, b]| mesh.place(a).distance(mesh.place(b)));
    let edge = lengths().sum::<f64>() / lengths().count().max(1) as f64;
    let cell = |p: DVec3| (p / edge).floor().as_ivec3();
    let mut first: FxHashMap<IVec3, u32> = FxHashMap::default();
    first.reserve(mesh.points.len());
    // The next vertex in the same cell.
    let next: Vec<Option<u32>> = (0..mesh.points.len() as u32).map(|v| first.insert(cell(mesh.place(v)), v)).collect();
    let is_near = |p: DVec3| {
        let firsts = cells_around(cell(p)).filter_map(|cell| first.get(&cell).copied());
        let mut vertices = firsts.flat_map(|v| std::iter::successors(Some(v), |&v| next[v as usize]));
        vertices.any(|v| mesh.place(v).distance_squared(p) < edge * edge)
    };
    let vertices = surface.vertex_count();
    let point = |id: usize| match id.checked_sub(vertices) {
        None => surface.points[id].as_dvec3(),
        Some(triangle) => surface.corners(triangle).iter().map(|corner| corner.as_dvec3()).sum::<DVec3>() / 3.0,
    };
    let all = (0..vertices + surface.triangle_count()).into_par_iter().with_min_len(1024);
    let far: Vec<usize> = all.filter(|&id| !is_near(point(id))).collect();
    let tree = (far.len() > FEW).then(|| fan(mesh));
    let distance = |p: DVec3| match &tree {
        Some(tree) => tree.distance(p),
        None => triangles(mesh).map(|corners| squared_distance(p, corners)).fold(f64::INFINITY, f64::min).sqrt(),
    };
    let measured = far.par_iter().map(|&id| {
        let point = point(id);
        UncoveredPoint { distance: distance(point), edge, point, id }
    });
    let mut uncovered: Vec<UncoveredPoint> = measured.filter(|found| found.distance > UNCOVERED * edge).collect();
    uncovered.sort_by(|a, b| b.distance.total_cmp(&a.distance).then(a.id.cmp(&b.id)));
    uncovered
}

/// The faces, those of more than three sides as fans about their first vertex.
fn triangles(mesh: &Mesh) -> impl Iterator<Item = [DVec3; 3]> {
    mesh.faces()
        .flat_map(move |face| (2..face.len()).map(move |k| [face[0], face[k - 1], face[k]].map(|v| mesh.place(v))))
}

/// The tree of [`triangles`].
pub(super) fn fan(mesh: &Mesh) -> Simplices<3> {
    Simplices::new(triangles(mesh))
}
