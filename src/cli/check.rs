//! `quadmosaic check`.

use super::output::print;
use super::summary;
use anyhow::ensure;
use clap::Args;
use quadmosaic::mesh::check::check;
use quadmosaic::mesh::quality::Quality;
use quadmosaic::mesh::read_mesh;
use std::path::PathBuf;

/// Checks and measures a polygon mesh
///
/// Lists broken invariants with their places (vertices and faces are counted from 0): vertices without a face, edges with
/// more than two faces, faces that are turned over, repeated, degenerate or concave. The exit code is 1 where there is one.
#[derive(Args)]
pub struct Arguments {
    /// The mesh: an OBJ, PLY or STL file, told apart by content
    #[arg(value_name = "MESH")]
    mesh: PathBuf,
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let mesh = read_mesh(&arguments.mesh)?;
    let faults = check(&mesh);
    // Measures of faces that name missing vertices mean nothing; the reader refuses those.
    print(&summary::of_mesh(&Quality::of(&mesh), &faults))?;
    let count = faults.list.len();
    ensure!(count == 0, "{} has {}", arguments.mesh.display(), summary::counted(count, "fault"));
    Ok(())
}
