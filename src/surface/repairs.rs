//! Repairs made between soup and surface.

use serde::Serialize;

/// Places that are kept of each kind of repair.
const PLACES: usize = 10;

/// The number of repairs of one kind, and where.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Repair {
    /// How many.
    pub count: usize,
    /// Where, in model units: the first ten places.
    pub at: Vec<[f64; 3]>,
}

impl Repair {
    /// Counts one more.
    pub(super) fn note(&mut self, place: impl FnOnce() -> [f64; 3]) {
        self.count += 1;
        if self.at.len() < PLACES {
            self.at.push(place());
        }
    }
}

/// Repairs made between soup and surface.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Repairs {
    /// Points that were joined to another at the same place.
    pub welded_points: Repair,
    /// Points that no triangle uses.
    pub unused_points: Repair,
    /// Triangles without area that were dropped: two of their corners are one.
    pub degenerate_triangles: Repair,
    /// Triangles that were given more than once, orientation aside.
    pub duplicate_triangles: Repair,
    /// Parts smaller than a hundred-thousandth of the model's size, which were dropped.
    pub dropped_specks: Repair,
    /// Triangles that were reversed.
    pub flipped_triangles: Repair,
    /// Edges of more than two triangles: sheets end there, and the mesh is joined again along them.
    pub joined_edges: Repair,
    /// Vertices that were added because several fans of triangles touch in one place; the mesh is joined again there.
    pub joined_vertices: Repair,
    /// Triangles without height whose longest edge was exchanged for the other diagonal.
    pub flipped_caps: Repair,
}
