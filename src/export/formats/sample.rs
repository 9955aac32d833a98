//! A small mesh for the tests of the formats.

use super::{Format, MeshFile, write_mesh_to};
use crate::mesh::{Mesh, VertexAttributes, VertexKind};
use crate::surface::{Attribute, AttributeKind, Regions, Soup};

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
        (0..6).map(|v| VertexAttributes { kind: kinds[v % 3], direction: [1.0, 0.0, 0.0] }).collect();
    MeshFile::new(&mesh(), &vertices).with_input(&soup(), true)
}

/// The triangles that the mesh was made of: colours are red and blue, texture coordinates jump between the triangle of the second
/// region and the others.
fn soup() -> Soup {
    let triangles = vec![[0, 1, 2], [0, 2, 3], [1, 4, 2], [4, 5, 2]];
    let mut soup = Soup { points: POINTS.to_vec(), triangles, ..Soup::default() };
    let colours = (0..6).flat_map(|v| if v < 4 { [1.0, 0.0, 0.0] } else { [0.0, 0.0, 1.0] }).collect();
    let heat = (0..6).map(|v| f64::from(v) / 2.0).collect();
    let corners = soup.triangles.as_flattened().iter().zip(0..);
    let textures = corners.flat_map(|(&v, corner)| {
        let [x, y, _] = POINTS[v as usize];
        [x / 4.0 + if corner < 9 { 0.0 } else { 0.5 }, y]
    });
    let texture = Attribute::of_vertices("", AttributeKind::Texture, 2, textures.collect());
    soup.attributes.list = vec![
        Attribute::of_vertices("", AttributeKind::Colour, 3, colours),
        Attribute { of_corners: (0..12).collect(), ..texture },
        Attribute::of_vertices("wall heat", AttributeKind::Numbers, 1, heat),
    ];
    soup
}

/// The mesh with its regions alone.
pub(super) fn plain() -> MeshFile {
    MeshFile::from(&mesh())
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
