//! Reads guides from files of text (CSV or JSON, told apart by content) and from the command line.

mod csv;
mod json;

use super::{Guide, Trace};
use std::path::Path;
use std::{fs, io};
use thiserror::Error;

/// Why numbers or words are no guide.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum GuideFault {
    /// Not six to eight numbers.
    #[error("a guide has 6 to 8 numbers (x, y, z, dx, dy, dz, and perhaps a radius and a weight), not {count}")]
    Count {
        /// How many there are.
        count: usize,
    },
    /// More words than the header has columns, or fewer than it needs.
    #[error("{count} values under a header of {columns} columns, of which {needed} are needed")]
    Columns {
        /// How many there are.
        count: usize,
        /// How many the header has.
        columns: usize,
        /// The last column that cannot be left out, counted from 1.
        needed: usize,
    },
    /// A column's name is not known.
    #[error("there is no column {name:?}; the columns are x, y, z, dx, dy, dz, radius (or r) and weight (or w)")]
    UnknownColumn {
        /// The name.
        name: String,
    },
    /// A column is there twice.
    #[error("the column {name} is there twice")]
    RepeatedColumn {
        /// The name.
        name: &'static str,
    },
    /// A column is missing.
    #[error("the header has no column {name}; it needs x, y, z, dx, dy and dz")]
    MissingColumn {
        /// The name.
        name: &'static str,
    },
    /// A word is not a number.
    #[error("{word:?} is not a number; write it like 0.25 or 2.5e-1")]
    NotANumber {
        /// The word.
        word: String,
    },
    /// A number is NaN or infinite.
    #[error("{word:?} is not finite")]
    NotFinite {
        /// The number as written.
        word: String,
    },
    /// The direction has no length.
    #[error("the direction (dx, dy, dz) is zero; give it any length but that")]
    NoDirection,
    /// A stroke does not lead anywhere.
    #[error("the stroke has not two points that differ; give it two at least")]
    NoStroke,
    /// The radius is negative.
    #[error("the radius {radius} is negative; write 0 or leave it out for the nearest triangle alone")]
    NegativeRadius {
        /// The radius as given.
        radius: f64,
    },
    /// The weight is not positive.
    #[error("the weight {weight} is not above 0; leave it out for a guide that is followed exactly")]
    NoWeight {
        /// The weight as given.
        weight: f64,
    },
}

/// Why a file gave no guides.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum GuideFileError {
    /// The operating system could not read the file.
    #[error("{file} cannot be read ({source}); check the path and its permissions")]
    Unreadable {
        /// The path that was given.
        file: String,
        /// What the operating system said.
        source: io::Error,
    },
    /// There is no guide in it.
    #[error("{file} holds no guide; write x, y, z, dx, dy, dz on a line, or leave the file out")]
    NoGuides {
        /// The path that was given.
        file: String,
    },
    /// It begins like JSON, and is none, or not of guides.
    #[error(
        "{file}: {source}; write {{\"guides\": [{{\"point\": [0, 0, 0], \"direction\": [1, 0, 0]}}], \"strokes\": \
         [{{\"points\": [[0, 0, 0], [1, 0, 0]]}}]}}, each with a radius and a weight where wanted"
    )]
    Json {
        /// The path that was given.
        file: String,
        /// What is wrong, with line and column.
        source: serde_json::Error,
    },
    /// One guide is wrong.
    #[error("{file}, {place}: {fault}")]
    Guide {
        /// The path that was given.
        file: String,
        /// Its line, or its place in JSON.
        place: String,
        /// What is wrong with it.
        fault: GuideFault,
    },
}

/// Reads the guides of a file, in model units; each is named by its file and place.
///
/// CSV has a guide a line: `x, y, z, dx, dy, dz` and perhaps a radius and a weight, apart by commas, semicolons or blanks, one of
/// them in the whole file. A first line without any number names the columns, then in any order: `x`, `y`, `z`, `dx`, `dy`, `dz`, `radius` (or `r`),
/// `weight` (or `w`); optional values can be left empty. Text after `#` and empty lines are passed over.
///
/// JSON is `{"guides": [...], "strokes": [...]}`, one of the two at least, or a bare list of guides. A guide is `{"point":
/// [x, y, z], "direction": [dx, dy, dz]}`, a stroke `{"points": [[x, y, z], ...]}`, both perhaps with `"radius"` and
/// `"weight"`.
///
/// # Errors
/// [`GuideFileError`] names the file and the place in it.
pub fn read_guides(path: &Path) -> Result<Vec<Guide>, GuideFileError> {
    let file = path.display().to_string();
    let bytes = fs::read(path).map_err(|source| GuideFileError::Unreadable { file: file.clone(), source })?;
    parse_guides(&String::from_utf8_lossy(&bytes), &file)
}

/// Reads the guides of a text as [`read_guides`] does those of a file. Errors and guides call it `name`.
///
/// # Errors
/// As [`read_guides`].
pub fn parse_guides(text: &str, name: &str) -> Result<Vec<Guide>, GuideFileError> {
    let text = text.trim_start_matches('\u{feff}');
    let guides = if text.trim_start().starts_with(['{', '[']) { json::read(text, name) } else { csv::read(text, name) };
    match guides {
        Ok(guides) if guides.is_empty() => Err(GuideFileError::NoGuides { file: name.to_owned() }),
        guides => guides,
    }
}

/// The guide, unless something is wrong with it.
fn checked(guide: Guide) -> Result<Guide, GuideFault> {
    match &guide.trace {
        Trace::Vector { direction: [0.0, 0.0, 0.0], .. } => return Err(GuideFault::NoDirection),
        Trace::Stroke { points } if points.iter().all(|point| *point == points[0]) => return Err(GuideFault::NoStroke),
        _ => {}
    }
    let Guide { radius, weight, .. } = guide;
    if radius < 0.0 {
        return Err(GuideFault::NegativeRadius { radius });
    }
    match weight {
        Some(weight) if weight <= 0.0 => Err(GuideFault::NoWeight { weight }),
        _ => Ok(guide),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    pub(super) fn read(name: &str, text: &str) -> Result<Vec<Guide>, GuideFileError> {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join(name);
        fs::write(&path, text).expect("it can be written");
        // The folder's name is another every time.
        read_guides(&path).map(|guides| {
            let short = |guide: &Guide| guide.name.rsplit('/').next().unwrap_or_default().to_owned();
            guides.into_iter().map(|guide| guide.clone().named(short(&guide))).collect()
        })
    }

    /// The error for each text must have these parts, and name the file.
    pub(super) fn refused(cases: &[(&str, &str)]) {
        for (text, part) in cases {
            let error = read("guides.txt", text).expect_err(text).to_string();
            assert!(error.contains("guides.txt") && error.contains(part), "{text}\n{error}");
        }
    }

    #[test]
    fn a_file_is_read_by_its_content() {
        let csv = "1,2,3,0,-1,0.5,0.25\n";
        let json = "\u{feff}\n [{\"point\": [1, 2, 3], \"direction\": [0, -1, 0.5], \"radius\": 0.25}]";
        let unnamed = |text: &str| read("guides.x", text).expect("they are guides").remove(0).named("");
        assert_eq!(unnamed(csv), unnamed(json));
        assert!(matches!(read_guides(Path::new("none.csv")), Err(GuideFileError::Unreadable { .. })));
        for empty in ["", "# none\n", "x,y,z,dx,dy,dz\n", "[]", "{}", "{\"strokes\": []}"] {
            assert!(matches!(read("guides.csv", empty), Err(GuideFileError::NoGuides { .. })), "{empty}");
        }
    }
}
