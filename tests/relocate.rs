//! Relocation: vertices find the best place about them, on the surface and along its features; faces stay.

mod common;
#[path = "common/plate.rs"]
mod plate;

use common::surfaces::{EXAMPLES, example, scattered, surface};
use glam::DVec3;
use plate::{Grid, SIDE, at};
use quadmosaic::compute::Cpu;
use quadmosaic::field::{Field, FieldOptions};
use quadmosaic::mesh::connect::{ConnectOptions, connect};
use quadmosaic::mesh::fill::{Holes, fill};
use quadmosaic::mesh::quality::{quad_shape, scaled_jacobian, triangle_shape};
use quadmosaic::mesh::relocate::relocate;
use quadmosaic::mesh::triangulate::triangulate;
use quadmosaic::mesh::{Context, Mesh, Place, SurfaceMesh};
use quadmosaic::mosaic::{Effort, MosaicBuilder};
use quadmosaic::parametrize::Rows;
use quadmosaic::surface::{FeatureOptions, Soup, Surface};

/// A least shape below this does not fall.
const POOR: f64 = 0.3;
/// Passes, as many as the pipeline takes.
const PASSES: usize = 6;

fn relocated_on(surface: &Surface, mesh: &Mesh, passes: usize) -> Mesh {
    let context = Context::new(surface);
    let mut mesh = SurfaceMesh::of(&context, mesh);
    relocate(&context, &mut mesh, passes);
    mesh.in_model_units(&context)
}

/// The grid's mesh relocated.
fn relocated(grid: &Grid) -> Mesh {
    let after = relocated_on(&grid.surface(), &grid.mesh(), PASSES);
    assert!(after.faces().eq(grid.mesh().faces()), "faces stay");
    after
}

/// How far a vertex lies from a place.
fn off(mesh: &Mesh, v: u32, [x, y]: [f64; 2]) -> f64 {
    DVec3::from(mesh.points[v as usize]).distance(DVec3::new(x, y, 0.0))
}

/// Where a vertex lies in the grid of squares.
fn home(v: u32) -> [f64; 2] {
    Grid::new().points[v as usize]
}

/// The least scaled Jacobian against the plate's normal.
fn least_jacobian(mesh: &Mesh) -> f64 {
    let up = |q: [[f64; 3]; 4]| {
        let [ac, bd] = [[0, 2], [1, 3]].map(|[i, j]| [q[j][0] - q[i][0], q[j][1] - q[i][1]]);
        (ac[0] * bd[1] - ac[1] * bd[0]).signum()
    };
    let quads = mesh.faces().map(|face| [0, 1, 2, 3].map(|k| mesh.points[face[k] as usize]));
    quads.map(|q| scaled_jacobian(q) * up(q)).fold(f64::INFINITY, f64::min)
}

#[test]
fn a_folded_vertex_finds_back() {
    let v = at(3, 3);
    for place in [[4.3, 3.0], [4.2, 4.1], [2.9, 1.8]] {
        let folded = Grid::new().moved(v, place);
        assert!(least_jacobian(&folded.mesh()) < 0.0, "it is folded");
        let unfolded = relocated(&folded);
        assert!(least_jacobian(&unfolded) > 0.95, "{place:?}: {}", least_jacobian(&unfolded));
        assert!(off(&unfolded, v, home(v)) < 0.2 && off(&folded.mesh(), v, home(v)) > 1.0);
    }
}

#[test]
fn a_vertex_inside_finds_the_best_place_and_a_corner_stays() {
    let v = at(3, 3);
    let mut grid = Grid::new();
    grid.points[v as usize] = [3.4, 3.25];
    let better = relocated(&grid);
    assert!(off(&better, v, home(v)) < 0.05, "{:?}", better.points[v as usize]);
    assert!(better.points[v as usize][2].abs() < 1e-6, "it stays on the plate");
    // Four features that meet there make it a corner.
    let star = [[v, v + 1], [v - 1, v], [v, at(3, 4)], [at(3, 2), v]];
    assert!(off(&relocated(&grid.with_features(&star)), v, [3.4, 3.25]) < 1e-9);
}

#[test]
fn a_vertex_on_a_feature_slides_along_it() {
    let v = at(2, 0);
    for x in [1.05, 1.4, 2.9] {
        let after = relocated(&Grid::new().moved(v, [x, 0.0]));
        assert!(off(&after, v, home(v)) < 0.06, "{:?}", after.points[v as usize]);
        assert!(after.points[v as usize][1].abs() < 1e-5, "it stays on the rim");
        let corners = [at(0, 0), at(SIDE, 0), at(0, SIDE), at(SIDE, SIDE)];
        assert!(corners.iter().all(|&corner| off(&after, corner, home(corner)) < 1e-9));
    }
    // From beside the crease a vertex comes near it, but only one on it stays on it.
    let v = at(2, 5);
    let crease: Vec<[u32; 2]> = (0..SIDE).map(|i| [at(i, 5), at(i + 1, 5)]).collect();
    let [on, beside] = [[2.6, 5.0], [2.6, 5.3]].map(|place| {
        let after = relocated(&Grid::new().with_features(&crease).moved(v, place));
        assert!(off(&after, v, home(v)) < 0.06, "{:?}", after.points[v as usize]);
        (after.points[v as usize][1] - 5.0).abs()
    });
    assert!(on < 1e-5 && beside > 1e-3, "{on} {beside}");
}

#[test]
fn good_faces_stay_and_the_same_comes_twice() {
    let good = Grid::new();
    let roundings = relocated_on(&good.surface(), &good.mesh(), 0);
    assert_eq!(relocated(&good), roundings);
    let other = Grid::new().moved(at(3, 3), [3.4, 3.2]);
    assert_eq!(relocated(&other), relocated(&other));
    assert_ne!(relocated(&other), relocated_on(&other.surface(), &other.mesh(), 0), "no passes, no moves");
}

#[test]
fn the_result_does_not_depend_on_the_number_of_threads() {
    let mut random = scattered(5);
    let mut grid = Grid::new();
    for v in 0..grid.points.len() as u32 {
        let [x, y] = home(v);
        let [dx, dy] = [x, y].map(|x| if x % f64::from(SIDE) == 0.0 { 0.0 } else { 0.6 * (random() - 0.5) });
        grid = grid.moved(v, [x + dx, y + dy]);
    }
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| relocated(&grid))
    };
    assert_eq!(with(1), with(4));
    assert!(least_jacobian(&with(1)) > least_jacobian(&grid.mesh()));
}

/// The height of the upper side of a plate with a hump.
fn height(hump: f64, x: f64) -> f64 {
    1.3 + hump * (-(x - 2.0).powi(2) / 0.5).exp()
}

/// A plate of width 4 with a hump: a strip of triangles.
fn humped(hump: f64) -> Surface {
    let xs = (0..=80).map(|k| f64::from(k) / 20.0);
    let points = xs.flat_map(|x| [[x, 0.0, 0.0], [x, height(hump, x), 0.0]]).collect();
    let triangles = (0..80).flat_map(|k| [[2 * k, 2 * k + 2, 2 * k + 3], [2 * k, 2 * k + 3, 2 * k + 1]]).collect();
    Surface::new(&Soup { points, triangles, ..Soup::default() }, &FeatureOptions::default()).unwrap()
}

/// One row of three quads.
fn row(hump: f64) -> Mesh {
    let xs = [0.0, 1.3, 2.7, 4.0];
    let upper = xs.map(|x| [x, height(hump, x), 0.0]);
    let mut mesh = Mesh::new(xs.map(|x| [x, 0.0, 0.0]).into_iter().chain(upper).collect());
    (0..3).for_each(|k| mesh.push_face(&[k, k + 1, k + 5, k + 4]));
    mesh
}

/// The farthest distance of the upper side of a plate with a hump from the upper edges of its row.
fn farthest(hump: f64, row: &Mesh) -> f64 {
    let chords: Vec<[DVec3; 2]> = (4..7).map(|k| [k, k + 1].map(|v| DVec3::from(row.points[v]))).collect();
    let off = |x: f64| {
        let point = DVec3::new(x, height(hump, x), 0.0);
        let to = |[a, b]: &[DVec3; 2]| {
            let share = ((point - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
            a.lerp(*b, share).distance(point)
        };
        chords.iter().map(to).fold(f64::INFINITY, f64::min)
    };
    (0..=80).map(|k| off(f64::from(k) / 20.0)).fold(0.0, f64::max)
}

#[test]
fn a_chord_that_leaves_its_curve_is_brought_nearer() {
    for hump in [0.8, 1.0, 1.2] {
        let (surface, before) = (humped(hump), row(hump));
        let after = relocated_on(&surface, &before, PASSES);
        let [was, is] = [&before, &after].map(|row| farthest(hump, row));
        assert!(is < 0.7 * was, "{hump}: {is} after {was}");
        let on_side = |v: usize| (after.points[v][1] - height(hump, after.points[v][0])).abs() < 5e-3;
        assert!((4..8).all(on_side), "on the feature");
        assert!([0, 3, 4, 7].iter().all(|&v| off(
            &after,
            v,
            [before.points[v as usize][0], before.points[v as usize][1]]
        ) < 1e-6));
    }
    // A chord that is near enough stays.
    let after = relocated_on(&humped(0.4), &row(0.4), PASSES);
    assert!((farthest(0.4, &after) - farthest(0.4, &row(0.4))).abs() < 1e-6);
}

/// The shapes of all faces.
fn shapes(mesh: &Mesh) -> Vec<f64> {
    mesh.faces()
        .map(|face| match *face {
            [a, b, c] => triangle_shape([a, b, c].map(|v| mesh.points[v as usize])),
            [a, b, c, d] => quad_shape([a, b, c, d].map(|v| mesh.points[v as usize])),
            _ => panic!("holes are filled"),
        })
        .collect()
}

#[test]
fn meshes_of_tiles_get_better_and_features_keep_their_vertices() {
    for (name, ..) in EXAMPLES {
        let surface = surface(&example(name, 4_000));
        let field = Field::new(&surface, &FieldOptions::default(), &Cpu).expect("the CPU does not fail");
        let (effort, rows) = (Effort::default(), Rows::Paper);
        let builder = MosaicBuilder {
            surface: &surface,
            field: &field,
            backend: &Cpu,
            effort,
            rows,
            first_scale: None,
            is_trial: false,
            progress: &|_| {},
        };
        let mosaic = builder.with_count(1_000, None).expect("the CPU does not fail");
        let triangulation = triangulate(&surface, &field, &mosaic);
        let edges = connect(&triangulation, &ConnectOptions::default());
        let context = Context::new(&surface);
        let (mut laid, _) = fill(&context, &triangulation, &edges, Holes::Patterns);
        let before = laid.clone();
        relocate(&context, &mut laid, 0);
        assert_eq!(laid.to_mesh(), before.to_mesh(), "{name}: no passes, no moves");
        relocate(&context, &mut laid, PASSES);
        let [was, is] = [&before, &laid].map(|mesh| shapes(&mesh.to_mesh()));
        let mean = |shapes: &[f64]| shapes.iter().sum::<f64>() / shapes.len() as f64;
        let least = |shapes: &[f64]| shapes.iter().copied().fold(POOR, f64::min);
        assert!(mean(&is) > mean(&was), "{name}: {} after {}", mean(&is), mean(&was));
        assert!(least(&is) >= least(&was), "{name}: {} after {}", least(&is), least(&was));
        assert!(laid.faces().eq(before.faces()), "{name}: faces stay");
        assert!(laid.faults(&context).len() <= before.faults(&context).len(), "{name}");
        let mut moved = 0;
        for (old, new) in before.vertices().iter().zip(laid.vertices()) {
            match (old.place, new.place) {
                (Place::Free, Place::Free) => {}
                (Place::Corner, Place::Corner) => assert_eq!(old.coordinates(), new.coordinates(), "{name}"),
                (Place::OnCurve { curve: a, .. }, Place::OnCurve { curve: b, .. }) => {
                    assert_eq!(a, b, "{name}");
                    assert!(off_curve(&surface, b, new.coordinates().into()) < 1e-6, "{name}");
                    moved += usize::from(old.coordinates() != new.coordinates());
                }
                places => panic!("{name}: {places:?}"),
            }
        }
        let on_curves = before.vertices().iter().filter(|v| matches!(v.place, Place::OnCurve { .. })).count();
        assert_eq!(moved > 0, on_curves > 0, "{name}: {moved} of {on_curves} have slid");
    }
}

/// How far a point lies from a feature curve.
fn off_curve(surface: &Surface, curve: u32, point: DVec3) -> f64 {
    let place = |v: u32| DVec3::from(surface.point(v));
    let segment = |ends: &[u32]| {
        let [a, b] = [ends[0], ends[1]].map(place);
        let share = ((point - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
        a.lerp(b, share).distance(point)
    };
    surface.features().curves()[curve as usize].vertices.windows(2).map(segment).fold(f64::INFINITY, f64::min)
}
