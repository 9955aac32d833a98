//! Whether rows end: arguments that `mesh` and `mosaic` share.

use super::mesh::number;
use clap::{Args, ValueEnum};
use quadmosaic::mosaic::Rows;

#[derive(Args)]
pub struct Weave {
    /// Whether rows of tiles may end inside the surface
    #[arg(long = "rows", value_name = "KIND", default_value = "paper", help_heading = "Rows")]
    row_ends: RowEnds,
    /// How far the sides of tiles follow the field so that fewer rows end, from 0 (equal tiles, or the asked sizes) to 1
    #[arg(long, value_name = "DIAL", default_value_t = 0.0, value_parser = dial, help_heading = "Rows")]
    pub fit: f64,
    /// The largest side over the mean one, and the mean over the smallest, that --fit may ask for
    #[arg(long, value_name = "FACTOR", default_value_t = 2.5, value_parser = range, help_heading = "Rows")]
    pub fit_range: f64,
}

#[derive(Clone, Copy, Debug, Default, ValueEnum)]
enum RowEnds {
    /// They end where equal tiles, or the asked sizes, need it
    #[default]
    Paper,
    /// They pass over the whole surface but for singularities of the field, and sizes give way: few irregular vertices
    Continuous,
}

impl Weave {
    /// Whether rows may end.
    pub fn rows(&self) -> Rows {
        match self.row_ends {
            RowEnds::Paper => Rows::Paper,
            RowEnds::Continuous => Rows::Continuous,
        }
    }
}

fn dial(text: &str) -> Result<f64, String> {
    number(text, 0.0..=1.0).ok_or_else(|| "the dial is a number from 0 to 1".to_owned())
}

fn range(text: &str) -> Result<f64, String> {
    number(text, 1.01..=10.0).ok_or_else(|| "the factor is a number from 1.01 to 10".to_owned())
}
