//! STL: triangles. Binary, where numbers are f32; where regions have names, ASCII with a solid a region, as only that has names.

use super::MeshFile;
use super::numbers::{push, push_point, write_bytes, write_lines};
use super::triangles::triangles;
use glam::DVec3;
use std::io::{self, Write};

/// The length of the text before binary triangles.
const HEADER: usize = 80;

pub(super) fn write(writer: &mut dyn Write, file: &MeshFile) -> io::Result<()> {
    let mesh = file.mesh();
    let normal = |corners: [[f64; 3]; 3]| {
        let [a, b, c] = corners.map(DVec3::from);
        (b - a).cross(c - a).normalize_or_zero().to_array()
    };
    if mesh.regions.names.is_empty() {
        let triangles = triangles(mesh, 0..mesh.face_count());
        let mut header = [b' '; HEADER];
        let title = format!("quadmosaic {}", env!("CARGO_PKG_VERSION"));
        header[..title.len()].copy_from_slice(title.as_bytes());
        writer.write_all(&header)?;
        writer.write_all(&(triangles.len() as u32).to_le_bytes())?;
        return write_bytes(
            writer,
            triangles.into_iter().map(|triangle| {
                let [a, b, c] = triangle.map(|v| mesh.points[v as usize]);
                // Twelve f32, and two bytes without meaning.
                let mut record = [0; 50];
                let numbers = [normal([a, b, c]), a, b, c];
                for (bytes, x) in record.chunks_exact_mut(4).zip(numbers.as_flattened()) {
                    bytes.copy_from_slice(&(*x as f32).to_le_bytes());
                }
                record
            }),
        );
    }
    for group in file.groups() {
        let triangles = triangles(mesh, group.faces());
        writeln!(writer, "{}", format!("solid {}", group.name).trim_end())?;
        write_lines(writer, 0..triangles.len(), |text, triangle| {
            let corners = triangles[triangle].map(|v| mesh.points[v as usize]);
            // No negative zero.
            let [x, y, z] = normal(corners).map(|x| x as f32 + 0.0);
            push(text, format_args!("facet normal {x:?} {y:?} {z:?}\nouter loop\n"));
            for corner in &corners {
                text.push_str("vertex");
                push_point(text, " ", corner);
                text.push('\n');
            }
            text.push_str("endloop\nendfacet\n");
        })?;
        writeln!(writer, "{}", format!("endsolid {}", group.name).trim_end())?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::Format;
    use super::super::sample::{bytes, sample, text, with_pentagon};

    #[test]
    fn named_regions_are_solids_and_others_are_binary() {
        let text = text(Format::Stl, &sample());
        let names: Vec<&str> = text.lines().filter(|line| line.contains("solid")).collect();
        assert_eq!(names, ["solid wing tip", "endsolid wing tip", "solid rest", "endsolid rest"]);
        assert_eq!(text.matches("facet normal 0.0 0.0 1.0").count(), 2, "the quad is two triangles\n{text}");
        assert!(text.contains("vertex 2.0 0.0 0.3333333333333333\n"));
        let bytes = bytes(Format::Stl, &with_pentagon());
        assert_eq!(bytes.len(), 84 + 50 * 4);
        assert_eq!(bytes[80..84], 4_u32.to_le_bytes());
        assert!(!bytes.starts_with(b"solid"));
    }
}
