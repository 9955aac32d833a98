//! What a draft is worth once the vertices round it have settled.
//!
//! The vertices move in their tangent planes, to where shape matching ([`regular`]) draws them; the pipeline's smoothing
//! does the same on the surface in the end.

use super::draft::Draft;
use crate::mesh::metric::{Frame, laid, lifted};
use crate::mesh::quality::{quad_shape, triangle_shape};
use crate::mesh::smooth::regular;
use glam::DVec3;
use rustc_hash::{FxHashMap, FxHashSet};

/// Rings of faces about a changed face whose inner vertices move.
const RINGS: usize = 2;
/// Sweeps over them.
const SWEEPS: usize = 6;
/// The share of the way to its place that a vertex moves in a sweep.
const STRIDE: f64 = 0.8;
/// The say of a triangle, in quads.
const TRIANGLE: f64 = 0.5;
/// A triangle of a smaller shape is no better than a bad quad.
const THIN: f64 = 0.1;
/// A draft may lower the worst shape about it by this share: a shape that nothing changed would fail a sharper test.
const ROUNDING: f64 = 1e-3;

/// What has become of a draft.
pub(super) struct Settled {
    /// Where the vertices are that have moved.
    pub(super) places: Vec<(u32, DVec3)>,
    /// How much less is lost of shape, in perfect quads.
    pub(super) gain: f64,
    /// The faces that changed and those at their vertices.
    pub(super) core: Vec<u32>,
}

/// Moves the vertices round the changed faces to where these are nearest to squares, and judges the result; `None` where
/// a quad would be worse than `least` and than all that were there, or a face would look away from the surface.
///
/// `price` is what a triangle costs, in perfect quads.
pub(super) fn settle(draft: &Draft, price: f64, least: f64) -> Option<Settled> {
    let (patch, settled, worst) = settled(draft, price);
    let least = least.min((1.0 - ROUNDING) * worst);
    let is_bad = |f: usize| quality(&patch.shown(f)) <= least || patch.looks_away(f);
    (!(0..patch.corners.len()).any(is_bad)).then_some(settled)
}

/// As [`settle`], whatever comes of it.
pub(super) fn settle_anyhow(draft: &Draft, price: f64) -> Settled {
    settled(draft, price).1
}

/// The settled patch, what has become of it, and the worst shape that was there.
fn settled<'a>(draft: &'a Draft<'a>, price: f64) -> (Patch<'a>, Settled, f64) {
    let mut patch = Patch::about(draft);
    (0..SWEEPS).for_each(|_| patch.sweep());

    let gone = || draft.changed().filter(|(_, corners)| corners.is_empty()).map(|(face, _)| face);
    let editor = &draft.scene.editor;
    let (mut gain, mut worst) = (0.0, f64::INFINITY);
    for face in gone().chain(patch.faces.iter().copied()).filter(|face| (*face as usize) < editor.face_count()) {
        let frame = draft.scene.metric.frame(editor.face(face));
        let before: Vec<DVec3> =
            editor.face(face).iter().map(|v| laid(frame.as_ref(), editor.point(*v).into())).collect();
        gain += loss(&before, price);
        worst = worst.min(quality(&before));
    }
    gain -= (0..patch.corners.len()).map(|f| loss(&patch.shown(f), price)).sum::<f64>();
    let core = gone().chain(patch.faces[..patch.core].iter().copied()).collect();
    let places = patch.free.iter().map(|&v| (patch.vertices[v], patch.points[v])).collect();
    (patch, Settled { places, gain, core }, worst)
}

/// The shape of a quad; of triangles those alone count that have hardly any.
pub(super) fn quality(points: &[DVec3]) -> f64 {
    match *points {
        [a, b, c, d] => quad_shape([a, b, c, d].map(DVec3::into)),
        [a, b, c] if triangle_shape([a, b, c].map(DVec3::into)) < THIN => THIN / 10.0,
        _ => 1.0,
    }
}

/// What a face lacks of a perfect quad.
fn loss(points: &[DVec3], price: f64) -> f64 {
    match *points {
        [a, b, c] => price + TRIANGLE * (1.0 - triangle_shape([a, b, c].map(DVec3::into))),
        _ => 1.0 - quality(points),
    }
}

/// The faces about a draft, with numbers of its own for their vertices.
struct Patch<'a> {
    draft: &'a Draft<'a>,
    vertices: Vec<u32>,
    points: Vec<DVec3>,
    normals: Vec<DVec3>,
    faces: Vec<u32>,
    /// The first of the faces have a vertex of a changed one.
    core: usize,
    corners: Vec<Vec<usize>>,
    /// What the shapes of the faces are measured in; none where tiles are squares.
    frames: Vec<Frame>,
    /// The vertices that move.
    free: Vec<usize>,
    /// For each vertex of `free`, the places that it has in faces.
    seats: Vec<Vec<(usize, usize)>>,
}

impl<'a> Patch<'a> {
    fn about(draft: &'a Draft<'a>) -> Self {
        let mut vertices = draft.touched();
        // A vertex that was merged with another has no face.
        vertices.retain(|v| draft.around(*v).next().is_some());
        let mut number: FxHashMap<u32, usize> = vertices.iter().enumerate().map(|(k, v)| (*v, k)).collect();
        let (mut faces, mut seen) = (Vec::new(), FxHashSet::default());
        let (mut core, mut inner) = (0, 0);
        for ring in 0..RINGS {
            let begin = std::mem::replace(&mut inner, vertices.len());
            for k in begin..inner {
                for face in draft.around(vertices[k]).filter(|face| seen.insert(*face)) {
                    faces.push(face);
                    for &v in draft.face(face) {
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
            faces.iter().map(|face| draft.face(*face).iter().map(|v| number[v]).collect()).collect();
        let originals = |face: &u32| draft.face(*face).iter().map(|v| draft.original(*v)).collect::<Vec<u32>>();
        let mut all_seats = vec![Vec::new(); inner];
        for (f, face) in corners.iter().enumerate() {
            for (place, &v) in face.iter().enumerate().filter(|(_, v)| **v < inner) {
                all_seats[v].push((f, place));
            }
        }
        let free: Vec<usize> = (0..inner).filter(|v| !draft.is_fixed(vertices[*v])).collect();
        Self {
            draft,
            frames: draft.scene.metric.frames(faces.iter().map(originals)),
            points: vertices.iter().map(|v| draft.point(*v)).collect(),
            normals: vertices.iter().map(|v| draft.normal(*v)).collect(),
            seats: free.iter().map(|v| std::mem::take(&mut all_seats[*v])).collect(),
            vertices,
            faces,
            core,
            corners,
            free,
        }
    }

    fn sweep(&mut self) {
        for (&v, seats) in self.free.iter().zip(&self.seats) {
            let (mut way, mut weight) = (DVec3::ZERO, 0.0);
            for &(f, place) in seats {
                let face = &self.corners[f];
                let share = if face.len() == 3 { TRIANGLE } else { 1.0 };
                let frame = self.frames.get(f);
                let corner = |k: usize| laid(frame, self.points[face[(place + k) % face.len()]]);
                let ideal = lifted(frame, regular(face.len(), corner));
                way += (ideal - self.points[v]) * share;
                weight += share;
            }
            let (way, normal) = (way * (STRIDE / weight), self.normals[v]);
            self.points[v] += way - normal * normal.dot(way);
        }
    }

    /// The corners of a face as its metric shows them.
    fn shown(&self, f: usize) -> Vec<DVec3> {
        self.corners[f].iter().map(|v| laid(self.frames.get(f), self.points[*v])).collect()
    }

    /// Whether a face lies upside down; not where all of its vertices are on features, whose normals are rough.
    fn looks_away(&self, f: usize) -> bool {
        let corners = &self.corners[f];
        let free = corners.iter().filter(|v| !self.draft.is_fixed(self.vertices[**v]));
        let up: DVec3 = free.map(|v| self.normals[*v]).sum();
        let at = |k: usize| self.points[corners[k]];
        let area = (2..corners.len()).map(|k| (at(k - 1) - at(0)).cross(at(k) - at(0))).sum::<DVec3>();
        area.dot(up) < 0.0
    }
}
