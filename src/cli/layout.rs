//! The layout of rows: arguments that `mesh`, `mosaic`, `picture` and `study` share.

use super::field_arguments::FieldArguments;
use super::numbers::number;
use super::summary;
use clap::{Args, ValueEnum};
use quadmosaic::field::{ASPECTS, StretchReport};
use quadmosaic::parametrize::Rows;
use quadmosaic::pipeline::Options;

#[derive(Args)]
pub struct LayoutArguments {
    /// Whether rows of tiles may end inside the surface
    #[arg(long = "rows", value_name = "KIND", default_value = "paper", help_heading = "Rows")]
    row_ends: RowEnds,
    /// The degree to which the sides of tiles follow the field so that fewer rows end, from 0 (equal tiles, or the wanted sizes)
    /// to 1
    #[arg(long, value_name = "DIAL", default_value_t = 0.0, value_parser = dial, help_heading = "Rows")]
    pub fit: f64,
    /// The largest side over the mean one, and the mean over the smallest, that --fit may ask for
    #[arg(long, value_name = "FACTOR", default_value_t = 2.5, value_parser = range, help_heading = "Rows")]
    pub fit_range: f64,
    /// Rectangular tiles: their longer side, which lies along the guides, over the shorter one (1 to 20), the area being that
    /// of the square. Needs a guide; where the field has no direction but a cross, about singularities of a quarter turn, tiles
    /// are squares. Not with --fit
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

/// Warns where tiles do not have the wanted aspect.
pub fn warn_of_stretch(stretch: Option<&StretchReport>) {
    let Some(&StretchReport { aspect, odd_singularities, nearly_square, unguided }) = stretch else { return };
    let percent = |share: f64| format!("{:.1} %", 100.0 * share);
    if nearly_square > 0.0 {
        eprintln!(
            "warning: on {} of the area tiles are squares or nearly so instead of {aspect} to 1: {}",
            percent(nearly_square),
            match odd_singularities {
                0 => "guides contradict each other there".to_owned(),
                count => format!(
                    "the field is only a cross about {}, which have no longer side; guides may move or remove them",
                    summary::counted(count, "point")
                ),
            }
        );
    }
    if unguided > 0.0 {
        eprintln!(
            "warning: no guide reaches {} of the area, whose tiles are squares; give each part of the surface a guide",
            percent(unguided)
        );
    }
}

fn aspect(text: &str) -> Result<f64, String> {
    number(text, ASPECTS).ok_or_else(|| {
        format!(
            "the aspect is the longer side over the shorter one, a number from {} to {}; guides say which side is longer",
            ASPECTS.start(),
            ASPECTS.end()
        )
    })
}

pub fn dial(text: &str) -> Result<f64, String> {
    number(text, 0.0..=1.0).ok_or_else(|| "the dial is a number from 0 to 1".to_owned())
}

fn range(text: &str) -> Result<f64, String> {
    number(text, 1.01..=10.0).ok_or_else(|| "the factor is a number from 1.01 to 10".to_owned())
}
