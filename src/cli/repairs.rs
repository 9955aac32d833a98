//! Repairs of the surface: arguments of all commands that read one, and warnings.

use super::summary::counted;
use clap::Args;
use quadmosaic::surface::{Length, NearRims, Places, RepairOptions, Surface, shown};

#[derive(Args)]
pub struct RepairArguments {
    /// Merge points that are no farther apart than TOL, and sew open boundaries that run side by side: in model units, or as
    /// 0.001% a share of the model's diagonal, or as 0.1x in sides of a tile. Without it points are merged that differ by rounding
    #[arg(long, value_name = "TOL", help_heading = "Repairs")]
    weld: Option<Length>,
    /// Join open boundaries to the sheets that they touch, as a wall that stands in the middle of a floor's triangles. Closed
    /// walls that lie on each other, and sheets that cross, are not joined
    #[arg(long, help_heading = "Repairs")]
    imprint: bool,
    /// Drop connected parts whose bounding box has a diagonal below SIZE: in model units, or as 3x in sides of a tile, or as 1%
    /// of the model's diagonal
    #[arg(long, value_name = "SIZE", help_heading = "Repairs")]
    drop_parts: Option<Length>,
    /// Fill holes (open boundary loops) whose bounding box has a diagonal below SIZE, which is as for --drop-parts
    #[arg(long, value_name = "SIZE", help_heading = "Repairs")]
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

/// Warns of repairs that show in the mesh, and of sheets that touch or cross without being joined.
pub fn warn_of_repairs(surface: &Surface) {
    let told = |places: &Places, noun: &str, what: &str, advice: &str| {
        if let Some(place) = places.at.first() {
            eprintln!("warning: {} {what}, the first at {}; {advice}", counted(places.count, noun), shown(place));
        }
    };
    let (repairs, contacts) = (surface.repairs(), surface.contacts());
    told(&repairs.joined_edges, "edge", "of more than two triangles", "sheets meet there, in the mesh too");
    told(&repairs.dropped_specks, "part", "too small to have a shape left out", "mesh small parts apart");
    told(
        &contacts.crossing,
        "pair",
        "of triangles that cross each other",
        "sheets pass through each other there, in the mesh too; unite or trim them",
    );
    told(
        &contacts.coincident,
        "pair",
        "of triangles that lie on each other",
        "two walls stand at one place there, in the mesh too; they are not joined: remove one of them",
    );
    told(
        &contacts.touching,
        "edge",
        "of open boundaries that lie inside other triangles",
        "sheets touch there but are not joined; ask for --imprint",
    );
    if let Some(NearRims { at, gap, length, tolerance }) = &contacts.near_rims {
        eprintln!(
            "warning: open boundaries run side by side over a length of {length:.4}, with a gap of {gap:.3e} at {}; if they \
             are one, ask for --weld {tolerance}",
            shown(at)
        );
    }
}
