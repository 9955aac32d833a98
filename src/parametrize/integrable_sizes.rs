//! Integrable sizes: tiles whose side follows the field's turning, so that rows need not end.
//!
//! # Theory
//! Let a cross field with axes `e1`, `e2` turn at the rate `w(e)` along a direction `e`, from `e1` towards `e2`. Rows of squares
//! of side `h` need not end where `grad log h = w(e2) e1 - w(e1) e2`, which is `w` as a vector, turned back by a quarter. By
//! least squares this is one Poisson equation with the cotangent Laplacian. Its right-hand side at a vertex is minus half the
//! sum of the turning along the sides opposite to the vertex; a third of what the three turnings of a triangle do not add up
//! to is taken off each. Open boundaries are free.
//!
//! # Practice
//! At a singularity `log h` has no bound. A hyperbolic tangent keeps it within the range and leaves small values as they are.

use super::turning;
use crate::compute::{Backend, ComputeError, Link};
use crate::field::Field;
use crate::solver::{Hierarchy, Problem, Terms};
use crate::surface::{Surface, previous};
use glam::DVec3;

/// The largest distance of a chord from its feature, in mean sides.
const MISS: f64 = 0.1;
/// Iterations of the solver.
const ITERATIONS: u32 = 8;

/// The logarithm of the integrable side at each vertex over the mean side; `range` bounds the largest side over the mean, and
/// the mean over the smallest.
///
/// # Errors
/// Where the backend fails.
pub fn integrable_sizes(
    surface: &Surface,
    field: &Field,
    range: f64,
    backend: &dyn Backend,
) -> Result<Vec<f64>, ComputeError> {
    let values = equations(surface, field).solve(backend)?;
    let mut logs: Vec<f64> = values.iter().map(|z| f64::from(z[0])).collect();
    // Triangles can be too thin for the precision of the solve; sides stay equal then.
    if !logs.iter().all(|x| x.is_finite()) {
        return Ok(vec![0.0; logs.len()]);
    }
    // The solution is unique up to a constant: its mean over the area becomes zero.
    let (mut sum, mut area) = (0.0, 0.0);
    for t in 0..surface.triangle_count() {
        let own = f64::from(surface.double_area(t));
        area += own;
        sum += surface.triangles[t].iter().map(|&v| own / 3.0 * logs[v as usize]).sum::<f64>();
    }
    let limit = range.ln();
    logs.iter_mut().for_each(|x| *x = limit * ((*x - sum / area) / limit).tanh());
    Ok(logs)
}

/// Lowers sides on features so that no chord is farther from its feature than a tenth of the mean side, `side`.
pub fn limit_chord_error(surface: &Surface, side: f64, relative: &mut [f32]) {
    for curve in surface.features().curves() {
        let mut points: Vec<DVec3> = curve.vertices.iter().map(|&v| surface.points[v as usize].as_dvec3()).collect();
        let last = points.len() - 1;
        if curve.closed {
            points.pop();
        }
        for (i, &vertex) in curve.vertices[..last.max(1)].iter().enumerate() {
            let Some([before, after]) = around(&points, curve.closed, i, side / 2.0) else { continue };
            let per_side = before.angle_between(after) * side / ((before.length() + after.length()) / 2.0);
            let most = (8.0 * MISS / per_side.max(MISS)).sqrt() as f32;
            relative[vertex as usize] = relative[vertex as usize].min(most);
        }
    }
}

/// The vectors to a point of a polyline from the point that is `reach` before it, and from it to the point as far after it.
fn around(points: &[DVec3], closed: bool, at: usize, reach: f64) -> Option<[DVec3; 2]> {
    let count = points.len();
    let step = |i: usize, forward: bool| match (forward, closed) {
        (true, false) => (i + 1 < count).then_some(i + 1),
        (false, false) => i.checked_sub(1),
        (true, true) => Some((i + 1) % count),
        (false, true) => Some((i + count - 1) % count),
    };
    let vector = |forward: bool| {
        let (mut i, mut length) = (at, 0.0);
        while length < reach {
            let next = step(i, forward)?;
            length += points[i].distance(points[next]);
            i = next;
            if i == at {
                return None;
            }
        }
        Some(if forward { points[i] - points[at] } else { points[at] - points[i] })
    };
    Some([vector(false)?, vector(true)?])
}

fn equations(surface: &Surface, field: &Field) -> Hierarchy {
    let sectors = field.sectors();
    let turns = turning(field);
    let mut right_hand_side = vec![[0.0f32; 2]; surface.vertex_count()];
    for t in 0..surface.triangle_count() as u32 {
        let sides = [3 * t, 3 * t + 1, 3 * t + 2];
        let open = sides.iter().map(|&h| turns[h as usize]).sum::<f64>() / 3.0;
        for h in sides {
            right_hand_side[surface.origin(previous(h)) as usize][0] -= ((turns[h as usize] - open) / 2.0) as f32;
        }
    }
    let weight = |h: u32| sectors.edge_weight(h) as f32;
    let problem = Problem::new(right_hand_side, |v, links| {
        let own = links.len();
        let mut add = |neighbour: u32, weight: f32| match links[own..].iter_mut().find(|l| l.neighbour == neighbour) {
            Some(link) => link.weight[0] += weight,
            None => links.push(Link { neighbour, weight: [weight, 0.0] }),
        };
        for corner in sectors.of_vertex(v as u32).iter().flat_map(|&s| sectors.corners(surface, s)) {
            add(surface.target(corner), weight(corner));
            add(surface.origin(previous(corner)), weight(previous(corner)));
        }
        Terms::default()
    });
    Hierarchy::linear(problem, ITERATIONS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::FeatureOptions;
    use crate::surface::examples::Example;

    #[test]
    fn chords_of_a_hole_miss_it_by_no_more_than_allowed_and_straight_sides_are_free() {
        let soup = Example::Plate.generate(5_000);
        let surface = Surface::new(&soup, &FeatureOptions::default()).unwrap_or_else(|error| panic!("{error}"));
        // The hole's radius is a fifth of the plate's side (examples/plate.rs).
        let radius = 0.2 / surface.frame().diagonal;
        let side = radius / 2.0;
        let mut relative = vec![10.0; surface.vertex_count()];
        limit_chord_error(&surface, side, &mut relative);
        for curve in surface.features().curves() {
            for &v in &curve.vertices {
                let found = f64::from(relative[v as usize]);
                if curve.closed {
                    // A chord of length l misses an arc of radius r by l^2 / 8 r; turns are seen over a quarter of it.
                    let miss = (found * side).powi(2) / (8.0 * radius) / side;
                    assert!((miss - MISS).abs() < 0.05 * MISS, "{miss}");
                } else {
                    // At a corner it is not asked, elsewhere nothing turns.
                    assert!(found > 2.0, "{found}");
                }
            }
        }
    }
}
