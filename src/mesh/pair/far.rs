//! All quads: the triangles that are left walk however far, one step at a time, and cross features where they must.

use super::draft::Draft;
use super::rows::{self, Landing, Within};
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
/// What shape quads must keep in each pass over the triangles: those that stay behind may fold them further.
const LEAST: [f64; 3] = [0.1, 0.03, 0.0];
/// Steps that a triangle may take beside twice the length of its way.
const DETOUR: usize = 20;
/// Faces from a feature on which a row to it is tried.
const NEAR: usize = 8;
/// Outside the mesh.
const OUTSIDE: u32 = u32::MAX;

/// A side of a face and the face beyond.
type Passage = ([u32; 2], u32);

impl Work<'_> {
    /// Pairs the triangles; returns how many vertices that took on open boundaries and on other features.
    pub(super) fn pair_all(&mut self) -> [usize; 2] {
        let mut added = [0; 2];
        for least in LEAST {
            self.options.least_shape = least;
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
        let scene = &self.scene;
        let crossing = way.iter().position(|&([x, y], next)| next == OUTSIDE || scene.is_feature(x, y));
        if crossing.is_some_and(|place| place < NEAR)
            && let Some(after) = self.land(triangle, added)
        {
            return Some(after);
        }
        if crossing == Some(0) {
            return None;
        }
        let ([x, y], next) = way[0];
        let draft = Draft::new(&self.scene);
        let corners = draft.face(triangle);
        let side = (0..3).find(|&k| corners[k] == x && corners[(k + 1) % 3] == y)?;
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
                let settled = settle(&draft, self.options.triangle_price, self.options.least_shape)?;
                Some((Change::of(&draft), settled, after))
            })
            .reduce(|best, other| if other.1.gain > best.1.gain { other } else { best })
    }

    /// Puts a row in from a triangle to a feature near it, where that can be; the triangle is beyond it then, if anywhere.
    fn land(&mut self, triangle: u32, added: &mut [usize; 2]) -> Option<Option<u32>> {
        let draft = Draft::new(&self.scene);
        let corners = draft.face(triangle).to_vec();
        let within = Within { longest: NEAR, most: f64::INFINITY };
        let mut landings: Vec<Landing> =
            corners.iter().flat_map(|&apex| rows::land(&draft, triangle, apex, within)).collect();
        for Landing { draft, split, .. } in &mut landings {
            for v in &split[..2] {
                let place = self.on_feature(draft.point(*v));
                draft.place(*v, place);
            }
        }
        let drafts = landings.iter().enumerate().map(|(k, landing)| (landing.draft.clone(), Some(k as u32))).collect();
        let (change, settled, best) = self.best_of(drafts)?;
        let Landing { beyond, split: [at, copy, end], draft } = &landings[best? as usize];
        let (beyond, at, copy, end) = (*beyond, *at, *copy, *end);
        let places = [at, copy].map(|v| draft.point(v));
        drop(landings);
        self.apply(&change, &settled.places);
        self.scene.editor.place(at, places[0].into());
        self.scene.editor.place(copy, places[1].into());
        self.scene.features.remove(&[at.min(end), at.max(end)]);
        self.scene.features.extend([[at, copy], [end.min(copy), end.max(copy)]]);
        added[usize::from(beyond.is_some())] += 1;
        Some(beyond)
    }

    /// The point of the surface's features that is nearest to a point.
    fn on_feature(&self, point: DVec3) -> DVec3 {
        let surface = self.surface;
        (0..3 * surface.triangle_count() as u32)
            .filter(|&h| surface.features().is_feature(h))
            .map(|h| {
                let [a, b] = [surface.origin(h), surface.target(h)].map(|v| DVec3::from(surface.point(v)));
                nearest_on_segment(point, a, b)
            })
            .min_by(|p, q| p.distance_squared(point).total_cmp(&q.distance_squared(point)))
            .unwrap_or(point)
    }
}
