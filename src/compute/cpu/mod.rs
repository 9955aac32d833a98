//! The kernels on the CPU, on rayon's threads.

mod conjugate;
pub mod grid;
mod multigrid;
pub mod neighbours;
pub mod relax;
mod smooth;
mod transfer;

#[cfg(test)]
pub(crate) use conjugate::product;
pub(crate) use multigrid::CpuMultigrid;
#[cfg(test)]
pub(crate) use smooth::{applied, remainder, stepped};

use super::{Backend, Complex, ComputeError, Level, Multigrid, Relaxation, RelaxationContext, RelaxationSurface, Tile};

/// The CPU.
#[derive(Clone, Copy, Debug, Default)]
pub struct Cpu;

impl Backend for Cpu {
    fn name(&self) -> &'static str {
        "cpu"
    }

    fn adapter(&self) -> String {
        format!("{} threads", rayon::current_num_threads())
    }

    fn multigrid<'a>(
        &'a self,
        levels: &'a [Level],
        start: usize,
        values: &[Complex],
    ) -> Result<Box<dyn Multigrid + 'a>, ComputeError> {
        Ok(Box::new(CpuMultigrid::new(levels, start, values)))
    }

    fn relaxation<'a>(
        &'a self,
        surface: &'a RelaxationSurface,
    ) -> Result<Box<dyn RelaxationContext + 'a>, ComputeError> {
        Ok(Box::new(CpuRelaxation { surface }))
    }
}

struct CpuRelaxation<'a> {
    surface: &'a RelaxationSurface,
}

impl RelaxationContext for CpuRelaxation<'_> {
    fn relax(&self, tiles: &[Tile], relaxation: &Relaxation) -> Result<Vec<Tile>, ComputeError> {
        Ok(relax::relax(self.surface, tiles, relaxation))
    }

    fn relax_watched(
        &self,
        tiles: &[Tile],
        relaxation: &Relaxation,
        is_cancelled: &(dyn Fn() -> bool + Sync),
    ) -> Result<Vec<Tile>, ComputeError> {
        Ok(relax::relax_watched(self.surface, tiles, relaxation, is_cancelled))
    }
}
