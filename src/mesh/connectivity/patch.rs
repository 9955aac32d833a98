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
/// Sweeps over the vertices.
pub(super) const SWEEPS: usize = 6;
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
    /// All faces that the scores depend on.
    pub dependencies: Vec<u32>,
}

/// Relaxes the vertices near an edit, and measures the patch. `known` are the measures of the faces of the mesh; `price` is the
/// price of a triangle. Without sweeps no vertex has a target.
pub(crate) fn relaxed(context: &Context, edit: &Edit, known: &[Measure], price: f64, sweeps: usize) -> Relaxed {
    let mut patch = Patch::about(edit);
    (0..sweeps).for_each(|_| patch.sweep());
    let moved = if sweeps > 0 { &patch.free[..] } else { &[] };

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
        targets: moved.iter().map(|&v| (patch.vertices[v], patch.points[v])).collect(),
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
        let (mut first_ring, mut inner) = (0, 0);
        for ring in 0..RINGS {
            let begin = std::mem::replace(&mut inner, vertices.len());
            for k in begin..inner {
                for face in edit.around(vertices[k]).filter(|face| seen.insert(*face)) {
                    faces.push(face);
                    for &v in edit.face(face) {
                        number.entry(v).or_insert_with(|| {
                            vertices.push(v);
                            vertices.len() - 1
                        });
                    }
                }
            }
            if ring == 0 {
                first_ring = faces.len();
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
        let free: Vec<usize> = (0..inner).filter(|&v| edit.is_free(vertices[v])).collect();
        Self {
            edit,
            maps: edit.mesh.metric().maps_of(faces.iter().map(originals)),
            points: vertices.iter().map(|&v| edit.point(v)).collect(),
            normals: vertices.iter().map(|&v| edit.vertex(v).normal).collect(),
            uses: free.iter().map(|&v| std::mem::take(&mut all_uses[v])).collect(),
            vertices,
            faces,
            first_ring,
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
