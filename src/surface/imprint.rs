//! Joins rims (open boundaries) to the sheets that they touch.
//!
//! # Theory
//! Chew, "Constrained Delaunay triangulations", 1989, by the crate `spade`: a triangle that rims touch is triangulated anew with the
//! rims' edges among its own.
//!
//! # Practice
//! A vertex of a rim that lies on a triangle becomes a vertex of that, inside it or in its sides. Where a rim crosses a side, both
//! get a new vertex. Sheets then have edges of more than two triangles in common. Only rims are joined: closed walls that lie on
//! each other, and sheets that pass through each other, stay as they are. No vertex moves.

use super::boxes::{Bounds, Boxes};
use super::cuts::{Cuts, sorted};
use super::edges::{Edges, sides};
use super::nearest::{nearest_on_segment, squared_distance};
use super::weld::Welded;
use glam::{DVec3, Vec3};
use rustc_hash::FxHashMap;

/// Joins rims to triangles no farther than `tolerance` from them, in diagonals; welded points are farther apart than that.
pub(super) fn imprint(welded: &mut Welded, tolerance: f64) {
    let edges = Edges::new(&welded.triangles);
    let rims = edges.open();
    let single: Vec<Vec3> = welded.points.iter().map(|p| p.as_vec3()).collect();
    let boxes = Boxes::new(&single, &welded.triangles);
    let Welded { frame, points, triangles, repairs, .. } = &mut *welded;
    let near = |ends: &[DVec3]| {
        let ends: Vec<Vec3> = ends.iter().map(|p| p.as_vec3()).collect();
        let mut near = boxes.meeting(&Bounds::of(&ends).grown(2.0 * tolerance as f32));
        near.sort_unstable();
        near
    };
    let mut cuts = Cuts::default();
    let mut crossings: FxHashMap<[[u32; 2]; 2], u32> = FxHashMap::default();
    let beside: Vec<Vec<u32>> = rims.iter().map(|rim| near(&rim.map(|v| points[v as usize]))).collect();
    for (rim, beside) in rims.iter().zip(&beside) {
        for side in beside.iter().flat_map(|&t| sides(triangles[t as usize])) {
            if side.iter().any(|v| rim.contains(v)) {
                continue;
            }
            let [[p, q], [a, b]] = [*rim, side].map(|ends| ends.map(|v| points[v as usize]));
            let off = |point: DVec3, start, end| nearest_on_segment(point, start, end).distance(point);
            if [p, q].iter().any(|&end| off(end, a, b) <= tolerance) {
                continue;
            }
            let on_rim: Vec<u32> = side.into_iter().filter(|&v| off(points[v as usize], p, q) <= tolerance).collect();
            if !on_rim.is_empty() {
                on_rim.into_iter().for_each(|v| cuts.insert(*rim, v));
            } else if let Some(crossing) = crossing([p, q], [a, b]).filter(|[on, at]| on.distance(*at) <= tolerance) {
                let mut key = [sorted(*rim), sorted(side)];
                key.sort_unstable();
                let vertex = *crossings.entry(key).or_insert_with(|| {
                    points.push(crossing[1]);
                    points.len() as u32 - 1
                });
                cuts.insert(*rim, vertex);
                cuts.insert(side, vertex);
            }
        }
    }
    let mut vertices: Vec<u32> = rims.as_flattened().iter().chain(crossings.values()).copied().collect();
    vertices.sort_unstable();
    vertices.dedup();
    for vertex in vertices {
        let place = points[vertex as usize];
        for t in near(&[place]) {
            let triangle = triangles[t as usize];
            let corners = triangle.map(|v| points[v as usize]);
            if triangle.contains(&vertex) || squared_distance(place, corners) > tolerance * tolerance {
                continue;
            }
            let side = sides(triangle).into_iter().find(|side| {
                let [start, end] = side.map(|v| points[v as usize]);
                nearest_on_segment(place, start, end).distance(place) <= tolerance
            });
            match side {
                Some(side) => cuts.insert(side, vertex),
                None => cuts.insert_inside(t, vertex),
            }
        }
    }
    cuts.sort(points);
    for (rim, beside) in rims.iter().zip(&beside) {
        let chain = [vec![rim[0]], cuts.between(rim[0], rim[1]), vec![rim[1]]].concat();
        let mut joined = chain.len() > 2;
        for &t in beside {
            if rim.iter().all(|v| triangles[t as usize].contains(v)) {
                continue;
            }
            for piece in chain.windows(2) {
                joined |= cuts.insert_segment(t, triangles[t as usize], [piece[0], piece[1]]);
            }
        }
        if joined {
            let [a, b] = rim.map(|v| points[v as usize]);
            repairs.imprinted_edges.note(|| frame.near(a.midpoint(b).into()));
        }
    }
    cuts.apply(welded);
}

/// The nearest points of the lines of two segments, where each lies inside its segment.
fn crossing([p, q]: [DVec3; 2], [a, b]: [DVec3; 2]) -> Option<[DVec3; 2]> {
    let (u, v, w) = (q - p, b - a, p - a);
    let (uu, uv, vv, uw, vw) = (u.dot(u), u.dot(v), v.dot(v), u.dot(w), v.dot(w));
    // The square of the sine of their angle, times the squares of their lengths.
    let parallel = uu * vv - uv * uv;
    if parallel <= 1e-12 * uu * vv {
        return None;
    }
    let [s, t] = [(uv * vw - vv * uw) / parallel, (uu * vw - uv * uw) / parallel];
    ((0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t)).then(|| [p + u * s, a + v * t])
}
