//! Reads points with sizes from text or PLY.

use crate::surface::load::{self, LoadError};
use crate::surface::records::{Record, records};
use std::path::Path;
use std::{fs, io};
use thiserror::Error;

/// A point and the tile side that is wanted there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SizeSample {
    /// Where, in model units.
    pub point: [f64; 3],
    /// The side: in model units, or relative to others'.
    pub size: f64,
}

/// Why a file gave no sizes.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SizeFileError {
    /// The operating system could not read the file.
    #[error("{file} cannot be read ({source}); check the path and its permissions")]
    Unreadable {
        /// The path that was given.
        file: String,
        /// What the operating system said.
        source: io::Error,
    },
    /// There is no size in it.
    #[error("{file} holds no sizes; write x, y, z, size on a line, or a PLY file with the vertex property size")]
    NoSizes {
        /// The path that was given.
        file: String,
    },
    /// One line is wrong.
    #[error("{file}, line {line}: {fault}")]
    Line {
        /// The path that was given.
        file: String,
        /// The line, counted from 1.
        line: usize,
        /// What is wrong with it.
        fault: SizeFault,
    },
    /// A PLY file is wrong.
    #[error(transparent)]
    Ply(#[from] LoadError),
    /// One vertex of a PLY file is wrong.
    #[error("{file}, vertex {vertex} (counted from 0): {fault}")]
    Vertex {
        /// The path that was given.
        file: String,
        /// The vertex.
        vertex: usize,
        /// What is wrong with it.
        fault: SizeFault,
    },
}

/// Why numbers or words are no point with a size.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum SizeFault {
    /// The header does not name the four columns, each once.
    #[error("the header names the columns {found:?}; it needs x, y, z and size, each once")]
    Header {
        /// The columns that it names.
        found: Vec<String>,
    },
    /// More or fewer values than columns.
    #[error("{count} values, not {columns}; write x, y, z, size, or what the header names")]
    Count {
        /// How many there are.
        count: usize,
        /// How many there are to be.
        columns: usize,
    },
    /// A word is not a finite number.
    #[error("{word:?} is not a finite number; write it like 0.25 or 2.5e-1")]
    NotANumber {
        /// The word.
        word: String,
    },
    /// A size is not positive.
    #[error("the size {size} is not above 0; write the side that a tile is to have there")]
    NotPositive {
        /// The size as given.
        size: f64,
    },
}

/// The columns, in the order that they have without a header.
const COLUMNS: [&str; 4] = ["x", "y", "z", "size"];

/// Reads points with sizes, told apart by content.
///
/// PLY: the element `vertex` has a property `size`. CSV has a point a line: `x, y, z, size`, apart by commas, semicolons or
/// blanks, one of them in the whole file; a first line without any number names the columns, in any order and with others
/// between them. Text after `#` and empty lines are passed over.
///
/// # Errors
/// [`SizeFileError`] names the file and the place in it.
pub fn read_sizes(path: &Path) -> Result<Vec<SizeSample>, SizeFileError> {
    let file = path.display().to_string();
    let bytes = fs::read(path).map_err(|source| SizeFileError::Unreadable { file: file.clone(), source })?;
    parse_sizes(&bytes, &file)
}

/// Reads the points of a file's bytes as [`read_sizes`] does those of a file. Errors call them `name`.
///
/// # Errors
/// As [`read_sizes`].
pub fn parse_sizes(bytes: &[u8], name: &str) -> Result<Vec<SizeSample>, SizeFileError> {
    let samples = match load::ply_sizes(bytes, name) {
        Some(rows) => of_ply(&rows?, name)?,
        None => of_text(&String::from_utf8_lossy(bytes), name)?,
    };
    if samples.is_empty() { Err(SizeFileError::NoSizes { file: name.to_owned() }) } else { Ok(samples) }
}

/// The samples of rows of numbers, each x, y, z and the size. Errors call them `name`.
///
/// # Errors
/// Where a number is not finite, a size is not above 0, or there is no row.
pub fn samples(rows: &[[f64; 4]], name: &str) -> Result<Vec<SizeSample>, SizeFileError> {
    let samples = of_ply(rows, name)?;
    if samples.is_empty() { Err(SizeFileError::NoSizes { file: name.to_owned() }) } else { Ok(samples) }
}

fn of_ply(rows: &[[f64; 4]], file: &str) -> Result<Vec<SizeSample>, SizeFileError> {
    let sample = |(vertex, &row): (usize, &[f64; 4])| {
        sample(row).map_err(|fault| SizeFileError::Vertex { file: file.to_owned(), vertex, fault })
    };
    rows.iter().enumerate().map(sample).collect()
}

fn of_text(text: &str, file: &str) -> Result<Vec<SizeSample>, SizeFileError> {
    let at_line = |line: usize| move |fault| SizeFileError::Line { file: file.to_owned(), line, fault };
    let mut records = records(text).peekable();
    let header = records.next_if(|record| record.values.iter().all(|value| value.parse::<f64>().is_err()));
    let (places, columns) = match header {
        Some(Record { line, values }) => (places(&values).map_err(at_line(line))?, values.len()),
        None => ([0, 1, 2, 3], 4),
    };
    records
        .map(|Record { line, values }| {
            if values.len() != columns {
                return Err(at_line(line)(SizeFault::Count { count: values.len(), columns }));
            }
            let mut row = [0.0; 4];
            for (number, &place) in row.iter_mut().zip(&places) {
                let word = &values[place];
                *number = word.parse().map_err(|_| at_line(line)(SizeFault::NotANumber { word: word.clone() }))?;
            }
            sample(row).map_err(at_line(line))
        })
        .collect()
}

/// Where each of [`COLUMNS`] stands on a line.
fn places(names: &[String]) -> Result<[usize; 4], SizeFault> {
    let mut places = [0; 4];
    for (place, column) in places.iter_mut().zip(COLUMNS) {
        let mut found = (0..names.len()).filter(|&i| names[i].eq_ignore_ascii_case(column));
        match (found.next(), found.next()) {
            (Some(only), None) => *place = only,
            _ => return Err(SizeFault::Header { found: names.to_vec() }),
        }
    }
    Ok(places)
}

fn sample(row: [f64; 4]) -> Result<SizeSample, SizeFault> {
    if let Some(number) = row.iter().find(|number| !number.is_finite()) {
        return Err(SizeFault::NotANumber { word: number.to_string() });
    }
    let [x, y, z, size] = row;
    if size > 0.0 { Ok(SizeSample { point: [x, y, z], size }) } else { Err(SizeFault::NotPositive { size }) }
}
