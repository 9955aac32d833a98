//! `quadmosaic serve`: a page on this machine that meshes the surface with what is drawn on it.
//!
//! It listens on the loopback interface alone, and asks no other machine for anything.

mod connections;
mod guard;
mod http;
mod meshing;
mod order;
mod runs;
mod site;

use super::backend::Machine;
use super::config::ConfigArguments;
use super::input::Source;
use super::mesh_output::format_of;
use super::method::MethodArguments;
use super::output::{expect_writable, file_path, print};
use super::progress::Progress;
use super::signals::Signals;
use anyhow::Context;
use clap::Args;
use connections::Server;
use guard::Guard;
use meshing::Meshing;
use quadmosaic::export::Format;
use runs::Runs;
use site::MeshSite;
use std::net::{Ipv4Addr, TcpListener};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Meshes a surface, and serves a page on which it is drawn on and meshed again
///
/// Prints the address of the page, for a browser on this machine. The page is that of `mesh --html`; a button meshes the surface with the
/// strokes and sizes that were drawn, by the options given here, and the number of vertices and the layout can be changed. Whoever has
/// the address can mesh this surface; the server takes no connections from other machines. Ctrl-C ends it.
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    #[command(flatten)]
    source: Source,
    /// Write each mesh to this file, whose extension tells the format
    #[arg(short, long, value_name = "OUT", value_parser = file_path, help_heading = "Output")]
    output: Option<PathBuf>,
    /// The format of the meshes, whatever the extension; obj where no file is given
    #[arg(long, value_name = "FORMAT", help_heading = "Output")]
    to: Option<Format>,
    /// The port of the server; 0: any that is free
    #[arg(long, value_name = "PORT", default_value_t = 0, help_heading = "Server")]
    port: u16,

    #[command(flatten)]
    _config: ConfigArguments,
    #[command(flatten)]
    method: MethodArguments,
    #[command(flatten)]
    machine: Machine,
}

const EXAMPLES: &str = "\
Examples:
  quadmosaic serve car.stl --points 6000 -o quads.obj
  On another machine, through a tunnel; the address that is printed is good on both:
    ssh -L 8123:127.0.0.1:8123 HOST quadmosaic serve car.stl --port 8123";

/// Serves the page until a signal ends the program, which is the error then.
///
/// # Errors
/// As `mesh` for the first mesh; where the port cannot be had; [`Stopped`](super::signals::Stopped).
pub fn run(arguments: Arguments) -> anyhow::Result<()> {
    let signals = Signals::listen().context("signals cannot be listened for")?;
    let Arguments { source, output, to, port, _config, method, machine } = arguments;
    let format = match (to, &output) {
        (Some(format), _) => format,
        (None, Some(path)) => format_of(path)?,
        (None, None) => Format::Obj,
    };
    if let Some(path) = &output {
        let taken: Vec<&Path> = source.path().into_iter().collect();
        expect_writable(path, &taken)?;
    }
    let options = method.options()?;
    machine.start_threads()?;
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))
        .with_context(|| format!("port {port} of 127.0.0.1 cannot be had; choose another, or leave --port out"))?;
    let guard = Guard::new().context("the operating system gives no random numbers for the token")?;
    let meshing = Meshing { name: source.to_string(), soup: source.read()?, mesher: machine.mesher()?, format, output };

    let progress = Progress::new(false);
    let first = meshing.make(&options, &|stage, share| match signals.stopped() {
        Some(_) => ControlFlow::Break(()),
        None => progress.show(stage, share),
    });
    progress.end();
    if let Some(stopped) = signals.stopped() {
        return Err(stopped.into());
    }
    let runs = Runs::new(meshing, first?);

    let address = listener.local_addr().context("the port is not known")?;
    let url = format!("http://{address}/{}/\n", guard.token());
    let file = format!("mesh.{}", format.extension());
    let server = Server::start(listener, Arc::new(MeshSite { guard, runs: runs.clone(), options, file }));
    let server = server.context("the threads of the server cannot be started")?;
    print(&url)?;
    let stopped = signals.wait();
    server.end();
    runs.end();
    Err(stopped.into())
}
