//! Triangulates single polygons by ear clipping, so that concave faces of a file keep their outline.

use glam::{DVec2, DVec3};

/// What counts as zero when the polygon's extent is one: some thousand roundings.
const TINY: f64 = 1e-12;

/// Splits a polygon with `corners.len()` >= 3 corners into `corners.len() - 2` triangles of its corners' places, oriented
/// as the polygon is. Works in the plane the polygon fits best (Newell's normal); a polygon that is no simple one there
/// still gives that many triangles, some of them degenerate or folded.
pub fn triangulate(corners: &[DVec3]) -> Vec<[usize; 3]> {
    let Some(flat) = (corners.len() > 3).then(|| flattened(corners)).flatten() else {
        return (2..corners.len()).map(|place| [0, place - 1, place]).collect();
    };
    let mut rest = Rest::new(flat);
    let mut triangles = Vec::with_capacity(corners.len() - 2);
    while triangles.len() + 2 < corners.len() {
        triangles.push(rest.clip());
    }
    triangles
}

/// The corners in the best plane, counter-clockwise, with extent one; none if the polygon has no area.
fn flattened(corners: &[DVec3]) -> Option<Vec<DVec2>> {
    let origin = corners[0];
    let extent = corners.iter().map(|corner| (*corner - origin).abs().max_element()).fold(0.0, f64::max);
    let local: Vec<_> = corners.iter().map(|corner| (*corner - origin) / extent).collect();
    let next = local.iter().cycle().skip(1);
    let normal: DVec3 = local.iter().zip(next).map(|(a, b)| a.cross(*b)).sum();
    if normal.is_nan() || normal.length() < TINY {
        return None;
    }
    let normal = normal.normalize();
    let along = normal.any_orthonormal_vector();
    let across = normal.cross(along);
    Some(local.iter().map(|point| DVec2::new(point.dot(along), point.dot(across))).collect())
}

/// What is left of the polygon while ears are clipped.
struct Rest {
    points: Vec<DVec2>,
    /// Places of the corners that are left, in order.
    places: Vec<usize>,
    /// How well shaped the ear at each of `places` is; none where there is no ear.
    ears: Vec<Option<f64>>,
    /// No search for ears was in vain yet, as it never is in a simple polygon.
    simple: bool,
}

impl Rest {
    fn new(points: Vec<DVec2>) -> Self {
        let places = (0..points.len()).collect();
        let mut rest = Self { points, places, ears: Vec::new(), simple: true };
        rest.find_ears();
        rest
    }

    fn find_ears(&mut self) {
        self.ears = (0..self.places.len()).map(|slot| self.ear(slot)).collect();
    }

    /// Takes the best shaped ear off.
    fn clip(&mut self) -> [usize; 3] {
        let best = |ears: &[Option<f64>]| {
            let known = ears.iter().enumerate().filter_map(|(slot, ear)| ear.map(|shape| (slot, shape)));
            known.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(slot, _)| slot)
        };
        let mut slot = best(&self.ears);
        if slot.is_none() && self.simple {
            // Clipping elsewhere may have freed ears that were covered before.
            self.find_ears();
            slot = best(&self.ears);
            self.simple = slot.is_some();
        }
        // Without any ear the polygon is not simple: go on with the most convex corner.
        let slot = slot.unwrap_or_else(|| {
            let turn = |slot: &usize| self.turn(self.around(*slot));
            (0..self.places.len()).max_by(|a, b| turn(a).total_cmp(&turn(b))).unwrap_or(0)
        });
        let triangle = self.around(slot);
        self.places.remove(slot);
        self.ears.remove(slot);
        let count = self.places.len();
        for neighbour in [(slot + count - 1) % count, slot % count] {
            self.ears[neighbour] = self.ear(neighbour);
        }
        triangle
    }

    /// A corner between its neighbours.
    fn around(&self, slot: usize) -> [usize; 3] {
        let count = self.places.len();
        [(slot + count - 1) % count, slot, (slot + 1) % count].map(|slot| self.places[slot])
    }

    /// Twice the signed area.
    fn turn(&self, [a, b, c]: [usize; 3]) -> f64 {
        (self.points[b] - self.points[a]).perp_dot(self.points[c] - self.points[a])
    }

    /// Twice the area of the ear over its longest side squared, if the corner is one: convex, and no other corner in it.
    fn ear(&self, slot: usize) -> Option<f64> {
        let triangle = self.around(slot);
        let doubled_area = self.turn(triangle);
        if doubled_area <= TINY {
            return None;
        }
        let [a, b, c] = triangle.map(|place| self.points[place]);
        let covers = |point: DVec2| {
            // Corners at the same point, as where a slit leads to a hole, do not cover each other.
            point != a
                && point != b
                && point != c
                && [(a, b), (b, c), (c, a)].iter().all(|(from, to)| (to - from).perp_dot(point - from) >= -TINY)
        };
        if self.places.iter().any(|&place| covers(self.points[place])) {
            return None;
        }
        let longest = [a.distance_squared(b), b.distance_squared(c), c.distance_squared(a)];
        Some(doubled_area / longest.into_iter().fold(0.0, f64::max))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sum of the areas and smallest signed area, seen along `normal`.
    fn areas(corners: &[DVec3], triangles: &[[usize; 3]], normal: DVec3) -> (f64, f64) {
        let area = |triangle: &[usize; 3]| {
            let [a, b, c] = triangle.map(|place| corners[place]);
            0.5 * (b - a).cross(c - a).dot(normal)
        };
        triangles.iter().map(area).fold((0.0, f64::INFINITY), |(sum, least), area| (sum + area, least.min(area)))
    }

    fn polygon(corners: &[[f64; 2]]) -> Vec<DVec3> {
        corners.iter().map(|&[x, y]| DVec3::new(x, y, 0.0)).collect()
    }

    #[test]
    fn outlines_are_kept_from_every_first_corner() {
        let shapes: [(&[[f64; 2]], f64); 5] = [
            (&[[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [2.0, 1.0], [0.0, 4.0]], 10.0),
            (&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]], 4.0),
            (&[[0.0, 0.0], [3.0, 0.0], [1.0, 1.0], [0.0, 3.0]], 3.0),
            // A spiral.
            (
                &[
                    [0.0, 0.0],
                    [5.0, 0.0],
                    [5.0, 5.0],
                    [1.0, 5.0],
                    [1.0, 2.0],
                    [3.0, 2.0],
                    [3.0, 3.0],
                    [2.0, 3.0],
                    [2.0, 4.0],
                    [4.0, 4.0],
                    [4.0, 1.0],
                    [0.0, 1.0],
                ],
                15.0,
            ),
            // A square with a square hole, joined by a slit.
            (
                &[
                    [0.0, 0.0],
                    [3.0, 0.0],
                    [3.0, 3.0],
                    [0.0, 3.0],
                    [0.0, 0.0],
                    [1.0, 1.0],
                    [1.0, 2.0],
                    [2.0, 2.0],
                    [2.0, 1.0],
                    [1.0, 1.0],
                ],
                8.0,
            ),
        ];
        for (shape, exact) in shapes {
            let mut corners = polygon(shape);
            for _ in 0..corners.len() {
                corners.rotate_left(1);
                let triangles = triangulate(&corners);
                assert_eq!(triangles.len(), corners.len() - 2);
                let (sum, least) = areas(&corners, &triangles, DVec3::Z);
                assert!((sum - exact).abs() < 1e-12 && least > 0.0, "{corners:?}: {sum}, {least}");
            }
        }
    }

    #[test]
    fn a_fan_would_fold() {
        let corners = polygon(&[[4.0, 0.0], [4.0, 4.0], [2.0, 1.0], [0.0, 4.0], [0.0, 0.0]]);
        assert!(areas(&corners, &[[0, 1, 2], [0, 2, 3], [0, 3, 4]], DVec3::Z).1 < 0.0);
    }

    #[test]
    fn tilted_tiny_and_far_polygons_keep_their_outline() {
        let (along, across) = (DVec3::new(0.6, 0.0, 0.8), DVec3::new(0.0, 1.0, 0.0));
        for (scale, offset) in [(1.0, 1e6), (1e-30, 0.0), (1e30, 0.0)] {
            let corners: Vec<_> = polygon(&[[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [2.0, 1.0], [0.0, 4.0]])
                .iter()
                .map(|point| scale * (point.x * along + point.y * across) + offset)
                .collect();
            let (sum, least) = areas(&corners, &triangulate(&corners), along.cross(across));
            // A coordinate of 1e6 carries an error of 1e-10.
            assert!((sum / scale / scale - 10.0).abs() < 1e-8 && least > 0.0, "{scale}, {offset}: {sum}");
        }
    }

    #[test]
    fn polygons_without_area_give_as_many_triangles() {
        assert_eq!(triangulate(&[DVec3::ONE; 5]).len(), 3);
        assert_eq!(triangulate(&polygon(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]])).len(), 2);
        assert_eq!(triangulate(&polygon(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [1.5, 0.0]])).len(), 2);
    }
}
