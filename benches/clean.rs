//! Topological clean-up.

mod common;

use criterion::{Criterion, criterion_group, criterion_main};
use quadmosaic::mesh::clean::{CleanOptions, clean};

fn bench(criterion: &mut Criterion) {
    let (_, triangulation, mesh) = common::filled();
    let anchors = triangulation.anchors();
    criterion.bench_function("clean", |b| b.iter(|| clean(&mesh, &anchors, &CleanOptions::default())));
}

criterion_group! { name = benches; config = common::criterion(); targets = bench }
criterion_main!(benches);
