//! Reads surfaces from files.
//!
//! # Practice
//! Wavefront OBJ goes through the crate `tobj`, which is given nothing but positions and faces: normals, texture
//! coordinates, colours, groups, lines and points say nothing about the shape, and mistakes in them must not keep a
//! surface from being read. Polygons are triangulated by ear clipping. `tobj` does not say where a file is wrong, so after a
//! failure a scan of our own finds the line.

use std::borrow::Cow;
use std::fs;
use std::io;
use std::path::Path;

use glam::DVec3;

use super::{Soup, polygon};

/// Why a file gave no surface.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LoadError {
    /// There is no such file.
    #[error("there is no file {file}; check the path")]
    Missing {
        /// The path that was given.
        file: String,
    },
    /// The path is a directory's.
    #[error("{file} is a directory; name a file in it")]
    Directory {
        /// The path that was given.
        file: String,
    },
    /// The operating system could not read the file.
    #[error("{file} cannot be read ({source}); check its permissions and the disk")]
    Unreadable {
        /// The path that was given.
        file: String,
        /// What the operating system said.
        source: io::Error,
    },
    /// The file's ending is that of no format we read.
    #[error("{file} does not end in .obj; convert it to Wavefront OBJ")]
    UnknownFormat {
        /// The path that was given.
        file: String,
    },
    /// The file has no bytes.
    #[error("{file} is empty; write the surface to it again")]
    Empty {
        /// The file's name.
        file: String,
    },
    /// The file holds bytes that no text has.
    #[error("{file} is not a text file (byte {offset} is zero); convert it to Wavefront OBJ")]
    Binary {
        /// The file's name.
        file: String,
        /// Where the first zero byte is, counted from 0.
        offset: usize,
    },
    /// There is no `v` line.
    #[error("{file} has no vertices (lines that begin with v); check that it is a Wavefront OBJ file")]
    NoVertices {
        /// The file's name.
        file: String,
    },
    /// There is no `f` line.
    #[error("{file} has {vertices} vertices but no faces (lines that begin with f); export it as a surface")]
    NoFaces {
        /// The file's name.
        file: String,
        /// The number of `v` lines.
        vertices: usize,
    },
    /// One line is wrong.
    #[error("{file}, line {line}: {fault}{}", if *.unended { "; it is the last line and has no end, so the file may be cut off" } else { "" })]
    Line {
        /// The file's name.
        file: String,
        /// The line's number, counted from 1.
        line: usize,
        /// What is wrong with it.
        fault: LineFault,
        /// It is the file's last line, without the end that lines have.
        unended: bool,
    },
    /// The parser refused the file for a reason that is not ours to name.
    #[error("{file} is not understood ({reason}); export it again with plain v and f lines")]
    Parser {
        /// The file's name.
        file: String,
        /// What the parser said.
        reason: String,
    },
}

/// What is wrong with one line of a file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LineFault {
    /// A coordinate is not a number.
    #[error("the coordinate {word:?} is not a number; write it like 0.25 or 2.5e-1")]
    NotANumber {
        /// The coordinate as written, shortened.
        word: String,
    },
    /// A coordinate is NaN, infinite or past the range of double precision.
    #[error("the coordinate {word:?} is not finite; every coordinate must be a number of size below 1.8e308")]
    NotFinite {
        /// The coordinate as written, shortened.
        word: String,
    },
    /// A fourth coordinate of zero puts the vertex at infinity.
    #[error("the weight (fourth coordinate) is zero; leave it out or write 1")]
    ZeroWeight,
    /// A vertex without all of x, y and z.
    #[error("the vertex has {count} of 3 coordinates; write x, y and z")]
    TooFewCoordinates {
        /// The number of coordinates it has.
        count: usize,
    },
    /// A face's corner is not an integer.
    #[error("{word:?} is not a vertex index; write a whole number, counted from 1")]
    NotAnIndex {
        /// The corner as written, shortened.
        word: String,
    },
    /// A face uses vertex 0.
    #[error("the face uses vertex 0; OBJ counts vertices from 1")]
    IndexZero,
    /// A face uses a vertex that does not exist.
    #[error("the face uses vertex {index}, but there are {vertices} vertices; correct the index or add the vertex")]
    IndexOutOfRange {
        /// The index as written.
        index: i64,
        /// The number of vertices it can use: all, or, if the index is negative, those before the face.
        vertices: usize,
    },
    /// A face with fewer than three corners.
    #[error("the face has {count} corners but needs at least 3; complete it or take it out")]
    TooFewIndices {
        /// The number of corners it has.
        count: usize,
    },
}

/// Reads a surface. Wavefront OBJ (`.obj`) is the one format.
///
/// # Errors
/// [`LoadError`] says what is wrong, where, and what to do.
pub fn read(path: &Path) -> Result<Soup, LoadError> {
    let (text, file) = contents(path)?;
    parse_obj(&text, &file)
}

/// A file's bytes, and its name as errors say it.
pub(crate) fn contents(path: &Path) -> Result<(Vec<u8>, String), LoadError> {
    let file = path.display().to_string();
    if path.is_dir() {
        return Err(LoadError::Directory { file });
    }
    if matches!(path.try_exists(), Ok(false)) {
        return Err(LoadError::Missing { file });
    }
    if !path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("obj")) {
        return Err(LoadError::UnknownFormat { file });
    }
    let text = fs::read(path).map_err(|source| LoadError::Unreadable { file: file.clone(), source })?;
    Ok((text, file))
}

/// Reads a surface from the bytes of a Wavefront OBJ file. Keeps the vertices that faces use, in order of first use.
///
/// # Errors
/// As [`read`]; messages call the file `name`.
pub fn parse_obj(text: &[u8], name: &str) -> Result<Soup, LoadError> {
    polygons(text, name, false).map(|mesh| triangulated(&mesh))
}

/// The polygons of a Wavefront OBJ file. With `all_vertices`, vertices stay in the order of the file, and so do those that
/// no face uses; each is then a face of one corner as well, before the others.
pub(crate) fn polygons(text: &[u8], name: &str, all_vertices: bool) -> Result<tobj::Mesh, LoadError> {
    if text.is_empty() {
        return Err(LoadError::Empty { file: name.to_owned() });
    }
    if let Some(offset) = text.iter().position(|&byte| byte == 0) {
        return Err(LoadError::Binary { file: name.to_owned(), offset });
    }
    // Indexed by position alone: else tobj splits vertices where texture coordinates differ.
    let options = tobj::LoadOptions { single_index: false, ignore_points: !all_vertices, ..Default::default() };
    let no_materials = |_: &Path| Ok(Default::default());
    let points = if all_vertices { one_point_a_vertex(text) } else { String::new() };
    let mesh = tobj::load_obj_buf(&mut (points + &positions_and_faces(text)).as_bytes(), &options, no_materials)
        .map_err(|error| explained(text, name, &error.to_string()))?
        .0
        .pop()
        .map(|model| model.mesh)
        .unwrap_or_default();
    let finite = mesh.positions.iter().all(|coordinate| coordinate.is_finite());
    let singles = if all_vertices { mesh.positions.len() / 3 } else { 0 };
    let faces = mesh.face_arities.get(singles..).unwrap_or_default();
    if !finite || mesh.indices.len() <= singles || faces.iter().any(|&corners| corners < 3) {
        return Err(explained(text, name, "some faces or coordinates make no sense"));
    }
    Ok(mesh)
}

/// Makes `tobj` see every vertex, in order, before any face; it knows no `p` lines.
fn one_point_a_vertex(text: &[u8]) -> String {
    let vertices = lines(text).filter(|(_, line)| matches!(Record::of(line), Some(Record::Vertex(_)))).count();
    (1..=vertices).map(|vertex| format!("f {vertex}\n")).collect()
}

fn triangulated(mesh: &tobj::Mesh) -> Soup {
    let points: Vec<_> = mesh.positions.chunks_exact(3).map(|xyz| [xyz[0], xyz[1], xyz[2]]).collect();
    // No arities: tobj's way to say that all faces are triangles.
    if mesh.face_arities.is_empty() {
        let triangles = mesh.indices.chunks_exact(3).map(|corners| [corners[0], corners[1], corners[2]]).collect();
        return Soup { points, triangles };
    }
    let mut triangles = Vec::with_capacity(mesh.indices.len());
    let mut rest = &mesh.indices[..];
    for &count in &mesh.face_arities {
        let (face, after) = rest.split_at(count as usize);
        rest = after;
        let corners: Vec<_> = face.iter().map(|&index| DVec3::from_array(points[index as usize])).collect();
        triangles.extend(polygon::triangulate(&corners).iter().map(|ear| ear.map(|place| face[place])));
    }
    Soup { points, triangles }
}

/// The lines with their numbers, counted from 1: comments cut off, continued lines joined.
fn lines(text: &[u8]) -> impl Iterator<Item = (usize, Cow<'_, str>)> {
    let text = text.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(text);
    let mut physical = text.split(|&byte| byte == b'\n').enumerate().map(|(index, line)| {
        let end = line.iter().position(|&byte| byte == b'#').unwrap_or(line.len());
        (index + 1, String::from_utf8_lossy(line[..end].trim_ascii()))
    });
    std::iter::from_fn(move || {
        let (number, mut line) = physical.next()?;
        while let Some(begun) = line.strip_suffix('\\') {
            let (_, continued) = physical.next().unwrap_or_default();
            line = format!("{begun} {continued}").into();
        }
        Some((number, line))
    })
}

/// A line that shapes the surface.
enum Record<'a> {
    /// Its coordinates: x, y, z and, where no colour follows, the weight.
    Vertex(Vec<&'a str>),
    /// The vertex index of each corner.
    Face(Vec<&'a str>),
}

impl<'a> Record<'a> {
    fn of(line: &'a str) -> Option<Self> {
        let mut words = line.split_whitespace();
        match words.next()? {
            "v" => {
                let mut coordinates: Vec<_> = words.collect();
                if coordinates.len() > 4 {
                    coordinates.truncate(3);
                }
                Some(Self::Vertex(coordinates))
            }
            // A corner without a vertex index stays as it is, to be refused.
            "f" => Some(Self::Face(
                words.map(|word| word.split('/').next().filter(|index| !index.is_empty()).unwrap_or(word)).collect(),
            )),
            _ => None,
        }
    }
}

/// What is left for `tobj` to parse.
fn positions_and_faces(text: &[u8]) -> String {
    let mut kept = String::with_capacity(text.len());
    for (_, line) in lines(text) {
        let (letter, words) = match Record::of(&line) {
            Some(Record::Vertex(words)) => ('v', words),
            Some(Record::Face(words)) => ('f', words),
            None => continue,
        };
        kept.push(letter);
        for word in words {
            kept.push(' ');
            kept.push_str(word);
        }
        kept.push('\n');
    }
    kept
}

/// The error for a text that gave no surface: the first wrong line, or what is missing altogether.
fn explained(text: &[u8], name: &str, reason: &str) -> LoadError {
    let file = name.to_owned();
    let count = |wanted: fn(&Record) -> bool| {
        lines(text).filter(|(_, line)| Record::of(line).is_some_and(|record| wanted(&record))).count()
    };
    let vertices = count(|record| matches!(record, Record::Vertex(_)));
    let faces = count(|record| matches!(record, Record::Face(_)));
    let mut vertices_before = 0;
    for (line, content) in lines(text) {
        let fault = match Record::of(&content) {
            Some(Record::Vertex(words)) => {
                vertices_before += 1;
                vertex_fault(&words)
            }
            Some(Record::Face(words)) => face_fault(&words, vertices_before, vertices),
            None => None,
        };
        if let Some(fault) = fault {
            let unended = !text.ends_with(b"\n") && lines(text).last().is_some_and(|(last, _)| last == line);
            return LoadError::Line { file, line, fault, unended };
        }
    }
    match (vertices, faces) {
        (0, _) => LoadError::NoVertices { file },
        (_, 0) => LoadError::NoFaces { file, vertices },
        _ => LoadError::Parser { file, reason: reason.to_owned() },
    }
}

fn vertex_fault(words: &[&str]) -> Option<LineFault> {
    for word in words {
        match word.parse::<f64>() {
            Err(_) => return Some(LineFault::NotANumber { word: shortened(word) }),
            Ok(number) if !number.is_finite() => return Some(LineFault::NotFinite { word: shortened(word) }),
            Ok(_) => {}
        }
    }
    match words {
        [] | [_] | [_, _] => Some(LineFault::TooFewCoordinates { count: words.len() }),
        [.., weight] if words.len() == 4 && weight.parse() == Ok(0.0) => Some(LineFault::ZeroWeight),
        _ => None,
    }
}

fn face_fault(words: &[&str], vertices_before: usize, vertices: usize) -> Option<LineFault> {
    for word in words {
        let fault = match word.parse::<i64>() {
            Err(_) => LineFault::NotAnIndex { word: shortened(word) },
            Ok(0) => LineFault::IndexZero,
            Ok(index) if index > 0 && index.unsigned_abs() > vertices as u64 => {
                LineFault::IndexOutOfRange { index, vertices }
            }
            Ok(index) if index < 0 && index.unsigned_abs() > vertices_before as u64 => {
                LineFault::IndexOutOfRange { index, vertices: vertices_before }
            }
            Ok(_) => continue,
        };
        return Some(fault);
    }
    (words.len() < 3).then_some(LineFault::TooFewIndices { count: words.len() })
}

/// A word as an error message can show it.
fn shortened(word: &str) -> String {
    const MOST: usize = 32;
    let mut short: String = word.chars().take(MOST).collect();
    if short.len() < word.len() {
        short.push_str("...");
    }
    short
}
