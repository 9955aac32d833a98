//! The rows that a surface can carry, in the layout of quads alone.
//!
//! # Theory
//! Rows that pass over the whole surface are squeezed where features are near each other. The parametrization shows how much
//! before there is a mesh: by its [`Distortion`](crate::parametrize::Distortion). Sides that fit the field make it less on smooth
//! surfaces, and more between near features. Where it is too large either way, rows end in pairs of vertices of valence 3 and 5.

use super::clock::Clock;
use super::{Layout, Options, PipelineError, builder, field, lay_by};
use crate::compute::Backend;
use crate::field::Field;
use crate::mosaic::{Mosaic, MosaicBuilder};
use crate::parametrize::Rows;
use crate::progress::Stage;
use crate::sizes::Sizes;
use crate::surface::Surface;
use std::borrow::Cow;

/// The cost of a distortion from which on rows end (docs/experiments.md, parametrization).
const SQUEEZED: f64 = 0.5;

/// How rows differ from those that the layout asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fallback {
    /// It is not known yet.
    Unknown,
    /// Not at all.
    None,
    /// Sides are equal.
    EqualSides,
    /// Sides are equal, and rows end.
    RowEnds,
}

/// What an earlier mesh of nearly the same surface tells.
#[derive(Clone, Copy, Debug)]
pub(super) struct Carried {
    /// Whether tiles are smaller than its own at its faults.
    pub is_refined: bool,
    /// How its rows differ from those that the layout asks for.
    pub fallback: Fallback,
    /// See [`MosaicBuilder::first_scale`](crate::mosaic::MosaicBuilder::first_scale).
    pub first_scale: Option<f64>,
}

impl Carried {
    /// Nothing.
    pub(super) const UNKNOWN: Self = Self { is_refined: false, fallback: Fallback::Unknown, first_scale: None };
}

impl Fallback {
    /// The options with these rows.
    pub(super) fn applied(self, options: &Options) -> Cow<'_, Options> {
        match self {
            Self::Unknown | Self::None => Cow::Borrowed(options),
            Self::EqualSides => Cow::Owned(Options { fit: 0.0, ..options.clone() }),
            Self::RowEnds => Cow::Owned(Options { fit: 0.0, rows: Rows::Paper, ..options.clone() }),
        }
    }
}

/// The field and the mosaic of `aim` tiles for a mesh of `count` vertices, with the rows that the surface can carry; their
/// fallback is chosen where it is unknown. Begins the stages of both.
///
/// # Errors
/// Where the backend fails, or tiles cannot have the wanted aspect.
pub(super) fn lay_carried(
    surface: &Surface,
    sizes: &Sizes,
    [count, aim]: [usize; 2],
    carried: &mut Carried,
    options: &Options,
    backend: &dyn Backend,
    clock: &mut Clock,
) -> Result<(Field, Mosaic), PipelineError> {
    let progress = clock.progress;
    let advance = |share| progress.advance(share);
    let field_of = |fallback: Fallback| field(surface, sizes.clone(), count, &fallback.applied(options), backend);
    let laid = |fallback: Fallback, field: &Field, first_scale, is_trial, trial| {
        let options = &*fallback.applied(options);
        let builder = MosaicBuilder { first_scale, is_trial, ..builder(surface, field, backend, options, &advance) };
        lay_by(&builder, options, aim, trial)
    };
    let is_open = carried.fallback == Fallback::Unknown && options.layout == Layout::Quads;

    clock.begin(Stage::Field)?;
    let fitted = field_of(carried.fallback)?;

    clock.begin(Stage::Mosaic)?;
    let mosaic = laid(carried.fallback, &fitted, carried.first_scale, is_open, None)?;
    if is_open {
        carried.fallback = Fallback::None;
    }
    if !is_open || !mosaic.is_folded() {
        return Ok((fitted, mosaic));
    }
    let equal = field_of(Fallback::EqualSides)?;
    let other = laid(Fallback::EqualSides, &equal, None, true, None)?;
    let (fallback, field, trial) = if mosaic.cost().min(other.cost()) > SQUEEZED {
        (Fallback::RowEnds, field_of(Fallback::RowEnds)?, None)
    } else if other.cost() < mosaic.cost() {
        (Fallback::EqualSides, equal, Some(other))
    } else {
        (Fallback::None, fitted, Some(mosaic))
    };
    carried.fallback = fallback;
    let mosaic = match trial {
        Some(trial) if !trial.is_folded() => trial,
        trial => laid(fallback, &field, None, false, trial)?,
    };
    Ok((field, mosaic))
}
