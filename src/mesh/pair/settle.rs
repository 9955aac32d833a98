//! What a draft is worth once the vertices round it have settled.

use super::draft::Draft;
use crate::mesh::quality::{quad_shape, triangle_shape};
use crate::mesh::smooth::regular;
use glam::DVec3;
use rustc_hash::FxHashMap;

/// Vertices so many edges from a changed face move.
const RINGS: usize = 2;
/// Sweeps over them.
const SWEEPS: usize = 6;
/// The share of the way to its place that a vertex moves in a sweep.
const STRIDE: f64 = 0.8;

/// What has become of a draft.
pub(super) struct Settled {
    /// Where the vertices are that have moved.
    pub(super) places: Vec<(u32, DVec3)>,
    /// How much less is lost of shape, in perfect quads.
    pub(super) gain: f64,
    /// The faces at the vertices of those that changed.
    pub(super) core: Vec<u32>,
}

/// What a face of four sides or fewer lacks of a perfect quad.
fn loss(points: &[DVec3], price: f64) -> f64 {
    match *points {
        [a, b, c] => price + 0.5 * (1.0 - triangle_shape([a, b, c].map(DVec3::into))),
        [a, b, c, d] => 1.0 - quad_shape([a, b, c, d].map(DVec3::into)),
        _ => 0.0,
    }
}

/// Moves the vertices round the changed faces to where these are nearest to squares, and judges the result; `None` where
/// a quad would be worse than `least` and than all that were there, or a changed face would look away from the surface.
pub(super) fn settle(draft: &Draft, price: f64, least: f64) -> Option<Settled> {
    // The vertices that move, then those about them.
    let alive = |draft: &Draft, v: &u32| draft.around(*v).next().is_some();
    let mut vertices: Vec<u32> = draft.touched().into_iter().filter(|v| alive(draft, v)).collect();
    let mut number: FxHashMap<u32, usize> = vertices.iter().enumerate().map(|(k, v)| (*v, k)).collect();
    let mut faces: Vec<u32> = Vec::new();
    let mut face_seen: FxHashMap<u32, ()> = FxHashMap::default();
    let (mut begin, mut movable, mut core) = (0, 0, 0);
    for ring in 0..=RINGS {
        let end = vertices.len();
        if ring == RINGS {
            movable = begin;
        }
        for k in begin..end {
            let around: Vec<u32> = draft.around(vertices[k]).collect();
            for face in around {
                if face_seen.insert(face, ()).is_none() {
                    faces.push(face);
                    for &v in draft.face(face) {
                        number.entry(v).or_insert_with(|| {
                            vertices.push(v);
                            vertices.len() - 1
                        });
                    }
                }
            }
        }
        if ring == 0 {
            core = faces.len();
        }
        begin = end;
        if ring + 1 == RINGS {
            movable = end;
            break;
        }
    }
    let corners: Vec<Vec<usize>> =
        faces.iter().map(|face| draft.face(*face).iter().map(|v| number[v]).collect()).collect();
    let mut around: Vec<Vec<(usize, usize)>> = vec![Vec::new(); movable];
    for (f, face) in corners.iter().enumerate() {
        for (place, &v) in face.iter().enumerate() {
            if v < movable {
                around[v].push((f, place));
            }
        }
    }
    let mut points: Vec<DVec3> = vertices.iter().map(|v| draft.point(*v)).collect();
    let normals: Vec<DVec3> = vertices.iter().map(|v| draft.normal(*v)).collect();
    let free: Vec<bool> = vertices.iter().map(|v| !draft.is_fixed(*v)).collect();
    for _ in 0..SWEEPS {
        for v in (0..movable).filter(|v| free[*v]) {
            let mut way = DVec3::ZERO;
            let mut weight = 0.0;
            for &(f, place) in &around[v] {
                let face = &corners[f];
                let share = if face.len() == 3 { 0.5 } else { 1.0 };
                way += (regular(face.len(), |k| points[face[(place + k) % face.len()]]) - points[v]) * share;
                weight += share;
            }
            let way = way / weight * STRIDE;
            points[v] += way - normals[v] * normals[v].dot(way);
        }
    }

    let editor = &draft.scene.editor;
    let before = |face: u32| -> Vec<DVec3> {
        let known = if (face as usize) < editor.face_count() { editor.face(face) } else { &[] };
        known.iter().map(|v| DVec3::from(editor.point(*v))).collect()
    };
    let gone: Vec<u32> = draft.changed().filter(|(_, corners)| corners.is_empty()).map(|(face, _)| face).collect();
    let shape = |points: &[DVec3]| match *points {
        [a, b, c, d] => quad_shape([a, b, c, d].map(DVec3::into)),
        [a, b, c] => triangle_shape([a, b, c].map(DVec3::into)),
        _ => 1.0,
    };
    let (mut gain, mut worst_before) = (0.0, f64::INFINITY);
    for &face in faces.iter().chain(&gone) {
        let places = before(face);
        gain += loss(&places, price);
        if places.len() == 4 {
            worst_before = worst_before.min(shape(&places));
        }
    }
    let least = least.min(0.999 * worst_before);
    for face in &corners {
        let places: Vec<DVec3> = face.iter().map(|v| points[*v]).collect();
        gain -= loss(&places, price);
        // On features normals are rough.
        let up: DVec3 = face.iter().filter(|v| free[**v]).map(|v| normals[*v]).sum();
        let area = (2..places.len()).map(|k| (places[k - 1] - places[0]).cross(places[k] - places[0])).sum::<DVec3>();
        if places.len() == 4 && shape(&places) <= least || area.dot(up) < 0.0 {
            return None;
        }
    }
    let places = (0..movable).filter(|v| free[*v]).map(|v| (vertices[v], points[v])).collect();
    let core = gone.iter().chain(&faces[..core]).copied().collect();
    Some(Settled { places, gain, core })
}
