//! `quadmosaic` turns a triangle surface into a quad-dominant mesh whose rows follow a cross field.
//!
//! # Guide
//! From arrays to quads: here a sphere with some 300 quads.
//!
//! ```
//! # use quadmosaic::surface::examples::Example;
//! # let soup = Example::Sphere.generate(1_000);
//! # let (points, triangles) = (soup.points, soup.triangles);
//! use quadmosaic::{Fineness, Mesher, Options, Soup};
//! let soup = Soup::new(points, triangles);
//! let outcome = Mesher::cpu().mesh(&soup, &Options::new(Fineness::Points(300)))?;
//! let mesh = &outcome.meshed.mesh;
//! let quads: Vec<[u32; 4]> = mesh.quads().collect();
//! # assert!(quads.len() > 250 && mesh.points.len().abs_diff(300) < 10);
//! # Ok::<(), quadmosaic::PipelineError>(())
//! ```
//!
//! | to | see |
//! |---|---|
//! | read a file | [`surface::load::read`] |
//! | set an option by its name on the command line | [`Options::set`](Options#method.set) |
//! | choose a layout, or the options for a purpose | [`Layout`], [`Preset`] |
//! | draw rows along directions | [`field::Guide`], `examples/guides.rs` |
//! | make a mesh symmetric | [`symmetry`], [`Options::symmetry`](Options#structfield.symmetry) |
//! | mesh patches of a surface apart, and join them | [`Options::keep_boundary`](Options#structfield.keep_boundary), `examples/patches.rs` |
//! | give sizes | [`sizes::SizeOptions`], `examples/sizes.rs` |
//! | mesh many surfaces, on several threads | [`Mesher`], `examples/many.rs` |
//! | see the progress, cancel a run | [`Mesher::mesh_watched`] |
//! | limit memory and time | [`Options::limits`](Options#structfield.limits) |
//! | judge the mesh | [`pipeline::Meshed`], [`Report`], [`Report::warnings`](report::Report#method.warnings) |
//! | write the mesh | [`export::write_mesh`] |
//! | write a page to look at it and to draw on it | `page::Page` |
//!
//! The library prints nothing, and says by an error of its own type what is wrong, where, and what to do. Coordinates are in model
//! units, as `f64`; vertices are `u32`.
//!
//! # Method
//! The way there is a *mosaic*: equal square tiles laid over the surface, turned along the field and pushed
//! into rows by repulsion. Tile centres become mesh vertices. See [`pipeline`] for the whole method in one function, and
//! [`paper`] for where it comes from and what it changes.
//!
//! # Features
//! All on by default: `gpu`, kernels on the GPU; `picture`, drawings; `page`, pages to look
//! and draw; `study`, sweeps with charts; `cli`, the
//! program. Without them the library takes a surface to a mesh on the CPU.

#![forbid(unsafe_code)]
#![warn(missing_docs)]

#[cfg(feature = "cli")]
extern crate self as quadmosaic;

#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod cli;
pub mod compute;
pub mod export;
pub mod field;
mod geometry;
#[cfg(feature = "gpu")]
pub mod gpu;
pub mod mesh;
mod mesher;
pub mod mosaic;
pub mod options;
#[cfg(feature = "page")]
pub mod page;
#[doc = include_str!("../docs/paper.md")]
pub mod paper {}
pub mod parametrize;
#[cfg(feature = "picture")]
pub mod picture;
pub mod pipeline;
mod progress;
pub mod report;
mod sets;
pub mod sizes;
mod solver;
#[cfg(feature = "study")]
pub mod study;
pub mod surface;
pub mod symmetry;
pub mod warnings;

pub use mesh::Mesh;
pub use mesher::Mesher;
pub use options::Preset;
pub use pipeline::{Fineness, Layout, Options, Outcome, PipelineError};
pub use report::Report;
pub use surface::{Soup, Surface};
