//! Places where sheets of a surface touch or cross each other without being joined.
//!
//! # Theory
//! Möller, "A fast triangle-triangle intersection test", 1997: most pairs are told apart by the distances of one triangle's corners
//! from the other's plane.
//!
//! # Practice
//! Triangles with a common vertex are neighbours, whatever their angle. Of the others, those without a common corner may cross;
//! coincident ones may have common corners, as where two solids share a wall in two triangulations. An edge of a rim touches a
//! sheet where its middle or both its ends lie on triangles of other corners.

use super::boxes::{Bounds, Boxes};
use super::nearest::{Simplices, nearest_on_segment, squared_distance};
use super::repairs::TOUCH;
use super::{Places, Surface, next};
use crate::progress::IsCancelled;
use glam::{DVec2, DVec3, Vec3};
use rayon::prelude::*;
use rustc_hash::FxHashMap;
use serde::Serialize;

/// Triangles in one plane coincide where they overlap by more than this in every direction.
const OVERLAP: f64 = 1e-5;
/// An edge of a rim touches no triangle with a corner on the same rim that is nearer to it along that, in diagonals: it may be a
/// sliver beside the edge.
const OWN_RIM: f64 = 0.01;
/// Rims nearer than this, in sides of a tile, run side by side.
const BESIDE: f64 = 0.02;
/// A rim runs beside itself only where the way along it is so many times as long as the gap.
const DETOUR: f64 = 10.0;
/// The tolerance that is advised, over the gap.
const ALLOWANCE: f64 = 1.1;

/// Places where sheets of a surface touch or cross each other without being joined.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Contacts {
    /// Pairs of triangles that cross.
    pub crossing: Places,
    /// Pairs of triangles that lie on each other.
    pub coincident: Places,
    /// Edges on open boundaries that lie on triangles beside which they do not end.
    pub touching: Places,
    /// Open boundaries that run side by side.
    pub near_rims: Option<NearRims>,
}

/// Open boundaries that run side by side, with a gap that is small beside a tile.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct NearRims {
    /// Where, in model units.
    pub at: [f64; 3],
    /// The largest gap, in model units.
    pub gap: f64,
    /// The length of the boundaries there, in model units.
    pub length: f64,
    /// The tolerance of welding that closes the gap, in model units.
    pub tolerance: f64,
}

/// Looks for contacts; `side` is that of a tile, unit-sized.
pub(super) fn contacts(surface: &Surface, side: f64, is_cancelled: &IsCancelled) -> Contacts {
    let boxes = Boxes::new(&surface.points, &surface.triangles);
    let rims = Rims::new(surface);
    let test = |s: u32, t: u32| {
        let [vertices, others] = [s, t].map(|t| surface.triangles[t as usize]);
        if vertices.iter().any(|v| others.contains(v)) {
            return None;
        }
        let [corners, others] = [s, t].map(|t| surface.corners(t as usize));
        if are_apart(corners, others) || are_apart(others, corners) {
            return None;
        }
        pair(corners, others).map(|kind| (kind, s.min(t)))
    };
    let (pairs, stretches) =
        rayon::join(|| boxes.pairs(TOUCH as f32, test, is_cancelled), || rims.stretches(surface, side));
    if is_cancelled() {
        return Contacts::default();
    }
    let touching = rims.touching(surface, &boxes, &stretches);
    let mut contacts = Contacts { near_rims: near_rims(surface, side, &stretches), ..Contacts::default() };
    let place = |p: Vec3| surface.frame.near(p.as_dvec3().into());
    for (kind, t) in pairs {
        let of_kind = match kind {
            Pair::Crossing => &mut contacts.crossing,
            Pair::Coincident => &mut contacts.coincident,
        };
        let [a, b, c] = surface.corners(t as usize);
        of_kind.note(|| place((a + b + c) / 3.0));
    }
    for h in touching {
        let [a, b] = [surface.origin(h), surface.target(h)].map(|v| surface.points[v as usize]);
        contacts.touching.note(|| place(a.midpoint(b)));
    }
    contacts
}

/// Whether a triangle lies on one side of another's plane, plainly even with the rounding of f32.
fn are_apart([a, b, c]: [Vec3; 3], others: [Vec3; 3]) -> bool {
    let normal = (b - a).cross(c - a);
    let heights = others.map(|p| normal.dot(p - a));
    let plain = 2.0 * TOUCH as f32 * normal.length();
    heights.iter().all(|&h| h > plain) || heights.iter().all(|&h| h < -plain)
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Pair {
    Crossing,
    Coincident,
}

/// How two triangles touch, if they do.
fn pair(s: [Vec3; 3], t: [Vec3; 3]) -> Option<Pair> {
    let [s, t] = [s, t].map(|corners| corners.map(|p| p.as_dvec3()));
    let heights = |[a, b, c]: [DVec3; 3], others: [DVec3; 3]| {
        let normal = (b - a).cross(c - a).try_normalize()?;
        Some(others.map(|p| normal.dot(p - a)))
    };
    let apart = |heights: &[f64; 3]| heights.iter().all(|&h| h > TOUCH) || heights.iter().all(|&h| h < -TOUCH);
    let of_t = heights(s, t).filter(|heights| !apart(heights))?;
    let of_s = heights(t, s).filter(|heights| !apart(heights))?;
    let flat = |heights: [f64; 3]| heights.iter().all(|h| h.abs() <= TOUCH);
    if flat(of_s) && flat(of_t) {
        return overlap(s, t).then_some(Pair::Coincident);
    }
    let shared = s.iter().any(|p| t.contains(p));
    (!shared && (pierces(t, of_t, s) || pierces(s, of_s, t))).then_some(Pair::Crossing)
}

/// Whether a side of one triangle, whose corners have these heights over the other, passes through that.
fn pierces(sides: [DVec3; 3], heights: [f64; 3], [a, b, c]: [DVec3; 3]) -> bool {
    let normal = (b - a).cross(c - a).normalize();
    (0..3).any(|k| {
        let ([p, q], [from, to]) = ([k, (k + 1) % 3].map(|k| sides[k]), [k, (k + 1) % 3].map(|k| heights[k]));
        let point = p + (q - p) * (from / (from - to));
        from.min(to) < -TOUCH
            && from.max(to) > TOUCH
            && [(a, b), (b, c), (c, a)]
                .iter()
                .all(|&(s, e)| (e - s).cross(point - s).dot(normal) > TOUCH * s.distance(e))
    })
}

/// Whether two triangles in nearly one plane overlap: no line along a side parts them.
fn overlap(s: [DVec3; 3], t: [DVec3; 3]) -> bool {
    let normal = (s[1] - s[0]).cross(s[2] - s[0]).normalize();
    let x = normal.any_orthonormal_vector();
    let y = normal.cross(x);
    let [s, t] = [s, t].map(|corners| corners.map(|p| DVec2::new(p.dot(x), p.dot(y))));
    let range = |corners: [DVec2; 3], axis: DVec2| {
        let along = corners.map(|p| p.dot(axis));
        [along.into_iter().fold(f64::INFINITY, f64::min), along.into_iter().fold(f64::NEG_INFINITY, f64::max)]
    };
    [s, t].iter().all(|corners| {
        (0..3).all(|k| {
            let axis = (corners[(k + 1) % 3] - corners[k]).perp().normalize_or_zero();
            let ([low, high], [lowest, highest]) = (range(s, axis), range(t, axis));
            high.min(highest) - low.max(lowest) > OVERLAP
        })
    })
}

/// The open boundaries, without seams where sheets meet.
struct Rims {
    half_edges: Vec<u32>,
    /// The boundary loop of each, and the way to its origin along that.
    along: Vec<(u32, f64)>,
    /// The length of each loop.
    lengths: Vec<f64>,
}

impl Rims {
    fn new(surface: &Surface) -> Self {
        let count = 3 * surface.triangle_count() as u32;
        let open = (0..count).filter(|&h| surface.twin(h).is_none());
        let key = |h: u32| {
            let [a, b] = [surface.origin(h), surface.target(h)].map(|v| surface.same_place(v));
            [a.min(b), a.max(b)]
        };
        let mut at_place: FxHashMap<[u32; 2], u32> = FxHashMap::default();
        open.clone().for_each(|h| *at_place.entry(key(h)).or_default() += 1);
        let (mut half_edges, mut along, mut lengths) = (Vec::new(), Vec::new(), Vec::new());
        let mut passed = FxHashMap::default();
        for start in open {
            let (mut h, mut way) = (start, 0.0);
            while passed.insert(h, ()).is_none() {
                if at_place[&key(h)] == 1 {
                    half_edges.push(h);
                    along.push((lengths.len() as u32, way));
                }
                way += surface.length(h);
                // The open half-edge that leaves the target, at the other end of its fan.
                h = next(h);
                while let Some(twin) = surface.twin(h) {
                    h = next(twin);
                }
            }
            if way > 0.0 {
                lengths.push(way);
            }
        }
        Self { half_edges, along, lengths }
    }

    /// The half-edges, of those that run beside no other rim, that lie on triangles of other corners.
    fn touching(&self, surface: &Surface, boxes: &Boxes, stretches: &[Option<Stretch>]) -> Vec<u32> {
        let at: FxHashMap<u32, (u32, f64)> =
            self.half_edges.iter().zip(&self.along).map(|(&h, &along)| (surface.origin(h), along)).collect();
        let touches = |edge: usize| {
            let h = self.half_edges[edge];
            let vertices = [surface.origin(h), surface.target(h)];
            let ends = vertices.map(|v| surface.points[v as usize]);
            let (of_loop, way) = self.along[edge];
            let is_beside = |v: &u32| {
                let on_rim = at.get(v).is_some_and(|&(loop_there, there)| {
                    let between = (way - there).abs();
                    loop_there == of_loop && between.min(self.lengths[of_loop as usize] - between) < OWN_RIM
                });
                on_rim || vertices.contains(v)
            };
            let lies_on = |p: Vec3, shared: usize| {
                boxes.meeting(&Bounds::of(&[p]).grown(TOUCH as f32)).into_iter().any(|t| {
                    let corners = surface.corners(t as usize);
                    let common = ends.iter().chain([&p]).filter(|end| corners.contains(end)).count();
                    common <= shared
                        && squared_distance(p.as_dvec3(), corners.map(|p| p.as_dvec3())) < TOUCH * TOUCH
                        && !surface.triangles[t as usize].iter().any(is_beside)
                })
            };
            lies_on(ends[0].midpoint(ends[1]), 1) || ends.iter().all(|&end| lies_on(end, 0))
        };
        let alone = (0..self.half_edges.len()).into_par_iter().filter(|&edge| stretches[edge].is_none());
        alone.filter(|&edge| touches(edge)).map(|edge| self.half_edges[edge]).collect()
    }

    /// The stretch of each half-edge along which another rim runs.
    fn stretches(&self, surface: &Surface, side: f64) -> Vec<Option<Stretch>> {
        let ends = |h: u32| [surface.origin(h), surface.target(h)].map(|v| surface.points[v as usize].as_dvec3());
        let tree = Simplices::<2>::new(self.half_edges.iter().map(|&h| ends(h)));
        let beside = BESIDE * side;
        // The distance of the rim nearest to a point on another, where it is near.
        let gap = |edge: usize, point: DVec3| {
            let (of_loop, start) = self.along[edge];
            let way = start + point.distance(ends(self.half_edges[edge])[0]);
            let is_other = |other: usize, at: DVec3| {
                let (loop_there, start) = self.along[other];
                let there = start + at.distance(ends(self.half_edges[other])[0]);
                let length = self.lengths[of_loop as usize];
                let between = (way - there).abs();
                loop_there != of_loop || between.min(length - between) > DETOUR * beside
            };
            let near = tree.within(point, beside).filter_map(|found| {
                let at = nearest_on_segment(point, found.corners[0], found.corners[1]);
                is_other(found.id as usize, at).then(|| at.distance(point))
            });
            near.min_by(f64::total_cmp)
        };
        let of_edge = |edge: usize| {
            let [a, b] = ends(self.half_edges[edge]);
            let pieces = (a.distance(b) / side).ceil().max(2.0) as usize;
            let gaps: Vec<Option<f64>> = (0..=pieces).map(|k| gap(edge, a.lerp(b, k as f64 / pieces as f64))).collect();
            let near = gaps.windows(2).filter(|ends| ends.iter().all(Option::is_some)).count();
            let widest = gaps.iter().flatten().copied().fold(0.0, f64::max);
            (near > 0).then(|| Stretch {
                length: a.distance(b) * near as f64 / pieces as f64,
                gap: widest,
                at: a.midpoint(b),
            })
        };
        (0..self.half_edges.len()).into_par_iter().map(of_edge).collect()
    }
}

/// The part of a half-edge along which another rim runs.
struct Stretch {
    length: f64,
    /// The largest gap.
    gap: f64,
    /// The middle of the half-edge.
    at: DVec3,
}

/// The rims that run side by side for the length of a tile.
fn near_rims(surface: &Surface, side: f64, stretches: &[Option<Stretch>]) -> Option<NearRims> {
    let found = || stretches.iter().flatten();
    let length: f64 = found().map(|stretch| stretch.length).sum();
    let widest = found().max_by(|a, b| a.gap.total_cmp(&b.gap))?;
    let diagonal = surface.frame.diagonal;
    // Both rims count.
    (length > 2.0 * side).then(|| NearRims {
        at: surface.frame.near(widest.at.into()),
        gap: widest.gap * diagonal,
        length: length / 2.0 * diagonal,
        tolerance: round_up(ALLOWANCE * widest.gap.max(TOUCH) * diagonal),
    })
}

/// The next larger number of two digits.
fn round_up(x: f64) -> f64 {
    let step = 10f64.powf(x.log10().floor() - 1.0);
    let digits = (x / step).ceil();
    format!("{:.1e}", digits * step).parse().unwrap_or(x)
}
