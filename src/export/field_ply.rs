//! Fields as PLY files.

use std::io::{self, Write};
use std::path::Path;

use super::{WriteError, atomic};
use crate::field::{Field, SingularityLocation};
use crate::surface::Surface;
use crate::surface::curvature::vertex_normals;
use glam::{DVec3, Vec3};

/// Writes a surface with its cross field as PLY, binary, little-endian.
///
/// Vertices: `x y z` in model units, in f64; `nx ny nz`, the normal; `ux uy uz` and `vx vy vz`, two directions of the cross,
/// `v` to the left of `u` (on a feature, those of one of its sides); `index`, that of a corner of features, in full turns,
/// else 0. Faces: their vertices, and the `index` of the singularity in them. Edges: the features.
///
/// # Errors
/// [`WriteError`] names the file and the reason; no half written file is left.
pub fn write_field_ply(path: &Path, surface: &Surface, field: &Field) -> Result<(), WriteError> {
    atomic(path, |writer| records(writer, surface, field))
}

const VERTEX: &str = "\
property double x
property double y
property double z
property float nx
property float ny
property float nz
property float ux
property float uy
property float uz
property float vx
property float vy
property float vz
property float index
";

fn records(writer: &mut dyn Write, surface: &Surface, field: &Field) -> io::Result<()> {
    let mut at_vertices = vec![0.0f32; surface.vertex_count()];
    let mut in_faces = vec![0.0f32; surface.triangle_count()];
    for singularity in field.singularities(surface) {
        let place = match singularity.location {
            SingularityLocation::Corner(vertex) => &mut at_vertices[vertex as usize],
            SingularityLocation::Triangle(triangle) => &mut in_faces[triangle as usize],
        };
        *place = singularity.index() as f32;
    }
    let edges: Vec<[u32; 2]> = surface
        .features()
        .curves()
        .iter()
        .flat_map(|curve| curve.vertices.windows(2).map(|pair| [pair[0], pair[1]]))
        .collect();

    writeln!(
        writer,
        "ply\nformat binary_little_endian 1.0\ncomment quadmosaic {} cross field",
        env!("CARGO_PKG_VERSION")
    )?;
    write!(writer, "element vertex {}\n{VERTEX}", surface.vertex_count())?;
    writeln!(writer, "element face {}", surface.triangle_count())?;
    write!(writer, "property list uchar int vertex_indices\nproperty float index\n")?;
    writeln!(writer, "element edge {}\nproperty int vertex1\nproperty int vertex2\nend_header", edges.len())?;
    for (vertex, &normal) in vertex_normals(surface).iter().enumerate() {
        let place = surface.frame().to_model(surface.points[vertex].as_dvec3().into());
        place.iter().try_for_each(|x| writer.write_all(&x.to_le_bytes()))?;
        let axis = axis(surface, field, vertex as u32, normal);
        let numbers = [normal, axis, normal.cross(axis)].map(|vector| vector.as_vec3().to_array());
        let numbers = numbers.as_flattened().iter().chain([&at_vertices[vertex]]);
        numbers.into_iter().try_for_each(|x| writer.write_all(&x.to_le_bytes()))?;
    }
    for (triangle, index) in surface.triangles.iter().zip(in_faces) {
        writer.write_all(&[3])?;
        triangle.iter().try_for_each(|&v| writer.write_all(&(v as i32).to_le_bytes()))?;
        writer.write_all(&index.to_le_bytes())?;
    }
    edges.as_flattened().iter().try_for_each(|&v| writer.write_all(&(v as i32).to_le_bytes()))
}

/// A direction of the cross at a vertex, laid across its normal; zero where there is none.
fn axis(surface: &Surface, field: &Field, vertex: u32, normal: DVec3) -> DVec3 {
    let Some(&sector) = field.sectors().of_vertex(vertex).first() else { return DVec3::ZERO };
    let triangle = field.sectors().first_corner[sector as usize] / 3;
    let place: Vec3 = surface.points[vertex as usize];
    field.axis(surface, triangle, place).as_dvec3().reject_from(normal).normalize_or_zero()
}
