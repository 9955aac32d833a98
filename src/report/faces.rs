//! Figures of some faces of a mesh: the worst ones, and those of each region.

use crate::mesh::Mesh;
use crate::mesh::quality::measures_of;
use serde::Serialize;
use std::iter::repeat_n;

/// The number of faces in [`WorstFace::of`].
const WORST: usize = 10;

/// A face of poor shape.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct WorstFace {
    /// Its number, counted from 0.
    pub face: usize,
    /// The number of its sides.
    pub sides: usize,
    /// Its shape: Qg of a quad, Tg of a triangle; 0 of other faces.
    pub shape: f64,
    /// The mean of its vertices, in model units.
    pub at: [f64; 3],
}

impl WorstFace {
    /// The faces of a mesh of the least shape, at most ten, the worst first.
    pub(super) fn of(mesh: &Mesh) -> Vec<Self> {
        let shape = |face: &[u32]| Some(measures_of(mesh, face).0).filter(|shape| !shape.is_nan()).unwrap_or_default();
        let mut shapes: Vec<(f64, usize)> = mesh.faces().map(shape).zip(0..).collect();
        let order = |a: &(f64, usize), b: &(f64, usize)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
        if shapes.len() > WORST {
            shapes.select_nth_unstable_by(WORST, order);
            shapes.truncate(WORST);
        }
        shapes.sort_unstable_by(order);
        let one = |(shape, face): (f64, usize)| {
            let corners = mesh.face(face);
            Self { face, sides: corners.len(), shape, at: mesh.middle(corners).to_array() }
        };
        shapes.into_iter().map(one).collect()
    }
}

/// The faces of a region.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RegionFigures {
    /// Its name; empty where faces have none.
    pub name: String,
    /// The number of its quads.
    pub quads: usize,
    /// The number of its triangles.
    pub triangles: usize,
    /// The number of its faces with more than four sides.
    pub polygons: usize,
}

impl RegionFigures {
    /// The regions of a mesh, one without a name where it has none.
    pub(super) fn of(mesh: &Mesh) -> Vec<Self> {
        let unnamed = [String::new()];
        let names = if mesh.regions.names.is_empty() { &unnamed } else { mesh.regions.names.as_slice() };
        let none = |name: &String| Self { name: name.clone(), quads: 0, triangles: 0, polygons: 0 };
        let mut regions: Vec<Self> = names.iter().map(none).collect();
        let of_face = mesh.regions.of_face.iter().copied().chain(repeat_n(0, mesh.face_count()));
        for (face, region) in mesh.faces().zip(of_face) {
            let region = &mut regions[region as usize];
            match face.len() {
                3 => region.triangles += 1,
                4 => region.quads += 1,
                _ => region.polygons += 1,
            }
        }
        regions
    }
}
