//! One mesher for many meshes and several threads, its progress, and the cancellation of its runs.

mod common;

use common::surfaces::example;
use quadmosaic::pipeline::{Stage, Watch};
use quadmosaic::{Fineness, Mesher, Options, PipelineError, Soup};
use std::ops::ControlFlow;
use std::sync::Mutex;
use std::thread;
use std::time::Instant;

fn options(points: usize) -> Options {
    Options::new(Fineness::Points(points))
}

#[test]
fn threads_share_a_mesher_and_get_the_meshes_that_they_get_alone() {
    let mesher = Mesher::cpu();
    let soups: Vec<Soup> = ["sphere", "torus", "plate", "block"].map(|name| example(name, 1_000)).into();
    let mesh = |soup: &Soup| mesher.mesh(soup, &options(300)).unwrap_or_else(|error| panic!("{error}")).meshed.mesh;
    let alone: Vec<_> = soups.iter().map(mesh).collect();
    let together: Vec<_> = thread::scope(|scope| {
        let threads: Vec<_> = soups.iter().map(|soup| scope.spawn(|| mesh(soup))).collect();
        threads.into_iter().map(|thread| thread.join().expect("no panic")).collect()
    });
    assert_eq!(alone, together);
    assert_ne!(alone[0], alone[1]);
}

/// Does work on threads of its own: those of the common pool may do the work of another test while a loop waits.
fn alone<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("threads").install(work)
}

/// The stage of the last call, where the run is cancelled at a call; prints the time from the break to the return.
fn cancelled(soup: &Soup, options: &Options, when: impl Fn(Stage, usize) -> bool + Sync) -> Option<Stage> {
    let calls = Mutex::new((0, None));
    let watch: &Watch = &|stage, _| {
        let mut calls = calls.lock().expect("no call panicked");
        assert!(calls.1.is_none(), "no call follows a break");
        calls.0 += 1;
        if !when(stage, calls.0) {
            return ControlFlow::Continue(());
        }
        calls.1 = Some((stage, Instant::now()));
        ControlFlow::Break(())
    };
    let result = alone(|| Mesher::cpu().mesh_watched(soup, options, watch));
    let broken = calls.into_inner().expect("no call panicked").1;
    assert_eq!(matches!(result, Err(PipelineError::Cancelled(_))), broken.is_some());
    assert_eq!(result.is_ok(), broken.is_none());
    broken.map(|(stage, at)| {
        println!("{}: ended {} ms after the break", stage.name(), at.elapsed().as_millis());
        stage
    })
}

#[test]
fn a_run_is_cancelled_in_any_stage() {
    let soup = example("m6", 20_000);
    for stage in Stage::ALL {
        assert_eq!(cancelled(&soup, &options(6_000), |now, _| now == stage), Some(stage));
    }
    assert_eq!(cancelled(&soup, &options(6_000), |_, _| false), None);
}

#[test]
fn long_stages_ask_many_times() {
    let soup = example("m6", 20_000);
    let calls = Mutex::new(Vec::new());
    let watch: &Watch = &|stage, _| {
        calls.lock().expect("no call panicked").push(stage);
        ControlFlow::Continue(())
    };
    let outcome = alone(|| Mesher::cpu().mesh_watched(&soup, &options(20_000), watch));
    let outcome = outcome.unwrap_or_else(|error| panic!("{error}"));
    let calls = calls.into_inner().expect("no call panicked");
    for (stage, _) in outcome.times {
        let within = calls.iter().filter(|told| **told == stage).count();
        let is_long = [Stage::Field, Stage::Mosaic, Stage::Connectivity, Stage::Relocate].contains(&stage);
        assert!(!is_long || within > 2, "{}: {within} calls", stage.name());
    }
}

#[test]
fn the_surface_stage_of_many_triangles_asks_many_times() {
    let soup = example("torus", 300_000);
    let calls = Mutex::new(0);
    let watch: &Watch = &|stage, _| {
        *calls.lock().expect("no call panicked") += u32::from(stage == Stage::Surface);
        ControlFlow::Continue(())
    };
    alone(|| Mesher::cpu().mesh_watched(&soup, &options(2_000), watch)).unwrap_or_else(|error| panic!("{error}"));
    let calls = calls.into_inner().expect("no call panicked");
    assert!(calls > 10, "{calls} calls");
    // Cancelled in the midst of it, it ends with it.
    for call in [2, calls as usize / 2] {
        assert_eq!(cancelled(&soup, &options(2_000), |_, now| now == call), Some(Stage::Surface), "call {call}");
    }
}
