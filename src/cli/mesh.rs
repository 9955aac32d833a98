//! `quadmosaic mesh`.

use super::backend::Machine;
use super::config::{ConfigArguments, Resulting};
use super::input::Source;
use super::mesh_output::MeshOutput;
use super::method::MethodArguments;
use super::output::{Output, expect_writable, page_path, picture_path, print_beside, warn, write_json};
use super::progress::Progress;
use super::{page, picture, sentence, summary};
use anyhow::Context;
use clap::{Args, CommandFactory, error::ErrorKind};
use quadmosaic::export::MeshFile;
use quadmosaic::page::write_page;
use quadmosaic::picture::{Paint, View, mesh_scene, write_picture};
use quadmosaic::report::{FailureReport, GivenOptions, Report};
use quadmosaic::surface::AttributeKind;
use quadmosaic::{Options, Outcome, Soup, warnings};
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
    _config: ConfigArguments,
    /// The options that result.
    #[arg(skip)]
    pub options: Vec<Resulting>,
    #[command(flatten)]
    method: MethodArguments,
    /// Refuse a mesh with a fault: exit with code 3, write no file
    ///
    /// Refused is also a mesh that differs from the surface in its Euler characteristic, boundary loops or components, or lacks a part of
    /// it; without this option that is a warning
    #[arg(long, help_heading = "Connection")]
    strict: bool,

    #[command(flatten)]
    machine: Machine,

    /// Write where each vertex lies on the input, to PLY, VTK and VTU
    ///
    /// As the arrays source_triangle, counted from 0, and source_barycentric
    #[arg(long, help_heading = "Output")]
    with_source: bool,
    /// Draw the mesh, as `quadmosaic picture` does
    #[arg(long, value_name = "PIC.png|svg", value_parser = picture_path, help_heading = "Output")]
    picture: Option<PathBuf>,
    /// Write a page for a browser, to look at the mesh and to draw on it
    ///
    /// It shows the mesh, the surface, the field and the tiles; strokes and sizes drawn on it are saved as files for --guides and
    /// --size-field
    #[arg(long, value_name = "PAGE.html", value_parser = page_path, help_heading = "Output")]
    html: Option<PathBuf>,
    /// Write the printed figures, and more, as JSON (-: standard output)
    #[arg(long, value_name = "FILE.json", help_heading = "Output")]
    pub report: Option<Output>,
    /// Print warnings and errors only
    #[arg(short, long, help_heading = "Output")]
    quiet: bool,
}

const EXAMPLES: &str = "\
Examples:
  The ONERA M6 wing with 6000 vertices:
    quadmosaic mesh example:m6 --points 6000 -o m6.obj
  Edges of 20 mm on a model in metres, rows along x near the point 1,0,0.5, figures as JSON:
    quadmosaic mesh car.stl --size 0.02 --guide 1,0,0.5,1,0,0 --report car.json -o quads.obj";

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    arguments.expect_writable().and_then(|()| mesh(arguments)).unwrap_or_else(|error| {
        arguments.report_failure(&error);
        Err(error)
    })
}

/// Writes the mesh; then what is beside it, whose error is the inner one.
fn mesh(arguments: &Arguments) -> anyhow::Result<anyhow::Result<()>> {
    let options = arguments.method.options()?;
    arguments.machine.start_threads()?;
    let name = arguments.source.to_string();

    let (soup, reading) = timed(|| arguments.source.read());
    let soup = soup?;
    let (mesher, opening) = timed(|| arguments.machine.mesher());
    let mesher = mesher?;

    let progress = Progress::new(arguments.quiet);
    let outcome = mesher.mesh_watched(&soup, &options, &|stage, share| progress.show(stage, share));
    progress.end();
    let outcome = outcome.context(name.clone())?;

    let (mut report, measuring) = timed(|| mesher.report(&name, &options, &outcome));
    report.options = Some(arguments.given());
    // What a preset sets need not have an effect.
    report.ineffective.retain(|option| arguments.is_given(option.option()));
    let wrong = report.wrong();
    if let (true, Some(wrong)) = (arguments.strict, &wrong) {
        let error = format!("{} was not written: {wrong}", arguments.output.output);
        report.error = Some(error.clone());
        let report = report.with_times(&[("read", reading), ("device", opening)], &[("measure", measuring)]);
        warn(arguments.write_report(&report).err().map(|error| sentence(&error)));
        return Err(Unsound(error).into());
    }
    let meshed = &outcome.meshed;
    let (written, writing) = timed(|| {
        let file = MeshFile::new(&meshed.mesh, &meshed.vertices).with_input(&soup, arguments.with_source);
        arguments.output.write(&file)
    });
    written?;
    let report =
        report.with_times(&[("read", reading), ("device", opening)], &[("measure", measuring), ("write", writing)]);
    // The mesh is written: what is told of it must not depend on the rest.
    let beside = arguments.write_beside(&soup, &options, &outcome, &report);
    Ok(arguments.tell(&soup, &options, &report).and(beside))
}

impl Arguments {
    /// Writes the results beside the mesh.
    fn write_beside(&self, soup: &Soup, options: &Options, outcome: &Outcome, report: &Report) -> anyhow::Result<()> {
        self.write_report(report)?;
        if let Some(path) = &self.picture {
            write_picture(path, &mesh_scene(&outcome.meshed.mesh, Paint::Sides), &View::default(), picture::SIZE)?;
        }
        if let Some(path) = &self.html {
            write_page(path, &page::of_run(soup, options, outcome, report)?)?;
        }
        Ok(())
    }

    /// Prints the figures and the warnings.
    fn tell(&self, soup: &Soup, options: &Options, report: &Report) -> anyhow::Result<()> {
        let output = &self.output.output;
        if !self.quiet {
            print_beside([output].into_iter().chain(&self.report), &summary::of_run(report))?;
        }
        warn(report.wrong().map(|wrong| format!("{output}: {wrong}")));
        warn(report.warnings());
        warn(warnings::of_seams(soup, options));
        warn(warnings::of_attributes(&soup.attributes, self.output.format()?, &output.to_string()));
        warn(warnings::of_precision(soup, report.mesh.vertices));
        Ok(())
    }

    /// Writes a report on a run that made no mesh. One that `--strict` refuses has a report of its own, and wrong usage is no run.
    fn report_failure(&self, error: &anyhow::Error) {
        let is_told = error.is::<Unsound>() || error.is::<clap::Error>();
        let is_free = |report: &&Output| {
            report.path().is_none_or(|path| expect_writable(path, &self.other_paths()).is_ok())
                && *report != &self.output.output
        };
        if let Some(path) = self.report.as_ref().filter(|_| !is_told).filter(is_free) {
            let failure = FailureReport::new(&self.source.to_string(), self.given(), sentence(error));
            warn(write_json(path, &failure).err().map(|error| sentence(&error)));
        }
    }

    /// Checks, before long work, that the results can be written.
    fn expect_writable(&self) -> anyhow::Result<()> {
        let conflict = |message| super::Arguments::command().error(ErrorKind::ArgumentConflict, message).into();
        let format = self.output.format()?;
        if self.method.leaves_holes() && !format.takes_polygons() {
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
        let mut paths = self.other_paths();
        paths.extend(self.report.as_ref().and_then(Output::path));
        let given = usize::from(self.source.path().is_some());
        (given..paths.len()).try_for_each(|k| expect_writable(paths[k], &paths[..k]))
    }

    /// The file that is read, where it is one, and those that are written, but for the report.
    fn other_paths(&self) -> Vec<&Path> {
        let drawn = [&self.picture, &self.html].into_iter().filter_map(Option::as_deref);
        self.source.path().into_iter().chain(self.output.path()).chain(drawn).collect()
    }

    /// The options that result, as reports have them.
    fn given(&self) -> GivenOptions {
        let value = |option: &Resulting| serde_json::to_value(&option.value).unwrap_or_default();
        self.options.iter().map(|option| (option.name.clone(), value(option))).collect()
    }

    /// Whether the user gave an option, by itself; its name is that of the library.
    fn is_given(&self, name: &str) -> bool {
        self.options.iter().any(|option| option.name.replace('-', "_") == name && option.is_given())
    }

    fn write_report(&self, report: &Report) -> anyhow::Result<()> {
        self.report.as_ref().map_or(Ok(()), |path| write_json(path, report))
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
