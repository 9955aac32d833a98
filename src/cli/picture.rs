//! `quadmosaic picture`.

use super::backend::Machine;
use super::field_arguments::FieldArguments;
use super::input::Source;
use super::layout::LayoutArguments;
use super::output::{expect_writable, picture_path, warn};
use anyhow::Context;
use clap::{Args, ValueEnum};
use quadmosaic::field::Stretch;
use quadmosaic::mosaic::quality::TileQuality;
use quadmosaic::options::{number, points};
use quadmosaic::picture::{Eye, FieldStyle, Paint, Scene, View, field_scene, mesh_scene, mosaic_scene, write_picture};
use quadmosaic::pipeline::{self, Fineness, Options, prepare};
use quadmosaic::warnings;
use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// The default size of a picture: width and height, in pixels.
pub const SIZE: [u32; 2] = [1600, 1200];

/// Draws a surface or a mesh, or the field or the mosaic of a surface
///
/// Needs neither a display nor a GPU. A mesh of quads is drawn with its quads pale, triangles orange and larger faces violet; a
/// surface of triangles smooth, with creases and boundaries heavier. --field and --mosaic draw the field and the tiles of `mesh`
/// with the same options.
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    #[command(flatten)]
    source: Source,
    /// The file of the picture
    #[arg(short, long, value_name = "PIC.png|svg", value_parser = picture_path)]
    output: PathBuf,

    /// Draw the cross field, and its singularities: red where rows bend round a point, blue where they part
    #[arg(
        long,
        value_enum,
        value_name = "STYLE",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "streamlines",
        help_heading = "What"
    )]
    field: Option<Style>,
    /// Draw the mosaic
    #[arg(long, conflicts_with = "field", help_heading = "What")]
    mosaic: bool,
    /// With --mosaic: the share of a tile's side between it and the next, 0 to 0.9
    #[arg(long, value_name = "SHARE", default_value_t = 0.1, value_parser = grout, requires = "mosaic", help_heading = "What")]
    grout: f64,
    /// The meaning of colours, of a mesh's faces or, with --mosaic, of tiles
    #[arg(long, visible_alias = "color", value_enum, default_value_t, help_heading = "What")]
    colour: Colours,
    /// With --field and --mosaic: number of vertices wanted
    #[arg(long, value_name = "N", default_value_t = 6000, value_parser = points, help_heading = "What")]
    points: usize,

    /// The view: three-quarter, front, back, left, right, top, bottom (z is up), or X,Y,Z, the direction to the eye
    #[arg(
        long,
        value_name = "VIEW",
        default_value = "three-quarter",
        allow_hyphen_values = true,
        help_heading = "View"
    )]
    view: Eye,
    /// The direction that is up in the picture [default: by the view]
    #[arg(long, value_name = "X,Y,Z", value_parser = vector::<3>, allow_hyphen_values = true, help_heading = "View")]
    up: Option<[f64; 3]>,
    /// Width and height in pixels
    #[arg(long, value_name = "WxH", default_value_t = Size(SIZE), help_heading = "View")]
    size: Size,
    /// Fill the picture with the ball of radius R round a point, in model units
    #[arg(long, value_name = "X,Y,Z,R", value_parser = vector::<4>, allow_hyphen_values = true, help_heading = "View")]
    zoom_to: Option<[f64; 4]>,

    #[command(flatten)]
    directions: FieldArguments,
    #[command(flatten)]
    layout: LayoutArguments,
    #[command(flatten)]
    machine: Machine,
}

const EXAMPLES: &str = "\
Examples:
  quadmosaic picture m6.obj -o m6.png
  quadmosaic picture m6.obj --colour quality --zoom-to 0.8,0.6,0,0.2 -o edge.svg
  quadmosaic picture example:m6 --mosaic --points 2000 --fit 1 -o tiles.png
  quadmosaic picture car.stl --field --view 1,-1,0.5 --size 2400x1600 -o field.png";

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Style {
    /// Lines that follow the field
    Streamlines,
    /// A cross here and there
    Crosses,
}

#[derive(Clone, Copy, Debug, Default, ValueEnum)]
enum Colours {
    /// The number of sides of a face
    #[default]
    Sides,
    /// Its shape; of a tile, its fit
    Quality,
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let taken: Vec<&Path> = arguments.source.path().into_iter().collect();
    expect_writable(&arguments.output, &taken)?;
    arguments.machine.start_threads()?;
    let scene = arguments.scene()?;
    let view = View {
        eye: arguments.view,
        up: arguments.up,
        zoom: arguments.zoom_to.map(|[x, y, z, radius]| ([x, y, z], radius)),
    };
    Ok(write_picture(&arguments.output, &scene, &view, arguments.size.0)?)
}

impl Arguments {
    fn scene(&self) -> anyhow::Result<Scene> {
        if self.field.is_none() && !self.mosaic {
            let paint = match self.colour {
                Colours::Sides => Paint::Sides,
                Colours::Quality => Paint::Quality,
            };
            return Ok(mesh_scene(&self.source.read_mesh()?, paint));
        }
        let options = self.layout.options(&self.directions, Options::new(Fineness::Points(self.points)))?;
        let soup = self.source.read()?;
        let (surface, sizes, count) = prepare(&soup, &options).context(self.source.to_string())?;
        let mesher = self.machine.mesher()?;
        let backend = mesher.backend();
        let field = pipeline::field(&surface, sizes, count, &options, backend)?;
        warn(warnings::of_guides(field.guides()));
        warn(warnings::of_stretch(field.stretch().map(Stretch::report)));
        Ok(match self.field {
            Some(Style::Streamlines) => field_scene(&surface, &field, FieldStyle::Streamlines),
            Some(Style::Crosses) => field_scene(&surface, &field, FieldStyle::Crosses),
            None => {
                let mosaic = pipeline::lay(&surface, &field, backend, count, &options, &|_| ())?;
                let fit = matches!(self.colour, Colours::Quality).then(|| TileQuality::of(&surface, &mosaic));
                let fit = fit.as_ref().map(|fit| fit.of_tiles.as_slice());
                mosaic_scene(&surface, &mosaic, self.grout as f32, fit)
            }
        })
    }
}

/// Some numbers with commas between them.
fn vector<const COUNT: usize>(text: &str) -> Result<[f64; COUNT], String> {
    let numbers = text.split(',').map(|number| number.trim().parse().ok().filter(|x: &f64| x.is_finite()));
    let numbers: Option<Vec<f64>> = numbers.collect();
    let refusal = || format!("write {COUNT} numbers with commas between them");
    numbers.and_then(|numbers| numbers.try_into().ok()).ok_or_else(refusal)
}

/// Width and height in pixels.
#[derive(Clone, Copy, Debug)]
struct Size([u32; 2]);

impl fmt::Display for Size {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}x{}", self.0[0], self.0[1])
    }
}

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let sides = text.split_once(['x', 'X']);
        let sides = sides.and_then(|(width, height)| Some([width.parse().ok()?, height.parse().ok()?]));
        sides.map(Self).ok_or_else(|| "write width and height in pixels, as 1600x1200".to_owned())
    }
}

pub fn grout(text: &str) -> Result<f64, String> {
    number(text, 0.0..=0.9).ok_or_else(|| "the grout is a number from 0 to 0.9, in tile sides".to_owned())
}
