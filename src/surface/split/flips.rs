//! Flips of edges inside triangles that were split, for better shaped parts.

use super::Split;
use crate::surface::{NONE, next, previous};

/// The least factor by which a flip improves the worse of two parts, so that no flip undoes another.
const GAIN: f64 = 1.01;

impl Split {
    /// Flips edges between parts of one root, a flat piece of the surface, as long as the worse of two parts gets better;
    /// `roots` names the root of each part.
    pub fn reshape(&mut self, roots: &[u32]) {
        let mut parents = vec![NONE; self.twins.len()];
        for (parent, parts) in (0..).zip(&self.parts) {
            parts.iter().for_each(|&part| parents[part as usize] = parent);
        }
        let is_inside = |twins: &[u32], h: u32| {
            let twin = twins[h as usize];
            twin != NONE && roots[h as usize / 3] == roots[twin as usize / 3]
        };
        let mut stack: Vec<u32> = (0..self.twins.len() as u32).filter(|&h| is_inside(&self.twins, h)).collect();
        while let Some(h) = stack.pop() {
            if is_inside(&self.twins, h) && self.gains(h) {
                stack.extend(self.flip(h, &mut parents));
            }
        }
    }

    fn corner(&self, h: u32) -> u32 {
        self.triangles[h as usize / 3][h as usize % 3]
    }

    /// Whether the two triangles at an edge are better shaped with the other diagonal, the worse one counting.
    fn gains(&self, h: u32) -> bool {
        let g = self.twins[h as usize];
        let [a, b, c, d] = [h, g, previous(h), previous(g)].map(|h| self.points[self.corner(h) as usize].as_dvec3());
        let normal = (b - a).cross(c - a) + (a - b).cross(d - b);
        // Twice the area, which is negative where the triangle is turned over, over the squared longest side.
        let shape = |p: glam::DVec3, q: glam::DVec3, r: glam::DVec3| {
            let longest = p.distance_squared(q).max(q.distance_squared(r)).max(r.distance_squared(p));
            (q - p).cross(r - p).dot(normal) / (normal.length() * longest).max(f64::MIN_POSITIVE)
        };
        let [now, then] = [[shape(a, b, c), shape(b, a, d)], [shape(a, d, c), shape(d, b, c)]].map(|[x, y]| x.min(y));
        then > 0.0 && then > GAIN * now
    }

    /// Puts the other diagonal in an edge's place; the four half-edges round the two triangles, which have moved.
    fn flip(&mut self, h: u32, parents: &mut [u32]) -> [u32; 4] {
        let g = self.twins[h as usize];
        let [t, u] = [h / 3, g / 3];
        let [a, b, c, d] = [h, g, previous(h), previous(g)].map(|h| self.corner(h));
        let old = [previous(g), next(h), next(g), previous(h)];
        let new = [3 * t, 3 * t + 1, 3 * u, 3 * u + 2];
        let twins = old.map(|h| self.twins[h as usize]);
        let owners = old.map(|h| parents[h as usize]);
        let slots: Vec<[usize; 3]> = (0..4)
            .filter(|&i| owners[i] != NONE)
            .flat_map(|i| [0, 1].map(|half| [i, owners[i] as usize, half]))
            .filter(|&[i, owner, half]| self.parts[owner][half] == old[i])
            .collect();
        self.triangles[t as usize] = [d, b, c];
        self.triangles[u as usize] = [a, d, c];
        for (i, &h) in new.iter().enumerate() {
            self.twins[h as usize] = twins[i];
            parents[h as usize] = owners[i];
            if twins[i] != NONE {
                self.twins[twins[i] as usize] = h;
            }
        }
        for [i, owner, half] in slots {
            self.parts[owner][half] = new[i];
        }
        let [across, back] = [3 * t + 2, 3 * u + 1];
        (self.twins[across as usize], self.twins[back as usize]) = (back, across);
        parents[across as usize] = NONE;
        parents[back as usize] = NONE;
        new
    }
}
