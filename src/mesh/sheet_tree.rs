//! Oriented triangles in a tree, and how a face stands on those nearest to its middle.

use crate::geometry::triangle_normal;
use crate::surface::nearest::{EQUALLY_NEAR, Triangles, nearest_weights};
use glam::{DVec3, Vec3};
use std::iter::zip;

/// A triangle points against a face where the cosine of their normals is below the negative of this: a low wall has a normal with the
/// roundings of its coordinates over its height.
const AGAINST: f64 = 1e-4;
/// A triangle agrees with a face where this cosine is larger than this.
const AGREES: f64 = 1e-3;
/// The largest cosine of the normals of two sheets that lie on each other.
const BACK: f32 = -0.98;

/// How a face stands on the triangles nearest to its middle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Standing {
    /// All of them agree with it; or it lies between two sheets at one place, or has no area.
    Along,
    /// One of them is perpendicular to it, none points against it: it crosses a step half-way, or its middle lies beyond a rim. Roundings
    /// decide whether that one points against it.
    Perpendicular,
    /// One of them points against it.
    Against,
}

/// The triangles nearest to the middle of a face.
pub(crate) struct NearestSheets {
    /// Their distance, unit-sized.
    pub distance: f64,
    /// Whether one of them points against the face.
    pub are_opposed: bool,
}

/// Oriented triangles, in a tree.
pub(super) struct SheetTree<'a> {
    points: &'a [Vec3],
    triangles: &'a [[u32; 3]],
    tree: Triangles,
}

impl<'a> SheetTree<'a> {
    pub fn new(points: &'a [Vec3], triangles: &'a [[u32; 3]]) -> Self {
        let corners = |t: u32| triangles[t as usize].map(|v| points[v as usize].as_dvec3());
        Self { points, triangles, tree: Triangles::of(triangles.len() as u32, corners) }
    }

    /// The tree of the triangles.
    pub fn triangles(&self) -> &Triangles {
        &self.tree
    }

    fn corners(&self, triangle: u32) -> [Vec3; 3] {
        self.triangles[triangle as usize].map(|v| self.points[v as usize])
    }

    fn normal(&self, triangle: u32) -> Vec3 {
        triangle_normal(self.corners(triangle))
    }

    /// Compares the normal of a face, of any length, with the triangles nearest to its middle.
    pub fn nearest_to(&self, normal: DVec3, middle: DVec3) -> NearestSheets {
        let distance = self.tree.nearest(middle).1;
        NearestSheets { distance, are_opposed: self.standing(normal, middle, distance) == Standing::Against }
    }

    /// How a face with this normal, of any length, stands on the triangles nearest to its middle. `distance` is an upper bound of their
    /// distance; where it is none, they are searched for.
    pub fn standing(&self, normal: DVec3, middle: DVec3, distance: f64) -> Standing {
        let direction = normal.normalize_or_zero();
        if direction == DVec3::ZERO {
            return Standing::Along;
        }
        let mut found = self.tree.within(middle, distance + EQUALLY_NEAR);
        if found.is_empty() {
            found = self.tree.within(middle, self.tree.nearest(middle).1 + EQUALLY_NEAR);
        }
        let cosine = |triangle: u32| self.normal(triangle).as_dvec3().dot(direction);
        if found.iter().all(|&triangle| cosine(triangle) > AGREES) {
            return Standing::Along;
        }
        let on = |triangle: u32| {
            let corners = self.corners(triangle).map(|corner| corner.as_dvec3());
            let point: DVec3 = zip(corners, nearest_weights(middle, corners)).map(|(p, w)| p * w).sum();
            (point.distance(middle), point, triangle)
        };
        let all: Vec<(f64, DVec3, u32)> = found.into_iter().map(on).collect();
        let least = all.iter().map(|(off, ..)| *off).fold(f64::INFINITY, f64::min);
        let near = || all.iter().filter(|(off, ..)| *off <= least + EQUALLY_NEAR);
        let has_back = |at: DVec3, triangle: u32| {
            let normal = self.normal(triangle);
            near().any(|&(_, back, other)| {
                self.normal(other).dot(normal) < BACK
                    && at.distance(back) <= EQUALLY_NEAR
                    && !self.share_an_edge(triangle, other)
            })
        };
        let is_one_below =
            |most: f64| near().any(|&(_, at, triangle)| cosine(triangle) < most && !has_back(at, triangle));
        if is_one_below(-AGAINST) {
            Standing::Against
        } else if is_one_below(AGREES) {
            Standing::Perpendicular
        } else {
            Standing::Along
        }
    }

    /// Whether two triangles meet at an edge.
    fn share_an_edge(&self, a: u32, b: u32) -> bool {
        let corners = self.triangles[b as usize];
        self.triangles[a as usize].iter().filter(|v| corners.contains(v)).count() > 1
    }
}
