//! The line of an OBJ text that is wrong, once it is known that one is.

use super::super::Fault;
use super::super::polygons::check_corners;
use super::super::text::{coordinates, number, parsed, shown, words};
use super::statements::{Statement, lines, vertices, weight};

/// The first line that is wrong, counted from 1. `vertices` is the text's number of them.
pub fn first(text: &[u8], vertices: usize) -> Option<(usize, Fault)> {
    let mut before = 0;
    lines(text).find_map(|(number, line)| {
        let checked = match Statement::of(&line)? {
            Statement::Vertex(rest) => {
                before += 1;
                vertex(rest)
            }
            Statement::Face(rest) => face(rest, before, vertices),
            Statement::Name(..) | Statement::Texture(_) => Ok(()),
        };
        checked.err().map(|fault| (number, fault))
    })
}

fn vertex(rest: &[u8]) -> Result<(), Fault> {
    coordinates(words(rest))?;
    match weight(rest).map(number).transpose()? {
        Some(0.0) => Err(Fault::ZeroWeight),
        _ => Ok(()),
    }
}

/// Corners are vertex indices, after slashes perhaps those of texture coordinates and normals.
fn face(rest: &[u8], before: usize, vertices: usize) -> Result<(), Fault> {
    for corner in words(rest) {
        let no_index = |word: &[u8]| Fault::NotAnIndex { word: shown(word) };
        let mut parts = corner.split(|&byte| byte == b'/');
        let word = parts.next().filter(|index| !index.is_empty()).unwrap_or(corner);
        let index: i64 = parsed(word).ok_or_else(|| no_index(word))?;
        let (place, usable) = match index {
            0 => return Err(Fault::IndexZero),
            1.. => (index - 1, vertices),
            _ => (before as i64 + index, before),
        };
        if !(0..usable as i64).contains(&place) {
            return Err(Fault::IndexOutOfRange { index, vertices: usable });
        }
        let whole = |part: &[u8]| part.is_empty() || parsed::<i64>(part).is_some();
        if parts.clone().count() > 2 || !parts.all(whole) {
            return Err(no_index(corner));
        }
    }
    check_corners(words(rest).count())
}

/// The line, counted from 1, of a vertex that is not finite, and why it is not.
pub fn of_vertex(text: &[u8], vertex: usize) -> (usize, Fault) {
    let (line, vertex) = vertices(text).nth(vertex).unwrap_or_default();
    let rest = vertex.get(1..).unwrap_or_default();
    let wrong = words(rest).take(3).chain(weight(rest)).find(|word| !number(word).is_ok_and(f64::is_finite));
    (line, wrong.map_or(Fault::ZeroWeight, |word| Fault::NotFinite { word: shown(word) }))
}
