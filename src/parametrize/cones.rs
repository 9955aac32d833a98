//! Singularities of the field as points of the coordinates: cones, whose place is whole, or half between tiles.

use super::Parametrization;
use super::row_ends::turned;
use crate::surface::Surface;
use glam::DVec3;

/// The share of a triangle that a cone keeps from its sides.
const INSIDE: f64 = 0.1;

/// A singularity inside a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// The triangle.
    pub triangle: u32,
    /// The way to it from each corner, in tile sides, in the frame of the corner's sector.
    pub from_corners: [[f64; 2]; 3],
}

fn less(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

impl Cone {
    /// Its place in the triangle, by the corners' shares.
    pub fn shares(&self, phases: &Parametrization) -> [f64; 3] {
        let shares = self.raw_shares(phases).map(|share| share.max(0.0));
        let sum: f64 = shares.iter().sum();
        shares.map(|share| INSIDE + (1.0 - 3.0 * INSIDE) * if sum > 0.0 { share / sum } else { 1.0 / 3.0 })
    }

    /// The same as the coordinates have it: where the image is folded there are negative ones.
    pub(super) fn raw_shares(&self, phases: &Parametrization) -> [f64; 3] {
        // Of the triangle of the other two corners and the cone, in the frame of the first of them.
        let area = |k: usize| {
            let next = (k + 1) % 3;
            let (side, arm) = (phases.step(3 * self.triangle + next as u32), self.from_corners[next]);
            side[0] * arm[1] - side[1] * arm[0]
        };
        let shares = [0, 1, 2].map(area);
        let sum: f64 = shares.iter().map(|share| share.abs()).sum();
        shares.map(|share| if sum > 0.0 { share / sum } else { 1.0 / 3.0 })
    }

    /// Its place on the surface, in unit-sized coordinates.
    pub fn position(&self, surface: &Surface, phases: &Parametrization) -> DVec3 {
        let [a, b, c] = surface.corners(self.triangle as usize).map(|p| p.as_dvec3());
        let [x, y, z] = self.shares(phases);
        a * x + b * y + c * z
    }
}

impl Parametrization<'_> {
    /// The cone in a triangle, where the axes turn round it.
    ///
    /// Coordinates that are continued round the triangle come back turned and moved; the cone is the point that stays.
    pub fn cone(&self, triangle: u32) -> Option<Cone> {
        let quarters = self.quarters_round(triangle);
        if quarters == 0 {
            return None;
        }
        let h = [0, 1, 2].map(|k| 3 * triangle + k);
        let ways = h.map(|h| self.ways[h as usize]);
        let first = self.step(h[0]);
        let second = ways[0].back(self.step(h[1]));
        let third = ways[0].back(ways[1].back(self.step(h[2])));
        let round = [first[0] + second[0] + third[0], first[1] + second[1] + third[1]];
        // x = turned(x) + round, and 1 - i, 2 or 1 + i are what is to be divided by.
        let x = match quarters {
            2 => round.map(|x| x / 2.0),
            // Read forth by one quarter, what comes back is turned by one quarter clockwise.
            1 => {
                let [a, b] = round;
                [(a + b) / 2.0, (b - a) / 2.0]
            }
            _ => {
                let [a, b] = round;
                [(a - b) / 2.0, (a + b) / 2.0]
            }
        };
        debug_assert!({
            let [u, v] = turned(x, 4 - quarters);
            (u + round[0] - x[0]).abs() + (v + round[1] - x[1]).abs() < 1e-6
        });
        let at_second = ways[0].forth(less(x, first));
        let at_third = ways[1].forth(less(at_second, self.step(h[1])));
        Some(Cone { triangle, from_corners: [x, at_second, at_third] })
    }

    /// Whether a cone lies where two rows cross.
    pub fn is_whole(&self, cone: &Cone) -> bool {
        let place = self.at(3 * cone.triangle);
        (0..2).all(|k| {
            let x = place[k] + cone.from_corners[0][k];
            (x - x.round()).abs() < 0.25
        })
    }

    /// How far the corners of a cone's triangle would be moved for the way to it to be that of the surface; the cone is
    /// taken to lie in the middle.
    pub(super) fn cone_offsets(&self, cone: &Cone) -> [[f64; 2]; 3] {
        [0, 1, 2].map(|k| {
            let [h, before] = [k, (k + 2) % 3].map(|k| self.ways[3 * cone.triangle as usize + k]);
            let back = before.forth(before.by);
            let wanted = [0, 1].map(|i| (h.by[i] - back[i]) / 3.0);
            less(cone.from_corners[k], wanted)
        })
    }
}
