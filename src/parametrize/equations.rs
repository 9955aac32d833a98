//! The linear problems of the parametrization: the phases, and the offsets of the coordinates.

use super::{Cone, Parametrization, Transition, Unknowns, along};
use crate::compute::{Complex, ComputeError, Link, MIRRORED};
use crate::field::Sectors;
use crate::solver::{Hierarchy, Problem, Terms};
use crate::surface::{Surface, next, previous};
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

/// The equations of the parametrization.
///
/// # Errors
/// Where the initial solution fails.
pub fn equations(graph: &Graph) -> Result<Hierarchy, ComputeError> {
    let right_hand_side = graph.fixed.iter().map(|&fixed| [f32::from(fixed), 0.0]).collect();
    let free = vec![0.0; graph.fixed.len()];
    Hierarchy::units(
        graph.problem(|transition, k| (TAU * transition.wanted[k]).sin_cos(), right_hand_side, &free),
        SWEEPS,
    )
}

/// The equations of the offsets of the coordinates, after which the steps are the wanted ones in the sense of least squares.
/// Offsets are real and held as imaginary numbers, which are negated when they are mirrored. `cones` are drawn to the middles
/// of their triangles.
pub fn offsets(surface: &Surface, parametrization: &Parametrization, cones: &[Cone]) -> Hierarchy {
    let graph = parametrization.graph(surface);
    let Graph { sectors, unknowns, .. } = graph;
    let mut right_hand_side = vec![[0.0, 0.0]; parametrization.fixed.len()];
    let mut add = |unknown: u32, by: f64| {
        let sum: &mut Complex = &mut right_hand_side[(unknown & !MIRRORED) as usize];
        sum[1] += (if unknown & MIRRORED != 0 { -by } else { by }) as f32;
    };
    for h in 0..parametrization.transitions.len() as u32 {
        let transition = parametrization.transitions[h as usize];
        let step = parametrization.step(h);
        let [from, to] = [h, next(h)].map(|corner| sectors.of_corner[corner as usize] as usize);
        for k in 0..2 {
            let off = graph.weight(h) * (step[k as usize] - transition.wanted[k as usize]);
            add(along(unknowns[from], k), off);
            add(along(unknowns[to], k + transition.quarters), -off);
        }
    }
    let mut held = vec![0.0; parametrization.fixed.len()];
    for cone in cones {
        let weight = CONE_WEIGHT * parametrization.stiffness.get(cone.triangle as usize).unwrap_or(&1.0);
        for (k, offset) in (0..3).zip(parametrization.cone_offsets(cone)) {
            let sector = sectors.of_corner[(3 * cone.triangle + k) as usize] as usize;
            for (unknown, off) in unknowns[sector].into_iter().zip(offset) {
                add(unknown, weight * off);
                held[(unknown & !MIRRORED) as usize] += weight as f32;
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
        let is_corner = surface.features().is_corner(vertex) && !released_ends.contains(&vertex);
        let own = fixed.len() as u32;
        if is_corner || sectors.quarters[sector] == 0 {
            fixed.extend([is_corner; 2]);
            return [own, own + 1];
        }
        let toward = surface.same_place(surface.target(first));
        let is_trimmed = released_vertices.contains(&vertex);
        if !is_trimmed {
            fixed.push(true);
        }
        let [along, end] = *shared.entry(surface.same_place(vertex)).or_insert_with(|| {
            let along = fixed.len() as u32;
            fixed.extend(if is_trimmed { &[false; 2][..] } else { &[false] });
            [along, toward]
        });
        let mirrored = if end == toward { 0 } else { MIRRORED };
        [along | mirrored, if is_trimmed { (along + 1) | mirrored } else { own }]
    });
    (unknowns.collect(), fixed)
}

/// The sectors that read each unknown, with the quarter turns from their axes, one after the other, and where those of each
/// unknown start.
fn readers(unknowns: &[Unknowns], count: usize) -> (Vec<u32>, Vec<[u32; 2]>) {
    let all = || (0..).zip(unknowns).flat_map(|(s, pair)| [0, 1].map(|k| [pair[k as usize], s, k]));
    let mut starts = vec![0u32; count + 1];
    all().for_each(|[unknown, ..]| starts[(unknown & !MIRRORED) as usize + 1] += 1);
    for i in 0..count {
        starts[i + 1] += starts[i];
    }
    let mut place = starts.clone();
    let mut readers = vec![[0; 2]; 2 * unknowns.len()];
    for [unknown, sector, k] in all() {
        let place = &mut place[(unknown & !MIRRORED) as usize];
        readers[*place as usize] = [sector, k];
        *place += 1;
    }
    (starts, readers)
}

impl Graph<'_> {
    fn weight(&self, half_edge: u32) -> f64 {
        self.sectors.edge_weight(half_edge) * self.stiffness.get(half_edge as usize / 3).unwrap_or(&1.0)
    }

    /// Links each unknown along all half-edges. `turn` is the sine and cosine of the angle of a transition's link, `held` the
    /// weight of each unknown's constraint.
    fn problem(
        &self,
        turn: impl Fn(&Transition, usize) -> (f64, f64) + Sync,
        right_hand_side: Vec<Complex>,
        held: &[f32],
    ) -> Problem {
        let &Self { surface, sectors, transitions, unknowns, fixed, .. } = self;

        let (reader_starts, readers) = readers(unknowns, fixed.len());
        // What direction `k` of the sector that a half-edge leaves is linked to at its end: the far value, taken back.
        let link = |h: u32, k: u32, end: Unknowns| {
            let transition = transitions[h as usize];
            let (s, c) = turn(&transition, k as usize);
            let w = self.weight(h);
            Link { neighbour: along(end, k + transition.quarters), weight: [(w * c) as f32, (-w * s) as f32] }
        };
        let sector_of = |corner: u32| sectors.of_corner[corner as usize] as usize;
        Problem::new(right_hand_side, |i, links| {
            let own = links.len();
            let mut add = |unknown: u32, link: Link| {
                // As the unknown itself, not as the sector that reads it.
                let mirror = unknown & MIRRORED;
                let weight = if mirror == 0 { link.weight } else { [link.weight[0], -link.weight[1]] };
                let link = Link { neighbour: link.neighbour ^ mirror, weight };
                if link.index() == i {
                    return;
                }
                match links[own..].iter_mut().find(|known| known.neighbour == link.neighbour) {
                    Some(known) => known.weight = [known.weight[0] + link.weight[0], known.weight[1] + link.weight[1]],
                    None => links.push(link),
                }
            };
            for &[sector, k] in &readers[reader_starts[i] as usize..reader_starts[i + 1] as usize] {
                let unknown = unknowns[sector as usize][k as usize];
                for corner in sectors.corners(surface, sector) {
                    add(unknown, link(corner, k, unknowns[sector_of(next(corner))]));
                    let entering = previous(corner);
                    let j = (k + transitions[entering as usize].quarters) % 2;
                    add(unknown, link(entering, j, [0; 2]).back(unknowns[sector_of(entering)][j as usize]));
                }
            }
            Terms { fixed: fixed[i], constraint: held[i], ..Terms::default() }
        })
    }
}
