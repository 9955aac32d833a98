//! What there is to say about a finished mesh, for a program to read; the command line prints the same for a person.

use crate::compute::Backend;
use crate::mesh::check::{Faults, check_joined};
use crate::mesh::clean::CleanCounts;
use crate::mesh::quality::Quality;
use crate::pipeline::{Fineness, Options, Outcome};
use crate::surface::Repairs;
use serde::Serialize;
use std::time::Duration;

/// The version of [`Report`]'s fields. It grows when a field changes its meaning or goes; new fields leave it as it is.
pub const VERSION: u32 = 1;

/// A run in figures.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// [`VERSION`].
    pub version: u32,
    /// The program's name and version.
    pub program: String,
    /// What was read.
    pub input: Input,
    /// What was asked for.
    pub asked: Asked,
    /// Where the heavy stages ran.
    pub backend: Device,
    /// The mosaic.
    pub mosaic: Tiles,
    /// Measures of the mesh before the clean-up and the smoothing.
    pub before: Quality,
    /// Measures of the mesh.
    pub mesh: Quality,
    /// What the clean-up did; absent where there was none.
    pub cleaned: Option<CleanCounts>,
    /// Broken invariants of the mesh, each with its place in model units.
    pub faults: Faults,
    /// How long each stage took, in order.
    pub times: Vec<Time>,
    /// Milliseconds of all stages together.
    pub total_milliseconds: f64,
}

/// What was read.
#[derive(Clone, Debug, Serialize)]
pub struct Input {
    /// The file's path or the example's name.
    pub name: String,
    /// Triangles of the surface, after repairs.
    pub triangles: usize,
    /// Vertices of the surface, after repairs.
    pub vertices: usize,
    /// Diagonal of its bounding box, in model units.
    pub diagonal: f64,
    /// What was mended.
    pub repairs: Repairs,
    /// Feature curves: creases and open boundaries between corners.
    pub curves: usize,
    /// Corners: ends, junctions and sharp turns of feature curves.
    pub corners: usize,
}

/// What was asked for: one of the two.
#[derive(Clone, Copy, Debug, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Asked {
    /// So many vertices.
    Points(usize),
    /// Tiles of this side, in model units.
    Size(f64),
}

/// Where the heavy stages ran.
#[derive(Clone, Debug, Serialize)]
pub struct Device {
    /// `cpu` or `gpu`.
    pub name: &'static str,
    /// The adapter's name, or the number of threads.
    pub adapter: String,
}

/// The mosaic.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Tiles {
    /// Tiles.
    pub tiles: usize,
    /// Those of them that lie on features.
    pub on_features: usize,
    /// Holes (faces of more than four sides) of the connected mosaic, before they were filled.
    pub holes: usize,
}

/// How long a stage took.
#[derive(Clone, Debug, Serialize)]
pub struct Time {
    /// The stage's name.
    pub stage: &'static str,
    /// Milliseconds.
    pub milliseconds: f64,
}

impl Report {
    /// Measures and checks what [`run`](crate::pipeline::run) made of the surface called `name`.
    pub fn new(name: &str, options: &Options, backend: &dyn Backend, outcome: &Outcome) -> Self {
        let surface = &outcome.surface;
        let times: Vec<Time> = outcome.times.iter().map(|&(stage, time)| Time::new(stage.name(), time)).collect();
        Self {
            version: VERSION,
            program: concat!("quadmosaic ", env!("CARGO_PKG_VERSION")).to_owned(),
            input: Input {
                name: name.to_owned(),
                triangles: surface.triangle_count(),
                vertices: surface.vertex_count(),
                diagonal: surface.frame().diagonal,
                repairs: surface.repairs().clone(),
                curves: surface.features().curves().len(),
                corners: surface.features().corners().count(),
            },
            asked: match options.fineness {
                Fineness::Points(count) => Asked::Points(count),
                Fineness::Size(size) => Asked::Size(size),
            },
            backend: Device { name: backend.name(), adapter: backend.adapter() },
            mosaic: Tiles {
                tiles: outcome.mosaic.count(),
                on_features: outcome.mosaic.sites.len(),
                holes: outcome.holes,
            },
            before: Quality::of(&outcome.before),
            mesh: Quality::of(&outcome.mesh),
            cleaned: outcome.cleaned.clone(),
            faults: check_joined(&outcome.mesh, &outcome.branches),
            total_milliseconds: total(&times),
            times,
        }
    }

    /// Adds the times of what came before and after the pipeline: reading, writing and the like.
    pub fn with_times(mut self, before: &[(&'static str, Duration)], after: &[(&'static str, Duration)]) -> Self {
        let times = |list: &[(&'static str, Duration)]| -> Vec<Time> {
            list.iter().map(|&(stage, time)| Time::new(stage, time)).collect()
        };
        self.times.splice(0..0, times(before));
        self.times.extend(times(after));
        self.total_milliseconds = total(&self.times);
        self
    }
}

fn total(times: &[Time]) -> f64 {
    times.iter().map(|time| time.milliseconds).sum()
}

impl Time {
    fn new(stage: &'static str, time: Duration) -> Self {
        Self { stage, milliseconds: time.as_secs_f64() * 1e3 }
    }
}
