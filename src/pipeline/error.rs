//! Why no mesh is made.

use super::{Contradiction, LimitError, POINTS};
use crate::compute::ComputeError;
use crate::field::StretchError;
use crate::progress::Cancelled;
use crate::sizes::SizesError;
use crate::surface::{BoundaryError, SurfaceError};
use crate::symmetry::SymmetryError;
use thiserror::Error;

/// The reason why no mesh was made.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PipelineError {
    /// The surface cannot be meshed.
    #[error(transparent)]
    Surface(SurfaceError),
    /// The backend failed.
    #[error(transparent)]
    Compute(ComputeError),
    /// The surface has no symmetry as asked.
    #[error(transparent)]
    Symmetry(#[from] SymmetryError),
    /// The boundary cannot be kept as asked.
    #[error(transparent)]
    Boundary(#[from] BoundaryError),
    /// The wanted sizes are invalid.
    #[error(transparent)]
    Sizes(#[from] SizesError),
    /// Tiles cannot have the wanted aspect.
    #[error(transparent)]
    Stretch(StretchError),
    /// An option contradicts the layout.
    #[error(transparent)]
    Contradiction(#[from] Contradiction),
    /// The wanted fineness is invalid.
    #[error(transparent)]
    Fineness(#[from] FinenessError),
    /// A limit is too tight for any mesh.
    #[error(transparent)]
    Limit(#[from] LimitError),
    /// The progress function cancelled the run.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl From<SurfaceError> for PipelineError {
    fn from(error: SurfaceError) -> Self {
        match error {
            SurfaceError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            error => Self::Surface(error),
        }
    }
}

impl From<ComputeError> for PipelineError {
    fn from(error: ComputeError) -> Self {
        match error {
            ComputeError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            error => Self::Compute(error),
        }
    }
}

impl From<StretchError> for PipelineError {
    fn from(error: StretchError) -> Self {
        match error {
            StretchError::Compute(error) => error.into(),
            error => Self::Stretch(error),
        }
    }
}

/// Why a surface cannot have a wanted fineness.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum FinenessError {
    /// The number of vertices is none of [`POINTS`].
    #[error("a mesh of {asked} points cannot be made; ask for {} to {}", POINTS.start(), POINTS.end())]
    Points {
        /// The number that was asked for.
        asked: usize,
    },
    /// Tiles of the side are larger than the surface, or too many.
    #[error("tiles of side {asked} cannot cover this surface; ask for {least:.3e} to {most:.3e}, its diagonal")]
    Size {
        /// The side that was asked for, in model units.
        asked: f64,
        /// The least side, in model units.
        least: f64,
        /// The diagonal of the surface, in model units.
        most: f64,
    },
    /// Sizes are to give the number of vertices, and there are none.
    #[error("no sizes are given; give some, or ask for a number of points")]
    NoSizes,
    /// The sizes give too many vertices.
    #[error(
        "the surface takes {count:.3e} tiles of the given sizes; ask for larger ones, in model units, so that {} are enough",
        POINTS.end()
    )]
    SmallSizes {
        /// The number of tiles.
        count: f64,
    },
}
