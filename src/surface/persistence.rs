//! The persistence of creases at the scale of tiles: those that do not persist are no features.
//!
//! # Theory
//! The persistence of a crease is its length in tile sides, each part weighted by the square of the angle by which the surface
//! turns there [at the scale of a tile](super::turning). Convex and concave parts cancel. So a long sharp edge persists; a short
//! one, the rims of a groove narrower than a tile, and creases of noise do not.
//!
//! A crease in rough surroundings must be the more persistent, the more dropped creases are near it: it must differ from them.
//!
//! The least persistent crease is dropped first. Two curves that are left at a corner and do not turn there become one, whose
//! persistence is the sum: a long crease stays when its branches are dropped, and a weak part of it stays with the strong ones,
//! which is hysteresis.
//!
//! # Practice
//! Creases by angle alone are dropped, not open boundaries, seams, named edges, borders of regions or ridges. With
//! [`FeatureOptions::every_crease`] the length alone counts.

use super::nearest::nearest_on_segment;
use super::turning::turn;
use super::{Curve, DroppedEdge, FeatureOptions, NONE, Reason, Surface, features};
use glam::DVec3;
use rayon::prelude::*;
use rstar::RTree;
use rstar::primitives::GeomWithData;
use rustc_hash::FxHashMap;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// The least persistence of an open crease.
const OPEN: f64 = 1.5;
/// The least persistence of a closed crease, with one corner or none.
const CLOSED: f64 = 5.0;
/// A turn by this angle, in degrees, is none: smooth surfaces and noise turn by as much.
const NO_TURN: f64 = 20.0;
/// A turn by this angle more, in degrees, has the weight 1.
const UNIT_TURN: f64 = 45.0;
/// The largest weight, that of a sharp edge.
const MOST_WEIGHT: f64 = 3.0;
/// The length of the walks on either side, in tile sides: steps and grooves of less than some 0.4 tiles turn back within it.
const REACH: f64 = 1.0;
/// The longest walk over the root of the surface's area: tiles as large as a part see round it.
const MOST_REACH: f64 = 0.1;
/// Two creases with the same ends that are nowhere farther apart, in tile sides, are one.
const LEAST_APART: f64 = 0.15;
/// The distance from a crease within which dropped ones make the surface rough, in tile sides.
const NEAR: f64 = 1.5;
/// The share of the least persistence that each tile side of dropped creases there adds to it.
const ROUGHNESS: f64 = 0.5;
/// The distance between the points of a crease at which turns and roughness are measured, in tile sides.
const SPACING: f64 = 0.25;
/// The most such points of all creases: their distance grows where slivers have more creases than tiles can follow.
const MOST_POINTS: f64 = 100_000.0;
/// ... or so many for each tile, where this is more.
const POINTS_PER_TILE: f64 = 16.0;

/// The features that persist, and the creases that do not.
pub(super) struct Persistent {
    /// Whether each half-edge is a feature.
    pub marked: Vec<bool>,
    /// The edges of the dropped creases.
    pub dropped: Vec<DroppedEdge>,
}

/// The features of a surface that persist for tiles of a side, unit-sized; or for tiles of `sides` at the vertices, where these are
/// given.
pub(super) fn persistent(surface: &Surface, options: &FeatureOptions, side: f64, sides: Option<&[f64]>) -> Persistent {
    let side_along = |h: u32| {
        let ends = [surface.origin(h), surface.target(h)];
        sides.map_or(side, |sides| ends.map(|v| sides[v as usize]).iter().sum::<f64>() / 2.0)
    };
    let mut pieces = Pieces::new(surface, options, side, side_along);
    let mut creases: Vec<(Reason, Vec<(u32, f32)>)> = Vec::new();
    pieces.drop_weak(&mut creases);
    if !options.every_crease {
        pieces.measure_roughness(&creases, side);
        pieces.drop_weak(&mut creases);
    }
    for id in pieces.doubles(LEAST_APART * side) {
        creases.push((Reason::Double, pieces.drop_piece(id)));
    }
    let edges_of = |(crease, (reason, edges)): (u32, (Reason, Vec<(u32, f32)>))| {
        edges.into_iter().map(move |(half_edge, turn)| DroppedEdge { half_edge, crease, turn, reason })
    };
    let dropped = (0..).zip(creases).flat_map(edges_of).collect();
    let mut marked = vec![false; 3 * surface.triangle_count()];
    for &(h, _) in pieces.list.iter().flatten().flat_map(|piece| &piece.edges) {
        marked[h as usize] = true;
        if surface.twins[h as usize] != NONE {
            marked[surface.twins[h as usize] as usize] = true;
        }
    }
    Persistent { marked, dropped }
}

/// The weight of a turn, in degrees; negative where it is concave.
fn weight(turn: f64) -> f64 {
    ((turn.abs() - NO_TURN).max(0.0) / UNIT_TURN).powi(2).min(MOST_WEIGHT).copysign(turn)
}

/// The half-edges of a crease, each with the turn in degrees at its first measured point, and the persistence of the crease.
fn measured(
    surface: &Surface,
    half_edges: &[u32],
    side_along: impl Fn(u32) -> f64,
    most_reach: f64,
    spacing: f64,
) -> (Vec<(u32, f32)>, f64) {
    // The rest of the distance to the next measured point, in tile sides, and the turn at the last one.
    let (mut rest, mut last, mut sum) = (0.0, 0.0, 0.0);
    let edges = half_edges.iter().map(|&h| {
        let side = side_along(h);
        let reach = (REACH * side).min(most_reach) as f32;
        let length = surface.length(h) / side;
        let (mut at, mut first) = (0.0, None);
        while at < length {
            if rest <= 0.0 {
                let middle = at + (length - at).min(spacing) / 2.0;
                last = turn(surface, h, (middle / length) as f32, reach).to_degrees();
                rest = spacing;
            }
            let step = rest.min(length - at);
            sum += weight(last) * step;
            first = first.or(Some(last));
            (rest, at) = (rest - step, at + step);
        }
        (h, first.unwrap_or(last) as f32)
    });
    (edges.collect(), sum)
}

/// A curve, or several in a row.
struct Piece {
    /// Its ends; none where it is closed.
    ends: Option<[u32; 2]>,
    /// Its half-edges from the first end to the last, each with its turn in degrees.
    edges: Vec<(u32, f32)>,
    /// In tile sides.
    length: f64,
    /// Negative where it is concave.
    persistence: f64,
    /// The mean length of the dropped creases near it, in tile sides, times its length.
    roughness: f64,
    may_go: bool,
}

struct Pieces<'a> {
    surface: &'a Surface,
    cos_corner: f64,
    list: Vec<Option<Piece>>,
    /// The pieces that end at each corner; one that ends there twice is named twice.
    at: FxHashMap<u32, Vec<u32>>,
    /// Those that may go, the least persistent first, by the bits of their persistences.
    queue: BinaryHeap<Reverse<(u64, u32)>>,
}

impl<'a> Pieces<'a> {
    fn new(surface: &'a Surface, options: &FeatureOptions, side: f64, side_along: impl Fn(u32) -> f64 + Sync) -> Self {
        let cos_corner = options.corner.to_radians().cos();
        let most_reach = MOST_REACH * surface.area().sqrt();
        let length = |curve: &Curve| curve.half_edges.iter().map(|&h| surface.length(h) / side_along(h)).sum::<f64>();
        let curves = surface.features.curves();
        let most_points = MOST_POINTS.max(POINTS_PER_TILE * surface.area() / side.powi(2));
        let spacing = SPACING.max(curves.iter().map(length).sum::<f64>() / most_points);
        let mut pieces =
            Self { surface, cos_corner, list: Vec::new(), at: FxHashMap::default(), queue: BinaryHeap::new() };
        let piece = |curve: &Curve| {
            let is_kept = |&h: &u32| surface.twin(h).is_none() || surface.is_named(h);
            let may_go = !curve.half_edges.iter().any(is_kept);
            let length = length(curve);
            let (edges, persistence) = match may_go && !options.every_crease {
                true => measured(surface, &curve.half_edges, &side_along, most_reach, spacing),
                false => (curve.half_edges.iter().map(|&h| (h, 180.0)).collect(), MOST_WEIGHT * length),
            };
            let ends = (!curve.closed).then(|| [curve.vertices[0], curve.vertices[curve.vertices.len() - 1]]);
            Piece { ends, edges, length, persistence, roughness: 0.0, may_go }
        };
        let list: Vec<Piece> = curves.par_iter().map(piece).collect();
        list.into_iter().for_each(|piece| pieces.add(piece));
        pieces
    }

    fn add(&mut self, piece: Piece) {
        let id = self.list.len() as u32;
        for &end in piece.ends.iter().flatten() {
            self.at.entry(end).or_default().push(id);
        }
        self.list.push(Some(piece));
        self.wait(id);
    }

    fn wait(&mut self, id: u32) {
        if let Some(piece) = self.list[id as usize].as_ref().filter(|piece| piece.may_go) {
            self.queue.push(Reverse((piece.persistence.abs().to_bits(), id)));
        }
    }

    /// Drops the creases that do not persist, and adds them to `creases`.
    fn drop_weak(&mut self, creases: &mut Vec<(Reason, Vec<(u32, f32)>)>) {
        while let Some(Reverse((_, id))) = self.queue.pop() {
            if let Some(reason) = self.reason_to_drop(id) {
                creases.push((reason, self.drop_piece(id)));
            }
        }
    }

    /// Measures the roughness near each piece by the dropped creases; all pieces wait for another try.
    fn measure_roughness(&mut self, creases: &[(Reason, Vec<(u32, f32)>)], side: f64) {
        let surface = self.surface;
        let middle = |h: u32| {
            let [a, b] = [surface.origin(h), surface.target(h)].map(|v| surface.points[v as usize].as_dvec3());
            ((a + b) / 2.0).to_array()
        };
        let dropped = creases.iter().flat_map(|(_, edges)| edges);
        let dropped = dropped.map(|&(h, _)| GeomWithData::new(middle(h), surface.length(h) / side));
        let dropped = RTree::bulk_load(dropped.collect());
        let near = |h: u32| {
            dropped.locate_within_distance(middle(h), (NEAR * side).powi(2)).map(|edge| edge.data).sum::<f64>()
        };
        for id in 0..self.list.len() {
            if let Some(piece) = &mut self.list[id] {
                let (mut rest, mut last) = (0.0, 0.0);
                for &(h, _) in &piece.edges {
                    if rest <= 0.0 {
                        (last, rest) = (near(h), SPACING);
                    }
                    let length = surface.length(h) / side;
                    piece.roughness += last * length;
                    rest -= length;
                }
                self.wait(id as u32);
            }
        }
    }

    /// The reason to drop a piece; `None` where it persists or is dropped already.
    fn reason_to_drop(&self, id: u32) -> Option<Reason> {
        let piece = self.list[id as usize].as_ref()?;
        let least = if piece.ends.is_none_or(|[start, end]| start == end) { CLOSED } else { OPEN };
        let reason = if MOST_WEIGHT * piece.length < least { Reason::Short } else { Reason::Weak };
        let contrast = 1.0 + ROUGHNESS * piece.roughness / piece.length.max(f64::MIN_POSITIVE);
        (piece.persistence.abs() < least * contrast).then_some(reason)
    }

    /// The creases that have the same ends as a more persistent curve and are nowhere farther from it than `apart`, unit-sized:
    /// the thin folds that tessellators and intersections leave.
    fn doubles(&self, apart: f64) -> Vec<u32> {
        let open = self.list.iter().zip(0..).filter_map(|(piece, id)| {
            let piece = piece.as_ref()?;
            let [a, b] = piece.ends.filter(|[a, b]| a != b)?;
            Some(([a.min(b), a.max(b)], (!piece.may_go, piece.persistence.abs()), id))
        });
        let mut open: Vec<([u32; 2], (bool, f64), u32)> = open.collect();
        open.sort_by(|x, y| x.0.cmp(&y.0).then(y.1.0.cmp(&x.1.0)).then(y.1.1.total_cmp(&x.1.1)).then(x.2.cmp(&y.2)));
        let is_double = |id: u32, stronger: &[([u32; 2], (bool, f64), u32)]| {
            stronger.iter().any(|&(_, _, other)| self.is_near(id, other, apart))
        };
        open.chunk_by(|x, y| x.0 == y.0)
            .flat_map(|same| {
                (1..same.len()).filter(|&k| !same[k].1.0 && is_double(same[k].2, &same[..k])).map(|k| same[k].2)
            })
            .collect()
    }

    /// Whether all points of a piece are no farther than this from another piece, unit-sized.
    fn is_near(&self, id: u32, other: u32, apart: f64) -> bool {
        let segments = |id: u32| {
            let edges = self.list[id as usize].iter().flat_map(|piece| &piece.edges);
            edges.map(|&(h, _)| {
                [self.surface.origin(h), self.surface.target(h)].map(|v| self.surface.points[v as usize].as_dvec3())
            })
        };
        let distance = |p: DVec3| {
            segments(other).map(|[a, b]| nearest_on_segment(p, a, b).distance(p)).fold(f64::INFINITY, f64::min)
        };
        segments(id).flatten().all(|p| distance(p) <= apart)
    }

    fn take(&mut self, id: u32) -> Option<Piece> {
        let piece = self.list[id as usize].take()?;
        for end in piece.ends.iter().flatten() {
            if let Some(at) = self.at.get_mut(end) {
                at.retain(|&other| other != id);
            }
        }
        Some(piece)
    }

    /// Drops a piece, joins what it separated, and returns its edges.
    fn drop_piece(&mut self, id: u32) -> Vec<(u32, f32)> {
        let Some(dropped) = self.take(id) else { return Vec::new() };
        for end in dropped.ends.into_iter().flatten() {
            let left = self.at[&end].clone();
            match *left {
                [a, b] if a != b && self.goes_on(end, a, b) => self.merge(end, a, b),
                _ => left.into_iter().for_each(|other| self.wait(other)),
            }
        }
        dropped.edges
    }

    /// Whether two pieces pass straight through a vertex.
    fn goes_on(&self, vertex: u32, a: u32, b: u32) -> bool {
        let [Some(a), Some(b)] = [a, b].map(|id| self.list[id as usize].as_ref()) else { return false };
        let ways = [a, b].map(|piece| piece.from(self.surface, vertex));
        !features::is_sharp(self.surface, vertex, ways, self.surface.features.reach, self.cos_corner)
    }

    fn merge(&mut self, vertex: u32, a: u32, b: u32) {
        let [Some(mut a), Some(mut b)] = [a, b].map(|id| self.take(id)) else { return };
        // Both run on from the first's beginning to the second's end.
        let far = |piece: &Piece| piece.ends.map_or(vertex, |[s, e]| if s == vertex { e } else { s });
        let ends = [far(&a), far(&b)];
        if a.ends.is_some_and(|[start, _]| start == vertex) {
            a.edges.reverse();
        }
        if b.ends.is_some_and(|[_, end]| end == vertex) {
            b.edges.reverse();
        }
        a.edges.append(&mut b.edges);
        self.add(Piece {
            ends: Some(ends),
            edges: a.edges,
            length: a.length + b.length,
            persistence: a.persistence + b.persistence,
            roughness: a.roughness + b.roughness,
            may_go: a.may_go && b.may_go,
        });
    }
}

impl Piece {
    /// Its vertices from one of its ends on, without the end.
    fn from(&self, surface: &Surface, end: u32) -> impl Iterator<Item = u32> {
        let first = self.edges[0].0;
        let is_forward = [surface.origin(first), surface.target(first)].contains(&end);
        let (mut at, count) = (end, self.edges.len());
        (0..count).map(move |k| {
            let (h, _) = self.edges[if is_forward { k } else { count - 1 - k }];
            at = features::other_end(surface, h, at);
            at
        })
    }
}

#[cfg(test)]
mod tests;
