//! Local relaxation: what an edit is worth once the vertices about it have moved to where they will be.
//!
//! The vertices move in their tangent planes, to where shape matching draws them; [relocation](crate::mesh::relocate) does the
//! same on the surface in the end.

use super::edit::{Edit, NEW};
use crate::mesh::metric::{Frame, laid, lifted};
use crate::mesh::objective::{Context, Measure, Score, TRIANGLE};
use crate::mesh::relocate::regular;
use glam::DVec3;
use rustc_hash::{FxHashMap, FxHashSet};

/// Rings of faces about a changed face whose inner vertices move.
const RINGS: usize = 2;
/// Sweeps over them.
const SWEEPS: usize = 6;
/// The share of the way to its place that a vertex moves in a sweep.
const STRIDE: f64 = 0.8;

/// What has become of an edit.
pub(crate) struct Relaxed {
    /// Where the vertices are drawn to that may move.
    pub targets: Vec<(u32, DVec3)>,
    /// The faces about the edit, before and after it.
    pub before: Score,
    pub after: Score,
    /// The least measures of a face, see [`Measure::least`].
    pub least_before: f64,
    pub least_after: f64,
    /// The faces that changed and those at their vertices.
    pub core: Vec<u32>,
}

/// Moves the vertices about the changed faces to where these are nearest to squares, and measures the faces. `known` are the
/// measures of the mesh's faces as they are; a triangle costs a price.
pub(crate) fn relaxed(context: &Context, edit: &Edit, known: &[Measure], price: f64) -> Relaxed {
    let mut patch = Patch::about(edit);
    (0..SWEEPS).for_each(|_| patch.sweep());

    let gone = || edit.changed().filter(|(_, corners)| corners.is_empty()).map(|(face, _)| face);
    let old = gone().chain(patch.faces.iter().copied()).filter(|&face| !edit.before(face).is_empty());
    let old: Vec<&Measure> = old.map(|face| &known[face as usize]).collect();
    let new: Vec<Measure> = (0..patch.corners.len()).map(|f| patch.measure(context, known, f)).collect();
    let least =
        |measures: &mut dyn Iterator<Item = &Measure>| measures.map(Measure::least).fold(f64::INFINITY, f64::min);
    Relaxed {
        before: old.iter().map(|measure| measure.score(price)).sum(),
        after: new.iter().map(|measure| measure.score(price)).sum(),
        least_before: least(&mut old.into_iter()),
        least_after: least(&mut new.iter()),
        core: gone().chain(patch.faces[..patch.core].iter().copied()).collect(),
        targets: patch.free.iter().map(|&v| (patch.vertices[v], patch.points[v])).collect(),
    }
}

/// The faces about an edit, with numbers of its own for their vertices.
struct Patch<'a> {
    edit: &'a Edit<'a>,
    vertices: Vec<u32>,
    points: Vec<DVec3>,
    normals: Vec<DVec3>,
    faces: Vec<u32>,
    /// The first of the faces have a vertex of a changed one.
    core: usize,
    corners: Vec<Vec<usize>>,
    /// The metric of the faces; none where tiles are squares.
    frames: Vec<Frame>,
    /// The vertices that move.
    free: Vec<usize>,
    /// For each vertex of `free`, the faces that it has and which of their corners it is.
    uses: Vec<Vec<(usize, usize)>>,
}

impl<'a> Patch<'a> {
    fn about(edit: &'a Edit<'a>) -> Self {
        let mut vertices = edit.touched();
        // A vertex that was merged with another has no face.
        vertices.retain(|&v| edit.around(v).next().is_some());
        let mut number: FxHashMap<u32, usize> = vertices.iter().enumerate().map(|(k, v)| (*v, k)).collect();
        let (mut faces, mut seen) = (Vec::new(), FxHashSet::default());
        let (mut core, mut inner) = (0, 0);
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
                core = faces.len();
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
            frames: edit.mesh.metric().frames(faces.iter().map(originals)),
            points: vertices.iter().map(|&v| edit.point(v)).collect(),
            normals: vertices.iter().map(|&v| edit.vertex(v).normal).collect(),
            uses: free.iter().map(|&v| std::mem::take(&mut all_uses[v])).collect(),
            vertices,
            faces,
            core,
            corners,
            free,
        }
    }

    fn sweep(&mut self) {
        for (&v, uses) in self.free.iter().zip(&self.uses) {
            let (mut way, mut weight) = (DVec3::ZERO, 0.0);
            for &(f, at) in uses {
                let face = &self.corners[f];
                let share = if face.len() == 3 { TRIANGLE } else { 1.0 };
                let frame = self.frames.get(f);
                let corner = |k: usize| laid(frame, self.points[face[(at + k) % face.len()]]);
                let target = lifted(frame, regular(face.len(), corner));
                way += (target - self.points[v]) * share;
                weight += share;
            }
            let (way, normal) = (way * (STRIDE / weight), self.normals[v]);
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
        Measure::of(points, self.frames.get(f), before, || context.orientation.is_inverted(points, sheets))
    }
}
