//! The edges of welded triangles, and the loops of open ones.

use super::cuts::sorted;
use rustc_hash::{FxHashMap, FxHashSet};

/// The edges of triangles.
pub(super) struct Edges {
    /// The triangles at each edge: how many, and the first.
    triangles: FxHashMap<[u32; 2], (u32, u32)>,
    /// The edges of one triangle, in order.
    open: Vec<[u32; 2]>,
}

impl Edges {
    pub fn new(triangles: &[[u32; 3]]) -> Self {
        let mut edges = Self { triangles: FxHashMap::default(), open: Vec::new() };
        edges.triangles.reserve(3 * triangles.len() / 2);
        (0..).zip(triangles).for_each(|(t, &triangle)| edges.add(t, triangle));
        let is_open = |side: &[u32; 2]| edges.triangles[&sorted(*side)].0 == 1;
        edges.open = triangles.iter().flat_map(|&triangle| sides(triangle)).filter(is_open).collect();
        edges
    }

    /// Adds the edges of a triangle; those that were open are still called so.
    pub fn add(&mut self, id: u32, triangle: [u32; 3]) {
        for side in sides(triangle) {
            self.triangles.entry(sorted(side)).or_insert((0, id)).0 += 1;
        }
    }

    /// The edges of one triangle each, as that triangle passes them.
    pub fn open(&self) -> &[[u32; 2]] {
        &self.open
    }

    /// The first triangle at an edge.
    pub fn triangle_at(&self, a: u32, b: u32) -> u32 {
        self.triangles[&sorted([a, b])].1
    }

    /// Whether two vertices have an edge between them.
    pub fn are_joined(&self, a: u32, b: u32) -> bool {
        self.triangles.contains_key(&sorted([a, b]))
    }

    /// The loops of open edges in which no vertex is passed twice, each of three vertices at least.
    pub fn loops(&self) -> Vec<Vec<u32>> {
        let mut leaving: FxHashMap<u32, Vec<u32>> = FxHashMap::default();
        for &[a, b] in &self.open {
            leaving.entry(a).or_default().push(b);
            leaving.entry(b).or_default().push(a);
        }
        let mut loops = Vec::new();
        let mut passed: FxHashSet<[u32; 2]> = FxHashSet::default();
        for &[start, _] in &self.open {
            // A walk along edges not passed yet; where it meets itself, a loop is complete.
            let mut path = vec![start];
            let mut places = FxHashMap::from_iter([(start, 0)]);
            while let Some(&last) = path.last() {
                let onward = leaving[&last].iter().copied().find(|&next| !passed.contains(&sorted([last, next])));
                let Some(next) = onward else {
                    // An open end: edges of more than two triangles begin there.
                    path.pop();
                    places.remove(&last);
                    continue;
                };
                passed.insert(sorted([last, next]));
                if let Some(&place) = places.get(&next) {
                    let found = path.split_off(place + 1);
                    found.iter().for_each(|v| _ = places.remove(v));
                    loops.push([vec![next], found].concat());
                } else {
                    places.insert(next, path.len());
                    path.push(next);
                }
            }
        }
        loops
    }
}

/// The sides of a triangle.
pub(super) fn sides([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}
