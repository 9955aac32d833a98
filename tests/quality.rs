//! The measures against closed forms.

use quadmosaic::mesh::Mesh;
use quadmosaic::mesh::quality::{Quality, Range, corner_angles, quad_shape, scaled_jacobian, triangle_shape, warp};
use std::f64::consts::{FRAC_PI_2, SQRT_2};

/// A few roundings of numbers near 1.
const CLOSE: f64 = 1e-14;

fn quad(corners: [[f64; 2]; 4]) -> [[f64; 3]; 4] {
    corners.map(|[x, y]| [x, y, 0.0])
}

fn rectangle(a: f64, b: f64) -> [[f64; 3]; 4] {
    quad([[0.0, 0.0], [a, 0.0], [a, b], [0.0, b]])
}

fn rhombus(t: f64) -> [[f64; 3]; 4] {
    quad([[0.0, 0.0], [1.0, 0.0], [1.0 + t.cos(), t.sin()], [t.cos(), t.sin()]])
}

#[test]
fn square_scores_one_at_any_size_and_place() {
    for size in [1e-6, 1.0, 1e6] {
        assert!((quad_shape(rectangle(size, size)) - 1.0).abs() < CLOSE);
        assert!((scaled_jacobian(rectangle(size, size)) - 1.0).abs() < CLOSE);
    }
    let tilted = [[5.0, 1.0, 1.0], [6.0, 1.0, 2.0], [6.0, 1.0 + SQRT_2, 2.0], [5.0, 1.0 + SQRT_2, 1.0]];
    assert!((quad_shape(tilted) - 1.0).abs() < CLOSE);
    assert!(quad_shape(rectangle(1.0, 1.01)) < 1.0 - CLOSE);
}

#[test]
fn rectangle_scores_two_ab_over_a2_plus_b2() {
    for (a, b) in [(1.0, 1.0), (1.0, 2.0), (3.0, 0.5)] {
        let expected = 2.0 * a * b / (a * a + b * b);
        assert!((quad_shape(rectangle(a, b)) - expected).abs() < CLOSE);
        assert!((quad_shape(rectangle(a, 1.5 * b)) - expected).abs() > 0.01, "another rectangle must differ");
        assert!((scaled_jacobian(rectangle(a, b)) - 1.0).abs() < CLOSE, "every corner is right");
    }
}

#[test]
fn rhombus_scores_sqrt2_sin_of_half_its_acute_angle() {
    for degrees in [10.0_f64, 45.0, 60.0, 90.0] {
        let t = degrees.to_radians();
        assert!((quad_shape(rhombus(t)) - SQRT_2 * (t / 2.0).sin()).abs() < CLOSE);
        assert!((scaled_jacobian(rhombus(t)) - t.sin()).abs() < CLOSE);
    }
    // Beyond a right angle the other diagonal is the longer one, and the closed form is of the other angle.
    let t = 120.0_f64.to_radians();
    assert!((quad_shape(rhombus(t)) - SQRT_2 * (t / 2.0).sin()).abs() > 0.1);
    assert!((quad_shape(rhombus(t)) - SQRT_2 * (FRAC_PI_2 - t / 2.0).sin()).abs() < CLOSE);
}

#[test]
fn reflex_and_folded_quads_score_nothing() {
    let dart = |x: f64| quad([[0.0, 0.0], [1.0, 0.0], [x, x], [0.0, 1.0]]);
    assert_eq!(quad_shape(dart(0.4)), 0.0);
    assert!(scaled_jacobian(dart(0.4)) < 0.0);
    assert!(quad_shape(dart(0.6)) > 0.0, "the same quad with the corner pushed out is convex");
    assert!(scaled_jacobian(dart(0.6)) > 0.0);
    let bow = quad([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]]);
    assert_eq!(quad_shape(bow), 0.0);
    assert_eq!(quad_shape([[1.0; 3]; 4]), 0.0);
}

#[test]
fn equilateral_triangle_scores_one() {
    let triangle = |height: f64| triangle_shape([[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.5, height, 1.0]]);
    assert!((triangle(3.0_f64.sqrt() / 2.0) - 1.0).abs() < CLOSE);
    assert!(triangle(1.0) < 0.99);
    assert_eq!(triangle(0.0), 0.0);
    assert_eq!(triangle_shape([[2.0; 3]; 3]), 0.0);
}

#[test]
fn angles_and_warp_have_closed_forms() {
    let angles = |corners: &[[f64; 3]]| corner_angles(corners).collect::<Vec<f64>>();
    let is = |found: Vec<f64>, wanted: &[f64]| {
        let close = found.iter().zip(wanted).all(|(found, wanted)| (found - wanted).abs() < 1e-9);
        assert!(found.len() == wanted.len() && close, "{found:?}, not {wanted:?}");
    };
    is(angles(&rectangle(2.0, 1.0)), &[90.0; 4]);
    is(angles(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]), &[90.0, 45.0, 45.0]);
    // An arrow: its third corner is reflex.
    is(
        angles(&[[0.0; 3], [3.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 3.0, 0.0]]),
        &[90.0, 26.56505117707799, 216.86989764584402, 26.56505117707799],
    );
    // A square folded over a diagonal by a right angle, and by none.
    for angle in [0.0, 30.0, 90.0] {
        let (sin, cos) = f64::to_radians(angle).sin_cos();
        let folded = [[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, cos, sin]];
        assert!((warp(folded) - angle).abs() < 1e-9, "{}", warp(folded));
        let mut turned = folded;
        turned.rotate_left(1);
        assert!((warp(turned) - angle).abs() < 1e-9, "whichever corner is the first");
    }
    let mesh = grid(3);
    let quality = Quality::of(&mesh);
    let one = Some(Range { min: 1.0, mean: 1.0, max: 1.0 });
    assert_eq!(quality.edge, one);
    let mut stretched = mesh;
    stretched.points.iter_mut().for_each(|point| point[1] *= 2.0);
    assert_eq!(Quality::of(&stretched).edge, Some(Range { min: 1.0, mean: 1.5, max: 2.0 }));
    assert_eq!((quality.angle.map(|of| of.max), quality.warp.map(|of| of.max)), (Some(90.0), Some(0.0)));
}

/// `n` by `n` unit squares.
fn grid(n: u32) -> Mesh {
    let side = n + 1;
    let mut mesh = Mesh::new((0..side * side).map(|v| [(v % side) as f64, (v / side) as f64, 0.0]).collect());
    for cell in 0..n * n {
        let v = cell / n * side + cell % n;
        mesh.push_face(&[v, v + 1, v + 1 + side, v + side]);
    }
    mesh
}

#[test]
fn grid_is_regular() {
    let quality = Quality::of(&grid(3));
    assert_eq!((quality.vertices, quality.quads, quality.triangles, quality.polygons), (16, 9, 0, 0));
    assert_eq!((quality.interior_vertices, quality.irregular_vertices), (4, 0));
    assert_eq!((quality.qr, quality.mean_edge, quality.edge_cv), (1.0, 1.0, 0.0));
    assert!(quality.tg.is_none(), "no triangle, no Tg");
    assert!((quality.qg.unwrap().min - 1.0).abs() < CLOSE);

    let mut mesh = Mesh::new(grid(3).points);
    for face in grid(3).faces().skip(1) {
        mesh.push_face(face);
    }
    // The first quad goes: one interior vertex is on the boundary now.
    assert_eq!(Quality::of(&mesh).interior_vertices, 3);
    mesh.push_face(&[0, 1, 5]);
    mesh.push_face(&[0, 5, 4]);
    let split = Quality::of(&mesh);
    assert_eq!((split.interior_vertices, split.irregular_vertices), (4, 1));
    assert_eq!(split.irregular(), 0.25);
    assert_eq!(split.qr, 0.8);
    assert!(split.edge_cv > 0.0);
}

#[test]
fn polygons_and_holes_count_as_triangles() {
    let mut mesh = Mesh::new(grid(2).points);
    mesh.push_face(&[0, 1, 4, 3]);
    mesh.push_face(&[1, 2, 5, 8, 7, 4]);
    let quality = Quality::of(&mesh);
    assert_eq!((quality.quads, quality.triangles, quality.polygons), (1, 0, 1));
    assert_eq!(quality.qr, 0.2, "a hexagon is four triangles");
    assert_eq!(Quality::with_holes(&mesh, 5).qr, 0.1);
}

#[test]
fn percentile_lies_between_the_two_lowest() {
    // 101 quads: the first percentile is the second lowest value.
    let mut mesh = Mesh::default();
    for k in 0..101 {
        let first = mesh.points.len() as u32;
        let width = if k == 0 {
            4.0
        } else if k == 1 {
            2.0
        } else {
            1.0
        };
        mesh.points.extend(rectangle(width, 1.0));
        mesh.push_face(&[first, first + 1, first + 2, first + 3]);
    }
    let spread = Quality::of(&mesh).qg.unwrap();
    assert!((spread.min - 8.0 / 17.0).abs() < CLOSE);
    assert!((spread.p01 - 0.8).abs() < CLOSE);
    // 99 roundings more than a single value has.
    assert!((spread.mean - (8.0 / 17.0 + 0.8 + 99.0) / 101.0).abs() < 100.0 * CLOSE);
}

#[test]
fn nothing_is_measured_on_an_empty_mesh() {
    let quality = Quality::of(&Mesh::default());
    assert_eq!((quality.qr, quality.mean_edge, quality.edge_cv), (0.0, 0.0, 0.0));
    assert!(quality.qg.is_none());
}
