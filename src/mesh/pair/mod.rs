//! Triangles that meet: they walk, rows between them come or go, and quads remain.
//!
//! # Theory
//! In a mesh of quads a triangle with a vertex of valence 5 is where a row ends (a dislocation). Two such ends that face each
//! other cancel when the row between them goes; two that look away from each other, when a row is put in between; and a
//! triangle walks, since with the quad beside it it forms a pentagon that can be cut anew. Along the column beside it a walk
//! costs nothing (it glides), in other directions it leaves a vertex of valence 3 and one of valence 5 behind.
//!
//! From each triangle a uniform-cost search (`search.rs`) goes over its steps (`step.rs`) and tries rows (`rows.rs`) from the cheap ones,
//! where cost is the growth of the sum of squared differences of valences from what they should be: 4, and on features
//! one face for each right angle. The cheapest ends are settled (`settle.rs`): the vertices about them move to where they will
//! be in the end, and the shapes that result decide. Changes are made in the order of their gains, judged once more
//! when they are made; triangles near a change are looked at again in the next round.
//!
//! # Changes versus the paper
//! The paper has nothing of this; see design section 8 ("beyond the paper").
//!
//! # Practice
//! The eight models and the example at 6,000 points (judged by an independent meter): Qr 0.977 before all clean-up, 0.991
//! after, Qg 0.951, irregular vertices 2.3 %; with [`Quads::All`] Qr 1, Qg 0.937, 3.0 %. At 60,000 points m6_gen, spot and
//! fandisk have Qr 0.997, 0.993 and 0.997, and Qg 0.984, 0.969 and 0.977.
//!
//! The price of a triangle weighs Qr against Qg: 0.5, 0.7 and 0.8 gave plane Qr 0.968, 0.973 and 0.975, and Qg 0.915, 0.913 and
//! 0.912; 0.5, 0.7 and 1 gave anchor 0.987, 0.991 and 0.994, and 0.957, 0.956 and 0.954.
//! 326 triangles of m6_gen at 60,000 points take 0.2 s on two cores, most of it to settle drafts.
//!
//! Tried on m6_gen, fish_blub, anchor and plane (mean Qr, Qg) before vertices were touched up: a price of 0.5 gave 0.980, 0.949,
//! 1 gave 0.9885, 0.9445 and 2 gave 0.991, 0.942. Rows of at most 4 or 16 quads instead of 8, 30 or 200 drafts instead of 10 and 12 sweeps
//! of settling instead of 6 change neither by 0.001. Re-cutting the whole strip between two triangles in the best way, with
//! all vertices where they are, as was done before, paired next to none: a strip that leans by half a square is refused
//! for its shape before smoothing.
//!
//! With [`Quads::All`] triangles that are left are paired along ways of faces (`ways.rs`), and quads about irregular vertices
//! are cut anew (`polish.rs`). Walking them all the way, one cut at a time, left 4 of the nine models with 2 to 32 triangles
//! where each cut would make a concave quad, and gave Qg 0.922 and irregular vertices 4.0 % where ways gave 0.935 and 3.3 %.

mod draft;
mod polish;
mod rows;
mod search;
mod settle;
mod step;
pub mod upright;
mod ways;

use super::clean::Anchors;
use super::facing::Facing;
use super::{Mesh, Metric};
use crate::surface::{Surface, SurfacePoint, WALK_EDGES, walk};
use draft::{Draft, Scene};
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use rustc_hash::FxHashSet;
use search::End;
use serde::Serialize;
use settle::{Settled, settle, settle_anyhow};
use ways::Added;

/// Which triangles are to become quads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quads {
    /// Those that gain by it.
    #[default]
    Most,
    /// All, whatever it costs.
    All,
}

/// How [`pair`] works.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairOptions {
    /// Which triangles are to become quads. Default [`Quads::Most`].
    pub quads: Quads,
    /// How much of the sum of shapes a triangle less may cost, in perfect quads. Default 0.8; 0 asks for better shape.
    pub triangle_price: f64,
    /// No quad gets a smaller shape (Qg) than this unless one about it had. Default 0.4; 0 still refuses concave quads.
    pub least_shape: f64,
    /// Longest row that is taken out or put in, in quads. Default 8.
    pub longest_row: usize,
    /// Drafts from which a triangle's way out is looked for. Default 10.
    pub drafts: usize,
    /// What a squared difference of a valence from what it should be costs at least, in perfect quads, where quads are cut
    /// anew. Default 0: in meshes with rows that end it is the shape that counts. 1 leaves rows that pass as they are.
    pub regularity: f64,
    /// How many vertices there are more than wanted, before; the pairing keeps near the count that is wanted. Default 0.
    pub excess: i64,
}

impl Default for PairOptions {
    fn default() -> Self {
        Self {
            quads: Quads::default(),
            triangle_price: 0.8,
            least_shape: 0.4,
            longest_row: 8,
            drafts: 10,
            regularity: 0.0,
            excess: 0,
        }
    }
}

/// What [`pair`] did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct PairCounts {
    /// Pairs of triangles that walked until they met.
    pub met: usize,
    /// Rows taken out.
    pub rows_out: usize,
    /// Rows put in.
    pub rows_in: usize,
    /// Rows put in along ways through quads, so that all faces could be quads.
    pub ways_in: usize,
    /// Ways through quads along which faces were taken out, for the same.
    pub ways_out: usize,
    /// Edges turned between two quads.
    pub turned: usize,
    /// Quads that went when two opposite corners became one.
    pub merged: usize,
    /// Vertices inside the surface taken out, as only two faces had them.
    pub dissolved: usize,
    /// Vertices added on open boundaries, so that all faces could be quads.
    pub on_boundaries: usize,
    /// Vertices added on other features, for the same.
    pub on_features: usize,
    /// Faces that looked away from the surface, or had a straight corner, and do no more.
    pub set_upright: usize,
    /// Triangles before.
    pub triangles_before: usize,
    /// Triangles after the pairing.
    pub triangles_after: usize,
}

/// A mesh whose triangles were paired.
pub struct Paired {
    /// The mesh.
    pub mesh: Mesh,
    /// For each vertex its id in the old mesh; `u32::MAX` for a new one.
    pub kept: Vec<u32>,
    /// The triangle of the surface below each vertex that may move.
    pub below: Vec<Option<u32>>,
    /// Edges on features, the smaller id first, sorted.
    pub features: Vec<[u32; 2]>,
    /// What shapes are measured in.
    pub metric: Metric,
    /// What was done.
    pub counts: PairCounts,
}

/// Pairs triangles where that is worth it. `below` names the surface's triangle below each vertex, `None` where it is fixed.
pub fn pair(surface: &Surface, mesh: &Mesh, anchors: &Anchors, below: &[Option<u32>], options: &PairOptions) -> Paired {
    let mut work = Work::new(surface, mesh, anchors, below, options);
    let mut counts = PairCounts { triangles_before: work.faces(Work::is_triangle).len(), ..PairCounts::default() };
    work.run(Work::is_triangle, Work::best, &mut counts);
    if options.quads == Quads::All {
        work.options = PairOptions {
            triangle_price: DEAR,
            longest_row: 3 * options.longest_row,
            drafts: 10 * options.drafts,
            ..*options
        };
        work.run(Work::is_triangle, Work::best, &mut counts);
        let Added { ways_in, ways_out, met, on_boundaries, on_features } = work.pair_all();
        counts = PairCounts { ways_in, ways_out, met: counts.met + met, on_boundaries, on_features, ..counts };
        work.regularity = REGULARITY;
    }
    work.regularity = work.regularity.max(options.regularity);
    work.run(Work::is_poor, Work::better, &mut counts);
    counts.dissolved = work.dissolve();
    counts.triangles_after = work.faces(Work::is_triangle).len();
    let Work { scene, below, .. } = work;
    let Scene { editor, metric, features, .. } = scene;
    let (mesh, kept) = editor.finish();
    let metric = metric.of(&kept);
    let below = kept.iter().map(|&v| below[v as usize]).collect();
    let number = |v: u32| kept.binary_search(&v).ok().map(|place| place as u32);
    let mut features: Vec<[u32; 2]> =
        features.into_iter().filter_map(|[a, b]| Some([number(a)?, number(b)?])).collect();
    features.sort_unstable();
    let known = anchors.fixed.len() as u32;
    let kept = kept.into_iter().map(|v| if v < known { v } else { u32::MAX }).collect();
    Paired { mesh, kept, below, features, metric, counts }
}

#[derive(Clone, Copy)]
enum Kind {
    Met,
    RowOut,
    RowIn,
    Turned,
    Merged,
}

struct Work<'a> {
    surface: &'a Surface,
    scene: Scene,
    below: Vec<Option<u32>>,
    options: PairOptions,
    /// Vertices that have come, less those that have gone.
    drift: i64,
    /// What a squared difference of a valence from what it should be costs, in perfect quads.
    regularity: f64,
    /// Half-edges of the surface's boundary where other sheets meet it.
    seams: FxHashSet<u32>,
    /// What tells faces that look away from the surface, while those are what changes are made for.
    facing: Option<&'a Facing<'a>>,
    /// Whether such a change must leave no bad face about it.
    is_strict: bool,
}

/// Rounds at most; each leaves those for the next whose surroundings another has changed.
const ROUNDS: usize = 12;
/// The count of vertices changes by one in so many at most, since so many were asked for, ...
const DRIFT: i64 = 150;
/// ... but on small meshes by this.
const LEAST_DRIFT: i64 = 2;
/// The price of a triangle where all are to go.
const DEAR: f64 = 3.0;
/// What a squared difference of a valence costs, in perfect quads, where all are quads.
const REGULARITY: f64 = 0.1;
/// Drafts that gain less are not made.
const LEAST_GAIN: f64 = 1e-3;

impl<'a> Work<'a> {
    fn new(surface: &'a Surface, mesh: &Mesh, anchors: &Anchors, below: &[Option<u32>], options: &PairOptions) -> Self {
        let normals = anchors.normals.iter().map(|n| Vec3::from(*n).as_dvec3()).collect();
        let scene = Scene::new(mesh, normals, below, &anchors.feature_edges, Metric::new(anchors));
        Self::on(surface, scene, below, options)
    }

    fn on(surface: &'a Surface, mut scene: Scene, below: &[Option<u32>], options: &PairOptions) -> Self {
        for v in (0..).zip(&scene.fixed).filter(|(_, fixed)| **fixed).map(|(v, _)| v).collect::<Vec<u32>>() {
            scene.ideal[v as usize] = ideal_valence(&scene, v);
        }
        Self {
            surface,
            scene,
            below: below.to_vec(),
            options: *options,
            drift: options.excess,
            regularity: 0.0,
            seams: FxHashSet::default(),
            facing: None,
            is_strict: true,
        }
    }

    fn is_triangle(&self, face: u32) -> bool {
        self.scene.editor.face(face).len() == 3
    }

    /// All faces of a kind, in order.
    fn faces(&self, is_one: impl Fn(&Self, u32) -> bool + Sync) -> Vec<u32> {
        let all = (0..self.scene.editor.face_count() as u32).into_par_iter().with_min_len(4096);
        all.filter(|&face| is_one(self, face)).collect()
    }

    /// Makes the best change about each of the faces that are worth a look, in rounds, until none gains any more.
    fn run(
        &mut self,
        is_worth: impl Fn(&Self, u32) -> bool + Sync,
        best: impl Fn(&Self, u32) -> Option<Found> + Sync,
        counts: &mut PairCounts,
    ) {
        let mut waiting = self.faces(&is_worth);
        let most_drift = (self.scene.editor.vertex_count() as i64 / DRIFT).max(LEAST_DRIFT);
        for _ in 0..ROUNDS {
            let mut found: Vec<Found> = waiting.par_iter().filter_map(|face| best(self, *face)).collect();
            found.sort_by(|a, b| b.gain.total_cmp(&a.gain));
            let mut changed: FxHashSet<u32> = FxHashSet::default();
            let known = self.scene.editor.face_count() as u32;
            let mut again = Vec::new();
            for Found { face, kind, change, core, .. } in found {
                if core.iter().any(|face| *face < known && changed.contains(face)) {
                    again.push(face);
                    continue;
                }
                // Others may have moved what lies about it.
                let draft = change.onto(&self.scene);
                let Some(settled) = self.settled(&draft).filter(|settled| settled.gain > LEAST_GAIN) else { continue };
                let drift = self.drift + draft.growth();
                if drift.abs() > self.drift.abs().max(most_drift) {
                    continue;
                }
                self.drift = drift;
                changed.extend(draft.changed().map(|(face, _)| face));
                again.extend(settled.core);
                let change = Change::of(&draft);
                self.apply(&change, &settled.places);
                match kind {
                    Kind::Met => counts.met += 1,
                    Kind::RowOut => counts.rows_out += 1,
                    Kind::RowIn => counts.rows_in += 1,
                    Kind::Turned => counts.turned += 1,
                    Kind::Merged => counts.merged += 1,
                }
            }
            if changed.is_empty() {
                break;
            }
            again.sort_unstable();
            again.dedup();
            again.retain(|&face| is_worth(self, face));
            waiting = again;
        }
    }

    /// The best that can be done about a triangle, if anything gains.
    fn best(&self, triangle: u32) -> Option<Found> {
        self.best_of(triangle, self.search(triangle).into_iter().map(|End { kind, draft, .. }| (kind, draft)))
    }

    /// The draft about a face that gains most, if any does.
    fn best_of<'d>(&'d self, face: u32, drafts: impl IntoIterator<Item = (Kind, Draft<'d>)>) -> Option<Found> {
        drafts
            .into_iter()
            .filter_map(|(kind, draft)| {
                let Settled { gain, core, .. } = self.settled(&draft)?;
                Some(Found { face, kind, gain, core, change: Change::of(&draft) })
            })
            .filter(|found| found.gain > LEAST_GAIN)
            .reduce(|best, other| if other.gain > best.gain { other } else { best })
    }

    /// What a draft is worth, regularity counted.
    fn settled(&self, draft: &Draft) -> Option<Settled> {
        if let Some(facing) = self.facing {
            let settled = match self.is_strict {
                true => settle(draft, self.options.triangle_price, 0.0)?,
                false => settle_anyhow(draft, self.options.triangle_price),
            };
            return Some(Settled { gain: settled.gain + self.relief(facing, draft, &settled)?, ..settled });
        }
        let settled = settle(draft, self.options.triangle_price, self.options.least_shape)?;
        if self.regularity == 0.0 {
            return Some(settled);
        }
        let before = Draft::new(&self.scene);
        let known = |v: u32| v < before.first_copy() && before.around(v).next().is_some();
        let irregularity = |draft: &Draft, v: u32| draft.irregularity(v, 0);
        let relief: f64 = draft
            .touched()
            .into_iter()
            .map(|v| {
                let was = if known(v) { irregularity(&before, v) } else { 0.0 };
                let is = if draft.around(v).next().is_some() { irregularity(draft, v) } else { 0.0 };
                was - is
            })
            .sum();
        Some(Settled { gain: settled.gain + self.regularity * relief, ..settled })
    }

    /// Makes a change of the mesh as it is, and walks its vertices to their places.
    fn apply(&mut self, change: &Change, places: &[(u32, DVec3)]) {
        for &source in &change.copies {
            self.scene.editor.add_vertex(self.scene.editor.point(source));
            self.scene.normals.push(self.scene.normals[source as usize]);
            self.scene.ideal.push(self.scene.ideal[source as usize]);
            self.scene.fixed.push(self.scene.fixed[source as usize]);
            self.scene.metric.copy(source);
            self.below.push(self.below[source as usize]);
        }
        for (face, corners) in &change.faces {
            self.scene.editor.set_face(*face, corners);
        }
        for &(v, place) in places {
            let Some(triangle) = self.below[v as usize] else { continue };
            let foot = self.foot(triangle, self.scene.editor.point(v).into(), place);
            self.below[v as usize] = Some(foot.triangle);
            self.scene.editor.place(v, foot.position.as_dvec3().into());
            self.scene.normals[v as usize] = self.surface.normal(foot.triangle as usize).as_dvec3();
        }
    }

    /// Where the way over the surface, from a place above a triangle straight towards another one, ends.
    fn foot(&self, triangle: u32, from: DVec3, to: DVec3) -> SurfacePoint {
        let barrier = |h| self.surface.features().is_feature(h);
        let normal = self.surface.normal(triangle as usize);
        let way = (to - from).as_vec3();
        let way = way - normal * normal.dot(way);
        walk(self.surface, barrier, triangle, from.as_vec3(), way, WALK_EDGES)
    }
}

/// The best draft about a face, by value: the mesh may change before it is made.
struct Found {
    face: u32,
    kind: Kind,
    gain: f64,
    /// The faces that must still be as they were.
    core: Vec<u32>,
    change: Change,
}

/// What a draft changes.
struct Change {
    faces: Vec<(u32, Vec<u32>)>,
    copies: Vec<u32>,
    places: Vec<(u32, DVec3)>,
    /// How many faces and vertices the mesh had.
    known: [u32; 2],
}

impl Change {
    fn of(draft: &Draft) -> Self {
        Self {
            faces: draft.changed().map(|(face, corners)| (face, corners.to_vec())).collect(),
            copies: draft.copies().to_vec(),
            places: draft.places().to_vec(),
            known: [draft.scene.editor.face_count() as u32, draft.first_copy()],
        }
    }

    /// The draft again, on a mesh that may have grown.
    fn onto<'a>(&self, scene: &'a Scene) -> Draft<'a> {
        let mut draft = Draft::new(scene);
        let [faces, vertices] = self.known;
        let more = [scene.editor.face_count() as u32 - faces, scene.editor.vertex_count() as u32 - vertices];
        let moved = |id: u32, known: u32, more: u32| if id < known { id } else { id + more };
        self.copies.iter().for_each(|&source| {
            draft.copy(source);
        });
        for (face, corners) in &self.faces {
            let corners: Vec<u32> = corners.iter().map(|&v| moved(v, vertices, more[1])).collect();
            draft.set_face(moved(*face, faces, more[0]), &corners);
        }
        self.places.iter().for_each(|&(v, place)| draft.place(moved(v, vertices, more[1]), place));
        draft
    }
}

/// How many faces a vertex on a feature should have: between two feature edges, one a right angle.
fn ideal_valence(scene: &Scene, vertex: u32) -> u8 {
    let draft = Draft::new(scene);
    let mut total = 0;
    let is_barrier = |a: u32, b: u32| draft.across(a, b).is_none();
    let starts: Vec<u32> =
        draft.around(vertex).filter(|face| is_barrier(vertex, draft.wings(*face, vertex)[1])).collect();
    for start in starts {
        let (mut face, mut angle) = (start, 0.0);
        for _ in 0..64 {
            let [before, after] = draft.wings(face, vertex);
            let here = draft.point(vertex);
            angle += (draft.point(before) - here).angle_between(draft.point(after) - here);
            if is_barrier(before, vertex) {
                break;
            }
            let Some(next) = draft.left(vertex, before) else { break };
            face = next;
        }
        total += (angle / std::f64::consts::FRAC_PI_2).round().max(1.0) as u8;
    }
    if total == 0 { draft.valence(vertex) as u8 } else { total }
}
