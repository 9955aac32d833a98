//! Where the vertices of a finished mesh lie on the input, and the attributes that they have there.
//!
//! # Practice
//! The nearest triangle of the input and the barycentric coordinates of the nearest point in it give a value by linear
//! interpolation. Texture coordinates jump at seams: there corners of faces at the same vertex have values of their own. A corner's
//! value is that towards the middle of its face.

use super::Mesh;
use crate::surface::nearest::{Triangles, nearest_weights};
use crate::surface::{Attribute, AttributeKind, Frame, Soup};
use glam::DVec3;
use rayon::prelude::*;

/// Steps from a vertex towards the middle of a face, of which two tell the side of a seam.
const STEPS: f64 = 16.0;
/// Values that differ by a smaller share of the extent of all are the same.
const SAME: f64 = 1e-3;
/// Values that differ by a larger share of it from one step to the next have a seam between them.
const JUMP: f64 = 0.1;

/// A place on the input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Source {
    /// The triangle, counted from 0.
    pub triangle: u32,
    /// The barycentric coordinates in it, none of them negative.
    pub barycentric: [f64; 3],
}

/// The triangles of an input that can be meshed, in a tree.
pub struct SourceTree<'a> {
    soup: &'a Soup,
    /// The tree has unit-sized coordinates.
    frame: Frame,
    triangles: Triangles,
}

impl<'a> SourceTree<'a> {
    /// Sorts the triangles.
    pub fn new(soup: &'a Soup) -> Self {
        let used = || (0..soup.triangles.len() as u32).flat_map(|t| corners(soup, t));
        let (low, high) = (used().fold(DVec3::INFINITY, DVec3::min), used().fold(DVec3::NEG_INFINITY, DVec3::max));
        let frame = Frame::of_box(low, high);
        let unit = |p: DVec3| DVec3::from(frame.to_unit(p.into()));
        let triangles = Triangles::of(soup.triangles.len() as u32, |t| corners(soup, t).map(unit));
        Self { soup, frame, triangles }
    }

    /// The places of points, in model units.
    pub fn sources(&self, points: &[[f64; 3]]) -> Vec<Source> {
        points.par_iter().with_min_len(256).map(|&point| self.source(point.into())).collect()
    }

    fn source(&self, point: DVec3) -> Source {
        let (triangle, _) = self.triangles.nearest(self.frame.to_unit(point.into()).into());
        Source { triangle, barycentric: nearest_weights(point, corners(self.soup, triangle)) }
    }

    /// The attributes of a mesh whose vertices have these sources: first a tuple a vertex, then those of corners that differ from
    /// their vertex.
    pub fn attributes(&self, mesh: &Mesh, sources: &[Source]) -> Vec<Attribute> {
        let transferred = |attribute: &Attribute| {
            let values = sources.par_iter().flat_map_iter(|source| self.value(attribute, source)).collect();
            let transferred = Attribute { values, of_corners: Vec::new(), ..attribute.clone() };
            match attribute.kind {
                AttributeKind::Texture => self.with_corners(mesh, attribute, transferred),
                _ => transferred,
            }
        };
        self.soup.attributes.list.iter().map(transferred).collect()
    }

    fn value(&self, attribute: &Attribute, source: &Source) -> Vec<f64> {
        let Source { triangle, barycentric } = *source;
        let vertices = self.soup.triangles[triangle as usize];
        let mut sum = vec![0.0; attribute.components];
        for (k, weight) in barycentric.into_iter().enumerate() {
            let tuple = attribute.at_corner(3 * triangle as usize + k, vertices[k]);
            sum.iter_mut().zip(tuple).for_each(|(sum, value)| *sum += weight * value);
        }
        sum
    }

    /// Adds the tuples of corners that differ from their vertex.
    fn with_corners(&self, mesh: &Mesh, attribute: &Attribute, mut transferred: Attribute) -> Attribute {
        let components = attribute.components;
        let tolerance: Vec<f64> = (0..components).map(|k| SAME * extent(&transferred.values, k, components)).collect();
        let is_same = |a: &[f64], b: &[f64]| (0..components).all(|k| (a[k] - b[k]).abs() <= tolerance[k]);
        let of_face = |face: usize| {
            let middle = mesh.middle(mesh.face(face));
            let of_corner = |&vertex: &u32| {
                let point = DVec3::from(mesh.points[vertex as usize]);
                let at = |steps: f64| self.value(attribute, &self.source(point.lerp(middle, steps / STEPS)));
                let (near, far) = (at(1.0), at(2.0));
                // Values are linear nearby, but where a seam passes through the face.
                let is_cut = (0..components).any(|k| (near[k] - far[k]).abs() > JUMP * tolerance[k] / SAME);
                let value: Vec<f64> = near.iter().zip(far).map(|(near, far)| 2.0 * near - far).collect();
                (!is_cut && !is_same(&value, transferred.tuple(vertex))).then_some(value)
            };
            mesh.face(face).iter().map(of_corner).collect::<Vec<_>>()
        };
        let of_faces: Vec<_> = (0..mesh.face_count()).into_par_iter().with_min_len(64).map(of_face).collect();
        if of_faces.iter().flatten().all(Option::is_none) {
            return transferred;
        }
        // The tuples that each vertex has beside its own.
        let mut more: Vec<Vec<u32>> = vec![Vec::new(); mesh.points.len()];
        for (&vertex, value) in mesh.faces().flatten().zip(of_faces.into_iter().flatten()) {
            let known = |value: &Vec<f64>| {
                more[vertex as usize].iter().copied().find(|&number| is_same(transferred.tuple(number), value))
            };
            let number = match value.map(|value| known(&value).ok_or(value)) {
                None => vertex,
                Some(Ok(number)) => number,
                Some(Err(value)) => {
                    let number = (transferred.values.len() / components) as u32;
                    transferred.values.extend(value);
                    more[vertex as usize].push(number);
                    number
                }
            };
            transferred.of_corners.push(number);
        }
        transferred
    }
}

fn corners(soup: &Soup, triangle: u32) -> [DVec3; 3] {
    soup.triangles[triangle as usize].map(|v| DVec3::from(soup.points[v as usize]))
}

/// The extent of a component of tuples.
fn extent(values: &[f64], component: usize, components: usize) -> f64 {
    let of = values.iter().skip(component).step_by(components);
    let (low, high) = of.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &x| (low.min(x), high.max(x)));
    (high - low).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square of two triangles with texture coordinates (x, y), on the upper one shifted, and a number x + 2 y.
    fn square(shift: f64) -> Soup {
        let points = vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let triangles = vec![[0, 1, 2], [0, 2, 3]];
        let mut soup = Soup { points, triangles, ..Soup::default() };
        let corners = soup.triangles.iter().flatten().map(|&v| soup.points[v as usize]);
        let values = corners.zip(0..).flat_map(|([x, y, _], k)| [x + if k < 3 { 0.0 } else { shift }, y]).collect();
        let texture = Attribute::of_vertices("", AttributeKind::Texture, 2, values);
        let numbers = soup.points.iter().map(|[x, y, _]| x + 2.0 * y).collect();
        soup.attributes.list = vec![
            Attribute { of_corners: (0..6).collect(), ..texture },
            Attribute::of_vertices("heat", AttributeKind::Numbers, 1, numbers),
        ];
        soup
    }

    /// Four quads on the square, cut along the diagonal into triangles.
    fn mesh() -> Mesh {
        let points = (0..9).map(|k| [f64::from(k % 3) / 2.0, f64::from(k / 3) / 2.0, 0.0]).collect();
        let mut mesh = Mesh::new(points);
        for face in [&[0, 1, 4][..], &[0, 4, 3], &[1, 2, 5, 4], &[3, 4, 7, 6], &[4, 5, 8], &[4, 8, 7]] {
            mesh.push_face(face);
        }
        mesh
    }

    #[test]
    fn values_are_linear_and_corners_at_seams_have_their_own() {
        for shift in [0.0, 5.0] {
            let (soup, mesh) = (square(shift), mesh());
            let tree = SourceTree::new(&soup);
            let attributes = tree.attributes(&mesh, &tree.sources(&mesh.points));
            let [texture, heat] = &attributes[..] else { panic!("two attributes") };
            for (v, [x, y, _]) in mesh.points.iter().enumerate() {
                assert!((heat.values[v] - x - 2.0 * y).abs() < 1e-12);
            }
            assert_eq!(texture.of_corners.is_empty(), shift == 0.0);
            let mut place = 0;
            for face in mesh.faces() {
                let middle = mesh.middle(face);
                for &v in face {
                    let [x, y, _] = mesh.points[v as usize];
                    let wanted = [x + if middle.y > middle.x { shift } else { 0.0 }, y];
                    let found = texture.at_corner(place, v);
                    assert!((0..2).all(|k| (found[k] - wanted[k]).abs() < 1e-12), "{found:?} {wanted:?}");
                    place += 1;
                }
            }
            // The three vertices on the diagonal have one tuple more.
            assert_eq!(texture.values.len(), if shift == 0.0 { 18 } else { 24 });
        }
    }
}
