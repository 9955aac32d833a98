//! Nastran bulk data: CQUAD4 and CTRIA3, a property number a region.
//!
//! # Practice
//! Vertices are in large fields: 16 characters a number. Elements are in small fields, which hold eight digits. The names of the
//! properties are comments before their elements, in the form that HyperMesh reads. The properties themselves (PSHELL) and materials
//! come from the model that includes the file.

use super::MeshFile;
use super::numbers::{push, within, write_lines};
use std::io::{self, Write};

/// The characters of a large field.
const WIDTH: usize = 16;

pub(super) fn write(writer: &mut dyn Write, file: &MeshFile) -> io::Result<()> {
    let mesh = file.mesh();
    writeln!(writer, "$ quadmosaic {}\nBEGIN BULK", env!("CARGO_PKG_VERSION"))?;
    write_lines(writer, 0..mesh.points.len(), |text, v| {
        let [x, y, z] = mesh.points[v].map(|x| within(WIDTH, x));
        push(text, format_args!("GRID*   {:<16}{:16}{x:>16}{y:>16}\n*       {z:>16}\n", v + 1, ""));
    })?;
    for (property, group) in (1..).zip(file.groups()) {
        if !group.name.is_empty() {
            writeln!(writer, "$HMNAME PROP{property:>20}\"{}\"", group.name)?;
        }
        write_lines(writer, group.faces(), |text, face| {
            let corners = mesh.face(face);
            let name = if corners.len() == 4 { "CQUAD4" } else { "CTRIA3" };
            push(text, format_args!("{name:<8}{:<8}{property:<8}", face + 1));
            corners.iter().for_each(|corner| push(text, format_args!("{:<8}", corner + 1)));
            text.push('\n');
        })?;
    }
    writeln!(writer, "ENDDATA")
}

#[cfg(test)]
mod tests {
    use super::super::Format;
    use super::super::sample::{sample, text};

    #[test]
    fn fields_are_in_their_columns() {
        let text = text(Format::Bdf, &sample());
        let vertex =
            "GRID*   5                                            2.0             0.0\n*       0.33333333333333\n";
        assert!(text.starts_with("$ quadmosaic V\nBEGIN BULK\nGRID*   1 ") && text.contains(vertex), "{text}");
        let elements = "$HMNAME PROP                   1\"wing tip\"\n\
                        CQUAD4  1       1       1       2       3       4       \n\
                        CTRIA3  2       1       2       5       3       \n\
                        $HMNAME PROP                   2\"rest\"\n\
                        CTRIA3  3       2       5       6       3       \nENDDATA\n";
        assert!(text.ends_with(elements), "{text}");
    }
}
