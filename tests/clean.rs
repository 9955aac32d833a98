//! The clean-up: each operation on the smallest mesh that shows it, where it must refuse, and what it leaves as it was.

use quadmosaic::mesh::Mesh;
use quadmosaic::mesh::check::{Faults, check};
use quadmosaic::mesh::clean::{Anchors, CleanCounts, CleanOptions, clean};
use quadmosaic::mesh::quality::Quality;

fn mesh(points: &[[f64; 2]], faces: &[&[u32]]) -> Mesh {
    let mut mesh = Mesh::new(points.iter().map(|[x, y]| [*x, *y, 0.0]).collect());
    for face in faces {
        mesh.push_face(face);
    }
    assert!(check(&mesh).list.iter().all(|fault| fault.at[2] == 0.0));
    mesh
}

/// Flat, nothing fixed, crosses along x and y.
fn free(mesh: &Mesh) -> Anchors {
    let count = mesh.points.len();
    Anchors {
        feature_edges: Vec::new(),
        fixed: vec![false; count],
        normals: vec![[0.0, 0.0, 1.0]; count],
        axes: vec![[1.0, 0.0, 0.0]; count],
        factors: Vec::new(),
    }
}

fn with_features(mesh: &Mesh, edges: &[[u32; 2]]) -> Anchors {
    let mut anchors = free(mesh);
    anchors.feature_edges = edges.to_vec();
    for &vertex in edges.iter().flatten() {
        anchors.fixed[vertex as usize] = true;
    }
    anchors
}

/// The faces, each turned so that its smallest vertex comes first, sorted.
fn faces(mesh: &Mesh) -> Vec<Vec<u32>> {
    let mut faces: Vec<Vec<u32>> = mesh
        .faces()
        .map(|face| {
            let first = (0..face.len()).min_by_key(|k| face[*k]).unwrap();
            face[first..].iter().chain(&face[..first]).copied().collect()
        })
        .collect();
    faces.sort();
    faces
}

fn area(mesh: &Mesh) -> f64 {
    let cross = |a: u32, b: u32| {
        let ([ax, ay, _], [bx, by, _]) = (mesh.points[a as usize], mesh.points[b as usize]);
        (ax * by - ay * bx) / 2.0
    };
    mesh.faces().flat_map(|face| (0..face.len()).map(move |k| cross(face[k], face[(k + 1) % face.len()]))).sum()
}

fn cleaned(mesh: &Mesh, anchors: &Anchors) -> (Mesh, CleanCounts) {
    clean(mesh, anchors, &CleanOptions::default())
}

/// The clean-up leaves the mesh as it is.
#[track_caller]
fn assert_refused(mesh: &Mesh, anchors: &Anchors) {
    let (after, counts) = cleaned(mesh, anchors);
    assert_eq!(&after, mesh, "{counts:?}");
}

#[test]
fn two_triangles_become_a_quad() {
    let square = mesh(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]], &[&[0, 1, 2], &[0, 2, 3]]);
    let (after, counts) = cleaned(&square, &free(&square));
    assert_eq!(faces(&after), [[0, 1, 2, 3]]);
    assert_eq!((counts.merged, counts.triangles_before, counts.triangles_after), (1, 2, 0));
    assert_eq!(counts.kept, [0, 1, 2, 3]);

    assert_refused(&square, &with_features(&square, &[[0, 2]]));
    let dart = mesh(&[[0.0, 0.0], [1.0, 0.0], [0.3, 0.3], [0.0, 1.0]], &[&[0, 1, 2], &[0, 2, 3]]);
    assert_refused(&dart, &free(&dart));
}

#[test]
fn the_better_of_two_merges_is_taken() {
    // Three triangles in a fan: the two on the left make a square, the two on the right a lopsided quad.
    let fan =
        mesh(&[[0.0, 0.0], [2.0, -0.5], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]], &[&[0, 1, 2], &[0, 2, 3], &[0, 3, 4]]);
    let (after, _) = cleaned(&fan, &free(&fan));
    assert_eq!(faces(&after), [vec![0, 1, 2], vec![0, 2, 3, 4]]);
}

/// Triangle, quad, triangle over two squares: the quad lies aslant.
fn slanted_row() -> Mesh {
    mesh(
        &[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [0.0, 1.0]],
        &[&[0, 4, 5], &[0, 1, 3, 4], &[1, 2, 3]],
    )
}

#[test]
fn triangle_quad_triangle_become_two_quads_along_the_field() {
    let row = slanted_row();
    let (after, counts) = cleaned(&row, &free(&row));
    assert_eq!(faces(&after), [[0, 1, 4, 5], [1, 2, 3, 4]]);
    assert_eq!((counts.rows, counts.triangles_after), (1, 0));

    assert_refused(&row, &with_features(&row, &[[1, 3]]));
    // The far end is pulled in: whatever the cut, a corner is reflex.
    let mut bent = row.clone();
    bent.points[2] = [1.2, 0.55, 0.0];
    bent.points[5] = [0.8, 0.45, 0.0];
    assert!(check(&bent).is_clean(), "a fair start");
    assert_refused(&bent, &free(&bent));
}

#[test]
fn the_field_decides_between_two_cuts() {
    // A regular hexagon has three cuts of equal shape; the middle edge goes where the cross does.
    let corners: Vec<[f64; 2]> =
        (0..6).map(|k| f64::from(k) * std::f64::consts::FRAC_PI_3).map(|t| [t.cos(), t.sin()]).collect();
    let hexagon = mesh(&corners, &[&[0, 1, 2], &[0, 2, 3, 5], &[3, 4, 5]]);
    // Two trapezia are worth less than the rectangle between the triangles, so a high price is set on those.
    let dear = CleanOptions { triangle_price: 0.5, ..CleanOptions::default() };
    for (middle, direction) in [(0_u32, 0.0_f64), (1, 60.0), (2, 120.0)] {
        let mut anchors = free(&hexagon);
        let (sin, cos) = direction.to_radians().sin_cos();
        anchors.axes.fill([cos as f32, sin as f32, 0.0]);
        let (after, counts) = clean(&hexagon, &anchors, &dear);
        assert_eq!((counts.rows, after.face_count()), (1, 2));
        assert!(after.faces().all(|face| face.contains(&middle) && face.contains(&(middle + 3))), "{direction}");
    }
}

#[test]
fn two_triangles_at_a_vertex_with_a_quad_between_become_quads() {
    // Round vertex 1: a triangle, a quad and a triangle over two squares.
    let turn = mesh(
        &[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.2], [0.0, 1.0]],
        &[&[0, 1, 5], &[1, 3, 4, 5], &[1, 2, 3]],
    );
    let (after, counts) = cleaned(&turn, &free(&turn));
    assert_eq!(faces(&after), [[0, 1, 4, 5], [1, 2, 3, 4]]);
    assert_eq!((counts.turns, counts.triangles_after), (1, 0));
    assert_refused(&turn, &with_features(&turn, &[[1, 5]]));
    let mut folded = turn.clone();
    // The corner at 5 is reflex, and no cut ends there but one that leaves the straight corner at 1.
    folded.points[5] = [0.6, 0.6, 0.0];
    assert!(check(&folded).is_clean(), "a fair start");
    assert_refused(&folded, &free(&folded));
}

#[test]
fn two_triangles_at_a_vertex_with_an_edge_between_become_quads() {
    // Round vertex 2: a triangle, two quads with the edge 2-6 between them, and a triangle; three squares, cut aslant.
    let turn = mesh(
        &[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0], [3.0, 1.0], [2.0, 1.0], [1.0, 1.2], [0.0, 1.0]],
        &[&[1, 2, 0], &[0, 2, 6, 7], &[2, 4, 5, 6], &[2, 3, 4]],
    );
    // The first triangle lies flat: lift it.
    let mut turn = turn;
    turn.points[1] = [1.0, -0.3, 0.0];
    let (after, counts) = cleaned(&turn, &free(&turn));
    assert_eq!(faces(&after), [[0, 1, 6, 7], [1, 2, 5, 6], [2, 3, 4, 5]]);
    assert_eq!((counts.turns, counts.triangles_after), (1, 0));
    assert_refused(&turn, &with_features(&turn, &[[2, 6]]));
}

/// A square outline with something in it, and a ring of four quads round it.
fn framed(inside: &[[f64; 2]], within: &[&[u32]]) -> Mesh {
    let mut points =
        vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [-1.0, -1.0], [2.0, -1.0], [2.0, 2.0], [-1.0, 2.0]];
    points.extend(inside);
    let mut all: Vec<&[u32]> = vec![&[4, 5, 1, 0], &[5, 6, 2, 1], &[6, 7, 3, 2], &[7, 4, 0, 3]];
    all.extend(within);
    mesh(&points, &all)
}

#[test]
fn vertex_of_valence_two_goes() {
    let doublet = framed(&[[0.55, 0.5]], &[&[0, 1, 2, 8], &[0, 8, 2, 3]]);
    assert!(!check(&doublet).is_clean(), "one of the two is concave");
    let (after, counts) = cleaned(&doublet, &free(&doublet));
    assert!(check(&after).is_clean(), "{}", check(&after));
    assert!(faces(&after).contains(&vec![0, 1, 2, 3]));
    assert_eq!((counts.removed, after.points.len()), (1, 8));
    assert_eq!(counts.kept, [0, 1, 2, 3, 4, 5, 6, 7]);

    let mut anchors = free(&doublet);
    anchors.fixed[8] = true;
    assert_refused(&doublet, &anchors);
    assert_refused(&doublet, &with_features(&doublet, &[[0, 8], [2, 8]]));
}

#[test]
fn vertex_among_triangles_goes() {
    for (star, within) in [
        (&[[0.5, 0.4]][..], &[&[0_u32, 1, 8][..], &[1, 2, 8], &[0, 8, 2, 3]][..]),
        (&[[0.5, 0.5]], &[&[0, 1, 8], &[1, 2, 8], &[2, 3, 8], &[3, 0, 8]]),
    ] {
        let before = framed(star, within);
        let (after, counts) = cleaned(&before, &free(&before));
        assert_eq!((counts.removed, counts.triangles_after), (1, 0));
        assert!(check(&after).is_clean(), "{}", check(&after));
        assert!(faces(&after).contains(&vec![0, 1, 2, 3]));
    }
}

#[test]
fn three_triangles_become_one() {
    let points = [[0.0, 0.0], [1.0, 0.0], [0.5, 0.9], [0.5, 0.3], [-2.0, -1.0], [3.0, -1.0], [0.5, 3.0]];
    let ring: [&[u32]; 3] = [&[4, 5, 1, 0], &[5, 6, 2, 1], &[6, 4, 0, 2]];
    let star: [&[u32]; 3] = [&[0, 1, 3], &[1, 2, 3], &[2, 0, 3]];
    let before = mesh(&points, &[ring, star].concat());
    let (after, counts) = cleaned(&before, &free(&before));
    assert_eq!((counts.removed, counts.triangles_after), (1, 1));
    assert!(faces(&after).contains(&vec![0, 1, 2]));
    assert_eq!(counts.kept, [0, 1, 2, 4, 5, 6]);

    let mut anchors = free(&before);
    anchors.fixed[3] = true;
    assert_eq!(cleaned(&before, &anchors).1.removed, 0);
}

#[test]
fn boundary_vertices_stay() {
    // Vertex 3 has two faces, but lies on the boundary.
    let corner = mesh(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.2, 0.8]], &[&[0, 1, 2], &[0, 2, 3]]);
    let (after, counts) = cleaned(&corner, &free(&corner));
    assert_eq!((after.points.len(), counts.removed), (4, 0));
}

#[test]
fn no_second_edge_between_two_vertices() {
    // A tetrahedron: merging any two of its triangles joins nothing anew, but the two quads left would be one face twice.
    let mut tetrahedron = Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.3, 0.3, 0.1]]);
    for face in [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]] {
        tetrahedron.push_face(&face);
    }
    let generous = CleanOptions { triangle_price: 10.0, least_shape: 0.0, ..CleanOptions::default() };
    let (after, _) = clean(&tetrahedron, &free(&tetrahedron), &generous);
    let faults: Faults = check(&after);
    assert!(faults.is_clean(), "{faults}");
    assert_eq!(faults.euler, 2);
}

/// SplitMix64, in [0, 1).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// `n` by `n` squares, a share of them split by a random diagonal, the vertices moved by up to `jitter` each way.
fn random_grid(n: u32, split: f64, jitter: f64, seed: u64) -> Mesh {
    let mut random = Random(seed);
    let side = n + 1;
    let points: Vec<[f64; 2]> = (0..side * side)
        .map(|v| [v % side, v / side].map(|x| f64::from(x) + jitter * (2.0 * random.next() - 1.0)))
        .collect();
    let mut grid = mesh(&points, &[]);
    for cell in 0..n * n {
        let a = cell / n * side + cell % n;
        let [b, c, d] = [a + 1, a + 1 + side, a + side];
        if random.next() >= split {
            grid.push_face(&[a, b, c, d]);
        } else if random.next() < 0.5 {
            grid.push_face(&[a, b, c]);
            grid.push_face(&[a, c, d]);
        } else {
            grid.push_face(&[a, b, d]);
            grid.push_face(&[b, c, d]);
        }
    }
    grid
}

/// Triangles over `n` by `n` squares from which `merges` random pairs made quads: triangles are left over everywhere.
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
            let k = (0..3).find(|k| !g.contains(&f[*k])).unwrap();
            let tip = *g.iter().find(|v| !f.contains(v)).unwrap();
            let quad = [f[k], f[(k + 1) % 3], tip, f[(k + 2) % 3]];
            let points = quad.map(|v| grid.points[v as usize]);
            if quadmosaic::mesh::quality::quad_shape(points) > 0.3 {
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
            {
                let options = CleanOptions::default();
                let (after, counts) = clean(&before, &free(&before), &options);
                let faults = check(&after);
                assert!(faults.is_clean(), "seed {seed}: {faults}");
                assert_eq!((faults.euler, faults.boundary_loops, faults.components), (1, 1, 1));
                // Each face adds some roundings of coordinates up to 20.
                assert!((area(&after) - area(&before)).abs() < 1e-10, "seed {seed}");
                assert_eq!(after.points.len() + counts.removed, before.points.len());
                let quality = Quality::of(&after);
                assert_eq!(quality.triangles, counts.triangles_after);
                assert!(counts.triangles_after < counts.triangles_before, "seed {seed}: {counts:?}");
                assert!(quality.qg.unwrap().min >= options.least_shape.min(Quality::of(&before).qg.unwrap().min));
                for (new, &old) in counts.kept.iter().enumerate() {
                    assert_eq!(after.points[new], before.points[old as usize]);
                }
                let boundary: Vec<[u32; 2]> =
                    outline(&after).iter().map(|ends| ends.map(|end| counts.kept[end as usize])).collect();
                assert_eq!(boundary, outline(&before), "seed {seed}");
            }
        }
    }
}

#[test]
fn split_grid_is_healed() {
    let before = random_grid(20, 0.3, 0.15, 7);
    let (after, counts) = clean(&before, &free(&before), &CleanOptions::default());
    assert_eq!((after.face_count(), counts.triangles_after, counts.removed), (400, 0, 0), "{counts:?}");
}

#[test]
fn features_stay() {
    let before = random_grid(12, 1.0, 0.1, 3);
    let diagonals: Vec<[u32; 2]> =
        before.edges().iter().map(|edge| edge.ends).filter(|[a, b]| b - a != 1 && b - a != 13).collect();
    let missing = |anchors: &Anchors| {
        let (after, counts) = clean(&before, anchors, &CleanOptions::default());
        let old = |vertex: u32| counts.kept[vertex as usize];
        let edges: Vec<[u32; 2]> = after.edges().iter().map(|edge| edge.ends.map(old)).collect();
        diagonals.iter().filter(|edge| edges.binary_search(edge).is_err()).count()
    };
    assert_eq!(missing(&with_features(&before, &diagonals)), 0);
    assert!(missing(&free(&before)) > 0, "without features they go");
}

#[test]
fn nothing_is_done_in_no_rounds_and_the_same_twice() {
    let before = leftovers(16, 1);
    let none = CleanOptions { rounds: 0, ..CleanOptions::default() };
    assert_eq!(clean(&before, &free(&before), &none).0, before);
    let run = || clean(&before, &free(&before), &CleanOptions::default());
    assert_eq!(run(), run());
}

#[test]
fn polygons_are_left_alone() {
    let before = mesh(
        &[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [2.0, 0.0], [2.5, 0.5], [2.0, 1.0]],
        &[&[0, 1, 2], &[0, 2, 3], &[1, 4, 5, 6, 2]],
    );
    let (after, _) = clean(&before, &free(&before), &CleanOptions::default());
    assert_eq!(faces(&after), [vec![0, 1, 2, 3], vec![1, 4, 5, 6, 2]]);
}

/// A torus of `n` by `2 n` quads, radii 1 and 2, a share of the quads split, with normals and crosses.
fn torus(n: u32, split: f64, seed: u64) -> (Mesh, Anchors) {
    let mut random = Random(seed);
    let (mut torus, mut normals, mut axes) = (Mesh::default(), Vec::new(), Vec::new());
    for v in 0..2 * n * n {
        let angle = |k: u32, n: u32, shift: f64| (f64::from(k) + 0.2 * shift) * std::f64::consts::TAU / f64::from(n);
        let (sin_u, cos_u) = angle(v / n, 2 * n, random.next()).sin_cos();
        let (sin_v, cos_v) = angle(v % n, n, random.next()).sin_cos();
        torus.points.push([(2.0 + cos_v) * cos_u, (2.0 + cos_v) * sin_u, sin_v]);
        normals.push([cos_v * cos_u, cos_v * sin_u, sin_v].map(|x| x as f32));
        axes.push([-sin_u, cos_u, 0.0].map(|x| x as f32));
    }
    for (i, j) in (0..2 * n).flat_map(|i| (0..n).map(move |j| (i, j))) {
        let at = |i: u32, j: u32| i % (2 * n) * n + j % n;
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        if random.next() >= split {
            torus.push_face(&[a, b, c, d]);
        } else if random.next() < 0.5 {
            torus.push_face(&[a, b, c]);
            torus.push_face(&[a, c, d]);
        } else {
            torus.push_face(&[a, b, d]);
            torus.push_face(&[b, c, d]);
        }
    }
    let fixed = vec![false; torus.points.len()];
    (torus, Anchors { feature_edges: Vec::new(), fixed, normals, axes, factors: Vec::new() })
}

#[test]
fn closed_curved_surface_keeps_its_topology() {
    for (seed, split) in [(1, 0.3), (2, 0.6), (3, 1.0)] {
        let (before, anchors) = torus(16, split, seed);
        assert!(check(&before).is_clean(), "{}", check(&before));
        let (after, counts) = clean(&before, &anchors, &CleanOptions::default());
        let faults = check(&after);
        assert!(faults.is_clean(), "{faults}");
        assert_eq!((faults.euler, faults.boundary_loops, faults.components), (0, 0, 1));
        assert!(counts.triangles_after * 20 < counts.triangles_before, "{counts:?}");
        // Every new face looks outwards.
        for face in after.faces() {
            let normal = anchors.normals[counts.kept[face[0] as usize] as usize].map(f64::from);
            let [a, b, c] = [0, 1, face.len() - 1].map(|k| after.points[face[k] as usize]);
            let [u, v] = [b, c].map(|p| [p[0] - a[0], p[1] - a[1], p[2] - a[2]]);
            let cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
            assert!((0..3).map(|k| cross[k] * normal[k]).sum::<f64>() > 0.0, "{face:?}");
        }
    }
}

#[test]
fn any_faces_at_all_are_borne() {
    for seed in 0..200 {
        let mut random = Random(seed);
        let mut soup = Mesh::new((0..12).map(|_| [0; 3].map(|_| random.next())).collect());
        for _ in 0..20 {
            let sides = 1 + (random.next() * 5.0) as usize;
            let face: Vec<u32> = (0..sides).map(|_| (random.next() * 12.0) as u32).collect();
            soup.push_face(&face);
        }
        let mut anchors = free(&soup);
        if seed % 2 == 0 {
            soup.points[0][0] = f64::NAN;
            anchors.axes[1] = [f32::NAN; 3];
        }
        let (after, counts) = clean(&soup, &anchors, &CleanOptions::default());
        assert!(counts.triangles_after <= counts.triangles_before);
        assert!(after.face_count() <= soup.face_count());
        let (faults, quality) = (check(&soup), Quality::of(&soup));
        assert!(!faults.is_clean() && (0.0..=1.0).contains(&quality.qr), "{faults}");
    }
}
