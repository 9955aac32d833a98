//! A mesh whose faces can be replaced, a few at a time.

use super::Mesh;

/// A mesh under work: faces keep their ids while others around them are replaced, and every vertex knows its faces.
///
/// It holds topology and positions only; whoever replaces faces sees to it that the new ones fill the place of the old.
pub(super) struct Editor {
    points: Vec<[f64; 3]>,
    faces: Rows,
    around: Rows,
}

impl Editor {
    pub(super) fn new(mesh: &Mesh) -> Self {
        let faces = Rows::of(mesh.faces().map(<[u32]>::len), &mesh.corners);
        let mut valence = vec![0; mesh.points.len()];
        for &vertex in &mesh.corners {
            valence[vertex as usize] += 1;
        }
        let mut around = Rows::of(valence.iter().copied(), &vec![0; mesh.corners.len()]);
        around.clear();
        for (id, face) in (0..).zip(mesh.faces()) {
            for &vertex in face {
                around.push(vertex, id);
            }
        }
        Self { points: mesh.points.clone(), faces, around }
    }

    pub(super) fn point(&self, vertex: u32) -> [f64; 3] {
        self.points[vertex as usize]
    }

    pub(super) fn vertex_count(&self) -> usize {
        self.points.len()
    }

    /// One more than the largest face id.
    pub(super) fn face_count(&self) -> usize {
        self.faces.spans.len()
    }

    /// The vertices of a face in order; empty where the face is gone.
    pub(super) fn face(&self, face: u32) -> &[u32] {
        self.faces.get(face)
    }

    /// The faces at a vertex, in no geometric order.
    pub(super) fn around(&self, vertex: u32) -> &[u32] {
        self.around.get(vertex)
    }

    /// The vertices before and after `vertex` in a face that has it.
    pub(super) fn wings(&self, face: u32, vertex: u32) -> [u32; 2] {
        let corners = self.face(face);
        let place = corners.iter().position(|corner| *corner == vertex).expect("the face has the vertex");
        [corners[(place + corners.len() - 1) % corners.len()], corners[(place + 1) % corners.len()]]
    }

    /// The face that runs from `a` to `b`.
    pub(super) fn left(&self, a: u32, b: u32) -> Option<u32> {
        self.around(a).iter().copied().find(|face| self.wings(*face, a)[1] == b)
    }

    /// Whether an edge joins the two vertices.
    pub(super) fn joined(&self, a: u32, b: u32) -> bool {
        self.around(a).iter().any(|face| self.wings(*face, a).contains(&b))
    }

    /// Whether a face at the vertex has no face across one of its edges there.
    pub(super) fn on_boundary(&self, vertex: u32) -> bool {
        self.around(vertex).iter().any(|face| {
            let [before, after] = self.wings(*face, vertex);
            self.left(vertex, before).is_none() || self.left(after, vertex).is_none()
        })
    }

    /// Moves a vertex.
    pub(super) fn place(&mut self, vertex: u32, point: [f64; 3]) {
        self.points[vertex as usize] = point;
    }

    /// Adds a vertex, on no face yet.
    pub(super) fn add_vertex(&mut self, point: [f64; 3]) -> u32 {
        self.points.push(point);
        self.around.add();
        self.points.len() as u32 - 1
    }

    /// Gives a face other vertices, none where it is to go; a face that follows the last one is added.
    pub(super) fn set_face(&mut self, face: u32, corners: &[u32]) {
        if face as usize == self.face_count() {
            self.faces.add();
        }
        for &vertex in self.faces.get(face) {
            self.around.remove(vertex, face);
        }
        self.faces.set(face, corners);
        for &vertex in corners {
            self.around.push(vertex, face);
        }
    }

    /// Puts new faces in the place of at least as many old ones; they take over the first ids.
    pub(super) fn replace(&mut self, old: &[u32], new: &[Vec<u32>]) {
        debug_assert!(new.len() <= old.len());
        for &face in old {
            for &vertex in self.faces.get(face) {
                self.around.remove(vertex, face);
            }
            self.faces.set(face, &[]);
        }
        for (&face, corners) in old.iter().zip(new) {
            self.faces.set(face, corners);
            for &vertex in corners {
                self.around.push(vertex, face);
            }
        }
    }

    /// The mesh without the faces that are gone and the vertices that lie on none, and the old id of each vertex left.
    pub(super) fn finish(self) -> (Mesh, Vec<u32>) {
        let kept: Vec<u32> = (0..self.points.len() as u32).filter(|vertex| !self.around(*vertex).is_empty()).collect();
        let mut renamed = vec![u32::MAX; self.points.len()];
        for (new, &old) in (0..).zip(&kept) {
            renamed[old as usize] = new;
        }
        let mut mesh = Mesh::new(kept.iter().map(|vertex| self.point(*vertex)).collect());
        let mut corners = Vec::new();
        for face in (0..self.face_count() as u32).filter(|face| !self.face(*face).is_empty()) {
            corners.clear();
            corners.extend(self.face(face).iter().map(|vertex| renamed[*vertex as usize]));
            mesh.push_face(&corners);
        }
        (mesh, kept)
    }
}

/// Rows of ids in one buffer; a row that outgrows its room moves to the buffer's end.
struct Rows {
    ids: Vec<u32>,
    spans: Vec<Span>,
}

struct Span {
    start: usize,
    len: u32,
    room: u32,
}

impl Rows {
    fn of(lengths: impl Iterator<Item = usize>, ids: &[u32]) -> Self {
        let mut start = 0;
        let spans = lengths
            .map(|len| {
                start += len;
                Span { start: start - len, len: len as u32, room: len as u32 }
            })
            .collect();
        Self { ids: ids.to_vec(), spans }
    }

    /// Adds a row without ids.
    fn add(&mut self) {
        self.spans.push(Span { start: self.ids.len(), len: 0, room: 0 });
    }

    fn clear(&mut self) {
        for span in &mut self.spans {
            span.len = 0;
        }
    }

    fn get(&self, row: u32) -> &[u32] {
        let span = &self.spans[row as usize];
        &self.ids[span.start..span.start + span.len as usize]
    }

    fn set(&mut self, row: u32, ids: &[u32]) {
        let span = &mut self.spans[row as usize];
        if ids.len() > span.room as usize {
            span.start = self.ids.len();
            span.room = ids.len() as u32;
            self.ids.extend_from_slice(ids);
        } else {
            self.ids[span.start..span.start + ids.len()].copy_from_slice(ids);
        }
        span.len = ids.len() as u32;
    }

    fn push(&mut self, row: u32, id: u32) {
        let span = &mut self.spans[row as usize];
        if span.len == span.room {
            let old = span.start..span.start + span.len as usize;
            span.start = self.ids.len();
            span.room = 2 * span.room.max(2);
            self.ids.extend_from_within(old);
            self.ids.resize(span.start + span.room as usize, u32::MAX);
        }
        self.ids[span.start + span.len as usize] = id;
        span.len += 1;
    }

    fn remove(&mut self, row: u32, id: u32) {
        let span = &mut self.spans[row as usize];
        let ids = &mut self.ids[span.start..span.start + span.len as usize];
        if let Some(place) = ids.iter().position(|other| *other == id) {
            ids.copy_within(place + 1.., place);
            span.len -= 1;
        }
    }
}
