//! The surface's feature curves, for vertices that move along them.

use crate::surface::Surface;
use crate::surface::nearest::nearest_on_segment;
use glam::DVec3;

/// A vertex goes this share of the way to its neighbour on the curve at most.
const NEAREST: f64 = 0.4;
/// The same where it goes to follow its curve better, ...
const FARTHEST: f64 = 0.5;
/// ... and how many places it tries on either side.
const PLACES: u32 = 10;
/// The chords to its neighbours may lose this share of the curve's length: they do where the curve bends between them.
const CUT: f64 = 1e-3;
/// How far a vertex may be from its curve by rounding, unit-sized.
const CLOSE: f64 = 1e-5;
/// Segments that are passed over together where they are far.
const BLOCK: usize = 16;

/// The feature curves that only one sheet has: where sheets meet, vertices have to stay together.
pub(super) struct Curves(Vec<Polyline>);

impl Curves {
    pub(super) fn new(surface: &Surface) -> Self {
        let shared = surface.shared_places();
        let curves = surface.features().curves().iter();
        let alone = curves.filter(|curve| !curve.vertices.iter().any(|&v| shared[v as usize]));
        let points = |vertices: &[u32]| vertices.iter().map(|&v| DVec3::from(surface.point(v))).collect();
        Self(alone.map(|curve| Polyline::new(points(&curve.vertices), curve.closed)).collect())
    }

    /// The places at a distance along the curve of a vertex, before and after it, but not near `others`, the vertices about
    /// it, nor where chords would cut a bend off; none where it has to stay: at the end of a curve, or where no other vertex is on one side.
    pub(super) fn beside(&self, here: DVec3, others: impl Iterator<Item = DVec3>, distance: f64) -> Vec<DVec3> {
        let Some(Between { curve, at, before, after }) = self.between(here, others) else { return Vec::new() };
        let [low, high] = [before, after].map(|way| curve.at(at + way));
        let chords = |place: DVec3| low.distance(place) + place.distance(high);
        let least = chords(here) - CUT * (after - before);
        let steps = [(-distance).max(NEAREST * before), distance.min(NEAREST * after)];
        steps.map(|step| curve.at(at + step)).into_iter().filter(|place| chords(*place) >= least).collect()
    }

    /// A vertex's own place first, then others along its curve, each with how far the curve leaves the chords to the next of
    /// `others` before and after; none where it has to stay.
    pub(super) fn chords(&self, here: DVec3, others: impl Iterator<Item = DVec3>) -> Vec<(DVec3, f64)> {
        let Some(Between { curve, at, before, after }) = self.between(here, others) else { return Vec::new() };
        let off = |step: f64| curve.off(at + before, at + step).max(curve.off(at + step, at + after));
        let steps =
            (1..=PLACES).flat_map(|k| [before, after].map(|way| FARTHEST * way * f64::from(k) / f64::from(PLACES)));
        std::iter::once(0.0).chain(steps).map(|step| (curve.at(at + step), off(step))).collect()
    }

    fn between(&self, here: DVec3, others: impl Iterator<Item = DVec3>) -> Option<Between<'_>> {
        let (curve, at) = self.0.iter().find_map(|curve| Some((curve, curve.locate(here)?)))?;
        let (mut before, mut after) = (0.0_f64, 0.0_f64);
        for way in others.filter_map(|other| Some(curve.way(at, curve.locate(other)?))).flatten() {
            let nearest = if way < 0.0 { &mut before } else { &mut after };
            if *nearest == 0.0 || way.abs() < nearest.abs() {
                *nearest = way;
            }
        }
        (!curve.is_end(at) && before < 0.0 && after > 0.0).then_some(Between { curve, at, before, after })
    }
}

/// A vertex on a curve between two others.
struct Between<'a> {
    curve: &'a Polyline,
    /// How far along the curve it is.
    at: f64,
    /// The ways along it to the others; the first is negative.
    before: f64,
    after: f64,
}

struct Polyline {
    points: Vec<DVec3>,
    /// How far each point is along it.
    arcs: Vec<f64>,
    /// The corners of the box about each block of segments.
    boxes: Vec<[DVec3; 2]>,
    closed: bool,
}

impl Polyline {
    fn new(points: Vec<DVec3>, closed: bool) -> Self {
        let mut arcs = vec![0.0];
        for ends in points.windows(2) {
            arcs.push(arcs[arcs.len() - 1] + ends[0].distance(ends[1]));
        }
        let segments = points.len().saturating_sub(1);
        let boxes = (0..segments).step_by(BLOCK).map(|first| {
            let block = &points[first..=(first + BLOCK).min(segments)];
            block.iter().fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[low, high], &p| [low.min(p), high.max(p)])
        });
        Self { boxes: boxes.collect(), points, arcs, closed }
    }

    fn length(&self) -> f64 {
        self.arcs[self.arcs.len() - 1]
    }

    /// How far along the curve a point on it is.
    fn locate(&self, point: DVec3) -> Option<f64> {
        let near = |[low, high]: [DVec3; 2]| point.cmpge(low - CLOSE).all() && point.cmple(high + CLOSE).all();
        let blocks = (0..self.boxes.len()).filter(|&block| near(self.boxes[block]));
        blocks
            .flat_map(|block| block * BLOCK + 1..((block + 1) * BLOCK + 1).min(self.points.len()))
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

    /// How far the curve between two places is from the chord between them.
    fn off(&self, from: f64, to: f64) -> f64 {
        let [start, end] = [from, to].map(|arc| self.at(arc));
        let rounds: &[f64] = if self.closed { &[-1.0, 0.0, 1.0] } else { &[0.0] };
        let passed = rounds.iter().flat_map(|round| {
            let [first, last] = [from, to].map(|arc| arc - round * self.length());
            let [first, last] = [first, last].map(|arc| self.arcs.partition_point(|&passed| passed <= arc));
            &self.points[first..last]
        });
        passed.map(|&p| nearest_on_segment(p, start, end).distance(p)).fold(0.0, f64::max)
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A square of side 1 whose sides have ten segments each, its first corner the origin.
    fn square(closed: bool) -> Curves {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::X + DVec3::Y, DVec3::Y, DVec3::ZERO];
        let inner = |ends: &[DVec3]| (0..10).map(|k| ends[0].lerp(ends[1], f64::from(k) / 10.0)).collect::<Vec<_>>();
        let mut points: Vec<DVec3> = corners.windows(2).flat_map(inner).collect();
        points.push(corners[4]);
        Curves(vec![Polyline::new(points, closed)])
    }

    #[test]
    fn a_vertex_steps_along_its_curve_but_not_round_bends_and_not_past_its_neighbours() {
        let here = DVec3::new(1.0, 0.25, 0.0);
        let others = || [DVec3::new(1.0, 0.05, 0.0), DVec3::new(1.0, 0.35, 0.0), DVec3::splat(0.5)].into_iter();
        let places = square(true).beside(here, others(), 0.05);
        assert!(places[0].distance(DVec3::new(1.0, 0.2, 0.0)) < 1e-12, "{places:?}");
        assert!(places[1].distance(DVec3::new(1.0, 0.29, 0.0)) < 1e-12, "two fifths of the way at most: {places:?}");
        let places = square(true).beside(DVec3::X, [DVec3::ZERO, DVec3::X + DVec3::Y].into_iter(), 0.1);
        assert!(places.is_empty(), "not round the bend: {places:?}");
        assert!(square(true).beside(here, others().skip(2), 0.1).is_empty(), "none on either side");
        assert!(square(true).beside(here + DVec3::Z * 0.01, others(), 0.1).is_empty(), "beside the curve");
    }

    #[test]
    fn chords_tell_how_far_they_leave_the_curve() {
        let here = DVec3::new(1.0, 0.3, 0.0);
        let others = || [DVec3::X * 0.7, DVec3::new(1.0, 0.9, 0.0)].into_iter();
        let places = square(true).chords(here, others());
        // The chord to the one before cuts the corner off, which lies as far from it as the height of the triangle.
        let height = 0.3 * 0.3 / (0.3_f64 * 0.3 + 0.3 * 0.3).sqrt();
        assert!(places[0].0 == here && (places[0].1 - height).abs() < 1e-12, "{places:?}");
        let best = places.iter().min_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
        assert!(best.0.distance(DVec3::X) < 1e-9 && best.1 < 1e-9, "at the corner nothing is left: {best:?}");
        assert!(square(true).chords(here + DVec3::Z * 0.01, others()).is_empty(), "beside the curve");
        // Past the first point of a closed curve.
        let places = square(true).chords(DVec3::X * 0.2, [DVec3::X * 0.5, DVec3::Y * 0.2].into_iter());
        assert!((places[0].1 - 0.2 / 2f64.sqrt()).abs() < 1e-12, "{places:?}");
        assert!(square(false).chords(DVec3::ZERO, others()).is_empty(), "the end of an open one");
    }

    #[test]
    fn a_closed_curve_goes_on_past_its_first_point_and_an_open_one_ends_there() {
        let (here, others) = (DVec3::X * 0.02, || [DVec3::X * 0.3, DVec3::Y * 0.01].into_iter());
        let places = square(true).beside(here, others(), 0.1);
        assert!(places.len() == 1 && places[0].distance(DVec3::X * 0.008) < 1e-12, "{places:?}");
        assert!(square(false).beside(here, others(), 0.1).is_empty());
    }
}
