//! Quads about irregular vertices and faces of a bad shape are cut anew, or go.
//!
//! # Theory
//! Two operations keep all quads quads: an edge between two turns to one of the two other diagonals of their hexagon, and a
//! quad goes when two opposite corners become one. A vertex of valence 3 beside one of valence 5 vanishes by the first, two of
//! valence 3 opposite each other in a quad by the second. A vertex of valence 2 always goes. A thin
//! triangle is cut anew together with the face beside it.

use super::draft::Draft;
use super::rows::rename;
use super::settle::quality;
use super::{Change, Found, Kind, Work, step};
use crate::mesh::metric::laid;
use crate::mesh::quality::triangle_shape;

/// A quad of a smaller shape is worth a look.
const POOR: f64 = 0.7;
/// So is a triangle of a smaller one.
const NEEDLE: f64 = 0.3;
/// Irregular vertices of a quad that is worth a look.
const IRREGULAR: usize = 2;

impl Work<'_> {
    /// Whether a face is worth a look.
    pub(super) fn is_poor(&self, face: u32) -> bool {
        let draft = Draft::new(&self.scene);
        let corners = draft.face(face);
        let frame = self.scene.metric.frame(corners);
        let at = |v: u32| laid(frame.as_ref(), draft.point(v));
        match *corners {
            [a, b, c] => triangle_shape([a, b, c].map(|v| at(v).into())) < NEEDLE,
            [a, b, c, d] => {
                let irregular = || corners.iter().filter(|&&v| draft.irregularity(v, 0) > 0.0).count();
                quality(&[a, b, c, d].map(at)) < POOR || (self.regularity > 0.0 && irregular() >= IRREGULAR)
            }
            _ => false,
        }
    }

    /// The best that can be done about a face, if anything gains.
    pub(super) fn better(&self, face: u32) -> Option<Found> {
        let draft = Draft::new(&self.scene);
        if draft.face(face).len() == 3 {
            let cut = (0..3).flat_map(|side| recut(&draft, face, side)).map(|draft| (Kind::Turned, draft));
            return self.best_of(face, cut.filter(|(_, draft)| draft.is_sound()));
        }
        let turned = (0..4).flat_map(|side| turned(&draft, face, side)).map(|draft| (Kind::Turned, draft));
        let merged = (0..2).filter_map(|k| merged(&draft, face, k)).map(|draft| (Kind::Merged, draft));
        self.best_of(face, turned.chain(merged).filter(|(_, draft)| draft.is_sound()))
    }

    /// Takes out the vertices inside the surface that two faces alone have, and returns how many those were: one of the faces
    /// has a straight corner or a reflex one there, whatever the vertex does.
    pub(super) fn dissolve(&mut self) -> usize {
        let mut count = 0;
        for v in 0..self.scene.editor.vertex_count() as u32 {
            let Some((draft, gone)) = dissolved(&Draft::new(&self.scene), v) else { continue };
            let change = Change::of(&draft);
            self.drift -= gone as i64;
            self.apply(&change, &[]);
            count += gone;
        }
        count
    }
}

/// The draft in which a vertex between two faces is no more and they are one, and then those that come to lie so; how many.
fn dissolved<'a>(draft: &Draft<'a>, v: u32) -> Option<(Draft<'a>, usize)> {
    let is_loose = |draft: &Draft, v: u32| !draft.is_fixed(v) && draft.around(v).count() == 2;
    let (mut draft, mut next, mut count) = (draft.clone(), Some(v).filter(|&v| is_loose(draft, v)), 0);
    while let Some(v) = next {
        let faces: Vec<u32> = draft.around(v).collect();
        let others = |face: &u32| {
            let corners = draft.face(*face);
            let at = corners.iter().position(|&w| w == v).unwrap_or(0);
            (1..corners.len()).map(|k| corners[(at + k) % corners.len()]).collect::<Vec<u32>>()
        };
        let (mut whole, rest) = (others(&faces[0]), others(&faces[1]));
        whole.extend(&rest[1..rest.len() - 1]);
        if !(3..=4).contains(&whole.len()) {
            return None;
        }
        draft.set_face(faces[0], &whole);
        draft.set_face(faces[1], &[]);
        count += 1;
        next = whole.into_iter().find(|&v| is_loose(&draft, v));
    }
    (count > 0 && draft.is_sound()).then_some((draft, count))
}

/// The drafts in which a triangle and the face beyond one of its sides are cut in another way.
pub(super) fn recut<'a>(draft: &Draft<'a>, triangle: u32, side: usize) -> Vec<Draft<'a>> {
    let corners = draft.face(triangle);
    let [x, y, z] = [0, 1, 2].map(|k| corners[(side + k) % 3]);
    let Some(other) = draft.across(x, y) else { return Vec::new() };
    let beyond = draft.face(other);
    match *beyond {
        [_, _, _] => {
            let Some(&tip) = beyond.iter().find(|v| !corners.contains(v)) else { return Vec::new() };
            let mut result = draft.clone();
            result.set_face(triangle, &[z, x, tip]);
            result.set_face(other, &[z, tip, y]);
            vec![result]
        }
        [_, _, _, _] => step::steps(draft, triangle, side, other).map(|step| step.take(draft).0).collect(),
        _ => Vec::new(),
    }
}

/// The drafts in which the edge between a quad and that beyond one of its sides is another diagonal of their hexagon.
pub(super) fn turned<'a>(draft: &Draft<'a>, face: u32, side: usize) -> Vec<Draft<'a>> {
    let corners = draft.face(face);
    let [x, y, p, q] = [0, 1, 2, 3].map(|k| corners[(side + k) % 4]);
    let Some(other) = draft.across(x, y).filter(|&other| draft.face(other).len() == 4) else { return Vec::new() };
    let beyond = draft.face(other);
    let at = beyond.iter().position(|&v| v == x).unwrap_or(0);
    let [r, s] = [1, 2].map(|k| beyond[(at + k) % 4]);
    [[[p, q, x, r], [r, s, y, p]], [[q, x, r, s], [s, y, p, q]]]
        .into_iter()
        .map(|[first, second]| {
            let mut result = draft.clone();
            result.set_face(face, &first);
            result.set_face(other, &second);
            result
        })
        .collect()
}

/// The draft in which two opposite corners of a quad are one.
pub(super) fn merged<'a>(draft: &Draft<'a>, face: u32, corner: usize) -> Option<Draft<'a>> {
    let corners = draft.face(face);
    let [a, b] = [corners[corner], corners[corner + 2]];
    let (stays, goes) = match (draft.is_fixed(a), draft.is_fixed(b)) {
        (true, true) => return None,
        (false, true) => (b, a),
        _ => (a, b),
    };
    let mut result = draft.clone();
    result.set_face(face, &[]);
    if !draft.is_fixed(stays) {
        result.place(stays, (draft.point(a) + draft.point(b)) / 2.0);
    }
    rename(&mut result, goes, stays, |_| true)?;
    Some(result)
}
