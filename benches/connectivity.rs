//! Optimising the connectivity.

mod common;

use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use quadmosaic::mesh::Context;
use quadmosaic::mesh::connectivity::{ConnectivityOptions, Quads, optimise};

fn bench(criterion: &mut Criterion) {
    let (surface, triangulation) = common::triangulated();
    let context = Context::new(&surface);
    let mesh = common::filled(&context, &triangulation);
    for (name, quads) in [("connectivity", Quads::Most), ("connectivity/paper", Quads::Paper)] {
        let options = ConnectivityOptions { quads, ..ConnectivityOptions::default() };
        criterion.bench_function(name, |b| {
            b.iter_batched_ref(|| mesh.clone(), |mesh| optimise(&context, mesh, &options), BatchSize::LargeInput);
        });
    }
}

criterion_group! { name = benches; config = common::criterion(); targets = bench }
criterion_main!(benches);
