//! Each invariant of the mesh: the smallest mesh that breaks it, and it alone.

use quadmosaic::mesh::Mesh;
use quadmosaic::mesh::check::{Kind, check};

fn mesh(points: &[[f64; 3]], faces: &[&[u32]]) -> Mesh {
    let mut mesh = Mesh::new(points.to_vec());
    for face in faces {
        mesh.push_face(face);
    }
    mesh
}

/// Two rows of three vertices, and one above the middle.
const POINTS: [[f64; 3]; 7] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [2.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [1.0, 1.0, 0.0],
    [2.0, 1.0, 0.0],
    [1.0, 0.5, 1.0],
];

fn kinds(mesh: &Mesh) -> Vec<Kind> {
    check(mesh).list.iter().map(|fault| fault.kind).collect()
}

#[test]
fn clean_meshes_have_no_faults() {
    let strip = check(&mesh(&POINTS[..6], &[&[0, 1, 4, 3], &[1, 2, 5, 4]]));
    assert!(strip.is_clean(), "{strip}");
    assert_eq!((strip.euler, strip.boundary_loops, strip.components), (1, 1, 1));

    let tetrahedron = check(&mesh(
        &[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        &[&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[2, 0, 3]],
    ));
    assert!(tetrahedron.is_clean(), "{tetrahedron}");
    assert_eq!((tetrahedron.euler, tetrahedron.boundary_loops, tetrahedron.components), (2, 0, 1));
    assert_eq!(tetrahedron.to_string(), "no faults; Euler characteristic 2, boundary loops 0, components 1");

    let pieces = check(&mesh(&POINTS[..6], &[&[0, 1, 3], &[2, 5, 4]]));
    assert_eq!((pieces.euler, pieces.boundary_loops, pieces.components), (2, 2, 2));

    assert!(check(&Mesh::default()).is_clean());
}

#[test]
fn ring_has_two_boundary_loops() {
    let points: Vec<[f64; 3]> = (0..8)
        .map(|k| {
            let angle = f64::from(k % 4) * std::f64::consts::FRAC_PI_2;
            let radius = if k < 4 { 1.0 } else { 2.0 };
            [radius * angle.cos(), radius * angle.sin(), 0.0]
        })
        .collect();
    let ring = check(&mesh(&points, &[&[0, 4, 5, 1], &[1, 5, 6, 2], &[2, 6, 7, 3], &[3, 7, 4, 0]]));
    assert!(ring.is_clean(), "{ring}");
    assert_eq!((ring.euler, ring.boundary_loops), (0, 2));
}

#[test]
fn non_finite_coordinate() {
    let mut points = POINTS[..3].to_vec();
    points[2] = [0.0, 1.0, 0.0];
    let good = mesh(&points, &[&[0, 1, 2]]);
    assert!(check(&good).is_clean());
    for bad in [f64::NAN, f64::INFINITY] {
        let mut broken = good.clone();
        broken.points[2][1] = bad;
        assert_eq!(kinds(&broken)[0], Kind::NonFinite { vertex: 2 });
    }
}

#[test]
fn isolated_vertex() {
    let faults = check(&mesh(&POINTS[..5], &[&[0, 1, 4, 3]]));
    assert_eq!(faults.list.len(), 1);
    assert_eq!(faults.list[0].kind, Kind::IsolatedVertex { vertex: 2 });
    assert_eq!(faults.list[0].at, POINTS[2]);
    assert_eq!(faults.euler, 1, "a vertex that no face uses does not count");
}

#[test]
fn non_manifold_vertex() {
    let bow = mesh(
        &[[0.0; 3], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0], [-1.0, -1.0, 0.0]],
        &[&[0, 1, 2], &[0, 3, 4]],
    );
    assert_eq!(kinds(&bow), [Kind::NonManifoldVertex { vertex: 0, fans: 2 }]);
    let mut fan = bow.clone();
    fan.push_face(&[0, 2, 3]);
    assert!(check(&fan).is_clean());
}

#[test]
fn non_manifold_edge() {
    let faults = check(&mesh(&POINTS, &[&[1, 4, 0], &[4, 1, 2], &[1, 4, 6], &[2, 5, 4], &[3, 0, 4]]));
    assert_eq!(faults.list.len(), 1, "{faults}");
    assert_eq!(faults.list[0].kind, Kind::NonManifoldEdge { edge: [1, 4], faces: 3 });
    assert_eq!(faults.list[0].at, [1.0, 0.5, 0.0]);
}

#[test]
fn misoriented_edge() {
    let faults = kinds(&mesh(&POINTS[..6], &[&[0, 1, 4, 3], &[1, 4, 5, 2]]));
    assert_eq!(faults, [Kind::MisorientedEdge { edge: [1, 4] }]);
}

#[test]
fn missing_vertex() {
    assert_eq!(kinds(&mesh(&POINTS[..3], &[&[0, 1, 7]])), [Kind::MissingVertex { face: 0, vertex: 7 }]);
}

#[test]
fn repeated_vertex() {
    let faults = kinds(&mesh(&POINTS[..5], &[&[0, 1, 4, 3], &[1, 2, 4, 2, 4]]));
    assert!(faults.contains(&Kind::RepeatedVertex { face: 1, vertex: 2 }), "{faults:?}");
}

#[test]
fn duplicate_face() {
    // A pillow: two faces back to back are a sphere, but they are one face twice.
    let pillow = mesh(&[POINTS[0], POINTS[1], POINTS[3]], &[&[0, 1, 2], &[2, 1, 0]]);
    assert_eq!(kinds(&pillow), [Kind::DuplicateFace { face: 1, earlier: 0 }]);
}

#[test]
fn degenerate_face() {
    let sliver = |height: f64| mesh(&[[0.0; 3], [1.0, 0.0, 0.0], [0.5, height, 0.0]], &[&[0, 1, 2]]);
    let faults = kinds(&sliver(0.0));
    assert_eq!(faults, [Kind::DegenerateFace { face: 0, area: 0.0 }]);
    // Mean edge 2/3, area height / 2: the bound on the area lies at a height of 8/9e-6.
    assert_eq!(kinds(&sliver(0.88e-6)).len(), 1);
    assert!(kinds(&sliver(0.90e-6)).is_empty());
    assert_eq!(kinds(&mesh(&[[1.0; 3]; 3], &[&[0, 1, 2]])).len(), 1, "nor has a mesh without extent a good face");
    let line = kinds(&mesh(&POINTS[..2], &[&[0, 1]]));
    assert!(line.contains(&Kind::DegenerateFace { face: 0, area: 0.0 }), "{line:?}");
}

#[test]
fn concave_quad() {
    let dart = |x: f64| mesh(&[[0.0; 3], [1.0, 0.0, 0.0], [x, x, 0.0], [0.0, 1.0, 0.0]], &[&[0, 1, 2, 3]]);
    assert_eq!(kinds(&dart(0.4)), [Kind::ConcaveQuad { face: 0 }]);
    assert!(kinds(&dart(0.6)).is_empty());
}

#[test]
fn display_names_the_first_few() {
    let text = check(&Mesh::new(vec![[0.0, 0.5, 0.0]; 8])).to_string();
    assert!(text.starts_with("8 faults;"), "{text}");
    assert!(text.contains("vertex 0 lies on no face at (0, 0.5, 0)"), "{text}");
    assert!(text.ends_with("and 3 more"), "{text}");
    // One fault of another kind is not lost among many.
    let mut points = vec![[0.0, 0.5, 0.0]; 8];
    points.extend([[0.0; 3], [1.0, 0.0, 0.0], [0.5, 0.0, 0.0]]);
    let text = check(&mesh(&points, &[&[8, 9, 10]])).to_string();
    assert!(text.contains("and 3 more\n  face 0 is degenerate"), "{text}");
}
