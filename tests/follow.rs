//! Vertices on features go to where edges follow them best.

#[path = "common/plate.rs"]
mod plate;

use plate::{at, grid, plate};
use quadmosaic::mesh::follow::follow;
use quadmosaic::mesh::smooth::Smoothed;
use quadmosaic::mesh::{Mesh, Metric};
use quadmosaic::surface::{FeatureOptions, Soup, Surface};

/// A plate of width 4 and height 2 whose upper side bends at `bend` in its middle: too little for a corner.
fn roof(bend: f64) -> Surface {
    let points = vec![[0.0; 3], [4.0, 0.0, 0.0], [4.0, 2.0, 0.0], [2.0, bend, 0.0], [0.0, 2.0, 0.0], [2.0, 0.0, 0.0]];
    let triangles = vec![[0, 5, 4], [5, 3, 4], [5, 1, 3], [1, 2, 3]];
    Surface::new(&Soup { points, triangles, ..Soup::default() }, &FeatureOptions::default()).unwrap()
}

/// One row of three quads under the upper side, whose two inner vertices there lie on both sides of the bend.
fn row(surface: &Surface, bend: f64) -> Smoothed {
    let upper = |x: f64| 2.0 + (bend - 2.0) * (1.0 - (x - 2.0).abs() / 2.0);
    let xs = [0.0, 1.3, 2.7, 4.0];
    let places = xs.map(|x| [x, 0.0]).into_iter().chain(xs.map(|x| [x, upper(x)]));
    let mut mesh = Mesh::new(places.map(|[x, y]| surface.frame().to_unit([x, y, 0.0])).collect());
    (0..3).for_each(|k| mesh.push_face(&[k, k + 1, k + 5, k + 4]));
    Smoothed { below: vec![None; 8], mesh }
}

#[test]
fn one_of_two_vertices_goes_to_the_bend_between_them() {
    let surface = roof(2.7);
    let before = row(&surface, 2.7);
    let after = follow(&Metric::default(), &surface, &before);
    let model = |v: usize| surface.frame().to_model(after.mesh.points[v]);
    let nearest = [5, 6].map(|v| (model(v)[0] - 2.0).abs()).into_iter().fold(f64::INFINITY, f64::min);
    assert!(nearest < 0.15, "{:?} {:?}", model(5), model(6));
    for v in [5, 6] {
        let [x, y, _] = model(v);
        assert!((y - 2.7 + 0.35 * (x - 2.0).abs()).abs() < 1e-6, "on the feature");
    }
    let ends = [0, 3, 4, 7];
    assert!(ends.iter().all(|&v| after.mesh.points[v] == before.mesh.points[v]), "corners stay");
    assert!(after.mesh.faces().eq(before.mesh.faces()));
}

#[test]
fn where_edges_follow_features_nothing_moves() {
    let surface = roof(2.05);
    let flat = row(&surface, 2.05);
    assert_eq!(follow(&Metric::default(), &surface, &flat), flat, "the bend is too small");
    let surface = plate();
    let uneven = grid(&surface, &[(at(2, 0), [1.2, 0.0])]);
    assert_eq!(follow(&Metric::default(), &surface, &uneven), uneven, "straight");
}
