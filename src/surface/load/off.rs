//! OFF (Object File Format, Geomview), ASCII: vertices and polygons. Normals, colours and texture coordinates are passed over.
//!
//! A vertex or a face is a line. Comments begin with `#`.

use super::cursor::vertex;
use super::text::{content_lines, coordinates, number, parsed, shown, words};
use super::{Fault, LoadError, Polygons};

pub(super) fn recognises(bytes: &[u8]) -> bool {
    let first = content_lines(bytes).next().and_then(|(_, line)| words(line).next());
    first.is_some_and(|word| dimensions(word).is_some())
}

/// What stands before `OFF` tells what vertices have. `None` where the word is none of the format's; some files have the first
/// count right behind it.
fn dimensions(word: &[u8]) -> Option<Dimensions> {
    let place = word.windows(3).position(|part| part == b"OFF")?;
    let (before, after) = (&word[..place], &word[place + 3..]);
    let mut rest = before;
    for attribute in [&b"ST"[..], b"C", b"N"] {
        rest = rest.strip_prefix(attribute).unwrap_or(rest);
    }
    match rest {
        _ if !after.iter().all(u8::is_ascii_digit) => None,
        b"" => Some(Dimensions::Three),
        b"4" | b"n" | b"4n" => Some(Dimensions::Other),
        _ => None,
    }
}

enum Dimensions {
    Three,
    Other,
}

pub(super) fn parse(bytes: &[u8], file: &str) -> Result<Polygons, LoadError> {
    let at_line = |line| move |fault| LoadError::at_line(file, bytes, line, fault);
    let mut lines = content_lines(bytes);
    let (mut line, mut counts) = lines.next().unwrap_or((1, b"OFF"));
    if let Some(dimensions) = words(counts).next().and_then(dimensions) {
        let keyword = words(counts).next().unwrap_or_default();
        if matches!(dimensions, Dimensions::Other) || words(counts).any(|word| word == b"BINARY") {
            let what = "OFF with other than three coordinates, or in binary,".to_owned();
            return Err(at_line(line)(Fault::Unsupported { what, remedy: "export it in ASCII with three" }));
        }
        let end = keyword.len() - keyword.iter().rev().take_while(|byte| byte.is_ascii_digit()).count();
        counts = counts[end..].trim_ascii();
        if counts.is_empty() {
            (line, counts) = lines.next().unwrap_or((line, b""));
        }
    }
    let mut counts = words(counts);
    let mut count = || {
        let what = "the numbers of vertices and of faces";
        let word = counts.next().ok_or(Fault::HeaderLacks { what })?;
        parsed::<usize>(word).ok_or_else(|| Fault::NotACount { count: shown(word) })
    };
    let (vertices, faces) = count().and_then(|vertices| Ok((vertices, count()?))).map_err(at_line(line))?;
    if vertices == 0 {
        return Err(LoadError::NoVertices { file: file.to_owned() });
    }
    if faces == 0 {
        return Err(LoadError::NoFaces { file: file.to_owned(), vertices });
    }
    let cut_off =
        |what: &str, said, found| LoadError::CutOff { file: file.to_owned(), what: what.to_owned(), said, found };

    let mut polygons = Polygons::default();
    // The lines of vertices that are not finite; only those that a face uses are wrong.
    let mut nowhere = Vec::new();
    for found in 0..vertices {
        let (line, content) = lines.next().ok_or_else(|| cut_off("vertices", vertices, found))?;
        let point = coordinates(words(content)).map_err(at_line(line))?;
        if let Some(place) = point.iter().position(|coordinate| !coordinate.is_finite()) {
            nowhere.push((found, line, words(content).nth(place).map(shown).unwrap_or_default()));
        }
        polygons.points.push(point);
    }
    for found in 0..faces {
        let (line, content) = lines.next().ok_or_else(|| cut_off("faces", faces, found))?;
        read_face(content, vertices, &mut polygons).map_err(at_line(line))?;
    }
    if let Some(vertex) = polygons.nowhere()
        && let Some((_, line, word)) = nowhere.into_iter().find(|wrong| wrong.0 == vertex)
    {
        return Err(at_line(line)(Fault::NotFinite { word }));
    }
    Ok(polygons)
}

/// The number of corners, then the corners; a colour may follow.
fn read_face(line: &[u8], vertices: usize, polygons: &mut Polygons) -> Result<(), Fault> {
    let mut words = words(line);
    let count = words.next().unwrap_or_default();
    let count: usize = parsed(count).ok_or_else(|| Fault::NotACount { count: shown(count) })?;
    for _ in 0..count {
        let word = words.next().ok_or(Fault::WrongRow { more: false })?;
        polygons.corners.push(vertex(number(word)?, vertices)?);
    }
    polygons.end_face()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_word_tells_what_vertices_have() {
        for word in ["OFF", "COFF", "NOFF", "CNOFF", "STOFF", "STCNOFF", "OFF490"] {
            assert!(matches!(dimensions(word.as_bytes()), Some(Dimensions::Three)), "{word}");
        }
        for word in ["4OFF", "nOFF", "C4nOFF"] {
            assert!(matches!(dimensions(word.as_bytes()), Some(Dimensions::Other)), "{word}");
        }
        for word in ["off", "KICKOFF", "OFFSET", "OF", "8"] {
            assert!(dimensions(word.as_bytes()).is_none(), "{word}");
        }
        assert!(recognises(b"# made by hand\nOFF\n") && !recognises(b"o OFF\n"));
    }
}
