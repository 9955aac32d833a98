//! The arguments that say where a mesh goes, and in which format.

use super::output::Output;
use clap::{Args, CommandFactory, error::ErrorKind};
use quadmosaic::export::{Format, MeshFile, WriteError, write_mesh, write_mesh_to};
use std::io::{self, BufWriter, Write};
use std::path::Path;

#[derive(Args)]
pub struct MeshOutput {
    /// The file of the mesh, whose extension tells the format
    ///
    /// It is written whole or not at all. -: standard output, with --to
    #[arg(short, long, value_name = "OUT", help_heading = "Output")]
    pub output: Output,
    /// The format, whatever the extension
    ///
    /// obj, ply, stl, off, vtk, vtu, msh (4.1), msh22, su2, inp, bdf or glb
    #[arg(long, value_name = "FORMAT", help_heading = "Output")]
    to: Option<Format>,
}

impl MeshOutput {
    /// The format.
    ///
    /// # Errors
    /// Wrong usage, where neither `--to` nor the extension tells it.
    pub fn format(&self) -> anyhow::Result<Format> {
        match (self.to, &self.output) {
            (Some(format), _) => Ok(format),
            (None, Output::File(path)) => format_of(path),
            (None, Output::Standard) => {
                Err(usage(&format!("name the format of standard output: --to {}", Format::list().replace(", ", "|"))))
            }
        }
    }

    /// The path, where it is a file.
    pub fn path(&self) -> Option<&Path> {
        self.output.path()
    }

    /// Writes a mesh.
    ///
    /// # Errors
    /// Where the format does not hold the mesh, or it cannot be written.
    pub fn write(&self, mesh: &MeshFile) -> anyhow::Result<()> {
        let format = self.format()?;
        match &self.output {
            Output::File(path) => Ok(write_mesh(path, format, mesh)?),
            Output::Standard => {
                let mut writer = BufWriter::new(io::stdout().lock());
                let written = write_mesh_to(&mut writer, format, mesh);
                match written.and_then(|()| writer.flush().map_err(WriteError::Stream)) {
                    // As with what is printed.
                    Err(WriteError::Stream(error)) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
                    written => Ok(written?),
                }
            }
        }
    }
}

/// The format that an extension tells.
///
/// # Errors
/// Wrong usage, where it tells none.
pub fn format_of(path: &Path) -> anyhow::Result<Format> {
    let shown = path.display();
    Format::from_extension(path).map_err(|error| match path.extension() {
        Some(_) => usage(&format!("{shown}: {error}; name a format by the extension or by --to")),
        None => usage(&format!(
            "{shown}: there is no extension that tells the format; name it, as by --to obj (or {})",
            Format::list().replacen("obj, ", "", 1)
        )),
    })
}

fn usage(message: &str) -> anyhow::Error {
    super::Arguments::command().error(ErrorKind::ValueValidation, message).into()
}
