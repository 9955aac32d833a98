//! The solution of the field's equations.

use super::*;
use crate::compute::cpu::{CpuMultigrid, applied, product, remainder, stepped};
use crate::compute::{ComputeError, Cpu, Level, Multigrid};
use crate::field::constraints;
use crate::solver::{Hierarchy, ITERATIONS, SWEEP_STEP, cycle, solve};
use crate::surface::examples::Example;
use crate::surface::{FeatureOptions, Soup};

fn surface(soup: &Soup) -> Surface {
    Surface::new(soup, &FeatureOptions::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// The hierarchy of the equations under these constraints.
fn hierarchy(surface: &Surface, sectors: &Sectors, constraints: &[Constraint]) -> Hierarchy {
    Hierarchy::directions(problem(surface, sectors, constraints), 10).expect("the CPU does not fail")
}

fn example(name: &str, triangles: usize) -> Hierarchy {
    let surface = surface(&name.parse::<Example>().expect("an example's name").generate(triangles));
    let sectors = Sectors::new(&surface);
    hierarchy(&surface, &sectors, &constraints::combined(&surface, &sectors, &[]))
}

/// How far squares are turned about z, so that no edge has a round angle.
const TURN: f64 = 0.3;

/// A square of `side` by `side` cells in the plane z = 0, diagonals alternating.
fn square(side: u32) -> Soup {
    let at = |i: u32, j: u32| j * (side + 1) + i;
    let mut soup = Soup::default();
    for j in 0..=side {
        let (s, c) = TURN.sin_cos();
        let turned = |x: f64, y: f64| [c * x - s * y, s * x + c * y, 0.0];
        soup.points.extend((0..=side).map(|i| turned(f64::from(i), f64::from(j))));
    }
    for (i, j) in (0..side).flat_map(|j| (0..side).map(move |i| (i, j))) {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        soup.triangles.extend(if (i + j) % 2 == 0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] });
    }
    soup
}

/// The crosses of a square between 0 degrees on its left side and `degrees` on its right: the largest difference, in
/// degrees, from `wanted`, which is told the place from 0 to 1. Top and bottom are free.
fn off_in_square(side: u32, degrees: f64, wanted: impl Fn(f64) -> f64) -> f64 {
    let surface = surface(&square(side));
    let sectors = Sectors::new(&surface);
    let place = |sector: usize| {
        let corner = sectors.first_corner[sector];
        let at = |vertex: u32| surface.frame().to_model(surface.points[vertex as usize].to_array().map(f64::from));
        let [from, to] = [at(surface.origin(corner)), at(surface.target(corner))];
        let x = from[0] * TURN.cos() + from[1] * TURN.sin();
        (x / f64::from(side), (to[1] - from[1]).atan2(to[0] - from[0]) - TURN)
    };
    let constraints: Vec<Constraint> = (0..sectors.count())
        .map(|sector| {
            let (x, axis) = place(sector);
            let angle = match x {
                x if x < 1e-4 => 0.0,
                x if x > 1.0 - 1e-4 => degrees.to_radians(),
                _ => return Constraint::none(),
            };
            let (s, c) = (4.0 * (angle - axis)).sin_cos();
            Constraint::fixed([c as f32, s as f32])
        })
        .collect();
    let crosses = hierarchy(&surface, &sectors, &constraints).solve(&Cpu).expect("the CPU does not fail");
    let off = |sector: usize| {
        let (x, axis) = place(sector);
        let angle = f64::from(crosses[sector][1]).atan2(f64::from(crosses[sector][0])) / 4.0 + axis;
        let off = angle.to_degrees() - wanted(x);
        (off - (off / 90.0).round() * 90.0).abs()
    };
    (0..sectors.count()).map(off).fold(0.0, f64::max)
}

#[test]
fn between_two_guided_sides_the_field_is_harmonic() {
    let degrees = 30.0;
    // Four times the angle is what is interpolated: z = (1 - x) + x exp(4 i degrees).
    let (s, c) = (4.0 * f64::to_radians(degrees)).sin_cos();
    let harmonic = |x: f64| (x * s).atan2(1.0 - x + x * c).to_degrees() / 4.0;
    for side in [24, 64, 150] {
        let off = off_in_square(side, degrees, harmonic);
        println!("{side} cells a side: {off:.3} degrees from harmonic");
        assert!(off < 0.5, "{side}: {off}");
    }
    // The angle itself is not interpolated, and between other sides there is another field.
    assert!(off_in_square(64, degrees, |x| degrees * x) > 2.0);
    assert!(off_in_square(64, degrees - 2.0, harmonic) > 1.0);
}

#[test]
fn a_constant_field_is_found_however_far_its_sides_are() {
    let off = off_in_square(300, 0.0, |_| 0.0).to_radians();
    println!("{off:.1e} radians");
    assert!(off < 1e-4, "{off}");
    assert!(off_in_square(300, 1.0, |_| 0.0).to_radians() > 1e-3);
}

/// Numbers in -0.5..0.5 that look random, zero where an unknown is fixed.
fn scattered(level: &Level, mut state: u32) -> Vec<Complex> {
    let mut next = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        state as f32 / u32::MAX as f32 - 0.5
    };
    (0..level.len()).map(|i| [next(), next()].map(|x| if level.is_fixed(i) { 0.0 } else { x })).collect()
}

#[test]
fn a_cycle_is_a_symmetric_map() {
    let hierarchy = example("m6", 20_000);
    let level = &hierarchy.levels[0];
    let map = |residual: &[Complex]| {
        let mut multigrid = at_start(&hierarchy.levels);
        multigrid.states[0].residual = residual.to_vec();
        cycle(&mut multigrid, 0, hierarchy.levels.len()).expect("the CPU does not fail");
        multigrid.states[0].correction.clone()
    };
    let (u, v) = (scattered(level, 1), scattered(level, 2));
    let (to_u, to_v) = (map(&u), map(&v));
    let [uv, vu, uu] = [product(&u, &to_v), product(&v, &to_u), product(&u, &to_u)];
    // Some hundred roundings of 2^-24 a value.
    assert!((uv - vu).abs() < 1e-4 * uu, "{uv} {vu} {uu}");
    assert!(uu > 0.0);
    let turned: Vec<Complex> = to_u.iter().map(|&[x, y]| [-y, x]).collect();
    assert!((uv - product(&v, &turned)).abs() > 1e-4 * uu, "another map is seen");
}

#[test]
fn products_are_trees_of_blocks() {
    let hierarchy = example("sphere", 2_000);
    let mut a = scattered(&hierarchy.levels[0], 3);
    for count in [0, 1, 255, 256, 257, 900] {
        let exact: f64 = a[..count].iter().map(|z| f64::from(z[0]).powi(2) + f64::from(z[1]).powi(2)).sum();
        // A tree of 1024 has ten roundings.
        assert!((f64::from(product(&a[..count], &a[..count])) - exact).abs() <= 1e-6 * exact, "{count}");
    }
    let before = product(&a[..900], &a[..900]);
    a[899][0] += 0.5;
    assert_ne!(product(&a[..900], &a[..900]), before);
}

/// Fixed values on all levels.
fn at_start(levels: &[Level]) -> CpuMultigrid<'_> {
    CpuMultigrid::new(levels, 0, &levels[0].fixed_values())
}

/// Counts the rows' worth of links that steps read, in sweeps of the finest level.
struct Counted<'a> {
    work: CpuMultigrid<'a>,
    sweeps: f64,
}

impl Counted<'_> {
    fn count(&mut self, depth: usize) {
        self.sweeps += self.work.levels[depth].links.len() as f64 / self.work.levels[0].links.len() as f64;
    }
}

impl Multigrid for Counted<'_> {
    fn prolong(&mut self, depth: usize) -> Result<(), ComputeError> {
        self.work.prolong(depth)
    }

    fn residual(&mut self, depth: usize) -> Result<(), ComputeError> {
        self.count(depth);
        self.work.residual(depth)
    }

    fn first_sweep(&mut self, depth: usize, step: f32) -> Result<(), ComputeError> {
        self.work.first_sweep(depth, step)
    }

    fn sweep(&mut self, depth: usize, step: f32) -> Result<(), ComputeError> {
        self.count(depth);
        self.work.sweep(depth, step)
    }

    fn restrict(&mut self, depth: usize) -> Result<(), ComputeError> {
        self.count(depth);
        self.work.restrict(depth)
    }

    fn correct(&mut self, depth: usize) -> Result<(), ComputeError> {
        self.work.correct(depth)
    }

    fn descend(&mut self, depth: usize, number: u32) -> Result<(), ComputeError> {
        self.count(depth);
        self.work.descend(depth, number)
    }

    fn normalised_sweep(&mut self, depth: usize, step: f32) -> Result<(), ComputeError> {
        self.count(depth);
        self.work.normalised_sweep(depth, step)
    }

    fn values(&mut self, depth: usize) -> Result<Vec<Complex>, ComputeError> {
        self.work.values(depth)
    }
}

/// The energy of `values` above that of the solution.
fn excess(level: &Level, values: &[Complex], solution: &[Complex]) -> f64 {
    let off: Vec<Complex> = values.iter().zip(solution).map(|(a, b)| [a[0] - b[0], a[1] - b[1]]).collect();
    let term = |i: usize| {
        let image = applied(level, &off, i);
        f64::from(off[i][0]) * f64::from(image[0]) + f64::from(off[i][1]) * f64::from(image[1])
    };
    (0..level.len()).into_par_iter().map(term).sum::<f64>() / 2.0
}

/// The linear problem's energy above its least, in shares of that of values that are zero where nothing fixes them, after
/// so many sweeps' work: with the hierarchy, and by sweeps alone.
fn convergence(levels: &[Level], cycles: u32, sweeps: &[u32]) -> (Vec<(f64, f64)>, Vec<f64>) {
    let (level, count) = (&levels[0], levels.len());
    let solution = {
        let mut multigrid = at_start(levels);
        (0..3).try_for_each(|_| solve(&mut multigrid, 0, count, 20)).expect("the CPU does not fail");
        multigrid.states.swap_remove(0).values
    };
    let whole = excess(level, &level.fixed_values(), &solution);
    let share = |values: &[Complex]| excess(level, values, &solution) / whole;

    let mut counted = Counted { work: at_start(levels), sweeps: 0.0 };
    let mut with = Vec::new();
    let mut run = || {
        for depth in (1..count).rev() {
            solve(&mut counted, depth, count, ITERATIONS)?;
            counted.prolong(depth - 1)?;
        }
        counted.residual(0)?;
        with.push((counted.sweeps, share(&counted.work.states[0].values)));
        (0..cycles).try_for_each(|number| {
            cycle(&mut counted, 0, count)?;
            counted.descend(0, number)?;
            with.push((counted.sweeps, share(&counted.work.states[0].values)));
            Ok::<_, ComputeError>(())
        })
    };
    run().expect("the CPU does not fail");

    let mut alone = level.fixed_values();
    let mut done = 0;
    let without = sweeps.iter().map(|&sweep| {
        for _ in done..sweep {
            let residual = |i| remainder(level.right_hand_side[i], level, &alone, i);
            let swept = |i| stepped(alone[i], level, residual(i), i, SWEEP_STEP);
            alone = (0..level.len()).into_par_iter().with_min_len(2048).map(swept).collect();
        }
        done = sweep;
        share(&alone)
    });
    (with, without.collect())
}

/// The levels without masses: the linear problem alone.
fn linear(mut levels: Vec<Level>) -> Vec<Level> {
    for row in levels.iter_mut().flat_map(|level| &mut level.rows) {
        row.diagonal -= row.mass;
        row.mass = 0.0;
    }
    levels
}

#[test]
fn the_hierarchy_converges_where_sweeps_do_not() {
    let (with, without) = convergence(&linear(example("m6", 30_000).levels), ITERATIONS, &[200]);
    let (work, left) = with[ITERATIONS as usize];
    println!("{left:.1e} after {work:.0} sweeps, {:.1e} after 200 without hierarchy", without[0]);
    assert!(left < 1e-4 && work < 200.0, "{with:?}");
    assert!(without[0] > 100.0 * left, "{without:?}");
}

#[test]
#[ignore = "a table for the module's documentation; a minute"]
fn energy_against_sweeps_on_a_million_triangles() {
    let sweeps = [16, 32, 64, 128, 256, 512, 1024, 2048];
    let (with, without) = convergence(&linear(example("m6", 1_000_000).levels), 16, &sweeps);
    for (work, left) in with {
        println!("with hierarchy    {work:7.1} sweeps {left:.1e}");
    }
    for (work, left) in sweeps.iter().zip(without) {
        println!("without hierarchy {work:5}   sweeps {left:.1e}");
    }
}
