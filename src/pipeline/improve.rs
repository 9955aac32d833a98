//! Making a mesh again that has faults or misses its count.
//!
//! Variants that were measured: docs/experiments.md, making a mesh again.

use super::clock::Clock;
use super::prepare::Sizing;
use super::{Fineness, Meshed, Options, Outcome, PipelineError, attempt};
use crate::compute::Backend;
use crate::mesh::check::Faults;
use crate::mesh::compare::Difference;
use crate::progress::{Progress, Stage};
use std::iter::zip;

/// The most times that a mesh is made again, for its faults or its count.
const REPEATS: usize = 8;
/// A mesh that misses the wanted count by a larger share is made again.
const COUNT_TOLERANCE: f64 = 0.02;
/// A mesh without faults is made again so often for its count.
const MOST_CORRECTIONS: usize = 2;
/// A mesh of more vertices than [`LARGE`] is not made again, as it takes long, where faults are still more than two thirds as frequent,
/// and more than so many, or it is no better for so many times.
const MANY: usize = 10;
const MOST_FUTILE: usize = 2;
const LARGE: usize = 1_500;
/// The most times of the asked count to which this raises it, ...
const MOST_RAISED: usize = 12;
/// ... or to this count where that is more: thin walls need many vertices, however few are asked for.
const ALWAYS_ALLOWED: usize = 24_000;

/// Makes a mesh again that has faults, with smaller tiles there, or misses the count, with more tiles or fewer; `best` is the best one at
/// any time, after an error too.
pub(super) fn improve(
    best: &mut Outcome,
    mut sizing: Sizing,
    options: &Options,
    backend: &dyn Backend,
    progress: &Progress,
) -> Result<(), PipelineError> {
    let (mut places, mut miss) = (best.meshed.faulty_places(), best.miss(options));
    // The surface of the latest mesh, where that is not the best one.
    let mut latest = None;
    let (mut futile, mut corrections) = (0, 0);
    for _ in 0..REPEATS {
        let is_off = |miss: f64| miss.abs() > COUNT_TOLERANCE;
        if best.meshed.wrong() == 0 {
            // For the count alone few corrections are enough, or do not help.
            if !is_off(best.miss(options)) || corrections == MOST_CORRECTIONS {
                break;
            }
            corrections += 1;
        }
        if best.meshed.is_hopeless() {
            break;
        }
        let mut clock = Clock::new(progress);
        clock.begin(Stage::Surface)?;
        let surface = latest.take().unwrap_or_else(|| best.surface.clone());
        if !places.is_empty() {
            sizing = sizing.refined(&surface, &places)?;
        }
        if is_off(miss) {
            sizing.aim *= (-miss).exp();
        }
        let prepared = sizing.sized(surface, options, progress)?;
        let is_allowed = options.limits.expect_memory(best.surface.undivided().triangles, prepared.count).is_ok();
        if prepared.count > (MOST_RAISED * prepared.sizing.count).max(ALWAYS_ALLOWED) || !is_allowed {
            break;
        }
        let (corrected, next) = attempt(prepared, options, backend, clock)?;
        let times = zip(&best.times, &next.times).map(|(spent, more)| (spent.0, spent.1 + more.1)).collect();
        let (before, after) = (best.meshed.wrong(), next.meshed.wrong());
        let is_large = next.meshed.mesh.points.len() > LARGE;
        let is_frequent = 3.0 * next.meshed.share_wrong() > 2.0 * best.meshed.share_wrong();
        (sizing, places, miss) = (corrected, next.meshed.faulty_places(), next.miss(options));
        let rank = |wrong: usize, miss: f64| (wrong, miss.abs().max(COUNT_TOLERANCE));
        if rank(after, miss) < rank(before, best.miss(options)) {
            (*best, futile) = (next, 0);
        } else {
            (latest, futile) = (Some(next.surface), futile + 1);
        }
        best.times = times;
        if is_large && (futile >= MOST_FUTILE || after > MANY && is_frequent) {
            break;
        }
    }
    Ok(())
}

/// The number of faults and differences.
pub(super) fn wrong(faults: &Faults, differences: &[Difference]) -> usize {
    faults.list.len() + differences.len()
}

impl Outcome {
    /// The logarithm of the number of vertices over the wanted one; 0 where no number is asked for.
    fn miss(&self, options: &Options) -> f64 {
        match options.fineness {
            Fineness::Points(_) => (self.meshed.mesh.points.len().max(1) as f64 / self.mosaic.wanted as f64).ln(),
            Fineness::Size(_) | Fineness::Sampled => 0.0,
        }
    }
}

impl Meshed {
    fn wrong(&self) -> usize {
        wrong(&self.faults, &self.differences)
    }

    /// The number of faults and differences for each face.
    fn share_wrong(&self) -> f64 {
        self.wrong() as f64 / self.mesh.face_count().max(1) as f64
    }

    /// Whether nearly all faces were faults before the edits: the surface is broken, so that smaller tiles would not help.
    fn is_hopeless(&self) -> bool {
        self.edits.is_some_and(|edits| 10 * edits.faults_before > 9 * self.before.face_count())
    }

    /// The places of the faults and differences, in model units.
    fn faulty_places(&self) -> Vec<[f64; 3]> {
        let of_differences = self.differences.iter().filter_map(|difference| match *difference {
            Difference::Uncovered { at, .. } | Difference::KeptBoundary { at, .. } => Some(at),
            _ => None,
        });
        self.faults.list.iter().map(|fault| fault.at).chain(of_differences).collect()
    }
}
