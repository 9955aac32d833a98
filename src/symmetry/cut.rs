//! The half of a surface on one side of a plane.
//!
//! # Practice
//! Triangles that cross the plane are cut; new vertices, and those within [`ON_PLANE`] of the plane, have its coordinate bit for bit
//! where it lies across a coordinate axis.
//! What the cut cannot make a boundary of one sheet is refused.

use super::{ON_PLANE, Plane, SymmetryError};
use crate::surface::{Ends, NamedEdge, Regions, Soup, Surface};
use glam::DVec3;
use rustc_hash::{FxHashMap, FxHashSet};

/// The half of a surface where coordinates on the plane's axis are larger.
#[derive(Clone, Debug)]
pub struct Half {
    /// Its triangles, oriented as the surface, with their regions.
    pub soup: Soup,
    /// Its edges that are features of the surface whatever their angle.
    pub edges: Vec<NamedEdge>,
    /// The length of its boundary on the plane, in model units.
    pub rim: f64,
}

/// Cuts a surface at a plane.
///
/// # Errors
/// Where the plane does not cross the surface, holds triangles, or touches the surface.
pub fn cut(surface: &Surface, plane: Plane) -> Result<Half, SymmetryError> {
    let cutter = Cutter::new(surface, plane);
    cutter.expect_crossed()?;
    cutter.expect_none_in_plane()?;
    cutter.half()
}

struct Cutter<'a> {
    surface: &'a Surface,
    plane: Plane,
    tolerance: f64,
    /// The signed distance of each vertex, 0 where it is on the plane.
    heights: Vec<f64>,
}

impl<'a> Cutter<'a> {
    fn new(surface: &'a Surface, plane: Plane) -> Self {
        let tolerance = ON_PLANE * surface.frame().diagonal;
        let height = |v: u32| {
            let height = plane.height(surface.model_point(surface.same_place(v)));
            if height.abs() <= tolerance { 0.0 } else { height }
        };
        let heights = (0..surface.vertex_count() as u32).map(height).collect();
        Self { surface, plane, tolerance, heights }
    }

    fn height(&self, vertex: u32) -> f64 {
        self.heights[vertex as usize]
    }

    /// A vertex in model units, on the plane where it is within the tolerance.
    fn point(&self, vertex: u32) -> [f64; 3] {
        let point = self.surface.model_point(self.surface.same_place(vertex));
        if self.height(vertex) == 0.0 { self.plane.onto(point) } else { point }
    }

    /// Whether a point of the half lies on the plane, where all others are farther away than the tolerance.
    fn is_on_plane(&self, point: [f64; 3]) -> bool {
        self.plane.height(point).abs() <= self.tolerance
    }

    /// Whether a part of a triangle is kept.
    fn is_kept(&self, triangle: u32) -> bool {
        self.surface.triangles[triangle as usize].iter().any(|&v| self.height(v) > 0.0)
    }

    fn expect_crossed(&self) -> Result<(), SymmetryError> {
        let sides = [1.0, -1.0].map(|side| self.heights.iter().any(|height| height * side > 0.0));
        if sides == [true, true] {
            return Ok(());
        }
        let along = |v: u32| self.plane.axis.along(self.surface.model_point(v));
        let all = || (0..self.surface.vertex_count() as u32).map(along);
        let (low, high) = (all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max));
        Err(SymmetryError::OneSide { plane: self.plane, low, high })
    }

    /// Triangles in the plane that are no wider than the tolerance are left out; others are an error.
    fn expect_none_in_plane(&self) -> Result<(), SymmetryError> {
        let is_wide = |corners: &&[u32; 3]| {
            let [a, b, c] = corners.map(|v| DVec3::from(self.point(v)));
            let longest = (b - a).length().max((c - b).length()).max((a - c).length());
            corners.iter().all(|&v| self.height(v) == 0.0)
                && (b - a).cross(c - a).length() > 2.0 * self.tolerance * longest
        };
        let mut wide = self.surface.triangles.iter().filter(is_wide);
        let Some(first) = wide.next() else { return Ok(()) };
        let at = first.iter().map(|&v| DVec3::from(self.point(v))).sum::<DVec3>() / 3.0;
        Err(SymmetryError::InPlane { plane: self.plane, count: 1 + wide.count(), at: at.into() })
    }

    fn half(&self) -> Result<Half, SymmetryError> {
        let surface = self.surface;
        let mut parts = Parts::default();
        let regions = surface.regions();
        let mut sources = Vec::new();
        for triangle in (0..surface.triangle_count() as u32).filter(|&t| self.is_kept(t)) {
            let polygon = self.clipped(triangle, &mut parts);
            let corners: Vec<DVec3> =
                polygon.iter().map(|corner| DVec3::from(parts.points[corner.0 as usize])).collect();
            let number = |k: usize| polygon[k].0;
            let faces = match polygon.len() {
                4 if corners[0].distance_squared(corners[2]) <= corners[1].distance_squared(corners[3]) => {
                    vec![[0, 1, 2], [0, 2, 3]]
                }
                4 => vec![[0, 1, 3], [1, 2, 3]],
                _ => vec![[0, 1, 2]],
            };
            sources.extend(faces.iter().map(|_| triangle));
            parts.triangles.extend(faces.into_iter().map(|face| face.map(number)));
            self.note_sides(&polygon, &mut parts)?;
        }
        let rim = self.rim(&parts)?;
        let regions = Regions::of(regions, &sources);
        let soup = Soup { regions, ..Soup::new(parts.points, parts.triangles) };
        Ok(Half { soup, edges: parts.edges, rim })
    }

    /// The corners of the kept part of a triangle, each with the half-edge on which the side after it lies; `None` for a side that
    /// the cut makes.
    fn clipped(&self, triangle: u32, parts: &mut Parts) -> Vec<(u32, Option<u32>)> {
        let surface = self.surface;
        let mut polygon = Vec::with_capacity(4);
        for h in 3 * triangle..3 * triangle + 3 {
            let ends = [surface.origin(h), surface.target(h)];
            let [from, to] = ends.map(|v| self.height(v));
            if from >= 0.0 {
                let side = (from > 0.0 || to >= 0.0).then_some(h);
                polygon.push((parts.vertex(surface.same_place(ends[0]), || self.point(ends[0])), side));
            }
            if from * to < 0.0 {
                let key = ends.map(|v| surface.same_place(v));
                polygon.push((parts.crossing(key, || self.crossing(ends)), (to > 0.0).then_some(h)));
            }
        }
        polygon
    }

    /// The point of an edge on the plane; the same for both directions of the edge.
    fn crossing(&self, [a, b]: [u32; 2]) -> [f64; 3] {
        let [a, b] = if self.height(a) > 0.0 { [a, b] } else { [b, a] };
        let share = self.height(a) / (self.height(a) - self.height(b));
        self.plane.onto(DVec3::from(self.point(a)).lerp(self.point(b).into(), share).into())
    }

    /// Notes which sides of a kept part are on the rim, and which are features whatever their angle.
    fn note_sides(&self, polygon: &[(u32, Option<u32>)], parts: &mut Parts) -> Result<(), SymmetryError> {
        let surface = self.surface;
        let regions = &surface.regions().of_face;
        let region = |h: u32| regions.get(h as usize / 3);
        for (k, &(start, half_edge)) in polygon.iter().enumerate() {
            let end = polygon[(k + 1) % polygon.len()].0;
            let is_on_plane = [start, end].iter().all(|&v| self.is_on_plane(parts.points[v as usize]));
            let Some(h) = half_edge.filter(|_| !is_on_plane) else {
                if is_on_plane {
                    let shares = half_edge.and_then(|h| surface.twin(h)).is_some_and(|twin| self.is_kept(twin / 3));
                    if shares || !parts.rim.insert([start.min(end), start.max(end)]) {
                        return Err(self.touches(parts.points[start as usize]));
                    }
                }
                continue;
            };
            if surface.is_named(h) && surface.twin(h).is_some_and(|twin| h < twin && region(h) == region(twin)) {
                let name = "a feature edge of the surface".to_owned();
                parts.edges.push(NamedEdge { ends: Ends::Vertices([start, end]), name });
            }
        }
        Ok(())
    }

    /// The length of the rim, on which each vertex on the plane lies.
    fn rim(&self, parts: &Parts) -> Result<f64, SymmetryError> {
        let mut is_on_rim = vec![false; parts.points.len()];
        parts.rim.iter().flatten().for_each(|&v| is_on_rim[v as usize] = true);
        let is_lone = |(point, is_on_rim): &(&[f64; 3], bool)| !is_on_rim && self.is_on_plane(**point);
        if let Some((&point, _)) = parts.points.iter().zip(is_on_rim).find(is_lone) {
            return Err(self.touches(point));
        }
        let mut edges: Vec<[u32; 2]> = parts.rim.iter().copied().collect();
        edges.sort_unstable();
        let place = |v: u32| DVec3::from(parts.points[v as usize]);
        Ok(edges.iter().map(|&[a, b]| place(a).distance(place(b))).sum())
    }

    fn touches(&self, at: [f64; 3]) -> SymmetryError {
        SymmetryError::Touches { plane: self.plane, at }
    }
}

/// The half as far as it is made.
#[derive(Default)]
struct Parts {
    points: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
    edges: Vec<NamedEdge>,
    /// The numbers of the surface's vertices.
    vertices: FxHashMap<u32, u32>,
    /// The numbers of the points where edges cross the plane.
    crossings: FxHashMap<[u32; 2], u32>,
    /// The edges on the plane.
    rim: FxHashSet<[u32; 2]>,
}

impl Parts {
    fn vertex(&mut self, vertex: u32, point: impl FnOnce() -> [f64; 3]) -> u32 {
        let points = &mut self.points;
        *self.vertices.entry(vertex).or_insert_with(|| push(points, point()))
    }

    fn crossing(&mut self, [a, b]: [u32; 2], point: impl FnOnce() -> [f64; 3]) -> u32 {
        let points = &mut self.points;
        *self.crossings.entry([a.min(b), a.max(b)]).or_insert_with(|| push(points, point()))
    }
}

fn push(points: &mut Vec<[f64; 3]>, point: [f64; 3]) -> u32 {
    points.push(point);
    points.len() as u32 - 1
}
