//! Sizes of tiles: counts and lengths against closed forms, growth, files, and whole meshes.

mod common;

use common::surfaces::{example, flat, surface};
use glam::{DVec2, DVec3};
use quadmosaic::compute::{Backend, Cpu};
use quadmosaic::gpu::GpuBackend;
use quadmosaic::mesh::Mesh;
use quadmosaic::pipeline::{Fineness, Layout, Options, PipelineError, run, unwatched};
use quadmosaic::sizes::{LocalSize, SizeFileError, SizeOptions, SizeSample, Sizes, SizesError, read_sizes};
use quadmosaic::surface::{Soup, Surface};
use std::f64::consts::PI;
use std::fs;

/// Sizes of a surface that are a function of the place, in unit-sized coordinates.
fn sizes(surface: &Surface, size: impl Fn([f64; 3]) -> f64) -> Sizes {
    let all = (0..surface.vertex_count() as u32).map(|v| size(surface.point(v)) as f32).collect();
    Sizes::from_vertices(surface, all).expect("they are sizes")
}

/// A flat square of side 1 and its side in unit-sized coordinates.
fn square() -> (Surface, f64) {
    (surface(&flat(40, 40, 1.0 / 40.0)), 1.0 / 2f64.sqrt())
}

#[test]
fn the_count_is_the_closed_form() {
    let (square, side) = square();
    // From a to b along x: the integral of 1 / (a + (b - a) x)^2 over the unit square is 1 / (a b), that of the inverse
    // along the two sides across x is 1 / a + 1 / b, along the other two 2 ln(b / a) / (b - a).
    let (a, b) = (1.0, 3.0);
    let linear = sizes(&square, |[x, _, _]| a + (b - a) * (x / side + 0.5));
    let closed = |h: f64| {
        let h = h / side;
        let round = 1.0 / a + 1.0 / b + 2.0 * (b / a).ln() / (b - a);
        1.0 / (a * b) / (h * h) + round / (2.0 * h)
    };
    for h in [0.001, 0.01, 0.05] {
        let count = linear.count_for_side(&square, h);
        // The middles of edges miss the integral by the square of a triangle's share of the range, 1/40 of 2 and less.
        assert!((count / closed(h) - 1.0).abs() < 1e-3, "{count}, not {}", closed(h));
        assert!((Sizes::equal().count_for_side(&square, h) / closed(h) - 1.0).abs() > 0.1, "equal tiles are more");
    }
    for count in [100, 5_000] {
        let h = f64::from(linear.side_for_count(&square, count));
        // The side is rounded to an f32.
        assert!((linear.count_for_side(&square, h) / count as f64 - 1.0).abs() < 1e-6);
    }
}

#[test]
fn products_and_what_is_no_size() {
    let (square, _) = square();
    let ones = sizes(&square, |_| 1.0);
    let linear = sizes(&square, |[x, _, _]| 1.0 + x);
    assert_eq!(linear.times(&Sizes::equal()), linear);
    assert_eq!(Sizes::equal().times(&linear), linear);
    assert_eq!(linear.times(&ones), linear);
    assert_eq!(linear.times(&linear).at_vertex(7), linear.at_vertex(7) * linear.at_vertex(7));
    let given = |all: Vec<f32>| Sizes::from_vertices(&square, all);
    let vertices = square.vertex_count();
    assert_eq!(given(vec![1.0; 3]), Err(SizesError::Count { given: 3, vertices }));
    for wrong in [0.0, -1.0, f32::INFINITY] {
        let mut all = vec![1.0; vertices];
        all[5] = wrong;
        assert_eq!(given(all), Err(SizesError::NotPositive { vertex: 5, size: wrong }));
    }
}

/// The steepest growth along an edge, in sides a side.
fn steepest(surface: &Surface, soup: &Soup, side: f64, sizes: &Sizes) -> f64 {
    let place = |v: u32| DVec3::from(surface.point(v));
    let vertex = |point: &[f64; 3]| {
        let at = DVec3::from(surface.frame().to_unit(*point));
        (0..surface.vertex_count() as u32).min_by(|&v, &w| place(v).distance(at).total_cmp(&place(w).distance(at)))
    };
    let vertices: Vec<u32> = soup.points.iter().flat_map(vertex).collect();
    let mut most = 0.0f64;
    for corners in &soup.triangles {
        let [a, b, c] = corners.map(|i| vertices[i as usize]);
        for [v, w] in [[a, b], [b, c], [c, a]] {
            let length = place(v).distance(place(w));
            let rise = f64::from(sizes.at_vertex(v) - sizes.at_vertex(w)).abs() * side;
            most = most.max(rise / length);
        }
    }
    most
}

#[test]
fn growth_is_bounded_and_nothing_is_smaller_than_it_must_be() {
    let soup = flat(40, 40, 1.0 / 40.0);
    let square = surface(&soup);
    let peaked = sizes(&square, |[x, y, _]| if x.hypot(y) < 0.01 { 0.1 } else { 1.0 });
    let (side, growth) = (0.2, 1.3);
    let limited = peaked.limited(&square, side, growth);
    // Sides are rounded to f32, 1e-7 of them over edges of a hundredth.
    assert!(steepest(&square, &soup, side, &limited) < growth - 1.0 + 1e-4);
    assert!(steepest(&square, &soup, side, &peaked) > 2.0 * (growth - 1.0), "without a bound it is steeper");
    let middle = (0..square.vertex_count() as u32).find(|&v| DVec3::from(square.point(v)).length() < 1e-3).unwrap();
    assert_eq!(limited.at_vertex(middle), 0.1, "the smallest stays");
    for v in 0..square.vertex_count() as u32 {
        let way = DVec3::from(square.point(v)).length();
        // Ways along edges are longer than straight ones, by the square root of 2 at most.
        let [least, most] = [1.0, 2f64.sqrt()].map(|longer| (0.1 + (growth - 1.0) / side * way * longer).min(1.0));
        let size = f64::from(limited.at_vertex(v));
        assert!((least - 1e-5..most + 1e-5).contains(&size), "{size} at {way}");
    }
    assert_eq!(Sizes::equal().limited(&square, side, growth), Sizes::equal());
}

fn samples(places: &[([f64; 3], f64)]) -> Vec<SizeSample> {
    places.iter().map(|&(point, size)| SizeSample { point, size }).collect()
}

fn meshed(soup: &Soup, options: &Options, backend: &dyn Backend) -> Mesh {
    run(soup, options, backend, &unwatched).unwrap_or_else(|error| panic!("{error}")).meshed.mesh
}

/// The middle and length of each edge of a mesh, those between two quads twice.
fn edges(mesh: &Mesh) -> Vec<(DVec3, f64)> {
    let mut edges = Vec::new();
    for face in mesh.faces() {
        for k in 0..face.len() {
            let [a, b] = [face[k], face[(k + 1) % face.len()]].map(|v| DVec3::from(mesh.points[v as usize]));
            edges.push(((a + b) / 2.0, a.distance(b)));
        }
    }
    edges
}

/// A square of side 1 with sizes from `a` at x = 0 to `b` at x = 1, by samples at its vertices.
fn graded(a: f64, b: f64) -> (Soup, Vec<SizeSample>) {
    let soup = flat(40, 40, 1.0 / 40.0);
    let sample = |&point: &[f64; 3]| SizeSample { point, size: a + (b - a) * point[0] };
    let all = soup.points.iter().map(sample).collect();
    (soup, all)
}

/// The mean length of edges whose middle has an x within 0.1 of this.
fn mean_length(mesh: &Mesh, x: f64) -> f64 {
    let near: Vec<f64> = edges(mesh).iter().filter(|(at, _)| (at.x - x).abs() < 0.1).map(|edge| edge.1).collect();
    near.iter().sum::<f64>() / near.len() as f64
}

#[test]
fn edges_have_the_lengths_of_a_linear_field() {
    let (a, b) = (0.012, 0.036);
    let (soup, all) = graded(a, b);
    let sizes = SizeOptions { samples: all, ..SizeOptions::default() };
    let mesh = meshed(&soup, &Options { sizes: sizes.clone(), ..Options::new(Fineness::Sampled) }, &Cpu);
    let count = 1.0 / (a * b) + (1.0 / a + 1.0 / b + 2.0 * (b / a).ln() / (b - a)) / 2.0;
    assert!((mesh.points.len() as f64 / count - 1.0).abs() < 0.03, "{} vertices, not {count}", mesh.points.len());
    let equal = meshed(&soup, &Options::new(Fineness::Points(mesh.points.len())), &Cpu);
    for x in [0.15, 0.5, 0.85] {
        let wanted = a + (b - a) * x;
        let found = mean_length(&mesh, x);
        // Diagonals of triangles are longer, and where rows end sides are.
        assert!((found / wanted - 1.0).abs() < 0.1, "{found} for {wanted} at {x}");
        assert!(x == 0.5 || (mean_length(&equal, x) / wanted - 1.0).abs() > 0.1, "equal tiles at {x}");
    }
    // With a count the same sizes are relative.
    let fewer = meshed(&soup, &Options { sizes, ..Options::new(Fineness::Points(1_000)) }, &Cpu);
    assert!((fewer.points.len() as f64 / 1_000.0 - 1.0).abs() < 0.03, "{}", fewer.points.len());
    let ratio = mean_length(&fewer, 0.85) / mean_length(&fewer, 0.15);
    let wanted = (a + (b - a) * 0.85) / (a + (b - a) * 0.15);
    assert!((ratio / wanted - 1.0).abs() < 0.1, "{ratio} for {wanted}");
}

#[test]
fn curvature_makes_edges_short_where_it_is_strong() {
    let soup = example("m6", 5_000);
    let sizes = SizeOptions { curvature: Some(15.0), ..SizeOptions::default() };
    let options = Options { sizes, ..Options::new(Fineness::Points(3_000)) };
    let fine = meshed(&soup, &options, &Cpu);
    let plain = meshed(&soup, &Options::new(Fineness::Points(3_000)), &Cpu);
    for mesh in [&fine, &plain] {
        assert!((mesh.points.len() as f64 / 3_000.0 - 1.0).abs() < 0.03, "{}", mesh.points.len());
    }
    let range = |mesh: &Mesh| {
        let mut lengths: Vec<f64> = edges(mesh).iter().map(|edge| edge.1).collect();
        lengths.sort_by(f64::total_cmp);
        lengths[lengths.len() * 19 / 20] / lengths[lengths.len() / 20]
    };
    // The nose of a wing turns by half a circle within a hundredth of its chord, and bounds the range of 4 from below.
    assert!(range(&fine) > 2.0, "{}", range(&fine));
    assert!(range(&plain) < 1.6, "{}", range(&plain));
}

/// The lengths of the edges whose middles are chosen, sorted.
fn lengths(mesh: &Mesh, is_chosen: impl Fn(DVec3) -> bool) -> Vec<f64> {
    let mut lengths: Vec<f64> = edges(mesh).iter().filter(|edge| is_chosen(edge.0)).map(|edge| edge.1).collect();
    lengths.sort_by(f64::total_cmp);
    lengths
}

fn median(lengths: &[f64]) -> f64 {
    lengths[lengths.len() / 2]
}

#[test]
fn edges_are_small_at_a_place_and_keep_their_size_elsewhere() {
    let soup = example("plate", 4_000);
    let local = |text: &str| vec![text.parse::<LocalSize>().expect("a size")];
    let of = |sizes: SizeOptions| meshed(&soup, &Options { sizes, ..Options::new(Fineness::Size(0.04)) }, &Cpu);
    let plain = of(SizeOptions::default());
    let boxed = of(SizeOptions { local: local("0.8,0.8,-1,1,1,1:0.01"), ..SizeOptions::default() });
    let in_box = |p: DVec3| p.x > 0.85 && p.y > 0.85;
    let far = |p: DVec3| p.x < 0.3 && p.y < 0.3;
    let [inside, outside] = [median(&lengths(&boxed, in_box)), median(&lengths(&boxed, far))];
    assert!((inside / 0.01 - 1.0).abs() < 0.15 && (outside / 0.04 - 1.0).abs() < 0.15, "{inside}, {outside}");
    assert!((median(&lengths(&plain, in_box)) / 0.04 - 1.0).abs() < 0.15);
    // Between two bounds they are all alike.
    let (least, largest) = (Some(0.02), Some(0.03));
    let bounded = of(SizeOptions { local: local("boundaries:0.001"), least, largest, ..SizeOptions::default() });
    let all = lengths(&bounded, |_| true);
    assert!(
        all[all.len() / 50] > 0.8 * 0.02 && all[all.len() * 49 / 50] < 1.5 * 0.03,
        "{:?}",
        [all[0], all[all.len() - 1]]
    );
}

#[test]
fn a_round_hole_has_so_many_edges() {
    let soup = example("plate", 4_000);
    let on_rim = |p: DVec3| (p.distance(DVec3::new(0.5, 0.5, 0.0)) - 0.2).abs() < 0.004;
    for (around, size) in [(24, 0.1), (40, 0.05)] {
        let sizes = SizeOptions { around_holes: around, ..SizeOptions::default() };
        let mesh = meshed(&soup, &Options { sizes, ..Options::new(Fineness::Size(size)) }, &Cpu);
        assert_eq!(lengths(&mesh, on_rim).len(), around);
    }
    let plain = meshed(&soup, &Options::new(Fineness::Size(0.1)), &Cpu);
    assert!(lengths(&plain, on_rim).len() < 20);
}

#[test]
fn equal_holes_have_equally_many_edges() {
    let soup = example("flange", 20_000);
    let sizes = SizeOptions { around_holes: 12, ..SizeOptions::default() };
    for layout in [Layout::Mosaic, Layout::Quads] {
        let rims = |sizes: SizeOptions| {
            let options = Options { sizes, ..Options::new(Fineness::Points(3_000)) }.with_layout(layout);
            let mesh = meshed(&soup, &options, &Cpu);
            // Twelve bolt holes of radius 0.07, 0.75 from the axis, in two faces.
            let rim = |bolt: u32, z: f64| {
                let centre = 0.75 * DVec2::from_angle(f64::from(bolt) * PI / 6.0);
                let on_rim = |p: DVec3| (p.truncate().distance(centre) - 0.07).abs() < 0.004 && (p.z - z).abs() < 1e-6;
                // Each edge is there once for each of its faces.
                lengths(&mesh, on_rim).len() / 2
            };
            let both = (0..12).flat_map(|bolt| [-0.1, 0.1].map(|z| rim(bolt, z)));
            both.collect::<Vec<usize>>()
        };
        // Edits that make all faces quads may change one edge.
        let off = if layout == Layout::Quads { 1 } else { 0 };
        let asked = rims(sizes.clone());
        assert!(asked.iter().all(|&count| count.abs_diff(12) <= off), "{layout:?}: {asked:?}");
        assert!(rims(SizeOptions::default()).iter().all(|&count| count < 12));
    }
}

#[test]
fn sizes_that_cannot_be_are_refused() {
    let soup = example("plate", 500);
    let said = |sizes: SizeOptions| {
        let options = Options { sizes, ..Options::new(Fineness::Points(200)) };
        run(&soup, &options, &Cpu, &unwatched).err().map(|error| error.to_string())
    };
    let local = |text: &str| vec![text.parse::<LocalSize>().expect("a size")];
    let nowhere = said(SizeOptions { local: local("ridges:0.1"), ..SizeOptions::default() });
    assert_eq!(nowhere.as_deref(), Some("the surface has no ridges, for which a size is given"));
    let range = said(SizeOptions { least: Some(0.2), largest: Some(0.1), ..SizeOptions::default() });
    assert_eq!(range.as_deref(), Some("the least size 0.2 is larger than the largest, 0.1"));
    assert_eq!(said(SizeOptions { local: local("boundaries:0.1"), ..SizeOptions::default() }), None);
}

#[test]
fn both_backends_lay_the_same_graded_mesh() {
    let Some(gpu) = common::gpu() else { return };
    if gpu.adapter().hardware {
        common::skip("on hardware bytes differ; tests/relax.rs compares steps");
        return;
    }
    let (soup, all) = graded(1.0, 2.5);
    let sizes = SizeOptions { samples: all, ..SizeOptions::default() };
    let options = Options { sizes, ..Options::new(Fineness::Points(1_500)) };
    let backend = GpuBackend::new(gpu).expect("its kernels compile");
    let on_cpu = meshed(&soup, &options, &Cpu);
    assert_eq!(on_cpu, meshed(&soup, &options, &backend));
    assert_ne!(on_cpu, meshed(&soup, &Options::new(Fineness::Points(1_500)), &backend), "equal tiles are others");
}

#[test]
fn sizes_that_are_one_change_nothing() {
    let soup = example("m6", 3_000);
    let plain = Options::new(Fineness::Points(2_000));
    let ones = SizeOptions { samples: samples(&[([0.0; 3], 0.3)]), ..SizeOptions::default() };
    let equal = meshed(&soup, &plain, &Cpu);
    let same = meshed(&soup, &Options { sizes: ones, ..plain.clone() }, &Cpu);
    // The scale is found by other roundings; the mosaic is the same but for those.
    assert!((same.points.len() as f64 / equal.points.len() as f64 - 1.0).abs() < 0.01);
    let two = SizeOptions { samples: samples(&[([0.0; 3], 0.3), ([1.0, 1.2, 0.0], 0.9)]), ..SizeOptions::default() };
    assert_ne!(meshed(&soup, &Options { sizes: two, ..plain }, &Cpu), equal);
}

#[test]
fn sizes_in_model_units_that_make_no_sense_are_refused() {
    let soup = flat(4, 4, 0.25);
    let refused = |samples: Vec<SizeSample>| {
        let sizes = SizeOptions { samples, ..SizeOptions::default() };
        run(&soup, &Options { sizes, ..Options::new(Fineness::Sampled) }, &Cpu, &unwatched).err()
    };
    let said = |error: Option<PipelineError>| error.map_or(String::new(), |error| error.to_string());
    assert!(said(refused(vec![])).contains("no sizes are given"));
    assert!(said(refused(samples(&[([0.0; 3], 1e-9)]))).contains("ask for larger ones"));
    assert!(matches!(refused(samples(&[([0.0; 3], 1e300)])), Some(PipelineError::Sizes(_))));
    assert!(refused(samples(&[([0.0; 3], 0.1)])).is_none());
}

fn read(text: &[u8]) -> Result<Vec<SizeSample>, SizeFileError> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("sizes.txt");
    fs::write(&path, text).expect("it can be written");
    read_sizes(&path)
}

const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n\
                   property float size\nend_header\n";

#[test]
fn files_of_all_styles_read_alike() {
    let wanted = samples(&[([1.0, 2.0, 3.0], 0.25), ([-1e3, 0.0, 0.5], 2.0)]);
    let texts = [
        "1,2,3,0.25\n-1e3,0,0.5,2\n".to_owned(),
        "x,y,z,size\r\n# two points\r\n\r\n1, 2, 3, .25 # first\r\n-1000,0,0.5,2".to_owned(),
        "\u{feff}Size Z name X Y\n0.25 3 nose 1 2\n2 0.5 tip -1e3 0\n".to_owned(),
        "size;x;y;z\n0.25;1;2;3\n2;-1000;0;0.5\n".to_owned(),
        "\"x\",\"y\",\"z\",\"size\",\"note, free\"\n1,2,3,0.25,\"a, b\"\n-1000,0,0.5,2,\n".to_owned(),
        format!("{PLY}1 2 3 0.25\n-1000 0 0.5 2\n"),
    ];
    for text in texts {
        assert_eq!(read(text.as_bytes()).expect("they are sizes"), wanted, "{text}");
    }
    let mut binary = PLY.replace("ascii", "binary_little_endian").into_bytes();
    for value in [1.0f32, 2.0, 3.0, 0.25, -1e3, 0.0, 0.5, 2.0] {
        binary.extend(value.to_le_bytes());
    }
    assert_eq!(read(&binary).expect("they are sizes"), wanted);
}

#[test]
fn wrong_files_are_refused_with_their_place() {
    for (text, part) in [
        ("1,2,3,0.25\n1,2,3\n", "line 2: 3 values, not 4"),
        ("1,2,3,0.25\n\n1,2,3,four\n", "line 3: \"four\" is not a finite number"),
        ("1,2,3,0\n", "line 1: the size 0 is not above 0"),
        ("1,2,3,-2\n", "the size -2 is not above 0"),
        ("1,2,inf,2\n", "line 1: \"inf\" is not a finite number"),
        ("x,y,z,h\n1,2,3,4\n", "line 1: the header names the columns [\"x\", \"y\", \"z\", \"h\"]"),
        ("x,y,z,size,size\n", "each once"),
        ("x,y,z,size\n1,2,3,4,5\n", "line 2: 5 values, not 4"),
        ("x,y,z,size,note\n1,2,3,0.25,a, b\n", "line 2: 6 values, not 5"),
        ("", "holds no sizes"),
        ("# none\nx,y,z,size\n", "holds no sizes"),
        (&format!("{PLY}1 2 3 0.25\n-1000 0 0.5 0\n"), "vertex 1 (counted from 0): the size 0 is not above 0"),
        (&format!("{PLY}1 2 3 0.25\n-1000 0 0.5\n"), "line 10"),
        (&PLY.replace("property float size\n", ""), "the property size of the element vertex"),
    ] {
        let error = read(text.as_bytes()).expect_err(text).to_string();
        assert!(error.contains("sizes.txt") && error.contains(part), "{text}\n{error}");
    }
    assert!(matches!(read_sizes("none.csv".as_ref()), Err(SizeFileError::Unreadable { .. })));
}
