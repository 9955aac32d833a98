//! The search for the scale at which a mosaic has the asked number of tiles.
//!
//! # Practice
//! Up to its finest level a mosaic is cheap. It is laid at another scale until its count there is right, and only then
//! relaxed on the finest level.

use super::Mosaic;
use super::builder::{Laying, MosaicBuilder, RELAXED, UNRELAXED};
use crate::compute::ComputeError;
use crate::parametrize::Rows;
use std::cell::Cell;

/// A mosaic may miss the asked count by this share before another one is laid.
const COUNT_ERROR: f64 = 0.015;
/// A mosaic may miss a count by so many tiles: the count jumps by some where a row comes or goes, and the connectivity optimisation
/// adds or removes a few.
const FEW_TILES: f64 = 6.0;
/// Mosaics that are relaxed on the finest level.
const ATTEMPTS: usize = 3;
/// A mosaic that is not relaxed yet may have so much less and so much more than the asked count, as shares, before another
/// one is tried: relaxation and clean-up delete some tiles.
const UNRELAXED_ERROR: [f64; 2] = [0.006, 0.018];
/// Mosaics that are tried for one aim.
const TRIES: usize = 6;
/// So many of them with equal sides throughout. On a surface with many equal parts, as the teeth of a gear, all of these get
/// another row at the same side, and the count jumps; where sides differ a little they do so one after the other.
const EVEN_TRIES: usize = 2;
/// By how much sides differ then, as a share, over the diagonal of the surface.
const TILT: f32 = 0.04;
/// Scales that differ by a smaller share are the same: their counts differ by chance.
const SAME_SCALE: f32 = 1e-3;
/// Mosaics that are tried where continuous rows fold much.
const FOLDED_TRIES: usize = 2;
/// Scales, as factors, that are tried too where rows fold.
const NEARBY: [f32; 4] = [1.003, 0.997, 1.007, 0.993];
/// The count of theirs may be off by so many times as much.
const MOST_OFF: f64 = 2.0;
/// The cost of a distortion from which on no scale nearby is much better.
const CHANCELESS: f64 = 0.3;

/// A mosaic that was tried: its scale, its count before its finest level is relaxed, and itself, unless it was taken.
struct Try {
    h: f32,
    count: usize,
    mosaic: Option<Mosaic>,
}

impl MosaicBuilder<'_> {
    /// A mosaic at the scale at which the sizes give `count` tiles; it may have some more or fewer.
    ///
    /// # Errors
    /// Where the backend fails.
    pub fn at_scale_for(&self, count: usize) -> Result<Mosaic, ComputeError> {
        self.laying(|laying| {
            let h = self.field.sizes().side_for_count(self.surface, count);
            let mosaic = laying.unrelaxed(h, 0.0)?;
            let relaxed = laying.relaxed(mosaic, h, UNRELAXED..RELAXED)?;
            Ok(Mosaic { wanted: count, aimed: count, ..relaxed })
        })
    }

    /// A mosaic of nearly `count` tiles. `trial` is one that this builder's surface and field gave in a trial for that count.
    ///
    /// Relaxation of the finest level changes the count a little; where it misses by too much, another count is aimed at.
    ///
    /// # Errors
    /// Where the backend fails.
    pub fn with_count(&self, count: usize, trial: Option<Mosaic>) -> Result<Mosaic, ComputeError> {
        self.laying(|laying| laying.with_count(count, trial))
    }

    fn laying(&self, lay: impl FnOnce(&Laying) -> Result<Mosaic, ComputeError>) -> Result<Mosaic, ComputeError> {
        let surface = self.relaxes().then(|| self.field.relaxation_surface(self.surface));
        let relaxation = surface.as_ref().map(|surface| self.backend.relaxation(surface)).transpose()?;
        let mosaic = lay(&Laying { builder: self, relaxation, reported: Cell::new(0.0) })?;
        (self.progress)(1.0);
        Ok(mosaic)
    }
}

impl Laying<'_> {
    fn with_count(&self, count: usize, trial: Option<Mosaic>) -> Result<Mosaic, ComputeError> {
        let mut aim = count as f64;
        let mut tried = Vec::new();
        let mut best = self.aimed_at(aim, trial, &mut tried)?;
        let mut last = best.count();
        let miss = |found: usize| (found.max(1) as f64 / count as f64).ln().abs();
        for _ in 1..ATTEMPTS {
            // Where features alone have more tiles than are wanted, or tiles are not relaxed, no other aim helps.
            if miss(last) < COUNT_ERROR.max(FEW_TILES / count as f64)
                || best.feature_samples.len() >= count
                || self.relaxation.is_none()
            {
                break;
            }
            aim *= count as f64 / last.max(1) as f64;
            let other = self.aimed_at(aim, None, &mut tried)?;
            last = other.count();
            if miss(last) < miss(best.count()) {
                best = other;
            }
        }
        Ok(Mosaic { wanted: count, aimed: count, ..best })
    }

    /// A mosaic that has `count` tiles before its finest level is relaxed; `trial` is the first one, and one that was `tried` for another
    /// count may have them, or shows where to begin.
    fn aimed_at(&self, count: f64, mut trial: Option<Mosaic>, tried: &mut Vec<Try>) -> Result<Mosaic, ComputeError> {
        // Rows that pass everywhere cost more than what they miss by.
        let [less, more] = if self.builder.rows == Rows::Continuous { [COUNT_ERROR; 2] } else { UNRELAXED_ERROR };
        let [less, more] = [less, more].map(|error| error.max(FEW_TILES / count));
        let (middle, reach) = ((more - less) / 2.0, (more + less) / 2.0);
        let off = |found: usize| ((found.max(1) as f64 / count).ln() - middle).abs();
        let nearest = |tried: &[Try], first: usize| {
            let left = (first..tried.len()).filter(|&k| tried[k].mosaic.is_some());
            left.min_by(|&a, &b| off(tried[a].count).total_cmp(&off(tried[b].count)))
        };
        let mut best = nearest(tried, 0).filter(|&known| off(tried[known].count) < reach);
        let (first, tries) = (tried.len(), if best.is_some() { 0 } else { TRIES });
        for attempt in 0..tries {
            let mosaic = match trial.take() {
                Some(trial) => trial,
                None => {
                    let tilt = if tried.len() < EVEN_TRIES { 0.0 } else { TILT };
                    self.unrelaxed(self.next_scale(count, tried), tilt)?
                }
            };
            let h = mosaic.scale;
            if self.builder.is_trial && mosaic.is_folded() {
                return Ok(mosaic);
            }
            let (features, found) = (mosaic.feature_samples.len(), mosaic.count());
            let is_same = attempt > 0 && tried.last().is_some_and(|last| (h / last.h - 1.0).abs() < SAME_SCALE);
            tried.push(Try { h, count: found, mosaic: Some(mosaic) });
            best = nearest(tried, first);
            // Where rows fold much, the count jumps by chance.
            let is_folded = || best.and_then(|best| tried[best].mosaic.as_ref()).is_some_and(Mosaic::is_folded);
            let is_last = attempt + 1 == FOLDED_TRIES && is_folded();
            if off(found) < reach || is_same || is_last || features as f64 >= count {
                break;
            }
        }
        let found = best.and_then(|best| Some((tried[best].h, tried[best].mosaic.take()?)));
        let (h, mosaic) = found.expect("one try at least");
        let (h, mosaic) = self.least_folded(h, mosaic, |found| off(found) < MOST_OFF * reach)?;
        self.relaxed(mosaic, h, UNRELAXED..RELAXED)
    }

    /// Of rows that pass over the whole surface, those of the least cost at nearly the same scale: which rows meet which is left to
    /// chance where the surface is narrow. Once an earlier mesh has found a scale, no other is tried. `is_near` says whether a count is as
    /// near as it must be.
    fn least_folded(
        &self,
        h: f32,
        mosaic: Mosaic,
        is_near: impl Fn(usize) -> bool,
    ) -> Result<(f32, Mosaic), ComputeError> {
        let mut best = (h, mosaic);
        for nearby in NEARBY {
            if self.builder.first_scale.is_some() || !best.1.is_folded() || best.1.cost() > CHANCELESS {
                break;
            }
            let other = self.unrelaxed(h * nearby, 0.0)?;
            let was_near = is_near(best.1.count());
            if (is_near(other.count()) || !was_near) && other.cost() < best.1.cost() {
                best = (h * nearby, other);
            }
        }
        Ok(best)
    }

    /// The scale to try next: between the last ones that gave too few tiles and too many, or beyond the last.
    fn next_scale(&self, count: f64, tried: &[Try]) -> f32 {
        let miss = |tried: &Try| (tried.count.max(1) as f64 / count).ln();
        // The last ones: the count jumps, and where the nearest ones stay the same, so would the scale between them.
        let latest = |is_many: bool| {
            let found = tried.iter().rev().find(|tried| (miss(tried) > 0.0) == is_many);
            found.map(|tried| (f64::from(tried.h), miss(tried)))
        };
        match ([latest(false), latest(true)], tried.last()) {
            ([Some((large, few)), Some((small, many))], _) if large > small => {
                (small * (large / small).powf(many / (many - few))) as f32
            }
            (_, Some(last)) => last.h * (miss(last) / 2.0).exp() as f32,
            (_, None) => {
                let MosaicBuilder { surface, field, first_scale, .. } = self.builder;
                field.sizes().side_for_count(surface, count.round() as usize) * first_scale.unwrap_or(1.0) as f32
            }
        }
    }
}
