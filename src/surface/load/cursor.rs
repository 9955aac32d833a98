//! Values of a file one after the other, written as text or as bytes of either order.

use super::text::{parsed, shown};
use super::{Fault, LoadError, Place, Polygons};

/// How values are written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// The type of a value. In text it does not matter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Type {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl Type {
    /// The bytes of a value.
    pub fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    /// The number that means the full intensity of a colour: 1 where it is real.
    pub fn full(self) -> f64 {
        match self {
            Self::I8 => i8::MAX.into(),
            Self::U8 => u8::MAX.into(),
            Self::I16 => i16::MAX.into(),
            Self::U16 => u16::MAX.into(),
            Self::I32 => i32::MAX.into(),
            Self::U32 => u32::MAX.into(),
            Self::I64 => i64::MAX as f64,
            Self::U64 => u64::MAX as f64,
            Self::F32 | Self::F64 => 1.0,
        }
    }

    pub fn is_integer(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
    }
}

/// Why a record cannot be read.
pub enum Stop {
    /// The file ends.
    End,
    Fault(Fault),
}

impl From<Fault> for Stop {
    fn from(fault: Fault) -> Self {
        Self::Fault(fault)
    }
}

/// A place in the data. Every value is read as f64, which holds all whole numbers up to 9e15.
#[derive(Clone, Copy)]
pub struct Cursor<'a> {
    pub bytes: &'a [u8],
    pub at: usize,
    /// The line, counted from 1, where the data is text.
    pub line: usize,
    pub encoding: Encoding,
}

impl<'a> Cursor<'a> {
    /// The beginning of a text.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0, line: 1, encoding: Encoding::Ascii }
    }

    /// What is left of the data.
    pub fn rest(&self) -> &'a [u8] {
        self.bytes.get(self.at..).unwrap_or_default()
    }

    /// Goes past blanks and line ends.
    pub fn skip_blanks(&mut self) {
        while let Some(byte) = self.rest().first().filter(|byte| byte.is_ascii_whitespace()) {
            self.line += usize::from(*byte == b'\n');
            self.at += 1;
        }
    }

    /// Goes past blanks and returns the next byte, which may be that of a line end.
    pub fn next_in_line(&mut self) -> Option<u8> {
        let blank = |byte: &u8| byte.is_ascii_whitespace() && *byte != b'\n';
        self.at += self.rest().iter().take_while(|byte| blank(byte)).count();
        self.rest().first().copied()
    }

    /// The rest of the line, without outer blanks; the next line is the next to be read.
    pub fn rest_of_line(&mut self) -> &'a [u8] {
        let rest = self.rest();
        let length = rest.iter().position(|&byte| byte == b'\n');
        self.at += length.map_or(rest.len(), |length| length + 1);
        self.line += usize::from(length.is_some());
        rest[..length.unwrap_or(rest.len())].trim_ascii()
    }

    /// The next word, on this line or one after it.
    pub fn word(&mut self) -> Result<&'a [u8], Stop> {
        self.skip_blanks();
        let rest = self.rest();
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        self.at += length;
        if length > 0 { Ok(&rest[..length]) } else { Err(Stop::End) }
    }

    /// The next value; that of a text may stand on a line after this one.
    pub fn value(&mut self, kind: Type) -> Result<f64, Stop> {
        if self.encoding == Encoding::Ascii {
            let word = self.word()?;
            return Ok(parsed(word).ok_or_else(|| Fault::NotAValue { word: shown(word) })?);
        }
        Ok(match kind {
            Type::I8 => i8::from_le_bytes(self.take()?).into(),
            Type::U8 => u8::from_le_bytes(self.take()?).into(),
            Type::I16 => i16::from_le_bytes(self.take()?).into(),
            Type::U16 => u16::from_le_bytes(self.take()?).into(),
            Type::I32 => i32::from_le_bytes(self.take()?).into(),
            Type::U32 => u32::from_le_bytes(self.take()?).into(),
            Type::I64 => i64::from_le_bytes(self.take()?) as f64,
            Type::U64 => u64::from_le_bytes(self.take()?) as f64,
            Type::F32 => f32::from_le_bytes(self.take()?).into(),
            Type::F64 => f64::from_le_bytes(self.take()?),
        })
    }

    /// The next value; where it is written as text, it must stand on this line.
    pub fn value_in_line(&mut self, kind: Type) -> Result<f64, Stop> {
        if self.encoding == Encoding::Ascii && self.next_in_line().ok_or(Stop::End)? == b'\n' {
            return Err(Fault::WrongRow { more: false }.into());
        }
        self.value(kind)
    }

    /// The next value as a whole number that is not negative, such as a count.
    pub fn count(&mut self, kind: Type) -> Result<usize, Stop> {
        let count = self.value(kind)?;
        if count < 0.0 || count.fract() != 0.0 {
            return Err(Fault::NotACount { count: count.to_string() }.into());
        }
        Ok(count as usize)
    }

    /// The next value as the number of one of so many vertices, counted from 0.
    pub fn vertex(&mut self, kind: Type, vertices: usize) -> Result<u32, Stop> {
        let index = self.value(kind)?;
        vertex(index, vertices).map_err(Stop::from)
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

    /// Goes past so many values.
    pub fn skip(&mut self, count: usize, kind: Type) -> Result<(), Stop> {
        if self.encoding == Encoding::Ascii {
            return (0..count).try_for_each(|_| self.word().map(drop));
        }
        let length = count.checked_mul(kind.bytes()).filter(|&length| length <= self.rest().len());
        self.at += length.ok_or(Stop::End)?;
        Ok(())
    }

    /// Reads so many records by `read`, which is told the number of each. `kind` is what one and many of them are called in errors.
    pub fn records(
        &mut self,
        file: &str,
        kind: [&str; 2],
        count: usize,
        mut read: impl FnMut(&mut Self, usize) -> Result<(), Stop>,
    ) -> Result<(), LoadError> {
        for number in 0..count {
            let start = *self;
            read(self, number).map_err(|stop| match stop {
                Stop::End => {
                    LoadError::CutOff { file: file.to_owned(), what: kind[1].to_owned(), said: count, found: number }
                }
                Stop::Fault(fault) => Self { line: self.line, ..start }.error(file, kind[0], number, fault),
            })?;
        }
        Ok(())
    }

    /// The error for a record that begins here.
    pub fn error(&self, file: &str, kind: &str, number: usize, fault: Fault) -> LoadError {
        if self.encoding == Encoding::Ascii {
            return LoadError::at_line(file, self.bytes, self.line, fault);
        }
        let place = Place::Record { kind: kind.to_owned(), number, byte: self.at };
        LoadError::At { file: file.to_owned(), place, fault, unended: false }
    }
}

/// A number as that of one of so many vertices, counted from 0.
pub fn vertex(index: f64, vertices: usize) -> Result<u32, Fault> {
    if (0.0..vertices as f64).contains(&index) && index.fract() == 0.0 {
        Ok(index as u32)
    } else {
        Err(Fault::NoSuchVertex { index, vertices })
    }
}

/// Vertices that have no place in space, each with where it is written. Only those that a face uses are wrong.
#[derive(Default)]
pub struct Nowhere<'a>(Vec<(usize, Cursor<'a>)>);

impl<'a> Nowhere<'a> {
    /// Notes a vertex that is not finite.
    pub fn note(&mut self, vertex: usize, point: [f64; 3], place: impl FnOnce() -> Cursor<'a>) {
        if !point.iter().all(|coordinate| coordinate.is_finite()) {
            self.0.push((vertex, place()));
        }
    }

    /// The error for the first vertex that a face uses. A vertex is called `kind`.
    pub fn error(&self, polygons: &Polygons, file: &str, kind: &str) -> Option<LoadError> {
        let vertex = polygons.nowhere()?;
        let (_, place) = self.0.iter().find(|wrong| wrong.0 == vertex)?;
        let wrong = polygons.points[vertex].into_iter().find(|coordinate| !coordinate.is_finite())?;
        Some(place.error(file, kind, vertex, Fault::NotFinite { word: wrong.to_string() }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TYPES: [Type; 10] =
        [Type::I8, Type::U8, Type::I16, Type::U16, Type::I32, Type::U32, Type::I64, Type::U64, Type::F32, Type::F64];

    fn little(kind: Type, number: i8) -> Vec<u8> {
        match kind {
            Type::F32 => f32::from(number).to_le_bytes().into(),
            Type::F64 => f64::from(number).to_le_bytes().into(),
            _ => i64::from(number).to_le_bytes()[..kind.bytes()].into(),
        }
    }

    #[test]
    fn values_are_the_same_in_every_encoding() {
        for kind in TYPES {
            let is_unsigned = matches!(kind, Type::U8 | Type::U16 | Type::U32 | Type::U64);
            for number in [0, 1, 127, if is_unsigned { 5 } else { -5 }] {
                let mut bytes = little(kind, number);
                let read = |bytes: &[u8], encoding| {
                    let mut cursor = Cursor { encoding, ..Cursor::new(bytes) };
                    let value = cursor.value(kind).ok();
                    (value, cursor.value(kind).is_err())
                };
                let wanted = (Some(f64::from(number)), true);
                assert_eq!(read(&bytes, Encoding::LittleEndian), wanted, "{kind:?}");
                assert_eq!(read(format!(" \n{number}\n").as_bytes(), Encoding::Ascii), wanted, "{kind:?}");
                bytes.reverse();
                assert_eq!(read(&bytes, Encoding::BigEndian), wanted, "{kind:?}");
                bytes.pop();
                assert_eq!(read(&bytes, Encoding::BigEndian).0, None, "{kind:?}");
            }
        }
    }

    #[test]
    fn lines_are_counted() {
        let mut cursor = Cursor::new(b"one two\n\n three\r\nfour");
        let mut word = || {
            let word = cursor.word().map(String::from_utf8_lossy).ok();
            (word.unwrap_or_default().into_owned(), cursor.line)
        };
        assert_eq!([word().1, word().1, word().1, word().1], [1, 1, 3, 4]);
        assert_eq!(word(), (String::new(), 4));
        let mut cursor = Cursor::new(b"one two \r\nthree");
        assert!(cursor.word().is_ok());
        assert_eq!((cursor.rest_of_line(), cursor.line), (&b"two"[..], 2));
        assert!(matches!(
            Cursor::new(b" \n3").value_in_line(Type::U8),
            Err(Stop::Fault(Fault::WrongRow { more: false }))
        ));
        assert!(matches!(Cursor::new(b" 3").value_in_line(Type::U8), Ok(3.0)));
    }

    #[test]
    fn counts_and_vertices_are_whole_numbers_in_range() {
        for (text, count, is_vertex) in [
            ("3", Some(3), true),
            ("4", Some(4), false),
            ("-1", None, false),
            ("0.5", None, false),
            ("nan", None, false),
        ] {
            assert_eq!(Cursor::new(text.as_bytes()).count(Type::I32).ok(), count, "{text}");
            assert_eq!(Cursor::new(text.as_bytes()).vertex(Type::I32, 4).is_ok(), is_vertex, "{text}");
        }
    }
}
