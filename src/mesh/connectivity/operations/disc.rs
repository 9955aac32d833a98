//! Discs of faces whose outline has convex corners alone, and that grow about a vertex.
//!
//! # Theory
//! A convex corner of the outline has one face inside, another vertex of it has two. A vertex on a curve all of whose faces on that
//! side are inside counts as one with two, as it wants to be. A disc grows by a ring of faces; then, at each vertex with more faces
//! inside, the faces that are missing join it. It does not cross features.

use super::super::edit::Edit;
use crate::mesh::incidence::sides;
use crate::mesh::vertex::Place;
use rustc_hash::{FxHashMap, FxHashSet};

/// The most faces of a disc.
const MOST_FACES: usize = 120;

/// A disc of faces with convex corners alone.
pub(super) struct Disc {
    pub faces: Vec<u32>,
    /// The vertices of its rim, counter-clockwise from a corner on.
    pub outline: Vec<u32>,
    /// The numbers of edges of its sides.
    pub lengths: Vec<usize>,
    /// The other vertices.
    pub inner: Vec<u32>,
    /// The number of its irregular vertices and triangles.
    pub irregular: usize,
}

/// Faces that grow to discs.
pub(super) struct Growing<'a> {
    edit: &'a Edit<'a>,
    faces: Vec<u32>,
    is_inside: FxHashSet<u32>,
    /// The number of its faces at each vertex.
    at: FxHashMap<u32, usize>,
    /// The vertices on the rim of the last disc.
    rim: Vec<u32>,
}

impl<'a> Growing<'a> {
    pub fn at(edit: &'a Edit<'a>, v: u32) -> Self {
        Self { edit, faces: Vec::new(), is_inside: FxHashSet::default(), at: FxHashMap::default(), rim: vec![v] }
    }

    /// Adds the faces at the vertices of the rim, and those that make it convex; `false` where no larger disc is found.
    pub fn grow(&mut self) -> bool {
        let before = self.faces.len();
        let mut waiting = std::mem::take(&mut self.rim);
        for v in waiting.clone() {
            let first = if before == 0 { self.edit.around(v).next() } else { self.inside(v) };
            if let Some(first) = first {
                let sector = self.sector(v, first);
                self.add(&sector, &mut waiting);
            }
        }
        while let Some(v) = waiting.pop() {
            let Some(first) = self.inside(v) else { continue };
            let sector = self.sector(v, first);
            let inside = sector.iter().filter(|face| self.is_inside.contains(face)).count();
            let is_whole = inside == sector.len();
            // The other faces inside are on another side of a feature.
            let is_pinched = inside < self.at[&v];
            if is_pinched || self.faces.len() > MOST_FACES || (is_whole && inside > 2 && self.is_fixed(v)) {
                return false;
            }
            let is_beside = inside < 2 || (inside == 2 && self.edit.is_free(v) && self.are_beside(v, &sector));
            if !is_whole && !is_beside {
                self.add(&sector, &mut waiting);
            }
        }
        self.rim = self.at.keys().copied().filter(|&v| self.on_rim(v)).collect();
        self.rim.sort_unstable();
        self.faces.len() > before
    }

    /// Whether a vertex is a corner of features. It keeps its faces, as a right angle may want one, two or three.
    fn is_fixed(&self, v: u32) -> bool {
        self.edit.vertex(v).place == Place::Corner
    }

    /// Whether a vertex of the rim wants two faces inside: all faces on its side of a curve are inside, or two of those of others.
    fn is_straight(&self, v: u32) -> bool {
        let is_whole = || self.inside(v).is_some_and(|first| self.sector(v, first).len() == self.at[&v]);
        let on_curve = !self.edit.is_free(v) && !self.is_fixed(v);
        (on_curve && is_whole()) || self.at[&v] == 2
    }

    /// A face inside at a vertex.
    fn inside(&self, v: u32) -> Option<u32> {
        self.edit.around(v).find(|face| self.is_inside.contains(face))
    }

    fn on_rim(&self, v: u32) -> bool {
        !self.edit.is_free(v) || self.at[&v] < self.edit.valence(v)
    }

    /// The faces at a vertex that are on the same side of features as one of them.
    fn sector(&self, v: u32, first: u32) -> Vec<u32> {
        let mut sector = vec![first];
        for direction in 0..2 {
            let mut face = first;
            loop {
                let beside = self.edit.beside(face, v)[direction];
                let [a, b] = if direction == 0 { [beside, v] } else { [v, beside] };
                match self.edit.across(a, b) {
                    Some(next) if !sector.contains(&next) => face = next,
                    _ => break,
                }
                sector.push(face);
            }
        }
        sector
    }

    /// Whether the two faces of a sector that are inside share an edge at the vertex.
    fn are_beside(&self, v: u32, sector: &[u32]) -> bool {
        let mut inside =
            sector.iter().filter(|face| self.is_inside.contains(face)).map(|&face| self.edit.beside(face, v));
        let (Some([a, b]), Some([c, d])) = (inside.next(), inside.next()) else { return false };
        a == d || b == c
    }

    fn add(&mut self, faces: &[u32], changed: &mut Vec<u32>) {
        for &face in faces {
            if self.is_inside.insert(face) {
                self.faces.push(face);
                for &v in self.edit.face(face) {
                    *self.at.entry(v).or_insert(0) += 1;
                    changed.push(v);
                }
            }
        }
    }

    /// The number of irregular vertices and triangles of the faces.
    fn irregular(&self) -> usize {
        let is_counted = |v: u32| match self.on_rim(v) {
            true => self.at[&v] != 2 && self.is_straight(v),
            false => is_irregular(self.edit, v),
        };
        let triangles = self.faces.iter().filter(|face| self.edit.face(**face).len() == 3).count();
        triangles + self.at.keys().filter(|v| is_counted(**v)).count()
    }

    /// The disc, where it is one with several irregular vertices or triangles, and with no feature inside.
    pub fn disc(&self) -> Option<Disc> {
        let edit = self.edit;
        let irregular = self.irregular();
        if irregular < 2 {
            return None;
        }
        let mut next: FxHashMap<u32, u32> = FxHashMap::default();
        for &face in &self.faces {
            if !(3..=4).contains(&edit.face(face).len()) {
                return None;
            }
            for [a, b] in sides(edit.face(face)) {
                if !edit.left(b, a).is_some_and(|other| self.is_inside.contains(&other)) {
                    // A vertex where the rim touches itself has two.
                    if next.insert(a, b).is_some() {
                        return None;
                    }
                } else if edit.curve([a, b]).is_some() {
                    return None;
                }
            }
        }
        let edges = (self.faces.iter().map(|&face| edit.face(face).len()).sum::<usize>() + next.len()) / 2;
        let is_convex = next.keys().all(|&v| self.at[&v] == 1 || self.is_straight(v));
        if !is_convex || self.at.len() + self.faces.len() != edges + 1 {
            return None;
        }
        let first = next.keys().copied().filter(|&v| !self.is_straight(v)).min()?;
        let mut outline = vec![first];
        while let Some(&v) = next.get(&outline[outline.len() - 1]).filter(|v| **v != first) {
            outline.push(v);
            if outline.len() > next.len() {
                return None;
            }
        }
        let mut inner: Vec<u32> = self.at.keys().copied().filter(|v| !next.contains_key(v)).collect();
        inner.sort_unstable();
        let is_whole = outline.len() == next.len() && inner.iter().all(|&v| edit.is_free(v));
        let corners: Vec<usize> = (0..outline.len()).filter(|&k| !self.is_straight(outline[k])).collect();
        let ends = corners.iter().skip(1).copied().chain([outline.len()]);
        let lengths: Vec<usize> = corners.iter().zip(ends).map(|(begin, end)| end - begin).collect();
        is_whole.then(|| Disc { faces: self.faces.clone(), outline, lengths, inner, irregular })
    }
}

/// Whether a vertex off features has another number of faces than it wants.
pub(super) fn is_irregular(edit: &Edit, v: u32) -> bool {
    edit.is_free(v) && edit.irregularity(v, 0) > 0.0
}
