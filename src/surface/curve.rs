//! Feature curves, parametrized by arc length.

use super::Surface;
use super::nearest::nearest_on_segment;
use glam::DVec3;
use rustc_hash::FxHashMap;

/// A chain of feature edges between two corners, or round from a vertex to itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// The vertices along it; the first is the last again where it is closed.
    pub vertices: Vec<u32>,
    /// A half-edge on each of its edges (one less than vertices), in either direction.
    pub half_edges: Vec<u32>,
    /// Whether it closes without passing a corner.
    pub closed: bool,
    /// The arc length from the first vertex to each vertex, unit-sized.
    pub(crate) arcs: Vec<f64>,
}

impl Curve {
    pub(super) fn new(surface: &Surface, vertices: Vec<u32>, half_edges: Vec<u32>, closed: bool) -> Self {
        let mut arcs = vec![0.0];
        for ends in vertices.windows(2) {
            let [a, b] = [ends[0], ends[1]].map(|v| surface.points[v as usize].as_dvec3());
            arcs.push(arcs[arcs.len() - 1] + a.distance(b));
        }
        Self { vertices, half_edges, closed, arcs }
    }

    /// The length of the curve, unit-sized.
    pub(crate) fn length(&self) -> f64 {
        self.arcs[self.arcs.len() - 1]
    }

    /// The arc length at a share of the way along the half-edge of a segment.
    pub(crate) fn arc(&self, surface: &Surface, segment: usize, half_edge: u32, share: f64) -> f64 {
        let forward = surface.origin(half_edge) == self.vertices[segment];
        let share = if forward { share } else { 1.0 - share };
        self.arcs[segment] + share * (self.arcs[segment + 1] - self.arcs[segment])
    }

    /// The arc length modulo the length of a closed curve, or within an open one.
    pub(crate) fn wrapped(&self, arc: f64) -> f64 {
        if self.closed { arc.rem_euclid(self.length()) } else { arc.clamp(0.0, self.length()) }
    }

    /// The point at an arc length.
    pub(crate) fn point(&self, surface: &Surface, arc: f64) -> DVec3 {
        let arc = self.wrapped(arc);
        let k = self.segment(arc);
        let length = self.arcs[k + 1] - self.arcs[k];
        let share = if length > 0.0 { (arc - self.arcs[k]) / length } else { 0.0 };
        let [a, b] = [k, k + 1].map(|k| surface.points[self.vertices[k] as usize].as_dvec3());
        a.lerp(b, share)
    }

    /// The segment that holds an arc length, from 0 on.
    pub(crate) fn segment(&self, arc: f64) -> usize {
        self.arcs.partition_point(|&passed| passed <= arc).clamp(1, self.arcs.len() - 1) - 1
    }

    /// The farthest distance of the curve between two arc lengths from the chord between them. On a closed curve the second
    /// may be beyond the first vertex, by less than a length.
    pub(crate) fn chord_distance(&self, surface: &Surface, from: f64, to: f64) -> f64 {
        let (from, to) = (from.min(to), from.max(to));
        let [start, end] = [from, to].map(|arc| self.point(surface, arc));
        let rounds: &[f64] = if self.closed { &[-1.0, 0.0, 1.0] } else { &[0.0] };
        let passed = rounds.iter().flat_map(|round| {
            let [first, last] = [from, to].map(|arc| arc - round * self.length());
            let [first, last] = [first, last].map(|arc| self.arcs.partition_point(|&passed| passed <= arc));
            &self.vertices[first..last]
        });
        passed
            .map(|&v| surface.points[v as usize].as_dvec3())
            .map(|point| nearest_on_segment(point, start, end).distance(point))
            .fold(0.0, f64::max)
    }

    /// The signed ways along the curve from one arc length to another; two where the curve is closed.
    pub(crate) fn ways(&self, from: f64, to: f64) -> impl Iterator<Item = f64> {
        let way = to - from;
        let round = self.closed.then(|| way - self.length() * way.signum());
        std::iter::once(way).chain(round)
    }
}

/// Whether each feature curve lies at the places of another one, where sheets of the surface meet.
pub(crate) fn shared_curves(surface: &Surface) -> Vec<bool> {
    let curves = surface.features().curves();
    let mut shared = vec![false; curves.len()];
    if !surface.shared_places().contains(&true) {
        return shared;
    }
    let mut first: FxHashMap<[u32; 2], usize> = FxHashMap::default();
    for (id, curve) in curves.iter().enumerate() {
        for ends in curve.vertices.windows(2) {
            let [a, b] = [ends[0], ends[1]].map(|v| surface.same_place(v));
            let other = *first.entry([a.min(b), a.max(b)]).or_insert(id);
            if other != id {
                (shared[id], shared[other]) = (true, true);
            }
        }
    }
    shared
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::{FeatureOptions, Soup};

    /// A square plate of `n` by `n` cells and side 1; its boundary is one closed curve, or four where corners are kept.
    fn plate(n: u32, corner: f64) -> Surface {
        let at = |i: u32, j: u32| i * (n + 1) + j;
        let points = (0..=n).flat_map(|i| (0..=n).map(move |j| [f64::from(i), f64::from(j), 0.0]));
        let points = points.map(|p| p.map(|x| x / f64::from(n))).collect();
        let cell = |i, j| [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]];
        let triangles = (0..n).flat_map(|i| (0..n).flat_map(move |j| cell(i, j))).collect();
        let options = FeatureOptions { corner, ..FeatureOptions::default() };
        Surface::new(&Soup { points, triangles, ..Soup::default() }, &options).unwrap_or_else(|error| panic!("{error}"))
    }

    #[test]
    fn points_and_arc_lengths_belong_together() {
        let surface = plate(10, 100.0);
        let [curve] = surface.features().curves() else { panic!("one closed curve") };
        assert!(curve.closed);
        let side = curve.length() / 4.0;
        assert!((side - 0.5f64.sqrt()).abs() < 1e-6, "a side of the square over its diagonal: {side}");
        for (k, &h) in curve.half_edges.iter().enumerate() {
            let s = curve.arc(&surface, k, h, 0.25);
            let [a, b] = [surface.origin(h), surface.target(h)].map(|v| DVec3::from(surface.point(v)));
            assert!(curve.point(&surface, s).distance(a.lerp(b, 0.25)) < 1e-7, "segment {k}");
            assert_eq!(curve.segment(s), k);
        }
        assert!(curve.point(&surface, -0.1).distance(curve.point(&surface, curve.length() - 0.1)) < 1e-12);
        let ways: Vec<f64> = curve.ways(0.1, curve.length() - 0.1).collect();
        assert!((ways[1] + 0.2).abs() < 1e-12 && ways[0] > 0.0, "{ways:?}");
    }

    #[test]
    fn a_chord_round_a_corner_leaves_the_curve_by_the_height_of_the_triangle() {
        let surface = plate(10, 100.0);
        let [curve] = surface.features().curves() else { panic!("one closed curve") };
        let side = curve.length() / 4.0;
        // The curve may begin anywhere; corners of the square lie a side apart.
        let corner = (0..curve.vertices.len()).find(|&k| {
            let [x, y, _] = surface.frame().to_model(surface.point(curve.vertices[k]));
            [x, y].iter().all(|c| c.abs() < 1e-6 || (c - 1.0).abs() < 1e-6)
        });
        let s = curve.arcs[corner.expect("a corner of the square")];
        let height = 0.1 * side / 2f64.sqrt();
        let off = |from: f64, to: f64| curve.chord_distance(&surface, from, to);
        assert!((off(s - 0.1 * side, s + 0.1 * side) - height).abs() < 1e-6);
        assert!(off(s, s + 0.5 * side) < 1e-7, "along a side the chord is the curve");
        assert!((off(s + 0.9 * side, s + 1.1 * side) - height).abs() < 1e-6);
    }
}
