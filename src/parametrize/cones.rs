//! Cones: singularities of the field inside triangles, as points of the coordinates. The coordinates of a cone are integers,
//! or half integers.

use super::Parametrization;
use super::transitions::turned;
use crate::surface::Surface;
use glam::DVec3;

/// The share of a triangle that a cone keeps from its sides.
const INSIDE: f64 = 0.1;

/// A singularity inside a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// The triangle.
    pub triangle: u32,
    /// The difference of the coordinates from each corner to the cone, in tile sides, in the frame of the corner's sector.
    pub from_corners: [[f64; 2]; 3],
}

fn difference(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

impl Cone {
    /// Its barycentric coordinates, moved inside the triangle.
    pub fn barycentric(&self, parametrization: &Parametrization) -> [f64; 3] {
        let shares = self.raw_barycentric(parametrization).map(|share| share.max(0.0));
        let sum: f64 = shares.iter().sum();
        shares.map(|share| INSIDE + (1.0 - 3.0 * INSIDE) * if sum > 0.0 { share / sum } else { 1.0 / 3.0 })
    }

    /// Its barycentric coordinates in the image of the triangle; where the image is folded, some are negative.
    pub(super) fn raw_barycentric(&self, parametrization: &Parametrization) -> [f64; 3] {
        // Of the triangle of the other two corners and the cone, in the frame of the first of them.
        let area = |k: usize| {
            let next = (k + 1) % 3;
            let (side, to_cone) = (parametrization.step(3 * self.triangle + next as u32), self.from_corners[next]);
            side[0] * to_cone[1] - side[1] * to_cone[0]
        };
        let shares = [0, 1, 2].map(area);
        let sum: f64 = shares.iter().map(|share| share.abs()).sum();
        shares.map(|share| if sum > 0.0 { share / sum } else { 1.0 / 3.0 })
    }

    /// Its place on the surface, in unit-sized coordinates.
    pub(crate) fn position(&self, surface: &Surface, parametrization: &Parametrization) -> DVec3 {
        let [a, b, c] = surface.corners(self.triangle as usize).map(|p| p.as_dvec3());
        let [x, y, z] = self.barycentric(parametrization);
        a * x + b * y + c * z
    }
}

impl Parametrization<'_> {
    /// The cone in a triangle around which the axes turn; `None` in others.
    ///
    /// Coordinates that are continued around the triangle come back turned and moved; the cone is the fixed point.
    pub fn cone(&self, triangle: u32) -> Option<Cone> {
        let quarters = self.quarters_around(triangle);
        if quarters == 0 {
            return None;
        }
        let h = [0, 1, 2].map(|k| 3 * triangle + k);
        let transitions = h.map(|h| self.transitions[h as usize]);
        let first = self.step(h[0]);
        let second = transitions[0].back(self.step(h[1]));
        let third = transitions[0].back(transitions[1].back(self.step(h[2])));
        let moved = [first[0] + second[0] + third[0], first[1] + second[1] + third[1]];
        // The solution of x = turned(x) + moved: a division by 1 - i, 2 or 1 + i.
        let x = match quarters {
            2 => moved.map(|x| x / 2.0),
            // Read forward by one quarter, what comes back is turned by one quarter clockwise.
            1 => {
                let [a, b] = moved;
                [(a + b) / 2.0, (b - a) / 2.0]
            }
            _ => {
                let [a, b] = moved;
                [(a - b) / 2.0, (a + b) / 2.0]
            }
        };
        debug_assert!({
            let [u, v] = turned(x, 4 - quarters);
            (u + moved[0] - x[0]).abs() + (v + moved[1] - x[1]).abs() < 1e-6
        });
        let at_second = transitions[0].forward(difference(x, first));
        let at_third = transitions[1].forward(difference(at_second, self.step(h[1])));
        Some(Cone { triangle, from_corners: [x, at_second, at_third] })
    }

    /// Whether the coordinates of a cone are integers: two rows cross there.
    pub fn is_integer(&self, cone: &Cone) -> bool {
        let place = self.at(3 * cone.triangle);
        (0..2).all(|k| {
            let x = place[k] + cone.from_corners[0][k];
            (x - x.round()).abs() < 0.25
        })
    }

    /// By how much the coordinates of the corners of a cone's triangle are off: the difference to those that the surface asks
    /// for, with the cone in the middle of the triangle.
    pub(super) fn cone_offsets(&self, cone: &Cone) -> [[f64; 2]; 3] {
        [0, 1, 2].map(|k| {
            let [h, before] = [k, (k + 2) % 3].map(|k| self.transitions[3 * cone.triangle as usize + k]);
            let back = before.forward(before.wanted);
            let wanted = [0, 1].map(|i| (h.wanted[i] - back[i]) / 3.0);
            difference(cone.from_corners[k], wanted)
        })
    }
}
