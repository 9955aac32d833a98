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

#[cfg(test)]
mod tests {
    use super::super::Format;
    use super::super::sample::{sample, text, with_pentagon};

    #[test]
    fn regions_are_groups_and_quads_come_first() {
        let points = "v 0.0 0.0 0.0\nv 1.0 0.0 0.0\nv 1.0 1.0 0.0\nv 0.0 1.0 0.0\nv 2.0 0.0 0.3333333333333333\nv 2.0 1.0 -1e-7\n";
        let faces = "g wing tip\nf 1 2 3 4\nf 2 5 3\ng rest\nf 5 6 3\n";
        assert_eq!(text(Format::Obj, &sample()), format!("# quadmosaic V\n{points}{faces}"));
        let faces = "f 5 6 3\nf 1 2 5 3 4\n";
        assert_eq!(text(Format::Obj, &with_pentagon()), format!("# quadmosaic V\n{points}{faces}"));
    }
}
