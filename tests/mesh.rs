//! From tiles to faces: the triangulation keeps the surface's topology, and holes are treated as asked.

mod common;

use common::surfaces::{EXAMPLES, example, surface};
use quadmosaic::compute::Cpu;
use quadmosaic::field::{Field, FieldOptions};
use quadmosaic::mesh::check::check;
use quadmosaic::mesh::connect::{ConnectOptions, connect};
use quadmosaic::mesh::fill::{self, Holes};
use quadmosaic::mesh::quality::Quality;
use quadmosaic::mesh::triangulate::triangulate;
use quadmosaic::mesh::{Context, Mesh, Triangulation};
use quadmosaic::mosaic::{Effort, Mosaic, MosaicBuilder};
use quadmosaic::parametrize::Rows;
use quadmosaic::surface::Surface;

const COUNT: usize = 1_000;

fn tiled(name: &str) -> (Surface, Mosaic, Triangulation) {
    let surface = surface(&example(name, 4_000));
    let field = Field::new(&surface, &FieldOptions::default(), &Cpu).expect("the CPU does not fail");
    let builder = MosaicBuilder {
        surface: &surface,
        field: &field,
        backend: &Cpu,
        effort: Effort::default(),
        rows: Rows::Paper,
        first_scale: None,
        is_trial: false,
        progress: &|_| {},
    };
    let mosaic = builder.with_count(COUNT, None).expect("the CPU does not fail");
    let triangulation = triangulate(&surface, &field, &mosaic);
    (surface, mosaic, triangulation)
}

/// The mesh that the edges enclose, unit-sized, and the number of its holes.
fn fill(surface: &Surface, triangulation: &Triangulation, edges: &[bool], holes: Holes) -> (Mesh, usize) {
    let (mesh, count) = fill::fill(&Context::new(surface), triangulation, edges, holes);
    (mesh.to_mesh(), count)
}

/// Constraints that no edge meets; those on features are made all the same.
const NO_EDGE: ConnectOptions = ConnectOptions { max_distance: 0.0, max_angle: 0.0 };

fn sides(mesh: &Mesh) -> [usize; 3] {
    let count = |which: fn(usize) -> bool| mesh.faces().filter(|face| which(face.len())).count();
    [count(|k| k == 3), count(|k| k == 4), count(|k| k > 4)]
}

/// Half-edges of the triangulation, three a face: as many as `connect` answers for.
fn half_edges(triangulation: &Triangulation) -> usize {
    connect(triangulation, &NO_EDGE).len()
}

#[test]
fn the_triangulation_keeps_the_topology() {
    for (name, characteristic, loops) in EXAMPLES {
        let (surface, mosaic, triangulation) = tiled(name);
        let all = vec![true; half_edges(&triangulation)];
        let (mesh, holes) = fill(&surface, &triangulation, &all, Holes::Leave);
        assert_eq!((holes, sides(&mesh)), (0, [all.len() / 3, 0, 0]), "{name}: all edges make triangles");
        let faults = check(&mesh);
        assert_eq!((faults.euler, faults.boundary_loops), (characteristic, loops), "{name}");
        assert_eq!(faults.components, 1, "{name}");
        assert!(
            faults.list.iter().all(|f| !format!("{f}").contains("fans") && !format!("{f}").contains("edge")),
            "{name}: {faults}"
        );
        assert_eq!(mesh.points.len(), mosaic.count() + triangulation.extra, "{name}");
        assert_eq!(triangulation.feature_samples, mosaic.feature_samples.len(), "{name}");
        assert_eq!(triangulation.extra, 0, "{name}: a handle of these surfaces is wider than a tile");
        // The sphere's area is kept nearly; of what is lost, chords of a tile side take h^2 / 8 R^2.
        if name == "sphere" {
            let area: f64 = mesh
                .faces()
                .map(|f| {
                    let [a, b, c] = [0, 1, 2].map(|i| glam::DVec3::from(mesh.points[f[i] as usize]));
                    (b - a).cross(c - a).length() / 2.0
                })
                .sum();
            assert!((area / surface.area() - 1.0).abs() < 0.02, "{}", area / surface.area());
        }
        // An inner face less is seen.
        let inner = |face: &[u32]| face.iter().all(|&v| v as usize >= triangulation.feature_samples);
        let taken = mesh.faces().position(inner).expect("a face off the features");
        let mut torn = Mesh::new(mesh.points.clone());
        mesh.faces().enumerate().filter(|(f, _)| *f != taken).for_each(|(_, face)| torn.push_face(face));
        assert_ne!((check(&torn).euler, check(&torn).boundary_loops), (characteristic, loops), "{name}");
    }
}

#[test]
fn holes_are_treated_as_asked() {
    for (name, characteristic, loops) in EXAMPLES {
        let (surface, _, triangulation) = tiled(name);
        // With a small angle fewer tiles are connected than with the default.
        let strict = ConnectOptions { max_angle: 12.0, ..ConnectOptions::default() };
        let [edges, strict] = [ConnectOptions::default(), strict].map(|options| connect(&triangulation, &options));
        let (left, few) = fill(&surface, &triangulation, &edges, Holes::Leave);
        let (left_strict, many) = fill(&surface, &triangulation, &strict, Holes::Leave);
        let [loose_quads, strict_quads] = [&left, &left_strict].map(|mesh| sides(mesh)[1]);
        assert!(strict_quads < loose_quads, "{name}: {strict_quads} quads with a small angle, {loose_quads} else");
        for (edges, holes, open) in [(&edges, few, &left), (&strict, many, &left_strict)] {
            for way in [Holes::Patterns, Holes::Triangles, Holes::Leave] {
                let (mesh, found) = fill(&surface, &triangulation, edges, way);
                assert_eq!(found, holes, "{name}, {way:?}: the same holes, whatever is done with them");
                let [triangles, quads, polygons] = sides(&mesh);
                assert_eq!(polygons > 0, way == Holes::Leave, "{name}, {way:?}: {polygons}");
                // No vertex comes or goes, so a face of k sides stands for k - 2 triangles, whatever is done.
                let covered: usize = mesh.faces().map(|face| face.len() - 2).sum();
                assert_eq!(covered, edges.len() / 3, "{name}, {way:?}: faces cover the triangulation");
                let faults = check(&mesh);
                assert_eq!((faults.euler, faults.boundary_loops), (characteristic, loops), "{name}, {way:?}");
                let [open_triangles, open_quads, _] = sides(open);
                match way {
                    // A folded face of four sides is split too.
                    Holes::Triangles => assert!(quads <= open_quads, "{name}: holes give triangles only"),
                    Holes::Patterns => assert!(quads > open_quads && triangles >= open_triangles, "{name}"),
                    Holes::Leave => {}
                }
            }
        }
    }
}

#[test]
fn more_edges_are_made_the_laxer_the_constraints() {
    let (_, _, triangulation) = tiled("torus");
    let made = |max_distance: f64, max_angle: f64| {
        connect(&triangulation, &ConnectOptions { max_distance, max_angle }).iter().filter(|&&e| e).count()
    };
    assert_eq!(made(0.0, 0.0), 0);
    assert_eq!(made(1.6, 0.0), 0);
    assert_eq!(made(0.5, 30.0), 0, "no two tiles are that near");
    let by_angle = [2.0, 10.0, 30.0, 44.0].map(|angle| made(1.6, angle));
    assert!(by_angle.windows(2).all(|w| w[0] < w[1]), "{by_angle:?}");
    // Two half-edges each, and four edges at a tile of a perfect mosaic.
    assert!(made(1.6, 30.0) <= 4 * COUNT * 102 / 100 && made(1.6, 30.0) > 4 * COUNT * 9 / 10, "{by_angle:?}");
}

#[test]
fn what_is_connected_is_mostly_quads() {
    let (surface, _, triangulation) = tiled("sphere");
    let filled = |options: &ConnectOptions| {
        Quality::of(&fill(&surface, &triangulation, &connect(&triangulation, options), Holes::Triangles).0).qr
    };
    // The paper's share before clean-up is about 0.80.
    assert!(filled(&ConnectOptions::default()) > 0.8, "{}", filled(&ConnectOptions::default()));
    assert!(filled(&NO_EDGE) < 0.1, "without edges everything is one hole of triangles");
}
