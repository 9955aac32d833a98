//! The command line: one file a subcommand. Nothing else prints.

mod backend;
mod batch;
mod check;
mod completions;
mod config;
mod devices;
mod earlier;
mod example;
mod features;
mod field;
mod field_arguments;
mod fineness;
mod input;
mod layout;
mod man;
mod mesh;
mod mesh_output;
mod method;
mod mosaic;
mod output;
mod page;
mod picture;
mod progress;
mod repairs;
mod serve;
mod signals;
mod study;
mod summary;
mod view;

use anyhow::Context;
use clap::{Parser, Subcommand};
use config::Request;
use mesh::Unsound;
use signals::{Stopped, end_by_signals};
use std::ffi::OsString;
use std::path::Path;

/// Turns a triangle surface into a quad-dominant mesh whose rows follow its features and your guides.
#[derive(Parser)]
#[command(name = "quadmosaic", version, after_help = EXAMPLES)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

const EXAMPLES: &str = "\
Examples:
  quadmosaic mesh example:m6 --points 6000 -o m6.obj
  quadmosaic mesh car.stl --size 0.02 --crease 30 --report car.json -o car_quads.obj

`quadmosaic help mesh` explains every option.";

#[derive(Subcommand)]
enum Command {
    Mesh(Box<mesh::Arguments>),
    Batch(Box<batch::Arguments>),
    Field(Box<field::Arguments>),
    Mosaic(Box<mosaic::Arguments>),
    Picture(Box<picture::Arguments>),
    Study(Box<study::Arguments>),
    Example(example::Arguments),
    Check(check::Arguments),
    View(view::Arguments),
    Serve(Box<serve::Arguments>),
    /// Lists the GPU adapters of this machine, the best first
    Devices,
    Completions(completions::Arguments),
    Man(man::Arguments),
}

/// The exit code where `--strict` refuses a mesh.
const UNSOUND: u8 = 3;

/// Does what the arguments ask for, the program's name first, and returns the exit code.
pub fn main(arguments: impl IntoIterator<Item = impl Into<OsString> + Clone>) -> u8 {
    let arguments: Vec<OsString> = arguments.into_iter().map(Into::into).collect();
    let parsed = config::parse(&arguments);
    let is_wrong =
        parsed.as_ref().is_err_and(|error| error.downcast_ref::<clap::Error>().is_none_or(clap::Error::use_stderr));
    if is_wrong {
        earlier::discard_named(&arguments);
    }
    let done = parsed.and_then(|request| match request {
        Request::Run(arguments) => run(arguments),
        Request::Print(text) => output::print(&text),
    });
    let Err(error) = done else { return 0 };
    // Wrong usage that clap could not see by itself exits as all wrong usage does, with code 2.
    if let Some(usage) = error.downcast_ref::<clap::Error>() {
        let _ = usage.print();
        return u8::try_from(usage.exit_code()).unwrap_or(u8::MAX);
    }
    // The user ended the program; that is no error to tell.
    if let Some(stopped) = error.downcast_ref::<Stopped>() {
        return stopped.code();
    }
    eprintln!("error: {}", sentence(&error));
    if error.is::<Unsound>() { UNSOUND } else { 1 }
}

/// Reads arguments as [`main`] does, with the file of options that they name, and does nothing more.
///
/// # Errors
/// What `main` would say of them.
pub fn expect_valid(arguments: impl IntoIterator<Item = impl Into<OsString> + Clone>) -> Result<(), String> {
    let arguments: Vec<OsString> = arguments.into_iter().map(Into::into).collect();
    config::parse(&arguments).map(|_| ()).map_err(|error| sentence(&error))
}

/// The error and its causes on one line; a cause that the error tells already is not repeated.
fn sentence(error: &anyhow::Error) -> String {
    error.chain().map(ToString::to_string).fold(String::new(), |told, cause| match told.as_str() {
        "" => cause,
        _ if told.contains(&cause) => told,
        _ => format!("{told}: {cause}"),
    })
}

impl Command {
    /// Where its report goes.
    fn report(&self) -> Option<&Path> {
        let report = match self {
            Self::Mesh(arguments) => &arguments.report,
            Self::Field(arguments) => &arguments.report,
            Self::Mosaic(arguments) => &arguments.report,
            Self::Check(arguments) => &arguments.report,
            _ => return None,
        };
        report.as_ref()?.path()
    }
}

fn run(arguments: Arguments) -> anyhow::Result<()> {
    arguments.command.report().into_iter().for_each(earlier::discard);
    // The server ends its runs itself.
    if !matches!(arguments.command, Command::Serve(_)) {
        end_by_signals().context("signals cannot be listened for")?;
    }
    match arguments.command {
        Command::Mesh(arguments) => mesh::run(&arguments),
        Command::Batch(arguments) => batch::run(&arguments),
        Command::Field(arguments) => field::run(&arguments),
        Command::Mosaic(arguments) => mosaic::run(&arguments),
        Command::Picture(arguments) => picture::run(&arguments),
        Command::Study(arguments) => study::run(&arguments),
        Command::Example(arguments) => example::run(arguments),
        Command::Check(arguments) => check::run(&arguments),
        Command::View(arguments) => view::run(&arguments),
        Command::Serve(arguments) => serve::run(*arguments),
        Command::Devices => devices::run(),
        Command::Completions(arguments) => completions::run(&arguments),
        Command::Man(arguments) => man::run(&arguments),
    }
}
