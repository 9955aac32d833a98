//! Writes meshes, fields and tiles to files, each format in its own module. A file appears complete or not at all.

mod atomic;
mod field_ply;
mod field_vtk;
mod formats;
mod shaded_ply;
mod tiles;

use std::io;
use std::path::PathBuf;

pub use atomic::{atomic, discard_drafts, expect_room};
pub use field_ply::write_field_ply;
pub use field_vtk::write_field_vtk;
pub use formats::{Format, MeshFile, UnknownFormat, ordered, write_mesh, write_mesh_to};
pub use shaded_ply::{Shade, write_mesh_ply};
pub use tiles::tile_mesh;

/// Why a file was not written. What was there before is unchanged.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The path is a directory's, or names nothing.
    #[error("{} is no file's path; name a file in a folder", .path.display())]
    NotAFile {
        /// The path that was given.
        path: PathBuf,
    },
    /// The folder the file should go to does not exist.
    #[error("{} cannot be written: its folder does not exist; create the folder or choose another", .path.display())]
    NoFolder {
        /// The path that was given.
        path: PathBuf,
    },
    /// The operating system refused.
    #[error("{} cannot be written ({source}); check the folder's permissions and the space on the disk", .path.display())]
    System {
        /// The path that was given.
        path: PathBuf,
        /// What the operating system said.
        source: io::Error,
    },
    /// A stream took no more bytes.
    #[error("the mesh cannot be written to the stream: {0}")]
    Stream(#[source] io::Error),
    /// The format has only triangles and quads.
    #[error(
        "{format} has no faces of more than four corners, and the mesh has {count}; fill them (--holes patterns), or write {}",
        with_polygons()
    )]
    Polygons {
        /// The format.
        format: Format,
        /// The number of such faces.
        count: usize,
    },
}

/// The formats that take faces of any size.
fn with_polygons() -> String {
    Format::all().filter(|format| format.takes_polygons()).map(Format::name).collect::<Vec<_>>().join(", ")
}
