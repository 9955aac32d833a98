//! The output: from a mosaic to a polygon mesh.

pub mod check;
mod collapse;
pub mod connect;
pub mod fill;
mod intrinsic;
pub mod quality;
pub mod triangulate;

pub use triangulate::Triangulation;

/// A polygon mesh: quads, triangles and, where holes were left, larger faces; counter-clockwise seen from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertex positions.
    pub points: Vec<[f64; 3]>,
    /// Vertex indices of all faces, one face after the other.
    corners: Vec<u32>,
    /// Where each face ends in `corners`.
    ends: Vec<u32>,
}

impl Mesh {
    /// A mesh of these vertices, with no face yet.
    pub fn new(points: Vec<[f64; 3]>) -> Self {
        Self { points, ..Self::default() }
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
}
