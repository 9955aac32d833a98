//! `quadmosaic example`.

use super::input;
use super::mesh_output::MeshOutput;
use super::output::{expect_writable, print_beside};
use clap::{Args, CommandFactory, error::ErrorKind};
use quadmosaic::export::MeshFile;
use quadmosaic::mesh::Mesh;
use quadmosaic::options::positive;
use quadmosaic::surface::examples::{Example, M6Options};

/// Writes an example surface as triangles
///
/// m6: the ONERA M6 wing, a half with an open root, in metres; torus: radii 1 and 0.4; sphere: radius 1; plate: the unit
/// square with a round hole; block: a box with a bore; flange: a ring with bolt holes.
#[derive(Args)]
pub struct Arguments {
    /// The example: m6, torus, sphere, plate, block or flange
    #[arg(value_parser = <Example as std::str::FromStr>::from_str)]
    example: Example,
    /// About how many triangles
    #[arg(long, value_name = "N", default_value_t = Example::DEFAULT_TRIANGLES, value_parser = input::triangles)]
    triangles: usize,
    /// m6 only: keep the published blunt trailing edge (default: sharp)
    #[arg(long)]
    blunt: bool,
    /// m6 only: close the tip by a flat face (default: round)
    #[arg(long)]
    flat_tip: bool,
    /// m6 only: both halves, closed (default: one half, open at the root)
    #[arg(long)]
    whole_span: bool,
    /// Move each coordinate of the vertices at random by up to SIZE, as in a scan
    #[arg(long, value_name = "SIZE", value_parser = positive)]
    noise: Option<f64>,
    #[command(flatten)]
    output: MeshOutput,
}

pub fn run(arguments: Arguments) -> anyhow::Result<()> {
    let Arguments { example, triangles, blunt, flat_tip, whole_span, noise, output } = arguments;
    let options = M6Options { blunt, flat_tip, whole_span };
    let example = match example {
        Example::M6(_) => Example::M6(options),
        other if options == M6Options::default() => other,
        _ => {
            let message = "--blunt, --flat-tip and --whole-span go with the example m6 only";
            return Err(super::Arguments::command().error(ErrorKind::ArgumentConflict, message).into());
        }
    };
    output.format()?;
    output.path().map_or(Ok(()), |path| expect_writable(path, &[]))?;
    let mesh = Mesh::from(example.generate(triangles).with_noise(noise.unwrap_or(0.0)));
    output.write(&MeshFile::from(&mesh))?;
    let text = format!("{}: {} triangles, {} vertices\n", output.output, mesh.face_count(), mesh.points.len());
    print_beside([&output.output], &text)
}
