//! The angle by which a surface turns across an edge at the scale of a tile.
//!
//! # Theory
//! From a point of the edge two straight walks over the surface leave at right angles to it, one on each side. The mean normals
//! along the walks differ by the turn. So a fold between two flat sides turns by its dihedral angle, whatever the size of the
//! triangles. A groove or a fillet narrower than the walks turns by what its surroundings do, and the turns of noise cancel.

use super::walk::{Passed, WALK_EDGES, Walkable, walk_through};
use super::{NONE, Surface};
use crate::geometry::{cross, unit};
use glam::{DVec3, Vec3};

/// A surface on which features are no barriers.
pub(super) struct WithoutBarriers<'a>(pub &'a Surface);

impl Walkable for WithoutBarriers<'_> {
    fn corners(&self, triangle: usize) -> [Vec3; 3] {
        self.0.corners(triangle)
    }

    fn beyond(&self, half_edge: u32) -> u32 {
        self.0.twins[half_edge as usize]
    }
}

/// The turn of a surface across an inner edge at a share of the way along a half-edge, in radians: positive where the edge is
/// convex. `reach` is the length of the walks.
pub(super) fn turn(surface: &Surface, half_edge: u32, share: f32, reach: f32) -> f64 {
    let twin = surface.twins[half_edge as usize];
    debug_assert!(twin != NONE, "an inner edge has a twin");
    let mean_normal = |h: u32, share: f32| {
        let [a, b] = [surface.origin(h), surface.target(h)].map(|v| surface.points[v as usize]);
        let inward = cross(surface.normal(h as usize / 3), unit(b - a));
        let mut sum = DVec3::ZERO;
        let passed = |passed: Passed| {
            sum += passed.normal.as_dvec3() * f64::from(passed.share);
            true
        };
        walk_through(&WithoutBarriers(surface), h / 3, a + (b - a) * share, inward * reach, WALK_EDGES, passed);
        sum
    };
    let (left, right) = (mean_normal(half_edge, share), mean_normal(twin, 1.0 - share));
    let along =
        DVec3::from(surface.point(surface.target(half_edge))) - DVec3::from(surface.point(surface.origin(half_edge)));
    let axis = left.cross(right);
    // Seen along the half-edge, the right side of a convex edge falls away clockwise.
    axis.length().atan2(left.dot(right)).copysign(axis.dot(along))
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::surface::{FeatureOptions, Soup};

    /// Triangles of this profile, a line of points in the plane of x and z, drawn out along y in cells of this length.
    pub fn drawn_out(profile: &[[f64; 2]], cells: u32, length: f64) -> Soup {
        let across = profile.len() as u32;
        let points = (0..=cells).flat_map(|j| profile.iter().map(move |&[x, z]| [x, f64::from(j) * length, z]));
        let at = |i: u32, j: u32| j * across + i;
        let cell =
            |i: u32, j: u32| [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]];
        let triangles = (0..cells).flat_map(|j| (0..across - 1).flat_map(move |i| cell(i, j)));
        Soup { points: points.collect(), triangles: triangles.collect(), ..Soup::default() }
    }

    fn surface(profile: &[[f64; 2]]) -> Surface {
        let soup = drawn_out(profile, 9, 1.0);
        Surface::new(&soup, &FeatureOptions::default()).unwrap_or_else(|error| panic!("{error}"))
    }

    /// The turn, in degrees, at the inner edge of the middle cell at a point of the profile; `reach` in the units of the profile.
    fn turn_at(surface: &Surface, [x, z]: [f64; 2], reach: f64) -> f64 {
        let middle = surface.frame().centre[1];
        let place = |v: u32| DVec3::from(surface.frame().to_model(surface.point(v)));
        let on = |h: &u32| {
            let [a, b] = [surface.origin(*h), surface.target(*h)].map(place);
            let is_at = |p: DVec3| (p.x - x).abs() < 1e-4 && (p.z - z).abs() < 1e-4;
            surface.twin(*h).is_some() && is_at(a) && is_at(b) && (a.y + b.y - 2.0 * middle).abs() < 1.0
        };
        let h = (0..3 * surface.triangle_count() as u32).find(on).expect("the profile has an edge there");
        turn(surface, h, 0.5, (reach / surface.frame().diagonal) as f32).to_degrees()
    }

    #[test]
    fn a_fold_turns_by_its_dihedral_angle_at_any_scale() {
        for angle in [10.0_f64, 50.0, 90.0, 150.0] {
            let (sine, cosine) = angle.to_radians().sin_cos();
            for up in [1.0, -1.0] {
                let surface = surface(&[[-4.0, 0.0], [0.0, 0.0], [4.0 * cosine, up * 4.0 * sine]]);
                for reach in [0.1, 1.0, 3.0] {
                    let found = turn_at(&surface, [0.0, 0.0], reach);
                    assert!((found + up * angle).abs() < 0.1, "{angle} upwards {up}, {reach}: {found}");
                }
            }
        }
    }

    #[test]
    fn a_groove_narrower_than_the_walk_turns_little_and_a_wide_one_fully() {
        // Its walls and its floor are 0.2 wide; right of its left rim a walk of length r passes 0.2 of wall, 0.2 of floor, 0.2 of
        // wall and r - 0.6 of the top: the walls' normals cancel.
        let profile = [[-5.0, 0.0], [0.0, 0.0], [0.0, -0.2], [0.2, -0.2], [0.2, 0.0], [5.0, 0.0]];
        let surface = surface(&profile);
        assert!(turn_at(&surface, [0.0, 0.0], 2.0).abs() < 0.1);
        assert!((turn_at(&surface, [0.0, 0.0], 0.1) - 90.0).abs() < 0.1);
        // Past half the first wall and all of the floor: the normals along it are (0.2, 0, 0) and (0, 0, 0.2), at 45 degrees.
        assert!((turn_at(&surface, [0.0, 0.0], 0.4) - 45.0).abs() < 0.1);
    }

    #[test]
    fn a_thin_plate_turns_by_more_than_a_right_angle() {
        let profile = [[-5.0, 0.0], [0.0, 0.0], [0.0, -0.2], [-5.0, -0.2]];
        let surface = surface(&profile);
        // The walk passes 0.2 of the rim and 1.8 of the lower side.
        let expected = 180.0 - (0.2_f64 / 1.8).atan().to_degrees();
        assert!((turn_at(&surface, [0.0, 0.0], 2.0) - expected).abs() < 0.1);
    }
}
