//! The mesh of a half and its mirror image, joined on the plane.

use super::Plane;
use crate::mesh::Mesh;
use crate::surface::{NONE, Regions};

/// A mesh that is symmetric about a plane, bit for bit where the plane lies across a coordinate axis.
#[derive(Clone, Debug)]
pub struct Joined {
    /// The mesh: first the vertices of the half, then the images of those that are not on the plane.
    pub mesh: Mesh,
    /// The vertex of the half behind each vertex: itself, or what it is the image of.
    pub sources: Vec<u32>,
    /// The mirror image of each vertex: itself on the plane.
    pub images: Vec<u32>,
}

impl Joined {
    /// Whether a vertex lies on the plane.
    pub fn is_on_plane(&self, vertex: u32) -> bool {
        self.images[vertex as usize] == vertex
    }
}

/// Joins the mesh of a half with its mirror image. Vertices no farther than `tolerance` from the plane, in model units, are put on it;
/// others move by a rounding where their images need it. A face all of whose vertices lie on the plane is its own image, and is left
/// out. Faces stay sorted by region, each followed by its image.
pub fn join(half: &Mesh, plane: Plane, tolerance: f64) -> Joined {
    let is_on_plane = |v: u32| plane.height(half.points[v as usize]).abs() <= tolerance;
    let is_kept = |face: &[u32]| !face.iter().all(|&v| is_on_plane(v));
    let mut is_used = vec![false; half.points.len()];
    half.faces().filter(|face| is_kept(face)).flatten().for_each(|&v| is_used[v as usize] = true);
    let mut sources: Vec<u32> = (0..half.points.len() as u32).filter(|&v| is_used[v as usize]).collect();
    let count = sources.len() as u32;
    let mut points: Vec<[f64; 3]> = sources.iter().map(|&v| half.points[v as usize]).collect();
    let mut images: Vec<u32> = (0..count).collect();
    // The number of each vertex of the half.
    let mut number = vec![NONE; half.points.len()];
    for v in 0..count {
        let (source, own) = (sources[v as usize], v as usize);
        number[source as usize] = v;
        if is_on_plane(source) {
            points[own] = plane.onto(points[own]);
            continue;
        }
        let [point, image] = plane.pair(points[own]);
        points[own] = point;
        images[own] = points.len() as u32;
        points.push(image);
        sources.push(source);
        images.push(v);
    }
    let mut mesh = Mesh::new(points);
    let mut of_face = Vec::new();
    for (k, face) in half.faces().enumerate().filter(|(_, face)| is_kept(face)) {
        let face: Vec<u32> = face.iter().map(|&v| number[v as usize]).collect();
        mesh.push_face(&face);
        let image: Vec<u32> = face.iter().rev().map(|&v| images[v as usize]).collect();
        mesh.push_face(&image);
        of_face.extend(half.regions.of_face.get(k).into_iter().flat_map(|&region| [region; 2]));
    }
    mesh.regions = Regions { names: half.regions.names.clone(), of_face };
    Joined { mesh, sources, images }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::check::{Kind, check};
    use crate::symmetry::Axis;

    /// Two squares side by side, the first one's left side on the plane x = 1 but for a rounding.
    fn squares() -> Mesh {
        let mut mesh = Mesh::new((0..6).map(|v| [1.0 + f64::from(v % 3), f64::from(v / 3), 0.0]).collect());
        mesh.points[0][0] += 1e-12;
        mesh.push_face(&[0, 1, 4, 3]);
        mesh.push_face(&[1, 2, 5, 4]);
        mesh.regions = Regions { names: vec!["a".to_owned(), "b".to_owned()], of_face: vec![0, 1] };
        mesh
    }

    #[test]
    fn the_halves_share_the_vertices_on_the_plane() {
        let plane = Plane { axis: Axis::X, offset: 1.0 };
        let Joined { mesh, sources, images } = join(&squares(), plane, 1e-9);
        assert_eq!((mesh.points.len(), mesh.face_count()), (10, 4));
        assert_eq!(mesh.regions.of_face, [0, 0, 1, 1]);
        for (v, &point) in mesh.points.iter().enumerate() {
            assert_eq!(plane.image(point), mesh.points[images[v] as usize]);
            assert!(sources[v] as usize == v || sources[v] == images[v]);
        }
        let faults = check(&mesh);
        assert!(faults.is_clean(), "{faults}");
        assert_eq!((faults.components, faults.boundary_loops, faults.euler), (1, 1, 1));
        let apart = check(&join(&squares(), plane, 1e-15).mesh);
        assert_eq!(
            apart.count(|kind| matches!(kind, Kind::NonManifoldVertex { .. })),
            1,
            "only one vertex is shared: {apart}"
        );
    }

    #[test]
    fn a_half_that_is_not_on_the_plane_gives_two_parts() {
        let plane = Plane { axis: Axis::X, offset: 0.0 };
        assert_eq!(check(&join(&squares(), plane, 1e-9).mesh).components, 2);
    }
}
