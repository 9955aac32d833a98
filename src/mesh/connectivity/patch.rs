//! Local relaxation: the scores about an edit after the vertices near it have moved.
//!
//! # Theory
//! The free vertices near the edit move by shape matching, as in [relocation](crate::mesh::relocate), but in their tangent planes:
//! this is fast, and near enough to the relocation that follows.

use super::edit::{Edit, NEW};
use crate::mesh::metric::{MetricMap, from_metric, to_metric};
use crate::mesh::objective::{Context, Measure, Score, TRIANGLE_WEIGHT};
use crate::mesh::relocate::regular;
use glam::DVec3;
use rustc_hash::{FxHashMap, FxHashSet};

/// The number of rings of faces about the changed faces in the patch; vertices inside it move.
const RINGS: usize = 2;
/// A vertex of more faces is a hub: the patch does not grow from its rim. Where a surface narrows to far below a tile, each edit at a
/// hub would cost as much as the whole mesh otherwise.
const HUB: usize = 24;
/// Sweeps over the vertices.
const SWEEPS: usize = 6;
/// The relaxation factor of a sweep.
const RELAXATION: f64 = 0.8;

/// An edit after local relaxation.
pub(crate) struct Relaxed {
    /// The points of the vertices that moved.
    pub targets: Vec<(u32, DVec3)>,
    /// The score of the patch before the edit.
    pub before: Score,
    /// The score of the patch after the edit.
    pub after: Score,
    /// The least [`Measure::least`] of the patch before the edit.
    pub least_before: f64,
    /// The least [`Measure::least`] of the patch after the edit.
    pub least_after: f64,
    /// The changed faces and those at their vertices.
    pub neighbourhood: Vec<u32>,
    /// Those of them that are not at a hub alone.
    pub nearest: Vec<u32>,
    /// All faces that the scores depend on.
    pub dependencies: Vec<u32>,
}

/// Relaxes the vertices near an edit, and measures the patch. `known` are the measures of the faces of the mesh; `price` is the
/// price of a triangle.
pub(crate) fn relaxed(context: &Context, edit: &Edit, known: &[Measure], price: f64) -> Relaxed {
    let mut patch = Patch::about(edit);
    (0..SWEEPS).for_each(|_| patch.sweep());

    let removed = || edit.changed().filter(|(_, corners)| corners.is_empty()).map(|(face, _)| face);
    let old = removed().chain(patch.faces.iter().copied()).filter(|&face| !edit.before(face).is_empty());
    let old: Vec<&Measure> = old.map(|face| &known[face as usize]).collect();
    let new: Vec<Measure> = (0..patch.corners.len()).map(|f| patch.measure(context, known, f)).collect();
    let least =
        |measures: &mut dyn Iterator<Item = &Measure>| measures.map(Measure::least).fold(f64::INFINITY, f64::min);
    Relaxed {
        before: old.iter().map(|measure| measure.score(price)).sum(),
        after: new.iter().map(|measure| measure.score(price)).sum(),
        least_before: least(&mut old.into_iter()),
        least_after: least(&mut new.iter()),
        dependencies: removed().chain(patch.faces.iter().copied()).collect(),
        neighbourhood: removed().chain(patch.faces[..patch.first_ring].iter().copied()).collect(),
        nearest: removed().chain(patch.faces[..patch.off_hubs].iter().copied()).collect(),
        targets: patch.free.iter().map(|&v| (patch.vertices[v], patch.points[v])).collect(),
    }
}

/// The faces near an edit, with local numbers for their vertices.
struct Patch<'a> {
    edit: &'a Edit<'a>,
    vertices: Vec<u32>,
    points: Vec<DVec3>,
    normals: Vec<DVec3>,
    faces: Vec<u32>,
    /// The number of faces in the first ring: the first faces.
    first_ring: usize,
    /// The number of those that are not at a hub alone.
    off_hubs: usize,
    corners: Vec<Vec<usize>>,
    /// The maps of the faces' metric; empty where tiles are squares.
    maps: Vec<MetricMap>,
    /// The vertices that move.
    free: Vec<usize>,
    /// For each vertex of `free`, its faces and its corner in each.
    uses: Vec<Vec<(usize, usize)>>,
}

impl<'a> Patch<'a> {
    fn about(edit: &'a Edit<'a>) -> Self {
        let mut vertices = edit.touched();
        // A merged vertex has no face.
        vertices.retain(|&v| edit.around(v).next().is_some());
        let mut number: FxHashMap<u32, usize> = vertices.iter().enumerate().map(|(k, v)| (*v, k)).collect();
        let (mut faces, mut seen) = (Vec::new(), FxHashSet::default());
        let (mut first_ring, mut off_hubs, mut inner, mut reached) = (0, 0, 0, vertices.len());
        let is_hub = |v: u32| v < NEW && edit.mesh.around(v).len() > HUB;
        let mut outer_hubs = Vec::new();
        for ring in 0..RINGS {
            let begin = std::mem::replace(&mut inner, reached);
            let (hubs, others): (Vec<usize>, Vec<usize>) = (begin..inner).partition(|&k| is_hub(vertices[k]));
            let mut add_faces_at = |k: usize, vertices: &mut Vec<u32>, faces: &mut Vec<u32>| {
                for face in edit.around(vertices[k]).filter(|face| seen.insert(*face)) {
                    faces.push(face);
                    for &v in edit.face(face) {
                        number.entry(v).or_insert_with(|| {
                            vertices.push(v);
                            vertices.len() - 1
                        });
                    }
                }
            };
            others.into_iter().for_each(|k| add_faces_at(k, &mut vertices, &mut faces));
            reached = vertices.len();
            if ring == 0 {
                off_hubs = faces.len();
                hubs.into_iter().for_each(|k| add_faces_at(k, &mut vertices, &mut faces));
                first_ring = faces.len();
            } else {
                outer_hubs = hubs;
            }
        }
        let corners: Vec<Vec<usize>> =
            faces.iter().map(|face| edit.face(*face).iter().map(|v| number[v]).collect()).collect();
        let originals = |face: &u32| edit.face(*face).iter().map(|&v| edit.original(v)).collect::<Vec<u32>>();
        let mut all_uses = vec![Vec::new(); inner];
        for (f, face) in corners.iter().enumerate() {
            for (k, &v) in face.iter().enumerate().filter(|(_, v)| **v < inner) {
                all_uses[v].push((f, k));
            }
        }
        let is_whole = |v: &usize| outer_hubs.binary_search(v).is_err();
        let free: Vec<usize> = (0..inner).filter(|&v| edit.is_free(vertices[v])).filter(is_whole).collect();
        Self {
            edit,
            maps: edit.mesh.metric().maps_of(faces.iter().map(originals)),
            points: vertices.iter().map(|&v| edit.point(v)).collect(),
            normals: vertices.iter().map(|&v| edit.vertex(v).normal).collect(),
            uses: free.iter().map(|&v| std::mem::take(&mut all_uses[v])).collect(),
            vertices,
            faces,
            first_ring,
            off_hubs,
            corners,
            free,
        }
    }

    fn sweep(&mut self) {
        for (&v, uses) in self.free.iter().zip(&self.uses) {
            let (mut way, mut weight) = (DVec3::ZERO, 0.0);
            for &(f, at) in uses {
                let face = &self.corners[f];
                let share = if face.len() == 3 { TRIANGLE_WEIGHT } else { 1.0 };
                let map = self.maps.get(f);
                let corner = |k: usize| to_metric(map, self.points[face[(at + k) % face.len()]]);
                let target = from_metric(map, regular(face.len(), corner));
                way += (target - self.points[v]) * share;
                weight += share;
            }
            let (way, normal) = (way * (RELAXATION / weight), self.normals[v]);
            self.points[v] += way - normal * normal.dot(way);
        }
    }

    fn measure(&self, context: &Context, known: &[Measure], f: usize) -> Measure {
        let corners = &self.corners[f];
        let mut points = [DVec3::ZERO; 5];
        let count = corners.len().min(5);
        (0..count).for_each(|k| points[k] = self.points[corners[k]]);
        let points = &points[..count];
        let face = self.faces[f];
        let is_same = face < NEW && !self.edit.changed().any(|(changed, _)| changed == face);
        let before = is_same.then(|| &known[face as usize]);
        let sheets = corners.iter().map(|&v| self.edit.vertex(self.vertices[v]).triangles);
        Measure::of(points, self.maps.get(f), before, || context.orientation.is_inverted(points, sheets))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Mesh, SurfaceMesh};
    use crate::surface::{FeatureOptions, Soup, Surface};
    use std::f64::consts::TAU;

    /// The number of faces in the patch about two triangles that become one quad at the middle of a disc, of three rings of so many
    /// faces.
    fn patch_at_middle(count: u32) -> usize {
        let at = |ring: u32, k: u32| if ring == 0 { 0 } else { 1 + (ring - 1) * count + k % count };
        let place = |ring: u32, k: u32| {
            let (sine, cosine) = (TAU * f64::from(k) / f64::from(count)).sin_cos();
            [f64::from(ring) * cosine, f64::from(ring) * sine, 0.0]
        };
        let around = (1..4).flat_map(|ring| (0..count).map(move |k| place(ring, k)));
        let points: Vec<[f64; 3]> = [[0.0; 3]].into_iter().chain(around).collect();
        let mut mesh = Mesh::new(points.clone());
        (0..count).for_each(|k| mesh.push_face(&[0, at(1, k), at(1, k + 1)]));
        for ring in 1..3 {
            for k in 0..count {
                mesh.push_face(&[at(ring, k), at(ring + 1, k), at(ring + 1, k + 1), at(ring, k + 1)]);
            }
        }
        let split = |face: &[u32]| face.windows(2).skip(1).map(|edge| [face[0], edge[0], edge[1]]).collect::<Vec<_>>();
        let soup = Soup::new(points, mesh.faces().flat_map(split).collect());
        let surface = Surface::new(&soup, &FeatureOptions::default()).unwrap_or_else(|error| panic!("{error}"));
        let context = Context::new(&surface);
        let mesh = SurfaceMesh::of(&context, &mesh);
        let mut edit = Edit::new(&mesh);
        edit.set_face(0, &[0, at(1, 0), at(1, 1), at(1, 2)]);
        edit.set_face(1, &[]);
        Patch::about(&edit).faces.len()
    }

    #[test]
    fn a_patch_does_not_grow_from_the_rim_of_a_hub() {
        let below = HUB as u32 - 4;
        assert!(patch_at_middle(below) >= 2 * below as usize - 1, "two whole rings");
        for count in [HUB as u32 + 4, 200] {
            assert!((count as usize - 1..count as usize + 12).contains(&patch_at_middle(count)), "{count}");
        }
    }
}
