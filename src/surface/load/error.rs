//! Why a file gave no surface.

use super::Format;
use std::fmt;
use std::io;

/// Why a file gave no surface.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LoadError {
    /// There is no such file.
    #[error("there is no file {file}; check the path")]
    Missing {
        /// The path that was given.
        file: String,
    },
    /// The path is a directory's.
    #[error("{file} is a directory; name a file in it")]
    Directory {
        /// The path that was given.
        file: String,
    },
    /// The operating system could not read the file.
    #[error("{file} cannot be read ({source}); check its permissions and the disk")]
    Unreadable {
        /// The path that was given.
        file: String,
        /// What the operating system said.
        source: io::Error,
    },
    /// The file has so many bytes that 32 bits might not count what it holds.
    #[error("{file} is larger than 4 GiB; give it fewer triangles, or split it")]
    TooLarge {
        /// The file's name.
        file: String,
    },
    /// The file has no bytes.
    #[error("{file} is empty; write the surface to it again")]
    Empty {
        /// The file's name.
        file: String,
    },
    /// The file is plainly of another format than was asked for.
    #[error("{file} was to be read as {asked}, but it is {found}; leave the format out or say {}", .found.name())]
    OtherFormat {
        /// The file's name.
        file: String,
        /// The format that was asked for.
        asked: Format,
        /// The format that the file has.
        found: Format,
    },
    /// The file is of another kind than meshes that are read.
    #[error("{file} is {kind}, which is not read; {remedy}")]
    Foreign {
        /// The file's name.
        file: String,
        /// What it is.
        kind: &'static str,
        /// What to do with it.
        remedy: &'static str,
    },
    /// A file in gzip is damaged.
    #[error("{file} is packed by gzip and cannot be unpacked ({source}); copy or pack it again")]
    Packed {
        /// The file's name.
        file: String,
        /// What is wrong.
        source: io::Error,
    },
    /// The file holds bytes that no text has, and is of no binary format that we know.
    #[error(
        "{file} is not a text file (byte {offset} is zero) and of no binary format that is read; export it as OBJ, STL or PLY"
    )]
    Binary {
        /// The file's name.
        file: String,
        /// Where the first zero byte is, counted from 0.
        offset: usize,
    },
    /// There is no vertex.
    #[error("{file} has no vertices; check that it holds a surface as OBJ, STL or PLY")]
    NoVertices {
        /// The file's name.
        file: String,
    },
    /// There is no face.
    #[error("{file} has {vertices} vertices but no faces; export it as a surface")]
    NoFaces {
        /// The file's name.
        file: String,
        /// The number of vertices.
        vertices: usize,
    },
    /// The file ends before all is there that its header promises.
    #[error(
        "{file} is cut off: the header says {said} {what}, but the file ends after {found}; copy or export it again"
    )]
    CutOff {
        /// The file's name.
        file: String,
        /// What is missing: triangles, or the rows of a PLY element.
        what: String,
        /// How many the header promises.
        said: usize,
        /// How many are there as a whole.
        found: usize,
    },
    /// The file ends within a section of MSH or VTK.
    #[error("{file} ends within {section}; copy or export it again")]
    EndsWithin {
        /// The file's name.
        file: String,
        /// The section.
        section: String,
    },
    /// A binary STL file goes on where it should end.
    #[error("{file}: the header says {said} triangles, but {bytes} bytes follow them; export it again")]
    GoesOn {
        /// The file's name.
        file: String,
        /// How many triangles the header promises.
        said: usize,
        /// The number of bytes after these.
        bytes: usize,
    },
    /// The text is refused, though no line of it is known to be wrong.
    #[error("{file} cannot be read as OBJ ({reason}); export it again")]
    Refused {
        /// The file's name.
        file: String,
        /// What the reader said.
        reason: String,
    },
    /// One place is wrong.
    #[error("{file}, {place}: {fault}{}", if *.unended { "; it is the last line and has no end, so the file may be cut off" } else { "" })]
    At {
        /// The file's name.
        file: String,
        /// Where it is wrong.
        place: Place,
        /// What is wrong there.
        fault: Fault,
        /// It is the last line of a text, without the end that lines have.
        unended: bool,
    },
}

impl LoadError {
    /// The error for one line, counted from 1, of a text.
    pub(super) fn at_line(file: &str, text: &[u8], line: usize, fault: Fault) -> Self {
        let ends = text.iter().filter(|&&byte| byte == b'\n').count();
        let unended = !text.ends_with(b"\n") && line > ends;
        Self::At { file: file.to_owned(), place: Place::Line(line), fault, unended }
    }
}

/// A place in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// A line of a text, counted from 1.
    Line(usize),
    /// One of many things that a file lists.
    Item {
        /// Of what kind.
        kind: &'static str,
        /// Its number, counted from 0.
        number: usize,
    },
    /// A record of a binary file.
    Record {
        /// Of what kind.
        kind: String,
        /// Its number, counted from 0.
        number: usize,
        /// Where it begins, counted from 0.
        byte: usize,
    },
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(line) => write!(f, "line {line}"),
            Self::Item { kind, number } => write!(f, "{kind} {number} (counted from 0)"),
            Self::Record { kind, number, byte } => write!(f, "{kind} {number} (counted from 0) at byte {byte}"),
        }
    }
}

/// What is wrong with one place of a file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Fault {
    /// A coordinate is not a number.
    #[error("the coordinate {word:?} is not a number; write it like 0.25 or 2.5e-1")]
    NotANumber {
        /// The coordinate as written, shortened.
        word: String,
    },
    /// A coordinate is NaN, infinite or past the range of double precision.
    #[error("the coordinate {word:?} is not finite; every coordinate must be a number of size below 1.8e308")]
    NotFinite {
        /// The coordinate as written, shortened.
        word: String,
    },
    /// OBJ: a fourth coordinate of nearly zero.
    #[error("the weight (fourth coordinate) puts the vertex at infinity; leave it out or write 1")]
    ZeroWeight,
    /// A vertex without all of x, y and z.
    #[error("the vertex has {count} of 3 coordinates; write x, y and z")]
    TooFewCoordinates {
        /// The number of coordinates it has.
        count: usize,
    },
    /// OBJ: a face's corner is not an integer.
    #[error("{word:?} is not a vertex index; write a whole number, counted from 1")]
    NotAnIndex {
        /// The corner as written, shortened.
        word: String,
    },
    /// OBJ: a face uses vertex 0.
    #[error("the face uses vertex 0; OBJ counts vertices from 1")]
    IndexZero,
    /// OBJ: a face uses a vertex that does not exist.
    #[error("the face uses vertex {index}, but there are {vertices} vertices; correct the index or add the vertex")]
    IndexOutOfRange {
        /// The index as written.
        index: i64,
        /// The number of vertices it can use: all, or, if the index is negative, those before the face.
        vertices: usize,
    },
    /// A face uses a vertex that does not exist, in a format that counts from 0.
    #[error(
        "the face uses vertex {index}, but there are {vertices}, counted from 0; correct the index or add the vertex"
    )]
    NoSuchVertex {
        /// The index; a number that is not whole is none.
        index: f64,
        /// The number of vertices.
        vertices: usize,
    },
    /// A kind of the format that is not read.
    #[error("{what} is not read; {remedy}")]
    Unsupported {
        /// What is not read.
        what: String,
        /// What to do.
        remedy: &'static str,
    },
    /// VTK: the end of a cell is not after that of the one before it, or is past the last of the corners.
    #[error("a cell ends at corner {end}, but it begins at {last}, and there are {numbers}; export the file again")]
    NoCellEnd {
        /// The end.
        end: f64,
        /// The end of the cell before it.
        last: usize,
        /// The number of corners of all cells.
        numbers: usize,
    },
    /// VTU, VTP: an array has fewer bytes than its header says.
    #[error("the data of the array is damaged or shorter than it says; copy or export the file again")]
    ShortArray,
    /// VTU, VTP: an array cannot be unpacked.
    #[error("the array is compressed by zlib and cannot be unpacked; copy or export the file again")]
    BadCompression,
    /// VTU, VTP: the file is no XML.
    #[error("the file is no XML ({reason:?}); export it again")]
    NotXml {
        /// What the reader said.
        reason: String,
    },
    /// MSH: a face uses a node that does not exist.
    #[error("the face uses node {tag}, which is not among the nodes before it; correct the number or add the node")]
    NoSuchNode {
        /// The node's tag.
        tag: f64,
    },
    /// MSH, VTK: another word is needed.
    #[error("{word:?} stands where {wanted} should; export the file again")]
    WrongWord {
        /// The word, shortened.
        word: String,
        /// What should stand there.
        wanted: String,
    },
    /// A face with fewer than three corners.
    #[error("the face has {count} corners but needs at least 3; complete it or take it out")]
    TooFewIndices {
        /// The number of corners it has.
        count: usize,
    },
    /// A face with more corners than a polygon has.
    #[error("the face has {count} corners but may have {most} at most; split it")]
    TooManyIndices {
        /// The number of corners it has.
        count: usize,
        /// The most it may have.
        most: usize,
    },
    /// Strips or compressed data hold more corners than 32 bits count.
    #[error("the faces up to here have more than 4294967295 corners; split the file")]
    TooManyCorners,
    /// STL: a line begins with a word that means nothing.
    #[error(
        "{word:?} is no word of an STL file; write solid, facet, outer loop, vertex, endloop, endfacet or endsolid"
    )]
    UnknownWord {
        /// The word, shortened.
        word: String,
    },
    /// STL: a facet that is no triangle.
    #[error("the facet that ends here has {count} of 3 vertices; split or complete it")]
    NotATriangle {
        /// The number of vertices it has.
        count: usize,
    },
    /// STL: a solid is not ended.
    #[error(
        "the file ends within the solid that begins here; copy or export it again, or add endsolid if all is there"
    )]
    EndlessSolid,
    /// STL: a binary file without all of its header.
    #[error("the file ends within the header, which has 84 bytes; copy or export it again")]
    ShortHeader,
    /// PLY: a header without an end.
    #[error("the header begins here and has no line end_header; copy or export the file again")]
    EndlessHeader,
    /// PLY: a line of the header that means nothing.
    #[error("{line:?} is no line of a PLY header; write format, comment, element, property or end_header")]
    HeaderLine {
        /// The line, shortened.
        line: String,
    },
    /// PLY: an encoding that does not exist, or a version that is not 1.0.
    #[error("the format {format:?} is unknown; write ascii 1.0, binary_little_endian 1.0 or binary_big_endian 1.0")]
    UnknownEncoding {
        /// Encoding and version, as written, shortened.
        format: String,
    },
    /// PLY: a type that does not exist.
    #[error(
        "the type {word:?} is unknown; PLY has char, uchar, short, ushort, int, uint, float, double; lists have whole counts"
    )]
    UnknownType {
        /// The type, shortened.
        word: String,
    },
    /// A header does not tell how the data is written, or how much there is, or where coordinates or faces are.
    #[error("the header ends without {what}; export the file as a surface")]
    HeaderLacks {
        /// What is missing.
        what: &'static str,
    },
    /// A count, such as a list's length, is no whole number, or negative.
    #[error("{count:?} is no count; write a whole number from 0 up")]
    NotACount {
        /// What is written, shortened.
        count: String,
    },
    /// A value is not a number.
    #[error("the value {word:?} is not a number; write it like 3, 0.25 or 2.5e-1")]
    NotAValue {
        /// The value as written, shortened.
        word: String,
    },
    /// A row of text with more or fewer values than the header says.
    #[error("the line has too {} values; write as many as the header says", if *.more { "many" } else { "few" })]
    WrongRow {
        /// There are more than the header says.
        more: bool,
    },
}
