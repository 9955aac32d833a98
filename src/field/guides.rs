//! The user's guides, and the constraints that they make.
//!
//! # Practice
//! A guide without weight fixes the crosses that it reaches. One of weight `w` constrains them with `2 pi w` in all, shared by
//! area, against links whose weights are cotangents and do not depend on the triangles. A plate's conductance between a disc
//! and a ring `e` times as wide is `2 pi` as well: a weight of 1 is about that of the surroundings, whatever the radius and the
//! triangles. Its effect in figures: docs/experiments.md, field.

use super::Sectors;
use super::constraints::{DirectionConstraint, angle_along, sector_area};
use crate::surface::Surface;
use crate::surface::nearest::{Triangles, nearest_on_segment};
use glam::DVec3;
use rayon::prelude::*;
use rustc_hash::FxHashSet;
use serde::Serialize;
use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};
use std::f64::consts::TAU;
use thiserror::Error;

/// A guide without radius may be this share of the surface's diagonal away from it.
const TOLERANCE: f64 = 0.02;
/// The most places along a part of a stroke that are examined.
const MOST_PLACES: f64 = 10_000.0;

/// A user's constraint of the field (the paper's control vectors, section 1): a direction near a point or along a stroke.
#[derive(Clone, Debug, PartialEq)]
pub struct Guide {
    /// What reports call it.
    pub name: String,
    /// Where it is and which way it points.
    pub trace: Trace,
    /// How far from its trace it reaches over the surface, in model units; 0: the nearest triangles' corners. Default 0.
    pub radius: f64,
    /// Its weight: 1 about that of the surroundings, 10 nearly exact. `None`, the default: the field
    /// follows it exactly.
    pub weight: Option<f64>,
}

/// Where a guide is and which way it points, in model units.
#[derive(Clone, Debug, PartialEq)]
pub enum Trace {
    /// A control vector.
    Vector {
        /// The place; the nearest point of the surface counts.
        point: [f64; 3],
        /// The direction, of any length; its part along the surface counts.
        direction: [f64; 3],
    },
    /// A line of points on the surface whose tangents guide.
    Stroke {
        /// The points, at least two that differ.
        points: Vec<[f64; 3]>,
    },
}

impl Guide {
    /// A control vector: at `point` (the nearest triangle's corners) the field follows `direction`, exactly.
    pub fn vector(point: [f64; 3], direction: [f64; 3]) -> Self {
        Self { name: "a guide".to_owned(), trace: Trace::Vector { point, direction }, radius: 0.0, weight: None }
    }

    /// A stroke: along the line through these points the field follows its tangents, exactly.
    pub fn stroke(points: Vec<[f64; 3]>) -> Self {
        Self { name: "a stroke".to_owned(), trace: Trace::Stroke { points }, radius: 0.0, weight: None }
    }

    /// The same guide, reaching as far as `radius` (model units).
    pub fn within(self, radius: f64) -> Self {
        Self { radius, ..self }
    }

    /// The same guide with a weight.
    pub fn with_weight(self, weight: f64) -> Self {
        Self { weight: Some(weight), ..self }
    }

    /// The same guide under another name.
    pub fn named(self, name: impl Into<String>) -> Self {
        Self { name: name.into(), ..self }
    }
}

/// What became of a guide.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GuideReport {
    /// Its name.
    pub name: String,
    /// How many crosses of the field it constrains.
    pub crosses: usize,
    /// Why it has no effect, or not all that was asked for.
    pub trouble: Option<GuideTrouble>,
}

/// Why a guide has no effect, or not all that was asked for.
#[derive(Clone, Debug, Error, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
#[non_exhaustive]
pub enum GuideTrouble {
    /// It is away from the surface.
    #[error(
        "it is {} away from the surface, more than {}, and has no effect; move it, check its units, or give it a larger \
         radius",
        rounded(distance),
        rounded(limit)
    )]
    Far {
        /// Its distance, in model units.
        distance: f64,
        /// How far away it may be: its radius, or 2 % of the surface's diagonal where it has none.
        limit: f64,
    },
    /// Some of a stroke is away from the surface.
    #[error(
        "{far} of {places} places along it are more than {} away from the surface, up to {}, and have no effect; follow \
         the surface more closely, or give it a larger radius",
        rounded(limit),
        rounded(distance)
    )]
    PartlyFar {
        /// Places that are too far away.
        far: usize,
        /// Places that were looked at.
        places: usize,
        /// The largest distance, in model units.
        distance: f64,
        /// How far away they may be.
        limit: f64,
    },
    /// It points out of the surface.
    #[error("it points along the normal of the surface, and has no effect; give it a direction along the surface")]
    AlongNormal,
    /// It reaches features alone.
    #[error(
        "it reaches only features, which the field follows in any case, and has no effect; move it off them, or give it \
         a radius"
    )]
    OnFeatures,
}

/// Three digits of a length.
fn rounded(length: &f64) -> f64 {
    format!("{length:.2e}").parse().unwrap_or(*length)
}

/// The constraints that guides make, and what became of each guide.
pub(super) fn constraints(
    surface: &Surface,
    sectors: &Sectors,
    guides: &[Guide],
) -> (Vec<DirectionConstraint>, Vec<GuideReport>) {
    if guides.is_empty() {
        return (Vec::new(), Vec::new());
    }
    let triangles = Triangles::new(surface);
    let (constraints, reports): (Vec<_>, Vec<_>) =
        guides.par_iter().map(|guide| Reach::new(&triangles, surface, sectors, guide).constraints(guide)).unzip();
    (constraints.concat(), reports)
}

/// A straight part of a guide: a segment, of no length for a control vector, and the direction along it.
struct Part {
    start: DVec3,
    end: DVec3,
    direction: DVec3,
}

fn parts(surface: &Surface, trace: &Trace) -> Vec<Part> {
    let place = |point: [f64; 3]| DVec3::from(surface.frame().to_unit(point));
    match trace {
        Trace::Vector { point, direction } => {
            let at = place(*point);
            vec![Part { start: at, end: at, direction: DVec3::from(*direction) }]
        }
        Trace::Stroke { points } => points
            .windows(2)
            .map(|pair| [place(pair[0]), place(pair[1])])
            .filter(|[start, end]| start != end)
            .map(|[start, end]| Part { start, end, direction: end - start })
            .collect(),
    }
}

/// The sectors that a guide reaches, in unit-sized coordinates.
struct Reach<'a> {
    surface: &'a Surface,
    sectors: &'a Sectors,
    parts: Vec<Part>,
    /// The part nearest to each sector, after its distance.
    reached: BTreeMap<u32, (f64, usize)>,
    limit: f64,
    places: usize,
    far: usize,
    farthest: f64,
}

impl<'a> Reach<'a> {
    fn new(triangles: &Triangles, surface: &'a Surface, sectors: &'a Sectors, guide: &Guide) -> Self {
        let radius = guide.radius / surface.frame().diagonal;
        let limit = if radius > 0.0 { radius } else { TOLERANCE };
        let parts = parts(surface, &guide.trace);
        let reached = BTreeMap::new();
        let mut reach = Self { surface, sectors, parts, reached, limit, places: 0, far: 0, farthest: 0.0 };
        let beneath = (0..reach.parts.len()).flat_map(|part| reach.along(triangles, part)).collect();
        if radius > 0.0 {
            reach.spread(radius, beneath);
        }
        reach
    }

    /// Reaches the corners of the triangles nearest to a part, in steps of half a triangle; returns the triangles with the part.
    fn along(&mut self, triangles: &Triangles, part: usize) -> Vec<(u32, usize)> {
        let Part { start, end, .. } = self.parts[part];
        let way = end - start;
        let mut at = 0.0;
        let mut beneath = Vec::new();
        loop {
            let place = start + way * at;
            let (triangle, distance) = triangles.nearest(place);
            self.places += 1;
            self.farthest = self.farthest.max(distance);
            if distance > self.limit {
                self.far += 1;
            } else {
                (3 * triangle..3 * triangle + 3).for_each(|corner| self.touch(corner, part));
                beneath.push((triangle, part));
            }
            if at >= 1.0 {
                return beneath;
            }
            let size = f64::from(self.surface.double_area(triangle as usize)).sqrt();
            at = (at + (size / 2.0 / way.length().max(f64::MIN_POSITIVE)).max(1.0 / MOST_PLACES)).min(1.0);
        }
    }

    /// Reaches the vertices within a radius that the surface within the radius connects to triangles beneath the guide, not
    /// those on the other side of a thin plate. Nearer triangles come first, with the part that led to them, so that each is
    /// visited once.
    fn spread(&mut self, radius: f64, beneath: Vec<(u32, usize)>) {
        let corners = |triangle: u32| 3 * triangle..3 * triangle + 3;
        let entry = |reach: &Self, triangle: u32, part: usize| {
            let nearest = corners(triangle).map(|corner| reach.distance(corner, part)).fold(f64::INFINITY, f64::min);
            // The bits of numbers from zero up are in the order of the numbers.
            Reverse((nearest.to_bits(), triangle, part))
        };
        let mut open: BinaryHeap<_> = beneath.into_iter().map(|(triangle, part)| entry(self, triangle, part)).collect();
        let mut seen = FxHashSet::default();
        while let Some(Reverse((nearest, triangle, part))) = open.pop() {
            if f64::from_bits(nearest) > radius || !seen.insert(triangle) {
                continue;
            }
            for corner in corners(triangle) {
                if self.distance(corner, part) <= radius {
                    self.touch(corner, part);
                }
                if let Some(twin) = self.surface.twin(corner).filter(|twin| !seen.contains(&(twin / 3))) {
                    open.push(entry(self, twin / 3, part));
                }
            }
        }
    }

    fn distance(&self, corner: u32, part: usize) -> f64 {
        let Part { start, end, .. } = self.parts[part];
        let place = self.surface.points[self.surface.origin(corner) as usize].as_dvec3();
        nearest_on_segment(place, start, end).distance(place)
    }

    fn touch(&mut self, corner: u32, part: usize) {
        let here = (self.distance(corner, part), part);
        let nearest = self.reached.entry(self.sectors.of_corner[corner as usize]).or_insert(here);
        if here < *nearest {
            *nearest = here;
        }
    }

    /// The constraints, and what is wrong with the guide.
    fn constraints(&self, guide: &Guide) -> (Vec<DirectionConstraint>, GuideReport) {
        let free = |sector: u32| self.sectors.quarters[sector as usize] == 0;
        let held: Vec<(u32, f64)> = self
            .reached
            .iter()
            .filter(|(sector, _)| free(**sector))
            .filter_map(|(&sector, &(_, part))| {
                Some((sector, angle_along(self.surface, self.sectors, sector, self.parts[part].direction)?))
            })
            .collect();
        let area: f64 = held.iter().map(|&(sector, _)| sector_area(self.surface, self.sectors, sector)).sum();
        let density = guide.weight.map(|weight| TAU * weight / area.max(f64::MIN_POSITIVE));
        let constraints = held.iter().map(|&(sector, angle)| DirectionConstraint { sector, angle, density }).collect();

        let diagonal = self.surface.frame().diagonal;
        let (distance, limit) = (self.farthest * diagonal, self.limit * diagonal);
        let trouble = if self.reached.is_empty() {
            Some(GuideTrouble::Far { distance, limit })
        } else if held.is_empty() && self.reached.keys().any(|&sector| free(sector)) {
            Some(GuideTrouble::AlongNormal)
        } else if held.is_empty() {
            Some(GuideTrouble::OnFeatures)
        } else if self.far > 0 {
            Some(GuideTrouble::PartlyFar { far: self.far, places: self.places, distance, limit })
        } else {
            None
        };
        (constraints, GuideReport { name: guide.name.clone(), crosses: held.len(), trouble })
    }
}
