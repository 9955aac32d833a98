//! The mosaic: equal square tiles in straight rows, on features, at the asked count.
//!
//! # Theory
//! After Lai, Hu and Martin's surface mosaics (the paper's references 1 and 2): square tiles of one size are laid over
//! the surface, turned along the cross field, and relaxed by a repulsion that is square as they are.
//!
//! # Changes versus the paper
//! The paper relaxes random tiles at their final size. Here tiles are taken where the rows of a periodic solve cross
//! ([`phases`], [`lattice`]), in step over the whole surface; where more are wanted than are solved for, each is split into
//! three by three ([`refine`]). Rows may be led on until none ends ([`Rows::Continuous`]); the tiles' sides then give way.
//! There, and where tiles are rectangles, neighbours are known in the mosaic's own metric ([`chart`]). Tiles on features are
//! placed along the feature curves ([`feature_samples`]) and stay there; they are seen from each side of a crease apart.
//!
//! # Practice
//! Order of work: [`phases`], [`feature_samples`] tiles on features, [`lattice`], [`census`] (remove and add), [`relax`], [`refine`];
//! where no row crosses another, as on a part of the size of a tile, [`sow`].
//!
//! Tried at 6,000 tiles: one, two and six batches of 8 steps gave fish_blub 3.9, 3.9, 3.9 and spot 4.2, 4.2, 4.1 % odd faces
//! before clean-up; two are kept, for what sizes and guides disturb. In the first of them tiles move by 0.008 tile sides in
//! the mean on m6_gen, 0.02 on spot, 0.06 after a split; where it is less than a hundredth there is no second. At 60,000 tiles, m6_gen and spot: solved at 6,700 and
//! split 0.62 and 1.55 % odd faces, Qg 0.981 and 0.967; solved at 60,000 0.54 and 1.61 %, Qg 0.985 and 0.971, in twice the time.
//! Rectangular tiles ([`crate::field::Stretch`]) are taken where rows cross, at the wanted density, and are not relaxed.
//! Squares laid like that have, at 6,000 points after clean-up and pairing, Qr 0.992 on spot, 0.989 on fandisk and 0.993 on
//! the example's wing, and 3.1, 2.5 and 1.5 % irregular vertices; relaxed they have 0.992, 0.991 and 0.994, and 2.3, 2.4 and
//! 1.4 %.
//! A reach of 1.6 tile sides instead of 1.75 loses 0.003 of Qr on the eight models and saves a tenth of the time.

pub mod census;
pub mod chart;
pub mod feature_samples;
pub mod fit;
pub mod fitting;
pub mod grid;
pub mod lattice;
pub mod neighbours;
pub(crate) mod oblong;
pub mod phases;
pub mod refine;
pub mod relax;
pub mod sow;
pub mod squares;

pub use feature_samples::{CurveParameters, FeaturePoint, FeatureSample};
pub use relax::Relaxation;

use crate::compute::{Backend, ComputeError, Ground};
use crate::field::Field;
use crate::geometry::dot;
use crate::sizes::Sizes;
use crate::surface::Surface;
use bytemuck::{Pod, Zeroable};
use chart::Chart;
use glam::Vec3;
use phases::{Phases, RowEnds};

/// A tile, or one side of a tile on a feature; the record that the kernels read.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Tile {
    /// Its centre, on the surface.
    pub position: [f32; 3],
    /// Its side length; of a rectangle, that of a square with its area.
    pub h: f32,
    /// The surface's unit normal there.
    pub normal: [f32; 3],
    /// The triangle that it lies in.
    pub triangle: u32,
    /// One direction of its cross: a unit vector along the surface.
    pub axis: [f32; 3],
    /// 0: free to move. Else it is the side of a fixed tile on a feature: the number of quarter turns from `axis`,
    /// counter-clockwise, that belong to this side.
    pub quarters: u32,
}

impl Tile {
    pub(crate) fn at(&self) -> Vec3 {
        Vec3::from(self.position)
    }

    pub(crate) fn normal(&self) -> Vec3 {
        Vec3::from(self.normal)
    }

    /// The direction of the cross at `turn` quarter turns, counter-clockwise, from `axis`.
    pub(crate) fn direction(&self, turn: u32) -> Vec3 {
        let axis = Vec3::from(self.axis);
        let direction = if turn % 2 == 1 { crate::geometry::cross(self.normal(), axis) } else { axis };
        if turn % 4 < 2 { direction } else { -direction }
    }

    /// A free tile at a point of a triangle, turned along the field; `h` is the scale of its sizes.
    pub(crate) fn free(surface: &Surface, field: &Field, triangle: u32, position: Vec3, h: f32) -> Self {
        Self {
            position: position.into(),
            h: h * field.sizes().at(surface, triangle, position),
            normal: surface.normal(triangle as usize).into(),
            triangle,
            axis: field.axis(surface, triangle, position).into(),
            quarters: 0,
        }
    }
}

/// Tiles on features, with their sides, and free tiles.
#[derive(Clone, Debug, Default)]
pub struct Mosaic {
    /// The tiles on features.
    pub feature_samples: Vec<FeatureSample>,
    /// All sides of the tiles on features first, in the order of the samples, then the free tiles.
    pub tiles: Vec<Tile>,
    /// How many of the tiles are sides.
    pub sides: usize,
    /// The scale of the tiles' sizes.
    pub scale: f32,
    pub(crate) curve_parameters: CurveParameters,
    /// See [`Mosaic::factor`]; empty where tiles are squares.
    pub(crate) factors: Vec<f32>,
    /// The metric in which the tiles are equal squares, where rows pass over the whole surface or tiles are rectangles.
    pub(crate) chart: Option<Chart>,
    /// What became of the ends of rows: on the level that was solved for.
    pub row_ends: Option<RowEnds>,
}

impl Mosaic {
    /// The free tiles.
    pub fn free(&self) -> &[Tile] {
        &self.tiles[self.sides..]
    }

    /// The number of tiles, those of several sheets at one place counted once: vertices of the mesh to come.
    pub fn count(&self) -> usize {
        let own = (0..).zip(&self.feature_samples).filter(|(id, sample)| sample.same_place == *id).count();
        own + self.free().len()
    }

    /// Tiles at the scale `h` on the features, and these free tiles.
    pub(crate) fn new(
        surface: &Surface,
        field: &Field,
        h: f32,
        curve_parameters: CurveParameters,
        free: impl IntoIterator<Item = Tile>,
    ) -> Self {
        let (feature_samples, mut tiles) = feature_samples::sample_features(surface, field, h, &curve_parameters);
        let sides = tiles.len();
        tiles.extend(free);
        let factors = oblong::factors(surface, field, &tiles);
        Self { feature_samples, tiles, sides, scale: h, curve_parameters, factors, chart: None, row_ends: None }
    }
}

/// Whether rows of tiles may end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Rows {
    /// They end where tiles of the wanted sides need it.
    #[default]
    Paper,
    /// They pass over the whole surface but for singularities of the field, and sides give way.
    Continuous,
}

/// How hard to work on the tiles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// The periodic solve lays at most this many tiles; more are made of them by splitting. Default 16,000.
    pub solved: usize,
    /// Batches of relaxation on each level, each before a census, at most. Default 2.
    pub batches: usize,
    /// Steps a batch. Default 8.
    pub steps: u32,
}

impl Default for Effort {
    fn default() -> Self {
        Self { solved: 16_000, batches: 2, steps: 8 }
    }
}

/// How often each tile of the periodic solve is split into three by three where tiles at the scale `h` are wanted.
fn splits(surface: &Surface, sizes: &Sizes, h: f64, solved: usize) -> i32 {
    let excess = sizes.count_for_side(surface, h) / solved.max(1) as f64;
    excess.log(9.0).ceil().max(0.0) as i32
}

/// The longest edge at each vertex of a surface on which a mosaic of `count` tiles can be laid, their longer sides up to
/// `aspect` times their shorter ones, in unit-sized coordinates: the periodic solve sees its rows from vertex to vertex.
pub fn longest_edges(surface: &Surface, sizes: &Sizes, count: usize, aspect: f64) -> Vec<f64> {
    let h = f64::from(sizes.side_for_count(surface, count));
    let across = LONGEST_EDGE.min(LONGEST_ACROSS / aspect.sqrt());
    let longest = across * h * 3f64.powi(splits(surface, sizes, h, Effort::default().solved));
    (0..surface.vertex_count() as u32).map(|v| longest * f64::from(sizes.at_vertex(v))).collect()
}

/// The number of equal tiles of side `h`, unit-sized, that a surface takes: the inverse of [`side_for_count`].
pub fn count_for_side(surface: &Surface, h: f64) -> f64 {
    Sizes::equal().count_for_side(surface, h)
}

/// The side of `count` equal tiles.
pub fn side_for_count(surface: &Surface, count: usize) -> f32 {
    Sizes::equal().side_for_count(surface, count)
}

/// Lays mosaics on one surface.
pub struct Layer<'a> {
    /// The surface.
    pub surface: &'a Surface,
    /// Its field.
    pub field: &'a Field,
    /// What the periodic solve runs on.
    pub backend: &'a dyn Backend,
    /// Surface and field, made ready for relaxation.
    pub ground: &'a dyn Ground,
    /// How hard to work.
    pub effort: Effort,
    /// Whether rows may end.
    pub rows: Rows,
    /// Is told how far the work is, from 0 to 1; it begins anew where a mosaic is laid again for its count.
    pub progress: &'a dyn Fn(f32),
}

/// A mosaic may miss the asked count by this share before another one is laid.
const COUNT_ERROR: f64 = 0.01;
/// Mosaics that are laid in full.
const ATTEMPTS: usize = 3;
/// A coarse mosaic may promise so much less and so much more than the asked count, as shares, before another one is tried: the
/// relaxation's census and the clean-up take some away.
const PROMISE_ERROR: [f64; 2] = [0.003, 0.009];
/// Coarse mosaics that are tried.
const TRIES: usize = 6;
/// So many of them with equal sides throughout. On a surface with many equal parts, as the teeth of a gear, all of these get
/// another row at the same side, and the count jumps; where sides differ a little they do so one after the other.
const EVEN_TRIES: usize = 2;
/// By how much sides differ then, as a share, over the diagonal of the surface.
const TILT: f32 = 0.04;
/// The direction in which they grow: oblique, so that parts that mirror each other differ.
const TILTED: [f32; 3] = [0.53, 0.62, 0.58];
/// The longest edge that the periodic solve sees rows across, in tile sides.
const LONGEST_EDGE: f64 = 0.9;
/// The same, in the shorter sides of tiles that are rectangles.
const LONGEST_ACROSS: f64 = 1.0;

/// The side of the tiles at each vertex of the surface.
fn sides(surface: &Surface, field: &Field, h: f32, tilt: f32) -> impl Fn(u32) -> f64 + Sync {
    move |vertex| {
        let up = dot(Vec3::from(TILTED), surface.points[vertex as usize]);
        f64::from(h * field.sizes().at_vertex(vertex) * (1.0 + tilt * up))
    }
}

/// A coarse mosaic that was laid: its scale, by how much its sides differ, and the tiles that it promised.
#[derive(Clone, Copy)]
struct Try {
    h: f32,
    tilt: f32,
    promised: usize,
}

/// A level is done when its tiles move by less than this in a batch, in the mean, in tile sides.
const STILL: f32 = 0.01;

/// How far tiles have moved in the mean, in tile sides.
fn movement(before: &[Tile], after: &[Tile]) -> f32 {
    let moved: f32 = before.iter().zip(after).map(|(a, b)| (b.at() - a.at()).length() / b.h).sum();
    moved / after.len().max(1) as f32
}

impl Layer<'_> {
    /// A mosaic of nearly `count` tiles.
    ///
    /// The census of the finest level changes the count a little; where it misses by too much, another count is aimed at.
    ///
    /// # Errors
    /// Where the backend fails.
    pub fn with_count(&self, count: usize) -> Result<Mosaic, ComputeError> {
        let mut aim = count as f64;
        let mut tried = Vec::new();
        let mut best = self.aimed_at(aim, &mut tried)?;
        let mut last = best.count();
        let miss = |found: usize| (found.max(1) as f64 / count as f64).ln().abs();
        for _ in 1..ATTEMPTS {
            // Where features alone have more tiles than are wanted, or a promise is always kept, no other aim helps.
            if miss(last) < COUNT_ERROR || best.feature_samples.len() >= count || !self.relaxes() {
                break;
            }
            aim *= count as f64 / last.max(1) as f64;
            let other = self.aimed_at(aim, &mut tried)?;
            last = other.count();
            if miss(last) < miss(best.count()) {
                best = other;
            }
        }
        Ok(best)
    }

    /// A mosaic that promises `count` tiles before its finest level is relaxed.
    ///
    /// Up to there it is cheap, and laid again with another side until its promise is right; what was `tried` for another count
    /// shows where to begin.
    fn aimed_at(&self, count: f64, tried: &mut Vec<Try>) -> Result<Mosaic, ComputeError> {
        // Rows that pass everywhere cost more than what they miss by.
        let [less, more] = if self.rows == Rows::Continuous { [COUNT_ERROR; 2] } else { PROMISE_ERROR };
        let (middle, reach) = ((more - less) / 2.0, (more + less) / 2.0);
        let off = |promised: usize| ((promised.max(1) as f64 / count).ln() - middle).abs();
        let mut best: Option<(Try, Mosaic)> = None;
        for attempt in 0..TRIES {
            let known = tried.iter().copied().min_by(|a, b| off(a.promised).total_cmp(&off(b.promised)));
            let known = known.filter(|known| attempt == 0 && off(known.promised) < reach);
            let (h, tilt) = known.map_or_else(
                || (self.side(count, tried), if tried.len() < EVEN_TRIES { 0.0 } else { TILT }),
                |known| (known.h, known.tilt),
            );
            let finest = self.promised(h, tilt)?;
            let (features, promised) = (finest.feature_samples.len(), finest.count());
            let this = Try { h, tilt, promised };
            tried.push(this);
            if best.as_ref().is_none_or(|(best, _)| off(promised) < off(best.promised)) {
                best = Some((this, finest));
            }
            if off(promised) < reach || features as f64 >= count {
                break;
            }
        }
        (self.progress)(0.3);
        let (Try { h, .. }, finest) = best.expect("one try at least");
        let settled = self.settled(finest, h)?;
        (self.progress)(1.0);
        Ok(settled)
    }

    /// The scale to try next: between those that promised too few tiles and too many, or beyond the last.
    fn side(&self, count: f64, tried: &[Try]) -> f32 {
        let miss = |tried: &Try| (tried.promised.max(1) as f64 / count).ln();
        // The last ones: the promise jumps, and where nearest ones stay the same, so would the scale between them.
        let latest = |is_many: bool| {
            let found = tried.iter().rev().find(|tried| (miss(tried) > 0.0) == is_many);
            found.map(|tried| (f64::from(tried.h), miss(tried)))
        };
        match ([latest(false), latest(true)], tried.last()) {
            ([Some((large, few)), Some((small, many))], _) if large > small => {
                (small * (large / small).powf(many / (many - few))) as f32
            }
            (_, Some(last)) => last.h * (miss(last) / 2.0).exp() as f32,
            (_, None) => self.field.sizes().side_for_count(self.surface, count.round() as usize),
        }
    }

    /// Tiles at the scale `h`, the finest level not relaxed; their sides differ by up to `tilt` over the surface.
    fn promised(&self, h: f32, tilt: f32) -> Result<Mosaic, ComputeError> {
        let splits = splits(self.surface, self.field.sizes(), f64::from(h), self.effort.solved);
        let finer = 3u32.pow(splits as u32);
        if self.rows == Rows::Continuous {
            return self.woven(h, tilt, finer);
        }
        if self.field.stretch().is_some() {
            return self.crossed(h, tilt, finer);
        }
        let mut mosaic = self.sown(h * finer as f32, tilt, finer)?;
        for split in 1..=splits {
            mosaic = self.settled(mosaic, h * 3f32.powi(splits - split + 1))?;
            mosaic = self.refined(&mosaic, h * 3f32.powi(splits - split));
        }
        Ok(mosaic)
    }

    /// Tiles at the scale `h` where the rows of the periodic solve cross; `finer` times as many rows are made of them later.
    fn sown(&self, h: f32, tilt: f32, finer: u32) -> Result<Mosaic, ComputeError> {
        let (surface, field) = (self.surface, self.field);
        let mut phases = Phases::solve(surface, field, sides(surface, field, h, tilt), self.rows, self.backend)?;
        let row_ends = phases.close(surface, self.rows, finer, self.backend)?;
        let mut tiles = lattice::lattice(surface, field, &phases, h);
        if tiles.is_empty() {
            tiles = sow::sow(surface, field, h);
        }
        let sown = Mosaic::new(surface, field, h, CurveParameters::new(surface, field, &phases), tiles);
        Ok(Mosaic { row_ends: Some(row_ends), ..census::take(surface, field, &sown) })
    }

    /// Tiles of side `h` in rows that pass over the whole surface; `finer` times as many rows as are solved for.
    fn woven(&self, h: f32, tilt: f32, finer: u32) -> Result<Mosaic, ComputeError> {
        let (surface, field) = (self.surface, self.field);
        let mut phases =
            Phases::solve(surface, field, sides(surface, field, h * finer as f32, tilt), self.rows, self.backend)?;
        let row_ends = phases.close(surface, self.rows, finer, self.backend)?;
        phases.multiply(finer);
        let mut chart = Chart::new(surface, &phases);
        let tiles = lattice::woven(surface, field, &phases, &chart, h);
        let woven = Mosaic::new(surface, field, h, CurveParameters::new(surface, field, &phases), tiles);
        let woven = census::thin(&woven, lattice::DOUBLE);
        chart.keep_cones(woven.free());
        Ok(Mosaic { chart: Some(chart), row_ends: Some(row_ends), ..woven })
    }

    /// Rectangular tiles where rows cross, which may end; `finer` times as many rows as are solved for.
    fn crossed(&self, h: f32, tilt: f32, finer: u32) -> Result<Mosaic, ComputeError> {
        let (surface, field) = (self.surface, self.field);
        let mut phases =
            Phases::solve(surface, field, sides(surface, field, h * finer as f32, tilt), self.rows, self.backend)?;
        let row_ends = phases.close(surface, self.rows, finer, self.backend)?;
        phases.multiply(finer);
        let mut tiles = lattice::lattice(surface, field, &phases, h);
        if tiles.is_empty() {
            tiles = sow::sow(surface, field, h);
        }
        let crossed = Mosaic::new(surface, field, h, CurveParameters::new(surface, field, &phases), tiles);
        Ok(Mosaic {
            chart: Some(Chart::of_ways(&phases)),
            row_ends: Some(row_ends),
            ..census::thin(&crossed, census::CROWDED)
        })
    }

    /// Whether tiles are moved after they are laid.
    fn relaxes(&self) -> bool {
        self.rows == Rows::Paper && self.field.stretch().is_none()
    }

    fn refined(&self, coarse: &Mosaic, h: f32) -> Mosaic {
        let free = refine::refine(self.surface, self.field, coarse, h);
        let refined = Mosaic::new(self.surface, self.field, h, coarse.curve_parameters.thirds(), free);
        Mosaic { row_ends: coarse.row_ends, ..census::take(self.surface, self.field, &refined) }
    }

    /// Relaxed in batches, with a census after each; rows that pass over the whole surface, and rectangles, stay as they are.
    fn settled(&self, mut mosaic: Mosaic, h: f32) -> Result<Mosaic, ComputeError> {
        if !self.relaxes() {
            return Ok(mosaic);
        }
        let relaxation = Relaxation::new(self.effort.steps, h, self.field.sizes());
        for _ in 0..self.effort.batches {
            let relaxed = self.ground.relax(&mosaic.tiles, &relaxation)?;
            let is_still = movement(&mosaic.tiles, &relaxed) < STILL;
            mosaic = census::take(self.surface, self.field, &Mosaic { tiles: relaxed, ..mosaic });
            if is_still {
                break;
            }
        }
        Ok(mosaic)
    }
}
