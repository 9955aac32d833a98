//! Smoothing: vertices move along the surface to where their faces are nearest to squares.
//!
//! # Theory
//! Each face has a best-fitting regular polygon about its centre; a vertex is drawn to the mean of its places in those of
//! its faces (shape matching). The move is laid on the surface by a walk, so vertices stay on it.
//!
//! # Practice
//! Vertices are taken one after the other. A move is kept only where it lowers neither the least nor the mean shape of
//! the faces at the vertex, so the worst face of the mesh never gets worse. Vertices on features stay.

use super::Mesh;
use super::quality::{quad_shape, triangle_shape};
use crate::surface::{Surface, WALK_EDGES, walk};
use glam::{DVec3, Vec3};

/// The share of the way to its place that a vertex moves at a time; halved where that is too far.
const STRIDES: [f32; 2] = [0.9, 0.4];
/// A vertex nearer to its place than this share of an edge stays.
const SETTLED: f32 = 1e-3;

/// Moves the vertices `passes` times. `triangles` names the triangle below each vertex, `None` where it is fixed.
pub fn smooth(surface: &Surface, mesh: &Mesh, triangles: &[Option<u32>], passes: usize) -> (Mesh, Vec<Option<u32>>) {
    let mut mesh = mesh.clone();
    let mut triangles = triangles.to_vec();
    let incidence = Incidence::new(&mesh);
    let barrier = |h| surface.features().is_feature(h);
    for _ in 0..passes {
        for (v, below) in triangles.iter_mut().enumerate() {
            let Some(triangle) = *below else { continue };
            let at = DVec3::from(mesh.points[v]);
            let faces = incidence.faces_at(v);
            let way = faces.iter().map(|&f| ideal(&mesh, f, v) - at).sum::<DVec3>() / faces.len().max(1) as f64;
            let normal = surface.normal(triangle as usize);
            let way = way.as_vec3();
            let way = way - normal * normal.dot(way);
            let (least, mean) = shapes(&mesh, faces);
            if way.length() < SETTLED * reach(&mesh, faces, v) {
                continue;
            }
            for stride in STRIDES {
                let foot = walk(surface, barrier, triangle, at.as_vec3(), way * stride, WALK_EDGES);
                mesh.points[v] = to_f64(foot.position);
                let (new_least, new_mean) = shapes(&mesh, faces);
                if new_least >= least && new_mean > mean {
                    *below = Some(foot.triangle);
                    break;
                }
                mesh.points[v] = at.into();
            }
        }
    }
    (mesh, triangles)
}

fn to_f64(p: Vec3) -> [f64; 3] {
    p.as_dvec3().into()
}

/// The faces at each vertex.
struct Incidence {
    starts: Vec<u32>,
    faces: Vec<u32>,
}

impl Incidence {
    fn new(mesh: &Mesh) -> Self {
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

    fn faces_at(&self, v: usize) -> &[u32] {
        &self.faces[self.starts[v] as usize..self.starts[v + 1] as usize]
    }
}

fn point(mesh: &Mesh, v: u32) -> DVec3 {
    DVec3::from(mesh.points[v as usize])
}

/// A length to compare moves with: from the vertex to the next one of its first face.
fn reach(mesh: &Mesh, faces: &[u32], v: usize) -> f32 {
    faces.first().map_or(0.0, |&f| {
        let face = mesh.face(f as usize);
        let k = face.iter().position(|&w| w as usize == v).unwrap_or(0);
        point(mesh, face[k]).distance(point(mesh, face[(k + 1) % face.len()])) as f32
    })
}

/// Where the vertex would be if the face were the regular polygon that fits it best.
fn ideal(mesh: &Mesh, face: u32, v: usize) -> DVec3 {
    let face = mesh.face(face as usize);
    let count = face.len();
    let centre = face.iter().map(|&w| point(mesh, w)).sum::<DVec3>() / count as f64;
    let arm = |k: usize| point(mesh, face[k % count]) - centre;
    let normal = (0..count).map(|k| arm(k).cross(arm(k + 1))).sum::<DVec3>().normalize_or_zero();
    let at = face.iter().position(|&w| w as usize == v).unwrap_or(0);
    // The arms of the others, turned to where this one is, averaged.
    let step = std::f64::consts::TAU / count as f64;
    let own = (0..count)
        .map(|k| {
            let (s, c) = (-(k as f64) * step).sin_cos();
            let a = arm(at + k);
            a * c + normal.cross(a) * s
        })
        .sum::<DVec3>()
        / count as f64;
    centre + own
}

/// The least and the mean shape of some faces.
fn shapes(mesh: &Mesh, faces: &[u32]) -> (f64, f64) {
    let shape = |&f: &u32| match *mesh.face(f as usize) {
        [a, b, c] => triangle_shape([a, b, c].map(|v| mesh.points[v as usize])),
        [a, b, c, d] => quad_shape([a, b, c, d].map(|v| mesh.points[v as usize])),
        _ => 0.0,
    };
    let (least, sum) = faces.iter().map(shape).fold((f64::INFINITY, 0.0), |(l, s), q| (l.min(q), s + q));
    (least, sum / faces.len().max(1) as f64)
}
