//! The operations: each proposes edits about the faces that it concerns.

mod caps;
mod disc;
mod paper;
mod quadrangulate;
mod recut;
mod rows;
mod search;
mod strips;
mod templates;
mod untangle;
mod walk;

pub(super) use paper::clean_up;
pub(super) use recut::dissolve;
pub(super) use strips::{pair_along_strips, put_rings};

use super::edit::Edit;
use super::{Engine, Kind};

/// An operation.
pub(super) struct Operation {
    /// Whether edits about a face are proposed.
    pub concerns: fn(&Engine, u32) -> bool,
    /// The proposed edits about a face; each keeps the mesh a manifold.
    pub propose: for<'e> fn(&'e Engine, u32) -> Vec<(Kind, Edit<'e>)>,
}

/// Triangles move until they meet; rows between them are inserted or removed.
pub(super) const PAIR: Operation = Operation { concerns: is_triangle, propose: search::ways_out };
/// Poor faces, and quads with irregular vertices, are recut or collapsed.
pub(super) const RECUT: Operation = Operation { concerns: recut::is_candidate, propose: recut::recuts };
/// Discs of several irregular vertices are quadrangulated anew.
pub(super) const QUADRANGULATE: Operation =
    Operation { concerns: quadrangulate::has_irregular, propose: quadrangulate::quadrangulations };
/// Faults are recut, collapsed or split, by one edit, by the best cut of a few faces, by two edits, or by a cap of
/// many.
pub(super) const UNTANGLE: [Operation; 4] = [
    Operation { concerns: is_fault, propose: untangle::once },
    Operation { concerns: is_fault, propose: untangle::unions },
    Operation { concerns: is_fault, propose: untangle::twice },
    Operation { concerns: is_fault, propose: caps::caps },
];

fn is_triangle(engine: &Engine, face: u32) -> bool {
    engine.is_triangle(face)
}

fn is_fault(engine: &Engine, face: u32) -> bool {
    engine.is_fault(face)
}
