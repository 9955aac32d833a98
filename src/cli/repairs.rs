//! Repairs of the surface: arguments of all commands that read one.

use clap::Args;
use quadmosaic::surface::{Length, RepairOptions};

#[derive(Args)]
pub struct RepairArguments {
    /// Merge points, and sew open boundaries, no farther apart than TOL
    ///
    /// In model units, or as 0.001% a share of the model's diagonal, or as 0.1x in sides of a tile. Without it points are merged that
    /// differ by rounding
    #[arg(long, value_name = "TOL", allow_hyphen_values = true, help_heading = "Repairs")]
    weld: Option<Length>,
    /// Join open boundaries to the sheets that they touch
    ///
    /// As a wall that stands in the middle of a floor's triangles. Closed walls that lie on each other, and sheets that cross, are not
    /// joined
    #[arg(long, help_heading = "Repairs")]
    imprint: bool,
    /// Drop connected parts smaller than SIZE
    ///
    /// Those whose bounding box has a diagonal below SIZE: in model units, or as 3x in sides of a tile, or as 1% of the model's diagonal
    #[arg(long, value_name = "SIZE", allow_hyphen_values = true, help_heading = "Repairs")]
    drop_parts: Option<Length>,
    /// Fill holes (open boundary loops) smaller than SIZE
    ///
    /// Those whose bounding box has a diagonal below SIZE, which is as for --drop-parts
    #[arg(long, value_name = "SIZE", allow_hyphen_values = true, help_heading = "Repairs")]
    fill_holes: Option<Length>,
}

impl RepairArguments {
    /// The options of repairs.
    pub fn options(&self) -> RepairOptions {
        RepairOptions {
            weld: self.weld,
            imprint: self.imprint,
            drop_parts: self.drop_parts,
            fill_holes: self.fill_holes,
        }
    }
}
