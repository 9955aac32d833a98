//! Covering: vertices move to the tips of parts that are smaller than a tile, so that no part of the surface is missing.
//!
//! # Theory
//! The tiles of a horn, a claw or a fin that is thinner than a tile may all lie at its foot. The tip is the point of the surface farthest
//! from the mesh. The vertex nearest to it moves there where none of its faces becomes a fault, and stays; then the other vertices are
//! relocated.
//!
//! # Changes versus the paper
//! The paper does not compare the mesh with the surface.

use super::objective::Context;
use super::relocate::Sweeps;
use super::surface_mesh::SurfaceMesh;
use super::uncovered::{UncoveredPoint, uncovered_points};
use super::vertex::{Place, Position};
use rayon::prelude::*;

/// Rounds of covering and relocation.
const ROUNDS: usize = 3;
/// The most tips in a round.
const MOST_TIPS: usize = 64;
/// The vertices nearest to a tip that are tried, ...
const NEAREST: usize = 6;
/// ... and how much farther than the mesh they are, in mean edge lengths.
const REACH: f64 = 2.0;
/// The least distance of two tips in a round, in mean edge lengths.
const TIP_DISTANCE: f64 = 2.0;
/// Passes of shape matching in a round.
const PASSES: usize = 3;

/// Moves free vertices to the tips of the parts of the surface that a compacted mesh misses; returns whether any has moved.
pub(crate) fn cover(context: &Context, mesh: &mut SurfaceMesh) -> bool {
    let mut is_held = vec![false; mesh.vertices().len()];
    for _ in 0..ROUNDS {
        let mut sweeps = Sweeps::new(context, mesh);
        let mut moved = Vec::new();
        for tip in tips(context, mesh) {
            let triangles = [tip.triangle(context.surface); 2];
            let position = Position { point: tip.point, place: Place::Free, triangles };
            let is_sound = |v: &u32| sweeps.least_shapes(mesh, *v, &position)[1] > 0.0;
            let found = nearest(mesh, &tip, &is_held).into_iter().find(is_sound);
            if let Some(v) = found {
                sweeps.put(mesh, v, &position);
                is_held[v as usize] = true;
                moved.push(v);
            }
        }
        if moved.is_empty() {
            break;
        }
        sweeps.hold(&is_held);
        sweeps.match_shapes(mesh, PASSES);
        sweeps.search_imperfect(mesh);
        sweeps.search_poor(mesh);
    }
    is_held.contains(&true)
}

/// The points of the surface that are farthest from a mesh, none near another.
fn tips(context: &Context, mesh: &SurfaceMesh) -> Vec<UncoveredPoint> {
    let flat = mesh.to_mesh();
    let mut tips: Vec<UncoveredPoint> = Vec::new();
    for found in uncovered_points(&flat, context.surface) {
        if tips.len() == MOST_TIPS {
            break;
        }
        if tips.iter().all(|tip| tip.point.distance(found.point) > TIP_DISTANCE * found.edge) {
            tips.push(found);
        }
    }
    tips
}

/// The free vertices that are nearest to a tip, those left out that `is_held` marks.
fn nearest(mesh: &SurfaceMesh, tip: &UncoveredPoint, is_held: &[bool]) -> Vec<u32> {
    // Those of the nearest face are among them.
    let reach = tip.distance + REACH * tip.edge;
    let off = |v: u32| mesh.point(v).distance(tip.point);
    let may_move = |&v: &u32| mesh.vertex(v).is_free() && !is_held[v as usize] && off(v) <= reach;
    let all = (0..mesh.vertices().len() as u32).into_par_iter().with_min_len(4096);
    let mut found: Vec<u32> = all.filter(may_move).collect();
    found.sort_by(|&a, &b| off(a).total_cmp(&off(b)).then(a.cmp(&b)));
    found.truncate(NEAREST);
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Mesh;
    use crate::surface::{FeatureOptions, Soup, Surface};
    use glam::DVec3;

    /// The cells of a grid of so many points across and along.
    fn cells(count: u32) -> impl Iterator<Item = [u32; 4]> {
        let at = move |i: u32, j: u32| j * count + i;
        (0..(count - 1).pow(2))
            .map(move |k| (k % (count - 1), k / (count - 1)))
            .map(move |(i, j)| [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)])
    }

    fn grid(count: u32, point: impl Fn(f64, f64) -> [f64; 3]) -> Vec<[f64; 3]> {
        (0..count.pow(2)).map(|k| point(f64::from(k % count), f64::from(k / count))).collect()
    }

    /// A square of side 8 with a horn of this height in its middle, less than a unit wide.
    fn horned(height: f64) -> Surface {
        let point = |i: f64, j: f64| {
            let [x, y] = [i / 5.0, j / 5.0];
            [x, y, height * (1.0 - (x - 4.0).hypot(y - 4.0) / 0.5).max(0.0)]
        };
        let triangles = cells(41).flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        let soup = Soup { points: grid(41, point), triangles, ..Soup::default() };
        let options = FeatureOptions { crease: 180.0, ridge: 180.0, ..FeatureOptions::default() };
        Surface::new(&soup, &options).unwrap_or_else(|error| panic!("{error}"))
    }

    /// A grid of unit squares at the foot of the horn.
    fn foot(context: &Context) -> SurfaceMesh {
        let mut mesh = Mesh::new(grid(8, |i, j| [i + 0.5, j + 0.5, 0.0]));
        cells(8).for_each(|cell| mesh.push_face(&cell));
        SurfaceMesh::of(context, &mesh)
    }

    #[test]
    fn a_vertex_moves_to_the_tip_of_a_horn_that_lies_between_vertices() {
        for height in [1.5, 2.5] {
            let surface = horned(height);
            let context = Context::new(&surface);
            let mut mesh = foot(&context);
            let distance =
                |mesh: &SurfaceMesh| uncovered_points(&mesh.to_mesh(), &surface)[0].distance * surface.frame().diagonal;
            assert!(distance(&mesh) > 0.9 * height, "the foot alone");
            assert!(cover(&context, &mut mesh));
            assert!(uncovered_points(&mesh.to_mesh(), &surface).is_empty());
            assert!(mesh.faults(&context).is_empty());
            let tip = DVec3::from(surface.frame().to_unit([4.0, 4.0, height]));
            assert!(mesh.vertices().iter().any(|vertex| vertex.point.distance(tip) < 1e-6));
        }
    }

    #[test]
    fn a_covered_surface_moves_no_vertex() {
        let surface = horned(0.5);
        let context = Context::new(&surface);
        let mut mesh = foot(&context);
        let before = mesh.to_mesh();
        assert!(!cover(&context, &mut mesh));
        assert_eq!(mesh.to_mesh(), before);
    }
}
