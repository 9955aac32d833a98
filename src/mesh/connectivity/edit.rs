//! An edit: a few faces, vertices and feature edges laid over a mesh, thought through before it is made.
//!
//! New faces and vertices have ids of their own, from [`NEW`] on, until the edit is made: it stays valid while the mesh grows
//! elsewhere.

use crate::mesh::incidence::{neighbours_in, sides, undirected};
use crate::mesh::surface_mesh::{SurfaceMesh, Vertex, walked};
use crate::surface::Surface;
use glam::DVec3;

/// The first id of the faces and vertices that an edit adds.
pub(crate) const NEW: u32 = 1 << 31;
/// No vertex, in the last corner of a triangle and in all corners of a face that is gone.
const NONE: u32 = u32::MAX;

/// The corners of a face of at most four.
type Corners = [u32; 4];

/// What an edit changes; faces are found by a search through all: they are few.
#[derive(Clone, Debug, Default)]
pub(crate) struct Change {
    /// Faces that it changes, gone ones and new ones too.
    faces: Vec<(u32, Corners)>,
    /// New vertices, each with one whose metric it takes.
    vertices: Vec<(Vertex, u32)>,
    /// Points towards which it moves vertices.
    moved: Vec<(u32, DVec3)>,
    /// Edges whose curve it changes.
    features: Vec<([u32; 2], Option<u32>)>,
}

/// A mesh as it would be after a change.
#[derive(Clone)]
pub(crate) struct Edit<'a> {
    pub(crate) mesh: &'a SurfaceMesh,
    change: Change,
}

impl<'a> Edit<'a> {
    /// The mesh as it is.
    pub(crate) fn new(mesh: &'a SurfaceMesh) -> Self {
        Self::with(mesh, Change::default())
    }

    /// The mesh after a change.
    pub(crate) fn with(mesh: &'a SurfaceMesh, change: Change) -> Self {
        Self { mesh, change }
    }

    pub(crate) fn into_change(self) -> Change {
        self.change
    }

    /// The vertices of a face; none where it is gone.
    pub(crate) fn face(&self, face: u32) -> &[u32] {
        match self.change.faces.iter().find(|changed| changed.0 == face) {
            Some((_, corners)) => slice(corners),
            None => self.mesh.face(face),
        }
    }

    /// The faces that the edit changes.
    pub(crate) fn changed(&self) -> impl Iterator<Item = (u32, &[u32])> {
        self.change.faces.iter().map(|(face, corners)| (*face, slice(corners)))
    }

    /// The vertices of a face before the edit; none for a new one.
    pub(crate) fn before(&self, face: u32) -> &[u32] {
        if face < NEW { self.mesh.face(face) } else { &[] }
    }

    pub(crate) fn set_face(&mut self, face: u32, corners: &[u32]) {
        let mut held = [NONE; 4];
        held[..corners.len()].copy_from_slice(corners);
        match self.change.faces.iter_mut().find(|changed| changed.0 == face) {
            Some(changed) => changed.1 = held,
            None => self.change.faces.push((face, held)),
        }
    }

    /// Adds a face; returns its id.
    pub(crate) fn add_face(&mut self, corners: &[u32]) -> u32 {
        let face = self.change.faces.iter().filter(|(face, _)| *face >= NEW).count() as u32 + NEW;
        self.set_face(face, corners);
        face
    }

    /// Adds a vertex; `like` is one whose metric it takes.
    pub(crate) fn add_vertex(&mut self, vertex: Vertex, like: u32) -> u32 {
        self.change.vertices.push((vertex, like));
        NEW + self.change.vertices.len() as u32 - 1
    }

    /// A second vertex at the place of one, which it can take some of the faces of.
    pub(crate) fn copy(&mut self, v: u32) -> u32 {
        let vertex = Vertex { origin: u32::MAX, ..*self.vertex(v) };
        let like = self.original(v);
        self.add_vertex(vertex, like)
    }

    /// Moves a vertex; it comes to lie on the surface when the edit is made.
    pub(crate) fn set_point(&mut self, v: u32, point: DVec3) {
        match self.change.moved.iter_mut().find(|moved| moved.0 == v) {
            Some(moved) => moved.1 = point,
            None => self.change.moved.push((v, point)),
        }
    }

    pub(crate) fn set_feature(&mut self, edge: [u32; 2], curve: Option<u32>) {
        let edge = undirected(edge);
        match self.change.features.iter_mut().find(|changed| changed.0 == edge) {
            Some(changed) => changed.1 = curve,
            None => self.change.features.push((edge, curve)),
        }
    }

    /// A vertex; the point of one that the edit moves is told by [`Self::point`].
    pub(crate) fn vertex(&self, v: u32) -> &Vertex {
        if v >= NEW { &self.change.vertices[(v - NEW) as usize].0 } else { self.mesh.vertex(v) }
    }

    pub(crate) fn point(&self, v: u32) -> DVec3 {
        self.change.moved.iter().find(|moved| moved.0 == v).map_or_else(|| self.vertex(v).point, |moved| moved.1)
    }

    pub(crate) fn is_free(&self, v: u32) -> bool {
        self.vertex(v).is_free()
    }

    /// The vertex itself, or for a new one that whose metric it takes.
    pub(crate) fn original(&self, v: u32) -> u32 {
        if v >= NEW { self.change.vertices[(v - NEW) as usize].1 } else { v }
    }

    /// The curve of an edge on a feature.
    pub(crate) fn curve(&self, edge: [u32; 2]) -> Option<u32> {
        let key = undirected(edge);
        let changed = self.change.features.iter().find(|changed| changed.0 == key);
        changed.map_or_else(|| if key[1] < NEW { self.mesh.curve(key) } else { None }, |changed| changed.1)
    }

    /// The edges whose curve the edit changes, with the curve before and after it.
    pub(crate) fn changed_features(&self) -> impl Iterator<Item = ([u32; 2], [Option<u32>; 2])> {
        let before = |edge: [u32; 2]| if edge[1] < NEW { self.mesh.curve(edge) } else { None };
        self.change.features.iter().map(move |&(edge, after)| (edge, [before(edge), after]))
    }

    /// The faces at a vertex, in no geometric order.
    pub(crate) fn around(&self, v: u32) -> impl Iterator<Item = u32> {
        let known = if v < NEW { self.mesh.around(v) } else { &[] };
        let faces = &self.change.faces;
        let kept = known.iter().copied().filter(|face| !faces.iter().any(|changed| changed.0 == *face));
        kept.chain(faces.iter().filter(move |changed| changed.1.contains(&v)).map(|changed| changed.0))
    }

    /// The number of faces at a vertex.
    pub(crate) fn valence(&self, v: u32) -> usize {
        self.around(v).count()
    }

    /// The corners before and after `v` in a face that has it.
    pub(crate) fn beside(&self, face: u32, v: u32) -> [u32; 2] {
        neighbours_in(self.face(face), v)
    }

    /// The face that runs from `a` to `b`.
    pub(crate) fn left(&self, a: u32, b: u32) -> Option<u32> {
        self.around(a).find(|face| self.beside(*face, a)[1] == b)
    }

    /// The face across the side from `a` to `b` of a face, unless that is a feature.
    pub(crate) fn across(&self, a: u32, b: u32) -> Option<u32> {
        self.left(b, a).filter(|_| self.curve([a, b]).is_none())
    }

    /// Whether a vertex lies on the boundary of the mesh.
    pub(crate) fn on_boundary(&self, v: u32) -> bool {
        self.around(v).any(|face| {
            let [before, after] = self.beside(face, v);
            self.left(v, before).is_none() || self.left(after, v).is_none()
        })
    }

    /// The faces round a vertex counter-clockwise, from `first` on; `None` where they do not close.
    pub(crate) fn fan(&self, v: u32, first: u32) -> Option<Vec<u32>> {
        /// Vertices of more faces are left alone.
        const MOST: usize = 12;
        let mut fan = vec![first];
        loop {
            let next = self.left(v, self.beside(fan[fan.len() - 1], v)[0])?;
            if next == first {
                return Some(fan);
            }
            if fan.len() > MOST {
                return None;
            }
            fan.push(next);
        }
    }

    /// The squared difference of a vertex with some faces more from the number that it should have.
    pub(crate) fn irregularity(&self, v: u32, more: i32) -> f64 {
        f64::from(self.valence(v) as i32 + more - self.wanted_valence(v)).powi(2)
    }

    /// The number of faces that a vertex should have.
    pub(crate) fn wanted_valence(&self, v: u32) -> i32 {
        self.vertex(v).valence.into()
    }

    /// Gives `to` the faces of `from` that `which` names; `None` where one has more than four sides or has both.
    pub(crate) fn rename(&mut self, from: u32, to: u32, which: impl Fn(u32) -> bool) -> Option<()> {
        let faces: Vec<u32> = self.around(from).filter(|face| which(*face)).collect();
        for face in faces {
            let mut corners = self.face(face).to_vec();
            if corners.len() > 4 || corners.contains(&to) {
                return None;
            }
            corners.iter_mut().filter(|v| **v == from).for_each(|v| *v = to);
            self.set_face(face, &corners);
        }
        Some(())
    }

    /// Makes one vertex of two: of one that is free and another, the other stays; of two that are free, at their middle. The
    /// faces that have both lose a corner, those of three go. `None` where neither is free.
    pub(crate) fn merge(&mut self, a: u32, b: u32) -> Option<u32> {
        let (stays, goes) = match (self.is_free(a), self.is_free(b)) {
            (false, false) => return None,
            (true, false) => (b, a),
            _ => (a, b),
        };
        if self.is_free(stays) {
            self.set_point(stays, (self.point(a) + self.point(b)) / 2.0);
        }
        self.absorb(stays, goes)
    }

    /// Gives one vertex the faces of another. The faces that have both lose a corner, those of three go.
    pub(crate) fn absorb(&mut self, stays: u32, goes: u32) -> Option<u32> {
        for face in self.around(goes).collect::<Vec<u32>>() {
            let corners = self.face(face);
            let rest: Vec<u32> = match corners.contains(&stays) {
                true => corners.iter().copied().filter(|&v| v != goes).collect(),
                false => corners.iter().map(|&v| if v == goes { stays } else { v }).collect(),
            };
            match rest.len() {
                2 => self.set_face(face, &[]),
                3 | 4 => self.set_face(face, &rest),
                _ => return None,
            }
        }
        Some(stays)
    }

    /// The vertices of all changed faces, as they were and as they are, sorted.
    pub(crate) fn touched(&self) -> Vec<u32> {
        let corners = self.changed().flat_map(|(face, corners)| corners.iter().chain(self.before(face)));
        let mut touched: Vec<u32> = corners.copied().collect();
        touched.sort_unstable();
        touched.dedup();
        touched
    }

    /// The number of vertices that come, less those that are left without a face.
    pub(crate) fn growth(&self) -> i64 {
        let gone = self.touched().into_iter().filter(|v| self.around(*v).next().is_none()).count();
        self.change.vertices.len() as i64 - gone as i64
    }

    /// Whether the faces at the touched vertices are still a manifold: one fan round each vertex, of three faces at least where
    /// it closes inside the surface, no two edges between two vertices, no two faces with the same vertices, no boundary
    /// where there was none, the same Euler characteristic, and no vertex on a feature without a face, except those in `dropped`.
    pub(crate) fn is_sound_without(&self, dropped: &[u32]) -> bool {
        let mut spokes: Vec<[u32; 2]> = Vec::new();
        self.touched().into_iter().all(|v| {
            spokes.clear();
            spokes.extend(self.around(v).map(|face| self.beside(face, v)));
            let Some(&first) =
                spokes.iter().find(|[_, after]| spokes.iter().all(|s| s[0] != *after)).or(spokes.first())
            else {
                return self.is_free(v) || dropped.contains(&v);
            };
            let mut at = first;
            for count in 1..=spokes.len() {
                let mut next = spokes.iter().filter(|spoke| spoke[1] == at[0]);
                match (next.next(), next.next()) {
                    (_, Some(_)) => return false,
                    (None, _) => return count == spokes.len() && self.may_be_open(v),
                    (Some(&spoke), None) if spoke == first => {
                        return count == spokes.len() && count > if self.is_free(v) { 2 } else { 1 };
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
        }) && self.euler_about(&self.touched()) == Self::new(self.mesh).euler_about(&self.touched())
    }

    /// The Euler characteristic of the faces about some vertices.
    fn euler_about(&self, vertices: &[u32]) -> i64 {
        let mut faces: Vec<u32> = vertices.iter().flat_map(|&v| self.around(v)).collect();
        faces.sort_unstable();
        faces.dedup();
        let mut edges: Vec<[u32; 2]> = faces.iter().flat_map(|&face| sides(self.face(face))).map(undirected).collect();
        edges.sort_unstable();
        edges.dedup();
        let mut corners: Vec<u32> = faces.iter().flat_map(|&face| self.face(face)).copied().collect();
        corners.sort_unstable();
        corners.dedup();
        corners.len() as i64 - edges.len() as i64 + faces.len() as i64
    }

    /// Whether a vertex may lie on the boundary after the edit: it did before, or it is new and on a feature.
    fn may_be_open(&self, v: u32) -> bool {
        if v >= NEW { !self.is_free(v) } else { Self::new(self.mesh).on_boundary(v) }
    }

    /// As [`Self::is_sound_without`], every vertex on a feature kept.
    pub(crate) fn is_sound(&self) -> bool {
        self.is_sound_without(&[])
    }
}

impl Change {
    /// Makes the change of a mesh and lets its free vertices walk towards points; returns the ids of the faces it has added.
    /// `targets` names vertices as the edit does.
    pub(crate) fn make(&self, mesh: &mut SurfaceMesh, surface: &Surface, targets: &[(u32, DVec3)]) -> Vec<u32> {
        let (first_vertex, first_face) = (mesh.vertices().len() as u32, mesh.face_bound() as u32);
        let made = |id: u32, first: u32| if id >= NEW { id - NEW + first } else { id };
        for (vertex, like) in &self.vertices {
            mesh.add_vertex(*vertex, made(*like, first_vertex));
        }
        for (face, corners) in &self.faces {
            let corners: Vec<u32> = slice(corners).iter().map(|&v| made(v, first_vertex)).collect();
            mesh.set_face(made(*face, first_face), &corners);
        }
        for &(ends, curve) in &self.features {
            mesh.set_feature(ends.map(|v| made(v, first_vertex)), curve);
        }
        for &(v, target) in targets {
            let v = made(v, first_vertex);
            let vertex = mesh.vertex(v);
            if vertex.is_free() {
                let position = walked(surface, vertex.triangles[0], vertex.point, target);
                mesh.set_position(v, &position, surface);
            }
        }
        (first_face..mesh.face_bound() as u32).collect()
    }
}

fn slice(corners: &Corners) -> &[u32] {
    match corners {
        [NONE, ..] => &[],
        [_, _, _, NONE] => &corners[..3],
        _ => corners,
    }
}
