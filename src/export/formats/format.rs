//! The formats of meshes.

use crate::surface::AttributeKind;
use std::fmt;
use std::path::Path;
use std::str::FromStr;

/// A format that a mesh is written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Wavefront OBJ: faces of any size, regions as groups.
    Obj,
    /// PLY, binary: faces of any size, the region of each face.
    Ply,
    /// STL: triangles; ASCII with a solid a region where regions have names, else binary.
    Stl,
    /// OFF: faces of any size.
    Off,
    /// VTK legacy, binary: faces of any size, with arrays.
    Vtk,
    /// VTU, the XML format of VTK, binary: faces of any size, with arrays.
    Vtu,
    /// Gmsh MSH 4.1, binary: regions as physical groups.
    Msh,
    /// Gmsh MSH 2.2, binary: regions as physical groups.
    Msh22,
    /// SU2: regions as markers.
    Su2,
    /// Abaqus and CalculiX input: shell elements, regions as element sets, sets of vertices.
    Inp,
    /// Nastran bulk data: shell elements, a property number a region.
    Bdf,
    /// glTF, binary: triangles, and edges as lines.
    Glb,
}

/// Formats by their names.
const NAMES: [(Format, &str); 12] = [
    (Format::Obj, "obj"),
    (Format::Ply, "ply"),
    (Format::Stl, "stl"),
    (Format::Off, "off"),
    (Format::Vtk, "vtk"),
    (Format::Vtu, "vtu"),
    (Format::Msh, "msh"),
    (Format::Msh22, "msh22"),
    (Format::Su2, "su2"),
    (Format::Inp, "inp"),
    (Format::Bdf, "bdf"),
    (Format::Glb, "glb"),
];

/// The name or the extension is none of a [`Format`].
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}; the formats are {}", if .0.is_empty() { "there is no extension".to_owned() } else { format!("{:?} is no format of meshes", .0) }, Format::list())]
pub struct UnknownFormat(pub String);

impl Format {
    /// All of them.
    pub fn all() -> impl Iterator<Item = Self> {
        NAMES.into_iter().map(|(format, _)| format)
    }

    /// Its name, which [`Format::from_str`] knows.
    pub fn name(self) -> &'static str {
        NAMES[self as usize].1
    }

    /// The extension of its files: its name, but for `msh22`, whose extension is `msh`.
    pub fn extension(self) -> &'static str {
        if self == Self::Msh22 { Self::Msh.name() } else { self.name() }
    }

    /// The format that the extension of a path means.
    ///
    /// # Errors
    /// Where there is no extension, or it is none of a format.
    pub fn from_extension(path: &Path) -> Result<Self, UnknownFormat> {
        path.extension().unwrap_or_default().to_string_lossy().parse()
    }

    /// The names, for messages.
    pub fn list() -> String {
        NAMES.map(|(_, name)| name).join(", ")
    }

    /// Whether attributes of a kind are written.
    pub fn takes(self, kind: AttributeKind) -> bool {
        match self {
            Self::Ply | Self::Vtk | Self::Vtu => true,
            Self::Obj | Self::Glb => kind != AttributeKind::Numbers,
            _ => false,
        }
    }

    /// Whether faces of more than four corners are written, as they are or split.
    pub fn takes_polygons(self) -> bool {
        !matches!(self, Self::Msh | Self::Msh22 | Self::Su2 | Self::Inp | Self::Bdf)
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Format {
    type Err = UnknownFormat;

    fn from_str(text: &str) -> Result<Self, UnknownFormat> {
        let found = NAMES.into_iter().find(|(_, name)| text.eq_ignore_ascii_case(name));
        found.map(|(format, _)| format).ok_or_else(|| UnknownFormat(text.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_extensions_are_known_again() {
        for format in Format::all() {
            assert_eq!(format.name().parse(), Ok(format));
        }
        assert_eq!(Format::from_extension(Path::new("a.b/wing.OBJ")), Ok(Format::Obj));
        let message = |path: &str| Format::from_extension(Path::new(path)).expect_err("no format").to_string();
        assert!(message("wing.stp").starts_with("\"stp\" is no format of meshes; the formats are obj, ply, stl,"));
        assert!(message("wing").starts_with("there is no extension; the formats are"), "{}", message("wing"));
    }
}
