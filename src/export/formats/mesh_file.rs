//! What the file of a mesh holds.

use crate::mesh::quality::measures_of;
use crate::mesh::transfer::{Source, SourceTree};
use crate::mesh::{Mesh, VertexAttributes};
use crate::surface::{Attribute, AttributeKind, Regions, Soup};
use rayon::prelude::*;
use rustc_hash::FxHashMap;
use std::borrow::Cow;
use std::ops::Range;

/// A mesh whose faces are in the order of files, and what is known of its vertices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshFile {
    mesh: Mesh,
    vertices: Vec<VertexAttributes>,
    /// Where each vertex lies on the input; empty where that is not to be written.
    sources: Vec<Source>,
    /// Attributes of the input: first a tuple a vertex, then those of corners that differ from their vertex.
    attributes: Vec<Attribute>,
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
    pub name: Cow<'a, str>,
    pub components: usize,
    pub values: Values<'a>,
}

impl MeshFile {
    /// A finished mesh, and what is known of its vertices.
    pub fn new(mesh: &Mesh, vertices: &[VertexAttributes]) -> Self {
        Self { vertices: vertices.to_vec(), ..Self::from(mesh) }
    }

    /// The same with the attributes of the triangles that the surface was made of, and, if that is asked for, with the place of each
    /// vertex on these.
    pub fn with_input(mut self, soup: &Soup, with_source: bool) -> Self {
        if !with_source && soup.attributes.list.is_empty() {
            return self;
        }
        let tree = SourceTree::new(soup);
        let sources = tree.sources(&self.mesh.points);
        self.attributes = tree.attributes(&self.mesh, &sources);
        if with_source { self.with_sources(sources) } else { self }
    }

    /// The same with attributes: first a tuple a vertex, then those of corners that differ from their vertex, as
    /// [`SourceTree::attributes`] gives them for [`MeshFile::mesh`].
    pub fn with_attributes(self, attributes: Vec<Attribute>) -> Self {
        Self { attributes, ..self }
    }

    /// The same with the place of each vertex on the input.
    pub fn with_sources(self, sources: Vec<Source>) -> Self {
        Self { sources, ..self }
    }

    /// The first attribute of a kind.
    pub(super) fn attribute(&self, kind: AttributeKind) -> Option<&Attribute> {
        self.attributes.iter().find(|attribute| attribute.kind == kind)
    }

    /// The same with a vertex for each tuple of texture coordinates, for formats that have these at vertices alone.
    pub(super) fn split_at_seams(&self) -> Cow<'_, Self> {
        let Some(texture) = self.attribute(AttributeKind::Texture).filter(|texture| !texture.of_corners.is_empty())
        else {
            return Cow::Borrowed(self);
        };
        let mut origins: Vec<u32> = (0..self.mesh.points.len() as u32).collect();
        origins.resize(texture.values.len() / texture.components, 0);
        for (&number, &vertex) in texture.of_corners.iter().zip(self.mesh.faces().flatten()) {
            origins[number as usize] = vertex;
        }
        let mut mesh = Mesh::new(origins.iter().map(|&v| self.mesh.points[v as usize]).collect());
        let mut start = 0;
        for face in self.mesh.faces() {
            mesh.push_face(&texture.of_corners[start..start + face.len()]);
            start += face.len();
        }
        mesh.regions = self.mesh.regions.clone();
        let split = |attribute: &Attribute| {
            let values = match attribute.of_corners.is_empty() {
                true => origins.iter().flat_map(|&v| attribute.tuple(v)).copied().collect(),
                false => attribute.values.clone(),
            };
            Attribute { values, of_corners: Vec::new(), ..attribute.clone() }
        };
        let attributes = self.attributes.iter().map(split).collect();
        Cow::Owned(Self { mesh, attributes, ..Self::default() })
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

    /// Arrays of vertices: `kind` (0 free, 1 on a boundary, 2 on a feature curve, 3 a corner) and `field` (a direction of the
    /// cross) where these are known, and those of [`MeshFile::given_arrays`].
    pub(super) fn vertex_arrays(&self) -> Vec<Array<'_>> {
        let mut arrays = Vec::new();
        if !self.vertices.is_empty() {
            let kinds = self.vertices.iter().map(|vertex| vertex.kind as i32).collect();
            let field = self.vertices.iter().flat_map(|vertex| vertex.direction).collect();
            arrays.extend([
                Array { name: "kind".into(), components: 1, values: Values::Integers(kinds) },
                Array { name: "field".into(), components: 3, values: Values::Floats(Cow::Owned(field)) },
            ]);
        }
        for array in self.given_arrays() {
            if arrays.iter().all(|known| known.name != array.name) {
                arrays.push(array);
            }
        }
        arrays
    }

    /// Arrays of vertices from the input: `source_triangle` (counted from 0) and `source_barycentric` (the coordinates in it)
    /// where these are asked for, and attributes; colours are bytes.
    pub(super) fn given_arrays(&self) -> Vec<Array<'_>> {
        let mut arrays = Vec::new();
        if !self.sources.is_empty() {
            let triangles = self.sources.iter().map(|source| source.triangle as i32).collect();
            let barycentric = self.sources.iter().flat_map(|source| source.barycentric).collect();
            arrays.extend([
                Array { name: "source_triangle".into(), components: 1, values: Values::Integers(triangles) },
                Array {
                    name: "source_barycentric".into(),
                    components: 3,
                    values: Values::Floats(Cow::Owned(barycentric)),
                },
            ]);
        }
        for Attribute { name, kind, components, values, .. } in &self.attributes {
            let of_vertices = &values[..components * self.mesh.points.len()];
            let values = match kind {
                AttributeKind::Colour => {
                    Values::Bytes(of_vertices.iter().map(|&x| (255.0 * x).round() as u8).collect())
                }
                AttributeKind::Texture | AttributeKind::Numbers => Values::Floats(of_vertices.into()),
            };
            arrays.push(Array { name: name.into(), components: *components, values });
        }
        arrays
    }

    /// Arrays of faces: `region` (an index into the names of regions), `shape` (Qg of a quad, Tg of a triangle) and
    /// `scaled_jacobian` (of a quad). Other faces have NaN.
    pub(super) fn face_arrays(&self) -> Vec<Array<'static>> {
        let count = self.mesh.face_count();
        let mut region: Vec<i32> = self.mesh.regions.of_face.iter().map(|&region| region as i32).collect();
        region.resize(count, 0);
        let measures =
            (0..count).into_par_iter().with_min_len(1024).map(|face| measures_of(&self.mesh, self.mesh.face(face)));
        let (shape, jacobian): (Vec<f64>, Vec<f64>) = measures.unzip();
        vec![
            Array { name: "region".into(), components: 1, values: Values::Integers(region) },
            Array { name: "shape".into(), components: 1, values: Values::Floats(shape.into()) },
            Array { name: "scaled_jacobian".into(), components: 1, values: Values::Floats(jacobian.into()) },
        ]
    }
}

impl From<&Mesh> for MeshFile {
    /// A mesh of whose vertices nothing is known.
    fn from(mesh: &Mesh) -> Self {
        Self { mesh: ordered(mesh), ..Self::default() }
    }
}

impl From<&Soup> for MeshFile {
    /// Triangles with their attributes.
    fn from(soup: &Soup) -> Self {
        let Soup { points, triangles, regions, attributes } = soup;
        let mesh = Mesh::from(Soup { regions: regions.clone(), ..Soup::new(points.clone(), triangles.clone()) });
        let order = file_order(&mesh);
        let attributes = attributes.list.iter().map(|attribute| at_vertices_first(attribute, soup, &order)).collect();
        Self { mesh: in_order(&mesh, &order), attributes, ..Self::default() }
    }
}

/// An attribute of triangles in an order, with a tuple a vertex first: that of the first corner there, of zeros where it has none.
fn at_vertices_first(attribute: &Attribute, soup: &Soup, order: &[usize]) -> Attribute {
    if attribute.of_corners.is_empty() {
        return attribute.clone();
    }
    let components = attribute.components;
    let mut first: Vec<Option<&[f64]>> = vec![None; soup.points.len()];
    let corners = || {
        let of_triangle = |&t: &usize| (0..3).map(move |k| (soup.triangles[t][k], attribute.of_corners[3 * t + k]));
        order.iter().flat_map(of_triangle).map(|(vertex, number)| (vertex, attribute.tuple(number)))
    };
    for (vertex, tuple) in corners() {
        first[vertex as usize].get_or_insert(tuple);
    }
    let zeros = vec![0.0; components];
    let mut values = first.iter().flat_map(|tuple| tuple.unwrap_or(&zeros)).copied().collect::<Vec<f64>>();
    let mut more: FxHashMap<(u32, Vec<u64>), u32> = FxHashMap::default();
    let of_corners = corners().map(|(vertex, tuple)| {
        if first[vertex as usize] == Some(tuple) {
            return vertex;
        }
        *more.entry((vertex, tuple.iter().map(|x| x.to_bits()).collect())).or_insert_with(|| {
            values.extend(tuple);
            (values.len() / components) as u32 - 1
        })
    });
    let of_corners = of_corners.collect();
    Attribute { values, of_corners, ..attribute.clone() }
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
    in_order(mesh, &file_order(mesh))
}

/// The faces in the order of files.
fn file_order(mesh: &Mesh) -> Vec<usize> {
    let region = |face: usize| mesh.regions.of_face.get(face).copied().unwrap_or(0);
    let mut order: Vec<usize> = (0..mesh.face_count()).collect();
    order.sort_by_key(|&face| (region(face), Kind::of(mesh.face(face))));
    order
}

fn in_order(mesh: &Mesh, order: &[usize]) -> Mesh {
    let mut sorted = Mesh::new(mesh.points.clone());
    order.iter().for_each(|&face| sorted.push_face(mesh.face(face)));
    let Regions { names, of_face } = &mesh.regions;
    if !of_face.is_empty() {
        let of_face = order.iter().map(|&face| of_face.get(face).copied().unwrap_or(0)).collect();
        sorted.regions = Regions { names: names.clone(), of_face };
    }
    sorted
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
    fn triangles_keep_the_values_of_their_corners_in_any_order_of_regions() {
        let points = vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [9.0; 3]];
        let mut soup = Soup::new(points, vec![[0, 1, 2], [0, 2, 3]]);
        soup.regions = Regions { names: vec!["a".to_owned(), "b".to_owned()], of_face: vec![1, 0] };
        // Vertex 0 has two values, vertex 2 has the same one twice.
        let values = [0.0, 1.0, 2.0, 7.0, 2.0, 3.0].iter().flat_map(|&u| [u, -u]).collect();
        let texture = Attribute::of_vertices("", AttributeKind::Texture, 2, values);
        soup.attributes.list = vec![Attribute { of_corners: (0..6).collect(), ..texture }];
        let file = MeshFile::from(&soup);
        assert_eq!(file.mesh().faces().collect::<Vec<_>>(), [[0, 2, 3], [0, 1, 2]]);
        let found = file.attribute(AttributeKind::Texture).expect("it is there");
        assert_eq!(found.of_corners, [0, 2, 3, 5, 1, 2]);
        assert_eq!(found.values, [7.0, -7.0, 1.0, -1.0, 2.0, -2.0, 3.0, -3.0, 0.0, 0.0, 0.0, 0.0]);
        assert_eq!(file.split_at_seams().mesh().points.len(), 6);
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
}
