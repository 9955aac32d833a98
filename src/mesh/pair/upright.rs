//! Faces that look away from the surface are cut anew, or go.
//!
//! # Theory
//! Where the surface is thinner than a tile, or sharp edges lie nearer to each other, a face may span from one side to the
//! other and look away from both. It is cut anew together with a face beside it in every way that leaves quads and triangles,
//! one of its edges shrinks, or two of its corners meet; of what results the shapes decide among those in which fewer faces
//! look away.

use super::draft::Draft;
use super::polish::{merged, recut, turned};
use super::settle::Settled;
use super::{Found, Kind, PairCounts, Quads, Work, step};
use crate::mesh::facing::Facing;
use glam::DVec3;

/// What a face less that looks away is worth, in perfect quads.
const WORTH: f64 = 4.0;

impl Work<'_> {
    /// Makes the best change about each face that looks away, whatever that costs in shape; none gets concave.
    pub(super) fn set_upright(&mut self, counts: &mut PairCounts) {
        self.options.least_shape = 0.0;
        self.facing = Some(Facing::new(self.surface));
        self.run(Self::is_upset, Self::upright, counts);
        self.facing = None;
    }

    /// Whether a face looks away from the surface.
    fn is_upset(&self, face: u32) -> bool {
        let draft = Draft::new(&self.scene);
        self.facing.as_ref().is_some_and(|facing| self.is_away(facing, &draft, face, |v| draft.point(v)))
    }

    /// The best that can be done about a face that looks away, if anything is.
    fn upright(&self, face: u32) -> Option<Found> {
        let draft = Draft::new(&self.scene);
        let corners = draft.face(face);
        let count = corners.len();
        let mut drafts: Vec<(Kind, Draft)> = Vec::new();
        for side in 0..count {
            let [a, b] = [corners[side], corners[(side + 1) % count]];
            drafts.extend(shrunk(&draft, a, b).map(|draft| (Kind::Merged, draft)));
            let Some(other) = draft.across(a, b) else { continue };
            let beyond = draft.face(other);
            let cut = match (count, beyond.len()) {
                (3, _) => recut(&draft, face, side),
                (_, 3) => beyond.iter().position(|&v| v == b).map_or(Vec::new(), |at| recut(&draft, other, at)),
                _ => turned(&draft, face, side),
            };
            drafts.extend(cut.into_iter().map(|draft| (Kind::Turned, draft)));
            if count == 3 && beyond.len() == 3 {
                drafts.extend(step::meet(&draft, face, side, other).map(|(_, draft)| (Kind::Met, draft)));
            }
        }
        if count == 4 {
            drafts.extend((0..2).filter_map(|k| merged(&draft, face, k)).map(|draft| (Kind::Merged, draft)));
        }
        self.best_of(face, drafts.into_iter().filter(|(_, draft)| self.may_be(draft)))
    }

    /// Where all faces are to be quads no triangle may come.
    fn may_be(&self, draft: &Draft) -> bool {
        let before = Draft::new(&self.scene);
        let is_triangle = |draft: &Draft, face: u32| usize::from(draft.face(face).len() == 3);
        let known = |face: u32| (face as usize) < self.scene.editor.face_count();
        let come: usize = draft.changed().map(|(face, _)| is_triangle(draft, face)).sum();
        let gone: usize = draft.changed().filter(|(face, _)| known(*face)).map(|(f, _)| is_triangle(&before, f)).sum();
        (self.options.quads == Quads::Most || come <= gone) && draft.is_sound()
    }

    /// How much better a settled draft is for the faces that look away no more; `None` where there are no fewer.
    pub(super) fn relief(&self, facing: &Facing, draft: &Draft, settled: &Settled) -> Option<f64> {
        let before = Draft::new(&self.scene);
        let known = |face: &&u32| (**face as usize) < self.scene.editor.face_count();
        let was = settled.core.iter().filter(known);
        let was = was.filter(|&&face| self.is_away(facing, &before, face, |v| before.point(v))).count();
        let place = |v: u32| settled.places.iter().find(|(w, _)| *w == v).map_or_else(|| draft.point(v), |(_, p)| *p);
        let is = settled.core.iter().filter(|&&face| self.is_away(facing, draft, face, place)).count();
        (is < was).then(|| WORTH * (was - is) as f64)
    }

    fn is_away(&self, facing: &Facing, draft: &Draft, face: u32, place: impl Fn(u32) -> DVec3) -> bool {
        let corners = draft.face(face);
        let places: Vec<DVec3> = corners.iter().map(|&v| place(v)).collect();
        !corners.is_empty() && facing.looks_away(&places, corners.iter().map(|&v| draft.normal(v)))
    }
}

/// The draft in which the ends of an edge are one; `None` where both are on features.
fn shrunk<'a>(draft: &Draft<'a>, a: u32, b: u32) -> Option<Draft<'a>> {
    let (stays, goes) = match (draft.is_fixed(a), draft.is_fixed(b)) {
        (true, true) => return None,
        (false, true) => (b, a),
        _ => (a, b),
    };
    let mut result = draft.clone();
    if !draft.is_fixed(stays) {
        result.place(stays, (draft.point(a) + draft.point(b)) / 2.0);
    }
    for face in draft.around(goes).collect::<Vec<u32>>() {
        let corners = draft.face(face);
        let rest: Vec<u32> = match corners.contains(&stays) {
            true => corners.iter().copied().filter(|&v| v != goes).collect(),
            false => corners.iter().map(|&v| if v == goes { stays } else { v }).collect(),
        };
        match rest.len() {
            2 => result.set_face(face, &[]),
            3 | 4 => result.set_face(face, &rest),
            _ => return None,
        }
    }
    Some(result)
}
