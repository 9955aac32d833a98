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
//! Set [`Options::symmetry`](crate::Options#structfield.symmetry). A plane that is given lies across a coordinate axis. One that is found
//! need not: the mirror image about an oblique plane is rounded, so that the mesh is symmetric within a rounding of its coordinates.

pub mod chords;
pub mod cut;
pub mod find;
pub mod join;

pub use cut::{Half, cut};
pub use find::Asymmetry;
pub use join::{Joined, join};

use crate::surface::{short, shown};
use glam::DVec3;
use serde::Serialize;
use std::fmt;
use std::str::FromStr;
use thiserror::Error;

/// A vertex no farther from the plane than this, in diagonals of the surface's bounding box, lies on it: some roundings of f32.
pub const ON_PLANE: f64 = 1e-6;

/// The direction across a plane.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Axis {
    /// The first coordinate.
    X,
    /// The second coordinate.
    Y,
    /// The third coordinate.
    Z,
    /// Another direction, of length 1.
    Oblique([f64; 3]),
}

impl Axis {
    /// The coordinate axes.
    pub const ALL: [Self; 3] = [Self::X, Self::Y, Self::Z];

    /// The coordinate of a point along it.
    pub fn along(self, point: [f64; 3]) -> f64 {
        match self {
            Self::X => point[0],
            Self::Y => point[1],
            Self::Z => point[2],
            Self::Oblique(normal) => DVec3::from(normal).dot(point.into()),
        }
    }

    /// The point moved along it by what `change` makes of its coordinate.
    fn with_coordinate(self, mut point: [f64; 3], change: impl FnOnce(f64) -> f64) -> [f64; 3] {
        match self {
            Self::X => point[0] = change(point[0]),
            Self::Y => point[1] = change(point[1]),
            Self::Z => point[2] = change(point[2]),
            Self::Oblique(normal) => {
                let along = self.along(point);
                point = (DVec3::from(point) + (change(along) - along) * DVec3::from(normal)).into();
            }
        }
        point
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
        self.axis.along(point) - self.offset
    }

    /// The nearest point of the plane: its coordinate is exact across a coordinate axis, and rounded else.
    pub fn onto(self, point: [f64; 3]) -> [f64; 3] {
        self.axis.with_coordinate(point, |_| self.offset)
    }

    /// The mirror image of a point.
    pub fn image(self, point: [f64; 3]) -> [f64; 3] {
        self.axis.with_coordinate(point, |x| 2.0 * self.offset - x)
    }

    /// The mirror image of a direction.
    pub fn image_of_direction(self, direction: [f64; 3]) -> [f64; 3] {
        self.axis.with_coordinate(direction, |x| -x)
    }

    /// The point itself where it lies on the kept side or on the plane, else its mirror image.
    pub fn folded(self, point: [f64; 3]) -> [f64; 3] {
        if self.height(point) < 0.0 { self.image(point) } else { point }
    }

    /// A box that holds, on the kept side, what a box and its mirror image hold there: the part of it on that side, or the image of the
    /// other part where that is larger; about an oblique plane the box round both.
    pub fn folded_box(self, mut low: [f64; 3], mut high: [f64; 3]) -> ([f64; 3], [f64; 3]) {
        if let Axis::Oblique(_) = self.axis {
            let corners = (0..8).map(|k| std::array::from_fn(|x| if k >> x & 1 == 0 { low[x] } else { high[x] }));
            let is_above = corners.clone().all(|corner| self.height(corner) >= 0.0);
            let images: Vec<[f64; 3]> = corners.filter(|_| !is_above).map(|corner| self.image(corner)).collect();
            for corner in images {
                low = std::array::from_fn(|x| low[x].min(corner[x]));
                high = std::array::from_fn(|x| high[x].max(corner[x]));
            }
            return (low, high);
        }
        let [below, above] = [-self.height(low), self.height(high)];
        if below > above {
            high = self.axis.with_coordinate(high, |_| self.offset + below);
            low = self.axis.with_coordinate(low, |_| self.offset - above);
        }
        (self.axis.with_coordinate(low, |x| x.max(self.offset)), high)
    }

    /// A point and its mirror image, each the image of the other bit for bit: the point moves by a rounding where it must. About an
    /// oblique plane they are so within a rounding.
    pub fn pair(self, point: [f64; 3]) -> [[f64; 3]; 2] {
        let image = self.image(point);
        // The smaller of two such coordinates is on a finer grid; one more image puts both on the coarser one.
        let point = self.image(image);
        [point, self.image(point)]
    }
}

impl fmt::Display for Plane {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let offset = short(self.offset);
        match self.axis {
            Axis::X => write!(f, "x = {offset}"),
            Axis::Y => write!(f, "y = {offset}"),
            Axis::Z => write!(f, "z = {offset}"),
            Axis::Oblique([a, b, c]) => write!(f, "{a:.6} x {b:+.6} y {c:+.6} z = {offset:.6e}"),
        }
    }
}

/// The symmetry that is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Symmetry {
    /// About this plane.
    About(Plane),
    /// About the plane about which the surface is symmetric, across a coordinate axis or a principal axis of the surface.
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
        "the surface is symmetric about no plane across x, y, z or a principal axis of it: the nearest is {plane}, where its mirror image \
         is {distance:.3e} away from it at {}, more than {limit:.3e}, half the side of a tile; name the plane, or turn the model so that \
         its plane lies across x, y or z",
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
    fn planes_are_told_with_few_digits() {
        let told = |axis, offset: f64| Plane { axis, offset }.to_string();
        assert_eq!(told(Axis::X, 1.0 / 3.0), "x = 0.3333333");
        assert_eq!(told(Axis::Y, 0.1 + 0.2), "y = 0.3");
        assert_eq!(told(Axis::Z, -0.0), "z = 0");
        assert_eq!(told(Axis::X, 1234.06251), "x = 1234.063");
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

    #[test]
    fn folded_boxes_hold_what_is_on_the_other_side() {
        let straight = Plane { axis: Axis::X, offset: 1.0 };
        assert_eq!(straight.folded_box([-2.0, 0.0, 0.0], [2.0, 1.0, 1.0]), ([1.0, 0.0, 0.0], [4.0, 1.0, 1.0]));
        let oblique = Plane { axis: Axis::Oblique([0.6, 0.8, 0.0]), offset: 0.5 };
        let above = ([1.0, 1.0, 0.0], [2.0, 2.0, 1.0]);
        assert_eq!(oblique.folded_box(above.0, above.1), above, "it is on the kept side");
        let (low, high) = oblique.folded_box([-1.0; 3], [-0.5; 3]);
        let image = oblique.image([-0.7, -0.9, -0.6]);
        assert!((0..3).all(|k| low[k] <= image[k] && image[k] <= high[k]), "{low:?} {high:?} {image:?}");
        assert!(oblique.height(image) > 0.0 && oblique.height(oblique.onto(image)).abs() < 1e-15);
        assert!(oblique.height(oblique.image([0.3, -0.2, 7.0])) + oblique.height([0.3, -0.2, 7.0]) < 1e-15);
    }
}
