//! Tiles, and the surface that they are relaxed on: the records that kernels read.

use super::{Complex, WORKGROUP};
use crate::geometry::cross;
use crate::sizes::Sizes;
use crate::surface::{NONE, Surface, WALK_EDGES};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// Tiles farther apart than this, in tile sides, do not see each other.
pub const REACH: f32 = 1.75;
/// How much farther than a tile sees its neighbour list goes, in tile sides.
pub const SKIN: f32 = 0.2;
/// The longest neighbour list. Where more tiles are near, the grid's first ones are in it.
pub const LIST_LENGTH: usize = 16;
/// The steps that neighbour lists are used for.
pub const LIST_STEPS: u32 = 8;

/// The edges that a tile may cross in one step.
pub const MOST_EDGES: u32 = WALK_EDGES;

/// A tile, or one side of a tile on a feature.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Tile {
    /// Its centre, on the surface, in unit-sized coordinates.
    pub position: [f32; 3],
    /// Its side length; of a rectangle, that of a square with its area.
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
        let direction = if turn % 2 == 1 { cross(self.normal(), axis) } else { axis };
        if turn % 4 < 2 { direction } else { -direction }
    }
}

/// A triangle of the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct Triangle {
    /// The vertices.
    pub corners: [u32; 3],
    /// The opposite half-edge of each half-edge; all bits set where it may not be crossed.
    pub beyond: [u32; 3],
}

/// The surface that tiles are relaxed on.
#[derive(Clone, Debug, PartialEq)]
pub struct RelaxationSurface {
    /// The vertices in unit-sized coordinates, each with the relative size of tiles there.
    pub points: Vec<[f32; 4]>,
    /// The triangles.
    pub triangles: Vec<Triangle>,
    /// The crosses at the corners of each triangle, against its first edge.
    pub crosses: Vec<[Complex; 3]>,
}

impl RelaxationSurface {
    /// A surface with sizes and with crosses at the corners of its triangles. Tiles do not cross its features.
    pub fn new(surface: &Surface, sizes: &Sizes, crosses: &[[Complex; 3]]) -> Self {
        let point = |(p, v): (&Vec3, u32)| [p.x, p.y, p.z, sizes.at_vertex(v)];
        let beyond = |h: u32| if surface.features().is_feature(h) { NONE } else { surface.twins[h as usize] };
        let triangle =
            |(t, &corners): (u32, &[u32; 3])| Triangle { corners, beyond: [0, 1, 2].map(|k| beyond(3 * t + k)) };
        Self {
            points: surface.points.iter().zip(0..).map(point).collect(),
            triangles: (0..).zip(&surface.triangles).map(triangle).collect(),
            crosses: crosses.to_vec(),
        }
    }
}

/// A batch of relaxation steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relaxation {
    /// How many steps.
    pub steps: u32,
    /// The side of the grid's cells, in unit-sized coordinates: more than the reach of the largest tile.
    pub cell: f32,
    /// The scale of the tiles' sizes: their side where the relative size is 1.
    pub scale: f32,
}

impl Relaxation {
    /// Steps for tiles of these sizes at this scale.
    pub fn new(steps: u32, scale: f32, sizes: &Sizes) -> Self {
        Self { steps, cell: cell(scale * sizes.largest()), scale }
    }
}

/// The side of the grid's cells for tiles of side at most `h`: a little more than their neighbour lists reach, so that
/// rounding puts no neighbour two cells away.
pub(crate) fn cell(h: f32) -> f32 {
    1.001 * (REACH + SKIN) * h
}

/// The number of the neighbour grid's buckets for this many points: a power of two, at least a workgroup of the scan.
pub fn bucket_count(points: usize) -> u32 {
    (2 * points).next_power_of_two().max(WORKGROUP) as u32
}
