//! What is meshed: a file, or an example surface by name.

use quadmosaic::surface::Soup;
use quadmosaic::surface::examples::Example;
use quadmosaic::surface::load::{self, LoadError};
use std::fmt;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// How many triangles an example can be asked for.
pub const TRIANGLES: RangeInclusive<usize> = 1..=20_000_000;

/// Where the surface comes from.
#[derive(Clone, Debug)]
pub enum Input {
    File(PathBuf),
    Example { name: String, example: Example, triangles: usize },
}

impl Input {
    /// The triangles.
    ///
    /// # Errors
    /// [`LoadError`] names the file.
    pub fn read(&self) -> Result<Soup, LoadError> {
        match self {
            Self::File(path) => load::read(path),
            Self::Example { example, triangles, .. } => Ok(example.generate(*triangles)),
        }
    }

    /// The path, where it is a file.
    pub fn path(&self) -> Option<&Path> {
        match self {
            Self::File(path) => Some(path),
            Self::Example { .. } => None,
        }
    }
}

impl fmt::Display for Input {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(path) => write!(f, "{}", path.display()),
            Self::Example { name, .. } => write!(f, "{name}"),
        }
    }
}

impl FromStr for Input {
    type Err = String;

    /// `example:NAME`, `example:NAME:TRIANGLES`, or a path.
    fn from_str(text: &str) -> Result<Self, String> {
        let Some(wanted) = text.strip_prefix("example:") else { return Ok(Self::File(text.into())) };
        let (name, triangles) = match wanted.split_once(':') {
            Some((name, count)) => (name, self::triangles(count)?),
            None => (wanted, Example::DEFAULT_TRIANGLES),
        };
        let example = name.parse().map_err(|error| format!("{error}"))?;
        Ok(Self::Example { name: text.to_owned(), example, triangles })
    }
}

/// A number of triangles that an example can be asked for.
pub fn triangles(text: &str) -> Result<usize, String> {
    let (least, most) = TRIANGLES.into_inner();
    text.parse().ok().filter(|count| TRIANGLES.contains(count)).ok_or(format!("ask for {least} to {most} triangles"))
}
