//! Caps: many faces about a fault are cut off along a short closed loop of edges, which few faces close again.
//!
//! # Theory
//! Near the tip of a needle fewer than three tiles go round. Faces span it there, and look away from the surface wherever their
//! vertices are; no edit of a few faces helps. A cap is a fan about the tip, where that is a corner of the surface, or about the
//! vertex farthest from the loop, or the best cut of the loop. The part about a fault grows by rings of faces, and takes the smaller
//! parts that it cuts off from the mesh, until a cap of it has fewer faults. All vertices that it removes lie near the new faces, so
//! no pin is cut off.

use super::super::edit::Edit;
use super::super::{Engine, Kind};
use super::untangle::{Measures, cut_outline, has_fewer_faults, is_allowed, outline, replaced};
use crate::mesh::incidence::sides;
use crate::mesh::vertex::Place;
use crate::surface::nearest::squared_distance;
use std::collections::BTreeSet;

/// The most rings of faces about a fault.
const RINGS: usize = 8;
/// The most faces that a cap replaces.
const MOST_FACES: usize = 120;
/// The most sides of a loop.
const MOST_SIDES: usize = 8;
/// The farthest that a removed vertex may lie from the new faces, in mean sides of the loop.
const FARTHEST: f64 = 0.5;

/// The caps of the smallest part about a fault that has some.
pub(super) fn caps<'e>(engine: &'e Engine, face: u32) -> Vec<(Kind, Edit<'e>)> {
    let edit = Edit::new(engine.mesh);
    let mut part = BTreeSet::from([face]);
    for _ in 0..RINGS {
        let corners: BTreeSet<u32> = part.iter().flat_map(|&face| edit.face(face)).copied().collect();
        part.extend(corners.iter().flat_map(|&v| edit.around(v)));
        if part.len() > MOST_FACES {
            break;
        }
        let caps = caps_of(engine, &edit, &with_cut_off(&edit, &part));
        if !caps.is_empty() {
            return caps.into_iter().map(|edit| (Kind::Collapse, edit)).collect();
        }
    }
    Vec::new()
}

/// Faces with the parts of the mesh that they cut off from the largest one.
fn with_cut_off(edit: &Edit, part: &BTreeSet<u32>) -> Vec<u32> {
    let mut beyond: Vec<BTreeSet<u32>> = Vec::new();
    for [a, b] in part.iter().flat_map(|&face| sides(edit.face(face))) {
        if let Some(first) = edit.left(b, a).filter(|first| !part.contains(first))
            && !beyond.iter().any(|known| known.contains(&first))
        {
            beyond.push(connected(edit, part, first));
        }
    }
    let largest = (0..beyond.len()).max_by_key(|&k| beyond[k].len());
    let cut_off = (0..).zip(&beyond).filter(|&(k, faces)| Some(k) != largest && faces.len() <= MOST_FACES);
    part.iter().chain(cut_off.flat_map(|(_, faces)| faces)).copied().collect()
}

/// The faces that edges connect with one, without those of a part; a few more than [`MOST_FACES`] where they are more.
fn connected(edit: &Edit, part: &BTreeSet<u32>, first: u32) -> BTreeSet<u32> {
    let mut found = BTreeSet::from([first]);
    let mut queue = vec![first];
    while let Some(face) = queue.pop().filter(|_| found.len() <= MOST_FACES) {
        let beside = sides(edit.face(face)).filter_map(|[a, b]| edit.left(b, a));
        queue.extend(beside.filter(|beside| !part.contains(beside) && found.insert(*beside)).collect::<Vec<u32>>());
    }
    found
}

/// The edits that put a cap in the place of faces; none unless their outline is short and no feature lies within it but one corner.
fn caps_of<'e>(engine: &'e Engine, edit: &Edit<'e>, faces: &[u32]) -> Vec<Edit<'e>> {
    let Some(outline) = outline(edit, faces).filter(|outline| (3..=MOST_SIDES).contains(&outline.len())) else {
        return Vec::new();
    };
    let count = outline.len();
    let has_feature = faces.iter().flat_map(|&face| sides(edit.face(face))).any(|[a, b]| {
        let is_inner = edit.left(b, a).is_some_and(|other| faces.contains(&other));
        is_inner && edit.curve([a, b]).is_some()
    });
    let corners: BTreeSet<u32> = faces.iter().flat_map(|&face| edit.face(face)).copied().collect();
    let inner: Vec<u32> = corners.into_iter().filter(|v| !outline.contains(v)).collect();
    let held: Vec<u32> = inner.iter().copied().filter(|&v| !edit.is_free(v)).collect();
    let is_tip = |&v: &u32| edit.vertex(v).place == Place::Corner && !edit.vertex(v).is_kept;
    if has_feature || held.len() > 1 || !held.iter().all(is_tip) {
        return Vec::new();
    }
    let middle = outline.iter().map(|&v| edit.point(v)).sum::<glam::DVec3>() / count as f64;
    let off = |v: &u32| edit.point(*v).distance_squared(middle);
    let tip = held.first().copied().or_else(|| inner.iter().copied().max_by(|a, b| off(a).total_cmp(&off(b))));
    let at = |k: usize| outline[k % count];
    let measures = Measures::new(engine);
    let mut caps: Vec<Vec<Vec<u32>>> = Vec::new();
    if let Some(tip) = tip {
        caps.push((0..count).map(|k| vec![at(k), at(k + 1), tip]).collect());
        if count.is_multiple_of(2) {
            let kites =
                |first: usize| (first..first + count).step_by(2).map(|k| vec![at(k), at(k + 1), at(k + 2), tip]);
            caps.extend((0..2).map(|first| kites(first).collect()));
        }
    }
    if held.is_empty() {
        caps.extend(cut_outline(&measures, edit, &outline, faces));
    }
    let side = (0..count).map(|k| edit.point(at(k)).distance(edit.point(at(k + 1)))).sum::<f64>() / count as f64;
    let points: Vec<glam::DVec3> = inner.iter().map(|&v| edit.point(v)).collect();
    let is_near = |cap: &Vec<Vec<u32>>| {
        let faces = cap.iter().map(|face| face.iter().map(|&v| edit.point(v)).collect::<Vec<_>>());
        are_near(&points, &faces.collect::<Vec<_>>(), FARTHEST * side)
    };
    let edits = caps.iter().filter(|cap| is_near(cap)).map(|cap| replaced(edit, faces, cap));
    edits.filter(|edit| has_fewer_faults(&measures, edit) && is_allowed(engine, edit)).collect()
}

/// Whether all points lie within a distance of faces.
pub(super) fn are_near(points: &[glam::DVec3], faces: &[impl AsRef<[glam::DVec3]>], distance: f64) -> bool {
    let triangles =
        || faces.iter().map(AsRef::as_ref).flat_map(|face| (2..face.len()).map(|k| [face[0], face[k - 1], face[k]]));
    points.iter().all(|&point| triangles().any(|corners| squared_distance(point, corners) <= distance * distance))
}
