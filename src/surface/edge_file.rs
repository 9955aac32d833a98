//! Reads feature edges from text: two points or two vertex numbers a line.

use super::records::{Record, records};
use std::path::Path;
use std::{fs, io};
use thiserror::Error;

/// An edge, or a straight line of edges, that the user wants the mesh to keep.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedEdge {
    /// Its two ends.
    pub ends: Ends,
    /// What messages call it, such as its file and line.
    pub name: String,
}

/// The ends of a [`NamedEdge`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ends {
    /// In model units.
    Points([[f64; 3]; 2]),
    /// Numbers of points of the file that the surface came from, counted from 0.
    Vertices([u32; 2]),
}

/// Why a file gave no feature edges.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum EdgeFileError {
    /// The operating system could not read the file.
    #[error("{file} cannot be read ({source}); check the path and its permissions")]
    Unreadable {
        /// The path that was given.
        file: String,
        /// What the operating system said.
        source: io::Error,
    },
    /// One line is wrong.
    #[error("{file}, line {line}: {fault}; write two vertex numbers (counted from 1) or two points (x, y, z, x, y, z)")]
    Line {
        /// The path that was given.
        file: String,
        /// The line's number, counted from 1.
        line: usize,
        /// What is wrong with it.
        fault: String,
    },
}

/// Reads one edge a line: two vertex numbers as the surface's file has them, counted from 1, or the six coordinates of two
/// points in model units, apart by commas, semicolons or blanks. Text after `#` and empty lines are passed over.
///
/// # Errors
/// [`EdgeFileError`] names the file and the line.
pub fn read_edges(path: &Path) -> Result<Vec<NamedEdge>, EdgeFileError> {
    let file = path.display().to_string();
    let bytes = fs::read(path).map_err(|source| EdgeFileError::Unreadable { file: file.clone(), source })?;
    let text = String::from_utf8_lossy(&bytes);
    records(&text)
        .map(|Record { line, values }| {
            let ends = ends(&values).map_err(|fault| EdgeFileError::Line { file: file.clone(), line, fault })?;
            Ok(NamedEdge { ends, name: format!("{file}, line {line}") })
        })
        .collect()
}

fn ends(values: &[String]) -> Result<Ends, String> {
    // The coordinates of a point may stand closer together than its two points.
    let words = values.iter().flat_map(|value| value.split([',', ' ', '\t'])).filter(|word| !word.is_empty());
    let words: Vec<&str> = words.collect();
    match words.len() {
        2 => {
            let number = |word: &str| match word.parse::<u32>() {
                Ok(number) if number > 0 => Ok(number - 1),
                _ => Err(format!("{word:?} is not a vertex number")),
            };
            Ok(Ends::Vertices([number(words[0])?, number(words[1])?]))
        }
        6 => {
            let mut at = [0.0; 6];
            for (at, word) in at.iter_mut().zip(&words) {
                *at = word
                    .parse()
                    .ok()
                    .filter(|x: &f64| x.is_finite())
                    .ok_or_else(|| format!("{word:?} is no number"))?;
            }
            let [x, y, z, u, v, w] = at;
            Ok(Ends::Points([[x, y, z], [u, v, w]]))
        }
        count => Err(format!("the edge has {count} numbers")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Vec<NamedEdge>, EdgeFileError> {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("edges.txt");
        fs::write(&path, text).expect("it can be written");
        read_edges(&path)
    }

    #[test]
    fn numbers_and_points_are_read() {
        let edges =
            read("# two edges\n1 7\n\n0,0,0, 1,-2,3.5 # the second\n0 0 0, 1 -2 3.5\n").expect("they are edges");
        assert_eq!(edges[0].ends, Ends::Vertices([0, 6]));
        assert_eq!(edges[2].ends, edges[1].ends);
        assert_eq!(edges[1].ends, Ends::Points([[0.0; 3], [1.0, -2.0, 3.5]]));
        assert!(edges[1].name.ends_with("edges.txt, line 4"), "{}", edges[1].name);
    }

    #[test]
    fn wrong_lines_are_named() {
        for (line, part) in [
            ("0 1", "\"0\" is not a vertex"),
            ("1 2 3", "has 3 numbers"),
            ("0 0 0 1 1 nan", "\"nan\""),
            ("a b", "\"a\""),
        ] {
            let error = read(&format!("1 2\n{line}\n")).expect_err(line).to_string();
            assert!(error.contains("edges.txt, line 2") && error.contains(part), "{error}");
        }
    }
}
