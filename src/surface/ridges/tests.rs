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
    grid(48, 400, jitter, false, |u, v| {
        let [x, z] = rounded(u);
        [x, LONG * v, z]
    })
}

/// The lines through the inside of the surface that are features at this side of tiles, in model units.
fn lines(surface: Surface, side: f64, ridge: f64) -> (Surface, Vec<Vec<DVec3>>) {
    let h = (side / surface.frame().diagonal) as f32;
    let fitted = surface.fitted(&FeatureOptions { ridge, ..FeatureOptions::default() }, h);
    let place = |&v: &u32| DVec3::from(fitted.frame().to_model(fitted.point(v)));
    let inner = fitted.features().curves().iter().filter(|curve| fitted.twin(curve.half_edges[0]).is_some());
    let lines = inner.map(|curve| curve.vertices.iter().map(place).collect()).collect();
    (fitted, lines)
}

/// The largest turn between following edges that are longer than `least`, in degrees.
fn largest_turn(line: &[DVec3], least: f64) -> f64 {
    let ways: Vec<DVec3> = line.windows(2).map(|p| p[1] - p[0]).filter(|way| way.length() > least).collect();
    ways.windows(2).map(|way| way[0].angle_between(way[1]).to_degrees()).fold(0.0, f64::max)
}

#[test]
fn a_rounded_edge_is_a_ridge_where_tiles_are_large() {
    for jitter in [0.0, 0.6] {
        for side in [0.06, 0.1, 0.2] {
            let (fitted, lines) = lines(edge(jitter), side, 60.0);
            let what = format!("tiles of {side}, jitter {jitter}");
            assert_eq!(lines.len(), 1, "{what}");
            let line = &lines[0];
            let mut ends = [line[0].y, line[line.len() - 1].y];
            ends.sort_by(f64::total_cmp);
            assert!(ends[0] < 1e-6 && ends[1] > LONG - 1e-6, "{what}: from {} to {}", ends[0], ends[1]);
            let off = line.iter().map(|p| p.x.abs()).fold(0.0, f64::max);
            println!("{what}: off {off}, turn {}, {} pts", largest_turn(line, 0.0), line.len());
            let _ = fitted;
        }
        for side in [0.02, 0.028] {
            let (_, lines) = lines(edge(jitter), side, 60.0);
            println!("{side} {}", lines.len());
        }
    }
}
