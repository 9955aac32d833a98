//! The whole method, and how long a run goes on that is cancelled.

mod common;

use criterion::{Criterion, SamplingMode, criterion_group, criterion_main};
use quadmosaic::compute::Cpu;
use quadmosaic::pipeline::{Fineness, Options, Stage, run, unwatched};
use quadmosaic::surface::examples::Example;
use std::ops::ControlFlow;
use std::sync::Mutex;
use std::time::{Duration, Instant};

fn bench(criterion: &mut Criterion) {
    let soup = common::soup();
    let options = Options::new(Fineness::Points(common::POINTS));
    criterion.bench_function("pipeline", |b| b.iter(|| run(&soup, &options, &Cpu, &unwatched)));
}

/// The longest time in which the stage of a large surface does not ask whether the run is cancelled.
fn bench_cancelling(criterion: &mut Criterion) {
    let soup = Example::Torus.generate(1_000_000);
    let options = Options::new(Fineness::Points(60_000));
    let longest_silence = || {
        let asked = Mutex::new((Instant::now(), Duration::ZERO));
        let watch = |stage, _| {
            let mut asked = asked.lock().expect("no call panicked");
            let (last, longest) = *asked;
            *asked = (Instant::now(), longest.max(last.elapsed()));
            if stage == Stage::Surface { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        };
        let _ = run(&soup, &options, &Cpu, &watch);
        asked.into_inner().expect("no call panicked").1
    };
    let mut group = criterion.benchmark_group("cancelling");
    // A run takes seconds, whatever is measured of it.
    group.sampling_mode(SamplingMode::Flat).measurement_time(Duration::from_millis(10));
    group.bench_function("longest silence", |b| b.iter_custom(|runs| (0..runs).map(|_| longest_silence()).sum()));
    group.finish();
}

criterion_group! { name = benches; config = common::criterion(); targets = bench, bench_cancelling }
criterion_main!(benches);
