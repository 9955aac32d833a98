//! The fineness of the mesh: arguments that `mesh`, `field` and `mosaic` share.

use clap::Args;
use quadmosaic::options::{degrees, growth, points, positive, up_to};
use quadmosaic::pipeline::Fineness;
use quadmosaic::sizes::{LocalSize, SizeOptions, read_sizes};
use std::path::PathBuf;

#[derive(Args)]
pub struct FinenessArguments {
    /// Number of vertices wanted, 4 to 50000000 [default: 6000]
    #[arg(long, value_name = "N", value_parser = points, conflicts_with = "size", help_heading = "Fineness")]
    points: Option<usize>,
    /// The edge length wanted, in model units, instead of --points
    #[arg(long, value_name = "H", value_parser = positive, help_heading = "Fineness")]
    size: Option<f64>,
    /// Edge lengths at points, spread over the surface
    ///
    /// CSV, one point a line (x, y, z, size, or named by a header), or PLY whose vertices have a property size. In model units; with
    /// --points or --size they are relative, and the number of vertices is as asked
    #[arg(long, value_name = "FILE", help_heading = "Fineness")]
    size_field: Option<PathBuf>,
    /// Smaller edges where the surface is curved
    ///
    /// It turns by at most this angle within an edge, in degrees (1 to 90); edges are at least a quarter of the others [default without a
    /// value: 20]
    #[arg(
        long,
        value_name = "DEGREES",
        value_parser = degrees::<90>,
        num_args = 0..=1,
        default_missing_value = "20",
        help_heading = "Fineness"
    )]
    refine_curvature: Option<f64>,
    /// Largest ratio of two edges beside each other (1.01 to 10)
    ///
    /// It counts where edges are not all equal
    #[arg(long, value_name = "RATIO", default_value_t = 1.2, value_parser = growth, help_heading = "Fineness")]
    max_growth: f64,
    /// The least number of edges round thin parts and holes
    ///
    /// Edges are smaller there, down to a tenth. 0 to 100; 0: any
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = up_to::<100>, help_heading = "Fineness")]
    around: usize,
    /// The largest edge at a place, as ridges:0.003
    ///
    /// PLACE:SIZE or PLACE:SIZE:GROWTH, in model units, many times. A place is features, boundaries, creases, ridges, two corners of a box
    /// as 0,0,0,1,2,3, or the name of a region. Away from it edges grow by GROWTH, or --max-growth
    #[arg(long, value_name = "PLACE:SIZE", allow_hyphen_values = true, help_heading = "Fineness")]
    size_at: Vec<LocalSize>,
    /// The least number of edges round each round hole (0 to 1000)
    ///
    /// Also round other closed features that are round. They get just so many where others would be fewer, or up to a fifth more (about
    /// as many above 16,000 points and with --layout quads). 0: any
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = up_to::<1000>, help_heading = "Fineness")]
    around_holes: usize,
    /// The least edge length, in model units, whatever else asks for shorter ones
    #[arg(long, value_name = "H", value_parser = positive, help_heading = "Fineness")]
    min_size: Option<f64>,
    /// The largest edge length, in model units; the number of vertices rises for it
    #[arg(long, value_name = "H", value_parser = positive, help_heading = "Fineness")]
    max_size: Option<f64>,
}

impl FinenessArguments {
    /// The wanted fineness; 6,000 vertices by default.
    pub fn fineness(&self) -> Fineness {
        match (self.points, self.size) {
            (_, Some(size)) => Fineness::Size(size),
            (None, None) if self.size_field.is_some() => Fineness::Sampled,
            (points, None) => Fineness::Points(points.unwrap_or(6000)),
        }
    }

    /// The wanted sizes of edges.
    ///
    /// # Errors
    /// Where the file of sizes cannot be read.
    pub fn sizes(&self) -> anyhow::Result<SizeOptions> {
        let samples = self.size_field.as_deref().map(read_sizes).transpose()?.unwrap_or_default();
        Ok(SizeOptions {
            samples,
            curvature: self.refine_curvature,
            growth: self.max_growth,
            around: self.around as f64,
            local: self.size_at.clone(),
            around_holes: self.around_holes,
            least: self.min_size,
            largest: self.max_size,
        })
    }
}
