//! The seeds that are known to fail, with the names of their failures.

pub const KNOWN: [(u64, &str); 0] = [];
