//! Faces cut into triangles, for formats that have no others.

use crate::mesh::Mesh;
use crate::surface::polygon::triangulate;
use glam::DVec3;
use rayon::prelude::*;
use std::ops::Range;

/// The triangles of some faces, in the order of the faces.
pub(super) fn triangles(mesh: &Mesh, faces: Range<usize>) -> Vec<[u32; 3]> {
    let parts = faces.into_par_iter().with_min_len(1024).flat_map_iter(|number| {
        let face = mesh.face(number);
        let points: Vec<DVec3> = face.iter().map(|&v| DVec3::from(mesh.points[v as usize])).collect();
        triangulate(&points).into_iter().map(|triangle| triangle.map(|corner| face[corner]))
    });
    parts.collect()
}
