//! Tiles as squares laid on the surface.
//!
//! # Practice
//! A place of a square is found by walking there from the tile's centre, so that squares bend with the surface and do not
//! pass features. The side of a tile on a feature has as many quarters of a square as it has quarter turns.

use super::{Mosaic, Tile};
use crate::mesh::Mesh;
use crate::surface::{Surface, WALK_EDGES, walk};
use glam::Vec3;
use rayon::prelude::*;

/// The places of a quarter of a square, counter-clockwise: the tile's centre, the middle of a side, a corner, the middle of
/// the next side; in unit-sized coordinates.
pub type Quarter = [[f32; 3]; 4];

/// The quarters of a tile's square; its sides are `share` of the tile's.
pub fn quarters(surface: &Surface, tile: &Tile, share: f32) -> Vec<Quarter> {
    let half = tile.h * share / 2.0;
    let count = quarter_count(tile);
    let barrier = |h: u32| surface.features().is_feature(h);
    let place =
        |way: Vec3| walk(surface, barrier, tile.triangle, tile.at(), way * half, WALK_EDGES).position.to_array();
    let middles: Vec<[f32; 3]> = (0..=count.min(3)).map(|turn| place(tile.direction(turn))).collect();
    let corner = |turn: u32| place(tile.direction(turn) + tile.direction(turn + 1));
    let middle = |turn: u32| middles[turn as usize % middles.len()];
    (0..count).map(|turn| [tile.position, middle(turn), corner(turn), middle(turn + 1)]).collect()
}

/// The squares of a mosaic as faces, in model units, each with vertices of its own: in the order of the tiles, those sides of
/// features that have no room left out. Of each face also the number of its tile.
///
/// `grout` is the share of a tile's side that is left free between it and its neighbour.
pub fn squares(surface: &Surface, mosaic: &Mosaic, grout: f32) -> (Mesh, Vec<u32>) {
    let outlines: Vec<Vec<[f32; 3]>> =
        mosaic.tiles.par_iter().map(|tile| outline(&quarters(surface, tile, 1.0 - grout))).collect();
    let points = outlines.iter().flatten().map(|&place| place.map(f64::from)).collect();
    let mut mesh = Mesh::new(points);
    let mut tiles = Vec::with_capacity(outlines.len());
    let mut first = 0;
    for (tile, outline) in (0..).zip(&outlines) {
        let next = first + outline.len() as u32;
        if next > first {
            mesh.push_face(&(first..next).collect::<Vec<u32>>());
            tiles.push(tile);
        }
        first = next;
    }
    (mesh.placed(surface.frame()), tiles)
}

/// How many quarters of its square a tile has.
pub(super) fn quarter_count(tile: &Tile) -> u32 {
    if tile.quarters == 0 { 4 } else { tile.quarters.min(4) }
}

/// The border of all quarters of a square.
fn outline(quarters: &[Quarter]) -> Vec<[f32; 3]> {
    let corners = quarters.iter().map(|quarter| quarter[2]);
    match quarters {
        [] => Vec::new(),
        [_, _, _, _] => corners.collect(),
        // The centre is on the straight side between the two.
        [first, second] => [first[1]].into_iter().chain(corners).chain([second[3]]).collect(),
        [first, ..] => {
            let last = quarters[quarters.len() - 1];
            [first[0], first[1]].into_iter().chain(corners).chain([last[3]]).collect()
        }
    }
}
