//! Feature edges: creases and open boundaries, chained into curves that end at corners.

use super::curve::Curve;
use super::{NONE, Surface, next};
use crate::geometry::dot;

/// What counts as a feature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FeatureOptions {
    /// Dihedral angle in degrees over which an edge is a crease; 180 or more: none is. Default 40.
    pub crease: f64,
    /// Turning angle in degrees over which a point of a feature curve is a corner. Default 50.
    pub corner: f64,
    /// Angle in degrees over which a smooth surface that turns within one tile has a ridge; 180 or more: it has none.
    /// Default 60.
    pub ridge: f64,
    /// Whether edges between named regions are features. Default true.
    pub region_borders: bool,
}

impl Default for FeatureOptions {
    fn default() -> Self {
        Self { crease: 40.0, corner: 50.0, ridge: 60.0, region_borders: true }
    }
}

/// The features of a surface.
#[derive(Clone, Debug, Default)]
pub struct Features {
    marked: Vec<bool>,
    curves: Vec<Curve>,
    is_corner: Vec<bool>,
}

impl Features {
    /// Finds creases and boundaries and chains them.
    pub(super) fn find(surface: &Surface, options: &FeatureOptions) -> Self {
        Self::along(surface, mark(surface, options.crease), options.corner)
    }

    /// Chains the marked half-edges into curves that turn by at most `corner` degrees between corners.
    pub(super) fn along(surface: &Surface, marked: Vec<bool>, corner: f64) -> Self {
        let edges = Incidence::new(surface, &marked);
        let cos_corner = corner.to_radians().cos();
        let mut is_corner: Vec<bool> = (0..surface.vertex_count() as u32)
            .map(|v| match *edges.at(v) {
                [] => false,
                [a, b] => turning_cosine(surface, v, a, b) < cos_corner,
                _ => true,
            })
            .collect();
        share_corners(surface, &edges, &mut is_corner);
        let curves = chain(surface, &edges, &is_corner);
        Self { marked, curves, is_corner }
    }

    /// Whether a half-edge lies on a feature (boundary half-edges do).
    pub fn is_feature(&self, half_edge: u32) -> bool {
        self.marked[half_edge as usize]
    }

    /// Whether a vertex is a corner: a feature's end, a junction of several, or a sharp turn.
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

fn other_end(surface: &Surface, half_edge: u32, vertex: u32) -> u32 {
    let origin = surface.origin(half_edge);
    if origin == vertex { surface.origin(next(half_edge)) } else { origin }
}

/// The cosine of the angle by which the curve through edges `a` and `b` turns at `vertex`.
pub(super) fn turning_cosine(surface: &Surface, vertex: u32, a: u32, b: u32) -> f64 {
    let here = surface.points[vertex as usize].as_dvec3();
    let [p, q] = [a, b].map(|h| surface.points[other_end(surface, h, vertex) as usize].as_dvec3());
    (here - p).normalize_or_zero().dot((q - here).normalize_or_zero())
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
