//! The seeds below 1,000 that are known to fail, with the names of their failures.

pub const KNOWN: [(u64, &str); 14] = [
    (60, "FlippedFace Opposed"),
    (111, "FlippedFace"),
    (219, "ConcaveQuad DegenerateFace FlippedFace"),
    (306, "FlippedFace"),
    (316, "FlippedFace"),
    (406, "FlippedFace Opposed"),
    (428, "FlippedFace"),
    (442, "FlippedFace"),
    (512, "Uncovered"),
    (531, "FlippedFace"),
    (626, "FlippedFace"),
    (660, "FlippedFace"),
    (797, "Uncovered"),
    (946, "FlippedFace"),
];
