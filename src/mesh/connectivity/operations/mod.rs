//! The operations: each proposes edits about the faces that it concerns.

mod paper;
mod recut;
mod rows;
mod search;
mod strips;
mod untangle;
mod walk;

pub(super) use paper::clean_up;
pub(super) use recut::dissolve;
pub(super) use strips::{pair_along_strips, put_rings};

use super::edit::Edit;
use super::{Engine, Kind};

/// An operation.
pub(super) struct Operation {
    /// Whether a face is worth a look.
    pub concerns: fn(&Engine, u32) -> bool,
    /// The edits about a face that may be worth it; all of them leave a manifold.
    pub propose: for<'e> fn(&'e Engine, u32) -> Vec<(Kind, Edit<'e>)>,
}

/// Triangles walk until they meet; rows between them come or go.
pub(super) const PAIR: Operation = Operation { concerns: is_triangle, propose: search::ways_out };
/// Quads about irregular vertices and faces of a poor shape are cut anew, or go.
pub(super) const RECUT: Operation = Operation { concerns: recut::is_poor, propose: recut::recuts };
/// Faults are cut anew, go, or are split; in one step, else in two.
pub(super) const UNTANGLE: [Operation; 2] = [
    Operation { concerns: is_fault, propose: untangle::once },
    Operation { concerns: is_fault, propose: untangle::twice },
];

fn is_triangle(engine: &Engine, face: u32) -> bool {
    engine.is_triangle(face)
}

fn is_fault(engine: &Engine, face: u32) -> bool {
    engine.is_fault(face)
}
