//! Moving on the surface: a displacement is laid in its triangle and unfolded across each edge that it crosses.
//!
//! The twin of `walk` in `shaders/relax.wgsl`: the same operations in the same order. A walk never jumps to the other
//! side of a thin part, as a closest-point projection does. At a feature it goes on along it.

use super::{NONE, Surface, next, previous};
use crate::geometry::{cross, dot, unit};
use glam::Vec3;

/// Edges that one walk may cross; a displacement over more small triangles than that ends early.
pub(crate) const WALK_EDGES: u32 = 256;

/// Where a walk has led.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Footing {
    pub triangle: u32,
    pub position: Vec3,
}

/// Walks from `position` in `triangle` by `displacement`, at most over `edges` edges.
///
/// `barrier(h)` tells whether half-edge `h` may not be crossed; boundary half-edges never are.
pub(crate) fn walk(
    surface: &Surface,
    barrier: impl Fn(u32) -> bool,
    triangle: u32,
    position: Vec3,
    displacement: Vec3,
    edges: u32,
) -> Footing {
    let mut t = triangle;
    let mut p = position;
    let mut heading = displacement;
    let mut left = 1.0f32;
    let mut entered = NONE;
    for _ in 0..edges {
        let corners = surface.corners(t as usize);
        let normal = unit(cross(corners[1] - corners[0], corners[2] - corners[0]));
        let step = heading * left;
        // The first edge that the rest of the way leaves the triangle by.
        let (mut exit, mut share) = (NONE, 1.0f32);
        for k in 0..3u32 {
            let h = 3 * t + k;
            if h == entered {
                continue;
            }
            let (a, b) = (corners[k as usize], corners[(k as usize + 1) % 3]);
            let inward = cross(normal, b - a);
            let speed = dot(inward, step);
            if speed < 0.0 {
                let reach = dot(inward, p - a).max(0.0) / (-speed);
                if reach < share {
                    share = reach;
                    exit = h;
                }
            }
        }
        p += step * share;
        if exit == NONE {
            return Footing { triangle: t, position: onto_plane(p, corners[0], normal) };
        }
        left *= 1.0 - share;
        let k = exit as usize % 3;
        let along = unit(corners[(k + 1) % 3] - corners[k]);
        let forward = dot(heading, along);
        let twin = surface.twins[exit as usize];
        if twin == NONE || barrier(exit) {
            heading = along * forward;
            entered = exit;
            continue;
        }
        let across = -dot(heading, cross(normal, along));
        t = twin / 3;
        entered = twin;
        let beyond = surface.corners(t as usize);
        let beyond_normal = unit(cross(beyond[1] - beyond[0], beyond[2] - beyond[0]));
        // Seen from the other side the edge runs backwards, so its inward normal is that of `-along`.
        heading = along * forward + cross(along, beyond_normal) * across;
    }
    let corners = surface.corners(t as usize);
    let normal = unit(cross(corners[1] - corners[0], corners[2] - corners[0]));
    Footing { triangle: t, position: onto_plane(p, corners[0], normal) }
}

fn onto_plane(p: Vec3, through: Vec3, normal: Vec3) -> Vec3 {
    p - normal * dot(normal, p - through)
}

/// The corner of the fan round a corner's vertex that follows it counter-clockwise; `None` past a barrier.
pub(crate) fn next_corner(surface: &Surface, barrier: impl Fn(u32) -> bool, corner: u32) -> Option<u32> {
    let edge = previous(corner);
    if barrier(edge) { None } else { surface.twin(edge) }
}

/// The corner that precedes it counter-clockwise; `None` past a barrier.
pub(crate) fn previous_corner(surface: &Surface, barrier: impl Fn(u32) -> bool, corner: u32) -> Option<u32> {
    if barrier(corner) { None } else { surface.twin(corner).map(next) }
}
