//! A few faces that are to be replaced by better ones with the same outline.

use super::{Anchors, CleanOptions};
use crate::mesh::Metric;
use crate::mesh::edit::Editor;
use crate::mesh::metric::laid;
use crate::mesh::quality::{quad_shape, triangle_shape};
use glam::{DVec3, Vec3};

/// What elements and edges are worth, in quads of perfect shape.
pub(super) struct Worth<'a> {
    pub(super) anchors: &'a Anchors,
    pub(super) options: &'a CleanOptions,
    pub(super) metric: Metric,
}

/// New faces for a patch.
pub(super) struct Change {
    pub(super) old: Vec<u32>,
    pub(super) new: Vec<Vec<u32>>,
    /// How much the mesh wins.
    pub(super) gain: f64,
}

impl Worth<'_> {
    /// Quads have their shape; a triangle is half an element, since two make a quad.
    fn face(&self, editor: &Editor, face: &[u32]) -> f64 {
        let frame = self.metric.frame(face);
        let point = |vertex| laid(frame.as_ref(), editor.point(vertex).into()).into();
        match *face {
            [a, b, c] => 0.5 * triangle_shape([a, b, c].map(point)) - self.options.triangle_price,
            [a, b, c, d] => quad_shape([a, b, c, d].map(point)),
            _ => 0.0,
        }
    }

    /// Nothing for an edge along the cross field, a loss for one aslant: `alignment` (1 - cos 4 angle) / 2.
    ///
    /// Crosses on features are rough, so they count only where both ends are on features.
    fn edge(&self, editor: &Editor, a: u32, b: u32) -> f64 {
        let frame = self.metric.frame(&[a, b]);
        let along = laid(frame.as_ref(), DVec3::from(editor.point(b)) - DVec3::from(editor.point(a)));
        let fixed = |vertex: u32| self.anchors.fixed[vertex as usize];
        let ends = [a, b].into_iter().filter(|end| !fixed(*end) || (fixed(a) && fixed(b)));
        let (mut loss, mut count) = (0.0, 0.0);
        for end in ends {
            let axis = Vec3::from(self.anchors.axes[end as usize]).as_dvec3();
            let normal = Vec3::from(self.anchors.normals[end as usize]).as_dvec3();
            let flat = (along - normal * along.dot(normal)).normalize_or_zero();
            let square = flat.dot(axis).powi(2);
            loss += 4.0 * square * (1.0 - square);
            count += 1.0;
        }
        -self.options.alignment * loss / count
    }

    pub(super) fn is_feature(&self, a: u32, b: u32) -> bool {
        self.anchors.feature_edges.binary_search(&[a.min(b), a.max(b)]).is_ok()
    }
}

/// Some faces of a mesh, in one piece without a hole.
pub(super) struct Patch<'a> {
    editor: &'a Editor,
    worth: &'a Worth<'a>,
    faces: &'a [u32],
    /// The outline, counter-clockwise.
    outline: Vec<u32>,
    /// For each vertex of the outline, the patch's area vector there. Faces beyond a feature have no say in it.
    normals: Vec<DVec3>,
    /// The edges between two of the faces.
    inner: Vec<[u32; 2]>,
    /// What the faces and inner edges are worth.
    value: f64,
}

impl<'a> Patch<'a> {
    /// `None` where an inner edge is a feature or the outline is not one simple loop.
    pub(super) fn of(editor: &'a Editor, worth: &'a Worth, faces: &'a [u32]) -> Option<Self> {
        let mut sides: Vec<[u32; 2]> = Vec::new();
        for &face in faces {
            let corners = editor.face(face);
            sides.extend(corners.iter().zip(corners.iter().cycle().skip(1)).map(|(a, b)| [*a, *b]));
        }
        let (mut inner, outer): (Vec<[u32; 2]>, Vec<[u32; 2]>) =
            sides.iter().copied().partition(|[a, b]| sides.contains(&[*b, *a]));
        inner.retain(|[a, b]| a < b);
        if inner.iter().any(|[a, b]| worth.is_feature(*a, *b)) {
            return None;
        }
        let mut outline = vec![outer.first()?[0]];
        loop {
            let mut next = outer.iter().filter(|side| side[0] == outline[outline.len() - 1]);
            let side = next.next()?;
            if next.next().is_some() {
                return None;
            }
            if side[1] == outline[0] {
                break;
            }
            if outline.len() == outer.len() {
                return None;
            }
            outline.push(side[1]);
        }
        if outline.len() != outer.len() {
            return None;
        }

        let mut normals = vec![DVec3::ZERO; outline.len()];
        let mut value: f64 = inner.iter().map(|[a, b]| worth.edge(editor, *a, *b)).sum();
        for &face in faces {
            let corners = editor.face(face);
            value += worth.face(editor, corners);
            let area = area_vector(editor, corners);
            for (normal, _) in normals.iter_mut().zip(&outline).filter(|(_, vertex)| corners.contains(vertex)) {
                *normal += area;
            }
        }
        Some(Self { editor, worth, faces, outline, normals, inner, value })
    }

    /// The best way to cut a patch without an inner vertex into quads alone, if it wins anything.
    ///
    /// Dynamic programming over the chords of the outline: what lies between the chord i-j and the outline is one quad
    /// i-k-l-j and what lies behind its three other sides.
    pub(super) fn into_quads(self) -> Option<Change> {
        let n = self.outline.len();
        let vertices: usize = self.faces.iter().map(|face| self.editor.face(*face).len().saturating_sub(2)).sum();
        if n % 2 == 1 || n != vertices + 2 {
            return None;
        }
        let mut best = vec![f64::NEG_INFINITY; n * n];
        let mut choice = vec![[0; 2]; n * n];
        for i in 0..n - 1 {
            best[i * n + i + 1] = 0.0;
        }
        for gap in (3..n).step_by(2) {
            for i in 0..n - gap {
                let j = i + gap;
                let chord = if gap == n - 1 { 0.0 } else { self.chord(i, j) };
                if chord == f64::NEG_INFINITY {
                    continue;
                }
                for k in (i + 1..j).step_by(2) {
                    for l in (k + 1..j).step_by(2) {
                        let behind = best[i * n + k] + best[k * n + l] + best[l * n + j];
                        if behind == f64::NEG_INFINITY {
                            continue;
                        }
                        let value = chord + behind + self.quad([i, k, l, j]);
                        if value > best[i * n + j] {
                            best[i * n + j] = value;
                            choice[i * n + j] = [k, l];
                        }
                    }
                }
            }
        }
        if best[n - 1] == f64::NEG_INFINITY {
            return None;
        }
        let mut new = Vec::new();
        let mut open = vec![[0, n - 1]];
        while let Some([i, j]) = open.pop() {
            if j - i > 1 {
                let [k, l] = choice[i * n + j];
                new.push([i, k, l, j].map(|place| self.outline[place]).to_vec());
                open.extend([[l, j], [k, l], [i, k]]);
            }
        }
        self.change(new, best[n - 1])
    }

    /// One face in the place of all, if it is a triangle or a quad and wins anything.
    pub(super) fn into_one(self) -> Option<Change> {
        let value = match self.outline.len() {
            3 => self.triangle(),
            4 => self.quad([0, 1, 2, 3]),
            _ => return None,
        };
        let new = vec![self.outline.clone()];
        self.change(new, value)
    }

    fn change(self, new: Vec<Vec<u32>>, value: f64) -> Option<Change> {
        // Gains below this are roundings of equal sums, and would let two states alternate.
        const LEAST_GAIN: f64 = 1e-9;
        let gain = value - self.value;
        let kept = gain > LEAST_GAIN && new.iter().all(|face| !self.repeats(face)) && self.keeps_valence(&new);
        kept.then(|| Change { old: self.faces.to_vec(), new, gain })
    }

    /// What a chord of the outline is worth as an edge: impossible where the two are joined outside the patch.
    fn chord(&self, i: usize, j: usize) -> f64 {
        let (a, b) = (self.outline[i], self.outline[j]);
        let inner = self.inner.contains(&[a.min(b), a.max(b)]);
        if !inner && self.editor.joined(a, b) { f64::NEG_INFINITY } else { self.worth.edge(self.editor, a, b) }
    }

    fn quad(&self, places: [usize; 4]) -> f64 {
        let vertices = places.map(|place| self.outline[place]);
        let [a, b, c, d] = vertices.map(|vertex| self.editor.point(vertex));
        let frame = self.worth.metric.frame(&vertices);
        let shape = quad_shape([a, b, c, d].map(|point| laid(frame.as_ref(), point.into()).into()));
        let normal = (DVec3::from(c) - DVec3::from(a)).cross(DVec3::from(d) - DVec3::from(b));
        if shape >= self.worth.options.least_shape && self.faces_up(&places, normal) {
            shape
        } else {
            f64::NEG_INFINITY
        }
    }

    fn triangle(&self) -> f64 {
        let normal = area_vector(self.editor, &self.outline);
        if self.faces_up(&[0, 1, 2], normal) { self.worth.face(self.editor, &self.outline) } else { f64::NEG_INFINITY }
    }

    fn faces_up(&self, places: &[usize], normal: DVec3) -> bool {
        places.iter().map(|place| self.normals[*place]).sum::<DVec3>().dot(normal) > 0.0
    }

    /// Whether a face outside the patch has the same vertices.
    fn repeats(&self, face: &[u32]) -> bool {
        self.editor.around(face[0]).iter().filter(|other| !self.faces.contains(other)).any(|other| {
            let corners = self.editor.face(*other);
            corners.len() == face.len() && corners.iter().all(|corner| face.contains(corner))
        })
    }

    /// Whether no interior vertex of the outline is left with two faces, which would share two edges.
    fn keeps_valence(&self, new: &[Vec<u32>]) -> bool {
        self.outline.iter().all(|vertex| {
            let around = self.editor.around(*vertex);
            let before = around.iter().filter(|face| self.faces.contains(face)).count();
            let after = new.iter().filter(|face| face.contains(vertex)).count();
            after >= before || around.len() - before + after > 2 || self.editor.on_boundary(*vertex)
        })
    }
}

/// Twice a face's vector area.
fn area_vector(editor: &Editor, corners: &[u32]) -> DVec3 {
    let point = |k: usize| DVec3::from(editor.point(corners[k]));
    (2..corners.len()).map(|k| (point(k - 1) - point(0)).cross(point(k) - point(0))).sum()
}
