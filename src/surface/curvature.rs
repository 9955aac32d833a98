//! Principal curvatures at a chosen scale.
//!
//! # Theory
//! The integral curvature tensor of Cohen-Steiner and Morvan 2003 (*Restricted Delaunay triangulations and normal
//! cycle*): over a disc `D` of the surface, `T = 1 / area(D) * sum over edges e of angle(e) * length(e in D) * e e^T`,
//! `e` the edge's unit direction and `angle` the turn of the normal across it. An edge stands for bending *across* it, so
//! the curvature that is an eigenvalue of `T` belongs to the direction across its eigenvector.
//!
//! # Changes versus the paper
//! The disc is the part of the surface in a ball that is reached from the ball's centre without crossing a feature: features
//! bound the disc, and the turn at a crease is not counted. Not every vertex has a disc: vertices a third of a radius apart are
//! measured, and the others take the mean of their tensors, with weights that fall to zero at half a radius. So the work grows
//! with the surface alone, not with the radius.
//!
//! # Practice
//! On a surface that bends evenly the curvature does not depend on the radius. A narrow bend through the centre of the
//! disc (a fillet of total angle `A`, much narrower than the radius `r`) is spread over it: a line of length `2 r` in an
//! area of `pi r^2` makes `k = 2 A / (pi r)`. So with [`radius_of_tile`] the surface turns by about `k h` within a tile of
//! side `h` in both cases. Beside the line `k` falls as the chord does, and is zero from a radius away. Measured values and
//! times: docs/experiments.md, surface.

use super::{NONE, Surface, next_corner, previous_corner};
use crate::progress::{IsCancelled, until_cancelled};
use glam::{DMat3, DVec3, Mat3, Vec3};
use rayon::prelude::*;
use rustc_hash::FxHashMap;
use std::f64::consts::{FRAC_2_PI, PI};
use std::mem;

/// Vertices within this share of the radius about a measured one are not measured themselves.
const SPACING: f64 = 1.0 / 3.0;
/// The share of the radius at which the weight of a measured vertex is zero.
const FADE: f64 = 0.5;

/// Cells on either side of a disc's middle that its triangles lie in, where bends are summed up beforehand.
const CELLS: i64 = 2;

/// The cells along z about one.
fn span_of([x, y, z]: [i64; 3]) -> impl Iterator<Item = [i64; 3]> {
    (-CELLS..=CELLS).map(move |k| [x, y, z + k])
}

/// The principal curvatures at a vertex.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Curvature {
    /// The directions of greatest and least `|curvature|`: unit vectors at right angles to each other and the normal.
    pub directions: [DVec3; 2],
    /// The curvatures in these directions, for unit-sized coordinates; positive where the surface is convex from outside.
    pub values: [f64; 2],
}

/// The radius of the disc in which a narrow fillet of angle `A` has the curvature `A / side`.
pub(crate) fn radius_of_tile(side: f64) -> f64 {
    FRAC_2_PI * side
}

/// The curvatures at each vertex, averaged over a disc of this radius (unit-sized coordinates) about it; it is at least
/// that of a tile of the vertex' shortest edge, so that bends are not seen one edge at a time.
pub(crate) fn curvatures(surface: &Surface, radius: f64) -> Vec<Curvature> {
    curvatures_above(surface, radius, 0.0, &|| false)
}

/// As [`curvatures`], but where the surface is sure to bend less than `least` the values are zero; cancelled, they are of no use.
pub(crate) fn curvatures_above(
    surface: &Surface,
    radius: f64,
    least: f64,
    is_cancelled: &IsCancelled,
) -> Vec<Curvature> {
    let measure = Measure::new(surface, radius, is_cancelled);
    let seeds = measure.seeds(&measure.settled(least, is_cancelled), is_cancelled);
    let measured: Vec<Vec<Bend>> = seeds
        .par_chunks(seeds.len().div_ceil(64).max(1))
        .map(|seeds| {
            let mut flood = Flood::new(surface);
            let left = seeds.iter().take_while(|_| !is_cancelled());
            left.map(|&seed| measure.bend(&mut flood, seed)).collect()
        })
        .collect();
    let mut tensors = vec![(DMat3::ZERO, 0.0); surface.vertex_count()];
    for bend in measured.into_iter().flatten() {
        for (vertex, weight) in bend.shares {
            let (sum, total) = &mut tensors[vertex as usize];
            *sum += bend.tensor * weight;
            *total += weight;
        }
    }
    let normals = vertex_normals(surface);
    let mean = |&(sum, total): &(DMat3, f64)| if total > 0.0 { sum / total } else { DMat3::ZERO };
    tensors.par_iter().zip(&normals).map(|(of, &normal)| Curvature::new(normal, mean(of))).collect()
}

impl Curvature {
    /// From the normal and the tensor whose eigenvalues belong to the directions across its eigenvectors.
    fn new(normal: DVec3, tensor: DMat3) -> Self {
        let (u, v) = normal.try_normalize().unwrap_or(DVec3::Z).any_orthonormal_pair();
        let (uu, uv, vv) = (u.dot(tensor * u), u.dot(tensor * v), v.dot(tensor * v));
        let (mean, half) = ((uu + vv) / 2.0, (uu - vv) / 2.0);
        let spread = half.hypot(uv);
        let (s, c) = (uv.atan2(half) / 2.0).sin_cos();
        let (along, across) = (u * c + v * s, v * c - u * s);
        // `along` is the eigenvector of the greater eigenvalue, so that curvature lies across it.
        let [first, second] = [(mean + spread, across), (mean - spread, along)];
        let [first, second] = if first.0.abs() >= second.0.abs() { [first, second] } else { [second, first] };
        Self { directions: [first.1, second.1], values: [first.0, second.0] }
    }
}

/// The tensor at one vertex, and the vertices that take part of it.
struct Bend {
    tensor: DMat3,
    shares: Vec<(u32, f64)>,
}

struct Measure<'a> {
    surface: &'a Surface,
    /// The radius of the disc about each vertex.
    radii: Vec<f64>,
    /// Whether a vertex lies on a feature: these take their tensors from each other alone, since theirs are of several sides.
    on_feature: Vec<bool>,
    /// A corner at each vertex.
    corners: Vec<u32>,
    /// The turn of the normal across each half-edge, in radians; zero on features.
    turns: Vec<f32>,
    normals: Vec<DVec3>,
    areas: Vec<f64>,
    /// The contribution of each whole triangle to a disc.
    tensors: Vec<Mat3>,
}

impl<'a> Measure<'a> {
    fn new(surface: &'a Surface, radius: f64, is_cancelled: &IsCancelled) -> Self {
        let mut corners = vec![NONE; surface.vertex_count()];
        let mut shortest = vec![f64::INFINITY; surface.vertex_count()];
        let mut on_feature = vec![false; surface.vertex_count()];
        for h in until_cancelled(0..3 * surface.triangle_count() as u32, is_cancelled) {
            let length = surface.length(h);
            corners[surface.origin(h) as usize] = h;
            for v in [surface.origin(h), surface.target(h)].map(|v| v as usize) {
                shortest[v] = shortest[v].min(length);
                on_feature[v] |= surface.features().is_feature(h);
            }
        }
        let triangles = || (0..surface.triangle_count()).into_par_iter();
        let sides = |t: usize| {
            let corners = surface.corners(t).map(|p| p.as_dvec3());
            [0, 1, 2].map(|k| corners[(k + 1) % 3] - corners[k])
        };
        let doubled: Vec<DVec3> = triangles().map(|t| sides(t)[0].cross(sides(t)[1])).collect();
        let normals: Vec<DVec3> = doubled.iter().map(|n| n.normalize_or_zero()).collect();
        let turns_of = |t: usize| (3 * t..3 * t + 3).map(|h| turn(surface, &normals, h as u32));
        let turns: Vec<f32> = match is_cancelled() {
            true => vec![0.0; 3 * surface.triangle_count()],
            false => triangles().flat_map_iter(turns_of).collect(),
        };
        let tensors = triangles().map(|t| {
            let sides = sides(t);
            (0..3).map(|k| half_tensor(sides[k], turns[3 * t + k])).sum::<DMat3>().as_mat3()
        });
        let tensors = tensors.collect();
        let radii = shortest.iter().map(|shortest| radius.max(radius_of_tile(*shortest))).collect();
        let areas = doubled.iter().map(|n| n.length() / 2.0).collect();
        Self { surface, radii, on_feature, corners, turns, normals, areas, tensors }
    }

    /// The vertices whose curvature is certainly below `least`: not even all turns in the cells around a disc, whatever
    /// their directions, would make as much in the disc's area, or beside features in a quarter of it.
    fn settled(&self, least: f64, is_cancelled: &IsCancelled) -> Vec<bool> {
        let surface = self.surface;
        if least <= 0.0 || is_cancelled() {
            return vec![false; surface.vertex_count()];
        }
        let longest = (0..3 * surface.triangle_count() as u32).into_par_iter().map(|h| surface.length(h));
        let reach = longest.reduce(|| 0.0, f64::max) + self.radii.iter().copied().fold(0.0, f64::max);
        let cell_of = |p: Vec3| (p.as_dvec3() / (reach / CELLS as f64)).floor().as_i64vec3().to_array();
        // Of each cell: the sum of turns times lengths, and whether a feature passes.
        let mut sums: FxHashMap<[i64; 3], (f64, bool)> = FxHashMap::default();
        for t in until_cancelled(0..surface.triangle_count(), is_cancelled) {
            let (sum, feature) = sums.entry(cell_of(surface.corners(t)[0])).or_default();
            for h in 3 * t as u32..3 * t as u32 + 3 {
                *sum += f64::from(self.turns[h as usize]).abs() * surface.length(h) / 2.0;
                *feature |= surface.features().is_feature(h);
            }
        }
        let about = |[x, y, z]: [i64; 3]| {
            if is_cancelled() {
                return 0.0;
            }
            let span = -CELLS..=CELLS;
            let cells = span.clone().flat_map(|i| span.clone().flat_map(move |j| span_of([x + i, y + j, z])));
            let found = cells.filter_map(|cell| sums.get(&cell));
            let (sum, feature) = found.fold((0.0, false), |(s, f), &(sum, feature)| (s + sum, f || feature));
            if feature { 4.0 * sum } else { sum }
        };
        let cells: Vec<[i64; 3]> = sums.keys().copied().collect();
        let bends: FxHashMap<[i64; 3], f64> = cells.par_iter().map(|&cell| (cell, about(cell))).collect();
        let bend = |p: Vec3| bends.get(&cell_of(p)).copied().unwrap_or_else(|| about(cell_of(p)));
        let points = surface.points.par_iter().zip(&self.radii);
        points.map(|(&p, radius)| bend(p) < least * PI * radius * radius).collect()
    }

    /// Vertices such that every other that is not `settled` has one of its kind, on features or off them, within the spacing.
    fn seeds(&self, settled: &[bool], is_cancelled: &IsCancelled) -> Vec<u32> {
        let mut covered = settled.to_vec();
        let mut flood = Flood::new(self.surface);
        let mut seeds = Vec::new();
        for seed in until_cancelled(0..settled.len() as u32, is_cancelled) {
            if !covered[seed as usize] {
                let radius = SPACING * self.radii[seed as usize];
                flood.run(self, seed, radius, radius, |_, _| {});
                flood.near.iter().for_each(|&(vertex, _)| covered[vertex as usize] = true);
                seeds.push(seed);
            }
        }
        seeds
    }

    fn bend(&self, flood: &mut Flood, seed: u32) -> Bend {
        let radius = self.radii[seed as usize];
        let reach = FADE * radius;
        let (mut tensor, mut area) = (DMat3::ZERO, 0.0);
        flood.run(self, seed, radius, reach, |t, rim| match rim {
            None => {
                tensor += self.tensors[t].as_dmat3();
                area += self.areas[t];
            }
            Some(sides) => {
                area += area_in_ball(sides, self.normals[t], radius * radius);
                for (side, &turn) in sides.iter().zip(&self.turns[3 * t..3 * t + 3]) {
                    if let Some((from, to)) = side.inside {
                        tensor += half_tensor(side.way * (to - from), turn);
                    }
                }
            }
        });
        let shares = flood.near.iter().map(|&(vertex, distance)| (vertex, 1.0 - distance / reach)).collect();
        Bend { tensor: if area > 0.0 { tensor / area } else { DMat3::ZERO }, shares }
    }
}

/// The mean normal of the triangles at each vertex, weighted by their areas: a unit vector, zero where they cancel.
pub(crate) fn vertex_normals(surface: &Surface) -> Vec<DVec3> {
    let mut sums = vec![DVec3::ZERO; surface.vertex_count()];
    for (t, corners) in surface.triangles.iter().enumerate() {
        let [a, b, c] = surface.corners(t).map(|p| p.as_dvec3());
        corners.iter().for_each(|&v| sums[v as usize] += (b - a).cross(c - a));
    }
    sums.iter().map(|sum| sum.normalize_or_zero()).collect()
}

/// The angle by which the normal turns across a half-edge, outward positive.
fn turn(surface: &Surface, normals: &[DVec3], half_edge: u32) -> f32 {
    let twin = surface.twin(half_edge).filter(|_| !surface.features().is_feature(half_edge));
    twin.map_or(0.0, |twin| {
        let [here, there] = [half_edge, twin].map(|h| normals[h as usize / 3]);
        let [from, to] = [half_edge, twin].map(|h| surface.points[surface.origin(h) as usize].as_dvec3());
        let sine = here.cross(there).dot((to - from).normalize_or_zero());
        sine.atan2(here.dot(there)) as f32
    })
}

/// Half of the contribution of an edge, or of a part of one, to a disc; the triangle on its other side has the other half.
fn half_tensor(way: DVec3, turn: f32) -> DMat3 {
    let scaled = way * (0.5 * f64::from(turn) / way.length().max(f64::MIN_POSITIVE));
    DMat3::from_cols(way * scaled.x, way * scaled.y, way * scaled.z)
}

/// Collects discs; one is used for many, so that its marks are allocated once.
struct Flood {
    round: u32,
    seen_triangles: Vec<u32>,
    seen_vertices: Vec<u32>,
    triangles: Vec<u32>,
    /// Vertices like the last centre and near it, and their distances from it.
    near: Vec<(u32, f64)>,
}

impl Flood {
    fn new(surface: &Surface) -> Self {
        Self {
            round: 0,
            seen_triangles: vec![0; surface.triangle_count()],
            seen_vertices: vec![0; surface.vertex_count()],
            triangles: Vec::new(),
            near: Vec::new(),
        }
    }

    /// Visits each triangle of the disc about a vertex, with its sides where it is not inside as a whole, and lists the
    /// vertices like it that are nearer than `reach`.
    fn run(
        &mut self,
        measure: &Measure,
        vertex: u32,
        radius: f64,
        reach: f64,
        mut visit: impl FnMut(usize, Option<&[Side; 3]>),
    ) {
        let surface = measure.surface;
        let centre = surface.points[vertex as usize];
        let [radius_squared, reach_squared] = [radius * radius, reach * reach];
        self.round += 1;
        self.triangles.clear();
        self.near.clear();
        for corner in fan(surface, measure.corners[vertex as usize]) {
            self.reach(corner / 3);
        }
        let mut at = 0;
        while let Some(&triangle) = self.triangles.get(at) {
            at += 1;
            let vertices = surface.triangles[triangle as usize];
            let place = |v: u32| (surface.points[v as usize] - centre).as_dvec3();
            let [a, b, c] = [place(vertices[0]), place(vertices[1]), place(vertices[2])];
            let distances = [a.length_squared(), b.length_squared(), c.length_squared()];
            for (&v, square) in vertices.iter().zip(distances) {
                if square < reach_squared && mem::replace(&mut self.seen_vertices[v as usize], self.round) != self.round
                {
                    self.near.push((v, square.sqrt()));
                }
            }
            let half_edge = 3 * triangle;
            if distances.iter().all(|&square| square < radius_squared) {
                visit(triangle as usize, None);
                (half_edge..half_edge + 3).for_each(|h| self.cross(surface, h));
            } else {
                let sides = [(a, b), (b, c), (c, a)].map(|(start, end)| Side::new(start, end, radius_squared));
                visit(triangle as usize, Some(&sides));
                for (h, _) in (half_edge..).zip(&sides).filter(|(_, side)| side.inside.is_some()) {
                    self.cross(surface, h);
                }
            }
        }
        let like = |v: u32| measure.on_feature[v as usize] == measure.on_feature[vertex as usize];
        self.near.retain(|&(v, _)| like(v));
    }

    fn cross(&mut self, surface: &Surface, half_edge: u32) {
        if let Some(twin) = surface.twin(half_edge).filter(|_| !surface.features().is_feature(half_edge)) {
            self.reach(twin / 3);
        }
    }

    fn reach(&mut self, triangle: u32) {
        if mem::replace(&mut self.seen_triangles[triangle as usize], self.round) != self.round {
            self.triangles.push(triangle);
        }
    }
}

/// One side of a triangle, seen from the centre of a ball.
struct Side {
    start: DVec3,
    way: DVec3,
    /// Where it enters and leaves the ball, as shares of its length; `None`: it passes by.
    inside: Option<(f64, f64)>,
}

impl Side {
    fn new(start: DVec3, end: DVec3, radius_squared: f64) -> Self {
        let way = end - start;
        let (square, product) = (way.length_squared(), start.dot(way));
        let root = (product * product - square * (start.length_squared() - radius_squared)).sqrt();
        let [from, to] = [-root, root].map(|root| ((root - product) / square).clamp(0.0, 1.0));
        // Not a number where there is no root; then neither is less.
        Self { start, way, inside: (from < to).then_some((from, to)) }
    }
}

/// The area of a triangle's part in a ball: of the intersection of a triangle and a circle, side by side.
fn area_in_ball(sides: &[Side; 3], normal: DVec3, radius_squared: f64) -> f64 {
    let height = normal * normal.dot(sides[0].start);
    let radius_squared = radius_squared - height.length_squared();
    if radius_squared <= 0.0 {
        return 0.0;
    }
    let wedge = |a: DVec3, b: DVec3| normal.dot(a.cross(b)) / 2.0;
    let sector = |a: DVec3, b: DVec3| radius_squared / 2.0 * angle(2.0 * wedge(a, b), a.dot(b));
    let beneath = |side: &Side| {
        let [a, b] = [side.start - height, side.start + side.way - height];
        side.inside.map_or_else(
            || sector(a, b),
            |(from, to)| {
                let [p, q] = [from, to].map(|share| a + side.way * share);
                sector(a, p) + wedge(p, q) + sector(q, b)
            },
        )
    };
    sides.iter().map(beneath).sum::<f64>().max(0.0)
}

/// `atan2`, by its series where angles are small, to 1e-6 of them: there are many.
fn angle(y: f64, x: f64) -> f64 {
    let t = y / x;
    if x > 0.0 && t.abs() < 0.25 {
        let square = t * t;
        t * (1.0 - square * (1.0 / 3.0 - square * (1.0 / 5.0 - square / 7.0)))
    } else {
        y.atan2(x)
    }
}

/// All corners at the vertex of one.
fn fan(surface: &Surface, corner: u32) -> impl Iterator<Item = u32> + '_ {
    let free = |_| false;
    let mut first = corner;
    while let Some(before) = previous_corner(surface, free, first).filter(|&before| before != corner) {
        first = before;
    }
    let mut at = Some(first);
    std::iter::from_fn(move || {
        let here = at?;
        at = next_corner(surface, free, here).filter(|&after| after != first);
        Some(here)
    })
}

#[cfg(test)]
mod tests;
