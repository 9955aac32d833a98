//! `quadmosaic view`.

use super::features::FeatureArguments;
use super::input::{Input, Source};
use super::output::{expect_writable, page_path};
use super::repairs::RepairArguments;
use super::{check, page};
use clap::Args;
use quadmosaic::mesh::quality::Quality;
use quadmosaic::page::write_page;
use quadmosaic::report::CheckReport;
use std::path::{Path, PathBuf};

/// Writes a page for a browser: a mesh to look at, and to draw strokes and sizes on
///
/// The page is one file that needs no network. It shows the faces, their quality by colour, irregular vertices, regions, histograms
/// and the figures of `check`; with --input, the surface and its features too. Strokes and sizes are saved as files for --guides and
/// --size-field.
#[derive(Args)]
#[command(after_help = EXAMPLES, mut_group("FeatureArguments", |features| features.requires("surface")),
    mut_group("RepairArguments", |repairs| repairs.requires("surface")))]
pub struct Arguments {
    #[command(flatten)]
    source: Source,
    /// The surface that the mesh approximates, a file or an example
    #[arg(id = "surface", long = "input", value_name = "SURFACE")]
    input: Option<Input>,
    /// The file of the page
    #[arg(short, long, value_name = "PAGE.html", value_parser = page_path)]
    output: PathBuf,
    #[command(flatten)]
    features: FeatureArguments,
    #[command(flatten)]
    repairs: RepairArguments,
}

const EXAMPLES: &str = "\
Examples:
  quadmosaic view quads.obj -o quads.html
  quadmosaic view quads.obj --input car.stl -o quads.html";

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let Arguments { source, input, output, features, repairs } = arguments;
    let mut taken: Vec<&Path> = source.path().into_iter().collect();
    if let Some(Input::File(path)) = input {
        taken.push(path);
    }
    expect_writable(output, &taken)?;
    let mesh = source.read_mesh()?;
    let surface = input.as_ref().map(|input| check::surface(input, &mesh, features, repairs)).transpose()?;
    let against = surface.as_ref().map(|(name, surface)| (name.as_str(), surface));
    let report = CheckReport::new(&source.to_string(), &mesh, against);
    let page = page::of_check(&mesh, &report)?;
    let page = match surface {
        Some((_, surface)) => {
            let side = Quality::of(&mesh).mean_edge / surface.frame().diagonal;
            let page = page.with_surface(&surface);
            page.with_features(&surface.fitted(&features.options(), side as f32))
        }
        None => page,
    };
    Ok(write_page(output, &page)?)
}
