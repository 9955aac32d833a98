//! The region of the surface that each face lies on.

use super::Mesh;
use super::objective::Context;
use super::surface_mesh::SurfaceMesh;
use crate::mosaic::Mosaic;
use crate::surface::Regions;
use glam::DVec3;

/// A compacted mesh with its faces sorted by region, and the old id of each face. The order stays where the surface has no
/// regions.
///
/// The region of a face is that of its free vertices, since borders of regions are features. A face without free vertices has
/// the region of the triangle nearest to its middle, if all its vertices touch that region, else the first common one.
pub(crate) fn with_regions(context: &Context, mesh: &SurfaceMesh, mosaic: &Mosaic) -> (Mesh, Vec<u32>) {
    let regions = context.surface.regions();
    if regions.of_face.is_empty() {
        return (mesh.to_mesh(), (0..mesh.face_bound() as u32).collect());
    }
    let of = |triangle: u32| regions.of_face[triangle as usize];
    let touched = |v: u32| -> Vec<u32> {
        let origin = mesh.vertex(v).origin as usize;
        if origin >= mosaic.feature_samples.len() {
            return Vec::new();
        }
        mosaic.sides_of(origin).iter().map(|side| of(side.triangle)).collect()
    };
    let region = |face: &[u32]| {
        if let Some(&v) = face.iter().find(|&&v| mesh.vertex(v).is_free()) {
            return of(mesh.vertex(v).triangles[0]);
        }
        let middle = face.iter().map(|&v| mesh.point(v)).sum::<DVec3>() / face.len() as f64;
        let nearest = of(context.orientation.triangles().nearest(middle).0);
        let sets: Vec<Vec<u32>> = face.iter().map(|&v| touched(v)).filter(|set| !set.is_empty()).collect();
        let common = |region: &u32| sets.iter().all(|set| set.contains(region));
        if common(&nearest) {
            return nearest;
        }
        sets.first().and_then(|set| set.iter().copied().find(common)).unwrap_or(nearest)
    };
    let mut order: Vec<(u32, u32)> = mesh.faces().map(region).zip(0..).collect();
    order.sort_unstable();
    let mut sorted = Mesh::new(mesh.vertices().iter().map(|vertex| vertex.point.to_array()).collect());
    order.iter().for_each(|&(_, face)| sorted.push_face(mesh.face(face)));
    sorted.regions =
        Regions { names: regions.names.clone(), of_face: order.iter().map(|&(region, _)| region).collect() };
    (sorted, order.into_iter().map(|(_, face)| face).collect())
}
