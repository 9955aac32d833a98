//! Reading of polygon meshes from files, of this program or another, for checks and measures.

use super::Mesh;
use crate::surface::load::{Format, LoadError, polygons};
use std::path::Path;

/// Reads a mesh from a file of any [`Format`], told apart by content: faces of any size with their regions, vertices in the order of
/// the file. STL's corners with the same coordinates are one vertex.
///
/// # Errors
/// [`LoadError`] says what is wrong, where, and what to do.
pub fn read_mesh(path: &Path) -> Result<Mesh, LoadError> {
    read_mesh_as(path, None)
}

/// As [`read_mesh`], in the format that is given, if one is.
///
/// # Errors
/// As [`read_mesh`].
pub fn read_mesh_as(path: &Path, format: Option<Format>) -> Result<Mesh, LoadError> {
    let read = polygons(path, format)?;
    Ok(Mesh { points: read.points, corners: read.corners, ends: read.ends, regions: read.regions })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vertices_and_faces_stay_as_the_file_has_them() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("mesh.obj");
        let text = "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nf 4 5 2 3\nf -1/1 4//1 3\nf 2 3 6 4 5\n";
        std::fs::write(&path, text).expect("it can be written");
        let mesh = read_mesh(&path).expect("it is a mesh");
        assert_eq!(mesh.points[0], [9.0; 3]);
        assert_eq!(mesh.points.len(), 6);
        let faces: Vec<_> = mesh.faces().collect();
        assert_eq!(faces, [&[3, 4, 1, 2][..], &[5, 3, 2], &[1, 2, 5, 3, 4]]);
    }

    #[test]
    fn a_file_without_faces_is_no_mesh() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        for (text, part) in [("v 0 0 0\nv 1 0 0\n", "no faces"), ("v 0 0 0\nv 1 0 0\nf 1 2\n", "line 3")] {
            let path = folder.path().join("points.obj");
            std::fs::write(&path, text).expect("it can be written");
            let error = read_mesh(&path).expect_err("there is nothing to check").to_string();
            assert!(error.contains("points.obj") && error.contains(part), "{error}");
        }
    }
}
