//! Laying the mosaic, and one batch of relaxation at its final size.

mod common;

use criterion::{Criterion, criterion_group, criterion_main};
use quadmosaic::compute::Relaxation;
use quadmosaic::compute::cpu::relax::relax;
use quadmosaic::mosaic::Effort;

fn bench(criterion: &mut Criterion) {
    let surface = common::surface();
    let field = common::field(&surface);
    criterion.bench_function("mosaic", |b| b.iter(|| common::mosaic(&surface, &field)));
    let tiles = common::mosaic(&surface, &field).tiles;
    let batch = Relaxation::new(Effort::default().steps, tiles[0].h, field.sizes());
    let surface = field.relaxation_surface(&surface);
    criterion.bench_function("mosaic/relax", |b| b.iter(|| relax(&surface, &tiles, &batch)));
}

criterion_group! { name = benches; config = common::criterion(); targets = bench }
criterion_main!(benches);
