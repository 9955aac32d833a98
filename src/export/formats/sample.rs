//! A small mesh for the tests of the formats.

use super::{Format, MeshFile, write_mesh_to};
use crate::mesh::{Mesh, VertexAttributes, VertexKind};
use crate::surface::{Regions, Soup};

/// The points of the sample.
pub(super) const POINTS: [[f64; 3]; 6] =
    [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [2.0, 0.0, 1.0 / 3.0], [2.0, 1.0, -1e-7]];

/// A triangle, a quad and a triangle of two regions, the first two in the wrong order.
fn mesh() -> Mesh {
    let mut mesh = Mesh::new(POINTS.to_vec());
    mesh.push_face(&[1, 4, 2]);
    mesh.push_face(&[0, 1, 2, 3]);
    mesh.push_face(&[4, 5, 2]);
    mesh.regions = Regions { names: vec!["wing tip".to_owned(), "rest".to_owned()], of_face: vec![0, 0, 1] };
    mesh
}

/// The mesh with all that can be known.
pub(super) fn sample() -> MeshFile {
    let kinds = [VertexKind::Corner, VertexKind::Free, VertexKind::Feature];
    let vertices: Vec<VertexAttributes> =
        (0..6).map(|v| VertexAttributes { kind: kinds[v % 3], triangle: 0, direction: [1.0, 0.0, 0.0] }).collect();
    let soup = Soup { points: POINTS.to_vec(), triangles: vec![[0, 1, 2]], ..Soup::default() };
    MeshFile::new(&mesh(), &vertices, &soup)
}

/// The mesh without regions, with a face of five corners.
pub(super) fn with_pentagon() -> MeshFile {
    let mut pentagon = Mesh::new(POINTS.to_vec());
    pentagon.push_face(&[0, 1, 4, 2, 3]);
    pentagon.push_face(&[4, 5, 2]);
    MeshFile::from(&pentagon)
}

/// The file in a format.
pub(super) fn bytes(format: Format, mesh: &MeshFile) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_mesh_to(&mut bytes, format, mesh).expect("a vector takes all");
    bytes
}

/// The file in a format of text, without the version of the program.
pub(super) fn text(format: Format, mesh: &MeshFile) -> String {
    let text = String::from_utf8(bytes(format, mesh)).expect("it is text");
    text.replace(env!("CARGO_PKG_VERSION"), "V")
}
