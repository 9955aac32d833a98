//! An intrinsic triangulation: connectivity, edge lengths, and the directions of edges at their vertices; no coordinates.
//!
//! # Theory
//! After Sharp, Soliman and Crane 2019, *Navigating intrinsic triangulations*: edges are geodesics of the surface, given
//! by their lengths, and each half-edge has its direction at its origin. Flips are exact for any shape in space: a thin
//! trailing edge and a strongly curved nose are intrinsically flat.
//!
//! # Practice
//! Half-edge `3 f + k` leaves corner `k` of face `f`. A corner has the directions at which it begins and ends, scaled like the
//! field's sectors, so that no angle is lost where corners are split and joined. The triangulation stays simplicial: no
//! operation makes a second edge between two vertices. An operation that would returns false; check the result.

mod removal;

use crate::surface::NONE;
use std::f64::consts::PI;

/// The triangulation. A dead face has origins [`NONE`].
#[derive(Clone, Debug, Default)]
pub(crate) struct Intrinsic {
    pub origin: Vec<u32>,
    pub twin: Vec<u32>,
    pub length: Vec<f64>,
    /// The scaled direction at the origin at which the corner of each half-edge begins: the half-edge's own.
    pub begin: Vec<f64>,
    /// The scaled direction at which that corner ends.
    pub end: Vec<f64>,
    /// The curve of each half-edge on a feature, [`NONE`] off features. Those on features are never flipped.
    pub curve: Vec<u32>,
    /// A half-edge that leaves each vertex; [`NONE`] where the vertex is removed.
    pub leaving: Vec<u32>,
}

pub(crate) use crate::surface::{next, previous};

/// The angle between sides `a` and `b` of a triangle whose third side is `c`; clamped where the sides do not close.
pub(crate) fn angle(a: f64, b: f64, c: f64) -> f64 {
    let cosine = (a * a + b * b - c * c) / (2.0 * a * b).max(f64::MIN_POSITIVE);
    cosine.clamp(-1.0, 1.0).acos()
}

/// The third side of a triangle with sides `a` and `b` and the angle between them.
pub(crate) fn third_side(a: f64, b: f64, angle: f64) -> f64 {
    (a * a + b * b - 2.0 * a * b * angle.cos()).max(0.0).sqrt()
}

/// The shortest new edge, as a share of the edge that is flipped.
const SHORTEST: f64 = 1e-12;

/// Two triangles on either side of an edge, laid in the plane: `a` at the origin, `b` at `(ab, 0)`, `c` above, `d` below.
struct Layout {
    ab: f64,
    c: [f64; 2],
    d: [f64; 2],
}

impl Intrinsic {
    pub fn face_count(&self) -> usize {
        self.origin.len() / 3
    }

    pub fn is_alive(&self, face: u32) -> bool {
        self.origin[3 * face as usize] != NONE
    }

    pub fn target(&self, h: u32) -> u32 {
        self.origin[next(h) as usize]
    }

    /// The unscaled angle of the corner at a half-edge's origin.
    pub fn corner(&self, h: u32) -> f64 {
        angle(self.length[h as usize], self.length[previous(h) as usize], self.length[next(h) as usize])
    }

    /// Adds a face without twins; returns its first half-edge.
    pub fn push_face(&mut self, origins: [u32; 3]) -> u32 {
        let h = self.origin.len() as u32;
        self.origin.extend(origins);
        self.twin.extend([NONE; 3]);
        self.length.extend([0.0; 3]);
        self.begin.extend([0.0; 3]);
        self.end.extend([0.0; 3]);
        self.curve.extend([NONE; 3]);
        h
    }

    /// Makes two half-edges each other's twins, with the first one's length; either may be [`NONE`].
    pub fn glue(&mut self, g: u32, h: u32) {
        if g != NONE {
            self.twin[g as usize] = h;
        }
        if h != NONE {
            self.twin[h as usize] = g;
        }
        if g != NONE && h != NONE {
            self.length[h as usize] = self.length[g as usize];
        }
    }

    /// The scaled angle that the corner of a half-edge spans.
    pub fn width(&self, h: u32) -> f64 {
        self.end[h as usize] - self.begin[h as usize]
    }

    fn set_corner(&mut self, h: u32, begin: f64, end: f64) {
        self.begin[h as usize] = begin;
        self.end[h as usize] = end;
    }

    /// The half-edges that leave a vertex, counter-clockwise; on a boundary from the first. True: all the way round.
    pub fn ring(&self, vertex: u32, ring: &mut Vec<u32>) -> bool {
        ring.clear();
        let start = self.leaving[vertex as usize];
        let mut first = start;
        loop {
            let twin = self.twin[first as usize];
            if twin == NONE {
                break;
            }
            first = next(twin);
            if first == start {
                break;
            }
        }
        let mut h = first;
        loop {
            ring.push(h);
            h = self.twin[previous(h) as usize];
            if h == NONE {
                return false;
            }
            if h == first {
                return true;
            }
        }
    }

    /// Whether a half-edge lies on a feature.
    pub fn is_feature(&self, h: u32) -> bool {
        self.curve[h as usize] != NONE
    }

    /// Whether an edge joins two vertices.
    pub fn joined(&self, a: u32, b: u32) -> bool {
        let mut found = false;
        self.visit_neighbours(a, |v| found |= v == b);
        found
    }

    /// Calls `visit` with every neighbour of a vertex.
    pub fn visit_neighbours(&self, vertex: u32, mut visit: impl FnMut(u32)) {
        let start = self.leaving[vertex as usize];
        let mut h = start;
        loop {
            visit(self.target(h));
            h = self.twin[previous(h) as usize];
            if h == start {
                return;
            }
            if h == NONE {
                break;
            }
        }
        // On a boundary: the rest of the fan, clockwise from the start, and the end that was met.
        let mut h = start;
        while self.twin[h as usize] != NONE {
            h = next(self.twin[h as usize]);
            visit(self.target(h));
        }
        let mut h = start;
        while self.twin[previous(h) as usize] != NONE {
            h = self.twin[previous(h) as usize];
        }
        visit(self.origin[previous(h) as usize]);
    }

    fn layout(&self, h: u32) -> Layout {
        let t = self.twin[h as usize];
        let l = |e: u32| self.length[e as usize];
        let ab = l(h);
        let foot = |to_a: f64, to_b: f64| {
            let x = (ab * ab + to_a * to_a - to_b * to_b) / (2.0 * ab).max(f64::MIN_POSITIVE);
            (x, (to_a * to_a - x * x).max(0.0).sqrt())
        };
        let (cx, cy) = foot(l(previous(h)), l(next(h)));
        let (dx, dy) = foot(l(next(t)), l(previous(t)));
        Layout { ab, c: [cx, cy], d: [dx, -dy] }
    }

    /// Whether a half-edge may be flipped: it has two faces that lie as a convex quad, and the new edge would be new.
    fn can_flip(&self, h: u32) -> bool {
        if self.twin[h as usize] == NONE || self.is_feature(h) {
            return false;
        }
        let Layout { ab, c, d } = self.layout(h);
        let height = c[1] - d[1];
        if height <= SHORTEST * ab {
            return false;
        }
        let crossing = d[0] + (c[0] - d[0]) * (-d[1] / height);
        let margin = 1e-9 * ab;
        crossing > margin && crossing < ab - margin && self.is_other_diagonal_new(h)
    }

    /// Whether the vertices opposite an edge are two that no edge joins.
    fn is_other_diagonal_new(&self, h: u32) -> bool {
        let [c, d] = [h, self.twin[h as usize]].map(|e| self.origin[previous(e) as usize]);
        c != d && !self.joined(c, d)
    }

    /// Turns the edge of `h` to the other diagonal of its two faces, where that is possible.
    pub fn flip(&mut self, h: u32) -> bool {
        let is_possible = self.can_flip(h);
        if is_possible {
            self.turn(h);
        }
        is_possible
    }

    /// As [`Self::flip`], also where the two faces lie as no convex quad. The new edge is as long as the quad's other diagonal, which
    /// lies outside it then.
    pub fn flip_any(&mut self, h: u32) -> bool {
        let is_possible = self.twin[h as usize] != NONE && !self.is_feature(h) && self.is_other_diagonal_new(h);
        if is_possible {
            self.turn(h);
        }
        is_possible
    }

    fn turn(&mut self, h: u32) {
        let Layout { ab, c, d } = self.layout(h);
        let length = (c[0] - d[0]).hypot(c[1] - d[1]).max(SHORTEST * ab);
        let t = self.twin[h as usize];
        // Faces (a, b, c) with h = ab, and (b, a, d) with t = ba, become (a, d, c) and (d, b, c).
        let (bc, ca, ad, db) = (next(h), previous(h), next(t), previous(t));
        let [a, b, vc, vd] = [h, t, ca, db].map(|e| self.origin[e as usize]);
        let l = |e: u32| self.length[e as usize];
        let share = |whole: f64, part: f64| if whole > 0.0 { (part / whole).clamp(0.0, 1.0) } else { 0.5 };
        let c_share = share(self.corner(ca), angle(l(ca), length, l(ad)));
        let d_share = share(self.corner(db), angle(l(db), length, l(bc)));
        let [at_c, at_d] = [(ca, c_share), (db, d_share)].map(|(e, share)| {
            let (begin, width) = (self.begin[e as usize], self.width(e));
            [begin, begin + width * share, begin + width]
        });
        let [a_corner, b_corner] = [(ad, h), (bc, t)].map(|(first, second)| {
            let begin = self.begin[first as usize];
            (begin, begin + self.width(first) + self.width(second))
        });
        let sides = [ad, ca, db, bc].map(|e| (self.twin[e as usize], l(e), self.curve[e as usize]));
        let (f, g) = (h / 3 * 3, t / 3 * 3);
        let put = |s: &mut Self, e: u32, origin: u32, corner: (f64, f64), side: Option<(u32, f64, u32)>| {
            s.origin[e as usize] = origin;
            s.set_corner(e, corner.0, corner.1);
            if let Some((twin, length, curve)) = side {
                s.twin[e as usize] = twin;
                s.length[e as usize] = length;
                s.curve[e as usize] = curve;
                if twin != NONE {
                    s.twin[twin as usize] = e;
                }
            }
        };
        put(self, f, a, a_corner, Some(sides[0]));
        put(self, f + 1, vd, (at_d[1], at_d[2]), None);
        put(self, f + 2, vc, (at_c[0], at_c[1]), Some(sides[1]));
        put(self, g, vd, (at_d[0], at_d[1]), Some(sides[2]));
        put(self, g + 1, b, b_corner, Some(sides[3]));
        put(self, g + 2, vc, (at_c[1], at_c[2]), None);
        for e in [f + 1, g + 2] {
            self.length[e as usize] = length;
            self.curve[e as usize] = NONE;
        }
        self.twin[f as usize + 1] = g + 2;
        self.twin[g as usize + 2] = f + 1;
        for (vertex, e) in [(a, f), (vd, g), (b, g + 1), (vc, f + 2)] {
            self.leaving[vertex as usize] = e;
        }
    }

    /// Whether the edge of `h` meets Delaunay's condition: its two opposite angles sum to at most pi.
    pub fn is_delaunay(&self, h: u32) -> bool {
        let t = self.twin[h as usize];
        if t == NONE || self.is_feature(h) {
            return true;
        }
        let Layout { c, d, ab } = self.layout(h);
        // cot C + cot D >= 0, with cot = (squares of the legs minus square of the base) / 4 areas.
        let cot = |p: [f64; 2]| {
            let dot = p[0] * (p[0] - ab) + p[1] * p[1];
            dot / (ab * p[1].abs()).max(1e-300)
        };
        cot(c) + cot(d) >= -1e-9
    }

    /// Flips edges until all that can be are Delaunay, starting from these half-edges.
    ///
    /// `may_flip(self, h)` can forbid it; `length(a, b, f, l)` gives the length of the new edge of face `f`, `l` being what
    /// the flip found.
    pub fn legalize(
        &mut self,
        stack: &mut Vec<u32>,
        may_flip: impl Fn(&Self, u32) -> bool,
        length: impl Fn(u32, u32, u32, f64) -> f64,
    ) {
        let mut budget = 1000 + 100 * stack.len();
        while let Some(h) = stack.pop() {
            if !self.is_alive(h / 3) || self.is_delaunay(h) || budget == 0 || !may_flip(self, h) {
                continue;
            }
            let t = self.twin[h as usize];
            if self.flip(h) {
                budget -= 1;
                let (f, g) = (h / 3 * 3, t / 3 * 3);
                let new = length(self.origin[f as usize + 1], self.target(f + 1), f / 3, self.length[f as usize + 1]);
                self.length[f as usize + 1] = new;
                self.length[g as usize + 2] = new;
                stack.extend([f, f + 2, g, g + 1]);
            }
        }
    }

    /// Splits an edge on a feature at a share of a half-edge's length; returns the new vertex.
    ///
    /// Directions at the new vertex count from the edge, on either side of it apart.
    pub fn split_edge(&mut self, h: u32, share: f64) -> u32 {
        let m = self.leaving.len() as u32;
        self.leaving.push(NONE);
        let t = self.twin[h as usize];
        let whole = self.length[h as usize];
        let curve = self.curve[h as usize];
        let near = self.split_side(h, share, m);
        let (am, mb) = (h, near);
        for (e, part) in [(am, share), (mb, 1.0 - share)] {
            self.length[e as usize] = whole * part;
            self.curve[e as usize] = curve;
        }
        self.leaving[m as usize] = mb;
        if t == NONE {
            self.twin[am as usize] = NONE;
            self.twin[mb as usize] = NONE;
        } else {
            let ma = self.split_side(t, 1.0 - share, m);
            for (e, part) in [(t, 1.0 - share), (ma, share)] {
                self.length[e as usize] = whole * part;
                self.curve[e as usize] = curve;
            }
            self.glue(am, ma);
            self.glue(mb, t);
        }
        m
    }

    /// Splits the face of `h` = ab (third corner c) by an edge from c to `m` on ab; returns the half-edge mb.
    fn split_side(&mut self, h: u32, share: f64, m: u32) -> u32 {
        let (bc, ca) = (next(h), previous(h));
        let l = |s: &Self, e: u32| s.length[e as usize];
        let (ab, vb, vc) = (l(self, h), self.origin[bc as usize], self.origin[ca as usize]);
        let am = ab * share;
        let mc = third_side(am, l(self, ca), self.corner(h));
        let at_m = angle(ab - am, mc, l(self, bc));
        let at_c = angle(l(self, ca), mc, am) / self.corner(ca).max(f64::MIN_POSITIVE);
        let (cb, ce) = (self.begin[ca as usize], self.end[ca as usize]);
        let c_middle = cb + (ce - cb) * at_c.clamp(0.0, 1.0);
        let b_corner = (self.begin[bc as usize], self.end[bc as usize]);
        let outer = (self.twin[bc as usize], l(self, bc), self.curve[bc as usize]);
        // The old face becomes (a, m, c); the new one is (m, b, c).
        let new = self.push_face([m, vb, vc]);
        self.origin[bc as usize] = m;
        self.curve[bc as usize] = NONE;
        self.set_corner(ca, cb, c_middle);
        self.set_corner(bc, at_m, PI);
        self.set_corner(new, 0.0, at_m);
        self.set_corner(new + 1, b_corner.0, b_corner.1);
        self.set_corner(new + 2, c_middle, ce);
        self.length[bc as usize] = mc;
        self.glue(bc, new + 2);
        self.length[new as usize + 1] = outer.1;
        self.curve[new as usize + 1] = outer.2;
        self.glue(new + 1, outer.0);
        self.leaving[vb as usize] = new + 1;
        self.leaving[vc as usize] = ca;
        new
    }

    /// Puts a vertex into a face. `lengths` and `directions` are those of the edges to the face's corners.
    pub fn split_face(&mut self, face: u32, lengths: [f64; 3], directions: [f64; 3]) -> u32 {
        let p = self.leaving.len() as u32;
        let h = [0, 1, 2].map(|k| 3 * face + k);
        let origins = h.map(|e| self.origin[e as usize]);
        let corners = h.map(|e| (self.begin[e as usize], self.end[e as usize]));
        let shares = [0, 1, 2].map(|k| {
            let part = angle(self.length[h[k] as usize], lengths[k], lengths[(k + 1) % 3]);
            (part / self.corner(h[k]).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0)
        });
        let outer = h.map(|e| (self.twin[e as usize], self.length[e as usize], self.curve[e as usize]));
        // Face k is (origin k, origin k + 1, p); the first reuses the old one.
        let faces = [3 * face, self.push_face([0; 3]), self.push_face([0; 3])];
        for k in 0..3 {
            let (e, n) = (faces[k], (k + 1) % 3);
            for (i, v) in [origins[k], origins[n], p].into_iter().enumerate() {
                self.origin[e as usize + i] = v;
            }
            let split = |(begin, end): (f64, f64), share: f64| begin + (end - begin) * share;
            self.set_corner(e, corners[k].0, split(corners[k], shares[k]));
            self.set_corner(e + 1, split(corners[n], shares[n]), corners[n].1);
            let turn = (directions[n] - directions[k]).rem_euclid(2.0 * PI);
            self.set_corner(e + 2, directions[k], directions[k] + turn);
            self.length[e as usize] = outer[k].1;
            self.curve[e as usize] = outer[k].2;
            self.glue(e, outer[k].0);
            self.length[e as usize + 1] = lengths[n];
            self.length[e as usize + 2] = lengths[k];
            self.curve[e as usize + 1] = NONE;
            self.curve[e as usize + 2] = NONE;
            self.leaving[origins[k] as usize] = e;
        }
        for k in 0..3 {
            self.glue(faces[k] + 1, faces[(k + 1) % 3] + 2);
        }
        self.leaving.push(faces[0] + 2);
        p
    }
}

#[cfg(test)]
pub(super) mod tests;
