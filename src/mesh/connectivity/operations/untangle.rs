//! Untangling: edits that remove faults, which are inverted, concave or degenerate faces.
//!
//! # Theory
//! A fault spans a part thinner than a tile, or all of its corners lie on one feature curve. Six edits are proposed: it is recut
//! together with a face beside it, one of its edges is collapsed, two of its corners are merged, it meets a triangle beside it, a
//! vertex of its curve is removed, or it is split. If none helps, two edits in turn are proposed. With [`Quads::All`] the last
//! resort is a ring of quads about the corner opposite to a straight one.

use super::super::edit::Edit;
use super::super::{Engine, Kind, Quads};
use super::recut::{collapsed, flipped, recut, split};
use super::walk;
use crate::mesh::incidence::sides;
use crate::mesh::vertex::Place;

/// The single edits about a fault.
pub(super) fn once<'e>(engine: &'e Engine, face: u32) -> Vec<(Kind, Edit<'e>)> {
    let mut edits = recuts_and_collapses(&Edit::new(engine.mesh), face);
    edits.retain(|(_, edit)| is_allowed(engine, edit));
    edits
}

/// The pairs of edits about a fault, each pair as one edit.
pub(super) fn twice<'e>(engine: &'e Engine, face: u32) -> Vec<(Kind, Edit<'e>)> {
    let mut edits: Vec<(Kind, Edit)> = Vec::new();
    for (kind, edit) in recuts_and_collapses(&Edit::new(engine.mesh), face) {
        let faces: Vec<u32> = edit.changed().filter(|(_, corners)| !corners.is_empty()).map(|(face, _)| face).collect();
        let again = faces.into_iter().flat_map(|face| recuts_and_collapses(&edit, face));
        let again = again.filter(|edit| has_fewer_faults(engine, &edit.1));
        edits.extend(again.map(|(_, edit)| (kind, edit)).filter(|(_, edit)| is_allowed(engine, edit)));
    }
    edits
}

/// Whether fewer of the changed faces are faults than before before the vertices relax: a quick test, as edits in two
/// steps are many.
fn has_fewer_faults(engine: &Engine, edit: &Edit) -> bool {
    let old = edit.changed().filter(|(face, _)| !edit.before(*face).is_empty());
    let before = old.filter(|(face, _)| engine.is_fault(*face)).count();
    let new = edit.changed().filter(|(_, corners)| !corners.is_empty());
    new.filter(|(face, _)| edit.measure(engine.context, *face).is_fault).take(before).count() < before
}

/// Whether an edit is sound, and adds no triangle with [`Quads::All`].
fn is_allowed(engine: &Engine, edit: &Edit) -> bool {
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
