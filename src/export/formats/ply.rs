//! PLY, binary, little-endian.
//!
//! Vertices: `x y z` in f64; faces: `vertex_indices`, and `region` where there are regions (not every reader skips properties that
//! it does not know). The names of regions are comments `region NUMBER NAME`.

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
    let regions = &mesh.regions.of_face;
    writeln!(writer, "{}end_header", if regions.is_empty() { "" } else { "property int region\n" })?;
    write_bytes(writer, mesh.points.as_flattened().iter().map(|x| x.to_le_bytes()))?;
    let mut records = Vec::new();
    for (number, face) in mesh.faces().enumerate() {
        let count = (face.len() as u32).to_le_bytes();
        records.extend(if is_large { &count } else { &count[..1] });
        face.iter().for_each(|vertex| records.extend(vertex.to_le_bytes()));
        records.extend(regions.get(number).into_iter().flat_map(|region| region.to_le_bytes()));
    }
    writer.write_all(&records)
}

#[cfg(test)]
mod tests {
    use super::super::Format;
    use super::super::sample::{bytes, sample, with_pentagon};

    #[test]
    fn records_are_as_long_as_the_header_says() {
        let end = b"end_header\n";
        for (mesh, corners, records) in [(sample(), 10, 3 * (1 + 4)), (with_pentagon(), 8, 2)] {
            let bytes = bytes(Format::Ply, &mesh);
            let body = bytes.windows(end.len()).position(|some| some == end).expect("a header") + end.len();
            assert_eq!(bytes.len() - body, 6 * 24 + records + 4 * corners);
            let third = f64::from_le_bytes(bytes[body + 4 * 24 + 16..][..8].try_into().expect("eight bytes"));
            assert_eq!(third, 1.0 / 3.0);
        }
        let bytes = bytes(Format::Ply, &sample());
        assert!(String::from_utf8_lossy(&bytes).contains("comment region 0 wing tip\ncomment region 1 rest\n"));
        // The last triangle is of the second region.
        assert_eq!(bytes[bytes.len() - 4..], 1_i32.to_le_bytes());
    }
}
