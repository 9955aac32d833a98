//! Triangulates single polygons, so that concave faces of a file keep their outline.

use earcut::Earcut;
use glam::{DVec2, DVec3};
use rstar::RTree;
use rstar::primitives::Line;
use rustc_hash::FxHashSet;

/// What counts as zero when the polygon's extent is one: some thousand roundings.
const TINY: f64 = 1e-12;

/// Most corners of a polygon that may cross itself and yet is split: `earcut` then takes up to their cube in time.
const MOST_CROSSING: usize = 2_000;

/// Splits a polygon with `corners.len()` >= 3 corners into `corners.len() - 2` triangles of its corners' places, oriented
/// as the polygon is. Works in the plane the polygon fits best (Newell's normal). A polygon that is not simple there still
/// gives that many triangles, some of them degenerate or folded.
///
/// Quads are split at their best shaped ear, larger polygons by the crate `earcut`; edges between their triangles are then
/// flipped to the Delaunay triangulation.
pub fn triangulate(corners: &[DVec3]) -> Vec<[usize; 3]> {
    let count = corners.len();
    let split = match flattened(corners) {
        Some(points) if count == 4 => Some(quad(&points)),
        Some(points) if count > 4 => clipped(&points),
        _ => None,
    };
    split.unwrap_or_else(|| (2..count).map(|place| [0, place - 1, place]).collect())
}

/// The corners in the best plane, counter-clockwise, with extent one; none if the polygon has no area.
fn flattened(corners: &[DVec3]) -> Option<Vec<DVec2>> {
    let origin = corners[0];
    let extent = corners.iter().map(|corner| (*corner - origin).abs().max_element()).fold(0.0, f64::max);
    let local: Vec<_> = corners.iter().map(|corner| (*corner - origin) / extent).collect();
    let next = local.iter().cycle().skip(1);
    let normal: DVec3 = local.iter().zip(next).map(|(a, b)| a.cross(*b)).sum();
    if normal.is_nan() || normal.length() < TINY {
        return None;
    }
    let normal = normal.normalize();
    let along = normal.any_orthonormal_vector();
    let across = normal.cross(along);
    Some(local.iter().map(|point| DVec2::new(point.dot(along), point.dot(across))).collect())
}

/// A quad as two triangles: that at its best shaped ear and the rest.
fn quad(points: &[DVec2]) -> Vec<[usize; 3]> {
    let turn = |[a, b, c]: [usize; 3]| (points[b] - points[a]).perp_dot(points[c] - points[a]);
    let is_ear = |triangle: [usize; 3]| {
        let [a, b, c] = triangle.map(|place| points[place]);
        let covers = |point: DVec2| {
            ![a, b, c].contains(&point)
                && [(a, b), (b, c), (c, a)].iter().all(|(from, to)| (to - from).perp_dot(point - from) >= -TINY)
        };
        turn(triangle) > TINY && !points.iter().any(|&point| covers(point))
    };
    // Twice the area over the longest side squared; of corners that are no ears, the most convex is the best.
    let shape = |triangle: [usize; 3]| {
        let [a, b, c] = triangle.map(|place| points[place]);
        let longest = [a.distance_squared(b), b.distance_squared(c), c.distance_squared(a)];
        let shape = turn(triangle) / longest.into_iter().fold(0.0, f64::max);
        if is_ear(triangle) { (true, shape) } else { (false, turn(triangle)) }
    };
    let best = |places: &[usize]| {
        let count = places.len();
        let around = |slot: usize| [(slot + count - 1) % count, slot, (slot + 1) % count].map(|slot| places[slot]);
        let shapes = (0..count).map(|slot| (around(slot), shape(around(slot))));
        let best = shapes.max_by(|(_, a), (_, b)| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        best.map(|(triangle, _)| triangle).unwrap_or_default()
    };
    let ear = best(&[0, 1, 2, 3]);
    let rest: Vec<usize> = (0..4).filter(|&place| place != ear[1]).collect();
    vec![ear, best(&rest)]
}

/// The triangles of a polygon; `None` if it is not simple, so that there are too few or too many.
fn clipped(points: &[DVec2]) -> Option<Vec<[usize; 3]>> {
    let coordinates: Vec<[f64; 2]> = points.iter().map(|point| point.to_array()).collect();
    if points.len() > MOST_CROSSING && crosses_itself(&coordinates) {
        return None;
    }
    let mut places = Vec::new();
    Earcut::new().earcut_slice(&coordinates, &[], &mut places);
    let mut triangles = with_all_corners(places.as_chunks().0.to_vec(), points.len())?;
    // The first tells `refine` which way all are wound: it must not be one whose area is but a rounding.
    let area = |&[a, b, c]: &[usize; 3]| (points[b] - points[a]).perp_dot(points[c] - points[a]);
    let largest = (0..triangles.len()).max_by(|&s, &t| area(&triangles[s]).total_cmp(&area(&triangles[t])))?;
    triangles.swap(0, largest);
    earcut::refine(triangles.as_flattened_mut(), &coordinates);
    Some(triangles)
}

/// Whether two sides cross, each at an inner point.
fn crosses_itself(points: &[[f64; 2]]) -> bool {
    let next = points.iter().cycle().skip(1);
    let sides = RTree::bulk_load(points.iter().zip(next).map(|(&from, &to)| Line::new(from, to)).collect());
    let apart = |side: &Line<[f64; 2]>, other: &Line<[f64; 2]>| {
        let [from, to, a, b] = [side.from, side.to, other.from, other.to].map(DVec2::from);
        let [a, b] = [a, b].map(|end| (to - from).perp_dot(end - from));
        a.min(b) < -TINY && a.max(b) > TINY
    };
    sides.intersection_candidates_with_other_tree(&sides).any(|(a, b)| apart(a, b) && apart(b, a))
}

/// The triangles that `earcut` gives, with the corners that it leaves out: those on another corner, or on a straight line.
/// A triangle with a side that passes some of them by becomes a fan. `None` if that does not make `count - 2` triangles.
fn with_all_corners(triangles: Vec<[usize; 3]>, count: usize) -> Option<Vec<[usize; 3]>> {
    let missing = (count - 2).checked_sub(triangles.len())?;
    if missing == 0 {
        return Some(triangles);
    }
    let sides = |[a, b, c]: [usize; 3]| [[a, b, c], [b, c, a], [c, a, b]];
    let steps = |[from, to]: [usize; 2]| (to + count - from) % count;
    let mut left = triangles;
    let all: FxHashSet<_> = left.iter().flat_map(|&triangle| sides(triangle)).map(|[a, b, _]| [a, b]).collect();
    let outer = all.iter().filter(|&&[a, b]| !all.contains(&[b, a]));
    let mut passing: FxHashSet<_> = outer.filter(|&&side| steps(side) > 1).copied().collect();
    if passing.iter().map(|&side| steps(side) - 1).sum::<usize>() != missing {
        return None;
    }
    let mut whole = Vec::with_capacity(count - 2);
    while let Some(triangle) = left.pop() {
        match sides(triangle).into_iter().find(|&[from, to, _]| passing.remove(&[from, to])) {
            None => whole.push(triangle),
            Some([from, to, tip]) => {
                let corner = |step: usize| (from + step) % count;
                left.extend((0..steps([from, to])).map(|step| [tip, corner(step), corner(step + 1)]));
            }
        }
    }
    Some(whole)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sum of the areas and smallest signed area, seen along `normal`.
    fn areas(corners: &[DVec3], triangles: &[[usize; 3]], normal: DVec3) -> (f64, f64) {
        let area = |triangle: &[usize; 3]| {
            let [a, b, c] = triangle.map(|place| corners[place]);
            0.5 * (b - a).cross(c - a).dot(normal)
        };
        triangles.iter().map(area).fold((0.0, f64::INFINITY), |(sum, least), area| (sum + area, least.min(area)))
    }

    fn polygon(corners: &[[f64; 2]]) -> Vec<DVec3> {
        corners.iter().map(|&[x, y]| DVec3::new(x, y, 0.0)).collect()
    }

    #[test]
    fn outlines_are_kept_from_every_first_corner() {
        let shapes: [(&[[f64; 2]], f64); 5] = [
            (&[[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [2.0, 1.0], [0.0, 4.0]], 10.0),
            (&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]], 4.0),
            (&[[0.0, 0.0], [3.0, 0.0], [1.0, 1.0], [0.0, 3.0]], 3.0),
            // A spiral.
            (
                &[
                    [0.0, 0.0],
                    [5.0, 0.0],
                    [5.0, 5.0],
                    [1.0, 5.0],
                    [1.0, 2.0],
                    [3.0, 2.0],
                    [3.0, 3.0],
                    [2.0, 3.0],
                    [2.0, 4.0],
                    [4.0, 4.0],
                    [4.0, 1.0],
                    [0.0, 1.0],
                ],
                15.0,
            ),
            // A square with a square hole, joined by a slit.
            (
                &[
                    [0.0, 0.0],
                    [3.0, 0.0],
                    [3.0, 3.0],
                    [0.0, 3.0],
                    [0.0, 0.0],
                    [1.0, 1.0],
                    [1.0, 2.0],
                    [2.0, 2.0],
                    [2.0, 1.0],
                    [1.0, 1.0],
                ],
                8.0,
            ),
        ];
        for (shape, exact) in shapes {
            let mut corners = polygon(shape);
            for _ in 0..corners.len() {
                corners.rotate_left(1);
                let triangles = triangulate(&corners);
                assert_eq!(triangles.len(), corners.len() - 2);
                let (sum, least) = areas(&corners, &triangles, DVec3::Z);
                assert!((sum - exact).abs() < 1e-12 && least > 0.0, "{corners:?}: {sum}, {least}");
            }
        }
    }

    /// A ladder is split at its rungs.
    #[test]
    fn triangles_are_well_shaped() {
        let outline: Vec<[f64; 2]> = (0..30).map(|step| [f64::from(step), 0.0]).collect();
        let back = outline.iter().rev().map(|&[x, _]| [x, 1.0]);
        let corners = polygon(&outline.iter().copied().chain(back).collect::<Vec<_>>());
        let longest = |triangles: &[[usize; 3]]| {
            let sides = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
            sides.map(|[a, b]| corners[a].distance(corners[b])).fold(0.0, f64::max)
        };
        assert!(longest(&triangulate(&corners)) < 1.5);
        let fan: Vec<[usize; 3]> = (2..60).map(|place| [0, place - 1, place]).collect();
        assert!(longest(&fan) > 29.0);
    }

    /// `earcut` leaves doubled corners out.
    #[test]
    fn doubled_corners_stay_and_the_outline_too() {
        let shape = [[0.0, 0.0], [4.0, 0.0], [4.0, 0.0], [4.0, 4.0], [2.0, 1.0], [2.0, 1.0], [0.0, 4.0]];
        let mut corners = polygon(&shape);
        for _ in 0..corners.len() {
            corners.rotate_left(1);
            let triangles = triangulate(&corners);
            let (sum, least) = areas(&corners, &triangles, DVec3::Z);
            assert_eq!(triangles.len(), 5);
            assert!((sum - 10.0).abs() < 1e-12 && least == 0.0, "{triangles:?}: {sum}, {least}");
        }
        let points: Vec<[f64; 2]> = shape.to_vec();
        let mut places: Vec<usize> = Vec::new();
        Earcut::new().earcut_slice(&points, &[], &mut places);
        assert!(places.len() < 3 * 5, "all corners: this test is about nothing");
    }

    #[test]
    fn only_crossing_sides_cross() {
        let circle = |turns: f64| -> Vec<[f64; 2]> {
            let angle = |step: i32| turns * std::f64::consts::TAU * f64::from(step) / 3_001.0;
            (0..3_001).map(|step| [angle(step).cos(), angle(step).sin()]).collect()
        };
        assert!(!crosses_itself(&circle(1.0)));
        assert!(crosses_itself(&circle(2.0)), "no two corners are the same");
        let slit = [
            [0.0, 0.0],
            [3.0, 0.0],
            [3.0, 3.0],
            [0.0, 3.0],
            [0.0, 0.0],
            [1.0, 1.0],
            [1.0, 2.0],
            [2.0, 1.0],
            [1.0, 1.0],
        ];
        assert!(!crosses_itself(&slit));
    }

    #[test]
    fn a_fan_would_fold() {
        let corners = polygon(&[[4.0, 0.0], [4.0, 4.0], [2.0, 1.0], [0.0, 4.0], [0.0, 0.0]]);
        assert!(areas(&corners, &[[0, 1, 2], [0, 2, 3], [0, 3, 4]], DVec3::Z).1 < 0.0);
    }

    #[test]
    fn tilted_tiny_and_far_polygons_keep_their_outline() {
        let (along, across) = (DVec3::new(0.6, 0.0, 0.8), DVec3::new(0.0, 1.0, 0.0));
        for (scale, offset) in [(1.0, 1e6), (1e-30, 0.0), (1e30, 0.0)] {
            let corners: Vec<_> = polygon(&[[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [2.0, 1.0], [0.0, 4.0]])
                .iter()
                .map(|point| scale * (point.x * along + point.y * across) + offset)
                .collect();
            let (sum, least) = areas(&corners, &triangulate(&corners), along.cross(across));
            // A coordinate of 1e6 carries an error of 1e-10.
            assert!((sum / scale / scale - 10.0).abs() < 1e-8 && least > 0.0, "{scale}, {offset}: {sum}");
        }
    }

    #[test]
    fn polygons_without_area_give_as_many_triangles() {
        assert_eq!(triangulate(&[DVec3::ONE; 5]).len(), 3);
        assert_eq!(triangulate(&polygon(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]])).len(), 2);
        assert_eq!(triangulate(&polygon(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [1.5, 0.0]])).len(), 2);
    }
}
