//! Fills small holes: open boundary loops.
//!
//! # Theory
//! Barequet, Sharir, "Filling gaps in the boundary of a polyhedron", 1995: of all triangulations of a loop, that of least area is
//! found by dynamic programming over its spans, in time cubic in the number of vertices.
//!
//! # Practice
//! Sides of triangles count a little beside their area, so that a flat hole gets compact triangles. No triangle's side is an edge
//! that the surface has already. Long loops are triangulated in the plane that they fit best. The outline of an open sheet is a
//! loop too: it stays open where its filling would be about as large as the sheet itself.

use super::edges::{Edges, sides};
use super::parts::Parts;
use super::polygon;
use super::weld::Welded;
use glam::DVec3;

/// The most vertices of a loop that is filled with the triangulation of least area.
const MOST_EXACT: usize = 200;
/// The weight of the sum of a triangle's squared sides beside its area.
const COMPACTNESS: f64 = 0.02;
/// A loop whose filling has a larger share of its part's area is the outline of a sheet.
const OUTLINE: f64 = 0.7;

/// Fills the open boundary loops with a bounding box whose diagonal is below `limit`.
pub(super) fn fill(welded: &mut Welded, limit: f64) {
    let Welded { frame, points, triangles, sources, repairs } = welded;
    let parts = Parts::new(points, triangles);
    let mut areas = vec![0.0; parts.count()];
    for (corners, &part) in triangles.iter().zip(&parts.of_triangle) {
        areas[part as usize] += area(corners.map(|v| points[v as usize]));
    }
    let mut edges = Edges::new(triangles);
    for mut hole in edges.loops() {
        let beside = edges.triangle_at(hole[0], hole[1]);
        if sides(triangles[beside as usize]).contains(&[hole[0], hole[1]]) {
            // The filling is oriented as the triangle beside it.
            hole.reverse();
        }
        let corners: Vec<DVec3> = hole.iter().map(|&v| points[v as usize]).collect();
        let low = corners.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let high = corners.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        if low.distance(high) >= limit {
            continue;
        }
        let filling = filling(&corners, |i, j| edges.are_joined(hole[i], hole[j]));
        let middle = corners.iter().sum::<DVec3>() / corners.len() as f64;
        let place = |k: usize| corners.get(k).copied().unwrap_or(middle);
        let filled: f64 = filling.iter().map(|triangle| area(triangle.map(place))).sum();
        if filled > OUTLINE * areas[parts.of_triangle[beside as usize] as usize] {
            continue;
        }
        let new = points.len() as u32;
        if filling.iter().flatten().any(|&k| k == hole.len()) {
            points.push(middle);
        }
        let vertex = |k: usize| hole.get(k).copied().unwrap_or(new);
        for triangle in filling.iter().map(|triangle| triangle.map(vertex)) {
            edges.add(triangles.len() as u32, triangle);
            triangles.push(triangle);
        }
        sources.resize(triangles.len(), sources[beside as usize]);
        repairs.filled_holes.note(|| frame.near(middle.into()));
    }
}

fn area([a, b, c]: [DVec3; 3]) -> f64 {
    (b - a).cross(c - a).length() / 2.0
}

/// The triangles that fill a loop, whose index `corners.len()` is the middle of the corners. `joined` tells which corners,
/// not beside each other in the loop, have an edge between them already.
fn filling(corners: &[DVec3], joined: impl Fn(usize, usize) -> bool) -> Vec<[usize; 3]> {
    let count = corners.len();
    let found = if count <= MOST_EXACT {
        least_area(corners, &joined)
    } else {
        let flat = polygon::triangulate(corners);
        let beside = |i: usize, j: usize| i.abs_diff(j) == 1 || i.abs_diff(j) == count - 1;
        let free =
            |&[a, b, c]: &[usize; 3]| [[a, b], [b, c], [c, a]].iter().all(|&[i, j]| beside(i, j) || !joined(i, j));
        flat.iter().all(free).then_some(flat)
    };
    found.unwrap_or_else(|| (0..count).map(|k| [k, (k + 1) % count, count]).collect())
}

/// The triangulation of least weight; `None` where each has a side that is an edge already.
fn least_area(corners: &[DVec3], joined: &impl Fn(usize, usize) -> bool) -> Option<Vec<[usize; 3]>> {
    let count = corners.len();
    let at = |i: usize, j: usize| i * count + j;
    // The least weight of the polygon from corner i to corner j, and the third corner of the triangle at its chord.
    let mut weights = vec![0.0; count * count];
    let mut tips = vec![0; count * count];
    for span in 2..count {
        for i in 0..count - span {
            let j = i + span;
            let mut best = (f64::INFINITY, i + 1);
            // The last chord, from the first corner to the last, is a side of the loop.
            if span + 1 == count || !joined(i, j) {
                for k in i + 1..j {
                    let sum = weights[at(i, k)] + weights[at(k, j)] + weight([corners[i], corners[k], corners[j]]);
                    if sum < best.0 {
                        best = (sum, k);
                    }
                }
            }
            (weights[at(i, j)], tips[at(i, j)]) = best;
        }
    }
    if weights[at(0, count - 1)] == f64::INFINITY {
        return None;
    }
    let mut triangles = Vec::with_capacity(count - 2);
    let mut spans = vec![(0, count - 1)];
    while let Some((i, j)) = spans.pop() {
        if j > i + 1 {
            let k = tips[at(i, j)];
            triangles.push([i, k, j]);
            spans.extend([(i, k), (k, j)]);
        }
    }
    Some(triangles)
}

fn weight([a, b, c]: [DVec3; 3]) -> f64 {
    area([a, b, c]) + COMPACTNESS * (a.distance_squared(b) + b.distance_squared(c) + c.distance_squared(a))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The least weight over all triangulations of the corners from `i` to `j`, tried one by one.
    fn least(corners: &[DVec3], i: usize, j: usize) -> f64 {
        if j == i + 1 {
            return 0.0;
        }
        let with =
            |k: usize| least(corners, i, k) + least(corners, k, j) + weight([corners[i], corners[k], corners[j]]);
        (i + 1..j).map(with).fold(f64::INFINITY, f64::min)
    }

    fn total(corners: &[DVec3], triangles: &[[usize; 3]]) -> f64 {
        triangles.iter().map(|triangle| weight(triangle.map(|k| corners[k]))).sum()
    }

    /// A loop that runs up and down as it goes round.
    fn wave(count: usize) -> Vec<DVec3> {
        let angle = |k: usize| std::f64::consts::TAU * k as f64 / count as f64;
        (0..count).map(|k| DVec3::new(angle(k).cos(), angle(k).sin(), 0.8 * (3.0 * angle(k)).sin())).collect()
    }

    #[test]
    fn the_filling_is_the_least_of_all() {
        for count in [3, 4, 7, 9] {
            let corners = wave(count);
            let found = filling(&corners, |_, _| false);
            assert_eq!(found.len(), count - 2);
            assert!((total(&corners, &found) - least(&corners, 0, count - 1)).abs() < 1e-12, "{count} corners");
        }
        let corners = wave(9);
        let fan: Vec<[usize; 3]> = (2..9).map(|k| [0, k - 1, k]).collect();
        assert!(total(&corners, &fan) > 1.05 * least(&corners, 0, 8), "any triangulation would do");
    }

    #[test]
    fn no_side_is_an_edge_already() {
        let corners = wave(8);
        let uses = |triangles: &[[usize; 3]], i, j| triangles.iter().any(|t| t.contains(&i) && t.contains(&j));
        let free = filling(&corners, |_, _| false);
        let inner = (0..8).flat_map(|i| (i + 2..8).map(move |j| (i, j))).filter(|&(i, j)| (i, j) != (0, 7));
        let (i, j) = inner.clone().find(|&(i, j)| uses(&free, i, j)).expect("an inner side");
        let other = filling(&corners, |a, b| (a.min(b), a.max(b)) == (i, j));
        assert!(!uses(&other, i, j) && other.len() == 6);
        // With no side left, all triangles meet in the middle.
        let star = filling(&corners, |_, _| true);
        assert!(star.len() == 8 && star.iter().all(|t| t.contains(&8)));
    }
}
