//! Guides from lines of numbers.

use super::{Guide, GuideFault, GuideFileError, checked};
use crate::surface::records::{Record, records};
use std::str::FromStr;

/// The columns, in the order that they have without a header; the rest after [`NEEDED`] can be left out.
const COLUMNS: [&str; 8] = ["x", "y", "z", "dx", "dy", "dz", "radius", "weight"];
const NEEDED: usize = 6;

impl FromStr for Guide {
    type Err = GuideFault;

    /// `x, y, z, dx, dy, dz` and perhaps a radius and a weight, apart by commas, semicolons or blanks, in model units.
    fn from_str(text: &str) -> Result<Self, GuideFault> {
        headless(&records(text).flat_map(|record| record.values).collect::<Vec<_>>())
    }
}

/// Reads one guide a line, after a header perhaps.
pub(super) fn read(text: &str, file: &str) -> Result<Vec<Guide>, GuideFileError> {
    let at_line = |line: usize| {
        move |fault| GuideFileError::Guide { file: file.to_owned(), place: format!("line {line}"), fault }
    };
    let mut records = records(text).peekable();
    let header = records.next_if(|record| record.values.iter().all(|value| value.parse::<f64>().is_err()));
    let header = header.map(|Record { line, values }| Header::new(&values).map_err(at_line(line))).transpose()?;
    records
        .map(|Record { line, values }| {
            let guide = header.as_ref().map_or_else(|| headless(&values), |header| header.guide(&values));
            Ok(guide.map_err(at_line(line))?.named(format!("{file}, line {line}")))
        })
        .collect()
}

/// The guide of values in the order of [`COLUMNS`].
fn headless(values: &[String]) -> Result<Guide, GuideFault> {
    match values.len() {
        NEEDED..=8 => guide(values.iter().map(|value| Some(value.as_str())).chain([None, None])),
        count => Err(GuideFault::Count { count }),
    }
}

/// Where each of [`COLUMNS`] stands on a line.
struct Header {
    places: [Option<usize>; 8],
    columns: usize,
}

impl Header {
    fn new(names: &[String]) -> Result<Self, GuideFault> {
        let mut header = Self { places: [None; 8], columns: names.len() };
        for (place, word) in names.iter().enumerate() {
            let name = match word.to_ascii_lowercase().as_str() {
                "r" => "radius".to_owned(),
                "w" => "weight".to_owned(),
                name => name.to_owned(),
            };
            let column = COLUMNS.iter().position(|&column| column == name);
            let column = column.ok_or_else(|| GuideFault::UnknownColumn { name: word.clone() })?;
            if header.places[column].replace(place).is_some() {
                return Err(GuideFault::RepeatedColumn { name: COLUMNS[column] });
            }
        }
        match header.places[..NEEDED].iter().position(Option::is_none) {
            Some(column) => Err(GuideFault::MissingColumn { name: COLUMNS[column] }),
            None => Ok(header),
        }
    }

    fn guide(&self, values: &[String]) -> Result<Guide, GuideFault> {
        let needed = self.places[..NEEDED].iter().flatten().max().map_or(0, |place| place + 1);
        if !(needed..=self.columns).contains(&values.len()) {
            return Err(GuideFault::Columns { count: values.len(), columns: self.columns, needed });
        }
        guide(self.places.iter().map(|place| place.and_then(|place| values.get(place)).map(String::as_str)))
    }
}

/// The guide of the words of [`COLUMNS`]; optional ones may be empty.
fn guide<'a>(words: impl Iterator<Item = Option<&'a str>>) -> Result<Guide, GuideFault> {
    let mut numbers = [None; 8];
    for (column, word) in words.take(8).enumerate() {
        numbers[column] = word.filter(|word| column < NEEDED || !word.is_empty()).map(number).transpose()?;
    }
    let [x, y, z, dx, dy, dz] = [0, 1, 2, 3, 4, 5].map(|column| numbers[column].unwrap_or_default());
    let vector = Guide::vector([x, y, z], [dx, dy, dz]);
    checked(Guide { radius: numbers[6].unwrap_or_default(), weight: numbers[7], ..vector })
}

fn number(word: &str) -> Result<f64, GuideFault> {
    let number: f64 = word.parse().map_err(|_| GuideFault::NotANumber { word: word.to_owned() })?;
    if number.is_finite() { Ok(number) } else { Err(GuideFault::NotFinite { word: word.to_owned() }) }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{read, refused};
    use super::*;

    #[test]
    fn all_styles_read_alike() {
        let guides = |lines: [usize; 2]| {
            let named = |guide: Guide, line: usize| guide.named(format!("guides.csv, line {line}"));
            vec![
                named(Guide::vector([1.0, 2.0, 3.0], [0.0, -1.0, 0.5]), lines[0]),
                named(Guide::vector([-1e3, 0.0, 0.0], [1.0, 0.0, 0.0]).within(0.25).with_weight(2.0), lines[1]),
            ]
        };
        let texts = [
            ("1,2,3,0,-1,0.5\n-1e3,0,0,1,0,0,0.25,2\n", [1, 2]),
            (
                "x,y,z,dx,dy,dz,radius,weight\r\n# two guides\r\n\r\n 1, 2, 3, 0, -1, 0.5 # first\r\n\
                 -1e3, 0, 0, 1, 0, 0, 0.25, 2",
                [4, 5],
            ),
            ("\u{feff}x y z dx dy dz r w\n1 2 3  0 -1 .5\n\t-1000 0 0\t1 0 0 2.5e-1 2\n", [2, 3]),
            ("W;X;Y;Z;DX;DY;DZ;R\n;1;2;3;0;-1;0.5;\n2;-1000;0;0;1;0;0;0.25\n", [2, 3]),
            ("dz,dy,dx,z,y,x,weight,radius\n0.5,-1,0,3,2,1,,0\n0,0,1,0,0,-1e3,2,0.25\n", [2, 3]),
        ];
        for (text, lines) in texts {
            assert_eq!(read("guides.csv", text).expect("they are guides"), guides(lines), "{text}");
        }
    }

    #[test]
    fn wrong_lines_are_named() {
        let good = "1,2,3,0,-1,0.5\n";
        let cases = [
            ("1,2,3,0,-1", "line 2: a guide has 6 to 8 numbers (x, y, z, dx, dy, dz, and perhaps a radius"),
            ("1,2,3,0,-1,0,1,8,9", "not 9"),
            ("1,2,3,0,-1,,0", "line 2: \"\" is not a number"),
            ("x,y,z,dx,dy,dz", "line 2: \"x\" is not a number"),
            ("1 2 3, 0 -1 0, 0, 0, 0, 0", "line 2: \"1 2 3\" is not a number"),
            ("1,2,nan,0,-1,0", "line 2: \"nan\" is not finite"),
            ("1,2,3,0,0,-0", "line 2: the direction"),
            ("1,2,3,1,0,0,-2", "line 2: the radius -2 is negative"),
            ("1,2,3,1,0,0,0,0", "line 2: the weight 0 is not above 0"),
        ];
        let texts = cases.map(|(line, part)| (format!("{good}{line}\n"), part));
        refused(&texts.each_ref().map(|(text, part)| (text.as_str(), *part)));
        refused(&[
            ("x,y,z,dx,dy,colour\n", "line 1: there is no column \"colour\""),
            ("x,y,z,dx,dy\n1,2,3,4,5", "line 1: the header has no column dz"),
            ("x,y,z,dx,dy,dz,r,radius\n", "line 1: the column radius is there twice"),
            ("r,x,y,z,dx,dy,dz\n1,2,3,4,5,6\n", "line 2: 6 values under a header of 7 columns, of which 7 are needed"),
            ("x,y,z,dx,dy,dz\n1,2,3,4,5,6,7\n", "line 2: 7 values under a header of 6 columns"),
            ("x,y,z,dx,dy,dz\n1,2,3,4,5,\n", "line 2: \"\" is not a number"),
        ]);
    }
}
