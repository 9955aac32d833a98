//! Removal of vertices from an intrinsic triangulation.
//!
//! # Theory
//! Flips, which are exact, remove the edges of a vertex until three are left (on a feature two, and one on each side). Then
//! the vertex is collapsed into a neighbour, which is exact where the surface is flat. Where a flip would make a second edge
//! between two vertices, the vertex is collapsed with more edges, and the new lengths are estimated by unfolding its faces.

use super::{Intrinsic, angle, next, previous, third_side};
use crate::surface::NONE;
use std::f64::consts::{PI, TAU};

/// The faces round a vertex `v` that is to be collapsed into `x`: face `i` is `(v, w_i, w_i+1)`, `w_0 = x`.
struct Fan {
    /// Half-edges `v -> w_i`.
    spokes: Vec<u32>,
    /// `w_i`; on a boundary one more than spokes.
    around: Vec<u32>,
    /// Whether the faces go all the way round.
    closed: bool,
}

impl Intrinsic {
    /// Removes a vertex. A vertex on a feature (two feature edges) is collapsed into a neighbour on it.
    ///
    /// False where the topology of the surface needs the vertex: each collapse would make a double edge.
    pub fn remove(&mut self, vertex: u32, ring: &mut Vec<u32>) -> bool {
        loop {
            let closed = self.ring(vertex, ring);
            if closed && ring.len() <= 3 || !ring.iter().any(|&h| self.flip(h)) {
                break;
            }
        }
        let closed = self.ring(vertex, ring);
        let on_feature = !closed || ring.iter().any(|&h| self.is_feature(h));
        let mut candidates: Vec<u32> = if closed { ring.clone() } else { vec![ring[0]] };
        candidates.retain(|&h| !on_feature || self.is_feature(h));
        candidates.sort_by(|&g, &h| self.length[g as usize].total_cmp(&self.length[h as usize]).then(g.cmp(&h)));
        candidates.into_iter().any(|h| {
            let fan = self.fan(h, ring, closed);
            let fits = self.may_collapse(&fan);
            if fits {
                self.collapse(&fan);
            }
            fits
        })
    }

    /// As [`Self::remove`], for a vertex of the boundary that must go: faces that lie as no convex quad are flipped too.
    ///
    /// Round a vertex whose neighbourhood is a disc, this always succeeds where the boundary has more than three vertices. An edge
    /// across two spokes makes the flip of the spoke between them impossible. Two such edges would cross, so of three spokes or more one
    /// can be flipped. Of two, the edge across joins the vertex's neighbours on the boundary. It is flipped itself: no edge joins what
    /// it encloses with the rest.
    pub fn remove_from_boundary(&mut self, vertex: u32, ring: &mut Vec<u32>) -> bool {
        loop {
            if self.remove(vertex, ring) {
                return true;
            }
            if self.ring(vertex, ring) {
                return false;
            }
            if ring[1..].iter().any(|&h| self.flip_any(h)) {
                continue;
            }
            let [after, before] = [self.target(ring[0]), self.origin[previous(ring[ring.len() - 1]) as usize]];
            self.ring(after, ring);
            let across = ring.iter().copied().find(|&h| self.target(h) == before);
            if !across.is_some_and(|h| self.flip_any(h)) {
                return false;
            }
        }
    }

    fn fan(&self, h: u32, ring: &[u32], closed: bool) -> Fan {
        let start = ring.iter().position(|&e| e == h).unwrap_or(0);
        let spokes: Vec<u32> = (0..ring.len()).map(|i| ring[(start + i) % ring.len()]).collect();
        let mut around: Vec<u32> = spokes.iter().map(|&e| self.target(e)).collect();
        if !closed {
            around.push(self.origin[previous(spokes[spokes.len() - 1]) as usize]);
        }
        Fan { spokes, around, closed }
    }

    /// The link condition: `v` and `x` have only the corners opposite their edge in common.
    fn may_collapse(&self, fan: &Fan) -> bool {
        let x = fan.around[0];
        let count = fan.spokes.len();
        let (c, d) = (fan.around[1], fan.around[fan.around.len() - 1]);
        let v = self.origin[fan.spokes[0] as usize];
        let mut shared = 0;
        self.visit_neighbours(x, |w| shared += usize::from(w != v && fan.around.contains(&w)));
        if fan.closed {
            if c == d || shared != 2 || count < 3 || (self.on_boundary(v) && self.on_boundary(x)) {
                return false;
            }
            // Of three faces one stays: there must be no face on its far side with the same vertices.
            let far = self.twin[next(fan.spokes[1]) as usize];
            count > 3 || far == NONE || self.origin[previous(far) as usize] != x
        } else {
            // A single triangle stays.
            shared == 1 && (count > 1 || self.twin[next(fan.spokes[0]) as usize] != NONE)
        }
    }

    fn on_boundary(&self, vertex: u32) -> bool {
        let start = self.leaving[vertex as usize];
        let mut h = start;
        loop {
            h = self.twin[previous(h) as usize];
            if h == NONE || h == start {
                return h == NONE;
            }
        }
    }

    /// The direction, at `v`, of each neighbour from `x` on, scaled so that a turn is 2 pi and a feature is straight.
    fn places(&self, fan: &Fan) -> Vec<f64> {
        let feature = if fan.closed {
            (1..fan.spokes.len()).find(|&i| self.is_feature(fan.spokes[i]))
        } else {
            Some(fan.spokes.len())
        };
        let spans = match feature {
            Some(at) => vec![(0..at, PI), (at..fan.spokes.len(), PI)],
            None => vec![(0..fan.spokes.len(), TAU)],
        };
        let mut places = vec![0.0];
        for (span, whole) in spans {
            let angles: Vec<f64> = span.map(|i| self.corner(fan.spokes[i])).collect();
            let total: f64 = angles.iter().sum::<f64>().max(f64::MIN_POSITIVE);
            let begin = places[places.len() - 1];
            let mut passed = 0.0;
            for a in angles {
                passed += a;
                places.push(begin + whole * passed / total);
            }
        }
        places
    }

    /// Collapses `v` into `x`: the faces round `v` become faces round `x`, and the one or two with both are removed.
    fn collapse(&mut self, fan: &Fan) {
        let Fan { spokes, around, closed } = fan;
        let (x, count) = (around[0], spokes.len());
        let v = self.origin[spokes[0] as usize];
        let stay = if *closed { 1..count - 1 } else { 1..count };
        let places = self.places(fan);
        let to_v: Vec<f64> = (0..around.len())
            .map(|i| {
                if i < count { self.length[spokes[i] as usize] } else { self.length[previous(spokes[i - 1]) as usize] }
            })
            .collect();
        let mut to_x: Vec<f64> = (0..around.len()).map(|i| third_side(to_v[0], to_v[i], places[i])).collect();
        to_x[1] = self.length[next(spokes[0]) as usize];
        if *closed {
            to_x[count - 1] = self.length[next(spokes[count - 1]) as usize];
        }

        self.turn_towards(fan, &places, &to_v, &to_x);
        self.share_directions(fan, &to_x);
        let near = self.side_beyond(next(spokes[0]), spokes[1 % count]);
        let far = closed.then(|| self.side_beyond(next(spokes[count - 1]), spokes[count - 1]));
        self.widen_at_opposites(fan, near.0, far.map(|f| f.0));

        for i in stay.clone() {
            let e = spokes[i] as usize;
            self.origin[e] = x;
            self.length[e] = to_x[i];
            self.length[previous(spokes[i]) as usize] = to_x[(i + 1) % around.len()];
            self.leaving[around[i] as usize] = next(spokes[i]);
            self.leaving[around[(i + 1) % around.len()] as usize] = previous(spokes[i]);
            self.leaving[x as usize] = spokes[i];
        }
        if stay.is_empty() {
            // A single face on the boundary: the edge across it becomes the boundary.
            self.twin[near.0 as usize] = NONE;
            self.curve[near.0 as usize] = self.curve[spokes[0] as usize];
            self.leaving[x as usize] = next(near.0);
            self.leaving[around[1] as usize] = near.0;
        } else {
            self.join(spokes[1], near);
            if let Some(far) = far {
                self.join(previous(spokes[count - 2]), far);
            }
        }
        for e in [Some(spokes[0]), closed.then(|| spokes[count - 1])].into_iter().flatten() {
            for k in 0..3 {
                self.origin[(e / 3 * 3 + k) as usize] = NONE;
            }
        }
        self.leaving[v as usize] = NONE;
    }

    /// The half-edge across a side that will coincide with a spoke, and the curve of either.
    fn side_beyond(&self, side: u32, spoke: u32) -> (u32, u32) {
        let curve = [side, spoke].map(|h| self.curve[h as usize]).into_iter().find(|&curve| curve != NONE);
        (self.twin[side as usize], curve.unwrap_or(NONE))
    }

    fn join(&mut self, inner: u32, (outer, curve): (u32, u32)) {
        self.glue(inner, outer);
        self.curve[inner as usize] = curve;
        if outer != NONE {
            self.curve[outer as usize] = curve;
        }
    }

    /// Sets the directions of the edges to `x` at the neighbours whose edges to `v` they replace.
    fn turn_towards(&mut self, fan: &Fan, places: &[f64], to_v: &[f64], to_x: &[f64]) {
        let last = if fan.closed { fan.spokes.len() - 1 } else { fan.spokes.len() };
        for i in 2..last {
            if self.is_feature(fan.spokes[i]) {
                continue;
            }
            let turn = angle(to_v[i], to_x[i], to_v[0]) * if places[i] <= PI { 1.0 } else { -1.0 };
            let (before, after) = (next(fan.spokes[i]), previous(fan.spokes[i - 1]));
            let turn = turn.max(-0.9 * self.width(before)).min(0.9 * self.width(after));
            self.end[before as usize] += turn;
            self.begin[after as usize] += turn;
        }
    }

    /// At `x`, distributes the directions of the removed corners over the new faces, by their angles.
    fn share_directions(&mut self, fan: &Fan, to_x: &[f64]) {
        let Fan { spokes, around, closed } = fan;
        let count = spokes.len();
        let left = next(spokes[0]);
        let left = (self.begin[left as usize], self.width(left));
        let stay = if *closed { 1..count - 1 } else { 1..count };
        let fill = |s: &mut Self, span: std::ops::Range<usize>, begin: f64, width: f64| {
            // A face whose estimated lengths do not close gets a small angle.
            let angles: Vec<f64> = span
                .clone()
                .map(|i| angle(to_x[i], to_x[(i + 1) % around.len()], s.length[next(spokes[i]) as usize]).max(1e-9))
                .collect();
            let total: f64 = angles.iter().sum::<f64>().max(f64::MIN_POSITIVE);
            let mut at = begin;
            for (i, angle) in span.zip(angles) {
                s.begin[spokes[i] as usize] = at;
                at += width * angle / total;
                s.end[spokes[i] as usize] = at;
            }
        };
        if !closed {
            return fill(self, stay, left.0, left.1);
        }
        let right = previous(spokes[count - 1]);
        let right = (self.begin[right as usize], self.width(right));
        match (1..count).find(|&i| self.is_feature(spokes[i])) {
            Some(feature) => {
                fill(self, stay.start..feature.min(stay.end), left.0, left.1);
                fill(self, feature..stay.end.max(feature), right.0, right.1);
                // A feature may move to an edge of `x` that was none; then one side of it has no face.
                let (near, far) = (self.twin[next(spokes[0]) as usize], self.twin[next(spokes[count - 1]) as usize]);
                if feature == 1 && near != NONE {
                    self.end[next(near) as usize] += left.1;
                }
                if feature == count - 1 && far != NONE {
                    self.begin[far as usize] -= right.1;
                }
            }
            None => fill(self, stay, left.0, left.1 + right.1),
        }
    }

    /// At the two corners opposite the edge `v x`, a kept face gets the directions of the removed one.
    fn widen_at_opposites(&mut self, fan: &Fan, near: u32, far: Option<u32>) {
        let spokes = &fan.spokes;
        let count = spokes.len();
        let width = self.width(previous(spokes[0]));
        if count > 1 && !self.is_feature(spokes[1]) {
            self.end[next(spokes[1]) as usize] += width;
        } else if near != NONE {
            self.begin[near as usize] -= width;
        }
        if let Some(far) = far {
            let width = self.width(next(spokes[count - 1]));
            if !self.is_feature(spokes[count - 1]) {
                self.begin[previous(spokes[count - 2]) as usize] -= width;
            } else if far != NONE {
                self.end[next(far) as usize] += width;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{against_plane, area, euler, faults, patch, plane};
    use super::*;

    /// A closed surface of unit edges: connectivity alone matters here.
    fn closed(triangles: &[[u32; 3]]) -> Intrinsic {
        let vertices = triangles.iter().flatten().max().map_or(0, |v| v + 1);
        let mut faces = Intrinsic { leaving: vec![NONE; vertices as usize], ..Intrinsic::default() };
        for &triangle in triangles {
            let h = faces.push_face(triangle);
            (0..3).for_each(|k| faces.leaving[triangle[k] as usize] = h + k as u32);
        }
        faces.length.fill(1.0);
        for g in 0..faces.origin.len() as u32 {
            let twin = (0..faces.origin.len() as u32)
                .find(|&h| faces.origin[h as usize] == faces.target(g) && faces.target(h) == faces.origin[g as usize]);
            faces.twin[g as usize] = twin.unwrap_or(NONE);
        }
        let mut ring = Vec::new();
        for v in 0..vertices {
            faces.ring(v, &mut ring);
            for (i, &h) in ring.iter().enumerate() {
                let part = TAU / ring.len() as f64;
                (faces.begin[h as usize], faces.end[h as usize]) = (part * i as f64, part * (i + 1) as f64);
            }
        }
        faces
    }

    const TETRAHEDRON: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

    fn none() -> Vec<String> {
        Vec::new()
    }

    #[test]
    fn on_a_flat_patch_inner_vertices_go_without_a_trace() {
        let n = 8u32;
        let (mut faces, points) = patch(n as usize);
        let mut ring = Vec::new();
        let mut inner: Vec<u32> = (0..(n + 1) * (n + 1))
            .filter(|v| (1..n).contains(&(v % (n + 1))) && (1..n).contains(&(v / (n + 1))))
            .collect();
        // Not in their order.
        inner.sort_by_key(|v| v * 7919 % 1009);
        for (count, &v) in inner.iter().enumerate() {
            assert!(faces.remove(v, &mut ring), "vertex {v}, the {count}th");
            assert_eq!(faces.leaving[v as usize], NONE);
            assert!(faces.origin.iter().all(|&o| o != v));
            assert_eq!(faults(&faces), none(), "after vertex {v}, the {count}th");
            assert!((area(&faces) - 64.0).abs() < 1e-6, "after vertex {v}, the {count}th: {}", area(&faces));
            assert_eq!(euler(&faces), 1, "after vertex {v}, the {count}th");
            assert!(against_plane(&faces, &points) < 1e-6, "after vertex {v}: {}", against_plane(&faces, &points));
        }
        let left = faces.leaving.iter().filter(|&&h| h != NONE).count() as u32;
        assert_eq!(left, 4 * n, "the boundary's vertices");
    }

    #[test]
    fn on_a_straight_side_vertices_go_and_on_a_corner_the_area_shrinks() {
        let n = 4u32;
        let (mut faces, points) = patch(n as usize);
        let mut ring = Vec::new();
        for v in 1..n {
            assert!(faces.remove(v, &mut ring), "vertex {v}");
            assert_eq!(faults(&faces), none(), "after vertex {v}");
            assert!((area(&faces) - 16.0).abs() < 1e-6, "after vertex {v}: {}", area(&faces));
            assert_eq!(euler(&faces), 1);
            assert!(against_plane(&faces, &points) < 1e-6);
        }
        assert!(faces.joined(0, n), "the side is one edge");
        // A corner that is taken out is straightened.
        assert!(faces.remove(0, &mut ring));
        assert_eq!(euler(&faces), 1);
        assert!((area(&faces) - 16.0).abs() > 0.1);
    }

    /// Faces at the boundary edge `0 1`, whose middle is vertex 2. The inner vertices are 3, at a given point, and 4.
    fn pocket(at: [f64; 2]) -> Intrinsic {
        // The edge 1-4 is across the spoke from 2 to 3.
        let points = [[-1.0, 0.0], [1.0, 0.0], [0.0, 0.0], at, [0.0, 1.0], [0.0, 2.0]];
        let triangles = [[2, 1, 3], [2, 3, 4], [2, 4, 0], [3, 1, 4], [1, 5, 4], [5, 0, 4]];
        plane(&points, &triangles)
    }

    #[test]
    fn a_vertex_of_the_boundary_goes_where_faces_have_no_area() {
        let mut ring = Vec::new();
        // A vertex on the edge 2-1: no flip at 2 is convex, and the edge 1-4 forbids each collapse that is tried.
        let mut faces = pocket([0.5, 0.0]);
        assert!(!faces.remove(2, &mut ring));
        assert!(faces.remove_from_boundary(2, &mut ring));
        assert!(faces.joined(0, 1) && euler(&faces) == 1);
        let broken: Vec<String> = faults(&faces).into_iter().filter(|fault| fault.contains("half-edge")).collect();
        assert_eq!(broken, none());
        // The partner: farther in, flips do.
        assert!(pocket([0.5, 0.3]).remove(2, &mut ring));
    }

    #[test]
    fn a_vertex_of_the_boundary_goes_from_behind_an_edge_across() {
        // The edge 0-1 encloses vertices 2, on the boundary, and 3.
        let points = [[-1.0, 0.0], [1.0, 0.0], [0.0, -0.5], [0.0, -0.2], [0.0, 1.0]];
        let mut faces = plane(&points, &[[2, 1, 3], [2, 3, 0], [3, 1, 0], [0, 1, 4]]);
        let mut ring = Vec::new();
        assert!(!faces.remove(2, &mut ring));
        assert!(faces.remove_from_boundary(2, &mut ring));
        assert!(faces.joined(3, 4) && faces.joined(0, 1) && euler(&faces) == 1);
        // A boundary of three vertices keeps them.
        let mut least = plane(&points[..4], &[[2, 1, 3], [2, 3, 0], [3, 1, 0]]);
        assert!(!least.remove_from_boundary(2, &mut ring));
    }

    #[test]
    fn a_tetrahedron_is_the_least_sphere() {
        let mut least = closed(&TETRAHEDRON);
        let mut ring = Vec::new();
        assert_eq!(faults(&least), none());
        for v in 0..4 {
            assert!(!least.remove(v, &mut ring), "vertex {v} of a tetrahedron");
            assert_eq!((faults(&least), euler(&least)), (none(), 2));
        }
        // With a vertex in one of its faces, that one goes.
        let corner = least.split_face(0, [0.6; 3], [0.0, 2.0, 4.0]);
        assert!(least.remove(corner, &mut ring));
        assert_eq!((faults(&least), euler(&least)), (none(), 2));
    }

    #[test]
    fn a_sphere_goes_down_to_the_tetrahedron() {
        // An octahedron, each face split twice.
        let mut faces =
            closed(&[[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]]);
        for face in 0..8 {
            for _ in 0..2 {
                faces.split_face(face, [0.7; 3], [0.0, 2.0, 4.0]);
            }
        }
        let mut ring = Vec::new();
        let mut alive: Vec<u32> = (0..faces.leaving.len() as u32).collect();
        loop {
            let before = alive.len();
            alive.retain(|&v| {
                let gone = faces.remove(v, &mut ring);
                assert_eq!(euler(&faces), 2, "vertex {v}");
                // Connectivity alone: faces of so few vertices do not lie flat, and lengths are estimated.
                let broken: Vec<String> = faults(&faces).into_iter().filter(|f| f.contains("half-edge")).collect();
                assert_eq!(broken, none(), "vertex {v}");
                !gone
            });
            if alive.len() == before {
                break;
            }
        }
        assert_eq!(alive.len(), 4);
    }

    #[test]
    fn an_annulus_keeps_its_hole() {
        // Two rings of six, the inner one the hole.
        let triangles: Vec<[u32; 3]> = (0..6u32)
            .flat_map(|i| {
                let j = (i + 1) % 6;
                [[i, j, 6 + j], [i, 6 + j, 6 + i]]
            })
            .collect();
        let mut faces = closed(&triangles);
        for h in 0..faces.twin.len() {
            faces.curve[h] = if faces.twin[h] == NONE { 0 } else { NONE };
        }
        let mut ring = Vec::new();
        let mut gone = 0;
        for v in (0..12).chain(0..12).chain(0..12) {
            if faces.leaving[v as usize] != NONE {
                gone += usize::from(faces.remove(v, &mut ring));
                assert_eq!(euler(&faces), 0, "vertex {v}");
            }
        }
        assert_eq!(gone, 6, "three vertices are the least of each loop");
    }
}
