//! Tiles as faces of a mesh.

use crate::mesh::Mesh;
use crate::mosaic::Mosaic;
use crate::mosaic::quarters::Quarter;
use crate::surface::Surface;

/// The tiles of a mosaic as faces of a mesh in model units, each with vertices of its own, and the number of each face's tile.
///
/// Faces are in the order of the tiles; the sides of tiles on features that have no quarter are left out.
///
/// `grout` is the share of a tile's side that is left free between it and its neighbour.
pub fn tile_mesh(surface: &Surface, mosaic: &Mosaic, grout: f32) -> (Mesh, Vec<u32>) {
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
    use crate::mosaic::quarters::quarter_count;
    use crate::mosaic::{CurveParameters, Tile};
    use crate::surface::FeatureOptions;
    use crate::surface::examples::Example;
    use glam::{DVec3, Vec3};

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
        let (mesh, tiles) = tile_mesh(&surface, &mosaic, 0.2);
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
        let (mesh, tiles) = tile_mesh(&surface, &mosaic, 0.0);
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
