//! The input: a file, standard input, or an example surface by name.

use clap::{Args, CommandFactory, error::ErrorKind};
use quadmosaic::mesh::{Mesh, read_mesh_as};
use quadmosaic::surface::Soup;
use quadmosaic::surface::examples::Example;
use quadmosaic::surface::load::{self, Format};
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// The arguments that name a surface.
#[derive(Args)]
pub struct Source {
    /// The surface: a file, - for standard input, or an example (example:m6)
    ///
    /// An OBJ, STL, PLY, OFF, MSH, VTK, VTU or VTP file, perhaps in gzip, told apart by content; or example:NAME or
    /// example:NAME:TRIANGLES, NAME one of m6, torus, sphere, plate, block, flange
    #[arg(value_name = "IN")]
    input: Input,
    /// The format of IN, where its content leaves it open
    ///
    /// obj, stl, ply, off, msh, vtk, vtu or vtp
    #[arg(long, value_name = "FORMAT", help_heading = "Input")]
    format: Option<Format>,
}

impl Source {
    /// The triangles.
    ///
    /// # Errors
    /// Where they cannot be read; the message names the file.
    pub fn read(&self) -> anyhow::Result<Soup> {
        self.input.read(self.format)
    }

    /// The faces of a mesh; of standard input and examples, the triangles.
    ///
    /// # Errors
    /// As [`Source::read`].
    pub fn read_mesh(&self) -> anyhow::Result<Mesh> {
        match &self.input {
            Input::File(path) => Ok(read_mesh_as(path, self.format)?),
            _ => Ok(self.read()?.into()),
        }
    }

    /// The path, where it is a file.
    pub fn path(&self) -> Option<&Path> {
        match &self.input {
            Input::File(path) => Some(path),
            _ => None,
        }
    }
}

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.input.fmt(f)
    }
}

/// The source of a surface.
#[derive(Clone, Debug)]
pub enum Input {
    File(PathBuf),
    Standard,
    Example { name: String, example: Example, triangles: usize },
}

impl Input {
    /// The triangles; `format` is that of a file whose content leaves it open.
    ///
    /// # Errors
    /// Where they cannot be read; the message names the file.
    pub fn read(&self, format: Option<Format>) -> anyhow::Result<Soup> {
        Ok(match self {
            Self::File(path) => load::read_as(path, format)?,
            Self::Standard => load::read_stream(io::stdin().lock(), &self.to_string(), format)?,
            Self::Example { .. } if format.is_some() => {
                let message = "--format goes with a file or standard input only";
                return Err(super::Arguments::command().error(ErrorKind::ArgumentConflict, message).into());
            }
            Self::Example { example, triangles, .. } => example.generate(*triangles),
        })
    }

    /// A beginning for the names of files about it.
    pub fn stem(&self) -> String {
        let name = match self {
            Self::File(path) => path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
            Self::Standard => "surface".to_owned(),
            Self::Example { name, .. } => name.trim_start_matches("example:").to_owned(),
        };
        name.chars().map(|c| if c.is_ascii_alphanumeric() || "-_.".contains(c) { c } else { '_' }).collect()
    }
}

impl fmt::Display for Input {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(path) => write!(f, "{}", path.display()),
            Self::Standard => write!(f, "standard input"),
            Self::Example { name, .. } => write!(f, "{name}"),
        }
    }
}

impl FromStr for Input {
    type Err = String;

    /// `-`, `example:NAME`, `example:NAME:TRIANGLES`, or a path.
    fn from_str(text: &str) -> Result<Self, String> {
        if text == "-" {
            return Ok(Self::Standard);
        }
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
    let (least, most) = Example::TRIANGLES.into_inner();
    text.parse()
        .ok()
        .filter(|count| Example::TRIANGLES.contains(count))
        .ok_or(format!("ask for {least} to {most} triangles"))
}
