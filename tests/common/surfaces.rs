//! Surfaces with known topology, and their geometry as a reader of the soup sees it.
#![allow(dead_code, reason = "each test binary compiles this file, and none uses all of it")]

use glam::DVec3;
use quadmosaic::surface::examples::Example;
use quadmosaic::surface::{FeatureOptions, Frame, Soup, Surface};

/// The example surfaces: name, Euler characteristic, number of boundary loops.
pub const EXAMPLES: [(&str, i64, usize); 5] =
    [("sphere", 2, 0), ("torus", 0, 0), ("block", 0, 0), ("plate", 0, 2), ("m6", 1, 1)];

pub fn example(name: &str, triangles: usize) -> Soup {
    name.parse::<Example>().expect("an example's name").generate(triangles)
}

pub fn surface(soup: &Soup) -> Surface {
    Surface::new(soup, &FeatureOptions::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// A flat rectangle of `columns` by `rows` squares of side `cell`, each cut along a diagonal; its normal is z.
pub fn flat(columns: usize, rows: usize, cell: f64) -> Soup {
    let at = |i: usize, j: usize| (j * (columns + 1) + i) as u32;
    let mut soup = Soup::default();
    for j in 0..=rows {
        soup.points.extend((0..=columns).map(|i| [i as f64 * cell, j as f64 * cell, 0.0]));
    }
    for j in 0..rows {
        for i in 0..columns {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            // Diagonals alternate, so that none of the grid's own directions is favoured.
            let halves = if (i + j) % 2 == 0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] };
            soup.triangles.extend(halves);
        }
    }
    soup
}

/// A strip of `count` squares round a circle, closed after `twists` half turns: one-sided where that is odd.
pub fn twisted_strip(count: usize, twists: usize) -> Soup {
    use std::f64::consts::TAU;
    let mut soup = Soup::default();
    for i in 0..count {
        let around = TAU * i as f64 / count as f64;
        let tilt = around * twists as f64 / 2.0;
        for side in [-0.3, 0.3] {
            let radius = 1.0 + side * tilt.cos();
            soup.points.push([radius * around.cos(), radius * around.sin(), side * tilt.sin()]);
        }
    }
    for i in 0..count {
        let [a, b] = [2 * i, 2 * i + 1].map(|v| v as u32);
        let [mut c, mut d] = [2 * i + 2, 2 * i + 3].map(|v| (v % (2 * count)) as u32);
        if i + 1 == count && twists % 2 == 1 {
            std::mem::swap(&mut c, &mut d);
        }
        soup.triangles.extend([[a, c, b], [b, c, d]]);
    }
    soup
}

/// Numbers in 0..1 that look random, the same ones every time.
pub fn scattered(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// The corners of a triangle of the soup in unit-sized coordinates.
///
/// Welding keeps the order of triangles, so where none is dropped this is the surface's triangle of that number.
pub fn unit_corners(soup: &Soup, frame: &Frame, triangle: usize) -> [DVec3; 3] {
    soup.triangles[triangle].map(|index| DVec3::from(frame.to_unit(soup.points[index as usize])))
}

/// The distance of a point from a triangle.
pub fn distance(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let normal = (b - a).cross(c - a);
    let inside = [(a, b), (b, c), (c, a)].iter().all(|&(s, e)| (e - s).cross(p - s).dot(normal) >= 0.0);
    if inside && normal.length() > 0.0 {
        return (p - a).dot(normal.normalize()).abs();
    }
    let to_side = |s: DVec3, e: DVec3| {
        let along = ((p - s).dot(e - s) / (e - s).length_squared()).clamp(0.0, 1.0);
        p.distance(s + (e - s) * along)
    };
    to_side(a, b).min(to_side(b, c)).min(to_side(c, a))
}
