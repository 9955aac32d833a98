//! The constraints of the field: arguments that `mesh`, `field`, `mosaic`, `picture` and `study` share.

use super::features::FeatureArguments;
use super::repairs::RepairArguments;
use clap::Args;
use quadmosaic::field::{Align, FieldOptions, Guide, read_guides};
use quadmosaic::options::{align, degrees};
use quadmosaic::surface::{FeatureOptions, NamedEdge, RepairOptions};
use std::path::PathBuf;

#[derive(Args)]
pub struct FieldArguments {
    #[command(flatten)]
    features: FeatureArguments,
    #[command(flatten)]
    repairs: RepairArguments,
    /// Turn within a tile from which a smooth surface has a ridge
    ///
    /// The line of sharpest turn, as on the nose of a wing, then carries a row. In degrees (1 to 180); 180: none does
    #[arg(long, value_name = "ANGLE", default_value_t = 60.0, value_parser = degrees::<180>, help_heading = "Rows")]
    ridge: f64,
    /// Rows run along DX,DY,DZ near X,Y,Z
    ///
    /// Within the distance R. Without a weight W they do so exactly; a weight of 1 is about as strong as the surroundings, 10 nearly exact.
    /// May be given many times
    #[arg(long = "guide", value_name = "X,Y,Z,DX,DY,DZ[,R[,W]]", allow_hyphen_values = true, help_heading = "Rows")]
    guides: Vec<Guide>,
    /// Guides from a file
    ///
    /// CSV, one a line, the columns as for --guide or named by a header (x, y, z, dx, dy, dz, radius, weight); or JSON with strokes too:
    /// {"guides": [{"point": [X,Y,Z], "direction": [DX,DY,DZ]}], "strokes": [{"points": [[X,Y,Z], ...]}]}, each perhaps with "radius" and
    /// "weight"
    #[arg(long = "guides", value_name = "FILE", help_heading = "Rows")]
    guide_files: Vec<PathBuf>,
    /// Rows along the directions of curvature
    ///
    /// Those of greatest and least curvature, where no guide and no feature is; WEIGHT: 1 is moderate, 0 off
    #[arg(long, value_name = "curvature:WEIGHT", value_parser = align, help_heading = "Rows")]
    align: Option<Align>,
}

impl FieldArguments {
    /// The options of features.
    pub fn features(&self) -> FeatureOptions {
        FeatureOptions { ridge: self.ridge, ..self.features.options() }
    }

    /// The edges that are features at any angle.
    ///
    /// # Errors
    /// Where a file of edges cannot be read.
    pub fn edges(&self) -> anyhow::Result<Vec<NamedEdge>> {
        self.features.edges()
    }

    /// The repairs of the surface.
    pub fn repairs(&self) -> RepairOptions {
        self.repairs.options()
    }

    /// The constraints of the field beside features.
    ///
    /// # Errors
    /// Where a file of guides cannot be read.
    pub fn field(&self) -> anyhow::Result<FieldOptions> {
        let number = |(at, guide): (usize, &Guide)| guide.clone().named(format!("--guide number {}", at + 1));
        let mut guides: Vec<Guide> = self.guides.iter().enumerate().map(number).collect();
        for file in &self.guide_files {
            guides.extend(read_guides(file)?);
        }
        Ok(FieldOptions { guides, align: self.align, ..FieldOptions::default() })
    }
}
