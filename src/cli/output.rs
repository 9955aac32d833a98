//! Where files go, and what is printed.

use anyhow::{Context, bail};
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

/// Makes sure, before long work, that a file can be written there, and that it is none of the files that are `taken`.
///
/// # Errors
/// Where it cannot; the folder is left as it was.
pub fn expect_writable(path: &Path, taken: &[&Path]) -> anyhow::Result<()> {
    let shown = path.display();
    let same = |other: &Path| {
        path == other
            || fs::canonicalize(path).ok().is_some_and(|full| fs::canonicalize(other).is_ok_and(|other| full == other))
    };
    if let Some(other) = taken.iter().find(|other| same(other)) {
        bail!("{shown} cannot be written: it is the same file as {}; choose another name", other.display());
    }
    if path.is_dir() {
        bail!("{shown} cannot be written: it is a folder; name a file in it");
    }
    // A link is followed, and a device has no folder to test.
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    if target.exists() && !target.is_file() {
        return Ok(());
    }
    let folder = target.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
    if !folder.is_dir() {
        bail!("{shown} cannot be written: its folder does not exist; create the folder or choose another");
    }
    let probe = folder.join(format!(".quadmosaic.{}.probe", std::process::id()));
    File::create_new(&probe)
        .and_then(|_| fs::remove_file(&probe))
        .with_context(|| format!("{shown} cannot be written, its folder takes no new file"))
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
