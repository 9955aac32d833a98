//! Sizes: the wanted side of the tiles at each vertex of the surface.
//!
//! # Theory
//! Sizes are relative, linear in each triangle; a tile's side is the size times a scale. A tile of side `h` covers the area `h^2`,
//! one on an open boundary half of it, so that `count = integral of 1 / h^2 over the area + half the integral of 1 / h along
//! boundaries`.
//!
//! # Changes versus the paper
//! The paper's tiles are equal; here that is the default.
//!
//! # Practice
//! Sizes vary as finely as the surface's triangles do; [`crate::pipeline::prepare`] divides triangles that are too large for their
//! tiles. The neighbour grid has cells for the largest tile: the time grows with the square of a range of sides above about
//! ten.

mod file;
mod growth;
mod local;
mod wanted;

pub use file::{SizeFileError, SizeSample, parse_sizes, read_sizes, samples};
pub use local::{LocalSize, NoLocalSize, Place};
pub use wanted::SizeOptions;
pub(crate) use wanted::Wanted;

use crate::geometry::barycentric;
use crate::surface::{NONE, Surface};
use glam::Vec3;
pub(crate) use growth::Growth;
use std::iter::zip;
use thiserror::Error;

/// Why numbers are not sizes of a surface.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum SizesError {
    /// Their number is not that of the vertices.
    #[error("{given} sizes for a surface of {vertices} vertices; give one for each")]
    Count {
        /// The sizes that were given.
        given: usize,
        /// The vertices.
        vertices: usize,
    },
    /// One is not a positive number.
    #[error("the size {size} of vertex {vertex} is not a number above 0")]
    NotPositive {
        /// The vertex, counted from 0.
        vertex: usize,
        /// Its size.
        size: f32,
    },
    /// The surface has no place for which a size is given.
    #[error("the surface has no {place}, for which a size is given{}", known(.regions))]
    Nowhere {
        /// The place.
        place: String,
        /// The regions that it has, where one is asked for.
        regions: Vec<String>,
    },
    /// The least side is larger than the largest.
    #[error("the least size {least} is larger than the largest, {largest}")]
    Range {
        /// The least side, in model units.
        least: f64,
        /// The largest side, in model units.
        largest: f64,
    },
}

fn known(regions: &[String]) -> String {
    if regions.is_empty() { String::new() } else { format!("; its regions are {}", regions.join(", ")) }
}

/// A relative tile side at each vertex of a surface.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sizes {
    /// Empty: 1 everywhere.
    relative: Vec<f32>,
    /// Of curves with an asked number of tiles.
    intervals: Vec<Intervals>,
}

/// A closed curve of the surface's features with a number of tiles that is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Intervals {
    /// The curve, by its index.
    pub curve: usize,
    /// The number of tiles round it.
    pub count: usize,
}

impl Sizes {
    /// 1 everywhere.
    pub fn equal() -> Self {
        Self::default()
    }

    /// These sides at the surface's vertices; vertices at one place, as where sheets meet, take the least of theirs.
    ///
    /// # Errors
    /// Where there is not one positive number for each vertex.
    pub fn from_vertices(surface: &Surface, mut relative: Vec<f32>) -> Result<Self, SizesError> {
        let vertices = surface.vertex_count();
        if relative.len() != vertices {
            return Err(SizesError::Count { given: relative.len(), vertices });
        }
        if let Some(vertex) = relative.iter().position(|size| !(size.is_finite() && *size > 0.0)) {
            return Err(SizesError::NotPositive { vertex, size: relative[vertex] });
        }
        let first = |v: usize| surface.same_place(v as u32) as usize;
        for v in 0..vertices {
            relative[first(v)] = relative[first(v)].min(relative[v]);
        }
        for v in 0..vertices {
            relative[v] = relative[first(v)];
        }
        Ok(Self { relative, intervals: Vec::new() })
    }

    /// With numbers of tiles round closed curves of the surface.
    pub fn with_intervals(self, intervals: Vec<Intervals>) -> Self {
        Self { intervals, ..self }
    }

    /// The closed curves with a number of tiles that is asked for.
    pub fn intervals(&self) -> &[Intervals] {
        &self.intervals
    }

    /// The product of the two at each vertex, with the intervals of the first.
    pub fn times(&self, other: &Self) -> Self {
        let relative = match (self.is_equal(), other.is_equal()) {
            (_, true) => self.relative.clone(),
            (true, _) => other.relative.clone(),
            _ => zip(&self.relative, &other.relative).map(|(a, b)| a * b).collect(),
        };
        Self { relative, intervals: self.intervals.clone() }
    }

    /// Lowered where they grow faster than allowed: by at most `growth - 1` sides a side along the surface's edges, where
    /// tiles have `side` (in unit-sized coordinates) times these sizes.
    pub fn limited(&self, surface: &Surface, side: f64, growth: f64) -> Self {
        if self.is_equal() {
            return self.clone();
        }
        let mut sides: Vec<f64> = self.relative.iter().map(|&size| side * f64::from(size)).collect();
        Growth::new(surface).limit(&mut sides, growth - 1.0);
        Self { relative: sides.iter().map(|h| (h / side) as f32).collect(), ..self.clone() }
    }

    /// Whether they are 1 everywhere by construction.
    pub fn is_equal(&self) -> bool {
        self.relative.is_empty()
    }

    /// The relative side at a vertex.
    pub fn at_vertex(&self, vertex: u32) -> f32 {
        self.relative.get(vertex as usize).copied().unwrap_or(1.0)
    }

    /// The largest of them.
    pub fn largest(&self) -> f32 {
        self.relative.iter().copied().reduce(f32::max).unwrap_or(1.0)
    }

    /// The relative side at a point of a triangle.
    pub(crate) fn at(&self, surface: &Surface, triangle: u32, position: Vec3) -> f32 {
        if self.is_equal() {
            return 1.0;
        }
        let [a, b, c] = surface.triangles[triangle as usize].map(|v| self.at_vertex(v));
        let [to_b, to_c] = barycentric(surface.corners(triangle as usize), position);
        a + (b - a) * to_b + (c - a) * to_c
    }

    /// The length of an edge in tiles of scale 1: the integral of `1 / size` along it.
    pub(crate) fn length(&self, surface: &Surface, half_edge: u32) -> f64 {
        let [a, b] = [surface.origin(half_edge), surface.target(half_edge)].map(|v| f64::from(self.at_vertex(v)));
        let length = surface.length(half_edge);
        // The second form is the first one's limit, and exact to twelve digits where it is used.
        if (b - a).abs() > 1e-4 * a { length * (b / a).ln() / (b - a) } else { length * 2.0 / (a + b) }
    }

    /// Twice the integral of `1 / size^2` over a triangle, by the middles of its edges.
    pub(crate) fn double_area(&self, surface: &Surface, triangle: usize) -> f64 {
        let [a, b, c] = surface.triangles[triangle].map(|v| f64::from(self.at_vertex(v)));
        let inverse = |x: f64, y: f64| 4.0 / ((x + y) * (x + y));
        f64::from(surface.double_area(triangle)) * ((inverse(a, b) + inverse(b, c) + inverse(c, a)) / 3.0)
    }

    /// The number of tiles at this scale (in unit-sized coordinates) that a surface takes: the inverse of
    /// [`Sizes::side_for_count`].
    pub fn count_for_side(&self, surface: &Surface, side: f64) -> f64 {
        let (area, boundary) = self.extent(surface);
        area / (side * side) + boundary / (2.0 * side)
    }

    /// The scale for `count` tiles: inner tiles cover a square each, tiles on an open boundary half of one.
    pub fn side_for_count(&self, surface: &Surface, count: usize) -> f32 {
        let (area, boundary) = self.extent(surface);
        // count = area / h^2 + boundary / (2 h), solved for 1 / h.
        let half = boundary / 2.0;
        let inverse = ((half * half + 4.0 * area * count as f64).sqrt() - half) / (2.0 * area);
        (1.0 / inverse) as f32
    }

    /// The area and the length of all open boundaries, in tiles of scale 1.
    fn extent(&self, surface: &Surface) -> (f64, f64) {
        let area = (0..surface.triangle_count()).map(|t| self.double_area(surface, t) / 2.0).sum();
        let on_boundary = (0..surface.twins.len() as u32).filter(|&h| surface.twins[h as usize] == NONE);
        (area, on_boundary.map(|h| self.length(surface, h)).sum())
    }
}
