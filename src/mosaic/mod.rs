//! The mosaic: equal square tiles in straight rows, on features, at the asked count.
//!
//! # Theory
//! After Lai, Hu and Martin's surface mosaics (the paper's references 1 and 2): square tiles of one size are laid over
//! the surface, turned along the cross field, and relaxed by a repulsion that is square as they are.
//!
//! # Changes versus the paper
//! The paper relaxes random tiles at their final size. Here a few tiles are relaxed first and each is then split into
//! three by three, again and again ([`refine`]): rows are in step over the whole surface before there are many.
//! Tiles on features are placed along the feature curves ([`seat`]) and stay there; they are seen from each side of
//! a crease apart.
//!
//! # Practice
//! Order of work: [`seat`] tiles on features, [`sow`] free tiles, [`relax`], [`census`] (remove and add), [`refine`].

pub mod census;
pub mod grid;
pub mod refine;
pub mod relax;
pub mod seat;
pub mod sow;

pub use relax::Relaxation;
pub use seat::{Seat, Site};

use crate::compute::{ComputeError, Ground};
use crate::field::Field;
use crate::surface::Surface;
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// A tile, or one side of a tile on a feature; the record that the kernels read.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Tile {
    /// Its centre, on the surface.
    pub position: [f32; 3],
    /// Its side length.
    pub h: f32,
    /// The surface's unit normal there.
    pub normal: [f32; 3],
    /// The triangle that it lies in.
    pub triangle: u32,
    /// One direction of its cross: a unit vector along the surface.
    pub axis: [f32; 3],
    /// 0: free to move. Else it is the side of a fixed tile on a feature: the number of quarter turns from `axis`,
    /// counter-clockwise, that belong to this side.
    pub quarters: u32,
}

impl Tile {
    pub(crate) fn at(&self) -> Vec3 {
        Vec3::from(self.position)
    }

    pub(crate) fn normal(&self) -> Vec3 {
        Vec3::from(self.normal)
    }

    /// The direction of the cross at `turn` quarter turns, counter-clockwise, from `axis`.
    pub(crate) fn direction(&self, turn: u32) -> Vec3 {
        let axis = Vec3::from(self.axis);
        let direction = if turn % 2 == 1 { crate::geometry::cross(self.normal(), axis) } else { axis };
        if turn % 4 < 2 { direction } else { -direction }
    }

    /// A free tile of side `h` at a point of a triangle, turned along the field.
    pub(crate) fn free(surface: &Surface, field: &Field, triangle: u32, position: Vec3, h: f32) -> Self {
        Self {
            position: position.into(),
            h,
            normal: surface.normal(triangle as usize).into(),
            triangle,
            axis: field.axis(surface, triangle, position).into(),
            quarters: 0,
        }
    }
}

/// Tiles on features, with their sides, and free tiles.
#[derive(Clone, Debug, Default)]
pub struct Mosaic {
    /// The tiles on features.
    pub sites: Vec<Site>,
    /// All sides of the tiles on features first, in the order of the sites, then the free tiles.
    pub tiles: Vec<Tile>,
    /// How many of the tiles are sides.
    pub sides: usize,
}

impl Mosaic {
    /// The free tiles.
    pub fn free(&self) -> &[Tile] {
        &self.tiles[self.sides..]
    }

    /// The number of tiles: vertices of the mesh to come.
    pub fn count(&self) -> usize {
        self.sites.len() + self.free().len()
    }

    /// Tiles of side `h` on the features, and these free tiles.
    pub(crate) fn new(surface: &Surface, field: &Field, h: f32, free: impl IntoIterator<Item = Tile>) -> Self {
        let (sites, mut tiles) = seat::seat(surface, field, h);
        let sides = tiles.len();
        tiles.extend(free);
        Self { sites, tiles, sides }
    }
}

/// How many tiles, and how hard to work on them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MosaicOptions {
    /// The side of the tiles, in unit-sized coordinates.
    pub h: f32,
    /// The coarsest mosaic has at least this many tiles, where the finest has. Default 70.
    pub first_tiles: usize,
    /// Batches of relaxation, each followed by a census, on the coarsest level. Default 12.
    pub first_batches: usize,
    /// Batches on each finer level. Default 4.
    pub batches: usize,
    /// Steps a batch. Default 8.
    pub steps: u32,
}

impl MosaicOptions {
    const FIRST_TILES: usize = 70;

    /// The defaults, for tiles of side `h`.
    pub fn with_side(h: f32) -> Self {
        Self { h, first_tiles: Self::FIRST_TILES, first_batches: 12, batches: 4, steps: 8 }
    }
}

/// The side for `count` tiles: inner tiles cover a square each, tiles on an open boundary half of one.
pub fn side_for_count(surface: &Surface, count: usize) -> f32 {
    let (area, boundary) = (surface.area(), surface.boundary_length());
    // count = area / h^2 + boundary / (2 h), solved for 1 / h.
    let half = boundary / 2.0;
    let inverse = ((half * half + 4.0 * area * count as f64).sqrt() - half) / (2.0 * area);
    (1.0 / inverse) as f32
}

/// A mosaic of nearly `count` tiles.
///
/// Rows that end leave gaps, so a mosaic has some tiles less than its area asks for, by about the same share on every
/// level. That share is measured first on a mosaic one level coarser.
///
/// # Errors
/// Where the backend fails.
pub fn lay_count(
    surface: &Surface,
    field: &Field,
    ground: &dyn Ground,
    count: usize,
    progress: &dyn Fn(f32),
) -> Result<Mosaic, ComputeError> {
    let plan = |wanted: usize| MosaicOptions::with_side(side_for_count(surface, wanted));
    let trial = if count >= 9 * MosaicOptions::FIRST_TILES { count / 9 } else { count };
    let found = lay(surface, field, ground, &plan(trial), &|share| progress(0.1 * share))?.count();
    let wanted = (count as f64 * (trial as f64 / found as f64).clamp(0.8, 1.25)).round() as usize;
    lay(surface, field, ground, &plan(wanted), &|share| progress(0.1 + 0.9 * share))
}

/// Lays a mosaic: few large tiles first, split until they have the wanted side.
///
/// # Errors
/// Where the backend fails.
pub fn lay(
    surface: &Surface,
    field: &Field,
    ground: &dyn Ground,
    options: &MosaicOptions,
    progress: &dyn Fn(f32),
) -> Result<Mosaic, ComputeError> {
    let finest = surface.area() / f64::from(options.h * options.h);
    let levels = (finest / options.first_tiles as f64).log(9.0).floor().max(0.0) as i32;
    let mut h = options.h * 3f32.powi(levels);
    let mut mosaic = Mosaic::new(surface, field, h, sow::sow(surface, field, h));
    for level in 0..=levels {
        if level > 0 {
            h = options.h * 3f32.powi(levels - level);
            mosaic = Mosaic::new(surface, field, h, refine::refine(surface, field, &mosaic, h));
        }
        let batches = if level == 0 { options.first_batches } else { options.batches };
        let relaxation = Relaxation::new(options.steps, h);
        for batch in 0..batches {
            mosaic = census::take(surface, field, &mosaic, batch + 1 < batches);
            mosaic.tiles = ground.relax(&mosaic.tiles, &relaxation)?;
            progress((level as f32 + (batch + 1) as f32 / batches as f32) / (levels + 1) as f32);
        }
    }
    Ok(census::take(surface, field, &mosaic, true))
}
