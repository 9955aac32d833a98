//! VTU, the XML format of VTK's unstructured grids, with the numbers appended in binary; the field data has an array for each
//! region, named as it, of its number and its dimension, 2.
//!
//! Source: the VTK file formats, section "XML file formats".

use super::MeshFile;
use super::mesh_file::{Array, Values};
use super::names::or_unnamed;
use super::numbers::write_bytes;
use super::vtk::cell_type;
use std::borrow::Cow;
use std::io::{self, Write};

pub(super) fn write(writer: &mut dyn Write, file: &MeshFile) -> io::Result<()> {
    let mesh = file.mesh();
    let integers = |name: &'static str, values: Vec<i32>| Array {
        name: name.into(),
        components: 1,
        values: Values::Integers(values),
    };
    let connectivity = mesh.faces().flatten().map(|&v| v as i32).collect();
    let ends = mesh.faces().scan(0, |end, face| {
        *end += face.len() as i32;
        Some(*end)
    });
    let points = Values::Floats(Cow::Borrowed(mesh.points.as_flattened()));
    let types = Values::Bytes(mesh.faces().map(|face| cell_type(face.len())).collect());
    let sections = [
        ("Points", vec![Array { name: "points".into(), components: 3, values: points }]),
        (
            "Cells",
            vec![
                integers("connectivity", connectivity),
                integers("offsets", ends.collect()),
                Array { name: "types".into(), components: 1, values: types },
            ],
        ),
        ("CellData", file.face_arrays()),
        ("PointData", file.vertex_arrays()),
    ];
    writeln!(writer, "<?xml version=\"1.0\"?>\n<!-- quadmosaic {} -->", env!("CARGO_PKG_VERSION"))?;
    writeln!(
        writer,
        "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">"
    )?;
    writeln!(writer, "<UnstructuredGrid>")?;
    if !mesh.regions.names.is_empty() {
        writeln!(writer, "<FieldData>")?;
        for (region, name) in mesh.regions.names.iter().enumerate() {
            let name = escaped(or_unnamed(name));
            let size = "NumberOfComponents=\"2\" NumberOfTuples=\"1\"";
            writeln!(
                writer,
                "<DataArray type=\"Int32\" Name=\"{name}\" {size} format=\"ascii\">{region} 2</DataArray>"
            )?;
        }
        writeln!(writer, "</FieldData>")?;
    }
    writeln!(writer, "<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">", mesh.points.len(), mesh.face_count())?;
    let mut offset = 0;
    for (section, arrays) in &sections {
        writeln!(writer, "<{section}>")?;
        for Array { name, components, values } in arrays {
            let (kind, bytes) = kind(values);
            let name = escaped(name);
            writeln!(
                writer,
                "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"appended\" offset=\"{offset}\"/>"
            )?;
            offset += size_of::<u64>() + bytes;
        }
        writeln!(writer, "</{section}>")?;
    }
    write!(writer, "</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_")?;
    for Array { values, .. } in sections.iter().flat_map(|(_, arrays)| arrays) {
        writer.write_all(&(kind(values).1 as u64).to_le_bytes())?;
        match values {
            Values::Bytes(bytes) => writer.write_all(bytes)?,
            Values::Integers(integers) => write_bytes(writer, integers.iter().map(|x| x.to_le_bytes()))?,
            Values::Floats(floats) => write_bytes(writer, floats.iter().map(|x| x.to_le_bytes()))?,
        }
    }
    writeln!(writer, "\n</AppendedData>\n</VTKFile>")
}

/// A name as the value of an attribute; characters that XML does not hold become `_`.
fn escaped(name: &str) -> String {
    let code = |c: char| match c {
        '&' => "&amp;".to_owned(),
        '<' => "&lt;".to_owned(),
        '"' => "&quot;".to_owned(),
        c if c.is_control() => "_".to_owned(),
        c => c.to_string(),
    };
    name.chars().map(code).collect()
}

/// The name of the type of numbers, and the size of all in bytes.
fn kind(values: &Values) -> (&'static str, usize) {
    match values {
        Values::Bytes(bytes) => ("UInt8", bytes.len()),
        Values::Integers(integers) => ("Int32", size_of_val(&integers[..])),
        Values::Floats(floats) => ("Float64", size_of_val(&floats[..])),
    }
}

#[cfg(test)]
mod tests {
    use super::super::Format;
    use super::super::sample::{bytes, sample};
    use super::*;

    #[test]
    fn names_are_valid_in_xml() {
        assert_eq!(escaped("a<b> & \"c\"\u{7}"), "a&lt;b> &amp; &quot;c&quot;_");
        let text = String::from_utf8_lossy(&bytes(Format::Vtu, &sample())).into_owned();
        assert!(
            text.contains("Name=\"wing tip\" NumberOfComponents=\"2\" NumberOfTuples=\"1\" format=\"ascii\">0 2<"),
            "{text}"
        );
    }

    #[test]
    fn blocks_begin_at_their_offsets() {
        let bytes = bytes(Format::Vtu, &sample());
        let head = String::from_utf8_lossy(&bytes).into_owned();
        let data = bytes.windows(7).position(|some| some == b"\"raw\">\n").expect("appended data") + 8;
        let arrays: Vec<(&str, usize)> = head
            .lines()
            .filter_map(|line| {
                let name = line.split("Name=\"").nth(1)?.split('"').next()?;
                Some((name, line.split("offset=\"").nth(1)?.split('"').next()?.parse().ok()?))
            })
            .collect();
        let size = |at: usize| u64::from_le_bytes(bytes[data + at..][..8].try_into().expect("eight bytes")) as usize;
        let expected = [
            ("points", 6 * 24),
            ("connectivity", 4 * 10),
            ("offsets", 4 * 3),
            ("types", 3),
            ("region", 4 * 3),
            ("shape", 8 * 3),
            ("scaled_jacobian", 8 * 3),
            ("kind", 4 * 6),
            ("field", 6 * 24),
            ("source_triangle", 4 * 6),
            ("source_barycentric", 6 * 24),
            ("RGB", 3 * 6),
            ("TCoords", 6 * 16),
            ("wall heat", 6 * 8),
        ];
        assert_eq!(arrays.iter().map(|&(name, at)| (name, size(at))).collect::<Vec<_>>(), expected);
        let last = arrays[arrays.len() - 1].1;
        assert_eq!(bytes[data + last + 8 + 6 * 8..], *b"\n</AppendedData>\n</VTKFile>\n");
    }
}
