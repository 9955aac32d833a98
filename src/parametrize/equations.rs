//! The linear problems of the parametrization: the phases, and the offsets of the coordinates.

use super::{Cone, Parametrization, Transition, Unknown, Unknowns, along};
use crate::compute::{Complex, ComputeError, Link, add, conjugate};
use crate::field::Sectors;
use crate::solver::{Hierarchy, Problem, Terms};
use crate::surface::{Surface, next, previous};
use rayon::prelude::*;
use rustc_hash::{FxHashMap, FxHashSet};
use std::f64::consts::TAU;

/// The weight of the constraints that draw the corners of a triangle to its cone; an edge's weight is about 0.6.
const CONE_WEIGHT: f64 = 2.0;
/// Normalised sweeps on each level.
const SWEEPS: u32 = 20;
/// Iterations of conjugate gradients on each level for the offsets. (docs/experiments.md, parametrization)
const OFFSET_ITERATIONS: u32 = 2;

/// The links between the unknowns.
pub struct Graph<'a> {
    pub surface: &'a Surface,
    pub sectors: &'a Sectors,
    pub transitions: &'a [Transition],
    pub unknowns: &'a [Unknowns],
    pub fixed: &'a [bool],
    /// The factor of each triangle's weight; empty: 1.
    pub stiffness: &'a [f64],
}

/// The equations of the phases.
///
/// # Errors
/// Where the initial solution fails.
pub fn equations(graph: &Graph) -> Result<Hierarchy, ComputeError> {
    let right_hand_side = graph.fixed.iter().map(|&fixed| [f32::from(fixed), 0.0]).collect();
    let free = vec![0.0; graph.fixed.len()];
    // Two rows read each.
    let turns = graph
        .transitions
        .par_iter()
        .with_min_len(512)
        .map(|transition| transition.wanted.map(|wanted| (TAU * wanted).sin_cos()));
    let turns: Vec<[(f64, f64); 2]> = turns.collect();
    Hierarchy::units(graph.problem(|h, k| turns[h][k], right_hand_side, &free), SWEEPS)
}

/// The equations of the offsets of the coordinates, after which the steps are the wanted ones in the sense of least squares.
/// Offsets are real and held as imaginary numbers, which are negated when they are mirrored. `cones` are drawn to the middles
/// of their triangles.
pub fn offsets(surface: &Surface, parametrization: &Parametrization, cones: &[Cone]) -> Hierarchy {
    let graph = parametrization.graph(surface);
    let Graph { sectors, unknowns, .. } = graph;
    let mut right_hand_side = vec![[0.0, 0.0]; parametrization.fixed.len()];
    let mut add_to = |unknown: Unknown, value: f64| {
        let sum: &mut Complex = &mut right_hand_side[unknown.index()];
        sum[1] += unknown.signed(value) as f32;
    };
    for h in 0..parametrization.transitions.len() as u32 {
        let transition = parametrization.transitions[h as usize];
        let step = parametrization.step(h);
        let [from, to] = [h, next(h)].map(|corner| sectors.of_corner[corner as usize] as usize);
        for k in 0..2 {
            let off = graph.weight(h) * (step[k as usize] - transition.wanted[k as usize]);
            add_to(along(unknowns[from], k), off);
            add_to(along(unknowns[to], k + transition.quarters), -off);
        }
    }
    let mut held = vec![0.0; parametrization.fixed.len()];
    for cone in cones {
        let weight = CONE_WEIGHT * parametrization.stiffness.get(cone.triangle as usize).unwrap_or(&1.0);
        for (k, offset) in (0..3).zip(parametrization.cone_offsets(cone)) {
            let sector = sectors.of_corner[(3 * cone.triangle + k) as usize] as usize;
            for (unknown, off) in unknowns[sector].into_iter().zip(offset) {
                add_to(unknown, weight * off);
                held[unknown.index()] += weight as f32;
            }
        }
    }
    for (value, _) in right_hand_side.iter_mut().zip(&parametrization.fixed).filter(|&(_, &fixed)| fixed) {
        *value = [0.0, 0.0];
    }
    Hierarchy::linear(graph.problem(|_, _| (0.0, 1.0), right_hand_side, &held), OFFSET_ITERATIONS)
}

/// The two unknowns of each sector, and which unknowns are fixed.
///
/// On a feature the phase across it is fixed, and the phase along it is shared by all sectors at the place. At corners both
/// are fixed, except at `released_ends`. At `released_vertices` neither is.
pub fn unknowns(
    surface: &Surface,
    sectors: &Sectors,
    released_ends: &FxHashSet<u32>,
    released_vertices: &FxHashSet<u32>,
) -> (Vec<Unknowns>, Vec<bool>) {
    let mut fixed = Vec::with_capacity(2 * sectors.count());
    // The shared unknown at a place on a feature, and the vertex that it grows towards.
    let mut shared: FxHashMap<u32, [u32; 2]> = FxHashMap::default();
    let unknowns = (0..sectors.count()).map(|sector| {
        let first = sectors.first_corner[sector];
        let vertex = surface.origin(first);
        let is_corner = sectors.is_corner(surface, vertex) && !released_ends.contains(&vertex);
        let own = fixed.len() as u32;
        if is_corner || sectors.quarters[sector] == 0 {
            fixed.extend([is_corner; 2]);
            return [own, own + 1].map(Unknown);
        }
        let toward = surface.same_place(surface.target(first));
        let is_released = released_vertices.contains(&vertex);
        if !is_released {
            fixed.push(true);
        }
        let [along, end] = *shared.entry(surface.same_place(vertex)).or_insert_with(|| {
            let along = fixed.len() as u32;
            fixed.extend(if is_released { &[false; 2][..] } else { &[false] });
            [along, toward]
        });
        let read = |unknown: u32| if end == toward { Unknown(unknown) } else { Unknown(unknown).mirrored() };
        [read(along), if is_released { read(along + 1) } else { Unknown(own) }]
    });
    (unknowns.collect(), fixed)
}

/// The sectors that read each unknown, with the quarter turns from their axes, one after the other, and where those of each
/// unknown start.
fn readers(unknowns: &[Unknowns], count: usize) -> (Vec<u32>, Vec<[u32; 2]>) {
    let all = || (0..).zip(unknowns).flat_map(|(s, pair)| [0, 1].map(|k| (pair[k as usize], [s, k])));
    let mut starts = vec![0u32; count + 1];
    all().for_each(|(unknown, _)| starts[unknown.index() + 1] += 1);
    for i in 0..count {
        starts[i + 1] += starts[i];
    }
    let mut place = starts.clone();
    let mut readers = vec![[0; 2]; 2 * unknowns.len()];
    for (unknown, reader) in all() {
        let place = &mut place[unknown.index()];
        readers[*place as usize] = reader;
        *place += 1;
    }
    (starts, readers)
}

impl Graph<'_> {
    fn weight(&self, half_edge: u32) -> f64 {
        self.sectors.edge_weight(half_edge) * self.stiffness.get(half_edge as usize / 3).unwrap_or(&1.0)
    }

    /// Links each unknown along all half-edges. `turn` is the sine and cosine of the angle of a half-edge's link in a direction,
    /// `held` the weight of each unknown's constraint.
    fn problem(
        &self,
        turn: impl Fn(usize, usize) -> (f64, f64) + Sync,
        right_hand_side: Vec<Complex>,
        held: &[f32],
    ) -> Problem {
        let &Self { surface, sectors, transitions, unknowns, fixed, .. } = self;

        let (reader_starts, readers) = readers(unknowns, fixed.len());
        // From direction `k` of the sector where a half-edge begins to the unknown at its end.
        let link = |h: u32, k: u32, end: Unknowns| {
            let transition = transitions[h as usize];
            let (s, c) = turn(h as usize, k as usize);
            let w = self.weight(h);
            Link { neighbour: along(end, k + transition.quarters).0, weight: [(w * c) as f32, (-w * s) as f32] }
        };
        let sector_of = |corner: u32| sectors.of_corner[corner as usize] as usize;
        Problem::new(right_hand_side, |i, links| {
            let own = links.len();
            let mut push = |unknown: Unknown, link: Link| {
                // Read as the unknown itself, not as the sector reads it.
                let link = if unknown.is_mirrored() {
                    Link { neighbour: Unknown(link.neighbour).mirrored().0, weight: conjugate(link.weight) }
                } else {
                    link
                };
                if link.index() == i {
                    return;
                }
                match links[own..].iter_mut().find(|known| known.neighbour == link.neighbour) {
                    Some(known) => known.weight = add(known.weight, link.weight),
                    None => links.push(link),
                }
            };
            for &[sector, k] in &readers[reader_starts[i] as usize..reader_starts[i + 1] as usize] {
                let unknown = unknowns[sector as usize][k as usize];
                for corner in sectors.corners(surface, sector) {
                    push(unknown, link(corner, k, unknowns[sector_of(next(corner))]));
                    let entering = previous(corner);
                    let j = (k + transitions[entering as usize].quarters) % 2;
                    push(unknown, link(entering, j, [Unknown(0); 2]).back(unknowns[sector_of(entering)][j as usize].0));
                }
            }
            Terms { fixed: fixed[i], constraint: held[i], ..Terms::default() }
        })
    }
}
