//! The worst faces: each vertex of one looks for the place where its faces are least bad.
//!
//! # Theory
//! Smoothing draws vertices to where their faces are nearest to squares on average; a folded face may be stuck there, and a
//! face that is turned over has a good shape. Here what counts is how much the faces at a vertex lack of a measure, squared and
//! summed: the smaller of shape and scaled Jacobian, and where a corner looks away from the surface its area, negative. The
//! vertex tries places about it (a pattern search): on the surface, or, where it lies on a feature curve, along that, between
//! its neighbours there. Corners stay, and so do curves at which sheets meet. The least measure about a vertex never falls,
//! unless faces look away.
//!
//! # Practice
//! Only vertices of faces below 0.3 move, so features are followed as well as before nearly everywhere. With a limit of 0.5 Qg
//! of plane at 6,000 points fell by 0.005, with this one by 0.001 to 0.002. A fold of several faces may stay: each of their
//! vertices alone finds no better place.

use super::metric::laid;
use super::quality::{quad_shape, scaled_jacobian, triangle_shape};
use super::smooth::{Incidence, Smoothed};
use super::{Mesh, Metric};
use crate::surface::nearest::nearest_on_segment;
use crate::surface::{Surface, WALK_EDGES, walk};
use glam::DVec3;

/// Faces with a smaller measure are worked on, until they have it.
const POOR: f64 = 0.3;
/// A triangle is as good as a quad of so many times its shape.
const TRIANGLE: f64 = 2.0;
/// Rounds over them.
const ROUNDS: usize = 12;
/// How far a vertex tries to go, in edges.
const STRIDES: [f64; 4] = [0.4, 0.2, 0.08, 0.03];
/// Directions that it tries.
const DIRECTIONS: u32 = 8;
/// A move must make the faces so much better, in squared measures.
const GAIN: f64 = 1e-4;
/// A vertex on a feature curve goes this share of the way to its neighbour there at most.
const NEAREST: f64 = 0.4;
/// How far a vertex on a feature curve may be from it by rounding, unit-sized.
const CLOSE: f64 = 1e-5;

/// Moves vertices of bad faces so that the faces about each become better, their shapes measured in a metric; others stay.
pub fn unfold(metric: &Metric, surface: &Surface, smoothed: &Smoothed) -> Smoothed {
    let Smoothed { mesh, below } = smoothed.clone();
    let incidence = Incidence::new(&mesh);
    let mean_edge = mean_edge(&mesh);
    let mut work = Work { metric, surface, mesh, below, incidence, mean_edge, curves: None };
    for _ in 0..ROUNDS {
        let mut moved = false;
        for v in work.poor() {
            moved |= work.improve(v);
        }
        if !moved {
            break;
        }
    }
    Smoothed { mesh: work.mesh, below: work.below }
}

/// Two triangles in place of each quad that is still concave, cut from its reflex corner.
pub fn split_concave(mesh: Mesh) -> Mesh {
    let corners = |face: &[u32]| -> Option<[[f64; 3]; 4]> {
        let &[a, b, c, d] = face else { return None };
        Some([a, b, c, d].map(|v| mesh.points[v as usize])).filter(|&quad| quad_shape(quad) == 0.0)
    };
    if mesh.faces().all(|face| corners(face).is_none()) {
        return mesh;
    }
    let mut split = Mesh::new(mesh.points.clone());
    for face in mesh.faces() {
        let Some(quad) = corners(face) else {
            split.push_face(face);
            continue;
        };
        let [p, q, r, s] = quad.map(DVec3::from);
        let normal = (r - p).cross(s - q);
        let area = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a).dot(normal);
        let least = |one, other| area(one).min(area(other));
        let first = usize::from(least([p, q, r], [p, r, s]) < least([q, r, s], [q, s, p]));
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| face[(first + k) % 4]);
        split.push_face(&[a, b, c]);
        split.push_face(&[a, c, d]);
    }
    split
}

fn mean_edge(mesh: &Mesh) -> f64 {
    let point = |v: u32| DVec3::from(mesh.points[v as usize]);
    let sides = || mesh.faces().flat_map(|face| face.iter().zip(face.iter().cycle().skip(1)));
    sides().map(|(&a, &b)| point(a).distance(point(b))).sum::<f64>() / sides().count().max(1) as f64
}

struct Work<'a> {
    metric: &'a Metric,
    surface: &'a Surface,
    mesh: Mesh,
    below: Vec<Option<u32>>,
    incidence: Incidence,
    mean_edge: f64,
    /// The surface's feature curves, once they are asked for.
    curves: Option<Vec<Polyline>>,
}

impl Work<'_> {
    /// The vertices of poor faces, in order.
    fn poor(&self) -> Vec<u32> {
        let is_poor = |f: &usize| self.measure(*f as u32) < POOR;
        let mut poor: Vec<u32> =
            (0..self.mesh.face_count()).filter(is_poor).flat_map(|f| self.mesh.face(f)).copied().collect();
        poor.sort_unstable();
        poor.dedup();
        poor
    }

    /// Moves a vertex to the best of the places about it, if one is better than its own.
    fn improve(&mut self, v: u32) -> bool {
        let here = self.point(v);
        let edge = self.edge(v);
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
        let surface = self.surface;
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
        let here = self.point(v);
        let curves = self.curves.take().unwrap_or_else(|| polylines(self.surface));
        let found = curves.iter().find_map(|curve| Some((curve, curve.locate(here)?)));
        let places = found.map_or(Vec::new(), |(curve, at)| {
            let faces = self.incidence.faces_at(v as usize).iter().flat_map(|&f| self.mesh.face(f as usize));
            let others = faces.filter(|&&w| w != v && self.below[w as usize].is_none());
            let ways = others.filter_map(|&w| Some(curve.way(at, curve.locate(self.point(w))?)));
            let (mut before, mut after) = (0.0_f64, 0.0_f64);
            for way in ways.flatten() {
                let nearest = if way < 0.0 { &mut before } else { &mut after };
                if *nearest == 0.0 || way.abs() < nearest.abs() {
                    *nearest = way;
                }
            }
            if curve.is_end(at) || before == 0.0 || after == 0.0 {
                return Vec::new();
            }
            let steps = [(-distance).max(NEAREST * before), distance.min(NEAREST * after)];
            steps.map(|step| curve.at(at + step)).to_vec()
        });
        self.curves = Some(curves);
        places
    }

    fn point(&self, v: u32) -> DVec3 {
        DVec3::from(self.mesh.points[v as usize])
    }

    /// The mean length of the sides that begin at a vertex.
    fn edge(&self, v: u32) -> f64 {
        let faces = self.incidence.faces_at(v as usize);
        let sides = faces.iter().map(|&f| {
            let face = self.mesh.face(f as usize);
            let next = face.iter().position(|&w| w == v).map_or(0, |k| (k + 1) % face.len());
            self.point(v).distance(self.point(face[next]))
        });
        sides.sum::<f64>() / faces.len().max(1) as f64
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
        let places: Vec<[f64; 3]> = corners.iter().map(|&v| self.mesh.points[v as usize]).collect();
        let at = |k: usize| DVec3::from(places[k % count]);
        let frame = self.metric.frame(corners);
        let shown = |place: [f64; 3]| laid(frame.as_ref(), place.into()).into();
        let value = match *places {
            [a, b, c] => TRIANGLE * triangle_shape([a, b, c].map(shown)),
            [a, b, c, d] => scaled_jacobian([a, b, c, d]).min(quad_shape([a, b, c, d].map(shown))),
            _ => return 1.0,
        };
        let normals =
            corners.iter().filter_map(|&v| Some(self.surface.normal(self.below[v as usize]? as usize).as_dvec3()));
        let across = if count == 4 { at(3) - at(1) } else { at(2) - at(1) };
        let own = (at(2) - at(0)).cross(across);
        let up = normals.sum::<DVec3>().try_normalize().unwrap_or(own.normalize_or_zero());
        let areas = (0..count).map(|k| (at(k + 1) - at(k)).cross(at(k + count - 1) - at(k)).dot(up));
        let least = areas.fold(f64::INFINITY, f64::min);
        if least < 0.0 { least / self.mean_edge.powi(2) } else { value }
    }
}

/// A feature curve of the surface.
struct Polyline {
    points: Vec<DVec3>,
    /// How far each point is along it.
    arcs: Vec<f64>,
    closed: bool,
}

/// The surface's feature curves that only one sheet has.
fn polylines(surface: &Surface) -> Vec<Polyline> {
    let shared = surface.shared_places();
    let curves = surface.features().curves().iter();
    curves
        .filter(|curve| !curve.vertices.iter().any(|&v| shared[v as usize]))
        .map(|curve| {
            let points = curve.vertices.iter().map(|&v| DVec3::from(surface.point(v))).collect();
            Polyline::new(points, curve.closed)
        })
        .collect()
}

impl Polyline {
    fn new(points: Vec<DVec3>, closed: bool) -> Self {
        let mut arcs = vec![0.0];
        for ends in points.windows(2) {
            arcs.push(arcs[arcs.len() - 1] + ends[0].distance(ends[1]));
        }
        Self { points, arcs, closed }
    }

    fn length(&self) -> f64 {
        self.arcs[self.arcs.len() - 1]
    }

    /// How far along the curve a point on it is.
    fn locate(&self, point: DVec3) -> Option<f64> {
        (1..self.points.len())
            .map(|k| {
                let foot = nearest_on_segment(point, self.points[k - 1], self.points[k]);
                (foot.distance(point), self.arcs[k - 1] + foot.distance(self.points[k - 1]))
            })
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .filter(|(distance, _)| *distance < CLOSE)
            .map(|(_, arc)| arc)
    }

    /// Whether a place is at an end of the curve.
    fn is_end(&self, arc: f64) -> bool {
        !self.closed && (arc < CLOSE || arc > self.length() - CLOSE)
    }

    /// The way from one place to another, and round the other way where the curve is closed.
    fn way(&self, from: f64, to: f64) -> Vec<f64> {
        let way = to - from;
        if self.closed { vec![way, way - self.length() * way.signum()] } else { vec![way] }
    }

    /// The point so far along the curve.
    fn at(&self, arc: f64) -> DVec3 {
        let arc = if self.closed { arc.rem_euclid(self.length()) } else { arc.clamp(0.0, self.length()) };
        let k = self.arcs.partition_point(|&passed| passed <= arc).clamp(1, self.arcs.len() - 1);
        let length = self.arcs[k] - self.arcs[k - 1];
        let share = if length > 0.0 { (arc - self.arcs[k - 1]) / length } else { 0.0 };
        self.points[k - 1].lerp(self.points[k], share)
    }
}
