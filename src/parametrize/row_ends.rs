//! Row ends, cancelled by flow.
//!
//! # Theory
//! Along each half-edge the coordinates jump by a pair of whole numbers beside what their two places say. Round a triangle
//! in which the field has a direction the steps add up to whole numbers too: to none where rows pass, to a unit where one
//! ends. Such a *charge* is moved over an edge by changing the edge's jump; where it meets its opposite both vanish. It
//! may go as well into a triangle where the field is singular, or over an open boundary, which then has a tile more or
//! less. All charges grow at once over what is cheap (Dijkstra), and those that meet first cancel, again and again; an edge
//! costs what its step is hurt. After
//! Bommer, Zimmer and Kobbelt 2009 (*Mixed-integer quadrangulation*) coordinates that are free are solved for again, by least
//! squares, the jumps being kept.

use super::{Parametrization, Rows};
use crate::surface::{Surface, previous};
use rayon::prelude::*;
use serde::Serialize;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// What an edge costs at least, in the weighted square of a tile side.
const LEAST_COST: f64 = 0.02;
/// What a way may cost, in the weighted square of a tile side, that takes away ends of rows of equal tiles. Where each tile
/// is split afterwards into n by n, it is an n-th: sides give way over n times as many rows.
const WORTH: f64 = 12.0;

/// What became of the ends of rows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct RowEnds {
    /// Ends of rows that the periodic solve left, counted with their multiplicity.
    pub before: usize,
    /// Those that no path took away.
    pub after: usize,
    /// Edges that the paths cross, together.
    pub path_edges: usize,
}

/// The unit vector of a direction, in quarter turns.
fn unit(k: u32) -> [i32; 2] {
    [[1, 0], [0, 1], [-1, 0], [0, -1]][k as usize % 4]
}

struct Flow<'a, 'b> {
    surface: &'a Surface,
    phases: &'a mut Parametrization<'b>,
    weights: Vec<f32>,
    /// The feature curve of each half-edge on one, and how many tile sides it has.
    curve_of: Vec<u32>,
    intervals: Vec<i32>,
    /// What it costs to move a charge over each half-edge in each direction of its triangle; infinite: it cannot.
    prices: Vec<[f32; 4]>,
    charges: Vec<[i32; 2]>,
    /// Whether a charge of any kind may end in a triangle.
    sinks: Vec<bool>,
    /// Whether a vertex lies where several sheets meet.
    shared: Vec<bool>,
    // Of a search, by triangle and direction: cost, the state before and the half-edge last crossed, the charge that grew
    // there, whether it is settled.
    cost: Vec<f64>,
    from: Vec<[u32; 2]>,
    label: Vec<u32>,
    done: Vec<bool>,
    touched: Vec<u32>,
}

/// The states of a triangle's charge, one for each coordinate.
fn states_of(triangle: u32, [u, v]: [i32; 2]) -> impl Iterator<Item = u32> {
    let along = (u != 0).then_some(if u > 0 { 0 } else { 2 });
    let across = (v != 0).then_some(if v > 0 { 1 } else { 3 });
    [along, across].into_iter().flatten().map(move |k| 4 * triangle + k)
}

/// What happens in a search, in the order of costs.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Event {
    /// A state is reached.
    Reached(u32),
    /// Opposite charges meet in these two states.
    Met(u32, u32),
    /// A charge leaves a state over a boundary half-edge.
    Left(u32, u32),
}

/// Where a path ends.
enum End {
    /// In a triangle, with this direction.
    Inside(u32),
    /// Over a boundary half-edge, from a state.
    Outside(u32, u32),
}

const NOWHERE: u32 = u32::MAX;

impl Parametrization<'_> {
    /// Moves the ends of rows to where they cancel: all of them, or those of equal tiles for which the way is worth it; the
    /// places of the rows must be solved for again.
    pub(super) fn cancel_row_ends(&mut self, surface: &Surface, rows: Rows, finer: u32) -> RowEnds {
        let triangles = surface.triangle_count() as u32;
        let sinks: Vec<bool> = (0..triangles).map(|t| self.quarters_round(t) != 0).collect();
        let charges: Vec<[i32; 2]> =
            (0..triangles).map(|t| if sinks[t as usize] { [0; 2] } else { self.charge(t) }).collect();
        let sectors = self.field.sectors();
        let weights = (0..3 * triangles).map(|h| sectors.cotangent(previous(h)).clamp(0.04, 2.0) as f32).collect();
        let mut shared = vec![false; surface.vertex_count()];
        for v in 0..surface.vertex_count() as u32 {
            let first = surface.same_place(v);
            if first != v {
                shared[v as usize] = true;
                shared[first as usize] = true;
            }
        }
        let count = |charges: &[[i32; 2]]| {
            charges.iter().map(|c| (c[0].unsigned_abs() + c[1].unsigned_abs()) as usize).sum::<usize>()
        };
        let before = count(&charges);
        let mut curve_of = vec![NOWHERE; self.ways.len()];
        let mut intervals = Vec::new();
        for (number, curve) in (0..).zip(surface.features().curves()) {
            intervals.push(curve.half_edges.iter().map(|&h| self.along(h)[1]).sum::<f64>().round() as i32);
            for &h in &curve.half_edges {
                for side in [Some(h), surface.twin(h)].into_iter().flatten() {
                    curve_of[side as usize] = number;
                }
            }
        }
        let states = 4 * triangles as usize;
        let mut flow = Flow {
            surface,
            phases: self,
            weights,
            curve_of,
            intervals,
            prices: Vec::new(),
            charges,
            sinks,
            shared,
            cost: vec![f64::INFINITY; states],
            from: vec![[NOWHERE; 2]; states],
            label: vec![NOWHERE; states],
            done: vec![false; states],
            touched: Vec::new(),
        };
        flow.prices = {
            let flow = &flow;
            (0..3 * triangles).into_par_iter().map(|h| flow.prices_of(h)).collect()
        };
        let mut path_edges = 0;
        loop {
            let crossed = flow.round(if rows == Rows::Paper { WORTH / f64::from(finer) } else { f64::INFINITY });
            path_edges += crossed;
            if crossed == 0 {
                break;
            }
        }
        if rows == Rows::Continuous {
            path_edges += flow.make_cones_whole();
        }
        RowEnds { before, after: count(&flow.charges), path_edges }
    }

    /// Quarter turns that the axes are turned by round a triangle.
    pub(super) fn quarters_round(&self, triangle: u32) -> u32 {
        (0..3).map(|k| self.ways[3 * triangle as usize + k].quarters).sum::<u32>() % 4
    }

    /// Quarter turns from the axes where a half-edge begins to those at its triangle's first corner.
    fn quarters_home(&self, half_edge: u32) -> u32 {
        let first = half_edge - half_edge % 3;
        let passed: u32 = (first..half_edge).map(|h| self.ways[h as usize].quarters).sum();
        (4 - passed % 4) % 4
    }

    /// What the steps round a triangle add up to, at its first corner.
    fn charge(&self, triangle: u32) -> [i32; 2] {
        let mut sum = [0.0; 2];
        for h in 3 * triangle..3 * triangle + 3 {
            let step = turned(self.step(h), self.quarters_home(h));
            sum = [sum[0] + step[0], sum[1] + step[1]];
        }
        sum.map(|x| x.round() as i32)
    }
}

/// A vector turned by quarters, counter-clockwise.
pub(super) fn turned([u, v]: [f64; 2], quarters: u32) -> [f64; 2] {
    [[u, v], [-v, u], [-u, -v], [v, -u]][quarters as usize % 4]
}

impl Flow<'_, '_> {
    /// Lets all charges grow at once, each over what is cheap, and cancels those that meet first, at a cost of `most`
    /// together; how many edges were crossed.
    fn round(&mut self, most: f64) -> usize {
        let mut heap = BinaryHeap::new();
        let starts: Vec<u32> = (0..).zip(&self.charges).flat_map(|(t, &charge)| states_of(t, charge)).collect();
        for (label, &state) in (0..).zip(&starts) {
            self.reach(state, 0.0, [NOWHERE; 2], label);
            heap.push(Reverse((0, Event::Reached(state))));
        }
        let mut alive = vec![true; starts.len()];
        let mut crossed = 0;
        while let Some(Reverse((bits, event))) = heap.pop() {
            // Costs are finite and not negative, so their bits are in order.
            let cost = f64::from_bits(bits);
            if cost > most {
                break;
            }
            let label = |flow: &Self, state: u32| flow.label[state as usize] as usize;
            match event {
                Event::Reached(state) => {
                    if cost > self.cost[state as usize] || !alive[label(self, state)] {
                        continue;
                    }
                    self.done[state as usize] = true;
                    if self.sinks[state as usize / 4] {
                        alive[label(self, state)] = false;
                        crossed += self.carry(End::Inside(state));
                        continue;
                    }
                    let opposite = state ^ 2;
                    if self.done[opposite as usize] {
                        let together = cost + self.cost[opposite as usize];
                        heap.push(Reverse((together.to_bits(), Event::Met(state, opposite))));
                    }
                    self.grow(state, cost, |there, event| heap.push(Reverse((there.to_bits(), event))));
                }
                Event::Met(a, b) => {
                    let [one, other] = [a, b].map(|state| label(self, state));
                    if one != other && alive[one] && alive[other] {
                        (alive[one], alive[other]) = (false, false);
                        crossed += self.carry(End::Inside(a)) + self.carry(End::Inside(b));
                    }
                }
                Event::Left(state, h) => {
                    if std::mem::replace(&mut alive[label(self, state)], false) {
                        crossed += self.carry(End::Outside(state, h));
                    }
                }
            }
        }
        self.forget();
        crossed
    }

    /// Reaches what lies beside a state.
    fn grow(&mut self, state: u32, cost: f64, mut push: impl FnMut(f64, Event)) {
        for h in 3 * (state / 4)..3 * (state / 4) + 3 {
            let there = cost + f64::from(self.prices[h as usize][state as usize % 4]);
            if there.is_infinite() {
                continue;
            }
            match self.surface.twin(h) {
                None => push(there, Event::Left(state, h)),
                Some(twin) => {
                    let next = 4 * (twin / 3) + self.across(h, twin, state % 4);
                    if there < self.cost[next as usize] {
                        self.reach(next, there, [state, h], self.label[state as usize]);
                        push(there, Event::Reached(next));
                    }
                }
            }
        }
    }

    fn forget(&mut self) {
        for state in self.touched.drain(..) {
            self.cost[state as usize] = f64::INFINITY;
            self.done[state as usize] = false;
        }
    }

    /// Leads a charge from one cone between tiles to the next such one, until all lie on tiles.
    fn make_cones_whole(&mut self) -> usize {
        let mut crossed = 0;
        for t in (0..self.sinks.len() as u32).filter(|&t| self.sinks[t as usize]).collect::<Vec<_>>() {
            if self.is_between(t) {
                let end = self.search(4 * t, |flow, state| {
                    flow.sinks[state as usize / 4] && state / 4 != t && flow.is_between(state / 4)
                });
                crossed += end.map_or(0, |end| self.carry(end));
                self.forget();
            }
        }
        crossed
    }

    /// Whether the cone in a triangle lies between tiles.
    fn is_between(&self, triangle: u32) -> bool {
        self.phases.cone(triangle).is_some_and(|cone| !self.phases.is_whole(&cone))
    }

    /// The cheapest way from a state to one that takes its charge.
    fn search(&mut self, start: u32, takes: impl Fn(&Self, u32) -> bool) -> Option<End> {
        let mut heap = BinaryHeap::new();
        self.reach(start, 0.0, [NOWHERE; 2], 0);
        heap.push(Reverse((0, Event::Reached(start))));
        while let Some(Reverse((bits, event))) = heap.pop() {
            let cost = f64::from_bits(bits);
            match event {
                Event::Reached(state) if cost > self.cost[state as usize] => {}
                Event::Reached(state) if state != start && takes(self, state) => return Some(End::Inside(state)),
                Event::Reached(state) => {
                    self.grow(state, cost, |there, event| heap.push(Reverse((there.to_bits(), event))));
                }
                Event::Left(state, h) => return Some(End::Outside(state, h)),
                Event::Met(..) => {}
            }
        }
        None
    }

    fn reach(&mut self, state: u32, cost: f64, from: [u32; 2], label: u32) {
        if self.cost[state as usize].is_infinite() {
            self.touched.push(state);
        }
        self.cost[state as usize] = cost;
        self.from[state as usize] = from;
        self.label[state as usize] = label;
    }

    /// The direction that a charge in the direction `k` has on the other side of a half-edge.
    fn across(&self, half_edge: u32, twin: u32, k: u32) -> u32 {
        let phases = &self.phases;
        // To the axes where the half-edge begins, where its twin ends; then to where the twin begins, and home.
        let here = k + 4 - phases.quarters_home(half_edge);
        let quarters = if self.surface.features().is_feature(half_edge) {
            // Beside a feature each side has its own axes; along it they are opposite.
            return (self.along(twin) + 4 + 2 + here - self.along(half_edge) + phases.quarters_home(twin)) % 4;
        } else {
            phases.ways[half_edge as usize].quarters
        };
        (here + quarters + phases.quarters_home(twin)) % 4
    }

    /// Quarter turns from the axis to a half-edge on a feature, where it begins.
    fn along(&self, half_edge: u32) -> u32 {
        let [x, y] = self.phases.ways[half_edge as usize].by;
        if x.abs() >= y.abs() {
            if x > 0.0 { 0 } else { 2 }
        } else if y > 0.0 {
            1
        } else {
            3
        }
    }

    fn prices_of(&self, half_edge: u32) -> [f32; 4] {
        [0, 1, 2, 3].map(|k| self.price(half_edge, k).map_or(f32::INFINITY, |price| price as f32))
    }

    /// What it costs to move a charge in the direction `k` over a half-edge; `None`: it cannot.
    fn price(&self, half_edge: u32, k: u32) -> Option<f64> {
        let phases = &self.phases;
        let here = (k + 4 - phases.quarters_home(half_edge)) % 4;
        // The jump that takes it away.
        let change = unit(here).map(|x| -f64::from(x));
        let step = phases.step(half_edge);
        if self.surface.features().is_feature(half_edge) {
            let along = unit(self.along(half_edge)).map(f64::from);
            let more = change[0] * along[0] + change[1] * along[1];
            let ends = [half_edge, crate::surface::next(half_edge)].map(|h| self.surface.origin(h) as usize);
            let left = self.intervals[self.curve_of[half_edge as usize] as usize] + more as i32;
            if more == 0.0 || left < 1 || ends.iter().any(|&v| self.shared[v]) {
                return None;
            }
        }
        let by = phases.ways[half_edge as usize].by;
        let grown = (0..2).map(|i| {
            let off = step[i] - by[i];
            (off + change[i]).powi(2) - off.powi(2)
        });
        Some((f64::from(self.weights[half_edge as usize]) * grown.sum::<f64>()).max(LEAST_COST))
    }

    /// Changes the jumps along the path that was found; how many edges it crosses.
    fn carry(&mut self, end: End) -> usize {
        let mut crossed = 0;
        let mut state = match end {
            End::Inside(state) => {
                self.charge(state, 1);
                state
            }
            End::Outside(state, h) => {
                self.cross(state, h);
                crossed += 1;
                state
            }
        };
        while self.from[state as usize][0] != NOWHERE {
            let [before, h] = self.from[state as usize];
            self.cross(before, h);
            crossed += 1;
            state = before;
        }
        self.charge(state, -1);
        crossed
    }

    fn charge(&mut self, state: u32, times: i32) {
        if self.sinks[state as usize / 4] {
            return;
        }
        let [u, v] = unit(state % 4);
        let charge = &mut self.charges[state as usize / 4];
        *charge = [charge[0] + times * u, charge[1] + times * v];
    }

    /// Changes the jump of a half-edge, and of its twin, that takes a state's charge over it.
    fn cross(&mut self, state: u32, half_edge: u32) {
        let here = (state % 4 + 4 - self.phases.quarters_home(half_edge)) % 4;
        if self.surface.features().is_feature(half_edge) {
            let same = (self.along(half_edge) + 4 - here).is_multiple_of(4);
            self.intervals[self.curve_of[half_edge as usize] as usize] += if same { -1 } else { 1 };
        }
        let add = |jump: &mut [i32; 2], k: u32| {
            let [u, v] = unit(k);
            *jump = [jump[0] + u, jump[1] + v];
        };
        add(&mut self.phases.jumps[half_edge as usize], here + 2);
        if let Some(twin) = self.surface.twin(half_edge) {
            let there = self.across(half_edge, twin, state % 4) + 4 - self.phases.quarters_home(twin);
            add(&mut self.phases.jumps[twin as usize], there % 4);
            self.prices[twin as usize] = self.prices_of(twin);
        }
        self.prices[half_edge as usize] = self.prices_of(half_edge);
    }
}
