//! All quads: a dual strip is inserted between each two triangles that are left.
//!
//! # Theory
//! A strip crosses the faces between two triangles. Each edge that it crosses gets a vertex at its middle. A quad that it
//! crosses straight becomes two quads, a quad in which it turns becomes three about a new vertex, and the triangles at its ends
//! become quads.
//!
//! ```text
//!       p---o---o---s              p---o---o---s
//!     / |   |   |   | \          / |   |   |   | \
//!   z   |   |   |   |   w  ->  z   m---m---m---m   w      (m moves away from z, and the last m from w)
//!     \ |   |   |   | /          \ |   |   |   | /
//!       q---o---o---t              q---o---o---t
//! ```
//!
//! Where there are too many vertices already, the faces on the strip are removed instead, if their shapes allow.
//!
//! Every insertion is made, so all triangles of a component are paired; their number is even where the component is closed. A
//! strip may cross features, which get the vertices. Of an odd number of triangles, the strip of the last one leaves over an
//! open boundary, which gets the vertex.

use super::super::edit::{Change, Edit, NEW};
use super::super::patch::{SWEEPS, relaxed};
use super::super::{Engine, Kind, LEAST_GAIN};
use super::walk;
use crate::mesh::incidence::{sides, undirected};
use crate::mesh::vertex::{Place, Vertex, walked};
use crate::surface::NONE;
use glam::DVec3;
use rayon::prelude::*;
use rustc_hash::{FxHashMap, FxHashSet};
use std::cmp::Reverse;
use std::collections::{BTreeSet, BinaryHeap};

/// The cost of a turn within a face; a face crossed costs 1.
const TURN_COST: u32 = 4;
/// The cost of an edge between two vertices on features: they do not make room, so the quads beside it stay half as wide.
const FIXED_EDGE_COST: u32 = 3;
/// The cost of an end of the strip on a feature: it takes a ring about the triangle's opposite corner.
const FEATURE_END_COST: u32 = 20;
/// The most rings of one strip.
const MOST_RINGS: usize = 4;
/// The least shape of a quad made of two triangles beside each other.
const LEAST_MERGED: f64 = 0.1;
/// The least shape of a face after the removal of a strip.
const LEAST_REMOVED: f64 = 0.15;
/// The cost of an end over an open boundary: larger than that of any strip between two triangles.
const BOUNDARY_END_COST: u32 = 1_000_000;
/// The outside of the mesh.
const OUTSIDE: u32 = NONE;

/// A dual strip from a triangle to another one, or over a boundary.
struct Strip {
    cost: u32,
    triangle: u32,
    /// The sides that it crosses, each with the face across.
    crossings: Vec<([u32; 2], u32)>,
}

/// Pairs all triangles that are left, in the order of the costs of their strips.
pub(in super::super) fn pair_along_strips(engine: &mut Engine) {
    let triangles: Vec<u32> = (0..engine.mesh.face_bound() as u32).filter(|&face| engine.is_triangle(face)).collect();
    let strips: Vec<Strip> = triangles.into_par_iter().filter_map(|t| find_strip(engine, t, true)).collect();
    let mut heap: BinaryHeap<_> = (0..strips.len()).map(|k| Reverse((strips[k].cost, strips[k].triangle, k))).collect();
    let mut strips: Vec<Option<Strip>> = strips.into_iter().map(Some).collect();
    while let Some(Reverse((_, triangle, k))) = heap.pop() {
        if engine.context.is_cancelled() {
            return;
        }
        let Some(strip) = strips[k].take() else { continue };
        if !engine.is_triangle(triangle) {
            continue;
        }
        if is_current(engine, &strip) {
            match *strip.crossings {
                [(side, other)] if other != OUTSIDE => {
                    if meet(engine, triangle, side, other) {
                        engine.counts.met += 1;
                    } else if let Some(strip) = find_strip(engine, triangle, false) {
                        apply(engine, &strip);
                    }
                }
                _ => apply(engine, &strip),
            }
        } else if let Some(strip) = find_strip(engine, triangle, true) {
            heap.push(Reverse((strip.cost, triangle, strips.len())));
            strips.push(Some(strip));
        }
    }
}

/// Whether the faces along a strip are unchanged.
fn is_current(engine: &Engine, strip: &Strip) -> bool {
    let edit = Edit::new(engine.mesh);
    let mut face = strip.triangle;
    strip.crossings.iter().enumerate().all(|(k, &([a, b], next))| {
        let corners = if k + 1 == strip.crossings.len() { 3 } else { 4 };
        let is_same = edit.left(a, b) == Some(face)
            && edit.left(b, a).unwrap_or(OUTSIDE) == next
            && (next == OUTSIDE || edit.face(next).len() == corners);
        face = next;
        is_same
    })
}

/// Merges two triangles beside each other into a quad, unless its shape is too small; returns whether it did.
fn meet(engine: &mut Engine, triangle: u32, [x, y]: [u32; 2], other: u32) -> bool {
    let edit = Edit::new(engine.mesh);
    let corners = edit.face(triangle);
    let side = (0..3).find(|&k| corners[k] == x && corners[(k + 1) % 3] == y);
    let met = side.and_then(|side| Some(walk::meet(&edit, triangle, side, other)?.1)).filter(Edit::is_sound);
    met.map(Edit::into_change).is_some_and(|change| make_relaxed(engine, change, LEAST_MERGED))
}

/// Makes a change unless it adds a fault or a face of a smaller shape than `least`; returns whether it did.
fn make_relaxed(engine: &mut Engine, change: Change, least: f64) -> bool {
    let edit = Edit::with(engine.mesh, change);
    let relaxed = relaxed(engine.context, &edit, &engine.measures, engine.options.triangle_price, SWEEPS);
    if relaxed.after.faults > relaxed.before.faults || relaxed.least_after < least.min(relaxed.least_before) {
        return false;
    }
    engine.excess += edit.growth();
    let change = edit.into_change();
    engine.make(&change, &relaxed.targets);
    true
}

/// The cheapest strip from a triangle to another one, or over a boundary, by Dijkstra's algorithm. `beside` admits a triangle
/// beside it.
fn find_strip(engine: &Engine, triangle: u32, beside: bool) -> Option<Strip> {
    if engine.context.is_cancelled() {
        return None;
    }
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
            let end_count = u32::from(face == triangle) + u32::from(count == 3);
            let feature_ends = if is_feature { end_count * FEATURE_END_COST } else { 0 };
            let turn = if face != triangle && side.iter().any(|v| entry.contains(v)) { TURN_COST } else { 0 };
            let boundary = if next.is_none() { BOUNDARY_END_COST } else { 0 };
            let fixed = if side.iter().any(|&v| edit.is_free(v)) { 0 } else { FIXED_EDGE_COST };
            let cost = cost + 1 + feature_ends + turn + fixed + boundary;
            heap.push(Reverse((cost, next.unwrap_or(OUTSIDE), face, side)));
        }
    }
    None
}

/// Removes the faces along a strip where there are too many vertices, else inserts the strip.
fn apply(engine: &mut Engine, strip: &Strip) {
    if engine.excess > 0 {
        let removal = removed(&Edit::new(engine.mesh), strip).filter(Edit::is_sound).map(Edit::into_change);
        if removal.is_some_and(|change| make_relaxed(engine, change, LEAST_REMOVED)) {
            engine.counts.strips_out += 1;
            return;
        }
    }
    let change = subdivided(engine, &split_edges(engine, strip)).into_change();
    insert(engine, change);
    engine.counts.strips_in += 1;
}

/// Makes a change that subdivides faces. Their vertices relax unless that makes a fault.
fn insert(engine: &mut Engine, change: Change) {
    let edit = Edit::with(engine.mesh, change);
    let relaxed = relaxed(engine.context, &edit, &engine.measures, engine.options.triangle_price, SWEEPS);
    engine.excess += edit.growth();
    let (on_features, on_boundaries) = added_on_features(&edit);
    let change = edit.into_change();
    let targets = if relaxed.after.faults > relaxed.before.faults { Vec::new() } else { relaxed.targets };
    engine.make(&change, &targets);
    engine.counts.on_features += on_features;
    engine.counts.on_boundaries += on_boundaries;
}

/// Inserts a ring of quads about the corner opposite to the straight corner of each fault, where the objective improves.
pub(in super::super) fn put_rings(engine: &mut Engine) {
    for face in (0..engine.mesh.face_bound() as u32).filter(|&face| engine.is_fault(face)).collect::<Vec<u32>>() {
        if !engine.is_fault(face) {
            continue;
        }
        let ring = opposite(engine, face).and_then(|corner| ring(engine, corner));
        let Some(change) = ring.map(|ring| subdivided(engine, &ring).into_change()) else { continue };
        let edit = Edit::with(engine.mesh, change);
        let evaluation = if edit.is_sound() { engine.evaluate(Kind::Ring, &edit) } else { None };
        let Some(evaluation) = evaluation.filter(|evaluation| evaluation.gain > LEAST_GAIN) else { continue };
        engine.excess += edit.growth();
        let change = edit.into_change();
        engine.make(&change, &evaluation.targets);
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

/// The edges at a vertex, the smaller id first; `None` where one of them may not be split.
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

/// The edges that an inserted strip splits, the smaller id first: those that it crosses. A triangle at its end whose side lies
/// on a feature would become a quad with a straight corner; a ring about the opposite corner splits the other sides too.
fn split_edges(engine: &Engine, strip: &Strip) -> BTreeSet<[u32; 2]> {
    let mut edges: BTreeSet<[u32; 2]> = strip.crossings.iter().map(|&(side, _)| undirected(side)).collect();
    // A ring removes the edges that it shares with another one.
    for _ in 0..MOST_RINGS {
        let Some(corner) = ring_corner(engine, &edges) else { break };
        let Some(ring) = ring(engine, corner) else { break };
        edges = edges.symmetric_difference(&ring).copied().collect();
    }
    edges
}

/// The corner of a triangle opposite to a side that lies on a feature and is the triangle's only split side.
fn ring_corner(engine: &Engine, edges: &BTreeSet<[u32; 2]>) -> Option<u32> {
    let edit = Edit::new(engine.mesh);
    let on_feature = edges.iter().filter(|&&[a, b]| edit.across(a, b).is_none() || edit.across(b, a).is_none());
    on_feature.copied().find_map(|[a, b]| {
        let faces = [edit.left(a, b), edit.left(b, a)].into_iter().flatten();
        faces.filter(|&face| edit.face(face).len() == 3).find_map(|face| {
            let corner = edit.face(face).iter().copied().find(|v| ![a, b].contains(v))?;
            let alone = [a, b].iter().all(|&v| !edges.contains(&undirected([v, corner])));
            alone.then_some(corner)
        })
    })
}

/// The edit that splits edges at their middles and subdivides their faces.
fn subdivided<'e>(engine: &'e Engine, edges: &BTreeSet<[u32; 2]>) -> Edit<'e> {
    let mut edit = Edit::new(engine.mesh);
    let mut faces: Vec<u32> = edges.iter().flat_map(|&[a, b]| [edit.left(a, b), edit.left(b, a)]).flatten().collect();
    faces.sort_unstable();
    faces.dedup();
    let middles: FxHashMap<[u32; 2], u32> = edges.iter().map(|&side| (side, split(engine, &mut edit, side))).collect();
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

/// The parts of a face with new vertices on its sides. All are quads, but for the first part of a triangle with two new
/// vertices, which is a triangle.
fn parts(engine: &Engine, edit: &mut Edit, corners: &[u32], on_sides: &[Option<u32>]) -> Vec<Vec<u32>> {
    let count = corners.len();
    let corner = |k: usize| corners[k % count];
    let middle = |k: usize| on_sides[k % count];
    let at_corner = |k: usize| Some([middle(k + count - 1)?, middle(k)?]);
    match on_sides.iter().flatten().count() {
        1 => vec![(0..count).flat_map(|k| [Some(corner(k)), middle(k)]).flatten().collect()],
        2 if count == 3 => {
            let cut = (0..3).find_map(|k| Some((k, at_corner(k)?)));
            cut.map_or(vec![corners.to_vec()], |(k, [before, after])| {
                vec![vec![corner(k), after, before], vec![after, corner(k + 1), corner(k + 2), before]]
            })
        }
        2 => match (0..4).find_map(|k| Some((k, at_corner(k)?))) {
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
            (0..count)
                .filter_map(|k| at_corner(k).map(|[before, after]| vec![corner(k), after, centre, before]))
                .collect()
        }
    }
}

/// Adds a vertex at the middle of an edge; on a feature curve where the edge lies on one.
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
        is_kept: false,
        origin: NONE,
        ..*edit.vertex(a)
    };
    let vertex = edit.add_vertex(vertex, a);
    edit.set_feature([a, b], None);
    edit.set_feature([a, vertex], Some(curve));
    edit.set_feature([b, vertex], Some(curve));
    vertex
}

/// Adds a vertex at the middle of a face.
fn centre(engine: &Engine, edit: &mut Edit, corners: &[u32]) -> u32 {
    let sum: DVec3 = corners.iter().map(|&v| edit.point(v)).sum();
    add_free(engine, edit, sum / corners.len() as f64, corners)
}

/// Adds a free vertex at a point, reached over the surface from a free vertex nearby.
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
        is_kept: false,
        origin: NONE,
        ..*edit.vertex(like)
    };
    edit.add_vertex(vertex, like)
}

/// Whether a boundary edge may be split: not one that is kept, nor on a curve that other sheets share, as they would need the vertex
/// too.
fn may_split(engine: &Engine, side: [u32; 2]) -> bool {
    let is_kept = side.iter().all(|&v| engine.mesh.vertex(v).is_kept);
    !is_kept && engine.mesh.curve(side).is_some_and(|curve| !engine.context.is_shared(curve))
}

/// The numbers of new vertices on features inside the surface and on its boundary.
fn added_on_features(edit: &Edit) -> (usize, usize) {
    let corners = edit.changed().flat_map(|(_, corners)| corners.iter().copied());
    let new: BTreeSet<u32> = corners.filter(|&v| v >= NEW && !edit.is_free(v)).collect();
    let on_boundary = new.iter().filter(|&&v| edit.on_boundary(v)).count();
    (new.len() - on_boundary, on_boundary)
}

/// The edit that removes the faces along a strip and merges the ends of each edge that it crosses; `None` where two vertices on
/// features would merge, or where the strip leaves over a boundary.
fn removed<'a>(edit: &Edit<'a>, strip: &Strip) -> Option<Edit<'a>> {
    let mut result = edit.clone();
    result.set_face(strip.triangle, &[]);
    for &(_, face) in &strip.crossings {
        if face == OUTSIDE {
            return None;
        }
        result.set_face(face, &[]);
    }
    // The vertex that each removed one is merged into.
    let mut merged: Vec<[u32; 2]> = Vec::new();
    for &(side, _) in &strip.crossings {
        let [a, b] = side.map(|v| merged.iter().fold(v, |v, &[from, to]| if v == from { to } else { v }));
        if a == b {
            return None;
        }
        let kept = result.merge(a, b)?;
        merged.push([if kept == a { b } else { a }, kept]);
    }
    Some(result)
}
