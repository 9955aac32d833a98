//! Which region of the surface each face lies on.

use super::Mesh;
use crate::mosaic::Mosaic;
use crate::surface::nearest::Triangles;
use crate::surface::{Regions, Surface};
use glam::DVec3;

/// The same mesh, in unit-sized coordinates, with its faces in the order of their regions; as it is where the surface has
/// none. `below` names the triangle below each vertex that is no tile on a feature, `kept` the vertex of the triangulation
/// that each one is.
///
/// A vertex that is no tile on a feature tells its faces' region, since borders of regions are features. Faces without such
/// vertices lie where the triangle nearest to their middle does, of the regions that all their vertices touch.
pub fn with_regions(mesh: &Mesh, surface: &Surface, mosaic: &Mosaic, below: &[Option<u32>], kept: &[u32]) -> Mesh {
    let regions = surface.regions();
    if regions.of_face.is_empty() {
        return mesh.clone();
    }
    let triangles = Triangles::new(surface);
    let of = |triangle: u32| regions.of_face[triangle as usize];
    let touched = |v: u32| -> Vec<u32> {
        let site = kept[v as usize] as usize;
        let Some(first) = mosaic.feature_samples.get(site).map(|site| site.first_side as usize) else {
            return Vec::new();
        };
        let end = mosaic.feature_samples.get(site + 1).map_or(mosaic.sides, |next| next.first_side as usize);
        mosaic.tiles[first..end].iter().map(|side| of(side.triangle)).collect()
    };
    let region = |face: &[u32]| {
        if let Some(triangle) = face.iter().find_map(|&v| below[v as usize]) {
            return of(triangle);
        }
        let middle = face.iter().map(|&v| DVec3::from(mesh.points[v as usize])).sum::<DVec3>() / face.len() as f64;
        let nearest = of(triangles.nearest(middle).0);
        let sets: Vec<Vec<u32>> = face.iter().map(|&v| touched(v)).filter(|set| !set.is_empty()).collect();
        let common = |region: &u32| sets.iter().all(|set| set.contains(region));
        if common(&nearest) {
            return nearest;
        }
        sets.first().and_then(|set| set.iter().copied().find(common)).unwrap_or(nearest)
    };
    let mut order: Vec<(u32, u32)> = mesh.faces().map(region).zip(0..).collect();
    order.sort_unstable();
    let mut sorted = Mesh::new(mesh.points.clone());
    order.iter().for_each(|&(_, face)| sorted.push_face(mesh.face(face as usize)));
    sorted.regions =
        Regions { names: regions.names.clone(), of_face: order.iter().map(|&(region, _)| region).collect() };
    sorted
}
