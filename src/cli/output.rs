//! Output: files and the standard output.

use anyhow::{Context, bail};
use quadmosaic::export::atomic;
use serde::Serialize;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// A path that ends in `.obj`, the one format that is written.
pub fn obj_path(text: &str) -> Result<PathBuf, String> {
    ends_in(text, &["obj"], "it does not end in .obj; Wavefront OBJ is the one format that is written")
}

/// A path that ends in `.vtk` or `.ply`.
pub fn field_path(text: &str) -> Result<PathBuf, String> {
    ends_in(text, &["vtk", "ply"], "it does not end in .vtk or .ply, the formats that a field is written in")
}

/// A path that ends in `.obj` or `.ply`.
pub fn tiles_path(text: &str) -> Result<PathBuf, String> {
    ends_in(text, &["obj", "ply"], "it does not end in .obj or .ply, the formats that tiles are written in")
}

/// A path that ends in `.png` or `.svg`.
pub fn picture_path(text: &str) -> Result<PathBuf, String> {
    ends_in(text, &["png", "svg"], "it does not end in .png or .svg, the formats of pictures")
}

fn ends_in(text: &str, endings: &[&str], refusal: &str) -> Result<PathBuf, String> {
    let path = file_path(text)?;
    let known = path.extension().is_some_and(|ending| endings.iter().any(|known| ending.eq_ignore_ascii_case(known)));
    if known { Ok(path) } else { Err(refusal.to_owned()) }
}

/// A path; `-` is refused, as it means standard output in other programs.
pub fn file_path(text: &str) -> Result<PathBuf, String> {
    match text {
        "-" => Err("results go to files, not to standard output; name a file".to_owned()),
        _ => Ok(text.into()),
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

/// Checks, before long work, that a file can be written at a path, and that it is none of the `taken` files.
///
/// # Errors
/// Where it cannot; the folder stays as it is.
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

/// The path without links and dots. The folder must exist, the file need not.
fn absolute(path: &Path) -> io::Result<PathBuf> {
    fs::canonicalize(path).or_else(|missing| {
        let name = path.file_name().ok_or(missing)?;
        let folder = path.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
        Ok(fs::canonicalize(folder)?.join(name))
    })
}

/// Prints to stdout. A pipe that is closed early (`| head`) is no error.
///
/// # Errors
/// Where stdout cannot be written for another reason.
pub fn print(text: &str) -> anyhow::Result<()> {
    match io::stdout().write_all(text.as_bytes()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(error).context("stdout cannot be written"),
        _ => Ok(()),
    }
}
