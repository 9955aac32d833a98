//! A tree of the bounding boxes of triangles, for pairs that may touch and for the triangles near a point.
//!
//! # Theory
//! Lauterbach et al., "Fast BVH construction on GPUs", 2009: triangles in the order of a space-filling curve are the leaves of a
//! tree. Here it is a complete binary one, so that no pointers are kept.

use crate::progress::{ASKED_EVERY, IsCancelled};
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::ops::Range;

/// Triangles a leaf.
const LEAF: usize = 4;

/// The most nodes that wait in a search: one a level, of at most 2^32 leaves.
const MOST_WAITING: usize = 34;

/// A box, from its lowest corner to its highest one.
#[derive(Clone, Copy)]
pub(super) struct Bounds {
    pub low: Vec3,
    pub high: Vec3,
}

impl Bounds {
    /// The box of nothing.
    pub const EMPTY: Self = Self { low: Vec3::INFINITY, high: Vec3::NEG_INFINITY };

    /// The box of some points.
    pub fn of(points: &[Vec3]) -> Self {
        points.iter().fold(Self::EMPTY, |all, &p| Self { low: all.low.min(p), high: all.high.max(p) })
    }

    /// The box with a margin.
    pub fn grown(self, margin: f32) -> Self {
        Self { low: self.low - margin, high: self.high + margin }
    }

    /// The box of both.
    pub fn joined(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// Whether it lies inside another box and touches none of its sides.
    pub fn is_inside(&self, outer: &Self) -> bool {
        self.low.cmpgt(outer.low).all() && self.high.cmplt(outer.high).all()
    }

    /// The least product of a vector with one in the box.
    pub fn least_dot(&self, vector: Vec3) -> f32 {
        (self.low * vector).min(self.high * vector).element_sum()
    }

    /// The squared distance of a point.
    fn squared_distance(&self, point: DVec3) -> f64 {
        (self.low.as_dvec3() - point).max(point - self.high.as_dvec3()).max(DVec3::ZERO).length_squared()
    }

    fn meets(&self, other: &Self) -> bool {
        self.low.cmple(other.high).all() && other.low.cmple(self.high).all()
    }
}

/// The boxes of the nodes over these boxes.
fn nodes_over(boxes: &[Bounds]) -> Vec<Bounds> {
    let leaves = boxes.len().div_ceil(LEAF).next_power_of_two();
    let mut nodes = vec![Bounds::EMPTY; 2 * leaves];
    for (node, chunk) in nodes[leaves..].iter_mut().zip(boxes.chunks(LEAF)) {
        *node = chunk.iter().fold(Bounds::EMPTY, |all, one| all.joined(*one));
    }
    for k in (1..leaves).rev() {
        nodes[k] = nodes[2 * k].joined(nodes[2 * k + 1]);
    }
    nodes
}

/// The tree.
pub(super) struct Boxes {
    /// The triangles, in the order of the curve.
    order: Vec<u32>,
    /// The box of each of them, in that order.
    boxes: Vec<Bounds>,
    /// The boxes of the nodes: the root is 1, the children of `k` are `2 k` and `2 k + 1`.
    nodes: Vec<Bounds>,
}

impl Boxes {
    /// Sorts triangles in unit-sized coordinates.
    pub fn new(points: &[Vec3], triangles: &[[u32; 3]]) -> Self {
        Self::of(triangles.len() as u32, |t| Bounds::of(&triangles[t as usize].map(|v| points[v as usize])))
    }

    /// Sorts so many triangles, in unit-sized coordinates, that have these boxes.
    pub fn of(count: u32, bounds: impl Fn(u32) -> Bounds + Sync) -> Self {
        let mut keys: Vec<(u64, u32)> = (0..count)
            .into_par_iter()
            .map(|t| {
                let Bounds { low, high } = bounds(t);
                (curve_key((low + high) / 2.0), t)
            })
            .collect();
        keys.par_sort_unstable();
        let order: Vec<u32> = keys.iter().map(|key| key.1).collect();
        let boxes: Vec<Bounds> = order.par_iter().map(|&t| bounds(t)).collect();
        let nodes = nodes_over(&boxes);
        Self { order, boxes, nodes }
    }

    /// Other boxes of all nodes: each holds those of its triangles.
    pub fn nodes_of(&self, bounds: impl Fn(u32) -> Bounds + Sync) -> Vec<Bounds> {
        nodes_over(&self.order.par_iter().map(|&t| bounds(t)).collect::<Vec<Bounds>>())
    }

    /// The triangles, in the order of their places.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// Calls `visit` with the places of triangles whose boxes are no farther from a point than a squared distance, the nearer ones of
    /// two nodes first; it returns the squared distance from then on.
    pub fn approach(&self, point: DVec3, squared: f64, visit: impl FnMut(Range<usize>) -> f64) {
        self.approach_some(point, squared, |_| true, visit);
    }

    /// As [`approach`](Self::approach), without the nodes that are not `wanted`.
    pub fn approach_some(
        &self,
        point: DVec3,
        mut squared: f64,
        wanted: impl Fn(usize) -> bool,
        mut visit: impl FnMut(Range<usize>) -> f64,
    ) {
        let leaves = self.nodes.len() / 2;
        let mut stack = [(1, self.nodes[1].squared_distance(point)); MOST_WAITING];
        let mut waiting = 1;
        while waiting > 0 {
            waiting -= 1;
            let (node, distance) = stack[waiting];
            if distance > squared || !wanted(node) {
                continue;
            }
            if node >= leaves {
                let first = (node - leaves) * LEAF;
                squared = visit(first..(first + LEAF).min(self.order.len()));
                continue;
            }
            let mut children = [2 * node, 2 * node + 1].map(|child| (child, self.nodes[child].squared_distance(point)));
            if children[0].1 < children[1].1 {
                children.swap(0, 1);
            }
            stack[waiting..waiting + 2].copy_from_slice(&children);
            waiting += 2;
        }
    }

    /// Calls `found` for the triangles whose boxes meet this one, from a place in the order on.
    fn search(&self, wanted: &Bounds, from: usize, mut found: impl FnMut(usize)) {
        let leaves = self.nodes.len() / 2;
        // A node, and the places of its leaves.
        let mut stack = [(1, 0, leaves); MOST_WAITING];
        let mut waiting = 1;
        while waiting > 0 {
            waiting -= 1;
            let (node, first, last) = stack[waiting];
            if last * LEAF <= from || !self.nodes[node].meets(wanted) {
                continue;
            }
            if node >= leaves {
                let places = (first * LEAF).max(from)..(last * LEAF).min(self.order.len());
                places.filter(|&place| self.boxes[place].meets(wanted)).for_each(&mut found);
            } else {
                let middle = usize::midpoint(first, last);
                stack[waiting] = (2 * node + 1, middle, last);
                stack[waiting + 1] = (2 * node, first, middle);
                waiting += 2;
            }
        }
    }

    /// The triangles whose boxes meet this one.
    pub fn meeting(&self, wanted: &Bounds) -> Vec<u32> {
        let mut found = Vec::new();
        self.search(wanted, 0, |place| found.push(self.order[place]));
        found
    }

    /// What `test` finds for the pairs of triangles whose boxes are no farther apart than `margin`, sorted; each pair is tested
    /// once. Cancelled, it finds some of them.
    pub fn pairs<T: Send + Ord>(
        &self,
        margin: f32,
        test: impl Fn(u32, u32) -> Option<T> + Sync,
        is_cancelled: &IsCancelled,
    ) -> Vec<T> {
        let from = |place: usize| {
            let (mut of_pairs, t) = (Vec::new(), self.order[place]);
            self.search(&self.boxes[place].grown(margin), place + 1, |other| {
                of_pairs.extend(test(t, self.order[other]));
            });
            of_pairs
        };
        let count = self.order.len();
        let in_part = |part: usize| {
            let start = part * ASKED_EVERY;
            let end = if is_cancelled() { start } else { count.min(start + ASKED_EVERY) };
            (start..end).flat_map(&from)
        };
        let mut found: Vec<T> = (0..count.div_ceil(ASKED_EVERY)).into_par_iter().flat_map_iter(in_part).collect();
        found.par_sort_unstable();
        found
    }
}

/// The place of a point along the Z curve: the interleaved bits of its coordinates, which are from -0.5 to 0.5.
fn curve_key(point: Vec3) -> u64 {
    let spread = |x: f32| {
        let mut bits = ((x + 0.5).clamp(0.0, 1.0) * ((1 << 21) - 1) as f32) as u64;
        for (shift, mask) in [
            (32, 0x001f_0000_0000_ffff),
            (16, 0x001f_0000_ff00_00ff),
            (8, 0x100f_00f0_0f00_f00f),
            (4, 0x10c3_0c30_c30c_30c3),
            (2, 0x1249_2492_4924_9249),
        ] {
            bits = (bits | (bits << shift)) & mask;
        }
        bits
    };
    spread(point.x) | (spread(point.y) << 1) | (spread(point.z) << 2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::examples::Example;
    use std::sync::atomic::{AtomicUsize, Ordering};

    #[test]
    fn the_tree_finds_the_pairs_that_a_search_of_all_finds() {
        let soup = "m6".parse::<Example>().expect("an example").generate(1_500);
        let surface = crate::surface::Surface::new(&soup, &crate::surface::FeatureOptions::default()).expect("a wing");
        let (points, triangles) = (&surface.points, &surface.triangles);
        let boxes = Boxes::new(points, triangles);
        let bounds: Vec<Bounds> = triangles.iter().map(|t| Bounds::of(&t.map(|v| points[v as usize]))).collect();
        for margin in [0.0, 0.01] {
            let found = boxes.pairs(margin, |s, t| Some([s.min(t), s.max(t)]), &|| false);
            let all = (0..triangles.len()).flat_map(|s| (s + 1..triangles.len()).map(move |t| [s, t]));
            let near = all.filter(|&[s, t]| bounds[s].grown(margin).meets(&bounds[t]));
            let wanted: Vec<[u32; 2]> = near.map(|pair| pair.map(|t| t as u32)).collect();
            assert_eq!(found, wanted, "margin {margin}");
            assert!(found.len() > 6 * triangles.len() / 2, "neighbours touch");
        }
    }

    #[test]
    fn the_search_asks_often_whether_it_is_cancelled() {
        let soup = "sphere".parse::<Example>().expect("an example").generate(20_000);
        let triangles = &soup.triangles;
        let points: Vec<Vec3> = soup.points.iter().map(|p| glam::DVec3::from(*p).as_vec3() / 4.0).collect();
        let boxes = Boxes::new(&points, triangles);
        let asked = AtomicUsize::new(0);
        let found = |last: usize| {
            asked.store(0, Ordering::Relaxed);
            let is_cancelled = || asked.fetch_add(1, Ordering::Relaxed) >= last;
            boxes.pairs(0.0, |s, t| Some([s, t]), &is_cancelled).len()
        };
        let all = found(usize::MAX);
        assert_eq!(asked.load(Ordering::Relaxed), triangles.len().div_ceil(ASKED_EVERY));
        let some = found(4);
        assert!(0 < some && some < all / 2 && found(0) == 0, "{some} of {all}");
    }
}
