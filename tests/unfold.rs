//! Unfolding: bad faces get better, on the surface and along its features, and all else stays.

#[path = "common/plate.rs"]
mod plate;

use plate::{SIDE, at, grid, plate};
use quadmosaic::mesh::facing::Facing;
use quadmosaic::mesh::quality::{Quality, scaled_jacobian};
use quadmosaic::mesh::smooth::Smoothed;
use quadmosaic::mesh::unfold::{split_folded, unfold};
use quadmosaic::mesh::{Mesh, Metric};

/// The least scaled Jacobian against the plate's normal.
fn least(mesh: &Mesh) -> f64 {
    let up = |q: [[f64; 3]; 4]| {
        let [ac, bd] = [[0, 2], [1, 3]].map(|[i, j]| [q[j][0] - q[i][0], q[j][1] - q[i][1]]);
        (ac[0] * bd[1] - ac[1] * bd[0]).signum()
    };
    let quads = mesh.faces().map(|face| [0, 1, 2, 3].map(|k| mesh.points[face[k] as usize]));
    quads.map(|q| scaled_jacobian(q) * up(q)).fold(f64::INFINITY, f64::min)
}

#[test]
fn a_folded_vertex_finds_back() {
    let surface = plate();
    for place in [[4.3, 3.0], [4.2, 4.1], [2.9, 1.8]] {
        let folded = grid(&surface, &[(at(3, 3), place)]);
        assert!(least(&folded.mesh) < 0.0, "it is folded");
        let unfolded = unfold(&Metric::default(), &Facing::new(&surface), &folded);
        assert!(least(&unfolded.mesh) > 0.25, "{place:?}: {}", least(&unfolded.mesh));
        assert!(unfolded.mesh.faces().eq(folded.mesh.faces()));
        // Nothing that may move: nothing moves.
        let stuck = Smoothed { below: vec![None; folded.below.len()], ..folded.clone() };
        assert_eq!(
            unfold(&Metric::default(), &Facing::new(&surface), &stuck).mesh.points[at(3, 3)],
            folded.mesh.points[at(3, 3)]
        );
    }
}

#[test]
fn a_vertex_on_a_feature_slides_along_it() {
    let surface = plate();
    let near = [1.05, 0.0];
    let bad = grid(&surface, &[(at(2, 0), near)]);
    // All inside is held, so that sliding alone helps.
    let mut held = bad.clone();
    held.below = held.below.iter().map(|_| None).collect();
    let slid = unfold(&Metric::default(), &Facing::new(&surface), &held);
    let place = surface.frame().to_model(slid.mesh.points[at(2, 0)]);
    assert!(place[0] > near[0] + 0.2 && place[0] < 3.0, "{place:?}");
    assert!(place[1].abs() < 1e-6, "it stays on the rim: {place:?}");
    assert_eq!(slid.mesh.points[at(2, 1)], held.mesh.points[at(2, 1)], "inside is no feature to slide along");
    // A corner has no way to go.
    let corners = [at(0, 0), at(SIDE, 0), at(0, SIDE), at(SIDE, SIDE)];
    assert!(corners.iter().all(|&v| slid.mesh.points[v] == held.mesh.points[v]));
    let worst = |mesh: &Mesh| Quality::of(mesh).qg.map_or(0.0, |spread| spread.min);
    assert!(worst(&slid.mesh) > worst(&held.mesh));
}

#[test]
fn good_faces_stay_and_twice_is_the_same() {
    let surface = plate();
    let good = grid(&surface, &[(at(3, 3), [3.2, 3.1])]);
    assert_eq!(unfold(&Metric::default(), &Facing::new(&surface), &good), good);
    let folded = grid(&surface, &[(at(3, 3), [4.3, 3.0])]);
    assert_eq!(
        unfold(&Metric::default(), &Facing::new(&surface), &folded),
        unfold(&Metric::default(), &Facing::new(&surface), &folded)
    );
    let far = unfold(&Metric::default(), &Facing::new(&surface), &folded);
    assert_eq!(far.mesh.points[at(0, 0)], folded.mesh.points[at(0, 0)]);
    assert_ne!(far, folded);
}

#[test]
fn a_concave_quad_becomes_two_triangles_from_its_reflex_corner() {
    // Each corner in turn is pushed over the diagonal of its neighbours.
    let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    for corner in 0..4 {
        let mut points = square.map(|[x, y]| [x, y, 0.0]);
        let [x, y] = square[(corner + 2) % 4];
        points[corner] = [0.5 + 0.2 * (x - 0.5), 0.5 + 0.2 * (y - 0.5), 0.0];
        let mut mesh = Mesh::new(points.to_vec());
        mesh.push_face(&[0, 1, 2, 3]);
        let split = split_folded(mesh);
        assert_eq!(split.face_count(), 2);
        assert!(split.faces().all(|face| face.len() == 3 && face.contains(&(corner as u32))));
        let turn = |face: &[u32]| {
            let [a, b, c] = [0, 1, 2].map(|k| points[face[k] as usize]);
            (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        };
        assert!(split.faces().all(|face| turn(face) > 0.0), "corner {corner}");
    }
    // Nearly straight at a corner: the halves are better; a lean rhombus: they are not.
    let quad = |points: [[f64; 2]; 4]| {
        let mut mesh = Mesh::new(points.map(|[x, y]| [x, y, 0.0]).to_vec());
        mesh.push_face(&[0, 1, 2, 3]);
        mesh
    };
    assert_eq!(split_folded(quad([[0.0, 0.0], [1.0, -0.05], [2.0, 0.0], [1.0, 1.5]])).face_count(), 2);
    let lean = quad([[0.0, 0.0], [1.0, 0.0], [1.98, 0.15], [0.98, 0.15]]);
    assert_eq!(split_folded(lean.clone()), lean);
    // Where the cut is an edge of another face already, it would have four faces.
    let mut points = square.map(|[x, y]| [x, y, 0.0]).to_vec();
    points[0] = [0.6, 0.6, 0.0];
    points.push([0.5, 0.5, 1.0]);
    let mut tent = Mesh::new(points);
    tent.push_face(&[0, 1, 2, 3]);
    tent.push_face(&[2, 0, 4]);
    assert_eq!(split_folded(tent.clone()), tent);
    let whole = grid(&plate(), &[]).mesh;
    assert_eq!(split_folded(whole.clone()), whole);
}
