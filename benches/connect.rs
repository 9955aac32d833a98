//! Triangulating the tiles, and choosing edges.

mod common;

use criterion::{Criterion, criterion_group, criterion_main};
use quadmosaic::mesh::connect::{ConnectOptions, connect};
use quadmosaic::mesh::triangulate::triangulate;

fn bench(criterion: &mut Criterion) {
    let surface = common::surface();
    let field = common::field(&surface);
    let mosaic = common::mosaic(&surface, &field);
    criterion.bench_function("connect/triangulate", |b| b.iter(|| triangulate(&surface, &field, &mosaic)));
    let triangulation = triangulate(&surface, &field, &mosaic);
    let options = ConnectOptions::default();
    criterion.bench_function("connect/connect", |b| b.iter(|| connect(&triangulation, &options)));
}

criterion_group! { name = benches; config = common::criterion(); targets = bench }
criterion_main!(benches);
