//! Whether a face looks away from the surface that it stands for.

use crate::surface::Surface;
use crate::surface::nearest::TriangleGrid;
use glam::DVec3;
use std::sync::OnceLock;

/// A face whose normal has a larger cosine with those of the surface below all of its corners is not looked at further.
const PLAIN: f64 = 0.5;

/// The surface, its triangles sorted once one is asked for.
pub(super) struct Facing<'a> {
    surface: &'a Surface,
    grid: OnceLock<TriangleGrid<'a>>,
}

impl<'a> Facing<'a> {
    pub(super) fn new(surface: &'a Surface) -> Self {
        Self { surface, grid: OnceLock::new() }
    }

    /// Whether a face with these corners looks away from the triangle nearest to its middle; `normals` are the surface's at
    /// its corners.
    pub(super) fn looks_away(&self, corners: &[DVec3], mut normals: impl Iterator<Item = DVec3>) -> bool {
        let middle = corners.iter().sum::<DVec3>() / corners.len() as f64;
        let arm = |k: usize| corners[k % corners.len()] - middle;
        let area: DVec3 = (0..corners.len()).map(|k| arm(k).cross(arm(k + 1))).sum();
        if normals.all(|normal| normal.dot(area) > PLAIN * area.length()) {
            return false;
        }
        let grid = self.grid.get_or_init(|| TriangleGrid::new(self.surface));
        self.surface.normal(grid.nearest(middle).0 as usize).as_dvec3().dot(area) < 0.0
    }
}
