//! Constraints of the field: features and the user's guides.
//!
//! # Practice
//! A guide without weight fixes the crosses that it reaches. One of weight `w` pulls at them, with `2 pi w` in all, shared
//! by area, against links whose weights are cotangents and so do not depend on the triangles: as a plate's conductance
//! between a disc and a ring `e` times as wide is `2 pi` too, a weight of 1 weighs about as much as the surroundings,
//! whatever the radius and however fine the triangles are. How far that draws the cross at the guide's point of the way
//! that an exact guide would: on the plate (18 degrees off, radius 0.03) 7 % for 0.1, 28 % for 0.3, 65 % for 1, 90 % for 3,
//! 99 % for 10; on the wing, between two edges that want other rows (37 degrees, radius 0.1), 4 % for 0.3, 19 % for 1, 75 %
//! for 3, 98 % for 10.

use super::{Complex, Sectors};
use crate::surface::nearest::{Triangles, nearest_on_segment};
use crate::surface::{Surface, next, previous};
use glam::DVec3;
use rayon::prelude::*;
use rustc_hash::FxHashSet;
use serde::Serialize;
use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};
use std::f64::consts::{PI, TAU};
use thiserror::Error;

/// A guide without radius may be this share of the surface's diagonal away from it.
const TOLERANCE: f64 = 0.02;
/// The least sine of the angle between a guide and the normal: below, its direction along the surface says nothing.
const LEAST_SINE: f64 = 0.1;
/// Most places along a part of a stroke that are looked at.
const MOST_PLACES: f64 = 10_000.0;

/// The user's wish for the field (the paper's control vectors, section 1): a direction near a point or along a stroke.
#[derive(Clone, Debug, PartialEq)]
pub struct Guide {
    /// What reports call it.
    pub name: String,
    /// Where it is and which way it points.
    pub trace: Trace,
    /// How far from its trace it reaches over the surface, in model units; 0: the nearest triangles' corners. Default 0.
    pub radius: f64,
    /// How strongly it pulls: 1 about as much as the surroundings, 10 nearly all the way. `None`, the default: the field
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
    /// How many crosses of the field it fixes or pulls at.
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

/// What draws an unknown towards a cross.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pull {
    pub toward: Complex,
    /// Against the weights of links; infinite: fixed.
    pub weight: f32,
}

impl Pull {
    pub fn none() -> Self {
        Self { toward: [0.0, 0.0], weight: 0.0 }
    }

    pub fn fixed(toward: Complex) -> Self {
        Self { toward, weight: f32::INFINITY }
    }

    pub fn is_fixed(&self) -> bool {
        self.weight == f32::INFINITY
    }

    /// Adds another pull, to be made one by [`Pull::settle`]. What is fixed is averaged, and other pulls do not count.
    pub fn add(&mut self, toward: Complex, weight: f32) {
        if weight == f32::INFINITY && !self.is_fixed() {
            *self = Self { toward: [0.0, 0.0], weight };
        } else if self.is_fixed() && weight != f32::INFINITY {
            return;
        }
        let share = if weight == f32::INFINITY { 1.0 } else { weight };
        self.toward = [self.toward[0] + toward[0] * share, self.toward[1] + toward[1] * share];
        if !self.is_fixed() {
            self.weight += weight;
        }
    }

    /// Makes the sum of several pulls one direction, as strong as what is left of them; pulls that cancel leave none.
    pub fn settle(&mut self) {
        let length = (self.toward[0] * self.toward[0] + self.toward[1] * self.toward[1]).sqrt();
        let whole = if self.is_fixed() { 1.0 } else { self.weight };
        if length > 1e-6 * whole {
            self.toward = self.toward.map(|x| x / length);
            self.weight = if self.is_fixed() { f32::INFINITY } else { length };
        } else {
            *self = Self::none();
        }
    }
}

/// A pull on one sector.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Grip {
    pub sector: u32,
    /// The direction, in radians from the sector's direction zero.
    pub angle: f64,
    /// The pull's weight per area of the surface (unit-sized); `None`: the cross is fixed.
    pub density: Option<f64>,
}

impl Grip {
    /// The cross that has the direction.
    pub fn toward(&self) -> Complex {
        let (s, c) = (4.0 * self.angle).sin_cos();
        [c as f32, s as f32]
    }
}

/// The pull on each sector: features fix theirs to run along the feature, grips draw the others.
pub(crate) fn pulls(surface: &Surface, sectors: &Sectors, grips: &[Grip]) -> Vec<Pull> {
    let along = |&quarters: &u8| if quarters > 0 { Pull::fixed([1.0, 0.0]) } else { Pull::none() };
    let mut pulls: Vec<Pull> = sectors.quarters.iter().map(along).collect();
    for grip in grips {
        let weight = |density: f64| (density * sector_area(surface, sectors, grip.sector)) as f32;
        pulls[grip.sector as usize].add(grip.toward(), grip.density.map_or(f32::INFINITY, weight));
    }
    pulls.iter_mut().filter(|pull| pull.weight > 0.0).for_each(Pull::settle);
    pulls
}

/// Where the guides grip, and what became of each.
pub(crate) fn grips(surface: &Surface, sectors: &Sectors, guides: &[Guide]) -> (Vec<Grip>, Vec<GuideReport>) {
    if guides.is_empty() {
        return (Vec::new(), Vec::new());
    }
    let triangles = Triangles::new(surface);
    let (grips, reports): (Vec<_>, Vec<_>) =
        guides.par_iter().map(|guide| Reach::new(&triangles, surface, sectors, guide).grip(guide)).unzip();
    (grips.concat(), reports)
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

    /// Reaches the corners of the triangles nearest to a part, looked for in steps of half a triangle; returns these,
    /// with the part.
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

    /// Reaches the vertices within a radius that the surface inside the radius connects to triangles beneath the guide, not
    /// those on the other side of a thin plate. Nearer triangles come first, and with the part that led to them: so each is
    /// visited once, however many parts are near.
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

    /// The grips, and what is wrong with the guide.
    fn grip(&self, guide: &Guide) -> (Vec<Grip>, GuideReport) {
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
        let grips = held.iter().map(|&(sector, angle)| Grip { sector, angle, density }).collect();

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
        (grips, GuideReport { name: guide.name.clone(), crosses: held.len(), trouble })
    }
}

/// A third of the area of the triangles at a sector.
fn sector_area(surface: &Surface, sectors: &Sectors, sector: u32) -> f64 {
    sectors.corners(surface, sector).map(|corner| f64::from(surface.double_area(corner as usize / 3)) / 6.0).sum()
}

/// A direction in space as a whole sector sees it, in radians from its direction zero; `None` where it points along the
/// normal.
pub(crate) fn angle_along(surface: &Surface, sectors: &Sectors, sector: u32, direction: DVec3) -> Option<f64> {
    let angle = |corner: u32| {
        let [o, p, q] =
            [corner, next(corner), previous(corner)].map(|h| surface.points[surface.origin(h) as usize].as_dvec3());
        let along = (p - o).try_normalize()?;
        let across = along.cross(q - o).cross(along).try_normalize()?;
        let (x, y) = (direction.dot(along), direction.dot(across));
        (x.hypot(y) > LEAST_SINE * direction.length()).then(|| y.atan2(x))
    };
    // The corner that the direction runs through, or the one that it misses least: beyond it, angles are not its own.
    let miss = |corner: u32, angle: f64| {
        let middle = sectors.corner_angle(corner) / 2.0;
        let off = (angle - middle).abs();
        off.min(TAU - off) - middle
    };
    let seen = sectors.corners(surface, sector).filter_map(|corner| Some((corner, angle(corner)?)));
    let (corner, angle) = seen.min_by(|a, b| miss(a.0, a.1).total_cmp(&miss(b.0, b.1)))?;
    // The same angle on the side of the corner's middle.
    let middle = sectors.corner_angle(corner) / 2.0;
    let angle = angle + if angle < middle - PI { TAU } else { 0.0 };
    Some(sectors.direction(corner, angle))
}
