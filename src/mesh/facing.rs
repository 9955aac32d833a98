//! Whether a face looks away from the surface that it stands for.

use crate::surface::Surface;
use crate::surface::nearest::{EQUALLY_NEAR, Triangles};
use glam::DVec3;
use std::sync::OnceLock;

/// A face whose normal has a larger cosine with those of the surface below all of its corners is not looked at further.
const PLAIN: f64 = 0.5;

/// The surface, its triangles sorted once one is asked for.
pub struct Facing<'a> {
    surface: &'a Surface,
    triangles: OnceLock<Triangles>,
}

impl<'a> Facing<'a> {
    /// That of a surface.
    pub fn new(surface: &'a Surface) -> Self {
        Self { surface, triangles: OnceLock::new() }
    }

    pub(super) fn surface(&self) -> &'a Surface {
        self.surface
    }

    /// The unit normal of a triangle of the surface.
    pub(super) fn normal(&self, triangle: u32) -> DVec3 {
        self.surface.normal(triangle as usize).as_dvec3()
    }

    /// Whether a face with these corners looks away from the triangle nearest to its middle, or from all that are equally near,
    /// as on both sides of a sharp edge; `normals` are the surface's at its corners.
    pub(super) fn looks_away(&self, corners: &[DVec3], mut normals: impl Iterator<Item = DVec3>) -> bool {
        let middle = corners.iter().sum::<DVec3>() / corners.len() as f64;
        let arm = |k: usize| corners[k % corners.len()] - middle;
        let area: DVec3 = (0..corners.len()).map(|k| arm(k).cross(arm(k + 1))).sum();
        if normals.all(|normal| normal.dot(area) > PLAIN * area.length()) {
            return false;
        }
        let triangles = self.triangles.get_or_init(|| Triangles::new(self.surface));
        let is_away = |triangle: u32| self.normal(triangle).dot(area) < 0.0;
        let (nearest, distance) = triangles.nearest(middle);
        is_away(nearest) && triangles.within(middle, distance + EQUALLY_NEAR).all(is_away)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::{FeatureOptions, Soup};

    /// Two squares of side 1, the lower one looking down, the upper one up, so far apart.
    fn sheets(apart: f64) -> Surface {
        let square = |z: f64| [[0.0, 0.0, z], [1.0, 0.0, z], [1.0, 1.0, z], [0.0, 1.0, z]];
        let points = [square(0.0), square(apart)].concat();
        let triangles = vec![[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7]];
        Surface::new(&Soup { points, triangles, ..Soup::default() }, &FeatureOptions::default()).unwrap()
    }

    #[test]
    fn the_sheet_nearest_to_the_middle_decides_unless_all_corners_agree() {
        let surface = sheets(0.1);
        let facing = Facing::new(&surface);
        let at = |[x, y, z]: [f64; 3]| DVec3::from(surface.frame().to_unit([x, y, z]));
        // Counter-clockwise from above, two corners on the upper sheet and one on the lower.
        let up = [at([0.4, 0.4, 0.1]), at([0.6, 0.4, 0.1]), at([0.5, 0.6, 0.0])];
        let down = [up[0], up[2], up[1]];
        let unknown = || [DVec3::ZERO; 3].into_iter();
        assert!(!facing.looks_away(&up, unknown()));
        assert!(facing.looks_away(&down, unknown()));
        let low = down.map(|corner| corner - DVec3::Z * (at([0.0, 0.0, 0.1]) - at([0.0; 3])).z * 0.5);
        assert!(!facing.looks_away(&low, unknown()), "the lower sheet is nearer");
        assert!(!facing.looks_away(&down, [-DVec3::Z; 3].into_iter()), "all corners lie on the lower sheet");
        assert!(facing.looks_away(&down, [-DVec3::Z, -DVec3::Z, DVec3::Z].into_iter()));
        let double = sheets(1e-6);
        let facing = Facing::new(&double);
        let flat = [[0.4, 0.4], [0.6, 0.4], [0.5, 0.6]].map(|[x, y]| DVec3::from(double.frame().to_unit([x, y, 0.0])));
        assert!(!facing.looks_away(&flat, unknown()), "both sheets are equally near");
        assert!(!facing.looks_away(&[flat[0], flat[2], flat[1]], unknown()));
    }
}
