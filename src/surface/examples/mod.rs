//! Example surfaces of any resolution: for trying the mesher, for its tests and for its benches.
//!
//! All are oriented outward and share vertices between triangles. Lengths are in metres for the wing and plain units
//! for the others.

mod block;
mod flange;
mod m6;
mod plate;
mod section;
mod sphere;
mod strip;
mod torus;

use std::ops::RangeInclusive;
use std::str::FromStr;

pub use m6::M6Options;

use super::Soup;

/// An example surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Example {
    /// The ONERA M6 wing: see [`M6Options`].
    M6(M6Options),
    /// A ring torus about the z axis: closed, smooth, genus 1. Radii 1 and 0.4.
    Torus,
    /// The unit sphere: closed, smooth, genus 0.
    Sphere,
    /// The unit square in the plane z = 0 with a round hole of radius 0.2 in its middle: two boundary loops, four corners.
    Plate,
    /// A box 2 x 2 x 1 with a bore of radius 0.7 through it: straight and round creases, genus 1.
    Block,
    /// A ring of radii 0.5 and 1 and thickness 0.2 with 12 bolt holes of radius 0.07: round creases near each other, genus 13.
    Flange,
}

/// A name that is no example surface's.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no example surface {name:?}; choose one of {}", Example::NAMES.join(", "))]
pub struct UnknownExample {
    /// The name that was given.
    pub name: String,
}

impl Example {
    /// The names that [`Example::from_str`] knows.
    pub const NAMES: [&str; 6] = ["m6", "torus", "sphere", "plate", "block", "flange"];

    /// The number of triangles to ask for when there is no reason to ask for another.
    pub const DEFAULT_TRIANGLES: usize = 20_000;

    /// The numbers of triangles that a user may ask for.
    pub const TRIANGLES: RangeInclusive<usize> = 1..=20_000_000;

    /// Triangulates this surface with about `triangles` triangles: within 20 % from 500 (the flange: 5,000) to 1,000,000. Fewer give
    /// the coarsest triangulation that still shows the shape.
    pub fn generate(&self, triangles: usize) -> Soup {
        match self {
            Self::M6(options) => m6::generate(options, triangles),
            Self::Torus => torus::generate(triangles),
            Self::Sphere => sphere::generate(triangles),
            Self::Plate => plate::generate(triangles),
            Self::Block => block::generate(triangles),
            Self::Flange => flange::generate(triangles),
        }
    }
}

impl FromStr for Example {
    type Err = UnknownExample;

    /// The example of that name, the wing with its default options.
    fn from_str(name: &str) -> Result<Self, Self::Err> {
        match name {
            "m6" => Ok(Self::M6(M6Options::default())),
            "torus" => Ok(Self::Torus),
            "sphere" => Ok(Self::Sphere),
            "plate" => Ok(Self::Plate),
            "block" => Ok(Self::Block),
            "flange" => Ok(Self::Flange),
            _ => Err(UnknownExample { name: name.to_owned() }),
        }
    }
}
