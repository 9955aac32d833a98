//! A mesh against the surface that it stands for: closed forms on flat squares, and what an independent judge measured.

mod common;

use common::surfaces::{flat, surface};
use quadmosaic::mesh::Mesh;
use quadmosaic::mesh::check::{Faults, Kind, check};
use quadmosaic::mesh::compare::{Comparison, Difference, check_against};
use quadmosaic::mesh::quality::Quality;
use quadmosaic::surface::load::read;
use quadmosaic::surface::{Soup, Surface};
use std::f64::consts::{SQRT_2, TAU};

/// The surface is rounded to 6e-8 of its diagonal, which is some tens of edge lengths.
const CLOSE: f64 = 1e-5;
const CELLS: usize = 6;

/// Faces that a quad of the middle is one of.
const MIDDLE: usize = 3 * CELLS + 2;

/// A flat square of `CELLS` by `CELLS` unit squares; its normal is z.
fn grid() -> Mesh {
    let side = CELLS as u32 + 1;
    let mut mesh = Mesh::new((0..side * side).map(|v| [f64::from(v % side), f64::from(v / side), 0.0]).collect());
    for cell in 0..(CELLS * CELLS) as u32 {
        let v = cell / CELLS as u32 * side + cell % CELLS as u32;
        mesh.push_face(&[v, v + 1, v + 1 + side, v + side]);
    }
    mesh
}

/// The same extent as triangles.
fn ground() -> Surface {
    surface(&flat(2 * CELLS, 2 * CELLS, 0.5))
}

/// The mesh with one face as `change` makes it; no face where that is too short.
fn with_face(mesh: &Mesh, face: usize, change: impl Fn(&mut Vec<u32>)) -> Mesh {
    let mut changed = Mesh::new(mesh.points.clone());
    for (id, corners) in mesh.faces().enumerate() {
        let mut corners = corners.to_vec();
        if id == face {
            change(&mut corners);
        }
        if corners.len() > 2 {
            changed.push_face(&corners);
        }
    }
    changed
}

fn moved(mesh: &Mesh, change: impl Fn([f64; 3]) -> [f64; 3]) -> Mesh {
    let mut moved = mesh.clone();
    moved.points.iter_mut().for_each(|point| *point = change(*point));
    moved
}

fn compared(mesh: &Mesh, surface: &Surface) -> (Faults, Comparison) {
    let (faults, comparison) = check_against(mesh, surface);
    (faults, comparison.expect("both have an extent"))
}

fn kinds(faults: &Faults) -> Vec<Kind> {
    faults.list.iter().map(|fault| fault.kind).collect()
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() < CLOSE
}

fn near_place(a: [f64; 3], b: [f64; 3]) -> bool {
    a.iter().zip(b).all(|(a, b)| near(*a, b))
}

#[test]
fn a_mesh_on_its_surface_has_no_fault() {
    let (faults, comparison) = compared(&grid(), &ground());
    assert!(faults.is_clean() && comparison.differences.is_empty(), "{faults}");
    assert!(comparison.hausdorff < CLOSE, "{comparison:?}");
    let features = comparison.features.expect("the rim");
    assert_eq!(features.edges, 8 * CELLS);
    assert!(features.max.distance < CLOSE && features.mean < CLOSE);
    assert_eq!(
        (comparison.topology.euler, comparison.topology.boundary_loops, comparison.topology.components),
        (1, 1, 1)
    );
}

#[test]
fn a_mesh_beside_its_surface_is_as_far_off_as_it_is() {
    // Edges are 1 long, so distances are what they are.
    let lifted = |height: f64| compared(&moved(&grid(), |[x, y, z]| [x, y, z + height]), &ground());
    let (faults, comparison) = lifted(0.5);
    assert!(faults.is_clean(), "{faults}");
    let features = comparison.features.expect("the rim");
    let Comparison { to_surface, to_mesh, vertices_to_surface, hausdorff, .. } = comparison;
    for distance in [to_surface.distance, to_mesh.distance, vertices_to_surface.distance, hausdorff, features.mean] {
        assert!(near(distance, 0.5), "{distance}");
    }
    assert!(near(features.p99, 0.5) && near(features.max.distance, 0.5));
    assert!(near(comparison.hausdorff_over_diagonal, 0.5 / (SQRT_2 * CELLS as f64)));

    let (faults, _) = lifted(1.5);
    let stray = |kind: &Kind| matches!(kind, Kind::StrayVertex { distance, .. } if near(*distance, 1.5));
    assert_eq!(faults.count(stray), grid().points.len());
    let sides = 4 * CELLS as u32;
    assert_eq!(faults.count(|kind| *kind == Kind::Hole { vertex: 0, sides }), 1, "its rim is none of the surface's");
}

#[test]
fn features_are_as_far_from_edges_as_the_rim_is_drawn_in() {
    let inset = 0.2;
    let scale = 1.0 - 2.0 * inset / CELLS as f64;
    let (_, comparison) = compared(&moved(&grid(), |[x, y, z]| [inset + scale * x, inset + scale * y, z]), &ground());
    let features = comparison.features.expect("the rim");
    // At a corner both coordinates are off, and edges have become shorter.
    assert!(near(features.max.distance * scale, SQRT_2 * inset), "{features:?}");
    assert!(near(features.p99 * scale, inset) || features.p99 * scale > inset);
    assert!(features.mean * scale > inset && features.mean < features.max.distance);
    assert!(near(comparison.to_mesh.distance * scale, SQRT_2 * inset));
    assert!(comparison.to_surface.distance < CLOSE, "seen from the mesh alone nothing is missing");
}

#[test]
fn a_missing_face_is_a_hole_and_has_a_place() {
    let surface = ground();
    let (faults, comparison) = compared(&with_face(&grid(), MIDDLE, Vec::clear), &surface);
    let [hole] = faults.list[..] else { panic!("{faults}") };
    assert!(matches!(hole.kind, Kind::Hole { sides: 4, .. }), "{hole}");
    assert_eq!(hole.at, [2.5, 3.5, 0.0]);
    assert_eq!(faults.hole_triangles(), 2);
    let differences = [Difference::Euler { mesh: 0, surface: 1 }, Difference::BoundaryLoops { mesh: 2, surface: 1 }];
    assert_eq!(comparison.differences, differences);

    // At the rim it is a bay: the boundary is as many curves as it was, but a corner of the surface is left uncovered.
    let (faults, comparison) = compared(&with_face(&grid(), 0, Vec::clear), &surface);
    assert_eq!(kinds(&faults), [Kind::IsolatedVertex { vertex: 0 }]);
    assert!(comparison.differences.iter().all(|difference| matches!(difference, Difference::Uncovered { .. })));
    assert!(near(comparison.to_mesh.distance, 1.0) && near_place(comparison.to_mesh.at, [0.0; 3]), "{comparison:?}");
}

#[test]
fn a_face_that_looks_away_is_found() {
    let (faults, _) = compared(&with_face(&grid(), MIDDLE, |face| face.reverse()), &ground());
    let flipped = |kind: &Kind| matches!(kind, Kind::FlippedFace { .. });
    assert_eq!(faults.count(flipped), 1);
    assert!(kinds(&faults).contains(&Kind::FlippedFace { face: MIDDLE as u32 }));
    // Turned over as a whole it is a good mesh by itself.
    let mut back = Mesh::new(grid().points);
    grid().faces().for_each(|face| back.push_face(&face.iter().rev().copied().collect::<Vec<_>>()));
    assert!(check(&back).is_clean());
    assert_eq!(compared(&back, &ground()).0.count(flipped), CELLS * CELLS);
}

#[test]
fn a_face_beyond_a_sharp_edge_looks_away_from_one_of_its_sides() {
    // A wedge of two faces, and a mesh of it that overhangs its edge: what is nearest is the edge, which has two sides.
    let soup = Soup {
        points: vec![
            [0.0, 0.0, 0.1],
            [0.0, 4.0, 0.1],
            [1.0, 0.0, 0.0],
            [1.0, 4.0, 0.0],
            [0.0, 0.0, -0.1],
            [0.0, 4.0, -0.1],
        ],
        triangles: vec![[0, 2, 1], [1, 2, 3], [4, 5, 2], [2, 5, 3]],
        ..Soup::default()
    };
    let face = |x: [f64; 2], upper: bool| {
        let z = if upper { 0.05 } else { -0.05 };
        let mut mesh = Mesh::new(vec![[x[0], 1.0, z], [x[1], 1.0, 0.0], [x[1], 2.0, 0.0], [x[0], 2.0, z]]);
        mesh.push_face(if upper { &[0, 1, 2, 3] } else { &[3, 2, 1, 0] });
        compared(&mesh, &surface(&soup)).0.count(|kind| matches!(kind, Kind::FlippedFace { .. }))
    };
    assert_eq!([true, false].map(|upper| face([0.9, 1.5], upper)), [1, 1]);
    assert_eq!([true, false].map(|upper| face([0.5, 1.0], upper)), [0, 0]);
}

#[test]
fn a_vertex_off_the_surface_is_found() {
    let lifted = |height: f64| {
        let mut mesh = grid();
        mesh.points[24][2] = height;
        let mean = Quality::of(&mesh).mean_edge;
        (compared(&mesh, &ground()), height / mean)
    };
    let ((faults, comparison), distance) = lifted(3.0);
    let [stray] = faults.list[..] else { panic!("{faults}") };
    assert!(matches!(stray.kind, Kind::StrayVertex { vertex: 24, distance: d } if near(d, distance)), "{stray}");
    assert!(near(comparison.to_surface.distance, distance));
    assert!(near_place(comparison.to_surface.at, [3.0, 3.0, 3.0]), "{comparison:?}");

    let ((faults, comparison), distance) = lifted(0.9);
    assert!(faults.is_clean(), "{faults}");
    assert!(near(comparison.hausdorff, distance));
}

#[test]
fn other_units_are_asked_about() {
    let said = |scale: f64| -> Vec<String> {
        let (_, comparison) = compared(&moved(&grid(), |point| point.map(|x| scale * x)), &ground());
        let is_lost = |difference: &&Difference| matches!(difference, Difference::Uncovered { .. });
        comparison.differences.iter().filter(|difference| !is_lost(difference)).map(ToString::to_string).collect()
    };
    assert_eq!(said(1000.0), ["the mesh is 1000 times larger than the surface; are the units the same?"]);
    assert_eq!(said(1.0 / 25.4), ["the mesh is 25 times smaller than the surface; are the units the same?"]);
    assert!(said(1.9).is_empty() && said(0.6).is_empty());
}

#[test]
fn a_lost_part_is_a_difference() {
    let mut two = flat(4, 4, 1.0);
    let other = flat(4, 4, 1.0);
    let first = two.points.len() as u32;
    two.points.extend(other.points.iter().map(|[x, y, _]| [*x, *y, 5.0]));
    two.triangles.extend(other.triangles.iter().map(|corners| corners.map(|v| v + first)));
    let mesh = |soup: &Soup| Mesh::from(soup.clone());
    assert!(compared(&mesh(&two), &surface(&two)).1.differences.is_empty());
    let (faults, comparison) = compared(&mesh(&other), &surface(&two));
    assert!(faults.is_clean());
    let lost = Difference::Components { mesh: 1, surface: 2 };
    assert!(comparison.differences.contains(&lost), "{comparison:?}");
    assert!(comparison.to_surface.distance < CLOSE && comparison.to_mesh.distance > 1.0);
}

/// Three pages of two squares by two that meet at a spine along z; the third begins at `x`.
fn book(x: f64) -> Mesh {
    let mut mesh = Mesh::default();
    let vertex = |mesh: &mut Mesh, at: [f64; 3]| {
        let known = mesh.points.iter().position(|point| *point == at);
        known.unwrap_or_else(|| {
            mesh.points.push(at);
            mesh.points.len() - 1
        }) as u32
    };
    for [dx, dy, from] in [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, x]] {
        for i in 0..2 {
            for k in 0..2 {
                let at = |i: i32, k: i32| [from + dx * f64::from(i), dy * f64::from(i), f64::from(k)];
                let face = [at(i, k), at(i + 1, k), at(i + 1, k + 1), at(i, k + 1)].map(|at| vertex(&mut mesh, at));
                mesh.push_face(&face);
            }
        }
    }
    mesh
}

fn triangles(mesh: &Mesh) -> Soup {
    let mut soup = Soup { points: mesh.points.clone(), ..Soup::default() };
    for face in mesh.faces() {
        soup.triangles.extend((2..face.len()).map(|k| [face[0], face[k - 1], face[k]]));
    }
    soup
}

#[test]
fn where_sheets_meet_the_mesh_may_branch() {
    let branching = |kind: &Kind| {
        matches!(kind, Kind::NonManifoldEdge { .. } | Kind::NonManifoldVertex { .. } | Kind::MisorientedEdge { .. })
    };
    assert_eq!(check(&book(0.0)).count(branching), 2, "it does not know of the surface");
    let (faults, comparison) = compared(&book(0.0), &surface(&triangles(&book(0.0))));
    assert_eq!(faults.count(branching), 0, "{faults}");
    assert!(comparison.differences.is_empty(), "{comparison:?}");
    // A page that is bound elsewhere is not excused.
    let (faults, _) = compared(&book(1.0), &surface(&triangles(&book(0.0))));
    assert_eq!(faults.count(branching), 2, "{faults}");
}

#[test]
fn what_cannot_be_compared_is_checked_alone() {
    let surface = ground();
    let mut missing = grid();
    missing.push_face(&[0, 1, 999]);
    let mut nowhere = grid();
    nowhere.points[3][1] = f64::NAN;
    let mut far = grid();
    far.points[3][1] = 1e200;
    for mesh in [Mesh::default(), missing, nowhere, far, moved(&grid(), |_| [1.0; 3])] {
        let (faults, comparison) = check_against(&mesh, &surface);
        assert_eq!(kinds(&faults), kinds(&check(&mesh)));
        assert!(comparison.is_none());
    }
    // A vertex that no face uses may be anywhere.
    let mut unused = grid();
    unused.points.push([f64::NAN; 3]);
    assert!(compared(&unused, &surface).1.hausdorff < CLOSE);
}

#[test]
fn a_model_agrees_with_itself() {
    for name in ["fandisk", "holes_cgal", "m6_gen", "spot"] {
        let Some(file) = common::shared(&format!("models/{name}.obj")) else { continue };
        let soup = read(&file).unwrap_or_else(|error| panic!("{error}"));
        let (surface, mesh) = (surface(&soup), Mesh::from(soup));
        let (faults, comparison) = compared(&mesh, &surface);
        assert!(faults.is_clean() && comparison.differences.is_empty(), "{name}: {faults}");
        assert!(comparison.hausdorff < 10.0 * CLOSE, "{name}: {comparison:?}");
        assert!(comparison.features.is_none_or(|features| features.max.distance < 10.0 * CLOSE), "{name}");
        let (faults, _) = compared(&with_face(&mesh, mesh.face_count() / 2, Vec::clear), &surface);
        assert_eq!(faults.count(|kind| matches!(kind, Kind::Hole { sides: 3, .. })), 1, "{name}: {faults}");
    }
}

/// A can of radius 1 and height 2 whose wall is `around` by `up` quads from the angle `turn` on; the lid is a fan of
/// triangles, the bottom one polygon.
fn can(around: u32, up: u32, turn: f64) -> Mesh {
    let mut mesh = Mesh::default();
    for j in 0..=up {
        mesh.points.extend((0..around).map(|i| {
            let angle = TAU * (f64::from(i) + turn) / f64::from(around);
            [angle.cos(), angle.sin(), 2.0 * f64::from(j) / f64::from(up)]
        }));
    }
    mesh.points.push([0.0, 0.0, 2.0]);
    let at = |i: u32, j: u32| j * around + i % around;
    for j in 0..up {
        (0..around).for_each(|i| mesh.push_face(&[at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]));
    }
    (0..around).for_each(|i| mesh.push_face(&[at(i, up), at(i + 1, up), (up + 1) * around]));
    mesh.push_face(&(0..around).rev().collect::<Vec<_>>());
    mesh
}

/// The can and what is damaged of it: a face of the wall, its first corner or the vertex there.
fn cans() -> [(&'static str, Mesh); 6] {
    let (can, face) = (can(24, 6, 0.5), 60);
    let corner = can.face(face)[0] as usize;
    let lost = with_face(&can, face, Vec::clear);
    let flipped = with_face(&can, face, |face| face.reverse());
    let mut doubled = with_face(&can, face, |corners| corners[0] = can.points.len() as u32);
    doubled.points.push(can.points[corner]);
    let (mut folded, mut moved) = (can.clone(), can.clone());
    let across = can.points[can.face(face)[2] as usize];
    folded.points[corner] = [0, 1, 2].map(|k| 1.3 * across[k] - 0.3 * can.points[corner][k]);
    moved.points[corner][0] *= 2.0;
    moved.points[corner][1] *= 2.0;
    [("whole", can), ("lost", lost), ("flipped", flipped), ("doubled", doubled), ("folded", folded), ("moved", moved)]
}

const COUNTS: [&str; 16] = [
    "vertices",
    "quads",
    "triangles",
    "interior vertices",
    "irregular vertices",
    "Euler characteristic",
    "boundary loops",
    "feature edges",
    "non-manifold edges",
    "misoriented edges",
    "repeated faces",
    "isolated vertices",
    "degenerate faces",
    "concave quads",
    "flipped faces",
    "holes",
];

const FIGURES: [&str; 18] = [
    "Qr",
    "Qg",
    "Qg 1 %",
    "Qg least",
    "Tg",
    "Jacobian",
    "Jacobian 1 %",
    "Jacobian least",
    "mean edge",
    "edge deviation",
    "vertices to surface",
    "to surface",
    "to mesh",
    "Hausdorff",
    "Hausdorff over diagonal",
    "features mean",
    "features 99 %",
    "features most",
];

/// What `meter.py`, a judge that shares no code with this program, measured on the files of [`cans`] against a can of 60 by
/// 10 quads, to seven digits: [`COUNTS`] and [`FIGURES`].
const JUDGED: [(&str, [i64; 16], [f64; 18]); 6] = [
    (
        "whole",
        [169, 144, 24, 169, 25, 2, 0, 120, 0, 0, 0, 0, 0, 0, 0, 0],
        [
            0.757_894_7,
            0.970_854_9,
            0.970_854_9,
            0.970_854_9,
            0.433_516,
            1.0,
            1.0,
            1.0,
            0.344_811_9,
            0.536_536_5,
            0.002_980_728,
            0.024_777_03,
            0.024_811_03,
            0.024_811_03,
            0.002_469_656,
            0.014_339_77,
            0.024_811_03,
            0.024_811_03,
        ],
    ),
    (
        "lost",
        [169, 143, 24, 165, 25, 1, 1, 120, 0, 0, 0, 0, 0, 0, 0, 1],
        [
            0.748_691_1,
            0.970_854_9,
            0.970_854_9,
            0.970_854_9,
            0.433_516,
            1.0,
            1.0,
            1.0,
            0.344_811_9,
            0.536_536_5,
            0.002_980_728,
            0.024_777_03,
            0.328_610_7,
            0.328_610_7,
            0.032_709_46,
            0.014_339_77,
            0.024_811_03,
            0.024_811_03,
        ],
    ),
    (
        "flipped",
        [169, 144, 24, 165, 25, 2, 1, 120, 0, 4, 0, 0, 0, 0, 1, 1],
        [
            0.75,
            0.970_854_9,
            0.970_854_9,
            0.970_854_9,
            0.433_516,
            1.0,
            1.0,
            1.0,
            0.344_811_9,
            0.536_536_5,
            0.002_980_728,
            0.024_777_03,
            0.024_811_03,
            0.024_811_03,
            0.002_469_656,
            0.014_339_77,
            0.024_811_03,
            0.024_811_03,
        ],
    ),
    (
        "doubled",
        [170, 144, 24, 166, 25, 1, 1, 120, 0, 0, 0, 0, 0, 0, 0, 1],
        [
            0.75,
            0.970_854_9,
            0.970_854_9,
            0.970_854_9,
            0.433_516,
            1.0,
            1.0,
            1.0,
            0.344_530_1,
            0.53555,
            0.002_983_166,
            0.024_797_29,
            0.024_831_32,
            0.024_831_32,
            0.002_469_656,
            0.014_351_5,
            0.024_831_32,
            0.024_831_32,
        ],
    ),
    (
        "folded",
        [169, 144, 24, 169, 25, 2, 0, 120, 0, 0, 0, 0, 0, 3, 1, 0],
        [
            0.757_894_7,
            0.945_355_6,
            0.0,
            0.0,
            0.433_516,
            0.965_856_2,
            -0.215_243_4,
            -1.0,
            0.348_324_3,
            0.540_005_7,
            0.041_830_42,
            0.106_589_8,
            0.108_292_4,
            0.108_292_4,
            0.010_889_08,
            0.014_195_17,
            0.024_560_84,
            0.024_560_84,
        ],
    ),
    (
        "moved",
        [169, 144, 24, 169, 25, 2, 0, 120, 0, 0, 0, 0, 0, 0, 0, 0],
        [
            0.757_894_7,
            0.945_694_8,
            0.065_090_85,
            0.065_090_85,
            0.433_516,
            0.982_920_4,
            0.385_135_6,
            0.385_135_6,
            0.353_893_3,
            0.566_494_7,
            2.827_646,
            2.827_646,
            0.501_840_5,
            2.827_646,
            0.288_872_9,
            0.013_971_79,
            0.024_174_34,
            0.024_174_34,
        ],
    ),
];

fn counts_of(quality: &Quality, faults: &Faults, comparison: &Comparison) -> [i64; 16] {
    let count = |which: fn(&Kind) -> bool| faults.count(which) as i64;
    [
        quality.vertices as i64,
        quality.quads as i64,
        quality.triangles as i64,
        quality.interior_vertices as i64,
        quality.irregular_vertices as i64,
        faults.euler,
        faults.boundary_loops as i64,
        comparison.features.expect("the rims").edges as i64,
        count(|kind| matches!(kind, Kind::NonManifoldEdge { .. })),
        count(|kind| matches!(kind, Kind::MisorientedEdge { .. })),
        count(|kind| matches!(kind, Kind::DuplicateFace { .. })),
        count(|kind| matches!(kind, Kind::IsolatedVertex { .. })),
        count(|kind| matches!(kind, Kind::DegenerateFace { .. })),
        count(|kind| matches!(kind, Kind::ConcaveQuad { .. })),
        count(|kind| matches!(kind, Kind::FlippedFace { .. })),
        count(|kind| matches!(kind, Kind::Hole { .. })),
    ]
}

fn figures_of(quality: &Quality, comparison: &Comparison) -> [f64; 18] {
    let [qg, tg, jacobian] =
        [quality.qg, quality.tg, quality.scaled_jacobian].map(|spread| spread.expect("faces of both kinds"));
    let features = comparison.features.expect("the rims");
    [
        quality.qr,
        qg.mean,
        qg.p01,
        qg.min,
        tg.mean,
        jacobian.mean,
        jacobian.p01,
        jacobian.min,
        quality.mean_edge,
        quality.edge_cv,
        comparison.vertices_to_surface.distance,
        comparison.to_surface.distance,
        comparison.to_mesh.distance,
        comparison.hausdorff,
        comparison.hausdorff_over_diagonal,
        features.mean,
        features.p99,
        features.max.distance,
    ]
}

#[test]
fn figures_agree_with_an_independent_judge() {
    let surface = surface(&triangles(&can(60, 10, 0.0)));
    let mut all = Vec::new();
    for ((name, mesh), (judged, counts, figures)) in cans().iter().zip(JUDGED) {
        assert_eq!(*name, judged);
        let (faults, comparison) = compared(mesh, &surface);
        let quality = Quality::with_holes(mesh, faults.hole_triangles());
        for ((found, judged), what) in counts_of(&quality, &faults, &comparison).iter().zip(counts).zip(COUNTS) {
            assert_eq!(*found, judged, "{name}: {what}");
        }
        let found = figures_of(&quality, &comparison);
        for ((found, judged), what) in found.iter().zip(figures).zip(FIGURES) {
            assert!(near(*found, judged), "{name}: {what} is {found}, judged {judged}");
        }
        all.push(found);
    }
    let agree = |k: usize| all[0].iter().zip(JUDGED[k].2).all(|(found, judged)| near(*found, judged));
    assert!((1..JUDGED.len()).filter(|k| agree(*k)).count() == 0, "the whole can must not pass for a damaged one");
}
