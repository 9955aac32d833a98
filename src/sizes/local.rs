//! Sizes at places: along features, in regions and boxes, and round holes.
//!
//! # Theory
//! At a distance `d` from a place, straight through space, the side is at most `size + (growth - 1) d`.

use super::SizesError;
use crate::surface::nearest::Simplices;
use crate::surface::{Curve, Surface};
use glam::DVec3;
use rayon::prelude::*;
use std::fmt;
use std::str::FromStr;
use thiserror::Error;

/// The mean distance of the points of a round curve from their centre may be missed by this share.
const ROUND: f64 = 0.1;

/// A part of a surface.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Place {
    /// All features.
    Features,
    /// Open boundaries.
    Boundaries,
    /// Sharp edges within the surface.
    Creases,
    /// Features within the surface that are not sharp: the lines along which it bends most, and edges that are named.
    Ridges,
    /// The triangles of a named region.
    Region(String),
    /// What lies within a box, in model units.
    Box {
        /// The least coordinates.
        low: [f64; 3],
        /// The largest coordinates.
        high: [f64; 3],
    },
}

/// A size at a place. Its text is `PLACE:SIZE` or `PLACE:SIZE:GROWTH`; a place is `features`, `boundaries`, `creases`, `ridges`, a
/// box by the six numbers `X,Y,Z,X,Y,Z` of two corners, or the name of a region.
#[derive(Clone, Debug, PartialEq)]
pub struct LocalSize {
    /// The place.
    pub place: Place,
    /// The largest side there, in model units.
    pub size: f64,
    /// The largest ratio of two sides beside each other round the place; `None`: [`SizeOptions::growth`](super::SizeOptions::growth).
    pub growth: Option<f64>,
}

/// A text is no size at a place.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[error(
    "write PLACE:SIZE or PLACE:SIZE:GROWTH, as ridges:0.1 or 0,0,0,1,2,3:0.1:1.2; a place is features, boundaries, creases, ridges, two \
     corners of a box, or a region's name; the size is above 0, the growth 1.01 to 10"
)]
pub struct NoLocalSize;

impl FromStr for LocalSize {
    type Err = NoLocalSize;

    fn from_str(text: &str) -> Result<Self, NoLocalSize> {
        let (front, last) = text.rsplit_once(':').ok_or(NoLocalSize)?;
        let last: f64 = last.parse().map_err(|_| NoLocalSize)?;
        let with_growth = front.rsplit_once(':').and_then(|(place, size)| Some((place, size.parse::<f64>().ok()?)));
        let (place, size, growth) = match with_growth {
            Some((place, size)) => (place, size, Some(last)),
            None => (front, last, None),
        };
        let is_valid = size > 0.0 && size.is_finite() && growth.is_none_or(|growth| (1.01..=10.0).contains(&growth));
        if !is_valid || place.is_empty() {
            return Err(NoLocalSize);
        }
        let numbers: Result<Vec<f64>, _> = place.split(',').map(str::parse::<f64>).collect();
        let place = match (place, numbers.as_deref()) {
            ("features", _) => Place::Features,
            ("boundaries", _) => Place::Boundaries,
            ("creases", _) => Place::Creases,
            ("ridges", _) => Place::Ridges,
            (_, Ok(&[a, b, c, d, e, f])) => {
                let (one, other) = (DVec3::new(a, b, c), DVec3::new(d, e, f));
                Place::Box { low: one.min(other).into(), high: one.max(other).into() }
            }
            (_, Ok(_)) => return Err(NoLocalSize),
            (name, Err(_)) => Place::Region(name.to_owned()),
        };
        Ok(Self { place, size, growth })
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Features => f.write_str("features"),
            Self::Boundaries => f.write_str("boundaries"),
            Self::Creases => f.write_str("creases"),
            Self::Ridges => f.write_str("ridges"),
            Self::Region(name) => write!(f, "region {name}"),
            Self::Box { low, high } => write!(f, "box {low:?} to {high:?}"),
        }
    }
}

/// Parts of a surface, in unit-sized coordinates, with the largest side at each.
pub(super) struct Limit {
    shape: Shape,
    /// Of the segments in their order; else one.
    sizes: Vec<f64>,
    growth: f64,
}

enum Shape {
    Segments(Simplices<2>),
    Triangles(Simplices<3>),
    Box { low: DVec3, high: DVec3 },
}

impl Limit {
    /// The limit of a size at a place; `growth` where it has none of its own. `crease` is the angle of creases, in degrees.
    ///
    /// # Errors
    /// Where the surface has no such place.
    pub fn new(surface: &Surface, local: &LocalSize, crease: f64, growth: f64) -> Result<Self, SizesError> {
        let point = |v: u32| DVec3::from(surface.point(v));
        let size = local.size / surface.frame().diagonal;
        let growth = local.growth.unwrap_or(growth);
        let half_edges = 0..3 * surface.triangle_count() as u32;
        let along = |is_chosen: &dyn Fn(u32) -> bool| {
            let of_edge = |&h: &u32| surface.twin(h).is_none_or(|twin| h < twin);
            let chosen: Vec<u32> = half_edges
                .clone()
                .filter(of_edge)
                .filter(|&h| surface.features().is_feature(h) && is_chosen(h))
                .collect();
            let sizes = vec![size; chosen.len()];
            let segments = chosen.into_iter().map(|h| [surface.origin(h), surface.target(h)].map(point));
            (Shape::Segments(Simplices::new(segments)), sizes)
        };
        let is_open = |h: u32| surface.twin(h).is_none();
        let limit = f64::cos(crease.to_radians()) as f32;
        let is_sharp = |h: u32| {
            let other = surface.twin(h).map(|twin| surface.normal(twin as usize / 3));
            other.is_some_and(|other| crease < 180.0 && surface.normal(h as usize / 3).dot(other) < limit)
        };
        let (shape, sizes) = match &local.place {
            Place::Features => along(&|_| true),
            Place::Boundaries => along(&is_open),
            Place::Creases => along(&is_sharp),
            Place::Ridges => along(&|h| !is_open(h) && !is_sharp(h)),
            Place::Region(name) => {
                let regions = surface.regions();
                let known = regions.names.iter().position(|known| known == name);
                let of = |t: &usize| known.is_some() && regions.of_face.get(*t).map(|&region| region as usize) == known;
                let triangles: Vec<usize> = (0..surface.triangle_count()).filter(of).collect();
                let sizes = if triangles.is_empty() { Vec::new() } else { vec![size] };
                let corners = triangles.into_iter().map(|t| surface.triangles[t].map(point));
                (Shape::Triangles(Simplices::new(corners)), sizes)
            }
            Place::Box { low, high } => {
                let [low, high] = [low, high].map(|&corner| DVec3::from(surface.frame().to_unit(corner)));
                (Shape::Box { low, high }, vec![size])
            }
        };
        if sizes.is_empty() {
            let regions = match &local.place {
                Place::Region(_) => surface.regions().names.clone(),
                _ => Vec::new(),
            };
            return Err(SizesError::Nowhere { place: local.place.to_string(), regions });
        }
        Ok(Self { shape, sizes, growth })
    }

    /// So many tiles at least round each closed curve that is round.
    pub fn round_holes(surface: &Surface, around: usize, growth: f64) -> Self {
        let point = |v: u32| DVec3::from(surface.point(v));
        let segments = round_curves(surface).flat_map(|(_, curve)| {
            let size = curve.length() / around as f64;
            curve.vertices.windows(2).map(move |ends| (size, [ends[0], ends[1]]))
        });
        let (sizes, segments): (Vec<f64>, Vec<[u32; 2]>) = segments.unzip();
        let shape = Shape::Segments(Simplices::new(segments.into_iter().map(|ends| ends.map(point))));
        Self { shape, sizes, growth }
    }

    /// The largest side at a point, in unit-sized coordinates.
    pub fn at(&self, point: DVec3) -> f64 {
        let (distance, k) = match &self.shape {
            Shape::Segments(segments) => match segments.nearest(point) {
                Some((distance, segment)) => (distance, segment.id as usize),
                None => return f64::INFINITY,
            },
            Shape::Triangles(triangles) => (triangles.distance(point), 0),
            Shape::Box { low, high } => (point.distance(point.clamp(*low, *high)), 0),
        };
        self.sizes[k] + (self.growth - 1.0) * distance
    }
}

/// The least of the limits at vertices of a surface from `first` on.
pub(super) fn least(limits: &[Limit], surface: &Surface, first: usize) -> Vec<f64> {
    let least = |v: u32| {
        let point = DVec3::from(surface.point(v));
        limits.iter().map(|limit| limit.at(point)).fold(f64::INFINITY, f64::min)
    };
    (first as u32..surface.vertex_count() as u32).into_par_iter().map(least).collect()
}

/// The closed features of a surface that are round, with their indices.
pub(super) fn round_curves(surface: &Surface) -> impl Iterator<Item = (usize, &Curve)> {
    surface.features().curves().iter().enumerate().filter(|(_, curve)| is_round(surface, curve))
}

/// Whether a curve is closed, and all of it is about equally far from its centre.
fn is_round(surface: &Surface, curve: &Curve) -> bool {
    let points = || curve.vertices[1..].iter().map(|&v| DVec3::from(surface.point(v)));
    let count = curve.vertices.len() as f64 - 1.0;
    let centre = points().sum::<DVec3>() / count;
    let mean = points().map(|point| point.distance(centre)).sum::<f64>() / count;
    curve.closed && points().all(|point| (point.distance(centre) - mean).abs() <= ROUND * mean)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::examples::Example;
    use crate::surface::{FeatureOptions, Soup};

    #[test]
    fn sizes_at_places_are_read() {
        let read = |text: &str| text.parse::<LocalSize>();
        let ridges = LocalSize { place: Place::Ridges, size: 0.003, growth: None };
        assert_eq!(read("ridges:0.003"), Ok(ridges.clone()));
        assert_eq!(read("ridges:0.003:1.1"), Ok(LocalSize { growth: Some(1.1), ..ridges }));
        let place = Place::Box { low: [-1.0, 0.0, 2.0], high: [1.0, 5.0, 3.0] };
        assert_eq!(read("1,0,3,-1,5,2:2"), Ok(LocalSize { place, size: 2.0, growth: None }));
        let wall = LocalSize { place: Place::Region("outer wall".into()), size: 1e-3, growth: None };
        assert_eq!(read("outer wall:1e-3"), Ok(wall));
        for text in
            ["", "ridges", "ridges:", ":1", "ridges:0", "ridges:-1", "ridges:1:1", "ridges:inf", "1,2,3:1", "a:b"]
        {
            assert_eq!(read(text), Err(NoLocalSize), "{text}");
        }
    }

    fn surface(name: &str) -> Surface {
        let soup: Soup = name.parse::<Example>().expect("an example's name").generate(4_000);
        Surface::new(&soup, &FeatureOptions::default()).unwrap_or_else(|error| panic!("{error}"))
    }

    #[test]
    fn the_limit_grows_with_the_distance_and_a_place_that_is_missing_is_told() {
        let plate = surface("plate");
        let unit = plate.frame().diagonal;
        let local = |text: &str| text.parse::<LocalSize>().expect("a size");
        let limit = |text: &str| Limit::new(&plate, &local(text), 40.0, 1.5);
        let at = |text: &str, point: [f64; 3]| {
            let limit = limit(text).unwrap_or_else(|error| panic!("{error}"));
            limit.at(DVec3::from(plate.frame().to_unit(point))) * unit
        };
        let corner = plate.frame().to_model(plate.point(0));
        let beside = [corner[0], corner[1], corner[2] + 2.0];
        let of_box = format!("{0},{1},{2},{0},{1},{2}:0.1", corner[0], corner[1], corner[2]);
        for place in ["boundaries:0.1", &of_box] {
            assert!((at(place, corner) - 0.1).abs() < 1e-6, "{place}");
            assert!((at(place, beside) - (0.1 + 0.5 * 2.0)).abs() < 1e-6, "{place}");
        }
        assert!((at("boundaries:0.1:1.1", beside) - (0.1 + 0.1 * 2.0)).abs() < 1e-6);
        for missing in ["ridges:0.1", "creases:0.1", "wall:0.1"] {
            assert!(matches!(limit(missing), Err(SizesError::Nowhere { .. })), "{missing}");
        }
    }

    #[test]
    fn round_curves_are_told_from_others() {
        let plate = surface("plate");
        let round = Limit::round_holes(&plate, 12, 1.2);
        let curves = plate.features().curves().iter().filter(|curve| is_round(&plate, curve));
        let lengths: Vec<f64> = curves.map(Curve::length).collect();
        assert_eq!(lengths.len(), 1, "the hole, not the square");
        assert!(!round.sizes.is_empty() && round.sizes.iter().all(|size| (lengths[0] / 12.0 - size).abs() < 1e-9));
        let block = surface("block");
        assert_eq!(block.features().curves().iter().filter(|curve| is_round(&block, curve)).count(), 2, "of the bore");
    }
}
