//! glTF 2.0, binary: a node a region, with its triangles, and the edges of its faces as lines.
//!
//! Positions are f32 by definition. They are relative to the middle of the mesh, which is the translation of the nodes, so that a
//! mesh far from the origin keeps its shape. Colours (`COLOR_0`, as the input has them) and texture coordinates (`TEXCOORD_0`, counted
//! from the top) are those of vertices, of which there are several at seams.
//!
//! Source: the glTF 2.0 specification, section 4 (binary glTF).

use super::MeshFile;
use super::mesh_file::Group;
use super::numbers::write_bytes;
use super::triangles::triangles;
use crate::mesh::Mesh;
use crate::surface::AttributeKind;
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use serde_json::{Value, json};
use std::io::{self, Write};

/// Constants of the format.
const F32: u32 = 5126;
const U32: u32 = 5125;
const VERTICES: u32 = 34962;
const INDICES: u32 = 34963;
const LINES: u32 = 1;
const TRIANGLES: u32 = 4;
const JSON: u32 = 0x4E4F_534A;
const BINARY: u32 = 0x004E_4942;

pub(super) fn write(writer: &mut dyn Write, file: &MeshFile) -> io::Result<()> {
    let file = &*file.split_at_seams();
    let mesh = file.mesh();
    let (middle, positions) = positions(mesh);
    let (low, high) = positions.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(l, h), &p| (l.min(p), h.max(p)));
    let mut indices: Vec<u32> = Vec::new();
    let mut accessors = vec![json!({
        "bufferView": 0, "componentType": F32, "count": positions.len(), "type": "VEC3",
        "min": low.to_array(), "max": high.to_array()
    })];
    let mut attributes = json!({"POSITION": 0});
    let mut floats: Vec<f32> = positions.iter().flat_map(|p| p.to_array()).collect();
    for (kind, semantic, shape) in
        [(AttributeKind::Colour, "COLOR_0", "VEC3"), (AttributeKind::Texture, "TEXCOORD_0", "VEC2")]
    {
        let Some(attribute) = file.attribute(kind) else { continue };
        attributes[semantic] = json!(accessors.len());
        accessors.push(json!({
            "bufferView": 0, "byteOffset": size_of_val(&floats[..]), "componentType": F32, "count": positions.len(), "type": shape
        }));
        floats.extend((0..).zip(&attribute.values).map(|(place, &value)| match kind {
            // Pictures begin at the top.
            AttributeKind::Texture if place % 2 == 1 => 1.0 - value as f32,
            _ => value as f32,
        }));
    }
    let is_coloured = file.attribute(AttributeKind::Colour).is_some();
    let (mut nodes, mut meshes) = (Vec::new(), Vec::new());
    for group in file.groups() {
        let mut primitive = |mode: u32, some: &[u32]| {
            accessors.push(json!({
                "bufferView": 1, "byteOffset": size_of_val(&indices[..]), "componentType": U32, "count": some.len(), "type": "SCALAR"
            }));
            indices.extend(some);
            let attributes = if mode == LINES { json!({"POSITION": 0}) } else { attributes.clone() };
            json!({"attributes": attributes, "indices": accessors.len() - 1, "mode": mode, "material": u32::from(mode == LINES)})
        };
        let triangles = triangles(mesh, group.faces());
        let primitives =
            [primitive(TRIANGLES, triangles.as_flattened()), primitive(LINES, edges(mesh, &group).as_flattened())];
        nodes.push(json!({"mesh": meshes.len(), "name": group.name, "translation": middle.to_array()}));
        meshes.push(json!({"name": group.name, "primitives": primitives}));
    }
    let sizes = [size_of_val(&floats[..]), size_of_val(&indices[..])];
    let material = |shade: f32| json!({"pbrMetallicRoughness": {"baseColorFactor": [shade, shade, shade, 1.0], "metallicFactor": 0.0}, "doubleSided": true});
    let scene: Value = json!({
        "asset": {"version": "2.0", "generator": format!("quadmosaic {}", env!("CARGO_PKG_VERSION"))},
        "scene": 0,
        "scenes": [{"nodes": (0..nodes.len()).collect::<Vec<_>>()}],
        "nodes": nodes,
        "meshes": meshes,
        "materials": [material(if is_coloured { 1.0 } else { 0.8 }), material(0.1)],
        "accessors": accessors,
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": sizes[0], "target": VERTICES},
            {"buffer": 0, "byteOffset": sizes[0], "byteLength": sizes[1], "target": INDICES}
        ],
        "buffers": [{"byteLength": sizes[0] + sizes[1]}]
    });
    let mut text = scene.to_string();
    // Chunks begin at multiples of four.
    text.extend(std::iter::repeat_n(' ', text.len().next_multiple_of(4) - text.len()));
    let binary = sizes[0] + sizes[1];
    let whole = 12 + 8 + text.len() + 8 + binary;
    writer.write_all(b"glTF")?;
    write_bytes(writer, [2, whole as u32, text.len() as u32, JSON].map(u32::to_le_bytes))?;
    writer.write_all(text.as_bytes())?;
    write_bytes(writer, [binary as u32, BINARY].map(u32::to_le_bytes))?;
    write_bytes(writer, floats.into_iter().map(f32::to_le_bytes))?;
    write_bytes(writer, indices.into_iter().map(u32::to_le_bytes))
}

/// The middle of the mesh, and its points relative to that.
fn positions(mesh: &Mesh) -> (DVec3, Vec<Vec3>) {
    let points = || mesh.points.iter().map(|&point| DVec3::from(point));
    let (low, high) = points().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), p| (l.min(p), h.max(p)));
    let middle = if mesh.points.is_empty() { DVec3::ZERO } else { low + (high - low) / 2.0 };
    (middle, points().map(|point| (point - middle).as_vec3()).collect())
}

/// The edges of a group's faces, each once.
fn edges(mesh: &Mesh, group: &Group) -> Vec<[u32; 2]> {
    let sides = |face: &[u32]| -> Vec<[u32; 2]> {
        face.iter().zip(face.iter().cycle().skip(1)).map(|(&a, &b)| [a.min(b), a.max(b)]).collect()
    };
    let mut edges: Vec<[u32; 2]> = group.faces().flat_map(|face| sides(mesh.face(face))).collect();
    edges.par_sort_unstable();
    edges.dedup();
    edges
}

#[cfg(test)]
mod tests {
    use super::super::Format;
    use super::super::sample::{bytes, plain, sample};
    use super::*;

    #[test]
    fn chunks_and_views_are_as_long_as_they_say() {
        let bytes = bytes(Format::Glb, &plain());
        let number = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes")) as usize;
        assert_eq!((number(4), number(8), number(16)), (2, bytes.len(), JSON as usize));
        let text = number(12);
        let scene: Value = serde_json::from_slice(&bytes[20..20 + text]).expect("it is JSON");
        // Six points, and of the regions three triangles and one, six edges and three.
        let [points, indices] = [6 * 12, 4 * (3 * 4 + 2 * (6 + 3))];
        assert_eq!(number(20 + text), points + indices);
        assert_eq!(bytes.len(), 28 + text + points + indices);
        assert_eq!(
            scene["bufferViews"][1],
            json!({"buffer": 0, "byteOffset": points, "byteLength": indices, "target": INDICES})
        );
        assert_eq!(scene["nodes"][0]["name"], "wing tip");
        assert_eq!(scene["accessors"][2]["count"], 12);
        assert_eq!(scene["nodes"][0]["translation"][0], 1.0);
        assert_eq!(scene["accessors"][0]["min"][0], -1.0);
    }
    #[test]
    fn vertices_on_a_seam_are_doubled() {
        let bytes = bytes(Format::Glb, &sample());
        let text = u32::from_le_bytes(bytes[12..16].try_into().expect("four bytes")) as usize;
        let scene: Value = serde_json::from_slice(&bytes[20..20 + text]).expect("it is JSON");
        let primitives = &scene["meshes"][0]["primitives"];
        assert_eq!(primitives[0]["attributes"], json!({"POSITION": 0, "COLOR_0": 1, "TEXCOORD_0": 2}));
        assert_eq!(primitives[1]["attributes"], json!({"POSITION": 0}));
        for accessor in 0..3 {
            assert_eq!(scene["accessors"][accessor]["count"], 8);
        }
        assert_eq!(scene["bufferViews"][0]["byteLength"], 8 * 4 * (3 + 3 + 2));
        let first = 28 + text + scene["accessors"][2]["byteOffset"].as_u64().expect("a number") as usize;
        let number = |k: usize| f32::from_le_bytes(bytes[first + 4 * k..][..4].try_into().expect("four bytes"));
        // The third vertex is (1, 1).
        assert_eq!((number(3), number(5)), (1.0, 0.0));
    }
}
