//! Faces that look away from the surface are cut anew, or go.
//!
//! # Theory
//! Where the surface is thinner than a tile, or sharp edges lie nearer to each other, a face may span from one side to the
//! other and look away from both. It is cut anew together with a face beside it in every way that leaves quads and triangles,
//! one of its edges shrinks, or two of its corners meet; of what results the shapes decide among those in which fewer faces
//! look away: first of those in which none is left about the change. So it is with quads that have a straight corner. Where all faces are to be quads and nothing else helps such
//! a quad, a ring of quads is put about the corner opposite to the straight one.
//!
//! This is done last, when all vertices have their places, so that what is judged is what is written.
//!
//! # Practice
//! Of 19 meshes that had such faces (wings, a fish and a plane, 500 to 20,000 points, equal and fitting sides, with triangles
//! and without) 4 keep one to four, all of thin fins and notches. Done before smoothing, 8 of them kept some. A draft
//! that leaves none about it is preferred: else two straight corners became one reflex one.

use super::draft::{Draft, Scene};
use super::polish::{merged, recut, turned};
use super::settle::{Settled, quality};
use super::ways::seams;
use super::{Found, Kind, PairCounts, PairOptions, Quads, Work, step};
use crate::mesh::Metric;
use crate::mesh::facing::Facing;
use crate::mesh::smooth::Smoothed;
use glam::DVec3;

/// How upset a face may be, ...
const MOST: u32 = 5;
/// ... and what it is worth that it is less so, in perfect quads.
const WORTH: f64 = 1.0;
/// A quad of a smaller shape has a straight corner.
const FLAT: f64 = 0.05;

/// A mesh in which fewer faces look away or have straight corners.
pub struct Uprighted {
    /// The mesh, on its surface.
    pub smoothed: Smoothed,
    /// For each vertex its id in the old mesh; `u32::MAX` for a new one.
    pub kept: Vec<u32>,
    /// How many faces fewer.
    pub count: usize,
}

/// Makes the best change about each face that looks away from the surface or has a straight corner, whatever that costs in
/// shape; `None` where there is none, or nothing helps. `features` are the edges that stay, the smaller id first.
pub fn upright(
    metric: &Metric,
    facing: &Facing,
    smoothed: &Smoothed,
    features: &[[u32; 2]],
    options: &PairOptions,
) -> Option<Uprighted> {
    let Smoothed { mesh, below } = smoothed;
    let normal = |below: &Option<u32>| below.map_or(DVec3::ZERO, |triangle| facing.normal(triangle));
    let normals: Vec<DVec3> = below.iter().map(normal).collect();
    let own = |face: &[u32]| upset(facing, face, |v| mesh.points[v as usize].into(), |v| normals[v as usize]);
    let before: Vec<u32> = mesh.faces().map(own).filter(|upset| *upset > 0).collect();
    if before.is_empty() {
        return None;
    }
    let scene = Scene::new(mesh, normals, below, features, metric.clone());
    let mut work = Work::on(facing.surface(), scene, below, options);
    work.facing = Some(facing);
    for is_strict in [true, false] {
        work.is_strict = is_strict;
        work.run(Work::is_upset, Work::upright, &mut PairCounts::default());
    }
    if options.quads == Quads::All {
        work.seams = seams(facing.surface());
        for face in work.faces(Work::is_upset) {
            if let Some(corner) = work.opposite(face) {
                work.put_ring(facing, corner);
            }
        }
    }
    let upset_faces = work.faces(Work::is_upset);
    let after = upset_faces
        .iter()
        .map(|&face| work.upset(facing, &Draft::new(&work.scene), face, |v| work.scene.editor.point(v).into()))
        .sum::<u32>();
    if after >= before.iter().sum() {
        return None;
    }
    let count = before.len().saturating_sub(upset_faces.len());
    let Work { scene, below, .. } = work;
    let known = mesh.points.len() as u32;
    let (mesh, kept) = scene.editor.finish();
    let below = kept.iter().map(|&v| below[v as usize]).collect();
    let kept = kept.into_iter().map(|v| if v < known { v } else { u32::MAX }).collect();
    Some(Uprighted { smoothed: Smoothed { mesh, below }, kept, count })
}

impl Work<'_> {
    /// Whether a face looks away from the surface.
    fn is_upset(&self, face: u32) -> bool {
        let draft = Draft::new(&self.scene);
        self.facing.is_some_and(|facing| self.upset(facing, &draft, face, |v| draft.point(v)) > 0)
    }

    /// The best that can be done about a face that looks away, if anything is: by one change of faces, else by two.
    fn upright(&self, face: u32) -> Option<Found> {
        let once = changed(&Draft::new(&self.scene), face);
        let found = self.best_of(face, once.iter().filter(|(_, draft)| self.may_be(draft)).cloned());
        found.or_else(|| {
            let twice = once.iter().flat_map(|(_, draft)| {
                let faces = draft.changed().filter(|(_, corners)| !corners.is_empty()).map(|(face, _)| face);
                faces.flat_map(|face| changed(draft, face)).collect::<Vec<_>>()
            });
            self.best_of(face, twice.filter(|(_, draft)| self.may_be(draft)))
        })
    }

    /// The corner of a quad opposite to the one that is straight, if one is.
    fn opposite(&self, face: u32) -> Option<u32> {
        let draft = Draft::new(&self.scene);
        let &[a, b, c, d] = draft.face(face) else { return None };
        let quad = [a, b, c, d].map(|v| draft.point(v));
        let turn = |k: usize| {
            let [before, here, after] = [3, 0, 1].map(|by| quad[(k + by) % 4]);
            (here - before).normalize_or_zero().dot((after - here).normalize_or_zero())
        };
        let straightest = (0..4).max_by(|&j, &k| turn(j).total_cmp(&turn(k)))?;
        (quality(&quad) < FLAT).then(|| [a, b, c, d][(straightest + 2) % 4])
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

    /// How much better a settled draft is for the faces that are less upset; `None` where it is not.
    pub(super) fn relief(&self, facing: &Facing, draft: &Draft, settled: &Settled) -> Option<f64> {
        let before = Draft::new(&self.scene);
        let known = |face: &&u32| (**face as usize) < self.scene.editor.face_count();
        let was = settled.core.iter().filter(known);
        let was: u32 = was.map(|&face| self.upset(facing, &before, face, |v| before.point(v))).sum();
        let place = |v: u32| settled.places.iter().find(|(w, _)| *w == v).map_or_else(|| draft.point(v), |(_, p)| *p);
        let is: u32 = settled.core.iter().map(|&face| self.upset(facing, draft, face, place)).sum();
        (is < was).then(|| WORTH * f64::from(was - is))
    }

    fn upset(&self, facing: &Facing, draft: &Draft, face: u32, place: impl Fn(u32) -> DVec3) -> u32 {
        upset(facing, draft.face(face), place, |v| draft.normal(v))
    }
}

/// How upset a face is: most if it looks away from the surface or is concave, a little if it has a straight corner; `normal`
/// is the surface's at a vertex.
fn upset(facing: &Facing, face: &[u32], place: impl Fn(u32) -> DVec3, normal: impl Fn(u32) -> DVec3) -> u32 {
    let places: Vec<DVec3> = face.iter().map(|&v| place(v)).collect();
    if face.is_empty() {
        return 0;
    }
    let shape = quality(&places);
    match shape <= 0.0 || facing.looks_away(&places, face.iter().map(|&v| normal(v))) {
        true => MOST,
        false => u32::from(shape < FLAT),
    }
}

/// The drafts in which a face is cut anew together with one beside it, or two of its corners are one.
fn changed<'a>(draft: &Draft<'a>, face: u32) -> Vec<(Kind, Draft<'a>)> {
    let corners = draft.face(face);
    let count = corners.len();
    let mut drafts: Vec<(Kind, Draft)> = Vec::new();
    for side in 0..count {
        let [a, b] = [corners[side], corners[(side + 1) % count]];
        drafts.extend(shrunk(draft, a, b).map(|draft| (Kind::Merged, draft)));
        let Some(other) = draft.across(a, b) else { continue };
        let beyond = draft.face(other);
        let cut = match (count, beyond.len()) {
            (3, _) => recut(draft, face, side),
            (_, 3) => beyond.iter().position(|&v| v == b).map_or(Vec::new(), |at| recut(draft, other, at)),
            _ => turned(draft, face, side),
        };
        drafts.extend(cut.into_iter().map(|draft| (Kind::Turned, draft)));
        if count == 3 && beyond.len() == 3 {
            drafts.extend(step::meet(draft, face, side, other).map(|(_, draft)| (Kind::Met, draft)));
        }
    }
    if count == 4 {
        drafts.extend((0..2).filter_map(|k| merged(draft, face, k)).map(|draft| (Kind::Merged, draft)));
    }
    drafts
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
