//! The plane about which a surface is symmetric, and how far its mirror image is from it.
//!
//! # Theory
//! A mirror image is as far from the surface as the surface is from the image, so one direction is measured: from the images of the
//! surface's vertices, and of points spread evenly over it, to the surface.
//!
//! # Practice
//! A plane is looked for across the axes x, y and z: through the origin, the middle of the bounding box and the centre of area. Where
//! the surface is symmetric about none of them, its principal axes of inertia through the centre of area are tried: a plane of symmetry
//! lies across one of them. Where two of its moments are equal, as those of a turned cube, these axes are arbitrary and none may be found.

use super::{Axis, Plane, SymmetryError};
use crate::surface::Surface;
use crate::surface::nearest::Triangles;
use crate::surface::sampling::sample_evenly;
use glam::{DMat3, DVec3};
use rayon::prelude::*;
use serde::Serialize;

/// The largest distance between a surface and its mirror image, in sides of tiles, with which a plane is found.
pub const SYMMETRIC: f64 = 0.5;
/// A distance above this, in sides of tiles, is a warning.
pub const NEARLY: f64 = 0.1;
/// Planes whose distances differ by less, in diagonals, are equally good.
const SAME: f64 = 1e-6;
/// The points that are spread over the surface: two a tile, within these bounds.
const SPREAD: std::ops::RangeInclusive<usize> = 2_000..=50_000;
/// Of all points so many are enough to choose a plane.
const FEW: usize = 2_000;

/// The largest distance of a surface's mirror image from the surface.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Asymmetry {
    /// In model units.
    pub distance: f64,
    /// In sides of tiles.
    pub tiles: f64,
    /// Its place on the image, in model units.
    pub at: [f64; 3],
}

/// A surface as its mirror images are compared with it, in unit-sized coordinates.
pub(crate) struct Comparison<'a> {
    surface: &'a Surface,
    triangles: Triangles,
    points: Vec<DVec3>,
    /// The side of a tile.
    side: f64,
}

impl<'a> Comparison<'a> {
    /// For tiles of a side, unit-sized.
    pub fn new(surface: &'a Surface, side: f64) -> Self {
        let tiles = surface.area() / (side * side);
        let spread = ((2.0 * tiles) as usize).clamp(*SPREAD.start(), *SPREAD.end());
        let step = surface.vertex_count().div_ceil(*SPREAD.end());
        let vertices = (0..surface.vertex_count() as u32).step_by(step).map(|v| DVec3::from(surface.point(v)));
        let spread = sample_evenly(surface, spread);
        let points = vertices.chain(spread.iter().map(|point| point.position.as_dvec3())).collect();
        Self { surface, triangles: Triangles::new(surface), points, side }
    }

    /// The asymmetry about a plane.
    pub fn about(&self, plane: Plane) -> Asymmetry {
        self.of_each(plane, 1)
    }

    /// The plane about which the surface is symmetric.
    ///
    /// # Errors
    /// Where there is none.
    pub fn find(&self) -> Result<(Plane, Asymmetry), SymmetryError> {
        let (centre, axes) = self.principal_axes();
        let places = [[0.0; 3], self.surface.frame().centre, centre];
        let across = |axis: Axis| places.map(|place| Plane { axis, offset: axis.along(place) });
        let straight = self.best(Axis::ALL.into_iter().flat_map(across));
        // An oblique plane costs the exact images: it is a last resort.
        let (plane, found) = if straight.1.tiles <= SYMMETRIC {
            straight
        } else {
            let oblique = self.best(axes.into_iter().map(|axis| Plane { axis, offset: axis.along(centre) }));
            if oblique.1.tiles < straight.1.tiles { oblique } else { straight }
        };
        if found.tiles <= SYMMETRIC {
            return Ok((plane, found));
        }
        let limit = SYMMETRIC * self.side * self.surface.frame().diagonal;
        Err(SymmetryError::NoPlane { plane, distance: found.distance, at: found.at, limit })
    }

    /// The plane of the least asymmetry, the first one of equals.
    fn best(&self, planes: impl Iterator<Item = Plane>) -> (Plane, Asymmetry) {
        let step = self.points.len().div_ceil(FEW);
        let mut best: Option<(Plane, f64)> = None;
        for plane in planes {
            let distance = self.of_each(plane, step).distance;
            if best.is_none_or(|best| distance < best.1 - SAME * self.surface.frame().diagonal) {
                best = Some((plane, distance));
            }
        }
        let plane = best.map_or(Plane { axis: Axis::X, offset: 0.0 }, |best| best.0);
        (plane, self.about(plane))
    }

    /// The centre of area, in model units, and the principal axes of inertia of the surface, a sheet of equal mass.
    fn principal_axes(&self) -> ([f64; 3], [Axis; 3]) {
        let frame = self.surface.frame();
        let (mut area, mut first, mut second) = (0.0, DVec3::ZERO, DMat3::ZERO);
        let product = |v: DVec3| DMat3::from_cols(v * v.x, v * v.y, v * v.z);
        for t in 0..self.surface.triangle_count() {
            let corners = self.surface.corners(t).map(|corner| corner.as_dvec3());
            let sum: DVec3 = corners.iter().sum();
            let own = f64::from(self.surface.double_area(t));
            area += own;
            first += sum / 3.0 * own;
            // The integral of x x^T over a triangle.
            second += corners.iter().fold(product(sum), |sum, &corner| sum + product(corner)) * (own / 12.0);
        }
        let centre = first / area;
        let axes = eigenvectors(second * (1.0 / area) - product(centre));
        (frame.to_model(centre.into()), axes.map(|axis| Axis::Oblique(axis.into())))
    }

    /// The asymmetry as each point of so many tells it.
    fn of_each(&self, plane: Plane, step: usize) -> Asymmetry {
        let frame = self.surface.frame();
        let origin = frame.to_unit(plane.onto(frame.centre));
        let plane = Plane { offset: plane.axis.along(origin), ..plane };
        let measured = self.points.par_iter().step_by(step).enumerate().map(|(k, &point)| {
            let image = DVec3::from(plane.image(point.into()));
            (self.triangles.nearest(image).1, k, image)
        });
        let farthest = measured.max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)));
        let (distance, _, image) = farthest.unwrap_or_default();
        Asymmetry { distance: distance * frame.diagonal, tiles: distance / self.side, at: frame.near(image.into()) }
    }
}

/// Sweeps of rotations: they converge quadratically.
const SWEEPS: usize = 10;

/// The eigenvectors of a symmetric matrix, of length 1, their largest coordinates positive, by Jacobi's rotations.
fn eigenvectors(mut matrix: DMat3) -> [DVec3; 3] {
    let mut vectors = DMat3::IDENTITY;
    for (p, q) in [(0, 1), (0, 2), (1, 2)].repeat(SWEEPS) {
        let angle = 0.5 * (2.0 * matrix.col(q)[p]).atan2(matrix.col(p)[p] - matrix.col(q)[q]);
        let (sin, cos) = angle.sin_cos();
        let mut rotation = DMat3::IDENTITY;
        (rotation.col_mut(p)[p], rotation.col_mut(p)[q]) = (cos, sin);
        (rotation.col_mut(q)[p], rotation.col_mut(q)[q]) = (-sin, cos);
        matrix = rotation.transpose() * matrix * rotation;
        vectors *= rotation;
    }
    [0, 1, 2].map(|k| {
        let vector = vectors.col(k).normalize();
        let largest = vector.abs().max_position();
        vector * vector[largest].signum()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eigenvectors_are_those_of_the_matrix() {
        let matrix = DMat3::from_cols_array(&[4.0, 1.0, -2.0, 1.0, 3.0, 0.5, -2.0, 0.5, 1.0]);
        let vectors = eigenvectors(matrix);
        for vector in vectors {
            let image = matrix * vector;
            assert!((image - vector * image.dot(vector)).length() < 1e-14, "{vector}");
            assert!((vector.length() - 1.0).abs() < 1e-14 && vector.max_element() >= -vector.min_element());
        }
        assert!(DMat3::from_cols(vectors[0], vectors[1], vectors[2]).determinant().abs() > 1.0 - 1e-14, "they differ");
        let other = DVec3::new(1.0, 0.0, 0.0);
        assert!((matrix * other - other * (matrix * other).dot(other)).length() > 1.0, "other vectors turn");
    }
}
