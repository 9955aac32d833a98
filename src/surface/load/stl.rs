//! STL, binary and ASCII: triangles, and the names of solids.
//!
//! A binary file is told from its size, 84 + 50 n bytes, for there are binary files whose header begins with `solid` as a
//! text does. STL repeats a point for each of its triangles; points with the same coordinates are made one here.

use super::text::{coordinates, shown, words};
use super::{Fault, LoadError, Place, Polygons, Regions};
use rustc_hash::FxHashMap;

/// 80 bytes of anything, then the number of triangles.
const HEADER: usize = 84;
/// The normal and three vertices as f32, then two bytes of attributes.
const TRIANGLE: usize = 50;
/// Where the vertices begin in a triangle.
const VERTICES: usize = 12;

pub(super) fn recognises(bytes: &[u8]) -> bool {
    let first = words(bytes).next().unwrap_or_default();
    has_exact_size(bytes) || is_keyword(first, "solid") || looks_like_triangles(bytes)
}

pub(super) fn parse(bytes: &[u8], file: &str) -> Result<Polygons, LoadError> {
    let polygons = if has_exact_size(bytes) || bytes.contains(&0) { binary(bytes, file) } else { ascii(bytes, file) }?;
    if polygons.points.is_empty() {
        return Err(LoadError::NoVertices { file: file.to_owned() });
    }
    Ok(polygons)
}

/// No text has it: four characters as a number promise more than a file may hold.
fn has_exact_size(bytes: &[u8]) -> bool {
    promised(bytes).is_some_and(|count| bytes.len() as u64 == HEADER as u64 + TRIANGLE as u64 * u64::from(count))
}

/// The number of triangles in the header.
fn promised(bytes: &[u8]) -> Option<u32> {
    bytes.get(HEADER - 4..)?.first_chunk().map(|count| u32::from_le_bytes(*count))
}

/// Whether the first triangles of a binary file that was cut off, or goes on, have coordinates as models do.
fn looks_like_triangles(bytes: &[u8]) -> bool {
    let plausible = |number: f32| number == 0.0 || (1e-15..1e15).contains(&number.abs());
    let mut first = bytes.get(HEADER..).unwrap_or_default().chunks_exact(TRIANGLE).take(8).peekable();
    bytes.contains(&0) && first.peek().is_some() && first.all(|triangle| floats(&triangle[..48]).all(plausible))
}

fn floats(bytes: &[u8]) -> impl Iterator<Item = f32> {
    bytes.chunks_exact(4).map(|four| f32::from_le_bytes([four[0], four[1], four[2], four[3]]))
}

fn binary(bytes: &[u8], file: &str) -> Result<Polygons, LoadError> {
    let file = file.to_owned();
    let Some(said) = promised(bytes).map(|count| count as usize) else {
        let place = Place::Record { kind: "header".to_owned(), number: 0, byte: 0 };
        return Err(LoadError::At { file, place, fault: Fault::ShortHeader, unended: false });
    };
    let body = &bytes[HEADER..];
    let found = body.len() / TRIANGLE;
    if found < said {
        return Err(LoadError::CutOff { file, what: "triangles".to_owned(), said, found });
    }
    let (body, rest) = body.split_at(said * TRIANGLE);
    // Less than a triangle of zeros or blanks at the end is padding; anything else could be a part of the surface.
    if found > said || !rest.iter().all(|&byte| byte == 0 || byte.is_ascii_whitespace()) {
        return Err(LoadError::GoesOn { file, said, bytes: rest.len() });
    }
    let mut points = Joined::default();
    for (number, triangle) in body.chunks_exact(TRIANGLE).enumerate() {
        for vertex in triangle[VERTICES..48].chunks_exact(12) {
            let mut point = [0.0; 3];
            for (coordinate, value) in point.iter_mut().zip(floats(vertex)) {
                if !value.is_finite() {
                    let byte = HEADER + number * TRIANGLE;
                    let place = Place::Record { kind: "triangle".to_owned(), number, byte };
                    let fault = Fault::NotFinite { word: value.to_string() };
                    return Err(LoadError::At { file, place, fault, unended: false });
                }
                *coordinate = f64::from(value);
            }
            points.push(point);
        }
        points.polygons.ends.push(points.polygons.corners.len() as u32);
    }
    Ok(points.polygons)
}

/// Keywords are read one after the other, whatever lines they stand on; only names and coordinates need theirs.
fn ascii(text: &[u8], file: &str) -> Result<Polygons, LoadError> {
    let mut points = Joined::default();
    let mut solids = Solids::default();
    for (number, line) in (1..).zip(text.split(|&byte| byte == b'\n')) {
        ascii_line(line, &mut points, number, &mut solids)
            .map_err(|fault| LoadError::at_line(file, text, number, fault))?;
    }
    if let Some((line, _)) = solids.open {
        return Err(LoadError::at_line(file, text, line, Fault::EndlessSolid));
    }
    // Vertices may stand outside of solids.
    let last = text.trim_ascii_end().split(|&byte| byte == b'\n').count();
    points.end_facet().map_err(|fault| LoadError::at_line(file, text, last, fault))?;
    let mut polygons = points.polygons;
    polygons.regions = Regions::from_marks(&solids.marks, polygons.ends.len());
    Ok(polygons)
}

#[derive(Default)]
struct Solids {
    /// Names, each with the number of facets that came before it.
    marks: Vec<(usize, String)>,
    /// The line in which the solid begins that is open, and the number of words in its name.
    open: Option<(usize, usize)>,
}

fn ascii_line(line: &[u8], points: &mut Joined, number: usize, solids: &mut Solids) -> Result<(), Fault> {
    let mut words = words(line);
    while let Some(word) = words.next() {
        if is_keyword(word, "vertex") {
            let written = words.clone();
            let point = coordinates(words.by_ref())?;
            if let Some(place) = point.iter().position(|coordinate| !coordinate.is_finite()) {
                return Err(Fault::NotFinite { word: written.map(shown).nth(place).unwrap_or_default() });
            }
            points.push(point);
        } else if is_keyword(word, "facet") {
            points.end_facet()?;
            // The word normal and its coordinates: the order of the vertices tells the side.
            words.by_ref().take(4).for_each(drop);
        } else if is_keyword(word, "outer") {
            words.next();
        } else if is_keyword(word, "endfacet") {
            points.end_facet()?;
        } else if is_keyword(word, "solid") {
            points.end_facet()?;
            let name = name_of_solid(&mut words);
            solids.open = Some((number, name.len()));
            let name = name.into_iter().map(String::from_utf8_lossy).collect::<Vec<_>>().join(" ");
            solids.marks.push((points.polygons.ends.len(), name));
        } else if is_keyword(word, "endsolid") {
            points.end_facet()?;
            let length = solids.open.take().map_or(0, |(_, length)| length);
            // Another solid may follow on the line, after the name of this one or without it.
            let mut after_name = words.clone().skip(length);
            if after_name.next().is_some_and(|word| is_keyword(word, "solid")) {
                words.by_ref().take(length).for_each(drop);
            } else if !words.clone().next().is_some_and(|word| is_keyword(word, "solid")) {
                break;
            }
        } else if !is_keyword(word, "endloop") {
            return Err(Fault::UnknownWord { word: shown(word) });
        }
    }
    Ok(())
}

/// The words up to the end of the line, or, where all stands on one line, up to the first facet or the solid's end.
fn name_of_solid<'a>(words: &mut (impl Iterator<Item = &'a [u8]> + Clone)) -> Vec<&'a [u8]> {
    let mut name = Vec::new();
    loop {
        let mut ahead = words.clone();
        match ahead.next() {
            None => return name,
            Some(word) if is_keyword(word, "endsolid") => return name,
            Some(word) if is_keyword(word, "facet") && ahead.next().is_some_and(|next| is_keyword(next, "normal")) => {
                return name;
            }
            Some(word) => name.push(word),
        }
        words.next();
    }
}

fn is_keyword(word: &[u8], keyword: &str) -> bool {
    word.eq_ignore_ascii_case(keyword.as_bytes())
}

/// Triangles whose corners at the same point are one vertex.
#[derive(Default)]
struct Joined {
    polygons: Polygons,
    known: FxHashMap<[u64; 3], u32>,
}

impl Joined {
    fn push(&mut self, point: [f64; 3]) {
        let points = &mut self.polygons.points;
        // Zero is added because there are two zeros.
        let vertex = *self.known.entry(point.map(|coordinate| (coordinate + 0.0).to_bits())).or_insert_with(|| {
            points.push(point);
            points.len() as u32 - 1
        });
        self.polygons.corners.push(vertex);
    }

    /// Ends the facet, if there is one.
    fn end_facet(&mut self) -> Result<(), Fault> {
        match self.polygons.corners.len() - 3 * self.polygons.ends.len() {
            0 => Ok(()),
            3 => self.polygons.end_face(),
            count => Err(Fault::NotATriangle { count }),
        }
    }
}
