//! The hierarchy of the field's equations.

use super::*;
use crate::compute::cpu::CpuMultigrid;
use crate::compute::{Level, Multigrid, modulus};
use crate::field::constraints;
use crate::solver::Hierarchy;
use crate::surface::FeatureOptions;
use crate::surface::examples::Example;

fn multiply(a: Complex, b: Complex) -> Complex {
    [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
}

fn hierarchy_of(surface: &Surface) -> (Sectors, Hierarchy) {
    let sectors = Sectors::new(surface);
    let problem = problem(surface, &sectors, &constraints::combined(surface, &sectors, &[]));
    let hierarchy = Hierarchy::directions(problem, 10).expect("the CPU does not fail");
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
        let (diagonal, constraint) = (level.rows[i].diagonal, modulus(level.right_hand_side[i]));
        if level.is_fixed(i) {
            if (constraint - 1.0).abs() > 1e-6 {
                faults.push(format!("unknown {i} is fixed to {constraint}"));
            }
        } else if moduli + constraint > diagonal * (1.0 + 1e-6) {
            // A dozen roundings.
            faults.push(format!("row {i} sums to {}, its diagonal is {diagonal}", moduli + constraint));
        }
        for link in links {
            let j = link.index();
            let back = level.links_of(j).iter().filter(|back| back.neighbour == i as u32);
            let off = |z: Complex| modulus(add(conjugate(z), link.weight.map(|x| -x)));
            // Both ends add up the same numbers in other orders.
            if back.map(|back| off(back.weight)).fold(f32::INFINITY, f32::min) > 1e-5 * modulus(link.weight).max(1.0) {
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
            assert_eq!(fine.aggregate_count(), coarse.len(), "{name}");
            assert!(
                fine.parents.iter().all(|turn| (modulus(turn.weight) - 1.0).abs() < 1e-5),
                "{name}: turns only turn"
            );
            let mut seen = vec![false; fine.len()];
            for aggregate in 0..coarse.len() {
                assert!(!fine.members_of(aggregate).is_empty(), "{name}: an unknown without members");
                for &member in fine.members_of(aggregate) {
                    assert_eq!(fine.parents[member as usize].neighbour, aggregate as u32, "{name}");
                    assert!(!std::mem::replace(&mut seen[member as usize], true), "{name}: a member twice");
                    assert_eq!(fine.is_fixed(member as usize), coarse.is_fixed(aggregate), "{name}: kinds are mixed");
                }
            }
            assert!(seen.iter().all(|&seen| seen), "{name}: an unknown without parent");
        }
        assert!(hierarchy.levels.last().is_some_and(|last| last.parents.is_empty() && last.aggregate_count() == 0));
    }
}

#[test]
fn a_heavy_row_a_short_fixed_cross_and_a_one_sided_link_are_seen() {
    let mut level = hierarchy("block", 2_000).levels.swap_remove(0);
    let free = (0..level.len()).find(|&i| !level.is_fixed(i)).expect("a free unknown");
    let fixed = (0..level.len()).find(|&i| level.is_fixed(i)).expect("a fixed unknown");
    level.rows[free].diagonal *= 0.9;
    assert_eq!(faults(&level).len(), 1);
    level.right_hand_side[fixed] = level.right_hand_side[fixed].map(|x| x * 0.9);
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
    assert!(hierarchy("sphere", 4_000).levels.iter().all(|l| l.right_hand_side.iter().all(|&b| b == [0.0, 0.0])));
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
            let way = surface.points[surface.target(corner) as usize] - surface.points[surface.origin(corner) as usize];
            let (s, c) = (-4.0 * f64::from(way.y).atan2(f64::from(way.x))).sin_cos();
            [c as f32, s as f32]
        })
        .collect();
    let far = |a: &[Complex], b: &[Complex]| {
        a.iter().zip(b).map(|(a, b)| modulus([a[0] - b[0], a[1] - b[1]])).fold(0.0, f32::max)
    };
    for (depth, level) in hierarchy.levels.iter().enumerate() {
        let swept = |values: &[Complex]| {
            let mut multigrid = CpuMultigrid::new(&hierarchy.levels, depth, values);
            multigrid
                .normalised_sweep(depth, 1.0)
                .and_then(|()| multigrid.values(depth))
                .expect("the CPU does not fail")
        };
        // Some twenty products of rounded unit numbers a level.
        assert!(far(&swept(&values), &values) < 1e-5, "level {depth}: {}", far(&swept(&values), &values));
        let mut other = values.clone();
        let free = (0..level.len()).find(|&i| !level.is_fixed(i)).expect("a free unknown");
        other[free] = other[free].map(|x| -x);
        assert!(far(&swept(&other), &other) > 0.1, "level {depth}: a cross that is not the mean");
        let mut first = vec![[0.0, 0.0]; level.aggregate_count()];
        for (parent, &value) in level.parents.iter().zip(&values).rev() {
            first[parent.index()] = multiply(conjugate(parent.weight), value);
        }
        for (parent, &value) in level.parents.iter().zip(&values) {
            let here = multiply(parent.weight, first[parent.index()]);
            assert!(far(&[here], &[value]) < 1e-5, "level {depth}: members differ");
        }
        values = first;
    }
}
