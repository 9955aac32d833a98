//! Constraint release: creases that are too near each other for rows of their own.
//!
//! Rows that pass over the whole surface are at least one tile apart. Two creases that are nearer lie on one row, and the
//! triangles between them are inverted. The constraint of one of the two is then released, from a free end of the crease on.

use super::{NEARLY_INVERTED, Parametrization, equations};
use crate::compute::{Backend, ComputeError};
use crate::surface::{Curve, Surface};
use rayon::prelude::*;
use rustc_hash::FxHashMap;

/// The longest part of a crease that is released, in tile sides.
const LONGEST: f64 = 3.0;
/// Rounds at most.
const ROUNDS: usize = 4;

/// A part of a curve, from a released end on.
#[derive(Clone, Copy)]
struct CurveEnd {
    curve: usize,
    from_end: bool,
    /// How many vertices.
    count: usize,
    /// In tile sides.
    length: f64,
}

impl Parametrization<'_> {
    /// Releases creases beside inverted triangles and solves again, until no crease is released.
    ///
    /// # Errors
    /// Where the backend fails.
    pub(super) fn release(&mut self, surface: &Surface, backend: &dyn Backend) -> Result<(), ComputeError> {
        for _ in 0..ROUNDS {
            if !self.release_once(surface) {
                break;
            }
            let cones = self.cones(surface);
            self.solve_offsets(surface, &cones, backend)?;
        }
        Ok(())
    }

    /// Releases creases once; whether there were any.
    fn release_once(&mut self, surface: &Surface) -> bool {
        let inverted: Vec<bool> = (0..surface.triangle_count() as u32)
            .into_par_iter()
            .map(|t| self.quarters_around(t) == 0 && self.singular_values(t)[1] < NEARLY_INVERTED)
            .collect();
        let mut groups = Groups((0..surface.vertex_count() as u32).collect());
        let mut is_inverted = vec![false; surface.vertex_count()];
        for (t, _) in inverted.iter().enumerate().filter(|(_, inverted)| **inverted) {
            let [a, b, c] = surface.triangles[t];
            [a, b, c].into_iter().for_each(|v| is_inverted[v as usize] = true);
            groups.unite(a, b);
            groups.unite(b, c);
        }
        // The shortest part for each group of inverted triangles, in order.
        let mut shortest: FxHashMap<u32, CurveEnd> = FxHashMap::default();
        let mut order = Vec::new();
        for (number, curve) in surface.features().curves().iter().enumerate().filter(|(_, curve)| !curve.closed) {
            for from_end in [false, true] {
                let vertices = run(curve, from_end);
                if !self.released_ends.contains(&vertices[0]) {
                    continue;
                }
                let mut parts: FxHashMap<u32, CurveEnd> = FxHashMap::default();
                let mut length = 0.0;
                for (i, &v) in vertices.iter().enumerate() {
                    if i > 0 {
                        let edge = if from_end { curve.half_edges.len() - i } else { i - 1 };
                        let [x, y] = self.transitions[curve.half_edges[edge] as usize].wanted;
                        length += x.hypot(y);
                    }
                    let is_held = !self.released_ends.contains(&v) && surface.features().is_corner(v);
                    if length > LONGEST || is_held {
                        break;
                    }
                    if is_inverted[v as usize] && !self.released_vertices.contains(&v) {
                        parts.insert(groups.of(v), CurveEnd { curve: number, from_end, count: i + 1, length });
                    }
                }
                let mut parts: Vec<(u32, CurveEnd)> = parts.into_iter().collect();
                parts.sort_unstable_by_key(|&(group, _)| group);
                for (group, part) in parts {
                    match shortest.get_mut(&group) {
                        Some(best) if part.length < best.length => *best = part,
                        Some(_) => {}
                        None => {
                            shortest.insert(group, part);
                            order.push(group);
                        }
                    }
                }
            }
        }
        for group in &order {
            let part = shortest[group];
            let vertices = run(&surface.features().curves()[part.curve], part.from_end);
            self.released_vertices.extend(&vertices[..part.count]);
        }
        if !order.is_empty() {
            (self.unknowns, self.fixed) =
                equations::unknowns(surface, self.field.sectors(), &self.released_ends, &self.released_vertices);
        }
        !order.is_empty()
    }
}

/// The vertices of a curve, from its first or its last on.
fn run(curve: &Curve, from_end: bool) -> Vec<u32> {
    let mut vertices = curve.vertices.clone();
    if from_end {
        vertices.reverse();
    }
    vertices
}

/// Vertices, each with another one of its group or itself.
struct Groups(Vec<u32>);

impl Groups {
    fn of(&mut self, mut v: u32) -> u32 {
        while self.0[v as usize] != v {
            let above = self.0[self.0[v as usize] as usize];
            self.0[v as usize] = above;
            v = above;
        }
        v
    }

    fn unite(&mut self, a: u32, b: u32) {
        let [a, b] = [self.of(a), self.of(b)];
        self.0[a.max(b) as usize] = a.min(b);
    }
}
