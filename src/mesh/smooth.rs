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
    let mut standing = Standing::new(metric, mesh);
    let floor = standing.shapes.iter().copied().fold(f64::INFINITY, f64::min).max(FLOOR);
    let free = (0..below.len()).filter(|&v| below[v].is_some());
    let colours = colours(mesh, &standing.incidence, free);
    for _ in 0..passes {
        for colour in &colours {
            let moves: Vec<(u32, u32, Vec3)> = colour
                .par_iter()
                .with_min_len(256)
                .filter(|&&v| standing.waiting[v as usize])
                .filter_map(|&v| {
                    let here = (v, result.below[v as usize]?);
                    let (triangle, place) = better(surface, &result.mesh, &standing, here, floor)?;
                    Some((v, triangle, place))
                })
                .collect();
            for &(v, triangle, place) in &moves {
                result.mesh.points[v as usize] = place.as_dvec3().into();
                result.below[v as usize] = Some(triangle);
            }
            let moved: Vec<u32> = moves.iter().map(|&(v, ..)| v).collect();
            standing.update(&result.mesh, colour, &moved);
        }
    }
    result
}

/// The faces of a mesh whose vertices move: what each is worth now, and who has to look again.
pub(super) struct Standing {
    pub(super) incidence: Incidence,
    frames: Vec<Frame>,
    /// The shape of each face.
    pub(super) shapes: Vec<f64>,
    /// Vertices that have a face which changed since they looked for their place last.
    pub(super) waiting: Vec<bool>,
}

impl Standing {
    pub(super) fn new(metric: &Metric, mesh: &Mesh) -> Self {
        let frames = metric.frames(mesh.faces());
        let own = |f: usize| shape_with(mesh, frames.get(f), mesh.face(f), None);
        let shapes = (0..mesh.face_count()).into_par_iter().with_min_len(1024).map(own).collect();
        Self { incidence: Incidence::new(mesh), shapes, waiting: vec![true; mesh.points.len()], frames }
    }

    /// Takes note that vertices have looked for their places, and that some of them, no two in one face, have moved.
    pub(super) fn update(&mut self, mesh: &Mesh, looked: &[u32], moved: &[u32]) {
        let own = |&f: &u32| (f, shape_with(mesh, self.frames.get(f as usize), mesh.face(f as usize), None));
        let about = |&v: &u32| self.incidence.faces_at(v as usize).iter().map(own);
        let changed: Vec<(u32, f64)> = moved.par_iter().with_min_len(256).flat_map_iter(about).collect();
        looked.iter().for_each(|&v| self.waiting[v as usize] = false);
        for (f, shape) in changed {
            self.shapes[f as usize] = shape;
            mesh.face(f as usize).iter().for_each(|&v| self.waiting[v as usize] = true);
        }
    }

    /// The least shape of the faces at a vertex, and the sum of what they say.
    pub(super) fn judge(&self, mesh: &Mesh, v: u32) -> (f64, f64) {
        self.fold(mesh, v, |f| self.shapes[f as usize])
    }

    /// The same if the vertex were at a place.
    pub(super) fn judge_at(&self, mesh: &Mesh, v: u32, place: DVec3) -> (f64, f64) {
        self.fold(mesh, v, |f| shape_with(mesh, self.frames.get(f as usize), mesh.face(f as usize), Some((v, place))))
    }

    fn fold(&self, mesh: &Mesh, v: u32, shape: impl Fn(u32) -> f64) -> (f64, f64) {
        self.incidence.faces_at(v as usize).iter().fold((f64::INFINITY, 0.0), |(least, sum), &f| {
            let (weight, shape) = (say(mesh.face(f as usize).len()), shape(f));
            (shape.min(least), sum + if weight > 0.0 { weight * shape } else { 0.0 })
        })
    }
}

/// Where a vertex goes, if its faces gain by it: the triangle there and the place.
fn better(
    surface: &Surface,
    mesh: &Mesh,
    standing: &Standing,
    (v, triangle): (u32, u32),
    floor: f64,
) -> Option<(u32, Vec3)> {
    let at = point(mesh, v);
    let faces = standing.incidence.faces_at(v as usize);
    let (mut way, mut weight) = (DVec3::ZERO, 0.0);
    for &f in faces {
        let face = mesh.face(f as usize);
        let place = face.iter().position(|&w| w == v)?;
        let share = say(face.len()) * (if standing.shapes[f as usize] < floor { BAD } else { 1.0 });
        way += (ideal(mesh, standing.frames.get(f as usize), face, place) - at) * share;
        weight += share;
    }
    let normal = surface.normal(triangle as usize).as_dvec3();
    let way = (way - normal * normal.dot(way)) / weight;
    if way.length() < SETTLED * reach(mesh, faces, v) {
        return None;
    }
    let (least, sum) = standing.judge(mesh, v);
    STRIDES.into_iter().find_map(|stride| {
        let barrier = |h| surface.features().is_feature(h);
        let foot = walk(surface, barrier, triangle, at.as_vec3(), way.as_vec3() * stride, WALK_EDGES);
        let (new_least, new_sum) = standing.judge_at(mesh, v, foot.position.as_dvec3());
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

/// How loudly a face speaks.
fn say(corners: usize) -> f64 {
    match corners {
        3 => TRIANGLE,
        4 => 1.0,
        _ => 0.0,
    }
}

/// The shape of a face, with one vertex elsewhere if asked; polygons are never the worst.
fn shape_with(mesh: &Mesh, frame: Option<&Frame>, face: &[u32], moved: Option<(u32, DVec3)>) -> f64 {
    let at = |w: u32| {
        let place = moved.filter(|(v, _)| w == *v).map_or_else(|| point(mesh, w), |(_, place)| place);
        laid(frame, place).into()
    };
    match *face {
        [a, b, c] => triangle_shape([a, b, c].map(at)),
        [a, b, c, d] => quad_shape([a, b, c, d].map(at)),
        _ => f64::INFINITY,
    }
}
