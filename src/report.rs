//! Reports on meshes, fields and mosaics as records that can be written as JSON. The command line prints the same figures.
//!
//! # Practice
//! Compare [`Report::version`] with [`VERSION`] before the fields are read.

mod check;
mod faces;
mod ineffective;
mod parts;
mod singularities;

pub use check::{Against, CheckReport};
pub use faces::{RegionFigures, WorstFace};
pub use ineffective::Ineffective;
pub use parts::{FieldReport, MosaicReport};

use crate::compute::Backend;
use crate::field::{Field, GuideReport, StretchReport};
use crate::mesh::Mesh;
use crate::mesh::check::Faults;
use crate::mesh::compare::Difference;
use crate::mesh::connectivity::EditCounts;
use crate::mesh::quality::Quality;
use crate::mesh::triangulate::Triangulation;
use crate::parametrize::{Distortion, RowEnds};
use crate::pipeline::{Fineness, Options, Outcome, Symmetric};
use crate::sets::Sets;
use crate::surface::{Contacts, Curve, Denoised, Reason, Repairs, Surface};
use crate::symmetry::{Asymmetry, Plane};
use rustc_hash::{FxHashMap, FxHashSet};
use serde::Serialize;
use singularities::{Found, singularities};
use std::collections::BTreeMap;
use std::time::Duration;

/// The version of [`Report`]'s fields. It grows where a field changes its meaning or is removed, not where one is added.
pub const VERSION: u32 = 4;

const PROGRAM: &str = concat!("quadmosaic ", env!("CARGO_PKG_VERSION"));

/// A report on a run.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// [`VERSION`].
    pub version: u32,
    /// The program's name and version.
    pub program: String,
    /// Why the mesh was not written; absent where it was.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
    /// The options by their names on the command line; absent where they were not given there.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub options: Option<GivenOptions>,
    /// The surface.
    pub surface: Input,
    /// The plane of symmetry; absent without one. All figures are those of the whole mesh, but for `edits` and `mosaic.row_ends`,
    /// which are those of the half that was meshed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub symmetry: Option<SymmetryFigures>,
    /// The boundary of the mesh, where it is that of the surface; absent where it is as tiles need it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub boundary: Option<BoundaryFigures>,
    /// The wanted fineness.
    pub asked: Asked,
    /// The backend of the heavy stages.
    pub backend: Device,
    /// The cross field.
    pub field: FieldFigures,
    /// The mosaic.
    pub mosaic: Tiles,
    /// Measures of the mesh before the connectivity optimisation and the relocation.
    pub before: Quality,
    /// Measures of the mesh.
    pub mesh: Quality,
    /// The faces of each region of the mesh.
    pub regions: Vec<RegionFigures>,
    /// The ten faces of the least shape, the worst first.
    pub worst: Vec<WorstFace>,
    /// Irregular vertices of the mesh, and those that the field demands.
    pub regularity: Regularity,
    /// The numbers of edits of the connectivity; absent without the optimisation.
    pub edits: Option<EditCounts>,
    /// Broken invariants of the mesh, with places in model units.
    pub faults: Faults,
    /// Global differences between the mesh and the surface.
    pub differences: Vec<Difference>,
    /// The options that had no effect.
    pub ineffective: Vec<Ineffective>,
    /// The stage that the time limit ended, and the time that it had taken; absent where the run came to its end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub late: Option<Time>,
    /// The time of each stage, in order.
    pub times: Vec<Time>,
    /// The time of all stages, in milliseconds.
    pub total_milliseconds: f64,
}

/// The values of options by their names, as the command line and its files of options have them.
pub type GivenOptions = BTreeMap<String, serde_json::Value>;

/// A report on a run that made no mesh.
#[derive(Clone, Debug, Serialize)]
pub struct FailureReport {
    /// [`VERSION`].
    pub version: u32,
    /// The program's name and version.
    pub program: String,
    /// Why there is no mesh.
    pub error: String,
    /// The options by their names on the command line.
    pub options: GivenOptions,
    /// The name of the surface.
    pub name: String,
}

impl FailureReport {
    /// The report on the run on the surface called `name`.
    pub fn new(name: &str, options: GivenOptions, error: String) -> Self {
        Self { version: VERSION, program: PROGRAM.to_owned(), error, options, name: name.to_owned() }
    }
}

/// A surface.
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
    /// The repairs that were made on it.
    pub repairs: Repairs,
    /// Places where its sheets touch or cross each other without being joined.
    pub contacts: Contacts,
    /// How far its points moved when it was smoothed; `None` where it is not noisy.
    pub denoised: Option<Denoised>,
    /// Feature curves: creases and open boundaries between corners.
    pub curves: usize,
    /// Corners: ends, junctions and sharp turns of feature curves.
    pub corners: usize,
    /// The length of the feature curves, in model units.
    pub curve_length: f64,
    /// Creases that are no features, as they do not persist at the scale of a tile.
    pub dropped: DroppedCreases,
}

/// A plane of symmetry.
#[derive(Clone, Debug, Serialize)]
pub struct SymmetryFigures {
    /// The plane.
    pub plane: Plane,
    /// Whether the plane was looked for, not given.
    pub is_found: bool,
    /// How far the mirror image of the surface is from it.
    pub asymmetry: Asymmetry,
    /// The number of vertices on the plane.
    pub on_plane: usize,
    /// The named regions of the surface that lie below the plane alone, so that the mesh does not have them.
    pub lost_regions: Vec<String>,
}

/// A boundary that was kept.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct BoundaryFigures {
    /// The number of its edges.
    pub edges: usize,
    /// The number of connected parts of the mesh with an odd number of them: each has a triangle.
    pub odd_parts: usize,
}

impl BoundaryFigures {
    fn of(mesh: &Mesh) -> Self {
        let mut parts = Sets::new(mesh.points.len());
        mesh.faces().flat_map(|face| face.windows(2)).for_each(|ends| parts.join(ends[0], ends[1]));
        let edges = mesh.edges();
        let mut counts: FxHashMap<u32, usize> = FxHashMap::default();
        for edge in edges.iter().filter(|edge| edge.is_boundary()) {
            *counts.entry(parts.root(edge.ends[0])).or_default() += 1;
        }
        Self { edges: counts.values().sum(), odd_parts: counts.values().filter(|count| **count % 2 == 1).count() }
    }
}

/// Creases that are no features, by reason.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct DroppedCreases {
    /// Creases too short for tiles, were they sharp.
    pub short: Creases,
    /// Creases at which the surface turns too little at the scale of a tile.
    pub weak: Creases,
    /// Creases that run beside a more persistent one between the same ends.
    pub double: Creases,
}

/// Some creases.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Creases {
    /// Their number.
    pub count: usize,
    /// Their length, in model units.
    pub length: f64,
}

/// The wanted fineness.
#[derive(Clone, Copy, Debug, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Asked {
    /// The number of vertices.
    Points(usize),
    /// The side of tiles, in model units.
    Size(f64),
    /// The sizes of tiles are those of the samples.
    Sampled,
}

/// The backend of the heavy stages.
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
    /// The effect of each guide.
    pub guides: Vec<GuideReport>,
    /// The effect of the wanted aspect of tiles; absent where that is 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stretch: Option<StretchReport>,
}

/// A singularity.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Singularity {
    /// Its place, in model units.
    pub at: [f64; 3],
    /// Its index: the turn of the field round it, in full turns; a multiple of a quarter.
    pub index: f64,
    /// Whether it is a corner of features, whose angles give its index, and no singularity of the field inside the surface.
    pub on_feature: bool,
}

/// The mosaic.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Tiles {
    /// Tiles.
    pub tiles: usize,
    /// The number of tiles that were wanted: more than were asked for where thin parts or a mesh without faults need them.
    pub wanted: usize,
    /// Those of them that lie on features.
    pub on_features: usize,
    /// Holes (faces of more than four sides) of the connected mosaic before filling.
    pub holes: usize,
    /// Row ends before and after the cancellation, and the length of its paths; absent where no row crosses another.
    pub row_ends: Option<RowEnds>,
    /// The distortion of rows that pass over the whole surface; absent where rows may end.
    pub distortion: Option<Distortion>,
    /// The differences between the sides of the tiles.
    pub sides: Option<Sides>,
}

impl Tiles {
    fn new(outcome: &Outcome) -> Self {
        let (mosaic, symmetry) = (&outcome.mosaic, outcome.symmetry.as_ref());
        let on_features = mosaic.feature_samples.len();
        // Tiles on the plane are shared by the halves, and are on features only of the half.
        let doubled = |half: usize, on_plane: usize| symmetry.map_or(half, |_| 2 * half.saturating_sub(on_plane));
        let on_plane = symmetry.map_or(0, |symmetry| symmetry.on_plane);
        Self {
            tiles: doubled(mosaic.count(), on_plane) + on_plane,
            wanted: symmetry.map_or(mosaic.wanted, |symmetry| symmetry.wanted),
            on_features: doubled(on_features, on_plane),
            holes: outcome.meshed.holes,
            row_ends: mosaic.row_ends,
            distortion: mosaic.distortion,
            sides: Sides::of(&outcome.triangulation),
        }
    }
}

/// The differences between the sides of tiles.
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

/// The irregular vertices, which lie inside the surface and have other than four faces.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Regularity {
    /// Those of the mesh.
    pub irregular: usize,
    /// Those that the field demands: its singularities, and corners of features inside the surface.
    pub demanded: usize,
    /// The difference: negative where singularities share a vertex.
    pub surplus: i64,
}

impl Regularity {
    fn of(singularities: &[Found], mesh: &Quality) -> Self {
        let demanded = singularities.iter().filter(|one| one.is_inside).count();
        let irregular = mesh.irregular_vertices;
        Self { irregular, demanded, surplus: irregular as i64 - demanded as i64 }
    }
}

/// The time of a stage.
#[derive(Clone, Debug, Serialize)]
pub struct Time {
    /// The stage's name.
    pub stage: &'static str,
    /// Milliseconds.
    pub milliseconds: f64,
}

impl Report {
    /// The report on a run, [`run`](crate::pipeline::run), with the surface called `name`.
    pub fn new(name: &str, options: &Options, backend: &dyn Backend, outcome: &Outcome) -> Self {
        let (surface, meshed, symmetry) = (&outcome.surface, &outcome.meshed, outcome.symmetry.as_ref());
        let times: Vec<Time> = outcome.times.iter().map(|&(stage, time)| Time::new(stage.name(), time)).collect();
        let (before, mesh) = rayon::join(|| Quality::of(&meshed.before), || Quality::of(&meshed.mesh));
        let found = singularities(surface, &outcome.field, symmetry);
        let whole = symmetry.map_or(surface, |symmetry| &symmetry.surface);
        let mosaic = Tiles::new(outcome);
        Self {
            version: VERSION,
            program: PROGRAM.to_owned(),
            error: None,
            options: None,
            surface: Input::new(name, whole),
            symmetry: symmetry.map(SymmetryFigures::new),
            boundary: options.keep_boundary.map(|_| BoundaryFigures::of(&meshed.mesh)),
            asked: Asked::new(options.fineness),
            backend: Device::new(backend),
            field: FieldFigures::new(&outcome.field, &found),
            ineffective: Ineffective::of(options, whole, &mosaic),
            mosaic,
            before,
            regions: RegionFigures::of(&meshed.mesh),
            worst: WorstFace::of(&meshed.mesh),
            regularity: Regularity::of(&found, &mesh),
            mesh,
            edits: meshed.edits,
            faults: meshed.faults.clone(),
            differences: meshed.differences.clone(),
            late: outcome.late.map(|late| Time::new(late.stage.name(), late.taken)),
            total_milliseconds: total(&times),
            times,
        }
    }

    /// Adds times before and after the pipeline, such as those of reading and writing.
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
            triangles: surface.undivided().triangles,
            vertices: surface.undivided().vertices,
            diagonal: surface.frame().diagonal,
            repairs: surface.repairs().clone(),
            contacts: surface.contacts().clone(),
            denoised: surface.denoised(),
            curves: surface.features().curves().len(),
            corners: surface.features().corners().count(),
            curve_length: surface.frame().diagonal * surface.features().curves().iter().map(Curve::length).sum::<f64>(),
            dropped: DroppedCreases {
                short: dropped(surface, Reason::Short),
                weak: dropped(surface, Reason::Weak),
                double: dropped(surface, Reason::Double),
            },
        }
    }
}

/// The creases of a surface that were dropped for a reason.
fn dropped(surface: &Surface, reason: Reason) -> Creases {
    let edges = || surface.dropped_edges().iter().filter(|edge| edge.reason == reason);
    Creases {
        count: edges().map(|edge| edge.crease).collect::<FxHashSet<u32>>().len(),
        // A sum of nothing is -0.
        length: surface.frame().diagonal * edges().map(|edge| surface.length(edge.half_edge)).sum::<f64>() + 0.0,
    }
}

impl SymmetryFigures {
    fn new(symmetry: &Symmetric) -> Self {
        Self {
            plane: symmetry.plane,
            is_found: symmetry.is_found,
            asymmetry: symmetry.asymmetry,
            on_plane: symmetry.on_plane,
            lost_regions: symmetry.lost_regions.clone(),
        }
    }
}

impl Device {
    fn new(backend: &dyn Backend) -> Self {
        Self { name: backend.name(), adapter: backend.adapter() }
    }
}

impl FieldFigures {
    fn new(field: &Field, found: &[Found]) -> Self {
        Self {
            singularities: found.iter().copied().map(Singularity::from).collect(),
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
