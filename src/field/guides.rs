//! Constraints of the field: features and the user's control vectors.

use super::{Complex, Sectors};
use crate::surface::{Surface, next, previous};
use glam::DVec3;
use rayon::prelude::*;

/// A control vector of the user's (the paper, section 1): near `point`, the field follows `direction`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Guide {
    /// Where, in model units; the nearest point of the surface counts.
    pub point: [f64; 3],
    /// Which way, of any length; its part along the surface counts.
    pub direction: [f64; 3],
    /// How far from the point the guide reaches, in model units; 0: the nearest triangle's corners. Default 0.
    pub radius: f64,
}

/// What draws an unknown towards a cross.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pull {
    pub toward: Complex,
    /// Against the weights of links; infinite: fixed.
    pub weight: f32,
}

impl Pull {
    pub fn none() -> Self {
        Self { toward: [0.0, 0.0], weight: 0.0 }
    }

    pub fn fixed(toward: Complex) -> Self {
        Self { toward, weight: f32::INFINITY }
    }

    pub fn is_fixed(&self) -> bool {
        self.weight == f32::INFINITY
    }

    /// Adds another pull; where both are fixed they are averaged by [`Pull::settle`].
    pub fn add(&mut self, toward: Complex, weight: f32) {
        let share = if weight == f32::INFINITY { 1.0 } else { weight };
        self.toward = [self.toward[0] + toward[0] * share, self.toward[1] + toward[1] * share];
        self.weight += weight;
    }

    /// Makes the sum of several pulls one direction; pulls that cancel leave none.
    pub fn settle(&mut self) {
        let length = (self.toward[0] * self.toward[0] + self.toward[1] * self.toward[1]).sqrt();
        if length > 1e-6 {
            self.toward = self.toward.map(|x| x / length);
        } else {
            *self = Self::none();
        }
    }
}

/// The pull on each sector: features fix theirs to run along the feature, guides those near them.
pub(crate) fn pulls(surface: &Surface, sectors: &Sectors, guides: &[Guide]) -> Vec<Pull> {
    let mut pulls: Vec<Pull> = sectors
        .quarters
        .iter()
        .map(|&quarters| if quarters > 0 { Pull::fixed([1.0, 0.0]) } else { Pull::none() })
        .collect();
    for guide in guides {
        let at = DVec3::from(surface.frame().to_unit(guide.point));
        let radius = guide.radius / surface.frame().diagonal;
        let direction = DVec3::from(guide.direction);
        for sector in reached(surface, sectors, at, radius) {
            if sectors.quarters[sector as usize] == 0
                && let Some(angle) = angle_of(surface, sectors, sector, direction)
            {
                let (s, c) = (4.0 * angle).sin_cos();
                pulls[sector as usize].add([c as f32, s as f32], f32::INFINITY);
            }
        }
    }
    pulls.iter_mut().filter(|pull| pull.weight > 0.0).for_each(Pull::settle);
    pulls
}

/// The sectors within `radius`, and in any case those of the triangle nearest to the point.
fn reached(surface: &Surface, sectors: &Sectors, at: DVec3, radius: f64) -> Vec<u32> {
    let nearest = (0..surface.triangle_count())
        .into_par_iter()
        .map(|t| (distance_squared(at, surface.corners(t).map(|p| p.as_dvec3())), t))
        .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut reached: Vec<u32> =
        nearest.iter().flat_map(|&(_, t)| [0, 1, 2].map(|k| sectors.of_corner[3 * t + k])).collect();
    if radius > 0.0 {
        reached.extend((0..sectors.count() as u32).filter(|&s| {
            let v = surface.origin(sectors.first_corner[s as usize]);
            surface.points[v as usize].as_dvec3().distance(at) <= radius
        }));
    }
    reached.sort_unstable();
    reached.dedup();
    reached
}

/// The scaled angle of a direction in space at a sector; `None` where it points along the normal.
fn angle_of(surface: &Surface, sectors: &Sectors, sector: u32, direction: DVec3) -> Option<f64> {
    let corner = sectors.first_corner[sector as usize];
    let [o, p, q] =
        [corner, next(corner), previous(corner)].map(|h| surface.points[surface.origin(h) as usize].as_dvec3());
    let along = (p - o).try_normalize()?;
    let across = along.cross(q - o).cross(along).try_normalize()?;
    let (x, y) = (direction.dot(along), direction.dot(across));
    (x.hypot(y) > 0.1 * direction.length()).then(|| sectors.direction(corner, y.atan2(x)))
}

/// The squared distance of a point from a triangle.
fn distance_squared(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let (ab, ac) = (b - a, c - a);
    let normal = ab.cross(ac);
    let inside = [(a, b), (b, c), (c, a)].iter().all(|&(s, e)| (e - s).cross(p - s).dot(normal) >= 0.0);
    if inside && normal.length_squared() > 0.0 {
        return (p - a).dot(normal).powi(2) / normal.length_squared();
    }
    let to_segment = |s: DVec3, e: DVec3| {
        let along = (p - s).dot(e - s) / (e - s).length_squared().max(f64::MIN_POSITIVE);
        p.distance_squared(s + (e - s) * along.clamp(0.0, 1.0))
    };
    to_segment(a, b).min(to_segment(b, c)).min(to_segment(c, a))
}
