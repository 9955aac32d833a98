//! Row ends, cancelled along shortest paths.
//!
//! # Theory
//! Along each half-edge the coordinates jump by a pair of integers. Around a triangle in which the field has a direction the
//! steps add up to a pair of integers: to zero where rows pass, to a unit where a row ends. Such a *charge* is moved over an
//! edge by a change of the edge's jump, and vanishes where it meets its opposite. It may also go into a triangle where the
//! field is singular, or over an open boundary, which then has a tile more or less. Paths grow from all charges at once, the
//! cheapest first (Dijkstra); those that meet first cancel. The price of an edge is how much more its step differs from the
//! wanted one, squared. Afterwards the coordinates are solved for again by least squares, with these jumps (Bommer, Zimmer and
//! Kobbelt 2009, *Mixed-integer quadrangulation*).

use super::transitions::turned;
use super::{Parametrization, Rows};
use crate::compute::{Backend, ComputeError};
use crate::progress::ASKED_EVERY;
use crate::sizes::Intervals;
use crate::surface::{Surface, previous};
use rayon::prelude::*;
use serde::Serialize;

/// The least price of an edge, in weighted squares of a tile side.
const LEAST_COST: f64 = 0.02;
/// The highest price of a path between ends of rows that may end, in weighted squares of a tile side
/// (docs/experiments.md, parametrization). Where each tile is split into n by n later, it is an n-th: the sides of n times as
/// many rows share the difference.
const MOST_COST: f64 = 12.0;

/// What became of the ends of rows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct RowEnds {
    /// Ends of rows after the periodic solve, with their multiplicity.
    pub before: usize,
    /// Ends of rows that are left.
    pub after: usize,
    /// Edges that the paths cross, in all.
    pub path_edges: usize,
}

/// The unit vector of a direction, in quarter turns.
fn unit(k: u32) -> [i32; 2] {
    [[1, 0], [0, 1], [-1, 0], [0, -1]][k as usize % 4]
}

struct Flow<'a, 'b> {
    surface: &'a Surface,
    parametrization: &'a mut Parametrization<'b>,
    weights: Vec<f32>,
    /// The feature curve of each half-edge on one, and how many tile sides it has.
    curve_of: Vec<u32>,
    intervals: Vec<i32>,
    /// Whether each curve keeps its number of tile sides.
    is_kept: Vec<bool>,
    /// The price of moving a charge over each half-edge, for each direction of its triangle; infinite: it cannot.
    prices: Vec<[f32; 4]>,
    /// By how many quarter turns the direction of a charge changes that is moved over each half-edge.
    turns: Vec<u8>,
    charges: Vec<[i32; 2]>,
    /// Whether a charge of any kind may end in a triangle.
    sinks: Vec<bool>,
    /// Whether a vertex lies where several sheets meet.
    shared: Vec<bool>,
    /// What a search knows of each state.
    reached: Vec<Reached>,
    touched: Vec<State>,
}

/// What a search knows of a state.
#[derive(Clone, Copy)]
struct Reached {
    /// Infinite where the state is not reached.
    cost: f64,
    /// Whether the cost is final.
    is_final: bool,
    /// The charge that the path began with.
    label: u32,
    /// The state before and the half-edge crossed last.
    from: Option<(State, u32)>,
}

impl Reached {
    const NOT: Self = Self { cost: f64::INFINITY, is_final: false, label: NOWHERE, from: None };
}

/// A unit charge in a triangle, with its direction in quarter turns from the axis at the triangle's first corner.
#[derive(Clone, Copy, PartialEq, Eq)]
struct State(u32);

impl State {
    fn new(triangle: u32, direction: u32) -> Self {
        Self(4 * triangle + direction)
    }

    fn triangle(self) -> u32 {
        self.0 / 4
    }

    fn direction(self) -> u32 {
        self.0 % 4
    }

    fn opposite(self) -> Self {
        Self(self.0 ^ 2)
    }

    fn index(self) -> usize {
        self.0 as usize
    }
}

/// The states of a triangle's charge, one for each coordinate.
fn states_of(triangle: u32, [u, v]: [i32; 2]) -> impl Iterator<Item = State> {
    let along = (u != 0).then_some(if u > 0 { 0 } else { 2 });
    let across = (v != 0).then_some(if v > 0 { 1 } else { 3 });
    [along, across].into_iter().flatten().map(move |k| State::new(triangle, k))
}

/// What happens in a search, in the order of costs.
#[derive(Clone, Copy)]
enum Event {
    /// A state is reached.
    Reached(State),
    /// Opposite charges meet in these two states.
    Met(State, State),
    /// A charge leaves a state over a boundary half-edge.
    Left(State, u32),
}

/// Where a path ends.
enum End {
    /// In a triangle, with this direction.
    Inside(State),
    /// Over a boundary half-edge, from a state.
    Outside(State, u32),
}

const NOWHERE: u32 = u32::MAX;

/// Events in the order of their costs, but for differences below [`LEAST_COST`]: no edge is cheaper, so that a state is final once
/// it is taken out (Dial 1969, *Algorithm 360: shortest-path forest with topological ordering*).
#[derive(Default)]
struct Queue {
    /// Each with the events of costs in a range of [`Self::WIDTH`].
    buckets: Vec<Vec<(f64, Event)>>,
    /// The first one that may have an event.
    first: usize,
}

impl Queue {
    /// Prices are rounded to f32, perhaps to less than the least one.
    const WIDTH: f64 = 0.99 * LEAST_COST;

    fn push(&mut self, cost: f64, event: Event) {
        let bucket = (cost / Self::WIDTH) as usize;
        if bucket >= self.buckets.len() {
            self.buckets.resize_with(bucket + 1, Vec::new);
        }
        self.buckets[bucket].push((cost, event));
    }

    fn pop(&mut self) -> Option<(f64, Event)> {
        loop {
            match self.buckets.get_mut(self.first)?.pop() {
                Some(next) => return Some(next),
                None => self.first += 1,
            }
        }
    }
}

impl Parametrization<'_> {
    /// Cancels the ends of rows: all of them where rows are continuous, else those with a cheap path. Afterwards the coordinates
    /// must be solved for again.
    ///
    /// # Errors
    /// Where the run is cancelled.
    pub(super) fn cancel_row_ends(
        &mut self,
        surface: &Surface,
        rows: Rows,
        finer: u32,
        backend: &dyn Backend,
    ) -> Result<RowEnds, ComputeError> {
        let triangles = surface.triangle_count() as u32;
        let sinks: Vec<bool> = (0..triangles).map(|t| self.quarters_around(t) != 0).collect();
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
        let mut curve_of = vec![NOWHERE; self.transitions.len()];
        let mut intervals = Vec::new();
        for (number, curve) in (0..).zip(surface.features().curves()) {
            intervals.push(curve.half_edges.iter().map(|&h| self.along(h)[1]).sum::<f64>().round() as i32);
            for &h in &curve.half_edges {
                for side in [Some(h), surface.twin(h)].into_iter().flatten() {
                    curve_of[side as usize] = number;
                }
            }
        }
        let mut is_kept = vec![false; intervals.len()];
        self.intervals.iter().for_each(|asked| is_kept[asked.curve] = true);
        let mut flow = Flow {
            surface,
            parametrization: self,
            weights,
            curve_of,
            intervals,
            is_kept,
            prices: Vec::new(),
            turns: Vec::new(),
            charges,
            sinks,
            shared,
            reached: vec![Reached::NOT; 4 * triangles as usize],
            touched: Vec::new(),
        };
        (flow.prices, flow.turns) = {
            let flow = &flow;
            (0..3 * triangles).into_par_iter().map(|h| (flow.prices_of(h), flow.turn(h))).unzip()
        };
        let mut path_edges = flow.set_intervals();
        loop {
            let most = if rows == Rows::Paper { MOST_COST / f64::from(finer) } else { f64::INFINITY };
            let crossed = flow.round(most, backend)?;
            path_edges += crossed;
            if crossed == 0 {
                break;
            }
        }
        if rows == Rows::Continuous {
            path_edges += flow.make_cones_integer(backend)?;
        }
        Ok(RowEnds { before, after: count(&flow.charges), path_edges })
    }

    /// Quarter turns by which the axes turn around a triangle.
    pub(super) fn quarters_around(&self, triangle: u32) -> u32 {
        (0..3).map(|k| self.transitions[3 * triangle as usize + k].quarters).sum::<u32>() % 4
    }

    /// Quarter turns from the axes where a half-edge begins to those at its triangle's first corner.
    fn quarters_home(&self, half_edge: u32) -> u32 {
        let first = half_edge - half_edge % 3;
        let passed: u32 = (first..half_edge).map(|h| self.transitions[h as usize].quarters).sum();
        (4 - passed % 4) % 4
    }

    /// The sum of the steps around a triangle, in the frame of its first corner.
    fn charge(&self, triangle: u32) -> [i32; 2] {
        let mut sum = [0.0; 2];
        for h in 3 * triangle..3 * triangle + 3 {
            let step = turned(self.step(h), self.quarters_home(h));
            sum = [sum[0] + step[0], sum[1] + step[1]];
        }
        sum.map(|x| x.round() as i32)
    }
}

impl Flow<'_, '_> {
    /// Gives curves the asked numbers of tile sides: row ends are put in beside them; how many edges were crossed.
    fn set_intervals(&mut self) -> usize {
        let mut crossed = 0;
        for Intervals { curve, count } in self.parametrization.intervals.clone() {
            let missing = count as i32 - self.intervals[curve];
            // The direction in which a charge that is moved over a half-edge makes the curve longer, or shorter.
            let turn = if missing > 0 { 2 } else { 0 };
            for _ in 0..missing.abs() {
                let excess = |h: u32| {
                    let step = |[x, y]: [f64; 2]| if self.along(h).is_multiple_of(2) { x.abs() } else { y.abs() };
                    let [found, wanted] =
                        [self.parametrization.step(h), self.parametrization.transitions[h as usize].wanted].map(step);
                    f64::from(missing.signum()) * (found - wanted)
                };
                let half_edges = &self.surface.features().curves()[curve].half_edges;
                let Some(h) = half_edges.iter().copied().min_by(|&a, &b| excess(a).total_cmp(&excess(b))) else {
                    break;
                };
                let direction = self.along(h) + turn + self.parametrization.quarters_home(h);
                let state = State::new(h / 3, direction % 4);
                self.charge(state, -1);
                if let Some(twin) = self.surface.twin(h) {
                    self.charge(self.across(h, twin, state.direction()), 1);
                }
                self.change_jumps(state, h);
                crossed += 1;
            }
        }
        crossed
    }

    /// Grows paths from all charges at once and cancels those that meet first, up to the price `most` of both paths together;
    /// how many edges were crossed.
    fn round(&mut self, most: f64, backend: &dyn Backend) -> Result<usize, ComputeError> {
        let mut queue = Queue::default();
        let mut asked = 0;
        let starts: Vec<State> = (0..).zip(&self.charges).flat_map(|(t, &charge)| states_of(t, charge)).collect();
        for (label, &state) in (0..).zip(&starts) {
            self.reach(state, 0.0, None, label);
            queue.push(0.0, Event::Reached(state));
        }
        let mut alive = vec![true; starts.len()];
        let mut crossed = 0;
        while let Some((cost, event)) = queue.pop() {
            if cost > most {
                continue;
            }
            asked += 1;
            if asked % ASKED_EVERY == 0 {
                backend.check()?;
            }
            let label = |flow: &Self, state: State| flow.reached[state.index()].label as usize;
            match event {
                Event::Reached(state) => {
                    let here = &mut self.reached[state.index()];
                    if cost > here.cost || !alive[here.label as usize] {
                        continue;
                    }
                    here.is_final = true;
                    if self.sinks[state.triangle() as usize] {
                        alive[label(self, state)] = false;
                        crossed += self.apply_path(End::Inside(state));
                        continue;
                    }
                    let opposite = self.reached[state.opposite().index()];
                    if opposite.is_final {
                        queue.push(cost + opposite.cost, Event::Met(state, state.opposite()));
                    }
                    self.grow(state, cost, most, &mut queue);
                }
                Event::Met(a, b) => {
                    let [one, other] = [a, b].map(|state| label(self, state));
                    if one != other && alive[one] && alive[other] {
                        (alive[one], alive[other]) = (false, false);
                        crossed += self.apply_path(End::Inside(a)) + self.apply_path(End::Inside(b));
                    }
                }
                Event::Left(state, h) => {
                    if std::mem::replace(&mut alive[label(self, state)], false) {
                        crossed += self.apply_path(End::Outside(state, h));
                    }
                }
            }
        }
        self.reset_search();
        Ok(crossed)
    }

    /// Reaches what lies beside a state up to the price `most`.
    fn grow(&mut self, state: State, cost: f64, most: f64, queue: &mut Queue) {
        for h in 3 * state.triangle()..3 * state.triangle() + 3 {
            let there = cost + f64::from(self.prices[h as usize][state.direction() as usize]);
            if there.is_infinite() || there > most {
                continue;
            }
            match self.surface.twin(h) {
                None => queue.push(there, Event::Left(state, h)),
                Some(twin) => {
                    let next = self.across(h, twin, state.direction());
                    if there < self.reached[next.index()].cost {
                        self.reach(next, there, Some((state, h)), self.reached[state.index()].label);
                        queue.push(there, Event::Reached(next));
                    }
                }
            }
        }
    }

    fn reset_search(&mut self) {
        for state in self.touched.drain(..) {
            self.reached[state.index()] = Reached::NOT;
        }
    }

    /// Moves a charge from one cone with half-integer coordinates to the next one, until all have integers.
    fn make_cones_integer(&mut self, backend: &dyn Backend) -> Result<usize, ComputeError> {
        let mut crossed = 0;
        for t in (0..self.sinks.len() as u32).filter(|&t| self.sinks[t as usize]).collect::<Vec<_>>() {
            backend.check()?;
            if self.is_half_integer(t) {
                // From each of its four directions, the cone comes to another integer.
                let starts = [0, 1, 2, 3].map(|k| State::new(t, k));
                let end = self.search(&starts, |flow, state| {
                    flow.sinks[state.triangle() as usize]
                        && state.triangle() != t
                        && flow.is_half_integer(state.triangle())
                });
                crossed += end.map_or(0, |end| self.apply_path(end));
                self.reset_search();
            }
        }
        Ok(crossed)
    }

    /// Whether the cone in a triangle has half-integer coordinates.
    fn is_half_integer(&self, triangle: u32) -> bool {
        self.parametrization.cone(triangle).is_some_and(|cone| !self.parametrization.is_integer(&cone))
    }

    /// The cheapest path from one of these states to one that takes its charge.
    fn search(&mut self, starts: &[State], takes: impl Fn(&Self, State) -> bool) -> Option<End> {
        let mut queue = Queue::default();
        for &start in starts {
            self.reach(start, 0.0, None, 0);
            queue.push(0.0, Event::Reached(start));
        }
        while let Some((cost, event)) = queue.pop() {
            match event {
                Event::Reached(state) if cost > self.reached[state.index()].cost => {}
                Event::Reached(state) if takes(self, state) => return Some(End::Inside(state)),
                Event::Reached(state) => self.grow(state, cost, f64::INFINITY, &mut queue),
                Event::Left(state, h) => return Some(End::Outside(state, h)),
                Event::Met(..) => {}
            }
        }
        None
    }

    fn reach(&mut self, state: State, cost: f64, from: Option<(State, u32)>, label: u32) {
        let place = &mut self.reached[state.index()];
        if place.cost.is_infinite() {
            self.touched.push(state);
        }
        *place = Reached { cost, is_final: place.is_final, label, from };
    }

    /// The state on the other side of a half-edge of a charge in the direction `k`.
    fn across(&self, half_edge: u32, twin: u32, k: u32) -> State {
        State::new(twin / 3, (k + u32::from(self.turns[half_edge as usize])) % 4)
    }

    /// See [`Self::turns`]; 0 on a boundary.
    fn turn(&self, half_edge: u32) -> u8 {
        let Some(twin) = self.surface.twin(half_edge) else { return 0 };
        let parametrization = &self.parametrization;
        // To the axes where the half-edge begins, where its twin ends; then to where the twin begins, and home.
        let quarters = if self.surface.features().is_feature(half_edge) {
            // Beside a feature each side has its own axes; along it they are opposite.
            self.along(twin) + 4 + 2 - self.along(half_edge)
        } else {
            parametrization.transitions[half_edge as usize].quarters
        };
        let home = |h: u32| parametrization.quarters_home(h);
        ((4 - home(half_edge) + quarters + home(twin)) % 4) as u8
    }

    /// Quarter turns from the axis to a half-edge on a feature, where it begins.
    fn along(&self, half_edge: u32) -> u32 {
        let [x, y] = self.parametrization.transitions[half_edge as usize].wanted;
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

    /// The price of moving a charge in the direction `k` over a half-edge; `None`: it cannot.
    fn price(&self, half_edge: u32, k: u32) -> Option<f64> {
        let parametrization = &self.parametrization;
        let here = (k + 4 - parametrization.quarters_home(half_edge)) % 4;
        // The change of the jump.
        let change = unit(here).map(|x| -f64::from(x));
        let step = parametrization.step(half_edge);
        if self.surface.features().is_feature(half_edge) {
            let along = unit(self.along(half_edge)).map(f64::from);
            let more = change[0] * along[0] + change[1] * along[1];
            let ends = [half_edge, crate::surface::next(half_edge)].map(|h| self.surface.origin(h) as usize);
            let curve = self.curve_of[half_edge as usize] as usize;
            let left = self.intervals[curve] + more as i32;
            if more == 0.0 || left < 1 || self.is_kept[curve] || ends.iter().any(|&v| self.shared[v]) {
                return None;
            }
        }
        let wanted = parametrization.transitions[half_edge as usize].wanted;
        let grown = (0..2).map(|i| {
            let off = step[i] - wanted[i];
            (off + change[i]).powi(2) - off.powi(2)
        });
        Some((f64::from(self.weights[half_edge as usize]) * grown.sum::<f64>()).max(LEAST_COST))
    }

    /// Changes the jumps along the path that was found; how many edges it crosses.
    fn apply_path(&mut self, end: End) -> usize {
        let mut crossed = 0;
        let mut state = match end {
            End::Inside(state) => {
                self.charge(state, 1);
                state
            }
            End::Outside(state, h) => {
                self.change_jumps(state, h);
                crossed += 1;
                state
            }
        };
        while let Some((before, h)) = self.reached[state.index()].from {
            self.change_jumps(before, h);
            crossed += 1;
            state = before;
        }
        self.charge(state, -1);
        crossed
    }

    fn charge(&mut self, state: State, times: i32) {
        if self.sinks[state.triangle() as usize] {
            return;
        }
        let [u, v] = unit(state.direction());
        let charge = &mut self.charges[state.triangle() as usize];
        *charge = [charge[0] + times * u, charge[1] + times * v];
    }

    /// Changes the jump of a half-edge, and of its twin, that takes a state's charge over it.
    fn change_jumps(&mut self, state: State, half_edge: u32) {
        let here = (state.direction() + 4 - self.parametrization.quarters_home(half_edge)) % 4;
        if self.surface.features().is_feature(half_edge) {
            let same = (self.along(half_edge) + 4 - here).is_multiple_of(4);
            self.intervals[self.curve_of[half_edge as usize] as usize] += if same { -1 } else { 1 };
        }
        let add = |jump: &mut [i32; 2], k: u32| {
            let [u, v] = unit(k);
            *jump = [jump[0] + u, jump[1] + v];
        };
        add(&mut self.parametrization.jumps[half_edge as usize], here + 2);
        if let Some(twin) = self.surface.twin(half_edge) {
            let there = self.across(half_edge, twin, state.direction()).direction() + 4
                - self.parametrization.quarters_home(twin);
            add(&mut self.parametrization.jumps[twin as usize], there % 4);
            self.prices[twin as usize] = self.prices_of(twin);
        }
        self.prices[half_edge as usize] = self.prices_of(half_edge);
    }
}
