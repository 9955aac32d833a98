//! Fields as legacy VTK files, for ParaView.

use std::io::{self, Write};
use std::path::Path;

use super::{WriteError, atomic};
use crate::field::{Field, SingularityLocation};
use crate::geometry::cross;
use crate::surface::Surface;
use crate::surface::curvature::vertex_normals;
use glam::Vec3;

/// What a cell of the file is.
#[derive(Clone, Copy)]
enum Kind {
    Triangle = 0,
    Feature = 1,
    Singularity = 2,
}

/// Writes a surface with its cross field as legacy VTK, binary: polygons are its triangles, lines its feature curves,
/// vertices its singularities.
///
/// Points are in model units, in f64, with `normals`. Cells have `kind` (0 triangle, 1 feature, 2 singularity), `index`
/// (of singularities, in full turns; else 0) and `cross_u`, `cross_v` (of triangles, at their centres: unit vectors, one
/// the other turned by 90 degrees to its left; else zero).
///
/// # Errors
/// [`WriteError`] names the file and the reason; no half written file is left.
pub fn write_field_vtk(path: &Path, surface: &Surface, field: &Field) -> Result<(), WriteError> {
    atomic(path, |writer| records(writer, surface, field))
}

fn records(writer: &mut dyn Write, surface: &Surface, field: &Field) -> io::Result<()> {
    let singularities = field.singularities(surface);
    let mut points: Vec<[f64; 3]> = surface.points.iter().map(|p| p.as_dvec3().into()).collect();
    let mut normals: Vec<Vec3> = vertex_normals(surface).iter().map(|normal| normal.as_vec3()).collect();
    let mut vertices = Vec::new();
    for singularity in &singularities {
        vertices.push(vec![match singularity.location {
            SingularityLocation::Corner(vertex) => vertex,
            SingularityLocation::Triangle(triangle) => {
                points.push(singularity.position);
                normals.push(surface.normal(triangle as usize));
                points.len() as u32 - 1
            }
        }]);
    }
    let curves = surface.features().curves();

    write!(writer, "# vtk DataFile Version 3.0\nquadmosaic {} cross field\nBINARY\n", env!("CARGO_PKG_VERSION"))?;
    writeln!(writer, "DATASET POLYDATA\nPOINTS {} double", points.len())?;
    for point in &points {
        surface.frame().to_model(*point).iter().try_for_each(|x| writer.write_all(&x.to_be_bytes()))?;
    }
    cells(writer, "VERTICES", vertices.iter().map(Vec::as_slice))?;
    cells(writer, "LINES", curves.iter().map(|curve| curve.vertices.as_slice()))?;
    cells(writer, "POLYGONS", surface.triangles.iter().map(|triangle| &triangle[..]))?;

    // ParaView numbers cells in this order, whatever the order in the file.
    let kinds = || {
        std::iter::repeat_n(Kind::Singularity, vertices.len())
            .chain(std::iter::repeat_n(Kind::Feature, curves.len()))
            .chain(std::iter::repeat_n(Kind::Triangle, surface.triangle_count()))
    };
    let others = vertices.len() + curves.len();
    writeln!(writer, "\nCELL_DATA {}\nSCALARS kind int 1\nLOOKUP_TABLE default", kinds().count())?;
    kinds().try_for_each(|kind| writer.write_all(&(kind as i32).to_be_bytes()))?;
    writeln!(writer, "\nSCALARS index float 1\nLOOKUP_TABLE default")?;
    let indices = singularities.iter().map(|singularity| singularity.index() as f32);
    let none = std::iter::repeat_n(0.0, curves.len() + surface.triangle_count());
    indices.chain(none).try_for_each(|index: f32| writer.write_all(&index.to_be_bytes()))?;
    let axes: Vec<[Vec3; 2]> = (0..surface.triangle_count()).map(|t| axes(surface, field, t)).collect();
    for (k, name) in ["cross_u", "cross_v"].into_iter().enumerate() {
        writeln!(writer, "\nVECTORS {name} float")?;
        vectors(writer, std::iter::repeat_n(Vec3::ZERO, others).chain(axes.iter().map(|axes| axes[k])))?;
    }
    writeln!(writer, "\nPOINT_DATA {}\nNORMALS normals float", points.len())?;
    vectors(writer, normals.into_iter())?;
    writeln!(writer)
}

/// A direction of the cross at a triangle's centre, and the next to its left.
fn axes(surface: &Surface, field: &Field, triangle: usize) -> [Vec3; 2] {
    let [a, b, c] = surface.corners(triangle);
    let axis = field.axis(surface, triangle as u32, (a + b + c) / 3.0);
    [axis, cross(surface.normal(triangle), axis)]
}

/// A section of cells, each a list of points; none where there are none.
fn cells<'a>(writer: &mut dyn Write, name: &str, cells: impl Iterator<Item = &'a [u32]> + Clone) -> io::Result<()> {
    let (count, size) = cells.clone().fold((0, 0), |(count, size), cell| (count + 1, size + 1 + cell.len()));
    if count == 0 {
        return Ok(());
    }
    writeln!(writer, "\n{name} {count} {size}")?;
    for cell in cells {
        let numbers = std::iter::once(cell.len() as u32).chain(cell.iter().copied());
        numbers.into_iter().try_for_each(|number| writer.write_all(&(number as i32).to_be_bytes()))?;
    }
    Ok(())
}

fn vectors(writer: &mut dyn Write, mut vectors: impl Iterator<Item = Vec3>) -> io::Result<()> {
    vectors.try_for_each(|vector| vector.to_array().iter().try_for_each(|x| writer.write_all(&x.to_be_bytes())))
}
