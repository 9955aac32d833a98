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

mod clock;
mod error;
mod fallback;
mod improve;
mod layout;
mod limits;
mod prepare;
mod symmetric;

pub use error::{FinenessError, PipelineError};
pub use layout::{Contradiction, Layout};
pub use limits::{Fits, LimitError, Limits, predicted_memory};
pub use prepare::prepare;
pub use symmetric::Symmetric;

use self::clock::Clock;
use self::fallback::lay_carried;
use self::improve::{improve, most_raised};
use self::prepare::{Prepared, Sizing, approximate_count, prepared, repaired};
use crate::compute::{Backend, ComputeError, Watched};
use crate::field::{Align, Field, FieldOptions, Stretch};
use crate::mesh::check::Faults;
use crate::mesh::compare::Difference;
use crate::mesh::connect::{ConnectOptions, connect};
use crate::mesh::connectivity::{ConnectivityOptions, EditCounts, Quads, optimise, quadrangulate, untangle};
use crate::mesh::cover::cover;
use crate::mesh::fill::{Holes, fill};
use crate::mesh::finish::{Finished, finish, joined};
use crate::mesh::relocate::{relocate, relocate_about};
use crate::mesh::snap::snap;
use crate::mesh::triangulate::triangulate_while;
use crate::mesh::{Context, Mesh, Standing, SurfaceMesh, Triangulation, VertexAttributes};
use crate::mosaic::{self, Effort, Mosaic, MosaicBuilder};
use crate::parametrize::Rows;
use crate::parametrize::integrable_sizes::{integrable_sizes, limit_chord_error};
use crate::progress::{Cancelled, Progress};
use crate::sizes::{SizeOptions, Sizes};
use crate::surface::{FeatureOptions, KeptBoundary, NamedEdge, RepairOptions, Soup, Surface};
use crate::symmetry::Symmetry;
use std::time::Duration;

pub use crate::progress::{Late, Stage, Watch, unwatched};

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
    /// The memory and the time that [`run`] may take. Default: any.
    pub limits: Limits,
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
            limits: Limits::default(),
        }
    }

    /// The same options with the paper's clean-up as the only operation on the connectivity.
    pub fn with_paper_clean_up(self) -> Self {
        let paper = ConnectivityOptions { quads: Quads::Paper, ..self.connectivity.unwrap_or_default() };
        Self { connectivity: Some(paper), ..self }
    }
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
    /// Where the time limit ended the run; `None` where it came to its end.
    pub late: Option<Late>,
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

/// The least [`ConnectivityOptions::regularity`] where rows are continuous.
const CONTINUOUS_REGULARITY: f64 = 1.0;
/// The least number of sweeps of a field that sides follow: sides fit a harmonic angle best.
const HARMONIC_SWEEPS: u32 = 150;
/// Singularities nearer to a feature than this, in tile sides, move onto it where rows are continuous.
const ABSORBED: f64 = 1.0;
/// The most rounds of untangling and relocation.
const UNTANGLING_ROUNDS: usize = 8;
/// A surface whose triangles, once those that are long are divided, are more than so many a tile is coarsened: the time grows with
/// them, and tiles do not need them.
const MOST_PARTS: usize = 8;
/// The numbers of vertices that can be asked for.
pub const POINTS: std::ops::RangeInclusive<usize> = 4..=50_000_000;

/// Meshes a soup of triangles. `watch` receives each stage and the share of it that is done; it is called at least every tenth of a
/// second or so, and can cancel the run.
///
/// A mesh with faults is made again, with smaller tiles there; one that misses the count, with more tiles or fewer.
///
/// # Errors
/// Where the surface cannot be meshed, the options are invalid, the backend fails, `watch` cancels the run, or a limit is too tight for
/// any mesh.
pub fn run(soup: &Soup, options: &Options, backend: &dyn Backend, watch: &Watch) -> Result<Outcome, PipelineError> {
    Contradiction::expect_none(options)?;
    options.limits.expect_memory(soup.triangles.len(), approximate_count(soup, options))?;
    let progress = &Progress::new(watch).within(options.limits.time);
    let done = match options.symmetry {
        Some(symmetry) => symmetric::run_symmetric(soup, symmetry, options, backend, progress),
        None => run_watched(soup, options, backend, progress),
    };
    match (done, progress.late()) {
        (Err(PipelineError::Cancelled(_)), Some(late)) => Err(LimitError::Time(late).into()),
        (done, late) => Ok(Outcome { late, ..done? }),
    }
}

/// As [`run`], without symmetry.
fn run_watched(
    soup: &Soup,
    options: &Options,
    backend: &dyn Backend,
    progress: &Progress,
) -> Result<Outcome, PipelineError> {
    let most = if let Fineness::Points(asked) = options.fineness { most_raised(asked) } else { 0 };
    let (mut best, mut raised) = made(soup, options, backend, progress)?;
    while let Some(count) = raised.filter(|&count| count <= most) {
        // The features, the noise and the thin parts were those that tiles of the asked count see, which are far larger.
        let finer = Options { fineness: Fineness::Points(count), ..options.clone() };
        let (other, more) = match made(soup, &finer, backend, progress) {
            Err(PipelineError::Limit(_)) => break,
            Err(PipelineError::Cancelled(_)) if progress.late().is_some() => break,
            done => done?,
        };
        let times = best.times_with(&other);
        if other.meshed.wrong() < best.meshed.wrong() {
            best = other;
        }
        (best.times, raised) = (times, more);
    }
    Ok(best)
}

/// The mesh of [`run_watched`] for the asked count, and the count for which it is to be made anew.
fn made(
    soup: &Soup,
    options: &Options,
    backend: &dyn Backend,
    progress: &Progress,
) -> Result<(Outcome, Option<usize>), PipelineError> {
    let backend = &Watched { backend, progress };
    let mut clock = Clock::new(progress);
    clock.begin(Stage::Surface)?;
    let prepared = prepared(repaired(soup, options, progress)?, options, progress)?;
    options.limits.expect_memory(soup.triangles.len(), prepared.count)?;
    let (sizing, mut best) = attempt(prepared, options, backend, clock)?;
    match improve(&mut best, sizing, options, backend, progress) {
        Err(PipelineError::Cancelled(_)) if progress.late().is_some() => Ok((best, None)),
        improved => improved.map(|raised| (best, raised)),
    }
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

    let (field, mosaic) =
        lay_carried(&surface, &sizes, [count, aim], &mut sizing.carried, options, backend, &mut clock)?;
    let options = &sizing.carried.fallback.applied(options);
    let mosaic = Mosaic { wanted: count, ..mosaic };
    let thin = if sizing.carried.is_refined { THIN_REFINED } else { THIN };
    sizing.carried.first_scale = Some(f64::from(mosaic.scale / field.sizes().side_for_count(&surface, aim)));

    clock.begin(Stage::Connect)?;
    let context = || Context::new(&surface).watched(progress);
    let triangulation = || triangulate_while(&surface, &field, &mosaic, &|| !progress.is_cancelled());
    let (triangulation, context) = rayon::join(triangulation, context);
    let triangulation = triangulation.ok_or(Cancelled)?;
    let meshed = meshed(context, &mosaic, &triangulation, options, thin, &mut clock)?;

    let times = clock.finish()?;
    Ok((sizing, Outcome { surface, field, mosaic, triangulation, meshed, symmetry: None, times, late: None }))
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
    meshed(Context::new(surface).watched(progress), mosaic, triangulation, options, THIN, &mut Clock::new(progress))
}

/// The stages from [`Stage::Connect`] on. Where a larger share of the faces than one in `thin` opposes the surface, they are not mended.
fn meshed(
    mut context: Context,
    mosaic: &Mosaic,
    triangulation: &Triangulation,
    options: &Options,
    thin: usize,
    clock: &mut Clock,
) -> Result<Meshed, Cancelled> {
    let edges = connect(triangulation, &options.connect);

    clock.begin(Stage::Fill)?;
    let (mut mesh, holes) = fill(&context, triangulation, &edges, options.holes);
    let before = joined(&context, &mesh, triangulation);
    clock.progress.check()?;

    clock.begin_improving(Stage::Connectivity)?;
    // Where sheets meet, each has vertices of its own.
    let doubled = mesh.vertices().len() - before.points.len();
    let connectivity = connectivity(options, mosaic.aimed + doubled);
    let mut edits = connectivity.map(|connectivity| optimise(&context, &mut mesh, &connectivity));

    clock.begin_improving(Stage::Relocate)?;
    relocate(&context, &mut mesh, options.smoothing);
    if let (Some(connectivity), Some(edits)) = (connectivity, &mut edits) {
        untangle_and_relocate(&context, &mut mesh, &connectivity, options.smoothing, edits);
    }
    let (without_discs, edits_before) = (mesh.clone(), edits);
    if let (Some(connectivity), Some(edits)) = (connectivity, &mut edits)
        && quadrangulate(&context, &mut mesh, &connectivity, edits)
    {
        relocate_about(&context, &mut mesh, options.smoothing, without_discs.vertices().len() as u32);
        untangle_and_relocate(&context, &mut mesh, &connectivity, options.smoothing, edits);
    }
    let has_discs = edits != edits_before;
    let (mesh, mut opposed) = settled(&mut context, mesh, connectivity, options.smoothing, thin, &mut edits);

    clock.begin(Stage::Finish)?;
    let is_late = clock.progress.late().is_some();
    if is_late {
        // The search for them was ended too.
        opposed = mesh.opposed_faces(&context);
    }
    let mut finished = completed(&context, mesh, &opposed, mosaic, triangulation, options.smoothing);
    if has_discs && (1..=MOST_FAULTS_OF_DISCS).contains(&wrong(&finished)) && !is_late {
        context.let_nearest_decide(&without_discs, &[]);
        let mut other_edits = edits_before;
        let (mesh, opposed) =
            settled(&mut context, without_discs, connectivity, options.smoothing, thin, &mut other_edits);
        let other = completed(&context, mesh, &opposed, mosaic, triangulation, options.smoothing);
        if wrong(&other) < wrong(&finished) {
            (finished, edits) = (other, other_edits);
        }
    }
    let Finished { mesh, vertices, branches, faults, differences } = finished;
    Ok(Meshed { before, holes, edits, mesh, vertices, branches, faults, differences })
}

/// Snaps a mesh to features, mends the faces that oppose the surface nearest to them, where they are at most one in `thin`, and returns those
/// that are left.
fn settled(
    context: &mut Context,
    mut mesh: SurfaceMesh,
    connectivity: Option<ConnectivityOptions>,
    passes: usize,
    thin: usize,
    edits: &mut Option<EditCounts>,
) -> (SurfaceMesh, Vec<u32>) {
    if passes > 0 {
        snap(context, &mut mesh);
    }
    mesh = mesh.compacted();
    context.regard_given();
    // Faces that stand perpendicular are mended too, and are none of those that are told.
    let (poor, standings): (Vec<u32>, Vec<Standing>) = mesh.faces_not_along(context).into_iter().unzip();
    let opposed = standings.iter().filter(|standing| **standing == Standing::Against).count();
    if let (Some(connectivity), Some(edits)) = (connectivity, edits)
        && !poor.is_empty()
        && opposed <= mesh.faces().count() / thin
    {
        context.let_nearest_decide(&mesh, &poor);
        untangle_and_relocate(context, &mut mesh, &connectivity, passes, edits);
        mesh = mesh.compacted();
        let left = mesh.faults(context);
        if mesh.free_from_curves(context.surface, &left) {
            untangle_and_relocate(context, &mut mesh, &connectivity, passes, edits);
            mesh = mesh.compacted();
        }
    }
    let opposed = if poor.is_empty() { Vec::new() } else { mesh.opposed_faces(context) };
    (mesh, opposed)
}

/// The number of faults and differences.
fn wrong(finished: &Finished) -> usize {
    improve::wrong(&finished.faults, &finished.differences)
}

/// Finishes a mesh whose opposed faces are listed, and covers the parts of the surface that it misses where this is better.
fn completed(
    context: &Context,
    mut mesh: SurfaceMesh,
    opposed: &[u32],
    mosaic: &Mosaic,
    triangulation: &Triangulation,
    passes: usize,
) -> Finished {
    let finished = finish(context, &mesh, opposed, mosaic, triangulation);
    let is_uncovered = |difference: &Difference| matches!(difference, Difference::Uncovered { .. });
    if passes == 0 || !finished.differences.iter().any(is_uncovered) || !cover(context, &mut mesh) {
        return finished;
    }
    let covered = finish(context, &mesh, &mesh.opposed_faces(context), mosaic, triangulation);
    if wrong(&covered) < wrong(&finished) { covered } else { finished }
}

/// Discs are not the cause of more faults than these.
const MOST_FAULTS_OF_DISCS: usize = 4;
/// Where a larger share of the faces than one in so many is nearer to an opposite sheet, the surface is thinner than its tiles: edits would
/// spoil shapes, and smaller tiles are better.
const THIN: usize = 100;
/// The same in a mesh that is made again with smaller tiles at its faults.
const THIN_REFINED: usize = 10;

/// The options of the connectivity optimisation, completed by the wanted number of vertices and by the other options.
fn connectivity(options: &Options, wanted: usize) -> Option<ConnectivityOptions> {
    let given = options.connectivity?;
    let wanted = match options.fineness {
        Fineness::Points(_) => Some(wanted),
        Fineness::Size(_) | Fineness::Sampled => None,
    };
    let regularity = match options.rows {
        Rows::Paper => given.regularity,
        Rows::Continuous => given.regularity.max(CONTINUOUS_REGULARITY),
    };
    Some(ConnectivityOptions { wanted, regularity, ..given })
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
    let absorb = match options.rows {
        Rows::Paper => options.field.absorb,
        Rows::Continuous => options.field.absorb.max(ABSORBED * side),
    };
    let field = Field::new(surface, &FieldOptions { align, sweeps, absorb, ..options.field.clone() }, backend)?;
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
    lay_by(&builder(surface, field, backend, options, progress), options, count, None)
}

/// The builder of [`lay`].
fn builder<'a>(
    surface: &'a Surface,
    field: &'a Field,
    backend: &'a dyn Backend,
    options: &Options,
    progress: &'a dyn Fn(f32),
) -> MosaicBuilder<'a> {
    let (effort, rows) = (Effort::default(), options.rows);
    MosaicBuilder { surface, field, backend, effort, rows, first_scale: None, is_trial: false, progress }
}

/// As [`lay`], by a builder, of which `trial` is a trial.
fn lay_by(
    builder: &MosaicBuilder,
    options: &Options,
    count: usize,
    trial: Option<Mosaic>,
) -> Result<Mosaic, ComputeError> {
    let is_absolute = !matches!(options.fineness, Fineness::Points(_)) && !builder.field.sizes().is_equal();
    if is_absolute { builder.at_scale_for(count) } else { builder.with_count(count, trial) }
}
