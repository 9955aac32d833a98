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
use super::{Complex, Sectors, guides::Pull};
use crate::surface::{NONE, Surface, next, next_corner, previous};
use bytemuck::{Pod, Zeroable};
use rayon::prelude::*;

/// Levels stop shrinking at this many unknowns.
const COARSEST: usize = 32;
/// Cotangent weights are kept above this share of their typical size, so that a sweep is a mean.
const LEAST_WEIGHT: f64 = 0.02;
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

/// Another unknown, and the complex number that its value is multiplied by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Link {
    /// The unknown.
    pub neighbour: u32,
    /// The factor.
    pub weight: Complex,
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
}

/// What a row's diagonal is made of beside its links' moduli.
#[derive(Clone, Copy, Debug, Default)]
struct Excess {
    /// By how much the links among its members disagree: the curvature that an aggregate covers.
    curvature: f32,
    /// The weight of its pulls.
    pull: f32,
    /// The weight of its anchor.
    anchor: f32,
    fixed: bool,
    /// The cross along the surface's bending, times the square of the difference of principal curvatures, times area.
    bend: Complex,
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
        Self { levels, start, crosses }
    }
}

/// What is known of each row, where its links start and, after the last, end, and all links.
struct Gathered<T> {
    rows: Vec<T>,
    starts: Vec<u32>,
    links: Vec<Link>,
}

/// The rows that `row` makes for each number, in order; it pushes a row's links and returns what else is known of it.
fn gather<T: Send>(count: usize, row: impl Fn(usize, &mut Vec<Link>) -> T + Sync) -> Gathered<T> {
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

impl Level {
    fn new(excess: &[Excess], starts: &[u32], links: Vec<Link>, pulls: Vec<Complex>) -> Self {
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
                let j = link.neighbour as usize;
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
                let parent = &mut self.parents[link.neighbour as usize];
                if parent.neighbour == NONE {
                    let modulus = squared.sqrt();
                    // The link reads j in i's frame; the turn reads i's value in j's.
                    *parent = Link { neighbour: family, weight: [link.weight[0] / modulus, -link.weight[1] / modulus] };
                    self.members.push(link.neighbour);
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
                let back = conjugate(self.parents[i].weight);
                for link in self.links_of(i) {
                    let parent = self.parents[link.neighbour as usize];
                    let weight = multiply(multiply(back, link.weight), parent.weight);
                    let weight = weight.map(|x| x * STIFFNESS);
                    if parent.neighbour == a as u32 {
                        total.curvature += (modulus(weight) - weight[0]).max(0.0);
                    } else {
                        moduli += modulus(weight);
                        match links[own..].iter_mut().find(|link| link.neighbour == parent.neighbour) {
                            Some(link) => link.weight = sum(link.weight, weight),
                            None => links.push(Link { neighbour: parent.neighbour, weight }),
                        }
                    }
                }
                pull = sum(pull, multiply(back, self.pulls[i]));
                total.curvature += excess[i].curvature * STIFFNESS;
                total.pull += excess[i].pull;
                total.anchor += excess[i].anchor;
                total.fixed &= excess[i].fixed;
                total.bend = sum(total.bend, multiply(back, excess[i].bend));
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

fn multiply(a: Complex, b: Complex) -> Complex {
    [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::guides;
    use crate::field::smooth::{Steps, Work};
    use crate::surface::FeatureOptions;
    use crate::surface::examples::Example;

    fn hierarchy_of(surface: &Surface) -> (Sectors, Hierarchy) {
        let sectors = Sectors::new(surface);
        let pulls = guides::pulls(surface, &sectors, &[]);
        let hierarchy = Hierarchy::new(surface, &sectors, &pulls);
        (sectors, hierarchy)
    }

    fn hierarchy(name: &str, triangles: usize) -> Hierarchy {
        let soup = name.parse::<Example>().expect("an example's name").generate(triangles);
        let surface = Surface::new(&soup, &FeatureOptions::default()).unwrap_or_else(|error| panic!("{error}"));
        hierarchy_of(&surface).1
    }

    /// What is wrong with a level on its own.
    fn faults(level: &Level) -> Vec<String> {
        let mut faults = Vec::new();
        let end = level.rows.last().map_or(0, |row| row.start as usize);
        if level.rows.len() != level.len() + 1 || end != level.links.len() {
            faults.push("rows do not cover the links".to_owned());
        }
        for i in 0..level.len() {
            let links = level.links_of(i);
            let moduli: f32 = links.iter().map(|link| modulus(link.weight)).sum();
            let (diagonal, pull) = (level.rows[i].diagonal, modulus(level.pulls[i]));
            if level.is_fixed(i) {
                if (pull - 1.0).abs() > 1e-6 {
                    faults.push(format!("unknown {i} is fixed to {pull}"));
                }
            } else if moduli + pull > diagonal * (1.0 + 1e-6) {
                // A dozen roundings.
                faults.push(format!("row {i} sums to {}, its diagonal is {diagonal}", moduli + pull));
            }
            for link in links {
                let j = link.neighbour as usize;
                let back = level.links_of(j).iter().filter(|back| back.neighbour == i as u32);
                let off = |z: Complex| modulus(sum(conjugate(z), link.weight.map(|x| -x)));
                // Both ends add up the same numbers in other orders.
                if back.map(|back| off(back.weight)).fold(f32::INFINITY, f32::min)
                    > 1e-5 * modulus(link.weight).max(1.0)
                {
                    faults.push(format!("the link from {i} to {j} is another one back"));
                }
            }
        }
        faults
    }

    #[test]
    fn every_level_is_a_mean_and_smaller_than_the_one_before() {
        for name in Example::NAMES {
            let hierarchy = hierarchy(name, 4_000);
            assert!(hierarchy.levels.len() > 2, "{name}");
            for (depth, level) in hierarchy.levels.iter().enumerate() {
                assert_eq!(faults(level), Vec::<String>::new(), "{name}, level {depth}");
            }
            for pair in hierarchy.levels.windows(2) {
                let [fine, coarse] = pair else { unreachable!("windows of two") };
                assert!(coarse.len() * 10 < fine.len() * 9, "{name}: {} after {}", coarse.len(), fine.len());
                assert_eq!(fine.family_count(), coarse.len(), "{name}");
                assert!(
                    fine.parents.iter().all(|turn| (modulus(turn.weight) - 1.0).abs() < 1e-5),
                    "{name}: turns only turn"
                );
                let mut seen = vec![false; fine.len()];
                for family in 0..coarse.len() {
                    assert!(!fine.members_of(family).is_empty(), "{name}: an unknown without members");
                    for &member in fine.members_of(family) {
                        assert_eq!(fine.parents[member as usize].neighbour, family as u32, "{name}");
                        assert!(!std::mem::replace(&mut seen[member as usize], true), "{name}: a member twice");
                        assert_eq!(fine.is_fixed(member as usize), coarse.is_fixed(family), "{name}: kinds are mixed");
                    }
                }
                assert!(seen.iter().all(|&seen| seen), "{name}: an unknown without parent");
            }
            assert!(hierarchy.levels.last().is_some_and(|last| last.parents.is_empty() && last.family_count() == 0));
        }
    }

    #[test]
    fn a_heavy_row_a_short_fixed_cross_and_a_one_sided_link_are_seen() {
        let mut level = hierarchy("block", 2_000).levels.swap_remove(0);
        let free = (0..level.len()).find(|&i| !level.is_fixed(i)).expect("a free unknown");
        let fixed = (0..level.len()).find(|&i| level.is_fixed(i)).expect("a fixed unknown");
        level.rows[free].diagonal *= 0.9;
        assert_eq!(faults(&level).len(), 1);
        level.pulls[fixed] = level.pulls[fixed].map(|x| x * 0.9);
        assert_eq!(faults(&level).len(), 2);
        let link = level.rows[free].start as usize;
        level.links[link].weight = conjugate(level.links[link].weight).map(|x| x * 1.01);
        assert!(faults(&level).len() >= 4, "both ends complain");
    }

    #[test]
    fn constraints_live_on_every_level() {
        for level in &hierarchy("block", 4_000).levels {
            let fixed = (0..level.len()).filter(|&i| level.is_fixed(i)).count();
            assert!(fixed > 0 && fixed < level.len());
        }
        assert!(hierarchy("sphere", 4_000).levels.iter().all(|l| l.pulls.iter().all(|&p| p == [0.0, 0.0])));
    }

    #[test]
    fn a_constant_field_on_a_rectangle_solves_every_level() {
        // Flat, its sides along x and y: all links agree with the cross along x, and so must their sums.
        let (columns, rows) = (48, 32);
        let mut soup = crate::surface::Soup::default();
        for j in 0..=rows {
            soup.points.extend((0..=columns).map(|i| [f64::from(i), f64::from(j), 0.0]));
        }
        for j in 0..rows as u32 {
            for i in 0..columns as u32 {
                let a = j * (columns as u32 + 1) + i;
                let [b, c, d] = [a + 1, a + columns as u32 + 2, a + columns as u32 + 1];
                soup.triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
        let surface = Surface::new(&soup, &FeatureOptions::default()).unwrap_or_else(|error| panic!("{error}"));
        let (sectors, hierarchy) = hierarchy_of(&surface);
        assert!(hierarchy.levels.len() > 2);
        let mut values: Vec<Complex> = sectors
            .first_corner
            .iter()
            .map(|&corner| {
                let way =
                    surface.points[surface.target(corner) as usize] - surface.points[surface.origin(corner) as usize];
                let (s, c) = (-4.0 * f64::from(way.y).atan2(f64::from(way.x))).sin_cos();
                [c as f32, s as f32]
            })
            .collect();
        let far = |a: &[Complex], b: &[Complex]| {
            a.iter().zip(b).map(|(a, b)| modulus([a[0] - b[0], a[1] - b[1]])).fold(0.0, f32::max)
        };
        for (depth, level) in hierarchy.levels.iter().enumerate() {
            let mut work = Work::new(&hierarchy.levels);
            let mut swept = |values: &[Complex]| {
                work.states[depth].crosses = values.to_vec();
                let Ok(()) = work.flow(depth, 1.0);
                work.states[depth].crosses.clone()
            };
            // Some twenty products of rounded unit numbers a level.
            assert!(far(&swept(&values), &values) < 1e-5, "level {depth}: {}", far(&swept(&values), &values));
            let mut other = values.clone();
            let free = (0..level.len()).find(|&i| !level.is_fixed(i)).expect("a free unknown");
            other[free] = other[free].map(|x| -x);
            assert!(far(&swept(&other), &other) > 0.1, "level {depth}: a cross that is not the mean");
            let mut first = vec![[0.0, 0.0]; level.family_count()];
            for (parent, &value) in level.parents.iter().zip(&values).rev() {
                first[parent.neighbour as usize] = multiply(conjugate(parent.weight), value);
            }
            for (parent, &value) in level.parents.iter().zip(&values) {
                let here = multiply(parent.weight, first[parent.neighbour as usize]);
                assert!(far(&[here], &[value]) < 1e-5, "level {depth}: members differ");
            }
            values = first;
        }
    }
}
