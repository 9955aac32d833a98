//! `quadmosaic` turns a triangle surface into a quad-dominant mesh whose rows follow a cross field.
//!
//! The way there is a *mosaic*: equal square tiles laid over the surface, turned along the field and pushed
//! into rows by repulsion. Tile centres become mesh vertices. See [`pipeline`] for the whole method in one function, and
//! [`paper`] for where it comes from and what it changes.
//!
//! Features, all on by default: `gpu`, kernels on the GPU; `picture`, drawings; `study`, sweeps with charts; `cli`, the
//! program. Without them the library takes a surface to a mesh on the CPU.

pub mod compute;
pub mod export;
pub mod field;
mod geometry;
#[cfg(feature = "gpu")]
pub mod gpu;
pub mod mesh;
pub mod mosaic;
#[doc = include_str!("../docs/paper.md")]
pub mod paper {}
pub mod parametrize;
#[cfg(feature = "picture")]
pub mod picture;
pub mod pipeline;
pub mod report;
mod sets;
pub mod sizes;
mod solver;
#[cfg(feature = "study")]
pub mod study;
pub mod surface;
