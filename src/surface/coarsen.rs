//! A coarser surface of the same shape: vertices that tiles of the wanted size do not need are removed.
//!
//! # Theory
//! Edges collapse, the shortest first, after Garland and Heckbert 1997, *Surface simplification using quadric error metrics*. A
//! vertex carries the planes of all triangles that it stands for, weighed by their areas, and those on features the lines of their
//! curves. An edge collapses into one of its vertices where the root mean square of that vertex's distances from the planes and
//! the lines stays below a tolerance, no triangle turns far, and the topology stays. Then edges between triangles in one plane are
//! flipped until they are Delaunay.
//!
//! # Practice
//! Remaining vertices are where they were. Corners, apexes, and vertices where sheets meet stay, and curves lose vertices along
//! themselves alone.

use super::fine::{FARTHEST, Fine};
use super::given::Given;
use super::given::Sheets;
use super::walk::{next_corner, previous_corner};
use super::{DroppedEdge, FeatureOptions, Features, NONE, Surface, next, previous};
use crate::progress::{ASKED_EVERY, Progress};
use glam::DVec3;
use rustc_hash::FxHashMap;
use std::iter::successors;
use std::sync::Arc;

/// The largest root mean square of the distances from planes and lines, in tile sides.
const TOLERANCE: f64 = 0.002;
/// The longest edge that collapses, in tile sides.
const LONGEST: f64 = 0.7;
/// The cosine of the largest angle by which one collapse turns a triangle.
const TURN: f64 = 0.9;
/// A collapse may leave triangles of this shape: twice the area over the squared longest side.
const SHAPE: f64 = 0.15;
/// A collapse may leave edges of this many lengths of the longest edge that collapses, or longer by this factor than they were.
const LONGER: f64 = 2.0;
/// Shapes are the same but for roundings where they differ by less than this factor.
const SAME: f64 = 0.999;
/// Four corners are in one plane where they are within this share of the tolerance of it.
const FLAT: f64 = 0.1;
/// Each round allows edges longer by this factor than the one before.
const ROUND: f64 = 1.6;
/// Sweeps over all vertices in a round.
const SWEEPS: usize = 2;

/// A quadratic form: the weighted sum of squared distances from planes, or from lines.
#[derive(Clone, Copy, Debug, Default)]
struct Quadric {
    /// The upper triangle of the matrix of the second degree, by rows.
    second: [f64; 6],
    first: DVec3,
    constant: f64,
    weight: f64,
}

impl Quadric {
    /// The squared distance from the plane through a point with a unit normal.
    fn plane(point: DVec3, n: DVec3, weight: f64) -> Self {
        let d = -n.dot(point);
        let second = [n.x * n.x, n.x * n.y, n.x * n.z, n.y * n.y, n.y * n.z, n.z * n.z];
        Self { second: second.map(|x| weight * x), first: n * (weight * d), constant: weight * d * d, weight }
    }

    /// The squared distance from the line through a point with a unit direction.
    fn line(point: DVec3, direction: DVec3, weight: f64) -> Self {
        let x = direction.any_orthonormal_vector();
        let sum = Self::plane(point, x, weight).plus(&Self::plane(point, direction.cross(x), weight));
        Self { weight, ..sum }
    }

    fn plus(&self, other: &Self) -> Self {
        Self {
            second: std::array::from_fn(|i| self.second[i] + other.second[i]),
            first: self.first + other.first,
            constant: self.constant + other.constant,
            weight: self.weight + other.weight,
        }
    }

    /// The mean squared distance of a point.
    fn at(&self, p: DVec3) -> f64 {
        let [xx, xy, xz, yy, yz, zz] = self.second;
        let product =
            DVec3::new(xx * p.x + xy * p.y + xz * p.z, xy * p.x + yy * p.y + yz * p.z, xz * p.x + yz * p.y + zz * p.z);
        let sum = p.dot(product) + 2.0 * self.first.dot(p) + self.constant;
        if self.weight > 0.0 { (sum / self.weight).max(0.0) } else { 0.0 }
    }
}

/// What an edge is.
#[derive(Clone, Copy, Debug, PartialEq)]
struct EdgeKind {
    is_feature: bool,
    is_named: bool,
    /// Whether it lies between two regions.
    is_border: bool,
    /// The crease of a dropped edge, by the first of [`Surface::dropped_edges`] on it; [`NONE`] on others.
    crease: u32,
}

impl EdgeKind {
    fn is_plain(self) -> bool {
        !self.is_feature && !self.is_named && !self.is_border && self.crease == NONE
    }
}

struct Coarsening {
    surface: Surface,
    kinds: Vec<EdgeKind>,
    is_dead: Vec<bool>,
    /// A half-edge that leaves each vertex; [`NONE`] where the vertex is removed.
    leaving: Vec<u32>,
    /// Whether each vertex must stay.
    is_fixed: Vec<bool>,
    /// Whether other vertices are at the place of each: sheets that meet there must keep the same edges.
    is_shared: Vec<bool>,
    /// The planes that each vertex stands for.
    planes: Vec<Quadric>,
    /// The lines of curves, of the vertices on them.
    lines: FxHashMap<u32, Quadric>,
    tolerance: f64,
}

impl Surface {
    /// A coarser surface for tiles of a side, unit-sized.
    pub(crate) fn coarsened(mut self, side: f64, options: &FeatureOptions, progress: &Progress) -> Self {
        let off = FARTHEST * side;
        let sheets = Arc::new(Sheets { points: self.points.clone(), triangles: self.triangles.clone(), off });
        self.fine = Some(Arc::new(Fine::new(&self, sheets.clone(), side)));
        match &mut self.as_given {
            Some(given) => Arc::make_mut(given).off += off,
            None => self.as_given = Some(sheets),
        }
        if progress.is_cancelled() {
            return self;
        }
        let mut coarsening = Coarsening::new(self, TOLERANCE * side);
        if progress.is_cancelled() {
            return coarsening.surface;
        }
        coarsening.collapse_all(LONGEST * side, progress);
        coarsening.flip_all(progress);
        coarsening.finish(options)
    }
}

impl Coarsening {
    fn new(surface: Surface, tolerance: f64) -> Self {
        let half_edges = 0..3 * surface.triangle_count() as u32;
        let kind = |is_feature| EdgeKind { is_feature, is_named: false, is_border: false, crease: NONE };
        let mut kinds: Vec<EdgeKind> = half_edges.clone().map(|h| kind(surface.features.is_feature(h))).collect();
        surface.named.iter().for_each(|&h| kinds[h as usize].is_named = true);
        surface.region_borders().iter().for_each(|&h| kinds[h as usize].is_border = true);
        let mut firsts = FxHashMap::default();
        for (i, edge) in (0..).zip(&surface.dropped) {
            let first = *firsts.entry(edge.crease).or_insert(i);
            for h in [Some(edge.half_edge), surface.twin(edge.half_edge)].into_iter().flatten() {
                kinds[h as usize].crease = first;
            }
        }
        let mut leaving = vec![NONE; surface.vertex_count()];
        half_edges.clone().for_each(|h| leaving[surface.origin(h) as usize] = h);
        let mut degrees = vec![0_u8; surface.vertex_count()];
        let mut lines: FxHashMap<u32, Quadric> = FxHashMap::default();
        let is_first = |h: &u32| surface.twin(*h).is_none_or(|twin| *h < twin);
        for h in half_edges.filter(is_first).filter(|&h| !kinds[h as usize].is_plain()) {
            let ends = [surface.origin(h), surface.target(h)];
            let [a, b] = ends.map(|v| surface.points[v as usize].as_dvec3());
            let line = Quadric::line(a, (b - a).normalize_or_zero(), a.distance(b));
            for v in ends {
                degrees[v as usize] = degrees[v as usize].saturating_add(1);
                let sum = lines.entry(v).or_default();
                *sum = sum.plus(&line);
            }
        }
        let is_shared = surface.shared_places();
        let mut is_fixed = is_shared.clone();
        for v in 0..surface.vertex_count() as u32 {
            is_fixed[v as usize] |=
                ![0, 2].contains(&degrees[v as usize]) || surface.features.is_corner(v) || surface.is_kept(v);
        }
        let mut planes = vec![Quadric::default(); surface.vertex_count()];
        for (t, triangle) in surface.triangles.iter().enumerate() {
            let corners = surface.corners(t).map(|p| p.as_dvec3());
            let double_area = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
            let area = double_area.length();
            if area > 0.0 {
                let plane = Quadric::plane(corners[0], double_area / area, area);
                triangle.iter().for_each(|&v| planes[v as usize] = planes[v as usize].plus(&plane));
            }
        }
        let is_dead = vec![false; surface.triangle_count()];
        Self { surface, kinds, is_dead, leaving, is_fixed, is_shared, planes, lines, tolerance }
    }

    fn place(&self, v: u32) -> DVec3 {
        self.surface.points[v as usize].as_dvec3()
    }

    /// The half-edges that leave a vertex, counter-clockwise; on a boundary from the first.
    fn ring(&self, v: u32, ring: &mut Vec<u32>) {
        let start = self.leaving[v as usize];
        let is_barrier = |_| false;
        let before = |&h: &u32| previous_corner(&self.surface, is_barrier, h).filter(|&h| h != start);
        let first = successors(Some(start), before).last().unwrap_or(start);
        let after = |&h: &u32| next_corner(&self.surface, is_barrier, h).filter(|&h| h != first);
        ring.clear();
        ring.extend(successors(Some(first), after));
    }

    /// Collapses edges up to a length, the shortest first.
    fn collapse_all(&mut self, longest: f64, progress: &Progress) {
        let half_edges = 0..3 * self.surface.triangle_count() as u32;
        let mut lengths: Vec<f64> = half_edges.map(|h| self.surface.length(h)).collect();
        let tenth = lengths.len() / 10;
        let shortest = *lengths.select_nth_unstable_by(tenth, f64::total_cmp).1;
        let mut limit = shortest.max(longest / 1e3).min(longest);
        let mut search = Search::new(self.surface.vertex_count());
        loop {
            for _ in 0..SWEEPS {
                for v in 0..self.leaving.len() as u32 {
                    if (v as usize).is_multiple_of(ASKED_EVERY) && progress.is_cancelled() {
                        return;
                    }
                    if self.leaving[v as usize] == NONE || self.is_fixed[v as usize] {
                        continue;
                    }
                    if let Some(h) = self.best(v, limit, &mut search) {
                        self.collapse(h, &search.ring);
                    }
                }
            }
            if limit >= longest {
                return;
            }
            limit = (ROUND * limit).min(longest);
        }
    }

    /// The half-edge from a vertex along which it collapses best, of those up to a length. Leaves the ring of the vertex in `search`.
    fn best(&self, v: u32, limit: f64, search: &mut Search) -> Option<u32> {
        let from = self.place(v);
        self.ring(v, &mut search.ring);
        let is_on_curve = self.lines.contains_key(&v);
        let squared = self.tolerance * self.tolerance;
        let mut candidates = std::mem::take(&mut search.candidates);
        candidates.clear();
        for &h in &search.ring {
            if is_on_curve == self.kinds[h as usize].is_plain() {
                continue;
            }
            let w = self.surface.target(h);
            let to = self.place(w);
            if self.is_shared[w as usize] || from.distance_squared(to) > limit * limit {
                continue;
            }
            let error = self.planes[v as usize].plus(&self.planes[w as usize]).at(to);
            if error > squared {
                continue;
            }
            if is_on_curve {
                let line = self.lines[&v].plus(self.lines.get(&w).unwrap_or(&Quadric::default()));
                if line.at(to) > squared || !self.is_chord_alike(h, &search.ring) {
                    continue;
                }
            }
            candidates.push((error + 1e-6 * from.distance_squared(to), h));
        }
        candidates.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let best = candidates
            .iter()
            .map(|&(_, h)| h)
            .find(|&h| self.keeps_shape(v, h, limit, &search.ring) && self.keeps_topology(h, search));
        search.candidates = candidates;
        best
    }

    /// Whether the other edge of a curve at a vertex is of the same kind as this one.
    fn is_chord_alike(&self, h: u32, ring: &[u32]) -> bool {
        let kind = self.kinds[h as usize];
        let last = previous(*ring.last().unwrap_or(&h));
        let boundary = self.surface.twin(last).is_none().then_some(last);
        let mut others = ring.iter().copied().chain(boundary).filter(|&g| g != h && !self.kinds[g as usize].is_plain());
        others.all(|g| self.kinds[g as usize] == kind)
    }

    /// Whether the triangles that stay round a vertex turn little and keep a fair shape when it moves to the end of a half-edge.
    fn keeps_shape(&self, v: u32, h: u32, limit: f64, ring: &[u32]) -> bool {
        let w = self.surface.target(h);
        let (from, to) = (self.place(v), self.place(w));
        let mut worst = [f64::INFINITY; 2];
        for &e in ring {
            let [b, c] = [self.surface.target(e), self.surface.origin(previous(e))];
            let [pb, pc] = [b, c].map(|v| self.place(v));
            let now = (pb - from).cross(pc - from);
            let shape = |area: f64, p: DVec3| {
                let longest = p.distance_squared(pb).max(pb.distance_squared(pc)).max(pc.distance_squared(p));
                area / longest.max(f64::MIN_POSITIVE)
            };
            worst[0] = worst[0].min(shape(now.length(), from));
            if b == w || c == w {
                continue;
            }
            let then = (pb - to).cross(pc - to);
            if then.dot(now) < TURN * then.length() * now.length() {
                return false;
            }
            let reach = |p: DVec3| p.distance_squared(pb).max(p.distance_squared(pc));
            if reach(to) > (LONGER * limit).powi(2).max(LONGER * reach(from)) {
                return false;
            }
            worst[1] = worst[1].min(shape(then.length(), to));
        }
        worst[1] > SHAPE.min(SAME * worst[0])
    }

    /// The link condition: the ends of an edge have no common neighbours but those of its triangles.
    fn keeps_topology(&self, h: u32, search: &mut Search) -> bool {
        let w = self.surface.target(h);
        search.stamp += 1;
        for &e in &search.ring {
            search.seen[self.surface.target(e) as usize] = search.stamp;
            search.seen[self.surface.origin(previous(e)) as usize] = search.stamp;
        }
        let triangles = 1 + usize::from(self.surface.twin(h).is_some());
        self.ring(w, &mut search.other);
        let last = previous(*search.other.last().unwrap_or(&h));
        let end = self.surface.twin(last).is_none().then(|| self.surface.origin(last));
        let neighbours = search.other.iter().map(|&e| self.surface.target(e)).chain(end);
        let common = neighbours.filter(|&x| search.seen[x as usize] == search.stamp).count();
        // No triangle may lose both of its other neighbours, nor one lie on another.
        let is_joined = |f: u32| {
            let [a, b] = [next(f), previous(f)].map(|e| self.surface.twin(e));
            match (a, b) {
                (None, None) => false,
                (Some(a), Some(b)) => self.surface.origin(previous(a)) != self.surface.origin(previous(b)),
                _ => true,
            }
        };
        common == triangles && is_joined(h) && self.surface.twin(h).is_none_or(is_joined)
    }

    /// Moves the origin of a half-edge to its target; `ring` is that of the origin.
    fn collapse(&mut self, h: u32, ring: &[u32]) {
        let (v, w) = (self.surface.origin(h), self.surface.target(h));
        for &e in ring {
            self.surface.triangles[e as usize / 3][e as usize % 3] = w;
        }
        self.planes[w as usize] = self.planes[w as usize].plus(&self.planes[v as usize]);
        if let Some(line) = self.lines.remove(&v) {
            let sum = self.lines.entry(w).or_default();
            *sum = sum.plus(&line);
        }
        self.leaving[v as usize] = NONE;
        let twin = self.surface.twins[h as usize];
        for side in [h, twin].into_iter().filter(|&side| side != NONE) {
            let [out, back] =
                [next(side), previous(side)].map(|e| (self.surface.twins[e as usize], self.kinds[e as usize]));
            let apex = self.surface.origin(previous(side));
            self.is_dead[side as usize / 3] = true;
            let kind = if out.1.is_plain() { back.1 } else { out.1 };
            for (e, other) in [(out.0, back.0), (back.0, out.0)] {
                if e != NONE {
                    self.surface.twins[e as usize] = other;
                    self.kinds[e as usize] = kind;
                    // It runs between `w` and the apex, one way or the other.
                    self.leaving[self.surface.origin(e) as usize] = e;
                    self.leaving[self.surface.target(e) as usize] = next(e);
                }
            }
            debug_assert!(self.leaving[apex as usize] / 3 != side / 3);
        }
        debug_assert!(self.leaving[w as usize] != NONE);
    }

    /// Flips plain edges between triangles in one plane until they are Delaunay.
    fn flip_all(&mut self, progress: &Progress) {
        let half_edges = 0..3 * self.surface.triangle_count() as u32;
        let mut stack: Vec<u32> = half_edges.filter(|&h| !self.is_dead[h as usize / 3]).collect();
        let mut budget = 10 * stack.len();
        let mut ring = Vec::new();
        while let Some(h) = stack.pop() {
            if budget == 0 || stack.len().is_multiple_of(ASKED_EVERY) && progress.is_cancelled() {
                return;
            }
            if self.gains(h, &mut ring) {
                budget -= 1;
                stack.extend(self.flip(h));
            }
        }
    }

    /// Whether an edge may be flipped, and its triangles are Delaunay only then.
    fn gains(&self, h: u32, ring: &mut Vec<u32>) -> bool {
        let Some(g) = self.surface.twin(h).filter(|_| self.kinds[h as usize].is_plain()) else { return false };
        let ends = [h, g, previous(h), previous(g)].map(|e| self.surface.origin(e));
        if ends.iter().any(|&v| self.is_shared[v as usize]) {
            return false;
        }
        let [a, b, c, d] = ends.map(|v| self.place(v));
        let angle = |from: DVec3, p: DVec3, q: DVec3| (p - from).angle_between(q - from);
        if angle(c, a, b) + angle(d, a, b) < std::f64::consts::PI + 1e-6 {
            return false;
        }
        let [now, then] =
            [[(a, b, c), (b, a, d)], [(a, d, c), (d, b, c)]].map(|pair| pair.map(|(p, q, r)| (q - p).cross(r - p)));
        let whole = (now[0] + now[1]).normalize_or_zero();
        // The four corners lie in one plane but for a part of the tolerance, and the other diagonal lies inside.
        let height = (d - c)
            .dot((b - a).cross(c - a).normalize_or_zero())
            .abs()
            .min((c - d).dot((a - b).cross(d - b).normalize_or_zero()).abs());
        if height > FLAT * self.tolerance || then.iter().any(|area| area.dot(whole) <= 0.0) {
            return false;
        }
        self.ring(ends[2], ring);
        !ring.iter().any(|&e| self.surface.target(e) == ends[3] || self.surface.origin(previous(e)) == ends[3])
    }

    /// Puts the other diagonal in an edge's place; the four half-edges round the two triangles.
    fn flip(&mut self, h: u32) -> [u32; 4] {
        let g = self.surface.twins[h as usize];
        let [t, u] = [h / 3, g / 3];
        let [a, b, c, d] = [h, g, previous(h), previous(g)].map(|e| self.surface.origin(e));
        let old = [previous(g), next(h), next(g), previous(h)];
        let new = [3 * t, 3 * t + 1, 3 * u, 3 * u + 2];
        let sides = old.map(|e| (self.surface.twins[e as usize], self.kinds[e as usize]));
        let plain = self.kinds[h as usize];
        self.surface.triangles[t as usize] = [d, b, c];
        self.surface.triangles[u as usize] = [a, d, c];
        for (&e, (twin, kind)) in new.iter().zip(sides) {
            self.surface.twins[e as usize] = twin;
            self.kinds[e as usize] = kind;
            if twin != NONE {
                self.surface.twins[twin as usize] = e;
            }
            self.leaving[self.surface.origin(e) as usize] = e;
        }
        let [across, back] = [3 * t + 2, 3 * u + 1];
        (self.surface.twins[across as usize], self.surface.twins[back as usize]) = (back, across);
        (self.kinds[across as usize], self.kinds[back as usize]) = (plain, plain);
        self.leaving[c as usize] = across;
        new
    }

    /// The surface of what is left.
    fn finish(self, options: &FeatureOptions) -> Surface {
        let Self { mut surface, kinds, is_dead, leaving, .. } = self;
        let sources: Vec<u32> = (0..is_dead.len() as u32).filter(|&t| !is_dead[t as usize]).collect();
        let mut number = vec![NONE; is_dead.len()];
        (0..).zip(&sources).for_each(|(new, &old)| number[old as usize] = new);
        let moved = |h: u32| if h == NONE { NONE } else { 3 * number[h as usize / 3] + h % 3 };
        let left: Vec<u32> = (0..leaving.len() as u32).filter(|&v| leaving[v as usize] != NONE).collect();
        let mut vertex = vec![NONE; leaving.len()];
        (0..).zip(&left).for_each(|(new, &old)| vertex[old as usize] = new);
        let half_edges = || sources.iter().flat_map(|&t| [3 * t, 3 * t + 1, 3 * t + 2]);

        let marked = half_edges().map(|h| kinds[h as usize].is_feature).collect();
        surface.named = half_edges().filter(|&h| kinds[h as usize].is_named).map(moved).collect();
        let dropped =
            half_edges().filter(|&h| kinds[h as usize].crease != NONE && surface.twin(h).is_none_or(|twin| h < twin));
        surface.dropped = dropped
            .map(|h| DroppedEdge { half_edge: moved(h), ..surface.dropped[kinds[h as usize].crease as usize] })
            .collect();
        surface.twins = half_edges().map(|h| moved(surface.twins[h as usize])).collect();
        surface.triangles =
            sources.iter().map(|&t| surface.triangles[t as usize].map(|v| vertex[v as usize])).collect();
        surface.points = left.iter().map(|&v| surface.points[v as usize]).collect();
        // Vertices that share their place stay.
        surface.same_place = left.iter().map(|&v| vertex[surface.same_place[v as usize] as usize]).collect();
        surface.kept = surface.kept.iter().map(|&v| vertex[v as usize]).collect();
        surface.regions = surface.regions.of(&sources);
        surface.given = Given { points: left.iter().map(|&v| surface.given.points[v as usize]).collect() };
        surface.features.apexes = surface.features.apexes.iter().map(|&v| vertex[v as usize]).collect();
        surface.features = Features::along(&surface, marked, options.corner, surface.features.reach);
        surface
    }
}

/// Buffers of the search for the best collapse.
struct Search {
    ring: Vec<u32>,
    other: Vec<u32>,
    candidates: Vec<(f64, u32)>,
    /// The stamp of the vertices of the ring.
    seen: Vec<u32>,
    stamp: u32,
}

impl Search {
    fn new(vertices: usize) -> Self {
        Self { ring: Vec::new(), other: Vec::new(), candidates: Vec::new(), seen: vec![0; vertices], stamp: 0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::unwatched;
    use crate::surface::Soup;
    use crate::surface::examples::Example;
    use crate::surface::nearest::squared_distance;

    fn surface(soup: &Soup) -> Surface {
        Surface::new(soup, &FeatureOptions::default()).unwrap_or_else(|error| panic!("{error}"))
    }

    fn example(name: &str, triangles: usize) -> Surface {
        surface(&name.parse::<Example>().unwrap_or_else(|error| panic!("{error}")).generate(triangles))
    }

    fn euler(surface: &Surface) -> i64 {
        let edges = (0..3 * surface.triangle_count() as u32).filter(|&h| surface.twin(h).is_none_or(|twin| h < twin));
        surface.vertex_count() as i64 - edges.count() as i64 + surface.triangle_count() as i64
    }

    /// What is wrong with the opposites of half-edges.
    fn faults(surface: &Surface) -> Vec<u32> {
        let is_wrong = |&h: &u32| {
            surface.twin(h).is_some_and(|twin| {
                surface.twin(twin) != Some(h)
                    || [surface.origin(twin), surface.target(twin)] != [surface.target(h), surface.origin(h)]
            })
        };
        (0..3 * surface.triangle_count() as u32).filter(is_wrong).collect()
    }

    /// The largest distance of some vertices of one surface from the other.
    fn distance(from: &Surface, to: &Surface) -> f64 {
        let to_surface = |p: DVec3| {
            let triangles = (0..to.triangle_count()).map(|t| to.corners(t).map(|p| p.as_dvec3()));
            triangles.map(|corners| squared_distance(p, corners)).fold(f64::INFINITY, f64::min).sqrt()
        };
        from.points.iter().step_by(37).map(|p| to_surface(p.as_dvec3())).fold(0.0, f64::max)
    }

    #[test]
    fn a_coarse_sphere_is_one_within_some_tolerances() {
        let fine = example("sphere", 40_000);
        let side = 0.2;
        let coarse = fine.clone().coarsened(side, &FeatureOptions::default(), &Progress::new(&unwatched));
        let given = coarse.as_given().expect("it is coarser");
        assert!(fine.as_given().is_none() && given.points == fine.points && given.triangles == fine.triangles);
        assert!(4 * coarse.triangle_count() < fine.triangle_count(), "{}", coarse.triangle_count());
        assert_eq!((euler(&coarse), faults(&coarse)), (2, vec![]));
        let far = distance(&fine, &coarse);
        assert!(far > 0.0 && far < 4.0 * TOLERANCE * side, "{far} is below four tolerances of {}", TOLERANCE * side);
        assert_eq!(
            fine.clone().coarsened(1e-6, &FeatureOptions::default(), &Progress::new(&unwatched)).triangle_count(),
            fine.triangle_count()
        );
    }

    #[test]
    fn a_block_keeps_its_corners_and_edges_and_loses_the_rest() {
        let fine = example("block", 20_000);
        let side = 0.2;
        let coarse = fine.clone().coarsened(side, &FeatureOptions::default(), &Progress::new(&unwatched));
        assert!(4 * coarse.triangle_count() < fine.triangle_count(), "{}", coarse.triangle_count());
        assert_eq!((euler(&coarse), faults(&coarse)), (euler(&fine), vec![]));
        let corners = |surface: &Surface| {
            let mut corners: Vec<_> =
                surface.features().corners().map(|v| surface.points[v as usize].to_array().map(f32::to_bits)).collect();
            corners.sort_unstable();
            corners
        };
        assert_eq!(corners(&coarse), corners(&fine));
        let length = |surface: &Surface| surface.features().curves().iter().map(|curve| curve.length()).sum::<f64>();
        assert!((length(&coarse) / length(&fine) - 1.0).abs() < 1e-3, "{} {}", length(&coarse), length(&fine));
    }

    #[test]
    fn needles_become_fair_triangles_where_they_are_coplanar() {
        // A rectangle whose long sides have so many vertices that its triangles are needles.
        let at = |i: u32, j: u32| 2 * i + j;
        let points = (0..=200).flat_map(|i| [0.0, 5.0].map(|y| [f64::from(i) / 20.0, y, 0.0])).collect();
        let cell = |i| [[at(i, 0), at(i + 1, 0), at(i + 1, 1)], [at(i, 0), at(i + 1, 1), at(i, 1)]];
        let soup = Soup { points, triangles: (0..200).flat_map(cell).collect(), ..Soup::default() };
        let fine = surface(&soup);
        let side = 1.0 / fine.frame().diagonal;
        let coarse = fine.clone().coarsened(side, &FeatureOptions::default(), &Progress::new(&unwatched));
        assert_eq!((euler(&coarse), faults(&coarse)), (1, vec![]));
        assert!((coarse.area() / fine.area() - 1.0).abs() < 1e-5);
        let longest = 0.9 * side;
        assert!(5 * coarse.parts(longest) < fine.parts(longest), "{} {}", coarse.parts(longest), fine.parts(longest));
    }

    #[test]
    fn the_distance_from_a_line_and_a_plane_is_that_of_geometry() {
        let [p, d] = [DVec3::new(1.0, 2.0, 3.0), DVec3::new(2.0, -1.0, 2.0) / 3.0];
        let q = DVec3::new(-0.5, 4.0, 1.0);
        let along = (q - p).dot(d);
        assert!((Quadric::plane(p, d, 2.0).at(q) - along * along).abs() < 1e-12);
        assert!((Quadric::line(p, d, 5.0).at(q) - ((q - p).length_squared() - along * along)).abs() < 1e-12);
        let mean = Quadric::plane(p, d, 1.0).plus(&Quadric::plane(q, d, 3.0)).at(q);
        assert!((mean - along * along / 4.0).abs() < 1e-12);
    }
}
