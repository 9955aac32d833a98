//! Cuts triangles along lines, which become edges of the surface. The shape stays.

mod flips;

use super::{NONE, Surface, next};
use glam::{DVec3, Vec3};
use rustc_hash::FxHashSet;

/// A point on the surface's edges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum EdgePoint {
    /// A vertex.
    Vertex(u32),
    /// The share of the way along a half-edge.
    Edge(u32, f64),
}

impl EdgePoint {
    pub fn position(self, surface: &Surface) -> DVec3 {
        match self {
            Self::Vertex(v) => surface.points[v as usize].as_dvec3(),
            Self::Edge(h, share) => {
                let [a, b] = [surface.origin(h), surface.target(h)].map(|v| surface.points[v as usize].as_dvec3());
                a + (b - a) * share
            }
        }
    }
}

/// The triangles of a surface, cut along lines.
pub(super) struct Split {
    pub points: Vec<Vec3>,
    pub triangles: Vec<[u32; 3]>,
    pub twins: Vec<u32>,
    /// The half-edge of each added point, and its share of the way along it.
    pub cuts: Vec<(u32, f64)>,
    /// The triangle that each one is a part of.
    pub sources: Vec<u32>,
    /// The two parts of each former half-edge, the first twice where it is whole.
    pub parts: Vec<[u32; 2]>,
    /// The half-edges on the lines.
    pub on_lines: Vec<u32>,
}

impl Split {
    /// Cuts the triangles along lines whose neighbouring places lie on one triangle; an edge is cut at one place at most.
    pub fn along(surface: &Surface, lines: &[Vec<EdgePoint>]) -> Self {
        let mut split = Self {
            points: surface.points.clone(),
            triangles: Vec::with_capacity(surface.triangle_count()),
            twins: Vec::new(),
            cuts: Vec::new(),
            sources: Vec::new(),
            parts: vec![[NONE; 2]; 3 * surface.triangle_count()],
            on_lines: Vec::new(),
        };
        let mut cuts = vec![NONE; 3 * surface.triangle_count()];
        let mut segments: FxHashSet<[u32; 2]> = FxHashSet::default();
        for line in lines {
            let vertices: Vec<u32> = line.iter().map(|&place| split.vertex(surface, &mut cuts, place)).collect();
            segments.extend(vertices.windows(2).map(|pair| [pair[0].min(pair[1]), pair[0].max(pair[1])]));
        }
        for t in 0..surface.triangle_count() as u32 {
            split.cut(surface, t, &cuts);
        }
        split.join_up(surface);
        split.on_lines = (0..3 * split.triangles.len() as u32)
            .filter(|&h| {
                let [a, b] = [h, next(h)].map(|h| split.triangles[h as usize / 3][h as usize % 3]);
                segments.contains(&[a.min(b), a.max(b)])
            })
            .collect();
        split
    }

    fn vertex(&mut self, surface: &Surface, cuts: &mut [u32], place: EdgePoint) -> u32 {
        match place {
            EdgePoint::Vertex(v) => v,
            EdgePoint::Edge(h, share) => {
                if cuts[h as usize] == NONE {
                    self.points.push(place.position(surface).as_vec3());
                    self.cuts.push((h, share));
                    for side in [Some(h), surface.twin(h)].into_iter().flatten() {
                        cuts[side as usize] = self.points.len() as u32 - 1;
                    }
                }
                cuts[h as usize]
            }
        }
    }

    /// Adds the parts of one triangle.
    fn cut(&mut self, surface: &Surface, triangle: u32, cuts: &[u32]) {
        let middle = [0, 1, 2].map(|k| Some(cuts[3 * triangle as usize + k]).filter(|&cut| cut != NONE));
        let corner = surface.triangles[triangle as usize];
        let first = self.triangles.len() as u32;
        // Turned so that cut sides come first and follow each other.
        let turn = match middle.map(|m| m.is_some()) {
            [false, true, _] => 1,
            [_, false, true] => 2,
            _ => 0,
        };
        let [a, b, c] = [0, 1, 2].map(|k| corner[(k + turn) % 3]);
        let sides = [0, 1, 2].map(|k| 3 * triangle + ((k + turn) % 3) as u32);
        let [ab, bc, ca] = [0, 1, 2].map(|k| middle[(k + turn) % 3]);
        // The parts, and the place among their edges of each half of the sides.
        let (parts, halves) = match (ab, bc, ca) {
            (None, ..) => (vec![[a, b, c]], [0, 0, 1, 1, 2, 2]),
            (Some(m), None, _) => (vec![[a, m, c], [m, b, c]], [0, 3, 4, 4, 2, 2]),
            (Some(m), Some(n), None) => {
                let far = |v: u32, w: u32| self.points[v as usize].distance_squared(self.points[w as usize]);
                if far(a, n) <= far(m, c) {
                    (vec![[m, b, n], [a, m, n], [a, n, c]], [3, 0, 1, 7, 8, 8])
                } else {
                    (vec![[m, b, n], [m, n, c], [a, m, c]], [6, 0, 1, 4, 8, 8])
                }
            }
            (Some(m), Some(n), Some(o)) => (vec![[a, m, o], [m, b, n], [o, n, c], [m, n, o]], [0, 3, 4, 7, 8, 2]),
        };
        for (i, place) in halves.into_iter().enumerate() {
            self.parts[sides[i / 2] as usize][i % 2] = 3 * first + place;
        }
        self.sources.extend(std::iter::repeat_n(triangle, parts.len()));
        self.triangles.extend(parts);
    }

    /// Finds the opposite of each half-edge.
    fn join_up(&mut self, surface: &Surface) {
        self.twins = vec![NONE; 3 * self.triangles.len()];
        for (h, &[first, second]) in self.parts.iter().enumerate() {
            if let Some(twin) = surface.twin(h as u32) {
                let [theirs, last] = self.parts[twin as usize];
                self.twins[first as usize] = last;
                self.twins[second as usize] = theirs;
            }
        }
        // Inside a triangle the parts are few.
        let mut begun = 0;
        for run in self.sources.chunk_by(|a, b| a == b) {
            let edges = 3 * begun as u32..3 * (begun + run.len()) as u32;
            begun += run.len();
            if run.len() == 1 {
                continue;
            }
            let ends = |h: u32| [h, next(h)].map(|h| self.triangles[h as usize / 3][h as usize % 3]);
            let pairs: Vec<[u32; 2]> = edges
                .clone()
                .flat_map(|h| edges.clone().map(move |g| [h, g]))
                .filter(|&[h, g]| h < g && ends(h) == [ends(g)[1], ends(g)[0]])
                .collect();
            for [h, g] in pairs {
                self.twins[h as usize] = g;
                self.twins[g as usize] = h;
            }
        }
    }
}

#[cfg(test)]
mod tests;
