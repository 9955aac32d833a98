//! The seeds below 1,000 that are known to fail, with the names of their failures.

pub const KNOWN: [(u64, &str); 1] = [(346, "FlippedFace Opposed")];
