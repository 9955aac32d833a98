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

use super::Tile;
use super::grid::Grid;
use crate::field::{Field, axis_at};
use crate::geometry::{cross, dot, unit};
use crate::surface::{Surface, WALK_EDGES, walk};
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
}

impl Relaxation {
    /// Steps for tiles of side at most `h`.
    pub fn new(steps: u32, h: f32) -> Self {
        Self { steps, cell: cell(h) }
    }
}

/// The side of the grid's cells for tiles of side at most `h`: a little more than their reach, so that rounding puts no
/// neighbour two cells away.
pub(super) fn cell(h: f32) -> f32 {
    1.001 * REACH * h
}

/// Takes a batch of steps on the CPU.
pub fn relax(surface: &Surface, field: &Field, tiles: &[Tile], relaxation: &Relaxation) -> Vec<Tile> {
    let mut tiles = tiles.to_vec();
    for _ in 0..relaxation.steps {
        let grid = Grid::build(|i| tiles[i].position, tiles.len(), relaxation.cell);
        tiles = (0..tiles.len()).into_par_iter().map(|i| moved(surface, field, &tiles, &grid, i as u32)).collect();
    }
    tiles
}

fn moved(surface: &Surface, field: &Field, tiles: &[Tile], grid: &Grid, id: u32) -> Tile {
    let tile = tiles[id as usize];
    if tile.quarters > 0 {
        return tile;
    }
    let (mut pull, mut weight) = (Vec3::ZERO, 0.0f32);
    grid.around(tile.position, |other| {
        if other != id
            && let Some(seen) = see(&tile, &tiles[other as usize])
        {
            let k = seen.place(id < other);
            let w = if k[0] != 0.0 && k[1] != 0.0 { DIAGONAL } else { 1.0 };
            if k[0].abs() <= 1.0 && k[1].abs() <= 1.0 {
                pull += (seen.x * (seen.u[0] - k[0]) + seen.y * (seen.u[1] - k[1])) * (w * seen.h);
                weight += w;
            }
        }
    });
    let normal = tile.normal();
    let step = pull * (STEP / weight.max(2.0));
    let step = step - normal * dot(normal, step);
    let barrier = |h| surface.features().is_feature(h);
    let foot = walk(surface, barrier, tile.triangle, tile.at(), step, WALK_EDGES);
    let corners = surface.corners(foot.triangle as usize);
    Tile {
        position: foot.position.into(),
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
    /// The lattice place that is nearest to where the other lies; never `[0, 0]`.
    fn place(&self, first: bool) -> [f32; 2] {
        let [u, v] = self.u;
        let k = [u.round_ties_even(), v.round_ties_even()];
        if k[0] != 0.0 || k[1] != 0.0 {
            return k;
        }
        let away = |t: f32| if t > 0.0 || (t == 0.0 && first) { 1.0 } else { -1.0 };
        if u.abs() >= v.abs() { [away(u), 0.0] } else { [0.0, away(v)] }
    }
}

/// How tile `a` sees tile `b`; `None` where it does not.
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
    let n = unit(na + nb);
    let (bx, by) = (b.direction(0), b.direction(1));
    // From behind, the side of a feature is not seen: its other side is.
    let behind = h * 1e-3;
    if dot(e, n).abs() > SHEET * h
        || ((b.quarters == 1 || b.quarters == 2) && dot(e, by) > behind)
        || (b.quarters == 1 && dot(e, bx) > behind)
    {
        return None;
    }
    let ax = a.direction(0);
    let (dx, dy) = (dot(ax, bx), dot(ax, by));
    let nearest = if dx.abs() >= dy.abs() {
        if dx < 0.0 { -bx } else { bx }
    } else if dy < 0.0 {
        -by
    } else {
        by
    };
    let sum = ax + nearest;
    let x = unit(sum - n * dot(n, sum));
    let y = cross(n, x);
    // arcsin(s) / s for the chord of an arc that turns by twice arcsin(s).
    let s2 = (1.0 - cosine) * 0.5;
    let stretch = 1.0 + s2 * (ARC[0] + s2 * (ARC[1] + s2 * ARC[2]));
    Some(Sight { x, y, u: [dot(e, x) * stretch / h, dot(e, y) * stretch / h], h })
}
