//! What is nearest to a point: segments or triangles in a tree of their boxes.

use super::Surface;
use glam::DVec3;
use rayon::prelude::*;
use rstar::{AABB, PointDistance, RTree, RTreeObject};

/// A segment or a triangle.
#[derive(Clone, Copy)]
pub(crate) struct Simplex<const CORNERS: usize> {
    pub corners: [DVec3; CORNERS],
    /// Its place among all.
    pub id: u32,
    /// Every search asks many simplices for theirs.
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

    /// The nearest and how far it is; `None` where there are no simplices.
    pub fn nearest(&self, point: DVec3) -> Option<(f64, &Simplex<CORNERS>)> {
        let (found, squared) = self.0.nearest_neighbor_with_distance_2(point.to_array())?;
        Some((squared.sqrt(), found))
    }

    /// How far the nearest is; infinitely far where there are no simplices.
    pub fn distance(&self, point: DVec3) -> f64 {
        self.nearest(point).map_or(f64::INFINITY, |(distance, _)| distance)
    }

    /// Those that are no farther than this.
    pub fn within(&self, point: DVec3, distance: f64) -> impl Iterator<Item = &Simplex<CORNERS>> {
        self.0.locate_within_distance(point.to_array(), distance * distance)
    }
}

/// So many trees hold a surface's triangles: they are planted at the same time.
const TREES: usize = 8;

/// The triangles of a surface.
pub(crate) struct Triangles {
    trees: Vec<Simplices<3>>,
    /// How many are in each but the last.
    each: usize,
}

impl Triangles {
    /// Sorts them into trees.
    pub fn new(surface: &Surface) -> Self {
        let each = surface.triangle_count().div_ceil(TREES);
        let corners = |t| surface.corners(t).map(|p| p.as_dvec3());
        let tree = |first: usize| (first..(first + each).min(surface.triangle_count())).map(corners);
        let trees = (0..TREES).into_par_iter().map(|k| Simplices::new(tree(k * each))).collect();
        Self { trees, each }
    }

    /// The triangle nearest to a point, and how far it is.
    pub fn nearest(&self, point: DVec3) -> (u32, f64) {
        let found = (0..).zip(&self.trees).filter_map(|(k, tree)| Some((k, tree.nearest(point)?)));
        let nearest = found.min_by(|(_, a), (_, b)| a.0.total_cmp(&b.0));
        let (k, (distance, triangle)) = nearest.expect("a surface has triangles");
        (k * self.each as u32 + triangle.id, distance)
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
    fn the_tree_finds_what_a_search_of_all_finds() {
        for (name, triangles) in [("m6", 2_000), ("block", 3_000), ("plate", 10)] {
            let soup = name.parse::<Example>().expect("an example's name").generate(triangles);
            let surface = Surface::new(&soup, &FeatureOptions::default()).unwrap_or_else(|error| panic!("{error}"));
            let triangles = Triangles::new(&surface);
            let corners = |t: usize| surface.corners(t).map(|p| p.as_dvec3());
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
                assert_eq!(squared_distance(point, corners(nearest as usize)).sqrt(), least, "{name}, {point}");
            }
        }
    }
}
