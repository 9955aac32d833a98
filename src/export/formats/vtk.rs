//! VTK legacy, binary, big-endian: an unstructured grid with arrays of vertices and faces; the field data has an
//! array for each region, named as it, of its number and its dimension, 2.
//!
//! Source: the VTK file formats, section "Simple legacy formats"; version 3.0, which every program reads.

use super::MeshFile;
use super::mesh_file::{Array, Values};
use super::names::or_unnamed;
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
        writeln!(writer, "FIELD FieldData {}", mesh.regions.names.len())?;
        for (region, name) in (0_i32..).zip(&mesh.regions.names) {
            writeln!(writer, "{} 2 1 int", encoded(or_unnamed(name)))?;
            write_bytes(writer, [region, 2].map(i32::to_be_bytes))?;
            writeln!(writer)?;
        }
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
        write!(writer, "\n{} {components} {count} ", encoded(name))?;
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

/// A name as VTK writes it: without blanks, which are `%20`.
fn encoded(name: &str) -> String {
    let code = |byte: u8| match byte {
        b'!'..=b'~' if !b"\"%".contains(&byte) => char::from(byte).to_string(),
        _ => format!("%{byte:02X}"),
    };
    name.bytes().map(code).collect()
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
            "DATASET UNSTRUCTURED_GRID\nFIELD FieldData 2\nwing%20tip 2 1 int\n",
            "\nPOINTS 6 double\n",
            "\nCELLS 3 13\n",
            "\nCELL_TYPES 3\n",
            "\nCELL_DATA 3\nFIELD FieldData 3\nregion 1 3 int\n",
            "\nPOINT_DATA 6\nFIELD FieldData 7\nkind 1 6 int\n",
            "\nsource_barycentric 3 6 double\n",
            "\nRGB 3 6 unsigned_char\n",
            "\nwall%20heat 1 6 double\n",
        ] {
            from += text[from..].find(line).unwrap_or_else(|| panic!("{line} in {text}"));
        }
    }

    #[test]
    fn names_have_no_blanks() {
        assert_eq!(encoded("wing tip 5%"), "wing%20tip%205%25");
        assert_eq!(encoded("ü"), "%C3%BC");
    }
}
