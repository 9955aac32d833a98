//! The input: triangles read or generated, welded, oriented, with adjacency and features.

pub mod examples;
pub mod load;
mod polygon;

/// Triangles as a file or a generator gives them: not welded, not oriented, in model units.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Soup {
    /// Corner positions, in model units.
    pub points: Vec<[f64; 3]>,
    /// Indices into `points`, three a triangle.
    pub triangles: Vec<[u32; 3]>,
}
