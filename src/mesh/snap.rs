//! Snapping: free vertices near a crease that is no feature move to it.
//!
//! # Theory
//! A crease that does not persist at the scale of a tile gets no row of its own, so it costs no irregular vertex. A vertex
//! beside it still describes the surface best where it lies on the crease. The vertices nearest to creases move first, each to
//! the nearest point, where its faces keep a good shape; then the other vertices are relocated.
//!
//! # Changes versus the paper
//! The paper has no features.

use super::objective::{Context, POOR};
use super::relocate::Sweeps;
use super::surface_mesh::SurfaceMesh;
use super::vertex::{Place, Position, walked};
use crate::surface::Surface;
use crate::surface::nearest::{Simplices, nearest_on_segment};
use glam::DVec3;
use rayon::prelude::*;

/// A crease across which the surface turns by less at the scale of a tile, in degrees, attracts no vertex.
const LEAST_TURN: f32 = 25.0;
/// The largest distance that a vertex moves to a crease, in edges.
const REACH: f64 = 0.5;
/// A walk that ends farther from the point on the crease, in edges, has reached another sheet.
const OTHER_SHEET: f64 = 0.3;
/// The faces of a vertex that moves keep this shape, or the least one that they had if it was not poor.
const LEAST_SHAPE: f64 = 0.5;
/// Rounds of snapping and relocation.
const ROUNDS: usize = 2;
/// Passes of shape matching in a round.
const PASSES: usize = 3;

/// Moves free vertices to the creases that are no features.
pub fn snap(context: &Context, mesh: &mut SurfaceMesh) {
    let Some(creases) = Creases::of(context.surface) else { return };
    let mut is_held = vec![false; mesh.vertices().len()];
    for _ in 0..ROUNDS {
        let mut sweeps = Sweeps::new(context, mesh);
        for Candidate { v, position, .. } in creases.candidates(mesh, &is_held) {
            if context.is_cancelled() {
                return;
            }
            let [before, after] = sweeps.least_shapes(mesh, v, &position);
            if after >= before.clamp(POOR, LEAST_SHAPE) {
                sweeps.put(mesh, v, &position);
                is_held[v as usize] = true;
            }
        }
        sweeps.hold(&is_held);
        sweeps.match_shapes(mesh, PASSES);
        sweeps.search_imperfect(mesh);
    }
    Sweeps::new(context, mesh).search_poor(mesh);
}

/// A vertex and the point of a crease that it may move to.
struct Candidate {
    v: u32,
    /// In edges.
    distance: f64,
    position: Position,
}

/// The edges of the creases that attract vertices.
struct Creases<'a> {
    surface: &'a Surface,
    half_edges: Vec<u32>,
    tree: Simplices<2>,
}

impl<'a> Creases<'a> {
    fn of(surface: &'a Surface) -> Option<Self> {
        let attracting = surface.dropped_edges().iter().filter(|edge| edge.turn.abs() >= LEAST_TURN);
        let half_edges: Vec<u32> = attracting.map(|edge| edge.half_edge).collect();
        let ends = |&h: &u32| [surface.origin(h), surface.target(h)].map(|v| DVec3::from(surface.point(v)));
        let tree = Simplices::new(half_edges.iter().map(ends));
        (!half_edges.is_empty()).then_some(Self { surface, half_edges, tree })
    }

    /// The free vertices near creases, except those that `is_held` marks, the nearest first.
    fn candidates(&self, mesh: &SurfaceMesh, is_held: &[bool]) -> Vec<Candidate> {
        let may_move = |&v: &u32| mesh.vertex(v).is_free() && !is_held[v as usize] && !mesh.around(v).is_empty();
        let all = (0..mesh.vertices().len() as u32).into_par_iter().with_min_len(256);
        let mut found: Vec<Candidate> = all.filter(may_move).filter_map(|v| self.candidate(mesh, v)).collect();
        found.sort_by(|a, b| a.distance.total_cmp(&b.distance).then(a.v.cmp(&b.v)));
        found
    }

    fn candidate(&self, mesh: &SurfaceMesh, v: u32) -> Option<Candidate> {
        let (here, edge) = (mesh.point(v), mesh.mean_edge_at(v));
        let (distance, nearest) = self.tree.nearest(here).filter(|(distance, _)| *distance < REACH * edge)?;
        let [start, end] = nearest.corners;
        let point = nearest_on_segment(here, start, end);
        let h = self.half_edges[nearest.id as usize];
        let twin = self.surface.twin(h).unwrap_or(h);
        let reached = walked(self.surface, mesh.vertex(v).triangles[0], here, point).point;
        let position = Position { point, place: Place::Free, triangles: [h / 3, twin / 3] };
        (reached.distance(point) <= OTHER_SHEET * edge).then_some(Candidate { v, distance: distance / edge, position })
    }
}
