//! Relaxation: tiles push and pull each other into rows.
//!
//! # Theory
//! Two tiles, with the mean of their crosses as axes, see each other at a place `u`, in tile sides. The second belongs at the
//! nearest lattice point, `k`: each moves by a share of `u - k`. That is antisymmetric, and orders random tiles. Two tiles that
//! overlap (`k = 0`) push apart along the longer axis: the Manhattan repulsion of the mosaics that the paper builds on.
//!
//! # Practice
//! Where the surface bends between two tiles, the chord between them is lengthened to the arc that it spans. A tile looks at
//! its neighbour list alone.

use super::neighbours;
use crate::compute::{LIST_STEPS, MOST_EDGES, REACH, Relaxation, RelaxationSurface, Tile};
use crate::geometry::{axis_at, barycentric, cross, dot, unit};
use crate::surface::{NONE, Walkable, walk_on};
use glam::Vec3;
use rayon::prelude::*;

/// The least cosine between the normals of tiles that see each other.
pub const LEAST_COSINE: f32 = 0.2;
/// Tiles farther off each other's plane than this, in tile sides, lie on different sheets.
pub const SHEET: f32 = 0.6;
/// The share of the way to its lattice point that a tile moves in a step.
pub const STEP: f32 = 0.7;
/// The weight of a diagonal neighbour; one along the axes has 1.
pub const DIAGONAL: f32 = 0.5;
/// The first terms of the series of `arcsin(s) / s` in `s^2`: 1/6, 3/40, 15/336.
pub const ARC: [f32; 3] = [0.16666667, 0.075, 0.04464286];

/// Takes a batch of steps on the CPU.
pub fn relax(surface: &RelaxationSurface, tiles: &[Tile], relaxation: &Relaxation) -> Vec<Tile> {
    relax_watched(surface, tiles, relaxation, &|| false)
}

/// Takes a batch of steps on the CPU, or fewer where `is_cancelled` becomes true.
pub fn relax_watched(
    surface: &RelaxationSurface,
    tiles: &[Tile],
    relaxation: &Relaxation,
    is_cancelled: &(dyn Fn() -> bool + Sync),
) -> Vec<Tile> {
    let mut tiles = tiles.to_vec();
    let mut lists = Vec::new();
    for step in 0..relaxation.steps {
        if is_cancelled() {
            break;
        }
        if step.is_multiple_of(LIST_STEPS) {
            lists = neighbours::lists(&tiles, relaxation.cell);
        }
        let moved = |id: usize| moved(surface, &tiles, &lists[id], id as u32, relaxation.scale);
        tiles = (0..tiles.len()).into_par_iter().with_min_len(256).map(moved).collect();
    }
    tiles
}

fn moved(surface: &RelaxationSurface, tiles: &[Tile], list: &[u32], id: u32, scale: f32) -> Tile {
    let tile = tiles[id as usize];
    if tile.quarters > 0 {
        return tile;
    }
    let (mut force, mut weight) = (Vec3::ZERO, 0.0f32);
    for &other in list.iter().take_while(|&&other| other != NONE) {
        if let Some(seen) = see(&tile, &tiles[other as usize]) {
            let Some(k) = seen.place(id < other) else { continue };
            let w = if k[0] != 0.0 && k[1] != 0.0 { DIAGONAL } else { 1.0 };
            force += (seen.x * (seen.u[0] - k[0]) + seen.y * (seen.u[1] - k[1])) * (w * seen.h);
            weight += w;
        }
    }
    let normal = tile.normal();
    let step = force * (STEP / weight.max(2.0));
    let step = step - normal * dot(normal, step);
    let end = walk_on(surface, tile.triangle, tile.at(), step, MOST_EDGES);
    let corners = surface.corners(end.triangle as usize);
    let to_corners = barycentric(corners, end.position);
    Tile {
        position: end.position.into(),
        h: scale * size_at(surface, end.triangle, to_corners),
        normal: unit(cross(corners[1] - corners[0], corners[2] - corners[0])).into(),
        triangle: end.triangle,
        axis: axis_at(corners, surface.crosses[end.triangle as usize], to_corners).into(),
        ..tile
    }
}

impl Walkable for RelaxationSurface {
    fn corners(&self, triangle: usize) -> [Vec3; 3] {
        self.triangles[triangle].corners.map(|v| {
            let [x, y, z, _] = self.points[v as usize];
            Vec3::new(x, y, z)
        })
    }

    fn beyond(&self, half_edge: u32) -> u32 {
        self.triangles[half_edge as usize / 3].beyond[half_edge as usize % 3]
    }
}

/// The relative size of tiles at a point of a triangle.
fn size_at(surface: &RelaxationSurface, triangle: u32, [to_b, to_c]: [f32; 2]) -> f32 {
    let [a, b, c] = surface.triangles[triangle as usize].corners.map(|v| surface.points[v as usize][3]);
    a + (b - a) * to_b + (c - a) * to_c
}

/// One tile as another sees it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sight {
    /// The mean axes of the two.
    pub x: Vec3,
    pub y: Vec3,
    /// Where the other lies in these axes, in tile sides.
    pub u: [f32; 2],
    /// The mean side.
    pub h: f32,
}

impl Sight {
    /// The lattice point beside the tile that is nearest to the other tile; `None` where a farther one is nearer.
    fn place(&self, first: bool) -> Option<[f32; 2]> {
        let [u, v] = self.u;
        if u.abs() >= 1.5 || v.abs() >= 1.5 {
            return None;
        }
        let k = [u, v].map(|t| f32::from(t.abs() > 0.5) * sign(t));
        if k[0] != 0.0 || k[1] != 0.0 {
            return Some(k);
        }
        let away = |t: f32| if t > 0.0 || (t == 0.0 && first) { 1.0 } else { -1.0 };
        Some(if u.abs() >= v.abs() { [away(u), 0.0] } else { [0.0, away(v)] })
    }
}

fn sign(t: f32) -> f32 {
    if t < 0.0 { -1.0 } else { 1.0 }
}

/// How tile `a` sees tile `b`; `None` where it does not.
#[inline(always)]
pub(crate) fn see(a: &Tile, b: &Tile) -> Option<Sight> {
    let h = (a.h + b.h) * 0.5;
    let e = b.at() - a.at();
    if dot(e, e) > (REACH * h) * (REACH * h) {
        return None;
    }
    let (na, nb) = (a.normal(), b.normal());
    let cosine = dot(na, nb);
    if cosine < LEAST_COSINE {
        return None;
    }
    // The mean normal and the mean axis are made unit last, and along with other divisions: those cost most here.
    let n = na + nb;
    let nn = dot(n, n);
    let height = dot(e, n);
    if height * height > (SHEET * h) * (SHEET * h) * nn || is_behind(b, e, h) {
        return None;
    }
    let ax = a.direction(0);
    let (bx, by) = (b.direction(0), b.direction(1));
    let (dx, dy) = (dot(ax, bx), dot(ax, by));
    // Products with 0, 1 or -1: which it is changes from pair to pair, and a branch would be guessed wrong half the time.
    let turned = f32::from(dx.abs() < dy.abs());
    let sum = ax + bx * ((1.0 - turned) * sign(dx)) + by * (turned * sign(dy));
    let x = sum - n * (dot(n, sum) / nn);
    let xx = dot(x, x);
    let x = x * (if xx > 0.0 { 1.0 / xx.sqrt() } else { 0.0 });
    let y = cross(n, x) * (1.0 / nn.sqrt());
    // arcsin(s) / s for the chord of an arc that turns by twice arcsin(s).
    let s2 = (1.0 - cosine) * 0.5;
    let stretch = (1.0 + s2 * (ARC[0] + s2 * (ARC[1] + s2 * ARC[2]))) / h;
    Some(Sight { x, y, u: [dot(e, x) * stretch, dot(e, y) * stretch], h })
}

/// From behind, the side of a feature is not seen: its other side is.
fn is_behind(b: &Tile, e: Vec3, h: f32) -> bool {
    let behind = h * 1e-3;
    ((b.quarters == 1 || b.quarters == 2) && dot(e, b.direction(1)) > behind)
        || (b.quarters == 1 && dot(e, b.direction(0)) > behind)
}
