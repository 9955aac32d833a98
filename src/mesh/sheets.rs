//! The sheets of a surface near a face: the triangles nearest to its middle, and how it stands on them.
//!
//! # Practice
//! Relocation and edits try many positions for one face: for small cubes, the triangles that can be nearest to a point of them are
//! remembered.

use crate::geometry::triangle_normal;
use crate::surface::nearest::{EQUALLY_NEAR, Triangles, nearest_weights};
use glam::{DVec3, IVec3, Vec3};
use rustc_hash::FxHashMap;
use std::iter::zip;
use std::sync::{Arc, PoisonError, RwLock};

/// A cosine smaller than this counts as none: the triangle is perpendicular to the face, but for roundings.
const PERPENDICULAR: f64 = 1e-6;
/// The largest cosine of the normals of two sheets that lie on each other.
const BACK: f32 = -0.98;

/// The largest side of the cubes for which the nearest triangles are remembered, in sides of a square as large as a triangle.
const CUBE: f64 = 2.0;

/// How a face stands on the triangles nearest to its middle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Standing {
    /// One of them agrees with its normal, and none points against it.
    Along,
    /// All of them are perpendicular to it: it crosses a step half-way, and roundings decide whether they point against it.
    Perpendicular,
    /// One of them points against it.
    Against,
}

/// The triangles nearest to the middle of a face.
pub(crate) struct NearestSheets {
    /// Their distance, unit-sized.
    pub distance: f64,
    /// Whether the face's normal points against them.
    pub are_opposed: bool,
}

/// A triangle that can be nearest to a point.
struct Candidate {
    triangle: u32,
    normal: Vec3,
    corners: [DVec3; 3],
}

impl Candidate {
    fn nearest_point(&self, point: DVec3) -> DVec3 {
        zip(self.corners, nearest_weights(point, self.corners)).map(|(p, w)| p * w).sum()
    }
}

/// Oriented triangles, in a tree.
pub(super) struct Sheets<'a> {
    points: &'a [Vec3],
    triangles: &'a [[u32; 3]],
    tree: Triangles,
    cubes: Cubes,
}

impl<'a> Sheets<'a> {
    pub fn new(points: &'a [Vec3], triangles: &'a [[u32; 3]]) -> Self {
        let corners = |t: u32| triangles[t as usize].map(|v| points[v as usize].as_dvec3());
        let tree = Triangles::of(triangles.len() as u32, corners);
        Self { points, triangles, tree, cubes: Cubes::new(1.0) }
    }

    /// The tree of the triangles.
    pub fn tree(&self) -> &Triangles {
        &self.tree
    }

    /// From now on the nearest triangles are remembered for cubes of this side, or smaller ones where triangles are small.
    pub fn remember(&mut self, side: f64) {
        let area = |corners: &[u32; 3]| {
            let [a, b, c] = corners.map(|v| self.points[v as usize]);
            f64::from((b - a).cross(c - a).length()) / 2.0
        };
        let mean = self.triangles.iter().map(area).sum::<f64>() / self.triangles.len().max(1) as f64;
        self.cubes = Cubes::new(side.min(CUBE * mean.sqrt()).max(10.0 * EQUALLY_NEAR));
    }

    /// Compares the normal of a face, of any length, with the triangles nearest to its middle.
    pub fn nearest_to(&self, normal: DVec3, middle: DVec3) -> NearestSheets {
        let distance = self.tree.nearest(middle).1;
        NearestSheets { distance, are_opposed: self.standing(normal, middle, distance) == Standing::Against }
    }

    /// How a face with this normal stands on the triangles nearest to its middle. `distance` is an upper bound of their distance; where it
    /// is none, they are searched for.
    pub fn standing(&self, normal: DVec3, middle: DVec3, distance: f64) -> Standing {
        let mut found = self.tree.within(middle, distance + EQUALLY_NEAR);
        if found.is_empty() {
            found = self.tree.within(middle, self.tree.nearest(middle).1 + EQUALLY_NEAR);
        }
        self.standing_on(normal, middle, &self.candidates(found))
    }

    /// As [`standing`](Self::standing), for one of many faces thereabouts: what is found is remembered.
    pub fn standing_remembered(&self, normal: DVec3, middle: DVec3) -> Standing {
        let candidates = self.cubes.at(middle, |centre, reach| {
            let farthest = self.tree.nearest(centre).1 + 2.0 * (reach + EQUALLY_NEAR);
            self.candidates(self.tree.within(centre, farthest))
        });
        self.standing_on(normal, middle, &candidates)
    }

    fn candidates(&self, triangles: Vec<u32>) -> Vec<Candidate> {
        let candidate = |triangle: u32| {
            let corners = self.triangles[triangle as usize].map(|v| self.points[v as usize]);
            Candidate { triangle, normal: triangle_normal(corners), corners: corners.map(|p| p.as_dvec3()) }
        };
        triangles.into_iter().map(candidate).collect()
    }

    /// How a face stands on the nearest of these triangles.
    fn standing_on(&self, normal: DVec3, middle: DVec3, candidates: &[Candidate]) -> Standing {
        let direction = normal.normalize_or_zero();
        let cosine = |one: &Candidate| one.normal.as_dvec3().dot(direction);
        if direction == DVec3::ZERO || candidates.iter().all(|one| cosine(one) > PERPENDICULAR) {
            return Standing::Along;
        }
        let all = candidates.iter().map(|one| {
            let point = one.nearest_point(middle);
            (point.distance(middle), point, one)
        });
        let all: Vec<(f64, DVec3, &Candidate)> = all.collect();
        let least = all.iter().map(|(off, ..)| *off).fold(f64::INFINITY, f64::min);
        let near = || all.iter().filter(|(off, ..)| *off <= least + EQUALLY_NEAR);
        let has_back = |at: DVec3, one: &Candidate| {
            near().any(|&(_, back, other)| {
                other.normal.dot(one.normal) < BACK
                    && at.distance(back) <= EQUALLY_NEAR
                    && !self.share_an_edge(one.triangle, other.triangle)
            })
        };
        if near().any(|&(_, at, one)| cosine(one) < -PERPENDICULAR && !has_back(at, one)) {
            Standing::Against
        } else if near().all(|&(.., one)| cosine(one).abs() <= PERPENDICULAR) {
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

/// Cubes whose candidates were asked for, in parts that are locked apart.
struct Cubes {
    side: f64,
    parts: [RwLock<FxHashMap<IVec3, Arc<[Candidate]>>>; Self::PARTS],
}

impl Cubes {
    const PARTS: usize = 64;

    fn new(side: f64) -> Self {
        Self { side, parts: std::array::from_fn(|_| RwLock::default()) }
    }

    /// The candidates for the cube of a point; `found` finds those for a ball, from its centre and its radius.
    fn at(&self, point: DVec3, found: impl FnOnce(DVec3, f64) -> Vec<Candidate>) -> Arc<[Candidate]> {
        let cube = (point / self.side).floor().as_ivec3();
        let part = &self.parts[(cube.x ^ cube.y << 2 ^ cube.z << 4) as usize % Self::PARTS];
        // A thread that panicked has left whole entries.
        if let Some(known) = part.read().unwrap_or_else(PoisonError::into_inner).get(&cube) {
            return known.clone();
        }
        let centre = (cube.as_dvec3() + 0.5) * self.side;
        let candidates: Arc<[Candidate]> = found(centre, self.side * 3f64.sqrt() / 2.0).into();
        part.write().unwrap_or_else(PoisonError::into_inner).insert(cube, candidates.clone());
        candidates
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::examples::Example;
    use crate::surface::{FeatureOptions, Surface};

    #[test]
    fn remembered_triangles_decide_as_those_that_are_searched_for() {
        let soup = "block".parse::<Example>().expect("an example's name").generate(3_000);
        let surface = Surface::new(&soup, &FeatureOptions::default()).unwrap_or_else(|error| panic!("{error}"));
        let mut sheets = Sheets::new(&surface.points, &surface.triangles);
        sheets.remember(0.1);
        let mut state = 1u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state) / f64::from(u32::MAX) - 0.5
        };
        let (mut found, mut wrong) = ([0; 3], 0);
        for _ in 0..3_000 {
            let mut vector = || DVec3::new(random(), random(), random());
            let (middle, normal) = (vector(), vector());
            let distance = sheets.tree().nearest(middle).1;
            let standing = sheets.standing(normal, middle, distance);
            assert_eq!(sheets.standing_remembered(normal, middle), standing, "{middle} {normal}");
            assert_eq!(sheets.standing(normal, middle, 0.5 * distance), standing, "a bound that is none");
            found[standing as usize] += 1;
            // Those nearest to the middle of the cube alone are too few.
            let centre = ((middle / sheets.cubes.side).floor() + 0.5) * sheets.cubes.side;
            let few = sheets.tree().within(centre, sheets.tree().nearest(centre).1 + EQUALLY_NEAR);
            wrong += usize::from(sheets.standing_on(normal, middle, &sheets.candidates(few)) != standing);
        }
        assert!(found[Standing::Along as usize] > 1_000 && found[Standing::Against as usize] > 1_000, "{found:?}");
        assert!(wrong > 10, "{wrong}");
    }
}
