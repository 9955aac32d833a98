//! How tiles are made.

use crate::compute::Tile;
use crate::field::Field;
use crate::parametrize::integer_grid::GridPoint;
use crate::surface::Surface;
use glam::Vec3;

impl Tile {
    /// A free tile at a point of a triangle, turned along the field; `h` is the scale of its sizes.
    pub(crate) fn free(surface: &Surface, field: &Field, triangle: u32, position: Vec3, h: f32) -> Self {
        let side = h * field.sizes().at(surface, triangle, position);
        Self::on_grid(surface, field, &GridPoint { triangle, position, side })
    }

    /// A free tile at a point of the integer grid, turned along the field.
    pub(super) fn on_grid(surface: &Surface, field: &Field, point: &GridPoint) -> Self {
        let &GridPoint { triangle, position, side } = point;
        Self {
            position: position.into(),
            h: side,
            normal: surface.normal(triangle as usize).into(),
            triangle,
            axis: field.axis(surface, triangle, position).into(),
            quarters: 0,
        }
    }
}
