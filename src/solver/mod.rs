//! Sparse linear problems between complex unknowns, solved by multigrid and conjugate gradients.
//!
//! # Theory
//! A [`Problem`] links unknowns by complex weights: the connection Laplacian of Knöppel et al. 2013 (*Globally optimal
//! direction fields*) is one. A [`Hierarchy`] coarsens it by aggregation and holds an initial solution on one of its levels.
//! From there on each finer level is solved by conjugate gradients, preconditioned by one V-cycle over the coarser levels
//! (Braess 1995, *Towards algebraic multigrid for elliptic problems of second order*), from the coarser level's values on.

mod coarsen;
mod hierarchy;
mod initial;
mod problem;
mod schedule;

pub(crate) use hierarchy::Hierarchy;
pub(crate) use problem::{Problem, Terms};
pub(crate) use schedule::NORMALISED_SWEEPS;
#[cfg(test)]
pub(crate) use schedule::{ITERATIONS, SWEEP_STEP, cycle, solve};
