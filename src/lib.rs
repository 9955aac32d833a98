//! `quadmosaic` turns a triangle surface into a quad-dominant mesh whose rows follow a cross field.
//!
//! The way there is a *mosaic*: equal square tiles laid over the surface, turned along the field and pushed
//! into rows by repulsion. Tile centres become mesh vertices. See [`pipeline`] for the whole method in one function, and
//! [`paper`] for where it comes from and what it changes.

pub mod compute;
pub mod export;
pub mod field;
mod geometry;
pub mod gpu;
pub mod mesh;
pub mod mosaic;
pub mod parametrize;
#[doc = include_str!("../docs/paper.md")]
pub mod paper {}
pub mod picture;
pub mod pipeline;
pub mod report;
pub mod sizes;
mod solver;
pub mod study;
pub mod surface;
