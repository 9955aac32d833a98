//! Arrays of numbers in JSON: little-endian bytes in base64.

use base64::prelude::{BASE64_STANDARD, Engine};
use serde::{Serialize, Serializer};

/// Numbers of 32 bits.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Floats(pub Vec<f32>);

/// Indices of 32 bits.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Indices(pub Vec<u32>);

impl Serialize for Floats {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&encoded(self.0.iter().map(|number| number.to_le_bytes())))
    }
}

impl Serialize for Indices {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&encoded(self.0.iter().map(|number| number.to_le_bytes())))
    }
}

fn encoded(numbers: impl Iterator<Item = [u8; 4]>) -> String {
    BASE64_STANDARD.encode(numbers.flatten().collect::<Vec<u8>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_little_endian() {
        let text = |value: &dyn Fn() -> serde_json::Result<String>| value().expect("it is text");
        assert_eq!(text(&|| serde_json::to_string(&Indices(vec![1, 0x0403_0201]))), "\"AQAAAAECAwQ=\"");
        assert_eq!(text(&|| serde_json::to_string(&Floats(vec![1.0]))), "\"AACAPw==\"");
    }
}
