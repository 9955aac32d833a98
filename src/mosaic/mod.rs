//! The mosaic: equal square tiles in straight rows, on features, at the asked count.
//!
//! # Theory
//! After Lai, Hu and Martin's surface mosaics (the paper's references 1 and 2): square tiles of one size cover the surface, turned
//! along the cross field, and are relaxed by a repulsion that is square as they are.
//!
//! # Changes versus the paper
//! The paper relaxes random tiles at their final size. Here tiles lie on the integer grid of a
//! [parametrization](crate::parametrize), in step over the whole surface, and are relaxed on coarse levels: each is then split into
//! three by three ([`refine`]). Tiles on features are placed along the feature curves ([`feature_samples`]) and do not move; each
//! side of a crease sees its own tiles. Where rows are continuous, or tiles are rectangles
//! ([`Stretch`](crate::field::Stretch)), tiles keep the places of the grid and are not relaxed.
//!
//! # Practice
//! Order of work: the parametrization; [`feature_samples`]; the integer grid; [`insert_delete`]; relaxation; [`refine`]. Where no
//! row crosses another, as on a part of the size of a tile, [`seed`] places the tiles. The scale is searched until the count is
//! right.
//!
//! Variants that were measured: docs/experiments.md, mosaic.

pub(crate) mod anisotropic;
mod builder;
mod count_search;
pub mod feature_samples;
pub mod insert_delete;
pub mod quality;
pub mod quarters;
pub mod refine;
pub mod seed;
mod tile;

pub use crate::compute::Tile;
pub use builder::{Effort, MosaicBuilder, longest_edges};
pub use feature_samples::{CurveParameters, FeaturePoint, FeatureSample};

use crate::field::Field;
use crate::parametrize::{Distortion, GridMetric, RowEnds};
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
    /// The number of vertices that the mesh is to have.
    pub wanted: usize,
    /// The number of tiles that were aimed at for it.
    pub aimed: usize,
    pub(crate) curve_parameters: CurveParameters,
    /// See [`Mosaic::factor`]; empty where tiles are squares.
    pub(crate) factors: Vec<f32>,
    /// The metric in which the tiles are unit squares, where rows are continuous or tiles are rectangles.
    pub(crate) metric: Option<GridMetric>,
    /// The ends of rows of the parametrization.
    pub row_ends: Option<RowEnds>,
    /// The distortion of the parametrization, where rows are continuous.
    pub distortion: Option<Distortion>,
}

/// The cost of a distortion from which on rows fold so much that others are tried (docs/experiments.md, parametrization).
const FOLDED: f64 = 0.1;

impl Mosaic {
    /// The free tiles.
    pub fn free(&self) -> &[Tile] {
        &self.tiles[self.sides..]
    }

    /// A tile on a feature as each side of the feature sees it.
    pub(crate) fn sides_of(&self, sample: usize) -> &[Tile] {
        let first = self.feature_samples[sample].first_side as usize;
        &self.tiles[first..self.feature_samples.get(sample + 1).map_or(self.sides, |next| next.first_side as usize)]
    }

    /// The number of tiles, those of several sheets at one place counted once: vertices of the mesh to come.
    pub fn count(&self) -> usize {
        let own = (0..).zip(&self.feature_samples).filter(|(id, sample)| sample.same_place == *id).count();
        own + self.free().len()
    }

    /// The cost of the distortion of continuous rows; 0 for others.
    pub(crate) fn cost(&self) -> f64 {
        self.distortion.map_or(0.0, |distortion| distortion.cost(self.count()))
    }

    /// Whether continuous rows fold so much that others may be better.
    pub(crate) fn is_folded(&self) -> bool {
        self.cost() > FOLDED
    }

    /// Tiles on the features at the scale `h`, and these free tiles.
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
        Self {
            feature_samples,
            tiles,
            sides,
            scale: h,
            wanted: 0,
            aimed: 0,
            curve_parameters,
            factors,
            metric: None,
            row_ends: None,
            distortion: None,
        }
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
