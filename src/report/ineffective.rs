//! Options that had no effect.

use super::Tiles;
use crate::pipeline::{Fineness, Options};
use crate::surface::{Repairs, Surface};
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
    /// The angle within an edge: all tiles have the same side.
    RefineCurvature,
    /// The number of edges round thin parts: all tiles have the same side.
    Around,
    /// The number of edges round holes: all tiles have the same side.
    AroundHoles,
    /// Sizes at places: all tiles have the same side.
    SizeAt,
    /// The least edge: all tiles have the same side.
    MinSize,
    /// The largest edge: all tiles have the same side, and are as many as asked for.
    MaxSize,
    /// The tolerance of welding: no point was merged, and no rim sewn.
    Weld,
    /// The joining of rims to sheets: none was joined.
    Imprint,
    /// The size of parts to be dropped: none is so small.
    DropParts,
    /// The size of holes to be filled: none is so small.
    FillHoles,
}

impl Ineffective {
    /// Those of a run: `surface` is the whole surface.
    pub(super) fn of(options: &Options, surface: &Surface, tiles: &Tiles) -> Vec<Self> {
        let default = Options::new(options.fineness);
        let is_equal = tiles.sides.is_some_and(|sides| sides.growth == 1.0);
        let is_as_asked = options.fineness == Fineness::Points(tiles.wanted);
        let Options { repairs: asked, sizes, .. } = options;
        let Repairs { welded_points, sewn_vertices, imprinted_edges, dropped_parts, filled_holes, .. } =
            surface.repairs();
        let found = [
            (Self::FitRange, options.fit_range != default.fit_range && options.fit == 0.0),
            (Self::MaxGrowth, sizes.growth != default.sizes.growth && is_equal),
            (Self::IgnoreRegions, !options.features.region_borders && surface.regions().names.is_empty()),
            (Self::KeepBoundary, options.keep_boundary.is_some() && !surface.keeps_boundary()),
            (Self::RefineCurvature, sizes.curvature.is_some() && is_equal),
            (Self::Around, sizes.around > default.sizes.around && is_equal),
            (Self::AroundHoles, sizes.around_holes > 0 && is_equal),
            (Self::SizeAt, !sizes.local.is_empty() && is_equal && is_as_asked),
            (Self::MinSize, sizes.least.is_some() && is_equal),
            (Self::MaxSize, sizes.largest.is_some() && is_equal && is_as_asked),
            (Self::Weld, asked.weld.is_some() && welded_points.count + sewn_vertices.count == 0),
            (Self::Imprint, asked.imprint && imprinted_edges.count == 0),
            (Self::DropParts, asked.drop_parts.is_some() && dropped_parts.count == 0),
            (Self::FillHoles, asked.fill_holes.is_some() && filled_holes.count == 0),
        ];
        found.into_iter().filter(|(_, is_so)| *is_so).map(|(option, _)| option).collect()
    }

    /// The option's name, as [`Options::set`] has it.
    pub fn option(self) -> &'static str {
        match self {
            Self::FitRange => "fit_range",
            Self::MaxGrowth => "max_growth",
            Self::IgnoreRegions => "ignore_regions",
            Self::KeepBoundary => "keep_boundary",
            Self::RefineCurvature => "refine_curvature",
            Self::Around => "around",
            Self::AroundHoles => "around_holes",
            Self::SizeAt => "size_at",
            Self::MinSize => "min_size",
            Self::MaxSize => "max_size",
            Self::Weld => "weld",
            Self::Imprint => "imprint",
            Self::DropParts => "drop_parts",
            Self::FillHoles => "fill_holes",
        }
    }
}

impl fmt::Display for Ineffective {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::FitRange => "the fit range had no effect, as sides do not fit the field; it goes with a fit, or a layout that has one",
            Self::MaxGrowth => "the largest growth had no effect, as all tiles have the same side; it goes with sizes, curvature and a fit",
            Self::IgnoreRegions => "ignoring regions had no effect, as the surface has none",
            Self::KeepBoundary => "keeping the boundary had no effect, as the surface has none",
            Self::RefineCurvature => "refining by curvature had no effect, as no part of the surface turns by more than the rest and this angle within an edge",
            Self::Around => "the number of edges round thin parts had no effect, as all have as many",
            Self::AroundHoles => "the number of edges round holes had no effect, as all have as many, or there are none",
            Self::SizeAt => "the sizes at places had no effect, as edges there are smaller",
            Self::MinSize => "the least size had no effect, as no edge is to be shorter",
            Self::MaxSize => "the largest size had no effect, as no edge is to be longer",
            Self::Weld => "welding had no effect, as no points or rims are so near to each other",
            Self::Imprint => "imprinting had no effect, as no open boundary lies on a sheet",
            Self::DropParts => "dropping parts had no effect, as none is so small",
            Self::FillHoles => "filling holes had no effect, as none is so small",
        })
    }
}
