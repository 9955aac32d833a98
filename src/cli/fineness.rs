//! How fine the mesh is to be: arguments that `mesh` and `field` share.

use super::mesh::positive;
use clap::Args;
use quadmosaic::pipeline::{Fineness, POINTS};

#[derive(Args)]
pub struct Wanted {
    /// Number of vertices wanted, 4 to 50000000 [default: 6000]
    #[arg(long, value_name = "N", value_parser = points, conflicts_with = "size", help_heading = "Fineness")]
    points: Option<usize>,
    /// Instead of --points: the edge length wanted, in model units
    #[arg(long, value_name = "H", value_parser = positive, help_heading = "Fineness")]
    size: Option<f64>,
}

impl Wanted {
    /// The default where nothing is asked for.
    pub fn fineness(&self) -> Fineness {
        match (self.points, self.size) {
            (_, Some(size)) => Fineness::Size(size),
            (points, None) => Fineness::Points(points.unwrap_or(6000)),
        }
    }
}

/// A number of vertices that can be asked for.
pub fn points(text: &str) -> Result<usize, String> {
    let refusal = || format!("ask for {} to {} vertices", POINTS.start(), POINTS.end());
    text.parse().ok().filter(|count| POINTS.contains(count)).ok_or_else(refusal)
}
