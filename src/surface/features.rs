//! Feature edges: creases and open boundaries, chained into curves that end at corners.

use super::curve::Curve;
use super::{NONE, Surface, next};
use crate::geometry::dot;
use glam::DVec3;
use rayon::prelude::*;

/// What counts as a feature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FeatureOptions {
    /// Dihedral angle in degrees over which an edge is a crease; 180 or more: none is. Default 40.
    pub crease: f64,
    /// Whether each crease longer than about a tile is a feature, even where the surface hardly turns at the scale of a tile.
    /// Default false.
    pub every_crease: bool,
    /// Turning angle in degrees over which a point of a feature curve is a corner. Default 50.
    pub corner: f64,
    /// Angle in degrees over which a smooth surface that turns within one tile has a ridge; 180 or more: it has none.
    /// Default 60.
    pub ridge: f64,
    /// Whether edges between named regions are features. Default true.
    pub region_borders: bool,
    /// Whether edges at which texture coordinates jump are features. Default false.
    pub texture_seams: bool,
}

impl Default for FeatureOptions {
    fn default() -> Self {
        Self {
            crease: 40.0,
            every_crease: false,
            corner: 50.0,
            ridge: 60.0,
            region_borders: true,
            texture_seams: false,
        }
    }
}

/// An edge of a crease that is no feature, as it does not persist at the scale of a tile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DroppedEdge {
    /// One of its half-edges.
    pub half_edge: u32,
    /// The crease, counted from 0.
    pub crease: u32,
    /// The angle in degrees by which the surface turns across it at the scale of a tile; negative where it is concave.
    pub turn: f32,
    /// Why its crease was dropped.
    pub reason: Reason,
}

/// The reason why a crease was dropped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    /// Were it sharp, it would still be too short.
    Short,
    /// At the scale of a tile the surface turns too little.
    Weak,
    /// A more persistent crease has the same ends and is nowhere farther away than a small part of a tile.
    Double,
}

/// A crease that ends on a kept boundary between two kept vertices ends so far from it, in tile sides.
const TRIMMED: f64 = 0.7;

/// The features of a surface.
#[derive(Clone, Debug, Default)]
pub struct Features {
    marked: Vec<bool>,
    curves: Vec<Curve>,
    is_corner: Vec<bool>,
    /// The arc length, unit-sized, over which a curve must turn on either side of a corner.
    pub(super) reach: f64,
    /// Corners without curves, in order.
    pub(super) apexes: Vec<u32>,
}

impl Features {
    /// Finds creases and boundaries and chains them.
    pub(super) fn find(surface: &Surface, options: &FeatureOptions) -> Self {
        Self::along(surface, mark(surface, options.crease), options.corner, 0.0)
    }

    /// Chains the marked half-edges into curves that turn by at most `corner` degrees between corners. A turn that a curve takes
    /// back within `reach`, unit-sized, is no corner.
    pub(super) fn along(surface: &Surface, marked: Vec<bool>, corner: f64, reach: f64) -> Self {
        let passed = if reach > 0.0 { surface.passed_vertices() } else { Vec::new() };
        let marked = trimmed(surface, marked, &passed, TRIMMED * reach);
        let edges = Incidence::new(surface, &marked);
        let apexes = surface.features.apexes.clone();
        let cos_corner = corner.to_radians().cos();
        let is_end: Vec<bool> =
            (0..surface.vertex_count() as u32).map(|v| ![0, 2].contains(&edges.at(v).len())).collect();
        let is_corner = |v: u32| match *edges.at(v) {
            [a, b] => {
                let ways = [a, b].map(|edge| edges.run(surface, v, edge, &is_end));
                is_sharp(surface, v, ways, reach, cos_corner)
            }
            _ => is_end[v as usize] || apexes.binary_search(&v).is_ok(),
        };
        let mut is_corner: Vec<bool> = (0..surface.vertex_count() as u32).into_par_iter().map(is_corner).collect();
        share_corners(surface, &edges, &mut is_corner);
        passed.iter().for_each(|&v| is_corner[v as usize] = false);
        let curves = chain(surface, &edges, &is_corner);
        Self { marked, curves, is_corner, reach, apexes }
    }

    /// Whether each half-edge lies on a feature.
    pub(super) fn marked(&self) -> Vec<bool> {
        self.marked.clone()
    }

    /// Whether a half-edge lies on a feature (boundary half-edges do).
    pub fn is_feature(&self, half_edge: u32) -> bool {
        self.marked[half_edge as usize]
    }

    /// Whether a vertex is a corner: a feature's end, a junction of several, a sharp turn, or an apex.
    pub fn is_corner(&self, vertex: u32) -> bool {
        self.is_corner[vertex as usize]
    }

    /// The corners, in order.
    pub fn corners(&self) -> impl Iterator<Item = u32> {
        (0..self.is_corner.len() as u32).filter(|&v| self.is_corner(v))
    }

    /// The feature curves.
    pub fn curves(&self) -> &[Curve] {
        &self.curves
    }
}

fn mark(surface: &Surface, crease: f64) -> Vec<bool> {
    let limit = crease.to_radians().cos() as f32;
    let normals: Vec<_> = (0..surface.triangle_count()).map(|t| surface.normal(t)).collect();
    let mut marked: Vec<bool> = (0..3 * surface.triangle_count())
        .map(|h| {
            let twin = surface.twins[h];
            twin == NONE || (crease < 180.0 && dot(normals[h / 3], normals[twin as usize / 3]) < limit)
        })
        .collect();
    surface.named.iter().for_each(|&h| marked[h as usize] = true);
    marked
}

/// Unmarks the creases that end on vertices of the boundary that the mesh passes by, over a length from there.
fn trimmed(surface: &Surface, mut marked: Vec<bool>, passed: &[u32], length: f64) -> Vec<bool> {
    if passed.is_empty() {
        return marked;
    }
    let edges = Incidence::new(surface, &marked);
    for &start in passed {
        for &first in edges.at(start).iter().filter(|&&h| surface.twin(h).is_some()) {
            let (mut at, mut edge, mut left) = (start, first, length);
            loop {
                [Some(edge), surface.twin(edge)].into_iter().flatten().for_each(|h| marked[h as usize] = false);
                at = other_end(surface, edge, at);
                left -= surface.length(edge);
                match *edges.at(at) {
                    [a, b] if left > 0.0 => edge = if a == edge { b } else { a },
                    _ => break,
                }
            }
        }
    }
    marked
}

/// The feature edges at each vertex, each edge named by the lower of its half-edges.
struct Incidence {
    starts: Vec<u32>,
    edges: Vec<u32>,
}

impl Incidence {
    fn new(surface: &Surface, marked: &[bool]) -> Self {
        let edges: Vec<u32> =
            (0..marked.len() as u32).filter(|&h| marked[h as usize] && h < surface.twins[h as usize]).collect();
        let mut starts = vec![0u32; surface.vertex_count() + 1];
        for &h in &edges {
            starts[surface.origin(h) as usize + 1] += 1;
            starts[surface.target(h) as usize + 1] += 1;
        }
        for v in 1..starts.len() {
            starts[v] += starts[v - 1];
        }
        let mut place = starts.clone();
        let mut incident = vec![0; 2 * edges.len()];
        for &h in &edges {
            for v in [surface.origin(h), surface.target(h)] {
                incident[place[v as usize] as usize] = h;
                place[v as usize] += 1;
            }
        }
        Self { starts, edges: incident }
    }

    /// The vertices along a curve from `start` on, over an edge at it, up to an end or round to the start.
    fn run<'a>(
        &'a self,
        surface: &'a Surface,
        start: u32,
        edge: u32,
        is_end: &'a [bool],
    ) -> impl Iterator<Item = u32> + 'a {
        let step = |edge: u32, from: u32| (edge, other_end(surface, edge, from));
        let next = move |&(edge, at): &(u32, u32)| match *self.at(at) {
            [a, b] if at != start && !is_end[at as usize] => Some(step(if a == edge { b } else { a }, at)),
            _ => None,
        };
        std::iter::successors(Some(step(edge, start)), next).map(|(_, at)| at)
    }

    fn at(&self, vertex: u32) -> &[u32] {
        &self.edges[self.starts[vertex as usize] as usize..self.starts[vertex as usize + 1] as usize]
    }
}

/// Makes corners of the vertices at one place unless the same two feature edges pass through all of them: curves of
/// sheets that meet then begin and end together.
fn share_corners(surface: &Surface, edges: &Incidence, is_corner: &mut [bool]) {
    let mut shared: Vec<[u32; 2]> = (0..surface.vertex_count() as u32)
        .filter(|&v| surface.same_place(v) != v)
        .flat_map(|v| [[surface.same_place(v), v], [surface.same_place(v); 2]])
        .collect();
    shared.sort_unstable();
    shared.dedup();
    let ways = |v: u32| -> Vec<u32> {
        let mut ways: Vec<u32> =
            edges.at(v).iter().map(|&edge| surface.same_place(other_end(surface, edge, v))).collect();
        ways.sort_unstable();
        ways
    };
    for group in shared.chunk_by(|a, b| a[0] == b[0]) {
        let first = ways(group[0][1]);
        let alike = group.iter().all(|&[_, v]| !is_corner[v as usize] && ways(v) == first);
        if first.len() != 2 || !alike {
            group.iter().for_each(|&[_, v]| is_corner[v as usize] = true);
        }
    }
}

/// The end of an edge that is not `vertex`.
pub(super) fn other_end(surface: &Surface, half_edge: u32, vertex: u32) -> u32 {
    let origin = surface.origin(half_edge);
    if origin == vertex { surface.origin(next(half_edge)) } else { origin }
}

/// Whether the curve that runs through a vertex has a sharp turn there: between its two edges, and between its points at an arc
/// length of `reach` on either side. `ways` are the vertices along it in both directions.
pub(super) fn is_sharp(
    surface: &Surface,
    vertex: u32,
    ways: [impl Iterator<Item = u32>; 2],
    reach: f64,
    cos_corner: f64,
) -> bool {
    let place = |v: u32| surface.points[v as usize].as_dvec3();
    let [before, after] = ways.map(|way| way.map(place));
    turns_sharply(place(vertex), before, after, reach, cos_corner)
}

/// As [`is_sharp`], of the points along a polyline in both directions.
pub(super) fn turns_sharply(
    here: DVec3,
    before: impl Iterator<Item = DVec3>,
    after: impl Iterator<Item = DVec3>,
    reach: f64,
    cos_corner: f64,
) -> bool {
    let (a, p) = first_and_at_arc(here, before, reach);
    let (b, q) = first_and_at_arc(here, after, reach);
    let turns = |p: DVec3, q: DVec3| (here - p).normalize_or_zero().dot((q - here).normalize_or_zero()) < cos_corner;
    turns(a, b) && turns(p, q)
}

/// The first point of a polyline, and the one at an arc length from its start.
fn first_and_at_arc(start: DVec3, way: impl Iterator<Item = DVec3>, arc: f64) -> (DVec3, DVec3) {
    let mut way = way.peekable();
    let first = way.peek().copied().unwrap_or(start);
    (first, at_arc(start, way, arc))
}

/// The point of a polyline at an arc length from its start, on its first side or beyond; its end where it is shorter.
fn at_arc(start: DVec3, mut rest: impl Iterator<Item = DVec3>, arc: f64) -> DVec3 {
    let mut here = rest.next().unwrap_or(start);
    let mut left = arc - here.distance(start);
    for next in rest {
        let length = next.distance(here);
        if left <= 0.0 {
            break;
        }
        here = here.lerp(next, (left / length).min(1.0));
        left -= length;
    }
    here
}

fn chain(surface: &Surface, edges: &Incidence, is_corner: &[bool]) -> Vec<Curve> {
    let mut done = vec![false; 3 * surface.triangle_count()];
    let mut curves = Vec::new();
    let mut follow = |start: u32, first: u32, done: &mut Vec<bool>| {
        let (mut vertices, mut half_edges) = (vec![start], Vec::new());
        let (mut at, mut edge) = (start, first);
        loop {
            done[edge as usize] = true;
            half_edges.push(edge);
            at = other_end(surface, edge, at);
            vertices.push(at);
            if at == start || is_corner[at as usize] {
                break;
            }
            let [a, b] = *edges.at(at) else { break };
            edge = if a == edge { b } else { a };
        }
        let closed = !is_corner[start as usize];
        curves.push(Curve::new(surface, vertices, half_edges, closed));
    };
    let corners_first = |corner: bool| (0..is_corner.len() as u32).filter(move |&v| is_corner[v as usize] == corner);
    for v in corners_first(true).chain(corners_first(false)) {
        for &edge in edges.at(v) {
            if !done[edge as usize] {
                follow(v, edge, &mut done);
            }
        }
    }
    curves
}
