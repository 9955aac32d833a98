//! Recutting: flips, collapses and splits of poor faces and of quads with irregular vertices.
//!
//! # Theory
//! Two operations keep a mesh of quads a mesh of quads. A flip replaces the edge between two quads by another diagonal of their
//! hexagon: it removes a vertex of valence 3 beside one of valence 5. A collapse merges two opposite corners of a quad: it removes
//! two vertices of valence 3 opposite each other. A thin triangle is recut together with the face beside it. A vertex of valence
//! 2 inside the surface is always removed.

use super::super::edit::Edit;
use super::super::{Engine, Kind, Quads};
use super::walk;

/// A quad of a smaller shape is recut.
const RECUT_QUAD: f64 = 0.7;
/// A triangle of a smaller shape is recut.
const RECUT_TRIANGLE: f64 = 0.3;
/// A quad of a smaller shape may be split into two triangles.
const SPLIT_QUAD: f64 = 0.4;
/// A quad with this number of irregular vertices is recut.
const IRREGULAR: usize = 2;

/// Whether a face may be recut.
pub(super) fn is_candidate(engine: &Engine, face: u32) -> bool {
    let corners = engine.mesh.face(face);
    let shape = engine.measures[face as usize].shape;
    match corners.len() {
        3 => shape < RECUT_TRIANGLE,
        4 => {
            let edit = Edit::new(engine.mesh);
            let irregular = || corners.iter().filter(|&&v| edit.irregularity(v, 0) > 0.0).count();
            shape < RECUT_QUAD || (engine.options.regularity > 0.0 && irregular() >= IRREGULAR)
        }
        _ => false,
    }
}

/// The edits that recut or split a face, or collapse a quad.
pub(super) fn recuts<'e>(engine: &'e Engine, face: u32) -> Vec<(Kind, Edit<'e>)> {
    let edit = Edit::new(engine.mesh);
    let mut edits: Vec<(Kind, Edit)> = Vec::new();
    if edit.face(face).len() == 3 {
        edits.extend((0..3).flat_map(|side| recut(&edit, face, side)).map(|edit| (Kind::Flip, edit)));
    } else {
        edits.extend((0..4).flat_map(|side| flipped(&edit, face, side)).map(|edit| (Kind::Flip, edit)));
        edits.extend((0..2).filter_map(|k| collapsed(&edit, face, k)).map(|edit| (Kind::Collapse, edit)));
        if engine.options.quads == Quads::Most && engine.measures[face as usize].shape < SPLIT_QUAD {
            edits.extend((0..2).map(|k| (Kind::Split, split(&edit, face, k))));
        }
    }
    edits.retain(|(_, edit)| edit.is_sound());
    edits
}

/// Removes the vertices of valence 2 inside the surface: one of the two faces has a straight or reflex corner there, wherever
/// the vertex is.
pub(in super::super) fn dissolve(engine: &mut Engine) {
    for v in 0..engine.mesh.vertices().len() as u32 {
        let Some((edit, count)) = dissolved(&Edit::new(engine.mesh), v) else { continue };
        let change = edit.into_change();
        engine.make(&change, &[]);
        engine.excess -= count as i64;
        engine.counts.dissolved += count;
    }
}

/// The edit that removes a vertex of valence 2 and merges its two faces, and so on for vertices that get valence 2; and the
/// number of removed vertices.
fn dissolved<'a>(edit: &Edit<'a>, v: u32) -> Option<(Edit<'a>, usize)> {
    let has_two_faces = |edit: &Edit, v: u32| edit.is_free(v) && edit.valence(v) == 2;
    let (mut edit, mut next, mut count) = (edit.clone(), Some(v).filter(|&v| has_two_faces(edit, v)), 0);
    while let Some(v) = next {
        let faces: Vec<u32> = edit.around(v).collect();
        let others = |face: &u32| {
            let corners = edit.face(*face);
            let at = corners.iter().position(|&w| w == v).unwrap_or(0);
            (1..corners.len()).map(|k| corners[(at + k) % corners.len()]).collect::<Vec<u32>>()
        };
        let (mut whole, rest) = (others(&faces[0]), others(&faces[1]));
        whole.extend(&rest[1..rest.len() - 1]);
        if !(3..=4).contains(&whole.len()) {
            return None;
        }
        edit.set_face(faces[0], &whole);
        edit.set_face(faces[1], &[]);
        count += 1;
        next = whole.into_iter().find(|&v| has_two_faces(&edit, v));
    }
    (count > 0 && edit.is_sound()).then_some((edit, count))
}

/// The edits that cut a triangle and the face across one of its sides in another way.
pub(super) fn recut<'a>(edit: &Edit<'a>, triangle: u32, side: usize) -> Vec<Edit<'a>> {
    let corners = edit.face(triangle);
    let [x, y, z] = [0, 1, 2].map(|k| corners[(side + k) % 3]);
    let Some(other) = edit.across(x, y) else { return Vec::new() };
    let beyond = edit.face(other);
    match *beyond {
        [_, _, _] => {
            let Some(&tip) = beyond.iter().find(|v| !corners.contains(v)) else { return Vec::new() };
            let mut result = edit.clone();
            result.set_face(triangle, &[z, x, tip]);
            result.set_face(other, &[z, tip, y]);
            vec![result]
        }
        [_, _, _, _] => walk::steps(edit, triangle, side, other).map(|step| step.take(edit).0).collect(),
        _ => Vec::new(),
    }
}

/// The edits that flip the edge between a quad and the quad across one of its sides to another diagonal of their hexagon.
pub(super) fn flipped<'a>(edit: &Edit<'a>, face: u32, side: usize) -> Vec<Edit<'a>> {
    let corners = edit.face(face);
    let [x, y, p, q] = [0, 1, 2, 3].map(|k| corners[(side + k) % 4]);
    let Some(other) = edit.across(x, y).filter(|&other| edit.face(other).len() == 4) else { return Vec::new() };
    let beyond = edit.face(other);
    let at = beyond.iter().position(|&v| v == x).unwrap_or(0);
    let [r, s] = [1, 2].map(|k| beyond[(at + k) % 4]);
    [[[p, q, x, r], [r, s, y, p]], [[q, x, r, s], [s, y, p, q]]]
        .into_iter()
        .map(|[first, second]| {
            let mut result = edit.clone();
            result.set_face(face, &first);
            result.set_face(other, &second);
            result
        })
        .collect()
}

/// The edit that merges two opposite corners of a quad.
pub(super) fn collapsed<'a>(edit: &Edit<'a>, face: u32, corner: usize) -> Option<Edit<'a>> {
    let corners = edit.face(face);
    let [a, b] = [corners[corner], corners[corner + 2]];
    let mut result = edit.clone();
    result.set_face(face, &[]);
    result.merge(a, b)?;
    Some(result)
}

/// The edit that splits a quad into two triangles from one of its corners.
pub(super) fn split<'a>(edit: &Edit<'a>, face: u32, corner: usize) -> Edit<'a> {
    let corners = edit.face(face);
    let [a, b, c, d] = [0, 1, 2, 3].map(|k| corners[(corner + k) % 4]);
    let mut result = edit.clone();
    result.set_face(face, &[a, b, c]);
    result.add_face(&[a, c, d]);
    result
}
