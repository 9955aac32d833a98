//! A ring torus about the z axis.

use std::f64::consts::TAU;

use glam::DVec3;

use super::Soup;
use super::strip::{Strips, nearest_size};

/// Distance of the tube's middle from the axis.
const MAJOR: f64 = 1.0;
/// Radius of the tube.
const MINOR: f64 = 0.4;

/// About `triangles` triangles, near right-isosceles.
pub fn generate(triangles: usize) -> Soup {
    let around_axis = |around_tube: usize| (around_tube as f64 * MAJOR / MINOR).round() as usize;
    let rows = nearest_size(4, triangles, |rows| 2 * rows * around_axis(rows));
    let columns = around_axis(rows);

    let mut strips = Strips::default();
    let mut rings: Vec<_> = (0..rows)
        .map(|row| {
            let (height, outward) = (TAU * row as f64 / rows as f64).sin_cos();
            strips.ring((0..columns).map(|column| {
                let (sin, cos) = (TAU * column as f64 / columns as f64).sin_cos();
                let radius = MAJOR + MINOR * outward;
                DVec3::new(radius * cos, radius * sin, MINOR * height)
            }))
        })
        .collect();
    rings.push(rings[0].clone());
    strips.chain(&rings);
    strips.finish()
}
