//! Pictures of surfaces, fields, mosaics and meshes, drawn without a display and without a GPU.
//!
//! # Practice
//! A [`Scene`] holds what is drawn, in model units, and knows no pixels; a [`View`] says from where it is seen. One
//! rasteriser (`raster`) finds out what is visible; PNG takes its colours from there, SVG its list of visible faces and
//! which hide which.
//! Sides of faces are part of the faces, so that lines of a mesh are hidden exactly where its faces are.

mod colour;
mod field;
mod image;
mod legend;
mod mesh;
mod mosaic;
mod normals;
mod order;
mod raster;
mod render;
mod scene;
mod shading;
mod svg;
mod text;
mod view;

pub use colour::Colour;
#[cfg(feature = "page")]
pub(crate) use field::field_lines;
pub use field::{FieldStyle, field_scene};
pub use image::Image;
pub use legend::Legend;
pub use mesh::{Paint, mesh_scene, surface_scene};
#[cfg(feature = "page")]
pub(crate) use mosaic::STONES;
pub use mosaic::mosaic_scene;
pub use scene::{Pen, Scene};
#[cfg(feature = "page")]
pub(crate) use view::named_turns;
pub use view::{Eye, UnknownEye, View};

use crate::export::{WriteError, atomic};
use std::path::Path;
use thiserror::Error;

/// Fewest and most pixels along a side of a picture.
pub const SIDE: std::ops::RangeInclusive<u32> = 16..=16_384;

/// Why there is no picture.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PictureError {
    /// The scene has neither faces nor lines.
    #[error("there is nothing to draw")]
    Empty,
    /// The picture would be too small or too large.
    #[error("a picture of {width}x{height} pixels cannot be drawn; ask for {} to {} each way", SIDE.start(), SIDE.end())]
    Size {
        /// Asked for.
        width: u32,
        /// Asked for.
        height: u32,
    },
    /// A direction has no length, or is not finite.
    #[error("the direction {} leads nowhere; give one with a length", crate::surface::shown(.direction))]
    Direction {
        /// Asked for.
        direction: [f64; 3],
    },
    /// Up would be along the line of sight.
    #[error("{} is along the line of sight and cannot be up in the picture; choose another direction for up", crate::surface::shown(.up))]
    Up {
        /// Asked for.
        up: [f64; 3],
    },
    /// What is to fill the picture has no size.
    #[error("a ball of radius {radius} cannot fill the picture; give a radius above 0, in model units")]
    Radius {
        /// Asked for.
        radius: f64,
    },
    /// The file's name ends in nothing that is known.
    #[error("{path} ends neither in .png nor in .svg, the formats of pictures")]
    Format {
        /// The path that was given.
        path: String,
    },
    /// The file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// Draws a scene into a file: PNG or SVG, by the ending of its name.
///
/// # Errors
/// [`PictureError`]; no half written file is left.
pub fn write_picture(path: &Path, scene: &Scene, view: &View, size: [u32; 2]) -> Result<(), PictureError> {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
    match ending.as_deref() {
        Some("png") => {
            let image = Image::of(scene, view, size)?;
            Ok(atomic(path, |writer| image.write_png(writer))?)
        }
        Some("svg") => {
            let text = svg::svg(scene, view, size)?;
            Ok(atomic(path, |writer| writer.write_all(text.as_bytes()))?)
        }
        _ => Err(PictureError::Format { path: path.display().to_string() }),
    }
}
