//! From soup to welded triangles: all repairs that come before orientation.
//!
//! # Practice
//! The order is fixed: points are welded and rims sewn; rims are joined to the sheets that they
//! touch; small parts are dropped; small holes are filled. So no hole of a part that
//! goes is filled, and no gap that welding closes.

use super::error::MOST_TRIANGLES;
use super::repairs::Limits;
use super::weld::{Welded, frame, weld};
use super::{RepairOptions, Soup, SurfaceError, holes, imprint, parts, sew};
use crate::progress::Progress;

/// Welds the soup, and repairs it as asked; the side of a tile is in model units.
///
/// # Errors
/// Where nothing is left to mesh, a length of the options is none, or the run is cancelled.
pub(super) fn mended(
    soup: &Soup,
    options: &RepairOptions,
    side: f64,
    progress: &Progress,
) -> Result<Welded, SurfaceError> {
    expect_countable(soup.triangles.len(), soup.points.len())?;
    let (frame, used) = frame(soup)?;
    let limits = Limits::new(options, frame.diagonal, side)?;
    let mut welded = weld(soup, frame, &used, limits.weld, progress)?;
    if let Some(tolerance) = limits.weld {
        sew::sew(&mut welded, tolerance);
        progress.check()?;
        if options.imprint {
            imprint::imprint(&mut welded, tolerance);
        }
    }
    progress.check()?;
    parts::drop_small(&mut welded, limits.drop_parts)?;
    if let Some(limit) = limits.fill_holes {
        holes::fill(&mut welded, limit);
    }
    if welded.has_area() { Ok(welded) } else { Err(SurfaceError::NoArea { given: soup.triangles.len() }) }
}

/// Refuses a surface whose triangles or points have no 32-bit numbers.
fn expect_countable(triangles: usize, points: usize) -> Result<(), SurfaceError> {
    match triangles.max(points) > MOST_TRIANGLES {
        true => Err(SurfaceError::TooLarge { triangles, points }),
        false => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_surface_beyond_32_bits_is_refused() {
        assert_eq!(expect_countable(MOST_TRIANGLES, MOST_TRIANGLES), Ok(()));
        for (triangles, points) in [(MOST_TRIANGLES + 1, 4), (1, MOST_TRIANGLES + 1), (usize::MAX, 4)] {
            assert_eq!(expect_countable(triangles, points), Err(SurfaceError::TooLarge { triangles, points }));
        }
    }
}
