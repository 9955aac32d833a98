//! Inserts vertices in the edges and inside of welded triangles, and triangulates these anew.

use super::constrained;
use super::weld::Welded;
use glam::DVec3;
use rustc_hash::FxHashMap;

/// The vertices to be inserted, and the segments that are to become edges.
#[derive(Default)]
pub(super) struct Cuts {
    /// Those of each edge, whose ends are in order.
    of_edge: FxHashMap<[u32; 2], Vec<u32>>,
    /// Those inside each triangle.
    inside: FxHashMap<u32, Inside>,
}

#[derive(Default)]
struct Inside {
    vertices: Vec<u32>,
    segments: Vec<[u32; 2]>,
}

impl Cuts {
    /// Inserts a vertex in an edge, once.
    pub fn insert(&mut self, edge: [u32; 2], vertex: u32) {
        let vertices = self.of_edge.entry(sorted(edge)).or_default();
        if !vertices.contains(&vertex) {
            vertices.push(vertex);
        }
    }

    /// Inserts a vertex inside a triangle.
    pub fn insert_inside(&mut self, triangle: u32, vertex: u32) {
        self.inside.entry(triangle).or_default().vertices.push(vertex);
    }

    /// Makes a segment an edge of a triangle with these corners, if it leads through that between vertices that it has already or
    /// that are inserted; those in sides are sorted. Returns whether it does, or lies in a side.
    pub fn insert_segment(&mut self, triangle: u32, corners: [u32; 3], segment: [u32; 2]) -> bool {
        let sides = self.sides(corners);
        let has = |vertices: &[u32], v: u32| vertices.contains(&v);
        let in_one_side = (0..3).any(|k| {
            let side = [sides[k].as_slice(), &[corners[(k + 1) % 3]]].concat();
            segment.iter().all(|&v| has(&side, v))
        });
        let inside = self.inside.get(&triangle).map_or(&[][..], |inside| &inside.vertices);
        if in_one_side {
            return true;
        }
        let leads_through = segment.iter().all(|&v| has(inside, v) || has(&sides.concat(), v));
        if leads_through {
            self.inside.entry(triangle).or_default().segments.push(segment);
        }
        leads_through
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.of_edge.is_empty() && self.inside.is_empty()
    }

    /// Sorts the vertices of each edge along it.
    pub fn sort(&mut self, points: &[DVec3]) {
        for ([start, end], vertices) in &mut self.of_edge {
            let [start, end] = [*start, *end].map(|v| points[v as usize]);
            let along = |v: u32| (points[v as usize] - start).dot(end - start);
            vertices.sort_by(|&v, &w| along(v).total_cmp(&along(w)).then(v.cmp(&w)));
        }
    }

    /// The vertices inserted in an edge, from its first end to its second one; they are sorted.
    pub fn between(&self, from: u32, to: u32) -> Vec<u32> {
        let mut vertices = self.of_edge.get(&sorted([from, to])).cloned().unwrap_or_default();
        if from > to {
            vertices.reverse();
        }
        vertices
    }

    /// The sides of a triangle: the first corner of each, and the vertices inserted in it, in order.
    fn sides(&self, [a, b, c]: [u32; 3]) -> [Vec<u32>; 3] {
        [[a, b], [b, c], [c, a]].map(|[from, to]| [vec![from], self.between(from, to)].concat())
    }

    /// Triangulates the triangles anew that have vertices in their sides.
    pub fn apply(mut self, welded: &mut Welded) {
        if self.is_empty() {
            return;
        }
        self.sort(&welded.points);
        let (mut triangles, mut sources) = (Vec::new(), Vec::new());
        for ((t, &triangle), &source) in (0..).zip(&welded.triangles).zip(&welded.sources) {
            let sides = self.sides(triangle);
            let inside = self.inside.get(&t);
            if inside.is_none() && sides.iter().all(|side| side.len() == 1) {
                triangles.push(triangle);
            } else {
                let (vertices, segments): (&[u32], &[[u32; 2]]) =
                    inside.map_or((&[], &[]), |inside| (&inside.vertices, &inside.segments));
                let sides = [0, 1, 2].map(|k| sides[k].as_slice());
                let new = constrained::triangulate(&welded.points, sides, vertices, segments);
                // A vertex in two sides, or in the side opposite to it, closes the triangles between its places.
                triangles.extend(new.into_iter().filter(|[a, b, c]| a != b && b != c && c != a));
            }
            sources.resize(triangles.len(), source);
        }
        (welded.triangles, welded.sources) = (triangles, sources);
        welded.drop_repeated();
    }
}

pub(super) fn sorted([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}
