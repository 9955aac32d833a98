//! Unfolding: bad faces get better, on the surface and along its features, and all else stays.

use quadmosaic::mesh::quality::{Quality, scaled_jacobian};
use quadmosaic::mesh::smooth::Smoothed;
use quadmosaic::mesh::unfold::{split_concave, unfold};
use quadmosaic::mesh::{Mesh, Metric};
use quadmosaic::surface::{FeatureOptions, Soup, Surface};

/// Squares along a side of the grid.
const SIDE: usize = 6;

/// A square plate of two triangles, the lower right one first.
fn plate() -> Surface {
    let n = SIDE as f64;
    let points = vec![[0.0; 3], [n, 0.0, 0.0], [n, n, 0.0], [0.0, n, 0.0]];
    let soup = Soup { points, triangles: vec![[0, 1, 2], [0, 2, 3]], ..Soup::default() };
    Surface::new(&soup, &FeatureOptions::default()).unwrap()
}

fn at(i: usize, j: usize) -> usize {
    j * (SIDE + 1) + i
}

/// A grid of squares on the plate with some vertices elsewhere.
fn grid(surface: &Surface, moved: &[(usize, [f64; 2])]) -> Smoothed {
    let mut places: Vec<[f64; 2]> = (0..=SIDE).flat_map(|j| (0..=SIDE).map(move |i| [i as f64, j as f64])).collect();
    moved.iter().for_each(|&(v, place)| places[v] = place);
    let mut mesh = Mesh::new(places.iter().map(|&[x, y]| surface.frame().to_unit([x, y, 0.0])).collect());
    for (i, j) in (0..SIDE).flat_map(|j| (0..SIDE).map(move |i| (i, j))) {
        mesh.push_face(&[at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)].map(|v| v as u32));
    }
    let n = SIDE as f64;
    let on_rim = |&[x, y]: &[f64; 2]| x == 0.0 || y == 0.0 || x == n || y == n;
    let below = places.iter().map(|place| (!on_rim(place)).then_some(u32::from(place[1] > place[0]))).collect();
    Smoothed { mesh, below }
}

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
        let unfolded = unfold(&Metric::default(), &surface, &folded);
        assert!(least(&unfolded.mesh) > 0.25, "{place:?}: {}", least(&unfolded.mesh));
        assert!(unfolded.mesh.faces().eq(folded.mesh.faces()));
        // Nothing that may move: nothing moves.
        let stuck = Smoothed { below: vec![None; folded.below.len()], ..folded.clone() };
        assert_eq!(unfold(&Metric::default(), &surface, &stuck).mesh.points[at(3, 3)], folded.mesh.points[at(3, 3)]);
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
    let slid = unfold(&Metric::default(), &surface, &held);
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
    assert_eq!(unfold(&Metric::default(), &surface, &good), good);
    let folded = grid(&surface, &[(at(3, 3), [4.3, 3.0])]);
    assert_eq!(unfold(&Metric::default(), &surface, &folded), unfold(&Metric::default(), &surface, &folded));
    let far = unfold(&Metric::default(), &surface, &folded);
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
        let split = split_concave(mesh);
        assert_eq!(split.face_count(), 2);
        assert!(split.faces().all(|face| face.len() == 3 && face.contains(&(corner as u32))));
        let turn = |face: &[u32]| {
            let [a, b, c] = [0, 1, 2].map(|k| points[face[k] as usize]);
            (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        };
        assert!(split.faces().all(|face| turn(face) > 0.0), "corner {corner}");
    }
    let whole = grid(&plate(), &[]).mesh;
    assert_eq!(split_concave(whole.clone()), whole);
}
