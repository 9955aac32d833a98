//! Neighbour lists: the tiles that a free tile may see during some steps; the twin of `shaders/neighbours.wgsl`.
//!
//! # Theory
//! Verlet's lists: a search through the grid finds tiles a little further off than a tile sees, by a skin, so that one
//! search serves several steps. What comes nearer than the skin allows is seen from the next search on.
//!
//! # Practice
//! In a first step tiles move by 0.05 sides (median; one in a hundred by 0.15), in later ones by a few thousandths: lists
//! made anew every step, every four steps and every eight gave meshes of the same quality (nine models at 6,000 tiles).
//! Tiles in rows have eight neighbours within reach and skin: the four that are two sides away are past it.

use super::grid::Grid;
use crate::compute::{LIST_LENGTH, REACH, SKIN, Tile};
use crate::geometry::dot;
use crate::surface::NONE;
use rayon::prelude::*;

/// For each tile, what the grid has near it, in the grid's order and ended by [`NONE`]. Tiles on features have none.
pub fn lists(tiles: &[Tile], cell: f32) -> Vec<[u32; LIST_LENGTH]> {
    let grid = Grid::build(|i| tiles[i].position, tiles.len(), cell);
    (0..tiles.len()).into_par_iter().with_min_len(256).map(|id| list(tiles, &grid, id)).collect()
}

fn list(tiles: &[Tile], grid: &Grid, id: usize) -> [u32; LIST_LENGTH] {
    let mut list = [NONE; LIST_LENGTH];
    let mut length = 0;
    let tile = &tiles[id];
    if tile.quarters == 0 {
        grid.around(tile.position, |other| {
            if length < LIST_LENGTH && other as usize != id && is_near(tile, &tiles[other as usize]) {
                list[length] = other;
                length += 1;
            }
        });
    }
    list
}

/// Whether a tile may come to be seen within some steps: it is near, and faces the same way.
fn is_near(a: &Tile, b: &Tile) -> bool {
    let reach = (REACH + SKIN) * ((a.h + b.h) * 0.5);
    let e = b.at() - a.at();
    dot(e, e) <= reach * reach && dot(a.normal(), b.normal()) > 0.0
}
