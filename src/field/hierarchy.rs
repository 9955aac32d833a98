//! The links between sectors on a hierarchy of ever coarser levels.
//!
//! # Theory
//! Coarsening by aggregation: strongly linked unknowns become one, read in the frame of the first among them, and links
//! between aggregates are the sums of their members' links in those frames (a Galerkin product with a unitary
//! prolongation). So a coarse level is a connection Laplacian again, the same sweep works on it, and constraints live
//! on every level.

use super::{Complex, Sectors, guides::Pull, sectors::rotate};
use crate::surface::{NONE, Surface, next, previous};

/// Levels stop shrinking at this many unknowns.
const COARSEST: usize = 32;
/// Cotangent weights are kept above this share of their typical size, so that the sweep is a mean.
const LEAST_WEIGHT: f32 = 0.02;
/// The share of its own value that a sweep keeps, so that neighbours do not swap values for ever.
const KEPT: f32 = 0.25;
/// An aggregate's members beside its first.
const MEMBERS: usize = 3;

/// One level: a sweep is `z_i <- sum_e weight_e z_neighbour_e + pull_i` over the links `starts[i]..starts[i + 1]`.
#[derive(Clone, Debug, Default)]
pub struct Level {
    /// Where the links of each unknown start; one more than unknowns.
    pub starts: Vec<u32>,
    /// The unknown at the other end of each link.
    pub neighbours: Vec<u32>,
    /// The complex weight of each link, its row scaled so that the moduli and the pull's sum to at most one.
    pub weights: Vec<Complex>,
    /// What constraints add to each unknown. A fixed unknown has no links.
    pub pulls: Vec<Complex>,
    /// The unknown on the next coarser level that each one is part of; empty on the coarsest.
    pub parents: Vec<u32>,
    /// What the parent's value is multiplied by to read it in the frame of each unknown.
    pub turns: Vec<Complex>,
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
}

/// All levels, finest first.
#[derive(Clone, Debug)]
pub struct Hierarchy {
    /// The levels, finest first.
    pub levels: Vec<Level>,
    /// Whether any unknown is constrained.
    pub constrained: bool,
}

/// Links before rows are scaled.
#[derive(Default)]
struct Links {
    starts: Vec<u32>,
    neighbours: Vec<u32>,
    weights: Vec<Complex>,
    pulls: Vec<Pull>,
}

impl Hierarchy {
    /// Links all sectors along the edges of the surface and coarsens until few unknowns are left.
    pub(crate) fn new(surface: &Surface, sectors: &Sectors, pulls: &[Pull]) -> Self {
        let mut links = link(surface, sectors, pulls);
        let mut levels = Vec::new();
        loop {
            let mut level = links.scaled();
            let coarser = (level.len() > COARSEST)
                .then(|| links.aggregate())
                .filter(|(parents, _, firsts)| firsts.len() * 10 < parents.len() * 9);
            let Some((parents, turns, firsts)) = coarser else {
                levels.push(level);
                break;
            };
            links = links.coarsened(&parents, &turns, &firsts);
            (level.parents, level.turns) = (parents, turns);
            levels.push(level);
        }
        Self { levels, constrained: pulls.iter().any(|pull| pull.weight > 0.0) }
    }
}

fn link(surface: &Surface, sectors: &Sectors, pulls: &[Pull]) -> Links {
    let half_edges = 3 * surface.triangle_count() as u32;
    // One entry a half-edge and direction; both sides of an inner edge add up.
    let mut entries: Vec<(u32, u32, Complex)> = Vec::with_capacity(2 * half_edges as usize);
    for h in 0..half_edges {
        let weight = cotangent(sectors.corner_angle(previous(h)));
        let (i, j) = (sectors.of_corner[h as usize], sectors.of_corner[next(h) as usize]);
        let r = rotate([weight, 0.0], sectors.transport(h));
        entries.push((i, j, r));
        entries.push((j, i, [r[0], -r[1]]));
    }
    let mut links = Links::from_entries(sectors.count(), entries);
    links.pulls = pulls.to_vec();
    links
}

fn cotangent(angle: f64) -> f32 {
    let (s, c) = angle.sin_cos();
    ((c / s.max(1e-9)) as f32 / 2.0).clamp(LEAST_WEIGHT, 1.0 / LEAST_WEIGHT)
}

impl Links {
    fn from_entries(unknowns: usize, mut entries: Vec<(u32, u32, Complex)>) -> Self {
        use rayon::slice::ParallelSliceMut;
        // Stable, so that sums are taken in the order of the entries.
        entries.par_sort_by_key(|&(i, j, _)| (u64::from(i) << 32) | u64::from(j));
        let mut links = Self { starts: vec![0; unknowns + 1], ..Self::default() };
        for run in entries.chunk_by(|a, b| a.0 == b.0 && a.1 == b.1) {
            let sum = run.iter().fold([0.0, 0.0], |s: Complex, e| [s[0] + e.2[0], s[1] + e.2[1]]);
            links.starts[run[0].0 as usize + 1] += 1;
            links.neighbours.push(run[0].1);
            links.weights.push(sum);
        }
        for i in 0..unknowns {
            links.starts[i + 1] += links.starts[i];
        }
        links
    }

    fn range(&self, i: usize) -> std::ops::Range<usize> {
        self.starts[i] as usize..self.starts[i + 1] as usize
    }

    fn scaled(&self) -> Level {
        let count = self.pulls.len();
        let mut level = Level { starts: vec![0; count + 1], ..Level::default() };
        for (i, pull) in self.pulls.iter().enumerate() {
            if pull.is_fixed() {
                level.pulls.push(pull.toward);
            } else {
                let total = pull.weight + self.range(i).map(|e| modulus(self.weights[e])).sum::<f32>();
                let scale = if total > 0.0 { (1.0 - KEPT) / total } else { 0.0 };
                level.pulls.push(pull.toward.map(|x| x * pull.weight * scale));
                level.neighbours.push(i as u32);
                level.weights.push([1.0 - (1.0 - KEPT) * f32::from(total > 0.0), 0.0]);
                for e in self.range(i) {
                    level.neighbours.push(self.neighbours[e]);
                    level.weights.push(self.weights[e].map(|x| x * scale));
                }
            }
            level.starts[i + 1] = level.neighbours.len() as u32;
        }
        level
    }

    /// Groups each unknown with its strongest free neighbours of the same kind: parent, turn, and each group's first.
    fn aggregate(&self) -> (Vec<u32>, Vec<Complex>, Vec<u32>) {
        let count = self.pulls.len();
        let mut parents = vec![NONE; count];
        let mut turns = vec![[1.0, 0.0]; count];
        let mut firsts = Vec::new();
        for i in 0..count {
            if parents[i] != NONE {
                continue;
            }
            let id = firsts.len() as u32;
            firsts.push(i as u32);
            parents[i] = id;
            let mut near: Vec<usize> = self
                .range(i)
                .filter(|&e| {
                    let j = self.neighbours[e] as usize;
                    parents[j] == NONE && self.pulls[j].is_fixed() == self.pulls[i].is_fixed()
                })
                .collect();
            near.sort_by(|&a, &b| modulus(self.weights[b]).total_cmp(&modulus(self.weights[a])).then(a.cmp(&b)));
            for &e in near.iter().take(MEMBERS) {
                let j = self.neighbours[e] as usize;
                let m = modulus(self.weights[e]);
                if parents[j] == NONE && m > 0.0 {
                    parents[j] = id;
                    // The link reads j in i's frame; the turn reads i's value in j's.
                    turns[j] = [self.weights[e][0] / m, -self.weights[e][1] / m];
                }
            }
        }
        (parents, turns, firsts)
    }

    fn coarsened(&self, parents: &[u32], turns: &[Complex], firsts: &[u32]) -> Links {
        let mut entries = Vec::with_capacity(self.weights.len());
        for (i, &a) in parents.iter().enumerate() {
            for e in self.range(i) {
                let j = self.neighbours[e] as usize;
                let b = parents[j];
                if a != b {
                    entries.push((a, b, multiply(multiply(conjugate(turns[i]), self.weights[e]), turns[j])));
                }
            }
        }
        let mut coarse = Links::from_entries(firsts.len(), entries);
        coarse.pulls = vec![Pull::none(); firsts.len()];
        for (i, &a) in parents.iter().enumerate() {
            let pull = &self.pulls[i];
            if pull.weight > 0.0 {
                coarse.pulls[a as usize].add(multiply(conjugate(turns[i]), pull.toward), pull.weight);
            }
        }
        coarse.pulls.iter_mut().for_each(Pull::settle);
        coarse
    }
}

fn modulus(z: Complex) -> f32 {
    (z[0] * z[0] + z[1] * z[1]).sqrt()
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
    use crate::field::{guides, smooth};
    use crate::surface::FeatureOptions;
    use crate::surface::examples::Example;

    fn hierarchy(name: &str, triangles: usize) -> Hierarchy {
        let soup = name.parse::<Example>().expect("an example's name").generate(triangles);
        let surface = Surface::new(&soup, &FeatureOptions::default()).unwrap_or_else(|error| panic!("{error}"));
        let sectors = Sectors::new(&surface);
        Hierarchy::new(&surface, &sectors, &guides::pulls(&surface, &sectors, &[]))
    }

    fn row(level: &Level, i: usize) -> std::ops::Range<usize> {
        level.starts[i] as usize..level.starts[i + 1] as usize
    }

    /// What is wrong with a level on its own.
    fn faults(level: &Level) -> Vec<String> {
        let mut faults = Vec::new();
        if level.starts.len() != level.len() + 1 || *level.starts.last().unwrap_or(&0) as usize != level.weights.len() {
            faults.push("rows do not cover the links".to_owned());
        }
        for i in 0..level.len() {
            let sum: f32 = row(level, i).map(|e| modulus(level.weights[e])).sum();
            // A dozen roundings.
            if sum + modulus(level.pulls[i]) > 1.0 + 1e-6 {
                faults.push(format!("row {i} sums to {}", sum + modulus(level.pulls[i])));
            }
            if (modulus(level.pulls[i]) > 1.0 - 1e-6) != row(level, i).is_empty() {
                faults.push(format!("unknown {i}: fixed and linked, or neither"));
            }
            if row(level, i).any(|e| level.neighbours[e] as usize >= level.len()) {
                faults.push(format!("row {i} leads out of the level"));
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
                assert!(fine.parents.iter().all(|&p| (p as usize) < coarse.len()));
                assert!(fine.turns.iter().all(|&t| (modulus(t) - 1.0).abs() < 1e-5), "{name}: turns only turn");
                let mut heirs = vec![false; coarse.len()];
                fine.parents.iter().for_each(|&p| heirs[p as usize] = true);
                assert!(heirs.iter().all(|&h| h), "{name}: an unknown without members");
            }
            assert!(hierarchy.levels.last().is_some_and(|last| last.parents.is_empty()));
            assert_eq!(hierarchy.constrained, !["sphere", "torus"].contains(&name));
        }
    }

    #[test]
    fn a_heavy_row_and_a_linked_fixed_unknown_are_seen() {
        let mut level = hierarchy("block", 2_000).levels.swap_remove(0);
        let free = (0..level.len()).find(|&i| !row(&level, i).is_empty()).expect("a free unknown");
        for e in row(&level, free) {
            level.weights[e] = level.weights[e].map(|x| x * 1.01);
        }
        assert_eq!(faults(&level).len(), 1);
        level.pulls[free] = [0.0, 1.0];
        assert_eq!(faults(&level).len(), 2);
    }

    #[test]
    fn constraints_live_on_every_level() {
        for level in &hierarchy("block", 4_000).levels {
            let fixed = level.pulls.iter().filter(|&&p| modulus(p) > 1.0 - 1e-6).count();
            assert!(fixed > 0 && fixed < level.len());
        }
        assert!(hierarchy("sphere", 4_000).levels.iter().all(|l| l.pulls.iter().all(|&p| p == [0.0, 0.0])));
    }

    #[test]
    fn a_constant_field_on_a_rectangle_stays_on_every_level() {
        // Flat, its sides along x and y: all links agree with the cross along x, and so must their sums.
        let (columns, rows) = (24, 16);
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
        let sectors = Sectors::new(&surface);
        let hierarchy = Hierarchy::new(&surface, &sectors, &guides::pulls(&surface, &sectors, &[]));
        assert!(hierarchy.levels.len() > 2);
        let mut values: Vec<Complex> = sectors
            .first_corner
            .iter()
            .map(|&corner| {
                let way =
                    surface.points[surface.target(corner) as usize] - surface.points[surface.origin(corner) as usize];
                rotate([1.0, 0.0], -f64::from(way.y).atan2(f64::from(way.x)))
            })
            .collect();
        let far = |a: &[Complex], b: &[Complex]| {
            a.iter().zip(b).map(|(a, b)| modulus([a[0] - b[0], a[1] - b[1]])).fold(0.0, f32::max)
        };
        for (depth, level) in hierarchy.levels.iter().enumerate() {
            for unit in [false, true] {
                let swept = smooth::sweep(level, &values, unit);
                // Some twenty products of rounded unit numbers a level.
                assert!(far(&swept, &values) < 1e-5, "level {depth}: {}", far(&swept, &values));
            }
            let mut other = values.clone();
            let free = (0..level.len()).find(|&i| !row(level, i).is_empty()).expect("a free unknown");
            other[free] = other[free].map(|x| -x);
            assert!(
                far(&smooth::sweep(level, &other, true), &other) > 0.1,
                "level {depth}: a cross that is not the mean"
            );
            if let Some(coarse) = hierarchy.levels.get(depth + 1) {
                let mut first = vec![[0.0, 0.0]; coarse.len()];
                for (i, &parent) in level.parents.iter().enumerate().rev() {
                    first[parent as usize] = multiply(conjugate(level.turns[i]), values[i]);
                }
                assert!(far(&smooth::prolong(level, &first), &values) < 1e-5, "level {depth}: members differ");
                values = first;
            }
        }
    }
}
