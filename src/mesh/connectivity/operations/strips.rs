//! All quads: a dual strip is put in between two triangles that are left, whatever lies on it.
//!
//! # Theory
//! A strip crosses the faces between two triangles. Each edge that it crosses gets a vertex in its middle. A quad that it
//! goes straight through becomes two, one in which it turns becomes three about a new vertex, and the triangles at the ends
//! become quads.
//!
//! ```text
//!       p---o---o---s              p---o---o---s
//!     / |   |   |   | \          / |   |   |   | \
//!   z   |   |   |   |   w  ->  z   m---m---m---m   w      (m draws back from z, and so does the last from w)
//!     \ |   |   |   | /          \ |   |   |   | /
//!       q---o---o---t              q---o---o---t
//! ```
//!
//! Where there are too many vertices already, the faces on the strip are taken out instead, if shape allows.
//!
//! Nothing refuses a strip that is put in, so the triangles of a component, whose number is even where no boundary is, all find
//! a partner. It crosses features: they get the vertex. Of an odd number the last one's strip leads out over an open boundary,
//! which gets it.

use super::super::edit::{Change, Edit, NEW};
use super::super::patch::relaxed;
use super::super::{Engine, Kind, LEAST_GAIN};
use super::walk;
use crate::mesh::incidence::{sides, undirected};
use crate::mesh::surface_mesh::{Place, Vertex, walked};
use crate::surface::NONE;
use glam::DVec3;
use rayon::prelude::*;
use rustc_hash::{FxHashMap, FxHashSet};
use std::cmp::Reverse;
use std::collections::{BTreeSet, BinaryHeap};

/// What it costs to turn within a face, in faces.
const TURN: u32 = 4;
/// What it costs to cross an edge between vertices that cannot make room: the quads beside it stay half as wide.
const FIXED: u32 = 3;
/// What it costs to leave or reach a triangle over a feature, which takes a ring about its corner.
const FLAT: u32 = 20;
/// Rings at most that are put about corners for one strip.
const RINGS: usize = 4;
/// The least shape of the quad that two triangles beside each other become.
const MEET_LEAST: f64 = 0.1;
/// The least shape of a quad where faces along a strip are taken out.
const OUT_LEAST: f64 = 0.15;
/// What it costs to leave over an open boundary: no triangle does while there is another to meet.
const LEAVING: u32 = 1_000_000;
/// Outside the mesh.
const OUTSIDE: u32 = NONE;

/// From a triangle to another one, or out.
struct Strip {
    cost: u32,
    triangle: u32,
    /// The sides that it crosses, each with the face beyond.
    crossings: Vec<([u32; 2], u32)>,
}

/// Pairs all triangles that are left, the nearest first.
pub(in super::super) fn pair_along_strips(engine: &mut Engine) {
    let triangles: Vec<u32> = (0..engine.mesh.face_bound() as u32).filter(|&face| engine.is_triangle(face)).collect();
    let strips: Vec<Strip> = triangles.into_par_iter().filter_map(|t| find_strip(engine, t, true)).collect();
    let mut heap: BinaryHeap<_> = (0..strips.len()).map(|k| Reverse((strips[k].cost, strips[k].triangle, k))).collect();
    let mut strips: Vec<Option<Strip>> = strips.into_iter().map(Some).collect();
    while let Some(Reverse((_, triangle, k))) = heap.pop() {
        let Some(strip) = strips[k].take() else { continue };
        if !engine.is_triangle(triangle) {
            continue;
        }
        if is_open(engine, &strip) {
            match *strip.crossings {
                [(side, other)] if other != OUTSIDE => {
                    if meet(engine, triangle, side, other) {
                        engine.counts.met += 1;
                    } else if let Some(strip) = find_strip(engine, triangle, false) {
                        go(engine, &strip);
                    }
                }
                _ => go(engine, &strip),
            }
        } else if let Some(strip) = find_strip(engine, triangle, true) {
            heap.push(Reverse((strip.cost, triangle, strips.len())));
            strips.push(Some(strip));
        }
    }
}

/// Whether the mesh is still such that a strip can be gone along.
fn is_open(engine: &Engine, strip: &Strip) -> bool {
    let edit = Edit::new(engine.mesh);
    let mut face = strip.triangle;
    strip.crossings.iter().enumerate().all(|(k, &([a, b], next))| {
        let corners = if k + 1 == strip.crossings.len() { 3 } else { 4 };
        let open = edit.left(a, b) == Some(face)
            && edit.left(b, a).unwrap_or(OUTSIDE) == next
            && (next == OUTSIDE || edit.face(next).len() == corners);
        face = next;
        open
    })
}

/// Makes a quad of two triangles beside each other, unless it would have a straight corner or a reflex one.
fn meet(engine: &mut Engine, triangle: u32, [x, y]: [u32; 2], other: u32) -> bool {
    let edit = Edit::new(engine.mesh);
    let corners = edit.face(triangle);
    let side = (0..3).find(|&k| corners[k] == x && corners[(k + 1) % 3] == y);
    let met = side.and_then(|side| Some(walk::meet(&edit, triangle, side, other)?.1)).filter(Edit::is_sound);
    met.map(Edit::into_change).is_some_and(|change| make_relaxed(engine, change, MEET_LEAST))
}

/// Makes a change, if no face is a fault then or has a smaller shape.
fn make_relaxed(engine: &mut Engine, change: Change, least: f64) -> bool {
    let edit = Edit::with(engine.mesh, change);
    let relaxed = relaxed(engine.context, &edit, &engine.measures, engine.options.triangle_price);
    if relaxed.after.faults > relaxed.before.faults || relaxed.least_after < least.min(relaxed.least_before) {
        return false;
    }
    engine.excess += edit.growth();
    let change = edit.into_change();
    engine.make(&change, &relaxed.targets);
    true
}

/// The cheapest strip from a triangle to another, or out, by Dijkstra's algorithm; to a triangle beside it only if asked.
fn find_strip(engine: &Engine, triangle: u32, beside: bool) -> Option<Strip> {
    let edit = Edit::new(engine.mesh);
    let mut from: FxHashMap<u32, (u32, [u32; 2])> = FxHashMap::default();
    let mut done: FxHashSet<u32> = FxHashSet::default();
    let mut heap = BinaryHeap::from([Reverse((0, triangle, triangle, [0; 2]))]);
    while let Some(Reverse((cost, face, before, entry))) = heap.pop() {
        if !done.insert(face) {
            continue;
        }
        from.insert(face, (before, entry));
        let corners = if face == OUTSIDE { &[] } else { edit.face(face) };
        if face == OUTSIDE || (face != triangle && corners.len() == 3) {
            let mut crossings = Vec::new();
            let mut at = face;
            while at != triangle {
                let (before, side) = from[&at];
                crossings.push((side, at));
                at = before;
            }
            crossings.reverse();
            return Some(Strip { cost, triangle, crossings });
        }
        // Of two faces that run along a side in the same direction, one has it.
        for side in sides(corners).filter(|&[a, b]| edit.left(a, b) == Some(face)) {
            let next = edit.left(side[1], side[0]);
            let count = next.map_or(0, |next| edit.face(next).len());
            let is_feature = next.is_none() || edit.curve(side).is_some();
            if count > 4 || (next.is_none() && !may_split(engine, side)) {
                continue;
            }
            if face == triangle && count == 3 && (is_feature || !beside) {
                continue;
            }
            let ends = u32::from(face == triangle) + u32::from(count == 3);
            let flat = if is_feature { ends * FLAT } else { 0 };
            let turn = if face != triangle && side.iter().any(|v| entry.contains(v)) { TURN } else { 0 };
            let leaving = if next.is_none() { LEAVING } else { 0 };
            let fixed = if side.iter().any(|&v| edit.is_free(v)) { 0 } else { FIXED };
            heap.push(Reverse((cost + 1 + flat + turn + fixed + leaving, next.unwrap_or(OUTSIDE), face, side)));
        }
    }
    None
}

/// Takes out what lies along a strip, if there are too many vertices, or puts a strip in.
fn go(engine: &mut Engine, strip: &Strip) {
    if engine.excess > 0 {
        let out = taken_out(&Edit::new(engine.mesh), strip).filter(Edit::is_sound).map(Edit::into_change);
        if out.is_some_and(|change| make_relaxed(engine, change, OUT_LEAST)) {
            engine.counts.strips_out += 1;
            return;
        }
    }
    let change = divided(engine, &marked(engine, strip)).into_change();
    put_in(engine, change);
    engine.counts.strips_in += 1;
}

/// Makes a change that divides faces; their vertices relax where that makes no fault.
fn put_in(engine: &mut Engine, change: Change) {
    let edit = Edit::with(engine.mesh, change);
    let relaxed = relaxed(engine.context, &edit, &engine.measures, engine.options.triangle_price);
    engine.excess += edit.growth();
    let (on_features, on_boundaries) = added_on_features(&edit);
    let change = edit.into_change();
    let targets = if relaxed.after.faults > relaxed.before.faults { Vec::new() } else { relaxed.targets };
    engine.make(&change, &targets);
    engine.counts.on_features += on_features;
    engine.counts.on_boundaries += on_boundaries;
}

/// Puts a ring of quads about the corner opposite to the straight one of each fault, if fewer faces are faults then.
pub(in super::super) fn put_rings(engine: &mut Engine) {
    for face in (0..engine.mesh.face_bound() as u32).filter(|&face| engine.is_fault(face)).collect::<Vec<u32>>() {
        if !engine.is_fault(face) {
            continue;
        }
        let ring = opposite(engine, face).and_then(|corner| ring(engine, corner));
        let Some(change) = ring.map(|ring| divided(engine, &ring).into_change()) else { continue };
        let edit = Edit::with(engine.mesh, change);
        let judged = if edit.is_sound() { engine.judge(&edit) } else { None };
        let Some(judged) = judged.filter(|judged| judged.gain > LEAST_GAIN) else { continue };
        engine.excess += edit.growth();
        let change = edit.into_change();
        engine.make(&change, &judged.targets);
        engine.counts.count(Kind::Ring);
    }
}

/// The corner of a quad opposite to the straightest one.
fn opposite(engine: &Engine, face: u32) -> Option<u32> {
    let &[a, b, c, d] = engine.mesh.face(face) else { return None };
    let quad = [a, b, c, d].map(|v| engine.mesh.point(v));
    let turn = |k: usize| {
        let [before, here, after] = [3, 0, 1].map(|by| quad[(k + by) % 4]);
        (here - before).normalize_or_zero().dot((after - here).normalize_or_zero())
    };
    let straightest = (0..4).max_by(|&j, &k| turn(j).total_cmp(&turn(k)))?;
    Some([a, b, c, d][(straightest + 2) % 4])
}

/// The edges at a vertex, the smaller id first; `None` where one may not be split.
fn ring(engine: &Engine, corner: u32) -> Option<BTreeSet<[u32; 2]>> {
    let edit = Edit::new(engine.mesh);
    let ends: BTreeSet<u32> = edit.around(corner).flat_map(|face| edit.beside(face, corner)).collect();
    let may_split = |&w: &u32| {
        let closed = edit.left(corner, w).is_some() && edit.left(w, corner).is_some();
        closed || may_split(engine, [corner, w])
    };
    let may_be = edit.around(corner).all(|face| edit.face(face).len() <= 4) && ends.iter().all(may_split);
    may_be.then(|| ends.into_iter().map(|w| undirected([corner, w])).collect())
}

/// The edges that get a vertex, the smaller id first: those that the strip crosses. A triangle that it leaves over a
/// feature would be a quad with a straight corner there; it is split on all sides, by a ring about its other corner.
fn marked(engine: &Engine, strip: &Strip) -> BTreeSet<[u32; 2]> {
    let mut marked: BTreeSet<[u32; 2]> = strip.crossings.iter().map(|&(side, _)| undirected(side)).collect();
    // A ring may take away what another one has brought.
    for _ in 0..RINGS {
        let Some(corner) = straight(engine, &marked) else { break };
        let Some(ring) = ring(engine, corner) else { break };
        marked = marked.symmetric_difference(&ring).copied().collect();
    }
    marked
}

/// The corner opposite a side that lies on a feature and is the only one of a triangle to be split.
fn straight(engine: &Engine, marked: &BTreeSet<[u32; 2]>) -> Option<u32> {
    let edit = Edit::new(engine.mesh);
    let on_feature = marked.iter().filter(|&&[a, b]| edit.across(a, b).is_none() || edit.across(b, a).is_none());
    on_feature.copied().find_map(|[a, b]| {
        let faces = [edit.left(a, b), edit.left(b, a)].into_iter().flatten();
        faces.filter(|&face| edit.face(face).len() == 3).find_map(|face| {
            let corner = edit.face(face).iter().copied().find(|v| ![a, b].contains(v))?;
            let alone = [a, b].iter().all(|&v| !marked.contains(&undirected([v, corner])));
            alone.then_some(corner)
        })
    })
}

/// The edit that gives edges a vertex each and divides their faces.
fn divided<'e>(engine: &'e Engine, marked: &BTreeSet<[u32; 2]>) -> Edit<'e> {
    let mut edit = Edit::new(engine.mesh);
    let mut faces: Vec<u32> = marked.iter().flat_map(|&[a, b]| [edit.left(a, b), edit.left(b, a)]).flatten().collect();
    faces.sort_unstable();
    faces.dedup();
    let middles: FxHashMap<[u32; 2], u32> = marked.iter().map(|&side| (side, split(engine, &mut edit, side))).collect();
    for face in faces {
        let corners = engine.mesh.face(face);
        let on_sides: Vec<Option<u32>> = sides(corners).map(|side| middles.get(&undirected(side)).copied()).collect();
        let parts = parts(engine, &mut edit, corners, &on_sides);
        edit.set_face(face, &parts[0]);
        parts[1..].iter().for_each(|part| {
            edit.add_face(part);
        });
    }
    edit
}

/// What a face is divided into, given the new vertices on its sides: quads, but for a triangle with two, which is one
/// still in its first part.
fn parts(engine: &Engine, edit: &mut Edit, corners: &[u32], on_sides: &[Option<u32>]) -> Vec<Vec<u32>> {
    let count = corners.len();
    let corner = |k: usize| corners[k % count];
    let middle = |k: usize| on_sides[k % count];
    let met = |k: usize| Some([middle(k + count - 1)?, middle(k)?]);
    match on_sides.iter().flatten().count() {
        1 => vec![(0..count).flat_map(|k| [Some(corner(k)), middle(k)]).flatten().collect()],
        2 if count == 3 => {
            let cut = (0..3).find_map(|k| Some((k, met(k)?)));
            cut.map_or(vec![corners.to_vec()], |(k, [before, after])| {
                vec![vec![corner(k), after, before], vec![after, corner(k + 1), corner(k + 2), before]]
            })
        }
        2 => match (0..4).find_map(|k| Some((k, met(k)?))) {
            Some((k, [before, after])) => {
                let centre = centre(engine, edit, corners);
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
            let centre = centre(engine, edit, corners);
            (0..count).filter_map(|k| met(k).map(|[before, after]| vec![corner(k), after, centre, before])).collect()
        }
    }
}

/// A new vertex in the middle of an edge: on the feature, if the edge is on one.
fn split(engine: &Engine, edit: &mut Edit, [a, b]: [u32; 2]) -> u32 {
    let middle = (edit.point(a) + edit.point(b)) / 2.0;
    let faces = [edit.left(a, b), edit.left(b, a)];
    let Some((curve, s)) = edit.curve([a, b]).and_then(|curve| {
        let [from, to] = engine.mesh.arcs(engine.context, [a, b], curve)?;
        Some((curve, engine.context.curve(curve).wrapped((from + to) / 2.0)))
    }) else {
        let near: Vec<u32> = [a, b]
            .into_iter()
            .chain(faces.into_iter().flatten().flat_map(|face| engine.mesh.face(face).iter().copied()))
            .collect();
        return add_free(engine, edit, middle, &near);
    };
    let (surface, line) = (engine.surface(), engine.context.curve(curve));
    let half_edge = line.half_edges[line.segment(s)];
    let vertex = Vertex {
        point: line.point(surface, s),
        place: Place::OnCurve { curve, s },
        triangles: [half_edge / 3, surface.twin(half_edge).unwrap_or(half_edge) / 3],
        normal: (edit.vertex(a).normal + edit.vertex(b).normal).normalize_or_zero(),
        valence: if faces.contains(&None) { 2 } else { 4 },
        origin: NONE,
        ..*edit.vertex(a)
    };
    let vertex = edit.add_vertex(vertex, a);
    edit.set_feature([a, b], None);
    edit.set_feature([a, vertex], Some(curve));
    edit.set_feature([b, vertex], Some(curve));
    vertex
}

/// A new vertex in the middle of a face.
fn centre(engine: &Engine, edit: &mut Edit, corners: &[u32]) -> u32 {
    let sum: DVec3 = corners.iter().map(|&v| edit.point(v)).sum();
    add_free(engine, edit, sum / corners.len() as f64, corners)
}

/// A new vertex on the surface, reached from one of those near it.
fn add_free(engine: &Engine, edit: &mut Edit, point: DVec3, near: &[u32]) -> u32 {
    let surface = engine.surface();
    let from = near.iter().copied().find(|&v| edit.is_free(v));
    let position = match from {
        Some(v) => walked(surface, edit.vertex(v).triangles[0], edit.point(v), point),
        None => {
            let triangle = engine.context.orientation.triangles().nearest(point).0;
            walked(surface, triangle, point, point)
        }
    };
    let like = from.unwrap_or(near[0]);
    let vertex = Vertex {
        point: position.point,
        place: Place::Free,
        triangles: position.triangles,
        normal: surface.normal(position.triangles[0] as usize).as_dvec3(),
        valence: 4,
        origin: NONE,
        ..*edit.vertex(like)
    };
    edit.add_vertex(vertex, like)
}

/// Whether a boundary edge can get a vertex: not where other sheets meet there, which would need it as well.
fn may_split(engine: &Engine, side: [u32; 2]) -> bool {
    engine.mesh.curve(side).is_some_and(|curve| !engine.context.is_shared(curve))
}

/// The numbers of new vertices on features inside the surface and on its boundary.
fn added_on_features(edit: &Edit) -> (usize, usize) {
    let corners = edit.changed().flat_map(|(_, corners)| corners.iter().copied());
    let new: BTreeSet<u32> = corners.filter(|&v| v >= NEW && !edit.is_free(v)).collect();
    let on_boundary = new.iter().filter(|&&v| edit.on_boundary(v)).count();
    (new.len() - on_boundary, on_boundary)
}

/// The edit in which the ends of each edge that a strip crosses are one, and the faces on it are gone; `None` where features
/// meet, or where the strip leads out.
fn taken_out<'a>(edit: &Edit<'a>, strip: &Strip) -> Option<Edit<'a>> {
    let mut result = edit.clone();
    result.set_face(strip.triangle, &[]);
    for &(_, face) in &strip.crossings {
        if face == OUTSIDE {
            return None;
        }
        result.set_face(face, &[]);
    }
    // What each vertex has become.
    let mut merged: Vec<[u32; 2]> = Vec::new();
    for &(side, _) in &strip.crossings {
        let [a, b] = side.map(|v| merged.iter().fold(v, |v, &[from, to]| if v == from { to } else { v }));
        if a == b {
            return None;
        }
        let stays = result.merge(a, b)?;
        merged.push([if stays == a { b } else { a }, stays]);
    }
    Some(result)
}
