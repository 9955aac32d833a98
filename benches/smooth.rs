//! Smoothing on the surface, as many passes as the pipeline takes.

mod common;

use criterion::{Criterion, criterion_group, criterion_main};
use quadmosaic::mesh::smooth::smooth;
use quadmosaic::pipeline::{Fineness, Options};

fn bench(criterion: &mut Criterion) {
    let (surface, triangulation, mesh) = common::filled();
    let all: Vec<u32> = (0..mesh.points.len() as u32).collect();
    let below = triangulation.free_triangles(&all);
    let passes = Options::new(Fineness::Points(common::POINTS)).smoothing;
    criterion.bench_function("smooth", |b| b.iter(|| smooth(&surface, &mesh, &below, passes)));
}

criterion_group! { name = benches; config = common::criterion(); targets = bench }
criterion_main!(benches);
