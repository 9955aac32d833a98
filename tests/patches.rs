//! Patches of a surface that are meshed apart fit together where their boundaries are kept.

mod common;
#[path = "../examples/patches.rs"]
#[allow(dead_code, reason = "the example's main is not called")]
mod example;

use common::surfaces::{example, flat, surface};
use example::{Plane, joined, meshed, patches, wing};
use quadmosaic::compute::Cpu;
use quadmosaic::mesh::Mesh;
use quadmosaic::mesh::compare::check_against;
use quadmosaic::mesh::connectivity::{ConnectivityOptions, Quads};
use quadmosaic::pipeline::{Fineness, Options, PipelineError, run, unwatched};
use quadmosaic::surface::{BoundaryError, KeptBoundary};
use quadmosaic::symmetry::{Axis, Plane as SymmetryPlane, Symmetry};
use quadmosaic::{Mesher, Soup};
use std::collections::{BTreeMap, BTreeSet};

type Bits = [u64; 3];

fn bits(point: [f64; 3]) -> Bits {
    point.map(|x| (x + 0.0).to_bits())
}

/// The boundary edges, from point to point, in the direction of their faces.
fn boundary(mesh: &Mesh) -> BTreeSet<[Bits; 2]> {
    let mut sides: BTreeMap<[u32; 2], usize> = BTreeMap::new();
    for face in mesh.faces() {
        for (&a, &b) in face.iter().zip(face.iter().cycle().skip(1)) {
            *sides.entry([a, b]).or_default() += 1;
        }
    }
    let is_open = |&&[a, b]: &&[u32; 2]| !sides.contains_key(&[b, a]);
    sides.keys().filter(is_open).map(|ends| ends.map(|v| bits(mesh.points[v as usize]))).collect()
}

fn options(keep_boundary: Option<KeptBoundary>, fineness: Fineness) -> Options {
    Options { keep_boundary, ..Options::new(fineness) }
}

fn mesh(soup: &Soup, options: &Options) -> Mesh {
    run(soup, options, &Cpu, &unwatched).unwrap_or_else(|error| panic!("{error}")).meshed.mesh
}

/// The planes of the octants.
fn octants() -> [Plane; 3] {
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|normal| Plane { normal, offset: 0.0 })
}

/// The joined meshes of patches, the number of their faults and differences from the whole surface, and the Euler characteristics
/// of both.
fn fitted(soup: &Soup, patches: &[Soup], options: &Options) -> (Mesh, usize, [i64; 2]) {
    let meshes = meshed(&Mesher::cpu(), patches, options).unwrap_or_else(|error| panic!("{error}"));
    let mesh = joined(&meshes);
    let (faults, comparison) = check_against(&mesh, &surface(soup));
    let comparison = comparison.expect("a comparison");
    let euler = [faults.topology().euler, comparison.topology.euler];
    println!("{} vertices, {faults}, {:?}", mesh.points.len(), comparison.differences);
    (mesh, faults.list.len() + comparison.differences.len(), euler)
}

/// The triangles of a surface in so many parts: by their middles, halved along the longest axis, again and again.
fn bisected(soup: &Soup, parts: usize) -> Vec<Soup> {
    if parts == 1 {
        return vec![soup.clone()];
    }
    let middle = |t: &[u32; 3], axis: usize| t.iter().map(|&v| soup.points[v as usize][axis]).sum::<f64>();
    let extent = |axis: usize| {
        let all = soup.triangles.iter().map(|t| middle(t, axis));
        all.clone().fold(f64::NEG_INFINITY, f64::max) - all.fold(f64::INFINITY, f64::min)
    };
    let axis = (0..3).max_by(|&i, &j| extent(i).total_cmp(&extent(j))).unwrap_or(0);
    let mut triangles = soup.triangles.clone();
    triangles.sort_by(|a, b| middle(a, axis).total_cmp(&middle(b, axis)));
    let half = triangles.split_off(triangles.len() / 2);
    [triangles, half].into_iter().flat_map(|t| bisected(&Soup::new(soup.points.clone(), t), parts / 2)).collect()
}

#[test]
fn the_boundary_of_the_mesh_is_that_of_the_input_bit_for_bit() {
    // Coordinates that f32 does not hold.
    let shapes: [fn([f64; 3]) -> [f64; 3]; 4] = [
        |[x, y, _]| [x, y, 0.1],
        |[x, y, _]| [1e3 + x / 3.0, y / 3.0 - 70.0, 0.1 + x * y],
        |[x, y, _]| [x, 0.6 * y, 0.2 * (5.0 * x).sin()],
        |[x, y, _]| [1e-3 * (0.5 + x) * (2.0 * y).cos(), 1e-3 * (0.5 + x) * (2.0 * y).sin(), 1e-4 * x],
    ];
    for (number, shape) in shapes.into_iter().enumerate() {
        let mut plate = example("plate", 1_500);
        plate.points.iter_mut().for_each(|p| *p = shape(*p));
        let given = boundary(&Mesh::from(plate.clone()));
        let plain = options(None, Fineness::Points(300));
        assert_ne!(boundary(&mesh(&plate, &plain)), given, "without the option it is another");
        for (points, quads) in [(300, Quads::All), (800, Quads::Most), (1_500, Quads::All)] {
            let connectivity = Some(ConnectivityOptions { quads, ..ConnectivityOptions::default() });
            let options = options(Some(KeptBoundary::Exact), Fineness::Points(points));
            let kept = mesh(&plate, &Options { connectivity, ..options });
            assert_eq!(boundary(&kept), given, "{number} {points} {quads:?}");
            let (faults, comparison) = check_against(&kept, &surface(&plate));
            let differences = comparison.expect("a comparison").differences;
            assert!(faults.is_clean() && differences.is_empty(), "{number} {points} {quads:?}: {faults}");
        }
    }
}

#[test]
fn ragged_patches_of_a_sphere_fit_together() {
    let sphere = example("sphere", 6_000);
    let patches = bisected(&sphere, 8);
    let kept = options(Some(KeptBoundary::Exact), Fineness::Points(400));
    let (_, wrong, euler) = fitted(&sphere, &patches, &kept);
    assert_eq!((wrong, euler), (0, [2, 2]));
    let (_, wrong, euler) = fitted(&sphere, &patches, &options(None, kept.fineness));
    assert!(wrong > 0 && euler[0] != 2, "without the option they do not fit: {wrong} {euler:?}");
}

#[test]
fn resampled_octants_of_a_sphere_fit_together() {
    let sphere = example("sphere", 20_000);
    let patches = patches(&sphere, &octants());
    assert_eq!(patches.len(), 8);
    let side = 0.06;
    let kept = options(Some(KeptBoundary::Resampled(side)), Fineness::Size(side));
    let (mesh, wrong, euler) = fitted(&sphere, &patches, &kept);
    assert_eq!((wrong, euler), (0, [2, 2]));
    let count = 4.0 * std::f64::consts::PI / (side * side);
    assert!((mesh.points.len() as f64 / count - 1.0).abs() < 0.05, "{} of {count}", mesh.points.len());
    let (_, wrong, euler) = fitted(&sphere, &patches, &options(None, kept.fineness));
    assert!(wrong > 0 && euler[0] != 2, "without the option they do not fit: {wrong} {euler:?}");
}

#[test]
fn patches_of_the_wing_fit_together() {
    let (soup, planes) = wing();
    let patches = patches(&soup, &planes);
    assert_eq!(patches.len(), 8);
    let side = 0.03;
    let kept = options(Some(KeptBoundary::Resampled(side)), Fineness::Size(side));
    let (_, wrong, euler) = fitted(&soup, &patches, &kept);
    assert_eq!((wrong, euler), (0, [1, 1]));
    let (_, wrong, euler) = fitted(&soup, &patches, &options(None, kept.fineness));
    assert!(wrong > 0 && euler[0] != 1, "without the option they do not fit: {wrong} {euler:?}");
}

#[test]
fn a_crease_may_end_between_the_samples_of_a_seam() {
    // A sheet folded by 45 degrees: a crease, and a turn of the seam that is no corner.
    let mut sheet = flat(44, 21, 0.05);
    sheet.points.iter_mut().for_each(|p| *p = [p[0] - 1.1, p[1], (p[0] - 1.1).abs() * 22.5_f64.to_radians().tan()]);
    let patches = patches(&sheet, &[Plane { normal: [0.15, 1.0, 0.0], offset: 0.51 }]);
    let side = 0.12;
    let kept = options(Some(KeptBoundary::Resampled(side)), Fineness::Size(side));
    let on_crease = |mesh: &Mesh| mesh.points.iter().filter(|p| p[2].abs() < 1e-12).count();
    let (mesh, wrong, euler) = fitted(&sheet, &patches, &kept);
    assert_eq!((wrong, euler), (0, [1, 1]));
    assert!(on_crease(&mesh) >= 6, "{}: the crease is kept", on_crease(&mesh));
    let (_, wrong, _) = fitted(&sheet, &patches, &options(None, kept.fineness));
    assert!(wrong > 0, "without the option they do not fit");
}

#[test]
fn a_loop_of_an_odd_number_of_edges_leaves_one_triangle() {
    let meshed = |removed: usize| {
        let mut plate = flat(12, 12, 1.0);
        // A triangle at the last corner has one side on the boundary, and leaves two.
        plate.triangles.truncate(plate.triangles.len() - removed);
        let connectivity = Some(ConnectivityOptions { quads: Quads::All, ..ConnectivityOptions::default() });
        let options = Options { connectivity, ..options(Some(KeptBoundary::Exact), Fineness::Points(169)) };
        let mesher = Mesher::cpu();
        let outcome = mesher.mesh(&plate, &options).unwrap_or_else(|error| panic!("{error}"));
        let mesh = &outcome.meshed.mesh;
        assert_eq!(boundary(mesh), boundary(&Mesh::from(plate)));
        assert!(outcome.meshed.faults.is_clean(), "{}", outcome.meshed.faults);
        let warnings = mesher.report("plate", &options, &outcome).warnings();
        let is_told = warnings.iter().any(|warning| warning.starts_with("1 triangle left"));
        (boundary(mesh).len(), mesh.triangles().count(), is_told)
    };
    assert_eq!(meshed(0), (48, 0, false));
    assert_eq!(meshed(1), (49, 1, true));
}

#[test]
fn what_cannot_be_kept_is_refused() {
    let plate = example("plate", 500);
    let refused = |options: &Options| match run(&plate, options, &Cpu, &unwatched) {
        Err(PipelineError::Boundary(error)) => error,
        Err(error) => panic!("{error}"),
        Ok(_) => panic!("a mesh was made"),
    };
    for side in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let asked = options(Some(KeptBoundary::Resampled(side)), Fineness::Points(200));
        assert!(matches!(refused(&asked), BoundaryError::Side { .. }), "{side}");
    }
    let kept = options(Some(KeptBoundary::Exact), Fineness::Points(200));
    let symmetry = Some(Symmetry::About(SymmetryPlane { axis: Axis::X, offset: 0.5 }));
    assert_eq!(refused(&Options { symmetry, ..kept }), BoundaryError::Symmetry);
}
