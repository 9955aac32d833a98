//! Tiles on features: one at each corner, and as many along each feature curve as fit.
//!
//! # Practice
//! A curve of length `l` holds `round(l / h)` intervals of tiles. Such a tile is one vertex of the mesh to come, but it
//! is seen from each side of the feature apart, with that side's normal and the curve's tangent as axis.

use super::Tile;
use crate::field::Field;
use crate::geometry::{cross, unit};
use crate::surface::{Curve, Surface, next, previous};
use glam::Vec3;
use rustc_hash::FxHashSet;

/// Where on the surface's features a tile sits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Seat {
    /// On a vertex of the surface.
    Vertex(u32),
    /// On an edge of the surface, at this share of the way along the half-edge.
    Edge(u32, f64),
}

/// A tile on a feature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Site {
    /// Where it sits.
    pub seat: Seat,
    /// The first of its sides among the mosaic's tiles.
    pub first_side: u32,
}

/// A place nearer to a vertex than this, in tile sides and as a share of its edge, is on the vertex.
const SNAP: f64 = 1e-3;

/// The tiles of side `h` on the features, and the sides that they are seen from.
pub fn seat(surface: &Surface, field: &Field, h: f32) -> (Vec<Site>, Vec<Tile>) {
    let mut seats: Vec<Seat> = surface.features().corners().map(Seat::Vertex).collect();
    let mut joined = FxHashSet::default();
    for curve in surface.features().curves() {
        let [first, last] = [curve.vertices[0], curve.vertices[curve.vertices.len() - 1]];
        // Few intervals must not make a loop of less than three edges, nor two edges between the same two corners.
        let least = if first == last {
            3
        } else if joined.insert([first.min(last), first.max(last)]) {
            1
        } else {
            2
        };
        along(surface, curve, h, least, &mut seats);
    }
    let mut tiles = Vec::with_capacity(2 * seats.len());
    let mut sites = Vec::with_capacity(seats.len());
    for seat in seats {
        sites.push(Site { seat, first_side: tiles.len() as u32 });
        sides(surface, field, seat, h, &mut tiles);
    }
    (sites, tiles)
}

fn place(surface: &Surface, seat: Seat) -> Vec3 {
    match seat {
        Seat::Vertex(v) => surface.points[v as usize],
        Seat::Edge(h, share) => {
            let [a, b] = [surface.origin(h), surface.target(h)].map(|v| surface.points[v as usize].as_dvec3());
            (a + (b - a) * share).as_vec3()
        }
    }
}

/// Adds the seats along a curve, its corners left out.
fn along(surface: &Surface, curve: &Curve, h: f32, least: usize, seats: &mut Vec<Seat>) {
    let lengths: Vec<f64> = curve.half_edges.iter().map(|&e| surface.length(e)).collect();
    let total: f64 = lengths.iter().sum();
    let intervals = ((total / f64::from(h)).round() as usize).max(least);
    let (mut edge, mut passed) = (0, 0.0);
    for i in usize::from(!curve.closed)..intervals {
        let at = total * i as f64 / intervals as f64;
        while edge + 1 < lengths.len() && passed + lengths[edge] < at {
            passed += lengths[edge];
            edge += 1;
        }
        let share = (at - passed) / lengths[edge].max(f64::MIN_POSITIVE);
        let snap = SNAP * (f64::from(h) / lengths[edge].max(f64::MIN_POSITIVE)).min(1.0);
        seats.push(if share < snap {
            Seat::Vertex(curve.vertices[edge])
        } else if share > 1.0 - snap {
            Seat::Vertex(curve.vertices[edge + 1])
        } else {
            let half_edge = curve.half_edges[edge];
            let forward = surface.origin(half_edge) == curve.vertices[edge];
            Seat::Edge(half_edge, if forward { share } else { 1.0 - share })
        });
    }
}

fn sides(surface: &Surface, field: &Field, seat: Seat, h: f32, tiles: &mut Vec<Tile>) {
    let position = place(surface, seat).into();
    match seat {
        Seat::Edge(half_edge, _) => {
            for e in [Some(half_edge), surface.twin(half_edge)].into_iter().flatten() {
                let along = surface.points[surface.target(e) as usize] - surface.points[surface.origin(e) as usize];
                tiles.push(Tile {
                    position,
                    h,
                    normal: surface.normal(e as usize / 3).into(),
                    triangle: e / 3,
                    axis: unit(along).into(),
                    quarters: 2,
                });
            }
        }
        Seat::Vertex(vertex) => {
            for &sector in field.sectors().of_vertex(vertex) {
                let quarters = u32::from(field.sectors().quarters[sector as usize]);
                let (triangle, middle) = middle(surface, field, sector);
                let normal = surface.normal(triangle as usize);
                // The middle of the side lies half its quarter turns past the axis.
                let back = -f32::from(quarters as u8) * std::f32::consts::FRAC_PI_4;
                let axis = middle * back.cos() + cross(normal, middle) * back.sin();
                tiles.push(Tile { position, h, normal: normal.into(), triangle, axis: axis.into(), quarters });
            }
        }
    }
}

/// The triangle that the middle direction of a sector points into, and that direction.
fn middle(surface: &Surface, field: &Field, sector: u32) -> (u32, Vec3) {
    let sectors = field.sectors();
    let total: f64 = sectors.corners(surface, sector).map(|c| sectors.corner_angle(c)).sum();
    let mut left = total / 2.0;
    let mut at = sectors.first_corner[sector as usize];
    for corner in sectors.corners(surface, sector) {
        at = corner;
        if left <= sectors.corner_angle(corner) {
            break;
        }
        left -= sectors.corner_angle(corner);
    }
    let [o, p, q] = [at, next(at), previous(at)].map(|e| surface.points[surface.origin(e) as usize]);
    let normal = unit(cross(p - o, q - o));
    let along = unit(p - o);
    let (s, c) = left.sin_cos();
    (at / 3, along * c as f32 + cross(normal, along) * s as f32)
}
