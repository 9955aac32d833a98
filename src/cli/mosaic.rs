//! `quadmosaic mosaic`.

use super::backend::Machine;
use super::field_arguments::FieldArguments;
use super::fineness::FinenessArguments;
use super::input::Source;
use super::layout::LayoutArguments;
use super::output::{Output, expect_writable, picture_path, print_beside, tiles_path, warn, write_json};
use super::{picture, summary};
use anyhow::Context;
use clap::Args;
use quadmosaic::export::{Format, MeshFile, Shade, tile_mesh, write_mesh, write_mesh_ply};
use quadmosaic::mosaic::quality::TileQuality;
use quadmosaic::picture::{Colour, View, mosaic_scene, write_picture};
use quadmosaic::pipeline::{self, Options, prepare};
use quadmosaic::report::MosaicReport;
use quadmosaic::warnings;
use std::path::{Path, PathBuf};

/// Writes the tiles that a mesh would be made of, as squares laid on the surface
///
/// With the same options these are the tiles of `mesh`. OBJ: a face a tile; on features, a face for each side. PLY: the same,
/// coloured by the fit of each tile (`quality`: 1 where its neighbours are at their places, 0 where they are half a tile off).
/// Prints the share of the area under tiles, the share under two tiles, and the straightness of the rows.
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    #[command(flatten)]
    source: Source,
    /// The file of the tiles
    #[arg(short, long, value_name = "TILES.obj|ply", value_parser = tiles_path)]
    output: PathBuf,
    /// The share of a tile's side that is left free between it and the next, 0 to 0.9
    #[arg(long, value_name = "SHARE", default_value_t = 0.1, value_parser = picture::grout)]
    grout: f64,
    #[command(flatten)]
    fineness: FinenessArguments,
    #[command(flatten)]
    directions: FieldArguments,
    #[command(flatten)]
    layout: LayoutArguments,
    #[command(flatten)]
    machine: Machine,
    /// Draw the tiles, as `quadmosaic picture --mosaic` does
    #[arg(long, value_name = "PIC.png|svg", value_parser = picture_path)]
    picture: Option<PathBuf>,
    /// Write the printed figures, and more, as JSON; -: to standard output
    #[arg(long, value_name = "FILE.json")]
    pub report: Option<Output>,
    /// Print warnings and errors only
    #[arg(short, long)]
    quiet: bool,
}

const EXAMPLES: &str = "\
Examples:
  quadmosaic mosaic example:m6 --points 2000 -o tiles.ply --picture tiles.png
  quadmosaic mosaic vase.stl --size 5 --grout 0.15 -o tiles.obj";

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let Arguments {
        source,
        output,
        grout,
        fineness,
        directions,
        layout,
        machine,
        picture: picture_file,
        report: report_file,
        quiet,
    } = arguments;
    let mut taken: Vec<&Path> = source.path().into_iter().collect();
    let pictured = picture_file.as_deref();
    for path in [output.as_path()].into_iter().chain(pictured).chain(report_file.as_ref().and_then(Output::path)) {
        expect_writable(path, &taken)?;
        taken.push(path);
    }
    let options = Options {
        features: directions.features(),
        repairs: directions.repairs(),
        edges: directions.edges()?,
        field: directions.field()?,
        sizes: fineness.sizes()?,
        rows: layout.rows(),
        fit: layout.fit,
        fit_range: layout.fit_range,
        aspect: layout.aspect,
        ..Options::new(fineness.fineness())
    };
    machine.start_threads()?;
    let name = source.to_string();
    let soup = source.read()?;
    let (surface, sizes, count) = prepare(&soup, &options).context(name.clone())?;
    let mesher = machine.mesher()?;
    let backend = mesher.backend();
    let field = pipeline::field(&surface, sizes, count, &options, backend)?;
    let mosaic = pipeline::lay(&surface, &field, backend, count, &options, &|_| ())?;

    let fit = TileQuality::of(&surface, &mosaic);
    let (mesh, tiles) = tile_mesh(&surface, &mosaic, *grout as f32);
    match output.extension() {
        Some(ending) if ending.eq_ignore_ascii_case("ply") => {
            let shade = |&tile: &u32| {
                let quality = fit.of_tiles[tile as usize];
                Shade { quality: quality as f32, colour: Colour::of_quality(quality).0 }
            };
            write_mesh_ply(output, &mesh, &tiles.iter().map(shade).collect::<Vec<_>>())?;
        }
        _ => write_mesh(output, Format::Obj, &MeshFile::from(&mesh))?,
    }
    if let Some(path) = picture_file {
        write_picture(path, &mosaic_scene(&surface, &mosaic, *grout as f32, None), &View::default(), picture::SIZE)?;
    }
    let report = MosaicReport::new(&name, &options, backend, (&surface, &field, &mosaic), fit);
    if let Some(output) = report_file {
        write_json(output, &report)?;
    }
    if !quiet {
        print_beside(report_file, &summary::of_mosaic(&report))?;
    }
    warn(warnings::of_guides(&report.field.guides));
    warn(warnings::of_surface(&report.surface));
    warn(warnings::of_stretch(report.field.stretch.as_ref()));
    Ok(())
}
