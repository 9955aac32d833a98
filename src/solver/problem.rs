//! A linear problem, assembled row by row.

use crate::compute::{Complex, Level, Link, Row, modulus};
use rayon::prelude::*;

/// Rows that one thread builds at a time.
const BLOCK: usize = 2048;

/// What a row has beside its links and its right-hand side.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Terms {
    /// By how much the links among an aggregate's members disagree: the curvature that the aggregate covers.
    pub curvature: f32,
    /// The weight of the row's constraint.
    pub constraint: f32,
    /// The mass over the time step.
    pub mass: f32,
    /// Whether the value is fixed, to the right-hand side.
    pub fixed: bool,
    /// A guess at the value, of any length, for where no constraint reaches.
    pub guess: Complex,
}

/// The equations of the finest level.
pub(crate) struct Problem {
    pub level: Level,
    pub terms: Vec<Terms>,
}

impl Problem {
    /// One row for each right-hand side; `row` pushes the links of a row and returns its other terms. A row's diagonal is the
    /// sum of its links' moduli and of its terms.
    pub fn new(right_hand_side: Vec<Complex>, row: impl Fn(usize, &mut Vec<Link>) -> Terms + Sync) -> Self {
        let Gathered { rows: terms, starts, links } = gather(right_hand_side.len(), row);
        Self { level: level(&terms, &starts, links, right_hand_side), terms }
    }
}

/// The level of these rows.
pub(super) fn level(terms: &[Terms], starts: &[u32], links: Vec<Link>, right_hand_side: Vec<Complex>) -> Level {
    let rows = (0..=terms.len())
        .into_par_iter()
        .map(|i| {
            let mut row = Row { start: starts[i], ..Row::default() };
            if let Some(terms) = terms.get(i).filter(|terms| !terms.fixed) {
                let own = &links[starts[i] as usize..starts[i + 1] as usize];
                let moduli: f32 = own.iter().map(|link| modulus(link.weight)).sum();
                row.mass = terms.mass;
                row.diagonal = moduli + terms.curvature + terms.constraint + terms.mass;
            }
            row
        })
        .collect();
    Level { rows, links, right_hand_side, ..Level::default() }
}

/// What is known of each row, where its links start and, after the last, end, and all links.
pub(super) struct Gathered<T> {
    pub rows: Vec<T>,
    pub starts: Vec<u32>,
    pub links: Vec<Link>,
}

/// The rows that `row` makes for each number, in order; it pushes a row's links and returns what else is known of it.
pub(super) fn gather<T: Send>(count: usize, row: impl Fn(usize, &mut Vec<Link>) -> T + Sync) -> Gathered<T> {
    let block = |first: usize| {
        let mut made = Gathered { rows: Vec::with_capacity(BLOCK), starts: Vec::new(), links: Vec::new() };
        for i in first..count.min(first + BLOCK) {
            made.starts.push(made.links.len() as u32);
            made.rows.push(row(i, &mut made.links));
        }
        made
    };
    let blocks: Vec<Gathered<T>> =
        (0..count.div_ceil(BLOCK)).into_par_iter().map(|number| block(number * BLOCK)).collect();
    let mut all = Gathered {
        rows: Vec::with_capacity(count),
        starts: Vec::with_capacity(count + 1),
        links: Vec::with_capacity(blocks.iter().map(|block| block.links.len()).sum()),
    };
    for block in blocks {
        let before = all.links.len() as u32;
        all.rows.extend(block.rows);
        all.starts.extend(block.starts.iter().map(|start| before + start));
        all.links.extend(block.links);
    }
    all.starts.push(all.links.len() as u32);
    all
}
