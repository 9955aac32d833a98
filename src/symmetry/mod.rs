//! Meshes that are symmetric about a plane, bit for bit.
//!
//! # Theory
//! The surface is [cut](cut()) at the plane, the half of larger coordinates is meshed, and its mirror image is [joined](join()) to it.
//! The rim of the half on the plane is a boundary, with which the field is aligned: rows cross the plane at a right angle or run along
//! it. A plane that is not given is [found](find).
//!
//! # Changes versus the paper
//! The paper has no symmetry.
//!
//! # Practice
//! Set [`Options::symmetry`](crate::Options#structfield.symmetry). Planes lie across an axis: the mirror image about any other plane
//! would be rounded.

pub mod chords;
pub mod cut;
pub mod find;
pub mod join;

pub use cut::{Half, cut};
pub use find::Asymmetry;
pub use join::{Joined, join};

use crate::surface::shown;
use serde::Serialize;
use std::fmt;
use std::str::FromStr;
use thiserror::Error;

/// A vertex no farther from the plane than this, in diagonals of the surface's bounding box, lies on it: some roundings of f32.
pub const ON_PLANE: f64 = 1e-6;

/// A coordinate axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Axis {
    /// The first coordinate.
    X,
    /// The second coordinate.
    Y,
    /// The third coordinate.
    Z,
}

impl Axis {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::X, Self::Y, Self::Z];

    /// Its place among the coordinates.
    pub fn index(self) -> usize {
        self as usize
    }
}

/// A plane across an axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Plane {
    /// The axis.
    pub axis: Axis,
    /// The coordinate of the plane on the axis, in model units.
    pub offset: f64,
}

impl Plane {
    /// The signed distance of a point from the plane, in model units.
    pub fn height(self, point: [f64; 3]) -> f64 {
        point[self.axis.index()] - self.offset
    }

    /// The mirror image of a point.
    pub fn image(self, mut point: [f64; 3]) -> [f64; 3] {
        let x = &mut point[self.axis.index()];
        *x = 2.0 * self.offset - *x;
        point
    }

    /// The mirror image of a direction.
    pub fn image_of_direction(self, mut direction: [f64; 3]) -> [f64; 3] {
        direction[self.axis.index()] *= -1.0;
        direction
    }

    /// The point itself where it lies on the kept side or on the plane, else its mirror image.
    pub fn folded(self, point: [f64; 3]) -> [f64; 3] {
        if self.height(point) < 0.0 { self.image(point) } else { point }
    }

    /// The part of a box on the kept side, or the image of the other part where that is larger.
    pub fn folded_box(self, mut low: [f64; 3], mut high: [f64; 3]) -> ([f64; 3], [f64; 3]) {
        let axis = self.axis.index();
        let [below, above] = [-self.height(low), self.height(high)];
        if below > above {
            high[axis] = self.offset + below;
            low[axis] = self.offset - above;
        }
        low[axis] = low[axis].max(self.offset);
        (low, high)
    }

    /// A point and its mirror image, each the image of the other bit for bit: the point moves by a rounding where it must.
    pub fn pair(self, point: [f64; 3]) -> [[f64; 3]; 2] {
        let image = self.image(point);
        // The smaller of two such coordinates is on a finer grid; one more image puts both on the coarser one.
        let point = self.image(image);
        [point, self.image(point)]
    }
}

impl fmt::Display for Plane {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let axis = ["x", "y", "z"][self.axis.index()];
        // No -0.
        write!(f, "{axis} = {}", self.offset + 0.0)
    }
}

/// The symmetry that is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Symmetry {
    /// About this plane.
    About(Plane),
    /// About the plane across an axis about which the surface is symmetric.
    Auto,
}

/// The text is no symmetry.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[error("write x, y or z, the axis across which the plane lies, perhaps with its place on the axis, as y:0.5; or auto")]
pub struct NoSymmetry;

impl FromStr for Symmetry {
    type Err = NoSymmetry;

    /// `x`, `y:0.5`, `auto`.
    fn from_str(text: &str) -> Result<Self, NoSymmetry> {
        if text == "auto" {
            return Ok(Self::Auto);
        }
        let (axis, offset) = text.split_once(':').unwrap_or((text, "0"));
        let axis = match axis {
            "x" => Axis::X,
            "y" => Axis::Y,
            "z" => Axis::Z,
            _ => return Err(NoSymmetry),
        };
        let offset = offset.parse().ok().filter(|offset: &f64| offset.is_finite()).ok_or(NoSymmetry)?;
        Ok(Self::About(Plane { axis, offset }))
    }
}

/// Why a surface has no mesh that is symmetric as asked.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum SymmetryError {
    /// The plane does not cross the surface.
    #[error(
        "the surface lies wholly on one side of the plane {plane}, from {low:.6e} to {high:.6e} along this axis; give a plane that \
         crosses it, or the whole surface"
    )]
    OneSide {
        /// The plane.
        plane: Plane,
        /// The least coordinate of the surface on the plane's axis.
        low: f64,
        /// The largest.
        high: f64,
    },
    /// Triangles lie in the plane.
    #[error("{count} triangles lie in the plane {plane}, the first at {}; the halves cannot be joined there: remove them", shown(.at))]
    InPlane {
        /// The plane.
        plane: Plane,
        /// The number of triangles.
        count: usize,
        /// The middle of the first one, in model units.
        at: [f64; 3],
    },
    /// The surface has a vertex or an edge on the plane where it does not cross it.
    #[error(
        "the surface touches the plane {plane} at {} without crossing it, so its halves cannot be joined there; move it away from the \
         plane, or mesh it without symmetry",
        shown(.at)
    )]
    Touches {
        /// The plane.
        plane: Plane,
        /// The vertex, or an end of the edge, in model units.
        at: [f64; 3],
    },
    /// The surface is symmetric about no plane that is tried.
    #[error(
        "the surface is symmetric about no plane across x, y or z: the nearest is {plane}, where its mirror image is {distance:.3e} \
         away from it at {}, more than {limit:.3e}, half the side of a tile; name the plane, or turn the model so that its plane lies \
         across an axis",
        shown(.at)
    )]
    NoPlane {
        /// The plane of the least distance.
        plane: Plane,
        /// The largest distance of the surface's mirror image from the surface, in model units.
        distance: f64,
        /// Its place, in model units.
        at: [f64; 3],
        /// The largest distance that is taken for symmetry.
        limit: f64,
    },
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn symmetries_are_read() {
        let plane = |axis, offset| Ok(Symmetry::About(Plane { axis, offset }));
        assert_eq!("x".parse(), plane(Axis::X, 0.0));
        assert_eq!("z:-0.5".parse(), plane(Axis::Z, -0.5));
        assert_eq!("auto".parse(), Ok(Symmetry::Auto));
        for refused in ["", "w", "x:", "x:inf", "x:nan", "X", ":0", "x:0:0"] {
            assert_eq!(refused.parse::<Symmetry>(), Err(NoSymmetry), "{refused}");
        }
    }

    #[test]
    fn each_of_a_pair_is_the_image_of_the_other() {
        let mut seed = 1_u64;
        let mut number = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1_u64 << 53) as f64
        };
        let (mut plain, mut all) = (0, 0);
        for offset in [0.0, 0.1, -0.3, 1e3 + 0.1, 1e-9, 1e9 / 3.0] {
            for scale in [1e-6, 1.0, 1e3, 1e9] {
                let plane = Plane { axis: Axis::Y, offset };
                for _ in 0..1_000 {
                    let given = [0.5, offset + scale * number(), 0.7];
                    let [point, image] = plane.pair(given);
                    assert_eq!((plane.image(point), plane.image(image)), (image, point), "{given:?}");
                    let step = f64::EPSILON * given[1].abs().max(offset.abs());
                    assert!((point[1] - given[1]).abs() <= 2.0 * step, "{given:?}");
                    assert!(offset != 0.0 || point == given, "the image is exact");
                    plain += usize::from(plane.image(plane.image(given)) == given);
                    all += 1;
                }
                assert_eq!(plane.pair([0.0, offset, 0.0]), [[0.0, offset, 0.0]; 2]);
            }
        }
        assert!(plain < all - 500, "the image of the image is rounded: {plain} of {all}");
    }
}
