//! PLY, binary, little-endian.
//!
//! Vertices: `x y z` in f64, colours as `red green blue` in bytes, texture coordinates as `s t`, and other numbers of the input by
//! their names; at a seam, a vertex has the texture coordinates of one side. Faces: `vertex_indices`, and `region` where there are regions (not every reader skips properties that
//! it does not know). The names of regions are comments `region NUMBER NAME`.

use super::MeshFile;
use super::mesh_file::{Array, Values};
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
    writeln!(writer, "property double x\nproperty double y\nproperty double z")?;
    let arrays = file.given_arrays();
    for array in &arrays {
        let kind = match array.values {
            Values::Bytes(_) => "uchar",
            Values::Integers(_) => "int",
            Values::Floats(_) => "double",
        };
        properties(array).iter().try_for_each(|name| writeln!(writer, "property {kind} {name}"))?;
    }
    writeln!(writer, "element face {}", mesh.face_count())?;
    writeln!(writer, "property list {} int vertex_indices", if is_large { "uint" } else { "uchar" })?;
    let regions = &mesh.regions.of_face;
    writeln!(writer, "{}end_header", if regions.is_empty() { "" } else { "property int region\n" })?;
    let mut records = Vec::new();
    for (v, point) in mesh.points.iter().enumerate() {
        records.extend(point.iter().flat_map(|x| x.to_le_bytes()));
        for Array { components, values, .. } in &arrays {
            let places = v * components..(v + 1) * components;
            match values {
                Values::Bytes(bytes) => records.extend(&bytes[places]),
                Values::Integers(integers) => records.extend(integers[places].iter().flat_map(|x| x.to_le_bytes())),
                Values::Floats(floats) => records.extend(floats[places].iter().flat_map(|x| x.to_le_bytes())),
            }
        }
    }
    writer.write_all(&records)?;
    records.clear();
    for (number, face) in mesh.faces().enumerate() {
        let count = (face.len() as u32).to_le_bytes();
        records.extend(if is_large { &count } else { &count[..1] });
        face.iter().for_each(|vertex| records.extend(vertex.to_le_bytes()));
        records.extend(regions.get(number).into_iter().flat_map(|region| region.to_le_bytes()));
    }
    writer.write_all(&records)
}

/// The names of an array's components, without blanks.
fn properties(array: &Array) -> Vec<String> {
    let plain: String = array.name.chars().map(|c| if c.is_whitespace() || c.is_control() { '_' } else { c }).collect();
    match (&*plain, array.components) {
        ("RGB", 3) => ["red", "green", "blue"].map(str::to_owned).to_vec(),
        ("TCoords", 2) => ["s", "t"].map(str::to_owned).to_vec(),
        // The place has these names.
        ("x" | "y" | "z", 1) => vec![format!("{plain}_")],
        (_, 1) => vec![plain],
        (_, count) => (0..count).map(|k| format!("{plain}_{k}")).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::Format;
    use super::super::sample::{bytes, plain, sample, with_pentagon};

    #[test]
    fn records_are_as_long_as_the_header_says() {
        let end = b"end_header\n";
        // Of each vertex of the sample: source, colour, texture coordinates, heat.
        let more = 4 + 24 + 3 + 16 + 8;
        for (mesh, corners, records, more) in
            [(plain(), 10, 3 * (1 + 4), 0), (with_pentagon(), 8, 2, 0), (sample(), 10, 3 * (1 + 4), more)]
        {
            let bytes = bytes(Format::Ply, &mesh);
            let body = bytes.windows(end.len()).position(|some| some == end).expect("a header") + end.len();
            assert_eq!(bytes.len() - body, 6 * (24 + more) + records + 4 * corners);
            let third = f64::from_le_bytes(bytes[body + 4 * (24 + more) + 16..][..8].try_into().expect("eight bytes"));
            assert_eq!(third, 1.0 / 3.0);
        }
        let bytes = bytes(Format::Ply, &sample());
        assert!(String::from_utf8_lossy(&bytes).contains("comment region 0 wing tip\ncomment region 1 rest\n"));
        // The last triangle is of the second region.
        assert_eq!(bytes[bytes.len() - 4..], 1_i32.to_le_bytes());
    }
}
