//! A box with a bore: one closed chain of rings, inward over the top, down the bore, outward over the bottom, up the sides.

use std::f64::consts::FRAC_PI_4;

use super::Soup;
use super::plate::Frame;
use super::strip::{Strips, nearest_size};

/// Half the side of the box's square.
const HALF_SIDE: f64 = 1.0;
/// Radius of the bore.
const RADIUS: f64 = 0.7;
/// Height of the box, along the bore.
const HEIGHT: f64 = 1.0;

/// Rows from the bottom to the top: the bore and the sides share their number, so it suits the mean of their spacings.
fn rows(along: usize) -> usize {
    let spacing = 2.0 * (HALF_SIDE * FRAC_PI_4 * RADIUS).sqrt() / along as f64;
    ((HEIGHT / spacing).round() as usize).max(1)
}

/// About `triangles` triangles, near right-isosceles.
pub fn generate(triangles: usize) -> Soup {
    let frame = |along| Frame::new(HALF_SIDE, RADIUS, along);
    let along = nearest_size(3, triangles, |along| 2 * frame(along).triangles() + 16 * along * rows(along));
    let (frame, rows) = (frame(along), rows(along));
    let (bottom, top) = (-0.5 * HEIGHT, 0.5 * HEIGHT);
    let height = |row: usize| bottom + HEIGHT * row as f64 / rows as f64;

    let mut strips = Strips::default();
    let mut ring = |index: usize, z: f64| strips.ring(frame.ring(index).map(|point| point.extend(z)));
    let mut rings = Vec::new();
    rings.extend((0..frame.across).map(|index| ring(index, top)));
    rings.extend((1..=rows).rev().map(|row| ring(frame.across, height(row))));
    rings.extend((1..=frame.across).rev().map(|index| ring(index, bottom)));
    rings.extend((0..rows).map(|row| ring(0, height(row))));
    rings.push(rings[0].clone());
    strips.chain(&rings);
    strips.finish()
}
