//! Wavefront OBJ: quads as quads, larger faces as polygons, regions as groups; colours behind the places of vertices, and texture
//! coordinates.

use super::MeshFile;
use super::numbers::{push, push_face, push_point, write_lines};
use crate::surface::AttributeKind;
use std::io::{self, Write};

pub(super) fn write(writer: &mut dyn Write, file: &MeshFile) -> io::Result<()> {
    let mesh = file.mesh();
    let colour = file.attribute(AttributeKind::Colour);
    let texture = file.attribute(AttributeKind::Texture);
    writeln!(writer, "# quadmosaic {}", env!("CARGO_PKG_VERSION"))?;
    write_lines(writer, 0..mesh.points.len(), |text, v| {
        text.push('v');
        push_point(text, " ", &mesh.points[v]);
        if let Some(colour) = colour {
            push_point(text, " ", colour.tuple(v as u32));
        }
        text.push('\n');
    })?;
    if let Some(texture) = texture {
        write_lines(writer, 0..texture.values.len() / texture.components, |text, number| {
            text.push_str("vt");
            push_point(text, " ", texture.tuple(number as u32));
            text.push('\n');
        })?;
    }
    // Where each face begins among all corners.
    let starts: Vec<usize> = match texture {
        Some(_) => mesh.faces().scan(0, |end, face| Some(std::mem::replace(end, *end + face.len()))).collect(),
        None => Vec::new(),
    };
    for group in file.groups() {
        if !mesh.regions.names.is_empty() {
            writeln!(writer, "{}", format!("g {}", group.name).trim_end())?;
        }
        write_lines(writer, group.faces(), |text, face| {
            text.push('f');
            match texture {
                None => push_face(text, " ", mesh.face(face), 1),
                Some(texture) => {
                    for (&vertex, corner) in mesh.face(face).iter().zip(starts[face]..) {
                        let number = texture.of_corners.get(corner).copied().unwrap_or(vertex);
                        push(text, format_args!(" {}/{}", vertex + 1, number + 1));
                    }
                }
            }
            text.push('\n');
        })?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::Format;
    use super::super::sample::{plain, sample, text, with_pentagon};

    #[test]
    fn regions_are_groups_and_quads_come_first() {
        let points = "v 0.0 0.0 0.0\nv 1.0 0.0 0.0\nv 1.0 1.0 0.0\nv 0.0 1.0 0.0\nv 2.0 0.0 0.3333333333333333\nv 2.0 1.0 -1e-7\n";
        let faces = "g wing tip\nf 1 2 3 4\nf 2 5 3\ng rest\nf 5 6 3\n";
        assert_eq!(text(Format::Obj, &plain()), format!("# quadmosaic V\n{points}{faces}"));
        let faces = "f 5 6 3\nf 1 2 5 3 4\n";
        assert_eq!(text(Format::Obj, &with_pentagon()), format!("# quadmosaic V\n{points}{faces}"));
    }

    #[test]
    fn corners_at_a_seam_have_texture_coordinates_of_their_own() {
        let text = text(Format::Obj, &sample());
        assert!(
            text.contains("v 0.0 0.0 0.0 1.0 0.0 0.0\n") && text.contains("v 2.0 1.0 -1e-7 0.0 0.0 1.0\n"),
            "{text}"
        );
        // Two of the six vertices lie on the seam.
        assert_eq!(text.matches("\nvt ").count(), 8, "{text}");
        assert!(text.contains("f 1/1 2/2 3/3 4/4\n") || text.contains("f 1/1 2/2 3/8 4/4\n"), "{text}");
    }
}
