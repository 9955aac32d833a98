//! Edges that the user names, and what was mended: both by their places.

mod common;

use common::surfaces::{example, flat};
use glam::DVec3;
use quadmosaic::surface::{Ends, FeatureOptions, NamedEdge, Places, Soup, Surface, SurfaceError};

fn edge(ends: Ends) -> NamedEdge {
    NamedEdge { ends, name: "edges.txt, line 3".to_owned() }
}

fn with(soup: &Soup, edges: &[NamedEdge]) -> Result<Surface, SurfaceError> {
    let options = FeatureOptions::default();
    Surface::new(soup, &options).unwrap_or_else(|error| panic!("{error}")).with_edges(soup, edges, &options)
}

/// The places along the features that are no boundary of the unit square, in model units, in order of x and y.
fn inner(surface: &Surface) -> Vec<[i64; 2]> {
    let mut places: Vec<[i64; 2]> = Vec::new();
    for curve in surface.features().curves() {
        let along = curve.vertices.iter().map(|&v| surface.frame().to_model(surface.point(v)));
        let along: Vec<[i64; 2]> = along.map(|[x, y, _]| [x, y].map(|x| (x * 10.0).round() as i64)).collect();
        let on_side = |k: usize, at: i64| along.iter().all(|p| p[k] == at);
        if !(0..2).any(|k| on_side(k, 0) || on_side(k, 10)) {
            places.extend(along);
        }
    }
    places.sort_unstable();
    places
}

/// The unit square in squares of 0.1: point `11 j + i` is at (0.1 i, 0.1 j).
fn square() -> Soup {
    flat(10, 10, 0.1)
}

#[test]
fn an_edge_is_named_by_its_ends() {
    let soup = square();
    assert_eq!(inner(&with(&soup, &[]).expect("a square")), [[0; 2]; 0]);
    let place = |i: usize, j: usize| soup.points[11 * j + i];
    let number = |i: u32, j: u32| 11 * j + i;
    for ends in [
        Ends::Vertices([number(4, 5), number(5, 5)]),
        Ends::Vertices([number(5, 5), number(4, 5)]),
        Ends::Points([place(4, 5), place(5, 5)]),
        // Within 1e-5 of the diagonal.
        Ends::Points([[0.4 + 1.3e-5, 0.5, 0.0], [0.5, 0.5, 1.3e-5]]),
    ] {
        let named = with(&soup, &[edge(ends)]).unwrap_or_else(|error| panic!("{ends:?}: {error}"));
        assert_eq!(inner(&named), [[4, 5], [5, 5]], "{ends:?}");
    }
}

#[test]
fn a_straight_line_of_edges_is_named_by_its_ends() {
    let soup = square();
    let line = edge(Ends::Points([[0.2, 0.3, 0.0], [0.2, 0.8, 0.0]]));
    let named = with(&soup, std::slice::from_ref(&line)).expect("a line");
    assert_eq!(inner(&named), (3..=8).map(|j| [2, j]).collect::<Vec<_>>());
    // Two lines cross in a corner.
    let other = edge(Ends::Points([[0.1, 0.5, 0.0], [0.7, 0.5, 0.0]]));
    let named = with(&soup, &[line, other]).expect("two lines");
    assert_eq!(named.features().corners().count(), 4 + 4 + 1);
}

#[test]
fn edges_that_are_not_there_are_refused_by_name() {
    let soup = square();
    let refusal = |ends: Ends| with(&soup, &[edge(ends)]).map(|_| ()).expect_err("it is no edge");
    let name = "edges.txt, line 3".to_owned();
    assert_eq!(
        refusal(Ends::Vertices([3, 121])),
        SurfaceError::NoSuchVertex { name: name.clone(), number: 122 },
        "numbers are counted from 1 where people read them"
    );
    for off in [[0.45, 0.5, 0.0], [0.5, 0.5, 1.6e-5], [7.0, 0.0, 0.0]] {
        let error = refusal(Ends::Points([[0.1, 0.1, 0.0], off]));
        assert_eq!(error, SurfaceError::NoVertexAt { name: name.clone(), at: off });
        assert!(error.to_string().starts_with("edges.txt, line 3: the surface has no vertex at ("), "{error}");
    }
    // Slopes of 1 to 2 would take a way 18 % longer or more; the last has no length.
    for (from, to) in [([0.1, 0.1, 0.0], [0.5, 0.3, 0.0]), ([0.1, 0.1, 0.0], [0.1, 0.1, 0.0])] {
        let error = refusal(Ends::Points([from, to]));
        assert_eq!(error, SurfaceError::NoEdges { name: name.clone(), from, to });
        assert!(error.to_string().contains("no straight line of edges, joins"), "{error}");
    }
    // A point that no triangle uses is no vertex of the surface.
    let mut more = soup.clone();
    more.points.push([0.55, 0.55, 0.0]);
    let error = with(&more, &[edge(Ends::Vertices([0, 121]))]).map(|_| ()).expect_err("it is no edge");
    assert_eq!(error, SurfaceError::NoVertexAt { name, at: [0.55, 0.55, 0.0] });
}

#[test]
fn named_edges_are_there_at_any_size_of_tiles() {
    let soup = square();
    let named = with(&soup, &[edge(Ends::Vertices([60, 61]))]).expect("an edge");
    for h in [0.01, 0.1, 1.0] {
        assert_eq!(inner(&named.clone().fitted(&FeatureOptions::default(), h)), [[5, 5], [6, 5]], "{h}");
    }
}

/// The places are these, up to what f32 loses on the way.
fn at(repair: &Places, places: &[[f64; 3]], size: f64) -> bool {
    repair.count == places.len()
        && repair.at.iter().zip(places).all(|(a, b)| DVec3::from(*a).distance(DVec3::from(*b)) < 1e-6 * size)
}

#[test]
fn repairs_have_their_places_in_model_units() {
    // A sphere of radius 100 about (1000, 0, 0), each point of which is a place of its own.
    let mut soup = example("sphere", 1_000);
    for p in &mut soup.points {
        *p = [100.0 * p[0] + 1000.0, 100.0 * p[1], 100.0 * p[2]];
    }
    let size = 346.0;
    let whole = Surface::new(&soup, &FeatureOptions::default()).expect("a sphere");
    assert_eq!(*whole.repairs(), Default::default());
    let place = |index: u32| soup.points[index as usize];
    let [a, b, c] = soup.triangles[40];
    let [d, e, f] = soup.triangles[300];
    let mut broken = soup.clone();
    let first = broken.points.len() as u32;
    broken.points.extend([[1.0, 2.0, 3.0], place(e)]);
    broken.triangles[300] = [d, first + 1, f];
    broken.triangles[40] = [a, c, b];
    broken.triangles.extend([[d, e, d], [b, c, a]]);
    // A speck, and a tetrahedron that touches the sphere from outside in one point.
    let outward = |p: [f64; 3], by: f64| [1000.0 + by * (p[0] - 1000.0), by * p[1], by * p[2]];
    let tip = place(soup.triangles[500][0]);
    let far = outward(tip, 1.2);
    broken.points.extend([tip, far, [far[0] + 5.0, far[1], far[2]], [far[0], far[1] + 5.0, far[2] + 5.0]]);
    broken.points.extend([[1000.0, 0.0, 0.0], [1000.0, 1e-4, 0.0], [1000.0, 0.0, 1e-4]]);
    let tetrahedron = [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]].map(|t| t.map(|v| first + 2 + v));
    broken.triangles.extend(tetrahedron);
    broken.triangles.push([first + 6, first + 7, first + 8]);

    let repairs = Surface::new(&broken, &FeatureOptions::default()).expect("a sphere").repairs().clone();
    assert!(at(&repairs.unused_points, &[[1.0, 2.0, 3.0]], size), "{:?}", repairs.unused_points);
    assert!(at(&repairs.welded_points, &[place(e), tip], size), "{:?}", repairs.welded_points);
    assert!(at(&repairs.degenerate_triangles, &[place(d)], size), "{:?}", repairs.degenerate_triangles);
    assert!(at(&repairs.duplicate_triangles, &[place(b)], size), "{:?}", repairs.duplicate_triangles);
    assert!(at(&repairs.dropped_specks, &[[1000.0, 0.0, 0.0]], size), "{:?}", repairs.dropped_specks);
    assert!(at(&repairs.joined_vertices, &[tip], size), "{:?}", repairs.joined_vertices);
    assert!(repairs.flipped_triangles.at.iter().any(|p| DVec3::from(*p).distance(place(a).into()) < 1e-6 * size));
    assert!(!at(&repairs.joined_vertices, &[outward(tip, 1.001)], size), "another place is told apart");
}

#[test]
fn ten_places_of_a_repair_are_told_and_all_are_counted() {
    let mut soup = square();
    soup.points.extend((0..25).map(|i| [f64::from(i), 7.0, 0.0]));
    let repairs = Surface::new(&soup, &FeatureOptions::default()).expect("a square").repairs().clone();
    assert_eq!(repairs.unused_points.count, 25);
    assert_eq!(repairs.unused_points.at, (0..10).map(|i| [f64::from(i), 7.0, 0.0]).collect::<Vec<_>>());
}

#[test]
fn a_flipped_cap_and_a_seam_are_where_they_should_be() {
    // Two triangles over one long edge, and a cap on its middle; all at a distance.
    let soup = Soup {
        points: vec![[50.0, 0.0, 0.0], [54.0, 0.0, 0.0], [52.0, 1e-7, 0.0], [52.0, 3.0, 0.0], [52.0, -3.0, 0.0]],
        triangles: vec![[0, 1, 2], [1, 0, 4], [0, 2, 3], [2, 1, 3]],
        ..Soup::default()
    };
    let mended = Surface::new(&soup, &FeatureOptions::default()).expect("a kite");
    assert!(at(&mended.repairs().flipped_caps, &[[52.0, 0.0, 0.0]], 8.0), "{:?}", mended.repairs());
    assert!((mended.area() * mended.frame().diagonal.powi(2) - 12.0).abs() < 1e-5);
    let mut page = soup.clone();
    page.points[2][1] = 0.1;
    page.points.push([52.0, 0.0, 3.0]);
    page.triangles.push([0, 1, 5]);
    let joined = Surface::new(&page, &FeatureOptions::default()).expect("three pages");
    assert!(at(&joined.repairs().joined_edges, &[[52.0, 0.0, 0.0]], 8.0), "{:?}", joined.repairs());
    assert_eq!(joined.repairs().flipped_caps.count, 0);
}
