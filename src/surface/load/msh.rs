//! MSH (Gmsh), 2.2 and 4.1, ASCII and binary of both byte orders: triangles and quads, with their physical groups as regions.
//!
//! Of faces of higher order the corners are taken. Points, lines and volumes are passed over. Vertices keep the order of the
//! file, whatever their tags.
//!
//! The crate `mshio` (0.4.2) reads 4.1 alone and asks for faces of one type a block. So the sections are read here.
//!
//! Source: the reference manual of Gmsh, sections "MSH file format" and "MSH file format version 2 (legacy)".

use super::cursor::{Cursor, Encoding, Nowhere, Stop, Type};
use super::text::{shown, words};
use super::{Fault, LoadError, Polygons, Regions};
use crate::surface::regions::Numbers;
use rustc_hash::FxHashMap;

pub(super) fn recognises(bytes: &[u8]) -> bool {
    matches!(words(bytes).next(), Some(b"$MeshFormat" | b"$NOD" | b"$Comments" | b"$PhysicalNames"))
}

pub(super) fn parse(bytes: &[u8], file: &str) -> Result<Polygons, LoadError> {
    let mut reader = Reader {
        file,
        cursor: Cursor::new(bytes),
        encoding: Encoding::Ascii,
        version: None,
        nodes: Nodes::default(),
        nowhere: Nowhere::default(),
        sections: 0,
        record: ("section", 0, 0),
        groups: FxHashMap::default(),
        regions: Numbers::default(),
        joined: FxHashMap::default(),
        polygons: Polygons::default(),
    };
    while let Ok(word) = reader.cursor.word() {
        reader.section(word)?;
    }
    let Reader { nowhere, regions, mut polygons, .. } = reader;
    if polygons.points.is_empty() {
        return Err(LoadError::NoVertices { file: file.to_owned() });
    }
    if polygons.ends.is_empty() {
        return Err(LoadError::NoFaces { file: file.to_owned(), vertices: polygons.points.len() });
    }
    polygons.regions = Regions::from_numbers(&regions, ATTRIBUTE, polygons.ends.len());
    match nowhere.error(&polygons, file, "node") {
        Some(error) => Err(error),
        None => Ok(polygons),
    }
}

#[derive(Clone, Copy, PartialEq)]
enum Version {
    Two,
    Four,
}

/// Vertices by their tags.
#[derive(Default)]
struct Nodes {
    count: u32,
    /// Empty as long as the tags are 1, 2, 3 and so on.
    by_tag: FxHashMap<u64, u32>,
}

impl Nodes {
    fn push(&mut self, tag: u64) {
        if self.by_tag.is_empty() && tag != u64::from(self.count) + 1 {
            self.by_tag = (0..self.count).map(|vertex| (u64::from(vertex) + 1, vertex)).collect();
            self.by_tag.insert(tag, self.count);
        } else if !self.by_tag.is_empty() {
            self.by_tag.insert(tag, self.count);
        }
        self.count += 1;
    }

    fn vertex(&self, tag: f64) -> Result<u32, Fault> {
        let found = if self.by_tag.is_empty() {
            (1.0..=f64::from(self.count)).contains(&tag).then(|| tag as u32 - 1)
        } else {
            self.by_tag.get(&(tag as u64)).copied()
        };
        found.filter(|_| tag.fract() == 0.0).ok_or(Fault::NoSuchNode { tag })
    }
}

struct Reader<'a> {
    file: &'a str,
    cursor: Cursor<'a>,
    /// How nodes, elements and entities are written; the rest is text.
    encoding: Encoding,
    version: Option<Version>,
    nodes: Nodes,
    nowhere: Nowhere<'a>,
    sections: usize,
    /// The kind, the number and the place of what is being read.
    record: (&'static str, usize, usize),
    /// The number of the region of each surface, in 4.1.
    groups: FxHashMap<i64, i64>,
    regions: Numbers,
    /// The numbers of regions that are in two groups.
    joined: FxHashMap<(i64, i64), i64>,
    polygons: Polygons,
}

impl Reader<'_> {
    /// Reads a section, whose first word is this.
    fn section(&mut self, word: &[u8]) -> Result<(), LoadError> {
        let name = shown(word.strip_prefix(b"$").unwrap_or(word));
        self.begin("section", self.sections);
        self.sections += 1;
        let read = if word.starts_with(b"$") {
            self.cursor.rest_of_line();
            self.content(word).and_then(|()| self.end(&name))
        } else {
            Err(wrong_word(word, "a section such as $Nodes"))
        };
        read.map_err(|stop| match stop {
            Stop::End => {
                LoadError::EndsWithin { file: self.file.to_owned(), section: format!("${}", name.escape_debug()) }
            }
            Stop::Fault(fault) => {
                let (kind, number, at) = self.record;
                Cursor { at, encoding: self.encoding, ..self.cursor }.error(self.file, kind, number, fault)
            }
        })
    }

    fn content(&mut self, word: &[u8]) -> Result<(), Stop> {
        let is_data = matches!(word, b"$Nodes" | b"$Elements" | b"$Entities");
        let Some(version) = self.version.filter(|_| is_data) else {
            return match word {
                b"$MeshFormat" => self.format(),
                b"$PhysicalNames" => self.names(),
                b"$NOD" | b"$ELM" => Err(unsupported_version("1").into()),
                _ if is_data => Err(Fault::HeaderLacks { what: "a section $MeshFormat" }.into()),
                _ => Ok(()),
            };
        };
        match (word, version) {
            (b"$Entities", Version::Two) => return Ok(()),
            (b"$Entities", Version::Four) => self.in_encoding(Self::entities)?,
            (b"$Nodes", Version::Two) => {
                let count = self.cursor.count(INT)?;
                self.in_encoding(|reader| reader.nodes_2(count))?;
            }
            (b"$Nodes", Version::Four) => self.in_encoding(Self::nodes_4)?,
            (_, Version::Two) => {
                let count = self.cursor.count(INT)?;
                self.in_encoding(|reader| reader.elements_2(count))?;
            }
            (_, Version::Four) => self.in_encoding(Self::elements_4)?,
        }
        Ok(())
    }

    /// Goes past the end of a section. Sections that are not read are passed over.
    fn end(&mut self, name: &str) -> Result<(), Stop> {
        let end = format!("$End{name}");
        if matches!(name, "MeshFormat" | "PhysicalNames" | "Nodes" | "Elements" | "Entities") {
            return match self.cursor.word()? {
                word if word == end.as_bytes() => Ok(()),
                word => Err(wrong_word(word, &end)),
            };
        }
        let place =
            self.cursor.rest().windows(end.len()).position(|window| window == end.as_bytes()).ok_or(Stop::End)?;
        let passed = &self.cursor.rest()[..place];
        self.cursor.line += passed.iter().filter(|&&byte| byte == b'\n').count();
        self.cursor.at += place + end.len();
        Ok(())
    }

    /// Reads a part that is written as `$MeshFormat` says.
    fn in_encoding(&mut self, read: impl FnOnce(&mut Self) -> Result<(), Stop>) -> Result<(), Stop> {
        if self.encoding != Encoding::Ascii && self.version == Some(Version::Two) {
            self.cursor.rest_of_line();
        }
        self.cursor.encoding = self.encoding;
        read(self)?;
        self.cursor.encoding = Encoding::Ascii;
        Ok(())
    }

    fn begin(&mut self, kind: &'static str, number: usize) {
        self.record = (kind, number, self.cursor.at);
    }

    /// The version, 0 for ASCII or 1 for binary, and the size of a tag in 4.1.
    fn format(&mut self) -> Result<(), Stop> {
        let version = self.cursor.word()?;
        self.version = Some(match version {
            b"4.1" => Version::Four,
            b"2" | b"2.0" | b"2.1" | b"2.2" => Version::Two,
            _ => return Err(unsupported_version(&shown(version)).into()),
        });
        let is_binary = self.cursor.count(INT)? == 1;
        let size = self.cursor.count(INT)?;
        if size != 8 {
            let what = format!("MSH with numbers of {size} bytes");
            return Err(Fault::Unsupported { what, remedy: "write it with 8 (gmsh -format msh41)" }.into());
        }
        if is_binary {
            self.cursor.rest_of_line();
            self.encoding = match self.cursor.rest().get(..4).ok_or(Stop::End)? {
                [1, 0, 0, 0] => Encoding::LittleEndian,
                [0, 0, 0, 1] => Encoding::BigEndian,
                _ => return Err(Fault::HeaderLacks { what: "the number 1 that tells the order of bytes" }.into()),
            };
            self.cursor.at += 4;
        }
        Ok(())
    }

    /// The names of physical groups: dimension, number and the name in quotes. A line each, in binary files too.
    fn names(&mut self) -> Result<(), Stop> {
        for _ in 0..self.cursor.count(INT)? {
            let dimension = self.cursor.count(INT)?;
            let number = self.cursor.value(INT)? as i64;
            let name = self.cursor.rest_of_line();
            let name = name.strip_prefix(b"\"").unwrap_or(name);
            let name = name.strip_suffix(b"\"").unwrap_or(name);
            if dimension == 2 {
                self.regions.names.insert(number, String::from_utf8_lossy(name).into_owned());
            }
        }
        Ok(())
    }

    fn node(&mut self, tag: f64, point: [f64; 3]) {
        self.nowhere.note(self.polygons.points.len(), point, || Cursor { at: self.record.2, ..self.cursor });
        self.nodes.push(tag as u64);
        self.polygons.points.push(point);
    }

    fn point(&mut self) -> Result<[f64; 3], Stop> {
        Ok([self.cursor.value(Type::F64)?, self.cursor.value(Type::F64)?, self.cursor.value(Type::F64)?])
    }

    fn nodes_2(&mut self, count: usize) -> Result<(), Stop> {
        for number in 0..count {
            self.begin("node", number);
            let tag = self.cursor.value(INT)?;
            let point = self.point()?;
            self.node(tag, point);
        }
        Ok(())
    }

    /// In text an element is a line. In binary, elements of the same type and number of tags follow a head.
    fn elements_2(&mut self, count: usize) -> Result<(), Stop> {
        let mut number = 0;
        while number < count {
            self.begin("element", number);
            if self.cursor.encoding == Encoding::Ascii {
                self.cursor.value(INT)?;
                let kind = self.cursor.count(INT)?;
                let tags = self.cursor.count(INT)?;
                self.element_2(kind, tags, None)?;
                self.cursor.rest_of_line();
                number += 1;
                continue;
            }
            let kind = self.cursor.count(INT)?;
            let elements = self.cursor.count(INT)?;
            let tags = self.cursor.count(INT)?;
            let nodes = nodes_of(kind)?;
            if elements == 0 || elements > count - number {
                return Err(Fault::NotACount { count: elements.to_string() }.into());
            }
            for _ in 0..elements {
                self.begin("element", number);
                self.cursor.skip(1, INT)?;
                self.element_2(kind, tags, Some(nodes))?;
                number += 1;
            }
        }
        Ok(())
    }

    /// Tags, the first of which is the physical group, and nodes, so many if the number is known.
    fn element_2(&mut self, kind: usize, tags: usize, nodes: Option<usize>) -> Result<(), Stop> {
        // The sign is that of the surface's side.
        let group = if tags > 0 { (self.cursor.value(INT)? as i64).saturating_abs() } else { 0 };
        self.cursor.skip(tags.saturating_sub(1), INT)?;
        let corners = corners_of(kind);
        if corners > 0 {
            self.face(corners, INT, Some(group).filter(|&group| group != 0))?;
            self.join_with_last();
        }
        self.cursor.skip(nodes.map_or(0, |nodes| nodes - corners), INT)
    }

    fn face(&mut self, corners: usize, kind: Type, region: Option<i64>) -> Result<(), Stop> {
        if let Some(region) = region {
            self.regions.marks.push((self.polygons.ends.len(), region));
        }
        for _ in 0..corners {
            let tag = self.cursor.value(kind)?;
            self.polygons.corners.push(self.nodes.vertex(tag)?);
        }
        Ok(self.polygons.end_face()?)
    }

    /// The physical groups of surfaces.
    fn entities(&mut self) -> Result<(), Stop> {
        let mut counts = [0; 4];
        for count in &mut counts {
            *count = self.cursor.count(SIZE)?;
        }
        for (dimension, count) in counts.into_iter().enumerate() {
            for number in 0..count {
                self.begin(["point", "curve", "surface", "volume"][dimension], number);
                let tag = self.cursor.value(INT)? as i64;
                // The place of a point, or the corners of a box.
                self.cursor.skip(if dimension == 0 { 3 } else { 6 }, Type::F64)?;
                let mut groups = Vec::new();
                for _ in 0..self.cursor.count(SIZE)? {
                    // The sign is that of the surface's side.
                    groups.push((self.cursor.value(INT)? as i64).saturating_abs());
                }
                if dimension > 0 {
                    let boundary = self.cursor.count(SIZE)?;
                    self.cursor.skip(boundary, INT)?;
                }
                if let Some(group) =
                    groups.into_iter().reduce(|all, group| self.joined(all, group)).filter(|_| dimension == 2)
                {
                    self.groups.insert(tag, group);
                }
            }
        }
        Ok(())
    }

    /// The number of the region that is in two groups. Its name is those of both; it is negative, as no group's is.
    fn joined(&mut self, first: i64, second: i64) -> i64 {
        let next = -1 - self.joined.len() as i64;
        *self.joined.entry((first, second)).or_insert_with(|| {
            let names = &mut self.regions.names;
            let name = |group: i64| names.get(&group).cloned().unwrap_or_else(|| format!("{ATTRIBUTE}_{group}"));
            let name = format!("{} {}", name(first), name(second));
            names.insert(next, name);
            next
        })
    }

    /// A face in two groups is written twice, one after the other; here it is one face, in both.
    fn join_with_last(&mut self) {
        let polygons = &mut self.polygons;
        let starts = |back: usize| polygons.ends.len().checked_sub(back).map_or(0, |face| polygons.ends[face] as usize);
        let (last, before) = (starts(2), starts(3));
        let is_same = polygons.ends.len() > 1 && polygons.corners[before..last] == polygons.corners[last..];
        let marks = &mut self.regions.marks;
        if let (true, &[.., (face, first), (second_face, second)]) = (is_same, &marks[..])
            && face + 1 == second_face
            && second_face + 1 == polygons.ends.len()
        {
            polygons.ends.pop();
            polygons.corners.truncate(last);
            marks.truncate(marks.len() - 2);
            let region = self.joined(first, second);
            self.regions.marks.push((face, region));
        }
    }

    /// Blocks, one an entity: all tags, then all places, with parameters on the entity if it says so.
    fn nodes_4(&mut self) -> Result<(), Stop> {
        let blocks = self.cursor.count(SIZE)?;
        self.cursor.skip(3, SIZE)?;
        for block in 0..blocks {
            self.begin("block of nodes", block);
            let dimension = self.cursor.count(INT)?;
            self.cursor.skip(1, INT)?;
            let parameters = if self.cursor.count(INT)? == 0 { 0 } else { dimension };
            let count = self.cursor.count(SIZE)?;
            let mut tags = Vec::new();
            for _ in 0..count {
                tags.push(self.cursor.value(SIZE)?);
            }
            for tag in tags {
                self.begin("node", self.polygons.points.len());
                let point = self.point()?;
                self.cursor.skip(parameters, Type::F64)?;
                self.node(tag, point);
            }
        }
        Ok(())
    }

    /// Blocks, one an entity and type.
    fn elements_4(&mut self) -> Result<(), Stop> {
        let blocks = self.cursor.count(SIZE)?;
        self.cursor.skip(3, SIZE)?;
        let mut number = 0;
        for block in 0..blocks {
            self.begin("block of elements", block);
            let dimension = self.cursor.count(INT)?;
            let entity = self.cursor.value(INT)? as i64;
            let kind = self.cursor.count(INT)?;
            let count = self.cursor.count(SIZE)?;
            let (corners, nodes) = (corners_of(kind), nodes_of(kind)?);
            let region = self.groups.get(&entity).copied().filter(|_| dimension == 2);
            if corners == 0 {
                let numbers = count.checked_mul(nodes + 1).ok_or(Stop::End)?;
                self.cursor.skip(numbers, SIZE)?;
                number += count;
                continue;
            }
            for _ in 0..count {
                self.begin("element", number);
                self.cursor.skip(1, SIZE)?;
                self.face(corners, SIZE, region)?;
                self.cursor.skip(nodes - corners, SIZE)?;
                number += 1;
            }
        }
        Ok(())
    }
}

/// What the number of a group without a name is called.
const ATTRIBUTE: &str = "physical";

/// The types of the numbers of MSH, where they are binary: those of 2.2 and tags of entities, and those of 4.1.
const INT: Type = Type::I32;
const SIZE: Type = Type::U64;

fn wrong_word(word: &[u8], wanted: &str) -> Stop {
    Fault::WrongWord { word: shown(word), wanted: wanted.to_owned() }.into()
}

fn unsupported_version(version: &str) -> Fault {
    let what = format!("version {version:?} of MSH");
    Fault::Unsupported { what, remedy: "write it as 4.1 or 2.2 (gmsh -format msh41)" }
}

/// The number of corners of a face of a type of element; 0 for points, lines and volumes.
fn corners_of(kind: usize) -> usize {
    match kind {
        2 | 9 | 20..=25 => 3,
        3 | 10 | 16 | 36..=38 => 4,
        _ => 0,
    }
}

/// The number of nodes of an element of a type.
fn nodes_of(kind: usize) -> Result<usize, Fault> {
    /// From type 1 on.
    const NODES: [usize; 31] =
        [2, 3, 4, 4, 8, 6, 5, 3, 6, 9, 10, 27, 18, 14, 1, 8, 20, 15, 13, 9, 10, 12, 15, 15, 21, 4, 5, 6, 20, 35, 56];
    match kind {
        1..=31 => Ok(NODES[kind - 1]),
        36 => Ok(16),
        37 => Ok(25),
        38 => Ok(36),
        92 => Ok(64),
        93 => Ok(125),
        _ => {
            let what = format!("an element of type {kind}");
            Err(Fault::Unsupported { what, remedy: "write the mesh with elements of the first or second order" })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_are_found_by_their_tags() {
        let nodes = |tags: &[u64]| {
            let mut nodes = Nodes::default();
            tags.iter().for_each(|&tag| nodes.push(tag));
            nodes
        };
        let plain = nodes(&[1, 2, 3]);
        assert!(plain.by_tag.is_empty());
        assert_eq!([plain.vertex(1.0), plain.vertex(3.0)], [Ok(0), Ok(2)]);
        for tag in [0.0, 4.0, 1.5, -1.0, f64::NAN] {
            assert!(plain.vertex(tag).is_err(), "{tag}");
        }
        let odd = nodes(&[1, 2, 70, 3]);
        assert_eq!([odd.vertex(2.0), odd.vertex(70.0), odd.vertex(3.0)], [Ok(1), Ok(2), Ok(3)]);
        assert!(odd.vertex(4.0).is_err() && odd.vertex(70.5).is_err());
    }

    #[test]
    fn a_face_has_no_more_corners_than_nodes() {
        for kind in (0..200).filter(|&kind| corners_of(kind) > 0) {
            assert!(nodes_of(kind).expect("it is known") >= corners_of(kind), "{kind}");
        }
    }
}
