//! Chords of the rim: edges inside the mesh of a half whose ends both lie on the plane.
//!
//! # Theory
//! A chord is its own mirror image, so four faces would meet at it. It is split by a new vertex over its middle: the point of the
//! half there, seen along the plane's axis. So the tip of a part that lies across the plane keeps its thickness. A chord with no such
//! point, or whose faces would be poor, stays; a face all of whose vertices lie on the plane is then left out of the
//! [joined](super::join()) mesh.

use super::Plane;
use crate::mesh::Mesh;
use crate::mesh::quality::{quad_shape, triangle_shape};
use crate::surface::{Regions, Soup};
use glam::DVec2;

/// A point over a chord that is nearer to it than this, in lengths of the chord, is none.
const LEAST_HEIGHT: f64 = 0.1;
/// The least shape of the faces that a split leaves.
const LEAST_SHAPE: f64 = 0.1;

/// The mesh of a half without chords, and an end of the chord behind each added vertex; `half` is what was meshed.
pub fn split_chords(mesh: &Mesh, half: &Soup, plane: Plane, tolerance: f64) -> (Mesh, Vec<u32>) {
    let is_on_plane = |v: &u32| plane.height(mesh.points[*v as usize]).abs() <= tolerance;
    let chords = mesh.edges().into_iter().filter(|edge| !edge.is_boundary() && edge.ends.iter().all(is_on_plane));
    let chords: Vec<[u32; 2]> = chords.map(|edge| edge.ends).collect();
    if chords.is_empty() {
        return (mesh.clone(), Vec::new());
    }
    let mut points = mesh.points.clone();
    let region = |face: usize| mesh.regions.of_face.get(face).copied();
    let mut faces: Vec<(Vec<u32>, Option<u32>)> =
        mesh.faces().enumerate().map(|(k, face)| (face.to_vec(), region(k))).collect();
    let mut ends = Vec::new();
    for chord in chords {
        let [a, b] = chord.map(|v| mesh.place(v));
        let Some(over) = over(half, plane, ((a + b) / 2.0).into(), LEAST_HEIGHT * a.distance(b)) else { continue };
        let middle = points.len() as u32;
        points.push(over);
        let shape = |face: &[u32]| match *face {
            [a, b, c] => triangle_shape([a, b, c].map(|v| points[v as usize])),
            [a, b, c, d] => quad_shape([a, b, c, d].map(|v| points[v as usize])),
            _ => 1.0,
        };
        let parts: Vec<(usize, Vec<Vec<u32>>)> = (0..)
            .zip(&faces)
            .filter_map(|(k, (face, _))| Some((k, with_middle(face, chord, middle, shape)?)))
            .collect();
        if parts.iter().flat_map(|(_, parts)| parts).any(|part| shape(part) < LEAST_SHAPE) {
            points.pop();
            continue;
        }
        ends.push(chord[0]);
        for (k, parts) in parts.into_iter().rev() {
            let region = faces[k].1;
            faces.splice(k..=k, parts.into_iter().map(|part| (part, region)));
        }
    }
    let mut split = Mesh::new(points);
    faces.iter().for_each(|(face, _)| split.push_face(face));
    let of_face = faces.iter().filter_map(|(_, region)| *region).collect();
    split.regions = Regions { names: mesh.regions.names.clone(), of_face };
    (split, ends)
}

/// The lowest point of the half over a point of the plane, from a height on.
fn over(half: &Soup, plane: Plane, point: [f64; 3], least: f64) -> Option<[f64; 3]> {
    let axis = plane.axis.index();
    let flat = |p: [f64; 3]| DVec2::new(p[(axis + 1) % 3], p[(axis + 2) % 3]);
    let heights = half.triangles.iter().filter_map(|corners| {
        let corners = corners.map(|v| half.points[v as usize]);
        let [a, b, c] = corners.map(|corner| flat(corner) - flat(point));
        let shares = [b.perp_dot(c), c.perp_dot(a), a.perp_dot(b)];
        let sum: f64 = shares.iter().sum();
        let is_over = sum != 0.0 && shares.iter().all(|share| share * sum >= 0.0);
        is_over
            .then(|| corners.iter().zip(shares).map(|(&corner, share)| plane.height(corner) * share / sum).sum::<f64>())
    });
    let height = heights.filter(|height| *height >= least).min_by(f64::total_cmp)?;
    let mut over = point;
    over[axis] = plane.offset + height;
    Some(over)
}

/// The parts of a face on one of whose sides there is a new vertex, by the better of two cuts; `None` where the side is none of its.
fn with_middle(face: &[u32], chord: [u32; 2], middle: u32, shape: impl Fn(&[u32]) -> f64) -> Option<Vec<Vec<u32>>> {
    let is_side = |k: &usize| {
        let side = [face[*k], face[(k + 1) % face.len()]];
        side == chord || side == [chord[1], chord[0]]
    };
    let side = (0..face.len()).find(is_side)?;
    let mut face = face.to_vec();
    face.insert(side + 1, middle);
    face.rotate_left(side + 1);
    let [m, a, b, c, d] = face[..] else { return Some(vec![face]) };
    // A quad has become a pentagon. Both cuts end at the new vertex, so that none is a chord.
    let cuts = [vec![vec![m, b, c, d], vec![m, a, b]], vec![vec![m, a, b, c], vec![m, c, d]]];
    let least = |parts: &Vec<Vec<u32>>| parts.iter().map(|part| shape(part)).fold(f64::INFINITY, f64::min);
    cuts.into_iter().max_by(|a, b| least(a).total_cmp(&least(b)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::check::check;
    use crate::symmetry::{Axis, join};

    const PLANE: Plane = Plane { axis: Axis::Z, offset: 0.0 };

    /// The upper half of a pyramid's roof: a quad from the chord (0, 1) upward, and a face beyond the chord on the plane, whose corners
    /// are on the rim.
    fn tip(face: &[u32]) -> Mesh {
        let points = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [-0.2, -0.8], [1.2, -0.8]];
        let mut mesh = Mesh::new(points.map(|[x, y]| [x, y, 0.0]).to_vec());
        mesh.points[2][2] = 1.0;
        mesh.points[3][2] = 1.0;
        mesh.push_face(&[0, 1, 2, 3]);
        mesh.push_face(face);
        mesh
    }

    /// A roof of a height over all of the tip.
    fn roof(height: f64) -> Soup {
        let points = vec![[-9.0, -9.0, height], [9.0, -9.0, height], [0.0, 9.0, height]];
        Soup::new(points, vec![[0, 1, 2]])
    }

    #[test]
    fn a_chord_is_split_over_its_middle() {
        for (face, faces) in [(&[1, 0, 4][..], 3), (&[1, 0, 4, 5], 4)] {
            let mesh = tip(face);
            let (split, ends) = split_chords(&mesh, &roof(0.3), PLANE, 1e-9);
            assert_eq!((ends, split.points[6], split.face_count()), (vec![0], [0.5, 0.0, 0.3], faces));
            let kinds = |mesh: &Mesh| {
                check(&join(mesh, PLANE, 1e-9).mesh)
                    .count(|kind| !matches!(kind, crate::mesh::check::Kind::IsolatedVertex { .. }))
            };
            assert!(kinds(&split) == 0, "{}", check(&join(&split, PLANE, 1e-9).mesh));
            // Without a point over it the flat face goes.
            let (flat, ends) = split_chords(&mesh, &roof(0.01), PLANE, 1e-9);
            assert_eq!((flat.face_count(), ends.len()), (2, 0));
            let joined = join(&flat, PLANE, 1e-9).mesh;
            assert_eq!((joined.face_count(), joined.points.len(), check(&joined).is_clean()), (2, 6, true));
        }
    }
}
