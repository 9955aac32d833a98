//! Options that had no effect.

use super::Sides;
use crate::pipeline::Options;
use crate::surface::Surface;
use serde::Serialize;
use std::fmt;

/// An option that differs from its default and had no effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Ineffective {
    /// The range of sides that fit the field: no side was to.
    FitRange,
    /// The growth of edges: all tiles have the same side.
    MaxGrowth,
    /// The borders of regions, not to be kept: there are none.
    IgnoreRegions,
    /// The boundary, to be kept: there is none.
    KeepBoundary,
}

impl Ineffective {
    /// Those of a run: `surface` is the whole surface, `sides` are those of the tiles.
    pub(super) fn of(options: &Options, surface: &Surface, sides: Option<Sides>) -> Vec<Self> {
        let default = Options::new(options.fineness);
        let is_equal = sides.is_some_and(|sides| sides.growth == 1.0);
        let found = [
            (Self::FitRange, options.fit_range != default.fit_range && options.fit == 0.0),
            (Self::MaxGrowth, options.sizes.growth != default.sizes.growth && is_equal),
            (Self::IgnoreRegions, !options.features.region_borders && surface.regions().names.is_empty()),
            (Self::KeepBoundary, options.keep_boundary.is_some() && !surface.keeps_boundary()),
        ];
        found.into_iter().filter(|(_, is_so)| *is_so).map(|(option, _)| option).collect()
    }
}

impl fmt::Display for Ineffective {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::FitRange => "the fit range had no effect, as sides do not fit the field; it goes with a fit, or a layout that has one",
            Self::MaxGrowth => "the largest growth had no effect, as all tiles have the same side; it goes with sizes, curvature and a fit",
            Self::IgnoreRegions => "ignoring regions had no effect, as the surface has none",
            Self::KeepBoundary => "keeping the boundary had no effect, as the surface has none",
        })
    }
}
