//! Ridges: lines where a smooth surface turns sharply within one tile, made into edges of the surface.
//!
//! # Theory
//! Curvature is measured over discs of the tiles' size, so that narrow and wide bends count by the angle by which they turn a
//! tile. On a ridge the greatest curvature has a maximum along its own direction: its derivative there is zero (Ohtake, Belyaev
//! and Seidel 2004, *Ridge-valley lines on meshes via implicit surface fitting*). The zero is found on each edge by linear
//! interpolation, and the zeros are joined triangle by triangle.
//!
//! # Changes versus the paper
//! The paper has no features at all. On the wing its rows cross the leading edge aslant wherever tiles are larger than the
//! edge is round, and cut it into teeth.
//!
//! # Practice
//! A line begins where the surface turns by more than the limit within a tile, is followed as long as it turns by more than a
//! share of the limit, and is dropped where it is shorter than some tiles. Finer tiles have fewer ridges, since less of a bend
//! lies within a tile.
//!
//! A round far narrower than a tile bends by the same angle all across it at the tile's scale, so that noise decides where its
//! crest is: with tiles of more than about four times its radius the line breaks up and is dropped.

use super::curvature::{Curvature, curvatures_above, radius_of_tile};
use super::split::EdgePoint;
use super::{NONE, Surface, next, previous};
use crate::progress::IsCancelled;
use glam::DVec3;
use rayon::prelude::*;
use std::collections::VecDeque;

/// The share of the limit down to which a line is followed.
const FOLLOWED: f64 = 0.8;
/// A line shorter than this, in tile sides, is dropped.
const SHORTEST: f64 = 15.0;
/// A crossing nearer to an edge's end than this, as a share of the edge, is at the end.
const SNAP: f64 = 0.05;
/// Places are kept this far from the ends of their edges while they are straightened, as a share of the edge.
const MARGIN: f64 = 0.01;
/// Rounds of straightening.
const STRAIGHTENED: usize = 20;

/// The ridges for tiles of side `h`, unit-sized, on which the surface turns by more than `limit` degrees a tile.
pub(super) fn ridges(surface: &Surface, h: f64, limit: f64, is_cancelled: &IsCancelled) -> Vec<Vec<EdgePoint>> {
    let limit = limit.to_radians();
    let field = Bending::new(surface, h, FOLLOWED * limit, is_cancelled);
    if is_cancelled() {
        return Vec::new();
    }
    let mut lines = field.lines(FOLLOWED * limit);
    lines.retain(|line| line.iter().any(|&place| field.strength(place) >= limit));
    lines.retain(|line| length(surface, line) >= SHORTEST * h);
    lines.iter_mut().for_each(|line| straighten(surface, line));
    lines.into_iter().map(|line| snapped(surface, line)).collect()
}

/// Moves points along their edges to where the line is shortest, which removes the noise of the crossings.
fn straighten(surface: &Surface, line: &mut [EdgePoint]) {
    let closed = line.first() == line.last();
    let count = line.len();
    for _ in 0..STRAIGHTENED {
        for i in 0..count {
            let EdgePoint::Edge(h, _) = line[i] else { continue };
            let (before, after) = match i {
                0 if closed => (line[count - 2], line[1]),
                0 => continue,
                _ if i + 1 < count => (line[i - 1], line[i + 1]),
                _ => continue,
            };
            let [a, b] = [surface.origin(h), surface.target(h)].map(|v| surface.points[v as usize].as_dvec3());
            let [p, q] = [before, after].map(|place| place.position(surface));
            // Where the edge comes nearest to the chord of the neighbours, by lengths on both sides.
            let [u, v] = [p, q].map(|p| ((p - a).dot(b - a) / a.distance_squared(b), p));
            let off = [u, v].map(|(share, p)| p.distance(a + (b - a) * share));
            let share = (u.0 * off[1] + v.0 * off[0]) / (off[0] + off[1]).max(f64::MIN_POSITIVE);
            line[i] = EdgePoint::Edge(h, share.clamp(MARGIN, 1.0 - MARGIN));
        }
        if closed {
            line[count - 1] = line[0];
        }
    }
}

/// Snaps points to near vertices, and leaves out those where the line would turn back on itself.
fn snapped(surface: &Surface, mut line: Vec<EdgePoint>) -> Vec<EdgePoint> {
    let closed = line.len() > 1 && line.first() == line.last();
    if closed {
        line.pop();
    }
    let mut kept: VecDeque<EdgePoint> = VecDeque::with_capacity(line.len() + 1);
    for place in line {
        let place = match place {
            EdgePoint::Edge(h, share) if share < SNAP => EdgePoint::Vertex(surface.origin(h)),
            EdgePoint::Edge(h, share) if share > 1.0 - SNAP => EdgePoint::Vertex(surface.target(h)),
            other => other,
        };
        while kept.back().is_some_and(|&last| is_beside(surface, last, place)) {
            kept.pop_back();
        }
        if !kept.back().is_some_and(|&last| last == place || is_beside(surface, place, last)) {
            kept.push_back(place);
        }
    }
    // A closed line must not turn back where its ends meet either.
    while closed && kept.len() > 1 {
        let (first, last) = (kept[0], kept[kept.len() - 1]);
        if first == last || is_beside(surface, last, first) {
            kept.pop_back();
        } else if is_beside(surface, first, last) {
            kept.pop_front();
        } else {
            kept.push_back(first);
            break;
        }
    }
    kept.into()
}

/// Whether a place is on an edge that ends at the vertex where the other one is.
fn is_beside(surface: &Surface, place: EdgePoint, vertex: EdgePoint) -> bool {
    let (EdgePoint::Edge(h, _), EdgePoint::Vertex(v)) = (place, vertex) else { return false };
    surface.origin(h) == v || surface.target(h) == v
}

fn length(surface: &Surface, line: &[EdgePoint]) -> f64 {
    line.windows(2).map(|pair| pair[0].position(surface).distance(pair[1].position(surface))).sum()
}

/// The bend of the surface at each vertex; zero where it is below the asked one.
struct Bending<'a> {
    surface: &'a Surface,
    /// The angle in radians by which it turns within a tile.
    turns: Vec<f64>,
    /// The direction in which it does, of either sign.
    across: Vec<DVec3>,
    /// The derivative of the turn in that direction.
    slopes: Vec<f64>,
}

impl<'a> Bending<'a> {
    fn new(surface: &'a Surface, h: f64, least: f64, is_cancelled: &IsCancelled) -> Self {
        let bends = curvatures_above(surface, radius_of_tile(h), least / h, is_cancelled);
        let turns: Vec<f64> = bends.iter().map(|bend| bend.values[0].abs() * h).collect();
        let slopes = if is_cancelled() { vec![0.0; turns.len()] } else { slopes(surface, &bends, &turns) };
        Self { surface, turns, across: bends.iter().map(|bend| bend.directions[0]).collect(), slopes }
    }

    fn strength(&self, place: EdgePoint) -> f64 {
        match place {
            EdgePoint::Vertex(v) => self.turns[v as usize],
            EdgePoint::Edge(h, share) => {
                let [a, b] = [self.surface.origin(h), self.surface.target(h)].map(|v| self.turns[v as usize]);
                a + (b - a) * share
            }
        }
    }

    /// Where the slope changes its sign along an edge, and the turn there is at least so sharp: the share of the way.
    fn crossing(&self, half_edge: u32, least: f64) -> Option<f64> {
        let [a, b] = [self.surface.origin(half_edge), self.surface.target(half_edge)].map(|v| v as usize);
        let [up, down] = [self.slopes[a], self.sign(a, b) * self.slopes[b]];
        if (up > 0.0) == (down > 0.0) {
            return None;
        }
        let share = up.abs() / (up.abs() + down.abs());
        let turn = self.turns[a] + (self.turns[b] - self.turns[a]) * share;
        (turn >= least).then_some(share)
    }

    /// Whether the directions at two vertices agree, or are opposite.
    fn sign(&self, a: usize, b: usize) -> f64 {
        if self.across[a].dot(self.across[b]) < 0.0 { -1.0 } else { 1.0 }
    }

    /// Whether the turn is greatest, not least, where the slope changes its sign in a triangle.
    fn is_crest(&self, triangle: usize) -> bool {
        let [a, b, c] = self.surface.triangles[triangle].map(|v| v as usize);
        let [with_b, with_c] = [self.sign(a, b), self.sign(a, c)];
        let corners = self.surface.corners(triangle).map(|p| p.as_dvec3());
        let across = self.across[a] + self.across[b] * with_b + self.across[c] * with_c;
        let slopes = [self.slopes[a], self.slopes[b] * with_b, self.slopes[c] * with_c];
        with_b * with_c * self.sign(b, c) > 0.0 && gradient(corners, slopes).dot(across) < 0.0
    }

    /// The lines that are at least so sharp, each a chain of places on edges.
    fn lines(&self, least: f64) -> Vec<Vec<EdgePoint>> {
        let surface = self.surface;
        let half_edges = 3 * surface.triangle_count() as u32;
        let crossings: Vec<Option<f64>> = (0..half_edges)
            .into_par_iter()
            .map(|h| {
                let twin = surface.twins[h as usize];
                let first = twin == NONE || h < twin;
                first.then(|| self.crossing(h, least)).flatten()
            })
            .collect();
        let named = |h: u32| h.min(surface.twins[h as usize]);
        let crossed = |h: u32| crossings[named(h) as usize].is_some();
        // A line passes a triangle by two of its edges.
        let passed = |t: u32| (3 * t..3 * t + 3).filter(|&h| crossed(h)).count() == 2 && self.is_crest(t as usize);
        let mut done = vec![false; half_edges as usize];
        let mut lines = Vec::new();
        for start in (0..half_edges).filter(|&h| crossings[h as usize].is_some()) {
            if done[start as usize] {
                continue;
            }
            // Both ways from the first edge; the way back is turned round.
            let mut line = VecDeque::from([start]);
            done[start as usize] = true;
            for (forward, side) in [(true, Some(start)), (false, surface.twin(start))] {
                let mut side = side;
                while let Some(h) = side.filter(|&h| passed(h / 3)) {
                    let out = if crossed(next(h)) { next(h) } else { previous(h) };
                    if std::mem::replace(&mut done[named(out) as usize], true) {
                        if named(out) == start && line.len() > 2 {
                            line.push_back(start);
                        }
                        break;
                    }
                    if forward {
                        line.push_back(named(out))
                    } else {
                        line.push_front(named(out))
                    }
                    side = surface.twin(out);
                }
            }
            lines.push(line.into_iter().map(|h| EdgePoint::Edge(h, crossings[h as usize].unwrap_or(0.5))).collect());
        }
        lines
    }
}

/// The gradient of values at the corners of a triangle, times twice its area.
fn gradient(corners: [DVec3; 3], values: [f64; 3]) -> DVec3 {
    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or_zero();
    (0..3).map(|k| normal.cross(corners[(k + 2) % 3] - corners[(k + 1) % 3]) * values[k]).sum()
}

/// The derivative of the turn at each vertex in the direction in which the surface bends most.
fn slopes(surface: &Surface, bends: &[Curvature], turns: &[f64]) -> Vec<f64> {
    let gradients: Vec<DVec3> = (0..surface.triangle_count())
        .into_par_iter()
        .map(|t| {
            let corners = surface.corners(t).map(|p| p.as_dvec3());
            gradient(corners, surface.triangles[t].map(|v| turns[v as usize]))
        })
        .collect();
    let mut sums = vec![(DVec3::ZERO, 0.0); bends.len()];
    for (t, corners) in surface.triangles.iter().enumerate() {
        let area = f64::from(surface.double_area(t));
        for &v in corners {
            sums[v as usize].0 += gradients[t];
            sums[v as usize].1 += area;
        }
    }
    sums.iter()
        .zip(bends)
        .map(|((sum, area), bend)| sum.dot(bend.directions[0]) / area.max(f64::MIN_POSITIVE))
        .collect()
}

#[cfg(test)]
mod tests;
