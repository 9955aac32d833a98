//! Chords of the rim: edges inside the mesh of a half whose ends both lie on the plane.
//!
//! # Theory
//! A chord is its own mirror image, so four faces would meet at it. Its two faces are cut anew without a chord, as at the tip of a part
//! that lies across the plane. Where no cut leaves good faces, the chord stays; a face all of whose vertices lie on the plane is left
//! out of the [joined](super::join()) mesh.

use super::Plane;
use crate::mesh::Mesh;
use crate::mesh::incidence::{sides, undirected};
use crate::mesh::polygon::cut;
use crate::mesh::quality::{quad_shape, triangle_shape};
use crate::surface::Regions;
use rustc_hash::FxHashSet;

/// The least shape of a face that a cut leaves.
const LEAST_SHAPE: f64 = 0.1;

/// The mesh of a half without chords. Vertices no farther than `tolerance` from the plane, in model units, lie on it.
pub fn without_chords(mesh: &Mesh, plane: Plane, tolerance: f64) -> Mesh {
    let is_on_plane = |v: u32| plane.height(mesh.points[v as usize]).abs() <= tolerance;
    let all = mesh.edges();
    let mut edges: FxHashSet<[u32; 2]> = all.iter().map(|edge| edge.ends).collect();
    let chords = all.iter().filter(|edge| !edge.is_boundary() && edge.ends.iter().all(|&v| is_on_plane(v)));
    let region = |face: usize| mesh.regions.of_face.get(face).copied();
    let mut faces: Vec<(Vec<u32>, Option<u32>)> =
        mesh.faces().enumerate().map(|(k, face)| (face.to_vec(), region(k))).collect();
    for [a, b] in chords.map(|edge| edge.ends) {
        let find = |side: [u32; 2]| faces.iter().position(|(face, _)| beyond(face, side).is_some());
        let (Some(first), Some(second)) = (find([a, b]), find([b, a])) else { continue };
        // The corners of both faces in order.
        let polygon: Vec<u32> = [(first, [a, b]), (second, [b, a])]
            .into_iter()
            .flat_map(|(face, side)| [vec![side[1]], beyond(&faces[face].0, side).unwrap_or_default()].concat())
            .collect();
        let corners = |face: &[usize]| -> Vec<u32> { face.iter().map(|&k| polygon[k]).collect() };
        let loss = |face: &[usize]| match shape(mesh, &corners(face)) {
            shape if shape < LEAST_SHAPE => f64::INFINITY,
            shape => 1.0 / shape,
        };
        // A new edge is no chord, and none that other faces have.
        let is_taken = |ends: [u32; 2]| ends.iter().all(|&v| is_on_plane(v)) || edges.contains(&undirected(ends));
        let chord = |i: usize, j: usize| if is_taken([polygon[i], polygon[j]]) { f64::INFINITY } else { 0.0 };
        if let Some((_, parts)) = cut(polygon.len(), loss, chord) {
            let known = faces.len();
            let mut parts = parts.iter().map(|part| corners(part));
            let regions = [first, second].map(|face| faces[face].1);
            for (face, region) in [first, second].into_iter().zip(regions) {
                // As many faces as before, or one more.
                faces[face] = (parts.next().unwrap_or_default(), region);
            }
            faces.extend(parts.map(|part| (part, regions[0])));
            edges.remove(&undirected([a, b]));
            for face in [first, second].into_iter().chain(known..faces.len()) {
                edges.extend(sides(&faces[face].0).map(undirected));
            }
        }
    }
    faces.retain(|(face, _)| !face.is_empty());
    // Faces are sorted by region.
    faces.sort_by_key(|(_, region)| *region);
    let mut result = Mesh::new(mesh.points.clone());
    faces.iter().for_each(|(face, _)| result.push_face(face));
    let of_face = faces.iter().filter_map(|(_, region)| *region).collect();
    result.regions = Regions { names: mesh.regions.names.clone(), of_face };
    result
}

/// The corners of a face from the end of a side on to its start, both left out; `None` where the side is none of its.
fn beyond(face: &[u32], [a, b]: [u32; 2]) -> Option<Vec<u32>> {
    let count = face.len();
    let start = (0..count).find(|&k| face[k] == a && face[(k + 1) % count] == b)?;
    Some((2..count).map(|k| face[(start + k) % count]).collect())
}

fn shape(mesh: &Mesh, face: &[u32]) -> f64 {
    let place = |v: u32| mesh.points[v as usize];
    match *face {
        [a, b, c] => triangle_shape([a, b, c].map(place)),
        [a, b, c, d] => quad_shape([a, b, c, d].map(place)),
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::check::{Kind, check};
    use crate::symmetry::{Axis, join};

    const PLANE: Plane = Plane { axis: Axis::Z, offset: 0.0 };

    /// A quad from the chord between vertices 0 and 1 upward, by a height, and beyond the chord the flat tip, a triangle or a quad.
    fn tip(face: &[u32], height: f64) -> Mesh {
        let points = [[-1.0, 0.0], [1.0, 0.0], [0.5, 0.9], [-0.5, 0.9], [-0.5, -0.9], [0.5, -0.9]];
        let mut mesh = Mesh::new(points.map(|[x, y]| [x, y, 0.0]).to_vec());
        mesh.points[2][2] = height;
        mesh.points[3][2] = height;
        mesh.push_face(&[0, 1, 2, 3]);
        mesh.push_face(face);
        mesh
    }

    /// The number of edges of the joined mesh at which more than two faces meet, and of its faces.
    fn joined(mesh: &Mesh) -> [usize; 2] {
        let mesh = join(mesh, PLANE, 1e-9).mesh;
        [check(&mesh).count(|kind| matches!(kind, Kind::NonManifoldEdge { .. })), mesh.face_count()]
    }

    #[test]
    fn the_faces_at_a_chord_are_cut_anew() {
        for face in [&[1, 0, 4][..], &[1, 0, 4, 5]] {
            let mesh = tip(face, 0.5);
            let cut = without_chords(&mesh, PLANE, 1e-9);
            assert_eq!(joined(&cut), [0, 2 * cut.face_count()], "no face is left out: {cut:?}");
            let chords = cut.edges().into_iter().filter(|edge| edge.ends == [0, 1]);
            assert_eq!((chords.count(), mesh.edges().iter().filter(|edge| edge.ends == [0, 1]).count()), (0, 1));
            assert_eq!(joined(&mesh), [0, 2], "without that the tip is left out");
        }
    }

    #[test]
    fn a_chord_between_two_faces_off_the_plane_stays_where_no_cut_is_good() {
        // A neck: both faces rise from the chord.
        let mut neck = tip(&[1, 0, 4, 5], 0.5);
        neck.points[4][2] = 0.5;
        neck.points[5][2] = 0.5;
        assert_eq!(joined(&neck), [1, 4]);
        assert_eq!(joined(&without_chords(&neck, PLANE, 1e-9))[0], 0);
        // So far up that any other face is a sliver.
        for v in 2..6 {
            neck.points[v][2] = 1e3;
        }
        assert_eq!(joined(&without_chords(&neck, PLANE, 1e-9)), [1, 4]);
    }
}
