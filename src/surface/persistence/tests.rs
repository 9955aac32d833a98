use super::super::Features;
use super::super::turning::tests::drawn_out;
use super::*;
use crate::surface::{FeatureOptions, Soup};
use glam::DVec3;

/// Squares along each side of the plate, each of side 1.
const CELLS: u32 = 12;

/// A polyline along the plate's edges, by its corners.
type Line = &'static [[u32; 2]];

/// A flat plate.
fn plate() -> Surface {
    let at = |i: u32, j: u32| j * (CELLS + 1) + i;
    let lattice = |n: u32| (0..n).flat_map(move |j| (0..n).map(move |i| (i, j)));
    let soup = Soup {
        points: lattice(CELLS + 1).map(|(i, j)| [f64::from(i), f64::from(j), 0.0]).collect(),
        triangles: lattice(CELLS)
            .flat_map(|(i, j)| [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]])
            .collect(),
        ..Soup::default()
    };
    Surface::new(&soup, &FeatureOptions::default()).unwrap_or_else(|error| panic!("{error}"))
}

fn ends(surface: &Surface, h: u32) -> [[u32; 2]; 2] {
    [surface.origin(h), surface.target(h)].map(|v| {
        let place = DVec3::from(surface.frame().to_model(surface.point(v)));
        [place.x, place.y].map(|x| x.round() as u32)
    })
}

/// The inner half-edges along a line.
fn along(surface: &Surface, line: Line) -> Vec<u32> {
    let on = |h: &u32| {
        line.windows(2).any(|pair| {
            let low = [0, 1].map(|k| pair[0][k].min(pair[1][k]));
            let high = [0, 1].map(|k| pair[0][k].max(pair[1][k]));
            ends(surface, *h).iter().all(|p| (0..2).all(|k| (low[k]..=high[k]).contains(&p[k])))
        })
    };
    (0..3 * surface.triangle_count() as u32).filter(on).filter(|&h| surface.twin(h).is_some()).collect()
}

/// How many inner edges of each line are left as features for tiles of side `h`, where lines turn by at most `corner`.
fn left(surface: &Surface, lines: &[Line], corner: f64, h: f64) -> Vec<usize> {
    let mut surface = surface.clone();
    let mut marked: Vec<bool> = surface.twins.iter().map(|&twin| twin == NONE).collect();
    lines.iter().flat_map(|line| along(&surface, line)).for_each(|h| marked[h as usize] = true);
    surface.features = Features::along(&surface, marked, corner, 0.0);
    // The plate is flat, so the lengths must decide alone.
    let options = FeatureOptions { corner, every_crease: true, ..FeatureOptions::default() };
    let kept = persistent(&surface, &options, h / surface.frame().diagonal, None).marked;
    assert!((0..).zip(&surface.twins).all(|(h, &twin)| twin != NONE || kept[h]), "a boundary goes");
    lines.iter().map(|line| along(&surface, line).iter().filter(|&&h| kept[h as usize]).count() / 2).collect()
}

/// A line from side to side.
const ACROSS: Line = &[[0, 6], [12, 6]];

#[test]
fn what_is_too_small_goes() {
    // The lines, the largest turn that is no corner, and the side of tiles from which the last one goes.
    let cases: [(&str, &[Line], f64, f64); 5] = [
        ("a spur", &[ACROSS, &[[6, 6], [6, 7]]], 50.0, 2.0),
        ("a line with two loose ends", &[ACROSS, &[[3, 2], [5, 2]]], 50.0, 4.0),
        ("a rung between lines", &[ACROSS, &[[0, 8], [12, 8]], &[[5, 6], [5, 8]]], 50.0, 4.0),
        ("a loop", &[ACROSS, &[[3, 2], [5, 2], [5, 3], [3, 3], [3, 2]]], 100.0, 3.6),
        ("a loop of four corners", &[ACROSS, &[[3, 2], [5, 2], [5, 4], [3, 4], [3, 2]]], 50.0, 4.0),
    ];
    let surface = plate();
    for (name, lines, corner, limit) in cases {
        let all = left(&surface, lines, corner, 0.01);
        assert!(all.iter().all(|&edges| edges > 0), "{name}: {all:?}");
        assert_eq!(left(&surface, lines, corner, 0.999 * limit), all, "{name}");
        let fewer = left(&surface, lines, corner, 1.001 * limit);
        let (last, others) = fewer.split_last().expect("there are lines");
        assert_eq!((*last, others), (0, &all[..others.len()]), "{name}");
    }
}

#[test]
fn a_closed_line_with_one_corner_is_a_loop() {
    // A drop: turns of 90 degrees at three places are none, but the tip has a tail, which makes it a corner.
    let (drop, tail): (Line, Line) = (&[[4, 2], [6, 2], [6, 3], [4, 3], [4, 2]], &[[4, 2], [4, 0]]);
    let surface = plate();
    assert_eq!(left(&surface, &[drop, tail], 100.0, 3.59), [6, 2]);
    assert_eq!(left(&surface, &[drop, tail], 100.0, 3.61), [0, 2]);
}

#[test]
fn a_long_line_with_short_branches_stays() {
    let comb: [Line; 6] =
        [ACROSS, &[[2, 6], [2, 7]], &[[4, 6], [4, 5]], &[[6, 6], [6, 7]], &[[8, 6], [8, 5]], &[[10, 6], [10, 7]]];
    let surface = plate();
    assert_eq!(left(&surface, &comb, 50.0, 1.9), [12, 1, 1, 1, 1, 1]);
    // Between branches it is shorter than half a tile, but they are shorter still.
    assert_eq!(left(&surface, &comb, 50.0, 4.5), [12, 0, 0, 0, 0, 0]);
    // Cut into the same pieces by lines that stay, it goes.
    let ladder: [Line; 6] = [
        &[[2, 6], [4, 6]],
        &[[2, 0], [2, 12]],
        &[[4, 0], [4, 12]],
        &[[8, 0], [8, 12]],
        &[[10, 0], [10, 12]],
        &[[8, 6], [10, 6]],
    ];
    assert_eq!(left(&surface, &ladder, 50.0, 4.5), [0, 12, 12, 12, 12, 0]);
}

#[test]
fn boundaries_and_named_edges_stay() {
    let mut surface = plate();
    let spur: Line = &[[3, 3], [4, 3]];
    assert_eq!(left(&surface, &[spur], 50.0, 100.0), [0]);
    let named = along(&surface, spur);
    surface.name(named);
    assert_eq!(left(&surface, &[spur], 50.0, 100.0), [1]);
}

/// The inner features of a surface for tiles of a side, in model units: the middles of their edges.
fn kept(surface: &Surface, options: &FeatureOptions, side: f64) -> Vec<DVec3> {
    let fitted = surface.clone().fitted(options, (side / surface.frame().diagonal) as f32);
    let place = |v: u32| DVec3::from(fitted.frame().to_model(fitted.point(v)));
    let inner = |&h: &u32| fitted.features().is_feature(h) && fitted.twin(h).is_some_and(|twin| h < twin);
    let middle = |h: u32| (place(fitted.origin(h)) + place(fitted.target(h))) / 2.0;
    (0..3 * fitted.triangle_count() as u32).filter(inner).map(middle).collect()
}

/// Reproducible numbers from -1 to 1.
fn noise(seed: usize) -> f64 {
    let x = (seed as f64 * 12.9898).sin() * 43_758.547;
    2.0 * (x - x.floor()) - 1.0
}

#[test]
fn creases_of_noise_go_and_a_noisy_sharp_edge_stays() {
    // A roof of 90 degrees, its ridge along y, in cells of side 0.25; all points are pushed up or down by up to 0.08.
    let (half, cells) = (24, 48);
    let profile: Vec<[f64; 2]> = (-half..=half).map(|i| f64::from(i) * 0.25).map(|x| [x, -x.abs()]).collect();
    let mut soup = drawn_out(&profile, cells, 0.25);
    soup.points.iter_mut().enumerate().for_each(|(k, point)| point[2] += 0.08 * noise(k));
    let options = FeatureOptions { ridge: 180.0, ..FeatureOptions::default() };
    let surface = Surface::new(&soup, &options).unwrap_or_else(|error| panic!("{error}"));
    let off_the_ridge = |middles: &[DVec3]| middles.iter().filter(|p| p.x.abs() > 0.3).count();
    let all = kept(&surface, &options, 0.01);
    let persistent = kept(&surface, &options, 1.0);
    assert!(off_the_ridge(&all) > 50, "{} creases of noise", off_the_ridge(&all));
    assert_eq!(off_the_ridge(&persistent), 0);
    let on_the_ridge = (0..48).filter(|&j| persistent.iter().any(|p| (p.y / 0.25 - f64::from(j) - 0.5).abs() < 0.6));
    assert_eq!(on_the_ridge.count(), 48, "the ridge is whole");
    // A bridge may lead over an edge that was dropped before: it is a feature then, or dropped once more.
    let fitted = surface.clone().fitted(&options, (1.0 / surface.frame().diagonal) as f32);
    let edge = |h: u32| fitted.twin(h).map_or(h, |twin| h.min(twin));
    let mut dropped: Vec<u32> = fitted.dropped_edges().iter().map(|dropped| edge(dropped.half_edge)).collect();
    assert!(!dropped.is_empty() && dropped.iter().all(|&h| !fitted.features().is_feature(h)));
    dropped.sort_unstable();
    assert!(dropped.windows(2).all(|pair| pair[0] != pair[1]), "an edge is listed twice");
    let every = kept(&surface, &FeatureOptions { every_crease: true, ..options }, 1.0);
    assert!(off_the_ridge(&every) > 0, "lengths alone keep creases of noise");
}

#[test]
fn a_groove_is_a_feature_of_tiles_that_resolve_it() {
    let profile = [[-9.0, 0.0], [0.0, 0.0], [0.0, -0.5], [0.5, -0.5], [0.5, 0.0], [9.0, 0.0]];
    let options = FeatureOptions { ridge: 180.0, ..FeatureOptions::default() };
    let surface = Surface::new(&drawn_out(&profile, 18, 1.0), &options).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(kept(&surface, &options, 0.3).len(), 4 * 18);
    assert_eq!(kept(&surface, &options, 3.0).len(), 0);
    let fitted = surface.clone().fitted(&options, (3.0 / surface.frame().diagonal) as f32);
    let dropped = fitted.dropped_edges();
    assert_eq!(dropped.len(), 4 * 18);
    assert!(dropped.iter().all(|edge| edge.reason == Reason::Weak), "each of the four is long");
    assert_eq!(dropped.iter().map(|edge| edge.crease).max(), Some(3), "four creases");
    assert!(dropped.iter().all(|edge| !fitted.features().is_feature(edge.half_edge)));
}

#[test]
fn a_turn_that_is_taken_back_within_a_tile_is_no_corner() {
    // Steps of side 1 along the diagonal of the plate.
    let stairs: Line = &[[2, 2], [3, 2], [3, 3], [4, 3], [4, 4], [5, 4], [5, 5], [6, 5], [6, 6]];
    let bend: Line = &[[2, 2], [9, 2], [9, 9]];
    let surface = plate();
    let corners = |line: Line, reach: f64| {
        let mut marked = vec![false; 3 * surface.triangle_count()];
        along(&surface, line).into_iter().for_each(|h| marked[h as usize] = true);
        Features::along(&surface, marked, 50.0, reach / surface.frame().diagonal).corners().count()
    };
    assert_eq!(corners(stairs, 0.0), 9, "each step and both ends");
    assert_eq!(corners(stairs, 4.0), 2, "the ends");
    assert_eq!(corners(bend, 4.0), 3);
}

#[test]
fn of_two_creases_beside_each_other_between_the_same_ends_one_stays() {
    let (straight, bowed): (Line, Line) = (&[[2, 6], [10, 6]], &[[2, 6], [2, 7], [10, 7], [10, 6]]);
    let lines: [Line; 4] = [straight, bowed, &[[2, 0], [2, 6]], &[[10, 6], [10, 0]]];
    let surface = plate();
    // They are 1 apart: 0.15 tile sides of 6.67.
    assert_eq!(left(&surface, &lines, 100.0, 6.6), [8, 10, 6, 6]);
    assert_eq!(left(&surface, &lines, 100.0, 6.7), [0, 10, 6, 6]);
}

#[test]
fn a_crease_among_many_dropped_ones_must_be_more_persistent() {
    // A fold of 50 degrees along y, and spikes of height 1.5 at a distance of 4 on either side of it.
    let fold: Vec<[f64; 2]> = (-8..=8).map(f64::from).map(|x| [x, x.max(0.0) * 50.0_f64.to_radians().tan()]).collect();
    let kept_on_fold = |is_rough: bool, side: f64| {
        let mut soup = drawn_out(&fold, 32, 1.0);
        if is_rough {
            let is_spike = |p: &[f64; 3]| p[0].abs() == 4.0 && p[1] % 4.0 == 2.0;
            soup.points.iter_mut().filter(|p| is_spike(p)).for_each(|p| p[2] += 1.5);
        }
        let surface = Surface::new(&soup, &FeatureOptions::default()).unwrap_or_else(|error| panic!("{error}"));
        let marked = persistent(&surface, &FeatureOptions::default(), side / surface.frame().diagonal, None).marked;
        let place = |v: u32| DVec3::from(surface.frame().to_model(surface.point(v)));
        let on_fold = |&h: &u32| {
            surface.twin(h).is_some_and(|twin| h < twin)
                && [surface.origin(h), surface.target(h)].iter().all(|&v| place(v).x.abs() < 1e-3)
        };
        (0..marked.len() as u32).filter(on_fold).filter(|&h| marked[h as usize]).count()
    };
    assert_eq!([kept_on_fold(false, 7.0), kept_on_fold(true, 7.0)], [32, 0]);
    assert_eq!([kept_on_fold(false, 12.0), kept_on_fold(true, 1.0)], [0, 32], "its own persistence counts too");
}
