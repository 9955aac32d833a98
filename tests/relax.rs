//! Relaxation on the GPU against its CPU twin.

mod common;

use quadmosaic::compute::cpu::neighbours;
use quadmosaic::compute::{Backend, Cpu, LIST_LENGTH, LIST_STEPS, REACH, Relaxation, SKIN};
use quadmosaic::field::{Field, FieldOptions};
use quadmosaic::gpu::{Gpu, GpuBackend};
use quadmosaic::mosaic::{CurveParameters, Tile, feature_samples, seed, side_for_count};
use quadmosaic::sizes::Sizes;
use quadmosaic::surface::examples::Example;
use quadmosaic::surface::{FeatureOptions, Surface};

fn example(name: &str) -> (Surface, Field) {
    let soup = name.parse::<Example>().unwrap().generate(3000);
    let surface = Surface::new(&soup, &FeatureOptions::default()).unwrap();
    let field = Field::new(&surface, &FieldOptions::default(), &Cpu).unwrap();
    (surface, field)
}

/// Tiles on features and scattered ones.
fn tiles(surface: &Surface, field: &Field, h: f32) -> Vec<Tile> {
    let mut tiles = feature_samples::sample_features(surface, field, h, &CurveParameters::default()).1;
    tiles.extend(seed::seed(surface, field, h));
    tiles
}

fn both(gpu: &Gpu, surface: &Surface, field: &Field, tiles: &[Tile], steps: u32) -> [Vec<Tile>; 2] {
    // Sides on features and lists are long enough for the largest tile, whatever made the tiles so large.
    let scale = tiles.iter().map(|tile| tile.h).fold(0.0, f32::max) / field.sizes().largest();
    let relaxation = Relaxation::new(steps, scale, field.sizes());
    let backend = GpuBackend::new(gpu).unwrap();
    let surface = field.relaxation_surface(surface);
    let backends: [&dyn Backend; 2] = [&Cpu, &backend];
    backends.map(|backend| backend.relaxation(&surface).unwrap().relax(tiles, &relaxation).unwrap())
}

/// What differs between two results, the worst tile first.
///
/// A software adapter must give the same bits. A hardware one may round divisions and square roots by some units in the
/// last place (2^-23 each, some hundred operations a step: 1e-4 of a side with room), and a tile at a threshold may
/// decide otherwise, so one tile in a hundred may differ by more.
fn difference(gpu: &Gpu, cpu: &[Tile], other: &[Tile]) -> Option<String> {
    let off = |a: &Tile, b: &Tile| {
        let d: f32 = (0..3).map(|k| (a.position[k] - b.position[k]).powi(2)).sum();
        d.sqrt() / a.h
    };
    let bytes = |tile: &Tile| bytemuck::bytes_of(tile).to_vec();
    let hardware = gpu.adapter().hardware;
    let differs =
        |a: &Tile, b: &Tile| if hardware { off(a, b).is_nan() || off(a, b) > 1e-4 } else { bytes(a) != bytes(b) };
    let wrong: Vec<usize> = (0..cpu.len()).filter(|&i| differs(&cpu[i], &other[i])).collect();
    let allowed = if hardware { cpu.len() / 100 } else { 0 };
    let worst = wrong.iter().copied().max_by(|&i, &j| off(&cpu[i], &other[i]).total_cmp(&off(&cpu[j], &other[j])))?;
    (wrong.len() > allowed || cpu.len() != other.len()).then(|| {
        format!(
            "{} of {} tiles differ, most tile {worst}:\n{:?}\n{:?}",
            wrong.len(),
            cpu.len(),
            cpu[worst],
            other[worst]
        )
    })
}

#[test]
fn a_step_is_the_same_on_every_example() {
    let Some(gpu) = common::gpu() else { return };
    for name in Example::NAMES {
        let (surface, field) = example(name);
        for count in [200, 2000] {
            let tiles = tiles(&surface, &field, side_for_count(&surface, count));
            let [cpu, other] = both(gpu, &surface, &field, &tiles, 1);
            assert_ne!(cpu, tiles, "{name}: nothing moved");
            assert_eq!(difference(gpu, &cpu, &other), None, "{name} at {count}");
        }
    }
}

#[test]
fn a_batch_of_steps_is_the_same() {
    let Some(gpu) = common::gpu() else { return };
    if gpu.adapter().hardware {
        common::skip("on hardware differences grow from step to step; tests/backends.rs compares the mesh's figures");
        return;
    }
    let (surface, field) = example("m6");
    let tiles = tiles(&surface, &field, side_for_count(&surface, 3000));
    let [cpu, other] = both(gpu, &surface, &field, &tiles, LIST_STEPS + 1);
    assert_eq!(difference(gpu, &cpu, &other), None);
}

/// The ids of a list.
fn ids(list: &[u32]) -> Vec<u32> {
    list.iter().copied().take_while(|&id| id != u32::MAX).collect()
}

/// The tiles that tile `id` must have in its list: all that it can see, and will if it and they move by half the skin.
fn near(tiles: &[Tile], id: usize) -> Vec<u32> {
    let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let is_near = |other: usize| {
        let e = [0, 1, 2].map(|k| tiles[other].position[k] - tiles[id].position[k]);
        let far = (REACH + SKIN) * (tiles[id].h + tiles[other].h) * 0.5;
        dot(e, e) <= far * far && dot(tiles[id].normal, tiles[other].normal) > 0.0
    };
    (0..tiles.len()).filter(|&other| other != id && is_near(other)).map(|other| other as u32).collect()
}

#[test]
fn lists_hold_what_a_search_of_all_pairs_finds() {
    for name in ["torus", "block"] {
        let (surface, field) = example(name);
        let h = side_for_count(&surface, 800);
        let tiles = tiles(&surface, &field, h);
        let cell = Relaxation::new(1, h, &Sizes::equal()).cell;
        let lists = neighbours::lists(&tiles, cell);
        let wrong = |lists: &[[u32; LIST_LENGTH]]| {
            let is_wrong = |&id: &usize| {
                let (mut found, wanted) = (ids(&lists[id]), near(&tiles, id));
                found.sort_unstable();
                // A crowded tile's list has as many as it can hold.
                let full = found.len() == LIST_LENGTH && found.iter().all(|id| wanted.contains(id));
                !(full || found == if tiles[id].quarters == 0 { wanted } else { vec![] })
            };
            (0..tiles.len()).filter(is_wrong).count()
        };
        assert_eq!(wrong(&lists), 0, "{name}");
        // Of cells that are too small, tiles two cells away are missing.
        assert!(wrong(&neighbours::lists(&tiles, 0.4 * cell)) > tiles.len() / 10, "{name}");
    }
}

#[test]
fn tiles_in_a_crowd_are_the_same() {
    let Some(gpu) = common::gpu() else { return };
    let (surface, field) = example("sphere");
    let h = side_for_count(&surface, 2000);
    // Four times as many as there is room for.
    let crowd: Vec<Tile> = seed::seed(&surface, &field, 0.5 * h).iter().map(|&tile| Tile { h, ..tile }).collect();
    let lists = neighbours::lists(&crowd, Relaxation::new(1, h, &Sizes::equal()).cell);
    let full = lists.iter().filter(|list| ids(*list).len() == LIST_LENGTH).count();
    assert!(full > crowd.len() / 2, "{full} of {} lists are full", crowd.len());
    let [cpu, other] = both(gpu, &surface, &field, &crowd, 1);
    assert_eq!(difference(gpu, &cpu, &other), None);
    // Which tiles are left out of a full list is told by their order.
    let turned: Vec<Tile> = crowd.iter().rev().copied().collect();
    let [_, mut other] = both(gpu, &surface, &field, &turned, 1);
    other.reverse();
    assert!(difference(gpu, &cpu, &other).is_some());
}

#[test]
fn tiles_of_different_sizes_are_the_same() {
    let Some(gpu) = common::gpu() else { return };
    for name in ["sphere", "block", "m6"] {
        let (surface, field) = example(name);
        // From 1 to 2 along x.
        let size = |v: u32| 1.5 + surface.point(v)[0] as f32;
        let sizes = Sizes::from_vertices(&surface, (0..surface.vertex_count() as u32).map(size).collect()).unwrap();
        let scale = sizes.side_for_count(&surface, 1500);
        let field = field.with_sizes(sizes);
        let tiles = tiles(&surface, &field, scale);
        let relaxation = Relaxation::new(LIST_STEPS, scale, field.sizes());
        let backend = GpuBackend::new(gpu).unwrap();
        let surface = field.relaxation_surface(&surface);
        let on_cpu = |relaxation| Cpu.relaxation(&surface).unwrap().relax(&tiles, relaxation).unwrap();
        let one = Relaxation { steps: 1, ..relaxation };
        // On hardware differences grow from step to step.
        let relaxation = if gpu.adapter().hardware { one } else { relaxation };
        let other = backend.relaxation(&surface).unwrap().relax(&tiles, &relaxation).unwrap();
        assert_eq!(difference(gpu, &on_cpu(&relaxation), &other), None, "{name}");
        for tile in &other {
            let wanted = scale * (1.5 + tile.position[0]);
            // Sizes are linear, but for the roundings of a dozen operations on numbers about 1.
            assert!((tile.h / wanted - 1.0).abs() < 1e-5, "{name}: {} for {wanted}", tile.h);
        }
        // At another scale tiles are others.
        let larger = Relaxation { scale: 1.001 * scale, ..one };
        assert!(on_cpu(&larger).iter().zip(&on_cpu(&one)).any(|(a, b)| a.quarters == 0 && a.h != b.h), "{name}");
    }
}

#[test]
fn one_bit_is_noticed() {
    let Some(gpu) = common::gpu() else { return };
    let (surface, field) = example("torus");
    let tiles = tiles(&surface, &field, side_for_count(&surface, 500));
    let [cpu, mut other] = both(gpu, &surface, &field, &tiles, 1);
    let moved = if gpu.adapter().hardware { other[7].h } else { 0.0 };
    for tile in if gpu.adapter().hardware { &mut other[..] } else { &mut other[7..8] } {
        tile.position[1] = f32::from_bits((tile.position[1] + moved).to_bits() ^ 1);
    }
    assert!(difference(gpu, &cpu, &other).is_some());
}

#[test]
fn tiles_at_thresholds_are_the_same() {
    let Some(gpu) = common::gpu() else { return };
    let (surface, field) = example("plate");
    let h = side_for_count(&surface, 400);
    let [first, second] = [0, 1].map(|i| tiles(&surface, &field, h)[40 + i]);
    let at = |x: f32, y: f32| {
        let mut tile = second;
        tile.position = [first.position[0] + x * h, first.position[1] + y * h, first.position[2]];
        tile.triangle = first.triangle;
        tile
    };
    // On top of each other, half a side apart, at the reach, and turned by an eighth: where decisions are made.
    let mut pairs = vec![first];
    for (x, y) in [(0.0, 0.0), (0.5, 0.0), (0.5, 0.5), (1.5, 0.0), (1.5, 1.5), (1.75, 0.0), (0.0, -0.5), (-1.0, 1.0)] {
        pairs.push(at(x, y));
    }
    let mut turned = at(0.25, 0.25);
    turned.axis = [std::f32::consts::FRAC_1_SQRT_2, std::f32::consts::FRAC_1_SQRT_2, 0.0];
    pairs.push(turned);
    let mut lost = at(0.1, 0.2);
    lost.axis = [0.0; 3];
    pairs.push(lost);
    let [cpu, other] = both(gpu, &surface, &field, &pairs, 1);
    assert_eq!(difference(gpu, &cpu, &other), None);
}
