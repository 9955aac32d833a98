//! The finished mesh: its faces have regions, its sheets are joined, it is in model units and compared with the surface.
//!
//! # Practice
//! Read [`Finished::faults`] and [`Finished::differences`] before the mesh is used: a mesh on parts thinner than a tile can have
//! both, and more points resolve these parts.

use super::attributes::{VertexAttributes, attributes};
use super::check::{Fault, Faults, Kind, check_joined, sort};
use super::compare::{Difference, differences_from, missing_kept_edges, uncovered};
use super::join::{Joined, join};
use super::objective::Context;
use super::regions::with_regions;
use super::surface_mesh::SurfaceMesh;
use super::{Mesh, Triangulation};
use crate::mosaic::{FeaturePoint, Mosaic};
use rustc_hash::{FxHashMap, FxHashSet};

/// A finished mesh, with its faults and its differences from the surface.
#[derive(Clone, Debug, Default)]
pub struct Finished {
    /// The mesh, in model units.
    pub mesh: Mesh,
    /// What is known of each of its vertices.
    pub vertices: Vec<VertexAttributes>,
    /// Whether sheets of the surface meet at each of its vertices.
    pub branches: Vec<bool>,
    /// Its broken invariants, inverted faces among them, with places in model units.
    pub faults: Faults,
    /// Its global differences from the surface: topology, and parts that are missing.
    pub differences: Vec<Difference>,
}

/// Gives the faces of a compacted mesh their regions, joins its sheets where they meet, and compares the result with the surface.
/// `opposed` lists the faces that point against the nearest triangles. Cancelled, it compares nothing.
pub(crate) fn finish(
    context: &Context,
    mesh: &SurfaceMesh,
    opposed: &[u32],
    mosaic: &Mosaic,
    triangulation: &Triangulation,
) -> Finished {
    let surface = context.surface;
    let (named, order) = with_regions(context, mesh, mosaic);
    let first = triangulation.joints(mesh.vertices().iter().map(|vertex| vertex.origin));
    let Joined { mesh: mut joined, mut branches, number } = join(&named, &first);
    let ends = context.ends_of_shared_curves();
    for (v, vertex) in mesh.vertices().iter().enumerate() {
        if let Some(FeaturePoint::Vertex(end)) =
            mosaic.feature_samples.get(vertex.origin as usize).map(|sample| sample.point)
            && ends.contains(&end)
        {
            branches[number[v] as usize] = true;
        }
    }
    let opposed: FxHashSet<u32> = opposed.iter().copied().collect();
    let inverted = (0..).zip(&order).filter(|(_, face)| opposed.contains(face)).map(|(face, _)| face);
    let uncovered = if context.is_cancelled() { None } else { uncovered(&joined, surface) };
    let all = (0..).zip(attributes(context, mesh, mosaic)).filter(|&(v, _)| first[v] as usize == v);
    let (points, vertices) = all.map(|(_, known)| known).unzip();
    joined.points = points;
    let mut faults = if context.is_cancelled() { Faults::default() } else { check_joined(&joined, &branches) };
    let missing = missing_kept_edges(surface, &kept_vertices(mesh, mosaic, &number), &joined);
    let differences =
        differences_from(faults.topology(), surface).into_iter().chain(uncovered).chain(missing).collect();
    faults.list.extend(inverted.map(|face| Fault {
        kind: Kind::FlippedFace { face },
        at: joined.middle(joined.face(face as usize)).to_array(),
    }));
    sort(&mut faults.list);
    Finished { mesh: joined, vertices, branches, faults, differences }
}

/// The joined vertices of a mesh at the kept vertices of its surface. `number` has the joined vertex of each one of the mesh.
fn kept_vertices(mesh: &SurfaceMesh, mosaic: &Mosaic, number: &[u32]) -> FxHashMap<u32, u32> {
    let kept = mesh.vertices().iter().zip(number).filter(|(vertex, _)| vertex.is_kept);
    kept.filter_map(|(vertex, &number)| match mosaic.feature_samples.get(vertex.origin as usize)?.point {
        FeaturePoint::Vertex(v) => Some((v, number)),
        FeaturePoint::Edge(..) => None,
    })
    .collect()
}

/// A mesh each of whose vertices has a face, with its sheets joined, in model units, without regions.
pub(crate) fn joined(context: &Context, mesh: &SurfaceMesh, triangulation: &Triangulation) -> Mesh {
    let joints = triangulation.joints(mesh.vertices().iter().map(|vertex| vertex.origin));
    join(&mesh.to_mesh(), &joints).mesh.placed(context.surface.frame())
}
