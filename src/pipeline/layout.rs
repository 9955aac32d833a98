//! The layout of the tiles' rows, and the options that contradict it.

use super::Options;
use crate::mesh::connectivity::Quads;
use crate::mesh::fill::Holes;
use thiserror::Error;

/// The layout of the tiles' rows.
///
/// # Practice
/// [`Layout::Mosaic`] is best where edges must be equal, or of given sizes; [`Layout::Even`] on smooth and slender surfaces, where a
/// few triangles do no harm. [`Layout::Quads`] is best where a solver or an artist wants quads alone, with few irregular vertices.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Layout {
    /// The paper's equal tiles; rows end where the surface narrows.
    #[default]
    Mosaic,
    /// Sides that fit the field; few rows end, in few triangles.
    Even,
    /// Quads alone, in rows that never end, with sides that fit the field; equal sides, or rows that end, where the surface is too
    /// narrow for that.
    Quads,
}

impl Layout {
    /// All layouts.
    pub const ALL: [Self; 3] = [Self::Mosaic, Self::Even, Self::Quads];

    /// The name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Mosaic => "mosaic",
            Self::Even => "even",
            Self::Quads => "quads",
        }
    }
}

/// Why an option contradicts the layout.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum Contradiction {
    /// The layout is [`Layout::Quads`], and triangles are to stay.
    #[error(
        "the layout quads has no triangles, but quads {0} keeps some; leave out one of them, or ask for the layout even"
    )]
    Triangles(&'static str),
    /// The layout is [`Layout::Quads`], and the connectivity is to stay.
    #[error("the layout quads needs the clean-up, which removes triangles; allow it, or ask for the layout even")]
    NoCleanUp,
    /// The layout is [`Layout::Quads`], and faces of more than four corners are to stay.
    #[error("the layout quads has no polygons, but holes leave keeps some; leave out one of them")]
    Polygons,
    /// The layout is [`Layout::Even`], and sides are not to fit the field.
    #[error("the layout even has sides that fit the field, but fit 0 makes them equal; leave out one of them")]
    EqualSides,
    /// Sides are to fit the field, and tiles to be rectangles.
    #[error(
        "the layout {0} has sides that fit the field, which rectangular tiles do not; leave out the aspect, or ask for the layout mosaic"
    )]
    Rectangles(&'static str),
}

impl Contradiction {
    /// The first contradiction of options, as the error.
    ///
    /// # Errors
    /// Where there is one.
    pub fn expect_none(options: &Options) -> Result<(), Self> {
        let Options { layout, fit, aspect, holes, connectivity, .. } = options;
        match (layout, connectivity) {
            (Layout::Quads, None) => return Err(Self::NoCleanUp),
            (Layout::Quads, Some(connectivity)) if connectivity.quads != Quads::All => {
                return Err(Self::Triangles(connectivity.quads.name()));
            }
            (Layout::Quads, _) if *holes == Holes::Leave => return Err(Self::Polygons),
            (Layout::Even, _) if *fit == 0.0 => return Err(Self::EqualSides),
            _ => {}
        }
        let is_fitted = *layout != Layout::Mosaic && *fit != 0.0;
        if is_fitted && *aspect != 1.0 { Err(Self::Rectangles(layout.name())) } else { Ok(()) }
    }
}
