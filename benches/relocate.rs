//! Relocation of vertices, in as many passes as the pipeline takes.

mod common;

use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use quadmosaic::mesh::Context;
use quadmosaic::mesh::relocate::relocate;
use quadmosaic::pipeline::{Fineness, Options};

fn bench(criterion: &mut Criterion) {
    let (surface, triangulation) = common::triangulated();
    let context = Context::new(&surface);
    let mesh = common::filled(&context, &triangulation);
    let passes = Options::new(Fineness::Points(common::POINTS)).smoothing;
    criterion.bench_function("relocate", |b| {
        b.iter_batched_ref(|| mesh.clone(), |mesh| relocate(&context, mesh, passes), BatchSize::LargeInput);
    });
}

criterion_group! { name = benches; config = common::criterion(); targets = bench }
criterion_main!(benches);
