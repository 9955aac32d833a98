//! Nearest segments and triangles, in trees of their bounding boxes.

use super::Surface;
use super::boxes::{Bounds, Boxes};
use glam::DVec3;
use rayon::prelude::*;
use rstar::{AABB, PointDistance, RTree, RTreeObject};

/// Triangles whose distances from a point differ by no more than this, in diagonals of the surface, are equally near to it:
/// coordinates are rounded to 6e-8.
pub(crate) const EQUALLY_NEAR: f64 = 1e-6;

/// A segment or a triangle.
#[derive(Clone, Copy)]
pub(crate) struct Simplex<const CORNERS: usize> {
    pub corners: [DVec3; CORNERS],
    /// Its index among all.
    pub id: u32,
    /// Its bounding box, which every search reads.
    envelope: AABB<[f64; 3]>,
}

impl<const CORNERS: usize> Simplex<CORNERS> {
    fn new(corners: [DVec3; CORNERS], id: u32) -> Self {
        let low = corners.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let high = corners.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        Self { corners, id, envelope: AABB::from_corners(low.to_array(), high.to_array()) }
    }
}

impl<const CORNERS: usize> RTreeObject for Simplex<CORNERS> {
    type Envelope = AABB<[f64; 3]>;

    fn envelope(&self) -> Self::Envelope {
        self.envelope
    }
}

impl PointDistance for Simplex<2> {
    fn distance_2(&self, point: &[f64; 3]) -> f64 {
        let (point, [start, end]) = (DVec3::from(*point), self.corners);
        nearest_on_segment(point, start, end).distance_squared(point)
    }
}

impl PointDistance for Simplex<3> {
    fn distance_2(&self, point: &[f64; 3]) -> f64 {
        squared_distance(DVec3::from(*point), self.corners)
    }
}

/// Simplices in a tree.
pub(crate) struct Simplices<const CORNERS: usize>(RTree<Simplex<CORNERS>>)
where
    Simplex<CORNERS>: PointDistance;

impl<const CORNERS: usize> Simplices<CORNERS>
where
    Simplex<CORNERS>: RTreeObject<Envelope = AABB<[f64; 3]>> + PointDistance,
{
    /// Sorts finite simplices into a tree.
    pub fn new(simplices: impl Iterator<Item = [DVec3; CORNERS]>) -> Self {
        Self(RTree::bulk_load(simplices.zip(0..).map(|(corners, id)| Simplex::new(corners, id)).collect()))
    }

    /// The nearest simplex and its distance; `None` where there are none.
    pub fn nearest(&self, point: DVec3) -> Option<(f64, &Simplex<CORNERS>)> {
        let (found, squared) = self.0.nearest_neighbor_with_distance_2(point.to_array())?;
        Some((squared.sqrt(), found))
    }

    /// The distance of the nearest simplex; infinite where there are none.
    pub fn distance(&self, point: DVec3) -> f64 {
        self.nearest(point).map_or(f64::INFINITY, |(distance, _)| distance)
    }

    /// Those that are no farther than this.
    pub fn within(&self, point: DVec3, distance: f64) -> impl Iterator<Item = &Simplex<CORNERS>> {
        self.0.locate_within_distance(point.to_array(), distance * distance)
    }
}

/// Products of unit vectors that are rounded to f32 differ by less than this.
const ROUNDING: f32 = 1e-5;

/// Normals of the triangles in a tree.
pub(crate) struct Normals {
    of_triangles: Vec<DVec3>,
    /// Boxes that hold those of each node.
    bounds: Vec<Bounds>,
}

/// The triangles of a surface, in a tree.
pub(crate) struct Triangles {
    boxes: Boxes,
    /// The corners of each, in the order of the tree.
    corners: Vec<[DVec3; 3]>,
}

impl Triangles {
    /// Sorts the triangles of a surface into a tree.
    pub fn new(surface: &Surface) -> Self {
        Self::of(surface.triangle_count() as u32, |t| surface.corners(t as usize).map(|p| p.as_dvec3()))
    }

    /// Sorts so many finite triangles, in unit-sized coordinates, into a tree.
    pub fn of(count: u32, corners: impl Fn(u32) -> [DVec3; 3] + Sync) -> Self {
        // Coordinates that f32 does not have are rounded.
        let boxes = Boxes::of(count, |t| Bounds::of(&corners(t).map(|p| p.as_vec3())).grown(f32::EPSILON));
        let corners = boxes.order().par_iter().map(|&t| corners(t)).collect();
        Self { boxes, corners }
    }

    /// The triangle nearest to a point, and its distance.
    pub fn nearest(&self, point: DVec3) -> (u32, f64) {
        let (mut best, mut squared) = (u32::MAX, f64::INFINITY);
        self.boxes.approach(point, squared, |places| {
            for place in places {
                let distance = squared_distance(point, self.corners[place]);
                if distance < squared {
                    (best, squared) = (self.boxes.order()[place], distance);
                }
            }
            squared
        });
        (best, squared.sqrt())
    }

    /// Bounds these normals of the triangles, for [`nearest_opposed`](Self::nearest_opposed).
    pub fn with_normals(&self, of_triangles: Vec<DVec3>) -> Normals {
        let bounds = |t: u32| Bounds::of(&[of_triangles[t as usize].as_vec3()]).grown(f32::EPSILON);
        Normals { bounds: self.boxes.nodes_of(bounds), of_triangles }
    }

    /// The distance of the nearest triangle whose normal has a cosine below `most` with a direction; `None` where none is nearer than
    /// `farthest`. Parts whose normals all have a larger one are left out, so that the search ends soon where no wall is near.
    pub fn nearest_opposed(
        &self,
        point: DVec3,
        farthest: f64,
        direction: DVec3,
        most: f64,
        normals: &Normals,
    ) -> Option<f64> {
        let (mut found, mut squared) = (false, farthest * farthest);
        let has_some = |node: usize| normals.bounds[node].least_dot(direction.as_vec3()) < most as f32 + ROUNDING;
        self.boxes.approach_some(point, squared, has_some, |places| {
            for place in places {
                if normals.of_triangles[self.boxes.order()[place] as usize].dot(direction) < most {
                    let distance = squared_distance(point, self.corners[place]);
                    (found, squared) = (found || distance < squared, squared.min(distance));
                }
            }
            squared
        });
        found.then(|| squared.sqrt())
    }

    /// The triangles that are no farther than this from a point.
    pub fn within(&self, point: DVec3, distance: f64) -> Vec<u32> {
        let (mut found, squared) = (Vec::new(), distance * distance);
        self.boxes.approach(point, squared, |places| {
            let near = places.filter(|&place| squared_distance(point, self.corners[place]) <= squared);
            found.extend(near.map(|place| self.boxes.order()[place]));
            squared
        });
        found
    }
}

/// The squared distance of a point from a triangle.
pub(crate) fn squared_distance(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let (ab, ac) = (b - a, c - a);
    let normal = ab.cross(ac);
    let inside = [(a, b), (b, c), (c, a)].iter().all(|&(s, e)| (e - s).cross(p - s).dot(normal) >= 0.0);
    if inside && normal.length_squared() > 0.0 {
        return (p - a).dot(normal).powi(2) / normal.length_squared();
    }
    let to_side = |s, e| nearest_on_segment(p, s, e).distance_squared(p);
    to_side(a, b).min(to_side(b, c)).min(to_side(c, a))
}

/// The barycentric coordinates of the point of a triangle that is nearest to `p`.
pub(crate) fn nearest_weights(p: DVec3, [a, b, c]: [DVec3; 3]) -> [f64; 3] {
    let normal = (b - a).cross(c - a);
    let area = normal.length_squared();
    let [second, third] = [(c, a), (a, b)].map(|(s, e)| (e - s).cross(p - s).dot(normal) / area);
    let first = 1.0 - second - third;
    // Of a triangle without area they are no numbers.
    if [first, second, third].iter().all(|&weight| weight >= 0.0) {
        return [first, second, third];
    }
    let corners = [a, b, c];
    let on_side = |k: usize| {
        let (start, end) = (corners[k], corners[(k + 1) % 3]);
        let way = end - start;
        let share = ((p - start).dot(way) / way.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        let mut weights = [0.0; 3];
        (weights[k], weights[(k + 1) % 3]) = (1.0 - share, share);
        ((start + way * share).distance_squared(p), weights)
    };
    let sides = (0..3).map(on_side).min_by(|a, b| a.0.total_cmp(&b.0));
    sides.map_or([1.0, 0.0, 0.0], |(_, weights)| weights)
}

/// The point of a segment, perhaps of no length, that is nearest to `p`.
pub(crate) fn nearest_on_segment(p: DVec3, start: DVec3, end: DVec3) -> DVec3 {
    let way = end - start;
    let share = (p - start).dot(way) / way.length_squared().max(f64::MIN_POSITIVE);
    start + way * share.clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::FeatureOptions;
    use crate::surface::examples::Example;

    #[test]
    fn barycentric_coordinates_give_the_nearest_point() {
        let corners = [DVec3::ZERO, DVec3::new(2.0, 0.0, 1.0), DVec3::new(0.0, 3.0, 0.5)];
        let at = |weights: [f64; 3], corners: [DVec3; 3]| (0..3).map(|k| corners[k] * weights[k]).sum::<DVec3>();
        for weights in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.2, 0.3, 0.5]] {
            let found = nearest_weights(at(weights, corners), corners);
            assert!((0..3).all(|k| (found[k] - weights[k]).abs() < 1e-12), "{found:?}");
        }
        let line = [DVec3::ZERO, DVec3::X, DVec3::X * 3.0];
        for triangle in [corners, line, [DVec3::ONE; 3]] {
            for k in 0..100 {
                let p = DVec3::new((f64::from(k) * 0.7).sin(), (f64::from(k) * 1.3).cos(), f64::from(k) / 50.0) * 3.0;
                let weights = nearest_weights(p, triangle);
                let distance = at(weights, triangle).distance_squared(p);
                assert!(weights.iter().all(|weight| (0.0..=1.0).contains(weight)), "{weights:?}");
                assert!((distance - squared_distance(p, triangle)).abs() < 1e-12, "{p} {weights:?}");
            }
        }
    }

    #[test]
    fn the_tree_finds_what_a_search_of_all_finds() {
        let mut opposed = 0;
        for (name, triangles) in [("m6", 2_000), ("block", 3_000), ("plate", 10)] {
            let soup = name.parse::<Example>().expect("an example's name").generate(triangles);
            let surface = Surface::new(&soup, &FeatureOptions::default()).unwrap_or_else(|error| panic!("{error}"));
            let triangles = Triangles::new(&surface);
            let corners = |t: usize| surface.corners(t).map(|p| p.as_dvec3());
            let normal = |t: usize| surface.normal(t).as_dvec3();
            let normals = triangles.with_normals((0..surface.triangle_count()).map(normal).collect());
            let mut state = 1u32;
            let mut random = || {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                f64::from(state) / f64::from(u32::MAX) - 0.5
            };
            for number in 0..500 {
                // Inside the surface's box, and up to three times as far.
                let scale = [1.0, 3.0][number % 2];
                let point = DVec3::new(random(), random(), random()) * scale;
                let all = (0..surface.triangle_count()).map(|t| squared_distance(point, corners(t)));
                let least = all.min_by(f64::total_cmp).expect("a triangle").sqrt();
                let (nearest, distance) = triangles.nearest(point);
                assert_eq!(distance, least, "{name}, {point}");
                let direction = DVec3::new(random(), random(), random()).normalize();
                let some = (0..surface.triangle_count()).filter(|&t| normal(t).dot(direction) < -0.5);
                let least_opposed = some.map(|t| squared_distance(point, corners(t))).fold(f64::INFINITY, f64::min);
                let found = triangles.nearest_opposed(point, 1.0, direction, -0.5, &normals);
                assert_eq!(found, Some(least_opposed.sqrt()).filter(|least| *least < 1.0), "{name}, {point}");
                opposed += usize::from(found.is_some_and(|found| found > distance));
                assert_eq!(squared_distance(point, corners(nearest as usize)).sqrt(), least, "{name}, {point}");
            }
        }
        assert!(opposed > 100, "{opposed}: the nearest of all are opposed");
    }
}
