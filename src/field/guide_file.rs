//! Reads guides from text: one guide a line, or one on the command line.

use super::Guide;
use std::path::Path;
use std::str::FromStr;
use std::{fs, io};
use thiserror::Error;

/// Why a text is no guide.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum GuideFault {
    /// Not six or seven numbers.
    #[error("a guide has 6 or 7 numbers (x, y, z, dx, dy, dz and a radius), not {count}")]
    Count {
        /// How many there are.
        count: usize,
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
    /// The radius is negative.
    #[error("the radius {radius} is negative; write 0 or leave it out for the nearest triangle alone")]
    NegativeRadius {
        /// The radius as given.
        radius: f64,
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
    /// One line is wrong.
    #[error("{file}, line {line}: {fault}")]
    Line {
        /// The path that was given.
        file: String,
        /// The line's number, counted from 1.
        line: usize,
        /// What is wrong with it.
        fault: GuideFault,
    },
}

impl FromStr for Guide {
    type Err = GuideFault;

    /// `x, y, z, dx, dy, dz` and perhaps a radius, apart by commas or by blanks, in model units.
    fn from_str(text: &str) -> Result<Self, GuideFault> {
        let numbers = words(text).into_iter().map(number).collect::<Result<Vec<f64>, _>>()?;
        let (x, y, z, dx, dy, dz, radius) = match *numbers {
            [x, y, z, dx, dy, dz] => (x, y, z, dx, dy, dz, 0.0),
            [x, y, z, dx, dy, dz, radius] => (x, y, z, dx, dy, dz, radius),
            _ => return Err(GuideFault::Count { count: numbers.len() }),
        };
        if [dx, dy, dz] == [0.0; 3] {
            return Err(GuideFault::NoDirection);
        }
        if radius < 0.0 {
            return Err(GuideFault::NegativeRadius { radius });
        }
        Ok(Self { point: [x, y, z], direction: [dx, dy, dz], radius })
    }
}

/// Reads one guide a line, as [`Guide::from_str`] does. Text after `#` and empty lines are passed over, and so is a first
/// line without any number, which names the columns.
///
/// # Errors
/// [`GuideFileError`] names the file and the line.
pub fn read_guides(path: &Path) -> Result<Vec<Guide>, GuideFileError> {
    let file = path.display().to_string();
    let bytes = fs::read(path).map_err(|source| GuideFileError::Unreadable { file: file.clone(), source })?;
    let text = String::from_utf8_lossy(&bytes);
    let mut lines = (1..)
        .zip(text.trim_start_matches('\u{feff}').lines())
        .map(|(line, content)| (line, content.split('#').next().unwrap_or_default().trim()))
        .filter(|(_, content)| !content.is_empty())
        .peekable();
    lines.next_if(|(_, content)| words(content).iter().all(|word| word.parse::<f64>().is_err()));
    let guides = lines
        .map(|(line, content)| {
            content.parse().map_err(|fault| GuideFileError::Line { file: file.clone(), line, fault })
        })
        .collect::<Result<Vec<_>, _>>()?;
    if guides.is_empty() { Err(GuideFileError::NoGuides { file }) } else { Ok(guides) }
}

fn words(text: &str) -> Vec<&str> {
    if text.contains(',') { text.split(',').map(str::trim).collect() } else { text.split_whitespace().collect() }
}

fn number(word: &str) -> Result<f64, GuideFault> {
    let number: f64 = word.parse().map_err(|_| GuideFault::NotANumber { word: word.to_owned() })?;
    if number.is_finite() { Ok(number) } else { Err(GuideFault::NotFinite { word: word.to_owned() }) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Vec<Guide>, GuideFileError> {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("guides.csv");
        fs::write(&path, text).expect("it can be written");
        read_guides(&path)
    }

    #[test]
    fn both_styles_read_alike() {
        let expected = [
            Guide { point: [1.0, 2.0, 3.0], direction: [0.0, -1.0, 0.5], radius: 0.0 },
            Guide { point: [-1e3, 0.0, 0.0], direction: [1.0, 0.0, 0.0], radius: 0.25 },
        ];
        let texts = [
            "1,2,3,0,-1,0.5\n-1e3,0,0,1,0,0,0.25\n",
            "x,y,z,dx,dy,dz,radius\r\n# two guides\r\n\r\n 1, 2, 3, 0, -1, 0.5 # first\r\n-1e3, 0, 0, 1, 0, 0, 0.25",
            "\u{feff}x y z dx dy dz r\n1 2 3  0 -1 .5\n\t-1000 0 0\t1 0 0 2.5e-1\n",
        ];
        for text in texts {
            assert_eq!(read(text).expect("they are guides"), expected, "{text}");
        }
    }

    #[test]
    fn wrong_lines_are_named() {
        let good = "1,2,3,0,-1,0.5\n";
        let cases = [
            ("1,2,3,0,-1", "line 2: a guide has 6 or 7 numbers (x, y, z, dx, dy, dz and a radius), not 5"),
            ("1,2,3,0,-1,0,1,8", "not 8"),
            ("1,2,3,0,-1,,0", "line 2: \"\" is not a number"),
            ("x,y,z,dx,dy,dz", "line 2: \"x\" is not a number"),
            ("1 2 3, 0 -1 0", "line 2: \"1 2 3\" is not a number"),
            ("1,2,nan,0,-1,0", "line 2: \"nan\" is not finite"),
            ("1,2,3,0,0,-0", "line 2: the direction"),
            ("1,2,3,1,0,0,-2", "line 2: the radius -2 is negative"),
        ];
        for (line, part) in cases {
            let error = read(&format!("{good}{line}\n")).expect_err(line).to_string();
            assert!(error.contains("guides.csv") && error.contains(part), "{error}");
        }
        assert!(matches!(read("# none\nx,y\n"), Err(GuideFileError::NoGuides { .. })));
        assert!(matches!(read_guides(Path::new("none.csv")), Err(GuideFileError::Unreadable { .. })));
    }
}
