//! The paper's clean-up: positions stay, and the four patterns are replaced where the faces' worth grows.

use super::plate::covered;
use super::{Optimised, Random, area, faces, flat, optimised, optimised_on, push_split, with};
use quadmosaic::mesh::check::check;
use quadmosaic::mesh::connectivity::Quads;
use quadmosaic::mesh::quality::{Quality, quad_shape};
use quadmosaic::mesh::{Context, Mesh, SurfaceMesh};
use quadmosaic::surface::Surface;

/// The smallest shape of a quad that may come, as the clean-up has it.
const LEAST_SHAPE: f64 = 0.3;

/// The mesh on the surface that it covers, cleaned up; some of its edges are features.
fn cleaned(mesh: &Mesh, features: &[[u32; 2]]) -> Optimised {
    cleaned_on(&covered(mesh, features), mesh)
}

fn cleaned_on(surface: &Surface, mesh: &Mesh) -> Optimised {
    let result = optimised(surface, mesh, &with(Quads::Paper));
    let stays = |(v, &origin): (usize, &u32)| result.after.points[v] == result.before.points[origin as usize];
    assert!(result.origins.iter().enumerate().all(stays), "positions stay");
    result
}

/// The clean-up leaves the mesh as it is.
#[track_caller]
fn assert_refused(mesh: &Mesh, features: &[[u32; 2]]) {
    let Optimised { before, after, counts, .. } = cleaned(mesh, features);
    assert_eq!(after, before, "{counts:?}");
}

#[test]
fn two_triangles_become_a_quad() {
    let square = flat(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]], &[&[0, 1, 2], &[0, 2, 3]]);
    let Optimised { after, origins, counts, .. } = cleaned(&square, &[]);
    assert_eq!(faces(&after), [[0, 1, 2, 3]]);
    assert_eq!((counts.merged, counts.triangles_before, counts.triangles_after), (1, 2, 0));
    assert_eq!(origins, [0, 1, 2, 3]);

    assert_refused(&square, &[[0, 2]]);
    let dart = flat(&[[0.0, 0.0], [1.0, 0.0], [0.3, 0.3], [0.0, 1.0]], &[&[0, 1, 2], &[0, 2, 3]]);
    assert_refused(&dart, &[]);
}

#[test]
fn the_better_of_two_merges_is_taken() {
    // Three triangles in a fan: the two on the left make a square, the two on the right a lopsided quad.
    let fan =
        flat(&[[0.0, 0.0], [2.0, -0.5], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]], &[&[0, 1, 2], &[0, 2, 3], &[0, 3, 4]]);
    assert_eq!(faces(&cleaned(&fan, &[]).after), [vec![0, 1, 2], vec![0, 2, 3, 4]]);
}

/// Triangle, quad, triangle over two squares: the quad lies aslant.
fn slanted_row() -> Mesh {
    flat(
        &[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [0.0, 1.0]],
        &[&[0, 4, 5], &[0, 1, 3, 4], &[1, 2, 3]],
    )
}

#[test]
fn triangle_quad_triangle_become_two_quads_along_the_field() {
    let row = slanted_row();
    let Optimised { after, counts, .. } = cleaned(&row, &[]);
    assert_eq!(faces(&after), [[0, 1, 4, 5], [1, 2, 3, 4]]);
    assert_eq!((counts.recut_rows, counts.triangles_after), (1, 0));

    assert_refused(&row, &[[1, 3]]);
    // The far end is pulled in: whatever the cut, a corner is reflex.
    let mut bent = row.clone();
    bent.points[2] = [1.2, 0.55, 0.0];
    bent.points[5] = [0.8, 0.45, 0.0];
    assert!(check(&bent).is_clean(), "a fair start");
    assert_refused(&bent, &[]);
}

#[test]
fn the_field_decides_between_two_cuts() {
    // A regular hexagon has three cuts of equal shape; the middle edge goes where the cross does.
    let corners: Vec<[f64; 2]> =
        (0..6).map(|k| f64::from(k) * std::f64::consts::FRAC_PI_3).map(|t| [t.cos(), t.sin()]).collect();
    for middle in 0..3_u32 {
        let at = |k: u32| (middle + k) % 6;
        let hexagon = flat(&corners, &[&[at(0), at(1), at(2)], &[at(0), at(2), at(3), at(5)], &[at(3), at(4), at(5)]]);
        let surface = covered(&hexagon, &[]);
        let context = Context::new(&surface);
        let middles = [0.0_f64, 60.0, 120.0].map(|direction| {
            let (sin, cos) = direction.to_radians().sin_cos();
            let laid = SurfaceMesh::of(&context, &hexagon).with_axes(&[[cos, sin, 0.0]; 6]);
            let Optimised { after, counts, .. } = optimised_on(&context, laid, &with(Quads::Paper));
            assert_eq!(after.face_count(), 3 - counts.recut_rows);
            (0..3).find(|v| after.faces().all(|face| face.contains(v) && face.contains(&(v + 3))))
        });
        // Where the cross lies along the triangles' sides, these are worth more than two trapezia.
        let wanted = [0, 1, 2].map(|k| (k != (middle + 1) % 3).then_some(k));
        assert_eq!(middles, wanted, "triangles at {} and {}", at(1), at(4));
    }
}

#[test]
fn two_triangles_at_a_vertex_with_a_quad_between_become_quads() {
    // Round vertex 1: a triangle, a quad and a triangle over two squares.
    let turn = flat(
        &[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.2], [0.0, 1.0]],
        &[&[0, 1, 5], &[1, 3, 4, 5], &[1, 2, 3]],
    );
    let Optimised { after, counts, .. } = cleaned(&turn, &[]);
    assert_eq!(faces(&after), [[0, 1, 4, 5], [1, 2, 3, 4]]);
    assert_eq!((counts.recut_fans, counts.triangles_after), (1, 0));
    assert_refused(&turn, &[[1, 5]]);
    let mut folded = turn.clone();
    // The corner at 5 is reflex, and no cut ends there but one that leaves the straight corner at 1.
    folded.points[5] = [0.6, 0.6, 0.0];
    assert!(check(&folded).is_clean(), "a fair start");
    assert_refused(&folded, &[]);
}

#[test]
fn two_triangles_at_a_vertex_with_an_edge_between_become_quads() {
    // Round vertex 2: a triangle, two quads with the edge 2-6 between them, and a triangle; three squares, cut aslant.
    let turn = flat(
        &[[0.0, 0.0], [1.0, -0.3], [2.0, 0.0], [3.0, 0.0], [3.0, 1.0], [2.0, 1.0], [1.0, 1.2], [0.0, 1.0]],
        &[&[1, 2, 0], &[0, 2, 6, 7], &[2, 4, 5, 6], &[2, 3, 4]],
    );
    let Optimised { after, counts, .. } = cleaned(&turn, &[]);
    assert_eq!(faces(&after), [[0, 1, 6, 7], [1, 2, 5, 6], [2, 3, 4, 5]]);
    assert_eq!((counts.recut_fans, counts.triangles_after), (1, 0));
    assert_refused(&turn, &[[2, 6]]);
}

/// A square outline with something in it, and a ring of four quads round it.
fn framed(inside: &[[f64; 2]], within: &[&[u32]]) -> Mesh {
    let mut points =
        vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [-1.0, -1.0], [2.0, -1.0], [2.0, 2.0], [-1.0, 2.0]];
    points.extend(inside);
    let mut all: Vec<&[u32]> = vec![&[4, 5, 1, 0], &[5, 6, 2, 1], &[6, 7, 3, 2], &[7, 4, 0, 3]];
    all.extend(within);
    flat(&points, &all)
}

#[test]
fn vertex_of_valence_two_goes() {
    let doublet = framed(&[[0.55, 0.5]], &[&[0, 1, 2, 8], &[0, 8, 2, 3]]);
    assert!(!check(&doublet).is_clean(), "one of the two is concave");
    let Optimised { after, origins, counts, .. } = cleaned(&doublet, &[]);
    assert!(check(&after).is_clean(), "{}", check(&after));
    assert!(faces(&after).contains(&vec![0, 1, 2, 3]));
    assert_eq!((counts.removed, after.points.len()), (1, 8));
    assert_eq!(origins, [0, 1, 2, 3, 4, 5, 6, 7]);

    assert_refused(&doublet, &[[0, 8], [2, 8]]);
}

#[test]
fn vertex_among_triangles_goes() {
    for (star, within) in [
        (&[[0.5, 0.4]][..], &[&[0_u32, 1, 8][..], &[1, 2, 8], &[0, 8, 2, 3]][..]),
        (&[[0.5, 0.5]], &[&[0, 1, 8], &[1, 2, 8], &[2, 3, 8], &[3, 0, 8]]),
    ] {
        let before = framed(star, within);
        let Optimised { after, counts, .. } = cleaned(&before, &[]);
        assert_eq!((counts.removed, counts.triangles_after), (1, 0));
        assert!(check(&after).is_clean(), "{}", check(&after));
        assert!(faces(&after).contains(&vec![0, 1, 2, 3]));
        assert_eq!(cleaned(&before, &[[0, 8], [2, 8]]).counts.removed, 0, "a vertex on a feature stays");
    }
}

#[test]
fn three_triangles_become_one() {
    let points = [[0.0, 0.0], [1.0, 0.0], [0.5, 0.9], [0.5, 0.3], [-2.0, -1.0], [3.0, -1.0], [0.5, 3.0]];
    let ring: [&[u32]; 3] = [&[4, 5, 1, 0], &[5, 6, 2, 1], &[6, 4, 0, 2]];
    let star: [&[u32]; 3] = [&[0, 1, 3], &[1, 2, 3], &[2, 0, 3]];
    let before = flat(&points, &[ring, star].concat());
    let Optimised { after, origins, counts, .. } = cleaned(&before, &[]);
    assert_eq!((counts.removed, counts.triangles_after), (1, 1));
    assert_eq!(origins, [0, 1, 2, 4, 5, 6]);
    assert!(faces(&after).contains(&vec![0, 1, 2]));

    assert_eq!(cleaned(&before, &[[0, 3]]).counts.removed, 0);
}

#[test]
fn boundary_vertices_stay() {
    // Vertex 3 has two faces, but lies on the boundary.
    let corner = flat(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.2, 0.8]], &[&[0, 1, 2], &[0, 2, 3]]);
    // So it does where the surface goes on.
    let beyond = covered(&flat(&[[-1.0, -1.0], [3.0, -1.0], [-1.0, 3.0]], &[&[0, 1, 2]]), &[]);
    for Optimised { after, counts, .. } in [cleaned(&corner, &[]), cleaned_on(&beyond, &corner)] {
        assert_eq!((after.points.len(), counts.removed), (4, 0));
    }
}

/// `n` by `n` squares, a share of them split by a random diagonal, the vertices moved by up to `jitter` each way.
fn random_grid(n: u32, split: f64, jitter: f64, seed: u64) -> Mesh {
    let mut random = Random(seed);
    let side = n + 1;
    let points: Vec<[f64; 2]> = (0..side * side)
        .map(|v| [v % side, v / side].map(|x| f64::from(x) + jitter * (2.0 * random.next() - 1.0)))
        .collect();
    let mut grid = flat(&points, &[]);
    for cell in 0..n * n {
        let a = cell / n * side + cell % n;
        push_split(&mut grid, [a, a + 1, a + 1 + side, a + side], split, &mut random);
    }
    grid
}

/// Triangles over `n` by `n` squares of which random pairs have become quads: triangles are left over everywhere.
fn leftovers(n: u32, seed: u64) -> Mesh {
    let grid = random_grid(n, 1.0, 0.1, seed);
    let mut random = Random(seed ^ 0xabcd);
    let mut partner = vec![usize::MAX; grid.face_count()];
    let mut result = Mesh::new(grid.points.clone());
    for a in 0..grid.face_count() {
        let near = (a + 1..(a + 2 * n as usize + 2).min(grid.face_count())).filter(|b| partner[*b] == usize::MAX);
        let shared = |b: usize| grid.face(a).iter().filter(|v| grid.face(b).contains(v)).count();
        let choices: Vec<usize> = near.filter(|b| shared(*b) == 2).collect();
        if partner[a] == usize::MAX && !choices.is_empty() {
            let b = choices[(random.next() * choices.len() as f64) as usize];
            let (f, g) = (grid.face(a), grid.face(b));
            let k = (0..3).find(|k| !g.contains(&f[*k])).expect("they differ");
            let tip = *g.iter().find(|v| !f.contains(v)).expect("they differ");
            let quad = [f[k], f[(k + 1) % 3], tip, f[(k + 2) % 3]];
            if quad_shape(quad.map(|v| grid.points[v as usize])) > LEAST_SHAPE {
                (partner[a], partner[b]) = (b, a);
                result.push_face(&quad);
            }
        }
    }
    for a in (0..grid.face_count()).filter(|a| partner[*a] == usize::MAX) {
        result.push_face(grid.face(a));
    }
    result
}

fn outline(mesh: &Mesh) -> Vec<[u32; 2]> {
    mesh.edges().iter().filter(|edge| edge.is_boundary()).map(|edge| edge.ends).collect()
}

#[test]
fn invariants_are_seen_to_break() {
    let whole = random_grid(4, 0.3, 0.1, 1);
    let mut torn = Mesh::new(whole.points.clone());
    for face in whole.faces().skip(1) {
        torn.push_face(face);
    }
    assert!((area(&torn) - area(&whole)).abs() > 0.1);
    assert_ne!(outline(&torn), outline(&whole));
    torn.push_face(&whole.face(0).iter().rev().copied().collect::<Vec<_>>());
    assert!(!check(&torn).is_clean());
}

#[test]
fn invariants_hold_on_random_grids() {
    for seed in 0..20 {
        for before in [random_grid(20, 0.3, 0.15, seed), leftovers(20, seed)] {
            let start = check(&before);
            assert!(start.is_clean(), "{start}");
            let Optimised { before, after, origins, counts } = cleaned(&before, &[]);
            let faults = check(&after);
            assert!(faults.is_clean(), "seed {seed}: {faults}");
            assert_eq!((faults.euler, faults.boundary_loops, faults.components), (1, 1, 1));
            // Each face adds some roundings of coordinates up to 20.
            assert!((area(&after) - area(&before)).abs() < 1e-10, "seed {seed}");
            assert_eq!(after.points.len() + counts.removed, before.points.len());
            let quality = Quality::of(&after);
            assert_eq!(quality.triangles, counts.triangles_after);
            assert!(counts.triangles_after < counts.triangles_before, "seed {seed}: {counts:?}");
            let least = |mesh: &Mesh| Quality::of(mesh).qg.expect("quads").min;
            assert!(least(&after) >= LEAST_SHAPE.min(least(&before)), "seed {seed}");
            let boundary: Vec<[u32; 2]> =
                outline(&after).iter().map(|ends| ends.map(|end| origins[end as usize])).collect();
            assert_eq!(boundary, outline(&before), "seed {seed}");
        }
    }
}

#[test]
fn split_grid_is_healed() {
    let before = random_grid(20, 0.3, 0.15, 7);
    let Optimised { after, counts, .. } = cleaned(&before, &[]);
    assert_eq!((after.face_count(), counts.triangles_after, counts.removed), (400, 0, 0), "{counts:?}");
}

#[test]
fn features_stay() {
    let before = random_grid(12, 1.0, 0.1, 3);
    let diagonals: Vec<[u32; 2]> =
        before.edges().iter().map(|edge| edge.ends).filter(|[a, b]| b - a != 1 && b - a != 13).collect();
    let missing = |features: &[[u32; 2]]| {
        let Optimised { after, origins, .. } = cleaned(&before, features);
        let edges: Vec<[u32; 2]> =
            after.edges().iter().map(|edge| edge.ends.map(|vertex| origins[vertex as usize])).collect();
        diagonals.iter().filter(|edge| edges.binary_search(edge).is_err()).count()
    };
    assert_eq!(missing(&diagonals), 0);
    assert!(missing(&[]) > 0, "without features they go");
}

#[test]
fn the_same_twice() {
    let before = leftovers(16, 1);
    let run = || (cleaned(&before, &[]).after, cleaned(&before, &[]).counts);
    assert_eq!(run(), run());
    assert_ne!(run().0, cleaned(&leftovers(16, 2), &[]).after);
}
