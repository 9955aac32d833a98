//! Rows that pass over the whole surface, and sizes that fit them.

mod common;

use common::surfaces::{example, flat};
use quadmosaic::compute::{Backend, Cpu};
use quadmosaic::gpu::GpuBackend;
use quadmosaic::mesh::check::check;
use quadmosaic::mesh::connectivity::{ConnectivityOptions, Quads};
use quadmosaic::mesh::quality::Quality;
use quadmosaic::parametrize::Rows;
use quadmosaic::parametrize::integrable_sizes::integrable_sizes;
use quadmosaic::pipeline::{Fineness, Layout, Options, Outcome, field, prepare, run, unwatched};
use quadmosaic::report::Report;
use quadmosaic::surface::{Ends, NamedEdge};

const POINTS: usize = 1_500;

fn options(rows: Rows, fit: f64) -> Options {
    Options { rows, fit, ..Options::new(Fineness::Points(POINTS)) }
}

fn meshed(name: &str, rows: Rows, fit: f64, backend: &dyn Backend) -> Outcome {
    run(&example(name, 6_000), &options(rows, fit), backend, &unwatched).unwrap_or_else(|error| panic!("{error}"))
}

/// Faces that are no quads, before any clean-up, as a share of all.
fn odd(outcome: &Outcome) -> f64 {
    1.0 - Quality::of(&outcome.meshed.before).qr
}

#[test]
fn continuous_rows_leave_no_end_and_hardly_an_odd_face() {
    for (name, characteristic, loops) in [("torus", 0, 0), ("sphere", 2, 0), ("block", 0, 0), ("m6", 1, 1)] {
        let woven = meshed(name, Rows::Continuous, 1.0, &Cpu);
        let ends = woven.mosaic.row_ends.expect("rows were led on");
        assert_eq!(ends.after, 0, "{name}: {ends:?}");
        let faults = check(&woven.meshed.mesh);
        assert!(faults.is_clean(), "{name}: {faults}");
        assert_eq!((faults.euler, faults.boundary_loops), (characteristic, loops), "{name}");
        // Where the coordinates fold, beside cones and corners, holes are left: a dozen odd faces are 1 % of these meshes.
        assert!(odd(&woven) < 0.015, "{name}: {}", odd(&woven));
        let miss = Quality::of(&woven.meshed.mesh).vertices as f64 / POINTS as f64 - 1.0;
        // Rows come whole: one more round the block's hole is 3 % of its tiles.
        assert!(miss.abs() < 0.04, "{name}: {miss}");
    }
    // Equal tiles on a torus need row ends: its outer side is longer than its inner one.
    let torus = meshed("torus", Rows::Paper, 0.0, &Cpu);
    assert!(odd(&torus) > 0.01, "{}", odd(&torus));
    let ends = torus.mosaic.row_ends.expect("rows near each other were led on");
    assert!(0 < ends.after && ends.after < ends.before, "{ends:?}");
}

#[test]
fn quads_alone_have_hardly_more_irregular_vertices_than_bolt_holes_demand_and_rows_end_where_they_are_too_near() {
    let flange = example("flange", 6_000);
    let quads = |points, layout| {
        let options = Options::new(Fineness::Points(points)).with_layout(layout);
        run(&flange, &options, &Cpu, &unwatched).unwrap_or_else(|error| panic!("{error}"))
    };
    // Each rim of the 12 holes has an index of -1, which is four vertices of valence 5, or fewer of a higher one.
    let demanded = 2 * 12 * 4;
    let irregular = |outcome: &Outcome| {
        let quality = Quality::of(&outcome.meshed.mesh);
        (quality.qr, quality.irregular_vertices)
    };
    let fine = quads(2_000, Layout::Quads);
    assert!(
        fine.mosaic.distortion.is_some_and(|distortion| distortion.cost(2_000) < 0.2),
        "{:?}",
        fine.mosaic.distortion
    );
    let (qr, found) = irregular(&fine);
    assert!(qr == 1.0 && (demanded / 2..=demanded + 20).contains(&found), "Qr {qr}, {found} irregular");
    let (qr, found) = irregular(&quads(2_000, Layout::Mosaic));
    assert!(qr < 1.0 && found > demanded + 20, "rows of equal tiles end: Qr {qr}, {found} irregular");

    // A hole has five tiles round: rows that pass everywhere fold.
    let coarse = quads(400, Layout::Quads);
    assert_eq!(coarse.mosaic.distortion, None, "rows end");
    assert_eq!(irregular(&coarse).0, 1.0);
    for outcome in [fine, coarse] {
        assert!(outcome.meshed.faults.is_clean() && outcome.meshed.differences.is_empty());
    }
}

#[test]
fn fitting_tiles_of_a_torus_grow_with_the_distance_from_its_axis() {
    // The field runs along the circles; rows across them fit where tiles are as wide as the circle is long.
    let options = options(Rows::Paper, 0.0);
    let (surface, sizes, count) = prepare(&example("torus", 40_000), &options).expect("a torus");
    let field = field(&surface, sizes, count, &options, &Cpu).expect("the CPU does not fail");
    let logs = integrable_sizes(&surface, &field, 10.0, &Cpu).expect("the CPU does not fail");
    let radius = |v: usize| {
        let [x, y, _] = surface.frame().to_model(surface.point(v as u32));
        x.hypot(y)
    };
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let radii: Vec<f64> = (0..logs.len()).map(|v| radius(v).ln()).collect();
    // The tanh that holds the range takes a tenth of the largest values; the slope shows it less.
    let (x, y) = (mean(&radii), mean(&logs));
    let product = |a: &[f64], b: &[f64], [p, q]: [f64; 2]| a.iter().zip(b).map(|(a, b)| (a - p) * (b - q)).sum::<f64>();
    let slope = product(&radii, &logs, [x, y]) / product(&radii, &radii, [x, x]);
    assert!((slope - 1.0).abs() < 0.1, "log h grows {slope} times as fast as the log of the radius");
    let correlation = slope * (product(&radii, &radii, [x, x]) / product(&logs, &logs, [y, y])).sqrt();
    assert!(correlation > 0.99, "{correlation}");
    let unfit: Vec<f64> = radii.iter().map(|r| -r).collect();
    assert!(product(&unfit, &logs, [-x, y]) < 0.0, "the opposite would be seen");
}

#[test]
fn continuous_rows_are_the_same_on_both_backends_and_every_time() {
    let cpu = meshed("block", Rows::Continuous, 1.0, &Cpu).meshed.mesh;
    assert_eq!(cpu, meshed("block", Rows::Continuous, 1.0, &Cpu).meshed.mesh);
    assert_ne!(cpu, meshed("block", Rows::Continuous, 0.5, &Cpu).meshed.mesh, "the dial does something");
    let Some(gpu) = common::gpu() else { return };
    let backend = GpuBackend::new(gpu).expect("kernels");
    let other = meshed("block", Rows::Continuous, 1.0, &backend).meshed.mesh;
    if gpu.adapter().hardware {
        // Other roundings may lead a row elsewhere; the figures agree.
        assert!((Quality::of(&cpu).qr - Quality::of(&other).qr).abs() < 0.02);
    } else {
        assert_eq!(cpu, other);
    }
}

#[test]
fn continuous_rows_have_the_irregular_vertices_that_the_field_demands() {
    let connectivity = Some(ConnectivityOptions { quads: Quads::All, ..ConnectivityOptions::default() });
    for name in ["torus", "sphere", "m6"] {
        let surplus = [Rows::Continuous, Rows::Paper].map(|rows| {
            let options = Options { connectivity, ..options(rows, 1.0) };
            let outcome =
                run(&example(name, 6_000), &options, &Cpu, &unwatched).unwrap_or_else(|error| panic!("{error}"));
            let report = Report::new(name, &options, &Cpu, &outcome);
            let found = report.regularity;
            assert_eq!(found.irregular as i64, found.demanded as i64 + found.surplus, "{name}");
            let sides = report.mosaic.sides.expect("there are tiles");
            assert!(sides.smallest < 1.0 && 1.0 < sides.largest && 1.0 < sides.growth, "{name}: {sides:?}");
            found.surplus
        });
        // A pair of irregular vertices may be left where the coordinates fold.
        assert!(surplus[0] <= 4, "{name}: {surplus:?}");
        assert!(surplus[1] > surplus[0], "{name}: row ends are irregular {surplus:?}");
    }
}

#[test]
fn rows_run_on_past_the_ends_of_creases_half_a_tile_apart() {
    // Two tiles' sides wide cells; creases of 4.5 and 3 tiles that overlap by 1.5.
    let soup = flat(48, 32, 0.5);
    // A plane is cut into equal triangles: what tells the creases is their names alone.
    let crease = |[from, to]: [u32; 2], y: u32| NamedEdge {
        ends: Ends::Vertices([from, to].map(|x| y * 49 + x)),
        name: format!("row {y}"),
    };
    let edges = vec![crease([10, 19], 16), crease([16, 22], 17)];
    let nearest = [Rows::Continuous, Rows::Paper].map(|rows| {
        let options = Options { edges: edges.clone(), ..Options { rows, ..Options::new(Fineness::Size(1.0)) } };
        let outcome = run(&soup, &options, &Cpu, &unwatched).unwrap_or_else(|error| panic!("{error}"));
        assert!(check(&outcome.meshed.mesh).is_clean());
        assert_eq!(Quality::of(&outcome.meshed.mesh).irregular_vertices, 0);
        // The end of the longer crease, four and a half tiles from its beginning.
        outcome.meshed.mesh.points.iter().map(|[x, y, _]| (x - 9.5).hypot(y - 8.0)).fold(f64::INFINITY, f64::min)
    });
    assert!(nearest[0] > 0.2 && nearest[1] < 1e-3, "only rows that may end have a tile there: {nearest:?}");
}
