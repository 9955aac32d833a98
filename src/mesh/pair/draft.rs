//! A change of a mesh that is thought through before it is made: a few faces and places laid over the mesh as it is.

use crate::mesh::edit::Editor;
use crate::mesh::{Mesh, Metric};
use glam::DVec3;
use rustc_hash::FxHashSet;

/// The mesh under work and what must be known of its vertices.
pub(super) struct Scene {
    pub(super) editor: Editor,
    /// Unit normals of the surface.
    pub(super) normals: Vec<DVec3>,
    /// How many faces each vertex should have.
    pub(super) ideal: Vec<u8>,
    /// Vertices that may neither move nor vanish.
    pub(super) fixed: Vec<bool>,
    /// Edges that stay, the smaller id first.
    pub(super) features: FxHashSet<[u32; 2]>,
    pub(super) metric: Metric,
}

impl Scene {
    /// Every vertex that may move should have four faces; those of the others are told later.
    pub(super) fn new(
        mesh: &Mesh,
        normals: Vec<DVec3>,
        below: &[Option<u32>],
        features: &[[u32; 2]],
        metric: Metric,
    ) -> Self {
        Self {
            editor: Editor::new(mesh),
            normals,
            ideal: vec![4; mesh.points.len()],
            fixed: below.iter().map(Option::is_none).collect(),
            features: features.iter().copied().collect(),
            metric,
        }
    }

    pub(super) fn is_feature(&self, a: u32, b: u32) -> bool {
        let on = |v: u32| self.fixed.get(v as usize) == Some(&true);
        on(a) && on(b) && self.features.contains(&[a.min(b), a.max(b)])
    }
}

/// No vertex, in the last corner of a triangle and in all corners of a face that is gone.
const NONE: u32 = u32::MAX;

/// The corners of a face of at most four.
type Corners = [u32; 4];

/// Faces of a draft are found by a search through all that it changes: they are few.
#[derive(Clone)]
pub(super) struct Draft<'a> {
    pub(super) scene: &'a Scene,
    /// Faces that the draft changes, gone ones and new ones too.
    faces: Vec<(u32, Corners)>,
    /// New vertices, by the vertex whose copy each is.
    copies: Vec<u32>,
    /// Vertices that the draft moves, new ones too.
    places: Vec<(u32, DVec3)>,
}

impl<'a> Draft<'a> {
    pub(super) fn new(scene: &'a Scene) -> Self {
        Self { scene, faces: Vec::new(), copies: Vec::new(), places: Vec::new() }
    }

    /// The vertices of a face; none where it is gone.
    pub(super) fn face(&self, face: u32) -> &[u32] {
        match self.faces.iter().find(|changed| changed.0 == face) {
            Some((_, corners)) => slice(corners),
            None => self.scene.editor.face(face),
        }
    }

    /// The faces that the draft changes.
    pub(super) fn changed(&self) -> impl Iterator<Item = (u32, &[u32])> {
        self.faces.iter().map(|(face, corners)| (*face, slice(corners)))
    }

    /// The vertices whose copies the draft adds.
    pub(super) fn copies(&self) -> &[u32] {
        &self.copies
    }

    /// The places that the draft gives vertices.
    pub(super) fn places(&self) -> &[(u32, DVec3)] {
        &self.places
    }

    pub(super) fn set_face(&mut self, face: u32, corners: &[u32]) {
        let mut held = [NONE; 4];
        held[..corners.len()].copy_from_slice(corners);
        match self.faces.iter_mut().find(|changed| changed.0 == face) {
            Some(changed) => changed.1 = held,
            None => self.faces.push((face, held)),
        }
    }

    /// Adds a face; returns its id.
    pub(super) fn add_face(&mut self, corners: &[u32]) -> u32 {
        let known = self.scene.editor.face_count() as u32;
        let last = self.faces.iter().map(|changed| changed.0).max().unwrap_or(0);
        let face = known.max(last + 1);
        self.set_face(face, corners);
        face
    }

    /// A second vertex at the place of one, which it can take some of the faces of.
    pub(super) fn copy(&mut self, vertex: u32) -> u32 {
        let copy = self.first_copy() + self.copies.len() as u32;
        self.copies.push(self.original(vertex));
        self.place(copy, self.point(vertex));
        copy
    }

    pub(super) fn place(&mut self, vertex: u32, point: DVec3) {
        match self.places.iter_mut().find(|placed| placed.0 == vertex) {
            Some(placed) => placed.1 = point,
            None => self.places.push((vertex, point)),
        }
    }

    pub(super) fn point(&self, vertex: u32) -> DVec3 {
        match self.places.iter().find(|placed| placed.0 == vertex) {
            Some(placed) => placed.1,
            None => self.scene.editor.point(vertex).into(),
        }
    }

    pub(super) fn normal(&self, vertex: u32) -> DVec3 {
        self.scene.normals[self.original(vertex) as usize]
    }

    pub(super) fn is_fixed(&self, vertex: u32) -> bool {
        self.scene.fixed[self.original(vertex) as usize]
    }

    /// The vertex itself, or the one whose copy it is.
    pub(super) fn original(&self, vertex: u32) -> u32 {
        match vertex.checked_sub(self.first_copy()) {
            Some(copy) => self.copies[copy as usize],
            None => vertex,
        }
    }

    /// The faces at a vertex, in no geometric order.
    pub(super) fn around(&self, vertex: u32) -> impl Iterator<Item = u32> {
        let known = if vertex < self.first_copy() { self.scene.editor.around(vertex) } else { &[] };
        let kept = known.iter().copied().filter(|face| !self.faces.iter().any(|changed| changed.0 == *face));
        kept.chain(self.faces.iter().filter(move |changed| changed.1.contains(&vertex)).map(|changed| changed.0))
    }

    /// The number of faces at a vertex.
    pub(super) fn valence(&self, vertex: u32) -> usize {
        self.around(vertex).count()
    }

    /// The vertices before and after `vertex` in a face that has it.
    pub(super) fn wings(&self, face: u32, vertex: u32) -> [u32; 2] {
        wings(self.face(face), vertex)
    }

    /// The face that runs from `a` to `b`.
    pub(super) fn left(&self, a: u32, b: u32) -> Option<u32> {
        self.around(a).find(|face| self.wings(*face, a)[1] == b)
    }

    /// The face across the side from `a` to `b` of a face, unless that is a feature.
    pub(super) fn across(&self, a: u32, b: u32) -> Option<u32> {
        self.left(b, a).filter(|_| !self.scene.is_feature(a, b))
    }

    /// The faces round a vertex counter-clockwise, from `first` on; `None` where they do not close.
    pub(super) fn fan(&self, vertex: u32, first: u32) -> Option<Vec<u32>> {
        let mut fan = vec![first];
        loop {
            let next = self.left(vertex, self.wings(fan[fan.len() - 1], vertex)[0])?;
            if next == first {
                return Some(fan);
            }
            if fan.len() > 12 {
                return None;
            }
            fan.push(next);
        }
    }

    /// How far a vertex with some faces more is from having those that it should.
    pub(super) fn irregularity(&self, vertex: u32, more: i32) -> f64 {
        f64::from(self.valence(vertex) as i32 + more - self.ideal(vertex)).powi(2)
    }

    /// How many faces a vertex should have.
    pub(super) fn ideal(&self, vertex: u32) -> i32 {
        self.scene.ideal[self.original(vertex) as usize].into()
    }

    /// The vertices of all changed faces, as they were and as they are, sorted.
    pub(super) fn touched(&self) -> Vec<u32> {
        let editor = &self.scene.editor;
        let known = |face: u32| if (face as usize) < editor.face_count() { editor.face(face) } else { &[] };
        let mut touched: Vec<u32> =
            self.changed().flat_map(|(face, corners)| corners.iter().chain(known(face))).copied().collect();
        touched.sort_unstable();
        touched.dedup();
        touched
    }

    /// How many vertices come, less those that are left without a face.
    pub(super) fn growth(&self) -> i64 {
        let gone = self.touched().into_iter().filter(|v| self.around(*v).next().is_none()).count();
        self.copies.len() as i64 - gone as i64
    }

    /// Whether the faces at the vertices that it touches are still a manifold: one fan round each vertex, of three
    /// faces at least where it closes, and no two faces with the same vertices.
    pub(super) fn is_sound(&self) -> bool {
        let mut spokes: Vec<[u32; 2]> = Vec::new();
        self.touched().into_iter().all(|vertex| {
            spokes.clear();
            spokes.extend(self.around(vertex).map(|face| self.wings(face, vertex)));
            let Some(&first) =
                spokes.iter().find(|[_, after]| spokes.iter().all(|s| s[0] != *after)).or(spokes.first())
            else {
                // Only a vertex that was merged with another may be left without a face.
                return !self.is_fixed(vertex);
            };
            let mut at = first;
            for count in 1..=spokes.len() {
                let mut next = spokes.iter().filter(|spoke| spoke[1] == at[0]);
                match (next.next(), next.next()) {
                    (_, Some(_)) => return false,
                    (None, _) => return count == spokes.len(),
                    (Some(&spoke), None) if spoke == first => {
                        return count == spokes.len() && count > if self.is_fixed(vertex) { 1 } else { 2 };
                    }
                    (Some(&spoke), None) => at = spoke,
                }
            }
            false
        }) && self.changed().all(|(face, corners)| {
            let same = |&other: &u32| {
                let others = self.face(other);
                other != face && others.len() == corners.len() && others.iter().all(|v| corners.contains(v))
            };
            let repeats = (1..corners.len()).any(|k| corners[..k].contains(&corners[k]));
            !repeats && corners.first().is_none_or(|&v| !self.around(v).any(|other| same(&other)))
        })
    }

    /// The first id that no vertex has had.
    pub(super) fn first_copy(&self) -> u32 {
        self.scene.editor.vertex_count() as u32
    }
}

/// The vertices before and after `vertex` in a face that has it.
pub(super) fn wings(corners: &[u32], vertex: u32) -> [u32; 2] {
    let place = corners.iter().position(|corner| *corner == vertex).expect("the face has the vertex");
    [corners[(place + corners.len() - 1) % corners.len()], corners[(place + 1) % corners.len()]]
}

fn slice(corners: &Corners) -> &[u32] {
    match corners {
        [NONE, ..] => &[],
        [_, _, _, NONE] => &corners[..3],
        _ => corners,
    }
}
