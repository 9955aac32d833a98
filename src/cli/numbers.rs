//! Parsers of numbers in arguments, with their ranges and error messages.

use quadmosaic::pipeline::POINTS;
use std::ops::RangeInclusive;

/// A length above 0.
pub fn positive(text: &str) -> Result<f64, String> {
    let length = text.parse::<f64>().ok().filter(|length| length.is_finite() && *length > 0.0);
    length.ok_or_else(|| "a length is a number above 0, in model units".to_owned())
}

/// An angle from 1 to `MOST` degrees.
pub fn degrees<const MOST: u32>(text: &str) -> Result<f64, String> {
    number(text, 1.0..=f64::from(MOST)).ok_or_else(|| format!("the angle is a number from 1 to {MOST}, in degrees"))
}

/// The largest distance of connected tiles.
pub fn distance(text: &str) -> Result<f64, String> {
    number(text, 1.0..=10.0).ok_or_else(|| "the distance is a number from 1 to 10, in tile sides".to_owned())
}

/// A whole number up to `MOST`.
pub fn up_to<const MOST: usize>(text: &str) -> Result<usize, String> {
    text.parse().ok().filter(|count| *count <= MOST).ok_or_else(|| format!("write a whole number from 0 to {MOST}"))
}

/// A number in a range.
pub fn number(text: &str, range: RangeInclusive<f64>) -> Option<f64> {
    text.parse().ok().filter(|number| range.contains(number))
}

/// A number of vertices that can be asked for.
pub fn points(text: &str) -> Result<usize, String> {
    let refusal = || format!("ask for {} to {} vertices", POINTS.start(), POINTS.end());
    text.parse().ok().filter(|count| POINTS.contains(count)).ok_or_else(refusal)
}
