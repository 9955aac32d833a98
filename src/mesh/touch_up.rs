//! The last touch: each vertex of an imperfect face goes to the place where the sum of its faces' shapes is greatest.
//!
//! # Theory
//! Smoothing draws vertices to the mean of what their faces want, which is the best place for faces that are nearly squares.
//! About irregular vertices it is not: there a vertex tries the eight directions in its tangent plane (a pattern search), and
//! one on a feature curve both ways along it. A move is kept where the sum of the shapes rises on the surface itself and the
//! least of them does not fall, or not below a floor.
//!
//! # Practice
//! At 6,000 points Qg of anchor rises from 0.951 to 0.955, of plane from 0.908 to 0.914, of fandisk and spot by 0.002; of the
//! gain on anchor half is the feature vertices'. Faces of a shape up to 0.9 instead of 0.8 add 0.001 in twice the time.

use super::curves::Curves;
use super::smooth::{Smoothed, Standing, colours};
use super::{Mesh, Metric};
use crate::surface::{Surface, WALK_EDGES, walk};
use glam::DVec3;
use rayon::prelude::*;

/// Faces of a smaller shape are imperfect.
const IMPERFECT: f64 = 0.8;
/// Rounds over them.
const ROUNDS: usize = 4;
/// How far a vertex tries to go, in edges.
const STRIDES: [f64; 4] = [0.2, 0.1, 0.05, 0.025];
/// Directions that it tries.
const DIRECTIONS: u32 = 8;
/// A move must add so much to the sum of shapes.
const GAIN: f64 = 1e-3;
/// Shapes above this may fall to it for the good of others.
const FLOOR: f64 = 0.5;

/// Where a vertex goes, and the triangle of the surface below; `None` on features.
type Place = (DVec3, Option<u32>);

/// Moves the vertices of imperfect faces; shapes are measured in a metric.
pub fn touch_up(metric: &Metric, surface: &Surface, smoothed: &Smoothed) -> Smoothed {
    let mut result = smoothed.clone();
    let mut standing = Standing::new(metric, &result.mesh);
    let curves = Curves::new(surface);
    for _ in 0..ROUNDS {
        let imperfect = imperfect(&result.mesh, &standing);
        if imperfect.is_empty() {
            break;
        }
        for colour in colours(&result.mesh, &standing.incidence, imperfect.into_iter()) {
            let scene = Scene { surface, curves: &curves, smoothed: &result, standing: &standing };
            let moves: Vec<(u32, Place)> =
                colour.par_iter().with_min_len(32).filter_map(|&v| Some((v, scene.better(v)?))).collect();
            for &(v, (place, below)) in &moves {
                result.mesh.points[v as usize] = place.into();
                result.below[v as usize] = below;
            }
            let moved: Vec<u32> = moves.iter().map(|&(v, _)| v).collect();
            standing.update(&result.mesh, &colour, &moved);
        }
    }
    result
}

/// The vertices of imperfect faces that have to look for their places, in order.
fn imperfect(mesh: &Mesh, standing: &Standing) -> Vec<usize> {
    let faces = (0..mesh.face_count()).filter(|&f| standing.shapes[f] < IMPERFECT);
    let mut vertices: Vec<usize> = faces.flat_map(|f| mesh.face(f)).map(|&v| v as usize).collect();
    vertices.retain(|&v| standing.waiting[v]);
    vertices.sort_unstable();
    vertices.dedup();
    vertices
}

struct Scene<'a> {
    surface: &'a Surface,
    curves: &'a Curves,
    smoothed: &'a Smoothed,
    standing: &'a Standing,
}

impl Scene<'_> {
    /// The best place found about a vertex, if it is better than its own.
    fn better(&self, v: u32) -> Option<Place> {
        let own = (self.point(v), self.smoothed.below[v as usize]);
        let edge = self.standing.incidence.edge(&self.smoothed.mesh, v);
        let mesh = &self.smoothed.mesh;
        let (least, mut sum) = self.judge(v);
        let mut best = own;
        for stride in STRIDES {
            let sum_at = |place| self.standing.judge_at(mesh, v, place).1;
            let tried = self.places(v, best, stride * edge).into_iter().map(|place| (sum_at(place), place));
            let Some((_, place)) = tried.max_by(|a, b| a.0.total_cmp(&b.0)).filter(|(hope, _)| *hope > sum + GAIN)
            else {
                continue;
            };
            let (place, below) = self.laid(best, place);
            let (new_least, new_sum) = self.judge_at(v, place);
            if new_sum > sum + GAIN && new_least >= least.min(FLOOR) {
                (sum, best) = (new_sum, (place, below));
            }
        }
        (best.0 != own.0).then_some(best)
    }

    /// The places at a distance that a vertex may go to: in the tangent plane, or on its feature curve.
    fn places(&self, v: u32, (here, below): Place, distance: f64) -> Vec<DVec3> {
        let Some(triangle) = below else {
            let is_fixed = |w: u32| self.smoothed.below[w as usize].is_none();
            let about =
                self.standing.incidence.faces_at(v as usize).iter().flat_map(|&f| self.smoothed.mesh.face(f as usize));
            let others = about.filter(|&&w| w != v && is_fixed(w)).map(|&w| self.point(w));
            return self.curves.beside(here, others, distance);
        };
        let (across, along) = self.surface.normal(triangle as usize).as_dvec3().any_orthonormal_pair();
        (0..DIRECTIONS)
            .map(|k| {
                let (s, c) = (f64::from(k) * std::f64::consts::TAU / f64::from(DIRECTIONS)).sin_cos();
                here + (across * c + along * s) * distance
            })
            .collect()
    }

    /// A place near one on the surface, laid on it by a walk; on a feature curve it is there already.
    fn laid(&self, (here, below): Place, place: DVec3) -> Place {
        let Some(triangle) = below else { return (place, None) };
        let barrier = |h| self.surface.features().is_feature(h);
        let foot = walk(self.surface, barrier, triangle, here.as_vec3(), (place - here).as_vec3(), WALK_EDGES);
        (foot.position.as_dvec3(), Some(foot.triangle))
    }

    /// The least shape at a vertex, and the sum; the least is none where a face looks away from the surface.
    fn judge(&self, v: u32) -> (f64, f64) {
        let (least, sum) = self.standing.judge(&self.smoothed.mesh, v);
        (if self.is_turned(v, self.point(v)) { 0.0 } else { least }, sum)
    }

    /// The same if the vertex were at a place.
    fn judge_at(&self, v: u32, place: DVec3) -> (f64, f64) {
        let (least, sum) = self.standing.judge_at(&self.smoothed.mesh, v, place);
        (if self.is_turned(v, place) { 0.0 } else { least }, sum)
    }

    fn is_turned(&self, v: u32, place: DVec3) -> bool {
        self.standing.incidence.faces_at(v as usize).iter().any(|&f| self.looks_away(f, v, place))
    }

    /// Whether a face, one of its vertices at a place, lies upside down; not where all of its vertices are on features.
    fn looks_away(&self, face: u32, v: u32, place: DVec3) -> bool {
        let corners = self.smoothed.mesh.face(face as usize);
        let below = |&w: &u32| self.smoothed.below[w as usize];
        let up: DVec3 = corners.iter().filter_map(below).map(|t| self.surface.normal(t as usize).as_dvec3()).sum();
        let at = |w: u32| if w == v { place } else { self.point(w) };
        let first = at(corners[0]);
        let sides = corners.windows(2).skip(1).map(|pair| (at(pair[0]) - first).cross(at(pair[1]) - first));
        sides.sum::<DVec3>().dot(up) < 0.0
    }

    fn point(&self, v: u32) -> DVec3 {
        DVec3::from(self.smoothed.mesh.points[v as usize])
    }
}
