//! Insertion and deletion between batches of relaxation: of two tiles that overlap one is deleted, and at empty lattice points
//! tiles are inserted.

use super::Mosaic;
use super::anisotropic::see_anisotropic;
use crate::compute::cpu::grid::Grid;
use crate::compute::cpu::relax::{Sight, see};
use crate::compute::{Tile, cell};
use crate::field::Field;
use crate::geometry::dot;
use crate::progress::IsCancelled;
use crate::surface::{Surface, WALK_EDGES, walk};
use rayon::prelude::*;

/// Two tiles nearer than this along both axes, in tile sides, are one too many.
pub(super) const CROWDED: f32 = 0.55;
/// A lattice point is empty where no tile lies within this, in tile sides.
const EMPTY: f32 = 0.72;
/// Tiles whose normals have a smaller cosine lie on opposite sides of a thin part. On rough surfaces the cosine between tiles at
/// one lattice point is larger.
const OTHER_SIDE: f32 = -0.5;

/// Deletes crowded tiles, then inserts tiles at empty lattice points, in the order of ids.
pub fn insert_and_delete(surface: &Surface, field: &Field, mosaic: &Mosaic) -> Mosaic {
    let mut result = delete_crowded(mosaic, CROWDED, &|| false);
    let more = at_empty_points(surface, field, &result);
    result.tiles.extend(more);
    result
}

fn cell_of(tiles: &[Tile]) -> f32 {
    cell(tiles.iter().map(|t| t.h).fold(0.0, f32::max))
}

/// The mosaic without the tiles that have an earlier one within `crowded_within` along both axes, in tile sides.
pub(super) fn delete_crowded(mosaic: &Mosaic, crowded_within: f32, is_cancelled: &IsCancelled) -> Mosaic {
    let tiles = &mosaic.tiles;
    let longest = mosaic.longest();
    let grid = Grid::build(|i| tiles[i].position, tiles.len(), longest * cell_of(tiles));
    let crowding: Vec<Vec<u32>> = (0..tiles.len())
        .into_par_iter()
        .with_min_len(256)
        .map(|id| {
            let mut others = Vec::new();
            if id >= mosaic.sides && !is_cancelled() {
                grid.around(tiles[id].position, |other| {
                    let crowds = (other as usize) < id
                        && see_anisotropic(&tiles[id], mosaic.factor(id), &tiles[other as usize], longest)
                            .is_some_and(|u| u[0].abs() < crowded_within && u[1].abs() < crowded_within);
                    others.extend(crowds.then_some(other));
                });
            }
            others
        })
        .collect();
    let kept = chosen(&crowding);
    Mosaic { tiles: chosen_of(tiles, &kept), factors: chosen_of(&mosaic.factors, &kept), ..mosaic.clone() }
}

fn chosen_of<T: Copy>(all: &[T], chosen: &[bool]) -> Vec<T> {
    all.iter().zip(chosen).filter(|&(_, chosen)| *chosen).map(|(&one, _)| one).collect()
}

/// A greedy independent set, in order: each is chosen that meets none of those chosen before it.
fn chosen(meets: &[Vec<u32>]) -> Vec<bool> {
    let mut chosen = vec![true; meets.len()];
    for (id, others) in meets.iter().enumerate() {
        chosen[id] = !others.iter().any(|&other| chosen[other as usize]);
    }
    chosen
}

/// Tiles at the empty lattice points beside the present tiles.
fn at_empty_points(surface: &Surface, field: &Field, mosaic: &Mosaic) -> Vec<Tile> {
    let tiles = &mosaic.tiles;
    let barrier = |h| surface.features().is_feature(h);
    let grid = Grid::build(|i| tiles[i].position, tiles.len(), cell_of(tiles));
    let candidates: Vec<Tile> = tiles
        .par_iter()
        .with_min_len(256)
        .flat_map_iter(|tile| empty_directions(tile, tiles, &grid).map(move |turn| (tile, turn)))
        .map(|(tile, turn)| {
            let foot = walk(surface, barrier, tile.triangle, tile.at(), tile.direction(turn) * tile.h, WALK_EDGES);
            Tile::free(surface, field, foot.triangle, foot.position, mosaic.scale)
        })
        .filter(|place| {
            let mut empty = true;
            grid.around(place.position, |other| empty &= !takes_place(place, &tiles[other as usize]));
            empty
        })
        .collect();
    let grid = Grid::build(|i| candidates[i].position, candidates.len(), cell_of(tiles));
    let rivals: Vec<Vec<u32>> = (0..candidates.len())
        .into_par_iter()
        .with_min_len(256)
        .map(|id| {
            let mut rivals = Vec::new();
            grid.around(candidates[id].position, |other| {
                let rival = (other as usize) < id && takes_place(&candidates[id], &candidates[other as usize]);
                rivals.extend(rival.then_some(other));
            });
            rivals
        })
        .collect();
    chosen_of(&candidates, &chosen(&rivals))
}

/// The turns of a tile's cross that point into the surface on its side and to an empty lattice point.
fn empty_directions(tile: &Tile, tiles: &[Tile], grid: &Grid) -> impl Iterator<Item = u32> + use<> {
    let mut empty = [true; 4];
    grid.around(tile.position, |other| {
        if let Some(Sight { u, .. }) = see(tile, &tiles[other as usize]) {
            for (empty, wanted) in empty.iter_mut().zip([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0f32]]) {
                *empty &= (u[0] - wanted[0]).abs() >= 0.5 || (u[1] - wanted[1]).abs() >= 0.5;
            }
        }
    });
    let inner = if tile.quarters == 0 { 0..4 } else { 1..tile.quarters };
    inner.filter(move |&turn| empty[turn as usize % 4])
}

fn takes_place(place: &Tile, tile: &Tile) -> bool {
    let apart = tile.at() - place.at();
    dot(apart, apart) < (EMPTY * place.h) * (EMPTY * place.h) && dot(place.normal(), tile.normal()) > OTHER_SIDE
}
