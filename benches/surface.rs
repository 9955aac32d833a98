//! Welding, orientation, adjacency and features.

mod common;

use criterion::{Criterion, criterion_group, criterion_main};
use quadmosaic::surface::{FeatureOptions, Surface};

fn bench(criterion: &mut Criterion) {
    let soup = common::soup();
    criterion.bench_function("surface", |b| b.iter(|| Surface::new(&soup, &FeatureOptions::default())));
}

criterion_group! { name = benches; config = common::criterion(); targets = bench }
criterion_main!(benches);
