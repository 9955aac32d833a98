//! A problem on ever coarser levels, with an initial solution and a schedule.

use super::coarsen::coarsen;
use super::initial;
use super::problem::Problem;
use super::schedule::{ITERATIONS, Schedule};
use crate::compute::{Backend, Complex, ComputeError, Level};

/// Unknowns of the level whose initial solution is by diffusion: what is tangled there stays so on all finer ones.
const DIFFUSED: usize = 8_000;
/// Unknowns of the level whose unit values spread: some of them for each region of rows in step.
const SPREAD: usize = 500;
/// Normalised sweeps there.
const SPREAD_SWEEPS: u32 = 200;

/// The levels of a problem, finest first, with an initial solution.
pub(crate) struct Hierarchy {
    pub levels: Vec<Level>,
    /// The level of the initial solution; coarser ones serve the V-cycles.
    start: usize,
    /// The initial solution.
    values: Vec<Complex>,
    schedule: Schedule,
}

impl Hierarchy {
    /// A linear problem, solved by so many iterations of conjugate gradients on each level. The initial solution is zero where
    /// nothing is fixed.
    pub fn linear(problem: Problem, iterations: u32) -> Self {
        let (levels, start, _) = coarsen(problem, 0);
        let values = levels[start].fixed_values();
        Self { levels, start, values, schedule: Schedule { iterations, sweeps: 0, last_sweeps: 0 } }
    }

    /// A problem whose values are directions: the linear problem's solution where constraints decide, diffused elsewhere, and
    /// normalised by so many sweeps at last.
    ///
    /// # Errors
    /// Where the initial solution fails.
    pub fn directions(problem: Problem, last_sweeps: u32) -> Result<Self, ComputeError> {
        let (mut levels, start, guesses) = coarsen(problem, DIFFUSED);
        let values = rayon::scope(|_| initial::diffused(&mut levels, start, &guesses))?;
        Ok(Self { levels, start, values, schedule: Schedule { iterations: ITERATIONS, sweeps: 0, last_sweeps } })
    }

    /// A problem between unit numbers, solved by so many normalised sweeps on each level. Values spread from fixed ones.
    ///
    /// # Errors
    /// Where the initial solution fails.
    pub fn units(problem: Problem, sweeps: u32) -> Result<Self, ComputeError> {
        let (levels, start, _) = coarsen(problem, SPREAD);
        let values = initial::spread(&levels[start], SPREAD_SWEEPS)?;
        Ok(Self { levels, start, values, schedule: Schedule { iterations: 0, sweeps, last_sweeps: sweeps } })
    }

    /// The values of the finest level.
    ///
    /// # Errors
    /// Where the backend fails.
    pub fn solve(&self, backend: &dyn Backend) -> Result<Vec<Complex>, ComputeError> {
        let mut multigrid = backend.multigrid(&self.levels, self.start, &self.values)?;
        // On one of rayon's threads: from outside, each of the CPU's many short loops would wait for one to wake.
        rayon::scope(|_| {
            self.schedule.run(&mut *multigrid, self.start, self.levels.len())?;
            multigrid.values(0)
        })
    }
}
