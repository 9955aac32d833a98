//! The method: arguments that `mesh` and `batch` share.

use super::field_arguments::FieldArguments;
use super::fineness::FinenessArguments;
use super::layout::LayoutArguments;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, CommandFactory, ValueEnum, error::ErrorKind};
use quadmosaic::mesh::connect::ConnectOptions;
use quadmosaic::mesh::connectivity::{self, ConnectivityOptions};
use quadmosaic::mesh::fill;
use quadmosaic::options::{self, degrees, distance, memory, seconds, up_to};
use quadmosaic::pipeline::{Contradiction, Layout, Limits, Options};
use quadmosaic::surface::KeptBoundary;
use quadmosaic::symmetry::Symmetry;
use std::time::Duration;

#[derive(Args)]
pub struct MethodArguments {
    /// The rows of tiles: sets --fit, --rows and --quads
    ///
    /// --fit, --rows and --quads override it, each one; what contradicts it is refused. `mosaic`, the default, is best where edges are to
    /// be equal, or of given sizes, and `even` on smooth and slender surfaces where a few triangles do no harm. `quads` is best where a
    /// solver or an artist wants quads alone, with few irregular vertices
    #[arg(long, value_parser = layouts(), help_heading = "Options together")]
    layout: Option<Layout>,
    #[command(flatten)]
    fineness: FinenessArguments,
    /// Make the mesh symmetric about a plane, bit for bit
    ///
    /// The half of larger coordinates is meshed, and its mirror image is joined to it: x, y or z, the axis across which the plane lies, at
    /// 0 or at OFFSET (y:0.5); or auto, which looks for the plane. The number of vertices is that of the whole mesh
    #[arg(long, value_name = "AXIS[:OFFSET]|auto", help_heading = "Symmetry")]
    symmetry: Option<Symmetry>,
    /// Keep the vertices of the surface's open boundary, bit for bit
    ///
    /// Patches of one surface that are meshed apart then fit together. With SIZE, in model units, the vertices are points about so far
    /// apart along the boundary, which depend on its curve alone; patches must then meet at corners of it. Without, or with `exact`, they
    /// are those of the surface
    #[arg(
        long,
        value_name = "SIZE|exact",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "exact",
        conflicts_with = "symmetry",
        help_heading = "Patches"
    )]
    keep_boundary: Option<KeptBoundary>,
    #[command(flatten)]
    directions: FieldArguments,

    /// L: the longest edge, in tile sides (1 to 10)
    #[arg(long, value_name = "L", default_value_t = 1.6, value_parser = distance, help_heading = "Connection")]
    max_distance: f64,
    /// Theta: the largest angle between an edge and its row, in degrees (1 to 45)
    #[arg(
        long,
        value_name = "THETA",
        default_value_t = 30.0,
        value_parser = degrees::<45>,
        help_heading = "Connection"
    )]
    max_angle: f64,
    /// How faces with more than four sides are filled
    #[arg(long, value_enum, default_value_t, help_heading = "Connection")]
    holes: Holes,
    /// The triangles that become quads
    #[arg(long, value_enum, default_value_t, help_heading = "Connection")]
    quads: Quads,
    /// No edits of the connectivity: keep the triangles of the filling
    #[arg(long, conflicts_with = "quads", help_heading = "Connection")]
    no_cleanup: bool,
    /// Passes of vertex relocation, 0 to 1000
    ///
    /// 0: vertices stay at the centres of tiles
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = up_to::<1000>, help_heading = "Connection")]
    smoothing: usize,

    /// The most memory: a run that needs more is refused before its work
    ///
    /// In bytes, or with K, M, G or T, powers of 1024: 500M, 2G, 2GB, 2GiB, 1e9. The memory is predicted for the CPU from the number
    /// of triangles and points; the error tells what would fit
    #[arg(long, value_name = "SIZE", value_parser = memory, help_heading = "Machine")]
    max_memory: Option<u64>,
    /// The longest time, in seconds: after it the best mesh so far is written
    ///
    /// A warning tells it. Where there is no mesh yet, that is an error. Reading and writing are not counted
    #[arg(long, value_name = "SECONDS", value_parser = seconds, help_heading = "Machine")]
    time_limit: Option<Duration>,

    #[command(flatten)]
    rows: LayoutArguments,
}

#[derive(Clone, Copy, Debug, Default, ValueEnum)]
enum Holes {
    /// Split into quads and at most one triangle each
    #[default]
    Patterns,
    /// Split into triangles
    Triangles,
    /// Left as polygons
    Leave,
}

#[derive(Clone, Copy, Debug, Default, ValueEnum)]
enum Quads {
    /// Those that the paper's clean-up finds
    Paper,
    /// Those whose change improves the mesh: triangles move until they meet, short rows are inserted or removed
    #[default]
    Most,
    /// All, at some cost of shape
    All,
}

impl MethodArguments {
    /// Whether faces of more than four corners stay.
    pub fn leaves_holes(&self) -> bool {
        matches!(self.holes, Holes::Leave)
    }

    /// The options.
    ///
    /// # Errors
    /// Where options contradict the layout, or a file of sizes, guides or feature edges cannot be read.
    pub fn options(&self) -> anyhow::Result<Options> {
        let rest = Options {
            symmetry: self.symmetry,
            keep_boundary: self.keep_boundary,
            layout: self.layout.unwrap_or_default(),
            sizes: self.fineness.sizes()?,
            connect: ConnectOptions { max_distance: self.max_distance, max_angle: self.max_angle },
            holes: match self.holes {
                Holes::Patterns => fill::Holes::Patterns,
                Holes::Triangles => fill::Holes::Triangles,
                Holes::Leave => fill::Holes::Leave,
            },
            connectivity: (!self.no_cleanup).then(|| ConnectivityOptions {
                quads: match self.quads {
                    Quads::Paper => connectivity::Quads::Paper,
                    Quads::Most => connectivity::Quads::Most,
                    Quads::All => connectivity::Quads::All,
                },
                ..ConnectivityOptions::default()
            }),
            smoothing: self.smoothing,
            limits: Limits { memory: self.max_memory, time: self.time_limit },
            ..Options::new(self.fineness.fineness())
        };
        let options = self.rows.options(&self.directions, rest)?;
        let refused = Contradiction::expect_none(&options);
        refused.map_err(|error| super::Arguments::command().error(ErrorKind::ArgumentConflict, error))?;
        Ok(options)
    }
}

/// The names of layouts, with what they are.
fn layouts() -> impl TypedValueParser<Value = Layout> {
    let value = |layout: Layout| PossibleValue::new(layout.name()).help(layout.purpose());
    PossibleValuesParser::new(Layout::ALL.map(value)).try_map(|name| options::layout(&name))
}
