//! Relaxation on the GPU against its CPU twin.

mod common;

use quadmosaic::compute::{Backend, Cpu};
use quadmosaic::field::{Field, FieldOptions};
use quadmosaic::gpu::{Gpu, GpuBackend};
use quadmosaic::mosaic::{Relaxation, Rulers, Tile, seat, side_for_count, sow};
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
    let mut tiles = seat::seat(surface, field, h, &Rulers::default()).1;
    tiles.extend(sow::sow(surface, field, h));
    tiles
}

fn both(gpu: &Gpu, surface: &Surface, field: &Field, tiles: &[Tile], steps: u32) -> [Vec<Tile>; 2] {
    let relaxation = Relaxation::new(steps, tiles.iter().map(|tile| tile.h).fold(0.0, f32::max));
    let backend = GpuBackend::new(gpu).unwrap();
    let cpu = Cpu.ground(surface, field).unwrap().relax(tiles, &relaxation).unwrap();
    let gpu = backend.ground(surface, field).unwrap().relax(tiles, &relaxation).unwrap();
    [cpu, gpu]
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
    let [cpu, other] = both(gpu, &surface, &field, &tiles, 9);
    assert_eq!(difference(gpu, &cpu, &other), None);
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
