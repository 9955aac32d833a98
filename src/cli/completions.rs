//! `quadmosaic completions`.

use super::output::print;
use clap::{Args, CommandFactory};
use clap_complete::{Shell, generate};

/// Writes a script by which a shell completes commands and options, to standard output
///
/// For bash: quadmosaic completions bash > ~/.local/share/bash-completion/completions/quadmosaic
#[derive(Args)]
pub struct Arguments {
    /// The shell
    shell: Shell,
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let mut script = Vec::new();
    generate(arguments.shell, &mut super::Arguments::command(), "quadmosaic", &mut script);
    print(&String::from_utf8(script)?)
}
