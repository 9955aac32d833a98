//! Reading a million triangles, and writing a million quads.

mod common;

use criterion::{Criterion, criterion_group, criterion_main};
use quadmosaic::export::{Format, MeshFile, write_mesh};
use quadmosaic::mesh::{Mesh, VertexAttributes};
use quadmosaic::surface::Regions;
use quadmosaic::surface::load::read;

/// The quads along the longer side.
const SIDE: u32 = 1000;

/// A sheet of quads, so many wide, whose coordinates have all their digits.
fn sheet(width: u32) -> Mesh {
    let points = (0..=SIDE).flat_map(|i| (0..=width).map(move |j| [i, j].map(|k| f64::from(k) / 7.0)));
    let mut mesh = Mesh::new(points.map(|[x, y]| [x, y, (x / 9.0).sin() * (y / 8.0).cos()]).collect());
    for corner in (0..SIDE).flat_map(|i| (0..width).map(move |j| i * (width + 1) + j)) {
        mesh.push_face(&[corner, corner + width + 1, corner + width + 2, corner + 1]);
    }
    mesh
}

/// A million triangles.
fn triangles() -> Mesh {
    let quads = sheet(SIDE / 2);
    let mut mesh = Mesh::new(quads.points.clone());
    for face in quads.faces() {
        mesh.push_face(&[face[0], face[1], face[2]]);
        mesh.push_face(&[face[0], face[2], face[3]]);
    }
    mesh
}

fn bench(criterion: &mut Criterion) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let plain = triangles();
    // STL is ASCII where regions have names.
    let mut named = plain.clone();
    named.regions = Regions { names: vec!["sheet".to_owned()], of_face: vec![0; plain.face_count()] };
    for (name, format, mesh) in [
        ("OBJ", Format::Obj, &plain),
        ("STL, binary", Format::Stl, &plain),
        ("STL, ASCII", Format::Stl, &named),
        ("PLY", Format::Ply, &plain),
        ("MSH", Format::Msh, &plain),
    ] {
        let path = folder.path().join(format.name());
        write_mesh(&path, format, &MeshFile::from(mesh)).expect("it can be written");
        criterion.bench_function(&format!("read {name}"), |b| b.iter(|| read(&path).expect("it can be read")));
    }
    let mesh = sheet(SIDE);
    let mesh = MeshFile::new(&mesh, &vec![VertexAttributes::default(); mesh.points.len()]);
    for format in Format::all() {
        let path = folder.path().join(format.name());
        criterion.bench_function(&format!("write {format}"), |b| b.iter(|| write_mesh(&path, format, &mesh)));
    }
}

criterion_group! { name = benches; config = common::criterion(); targets = bench }
criterion_main!(benches);
