//! Properties that hold for any surface, tried on random ones: smooth shears of surfaces with known topology.
//!
//! Environment variables:
//!
//! - `PROPTEST_CASES`: the number of surfaces of each test, instead of a few.
//! - `PROPTEST_RNG_SEED`: other surfaces.

mod common;

use common::surfaces::{EXAMPLES, example};
use glam::{DMat3, DQuat, DVec3};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use quadmosaic::compute::Cpu;
use quadmosaic::field::{Field, FieldOptions};
use quadmosaic::mesh::Mesh;
use quadmosaic::mesh::quality::Quality;
use quadmosaic::parametrize::{Parametrization, Rows};
use quadmosaic::pipeline::{Fineness, Meshed, Options, run, unwatched};
use quadmosaic::surface::{FeatureOptions, Soup, Surface};
use std::collections::{HashMap, HashSet};
use std::f64::consts::TAU;
use std::fmt;

/// So many surfaces where the environment asks for no other number, and the same ones each time.
fn config(cases: u32) -> ProptestConfig {
    let asked = |name: &str| std::env::var_os(name).is_some();
    let mut config = ProptestConfig { failure_persistence: None, max_shrink_iters: 20, ..ProptestConfig::default() };
    if !asked("PROPTEST_CASES") {
        config.cases = cases;
    }
    if !asked("PROPTEST_RNG_SEED") {
        config.rng_seed = RngSeed::Fixed(1);
    }
    config
}

/// A surface with its topology, and the number of vertices to ask for.
#[derive(Clone)]
struct Given {
    soup: Soup,
    /// The example that it is made of, and how.
    name: String,
    euler: i64,
    loops: usize,
    points: usize,
}

impl fmt::Debug for Given {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, {} points asked for", self.name, self.points)
    }
}

fn surfaces() -> impl Strategy<Value = Given> {
    let shape = (0..4_usize, 400..1_500_usize);
    let stretch = prop::array::uniform3(0.7..1.4);
    let wave = (0.0..0.15, 1.0..2.5, 0.0..TAU);
    (shape, stretch, wave, 150..400_usize).prop_map(|((shape, triangles), stretch, wave, points)| {
        let (name, euler, loops) = EXAMPLES[shape];
        let (height, waves, phase): (f64, f64, f64) = wave;
        let mut soup = example(name, triangles);
        for point in &mut soup.points {
            let [x, y, z] = [0, 1, 2].map(|k| point[k] * stretch[k]);
            *point = [x, y, z + height * (waves * x + 0.7 * waves * y + phase).sin()];
        }
        let name = format!("{name} of {triangles} triangles, stretched by {stretch:?}, with waves {wave:?}");
        Given { soup, name, euler, loops, points }
    })
}

fn rotations() -> impl Strategy<Value = DMat3> {
    let angles = prop::array::uniform3(0.0..TAU);
    angles.prop_map(|[a, b, c]| DMat3::from_quat(DQuat::from_euler(glam::EulerRot::XYZ, a, b, c)))
}

fn meshed(soup: &Soup, points: usize) -> Meshed {
    let done = run(soup, &Options::new(Fineness::Points(points)), &Cpu, &unwatched);
    done.unwrap_or_else(|error| panic!("{error}")).meshed
}

fn mapped(soup: &Soup, map: impl Fn(DVec3) -> DVec3) -> Soup {
    let points = soup.points.iter().map(|&point| map(point.into()).into()).collect();
    Soup { points, ..soup.clone() }
}

/// What a reader of the faces alone counts: the Euler characteristic, the boundary loops, and the directed edges that two faces have.
fn counted(mesh: &Mesh) -> (i64, usize, usize) {
    let sides =
        |face: &[u32]| -> Vec<[u32; 2]> { (0..face.len()).map(|i| [face[i], face[(i + 1) % face.len()]]).collect() };
    let mut directed: HashMap<[u32; 2], usize> = HashMap::new();
    mesh.faces().flat_map(sides).for_each(|side| *directed.entry(side).or_default() += 1);
    let vertices: HashSet<u32> = directed.keys().flatten().copied().collect();
    let edges: HashSet<[u32; 2]> = directed.keys().map(|&[a, b]| [a.min(b), a.max(b)]).collect();
    let euler = vertices.len() as i64 - edges.len() as i64 + mesh.face_count() as i64;
    let mut open: HashMap<u32, u32> =
        directed.keys().filter(|&&[a, b]| !directed.contains_key(&[b, a])).map(|&[a, b]| (b, a)).collect();
    let mut loops = 0;
    while let Some(&start) = open.keys().next() {
        let mut at = start;
        while let Some(next) = open.remove(&at) {
            at = next;
        }
        loops += 1;
    }
    (euler, loops, directed.values().filter(|&&count| count > 1).count())
}

/// The volume that the fans of faces enclose with the origin.
fn volume<'a>(points: &[[f64; 3]], faces: impl Iterator<Item = &'a [u32]>) -> f64 {
    let at = |v: u32| DVec3::from(points[v as usize]);
    let fans = faces.flat_map(|face| face.windows(2).skip(1).map(|edge| [face[0], edge[0], edge[1]]));
    fans.map(|[a, b, c]| at(a).dot(at(b).cross(at(c))) / 6.0).sum()
}

/// The mesh without a face that touches no boundary.
fn without_an_inner_face(mesh: &Mesh) -> Mesh {
    let edges = mesh.edges();
    let open: HashSet<u32> = edges.iter().filter(|edge| edge.is_boundary()).flat_map(|edge| edge.ends).collect();
    let is_inner = |face: &[u32]| face.iter().all(|v| !open.contains(v));
    let left_out = mesh.faces().position(is_inner).expect("there are some hundred faces");
    let mut other = Mesh::new(mesh.points.clone());
    mesh.faces().enumerate().filter(|(index, _)| *index != left_out).for_each(|(_, face)| other.push_face(face));
    other
}

fn with_first_face_turned(mesh: &Mesh) -> Mesh {
    let mut other = Mesh::new(mesh.points.clone());
    other.push_face(&mesh.face(0).iter().rev().copied().collect::<Vec<_>>());
    mesh.faces().skip(1).for_each(|face| other.push_face(face));
    other
}

/// The mesh without one vertex in so many, and without their faces.
fn without_every(nth: u32, mesh: &Mesh) -> Mesh {
    let kept: Vec<u32> = (0..mesh.points.len() as u32).filter(|v| v % nth != 0).collect();
    let number: HashMap<u32, u32> = kept.iter().copied().zip(0..).collect();
    let mut other = Mesh::new(kept.iter().map(|&v| mesh.points[v as usize]).collect());
    let faces =
        mesh.faces().filter_map(|face| face.iter().map(|v| number.get(v).copied()).collect::<Option<Vec<u32>>>());
    faces.for_each(|face| other.push_face(&face));
    other
}

/// The mesh with one quad in so many cut into two triangles.
fn with_every_quad_cut(nth: usize, mesh: &Mesh) -> Mesh {
    let mut other = Mesh::new(mesh.points.clone());
    for (index, face) in mesh.faces().enumerate() {
        match *face {
            [a, b, c, d] if index % nth == 0 => [[a, b, c], [a, c, d]].iter().for_each(|half| other.push_face(half)),
            _ => other.push_face(face),
        }
    }
    other
}

/// The mesh stretched along x.
fn stretched(by: f64, mesh: &Mesh) -> Mesh {
    let mut other = Mesh::new(mesh.points.iter().map(|&[x, y, z]| [by * x, y, z]).collect());
    mesh.faces().for_each(|face| other.push_face(face));
    other
}

/// Why a mesh has not the topology of its surface with one orientation; `None` where it has.
fn wrong(mesh: &Mesh, given: &Given) -> Option<String> {
    let (euler, loops, repeated) = counted(mesh);
    if repeated > 0 {
        return Some(format!("{repeated} directed edges have two faces"));
    }
    let is_same = (euler, loops) == (given.euler, given.loops);
    (!is_same)
        .then(|| format!("Euler characteristic {euler} and {loops} loops, not {} and {}", given.euler, given.loops))
}

/// The largest distance of the vertices from those of another mesh, over the extent; `None` where the faces are others.
fn apart(one: &Mesh, other: &Mesh, back: impl Fn(DVec3) -> DVec3) -> Option<f64> {
    let is_same = one.points.len() == other.points.len() && one.faces().eq(other.faces());
    let extent = one.points.as_flattened().iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    let pairs = one.points.iter().zip(&other.points);
    let far = pairs.map(|(&p, &q)| DVec3::from(p).distance(back(q.into()))).fold(0.0, f64::max);
    is_same.then_some(far / extent)
}

/// Rounding of f64 coordinates after a scale, a shift and the way back.
const ROUNDING: f64 = 1e-14;

/// Whether two meshes have nearly the same count, share of quads and mean shape of quads. Of 80 surfaces, turned and permuted, meshes of
/// 600 to 1,600 points differed by up to half of these bounds; meshes of fewer points differ more, by chance.
fn is_alike(one: &Mesh, other: &Mesh) -> bool {
    let [a, b] = [one, other].map(Quality::of);
    let shape = |quality: &Quality| quality.qg.map_or(0.0, |shape| shape.mean);
    let count = a.vertices as f64 / b.vertices as f64 - 1.0;
    count.abs() < 0.04 && (a.qr - b.qr).abs() < 0.05 && (shape(&a) - shape(&b)).abs() < 0.02
}

proptest! {
    #![proptest_config(config(6))]

    #[test]
    fn a_mesh_has_the_topology_and_the_orientation_of_its_surface(given in surfaces()) {
        let meshed = meshed(&given.soup, given.points);
        for mesh in [&meshed.before, &meshed.mesh] {
            prop_assert_eq!(wrong(mesh, &given), None);
            prop_assert!(wrong(&without_an_inner_face(mesh), &given).is_some(), "a missing face is seen");
            prop_assert!(wrong(&with_first_face_turned(mesh), &given).is_some(), "a turned face is seen");
        }
        if given.loops == 0 {
            let of_soup = volume(&given.soup.points, given.soup.triangles.iter().map(|triangle| &triangle[..]));
            let of_mesh = volume(&meshed.mesh.points, meshed.mesh.faces());
            prop_assert!((of_mesh / of_soup - 1.0).abs() < 0.25, "{} encloses {of_mesh}, not {of_soup}", given.name);
            let turned: Vec<Vec<u32>> = meshed.mesh.faces().map(|face| face.iter().rev().copied().collect()).collect();
            let turned = volume(&meshed.mesh.points, turned.iter().map(|face| &face[..]));
            prop_assert!(turned / of_soup < 0.0, "inside out");
        }
    }

    #[test]
    fn powers_of_two_change_no_bit(given in surfaces(), power in -3..4_i32) {
        let (factor, base) = (2.0_f64.powi(power), meshed(&given.soup, given.points).mesh);
        let scaled = |factor: f64| meshed(&mapped(&given.soup, |p| p * factor), given.points).mesh;
        prop_assert_eq!(apart(&base, &scaled(factor), |p| p / factor), Some(0.0));
        prop_assert_ne!(apart(&base, &scaled(1.1 * factor), |p| p / (1.1 * factor)), Some(0.0), "rounding is seen");
    }

    #[test]
    fn scales_and_shifts_change_the_mesh_by_rounding(
        given in surfaces(), scale in 0.2..5.0, shift in prop::array::uniform3(-3.0..3.0)
    ) {
        let (base, shift) = (meshed(&given.soup, given.points).mesh, DVec3::from(shift));
        let moved = |shear: f64| {
            let soup = mapped(&given.soup, |p| scale * (p + shear * DVec3::new(p.y, 0.0, 0.0)) + shift);
            let mesh = meshed(&soup, given.points).mesh;
            apart(&base, &mesh, |p| (p - shift) / scale)
        };
        prop_assert!(moved(0.0).is_some_and(|far| far < ROUNDING), "{:?}", moved(0.0));
        prop_assert!(moved(1e-3).is_none_or(|far| far > ROUNDING), "another surface");
    }

    #[test]
    fn turned_and_permuted_surfaces_give_meshes_alike(given in surfaces(), turn in rotations(), by in 0..1_000_usize) {
        let points = 4 * given.points;
        let base = meshed(&given.soup, points).mesh;
        let turned = meshed(&mapped(&given.soup, |p| turn * p), points).mesh;
        prop_assert!(is_alike(&base, &turned), "turned: {:?} {:?}", Quality::of(&base), Quality::of(&turned));
        let mut other = given.soup.clone();
        let by = by % other.triangles.len();
        other.triangles.rotate_left(by);
        other.triangles.iter_mut().for_each(|triangle| triangle.rotate_left(by % 3));
        let permuted = meshed(&other, points).mesh;
        prop_assert!(is_alike(&base, &permuted), "permuted: {:?} {:?}", Quality::of(&base), Quality::of(&permuted));
        // Each of the three measures tells meshes apart.
        prop_assert!(!is_alike(&base, &without_every(20, &base)), "fewer vertices");
        prop_assert!(!is_alike(&base, &with_every_quad_cut(30, &base)), "more triangles");
        prop_assert!(!is_alike(&base, &stretched(1.5, &base)), "worse shapes");
    }

    #[test]
    fn threads_change_no_bit(given in surfaces()) {
        let on = |threads: usize, soup: &Soup| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads start");
            pool.install(|| meshed(soup, given.points).mesh)
        };
        let one = on(1, &given.soup);
        prop_assert!([2, 7].into_iter().all(|threads| on(threads, &given.soup) == one));
        let mut other = given.soup.clone();
        other.points[7][2] += 1e-3;
        prop_assert_ne!(on(1, &other), one, "another surface");
    }

    #[test]
    fn indices_of_the_field_add_up_to_the_euler_characteristic(given in surfaces()) {
        prop_assume!(given.loops == 0);
        let surface = Surface::new(&given.soup, &FeatureOptions::default()).expect("it is a surface");
        let field = Field::new(&surface, &FieldOptions::default(), &Cpu).expect("the CPU does not fail");
        let quarters: Vec<i32> = field.singularities(&surface).iter().map(|place| place.quarters).collect();
        let sum = |quarters: &[i32]| i64::from(quarters.iter().sum::<i32>());
        prop_assert_eq!(sum(&quarters), 4 * given.euler, "{}", given.name);
        prop_assert!(quarters.is_empty() || sum(&quarters[1..]) != 4 * given.euler, "each counts");
    }

    #[test]
    fn steps_close_round_triangles_but_where_rows_end(given in surfaces()) {
        let surface = Surface::new(&given.soup, &FeatureOptions::default()).expect("it is a surface");
        let field = Field::new(&surface, &FieldOptions::default(), &Cpu).expect("the CPU does not fail");
        // A length of the surface's own triangles, so that rows are seen from vertex to vertex.
        let side = 0.12;
        let phases = Parametrization::solve(&surface, &field, |_| side, &[], Rows::Paper, &Cpu).expect("the CPU does not fail");
        // The sum of the steps round a triangle, whichever way the second corner's frame is turned; `third` is the half-edge in the
        // place of the third.
        let round = |t: u32, third: u32| {
            let [[a, b], [c, d]] = [phases.step(3 * t), phases.step_at_end(third)];
            let [u, v] = phases.step(3 * t + 1);
            let ways = [[u, v], [-v, u], [-u, -v], [v, -u]];
            ways.map(|[u, v]| (a + c + u).abs() + (b + d + v).abs()).into_iter().fold(f64::MAX, f64::min)
        };
        let triangles = surface.triangle_count() as u32;
        let open = |third: fn(u32) -> u32| (0..triangles).filter(|&t| round(t, third(t)) > 1e-6).count();
        prop_assert!(open(|t| 3 * t + 2) < triangles as usize / 5, "{} of {triangles}", open(|t| 3 * t + 2));
        prop_assert!(open(|t| 3 * t + 1) > triangles as usize / 2, "a wrong side does not close");
    }
}
