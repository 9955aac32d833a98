//! Meshes with colours, as PLY files.

use super::{WriteError, atomic};
use crate::mesh::Mesh;
use std::io::{self, Write};
use std::path::Path;

/// What a face has beside its corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shade {
    /// A measure of it.
    pub quality: f32,
    /// Red, green and blue.
    pub colour: [u8; 3],
}

/// Writes a mesh with a shade for each face as PLY, binary, little-endian.
///
/// Vertices: `x y z` in f64, and `red green blue`, those of the last face at it; faces: their vertices, `quality`, `red green
/// blue`. Faces without a shade are black.
///
/// # Errors
/// [`WriteError`] names the file and the reason; no half written file is left.
pub fn write_mesh_ply(path: &Path, mesh: &Mesh, shades: &[Shade]) -> Result<(), WriteError> {
    atomic(path, |writer| records(writer, mesh, shades))
}

const COLOUR: &str = "property uchar red\nproperty uchar green\nproperty uchar blue\n";

fn records(writer: &mut dyn Write, mesh: &Mesh, shades: &[Shade]) -> io::Result<()> {
    let shade = |face: usize| shades.get(face).copied().unwrap_or(Shade { quality: 0.0, colour: [0; 3] });
    let mut colours = vec![[0; 3]; mesh.points.len()];
    for (number, face) in mesh.faces().enumerate() {
        face.iter().for_each(|&vertex| colours[vertex as usize] = shade(number).colour);
    }
    writeln!(writer, "ply\nformat binary_little_endian 1.0\ncomment quadmosaic {}", env!("CARGO_PKG_VERSION"))?;
    writeln!(writer, "element vertex {}", mesh.points.len())?;
    write!(writer, "property double x\nproperty double y\nproperty double z\n{COLOUR}")?;
    writeln!(writer, "element face {}", mesh.face_count())?;
    writeln!(writer, "property list uint int vertex_indices\nproperty float quality\n{COLOUR}end_header")?;
    for (point, colour) in mesh.points.iter().zip(&colours) {
        point.iter().try_for_each(|x| writer.write_all(&x.to_le_bytes()))?;
        writer.write_all(colour)?;
    }
    for (number, face) in mesh.faces().enumerate() {
        writer.write_all(&(face.len() as u32).to_le_bytes())?;
        face.iter().try_for_each(|&vertex| writer.write_all(&(vertex as i32).to_le_bytes()))?;
        let Shade { quality, colour } = shade(number);
        writer.write_all(&quality.to_le_bytes())?;
        writer.write_all(&colour)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::read_mesh;

    #[test]
    fn faces_come_back_and_each_has_its_colour() {
        let points =
            [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 1.0 / 3.0], [0.0, 1.0, 0.0], [2.0, 0.0, 0.0], [2.0, 1.0, 0.0]];
        let mut mesh = Mesh::new(points.to_vec());
        mesh.push_face(&[0, 1, 2, 3]);
        mesh.push_face(&[4, 5, 2]);
        let shades = [([1, 2, 3], 0.25), ([4, 5, 6], 1.0)].map(|(colour, quality)| Shade { quality, colour });
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("a.ply");
        write_mesh_ply(&path, &mesh, &shades).expect("it can be written");
        assert_eq!(read_mesh(&path).expect("it is a mesh"), mesh);
        let bytes = std::fs::read(&path).expect("it is there");
        let tail = &bytes[bytes.len() - (4 + 12 + 4 + 3)..];
        assert_eq!(tail[16..20], 1.0_f32.to_le_bytes());
        assert_eq!(tail[20..], [4, 5, 6]);
    }
}
