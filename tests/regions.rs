//! Named regions: faces of the mesh have the names of the triangles that they lie on, and borders are kept.

mod common;

use common::surfaces::{distance, unit_corners};
use glam::DVec3;
use quadmosaic::compute::Cpu;
use quadmosaic::mesh::Mesh;
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

fn meshed(soup: &Soup, points: usize) -> Outcome {
    let options = Options::new(Fineness::Points(points));
    run(soup, &options, &Cpu, &|_, _| {}).unwrap_or_else(|error| panic!("{error}"))
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
