//! The worst faces: each vertex of one looks for the place where its faces are least bad.
//!
//! # Theory
//! Smoothing draws vertices to where their faces are nearest to squares on average; a folded face may be stuck there, and a
//! face that is turned over has a good shape. Here what counts is how much the faces at a vertex lack of a measure, squared and
//! summed: the smaller of shape and scaled Jacobian, and where a corner looks away from the surface its area, negative; so is
//! a face's measure that looks away from the surface nearest to its middle, as one may that spans a part thinner than a tile. The
//! vertex tries places about it (a pattern search): on the surface, or, where it lies on a feature curve, along that, between
//! its neighbours there. Corners stay, and so do curves at which sheets meet. The least measure about a vertex never falls,
//! unless faces look away.
//!
//! # Practice
//! Only vertices of faces below 0.3 move, so features are followed as well as before nearly everywhere. With a limit of 0.5 Qg
//! of plane at 6,000 points fell by 0.005, with this one by 0.001 to 0.002. A fold of several faces may stay: each of their
//! vertices alone finds no better place.

use super::curves::Curves;
use super::facing::Facing;
use super::metric::laid;
use super::quality::{quad_shape, scaled_jacobian, triangle_shape};
use super::smooth::{Incidence, Smoothed};
use super::{Mesh, Metric};
use crate::surface::{WALK_EDGES, walk};
use glam::DVec3;
use rayon::prelude::*;

/// Faces with a smaller measure are worked on, until they have it.
const POOR: f64 = 0.3;
/// A triangle is as good as a quad of so many times its shape.
const TRIANGLE: f64 = 2.0;
/// Rounds over them.
const ROUNDS: usize = 12;
/// A quad whose scaled Jacobian is smaller may be split.
const FOLDED: f64 = 0.2;
/// How far a vertex tries to go, in edges.
const STRIDES: [f64; 4] = [0.4, 0.2, 0.08, 0.03];
/// Directions that it tries.
const DIRECTIONS: u32 = 8;
/// The measure of a face that looks away from the surface nearest to its middle, but not from that below its corners.
const AWAY: f64 = 0.2;
/// A move must make the faces so much better, in squared measures.
const GAIN: f64 = 1e-4;

/// Moves vertices of bad faces so that the faces about each become better, their shapes measured in a metric; others stay.
pub fn unfold(metric: &Metric, facing: &Facing, smoothed: &Smoothed) -> Smoothed {
    let Smoothed { mesh, below } = smoothed.clone();
    let incidence = Incidence::new(&mesh);
    let mean_edge = mean_edge(&mesh);
    let mut work = Work { metric, facing, mesh, below, incidence, mean_edge, curves: None };
    let mut waiting = work.poor();
    for _ in 0..ROUNDS {
        waiting.retain(|&v| work.improve(v));
        if waiting.is_empty() {
            break;
        }
        waiting = work.poor_about(&waiting);
    }
    Smoothed { mesh: work.mesh, below: work.below }
}

/// Two triangles in place of each quad that is still concave, cut from its reflex corner, and of each whose scaled Jacobian
/// is below 0.2 where they have better shapes than it; not where the cut is an edge already.
pub fn split_folded(mesh: Mesh) -> Mesh {
    let cuts: Vec<Option<usize>> = mesh.faces().map(|face| cut(&mesh, face)).collect();
    if cuts.iter().all(Option::is_none) {
        return mesh;
    }
    let incidence = Incidence::new(&mesh);
    let joined = |a: u32, b: u32| {
        let beside = |face: &[u32]| {
            let at = face.iter().position(|&v| v == a);
            at.is_some_and(|k| face[(k + 1) % face.len()] == b || face[(k + face.len() - 1) % face.len()] == b)
        };
        incidence.faces_at(a as usize).iter().any(|&f| beside(mesh.face(f as usize)))
    };
    let mut split = Mesh::new(mesh.points.clone());
    for (face, cut) in mesh.faces().zip(cuts) {
        let corners = cut.map(|first| [0, 1, 2, 3].map(|k| face[(first + k) % 4]));
        match corners.filter(|[a, _, c, _]| !joined(*a, *c)) {
            Some([a, b, c, d]) => {
                split.push_face(&[a, b, c]);
                split.push_face(&[a, c, d]);
            }
            None => split.push_face(face),
        }
    }
    split
}

/// The corner of a face, 0 or 1, from which it is to be cut, if it is.
fn cut(mesh: &Mesh, face: &[u32]) -> Option<usize> {
    let &[a, b, c, d] = face else { return None };
    let quad = [a, b, c, d].map(|v| mesh.points[v as usize]);
    if scaled_jacobian(quad) >= FOLDED {
        return None;
    }
    let [p, q, r, s] = quad.map(DVec3::from);
    let normal = (r - p).cross(s - q);
    let area = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a).dot(normal);
    let halves = [[[p, q, r], [p, r, s]], [[q, r, s], [q, s, p]]];
    let least = halves.map(|[one, other]| area(one).min(area(other)));
    let first = usize::from(least[0] < least[1]);
    let worst = halves[first].map(|half| triangle_shape(half.map(DVec3::into))).into_iter().fold(1.0, f64::min);
    (quad_shape(quad) == 0.0 || worst > quad_shape(quad)).then_some(first)
}

fn mean_edge(mesh: &Mesh) -> f64 {
    let point = |v: u32| DVec3::from(mesh.points[v as usize]);
    let sides = || mesh.faces().flat_map(|face| face.iter().zip(face.iter().cycle().skip(1)));
    sides().map(|(&a, &b)| point(a).distance(point(b))).sum::<f64>() / sides().count().max(1) as f64
}

struct Work<'a> {
    metric: &'a Metric,
    facing: &'a Facing<'a>,
    mesh: Mesh,
    below: Vec<Option<u32>>,
    incidence: Incidence,
    mean_edge: f64,
    /// The surface's feature curves, once they are asked for.
    curves: Option<Curves>,
}

impl Work<'_> {
    /// The vertices of poor faces, in order.
    fn poor(&self) -> Vec<u32> {
        let faces = (0..self.mesh.face_count() as u32).into_par_iter().with_min_len(1024);
        let mut poor: Vec<u32> = faces
            .filter(|&face| self.is_poor(face))
            .flat_map_iter(|face| self.mesh.face(face as usize))
            .copied()
            .collect();
        poor.sort_unstable();
        poor.dedup();
        poor
    }

    /// The vertices of poor faces that share a face with one of some vertices, in order: for others nothing has changed.
    fn poor_about(&self, moved: &[u32]) -> Vec<u32> {
        let faces_at = |v: u32| self.incidence.faces_at(v as usize);
        let mut about: Vec<u32> =
            moved.iter().flat_map(|&v| faces_at(v)).flat_map(|&face| self.mesh.face(face as usize)).copied().collect();
        about.sort_unstable();
        about.dedup();
        about.retain(|&v| faces_at(v).iter().any(|&face| self.is_poor(face)));
        about
    }

    fn is_poor(&self, face: u32) -> bool {
        self.measure(face) < POOR
    }

    /// Moves a vertex to the best of the places about it, if one is better than its own.
    fn improve(&mut self, v: u32) -> bool {
        let here = self.point(v);
        let edge = self.incidence.edge(&self.mesh, v);
        let (bad, least) = self.badness(v);
        let mut best = (bad - GAIN, None);
        for stride in STRIDES {
            for (place, triangle) in self.places(v, stride * edge) {
                let kept = self.below[v as usize];
                self.mesh.points[v as usize] = place.into();
                self.below[v as usize] = triangle;
                let (bad, new_least) = self.badness(v);
                self.mesh.points[v as usize] = here.into();
                self.below[v as usize] = kept;
                if bad < best.0 && (least < 0.0 || new_least >= least) {
                    best = (bad, Some((place, triangle)));
                }
            }
        }
        let Some((place, triangle)) = best.1 else { return false };
        self.mesh.points[v as usize] = place.into();
        self.below[v as usize] = triangle;
        true
    }

    /// The places at a distance from a vertex that it may go to, and the triangles of the surface there.
    fn places(&mut self, v: u32, distance: f64) -> Vec<(DVec3, Option<u32>)> {
        let Some(triangle) = self.below[v as usize] else {
            return self.along_curve(v, distance).into_iter().map(|place| (place, None)).collect();
        };
        let surface = self.facing.surface();
        let from = self.point(v).as_vec3();
        let normal = surface.normal(triangle as usize);
        let (across, along) = normal.any_orthonormal_pair();
        let barrier = |h| surface.features().is_feature(h);
        (0..DIRECTIONS)
            .map(|k| {
                let (s, c) = (f64::from(k) * std::f64::consts::TAU / f64::from(DIRECTIONS)).sin_cos();
                let way = (across * c as f32 + along * s as f32) * distance as f32;
                let foot = walk(surface, barrier, triangle, from, way, WALK_EDGES);
                (foot.position.as_dvec3(), Some(foot.triangle))
            })
            .collect()
    }

    /// The places at a distance from a vertex on a feature curve, before and after it; none where it has to stay.
    fn along_curve(&mut self, v: u32, distance: f64) -> Vec<DVec3> {
        let curves = self.curves.take().unwrap_or_else(|| Curves::new(self.facing.surface()));
        let about = self.incidence.faces_at(v as usize).iter().flat_map(|&f| self.mesh.face(f as usize));
        let others = about.filter(|&&w| w != v && self.below[w as usize].is_none()).map(|&w| self.point(w));
        let places = curves.beside(self.point(v), others, distance);
        self.curves = Some(curves);
        places
    }

    fn point(&self, v: u32) -> DVec3 {
        DVec3::from(self.mesh.points[v as usize])
    }

    /// How bad the faces at a vertex are, and the least measure of them.
    fn badness(&self, v: u32) -> (f64, f64) {
        let measures = self.incidence.faces_at(v as usize).iter().map(|&f| self.measure(f));
        measures.fold((0.0, f64::INFINITY), |(bad, least), measure| {
            (bad + (POOR - measure).max(0.0).powi(2), measure.min(least))
        })
    }

    /// The smaller of a face's shape and scaled Jacobian; where a corner looks away from the surface, its area, in squares of
    /// the mean edge, negative.
    fn measure(&self, face: u32) -> f64 {
        let corners = self.mesh.face(face as usize);
        let count = corners.len();
        let mut places = [DVec3::ZERO; 4];
        let mut normals = [DVec3::ZERO; 4];
        if count > 4 {
            return 1.0;
        }
        for (k, &v) in corners.iter().enumerate() {
            places[k] = self.point(v);
            normals[k] = self.below[v as usize].map_or(DVec3::ZERO, |t| self.facing.normal(t));
        }
        let at = |k: usize| places[k % count];
        let across = if count == 4 { at(3) - at(1) } else { at(2) - at(1) };
        let own = (at(2) - at(0)).cross(across);
        let up = normals.iter().sum::<DVec3>().try_normalize().unwrap_or(own.normalize_or_zero());
        let areas = (0..count).map(|k| (at(k + 1) - at(k)).cross(at(k + count - 1) - at(k)).dot(up));
        let least = areas.fold(f64::INFINITY, f64::min);
        if least < 0.0 {
            return least / self.mean_edge.powi(2);
        }
        if self.facing.looks_away(&places[..count], normals[..count].iter().copied()) {
            return -AWAY;
        }
        let frame = self.metric.frame(corners);
        let shown = |k: usize| laid(frame.as_ref(), at(k)).into();
        match count {
            3 => TRIANGLE * triangle_shape([0, 1, 2].map(shown)),
            _ => scaled_jacobian([0, 1, 2, 3].map(|k| at(k).into())).min(quad_shape([0, 1, 2, 3].map(shown))),
        }
    }
}
