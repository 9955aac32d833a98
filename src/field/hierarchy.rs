//! The field's linear problem, on a hierarchy of ever coarser levels.
//!
//! # Theory
//! The smoothest field minimises the connection Laplacian's energy, `sum_ij w_ij |z_i - r_ij z_j|^2 / 2`, against the
//! constraints (Knöppel et al. 2013). Coarsening by aggregation: strongly linked unknowns become one, read in the frame
//! of the first among them, and links between aggregates are the sums of their members' links in those frames (a
//! Galerkin product with a unitary prolongation). So a coarse level is a connection Laplacian again, the same sweep
//! works on it, and constraints live on every level.
//!
//! A field that is constant on each aggregate changes by jumps, and its energy is too large by the aggregates' width:
//! the coarse links are weakened by [`STIFFNESS`] (Braess 1995, *Towards algebraic multigrid for elliptic problems of
//! second order*), pulls and masses are not.

use super::outset::{OUTSET, outset};
use super::smooth::Pace;
use super::{Complex, Sectors, guides::Pull};
use crate::surface::{NONE, Surface, next, next_corner, previous};
use bytemuck::{Pod, Zeroable};
use rayon::prelude::*;

/// Levels stop shrinking at this many unknowns.
const COARSEST: usize = 32;
/// Cotangent weights are kept above this share of their typical size, so that a sweep is a mean.
pub(crate) const LEAST_WEIGHT: f64 = 0.02;
/// An aggregate's members beside its first.
const MEMBERS: usize = 3;
/// What coarse links are multiplied by. Aggregates of four are two wide, and a half would be exact for the smoothest
/// fields; but near constraints it corrects too much. From 0.5 to 0.7 conjugate gradients need about as many descents, at
/// 1 half as many again.
const STIFFNESS: f32 = 0.65;
/// The time in which an anchor draws a cross to itself, in areas of the surface: so long that constraints decide, and
/// short enough that without any the equations have one answer.
const DIFFUSION: f64 = 10.0;
/// Rows that one thread builds at a time.
const BLOCK: usize = 2048;

/// The bit of a link's unknown that says that its value is mirrored, taken conjugate, before it is multiplied.
pub const MIRRORED: u32 = 1 << 31;

/// Another unknown, and the complex number that its value is multiplied by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Link {
    /// The unknown, and [`MIRRORED`].
    pub neighbour: u32,
    /// The factor.
    pub weight: Complex,
}

impl Link {
    /// The unknown.
    #[inline]
    pub fn index(&self) -> usize {
        (self.neighbour & !MIRRORED) as usize
    }

    /// Whether its value is mirrored before it is multiplied.
    #[inline]
    pub fn is_mirrored(&self) -> bool {
        self.neighbour & MIRRORED != 0
    }

    /// What it makes of a value.
    #[inline]
    pub fn of(&self, [x, y]: Complex) -> Complex {
        let y = if self.is_mirrored() { -y } else { y };
        [self.weight[0] * x - self.weight[1] * y, self.weight[0] * y + self.weight[1] * x]
    }

    /// The link back to `to`, which this one leads from: its adjoint.
    #[inline]
    pub fn back(&self, to: u32) -> Self {
        let weight = if self.is_mirrored() { self.weight } else { conjugate(self.weight) };
        Self { neighbour: to ^ self.neighbour & MIRRORED, weight }
    }

    /// First `inner`, then this one: a link to the unknown of `inner`.
    fn after(&self, inner: &Self) -> Self {
        Self { neighbour: inner.neighbour ^ self.neighbour & MIRRORED, weight: self.of(inner.weight) }
    }
}

/// One unknown's equation: `diagonal z - sum weight z_neighbour` is what pulls it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Row {
    /// Where its links start; the next row's start is their end.
    pub start: u32,
    /// What its own value is multiplied by; 0: its value is fixed.
    pub diagonal: f32,
    /// The part of `diagonal` that draws it to the cross that it had.
    pub anchor: f32,
}

/// One level.
#[derive(Clone, Debug, Default)]
pub struct Level {
    /// The equations, and one more that ends the last one's links.
    pub rows: Vec<Row>,
    /// The links of all rows.
    pub links: Vec<Link>,
    /// What constraints add to each equation; the value of a fixed unknown.
    pub pulls: Vec<Complex>,
    /// The unknown on the next coarser level that each one is part of, with the factor that reads its value in the
    /// frame of this one; empty on the coarsest.
    pub parents: Vec<Link>,
    /// Where the members of each of the next coarser level's unknowns start, and one more; empty on the coarsest.
    pub families: Vec<u32>,
    /// The members of the coarser unknowns, one after the other.
    pub members: Vec<u32>,
}

impl Level {
    /// The number of unknowns.
    pub fn len(&self) -> usize {
        self.pulls.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.pulls.is_empty()
    }

    /// The links of an unknown.
    pub fn links_of(&self, unknown: usize) -> &[Link] {
        &self.links[self.rows[unknown].start as usize..self.rows[unknown + 1].start as usize]
    }

    /// Whether an unknown keeps its value.
    pub fn is_fixed(&self, unknown: usize) -> bool {
        self.rows[unknown].diagonal == 0.0
    }
}

/// All levels, finest first.
#[derive(Clone, Debug)]
pub struct Hierarchy {
    /// The levels, finest first.
    pub levels: Vec<Level>,
    /// The level that the smoothing sets out from; coarser ones serve the V-cycles.
    pub start: usize,
    /// The crosses of that level.
    pub crosses: Vec<Complex>,
    /// How much is done on the way to the finest.
    pub pace: Pace,
}

/// What a row's diagonal is made of beside its links' moduli.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Excess {
    /// By how much the links among its members disagree: the curvature that an aggregate covers.
    pub curvature: f32,
    /// The weight of its pulls.
    pub pull: f32,
    /// The weight of its anchor.
    pub anchor: f32,
    pub fixed: bool,
    /// The cross along the surface's bending, times the square of the difference of principal curvatures, times area.
    pub bend: Complex,
}

impl Hierarchy {
    /// Links all sectors along the edges of the surface and coarsens until few unknowns are left.
    pub(crate) fn new(surface: &Surface, sectors: &Sectors, pulls: &[Pull]) -> Self {
        let (mut level, mut excess) = finest(surface, sectors, pulls);
        let mut levels = Vec::new();
        let (mut start, mut bends) = (0, None);
        loop {
            let coarsest = level.len() <= COARSEST || !level.aggregate();
            if bends.is_none() && (coarsest || level.len() <= OUTSET) {
                start = levels.len();
                bends = Some(excess.iter().map(|excess| excess.bend).collect::<Vec<_>>());
            }
            if coarsest {
                levels.push(level);
                break;
            }
            let coarser = level.coarsened(&excess);
            levels.push(std::mem::replace(&mut level, coarser.0));
            excess = coarser.1;
        }
        let crosses = rayon::scope(|_| outset(&mut levels, start, &bends.unwrap_or_default()));
        Self { levels, start, crosses, pace: Pace::FIELD }
    }
}

/// What is known of each row, where its links start and, after the last, end, and all links.
pub(crate) struct Gathered<T> {
    pub rows: Vec<T>,
    pub starts: Vec<u32>,
    pub links: Vec<Link>,
}

/// The rows that `row` makes for each number, in order; it pushes a row's links and returns what else is known of it.
pub(crate) fn gather<T: Send>(count: usize, row: impl Fn(usize, &mut Vec<Link>) -> T + Sync) -> Gathered<T> {
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

fn finest(surface: &Surface, sectors: &Sectors, pulls: &[Pull]) -> (Level, Vec<Excess>) {
    let area = surface.area();
    let normals: Vec<_> = (0..surface.triangle_count()).into_par_iter().map(|t| surface.normal(t)).collect();
    let links_of_edges: Vec<Complex> = (0..3 * surface.triangle_count() as u32)
        .into_par_iter()
        .map(|h| {
            let weight = (sectors.cotangent(previous(h)) / 2.0).clamp(LEAST_WEIGHT, 1.0 / LEAST_WEIGHT);
            let (s, c) = (4.0 * sectors.transport(h)).sin_cos();
            [(weight * c) as f32, (weight * s) as f32]
        })
        .collect();
    let Gathered { rows: excess, starts, links } = gather(sectors.count(), |i, links| {
        let first = sectors.first_corner[i];
        let mut around = 0.0;
        let mut bend = [0.0f64; 2];
        let own = links.len();
        let mut at = first;
        loop {
            around += surface.double_area(at as usize / 3);
            // The edge that leaves this corner was the last corner's other side, and this one's other side comes next.
            let out = links_of_edges[at as usize];
            if let Some(twin) = surface.twin(at) {
                let e = surface.points[surface.target(at) as usize] - surface.points[surface.origin(at) as usize];
                let turn = normals[at as usize / 3].cross(normals[twin as usize / 3]).dot(e) / 2.0;
                let (s, c) = (2.0 * sectors.direction(at, 0.0)).sin_cos();
                bend = [bend[0] + f64::from(turn) * c, bend[1] + f64::from(turn) * s];
            }
            let back = conjugate(links_of_edges[previous(at) as usize]);
            match links.last_mut().filter(|_| at != first) {
                Some(last) => last.weight = sum(last.weight, out),
                None => links.push(Link { neighbour: sectors.of_corner[next(at) as usize], weight: out }),
            }
            match next_corner(surface, |h| surface.features().is_feature(h), at) {
                Some(corner) if corner == first => {
                    links[own].weight = sum(links[own].weight, back);
                    break;
                }
                more => {
                    links.push(Link { neighbour: sectors.of_corner[previous(at) as usize], weight: back });
                    let Some(corner) = more else { break };
                    at = corner;
                }
            }
        }
        Excess {
            curvature: 0.0,
            pull: pulls[i].weight,
            anchor: (f64::from(around) / 6.0 / (DIFFUSION * area)) as f32,
            fixed: pulls[i].is_fixed(),
            bend: {
                let a = f64::from(around) / 6.0;
                [((bend[0] * bend[0] - bend[1] * bend[1]) / a) as f32, (2.0 * bend[0] * bend[1] / a) as f32]
            },
        }
    });
    let pulls = pulls.iter().map(|p| if p.is_fixed() { p.toward } else { p.toward.map(|x| x * p.weight) }).collect();
    (Level::new(&excess, &starts, links, pulls), excess)
}

/// A level and all coarser ones, finest first.
pub(crate) fn coarsen(mut level: Level, mut excess: Vec<Excess>) -> Vec<Level> {
    let mut levels = Vec::new();
    while level.len() > COARSEST && level.aggregate() {
        let coarser = level.coarsened(&excess);
        levels.push(std::mem::replace(&mut level, coarser.0));
        excess = coarser.1;
    }
    levels.push(level);
    levels
}

impl Level {
    pub(crate) fn new(excess: &[Excess], starts: &[u32], links: Vec<Link>, pulls: Vec<Complex>) -> Self {
        let rows = (0..=excess.len())
            .into_par_iter()
            .map(|i| {
                let mut row = Row { start: starts[i], ..Row::default() };
                if let Some(excess) = excess.get(i).filter(|excess| !excess.fixed) {
                    let own = &links[starts[i] as usize..starts[i + 1] as usize];
                    let moduli: f32 = own.iter().map(|link| modulus(link.weight)).sum();
                    row.anchor = excess.anchor;
                    row.diagonal = moduli + excess.curvature + excess.pull + excess.anchor;
                }
                row
            })
            .collect();
        Self { rows, links, pulls, ..Self::default() }
    }

    /// Makes anchors stronger, up to `factor` times as strong where the share is 1.
    pub(super) fn hold(&mut self, factor: f32, shares: &[f32]) {
        for (row, share) in self.rows.iter_mut().zip(shares) {
            if row.diagonal > 0.0 {
                let more = row.anchor * (factor - 1.0) * share;
                row.anchor += more;
                row.diagonal += more;
            }
        }
    }

    /// The values of what is fixed, and zero elsewhere.
    pub fn fixed_crosses(&self) -> Vec<Complex> {
        (0..self.len()).map(|i| if self.is_fixed(i) { self.pulls[i] } else { [0.0, 0.0] }).collect()
    }

    /// The number of unknowns of the next coarser level; 0 on the coarsest.
    pub fn family_count(&self) -> usize {
        self.families.len().saturating_sub(1)
    }

    /// The members of an unknown of the next coarser level.
    pub fn members_of(&self, family: usize) -> &[u32] {
        &self.members[self.families[family] as usize..self.families[family + 1] as usize]
    }

    /// Groups each unknown with its strongest free neighbours of the same kind; `false`: that hardly makes them fewer.
    fn aggregate(&mut self) -> bool {
        let count = self.len();
        self.parents = vec![Link { neighbour: NONE, weight: [1.0, 0.0] }; count];
        self.families = Vec::with_capacity(count / 2);
        self.members = Vec::with_capacity(count);
        for i in 0..count {
            if self.parents[i].neighbour != NONE {
                continue;
            }
            let family = self.families.len() as u32;
            self.families.push(self.members.len() as u32);
            self.parents[i].neighbour = family;
            self.members.push(i as u32);
            // The strongest first, of equals the first; ids as modulus squared and the place in the row.
            let mut strongest = [(0.0, usize::MAX); MEMBERS];
            let own = self.rows[i].start as usize..self.rows[i + 1].start as usize;
            for e in own {
                let link = self.links[e];
                let j = link.index();
                if self.parents[j].neighbour == NONE && self.is_fixed(j) == self.is_fixed(i) {
                    let mut here = (modulus_squared(link.weight), e);
                    for place in &mut strongest {
                        if here.0 > place.0 {
                            std::mem::swap(&mut here, place);
                        }
                    }
                }
            }
            for (squared, e) in strongest.into_iter().filter(|strong| strong.1 != usize::MAX) {
                let link = self.links[e];
                let parent = &mut self.parents[link.index()];
                if parent.neighbour == NONE {
                    let modulus = squared.sqrt();
                    // The link reads j in i's frame; the turn reads i's value in j's.
                    let back = link.back(family);
                    *parent = Link { weight: back.weight.map(|x| x / modulus), ..back };
                    self.members.push(link.index() as u32);
                }
            }
        }
        let shrinks = self.families.len() * 10 < count * 9;
        if shrinks {
            self.families.push(count as u32);
        } else {
            (self.parents, self.families, self.members) = Default::default();
        }
        shrinks
    }

    fn coarsened(&self, excess: &[Excess]) -> (Self, Vec<Excess>) {
        let Gathered { rows, starts, links } = gather(self.families.len() - 1, |a, links| {
            let own = links.len();
            let mut total = Excess { fixed: true, ..Excess::default() };
            let mut pull = [0.0, 0.0];
            let mut moduli = 0.0;
            for &i in self.members_of(a) {
                let i = i as usize;
                let back = self.parents[i].back(0);
                for link in self.links_of(i) {
                    let parent = back.after(link).after(&self.parents[link.index()]);
                    let weight = parent.weight.map(|x| x * STIFFNESS);
                    if parent.index() == a {
                        // A mirrored value is as often against itself as with it.
                        let along = if parent.is_mirrored() { 0.0 } else { weight[0] };
                        total.curvature += (modulus(weight) - along).max(0.0);
                    } else {
                        moduli += modulus(weight);
                        match links[own..].iter_mut().find(|link| link.neighbour == parent.neighbour) {
                            Some(link) => link.weight = sum(link.weight, weight),
                            None => links.push(Link { neighbour: parent.neighbour, weight }),
                        }
                    }
                }
                pull = sum(pull, back.of(self.pulls[i]));
                total.curvature += excess[i].curvature * STIFFNESS;
                total.pull += excess[i].pull;
                total.anchor += excess[i].anchor;
                total.fixed &= excess[i].fixed;
                total.bend = sum(total.bend, back.of(excess[i].bend));
            }
            total.curvature += (moduli - links[own..].iter().map(|link| modulus(link.weight)).sum::<f32>()).max(0.0);
            if total.fixed {
                let length = modulus(pull);
                pull =
                    if length > 1e-6 { pull.map(|x| x / length) } else { self.pulls[self.members_of(a)[0] as usize] };
            }
            (total, pull)
        });
        let (excess, pulls): (Vec<_>, Vec<_>) = rows.into_iter().unzip();
        (Self::new(&excess, &starts, links, pulls), excess)
    }
}

fn modulus_squared(z: Complex) -> f32 {
    z[0] * z[0] + z[1] * z[1]
}

pub(super) fn modulus(z: Complex) -> f32 {
    modulus_squared(z).sqrt()
}

fn sum(a: Complex, b: Complex) -> Complex {
    [a[0] + b[0], a[1] + b[1]]
}

fn conjugate(z: Complex) -> Complex {
    [z[0], -z[1]]
}

#[cfg(test)]
mod tests;
