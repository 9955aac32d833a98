//! Constraints of the field: the directions that features, guides and curvature ask for.

use super::Sectors;
use crate::compute::Complex;
use crate::surface::{Surface, next, previous};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// The least sine of the angle between a direction and the normal: below, the direction along the surface is undefined.
const LEAST_SINE: f64 = 0.1;

/// What an unknown is constrained to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Constraint {
    pub target: Complex,
    /// Against the weights of links; infinite: the value is fixed.
    pub weight: f32,
}

impl Constraint {
    pub fn none() -> Self {
        Self { target: [0.0, 0.0], weight: 0.0 }
    }

    pub fn fixed(target: Complex) -> Self {
        Self { target, weight: f32::INFINITY }
    }

    pub fn is_fixed(&self) -> bool {
        self.weight == f32::INFINITY
    }

    /// Adds another one to a sum that [`Constraint::mean`] makes one direction. Fixed ones are averaged, and others do not
    /// count beside them.
    fn add(&mut self, target: Complex, weight: f32) {
        if weight == f32::INFINITY && !self.is_fixed() {
            *self = Self { target: [0.0, 0.0], weight };
        } else if self.is_fixed() && weight != f32::INFINITY {
            return;
        }
        let share = if weight == f32::INFINITY { 1.0 } else { weight };
        self.target = [self.target[0] + target[0] * share, self.target[1] + target[1] * share];
        if !self.is_fixed() {
            self.weight += weight;
        }
    }

    /// The direction of a sum, weighted by the sum's length; none where the sum cancels.
    fn mean(&self) -> Self {
        let length = (self.target[0] * self.target[0] + self.target[1] * self.target[1]).sqrt();
        let whole = if self.is_fixed() { 1.0 } else { self.weight };
        if length > 1e-6 * whole {
            let weight = if self.is_fixed() { f32::INFINITY } else { length };
            Self { target: self.target.map(|x| x / length), weight }
        } else {
            Self::none()
        }
    }
}

/// A direction that one sector is constrained to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DirectionConstraint {
    pub sector: u32,
    /// The direction, in radians from the sector's direction zero.
    pub angle: f64,
    /// The weight per area of the surface (unit-sized); `None`: the cross is fixed.
    pub density: Option<f64>,
}

impl DirectionConstraint {
    /// The cross that has the direction.
    fn target(&self) -> Complex {
        let (s, c) = (4.0 * self.angle).sin_cos();
        [c as f32, s as f32]
    }
}

/// The constraint on each sector: features fix theirs to run along the feature, the `directions` constrain others.
pub(crate) fn combined(surface: &Surface, sectors: &Sectors, directions: &[DirectionConstraint]) -> Vec<Constraint> {
    let along = |&quarters: &u8| if quarters > 0 { Constraint::fixed([1.0, 0.0]) } else { Constraint::none() };
    let mut constraints: Vec<Constraint> = sectors.quarters.iter().map(along).collect();
    for direction in directions {
        let weight = |density: f64| (density * sector_area(surface, sectors, direction.sector)) as f32;
        constraints[direction.sector as usize].add(direction.target(), direction.density.map_or(f32::INFINITY, weight));
    }
    constraints.iter_mut().filter(|sum| sum.weight > 0.0).for_each(|sum| *sum = sum.mean());
    constraints
}

/// A third of the area of the triangles at a sector.
pub(super) fn sector_area(surface: &Surface, sectors: &Sectors, sector: u32) -> f64 {
    sectors.corners(surface, sector).map(|corner| f64::from(surface.double_area(corner as usize / 3)) / 6.0).sum()
}

/// A direction in space as a whole sector sees it, in radians from its direction zero; `None` where it points along the
/// normal.
pub(super) fn angle_along(surface: &Surface, sectors: &Sectors, sector: u32, direction: DVec3) -> Option<f64> {
    let angle = |corner: u32| {
        let [o, p, q] =
            [corner, next(corner), previous(corner)].map(|h| surface.points[surface.origin(h) as usize].as_dvec3());
        let along = (p - o).try_normalize()?;
        let across = along.cross(q - o).cross(along).try_normalize()?;
        let (x, y) = (direction.dot(along), direction.dot(across));
        (x.hypot(y) > LEAST_SINE * direction.length()).then(|| y.atan2(x))
    };
    // The corner that the direction runs through, or the one that it misses least: beyond it, angles are not its own.
    let miss = |corner: u32, angle: f64| {
        let middle = sectors.corner_angle(corner) / 2.0;
        let off = (angle - middle).abs();
        off.min(TAU - off) - middle
    };
    let seen = sectors.corners(surface, sector).filter_map(|corner| Some((corner, angle(corner)?)));
    let (corner, angle) = seen.min_by(|a, b| miss(a.0, a.1).total_cmp(&miss(b.0, b.1)))?;
    // The same angle on the side of the corner's middle.
    let middle = sectors.corner_angle(corner) / 2.0;
    let angle = angle + if angle < middle - PI { TAU } else { 0.0 };
    Some(sectors.direction(corner, angle))
}
