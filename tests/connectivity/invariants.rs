//! What all operations keep: topology, orientation, and the mesh itself where nothing can be done.

use super::plate::covered;
use super::{Optimised, Random, faces, flat, optimised, optimised_on, push_split, with};
use quadmosaic::mesh::check::{Faults, Kind, check};
use quadmosaic::mesh::connectivity::{ConnectivityOptions, Quads, optimise, untangle};
use quadmosaic::mesh::relocate::relocate;
use quadmosaic::mesh::{Context, Mesh, SurfaceMesh};
use quadmosaic::surface::{FeatureOptions, Soup, Surface};

#[test]
fn no_second_edge_between_two_vertices() {
    // A tetrahedron: merging any two of its triangles joins nothing anew, but the two quads left would be one face twice.
    let points = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.3, 0.3, 0.1]];
    let triangles = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    let soup = Soup { points, triangles, ..Soup::default() };
    let smooth = FeatureOptions { crease: 180.0, ..FeatureOptions::default() };
    let surface = Surface::new(&soup, &smooth).unwrap_or_else(|error| panic!("{error}"));
    for quads in [Quads::Paper, Quads::Most, Quads::All] {
        let generous = ConnectivityOptions { triangle_price: 10.0, least_shape: 0.0, ..with(quads) };
        let Optimised { after, .. } = optimised(&surface, &soup.clone().into(), &generous);
        let faults: Faults = check(&after);
        assert!(faults.is_clean(), "{quads:?}: {faults}");
        assert_eq!(faults.euler, 2, "{quads:?}");
    }
}

#[test]
fn polygons_are_left_alone() {
    let before = flat(
        &[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [2.0, 0.0], [2.5, 0.5], [2.0, 1.0]],
        &[&[0, 1, 2], &[0, 2, 3], &[1, 4, 5, 6, 2]],
    );
    for quads in [Quads::Paper, Quads::Most, Quads::All] {
        let Optimised { after, .. } = optimised(&covered(&before, &[]), &before, &with(quads));
        assert_eq!(faces(&after), [vec![0, 1, 2, 3], vec![1, 4, 5, 6, 2]], "{quads:?}");
    }
}

/// A torus of `n` by `2 n` quads, radii 1 and 2, a share of the quads split, with its normals and crosses.
fn torus(n: u32, split: f64, seed: u64) -> (Mesh, Vec<[f64; 3]>, Vec<[f64; 3]>) {
    let mut random = Random(seed);
    let (mut torus, mut normals, mut axes) = (Mesh::default(), Vec::new(), Vec::new());
    for v in 0..2 * n * n {
        let angle = |k: u32, n: u32, shift: f64| (f64::from(k) + 0.2 * shift) * std::f64::consts::TAU / f64::from(n);
        let (sin_u, cos_u) = angle(v / n, 2 * n, random.next()).sin_cos();
        let (sin_v, cos_v) = angle(v % n, n, random.next()).sin_cos();
        torus.points.push([(2.0 + cos_v) * cos_u, (2.0 + cos_v) * sin_u, sin_v]);
        normals.push([cos_v * cos_u, cos_v * sin_u, sin_v]);
        axes.push([-sin_u, cos_u, 0.0]);
    }
    for (i, j) in (0..2 * n).flat_map(|i| (0..n).map(move |j| (i, j))) {
        let at = |i: u32, j: u32| i % (2 * n) * n + j % n;
        push_split(&mut torus, [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)], split, &mut random);
    }
    (torus, normals, axes)
}

#[test]
fn closed_curved_surfaces_keep_their_topology() {
    // The clean-up takes a mesh of triangles; the other operations those that it leaves.
    for (seed, split, quads) in [
        (1, 0.3, Quads::Paper),
        (2, 0.6, Quads::Paper),
        (3, 1.0, Quads::Paper),
        (4, 0.02, Quads::Most),
        (5, 0.1, Quads::Most),
        (6, 0.02, Quads::All),
        (7, 0.1, Quads::All),
    ] {
        let (before, normals, axes) = torus(16, split, seed);
        assert!(check(&before).is_clean(), "{}", check(&before));
        let surface = covered(&before, &[]);
        let context = Context::new(&surface);
        let laid = SurfaceMesh::of(&context, &before).with_axes(&axes);
        let Optimised { after, origins, counts, .. } = optimised_on(&context, laid, &with(quads));
        let faults = check(&after);
        assert!(faults.is_clean(), "{faults}");
        assert_eq!((faults.euler, faults.boundary_loops, faults.components), (0, 0, 1));
        assert!(counts.triangles_after * 5 < counts.triangles_before, "{quads:?}: {counts:?}");
        assert!(quads != Quads::All || counts.triangles_after == 0, "{counts:?}");
        // Every face looks outwards.
        for face in after.faces() {
            let Some(old) = face.iter().map(|&v| origins[v as usize]).find(|&old| old != u32::MAX) else { continue };
            let normal = normals[old as usize];
            let [a, b, c] = [0, 1, face.len() - 1].map(|k| after.points[face[k] as usize]);
            let [u, v] = [b, c].map(|p| [p[0] - a[0], p[1] - a[1], p[2] - a[2]]);
            let cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
            assert!((0..3).map(|k| cross[k] * normal[k]).sum::<f64>() > 0.0, "{face:?}");
        }
    }
}

#[test]
fn any_faces_at_all_are_borne() {
    let square = flat(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]], &[&[0, 1, 2, 3]]);
    let surface = covered(&square, &[]);
    let context = Context::new(&surface);
    for seed in 0..200 {
        let mut random = Random(seed);
        let mut soup = Mesh::new((0..12).map(|_| [0; 3].map(|_| random.next())).collect());
        for _ in 0..20 {
            let sides = 1 + (random.next() * 5.0) as usize;
            // Some name a vertex twice, and some one that is missing.
            let face: Vec<u32> = (0..sides).map(|_| (random.next() * 12.05) as u32).collect();
            soup.push_face(&face);
        }
        assert!(!check(&soup).is_clean());
        let mut axes = [[1.0, 0.0, 0.0]; 12];
        if seed % 2 == 0 {
            soup.points[0][0] = f64::NAN;
            axes[1] = [f64::NAN; 3];
        }
        for quads in [Quads::Paper, Quads::Most, Quads::All] {
            let mut laid = SurfaceMesh::of(&context, &soup).with_axes(&axes);
            let faces = laid.faces().count();
            let mut counts = optimise(&context, &mut laid, &with(quads));
            untangle(&context, &mut laid, &with(quads), &mut counts);
            relocate(&context, &mut laid, 2);
            let after = check(&laid.in_model_units(&context));
            assert_eq!(laid.faces().count() > 0, faces > 0, "{seed}, {quads:?}: {counts:?}");
            let is_broken = |kind: &Kind| matches!(kind, Kind::MissingVertex { .. } | Kind::RepeatedVertex { .. });
            assert_eq!(after.count(is_broken), 0, "{seed}, {quads:?}: {after}");
        }
    }
}
