//! `quadmosaic field`.

use super::backend::Machine;
use super::field_arguments::FieldArguments;
use super::fineness::FinenessArguments;
use super::input::Source;
use super::output::{Output, expect_writable, field_path, print_beside, warn, write_json};
use super::summary;
use anyhow::Context;
use clap::Args;
use quadmosaic::export::{write_field_ply, write_field_vtk};
use quadmosaic::pipeline::{self, Options, prepare};
use quadmosaic::report::FieldReport;
use quadmosaic::warnings;
use std::path::{Path, PathBuf};

/// Writes the cross field of a surface, for ParaView
///
/// Reads a triangle surface and makes the field that `mesh` would lay its tiles along, with the same options. Ridges, and
/// creases too small for a tile, depend on how fine the mesh is to be.
///
/// VTK: per triangle two directions of its cross (cross_u, cross_v); feature curves as lines and singularities as points, told
/// apart by `kind` (0 surface, 1 feature, 2 singularity), with the singularities' `index`. PLY: per vertex its normal, two
/// directions (ux uy uz, vx vy vz) and the index of a corner, per face the index of a singularity; features as edges.
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    #[command(flatten)]
    source: Source,
    /// The file of the field
    #[arg(short, long, value_name = "FIELD.vtk|ply", value_parser = field_path)]
    output: PathBuf,
    #[command(flatten)]
    fineness: FinenessArguments,
    #[command(flatten)]
    directions: FieldArguments,
    #[command(flatten)]
    machine: Machine,
    /// Write the printed figures, and more, as JSON; -: to standard output
    #[arg(long, value_name = "FILE.json")]
    pub report: Option<Output>,
    /// Print warnings and errors only
    #[arg(short, long)]
    quiet: bool,
}

const EXAMPLES: &str = "\
Examples:
  quadmosaic field example:m6 -o field.vtk
  quadmosaic field car.obj --guides guides.json --align curvature:1 -o field.vtk

In ParaView: a Glyph of cross_u and one of cross_v (Glyph Mode: Every Nth Point, after Cell Centers) show the crosses.";

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let Arguments { source, output, fineness, directions, machine, report: report_path, quiet } = arguments;
    let mut taken: Vec<&Path> = source.path().into_iter().collect();
    let report_file = report_path.as_ref().and_then(Output::path);
    for path in [output.as_path()].into_iter().chain(report_file) {
        expect_writable(path, &taken)?;
        taken.push(path);
    }
    let options = Options {
        features: directions.features(),
        repairs: directions.repairs(),
        edges: directions.edges()?,
        field: directions.field()?,
        sizes: fineness.sizes()?,
        ..Options::new(fineness.fineness())
    };
    machine.start_threads()?;
    let name = source.to_string();
    let soup = source.read()?;
    let (surface, sizes, count) = prepare(&soup, &options).context(name.clone())?;
    let mesher = machine.mesher()?;
    let backend = mesher.backend();
    let field = pipeline::field(&surface, sizes, count, &options, backend)?;
    match output.extension() {
        Some(ending) if ending.eq_ignore_ascii_case("ply") => write_field_ply(output, &surface, &field)?,
        _ => write_field_vtk(output, &surface, &field)?,
    }
    let report = FieldReport::new(&name, backend, &surface, &field);
    if let Some(output) = report_path {
        write_json(output, &report)?;
    }
    if !quiet {
        print_beside(report_path, &summary::of_field(&report))?;
    }
    warn(warnings::of_guides(&report.field.guides));
    warn(warnings::of_surface(&report.surface));
    Ok(())
}
