//! The pairing of a triangle with another one: a search over its movements, and over rows that can be removed or inserted.
//!
//! # Theory
//! The search is a uniform-cost search. Its cost is the change of the squared differences between valences and the wanted
//! ones, with a price for each step. The cheapest edits found are evaluated by the objective.

use super::super::edit::Edit;
use super::super::{Engine, Kind};
use super::rows::{self, RowLimits};
use super::walk::{self, Step};
use rustc_hash::FxHashSet;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// The number of a triangle's edits that the objective evaluates.
const EVALUATED: usize = 3;
/// The price of a step, in squared valences.
const STEP_PRICE: f64 = 0.1;
/// The most that the last step can reduce the cost by.
const LAST_STEP_REDUCTION: f64 = 2.5;
/// Rows are searched from positions of a smaller cost.
const ROW_SEARCH_COST: f64 = 0.35;
/// The largest cost of an edit.
const MOST_COST: f64 = 2.6;

/// The edits in which a triangle and another one are no more: one for each that is beside it, and the cheapest others.
pub(super) fn ways_out<'e>(engine: &'e Engine, triangle: u32) -> Vec<(Kind, Edit<'e>)> {
    let edit = Edit::new(engine.mesh);
    let corners = edit.face(triangle);
    let met = (0..3).filter_map(|side| {
        let other = edit.across(corners[side], corners[(side + 1) % 3]).filter(|&other| engine.is_triangle(other))?;
        walk::meet(&edit, triangle, side, other).map(|(_, met)| (Kind::Meet, met)).filter(|(_, met)| met.is_sound())
    });
    let others = search(engine, triangle).into_iter().map(|end| (end.kind, end.edit));
    met.chain(others).collect()
}

/// The cheapest edits in which the triangle is no more, by uniform-cost search over its steps, but for those without a step.
fn search<'e>(engine: &'e Engine, triangle: u32) -> Vec<End<'e>> {
    let mut walked = vec![(Edit::new(engine.mesh), triangle)];
    let mut seen: FxHashSet<[u32; 3]> = FxHashSet::default();
    let mut heap: BinaryHeap<Reached> = BinaryHeap::new();
    let mut ends = Ends { list: Vec::new() };
    let (mut node, mut cost) = (0, 0.0);
    loop {
        let (edit, triangle) = (&walked[node].0, walked[node].1);
        for side in 0..3 {
            let corners = edit.face(triangle);
            let [x, y, z] = [0, 1, 2].map(|k| corners[(side + k) % 3]);
            if cost < ROW_SEARCH_COST {
                let longest = engine.options.longest_row;
                let limits = |ends: &Ends| RowLimits { longest, most_cost: ends.most() - cost };
                let out = rows::remove_row(edit, triangle, side, limits(&ends));
                ends.extend(Kind::RowOut, cost, out);
                rows::insert_rows(edit, triangle, z, limits(&ends), |row_cost, row| {
                    ends.extend(Kind::RowIn, cost, [(row_cost, row)]);
                    ends.most() - cost
                });
            }
            let Some(next) = edit.across(x, y) else { continue };
            match edit.face(next).len() {
                3 if node > 0 => ends.extend(Kind::Meet, cost, walk::meet(edit, triangle, side, next)),
                4 => heap.extend(walk::steps(edit, triangle, side, next).filter_map(|step| {
                    let cost = cost + step.cost(edit) + STEP_PRICE;
                    (cost - LAST_STEP_REDUCTION < ends.most() && !seen.contains(&step.key())).then_some(Reached {
                        cost,
                        from: node,
                        step,
                    })
                })),
                _ => {}
            }
        }
        if walked.len() == engine.options.searched {
            return ends.list;
        }
        let next = loop {
            let Some(next) = heap.pop() else { return ends.list };
            if next.cost - LAST_STEP_REDUCTION > ends.most() {
                return ends.list;
            }
            if seen.insert(next.step.key()) {
                break next;
            }
        };
        cost = next.cost;
        node = walked.len();
        walked.push(next.step.take(&walked[next.from].0));
    }
}

/// A step that the search can make.
struct Reached {
    cost: f64,
    /// The position that it starts from, in the order of the visits.
    from: usize,
    step: Step,
}

impl Ord for Reached {
    fn cmp(&self, other: &Self) -> Ordering {
        other.cost.total_cmp(&self.cost).then(other.from.cmp(&self.from)).then(other.step.key().cmp(&self.step.key()))
    }
}

impl PartialOrd for Reached {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Reached {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Reached {}

/// An edit that pairs two triangles.
struct End<'a> {
    kind: Kind,
    edit: Edit<'a>,
    cost: f64,
}

/// The cheapest edits, in order.
struct Ends<'a> {
    list: Vec<End<'a>>,
}

impl<'a> Ends<'a> {
    /// The largest cost of an edit that is kept.
    fn most(&self) -> f64 {
        self.list.get(EVALUATED - 1).map_or(MOST_COST, |end| end.cost)
    }

    fn extend(&mut self, kind: Kind, before: f64, edits: impl IntoIterator<Item = (f64, Edit<'a>)>) {
        for (cost, edit) in edits {
            let cost = before + cost;
            if cost < self.most() && edit.is_sound() {
                let place = self.list.partition_point(|end| end.cost <= cost);
                self.list.insert(place, End { kind, edit, cost });
                self.list.truncate(EVALUATED);
            }
        }
    }
}
