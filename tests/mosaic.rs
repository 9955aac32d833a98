//! The mosaic: tiles on the surface, on features where they belong, as many as asked for, none on another.

mod common;

use common::surfaces::{EXAMPLES, example, surface, unit_corners};
use glam::DVec3;
use quadmosaic::compute::Cpu;
use quadmosaic::field::{Field, FieldOptions};
use quadmosaic::mosaic::{
    CurveParameters, Effort, FeaturePoint, Mosaic, MosaicBuilder, Tile, feature_samples, seed, side_for_count,
};
use quadmosaic::parametrize::Rows;
use quadmosaic::surface::{Soup, Surface};
use std::collections::HashSet;

const COUNT: usize = 2_000;

fn laid(surface: &Surface, field: &Field, count: usize) -> Mosaic {
    let builder = MosaicBuilder {
        surface,
        field,
        backend: &Cpu,
        effort: Effort::default(),
        rows: Rows::Paper,
        first_scale: None,
        is_trial: false,
        progress: &|_| {},
    };
    builder.with_count(count, None).expect("the CPU does not fail")
}

fn field(surface: &Surface) -> Field {
    Field::new(surface, &FieldOptions::default(), &Cpu).expect("the CPU does not fail")
}

fn vector(v: [f32; 3]) -> DVec3 {
    DVec3::from(v.map(f64::from))
}

/// Coordinates lie below 0.5, where f32 are 3e-8 apart; a step adds, projects and rounds some ten times an edge crossed,
/// and what is crossed last decides.
const TOLERANCE: f64 = 2e-6;

/// What is wrong with a tile by itself.
fn fault(soup: &Soup, surface: &Surface, tile: &Tile) -> Option<String> {
    let corners = unit_corners(soup, surface.frame(), tile.triangle as usize);
    let [a, b, c] = corners;
    let normal = (b - a).cross(c - a).normalize();
    let (at, up, axis) = (vector(tile.position), vector(tile.normal), vector(tile.axis));
    let sides = [(a, b), (b, c), (c, a)];
    let outside = sides.iter().map(|&(s, e)| (at - s).dot((e - s).cross(normal).normalize()));
    let height = (at - a).dot(normal).abs();
    // The normal of a sliver is as uncertain as its corners over its height.
    let flat = (b - a).cross(c - a).length() / (b - a).length().max((c - b).length()).max((a - c).length());
    let tilt = 1e-5 + 4.0 * TOLERANCE / flat;
    if height > TOLERANCE {
        return Some(format!("{height:e} above its triangle's plane"));
    }
    if let Some(beyond) = outside.reduce(f64::max).filter(|&beyond| beyond > TOLERANCE) {
        return Some(format!("{beyond:e} outside its triangle"));
    }
    if (up.length() - 1.0).abs() > 1e-5 || (axis.length() - 1.0).abs() > 1e-5 {
        return Some(format!("normal of length {}, axis of length {}", up.length(), axis.length()));
    }
    if (up - normal).length() > tilt || axis.dot(up).abs() > tilt {
        return Some(format!("normal {up} for a triangle with {normal}, axis {axis}"));
    }
    None
}

#[test]
fn tiles_lie_on_the_surface_and_face_outward() {
    for (name, ..) in EXAMPLES {
        let soup = example(name, 5_000);
        let surface = surface(&soup);
        let mosaic = laid(&surface, &field(&surface), COUNT);
        for (id, tile) in mosaic.tiles.iter().enumerate() {
            assert_eq!(fault(&soup, &surface, tile), None, "{name}, tile {id} of {}", mosaic.tiles.len());
            assert_eq!(tile.quarters > 0, id < mosaic.sides, "{name}, tile {id}: sides first");
            assert_eq!(tile.h, mosaic.tiles[0].h, "{name}: equal tiles");
        }
        let tile = mosaic.free()[0];
        let lift = |by: f64| (vector(tile.position) + vector(tile.normal) * by).as_vec3().into();
        let slide = (vector(tile.position) + vector(tile.axis) * 0.1).as_vec3().into();
        for broken in [
            Tile { position: lift(1e-5), ..tile },
            Tile { position: slide, ..tile },
            Tile { axis: tile.normal, ..tile },
            Tile { normal: tile.normal.map(|x| -x), ..tile },
            Tile { axis: tile.axis.map(|x| x * 1.1), ..tile },
        ] {
            assert_ne!(fault(&soup, &surface, &broken), None, "{name}: {broken:?}");
        }
    }
}

#[test]
fn the_count_is_the_one_asked_for() {
    for (name, ..) in EXAMPLES {
        let surface = surface(&example(name, 5_000));
        let mosaic = laid(&surface, &field(&surface), COUNT);
        let miss = mosaic.count() as f64 / COUNT as f64 - 1.0;
        assert!(miss.abs() < 0.02, "{name}: {} tiles", mosaic.count());
        assert_eq!(mosaic.count(), mosaic.feature_samples.len() + mosaic.tiles.len() - mosaic.sides, "{name}");
        // The closed formula alone misses by what tiles on features take, but not by much.
        let h = f64::from(side_for_count(&surface, COUNT));
        let promised = surface.area() / (h * h) + surface.boundary_length() / (2.0 * h);
        assert!((promised / COUNT as f64 - 1.0).abs() < 1e-5, "{name}: {promised}");
    }
    let sphere = surface(&example("sphere", 5_000));
    let half = laid(&sphere, &field(&sphere), COUNT / 2).count() as f64;
    assert!((half / COUNT as f64 - 1.0).abs() > 0.4, "another count gives another mosaic");
}

/// Pairs of free tiles on the same side of the surface that are nearer than this, in tile sides.
fn crowded(tiles: &[Tile], least: f64) -> usize {
    let mut pairs = 0;
    for (i, a) in tiles.iter().enumerate() {
        for b in &tiles[..i] {
            let near = vector(a.position).distance(vector(b.position)) < least * f64::from(a.h);
            // Across a thin edge another tile may be near in space and far on the surface.
            pairs += usize::from(near && vector(a.normal).dot(vector(b.normal)) > 0.5);
        }
    }
    pairs
}

#[test]
fn no_two_free_tiles_overlap() {
    for (name, ..) in EXAMPLES {
        let surface = surface(&example(name, 5_000));
        let field = field(&surface);
        let mosaic = laid(&surface, &field, COUNT);
        assert_eq!(crowded(mosaic.free(), 0.5), 0, "{name}");
        // Scattered tiles do.
        let sown = seed::seed(&surface, &field, mosaic.tiles[0].h);
        assert!(crowded(&sown, 0.5) > COUNT / 20, "{name}");
    }
}

#[test]
fn the_relaxed_tiles_stand_in_rows() {
    // On a smooth closed surface a tile has a neighbour one side away along each direction of its cross.
    let surface = surface(&example("torus", 5_000));
    let field = field(&surface);
    let mosaic = laid(&surface, &field, COUNT);
    let neighbours = |tiles: &[Tile]| {
        let mut found = 0;
        for a in tiles {
            let (x, n) = (vector(a.axis), vector(a.normal));
            let y = n.cross(x);
            for way in [x, y, -x, -y] {
                let wanted = vector(a.position) + way * f64::from(a.h);
                let nearest = tiles.iter().map(|b| vector(b.position).distance(wanted)).fold(f64::MAX, f64::min);
                found += usize::from(nearest < 0.3 * f64::from(a.h));
            }
        }
        found as f64 / (4 * tiles.len()) as f64
    };
    let (relaxed, sown) = (neighbours(mosaic.free()), neighbours(&seed::seed(&surface, &field, mosaic.tiles[0].h)));
    // Of scattered tiles one lies within 0.3 sides of a place with probability 1 - exp(-pi 0.09) = 0.25.
    assert!(sown < 0.35, "{sown}");
    assert!(relaxed > 0.8, "{relaxed}");
}

#[test]
fn samples_lie_on_features() {
    for name in ["block", "plate", "m6"] {
        let soup = example(name, 5_000);
        let surface = surface(&soup);
        let field = field(&surface);
        let h = side_for_count(&surface, COUNT);
        let (samples, tiles) = feature_samples::sample_features(&surface, &field, h, &CurveParameters::default());
        let features = surface.features();
        let on_curves: HashSet<u32> = features.curves().iter().flat_map(|c| c.vertices.iter().copied()).collect();
        let corner = |h: u32| unit_corners(&soup, surface.frame(), h as usize / 3)[h as usize % 3];
        let mut corners = 0;
        for (i, sample) in samples.iter().enumerate() {
            let at = vector(tiles[sample.first_side as usize].position);
            let exact = match sample.point {
                FeaturePoint::Vertex(v) => {
                    assert!(on_curves.contains(&v), "{name}: sample {i} on vertex {v}");
                    corners += usize::from(features.is_corner(v));
                    corner(field.sectors().first_corner[field.sectors().of_vertex(v)[0] as usize])
                }
                FeaturePoint::Edge(h, share) => {
                    assert!(features.is_feature(h) && (0.0..=1.0).contains(&share), "{name}: sample {i} on edge {h}");
                    let [a, b] = [corner(h), corner(h / 3 * 3 + (h + 1) % 3)];
                    a + (b - a) * share
                }
            };
            // One rounding to f32 of coordinates below 0.5, on ends that were rounded too.
            assert!((at - exact).abs().max_element() < 1e-7, "{name}: sample {i} at {at}, not {exact}");
            let last = samples.get(i + 1).map_or(tiles.len(), |next| next.first_side as usize);
            let sides = &tiles[sample.first_side as usize..last];
            assert!(!sides.is_empty() && sides.iter().all(|s| s.quarters > 0 && vector(s.position) == at));
        }
        assert_eq!(corners, features.corners().count(), "{name}: each corner has its tile");
        let places: HashSet<[u32; 3]> =
            samples.iter().map(|s| tiles[s.first_side as usize].position.map(f32::to_bits)).collect();
        assert_eq!(places.len(), samples.len(), "{name}: no place is taken twice");
        // As many intervals as fit each curve.
        let length: f64 = features
            .curves()
            .iter()
            .flat_map(|c| &c.half_edges)
            .map(|&h| corner(h).distance(corner(h / 3 * 3 + (h + 1) % 3)))
            .sum();
        let slack = 0.5 * features.curves().len() as f64 + corners as f64;
        let miss = samples.len() as f64 - length / f64::from(h);
        assert!(miss.abs() <= slack, "{name}: {} samples on {} sides", samples.len(), length / f64::from(h));
        let wider = feature_samples::sample_features(&surface, &field, 2.0 * h, &CurveParameters::default()).0.len();
        assert!((wider as f64 - length / f64::from(h)).abs() > slack, "{name}: half as many would be seen");
    }
    let sphere = surface(&example("sphere", 1_000));
    assert_eq!(feature_samples::sample_features(&sphere, &field(&sphere), 0.1, &CurveParameters::default()).0.len(), 0);
}

#[test]
fn a_mosaic_is_the_same_every_time() {
    let block = surface(&example("block", 4_000));
    let field = field(&block);
    let tiles = |threads: usize, count: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| laid(&block, &field, count).tiles)
    };
    let once = tiles(1, 1_000);
    assert_eq!(once, tiles(1, 1_000));
    assert_eq!(once, tiles(2, 1_000));
    assert_ne!(once, tiles(2, 1_050));
}
