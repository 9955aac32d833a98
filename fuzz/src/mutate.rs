//! Changes of inputs for the runner that has no libFuzzer.

/// Pseudorandom numbers: splitmix64.
pub struct Random(pub u64);

impl Random {
    fn number(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ z >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ z >> 31
    }

    /// A number below `count`, or 0.
    pub fn below(&mut self, count: usize) -> usize {
        (self.number() % count.max(1) as u64) as usize
    }

    fn of<'a, T>(&mut self, list: &'a [T]) -> &'a T {
        &list[self.below(list.len())]
    }

    /// A part of something so long.
    fn range(&mut self, length: usize) -> std::ops::Range<usize> {
        let start = self.below(length + 1);
        // Short parts are as common as long ones.
        let most = *self.of(&[4, 16, length]);
        start..start + self.below((length - start).min(most) + 1)
    }
}

/// Words that readers take for numbers or ends.
const WORDS: [&[u8]; 26] = [
    b"0",
    b"-1",
    b"1",
    b"3",
    b"255",
    b"4294967295",
    b"4294967296",
    b"18446744073709551615",
    b"-9223372036854775808",
    b"1e308",
    b"1e999",
    b"-1e-320",
    b"nan",
    b"inf",
    b"\n",
    b"\r\n",
    b" ",
    b"#",
    b"\"",
    b"\\",
    b",",
    b";",
    b"\0\0\0\0",
    b"\xFF\xFF\xFF\xFF",
    b"\x00\x00\x00\x80",
    b"\xEF\xBB\xBF",
];

const LONGEST: usize = 1 << 14;

/// One to six changes of an input; `other` is one that parts are taken from.
pub fn mutated(input: &[u8], other: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = input.to_vec();
    for _ in 0..=random.below(6) {
        change(&mut bytes, other, random);
    }
    bytes.truncate(LONGEST);
    bytes
}

fn change(bytes: &mut Vec<u8>, other: &[u8], random: &mut Random) {
    let length = bytes.len();
    match random.below(9) {
        0 if length > 0 => bytes[random.below(length)] ^= 1 << random.below(8),
        1 if length > 0 => {
            let place = random.below(length);
            bytes[place] = random.below(256) as u8;
        }
        2 => drop(bytes.drain(random.range(length))),
        3 => {
            let part = bytes[random.range(length)].to_vec();
            insert(bytes, &part, random);
        }
        4 => insert(bytes, *random.of(&WORDS), random),
        5 => {
            let part = word_at(bytes, random.below(length + 1));
            bytes.splice(part, random.of(&WORDS).iter().copied());
        }
        6 => {
            let (part, given) = (random.range(length), random.range(other.len()));
            bytes.splice(part, other[given].iter().copied());
        }
        7 => {
            let part = bytes[random.range(length)].to_vec();
            for byte in random.range(length).zip(part) {
                bytes[byte.0] = byte.1;
            }
        }
        _ => bytes.truncate(random.below(length + 1)),
    }
}

fn insert(bytes: &mut Vec<u8>, part: &[u8], random: &mut Random) {
    let place = random.below(bytes.len() + 1);
    bytes.splice(place..place, part.iter().copied());
}

/// The word that a place lies in; between words an empty range.
fn word_at(bytes: &[u8], place: usize) -> std::ops::Range<usize> {
    let is_inside = |byte: &u8| byte.is_ascii_alphanumeric() || b"+-._".contains(byte);
    let before = bytes[..place].iter().rev().take_while(|byte| is_inside(byte)).count();
    let after = bytes[place..].iter().take_while(|byte| is_inside(byte)).count();
    place - before..place + after
}
