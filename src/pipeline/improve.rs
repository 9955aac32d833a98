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
use std::time::Duration;

/// The most times that a mesh is made again, for its faults or its count.
const REPEATS: usize = 8;
/// A mesh that misses the wanted count by a larger share is made again.
const COUNT_TOLERANCE: f64 = 0.02;
/// A mesh without faults is made again so often for its count.
const MOST_CORRECTIONS: usize = 2;
/// A mesh of more vertices than [`LARGE`] is not made again, as it takes long, where faults are still more than two thirds as frequent,
/// and more than so many, or neither their number nor their frequency has fallen for so many times.
const MANY: usize = 10;
const MOST_FUTILE: usize = 2;
const LARGE: usize = 1_500;
/// The most times of the asked count to which this raises it, ...
const MOST_RAISED: usize = 12;
/// ... or to this count where that is more: thin walls need many vertices, however few are asked for.
const ALWAYS_ALLOWED: usize = 24_000;

/// A mesh that needs so many times the asked number of vertices is made anew for its own number.
const RAISED: usize = 2;

/// Makes a mesh again that has faults, with smaller tiles there, or misses the count, with more tiles or fewer; `best` is the best one at
/// any time, after an error too. Returns the number of vertices for which it is to be made anew, where it needs far more than are asked
/// for.
pub(super) fn improve(
    best: &mut Outcome,
    mut sizing: Sizing,
    options: &Options,
    backend: &dyn Backend,
    progress: &Progress,
) -> Result<Option<usize>, PipelineError> {
    let (mut places, mut miss) = (best.meshed.faulty_places(), best.miss(options));
    // The surface of the latest mesh, where that is not the best one.
    let mut latest = None;
    let mut patience = Patience::new(best.meshed.share_wrong());
    let mut corrections = 0;
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
        if prepared.count > most_raised(prepared.sizing.count) || !is_allowed {
            break;
        }
        let is_counted = matches!(options.fineness, Fineness::Points(_));
        if is_counted && best.meshed.wrong() > 0 && prepared.count >= RAISED * prepared.sizing.count {
            return Ok(Some(prepared.count));
        }
        let (corrected, next) = attempt(prepared, options, backend, clock)?;
        let times = best.times_with(&next);
        let (before, after) = (best.meshed.wrong(), next.meshed.wrong());
        let is_large = next.meshed.mesh.points.len() > LARGE;
        let shares = [&next, best].map(|outcome| outcome.meshed.share_wrong());
        (sizing, places, miss) = (corrected, next.meshed.faulty_places(), next.miss(options));
        let rank = |wrong: usize, miss: f64| (wrong, miss.abs().max(COUNT_TOLERANCE));
        let is_better = rank(after, miss) < rank(before, best.miss(options));
        if is_better {
            *best = next;
        } else {
            latest = Some(next.surface);
        }
        best.times = times;
        if patience.is_spent(after, shares, is_better) && is_large {
            break;
        }
    }
    Ok(None)
}

/// The most vertices of a mesh for which so many are asked for.
pub(super) fn most_raised(asked: usize) -> usize {
    (MOST_RAISED * asked).max(ALWAYS_ALLOWED)
}

/// Whether it is worth to make a large mesh again.
struct Patience {
    /// The least frequency of faults yet.
    least_share: f64,
    /// How often neither the number nor the frequency of faults has fallen.
    futile: usize,
}

impl Patience {
    fn new(share: f64) -> Self {
        Self { least_share: share, futile: 0 }
    }

    /// Whether it is spent by one more mesh with so many faults. `share` is their frequency, `best` that of the best mesh before.
    fn is_spent(&mut self, faults: usize, [share, best]: [f64; 2], is_better: bool) -> bool {
        let is_like = |other: f64| 3.0 * share > 2.0 * other;
        self.futile = if !is_better && is_like(self.least_share) { self.futile + 1 } else { 0 };
        self.least_share = self.least_share.min(share);
        self.futile >= MOST_FUTILE || faults > MANY && is_like(best)
    }
}

/// The number of faults and differences.
pub(super) fn wrong(faults: &Faults, differences: &[Difference]) -> usize {
    faults.list.len() + differences.len()
}

impl Outcome {
    /// The times of both, stage by stage.
    pub(super) fn times_with(&self, other: &Self) -> Vec<(Stage, Duration)> {
        zip(&self.times, &other.times).map(|(spent, more)| (spent.0, spent.1 + more.1)).collect()
    }

    /// The logarithm of the number of vertices over the wanted one; 0 where no number is asked for.
    fn miss(&self, options: &Options) -> f64 {
        match options.fineness {
            Fineness::Points(_) => (self.meshed.mesh.points.len().max(1) as f64 / self.mosaic.wanted as f64).ln(),
            Fineness::Size(_) | Fineness::Sampled => 0.0,
        }
    }
}

impl Meshed {
    pub(super) fn wrong(&self) -> usize {
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether patience is left after meshes with these numbers of faults and of faces.
    fn is_left(meshes: &[[usize; 2]]) -> bool {
        let share = |[faults, faces]: [usize; 2]| faults as f64 / faces as f64;
        let mut best = meshes[0];
        let mut patience = Patience::new(share(best));
        meshes[1..].iter().all(|&mesh| {
            let is_better = mesh[0] < best[0];
            let is_spent = patience.is_spent(mesh[0], [share(mesh), share(best)], is_better);
            best = if is_better { mesh } else { best };
            !is_spent
        })
    }

    #[test]
    fn a_mesh_is_made_again_while_faults_become_fewer_or_rarer() {
        assert!(is_left(&[[50, 120], [49, 460], [48, 1_840]]), "fewer");
        assert!(
            is_left(&[[50, 120], [209, 1_600], [242, 4_000], [250, 9_000]]),
            "rarer, though more faces have more of them"
        );
        assert!(!is_left(&[[50, 120], [209, 450]]), "as frequent");
        assert!(is_left(&[[5, 2_000], [6, 2_000]]), "once more");
        assert!(!is_left(&[[5, 2_000], [6, 2_000], [5, 2_000]]), "neither, twice");
        assert!(is_left(&[[5, 2_000], [6, 2_000], [4, 2_000], [4, 2_000]]), "twice, but not one after the other");
    }
}
