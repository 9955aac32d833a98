//! Sides that do not grow faster than allowed.

use crate::surface::Surface;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Lowers each side to the least that the others allow: along an edge of the surface, by at most `slope` times its length.
///
/// The smallest side is settled first and bounds its neighbours, as in Dijkstra's search for shortest ways. Across
/// triangles, where no edge runs, sides may grow a little faster.
pub fn limit(surface: &Surface, sides: &mut [f64], slope: f64) {
    let edges = Edges::new(surface);
    let first = |v: usize| surface.same_place(v as u32) as usize;
    for v in 0..sides.len() {
        sides[first(v)] = sides[first(v)].min(sides[v]);
    }
    // The bits of positive numbers are ordered as the numbers are.
    let places = (0..sides.len()).filter(|&v| first(v) == v);
    let mut queue: BinaryHeap<Reverse<(u64, u32)>> = places.map(|v| Reverse((sides[v].to_bits(), v as u32))).collect();
    while let Some(Reverse((bits, vertex))) = queue.pop() {
        let side = f64::from_bits(bits);
        if side > sides[vertex as usize] {
            continue;
        }
        for &(other, length) in edges.at(vertex) {
            let most = side + slope * length;
            if most < sides[other as usize] {
                sides[other as usize] = most;
                queue.push(Reverse((most.to_bits(), other)));
            }
        }
    }
    for v in 0..sides.len() {
        sides[v] = sides[first(v)];
    }
}

/// The edges at each place, with their other end and length.
struct Edges {
    starts: Vec<u32>,
    list: Vec<(u32, f64)>,
}

impl Edges {
    fn new(surface: &Surface) -> Self {
        let ends = |h: u32| [surface.origin(h), surface.target(h)].map(|v| surface.same_place(v));
        // Both ways, also where an edge has one half-edge alone.
        let mut all: Vec<[u32; 3]> = (0..3 * surface.triangle_count() as u32)
            .flat_map(|h| {
                let [a, b] = ends(h);
                [[a, b, h], [b, a, h]]
            })
            .collect();
        all.sort_unstable();
        all.dedup_by_key(|[a, b, _]| [*a, *b]);
        let starts = (0..=surface.vertex_count() as u32).map(|v| all.partition_point(|edge| edge[0] < v) as u32);
        Self { starts: starts.collect(), list: all.iter().map(|&[_, b, h]| (b, surface.length(h))).collect() }
    }

    fn at(&self, vertex: u32) -> &[(u32, f64)] {
        &self.list[self.starts[vertex as usize] as usize..self.starts[vertex as usize + 1] as usize]
    }
}
