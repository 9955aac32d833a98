//! Surfaces whose sheets meet, through the whole method: the mesh branches where they do, and nowhere else.

#[path = "../common/mod.rs"]
mod common;
mod shapes;

use common::surfaces::{distance, scattered, surface, unit_corners};
use glam::DVec3;
use quadmosaic::compute::{Backend, Cpu};
use quadmosaic::gpu::GpuBackend;
use quadmosaic::mesh::Mesh;
use quadmosaic::mesh::check::{check, check_joined};
use quadmosaic::pipeline::{Fineness, Meshed, Options, Outcome, run, unwatched};
use quadmosaic::surface::{Soup, Surface};
use rayon::prelude::*;
use shapes::Shape;
use std::collections::BTreeMap;
use std::sync::OnceLock;

fn meshed(soup: &Soup, points: usize, backend: &dyn Backend) -> Outcome {
    run(soup, &Options::new(Fineness::Points(points)), backend, &unwatched).unwrap_or_else(|error| panic!("{error}"))
}

/// Each shape, meshed with tiles of two sizes.
fn shapes() -> &'static [(Shape, Vec<Outcome>)] {
    static DONE: OnceLock<Vec<(Shape, Vec<Outcome>)>> = OnceLock::new();
    DONE.get_or_init(|| {
        let mesh = |shape: Shape| {
            let outcomes = [200, 700].map(|points| meshed(&shape.soup, points, &Cpu));
            (shape, outcomes.into())
        };
        shapes::all().into_par_iter().map(mesh).collect()
    })
}

/// The edges of faces by how many have them, and the Euler characteristic; vertices are what corners name.
struct Tally {
    edges: BTreeMap<usize, Vec<[DVec3; 2]>>,
    euler: i64,
}

impl Tally {
    fn new<'a>(points: &[[f64; 3]], faces: impl Iterator<Item = &'a [u32]>) -> Self {
        let mut sides: BTreeMap<[u32; 2], usize> = BTreeMap::new();
        let mut used = vec![false; points.len()];
        let mut count = 0;
        for face in faces {
            count += 1;
            for (&a, &b) in face.iter().zip(face.iter().cycle().skip(1)) {
                used[a as usize] = true;
                *sides.entry([a.min(b), a.max(b)]).or_default() += 1;
            }
        }
        let euler = used.iter().filter(|&&used| used).count() as i64 - sides.len() as i64 + count;
        let mut edges: BTreeMap<usize, Vec<[DVec3; 2]>> = BTreeMap::new();
        for (ends, count) in sides {
            edges.entry(count).or_default().push(ends.map(|v| points[v as usize].into()));
        }
        Self { edges, euler }
    }

    fn of_mesh(mesh: &Mesh) -> Self {
        Self::new(&mesh.points, mesh.faces())
    }

    /// Points at one place are one.
    fn of_soup(soup: &Soup) -> Self {
        let mut known = BTreeMap::new();
        let key = |p: &[f64; 3]| p.map(|x| (x * 1e6).round() as i64);
        let number: Vec<u32> =
            (0..).zip(&soup.points).map(|(index, p)| *known.entry(key(p)).or_insert(index)).collect();
        let mut triangles: Vec<[u32; 3]> = soup
            .triangles
            .iter()
            .map(|t| t.map(|v| number[v as usize]))
            .filter(|[a, b, c]| a != b && b != c && c != a)
            .collect();
        triangles.sort_by_key(|t| sorted(*t));
        triangles.dedup_by_key(|t| sorted(*t));
        Self::new(&soup.points, triangles.iter().map(|t| &t[..]))
    }

    fn length(&self, faces: usize) -> f64 {
        self.edges.get(&faces).into_iter().flatten().map(|[a, b]| a.distance(*b)).sum()
    }
}

fn sorted(mut t: [u32; 3]) -> [u32; 3] {
    t.sort_unstable();
    t
}

/// How a mesh branches, ends or is connected otherwise than the surface does.
fn difference(surface: &Soup, mesh: &Mesh, roundness: f64) -> Option<String> {
    let [given, made] = [Tally::of_soup(surface), Tally::of_mesh(mesh)];
    let kinds = |tally: &Tally| tally.edges.keys().copied().filter(|&faces| faces != 2).collect::<Vec<_>>();
    if kinds(&given) != kinds(&made) {
        return Some(format!("edges have {:?} faces, not {:?}", kinds(&made), kinds(&given)));
    }
    for faces in kinds(&given) {
        let (wanted, length) = (given.length(faces), made.length(faces));
        if (length / wanted - 1.0).abs() > 1e-5 + roundness {
            return Some(format!("edges of {faces} faces have length {length}, not {wanted}"));
        }
        let far = |p: DVec3| given.edges[&faces].iter().map(|&[a, b]| distance(p, [a, b, b])).fold(f64::MAX, f64::min);
        let mean = length / made.edges[&faces].len() as f64;
        if let Some([a, b]) = made.edges[&faces]
            .iter()
            .find(|[a, b]| far(*a).max(far(*b)) > 1e-5 || far(a.midpoint(*b)) > 1e-5 + 2.0 * mean * roundness.sqrt())
        {
            return Some(format!("the edge from {a} to {b} has {faces} faces"));
        }
    }
    (given.euler != made.euler).then(|| format!("Euler characteristic {}, not {}", made.euler, given.euler))
}

#[test]
fn meshes_branch_where_sheets_meet_and_nowhere_else() {
    for (shape, outcomes) in shapes() {
        for Meshed { mesh, branches, faults, differences, .. } in outcomes.iter().map(|outcome| &outcome.meshed) {
            let what = format!("{}, {} vertices", shape.name, mesh.points.len());
            assert_eq!(difference(&shape.meant, mesh, shape.roundness), None, "{what}");
            assert!(faults.is_clean(), "{what}: {faults}");
            assert_eq!((check_joined(mesh, branches).list.len(), differences.as_slice()), (0, &[][..]), "{what}");
            assert!(!check(mesh).is_clean(), "{what}: for one who does not know the surface, it branches");
        }
    }
}

#[test]
fn a_line_where_sheets_meet_may_end_inside_one_of_them() {
    let (_, outcomes) = shapes().iter().find(|one| one.0.name == "a plate standing within a plate").expect("a shape");
    for Meshed { mesh, branches, faults, .. } in outcomes.iter().map(|outcome| &outcome.meshed) {
        assert!(faults.is_clean(), "{faults}");
        for tip in [DVec3::new(0.0, 0.25, 0.0), DVec3::new(0.0, 0.75, 0.0)] {
            let at = mesh.points.iter().position(|&p| DVec3::from(p).distance(tip) < 1e-6).expect("a vertex is there");
            assert!(branches[at], "sheets meet at the end of the line too");
            let mut others = branches.clone();
            others[at] = false;
            assert!(!check_joined(mesh, &others).is_clean(), "the end is told where it is not known");
        }
    }
}

#[test]
fn another_way_to_branch_is_seen() {
    for (shape, outcomes) in shapes() {
        let Meshed { mesh, branches, .. } = &outcomes[1].meshed;
        let branch = branches.iter().position(|&branches| branches).expect("they branch") as u32;
        // One face at a branch has a vertex of its own there; then it is gone.
        let at = mesh.faces().position(|face| face.contains(&branch)).expect("a face is at it");
        let torn = |keep: bool| {
            let mut torn = Mesh::new(mesh.points.clone());
            torn.points.push(mesh.points[branch as usize]);
            for (index, face) in mesh.faces().enumerate() {
                let own = |&v: &u32| if index == at && v == branch { mesh.points.len() as u32 } else { v };
                if keep || index != at {
                    torn.push_face(&face.iter().map(own).collect::<Vec<_>>());
                }
            }
            torn
        };
        for keep in [true, false] {
            assert!(difference(&shape.meant, &torn(keep), shape.roundness).is_some(), "{}: {keep}", shape.name);
        }
    }
    // Each has a way of its own.
    let mesh = |name: &str| &shapes().iter().find(|(shape, _)| shape.name == name).expect("a shape").1[0].meshed.mesh;
    let [three, four] = ["three pages at a spine", "four pages at a spine"].map(mesh);
    for (angles, wanted) in [(&[0.0, 100.0, 220.0][..], [true, false]), (&[0.0, 80.0, 170.0, 260.0], [false, true])] {
        let found = [three, four].map(|mesh| difference(&shapes::book(angles), mesh, 0.0).is_none());
        assert_eq!(found, wanted);
    }
    let [one, two] = ["two boxes at one wall", "two boxes at two walls"].map(mesh);
    assert_eq!(difference(&shapes::boxes_at_a_wall(), one, 0.0), None);
    assert!(difference(&shapes::boxes_at_a_wall(), two, 0.0).is_some_and(|what| what.contains("[4] faces, not [3]")));
}

#[test]
fn meshes_of_sheets_lie_on_them() {
    for (shape, outcomes) in shapes() {
        let Outcome { surface, meshed: Meshed { mesh, .. }, .. } = &outcomes[0];
        let triangles: Vec<_> =
            (0..shape.soup.triangles.len()).map(|t| unit_corners(&shape.soup, surface.frame(), t)).collect();
        let far = |p: [f64; 3]| {
            let p = DVec3::from(surface.frame().to_unit(p));
            triangles.iter().map(|&corners| distance(p, corners)).fold(f64::MAX, f64::min)
        };
        // As on any surface: some ten roundings of f32 an edge crossed.
        let worst = mesh.points.iter().map(|&p| far(p)).fold(0.0, f64::max);
        assert!(worst < 2e-6, "{}: {worst:e}", shape.name);
        let off = mesh.points.iter().map(|p| far(p.map(|x| 1.0001 * x + 1e-4))).fold(0.0, f64::max);
        assert!(off > 2e-6, "{}: moved, it is not", shape.name);
    }
}

#[test]
fn triangles_may_look_any_way() {
    let features = |surface: &Surface| (surface.features().curves().len(), surface.features().corners().count());
    shapes::all().into_par_iter().for_each(|shape| {
        let plain = features(&surface(&shape.soup));
        let count = shape.soup.triangles.len();
        let mut random = scattered(5);
        let scattered: Vec<bool> = (0..count).map(|_| random() < 0.3).collect();
        let half: Vec<bool> = (0..count).map(|t| 2 * t > count).collect();
        for (name, turned) in [("three of ten triangles", scattered), ("the second half", half)] {
            // Which triangles of two walls at one place go together is told by nothing but the way they look.
            if name != "the second half" && shape.name == "two boxes at two walls" {
                continue;
            }
            let mut soup = shape.soup.clone();
            soup.triangles.iter_mut().zip(turned).filter(|(_, turned)| *turned).for_each(|(t, _)| t.swap(1, 2));
            let outcome = meshed(&soup, 200, &Cpu);
            let what = format!("{}, {name} turned over", shape.name);
            let Meshed { mesh, faults, differences, .. } = &outcome.meshed;
            assert_eq!(difference(&shape.meant, mesh, shape.roundness), None, "{what}");
            assert!(faults.is_clean() && differences.is_empty(), "{what}: {faults} {differences:?}");
            // A seam that is paired in one way here and in another there has corners between.
            if name != "the second half" {
                assert_eq!(features(&surface(&soup)), plain, "{what}");
            }
        }
    });
}

#[test]
fn meshes_of_sheets_are_the_same_on_the_gpu() {
    let Some(gpu) = common::gpu() else { return };
    let backend = GpuBackend::new(gpu).unwrap_or_else(|error| panic!("{error}"));
    let cpu = shapes().iter().find(|(shape, _)| shape.name == "a disc in a tube").expect("a shape");
    let soup = &cpu.0.soup;
    let mesh = meshed(soup, 200, &backend).meshed.mesh;
    assert_eq!(difference(soup, &mesh, cpu.0.roundness), None);
    assert!(gpu.adapter().hardware || mesh == cpu.1[0].meshed.mesh);
    assert_ne!(mesh, cpu.1[1].meshed.mesh);
}
