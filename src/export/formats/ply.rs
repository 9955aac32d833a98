//! PLY, binary, little-endian.
//!
//! Vertices: `x y z` in f64; faces: `vertex_indices`, and `region`. The names of regions are comments `region NUMBER NAME`.

use super::MeshFile;
use super::numbers::write_bytes;
use std::io::{self, Write};

/// The most corners that a byte counts.
const BYTE: usize = u8::MAX as usize;

pub(super) fn write(writer: &mut dyn Write, file: &MeshFile) -> io::Result<()> {
    let mesh = file.mesh();
    let is_large = mesh.faces().any(|face| face.len() > BYTE);
    writeln!(writer, "ply\nformat binary_little_endian 1.0\ncomment quadmosaic {}", env!("CARGO_PKG_VERSION"))?;
    for (region, name) in mesh.regions.names.iter().enumerate() {
        writeln!(writer, "comment region {region} {name}")?;
    }
    writeln!(writer, "element vertex {}", mesh.points.len())?;
    writeln!(writer, "property double x\nproperty double y\nproperty double z\nelement face {}", mesh.face_count())?;
    writeln!(writer, "property list {} int vertex_indices", if is_large { "uint" } else { "uchar" })?;
    writeln!(writer, "property int region\nend_header")?;
    write_bytes(writer, mesh.points.as_flattened().iter().map(|x| x.to_le_bytes()))?;
    for (number, face) in mesh.faces().enumerate() {
        let count = (face.len() as u32).to_le_bytes();
        writer.write_all(if is_large { &count } else { &count[..1] })?;
        face.iter().try_for_each(|vertex| writer.write_all(&vertex.to_le_bytes()))?;
        writer.write_all(&mesh.regions.of_face.get(number).copied().unwrap_or(0).to_le_bytes())?;
    }
    Ok(())
}
