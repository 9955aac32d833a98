//! Meshes that are symmetric about a plane.

mod common;

use common::surfaces::{example, flat, surface};
use glam::{DQuat, DVec3, EulerRot};
use quadmosaic::compute::Cpu;
use quadmosaic::field::Guide;
use quadmosaic::mesh::Mesh;
use quadmosaic::mesh::check::check;
use quadmosaic::pipeline::{Fineness, Meshed, Options, Outcome, PipelineError, run, unwatched};
use quadmosaic::surface::{Ends, NamedEdge, Regions};
use quadmosaic::symmetry::{Axis, Plane, Symmetry, SymmetryError, cut};
use quadmosaic::{Mesher, Soup};
use std::collections::{HashMap, HashSet};
use std::f64::consts::{PI, TAU};

/// An ellipsoid bent in the plane y = 0 whose triangles are not symmetric about it.
fn bean() -> Soup {
    let (rings, sides) = (30, 40);
    let at = |along: f64, around: f64| {
        let (x, r) = (along.cos(), 0.45 * along.sin());
        [x, r * around.cos(), r * around.sin() + 0.45 * x * x]
    };
    let mut points = vec![at(0.0, 0.0)];
    for i in 1..rings {
        let turn = 0.3 + 0.37 * f64::from(i % 2);
        points.extend(
            (0..sides)
                .map(|j| at(PI * f64::from(i) / f64::from(rings), TAU * (f64::from(j) + turn) / f64::from(sides))),
        );
    }
    points.push(at(PI, 0.0));
    let last = points.len() as u32 - 1;
    let on = |i: i32, j: i32| (1 + (i - 1) * sides + j % sides) as u32;
    let mut triangles = Vec::new();
    for j in 0..sides {
        triangles.extend([[0, on(1, j), on(1, j + 1)], [on(rings - 1, j), last, on(rings - 1, j + 1)]]);
        for i in 1..rings - 1 {
            let [a, b, c, d] = [on(i, j), on(i + 1, j), on(i + 1, j + 1), on(i, j + 1)];
            triangles.extend(if i % 2 == 0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] });
        }
    }
    Soup::new(points, triangles)
}

/// A box from -1 to 1 along each axis, each side cut into so many strips both ways.
fn cube(strips: usize) -> Soup {
    let mut soup = Soup::default();
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            let first = soup.points.len() as u32;
            let square = flat(strips, strips, 2.0 / strips as f64);
            soup.points.extend(square.points.iter().map(|&[i, j, _]| {
                let mut point = [0.0; 3];
                (point[axis], point[(axis + 1) % 3], point[(axis + 2) % 3]) = (side, side * (i - 1.0), j - 1.0);
                point
            }));
            soup.triangles.extend(square.triangles.iter().map(|t| t.map(|v| first + v)));
        }
    }
    soup
}

fn moved(mut soup: Soup, by: [f64; 3]) -> Soup {
    soup.points.iter_mut().for_each(|point| (0..3).for_each(|k| point[k] += by[k]));
    soup
}

/// The mirror image about x = 0.
fn mirrored(mut soup: Soup) -> Soup {
    soup.points.iter_mut().for_each(|point| point[0] = -point[0]);
    soup.triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
    soup
}

fn both(mut soup: Soup, other: &Soup) -> Soup {
    let first = soup.points.len() as u32;
    soup.points.extend(&other.points);
    soup.triangles.extend(other.triangles.iter().map(|t| t.map(|v| first + v)));
    soup
}

fn about(axis: Axis, offset: f64) -> Symmetry {
    Symmetry::About(Plane { axis, offset })
}

fn options(points: usize, symmetry: Symmetry) -> Options {
    Options { symmetry: Some(symmetry), ..Options::new(Fineness::Points(points)) }
}

fn tried(soup: &Soup, options: &Options) -> Result<Outcome, PipelineError> {
    run(soup, options, &Cpu, &unwatched)
}

fn meshed(soup: &Soup, options: &Options) -> Outcome {
    tried(soup, options).unwrap_or_else(|error| panic!("{error}"))
}

fn refused(soup: &Soup, symmetry: Symmetry) -> SymmetryError {
    match tried(soup, &options(500, symmetry)) {
        Err(PipelineError::Symmetry(error)) => error,
        Err(error) => panic!("{error}"),
        Ok(_) => panic!("a mesh was made"),
    }
}

/// The bits of a point; no two of them for 0.
fn bits(point: [f64; 3]) -> [u64; 3] {
    point.map(|x| (x + 0.0).to_bits())
}

/// The numbers of vertices and of faces without a mirror image in the mesh.
fn without_image(mesh: &Mesh, plane: Plane) -> [usize; 2] {
    let number: HashMap<[u64; 3], u32> = mesh.points.iter().map(|&point| bits(point)).zip(0..).collect();
    let image = |v: u32| number.get(&bits(plane.image(mesh.points[v as usize]))).copied();
    let turned = |mut face: Vec<u32>| {
        let least = (0..face.len()).min_by_key(|&k| face[k]).unwrap_or(0);
        face.rotate_left(least);
        face
    };
    let faces: HashSet<Vec<u32>> = mesh.faces().map(|face| turned(face.to_vec())).collect();
    let has_image = |face: &[u32]| {
        let image: Option<Vec<u32>> = face.iter().rev().map(|&v| image(v)).collect();
        image.is_some_and(|image| faces.contains(&turned(image)))
    };
    let vertices = (0..mesh.points.len() as u32).filter(|&v| image(v).is_none()).count();
    [vertices, mesh.faces().filter(|face| !has_image(face)).count()]
}

#[test]
fn each_vertex_and_face_has_its_mirror_image_bit_for_bit() {
    let plane = Plane { axis: Axis::Y, offset: 0.0 };
    let plain = meshed(&bean(), &Options::new(Fineness::Points(1_000))).meshed.mesh;
    let [vertices, faces] = without_image(&plain, plane);
    assert!(
        10 * vertices > 9 * plain.points.len() && faces > 900,
        "symmetry is not there by itself: {vertices}, {faces}"
    );
    for offset in [0.0, 0.1, 1e3 + 0.3] {
        let plane = Plane { offset, ..plane };
        let outcome = meshed(&moved(bean(), [0.0, offset, 0.0]), &options(1_000, Symmetry::About(plane)));
        let meshed = &outcome.meshed;
        assert_eq!(without_image(&meshed.mesh, plane), [0, 0], "{plane}");
        let heights = || meshed.mesh.points.iter().map(|&point| plane.height(point).abs());
        let on_plane = heights().filter(|height| *height == 0.0).count();
        assert_eq!(Some(on_plane), outcome.symmetry.as_ref().map(|symmetry| symmetry.on_plane));
        assert!(on_plane > 40 && heights().all(|height| height == 0.0 || height > 1e-3), "{on_plane}");
        assert!(meshed.faults.is_clean() && meshed.differences.is_empty(), "{}", meshed.faults);
        assert_eq!((meshed.faults.euler, meshed.faults.boundary_loops), (2, 0));
        assert!(meshed.mesh.points.len().abs_diff(1_000) < 20, "{}", meshed.mesh.points.len());
        assert_eq!(meshed.vertices.len(), meshed.mesh.points.len());
        assert!(
            meshed.vertices.iter().all(|vertex| vertex.kind == quadmosaic::mesh::VertexKind::Free),
            "the plane is no feature"
        );
    }
}

#[test]
fn the_report_is_that_of_the_whole() {
    let options = options(1_000, about(Axis::Y, 0.0));
    let mesher = Mesher::cpu();
    let report = |soup: &Soup| {
        let outcome = meshed(soup, &options);
        mesher.report("bean", &options, &outcome)
    };
    let whole = report(&bean());
    assert_eq!(whole.surface.triangles, bean().triangles.len());
    assert_eq!((whole.field.index_sum, whole.mesh.vertices), (2.0, whole.mesh.interior_vertices));
    assert_eq!((whole.warnings(), whole.wrong()), (Vec::new(), None));
    // A dent below the plane is not in the mesh.
    let mut dented = bean();
    let dent =
        |point: &mut [f64; 3]| point[1] *= 1.0 - 0.3 * (-10.0 * (point[0] * point[0] + point[2] * point[2])).exp();
    dented.points.iter_mut().filter(|point| point[1] < 0.0).for_each(dent);
    let warnings = report(&dented).warnings();
    let told = "the surface is not symmetric about y = 0: its mirror image is up to 1.";
    assert!(warnings.len() == 1 && warnings[0].starts_with(told), "{warnings:?}");
}

#[test]
fn boundaries_stay_and_several_rims_are_joined() {
    // A tube that is open at both ends, cut across and along; a torus, cut across (two rims) and along (two rims, one in the other).
    let mut tube = flat(40, 20, 0.1);
    tube.points.iter_mut().for_each(|point| {
        let around = TAU * point[0] / 4.0;
        *point = [around.cos(), around.sin(), point[1] - 1.0];
    });
    let torus = example("torus", 3_000);
    for (soup, axes, loops) in [(&tube, [Axis::X, Axis::Z], 2), (&torus, [Axis::X, Axis::Z], 0)] {
        for axis in axes {
            let outcome = meshed(soup, &options(800, about(axis, 0.0)));
            let meshed = &outcome.meshed;
            assert_eq!(without_image(&meshed.mesh, Plane { axis, offset: 0.0 }), [0, 0]);
            assert!(meshed.faults.is_clean() && meshed.differences.is_empty(), "{axis:?}: {}", meshed.faults);
            assert_eq!((meshed.faults.euler, meshed.faults.boundary_loops), (0, loops), "{axis:?}");
            assert!(meshed.mesh.points.len().abs_diff(800) < 24, "{axis:?}: {}", meshed.mesh.points.len());
            let report = Mesher::cpu().report("it", &options(800, about(axis, 0.0)), &outcome);
            assert_eq!(report.field.index_sum, 0.0, "{axis:?}");
        }
    }
}

#[test]
fn sheets_that_meet_across_the_plane_are_joined() {
    // A floor, and a wall in its middle, which the plane crosses.
    let floor = moved(flat(21, 20, 0.1), [-1.05, -1.0, 0.0]);
    let mut wall = moved(flat(21, 10, 0.1), [-1.05, 0.0, 0.0]);
    wall.points.iter_mut().for_each(|point| point.swap(1, 2));
    let soup = both(floor, &wall);
    let Meshed { mesh, faults, differences, branches, .. } = meshed(&soup, &options(800, about(Axis::X, 0.0))).meshed;
    assert_eq!(without_image(&mesh, Plane { axis: Axis::X, offset: 0.0 }), [0, 0]);
    assert!(faults.is_clean() && differences.is_empty(), "{faults}");
    let is_joint = |point: &[f64; 3]| point[1] == 0.0 && point[2] == 0.0;
    assert!(mesh.points.iter().zip(&branches).all(|(point, branches)| is_joint(point) == *branches));
    assert!(branches.iter().filter(|branches| **branches).count() > 10);
}

#[test]
fn a_cut_keeps_the_area_on_both_sides() {
    // Through edges and vertices, through faces alone, and within the tolerance of vertices.
    for (soup, offset) in [(cube(2), 0.0), (cube(2), 0.25), (cube(3), 0.0), (cube(2), 1e-9), (cube(4), 0.5 - 1e-6)] {
        let plane = Plane { axis: Axis::X, offset };
        let above = cut(&surface(&soup), plane).unwrap_or_else(|error| panic!("{error}"));
        let below = cut(&surface(&mirrored(soup)), Plane { offset: -offset, ..plane })
            .unwrap_or_else(|error| panic!("{error}"));
        for (half, depth) in [(&above, 1.0 - offset), (&below, 1.0 + offset)] {
            assert!((half.soup.area() - 4.0 - 8.0 * depth).abs() < 1e-5, "{offset}: {}", half.soup.area());
            assert!((half.rim - 8.0).abs() < 1e-9, "{offset}: {}", half.rim);
            let faults = check(&half.soup.clone().into());
            assert!(faults.is_clean() && (faults.euler, faults.boundary_loops) == (1, 1), "{offset}: {faults}");
        }
        assert!(above.soup.points.iter().all(|point| point[0] == offset || point[0] > offset + 1e-7));
    }
}

#[test]
fn a_plane_is_found_or_refused() {
    let found = |soup: &Soup| meshed(soup, &options(1_000, Symmetry::Auto)).symmetry.map(|symmetry| symmetry.plane);
    assert_eq!(found(&bean()), Some(Plane { axis: Axis::X, offset: 0.0 }), "it is symmetric about x = 0 too");
    // Thicker at one end, it is symmetric about one plane alone.
    let thicker = |mut soup: Soup| {
        soup.points.iter_mut().for_each(|point| {
            let factor = 1.0 + 0.3 * point[0];
            *point = [point[0], factor * point[1], factor * point[2]];
        });
        soup
    };
    let outcome = meshed(&moved(thicker(bean()), [0.0, 7.3, 0.0]), &options(1_000, Symmetry::Auto));
    let Some(Plane { axis: Axis::Y, offset }) = outcome.symmetry.map(|symmetry| symmetry.plane) else {
        panic!("across y")
    };
    assert!((offset - 7.3).abs() < 0.01, "{offset}");
    // Sheared, it has no plane.
    let mut sheared = thicker(bean());
    sheared
        .points
        .iter_mut()
        .for_each(|point| *point = [point[0] + 0.5 * point[1], point[1] + 0.4 * point[2], point[2]]);
    let error = refused(&sheared, Symmetry::Auto);
    assert!(matches!(error, SymmetryError::NoPlane { distance, limit, .. } if distance > limit), "{error}");
}

#[test]
fn a_turned_plane_is_found_and_told_by_its_normal() {
    // Thicker at one end and turned, it is symmetric about one plane alone, which lies across no coordinate axis.
    let turn = DQuat::from_euler(EulerRot::XYZ, 0.3, -0.5, 0.8);
    let turned = |mut soup: Soup| {
        soup.points.iter_mut().for_each(|point| {
            let factor = 1.0 + 0.3 * point[0];
            let point_there = DVec3::new(point[0], factor * point[1], factor * point[2]);
            *point = (turn * point_there + DVec3::new(3.0, 4.0, 5.0)).into();
        });
        soup
    };
    let soup = turned(bean());
    let outcome = meshed(&soup, &options(1_000, Symmetry::Auto));
    let plane = outcome.symmetry.as_ref().expect("a plane").plane;
    let Axis::Oblique(normal) = plane.axis else { panic!("{plane}") };
    assert!(DVec3::from(normal).cross(turn * DVec3::Y).length() < 1e-3, "{plane}");
    assert!(plane.to_string().contains(" x ") && plane.to_string().contains(" z = "), "{plane}");
    let farthest_image = |mesh: &Mesh, plane: Plane| {
        let places: Vec<DVec3> = mesh.points.iter().map(|&point| point.into()).collect();
        let nearest = |&point: &[f64; 3]| {
            let image = DVec3::from(plane.image(point));
            places.iter().map(|place| place.distance(image)).fold(f64::INFINITY, f64::min)
        };
        mesh.points.iter().map(nearest).fold(0.0, f64::max)
    };
    let Meshed { mesh, faults, differences, .. } = &outcome.meshed;
    assert!(farthest_image(mesh, plane) < 1e-13, "{}", farthest_image(mesh, plane));
    assert!(faults.is_clean() && differences.is_empty() && faults.euler == 2, "{faults}");
    let on_plane = mesh.points.iter().filter(|&&point| plane.height(point).abs() < 1e-13).count();
    assert!(on_plane > 40 && outcome.symmetry.is_some_and(|symmetry| symmetry.on_plane == on_plane), "{on_plane}");
    let plain = meshed(&soup, &Options::new(Fineness::Points(1_000))).meshed.mesh;
    assert!(farthest_image(&plain, plane) > 1e-3, "symmetry is not there by itself");
    // Bent to one side, it has no plane.
    let bent = turned(sideways(bean()));
    let error = refused(&bent, Symmetry::Auto);
    assert!(matches!(error, SymmetryError::NoPlane { distance, limit, .. } if distance > limit), "{error}");
}

/// Bent out of both its planes.
fn sideways(mut soup: Soup) -> Soup {
    soup.points.iter_mut().for_each(|point| point[1] += 0.5 * point[0].powi(3) + 0.3 * point[0] * point[2]);
    soup
}

#[test]
fn what_cannot_be_joined_is_refused_with_a_place() {
    let x = about(Axis::X, 0.0);
    let error = refused(&cube(2), about(Axis::X, 1.5));
    assert_eq!(
        error.to_string(),
        "the surface lies wholly on one side of the plane x = 1.5, from -1.000000e0 to 1.000000e0 along this axis; give a plane that \
         crosses it, or the whole surface"
    );
    assert!(
        matches!(refused(&cube(2), about(Axis::X, 1.0)), SymmetryError::OneSide { .. }),
        "its side lies in the plane"
    );
    // A wall in the plane, across the box.
    let mut wall = flat(2, 2, 1.0);
    wall.points.iter_mut().for_each(|point| *point = [0.0, point[0] - 1.0, point[1] - 1.0]);
    assert!(matches!(refused(&both(cube(2), &wall), x), SymmetryError::InPlane { count: 8, at, .. } if at[0] == 0.0));
    // Two tips, and two edges, that meet on the plane.
    let tip = Soup::new(
        vec![[0.0; 3], [1.0, 1.0, 0.0], [1.0, -1.0, 1.0], [1.0, -1.0, -1.0]],
        vec![[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]],
    );
    let error = refused(&both(tip.clone(), &mirrored(tip.clone())), x);
    assert!(matches!(error, SymmetryError::Touches { at, .. } if at == [0.0; 3]), "{error}");
    let mut edge = tip;
    edge.points[1] = [0.0, 1.0, 0.0];
    assert!(matches!(refused(&both(edge.clone(), &mirrored(edge)), x), SymmetryError::Touches { .. }));
}

#[test]
fn a_guide_below_the_plane_acts_as_its_mirror_image() {
    let with = |guides: Vec<Guide>| {
        let mut options = options(600, about(Axis::Y, 0.0));
        options.field.guides = guides;
        meshed(&bean(), &options).meshed.mesh
    };
    let guide = |side: f64| Guide::vector([0.2, 0.45 * side, 0.0], [1.0, 0.0, 1.0]).within(0.2);
    let [above, below] = [1.0, -1.0].map(|side| with(vec![guide(side)]));
    assert_eq!(above, below);
    assert_ne!(above, with(Vec::new()), "the guide acts");
}

#[test]
fn regions_and_named_edges_of_the_half_are_kept() {
    let mut soup = cube(4);
    let side = |t: usize| (t / 32) as u32;
    let names = ["left", "right", "front", "back", "bottom", "top"].map(str::to_owned).to_vec();
    soup.regions = Regions { names, of_face: (0..soup.triangles.len()).map(side).collect() };
    let mut options = options(600, about(Axis::X, 0.0));
    options.features.crease = 180.0;
    options.features.region_borders = false;
    let named = [[-1.0, 0.5, 1.0], [1.0, 0.5, 1.0]];
    let on_edge = |mesh: &Mesh| mesh.points.iter().filter(|point| point[1] == 0.5 && point[2] == 1.0).count();
    let without = meshed(&soup, &options).meshed.mesh;
    options.edges = vec![NamedEdge { ends: Ends::Points(named), name: "a line".to_owned() }];
    let outcome = meshed(&soup, &options);
    let mesh = &outcome.meshed.mesh;
    assert!(on_edge(mesh) > 8 && on_edge(&without) < 8, "{} {}", on_edge(mesh), on_edge(&without));
    assert!(
        mesh.regions.of_face.is_sorted() && !mesh.regions.of_face.contains(&0),
        "the left side is that of the right one"
    );
    assert_eq!(outcome.symmetry.map(|symmetry| symmetry.lost_regions), Some(vec!["left".to_owned()]));
}
