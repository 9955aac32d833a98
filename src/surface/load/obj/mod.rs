//! Wavefront OBJ, through the crate `tobj`: positions, faces and names; also colours behind positions and texture coordinates.
//! Normals are passed over.
//!
//! `tobj` reads numbers, weights and indices. It is given vertices and faces alone, one statement a line: it knows neither
//! continued lines nor comments behind a statement, takes `l` for faces, and refuses texts for mistakes in colours, texture
//! coordinates, normals and materials, which say nothing about the shape. Names are taken here, since `tobj` ends a mesh
//! with its own vertices at each of them and loses the difference of `g`, `o` and `usemtl`; so are colours and texture
//! coordinates, which may be wrong without the shape being so: then they are left out.

mod attributes;
mod fault;
mod statements;

use super::text::words;
use super::{LoadError, Polygons, Regions};
use attributes::Collected;
use statements::{Kind, Statement, lines, vertices, weight};
use std::io::{Read, Write};

/// Whether it is a text with vertices.
pub(super) fn recognises(bytes: &[u8]) -> bool {
    !bytes.contains(&0) && vertices(bytes).next().is_some()
}

pub(super) fn parse(text: &[u8], file: &str) -> Result<Polygons, LoadError> {
    let at_line = |(line, fault)| LoadError::at_line(file, text, line, fault);
    let shape = Shape::of(text);
    let vertices = shape.vertices;
    let polygons = shape.into_polygons().map_err(|reason| {
        fault::first(text, vertices).map_or_else(|| LoadError::Refused { file: file.to_owned(), reason }, at_line)
    })?;
    if polygons.points.is_empty() {
        return Err(LoadError::NoVertices { file: file.to_owned() });
    }
    if polygons.ends.is_empty() {
        return Err(LoadError::NoFaces { file: file.to_owned(), vertices });
    }
    match polygons.nowhere() {
        Some(vertex) => Err(at_line(fault::of_vertex(text, vertex))),
        None => Ok(polygons),
    }
}

/// What a text says about the shape.
#[derive(Default)]
struct Shape {
    /// The statements of vertices and faces, one a line.
    statements: Vec<u8>,
    vertices: usize,
    faces: usize,
    /// Names of regions, each with the number of faces that came before it.
    marks: Vec<(usize, String)>,
    collected: Collected,
}

/// The names that hold at a place of the text.
#[derive(Default)]
struct Names {
    object: String,
    /// Once a text has groups, objects name nothing.
    group: Option<String>,
    material: String,
}

impl Names {
    fn set(&mut self, kind: Kind, name: &[u8]) {
        let name = String::from_utf8_lossy(&words(name).collect::<Vec<_>>().join(&b' ')).into_owned();
        match kind {
            Kind::Group => self.group = Some(name),
            Kind::Object => self.object = name,
            Kind::Material => self.material = name,
        }
    }

    /// The name of the region: that of the group or object, then that of the material, as one face may have several groups.
    fn region(&self) -> String {
        let part = self.group.as_ref().unwrap_or(&self.object);
        if self.material.is_empty() || self.material == *part {
            part.clone()
        } else if part.is_empty() {
            self.material.clone()
        } else {
            format!("{part} {}", self.material)
        }
    }
}

impl Shape {
    fn of(text: &[u8]) -> Self {
        let mut shape = Self { statements: Vec::with_capacity(text.len()), ..Self::default() };
        let mut names = Names::default();
        for (_, line) in lines(text) {
            match Statement::of(&line) {
                Some(Statement::Vertex(rest)) => {
                    let (place, colour) = split_colour(rest);
                    shape.collected.push_colour(shape.vertices, colour);
                    shape.vertices += 1;
                    shape.state(b'v', place);
                }
                Some(Statement::Texture(rest)) => shape.collected.push_texture(rest),
                Some(Statement::Face(rest)) => {
                    shape.collected.push_face(rest);
                    shape.faces += 1;
                    shape.state(b'f', rest);
                }
                Some(Statement::Name(kind, rest)) => {
                    names.set(kind, rest);
                    shape.marks.push((shape.faces, names.region()));
                }
                None => {}
            }
        }
        shape
    }

    fn state(&mut self, keyword: u8, rest: &[u8]) {
        self.statements.push(keyword);
        self.statements.extend_from_slice(rest);
        self.statements.push(b'\n');
    }

    /// The polygons, or why there are none.
    fn into_polygons(self) -> Result<Polygons, String> {
        // tobj numbers vertices by first use. After a face of all of them, that is the order of the file.
        let mut first = b"f".to_vec();
        for vertex in 1..=self.vertices {
            write!(first, " {vertex}").map_err(|error| error.to_string())?;
        }
        first.push(b'\n');
        let mut reader = first.chain(&self.statements[..]);
        let no_materials = |_: &std::path::Path| Ok(Default::default());
        let (models, _) = tobj::load_obj_buf(&mut reader, &tobj::LoadOptions::default(), no_materials)
            .map_err(|error| error.to_string())?;
        let mesh = models.into_iter().map(|model| model.mesh).next().unwrap_or_default();

        let points = mesh.positions.as_chunks().0.to_vec();
        let mut polygons =
            Polygons { points, regions: Regions::from_marks(&self.marks, self.faces), ..Polygons::default() };
        polygons.corners.reserve(mesh.indices.len());
        let mut corners = mesh.indices.iter().skip(self.vertices);
        for face in 1..=self.faces {
            // Where all faces are triangles, tobj leaves their sizes out.
            let size = mesh.face_arities.get(face).map_or(3, |&size| size as usize);
            polygons.corners.extend(corners.by_ref().take(size));
            polygons.end_face().map_err(|fault| fault.to_string())?;
        }
        polygons.attributes = self.collected.finish(self.vertices, polygons.corners.len());
        Ok(polygons)
    }
}

/// A vertex's coordinates and its weight, and its colour.
fn split_colour(vertex: &[u8]) -> (&[u8], &[u8]) {
    match words(vertex).nth(2) {
        Some(last) if weight(vertex).is_none() => {
            let end = last.as_ptr_range().end.addr() - vertex.as_ptr().addr();
            vertex.split_at(end)
        }
        _ => (vertex, b""),
    }
}
