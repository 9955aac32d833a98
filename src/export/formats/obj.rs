//! Wavefront OBJ: quads as quads, larger faces as polygons, regions as groups.

use super::MeshFile;
use super::numbers::{push_face, push_point, write_lines};
use std::io::{self, Write};

pub(super) fn write(writer: &mut dyn Write, file: &MeshFile) -> io::Result<()> {
    let mesh = file.mesh();
    writeln!(writer, "# quadmosaic {}", env!("CARGO_PKG_VERSION"))?;
    write_lines(writer, 0..mesh.points.len(), |text, v| {
        text.push('v');
        push_point(text, " ", &mesh.points[v]);
        text.push('\n');
    })?;
    for group in file.groups() {
        if !mesh.regions.names.is_empty() {
            writeln!(writer, "{}", format!("g {}", group.name).trim_end())?;
        }
        write_lines(writer, group.faces(), |text, face| {
            text.push('f');
            push_face(text, " ", mesh.face(face), 1);
            text.push('\n');
        })?;
    }
    Ok(())
}
