//! OFF: faces of any size; the names of regions are comments before their faces.

use super::MeshFile;
use super::numbers::{push, push_face, write_lines};
use std::io::{self, Write};

pub(super) fn write(writer: &mut dyn Write, file: &MeshFile) -> io::Result<()> {
    let mesh = file.mesh();
    writeln!(writer, "OFF\n# quadmosaic {}", env!("CARGO_PKG_VERSION"))?;
    writeln!(writer, "{} {} 0", mesh.points.len(), mesh.face_count())?;
    write_lines(writer, 0..mesh.points.len(), |text, v| {
        let [x, y, z] = mesh.points[v];
        push(text, format_args!("{x:?} {y:?} {z:?}\n"));
    })?;
    for group in file.groups() {
        if !group.name.is_empty() {
            writeln!(writer, "# {}", group.name)?;
        }
        write_lines(writer, group.faces(), |text, face| {
            let face = mesh.face(face);
            push(text, format_args!("{}", face.len()));
            push_face(text, " ", face, 0);
            text.push('\n');
        })?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::Format;
    use super::super::sample::{sample, text};

    #[test]
    fn counts_come_first_and_names_are_comments() {
        let expected = "OFF\n# quadmosaic V\n6 3 0\n0.0 0.0 0.0\n1.0 0.0 0.0\n1.0 1.0 0.0\n0.0 1.0 0.0\n\
                        2.0 0.0 0.3333333333333333\n2.0 1.0 -1e-7\n\
                        # wing tip\n4 0 1 2 3\n3 1 4 2\n# rest\n3 4 5 2\n";
        assert_eq!(text(Format::Off, &sample()), expected);
    }
}
