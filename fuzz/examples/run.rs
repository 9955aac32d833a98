//! Runs targets without libFuzzer, on a stable toolchain, and writes seeds for it. See `README.md`.

use quadmosaic_fuzz::mutate::{Random, mutated};
use quadmosaic_fuzz::seeds::seeds;
use quadmosaic_fuzz::{TARGETS, Target};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::panic;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};
use std::{fs, io};

const USAGE: &str = "\
usage: run TARGET SECONDS [SEED]   run a target on changed seeds; all: each in turn
       run TARGET FILE             run it once on a file
       run seeds                   write the seeds to corpus/";

/// An input that takes longer is kept as a slow one.
const SLOW: Duration = Duration::from_secs(10);

thread_local! {
    /// Where the last panic was, and what it said.
    static PANIC: RefCell<String> = const { RefCell::new(String::new()) };
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let done = match arguments[..] {
        ["seeds"] => write_seeds().map(|()| true),
        [name, given] => run(name, given, "0"),
        [name, given, seed] => run(name, given, seed),
        _ => Err(io::Error::other(USAGE)),
    };
    match done {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(2)
        }
    }
}

/// The folder of this package.
fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

fn write_seeds() -> io::Result<()> {
    for (target, _) in TARGETS {
        let folder = folder("corpus").join(target);
        fs::create_dir_all(&folder)?;
        for (index, seed) in seeds(target).iter().enumerate() {
            fs::write(folder.join(format!("seed{index}")), seed)?;
        }
    }
    Ok(())
}

/// Whether no target failed.
fn run(name: &str, given: &str, seed: &str) -> io::Result<bool> {
    let chosen: Vec<_> = TARGETS.into_iter().filter(|(target, _)| *target == name || name == "all").collect();
    if chosen.is_empty() {
        let names = TARGETS.map(|(target, _)| target).join(", ");
        return Err(io::Error::other(format!("there is no target {name}; the targets are {names}")));
    }
    // One thread, so that an input does the same each time it is run.
    rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build_global().map_err(io::Error::other)?;
    let Ok(seconds) = given.parse() else {
        let data = fs::read(given)?;
        chosen.into_iter().for_each(|(_, target)| target(&data));
        return Ok(true);
    };
    let seed: u64 = seed.parse().map_err(io::Error::other)?;
    panic::set_hook(Box::new(|info| PANIC.set(info.to_string())));
    let failed = chosen.into_iter().map(|(name, target)| search(name, target, Duration::from_secs(seconds), seed));
    let failed: io::Result<Vec<bool>> = failed.collect();
    Ok(!failed?.contains(&true))
}

/// Runs a target on changed seeds for so long, and keeps one input for each place of a panic. Whether there was one.
fn search(name: &str, target: Target, time: Duration, seed: u64) -> io::Result<bool> {
    let (seeds, mut random) = (seeds(name), Random(seed));
    let mut found: BTreeMap<String, usize> = BTreeMap::new();
    let (start, mut runs, mut slowest) = (Instant::now(), 0_usize, Duration::ZERO);
    while start.elapsed() < time {
        // The seeds themselves come first.
        let data = match seeds.get(runs) {
            Some(seed) => seed.clone(),
            None => {
                let [one, other] = [0; 2].map(|_| &seeds[random.below(seeds.len())]);
                mutated(one, other, &mut random)
            }
        };
        runs += 1;
        let begun = Instant::now();
        let panicked = panic::catch_unwind(|| target(&data)).is_err();
        let taken = begun.elapsed();
        slowest = slowest.max(taken);
        if panicked {
            let told = PANIC.take();
            // The place stands on the first line.
            let place = told.lines().next().unwrap_or_default().to_owned();
            let count = found.entry(place).or_insert(0);
            *count += 1;
            if *count == 1 {
                println!("{name}: {told}\n  {}", keep(name, "crash", &data)?.display());
            }
        } else if taken > SLOW {
            println!("{name}: {:.1} s\n  {}", taken.as_secs_f64(), keep(name, "slow", &data)?.display());
        }
    }
    let crashes: usize = found.values().sum();
    println!(
        "{name}: {runs} runs in {:.0} s, {crashes} crashes at {} places, the slowest run {:.3} s",
        start.elapsed().as_secs_f64(),
        found.len(),
        slowest.as_secs_f64()
    );
    Ok(crashes > 0)
}

fn keep(target: &str, kind: &str, data: &[u8]) -> io::Result<PathBuf> {
    let folder = folder("artifacts").join(target);
    fs::create_dir_all(&folder)?;
    let mut hasher = DefaultHasher::new();
    data.hash(&mut hasher);
    let path = folder.join(format!("{kind}-{:016x}", hasher.finish()));
    fs::write(&path, data)?;
    Ok(path)
}
