//! Where the input is no manifold, and where it has named regions: the mesh is joined, and named, as the surface is.

mod common;

use common::surfaces::{distance, unit_corners};
use glam::DVec3;
use quadmosaic::compute::Cpu;
use quadmosaic::mesh::Mesh;
use quadmosaic::mesh::check::check_joined;
use quadmosaic::pipeline::{Fineness, Options, Outcome, run};
use quadmosaic::surface::{FeatureOptions, Regions, Soup, Surface};

/// Adds a grid of `count` by `count` squares from `origin` along `u` and `v`.
fn plate(soup: &mut Soup, origin: [f64; 3], u: [f64; 3], v: [f64; 3], count: usize) {
    let first = soup.points.len() as u32;
    let [origin, u, v] = [origin, u, v].map(DVec3::from);
    let share = |i: usize| i as f64 / count as f64;
    for j in 0..=count {
        soup.points.extend((0..=count).map(|i| (origin + u * share(i) + v * share(j)).to_array()));
    }
    let at = |i: usize, j: usize| first + (j * (count + 1) + i) as u32;
    for j in 0..count {
        for i in 0..count {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            soup.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
}

/// A box from `low` to `high`, outward.
fn solid(soup: &mut Soup, low: [f64; 3], high: [f64; 3], count: usize) {
    let [x, y, z] = [0, 1, 2].map(|k| {
        let mut way = [0.0; 3];
        way[k] = high[k] - low[k];
        way
    });
    for (origin, u, v) in [(low, y, x), (low, x, z), (low, z, y)] {
        plate(soup, origin, u, v, count);
        plate(soup, high, v.map(|c| -c), u.map(|c| -c), count);
    }
}

/// A disc of `rings` rings closing a tube half way: each edge of its rim has three triangles, and it has no corner.
fn baffle() -> Soup {
    let (around, along, rings) = (48, 12, 8);
    let place = |i: usize, r: f64, z: f64| {
        let (s, c) = (std::f64::consts::TAU * (i % around) as f64 / around as f64).sin_cos();
        [r * c, r * s, z]
    };
    let mut soup = Soup::default();
    let mut quad = |corners: [[f64; 3]; 4]| {
        let first = soup.points.len() as u32;
        soup.points.extend(corners);
        soup.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    };
    for i in 0..around {
        for j in 0..along {
            let [z, w] = [j, j + 1].map(|j| 2.0 * j as f64 / along as f64 - 1.0);
            quad([place(i, 1.0, z), place(i + 1, 1.0, z), place(i + 1, 1.0, w), place(i, 1.0, w)]);
        }
        for k in 0..rings {
            let [r, s] = [k, k + 1].map(|k| k as f64 / rings as f64);
            quad([place(i, r, 0.0), place(i, s, 0.0), place(i + 1, s, 0.0), place(i + 1, r, 0.0)]);
        }
    }
    soup
}

fn meshed(soup: &Soup, points: usize) -> Outcome {
    let options = Options::new(Fineness::Points(points));
    run(soup, &options, &Cpu, &|_, _| {}).unwrap_or_else(|error| panic!("{error}"))
}

/// Vertices minus edges plus faces, points at one place counted once; and how many edges have 1, 2, 3, 4 faces.
fn counts<'a>(points: &[[f64; 3]], faces: impl Iterator<Item = &'a [u32]>) -> (i64, [usize; 5]) {
    use std::collections::{BTreeMap, BTreeSet};
    let key = |v: u32| points[v as usize].map(|x| (x * 1e6).round() as i64);
    let (mut vertices, mut edges, mut count) = (BTreeSet::new(), BTreeMap::new(), 0);
    for face in faces {
        let keys: Vec<_> = face.iter().map(|&v| key(v)).collect();
        let mut distinct = keys.clone();
        distinct.sort_unstable();
        distinct.dedup();
        if distinct.len() < 3 {
            continue;
        }
        count += 1;
        for (a, b) in keys.iter().zip(keys.iter().cycle().skip(1)) {
            vertices.insert(*a);
            *edges.entry([*a.min(b), *a.max(b)]).or_insert(0usize) += 1;
        }
    }
    let mut with = [0; 5];
    edges.values().for_each(|&faces| with[faces.min(4)] += 1);
    (vertices.len() as i64 - edges.len() as i64 + count, with)
}

#[test]
fn sheets_are_joined_where_they_meet() {
    let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    let mut t_joint = Soup::default();
    plate(&mut t_joint, [0.0, 0.0, 0.0], x, y, 8);
    plate(&mut t_joint, [0.0, 0.5, 0.0], x, z, 8);
    let mut edge = Soup::default();
    solid(&mut edge, [0.0; 3], [1.0; 3], 4);
    solid(&mut edge, [1.0, 1.0, 0.0], [2.0, 2.0, 1.0], 4);
    let mut wall = Soup::default();
    solid(&mut wall, [0.0; 3], [1.0; 3], 4);
    solid(&mut wall, [1.0, 0.0, 0.0], [2.0, 1.0, 1.0], 4);
    let mut tip = Soup::default();
    solid(&mut tip, [0.0; 3], [1.0; 3], 4);
    solid(&mut tip, [1.0; 3], [2.0; 3], 4);
    // How many faces the edges of the seam have; 0: there is no such edge.
    let cases =
        [("t joint", t_joint, 3), ("edge", edge, 4), ("wall", wall, 3), ("tip", tip, 0), ("baffle", baffle(), 3)];
    for (name, soup, crowded) in cases {
        let outcome = meshed(&soup, 900);
        let mesh = &outcome.mesh;
        let faults = check_joined(mesh, &outcome.branches);
        assert!(faults.is_clean(), "{name}: {faults}");
        let (wanted, given) = counts(&soup.points, soup.triangles.iter().map(|t| &t[..]));
        let (found, with) = counts(&mesh.points, mesh.faces());
        // The 32 triangles of the wall between the two boxes are given twice, and once is enough.
        let wanted = if name == "wall" { wanted - 32 } else { wanted };
        assert_eq!(found, wanted, "{name}");
        for faces in [1, 3, 4] {
            let expected = if faces == 1 { given[1] > 0 } else { faces == crowded };
            assert_eq!(with[faces] > 0, expected, "{name}: {with:?}, given {given:?}");
        }
        // Taken apart, the same mesh is seen to be another.
        let mut torn = Mesh::new(mesh.faces().flatten().map(|&v| mesh.points[v as usize].map(|c| c * 1.1)).collect());
        let mut first = 0;
        for face in mesh.faces() {
            torn.push_face(&(first..first + face.len() as u32).collect::<Vec<_>>());
            torn.points[first as usize][0] += 1e-3 * f64::from(first + 1);
            first += face.len() as u32;
        }
        assert_ne!(counts(&torn.points, torn.faces()).0, wanted, "{name}");
    }
}

/// A box whose sides have names.
fn named_box() -> Soup {
    let mut soup = Soup::default();
    solid(&mut soup, [0.0; 3], [2.0, 1.0, 1.0], 6);
    let names = ["bottom", "top", "front", "back", "left", "right"].map(str::to_owned);
    let of_face = (0..soup.triangles.len() as u32).map(|t| t / 72).collect();
    soup.regions = Regions { names: names.to_vec(), of_face };
    soup
}

#[test]
fn faces_have_the_names_of_their_regions() {
    let mut soup = named_box();
    let frame = *Surface::new(&soup, &FeatureOptions::default()).expect("a box").frame();
    // How many faces do not lie on the region that they are named for.
    let wrong = |soup: &Soup, mesh: &Mesh| {
        let off = |face: usize| {
            let corners = mesh.face(face);
            let middle = corners.iter().map(|&v| DVec3::from(mesh.points[v as usize])).sum::<DVec3>();
            let middle = DVec3::from(frame.to_unit((middle / corners.len() as f64).into()));
            let own = (0..soup.triangles.len()).filter(|&t| soup.regions.of_face[t] == mesh.regions.of_face[face]);
            own.map(|t| distance(middle, unit_corners(soup, &frame, t))).fold(f64::MAX, f64::min) > 1e-6
        };
        (0..mesh.face_count()).filter(|&face| off(face)).count()
    };
    let outcome = meshed(&soup, 500);
    assert_eq!(outcome.mesh.regions.names, soup.regions.names);
    assert_eq!(outcome.mesh.regions.of_face.len(), outcome.mesh.face_count());
    assert_eq!(wrong(&soup, &outcome.mesh), 0);
    soup.regions.of_face.iter_mut().for_each(|region| *region = (*region + 1) % 6);
    assert_eq!(wrong(&soup, &outcome.mesh), outcome.mesh.face_count(), "other names would all be wrong");
}

#[test]
fn borders_of_regions_are_features_unless_told_otherwise() {
    let mut soup = Soup::default();
    plate(&mut soup, [0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], 8);
    let half = soup.triangles.len() as u32 / 2;
    let of_face = (0..2 * half).map(|t| u32::from(t >= half)).collect();
    soup.regions = Regions { names: vec!["low".to_owned(), "high".to_owned()], of_face };
    let curves = |region_borders: bool| {
        let options = FeatureOptions { region_borders, ..FeatureOptions::default() };
        Surface::new(&soup, &options).expect("a plate").features().curves().len()
    };
    // The border, and two sides that it parts.
    assert_eq!((curves(false), curves(true)), (4, 7));
}
