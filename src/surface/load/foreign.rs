//! Kinds of files that are no meshes of a format that is read, known by their content, and what to do with them.

use super::LoadError;
use super::text::words;

/// How much of a file is looked at where no fixed place tells.
const LOOKED_AT: usize = 1 << 16;

const EXPORT_CAD: &str = "mesh its faces in the CAD program, or in Gmsh or FreeCAD, and export them as STL, OBJ or MSH";
const EXPORT_MESH: &str =
    "open it in the program that it is from, or in Blender or MeshLab, and export it as OBJ, PLY or STL";
const RUN: &str = "run it in its program and export the result as STL, OBJ or MSH";

/// The error for a file whose beginning says that it is of another kind.
pub fn refused(bytes: &[u8], file: &str) -> Option<LoadError> {
    let head = &bytes[..bytes.len().min(LOOKED_AT)];
    let has = |part: &[u8]| head.windows(part.len()).any(|window| window == part);
    let text = head.trim_ascii_start();
    let begins = |part: &str| text.get(..part.len()).is_some_and(|first| first.eq_ignore_ascii_case(part.as_bytes()));
    let is_xml = |element: &[u8]| begins("<") && has(element);
    let (kind, remedy) = if begins("ISO-10303-21;") {
        ("a STEP file, a CAD model", EXPORT_CAD)
    } else if is_iges(bytes) {
        ("an IGES file, a CAD model", EXPORT_CAD)
    } else if begins("DBRep_DrawableShape") || begins("CASCADE Topology") {
        ("a BREP file, a CAD model of Open CASCADE", EXPORT_CAD)
    } else if begins("**ABCDEFGHIJKLMNOPQRSTUVWXYZ") || begins("**PART1;") {
        ("a Parasolid file, a CAD model", EXPORT_CAD)
    } else if bytes.starts_with(b"\xD0\xCF\x11\xE0") {
        ("a document of a CAD or office program", EXPORT_CAD)
    } else if bytes.starts_with(b"PK\x03\x04") && has(b"3dmodel.model") {
        ("a 3MF file", "open it in the slicer, or in Blender or MeshLab, and export it as STL or OBJ")
    } else if bytes.starts_with(b"PK\x03\x04")
        || bytes.starts_with(b"BZh")
        || bytes.starts_with(b"7z\xBC\xAF")
        || bytes.starts_with(b"\xFD7zXZ\0")
    {
        ("an archive", "unpack it and name a file in it; only gzip is unpacked here")
    } else if bytes.starts_with(b"glTF") || begins("{") && has(b"\"asset\"") {
        ("a glTF file", EXPORT_MESH)
    } else if bytes.starts_with(b"Kaydara FBX Binary") || begins("; FBX ") {
        ("an FBX file", EXPORT_MESH)
    } else if bytes.starts_with(b"BLENDER") {
        ("a Blender file", EXPORT_MESH)
    } else if bytes.starts_with(b"\x89HDF\r\n") {
        ("an HDF5 file, such as CGNS or MED", "export the surface as VTU, MSH or STL, in ParaView or Salome")
    } else if words(text).take(2).eq([&b"0"[..], b"SECTION"]) {
        ("a DXF file, a drawing", EXPORT_CAD)
    } else if begins("#VRML") || is_xml(b"<X3D") {
        ("a VRML or X3D file, a scene", EXPORT_MESH)
    } else if is_xml(b"<COLLADA") {
        ("a COLLADA file, a scene", EXPORT_MESH)
    } else if is_xml(b"<amf") {
        ("an AMF file", EXPORT_MESH)
    } else if begins("<!DOCTYPE html") || begins("<html") {
        ("a web page", "download the file itself")
    } else if begins("version https://git-lfs") {
        ("a pointer of Git LFS", "fetch the file itself with git lfs pull")
    } else if begins("FoamFile") || begins("/*---") && has(b"FoamFile") {
        ("an OpenFOAM file", "write the surface as VTK or STL, with surfaceMeshExtract or foamToVTK")
    } else {
        return None;
    };
    Some(LoadError::Foreign { file: file.to_owned(), kind, remedy })
}

/// The error for a text in which a script or an input file of another program is found, if no format is.
pub fn refused_text(bytes: &[u8], file: &str) -> Option<LoadError> {
    let head = &bytes[..bytes.len().min(LOOKED_AT)];
    if head.contains(&0) {
        return None;
    }
    let text = String::from_utf8_lossy(head);
    let lines = || text.lines().map(str::trim).filter(|line| !line.is_empty());
    let any = |starts: &[&str]| lines().any(|line| starts.iter().any(|start| line.starts_with(start)));
    let first = lines().find(|line| !line.starts_with("**")).unwrap_or_default().to_ascii_uppercase();
    let (kind, remedy) = if any(&["SetFactory(", "Point(", "Point (", "Physical Surface", "lc = ", "Include \""])
        && text.contains(';')
    {
        ("a Gmsh script", "mesh it in Gmsh (gmsh -2 -format msh41) and name the MSH file")
    } else if first.starts_with("*HEADING") || first.starts_with("*NODE") || first.starts_with("*PART") {
        ("an input file of Abaqus or CalculiX", "export its surface as OBJ, STL or VTU")
    } else if any(&["BEGIN BULK", "GRID ", "GRID*", "GRID,"]) {
        ("a Nastran file", "export its surface as OBJ, STL or VTU")
    } else if any(&["NDIME="]) {
        ("an SU2 mesh", "export its surface as OBJ, STL or VTU")
    } else if first.starts_with("#!") || any(&["import ", "def "]) {
        ("a script", RUN)
    } else if any(&[
        "module ",
        "difference()",
        "union()",
        "translate(",
        "rotate(",
        "cube(",
        "sphere(",
        "cylinder(",
        "$fn",
        "linear_extrude(",
    ]) {
        ("an OpenSCAD script", RUN)
    } else {
        return None;
    };
    Some(LoadError::Foreign { file: file.to_owned(), kind, remedy })
}

/// Lines of 80 characters, of which the last eight are a section's letter and the number in it; the first section is S.
fn is_iges(bytes: &[u8]) -> bool {
    bytes.get(72) == Some(&b'S')
        && bytes.get(73..80).is_some_and(|number| number.trim_ascii() == b"1" || number == b"0000001")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kind(text: &[u8]) -> Option<&'static str> {
        match refused(text, "it").or_else(|| refused_text(text, "it")) {
            Some(LoadError::Foreign { kind, .. }) => Some(kind),
            _ => None,
        }
    }

    #[test]
    fn kinds_are_known_by_their_content() {
        let iges = format!("{:<72}S      1\n", "a part");
        let three = [&b"PK\x03\x04\x14\0\0\0"[..], b"3D/3dmodel.model"].concat();
        let cases: [(&[u8], &str); 17] = [
            (b"\nISO-10303-21;\nHEADER;", "STEP"),
            (iges.as_bytes(), "IGES"),
            (&three, "3MF"),
            (b"PK\x03\x04\x14\0\0\0wing.obj", "archive"),
            (b"glTF\x02\0\0\0", "glTF"),
            (b"{\"asset\": {\"version\": \"2.0\"}}", "glTF"),
            (b"<?xml version=\"1.0\"?><COLLADA>", "COLLADA"),
            (b"<!doctype HTML><html>", "web page"),
            (b"\x89HDF\r\n\x1A\n", "CGNS"),
            (b"  0\nSECTION\n  2\nHEADER\n", "DXF"),
            (b"CASCADE Topology V1, (c) Matra-Datavision", "BREP"),
            (b"SetFactory(\"OpenCASCADE\");\nBox(1) = {0,0,0, 1,1,1};\n", "Gmsh"),
            (b"$fn = 20;\ndifference() { cube(2); sphere(1); }\n", "OpenSCAD"),
            (b"#!/usr/bin/env python3\nprint(1)\n", "a script"),
            (b"** made by hand\n*Heading\n*NODE\n1, 0, 0, 0\n", "Abaqus"),
            (b"$ made by hand\nBEGIN BULK\nGRID,1,,0.,0.,0.\n", "Nastran"),
            (b"NDIME= 3\nNELEM= 0\n", "SU2"),
        ];
        for (text, part) in cases {
            let kind = kind(text).unwrap_or_default();
            assert!(kind.contains(part), "{}: {kind}", String::from_utf8_lossy(text));
        }
    }

    #[test]
    fn meshes_and_rubbish_are_no_other_kind() {
        let meshes: [&[u8]; 6] = [
            b"solid step\nfacet normal 0 0 1",
            b"# ISO-10303-21;\nv 0 0 0\nv 1 0 0\nf 1 2 3\n",
            b"<?xml version=\"1.0\"?><VTKFile type=\"PolyData\">",
            b"ply\nformat ascii 1.0\n",
            b"rubbish",
            b"",
        ];
        for text in meshes {
            assert_eq!(kind(text), None, "{}", String::from_utf8_lossy(text));
        }
    }
}
