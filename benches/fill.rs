//! Filling holes.

mod common;

use criterion::{Criterion, criterion_group, criterion_main};
use quadmosaic::mesh::Context;
use quadmosaic::mesh::connect::{ConnectOptions, connect};
use quadmosaic::mesh::fill::{Holes, fill};

fn bench(criterion: &mut Criterion) {
    let (surface, triangulation) = common::triangulated();
    let context = Context::new(&surface);
    let edges = connect(&triangulation, &ConnectOptions::default());
    criterion.bench_function("fill", |b| b.iter(|| fill(&context, &triangulation, &edges, Holes::Patterns)));
}

criterion_group! { name = benches; config = common::criterion(); targets = bench }
criterion_main!(benches);
