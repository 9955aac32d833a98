//! The plane about which a surface is symmetric, and how far its mirror image is from it.
//!
//! # Theory
//! A mirror image is as far from the surface as the surface is from the image, so one direction is measured: from the images of the
//! surface's vertices, and of points spread evenly over it, to the surface.
//!
//! # Practice
//! A plane is looked for across the axes x, y and z: through the origin, the middle of the bounding box and the centre of area.

use super::{Axis, Plane, SymmetryError};
use crate::surface::Surface;
use crate::surface::nearest::Triangles;
use crate::surface::sampling::sample_evenly;
use glam::DVec3;
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
        let step = self.points.len().div_ceil(FEW);
        let mut best: Option<(Plane, f64)> = None;
        for plane in self.candidates() {
            let distance = self.of_each(plane, step).distance;
            if best.is_none_or(|best| distance < best.1 - SAME * self.surface.frame().diagonal) {
                best = Some((plane, distance));
            }
        }
        let plane = best.map_or(Plane { axis: Axis::X, offset: 0.0 }, |best| best.0);
        let found = self.about(plane);
        if found.tiles <= SYMMETRIC {
            return Ok((plane, found));
        }
        let limit = SYMMETRIC * self.side * self.surface.frame().diagonal;
        Err(SymmetryError::NoPlane { plane, distance: found.distance, at: found.at, limit })
    }

    fn candidates(&self) -> Vec<Plane> {
        let area = |t: usize| f64::from(self.surface.double_area(t));
        let middle = |t: usize| self.surface.corners(t).iter().map(|corner| corner.as_dvec3()).sum::<DVec3>() / 3.0;
        let triangles = 0..self.surface.triangle_count();
        let moment: DVec3 = triangles.clone().map(|t| middle(t) * area(t)).sum();
        let centre = self.surface.frame().to_model((moment / triangles.map(area).sum::<f64>()).into());
        let places = [[0.0; 3], self.surface.frame().centre, centre];
        let planes = |axis: Axis| places.map(|place| Plane { axis, offset: place[axis.index()] });
        Axis::ALL.into_iter().flat_map(planes).collect()
    }

    /// The asymmetry as each point of so many tells it.
    fn of_each(&self, plane: Plane, step: usize) -> Asymmetry {
        let frame = self.surface.frame();
        let mut origin = frame.centre;
        origin[plane.axis.index()] = plane.offset;
        let plane = Plane { offset: frame.to_unit(origin)[plane.axis.index()], ..plane };
        let measured = self.points.par_iter().step_by(step).enumerate().map(|(k, &point)| {
            let image = DVec3::from(plane.image(point.into()));
            (self.triangles.nearest(image).1, k, image)
        });
        let farthest = measured.max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)));
        let (distance, _, image) = farthest.unwrap_or_default();
        Asymmetry { distance: distance * frame.diagonal, tiles: distance / self.side, at: frame.near(image.into()) }
    }
}
