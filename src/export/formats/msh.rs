//! Gmsh MSH 4.1, binary: a discrete surface and a physical group a region. All nodes are of the first surface.
//!
//! Source: the reference manual of Gmsh, section "MSH file format".

use super::MeshFile;
use super::mesh_file::Group;
use super::names::or_unnamed;
use super::numbers::write_bytes;
use crate::mesh::Mesh;
use std::io::{self, Write};

/// Gmsh's types of elements.
pub(super) const TRIANGLE: i32 = 2;
pub(super) const QUAD: i32 = 3;
/// The dimension of a surface.
pub(super) const SURFACE: i32 = 2;

pub(super) fn write(writer: &mut dyn Write, file: &MeshFile) -> io::Result<()> {
    let mesh = file.mesh();
    let groups = file.groups();
    write_head(writer, "4.1", &groups)?;
    writeln!(writer, "$Entities")?;
    write_sizes(writer, &[0, 0, groups.len(), 0])?;
    for (tag, group) in (1..).zip(&groups) {
        write_integers(writer, &[tag])?;
        write_bytes(writer, bounds(mesh, group).as_flattened().iter().map(|x| x.to_le_bytes()))?;
        // One physical group, and no bounding curve.
        write_sizes(writer, &[1])?;
        write_integers(writer, &[tag])?;
        write_sizes(writer, &[0])?;
    }
    let vertices = mesh.points.len();
    writeln!(writer, "\n$EndEntities\n$Nodes")?;
    write_sizes(writer, &[1, vertices, 1, vertices])?;
    write_integers(writer, &[SURFACE, 1, 0])?;
    write_sizes(writer, &[vertices])?;
    write_bytes(writer, (1..=vertices as u64).map(u64::to_le_bytes))?;
    write_bytes(writer, mesh.points.as_flattened().iter().map(|x| x.to_le_bytes()))?;
    writeln!(writer, "\n$EndNodes\n$Elements")?;
    let blocks = || (1..).zip(&groups).flat_map(|(tag, group)| group.blocks().map(move |block| (tag, block)));
    let elements = mesh.face_count();
    write_sizes(writer, &[blocks().count(), elements, 1, elements])?;
    for (tag, (corners, faces)) in blocks() {
        write_integers(writer, &[SURFACE, tag, if corners == 4 { QUAD } else { TRIANGLE }])?;
        write_sizes(writer, &[faces.len()])?;
        let numbers = faces.flat_map(|face| {
            let vertices = mesh.face(face).iter().map(|&v| u64::from(v) + 1);
            std::iter::once(face as u64 + 1).chain(vertices)
        });
        write_bytes(writer, numbers.map(u64::to_le_bytes))?;
    }
    writeln!(writer, "\n$EndElements")
}

/// Writes what both versions begin with: the version, and the names of the physical groups.
pub(super) fn write_head(writer: &mut dyn Write, version: &str, groups: &[Group]) -> io::Result<()> {
    writeln!(writer, "$MeshFormat\n{version} 1 8")?;
    // It tells the order of bytes.
    write_integers(writer, &[1])?;
    writeln!(writer, "\n$EndMeshFormat\n$PhysicalNames\n{}", groups.len())?;
    for (tag, group) in (1..).zip(groups) {
        writeln!(writer, "{SURFACE} {tag} \"{}\"", or_unnamed(group.name).replace('"', "'"))?;
    }
    writeln!(writer, "$EndPhysicalNames")
}

pub(super) fn write_integers(writer: &mut dyn Write, integers: &[i32]) -> io::Result<()> {
    integers.iter().try_for_each(|integer: &i32| writer.write_all(&integer.to_le_bytes()))
}

fn write_sizes(writer: &mut dyn Write, sizes: &[usize]) -> io::Result<()> {
    sizes.iter().try_for_each(|&size| writer.write_all(&(size as u64).to_le_bytes()))
}

/// The least and the largest coordinates of a group.
fn bounds(mesh: &Mesh, group: &Group) -> [[f64; 3]; 2] {
    let mut bounds = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    for &v in group.faces().flat_map(|face| mesh.face(face)) {
        for (axis, x) in mesh.points[v as usize].into_iter().enumerate() {
            bounds[0][axis] = bounds[0][axis].min(x);
            bounds[1][axis] = bounds[1][axis].max(x);
        }
    }
    bounds
}

#[cfg(test)]
mod tests {
    use super::super::Format;
    use super::super::sample::{bytes, sample};

    #[test]
    fn sections_are_as_long_as_their_counts_say() {
        let bytes = bytes(Format::Msh, &sample());
        let at = |name: &str| bytes.windows(name.len()).position(|some| some == name.as_bytes()).expect(name);
        let length = |name: &str| at(&format!("\n$End{name}")) - at(&format!("${name}\n")) - name.len() - 2;
        assert_eq!(length("MeshFormat"), "4.1 1 8\n".len() + 4);
        assert_eq!(length("Entities"), 4 * 8 + 2 * (4 + 6 * 8 + 8 + 4 + 8));
        assert_eq!(length("Nodes"), 4 * 8 + 3 * 4 + 8 + 6 * (8 + 24));
        assert_eq!(length("Elements"), 4 * 8 + 3 * (3 * 4 + 8) + 8 * (5 + 4 + 4));
        assert!(at("$PhysicalNames\n2\n2 1 \"wing tip\"\n2 2 \"rest\"\n$EndPhysicalNames\n") > 0);
    }
}
