//! The one measure that every change of a mesh is judged by.
//!
//! # Theory
//! Lexicographic: first the number of faults (faces that are inverted, concave or without area), then a loss in units of
//! perfect quads. The loss of a face is what its shape lacks, and more below a floor, so that no face is given up for many;
//! a triangle costs a price besides. The loss of a feature edge grows with the distance of its chord from the curve.

use super::metric::{Frame, laid};
use super::orientation::{self, Orientation};
use super::quality::{quad_shape, triangle_shape};
use super::surface_mesh::{Place, SurfaceMesh, walked};
use crate::surface::{Curve, Surface, shared_curves};
use glam::DVec3;
use rayon::prelude::*;
use rustc_hash::FxHashSet;

/// A face of a smaller shape is a fault: its corners lie on one line, or one of them is straight or reflex.
const DEGENERATE: f64 = 0.01;
/// Shapes below this lose more than what they lack.
const FLOOR: f64 = 0.5;
/// A least shape below this rises whatever the loss does.
const POOR: f64 = 0.3;
/// A least shape that rises by less than this is the same.
const RISE: f64 = 1e-3;
/// The further loss at shape 0.
const BELOW_FLOOR: f64 = 3.0;
/// The weight of a triangle's shape, against a quad's.
pub(crate) const TRIANGLE: f64 = 0.5;
/// A triangle is below the floor where so many times its shape is.
const TRIANGLE_FLOOR: f64 = 2.0;
/// The cosine of the largest turn of a face's normal that cannot invert it: 60 degrees.
const TURN: f64 = 0.5;
/// Chords may leave their curve by this at little cost, in edges, ...
const CLOSE: f64 = 0.12;
/// ... the loss for each edge, ...
const CHORD: f64 = 1.5;
/// ... and for the square of what is beyond.
const FAR_CHORD: f64 = 20.0;

/// The loss of a chord that leaves its curve too far.
pub(crate) const FAR_CHORD_LOSS: f64 = CHORD * CLOSE;

/// A surface, and what is asked of it while a mesh on it changes.
pub struct Context<'a> {
    pub(crate) surface: &'a Surface,
    pub(crate) orientation: Orientation<'a>,
    /// Whether several sheets share each feature curve.
    shared: Vec<bool>,
}

impl<'a> Context<'a> {
    /// That of a surface.
    pub fn new(surface: &'a Surface) -> Self {
        Self { surface, orientation: Orientation::new(surface), shared: shared_curves(surface) }
    }

    pub(crate) fn curve(&self, curve: u32) -> &'a Curve {
        &self.surface.features().curves()[curve as usize]
    }

    /// The ends of the curves that several sheets share: the mesh may branch there too.
    pub(crate) fn tips_of_shared_curves(&self) -> FxHashSet<u32> {
        let curves = self.surface.features().curves().iter().zip(&self.shared).filter(|(_, shared)| **shared);
        curves.flat_map(|(curve, _)| [curve.vertices[0], curve.vertices[curve.vertices.len() - 1]]).collect()
    }

    /// Whether several sheets share a curve.
    pub(crate) fn is_shared(&self, curve: u32) -> bool {
        self.shared[curve as usize]
    }
}

/// The value of some faces and edges: fewer faults are better, then a larger least shape below the floor, then less loss.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Score {
    /// The number of faults.
    pub faults: u32,
    /// The least shape, no more than that of a poor face.
    pub least: f64,
    /// In perfect quads.
    pub loss: f64,
}

impl Score {
    /// Whether this is better than another; by more than a margin, where it is the loss that decides.
    pub(crate) fn beats(&self, other: &Self, margin: f64) -> bool {
        let (faults, least) = (self.faults.cmp(&other.faults), self.least - other.least);
        let rises = least > RISE;
        faults.is_lt() || (faults.is_eq() && (rises || (least >= 0.0 && self.loss < other.loss - margin)))
    }
}

impl Default for Score {
    fn default() -> Self {
        Self { faults: 0, least: POOR, loss: 0.0 }
    }
}

impl std::iter::Sum for Score {
    fn sum<I: Iterator<Item = Self>>(scores: I) -> Self {
        scores.fold(Self::default(), |sum, score| Self {
            faults: sum.faults + score.faults,
            least: sum.least.min(score.least),
            loss: sum.loss + score.loss,
        })
    }
}

/// What is known of a face.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Measure {
    /// Qg of a quad, Tg of a triangle, 1 of a larger face.
    pub shape: f64,
    /// Whether it is a fault.
    pub is_fault: bool,
    /// Twice its vector area.
    pub normal: DVec3,
    corners: u8,
}

impl Measure {
    /// Measures a face by its corners. `frame` is that of its metric. `before` is what the face was a small change ago: where
    /// its normal turns by less than 60 degrees, it keeps its orientation. `inverted` tells it where that is unknown.
    pub(crate) fn of(
        corners: &[DVec3],
        frame: Option<&Frame>,
        before: Option<&Self>,
        inverted: impl FnOnce() -> bool,
    ) -> Self {
        let shape = shape(corners, frame);
        let normal = orientation::normal(corners);
        let keeps = |before: &Self| {
            !before.is_fault && before.normal.dot(normal) > TURN * (before.normal.length() * normal.length())
        };
        let is_fault = shape < DEGENERATE || !(before.is_some_and(keeps) || !inverted());
        Self { shape, is_fault, normal, corners: corners.len() as u8 }
    }

    /// The score of the face where a triangle costs a price.
    pub(crate) fn score(&self, triangle_price: f64) -> Score {
        let below = |shape: f64| BELOW_FLOOR * ((FLOOR - shape).max(0.0) / FLOOR).powi(2);
        let loss = match self.corners {
            0..=3 => triangle_price + TRIANGLE * (1.0 - self.shape) + below(TRIANGLE_FLOOR * self.shape),
            _ => 1.0 - self.shape + below(self.shape),
        };
        Score { faults: u32::from(self.is_fault), least: self.least().min(POOR), loss }
    }

    /// The shape of a quad; a triangle has one only where it is thin.
    pub(crate) fn least(&self) -> f64 {
        if self.corners == 3 { (self.shape / THIN).min(1.0) } else { self.shape }
    }
}

/// A triangle of a smaller shape is worse than a good quad.
const THIN: f64 = 0.3;

/// The shape of a face in a metric: Qg or Tg; 1 for larger faces.
pub(crate) fn shape(corners: &[DVec3], frame: Option<&Frame>) -> f64 {
    let at = |p: DVec3| laid(frame, p).to_array();
    match *corners {
        [a, b, c] => triangle_shape([a, b, c].map(at)),
        [a, b, c, d] => quad_shape([a, b, c, d].map(at)),
        _ => 1.0,
    }
}

/// The loss of a feature edge whose curve leaves its chord by a distance, in edges.
pub(crate) fn chord_loss(distance: f64) -> f64 {
    CHORD * distance + FAR_CHORD * (distance - CLOSE).max(0.0).powi(2)
}

impl SurfaceMesh {
    /// The measure of a face as it is.
    pub(crate) fn measure(&self, context: &Context, face: u32) -> Measure {
        let corners = self.face(face);
        let points: Vec<DVec3> = corners.iter().map(|&v| self.point(v)).collect();
        let frame = self.metric().frame(corners);
        Measure::of(&points, frame.as_ref(), None, || {
            context.orientation.is_inverted(&points, corners.iter().map(|&v| self.vertex(v).triangles))
        })
    }

    /// Whether a face points against the triangles of the surface that are nearest to it, whatever sheet it is made for.
    pub(crate) fn points_against_nearest(&self, context: &Context, face: u32) -> bool {
        let corners = self.face(face);
        let points: Vec<DVec3> = corners.iter().map(|&v| self.point(v)).collect();
        let (normal, middle) = (orientation::normal(&points), orientation::middle(&points));
        // The place below the middle on the face's own sheet tells how far there is to look.
        let Some(&v) = corners.iter().find(|&&v| self.vertex(v).is_free()) else {
            return context.orientation.nearest_sheets(normal, middle).are_opposed;
        };
        let below = walked(context.surface, self.vertex(v).triangles[0], self.point(v), middle);
        context.orientation.opposes_nearest(normal, middle, below.point.distance(middle))
    }

    /// The faces that are inverted, concave or without area.
    pub fn faults(&self, context: &Context) -> Vec<u32> {
        let is_fault = |&face: &u32| !self.face(face).is_empty() && self.measure(context, face).is_fault;
        (0..self.face_bound() as u32).into_par_iter().with_min_len(1024).filter(is_fault).collect()
    }

    /// The arc length of a vertex on a curve, as near as may be to another one: a corner may be both ends of it.
    pub(crate) fn arc(&self, context: &Context, v: u32, curve: u32, near: f64) -> Option<f64> {
        let vertex = self.vertex(v);
        match vertex.place {
            Place::OnCurve { curve: own, s } if own == curve => Some(s),
            Place::Corner => {
                let line = context.curve(curve);
                let ends = [0.0, line.length()];
                let at = |s: f64| line.point(context.surface, s).distance_squared(vertex.point);
                let [first, last] = ends.map(at);
                let least = first.min(last);
                let same = ends.into_iter().zip([first, last]).filter(|(_, off)| *off <= least + SAME_POINT);
                same.map(|(s, _)| s).min_by(|a, b| (a - near).abs().total_cmp(&(b - near).abs()))
            }
            _ => None,
        }
    }
}

impl SurfaceMesh {
    /// The arc lengths of two neighbours on a curve; on a closed one the second may be beyond its ends.
    pub(crate) fn arcs(&self, context: &Context, [a, b]: [u32; 2], curve: u32) -> Option<[f64; 2]> {
        let line = context.curve(curve);
        let own = |v: u32| match self.vertex(v).place {
            Place::OnCurve { s, .. } => s,
            _ => 0.0,
        };
        let from = self.arc(context, a, curve, own(b))?;
        let to = self.arc(context, b, curve, from)?;
        let way = line.ways(from, to).min_by(|x, y| x.abs().total_cmp(&y.abs()))?;
        Some([from, from + way])
    }
}

/// Squared unit-sized distance of points that are the same but for roundings.
const SAME_POINT: f64 = 1e-12;
