//! Drops creases that are too small for tiles.
//!
//! # Practice
//! The rule, in tile sides, for creases by angle alone (not for open boundaries, seams, named edges, borders of regions and
//! ridges):
//! - a spur, with an end that no other feature meets, is dropped where it is shorter than [`SPUR`];
//! - a closed crease, with one corner or none, where it is shorter than [`LOOP`];
//! - a crease between two corners, where it is shorter than [`SHORT`].
//!
//! The shortest is dropped first. Two curves that are left at a corner and do not turn there become one, so that a long crease
//! stays when short branches are dropped.

use super::{NONE, Surface, features};
use rustc_hash::FxHashMap;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Longest spur that is dropped, in tile sides.
const SPUR: f64 = 0.5;
/// Longest closed crease that is dropped, in tile sides.
const LOOP: f64 = 2.0;
/// Longest crease between corners that is dropped, in tile sides.
const SHORT: f64 = 0.5;

/// The marks of the surface's features without those that are too small for tiles of side `h`; `corner` in degrees.
pub(super) fn without_tiny(surface: &Surface, corner: f64, h: f64) -> Vec<bool> {
    let mut pieces = Pieces::new(surface, corner);
    while let Some(Reverse((_, id))) = pieces.queue.pop() {
        if pieces.is_tiny(id, h) {
            pieces.drop_piece(id);
        }
    }
    let mut marked = vec![false; 3 * surface.triangle_count()];
    for piece in pieces.list.iter().flatten() {
        for &h in &piece.half_edges {
            marked[h as usize] = true;
            if surface.twins[h as usize] != NONE {
                marked[surface.twins[h as usize] as usize] = true;
            }
        }
    }
    marked
}

/// A curve, or several in a row.
struct Piece {
    /// Its ends; none where it is closed.
    ends: Option<[u32; 2]>,
    /// From the first end to the last.
    half_edges: Vec<u32>,
    length: f64,
    may_go: bool,
}

struct Pieces<'a> {
    surface: &'a Surface,
    cos_corner: f64,
    list: Vec<Option<Piece>>,
    /// The pieces that end at each corner; one that ends there twice is named twice.
    at: FxHashMap<u32, Vec<u32>>,
    /// Those that may go, the shortest first, by the bits of their lengths.
    queue: BinaryHeap<Reverse<(u64, u32)>>,
}

impl<'a> Pieces<'a> {
    fn new(surface: &'a Surface, corner: f64) -> Self {
        let cos_corner = corner.to_radians().cos();
        let mut pieces =
            Self { surface, cos_corner, list: Vec::new(), at: FxHashMap::default(), queue: BinaryHeap::new() };
        for curve in surface.features.curves() {
            let kept = |&h: &u32| surface.twin(h).is_none() || surface.is_named(h);
            pieces.add(Piece {
                ends: (!curve.closed).then(|| [curve.vertices[0], curve.vertices[curve.vertices.len() - 1]]),
                length: curve.half_edges.iter().map(|&h| surface.length(h)).sum(),
                may_go: !curve.half_edges.iter().any(kept),
                half_edges: curve.half_edges.clone(),
            });
        }
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
            self.queue.push(Reverse((piece.length.to_bits(), id)));
        }
    }

    fn is_tiny(&self, id: u32, h: f64) -> bool {
        let Some(piece) = &self.list[id as usize] else { return false };
        let limit = match piece.ends {
            None => LOOP,
            Some([start, end]) if start == end => LOOP,
            Some(ends) if ends.iter().any(|end| self.at[end].len() == 1) => SPUR,
            Some(_) => SHORT,
        };
        piece.length < limit * h
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

    fn drop_piece(&mut self, id: u32) {
        let ends = self.take(id).and_then(|piece| piece.ends);
        for end in ends.into_iter().flatten() {
            let left = self.at[&end].clone();
            match *left {
                [a, b] if a != b && self.goes_on(end, a, b) => self.merge(end, a, b),
                _ => left.into_iter().for_each(|other| self.wait(other)),
            }
        }
    }

    /// Whether two pieces pass straight through a vertex.
    fn goes_on(&self, vertex: u32, a: u32, b: u32) -> bool {
        let [Some(a), Some(b)] = [a, b].map(|id| self.list[id as usize].as_ref()) else { return false };
        let edges = [a, b].map(|piece| piece.edge_at(self.surface, vertex));
        features::turning_cosine(self.surface, vertex, edges[0], edges[1]) >= self.cos_corner
    }

    fn merge(&mut self, vertex: u32, a: u32, b: u32) {
        let [Some(mut a), Some(mut b)] = [a, b].map(|id| self.take(id)) else { return };
        // Both run on from the first's beginning to the second's end.
        let far = |piece: &Piece| piece.ends.map_or(vertex, |[s, e]| if s == vertex { e } else { s });
        let ends = [far(&a), far(&b)];
        if a.ends.is_some_and(|[start, _]| start == vertex) {
            a.half_edges.reverse();
        }
        if b.ends.is_some_and(|[_, end]| end == vertex) {
            b.half_edges.reverse();
        }
        a.half_edges.append(&mut b.half_edges);
        self.add(Piece {
            ends: Some(ends),
            half_edges: a.half_edges,
            length: a.length + b.length,
            may_go: a.may_go && b.may_go,
        });
    }
}

impl Piece {
    /// Its edge at one of its ends.
    fn edge_at(&self, surface: &Surface, vertex: u32) -> u32 {
        let [first, last] = [self.half_edges[0], self.half_edges[self.half_edges.len() - 1]];
        if surface.origin(first) == vertex || surface.target(first) == vertex { first } else { last }
    }
}

#[cfg(test)]
mod tests;
