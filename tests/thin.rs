//! Parts thinner than the tiles that are asked for: tips of needles, walls, and teeth.

use quadmosaic::parametrize::Rows;
use quadmosaic::{Fineness, Mesher, Options, Outcome, Soup};
use std::f64::consts::TAU;

/// A profile of radii and heights that begins and ends on the axis or comes back to its beginning, turned about the axis.
fn turned(profile: &[[f64; 2]], around: u32) -> Soup {
    let mut points: Vec<[f64; 3]> = Vec::new();
    let is_closed = profile.first() == profile.last();
    let rows = if is_closed { &profile[1..] } else { profile };
    let first: Vec<u32> = rows
        .iter()
        .map(|&[radius, height]| {
            let first = points.len() as u32;
            let angle = |i: u32| TAU * f64::from(i) / f64::from(around);
            let count = if radius == 0.0 { 1 } else { around };
            points.extend((0..count).map(|i| [radius * angle(i).cos(), radius * angle(i).sin(), height]));
            first
        })
        .collect();
    let at = |row: usize, i: u32| first[row] + if rows[row][0] == 0.0 { 0 } else { i % around };
    let pairs = (0..rows.len() - usize::from(!is_closed)).map(|row| (row, (row + 1) % rows.len()));
    let quads =
        pairs.flat_map(|(low, high)| (0..around).map(move |i| [(low, i), (low, i + 1), (high, i + 1), (high, i)]));
    let halves = quads.map(|quad| quad.map(|(row, i)| at(row, i))).flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]);
    let triangles = halves.filter(|[a, b, c]| a != b && b != c && c != a).collect();
    Soup::new(points, triangles)
}

fn meshed(soup: &Soup, options: &Options) -> Outcome {
    Mesher::cpu().mesh(soup, options).unwrap_or_else(|error| panic!("{error}"))
}

fn faults(outcome: &Outcome) -> usize {
    outcome.meshed.faults.list.len() + outcome.meshed.differences.len()
}

/// Two cones, base on base.
fn spindle(height: f64, around: u32) -> Soup {
    turned(&[[0.0, -height], [1.0, 0.0], [0.0, height]], around)
}

#[test]
fn the_tips_of_needles_are_closed_by_faces_that_look_outward() {
    let mut before_edits = 0;
    for (height, points) in [(5.0, 150), (10.0, 200), (20.0, 120)] {
        let soup = spindle(height, 60);
        for rows in [Rows::Paper, Rows::Continuous] {
            let outcome = meshed(&soup, &Options { rows, ..Options::new(Fineness::Points(points)) });
            assert_eq!(faults(&outcome), 0, "height {height}, {points} points, {rows:?}");
            before_edits += outcome.meshed.edits.map_or(0, |edits| edits.faults_before);
            let top = outcome.meshed.mesh.points.iter().map(|[.., z]| *z).fold(0.0, f64::max);
            assert!(top > 0.999 * height, "height {height}: the tip is cut off at {top}");
        }
    }
    assert!(before_edits > 0, "tips are no matter");
}

/// A pipe with a wall.
fn pipe(wall: f64) -> Soup {
    let inner = 1.0 - wall;
    turned(&[[1.0, 0.0], [1.0, 3.0], [inner, 3.0], [inner, 0.0], [1.0, 0.0]], 64)
}

#[test]
fn a_thin_wall_has_the_vertices_that_it_needs_however_few_are_asked_for() {
    for points in [30, 150, 600] {
        let options = Options::new(Fineness::Points(points));
        let outcome = meshed(&pipe(0.01), &options);
        assert_eq!(faults(&outcome), 0, "{points} points");
        assert!(outcome.meshed.mesh.points.len() > 3 * points, "{points} points: the wall needs no more");
        let thick = meshed(&pipe(0.5), &options).meshed.mesh.points.len();
        assert!(thick < 2 * points.max(100), "{points} points: {thick} on a thick wall");
    }
    let thinnest = meshed(&pipe(1e-4), &Options::new(Fineness::Points(150)));
    assert!(faults(&thinnest) > 0, "no wall is too thin");
}

/// A flat gear of radius 1.
fn gear(teeth: u32, depth: f64, height: f64) -> Soup {
    let tooth = [(0.0, 1.0 - depth), (0.35, 1.0 - depth), (0.5, 1.0), (0.85, 1.0)];
    let angle = |tooth: u32, share: f64| TAU * (f64::from(tooth) + share) / f64::from(teeth);
    let places = (0..teeth).flat_map(|i| tooth.map(|(share, radius)| (angle(i, share), radius)));
    let outline: Vec<[f64; 2]> = places.map(|(angle, radius)| [radius * angle.cos(), radius * angle.sin()]).collect();
    let at = |height: f64| outline.iter().map(move |&[x, y]| [x, y, height]);
    let points = at(0.0).chain(at(height)).chain([[0.0; 3], [0.0, 0.0, height]]).collect();
    let count = outline.len() as u32;
    let sectors = (0..count).flat_map(|a| {
        let b = (a + 1) % count;
        [[a, b, count + b], [a, count + b, count + a], [2 * count, b, a], [2 * count + 1, count + a, count + b]]
    });
    Soup::new(points, sectors.collect())
}

#[test]
fn a_mesh_that_needs_far_more_vertices_is_made_anew_for_their_number() {
    let soup = gear(40, 0.03, 0.1);
    let mesh = |points| meshed(&soup, &Options::new(Fineness::Points(points)));
    let few = mesh(30);
    let needed = few.mosaic.wanted;
    assert_eq!(faults(&few), 0);
    assert!(needed >= 60, "{needed} vertices are wanted");
    assert_eq!(few.meshed.mesh, mesh(needed).meshed.mesh, "the mesh for 30 is not that for {needed}");
    assert_ne!(few.meshed.mesh, mesh(needed + 10).meshed.mesh, "meshes do not depend on the number");
    assert_eq!(mesh(60).mosaic.wanted, 60, "the number is raised where that is not needed");
}
