//! The surface as the tiles need it: its features, the sizes of tiles and their number.

use super::fallback::Carried;
use super::{Fineness, FinenessError, MOST_PARTS, Options, POINTS, PipelineError, unwatched};
use crate::field::StretchError;
use crate::mosaic;
use crate::progress::Progress;
use crate::sizes::{Sizes, SizesError, Wanted};
use crate::surface::{BoundaryError, Soup, Surface};

/// The most rounds in which the surface is divided where sizes, known at vertices, are small.
const SIZE_ROUNDS: usize = 4;

/// A surface that can carry its tiles.
pub(super) struct Prepared<'a> {
    pub surface: Surface,
    pub sizing: Sizing<'a>,
    /// The sizes of the tiles.
    pub sizes: Sizes,
    /// Their wanted number.
    pub count: usize,
}

/// What the sizes of the tiles follow from.
pub(super) struct Sizing<'a> {
    wanted: Wanted<'a>,
    /// The number of tiles that is asked for.
    pub count: usize,
    /// The number of tiles that is aimed at over the wanted number of vertices: the connectivity optimisation adds or removes some.
    pub aim: f64,
    /// What an earlier mesh tells of the rows.
    pub carried: Carried,
}

/// The surface with the features that tiles of this fineness resolve, the sizes of the tiles, and the wanted number of vertices.
///
/// # Errors
/// Where the surface cannot be meshed, or the fineness, the sizes or the aspect are invalid.
pub fn prepare(soup: &Soup, options: &Options) -> Result<(Surface, Sizes, usize), PipelineError> {
    let progress = &Progress::new(&unwatched);
    let Prepared { surface, sizes, count, .. } = prepared(repaired(soup, options, progress)?, options, progress)?;
    Ok((surface, sizes, count))
}

/// The surface of a soup, repaired, with the edges that are named.
pub(super) fn repaired(soup: &Soup, options: &Options, progress: &Progress) -> Result<Surface, PipelineError> {
    expect_stretchable(options)?;
    if options.keep_boundary.is_some() && options.symmetry.is_some() {
        return Err(BoundaryError::Symmetry.into());
    }
    let side = approximate_side(soup, options);
    let surface = Surface::repaired_watched(soup, &options.features, &options.repairs, side, progress)?;
    progress.check()?;
    let surface = surface.with_edges(soup, &options.edges, &options.features)?;
    match options.keep_boundary {
        Some(kept) => Ok(surface.with_kept_boundary(kept, &options.features)?),
        None => Ok(surface),
    }
}

/// As [`prepare`], for a surface that is repaired.
pub(super) fn prepared<'a>(
    surface: Surface,
    options: &'a Options,
    progress: &Progress,
) -> Result<Prepared<'a>, PipelineError> {
    let features = &options.features;
    progress.check()?;
    let count = count(&surface, options)?;
    let side = mosaic::side_for_count(&surface, count);
    progress.check()?;
    let is_cancelled = || progress.is_cancelled();
    let small = options.sizes.small_sides(&surface, f64::from(side), features.crease, &is_cancelled);
    progress.check()?;
    let surface = surface.with_contacts_watched(f64::from(side), progress);
    progress.check()?;
    let mut surface = surface.fitted_to(features, side, small.at_vertices.as_deref(), progress);
    progress.check()?;
    if surface.parts(mosaic::longest_edges(&surface, &Sizes::equal(), count, options.aspect)[0]) > MOST_PARTS * count {
        progress.check()?;
        surface = surface.coarsened(f64::from(side), features, progress);
    }
    progress.check()?;
    let mut wanted = options.sizes.on(&surface, f64::from(side), small.is_thin, features.crease)?;
    if matches!(options.fineness, Fineness::Size(_)) {
        wanted.keep_scale(&surface, count)?;
    }
    Sizing { wanted, count, aim: 1.0, carried: Carried::UNKNOWN }.sized(surface, options, progress)
}

impl<'a> Sizing<'a> {
    /// Smaller tiles at these places, in model units.
    pub fn refined(self, surface: &Surface, places: &[[f64; 3]]) -> Result<Self, SizesError> {
        let carried = Carried { is_refined: true, ..self.carried };
        Ok(Self { wanted: self.wanted.refined(surface, self.count, places)?, carried, ..self })
    }

    /// The surface, divided where tiles are small, and their sizes.
    pub fn sized(
        self,
        mut surface: Surface,
        options: &Options,
        progress: &Progress,
    ) -> Result<Prepared<'a>, PipelineError> {
        let mut wanted = self.wanted;
        let count = wanted.raised(&surface, self.count)?;
        let mut sizes = wanted.sizes(&surface, count)?;
        for _ in 0..SIZE_ROUNDS {
            progress.check()?;
            let longest = mosaic::longest_edges(&surface, &sizes, count, options.aspect);
            let middles;
            (surface, middles) = surface.divided(longest, &options.features);
            if middles.is_empty() {
                break;
            }
            wanted = wanted.divided(&surface, &middles);
            if sizes.is_equal() {
                break;
            }
            sizes = wanted.sizes(&surface, count)?;
        }
        let intervals = wanted.intervals(&surface, &sizes, count);
        Ok(Prepared { surface, sizing: Self { wanted, ..self }, sizes: sizes.with_intervals(intervals), count })
    }
}

/// Checks the aspect before the surface is read, as the rest takes long.
fn expect_stretchable(options: &Options) -> Result<(), StretchError> {
    StretchError::of_aspect(options.aspect)?;
    match options.aspect == 1.0 {
        false if options.fit != 0.0 => Err(StretchError::Fitted),
        false if options.field.guides.is_empty() => Err(StretchError::NoGuide),
        _ => Ok(()),
    }
}

/// The number of vertices of a fineness, before the surface is known.
pub(super) fn approximate_count(soup: &Soup, options: &Options) -> usize {
    match options.fineness {
        Fineness::Points(count) => count,
        Fineness::Size(_) | Fineness::Sampled => (soup.area() / approximate_side(soup, options).powi(2)) as usize,
    }
}

/// The side of a tile, in model units, before the surface is known; beside the approximate count only lengths of repairs depend on it.
fn approximate_side(soup: &Soup, options: &Options) -> f64 {
    match options.fineness {
        Fineness::Points(count) => (soup.area() / count as f64).sqrt(),
        Fineness::Size(size) => size,
        Fineness::Sampled => {
            let sizes = options.sizes.samples.iter().map(|sample| sample.size);
            sizes.sum::<f64>() / options.sizes.samples.len() as f64
        }
    }
}

/// The number of vertices of a fineness.
fn count(surface: &Surface, options: &Options) -> Result<usize, PipelineError> {
    match options.fineness {
        Fineness::Points(count) if POINTS.contains(&count) => Ok(count),
        Fineness::Points(asked) => Err(FinenessError::Points { asked }.into()),
        Fineness::Size(size) => {
            let diagonal = surface.frame().diagonal;
            let count = mosaic::count_for_side(surface, size / diagonal);
            if size > 0.0 && size <= diagonal && count <= *POINTS.end() as f64 {
                return Ok((count.round() as usize).max(*POINTS.start()));
            }
            let least = diagonal * f64::from(mosaic::side_for_count(surface, *POINTS.end()));
            Err(FinenessError::Size { asked: size, least, most: diagonal }.into())
        }
        Fineness::Sampled if options.sizes.samples.is_empty() => Err(FinenessError::NoSizes.into()),
        Fineness::Sampled => {
            let count = options.sizes.count(surface)?;
            if count <= *POINTS.end() as f64 {
                return Ok((count.round() as usize).max(*POINTS.start()));
            }
            Err(FinenessError::SmallSizes { count }.into())
        }
    }
}
