//! The cross field: sectors, hierarchy, smoothing.

mod common;

use criterion::{Criterion, criterion_group, criterion_main};

fn bench(criterion: &mut Criterion) {
    let surface = common::surface();
    criterion.bench_function("field", |b| b.iter(|| common::field(&surface)));
}

criterion_group! { name = benches; config = common::criterion(); targets = bench }
criterion_main!(benches);
