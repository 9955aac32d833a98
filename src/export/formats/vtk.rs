//! VTK legacy, binary, big-endian: an unstructured grid with arrays of vertices and faces; the field data `region_names` has the
//! names of regions.
//!
//! Source: the VTK file formats, section "Simple legacy formats"; version 3.0, which every program reads.

use super::MeshFile;
use super::mesh_file::{Array, Values};
use super::numbers::write_bytes;
use std::io::{self, Write};

/// VTK's types of cells, by the number of corners.
pub(super) fn cell_type(corners: usize) -> u8 {
    match corners {
        3 => 5,
        4 => 9,
        _ => 7,
    }
}

pub(super) fn write(writer: &mut dyn Write, file: &MeshFile) -> io::Result<()> {
    let mesh = file.mesh();
    writeln!(writer, "# vtk DataFile Version 3.0\nquadmosaic {}\nBINARY", env!("CARGO_PKG_VERSION"))?;
    writeln!(writer, "DATASET UNSTRUCTURED_GRID")?;
    if !mesh.regions.names.is_empty() {
        writeln!(writer, "FIELD FieldData 1\nregion_names 1 {} string", mesh.regions.names.len())?;
        for name in &mesh.regions.names {
            write_string(writer, name)?;
        }
        writeln!(writer)?;
    }
    writeln!(writer, "POINTS {} double", mesh.points.len())?;
    write_bytes(writer, mesh.points.as_flattened().iter().map(|x| x.to_be_bytes()))?;
    let corners: usize = mesh.faces().map(<[u32]>::len).sum();
    writeln!(writer, "\nCELLS {} {}", mesh.face_count(), mesh.face_count() + corners)?;
    let numbers = mesh.faces().flat_map(|face| std::iter::once(face.len() as u32).chain(face.iter().copied()));
    write_bytes(writer, numbers.map(u32::to_be_bytes))?;
    writeln!(writer, "\nCELL_TYPES {}", mesh.face_count())?;
    write_bytes(writer, mesh.faces().map(|face| i32::from(cell_type(face.len())).to_be_bytes()))?;
    write_arrays(writer, "CELL_DATA", mesh.face_count(), &file.face_arrays())?;
    write_arrays(writer, "POINT_DATA", mesh.points.len(), &file.vertex_arrays())?;
    writeln!(writer)
}

fn write_arrays(writer: &mut dyn Write, section: &str, count: usize, arrays: &[Array]) -> io::Result<()> {
    if arrays.is_empty() {
        return Ok(());
    }
    write!(writer, "\n{section} {count}\nFIELD FieldData {}", arrays.len())?;
    for Array { name, components, values } in arrays {
        write!(writer, "\n{name} {components} {count} ")?;
        match values {
            Values::Bytes(bytes) => {
                writeln!(writer, "unsigned_char")?;
                writer.write_all(bytes)?;
            }
            Values::Integers(integers) => {
                writeln!(writer, "int")?;
                write_bytes(writer, integers.iter().map(|x| x.to_be_bytes()))?;
            }
            Values::Floats(floats) => {
                writeln!(writer, "double")?;
                write_bytes(writer, floats.iter().map(|x| x.to_be_bytes()))?;
            }
        }
    }
    Ok(())
}

/// Writes a string as VTK does: its length, whose size the first two bits tell, and its bytes.
fn write_string(writer: &mut dyn Write, text: &str) -> io::Result<()> {
    match text.len() as u64 {
        length @ ..0x40 => writer.write_all(&[0xC0 | length as u8])?,
        length @ ..0x4000 => writer.write_all(&(0x8000 | length as u16).to_be_bytes())?,
        length => writer.write_all(&(0x4000_0000 | length as u32).to_be_bytes())?,
    }
    writer.write_all(text.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::super::Format;
    use super::super::sample::{bytes, sample};
    use super::*;

    #[test]
    fn sections_follow_each_other() {
        let bytes = bytes(Format::Vtk, &sample());
        let text = String::from_utf8_lossy(&bytes);
        let mut from = 0;
        for line in [
            "DATASET UNSTRUCTURED_GRID\nFIELD FieldData 1\nregion_names 1 2 string\n",
            "\nPOINTS 6 double\n",
            "\nCELLS 3 13\n",
            "\nCELL_TYPES 3\n",
            "\nCELL_DATA 3\nFIELD FieldData 3\nregion 1 3 int\n",
            "\nPOINT_DATA 6\nFIELD FieldData 4\nkind 1 6 int\n",
            "\nsource_barycentric 3 6 double\n",
        ] {
            from += text[from..].find(line).unwrap_or_else(|| panic!("{line} in {text}"));
        }
    }

    #[test]
    fn the_length_of_a_string_comes_first() {
        let written = |length: usize| {
            let mut bytes = Vec::new();
            write_string(&mut bytes, &"a".repeat(length)).expect("a vector takes all");
            bytes
        };
        assert_eq!(written(3), [0xC3, b'a', b'a', b'a']);
        assert_eq!(written(200)[..3], [0x80, 200, b'a']);
        assert_eq!(written(20_000)[..5], [0x40, 0, 0x4E, 0x20, b'a']);
    }
}
