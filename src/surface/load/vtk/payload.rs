//! The bytes of an array of a VTK XML file: raw or base64, perhaps compressed by zlib, behind a header with their number.

use super::super::Fault;
use base64::Engine;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use flate2::read::ZlibDecoder;
use std::borrow::Cow;
use std::io::Read;

/// How the bytes of arrays are written in a file.
#[derive(Clone, Copy, Debug)]
pub struct Coding {
    /// The bytes of a number in the header: 4 or 8.
    pub size: usize,
    pub is_big_endian: bool,
    pub is_compressed: bool,
}

/// Bytes of a file, as they are or as base64.
#[derive(Clone, Copy, Debug)]
pub enum Source<'a> {
    Raw(&'a [u8]),
    Base64(&'a [u8]),
}

impl<'a> Source<'a> {
    /// The first bytes, and what follows them. In base64, what follows begins after padding, or else within the same run.
    fn split(self, count: usize) -> Option<(Cow<'a, [u8]>, Rest<'a>)> {
        match self {
            Self::Raw(bytes) => {
                let (first, rest) = bytes.split_at_checked(count)?;
                Some((Cow::Borrowed(first), Rest { skipped: 0, source: Self::Raw(rest) }))
            }
            Self::Base64(text) => {
                let length = count.div_ceil(3).checked_mul(4)?;
                let (run, after) = text.split_at_checked(length)?;
                let mut bytes = engine().decode(run).ok()?;
                // Padding, or nothing more in it, ends a run.
                let rest = if bytes.len() == count {
                    Rest { skipped: 0, source: Self::Base64(after) }
                } else {
                    Rest { skipped: count, source: self }
                };
                bytes.get(..count)?;
                bytes.truncate(count);
                Some((Cow::Owned(bytes), rest))
            }
        }
    }
}

/// What follows some bytes.
struct Rest<'a> {
    /// Bytes at the beginning that have been read.
    skipped: usize,
    source: Source<'a>,
}

impl<'a> Rest<'a> {
    fn take(self, count: usize) -> Option<Cow<'a, [u8]>> {
        let (bytes, _) = self.source.split(self.skipped.checked_add(count)?)?;
        Some(match bytes {
            Cow::Borrowed(bytes) => Cow::Borrowed(&bytes[self.skipped..]),
            Cow::Owned(mut bytes) => Cow::Owned(bytes.split_off(self.skipped)),
        })
    }
}

fn engine() -> GeneralPurpose {
    GeneralPurpose::new(&STANDARD, GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent))
}

/// The bytes of an array.
pub fn bytes(source: Source<'_>, coding: Coding) -> Result<Cow<'_, [u8]>, Fault> {
    let numbers = |bytes: &[u8]| -> Vec<u64> {
        bytes.chunks_exact(coding.size).map(|bytes| number(bytes, coding.is_big_endian)).collect()
    };
    let cut_off = || Fault::ShortArray;
    if !coding.is_compressed {
        let (header, rest) = source.split(coding.size).ok_or_else(cut_off)?;
        let length = numbers(&header)[0];
        return rest.take(usize::try_from(length).map_err(|_| cut_off())?).ok_or_else(cut_off);
    }
    // The numbers of blocks, of bytes in a block, and of bytes in the last; then the packed size of each.
    let (head, _) = source.split(3 * coding.size).ok_or_else(cut_off)?;
    let [blocks, block, _] = numbers(&head)[..] else { return Err(cut_off()) };
    let header = usize::try_from(blocks).ok().and_then(|blocks| blocks.checked_add(3)?.checked_mul(coding.size));
    let (header, rest) = source.split(header.ok_or_else(cut_off)?).ok_or_else(cut_off)?;
    let sizes = numbers(&header).split_off(3);
    let packed = sizes.iter().try_fold(0_usize, |sum, &size| sum.checked_add(usize::try_from(size).ok()?));
    let packed = rest.take(packed.ok_or_else(cut_off)?).ok_or_else(cut_off)?;
    let mut unpacked = Vec::new();
    let mut at = 0;
    for size in sizes {
        let end = at + size as usize;
        // No more than the header promises, so that damaged data cannot fill the memory.
        let mut stream = ZlibDecoder::new(&packed[at..end]).take(block);
        stream.read_to_end(&mut unpacked).map_err(|_| Fault::BadCompression)?;
        at = end;
    }
    Ok(Cow::Owned(unpacked))
}

fn number(bytes: &[u8], is_big_endian: bool) -> u64 {
    let add = |sum: u64, byte: &u8| sum << 8 | u64::from(*byte);
    if is_big_endian { bytes.iter().fold(0, add) } else { bytes.iter().rev().fold(0, add) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use base64::engine::general_purpose::STANDARD as BASE64;
    use flate2::Compression;
    use flate2::write::ZlibEncoder;
    use std::io::Write;

    fn packed(bytes: &[u8]) -> Vec<u8> {
        let mut packer = ZlibEncoder::new(Vec::new(), Compression::fast());
        packer.write_all(bytes).expect("a vector takes all");
        packer.finish().expect("a vector takes all")
    }

    fn header(numbers: &[u64], coding: Coding) -> Vec<u8> {
        let bytes = |number: &u64| match (coding.size, coding.is_big_endian) {
            (4, false) => (*number as u32).to_le_bytes().to_vec(),
            (4, true) => (*number as u32).to_be_bytes().to_vec(),
            (_, false) => number.to_le_bytes().to_vec(),
            (_, true) => number.to_be_bytes().to_vec(),
        };
        numbers.iter().flat_map(bytes).collect()
    }

    fn codings(is_compressed: bool) -> Vec<Coding> {
        let all = [(4, false), (4, true), (8, false), (8, true)];
        all.map(|(size, is_big_endian)| Coding { size, is_big_endian, is_compressed }).to_vec()
    }

    /// Header and data as raw bytes, in one run of base64, and in a run each.
    fn check(head: &[u8], data: &[u8], coding: Coding, wanted: &[u8]) {
        let raw = [head, data, b"more"].concat();
        assert_eq!(bytes(Source::Raw(&raw), coding).expect("it is whole"), wanted);
        let one = BASE64.encode([head, data].concat());
        assert_eq!(bytes(Source::Base64(one.as_bytes()), coding).expect("it is whole"), wanted);
        let two = BASE64.encode(head) + &BASE64.encode(data) + "AAAA";
        assert_eq!(bytes(Source::Base64(two.as_bytes()), coding).expect("it is whole"), wanted);
        for end in 0..head.len() + data.len() {
            assert!(bytes(Source::Raw(&raw[..end]), coding).is_err(), "{end}");
            assert!(bytes(Source::Base64(&one.as_bytes()[..end]), coding).is_err(), "{end}");
        }
    }

    #[test]
    fn plain_bytes_are_read() {
        for coding in codings(false) {
            for length in 0..9 {
                let data = &b"\x01\x02\xFF\x04\x05\x06\x07\x08\x09"[..length];
                check(&header(&[length as u64], coding), data, coding, data);
            }
        }
    }

    #[test]
    fn compressed_bytes_are_read() {
        let data: Vec<u8> = (0..100).collect();
        let blocks: Vec<Vec<u8>> = data.chunks(40).map(packed).collect();
        let sizes = blocks.iter().map(|block| block.len() as u64);
        let numbers: Vec<u64> = [3, 40, 20].into_iter().chain(sizes).collect();
        for coding in codings(true) {
            check(&header(&numbers, coding), &blocks.concat(), coding, &data);
            check(&header(&[0, 0, 0], coding), &[], coding, &[]);
        }
    }

    #[test]
    fn promises_that_are_not_kept_are_refused() {
        for coding in codings(false).into_iter().chain(codings(true)) {
            let head = vec![255; 40];
            assert_eq!(bytes(Source::Raw(&head), coding), Err(Fault::ShortArray));
            assert_eq!(bytes(Source::Base64(BASE64.encode(&head).as_bytes()), coding), Err(Fault::ShortArray));
        }
        let coding = codings(true)[0];
        let bomb = packed(&[0; 100_000]);
        let file = [header(&[1, 50, 50, bomb.len() as u64], coding), bomb].concat();
        assert_eq!(bytes(Source::Raw(&file), coding).expect("it is cut").len(), 50);
        let junk = [header(&[1, 50, 50, 4], coding), vec![7; 4]].concat();
        assert_eq!(bytes(Source::Raw(&junk), coding), Err(Fault::BadCompression));
        assert_eq!(bytes(Source::Base64(b"?????????????"), coding), Err(Fault::ShortArray));
    }
}
