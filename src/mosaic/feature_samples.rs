//! Feature samples: one tile at each corner, and as many along each feature curve as fit.
//!
//! # Practice
//! Along a curve of length `l` there are `round(l / h)` intervals of equal tiles, or the integral of `1 / h`; within an edge they
//! are even. A sample is one vertex of the mesh. It has a tile on each side of the feature, with the normal of that side and the
//! curve's tangent as axis. Where sheets meet, each has its own samples, at the same places.

use crate::compute::Tile;
use crate::field::Field;
use crate::geometry::{cross, unit};
use crate::parametrize::Parametrization;
use crate::sizes::Sizes;
use crate::surface::{Curve, Surface, next, previous, shared_curves};
use glam::Vec3;
use rustc_hash::{FxHashMap, FxHashSet};

/// A point on a feature of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FeaturePoint {
    /// A vertex of the surface.
    Vertex(u32),
    /// A point of an edge, at this share of the way along the half-edge.
    Edge(u32, f64),
}

/// A tile on a feature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FeatureSample {
    /// The centre.
    pub point: FeaturePoint,
    /// The first of its sides among the mosaic's tiles.
    pub first_side: u32,
    /// The first sample at the same place: itself, but where sheets meet or fans touch.
    pub same_place: u32,
}

/// A point nearer to a vertex than this, in tile sides and as a share of its edge, is on the vertex.
const SNAP: f64 = 1e-3;

/// A point farther out than a released end of a feature by less than this, in tile sides, is on it.
const AT_END: f64 = 5e-3;

/// Quarter turns of the tile at a corner without features of its own: one more than a full turn, so that all directions lie
/// inside.
const ALL_ROUND: u32 = 5;

/// The samples of the features at the scale `h`, and the tiles on their sides.
pub fn sample_features(
    surface: &Surface,
    field: &Field,
    h: f32,
    curve_parameters: &CurveParameters,
) -> (Vec<FeatureSample>, Vec<Tile>) {
    let mut samples = Samples::default();
    samples.at_corners(surface, &curve_parameters.released_ends);
    let mut joined = FxHashSet::default();
    let keeps_boundary = surface.keeps_boundary() && curve_parameters.factor == curve_parameters.last_factor;
    let shared = if keeps_boundary { shared_curves(surface) } else { Vec::new() };
    let is_kept =
        |number: usize, curve: &Curve| keeps_boundary && !shared[number] && surface.twin(curve.half_edges[0]).is_none();
    let curves = || surface.features().curves().iter().enumerate();
    for (_, curve) in curves().filter(|&(number, curve)| is_kept(number, curve)) {
        let path = CurvePath::new(surface, field, curve);
        let parameters = path.kept(surface);
        samples.along(surface, &path, h, &parameters, None);
        if intervals(&parameters) == 1 {
            joined.insert(path.ends(surface));
        }
    }
    for (_, curve) in curves().filter(|&(number, curve)| !is_kept(number, curve)) {
        let path = CurvePath::new(surface, field, curve);
        let least = {
            // Few intervals must not make a loop of less than three edges, nor two edges between the same two corners.
            let ends = path.ends(surface);
            if curve_parameters.ranges.contains_key(&path.key(surface)) {
                0
            } else if ends[0] == ends[1] {
                3
            } else if joined.insert(ends) {
                1
            } else {
                2
            }
        };
        let parameters = match samples.intervals(surface, &path) {
            Some(intervals) => path.even(intervals),
            None => match curve_parameters.at_vertices.get(&path.key(surface)) {
                Some(parameters) if intervals(parameters) * curve_parameters.factor >= least => {
                    parameters.iter().map(|x| x * curve_parameters.factor as f64).collect()
                }
                _ => path.even(((path.length / f64::from(h)).round() as usize).max(least)),
            },
        };
        samples.along(surface, &path, h, &parameters, curve_parameters.ranges.get(&path.key(surface)).copied());
    }
    let mut tiles = Vec::with_capacity(2 * samples.list.len());
    let mut feature_samples = Vec::with_capacity(samples.list.len());
    for (point, same_place) in samples.list {
        feature_samples.push(FeatureSample { point, first_side: tiles.len() as u32, same_place });
        sides(surface, field, point, h, &mut tiles);
    }
    (feature_samples, tiles)
}

fn intervals(parameters: &[f64]) -> usize {
    (parameters[parameters.len() - 1] - parameters[0]).round() as usize
}

/// The largest change of a parameter that makes a curve's parameters increase, in tiles.
const MOST_CHANGE: f64 = 0.02;
/// The least growth of a parameter from one vertex to the next, in tiles.
const LEAST_GROWTH: f64 = 1e-6;

/// Makes the parameters in a range increase, where few decrease as in an inverted triangle of the parametrization. False where
/// one would change by more than [`MOST_CHANGE`]; then they are as they were.
fn make_monotone(parameters: &mut [f64], range: std::ops::RangeInclusive<usize>) -> bool {
    let given = &parameters[range.clone()];
    if given.windows(2).all(|pair| pair[1] > pair[0]) {
        return true;
    }
    let mut largest = f64::NEG_INFINITY;
    let mut fitted: Vec<f64> = given
        .iter()
        .map(|&x| {
            largest = x.max(largest + LEAST_GROWTH);
            largest
        })
        .collect();
    let mut smallest = f64::INFINITY;
    for (x, &y) in fitted.iter_mut().zip(given).rev() {
        smallest = y.min(smallest - LEAST_GROWTH);
        *x = (*x + smallest) / 2.0;
    }
    let is_near = fitted.iter().zip(given).all(|(x, y)| (x - y).abs() <= MOST_CHANGE);
    if is_near {
        parameters[range].copy_from_slice(&fitted);
    }
    is_near
}

/// A parameter along each feature curve, whose integers are the samples.
#[derive(Clone, Debug, Default)]
pub struct CurveParameters {
    /// The parameter at each vertex of a curve, by the curve's first edge.
    at_vertices: FxHashMap<[u32; 2], Vec<f64>>,
    /// What the parameters are multiplied by.
    factor: usize,
    /// The factor on the last level, that of the mesh.
    last_factor: usize,
    /// Ends of curves that hold no sample.
    pub(crate) released_ends: FxHashSet<u32>,
    /// The first and the last parameter of a sample, along curves with such ends.
    ranges: FxHashMap<[u32; 2], [f64; 2]>,
}

impl CurveParameters {
    /// Those of a parametrization: samples lie where its rows cross the features. Tiles will have a side `last_factor` times
    /// smaller.
    pub fn new(surface: &Surface, field: &Field, parametrization: &Parametrization, last_factor: usize) -> Self {
        let (mut at_vertices, mut ranges) = (FxHashMap::default(), FxHashMap::default());
        let mut released_ends = FxHashSet::default();
        for curve in surface.features().curves() {
            let path = CurvePath::new(surface, field, curve);
            let growth = path.half_edges.iter().zip(&path.vertices).map(|(&h, &v)| {
                let [at, step] = parametrization.along(h);
                if surface.origin(h) == v { [at, step] } else { [-at - step, step] }
            });
            let growth: Vec<[f64; 2]> = growth.collect();
            let has_sample = path.has_sample(&parametrization.released_ends);
            let mut here = vec![if has_sample[0] { 0.0 } else { growth[0][0] }];
            growth.iter().for_each(|[_, step]| here.push(here[here.len() - 1] + step));
            let has_released_end = !path.closed && has_sample != [true; 2];
            let (first, last) = path.constrained(&parametrization.released_vertices);
            if (has_released_end || intervals(&here) > 0) && make_monotone(&mut here, first.min(last)..=last) {
                if has_released_end {
                    let margin = has_sample.map(|has_sample| if has_sample { 0.5 } else { 0.0 });
                    let range =
                        if first <= last { [here[first] + margin[0], here[last] - margin[1]] } else { [1.0, 0.0] };
                    ranges.insert(path.key(surface), range);
                }
                // Corners are integers, but for roundings.
                let last = here.len() - 1;
                if path.closed {
                    here[last] = here[0] + intervals(&here) as f64;
                } else if has_sample[1] {
                    here[last] = here[last].round();
                }
                at_vertices.entry(path.key(surface)).or_insert(here);
                released_ends.extend(path.tips().into_iter().filter(|tip| parametrization.released_ends.contains(tip)));
            }
        }
        Self { at_vertices, factor: 1, last_factor, released_ends, ranges }
    }

    /// For tiles of a third of the side.
    pub fn thirds(&self) -> Self {
        Self { factor: 3 * self.factor, ..self.clone() }
    }
}

/// A feature curve, run through in the direction, and from the vertex where it is closed, that curves of other sheets at
/// the same place are run through as well.
struct CurvePath {
    vertices: Vec<u32>,
    half_edges: Vec<u32>,
    /// The lengths of the edges, in mean sides of tiles of scale 1.
    lengths: Vec<f64>,
    /// How many tiles of scale 1 lie along it.
    length: f64,
    closed: bool,
}

impl CurvePath {
    fn new(surface: &Surface, field: &Field, curve: &Curve) -> Self {
        let (mut vertices, mut half_edges) = (curve.vertices.clone(), curve.half_edges.clone());
        let place = |v: u32| surface.same_place(v);
        if curve.closed {
            vertices.pop();
            let first = (0..vertices.len()).min_by_key(|&i| place(vertices[i])).unwrap_or(0);
            vertices.rotate_left(first);
            half_edges.rotate_left(first);
            vertices.push(vertices[0]);
        }
        let forward: Vec<u32> = vertices.iter().map(|&v| place(v)).collect();
        if forward.iter().rev().lt(&forward) {
            vertices.reverse();
            half_edges.reverse();
        }
        let lengths: Vec<f64> = half_edges.iter().map(|&h| field.sizes().length(surface, h)).collect();
        let length = lengths.iter().zip(&half_edges).map(|(length, &h)| length / factor(surface, field, h)).sum();
        Self { vertices, half_edges, length, lengths, closed: curve.closed }
    }

    /// Equal intervals.
    fn even(&self, intervals: usize) -> Vec<f64> {
        let whole: f64 = self.lengths.iter().sum();
        let mut passed = 0.0;
        let mut parameters = vec![0.0];
        for length in &self.lengths {
            passed += length;
            parameters.push(passed / whole * intervals as f64);
        }
        let last = parameters.len() - 1;
        parameters[last] = intervals as f64;
        parameters
    }

    /// Parameters that grow by 1 from one vertex of a kept boundary to the next.
    fn kept(&self, surface: &Surface) -> Vec<f64> {
        let mut arcs = vec![0.0];
        self.lengths.iter().for_each(|length| arcs.push(arcs[arcs.len() - 1] + length));
        // The last vertex of a loop is the first one again.
        let places = (0..arcs.len() - usize::from(self.closed)).filter(|&i| surface.is_kept(self.vertices[i]));
        let mut kept: Vec<f64> = places.map(|i| arcs[i]).collect();
        let whole = arcs[arcs.len() - 1];
        // Of a loop, the vertices before the first and after the last, too.
        if self.closed
            && let [first, .., last] = kept[..]
        {
            kept.insert(0, last - whole);
            kept.push(first + whole);
        }
        let parameter = |&arc: &f64| {
            let next = kept.partition_point(|&other| other <= arc).clamp(1, kept.len() - 1);
            let [from, to] = [kept[next - 1], kept[next]];
            (next - 1) as f64 + (arc - from) / (to - from)
        };
        arcs.iter().map(parameter).collect()
    }

    fn tips(&self) -> [u32; 2] {
        [self.vertices[0], self.vertices[self.vertices.len() - 1]]
    }

    /// Whether tiles of their own are at its two ends.
    fn has_sample(&self, released: &FxHashSet<u32>) -> [bool; 2] {
        self.tips().map(|tip| !self.closed && !released.contains(&tip))
    }

    /// The first and the last of the vertices between its released ends; none where the first is after the last.
    fn constrained(&self, released: &FxHashSet<u32>) -> (usize, usize) {
        let is_constrained = |v: &u32| !released.contains(v);
        let first = self.vertices.iter().position(is_constrained).unwrap_or(self.vertices.len());
        (first, self.vertices.iter().rposition(is_constrained).unwrap_or(0))
    }

    /// Where it begins and ends, the lower first.
    fn ends(&self, surface: &Surface) -> [u32; 2] {
        let [a, b] = self.tips().map(|v| surface.same_place(v));
        [a.min(b), a.max(b)]
    }

    /// Where its first edge is: the same for all curves at one place, and for no other.
    fn key(&self, surface: &Surface) -> [u32; 2] {
        [self.vertices[0], self.vertices[1]].map(|v| surface.same_place(v))
    }
}

/// The side along a half-edge over the mean one.
fn factor(surface: &Surface, field: &Field, half_edge: u32) -> f64 {
    let Some(stretch) = field.stretch() else { return 1.0 };
    let [from, to] = [surface.origin(half_edge), surface.target(half_edge)].map(|v| surface.points[v as usize]);
    f64::from(stretch.factor(surface, half_edge / 3, (from + to) / 2.0, unit(to - from)))
}

/// Samples, each with the first one at its place.
#[derive(Default)]
struct Samples {
    list: Vec<(FeaturePoint, u32)>,
    /// The first sample of each curve, and how many it has.
    of_curves: FxHashMap<[u32; 2], [u32; 2]>,
}

impl Samples {
    fn at_corners(&mut self, surface: &Surface, released: &FxHashSet<u32>) {
        let mut first = FxHashMap::default();
        for v in surface.features().corners().filter(|v| !released.contains(v)) {
            let id = self.list.len() as u32;
            self.list.push((FeaturePoint::Vertex(v), *first.entry(surface.same_place(v)).or_insert(id)));
        }
    }

    /// The intervals of a curve of another sheet at the same place.
    fn intervals(&self, surface: &Surface, path: &CurvePath) -> Option<usize> {
        let [_, count] = *self.of_curves.get(&path.key(surface))?;
        Some(count as usize + usize::from(!path.closed))
    }

    /// Adds the samples along a curve, within a range of its parameters where it has one; its corners are left out.
    fn along(&mut self, surface: &Surface, path: &CurvePath, h: f32, parameters: &[f64], range: Option<[f64; 2]>) {
        let begun = self.list.len() as u32;
        let (begin, end) = (parameters[0].ceil() as i64, parameters[parameters.len() - 1].floor() as i64);
        let whole = match range {
            Some([first, last]) => (first - AT_END).ceil() as i64..(last + AT_END).floor() as i64 + 1,
            None if path.closed => begin..begin + intervals(parameters) as i64,
            None => begin + 1..end,
        };
        let count = (whole.end - whole.start).max(0) as u32;
        let [first, _] = *self.of_curves.entry(path.key(surface)).or_insert([begun, count]);
        let lengths = &path.lengths;
        let mut edge = 0;
        for (k, at) in (0..).zip(whole) {
            let at = at as f64;
            while edge + 1 < lengths.len() && parameters[edge + 1] < at {
                edge += 1;
            }
            let share = ((at - parameters[edge]) / (parameters[edge + 1] - parameters[edge])).clamp(0.0, 1.0);
            let snap = SNAP * (f64::from(h) / lengths[edge].max(f64::MIN_POSITIVE)).min(1.0);
            let point = if share < snap {
                FeaturePoint::Vertex(path.vertices[edge])
            } else if share > 1.0 - snap {
                FeaturePoint::Vertex(path.vertices[edge + 1])
            } else {
                let half_edge = path.half_edges[edge];
                let forward = surface.origin(half_edge) == path.vertices[edge];
                FeaturePoint::Edge(half_edge, if forward { share } else { 1.0 - share })
            };
            self.list.push((point, first + k));
        }
    }
}

fn place(surface: &Surface, point: FeaturePoint) -> Vec3 {
    match point {
        FeaturePoint::Vertex(v) => surface.points[v as usize],
        FeaturePoint::Edge(h, share) => {
            let [a, b] = [surface.origin(h), surface.target(h)].map(|v| surface.points[v as usize].as_dvec3());
            (a + (b - a) * share).as_vec3()
        }
    }
}

fn size(surface: &Surface, sizes: &Sizes, point: FeaturePoint) -> f32 {
    match point {
        FeaturePoint::Vertex(v) => sizes.at_vertex(v),
        FeaturePoint::Edge(h, share) => {
            let [a, b] = [surface.origin(h), surface.target(h)].map(|v| sizes.at_vertex(v));
            a + (b - a) * share as f32
        }
    }
}

fn sides(surface: &Surface, field: &Field, point: FeaturePoint, h: f32, tiles: &mut Vec<Tile>) {
    let position = place(surface, point).into();
    let h = h * size(surface, field.sizes(), point);
    match point {
        FeaturePoint::Edge(half_edge, _) => {
            for e in [Some(half_edge), surface.twin(half_edge)].into_iter().flatten() {
                let along = surface.points[surface.target(e) as usize] - surface.points[surface.origin(e) as usize];
                tiles.push(Tile {
                    position,
                    h,
                    normal: surface.normal(e as usize / 3).into(),
                    triangle: e / 3,
                    axis: unit(along).into(),
                    quarters: 2,
                });
            }
        }
        FeaturePoint::Vertex(vertex) => {
            for &sector in field.sectors().of_vertex(vertex) {
                let quarters = u32::from(field.sectors().quarters[sector as usize]);
                if quarters == 0 {
                    let triangle = field.sectors().first_corner[sector as usize] / 3;
                    let tile = Tile::free(surface, field, triangle, Vec3::from(position), h);
                    tiles.push(Tile { h, quarters: ALL_ROUND, ..tile });
                    continue;
                }
                let (triangle, middle) = middle(surface, field, sector);
                let normal = surface.normal(triangle as usize);
                // The middle of the side lies half its quarter turns past the axis.
                let back = -f32::from(quarters as u8) * std::f32::consts::FRAC_PI_4;
                let axis = middle * back.cos() + cross(normal, middle) * back.sin();
                tiles.push(Tile { position, h, normal: normal.into(), triangle, axis: axis.into(), quarters });
            }
        }
    }
}

/// The triangle that the middle direction of a sector points into, and that direction.
fn middle(surface: &Surface, field: &Field, sector: u32) -> (u32, Vec3) {
    let sectors = field.sectors();
    let total: f64 = sectors.corners(surface, sector).map(|c| sectors.corner_angle(c)).sum();
    let mut left = total / 2.0;
    let mut at = sectors.first_corner[sector as usize];
    for corner in sectors.corners(surface, sector) {
        at = corner;
        if left <= sectors.corner_angle(corner) {
            break;
        }
        left -= sectors.corner_angle(corner);
    }
    let [o, p, q] = [at, next(at), previous(at)].map(|e| surface.points[surface.origin(e) as usize]);
    let normal = unit(cross(p - o, q - o));
    let along = unit(p - o);
    let (s, c) = left.sin_cos();
    (at / 3, along * c as f32 + cross(normal, along) * s as f32)
}

#[cfg(test)]
mod tests {
    use super::make_monotone;

    #[test]
    fn a_parameter_that_decreases_in_one_edge_is_mended_and_the_others_stay() {
        let mut parameters = [0.0, 1.0, 2.02, 2.0, 3.0, 4.0];
        assert!(make_monotone(&mut parameters, 0..=5));
        assert!(parameters.windows(2).all(|pair| pair[1] > pair[0]), "{parameters:?}");
        assert!((parameters[2] - 2.01).abs() < 1e-5 && (parameters[3] - 2.01).abs() < 1e-5);
        assert_eq!([0, 1, 4, 5].map(|i| parameters[i]), [0.0, 1.0, 3.0, 4.0]);
    }

    #[test]
    fn parameters_that_turn_back_farther_are_left() {
        let given = [0.0, 3.0, 1.5, 4.0];
        let mut parameters = given;
        assert!(!make_monotone(&mut parameters, 0..=3));
        assert_eq!(parameters, given);
        assert!(make_monotone(&mut parameters, 0..=1), "outside the range they may");
    }
}
