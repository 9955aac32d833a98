//! VTU and VTP, the XML files of VTK: arrays in ASCII, base64 or appended, plain or compressed by zlib.
//!
//! The elements are listed first; then the arrays that a surface needs are read. A raw appended section is no XML and is not
//! looked at by the XML reader.

use super::super::cursor::{Cursor, Stop, Type, vertex};
use super::super::text::{parsed, shown};
use super::super::{Fault, LoadError, Place, Polygons};
use super::payload::{self, Coding, Source};
use super::{
    Cells, Faces, LINE, POLYGON, PointArray, RegionArray, STRIP, VERTEX, attribute_kind, attributes, is_normals,
    named_region,
};
use crate::surface::attributes::AttributeKind;
use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader, XmlVersion};
use rustc_hash::FxHashMap;

/// The data set of a file: `UnstructuredGrid` is VTU, `PolyData` VTP.
pub fn data_set(bytes: &[u8]) -> Option<String> {
    let is_xml = bytes.trim_ascii_start().starts_with(b"<");
    let mut reader = Reader::from_reader(if is_xml { bytes } else { b"" });
    for _ in 0..16 {
        match reader.read_event().ok()? {
            Event::Start(element) if element.name().as_ref() == "VTKFile" => return attribute(&element, "type"),
            Event::Start(_) | Event::Eof => return None,
            _ => {}
        }
    }
    None
}

pub fn parse(bytes: &[u8], file: &str) -> Result<Polygons, LoadError> {
    let document = Document::parse(bytes).map_err(|(at, stop)| match stop {
        Stop::End => LoadError::EndsWithin { file: file.to_owned(), section: "the element VTKFile".to_owned() },
        Stop::Fault(fault) => LoadError::at_line(file, bytes, line_of(bytes, at), fault),
    })?;
    let at = |array: &Array, fault| LoadError::at_line(file, bytes, line_of(bytes, array.at), fault);
    let mut faces = Faces::default();
    let mut region: Option<RegionArray> = None;
    let mut names = FxHashMap::default();
    let (mut point_arrays, mut left_out): (Vec<PointArray>, Vec<String>) = Default::default();
    for array in document.arrays.iter().filter(|array| array.section == "FieldData" && array.is_integer()) {
        if let Some(region) = named_region(&document.numbers(array).map_err(|fault| at(array, fault))?) {
            names.insert(region, array.name.clone());
        }
    }
    for piece in 0..document.pieces {
        let arrays = || document.arrays.iter().filter(|array| array.piece == Some(piece));
        let find = |section: &str, name: &str| arrays().find(|array| array.section == section && array.name == name);
        let numbers = |array: &Array| document.numbers(array).map_err(|fault| at(array, fault));
        let Some(places) = arrays().find(|array| array.section == "Points") else { continue };
        let coordinates = numbers(places)?;
        let first = faces.polygons.points.len();
        faces.polygons.points.extend(coordinates.as_chunks::<3>().0);
        let points = faces.polygons.points.len() - first;
        for array in arrays().filter(|array| array.section == "PointData" && !is_normals(&array.name)) {
            let (kind, components) = (array.kind.unwrap_or(Type::I8), array.components);
            let Some(meaning) = attribute_kind(&array.name, kind, components).filter(|_| components > 0) else {
                left_out.push(array.name.clone());
                continue;
            };
            let mut read = numbers(array)?;
            if meaning == AttributeKind::Colour {
                read.iter_mut().for_each(|number| *number /= kind.full());
            }
            read.resize(components * points, 0.0);
            let known =
                point_arrays.iter().position(|other| other.name == array.name && other.components == components);
            let known = known.unwrap_or_else(|| {
                let name = array.name.clone();
                point_arrays.push(PointArray { name, kind: meaning, components, numbers: Vec::new() });
                point_arrays.len() - 1
            });
            // Points of a piece without the array before this one.
            point_arrays[known].numbers.resize(components * first, 0.0);
            point_arrays[known].numbers.append(&mut read);
        }
        let sections = [("Verts", VERTEX), ("Lines", LINE), ("Polys", POLYGON), ("Strips", STRIP), ("Cells", 0)];
        let before = faces.cells;
        for (section, kind) in sections {
            let (Some(connectivity), Some(ends)) = (find(section, "connectivity"), find(section, "offsets")) else {
                continue;
            };
            let corner = |&number: &f64| vertex(number, points).map(|vertex| vertex + first as u32);
            let corners = numbers(connectivity)?.iter().map(corner).collect::<Result<_, _>>();
            let corners = corners.map_err(|fault| at(connectivity, fault))?;
            let cells = Cells::new(corners, &numbers(ends)?).map_err(|fault| at(ends, fault))?;
            if section != "Cells" {
                faces.add(file, &cells, std::iter::repeat(kind))?;
                continue;
            }
            let Some(kinds) = find(section, "types") else {
                return Err(at(ends, Fault::HeaderLacks { what: "the array types" }));
            };
            let kinds = numbers(kinds)?;
            if kinds.len() < cells.ends.len() {
                let (what, said, found) = ("types of cells".to_owned(), cells.ends.len(), kinds.len());
                return Err(LoadError::CutOff { file: file.to_owned(), what, said, found });
            }
            faces.add(file, &cells, kinds.iter().map(|&kind| kind as u8))?;
        }
        let of_cells = || arrays().filter(|array| array.section == "CellData");
        let chosen = of_cells().filter_map(|array| Some((array.rank()?, array))).min_by_key(|(rank, _)| *rank);
        let is_chosen = |array: &Array| chosen.is_some_and(|(_, chosen)| chosen.name == array.name);
        left_out.extend(of_cells().filter(|array| !is_chosen(array)).map(|array| format!("{} of cells", array.name)));
        if let Some((rank, array)) = chosen {
            let mut read = numbers(array)?;
            read.resize(faces.cells - before, f64::NAN);
            let region =
                region.get_or_insert_with(|| RegionArray { rank, name: array.name.clone(), numbers: Vec::new() });
            // Cells of a piece without the array before this one.
            region.numbers.resize(before, f64::NAN);
            region.numbers.append(&mut read);
        }
    }
    let points = faces.polygons.points.len();
    let mut polygons = faces.finish(file, region, names)?;
    polygons.attributes = attributes(point_arrays, left_out, points);
    if let Some(number) = polygons.nowhere() {
        let wrong = polygons.points[number].into_iter().find(|coordinate| !coordinate.is_finite()).unwrap_or_default();
        let (place, fault) = (Place::Item { kind: "point", number }, Fault::NotFinite { word: wrong.to_string() });
        return Err(LoadError::At { file: file.to_owned(), place, fault, unended: false });
    }
    Ok(polygons)
}

fn line_of(bytes: &[u8], at: usize) -> usize {
    1 + bytes[..at.min(bytes.len())].iter().filter(|&&byte| byte == b'\n').count()
}

fn attribute(element: &BytesStart, name: &str) -> Option<String> {
    let found = element.attributes().flatten().find(|attribute| attribute.key.as_ref() == name)?;
    Some(found.normalized_value(XmlVersion::Implicit1_0).unwrap_or(found.value.clone()).into_owned())
}

/// An array as the elements describe it.
struct Array<'a> {
    /// The piece it is in, if it is in one.
    piece: Option<usize>,
    section: String,
    name: String,
    /// `None` for strings and whatever else is no number.
    kind: Option<Type>,
    components: usize,
    format: Format,
    /// What is written in the element.
    text: &'a [u8],
    /// Where the element begins.
    at: usize,
}

enum Format {
    Ascii,
    Binary,
    Appended(usize),
}

impl Array<'_> {
    fn is_integer(&self) -> bool {
        self.kind.is_some_and(Type::is_integer)
    }

    fn rank(&self) -> Option<usize> {
        RegionArray::rank(&self.name, self.kind?, self.components)
    }
}

struct Document<'a> {
    coding: Coding,
    pieces: usize,
    arrays: Vec<Array<'a>>,
    /// What arrays with an offset are appended to.
    appended: Option<Source<'a>>,
}

impl<'a> Document<'a> {
    /// The arrays, or why there are none and where.
    fn parse(bytes: &'a [u8]) -> Result<Self, (usize, Stop)> {
        let mut reader = Reader::from_reader(bytes);
        let coding = Coding { size: 4, is_big_endian: false, is_compressed: false };
        let mut document = Self { coding, pieces: 0, arrays: Vec::new(), appended: None };
        let (mut section, mut in_piece) = (String::new(), false);
        loop {
            let at = reader.buffer_position() as usize;
            let event =
                reader.read_event().map_err(|error| (at, Fault::NotXml { reason: error.to_string() }.into()))?;
            let after = reader.buffer_position() as usize;
            let (element, is_empty) = match event {
                Event::Start(element) => (element, false),
                Event::Empty(element) => (element, true),
                Event::End(element) => {
                    match element.name().as_ref() {
                        "Piece" => in_piece = false,
                        "VTKFile" => return Ok(document),
                        _ => {}
                    }
                    continue;
                }
                Event::Eof => return Err((at, Stop::End)),
                _ => continue,
            };
            match element.name().as_ref() {
                "VTKFile" => document.coding = coding_of(&element).map_err(|fault| (at, fault.into()))?,
                "Piece" => {
                    document.pieces += 1;
                    in_piece = true;
                }
                "DataArray" | "Array" => {
                    let end = bytes[after..]
                        .iter()
                        .position(|&byte| byte == b'<')
                        .map_or(bytes.len(), |length| after + length);
                    let text = if is_empty { b"" } else { &bytes[after..end] };
                    let piece = in_piece.then(|| document.pieces - 1);
                    let array = array_of(&element, text, at, piece, &section).map_err(|fault| (at, fault.into()))?;
                    document.arrays.push(array);
                }
                "AppendedData" => {
                    let rest = &bytes[after..];
                    let begin = rest.iter().position(|&byte| byte == b'_').ok_or((at, Stop::End))?;
                    let rest = &rest[begin + 1..];
                    let is_raw = attribute(&element, "encoding").is_none_or(|encoding| encoding == "raw");
                    document.appended = Some(if is_raw { Source::Raw(rest) } else { Source::Base64(rest) });
                    return Ok(document);
                }
                name => section = name.to_owned(),
            }
        }
    }

    /// The bytes of an array that is not in ASCII.
    fn bytes(&self, array: &Array<'a>) -> Result<Vec<u8>, Fault> {
        let bytes = match (&array.format, self.appended) {
            (Format::Appended(offset), Some(Source::Raw(all))) => {
                payload::bytes(Source::Raw(all.get(*offset..).ok_or(Fault::ShortArray)?), self.coding)
            }
            (Format::Appended(offset), Some(Source::Base64(all))) => {
                payload::bytes(Source::Base64(all.get(*offset..).ok_or(Fault::ShortArray)?), self.coding)
            }
            (Format::Appended(_), None) => return Err(Fault::HeaderLacks { what: "the element AppendedData" }),
            _ => {
                let text: Vec<u8> = array.text.iter().copied().filter(|byte| !byte.is_ascii_whitespace()).collect();
                return Ok(payload::bytes(Source::Base64(&text), self.coding)?.into_owned());
            }
        };
        Ok(bytes?.into_owned())
    }

    /// The numbers of an array, each read as f64, which holds all whole numbers up to 9e15.
    fn numbers(&self, array: &Array<'a>) -> Result<Vec<f64>, Fault> {
        let kind = array.kind.ok_or(Fault::HeaderLacks { what: "a type of numbers for this array" })?;
        let bytes;
        let mut cursor = Cursor::new(array.text);
        if !matches!(array.format, Format::Ascii) {
            bytes = self.bytes(array)?;
            cursor = Cursor { encoding: super::encoding(self.coding.is_big_endian), ..Cursor::new(&bytes) };
        }
        let mut numbers = Vec::new();
        loop {
            match cursor.value(kind) {
                Ok(number) => numbers.push(number),
                Err(Stop::End) => return Ok(numbers),
                Err(Stop::Fault(fault)) => return Err(fault),
            }
        }
    }
}

fn coding_of(element: &BytesStart) -> Result<Coding, Fault> {
    let data_set = attribute(element, "type").unwrap_or_default();
    if !["UnstructuredGrid", "PolyData"].contains(&&*data_set) {
        let what = format!("the VTK data set {:?}", shown(data_set.as_bytes()));
        return Err(Fault::Unsupported { what, remedy: "extract its surface in ParaView and save it as VTP or VTU" });
    }
    let is = |name: &str, value: &str| attribute(element, name).is_some_and(|found| found == value);
    let compressor = attribute(element, "compressor").filter(|compressor| !compressor.is_empty());
    match compressor.as_deref() {
        None | Some("vtkZLibDataCompressor") => {}
        Some(other) => {
            let what = format!("data compressed by {:?}", shown(other.as_bytes()));
            return Err(Fault::Unsupported { what, remedy: "save the file with ZLib or without compression" });
        }
    }
    let size = if is("header_type", "UInt64") { 8 } else { 4 };
    Ok(Coding { size, is_big_endian: is("byte_order", "BigEndian"), is_compressed: compressor.is_some() })
}

fn array_of<'a>(
    element: &BytesStart,
    text: &'a [u8],
    at: usize,
    piece: Option<usize>,
    section: &str,
) -> Result<Array<'a>, Fault> {
    let number = |name: &str| {
        attribute(element, name)
            .map(|word| parsed(word.as_bytes()).ok_or(Fault::NotACount { count: shown(word.as_bytes()) }))
            .transpose()
    };
    let format = match attribute(element, "format").as_deref() {
        Some("binary") => Format::Binary,
        Some("appended") => Format::Appended(number("offset")?.unwrap_or(0)),
        _ => Format::Ascii,
    };
    let kind = match attribute(element, "type").as_deref() {
        Some("Int8") => Some(Type::I8),
        Some("UInt8") => Some(Type::U8),
        Some("Int16") => Some(Type::I16),
        Some("UInt16") => Some(Type::U16),
        Some("Int32") => Some(Type::I32),
        Some("UInt32") => Some(Type::U32),
        Some("Int64") => Some(Type::I64),
        Some("UInt64") => Some(Type::U64),
        Some("Float32") => Some(Type::F32),
        Some("Float64") => Some(Type::F64),
        _ => None,
    };
    let name = attribute(element, "Name").unwrap_or_default();
    let components = number("NumberOfComponents")?.unwrap_or(1);
    Ok(Array { piece, section: section.to_owned(), name, kind, components, format, text, at })
}
