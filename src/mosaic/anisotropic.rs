//! Rectangular tiles, as each other sees them.
//!
//! A tile's `h` is the side of the square with its area. The mosaic holds the factor by which its side along the axis is longer,
//! and its side across the axis shorter.

use super::Mosaic;
use crate::compute::Tile;
use crate::compute::cpu::relax::see;
use crate::field::Field;
use crate::surface::Surface;

/// The side of each tile along its axis over its mean side; empty where tiles are squares.
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

/// The place of a tile that another one sees, along its axis and across, in its sides; `None` where it does not see it. `factor`
/// is that of the seeing tile, `longest` the largest ratio of a longer side to the mean one.
pub(super) fn see_anisotropic(a: &Tile, factor: f32, b: &Tile, longest: f32) -> Option<[f32; 2]> {
    if longest == 1.0 {
        return Some(see(a, b)?.u);
    }
    let wide = |tile: &Tile| Tile { h: tile.h * longest, ..*tile };
    let [u, v] = see(&wide(a), &wide(b))?.u;
    Some([u * longest / factor, v * longest * factor])
}
