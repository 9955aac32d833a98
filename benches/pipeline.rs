//! The whole method.

mod common;

use criterion::{Criterion, criterion_group, criterion_main};
use quadmosaic::compute::Cpu;
use quadmosaic::pipeline::{Fineness, Options, run, unwatched};

fn bench(criterion: &mut Criterion) {
    let soup = common::soup();
    let options = Options::new(Fineness::Points(common::POINTS));
    criterion.bench_function("pipeline", |b| b.iter(|| run(&soup, &options, &Cpu, &unwatched)));
}

criterion_group! { name = benches; config = common::criterion(); targets = bench }
criterion_main!(benches);
