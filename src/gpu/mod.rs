//! The GPU backend: the one place that names `wgpu`.
//!
//! # Practice
//! One file for each file of `shaders/`, with the same stem; `multigrid` and `relaxation` put their kernels together.
//!
//! [`Gpu::open`] gives a device, [`Program`] the kernels of one file of `shaders/`, [`Buffer`] typed memory on the
//! device, and [`Recording`] a batch of dispatches that goes to the device in one submission. Read-back is a wait,
//! so a batch keeps its data on the device until its end.
//!
//! Software adapters (Mesa's lavapipe) count as a GPU here: the kernels hold nothing that is not bit-equal there to
//! the CPU's `f32`, and the tests rely on that.

mod backend;
mod buffer;
pub mod conjugate;
mod device;
mod error;
pub mod grid;
mod kernel;
mod multigrid;
mod neighbours;
mod relax;
mod relaxation;
pub mod smooth;
pub mod transfer;

pub use backend::GpuBackend;
pub use buffer::Buffer;
pub use device::{AdapterSummary, Gpu, adapters, can_have_hardware};
pub use error::GpuError;
pub use kernel::{Access, Bindable, Bindings, Kernel, Program, Recording, WORKGROUP};
