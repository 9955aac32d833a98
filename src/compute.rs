//! Where the heavy stages run: on the CPU, or as compute shaders.

use crate::field::{Complex, Field, Hierarchy, smooth};
use crate::mosaic::{Relaxation, Tile, relax};
use crate::surface::Surface;
use thiserror::Error;

/// Why a backend could not do its work.
#[derive(Debug, Error)]
#[error("the {backend} backend failed: {reason}")]
#[non_exhaustive]
pub struct ComputeError {
    /// The backend's name.
    pub backend: &'static str,
    /// What went wrong and what to do.
    pub reason: String,
}

/// The stages that have a kernel. Both implementations give the same bits on a conforming device.
pub trait Backend: Send + Sync {
    /// `cpu` or `gpu`.
    fn name(&self) -> &'static str;

    /// What it runs on: the adapter's name, or the number of threads.
    fn adapter(&self) -> String;

    /// Smooths the values of a hierarchy's unknowns, the field's or the phases', from the level that it sets out from to the
    /// finest.
    ///
    /// # Errors
    /// Where the device fails or a buffer is too large for it.
    fn smooth(&self, hierarchy: &Hierarchy) -> Result<Vec<Complex>, ComputeError>;

    /// Makes ready to relax tiles on a surface: what stays the same over all batches is laid out, or uploaded, once.
    ///
    /// # Errors
    /// Where the device fails or a buffer is too large for it.
    fn ground<'a>(&'a self, surface: &'a Surface, field: &'a Field) -> Result<Box<dyn Ground + 'a>, ComputeError>;
}

/// A surface with its field, made ready for relaxation.
pub trait Ground {
    /// Takes a batch of relaxation steps; see [`relax`].
    ///
    /// # Errors
    /// Where the device fails or a buffer is too large for it.
    fn relax(&self, tiles: &[Tile], relaxation: &Relaxation) -> Result<Vec<Tile>, ComputeError>;
}

/// The kernels' CPU twins, on rayon's threads.
#[derive(Clone, Copy, Debug, Default)]
pub struct Cpu;

struct CpuGround<'a> {
    surface: &'a Surface,
    field: &'a Field,
}

impl Backend for Cpu {
    fn name(&self) -> &'static str {
        "cpu"
    }

    fn adapter(&self) -> String {
        format!("{} threads", rayon::current_num_threads())
    }

    fn smooth(&self, hierarchy: &Hierarchy) -> Result<Vec<Complex>, ComputeError> {
        Ok(smooth::smooth(hierarchy))
    }

    fn ground<'a>(&'a self, surface: &'a Surface, field: &'a Field) -> Result<Box<dyn Ground + 'a>, ComputeError> {
        Ok(Box::new(CpuGround { surface, field }))
    }
}

impl Ground for CpuGround<'_> {
    fn relax(&self, tiles: &[Tile], relaxation: &Relaxation) -> Result<Vec<Tile>, ComputeError> {
        Ok(relax::relax(self.surface, self.field, tiles, relaxation))
    }
}
