//! Writes meshes, fields and tiles to files, each format in its own module. A file appears complete or not at all.

mod field_ply;
mod field_vtk;
mod formats;
mod shaded_ply;
mod tiles;

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

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

/// Writes a file by `content`, under another name in the same folder until it is complete. A link is followed; a device
/// or pipe, which cannot be replaced, is written directly.
///
/// # Errors
/// [`WriteError`]; then nothing is left behind.
pub fn atomic(path: &Path, content: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), WriteError> {
    let failed = |source: io::Error| WriteError::System { path: path.to_owned(), source };
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let Some(name) = target.file_name().filter(|_| !target.is_dir()) else {
        return Err(WriteError::NotAFile { path: path.to_owned() });
    };
    if target.exists() && !target.is_file() {
        return File::options().write(true).open(&target).and_then(|file| fill(file, content)).map_err(failed);
    }
    let folder = target.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
    if !folder.is_dir() {
        return Err(WriteError::NoFolder { path: path.to_owned() });
    }
    let draft = folder.join(draft_name(&name.to_string_lossy()));
    let file = File::create_new(&draft).map_err(failed)?;
    fill(file, content).and_then(|()| fs::rename(&draft, &target)).map_err(|source| {
        // The first error is the one to report.
        let _ = fs::remove_file(&draft);
        failed(source)
    })
}

/// A name that no other writer uses, hidden from plain listings.
fn draft_name(name: &str) -> String {
    static DRAFTS: AtomicU64 = AtomicU64::new(0);
    format!(".{name}.{}-{}.part", std::process::id(), DRAFTS.fetch_add(1, Ordering::Relaxed))
}

fn fill(file: File, content: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let mut writer = BufWriter::new(file);
    content(&mut writer)?;
    writer.flush()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).expect("the folder is there");
        entries.map(|entry| entry.expect("it can be listed").file_name().to_string_lossy().into_owned()).collect()
    }

    #[test]
    fn a_file_is_replaced_as_a_whole_or_not_at_all() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("out.obj");
        atomic(&path, |writer| writer.write_all(b"old")).expect("it can be written");
        let error = atomic(&path, |writer| {
            writer.write_all(&[b'x'; 100_000])?;
            Err(io::Error::other("no more"))
        });
        assert!(error.unwrap_err().to_string().contains("out.obj cannot be written (no more)"));
        assert_eq!(fs::read(&path).expect("still there"), b"old");
        assert_eq!(names(folder.path()), ["out.obj"]);
        atomic(&path, |writer| writer.write_all(b"new")).expect("it can be written");
        assert_eq!(fs::read(&path).expect("still there"), b"new");
        assert_eq!(names(folder.path()), ["out.obj"]);
    }

    #[test]
    fn impossible_paths_are_refused() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let nothing = |_: &mut dyn Write| Ok(());
        assert!(matches!(atomic(folder.path(), nothing), Err(WriteError::NotAFile { .. })));
        assert!(matches!(atomic(Path::new(""), nothing), Err(WriteError::NotAFile { .. })));
        let lost = folder.path().join("none").join("out.obj");
        assert!(matches!(atomic(&lost, nothing), Err(WriteError::NoFolder { .. })));
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let [file, link] = ["file.obj", "link.obj"].map(|name| folder.path().join(name));
        fs::write(&file, "old").expect("it can be written");
        std::os::unix::fs::symlink(&file, &link).expect("it can be linked");
        atomic(&link, |writer| writer.write_all(b"new")).expect("it can be written");
        assert_eq!(fs::read(&file).expect("still there"), b"new");
        assert!(link.is_symlink());
    }
}
