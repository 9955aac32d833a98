//! Options by their names, with values as text: those of the command line's `mesh`, and of Python.
//!
//! # Practice
//! The functions of this module read one value each, with its range and its message. [`Options::set`] reads any option by the name
//! that the command line has, with `_` for `-`.

mod settings;

pub use settings::{Preset, Setting};

use crate::field::{ASPECTS, Align};
use crate::mesh::connectivity::{ConnectivityOptions, Quads};
use crate::mesh::fill::Holes;
use crate::parametrize::Rows;
use crate::pipeline::{Fineness, Layout, Options, POINTS};
use crate::sizes::{LocalSize, NoLocalSize};
use crate::surface::{KeptBoundary, Length, LengthError, NoKeptBoundary};
use crate::symmetry::{NoSymmetry, Symmetry};
use std::ops::RangeInclusive;
use std::thread;
use std::time::Duration;
use thiserror::Error;

/// Why a text is no value of an option.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum ValueError {
    /// No length.
    #[error("a length is a number above 0, in model units")]
    Length,
    /// No length of a repair.
    #[error(transparent)]
    Repair(#[from] LengthError),
    /// No size at a place.
    #[error(transparent)]
    LocalSize(#[from] NoLocalSize),
    /// No symmetry.
    #[error(transparent)]
    Symmetry(#[from] NoSymmetry),
    /// No boundary that is kept.
    #[error(transparent)]
    KeptBoundary(#[from] NoKeptBoundary),
    /// No angle.
    #[error("the angle is a number from 1 to {most}, in degrees")]
    Angle {
        /// The largest angle.
        most: u32,
    },
    /// No distance of connected tiles.
    #[error("the distance is a number from 1 to 10, in tile sides")]
    Distance,
    /// No memory.
    #[error("write a number of bytes, or one with K, M, G or T, as 2G or 2GB")]
    Memory,
    /// No time.
    #[error("the time is a number above 0, at most {LONGEST}, in seconds")]
    Time,
    /// No whole number.
    #[error("write a whole number from 0 to {most}")]
    Whole {
        /// The largest number.
        most: usize,
    },
    /// No number of vertices that can be asked for.
    #[error("ask for {} to {} vertices", POINTS.start(), POINTS.end())]
    Points,
    /// No ratio of edges.
    #[error("the ratio is a number from 1.01 to 10")]
    Growth,
    /// No dial.
    #[error("the dial is a number from 0 to 1")]
    Dial,
    /// No factor of sides.
    #[error("the factor is a number from 1.01 to 10")]
    Factor,
    /// No aspect.
    #[error(
        "the aspect is the longer side over the shorter one, a number from {} to {}; guides say which side is longer",
        ASPECTS.start(),
        ASPECTS.end()
    )]
    Aspect,
    /// No alignment.
    #[error("write curvature:WEIGHT, the weight a number from 0 to 1000000, as curvature:1")]
    Align,
    /// None of some words.
    #[error("write one of {}", .0.join(", "))]
    Word(&'static [&'static str]),
}

/// Why an option cannot be set.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum OptionError {
    /// There is no such option.
    #[error("there is no option {name}; the options are {}", NAMES.join(", "))]
    Unknown {
        /// The name that was given.
        name: String,
    },
    /// The value is none of the option's.
    #[error("invalid value '{value}' for {name}: {fault}")]
    Value {
        /// The option.
        name: &'static str,
        /// The value that was given.
        value: String,
        /// What is wrong with it.
        fault: ValueError,
    },
}

/// The names of the options that [`Options::set`] knows.
pub const NAMES: [&str; 34] = [
    "preset",
    "layout",
    "points",
    "size",
    "symmetry",
    "keep_boundary",
    "refine_curvature",
    "around",
    "max_growth",
    "size_at",
    "around_holes",
    "min_size",
    "max_size",
    "weld",
    "imprint",
    "drop_parts",
    "fill_holes",
    "crease",
    "ignore_regions",
    "keep_uv",
    "ridge",
    "align",
    "rows",
    "fit",
    "fit_range",
    "aspect",
    "max_distance",
    "max_angle",
    "holes",
    "quads",
    "no_cleanup",
    "smoothing",
    "max_memory",
    "time_limit",
];

/// The longest time limit, in seconds.
const LONGEST: u32 = 100_000_000;

const LAYOUTS: &[&str; 3] = &[Layout::Mosaic.name(), Layout::Even.name(), Layout::Quads.name()];
const QUADS: &[&str; 3] = &[Quads::Paper.name(), Quads::Most.name(), Quads::All.name()];
const PRESETS: &[&str; 5] =
    &[Preset::Cfd.name(), Preset::Fem.name(), Preset::Scan.name(), Preset::Retopo.name(), Preset::Paper.name()];

impl Options {
    /// Sets one option to a value as the command line writes it; a flag to `true` or `false`. `size_at` adds to those before. What a preset or a layout sets,
    /// later calls override: set it first.
    ///
    /// # Errors
    /// Where there is no such option, or the value is none of its.
    pub fn set(&mut self, name: &str, value: &str) -> Result<(), OptionError> {
        let known = NAMES.into_iter().find(|known| *known == name);
        let name = known.ok_or_else(|| OptionError::Unknown { name: name.to_owned() })?;
        self.set_known(name, value).map_err(|fault| OptionError::Value { name, value: value.to_owned(), fault })
    }

    fn set_known(&mut self, name: &'static str, value: &str) -> Result<(), ValueError> {
        match name {
            "preset" => self.prepare_for(preset(value)?),
            "layout" => self.lay_out(layout(value)?),
            "points" => self.fineness = Fineness::Points(points(value)?),
            "size" => self.fineness = Fineness::Size(positive(value)?),
            "symmetry" => self.symmetry = Some(value.parse::<Symmetry>()?),
            "keep_boundary" => {
                self.keep_boundary = match value {
                    "true" => Some(KeptBoundary::Exact),
                    "false" => None,
                    _ => Some(value.parse::<KeptBoundary>()?),
                }
            }
            "refine_curvature" => self.sizes.curvature = Some(degrees::<90>(value)?),
            "around" => self.sizes.around = up_to::<100>(value)? as f64,
            "max_growth" => self.sizes.growth = growth(value)?,
            "size_at" => self.sizes.local.push(value.parse::<LocalSize>()?),
            "around_holes" => self.sizes.around_holes = up_to::<1000>(value)?,
            "min_size" => self.sizes.least = Some(positive(value)?),
            "max_size" => self.sizes.largest = Some(positive(value)?),
            "weld" => self.repairs.weld = Some(value.parse::<Length>()?),
            "imprint" => self.repairs.imprint = flag(value)?,
            "drop_parts" => self.repairs.drop_parts = Some(value.parse::<Length>()?),
            "fill_holes" => self.repairs.fill_holes = Some(value.parse::<Length>()?),
            "crease" => (self.features.crease, self.features.every_crease) = (degrees::<180>(value)?, true),
            "ignore_regions" => self.features.region_borders = !flag(value)?,
            "keep_uv" => self.features.texture_seams = flag(value)?,
            "ridge" => self.features.ridge = degrees::<180>(value)?,
            "align" => self.field.align = Some(align(value)?),
            "rows" => self.rows = word(value, &["paper", "continuous"], [Rows::Paper, Rows::Continuous])?,
            "fit" => self.fit = dial(value)?,
            "fit_range" => self.fit_range = factor(value)?,
            "aspect" => self.aspect = aspect(value)?,
            "max_distance" => self.connect.max_distance = distance(value)?,
            "max_angle" => self.connect.max_angle = degrees::<45>(value)?,
            "holes" => {
                let all = [Holes::Patterns, Holes::Triangles, Holes::Leave];
                self.holes = word(value, &["patterns", "triangles", "leave"], all)?;
            }
            "quads" => {
                let quads = word(value, QUADS, [Quads::Paper, Quads::Most, Quads::All])?;
                self.connectivity = Some(ConnectivityOptions { quads, ..self.connectivity.unwrap_or_default() });
            }
            "no_cleanup" => self.connectivity = if flag(value)? { None } else { Some(Default::default()) },
            "max_memory" => self.limits.memory = Some(memory(value)?),
            "time_limit" => self.limits.time = Some(seconds(value)?),
            _ => self.smoothing = up_to::<1000>(value)?,
        }
        Ok(())
    }
}

/// A number in a range.
pub fn number(text: &str, range: RangeInclusive<f64>) -> Option<f64> {
    text.parse().ok().filter(|number| range.contains(number))
}

/// A length above 0.
///
/// # Errors
/// As all functions of this module: where the text is none.
pub fn positive(text: &str) -> Result<f64, ValueError> {
    text.parse::<f64>().ok().filter(|length| length.is_finite() && *length > 0.0).ok_or(ValueError::Length)
}

/// An angle from 1 to `MOST` degrees.
///
/// # Errors
/// Where the text is none.
pub fn degrees<const MOST: u32>(text: &str) -> Result<f64, ValueError> {
    number(text, 1.0..=f64::from(MOST)).ok_or(ValueError::Angle { most: MOST })
}

/// The largest distance of connected tiles.
///
/// # Errors
/// Where the text is none.
pub fn distance(text: &str) -> Result<f64, ValueError> {
    number(text, 1.0..=10.0).ok_or(ValueError::Distance)
}

/// A whole number up to `MOST`.
///
/// # Errors
/// Where the text is none.
pub fn up_to<const MOST: usize>(text: &str) -> Result<usize, ValueError> {
    text.parse().ok().filter(|count| *count <= MOST).ok_or(ValueError::Whole { most: MOST })
}

/// A number of threads, of which more than there are cores are not started; 0 for as many as there are.
///
/// # Errors
/// Where the text is none.
pub fn threads(text: &str) -> Result<usize, ValueError> {
    let asked = up_to::<1024>(text)?;
    Ok(thread::available_parallelism().map_or(asked, |cores| asked.min(cores.get())))
}

/// A number of vertices that can be asked for.
///
/// # Errors
/// Where the text is none.
pub fn points(text: &str) -> Result<usize, ValueError> {
    text.parse().ok().filter(|count| POINTS.contains(count)).ok_or(ValueError::Points)
}

/// The units of memory, powers of 1024.
const UNITS: [char; 4] = ['K', 'M', 'G', 'T'];

/// A number of bytes, perhaps with a unit: `1e9`, `2G`, `2GB`, `2GiB`.
///
/// # Errors
/// Where the text is none.
pub fn memory(text: &str) -> Result<u64, ValueError> {
    let text = text.to_ascii_uppercase();
    let text = text.strip_suffix('B').unwrap_or(&text);
    let text = text.strip_suffix('I').filter(|rest| rest.ends_with(UNITS)).unwrap_or(text);
    let unit = UNITS.iter().position(|&unit| text.ends_with(unit));
    let digits = text.strip_suffix(UNITS).unwrap_or(text).trim_end();
    let is_plain = digits.bytes().all(|byte| byte.is_ascii_digit() || b".E+".contains(&byte));
    let number = digits.parse::<f64>().ok().filter(|number| is_plain && *number > 0.0 && number.is_finite());
    let bytes = number.ok_or(ValueError::Memory)? * 1024f64.powi(unit.map_or(0, |power| power as i32 + 1));
    Ok(bytes as u64)
}

/// A time above 0, in seconds.
///
/// # Errors
/// Where the text is none.
pub fn seconds(text: &str) -> Result<Duration, ValueError> {
    number(text, f64::MIN_POSITIVE..=f64::from(LONGEST)).map(Duration::from_secs_f64).ok_or(ValueError::Time)
}

/// The largest ratio of two edges beside each other.
///
/// # Errors
/// Where the text is none.
pub fn growth(text: &str) -> Result<f64, ValueError> {
    number(text, 1.01..=10.0).ok_or(ValueError::Growth)
}

/// A share from 0 to 1.
///
/// # Errors
/// Where the text is none.
pub fn dial(text: &str) -> Result<f64, ValueError> {
    number(text, 0.0..=1.0).ok_or(ValueError::Dial)
}

/// The largest side over the mean one.
///
/// # Errors
/// Where the text is none.
pub fn factor(text: &str) -> Result<f64, ValueError> {
    number(text, 1.01..=10.0).ok_or(ValueError::Factor)
}

/// The longer side of a tile over the shorter one.
///
/// # Errors
/// Where the text is none.
pub fn aspect(text: &str) -> Result<f64, ValueError> {
    number(text, ASPECTS).ok_or(ValueError::Aspect)
}

/// An alignment with curvature, as `curvature:1`.
///
/// # Errors
/// Where the text is none.
pub fn align(text: &str) -> Result<Align, ValueError> {
    let weight = text.strip_prefix("curvature:").and_then(|weight| number(weight, 0.0..=1e6));
    Ok(Align { weight: weight.ok_or(ValueError::Align)?, side: None })
}

/// A layout by its name.
///
/// # Errors
/// Where the text is none.
pub fn layout(text: &str) -> Result<Layout, ValueError> {
    word(text, LAYOUTS, Layout::ALL)
}

/// A preset by its name.
///
/// # Errors
/// Where the text is none.
pub fn preset(text: &str) -> Result<Preset, ValueError> {
    word(text, PRESETS, Preset::ALL)
}

fn flag(text: &str) -> Result<bool, ValueError> {
    word(text, &["true", "false"], [true, false])
}

/// The value of a word.
fn word<T, const N: usize>(text: &str, words: &'static [&'static str; N], values: [T; N]) -> Result<T, ValueError> {
    words.iter().zip(values).find(|(word, _)| **word == text).map(|(_, value)| value).ok_or(ValueError::Word(words))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn set(name: &str, value: &str) -> Result<Options, OptionError> {
        let mut options = Options::new(Fineness::Points(100));
        options.set(name, value).map(|()| options)
    }

    #[test]
    fn each_option_has_a_value_that_is_taken_and_one_that_is_refused() {
        let taken = |name: &str| match name {
            "imprint" | "ignore_regions" | "keep_uv" | "no_cleanup" => "true",
            "points" => "200",
            "symmetry" => "y:0.5",
            "size_at" => "ridges:0.1",
            "weld" | "drop_parts" | "fill_holes" => "0.1%",
            "align" => "curvature:1",
            "rows" => "continuous",
            "preset" => "scan",
            "layout" => "quads",
            "holes" => "leave",
            "quads" => "all",
            "fit" => "0.5",
            "max_growth" | "max_distance" | "aspect" => "1.5",
            _ => "5",
        };
        let default = format!("{:?}", Options::new(Fineness::Points(100)));
        for name in NAMES {
            let options = set(name, taken(name)).unwrap_or_else(|error| panic!("{error}"));
            assert_ne!(format!("{options:?}"), default, "{name} has an effect");
            for refused in ["", "-1", "1e9"] {
                let said = set(name, refused).err().map(|error| error.to_string()).unwrap_or_default();
                let lengths = ["size", "min_size", "max_size", "keep_boundary", "weld", "drop_parts", "fill_holes"];
                let is_value = refused == "1e9" && (name == "max_memory" || lengths.contains(&name));
                assert!(
                    is_value || said.starts_with(&format!("invalid value '{refused}' for {name}: ")),
                    "{name}: {said}"
                );
            }
        }
        for (text, bytes) in [
            ("500", 500),
            ("1e9", 1_000_000_000),
            ("2G", 2 << 30),
            ("2g", 2 << 30),
            ("2GB", 2 << 30),
            ("2GiB", 2 << 30),
            ("1.5 kB", 1536),
            ("3T", 3 << 40),
            ("7B", 7),
        ] {
            assert_eq!(memory(text), Ok(bytes), "{text}");
        }
        for refused in ["G", "2X", "2GG", "2iB", "2BB", "e9", "1e999", "inf", "nan", "-1G", "0", "2G2"] {
            assert_eq!(memory(refused), Err(ValueError::Memory), "{refused}");
        }
        let said = set("point", "5").expect_err("there is none").to_string();
        assert!(said.starts_with("there is no option point; the options are preset, layout, points,"), "{said}");
    }
}
