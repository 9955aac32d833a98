//! The memory and the time that a run may take, and what happens at their limits.

#[path = "common/desk.rs"]
mod desk;

use desk::{Desk, text};
use quadmosaic::mesh::check::check;
use quadmosaic::pipeline::{Fits, LimitError, Limits, Stage, Watch, predicted_memory};
use quadmosaic::surface::examples::Example;
use quadmosaic::{Fineness, Mesher, Options, Outcome, PipelineError, Report};
use std::ops::ControlFlow;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

fn within(points: usize, limits: Limits) -> Options {
    Options { limits, ..Options::new(Fineness::Points(points)) }
}

#[test]
fn a_run_that_needs_too_much_memory_is_refused_before_its_work() {
    let soup = Example::Sphere.generate(1_000);
    let begun = Mutex::new(false);
    let watch: &Watch = &|_, _| {
        *begun.lock().expect("no call panicked") = true;
        ControlFlow::Continue(())
    };
    let limited = |points, memory| {
        let options = within(points, Limits { memory: Some(memory), time: None });
        Mesher::cpu().mesh_watched(&soup, &options, watch)
    };
    let limit = predicted_memory(soup.triangles.len(), 300);
    let needed = predicted_memory(soup.triangles.len(), 40_000);
    let refusal = match limited(40_000, limit) {
        Err(PipelineError::Limit(error)) => error,
        other => panic!("{:?}", other.err()),
    };
    assert_eq!(refusal, LimitError::Memory { needed, limit, fits: Fits::Points(300) });
    let told = refusal.to_string();
    assert!(
        told.ends_with("more than the limit of 13.24 MB; 300 points would fit: ask for as many, or allow more"),
        "{told}"
    );
    assert!(!*begun.lock().expect("no call panicked"), "the work had begun");

    // What is told to fit does, and one point more does not.
    assert!(limited(300, limit).is_ok());
    assert!(*begun.lock().expect("no call panicked"));
    assert!(matches!(limited(301, limit), Err(PipelineError::Limit(_))));

    // Tiles of a given side are counted.
    let side = (soup.area() / 40_000.0).sqrt();
    let limits = Limits { memory: Some(limit), time: None };
    let options = Options { limits, ..Options::new(Fineness::Size(side)) };
    assert!(matches!(Mesher::cpu().mesh(&soup, &options), Err(PipelineError::Limit(_))));
    assert!(Mesher::cpu().mesh(&soup, &Options { fineness: Fineness::Size(12.0 * side), ..options }).is_ok());
}

#[test]
fn the_error_names_what_would_fit() {
    let fits = |triangles, points, memory| {
        let soup = Example::Plate.generate(triangles);
        let options = within(points, Limits { memory: Some(memory), time: None });
        match Mesher::cpu().mesh(&soup, &options) {
            Err(PipelineError::Limit(LimitError::Memory { fits, .. })) => Some((soup.triangles.len(), fits)),
            _ => None,
        }
    };
    // The surface alone takes more than the limit.
    let limit = predicted_memory(20_000, 500);
    let (given, found) = fits(100_000, 500, limit).expect("it does not fit");
    let Fits::Triangles(fewer) = found else { panic!("{found:?}") };
    assert!(fewer < given && predicted_memory(fewer, 500) <= limit && predicted_memory(fewer + 1, 500) > limit);
    assert_eq!(fits(100_000, 1_000_000, limit).expect("it does not fit").1, Fits::Neither);
    assert_eq!(fits(1_000, 500, limit), None);
}

#[test]
fn the_program_takes_limits_from_the_command_line_and_from_files() {
    let desk = Desk::new();
    desk.put("small.toml", "max-memory = \"20M\"\n");
    desk.put("short.toml", "time-limit = 0.000001\n");
    let mesh = ["mesh", "example:torus:2000", "-o", "out.obj", "--points"];
    for more in [["--max-memory", "20M"], ["--config", "small.toml"]] {
        let said = desk.refusal(1, &[&mesh[..], &["60000"], &more].concat());
        assert!(said.contains("of memory, more than the limit of 20.00 MB; "), "{said}");
        desk.said(&[&mesh[..], &["500"], &more].concat());
        std::fs::remove_file(desk.path("out.obj")).expect("it was written");
    }
    for more in [["--time-limit", "0.000001"], ["--config", "short.toml"]] {
        let said = desk.refusal(1, &[&mesh[..], &["500"], &more].concat());
        let message = "there is no mesh yet after 0.000001 s, the time limit; the stage surface had taken 0.00 s of it";
        assert!(said.contains(message), "{said}");
    }
    let output = desk.run(&[&mesh[..], &["500", "--time-limit", "600", "--max-memory", "1G"]].concat());
    assert!(output.status.success() && output.stderr.is_empty(), "{}", text(&output.stderr));
    for (option, value, message) in [
        ("--max-memory", "2X", "write a number of bytes, or one with K, M, G or T, as 2G or 2GB"),
        ("--time-limit", "0", "the time is a number above 0, at most 100000000, in seconds"),
    ] {
        let output = desk.run(&[&mesh[..], &["500", option, value]].concat());
        assert_eq!(output.status.code(), Some(2));
        assert!(text(&output.stderr).contains(message), "{}", text(&output.stderr));
    }
}

/// The peak of the program's memory in a run, in bytes.
#[cfg(target_os = "linux")]
fn peak(triangles: usize, points: usize) -> u64 {
    let desk = Desk::new();
    let [surface, points] = [format!("example:torus:{triangles}"), points.to_string()];
    let mut program =
        desk.command(&["mesh", &surface, "--points", &points, "-q", "-o", "out.obj"]).spawn().expect("it starts");
    let status = format!("/proc/{}/status", program.id());
    let mut peak = 0;
    while program.try_wait().expect("it can be asked").is_none() {
        // A process that has ended has no such line.
        let told = std::fs::read_to_string(&status).unwrap_or_default();
        let line = told.lines().find_map(|line| line.strip_prefix("VmHWM:")).unwrap_or_default();
        peak = line.trim().trim_end_matches(" kB").parse().unwrap_or(peak);
        thread::sleep(Duration::from_millis(1));
    }
    1024 * peak
}

#[cfg(target_os = "linux")]
#[test]
fn the_predicted_memory_is_that_of_the_program() {
    // The errors that docs/performance.md tells. A run takes up to a fifth more than another one, as each thread has a heap of its own.
    let is_near = |predicted: u64, measured: u64| (0.7..1.4).contains(&(predicted as f64 / measured as f64));
    for (triangles, points) in [(2_000, 500), (2_000, 10_000), (2_000, 40_000), (100_000, 20_000), (300_000, 500)] {
        let measured = peak(triangles, points);
        let predicted = predicted_memory(triangles, points);
        assert!(
            is_near(predicted, measured),
            "{triangles} triangles, {points} points: {predicted}, measured {measured}"
        );
        assert!(!is_near(predicted_memory(10 * triangles, 10 * points), measured), "it tells nothing");
    }
}

/// Calls a function with each stage that begins, and how often it has begun.
fn beginnings(told: impl Fn(Stage, usize) + Sync) -> impl Fn(Stage, f32) -> ControlFlow<()> + Sync {
    let state = Mutex::new((None, [0; Stage::ALL.len()]));
    move |stage, _| {
        let mut state = state.lock().expect("no call panicked");
        if state.0 != Some(stage) {
            state.0 = Some(stage);
            state.1[stage as usize] += 1;
            told(stage, state.1[stage as usize]);
        }
        ControlFlow::Continue(())
    }
}

/// A run whose time is over where a stage begins for the `time`-th time, as its progress function waits there, and the time that it had:
/// as much as it takes to come there on this machine.
fn late(example: Example, points: usize, stage: Stage, time: usize) -> (Result<Outcome, PipelineError>, Duration) {
    let soup = example.generate(1_000);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    for power in 0.. {
        let limit = Duration::from_secs(1 << power);
        let (started, has_waited) = (Instant::now(), AtomicBool::new(false));
        let watch = beginnings(|now, count| {
            let left = limit.saturating_sub(started.elapsed());
            if (now, count) == (stage, time) && !left.is_zero() {
                has_waited.store(true, Ordering::Relaxed);
                thread::sleep(left + Duration::from_millis(50));
            }
        });
        let options = within(points, Limits { memory: None, time: Some(limit) });
        let end = pool.install(|| Mesher::cpu().mesh_watched(&soup, &options, &watch));
        if has_waited.load(Ordering::Relaxed) {
            return (end, limit);
        }
    }
    unreachable!("some time is enough")
}

/// Whether a mesh of an example is made again, as its count is missed.
fn is_made_again(example: Example, points: usize) -> bool {
    let times = AtomicUsize::new(0);
    let watch = beginnings(|stage, count| {
        if stage == Stage::Finish {
            times.store(count, Ordering::Relaxed);
        }
    });
    let outcome = Mesher::cpu().mesh_watched(&example.generate(1_000), &within(points, Limits::default()), &watch);
    assert!(outcome.is_ok());
    times.load(Ordering::Relaxed) > 1
}

#[test]
fn a_mesh_that_would_be_made_again_is_the_result_where_the_time_is_over() {
    let points = [100, 130, 170, 220, 290].into_iter().find(|&points| is_made_again(Example::Block, points));
    let points = points.expect("rows of a box come whole: a count is missed");
    for stage in [Stage::Surface, Stage::Mosaic] {
        let outcome = late(Example::Block, points, stage, 2).0.unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(outcome.late.map(|late| late.stage), Some(stage));
        assert!(check(&outcome.meshed.mesh).is_clean());
    }
}

#[test]
fn the_best_mesh_so_far_is_the_result_where_the_time_is_over() {
    let points = [300, 350, 400, 450].into_iter().find(|&points| !is_made_again(Example::Torus, points));
    let points = points.expect("not all counts are missed");
    let whole = Mesher::cpu().mesh(&Example::Torus.generate(1_000), &within(points, Limits::default()));
    let whole = whole.unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(whole.late, None);
    let ends = thread::scope(|scope| {
        let runs = Stage::ALL.map(|stage| scope.spawn(move || (stage, late(Example::Torus, points, stage, 1))));
        runs.map(|run| run.join().expect("no panic"))
    });
    for (stage, (end, limit)) in ends {
        match (stage, end) {
            // There is a mesh once its holes are filled.
            (Stage::Connectivity | Stage::Relocate, Ok(outcome)) => {
                let late = outcome.late.expect("it is told");
                assert_eq!((late.stage, late.limit), (stage, limit));
                assert!(late.taken > Duration::ZERO);
                let mesh = &outcome.meshed.mesh;
                let faults = check(mesh);
                assert_eq!((faults.euler, faults.boundary_loops), (0, 0), "{}", stage.name());
                assert_ne!(*mesh, whole.meshed.mesh, "{}", stage.name());
                let options = within(points, Limits::default());
                let report: Report = Mesher::cpu().report("torus", &options, &outcome);
                let told = format!("the time limit ended the run in the stage {}", stage.name());
                assert!(report.warnings().iter().any(|warning| warning.starts_with(&told)), "{:?}", report.warnings());
            }
            // What is finished is whole.
            (Stage::Finish, Ok(outcome)) => {
                assert_eq!((outcome.late, &outcome.meshed.mesh), (None, &whole.meshed.mesh));
            }
            (_, Err(PipelineError::Limit(LimitError::Time(late)))) => {
                assert_eq!((late.stage, late.limit), (stage, limit));
                assert!(![Stage::Connectivity, Stage::Relocate, Stage::Finish].contains(&stage), "{}", stage.name());
            }
            (stage, Ok(_)) => panic!("a mesh from nothing in the stage {}", stage.name()),
            (stage, Err(error)) => panic!("{}: {error}", stage.name()),
        }
    }
}
