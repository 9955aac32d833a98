//! Reads surfaces from files.
//!
//! # Practice
//! The content tells the format, whatever the file's name; a file in gzip is unpacked first. OBJ is read through the crate `tobj`,
//! XML through `quick-xml`, and `flate2` and `base64` unpack. The other formats have readers of our own, for what crates do not
//! give (`stl_io` 0.11, `ply-rs-bw` 4.0, `serde-ply` 0.2, `mshio` 0.4 and `vtkio` 0.6 were looked at): one sentence with the line
//! or byte for every fault, coordinates as f64, names of regions, and files as other programs write them. No count in a header is
//! trusted: memory follows the bytes that are there.
//!
//! # Regions
//! | format | regions |
//! |---|---|
//! | OBJ | `g`, or `o` where there is no `g`, and `usemtl`: both names, apart by a blank |
//! | STL | solids of ASCII files |
//! | PLY | an integer property of `face`; names by comments like `comment region 3 wing` |
//! | MSH | physical groups of surfaces; of a face in several, all names |
//! | VTK, VTU, VTP | an integer array of cells; names by field data, as `wing` of the integers 3 and 2 |
//!
//! The integer is the first of `region`, `patch`, `label`, `material`, `part`, `group`, `gmsh:physical`, `physical` and `CellEntity`
//! that a file has. Case, whatever is neither letter nor digit, and `id`, `index` or a plural at the end do not matter.

mod cursor;
mod error;
mod foreign;
mod msh;
mod obj;
mod off;
mod ply;
mod polygons;
mod stl;
mod text;
mod vtk;

pub use error::{Fault, LoadError, Place};
pub(crate) use polygons::Polygons;

use super::{Regions, Soup};
use flate2::read::MultiGzDecoder;
use std::fmt;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;
use std::str::FromStr;

/// A format of surface files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Wavefront OBJ.
    Obj,
    /// STL, binary or ASCII.
    Stl,
    /// PLY, ASCII or binary.
    Ply,
    /// OFF, ASCII.
    Off,
    /// MSH of Gmsh, 2.2 and 4.1, ASCII or binary.
    Msh,
    /// VTK legacy, ASCII or binary.
    Vtk,
    /// VTU, an unstructured grid as XML.
    Vtu,
    /// VTP, poly data as XML.
    Vtp,
}

impl Format {
    /// All of them.
    pub const ALL: [Self; 8] = [Self::Obj, Self::Stl, Self::Ply, Self::Off, Self::Msh, Self::Vtk, Self::Vtu, Self::Vtp];

    /// The name that [`Format::from_str`] knows.
    pub fn name(self) -> &'static str {
        match self {
            Self::Obj => "obj",
            Self::Stl => "stl",
            Self::Ply => "ply",
            Self::Off => "off",
            Self::Msh => "msh",
            Self::Vtk => "vtk",
            Self::Vtu => "vtu",
            Self::Vtp => "vtp",
        }
    }

    /// The format that the content shows, if it shows one.
    fn of(bytes: &[u8]) -> Option<Self> {
        if ply::recognises(bytes) {
            Some(Self::Ply)
        } else if msh::recognises(bytes) {
            Some(Self::Msh)
        } else if vtk::legacy::recognises(bytes) {
            Some(Self::Vtk)
        } else if let Some(data_set) = vtk::xml::data_set(bytes) {
            // Of any other data set, the reader says that it is none of a surface.
            Some(if data_set == "PolyData" { Self::Vtp } else { Self::Vtu })
        } else if off::recognises(bytes) {
            Some(Self::Off)
        } else if stl::recognises(bytes) {
            Some(Self::Stl)
        } else {
            obj::recognises(bytes).then_some(Self::Obj)
        }
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name().to_uppercase())
    }
}

impl FromStr for Format {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|format| text.eq_ignore_ascii_case(format.name()));
        found.ok_or_else(|| {
            let names: Vec<_> = Self::ALL.iter().map(|format| format.name()).collect();
            format!("the formats are {}", names.join(", "))
        })
    }
}

/// Reads a surface from a file of any [`Format`]. All vertices of the file are kept, in its order, also those that no face
/// uses; STL's, which have no order, are those with different coordinates. Polygons are triangulated by ear clipping.
///
/// # Errors
/// [`LoadError`] says what is wrong, where, and what to do.
pub fn read(path: &Path) -> Result<Soup, LoadError> {
    read_as(path, None)
}

/// Reads a surface as [`read`] does, from a file of this format; without one, the content tells it.
///
/// # Errors
/// As [`read`], and where the content is plainly of another format.
pub fn read_as(path: &Path, format: Option<Format>) -> Result<Soup, LoadError> {
    polygons(path, format).map(Polygons::into_soup)
}

/// Reads a surface from a stream as [`read_as`] does. Error messages call it `name`.
///
/// # Errors
/// As [`read_as`].
pub fn read_stream(stream: impl Read, name: &str, format: Option<Format>) -> Result<Soup, LoadError> {
    polygons_of(stream, name, format).map(Polygons::into_soup)
}

/// The vertices and faces of a file.
pub(crate) fn polygons(path: &Path, format: Option<Format>) -> Result<Polygons, LoadError> {
    let file = path.display().to_string();
    if path.is_dir() {
        return Err(LoadError::Directory { file });
    }
    if matches!(path.try_exists(), Ok(false)) {
        return Err(LoadError::Missing { file });
    }
    match File::open(path) {
        Ok(stream) => polygons_of(stream, &file, format),
        Err(source) => Err(LoadError::Unreadable { file, source }),
    }
}

/// The coordinates and the property `size` of the vertices of PLY; `None` where the content is none.
pub(crate) fn ply_sizes(bytes: &[u8], name: &str) -> Option<Result<Vec<[f64; 4]>, LoadError>> {
    ply::recognises(bytes).then(|| ply::sizes(bytes, name))
}

/// With no more bytes, vertices and corners can be counted in 32 bits.
const MOST_BYTES: u64 = u32::MAX as u64;

/// What files in gzip begin with.
const GZIP: [u8; 2] = [0x1F, 0x8B];

fn polygons_of(stream: impl Read, name: &str, format: Option<Format>) -> Result<Polygons, LoadError> {
    let file = || name.to_owned();
    let all_of = |stream: &mut dyn Read, failed: fn(String, io::Error) -> LoadError| {
        let mut bytes = Vec::new();
        let length = stream.take(MOST_BYTES + 1).read_to_end(&mut bytes).map_err(|source| failed(file(), source))?;
        if length as u64 > MOST_BYTES { Err(LoadError::TooLarge { file: file() }) } else { Ok(bytes) }
    };
    let mut stream = stream;
    let mut bytes = all_of(&mut stream, |file, source| LoadError::Unreadable { file, source })?;
    if bytes.starts_with(&GZIP) {
        let mut packed = MultiGzDecoder::new(&bytes[..]);
        bytes = all_of(&mut packed, |file, source| LoadError::Packed { file, source })?;
    }
    if bytes.is_empty() {
        return Err(LoadError::Empty { file: file() });
    }
    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(&bytes);
    let bytes = &*text::with_line_feeds(bytes);
    if let Some(error) = foreign::refused(bytes, name) {
        return Err(error);
    }
    let found = Format::of(bytes);
    if let (Some(asked), Some(found)) = (format, found)
        && asked != found
    {
        return Err(LoadError::OtherFormat { file: file(), asked, found });
    }
    match format.or(found) {
        Some(Format::Ply) => ply::parse(bytes, name),
        Some(Format::Stl) => stl::parse(bytes, name),
        Some(Format::Off) => off::parse(bytes, name),
        Some(Format::Msh) => msh::parse(bytes, name),
        Some(Format::Vtk) => vtk::legacy::parse(bytes, name),
        Some(Format::Vtu | Format::Vtp) => vtk::xml::parse(bytes, name),
        Some(Format::Obj) | None => match bytes.iter().position(|&byte| byte == 0) {
            Some(offset) => Err(LoadError::Binary { file: file(), offset }),
            None => {
                let foreign = foreign::refused_text(bytes, name).filter(|_| format.or(found).is_none());
                foreign.map_or_else(|| obj::parse(bytes, name), Err)
            }
        },
    }
}
