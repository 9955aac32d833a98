//! Segments or triangles, to find how far the nearest is from a point.

use crate::surface::nearest::{nearest_on_segment, squared_distance};
use glam::DVec3;
use rstar::{AABB, PointDistance, RTree, RTreeObject};

/// A segment or a triangle.
#[derive(Clone, Copy)]
pub(super) struct Simplex<const CORNERS: usize> {
    corners: [DVec3; CORNERS],
    /// Every search asks many simplices for theirs.
    envelope: AABB<[f64; 3]>,
}

impl<const CORNERS: usize> Simplex<CORNERS> {
    fn new(corners: [DVec3; CORNERS]) -> Self {
        let low = corners.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let high = corners.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        Self { corners, envelope: AABB::from_corners(low.to_array(), high.to_array()) }
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
pub(super) struct Simplices<const CORNERS: usize>(RTree<Simplex<CORNERS>>)
where
    Simplex<CORNERS>: PointDistance;

impl<const CORNERS: usize> Simplices<CORNERS>
where
    Simplex<CORNERS>: RTreeObject<Envelope = AABB<[f64; 3]>> + PointDistance,
{
    /// Sorts finite simplices into a tree.
    pub fn new(simplices: impl Iterator<Item = [DVec3; CORNERS]>) -> Self {
        Self(RTree::bulk_load(simplices.map(Simplex::new).collect()))
    }

    /// How far the nearest is, and its corners; `None` where there are no simplices.
    pub fn nearest(&self, point: DVec3) -> Option<(f64, [DVec3; CORNERS])> {
        let (found, squared) = self.0.nearest_neighbor_with_distance_2(point.to_array())?;
        Some((squared.sqrt(), found.corners))
    }

    /// How far the nearest is; infinitely far where there are no simplices.
    pub fn distance(&self, point: DVec3) -> f64 {
        self.nearest(point).map_or(f64::INFINITY, |(distance, _)| distance)
    }

    /// Those that are no farther than this.
    pub fn within(&self, point: DVec3, distance: f64) -> impl Iterator<Item = [DVec3; CORNERS]> {
        self.0.locate_within_distance(point.to_array(), distance * distance).map(|simplex| simplex.corners)
    }
}
