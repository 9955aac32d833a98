//! Connectivity optimisation: one engine makes all local edits of faces.
//!
//! # Theory
//! An operation proposes edits about a face. The objective of the mesh evaluates an edit after the vertices
//! near it have relaxed: fewer faults come first, then less loss. Edits are made in rounds. Each face that an operation concerns
//! finds its best edit; the edits are evaluated again and made in the order of their gains; the faces near a change are
//! visited again in the next round.
//!
//! In a mesh of quads, a triangle with a vertex of valence 5 is the end of a row (a dislocation). Two ends that face each other
//! cancel when the row between them is removed; two ends that point away from each other cancel when a row is inserted. A
//! triangle moves when the pentagon that it forms with the quad beside it is cut in another way. At last, parts with more irregular
//! vertices than they need are quadrangulated anew.
//!
//! # Changes versus the paper
//! The paper's clean-up (section 3, figure 5) is the operation set of [`Quads::Paper`]. It evaluates edits with the vertices as
//! they are, and uses the field. The other operations are not in the paper.
//!
//! # Practice
//! Call [`optimise`] once, then [relocate](super::relocate), then [`untangle`] and relocation in turns until no fault is left, then
//! [`quadrangulate`], and the same again where it has changed the mesh.
//! [`Quads::Most`] is the default; [`Quads::All`] gives up shape for the last triangles; [`Quads::Paper`] is for comparison with the
//! paper.

pub(crate) mod edit;
pub(crate) mod operations;
mod patch;

use super::objective::{Context, Measure, POOR, Score, chord_loss};
use super::relocate::match_shapes;
use super::surface_mesh::SurfaceMesh;
use super::vertex::walked;
use crate::surface::Surface;
use edit::{Change, Edit, NEW};
use operations::Operation;
use patch::relaxed;
use rayon::prelude::*;
use rustc_hash::FxHashSet;
use serde::Serialize;

/// The triangles that become quads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quads {
    /// Those that the paper's clean-up finds.
    Paper,
    /// Those whose change improves the objective.
    #[default]
    Most,
    /// All, at any cost of shape.
    All,
}

impl Quads {
    /// The name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Paper => "paper",
            Self::Most => "most",
            Self::All => "all",
        }
    }
}

/// Options of the connectivity optimisation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConnectivityOptions {
    /// The triangles that become quads. Default [`Quads::Most`].
    pub quads: Quads,
    /// The price of a triangle: the loss that its removal may cost, in perfect quads. Default 0.8; 0 favours shape.
    pub triangle_price: f64,
    /// The least shape (Qg) that an edit may leave, unless a face near it has a smaller one before. Default 0.4; 0 still refuses
    /// concave quads.
    pub least_shape: f64,
    /// The longest row that is removed or inserted, in quads. Default 8.
    pub longest_row: usize,
    /// The number of positions of a triangle that its search visits. Default 10.
    pub searched: usize,
    /// The cost of a squared difference between a valence and the wanted one, in perfect quads, where quads are recut. Default
    /// 0: the shape alone counts, as rows end anyway. Use 1 where rows are continuous: it keeps them.
    pub regularity: f64,
    /// The number of vertices that edits keep near to. Default `None`: that of the mesh.
    pub wanted: Option<usize>,
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
            wanted: None,
        }
    }
}

/// The numbers of edits that were made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct EditCounts {
    /// The paper's (a): two triangles became one quad.
    pub merged: usize,
    /// The paper's (b): triangle, quad, triangle became two quads.
    pub recut_rows: usize,
    /// The paper's (c): two triangles at a vertex and the quads between them became quads.
    pub recut_fans: usize,
    /// The paper's (d): vertices removed.
    pub removed: usize,
    /// Pairs of triangles that moved until they met.
    pub met: usize,
    /// Rows removed.
    pub rows_out: usize,
    /// Rows inserted.
    pub rows_in: usize,
    /// Dual strips inserted so that all faces become quads.
    pub strips_in: usize,
    /// Dual strips removed so that all faces become quads.
    pub strips_out: usize,
    /// Edges flipped to another diagonal of their two faces.
    pub flipped: usize,
    /// Faces collapsed: two of their corners were merged.
    pub collapsed: usize,
    /// Discs quadrangulated anew, with fewer irregular vertices.
    pub quadrangulated: usize,
    /// Vertices of valence 2 inside the surface removed.
    pub dissolved: usize,
    /// Quads split into two triangles.
    pub split: usize,
    /// Vertices added on open boundaries so that all faces become quads.
    pub on_boundaries: usize,
    /// Vertices added on other features so that all faces become quads.
    pub on_features: usize,
    /// Faults before.
    pub faults_before: usize,
    /// Triangles before.
    pub triangles_before: usize,
    /// Triangles after.
    pub triangles_after: usize,
}

/// The kind of an edit.
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
    Quadrangulate,
}

impl Kind {
    /// The sweeps of local relaxation after an edit: none where its vertices are at their places.
    fn sweeps(self) -> usize {
        if self == Self::Quadrangulate { 0 } else { patch::SWEEPS }
    }
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
            Kind::Quadrangulate => &mut self.quadrangulated,
        } += 1;
    }
}

/// The most rounds. An edit near another one of the same round waits for the next.
const ROUNDS: usize = 12;
/// The number of vertices may differ from the wanted number by one for each of these vertices, ...
const VERTICES_PER_EXCESS: i64 = 150;
/// ... and on small meshes by this number.
const LEAST_EXCESS: i64 = 2;
/// The gain, in perfect quads, of a vertex less where there are too many by more than that, or of one more where there are too few.
const EXCESS_PRICE: f64 = 0.15;
/// Where discs are quadrangulated anew, the number may change by one for each of these vertices.
const VERTICES_PER_DISC_EXCESS: i64 = 100;
/// The price of a triangle with [`Quads::All`].
const ALL_PRICE: f64 = 3.0;
/// The least [`ConnectivityOptions::regularity`] where discs are quadrangulated anew.
const DISC_REGULARITY: f64 = 0.2;
/// The least [`ConnectivityOptions::regularity`] with [`Quads::All`].
const ALL_REGULARITY: f64 = 0.1;
/// An edit makes no vertex of a higher valence, unless one near it had that before: collapses one after the other would gather the
/// faces of a thin part at one vertex, with no fault and no shape.
const HIGHEST_VALENCE: usize = 9;
/// Passes of shape matching before poor quads are recut.
const PASSES: usize = 2;
/// The least gain of an edit.
const LEAST_GAIN: f64 = 1e-3;
/// The gain of one fault less, in perfect quads.
const FAULT_GAIN: f64 = 10.0;
/// The share by which an edit may lower the least shape near it. It is a tolerance for relaxation: unchanged faces move too.
const SHAPE_TOLERANCE: f64 = 1e-3;

/// Turns triangles into quads and recuts poor quads. Returns the numbers of edits.
pub fn optimise(context: &Context, mesh: &mut SurfaceMesh, options: &ConnectivityOptions) -> EditCounts {
    let mut engine = Engine::new(context, mesh, options);
    engine.counts.triangles_before = engine.triangles();
    engine.counts.faults_before = engine.faults();
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
        engine.options.regularity = options.regularity.max(ALL_REGULARITY);
    }
    let (options, excess, most_excess, counts) = (engine.options, engine.excess, engine.most_excess, engine.counts);
    let measures = match_shapes(context, mesh, PASSES).into_measures();
    let mut engine = Engine { context, mesh, measures, options, excess, most_excess, counts };
    engine.run(&[operations::RECUT]);
    operations::dissolve(&mut engine);
    engine.finish()
}

/// Untangles faces that are inverted, concave or without area, by edits; `counts` grows by these. Returns whether there are fewer
/// faults than before.
pub fn untangle(
    context: &Context,
    mesh: &mut SurfaceMesh,
    options: &ConnectivityOptions,
    counts: &mut EditCounts,
) -> bool {
    let mut engine = Engine::new(context, mesh, options);
    if engine.faults() == 0 {
        return false;
    }
    engine.counts = *counts;
    let before = engine.faults();
    engine.run(&operations::UNTANGLE);
    if options.quads == Quads::All {
        operations::put_rings(&mut engine);
    }
    let is_better = engine.faults() < before;
    *counts = engine.finish();
    is_better
}

/// Quadrangulates discs with more irregular vertices than they need anew; `counts` grow by these. Returns whether there were some.
pub fn quadrangulate(
    context: &Context,
    mesh: &mut SurfaceMesh,
    options: &ConnectivityOptions,
    counts: &mut EditCounts,
) -> bool {
    if options.quads == Quads::Paper {
        return false;
    }
    let regularity = options.regularity.max(DISC_REGULARITY);
    let mut engine = Engine::new(context, mesh, &ConnectivityOptions { regularity, ..*options });
    engine.counts = *counts;
    engine.run_within(VERTICES_PER_DISC_EXCESS, &[operations::QUADRANGULATE]);
    let before = counts.quadrangulated;
    *counts = engine.finish();
    counts.quadrangulated > before
}

/// The engine: a mesh while edits are made.
pub(crate) struct Engine<'a> {
    context: &'a Context<'a>,
    mesh: &'a mut SurfaceMesh,
    /// The measures of the faces.
    measures: Vec<Measure>,
    options: ConnectivityOptions,
    /// The number of vertices above the wanted one.
    excess: i64,
    /// The number of vertices may differ from the wanted number by so many.
    most_excess: i64,
    counts: EditCounts,
}

/// The best edit about a face. It holds no reference to the mesh, which may change before the edit is made.
struct Candidate {
    face: u32,
    kind: Kind,
    change: Change,
    /// In perfect quads, with that of a nearer number of vertices.
    gain: f64,
    evaluation: Evaluation,
}

/// The evaluation of an edit.
struct Evaluation {
    /// In perfect quads.
    gain: f64,
    /// Whether it removes a fault.
    has_fewer_faults: bool,
    /// The points of the vertices that relaxed.
    targets: Vec<(u32, glam::DVec3)>,
    /// The faces of the mesh that it changes, and those at their vertices.
    neighbourhood: Vec<u32>,
    /// All faces of the mesh that it depends on.
    dependencies: Vec<u32>,
}

impl<'a> Engine<'a> {
    fn new(context: &'a Context<'a>, mesh: &'a mut SurfaceMesh, options: &ConnectivityOptions) -> Self {
        let all = (0..mesh.face_bound() as u32).into_par_iter().with_min_len(1024);
        let measures = all.map(|face| mesh.measure(context, face)).collect();
        let used = (0..mesh.vertices().len() as u32).filter(|&v| !mesh.around(v).is_empty()).count();
        let excess = options.wanted.map_or(0, |wanted| used as i64 - wanted as i64);
        let (options, counts) = (*options, EditCounts::default());
        Self { context, mesh, measures, options, excess, most_excess: i64::MAX, counts }
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

    fn faults(&self) -> usize {
        self.measures.iter().filter(|measure| measure.is_fault).count()
    }

    fn is_triangle(&self, face: u32) -> bool {
        self.mesh.face(face).len() == 3
    }

    fn is_fault(&self, face: u32) -> bool {
        !self.mesh.face(face).is_empty() && self.measures[face as usize].is_fault
    }

    /// The faces that an operation concerns, in order.
    fn concerned(&self, operations: &[Operation]) -> Vec<u32> {
        let all = (0..self.mesh.face_bound() as u32).into_par_iter().with_min_len(4096);
        all.filter(|&face| operations.iter().any(|operation| (operation.concerns)(self, face))).collect()
    }

    /// Makes the best edit about each face that an operation concerns, in rounds, until none gains.
    fn run(&mut self, operations: &[Operation]) {
        self.run_within(VERTICES_PER_EXCESS, operations);
    }

    /// As [`Self::run`]; the number of vertices may differ from the wanted number by one for each of so many.
    fn run_within(&mut self, vertices_per_excess: i64, operations: &[Operation]) {
        self.most_excess = (self.mesh.vertices().len() as i64 / vertices_per_excess).max(LEAST_EXCESS);
        let mut waiting = self.concerned(operations);
        for _ in 0..ROUNDS {
            let best = |&face: &u32| self.best(operations, face);
            let mut candidates: Vec<Candidate> = waiting.par_iter().filter_map(best).collect();
            candidates.sort_by(|a, b| b.gain.total_cmp(&a.gain));
            let mut changed: FxHashSet<u32> = FxHashSet::default();
            let mut measured: FxHashSet<u32> = FxHashSet::default();
            let mut again = Vec::new();
            for Candidate { face, kind, change, evaluation, .. } in candidates {
                if self.context.is_cancelled() {
                    return;
                }
                if evaluation.neighbourhood.iter().any(|face| changed.contains(face)) {
                    again.push(face);
                    continue;
                }
                let edit = Edit::with(self.mesh, change);
                let excess = self.excess + edit.growth();
                // An earlier edit of the round may have moved vertices near this one.
                let evaluation = match evaluation.dependencies.iter().any(|face| measured.contains(face)) {
                    true => self.evaluate(kind, &edit),
                    false => Some(evaluation),
                };
                let is_made = |evaluation: &Evaluation| {
                    evaluation.gain + self.excess_gain(&edit) > LEAST_GAIN && self.holds(&edit, evaluation)
                };
                let Some(evaluation) = evaluation.filter(is_made) else { continue };
                let is_needed = evaluation.has_fewer_faults || evaluation.gain >= FAULT_GAIN;
                if excess.abs() > self.excess.abs().max(self.most_excess) && !is_needed {
                    continue;
                }
                changed.extend(edit.changed().map(|(face, _)| face).filter(|face| *face < NEW));
                again.extend(&evaluation.neighbourhood);
                let change = edit.into_change();
                let first_added = self.mesh.face_bound() as u32;
                let faces = self.make(&change, &evaluation.targets);
                again.extend(faces.iter().filter(|face| **face >= first_added));
                measured.extend(faces);
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

    /// The edit about a face that gains most, of the first operation that has one; none in a cancelled run. Where operations follow,
    /// it must [hold](Self::holds) about a fault, or else they would not be tried.
    fn best(&self, operations: &[Operation], face: u32) -> Option<Candidate> {
        if self.context.is_cancelled() {
            return None;
        }
        let must_hold = operations.len() > 1 && self.is_fault(face);
        let concerned = operations.iter().filter(|operation| (operation.concerns)(self, face));
        concerned.map(|operation| (operation.propose)(self, face)).find_map(|edits| {
            let evaluated = edits.into_iter().filter_map(|(kind, edit)| {
                let evaluation = self.evaluate(kind, &edit)?;
                Some((evaluation.gain + self.excess_gain(&edit), evaluation, kind, edit))
            });
            let mut gaining: Vec<_> = evaluated.filter(|(gain, ..)| *gain > LEAST_GAIN).collect();
            gaining.sort_by(|a, b| b.0.total_cmp(&a.0));
            let mut gaining = gaining.into_iter();
            let best = gaining.find(|(_, evaluation, _, edit)| !must_hold || self.holds(edit, evaluation));
            best.map(|(gain, evaluation, kind, edit)| Candidate {
                face,
                kind,
                change: edit.into_change(),
                gain,
                evaluation,
            })
        })
    }

    /// The evaluation of an edit after local relaxation; `None` where it adds a fault, leaves too small a shape, or gathers too many
    /// faces at a vertex.
    fn evaluate(&self, kind: Kind, edit: &Edit) -> Option<Evaluation> {
        let touched = edit.touched();
        let before = Edit::new(self.mesh);
        let highest_before = touched.iter().filter(|&&v| v < NEW).map(|&v| before.valence(v)).max();
        let highest = touched.iter().map(|&v| edit.valence(v)).max();
        if highest > highest_before.max(Some(HIGHEST_VALENCE)) {
            return None;
        }
        let relaxed = relaxed(self.context, edit, &self.measures, self.options.triangle_price, kind.sweeps());
        let (before, after) = (relaxed.before, relaxed.after);
        let least_shape = if kind == Kind::Quadrangulate { POOR } else { self.options.least_shape };
        let least = least_shape.min((1.0 - SHAPE_TOLERANCE) * relaxed.least_before);
        if after.faults > before.faults || (after.faults == before.faults && relaxed.least_after < least) {
            return None;
        }
        let regularity = self.options.regularity;
        let regularity_gain = if regularity > 0.0 { regularity * self.irregularity_removed(edit) } else { 0.0 };
        let gain = gain(before, after) + regularity_gain - self.chord_loss(edit);
        let old = |faces: Vec<u32>| faces.into_iter().filter(|face| *face < NEW).collect();
        let [neighbourhood, dependencies] = [relaxed.neighbourhood, relaxed.dependencies].map(old);
        let has_fewer_faults = after.faults < before.faults;
        Some(Evaluation { gain, has_fewer_faults, targets: relaxed.targets, neighbourhood, dependencies })
    }

    /// Whether an edit adds no fault once its vertices have walked to their places. On small triangles and beside features a
    /// walk may end elsewhere than the move in the tangent plane.
    fn holds(&self, edit: &Edit, evaluation: &Evaluation) -> bool {
        let mut walked_to = edit.clone();
        for &(v, target) in &evaluation.targets {
            let vertex = edit.vertex(v);
            let position = walked(self.surface(), vertex.triangles[0], vertex.point, target);
            walked_to.set_position(v, &position);
        }
        let vertices = edit.touched().into_iter().chain(evaluation.targets.iter().map(|&(v, _)| v));
        let mut faces: Vec<u32> = vertices.flat_map(|v| edit.around(v).collect::<Vec<_>>()).collect();
        faces.sort_unstable();
        faces.dedup();
        let changed: Vec<u32> = edit.changed().map(|(face, _)| face).collect();
        let old = faces.iter().chain(changed.iter().filter(|face| edit.face(**face).is_empty()));
        let before = old.filter(|&&face| face < NEW && self.is_fault(face)).count();
        faces.iter().filter(|&&face| walked_to.measure(self.context, face).is_fault).take(before + 1).count() <= before
    }

    /// The gain, in perfect quads, of a number of vertices that is nearer to those that it may be.
    fn excess_gain(&self, edit: &Edit) -> f64 {
        let excess = |growth: i64| ((self.excess + growth).abs() - self.most_excess).max(0);
        EXCESS_PRICE * (excess(0) - excess(edit.growth())) as f64
    }

    /// The growth of the loss of the feature edges' chords.
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

    /// The decrease of the sum of squared differences between valences and the wanted ones.
    fn irregularity_removed(&self, edit: &Edit) -> f64 {
        let before = Edit::new(self.mesh);
        let squared = |edit: &Edit, v: u32| if edit.valence(v) > 0 { edit.irregularity(v, 0) } else { 0.0 };
        let was = |v: u32| if v < NEW { squared(&before, v) } else { 0.0 };
        edit.touched().into_iter().map(|v| was(v) - squared(edit, v)).sum()
    }

    /// Makes a change and measures the faces that it touches; returns them.
    fn make(&mut self, change: &Change, targets: &[(u32, glam::DVec3)]) -> Vec<u32> {
        let first_vertex = self.mesh.vertices().len() as u32;
        let edit = Edit::with(self.mesh, change.clone());
        let mut touched = edit.touched();
        touched.extend(targets.iter().map(|&(v, _)| v));
        let removed: Vec<u32> = edit.changed().map(|(face, _)| face).filter(|face| *face < NEW).collect();
        change.make(self.mesh, self.surface(), targets);
        touched.iter_mut().filter(|v| **v >= NEW).for_each(|v| *v = *v - NEW + first_vertex);
        let mut faces: Vec<u32> = touched.iter().flat_map(|&v| self.mesh.around(v)).copied().chain(removed).collect();
        faces.sort_unstable();
        faces.dedup();
        self.measures.resize_with(self.mesh.face_bound(), || Measure::of(&[], None, None, || false));
        for &face in &faces {
            self.measures[face as usize] = self.mesh.measure(self.context, face);
        }
        faces
    }
}

/// The gain of an edit between two scores, in perfect quads.
fn gain(before: Score, after: Score) -> f64 {
    FAULT_GAIN * (f64::from(before.faults) - f64::from(after.faults)) + before.loss - after.loss
}
