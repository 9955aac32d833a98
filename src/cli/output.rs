//! Where files go, and what is printed.

use anyhow::{Context, bail};
use quadmosaic::export::atomic;
use serde::Serialize;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// A path that ends in `.obj`, the one format that is written.
pub fn obj_path(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    match path.extension() {
        Some(ending) if ending.eq_ignore_ascii_case("obj") => Ok(path),
        _ => Err("it does not end in .obj; Wavefront OBJ is the one format that is written".to_owned()),
    }
}

/// A path that ends in `.vtk` or `.ply`.
pub fn field_path(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    match path.extension() {
        Some(ending) if ["vtk", "ply"].iter().any(|known| ending.eq_ignore_ascii_case(known)) => Ok(path),
        _ => Err("it does not end in .vtk or .ply, the formats that a field is written in".to_owned()),
    }
}

/// A path that ends in `.obj` or `.ply`.
pub fn tiles_path(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    match path.extension() {
        Some(ending) if ["obj", "ply"].iter().any(|known| ending.eq_ignore_ascii_case(known)) => Ok(path),
        _ => Err("it does not end in .obj or .ply, the formats that tiles are written in".to_owned()),
    }
}

/// A path that ends in `.png` or `.svg`.
pub fn picture_path(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    match path.extension() {
        Some(ending) if ["png", "svg"].iter().any(|known| ending.eq_ignore_ascii_case(known)) => Ok(path),
        _ => Err("it does not end in .png or .svg, the formats of pictures".to_owned()),
    }
}

/// Writes figures as JSON.
///
/// # Errors
/// Where the file cannot be written.
pub fn write_json(path: &Path, figures: &impl Serialize) -> anyhow::Result<()> {
    atomic(path, |writer| {
        serde_json::to_writer_pretty(&mut *writer, figures)?;
        writeln!(writer)
    })?;
    Ok(())
}

/// Makes sure, before long work, that a file can be written there, and that it is none of the files that are `taken`.
///
/// # Errors
/// Where it cannot; the folder is left as it was.
pub fn expect_writable(path: &Path, taken: &[&Path]) -> anyhow::Result<()> {
    let shown = path.display();
    if path.is_dir() {
        bail!("{shown} cannot be written: it is a folder; name a file in it");
    }
    let target = absolute(path).ok().filter(|target| target.parent().is_some_and(Path::is_dir));
    let target = target
        .with_context(|| format!("{shown} cannot be written: there is no such folder; create it or choose another"))?;
    if let Some(other) = taken.iter().find(|other| absolute(other).is_ok_and(|other| other == target)) {
        bail!("{shown} cannot be written: it is the same file as {}; choose another name", other.display());
    }
    // A device has no folder to test.
    if target.exists() && !target.is_file() {
        return Ok(());
    }
    let probe = target.with_file_name(format!(".quadmosaic.{}.probe", std::process::id()));
    File::create_new(&probe)
        .and_then(|_| fs::remove_file(&probe))
        .with_context(|| format!("{shown} cannot be written, its folder takes no new file"))
}

/// The path without links and dots; of the file itself, only the folder needs to exist.
fn absolute(path: &Path) -> io::Result<PathBuf> {
    fs::canonicalize(path).or_else(|missing| {
        let name = path.file_name().ok_or(missing)?;
        let folder = path.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
        Ok(fs::canonicalize(folder)?.join(name))
    })
}

/// Prints to stdout. Whoever closes the pipe early (`| head`) has read enough.
///
/// # Errors
/// Where stdout cannot be written for another reason.
pub fn print(text: &str) -> anyhow::Result<()> {
    match io::stdout().write_all(text.as_bytes()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(error).context("stdout cannot be written"),
        _ => Ok(()),
    }
}
