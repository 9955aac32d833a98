//! Faces that look away from the surface are cut anew; features and all quads stay.

#[path = "common/plate.rs"]
mod plate;

use plate::{at, grid, plate};
use quadmosaic::mesh::facing::Facing;
use quadmosaic::mesh::pair::upright::{Uprighted, upright};
use quadmosaic::mesh::pair::{PairOptions, Quads};
use quadmosaic::mesh::quality::quad_shape;
use quadmosaic::mesh::smooth::Smoothed;
use quadmosaic::mesh::{Mesh, Metric};
use quadmosaic::surface::Surface;

/// The faces of the plate's mesh whose normal points down.
fn turned_over(mesh: &Mesh) -> usize {
    let area = |face: &[u32]| {
        let cross = |(a, b): (&u32, &u32)| {
            let [p, q] = [a, b].map(|&v| mesh.points[v as usize]);
            p[0] * q[1] - p[1] * q[0]
        };
        face.iter().zip(face.iter().cycle().skip(1)).map(cross).sum::<f64>()
    };
    mesh.faces().filter(|face| area(face) < 0.0).count()
}

/// The plate's grid, no vertex of which may move, with other faces in the place of some.
fn held(surface: &Surface, moved: (usize, [f64; 2]), gone: &[[usize; 2]], come: &[&[usize]]) -> Smoothed {
    let Smoothed { mesh, below } = grid(surface, &[moved]);
    let is_gone = |face: &[u32]| gone.iter().any(|&[i, j]| face[0] as usize == at(i, j));
    let mut held = Mesh::new(mesh.points.clone());
    mesh.faces().filter(|face| !is_gone(face)).for_each(|face| held.push_face(face));
    for face in come {
        held.push_face(&face.iter().map(|&v| v as u32).collect::<Vec<u32>>());
    }
    Smoothed { mesh: held, below: vec![None; below.len()] }
}

fn set_upright(surface: &Surface, smoothed: &Smoothed, features: &[[u32; 2]], quads: Quads) -> Option<Uprighted> {
    let options = PairOptions { quads, ..PairOptions::default() };
    upright(&Metric::default(), &Facing::new(surface), smoothed, features, &options)
}

#[test]
fn two_triangles_are_cut_along_the_other_diagonal_unless_theirs_is_a_feature() {
    let surface = plate();
    let [a, b, c, d] = [at(2, 2), at(3, 2), at(3, 3), at(2, 3)];
    // One corner lies beyond the diagonal that the triangles share.
    let wrong = held(&surface, (d, [2.7, 2.3]), &[[2, 2]], &[&[a, b, c], &[a, c, d]]);
    assert_eq!(turned_over(&wrong.mesh), 1);
    let Uprighted { smoothed, kept, count } = set_upright(&surface, &wrong, &[], Quads::Most).unwrap();
    assert_eq!((turned_over(&smoothed.mesh), count), (0, 1));
    assert_eq!(smoothed.mesh.points, wrong.mesh.points);
    assert_eq!(kept, (0..wrong.mesh.points.len() as u32).collect::<Vec<u32>>());
    assert_eq!(smoothed.mesh.face_count(), wrong.mesh.face_count());
    // The other diagonal leads into the surface, those to the quads about do not.
    let stays = [[a, b], [b, c], [c, d], [d, a], [a, c]].map(|[v, w]| [v.min(w) as u32, v.max(w) as u32]);
    assert!(set_upright(&surface, &wrong, &stays, Quads::Most).is_none());
}

#[test]
fn quads_are_turned_and_stay_quads() {
    let surface = plate();
    let [a, b, c, d, e, f] = [at(2, 2), at(3, 2), at(4, 2), at(4, 3), at(3, 3), at(2, 3)];
    // The edge between two squares leads elsewhere, so that each has a straight corner.
    let wrong = held(&surface, (e, [3.0, 3.0]), &[[2, 2], [3, 2]], &[&[f, a, b, c], &[c, d, e, f]]);
    let Uprighted { smoothed, count, .. } = set_upright(&surface, &wrong, &[], Quads::All).unwrap();
    assert_eq!(count, 2);
    assert!(smoothed.mesh.faces().all(|face| face.len() == 4));
    let middle = [b as u32, e as u32];
    assert_eq!(smoothed.mesh.faces().filter(|face| middle.iter().all(|v| face.contains(v))).count(), 2);
    let stays = [[c.min(f) as u32, c.max(f) as u32]];
    assert!(set_upright(&surface, &wrong, &stays, Quads::Most).is_none(), "the edge is a feature");
}

#[test]
fn a_ring_about_the_opposite_corner_takes_a_straight_one_away() {
    let surface = plate();
    let [low, high] = [2, 3].map(|j| move |i: usize| at(i, j));
    let straight = [low(2), low(3), low(4), high(2)];
    let others = [[high(2), low(4), high(4), high(3)], [low(4), low(5), high(5), high(4)]];
    let come: Vec<&[usize]> = std::iter::once(&straight[..]).chain(others.iter().map(|face| &face[..])).collect();
    let wrong = held(&surface, (at(3, 3), [3.0, 3.4]), &[[2, 2], [3, 2], [4, 2]], &come);
    // All about it are features, so that nothing can be cut anew.
    let sides = (0..4).map(|k| [straight[k], straight[(k + 1) % 4]].map(|v| v as u32));
    let mut stays: Vec<[u32; 2]> = sides.map(|[v, w]| [v.min(w), v.max(w)]).collect();
    stays.sort_unstable();
    assert!(set_upright(&surface, &wrong, &stays, Quads::Most).is_none(), "two triangles are made of it later");
    let Uprighted { smoothed: Smoothed { mesh, below }, kept, count } =
        set_upright(&surface, &wrong, &stays, Quads::All).unwrap();
    assert_eq!(count, 1);
    let quads = mesh.faces().map(|face| [0, 1, 2, 3].map(|k| mesh.points[face[k] as usize]));
    assert!(quads.map(quad_shape).fold(1.0, f64::min) > 0.1);
    // Five edges meet at the corner, and five faces: each gets a vertex, the new ones of features no place to move.
    assert_eq!(kept.iter().filter(|&&v| v == u32::MAX).count(), 10);
    assert_eq!(mesh.points.len(), wrong.mesh.points.len() + 10);
    assert_eq!(below.iter().filter(|below| below.is_some()).count(), 8);
    assert_eq!(turned_over(&mesh), 0);
}

#[test]
fn a_mesh_without_such_faces_stays() {
    let surface = plate();
    assert!(set_upright(&surface, &grid(&surface, &[]), &[], Quads::Most).is_none());
    assert!(set_upright(&surface, &grid(&surface, &[(at(3, 3), [3.3, 3.2])]), &[], Quads::All).is_none());
}
