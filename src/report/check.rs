//! The report on a mesh alone, or beside a surface.

use super::{Input, PROGRAM, VERSION};
use crate::mesh::Mesh;
use crate::mesh::check::{Faults, Kind, check_joined};
use crate::mesh::compare::{Comparison, Difference, check_against};
use crate::mesh::joints::joints;
use crate::mesh::quality::Quality;
use crate::surface::Surface;
use serde::Serialize;

/// A report on a mesh.
#[derive(Clone, Debug, Serialize)]
pub struct CheckReport {
    /// [`VERSION`].
    pub version: u32,
    /// The program's name and version.
    pub program: String,
    /// The mesh's name.
    pub name: String,
    /// Measures of the mesh; absent where its faces name missing vertices.
    pub mesh: Option<Quality>,
    /// The number of edges of more than two faces along which sheets meet; with a surface that tells where they do, 0.
    pub joints: usize,
    /// Broken invariants of the mesh, with places in model units.
    pub faults: Faults,
    /// The comparison with a surface; absent without a surface.
    pub against: Option<Against>,
}

/// The comparison of a mesh with a surface.
#[derive(Clone, Debug, Serialize)]
pub struct Against {
    /// The surface.
    pub surface: Input,
    /// The comparison; absent where the mesh has no extent, or its vertices are missing or not finite.
    pub comparison: Option<Comparison>,
}

impl CheckReport {
    /// The report on the mesh called `name`; `against` is the name and the surface to compare it with.
    pub fn new(name: &str, mesh: &Mesh, against: Option<(&str, &Surface)>) -> Self {
        let joints = if against.is_none() { joints(mesh) } else { Vec::new() };
        let (faults, against) = match against {
            None => {
                let mut branches = vec![false; mesh.points.len()];
                joints.iter().flatten().for_each(|&v| branches[v as usize] = true);
                (check_joined(mesh, &branches), None)
            }
            Some((name, surface)) => {
                let (faults, comparison) = check_against(mesh, surface);
                (faults, Some(Against { surface: Input::new(name, surface), comparison }))
            }
        };
        let measurable = faults.count(|kind| matches!(kind, Kind::MissingVertex { .. })) == 0;
        Self {
            version: VERSION,
            program: PROGRAM.to_owned(),
            name: name.to_owned(),
            mesh: measurable.then(|| Quality::with_holes(mesh, faults.hole_triangles())),
            joints: joints.len(),
            faults,
            against,
        }
    }

    /// Global differences between the mesh and the surface; none without a surface.
    pub fn differences(&self) -> &[Difference] {
        let comparison = self.against.as_ref().and_then(|against| against.comparison.as_ref());
        comparison.map_or(&[], |comparison| &comparison.differences)
    }
}
