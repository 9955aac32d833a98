//! The matching of crosses: which direction of one cross is which direction of another.

use super::Sectors;
use crate::compute::Complex;
use crate::surface::next;
use std::f64::consts::{FRAC_PI_2, PI};

/// One direction of each sector's cross, in radians from the sector's direction zero; on a feature, direction zero itself.
pub(crate) fn axes(sectors: &Sectors, crosses: &[Complex]) -> Vec<f64> {
    let on_feature = |sector: usize| sectors.quarters[sector] > 0;
    let axis = |z: &Complex| f64::from(z[1]).atan2(f64::from(z[0])) / 4.0;
    crosses.iter().enumerate().map(|(s, z)| if on_feature(s) { 0.0 } else { axis(z) }).collect()
}

/// The matching of the crosses at the ends of a half-edge.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Matching {
    /// By how much the cross turns, in radians, counter-clockwise: at most an eighth of a turn.
    pub turn: f64,
    /// How many quarters its axis is turned by when it is read in the frame of the sector at the end.
    pub quarters: f64,
    /// The half-edge's angle from the axis where it begins.
    pub leaving: f64,
}

impl Matching {
    /// Along a half-edge; `axes` as [`axes`] makes them.
    pub fn along(sectors: &Sectors, axes: &[f64], h: u32) -> Self {
        let [from, to] = [h, next(h)].map(|corner| sectors.of_corner[corner as usize] as usize);
        let leaving = sectors.direction(h, 0.0) - axes[from];
        let arriving = sectors.direction(next(h), sectors.corner_angle(next(h))) + PI - axes[to];
        let quarters = ((arriving - leaving) / FRAC_PI_2).round();
        Self { turn: leaving - arriving + quarters * FRAC_PI_2, quarters, leaving }
    }

    /// Whether the axis at one end is the other direction of the cross at the other end.
    pub fn swaps(&self) -> bool {
        self.quarters.rem_euclid(2.0) == 1.0
    }
}
