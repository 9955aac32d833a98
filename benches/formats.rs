//! Writing a million quads.

mod common;

use criterion::{Criterion, criterion_group, criterion_main};
use quadmosaic::export::{Format, MeshFile, write_mesh};
use quadmosaic::mesh::{Mesh, VertexAttributes};
use quadmosaic::surface::Soup;

/// The quads along either side.
const SIDE: u32 = 1000;

/// A sheet of quads whose coordinates have all their digits.
fn sheet() -> MeshFile {
    let points = (0..=SIDE).flat_map(|i| (0..=SIDE).map(move |j| [i, j].map(|k| f64::from(k) / 7.0)));
    let mut mesh = Mesh::new(points.map(|[x, y]| [x, y, (x / 9.0).sin() * (y / 8.0).cos()]).collect());
    for corner in (0..SIDE).flat_map(|i| (0..SIDE).map(move |j| i * (SIDE + 1) + j)) {
        mesh.push_face(&[corner, corner + SIDE + 1, corner + SIDE + 2, corner + 1]);
    }
    let vertices = vec![VertexAttributes::default(); mesh.points.len()];
    let soup = Soup { points: mesh.points[..3].to_vec(), triangles: vec![[0, 1, 2]], ..Soup::default() };
    MeshFile::new(&mesh, &vertices, &soup)
}

fn bench(criterion: &mut Criterion) {
    let (mesh, folder) = (sheet(), tempfile::tempdir().expect("a temporary folder"));
    for format in Format::all() {
        let path = folder.path().join(format.name());
        criterion.bench_function(&format!("write {format}"), |b| b.iter(|| write_mesh(&path, format, &mesh)));
    }
}

criterion_group! { name = benches; config = common::criterion(); targets = bench }
criterion_main!(benches);
