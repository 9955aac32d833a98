//! The method: arguments that `mesh` and `batch` share.

use super::field_arguments::FieldArguments;
use super::fineness::FinenessArguments;
use super::layout::LayoutArguments;
use clap::{Args, ValueEnum};
use quadmosaic::mesh::connect::ConnectOptions;
use quadmosaic::mesh::connectivity::{self, ConnectivityOptions};
use quadmosaic::mesh::fill;
use quadmosaic::options::{degrees, distance, up_to};
use quadmosaic::pipeline::Options;
use quadmosaic::surface::KeptBoundary;
use quadmosaic::symmetry::Symmetry;

#[derive(Args)]
pub struct MethodArguments {
    #[command(flatten)]
    fineness: FinenessArguments,
    /// Mesh the half of larger coordinates, and join its mirror image to it, bit for bit: x, y or z, the axis across which the plane
    /// lies, at 0 or at OFFSET (y:0.5); or auto, which looks for the plane. The number of vertices is that of the whole mesh
    #[arg(long, value_name = "AXIS[:OFFSET]|auto", help_heading = "Symmetry")]
    symmetry: Option<Symmetry>,
    /// Keep the vertices of the surface's open boundary, bit for bit, as those of the mesh's: patches of one surface that are meshed
    /// apart fit together. With SIZE, in model units, they are points about so far apart along the boundary, which depend on its
    /// curve alone; patches must then meet at corners of it
    #[arg(
        long,
        value_name = "SIZE",
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
    /// Do not optimise the connectivity: keep the triangles of the filling
    #[arg(long, conflicts_with = "quads", help_heading = "Connection")]
    no_cleanup: bool,
    /// Passes of vertex relocation, 0 to 1000; 0: vertices stay at the centres of tiles
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = up_to::<1000>, help_heading = "Connection")]
    smoothing: usize,

    #[command(flatten)]
    layout: LayoutArguments,
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
    /// Where a file of sizes, guides or feature edges cannot be read.
    pub fn options(&self) -> anyhow::Result<Options> {
        let rest = Options {
            symmetry: self.symmetry,
            keep_boundary: self.keep_boundary,
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
            ..Options::new(self.fineness.fineness())
        };
        self.layout.options(&self.directions, rest)
    }
}
