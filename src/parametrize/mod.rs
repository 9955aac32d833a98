//! The parametrization: two coordinates over the surface whose integers are the rows of tiles.
//!
//! # Theory
//! After Ray, Li, Lévy, Sheffer and Alliez 2006 (*Periodic global parameterization*). At each sector of the surface's vertices
//! two unit complex numbers, the phases `exp(2 pi i u)` and `exp(2 pi i v)`, hold the coordinates along the cross's two axes, in
//! tile sides. A [`Transition`] reads a neighbour's phases: a quarter turn of the matching swaps the two and mirrors one, and
//! the wanted difference of the coordinates shifts them. Each phase is an unknown, and a link between two of them is a
//! rotation or a reflection, so that the solver of the cross field solves for phases too, with normalised sweeps.
//!
//! Afterwards the phases have integer jumps, and rows end where the jumps around a triangle do not add up to zero. Ends of
//! rows are cancelled by pairs; then the coordinates are solved for again by least squares, with the jumps fixed (Bommer,
//! Zimmer and Kobbelt 2009, *Mixed-integer quadrangulation*). Rows that pass over the whole surface have no ends; where
//! creases are too near each other for that, constraints are released, and inverted triangles are stiffened.
//!
//! # Changes versus the paper
//! The paper's forerunner relaxes random tiles, which order only locally.
//!
//! # Practice
//! On a feature the phase across it is fixed, so that a row lies on it, and the phase along it is one unknown for all of its
//! sides. At corners both are fixed. Continuous rows run on past the ends of creases; rows that may end do not.
//!
//! Variants that were measured: docs/experiments.md, parametrization.

mod cones;
mod distortion;
mod equations;
mod grid_metric;
pub mod integer_grid;
pub mod integrable_sizes;
mod release;
mod row_ends;
mod stiffening;
mod transitions;

pub use cones::Cone;
pub use distortion::Distortion;
pub use grid_metric::GridMetric;
pub(crate) use grid_metric::PlacedCone;
pub use row_ends::RowEnds;
pub use transitions::Transition;
use transitions::turning;

use crate::compute::{Backend, Complex, ComputeError, MIRRORED};
use crate::field::{Field, Sectors};
use crate::sizes::Intervals;
use crate::surface::{Surface, next};
use equations::Graph;
use rustc_hash::FxHashSet;
use std::f64::consts::TAU;

/// Whether rows of tiles may end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Rows {
    /// They end where tiles of the wanted sides need it.
    #[default]
    Paper,
    /// They pass over the whole surface but for singularities of the field, and sides adapt.
    Continuous,
}

/// The factor of the weight beside curves with an asked number of tiles.
const FIRMNESS: f64 = 20.0;
/// An image whose smaller singular value is below this is nearly inverted.
const NEARLY_INVERTED: f64 = 0.1;

/// Two coordinates at all sectors, in tile sides.
#[derive(Clone, Debug)]
pub struct Parametrization<'a> {
    field: &'a Field,
    /// Along each half-edge.
    transitions: Vec<Transition>,
    /// The two coordinates of each sector, up to integers.
    coordinates: Vec<[f64; 2]>,
    /// What is added to the difference of the coordinates along each half-edge, in the frame of the sector where it begins.
    jumps: Vec<[i32; 2]>,
    unknowns: Vec<Unknowns>,
    /// The curves that an asked number of rows meets.
    intervals: Vec<Intervals>,
    /// Whether each unknown is fixed.
    fixed: Vec<bool>,
    /// Ends of features that hold no tile: rows run on past them.
    pub(crate) released_ends: FxHashSet<u32>,
    /// Vertices of creases that rows do not lie on.
    pub(crate) released_vertices: FxHashSet<u32>,
    /// The factor of each triangle's weight where the coordinates are solved for again; empty: 1.
    stiffness: Vec<f64>,
}

/// An unknown of the linear problems, as a sector reads it: itself or mirrored, with the bit [`MIRRORED`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Unknown(u32);

impl Unknown {
    fn index(self) -> usize {
        (self.0 & !MIRRORED) as usize
    }

    fn is_mirrored(self) -> bool {
        self.0 & MIRRORED != 0
    }

    /// The same unknown, read the other way.
    fn mirrored(self) -> Self {
        Self(self.0 ^ MIRRORED)
    }

    /// A real value, negated where the unknown is mirrored.
    fn signed(self, value: f64) -> f64 {
        if self.is_mirrored() { -value } else { value }
    }
}

/// The unknowns that stand for the phases along a sector's axis, and across it.
type Unknowns = [Unknown; 2];

/// The unknown that a sector reads in the direction of `k` quarter turns from its axis.
fn along(unknowns: Unknowns, k: u32) -> Unknown {
    let unknown = unknowns[(k % 2) as usize];
    if k % 4 >= 2 { unknown.mirrored() } else { unknown }
}

impl<'a> Parametrization<'a> {
    /// Rows of tiles whose mean side at each vertex is `side`, in unit-sized coordinates; the field may stretch them. As many as are
    /// asked for meet the curves of `intervals`.
    ///
    /// # Errors
    /// Where the backend fails.
    pub fn solve(
        surface: &Surface,
        field: &'a Field,
        side: impl Fn(u32) -> f64 + Sync,
        intervals: &[Intervals],
        rows: Rows,
        backend: &dyn Backend,
    ) -> Result<Self, ComputeError> {
        let mut transitions = transitions::transitions(surface, field, side);
        let stiffness = fit_intervals(surface, intervals, &mut transitions);
        backend.check()?;
        let released_ends = match rows {
            Rows::Paper => FxHashSet::default(),
            Rows::Continuous => releasable_ends(surface, field.sectors()),
        };
        let released_vertices = FxHashSet::default();
        let (unknowns, fixed) = equations::unknowns(surface, field.sectors(), &released_ends, &released_vertices);
        let sectors = field.sectors();
        let graph = Graph {
            surface,
            sectors,
            transitions: &transitions,
            unknowns: &unknowns,
            fixed: &fixed,
            stiffness: &stiffness,
        };
        let values = equations::equations(&graph)?.solve(backend)?;
        let coordinates = unknowns.iter().map(|pair| pair.map(|unknown| turns(&values, unknown))).collect();
        let mut parametrization = Self {
            field,
            transitions,
            coordinates,
            jumps: Vec::new(),
            unknowns,
            intervals: intervals.to_vec(),
            fixed,
            released_ends,
            released_vertices,
            stiffness,
        };
        parametrization.jumps = parametrization.nearest_jumps(surface);
        Ok(parametrization)
    }

    /// Cancels the ends of rows by pairs and solves for the coordinates again.
    ///
    /// Continuous rows keep no end: they pass over the whole surface but for singularities of the field, and their distances
    /// adapt. Of the paper's rows those ends are cancelled that lie near each other; `finer` times as many rows are made of
    /// them later.
    ///
    /// # Errors
    /// Where the backend fails.
    pub fn resolve_row_ends(
        &mut self,
        surface: &Surface,
        rows: Rows,
        finer: u32,
        backend: &dyn Backend,
    ) -> Result<RowEnds, ComputeError> {
        let ends = self.cancel_row_ends(surface, rows, finer, backend)?;
        match rows {
            Rows::Paper => self.solve_offsets(surface, &[], backend)?,
            Rows::Continuous => {
                self.solve_offsets(surface, &self.cones(surface), backend)?;
                self.release(surface, backend)?;
                self.stiffen_inverted(surface, backend)?;
            }
        }
        Ok(ends)
    }

    fn cones(&self, surface: &Surface) -> Vec<Cone> {
        (0..surface.triangle_count() as u32).filter_map(|t| self.cone(t)).collect()
    }

    /// Solves for the coordinates again, with the same jumps.
    fn solve_offsets(&mut self, surface: &Surface, cones: &[Cone], backend: &dyn Backend) -> Result<(), ComputeError> {
        backend.check()?;
        let values = equations::offsets(surface, self, cones).solve(backend)?;
        for (coordinates, pair) in self.coordinates.iter_mut().zip(&self.unknowns) {
            for k in 0..2 {
                coordinates[k] += pair[k].signed(f64::from(values[pair[k].index()][1]));
            }
        }
        Ok(())
    }

    /// Puts so many rows in the place of each.
    pub fn multiply(&mut self, by: u32) {
        self.coordinates.iter_mut().flatten().for_each(|coordinate| *coordinate *= f64::from(by));
        self.jumps.iter_mut().flatten().for_each(|jump| *jump *= by as i32);
        self.transitions
            .iter_mut()
            .flat_map(|transition| &mut transition.wanted)
            .for_each(|side| *side *= f64::from(by));
    }

    fn graph<'g>(&'g self, surface: &'g Surface) -> Graph<'g> {
        let Self { transitions, unknowns, fixed, stiffness, .. } = self;
        Graph { surface, sectors: self.field.sectors(), transitions, unknowns, fixed, stiffness }
    }

    /// The jumps that make the steps nearest to the wanted ones.
    fn nearest_jumps(&self, surface: &Surface) -> Vec<[i32; 2]> {
        let own = |h: u32| {
            let transition = &self.transitions[h as usize];
            let [here, there] = [self.at(h), transition.back(self.at(next(h)))];
            [0, 1].map(|k| -(there[k] - here[k] - transition.wanted[k]).round() as i32)
        };
        // Both sides of an edge must fall on the same side of a half.
        let jump = |h: u32| match surface.twin(h) {
            Some(twin) if twin < h && !surface.features().is_feature(h) => {
                self.transitions[twin as usize].forward(own(twin).map(f64::from)).map(|x| -x as i32)
            }
            _ => own(h),
        };
        (0..self.transitions.len() as u32).map(jump).collect()
    }

    /// The coordinates at the sector of a corner, up to integers.
    pub fn at(&self, corner: u32) -> [f64; 2] {
        self.coordinates[self.sector(corner)]
    }

    /// The difference of the coordinates along a half-edge, in the frame of the sector where it begins.
    pub fn step(&self, half_edge: u32) -> [f64; 2] {
        let [here, there] = [self.at(half_edge), self.transitions[half_edge as usize].back(self.at(next(half_edge)))];
        let jump = self.jumps[half_edge as usize];
        [0, 1].map(|k| there[k] - here[k] + f64::from(jump[k]))
    }

    /// As [`Parametrization::step`], in the frame of the sector at the half-edge's end.
    pub fn step_at_end(&self, half_edge: u32) -> [f64; 2] {
        self.transitions[half_edge as usize].forward(self.step(half_edge))
    }

    /// The coordinate along a half-edge on a feature where it begins, up to integers, and its difference along the half-edge.
    pub fn along(&self, half_edge: u32) -> [f64; 2] {
        let [x, y] = self.transitions[half_edge as usize].wanted;
        let (k, sign) = if x.abs() >= y.abs() { (0, x.signum()) } else { (1, y.signum()) };
        [self.at(half_edge)[k], self.step(half_edge)[k]].map(|value| sign * value)
    }

    fn sector(&self, corner: u32) -> usize {
        self.field.sectors().of_corner[corner as usize] as usize
    }
}

/// Scales the wanted steps along curves so that they add up to the asked numbers of tiles; the factor of each triangle's weight,
/// or nothing where all have the same.
fn fit_intervals(surface: &Surface, intervals: &[Intervals], transitions: &mut [Transition]) -> Vec<f64> {
    let mut stiffness = if intervals.is_empty() { Vec::new() } else { vec![1.0; surface.triangle_count()] };
    for &Intervals { curve, count } in intervals {
        let half_edges = &surface.features().curves()[curve].half_edges;
        let length = |h: u32| {
            let [x, y] = transitions[h as usize].wanted;
            x.hypot(y)
        };
        let factor = count as f64 / half_edges.iter().map(|&h| length(h)).sum::<f64>();
        for side in half_edges.iter().flat_map(|&h| [Some(h), surface.twin(h)]).flatten() {
            transitions[side as usize].wanted = transitions[side as usize].wanted.map(|step| factor * step);
            stiffness[side as usize / 3] = FIRMNESS;
        }
    }
    stiffness
}

/// The angle of an unknown's value, in turns.
fn turns(values: &[Complex], unknown: Unknown) -> f64 {
    let [x, y] = values[unknown.index()].map(f64::from);
    unknown.signed(y.atan2(x) / TAU)
}

/// The ends of creases within the surface that no singularity of the field sits on.
fn releasable_ends(surface: &Surface, sectors: &Sectors) -> FxHashSet<u32> {
    let features = surface.features();
    let mut shared = FxHashSet::default();
    for v in (0..surface.vertex_count() as u32).filter(|&v| surface.same_place(v) != v) {
        shared.extend([v, surface.same_place(v)]);
    }
    let is_releasable = |&v: &u32| {
        let [sector] = *sectors.of_vertex(v) else { return false };
        let first = sectors.first_corner[sector as usize];
        sectors.quarters[sector as usize] == 4
            && surface.twin(first).is_some()
            && features.is_feature(first)
            && !shared.contains(&v)
    };
    features.corners().filter(is_releasable).collect()
}
