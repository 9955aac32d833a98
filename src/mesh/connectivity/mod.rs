//! Connectivity optimisation: local edits of faces, one engine for all of them.
//!
//! # Theory
//! An [operation](operations) proposes edits about a face. An edit is judged by the [objective](super::objective) once the
//! vertices about it have relaxed, and made where it gains: first of all fewer faults, then less loss. Edits are made in
//! rounds: each face that is worth a look finds its best edit, the edits are made in the order of their gains and judged once
//! more when they are made, and the faces near a change look again in the next round.
//!
//! The operations that turn triangles into quads rest on this: in a mesh of quads a triangle with a vertex of valence 5 is where
//! a row ends (a dislocation). Two ends that face each other cancel when the row between them goes; two that look away from
//! each other, when a row is put in between; and a triangle walks, since with the quad beside it it forms a pentagon that
//! can be cut anew.
//!
//! # Changes versus the paper
//! The paper's clean-up (section 3, figure 5) is the operation set in `operations/paper.rs`. It judges positions as they
//! are and asks the field; the rest is beyond the paper.

pub(crate) mod edit;
pub(crate) mod operations;
mod patch;

use super::objective::{Context, Measure, Score, chord_loss};
use super::relocate::match_shapes;
use super::surface_mesh::SurfaceMesh;
use crate::surface::Surface;
use edit::{Change, Edit, NEW};
use operations::Operation;
use patch::relaxed;
use rayon::prelude::*;
use rustc_hash::FxHashSet;
use serde::Serialize;

/// Which triangles are to become quads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quads {
    /// Those that the paper's clean-up finds.
    Paper,
    /// Those that gain by it.
    #[default]
    Most,
    /// All, whatever it costs.
    All,
}

/// How the connectivity is optimised.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConnectivityOptions {
    /// Which triangles are to become quads. Default [`Quads::Most`].
    pub quads: Quads,
    /// The loss that one triangle less may cost, in perfect quads. Default 0.8; 0 asks for better shape.
    pub triangle_price: f64,
    /// No quad gets a smaller shape (Qg) than this unless one about it had. Default 0.4; 0 still refuses concave quads.
    pub least_shape: f64,
    /// Longest row that is taken out or put in, in quads. Default 8.
    pub longest_row: usize,
    /// Places of a walking triangle from which a way out is looked for. Default 10.
    pub searched: usize,
    /// The least cost of a squared difference of a valence from the wanted one, in perfect quads, where quads are cut anew.
    /// Default 0: in meshes with rows that end it is the shape that counts. 1 leaves continuous rows as they are.
    pub regularity: f64,
    /// The number of vertices above the wanted one, before; the count is kept near the wanted one. Default 0.
    pub excess: i64,
}

impl Default for ConnectivityOptions {
    fn default() -> Self {
        Self {
            quads: Quads::default(),
            triangle_price: 0.8,
            least_shape: 0.4,
            longest_row: 8,
            searched: 10,
            regularity: 0.0,
            excess: 0,
        }
    }
}

/// The edits that were made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct EditCounts {
    /// The paper's (a): two triangles made one quad.
    pub merged: usize,
    /// The paper's (b): triangle, quad, triangle made two quads.
    pub recut_rows: usize,
    /// The paper's (c): two triangles at a vertex and the quads between them made quads.
    pub recut_fans: usize,
    /// The paper's (d): vertices taken out.
    pub removed: usize,
    /// Pairs of triangles that walked until they met.
    pub met: usize,
    /// Rows taken out.
    pub rows_out: usize,
    /// Rows put in.
    pub rows_in: usize,
    /// Dual strips put in, so that all faces could be quads.
    pub strips_in: usize,
    /// Dual strips taken out, for the same.
    pub strips_out: usize,
    /// Edges flipped to another diagonal of their two faces.
    pub flipped: usize,
    /// Faces that went when two of their corners became one.
    pub collapsed: usize,
    /// Vertices inside the surface taken out, as only two faces had them.
    pub dissolved: usize,
    /// Quads cut into two triangles, as they were faults.
    pub split: usize,
    /// Vertices added on open boundaries, so that all faces could be quads.
    pub on_boundaries: usize,
    /// Vertices added on other features, for the same.
    pub on_features: usize,
    /// Triangles before.
    pub triangles_before: usize,
    /// Triangles after.
    pub triangles_after: usize,
}

/// What an edit does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Merge,
    RecutRow,
    RecutFan,
    Remove,
    Meet,
    RowOut,
    RowIn,
    Flip,
    Collapse,
    Split,
    Ring,
}

impl EditCounts {
    fn count(&mut self, kind: Kind) {
        *match kind {
            Kind::Merge => &mut self.merged,
            Kind::RecutRow => &mut self.recut_rows,
            Kind::RecutFan => &mut self.recut_fans,
            Kind::Remove => &mut self.removed,
            Kind::Meet => &mut self.met,
            Kind::RowOut => &mut self.rows_out,
            Kind::RowIn => &mut self.rows_in,
            Kind::Flip => &mut self.flipped,
            Kind::Collapse => &mut self.collapsed,
            Kind::Split => &mut self.split,
            Kind::Ring => &mut self.strips_in,
        } += 1;
    }
}

/// Rounds at most; each leaves those for the next whose surroundings another has changed.
const ROUNDS: usize = 12;
/// The count of vertices changes by one in so many at most, since so many were asked for, ...
const DRIFT: i64 = 150;
/// ... but on small meshes by this.
const LEAST_DRIFT: i64 = 2;
/// The price of a triangle where all are to go.
const ALL_PRICE: f64 = 3.0;
/// The cost of a squared difference of a valence, in perfect quads, where all are quads.
const REGULARITY: f64 = 0.1;
/// Passes of relocation before poor quads are cut anew.
const PASSES: usize = 2;
/// Edits that gain less are not made.
const LEAST_GAIN: f64 = 1e-3;
/// The gain of a fault less, in perfect quads.
const FAULT: f64 = 10.0;
/// An edit may lower the least shape about it by this share: a shape that nothing changed would fail a sharper test.
const ROUNDING: f64 = 1e-3;

/// Turns triangles into quads and cuts poor quads anew, as the options ask. Vertices move only where faces change.
pub fn optimise(context: &Context, mesh: &mut SurfaceMesh, options: &ConnectivityOptions) -> EditCounts {
    let mut engine = Engine::new(context, mesh, options);
    engine.counts.triangles_before = engine.triangles();
    if options.quads == Quads::Paper {
        operations::clean_up(&mut engine);
        return engine.finish();
    }
    engine.run(&[operations::PAIR]);
    if options.quads == Quads::All {
        let longest_row = 3 * options.longest_row;
        engine.options =
            ConnectivityOptions { triangle_price: ALL_PRICE, longest_row, searched: 10 * options.searched, ..*options };
        engine.run(&[operations::PAIR]);
        operations::pair_along_strips(&mut engine);
        engine.options.regularity = options.regularity.max(REGULARITY);
    }
    let (options, excess, counts) = (engine.options, engine.excess, engine.counts);
    match_shapes(context, mesh, PASSES);
    let mut engine = Engine { options, excess, counts, ..Engine::new(context, mesh, &options) };
    engine.run(&[operations::RECUT]);
    operations::dissolve(&mut engine);
    engine.finish()
}

/// Mends faults: faces that are inverted, concave or without area. The vertices about the edits, which `counts` gets, have
/// relaxed. False where there is nothing to mend or nothing helps.
pub fn untangle(
    context: &Context,
    mesh: &mut SurfaceMesh,
    options: &ConnectivityOptions,
    counts: &mut EditCounts,
) -> bool {
    let mut engine = Engine::new(context, mesh, options);
    if !engine.measures.iter().any(|measure| measure.is_fault) {
        return false;
    }
    engine.counts = *counts;
    engine.run(&operations::UNTANGLE);
    if options.quads == Quads::All {
        operations::put_rings(&mut engine);
    }
    let before = std::mem::replace(counts, engine.finish());
    before != *counts
}

/// A mesh under work.
pub(crate) struct Engine<'a> {
    context: &'a Context<'a>,
    mesh: &'a mut SurfaceMesh,
    /// The measures of the faces as they are.
    measures: Vec<Measure>,
    options: ConnectivityOptions,
    /// The number of vertices above the wanted one.
    excess: i64,
    counts: EditCounts,
}

/// The best edit about a face, by value: the mesh may change before it is made.
struct Found {
    face: u32,
    kind: Kind,
    change: Change,
    judged: Judged,
}

/// What an edit is worth.
struct Judged {
    gain: f64,
    targets: Vec<(u32, glam::DVec3)>,
    /// The old faces that must still be as they were.
    core: Vec<u32>,
}

impl<'a> Engine<'a> {
    fn new(context: &'a Context<'a>, mesh: &'a mut SurfaceMesh, options: &ConnectivityOptions) -> Self {
        let all = (0..mesh.face_bound() as u32).into_par_iter().with_min_len(1024);
        let measures = all.map(|face| mesh.measure(context, face)).collect();
        Self { context, mesh, measures, options: *options, excess: options.excess, counts: EditCounts::default() }
    }

    fn finish(mut self) -> EditCounts {
        self.counts.triangles_after = self.triangles();
        self.counts
    }

    fn surface(&self) -> &'a Surface {
        self.context.surface
    }

    fn triangles(&self) -> usize {
        self.mesh.faces().filter(|face| face.len() == 3).count()
    }

    fn is_triangle(&self, face: u32) -> bool {
        self.mesh.face(face).len() == 3
    }

    fn is_fault(&self, face: u32) -> bool {
        !self.mesh.face(face).is_empty() && self.measures[face as usize].is_fault
    }

    /// All faces that an operation concerns, in order.
    fn concerned(&self, operations: &[Operation]) -> Vec<u32> {
        let all = (0..self.mesh.face_bound() as u32).into_par_iter().with_min_len(4096);
        all.filter(|&face| operations.iter().any(|operation| (operation.concerns)(self, face))).collect()
    }

    /// Makes the best edit about each face that an operation concerns, in rounds, until none gains any more.
    fn run(&mut self, operations: &[Operation]) {
        let mut waiting = self.concerned(operations);
        let most_excess = (self.mesh.vertices().len() as i64 / DRIFT).max(LEAST_DRIFT);
        for _ in 0..ROUNDS {
            let best = |&face: &u32| self.best(operations, face);
            let mut found: Vec<Found> = waiting.par_iter().filter_map(best).collect();
            found.sort_by(|a, b| b.judged.gain.total_cmp(&a.judged.gain));
            let mut changed: FxHashSet<u32> = FxHashSet::default();
            let mut again = Vec::new();
            for Found { face, kind, change, judged } in found {
                if judged.core.iter().any(|face| changed.contains(face)) {
                    again.push(face);
                    continue;
                }
                let edit = Edit::with(self.mesh, change);
                let excess = self.excess + edit.growth();
                // An earlier change may have moved what lies about this one.
                let judged = self.judge(&edit).filter(|judged| judged.gain > LEAST_GAIN);
                let Some(judged) = judged else { continue };
                if excess.abs() > self.excess.abs().max(most_excess) && judged.gain < FAULT {
                    continue;
                }
                changed.extend(edit.changed().map(|(face, _)| face).filter(|face| *face < NEW));
                again.extend(&judged.core);
                let change = edit.into_change();
                again.extend(self.make(&change, &judged.targets));
                self.excess = excess;
                self.counts.count(kind);
            }
            if changed.is_empty() {
                break;
            }
            again.sort_unstable();
            again.dedup();
            again.retain(|&face| operations.iter().any(|operation| (operation.concerns)(self, face)));
            waiting = again;
        }
    }

    /// The edit about a face that gains most, of the first operation that has one.
    fn best(&self, operations: &[Operation], face: u32) -> Option<Found> {
        let concerned = operations.iter().filter(|operation| (operation.concerns)(self, face));
        concerned.map(|operation| (operation.propose)(self, face)).find_map(|edits| {
            edits
                .into_iter()
                .filter_map(|(kind, edit)| Some((self.judge(&edit)?, kind, edit)))
                .filter(|(judged, ..)| judged.gain > LEAST_GAIN)
                .reduce(|best, other| if other.0.gain > best.0.gain { other } else { best })
                .map(|(judged, kind, edit)| Found { face, kind, change: edit.into_change(), judged })
        })
    }

    /// What an edit is worth once the vertices about it have relaxed; `None` where it adds a fault or a quad of too small a shape.
    fn judge(&self, edit: &Edit) -> Option<Judged> {
        let relaxed = relaxed(self.context, edit, &self.measures, self.options.triangle_price);
        let (before, after) = (relaxed.before, relaxed.after);
        let least = self.options.least_shape.min((1.0 - ROUNDING) * relaxed.least_before);
        if after.faults > before.faults || (after.faults == before.faults && relaxed.least_after < least) {
            return None;
        }
        let relief = if self.options.regularity > 0.0 { self.options.regularity * self.relief(edit) } else { 0.0 };
        let gain = gain(before, after) + relief - self.chord_loss(edit);
        let core = relaxed.core.into_iter().filter(|face| *face < NEW).collect();
        Some(Judged { gain, targets: relaxed.targets, core })
    }

    /// By how much the loss of chords of feature curves grows.
    fn chord_loss(&self, edit: &Edit) -> f64 {
        let distance = |[a, b]: [u32; 2], curve: u32| {
            let line = self.context.curve(curve);
            let [from, to] = self.mesh.arcs(self.context, [a, b], curve)?;
            Some(line.chord_distance(self.surface(), from, to) / self.mesh.mean_edge_at(a).max(f64::MIN_POSITIVE))
        };
        let loss = |edge: [u32; 2], curve: Option<u32>| {
            let is_old = edge.iter().all(|&v| v < NEW);
            curve.filter(|_| is_old).and_then(|curve| distance(edge, curve)).map_or(0.0, chord_loss)
        };
        edit.changed_features().map(|(edge, [before, after])| loss(edge, after) - loss(edge, before)).sum()
    }

    /// By how much the sum of squared differences of valences from the wanted ones falls.
    fn relief(&self, edit: &Edit) -> f64 {
        let before = Edit::new(self.mesh);
        let squared = |edit: &Edit, v: u32| if edit.valence(v) > 0 { edit.irregularity(v, 0) } else { 0.0 };
        let was = |v: u32| if v < NEW { squared(&before, v) } else { 0.0 };
        edit.touched().into_iter().map(|v| was(v) - squared(edit, v)).sum()
    }

    /// Makes a change and measures the faces that it touches; returns the new ones.
    fn make(&mut self, change: &Change, targets: &[(u32, glam::DVec3)]) -> Vec<u32> {
        let first_vertex = self.mesh.vertices().len() as u32;
        let edit = Edit::with(self.mesh, change.clone());
        let mut touched = edit.touched();
        touched.extend(targets.iter().map(|&(v, _)| v));
        let gone: Vec<u32> = edit.changed().map(|(face, _)| face).filter(|face| *face < NEW).collect();
        let added = change.make(self.mesh, self.surface(), targets);
        touched.iter_mut().filter(|v| **v >= NEW).for_each(|v| *v = *v - NEW + first_vertex);
        let mut faces: Vec<u32> = touched.iter().flat_map(|&v| self.mesh.around(v)).copied().chain(gone).collect();
        faces.sort_unstable();
        faces.dedup();
        self.measures.resize_with(self.mesh.face_bound(), || Measure::of(&[], None, None, || false));
        for face in faces {
            self.measures[face as usize] = self.mesh.measure(self.context, face);
        }
        added
    }
}

/// The gain of an edit between two scores, in perfect quads.
fn gain(before: Score, after: Score) -> f64 {
    FAULT * (f64::from(before.faults) - f64::from(after.faults)) + before.loss - after.loss
}
