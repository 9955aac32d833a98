//! Smoothing of the field on the GPU against its CPU twin.

mod common;

use quadmosaic::compute::{Backend, Complex, Cpu};
use quadmosaic::field::{Field, FieldOptions, Guide};
use quadmosaic::gpu::{Gpu, GpuBackend};
use quadmosaic::surface::examples::Example;
use quadmosaic::surface::{FeatureOptions, Surface};

/// So many that two levels are finer than the one that the smoothing sets out from.
const TRIANGLES: usize = 70_000;

/// The crosses of an example on both backends.
fn both(gpu: &Gpu, name: &str, guides: &[Guide]) -> [Vec<Complex>; 2] {
    let soup = name.parse::<Example>().unwrap().generate(TRIANGLES);
    let surface = Surface::new(&soup, &FeatureOptions::default()).unwrap();
    let backend = GpuBackend::new(gpu).unwrap();
    let backends: [&dyn Backend; 2] = [&Cpu, &backend];
    backends.map(|backend| Field::new(&surface, &FieldOptions::guided(guides), backend).unwrap().crosses().to_vec())
}

/// What differs, the worst cross first. A software adapter must give the same bits. On a hardware one a sum may be rounded
/// otherwise, by some 2^-23; the equations answer an error that is alike over `n` rows of cells by about `n * n / 10` times
/// as much, and examples of this size have some 200 rows: 1e-3.
fn difference(gpu: &Gpu, cpu: &[Complex], other: &[Complex]) -> Option<String> {
    let off = |i: usize| (cpu[i][0] - other[i][0]).hypot(cpu[i][1] - other[i][1]);
    let bits = |z: Complex| z.map(f32::to_bits);
    let hardware = gpu.adapter().hardware;
    let differs =
        |i: &usize| if hardware { off(*i).is_nan() || off(*i) > 1e-3 } else { bits(cpu[*i]) != bits(other[*i]) };
    let wrong: Vec<usize> = (0..cpu.len()).filter(differs).collect();
    let worst = wrong.iter().copied().max_by(|&i, &j| off(i).total_cmp(&off(j)))?;
    Some(format!("{} of {} differ, most cross {worst}: {:?} {:?}", wrong.len(), cpu.len(), cpu[worst], other[worst]))
}

#[test]
fn the_field_is_the_same_on_every_example() {
    let Some(gpu) = common::gpu() else { return };
    for name in Example::NAMES {
        let [cpu, other] = both(gpu, name, &[]);
        assert_eq!(difference(gpu, &cpu, &other), None, "{name}");
    }
}

#[test]
fn the_field_is_the_same_with_guides() {
    let Some(gpu) = common::gpu() else { return };
    let guide = Guide::vector([1.4, 0.0, 0.0], [0.0, 1.0, 1.0]).within(0.2);
    let [cpu, other] = both(gpu, "torus", &[guide]);
    let [unguided, _] = both(gpu, "torus", &[]);
    assert_ne!(cpu, unguided, "the guide does nothing");
    assert_eq!(difference(gpu, &cpu, &other), None);
}

#[test]
fn one_bit_is_noticed() {
    let Some(gpu) = common::gpu() else { return };
    let [cpu, mut other] = both(gpu, "sphere", &[]);
    let last = other.len() - 1;
    other[last][1] =
        if gpu.adapter().hardware { other[last][1] + 1e-2 } else { f32::from_bits(other[last][1].to_bits() ^ 1) };
    assert!(difference(gpu, &cpu, &other).is_some());
}
