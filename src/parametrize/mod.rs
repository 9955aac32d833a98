//! The periodic solve: rows of tiles that are in step over the whole surface, before there is a tile.
//!
//! # Theory
//! After Ray, Li, Lévy, Sheffer and Alliez 2006 (*Periodic global parameterization*). Where the two families of rows lie
//! is held by two unit complex numbers at each sector of the surface's vertices, the phases `exp(2 pi i u)` and
//! `exp(2 pi i v)` of the coordinates along the cross's two axes, in tile sides. A neighbour is read through the matching
//! of the crosses, a quarter turn of which swaps the two and mirrors one, and a shift, the way to it in tile sides
//! ([`Transition`]). So each phase at each sector is an unknown, and a link between two of them is a turn or a mirrored turn:
//! the field's kind of equations, smoothed from coarse levels to fine ones by the field's kernels, normalised after
//! every sweep.
//!
//! # Changes versus the paper
//! The paper's forerunner relaxes random tiles, which order only locally. The share of faces that are no quads before any
//! clean-up, in percent at 6,000 points (random tiles on a coarse level, relaxed, split into three by three / periodic):
//! m6_gen 2.4 / 1.7, fish_blub 5.8 / 4.0, spot 5.4 / 4.1, fandisk 4.2 / 2.4. Mean Qg rose by 0.02 to 0.03.
//!
//! # Practice
//! On a feature the phase across it is fixed, so that a row lies on it, and the phase along it is one unknown for all of its
//! sides. At corners both are fixed.
//!
//! Sweeps a level: 10, 20, 60, 200 gave fish_blub 4.2, 3.9, 4.0, 4.2 and spot 4.3, 4.2, 4.0, 3.9 % odd faces; 1,000
//! sweeps on the first level in place of 200 changed nothing. Edges of at most 0.45, 0.7 and 1 tile sides gave fish_blub
//! 4.0, 3.9, 4.5 and spot 4.0, 4.2, 4.3.
//!
//! Each end of a row of equal tiles becomes an odd face. Those near each other are led to each other ([`Parametrization::close`]);
//! sides give way a little. By what that may cost, odd faces before any clean-up in percent and the mean Qg of the mesh:
//!
//! | cost | fish_blub | spot | fandisk | m6_gen |
//! |---|---|---|---|---|
//! | 0 | 4.3, 0.943 | 4.1, 0.937 | 2.4, 0.957 | 1.6, 0.969 |
//! | 12 | 3.2, 0.945 | 3.2, 0.939 | 2.1, 0.957 | 1.5, 0.969 |
//! | 18 | 2.8, 0.945 | 3.1, 0.935 | 2.1, 0.958 | 1.5, 0.969 |
//! | 25 | 2.5, 0.941 | 2.6, 0.931 | 2.1, 0.955 | 1.4, 0.967 |
//! | 40 | 2.4, 0.934 | 2.2, 0.926 | 1.7, 0.951 | 1.4, 0.965 |
//!
//! Rows that pass over the whole surface ([`Rows::Continuous`]) leave no row end, but whole numbers may contradict each other:
//! creases less than a tile apart, and creases shorter than one. There rows run on past the ends of creases, one of two
//! creases lets its row go, and folded triangles weigh more. At 6,000 points, `--fit 1 --quads all`, irregular
//! vertices in percent, and those that the singularities demand:
//!
//! | | m6_gen | fish_blub | fandisk | anchor | spot | holes_cgal |
//! |---|---|---|---|---|---|---|
//! | without all this | 0.20 | 1.66 | 1.04 | 2.78 | 1.45 | 0.58 |
//! | with it | 0.05 | 0.56 | 0.83 | 2.83 | 0.91 | 0.40 |
//! | demanded | 0.05 | 0.56 | 0.57 | 0.82 | 0.99 | 0.50 |
//!
//! Tried: moving row ends once more where the strain of the solved coordinates says so (negative cycles over the triangles)
//! lowered the strain by 1 % and no count; pulling the field along features for one and a half tiles, so that no
//! singularity lies nearer than a tile to one, made more irregular vertices on most models. Whole numbers swing with any
//! setting: over all variants tried fandisk had 0.63 to 1.0 % and anchor 2.0 to 4.1 %.
//!
//! Of the paper's rows, where creases run out within the surface the end holds a tile. Letting rows run on past it instead, with the last tile at
//! the nearest whole number, gave fish_blub and spot 0.1 to 0.3 % fewer odd faces, and features missed by 0.27 and 0.42
//! tiles (0.10 and 0.30 with tiles there). Creases left out of the solve's first levels gained nothing.

mod cones;
mod equations;
mod grid_metric;
pub mod integer_grid;
pub mod integrable_sizes;
mod release;
mod row_ends;
mod stiffening;
mod transitions;

pub use cones::Cone;
pub use grid_metric::GridMetric;
pub(crate) use grid_metric::PlacedCone;
pub use row_ends::RowEnds;
pub use transitions::Transition;
use transitions::turning;

use crate::compute::{Backend, Complex, ComputeError, MIRRORED};
use crate::field::{Field, Sectors};
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
    /// They pass over the whole surface but for singularities of the field, and sides give way.
    Continuous,
}

/// An image whose least stretch is below this is nearly turned over.
const NEARLY_FOLDED: f64 = 0.1;

/// The phases of the rows at all sectors.
#[derive(Clone, Debug)]
pub struct Parametrization<'a> {
    field: &'a Field,
    ways: Vec<Transition>,
    /// The two coordinates of each sector, up to whole numbers.
    places: Vec<[f64; 2]>,
    /// By how much more than the two places say the coordinates grow along each half-edge, at the sector that it leaves.
    jumps: Vec<[i32; 2]>,
    unknowns: Vec<Unknowns>,
    /// Whether each unknown is fixed.
    fixed: Vec<bool>,
    /// Ends of features that need hold no tile: rows run on past them.
    pub(crate) loose: FxHashSet<u32>,
    /// Vertices of creases that rows no longer lie on.
    pub(crate) trimmed: FxHashSet<u32>,
    /// How many times its own weight each triangle has where the coordinates are solved for again; empty: once.
    stiffness: Vec<f64>,
}

/// The unknown that stands for the phase along a sector's axis, and across it; mirrored or not.
type Unknowns = [u32; 2];

/// What a sector reads in the direction of `k` quarter turns from its axis.
fn along(unknowns: Unknowns, k: u32) -> u32 {
    unknowns[(k % 2) as usize] ^ if k % 4 >= 2 { MIRRORED } else { 0 }
}

impl<'a> Parametrization<'a> {
    /// Rows of tiles whose mean side at each vertex is `side`, in unit-sized coordinates; the field may stretch them.
    ///
    /// # Errors
    /// Where the backend fails.
    pub fn solve(
        surface: &Surface,
        field: &'a Field,
        side: impl Fn(u32) -> f64 + Sync,
        rows: Rows,
        backend: &dyn Backend,
    ) -> Result<Self, ComputeError> {
        let ways = transitions::transitions(surface, field, side);
        let loose = match rows {
            Rows::Paper => FxHashSet::default(),
            Rows::Continuous => loose_ends(surface, field.sectors()),
        };
        let trimmed = FxHashSet::default();
        let (unknowns, fixed) = equations::unknowns(surface, field.sectors(), &loose, &trimmed);
        let (sectors, stiffness) = (field.sectors(), Vec::new());
        let graph = Graph { surface, sectors, ways: &ways, unknowns: &unknowns, fixed: &fixed, stiffness: &stiffness };
        let values = equations::equations(&graph)?.solve(backend)?;
        let places = unknowns.iter().map(|pair| pair.map(|unknown| turns(&values, unknown))).collect();
        let mut phases = Self { field, ways, places, jumps: Vec::new(), unknowns, fixed, loose, trimmed, stiffness };
        phases.jumps = phases.nearest_jumps(surface);
        Ok(phases)
    }

    /// Leads the ends of rows to where they cancel and solves for the coordinates again.
    ///
    /// Of continuous rows none is left to end: they pass over the whole surface but for singularities of the field, and
    /// their distances give way. Of the paper's rows those ends go that lie near each other; `finer` times as many rows
    /// are made of them later.
    ///
    /// # Errors
    /// Where the backend fails.
    pub fn close(
        &mut self,
        surface: &Surface,
        rows: Rows,
        finer: u32,
        backend: &dyn Backend,
    ) -> Result<RowEnds, ComputeError> {
        let ends = self.cancel_row_ends(surface, rows, finer);
        match rows {
            Rows::Paper => self.settle(surface, &[], backend)?,
            Rows::Continuous => {
                self.settle(surface, &self.cones(surface), backend)?;
                self.trim(surface, backend)?;
                self.unfold(surface, backend)?;
            }
        }
        Ok(ends)
    }

    fn cones(&self, surface: &Surface) -> Vec<Cone> {
        (0..surface.triangle_count() as u32).filter_map(|t| self.cone(t)).collect()
    }

    /// Solves for the coordinates again, the jumps being kept.
    fn settle(&mut self, surface: &Surface, cones: &[Cone], backend: &dyn Backend) -> Result<(), ComputeError> {
        let values = equations::offsets(surface, self, cones).solve(backend)?;
        for (place, pair) in self.places.iter_mut().zip(&self.unknowns) {
            for k in 0..2 {
                let offset = f64::from(values[(pair[k] & !MIRRORED) as usize][1]);
                place[k] += if pair[k] & MIRRORED != 0 { -offset } else { offset };
            }
        }
        Ok(())
    }

    /// Puts so many rows in place of each.
    pub fn multiply(&mut self, by: u32) {
        self.places.iter_mut().flatten().for_each(|place| *place *= f64::from(by));
        self.jumps.iter_mut().flatten().for_each(|jump| *jump *= by as i32);
        self.ways.iter_mut().flat_map(|way| &mut way.by).for_each(|side| *side *= f64::from(by));
    }

    fn graph<'g>(&'g self, surface: &'g Surface) -> Graph<'g> {
        let Self { ways, unknowns, fixed, stiffness, .. } = self;
        Graph { surface, sectors: self.field.sectors(), ways, unknowns, fixed, stiffness }
    }

    /// The jumps that make steps most like the ways.
    fn nearest_jumps(&self, surface: &Surface) -> Vec<[i32; 2]> {
        let own = |h: u32| {
            let way = &self.ways[h as usize];
            let [here, there] = [self.at(h), way.back(self.at(next(h)))];
            [0, 1].map(|k| -(there[k] - here[k] - way.by[k]).round() as i32)
        };
        // Both sides of an edge must fall on the same side of a half.
        let jump = |h: u32| match surface.twin(h) {
            Some(twin) if twin < h && !surface.features().is_feature(h) => {
                self.ways[twin as usize].forth(own(twin).map(f64::from)).map(|x| -x as i32)
            }
            _ => own(h),
        };
        (0..self.ways.len() as u32).map(jump).collect()
    }

    /// The coordinates at the sector of a corner, up to whole numbers.
    pub fn at(&self, corner: u32) -> [f64; 2] {
        self.places[self.sector(corner)]
    }

    /// By how much the coordinates grow along a half-edge, in the frame of the sector that it leaves.
    pub fn step(&self, half_edge: u32) -> [f64; 2] {
        let [here, there] = [self.at(half_edge), self.ways[half_edge as usize].back(self.at(next(half_edge)))];
        let jump = self.jumps[half_edge as usize];
        [0, 1].map(|k| there[k] - here[k] + f64::from(jump[k]))
    }

    /// As [`Parametrization::step`], in the frame of the sector at the half-edge's end.
    pub fn step_at_end(&self, half_edge: u32) -> [f64; 2] {
        self.ways[half_edge as usize].forth(self.step(half_edge))
    }

    /// The coordinate in the direction of a half-edge on a feature where it begins, up to whole numbers, and its growth.
    pub fn along(&self, half_edge: u32) -> [f64; 2] {
        let [x, y] = self.ways[half_edge as usize].by;
        let (k, sign) = if x.abs() >= y.abs() { (0, x.signum()) } else { (1, y.signum()) };
        [self.at(half_edge)[k], self.step(half_edge)[k]].map(|value| sign * value)
    }

    fn sector(&self, corner: u32) -> usize {
        self.field.sectors().of_corner[corner as usize] as usize
    }
}

/// The angle of an unknown's value, in turns.
fn turns(values: &[Complex], unknown: u32) -> f64 {
    let [x, y] = values[(unknown & !MIRRORED) as usize].map(f64::from);
    let turns = y.atan2(x) / TAU;
    if unknown & MIRRORED != 0 { -turns } else { turns }
}

/// The ends of creases within the surface that no singularity of the field sits on.
fn loose_ends(surface: &Surface, sectors: &Sectors) -> FxHashSet<u32> {
    let features = surface.features();
    let mut shared = FxHashSet::default();
    for v in (0..surface.vertex_count() as u32).filter(|&v| surface.same_place(v) != v) {
        shared.extend([v, surface.same_place(v)]);
    }
    let is_loose = |&v: &u32| {
        let [sector] = *sectors.of_vertex(v) else { return false };
        let first = sectors.first_corner[sector as usize];
        sectors.quarters[sector as usize] == 4
            && surface.twin(first).is_some()
            && features.is_feature(first)
            && !shared.contains(&v)
    };
    features.corners().filter(is_loose).collect()
}
