//! Lays the tiles of a mosaic at one scale, splits them and relaxes them.
//!
//! # Practice
//! Squares whose rows may end are laid coarsely, relaxed, and split three by three, level after level. Rows that pass over
//! the whole surface, and rectangles, are laid at their final scale and not relaxed.

use super::{CurveParameters, Mosaic, insert_delete, refine, seed};
use crate::compute::{Backend, ComputeError, Relaxation, RelaxationContext, Tile};
use crate::field::Field;
use crate::geometry::dot;
use crate::parametrize::integer_grid::{DOUBLE, continuous_integer_grid, integer_grid};
use crate::parametrize::{GridMetric, Parametrization, Rows};
use crate::sizes::Sizes;
use crate::surface::Surface;
use glam::Vec3;
use std::cell::Cell;
use std::ops::Range;

/// The longest edge that the parametrization sees rows across, in tile sides.
const LONGEST_EDGE: f64 = 0.9;
/// The same, in the shorter sides of tiles that are rectangles.
const LONGEST_ACROSS: f64 = 1.0;
/// The direction in which sides grow: oblique, so that parts that mirror each other differ.
const TILTED: [f32; 3] = [0.53, 0.62, 0.58];
/// Relaxation ends when the tiles move by less than this in a batch, in the mean, in tile sides.
const STILL: f32 = 0.01;

/// How hard to work on the tiles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// The parametrization is solved for at most this many tiles; more are made by splitting. Default 16,000.
    pub solved: usize,
    /// Batches of relaxation on each level, each before tiles are inserted and deleted, at most. Default 2.
    pub batches: usize,
    /// Steps a batch. Default 8.
    pub steps: u32,
}

impl Default for Effort {
    fn default() -> Self {
        Self { solved: 16_000, batches: 2, steps: 8 }
    }
}

/// How often each tile of the parametrization is split into three by three where tiles at the scale `h` are wanted.
fn splits(surface: &Surface, sizes: &Sizes, h: f64, solved: usize) -> i32 {
    let excess = sizes.count_for_side(surface, h) / solved.max(1) as f64;
    excess.log(9.0).ceil().max(0.0) as i32
}

/// The longest edge allowed at each vertex of a surface for a mosaic of `count` tiles, their longer sides up to `aspect`
/// times their shorter ones, in unit-sized coordinates: the parametrization sees its rows from vertex to vertex.
pub fn longest_edges(surface: &Surface, sizes: &Sizes, count: usize, aspect: f64) -> Vec<f64> {
    let h = f64::from(sizes.side_for_count(surface, count));
    let across = LONGEST_EDGE.min(LONGEST_ACROSS / aspect.sqrt());
    let longest = across * h * 3f64.powi(splits(surface, sizes, h, Effort::default().solved));
    (0..surface.vertex_count() as u32).map(|v| longest * f64::from(sizes.at_vertex(v))).collect()
}

/// Lays mosaics on one surface.
pub struct MosaicBuilder<'a> {
    /// The surface.
    pub surface: &'a Surface,
    /// Its field.
    pub field: &'a Field,
    /// What the kernels run on.
    pub backend: &'a dyn Backend,
    /// How hard to work.
    pub effort: Effort,
    /// Whether rows may end.
    pub rows: Rows,
    /// What an earlier mosaic of nearly the same surface has found: the scale that is tried first, over the one at which the sizes give
    /// the count. `None`: there was none.
    pub first_scale: Option<f64>,
    /// Whether a mosaic whose continuous rows fold much is given as it is laid first, whatever its count, as another field may fit
    /// better.
    pub is_trial: bool,
    /// Receives the progress, from 0 to 1; it stays where a mosaic is laid again for its count.
    pub progress: &'a dyn Fn(f32),
}

/// A builder at work: where tiles are relaxed, with the context for it.
pub(super) struct Laying<'a> {
    pub builder: &'a MosaicBuilder<'a>,
    pub relaxation: Option<Box<dyn RelaxationContext + 'a>>,
    /// The largest share of the work that was reported.
    pub reported: Cell<f32>,
}

/// The share of the work that tiles take until their finest level is relaxed.
pub(super) const UNRELAXED: f32 = 0.3;
/// The share with the relaxation.
pub(super) const RELAXED: f32 = 0.95;

impl MosaicBuilder<'_> {
    /// Whether tiles are relaxed after they are laid.
    pub(super) fn relaxes(&self) -> bool {
        self.rows == Rows::Paper && self.field.stretch().is_none()
    }
}

impl Laying<'_> {
    /// Tiles at the scale `h`, the finest level not relaxed; their sides differ by up to `tilt` over the surface.
    ///
    /// # Errors
    /// Where the backend fails.
    pub(super) fn unrelaxed(&self, h: f32, tilt: f32) -> Result<Mosaic, ComputeError> {
        let &MosaicBuilder { surface, field, effort, .. } = self.builder;
        let splits = splits(surface, field.sizes(), f64::from(h), effort.solved);
        // Each level has nine times as many tiles as the one before.
        let share = |split: i32| UNRELAXED * 9f32.powi(split - splits);
        let mut mosaic = self.laid(h, tilt, 3u32.pow(splits as u32))?;
        self.report(share(0));
        if self.relaxation.is_some() {
            for split in 1..=splits {
                mosaic = self.relaxed(mosaic, h * 3f32.powi(splits - split + 1), share(split - 1)..share(split))?;
                mosaic = self.refined(&mosaic, h * 3f32.powi(splits - split));
            }
        }
        self.report(UNRELAXED);
        Ok(mosaic)
    }

    /// Reports the share of the work that is done; it never falls.
    pub(super) fn report(&self, share: f32) {
        self.reported.set(share.max(self.reported.get()));
        (self.builder.progress)(self.reported.get());
    }

    /// Tiles on the integer grid of a parametrization that is solved at the scale `h * finer`: at that scale where they will
    /// be relaxed and split, else at the scale `h`, with `finer` times as many rows.
    fn laid(&self, h: f32, tilt: f32, finer: u32) -> Result<Mosaic, ComputeError> {
        let &MosaicBuilder { surface, field, rows, backend, .. } = self.builder;
        let solved = h * finer as f32;
        let sides = sides(surface, field, solved, tilt);
        // Where each tile is split later, the asked numbers would have to be multiples.
        let intervals = if finer == 1 { field.sizes().intervals() } else { &[] };
        let mut parametrization = Parametrization::solve(surface, field, sides, intervals, rows, backend)?;
        let row_ends = parametrization.resolve_row_ends(surface, rows, finer, backend)?;
        let distortion = (rows == Rows::Continuous).then(|| parametrization.distortion(surface, f64::from(solved)));
        let is_relaxed = self.relaxation.is_some();
        let h = if is_relaxed { solved } else { h };
        if !is_relaxed {
            parametrization.multiply(finer);
        }
        let mut metric = match rows {
            Rows::Continuous => Some(GridMetric::new(surface, &parametrization)),
            Rows::Paper => field.stretch().map(|_| GridMetric::of_transitions(&parametrization)),
        };
        backend.check()?;
        let points = match (rows, &metric) {
            (Rows::Continuous, Some(metric)) => continuous_integer_grid(surface, field, &parametrization, metric, h),
            _ => integer_grid(surface, field, &parametrization, h),
        };
        let mut tiles: Vec<Tile> = points.iter().map(|point| Tile::on_grid(surface, field, point)).collect();
        if tiles.is_empty() && rows == Rows::Paper {
            tiles = seed::seed(surface, field, h);
        }
        backend.check()?;
        let last_factor = if is_relaxed { finer as usize } else { 1 };
        let curve_parameters = CurveParameters::new(surface, field, &parametrization, last_factor);
        let mosaic = Mosaic::new(surface, field, h, curve_parameters, tiles);
        backend.check()?;
        let is_cancelled = || backend.check().is_err();
        let mosaic = match rows {
            _ if is_relaxed => insert_delete::insert_and_delete(surface, field, &mosaic),
            Rows::Paper => insert_delete::delete_crowded(&mosaic, insert_delete::CROWDED, &is_cancelled),
            Rows::Continuous => insert_delete::delete_crowded(&mosaic, DOUBLE, &is_cancelled),
        };
        if let Some(metric) = &mut metric {
            metric.keep_cones(mosaic.free().iter().map(|tile| tile.position));
        }
        Ok(Mosaic { metric, row_ends: Some(row_ends), distortion, ..mosaic })
    }

    fn refined(&self, coarse: &Mosaic, h: f32) -> Mosaic {
        let &MosaicBuilder { surface, field, .. } = self.builder;
        let free = refine::refine(surface, field, coarse, h);
        let refined = Mosaic::new(surface, field, h, coarse.curve_parameters.thirds(), free);
        Mosaic { row_ends: coarse.row_ends, ..insert_delete::insert_and_delete(surface, field, &refined) }
    }

    /// Relaxed in batches, tiles being inserted and deleted after each; as it is where tiles are not relaxed. The shares of the work
    /// at the start and the end are `shares`.
    ///
    /// # Errors
    /// Where the backend fails.
    pub(super) fn relaxed(&self, mut mosaic: Mosaic, h: f32, shares: Range<f32>) -> Result<Mosaic, ComputeError> {
        let Some(context) = &self.relaxation else { return Ok(mosaic) };
        let &MosaicBuilder { surface, field, effort, .. } = self.builder;
        let relaxation = Relaxation::new(effort.steps, h, field.sizes());
        let report = |done: f32| {
            self.report(shares.start + (shares.end - shares.start) * done / effort.batches as f32);
        };
        for batch in 0..effort.batches {
            let tiles = context.relax(&mosaic.tiles, &relaxation)?;
            report(batch as f32 + 0.8);
            let is_still = movement(&mosaic.tiles, &tiles) < STILL;
            mosaic = insert_delete::insert_and_delete(surface, field, &Mosaic { tiles, ..mosaic });
            report(batch as f32 + 1.0);
            if is_still {
                break;
            }
        }
        Ok(mosaic)
    }
}

/// The side of the tiles at each vertex of the surface.
fn sides(surface: &Surface, field: &Field, h: f32, tilt: f32) -> impl Fn(u32) -> f64 + Sync {
    move |vertex| {
        let up = dot(Vec3::from(TILTED), surface.points[vertex as usize]);
        f64::from(h * field.sizes().at_vertex(vertex) * (1.0 + tilt * up))
    }
}

/// How far tiles have moved in the mean, in tile sides.
fn movement(before: &[Tile], after: &[Tile]) -> f32 {
    let moved: f32 = before.iter().zip(after).map(|(a, b)| (b.at() - a.at()).length() / b.h).sum();
    moved / after.len().max(1) as f32
}
