//! `quadmosaic man`.

use anyhow::Context;
use clap::{Args, CommandFactory};
use std::fs;
use std::path::PathBuf;

/// Writes the manual: one page for man for each command
///
/// Read one: man ./quadmosaic-mesh.1
#[derive(Args)]
pub struct Arguments {
    /// The folder of the pages, created where it is missing
    #[arg(short, long, value_name = "DIR", help_heading = "Output")]
    output: PathBuf,
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let folder = &arguments.output;
    fs::create_dir_all(folder).with_context(|| format!("the folder {} cannot be made", folder.display()))?;
    let command = super::Arguments::command().disable_help_subcommand(true);
    clap_mangen::generate_to(command, folder)
        .with_context(|| format!("the pages cannot be written to {}", folder.display()))
}
