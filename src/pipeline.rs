//! The whole method: from a triangle surface to a quad-dominant mesh.
//!
//! # Theory
//! The paper's abstract and sections 2 and 3: a mosaic of equal square tiles, turned along a field, covers the surface;
//! the tiles' centres are connected up, down, left and right; holes are filled by patterns; clean-up turns triangles
//! into quads.

use crate::compute::{Backend, ComputeError};
use crate::field::{Align, Field, FieldOptions, Stretch, StretchError};
use crate::mesh::clean::{CleanCounts, CleanOptions, clean};
use crate::mesh::connect::{ConnectOptions, connect};
use crate::mesh::facing::Facing;
use crate::mesh::fill::{Holes, fill};
use crate::mesh::follow::follow;
use crate::mesh::join::{Joined, join};
use crate::mesh::pair::upright::upright;
use crate::mesh::pair::{PairCounts, PairOptions, Paired, Quads, pair};
use crate::mesh::regions::with_regions;
use crate::mesh::smooth::{Smoothed, smooth_in};
use crate::mesh::touch_up::touch_up;
use crate::mesh::triangulate::triangulate;
use crate::mesh::unfold::{split_folded, unfold};
use crate::mesh::{Mesh, Metric, Triangulation};
use crate::mosaic::{self, Effort, Mosaic, MosaicBuilder};
use crate::parametrize::Rows;
use crate::parametrize::integrable_sizes::{integrable_sizes, limit_chord_error};
use crate::sizes::{SizeOptions, Sizes, SizesError};
use crate::surface::{FeatureOptions, NONE, NamedEdge, Soup, Surface, SurfaceError};
use std::time::{Duration, Instant};
use thiserror::Error;

/// How fine the mesh is to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fineness {
    /// This many vertices.
    Points(usize),
    /// As many as equal tiles of this side, in model units, cover the surface.
    Size(f64),
    /// As many as tiles of the sizes that samples give, in model units, cover the surface.
    Sampled,
}

/// What the method can be told.
#[derive(Clone, Debug)]
pub struct Options {
    /// How fine the mesh is to be.
    pub fineness: Fineness,
    /// What counts as a feature.
    pub features: FeatureOptions,
    /// Edges of the surface that are features whatever their angle.
    pub edges: Vec<NamedEdge>,
    /// What draws the field beside features.
    pub field: FieldOptions,
    /// Whether rows of tiles may end.
    pub rows: Rows,
    /// How far sides follow the field so that rows need not end, from 0 (not at all) to 1. Default 0.
    pub fit: f64,
    /// The largest side over the mean one, and the mean over the smallest, that fitting may ask for. Default 2.5.
    pub fit_range: f64,
    /// The longer side of a tile, which lies along the guides, over the shorter one, from 1 to 20. Default 1: squares.
    pub aspect: f64,
    /// Where tiles are to be smaller or larger than elsewhere.
    pub sizes: SizeOptions,
    /// When two tiles are connected.
    pub connect: ConnectOptions,
    /// What to do with holes.
    pub holes: Holes,
    /// The clean-up; `None`: the mesh stays as the filling leaves it.
    pub cleanup: Option<CleanOptions>,
    /// The pairing of triangles that the clean-up leaves; `None`: they stay.
    pub pairing: Option<PairOptions>,
    /// Passes of smoothing after the clean-up. Default 6; 0: vertices stay where the tiles were.
    pub smoothing: usize,
}

impl Options {
    /// The defaults, at this fineness.
    pub fn new(fineness: Fineness) -> Self {
        Self {
            fineness,
            features: FeatureOptions::default(),
            edges: Vec::new(),
            field: FieldOptions::default(),
            rows: Rows::default(),
            fit: 0.0,
            fit_range: 2.5,
            aspect: 1.0,
            sizes: SizeOptions::default(),
            connect: ConnectOptions::default(),
            holes: Holes::default(),
            cleanup: Some(CleanOptions::default()),
            pairing: Some(PairOptions::default()),
            smoothing: 6,
        }
    }
}

/// A step of the way, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Welding, orientation, adjacency, features.
    Surface,
    /// The cross field.
    Field,
    /// Sowing and relaxing tiles.
    Mosaic,
    /// Triangulating the tiles and choosing edges.
    Connect,
    /// Splitting holes.
    Fill,
    /// Topological clean-up.
    Clean,
    /// Pairing of the triangles that are left.
    Pair,
    /// Smoothing.
    Smooth,
}

impl Stage {
    /// Its name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Surface => "surface",
            Self::Field => "field",
            Self::Mosaic => "mosaic",
            Self::Connect => "connect",
            Self::Fill => "fill",
            Self::Clean => "clean",
            Self::Pair => "pair",
            Self::Smooth => "smooth",
        }
    }
}

/// Why no mesh was made.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PipelineError {
    /// The surface cannot be meshed.
    #[error(transparent)]
    Surface(#[from] SurfaceError),
    /// The backend failed.
    #[error(transparent)]
    Compute(#[from] ComputeError),
    /// The asked sizes make no sense.
    #[error(transparent)]
    Sizes(#[from] SizesError),
    /// Tiles cannot be rectangles as asked.
    #[error(transparent)]
    Stretch(#[from] StretchError),
    /// The asked fineness makes no sense.
    #[error("{0}")]
    Fineness(String),
}

/// Everything that the method made on the way; coordinates are unit-sized but for those of meshes.
pub struct Outcome {
    /// The surface.
    pub surface: Surface,
    /// Its cross field.
    pub field: Field,
    /// The tiles.
    pub mosaic: Mosaic,
    /// Their triangulation.
    pub triangulation: Triangulation,
    /// The mesh before clean-up, in model units.
    pub before: Mesh,
    /// The mesh, in model units.
    pub mesh: Mesh,
    /// Whether sheets of the surface meet at each of its vertices.
    pub branches: Vec<bool>,
    /// Holes of the connected mosaic, before they were filled.
    pub holes: usize,
    /// What the clean-up did.
    pub cleaned: Option<CleanCounts>,
    /// What the pairing of triangles did.
    pub paired: Option<PairCounts>,
    /// How long each stage took.
    pub times: Vec<(Stage, Duration)>,
}

/// The price of irregular vertices where rows pass over the whole surface: see [`PairOptions::regularity`].
const REGULARITY: f64 = 1.0;
/// Sweeps of the field that sides follow: they draw its angle to a harmonic one, which sides can fit. With 10, 60 and 150 of
/// them and continuous rows Qg was 0.944, 0.948 and 0.952 on spot and 0.942, 0.945 and 0.946 on holes_cgal.
const HARMONIC_SWEEPS: u32 = 150;
/// Passes of smoothing before the pairing.
const CALMING: usize = 2;

/// What connecting tiles gives: a part of [`Outcome`].
pub struct Meshed {
    /// The mesh before clean-up, in model units.
    pub before: Mesh,
    /// The mesh, in model units.
    pub mesh: Mesh,
    /// Whether sheets of the surface meet at each of its vertices.
    pub branches: Vec<bool>,
    /// Holes of the connected mosaic, before they were filled.
    pub holes: usize,
    /// What the clean-up did.
    pub cleaned: Option<CleanCounts>,
    /// What the pairing of triangles did.
    pub paired: Option<PairCounts>,
}
/// Sizes are seen at vertices, and where these show small ones the surface gets more vertices: so often at most.
const ROUNDS_OF_SIZES: usize = 4;

/// Fewest and most vertices that can be asked for.
pub const POINTS: std::ops::RangeInclusive<usize> = 4..=50_000_000;

/// Meshes a soup of triangles. `progress` is told each stage as it begins, and how far it is, from 0 to 1.
///
/// # Errors
/// Where the surface cannot be meshed, the fineness makes no sense, or the backend fails.
pub fn run(
    soup: &Soup,
    options: &Options,
    backend: &dyn Backend,
    progress: &dyn Fn(Stage, f32),
) -> Result<Outcome, PipelineError> {
    let mut clock = Clock { progress, times: Vec::new(), started: Instant::now() };

    clock.begin(Stage::Surface);
    let (surface, sizes, count) = prepare(soup, options)?;

    clock.begin(Stage::Field);
    let field = field(&surface, sizes, count, options, backend)?;

    clock.begin(Stage::Mosaic);
    let mosaic = lay(&surface, &field, backend, count, options, &|share| progress(Stage::Mosaic, share))?;

    clock.begin(Stage::Connect);
    let triangulation = triangulate(&surface, &field, &mosaic);
    let Meshed { before, mesh, branches, holes, cleaned, paired } =
        meshed(&surface, &mosaic, &triangulation, options, &mut clock);

    let times = clock.finish();
    Ok(Outcome { surface, field, mosaic, triangulation, before, mesh, branches, holes, cleaned, paired, times })
}

/// Connects tiles that are triangulated already: as [`run`] does, but for what comes before.
pub fn connected(surface: &Surface, mosaic: &Mosaic, triangulation: &Triangulation, options: &Options) -> Meshed {
    let mut clock = Clock { progress: &|_, _| (), times: Vec::new(), started: Instant::now() };
    meshed(surface, mosaic, triangulation, options, &mut clock)
}

fn meshed(
    surface: &Surface,
    mosaic: &Mosaic,
    triangulation: &Triangulation,
    options: &Options,
    clock: &mut Clock,
) -> Meshed {
    let edges = connect(triangulation, &options.connect);

    clock.begin(Stage::Fill);
    let (filled, holes) = fill(triangulation, &edges, options.holes);

    clock.begin(Stage::Clean);
    let anchors = triangulation.anchors();
    let (cleaned, counts) = match &options.cleanup {
        Some(cleanup) => {
            let (mesh, counts) = clean(&filled, &anchors, cleanup);
            (mesh, Some(counts))
        }
        None => (filled.clone(), None),
    };

    let kept: Vec<u32> =
        counts.as_ref().map_or_else(|| (0..filled.points.len() as u32).collect(), |counts| counts.kept.clone());
    let below = triangulation.free_triangles(&kept);

    clock.begin(Stage::Pair);
    let (quads, below, mut kept, features, metric, mut pairs) = match &options.pairing {
        Some(pairing) => {
            // Drafts are judged by what smoothing makes of them, so what they are compared with is smoothed too.
            let anchors = anchors.of(&kept);
            let calm = smooth_in(&Metric::new(&anchors), surface, &cleaned, &below, options.smoothing.min(CALMING));
            let excess = match options.fineness {
                Fineness::Points(count) => join_count(&triangulation.joints(&kept)) as i64 - count as i64,
                Fineness::Size(_) | Fineness::Sampled => 0,
            };
            let regularity = match options.rows {
                Rows::Paper => pairing.regularity,
                Rows::Continuous => pairing.regularity.max(REGULARITY),
            };
            let Paired { mesh, kept: of_cleaned, below, features, metric, counts } =
                pair(surface, &calm.mesh, &anchors, &calm.below, &PairOptions { excess, regularity, ..*pairing });
            let kept = of_cleaned.iter().map(|&v| kept.get(v as usize).copied().unwrap_or(NONE)).collect();
            (mesh, below, kept, features, metric, Some(counts))
        }
        None => {
            let anchors = anchors.of(&kept);
            let metric = Metric::new(&anchors);
            (cleaned, below, kept, anchors.feature_edges, metric, None)
        }
    };

    clock.begin(Stage::Smooth);
    let mut smoothed = smooth_in(&metric, surface, &quads, &below, options.smoothing);
    let facing = Facing::new(surface);
    if options.smoothing > 0 {
        smoothed = follow(&metric, surface, &unfold(&metric, &facing, &smoothed));
        smoothed = follow(&metric, surface, &touch_up(&metric, surface, &smoothed));
    }
    if let (Some(pairing), Some(counts)) = (&options.pairing, &mut pairs)
        && let Some(uprighted) = upright(&metric, &facing, &smoothed, &features, pairing)
    {
        kept = uprighted.kept.iter().map(|&v| kept.get(v as usize).copied().unwrap_or(NONE)).collect();
        counts.set_upright = uprighted.count;
        smoothed = uprighted.smoothed;
    }
    let Smoothed { mesh: smoothed, below } = smoothed;
    let all_quads = options.pairing.is_some_and(|pairing| pairing.quads == Quads::All);
    let smoothed = if all_quads { smoothed } else { split_folded(smoothed) };
    let before = join(&filled, &triangulation.same_place).mesh;
    let named = with_regions(&smoothed, surface, mosaic, &below, &kept);
    let Joined { mesh, branches } = join(&named, &triangulation.joints(&kept));
    let [before, mesh] = [before, mesh].map(|mesh| mesh.placed(surface.frame()));
    Meshed { before, mesh, branches, holes, cleaned: counts, paired: pairs }
}

/// The number of vertices once those at one place are one; `joints` names the first at the place of each.
fn join_count(joints: &[u32]) -> usize {
    (0..).zip(joints).filter(|&(v, &first)| v == first).count()
}

/// The surface, with the features that tiles so fine can show, how large they are to be, and how many vertices are wanted.
///
/// # Errors
/// Where the surface cannot be meshed or the fineness, the sizes or the aspect make no sense.
pub fn prepare(soup: &Soup, options: &Options) -> Result<(Surface, Sizes, usize), PipelineError> {
    expect_stretchable(options)?;
    let features = &options.features;
    let surface = Surface::new(soup, features)?.with_edges(soup, &options.edges, features)?;
    let count = count(&surface, options)?;
    let side = mosaic::side_for_count(&surface, count);
    let mut surface = surface.fitted(features, side);
    let mut wanted = options.sizes.on(&surface, f64::from(side));
    let mut sizes = wanted.sizes(&surface, count)?;
    for _ in 0..ROUNDS_OF_SIZES {
        let longest = mosaic::longest_edges(&surface, &sizes, count, options.aspect);
        let middles;
        (surface, middles) = surface.divided(longest, features);
        if middles.is_empty() || sizes.is_equal() {
            break;
        }
        wanted = wanted.divided(&surface, &middles);
        sizes = wanted.sizes(&surface, count)?;
    }
    Ok((surface, sizes, count))
}

/// The field that `count` tiles would be laid along, curvature being seen at their scale, and the sizes of the tiles: these,
/// and if asked those that fit the field.
///
/// # Errors
/// Where the backend fails, or tiles cannot be stretched as asked.
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
        // Of equal tiles: where sizes vary it is their mean side.
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

/// A mosaic of nearly `count` tiles; `progress` is told how far it is, from 0 to 1.
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
    MosaicBuilder { surface, field, backend, effort: Effort::default(), rows: options.rows, progress }.with_count(count)
}

/// Before long work: what can be known of the aspect without the surface.
fn expect_stretchable(options: &Options) -> Result<(), StretchError> {
    StretchError::of_aspect(options.aspect)?;
    match options.aspect == 1.0 {
        false if options.fit != 0.0 => Err(StretchError::Fitted),
        false if options.field.guides.is_empty() => Err(StretchError::NoGuide),
        _ => Ok(()),
    }
}

/// How many vertices that makes.
fn count(surface: &Surface, options: &Options) -> Result<usize, PipelineError> {
    match options.fineness {
        Fineness::Points(count) if POINTS.contains(&count) => Ok(count),
        Fineness::Points(count) => Err(PipelineError::Fineness(format!(
            "a mesh of {count} points cannot be made; ask for {} to {}",
            POINTS.start(),
            POINTS.end()
        ))),
        Fineness::Size(size) => {
            let diagonal = surface.frame().diagonal;
            let count = mosaic::count_for_side(surface, size / diagonal);
            if size > 0.0 && size <= diagonal && count <= *POINTS.end() as f64 {
                return Ok((count.round() as usize).max(*POINTS.start()));
            }
            let least = diagonal * f64::from(mosaic::side_for_count(surface, *POINTS.end()));
            Err(PipelineError::Fineness(format!(
                "tiles of side {size} cannot cover this surface; ask for {least:.3e} to {diagonal:.3e}, its diagonal"
            )))
        }
        Fineness::Sampled if options.sizes.samples.is_empty() => {
            Err(PipelineError::Fineness("no sizes are given; give some, or ask for a number of points".to_owned()))
        }
        Fineness::Sampled => {
            let count = options.sizes.count(surface)?;
            if count <= *POINTS.end() as f64 {
                return Ok((count.round() as usize).max(*POINTS.start()));
            }
            Err(PipelineError::Fineness(format!(
                "the surface takes {count:.3e} tiles of the given sizes; ask for larger ones, in model units, so that {} are enough",
                POINTS.end()
            )))
        }
    }
}

struct Clock<'a> {
    progress: &'a dyn Fn(Stage, f32),
    times: Vec<(Stage, Duration)>,
    started: Instant,
}

impl Clock<'_> {
    fn begin(&mut self, stage: Stage) {
        self.end();
        self.times.push((stage, Duration::ZERO));
        (self.progress)(stage, 0.0);
    }

    fn end(&mut self) {
        let now = Instant::now();
        if let Some((stage, time)) = self.times.last_mut() {
            *time = now - self.started;
            (self.progress)(*stage, 1.0);
        }
        self.started = now;
    }

    fn finish(mut self) -> Vec<(Stage, Duration)> {
        self.end();
        self.times
    }
}
