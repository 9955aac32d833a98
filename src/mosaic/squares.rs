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

/// The squares of a mosaic as faces, in model units, each with vertices of its own: in the order of the tiles, those sides of
/// features that have no room left out. Of each face also the number of its tile.
///
/// `grout` is the share of a tile's side that is left free between it and its neighbour.
pub fn squares(surface: &Surface, mosaic: &Mosaic, grout: f32) -> (Mesh, Vec<u32>) {
    let outlines: Vec<Vec<[f32; 3]>> =
        mosaic.quarters(surface, 1.0 - grout).iter().map(|quarters| outline(quarters)).collect();
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compute::Cpu;
    use crate::field::{Field, FieldOptions};
    use crate::mosaic::feature_samples::CurveParameters;
    use crate::surface::FeatureOptions;
    use crate::surface::examples::Example;
    use glam::DVec3;

    /// Twice the area of a face, as a vector along its normal.
    fn area(mesh: &Mesh, face: &[u32]) -> DVec3 {
        let places: Vec<DVec3> = face.iter().map(|&v| mesh.points[v as usize].into()).collect();
        (1..places.len() - 1).map(|k| (places[k] - places[0]).cross(places[k + 1] - places[0])).sum()
    }

    /// The tiles on the features of a block, and some in the middle of its triangles.
    fn block() -> (Surface, Mosaic, f32) {
        let surface = Surface::new(&Example::Block.generate(2_000), &FeatureOptions::default());
        let surface = surface.unwrap_or_else(|error| panic!("{error}"));
        let field = Field::new(&surface, &FieldOptions::default(), &Cpu).unwrap_or_else(|error| panic!("{error}"));
        let h = (0.1 / surface.frame().diagonal) as f32;
        let free = (0..surface.triangle_count()).step_by(50).map(|triangle| {
            let middle = surface.corners(triangle).iter().sum::<Vec3>() / 3.0;
            Tile::free(&surface, &field, triangle as u32, middle, h)
        });
        let mosaic = Mosaic::new(&surface, &field, h, CurveParameters::default(), free.collect::<Vec<_>>());
        (surface, mosaic, h)
    }

    #[test]
    fn tiles_on_features_are_laid_on_each_side_and_do_not_pass_them() {
        let (surface, mosaic, _) = block();
        let (mesh, tiles) = squares(&surface, &mosaic, 0.2);
        assert_eq!(tiles.len(), mesh.face_count());
        assert!(mosaic.sides > 100 && mosaic.free().len() > 20);
        let mut whole = 0;
        for (face, &tile) in mesh.faces().zip(&tiles) {
            let tile = &mosaic.tiles[tile as usize];
            // The block's flat sides; the bore is round.
            if tile.normal.iter().any(|x| x.abs() > 0.999)
                && face.iter().all(|&v| {
                    let [x, y, _] = mesh.points[v as usize];
                    x.hypot(y) > 0.8
                })
            {
                let share = f64::from(quarter_count(tile)) / 4.0;
                let expected = 2.0 * share * 0.08 * 0.08;
                let found = area(&mesh, face).dot(tile.normal().as_dvec3());
                // Those that meet an edge of the block are bent along it.
                whole += usize::from((found - expected).abs() < 1e-4 * expected);
                assert!(found > -1e-9 && found < 1.001 * expected, "{found} {expected}");
                assert!(face.iter().all(|&v| {
                    let way = DVec3::from(mesh.points[v as usize]) - DVec3::from(mesh.points[face[0] as usize]);
                    way.dot(tile.normal().as_dvec3()).abs() < 1e-6
                }));
            }
        }
        assert!(whole > 100, "{whole} squares have their full area");
    }

    #[test]
    fn a_corner_has_a_quarter_and_a_straight_edge_a_half() {
        let (surface, mosaic, _) = block();
        let (mesh, tiles) = squares(&surface, &mosaic, 0.0);
        for (face, &tile) in mesh.faces().zip(&tiles) {
            let sides = match mosaic.tiles[tile as usize].quarters {
                3 => 6,
                _ => 4,
            };
            assert_eq!(face.len(), sides);
        }
        let of = |quarters| mosaic.tiles[..mosaic.sides].iter().filter(|tile| tile.quarters == quarters).count();
        assert_eq!(of(1), 24, "a box has 8 corners, each of three sides");
        assert!(of(2) > 100);
    }
}
