//! A polygon mesh on a surface: each vertex has a place on the surface, which says how it may move.
//!
//! # Theory
//! A vertex is free on a triangle of the surface, lies on a feature curve at an arc length, or is a corner. The sampling of the
//! features gives the places, and each later step keeps them.
//!
//! # Practice
//! Edits keep the ids of the faces and vertices that they do not change. [`SurfaceMesh::compacted`] alone renumbers them; call
//! it once, after the last edit.

use super::incidence::{Rows, neighbours_in, undirected};
use super::vertex::{Place, Position, REGULAR, Vertex};
use super::{Mesh, Metric};
use crate::surface::{NONE, Surface};
use glam::DVec3;
use rustc_hash::FxHashMap;

/// A polygon mesh on a surface, with the faces at each vertex and the metric of its shapes.
#[derive(Clone, Debug, Default)]
pub struct SurfaceMesh {
    vertices: Vec<Vertex>,
    faces: Rows,
    around: Rows,
    /// The curve of each edge on a feature, the smaller end first. Boundary edges are among them.
    features: FxHashMap<[u32; 2], u32>,
    metric: Metric,
}

impl SurfaceMesh {
    /// A mesh of these faces. `features` gives the curve of each edge on a feature, the smaller end first; `metric` is the metric
    /// of shapes.
    pub(crate) fn new(
        vertices: Vec<Vertex>,
        faces: &[Vec<u32>],
        features: FxHashMap<[u32; 2], u32>,
        metric: Metric,
    ) -> Self {
        let rows = faces.iter().map(Vec::as_slice);
        let around = Rows::transposed(rows, vertices.len());
        let faces = Rows::new(faces.iter().map(Vec::len), faces.concat());
        let mut mesh = Self { vertices, faces, around, features, metric };
        for v in 0..mesh.vertices.len() as u32 {
            if !mesh.vertices[v as usize].is_free() {
                mesh.vertices[v as usize].valence = mesh.wanted_valence(v);
            }
        }
        mesh
    }

    /// The same mesh whose vertices have these tangent directions of the cross, of any length but 0, one for each vertex.
    pub fn with_axes(mut self, axes: &[[f64; 3]]) -> Self {
        for (vertex, &axis) in self.vertices.iter_mut().zip(axes) {
            let axis = DVec3::from(axis);
            vertex.axis = (axis - vertex.normal * vertex.normal.dot(axis)).try_normalize().unwrap_or(vertex.axis);
        }
        self
    }

    /// The vertices, those that no face has included.
    pub fn vertices(&self) -> &[Vertex] {
        &self.vertices
    }

    /// A vertex.
    pub fn vertex(&self, v: u32) -> &Vertex {
        &self.vertices[v as usize]
    }

    /// The coordinates of a vertex, unit-sized.
    pub(crate) fn point(&self, v: u32) -> DVec3 {
        self.vertices[v as usize].point
    }

    /// One more than the largest face id.
    pub(crate) fn face_bound(&self) -> usize {
        self.faces.count()
    }

    /// The vertices of a face in order; empty where the face is removed.
    pub(crate) fn face(&self, face: u32) -> &[u32] {
        self.faces.get(face)
    }

    /// The faces that are not removed.
    pub fn faces(&self) -> impl Iterator<Item = &[u32]> + Clone {
        self.faces.iter().filter(|face| !face.is_empty())
    }

    /// The faces at a vertex, in no geometric order.
    pub(crate) fn around(&self, v: u32) -> &[u32] {
        self.around.get(v)
    }

    /// The metric in which shapes are measured.
    pub(crate) fn metric(&self) -> &Metric {
        &self.metric
    }

    /// The face to the left of the edge from `a` to `b`.
    pub(crate) fn left(&self, a: u32, b: u32) -> Option<u32> {
        self.around(a).iter().copied().find(|&face| neighbours_in(self.face(face), a)[1] == b)
    }

    /// The curve of an edge on a feature.
    pub(crate) fn curve(&self, edge: [u32; 2]) -> Option<u32> {
        let on = |v: u32| self.vertices.get(v as usize).is_some_and(|vertex| !vertex.is_free());
        if edge.iter().all(|&v| on(v)) { self.features.get(&undirected(edge)).copied() } else { None }
    }

    /// Frees the vertices of some faces from the curves inside the surface that they lie on. True: there were some.
    pub(crate) fn free_from_curves(&mut self, surface: &Surface, faces: &[u32]) -> bool {
        let is_inner = |curve: u32| {
            surface.features().curves()[curve as usize].half_edges.iter().all(|&h| surface.twin(h).is_some())
        };
        let mut any = false;
        let corners: Vec<u32> = faces.iter().flat_map(|&face| self.face(face)).copied().collect();
        for v in corners {
            let vertex = &mut self.vertices[v as usize];
            if let Place::OnCurve { curve, .. } = vertex.place
                && is_inner(curve)
            {
                *vertex = Vertex {
                    place: Place::Free,
                    triangles: [vertex.triangles[0]; 2],
                    normal: surface.normal(vertex.triangles[0] as usize).as_dvec3(),
                    valence: REGULAR,
                    ..*vertex
                };
                any = true;
            }
        }
        any
    }

    /// The neighbours of a vertex along a feature curve.
    pub(crate) fn along(&self, v: u32, curve: u32) -> impl Iterator<Item = u32> {
        let ends = self.around(v).iter().flat_map(move |&face| neighbours_in(self.face(face), v));
        let mut seen = [NONE; 2];
        ends.filter(move |&w| {
            let is_new = !seen.contains(&w) && self.curve([v, w]) == Some(curve);
            if is_new {
                seen = [w, seen[0]];
            }
            is_new
        })
    }

    /// Adds a vertex without faces; it takes the metric of the vertex `like`.
    pub(crate) fn add_vertex(&mut self, vertex: Vertex, like: u32) -> u32 {
        self.vertices.push(vertex);
        self.around.add();
        self.metric.copy(like);
        self.vertices.len() as u32 - 1
    }

    /// Moves a vertex.
    pub(crate) fn set_position(&mut self, v: u32, position: &Position, surface: &Surface) {
        let vertex = &mut self.vertices[v as usize];
        (vertex.point, vertex.place, vertex.triangles) = (position.point, position.place, position.triangles);
        if vertex.is_free() {
            vertex.normal = surface.normal(position.triangles[0] as usize).as_dvec3();
        }
    }

    /// Replaces the vertices of a face; no vertices remove the face, and the id after the last one adds a face.
    pub(crate) fn set_face(&mut self, face: u32, corners: &[u32]) {
        if face as usize == self.face_bound() {
            self.faces.add();
        }
        for &v in self.faces.get(face) {
            self.around.remove(v, face);
        }
        self.faces.set(face, corners);
        for &v in corners {
            self.around.push(v, face);
        }
    }

    /// Sets the feature curve of an edge; `None`: it lies on no feature.
    pub(crate) fn set_feature(&mut self, edge: [u32; 2], curve: Option<u32>) {
        match curve {
            Some(curve) => self.features.insert(undirected(edge), curve),
            None => self.features.remove(&undirected(edge)),
        };
    }

    /// The wanted valence of a vertex on a feature: one face for each right angle between two feature edges.
    fn wanted_valence(&self, v: u32) -> u8 {
        let is_barrier = |a: u32, b: u32| self.left(b, a).is_none() || self.curve([a, b]).is_some();
        let mut total = 0;
        for &start in self.around(v) {
            if !is_barrier(v, neighbours_in(self.face(start), v)[1]) {
                continue;
            }
            let (mut face, mut angle) = (start, 0.0);
            for _ in 0..=self.around(v).len() {
                let [before, after] = neighbours_in(self.face(face), v);
                let here = self.point(v);
                angle += (self.point(before) - here).angle_between(self.point(after) - here);
                if is_barrier(before, v) {
                    break;
                }
                let Some(next) = self.left(v, before) else { break };
                face = next;
            }
            total += (angle / std::f64::consts::FRAC_PI_2).round().max(1.0) as u8;
        }
        if total == 0 { self.around(v).len() as u8 } else { total }
    }

    /// The same mesh without removed faces and without vertices that no face has; the order stays.
    pub fn compacted(&self) -> Self {
        let kept: Vec<u32> = (0..self.vertices.len() as u32).filter(|&v| !self.around(v).is_empty()).collect();
        let mut number = vec![NONE; self.vertices.len()];
        (0..).zip(&kept).for_each(|(new, &old)| number[old as usize] = new);
        let faces: Vec<Vec<u32>> =
            self.faces().map(|face| face.iter().map(|&v| number[v as usize]).collect()).collect();
        let features = self.features.iter().map(|(ends, &curve)| (ends.map(|v| number[v as usize]), curve));
        let around = Rows::transposed(faces.iter().map(Vec::as_slice), kept.len());
        Self {
            vertices: kept.iter().map(|&v| self.vertices[v as usize]).collect(),
            around,
            features: features.filter(|(ends, _)| !ends.contains(&NONE)).collect(),
            metric: self.metric.of(&kept),
            faces: Rows::new(faces.iter().map(Vec::len), faces.concat()),
        }
    }

    /// The faces and the unit-sized coordinates. Compact the mesh first: then every vertex has a face.
    pub fn to_mesh(&self) -> Mesh {
        let mut mesh = Mesh::new(self.vertices.iter().map(|vertex| vertex.point.to_array()).collect());
        self.faces().for_each(|face| mesh.push_face(face));
        mesh
    }

    /// The mean length of the sides that begin at a vertex.
    pub(crate) fn mean_edge_at(&self, v: u32) -> f64 {
        let faces = self.around(v);
        let lengths = faces.iter().map(|&f| self.point(v).distance(self.point(neighbours_in(self.face(f), v)[1])));
        lengths.sum::<f64>() / faces.len().max(1) as f64
    }
}
