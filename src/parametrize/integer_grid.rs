//! The integer grid: the points at which both coordinates are integers.

use super::Parametrization;
use super::grid_metric::{GridMetric, LinearPiece};
use crate::field::Field;
use crate::surface::Surface;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Triangles whose image is thinner than this, as a share of the squares of its sides, or inverted hold no grid point.
const THIN: f64 = 0.02;
/// The same for rows that pass over the whole surface: only images without area hold no grid point.
const NO_AREA: f64 = 1e-9;
/// A point outside of a triangle by less than this share of its height belongs to it too: none is lost on an edge.
const SLACK: f64 = 1e-3;

/// Grid points of rows that pass over the whole surface are one where they lie within this of each other, in tile sides.
pub const DOUBLE: f32 = 0.2;

/// A point of the integer grid on the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridPoint {
    /// Its triangle.
    pub triangle: u32,
    /// Its place, in unit-sized coordinates.
    pub(crate) position: Vec3,
    /// The side of the tile to come, in unit-sized coordinates.
    pub side: f32,
}

impl GridPoint {
    /// Its place, in unit-sized coordinates.
    pub fn place(&self) -> [f32; 3] {
        self.position.into()
    }
}

/// The points where two rows cross, tiles being of the field's sizes at the scale `h`. A point on an edge is found in each of
/// the edge's triangles.
pub fn integer_grid(surface: &Surface, field: &Field, parametrization: &Parametrization, h: f32) -> Vec<GridPoint> {
    let thin = thin(field);
    let points = |t: u32| {
        let sides = [parametrization.step(3 * t), parametrization.step_at_end(3 * t + 2).map(|x| -x)];
        let corners = surface.corners(t as usize).map(|p| p.as_dvec3());
        let found = crossings(parametrization.at(3 * t), sides, thin).into_iter();
        found.map(move |shares| {
            let position = place(corners, shares).as_vec3();
            GridPoint { triangle: t, position, side: h * field.sizes().at(surface, t, position) }
        })
    };
    (0..surface.triangle_count() as u32).into_par_iter().flat_map_iter(points).collect()
}

/// As [`integer_grid`], for rows that pass over the whole surface: the points on cones first, the others also in the
/// triangles that hold cones, none on features. Each has the side that the rows have there.
///
/// Where the coordinates are folded, a crossing lies in two upright triangles and in an inverted one between them: a point of
/// an inverted triangle takes the nearest upright one away.
pub fn continuous_integer_grid(
    surface: &Surface,
    field: &Field,
    parametrization: &Parametrization,
    metric: &GridMetric,
    h: f32,
) -> Vec<GridPoint> {
    let on_cones = metric.cones.iter().filter(|placed| placed.is_tile).map(|placed| {
        let (triangle, position) = (placed.cone.triangle, placed.position.as_vec3());
        GridPoint { triangle, position, side: h * field.sizes().at(surface, triangle, position) }
    });
    let points_of = |triangle: u32, piece: &LinearPiece| {
        let origin = parametrization.at(piece.corner);
        let [p, q] = piece.sides;
        let area = p[0] * q[1] - p[1] * q[0];
        let [a, b, c] = piece.points;
        let is_inverted = area < 0.0;
        let sides = if is_inverted { [q, p] } else { [p, q] };
        let side = ((b - a).cross(c - a).length() / area.abs().max(f64::MIN_POSITIVE)).sqrt() as f32;
        let off_features = |[x, y]: &[f64; 2]| {
            let far = [*y, 1.0 - x - y, *x];
            let near = [1.0 - x - y, *x, *y];
            far.iter().zip(piece.on_feature).all(|(&far, on_feature)| !on_feature || far > 2.0 * SLACK)
                && near.iter().zip(piece.has_feature).all(|(&near, on)| !on || near < 1.0 - 2.0 * SLACK)
        };
        let in_order = move |[x, y]: [f64; 2]| if is_inverted { [y, x] } else { [x, y] };
        let found = crossings(origin, sides, NO_AREA).into_iter().map(in_order).filter(off_features);
        let point =
            |shares| (GridPoint { triangle, position: place(piece.points, shares).as_vec3(), side }, is_inverted);
        found.map(point).collect::<Vec<_>>()
    };
    let elsewhere = (0..surface.triangle_count() as u32)
        .into_par_iter()
        .flat_map_iter(|t| metric.pieces(surface, t).into_iter().flat_map(move |piece| points_of(t, &piece)));
    let (inverted, upright): (Vec<_>, Vec<_>) = elsewhere.partition(|&(_, is_inverted)| is_inverted);
    let mut points: Vec<GridPoint> = on_cones.chain(upright.into_iter().map(|(point, _)| point)).collect();
    let count = points.len();
    let mut is_left = vec![true; count];
    let on_cones = metric.cones.iter().filter(|placed| placed.is_tile).count();
    for (other, _) in inverted {
        let distance = |i: &usize| points[*i].position.distance_squared(other.position);
        let nearest = (on_cones..count).filter(|&i| is_left[i]).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        if let Some(i) = nearest.filter(|i| distance(i) < h * h) {
            is_left[i] = false;
        }
    }
    let mut left = is_left.iter();
    points.retain(|_| left.next().copied().unwrap_or(true));
    points
}

/// The least image of a triangle that holds grid points, stretched tiles making all images thinner.
fn thin(field: &Field) -> f64 {
    THIN / field.stretch().map_or(1.0, |stretch| stretch.report().aspect)
}

fn place([a, b, c]: [DVec3; 3], [to_b, to_c]: [f64; 2]) -> DVec3 {
    a + (b - a) * to_b + (c - a) * to_c
}

/// The points of a triangle at which both coordinates are integers, in shares of its first and last side. The coordinates are
/// `origin` at its first corner and grow by `sides` along those two sides.
fn crossings(origin: [f64; 2], [p, q]: [[f64; 2]; 2], thin: f64) -> Vec<[f64; 2]> {
    let mut found = Vec::new();
    let area = p[0] * q[1] - p[1] * q[0];
    if area <= thin * (p[0] * p[0] + p[1] * p[1] + q[0] * q[0] + q[1] * q[1]) {
        return found;
    }
    let integers = |k: usize| {
        let ends = [0.0, p[k], q[k]].map(|x| origin[k] + x);
        let [low, high] = [f64::min, f64::max].map(|pick| ends.into_iter().reduce(pick).unwrap_or(0.0));
        let slack = SLACK * (high - low);
        (low - slack).ceil() as i64..=(high + slack).floor() as i64
    };
    for (i, j) in integers(0).flat_map(|i| integers(1).map(move |j| (i, j))) {
        let [x, y] = [i as f64 - origin[0], j as f64 - origin[1]];
        let [b, c] = [(x * q[1] - y * q[0]) / area, (p[0] * y - p[1] * x) / area];
        if b >= -SLACK && c >= -SLACK && b + c <= 1.0 + SLACK {
            let inside = [b.clamp(0.0, 1.0), c.clamp(0.0, 1.0)];
            let over = (inside[0] + inside[1]).max(1.0);
            found.push(inside.map(|x| x / over));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crossings_lie_at_integers_and_none_is_missed() {
        // A right triangle of 3 by 3 tiles, its first corner just off a crossing.
        let origin = [0.9, 4.9];
        let found = crossings(origin, [[3.0, 0.0], [0.0, 3.0]], THIN);
        let mut places: Vec<[i64; 2]> = Vec::new();
        for [b, c] in found {
            let place = [origin[0] + 3.0 * b, origin[1] + 3.0 * c];
            assert!(place.iter().all(|x| (x - x.round()).abs() < 1e-9), "{place:?}");
            places.push(place.map(|x| x.round() as i64));
        }
        places.sort_unstable();
        assert_eq!(places, [[1, 5], [1, 6], [1, 7], [2, 5], [2, 6], [3, 5]]);
    }

    #[test]
    fn a_crossing_on_an_edge_belongs_to_both_sides_and_a_turned_triangle_holds_none() {
        let sides = [[1.0, -0.5], [1.0, 0.5]];
        assert_eq!(crossings([0.0, 0.0], sides, THIN).len(), 2, "the first corner and the middle of the far side");
        assert_eq!(crossings([1.0, 0.0], [[-1.0, -0.5], [-1.0, 0.5]], THIN).len(), 0, "turned over");
        assert_eq!(crossings([0.3, 0.3], [[0.4, 0.0], [0.0, 0.4]], THIN).len(), 0, "between crossings");
    }
}
