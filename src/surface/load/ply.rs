//! PLY, ASCII and binary of both byte orders: the coordinates, colours, texture coordinates and other real numbers of vertices, the
//! corners, regions and texture coordinates of faces, and strips of triangles. Other properties and elements are skipped.

use super::cursor::{Cursor, Encoding, Nowhere, Stop, Type, vertex};
use super::text::{parsed, shown, words};
use super::{Fault, LoadError, Polygons, Regions};
use crate::surface::attributes::{Attribute, AttributeKind, Attributes};
use crate::surface::regions::{Numbers, attribute_rank};
use rustc_hash::FxHashMap;

pub(super) fn recognises(bytes: &[u8]) -> bool {
    bytes.strip_prefix(b"ply").and_then(|rest| rest.first()).is_some_and(u8::is_ascii_whitespace)
}

pub(super) fn parse(bytes: &[u8], file: &str) -> Result<Polygons, LoadError> {
    let header = Header::parse(bytes).map_err(|(line, fault)| LoadError::at_line(file, bytes, line, fault))?;
    let (vertices, faces) = (header.rows(VERTEX), header.rows(FACE).max(header.rows(STRIPS)));
    if vertices == 0 {
        return Err(LoadError::NoVertices { file: file.to_owned() });
    }
    if faces == 0 {
        return Err(LoadError::NoFaces { file: file.to_owned(), vertices });
    }
    let regions = Numbers { names: header.region_names(bytes), ..Numbers::default() };
    let mut rows = Rows { regions, numbers: vec![Vec::new(); header.numbers()], ..Rows::default() };
    let mut points = Vec::new();
    let mut nowhere = Nowhere::default();
    header.read(file, &mut rows, |row, start, [x, y, z, _]| {
        nowhere.note(row, [x, y, z], || start);
        points.push([x, y, z]);
    })?;
    rows.polygons.points = points;
    let attributes = header.attributes(&mut rows);
    let mut polygons = rows.polygons;
    polygons.attributes = attributes;
    if let Some(name) = header.region() {
        polygons.regions = Regions::from_numbers(&rows.regions, name, polygons.ends.len());
    }
    if polygons.ends.is_empty() {
        return Err(LoadError::NoFaces { file: file.to_owned(), vertices });
    }
    match nowhere.error(&polygons, file, VERTEX) {
        Some(error) => Err(error),
        None => Ok(polygons),
    }
}

/// The coordinates and the property `size` of all vertices.
pub(super) fn sizes(bytes: &[u8], file: &str) -> Result<Vec<[f64; 4]>, LoadError> {
    let header = Header::parse(bytes).map_err(|(line, fault)| LoadError::at_line(file, bytes, line, fault))?;
    if !header.has(VERTEX, Role::Size) {
        let fault = Fault::HeaderLacks { what: "the property size of the element vertex" };
        return Err(LoadError::at_line(file, bytes, header.body.line - 1, fault));
    }
    let mut sizes = Vec::new();
    header.read(file, &mut Rows::default(), |_, _, row| sizes.push(row))?;
    Ok(sizes)
}

const VERTEX: &str = "vertex";
const FACE: &str = "face";
/// One row holds strips, apart by -1: every vertex after the second makes a triangle with the two before it.
const STRIPS: &str = "tristrips";

/// The names that programs give to colours and texture coordinates of vertices.
const COLOURS: [[&str; 3]; 3] =
    [["red", "green", "blue"], ["r", "g", "b"], ["diffuse_red", "diffuse_green", "diffuse_blue"]];
const TEXTURES: [[&str; 2]; 3] = [["s", "t"], ["u", "v"], ["texture_u", "texture_v"]];
/// Normals, which a mesh has of its own.
const NORMALS: [&str; 3] = ["nx", "ny", "nz"];

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
    name: String,
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
    /// The vertices of strips.
    Strips,
    /// The number of a face's region.
    Region,
    /// A number of a vertex, by its place among these.
    Number(usize),
    /// The texture coordinates of a face's corners, two each.
    CornerTexture,
    Ignored,
}

/// What rows hold, but for vertices.
#[derive(Default)]
struct Rows {
    polygons: Polygons,
    regions: Numbers,
    /// Of each property with [`Role::Number`], the numbers of all vertices.
    numbers: Vec<Vec<f64>>,
    /// The texture coordinates of corners.
    textures: Vec<f64>,
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
                    encoding = Some(encoding_of(format).map_err(|fault| (line, fault))?);
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
                    let kind =
                        |word: &&[u8]| type_of(word).ok_or_else(|| (line, Fault::UnknownType { word: shown(word) }));
                    let role = Role::of(&element.name, name, length.is_some());
                    let (value, list) = (kind(value)?, length);
                    let length = list.map(kind).transpose()?;
                    if let (Some(Type::F32 | Type::F64), Some(word)) = (length, list) {
                        return Err((line, Fault::UnknownType { word: shown(word) }));
                    }
                    let name = String::from_utf8_lossy(name).into_owned();
                    element.properties.push(Property { name, role, length, value });
                }
                ([b"end_header"], _) => break,
                _ => return Err(unknown()),
            }
        }
        let lacks = |what| (line, Fault::HeaderLacks { what });
        let encoding = encoding.ok_or(lacks("a line format"))?;
        let body = Cursor { bytes, at, line: line + 1, encoding };
        let mut header = Self { elements, body };
        if header.rows(VERTEX) > 0 && !(0..3).all(|axis| header.has(VERTEX, Role::Axis(axis))) {
            return Err(lacks("the properties x, y and z of the element vertex"));
        }
        let strips = header.has(STRIPS, Role::Strips);
        if header.rows(FACE) > 0 && !header.has(FACE, Role::Corners) && !strips {
            return Err(lacks("the list vertex_indices of the element face"));
        }
        if header.rows(STRIPS) > 0 && !strips {
            return Err(lacks("the list vertex_indices of the element tristrips"));
        }
        header.choose_region();
        header.choose_numbers();
        Ok(header)
    }

    /// Of the properties that may tell the regions of faces, the first by rank does.
    fn choose_region(&mut self) {
        if !self.has(FACE, Role::Corners) {
            return;
        }
        let Some(face) = self.elements.iter_mut().find(|element| element.name == FACE) else { return };
        let whole =
            face.properties.iter_mut().filter(|property| property.length.is_none() && property.value.is_integer());
        let ranked = whole.filter_map(|property| Some((attribute_rank(&property.name)?, property)));
        if let Some((_, property)) = ranked.min_by_key(|(rank, _)| *rank) {
            property.role = Role::Region;
        }
    }

    /// Of the other properties of vertices, colours and real numbers are read.
    fn choose_numbers(&mut self) {
        let Some(vertex) = self.elements.iter_mut().find(|element| element.name == VERTEX) else { return };
        let other = vertex.properties.iter_mut().filter(|p| p.role == Role::Ignored && p.length.is_none());
        let read = other.filter(|p| {
            let is_real = !p.value.is_integer() && !NORMALS.contains(&&*p.name);
            is_real || COLOURS.iter().flatten().any(|name| *name == p.name)
        });
        read.enumerate().for_each(|(number, property)| property.role = Role::Number(number));
    }

    /// How many properties of vertices are read as numbers.
    fn numbers(&self) -> usize {
        let properties = self.find(VERTEX).into_iter().flat_map(|vertex| &vertex.properties);
        properties.filter(|property| matches!(property.role, Role::Number(_))).count()
    }

    /// The attributes that rows hold, and the names of those that were skipped.
    fn attributes(&self, rows: &mut Rows) -> Attributes {
        let mut attributes = Attributes::default();
        let properties = self.find(VERTEX).map_or(&[][..], |vertex| &vertex.properties);
        let find = |name: &str| properties.iter().find(|p| p.name == name && matches!(p.role, Role::Number(_)));
        let all = |names: &[&str]| names.iter().map(|name| find(name)).collect::<Option<Vec<_>>>();
        let mut used: Vec<&str> = Vec::new();
        let groups = [
            (AttributeKind::Colour, COLOURS.iter().find_map(|names| all(names))),
            (AttributeKind::Texture, TEXTURES.iter().find_map(|names| all(names))),
        ];
        for (kind, group) in groups {
            let Some(group) = group else { continue };
            used.extend(group.iter().map(|property| &*property.name));
            let columns: Vec<(&Vec<f64>, f64)> = group
                .iter()
                .filter_map(|property| match property.role {
                    Role::Number(number) => Some((&rows.numbers[number], property.value.full())),
                    _ => None,
                })
                .collect();
            let count = rows.polygons.points.len();
            let values = (0..count).flat_map(|v| columns.iter().map(move |(column, most)| column[v] / most)).collect();
            attributes.list.push(Attribute::of_vertices("", kind, group.len(), values));
        }
        for property in properties.iter().filter(|property| !used.contains(&&*property.name)) {
            match property.role {
                Role::Number(number) if !property.value.is_integer() => {
                    let values = std::mem::take(&mut rows.numbers[number]);
                    attributes.list.push(Attribute::of_vertices(&property.name, AttributeKind::Numbers, 1, values));
                }
                Role::Number(_) | Role::Ignored if !NORMALS.contains(&&*property.name) => {
                    attributes.leave_out(property.name.clone());
                }
                _ => {}
            }
        }
        let of_faces = self.find(FACE).into_iter().flat_map(|face| &face.properties);
        for property in of_faces.filter(|property| property.role == Role::Ignored) {
            attributes.leave_out(format!("{} of faces", property.name));
        }
        let corners = rows.polygons.corners.len();
        if !rows.textures.is_empty() && rows.textures.len() == 2 * corners {
            let texture = Attribute::of_vertices("", AttributeKind::Texture, 2, std::mem::take(&mut rows.textures));
            attributes.list.retain(|attribute| attribute.kind != AttributeKind::Texture);
            attributes.list.push(Attribute { of_corners: (0..corners as u32).collect(), ..texture });
        } else if !rows.textures.is_empty() {
            attributes.leave_out("texture coordinates, which some faces lack".to_owned());
        }
        attributes
    }

    /// The names of regions, which comments tell: `comment region 3 wing`.
    fn region_names(&self, bytes: &[u8]) -> FxHashMap<i64, String> {
        let named = |line: &[u8]| {
            let mut words = words(line);
            let is_name = words.next() == Some(b"comment") && words.next() == Some(b"region");
            let number = words.next().filter(|_| is_name).and_then(parsed)?;
            Some((number, words.map(String::from_utf8_lossy).collect::<Vec<_>>().join(" ")))
        };
        bytes[..self.body.at].split(|&byte| byte == b'\n').filter_map(named).collect()
    }

    /// The name of the property that tells the regions of faces.
    fn region(&self) -> Option<&str> {
        let mut properties = self.find(FACE)?.properties.iter();
        properties.find(|property| property.role == Role::Region).map(|property| property.name.as_str())
    }

    /// Reads all rows; `visit` is told the number and place of each vertex, and its values of x, y, z and size.
    fn read(
        &self,
        file: &str,
        rows: &mut Rows,
        mut visit: impl FnMut(usize, Cursor<'a>, [f64; 4]),
    ) -> Result<(), LoadError> {
        let mut cursor = self.body;
        let vertices = self.rows(VERTEX);
        // Rows without a property take no bytes.
        for element in self.elements.iter().filter(|element| !element.properties.is_empty()) {
            let is_vertex = element.name == VERTEX;
            let kind = [&*shown(element.name.as_bytes()), &*element.plural()];
            cursor.records(file, kind, element.rows, |cursor, row| {
                if cursor.encoding == Encoding::Ascii {
                    cursor.skip_blanks();
                }
                let start = *cursor;
                let values = element.read_row(cursor, vertices, rows)?;
                if is_vertex {
                    visit(row, start, values);
                }
                Ok(())
            })?;
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

fn encoding_of(words: &[&[u8]]) -> Result<Encoding, Fault> {
    match words {
        [b"ascii", b"1.0"] => Ok(Encoding::Ascii),
        [b"binary_little_endian", b"1.0"] => Ok(Encoding::LittleEndian),
        [b"binary_big_endian", b"1.0"] => Ok(Encoding::BigEndian),
        _ => Err(Fault::UnknownEncoding { format: shown(&words.join(&b' ')) }),
    }
}

fn type_of(word: &[u8]) -> Option<Type> {
    Some(match word {
        b"char" | b"int8" => Type::I8,
        b"uchar" | b"uint8" => Type::U8,
        b"short" | b"int16" => Type::I16,
        b"ushort" | b"uint16" => Type::U16,
        b"int" | b"int32" => Type::I32,
        b"uint" | b"uint32" => Type::U32,
        b"float" | b"float32" => Type::F32,
        b"double" | b"float64" => Type::F64,
        _ => return None,
    })
}

impl Role {
    fn of(element: &str, property: &[u8], list: bool) -> Self {
        match (element, property, list) {
            (VERTEX, b"x", false) => Self::Axis(0),
            (VERTEX, b"y", false) => Self::Axis(1),
            (VERTEX, b"z", false) => Self::Axis(2),
            (VERTEX, b"size", false) => Self::Size,
            (FACE, b"vertex_indices" | b"vertex_index", true) => Self::Corners,
            (FACE, b"texcoord", true) => Self::CornerTexture,
            (STRIPS, b"vertex_indices" | b"vertex_index", true) => Self::Strips,
            _ => Self::Ignored,
        }
    }
}

impl Element {
    /// Reads a row: adds its corners as a face, if it has some, and returns x, y, z and size, zero where it has none.
    fn read_row(&self, cursor: &mut Cursor, vertices: usize, rows: &mut Rows) -> Result<[f64; 4], Stop> {
        let mut values = [0.0; 4];
        let faces = rows.polygons.ends.len();
        for &Property { role, length, value, .. } in &self.properties {
            let Some(length) = length else {
                let number = cursor.value_in_line(value)?;
                match role {
                    Role::Axis(axis) => values[axis] = number,
                    Role::Size => values[3] = number,
                    Role::Region => rows.regions.marks.push((faces, number as i64)),
                    Role::Number(place) => {
                        if let Some(numbers) = rows.numbers.get_mut(place) {
                            numbers.push(number);
                        }
                    }
                    Role::Corners | Role::Strips | Role::CornerTexture | Role::Ignored => {}
                }
                continue;
            };
            let count = cursor.value_in_line(length)?;
            if count < 0.0 || count.fract() != 0.0 {
                return Err(Fault::NotACount { count: count.to_string() }.into());
            }
            let count = count as usize;
            match role {
                Role::Corners => {
                    for _ in 0..count {
                        rows.polygons.corners.push(vertex(cursor.value_in_line(value)?, vertices)?);
                    }
                    rows.polygons.end_face()?;
                }
                Role::CornerTexture => {
                    for _ in 0..count {
                        rows.textures.push(cursor.value_in_line(value)?);
                    }
                }
                Role::Strips => read_strips(cursor, count, value, vertices, &mut rows.polygons)?,
                _ if cursor.encoding == Encoding::Ascii => {
                    (0..count).try_for_each(|_| cursor.value_in_line(value).map(drop))?;
                }
                _ => cursor.skip(count, value)?,
            }
        }
        let ended = cursor.encoding != Encoding::Ascii || cursor.next_in_line().is_none_or(|byte| byte == b'\n');
        if ended { Ok(values) } else { Err(Fault::WrongRow { more: true }.into()) }
    }

    fn plural(&self) -> String {
        match self.name.as_str() {
            VERTEX => "vertices".to_owned(),
            FACE => "faces".to_owned(),
            other => format!("rows of the element {}", shown(other.as_bytes())),
        }
    }
}

fn read_strips(
    cursor: &mut Cursor,
    count: usize,
    kind: Type,
    vertices: usize,
    polygons: &mut Polygons,
) -> Result<(), Stop> {
    let mut strip = Vec::new();
    for _ in 0..count {
        let index = cursor.value_in_line(kind)?;
        if index == -1.0 {
            polygons.push_strip(&strip)?;
            strip.clear();
        } else {
            strip.push(vertex(index, vertices)?);
        }
    }
    Ok(polygons.push_strip(&strip)?)
}
