//! Boundaries that the mesh keeps, so that patches of one surface that are meshed apart fit together.
//!
//! # Theory
//! The vertices of the mesh on a kept boundary are the kept vertices of the surface, no others. Either all vertices of the boundary
//! are kept, or points at equal arc lengths between its corners are inserted as vertices and kept. These depend on the curve
//! alone: each curve is run through in the direction that its coordinates give, so both sides of a seam have the same points, bit for
//! bit.
//!
//! # Practice
//! A corner is a sharp turn of the curve. Where three patches meet, the boundaries of all three must have a corner to be resampled
//! alike; vertices that are kept as they are fit anywhere. Vertices of a seam that differ by rounding alone are welded, perhaps not alike
//! in both patches. Edges at which sheets meet are no boundary.

use super::features::turns_sharply;
use super::split::{EdgePoint, Split};
use super::{FeatureOptions, Features, Surface};
use glam::DVec3;
use rustc_hash::{FxHashMap, FxHashSet};
use std::str::FromStr;
use thiserror::Error;

/// A sample nearer to a vertex of the boundary than this, in asked sides, is on it.
const SNAP: f64 = 0.02;

/// The boundary vertices of a mesh, where it keeps the boundary of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum KeptBoundary {
    /// The vertices of the surface's boundary.
    Exact,
    /// Points of the surface's boundary about so far apart, in model units: its corners, and an even number of equal intervals
    /// between them.
    Resampled(f64),
}

/// A text is no [`KeptBoundary`].
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[error(
    "write exact, to keep the vertices of the boundary, or the distance of points along it, a number above 0 in model units"
)]
pub struct NoKeptBoundary;

impl FromStr for KeptBoundary {
    type Err = NoKeptBoundary;

    /// `exact`, `0.05`.
    fn from_str(text: &str) -> Result<Self, NoKeptBoundary> {
        if text == "exact" {
            return Ok(Self::Exact);
        }
        let side = text.parse().ok().filter(|side: &f64| side.is_finite() && *side > 0.0);
        side.map(Self::Resampled).ok_or(NoKeptBoundary)
    }
}

/// Why a boundary cannot be kept.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum BoundaryError {
    /// The distance of points is no length.
    #[error("points on the boundary cannot be {side} apart; give a number above 0, in model units")]
    Side {
        /// The distance that was asked for.
        side: f64,
    },
    /// The mesh is to be symmetric too.
    #[error("a mesh with a plane of symmetry cannot keep the boundary of its surface; ask for one of the two")]
    Symmetry,
}

/// A part of the boundary: its vertices in order, round a loop or between two ends.
struct Chain {
    vertices: Vec<u32>,
    is_loop: bool,
}

impl Surface {
    /// The same surface, with a boundary that the mesh keeps.
    ///
    /// # Errors
    /// Where the distance of points is no length.
    pub(crate) fn with_kept_boundary(
        mut self,
        kept: KeptBoundary,
        options: &FeatureOptions,
    ) -> Result<Self, BoundaryError> {
        match kept {
            KeptBoundary::Exact => {
                self.kept = self.chains().into_iter().flat_map(|chain| chain.vertices).collect();
            }
            KeptBoundary::Resampled(side) if side.is_finite() && side > 0.0 => self.resample(side, options),
            KeptBoundary::Resampled(side) => return Err(BoundaryError::Side { side }),
        }
        self.kept.sort_unstable();
        self.features = Features::along(&self, self.features.marked(), options.corner, self.features.reach);
        Ok(self)
    }

    /// Whether the mesh keeps the boundary of the surface, and there is one.
    pub(crate) fn keeps_boundary(&self) -> bool {
        !self.kept.is_empty()
    }

    /// Whether a vertex is one of a boundary that the mesh keeps.
    pub(crate) fn is_kept(&self, vertex: u32) -> bool {
        self.kept.binary_search(&vertex).is_ok()
    }

    /// The vertices of a kept boundary that are not kept.
    pub(super) fn passed_vertices(&self) -> Vec<u32> {
        if !self.keeps_boundary() {
            return Vec::new();
        }
        self.chains().into_iter().flat_map(|chain| chain.vertices).filter(|&v| !self.is_kept(v)).collect()
    }

    /// The ends of the edges of a kept boundary.
    pub(crate) fn kept_edges(&self) -> impl Iterator<Item = [u32; 2]> {
        self.kept_runs().into_iter().map(|run| [run[0], run[run.len() - 1]])
    }

    /// The vertices of a kept boundary from each kept one to the next.
    fn kept_runs(&self) -> Vec<Vec<u32>> {
        if !self.keeps_boundary() {
            return Vec::new();
        }
        let mut runs = Vec::new();
        for Chain { mut vertices, is_loop } in self.chains() {
            if is_loop {
                let first = vertices.iter().position(|&v| self.is_kept(v)).unwrap_or(0);
                vertices.rotate_left(first);
                vertices.push(vertices[0]);
            }
            let mut run = vec![vertices[0]];
            for &v in &vertices[1..] {
                run.push(v);
                if self.is_kept(v) {
                    runs.push(std::mem::replace(&mut run, vec![v]));
                }
            }
        }
        runs
    }

    /// The length of a kept boundary's edges at its vertices, unit-sized: the mean of the two at a kept vertex.
    pub(crate) fn kept_lengths(&self) -> Vec<(u32, f64)> {
        let place = |v: u32| self.points[v as usize].as_dvec3();
        let length = |run: &[u32]| run.windows(2).map(|ends| place(ends[0]).distance(place(ends[1]))).sum::<f64>();
        let mut lengths: Vec<(u32, f64)> = Vec::new();
        for run in self.kept_runs() {
            let length = length(&run);
            lengths.extend(run.into_iter().map(|v| (v, length)));
        }
        lengths.sort_unstable_by_key(|&(v, _)| v);
        let mean = |of_one: &[(u32, f64)]| {
            (of_one[0].0, of_one.iter().map(|&(_, length)| length).sum::<f64>() / of_one.len() as f64)
        };
        lengths.chunk_by(|a, b| a.0 == b.0).map(mean).collect()
    }

    /// The boundary, without edges at which sheets meet.
    fn chains(&self) -> Vec<Chain> {
        let open: Vec<[u32; 2]> = (0..3 * self.triangle_count() as u32)
            .filter(|&h| self.twin(h).is_none())
            .map(|h| [self.origin(h), self.target(h)])
            .collect();
        let place = |&ends: &[u32; 2]| sorted(ends.map(|v| self.same_place(v)));
        let mut sheets: FxHashMap<[u32; 2], usize> = FxHashMap::default();
        open.iter().for_each(|ends| *sheets.entry(place(ends)).or_default() += 1);
        let open: Vec<[u32; 2]> = open.into_iter().filter(|ends| sheets[&place(ends)] == 1).collect();
        let mut next: FxHashMap<u32, u32> = open.iter().map(|&[a, b]| (a, b)).collect();
        let ends: FxHashSet<u32> = open.iter().map(|&[_, b]| b).collect();
        let mut chains = Vec::new();
        let starts = open.iter().map(|&[a, _]| a);
        for start in starts.clone().filter(|a| !ends.contains(a)).chain(starts) {
            let mut vertices = vec![start];
            let mut at = start;
            while let Some(after) = next.remove(&at) {
                vertices.push(after);
                at = after;
            }
            let is_loop = at == start && vertices.len() > 1;
            if is_loop {
                vertices.pop();
            }
            if vertices.len() > 1 {
                chains.push(Chain { vertices, is_loop });
            }
        }
        chains
    }

    /// Keeps points about so far apart, in model units, and inserts them where they lie between vertices.
    fn resample(&mut self, side: f64, options: &FeatureOptions) {
        let mut waiting: Vec<([u32; 2], Vec<DVec3>)> = Vec::new();
        for Chain { vertices, is_loop } in self.chains() {
            let points: Vec<DVec3> = vertices.iter().map(|&v| DVec3::from(self.model_point(v))).collect();
            for sample in samples(&points, is_loop, side, options.corner) {
                match sample {
                    Sample::Vertex(i) => self.kept.push(vertices[i]),
                    Sample::Between(ends, point) => {
                        let ends = ends.map(|i| vertices[i]);
                        match waiting.last_mut().filter(|(last, _)| *last == ends) {
                            Some((_, points)) => points.push(point),
                            None => waiting.push((ends, vec![point])),
                        }
                    }
                }
            }
        }
        // An edge is cut at one point at a time.
        while !waiting.is_empty() {
            let open = (0..3 * self.triangle_count() as u32).filter(|&h| self.twin(h).is_none());
            let half_edges: FxHashMap<[u32; 2], u32> =
                open.map(|h| (sorted([self.origin(h), self.target(h)]), h)).collect();
            let (mut lines, mut inserted, mut rest) = (Vec::new(), Vec::new(), Vec::new());
            for ([a, b], mut points) in waiting {
                let h = half_edges[&sorted([a, b])];
                let after = points.split_off(points.len() / 2 + 1);
                let Some(point) = points.pop() else { continue };
                let [from, to] = [self.origin(h), self.target(h)].map(|v| DVec3::from(self.model_point(v)));
                lines.push(vec![EdgePoint::Edge(h, from.distance(point) / from.distance(to))]);
                let vertex = (self.vertex_count() + inserted.len()) as u32;
                inserted.push(point);
                rest.extend([([a, vertex], points), ([vertex, b], after)].into_iter().filter(|(_, p)| !p.is_empty()));
            }
            let first = self.vertex_count() as u32;
            let places = first..first + inserted.len() as u32;
            self.kept.extend(places.clone());
            let split = Split::along(self, &lines);
            self.replace(split, places.clone(), options);
            for (v, point) in places.zip(inserted) {
                self.given.points[v as usize] = point.into();
            }
            waiting = rest;
        }
    }
}

fn sorted([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// A point of a polyline.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Sample {
    Vertex(usize),
    /// Between two vertices.
    Between([usize; 2], DVec3),
}

/// The samples of a polyline about `side` apart: its ends where it is no loop, its turns by more than `corner` degrees, and an
/// even number of equal intervals between them. Those between the same two vertices follow each other. All vertices, where there
/// are no three samples.
fn samples(points: &[DVec3], is_loop: bool, side: f64, corner: f64) -> Vec<Sample> {
    let count = points.len();
    let cos_corner = corner.to_radians().cos();
    let after = |i: usize| (1..if is_loop { count } else { count - i }).map(move |k| points[(i + k) % count]);
    let before = |i: usize| (1..if is_loop { count } else { i + 1 }).map(move |k| points[(i + count - k) % count]);
    let is_end = |i: usize| !is_loop && (i == 0 || i + 1 == count);
    let is_corner = |&i: &usize| is_end(i) || turns_sharply(points[i], after(i), before(i), side, cos_corner);
    let mut ends: Vec<usize> = (0..count).filter(is_corner).collect();
    let order = |i: usize, j: usize| {
        let [p, q] = [points[i], points[j]];
        p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y)).then(p.z.total_cmp(&q.z))
    };
    if ends.is_empty() {
        ends.extend((0..count).min_by(|&i, &j| order(i, j)));
    }
    let mut samples: Vec<Sample> = ends.iter().map(|&i| Sample::Vertex(i)).collect();
    let lasts = ends.iter().copied().cycle().skip(1);
    let curves = ends.iter().copied().zip(lasts).take(if is_loop { ends.len() } else { ends.len() - 1 });
    for (first, last) in curves {
        let length = (last + count - first - 1) % count + 1;
        let mut curve: Vec<usize> = (first..=first + length).map(|i| i % count).collect();
        let ways = curve.iter().zip(curve.iter().rev()).map(|(&i, &j)| order(i, j));
        if ways.into_iter().find(|way| way.is_ne()).is_some_and(|way| way.is_gt()) {
            curve.reverse();
        }
        samples.extend(inner_samples(points, &curve, side));
    }
    if samples.len() < 3 { (0..count).map(Sample::Vertex).collect() } else { samples }
}

/// The samples between the ends of a curve, which is given by its vertices.
fn inner_samples(points: &[DVec3], curve: &[usize], side: f64) -> Vec<Sample> {
    let mut arcs = vec![0.0];
    for ends in curve.windows(2) {
        arcs.push(arcs[arcs.len() - 1] + points[ends[0]].distance(points[ends[1]]));
    }
    let length = arcs[arcs.len() - 1];
    let least = if curve[0] == curve[curve.len() - 1] { 4 } else { 2 };
    let intervals = (2 * (length / (2.0 * side)).round() as usize).max(least);
    let sample = |k: usize| {
        let arc = length * k as f64 / intervals as f64;
        let edge = arcs.partition_point(|&passed| passed <= arc).clamp(1, arcs.len() - 1) - 1;
        let ends = [curve[edge], curve[edge + 1]];
        let [from, to] = [arc - arcs[edge], arcs[edge + 1] - arc];
        let snap = SNAP * side.min(length / intervals as f64);
        match () {
            () if from <= snap => Sample::Vertex(ends[0]),
            () if to <= snap => Sample::Vertex(ends[1]),
            () => {
                let [a, b] = ends.map(|i| points[i]);
                Sample::Between(ends, a + (b - a) * (from / (arcs[edge + 1] - arcs[edge])))
            }
        }
    };
    (1..intervals).map(sample).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A loop of three quarters of a circle, finely divided, and two straight sides to its centre.
    fn outline() -> Vec<DVec3> {
        let arc = (0..=60).map(|k| {
            let (y, x) = (0.3 + f64::from(k) * 0.075).sin_cos();
            DVec3::new(x, y, 0.1 * x * y)
        });
        arc.chain([DVec3::ZERO]).collect()
    }

    fn places(points: &[DVec3], is_loop: bool, side: f64) -> Vec<[u64; 3]> {
        let place = |sample: Sample| match sample {
            Sample::Vertex(i) => points[i],
            Sample::Between(_, point) => point,
        };
        let samples = samples(points, is_loop, side, 50.0).into_iter().map(place);
        let mut places: Vec<[u64; 3]> = samples.map(|p| p.to_array().map(f64::to_bits)).collect();
        places.sort_unstable();
        places
    }

    #[test]
    fn samples_do_not_depend_on_direction_or_start() {
        let points = outline();
        for side in [0.05, 0.11, 0.3, 2.0] {
            let expected = places(&points, true, side);
            let mut turned = points.clone();
            turned.rotate_left(17);
            assert_eq!(places(&turned, true, side), expected);
            turned.reverse();
            assert_eq!(places(&turned, true, side), expected);
            turned.iter_mut().for_each(|point| point.x *= 1.001);
            assert_ne!(places(&turned, true, side), expected, "another curve has other samples");
        }
    }

    #[test]
    fn the_samples_of_a_seam_do_not_depend_on_the_rest_of_the_patch() {
        let points = outline();
        // The straight sides, joined by another outline.
        let mut other: Vec<DVec3> = [points[60], DVec3::ZERO, points[0]].into();
        other.extend([DVec3::new(2.0, -1.0, 0.0), DVec3::new(-1.0, -2.0, 0.0)]);
        let on_seam = |points: &[DVec3]| -> Vec<[u64; 3]> {
            let [start, end] = [outline()[0], outline()[60]];
            let lies = |p: &DVec3| {
                [start, end]
                    .iter()
                    .any(|q| p.cross(*q).length() < 1e-12 && p.dot(*q) > -1e-12 && p.length() <= q.length())
            };
            places(points, true, 0.1).into_iter().filter(|p| lies(&DVec3::from(p.map(f64::from_bits)))).collect()
        };
        assert_eq!(on_seam(&other), on_seam(&points));
        assert_eq!(on_seam(&points).len(), 21, "the corners, and ten intervals on each side of length 1");
    }

    #[test]
    fn intervals_are_equal_and_even_and_near_the_asked_side() {
        let points: Vec<DVec3> = (0..=100).map(|k| DVec3::X * f64::from(k).powi(2) / 1e4).collect();
        for side in [0.013, 0.1, 0.24, 0.7] {
            let mut places: Vec<f64> = places(&points, false, side).iter().map(|p| f64::from_bits(p[0])).collect();
            places.sort_by(f64::total_cmp);
            let intervals = places.len() - 1;
            assert_eq!(intervals % 2, 0);
            let mean = 1.0 / intervals as f64;
            let nearest = 2.0 * (1.0 / (2.0 * side)).round().max(1.0);
            assert_eq!(intervals as f64, nearest, "{side}");
            assert!(places.windows(2).all(|p| (p[1] - p[0] - mean).abs() <= 2.0 * SNAP * side), "{side}");
        }
    }

    #[test]
    fn kept_boundaries_are_read() {
        assert_eq!("exact".parse(), Ok(KeptBoundary::Exact));
        assert_eq!("2.5e-1".parse(), Ok(KeptBoundary::Resampled(0.25)));
        for refused in ["", "0", "-1", "nan", "inf", "Exact", "0.1x"] {
            assert_eq!(refused.parse::<KeptBoundary>(), Err(NoKeptBoundary), "{refused}");
        }
    }
}
