//! All quads: a row is put in along a way of faces between two triangles that are left, whatever lies on it.
//!
//! # Theory
//! Each edge that the way crosses gets a vertex in its middle. A quad that the way goes straight through becomes two, one in
//! which it turns becomes three about a new vertex, and the triangles at the ends become quads.
//!
//! ```text
//!       p---o---o---s              p---o---o---s
//!     / |   |   |   | \          / |   |   |   | \
//!   z   |   |   |   |   w  ->  z   m---m---m---m   w      (m draws back from z, and so does the last from w)
//!     \ |   |   |   | /          \ |   |   |   | /
//!       q---o---o---t              q---o---o---t
//! ```
//!
//! Where there are too many vertices already, the faces on the way are taken out instead, if shape allows.
//!
//! Nothing refuses a row that is put in, so the triangles of a component, whose number is even where no boundary is, all find a partner. It
//! crosses features: they get the vertex. Of an odd number the last one's way leads out over an open boundary, which gets it.

use super::draft::Draft;
use super::rows::rename;
use super::settle::{settle, settle_anyhow};
use super::{Change, Work, step};
use crate::mesh::facing::Facing;
use crate::surface::Surface;
use crate::surface::nearest::{Triangles, nearest_on_segment};
use glam::DVec3;
use rayon::prelude::*;
use rustc_hash::{FxHashMap, FxHashSet};
use std::cmp::Reverse;
use std::collections::{BTreeSet, BinaryHeap};

/// What it costs to turn within a face, in faces.
const TURN: u32 = 4;
/// What it costs to cross an edge between vertices that cannot make room: the quads beside it stay half as wide.
const PINNED: u32 = 3;
/// What it costs to leave or reach a triangle over a feature, which takes a ring about its corner.
const FLAT: u32 = 20;
/// Rings at most that are put about corners for one way.
const RINGS: usize = 4;
/// The least shape of the quad that two triangles beside each other become.
const MEET_LEAST: f64 = 0.1;
/// The least shape of a quad where faces along a way are taken out.
const OUT_LEAST: f64 = 0.15;
/// What it costs to leave over an open boundary: no triangle does while there is another to meet.
const LEAVING: u32 = 1_000_000;
/// Outside the mesh.
const OUTSIDE: u32 = u32::MAX;

/// A side of a face and the face beyond.
type Passage = ([u32; 2], u32);

/// From a triangle to another one, or out.
struct Way {
    cost: u32,
    triangle: u32,
    passages: Vec<Passage>,
}

/// Vertices and rows that came.
#[derive(Default)]
pub(super) struct Added {
    pub(super) ways_in: usize,
    pub(super) ways_out: usize,
    pub(super) met: usize,
    pub(super) on_boundaries: usize,
    pub(super) on_features: usize,
}

impl Work<'_> {
    /// Pairs all triangles that are left, the nearest first.
    pub(super) fn pair_all(&mut self) -> Added {
        self.seams = seams(self.surface);
        let mut added = Added::default();
        let ways: Vec<Way> = self.faces(Self::is_triangle).into_par_iter().filter_map(|t| self.way(t, true)).collect();
        let mut heap: BinaryHeap<_> = (0..ways.len()).map(|k| Reverse((ways[k].cost, ways[k].triangle, k))).collect();
        let mut ways: Vec<Option<Way>> = ways.into_iter().map(Some).collect();
        while let Some(Reverse((_, triangle, k))) = heap.pop() {
            let Some(way) = ways[k].take() else { continue };
            if self.scene.editor.face(triangle).len() != 3 {
                continue;
            }
            if self.is_open(&way) {
                match *way.passages {
                    [(side, other)] if other != OUTSIDE => {
                        if self.meet(triangle, side, other) {
                            added.met += 1;
                        } else if let Some(way) = self.way(triangle, false) {
                            self.go(&way, &mut added);
                        }
                    }
                    _ => self.go(&way, &mut added),
                }
            } else if let Some(way) = self.way(triangle, true) {
                heap.push(Reverse((way.cost, triangle, ways.len())));
                ways.push(Some(way));
            }
        }
        added
    }

    /// Whether the mesh is still such that a way can be gone.
    fn is_open(&self, way: &Way) -> bool {
        let draft = Draft::new(&self.scene);
        let mut face = way.triangle;
        way.passages.iter().enumerate().all(|(k, &([a, b], next))| {
            let sides = if k + 1 == way.passages.len() { 3 } else { 4 };
            let open = draft.left(a, b) == Some(face)
                && draft.left(b, a).unwrap_or(OUTSIDE) == next
                && (next == OUTSIDE || draft.face(next).len() == sides);
            face = next;
            open
        })
    }

    /// Makes a quad of two triangles beside each other, unless it would have a straight corner or a reflex one.
    fn meet(&mut self, triangle: u32, [x, y]: [u32; 2], other: u32) -> bool {
        let draft = Draft::new(&self.scene);
        let corners = draft.face(triangle);
        let side = (0..3).find(|&k| corners[k] == x && corners[(k + 1) % 3] == y);
        let met = side.and_then(|side| Some(step::meet(&draft, triangle, side, other)?.1)).filter(Draft::is_sound);
        let Some((change, settled)) =
            met.and_then(|met| Some((Change::of(&met), settle(&met, self.options.triangle_price, MEET_LEAST)?)))
        else {
            return false;
        };
        self.apply(&change, &settled.places);
        true
    }

    /// The cheapest way from a triangle to another, or out, by Dijkstra's algorithm; to a triangle beside it only if asked.
    fn way(&self, triangle: u32, beside: bool) -> Option<Way> {
        let draft = Draft::new(&self.scene);
        let mut from: FxHashMap<u32, (u32, [u32; 2])> = FxHashMap::default();
        let mut done: FxHashSet<u32> = FxHashSet::default();
        let mut heap = BinaryHeap::from([Reverse((0, triangle, triangle, [0; 2]))]);
        while let Some(Reverse((cost, face, before, entry))) = heap.pop() {
            if !done.insert(face) {
                continue;
            }
            from.insert(face, (before, entry));
            let corners = if face == OUTSIDE { &[] } else { draft.face(face) };
            if face == OUTSIDE || (face != triangle && corners.len() == 3) {
                let mut passages = Vec::new();
                let mut at = face;
                while at != triangle {
                    let (before, side) = from[&at];
                    passages.push((side, at));
                    at = before;
                }
                passages.reverse();
                return Some(Way { cost, triangle, passages });
            }
            for k in 0..corners.len() {
                let side = [corners[k], corners[(k + 1) % corners.len()]];
                let next = draft.left(side[1], side[0]);
                let sides = next.map_or(0, |next| draft.face(next).len());
                let is_feature = next.is_none() || self.scene.is_feature(side[0], side[1]);
                if sides > 4 || (next.is_none() && !self.may_leave(side)) {
                    continue;
                }
                if face == triangle && sides == 3 && (is_feature || !beside) {
                    continue;
                }
                let ends = u32::from(face == triangle) + u32::from(sides == 3);
                let flat = if is_feature { ends * FLAT } else { 0 };
                let turn = if face != triangle && side.iter().any(|v| entry.contains(v)) { TURN } else { 0 };
                let leaving = if next.is_none() { LEAVING } else { 0 };
                let pinned = if side.iter().all(|&v| draft.is_fixed(v)) { PINNED } else { 0 };
                heap.push(Reverse((cost + 1 + flat + turn + pinned + leaving, next.unwrap_or(OUTSIDE), face, side)));
            }
        }
        None
    }

    /// Takes out what lies along a way, if there are too many vertices, or puts a row in.
    fn go(&mut self, way: &Way, added: &mut Added) {
        let out = (self.drift > 0).then(|| taken_out(&Draft::new(&self.scene), way)).flatten().filter(Draft::is_sound);
        let out = out.and_then(|out| {
            let settled = settle(&out, self.options.triangle_price, OUT_LEAST)?;
            Some((Change::of(&out), out.growth(), settled))
        });
        if let Some((change, growth, settled)) = out {
            self.apply(&change, &settled.places);
            self.drift += growth;
            added.ways_out += 1;
        } else {
            self.put_in(way, added);
            added.ways_in += 1;
        }
    }

    /// Puts a row in along a way.
    fn put_in(&mut self, way: &Way, added: &mut Added) {
        let marked = self.marked(way);
        let change = self.divided(&marked, added);
        let places = settle(&change.onto(&self.scene), self.options.triangle_price, 0.0).map(|settled| settled.places);
        self.apply(&change, &places.unwrap_or_default());
    }

    /// Gives edges a vertex each, and tells what becomes of their faces.
    fn divided(&mut self, marked: &BTreeSet<[u32; 2]>, added: &mut Added) -> Change {
        let draft = Draft::new(&self.scene);
        let mut faces: Vec<u32> =
            marked.iter().flat_map(|&[a, b]| [draft.left(a, b), draft.left(b, a)]).flatten().collect();
        faces.sort_unstable();
        faces.dedup();
        let middles: FxHashMap<[u32; 2], u32> = marked.iter().map(|&side| (side, self.split(side, added))).collect();
        let mut new: Vec<(u32, Vec<Vec<u32>>)> = Vec::new();
        for face in faces {
            let corners = self.scene.editor.face(face).to_vec();
            let sides = (0..corners.len()).map(|k| [corners[k], corners[(k + 1) % corners.len()]]);
            let on_sides: Vec<Option<u32>> = sides.map(|[a, b]| middles.get(&[a.min(b), a.max(b)]).copied()).collect();
            new.push((face, self.parts(face, &corners, &on_sides)));
        }
        let mut draft = Draft::new(&self.scene);
        for (face, parts) in &new {
            draft.set_face(*face, &parts[0]);
            parts[1..].iter().for_each(|part| {
                draft.add_face(part);
            });
        }
        Change::of(&draft)
    }

    /// Puts a ring of quads about a vertex of quads, if fewer faces look away or have straight corners then.
    pub(super) fn put_ring(&mut self, facing: &Facing, corner: u32) {
        let Some(ring) = self.ring(corner) else { return };
        let (features, drift) = (self.scene.features.clone(), self.drift);
        let change = self.divided(&ring, &mut Added::default());
        let draft = change.onto(&self.scene);
        let settled = settle_anyhow(&draft, self.options.triangle_price);
        if draft.is_sound() && self.relief(facing, &draft, &settled).is_some() {
            self.apply(&change, &settled.places);
        } else {
            // The new vertices are left without faces.
            (self.scene.features, self.drift) = (features, drift);
        }
    }

    /// The edges at a vertex, the smaller id first; `None` where one may not be split.
    fn ring(&self, corner: u32) -> Option<BTreeSet<[u32; 2]>> {
        let draft = Draft::new(&self.scene);
        let spokes: BTreeSet<u32> = draft.around(corner).flat_map(|face| draft.wings(face, corner)).collect();
        let may_split = |&w: &u32| {
            let closed = draft.left(corner, w).is_some() && draft.left(w, corner).is_some();
            closed || self.may_leave([corner, w])
        };
        let may_be = draft.around(corner).all(|face| draft.face(face).len() <= 4) && spokes.iter().all(may_split);
        may_be.then(|| spokes.into_iter().map(|w| [corner.min(w), corner.max(w)]).collect())
    }

    /// The edges that get a vertex, the smaller id first: those that the way crosses. A triangle that it leaves over a
    /// feature would be a quad with a straight corner there; it is split on all sides, by a ring about its other corner.
    fn marked(&self, way: &Way) -> BTreeSet<[u32; 2]> {
        let sorted = |a: u32, b: u32| [a.min(b), a.max(b)];
        let mut marked: BTreeSet<[u32; 2]> = way.passages.iter().map(|&([a, b], _)| sorted(a, b)).collect();
        // A ring may take away what another one has brought.
        for _ in 0..RINGS {
            let Some(corner) = self.straight(&marked) else { break };
            let Some(ring) = self.ring(corner) else { break };
            marked = marked.symmetric_difference(&ring).copied().collect();
        }
        marked
    }

    /// The corner opposite a side that lies on a feature and is the only one of a triangle to be split.
    fn straight(&self, marked: &BTreeSet<[u32; 2]>) -> Option<u32> {
        let draft = Draft::new(&self.scene);
        marked.iter().filter(|&&[a, b]| draft.across(a, b).is_none() || draft.across(b, a).is_none()).find_map(
            |&[a, b]| {
                let faces = [draft.left(a, b), draft.left(b, a)].into_iter().flatten();
                faces.filter(|&face| draft.face(face).len() == 3).find_map(|face| {
                    let corner = draft.face(face).iter().copied().find(|v| ![a, b].contains(v))?;
                    let alone = [a, b].iter().all(|&v| !marked.contains(&[v.min(corner), v.max(corner)]));
                    alone.then_some(corner)
                })
            },
        )
    }

    /// What a face is split into, given the new vertices on its sides: quads, but for a triangle with two, which is one
    /// still in its first part.
    fn parts(&mut self, face: u32, corners: &[u32], on_sides: &[Option<u32>]) -> Vec<Vec<u32>> {
        let count = corners.len();
        let corner = |k: usize| corners[k % count];
        let middle = |k: usize| on_sides[k % count];
        let met = |k: usize| Some([middle(k + count - 1)?, middle(k)?]);
        match on_sides.iter().flatten().count() {
            1 => {
                let halved = (0..count).flat_map(|k| [Some(corner(k)), middle(k)]).flatten();
                vec![halved.collect()]
            }
            2 if count == 3 => {
                let cut = (0..3).find_map(|k| Some((k, met(k)?)));
                cut.map_or(Vec::new(), |(k, [before, after])| {
                    vec![vec![corner(k), after, before], vec![after, corner(k + 1), corner(k + 2), before]]
                })
            }
            2 => match (0..4).find_map(|k| Some((k, met(k)?))) {
                Some((k, [before, after])) => {
                    let centre = self.middle(face);
                    vec![
                        vec![corner(k), after, centre, before],
                        vec![after, corner(k + 1), corner(k + 2), centre],
                        vec![corner(k + 2), corner(k + 3), before, centre],
                    ]
                }
                None => {
                    let first = usize::from(middle(0).is_none());
                    let across: Vec<u32> = [middle(first), middle(first + 2)].into_iter().flatten().collect();
                    vec![
                        vec![corner(first), across[0], across[1], corner(first + 3)],
                        vec![across[0], corner(first + 1), corner(first + 2), across[1]],
                    ]
                }
            },
            _ => {
                let centre = self.middle(face);
                (0..count)
                    .filter_map(|k| met(k).map(|[before, after]| vec![corner(k), after, centre, before]))
                    .collect()
            }
        }
    }

    /// A new vertex in the middle of an edge: on the feature, if the edge is on one.
    fn split(&mut self, [a, b]: [u32; 2], added: &mut Added) -> u32 {
        let scene = &self.scene;
        let middle = (DVec3::from(scene.editor.point(a)) + DVec3::from(scene.editor.point(b))) / 2.0;
        let draft = Draft::new(scene);
        let sides = [draft.left(a, b), draft.left(b, a)];
        let is_boundary = sides.contains(&None);
        if !is_boundary && !scene.is_feature(a, b) {
            let near: Vec<u32> = [a, b]
                .into_iter()
                .chain(sides.into_iter().flatten().flat_map(|f| draft.face(f).iter().copied()))
                .collect();
            return self.add_free(middle, &near);
        }
        let normal = (scene.normals[a as usize] + scene.normals[b as usize]).normalize_or_zero();
        let reach = middle.distance(DVec3::from(scene.editor.point(a)));
        let near = |place: &DVec3| place.distance(middle) < reach;
        let place = self.nearest_feature(middle).map(|(_, place)| place).filter(near).unwrap_or(middle);
        let vertex = self.add(a, place, normal, None, if is_boundary { 2 } else { 4 });
        self.scene.features.remove(&[a.min(b), a.max(b)]);
        self.scene.features.extend([[a, vertex], [b, vertex]]);
        *(if is_boundary { &mut added.on_boundaries } else { &mut added.on_features }) += 1;
        vertex
    }

    /// A new vertex in the middle of a face.
    fn middle(&mut self, face: u32) -> u32 {
        let corners = self.scene.editor.face(face).to_vec();
        let sum: DVec3 = corners.iter().map(|&v| DVec3::from(self.scene.editor.point(v))).sum();
        self.add_free(sum / corners.len() as f64, &corners)
    }

    /// A new vertex on the surface, reached from one of those near it.
    fn add_free(&mut self, place: DVec3, near: &[u32]) -> u32 {
        let from = near.iter().find_map(|&v| Some((v, self.below[v as usize]?)));
        let (triangle, place) = match from {
            Some((v, triangle)) => {
                let foot = self.foot(triangle, self.scene.editor.point(v).into(), place);
                (foot.triangle, foot.position.as_dvec3())
            }
            None => (Triangles::new(self.surface).nearest(place).0, place),
        };
        let normal = self.surface.normal(triangle as usize).as_dvec3();
        self.add(from.map_or(near[0], |(v, _)| v), place, normal, Some(triangle), 4)
    }

    /// A new vertex, for which rows are as far apart as at another.
    fn add(&mut self, like: u32, place: DVec3, normal: DVec3, below: Option<u32>, ideal: u8) -> u32 {
        self.scene.metric.copy(like);
        self.scene.normals.push(normal);
        self.scene.ideal.push(ideal);
        self.scene.fixed.push(below.is_none());
        self.below.push(below);
        self.drift += 1;
        self.scene.editor.add_vertex(place.into())
    }

    /// The half-edge of the surface's features that is nearest to a point, and its nearest point.
    fn nearest_feature(&self, point: DVec3) -> Option<(u32, DVec3)> {
        let surface = self.surface;
        (0..3 * surface.triangle_count() as u32)
            .filter(|&h| surface.features().is_feature(h))
            .map(|h| {
                let [a, b] = [surface.origin(h), surface.target(h)].map(|v| DVec3::from(surface.point(v)));
                (h, nearest_on_segment(point, a, b))
            })
            .min_by(|p, q| p.1.distance_squared(point).total_cmp(&q.1.distance_squared(point)))
    }

    /// Whether a boundary edge can get a vertex: not where other sheets meet there, which would need it as well.
    fn may_leave(&self, [a, b]: [u32; 2]) -> bool {
        let middle = (DVec3::from(self.scene.editor.point(a)) + DVec3::from(self.scene.editor.point(b))) / 2.0;
        self.seams.is_empty() || self.nearest_feature(middle).is_none_or(|(h, _)| !self.seams.contains(&h))
    }
}

/// The draft in which the ends of each edge that a way crosses are one, and the faces on it are gone; `None` where
/// features meet, or where the way leads out.
fn taken_out<'a>(draft: &Draft<'a>, way: &Way) -> Option<Draft<'a>> {
    let mut result = draft.clone();
    result.set_face(way.triangle, &[]);
    for &(_, face) in &way.passages {
        if face == OUTSIDE {
            return None;
        }
        result.set_face(face, &[]);
    }
    // What each vertex has become.
    let mut merged: Vec<[u32; 2]> = Vec::new();
    for &(side, _) in &way.passages {
        let [a, b] = side.map(|v| merged.iter().fold(v, |v, &[from, to]| if v == from { to } else { v }));
        let (stays, goes) = match (draft.is_fixed(a), draft.is_fixed(b)) {
            (true, true) => return None,
            (false, true) => (b, a),
            _ => (a, b),
        };
        if stays == goes {
            return None;
        }
        if !draft.is_fixed(stays) {
            result.place(stays, (result.point(a) + result.point(b)) / 2.0);
        }
        rename(&mut result, goes, stays, |_| true)?;
        merged.push([goes, stays]);
    }
    Some(result)
}

/// The half-edges of the surface's boundary where other sheets meet it.
pub(super) fn seams(surface: &Surface) -> FxHashSet<u32> {
    let shared = surface.shared_places();
    (0..3 * surface.triangle_count() as u32)
        .filter(|&h| surface.twin(h).is_none())
        .filter(|&h| [surface.origin(h), surface.target(h)].iter().all(|&v| shared[v as usize]))
        .collect()
}
