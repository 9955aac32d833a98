//! Named regions through the whole method: each face has the name of the region that it lies on.

mod common;

use common::surfaces::{distance, flat, unit_corners};
use glam::DVec3;
use quadmosaic::compute::Cpu;
use quadmosaic::mesh::Mesh;
use quadmosaic::pipeline::{Fineness, Options, Outcome, run, unwatched};
use quadmosaic::surface::{FeatureOptions, Regions, Soup};

/// A box of 2 by 1 by 1 whose sides have names, 72 triangles each.
fn named_box() -> Soup {
    let mut soup = Soup::default();
    let [low, high] = [DVec3::ZERO, DVec3::new(2.0, 1.0, 1.0)];
    let [x, y, z] = [DVec3::X * 2.0, DVec3::Y, DVec3::Z];
    for (origin, u, v) in [(low, y, x), (high, -x, -y), (low, x, z), (high, -z, -x), (low, z, y), (high, -y, -z)] {
        let first = soup.points.len() as u32;
        let side = flat(6, 6, 1.0 / 6.0);
        soup.points.extend(side.points.iter().map(|&[i, j, _]| (origin + u * i + v * j).to_array()));
        soup.triangles.extend(side.triangles.iter().map(|t| t.map(|index| first + index)));
    }
    let names = ["bottom", "top", "front", "back", "left", "right"].map(str::to_owned);
    soup.regions = Regions { names: names.to_vec(), of_face: (0..432).map(|t| t / 72).collect() };
    soup
}

/// A plate of 2 by 1 of which what lies beyond a zigzag about the middle has another name.
fn named_plate() -> Soup {
    let mut soup = flat(20, 10, 0.1);
    let beyond = |t: &[u32; 3]| u32::from(t.iter().map(|&v| soup.points[v as usize][0]).sum::<f64>() > 3.0);
    let of_face = soup.triangles.iter().map(beyond).collect();
    soup.regions = Regions { names: vec!["left".to_owned(), "right".to_owned()], of_face };
    soup
}

fn meshed(soup: &Soup, region_borders: bool) -> Outcome {
    let features = FeatureOptions { region_borders, ..FeatureOptions::default() };
    let options = Options { features, ..Options::new(Fineness::Points(500)) };
    run(soup, &options, &Cpu, &unwatched).unwrap_or_else(|error| panic!("{error}"))
}

/// The share of faces whose middle does not lie on the region that they are named for.
fn wrong(soup: &Soup, outcome: &Outcome, mesh: &Mesh) -> f64 {
    let frame = outcome.surface.frame();
    let off = |face: usize| {
        let corners = mesh.face(face);
        let middle = corners.iter().map(|&v| DVec3::from(mesh.points[v as usize])).sum::<DVec3>();
        let middle = DVec3::from(frame.to_unit((middle / corners.len() as f64).into()));
        let own = (0..soup.triangles.len()).filter(|&t| soup.regions.of_face[t] == mesh.regions.of_face[face]);
        own.map(|t| distance(middle, unit_corners(soup, frame, t))).fold(f64::MAX, f64::min) > 1e-6
    };
    (0..mesh.face_count()).filter(|&face| off(face)).count() as f64 / mesh.face_count() as f64
}

#[test]
fn faces_have_the_names_of_their_regions() {
    for (name, mut soup) in [("box", named_box()), ("plate", named_plate())] {
        let outcome = meshed(&soup, true);
        let mesh = &outcome.meshed.mesh;
        assert_eq!(mesh.regions.names, soup.regions.names, "{name}");
        assert_eq!(mesh.regions.of_face.len(), mesh.face_count(), "{name}");
        assert!(mesh.regions.of_face.is_sorted(), "{name}: the faces of a region are in a row");
        assert_eq!(wrong(&soup, &outcome, mesh), 0.0, "{name}");
        let count = soup.regions.names.len() as u32;
        soup.regions.of_face.iter_mut().for_each(|region| *region = (*region + 1) % count);
        assert_eq!(wrong(&soup, &outcome, mesh), 1.0, "{name}: other names would all be wrong");
    }
}

#[test]
fn faces_that_lie_on_two_regions_have_the_name_of_one() {
    let soup = named_plate();
    let outcome = meshed(&soup, false);
    assert_eq!(outcome.meshed.mesh.regions.of_face.len(), outcome.meshed.mesh.face_count());
    let share = wrong(&soup, &outcome, &outcome.meshed.mesh);
    // Of some 30 by 15 faces two columns at most lie across the border.
    assert!(share < 2.0 / 30.0, "{share}");
    let mut other = soup;
    other.regions = Regions::default();
    assert_eq!(meshed(&other, false).meshed.mesh.regions, Regions::default());
}

#[test]
fn borders_of_regions_are_features_unless_told_otherwise() {
    let curves = |region_borders: bool| meshed(&named_plate(), region_borders).surface.features().curves().to_vec();
    // The four sides; two of them are parted by the border, of which there is at least one curve more.
    assert_eq!(curves(false).len(), 4);
    assert!(curves(true).len() >= 7);
    // The box' edges are creases, and so features in any case.
    for region_borders in [false, true] {
        assert_eq!(meshed(&named_box(), region_borders).surface.features().curves().len(), 12);
    }
}
