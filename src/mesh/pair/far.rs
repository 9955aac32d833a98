//! All quads: the triangles that are left walk however far, one step at a time, and cross features where they must.

use super::draft::Draft;
use super::settle::{Settled, settle};
use super::step::{Step, meet, steps};
use super::{Change, Work};
use crate::surface::nearest::nearest_on_segment;
use glam::DVec3;
use rustc_hash::{FxHashMap, FxHashSet};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// What it costs to cross a feature, in steps: that takes a new vertex on it.
const CROSSING: u32 = 40;
/// What it costs to leave over an open boundary: no triangle does while there is another to meet.
const LEAVING: u32 = 1_000_000;
/// Passes over the triangles: one whose way was barred may find it open.
const PASSES: usize = 3;
/// No quad becomes worse than this shape.
const LEAST: f64 = 0.1;
/// Steps that a triangle may take beside twice the length of its way.
const DETOUR: usize = 20;
/// Outside the mesh.
const OUTSIDE: u32 = u32::MAX;

/// A side of a face and the face beyond.
type Passage = ([u32; 2], u32);

impl Work<'_> {
    /// Pairs the triangles; returns how many vertices that took on open boundaries and on other features.
    pub(super) fn pair_all(&mut self) -> [usize; 2] {
        let mut added = [0; 2];
        for _ in 0..PASSES {
            for triangle in self.triangles() {
                self.walk_off(triangle, &mut added);
            }
        }
        added
    }

    /// Walks a triangle until it is no more, or can go no further.
    fn walk_off(&mut self, mut triangle: u32, added: &mut [usize; 2]) {
        // Faces that the triangle could not step to.
        let mut barred: FxHashSet<u32> = FxHashSet::default();
        let mut left = None;
        while self.scene.editor.face(triangle).len() == 3 {
            let Some(way) = self.way(triangle, &barred) else { return };
            // A detour about what is barred is fine, wandering is not.
            let left = left.get_or_insert(2 * way.len() + DETOUR);
            if *left == 0 {
                return;
            }
            *left -= 1;
            match self.walk_on(triangle, &way, added) {
                Some(Some(after)) => triangle = after,
                Some(None) => return,
                None => {
                    barred.insert(way[0].1);
                }
            }
        }
    }

    /// One step of a triangle along a way; `None` where it cannot be made, and where it is no more, no triangle.
    fn walk_on(&mut self, triangle: u32, way: &[Passage], added: &mut [usize; 2]) -> Option<Option<u32>> {
        let ([x, y], next) = way[0];
        if next == OUTSIDE || self.scene.is_feature(x, y) {
            let place = self.on_feature(x, y);
            let drafts = crossings(&Draft::new(&self.scene), triangle, [x, y], next, place);
            let (change, settled, after) = self.best_of(drafts)?;
            let middle = self.scene.editor.vertex_count() as u32;
            self.apply(&change, &settled.places);
            self.scene.editor.place(middle, place.into());
            self.scene.ideal[middle as usize] = if next == OUTSIDE { 2 } else { 4 };
            self.scene.features.remove(&[x.min(y), x.max(y)]);
            self.scene.features.extend([x, y].map(|end| [end, middle]));
            added[usize::from(next != OUTSIDE)] += 1;
            return Some(after);
        }
        let draft = Draft::new(&self.scene);
        let corners = draft.face(triangle);
        let side = (0..3).find(|&k| corners[k] == x)?;
        let Some((onward, _)) = way.get(1) else {
            let (change, settled, _) = self.best_of(vec![(meet(&draft, triangle, side, next).1, None)])?;
            self.apply(&change, &settled.places);
            return Some(None);
        };
        // Cuts that leave the triangle beside the next face of the way, or else any.
        let (onward, other): (Vec<Step>, Vec<Step>) =
            steps(&draft, triangle, side, next).partition(|step| onward.iter().all(|v| step.key().contains(v)));
        let taken = |steps: Vec<Step>| steps.iter().map(|step| step.take(&draft)).map(|(d, t)| (d, Some(t))).collect();
        let (change, settled, after) = self.best_of(taken(onward)).or_else(|| self.best_of(taken(other)))?;
        self.apply(&change, &settled.places);
        Some(after)
    }

    /// The cheapest way from a triangle to another, or out, through no barred face: Dijkstra's algorithm.
    fn way(&self, triangle: u32, barred: &FxHashSet<u32>) -> Option<Vec<Passage>> {
        let draft = Draft::new(&self.scene);
        let mut from: FxHashMap<u32, (u32, [u32; 2])> = FxHashMap::default();
        let mut done: FxHashSet<u32> = FxHashSet::default();
        let mut heap = BinaryHeap::from([Reverse((0, triangle, triangle, [0; 2]))]);
        while let Some(Reverse((cost, face, before, side))) = heap.pop() {
            if !done.insert(face) {
                continue;
            }
            from.insert(face, (before, side));
            let corners = if face == OUTSIDE { &[] } else { draft.face(face) };
            if face == OUTSIDE || (face != triangle && corners.len() == 3) {
                let mut way = Vec::new();
                let mut at = face;
                while at != triangle {
                    let (before, side) = from[&at];
                    way.push((side, at));
                    at = before;
                }
                way.reverse();
                return Some(way);
            }
            for k in 0..corners.len() {
                let side = [corners[k], corners[(k + 1) % corners.len()]];
                let next = draft.left(side[1], side[0]);
                let price = match next {
                    None => LEAVING,
                    Some(_) if self.scene.is_feature(side[0], side[1]) => CROSSING,
                    Some(_) => 1,
                };
                if !barred.contains(&next.unwrap_or(OUTSIDE)) && next.is_none_or(|next| draft.face(next).len() <= 4) {
                    heap.push(Reverse((cost + price, next.unwrap_or(OUTSIDE), face, side)));
                }
            }
        }
        None
    }

    /// The draft that loses least of shape.
    fn best_of(&self, drafts: Vec<(Draft, Option<u32>)>) -> Option<(Change, Settled, Option<u32>)> {
        drafts
            .into_iter()
            .filter(|(draft, _)| draft.is_sound())
            .filter_map(|(draft, after)| {
                let settled = settle(&draft, self.options.triangle_price, LEAST)?;
                Some((Change::of(&draft), settled, after))
            })
            .reduce(|best, other| if other.1.gain > best.1.gain { other } else { best })
    }

    /// The point of a feature of the surface nearest to the middle of two vertices.
    fn on_feature(&self, x: u32, y: u32) -> DVec3 {
        let [x, y] = [x, y].map(|v| DVec3::from(self.scene.editor.point(v)));
        let middle = (x + y) / 2.0;
        let surface = self.surface;
        (0..3 * surface.triangle_count() as u32)
            .filter(|&h| surface.features().is_feature(h))
            .map(|h| {
                let [a, b] = [surface.origin(h), surface.target(h)].map(|v| DVec3::from(surface.point(v)));
                nearest_on_segment(middle, a, b)
            })
            .min_by(|p, q| p.distance_squared(middle).total_cmp(&q.distance_squared(middle)))
            .unwrap_or(middle)
    }
}

/// The ways to make a triangle a quad by a vertex on its side from `x` to `y`: the face beyond has a side more then, and
/// is cut into a quad and a triangle, whose id comes with the draft.
fn crossings<'a>(
    draft: &Draft<'a>,
    triangle: u32,
    [x, y]: [u32; 2],
    next: u32,
    place: DVec3,
) -> Vec<(Draft<'a>, Option<u32>)> {
    let mut crossed = draft.clone();
    let middle = crossed.copy(x);
    crossed.place(middle, place);
    let apex = draft.face(triangle).iter().find(|v| ![x, y].contains(v)).copied();
    crossed.set_face(triangle, &[x, middle, y, apex.expect("a triangle has three corners")]);
    if next == OUTSIDE {
        return vec![(crossed, None)];
    }
    let beyond = draft.face(next);
    let at = beyond.iter().position(|&v| v == y).expect("the face has the side");
    let corner = |k: usize| beyond[(at + k) % beyond.len()];
    if beyond.len() == 3 {
        crossed.set_face(next, &[y, middle, x, corner(2)]);
        return vec![(crossed, None)];
    }
    let (u, v) = (corner(2), corner(3));
    [([middle, x, u], [middle, u, v, y]), ([v, y, middle], [middle, x, u, v])]
        .into_iter()
        .map(|(triangle, quad)| {
            let mut cut = crossed.clone();
            cut.set_face(next, &triangle);
            cut.add_face(&quad);
            (cut, Some(next))
        })
        .collect()
}
