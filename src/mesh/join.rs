//! The joining of the meshes of sheets where sheets of the surface meet.

use super::Mesh;
use crate::surface::NONE;

/// A mesh without two vertices at the same point.
#[derive(Clone, Debug)]
pub struct Joined {
    /// The mesh.
    pub mesh: Mesh,
    /// Whether sheets meet at each vertex: the mesh may branch there as the surface does.
    pub branches: Vec<bool>,
    /// The new id of each old vertex.
    pub number: Vec<u32>,
}

/// Merges the vertices at the same point; `first` gives, for each vertex, the first vertex at its point.
pub fn join(mesh: &Mesh, first: &[u32]) -> Joined {
    let mut number = vec![NONE; mesh.points.len()];
    let mut points = Vec::with_capacity(mesh.points.len());
    let mut branches = Vec::with_capacity(mesh.points.len());
    for (v, &first) in first.iter().enumerate() {
        if first as usize == v {
            number[v] = points.len() as u32;
            points.push(mesh.points[v]);
            branches.push(false);
        } else {
            number[v] = number[first as usize];
            branches[number[v] as usize] = true;
        }
    }
    let mut joined = Mesh::new(points);
    let mut corners = Vec::new();
    for face in mesh.faces() {
        corners.clear();
        corners.extend(face.iter().map(|&v| number[v as usize]));
        joined.push_face(&corners);
    }
    joined.regions = mesh.regions.clone();
    Joined { mesh: joined, branches, number }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::check::{check, check_joined};

    /// Three squares that meet at the edge from (0, 0, 0) to (0, 0, 1), each with vertices of its own.
    fn book() -> (Mesh, Vec<u32>) {
        let mut mesh = Mesh::default();
        for [x, y] in [[1.0, 0.0], [-1.0, 1.0], [-1.0, -1.0]] {
            let first = mesh.points.len() as u32;
            mesh.points.extend([[0.0, 0.0, 0.0], [x, y, 0.0], [x, y, 1.0], [0.0, 0.0, 1.0]]);
            mesh.push_face(&[first, first + 1, first + 2, first + 3]);
        }
        (mesh, vec![0, 1, 2, 3, 0, 5, 6, 3, 0, 9, 10, 3])
    }

    #[test]
    fn pages_are_joined_at_the_spine_and_nowhere_else() {
        let (mesh, first) = book();
        let Joined { mesh, branches, .. } = join(&mesh, &first);
        assert_eq!(mesh.points.len(), 8);
        assert_eq!((0..8).filter(|&v| branches[v]).collect::<Vec<_>>(), [0, 3]);
        assert_eq!(mesh.face_count(), 3);
        assert!(mesh.faces().all(|face| face[0] == 0 && face[3] == 3));
        assert!(check_joined(&mesh, &branches).is_clean());
        assert!(!check(&mesh).is_clean(), "for one who does not know the surface, the spine is a fault");
    }

    #[test]
    fn a_mesh_of_one_sheet_stays_as_it_is() {
        let (mesh, _) = book();
        let joined = join(&mesh, &(0..12).collect::<Vec<_>>());
        assert_eq!(joined.mesh, mesh);
        assert!(!joined.branches.contains(&true));
    }
}
