//! The whole method: from a triangle surface to a quad-dominant mesh.
//!
//! # Theory
//! The paper's abstract and sections 2 and 3: a mosaic of equal square tiles, aligned with a field, covers the surface. The
//! tiles' centres are connected up, down, left and right, holes are filled by patterns, and clean-up turns triangles into
//! quads.
//!
//! # Changes versus the paper
//! The mosaic is made here, by a periodic solve. Clean-up is one of several operations on the connectivity. Vertices are
//! relocated, remaining faults are untangled, and the mesh is compared with the surface. See [`paper`](crate::paper).
//!
//! # Practice
//! Call [`run`] with [`Options::new`]. Then check [`Meshed::faults`] and [`Meshed::differences`]: a mesh with either is returned
//! all the same.

mod layout;
mod prepare;
mod symmetric;

pub use layout::{Contradiction, Layout};
pub use prepare::prepare;
pub use symmetric::Symmetric;

use self::prepare::{Prepared, Sizing, prepared, repaired};
use crate::compute::{Backend, ComputeError, Watched};
use crate::field::{Align, Field, FieldOptions, Stretch, StretchError};
use crate::mesh::check::Faults;
use crate::mesh::compare::Difference;
use crate::mesh::connect::{ConnectOptions, connect};
use crate::mesh::connectivity::{ConnectivityOptions, EditCounts, Quads, optimise, untangle};
use crate::mesh::fill::{Holes, fill};
use crate::mesh::finish::{Finished, finish, joined};
use crate::mesh::relocate::relocate;
use crate::mesh::snap::snap;
use crate::mesh::triangulate::triangulate_while;
use crate::mesh::{Context, Mesh, SurfaceMesh, Triangulation, VertexAttributes};
use crate::mosaic::{self, Effort, Mosaic, MosaicBuilder};
use crate::parametrize::Rows;
use crate::parametrize::integrable_sizes::{integrable_sizes, limit_chord_error};
use crate::progress::{Cancelled, Progress};
use crate::sizes::{FEW, SizeOptions, Sizes, SizesError};
use crate::surface::{
    BoundaryError, FeatureOptions, KeptBoundary, NamedEdge, RepairOptions, Soup, Surface, SurfaceError,
};
use crate::symmetry::{Symmetry, SymmetryError};
use std::iter::zip;
use std::time::{Duration, Instant};
use thiserror::Error;

pub use crate::progress::{Stage, Watch, unwatched};

/// The fineness of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fineness {
    /// A number of vertices.
    Points(usize),
    /// The number of equal tiles of this side, in model units, that cover the surface.
    Size(f64),
    /// The number of tiles of the sizes of the samples, in model units, that cover the surface.
    Sampled,
}

/// Options of the method.
#[derive(Clone, Debug)]
pub struct Options {
    /// The fineness of the mesh.
    pub fineness: Fineness,
    /// The plane about which [`run`] makes the mesh symmetric, bit for bit. Default: none.
    pub symmetry: Option<Symmetry>,
    /// The boundary vertices of the mesh, so that patches of one surface that are meshed apart fit together. Default: as tiles need
    /// them.
    pub keep_boundary: Option<KeptBoundary>,
    /// The repairs of the surface.
    pub repairs: RepairOptions,
    /// The features of the surface.
    pub features: FeatureOptions,
    /// Edges of the surface that are features at any angle.
    pub edges: Vec<NamedEdge>,
    /// The constraints of the field beside features.
    pub field: FieldOptions,
    /// The layout that [`rows`](Self::rows), [`fit`](Self::fit) and [`Quads`] were set for by [`Options::with_layout`]; what
    /// contradicts it is refused. Default: the mosaic, which nothing contradicts.
    pub layout: Layout,
    /// Whether rows of tiles may end.
    pub rows: Rows,
    /// The degree to which the sides of tiles follow the field so that fewer rows end, from 0 (not at all) to 1. Default 0.
    pub fit: f64,
    /// The largest side over the mean one, and the mean over the smallest, that fitting may ask for. Default 2.5.
    pub fit_range: f64,
    /// The longer side of a tile, which lies along the guides, over the shorter one, from 1 to 20. Default 1: squares.
    pub aspect: f64,
    /// The wanted sizes of tiles.
    pub sizes: SizeOptions,
    /// The constraints of edges between tiles.
    pub connect: ConnectOptions,
    /// The way in which holes are filled.
    pub holes: Holes,
    /// Options of the connectivity optimisation; `None`: no edits, the connectivity stays as it is after filling.
    pub connectivity: Option<ConnectivityOptions>,
    /// Passes of relocation. Default 6; 0: vertices stay where the tiles were.
    pub smoothing: usize,
}

impl Options {
    /// The default options at a fineness.
    pub fn new(fineness: Fineness) -> Self {
        Self {
            fineness,
            symmetry: None,
            keep_boundary: None,
            repairs: RepairOptions::default(),
            features: FeatureOptions::default(),
            edges: Vec::new(),
            field: FieldOptions::default(),
            layout: Layout::default(),
            rows: Rows::default(),
            fit: 0.0,
            fit_range: 2.5,
            aspect: 1.0,
            sizes: SizeOptions::default(),
            connect: ConnectOptions::default(),
            holes: Holes::default(),
            connectivity: Some(ConnectivityOptions::default()),
            smoothing: 6,
        }
    }

    /// The same options with the paper's clean-up as the only operation on the connectivity.
    pub fn with_paper_clean_up(self) -> Self {
        let paper = ConnectivityOptions { quads: Quads::Paper, ..self.connectivity.unwrap_or_default() };
        Self { connectivity: Some(paper), ..self }
    }
}

/// The reason why no mesh was made.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PipelineError {
    /// The surface cannot be meshed.
    #[error(transparent)]
    Surface(SurfaceError),
    /// The backend failed.
    #[error(transparent)]
    Compute(ComputeError),
    /// The surface has no symmetry as asked.
    #[error(transparent)]
    Symmetry(#[from] SymmetryError),
    /// The boundary cannot be kept as asked.
    #[error(transparent)]
    Boundary(#[from] BoundaryError),
    /// The wanted sizes are invalid.
    #[error(transparent)]
    Sizes(#[from] SizesError),
    /// Tiles cannot have the wanted aspect.
    #[error(transparent)]
    Stretch(StretchError),
    /// An option contradicts the layout.
    #[error(transparent)]
    Contradiction(#[from] Contradiction),
    /// The wanted fineness is invalid.
    #[error(transparent)]
    Fineness(#[from] FinenessError),
    /// The progress function cancelled the run.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl From<SurfaceError> for PipelineError {
    fn from(error: SurfaceError) -> Self {
        match error {
            SurfaceError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            error => Self::Surface(error),
        }
    }
}

impl From<ComputeError> for PipelineError {
    fn from(error: ComputeError) -> Self {
        match error {
            ComputeError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            error => Self::Compute(error),
        }
    }
}

impl From<StretchError> for PipelineError {
    fn from(error: StretchError) -> Self {
        match error {
            StretchError::Compute(error) => error.into(),
            error => Self::Stretch(error),
        }
    }
}

/// Why a surface cannot have a wanted fineness.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum FinenessError {
    /// The number of vertices is none of [`POINTS`].
    #[error("a mesh of {asked} points cannot be made; ask for {} to {}", POINTS.start(), POINTS.end())]
    Points {
        /// The number that was asked for.
        asked: usize,
    },
    /// Tiles of the side are larger than the surface, or too many.
    #[error("tiles of side {asked} cannot cover this surface; ask for {least:.3e} to {most:.3e}, its diagonal")]
    Size {
        /// The side that was asked for, in model units.
        asked: f64,
        /// The least side, in model units.
        least: f64,
        /// The diagonal of the surface, in model units.
        most: f64,
    },
    /// Sizes are to give the number of vertices, and there are none.
    #[error("no sizes are given; give some, or ask for a number of points")]
    NoSizes,
    /// The sizes give too many vertices.
    #[error(
        "the surface takes {count:.3e} tiles of the given sizes; ask for larger ones, in model units, so that {} are enough",
        POINTS.end()
    )]
    SmallSizes {
        /// The number of tiles.
        count: f64,
    },
}

/// The results of all stages. Coordinates are unit-sized, but for those of meshes, which are in model units.
///
/// With [`Options::symmetry`] the mesh is that of the whole surface; surface, field, mosaic, triangulation and edits are those of the
/// half that was meshed.
pub struct Outcome {
    /// The surface.
    pub surface: Surface,
    /// Its cross field.
    pub field: Field,
    /// The tiles.
    pub mosaic: Mosaic,
    /// Their triangulation.
    pub triangulation: Triangulation,
    /// The mesh.
    pub meshed: Meshed,
    /// The plane of symmetry and the whole surface; `None` without symmetry.
    pub symmetry: Option<Symmetric>,
    /// The time of each stage.
    pub times: Vec<(Stage, Duration)>,
}

/// The results of the stages from [`Stage::Connect`] on.
pub struct Meshed {
    /// The mesh before the connectivity optimisation, in model units.
    pub before: Mesh,
    /// The number of holes of the connected mosaic before filling.
    pub holes: usize,
    /// The numbers of edits of the connectivity; `None` without the optimisation.
    pub edits: Option<EditCounts>,
    /// The mesh, in model units.
    pub mesh: Mesh,
    /// What is known of each vertex of the mesh.
    pub vertices: Vec<VertexAttributes>,
    /// Whether sheets of the surface meet at each of its vertices.
    pub branches: Vec<bool>,
    /// The broken invariants of the mesh, with places in model units.
    pub faults: Faults,
    /// The global differences between the mesh and the surface.
    pub differences: Vec<Difference>,
}

impl Outcome {
    /// The logarithm of the number of vertices over the wanted one; 0 where no number is asked for.
    fn miss(&self, options: &Options) -> f64 {
        match options.fineness {
            Fineness::Points(_) => (self.meshed.mesh.points.len().max(1) as f64 / self.mosaic.wanted as f64).ln(),
            Fineness::Size(_) | Fineness::Sampled => 0.0,
        }
    }
}

impl Meshed {
    /// The number of faults and differences.
    fn wrong(&self) -> usize {
        self.faults.list.len() + self.differences.len()
    }

    /// Whether nearly all faces were faults before the edits: the surface is broken, so that smaller tiles would not help.
    fn is_hopeless(&self) -> bool {
        self.edits.is_some_and(|edits| 10 * edits.faults_before > 9 * self.before.face_count())
    }

    /// The places of the faults and differences, in model units.
    fn faulty_places(&self) -> Vec<[f64; 3]> {
        let of_differences = self.differences.iter().filter_map(|difference| match *difference {
            Difference::Uncovered { at, .. } | Difference::KeptBoundary { at, .. } => Some(at),
            _ => None,
        });
        self.faults.list.iter().map(|fault| fault.at).chain(of_differences).collect()
    }
}

/// The least [`ConnectivityOptions::regularity`] where rows are continuous.
const CONTINUOUS_REGULARITY: f64 = 1.0;
/// The least number of sweeps of a field that sides follow: sides fit a harmonic angle best.
const HARMONIC_SWEEPS: u32 = 150;
/// The most rounds of untangling and relocation.
const UNTANGLING_ROUNDS: usize = 3;
/// The most times that a mesh is made again, for its faults or its count.
const REPEATS: usize = 5;
/// A mesh that misses the wanted count by a larger share is made again.
const COUNT_TOLERANCE: f64 = 0.02;
/// A mesh of more vertices than [`LARGE`] is not made again, as it takes long, where it still has more than two thirds of the faults,
/// and more than so many, or is no better for so many times.
const MANY: usize = 10;
const MOST_FUTILE: usize = 2;
const LARGE: usize = 3_000;
/// The most times of the asked count, or of [`FEW`] where that is more, to which this raises it.
const MOST_RAISED: usize = 12;

/// The numbers of vertices that can be asked for.
pub const POINTS: std::ops::RangeInclusive<usize> = 4..=50_000_000;

/// Meshes a soup of triangles. `watch` receives each stage and the share of it that is done; it is called at least every tenth of a
/// second or so, and can cancel the run.
///
/// A mesh with faults is made again, with smaller tiles there; one that misses the count, with more tiles or fewer.
///
/// # Errors
/// Where the surface cannot be meshed, the options are invalid, the backend fails, or `watch` cancels the run.
pub fn run(soup: &Soup, options: &Options, backend: &dyn Backend, watch: &Watch) -> Result<Outcome, PipelineError> {
    Contradiction::expect_none(options)?;
    if let Some(symmetry) = options.symmetry {
        return symmetric::run_symmetric(soup, symmetry, options, backend, watch);
    }
    let progress = &Progress::new(watch);
    let backend = &Watched { backend, progress };
    let mut clock = Clock::new(progress);
    clock.begin(Stage::Surface)?;
    let prepared = prepared(repaired(soup, options, progress)?, options, progress)?;
    let (sizing, first) = attempt(prepared, options, backend, clock)?;
    improve(first, sizing, options, backend, progress)
}

/// Makes a mesh again that has faults, with smaller tiles there, or misses the count, with more tiles or fewer; returns the best one.
fn improve(
    mut best: Outcome,
    mut sizing: Sizing,
    options: &Options,
    backend: &dyn Backend,
    progress: &Progress,
) -> Result<Outcome, PipelineError> {
    let (mut places, mut miss) = (best.meshed.faulty_places(), best.miss(options));
    // The surface of the latest mesh, where that is not the best one.
    let mut latest = None;
    let mut futile = 0;
    for _ in 0..REPEATS {
        let is_off = miss.abs() > COUNT_TOLERANCE;
        // For the count alone one correction is enough, or does not help.
        if places.is_empty() && !(is_off && sizing.aim == 1.0) || best.meshed.is_hopeless() {
            break;
        }
        let mut clock = Clock::new(progress);
        clock.begin(Stage::Surface)?;
        let surface = latest.take().unwrap_or_else(|| best.surface.clone());
        if !places.is_empty() {
            sizing = sizing.refined(&surface, &places)?;
        }
        if is_off {
            sizing.aim *= (-miss).exp();
        }
        let prepared = sizing.sized(surface, options, progress)?;
        if prepared.count > MOST_RAISED * prepared.sizing.count.max(FEW) {
            break;
        }
        let (corrected, next) = attempt(prepared, options, backend, clock)?;
        let times = zip(&best.times, &next.times).map(|(spent, more)| (spent.0, spent.1 + more.1)).collect();
        let (before, after) = (best.meshed.wrong(), next.meshed.wrong());
        let is_large = next.meshed.mesh.points.len() > LARGE;
        (sizing, places, miss) = (corrected, next.meshed.faulty_places(), next.miss(options));
        let rank = |wrong: usize, miss: f64| (wrong, miss.abs().max(COUNT_TOLERANCE));
        if rank(after, miss) < rank(before, best.miss(options)) {
            (best, futile) = (next, 0);
        } else {
            (latest, futile) = (Some(next.surface), futile + 1);
        }
        best.times = times;
        if is_large && (futile == MOST_FUTILE || after > MANY.max(2 * before / 3)) {
            break;
        }
    }
    Ok(best)
}

fn attempt<'a>(
    prepared: Prepared<'a>,
    options: &Options,
    backend: &dyn Backend,
    mut clock: Clock,
) -> Result<(Sizing<'a>, Outcome), PipelineError> {
    let Prepared { surface, mut sizing, sizes, count } = prepared;
    let aim = ((sizing.aim * count as f64).round() as usize).max(*POINTS.start());
    let progress = clock.progress;

    clock.begin(Stage::Field)?;
    let field = field(&surface, sizes, count, options, backend)?;

    clock.begin(Stage::Mosaic)?;
    let advance = |share| progress.advance(share);
    let builder = builder(&surface, &field, backend, options, &advance);
    let mosaic = laid(&MosaicBuilder { first_scale: sizing.first_scale, ..builder }, aim, options)?;
    let mosaic = Mosaic { wanted: count, ..mosaic };
    sizing.first_scale = f64::from(mosaic.scale / field.sizes().side_for_count(&surface, aim));

    clock.begin(Stage::Connect)?;
    let context = || Context::new(&surface).watched(progress);
    let triangulation = || triangulate_while(&surface, &field, &mosaic, &|| !progress.is_cancelled());
    let (triangulation, context) = rayon::join(triangulation, context);
    let triangulation = triangulation.ok_or(Cancelled)?;
    let meshed = meshed(context, &mosaic, &triangulation, options, &mut clock)?;

    let times = clock.finish()?;
    Ok((sizing, Outcome { surface, field, mosaic, triangulation, meshed, symmetry: None, times }))
}

/// The stages of [`run`] from [`Stage::Connect`] on, for tiles that are triangulated already.
///
/// # Errors
/// Where `watch` cancels the run.
pub fn connected(
    surface: &Surface,
    mosaic: &Mosaic,
    triangulation: &Triangulation,
    options: &Options,
    watch: &Watch,
) -> Result<Meshed, Cancelled> {
    let progress = &Progress::new(watch);
    meshed(Context::new(surface).watched(progress), mosaic, triangulation, options, &mut Clock::new(progress))
}

fn meshed(
    mut context: Context,
    mosaic: &Mosaic,
    triangulation: &Triangulation,
    options: &Options,
    clock: &mut Clock,
) -> Result<Meshed, Cancelled> {
    let edges = connect(triangulation, &options.connect);

    clock.begin(Stage::Fill)?;
    let (mut mesh, holes) = fill(&context, triangulation, &edges, options.holes);
    let before = joined(&context, &mesh, triangulation);

    clock.begin(Stage::Connectivity)?;
    let connectivity = connectivity(options, &before, mosaic);
    let mut edits = connectivity.map(|connectivity| optimise(&context, &mut mesh, &connectivity));

    clock.begin(Stage::Relocate)?;
    relocate(&context, &mut mesh, options.smoothing);
    if let (Some(connectivity), Some(edits)) = (connectivity, &mut edits) {
        untangle_and_relocate(&context, &mut mesh, &connectivity, options.smoothing, edits);
    }
    if options.smoothing > 0 {
        snap(&context, &mut mesh);
    }
    mesh = mesh.compacted();
    let mut opposed = mesh.opposed_faces(&context);
    if let (Some(connectivity), Some(edits)) = (connectivity, &mut edits)
        && (1..=mesh.faces().count() / THIN).contains(&opposed.len())
    {
        context.let_nearest_decide();
        untangle_and_relocate(&context, &mut mesh, &connectivity, options.smoothing, edits);
        mesh = mesh.compacted();
        let left = mesh.faults(&context);
        if mesh.free_from_curves(context.surface, &left) {
            untangle_and_relocate(&context, &mut mesh, &connectivity, options.smoothing, edits);
            mesh = mesh.compacted();
        }
        opposed = mesh.opposed_faces(&context);
    }

    clock.begin(Stage::Finish)?;
    let Finished { mesh, vertices, branches, faults, differences } =
        finish(&context, &mesh, &opposed, mosaic, triangulation);
    Ok(Meshed { before, holes, edits, mesh, vertices, branches, faults, differences })
}

/// Where a larger share of the faces than one in so many is nearer to an opposite sheet, the surface is thinner than its tiles
/// throughout, and edits would only spoil shapes.
const THIN: usize = 100;

/// The options of the connectivity optimisation, completed by the mesh before it and by the other options.
fn connectivity(options: &Options, before: &Mesh, mosaic: &Mosaic) -> Option<ConnectivityOptions> {
    let given = options.connectivity?;
    let excess = match options.fineness {
        Fineness::Points(_) => before.points.len() as i64 - mosaic.aimed as i64,
        Fineness::Size(_) | Fineness::Sampled => 0,
    };
    let regularity = match options.rows {
        Rows::Paper => given.regularity,
        Rows::Continuous => given.regularity.max(CONTINUOUS_REGULARITY),
    };
    Some(ConnectivityOptions { excess, regularity, ..given })
}

/// Untangles faults and relocates vertices in turns, until no fault is left or no edit helps.
fn untangle_and_relocate(
    context: &Context,
    mesh: &mut SurfaceMesh,
    options: &ConnectivityOptions,
    passes: usize,
    edits: &mut EditCounts,
) {
    for _ in 0..UNTANGLING_ROUNDS {
        if context.is_cancelled() || !untangle(context, mesh, options, edits) {
            break;
        }
        relocate(context, mesh, passes);
    }
}

/// The field for `count` tiles. Curvature is measured at their scale. The field has the sizes of the tiles: `sizes`, times those
/// that fit the field with [`Options::fit`].
///
/// # Errors
/// Where the backend fails, or tiles cannot have the wanted aspect.
pub fn field(
    surface: &Surface,
    sizes: Sizes,
    count: usize,
    options: &Options,
    backend: &dyn Backend,
) -> Result<Field, PipelineError> {
    let side = surface.frame().diagonal * f64::from(mosaic::side_for_count(surface, count));
    let align = options.field.align.map(|align| Align { side: align.side.or(Some(side)), ..align });
    let sweeps = if options.fit > 0.0 { HARMONIC_SWEEPS.max(options.field.sweeps) } else { options.field.sweeps };
    let field = Field::new(surface, &FieldOptions { align, sweeps, ..options.field.clone() }, backend)?;
    if options.aspect != 1.0 {
        // The side of equal tiles; where sizes vary, it is the mean side.
        let side = f64::from(mosaic::side_for_count(surface, count));
        let stretch = Stretch::new(surface, &field, &options.field.guides, options.aspect, side, backend)?;
        return Ok(field.with_sizes(sizes).with_stretch(stretch));
    }
    if options.fit == 0.0 {
        return Ok(field.with_sizes(sizes));
    }
    let fitting = integrable_sizes(surface, &field, options.fit_range, backend)?;
    let mut fitting: Vec<f32> = fitting.iter().map(|log| (options.fit * log).exp() as f32).collect();
    let side = f64::from(mosaic::side_for_count(surface, count));
    limit_chord_error(surface, side, &mut fitting);
    let fitting = Sizes::from_vertices(surface, fitting)?.limited(surface, side, options.sizes.growth);
    Ok(field.with_sizes(sizes.times(&fitting)))
}

/// A mosaic of nearly `count` tiles, or of the tiles that sizes in model units give; `progress` receives the share that is done, from 0 to 1.
///
/// # Errors
/// Where the backend fails.
pub fn lay(
    surface: &Surface,
    field: &Field,
    backend: &dyn Backend,
    count: usize,
    options: &Options,
    progress: &dyn Fn(f32),
) -> Result<Mosaic, ComputeError> {
    laid(&builder(surface, field, backend, options, progress), count, options)
}

fn builder<'a>(
    surface: &'a Surface,
    field: &'a Field,
    backend: &'a dyn Backend,
    options: &Options,
    progress: &'a dyn Fn(f32),
) -> MosaicBuilder<'a> {
    let (effort, rows) = (Effort::default(), options.rows);
    MosaicBuilder { surface, field, backend, effort, rows, first_scale: 1.0, progress }
}

fn laid(builder: &MosaicBuilder, count: usize, options: &Options) -> Result<Mosaic, ComputeError> {
    let is_absolute = !matches!(options.fineness, Fineness::Points(_)) && !builder.field.sizes().is_equal();
    if is_absolute { builder.at_scale_for(count) } else { builder.with_count(count) }
}

/// Measures the times of stages and reports their progress.
struct Clock<'a> {
    progress: &'a Progress<'a>,
    times: Vec<(Stage, Duration)>,
    started: Instant,
}

impl<'a> Clock<'a> {
    fn new(progress: &'a Progress<'a>) -> Self {
        Self { progress, times: Vec::new(), started: Instant::now() }
    }

    fn begin(&mut self, stage: Stage) -> Result<(), Cancelled> {
        self.end()?;
        self.times.push((stage, Duration::ZERO));
        self.progress.report(stage, 0.0)
    }

    fn end(&mut self) -> Result<(), Cancelled> {
        let now = Instant::now();
        if let Some((stage, time)) = self.times.last_mut() {
            *time = now - self.started;
            self.progress.report(*stage, 1.0)?;
        }
        self.started = now;
        Ok(())
    }

    fn finish(mut self) -> Result<Vec<(Stage, Duration)>, Cancelled> {
        self.end()?;
        Ok(self.times)
    }
}
