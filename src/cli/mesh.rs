//! `quadmosaic mesh`.

use super::backend::Machine;
use super::field_arguments::{FieldArguments, warn_of};
use super::fineness::FinenessArguments;
use super::input::Source;
use super::layout::{LayoutArguments, warn_of_stretch};
use super::mesh_output::MeshOutput;
use super::numbers::{degrees, distance, up_to};
use super::output::{Output, expect_writable, picture_path, print_beside, write_json};
use super::picture;
use super::repairs::warn_of_repairs;
use super::summary;
use anyhow::Context;
use clap::{Args, CommandFactory, ValueEnum, error::ErrorKind};
use indicatif::{ProgressBar, ProgressStyle};
use quadmosaic::export::MeshFile;
use quadmosaic::mesh::connect::ConnectOptions;
use quadmosaic::mesh::connectivity::{self, ConnectivityOptions};
use quadmosaic::mesh::fill;
use quadmosaic::picture::{Paint, View, mesh_scene, write_picture};
use quadmosaic::pipeline::{self, Options, Stage};
use quadmosaic::report::{Asked, Report};
use quadmosaic::surface::{AttributeKind, Attributes, Soup};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Meshes a triangle surface
///
/// Reads a triangle surface, lays square tiles on it in rows that follow its features and your guides, and connects their
/// centres to a mesh of quads and a few triangles. Compares the mesh with the surface. Prints measures of both.
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    #[command(flatten)]
    source: Source,
    #[command(flatten)]
    output: MeshOutput,

    #[command(flatten)]
    fineness: FinenessArguments,
    #[command(flatten)]
    directions: FieldArguments,

    /// L: the longest edge, in tile sides (1 to 10)
    #[arg(long, value_name = "L", default_value_t = 1.6, value_parser = distance, help_heading = "Connection")]
    max_distance: f64,
    /// Theta: the largest angle between an edge and its row, in degrees (1 to 45)
    #[arg(
        long,
        value_name = "THETA",
        default_value_t = 30.0,
        value_parser = degrees::<45>,
        help_heading = "Connection"
    )]
    max_angle: f64,
    /// How faces with more than four sides are filled
    #[arg(long, value_enum, default_value_t, help_heading = "Connection")]
    holes: Holes,
    /// The triangles that become quads
    #[arg(long, value_enum, default_value_t, help_heading = "Connection")]
    quads: Quads,
    /// Do not optimise the connectivity: keep the triangles of the filling
    #[arg(long, conflicts_with = "quads", help_heading = "Connection")]
    no_cleanup: bool,
    /// Exit with code 3 and write no file where the mesh has a fault, or differs from the surface in its Euler characteristic,
    /// boundary loops or components, or lacks a part of it; without this option that is a warning
    #[arg(long, help_heading = "Connection")]
    strict: bool,
    /// Passes of vertex relocation, 0 to 1000; 0: vertices stay at the centres of tiles
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = up_to::<1000>, help_heading = "Connection")]
    smoothing: usize,

    #[command(flatten)]
    layout: LayoutArguments,

    #[command(flatten)]
    machine: Machine,

    /// Write where each vertex lies on the input (arrays source_triangle, counted from 0, and source_barycentric); with PLY, VTK and
    /// VTU
    #[arg(long)]
    with_source: bool,
    /// Draw the mesh, as `quadmosaic picture` does
    #[arg(long, value_name = "PIC.png|svg", value_parser = picture_path)]
    picture: Option<PathBuf>,
    /// Write the printed figures, and more, as JSON; -: to standard output
    #[arg(long, value_name = "FILE.json")]
    report: Option<Output>,
    /// Print warnings and errors only
    #[arg(short, long)]
    quiet: bool,
}

const EXAMPLES: &str = "\
Examples:
  The ONERA M6 wing with 6000 vertices:
    quadmosaic mesh example:m6 --points 6000 -o m6.obj
  Edges of 20 mm on a model in metres, rows along x near the point 1,0,0.5, figures as JSON:
    quadmosaic mesh car.stl --size 0.02 --guide 1,0,0.5,1,0,0 --report car.json -o quads.obj";

#[derive(Clone, Copy, Debug, Default, ValueEnum)]
enum Holes {
    /// Split into quads and at most one triangle each
    #[default]
    Patterns,
    /// Split into triangles
    Triangles,
    /// Left as polygons
    Leave,
}

#[derive(Clone, Copy, Debug, Default, ValueEnum)]
enum Quads {
    /// Those that the paper's clean-up finds
    Paper,
    /// Those whose change improves the mesh: triangles move until they meet, short rows are inserted or removed
    #[default]
    Most,
    /// All, at some cost of shape
    All,
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    arguments.expect_writable()?;
    let options = arguments.options()?;
    arguments.machine.start_threads()?;
    let name = arguments.source.to_string();

    let (soup, reading) = timed(|| arguments.source.read());
    let soup = soup?;
    let (device, opening) = timed(|| arguments.machine.open());
    let device = device?;
    let (backend, compiling) = timed(|| device.backend());
    let backend = backend?;

    let progress = Progress::new(arguments.quiet);
    let outcome = pipeline::run(&soup, &options, &*backend, &|stage, share| progress.show(stage, share));
    progress.bar.finish_and_clear();
    let outcome = outcome.context(name.clone())?;

    let (report, measuring) = timed(|| Report::new(&name, &options, &*backend, &outcome));
    let wrong = summary::wrong(&report);
    if let (true, Some(wrong)) = (arguments.strict, &wrong) {
        return Err(Unsound(format!("{} was not written: {wrong}", arguments.output.output)).into());
    }
    let meshed = &outcome.meshed;
    let (written, writing) = timed(|| {
        let file = MeshFile::new(&meshed.mesh, &meshed.vertices).with_input(&soup, arguments.with_source);
        arguments.output.write(&file)
    });
    written?;
    let report = report.with_times(
        &[("read", reading), ("device", opening + compiling)],
        &[("measure", measuring), ("write", writing)],
    );
    if let Some(path) = &arguments.picture {
        write_picture(path, &mesh_scene(&outcome.meshed.mesh, Paint::Sides), &View::default(), picture::SIZE)?;
    }
    if let Some(path) = &arguments.report {
        write_json(path, &report)?;
    }
    if !arguments.quiet {
        print_beside([&arguments.output.output].into_iter().chain(&arguments.report), &summary::of_run(&report))?;
    }
    warn_of(outcome.field.guides());
    warn_of_stretch(report.field.stretch.as_ref());
    warn_of_repairs(&outcome.surface);
    warn_of_attributes(&soup.attributes, &arguments.output)?;
    warn_of_precision(&soup, meshed.mesh.points.len());
    if let Some(wrong) = wrong {
        eprintln!("warning: {}: {wrong}", arguments.output.output);
    }
    if let Some(warning) = count_warning(&report) {
        eprintln!("warning: {warning}");
    }
    Ok(())
}

/// Tells which attributes of the surface the file of the mesh does not have.
fn warn_of_attributes(attributes: &Attributes, output: &MeshOutput) -> anyhow::Result<()> {
    let format = output.format()?;
    let refused = attributes.list.iter().filter(|attribute| !format.takes(attribute.kind));
    let refused: Vec<&str> = refused
        .map(|attribute| match attribute.kind {
            AttributeKind::Colour => "colours",
            AttributeKind::Texture => "texture coordinates",
            AttributeKind::Numbers => attribute.name.as_str(),
        })
        .collect();
    let advice = if refused.is_empty() { "" } else { "; ply, vtk and vtu hold numbers of vertices" };
    let all: Vec<&str> = refused.into_iter().chain(attributes.left_out.iter().map(String::as_str)).collect();
    if !all.is_empty() {
        eprintln!("warning: not carried to {}: {}{advice}", output.output, all.join(", "));
    }
    Ok(())
}

/// Steps of coordinates above this share of a tile's side show in the mesh.
const COARSE: f64 = 1e-3;

/// Tells where coordinates in f32 are too coarse for tiles of which so many cover the surface.
fn warn_of_precision(soup: &Soup, tiles: usize) {
    let side = (soup.area() / tiles as f64).sqrt();
    if let Some(step) = soup.f32_step().filter(|&step| step > COARSE * side) {
        eprintln!(
            "warning: the coordinates are multiples of {step:.1e}, as f32 has them so far from the origin, and a tile has a side of \
             {side:.3e}: steps show in the mesh; move the model to the origin before it is exported, or export it in f64 or text"
        );
    }
}

/// A number of vertices that misses the wanted one by a larger share is a warning.
const COUNT_TOLERANCE: f64 = 0.05;

fn count_warning(report: &Report) -> Option<String> {
    let Asked::Points(asked) = report.asked else { return None };
    let found = report.mesh.vertices;
    (found.abs_diff(asked) as f64 > COUNT_TOLERANCE * asked as f64).then(|| {
        let on_features = report.mosaic.on_features;
        let advice = match found > asked && 2 * on_features > asked {
            true => format!(
                ", as {on_features} tiles lie on features; ask for another number, or for fewer features by --crease"
            ),
            false => "; ask for another number".to_owned(),
        };
        format!("{found} vertices instead of {asked}{advice}")
    })
}

impl Arguments {
    /// Checks, before long work, that the results can be written.
    fn expect_writable(&self) -> anyhow::Result<()> {
        let conflict = |message| super::Arguments::command().error(ErrorKind::ArgumentConflict, message).into();
        let format = self.output.format()?;
        if matches!(self.holes, Holes::Leave) && !format.takes_polygons() {
            return Err(conflict(format!(
                "{format} has no faces of more than four corners; --holes leave does not go with it"
            )));
        }
        if self.with_source && !format.takes(AttributeKind::Numbers) {
            return Err(conflict(format!(
                "{format} has no arrays of vertices; --with-source goes with ply, vtk and vtu"
            )));
        }
        if (&self.output.output, self.report.as_ref()) == (&Output::Standard, Some(&Output::Standard)) {
            let message = "the mesh and the report cannot both go to standard output; name a file for one of them";
            return Err(conflict(message.to_owned()));
        }
        let mut taken: Vec<&Path> = self.source.path().into_iter().collect();
        let report = self.report.as_ref().and_then(Output::path);
        for path in self.output.path().into_iter().chain(self.picture.as_deref()).chain(report) {
            expect_writable(path, &taken)?;
            taken.push(path);
        }
        Ok(())
    }

    fn options(&self) -> anyhow::Result<Options> {
        let rest = Options {
            sizes: self.fineness.sizes()?,
            connect: ConnectOptions { max_distance: self.max_distance, max_angle: self.max_angle },
            holes: match self.holes {
                Holes::Patterns => fill::Holes::Patterns,
                Holes::Triangles => fill::Holes::Triangles,
                Holes::Leave => fill::Holes::Leave,
            },
            connectivity: (!self.no_cleanup).then(|| ConnectivityOptions {
                quads: match self.quads {
                    Quads::Paper => connectivity::Quads::Paper,
                    Quads::Most => connectivity::Quads::Most,
                    Quads::All => connectivity::Quads::All,
                },
                ..ConnectivityOptions::default()
            }),
            smoothing: self.smoothing,
            ..Options::new(self.fineness.fineness())
        };
        self.layout.options(&self.directions, rest)
    }
}

/// The mesh has a fault or differs from the surface, with `--strict`.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct Unsound(String);

fn timed<T>(work: impl FnOnce() -> T) -> (T, Duration) {
    let start = Instant::now();
    let done = work();
    (done, start.elapsed())
}

/// A progress bar on stderr, hidden where that is no terminal.
struct Progress {
    bar: ProgressBar,
}

impl Progress {
    fn new(quiet: bool) -> Self {
        let bar = if quiet { ProgressBar::hidden() } else { ProgressBar::new(100) };
        let style = ProgressStyle::with_template("{msg:12} {bar:40} {percent:>3} %").expect("the template is right");
        Self { bar: bar.with_style(style) }
    }

    fn show(&self, stage: Stage, share: f32) {
        self.bar.set_message(stage.name());
        self.bar.set_position((100.0 * share) as u64);
    }
}
