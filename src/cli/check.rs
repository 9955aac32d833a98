//! `quadmosaic check`.

use super::features::FeatureArguments;
use super::input::Input;
use super::output::{Output, expect_writable, print_beside, write_json};
use super::repairs::RepairArguments;
use super::summary;
use anyhow::{Context, bail};
use clap::Args;
use quadmosaic::mesh::quality::Quality;
use quadmosaic::mesh::{Mesh, read_mesh};
use quadmosaic::report::CheckReport;
use quadmosaic::surface::Surface;
use std::path::{Path, PathBuf};

/// Checks and measures a polygon mesh, alone or against the surface that it approximates
///
/// Lists broken invariants with their places (vertices and faces are counted from 0): vertices without a face, edges with
/// more than two faces, faces that are misoriented, repeated, degenerate or concave. Against a surface it also lists inverted
/// faces, holes, vertices farther from it than an edge length, and differences of topology; it measures the distances of the
/// two from each other, and of the surface's features from the mesh's edges. The mesh may branch where sheets of the surface
/// meet. The exit code is 1 where there is a fault or a difference.
#[derive(Args)]
#[command(after_help = EXAMPLES, mut_group("FeatureArguments", |features| features.requires("against")),
    mut_group("RepairArguments", |repairs| repairs.requires("against")))]
pub struct Arguments {
    /// The mesh: an OBJ, PLY or STL file, told apart by content
    #[arg(value_name = "MESH")]
    mesh: PathBuf,
    /// The surface: such a file, -: standard input; or an example, as for `mesh`
    #[arg(long, value_name = "SURFACE")]
    against: Option<Input>,
    #[command(flatten)]
    features: FeatureArguments,
    #[command(flatten)]
    repairs: RepairArguments,
    /// Write the printed figures, and every fault, as JSON; -: to standard output
    #[arg(long, value_name = "FILE.json")]
    pub report: Option<Output>,
}

const EXAMPLES: &str = "\
Examples:
  quadmosaic check quads.obj
  quadmosaic check quads.obj --against car.stl --crease 30 --report check.json";

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    arguments.expect_writable()?;
    let mesh = read_mesh(&arguments.mesh)?;
    let name = arguments.mesh.display().to_string();
    let Arguments { features, repairs, .. } = arguments;
    let surface = arguments.against.as_ref().map(|input| surface(input, &mesh, features, repairs)).transpose()?;
    let against = surface.as_ref().map(|(name, surface)| (name.as_str(), surface));
    let report = CheckReport::new(&name, &mesh, against);
    if let Some(output) = &arguments.report {
        write_json(output, &report)?;
    }
    print_beside(&arguments.report, &summary::of_check(&report))?;
    match summary::faults_of(&report) {
        None => Ok(()),
        Some(faults) => bail!("{name}: {faults}"),
    }
}

impl Arguments {
    fn expect_writable(&self) -> anyhow::Result<()> {
        let Some(report) = self.report.as_ref().and_then(Output::path) else { return Ok(()) };
        let mut taken: Vec<&Path> = vec![&self.mesh];
        if let Some(Input::File(path)) = &self.against {
            taken.push(path);
        }
        expect_writable(report, &taken)
    }
}

/// The surface that a mesh approximates, and its name.
///
/// # Errors
/// Where it cannot be read, or is none.
pub fn surface(
    input: &Input,
    mesh: &Mesh,
    features: &FeatureArguments,
    repairs: &RepairArguments,
) -> anyhow::Result<(String, Surface)> {
    let (soup, name, options) = (input.read(None)?, input.to_string(), features.options());
    let edges = features.edges()?;
    // A tile is as large as the mesh's faces.
    let side = Quality::of(mesh).mean_edge;
    let surface = Surface::repaired(&soup, &options, &repairs.options(), side)
        .and_then(|surface| surface.with_edges(&soup, &edges, &options));
    Ok((name.clone(), surface.context(name)?))
}
