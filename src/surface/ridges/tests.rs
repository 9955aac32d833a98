use super::*;
use crate::surface::examples::Example;
use crate::surface::{FeatureOptions, Soup};

const RADIUS: f64 = 0.03;
const LONG: f64 = 4.0;

/// A surface of `columns` by `rows` cells, its points moved within it a little where asked; closed round its rows where asked.
fn grid(columns: usize, rows: usize, jitter: f64, closed: bool, place: impl Fn(f64, f64) -> [f64; 3]) -> Surface {
    let mut state = 1u64;
    let mut random = move || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 40) as f64 / (1u64 << 24) as f64 - 0.5
    };
    let height = if closed { rows } else { rows + 1 };
    let at = |i: usize, j: usize| (j % height * (columns + 1) + i) as u32;
    let mut soup = Soup::default();
    for j in 0..height {
        for i in 0..=columns {
            let free = |k: usize, count: usize| if k == 0 || k == count { 0.0 } else { jitter };
            let (u, v) = (i as f64 + free(i, columns) * random(), j as f64 + free(j, rows) * random());
            soup.points.push(place(u / columns as f64, v / rows as f64));
        }
    }
    for (i, j) in (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j))) {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        soup.triangles.extend(if (i + j) % 2 == 0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] });
    }
    Surface::new(&soup, &FeatureOptions::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// Two flanks with a round between that turns by a right angle: `u` runs over it with half of its cells on the round.
fn rounded(u: f64) -> [f64; 2] {
    let angle = std::f64::consts::FRAC_PI_2 * (2.0 * (u - 0.25)).clamp(0.0, 1.0) - std::f64::consts::FRAC_PI_4;
    let flank = 4.0 * (0.25 - u).max(u - 0.75).max(0.0);
    let (s, c) = angle.sin_cos();
    [RADIUS * s + c * flank * angle.signum(), RADIUS * c - s.abs() * flank]
}

/// The rounded edge along y, the round's middle over x = 0.
fn edge(jitter: f64) -> Surface {
    grid(24, 400, jitter, false, |u, v| {
        let [x, z] = rounded(u);
        [x, LONG * v, z]
    })
}

/// A ring wall of radius 2 whose rim is rounded.
fn rim(jitter: f64) -> Surface {
    grid(24, 1_200, jitter, true, |u, v| {
        let [x, z] = rounded(u);
        let (s, c) = (std::f64::consts::TAU * v).sin_cos();
        [(2.0 + x) * c, (2.0 + x) * s, z]
    })
}

/// The surface with the features for tiles of this side, in model units.
fn fitted(surface: &Surface, side: f64, ridge: f64) -> Surface {
    let h = (side / surface.frame().diagonal) as f32;
    surface.clone().fitted(&FeatureOptions { ridge, ..FeatureOptions::default() }, h)
}

/// The features through the inside of the surface: whether each is closed, and its places in model units.
fn lines(surface: &Surface) -> Vec<(bool, Vec<DVec3>)> {
    let place = |&v: &u32| DVec3::from(surface.frame().to_model(surface.point(v)));
    let inner = surface.features().curves().iter().filter(|curve| surface.twin(curve.half_edges[0]).is_some());
    inner.map(|curve| (curve.closed, curve.vertices.iter().map(place).collect())).collect()
}

/// The largest turn between following edges, in degrees.
fn largest_turn(line: &[DVec3]) -> f64 {
    let ways: Vec<DVec3> = line.windows(2).map(|p| p[1] - p[0]).collect();
    ways.windows(2).map(|way| way[0].angle_between(way[1]).to_degrees()).fold(0.0, f64::max)
}

#[test]
fn a_rounded_edge_is_a_ridge_where_tiles_are_large() {
    for jitter in [0.0, 0.15] {
        let surface = edge(jitter);
        for side in [0.04, 0.06] {
            let ridged = fitted(&surface, side, 60.0);
            let what = format!("tiles of {side}, jitter {jitter}");
            let [(false, line)] = &lines(&ridged)[..] else { panic!("{what}: {} lines", lines(&ridged).len()) };
            let mut ends = [line[0].y, line[line.len() - 1].y];
            ends.sort_by(f64::total_cmp);
            assert!(ends[0] < 1e-6 && ends[1] > LONG - 1e-6, "{what}: from {} to {}", ends[0], ends[1]);
            let off = line.iter().map(|p| p.x.abs()).fold(0.0, f64::max);
            assert!(off < 0.1 * side, "{what}: {off} off the middle of the round");
            assert!(largest_turn(line) < 10.0, "{what}: turns by {}", largest_turn(line));
            // The shape is as it was.
            assert!((ridged.area() / surface.area() - 1.0).abs() < 1e-6, "{what}");
            assert!((ridged.boundary_length() / surface.boundary_length() - 1.0).abs() < 1e-6, "{what}");
            // The line was no line of edges: triangles were cut along it.
            assert!(ridged.triangle_count() > surface.triangle_count() || jitter == 0.0, "{what}");
        }
    }
}

#[test]
fn a_rounded_edge_is_none_where_tiles_are_small_or_may_turn_more() {
    let surface = edge(0.15);
    // The round turns by 60 degrees within 0.031.
    for (side, ridge) in [(0.02, 60.0), (0.028, 60.0), (0.06, 100.0), (0.06, 180.0)] {
        let plain = fitted(&surface, side, ridge);
        assert_eq!(lines(&plain).len(), 0, "tiles of {side}, limit {ridge}");
        assert_eq!(plain.points, surface.points, "tiles of {side}, limit {ridge}");
        assert_eq!(plain.features().curves(), surface.features().curves(), "tiles of {side}, limit {ridge}");
    }
}

#[test]
fn a_round_rim_is_one_closed_ridge() {
    for jitter in [0.0, 0.1, 0.2] {
        let ridged = fitted(&rim(jitter), 0.05, 60.0);
        let found = lines(&ridged);
        let [(true, line)] = &found[..] else { panic!("jitter {jitter}: {} lines", found.len()) };
        let off = line.iter().map(|p| (p.x.hypot(p.y) - 2.0).abs()).fold(0.0, f64::max);
        assert!(off < 0.1 * 0.05, "jitter {jitter}: {off} off the middle of the round");
        assert!(largest_turn(line) < 15.0, "jitter {jitter}: turns by {}", largest_turn(line));
        assert_eq!(ridged.features().corners().count(), 0, "jitter {jitter}");
        assert_eq!(lines(&fitted(&rim(jitter), 0.02, 60.0)).len(), 0, "jitter {jitter}");
    }
}

/// A band of ten triangles round the z axis, and the half-edges across it in order.
fn band() -> (Surface, Vec<u32>) {
    let at = |i: u32| (std::f64::consts::TAU * f64::from(i) / 10.0).sin_cos();
    let points = (0..10).map(|i| [at(i).1, at(i).0, f64::from(i % 2)]).collect();
    let triangles = (0..10).map(|i| [i, (i + 1 + i % 2) % 10, (i + 2 - i % 2) % 10]).collect();
    let options = FeatureOptions { crease: 180.0, corner: 180.0, ..FeatureOptions::default() };
    let surface = Surface::new(&Soup { points, triangles, ..Soup::default() }, &options).expect("a band");
    let number = |v: u32| {
        let place = DVec3::from(surface.frame().to_model(surface.point(v)));
        (place.y.atan2(place.x) * 10.0 / std::f64::consts::TAU).round().rem_euclid(10.0) as u32
    };
    let across = |i: u32| {
        let joins = |&h: &u32| [surface.origin(h), surface.target(h)].map(number) == [i, (i + 1) % 10];
        (0..30).find(joins).expect("an edge across the band")
    };
    let edges = (0..10).map(across).collect();
    (surface, edges)
}

#[test]
fn a_closed_line_stays_closed_where_it_is_put_on_vertices() {
    let (surface, edges) = band();
    let places = |share: &dyn Fn(usize) -> f64| -> Vec<EdgePoint> {
        let mut line: Vec<EdgePoint> = (0..).zip(&edges).map(|(k, &h)| EdgePoint::Edge(h, share(k))).collect();
        line.push(line[0]);
        line
    };
    assert_eq!(snapped(&surface, places(&|_| 0.5)), places(&|_| 0.5));
    for (edge, &across) in edges.iter().enumerate() {
        for (end, share) in [(0, 0.01), (1, 0.99)] {
            let line = snapped(&surface, places(&|k| if k == edge { share } else { 0.5 }));
            // Two of the edges across the band meet at each vertex; the line passes it once.
            let vertex = [surface.origin(across), surface.target(across)][end];
            assert_eq!(line.first(), line.last(), "edge {edge}, end {end}: {line:?}");
            assert_eq!(line.len(), 10, "edge {edge}, end {end}: {line:?}");
            assert!(line.contains(&EdgePoint::Vertex(vertex)), "edge {edge}, end {end}");
            let beside =
                |pair: &[EdgePoint]| is_beside(&surface, pair[0], pair[1]) || is_beside(&surface, pair[1], pair[0]);
            assert!(!line.windows(2).any(beside), "edge {edge}, end {end}: {line:?}");
        }
    }
    // A line that is not closed keeps its ends.
    let open = snapped(&surface, places(&|k| if k == 9 { 0.99 } else { 0.5 })[..10].to_vec());
    assert!(open.first() != open.last() && open.len() == 10, "{open:?}");
}

/// The wing, in model units, with the features for so many tiles.
fn wing(triangles: usize, points: usize, ridge: f64) -> Surface {
    let soup = "m6".parse::<Example>().expect("an example").generate(triangles);
    let surface = Surface::new(&soup, &FeatureOptions::default()).unwrap_or_else(|error| panic!("{error}"));
    let h = (surface.area() / points as f64).sqrt() as f32;
    surface.fitted(&FeatureOptions { ridge, ..FeatureOptions::default() }, h)
}

#[test]
fn the_leading_edge_of_the_wing_is_one_ridge() {
    for triangles in [10_000, 20_000, 50_000] {
        let at_edge = |surface: &Surface| -> Vec<Vec<DVec3>> {
            // The trailing edge is a crease, and its ends are further back.
            lines(surface).into_iter().map(|line| line.1).filter(|line| line.iter().any(|p| p.x < 0.6)).collect()
        };
        let found = at_edge(&wing(triangles, 6_000, 60.0));
        let [line] = &found[..] else { panic!("{triangles} triangles: {} lines", found.len()) };
        let (low, high) = (line[0].min(line[line.len() - 1]), line[0].max(line[line.len() - 1]));
        assert!(low.length() < 1e-3, "{triangles} triangles: the root's nose is {low}");
        assert!(high.y > 1.19, "{triangles} triangles: it ends at {high}");
        assert!(largest_turn(line) < 35.0, "{triangles} triangles: it turns by {}", largest_turn(line));
        assert!(at_edge(&wing(triangles, 6_000, 180.0)).is_empty(), "{triangles} triangles");
    }
    let fine = |ridge: f64| wing(100_000, 600_000, ridge);
    assert_eq!(fine(60.0).features().curves(), fine(180.0).features().curves());
}
