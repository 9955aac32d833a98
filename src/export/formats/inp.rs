//! Abaqus and CalculiX input: shell elements S4 and S3, an element set a region, sets of vertices.
//!
//! # Practice
//! The file has a mesh and no model: a material, `*SHELL SECTION` and steps come from a file that includes it. The element sets are
//! those of the regions. The node sets are `BOUNDARY`, vertices on an open boundary, and, where they are known, `FEATURE`, vertices
//! on feature curves, and `CORNER`, corners of these; an empty set is left out. A number has at most 20 characters, as CalculiX
//! reads no more.

use super::MeshFile;
use super::names::identifiers;
use super::numbers::{push, push_face, within, write_lines};
use crate::mesh::VertexKind;
use std::io::{self, Write};

/// The characters of a number.
const WIDTH: usize = 20;
/// The characters of a name.
const NAME: usize = 80;
/// The numbers in a line of a set.
const IN_A_LINE: usize = 16;

pub(super) fn write(writer: &mut dyn Write, file: &MeshFile) -> io::Result<()> {
    let mesh = file.mesh();
    writeln!(writer, "*HEADING\nquadmosaic {}\n*NODE", env!("CARGO_PKG_VERSION"))?;
    write_lines(writer, 0..mesh.points.len(), |text, v| {
        let [x, y, z] = mesh.points[v].map(|x| within(WIDTH, x));
        push(text, format_args!("{}, {x}, {y}, {z}\n", v + 1));
    })?;
    let groups = file.groups();
    for (corners, faces) in groups.iter().flat_map(|group| group.blocks()) {
        writeln!(writer, "*ELEMENT, TYPE=S{corners}")?;
        write_lines(writer, faces, |text, face| {
            push(text, format_args!("{}", face + 1));
            push_face(text, ", ", mesh.face(face), 1);
            text.push('\n');
        })?;
    }
    for (group, name) in groups.iter().zip(identifiers(groups.iter().map(|group| group.name), NAME)) {
        writeln!(writer, "*ELSET, ELSET={name}, GENERATE\n{}, {}, 1", group.faces().start + 1, group.faces().end)?;
    }
    let mut is_boundary = vec![false; mesh.points.len()];
    let boundary = mesh.edges().into_iter().filter(|edge| edge.is_boundary());
    boundary.flat_map(|edge| edge.ends).for_each(|v| is_boundary[v as usize] = true);
    let of_kind = |kinds: &[VertexKind]| -> Vec<bool> {
        file.vertices().iter().map(|vertex| kinds.contains(&vertex.kind)).collect()
    };
    write_set(writer, "BOUNDARY", &is_boundary)?;
    write_set(writer, "FEATURE", &of_kind(&[VertexKind::Feature, VertexKind::Corner]))?;
    write_set(writer, "CORNER", &of_kind(&[VertexKind::Corner]))
}

/// Writes the vertices that are marked.
fn write_set(writer: &mut dyn Write, name: &str, is_in: &[bool]) -> io::Result<()> {
    let numbers: Vec<String> =
        is_in.iter().zip(1_usize..).filter(|(is_in, _)| **is_in).map(|(_, number)| number.to_string()).collect();
    if !numbers.is_empty() {
        writeln!(writer, "*NSET, NSET={name}")?;
    }
    numbers.chunks(IN_A_LINE).try_for_each(|line| writeln!(writer, "{}", line.join(", ")))
}

#[cfg(test)]
mod tests {
    use super::super::Format;
    use super::super::sample::{sample, text};

    #[test]
    fn regions_are_element_sets_and_kinds_are_node_sets() {
        let expected = "*HEADING\nquadmosaic V\n*NODE\n1, 0.0, 0.0, 0.0\n2, 1.0, 0.0, 0.0\n3, 1.0, 1.0, 0.0\n\
                        4, 0.0, 1.0, 0.0\n5, 2.0, 0.0, 0.3333333333333333\n6, 2.0, 1.0, -1.0E-7\n\
                        *ELEMENT, TYPE=S4\n1, 1, 2, 3, 4\n*ELEMENT, TYPE=S3\n2, 2, 5, 3\n\
                        *ELEMENT, TYPE=S3\n3, 5, 6, 3\n\
                        *ELSET, ELSET=wing_tip, GENERATE\n1, 2, 1\n*ELSET, ELSET=rest, GENERATE\n3, 3, 1\n\
                        *NSET, NSET=BOUNDARY\n1, 2, 3, 4, 5, 6\n*NSET, NSET=FEATURE\n1, 3, 4, 6\n\
                        *NSET, NSET=CORNER\n1, 4\n";
        assert_eq!(text(Format::Inp, &sample()), expected);
    }
}
