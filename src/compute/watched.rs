//! A backend that ends the work of a cancelled run: each kernel asks first.

use super::{Backend, Complex, ComputeError, Level, Multigrid, Relaxation, RelaxationContext, RelaxationSurface, Tile};
use crate::progress::Progress;

/// A backend whose kernels fail with [`ComputeError::Cancelled`] once the run is cancelled.
pub(crate) struct Watched<'a> {
    pub backend: &'a dyn Backend,
    pub progress: &'a Progress<'a>,
}

impl Backend for Watched<'_> {
    fn name(&self) -> &'static str {
        self.backend.name()
    }

    fn adapter(&self) -> String {
        self.backend.adapter()
    }

    fn check(&self) -> Result<(), ComputeError> {
        Ok(self.progress.check()?)
    }

    fn multigrid<'a>(
        &'a self,
        levels: &'a [Level],
        start: usize,
        values: &[Complex],
    ) -> Result<Box<dyn Multigrid + 'a>, ComputeError> {
        self.progress.check()?;
        let multigrid = self.backend.multigrid(levels, start, values)?;
        Ok(Box::new(WatchedMultigrid { multigrid, progress: self.progress }))
    }

    fn relaxation<'a>(
        &'a self,
        surface: &'a RelaxationSurface,
    ) -> Result<Box<dyn RelaxationContext + 'a>, ComputeError> {
        self.progress.check()?;
        Ok(Box::new(WatchedRelaxation { context: self.backend.relaxation(surface)?, progress: self.progress }))
    }
}

struct WatchedMultigrid<'a> {
    multigrid: Box<dyn Multigrid + 'a>,
    progress: &'a Progress<'a>,
}

impl WatchedMultigrid<'_> {
    fn asked(&mut self) -> Result<&mut dyn Multigrid, ComputeError> {
        self.progress.check()?;
        Ok(&mut *self.multigrid)
    }
}

impl Multigrid for WatchedMultigrid<'_> {
    fn prolong(&mut self, depth: usize) -> Result<(), ComputeError> {
        self.asked()?.prolong(depth)
    }

    fn residual(&mut self, depth: usize) -> Result<(), ComputeError> {
        self.asked()?.residual(depth)
    }

    fn first_sweep(&mut self, depth: usize, step: f32) -> Result<(), ComputeError> {
        self.asked()?.first_sweep(depth, step)
    }

    fn sweep(&mut self, depth: usize, step: f32) -> Result<(), ComputeError> {
        self.asked()?.sweep(depth, step)
    }

    fn restrict(&mut self, depth: usize) -> Result<(), ComputeError> {
        self.asked()?.restrict(depth)
    }

    fn correct(&mut self, depth: usize) -> Result<(), ComputeError> {
        self.asked()?.correct(depth)
    }

    fn descend(&mut self, depth: usize, number: u32) -> Result<(), ComputeError> {
        self.asked()?.descend(depth, number)
    }

    fn normalised_sweep(&mut self, depth: usize, step: f32) -> Result<(), ComputeError> {
        self.asked()?.normalised_sweep(depth, step)
    }

    fn values(&mut self, depth: usize) -> Result<Vec<Complex>, ComputeError> {
        self.asked()?.values(depth)
    }
}

struct WatchedRelaxation<'a> {
    context: Box<dyn RelaxationContext + 'a>,
    progress: &'a Progress<'a>,
}

impl RelaxationContext for WatchedRelaxation<'_> {
    fn relax(&self, tiles: &[Tile], relaxation: &Relaxation) -> Result<Vec<Tile>, ComputeError> {
        self.progress.check()?;
        let tiles = self.context.relax_watched(tiles, relaxation, &|| self.progress.is_cancelled())?;
        self.progress.check()?;
        Ok(tiles)
    }
}
