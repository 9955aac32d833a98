//! Surfaces made of patches: grids, turned profiles, walls and flat caps, which are welded where they touch.

use super::random::Random;
use glam::{DMat3, DVec2, DVec3};
use quadmosaic::surface::Soup;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// A closed polygon without collinear neighbours; outlines run counter-clockwise.
pub type Loop = Vec<DVec2>;

/// Two points nearer than this, where a surface is about one long, are one.
const WELDED: f64 = 1e-9;

#[derive(Clone, Default)]
pub struct Builder {
    pub points: Vec<DVec3>,
    pub triangles: Vec<[u32; 3]>,
}

impl Builder {
    pub fn triangle(&mut self, corners: [DVec3; 3]) {
        let first = self.points.len() as u32;
        self.points.extend(corners);
        self.triangles.push([first, first + 1, first + 2]);
    }

    /// A quad; `other` takes its other diagonal.
    pub fn quad(&mut self, [a, b, c, d]: [DVec3; 4], other: bool) {
        let halves = if other { [[a, b, d], [b, c, d]] } else { [[a, b, c], [a, c, d]] };
        halves.into_iter().for_each(|half| self.triangle(half));
    }

    /// A grid over the unit square; a side that comes back to its beginning is welded. Diagonals alternate.
    pub fn grid(&mut self, [columns, rows]: [usize; 2], place: impl Fn(f64, f64) -> DVec3) {
        let at = |i: usize, j: usize| place(i as f64 / columns as f64, j as f64 / rows as f64);
        for (i, j) in (0..columns).flat_map(|i| (0..rows).map(move |j| (i, j))) {
            self.quad([at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)], (i + j) % 2 == 1);
        }
    }

    /// A profile of radii and heights, from below to above where it is outside, turned about the z axis.
    pub fn turned(&mut self, profile: &[DVec2], around: usize) {
        let at = |p: DVec2, i: usize| {
            let (s, c) = (TAU * (i % around) as f64 / around as f64).sin_cos();
            DVec3::new(p.x * c, p.x * s, p.y)
        };
        for (pair, i) in profile.windows(2).flat_map(|pair| (0..around).map(move |i| (pair, i))) {
            self.quad([at(pair[0], i), at(pair[0], i + 1), at(pair[1], i + 1), at(pair[1], i)], false);
        }
    }

    /// The wall from a loop at one height to the same loop at another one; outside where an outline goes up.
    pub fn wall(&mut self, corners: &Loop, [from, to]: [f64; 2], rows: usize) {
        let height = |j: usize| from * (1.0 - j as f64 / rows as f64) + to * j as f64 / rows as f64;
        let next = corners.iter().cycle().skip(1);
        for ((a, b), j) in corners.iter().zip(next).flat_map(|side| (0..rows).map(move |j| (side, j))) {
            let [low, high] = [height(j), height(j + 1)];
            self.quad([a.extend(low), b.extend(low), b.extend(high), a.extend(high)], j % 2 == 1);
        }
    }

    /// The flat part at a height that an odd number of loops encloses, with points inside; `up` is the side of its normal.
    pub fn flat(&mut self, loops: &[Loop], inside: &[DVec2], height: f64, up: bool) {
        let mut cut = ConstrainedDelaunayTriangulation::<Point2<f64>>::new();
        let insert = |p: &DVec2, cut: &mut ConstrainedDelaunayTriangulation<_>| {
            cut.insert(Point2::new(p.x, p.y)).expect("coordinates are finite")
        };
        for corners in loops {
            let ids: Vec<_> = corners.iter().map(|p| insert(p, &mut cut)).collect();
            ids.iter().zip(ids.iter().cycle().skip(1)).for_each(|(&a, &b)| {
                cut.add_constraint(a, b);
            });
        }
        inside.iter().for_each(|p| {
            insert(p, &mut cut);
        });
        for face in cut.inner_faces() {
            let mut corners = face.positions().map(|p| DVec2::new(p.x, p.y));
            if enclosed(loops, (corners[0] + corners[1] + corners[2]) / 3.0) {
                if !up {
                    corners.swap(1, 2);
                }
                self.triangle(corners.map(|p| p.extend(height)));
            }
        }
    }

    /// A flat region between two heights; the first loop is its outline, the others are holes.
    pub fn extruded(&mut self, loops: &[Loop], inside: &[DVec2], heights: [f64; 2], rows: usize) {
        for (index, corners) in loops.iter().enumerate() {
            self.wall(&if index == 0 { corners.clone() } else { reversed(corners) }, heights, rows);
        }
        self.flat(loops, inside, heights[0], false);
        self.flat(loops, inside, heights[1], true);
    }

    pub fn add(&mut self, other: &Self, offset: DVec3) {
        let first = self.points.len() as u32;
        self.points.extend(other.points.iter().map(|p| p + offset));
        self.triangles.extend(other.triangles.iter().map(|t| t.map(|v| v + first)));
    }

    pub fn mapped(mut self, map: impl Fn(DVec3) -> DVec3) -> Self {
        self.points.iter_mut().for_each(|p| *p = map(*p));
        self
    }

    /// Points at one place are one; triangles that have one twice are dropped.
    pub fn welded(self) -> Self {
        let mut known = BTreeMap::new();
        let mut points = Vec::new();
        let mut number = |p: &DVec3| {
            *known.entry(p.to_array().map(|x| (x / WELDED).round() as i64)).or_insert_with(|| {
                points.push(*p);
                points.len() as u32 - 1
            })
        };
        let numbers: Vec<u32> = self.points.iter().map(&mut number).collect();
        let triangles = self.triangles.iter().map(|t| t.map(|v| numbers[v as usize]));
        let triangles = triangles.filter(|[a, b, c]| a != b && b != c && c != a).collect();
        Self { points, triangles }
    }

    /// The lowest and the highest coordinates.
    pub fn bounds(&self) -> [DVec3; 2] {
        let fold = |by: fn(DVec3, DVec3) -> DVec3| self.points.iter().copied().reduce(by).unwrap_or_default();
        [fold(DVec3::min), fold(DVec3::max)]
    }

    /// As a soup: welded, and at random turned, scaled and moved.
    pub fn placed(self, random: &mut Random) -> Soup {
        let welded = self.welded();
        let turn = if random.chance(0.5) { DMat3::IDENTITY } else { rotation(random) };
        let scale = if random.chance(0.5) { 1.0 } else { random.scale(1e-2, 1e3) };
        let points = welded.points.iter().map(|p| (turn * (p * scale)).to_array()).collect();
        Soup { points, triangles: welded.triangles, ..Soup::default() }
    }
}

pub fn rotation(random: &mut Random) -> DMat3 {
    DMat3::from_rotation_z(random.real(0.0, TAU))
        * DMat3::from_rotation_x(random.real(0.0, TAU))
        * DMat3::from_rotation_y(random.real(0.0, TAU))
}

pub fn reversed(corners: &Loop) -> Loop {
    corners.iter().rev().copied().collect()
}

/// Whether an odd number of loops is round a point.
pub fn enclosed(loops: &[Loop], p: DVec2) -> bool {
    let crossings = loops.iter().flat_map(|corners| corners.iter().zip(corners.iter().cycle().skip(1)));
    let right =
        |(a, b): &(&DVec2, &DVec2)| (a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y);
    crossings.filter(right).count() % 2 == 1
}

/// The distance of a point from the sides of a loop.
pub fn distance(p: DVec2, corners: &Loop) -> f64 {
    let sides = corners.iter().zip(corners.iter().cycle().skip(1));
    let to_side = |(a, b): (&DVec2, &DVec2)| {
        let along = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
        p.distance(a + (b - a) * along)
    };
    sides.map(to_side).fold(f64::MAX, f64::min)
}

/// Points of a shaken grid of a step within loops, half a step from them.
pub fn filling(loops: &[Loop], step: f64, random: &mut Random) -> Vec<DVec2> {
    let corners = || loops.iter().flatten().copied();
    let low = corners().reduce(DVec2::min).unwrap_or_default();
    let high = corners().reduce(DVec2::max).unwrap_or_default();
    let [columns, rows] = ((high - low) / step).to_array().map(|x| x as usize);
    let cells = (0..rows).flat_map(|j| (0..columns).map(move |i| DVec2::new(i as f64, j as f64)));
    let shaken = cells.map(|cell| low + step * (cell + DVec2::new(random.real(0.2, 0.8), random.real(0.2, 0.8))));
    let far = |p: &DVec2| loops.iter().all(|corners| distance(*p, corners) > step / 2.0);
    shaken.filter(|p| enclosed(loops, *p) && far(p)).collect()
}

pub fn circle(centre: DVec2, radius: f64, count: usize) -> Loop {
    (0..count).map(|i| centre + radius * DVec2::from_angle(TAU * (i as f64 + 0.137) / count as f64)).collect()
}
