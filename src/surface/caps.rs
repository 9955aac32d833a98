//! Flips of caps: triangles without height, whose three corners lie on a line, as tessellators leave them beside fine curves.
//!
//! # Practice
//! A cap has no normal: it makes false creases and misleads walks. Its longest edge is flipped, which moves the surface by no
//! more than the cap's height. A cap whose longest edge is open stays.

use super::{Frame, NONE, Repairs, next, previous};
use glam::{DVec3, Vec3};

/// A triangle lower than this over its longest edge, in diagonals of the bounding box, is a cap: a few times what f32 resolves.
const LEAST_HEIGHT: f64 = 5e-7;
/// Rounds over all triangles: flipping one cap can make another of its neighbour.
const ROUNDS: usize = 20;

/// Flips the longest edges of caps; `seams` are half-edges that stay, sorted.
pub(super) fn flip(
    points: &[Vec3],
    triangles: &mut [[u32; 3]],
    twins: &mut [u32],
    seams: &[u32],
    frame: &Frame,
    repairs: &mut Repairs,
) {
    let mut caps: Vec<u32> =
        (0..triangles.len() as u32).filter(|&t| is_cap(places(points, triangles[t as usize]))).collect();
    let mut corners = Corners { points, triangles, twins };
    for _ in 0..ROUNDS {
        let before = caps.len();
        caps.retain(|&t| {
            let flipped = corners.flip_cap(t, seams);
            if flipped {
                let apex = corners.triangles[t as usize][0];
                repairs.flipped_caps.note(|| frame.near(points[apex as usize].as_dvec3().into()));
            }
            !flipped
        });
        if caps.is_empty() || caps.len() == before {
            break;
        }
    }
}

/// Whether the three corners lie on a line.
pub(super) fn is_cap(corners: [DVec3; 3]) -> bool {
    height(corners).0 < LEAST_HEIGHT
}

/// The height of a triangle over its longest edge, and which edge that is.
fn height(p: [DVec3; 3]) -> (f64, usize) {
    let squared = |k: usize| p[k].distance_squared(p[(k + 1) % 3]);
    let longest = (0..3).fold(0, |l, k| if squared(k) > squared(l) { k } else { l });
    let double_area = (p[1] - p[0]).cross(p[2] - p[0]).length();
    (double_area / squared(longest).sqrt().max(f64::MIN_POSITIVE), longest)
}

fn places(points: &[Vec3], triangle: [u32; 3]) -> [DVec3; 3] {
    triangle.map(|v| points[v as usize].as_dvec3())
}

struct Corners<'a> {
    points: &'a [Vec3],
    triangles: &'a mut [[u32; 3]],
    twins: &'a mut [u32],
}

impl Corners<'_> {
    fn origin(&self, half_edge: u32) -> u32 {
        self.triangles[half_edge as usize / 3][half_edge as usize % 3]
    }

    /// Flips the longest edge where that makes the two triangles higher; returns whether it did.
    fn flip_cap(&mut self, triangle: u32, seams: &[u32]) -> bool {
        let (low, longest) = height(places(self.points, self.triangles[triangle as usize]));
        let h = 3 * triangle + longest as u32;
        let g = self.twins[h as usize];
        if low >= LEAST_HEIGHT || g == NONE {
            return low >= LEAST_HEIGHT;
        }
        let other = g / 3;
        let around = [h, next(h), previous(h), g, next(g), previous(g)];
        if around.iter().any(|edge| seams.binary_search(edge).is_ok()) {
            return false;
        }
        let [a, b, p, q] = [self.origin(h), self.origin(g), self.origin(previous(h)), self.origin(previous(g))];
        // The foot of the apex has to lie inside the edge: a needle's does not.
        let [pa, pb, pp] = [a, b, p].map(|v| self.points[v as usize].as_dvec3());
        if (pa - pp).dot(pb - pp) >= 0.0 || p == q || self.joined(p, q, previous(h)) {
            return false;
        }
        let others = height(places(self.points, self.triangles[other as usize])).0;
        let halves = [[p, a, q], [q, b, p]];
        let least = halves.map(|half| height(places(self.points, half)).0).into_iter().fold(f64::INFINITY, f64::min);
        // Both new triangles must face the way the other one did.
        let facing = |t: [u32; 3]| {
            let [x, y, z] = places(self.points, t);
            (y - x).cross(z - x)
        };
        let normal: DVec3 = facing(self.triangles[other as usize]);
        if least <= low.min(others) || halves.iter().any(|&half| facing(half).dot(normal) <= 0.0) {
            return false;
        }
        let outer = [previous(h), next(g), previous(g), next(h)].map(|edge| self.twins[edge as usize]);
        self.triangles[triangle as usize] = halves[0];
        self.triangles[other as usize] = halves[1];
        let inner = [3 * triangle + 2, 3 * other + 2];
        let places = [3 * triangle, 3 * triangle + 1, 3 * other, 3 * other + 1];
        for (place, twin) in places.into_iter().zip(outer) {
            self.twins[place as usize] = twin;
            if twin != NONE {
                self.twins[twin as usize] = place;
            }
        }
        self.twins[inner[0] as usize] = inner[1];
        self.twins[inner[1] as usize] = inner[0];
        true
    }

    /// Whether an edge joins two vertices; `corner` leaves the first.
    fn joined(&self, v: u32, w: u32, corner: u32) -> bool {
        debug_assert_eq!(self.origin(corner), v);
        let meets = |h: u32| self.origin(next(h)) == w || self.origin(previous(h)) == w;
        let mut at = corner;
        loop {
            if meets(at) {
                return true;
            }
            at = self.twins[previous(at) as usize];
            if at == corner {
                return false;
            }
            if at == NONE {
                break;
            }
        }
        let mut at = corner;
        loop {
            let twin = self.twins[at as usize];
            if twin == NONE {
                return false;
            }
            at = next(twin);
            if meets(at) {
                return true;
            }
        }
    }
}
