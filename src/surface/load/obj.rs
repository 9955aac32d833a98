//! Wavefront OBJ: positions, faces and names.
//!
//! Normals, texture coordinates, colours, materials, lines and points say nothing about the shape, and mistakes in them
//! must not keep a surface from being read. The text is parsed in pieces of whole lines, in parallel; a first pass counts
//! each piece's lines and vertices, so that every piece knows its line numbers and what its indices mean.

use super::text::{coordinates, number, parsed, shown, words};
use super::{Fault, LoadError, Polygons};
use rayon::prelude::*;
use std::borrow::Cow;

/// Bytes of a piece, its last line aside.
const PIECE: usize = 1 << 20;

/// Whether it is a text with vertices.
pub(super) fn recognises(bytes: &[u8]) -> bool {
    !bytes.contains(&0) && vertex_lines(bytes).next().is_some()
}

pub(super) fn parse(text: &[u8], file: &str) -> Result<Polygons, LoadError> {
    let pieces = pieces(text);
    let counts: Vec<Start> = pieces.par_iter().map(|piece| Start::after(piece)).collect();
    let mut all = Start::default();
    let mut starts = Vec::with_capacity(pieces.len());
    for count in &counts {
        starts.push(all);
        all = Start { lines: all.lines + count.lines, vertices: all.vertices + count.vertices };
    }
    let parts: Vec<_> =
        pieces.par_iter().zip(&starts).map(|(piece, start)| Part::parse(piece, *start, all.vertices)).collect();

    let mut whole = Polygons { points: Vec::with_capacity(all.vertices), ..Default::default() };
    let mut grouped = false;
    for part in parts {
        let Part { polygons, kinds } = part.map_err(|(line, fault)| LoadError::at_line(file, text, line, fault))?;
        let (faces, corners) = (whole.ends.len(), whole.corners.len() as u32);
        whole.points.extend(polygons.points);
        whole.corners.extend(polygons.corners);
        whole.ends.extend(polygons.ends.iter().map(|end| end + corners));
        for ((face, name), kind) in polygons.marks.into_iter().zip(kinds) {
            grouped |= kind == Name::Group;
            if kind == Name::Group || !grouped {
                whole.marks.push((faces + face, name));
            }
        }
    }
    if whole.points.is_empty() {
        return Err(LoadError::NoVertices { file: file.to_owned() });
    }
    if whole.ends.is_empty() {
        return Err(LoadError::NoFaces { file: file.to_owned(), vertices: whole.points.len() });
    }
    if let Some(vertex) = whole.nowhere() {
        let (line, fault) = no_place(text, vertex);
        return Err(LoadError::at_line(file, text, line, fault));
    }
    Ok(whole)
}

/// The text cut where a line ends that is not continued.
fn pieces(text: &[u8]) -> Vec<&[u8]> {
    let mut pieces = Vec::new();
    let mut rest = text;
    while !rest.is_empty() {
        let mut end = rest.len().min(PIECE);
        while let Some(more) = rest[end..].iter().position(|&byte| byte == b'\n') {
            let last = rest[..end + more].rsplit(|&byte| byte == b'\n').next().unwrap_or_default();
            end += more + 1;
            if !content(last).ends_with(b"\\") {
                break;
            }
        }
        let (piece, after) = rest.split_at(end);
        pieces.push(piece);
        rest = after;
    }
    pieces
}

/// A line without its comment and outer blanks.
fn content(line: &[u8]) -> &[u8] {
    let end = line.iter().position(|&byte| byte == b'#').unwrap_or(line.len());
    line[..end].trim_ascii()
}

/// The lines' content with their numbers, counted from 1; continued lines joined.
fn lines(text: &[u8]) -> impl Iterator<Item = (usize, Cow<'_, [u8]>)> {
    let mut physical = (1..).zip(text.split(|&byte| byte == b'\n').map(content));
    std::iter::from_fn(move || {
        let (number, line) = physical.next()?;
        let mut line = Cow::Borrowed(line);
        while line.ends_with(b"\\") {
            let (_, continued) = physical.next().unwrap_or_default();
            let begun = line.to_mut();
            begun.pop();
            begun.push(b' ');
            begun.extend_from_slice(continued);
        }
        Some((number, line))
    })
}

fn vertex_lines(text: &[u8]) -> impl Iterator<Item = (usize, Cow<'_, [u8]>)> {
    lines(text).filter(|(_, line)| matches!(Record::of(line), Some(Record::Vertex(_))))
}

/// A line that says something about the surface: its words after the first.
enum Record<'a> {
    Vertex(&'a [u8]),
    Face(&'a [u8]),
    Name(Name, &'a [u8]),
}

/// What a name is given to. Groups are the finer division where a file has both.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Name {
    Group,
    Object,
}

impl<'a> Record<'a> {
    fn of(line: &'a [u8]) -> Option<Self> {
        let (&letter, rest) = line.split_first()?;
        if !rest.first().is_none_or(u8::is_ascii_whitespace) {
            return None;
        }
        match letter {
            b'v' => Some(Self::Vertex(rest)),
            b'f' => Some(Self::Face(rest)),
            b'g' => Some(Self::Name(Name::Group, rest)),
            b'o' => Some(Self::Name(Name::Object, rest)),
            _ => None,
        }
    }
}

/// What comes before a piece.
#[derive(Clone, Copy, Default)]
struct Start {
    lines: usize,
    vertices: usize,
}

impl Start {
    /// What would come before the next piece, were this the first.
    fn after(piece: &[u8]) -> Self {
        let lines = piece.iter().filter(|&&byte| byte == b'\n').count();
        Self { lines, vertices: vertex_lines(piece).count() }
    }
}

/// What a piece holds. Its corners are numbered for the whole file.
#[derive(Default)]
struct Part {
    polygons: Polygons,
    /// What each of the marks is for.
    kinds: Vec<Name>,
}

impl Part {
    /// The piece, or its first wrong line, counted from 1 in the whole file. `vertices` is the file's number of them.
    fn parse(piece: &[u8], start: Start, vertices: usize) -> Result<Self, (usize, Fault)> {
        let mut part = Self::default();
        for (number, line) in lines(piece) {
            let read = match Record::of(&line) {
                Some(Record::Vertex(rest)) => position(rest).map(|point| part.polygons.points.push(point)),
                Some(Record::Face(rest)) => {
                    let before = start.vertices + part.polygons.points.len();
                    face(rest, before, vertices, &mut part.polygons)
                }
                Some(Record::Name(kind, rest)) => {
                    let text = words(rest).collect::<Vec<_>>().join(&b' ');
                    let name = String::from_utf8_lossy(&text).into_owned();
                    part.polygons.marks.push((part.polygons.ends.len(), name));
                    part.kinds.push(kind);
                    Ok(())
                }
                None => Ok(()),
            };
            read.map_err(|fault| (start.lines + number, fault))?;
        }
        Ok(part)
    }
}

/// x, y, z and a weight, if there is no colour instead of it.
fn position(rest: &[u8]) -> Result<[f64; 3], Fault> {
    let point = coordinates(words(rest))?;
    Ok(match weight(rest) {
        Some(word) => {
            let weight = number(word)?;
            point.map(|coordinate| coordinate / weight)
        }
        None => point,
    })
}

fn weight(rest: &[u8]) -> Option<&[u8]> {
    let mut words = words(rest).skip(3);
    words.next().filter(|_| words.next().is_none())
}

/// Reads a face. Corners are vertex indices, after a slash perhaps those of texture coordinates and normals.
fn face(rest: &[u8], before: usize, vertices: usize, polygons: &mut Polygons) -> Result<(), Fault> {
    for corner in words(rest) {
        let word = corner.split(|&byte| byte == b'/').next().filter(|index| !index.is_empty()).unwrap_or(corner);
        let index: i64 = parsed(word).ok_or_else(|| Fault::NotAnIndex { word: shown(word) })?;
        let (place, usable) = match index {
            0 => return Err(Fault::IndexZero),
            1.. => (index - 1, vertices),
            _ => (before as i64 + index, before),
        };
        if !(0..usable as i64).contains(&place) {
            return Err(Fault::IndexOutOfRange { index, vertices: usable });
        }
        polygons.corners.push(place as u32);
    }
    polygons.end_face()
}

/// The line, counted from 1, of a vertex that is not finite, and why it is not.
fn no_place(text: &[u8], vertex: usize) -> (usize, Fault) {
    let (number, line) = vertex_lines(text).nth(vertex).unwrap_or_default();
    let rest = line.get(1..).unwrap_or_default();
    let wrong = words(rest).take(3).chain(weight(rest)).find(|word| !self::number(word).is_ok_and(f64::is_finite));
    (number, wrong.map_or(Fault::ZeroWeight, |word| Fault::NotFinite { word: shown(word) }))
}
