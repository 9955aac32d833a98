//! PLY, ASCII and binary of both byte orders: the coordinates of vertices and the corners of faces.
//!
//! Other properties and elements are skipped. Every value is read as f64, which holds all of PLY's types.

use super::text::{parsed, shown, words};
use super::{Fault, LoadError, Place, Polygons};

pub(super) fn recognises(bytes: &[u8]) -> bool {
    bytes.strip_prefix(b"ply").and_then(|rest| rest.first()).is_some_and(u8::is_ascii_whitespace)
}

pub(super) fn parse(bytes: &[u8], file: &str) -> Result<Polygons, LoadError> {
    let header = Header::parse(bytes).map_err(|(line, fault)| LoadError::at_line(file, bytes, line, fault))?;
    let (vertices, faces) = (header.rows(VERTEX), header.rows(FACE));
    if vertices == 0 {
        return Err(LoadError::NoVertices { file: file.to_owned() });
    }
    if faces == 0 {
        return Err(LoadError::NoFaces { file: file.to_owned(), vertices });
    }
    let mut polygons = Polygons::default();
    // Where the vertices are that are not finite; only those that a face uses are wrong.
    let mut nowhere = Vec::new();
    let mut points = Vec::new();
    header.rows_of_all(bytes, file, &mut polygons, |element, row, start, [x, y, z, _]| {
        if element.name == VERTEX {
            points.push([x, y, z]);
            if ![x, y, z].iter().all(|coordinate| coordinate.is_finite()) {
                nowhere.push((element, row, start));
            }
        }
    })?;
    polygons.points = points;
    if let Some(vertex) = polygons.nowhere()
        && let Some((element, row, start)) = nowhere.into_iter().find(|wrong| wrong.1 == vertex)
    {
        let wrong = polygons.points[vertex].into_iter().find(|coordinate| !coordinate.is_finite());
        let word = wrong.map_or(String::new(), |coordinate| coordinate.to_string());
        return Err(start.error(element, row, Fault::NotFinite { word }, bytes, file));
    }
    Ok(polygons)
}

/// The coordinates and the property `size` of all vertices.
pub(super) fn sizes(bytes: &[u8], file: &str) -> Result<Vec<[f64; 4]>, LoadError> {
    let header = Header::parse(bytes).map_err(|(line, fault)| LoadError::at_line(file, bytes, line, fault))?;
    if !header.has(VERTEX, Role::Size) {
        let fault = Fault::HeaderLacks { what: "the property size of the element vertex" };
        return Err(LoadError::at_line(file, bytes, header.body.line - 1, fault));
    }
    let mut polygons = Polygons::default();
    let mut sizes = Vec::new();
    header.rows_of_all(bytes, file, &mut polygons, |element, _, _, row| {
        if element.name == VERTEX {
            sizes.push(row);
        }
    })?;
    Ok(sizes)
}

const VERTEX: &str = "vertex";
const FACE: &str = "face";

/// What the header says, and where the data begins.
struct Header<'a> {
    elements: Vec<Element>,
    body: Cursor<'a>,
}

struct Element {
    name: String,
    rows: usize,
    properties: Vec<Property>,
}

struct Property {
    role: Role,
    /// The type of a list's length, if it is a list.
    length: Option<Type>,
    /// The type of a value, or of a list's values.
    value: Type,
}

#[derive(Clone, Copy, PartialEq)]
enum Role {
    /// A coordinate of a vertex.
    Axis(usize),
    /// The tile side that is wanted at a vertex.
    Size,
    /// The vertices of a face.
    Corners,
    Ignored,
}

#[derive(Clone, Copy, PartialEq)]
enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

#[derive(Clone, Copy, PartialEq)]
enum Type {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl<'a> Header<'a> {
    /// The header, or its first wrong line, counted from 1.
    fn parse(bytes: &'a [u8]) -> Result<Self, (usize, Fault)> {
        let mut encoding = None;
        let mut elements: Vec<Element> = Vec::new();
        let (mut line, mut at) = (0, 0);
        loop {
            let length = bytes[at..].iter().position(|&byte| byte == b'\n').ok_or((1, Fault::EndlessHeader))?;
            let content = bytes[at..at + length].trim_ascii();
            at += length + 1;
            line += 1;
            let unknown = || (line, Fault::HeaderLine { line: shown(content) });
            match (words(content).collect::<Vec<_>>().as_slice(), elements.last_mut()) {
                ([] | [b"comment" | b"obj_info", ..], _) => {}
                ([b"ply"], _) if line == 1 => {}
                ([b"format", format @ ..], _) => {
                    encoding = Some(Encoding::parse(format).map_err(|fault| (line, fault))?);
                }
                ([b"element", name, rows], _) => {
                    let name = String::from_utf8_lossy(name).into_owned();
                    elements.push(Element { name, rows: parsed(rows).ok_or_else(unknown)?, properties: Vec::new() });
                }
                ([b"property", words @ .., name], Some(element)) => {
                    let (length, value) = match words {
                        [value] => (None, value),
                        [b"list", length, value] => (Some(length), value),
                        _ => return Err(unknown()),
                    };
                    let kind = |word: &&[u8]| {
                        Type::parse(word).ok_or_else(|| (line, Fault::UnknownType { word: shown(word) }))
                    };
                    let role = Role::of(&element.name, name, length.is_some());
                    let (value, list) = (kind(value)?, length);
                    let length = list.map(kind).transpose()?;
                    if let (Some(Type::F32 | Type::F64), Some(word)) = (length, list) {
                        return Err((line, Fault::UnknownType { word: shown(word) }));
                    }
                    element.properties.push(Property { role, length, value });
                }
                ([b"end_header"], _) => break,
                _ => return Err(unknown()),
            }
        }
        let lacks = |what| (line, Fault::HeaderLacks { what });
        let encoding = encoding.ok_or(lacks("a line format"))?;
        let body = Cursor { bytes, at, line: line + 1, encoding };
        let header = Self { elements, body };
        if header.rows(VERTEX) > 0 && !(0..3).all(|axis| header.has(VERTEX, Role::Axis(axis))) {
            return Err(lacks("the properties x, y and z of the element vertex"));
        }
        if header.rows(FACE) > 0 && !header.has(FACE, Role::Corners) {
            return Err(lacks("the list vertex_indices of the element face"));
        }
        Ok(header)
    }

    /// Reads all rows: their faces into `polygons`; `visit` is told the element, the row's number and place, and its values
    /// of x, y, z and size.
    fn rows_of_all<'h>(
        &'h self,
        bytes: &[u8],
        file: &str,
        polygons: &mut Polygons,
        mut visit: impl FnMut(&'h Element, usize, Cursor<'a>, [f64; 4]),
    ) -> Result<(), LoadError> {
        let mut cursor = self.body;
        // Rows without a property take no bytes.
        for element in self.elements.iter().filter(|element| !element.properties.is_empty()) {
            for row in 0..element.rows {
                let start = cursor.begin_row();
                let values = element.read_row(&mut cursor, self.rows(VERTEX), polygons).map_err(|stop| match stop {
                    Stop::End => {
                        let what = element.plural();
                        LoadError::CutOff { file: file.to_owned(), what, said: element.rows, found: row }
                    }
                    Stop::Fault(fault) => start.error(element, row, fault, bytes, file),
                })?;
                visit(element, row, start, values);
            }
        }
        Ok(())
    }

    fn has(&self, element: &str, role: Role) -> bool {
        self.find(element).is_some_and(|element| element.properties.iter().any(|property| property.role == role))
    }

    fn find(&self, name: &str) -> Option<&Element> {
        self.elements.iter().find(|element| element.name == name)
    }

    fn rows(&self, name: &str) -> usize {
        self.find(name).map_or(0, |element| element.rows)
    }
}

impl Encoding {
    fn parse(words: &[&[u8]]) -> Result<Self, Fault> {
        match words {
            [b"ascii", b"1.0"] => Ok(Self::Ascii),
            [b"binary_little_endian", b"1.0"] => Ok(Self::LittleEndian),
            [b"binary_big_endian", b"1.0"] => Ok(Self::BigEndian),
            _ => Err(Fault::UnknownEncoding { format: shown(&words.join(&b' ')) }),
        }
    }
}

impl Type {
    fn parse(word: &[u8]) -> Option<Self> {
        Some(match word {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }

    fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}

impl Role {
    fn of(element: &str, property: &[u8], list: bool) -> Self {
        match (element, property, list) {
            (VERTEX, b"x", false) => Self::Axis(0),
            (VERTEX, b"y", false) => Self::Axis(1),
            (VERTEX, b"z", false) => Self::Axis(2),
            (VERTEX, b"size", false) => Self::Size,
            (FACE, b"vertex_indices" | b"vertex_index", true) => Self::Corners,
            _ => Self::Ignored,
        }
    }
}

impl Element {
    /// Reads a row: adds its corners as a face, if it has some, and returns x, y, z and size, zero where it has none.
    fn read_row(&self, cursor: &mut Cursor, vertices: usize, polygons: &mut Polygons) -> Result<[f64; 4], Stop> {
        let mut values = [0.0; 4];
        for &Property { role, length, value } in &self.properties {
            let Some(length) = length else {
                let number = cursor.value(value)?;
                match role {
                    Role::Axis(axis) => values[axis] = number,
                    Role::Size => values[3] = number,
                    Role::Corners | Role::Ignored => {}
                }
                continue;
            };
            let count = cursor.value(length)?;
            if count < 0.0 || count.fract() != 0.0 {
                return Err(Fault::NoListLength { count }.into());
            }
            let count = count as usize;
            if role != Role::Corners {
                cursor.skip(count, value)?;
                continue;
            }
            for _ in 0..count {
                let index = cursor.value(value)?;
                if !(0.0..vertices as f64).contains(&index) || index.fract() != 0.0 {
                    return Err(Fault::NoSuchVertex { index, vertices }.into());
                }
                polygons.corners.push(index as u32);
            }
            polygons.end_face()?;
        }
        cursor.end_row()?;
        Ok(values)
    }

    fn plural(&self) -> String {
        match self.name.as_str() {
            VERTEX => "vertices".to_owned(),
            FACE => "faces".to_owned(),
            other => format!("rows of the element {}", shown(other.as_bytes())),
        }
    }
}

/// Why a row cannot be read.
enum Stop {
    /// The file ends.
    End,
    Fault(Fault),
}

impl From<Fault> for Stop {
    fn from(fault: Fault) -> Self {
        Self::Fault(fault)
    }
}

/// A place in the data.
#[derive(Clone, Copy)]
struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
    /// The line, counted from 1, where the data is text.
    line: usize,
    encoding: Encoding,
}

impl<'a> Cursor<'a> {
    /// Goes to where the next row begins.
    fn begin_row(&mut self) -> Self {
        if self.encoding == Encoding::Ascii {
            while let Some(byte) = self.rest().first().filter(|byte| byte.is_ascii_whitespace()) {
                self.line += usize::from(*byte == b'\n');
                self.at += 1;
            }
        }
        *self
    }

    /// A row of text ends where its line does.
    fn end_row(&mut self) -> Result<(), Stop> {
        let ended = self.encoding != Encoding::Ascii || self.next_in_line().is_none_or(|byte| byte == b'\n');
        if ended { Ok(()) } else { Err(Fault::WrongRow { more: true }.into()) }
    }

    /// The next byte that is no blank.
    fn next_in_line(&mut self) -> Option<u8> {
        let blank = |byte: &u8| byte.is_ascii_whitespace() && *byte != b'\n';
        self.at += self.rest().iter().take_while(|byte| blank(byte)).count();
        self.rest().first().copied()
    }

    fn rest(&self) -> &'a [u8] {
        &self.bytes[self.at..]
    }

    fn value(&mut self, kind: Type) -> Result<f64, Stop> {
        if self.encoding == Encoding::Ascii {
            return self.written();
        }
        Ok(match kind {
            Type::I8 => i8::from_le_bytes(self.take()?).into(),
            Type::U8 => u8::from_le_bytes(self.take()?).into(),
            Type::I16 => i16::from_le_bytes(self.take()?).into(),
            Type::U16 => u16::from_le_bytes(self.take()?).into(),
            Type::I32 => i32::from_le_bytes(self.take()?).into(),
            Type::U32 => u32::from_le_bytes(self.take()?).into(),
            Type::F32 => f32::from_le_bytes(self.take()?).into(),
            Type::F64 => f64::from_le_bytes(self.take()?),
        })
    }

    /// A value in a row of text.
    fn written(&mut self) -> Result<f64, Stop> {
        if self.next_in_line().ok_or(Stop::End)? == b'\n' {
            return Err(Fault::WrongRow { more: false }.into());
        }
        let rest = self.rest();
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        self.at += length;
        let word = &rest[..length];
        Ok(parsed(word).ok_or_else(|| Fault::NotAValue { word: shown(word) })?)
    }

    /// The bytes of a number, the least first.
    fn take<const N: usize>(&mut self) -> Result<[u8; N], Stop> {
        let mut bytes = *self.rest().first_chunk().ok_or(Stop::End)?;
        self.at += N;
        if self.encoding == Encoding::BigEndian {
            bytes.reverse();
        }
        Ok(bytes)
    }

    fn skip(&mut self, count: usize, kind: Type) -> Result<(), Stop> {
        if self.encoding == Encoding::Ascii {
            return (0..count).try_for_each(|_| self.written().map(drop));
        }
        let length = count.checked_mul(kind.bytes()).filter(|&length| length <= self.rest().len());
        self.at += length.ok_or(Stop::End)?;
        Ok(())
    }

    /// The error for the row that begins here.
    fn error(&self, element: &Element, row: usize, fault: Fault, bytes: &[u8], file: &str) -> LoadError {
        if self.encoding == Encoding::Ascii {
            return LoadError::at_line(file, bytes, self.line, fault);
        }
        let place = Place::Record { kind: shown(element.name.as_bytes()), number: row, byte: self.at };
        LoadError::At { file: file.to_owned(), place, fault, unended: false }
    }
}
