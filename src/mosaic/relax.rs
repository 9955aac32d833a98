//! Relaxation: tiles push and pull each other into rows; the twin of `shaders/relax.wgsl`.
//!
//! # Theory
//! Two tiles with the mean of their crosses as axes see each other at a place `u`, in tile sides. The lattice place that
//! this is nearest to, `k`, is where the other should be: each moves by a share of `u - k`. That is antisymmetric, and
//! orders a random mosaic by itself. Two tiles that overlap (`k = 0`) push apart along the longer axis: the Manhattan
//! repulsion of the mosaics that the paper builds on.
//!
//! # Practice
//! Where the surface bends between two tiles, the chord between them is stretched to the arc that it spans.
//! A tile looks at those of its neighbour list alone, which is made anew every few steps.

use super::Tile;
use super::neighbours::{self, SKIN};
use crate::field::{Field, axis_at};
use crate::geometry::{cross, dot, unit};
use crate::sizes::Sizes;
use crate::surface::{NONE, Surface, WALK_EDGES, walk};
use glam::Vec3;
use rayon::prelude::*;

/// Tiles whose normals differ by more than the angle of this cosine do not see each other.
pub const LEAST_COSINE: f32 = 0.2;
/// Tiles further apart than this, in tile sides, do not see each other.
pub const REACH: f32 = 1.75;
/// Tiles further off each other's plane than this, in tile sides, lie on different sheets.
pub const SHEET: f32 = 0.6;
/// The share of the way to its place that a tile moves in a step.
pub const STEP: f32 = 0.7;
/// A diagonal neighbour's weight against that of one along the axes.
pub const DIAGONAL: f32 = 0.5;
/// The first terms of the series of `arcsin(s) / s` in `s^2`: 1/6, 3/40, 15/336.
const ARC: [f32; 3] = [0.16666667, 0.075, 0.04464286];

/// A batch of relaxation steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relaxation {
    /// How many steps.
    pub steps: u32,
    /// The side of the grid's cells, in unit-sized coordinates: more than the reach of the largest tile.
    pub cell: f32,
    /// The scale of the tiles' sizes: their side where the relative size is 1.
    pub scale: f32,
}

impl Relaxation {
    /// Steps for tiles of these sizes at this scale.
    pub fn new(steps: u32, scale: f32, sizes: &Sizes) -> Self {
        Self { steps, cell: cell(scale * sizes.largest()), scale }
    }
}

/// The side of the grid's cells for tiles of side at most `h`: a little more than their lists reach, so that rounding
/// puts no neighbour two cells away.
pub(super) fn cell(h: f32) -> f32 {
    1.001 * (REACH + SKIN) * h
}

/// Takes a batch of steps on the CPU.
pub fn relax(surface: &Surface, field: &Field, tiles: &[Tile], relaxation: &Relaxation) -> Vec<Tile> {
    let mut tiles = tiles.to_vec();
    let mut lists = Vec::new();
    for step in 0..relaxation.steps {
        if step.is_multiple_of(neighbours::STEPS) {
            lists = neighbours::lists(&tiles, relaxation.cell);
        }
        let moved = |id: usize| moved(surface, field, &tiles, &lists[id], id as u32, relaxation.scale);
        tiles = (0..tiles.len()).into_par_iter().with_min_len(256).map(moved).collect();
    }
    tiles
}

fn moved(surface: &Surface, field: &Field, tiles: &[Tile], list: &[u32], id: u32, scale: f32) -> Tile {
    let tile = tiles[id as usize];
    if tile.quarters > 0 {
        return tile;
    }
    let (mut pull, mut weight) = (Vec3::ZERO, 0.0f32);
    for &other in list.iter().take_while(|&&other| other != NONE) {
        if let Some(seen) = see(&tile, &tiles[other as usize]) {
            let Some(k) = seen.place(id < other) else { continue };
            let w = if k[0] != 0.0 && k[1] != 0.0 { DIAGONAL } else { 1.0 };
            pull += (seen.x * (seen.u[0] - k[0]) + seen.y * (seen.u[1] - k[1])) * (w * seen.h);
            weight += w;
        }
    }
    let normal = tile.normal();
    let step = pull * (STEP / weight.max(2.0));
    let step = step - normal * dot(normal, step);
    let barrier = |h| surface.features().is_feature(h);
    let foot = walk(surface, barrier, tile.triangle, tile.at(), step, WALK_EDGES);
    let corners = surface.corners(foot.triangle as usize);
    Tile {
        position: foot.position.into(),
        h: scale * field.sizes().at(surface, foot.triangle, foot.position),
        normal: unit(cross(corners[1] - corners[0], corners[2] - corners[0])).into(),
        triangle: foot.triangle,
        axis: axis_at(corners, field.in_triangles()[foot.triangle as usize], foot.position).into(),
        ..tile
    }
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
    /// The place in the lattice, next to the tile, that is nearest to where the other lies; `None` where a place further
    /// off is nearer.
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
