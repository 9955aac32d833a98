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
//! Order of work: [`phases`], [`feature_samples`] tiles on features, [`lattice`], [`insert_delete`] (remove and add), [`relax`], [`refine`];
//! where no row crosses another, as on a part of the size of a tile, [`seed`].
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

pub(crate) mod anisotropic;
mod builder;
mod count_search;
pub mod feature_samples;
pub mod fit;
pub mod insert_delete;
pub mod quarters;
pub mod refine;
pub mod seed;
mod tile;

pub use crate::compute::Tile;
pub use builder::{Effort, MosaicBuilder, longest_edges};
pub use feature_samples::{CurveParameters, FeaturePoint, FeatureSample};

use crate::field::Field;
use crate::parametrize::{GridMetric, RowEnds};
use crate::sizes::Sizes;
use crate::surface::Surface;

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
    pub(crate) metric: Option<GridMetric>,
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
        let factors = anisotropic::factors(surface, field, &tiles);
        Self { feature_samples, tiles, sides, scale: h, curve_parameters, factors, metric: None, row_ends: None }
    }
}

/// The number of equal tiles of side `h`, unit-sized, that a surface takes: the inverse of [`side_for_count`].
pub fn count_for_side(surface: &Surface, h: f64) -> f64 {
    Sizes::equal().count_for_side(surface, h)
}

/// The side of `count` equal tiles, unit-sized.
pub fn side_for_count(surface: &Surface, count: usize) -> f32 {
    Sizes::equal().side_for_count(surface, count)
}
