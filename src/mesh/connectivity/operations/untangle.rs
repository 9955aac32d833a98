//! Untangling: edits that remove faults, which are inverted, concave or degenerate faces.
//!
//! # Theory
//! A fault spans a part thinner than a tile, or all of its corners lie on one feature curve. Six edits are proposed: it is recut
//! together with a face beside it, one of its edges is collapsed, two of its corners are merged, it meets a triangle beside it, a
//! vertex of its curve is removed, or it is split. If none helps, the best cut of its union with one or two faces is proposed, then
//! two edits in turn, and then [caps](super::caps). With [`Quads::All`] the last
//! resort is a ring of quads about the corner opposite to a straight one.

use super::super::edit::Edit;
use super::super::{Engine, Kind, Quads};
use super::recut::{collapsed, flipped, recut, split};
use super::walk;
use crate::mesh::incidence::sides;
use crate::mesh::objective::Measure;
use crate::mesh::polygon;
use crate::mesh::vertex::Place;
use crate::surface::NONE;
use rustc_hash::FxHashMap;
use std::cell::RefCell;

/// The measures of the faces that edits about one face propose, many of them again and again.
pub(super) struct Measures<'a, 'e> {
    pub engine: &'a Engine<'e>,
    /// Those whose vertices the mesh has, where they are.
    known: RefCell<FxHashMap<[u32; 4], Measure>>,
}

impl<'a, 'e> Measures<'a, 'e> {
    pub fn new(engine: &'a Engine<'e>) -> Self {
        Self { engine, known: RefCell::default() }
    }

    /// The measure of a face of three or four corners.
    fn of(&self, edit: &Edit, corners: &[u32]) -> Measure {
        let measure = || edit.measure_of(self.engine.context, corners);
        if !edit.keeps(corners) {
            return measure();
        }
        let mut key = [NONE; 4];
        key[..corners.len()].copy_from_slice(corners);
        *self.known.borrow_mut().entry(key).or_insert_with(measure)
    }
}

/// The single edits about a fault.
pub(super) fn once<'e>(engine: &'e Engine, face: u32) -> Vec<(Kind, Edit<'e>)> {
    let mut edits = recuts_and_collapses(&Edit::new(engine.mesh), face);
    edits.retain(|(_, edit)| is_allowed(engine, edit));
    edits
}

/// The pairs of edits about a fault, each pair as one edit.
pub(super) fn twice<'e>(engine: &'e Engine, face: u32) -> Vec<(Kind, Edit<'e>)> {
    let measures = Measures::new(engine);
    let mut edits: Vec<(Kind, Edit)> = Vec::new();
    for (kind, edit) in recuts_and_collapses(&Edit::new(engine.mesh), face) {
        let faces: Vec<u32> = edit.changed().filter(|(_, corners)| !corners.is_empty()).map(|(face, _)| face).collect();
        let again = faces.into_iter().flat_map(|face| recuts_and_collapses(&edit, face));
        let again = again.filter(|edit| has_fewer_faults(&measures, &edit.1));
        edits.extend(again.map(|(_, edit)| (kind, edit)).filter(|(_, edit)| is_allowed(engine, edit)));
    }
    edits
}

/// The recuts of the union of a fault with one or two of the faces beside it, each the cut into quads and triangles of least cost.
pub(super) fn unions<'e>(engine: &'e Engine, face: u32) -> Vec<(Kind, Edit<'e>)> {
    let (measures, edit) = (Measures::new(engine), Edit::new(engine.mesh));
    let beside = |face: u32| -> Vec<u32> { sides(edit.face(face)).filter_map(|[a, b]| edit.across(a, b)).collect() };
    let first = beside(face);
    let mut sets: Vec<Vec<u32>> = first.iter().map(|&other| vec![face, other]).collect();
    for (k, &other) in first.iter().enumerate() {
        let second = first[k + 1..].iter().copied().chain(beside(other));
        sets.extend(second.filter(|third| ![face, other].contains(third)).map(|third| vec![face, other, third]));
    }
    let cut = |set: Vec<u32>| recut_union(&measures, &edit, &set).filter(|edit| is_allowed(engine, edit));
    sets.into_iter().filter_map(cut).map(|edit| (Kind::Flip, edit)).collect()
}

/// The edit that recuts the union of faces; `None` unless that is a simple polygon with a cut of its own.
fn recut_union<'e>(measures: &Measures, edit: &Edit<'e>, set: &[u32]) -> Option<Edit<'e>> {
    let outline = outline(edit, set)?;
    let inner_sides = set.iter().map(|&face| edit.face(face).len()).sum::<usize>() - outline.len();
    if inner_sides != 2 * (set.len() - 1) {
        return None;
    }
    let result = replaced(edit, set, &cut_outline(measures, edit, &outline, set)?);
    has_fewer_faults(measures, &result).then_some(result)
}

/// The outline of the union of faces, counter-clockwise; `None` unless it is one simple polygon.
pub(super) fn outline(edit: &Edit, set: &[u32]) -> Option<Vec<u32>> {
    let all: Vec<[u32; 2]> = set.iter().flat_map(|&face| sides(edit.face(face))).collect();
    let rim: Vec<[u32; 2]> = all.iter().copied().filter(|&[a, b]| !all.contains(&[b, a])).collect();
    let mut outline = vec![rim.first()?[0]];
    while outline.len() < rim.len() {
        outline.push(rim.iter().find(|side| side[0] == outline[outline.len() - 1])?[1]);
    }
    let is_repeated = (1..outline.len()).any(|k| outline[..k].contains(&outline[k]));
    (!is_repeated).then_some(outline)
}

/// The cut of least cost of an outline of faces into quads and triangles.
pub(super) fn cut_outline(measures: &Measures, edit: &Edit, outline: &[u32], set: &[u32]) -> Option<Vec<Vec<u32>>> {
    /// The cost of a fault, in perfect quads.
    const FAULT: f64 = 10.0;
    let corners = |places: &[usize]| places.iter().map(|&k| outline[k]).collect::<Vec<u32>>();
    let cost = |places: &[usize]| {
        let measure = measures.of(edit, &corners(places));
        let fault = if measure.is_fault { FAULT } else { 0.0 };
        fault + measure.score(measures.engine.options.triangle_price).loss
    };
    let chord = |i: usize, j: usize| {
        let [a, b] = [outline[i], outline[j]];
        let is_outside = |face: Option<u32>| face.is_some_and(|face| !set.contains(&face));
        let is_taken = is_outside(edit.left(a, b)) || is_outside(edit.left(b, a)) || edit.curve([a, b]).is_some();
        if is_taken { f64::INFINITY } else { 0.0 }
    };
    let (_, parts) = polygon::cut(outline.len(), cost, chord)?;
    Some(parts.iter().map(|part| corners(part)).collect())
}

/// The edit that puts other faces in the place of some.
pub(super) fn replaced<'e>(edit: &Edit<'e>, set: &[u32], faces: &[Vec<u32>]) -> Edit<'e> {
    let mut result = edit.clone();
    set.iter().for_each(|&face| result.set_face(face, &[]));
    for (k, corners) in faces.iter().enumerate() {
        match set.get(k) {
            Some(&face) => result.set_face(face, corners),
            None => {
                result.add_face(corners);
            }
        }
    }
    result
}

/// Whether fewer of the changed faces are faults than before before the vertices relax: a quick test, as edits in two
/// steps are many.
pub(super) fn has_fewer_faults(measures: &Measures, edit: &Edit) -> bool {
    let old = edit.changed().filter(|(face, _)| !edit.before(*face).is_empty());
    let before = old.filter(|(face, _)| measures.engine.is_fault(*face)).count();
    let new = edit.changed().filter(|(_, corners)| !corners.is_empty());
    new.filter(|(_, corners)| measures.of(edit, corners).is_fault).take(before).count() < before
}

/// Whether an edit is sound, and adds no triangle with [`Quads::All`].
pub(super) fn is_allowed(engine: &Engine, edit: &Edit) -> bool {
    let is_triangle = |corners: &[u32]| usize::from(corners.len() == 3);
    let added: usize = edit.changed().map(|(_, corners)| is_triangle(corners)).sum();
    let removed: usize = edit.changed().map(|(face, _)| is_triangle(edit.before(face))).sum();
    (engine.options.quads != Quads::All || added <= removed) && edit.is_sound_without(&dropped(edit))
}

/// The edits that recut a face together with one beside it, collapse it or split it.
fn recuts_and_collapses<'e>(edit: &Edit<'e>, face: u32) -> Vec<(Kind, Edit<'e>)> {
    let corners = edit.face(face);
    let count = corners.len();
    let mut edits: Vec<(Kind, Edit)> = Vec::new();
    if !(3..=4).contains(&count) {
        return edits;
    }
    for side in 0..count {
        let [a, b] = [corners[side], corners[(side + 1) % count]];
        edits.extend(edge_collapsed(edit, a, b).into_iter().map(|edit| (Kind::Collapse, edit)));
        let Some(other) = edit.across(a, b) else { continue };
        let beyond = edit.face(other);
        let cut = match (count, beyond.len()) {
            (3, _) => recut(edit, face, side),
            (_, 3) => beyond.iter().position(|&v| v == b).map_or(Vec::new(), |at| recut(edit, other, at)),
            _ => flipped(edit, face, side),
        };
        edits.extend(cut.into_iter().map(|edit| (Kind::Flip, edit)));
        if count == 3 && beyond.len() == 3 {
            edits.extend(walk::meet(edit, face, side, other).map(|(_, edit)| (Kind::Meet, edit)));
        }
    }
    if count == 4 {
        edits.extend((0..2).filter_map(|k| collapsed(edit, face, k)).map(|edit| (Kind::Collapse, edit)));
        edits.extend((0..2).map(|k| (Kind::Split, split(edit, face, k))));
    }
    edits
}

/// The edits that collapse an edge. Of an edge on a feature curve an end is removed that is no corner.
fn edge_collapsed<'e>(edit: &Edit<'e>, a: u32, b: u32) -> Vec<Edit<'e>> {
    if edit.is_free(a) || edit.is_free(b) {
        let mut result = edit.clone();
        return result.merge(a, b).map(|_| result).into_iter().collect();
    }
    let Some(curve) = edit.curve([a, b]) else { return Vec::new() };
    let may_go = |&[_, removed]: &[u32; 2]| matches!(edit.vertex(removed).place, Place::OnCurve { curve: own, .. } if own == curve);
    [[a, b], [b, a]]
        .into_iter()
        .filter(may_go)
        .filter_map(|[kept, removed]| {
            let next = feature_neighbours(edit, removed, curve).into_iter().find(|&w| w != kept)?;
            // Where another feature already joins the two, two curves coincide there: the triangle between them must be removed.
            let other = edit.curve([kept, next]);
            let is_between = |face: u32| [kept, next].iter().all(|v| edit.face(face).contains(v));
            if other.is_some() && !edit.around(removed).any(|face| edit.face(face).len() == 3 && is_between(face)) {
                return None;
            }
            let mut result = edit.clone();
            result.set_feature([removed, kept], None);
            result.set_feature([removed, next], None);
            result.set_feature([kept, next], other.or(Some(curve)));
            result.absorb(kept, removed)?;
            Some(result)
        })
        .collect()
}

/// The vertices on features that an edit leaves without a face after it has merged their feature edges.
fn dropped(edit: &Edit) -> Vec<u32> {
    let is_dropped = |v: &u32| {
        let vertex = edit.vertex(*v);
        let Place::OnCurve { curve, .. } = vertex.place else { return false };
        let old = edit.changed().flat_map(|(face, _)| sides(edit.before(face)).collect::<Vec<_>>());
        edit.valence(*v) == 0 && old.filter(|ends| ends.contains(v)).all(|ends| edit.curve(ends) != Some(curve))
    };
    edit.touched().into_iter().filter(is_dropped).collect()
}

/// The neighbours of a vertex along a feature curve.
fn feature_neighbours(edit: &Edit, v: u32, curve: u32) -> Vec<u32> {
    let mut ends: Vec<u32> = edit.around(v).flat_map(|face| edit.beside(face, v)).collect();
    ends.sort_unstable();
    ends.dedup();
    ends.retain(|&w| edit.curve([v, w]) == Some(curve));
    ends
}
