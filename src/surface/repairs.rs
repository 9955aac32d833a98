//! Repairs that can be asked for, and those that were made, between soup and surface.

use super::SurfaceError;
use serde::Serialize;
use std::str::FromStr;
use thiserror::Error;

/// Places that are kept.
const PLACES: usize = 10;

/// Distances below this, in diagonals of the bounding box, are none between sheets: some tens of steps of f32.
pub(super) const TOUCH: f64 = 2e-6;

/// The largest tolerance of welding, in diagonals of the bounding box: a larger one would leave no shape.
const MOST_WELD: f64 = 0.05;

/// A length, in one of three units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Length {
    /// In model units.
    Model(f64),
    /// In diagonals of the model's bounding box.
    Diagonals(f64),
    /// In sides of a tile.
    Tiles(f64),
}

impl Length {
    /// The length in diagonals of the bounding box; `diagonal` and the side of a tile are in model units.
    pub(super) fn in_diagonals(self, diagonal: f64, side: f64) -> f64 {
        match self {
            Self::Model(length) => length / diagonal,
            Self::Diagonals(share) => share,
            Self::Tiles(count) => count * side / diagonal,
        }
    }
}

/// A text is no [`Length`].
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[error("write a number above 0: 0.1 in model units, 0.001% of the model's diagonal, or 3x the side of a tile")]
pub struct LengthError;

impl FromStr for Length {
    type Err = LengthError;

    /// `0.1`: model units; `0.001%`: a share of the diagonal; `3x`: sides of a tile.
    fn from_str(text: &str) -> Result<Self, LengthError> {
        let (number, unit): (&str, fn(f64) -> Self) = match (text.strip_suffix('%'), text.strip_suffix('x')) {
            (Some(percent), _) => (percent, |percent| Self::Diagonals(percent / 100.0)),
            (_, Some(count)) => (count, Self::Tiles),
            _ => (text, Self::Model),
        };
        let number = number.parse::<f64>().ok().filter(|number| number.is_finite() && *number > 0.0);
        number.map(unit).ok_or(LengthError)
    }
}

/// The repairs that change the shape or the topology of the input. None is made by default.
///
/// They are made in the order of the fields, on welded points and before features are looked for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RepairOptions {
    /// Points no farther apart than this are merged, and rims are sewn: a vertex on an open boundary is inserted in the edges of
    /// other open boundaries that are no farther from it. `None`: points are merged that differ by rounding alone.
    pub weld: Option<Length>,
    /// Open boundaries that lie on triangles are joined to them: the triangles are divided so that the sheets meet in common
    /// edges. Closed walls that lie on each other and sheets that cross are not joined.
    pub imprint: bool,
    /// Connected parts with a bounding box whose diagonal is shorter than this are dropped.
    pub drop_parts: Option<Length>,
    /// Open boundary loops with a bounding box whose diagonal is shorter than this are filled with triangles.
    pub fill_holes: Option<Length>,
}

/// The lengths of [`RepairOptions`], in diagonals of the bounding box.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Limits {
    pub weld: Option<f64>,
    pub drop_parts: Option<f64>,
    pub fill_holes: Option<f64>,
}

impl Limits {
    /// The lengths of the options; `diagonal` and the side of a tile are in model units.
    ///
    /// # Errors
    /// Where a length is none.
    pub fn new(options: &RepairOptions, diagonal: f64, side: f64) -> Result<Self, SurfaceError> {
        let limit = |name, length: Option<Length>, most: f64| {
            let Some(length) = length.map(|length| length.in_diagonals(diagonal, side)) else { return Ok(None) };
            let is_length = length > 0.0 && length <= most;
            if is_length { Ok(Some(length)) } else { Err(SurfaceError::RepairLength { name, length, most }) }
        };
        Ok(Self {
            // Rims are joined to sheets from this distance on, and no two points may be nearer.
            weld: match limit("welding", options.weld, MOST_WELD)? {
                Some(weld) => Some(weld),
                None => options.imprint.then_some(TOUCH),
            },
            drop_parts: limit("dropping parts", options.drop_parts, f64::MAX)?,
            fill_holes: limit("filling holes", options.fill_holes, f64::MAX)?,
        })
    }
}

/// The number of things of one kind, and where they are.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Places {
    /// How many.
    pub count: usize,
    /// Where, in model units: the first ten places.
    pub at: Vec<[f64; 3]>,
}

impl Places {
    /// Counts one more.
    pub(super) fn note(&mut self, place: impl FnOnce() -> [f64; 3]) {
        self.count += 1;
        if self.at.len() < PLACES {
            self.at.push(place());
        }
    }
}

/// Repairs made between soup and surface.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Repairs {
    /// Points that were joined to another at the same place.
    pub welded_points: Places,
    /// Vertices on rims that were inserted in the edges of rims beside them by [`RepairOptions::weld`].
    pub sewn_vertices: Places,
    /// The largest distance, in model units, over which points were joined or rims sewn.
    pub largest_gap: f64,
    /// Edges on rims that were joined to the triangles they lie on by [`RepairOptions::imprint`].
    pub imprinted_edges: Places,
    /// Points that no triangle uses.
    pub unused_points: Places,
    /// Triangles without area that were dropped: two of their corners are one.
    pub degenerate_triangles: Places,
    /// Triangles that were given more than once, orientation aside.
    pub duplicate_triangles: Places,
    /// Parts smaller than a hundred-thousandth of the model's size, which were dropped.
    pub dropped_specks: Places,
    /// Parts that were dropped by [`RepairOptions::drop_parts`].
    pub dropped_parts: Places,
    /// Open boundary loops that were filled by [`RepairOptions::fill_holes`].
    pub filled_holes: Places,
    /// Triangles that were reversed.
    pub flipped_triangles: Places,
    /// Edges of more than two triangles: sheets end there, and the mesh is joined again along them.
    pub joined_edges: Places,
    /// Vertices that were added because several fans of triangles touch in one place; the mesh is joined again there.
    pub joined_vertices: Places,
    /// Triangles without height whose longest edge was exchanged for the other diagonal.
    pub flipped_caps: Places,
}
