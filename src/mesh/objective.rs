//! The objective of all changes of a mesh: of its connectivity and of its vertices.
//!
//! # Theory
//! The objective is lexicographic. The number of faults counts first: faces that are inverted, concave or without area. Then
//! counts the least shape, up to that of a poor face, and then a loss in units of perfect quads. The loss of a face is 1 less its
//! shape, and more below a floor, so that one bad face outweighs many slightly worse ones. A triangle has a price besides. The
//! loss of a feature edge grows with the distance of its chord from the curve.
//!
//! # Practice
//! Compare two [`Score`]s of the same part of a mesh, before a change and after it, by [`Score::beats`].

use super::metric::{MetricMap, to_metric};
use super::orientation::{self, Orientation};
use super::quality::{quad_shape, scaled_jacobian, triangle_shape};
use super::sheet_tree::Standing;
use super::surface_mesh::SurfaceMesh;
use super::vertex::Place;
use crate::progress::Progress;
use crate::surface::{Curve, Surface, shared_curves};
use glam::DVec3;
use rayon::prelude::*;
use rustc_hash::FxHashSet;

/// A face with a corner of a smaller sine is a fault: it is straight or reflex, or the corners lie on one line. A thin rectangle is
/// none.
const DEGENERATE: f64 = 0.01;
/// Faces of a larger shape have no such corner.
const SOUND: f64 = 0.05;
/// The floor: a smaller shape has a further loss.
pub(crate) const FLOOR: f64 = 0.5;
/// A face of a smaller shape is poor: the least shape counts before the loss.
pub(crate) const POOR: f64 = 0.3;
/// Least shapes that differ by less are equal.
const LEAST_RISE: f64 = 1e-3;
/// The further loss at shape 0.
const BELOW_FLOOR: f64 = 3.0;
/// The weight of a triangle's shape; a quad's is 1.
pub(crate) const TRIANGLE_WEIGHT: f64 = 0.5;
/// A triangle's shape times this is compared with the floor.
const TRIANGLE_FLOOR_FACTOR: f64 = 2.0;
/// A triangle of a smaller shape is worse than a good quad.
const THIN_TRIANGLE: f64 = 0.3;
/// The cosine of the largest turn of a face's normal that cannot invert it: 60 degrees.
const TURN_COSINE: f64 = 0.5;
/// The tolerated distance of a chord from its curve, in edges.
const CHORD_TOLERANCE: f64 = 0.12;
/// The loss for each edge of that distance.
const CHORD_LOSS: f64 = 1.5;
/// The loss for the squared distance beyond the tolerance.
const EXCESS_CHORD_LOSS: f64 = 20.0;

/// The distance, in edges, within which the mending of a face changes others.
const MENDING_DISTANCE: f64 = 4.0;
/// The loss of a chord at the tolerated distance.
pub(crate) const TOLERATED_CHORD_LOSS: f64 = CHORD_LOSS * CHORD_TOLERANCE;

/// A surface, with what changes of a mesh on it need to know.
pub struct Context<'a> {
    pub(crate) surface: &'a Surface,
    pub(crate) orientation: Orientation<'a>,
    /// Whether several sheets share each feature curve.
    shared: Vec<bool>,
    progress: Option<&'a Progress<'a>>,
}

impl<'a> Context<'a> {
    /// From now on the triangles nearest to a face decide whether it is inverted, whatever sheet it was made on, about these faces and
    /// those that their mending can change.
    pub(crate) fn let_nearest_decide(&mut self, mesh: &SurfaceMesh, faces: &[u32]) {
        let corners = || faces.iter().map(|&face| mesh.face(face));
        let middle = |face: &[u32]| orientation::middle(&face.iter().map(|&v| mesh.point(v)).collect::<Vec<DVec3>>());
        let longest = corners().flatten().map(|&v| mesh.mean_edge_at(v)).fold(0.0, f64::max);
        self.orientation.let_nearest_decide(corners().map(middle), MENDING_DISTANCE * longest);
    }

    /// From now on the triangles as they were given count where the nearest ones decide.
    pub(crate) fn regard_given(&mut self) {
        self.orientation.regard_given();
    }

    /// The context of a surface.
    pub fn new(surface: &'a Surface) -> Self {
        Self { surface, orientation: Orientation::new(surface), shared: shared_curves(surface), progress: None }
    }

    /// The same context for a run that may be cancelled.
    pub(crate) fn watched(self, progress: &'a Progress<'a>) -> Self {
        Self { progress: Some(progress), ..self }
    }

    /// Whether the run is cancelled: loops over the mesh end then.
    pub(crate) fn is_cancelled(&self) -> bool {
        self.progress.is_some_and(Progress::is_cancelled)
    }

    pub(crate) fn curve(&self, curve: u32) -> &'a Curve {
        &self.surface.features().curves()[curve as usize]
    }

    /// The ends of the curves that several sheets share, as vertices of the surface. The mesh may branch there.
    pub(crate) fn ends_of_shared_curves(&self) -> FxHashSet<u32> {
        let curves = self.surface.features().curves().iter().zip(&self.shared).filter(|(_, shared)| **shared);
        curves.flat_map(|(curve, _)| [curve.vertices[0], curve.vertices[curve.vertices.len() - 1]]).collect()
    }

    /// Whether several sheets share a curve.
    pub(crate) fn is_shared(&self, curve: u32) -> bool {
        self.shared[curve as usize]
    }
}

/// The objective of some faces and edges: fewer faults are better, then a larger least shape, then a smaller loss.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Score {
    /// The number of faults.
    pub faults: u32,
    /// The least shape; at most [`POOR`].
    pub least: f64,
    /// The loss, in perfect quads.
    pub loss: f64,
}

impl Score {
    /// Whether this is better than another score. The losses must differ by more than a margin.
    pub(crate) fn beats(&self, other: &Self, margin: f64) -> bool {
        let (faults, least) = (self.faults.cmp(&other.faults), self.least - other.least);
        let rises = least > LEAST_RISE;
        faults.is_lt() || (faults.is_eq() && (rises || (least >= 0.0 && self.loss < other.loss - margin)))
    }

    /// Whether a sum of this and further scores can [beat](Self::beats) another score.
    pub(crate) fn can_beat(&self, other: &Self, margin: f64) -> bool {
        let (faults, least) = (self.faults.cmp(&other.faults), self.least - other.least);
        faults.is_lt() || (faults.is_eq() && (least > LEAST_RISE || (least >= 0.0 && self.loss < other.loss - margin)))
    }

    /// The score of the faces and edges of both.
    pub(crate) fn plus(&self, other: &Self) -> Self {
        Self { faults: self.faults + other.faults, least: self.least.min(other.least), loss: self.loss + other.loss }
    }
}

impl Default for Score {
    fn default() -> Self {
        Self { faults: 0, least: POOR, loss: 0.0 }
    }
}

impl std::iter::Sum for Score {
    fn sum<I: Iterator<Item = Self>>(scores: I) -> Self {
        scores.fold(Self::default(), |sum, score| sum.plus(&score))
    }
}

/// The measure of a face.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Measure {
    /// Qg of a quad, Tg of a triangle, 1 of a larger face.
    pub shape: f64,
    /// Whether it is inverted, concave or without area.
    pub is_fault: bool,
    /// Twice its vector area.
    pub normal: DVec3,
    corners: u8,
}

impl Measure {
    /// Measures a face by its corners, under a map of its metric. `before` is its measure before a small change: a face whose
    /// normal turns by less than 60 degrees keeps its orientation. `inverted` tests the orientation where it is unknown.
    pub(crate) fn of(
        corners: &[DVec3],
        map: Option<&MetricMap>,
        before: Option<&Self>,
        inverted: impl FnOnce() -> bool,
    ) -> Self {
        let shape = shape(corners, map);
        let normal = orientation::normal(corners);
        let keeps = |before: &Self| {
            !before.is_fault && before.normal.dot(normal) > TURN_COSINE * (before.normal.length() * normal.length())
        };
        let is_degenerate = shape < SOUND && least_sine(corners, map) < DEGENERATE;
        let is_fault = is_degenerate || (!before.is_some_and(keeps) && inverted());
        Self { shape, is_fault, normal, corners: corners.len() as u8 }
    }

    /// The shape of the face, 0 where it is a fault.
    pub(crate) fn shape_unless_fault(&self) -> f64 {
        if self.is_fault { 0.0 } else { self.shape }
    }

    /// The score of the face; a triangle has a price.
    pub(crate) fn score(&self, triangle_price: f64) -> Score {
        let below = |shape: f64| BELOW_FLOOR * ((FLOOR - shape).max(0.0) / FLOOR).powi(2);
        let loss = match self.corners {
            0..=3 => triangle_price + TRIANGLE_WEIGHT * (1.0 - self.shape) + below(TRIANGLE_FLOOR_FACTOR * self.shape),
            _ => 1.0 - self.shape + below(self.shape),
        };
        Score { faults: u32::from(self.is_fault), least: self.least().min(POOR), loss }
    }

    /// The shape of a quad or of a thin triangle, scaled to 1 at [`THIN_TRIANGLE`]; 1 for other triangles.
    pub(crate) fn least(&self) -> f64 {
        if self.corners == 3 { (self.shape / THIN_TRIANGLE).min(1.0) } else { self.shape }
    }
}

/// The shape of a face under a map of its metric: Qg or Tg; 1 for larger faces.
pub(crate) fn shape(corners: &[DVec3], map: Option<&MetricMap>) -> f64 {
    let at = |p: DVec3| to_metric(map, p).to_array();
    match *corners {
        [a, b, c] => triangle_shape([a, b, c].map(at)),
        [a, b, c, d] => quad_shape([a, b, c, d].map(at)),
        _ => 1.0,
    }
}

/// The least sine of a quad's corners, negative where one is reflex, or the sine of a triangle's largest corner; 1 for larger faces.
fn least_sine(corners: &[DVec3], map: Option<&MetricMap>) -> f64 {
    let at = |p: DVec3| to_metric(map, p);
    match *corners {
        [a, b, c] => {
            let [a, b, c] = [a, b, c].map(at);
            let sides = [b - a, c - b, a - c];
            let squared = sides.map(|side| side.length_squared());
            // The largest corner lies between the two shorter sides.
            let longest = squared.into_iter().fold(0.0, f64::max);
            let product = squared.into_iter().product::<f64>() / longest.max(f64::MIN_POSITIVE);
            if product > 0.0 { sides[0].cross(sides[1]).length() / product.sqrt() } else { 0.0 }
        }
        [a, b, c, d] => scaled_jacobian([a, b, c, d].map(|p| at(p).to_array())),
        _ => 1.0,
    }
}

/// The loss of a feature edge at a distance of its chord from the curve, in edges.
pub(crate) fn chord_loss(distance: f64) -> f64 {
    CHORD_LOSS * distance + EXCESS_CHORD_LOSS * (distance - CHORD_TOLERANCE).max(0.0).powi(2)
}

impl SurfaceMesh {
    /// The measure of a face.
    pub(crate) fn measure(&self, context: &Context, face: u32) -> Measure {
        let corners = self.face(face);
        let points: Vec<DVec3> = corners.iter().map(|&v| self.point(v)).collect();
        let map = self.metric().map_of(corners);
        Measure::of(&points, map.as_ref(), None, || {
            context.orientation.is_inverted(&points, corners.iter().map(|&v| self.vertex(v).triangles))
        })
    }

    /// The faces that the triangles nearest to their middles point against: of all sheets, those that were given, once they are
    /// [regarded](Context::regard_given).
    pub(crate) fn opposed_faces(&self, context: &Context) -> Vec<u32> {
        let opposed = self.faces_not_along(context).into_iter().filter(|(_, standing)| *standing == Standing::Against);
        opposed.map(|(face, _)| face).collect()
    }

    /// The same faces, and those that stand perpendicular on these triangles.
    pub(crate) fn faces_not_along(&self, context: &Context) -> Vec<(u32, Standing)> {
        let is_asked = |&face: &u32| !self.face(face).is_empty() && !context.is_cancelled();
        let all = (0..self.face_bound() as u32).into_par_iter().with_min_len(1024).filter(is_asked);
        all.map(|face| (face, self.standing(context, face)))
            .filter(|(_, standing)| *standing != Standing::Along)
            .collect()
    }

    fn standing(&self, context: &Context, face: u32) -> Standing {
        let corners = self.face(face);
        let points: Vec<DVec3> = corners.iter().map(|&v| self.point(v)).collect();
        context.orientation.standing(&points, corners.iter().map(|&v| self.vertex(v).triangles))
    }

    /// The faces that are inverted, concave or without area.
    pub fn faults(&self, context: &Context) -> Vec<u32> {
        let is_fault = |&face: &u32| !self.face(face).is_empty() && self.measure(context, face).is_fault;
        (0..self.face_bound() as u32).into_par_iter().with_min_len(1024).filter(is_fault).collect()
    }

    /// The arc length of a vertex on a curve; of the two that a corner at both ends has, the one nearer to `near`.
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

    /// The arc lengths of two neighbours on a curve. On a closed curve the second may lie beyond the ends.
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

/// The squared unit-sized distance of points that differ by roundings alone.
const SAME_POINT: f64 = 1e-12;
