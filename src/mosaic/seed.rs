//! Seeds: tiles spread evenly over the surface, where no rows cross.

use crate::compute::Tile;
use crate::field::Field;
use crate::geometry::scattered;
use crate::surface::Surface;

/// As many free tiles at the scale `h` as the surface takes, at scattered points; the same ones every time.
///
/// Each tile has an equal share of the area, counted in tiles through the triangles in order. The spread is even wherever
/// neighbouring triangles have neighbouring numbers.
pub fn seed(surface: &Surface, field: &Field, h: f32) -> Vec<Tile> {
    let sizes = field.sizes();
    let areas: Vec<f64> = (0..surface.triangle_count()).map(|t| sizes.double_area(surface, t)).collect();
    let total: f64 = areas.iter().sum();
    let count = (total / 2.0 / f64::from(h * h)).round().max(1.0) as u64;
    let mut tiles = Vec::with_capacity(count as usize);
    let (mut triangle, mut passed) = (0, 0.0);
    for i in 0..count {
        let share = total * (i as f64 + 0.5) / count as f64;
        while triangle + 1 < areas.len() && passed + areas[triangle] < share {
            passed += areas[triangle];
            triangle += 1;
        }
        let [mut u, mut v] = [2 * i, 2 * i + 1].map(|number| 0.01 + 0.98 * scattered(number));
        if u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        let [a, b, c] = surface.corners(triangle);
        tiles.push(Tile::free(surface, field, triangle as u32, a + (b - a) * u + (c - a) * v, h));
    }
    tiles
}
