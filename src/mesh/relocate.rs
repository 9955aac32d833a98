//! Relocation: vertices move along the surface, the connectivity stays.
//!
//! # Theory
//! Each face has a best-fitting regular polygon about its centre. Shape matching moves a vertex towards the mean of its
//! corners in the polygons of its faces. Where a face is poor, a pattern search follows: the vertex tries displacements in
//! several directions, of decreasing lengths. A free vertex moves over the surface, a vertex on a feature curve moves along it
//! between its neighbours on the curve, and a corner stays. A move is made where the objective of the faces
//! and feature edges at the vertex improves.
//!
//! Vertices that share no face move at the same time: a greedy colouring in the order of the vertices gives the sets, so the
//! result does not depend on the number of threads. A vertex is visited again once one of its faces has changed.
//! Where the nearest triangles decide, no move makes a face oppose them.
//!
//! # Changes versus the paper
//! The paper does not move vertices.
//!
//! # Practice
//! With 0 passes the vertices stay at the centres of the tiles, as in the paper. The connectivity should be final first: after an
//! edit, relocate again.

use super::metric::{MetricMap, from_metric, to_metric};
use super::objective::{Context, FLOOR, Measure, POOR, Score, TOLERATED_CHORD_LOSS, TRIANGLE_WEIGHT, chord_loss};
use super::orientation::middle;
use super::surface_mesh::SurfaceMesh;
use super::vertex::{Place, Position, walked};
use crate::surface::NONE;
use glam::DVec3;
use rayon::prelude::*;

/// The shares of the displacement of shape matching that a vertex tries, one after the other.
const STEP_SHARES: [f64; 2] = [0.9, 0.4];
/// The weight of a face below the floor in shape matching.
const BELOW_FLOOR_WEIGHT: f64 = 3.0;
/// A vertex stays where its displacement is a smaller share of an edge.
const LEAST_DISPLACEMENT: f64 = 1e-3;
/// A face of a smaller shape is imperfect: its vertices search after the passes.
const IMPERFECT: f64 = 0.8;
/// Rounds of the search over the vertices of imperfect faces.
const ROUNDS: usize = 4;
/// The most rounds of the search over the vertices of poor faces that follow.
const POOR_ROUNDS: usize = 8;
/// The displacements of a search, in edges.
const DISPLACEMENTS: [f64; 5] = [0.4, 0.2, 0.1, 0.05, 0.025];
/// The number of directions in which a free vertex searches.
const DIRECTIONS: u32 = 8;
/// The cosine of the angle between a face and a sheet from which on these are opposed: 120 degrees.
const OPPOSED_COSINE: f64 = -0.5;
/// The least gain of a search step.
const LEAST_GAIN: f64 = 1e-3;
/// The largest share of the distance to a neighbour on its curve that a vertex moves.
const CURVE_SHARE: f64 = 0.5;

/// Relocates the vertices: `passes` of shape matching, then searches at the vertices of imperfect faces.
pub fn relocate(context: &Context, mesh: &mut SurfaceMesh, passes: usize) {
    if passes == 0 {
        return;
    }
    Sweeps::new(context, mesh).relocate(mesh, passes);
}

/// As [`relocate`], from the faces at the vertices from `first` on, and as far as vertices move: those are new.
pub(crate) fn relocate_about(context: &Context, mesh: &mut SurfaceMesh, passes: usize, first: u32) {
    if passes == 0 {
        return;
    }
    let mut sweeps = Sweeps::new(context, mesh);
    sweeps.is_waiting.fill(false);
    for v in first..mesh.vertices().len() as u32 {
        let corners = mesh.around(v).iter().flat_map(|&f| mesh.face(f));
        corners.for_each(|&w| sweeps.is_waiting[w as usize] = true);
    }
    sweeps.relocate(mesh, passes);
}

/// Relocates the vertices by `passes` of shape matching alone.
pub(crate) fn match_shapes<'a>(context: &'a Context<'a>, mesh: &mut SurfaceMesh, passes: usize) -> Sweeps<'a> {
    let mut sweeps = Sweeps::new(context, mesh);
    sweeps.match_shapes(mesh, passes);
    sweeps
}

/// The way in which a vertex finds its position.
#[derive(Clone, Copy)]
enum Step {
    /// Shape matching, and a search where a face is poor.
    Match,
    /// A search where a face has a smaller shape than this.
    Search(f64),
}

/// The state of a relocation.
pub(crate) struct Sweeps<'a> {
    context: &'a Context<'a>,
    /// The map of each face's metric; empty where tiles are squares.
    maps: Vec<MetricMap>,
    measures: Vec<Measure>,
    /// Whether a face of each vertex has changed since its last visit.
    is_waiting: Vec<bool>,
    /// The movable vertices, in sets of which no two share a face.
    colours: Vec<Vec<u32>>,
}

impl<'a> Sweeps<'a> {
    pub(crate) fn new(context: &'a Context<'a>, mesh: &SurfaceMesh) -> Self {
        let all = 0..mesh.face_bound() as u32;
        Self {
            context,
            maps: mesh.metric().maps_of(all.clone().map(|f| mesh.face(f))),
            measures: all.into_par_iter().with_min_len(1024).map(|f| mesh.measure(context, f)).collect(),
            is_waiting: vec![true; mesh.vertices().len()],
            colours: colours(mesh),
        }
    }

    /// The measures of the faces as they are.
    pub(crate) fn into_measures(self) -> Vec<Measure> {
        self.measures
    }

    /// Keeps vertices where they are: those that `is_held` marks.
    pub(crate) fn hold(&mut self, is_held: &[bool]) {
        self.colours.iter_mut().for_each(|set| set.retain(|&v| !is_held[v as usize]));
    }

    fn relocate(&mut self, mesh: &mut SurfaceMesh, passes: usize) {
        self.match_shapes(mesh, passes);
        self.search_imperfect(mesh);
        self.search_poor(mesh);
    }

    /// Passes of shape matching.
    pub(crate) fn match_shapes(&mut self, mesh: &mut SurfaceMesh, passes: usize) {
        (0..passes).for_each(|_| {
            self.sweep(mesh, Step::Match);
        });
    }

    /// Searches at the vertices of imperfect faces.
    pub(crate) fn search_imperfect(&mut self, mesh: &mut SurfaceMesh) {
        (0..ROUNDS).for_each(|_| {
            self.sweep(mesh, Step::Search(IMPERFECT));
        });
    }

    /// Searches at the vertices of poor faces, until none moves.
    pub(crate) fn search_poor(&mut self, mesh: &mut SurfaceMesh) {
        for _ in 0..POOR_ROUNDS {
            if !self.sweep(mesh, Step::Search(POOR)) {
                break;
            }
        }
    }

    /// The least shape of the faces at a vertex, 0 where one is a fault, as it is and with the vertex at a position.
    pub(crate) fn least_shapes(&self, mesh: &SurfaceMesh, v: u32, position: &Position) -> [f64; 2] {
        let view = View { sweeps: self, mesh };
        let moved = mesh.around(v).iter().map(|&f| view.measure(f, Some((v, position))).shape_unless_fault());
        [view.worst(v), moved.fold(1.0, f64::min)]
    }

    /// Moves a vertex to a position, and measures its faces.
    pub(crate) fn put(&mut self, mesh: &mut SurfaceMesh, v: u32, position: &Position) {
        mesh.set_position(v, position, self.context.surface);
        for &f in mesh.around(v) {
            self.measures[f as usize] = View { sweeps: self, mesh }.measure(f, None);
        }
    }

    /// Visits each waiting vertex once, colour by colour; returns whether any has moved.
    fn sweep(&mut self, mesh: &mut SurfaceMesh, step: Step) -> bool {
        let mut any = false;
        for k in 0..self.colours.len() {
            let view = View { sweeps: self, mesh };
            let is_visited =
                |&&v: &&u32| self.is_waiting[v as usize] && view.may_gain(v, step) && !self.context.is_cancelled();
            let found: Vec<(u32, Option<Position>)> = self.colours[k]
                .par_iter()
                .with_min_len(128)
                .filter(is_visited)
                .map(|&v| (v, view.better(v, step)))
                .collect();
            for &(v, ref position) in &found {
                self.is_waiting[v as usize] = false;
                if let Some(position) = position {
                    mesh.set_position(v, position, self.context.surface);
                }
            }
            let moved = found.iter().filter(|(_, position)| position.is_some());
            let faces: Vec<u32> = moved.flat_map(|&(v, _)| mesh.around(v)).copied().collect();
            let measured: Vec<Measure> =
                faces.par_iter().with_min_len(256).map(|&f| View { sweeps: self, mesh }.measure(f, None)).collect();
            for (&f, measure) in faces.iter().zip(measured) {
                self.measures[f as usize] = measure;
                mesh.face(f).iter().for_each(|&v| self.is_waiting[v as usize] = true);
            }
            any |= !faces.is_empty();
        }
        any
    }
}

/// A mesh between two moves, with the state of the relocation.
struct View<'a> {
    sweeps: &'a Sweeps<'a>,
    mesh: &'a SurfaceMesh,
}

impl View<'_> {
    /// Whether a step applies to a vertex.
    fn may_gain(&self, v: u32, step: Step) -> bool {
        match step {
            Step::Match => true,
            Step::Search(limit) => self.worst(v) < limit || self.leaves_its_curve(v),
        }
    }

    /// Whether the chords at a vertex are too far from its feature curve.
    fn leaves_its_curve(&self, v: u32) -> bool {
        let vertex = self.mesh.vertex(v);
        let Place::OnCurve { curve, s } = vertex.place else { return false };
        let position = Position::from(vertex);
        self.range(v, curve, s).is_some_and(|range| self.chords(v, &position, &range) > TOLERATED_CHORD_LOSS)
    }

    /// The least shape of the faces at a vertex, 0 where one is a fault.
    fn worst(&self, v: u32) -> f64 {
        let measures = self.mesh.around(v).iter().map(|&f| &self.sweeps.measures[f as usize]);
        measures.map(Measure::shape_unless_fault).fold(1.0, f64::min)
    }

    /// A better position of a vertex, if one is found.
    fn better(&self, v: u32, step: Step) -> Option<Position> {
        let range = match self.mesh.vertex(v).place {
            Place::Free => None,
            Place::OnCurve { curve, s } => Some(self.range(v, curve, s)?),
            Place::Corner => return None,
        };
        let current = Position::from(self.mesh.vertex(v));
        let score = self.current_score(v, &current, range.as_ref());
        if let Step::Match = step {
            let found = self.matched(v, &current, score, range.as_ref());
            if found.is_some() || (self.worst(v) >= POOR && !self.leaves_its_curve(v)) {
                return found;
            }
        }
        self.searched(v, current, score, range.as_ref())
    }

    /// The position of a step of shape matching, if it improves the score.
    fn matched(&self, v: u32, current: &Position, score: Score, range: Option<&Range>) -> Option<Position> {
        let way = self.target(v) - current.point;
        let normal = self.mesh.vertex(v).normal;
        let way = if range.is_none() { way - normal * normal.dot(way) } else { way };
        let edge = self.mesh.mean_edge_at(v);
        let length = range.map_or(way.length(), |range| way.dot(range.tangent).abs());
        if length < LEAST_DISPLACEMENT * edge {
            return None;
        }
        STEP_SHARES.into_iter().find_map(|share| {
            let position = self.moved(current, way * share, range)?;
            self.better_score(v, &position, range, &score, 0.0).map(|_| position)
        })
    }

    /// The position of a pattern search, if it improves the score.
    fn searched(&self, v: u32, current: Position, score: Score, range: Option<&Range>) -> Option<Position> {
        let edge = self.mesh.mean_edge_at(v);
        let (mut best, mut least) = (current, score);
        for length in DISPLACEMENTS.map(|share| share * edge) {
            let ways: Vec<DVec3> = match range {
                Some(range) => vec![range.tangent * length, range.tangent * -length],
                None => {
                    let normal = self.sweeps.context.surface.normal(best.triangles[0] as usize).as_dvec3();
                    let (across, along) = normal.any_orthonormal_pair();
                    let angle = |k: u32| f64::from(k) * std::f64::consts::TAU / f64::from(DIRECTIONS);
                    (0..DIRECTIONS).map(|k| (across * angle(k).cos() + along * angle(k).sin()) * length).collect()
                }
            };
            let tried = ways.into_iter().filter_map(|way| self.moved(&best, way, range));
            let mut found = None;
            for position in tried {
                if let Some(score) = self.better_score(v, &position, range, &least, LEAST_GAIN) {
                    (found, least) = (Some(position), score);
                }
            }
            best = found.unwrap_or(best);
        }
        (best != current).then_some(best)
    }

    /// The position at a displacement: over the surface, or along a curve within a range.
    fn moved(&self, from: &Position, way: DVec3, range: Option<&Range>) -> Option<Position> {
        let surface = self.sweeps.context.surface;
        let Some(range) = range else { return Some(walked(surface, from.triangles[0], from.point, from.point + way)) };
        let Place::OnCurve { curve, s } = from.place else { return None };
        let line = self.sweeps.context.curve(curve);
        let s = range.clamped(s + way.dot(range.tangent));
        let half_edge = line.half_edges[line.segment(line.wrapped(s))];
        let other = surface.twin(half_edge).unwrap_or(half_edge);
        Some(Position {
            point: line.point(surface, s),
            place: Place::OnCurve { curve, s: line.wrapped(s) },
            triangles: [half_edge / 3, other / 3],
        })
    }

    /// The target of shape matching for a vertex.
    fn target(&self, v: u32) -> DVec3 {
        let here = self.mesh.point(v);
        let (mut way, mut weight) = (DVec3::ZERO, 0.0);
        for &f in self.mesh.around(v) {
            let face = self.mesh.face(f);
            let Some(at) = face.iter().position(|&w| w == v).filter(|_| face.len() <= 4) else { continue };
            let low = self.sweeps.measures[f as usize].shape < FLOOR;
            let share =
                if face.len() == 3 { TRIANGLE_WEIGHT } else { 1.0 } * if low { BELOW_FLOOR_WEIGHT } else { 1.0 };
            let map = self.sweeps.maps.get(f as usize);
            let corner = |k: usize| to_metric(map, self.mesh.point(face[(at + k) % face.len()]));
            way += (from_metric(map, regular(face.len(), corner)) - here) * share;
            weight += share;
        }
        if weight > 0.0 { here + way / weight } else { here }
    }

    /// The score of the faces and feature edges at a vertex as it is.
    fn current_score(&self, v: u32, current: &Position, range: Option<&Range>) -> Score {
        let faces: Score = self.mesh.around(v).iter().map(|&f| self.sweeps.measures[f as usize].score(0.0)).sum();
        let chords = range.map_or(0.0, |range| self.chords(v, current, range));
        Score { loss: faces.loss + chords, ..faces }
    }

    /// The score of the faces and feature edges at a vertex, the vertex being at a position, where it [beats](Score::beats) another
    /// one.
    fn better_score(
        &self,
        v: u32,
        position: &Position,
        range: Option<&Range>,
        other: &Score,
        margin: f64,
    ) -> Option<Score> {
        let mut score = Score::default();
        for &f in self.mesh.around(v) {
            score = score.plus(&self.measure(f, Some((v, position))).score(0.0));
            if !score.can_beat(other, margin) {
                return None;
            }
        }
        score.loss += range.map_or(0.0, |range| self.chords(v, position, range));
        (score.beats(other, margin) && !self.adds_opposed(v, position)).then_some(score)
    }

    /// Whether a face at a vertex that is no fault would point against the triangles nearest to it, where these decide, with the vertex
    /// at a position: its normal does not tell, as a thin part is near.
    fn adds_opposed(&self, v: u32, position: &Position) -> bool {
        let orientation = &self.sweeps.context.orientation;
        self.mesh.around(v).iter().any(|&f| {
            let at = |w: u32| if w == v { *position } else { Position::from(self.mesh.vertex(w)) };
            let corners = self.mesh.face(f).iter().map(|&w| at(w));
            let points: Vec<DVec3> = corners.clone().map(|corner| corner.point).collect();
            !self.sweeps.measures[f as usize].is_fault
                && orientation.nearest_decide_at(middle(&points))
                && orientation.is_inverted(&points, corners.map(|corner| corner.triangles))
        })
    }

    /// The loss of the two feature edges at a vertex on a curve.
    fn chords(&self, v: u32, position: &Position, range: &Range) -> f64 {
        let Place::OnCurve { curve, s } = position.place else { return 0.0 };
        let context = self.sweeps.context;
        let line = context.curve(curve);
        let s = range.unwrapped(s, line.length());
        debug_assert!(self.mesh.vertex(v).place != Place::Free);
        let chord = |other: f64| chord_loss(line.chord_distance(context.surface, s, other) / range.edge);
        chord(range.before) + chord(range.after)
    }

    /// The measure of a face; `moved` gives one of its vertices another position.
    fn measure(&self, f: u32, moved: Option<(u32, &Position)>) -> Measure {
        let face = self.mesh.face(f);
        let mut points = [DVec3::ZERO; 4];
        let mut triangles = [[NONE; 2]; 4];
        let before = &self.sweeps.measures[f as usize];
        if face.len() > 4 {
            return *before;
        }
        for (k, &w) in face.iter().enumerate() {
            (points[k], triangles[k]) = match moved {
                Some((v, position)) if v == w => (position.point, position.triangles),
                _ => (self.mesh.point(w), self.mesh.vertex(w).triangles),
            };
        }
        let (points, triangles) = (&points[..face.len()], &triangles[..face.len()]);
        let map = self.sweeps.maps.get(f as usize);
        let Context { surface, orientation, .. } = self.sweeps.context;
        // A vertex that would walk over a rim comes onto another sheet, which the normal of the face does not tell.
        let least = OPPOSED_COSINE * before.normal.length();
        let agrees = |&t: &u32| surface.normal(t as usize).as_dvec3().dot(before.normal) > least;
        let known = Some(before).filter(|_| moved.is_none_or(|(_, position)| position.triangles.iter().any(agrees)));
        Measure::of(points, map, known, || orientation.is_inverted(points, triangles.iter().copied()))
    }

    /// The range of a vertex on a curve; `None` where it has no neighbour on one side.
    fn range(&self, v: u32, curve: u32, s: f64) -> Option<Range> {
        let context = self.sweeps.context;
        let line = context.curve(curve);
        let (mut before, mut after) = (0.0_f64, 0.0_f64);
        for w in self.mesh.along(v, curve) {
            for way in line.ways(s, self.mesh.arc(context, w, curve, s)?) {
                let nearest = if way < 0.0 { &mut before } else { &mut after };
                if *nearest == 0.0 || way.abs() < nearest.abs() {
                    *nearest = way;
                }
            }
        }
        let step = [before, after].map(|way| line.point(context.surface, s + CURVE_SHARE * way));
        let tangent = (step[1] - step[0]).try_normalize()?;
        let edge = self.mesh.mean_edge_at(v);
        (before < 0.0 && after > 0.0).then_some(Range { s, before: s + before, after: s + after, tangent, edge })
    }
}

/// The part of a curve between the neighbours of a vertex on it.
struct Range {
    /// The arc lengths of the vertex and its neighbours. On a closed curve they may lie beyond the ends.
    s: f64,
    before: f64,
    after: f64,
    /// The direction along the curve.
    tangent: DVec3,
    /// The mean length of the edges at the vertex.
    edge: f64,
}

impl Range {
    fn clamped(&self, s: f64) -> f64 {
        s.clamp(self.s + CURVE_SHARE * (self.before - self.s), self.s + CURVE_SHARE * (self.after - self.s))
    }

    /// The arc length between the neighbours that is the same point of a closed curve of a length.
    fn unwrapped(&self, s: f64, length: f64) -> f64 {
        [s, s - length, s + length].into_iter().find(|s| (self.before..=self.after).contains(s)).unwrap_or(s)
    }
}

/// The movable vertices, in sets of which no two share a face.
fn colours(mesh: &SurfaceMesh) -> Vec<Vec<u32>> {
    const UNCOLOURED: u8 = u8::MAX;
    let mut colour = vec![UNCOLOURED; mesh.vertices().len()];
    let mut sets: Vec<Vec<u32>> = Vec::new();
    let mut taken = Vec::new();
    for v in 0..mesh.vertices().len() as u32 {
        let vertex = mesh.vertex(v);
        if mesh.around(v).is_empty() || vertex.place == Place::Corner || vertex.is_kept {
            continue;
        }
        taken.clear();
        taken.resize(sets.len() + 1, false);
        for &w in mesh.around(v).iter().flat_map(|&f| mesh.face(f)) {
            if colour[w as usize] != UNCOLOURED {
                taken[colour[w as usize] as usize] = true;
            }
        }
        // A vertex without one of the 255 colours stays; only a vertex of as many faces needs more.
        let free = taken.iter().position(|taken| !taken).unwrap_or(0);
        if free == sets.len() {
            if free == UNCOLOURED as usize {
                continue;
            }
            sets.push(Vec::new());
        }
        colour[v as usize] = free as u8;
        sets[free].push(v);
    }
    sets
}

/// The first corner of the regular polygon that fits a polygon best; `corner` gives its corners in order.
pub(crate) fn regular(count: usize, corner: impl Fn(usize) -> DVec3) -> DVec3 {
    let centre = (0..count).map(&corner).sum::<DVec3>() / count as f64;
    if count == 4 {
        // The mean of both half diagonals, the other one turned by a right angle.
        let (first, second) = (corner(0) - corner(2), corner(3) - corner(1));
        let normal = second.cross(first).normalize_or_zero();
        return centre + (first + normal.cross(second)) / 4.0;
    }
    let radius = |k: usize| corner(k % count) - centre;
    let normal = (0..count).map(|k| radius(k).cross(radius(k + 1))).sum::<DVec3>().normalize_or_zero();
    // The mean of the vectors from the centre to all corners, turned to the first corner.
    let step = std::f64::consts::TAU / count as f64;
    let turned = (0..count).map(|k| {
        let (s, c) = (-(k as f64) * step).sin_cos();
        radius(k) * c + normal.cross(radius(k)) * s
    });
    centre + turned.sum::<DVec3>() / count as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Mesh;
    use crate::surface::{FeatureOptions, Soup, Surface};

    fn surface(points: Vec<[f64; 3]>, quads: &[[u32; 4]]) -> Surface {
        let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        let options = FeatureOptions { crease: 180.0, ridge: 180.0, ..FeatureOptions::default() };
        Surface::new(&Soup { points, triangles, ..Soup::default() }, &options).unwrap_or_else(|error| panic!("{error}"))
    }

    #[test]
    fn no_vertex_moves_so_that_a_face_crosses_a_wall_where_the_nearest_triangles_decide() {
        // A wall of thickness 0.1 with a rim at x = 0, and a face across its rim.
        let points =
            [[2.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.1], [2.0, 0.0, 0.1]].map(|p| [p, [p[0], 1.0, p[2]]]);
        let surface = surface(points.concat(), &[[0, 2, 3, 1], [2, 4, 5, 3], [4, 6, 7, 5]]);
        let mut context = Context::new(&surface);
        let mut mesh = Mesh::new(vec![[0.03, 0.2, 0.0], [0.03, 0.2, 0.1], [0.03, 0.8, 0.1], [0.03, 0.8, 0.0]]);
        mesh.push_face(&[0, 1, 2, 3]);
        let mesh = SurfaceMesh::of(&context, &mesh);
        assert!(mesh.faults(&context).is_empty());
        let far =
            Position { point: DVec3::from(surface.frame().to_unit([1.0, 0.2, 0.1])), ..Position::from(mesh.vertex(1)) };
        let adds = |context: &Context, mesh: &SurfaceMesh, position: &Position| {
            View { sweeps: &Sweeps::new(context, mesh), mesh }.adds_opposed(1, position)
        };
        assert!(!adds(&context, &mesh, &far));
        context.let_nearest_decide(&mesh, &[0]);
        assert!(adds(&context, &mesh, &far));
        assert!(!adds(&context, &mesh, &Position::from(mesh.vertex(1))));
    }
}
