//! Rectangular tiles, as each other sees them.
//!
//! A tile's `h` is the mean of its two sides, as of a square with its area; what it is longer by along its axis, and shorter
//! across, the mosaic knows.

use super::Mosaic;
use crate::compute::Tile;
use crate::compute::cpu::relax::see;
use crate::field::Field;
use crate::surface::Surface;

/// By what the side of each tile along its axis is longer than its mean side; nothing where tiles are squares.
pub(crate) fn factors(surface: &Surface, field: &Field, tiles: &[Tile]) -> Vec<f32> {
    let Some(stretch) = field.stretch() else { return Vec::new() };
    tiles.iter().map(|tile| stretch.factor(surface, tile.triangle, tile.at(), tile.axis.into())).collect()
}

impl Mosaic {
    /// The side of a tile along its axis over its mean side: 1 for a square, below 1 where the axis is the shorter one.
    pub fn factor(&self, tile: usize) -> f32 {
        self.factors.get(tile).copied().unwrap_or(1.0)
    }

    /// The largest ratio of a tile's longer side to its mean one.
    pub(super) fn longest(&self) -> f32 {
        self.factors.iter().map(|factor| factor.max(1.0 / factor)).fold(1.0, f32::max)
    }
}

/// Where a tile sees another, along its axis and across, in its sides; `None` where it does not. `factor` is the tile's,
/// `longest` the largest ratio of a longer side to the mean one.
pub(super) fn see_anisotropic(a: &Tile, factor: f32, b: &Tile, longest: f32) -> Option<[f32; 2]> {
    if longest == 1.0 {
        return Some(see(a, b)?.u);
    }
    let wide = |tile: &Tile| Tile { h: tile.h * longest, ..*tile };
    let [u, v] = see(&wide(a), &wide(b))?.u;
    Some([u * longest / factor, v * longest * factor])
}
