//! Topological clean-up: fewer triangles, and no vertex of valence 2 or of valence 3 among triangles.
//!
//! # Theory
//!
//! The paper, section 3 and figure 5: four patterns are searched for and replaced, in the order (b), (c), (a), (d), over all
//! elements, two rounds.
//!
//! # Changes versus the paper
//!
//! The figure is not in the text we have, so the patterns are read from the text and from design section 8:
//! - (a) two triangles that share an edge become a quad;
//! - (b) triangle, quad, triangle in a row become two quads;
//! - (c) two triangles at one vertex with a quad between them, or two quads and so one edge, become quads;
//! - (d) a vertex whose faces leave an outline of three or four vertices goes, and one face takes their place: two quads that
//!   share two edges, three triangles, two triangles and a quad, four triangles.
//!
//! (a), (b) and (c) are one operation, for 0, 1 and 2 quads: the outline of two triangles and the quads between them is cut
//! into quads in the best way there is. Triangles further apart are [paired](super::pair) afterwards.
//!
//! An operation is made where the sum of what the elements are worth grows: a quad its shape (Qg), a triangle half its shape
//! (Tg) less a price, and an edge aslant to the cross field costs.
//!
//! # Practice
//!
//! Positions do not change, so a change that smoothing would have made good is judged as it is; `triangle_price` is the loss
//! of shape that one triangle less may cost.

mod patch;

use super::edit::Editor;
use super::{Mesh, Metric};
use patch::{Change, Patch, Worth};
use serde::Serialize;

/// What the clean-up must respect and follow; one entry a vertex, except where it says otherwise.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Anchors {
    /// Edges on features, the smaller id first, sorted. They stay. Boundary edges stay without being named.
    pub feature_edges: Vec<[u32; 2]>,
    /// Whether the vertex lies on a feature and may not vanish.
    pub fixed: Vec<bool>,
    /// Unit surface normals; rough on features.
    pub normals: Vec<[f32; 3]>,
    /// One unit tangent direction of the cross; rough on features.
    pub axes: Vec<[f32; 3]>,
    /// The wanted side of a tile along that direction over its mean side; empty where tiles are squares.
    pub factors: Vec<f32>,
}

impl Anchors {
    /// Those of some of the vertices, in ascending order.
    pub fn of(&self, kept: &[u32]) -> Self {
        let number = |v: u32| kept.binary_search(&v).ok().map(|place| place as u32);
        Self {
            feature_edges: self.feature_edges.iter().filter_map(|&[a, b]| Some([number(a)?, number(b)?])).collect(),
            fixed: kept.iter().map(|&v| self.fixed[v as usize]).collect(),
            normals: kept.iter().map(|&v| self.normals[v as usize]).collect(),
            axes: kept.iter().map(|&v| self.axes[v as usize]).collect(),
            factors: kept.iter().filter_map(|&v| self.factors.get(v as usize).copied()).collect(),
        }
    }
}

/// How [`clean`] works.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CleanOptions {
    /// Rounds over all patterns. Default 2, as in the paper; 0 leaves the mesh as it is.
    pub rounds: usize,
    /// How much of the sum of shapes one triangle less may cost, in perfect quads. Default 0.25; 0 asks for better shape.
    pub triangle_price: f64,
    /// What an edge at 45 degrees to the cross costs, in perfect quads. Default 0.25; 0 ignores the field.
    pub alignment: f64,
    /// No new quad has a smaller shape (Qg). Default 0.3; 0 still refuses flipped quads.
    pub least_shape: f64,
}

impl Default for CleanOptions {
    fn default() -> Self {
        Self { rounds: 2, triangle_price: 0.25, alignment: 0.25, least_shape: 0.3 }
    }
}

/// What [`clean`] did.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct CleanCounts {
    /// (a): two triangles made one quad.
    pub merged: usize,
    /// (b): triangle, quad, triangle made two quads.
    pub rows: usize,
    /// (c): two triangles at a vertex and what lay between them made quads.
    pub turns: usize,
    /// (d): vertices taken out.
    pub removed: usize,
    /// Triangles before.
    pub triangles_before: usize,
    /// Triangles after.
    pub triangles_after: usize,
    /// For each vertex of the new mesh, its id in the old one. Vertices that lie on no face are dropped.
    #[serde(skip)]
    pub kept: Vec<u32>,
}

/// Replaces triangles by quads where that is worth it; positions stay.
///
/// Elements are visited in the order of their ids, so the same mesh gives the same result.
///
/// # Panics
///
/// Where `anchors` has not one entry a vertex, or a face names a vertex that is not there.
pub fn clean(mesh: &Mesh, anchors: &Anchors, options: &CleanOptions) -> (Mesh, CleanCounts) {
    let vertices = [anchors.fixed.len(), anchors.normals.len(), anchors.axes.len()];
    assert_eq!(vertices, [mesh.points.len(); 3], "anchors need one entry a vertex");
    let mut cleaner =
        Cleaner { editor: Editor::new(mesh), worth: Worth { anchors, options, metric: Metric::new(anchors) } };
    let mut counts = CleanCounts { triangles_before: cleaner.triangles().count(), ..CleanCounts::default() };
    for _ in 0..options.rounds {
        counts.rows += cleaner.over_faces(Cleaner::row);
        counts.turns += cleaner.over_faces(Cleaner::turn);
        counts.merged += cleaner.over_faces(Cleaner::merge);
        counts.removed += cleaner.remove_vertices();
    }
    counts.triangles_after = cleaner.triangles().count();
    let (mesh, kept) = cleaner.editor.finish();
    (mesh, CleanCounts { kept, ..counts })
}

struct Cleaner<'a> {
    editor: Editor,
    worth: Worth<'a>,
}

impl Cleaner<'_> {
    fn triangles(&self) -> impl Iterator<Item = u32> {
        (0..self.editor.face_count() as u32).filter(|face| self.is_triangle(*face))
    }

    fn is_triangle(&self, face: u32) -> bool {
        self.editor.face(face).len() == 3
    }

    fn is_quad(&self, face: u32) -> bool {
        self.editor.face(face).len() == 4
    }

    /// The face across the `k`-th side, unless that is a feature.
    fn across(&self, face: u32, k: usize) -> Option<u32> {
        let corners = self.editor.face(face);
        let (a, b) = (corners[k], corners[(k + 1) % corners.len()]);
        self.editor.left(b, a).filter(|_| !self.worth.is_feature(a, b))
    }

    fn apply(&mut self, change: Option<Change>) -> bool {
        if let Some(change) = &change {
            self.editor.replace(&change.old, &change.new);
        }
        change.is_some()
    }

    /// Makes the best change at each face, and counts them.
    fn over_faces(&mut self, best: impl Fn(&Self, u32) -> Option<Change>) -> usize {
        (0..self.editor.face_count() as u32)
            .filter(|face| {
                let change = best(self, *face);
                self.apply(change)
            })
            .count()
    }

    /// The best change of some rows of faces that begin and end with a triangle.
    fn best(&self, rows: impl Iterator<Item = Vec<u32>>) -> Option<Change> {
        rows.filter_map(|row| Patch::of(&self.editor, &self.worth, &row).and_then(Patch::into_quads))
            .reduce(|best, other| if other.gain > best.gain { other } else { best })
    }

    /// (a): the triangle and one beside it.
    fn merge(&self, face: u32) -> Option<Change> {
        if !self.is_triangle(face) {
            return None;
        }
        let beside = (0..3).filter_map(|k| self.across(face, k)).filter(|other| self.is_triangle(*other));
        self.best(beside.map(|other| vec![face, other]))
    }

    /// (b): the quad and two triangles on opposite sides.
    fn row(&self, face: u32) -> Option<Change> {
        if !self.is_quad(face) {
            return None;
        }
        let triangle = |k| self.across(face, k).filter(|other| self.is_triangle(*other));
        self.best((0..2).filter_map(|k| Some(vec![triangle(k)?, face, triangle(k + 2)?])))
    }

    /// (c): the triangle, one or two quads beside it at one of its vertices, and another triangle there.
    fn turn(&self, face: u32) -> Option<Change> {
        if !self.is_triangle(face) {
            return None;
        }
        let fans = (0..3).flat_map(|k| [(k, 0), (k, 1)]).filter_map(|(k, wing)| {
            let vertex = self.editor.face(face)[k];
            let mut fan = vec![face];
            for _ in 0..3 {
                let next = self.beside(fan[fan.len() - 1], vertex, wing)?;
                fan.push(next);
                if self.is_triangle(next) {
                    return (fan.len() > 2 && next != face).then_some(fan);
                }
                if !self.is_quad(next) {
                    return None;
                }
            }
            None
        });
        self.best(fans)
    }

    /// The next face round a vertex: counter-clockwise for wing 0, clockwise for wing 1.
    fn beside(&self, face: u32, vertex: u32, wing: usize) -> Option<u32> {
        let spoke = self.editor.wings(face, vertex)[wing];
        let next = if wing == 0 { self.editor.left(vertex, spoke) } else { self.editor.left(spoke, vertex) };
        next.filter(|_| !self.worth.is_feature(vertex, spoke))
    }

    /// (d): over all vertices; returns how many went.
    fn remove_vertices(&mut self) -> usize {
        (0..self.editor.vertex_count() as u32)
            .filter(|vertex| {
                let star = self.editor.around(*vertex).to_vec();
                let sides: usize = star.iter().map(|face| self.editor.face(*face).len().saturating_sub(2)).sum();
                let small = (2..=4).contains(&star.len()) && sides <= 4;
                if !small || self.worth.anchors.fixed[*vertex as usize] || self.editor.on_boundary(*vertex) {
                    return false;
                }
                let change = Patch::of(&self.editor, &self.worth, &star).and_then(Patch::into_one);
                self.apply(change)
            })
            .count()
    }
}
