//! Unit tests of the intrinsic triangulation, and what those of its collapses share with them.

use super::*;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// A triangulation of points in the plane, its directions those of the plane.
pub fn plane(points: &[[f64; 2]], triangles: &[[u32; 3]]) -> Intrinsic {
    let mut faces = Intrinsic { leaving: vec![NONE; points.len()], ..Intrinsic::default() };
    let way = |a: u32, b: u32| {
        let ([ax, ay], [bx, by]) = (points[a as usize], points[b as usize]);
        [bx - ax, by - ay]
    };
    let mut at: BTreeMap<(u32, u32), u32> = BTreeMap::new();
    for &[a, b, c] in triangles {
        let h = faces.push_face([a, b, c]);
        for (e, [v, w, u]) in (h..).zip([[a, b, c], [b, c, a], [c, a, b]]) {
            let [first, last] = [way(v, w), way(v, u)];
            let begin = first[1].atan2(first[0]);
            let width = (last[1].atan2(last[0]) - begin).rem_euclid(TAU);
            faces.length[e as usize] = first[0].hypot(first[1]);
            faces.set_corner(e, begin, begin + width);
            faces.leaving[v as usize] = e;
            at.insert((v, w), e);
        }
    }
    for (&(v, w), &h) in &at {
        match at.get(&(w, v)) {
            Some(&twin) => faces.twin[h as usize] = twin,
            None => faces.curve[h as usize] = 0,
        }
    }
    faces
}

/// `n` by `n` cells, inner points pushed about.
pub fn patch(n: usize) -> (Intrinsic, Vec<[f64; 2]>) {
    let at = |i: usize, j: usize| (j * (n + 1) + i) as u32;
    let mut points = Vec::new();
    let mut triangles = Vec::new();
    for j in 0..=n {
        for i in 0..=n {
            let inner = (1..n).contains(&i) && (1..n).contains(&j);
            let push = |seed: usize| if inner { (seed * 7919 % 101) as f64 / 101.0 * 0.6 - 0.3 } else { 0.0 };
            points.push([i as f64 + push(17 * i + j + 1), j as f64 + push(31 * j + 5 * i + 2)]);
        }
    }
    for j in 0..n {
        for i in 0..n {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    (plane(&points, &triangles), points)
}

pub fn area(faces: &Intrinsic) -> f64 {
    (0..faces.face_count() as u32)
        .filter(|&f| faces.is_alive(f))
        .map(|f| {
            let [a, b, _] = [0, 1, 2].map(|k| faces.length[(3 * f + k) as usize]);
            a * b * faces.corner(3 * f + 1).sin() / 2.0
        })
        .sum()
}

/// Vertices, edges and faces that are there.
pub fn euler(faces: &Intrinsic) -> i64 {
    let alive = (0..faces.origin.len()).filter(|&h| faces.is_alive(h as u32 / 3));
    let (mut sides, mut open) = (0, 0);
    for h in alive {
        sides += 1;
        open += i64::from(faces.twin[h] == NONE);
    }
    let vertices = faces.leaving.iter().filter(|&&h| h != NONE).count() as i64;
    vertices - (sides + open) / 2 + sides / 3
}

/// What is wrong with the connectivity, the lengths or, inside, the directions.
pub fn faults(faces: &Intrinsic) -> Vec<String> {
    let mut faults = Vec::new();
    let mut ends = BTreeMap::new();
    for h in (0..faces.origin.len() as u32).filter(|&h| faces.is_alive(h / 3)) {
        let twin = faces.twin[h as usize];
        if ends.insert((faces.origin[h as usize], faces.target(h)), h).is_some() {
            faults.push(format!("half-edge {h} is not the only one between its ends"));
        }
        if twin != NONE {
            let mirrored = faces.twin[twin as usize] == h
                && faces.is_alive(twin / 3)
                && faces.origin[twin as usize] == faces.target(h)
                && faces.target(twin) == faces.origin[h as usize]
                && faces.curve[twin as usize] == faces.curve[h as usize];
            if !mirrored || (faces.length[h as usize] - faces.length[twin as usize]).abs() > 1e-12 {
                faults.push(format!("half-edges {h} and {twin} are no twins"));
            }
        }
        let around: f64 = [h, next(h), previous(h)].iter().map(|&e| faces.corner(e)).sum();
        if (around - PI).abs() > 1e-6 {
            faults.push(format!("the face of {h} does not close: {around}"));
        }
    }
    if !faults.is_empty() {
        // Where twins are wrong, walking round a vertex need not end.
        return faults;
    }
    let mut ring = Vec::new();
    for v in 0..faces.leaving.len() as u32 {
        let h = faces.leaving[v as usize];
        if h == NONE {
            continue;
        }
        if !faces.is_alive(h / 3) || faces.origin[h as usize] != v {
            faults.push(format!("vertex {v} has lost its half-edge"));
            continue;
        }
        let closed = faces.ring(v, &mut ring);
        let widths: f64 = ring.iter().map(|&h| faces.width(h)).sum();
        if closed && (widths - TAU).abs() > 1e-9 {
            faults.push(format!("the directions at vertex {v} span {widths}"));
        }
        if ring.iter().any(|&h| faces.origin[h as usize] != v) {
            faults.push(format!("the ring of vertex {v} leaves it"));
        }
        let first = usize::from(!closed);
        for i in first..ring.len() {
            let before = ring[(i + ring.len() - 1) % ring.len()];
            if faces.is_feature(ring[i]) {
                // Each side of a feature counts its directions from the feature.
                continue;
            }
            let gap = faces.begin[ring[i] as usize] - faces.end[before as usize];
            if (gap - (gap / TAU).round() * TAU).abs() > 1e-9 {
                faults.push(format!("a gap of {gap} in the directions at vertex {v}"));
            }
        }
    }
    faults
}

/// On a plane, the largest error of lengths and directions against the points.
pub fn against_plane(faces: &Intrinsic, points: &[[f64; 2]]) -> f64 {
    let mut worst = 0.0f64;
    for h in (0..faces.origin.len() as u32).filter(|&h| faces.is_alive(h / 3)) {
        let [[ax, ay], [bx, by]] = [faces.origin[h as usize], faces.target(h)].map(|v| points[v as usize]);
        let off = faces.begin[h as usize] - (by - ay).atan2(bx - ax);
        worst = worst.max((off - (off / TAU).round() * TAU).abs());
        worst = worst.max((faces.length[h as usize] - (bx - ax).hypot(by - ay)).abs());
    }
    worst
}

fn none() -> Vec<String> {
    Vec::new()
}

#[test]
fn the_faults_of_a_triangulation_are_seen() {
    let (whole, points) = patch(5);
    assert_eq!(faults(&whole), none());
    assert!(against_plane(&whole, &points) < 1e-12);
    // Leaves the first inner point of the second row.
    let inner = whole.leaving[7] as usize;
    let changes: [fn(&mut Intrinsic, usize); 4] = [
        |f, h| f.length[h] *= 1.01,
        |f, h| f.end[h] += 0.01,
        |f, h| f.twin[h] = f.twin[h + 2],
        |f, h| f.origin[h] += 1,
    ];
    for (i, change) in changes.into_iter().enumerate() {
        let mut broken = whole.clone();
        change(&mut broken, inner);
        assert_ne!(faults(&broken), none(), "change {i}");
    }
    let mut turned = whole.clone();
    turned.begin.iter_mut().for_each(|b| *b += 0.01);
    assert!(against_plane(&turned, &points) > 0.009);
}

#[test]
fn flipped_twice_an_edge_is_what_it_was() {
    let (mut faces, points) = patch(6);
    let state = |faces: &Intrinsic| -> BTreeMap<(u32, u32), [f64; 2]> {
        (0..faces.origin.len() as u32)
            .map(|h| {
                let turn = (faces.end[h as usize].sin(), faces.begin[h as usize].sin());
                ((faces.origin[h as usize], faces.target(h)), [faces.length[h as usize], turn.0 + 2.0 * turn.1])
            })
            .collect()
    };
    let before = state(&faces);
    let mut flipped = 0;
    for h in 0..faces.origin.len() as u32 {
        let ends = [faces.origin[h as usize], faces.target(h)];
        if !faces.flip(h) {
            continue;
        }
        flipped += 1;
        let new = h / 3 * 3 + 1;
        assert_ne!(state(&faces).keys().collect::<Vec<_>>(), before.keys().collect::<Vec<_>>());
        assert_eq!(faults(&faces), none());
        assert!(against_plane(&faces, &points) < 1e-9, "the other diagonal of a flat quad");
        assert!(!faces.joined(ends[0], ends[1]));
        assert!(faces.flip(new), "back");
        let after = state(&faces);
        for (key, was) in &before {
            let is = after.get(key).unwrap_or_else(|| panic!("edge {key:?} is gone"));
            assert!((is[0] - was[0]).abs() < 1e-9 && (is[1] - was[1]).abs() < 1e-9, "{key:?}: {is:?}, not {was:?}");
        }
    }
    assert!(flipped > 50, "{flipped}");
}

#[test]
fn what_cannot_be_flipped_stays() {
    // A quad with a reflex corner at 1, and the boundary.
    let points = [[0.0, 0.0], [1.0, 0.0], [2.0, 1.0], [2.0, -1.0]];
    let mut faces = plane(&points, &[[0, 1, 2], [1, 0, 3]]);
    assert!((0..6).all(|h| !faces.flip(h)));
    assert_eq!(faults(&faces), none());
    let points = [[0.0, 0.0], [3.0, 0.0], [2.0, 1.0], [2.0, -1.0]];
    let mut convex = plane(&points, &[[0, 1, 2], [1, 0, 3]]);
    convex.curve[0] = 0;
    assert!(!convex.flip(0), "a feature");
    convex.curve[0] = NONE;
    assert!(convex.flip(0));
}

#[test]
fn splits_keep_area_angles_and_places() {
    let (mut faces, mut points) = patch(6);
    let whole = area(&faces);
    assert!((whole - 36.0).abs() < 1e-9);
    for i in 0..60u32 {
        let h = (i * 37) % faces.origin.len() as u32;
        if i % 2 == 0 {
            // Only features are split: each side of one counts its directions from it.
            faces.curve[h as usize] = 0;
            if faces.twin[h as usize] != NONE {
                let twin = faces.twin[h as usize];
                faces.curve[twin as usize] = 0;
            }
            let share = 0.2 + 0.01 * f64::from(i);
            let [[ax, ay], [bx, by]] = [faces.origin[h as usize], faces.target(h)].map(|v| points[v as usize]);
            assert_eq!(faces.split_edge(h, share) as usize, points.len());
            points.push([ax + (bx - ax) * share, ay + (by - ay) * share]);
        } else {
            let corners = [0, 1, 2].map(|k| points[faces.origin[(h / 3 * 3 + k) as usize] as usize]);
            let point = [0, 1].map(|x| 0.5 * corners[0][x] + 0.3 * corners[1][x] + 0.2 * corners[2][x]);
            let ways = corners.map(|[x, y]| [x - point[0], y - point[1]]);
            let vertex = faces.split_face(h / 3, ways.map(|[x, y]| x.hypot(y)), ways.map(|[x, y]| y.atan2(x)));
            assert_eq!(vertex as usize, points.len());
            points.push(point);
        }
        assert_eq!(faults(&faces), none(), "split {i}");
        assert!((area(&faces) - whole).abs() < 1e-9, "split {i}");
        assert_eq!(euler(&faces), 1, "split {i}");
    }
    let mut closed = 0;
    let mut ring = Vec::new();
    for v in 0..faces.leaving.len() as u32 {
        if faces.ring(v, &mut ring) {
            let spread: f64 = ring.iter().map(|&h| faces.corner(h)).sum();
            assert!((spread - TAU).abs() < 1e-7, "vertex {v}: {spread}");
            closed += 1;
        }
    }
    assert!(closed > 70, "{closed}");
    let misplaced = faces.split_face(0, [0.1, 2.0, 2.0], [0.0, 2.0, 4.0]);
    assert!((area(&faces) - whole).abs() > 1e-3, "lengths that do not fit vertex {misplaced} are seen");
}

#[test]
fn legalized_all_edges_are_delaunay() {
    let (mut faces, points) = patch(12);
    let broken = |faces: &Intrinsic| (0..faces.origin.len() as u32).filter(|&h| !faces.is_delaunay(h)).count();
    assert!(broken(&faces) > 20, "the patch is not Delaunay as it is made");
    let mut stack = (0..faces.origin.len() as u32).collect();
    faces.legalize(&mut stack, |_, _| true, |_, _, _, length| length);
    assert_eq!(broken(&faces), 0);
    assert_eq!(faults(&faces), none());
    assert!(against_plane(&faces, &points) < 1e-7, "flips in the plane are exact");
    assert!((area(&faces) - 144.0).abs() < 1e-7);
    // No point lies in the circle round a face.
    for f in 0..faces.face_count() as u32 {
        let [[ax, ay], [bx, by], [cx, cy]] = [0, 1, 2].map(|k| points[faces.origin[(3 * f + k) as usize] as usize]);
        let d = 2.0 * (ax * (by - cy) + bx * (cy - ay) + cx * (ay - by));
        let square = |x: f64, y: f64| x * x + y * y;
        let (a, b, c) = (square(ax, ay), square(bx, by), square(cx, cy));
        let centre =
            [(a * (by - cy) + b * (cy - ay) + c * (ay - by)) / d, (a * (cx - bx) + b * (ax - cx) + c * (bx - ax)) / d];
        let radius = (ax - centre[0]).hypot(ay - centre[1]);
        assert!(points.iter().all(|p| (p[0] - centre[0]).hypot(p[1] - centre[1]) > radius - 1e-6), "face {f}");
    }
    let mut again = (0..faces.origin.len() as u32).collect();
    faces.legalize(&mut again, |_, _| panic!("nothing is left to flip"), |_, _, _, length| length);
}
