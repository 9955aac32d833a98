//! Neighbour lists: the tiles that a free tile may see during some steps.
//!
//! # Theory
//! Verlet lists: a search through the grid finds tiles that are farther off than a tile sees by a skin, so that one search
//! serves several steps. A tile that comes nearer than the skin allows is seen from the next search on.
//!
//! # Practice
//! `LIST_STEPS` and the lists' length: docs/experiments.md, mosaic.

use super::grid::Grid;
use crate::compute::{LIST_LENGTH, REACH, SKIN, Tile};
use crate::geometry::dot;
use crate::surface::NONE;
use rayon::prelude::*;

/// The tiles near each free tile, in the grid's order and ended by [`NONE`]. Tiles on features have empty lists.
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

/// Whether a tile may be seen within some steps: it is near, and faces the same way.
fn is_near(a: &Tile, b: &Tile) -> bool {
    let reach = (REACH + SKIN) * ((a.h + b.h) * 0.5);
    let e = b.at() - a.at();
    dot(e, e) <= reach * reach && dot(a.normal(), b.normal()) > 0.0
}
