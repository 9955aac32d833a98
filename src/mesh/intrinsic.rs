//! An intrinsic triangulation: connectivity, edge lengths, and the directions of edges at their vertices; no coordinates.
//!
//! # Theory
//! After Sharp, Soliman and Crane 2019, *Navigating intrinsic triangulations*: edges are geodesics of the surface, known
//! by their lengths, and each half-edge knows its direction at its origin. Flips are exact, whatever the shape in space:
//! a thin trailing edge or a strongly curved nose is as flat here as a plane.
//!
//! # Practice
//! Half-edge `3 f + k` leaves corner `k` of face `f`. A corner holds the directions at which it begins and ends, scaled
//! as the field's sectors are, so that splitting and joining corners never loses an angle. The triangulation stays
//! simplicial: no operation makes a second edge between two vertices.

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
    /// Half-edges on features; they are never flipped.
    pub locked: Vec<bool>,
    /// A half-edge that leaves each vertex; [`NONE`] where the vertex is gone.
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
        self.locked.extend([false; 3]);
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
        let t = self.twin[h as usize];
        if t == NONE || self.locked[h as usize] {
            return false;
        }
        let Layout { ab, c, d } = self.layout(h);
        let height = c[1] - d[1];
        if height <= 1e-12 * ab {
            return false;
        }
        let crossing = d[0] + (c[0] - d[0]) * (-d[1] / height);
        let margin = 1e-9 * ab;
        crossing > margin
            && crossing < ab - margin
            && self.origin[previous(h) as usize] != self.origin[previous(t) as usize]
            && !self.joined(self.origin[previous(h) as usize], self.origin[previous(t) as usize])
    }

    /// Turns the edge of `h` to the other diagonal of its two faces, where that is possible.
    pub fn flip(&mut self, h: u32) -> bool {
        if !self.can_flip(h) {
            return false;
        }
        let Layout { c, d, .. } = self.layout(h);
        let length = (c[0] - d[0]).hypot(c[1] - d[1]);
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
        let sides = [ad, ca, db, bc].map(|e| (self.twin[e as usize], l(e), self.locked[e as usize]));
        let (f, g) = (h / 3 * 3, t / 3 * 3);
        let put = |s: &mut Self, e: u32, origin: u32, corner: (f64, f64), side: Option<(u32, f64, bool)>| {
            s.origin[e as usize] = origin;
            s.set_corner(e, corner.0, corner.1);
            if let Some((twin, length, locked)) = side {
                s.twin[e as usize] = twin;
                s.length[e as usize] = length;
                s.locked[e as usize] = locked;
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
            self.locked[e as usize] = false;
        }
        self.twin[f as usize + 1] = g + 2;
        self.twin[g as usize + 2] = f + 1;
        for (vertex, e) in [(a, f), (vd, g), (b, g + 1), (vc, f + 2)] {
            self.leaving[vertex as usize] = e;
        }
        true
    }

    /// Whether the edge of `h` meets Delaunay's condition: its two opposite angles sum to at most pi.
    pub fn is_delaunay(&self, h: u32) -> bool {
        let t = self.twin[h as usize];
        if t == NONE || self.locked[h as usize] {
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
    /// `may_flip(self, h)` can forbid it; `length(a, b, l)` gives the new edge's length, `l` being what the flip found.
    pub fn legalize(
        &mut self,
        stack: &mut Vec<u32>,
        may_flip: impl Fn(&Self, u32) -> bool,
        length: impl Fn(u32, u32, f64) -> f64,
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
                let new = length(self.origin[f as usize + 1], self.target(f + 1), self.length[f as usize + 1]);
                self.length[f as usize + 1] = new;
                self.length[g as usize + 2] = new;
                stack.extend([f, f + 2, g, g + 1]);
            }
        }
    }

    /// Splits a half-edge's edge at a share of its length; returns the new vertex.
    pub fn split_edge(&mut self, h: u32, share: f64) -> u32 {
        let m = self.leaving.len() as u32;
        self.leaving.push(NONE);
        let t = self.twin[h as usize];
        let whole = self.length[h as usize];
        let locked = self.locked[h as usize];
        let near = self.split_side(h, share, m);
        let (am, mb) = (h, near);
        for (e, part) in [(am, share), (mb, 1.0 - share)] {
            self.length[e as usize] = whole * part;
            self.locked[e as usize] = locked;
        }
        self.leaving[m as usize] = mb;
        if t == NONE {
            self.twin[am as usize] = NONE;
            self.twin[mb as usize] = NONE;
        } else {
            let ma = self.split_side(t, 1.0 - share, m);
            for (e, part) in [(t, 1.0 - share), (ma, share)] {
                self.length[e as usize] = whole * part;
                self.locked[e as usize] = locked;
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
        let outer = (self.twin[bc as usize], l(self, bc), self.locked[bc as usize]);
        // The old face becomes (a, m, c); the new one is (m, b, c).
        let new = self.push_face([m, vb, vc]);
        self.origin[bc as usize] = m;
        self.locked[bc as usize] = false;
        self.set_corner(ca, cb, c_middle);
        self.set_corner(bc, at_m, PI);
        self.set_corner(new, 0.0, at_m);
        self.set_corner(new + 1, b_corner.0, b_corner.1);
        self.set_corner(new + 2, c_middle, ce);
        self.length[bc as usize] = mc;
        self.glue(bc, new + 2);
        self.length[new as usize + 1] = outer.1;
        self.locked[new as usize + 1] = outer.2;
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
        let outer = h.map(|e| (self.twin[e as usize], self.length[e as usize], self.locked[e as usize]));
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
            self.locked[e as usize] = outer[k].2;
            self.glue(e, outer[k].0);
            self.length[e as usize + 1] = lengths[n];
            self.length[e as usize + 2] = lengths[k];
            self.locked[e as usize + 1] = false;
            self.locked[e as usize + 2] = false;
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
pub(super) mod tests {
    use super::*;
    use std::collections::BTreeMap;
    use std::f64::consts::TAU;

    /// A triangulation of points in the plane, its directions those of the plane.
    pub fn plane(points: &[[f64; 2]], triangles: &[[u32; 3]]) -> Intrinsic {
        let mut faces = Intrinsic { leaving: vec![NONE; points.len()], ..Intrinsic::default() };
        let way = |a: u32, b: u32| {
            let ([ax, ay], [bx, by]) = (points[a as usize], points[b as usize]);
            [bx - ax, by - ay]
        };
        let mut at: BTreeMap<(u32, u32), u32> = BTreeMap::new();
        for &[a, b, c] in triangles {
            let h = faces.push_face([a, b, c]);
            for (e, [v, w, u]) in (h..).zip([[a, b, c], [b, c, a], [c, a, b]]) {
                let [first, last] = [way(v, w), way(v, u)];
                let begin = first[1].atan2(first[0]);
                let width = (last[1].atan2(last[0]) - begin).rem_euclid(TAU);
                faces.length[e as usize] = first[0].hypot(first[1]);
                faces.set_corner(e, begin, begin + width);
                faces.leaving[v as usize] = e;
                at.insert((v, w), e);
            }
        }
        for (&(v, w), &h) in &at {
            match at.get(&(w, v)) {
                Some(&twin) => faces.twin[h as usize] = twin,
                None => faces.locked[h as usize] = true,
            }
        }
        faces
    }

    /// `n` by `n` cells, inner points pushed about.
    pub fn patch(n: usize) -> (Intrinsic, Vec<[f64; 2]>) {
        let at = |i: usize, j: usize| (j * (n + 1) + i) as u32;
        let mut points = Vec::new();
        let mut triangles = Vec::new();
        for j in 0..=n {
            for i in 0..=n {
                let inner = (1..n).contains(&i) && (1..n).contains(&j);
                let push = |seed: usize| if inner { (seed * 7919 % 101) as f64 / 101.0 * 0.6 - 0.3 } else { 0.0 };
                points.push([i as f64 + push(17 * i + j + 1), j as f64 + push(31 * j + 5 * i + 2)]);
            }
        }
        for j in 0..n {
            for i in 0..n {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
        (plane(&points, &triangles), points)
    }

    pub fn area(faces: &Intrinsic) -> f64 {
        (0..faces.face_count() as u32)
            .filter(|&f| faces.is_alive(f))
            .map(|f| {
                let [a, b, _] = [0, 1, 2].map(|k| faces.length[(3 * f + k) as usize]);
                a * b * faces.corner(3 * f + 1).sin() / 2.0
            })
            .sum()
    }

    /// Vertices, edges and faces that are there.
    pub fn euler(faces: &Intrinsic) -> i64 {
        let alive = (0..faces.origin.len()).filter(|&h| faces.is_alive(h as u32 / 3));
        let (mut sides, mut open) = (0, 0);
        for h in alive {
            sides += 1;
            open += i64::from(faces.twin[h] == NONE);
        }
        let vertices = faces.leaving.iter().filter(|&&h| h != NONE).count() as i64;
        vertices - (sides + open) / 2 + sides / 3
    }

    /// What is wrong with the connectivity, the lengths or, inside, the directions.
    pub fn faults(faces: &Intrinsic) -> Vec<String> {
        let mut faults = Vec::new();
        let mut ends = BTreeMap::new();
        for h in (0..faces.origin.len() as u32).filter(|&h| faces.is_alive(h / 3)) {
            let twin = faces.twin[h as usize];
            if ends.insert((faces.origin[h as usize], faces.target(h)), h).is_some() {
                faults.push(format!("half-edge {h} is not the only one between its ends"));
            }
            if twin != NONE {
                let mirrored = faces.twin[twin as usize] == h
                    && faces.is_alive(twin / 3)
                    && faces.origin[twin as usize] == faces.target(h)
                    && faces.target(twin) == faces.origin[h as usize]
                    && faces.locked[twin as usize] == faces.locked[h as usize];
                if !mirrored || (faces.length[h as usize] - faces.length[twin as usize]).abs() > 1e-12 {
                    faults.push(format!("half-edges {h} and {twin} are no twins"));
                }
            }
            let around: f64 = [h, next(h), previous(h)].iter().map(|&e| faces.corner(e)).sum();
            if (around - PI).abs() > 1e-6 {
                faults.push(format!("the face of {h} does not close: {around}"));
            }
        }
        if !faults.is_empty() {
            // Where twins are wrong, walking round a vertex need not end.
            return faults;
        }
        let mut ring = Vec::new();
        for v in 0..faces.leaving.len() as u32 {
            let h = faces.leaving[v as usize];
            if h == NONE {
                continue;
            }
            if !faces.is_alive(h / 3) || faces.origin[h as usize] != v {
                faults.push(format!("vertex {v} has lost its half-edge"));
                continue;
            }
            let closed = faces.ring(v, &mut ring);
            let widths: f64 = ring.iter().map(|&h| faces.width(h)).sum();
            if closed && (widths - TAU).abs() > 1e-9 {
                faults.push(format!("the directions at vertex {v} span {widths}"));
            }
            if ring.iter().any(|&h| faces.origin[h as usize] != v) {
                faults.push(format!("the ring of vertex {v} leaves it"));
            }
            let first = usize::from(!closed);
            for i in first..ring.len() {
                let before = ring[(i + ring.len() - 1) % ring.len()];
                if faces.locked[ring[i] as usize] {
                    // Each side of a feature counts its directions from the feature.
                    continue;
                }
                let gap = faces.begin[ring[i] as usize] - faces.end[before as usize];
                if (gap - (gap / TAU).round() * TAU).abs() > 1e-9 {
                    faults.push(format!("a gap of {gap} in the directions at vertex {v}"));
                }
            }
        }
        faults
    }

    /// On a plane, the largest error of lengths and directions against the points.
    pub fn against_plane(faces: &Intrinsic, points: &[[f64; 2]]) -> f64 {
        let mut worst = 0.0f64;
        for h in (0..faces.origin.len() as u32).filter(|&h| faces.is_alive(h / 3)) {
            let [[ax, ay], [bx, by]] = [faces.origin[h as usize], faces.target(h)].map(|v| points[v as usize]);
            let off = faces.begin[h as usize] - (by - ay).atan2(bx - ax);
            worst = worst.max((off - (off / TAU).round() * TAU).abs());
            worst = worst.max((faces.length[h as usize] - (bx - ax).hypot(by - ay)).abs());
        }
        worst
    }

    fn none() -> Vec<String> {
        Vec::new()
    }

    #[test]
    fn the_faults_of_a_triangulation_are_seen() {
        let (whole, points) = patch(5);
        assert_eq!(faults(&whole), none());
        assert!(against_plane(&whole, &points) < 1e-12);
        // Leaves the first inner point of the second row.
        let inner = whole.leaving[7] as usize;
        let changes: [fn(&mut Intrinsic, usize); 4] = [
            |f, h| f.length[h] *= 1.01,
            |f, h| f.end[h] += 0.01,
            |f, h| f.twin[h] = f.twin[h + 2],
            |f, h| f.origin[h] += 1,
        ];
        for (i, change) in changes.into_iter().enumerate() {
            let mut broken = whole.clone();
            change(&mut broken, inner);
            assert_ne!(faults(&broken), none(), "change {i}");
        }
        let mut turned = whole.clone();
        turned.begin.iter_mut().for_each(|b| *b += 0.01);
        assert!(against_plane(&turned, &points) > 0.009);
    }

    #[test]
    fn flipped_twice_an_edge_is_what_it_was() {
        let (mut faces, points) = patch(6);
        let state = |faces: &Intrinsic| -> BTreeMap<(u32, u32), [f64; 2]> {
            (0..faces.origin.len() as u32)
                .map(|h| {
                    let turn = (faces.end[h as usize].sin(), faces.begin[h as usize].sin());
                    ((faces.origin[h as usize], faces.target(h)), [faces.length[h as usize], turn.0 + 2.0 * turn.1])
                })
                .collect()
        };
        let before = state(&faces);
        let mut flipped = 0;
        for h in 0..faces.origin.len() as u32 {
            let ends = [faces.origin[h as usize], faces.target(h)];
            if !faces.flip(h) {
                continue;
            }
            flipped += 1;
            let new = h / 3 * 3 + 1;
            assert_ne!(state(&faces).keys().collect::<Vec<_>>(), before.keys().collect::<Vec<_>>());
            assert_eq!(faults(&faces), none());
            assert!(against_plane(&faces, &points) < 1e-9, "the other diagonal of a flat quad");
            assert!(!faces.joined(ends[0], ends[1]));
            assert!(faces.flip(new), "back");
            let after = state(&faces);
            for (key, was) in &before {
                let is = after.get(key).unwrap_or_else(|| panic!("edge {key:?} is gone"));
                assert!((is[0] - was[0]).abs() < 1e-9 && (is[1] - was[1]).abs() < 1e-9, "{key:?}: {is:?}, not {was:?}");
            }
        }
        assert!(flipped > 50, "{flipped}");
    }

    #[test]
    fn what_cannot_be_flipped_stays() {
        // A quad with a reflex corner at 1, and the boundary.
        let points = [[0.0, 0.0], [1.0, 0.0], [2.0, 1.0], [2.0, -1.0]];
        let mut faces = plane(&points, &[[0, 1, 2], [1, 0, 3]]);
        assert!((0..6).all(|h| !faces.flip(h)));
        assert_eq!(faults(&faces), none());
        let points = [[0.0, 0.0], [3.0, 0.0], [2.0, 1.0], [2.0, -1.0]];
        let mut convex = plane(&points, &[[0, 1, 2], [1, 0, 3]]);
        convex.locked[0] = true;
        assert!(!convex.flip(0), "a feature");
        convex.locked[0] = false;
        assert!(convex.flip(0));
    }

    #[test]
    fn splits_keep_area_angles_and_places() {
        let (mut faces, mut points) = patch(6);
        let whole = area(&faces);
        assert!((whole - 36.0).abs() < 1e-9);
        for i in 0..60u32 {
            let h = (i * 37) % faces.origin.len() as u32;
            if i % 2 == 0 {
                // Only features are split: each side of one counts its directions from it.
                faces.locked[h as usize] = true;
                if faces.twin[h as usize] != NONE {
                    let twin = faces.twin[h as usize];
                    faces.locked[twin as usize] = true;
                }
                let share = 0.2 + 0.01 * f64::from(i);
                let [[ax, ay], [bx, by]] = [faces.origin[h as usize], faces.target(h)].map(|v| points[v as usize]);
                assert_eq!(faces.split_edge(h, share) as usize, points.len());
                points.push([ax + (bx - ax) * share, ay + (by - ay) * share]);
            } else {
                let corners = [0, 1, 2].map(|k| points[faces.origin[(h / 3 * 3 + k) as usize] as usize]);
                let point = [0, 1].map(|x| 0.5 * corners[0][x] + 0.3 * corners[1][x] + 0.2 * corners[2][x]);
                let ways = corners.map(|[x, y]| [x - point[0], y - point[1]]);
                let vertex = faces.split_face(h / 3, ways.map(|[x, y]| x.hypot(y)), ways.map(|[x, y]| y.atan2(x)));
                assert_eq!(vertex as usize, points.len());
                points.push(point);
            }
            assert_eq!(faults(&faces), none(), "split {i}");
            assert!((area(&faces) - whole).abs() < 1e-9, "split {i}");
            assert_eq!(euler(&faces), 1, "split {i}");
        }
        let mut closed = 0;
        let mut ring = Vec::new();
        for v in 0..faces.leaving.len() as u32 {
            if faces.ring(v, &mut ring) {
                let spread: f64 = ring.iter().map(|&h| faces.corner(h)).sum();
                assert!((spread - TAU).abs() < 1e-7, "vertex {v}: {spread}");
                closed += 1;
            }
        }
        assert!(closed > 70, "{closed}");
        let misplaced = faces.split_face(0, [0.1, 2.0, 2.0], [0.0, 2.0, 4.0]);
        assert!((area(&faces) - whole).abs() > 1e-3, "lengths that do not fit vertex {misplaced} are seen");
    }

    #[test]
    fn legalized_all_edges_are_delaunay() {
        let (mut faces, points) = patch(12);
        let broken = |faces: &Intrinsic| (0..faces.origin.len() as u32).filter(|&h| !faces.is_delaunay(h)).count();
        assert!(broken(&faces) > 20, "the patch is not Delaunay as it is made");
        let mut stack = (0..faces.origin.len() as u32).collect();
        faces.legalize(&mut stack, |_, _| true, |_, _, length| length);
        assert_eq!(broken(&faces), 0);
        assert_eq!(faults(&faces), none());
        assert!(against_plane(&faces, &points) < 1e-7, "flips in the plane are exact");
        assert!((area(&faces) - 144.0).abs() < 1e-7);
        // No point lies in the circle round a face.
        for f in 0..faces.face_count() as u32 {
            let [[ax, ay], [bx, by], [cx, cy]] = [0, 1, 2].map(|k| points[faces.origin[(3 * f + k) as usize] as usize]);
            let d = 2.0 * (ax * (by - cy) + bx * (cy - ay) + cx * (ay - by));
            let square = |x: f64, y: f64| x * x + y * y;
            let (a, b, c) = (square(ax, ay), square(bx, by), square(cx, cy));
            let centre = [
                (a * (by - cy) + b * (cy - ay) + c * (ay - by)) / d,
                (a * (cx - bx) + b * (ax - cx) + c * (bx - ax)) / d,
            ];
            let radius = (ax - centre[0]).hypot(ay - centre[1]);
            assert!(points.iter().all(|p| (p[0] - centre[0]).hypot(p[1] - centre[1]) > radius - 1e-6), "face {f}");
        }
        let mut again = (0..faces.origin.len() as u32).collect();
        faces.legalize(&mut again, |_, _| panic!("nothing is left to flip"), |_, _, length| length);
    }
}
