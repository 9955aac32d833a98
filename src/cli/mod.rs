//! The command line: one file a subcommand. Nothing else prints.

mod backend;
mod check;
mod devices;
mod example;
mod features;
mod field;
mod field_arguments;
mod fineness;
mod input;
mod layout;
mod mesh;
mod mesh_output;
mod mosaic;
mod numbers;
mod output;
mod picture;
mod repairs;
mod study;
mod summary;

use clap::{Parser, Subcommand};
pub use mesh::Unsound;

/// Turns a triangle surface into a quad-dominant mesh whose rows follow its features and your guides.
#[derive(Parser)]
#[command(version, after_help = EXAMPLES)]
pub struct Arguments {
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
    Field(Box<field::Arguments>),
    Mosaic(Box<mosaic::Arguments>),
    Picture(Box<picture::Arguments>),
    Study(Box<study::Arguments>),
    Example(example::Arguments),
    Check(check::Arguments),
    /// Lists the GPU adapters of this machine, the best first
    Devices,
}

/// Does what the arguments ask for.
///
/// # Errors
/// With a sentence for the user.
pub fn run(arguments: Arguments) -> anyhow::Result<()> {
    match arguments.command {
        Command::Mesh(arguments) => mesh::run(&arguments),
        Command::Field(arguments) => field::run(&arguments),
        Command::Mosaic(arguments) => mosaic::run(&arguments),
        Command::Picture(arguments) => picture::run(&arguments),
        Command::Study(arguments) => study::run(&arguments),
        Command::Example(arguments) => example::run(arguments),
        Command::Check(arguments) => check::run(&arguments),
        Command::Devices => devices::run(),
    }
}
