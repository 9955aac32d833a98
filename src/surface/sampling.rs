//! Points spread evenly over a surface, each for the same share of its area.
//!
//! # Theory
//! Systematic sampling: points are taken at equal steps of the area summed over the triangles in order. Inside its triangle a
//! point follows the sequence of Roberts (*The unreasonable effectiveness of quasirandom sequences*, 2018).

use super::{Surface, SurfacePoint};

/// The steps of the sequence: the first two powers of the reciprocal of the plastic number.
const STEPS: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];

/// So many points; the same ones every time.
pub(crate) fn sample_evenly(surface: &Surface, count: usize) -> Vec<SurfacePoint> {
    let each = surface.area() / count as f64;
    let mut points = Vec::with_capacity(count);
    let mut passed = 0.0;
    for triangle in 0..surface.triangle_count() {
        passed += f64::from(surface.double_area(triangle)) / 2.0;
        while points.len() < count && (points.len() as f64 + 0.5) * each <= passed {
            let [u, v] = STEPS.map(|step| (0.5 + step * points.len() as f64).fract() as f32);
            let [u, v] = if u + v > 1.0 { [1.0 - u, 1.0 - v] } else { [u, v] };
            let [a, b, c] = surface.corners(triangle);
            points.push(SurfacePoint { triangle: triangle as u32, position: a + (b - a) * u + (c - a) * v });
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::FeatureOptions;
    use crate::surface::examples::Example;
    use glam::Vec3;

    #[test]
    fn each_half_of_a_sphere_has_half_of_the_points() {
        let soup = Example::Sphere.generate(3_000);
        let surface = Surface::new(&soup, &FeatureOptions::default()).unwrap_or_else(|error| panic!("{error}"));
        let count = 10_000;
        let points = sample_evenly(&surface, count);
        assert!(points.len().abs_diff(count) <= 1);
        for axis in [Vec3::X, Vec3::Y, Vec3::Z, Vec3::new(0.6, -0.64, 0.48)] {
            let above = points.iter().filter(|point| point.position.dot(axis) > 0.0).count();
            // Of the triangles that the halves share, some 100 of 3,000, each may have its three points on one side.
            assert!(above.abs_diff(count / 2) < 170, "{axis}: {above}");
        }
        let low = points.iter().filter(|point| point.position.z < 0.0).count();
        let cap = points.iter().filter(|point| point.position.z < -0.5 / surface.frame().diagonal as f32).count();
        // Archimedes: the cap below half the radius has a quarter of the area; not so a count of vertices or of triangles.
        assert!((cap as f64 / low as f64 - 0.5).abs() < 0.02, "{cap} of {low}");
    }
}
