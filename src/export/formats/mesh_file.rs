//! What the file of a mesh holds.

use crate::mesh::quality::{quad_shape, scaled_jacobian, triangle_shape};
use crate::mesh::{Mesh, VertexAttributes};
use crate::surface::{Regions, Soup};
use glam::DVec3;
use rayon::prelude::*;
use std::borrow::Cow;
use std::ops::Range;

/// A mesh whose faces are in the order of files, and what is known of its vertices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshFile {
    mesh: Mesh,
    vertices: Vec<VertexAttributes>,
    /// The barycentric coordinates of each vertex in its triangle of the input.
    barycentric: Vec<[f64; 3]>,
}

/// The faces of a region.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Group<'a> {
    /// Empty where it has none.
    pub name: &'a str,
    pub quads: Range<usize>,
    pub triangles: Range<usize>,
    pub polygons: Range<usize>,
}

impl Group<'_> {
    /// All faces.
    pub fn faces(&self) -> Range<usize> {
        self.quads.start..self.polygons.end
    }

    /// The quads and the triangles, each with the number of their corners; none that are empty.
    pub fn blocks(&self) -> impl Iterator<Item = (usize, Range<usize>)> {
        [(4, self.quads.clone()), (3, self.triangles.clone())].into_iter().filter(|(_, faces)| !faces.is_empty())
    }
}

/// The numbers of an [`Array`].
pub(super) enum Values<'a> {
    Bytes(Vec<u8>),
    Integers(Vec<i32>),
    Floats(Cow<'a, [f64]>),
}

/// A named array, so many numbers a vertex or a face.
pub(super) struct Array<'a> {
    pub name: &'static str,
    pub components: usize,
    pub values: Values<'a>,
}

impl MeshFile {
    /// A finished mesh, what is known of its vertices, and the triangles that the surface was made of.
    ///
    /// # Panics
    /// Where a vertex names a triangle that the soup does not have.
    pub fn new(mesh: &Mesh, vertices: &[VertexAttributes], soup: &Soup) -> Self {
        let corners = |triangle: u32| soup.triangles[triangle as usize].map(|v| DVec3::from(soup.points[v as usize]));
        let weights =
            |(vertex, &point): (&VertexAttributes, &[f64; 3])| barycentric(corners(vertex.triangle), point.into());
        let barycentric = vertices.par_iter().zip(&mesh.points).map(weights).collect();
        Self { mesh: ordered(mesh), vertices: vertices.to_vec(), barycentric }
    }

    /// The mesh, in the order of the file.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// What is known of the vertices; empty where nothing is.
    pub(super) fn vertices(&self) -> &[VertexAttributes] {
        &self.vertices
    }

    /// The regions that have faces; one without a name where there are no regions.
    pub(super) fn groups(&self) -> Vec<Group<'_>> {
        let regions = &self.mesh.regions;
        let mut groups = Vec::new();
        let mut start = 0;
        while start < self.mesh.face_count() {
            let region = regions.of_face.get(start);
            let faces = &regions.of_face[start.min(regions.of_face.len())..];
            let end = region.map_or(self.mesh.face_count(), |region| start + faces.partition_point(|r| r <= region));
            let until = |kind: Kind| {
                let (mut low, mut high) = (start, end);
                while low < high {
                    let middle = low + (high - low) / 2;
                    if Kind::of(self.mesh.face(middle)) <= kind { low = middle + 1 } else { high = middle }
                }
                low
            };
            let (quads, triangles) = (until(Kind::Quad), until(Kind::Triangle));
            let name = region.map_or("", |&region| regions.names[region as usize].as_str());
            groups.push(Group { name, quads: start..quads, triangles: quads..triangles, polygons: triangles..end });
            start = end;
        }
        groups
    }

    /// Arrays of vertices: `kind` (0 free, 1 on a boundary, 2 on a feature curve, 3 a corner), `source_triangle` (of the input,
    /// counted from 0), `source_barycentric` (the coordinates in it), `field` (a direction of the cross). None where nothing is
    /// known.
    pub(super) fn vertex_arrays(&self) -> Vec<Array<'_>> {
        if self.vertices.is_empty() {
            return Vec::new();
        }
        let integers =
            |value: fn(&VertexAttributes) -> i32| Values::Integers(self.vertices.iter().map(value).collect());
        let field = self.vertices.iter().flat_map(|vertex| vertex.direction).collect();
        vec![
            Array { name: "kind", components: 1, values: integers(|vertex| vertex.kind as i32) },
            Array { name: "source_triangle", components: 1, values: integers(|vertex| vertex.triangle as i32) },
            Array {
                name: "source_barycentric",
                components: 3,
                values: Values::Floats(self.barycentric.as_flattened().into()),
            },
            Array { name: "field", components: 3, values: Values::Floats(Cow::Owned(field)) },
        ]
    }

    /// Arrays of faces: `region` (an index into the names of regions), `shape` (Qg of a quad, Tg of a triangle) and
    /// `scaled_jacobian` (of a quad). Other faces have NaN.
    pub(super) fn face_arrays(&self) -> Vec<Array<'static>> {
        let count = self.mesh.face_count();
        let mut region: Vec<i32> = self.mesh.regions.of_face.iter().map(|&region| region as i32).collect();
        region.resize(count, 0);
        let measures = (0..count).into_par_iter().with_min_len(1024).map(|face| self.measures(face));
        let (shape, jacobian): (Vec<f64>, Vec<f64>) = measures.unzip();
        vec![
            Array { name: "region", components: 1, values: Values::Integers(region) },
            Array { name: "shape", components: 1, values: Values::Floats(shape.into()) },
            Array { name: "scaled_jacobian", components: 1, values: Values::Floats(jacobian.into()) },
        ]
    }

    fn measures(&self, face: usize) -> (f64, f64) {
        let point = |v: u32| self.mesh.points[v as usize];
        match *self.mesh.face(face) {
            [a, b, c] => (triangle_shape([a, b, c].map(point)), f64::NAN),
            [a, b, c, d] => {
                let corners = [a, b, c, d].map(point);
                (quad_shape(corners), scaled_jacobian(corners))
            }
            _ => (f64::NAN, f64::NAN),
        }
    }
}

impl From<&Mesh> for MeshFile {
    /// A mesh of whose vertices nothing is known.
    fn from(mesh: &Mesh) -> Self {
        Self { mesh: ordered(mesh), ..Self::default() }
    }
}

/// The kinds of faces, in the order of files.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    Quad,
    Triangle,
    Polygon,
}

impl Kind {
    fn of(face: &[u32]) -> Self {
        match face.len() {
            4 => Self::Quad,
            ..4 => Self::Triangle,
            _ => Self::Polygon,
        }
    }
}

/// The same mesh with its faces by region, and within a region quads, then triangles, then larger faces; else in their order.
pub fn ordered(mesh: &Mesh) -> Mesh {
    let region = |face: usize| mesh.regions.of_face.get(face).copied().unwrap_or(0);
    let mut order: Vec<usize> = (0..mesh.face_count()).collect();
    order.sort_by_key(|&face| (region(face), Kind::of(mesh.face(face))));
    let mut sorted = Mesh::new(mesh.points.clone());
    order.iter().for_each(|&face| sorted.push_face(mesh.face(face)));
    if !mesh.regions.of_face.is_empty() {
        let of_face = order.iter().map(|&face| region(face)).collect();
        sorted.regions = Regions { names: mesh.regions.names.clone(), of_face };
    }
    sorted
}

/// The barycentric coordinates of the point of a triangle's plane that is nearest to a point; of a triangle without area, those
/// of its first corner.
fn barycentric([a, b, c]: [DVec3; 3], point: DVec3) -> [f64; 3] {
    let normal = (b - a).cross(c - a);
    let area = normal.length_squared();
    if area == 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let [second, third] = [(c, a), (a, b)].map(|(p, q)| (q - p).cross(point - p).dot(normal) / area);
    [1.0 - second - third, second, third]
}

#[cfg(test)]
mod tests {
    use super::super::sample::{sample, with_pentagon};
    use super::*;

    #[test]
    fn regions_have_quads_then_triangles_then_larger_faces() {
        let file = sample();
        let groups = file.groups();
        let expected = [
            Group { name: "wing tip", quads: 0..1, triangles: 1..2, polygons: 2..2 },
            Group { name: "rest", quads: 2..2, triangles: 2..3, polygons: 3..3 },
        ];
        assert_eq!(groups, expected);
        let file = with_pentagon();
        assert_eq!(file.groups(), [Group { name: "", quads: 0..0, triangles: 0..1, polygons: 1..2 }]);
        assert_eq!(file.mesh().face(1), [0, 1, 4, 2, 3]);
        assert!(MeshFile::default().groups().is_empty());
    }

    #[test]
    fn faces_of_a_kind_keep_their_order() {
        let mut mesh = Mesh::new(vec![[0.0; 3]; 9]);
        for v in 0..6 {
            mesh.push_face(&[v, 6, 7, 8][..3 + v as usize % 2]);
        }
        let firsts: Vec<u32> = ordered(&mesh).faces().map(|face| face[0]).collect();
        assert_eq!(firsts, [1, 3, 5, 0, 2, 4]);
    }

    #[test]
    fn barycentric_coordinates_give_the_point() {
        let corners = [DVec3::ZERO, DVec3::new(2.0, 0.0, 1.0), DVec3::new(0.0, 3.0, 0.5)];
        for weights in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.2, 0.3, 0.5], [1.5, -0.25, -0.25]] {
            let point = (0..3).map(|k| corners[k] * weights[k]).sum::<DVec3>();
            let found = barycentric(corners, point);
            assert!((0..3).all(|k| (found[k] - weights[k]).abs() < 1e-12), "{found:?}");
        }
        assert_eq!(barycentric([DVec3::ONE; 3], DVec3::ZERO), [1.0, 0.0, 0.0]);
    }
}
