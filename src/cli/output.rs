//! Output: files and the standard output.

use anyhow::{Context, bail};
use quadmosaic::export::{atomic, expect_room};
use serde::Serialize;
use std::convert::Infallible;
use std::fmt;
use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// Where a result goes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Output {
    File(PathBuf),
    Standard,
}

impl Output {
    /// The path, where it is a file.
    pub fn path(&self) -> Option<&Path> {
        match self {
            Self::File(path) => Some(path),
            Self::Standard => None,
        }
    }
}

impl FromStr for Output {
    type Err = Infallible;

    /// `-` or `/dev/stdout`, or a path.
    fn from_str(text: &str) -> Result<Self, Infallible> {
        Ok(if ["-", "/dev/stdout"].contains(&text) { Self::Standard } else { Self::File(text.into()) })
    }
}

impl fmt::Display for Output {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(path) => write!(f, "{}", path.display()),
            Self::Standard => write!(f, "standard output"),
        }
    }
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

/// A path that ends in `.html`.
pub fn page_path(text: &str) -> Result<PathBuf, String> {
    ends_in(text, &["html", "htm"], "it does not end in .html, the format of pages")
}

fn ends_in(text: &str, endings: &[&str], refusal: &str) -> Result<PathBuf, String> {
    let path = file_path(text)?;
    let known = path.extension().is_some_and(|ending| endings.iter().any(|known| ending.eq_ignore_ascii_case(known)));
    if known { Ok(path) } else { Err(refusal.to_owned()) }
}

/// A path; `-` is refused.
pub fn file_path(text: &str) -> Result<PathBuf, String> {
    match text {
        "-" => Err("this result goes to a file, not to standard output; name a file".to_owned()),
        _ => Ok(text.into()),
    }
}

/// Writes figures as JSON.
///
/// # Errors
/// Where the file cannot be written.
pub fn write_json(output: &Output, figures: &impl Serialize) -> anyhow::Result<()> {
    let content = |writer: &mut dyn Write| {
        serde_json::to_writer_pretty(&mut *writer, figures)?;
        writeln!(writer)
    };
    match output {
        Output::File(path) => Ok(atomic(path, content)?),
        Output::Standard => to_stdout(content),
    }
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
    if fs::metadata(path).is_err_and(|error| error.kind() == io::ErrorKind::InvalidFilename) {
        bail!("{shown} cannot be written: the name is too long; choose a shorter one");
    }
    let target = absolute(path).ok();
    let (target, folder) = target
        .as_deref()
        .and_then(|target| Some((target, target.parent().filter(|folder| folder.is_dir())?)))
        .with_context(|| format!("{shown} cannot be written: there is no such folder; create it or choose another"))?;
    if let Some(other) = taken.iter().find(|other| absolute(other).is_ok_and(|other| other == target)) {
        bail!("{shown} cannot be written: it is the same file as {}; choose another name", other.display());
    }
    // A device has no folder to test.
    if target.exists() && !target.is_file() {
        return Ok(());
    }
    expect_room(folder).with_context(|| format!("{shown} cannot be written, its folder takes no new file"))
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
    to_stdout(|writer| writer.write_all(text.as_bytes()))
}

/// Prints warnings to stderr.
pub fn warn(warnings: impl IntoIterator<Item = String>) {
    warnings.into_iter().for_each(|warning| eprintln!("warning: {warning}"));
}

/// Prints to stdout, or to stderr where one of the results goes to stdout.
///
/// # Errors
/// As [`print`].
pub fn print_beside<'a>(results: impl IntoIterator<Item = &'a Output>, text: &str) -> anyhow::Result<()> {
    if results.into_iter().any(|result| *result == Output::Standard) {
        eprint!("{text}");
        return Ok(());
    }
    print(text)
}

/// Writes to stdout as [`print`] does.
fn to_stdout(content: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> anyhow::Result<()> {
    let mut writer = BufWriter::new(io::stdout().lock());
    match content(&mut writer).and_then(|()| writer.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(error).context("stdout cannot be written"),
        _ => Ok(()),
    }
}
