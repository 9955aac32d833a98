//! The last touch: vertices of imperfect faces find the best place about them, on the surface and along its features.

#[path = "common/plate.rs"]
mod plate;

use plate::{SIDE, at, grid, plate};
use quadmosaic::mesh::quality::Quality;
use quadmosaic::mesh::smooth::Smoothed;
use quadmosaic::mesh::touch_up::touch_up;
use quadmosaic::mesh::{Mesh, Metric};
use quadmosaic::surface::Surface;

fn mean(mesh: &Mesh) -> f64 {
    Quality::of(mesh).qg.map_or(0.0, |spread| spread.mean)
}

fn touched(surface: &Surface, mesh: &Smoothed) -> Smoothed {
    touch_up(&Metric::default(), surface, mesh)
}

#[test]
fn a_vertex_inside_finds_the_best_place() {
    let surface = plate();
    let moved = grid(&surface, &[(at(3, 3), [3.4, 3.25])]);
    let better = touched(&surface, &moved);
    let [x, y, z] = surface.frame().to_model(better.mesh.points[at(3, 3)]);
    assert!((x - 3.0).hypot(y - 3.0) < 0.1 && z.abs() < 1e-6, "{x} {y} {z}");
    assert!(mean(&better.mesh) > mean(&moved.mesh) + 0.005);
    assert_eq!(better.below[at(3, 3)].map(|triangle| triangle < 2), Some(true));
    let held = Smoothed { below: vec![None; moved.below.len()], ..moved };
    assert_eq!(touched(&surface, &held).mesh.points[at(3, 3)], held.mesh.points[at(3, 3)], "inside is no feature");
}

#[test]
fn a_vertex_on_a_feature_slides_and_a_corner_stays() {
    let surface = plate();
    let moved = grid(&surface, &[(at(2, 0), [1.4, 0.0])]);
    let better = touched(&surface, &moved);
    let [x, y, _] = surface.frame().to_model(better.mesh.points[at(2, 0)]);
    assert!((x - 2.0).abs() < 0.2 && y.abs() < 1e-6, "{x} {y}");
    let beside_corner = grid(&surface, &[(at(1, 1), [1.3, 1.4])]);
    let corners = [at(0, 0), at(SIDE, 0), at(0, SIDE), at(SIDE, SIDE)];
    let better = touched(&surface, &beside_corner);
    assert!(corners.iter().all(|&v| better.mesh.points[v] == beside_corner.mesh.points[v]));
}

#[test]
fn good_faces_stay() {
    let surface = plate();
    for moved in [vec![], vec![(at(3, 3), [3.1, 3.05])]] {
        let good = grid(&surface, &moved);
        assert_eq!(touched(&surface, &good), good);
    }
}
