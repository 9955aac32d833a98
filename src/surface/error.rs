//! Why a soup of triangles cannot be meshed.

use crate::progress::Cancelled;
use thiserror::Error;

/// The most triangles, and the most points, of a surface: each side of a triangle has a 32-bit number, and one is no side's.
pub(super) const MOST_TRIANGLES: usize = (u32::MAX / 3 - 1) as usize;

/// Why a soup of triangles is no surface that can be meshed.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum SurfaceError {
    /// There is nothing to mesh.
    #[error("the surface has no triangles; check that the file holds faces")]
    Empty,
    /// Numbers of sides of triangles would not be 32-bit numbers.
    #[error(
        "the surface has {triangles} triangles and {points} points; mesh it in parts of at most {MOST_TRIANGLES} triangles and points"
    )]
    TooLarge {
        /// Triangles that were given.
        triangles: usize,
        /// Points that were given.
        points: usize,
    },
    /// Nothing is left of the triangles at the precision that is computed with.
    #[error(
        "none of the {given} triangles has any area: their corners lie on a line, or within a ten-millionth of the \
         model's size of one; check the coordinates"
    )]
    NoArea {
        /// Triangles that were given.
        given: usize,
    },
    /// A length of the repairs is none.
    #[error("{length} of the model's diagonal is no length for {name}; give one above 0{}", upper_limit(*.most))]
    RepairLength {
        /// The repair.
        name: &'static str,
        /// The length, in diagonals of the bounding box.
        length: f64,
        /// The largest, in diagonals of the bounding box.
        most: f64,
    },
    /// Each part of the surface is smaller than those that are to be dropped.
    #[error(
        "no part of the surface is left: the largest is {largest:.6e} across, and those below {limit:.6e} are to be dropped; \
         give a smaller limit"
    )]
    AllPartsSmall {
        /// The limit, in model units.
        limit: f64,
        /// The diagonal of the largest part's bounding box, in model units.
        largest: f64,
    },
    /// The triangles of one component cannot be oriented alike.
    #[error("the surface is not orientable: a one-sided strip passes triangle {triangle} at {}; cut it open there", shown(.at))]
    NotOrientable {
        /// A triangle, counted from 0 in the order of the file, where the two orientations meet.
        triangle: usize,
        /// Its first corner, in model units.
        at: [f64; 3],
    },
    /// A feature edge names a vertex that is not there.
    #[error("{name}: there is no vertex {number} in the surface's file")]
    NoSuchVertex {
        /// What the edge is called.
        name: String,
        /// The vertex, counted from 1.
        number: usize,
    },
    /// A feature edge ends where there is no vertex.
    #[error("{name}: the surface has no vertex at {}; give the place of one, in the units of the surface", shown(.at))]
    NoVertexAt {
        /// What the edge is called.
        name: String,
        /// The place, in model units.
        at: [f64; 3],
    },
    /// A feature edge is none of the surface's.
    #[error(
        "{name}: no edge, and no straight line of edges, joins {} and {}; name edges of the surface",
        shown(.from), shown(.to)
    )]
    NoEdges {
        /// What the edge is called.
        name: String,
        /// One end, in model units.
        from: [f64; 3],
        /// The other.
        to: [f64; 3],
    },
    /// An index points past the last point.
    #[error("triangle {triangle} uses point {index}, but there are only {points} points")]
    IndexOutOfRange {
        /// The triangle, counted from 0.
        triangle: usize,
        /// The index that it uses.
        index: u32,
        /// The number of points.
        points: usize,
    },
    /// The run was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// A coordinate is NaN or infinite, or the extent overflows.
    #[error("point {point} has a coordinate that is not finite or too large to compute with")]
    NotFinite {
        /// The point, counted from 0.
        point: usize,
    },
}

fn upper_limit(most: f64) -> String {
    if most < f64::MAX { format!(" and of at most {most} of it") } else { String::new() }
}

/// A place in messages: so many digits are enough to find it.
pub fn shown(place: &[f64; 3]) -> String {
    let [x, y, z] = place.map(short);
    format!("({x}, {y}, {z})")
}

/// A coordinate in messages, with seven significant digits and no -0.
pub(crate) fn short(x: f64) -> f64 {
    format!("{x:.6e}").parse().unwrap_or(x) + 0.0
}
