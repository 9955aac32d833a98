//! Anisotropy: which direction of each cross is the longer one, where tiles are rectangles.
//!
//! # Theory
//! A cross has two axes, and rectangles need one of them, without sign. Guides choose it where they are, and the matching of the
//! crosses carries the choice on, swapped by each odd quarter turn. Let a sector have 1 where the axis is the longer one, and -1
//! where the direction across it is. The smoothest continuation solves a Laplace equation whose links have a sign; the sign of
//! the solution is the choice. Where no point has an odd number of quarter turns around it, this is the guides' choice
//! everywhere, exactly. Around a point with an odd number, such as a singularity of index 1/4, there is only a cross: the choice
//! jumps along a *cut* from there to another such point or to a boundary.
//!
//! Tiles at a cut are squares. The logarithm of their aspect grows in proportion to the distance from the cut, to the asked one
//! over [`BLEND`] long sides.
//!
//! # Changes versus the paper
//! The paper has squares alone; the surface mosaics that it builds on (its references 1 and 2) have rectangles.
//!
//! # Practice
//! The choice passes creases, since the direction along a crease is the same on both sides, and places where sheets meet.
//!
//! A stretch is held as `log(side / mean side) (cos 2t, sin 2t)`, `t` the angle of the longer side: it can be averaged, and gives
//! the length of a tile in any direction.

use super::constraints::DirectionConstraint;
use super::matching::{Matching, axes};
use super::{Field, Guide, Sectors, guides};
use crate::compute::{Backend, Complex, ComputeError, Link};
use crate::geometry::{barycentric, cross, dot, triangle_normal, unit};
use crate::sizes::Growth;
use crate::solver::{Hierarchy, Problem, Terms};
use crate::surface::{Surface, next, previous};
use glam::Vec3;
use rayon::prelude::*;
use serde::Serialize;
use std::collections::VecDeque;
use std::f64::consts::FRAC_PI_2;
use std::ops::RangeInclusive;
use thiserror::Error;

/// The aspects that can be asked for.
pub const ASPECTS: RangeInclusive<f64> = 1.0..=20.0;

/// The long sides over which the aspect grows from a square's to the asked one (docs/experiments.md, field).
const BLEND: f64 = 2.0;
/// A guide chooses an axis where the cosine of twice the angle between them is at least this.
const LEAST_AGREEMENT: f64 = 0.2;
/// Smaller values, as behind many cuts, may be roundings.
const NEGLIGIBLE: f32 = 1e-6;
/// Iterations of the solver: signs alone count.
const ITERATIONS: u32 = 8;

/// Why tiles cannot be stretched.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum StretchError {
    /// The aspect makes no sense.
    #[error(
        "an aspect of {asked} cannot be made; ask for the longer side over the shorter one, {} to {}",
        ASPECTS.start(),
        ASPECTS.end()
    )]
    Aspect {
        /// What was asked for.
        asked: f64,
    },
    /// No guide chooses the longer side.
    #[error(
        "rectangular tiles need a guide: nothing says which way their longer side is to lie; give a direction at a point, or a \
         stroke, on the surface and off its features"
    )]
    NoGuide,
    /// Sizes that fit the field are those of squares.
    #[error("tiles cannot both be rectangular and fit the field; leave out the aspect or the fit")]
    Fitted,
    /// The backend failed.
    #[error(transparent)]
    Compute(#[from] ComputeError),
}

impl StretchError {
    /// Whether an aspect can be asked for.
    pub(crate) fn of_aspect(asked: f64) -> Result<(), Self> {
        if ASPECTS.contains(&asked) { Ok(()) } else { Err(Self::Aspect { asked }) }
    }
}

/// What became of the asked aspect.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StretchReport {
    /// The asked ratio of the longer side to the shorter one.
    pub aspect: f64,
    /// Points about which the longer side has no direction: singularities with an odd number of quarter turns.
    pub odd_singularities: usize,
    /// The share of the area on which the aspect is less than the root of what was asked for, but for `unguided`.
    pub nearly_square: f64,
    /// The share of the area that no guide reaches; tiles are squares there.
    pub unguided: f64,
}

/// The ratio of a tile's side to its mean side in each direction, over a surface.
#[derive(Clone, Debug)]
pub struct Stretch {
    of_sectors: Vec<Complex>,
    in_triangles: Vec<[Complex; 3]>,
    report: StretchReport,
}

impl Stretch {
    /// Tiles of this aspect over a field, their longer side along the guides; `side` is their mean side, unit-sized.
    ///
    /// # Errors
    /// Where the aspect makes no sense, no guide chooses a direction, or the backend fails.
    pub fn new(
        surface: &Surface,
        field: &Field,
        guides: &[Guide],
        aspect: f64,
        side: f64,
        backend: &dyn Backend,
    ) -> Result<Self, StretchError> {
        StretchError::of_aspect(aspect)?;
        let sectors = field.sectors();
        let graph = AxisGraph::new(surface, sectors, axes(sectors, field.crosses()));
        let guided = graph.guided(&guides::constraints(surface, sectors, guides).0);
        if guided.iter().all(|&choice| choice == 0.0) {
            return Err(StretchError::NoGuide);
        }
        let choices = graph.choices(&graph.equations(&guided).solve(backend)?);
        let full = aspect.ln() / 2.0;
        let (logs, odd_singularities) = graph.logs(&choices, full, full / (BLEND * side * aspect.sqrt()));

        let of_sectors: Vec<Complex> = (0..sectors.count())
            .map(|sector| {
                let log = f64::from(choices[sector]) * logs[graph.vertex(sector)];
                let (s, c) = (2.0 * graph.axes[sector]).sin_cos();
                [(log * c) as f32, (log * s) as f32]
            })
            .collect();
        let [mut nearly_square, mut unguided, mut area] = [0.0; 3];
        for t in 0..surface.triangle_count() {
            let own = f64::from(surface.double_area(t));
            area += own;
            let corners = [0, 1, 2].map(|k| 3 * t + k);
            if corners.iter().any(|&corner| choices[sectors.of_corner[corner] as usize] == 0.0) {
                unguided += own;
            } else if surface.triangles[t].iter().map(|&v| logs[v as usize]).sum::<f64>() / 3.0 < full / 2.0 {
                nearly_square += own;
            }
        }
        Ok(Self {
            in_triangles: sectors.in_triangles(&of_sectors, 2.0),
            of_sectors,
            report: StretchReport {
                aspect,
                odd_singularities,
                nearly_square: nearly_square / area,
                unguided: unguided / area,
            },
        })
    }

    /// What became of the asked aspect.
    pub fn report(&self) -> &StretchReport {
        &self.report
    }

    /// The logarithm of the side over the mean one, along each sector's axis.
    pub(crate) fn along_axes(&self, axes: &[f64]) -> Vec<f64> {
        let along = |(z, axis): (&Complex, &f64)| {
            let (s, c) = (2.0 * axis).sin_cos();
            f64::from(z[0]) * c + f64::from(z[1]) * s
        };
        self.of_sectors.iter().zip(axes).map(along).collect()
    }

    /// The side over the mean one in a unit direction along a triangle.
    pub(crate) fn factor(&self, surface: &Surface, triangle: u32, position: Vec3, direction: Vec3) -> f32 {
        let corners = surface.corners(triangle as usize);
        let [wb, wc] = barycentric(corners, position);
        let weights = [(1.0 - wb - wc).max(0.0), wb, wc];
        let z = self.in_triangles[triangle as usize];
        let [x, y] = [0, 1].map(|k| (0..3).map(|corner| z[corner][k] * weights[corner]).sum::<f32>());
        let first = unit(corners[1] - corners[0]);
        let normal = triangle_normal(corners);
        let (cosine, sine) = (dot(direction, first), dot(direction, cross(normal, first)));
        (x * (cosine * cosine - sine * sine) + y * (2.0 * cosine * sine)).exp()
    }
}

/// The sectors, and how the choice of an axis passes from one to another.
struct AxisGraph<'a> {
    surface: &'a Surface,
    sectors: &'a Sectors,
    axes: Vec<f64>,
    /// Whether the axes at the two ends of each half-edge are different directions.
    swaps: Vec<bool>,
    /// Pairs of sectors across features, in both orders, sorted, and whether their axes are different directions.
    seams: Vec<(u32, u32, bool)>,
}

impl<'a> AxisGraph<'a> {
    fn new(surface: &'a Surface, sectors: &'a Sectors, axes: Vec<f64>) -> Self {
        let swaps = |h: u32| {
            // A turn of just an eighth must be read alike from both sides.
            let twin = surface.twin(h).filter(|&twin| twin < h && !surface.features().is_feature(h));
            Matching::along(sectors, &axes, twin.unwrap_or(h)).swaps()
        };
        let swaps = (0..3 * surface.triangle_count() as u32).into_par_iter().map(swaps).collect();
        let mut graph = Self { surface, sectors, axes, swaps, seams: Vec::new() };
        // Both ends of each side of each edge on a feature, by the edge's place.
        let mut ends = Vec::new();
        for h in (0..3 * surface.triangle_count() as u32).filter(|&h| surface.features().is_feature(h)) {
            let [from, to] = [surface.origin(h), surface.target(h)].map(|v| surface.same_place(v));
            let far = next(h);
            for (end, corner, angle) in [(from, h, 0.0), (to, far, sectors.corner_angle(far))] {
                let sector = sectors.of_corner[corner as usize];
                let off = (sectors.direction(corner, angle) - graph.axes[sector as usize]) / FRAC_PI_2;
                ends.push(([from.min(to), from.max(to), end], sector, off.round().rem_euclid(2.0) == 1.0));
            }
        }
        ends.sort_unstable();
        for pair in ends.windows(2).filter(|pair| pair[0].0 == pair[1].0 && pair[0].1 != pair[1].1) {
            let [(_, a, across_a), (_, b, across_b)] = [pair[0], pair[1]];
            graph.seams.extend([(a, b, across_a != across_b), (b, a, across_a != across_b)]);
        }
        graph.seams.sort_unstable();
        graph.seams.dedup();
        graph
    }

    fn vertex(&self, sector: usize) -> usize {
        self.surface.origin(self.sectors.first_corner[sector]) as usize
    }

    /// Visits the neighbours of a sector, each with whether the choice is swapped between the two, and with the link's weight.
    /// A neighbour along several half-edges is visited as often.
    fn visit_neighbours(&self, sector: u32, mut visit: impl FnMut(u32, bool, f64)) {
        let Self { surface, sectors, .. } = self;
        for corner in sectors.corners(surface, sector) {
            for (h, end) in [(corner, next(corner)), (previous(corner), previous(corner))] {
                visit(sectors.of_corner[end as usize], self.swaps[h as usize], sectors.edge_weight(h));
            }
        }
        let start = self.seams.partition_point(|seam| seam.0 < sector);
        let seams = self.seams[start..].iter().take_while(|seam| seam.0 == sector);
        seams.for_each(|&(_, other, swaps)| visit(other, swaps, 1.0));
    }

    /// The guides' choice in each sector: 1 its axis, -1 the direction across, 0 none.
    fn guided(&self, directions: &[DirectionConstraint]) -> Vec<f32> {
        let mut sums = vec![0.0; self.axes.len()];
        for direction in directions {
            sums[direction.sector as usize] += (2.0 * (direction.angle - self.axes[direction.sector as usize])).cos();
        }
        sums.iter().map(|sum: &f64| if sum.abs() < LEAST_AGREEMENT { 0.0 } else { sum.signum() as f32 }).collect()
    }

    /// The equations whose solution's signs are the choices; `guided` ones are fixed.
    fn equations(&self, guided: &[f32]) -> Hierarchy {
        let right_hand_side = guided.iter().map(|&choice| [choice, 0.0]).collect();
        let problem = Problem::new(right_hand_side, |s, links| {
            let own = links.len();
            self.visit_neighbours(s as u32, |neighbour, swaps, weight| {
                let weight = (if swaps { -weight } else { weight }) as f32;
                match links[own..].iter_mut().find(|link| link.neighbour == neighbour) {
                    Some(link) => link.weight[0] += weight,
                    None => links.push(Link { neighbour, weight: [weight, 0.0] }),
                }
            });
            Terms { fixed: guided[s] != 0.0, ..Terms::default() }
        });
        Hierarchy::linear(problem, ITERATIONS)
    }

    /// The signs of values; negligible values take their neighbours' choices. 0 in parts without any.
    fn choices(&self, values: &[Complex]) -> Vec<f32> {
        let sign = |&[x, _]: &Complex| if x.abs() < NEGLIGIBLE { 0.0 } else { x.signum() };
        let mut choices: Vec<f32> = values.iter().map(sign).collect();
        let mut reached: VecDeque<u32> = (0..).zip(&choices).filter(|(_, x)| **x != 0.0).map(|(s, _)| s).collect();
        while let Some(sector) = reached.pop_front() {
            let choice = choices[sector as usize];
            self.visit_neighbours(sector, |other, swaps, _| {
                if choices[other as usize] == 0.0 {
                    choices[other as usize] = if swaps { -choice } else { choice };
                    reached.push_back(other);
                }
            });
        }
        choices
    }

    /// The logarithm of the longer side over the mean one at each vertex: `full`, but zero on cuts and growing from there by
    /// `slope` at most. Also the number of points at which cuts must end.
    fn logs(&self, choices: &[f32], full: f64, slope: f64) -> (Vec<f64>, usize) {
        let mut logs = vec![full; self.surface.vertex_count()];
        for sector in 0..choices.len() as u32 {
            self.visit_neighbours(sector, |other, swaps, _| {
                let product = choices[sector as usize] * choices[other as usize];
                if (if swaps { -product } else { product }) <= 0.0 {
                    [sector, other].iter().for_each(|&end| logs[self.vertex(end as usize)] = 0.0);
                }
            });
        }
        if logs.contains(&0.0) {
            Growth::new(self.surface).limit(&mut logs, slope);
        }
        let odd = |swaps: &&[bool]| swaps.iter().filter(|&&swaps| swaps).count() % 2 == 1;
        (logs, self.swaps.chunks(3).filter(odd).count() + self.odd_corners())
    }

    /// The corners of features with an odd number of quarter turns, each sheet that meets there apart.
    fn odd_corners(&self) -> usize {
        let is_odd = |v: u32| {
            let own = self.sectors.of_vertex(v);
            let open = own
                .iter()
                .flat_map(|&sector| self.sectors.corners(self.surface, sector))
                .any(|corner| self.surface.twin(corner).is_none() || self.surface.twin(previous(corner)).is_none());
            let quarters: u32 = own.iter().map(|&sector| u32::from(self.sectors.quarters[sector as usize])).sum();
            !open && quarters % 2 == 1
        };
        self.surface.features().corners().filter(|&v| is_odd(v)).count()
    }
}
