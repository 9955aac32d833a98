//! What the benches share: one surface, meshed as far as a stage needs it.
#![allow(dead_code, reason = "each bench compiles this file, and none uses all of it")]

use criterion::Criterion;
use quadmosaic::compute::Cpu;
use quadmosaic::field::{Field, FieldOptions};
use quadmosaic::mesh::connect::{ConnectOptions, connect};
use quadmosaic::mesh::fill::{Holes, fill};
use quadmosaic::mesh::triangulate::triangulate;
use quadmosaic::mesh::{Context, SurfaceMesh, Triangulation};
use quadmosaic::mosaic::{Effort, Mosaic, MosaicBuilder};
use quadmosaic::parametrize::Rows;
use quadmosaic::surface::examples::Example;
use quadmosaic::surface::{FeatureOptions, Soup, Surface};
use std::time::Duration;

/// The vertices that are asked for.
pub const POINTS: usize = 6_000;

/// Few samples: a stage takes milliseconds to a second, and a whole `cargo bench` is to take minutes.
pub fn criterion() -> Criterion {
    Criterion::default()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(2))
        .configure_from_args()
}

/// The wing.
pub fn soup() -> Soup {
    "m6".parse::<Example>().expect("an example's name").generate(Example::DEFAULT_TRIANGLES)
}

pub fn surface() -> Surface {
    Surface::new(&soup(), &FeatureOptions::default()).expect("the wing is a surface")
}

pub fn field(surface: &Surface) -> Field {
    Field::new(surface, &FieldOptions::default(), &Cpu).expect("the CPU does not fail")
}

pub fn mosaic(surface: &Surface, field: &Field) -> Mosaic {
    let builder = MosaicBuilder {
        surface,
        field,
        backend: &Cpu,
        effort: Effort::default(),
        rows: Rows::Paper,
        first_scale: None,
        is_trial: false,
        progress: &|_| {},
    };
    builder.with_count(POINTS, None).expect("the CPU does not fail")
}

/// The surface and its tiles' triangulation.
pub fn triangulated() -> (Surface, Triangulation) {
    let surface = surface();
    let field = field(&surface);
    let triangulation = triangulate(&surface, &field, &mosaic(&surface, &field));
    (surface, triangulation)
}

/// The mesh with its holes filled.
pub fn filled(context: &Context, triangulation: &Triangulation) -> SurfaceMesh {
    fill(context, triangulation, &connect(triangulation, &ConnectOptions::default()), Holes::Patterns).0
}
