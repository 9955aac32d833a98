//! Quads about irregular vertices and faces of a poor shape are cut anew, or go.
//!
//! # Theory
//! Two operations keep all quads quads: an edge between two flips to one of the two other diagonals of their hexagon, and a
//! quad goes when two opposite corners become one. A vertex of valence 3 beside one of valence 5 vanishes by the first, two of
//! valence 3 opposite each other in a quad by the second. A vertex inside the surface that only two faces have always goes. A
//! thin triangle is cut anew together with the face beside it.

use super::super::edit::Edit;
use super::super::{Engine, Kind, Quads};
use super::walk;

/// A quad of a smaller shape is worth a look.
const POOR: f64 = 0.7;
/// So is a triangle of a smaller one.
const NEEDLE: f64 = 0.3;
/// A quad of a smaller shape may be split into two triangles.
const SPLIT: f64 = 0.4;
/// Irregular vertices of a quad that is worth a look.
const IRREGULAR: usize = 2;

/// Whether a face is worth a look.
pub(super) fn is_poor(engine: &Engine, face: u32) -> bool {
    let corners = engine.mesh.face(face);
    let shape = engine.measures[face as usize].shape;
    match corners.len() {
        3 => shape < NEEDLE,
        4 => {
            let edit = Edit::new(engine.mesh);
            let irregular = || corners.iter().filter(|&&v| edit.irregularity(v, 0) > 0.0).count();
            shape < POOR || (engine.options.regularity > 0.0 && irregular() >= IRREGULAR)
        }
        _ => false,
    }
}

/// The edits that cut a face anew, or take a quad out.
pub(super) fn recuts<'e>(engine: &'e Engine, face: u32) -> Vec<(Kind, Edit<'e>)> {
    let edit = Edit::new(engine.mesh);
    let mut edits: Vec<(Kind, Edit)> = Vec::new();
    if edit.face(face).len() == 3 {
        edits.extend((0..3).flat_map(|side| recut(&edit, face, side)).map(|edit| (Kind::Flip, edit)));
    } else {
        edits.extend((0..4).flat_map(|side| flipped(&edit, face, side)).map(|edit| (Kind::Flip, edit)));
        edits.extend((0..2).filter_map(|k| collapsed(&edit, face, k)).map(|edit| (Kind::Collapse, edit)));
        if engine.options.quads == Quads::Most && engine.measures[face as usize].shape < SPLIT {
            edits.extend((0..2).map(|k| (Kind::Split, split(&edit, face, k))));
        }
    }
    edits.retain(|(_, edit)| edit.is_sound());
    edits
}

/// Takes out the vertices inside the surface that only two faces have: one of the faces has a straight corner or a reflex
/// one there, whatever the vertex does.
pub(in super::super) fn dissolve(engine: &mut Engine) {
    for v in 0..engine.mesh.vertices().len() as u32 {
        let Some((edit, gone)) = dissolved(&Edit::new(engine.mesh), v) else { continue };
        let change = edit.into_change();
        engine.make(&change, &[]);
        engine.excess -= gone as i64;
        engine.counts.dissolved += gone;
    }
}

/// The edit after which a vertex between two faces is no more and they are one, and then those that come to lie so; how many.
fn dissolved<'a>(edit: &Edit<'a>, v: u32) -> Option<(Edit<'a>, usize)> {
    let is_loose = |edit: &Edit, v: u32| edit.is_free(v) && edit.valence(v) == 2;
    let (mut edit, mut next, mut count) = (edit.clone(), Some(v).filter(|&v| is_loose(edit, v)), 0);
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
        next = whole.into_iter().find(|&v| is_loose(&edit, v));
    }
    (count > 0 && edit.is_sound()).then_some((edit, count))
}

/// The edits that cut a triangle and the face beyond one of its sides in another way.
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

/// The edits that flip the edge between a quad and that beyond one of its sides to another diagonal of their hexagon.
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

/// The edit that makes one vertex of two opposite corners of a quad.
pub(super) fn collapsed<'a>(edit: &Edit<'a>, face: u32, corner: usize) -> Option<Edit<'a>> {
    let corners = edit.face(face);
    let [a, b] = [corners[corner], corners[corner + 2]];
    let mut result = edit.clone();
    result.set_face(face, &[]);
    result.merge(a, b)?;
    Some(result)
}

/// The edit that cuts a quad into two triangles from one of its corners.
pub(super) fn split<'a>(edit: &Edit<'a>, face: u32, corner: usize) -> Edit<'a> {
    let corners = edit.face(face);
    let [a, b, c, d] = [0, 1, 2, 3].map(|k| corners[(corner + k) % 4]);
    let mut result = edit.clone();
    result.set_face(face, &[a, b, c]);
    result.add_face(&[a, c, d]);
    result
}
