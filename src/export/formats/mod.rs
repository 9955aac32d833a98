//! Meshes as files: one module a format.
//!
//! # Practice
//! Make a [`MeshFile`] and call [`write_mesh`]. [`Format`] says what each format holds. In every format faces are in the order of
//! [`ordered`]: by region, and within a region quads before triangles before larger faces. Regions become groups with names.
//! The same mesh gives the same bytes.
//!
//! Text formats have the shortest decimals that read back as the same f64, binary ones have f64, but for these:
//! STL (binary) and glTF have f32 by definition; INP has 20 and BDF 16 characters a number, and the nearest number that fits.
//!
//! # Changes versus crates
//! `vtkio` 0.6.3 (2021) holds a copy of each array and is followed by release candidates alone; `gltf-json` 1.4 takes more lines
//! than the JSON itself. No crate writes the other formats with f64, names and quads. So each format is written here. There is no CGNS,
//! as no crate has it.

mod bdf;
mod format;
mod glb;
mod inp;
mod mesh_file;
mod msh;
mod msh22;
mod names;
mod numbers;
mod obj;
mod off;
mod ply;
mod stl;
mod su2;
mod triangles;
mod vtk;
mod vtu;

#[cfg(test)]
mod sample;

pub use format::{Format, UnknownFormat};
pub use mesh_file::{MeshFile, ordered};

use super::{WriteError, atomic};
use std::io::{self, Write};
use std::path::Path;

/// Writes a mesh to a file in a format.
///
/// # Errors
/// [`WriteError`] names the file and the reason; no half written file is left.
pub fn write_mesh(path: &Path, format: Format, mesh: &MeshFile) -> Result<(), WriteError> {
    expect_faces(format, mesh)?;
    atomic(path, |writer| records(writer, format, mesh))
}

/// Writes a mesh to a stream in a format.
///
/// # Errors
/// Where the format does not hold the mesh's faces, or the stream takes no more bytes.
pub fn write_mesh_to(writer: &mut dyn Write, format: Format, mesh: &MeshFile) -> Result<(), WriteError> {
    expect_faces(format, mesh)?;
    records(writer, format, mesh).map_err(WriteError::Stream)
}

/// Refuses faces of more than four corners where the format has only triangles and quads.
fn expect_faces(format: Format, mesh: &MeshFile) -> Result<(), WriteError> {
    match mesh.mesh().faces().filter(|face| face.len() > 4).count() {
        count if count > 0 && !format.takes_polygons() => Err(WriteError::Polygons { format, count }),
        _ => Ok(()),
    }
}

fn records(writer: &mut dyn Write, format: Format, mesh: &MeshFile) -> io::Result<()> {
    match format {
        Format::Obj => obj::write(writer, mesh),
        Format::Ply => ply::write(writer, mesh),
        Format::Stl => stl::write(writer, mesh),
        Format::Off => off::write(writer, mesh),
        Format::Vtk => vtk::write(writer, mesh),
        Format::Vtu => vtu::write(writer, mesh),
        Format::Msh => msh::write(writer, mesh),
        Format::Msh22 => msh22::write(writer, mesh),
        Format::Su2 => su2::write(writer, mesh),
        Format::Inp => inp::write(writer, mesh),
        Format::Bdf => bdf::write(writer, mesh),
        Format::Glb => glb::write(writer, mesh),
    }
}

#[cfg(test)]
mod tests {
    use super::sample::{bytes, sample, with_pentagon};
    use super::*;

    #[test]
    fn the_same_mesh_gives_the_same_bytes() {
        for format in Format::all() {
            assert_eq!(bytes(format, &sample()), bytes(format, &sample()), "{format}");
        }
    }

    #[test]
    fn larger_faces_are_written_or_refused() {
        for format in Format::all() {
            let mut written = Vec::new();
            match write_mesh_to(&mut written, format, &with_pentagon()) {
                Ok(()) => assert!(format.takes_polygons() && !written.is_empty(), "{format}"),
                Err(error) => {
                    let said = error.to_string();
                    assert!(!format.takes_polygons() && written.is_empty(), "{said}");
                    assert!(said.contains("the mesh has 1;") && said.contains("--holes patterns"), "{said}");
                }
            }
        }
    }
}
