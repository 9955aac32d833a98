//! Gmsh MSH 2.2, binary: a physical group a region.
//!
//! Source: the reference manual of Gmsh, section "MSH file format version 2".

use super::MeshFile;
use super::msh::{QUAD, TRIANGLE, write_head, write_integers};
use super::numbers::write_bytes;
use std::io::{self, Write};

pub(super) fn write(writer: &mut dyn Write, file: &MeshFile) -> io::Result<()> {
    let mesh = file.mesh();
    let groups = file.groups();
    write_head(writer, "2.2", &groups)?;
    writeln!(writer, "$Nodes\n{}", mesh.points.len())?;
    write_bytes(
        writer,
        (1..).zip(&mesh.points).map(|(number, &[x, y, z])| {
            let mut record = [0; 28];
            record[..4].copy_from_slice(&i32::to_le_bytes(number));
            for (bytes, x) in record[4..].chunks_exact_mut(8).zip([x, y, z]) {
                bytes.copy_from_slice(&x.to_le_bytes());
            }
            record
        }),
    )?;
    writeln!(writer, "\n$EndNodes\n$Elements\n{}", mesh.face_count())?;
    for (tag, group) in (1..).zip(&groups) {
        for (corners, faces) in group.blocks() {
            // Two tags: the physical group and the surface.
            let kind = if corners == 4 { QUAD } else { TRIANGLE };
            write_integers(writer, &[kind, faces.len() as i32, 2])?;
            let numbers = faces.flat_map(|face| {
                let vertices = mesh.face(face).iter().map(|&v| v as i32 + 1);
                [face as i32 + 1, tag, tag].into_iter().chain(vertices)
            });
            write_bytes(writer, numbers.map(i32::to_le_bytes))?;
        }
    }
    writeln!(writer, "\n$EndElements")
}

#[cfg(test)]
mod tests {
    use super::super::Format;
    use super::super::sample::{bytes, sample};

    #[test]
    fn sections_are_as_long_as_their_counts_say() {
        let bytes = bytes(Format::Msh22, &sample());
        let at = |name: &str| bytes.windows(name.len()).position(|some| some == name.as_bytes()).expect(name);
        let length = |name: &str| at(&format!("\n$End{name}")) - at(&format!("${name}\n")) - name.len() - 2;
        assert_eq!(length("MeshFormat"), "2.2 1 8\n".len() + 4);
        assert_eq!(length("Nodes"), 2 + 6 * (4 + 24));
        assert_eq!(length("Elements"), 2 + 3 * 12 + 4 * (3 * 3 + 4 + 3 + 3));
    }
}
