//! The grid metric: distances and directions in tile sides along the rows.
//!
//! It measures the triangulation of the tiles where rows pass over the whole surface, or where tiles are rectangles.

use super::{Cone, Parametrization};
use crate::surface::Surface;
use glam::DVec3;

/// The least length of an edge, in tile sides.
const SHORTEST: f64 = 1e-4;

/// Coordinates whose integers are tiles, as steps along the surface's half-edges.
#[derive(Clone, Debug)]
pub struct GridMetric {
    /// Along each half-edge, in tile sides along the axes of the sector that it leaves.
    pub(crate) steps: Vec<[f64; 2]>,
    /// The same, in the frame of the sector at its end.
    pub(crate) at_ends: Vec<[f64; 2]>,
    /// Whether a vertex of the surface lies on a feature that rows lie on.
    has_feature: Vec<bool>,
    /// Singularities inside triangles.
    pub(crate) cones: Vec<PlacedCone>,
}

/// A cone with its place.
#[derive(Clone, Debug)]
pub(crate) struct PlacedCone {
    pub cone: Cone,
    pub position: DVec3,
    /// Whether it carries a tile.
    pub is_tile: bool,
}

impl GridMetric {
    /// The metric of continuous rows.
    pub fn new(surface: &Surface, parametrization: &Parametrization) -> Self {
        let half_edges = 0..3 * surface.triangle_count() as u32;
        let cones =
            (0..surface.triangle_count() as u32).filter_map(|t| parametrization.cone(t)).map(|cone| PlacedCone {
                position: cone.position(surface, parametrization),
                is_tile: parametrization.is_integer(&cone),
                cone,
            });
        Self {
            has_feature: has_feature(surface, parametrization),
            cones: cones.collect(),
            steps: half_edges.clone().map(|h| parametrization.step(h)).collect(),
            at_ends: half_edges.map(|h| parametrization.step_at_end(h)).collect(),
        }
    }

    /// The wanted steps: where rows may end, the steps of the coordinates do not add up.
    pub(crate) fn of_transitions(parametrization: &Parametrization) -> Self {
        let (steps, at_ends) = parametrization
            .transitions
            .iter()
            .map(|transition| (transition.wanted, transition.forward(transition.wanted)))
            .unzip();
        Self { steps, at_ends, has_feature: Vec::new(), cones: Vec::new() }
    }

    /// Takes note of which cones still carry a tile; `centres` are those of the free tiles, tiles on cones first, in order.
    pub(crate) fn keep_cones(&mut self, centres: impl Iterator<Item = [f32; 3]> + Clone) {
        let mut left = centres;
        for placed in self.cones.iter_mut().filter(|placed| placed.is_tile) {
            let place = <[f32; 3]>::from(placed.position.as_vec3());
            let mut ahead = left.clone();
            placed.is_tile = ahead.next() == Some(place);
            if placed.is_tile {
                left = ahead;
            }
        }
    }

    /// The length of a half-edge in tile sides.
    pub(crate) fn length(&self, half_edge: u32) -> f64 {
        let [u, v] = self.steps[half_edge as usize];
        u.hypot(v).max(SHORTEST)
    }

    /// The directions at which the corner of a half-edge begins and ends, in radians from the axis of its sector, up to
    /// whole turns.
    pub(crate) fn corner_directions(&self, half_edge: u32) -> [f64; 2] {
        let [u, v] = self.steps[half_edge as usize];
        let [x, y] = self.at_ends[crate::surface::previous(half_edge) as usize];
        [v.atan2(u), (-y).atan2(-x)]
    }

    /// The triangle, or the three triangles between its sides and its cone.
    pub(crate) fn pieces(&self, surface: &Surface, triangle: u32) -> Vec<LinearPiece> {
        let points = surface.corners(triangle as usize).map(|p| p.as_dvec3());
        let h = [0, 1, 2].map(|k| 3 * triangle + k);
        let has_feature = |k: usize| {
            let vertex = surface.origin(h[k % 3]);
            self.has_feature.get(vertex as usize).is_some_and(|&has_feature| has_feature)
        };
        let on_feature = [0, 1, 2].map(|k| surface.features().is_feature(h[k]) && has_feature(k) && has_feature(k + 1));
        match self.cones.binary_search_by_key(&triangle, |placed| placed.cone.triangle) {
            Ok(i) => {
                let PlacedCone { cone, position, .. } = &self.cones[i];
                let piece = |k: usize| LinearPiece {
                    corner: h[k],
                    points: [points[k], points[(k + 1) % 3], *position],
                    sides: [self.steps[h[k] as usize], cone.from_corners[k]],
                    on_feature: [on_feature[k], false, false],
                    has_feature: [has_feature(k), has_feature(k + 1), false],
                };
                vec![piece(0), piece(1), piece(2)]
            }
            Err(_) => {
                let sides = [self.steps[h[0] as usize], self.at_ends[h[2] as usize].map(|x| -x)];
                vec![LinearPiece { corner: h[0], points, sides, on_feature, has_feature: [0, 1, 2].map(has_feature) }]
            }
        }
    }

    /// The gradients of the coordinates at a point of a triangle, in the frame of one of its corners.
    pub(crate) fn gradients(&self, surface: &Surface, triangle: u32, position: DVec3) -> [DVec3; 2] {
        let pieces = self.pieces(surface, triangle);
        let depth = |piece: &LinearPiece| {
            let [a, b, c] = piece.points;
            let normal = (b - a).cross(c - a);
            // A cone lies inside its triangle: only the two sides at the cone separate the pieces.
            let inside = [(b, c), (c, a)].map(|(p, q)| (q - p).cross(position - p).dot(normal));
            inside[0].min(inside[1]) / normal.length_squared().max(f64::MIN_POSITIVE)
        };
        let deepest = pieces.iter().max_by(|a, b| depth(a).total_cmp(&depth(b)));
        deepest.expect("a triangle has a piece").gradients()
    }
}

fn has_feature(surface: &Surface, parametrization: &Parametrization) -> Vec<bool> {
    let mut found = vec![false; surface.vertex_count()];
    for curve in surface.features().curves() {
        curve.vertices.iter().for_each(|&v| found[v as usize] = !parametrization.released_vertices.contains(&v));
    }
    found
}

/// A triangle in which coordinates are linear.
#[derive(Clone, Debug)]
pub(crate) struct LinearPiece {
    /// The corner of the surface whose frame is used.
    pub corner: u32,
    /// The first lies at that corner.
    pub points: [DVec3; 3],
    /// The steps from the first point to the second and the third.
    pub sides: [[f64; 2]; 2],
    /// Whether the sides after each point lie on features.
    pub on_feature: [bool; 3],
    /// Whether the points do.
    pub has_feature: [bool; 3],
}

impl LinearPiece {
    fn gradients(&self) -> [DVec3; 2] {
        let [a, b, c] = self.points;
        let (x, y) = (b - a, c - a);
        let normal = x.cross(y);
        let area = normal.length_squared().max(f64::MIN_POSITIVE);
        // Each is perpendicular to one side and grows along the other.
        let (along_x, along_y) = (y.cross(normal) / area, normal.cross(x) / area);
        let [p, q] = self.sides;
        [0, 1].map(|k| along_x * p[k] + along_y * q[k])
    }
}
