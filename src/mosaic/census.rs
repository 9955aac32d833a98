//! Between batches of relaxation: one of two tiles that overlap goes, and a tile comes where a place is empty.

use super::grid::Grid;
use super::relax::{self, see};
use super::{Mosaic, Tile};
use crate::field::Field;
use crate::geometry::dot;
use crate::surface::{Surface, WALK_EDGES, walk};

/// Two tiles nearer than this along both axes, in tile sides, are one too many.
const CROWDED: f32 = 0.55;
/// A place is empty where no tile lies within this, in tile sides.
const EMPTY: f32 = 0.72;
/// A tile whose normal is turned by more than the angle of this cosine lies on the other side of a thin part. On rough
/// surfaces normals differ by less than that between tiles that do take each other's place.
const OTHER_SIDE: f32 = -0.5;

/// Removes tiles where they crowd and adds tiles where there is room, in the order of ids.
pub fn take(surface: &Surface, field: &Field, mosaic: &Mosaic) -> Mosaic {
    let tiles = thin(mosaic, CROWDED);
    let mut result = Mosaic { tiles, ..mosaic.clone() };
    let more = room(surface, field, &result);
    result.tiles.extend(more);
    result
}

fn cell_of(tiles: &[Tile]) -> f32 {
    relax::cell(tiles.iter().map(|t| t.h).fold(0.0, f32::max))
}

pub(super) fn thin(mosaic: &Mosaic, crowded_within: f32) -> Vec<Tile> {
    let tiles = &mosaic.tiles;
    let grid = Grid::build(|i| tiles[i].position, tiles.len(), cell_of(tiles));
    let mut kept = vec![true; tiles.len()];
    for id in mosaic.sides..tiles.len() {
        let mut crowded = false;
        grid.around(tiles[id].position, |other| {
            crowded |= (other as usize) < id
                && kept[other as usize]
                && see(&tiles[id], &tiles[other as usize])
                    .is_some_and(|s| s.u[0].abs() < crowded_within && s.u[1].abs() < crowded_within);
        });
        kept[id] = !crowded;
    }
    tiles.iter().zip(kept).filter(|&(_, kept)| kept).map(|(&tile, _)| tile).collect()
}

/// Tiles at the empty places beside the present ones.
fn room(surface: &Surface, field: &Field, mosaic: &Mosaic) -> Vec<Tile> {
    let tiles = &mosaic.tiles;
    let barrier = |h| surface.features().is_feature(h);
    let grid = Grid::build(|i| tiles[i].position, tiles.len(), cell_of(tiles));
    let candidates: Vec<Tile> = tiles
        .iter()
        .flat_map(|tile| inner_directions(tile).map(move |turn| (tile, turn)))
        .filter(|(tile, turn)| {
            let wanted = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0f32]][*turn as usize % 4];
            let mut taken = false;
            grid.around(tile.position, |other| {
                taken |= see(tile, &tiles[other as usize])
                    .is_some_and(|s| (s.u[0] - wanted[0]).abs() < 0.5 && (s.u[1] - wanted[1]).abs() < 0.5);
            });
            !taken
        })
        .map(|(tile, turn)| {
            let foot = walk(surface, barrier, tile.triangle, tile.at(), tile.direction(turn) * tile.h, WALK_EDGES);
            Tile::free(surface, field, foot.triangle, foot.position, tile.h)
        })
        .collect();
    let all: Vec<Tile> = tiles.iter().chain(&candidates).copied().collect();
    let grid = Grid::build(|i| all[i].position, all.len(), cell_of(tiles));
    let mut present: Vec<bool> = (0..all.len()).map(|i| i < tiles.len()).collect();
    for id in tiles.len()..all.len() {
        let mut free = true;
        grid.around(all[id].position, |other| {
            free &= !present[other as usize] || !takes_place(&all[id], &all[other as usize]);
        });
        present[id] = free;
    }
    (tiles.len()..all.len()).filter(|&i| present[i]).map(|i| all[i]).collect()
}

fn takes_place(place: &Tile, tile: &Tile) -> bool {
    let apart = tile.at() - place.at();
    dot(apart, apart) < (EMPTY * place.h) * (EMPTY * place.h) && dot(place.normal(), tile.normal()) > OTHER_SIDE
}

/// The turns of a tile's cross that point into the surface on its side.
fn inner_directions(tile: &Tile) -> std::ops::Range<u32> {
    if tile.quarters == 0 { 0..4 } else { 1..tile.quarters }
}
