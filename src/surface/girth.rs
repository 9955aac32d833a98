//! The girth of thin parts: the length of the shortest way round a rod, a tube or a narrow hole.
//!
//! # Theory
//! The way round is a closed geodesic. From a point a straight walk over the surface leaves in each of some directions. Where the
//! surface is closed in that direction within the walk, the walk passes places where the surface looks the other way, and comes
//! back to the point from behind. On a tube a walk that is off the way round by an angle comes back beside the point, by the
//! girth times its tangent. On the tip of a cone walks come back in another direction, so it has no girth.

use super::turning::WithoutBarriers;
use super::walk::{WALK_EDGES, walk_through};
use super::{Surface, SurfacePoint};
use crate::geometry::{cells_around, cross, unit};
use crate::progress::{ASKED_EVERY, IsCancelled, until_cancelled};
use glam::{IVec3, Vec3};
use rayon::prelude::*;
use rustc_hash::{FxHashMap, FxHashSet};
use std::f32::consts::PI;

/// The directions of walks, over half a turn.
const DIRECTIONS: u32 = 8;
/// A walk comes back where it passes the point nearer than this share of its length: the tangent of the largest angle between a
/// way round and the nearest direction, and a margin for noise.
const BESIDE: f32 = 0.25;
/// The cosine of the largest angle between the start and the end of a walk that comes back.
const AHEAD: f32 = 0.9;
/// The normals of the start and the end of such a walk agree by this cosine.
const ALIKE: f32 = 0.7;
/// A walk that goes round passes a normal that opposes that of its start by this cosine.
const OPPOSED: f32 = -0.5;
/// A shorter way round, in tile sides, is that of a slit or of triangles without height: no tile is as small.
const SHORTEST: f32 = 0.01;
/// The distance between points that are tested, in tile sides.
const SPACING: f32 = 1.0 / 3.0;

/// The girth at each vertex, in unit-sized coordinates, where it is at most `most`; infinity elsewhere.
pub(crate) fn girths(surface: &Surface, most: f32, side: f32, is_cancelled: &IsCancelled) -> Vec<f64> {
    let mut girths = vec![f64::INFINITY; surface.vertex_count()];
    let tested = spread(surface, SPACING * side, most, is_cancelled);
    let found = |&triangle: &u32| if is_cancelled() { f32::INFINITY } else { girth(surface, triangle, most) };
    let found: Vec<f32> = tested.par_iter().with_min_len(64).map(found).collect();
    for (&triangle, girth) in tested.iter().zip(found).filter(|(_, girth)| *girth > SHORTEST * side) {
        for v in surface.triangles[triangle as usize] {
            girths[v as usize] = girths[v as usize].min(f64::from(girth));
        }
    }
    girths
}

/// One triangle of each cell of this size and each octant of normals, of those that have an opposite within half of `most`.
fn spread(surface: &Surface, cell: f32, most: f32, is_cancelled: &IsCancelled) -> Vec<u32> {
    let directions = Directions::new();
    let (middles, kinds): (Vec<Vec3>, Vec<u32>) = (0..surface.triangle_count() as u32)
        .into_par_iter()
        .map(|t| (middle(surface, t), directions.nearest(surface.normal(t as usize))))
        .unzip();
    let at = |p: Vec3, size: f32| (p / size).floor().as_ivec3();
    // Two points on opposite sides are no farther apart than half the girth.
    let reach = most / 2.0;
    let mut seen_in: FxHashMap<IVec3, u32> = FxHashMap::default();
    for (t, kind) in kinds.iter().enumerate() {
        if t.is_multiple_of(ASKED_EVERY) && is_cancelled() {
            return Vec::new();
        }
        // A large triangle passes several cells: lines along its longest side.
        let corners = surface.corners(t);
        let length = |k: usize| corners[k].distance(corners[(k + 1) % 3]);
        let longest = (0..3).max_by(|&i, &j| length(i).total_cmp(&length(j))).unwrap_or(0);
        let [a, b, c] = [0, 1, 2].map(|k| corners[(longest + k) % 3]);
        let height = surface.double_area(t) / length(longest).max(f32::MIN_POSITIVE);
        let parts = |length: f32| (length / reach).ceil().max(1.0);
        let (along, across) = (parts(length(longest)), parts(height));
        for i in 0..across as u32 {
            let [from, to] = [a, b].map(|end| end.lerp(c, (i as f32 + 0.5) / across));
            for j in 0..along as u32 {
                *seen_in.entry(at(from.lerp(to, (j as f32 + 0.5) / along), reach)).or_default() |= 1 << kind;
            }
        }
    }
    let has_opposite = |t: u32| {
        let opposed = directions.opposed[kinds[t as usize] as usize];
        let mut near = cells_around(at(middles[t as usize], reach)).filter_map(|cell| seen_in.get(&cell));
        near.any(|seen| seen & opposed != 0)
    };
    let mut seen = FxHashSet::default();
    let is_first = |&t: &u32| {
        let n = surface.normal(t as usize);
        seen.insert((at(middles[t as usize], cell), [n.x > 0.0, n.y > 0.0, n.z > 0.0]))
    };
    let all = until_cancelled(0..surface.triangle_count() as u32, is_cancelled);
    let spread: Vec<u32> = all.filter(is_first).collect();
    until_cancelled(spread.into_iter(), is_cancelled).filter(|&t| has_opposite(t)).collect()
}

/// The 26 directions of a cube's faces, edges and corners.
struct Directions {
    units: Vec<Vec3>,
    /// Those that oppose each, for normals that are nearest to either.
    opposed: Vec<u32>,
}

impl Directions {
    /// The cosine of two of the directions that may stand for normals that oppose each other.
    const MAY_OPPOSE: f32 = -0.1;

    fn new() -> Self {
        let steps = [-1.0, 0.0, 1.0];
        let all =
            steps.into_iter().flat_map(|x| steps.into_iter().flat_map(move |y| steps.map(|z| Vec3::new(x, y, z))));
        let units: Vec<Vec3> = all.filter(|d| *d != Vec3::ZERO).map(unit).collect();
        let opposed = |d: &Vec3| {
            let opposes = units.iter().map(|e| u32::from(e.dot(*d) < Self::MAY_OPPOSE));
            (0..).zip(opposes).map(|(k, opposes)| opposes << k).sum()
        };
        Self { opposed: units.iter().map(opposed).collect(), units }
    }

    fn nearest(&self, normal: Vec3) -> u32 {
        let of = |k: &u32| self.units[*k as usize].dot(normal);
        (0..self.units.len() as u32).max_by(|a, b| of(a).total_cmp(&of(b))).unwrap_or(0)
    }
}

fn middle(surface: &Surface, triangle: u32) -> Vec3 {
    surface.corners(triangle as usize).iter().sum::<Vec3>() / 3.0
}

/// The girth at the middle of a triangle; infinity where it is more than `most`.
fn girth(surface: &Surface, triangle: u32, most: f32) -> f32 {
    let start = SurfacePoint { triangle, position: middle(surface, triangle) };
    let normal = surface.normal(triangle as usize);
    let [a, b, _] = surface.corners(triangle as usize);
    let x = unit(b - a);
    let y = cross(normal, x);
    (0..DIRECTIONS).fold(f32::INFINITY, |least, k| {
        let (sine, cosine) = (PI * k as f32 / DIRECTIONS as f32).sin_cos();
        least.min(way_round(surface, start, normal, x * cosine + y * sine, least.min(most)))
    })
}

/// The length of the walk in a direction until it comes back; infinity where it does not within `most`.
fn way_round(surface: &Surface, start: SurfacePoint, normal: Vec3, direction: Vec3, most: f32) -> f32 {
    let (mut length, mut from, mut is_round, mut least) = (0.0, start.position, false, f32::INFINITY);
    walk_through(&WithoutBarriers(surface), start.triangle, start.position, direction * most, WALK_EDGES, |passed| {
        let agreement = passed.normal.dot(normal);
        is_round |= agreement < OPPOSED;
        let step = passed.to - from;
        let heading = unit(passed.heading);
        if is_round && agreement > ALIKE && heading.dot(direction) > AHEAD {
            let ahead = (start.position - from).dot(heading).clamp(0.0, step.length());
            let beside = start.position.distance(from + heading * ahead);
            let whole = length + ahead;
            if beside < BESIDE * whole && ahead < step.length() {
                least = whole;
            }
        }
        length += step.length();
        from = passed.to;
        // What is left may be too short to come back.
        least.is_infinite() && start.position.distance(from) < BESIDE * most + most - length
    });
    least
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::{FeatureOptions, Soup};
    use std::f64::consts::TAU;

    /// Closed rings of points, one after the other, joined by triangles.
    fn rings(rings: &[Vec<[f64; 3]>]) -> Surface {
        let count = rings[0].len() as u32;
        let at = |ring: u32, i: u32| ring * count + i % count;
        let cell =
            |r: u32, i: u32| [[at(r, i), at(r, i + 1), at(r + 1, i + 1)], [at(r, i), at(r + 1, i + 1), at(r + 1, i)]];
        let triangles = (0..rings.len() as u32 - 1).flat_map(|r| (0..count).flat_map(move |i| cell(r, i))).collect();
        let soup = Soup { points: rings.concat(), triangles, ..Soup::default() };
        Surface::new(&soup, &FeatureOptions::default()).unwrap_or_else(|error| panic!("{error}"))
    }

    fn circle(radius: f64, sectors: u32, z: f64) -> Vec<[f64; 3]> {
        let angle = |i: u32| TAU * f64::from(i) / f64::from(sectors);
        (0..sectors).map(|i| [radius * angle(i).cos(), radius * angle(i).sin(), z]).collect()
    }

    /// The girths that are found where `most` and `side` are in model units; infinite ones are left out.
    fn found(surface: &Surface, most: f64, side: f64) -> Vec<f64> {
        let diagonal = surface.frame().diagonal;
        let girths = girths(surface, (most / diagonal) as f32, (side / diagonal) as f32, &|| false);
        girths.into_iter().filter(|girth| girth.is_finite()).map(|girth| girth * diagonal).collect()
    }

    #[test]
    fn the_girth_of_a_tube_is_the_length_round_it_whatever_its_triangles() {
        for (sectors, cells) in [(6, 1), (24, 1), (24, 40), (7, 10)] {
            let tube: Vec<_> =
                (0..=cells).map(|k| circle(1.0, sectors, 20.0 * f64::from(k) / f64::from(cells))).collect();
            let tube = rings(&tube);
            let polygon = 2.0 * f64::from(sectors) * (TAU / 2.0 / f64::from(sectors)).sin();
            let girths = found(&tube, 7.0, 2.0);
            // Not every triangle is tested.
            assert!(2 * girths.len() > tube.vertex_count(), "{sectors} sectors, {cells} cells");
            // A way that is off by 11 degrees is longer by 2 %.
            let is_right = |girth: &f64| (0.98 * polygon..1.05 * polygon).contains(girth);
            assert!(girths.iter().all(is_right), "{polygon}: {girths:?}");
            assert!(found(&tube, 0.9 * polygon, 2.0).is_empty(), "longer than the largest girth that is asked for");
        }
    }

    #[test]
    fn a_rod_of_rectangles_has_a_girth_and_a_plate_and_a_cone_have_none() {
        let rectangle = |z: f64| vec![[0.0, 0.0, z], [2.0, 0.0, z], [2.0, 1.0, z], [0.0, 1.0, z]];
        let girths = found(&rings(&[rectangle(0.0), rectangle(30.0)]), 7.0, 2.0);
        assert!(girths.len() == 8 && girths.iter().all(|girth| (5.9..6.3).contains(girth)), "{girths:?}");
        let wide = |z: f64| vec![[0.0, 0.0, z], [20.0, 0.0, z], [20.0, 1.0, z], [0.0, 1.0, z]];
        assert!(found(&rings(&[wide(0.0), wide(20.0)]), 7.0, 2.0).is_empty());
        let slant = |k: u32| 0.1 + f64::from(k);
        for half_angle in [10.0_f64, 20.0, 30.0] {
            let (sine, cosine) = half_angle.to_radians().sin_cos();
            let cone: Vec<_> = (0..20).map(|k| circle(slant(k) * sine, 32, -slant(k) * cosine)).collect();
            assert!(found(&rings(&cone), 7.0, 2.0).is_empty(), "{half_angle} degrees");
        }
    }
}
