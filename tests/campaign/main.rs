//! A campaign of random surfaces and options: no mesh may have a fault.
//!
//! Each seed is a surface, a number of vertices and options. Environment variables:
//!
//! - `QUADMOSAIC_CAMPAIGN`: the number of seeds, from 0 on, or a range of them, as `1000..2000`. Default 300.
//! - `QUADMOSAIC_CAMPAIGN_SEED`: this seed alone. Its surface is written to the folder of temporary files.
//!
//! The test fails where a seed fails, but for the failures that [`known`] lists. A listed seed that is right is told.

mod builder;
mod judge;
mod kinds;
mod known;
mod outlines;
mod random;
mod trial;

use judge::{Sense, euler, opposed, unclean};
use known::KNOWN;
use quadmosaic::surface::Soup;
use quadmosaic::surface::examples::Example;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;
use std::time::Duration;
use trial::{Trial, Verdict};

fn seeds() -> Range<u64> {
    let Ok(text) = std::env::var("QUADMOSAIC_CAMPAIGN") else { return 0..300 };
    let (first, end) = text.split_once("..").unwrap_or(("0", &text));
    let parsed = |number: &str| number.parse().unwrap_or_else(|_| panic!("QUADMOSAIC_CAMPAIGN={text} is no range"));
    parsed(first)..parsed(end)
}

/// One trial without its surface.
struct Line {
    seed: u64,
    /// The kind, the options and the band of the number of points.
    parameters: [&'static str; 3],
    verdict: Verdict,
}

/// Judges a trial and prints it where it fails.
fn judged(trial: &Trial) -> Line {
    let Trial { seed, kind, soup, points, choice } = trial;
    let verdict = trial.judged();
    if !verdict.failures.is_empty() {
        println!(
            "seed {seed}: {} of {} triangles, --points {points} {}: {}\n    QUADMOSAIC_CAMPAIGN_SEED={seed} cargo test --release --test campaign -- --nocapture",
            kind.name,
            soup.triangles.len(),
            choice.arguments,
            told(&verdict.failures)
        );
    }
    let band = match points {
        ..50 => "below 50",
        50..200 => "50 to 200",
        200..600 => "200 to 600",
        600..3_000 => "600 to 3,000",
        _ => "3,000 and more",
    };
    Line { seed: *seed, parameters: [kind.name, choice.arguments, band], verdict }
}

fn told(failures: &BTreeMap<String, usize>) -> String {
    failures.iter().map(|(name, count)| format!("{name} x{count}")).collect::<Vec<_>>().join(", ")
}

/// Judges seeds, each on a thread of its own.
fn campaign(seeds: Range<u64>) -> Vec<Line> {
    let next = AtomicU64::new(seeds.start);
    let lines = Mutex::new(Vec::new());
    let work = || {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread starts");
        loop {
            let seed = next.fetch_add(1, Ordering::Relaxed);
            if seed >= seeds.end {
                break;
            }
            let line = pool.install(|| judged(&Trial::new(seed)));
            lines.lock().expect("no thread panics").push(line);
        }
    };
    thread::scope(|scope| {
        for _ in 0..thread::available_parallelism().map_or(1, |threads| threads.get()) {
            scope.spawn(work);
        }
    });
    let mut lines = lines.into_inner().expect("no thread panics");
    lines.sort_by_key(|line| line.seed);
    lines
}

/// Prints how many trials fail by each parameter, by which failures, and which trials take longest.
fn summarise(lines: &[Line]) {
    for (index, title) in ["kind", "options", "points"].iter().enumerate() {
        let mut rows: BTreeMap<&str, (usize, usize, BTreeMap<&str, usize>)> = BTreeMap::new();
        for line in lines {
            let row = rows.entry(line.parameters[index]).or_default();
            row.0 += 1;
            row.1 += usize::from(!line.verdict.failures.is_empty());
            line.verdict.failures.keys().for_each(|name| *row.2.entry(name).or_default() += 1);
        }
        println!("\n{title} | trials | failed | by");
        for (name, (trials, failed, by)) in rows {
            println!("{name} | {trials} | {failed} | {by:?}");
        }
    }
    let mut causes: BTreeMap<&str, Vec<u64>> = BTreeMap::new();
    for line in lines {
        line.verdict.failures.keys().for_each(|name| causes.entry(name).or_default().push(line.seed));
    }
    println!("\nfailure | seeds");
    causes.iter().for_each(|(name, seeds)| println!("{name} | {} | {seeds:?}", seeds.len()));
    let mut slowest: Vec<&Line> = lines.iter().collect();
    slowest.sort_by_key(|line| std::cmp::Reverse(line.verdict.time));
    println!("\nslowest");
    for Line { seed, parameters: [kind, options, band], verdict } in slowest.iter().take(10) {
        println!("seed {seed}: {:.1} s, {kind}, {band}, {options}", verdict.time.as_secs_f64());
    }
    let total: Duration = lines.iter().map(|line| line.verdict.time).sum();
    println!("\n{} trials in {:.0} s of one thread", lines.len(), total.as_secs_f64());
}

/// The failures that are not listed, and the listed seeds that are right.
fn against_known(lines: &[Line], known: &[(u64, &str)]) -> (Vec<String>, Vec<u64>) {
    let known: BTreeMap<u64, Vec<&str>> =
        known.iter().map(|&(seed, names)| (seed, names.split(' ').collect())).collect();
    let (mut new, mut right) = (Vec::new(), Vec::new());
    for Line { seed, verdict, .. } in lines {
        let known = known.get(seed);
        let is_new = |name: &&String| !known.is_some_and(|known| known.contains(&name.as_str()));
        new.extend(verdict.failures.keys().filter(is_new).map(|name| format!("seed {seed}: {name}")));
        if known.is_some() && verdict.failures.is_empty() {
            right.push(*seed);
        }
    }
    (new, right)
}

#[test]
fn no_mesh_has_a_fault() {
    if let Ok(seed) = std::env::var("QUADMOSAIC_CAMPAIGN_SEED") {
        let seed = seed.parse().unwrap_or_else(|_| panic!("QUADMOSAIC_CAMPAIGN_SEED={seed} is no number"));
        let trial = Trial::new(seed);
        let file = std::env::temp_dir().join(format!("quadmosaic-campaign-{seed}.obj"));
        trial.write(&file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        println!("{}", trial.command(&file));
        let failures = judged(&trial).verdict.failures;
        assert!(failures.is_empty(), "seed {seed}: {}", told(&failures));
        return;
    }
    let lines = campaign(seeds());
    summarise(&lines);

    let (new, right) = against_known(&lines, &KNOWN);
    right.iter().for_each(|seed| println!("seed {seed} is right now: take it from the list"));
    assert!(new.is_empty(), "{} new failures:\n{}", new.len(), new.join("\n"));
}

#[test]
fn surfaces_are_clean() {
    let unclean: Vec<String> = seeds()
        .map(Trial::new)
        .filter_map(|trial| {
            let why = unclean(&trial.soup, trial.kind.joined)?;
            Some(format!("seed {}, {}: {why}", trial.seed, trial.kind.name))
        })
        .collect();
    assert!(unclean.is_empty(), "{} surfaces:\n{}", unclean.len(), unclean.join("\n"));
}

#[test]
fn failures_that_are_not_listed_are_new() {
    let line = |seed, names: &[&str]| {
        let failures = names.iter().map(|name| ((*name).to_owned(), 1)).collect();
        Line { seed, parameters: [""; 3], verdict: Verdict { failures, time: Duration::ZERO } }
    };
    let lines = [line(0, &[]), line(1, &["Opposed"]), line(2, &["Euler", "Opposed"]), line(3, &[]), line(4, &["Hole"])];
    let (new, right) = against_known(&lines, &[(1, "Hole Opposed"), (2, "Opposed"), (3, "Opposed"), (9, "Hole")]);
    assert_eq!(new, ["seed 2: Euler", "seed 4: Hole"]);
    assert_eq!(right, [3]);
}

/// A ball's surface, and its triangles as faces.
fn ball() -> (Soup, Vec<[u32; 3]>) {
    let soup = "sphere".parse::<Example>().expect("an example's name").generate(200);
    let faces = soup.triangles.clone();
    (soup, faces)
}

fn opposed_of(faces: &[[u32; 3]], soup: &Soup, sense: Sense) -> usize {
    let faces: Vec<&[u32]> = faces.iter().map(|face| &face[..]).collect();
    opposed(&soup.points, &faces, soup, sense)
}

#[test]
fn inverted_faces_are_opposed() {
    let (soup, mut faces) = ball();
    assert_eq!(opposed_of(&faces, &soup, Sense::OfSurface), 0);
    faces[7].swap(0, 1);
    assert_eq!(opposed_of(&faces, &soup, Sense::OfSurface), 1);
    assert_eq!(opposed_of(&faces, &soup, Sense::OfSheets), 1);
    faces.iter_mut().for_each(|face| face.swap(0, 1));
    assert_eq!(opposed_of(&faces, &soup, Sense::OfSurface), faces.len() - 1);
    assert_eq!(opposed_of(&faces, &soup, Sense::OfSheets), 1);
}

#[test]
fn a_missing_face_changes_the_euler_characteristic() {
    let (_, faces) = ball();
    assert_eq!(euler(faces.iter().map(|face| &face[..])), 2);
    assert_eq!(euler(faces[1..].iter().map(|face| &face[..])), 1);
}

#[test]
fn spheres_that_cross_are_unclean() {
    let (mut soup, faces) = ball();
    assert_eq!(unclean(&soup, false), None);
    let count = soup.points.len() as u32;
    let moved: Vec<_> = soup.points.iter().map(|[x, y, z]| [x + 0.3, y + 0.2, z + 0.1]).collect();
    soup.points.extend(moved);
    soup.triangles.extend(faces.iter().map(|face| face.map(|v| v + count)));
    assert!(unclean(&soup, false).is_some_and(|why| why.contains("cuts")));
}

#[test]
fn a_turned_triangle_is_unclean() {
    let (mut soup, _) = ball();
    soup.triangles[3].swap(0, 1);
    for joined in [false, true] {
        assert!(unclean(&soup, joined).is_some_and(|why| why.contains("run along 2 times")));
    }
}

#[test]
fn a_surface_turned_inward_is_unclean() {
    let (mut soup, _) = ball();
    soup.triangles.iter_mut().for_each(|triangle| triangle.swap(0, 1));
    assert!(unclean(&soup, false).is_some_and(|why| why.contains("inside")));
}
