//! An edit: changed faces, vertices and feature edges over a mesh that stays as it is until the edit is made.
//!
//! # Practice
//! New faces and vertices have temporary ids, from [`NEW`] on. So an edit stays valid while other edits add to the mesh; check
//! [`Edit::is_sound`] and the faces that it changes before it is made.

use crate::mesh::incidence::{neighbours_in, sides, undirected};
use crate::mesh::objective::{Context, Measure};
use crate::mesh::surface_mesh::SurfaceMesh;
use crate::mesh::vertex::{Position, Vertex, walked};
use crate::surface::Surface;
use glam::DVec3;

/// The first id of the faces and vertices that an edit adds.
pub(crate) const NEW: u32 = 1 << 31;
/// No vertex: the last corner of a triangle, and all corners of a removed face.
const NONE: u32 = u32::MAX;

/// The corners of a triangle or a quad.
type Corners = [u32; 4];

/// The changes of an edit. They are few, so each look-up is a linear search.
#[derive(Clone, Debug, Default)]
pub(crate) struct Change {
    /// The changed faces, removed and new ones included.
    faces: Vec<(u32, Corners)>,
    /// The new vertices, each with the vertex whose metric it takes.
    vertices: Vec<(Vertex, u32)>,
    /// The new points of vertices.
    moved: Vec<(u32, DVec3)>,
    /// The sheets about vertices that were put on the surface.
    sheets: Vec<(u32, [u32; 2])>,
    /// The edges whose feature curve changes.
    features: Vec<([u32; 2], Option<u32>)>,
}

/// A mesh as it is after a change.
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

    /// The vertices of a face; none where it is removed.
    pub(crate) fn face(&self, face: u32) -> &[u32] {
        match self.change.faces.iter().find(|changed| changed.0 == face) {
            Some((_, corners)) => slice(corners),
            None => self.mesh.face(face),
        }
    }

    /// The changed faces, with their vertices after the edit.
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

    /// Adds a vertex; it takes the metric of the vertex `like`.
    pub(crate) fn add_vertex(&mut self, vertex: Vertex, like: u32) -> u32 {
        self.change.vertices.push((vertex, like));
        NEW + self.change.vertices.len() as u32 - 1
    }

    /// Adds a copy of a vertex, without faces.
    pub(crate) fn copy(&mut self, v: u32) -> u32 {
        let vertex = Vertex { origin: u32::MAX, is_kept: false, ..*self.vertex(v) };
        let like = self.original(v);
        self.add_vertex(vertex, like)
    }

    /// Moves a vertex. It is projected to the surface when the edit is made.
    pub(crate) fn set_point(&mut self, v: u32, point: DVec3) {
        match self.change.moved.iter_mut().find(|moved| moved.0 == v) {
            Some(moved) => moved.1 = point,
            None => self.change.moved.push((v, point)),
        }
    }

    /// Puts a vertex at a position on the surface.
    pub(crate) fn set_position(&mut self, v: u32, position: &Position) {
        self.set_point(v, position.point);
        match self.change.sheets.iter_mut().find(|sheets| sheets.0 == v) {
            Some(sheets) => sheets.1 = position.triangles,
            None => self.change.sheets.push((v, position.triangles)),
        }
    }

    /// The triangles of the surface on the two sides of a vertex.
    pub(crate) fn sheets(&self, v: u32) -> [u32; 2] {
        let moved = self.change.sheets.iter().find(|sheets| sheets.0 == v);
        moved.map_or_else(|| self.vertex(v).triangles, |moved| moved.1)
    }

    /// The measure of a face where its vertices are.
    pub(crate) fn measure(&self, context: &Context, face: u32) -> Measure {
        self.measure_of(context, self.face(face))
    }

    /// The measure of a face with these vertices.
    pub(crate) fn measure_of(&self, context: &Context, corners: &[u32]) -> Measure {
        let points: Vec<DVec3> = corners.iter().map(|&v| self.point(v)).collect();
        let originals: Vec<u32> = corners.iter().map(|&v| self.original(v)).collect();
        let map = self.mesh.metric().map_of(&originals);
        let sheets = corners.iter().map(|&v| self.sheets(v));
        Measure::of(&points, map.as_ref(), None, || context.orientation.is_inverted(&points, sheets))
    }

    pub(crate) fn set_feature(&mut self, edge: [u32; 2], curve: Option<u32>) {
        let edge = undirected(edge);
        match self.change.features.iter_mut().find(|changed| changed.0 == edge) {
            Some(changed) => changed.1 = curve,
            None => self.change.features.push((edge, curve)),
        }
    }

    /// A vertex; [`Self::point`] gives its point where the edit moves it.
    pub(crate) fn vertex(&self, v: u32) -> &Vertex {
        if v >= NEW { &self.change.vertices[(v - NEW) as usize].0 } else { self.mesh.vertex(v) }
    }

    pub(crate) fn point(&self, v: u32) -> DVec3 {
        self.change.moved.iter().find(|moved| moved.0 == v).map_or_else(|| self.vertex(v).point, |moved| moved.1)
    }

    /// Whether the mesh has all of these vertices where the edit has them.
    pub(crate) fn keeps(&self, vertices: &[u32]) -> bool {
        let Change { moved, sheets, .. } = &self.change;
        let is_changed = |v: u32| moved.iter().any(|moved| moved.0 == v) || sheets.iter().any(|sheets| sheets.0 == v);
        vertices.iter().all(|&v| v < NEW && !is_changed(v))
    }

    pub(crate) fn is_free(&self, v: u32) -> bool {
        self.vertex(v).is_free()
    }

    /// The vertex itself; for a new vertex, the one whose metric it takes.
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

    /// The face to the left of the edge from `a` to `b`.
    pub(crate) fn left(&self, a: u32, b: u32) -> Option<u32> {
        self.around(a).find(|face| self.beside(*face, a)[1] == b)
    }

    /// The face across the side from `a` to `b` of a face, unless the side lies on a feature.
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
        /// Vertices of more faces have no fan here.
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

    /// The squared difference between the valence of a vertex, with `more` faces, and the wanted valence.
    pub(crate) fn irregularity(&self, v: u32, more: i32) -> f64 {
        f64::from(self.valence(v) as i32 + more - self.wanted_valence(v)).powi(2)
    }

    /// The wanted valence of a vertex.
    pub(crate) fn wanted_valence(&self, v: u32) -> i32 {
        self.vertex(v).valence.into()
    }

    /// Moves the faces that satisfy `which` from a vertex to another; `None` where one has more than four sides or both vertices.
    pub(crate) fn move_faces(&mut self, from: u32, to: u32, which: impl Fn(u32) -> bool) -> Option<()> {
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

    /// Merges two vertices; returns the one that stays. Of a free vertex and another, the other stays; two free vertices meet at
    /// their middle. `None` where neither is free. See [`Self::absorb`].
    pub(crate) fn merge(&mut self, a: u32, b: u32) -> Option<u32> {
        let (kept, removed) = match (self.is_free(a), self.is_free(b)) {
            (false, false) => return None,
            (true, false) => (b, a),
            _ => (a, b),
        };
        if self.is_free(kept) {
            self.set_point(kept, (self.point(a) + self.point(b)) / 2.0);
        }
        self.absorb(kept, removed)
    }

    /// Moves the faces of a vertex to another one. A quad with both becomes a triangle, a triangle with both is removed. `None`
    /// where a face has more than four sides.
    pub(crate) fn absorb(&mut self, kept: u32, removed: u32) -> Option<u32> {
        for face in self.around(removed).collect::<Vec<u32>>() {
            let corners = self.face(face);
            let rest: Vec<u32> = match corners.contains(&kept) {
                true => corners.iter().copied().filter(|&v| v != removed).collect(),
                false => corners.iter().map(|&v| if v == removed { kept } else { v }).collect(),
            };
            match rest.len() {
                2 => self.set_face(face, &[]),
                3 | 4 => self.set_face(face, &rest),
                _ => return None,
            }
        }
        Some(kept)
    }

    /// The vertices of all changed faces, before and after the edit, sorted.
    pub(crate) fn touched(&self) -> Vec<u32> {
        let corners = self.changed().flat_map(|(face, corners)| corners.iter().chain(self.before(face)));
        let mut touched: Vec<u32> = corners.copied().collect();
        touched.sort_unstable();
        touched.dedup();
        touched
    }

    /// The number of vertices added, less those left without a face.
    pub(crate) fn growth(&self) -> i64 {
        let removed = self.touched().into_iter().filter(|v| self.around(*v).next().is_none()).count();
        self.change.vertices.len() as i64 - removed as i64
    }

    /// Whether the edit keeps the mesh a manifold of the same topology. The faces at each touched vertex form one fan, of at
    /// least three faces round a free vertex; no two edges have the same ends, and no two faces the same vertices; no new
    /// boundary appears; boundary edges that are kept stay; the Euler characteristic stays; and each vertex on a feature has a
    /// face, except those in `dropped`.
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
        }) && self.kept_edges() == self.kept_edges_before()
            && self.euler_about(&self.touched()) == Self::new(self.mesh).euler_about(&self.touched())
    }

    /// The boundary edges between kept vertices in the changed faces, sorted.
    fn kept_edges(&self) -> Vec<[u32; 2]> {
        let faces = self.changed().map(|(_, corners)| corners);
        self.kept_edges_of(faces)
    }

    /// The boundary edges between kept vertices in the faces that change, before the edit, sorted.
    fn kept_edges_before(&self) -> Vec<[u32; 2]> {
        let faces = self.changed().map(|(face, _)| self.before(face));
        Self::new(self.mesh).kept_edges_of(faces)
    }

    fn kept_edges_of<'f>(&self, faces: impl Iterator<Item = &'f [u32]>) -> Vec<[u32; 2]> {
        let is_kept =
            |&[a, b]: &[u32; 2]| self.vertex(a).is_kept && self.vertex(b).is_kept && self.left(b, a).is_none();
        let mut edges: Vec<[u32; 2]> = faces.flat_map(sides).filter(is_kept).collect();
        edges.sort_unstable();
        edges
    }

    /// The Euler characteristic of the faces at some vertices.
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

    /// Whether a vertex may lie on the boundary after the edit: it did before, or it is new and lies on a feature.
    fn may_be_open(&self, v: u32) -> bool {
        if v >= NEW { !self.is_free(v) } else { Self::new(self.mesh).on_boundary(v) }
    }

    /// As [`Self::is_sound_without`], with no vertex dropped.
    pub(crate) fn is_sound(&self) -> bool {
        self.is_sound_without(&[])
    }
}

impl Change {
    /// Changes a mesh, and moves free vertices over the surface towards `targets`. Vertices have the ids of the
    /// edit.
    pub(crate) fn make(&self, mesh: &mut SurfaceMesh, surface: &Surface, targets: &[(u32, DVec3)]) {
        let (first_vertex, first_face) = (mesh.vertices().len() as u32, mesh.face_bound() as u32);
        let final_id = |id: u32, first: u32| if id >= NEW { id - NEW + first } else { id };
        for (vertex, like) in &self.vertices {
            mesh.add_vertex(*vertex, final_id(*like, first_vertex));
        }
        for (face, corners) in &self.faces {
            let corners: Vec<u32> = slice(corners).iter().map(|&v| final_id(v, first_vertex)).collect();
            mesh.set_face(final_id(*face, first_face), &corners);
        }
        for &(ends, curve) in &self.features {
            mesh.set_feature(ends.map(|v| final_id(v, first_vertex)), curve);
        }
        for &(v, target) in targets {
            let v = final_id(v, first_vertex);
            let vertex = mesh.vertex(v);
            if vertex.is_free() {
                let position = walked(surface, vertex.triangles[0], vertex.point, target);
                mesh.set_position(v, &position, surface);
            }
        }
    }
}

fn slice(corners: &Corners) -> &[u32] {
    match corners {
        [NONE, ..] => &[],
        [_, _, _, NONE] => &corners[..3],
        _ => corners,
    }
}
