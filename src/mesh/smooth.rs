//! Smoothing: vertices move along the surface to where their faces are nearest to squares.
//!
//! # Theory
//! Each face has a best-fitting regular polygon about its centre; a vertex is drawn to the mean of its places in those of
//! its faces (shape matching). The move is laid on the surface by a walk, so vertices stay on it.
//!
//! # Practice
//! A move is kept only where the sum of the shapes at the vertex rises and the worst of them either rises or stays above
//! a floor that is no lower than the worst shape of the whole mesh: so that never gets worse. A rule without the floor
//! (no vertex may make its worst face worse) gets stuck: Qg of fish_blub at 6,000 points stays at 0.927 in 200 passes,
//! with the floor it is 0.930 after 20.
//!
//! Vertices that share no face move at once: the mesh is coloured, greedily in the order of the vertices, and the colours
//! take turns. So the result does not depend on the number of threads. Vertices on features stay.

use super::metric::{Frame, laid, lifted};
use super::quality::{quad_shape, triangle_shape};
use super::{Mesh, Metric};
use crate::surface::{Surface, WALK_EDGES, walk};
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// The share of the way to its place that a vertex moves at a time; less where that is too far.
const STRIDES: [f32; 2] = [0.9, 0.4];
/// How much louder a face below the floor draws.
const BAD: f64 = 3.0;
/// A vertex nearer to its place than this share of an edge stays.
const SETTLED: f64 = 1e-3;
/// Shapes above this may fall to it for the good of others.
const FLOOR: f64 = 0.5;
/// Where the worst shape at a vertex is below the floor, it need rise by so much only, whatever the sum does.
const RISE: f64 = 1e-3;
/// The say of a triangle, in quads.
const TRIANGLE: f64 = 0.5;

/// A mesh on a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Smoothed {
    /// The mesh.
    pub mesh: Mesh,
    /// The triangle of the surface below each vertex, `None` where it is fixed.
    pub below: Vec<Option<u32>>,
}

/// Moves the vertices `passes` times. `below` names the triangle of the surface below each vertex, `None` where it is fixed.
pub fn smooth(surface: &Surface, mesh: &Mesh, below: &[Option<u32>], passes: usize) -> Smoothed {
    smooth_in(&Metric::default(), surface, mesh, below, passes)
}

/// As [`smooth`], to where faces are nearest to squares in a metric.
pub fn smooth_in(metric: &Metric, surface: &Surface, mesh: &Mesh, below: &[Option<u32>], passes: usize) -> Smoothed {
    let mut result = Smoothed { mesh: mesh.clone(), below: below.to_vec() };
    if passes == 0 {
        return result;
    }
    let incidence = Incidence::new(mesh);
    let frames = metric.frames(mesh.faces());
    let worst = (0..mesh.face_count()).map(|f| shape(mesh, &frames, f as u32).1).fold(f64::INFINITY, f64::min);
    let floor = worst.max(FLOOR);
    let free = (0..below.len()).filter(|&v| below[v].is_some());
    let colours = colours(mesh, &incidence, free);
    for _ in 0..passes {
        for colour in &colours {
            let moves: Vec<Option<(u32, Vec3)>> = colour
                .par_iter()
                .with_min_len(256)
                .map(|&v| {
                    let faces = incidence.faces_at(v as usize);
                    let here = (v, result.below[v as usize]?);
                    better(surface, &result.mesh, &frames, here, faces, floor)
                })
                .collect();
            for (&v, moved) in colour.iter().zip(moves) {
                if let Some((triangle, place)) = moved {
                    result.mesh.points[v as usize] = place.as_dvec3().into();
                    result.below[v as usize] = Some(triangle);
                }
            }
        }
    }
    result
}

/// Where a vertex goes, if its faces gain by it: the triangle there and the place.
fn better(
    surface: &Surface,
    mesh: &Mesh,
    frames: &[Frame],
    (v, triangle): (u32, u32),
    faces: &[u32],
    floor: f64,
) -> Option<(u32, Vec3)> {
    let at = point(mesh, v);
    let (mut way, mut weight) = (DVec3::ZERO, 0.0);
    for &f in faces {
        let face = mesh.face(f as usize);
        let place = face.iter().position(|&w| w == v)?;
        let (share, shape) = shape(mesh, frames, f);
        let share = share * (if shape < floor { BAD } else { 1.0 });
        way += (ideal(mesh, frames.get(f as usize), face, place) - at) * share;
        weight += share;
    }
    let normal = surface.normal(triangle as usize).as_dvec3();
    let way = (way - normal * normal.dot(way)) / weight;
    if way.length() < SETTLED * reach(mesh, faces, v) {
        return None;
    }
    let judge = |to: Option<DVec3>| {
        faces.iter().fold((f64::INFINITY, 0.0), |(least, sum), &f| {
            let (weight, shape) = shape_with(mesh, frames, f, v, to);
            (shape.min(least), sum + if weight > 0.0 { weight * shape } else { 0.0 })
        })
    };
    let (least, sum) = judge(None);
    STRIDES.into_iter().find_map(|stride| {
        let barrier = |h| surface.features().is_feature(h);
        let foot = walk(surface, barrier, triangle, at.as_vec3(), way.as_vec3() * stride, WALK_EDGES);
        let (new_least, new_sum) = judge(Some(foot.position.as_dvec3()));
        let worst_rises = least < floor && new_least > least + RISE;
        (new_least >= least.min(floor) && (worst_rises || new_sum > sum)).then_some((foot.triangle, foot.position))
    })
}

/// Vertices that have faces, in sets of which no two share a face.
pub(super) fn colours(mesh: &Mesh, incidence: &Incidence, vertices: impl Iterator<Item = usize>) -> Vec<Vec<u32>> {
    const NONE: u8 = u8::MAX;
    let mut colour = vec![NONE; mesh.points.len()];
    let mut sets: Vec<Vec<u32>> = Vec::new();
    let mut taken = Vec::new();
    for v in vertices.filter(|&v| !incidence.faces_at(v).is_empty()) {
        taken.clear();
        taken.resize(sets.len() + 1, false);
        for &w in incidence.faces_at(v).iter().flat_map(|&f| mesh.face(f as usize)) {
            if colour[w as usize] != NONE {
                taken[colour[w as usize] as usize] = true;
            }
        }
        // More than 255 colours would take a vertex of as many faces; what has none of its own stays.
        let free = taken.iter().position(|taken| !taken).unwrap_or(0);
        if free == sets.len() {
            if free == NONE as usize {
                continue;
            }
            sets.push(Vec::new());
        }
        colour[v] = free as u8;
        sets[free].push(v as u32);
    }
    sets
}

/// The faces at each vertex.
pub(super) struct Incidence {
    starts: Vec<u32>,
    faces: Vec<u32>,
}

impl Incidence {
    pub(super) fn new(mesh: &Mesh) -> Self {
        let mut starts = vec![0; mesh.points.len() + 1];
        mesh.faces().flatten().for_each(|&v| starts[v as usize + 1] += 1);
        for v in 1..starts.len() {
            starts[v] += starts[v - 1];
        }
        let mut place = starts.clone();
        let mut faces = vec![0; starts[starts.len() - 1] as usize];
        for (f, face) in mesh.faces().enumerate() {
            for &v in face {
                faces[place[v as usize] as usize] = f as u32;
                place[v as usize] += 1;
            }
        }
        Self { starts, faces }
    }

    pub(super) fn faces_at(&self, v: usize) -> &[u32] {
        &self.faces[self.starts[v] as usize..self.starts[v + 1] as usize]
    }

    /// The mean length of the sides that begin at a vertex.
    pub(super) fn edge(&self, mesh: &Mesh, v: u32) -> f64 {
        let faces = self.faces_at(v as usize);
        let sides = faces.iter().map(|&f| {
            let face = mesh.face(f as usize);
            let next = face.iter().position(|&w| w == v).map_or(0, |k| (k + 1) % face.len());
            point(mesh, v).distance(point(mesh, face[next]))
        });
        sides.sum::<f64>() / faces.len().max(1) as f64
    }
}

fn point(mesh: &Mesh, v: u32) -> DVec3 {
    DVec3::from(mesh.points[v as usize])
}

/// A length to compare moves with: from the vertex to the next one of its first face.
fn reach(mesh: &Mesh, faces: &[u32], v: u32) -> f64 {
    faces.first().map_or(0.0, |&f| {
        let face = mesh.face(f as usize);
        let k = face.iter().position(|&w| w == v).unwrap_or(0);
        point(mesh, v).distance(point(mesh, face[(k + 1) % face.len()]))
    })
}

/// Where the vertex at a place of a face would be if the face were the regular polygon that fits it best.
fn ideal(mesh: &Mesh, frame: Option<&Frame>, face: &[u32], place: usize) -> DVec3 {
    lifted(frame, regular(face.len(), |k| laid(frame, point(mesh, face[(place + k) % face.len()]))))
}

/// The first corner of the regular polygon that fits a polygon best; `corner` tells its corners in order.
pub(super) fn regular(count: usize, corner: impl Fn(usize) -> DVec3) -> DVec3 {
    let centre = (0..count).map(&corner).sum::<DVec3>() / count as f64;
    if count == 4 {
        // The two arms of each diagonal, those of the other one turned by a right angle.
        let (first, second) = (corner(0) - corner(2), corner(3) - corner(1));
        let normal = second.cross(first).normalize_or_zero();
        return centre + (first + normal.cross(second)) / 4.0;
    }
    let arm = |k: usize| corner(k % count) - centre;
    let normal = (0..count).map(|k| arm(k).cross(arm(k + 1))).sum::<DVec3>().normalize_or_zero();
    // The arms of the others, turned to where this one is, averaged.
    let step = std::f64::consts::TAU / count as f64;
    let turned = (0..count).map(|k| {
        let (s, c) = (-(k as f64) * step).sin_cos();
        arm(k) * c + normal.cross(arm(k)) * s
    });
    centre + turned.sum::<DVec3>() / count as f64
}

/// What a face says and how loudly, with one vertex elsewhere if asked.
pub(super) fn shape_with(mesh: &Mesh, frames: &[Frame], face: u32, v: u32, to: Option<DVec3>) -> (f64, f64) {
    let at = |w: u32| {
        let place = to.filter(|_| w == v).unwrap_or_else(|| point(mesh, w));
        laid(frames.get(face as usize), place).into()
    };
    match *mesh.face(face as usize) {
        [a, b, c] => (TRIANGLE, triangle_shape([a, b, c].map(at))),
        [a, b, c, d] => (1.0, quad_shape([a, b, c, d].map(at))),
        _ => (0.0, f64::INFINITY),
    }
}

pub(super) fn shape(mesh: &Mesh, frames: &[Frame], face: u32) -> (f64, f64) {
    shape_with(mesh, frames, face, 0, None)
}
