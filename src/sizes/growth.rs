//! The limit of growth from one tile to the next.

use crate::surface::Surface;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// The edges of a surface, along which sides are limited.
pub struct Growth<'a> {
    surface: &'a Surface,
    /// Where the edges at each place begin in `edges`.
    starts: Vec<u32>,
    /// The other end and the length.
    edges: Vec<(u32, f64)>,
    /// The sides at the vertices of a boundary that the mesh keeps.
    kept: Vec<(u32, f64)>,
}

impl<'a> Growth<'a> {
    pub fn new(surface: &'a Surface) -> Self {
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
        let edges = all.iter().map(|&[_, b, h]| (b, surface.length(h))).collect();
        Self { surface, starts: starts.collect(), edges, kept: surface.kept_lengths() }
    }

    /// Makes sides those of the edges of the boundary that the mesh keeps, from which other sides differ by at most `slope` times
    /// the way. Sides of the boundary that differ by more are lowered.
    pub fn keep_boundary(&self, sides: &mut [f64], slope: f64) {
        if self.kept.is_empty() {
            return;
        }
        let mut wanted = vec![f64::INFINITY; sides.len()];
        self.kept.iter().for_each(|&(v, side)| wanted[v as usize] = side);
        self.limit(&mut wanted, slope);
        sides.iter_mut().zip(&wanted).for_each(|(side, &most)| *side = side.min(most));
        self.kept.iter().for_each(|&(v, _)| sides[v as usize] = wanted[v as usize]);
        // To limit what sides lack to the largest one is to raise them.
        let largest = sides.iter().copied().fold(0.0, f64::max);
        let mut lacking: Vec<f64> = sides.iter().map(|side| largest - side).collect();
        self.limit(&mut lacking, slope);
        sides.iter_mut().zip(lacking).for_each(|(side, lacking)| *side = largest - lacking);
    }

    /// Lowers sides so that the difference along each edge is at most `slope` times its length.
    ///
    /// As in Dijkstra's search for shortest paths, the smallest side is final first and limits its neighbours. Across triangles,
    /// where no edge runs, sides may grow a little faster.
    pub fn limit(&self, sides: &mut [f64], slope: f64) {
        let first = |v: usize| self.surface.same_place(v as u32) as usize;
        for v in 0..sides.len() {
            sides[first(v)] = sides[first(v)].min(sides[v]);
        }
        // The bits of positive numbers are ordered as the numbers are.
        let places = (0..sides.len()).filter(|&v| first(v) == v);
        let mut queue: BinaryHeap<Reverse<(u64, u32)>> =
            places.map(|v| Reverse((sides[v].to_bits(), v as u32))).collect();
        while let Some(Reverse((bits, vertex))) = queue.pop() {
            let side = f64::from_bits(bits);
            if side > sides[vertex as usize] {
                continue;
            }
            let at = self.starts[vertex as usize] as usize..self.starts[vertex as usize + 1] as usize;
            for &(other, length) in &self.edges[at] {
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
}
