//! Reports on meshes, fields and mosaics, for programs to read; the command line prints the same for people.

use crate::compute::Backend;
use crate::field::{self, Field, GuideReport, SingularityLocation, StretchReport};
use crate::mesh::Mesh;
use crate::mesh::check::{Faults, Kind, check};
use crate::mesh::compare::{Comparison, Difference, check_against};
use crate::mesh::connectivity::EditCounts;
use crate::mesh::quality::Quality;
use crate::mesh::triangulate::Triangulation;
use crate::mosaic::{Mosaic, quality::TileQuality};
use crate::parametrize::RowEnds;
use crate::pipeline::{Fineness, Options, Outcome};
use crate::surface::{Repairs, Surface};
use rustc_hash::FxHashSet;
use serde::Serialize;
use std::time::Duration;

/// The version of [`Report`]'s fields. It grows when a field changes its meaning or goes; new fields leave it as it is.
pub const VERSION: u32 = 4;

const PROGRAM: &str = concat!("quadmosaic ", env!("CARGO_PKG_VERSION"));

/// A run in figures.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// [`VERSION`].
    pub version: u32,
    /// The program's name and version.
    pub program: String,
    /// What was read.
    pub surface: Input,
    /// What was asked for.
    pub asked: Asked,
    /// Where the heavy stages ran.
    pub backend: Device,
    /// The cross field.
    pub field: FieldFigures,
    /// The mosaic.
    pub mosaic: Tiles,
    /// Measures of the mesh before the clean-up and the smoothing.
    pub before: Quality,
    /// Measures of the mesh.
    pub mesh: Quality,
    /// Irregular vertices of the mesh, and those that the field demands.
    pub regularity: Regularity,
    /// The edits of the connectivity; absent where none were asked for.
    pub edits: Option<EditCounts>,
    /// Broken invariants of the mesh, each with its place in model units.
    pub faults: Faults,
    /// What the mesh as a whole has otherwise than the surface.
    pub differences: Vec<Difference>,
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
    /// The repairs that were made.
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
    /// Tiles of the sizes that samples give.
    Sampled,
}

/// Where the heavy stages ran.
#[derive(Clone, Debug, Serialize)]
pub struct Device {
    /// `cpu` or `gpu`.
    pub name: &'static str,
    /// The adapter's name, or the number of threads.
    pub adapter: String,
}

/// The cross field.
#[derive(Clone, Debug, Serialize)]
pub struct FieldFigures {
    /// The singularities, in no particular order.
    pub singularities: Vec<Singularity>,
    /// The sum of their indices: the Euler characteristic.
    pub index_sum: f64,
    /// What became of each guide.
    pub guides: Vec<GuideReport>,
    /// What became of the asked aspect of tiles, unless that is 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stretch: Option<StretchReport>,
}

/// A singularity.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Singularity {
    /// Where, in model units.
    pub at: [f64; 3],
    /// The turn of the field around it, in full turns: a multiple of a quarter.
    pub index: f64,
    /// Whether it is a corner of features, by its angles, and not a singularity of the field itself.
    pub on_feature: bool,
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
    /// Ends of rows before and after they were cancelled, and the length of the paths; absent where no row crosses another.
    pub row_ends: Option<RowEnds>,
    /// How much the sides of the tiles differ.
    pub sides: Option<Sides>,
}

/// How much the sides of tiles differ.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Sides {
    /// The smallest over the mean.
    pub smallest: f64,
    /// The largest over the mean.
    pub largest: f64,
    /// The mean, over all pairs of neighbours, of the larger side over the smaller one.
    pub growth: f64,
}

impl Sides {
    /// Measures the tiles of a triangulation; `None` where it has none.
    fn of(triangulation: &Triangulation) -> Option<Self> {
        let sides: Vec<f64> = triangulation.tiles.iter().map(|tile| f64::from(tile.h)).collect();
        let mean = sides.iter().sum::<f64>() / sides.len() as f64;
        let smallest = sides.iter().copied().reduce(f64::min)?;
        let largest = sides.iter().copied().reduce(f64::max)?;
        let ratios = triangulation.edges().map(|ends| {
            let [a, b] = ends.map(|v| sides[v as usize]);
            a.max(b) / a.min(b)
        });
        let (sum, count) = ratios.fold((0.0, 0), |(sum, count), ratio| (sum + ratio, count + 1));
        let growth = sum / f64::from(count.max(1));
        Some(Self { smallest: smallest / mean, largest: largest / mean, growth })
    }
}

/// Vertices inside the surface at which other than four faces meet, and why.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Regularity {
    /// Those of the mesh.
    pub irregular: usize,
    /// Those that the field demands: its singularities, corners of features inside the surface being some of them.
    pub demanded: usize,
    /// The difference: negative where singularities share a vertex.
    pub surplus: i64,
}

impl Regularity {
    fn of(surface: &Surface, field: &Field, mesh: &Quality) -> Self {
        let open: FxHashSet<u32> = (0..3 * surface.triangle_count() as u32)
            .filter(|&h| surface.twin(h).is_none())
            .flat_map(|h| [surface.origin(h), surface.target(h)])
            .collect();
        let is_inside = |location| !matches!(location, SingularityLocation::Corner(vertex) if open.contains(&vertex));
        let demanded = field.singularities(surface).iter().filter(|one| is_inside(one.location)).count();
        let irregular = mesh.irregular_vertices;
        Self { irregular, demanded, surplus: irregular as i64 - demanded as i64 }
    }
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
        let (surface, meshed) = (&outcome.surface, &outcome.meshed);
        let times: Vec<Time> = outcome.times.iter().map(|&(stage, time)| Time::new(stage.name(), time)).collect();
        let mesh = Quality::of(&meshed.mesh);
        Self {
            version: VERSION,
            program: PROGRAM.to_owned(),
            surface: Input::new(name, surface),
            asked: Asked::new(options.fineness),
            backend: Device::new(backend),
            field: FieldFigures::new(surface, &outcome.field),
            mosaic: Tiles {
                tiles: outcome.mosaic.count(),
                on_features: outcome.mosaic.feature_samples.len(),
                holes: meshed.holes,
                row_ends: outcome.mosaic.row_ends,
                sides: Sides::of(&outcome.triangulation),
            },
            before: Quality::of(&meshed.before),
            regularity: Regularity::of(surface, &outcome.field, &mesh),
            mesh,
            edits: meshed.edits,
            faults: meshed.faults.clone(),
            differences: meshed.differences.clone(),
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

/// A field in figures.
#[derive(Clone, Debug, Serialize)]
pub struct FieldReport {
    /// [`VERSION`].
    pub version: u32,
    /// The program's name and version.
    pub program: String,
    /// What was read.
    pub surface: Input,
    /// Where the heavy stages ran.
    pub backend: Device,
    /// The cross field.
    pub field: FieldFigures,
}

impl FieldReport {
    /// Measures the field of the surface called `name`.
    pub fn new(name: &str, backend: &dyn Backend, surface: &Surface, field: &Field) -> Self {
        Self {
            version: VERSION,
            program: PROGRAM.to_owned(),
            surface: Input::new(name, surface),
            backend: Device::new(backend),
            field: FieldFigures::new(surface, field),
        }
    }
}

/// A mosaic in figures.
#[derive(Clone, Debug, Serialize)]
pub struct MosaicReport {
    /// [`VERSION`].
    pub version: u32,
    /// The program's name and version.
    pub program: String,
    /// What was read.
    pub surface: Input,
    /// What was asked for.
    pub asked: Asked,
    /// Where the heavy stages ran.
    pub backend: Device,
    /// The cross field.
    pub field: FieldFigures,
    /// Tiles.
    pub tiles: usize,
    /// Those of them that lie on features.
    pub on_features: usize,
    /// How well they sit.
    pub fit: TileQuality,
}

impl MosaicReport {
    /// Says what there is to say about the mosaic, and its fit, of the surface called `name`.
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
            field: FieldFigures::new(surface, field),
            tiles: mosaic.count(),
            on_features: mosaic.feature_samples.len(),
            fit,
        }
    }
}

/// A mesh, checked and measured.
#[derive(Clone, Debug, Serialize)]
pub struct CheckReport {
    /// [`VERSION`].
    pub version: u32,
    /// The program's name and version.
    pub program: String,
    /// What the mesh is called.
    pub name: String,
    /// Measures of the mesh; absent where its faces name missing vertices.
    pub mesh: Option<Quality>,
    /// Broken invariants of the mesh, each with its place in model units.
    pub faults: Faults,
    /// What it was compared with; absent where it was with nothing.
    pub against: Option<Against>,
}

/// What a mesh was compared with, and how it differs.
#[derive(Clone, Debug, Serialize)]
pub struct Against {
    /// The surface.
    pub surface: Input,
    /// How the mesh differs from it; absent where the mesh has nothing that could be compared.
    pub comparison: Option<Comparison>,
}

impl CheckReport {
    /// Checks and measures the mesh called `name`, and compares it with a surface and its name where there is one.
    pub fn new(name: &str, mesh: &Mesh, against: Option<(&str, &Surface)>) -> Self {
        let (faults, against) = match against {
            None => (check(mesh), None),
            Some((name, surface)) => {
                let (faults, comparison) = check_against(mesh, surface);
                (faults, Some(Against { surface: Input::new(name, surface), comparison }))
            }
        };
        let measurable = faults.count(|kind| matches!(kind, Kind::MissingVertex { .. })) == 0;
        Self {
            version: VERSION,
            program: PROGRAM.to_owned(),
            name: name.to_owned(),
            mesh: measurable.then(|| Quality::with_holes(mesh, faults.hole_triangles())),
            faults,
            against,
        }
    }

    /// What the mesh as a whole has otherwise than the surface.
    pub fn differences(&self) -> &[Difference] {
        let comparison = self.against.as_ref().and_then(|against| against.comparison.as_ref());
        comparison.map_or(&[], |comparison| &comparison.differences)
    }
}

impl Asked {
    fn new(fineness: Fineness) -> Self {
        match fineness {
            Fineness::Points(count) => Self::Points(count),
            Fineness::Size(size) => Self::Size(size),
            Fineness::Sampled => Self::Sampled,
        }
    }
}

impl Input {
    fn new(name: &str, surface: &Surface) -> Self {
        Self {
            name: name.to_owned(),
            triangles: surface.triangle_count(),
            vertices: surface.vertex_count(),
            diagonal: surface.frame().diagonal,
            repairs: surface.repairs().clone(),
            curves: surface.features().curves().len(),
            corners: surface.features().corners().count(),
        }
    }
}

impl Device {
    fn new(backend: &dyn Backend) -> Self {
        Self { name: backend.name(), adapter: backend.adapter() }
    }
}

impl FieldFigures {
    fn new(surface: &Surface, field: &Field) -> Self {
        let found = field.singularities(surface);
        let singularity = |singularity: &field::Singularity| Singularity {
            at: surface.frame().to_model(singularity.position),
            index: singularity.index(),
            on_feature: matches!(singularity.location, SingularityLocation::Corner(_)),
        };
        Self {
            singularities: found.iter().map(singularity).collect(),
            index_sum: f64::from(found.iter().map(|singularity| singularity.quarters).sum::<i32>()) / 4.0,
            guides: field.guides().to_vec(),
            stretch: field.stretch().map(|stretch| *stretch.report()),
        }
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
