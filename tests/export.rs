//! The files of fields, read back as ParaView reads them; meshes whose points are those of the input.

mod common;

use common::surfaces::{example, surface};
use glam::DVec3;
use quadmosaic::compute::Cpu;
use quadmosaic::export::{Format, MeshFile, ordered, write_field_ply, write_field_vtk, write_mesh};
use quadmosaic::field::{Field, FieldOptions, SingularityLocation};
use quadmosaic::mesh::{Mesh, VertexKind, read_mesh};
use quadmosaic::pipeline::{Fineness, Meshed, Options, run, unwatched};
use quadmosaic::surface::{Soup, Surface};
use std::collections::HashMap;

fn field(surface: &Surface) -> Field {
    Field::new(surface, &FieldOptions::default(), &Cpu).expect("the CPU does not fail")
}

fn written(write: impl Fn(&std::path::Path)) -> Vec<u8> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("field");
    write(&path);
    std::fs::read(path).expect("it was written")
}

/// A file of text lines and binary numbers between them.
struct Reader<'a> {
    left: &'a [u8],
}

impl<'a> Reader<'a> {
    /// The next line that is not empty; `None` at the end.
    fn line(&mut self) -> Option<Vec<&'a str>> {
        while let Some(end) = self.left.iter().position(|&byte| byte == b'\n') {
            let (line, rest) = self.left.split_at(end);
            self.left = &rest[1..];
            if !line.is_empty() {
                return Some(std::str::from_utf8(line).expect("a line of text").split(' ').collect());
            }
        }
        None
    }

    fn bytes<const N: usize>(&mut self) -> [u8; N] {
        let (bytes, rest) = self.left.split_first_chunk().expect("the file goes on");
        self.left = rest;
        *bytes
    }

    fn floats(&mut self, count: usize) -> Vec<f32> {
        (0..count).map(|_| f32::from_be_bytes(self.bytes())).collect()
    }

    fn integers(&mut self, count: usize) -> Vec<i32> {
        (0..count).map(|_| i32::from_be_bytes(self.bytes())).collect()
    }
}

#[derive(Default)]
struct Vtk {
    points: Vec<DVec3>,
    /// The cells of each section, in the file's order.
    cells: Vec<(String, Vec<Vec<i32>>)>,
    arrays: HashMap<String, Vec<f32>>,
}

fn vtk(bytes: &[u8]) -> Vtk {
    let mut reader = Reader { left: bytes };
    let mut vtk = Vtk::default();
    assert_eq!(reader.line(), Some(vec!["#", "vtk", "DataFile", "Version", "3.0"]));
    assert!(reader.line().is_some_and(|title| title[0] == "quadmosaic"));
    assert_eq!(reader.line(), Some(vec!["BINARY"]));
    assert_eq!(reader.line(), Some(vec!["DATASET", "POLYDATA"]));
    let mut items = 0;
    while let Some(line) = reader.line() {
        let number = |word: &str| word.parse::<usize>().expect("a number");
        match *line {
            ["POINTS", count, "double"] => {
                let mut double = || f64::from_be_bytes(reader.bytes());
                vtk.points = (0..number(count)).map(|_| DVec3::new(double(), double(), double())).collect();
            }
            [name @ ("VERTICES" | "LINES" | "POLYGONS"), count, size] => {
                let mut numbers = reader.integers(number(size)).into_iter();
                let mut cells = Vec::new();
                while let Some(corners) = numbers.next() {
                    cells.push(numbers.by_ref().take(corners as usize).collect());
                }
                assert_eq!(cells.len(), number(count), "{name}");
                vtk.cells.push((name.to_owned(), cells));
            }
            ["CELL_DATA" | "POINT_DATA", count] => items = number(count),
            ["SCALARS", name, kind, "1"] => {
                assert_eq!(reader.line(), Some(vec!["LOOKUP_TABLE", "default"]));
                let values = match kind {
                    "int" => reader.integers(items).into_iter().map(|value| value as f32).collect(),
                    _ => reader.floats(items),
                };
                vtk.arrays.insert(name.to_owned(), values);
            }
            ["VECTORS" | "NORMALS", name, "float"] => {
                vtk.arrays.insert(name.to_owned(), reader.floats(3 * items));
            }
            _ => panic!("{line:?}"),
        }
    }
    assert!(reader.left.is_empty());
    vtk
}

#[test]
fn a_vtk_file_has_the_field_the_features_and_the_singularities() {
    for name in ["block", "sphere", "m6"] {
        let soup = example(name, 3_000);
        let surface = surface(&soup);
        let field = field(&surface);
        let found = vtk(&written(|path| write_field_vtk(path, &surface, &field).expect("it can be written")));
        let singularities = field.singularities(&surface);
        let curves = surface.features().curves().len();

        let sections: Vec<_> = found.cells.iter().map(|(name, cells)| (name.as_str(), cells.len())).collect();
        let expected = [("VERTICES", singularities.len()), ("LINES", curves), ("POLYGONS", surface.triangle_count())];
        let expected: Vec<_> = expected.into_iter().filter(|(_, count)| *count > 0).collect();
        assert_eq!(sections, expected, "{name}");
        let cells: Vec<&Vec<i32>> = found.cells.iter().flat_map(|(_, cells)| cells).collect();
        let [kind, index, u, v] = ["kind", "index", "cross_u", "cross_v"].map(|array| &found.arrays[array]);
        let vector = |array: &[f32], i: usize| DVec3::from_array([0, 1, 2].map(|k| f64::from(array[3 * i + k])));
        let normals = &found.arrays["normals"];
        for (i, cell) in cells.iter().enumerate() {
            let corners: Vec<DVec3> = cell.iter().map(|&p| found.points[p as usize]).collect();
            let [u, v] = [vector(u, i), vector(v, i)];
            match kind[i] as u32 {
                2 => {
                    let singularity = &singularities[i];
                    assert_eq!(f64::from(index[i]), singularity.index(), "{name}");
                    let place = DVec3::from(surface.frame().to_model(singularity.position));
                    assert!(cell.len() == 1 && corners[0].distance(place) < 1e-6, "{name}: {place}");
                }
                1 => assert!(cell.len() > 1 && u == DVec3::ZERO && v == DVec3::ZERO && index[i] == 0.0),
                _ => {
                    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize();
                    assert!((u.length() - 1.0).abs() < 1e-5 && u.dot(normal).abs() < 1e-3, "{name}: {u}");
                    assert!(v.distance(normal.cross(u)) < 1e-3, "{name}: {v}");
                    if name == "sphere" {
                        assert!(vector(normals, cell[0] as usize).dot(normal) > 0.9, "normals are outward");
                    }
                }
            }
        }
        if name == "block" {
            // The triangles of the top beside the edges along y: their crosses follow the edges.
            let follows = |i: usize| {
                let corners: Vec<DVec3> = cells[i].iter().map(|&p| found.points[p as usize]).collect();
                let beside = corners.iter().all(|p| p.z > 0.49 && p.x.abs() > 0.9 && p.y.abs() < 0.8);
                let u = vector(u, i);
                beside.then(|| u.x.abs().max(u.y.abs()) > 0.99)
            };
            let beside: Vec<bool> = (0..cells.len()).filter(|&i| kind[i] == 0.0).filter_map(follows).collect();
            assert!(beside.len() > 10 && beside.iter().all(|&follows| follows), "{beside:?}");
            assert!(singularities.iter().any(|s| matches!(s.location, SingularityLocation::Corner(_))));
        }
    }
}

#[test]
fn a_ply_file_is_as_long_as_its_header_says() {
    let surface = surface(&example("block", 2_000));
    let field = field(&surface);
    let bytes = written(|path| write_field_ply(path, &surface, &field).expect("it can be written"));
    let mut reader = Reader { left: &bytes };
    assert_eq!(reader.line(), Some(vec!["ply"]));
    assert_eq!(reader.line(), Some(vec!["format", "binary_little_endian", "1.0"]));
    let (mut count, mut sizes, mut properties) = (0, Vec::new(), HashMap::new());
    loop {
        match *reader.line().expect("the header ends") {
            ["end_header"] => break,
            ["element", name, number] => {
                count = number.parse::<usize>().expect("a number");
                sizes.push(0);
                properties.insert(name, count);
            }
            ["property", "list", "uchar", "int", _] => sizes[properties.len() - 1] += count * (1 + 3 * 4),
            ["property", "double", _] => sizes[properties.len() - 1] += count * 8,
            ["property", "float" | "int", _] => sizes[properties.len() - 1] += count * 4,
            ["comment", ..] => {}
            ref line => panic!("{line:?}"),
        }
    }
    assert_eq!(reader.left.len(), sizes.iter().sum::<usize>());
    assert_eq!(properties["vertex"], surface.vertex_count());
    assert_eq!(properties["face"], surface.triangle_count());
    let marked = (0..3 * surface.triangle_count() as u32).filter(|&h| surface.features().is_feature(h)).count();
    assert_eq!(properties["edge"], marked / 2, "a closed surface has each crease twice");

    let vertices = properties["vertex"];
    let mut floats =
        |count: usize| -> Vec<f64> { (0..count).map(|_| f64::from(f32::from_le_bytes(reader.bytes()))).collect() };
    let mut corners = 0.0;
    for vertex in 0..vertices {
        floats(6);
        let numbers = floats(10);
        let [n, u, v] = [0, 3, 6].map(|at| DVec3::from_slice(&numbers[at..]));
        assert!(n.cross(u).distance(v) < 1e-5 && (u.length() - 1.0).abs() < 1e-5, "vertex {vertex}: {n} {u} {v}");
        corners += numbers[9];
    }
    assert_eq!(corners, 2.0, "eight corners of a quarter");
}

/// A box, off the origin and turned by an angle about z, with its eight corners.
fn turned_box(angle: f64) -> Soup {
    let corner = |k: u32| {
        let [x, y, z] = [0, 1, 2].map(|axis| f64::from(k >> axis & 1));
        let [x, y, z] = [17.3 + 1.2 * x, -4.1 + 0.7 * y, 0.1 + z / 3.0];
        [x * angle.cos() - y * angle.sin(), x * angle.sin() + y * angle.cos(), z]
    };
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Soup { points: (0..8).map(corner).collect(), triangles, ..Soup::default() }
}

fn meshed(soup: &Soup, points: usize) -> Meshed {
    let options = Options::new(Fineness::Points(points));
    run(soup, &options, &Cpu, &unwatched).unwrap_or_else(|error| panic!("{error}")).meshed
}

/// The distance of a point from the nearest of the planes of a soup's triangles.
fn off_planes(soup: &Soup, point: [f64; 3]) -> f64 {
    let planes = soup.triangles.iter().map(|triangle| triangle.map(|v| DVec3::from(soup.points[v as usize])));
    let off = planes.map(|[a, b, c]| (b - a).cross(c - a).normalize().dot(DVec3::from(point) - a).abs());
    off.fold(f64::INFINITY, f64::min)
}

#[test]
fn corners_keep_their_bits_and_vertices_lie_on_the_planes_of_the_input() {
    for angle in [0.0, 0.3, 2.0] {
        let soup = turned_box(angle);
        let Meshed { mesh, vertices, .. } = meshed(&soup, 800);
        let corners: Vec<[f64; 3]> =
            mesh.points.iter().zip(&vertices).filter(|(_, v)| v.kind == VertexKind::Corner).map(|(p, _)| *p).collect();
        assert_eq!(corners.len(), 8);
        for corner in &soup.points {
            assert!(corners.iter().any(|found| found.map(f64::to_bits) == corner.map(f64::to_bits)), "{corner:?}");
        }
        let diagonal = 1.43;
        let farthest = mesh.points.iter().map(|&point| off_planes(&soup, point)).fold(0.0, f64::max);
        assert!(farthest <= 1e-12 * diagonal, "{farthest} off the planes");
        // In f32 they would not.
        let rough = mesh.points.iter().map(|point| off_planes(&soup, point.map(|x| f64::from(x as f32))));
        assert!(rough.fold(0.0, f64::max) > 1e-9);
        let surface = surface(&soup);
        let lossy = (0..8).filter(|&v| surface.frame().to_model(surface.point(v)) != surface.model_point(v));
        assert!(lossy.count() > 0, "the coordinates that are computed with are not the input's");
    }
}

#[test]
fn a_rim_on_a_plane_stays_on_it_exactly() {
    let soup = example("m6", 6_000);
    let Meshed { mesh, vertices, .. } = meshed(&soup, 1_500);
    let root: Vec<f64> = mesh.points.iter().map(|p| p[1]).filter(|y| y.abs() < 1e-6).collect();
    assert!(root.len() > 20 && root.iter().all(|&y| y == 0.0), "{root:?}");
    let on_boundary = vertices.iter().filter(|v| v.kind == VertexKind::Boundary).count();
    assert!((20..=root.len()).contains(&on_boundary), "{on_boundary} of {}", root.len());
}

#[test]
fn the_file_has_the_mesh() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let soup = turned_box(0.3);
    let Meshed { mesh, vertices, .. } = meshed(&soup, 300);
    let file = MeshFile::new(&mesh, &vertices).with_input(&soup, true);
    for format in [Format::Obj, Format::Ply] {
        let path = folder.path().join(format.name());
        write_mesh(&path, format, &file).expect("it can be written");
        let Mesh { points, .. } = &mesh;
        let read = read_mesh(&path).expect("it is a mesh");
        assert_eq!(&read.points, points, "{format}");
        assert!(read.faces().eq(ordered(&mesh).faces()), "{format}");
    }
}
