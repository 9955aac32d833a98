//! The kernels, and where they run: on the CPU, or as compute shaders.
//!
//! # Practice
//! [`Backend`] is the interface between the method and its kernels. It takes plain records alone. [`cpu`] holds the CPU's
//! kernels, one file for each file of `shaders/` and with the same stem; [`crate::gpu`] runs the shaders.

mod complex;
pub mod cpu;
mod equations;
mod tiles;
mod watched;

pub use complex::{Complex, NEGLIGIBLE};
pub(crate) use complex::{add, conjugate, modulus, modulus_squared, normalised, scaled};
pub use cpu::Cpu;
pub(crate) use equations::target;
pub use equations::{Level, Link, MIRRORED, Row, TARGET_LENGTH};
pub(crate) use tiles::cell;
pub use tiles::{
    LIST_LENGTH, LIST_STEPS, MOST_EDGES, REACH, Relaxation, RelaxationSurface, SKIN, Tile, Triangle, bucket_count,
};
pub(crate) use watched::Watched;

use crate::progress::Cancelled;
use thiserror::Error;

/// Invocations in a workgroup of every kernel, and values in a block of a sum.
pub const WORKGROUP: usize = 256;

/// Why a backend did not do its work.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ComputeError {
    /// It failed.
    #[error("the {backend} backend failed: {source}")]
    Failed {
        /// The backend's name.
        backend: &'static str,
        /// What went wrong and what to do.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
    /// The run was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// The kernels on one device. All implementations give the same bits on a device that rounds as IEEE 754 does.
pub trait Backend: Send + Sync {
    /// `cpu` or `gpu`.
    fn name(&self) -> &'static str;

    /// What it runs on: the adapter's name, or the number of threads.
    fn adapter(&self) -> String;

    /// Asks whether the run goes on.
    ///
    /// # Errors
    /// Where it was cancelled.
    fn check(&self) -> Result<(), ComputeError> {
        Ok(())
    }

    /// Lays out, or uploads, the levels of a linear problem, finest first. Level `start` gets these values; the others have
    /// the values of their fixed unknowns, and zero elsewhere.
    ///
    /// # Errors
    /// Where the device fails or a buffer is too large for it.
    fn multigrid<'a>(
        &'a self,
        levels: &'a [Level],
        start: usize,
        values: &[Complex],
    ) -> Result<Box<dyn Multigrid + 'a>, ComputeError>;

    /// Lays out, or uploads, the surface that tiles are relaxed on.
    ///
    /// # Errors
    /// Where the device fails or a buffer is too large for it.
    fn relaxation<'a>(
        &'a self,
        surface: &'a RelaxationSurface,
    ) -> Result<Box<dyn RelaxationContext + 'a>, ComputeError>;
}

/// The kernels of multigrid and conjugate gradients on the levels of one problem.
///
/// A level has values, their residual, and a correction of the values. Levels are numbered by their depth from 0, the finest.
///
/// # Errors
/// All methods fail where the device fails.
pub trait Multigrid: Send {
    /// The values become those of the next coarser level, read in the frames of this one; fixed ones stay.
    fn prolong(&mut self, depth: usize) -> Result<(), ComputeError>;

    /// Computes the residual of the values; the mass terms draw each value to itself.
    fn residual(&mut self, depth: usize) -> Result<(), ComputeError>;

    /// A first Jacobi sweep for the correction, from zero, damped by `step`.
    fn first_sweep(&mut self, depth: usize, step: f32) -> Result<(), ComputeError>;

    /// A Jacobi sweep for the correction, damped by `step`.
    fn sweep(&mut self, depth: usize, step: f32) -> Result<(), ComputeError>;

    /// The next coarser level's residual becomes what the correction leaves of this one's.
    fn restrict(&mut self, depth: usize) -> Result<(), ComputeError>;

    /// Adds the next coarser level's correction to this one's.
    fn correct(&mut self, depth: usize) -> Result<(), ComputeError>;

    /// A step of preconditioned conjugate gradients, the correction being the preconditioned residual; steps are numbered
    /// from 0.
    fn descend(&mut self, depth: usize, number: u32) -> Result<(), ComputeError>;

    /// A Jacobi sweep of the values, damped by `step`; then all values are divided by their moduli.
    fn normalised_sweep(&mut self, depth: usize, step: f32) -> Result<(), ComputeError>;

    /// Waits for the device and returns the values of a level.
    fn values(&mut self, depth: usize) -> Result<Vec<Complex>, ComputeError>;
}

/// A surface made ready for the relaxation of tiles.
pub trait RelaxationContext {
    /// Takes a batch of relaxation steps.
    ///
    /// # Errors
    /// Where the device fails or a buffer is too large for it.
    fn relax(&self, tiles: &[Tile], relaxation: &Relaxation) -> Result<Vec<Tile>, ComputeError>;

    /// As [`RelaxationContext::relax`]. It may end early once `is_cancelled` is true; the tiles are of no use then.
    ///
    /// # Errors
    /// As [`RelaxationContext::relax`].
    fn relax_watched(
        &self,
        tiles: &[Tile],
        relaxation: &Relaxation,
        is_cancelled: &(dyn Fn() -> bool + Sync),
    ) -> Result<Vec<Tile>, ComputeError> {
        let _ = is_cancelled;
        self.relax(tiles, relaxation)
    }
}
