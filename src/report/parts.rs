//! Reports on parts of a run: the field, and the mosaic.

use super::singularities::singularities;
use super::{Asked, Device, FieldFigures, Input, PROGRAM, VERSION};
use crate::compute::Backend;
use crate::field::Field;
use crate::mosaic::{Mosaic, quality::TileQuality};
use crate::pipeline::Options;
use crate::surface::Surface;
use serde::Serialize;

/// A report on a field.
#[derive(Clone, Debug, Serialize)]
pub struct FieldReport {
    /// [`VERSION`].
    pub version: u32,
    /// The program's name and version.
    pub program: String,
    /// The surface.
    pub surface: Input,
    /// The backend of the heavy stages.
    pub backend: Device,
    /// The cross field.
    pub field: FieldFigures,
}

impl FieldReport {
    /// The report on the field of the surface called `name`.
    pub fn new(name: &str, backend: &dyn Backend, surface: &Surface, field: &Field) -> Self {
        Self {
            version: VERSION,
            program: PROGRAM.to_owned(),
            surface: Input::new(name, surface),
            backend: Device::new(backend),
            field: FieldFigures::new(field, &singularities(surface, field, None)),
        }
    }
}

/// A report on a mosaic.
#[derive(Clone, Debug, Serialize)]
pub struct MosaicReport {
    /// [`VERSION`].
    pub version: u32,
    /// The program's name and version.
    pub program: String,
    /// The surface.
    pub surface: Input,
    /// The wanted fineness.
    pub asked: Asked,
    /// The backend of the heavy stages.
    pub backend: Device,
    /// The cross field.
    pub field: FieldFigures,
    /// Tiles.
    pub tiles: usize,
    /// Those of them that lie on features.
    pub on_features: usize,
    /// Their coverage, overlap and straightness.
    pub fit: TileQuality,
}

impl MosaicReport {
    /// The report on the mosaic, with its fit, of the surface called `name`.
    pub fn new(
        name: &str,
        options: &Options,
        backend: &dyn Backend,
        (surface, field, mosaic): (&Surface, &Field, &Mosaic),
        fit: TileQuality,
    ) -> Self {
        Self {
            version: VERSION,
            program: PROGRAM.to_owned(),
            surface: Input::new(name, surface),
            asked: Asked::new(options.fineness),
            backend: Device::new(backend),
            field: FieldFigures::new(field, &singularities(surface, field, None)),
            tiles: mosaic.count(),
            on_features: mosaic.feature_samples.len(),
            fit,
        }
    }
}
