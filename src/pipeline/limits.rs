//! The memory and the time that a run may take.

use super::{MOST_PARTS, POINTS};
use crate::mosaic::Effort;
use crate::progress::Late;
use std::ops::RangeInclusive;
use std::time::Duration;
use thiserror::Error;

/// What a run may take. Default: no limits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Limits {
    /// The most memory, in bytes, of the process: a run that is predicted to need more is refused before its work.
    pub memory: Option<u64>,
    /// The longest time: where it is over, the best mesh so far is the result, and [`Outcome::late`](super::Outcome::late) tells it.
    pub time: Option<Duration>,
}

/// Why a run within its limits makes no mesh.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum LimitError {
    /// The run needs more memory.
    #[error("the run needs about {} of memory, more than the limit of {}; {fits}", shown(*.needed), shown(*.limit))]
    Memory {
        /// The memory that is predicted, in bytes.
        needed: u64,
        /// The limit, in bytes.
        limit: u64,
        /// What would fit.
        fits: Fits,
    },
    /// The time was over before there was a mesh.
    #[error(
        "there is no mesh yet after {} s, the time limit; the stage {} had taken {:.2} s of it; allow more time, or ask for fewer points",
        .0.limit.as_secs_f64(),
        .0.stage.name(),
        .0.taken.as_secs_f64()
    )]
    Time(Late),
}

/// What fits into a limit of memory.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum Fits {
    /// The same surface with so many vertices.
    #[error("{0} points would fit: ask for as many, or allow more")]
    Points(usize),
    /// Where that is none: as many vertices on a surface of so many triangles.
    #[error("{0} triangles would fit: give a file of as many, or allow more")]
    Triangles(usize),
    /// Neither of them alone.
    #[error("neither fewer points nor fewer triangles alone would fit; allow more")]
    Neither,
}

impl Fits {
    fn within(limit: u64, triangles: usize, points: usize) -> Self {
        let fewer_points = || most(POINTS, |points| predicted_memory(triangles, points) <= limit).map(Self::Points);
        let fewer_triangles =
            || most(1..=triangles, |triangles| predicted_memory(triangles, points) <= limit).map(Self::Triangles);
        fewer_points().or_else(fewer_triangles).unwrap_or(Self::Neither)
    }
}

/// A number of a range that is good, above which none is found; `None` where the first is bad.
fn most(range: RangeInclusive<usize>, is_good: impl Fn(usize) -> bool) -> Option<usize> {
    let (mut good, mut bad) = (*range.start(), range.end() + 1);
    if !is_good(good) {
        return None;
    }
    while good + 1 < bad {
        let middle = good.midpoint(bad);
        *(if is_good(middle) { &mut good } else { &mut bad }) = middle;
    }
    Some(good)
}

/// The bytes that any run takes.
const BASE: f64 = 12e6;
/// The bytes of a triangle of the surface as it is given.
const GIVEN: f64 = 310.0;
/// The bytes of a triangle that tiles are laid on, where the surface is not coarsened.
const LAID_ON: f64 = 350.0;
/// The bytes of a tile that the parametrization is solved for.
const SOLVED: f64 = 3_800.0;
/// The bytes of a vertex of the mesh.
const VERTEX: f64 = 1_450.0;

/// The memory, in bytes, that a run on the CPU takes at its peak: that of the whole process.
///
/// The constants are fitted to measured peaks; `docs/performance.md` says how near it comes.
pub fn predicted_memory(triangles: usize, points: usize) -> u64 {
    let laid_on = if triangles > MOST_PARTS.saturating_mul(points) { 0 } else { triangles };
    let mut solved = points;
    while solved > Effort::default().solved {
        solved /= 9;
    }
    let mosaic = (LAID_ON * laid_on as f64).max(SOLVED * solved as f64);
    (BASE + GIVEN * triangles as f64 + mosaic + VERTEX * points as f64) as u64
}

impl Limits {
    /// Refuses a run that is predicted to need more memory than it may take.
    pub(super) fn expect_memory(&self, triangles: usize, points: usize) -> Result<(), LimitError> {
        let needed = predicted_memory(triangles, points);
        match self.memory {
            Some(limit) if needed > limit => {
                Err(LimitError::Memory { needed, limit, fits: Fits::within(limit, triangles, points) })
            }
            _ => Ok(()),
        }
    }
}

/// Bytes in a unit that is a power of 1024.
fn shown(bytes: u64) -> String {
    let units = ["kB", "MB", "GB"];
    let power = (bytes.max(1).ilog(1024) as usize).clamp(1, units.len());
    format!("{:.2} {}", bytes as f64 / 1024f64.powi(power as i32), units[power - 1])
}
