//! Divides long edges, so that values at the surface's vertices can vary within a few tiles. The shape stays.
//!
//! # Practice
//! Long edges are halved, again and again. Inside a thin triangle this would give three parts every time; there the inner edges
//! wait until the outer ones are short, and are flipped between the parts, which gives strips of two (docs/experiments.md,
//! surface).

use super::split::{EdgePoint, Split};
use super::{DroppedEdge, FeatureOptions, Features, Surface};
use rustc_hash::FxHashMap;

/// Triangles of a worse shape than this are thin.
const THIN: f64 = 0.4;

impl Surface {
    /// The same surface with no edge longer than `longest` at its two ends, in unit-sized coordinates; and the two ends of the
    /// edge in whose middle each new vertex lies.
    pub(crate) fn divided(mut self, mut longest: Vec<f64>, options: &FeatureOptions) -> (Self, Vec<[u32; 2]>) {
        let mut added = Vec::new();
        let mut roots: Vec<u32> = (0..self.triangle_count() as u32).collect();
        let is_thin: Vec<bool> = roots.iter().map(|&t| self.shape(t) < THIN).collect();
        loop {
            let ends = |h: u32| [self.origin(h), self.target(h)].map(|v| longest[v as usize]);
            let allowed = |h: u32| ends(h)[0].min(ends(h)[1]);
            let long = |&h: &u32| self.twin(h).is_none_or(|twin| h < twin) && self.length(h) > allowed(h);
            let mut middles: Vec<u32> = (0..3 * self.triangle_count() as u32).filter(long).collect();
            let root = |h: u32| roots[h as usize / 3] as usize;
            let is_inside = |h: u32| self.twin(h).is_some_and(|twin| root(h) == root(twin));
            let mut waits = vec![false; is_thin.len()];
            for &h in middles.iter().filter(|&&h| !is_inside(h)) {
                [Some(h), self.twin(h)].into_iter().flatten().for_each(|side| waits[root(side)] = is_thin[root(side)]);
            }
            middles.retain(|&h| !is_inside(h) || !waits[root(h)]);
            if middles.is_empty() {
                return (self, added);
            }
            // The middles are the vertices that are added, in their order.
            let between: Vec<f64> = middles.iter().map(|&h| (ends(h)[0] + ends(h)[1]) / 2.0).collect();
            longest.extend(between);
            added.extend(middles.iter().map(|&h| [self.origin(h), self.target(h)]));
            self.halve(&middles, &mut roots, options);
        }
    }

    /// About the number of triangles once no edge is longer than `longest`, unit-sized.
    pub(crate) fn parts(&self, longest: f64) -> usize {
        let parts = |t: usize| {
            let [a, b, c] = self.corners(t).map(|p| p.as_dvec3());
            let length = a.distance(b).max(b.distance(c)).max(c.distance(a));
            let height = (b - a).cross(c - a).length() / length.max(f64::MIN_POSITIVE);
            (2.0 * length / longest).max(1.0) * (height / longest).max(1.0)
        };
        (0..self.triangle_count()).map(parts).sum::<f64>() as usize
    }

    /// Twice the area of a triangle over its squared longest side: 0.87 where all sides are equal.
    fn shape(&self, triangle: u32) -> f64 {
        let [a, b, c] = self.corners(triangle as usize).map(|p| p.as_dvec3());
        let longest = a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a));
        (b - a).cross(c - a).length() / longest.max(f64::MIN_POSITIVE)
    }

    /// Halves edges and updates `roots`, the triangle that each one is a part of.
    fn halve(&mut self, edges: &[u32], roots: &mut Vec<u32>, options: &FeatureOptions) {
        let lines: Vec<Vec<EdgePoint>> = edges.iter().map(|&h| vec![EdgePoint::Edge(h, 0.5)]).collect();
        // Where sheets meet, the edges of all of them are divided at one place.
        let mut first = FxHashMap::default();
        let middles = (self.points.len() as u32..).zip(edges).map(|(middle, &h)| {
            let [a, b] = [self.origin(h), self.target(h)].map(|v| self.same_place(v));
            if !self.features.is_feature(h) {
                return middle;
            }
            *first.entry([a.min(b), a.max(b)]).or_insert(middle)
        });
        let middles: Vec<u32> = middles.collect();
        let mut split = Split::along(self, &lines);
        *roots = split.sources.iter().map(|&source| roots[source as usize]).collect();
        split.reshape(roots);
        self.replace(split, middles, options);
    }

    /// Takes the parts of triangles in place of the whole ones. `places` gives, for each added vertex, the first vertex at its
    /// place.
    pub(super) fn replace(&mut self, split: Split, places: impl IntoIterator<Item = u32>, options: &FeatureOptions) {
        let parts = |h: &u32| split.parts[*h as usize];
        let mut marked = vec![false; 3 * split.triangles.len()];
        let features = (0..split.parts.len() as u32).filter(|&h| self.features.is_feature(h));
        features.flat_map(|h| parts(&h)).chain(split.on_lines.iter().copied()).for_each(|h| marked[h as usize] = true);
        self.named = self.named.iter().flat_map(parts).collect();
        let dropped = |&edge: &DroppedEdge| {
            let [first, second] = parts(&edge.half_edge);
            let second = Some(second).filter(|second| *second != first);
            [Some(first), second].into_iter().flatten().map(move |half_edge| DroppedEdge { half_edge, ..edge })
        };
        self.dropped = self.dropped.iter().flat_map(dropped).collect();
        self.name(split.on_lines);
        self.regions = self.regions.of(&split.sources);
        self.same_place.extend(places);
        (self.points, self.triangles, self.twins) = (split.points, split.triangles, split.twins);
        self.features = Features::along(self, marked, options.corner, self.features.reach);
    }
}
