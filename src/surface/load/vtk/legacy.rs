//! VTK legacy files, ASCII and binary (big-endian): poly data and unstructured grids.

use super::super::cursor::{Cursor, Encoding, Nowhere, Stop, Type};
use super::super::text::{parsed, shown};
use super::super::{Fault, LoadError, Polygons};
use super::{
    Cells, Faces, LINE, POLYGON, PointArray, RegionArray, STRIP, VERTEX, attribute_kind, attributes, is_normals,
    named_region,
};
use crate::surface::attributes::AttributeKind;
use rustc_hash::FxHashMap;

const MAGIC: &[u8] = b"# vtk DataFile";

pub fn recognises(bytes: &[u8]) -> bool {
    bytes.get(..MAGIC.len()).is_some_and(|first| first.eq_ignore_ascii_case(MAGIC))
}

pub fn parse(bytes: &[u8], file: &str) -> Result<Polygons, LoadError> {
    let mut reader = Reader {
        cursor: Cursor::new(bytes),
        encoding: Encoding::Ascii,
        record: ("section", 0, 0),
        section: "the header".to_owned(),
        points: Vec::new(),
        nowhere: Nowhere::default(),
        parts: Default::default(),
        cells: Cells::default(),
        kinds: Vec::new(),
        attributes: None,
        region: None,
        names: FxHashMap::default(),
        arrays: Vec::new(),
        left_out: Vec::new(),
    };
    reader.read().map_err(|stop| match stop {
        Stop::End => LoadError::EndsWithin { file: file.to_owned(), section: reader.section.clone() },
        Stop::Fault(fault) => {
            let (kind, number, at) = reader.record;
            Cursor { at, encoding: reader.encoding, ..reader.cursor }.error(file, kind, number, fault)
        }
    })?;
    let mut faces = Faces::default();
    faces.polygons.points = reader.points;
    if reader.kinds.len() < reader.cells.ends.len() {
        let (what, said, found) = ("types of cells".to_owned(), reader.cells.ends.len(), reader.kinds.len());
        return Err(LoadError::CutOff { file: file.to_owned(), what, said, found });
    }
    for (part, kind) in reader.parts.iter().zip([VERTEX, LINE, POLYGON, STRIP]) {
        faces.add(file, part, std::iter::repeat(kind))?;
    }
    faces.add(file, &reader.cells, reader.kinds.into_iter())?;
    let points = faces.polygons.points.len();
    let mut polygons = faces.finish(file, reader.region, reader.names)?;
    polygons.attributes = attributes(reader.arrays, reader.left_out, points);
    match reader.nowhere.error(&polygons, file, "point") {
        Some(error) => Err(error),
        None => Ok(polygons),
    }
}

struct Reader<'a> {
    cursor: Cursor<'a>,
    /// How numbers are written.
    encoding: Encoding,
    /// The kind, the number and the place of what is being read.
    record: (&'static str, usize, usize),
    section: String,
    points: Vec<[f64; 3]>,
    nowhere: Nowhere<'a>,
    /// Of poly data, the cells that are points, lines, polygons and strips.
    parts: [Cells; 4],
    /// Of a grid, the cells and their types.
    cells: Cells,
    kinds: Vec<u8>,
    /// Whether arrays are those of cells, and how many tuples they have; none before the first section of them.
    attributes: Option<(bool, usize)>,
    region: Option<RegionArray>,
    /// The names of regions by their numbers.
    names: FxHashMap<i64, String>,
    /// Arrays of points.
    arrays: Vec<PointArray>,
    /// The names of other arrays of points and cells.
    left_out: Vec<String>,
}

impl<'a> Reader<'a> {
    fn read(&mut self) -> Result<(), Stop> {
        self.cursor.rest_of_line();
        self.cursor.rest_of_line();
        let encoding = self.cursor.word()?;
        self.encoding = match &encoding.to_ascii_uppercase()[..] {
            b"ASCII" => Encoding::Ascii,
            b"BINARY" => Encoding::BigEndian,
            _ => return Err(wrong_word(encoding, "ASCII or BINARY")),
        };
        let mut sections = 0;
        while let Ok(word) = self.cursor.word() {
            self.record = ("section", sections, self.cursor.at - word.len());
            self.section = shown(word);
            self.keyword(word)?;
            sections += 1;
        }
        Ok(())
    }

    fn keyword(&mut self, word: &'a [u8]) -> Result<(), Stop> {
        match &word.to_ascii_uppercase()[..] {
            b"DATASET" => self.data_set()?,
            b"POINTS" => self.read_points()?,
            b"VERTICES" => self.parts[0] = self.read_cells()?,
            b"LINES" => self.parts[1] = self.read_cells()?,
            b"POLYGONS" => self.parts[2] = self.read_cells()?,
            b"TRIANGLE_STRIPS" => self.parts[3] = self.read_cells()?,
            b"CELLS" => self.cells = self.read_cells()?,
            b"CELL_TYPES" => {
                let count = self.count()?;
                self.begin_data();
                self.kinds = self.numbers(count, Type::I32)?.into_iter().map(|kind| kind as u8).collect();
            }
            b"CELL_DATA" => self.attributes = Some((true, self.count()?)),
            b"POINT_DATA" => self.attributes = Some((false, self.count()?)),
            b"FIELD" => self.field()?,
            b"METADATA" => self.metadata(),
            b"SCALARS" => {
                let name = self.name()?;
                let kind = self.kind()?;
                let rest = self.cursor.rest_of_line();
                let components = parsed(rest).unwrap_or(1);
                let ahead = self.cursor;
                if self.cursor.word()?.eq_ignore_ascii_case(b"LOOKUP_TABLE") {
                    self.cursor.rest_of_line();
                } else {
                    self.cursor = ahead;
                }
                self.array(&name, kind, components, self.tuples())?;
            }
            b"COLOR_SCALARS" => {
                let name = self.name()?;
                let components = self.count()?;
                self.begin_data();
                // In text they are real, from 0 to 1.
                let kind = if self.encoding == Encoding::Ascii { Type::F32 } else { Type::U8 };
                let meaning = matches!(components, 3 | 4).then_some(AttributeKind::Colour);
                self.array_of(&name, Kind::Number(kind), components, self.tuples(), meaning)?;
            }
            b"LOOKUP_TABLE" => {
                self.name()?;
                let size = self.count()?;
                self.begin_data();
                self.skip(size.checked_mul(4).ok_or(Stop::End)?, Type::U8)?;
            }
            b"TEXTURE_COORDINATES" => {
                let name = self.name()?;
                let components = self.count()?;
                let kind = self.kind()?;
                self.begin_data();
                let meaning = (components > 1).then_some(AttributeKind::Texture);
                self.array_of(&name, kind, components, self.tuples(), meaning)?;
            }
            keyword @ (b"VECTORS" | b"NORMALS" | b"TENSORS" | b"TENSORS6" | b"GLOBAL_IDS" | b"PEDIGREE_IDS"
            | b"EDGE_FLAGS") => {
                let components = match keyword {
                    b"VECTORS" | b"NORMALS" => 3,
                    b"TENSORS" => 9,
                    b"TENSORS6" => 6,
                    _ => 1,
                };
                let mut name = self.name()?;
                if keyword == b"NORMALS" {
                    name = "normals".to_owned();
                }
                let kind = self.kind()?;
                self.begin_data();
                self.array(&name, kind, components, self.tuples())?;
            }
            _ => return Err(wrong_word(word, "a section such as POINTS, CELLS or CELL_DATA")),
        }
        Ok(())
    }

    fn data_set(&mut self) -> Result<(), Stop> {
        let kind = self.cursor.word()?;
        if [&b"POLYDATA"[..], b"UNSTRUCTURED_GRID"].iter().any(|read| kind.eq_ignore_ascii_case(read)) {
            return Ok(());
        }
        let what = format!("the VTK data set {:?}", shown(kind));
        Err(Fault::Unsupported { what, remedy: "extract its surface in ParaView and save it as VTP or VTU" }.into())
    }

    fn read_points(&mut self) -> Result<(), Stop> {
        let count = self.count()?;
        let kind = self.number_kind()?;
        self.begin_data();
        self.cursor.encoding = self.encoding;
        for point in 0..count {
            self.record = ("point", point, self.cursor.at);
            let place = [self.cursor.value(kind)?, self.cursor.value(kind)?, self.cursor.value(kind)?];
            self.nowhere.note(point, place, || Cursor { at: self.record.2, ..self.cursor });
            self.points.push(place);
        }
        self.cursor.encoding = Encoding::Ascii;
        Ok(())
    }

    /// Before version 5 each cell has its number of vertices before these; since then, all ends come first.
    fn read_cells(&mut self) -> Result<Cells, Stop> {
        let cells = self.count()?;
        let numbers = self.count()?;
        self.begin_data();
        let ahead = self.cursor;
        if self.encoding == Encoding::Ascii {
            self.cursor.skip_blanks();
        }
        let is_new = self.cursor.rest().starts_with(b"OFFSETS");
        self.cursor = ahead;
        if is_new {
            self.cursor.word()?;
            let kind = self.number_kind()?;
            self.begin_data();
            let ends = self.numbers(cells, kind)?;
            match self.cursor.word()? {
                b"CONNECTIVITY" => {}
                word => return Err(wrong_word(word, "CONNECTIVITY")),
            }
            let kind = self.number_kind()?;
            self.begin_data();
            let corners = self.vertices(numbers, kind)?;
            // The first number is 0, where the first cell begins.
            return Ok(Cells::new(corners, ends.get(1..).unwrap_or_default())?);
        }
        let mut read = Cells::default();
        self.cursor.encoding = self.encoding;
        for cell in 0..cells {
            self.record = ("cell", cell, self.cursor.at);
            for _ in 0..self.cursor.count(Type::I32)? {
                read.corners.push(self.cursor.vertex(Type::I32, self.points.len())?);
            }
            read.ends.push(read.corners.len());
        }
        self.cursor.encoding = Encoding::Ascii;
        Ok(read)
    }

    fn vertices(&mut self, count: usize, kind: Type) -> Result<Vec<u32>, Stop> {
        let mut vertices = Vec::new();
        self.cursor.encoding = self.encoding;
        for number in 0..count {
            self.record = ("corner", number, self.cursor.at);
            vertices.push(self.cursor.vertex(kind, self.points.len())?);
        }
        self.cursor.encoding = Encoding::Ascii;
        Ok(vertices)
    }

    fn numbers(&mut self, count: usize, kind: Type) -> Result<Vec<f64>, Stop> {
        let mut numbers = Vec::new();
        self.cursor.encoding = self.encoding;
        for number in 0..count {
            self.record = ("number", number, self.cursor.at);
            numbers.push(self.cursor.value(kind)?);
        }
        self.cursor.encoding = Encoding::Ascii;
        Ok(numbers)
    }

    fn field(&mut self) -> Result<(), Stop> {
        self.name()?;
        for _ in 0..self.count()? {
            let mut name = self.name()?;
            if name == "METADATA" {
                self.metadata();
                name = self.name()?;
            }
            let (components, tuples) = (self.count()?, self.count()?);
            let kind = self.kind()?;
            match kind {
                Kind::Text => {
                    self.cursor.rest_of_line();
                }
                Kind::Number(_) | Kind::Bits => self.begin_data(),
            }
            self.array(&name, kind, components, tuples)?;
        }
        Ok(())
    }

    /// Goes past the lines up to an empty one.
    fn metadata(&mut self) {
        self.cursor.rest_of_line();
        while !self.cursor.rest().is_empty() && !self.cursor.rest_of_line().is_empty() {}
    }

    /// Reads an array, or passes it over.
    fn array(&mut self, name: &str, kind: Kind, components: usize, tuples: usize) -> Result<(), Stop> {
        self.array_of(name, kind, components, tuples, None)
    }

    /// As [`Reader::array`]; of points, it has this meaning, if one is given.
    fn array_of(
        &mut self,
        name: &str,
        kind: Kind,
        components: usize,
        tuples: usize,
        meaning: Option<AttributeKind>,
    ) -> Result<(), Stop> {
        self.record = ("array", 0, self.cursor.at);
        let count = components.checked_mul(tuples).ok_or(Stop::End)?;
        let kind = match kind {
            Kind::Number(kind) => kind,
            Kind::Bits if self.encoding == Encoding::Ascii => Type::U8,
            Kind::Bits => return self.skip(count.div_ceil(8), Type::U8),
            Kind::Text => return self.skip_strings(count),
        };
        if self.attributes.is_none() && kind.is_integer() && count == 2 {
            if let Some(region) = named_region(&self.numbers(count, kind)?) {
                self.names.insert(region, name.to_owned());
            }
            return Ok(());
        }
        let of_cells = matches!(self.attributes, Some((true, _)));
        match RegionArray::rank(name, kind, components).filter(|_| of_cells) {
            Some(rank) if self.region.as_ref().is_none_or(|known| rank < known.rank) => {
                let numbers = self.numbers(count, kind)?;
                self.region = Some(RegionArray { rank, name: name.to_owned(), numbers });
                Ok(())
            }
            _ if of_cells || self.attributes.is_none() || is_normals(name) => {
                if of_cells {
                    self.left_out.push(format!("{name} of cells"));
                }
                self.skip(count, kind)
            }
            _ => match meaning.or_else(|| attribute_kind(name, kind, components)) {
                Some(meaning) if components > 0 && tuples == self.points.len() => {
                    let mut numbers = self.numbers(count, kind)?;
                    if meaning == AttributeKind::Colour {
                        numbers.iter_mut().for_each(|number| *number /= kind.full());
                    }
                    self.arrays.push(PointArray { name: name.to_owned(), kind: meaning, components, numbers });
                    Ok(())
                }
                _ => {
                    self.left_out.push(name.to_owned());
                    self.skip(count, kind)
                }
            },
        }
    }

    fn skip(&mut self, count: usize, kind: Type) -> Result<(), Stop> {
        self.cursor.encoding = self.encoding;
        self.cursor.skip(count, kind)?;
        self.cursor.encoding = Encoding::Ascii;
        Ok(())
    }

    /// Strings: in text a line each; in binary after their length, whose size the first two bits tell.
    fn skip_strings(&mut self, count: usize) -> Result<(), Stop> {
        for _ in 0..count {
            let rest = self.cursor.rest();
            let &first = rest.first().ok_or(Stop::End)?;
            if self.encoding == Encoding::Ascii {
                self.cursor.rest_of_line();
                continue;
            }
            let size = 1 << (3 - (first >> 6));
            let bytes = rest.get(1..size).ok_or(Stop::End)?;
            let length = bytes.iter().fold(u64::from(first & 0x3F), |sum, &byte| sum << 8 | u64::from(byte));
            let end = usize::try_from(length).ok().and_then(|length| size.checked_add(length));
            self.cursor.at += end.filter(|&end| end <= rest.len()).ok_or(Stop::End)?;
        }
        Ok(())
    }

    /// In binary files numbers begin on the line after those that tell what they are.
    fn begin_data(&mut self) {
        if self.encoding != Encoding::Ascii {
            self.cursor.rest_of_line();
        }
    }

    fn count(&mut self) -> Result<usize, Stop> {
        self.cursor.count(Type::I32)
    }

    fn name(&mut self) -> Result<String, Stop> {
        self.cursor.word().map(decoded)
    }

    fn tuples(&self) -> usize {
        self.attributes.map_or(0, |(_, tuples)| tuples)
    }

    fn number_kind(&mut self) -> Result<Type, Stop> {
        match self.kind()? {
            Kind::Number(kind) => Ok(kind),
            Kind::Bits | Kind::Text => Err(wrong_word(b"bit or string", "a type of numbers")),
        }
    }

    fn kind(&mut self) -> Result<Kind, Stop> {
        let word = self.cursor.word()?;
        let kind = match &word.to_ascii_lowercase()[..] {
            b"bit" => return Ok(Kind::Bits),
            b"string" => return Ok(Kind::Text),
            b"char" | b"signed_char" => Type::I8,
            b"unsigned_char" => Type::U8,
            b"short" => Type::I16,
            b"unsigned_short" => Type::U16,
            // VTK writes its type of indices as 32 bits here.
            b"int" | b"vtkidtype" => Type::I32,
            b"unsigned_int" => Type::U32,
            b"long" | b"vtktypeint64" | b"long_long" => Type::I64,
            b"unsigned_long" | b"vtktypeuint64" | b"unsigned_long_long" => Type::U64,
            b"float" => Type::F32,
            b"double" => Type::F64,
            _ => return Err(wrong_word(word, "a type such as int, float or double")),
        };
        Ok(Kind::Number(kind))
    }
}

/// The type of an array.
#[derive(Clone, Copy)]
enum Kind {
    Number(Type),
    /// Eight a byte.
    Bits,
    Text,
}

fn wrong_word(word: &[u8], wanted: &str) -> Stop {
    Fault::WrongWord { word: shown(word), wanted: wanted.to_owned() }.into()
}

/// A name or string of a text, in which `%20` is a blank and so on.
fn decoded(word: &[u8]) -> String {
    let mut bytes = Vec::with_capacity(word.len());
    let mut rest = word;
    while let Some((&byte, after)) = rest.split_first() {
        let code = after
            .get(..2)
            .filter(|_| byte == b'%')
            .and_then(|code| u8::from_str_radix(std::str::from_utf8(code).ok()?, 16).ok());
        bytes.push(code.unwrap_or(byte));
        rest = if code.is_some() { &after[2..] } else { after };
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

#[cfg(test)]
mod tests {
    use super::decoded;

    #[test]
    fn codes_in_names_are_characters() {
        assert_eq!(decoded(b"upper%20skin%25"), "upper skin%");
        assert_eq!(decoded(b"5% %2 %zz %"), "5% %2 %zz %");
        assert_eq!(decoded(b"Fl%C3%BCgel"), "Fl\u{fc}gel");
    }
}
