//! The layout of rows: arguments that `mesh`, `mosaic`, `picture` and `study` share.

use super::field_arguments::FieldArguments;
use clap::{Args, ValueEnum};
use quadmosaic::options::{aspect, dial, factor};
use quadmosaic::parametrize::Rows;
use quadmosaic::pipeline::Options;

#[derive(Args)]
pub struct LayoutArguments {
    /// Whether rows of tiles may end inside the surface
    #[arg(long = "rows", value_name = "KIND", default_value = "paper", help_heading = "Rows")]
    row_ends: RowEnds,
    /// How far sides follow the field, so that fewer rows end (0 to 1)
    ///
    /// 0: tiles are equal, or have the wanted sizes
    #[arg(long, value_name = "DIAL", default_value_t = 0.0, value_parser = dial, help_heading = "Rows")]
    pub fit: f64,
    /// The largest side over the mean one that --fit may ask for
    ///
    /// The same number bounds the mean side over the smallest one
    #[arg(long, value_name = "FACTOR", default_value_t = 2.5, value_parser = factor, help_heading = "Rows")]
    pub fit_range: f64,
    /// Rectangular tiles: the longer side over the shorter (1 to 20)
    ///
    /// The longer side lies along the guides, of which there must be one; the area is that of the square. Where the field has no direction
    /// but a cross, about singularities of a quarter turn, tiles are squares. Not with --fit
    #[arg(long, value_name = "RATIO", default_value_t = 1.0, value_parser = aspect, help_heading = "Rows")]
    pub aspect: f64,
}

#[derive(Clone, Copy, Debug, Default, ValueEnum)]
enum RowEnds {
    /// They end where equal tiles, or the wanted sizes, need it
    #[default]
    Paper,
    /// They end nowhere but at singularities of the field, and sizes vary: few irregular vertices
    Continuous,
}

impl LayoutArguments {
    /// Options with this layout and these directions, and the rest as given.
    ///
    /// # Errors
    /// Where a file of guides or of feature edges cannot be read.
    pub fn options(&self, directions: &FieldArguments, rest: Options) -> anyhow::Result<Options> {
        Ok(Options {
            features: directions.features(),
            repairs: directions.repairs(),
            edges: directions.edges()?,
            field: directions.field()?,
            rows: self.rows(),
            fit: self.fit,
            fit_range: self.fit_range,
            aspect: self.aspect,
            ..rest
        })
    }

    /// Whether rows may end.
    pub fn rows(&self) -> Rows {
        match self.row_ends {
            RowEnds::Paper => Rows::Paper,
            RowEnds::Continuous => Rows::Continuous,
        }
    }
}
