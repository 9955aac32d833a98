//! Bridges: edges that join the ends of creases over gaps shorter than a tile.
//!
//! # Theory
//! A crease whose angle wavers about the least one falls into pieces. From an end of a crease the shortest way over edges that
//! turn less, but to the same side, leads on to the next piece: hysteresis, as in Canny's edge detector (*A computational
//! approach to edge detection*, 1986). Each end that is left would cost irregular vertices.

use super::walk::next_corner;
use super::{NONE, Surface};
use crate::geometry::{cross, dot};
use rustc_hash::FxHashMap;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// The least dihedral angle of an edge of a bridge, in degrees.
const LEAST_ANGLE: f64 = 15.0;
/// The longest bridge, in tile sides.
const LONGEST: f64 = 2.0;
/// A bridge to a place that is nearer along the crease than so many times its length is none.
const DETOUR: f64 = 3.0;

/// The half-edges of the bridges between the features of a surface for tiles of a side, unit-sized.
pub(super) fn bridges(surface: &Surface, side: f64) -> Vec<u32> {
    let mut graph = Graph::new(surface);
    let mut bridges = Vec::new();
    for v in 0..surface.vertex_count() as u32 {
        if let [edge] = graph.edges_at(v)[..]
            && let Some(path) = graph.path(v, edge, LONGEST * side)
        {
            graph.add(&path);
            bridges.extend(path);
        }
    }
    bridges
}

struct Graph<'a> {
    surface: &'a Surface,
    /// The feature edges at each vertex that has any, each by one half-edge.
    features: FxHashMap<u32, Vec<u32>>,
    /// A half-edge from each vertex; on a boundary the first one counter-clockwise.
    corner_of: Vec<u32>,
}

impl<'a> Graph<'a> {
    fn new(surface: &'a Surface) -> Self {
        let mut corner_of = vec![NONE; surface.vertex_count()];
        for h in 0..3 * surface.triangle_count() as u32 {
            let corner = &mut corner_of[surface.origin(h) as usize];
            if *corner == NONE || surface.twins[h as usize] == NONE {
                *corner = h;
            }
        }
        let mut graph = Self { surface, features: FxHashMap::default(), corner_of };
        let is_first = |h: &u32| *h < surface.twins[*h as usize];
        let marked = (0..3 * surface.triangle_count() as u32).filter(|&h| surface.features.is_feature(h));
        graph.add(&marked.filter(is_first).collect::<Vec<u32>>());
        graph
    }

    fn add(&mut self, edges: &[u32]) {
        for &h in edges {
            for v in [self.surface.origin(h), self.surface.target(h)] {
                self.features.entry(v).or_default().push(h);
            }
        }
    }

    fn edges_at(&self, v: u32) -> &[u32] {
        self.features.get(&v).map_or(&[], Vec::as_slice)
    }

    /// The sine of the dihedral angle of an edge, positive where it is convex; 0 of a boundary edge. Beyond a right angle it is 1.
    fn bend(&self, h: u32) -> f64 {
        let Some(twin) = self.surface.twin(h) else { return 0.0 };
        let [left, right] = [h, twin].map(|h| self.surface.normal(h as usize / 3));
        let [a, b] = [self.surface.origin(h), self.surface.target(h)].map(|v| self.surface.points[v as usize]);
        let sine = f64::from(cross(left, right).length());
        let sine = if dot(left, right) < 0.0 { 1.0 } else { sine };
        sine.copysign(f64::from(dot(cross(left, right), b - a)))
    }

    /// The shortest path from an end of a feature, whose last edge is `edge`, to another feature over edges that bend to the same
    /// side; none is longer than `longest`.
    fn path(&self, start: u32, edge: u32, longest: f64) -> Option<Vec<u32>> {
        let surface = self.surface;
        let least = LEAST_ANGLE.to_radians().sin();
        let side = self.bend(edge).signum();
        let mut reached: FxHashMap<u32, (f64, u32)> = FxHashMap::default();
        let mut queue = BinaryHeap::from([Reverse((0_u64, start, NONE))]);
        while let Some(Reverse((bits, v, came))) = queue.pop() {
            let length = f64::from_bits(bits);
            if reached.contains_key(&v) {
                continue;
            }
            reached.insert(v, (length, came));
            if v != start && !self.edges_at(v).is_empty() {
                let mut path = Vec::new();
                let mut at = v;
                while let Some(&(_, came)) = reached.get(&at).filter(|(_, came)| *came != NONE) {
                    path.push(came);
                    at = surface.origin(came);
                }
                return (!self.is_near_along(start, v, DETOUR * length)).then_some(path);
            }
            let first = self.corner_of[v as usize];
            let mut corner = Some(first);
            while let Some(h) = corner {
                let (w, on) = (surface.target(h), length + surface.length(h));
                if on <= longest && self.bend(h) * side >= least && !surface.features.is_feature(h) {
                    queue.push(Reverse((on.to_bits(), w, h)));
                }
                corner = next_corner(surface, |h| surface.twin(h).is_none(), h).filter(|&next| next != first);
            }
        }
        None
    }

    /// Whether features lead from a vertex to another within a length.
    fn is_near_along(&self, from: u32, to: u32, longest: f64) -> bool {
        let mut seen: FxHashMap<u32, f64> = FxHashMap::from_iter([(from, 0.0)]);
        let mut open = vec![(from, 0.0)];
        while let Some((v, length)) = open.pop() {
            for &h in self.edges_at(v) {
                let w = if self.surface.origin(h) == v { self.surface.target(h) } else { self.surface.origin(h) };
                let on = length + self.surface.length(h);
                if on <= longest && seen.get(&w).is_none_or(|&known| on < known) {
                    seen.insert(w, on);
                    open.push((w, on));
                }
            }
        }
        seen.contains_key(&to)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::{FeatureOptions, Soup};

    /// A sheet of unit squares, 4 wide and 40 long, folded along its middle: by 60 degrees, and by `gap` degrees in rows 18 to 22, with a
    /// gradual change between.
    fn sheet(gap: f64) -> Surface {
        let (half, length) = (2_u32, 40_u32);
        let across = 2 * half + 1;
        let angle = |j: u32| gap + (60.0 - gap) * ((f64::from(j) - 20.0).abs() - 2.0).clamp(0.0, 8.0) / 8.0;
        let point = |i: u32, j: u32| {
            let x = f64::from(i) - f64::from(half);
            [x, f64::from(j), -x.abs() * (angle(j) / 2.0).to_radians().tan()]
        };
        let at = |i: u32, j: u32| j * across + i;
        let cell =
            |i: u32, j: u32| [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]];
        let soup = Soup {
            points: (0..=length).flat_map(|j| (0..across).map(move |i| point(i, j))).collect(),
            triangles: (0..length).flat_map(|j| (0..across - 1).flat_map(move |i| cell(i, j))).collect(),
            ..Soup::default()
        };
        // Only the fold is sharper than this.
        let options = FeatureOptions { crease: 45.0, ..FeatureOptions::default() };
        Surface::new(&soup, &options).unwrap_or_else(|error| panic!("{error}"))
    }

    /// The number of edges of the bridges for tiles of a side, in model units.
    fn found(surface: &Surface, side: f64) -> usize {
        let bridges = bridges(surface, side / surface.frame().diagonal);
        let on_fold = |v: u32| surface.frame().to_model(surface.point(v))[0].abs() < 1e-4;
        assert!(bridges.iter().all(|&h| on_fold(surface.origin(h)) && on_fold(surface.target(h))));
        bridges.len()
    }

    #[test]
    fn a_gap_of_two_tiles_is_bridged_where_the_surface_bends_to_the_same_side() {
        let bent = sheet(30.0);
        let gap = (0..3 * bent.triangle_count() as u32).filter(|&h| {
            let on_fold = |v: u32| bent.frame().to_model(bent.point(v))[0].abs() < 1e-4;
            on_fold(bent.origin(h)) && on_fold(bent.target(h)) && !bent.features().is_feature(h)
        });
        let edges = gap.count() / 2;
        assert!((4..=14).contains(&edges), "{edges}");
        assert_eq!(found(&bent, edges as f64 / LONGEST + 0.1), edges);
        assert_eq!(found(&bent, edges as f64 / LONGEST - 0.1), 0, "the gap is longer than a bridge");
        assert_eq!(found(&sheet(10.0), 20.0), 0, "the gap is flat");
        assert_eq!(found(&sheet(-30.0), 20.0), 0, "the gap bends to the other side");
        assert_eq!(found(&sheet(60.0), 20.0), 0, "there is no gap");
    }
}
