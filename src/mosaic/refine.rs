//! Refinement: each tile of a coarse mosaic becomes three by three of a third of its side.
//!
//! The middle one of the nine keeps its parent's place, so that rows on features stay there.

use super::Mosaic;
use crate::compute::Tile;
use crate::field::Field;
use crate::surface::{Surface, WALK_EDGES, walk};
use rayon::prelude::*;

/// The free tiles at the scale `h` into which the mosaic's tiles split; those on features split towards the inside.
pub fn refine(surface: &Surface, field: &Field, mosaic: &Mosaic, h: f32) -> Vec<Tile> {
    mosaic
        .tiles
        .par_iter()
        .flat_map_iter(|tile| {
            let side = h * field.sizes().at(surface, tile.triangle, tile.at());
            places(tile).map(move |[x, y]| {
                let way = (tile.direction(0) * x + tile.direction(1) * y) * side;
                let barrier = |e| surface.features().is_feature(e);
                let foot = walk(surface, barrier, tile.triangle, tile.at(), way, WALK_EDGES);
                Tile::free(surface, field, foot.triangle, foot.position, h)
            })
        })
        .collect()
}

/// The places of a tile's children that are free, in the children's sides along the tile's axes.
fn places(tile: &Tile) -> impl Iterator<Item = [f32; 2]> {
    let quarters = tile.quarters;
    let all = [[0, 0], [1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0], [-1, -1], [0, -1], [1, -1]];
    // Counted in eighths of a turn from the axis; a side of `quarters` has those strictly inside.
    all.into_iter().enumerate().filter_map(move |(i, [x, y])| {
        let inside = quarters == 0 || (i >= 2 && i as u32 - 1 < 2 * quarters) || (i == 1 && quarters > 4);
        inside.then_some([x as f32, y as f32])
    })
}
