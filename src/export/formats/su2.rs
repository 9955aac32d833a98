//! SU2: the elements of a surface in three dimensions, a marker a region. There are no volume elements, and so no `NELEM`.

use super::MeshFile;
use super::names::identifiers;
use super::numbers::{push, push_face, write_lines};
use std::io::{self, Write};

/// The types of elements, those of VTK.
const TRIANGLE: u32 = 5;
const QUAD: u32 = 9;

pub(super) fn write(writer: &mut dyn Write, file: &MeshFile) -> io::Result<()> {
    let mesh = file.mesh();
    writeln!(writer, "% quadmosaic {}\nNDIME= 3\nNPOIN= {}", env!("CARGO_PKG_VERSION"), mesh.points.len())?;
    write_lines(writer, 0..mesh.points.len(), |text, v| {
        let [x, y, z] = mesh.points[v];
        push(text, format_args!("{x:?} {y:?} {z:?} {v}\n"));
    })?;
    let groups = file.groups();
    writeln!(writer, "NMARK= {}", groups.len())?;
    for (group, name) in groups.iter().zip(identifiers(groups.iter().map(|group| group.name), usize::MAX)) {
        writeln!(writer, "MARKER_TAG= {name}\nMARKER_ELEMS= {}", group.faces().len())?;
        write_lines(writer, group.faces(), |text, face| {
            let face = mesh.face(face);
            push(text, format_args!("{}", if face.len() == 4 { QUAD } else { TRIANGLE }));
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
    fn regions_are_markers() {
        let text = text(Format::Su2, &sample());
        assert!(text.starts_with("% quadmosaic V\nNDIME= 3\nNPOIN= 6\n0.0 0.0 0.0 0\n"), "{text}");
        let markers = "2.0 1.0 -1e-7 5\nNMARK= 2\nMARKER_TAG= wing_tip\nMARKER_ELEMS= 2\n9 0 1 2 3\n5 1 4 2\n\
                       MARKER_TAG= rest\nMARKER_ELEMS= 1\n5 4 5 2\n";
        assert!(text.ends_with(markers), "{text}");
    }
}
