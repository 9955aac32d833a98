//! A flat square with a round hole, and the rings that such a face is made of.

use std::f64::consts::FRAC_PI_4;

use glam::DVec2;

use super::Soup;
use super::strip::{Strips, nearest_size};

/// Half the side of the plate.
const HALF_SIDE: f64 = 0.5;
/// Radius of its hole.
const RADIUS: f64 = 0.2;

/// A square about the origin with a round hole in its middle, divided by rings that turn from the square into the circle.
pub struct Frame {
    half_side: f64,
    radius: f64,
    /// Points of a ring along each of the four sides.
    pub along: usize,
    /// Strips between the square and the hole.
    pub across: usize,
}

impl Frame {
    /// The frame with that many points along a side, and strips about as wide as its points are apart.
    pub fn new(half_side: f64, radius: f64, along: usize) -> Self {
        let growth = Self::growth(half_side, radius);
        // The way from hole to square is shortest in the middle of a side and longest in its ends.
        let way = 0.5 * (half_side + half_side * 2.0_f64.sqrt()) - radius;
        let mean_spacing = (2.0 * half_side - FRAC_PI_4 * 2.0 * radius) / growth.ln() / along as f64;
        Self { half_side, radius, along, across: ((way / mean_spacing).round() as usize).max(1) }
    }

    /// The points' spacing on the square over that on the hole.
    fn growth(half_side: f64, radius: f64) -> f64 {
        half_side / (FRAC_PI_4 * radius)
    }

    /// The number of triangles between the square and the hole.
    pub fn triangles(&self) -> usize {
        8 * self.along * self.across
    }

    /// One ring, counter-clockwise from the corner (+, -): 0 is the square, [`Frame::across`] is the hole.
    pub fn ring(&self, index: usize) -> impl Iterator<Item = DVec2> {
        // The strips grow from the hole to the square as the points' spacing does.
        let growth = Self::growth(self.half_side, self.radius);
        let inward = 1.0 - index as f64 / self.across as f64;
        let outside = (growth.powf(inward) - 1.0) / (growth - 1.0);
        (0..4 * self.along).map(move |place| {
            let (side, step) = (place / self.along, (place % self.along) as f64 / self.along as f64);
            let on_first_side = DVec2::new(self.half_side, self.half_side * (2.0 * step - 1.0));
            let on_square = (0..side).fold(on_first_side, |point, _| point.perp());
            let on_circle = self.radius * DVec2::from_angle((2.0 * (side as f64 + step) - 1.0) * FRAC_PI_4);
            on_circle.lerp(on_square, outside)
        })
    }
}

/// About `triangles` triangles, near right-isosceles, finer at the hole.
pub fn generate(triangles: usize) -> Soup {
    let frame = |along| Frame::new(HALF_SIDE, RADIUS, along);
    let frame = frame(nearest_size(3, triangles, |along| frame(along).triangles()));
    let mut strips = Strips::default();
    let centre = DVec2::splat(HALF_SIDE);
    let rings: Vec<_> = (0..=frame.across)
        .map(|index| strips.ring(frame.ring(index).map(|point| (point + centre).extend(0.0))))
        .collect();
    strips.chain(&rings);
    strips.finish()
}
