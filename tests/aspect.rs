//! Rectangular tiles: their sides, where the longer one lies, and where there are but squares.

mod common;

use common::surfaces::{example, flat};
use glam::DVec3;
use quadmosaic::compute::Cpu;
use quadmosaic::export::tile_mesh;
use quadmosaic::field::{Guide, StretchError, StretchReport};
use quadmosaic::gpu::GpuBackend;
use quadmosaic::mesh::Mesh;
use quadmosaic::mesh::check::check;
use quadmosaic::mesh::quality::Quality;
use quadmosaic::mosaic::quality::TileQuality;
use quadmosaic::parametrize::Rows;
use quadmosaic::pipeline::{Fineness, Options, Outcome, PipelineError, run, unwatched};
use quadmosaic::sizes::SizeSample;
use quadmosaic::surface::Soup;
use std::f64::consts::TAU;

const POINTS: usize = 1_500;

fn options(guide: Guide, aspect: f64, rows: Rows) -> Options {
    let mut options = Options { aspect, rows, ..Options::new(Fineness::Points(POINTS)) };
    options.field.guides.push(guide);
    options
}

fn outcome(soup: &Soup, options: &Options) -> Outcome {
    run(soup, options, &Cpu, &unwatched).unwrap_or_else(|error| panic!("{error}"))
}

/// A tube of radius 1 about the z axis, from z = 0 to 3; of four flat sides where it is square.
fn tube(square: bool) -> Soup {
    let (around, along) = (48, 24);
    let mut soup = flat(around, along, 1.0);
    for point in &mut soup.points {
        // The seam's two sides are one.
        let [u, v] = [point[0] / around as f64 % 1.0, point[1] / along as f64];
        let (s, c) = (TAU * u).sin_cos();
        let radius = if square { 1.0 / s.abs().max(c.abs()) } else { 1.0 };
        *point = [radius * c, radius * s, 3.0 * v];
    }
    soup
}

/// A quad's middle, the direction of its first side and the one across, and the length of the first over that across.
struct Sides {
    middle: DVec3,
    ways: [DVec3; 2],
    ratio: f64,
}

fn sides(mesh: &Mesh) -> Vec<Sides> {
    let of = |face: &[u32]| {
        let p = [0, 1, 2, 3].map(|k| DVec3::from(mesh.points[face[k] as usize]));
        let ways = [p[1] - p[0] + p[2] - p[3], p[3] - p[0] + p[2] - p[1]];
        Sides {
            middle: p.iter().sum::<DVec3>() / 4.0,
            ways: ways.map(DVec3::normalize),
            ratio: ways[0].length() / ways[1].length(),
        }
    };
    mesh.faces().filter(|face| face.len() == 4).map(of).collect()
}

/// How much longer quads are along a direction than across it, each: below 1 where they are shorter.
fn along(mesh: &Mesh, direction: impl Fn(DVec3) -> DVec3) -> Vec<f64> {
    let ratio = |Sides { middle, ways, ratio }: &Sides| {
        let wanted = direction(*middle);
        if ways[0].dot(wanted).abs() > ways[1].dot(wanted).abs() { *ratio } else { 1.0 / ratio }
    };
    sides(mesh).iter().map(ratio).collect()
}

fn mean(ratios: &[f64]) -> f64 {
    (ratios.iter().map(|ratio| ratio.ln()).sum::<f64>() / ratios.len() as f64).exp()
}

/// The angle, in degrees, between a direction and the nearest side of each quad: the largest of nine in ten.
fn turned(mesh: &Mesh, direction: DVec3) -> f64 {
    let angle = |Sides { ways, .. }: &Sides| {
        ways.map(|way| way.dot(direction).abs()).into_iter().fold(0.0, f64::max).min(1.0).acos().to_degrees()
    };
    let mut angles: Vec<f64> = sides(mesh).iter().map(angle).collect();
    angles.sort_by(f64::total_cmp);
    angles[angles.len() * 9 / 10]
}

fn stretched(outcome: &Outcome) -> StretchReport {
    *outcome.field.stretch().expect("an aspect was asked for").report()
}

#[test]
fn quads_have_the_asked_aspect_along_the_guide() {
    for rows in [Rows::Paper, Rows::Continuous] {
        for aspect in [1.5, 3.0, 8.0] {
            let plate = flat(30, 30, 0.1);
            for (name, soup, at, way) in [
                ("plate along x", &plate, [1.5, 1.5, 0.0], DVec3::X),
                ("plate along y", &plate, [1.5, 1.5, 0.0], DVec3::Y),
                ("tube along z", &tube(false), [1.0, 0.0, 1.5], DVec3::Z),
            ] {
                let made = outcome(soup, &options(Guide::vector(at, way.into()), aspect, rows));
                let what = format!("{name}, {aspect}, {rows:?}");
                // Rows come whole, and of the wide ones there are at least 13.
                let found = mean(&along(&made.meshed.mesh, |_| way));
                assert!((found / aspect).ln().abs() < 0.05, "{what}: {found}");
                let turned = turned(&made.meshed.mesh, way);
                assert!(turned < 1.0, "{what}: {turned} degrees");
                // One row more or less, of those that have fewest tiles, is 4 % of them.
                let miss = made.mosaic.count() as f64 / POINTS as f64 - 1.0;
                assert!(miss.abs() < 0.03, "{what}: {miss}");
                assert!(check(&made.meshed.mesh).is_clean(), "{what}: {}", check(&made.meshed.mesh));
                let StretchReport { odd_singularities, nearly_square, unguided, .. } = stretched(&made);
                assert_eq!((odd_singularities, nearly_square, unguided), (0, 0.0, 0.0), "{what}");
            }
        }
    }
}

#[test]
fn without_an_aspect_a_guide_makes_squares() {
    let guide = Guide::vector([1.5, 1.5, 0.0], [1.0, 0.0, 0.0]);
    let made = outcome(&flat(30, 30, 0.1), &options(guide, 1.0, Rows::Paper));
    let found = mean(&along(&made.meshed.mesh, |_| DVec3::X));
    assert!((found - 1.0).abs() < 0.03, "{found}");
    assert!(made.field.stretch().is_none());
}

#[test]
fn what_cannot_be_stretched_is_refused() {
    let plate = flat(10, 10, 0.1);
    let inside = Guide::vector([0.5, 0.5, 0.0], [1.0, 0.0, 0.0]);
    let refusal = |options: &Options| match run(&plate, options, &Cpu, &unwatched) {
        Err(PipelineError::Stretch(error)) => error,
        Err(other) => panic!("{other}"),
        Ok(_) => panic!("a mesh was made"),
    };
    for aspect in [0.0, 0.5, 20.1, -3.0, f64::NAN, f64::INFINITY] {
        let error = refusal(&options(inside.clone(), aspect, Rows::Paper));
        assert!(matches!(error, StretchError::Aspect { .. }), "{aspect}: {error}");
    }
    let none = Options { aspect: 2.0, ..Options::new(Fineness::Points(POINTS)) };
    assert!(matches!(refusal(&none), StretchError::NoGuide));
    let far = Guide::vector([0.5, 0.5, 9.0], [1.0, 0.0, 0.0]);
    assert!(matches!(refusal(&options(far, 2.0, Rows::Paper)), StretchError::NoGuide));
    let fitted = Options { fit: 1.0, ..options(inside, 2.0, Rows::Paper) };
    assert!(matches!(refusal(&fitted), StretchError::Fitted));
}

#[test]
fn the_choice_passes_creases() {
    let round = |middle: DVec3| DVec3::Z.cross(middle).normalize();
    for (way, aspect_along_z) in [([0.0, 0.0, 1.0], 3.0), ([0.0, 1.0, 0.0], 1.0 / 3.0)] {
        let made = outcome(&tube(true), &options(Guide::vector([1.0, 0.0, 1.5], way), 3.0, Rows::Paper));
        assert!(made.surface.features().curves().len() >= 6, "four creases and two rims");
        // On each of the four sides, of which the guide knows one.
        for side in [DVec3::X, DVec3::Y, -DVec3::X, -DVec3::Y] {
            let there = |quad: &&Sides| quad.middle.dot(side) > 0.98;
            let quads = sides(&made.meshed.mesh);
            let ratios: Vec<f64> = quads
                .iter()
                .filter(there)
                .map(|quad| if quad.ways[0].z.abs() > 0.7 { quad.ratio } else { 1.0 / quad.ratio })
                .collect();
            assert!(ratios.len() > 200, "{side}: {}", ratios.len());
            assert!((mean(&ratios) / aspect_along_z).ln().abs() < 0.06, "{side}: {}", mean(&ratios));
        }
        assert_eq!(stretched(&made).nearly_square, 0.0);
    }
    // On a round tube too: there the longer side goes round.
    let made = outcome(&tube(false), &options(Guide::vector([1.0, 0.0, 1.5], [0.0, 1.0, 0.0]), 3.0, Rows::Paper));
    assert!((mean(&along(&made.meshed.mesh, round)) / 3.0).ln().abs() < 0.05);
}

#[test]
fn rows_of_a_wing_run_along_its_span() {
    let soup = example("m6", 6_000);
    let span = DVec3::new(0.45, 1.0, 0.0).normalize();
    for rows in [Rows::Paper, Rows::Continuous] {
        let made = outcome(&soup, &options(Guide::vector([0.6, 0.6, 0.02], span.into()).within(0.3), 3.0, rows));
        let mut ratios = along(&made.meshed.mesh, |_| span);
        ratios.sort_by(f64::total_cmp);
        let median = ratios[ratios.len() / 2];
        assert!((median / 3.0).ln().abs() < 0.06, "{rows:?}: {median}");
        assert!(turned(&made.meshed.mesh, span) < 30.0, "{rows:?}: the edges are swept by 16 and 30 degrees");
        let miss = made.mosaic.count() as f64 / POINTS as f64 - 1.0;
        assert!(miss.abs() < if rows == Rows::Paper { 0.011 } else { 0.03 }, "{rows:?}: {miss}");
        let faults = check(&made.meshed.mesh);
        assert!(faults.is_clean(), "{rows:?}: {faults}");
        assert_eq!((faults.euler, faults.boundary_loops), (1, 1), "{rows:?}");
        let StretchReport { odd_singularities, nearly_square, unguided, .. } = stretched(&made);
        assert_eq!(odd_singularities, 2, "{rows:?}: one a side, at the tip");
        assert!(nearly_square > 0.0 && nearly_square < 0.03 && unguided == 0.0, "{rows:?}: {nearly_square}");
    }
}

#[test]
fn about_odd_singularities_tiles_are_squares() {
    let soup = example("sphere", 6_000);
    let made = outcome(&soup, &options(Guide::vector([1.0, 0.0, 0.0], [0.0, 0.0, 1.0]), 3.0, Rows::Paper));
    let StretchReport { odd_singularities, nearly_square, unguided, .. } = stretched(&made);
    assert_eq!(odd_singularities, 8);
    assert!(nearly_square > 0.02 && nearly_square < 0.5 && unguided == 0.0, "{nearly_square}");
    let odd: Vec<DVec3> = made
        .field
        .singularities(&made.surface)
        .iter()
        .map(|singularity| made.surface.frame().to_model(singularity.position).into())
        .collect();
    assert_eq!(odd.len(), 8);
    let (mut near, mut guided) = (Vec::new(), Vec::new());
    for quad in sides(&made.meshed.mesh) {
        let ratio = quad.ratio.max(1.0 / quad.ratio);
        if odd.iter().any(|place| place.distance(quad.middle) < 0.12) {
            near.push(ratio);
        }
        if quad.middle.distance(DVec3::X) < 0.3 {
            guided.push(if quad.ways[0].z.abs() > 0.7 { quad.ratio } else { 1.0 / quad.ratio });
        }
    }
    assert!(near.len() > 8 && guided.len() > 10, "{} {}", near.len(), guided.len());
    assert!(mean(&near) < 1.5, "{}", mean(&near));
    assert!(mean(&guided) > 2.0, "{}: long, and along the guide", mean(&guided));
}

#[test]
fn as_many_are_squares_whatever_unit_sizes_have() {
    let guided = |fineness, sizes: &[f64]| {
        let samples = sizes.iter().map(|&size| SizeSample { point: [1.0, 0.0, 0.0], size });
        let mut options = options(Guide::vector([1.0, 0.0, 0.0], [0.0, 0.0, 1.0]), 3.0, Rows::Paper);
        options.fineness = fineness;
        options.sizes.samples = samples.collect();
        stretched(&outcome(&example("sphere", 6_000), &options)).nearly_square
    };
    // Equal tiles of the side 0.1 are 1,257.
    let points = guided(Fineness::Points(1_257), &[]);
    let [sampled, coarser] = [0.1, 0.2].map(|size| guided(Fineness::Sampled, &[size]));
    // The triangles that cuts cross are not the same ones.
    assert!((sampled / points).ln().abs() < 0.4, "{sampled}, {points}");
    assert!(coarser > 1.5 * sampled, "{coarser}: squares are so many tiles about a point");
}

#[test]
fn a_part_that_no_guide_reaches_has_squares() {
    let mut soup = flat(20, 20, 0.1);
    let other = flat(20, 20, 0.1);
    let first = soup.points.len() as u32;
    soup.points.extend(other.points.iter().map(|[x, y, z]| [x + 3.0, *y, *z]));
    soup.triangles.extend(other.triangles.iter().map(|triangle| triangle.map(|v| v + first)));
    let made = outcome(&soup, &options(Guide::vector([1.0, 1.0, 0.0], [1.0, 0.0, 0.0]), 4.0, Rows::Paper));
    let report = stretched(&made);
    assert!((report.unguided - 0.5).abs() < 1e-6 && report.nearly_square == 0.0, "{report:?}");
    for (range, aspect) in [(0.0..2.0, 4.0), (3.0..5.0, 1.0)] {
        let quads = sides(&made.meshed.mesh);
        let own = quads.iter().filter(|quad| range.contains(&quad.middle.x));
        let ratios: Vec<f64> =
            own.map(|quad| if quad.ways[0].x.abs() > 0.7 { quad.ratio } else { 1.0 / quad.ratio }).collect();
        assert!((mean(&ratios) / aspect).ln().abs() < 0.06, "{range:?}: {}", mean(&ratios));
    }
}

#[test]
fn rectangles_cover_the_surface_once() {
    let guide = Guide::vector([1.5, 1.5, 0.0], [1.0, 0.0, 0.0]);
    let made = outcome(&flat(30, 30, 0.1), &options(guide, 4.0, Rows::Paper));
    let fit = TileQuality::of(&made.surface, &made.mosaic);
    assert!(fit.coverage > 0.97 && fit.overlap < 0.03, "{fit:?}");
    assert!(fit.straightness < 0.5, "{}", fit.straightness);
    let (tiles, _) = tile_mesh(&made.surface, &made.mosaic, 0.2);
    // Those on the rim are halves and quarters.
    let inner: Vec<f64> = sides(&tiles)
        .iter()
        .filter(|tile| (0.3..2.7).contains(&tile.middle.x) && (0.3..2.7).contains(&tile.middle.y))
        .map(|tile| if tile.ways[0].x.abs() > 0.7 { tile.ratio } else { 1.0 / tile.ratio })
        .collect();
    assert!(inner.len() > 800, "{}", inner.len());
    assert!(inner.iter().all(|ratio| (ratio / 4.0).ln().abs() < 0.01), "{}", mean(&inner));
}

#[test]
fn both_backends_stretch_alike() {
    let Some(gpu) = common::gpu() else { return };
    let soup = example("m6", 6_000);
    let options = options(Guide::vector([0.6, 0.6, 0.02], [0.45, 1.0, 0.0]), 3.0, Rows::Paper);
    let backend = GpuBackend::new(gpu).expect("kernels");
    let on_gpu = run(&soup, &options, &backend, &unwatched).unwrap_or_else(|error| panic!("{error}"));
    let on_cpu = outcome(&soup, &options);
    if gpu.adapter().hardware {
        // Other roundings may lay a row elsewhere; the figures agree.
        let qr = |made: &Outcome| Quality::of(&made.meshed.mesh).qr;
        assert!((qr(&on_gpu) - qr(&on_cpu)).abs() < 0.02);
    } else {
        assert_eq!(on_gpu.meshed.mesh, on_cpu.meshed.mesh);
    }
    assert_ne!(
        on_cpu.meshed.mesh,
        outcome(&soup, &Options { aspect: 1.0, ..options }).meshed.mesh,
        "the aspect does something"
    );
}
