//! Triangulates a triangle with vertices in its sides and inside, and with segments that become edges.

use glam::DVec3;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};

/// Coordinates are multiples of this, so that points in a side lie exactly on a line.
const STEP: f64 = 1.0 / (1u64 << 40) as f64;

/// The triangles, in the orientation of the sides. Each side is its first corner and the vertices between that and the next
/// corner, in order. Segments that cross others are passed over.
///
/// Works in the coordinates in which the corners are (0, 0), (1, 0) and (0, 1) and vertices in sides lie on them exactly: so no
/// triangle lies in a side, though the vertices are a little off it.
pub(super) fn triangulate(
    points: &[DVec3],
    sides: [&[u32]; 3],
    inside: &[u32],
    segments: &[[u32; 2]],
) -> Vec<[u32; 3]> {
    let point = |v: u32| points[v as usize];
    let corners = sides.map(|side| point(side[0]));
    let on_grid = |x: f64| (x / STEP).round() * STEP;
    let mut vertices: Vec<(u32, [f64; 2])> = Vec::new();
    for (k, side) in sides.iter().enumerate() {
        let (start, way) = (corners[k], corners[(k + 1) % 3] - corners[k]);
        for &v in side.iter() {
            let share = on_grid(((point(v) - start).dot(way) / way.length_squared()).clamp(0.0, 1.0));
            vertices.push((v, [[share, 0.0], [1.0 - share, share], [0.0, 1.0 - share]][k]));
        }
    }
    let [along, up] = [corners[1] - corners[0], corners[2] - corners[0]];
    let normal = along.cross(up);
    for &v in inside {
        let from = point(v) - corners[0];
        let [x, y] =
            [from.cross(up), along.cross(from)].map(|part| on_grid(part.dot(normal) / normal.length_squared()));
        vertices.push((v, [x, y]));
    }
    let mut triangulation = ConstrainedDelaunayTriangulation::<Point2<f64>>::new();
    let mut names = Vec::with_capacity(vertices.len());
    let mut handles = Vec::with_capacity(vertices.len());
    for &(v, [x, y]) in &vertices {
        // Numbers on the grid are neither too small nor too large for it.
        let Ok(handle) = triangulation.insert(Point2::new(x, y)) else { continue };
        if handle.index() == names.len() {
            names.push(v);
        }
        handles.push((v, handle));
    }
    let handle = |v: u32| handles.iter().find(|one| one.0 == v).map(|one| one.1);
    for &[from, to] in segments {
        if let (Some(from), Some(to)) = (handle(from), handle(to))
            && from != to
            && triangulation.can_add_constraint(from, to)
        {
            triangulation.add_constraint(from, to);
        }
    }
    triangulation.inner_faces().map(|face| face.vertices().map(|vertex| names[vertex.index()])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: [DVec3; 3] = [DVec3::new(1.0, 2.0, 0.5), DVec3::new(4.0, 2.5, 1.0), DVec3::new(2.0, 6.0, -1.0)];

    /// The corners, two points in the first side, one in the second, two inside.
    fn points() -> Vec<DVec3> {
        let [a, b, c] = CORNERS;
        let inner = |s: f64, t: f64| a + s * (b - a) + t * (c - a);
        vec![a, b, c, a.lerp(b, 0.3), a.lerp(b, 1.0 / 3.0), b.lerp(c, 0.7), inner(0.2, 0.3), inner(0.3, 0.3)]
    }

    fn found(segments: &[[u32; 2]]) -> Vec<[u32; 3]> {
        triangulate(&points(), [&[0, 3, 4], &[1, 5], &[2]], &[6, 7], segments)
    }

    #[test]
    fn the_triangle_is_covered_once_with_all_vertices() {
        let points = points();
        let triangles = found(&[]);
        // Six corners of the outline and two vertices inside.
        assert_eq!(triangles.len(), 6 - 2 + 2 * 2);
        let area = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a);
        let whole = area(CORNERS);
        let areas = triangles.iter().map(|t| area(t.map(|v| points[v as usize])).dot(whole.normalize()));
        assert!(areas.clone().all(|area| area > 0.0) && (areas.sum::<f64>() - whole.length()).abs() < 1e-12);
    }

    #[test]
    fn segments_become_edges() {
        let has = |triangles: &[[u32; 3]], [a, b]: [u32; 2]| triangles.iter().any(|t| t.contains(&a) && t.contains(&b));
        // From a side past both inner vertices to the opposite corner.
        let segment = [4, 2];
        assert!(!has(&found(&[]), segment), "it would be an edge without being asked for");
        assert!(has(&found(&[segment]), segment));
        let crossing = found(&[segment, [0, 5]]);
        assert!(has(&crossing, segment) && !has(&crossing, [0, 5]) && crossing.len() == 8);
    }
}
