//! The mosaic: equal square tiles laid over the surface and pushed into rows.

pub mod grid;
