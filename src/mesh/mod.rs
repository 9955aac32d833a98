//! The mesh: from a mosaic to a polygon mesh on the surface.
//!
//! # Theory
//! The tiles' centres are [triangulated](triangulate), the edges along the cross are [selected](connect), and the faces that they
//! enclose are [filled](fill). Then the [connectivity] is optimised and the vertices are [relocated](relocate). The
//! [finished](finish) mesh is compared with the surface.

mod attributes;
pub mod check;
pub mod compare;
pub mod connect;
pub mod connectivity;
pub(crate) mod cover;
pub mod fill;
pub mod finish;
pub(crate) mod incidence;
mod intrinsic;
pub mod join;
pub mod joints;
mod metric;
mod objective;
mod orientation;
mod placement;
pub(crate) mod polygon;
pub mod quality;
mod read;
mod regions;
pub mod relocate;
mod sheet_tree;
pub mod snap;
mod surface_mesh;
mod topology;
pub mod transfer;
pub mod triangulate;
mod uncovered;
mod vertex;

pub use attributes::{VertexAttributes, VertexKind};
pub use metric::Metric;
pub use objective::Context;
pub use read::{read_mesh, read_mesh_as};
pub(crate) use sheet_tree::Standing;
pub use surface_mesh::SurfaceMesh;
pub use topology::Topology;
pub use triangulate::Triangulation;
pub use vertex::{Place, Vertex};

use crate::surface::{Regions, Soup};
use glam::DVec3;
use rayon::prelude::*;

/// A polygon mesh: quads, triangles and, where holes were left, larger faces; counter-clockwise seen from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertex positions.
    pub points: Vec<[f64; 3]>,
    /// Vertex indices of all faces, one face after the other.
    corners: Vec<u32>,
    /// The end of each face in `corners`.
    ends: Vec<u32>,
    /// The named region of each face.
    pub regions: Regions,
}

impl Mesh {
    /// A mesh of these vertices, with no face yet.
    pub fn new(points: Vec<[f64; 3]>) -> Self {
        Self { points, ..Self::default() }
    }

    /// The mesh in model units; its vertices are in unit-sized coordinates before.
    pub(crate) fn placed(mut self, frame: &crate::surface::Frame) -> Self {
        self.points.iter_mut().for_each(|point| *point = frame.to_model(*point));
        self
    }

    /// Adds a face, its vertices in counter-clockwise order.
    pub fn push_face(&mut self, face: &[u32]) {
        self.corners.extend_from_slice(face);
        self.ends.push(self.corners.len() as u32);
    }

    /// The number of faces.
    pub fn face_count(&self) -> usize {
        self.ends.len()
    }

    /// The vertices of one face, in order.
    pub fn face(&self, index: usize) -> &[u32] {
        let start = if index == 0 { 0 } else { self.ends[index - 1] as usize };
        &self.corners[start..self.ends[index] as usize]
    }

    /// All faces, in order.
    pub fn faces(&self) -> impl ExactSizeIterator<Item = &[u32]> {
        (0..self.face_count()).map(|index| self.face(index))
    }

    /// The faces of four vertices, in order.
    pub fn quads(&self) -> impl Iterator<Item = [u32; 4]> {
        self.faces().filter_map(|face| face.try_into().ok())
    }

    /// The faces of three vertices, in order.
    pub fn triangles(&self) -> impl Iterator<Item = [u32; 3]> {
        self.faces().filter_map(|face| face.try_into().ok())
    }

    /// The point of a vertex.
    pub(crate) fn place(&self, vertex: u32) -> DVec3 {
        DVec3::from(self.points[vertex as usize])
    }

    /// The mean of the points of some vertices; of none, the origin.
    pub(crate) fn middle(&self, vertices: &[u32]) -> DVec3 {
        vertices.iter().map(|&vertex| self.place(vertex)).sum::<DVec3>() / vertices.len().max(1) as f64
    }

    /// The lengths of edges.
    pub(crate) fn lengths(&self, edges: &[Edge]) -> Vec<f64> {
        edges.iter().map(|edge| self.place(edge.ends[0]).distance(self.place(edge.ends[1]))).collect()
    }

    /// All undirected edges, sorted by their ends; each is listed once.
    pub fn edges(&self) -> Vec<Edge> {
        let mut sides: Vec<(u32, u32, bool)> = self
            .faces()
            .flat_map(|face| face.iter().zip(face.iter().cycle().skip(1)))
            .map(|(&a, &b)| (a.min(b), a.max(b), a < b))
            .collect();
        sides.par_sort_unstable();
        sides
            .chunk_by(|s, t| (s.0, s.1) == (t.0, t.1))
            .map(|same| {
                let along = same.iter().filter(|side| side.2).count() as u32;
                Edge { ends: [same[0].0, same[0].1], along, against: same.len() as u32 - along }
            })
            .collect()
    }
}

impl From<Soup> for Mesh {
    /// The triangles as faces, vertices in the same order.
    fn from(soup: Soup) -> Self {
        let ends = (1..=soup.triangles.len() as u32).map(|face| 3 * face).collect();
        Self { points: soup.points, corners: soup.triangles.into_flattened(), ends, regions: soup.regions }
    }
}

/// An undirected edge of a [`Mesh`], with the numbers of its faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edge {
    /// The two vertices, the smaller id first.
    pub ends: [u32; 2],
    /// Number of faces that run from `ends[0]` to `ends[1]`.
    pub along: u32,
    /// Number of faces that run from `ends[1]` to `ends[0]`.
    pub against: u32,
}

impl Edge {
    /// Whether it is a boundary edge: its faces lie on one side only.
    pub fn is_boundary(&self) -> bool {
        self.along == 0 || self.against == 0
    }
}
