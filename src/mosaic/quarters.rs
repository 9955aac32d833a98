//! Tiles as quarters of squares laid on the surface.
//!
//! # Practice
//! A point of a square is found by walking there from the tile's centre, so that squares bend with the surface and do not
//! pass features. The side of a tile on a feature has as many quarters of a square as it has quarter turns.

use super::Mosaic;
use crate::compute::Tile;
use crate::surface::{Surface, WALK_EDGES, walk};
use glam::Vec3;
use rayon::prelude::*;

/// The places of a quarter of a square, counter-clockwise: the tile's centre, the middle of a side, a corner, the middle of
/// the next side; in unit-sized coordinates.
pub type Quarter = [[f32; 3]; 4];

/// The quarters of a tile's square, or rectangle, its side along its axis being `factor` times its mean one; the sides are
/// `share` of the tile's.
pub fn quarters(surface: &Surface, tile: &Tile, factor: f32, share: f32) -> Vec<Quarter> {
    let half = tile.h * share / 2.0;
    let count = quarter_count(tile);
    let barrier = |h: u32| surface.features().is_feature(h);
    let place =
        |way: Vec3| walk(surface, barrier, tile.triangle, tile.at(), way * half, WALK_EDGES).position.to_array();
    let arm = |turn: u32| tile.direction(turn) * if turn.is_multiple_of(2) { factor } else { 1.0 / factor };
    let middles: Vec<[f32; 3]> = (0..=count.min(3)).map(|turn| place(arm(turn))).collect();
    let corner = |turn: u32| place(arm(turn) + arm(turn + 1));
    let middle = |turn: u32| middles[turn as usize % middles.len()];
    (0..count).map(|turn| [tile.position, middle(turn), corner(turn), middle(turn + 1)]).collect()
}

impl Mosaic {
    /// The [`quarters`] of each tile.
    pub fn quarters(&self, surface: &Surface, share: f32) -> Vec<Vec<Quarter>> {
        let of = |(i, tile): (usize, &Tile)| quarters(surface, tile, self.factor(i), share);
        self.tiles.par_iter().enumerate().map(of).collect()
    }
}

/// How many quarters of its square a tile has.
pub(crate) fn quarter_count(tile: &Tile) -> u32 {
    if tile.quarters == 0 { 4 } else { tile.quarters.min(4) }
}
