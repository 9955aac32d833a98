//! Filling holes.

mod common;

use criterion::{Criterion, criterion_group, criterion_main};
use quadmosaic::mesh::connect::{ConnectOptions, connect};
use quadmosaic::mesh::fill::{Holes, fill};

fn bench(criterion: &mut Criterion) {
    let (_, triangulation, _) = common::filled();
    let edges = connect(&triangulation, &ConnectOptions::default());
    criterion.bench_function("fill", |b| b.iter(|| fill(&triangulation, &edges, Holes::Patterns)));
}

criterion_group! { name = benches; config = common::criterion(); targets = bench }
criterion_main!(benches);
