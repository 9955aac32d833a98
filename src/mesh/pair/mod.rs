//! Triangles that meet: they walk, rows between them go or come, and quads remain.
//!
//! # Theory
//! A triangle in a mesh of quads is where a row ends (a dislocation): two such ends cancel, or make a vertex of valence 3 and
//! one of valence 5. Which pairs, and on which way, is a search over drafts: from each triangle in turn, steps ([`step`])
//! and rows ([`rows`]), the cheapest first by how far valences are from what they should be. The best few are settled
//! ([`settle`]): the vertices about them move to where they would in the end, and the shapes that result decide.

mod draft;
mod rows;
mod settle;
mod step;

use super::Mesh;
use super::clean::Anchors;
use super::edit::Editor;
use crate::surface::{Surface, WALK_EDGES, walk};
use draft::{Draft, Scene};
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use rustc_hash::FxHashSet;
use serde::Serialize;
use settle::{Settled, settle};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// How [`pair`] works.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairOptions {
    /// How much of the sum of shapes a triangle less may cost, in perfect quads. Default 0.5.
    pub triangle_price: f64,
    /// No quad becomes worse than this shape (Qg) unless one about it was. Default 0.4.
    pub least_shape: f64,
    /// Longest row, in quads, that is taken out or put in. Default 8.
    pub longest_row: usize,
    /// Drafts that are looked at from each triangle. Default 60.
    pub drafts: usize,
}

impl Default for PairOptions {
    fn default() -> Self {
        let env = |n: &str, d: f64| std::env::var(n).ok().and_then(|s| s.parse().ok()).unwrap_or(d);
        Self { triangle_price: env("PRICE", 0.5), least_shape: env("LEAST", 0.4), longest_row: env("ROW", 8.0) as usize, drafts: env("DRAFTS", 60.0) as usize }
    }
}

/// What [`pair`] did.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct PairCounts {
    /// Pairs of triangles that walked until they met.
    pub met: usize,
    /// Rows taken out.
    pub rows_out: usize,
    /// Rows put in.
    pub rows_in: usize,
    /// Triangles before.
    pub triangles_before: usize,
    /// Triangles after.
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
    /// What was done.
    pub counts: PairCounts,
}

/// Pairs triangles where that is worth it. `below` names the surface's triangle below each vertex, `None` where it is fixed.
pub fn pair(surface: &Surface, mesh: &Mesh, anchors: &Anchors, below: &[Option<u32>], options: &PairOptions) -> Paired {
    let mut work = Work::new(surface, mesh, anchors, below, options);
    let mut counts = PairCounts { triangles_before: work.triangles().len(), ..PairCounts::default() };
    work.run(&mut counts);
    counts.triangles_after = work.triangles().len();
    let Work { scene, below, .. } = work;
    let (mesh, kept) = scene.editor.finish();
    let below = kept.iter().map(|&v| below[v as usize]).collect();
    let known = anchors.fixed.len() as u32;
    let kept = kept.into_iter().map(|v| if v < known { v } else { u32::MAX }).collect();
    Paired { mesh, kept, below, counts }
}

#[derive(Clone, Copy)]
enum Kind {
    Met,
    RowOut,
    RowIn,
}

struct Work<'a> {
    surface: &'a Surface,
    scene: Scene<'a>,
    below: Vec<Option<u32>>,
    options: &'a PairOptions,
}

/// Rounds at most; each leaves those for the next whose surroundings another has changed.
const ROUNDS: usize = 12;
/// Drafts of one triangle that are settled.
const SETTLED: usize = 3;
/// What a step costs besides, in squared valences.
const STEP: f64 = 0.1;
/// What each quad of a row costs besides.
const LENGTH: f64 = 0.1;
/// Drafts that cost more are not followed.
const MOST: f64 = 2.6;

impl<'a> Work<'a> {
    fn new(
        surface: &'a Surface,
        mesh: &Mesh,
        anchors: &'a Anchors,
        below: &[Option<u32>],
        options: &'a PairOptions,
    ) -> Self {
        let mut scene = Scene {
            editor: Editor::new(mesh),
            normals: anchors.normals.iter().map(|n| Vec3::from(*n).as_dvec3()).collect(),
            ideal: vec![4; mesh.points.len()],
            fixed: below.iter().map(Option::is_none).collect(),
            features: &anchors.feature_edges,
        };
        for v in (0..).zip(&scene.fixed).filter(|(_, fixed)| **fixed).map(|(v, _)| v).collect::<Vec<u32>>() {
            scene.ideal[v as usize] = ideal_valence(&scene, v);
        }
        Self { surface, scene, below: below.to_vec(), options }
    }

    fn triangles(&self) -> Vec<u32> {
        let editor = &self.scene.editor;
        (0..editor.face_count() as u32).filter(|face| editor.face(*face).len() == 3).collect()
    }

    fn run(&mut self, counts: &mut PairCounts) {
        let mut waiting = self.triangles();
        for _ in 0..ROUNDS {
            let mut found: Vec<(Kind, Settled)> = waiting.par_iter().filter_map(|t| self.best(*t)).collect();
            found.sort_by(|a, b| b.1.gain.total_cmp(&a.1.gain));
            let mut stamped: FxHashSet<u32> = FxHashSet::default();
            let mut chosen = Vec::new();
            let mut again = Vec::new();
            for (kind, settled) in found {
                if settled.faces.iter().any(|face| stamped.contains(face)) {
                    again.extend(settled.faces);
                } else {
                    stamped.extend(&settled.faces);
                    chosen.push((kind, Change::of(settled)));
                }
            }
            if chosen.is_empty() {
                break;
            }
            for (kind, change) in chosen {
                match kind {
                    Kind::Met => counts.met += 1,
                    Kind::RowOut => counts.rows_out += 1,
                    Kind::RowIn => counts.rows_in += 1,
                }
                again.extend(change.faces.iter().map(|face| face.0));
                again.extend(&change.about);
                self.apply(&change);
            }
            again.sort_unstable();
            again.dedup();
            waiting = self.triangles().into_iter().filter(|t| again.binary_search(t).is_ok()).collect();
        }
    }

    /// The best that can be done about a triangle, if anything gains.
    fn best(&self, triangle: u32) -> Option<(Kind, Settled<'_>)> {
        let mut ends = self.search(triangle);
        ends.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        ends.into_iter()
            .filter(|end| end.draft.is_sound())
            .take(SETTLED)
            .filter_map(|end| {
                settle(end.draft, self.options.triangle_price, self.options.least_shape).map(|s| (end.kind, s))
            })
            .filter(|(_, settled)| settled.gain > 1e-3)
            .reduce(|best, other| if other.1.gain > best.1.gain { other } else { best })
    }

    /// Drafts in which the triangle is no more, by uniform-cost search over its steps.
    fn search(&self, triangle: u32) -> Vec<End<'_>> {
        let start = Node { draft: Draft::new(&self.scene), triangle, cost: 0.0, order: 0 };
        let mut seen: FxHashSet<[u32; 3]> = FxHashSet::default();
        let mut heap = BinaryHeap::from([start]);
        let mut ends = Vec::new();
        let mut order = 0;
        for _ in 0..self.options.drafts {
            let Some(Node { draft, triangle, cost, .. }) = heap.pop() else { break };
            let [a, b, c] = [0, 1, 2].map(|k| draft.face(triangle)[k]);
            let mut key = [a, b, c];
            key.sort_unstable();
            if !seen.insert(key) {
                continue;
            }
            let first_only = order == 0 || cost < 0.5;
            for side in 0..3 {
                let [x, y, z] = [0, 1, 2].map(|k| [a, b, c][(side + k) % 3]);
                if first_only {
                    if let Some(row) = rows::take_out(&draft, triangle, side, self.options.longest_row) {
                        ends.push(End::new(Kind::RowOut, row, &self.scene));
                    }
                    for row in rows::put_in(&draft, triangle, z, self.options.longest_row) {
                        ends.push(End::new(Kind::RowIn, row, &self.scene));
                    }
                }
                let Some(next) = draft.across(x, y) else { continue };
                match draft.face(next).len() {
                    3 => {
                        if let Some(met) = step::meet(&draft, triangle, side, next) {
                            ends.push(End::new(Kind::Met, met, &self.scene));
                        }
                    }
                    4 => {
                        for stepped in step::steps(&draft, triangle, side, next) {
                            let cost = cost_of(&stepped) + STEP * stepped.changed().count() as f64;
                            if cost < MOST {
                                order += 1;
                                heap.push(Node { draft: stepped, triangle: next, cost, order });
                            }
                        }
                    }
                    _ => {}
                }
            }
        }
        ends
    }

    fn apply(&mut self, change: &Change) {
        let first_face = self.scene.editor.face_count() as u32;
        let first_vertex = self.scene.editor.vertex_count() as u32;
        let vertex = |v: u32| if v >= change.first_copy { v - change.first_copy + first_vertex } else { v };
        for &(_, source) in &change.copies {
            self.scene.editor.add_vertex(self.scene.editor.point(source));
            self.scene.normals.push(self.scene.normals[source as usize]);
            self.scene.ideal.push(4);
            self.scene.fixed.push(false);
            self.below.push(self.below[source as usize]);
        }
        for (face, corners) in &change.faces {
            let face = if *face >= change.first_face { face - change.first_face + first_face } else { *face };
            let corners: Vec<u32> = corners.iter().map(|v| vertex(*v)).collect();
            self.scene.editor.set_face(face, &corners);
        }
        let barrier = |h| self.surface.features().is_feature(h);
        for &(v, place) in &change.places {
            let v = vertex(v);
            let Some(triangle) = self.below[v as usize] else { continue };
            let from = DVec3::from(self.scene.editor.point(v)).as_vec3();
            let normal = self.surface.normal(triangle as usize);
            let way = place.as_vec3() - from;
            let way = way - normal * normal.dot(way);
            let foot = walk(self.surface, barrier, triangle, from, way, WALK_EDGES);
            self.below[v as usize] = Some(foot.triangle);
            self.scene.editor.place(v, foot.position.as_dvec3().into());
            self.scene.normals[v as usize] = self.surface.normal(foot.triangle as usize).as_dvec3();
        }
    }
}

/// A draft that has left the search, by value.
struct Change {
    faces: Vec<(u32, Vec<u32>)>,
    copies: Vec<(u32, u32)>,
    places: Vec<(u32, DVec3)>,
    /// Faces that only moved.
    about: Vec<u32>,
    first_face: u32,
    first_copy: u32,
}

impl Change {
    fn of(settled: Settled) -> Self {
        let draft = settled.draft;
        Self {
            faces: draft.changed().map(|(face, corners)| (face, corners.to_vec())).collect(),
            copies: draft.copies().collect(),
            places: draft.places().to_vec(),
            about: settled.faces,
            first_face: draft.scene.editor.face_count() as u32,
            first_copy: draft.first_copy(),
        }
    }
}

/// A triangle that has walked.
struct Node<'a> {
    draft: Draft<'a>,
    triangle: u32,
    cost: f64,
    order: u32,
}

impl Ord for Node<'_> {
    fn cmp(&self, other: &Self) -> Ordering {
        other.cost.total_cmp(&self.cost).then(other.order.cmp(&self.order))
    }
}

impl PartialOrd for Node<'_> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Node<'_> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Node<'_> {}

/// A draft in which two triangles are no more.
struct End<'a> {
    kind: Kind,
    draft: Draft<'a>,
    cost: f64,
}

impl<'a> End<'a> {
    fn new(kind: Kind, draft: Draft<'a>, _scene: &Scene) -> Self {
        let cost = cost_of(&draft) + LENGTH * draft.changed().count() as f64;
        Self { kind, draft, cost }
    }
}

/// How much more irregular a draft is than the mesh as it is.
fn cost_of(draft: &Draft) -> f64 {
    let now = Draft::new(draft.scene);
    draft
        .touched()
        .into_iter()
        .map(|v| {
            let after = if draft.around(v).next().is_none() { 0.0 } else { draft.irregularity(v) };
            let before = if v >= draft.first_copy() { 0.0 } else { now.irregularity(v) };
            after - before
        })
        .sum()
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
