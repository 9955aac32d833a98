//! VTK, legacy and XML.

use base64::Engine;
use base64::engine::general_purpose::STANDARD as BASE64;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use quadmosaic::mesh::read_mesh;
use quadmosaic::surface::load::{Fault, Format, LoadError, Place, read_stream};
use quadmosaic::surface::{Regions, Soup};
use std::io::Write;

/// A line before the faces, an array that tells no region, one that does, and their names. Written as bytes, or, where `is_new`, as
/// version 5 has it.
pub fn legacy(points: &[[f32; 3]], faces: &[&[u32]], is_binary: bool, is_new: bool) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut text = |text: String| bytes.extend(text.into_bytes());
    let number = |text: &mut dyn FnMut(&[u8]), number: i64, size: usize| match is_binary {
        true => text(&number.to_be_bytes()[8 - size..]),
        false => text(format!("{number} ").as_bytes()),
    };
    text(format!("# vtk DataFile Version {}\nmade by hand\n", if is_new { "5.1" } else { "3.0" }));
    text(format!("{}\nDATASET UNSTRUCTURED_GRID\n", if is_binary { "BINARY" } else { "ASCII" }));
    text("FIELD FieldData 4\nTIME 1 1 double\n".to_owned());
    let mut put = |part: &[u8]| bytes.extend(part);
    if is_binary {
        put(&2.5_f64.to_be_bytes())
    } else {
        put(b"2.5")
    }
    put(b"\nMETADATA\nINFORMATION 0\n\nby 1 2 string\n");
    for name in ["somebody", "else"] {
        match is_binary {
            true => put(&[&[0xC0 | name.len() as u8], name.as_bytes()].concat()),
            false => put(format!("{name}\n").as_bytes()),
        }
    }
    for (region, name) in ["upper%20skin", "tip"].into_iter().enumerate() {
        put(format!("\n{name} 2 1 int\n").as_bytes());
        number(&mut put, region as i64, 4);
        number(&mut put, 2, 4);
    }
    put(format!("\nPOINTS {} float\n", points.len()).as_bytes());
    for coordinate in points.as_flattened() {
        if is_binary { put(&coordinate.to_be_bytes()) } else { put(format!("{coordinate:e} ").as_bytes()) }
    }
    let cells: Vec<&[u32]> = [&[0, 1][..]].into_iter().chain(faces.iter().copied()).collect();
    let corners: usize = cells.iter().map(|cell| cell.len()).sum();
    if is_new {
        put(format!("\nCELLS {} {corners}\nOFFSETS vtktypeint64\n", cells.len() + 1).as_bytes());
        let mut end = 0;
        number(&mut put, 0, 8);
        for cell in &cells {
            end += cell.len() as i64;
            number(&mut put, end, 8);
        }
        put(b"\nCONNECTIVITY vtktypeint64\n");
        cells.iter().copied().flatten().for_each(|&corner| number(&mut put, corner.into(), 8));
    } else {
        put(format!("\nCELLS {} {}\n", cells.len(), cells.len() + corners).as_bytes());
        for cell in &cells {
            number(&mut put, cell.len() as i64, 4);
            cell.iter().for_each(|&corner| number(&mut put, corner.into(), 4));
        }
    }
    put(format!("\nCELL_TYPES {}\n", cells.len()).as_bytes());
    cells.iter().for_each(|cell| number(&mut put, [3, 5, 9, 7][cell.len() - 2], 4));
    put(format!("\nPOINT_DATA {}\nNORMALS n short\n", points.len()).as_bytes());
    (0..3 * points.len()).for_each(|_| number(&mut put, -1, 2));
    put(format!("\nCELL_DATA {}\nSCALARS quality unsigned_char 1\nLOOKUP_TABLE default\n", cells.len()).as_bytes());
    cells.iter().for_each(|_| number(&mut put, 200, 1));
    put(format!("\nFIELD FieldData 1\nRegion 1 {} int\n", cells.len()).as_bytes());
    (0..cells.len()).for_each(|cell| number(&mut put, i64::from(cell > cells.len() / 2), 4));
    put(b"\n");
    bytes
}

/// How the arrays of an XML file are written.
#[derive(Clone, Copy, PartialEq)]
pub enum Arrays {
    Ascii,
    Base64,
    Raw,
    AppendedBase64,
}

pub const ARRAYS: [Arrays; 4] = [Arrays::Ascii, Arrays::Base64, Arrays::Raw, Arrays::AppendedBase64];

/// The same as XML: a grid (VTU), or poly data (VTP), in two pieces if there are two faces or more.
pub fn xml(points: &[[f32; 3]], faces: &[&[u32]], is_poly: bool, arrays: Arrays, is_packed: bool) -> Vec<u8> {
    let mut file = Xml { text: String::new(), appended: Vec::new(), arrays, is_packed };
    let data_set = if is_poly { "PolyData" } else { "UnstructuredGrid" };
    let compressor = if is_packed { " compressor=\"vtkZLibDataCompressor\"" } else { "" };
    file.text += &format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"{data_set}\" version=\"1.0\" byte_order=\"BigEndian\" \
         header_type=\"UInt64\"{compressor}>\n<!-- made by hand -->\n<{data_set}>\n<FieldData>\n"
    );
    file.array("String", "by", 1, &[98, 121, 0]);
    file.array("Int32", "upper skin &lt;1&gt;", 2, &[0, 2]);
    file.array("Int64", "tip", 2, &[1, 2]);
    file.array("Int32", "1D", 2, &[1, 1]);
    file.text += "</FieldData>\n";
    let (first, second) = faces.split_at(faces.len() / 2);
    for (piece, faces) in [first, second].into_iter().enumerate() {
        file.text += "<Piece>\n<Points>\n";
        file.points(points);
        file.text += "</Points>\n";
        let cells = |file: &mut Xml, section: &str, cells: &[&[u32]]| {
            file.text += &format!("<{section}>\n");
            file.array(
                "Int32",
                "connectivity",
                1,
                &cells.iter().copied().flatten().map(|&corner| corner.into()).collect::<Vec<_>>(),
            );
            let ends = cells.iter().scan(0, |end, cell| {
                *end += cell.len() as i64;
                Some(*end)
            });
            file.array("Int64", "offsets", 1, &ends.collect::<Vec<_>>());
            if !is_poly {
                file.array(
                    "UInt8",
                    "types",
                    1,
                    &cells.iter().map(|cell| [3, 5, 9, 7][cell.len() - 2]).collect::<Vec<_>>(),
                );
            }
            file.text += &format!("</{section}>\n");
        };
        let line: &[u32] = &[0, 1];
        if is_poly {
            cells(&mut file, "Lines", &[line]);
            cells(&mut file, "Polys", faces);
        } else {
            cells(&mut file, "Cells", &[&[line], faces].concat());
        }
        file.text += "<CellData>\n";
        file.array("Int16", "normal", 3, &vec![-1; 3 * (faces.len() + 1)]);
        file.array("Int8", "Region", 1, &vec![piece as i64; faces.len() + 1]);
        file.text += "</CellData>\n</Piece>\n";
    }
    file.text += &format!("</{data_set}>\n");
    if matches!(arrays, Arrays::Raw | Arrays::AppendedBase64) {
        let encoding = if arrays == Arrays::Raw { "raw" } else { "base64" };
        file.text += &format!("<AppendedData encoding=\"{encoding}\">\n  _");
    }
    let mut bytes = file.text.into_bytes();
    bytes.extend(file.appended);
    if matches!(arrays, Arrays::Raw | Arrays::AppendedBase64) {
        bytes.extend(b"\n</AppendedData>\n");
    }
    bytes.extend(b"</VTKFile>\n");
    bytes
}

struct Xml {
    text: String,
    appended: Vec<u8>,
    arrays: Arrays,
    is_packed: bool,
}

impl Xml {
    fn array(&mut self, kind: &str, name: &str, components: usize, numbers: &[i64]) {
        let size = match kind {
            "String" | "Int8" | "UInt8" => 1,
            "Int16" => 2,
            "Int32" => 4,
            _ => 8,
        };
        let bytes = numbers.iter().flat_map(|number| number.to_be_bytes()[8 - size..].to_vec()).collect();
        let text = numbers.iter().map(|number| format!("{number} ")).collect();
        self.put(kind, name, components, text, bytes);
    }

    fn points(&mut self, points: &[[f32; 3]]) {
        let all = points.as_flattened();
        let text = all.iter().map(|number| format!("{number:e}\n")).collect();
        self.put("Float32", "Points", 3, text, all.iter().flat_map(|number| number.to_be_bytes()).collect());
    }

    fn put(&mut self, kind: &str, name: &str, components: usize, text: String, bytes: Vec<u8>) {
        let head = format!("<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\"");
        let numbers =
            |numbers: &[usize]| numbers.iter().flat_map(|&number| (number as u64).to_be_bytes()).collect::<Vec<_>>();
        let (header, data) = if self.is_packed {
            let blocks: Vec<_> = bytes.chunks(16).map(packed).collect();
            let sizes = blocks.iter().map(Vec::len);
            let all: Vec<_> = [blocks.len(), 16, bytes.len() % 16].into_iter().chain(sizes).collect();
            (numbers(&all), blocks.concat())
        } else {
            (numbers(&[bytes.len()]), bytes)
        };
        let base64 = || BASE64.encode(&header) + &BASE64.encode(&data);
        let offset = self.appended.len();
        self.text += &match self.arrays {
            Arrays::Ascii => format!("{head} format=\"ascii\">\n{text}\n</DataArray>\n"),
            Arrays::Base64 => format!("{head} format=\"binary\">\n  {}\n</DataArray>\n", base64()),
            Arrays::Raw | Arrays::AppendedBase64 => format!("{head} format=\"appended\" offset=\"{offset}\"/>\n"),
        };
        match self.arrays {
            Arrays::Raw => self.appended.extend([header, data].concat()),
            Arrays::AppendedBase64 => self.appended.extend(base64().into_bytes()),
            Arrays::Ascii | Arrays::Base64 => {}
        }
    }
}

fn packed(bytes: &[u8]) -> Vec<u8> {
    let mut packer = ZlibEncoder::new(Vec::new(), Compression::fast());
    packer.write_all(bytes).expect("a vector takes all");
    packer.finish().expect("a vector takes all")
}

const POINTS: [[f32; 3]; 5] = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.5, 2.0, 0.0]];
const FACES: [&[u32]; 2] = [&[0, 1, 2, 3], &[3, 2, 4]];

fn parse(bytes: impl AsRef<[u8]>) -> Result<Soup, LoadError> {
    read_stream(bytes.as_ref(), "wing", None)
}

fn plain() -> String {
    String::from_utf8(legacy(&POINTS, &FACES, false, false)).expect("it is text")
}

fn plain_xml() -> String {
    String::from_utf8(xml(&POINTS, &FACES, false, Arrays::Ascii, false)).expect("it is text")
}

#[test]
fn numbers_of_cells_are_regions() {
    let regions = Regions { names: vec!["upper skin".into(), "tip".into()], of_face: vec![0, 0, 1] };
    for is_binary in [false, true] {
        for is_new in [false, true] {
            let soup = parse(legacy(&POINTS, &FACES, is_binary, is_new)).expect("it is valid");
            assert_eq!((soup.points.len(), soup.triangles.len()), (5, 3));
            assert_eq!(soup.triangles[2], [3, 2, 4]);
            assert_eq!(soup.regions, regions);
        }
    }
    for arrays in ARRAYS {
        for (is_poly, is_packed) in [(false, false), (false, true), (true, false), (true, true)] {
            let soup = parse(xml(&POINTS, &FACES, is_poly, arrays, is_packed)).expect("it is valid");
            // The points of the second piece come after those of the first.
            assert_eq!((soup.points.len(), soup.triangles.len()), (10, 3));
            assert_eq!(soup.triangles[2], [8, 7, 9]);
            assert_eq!(soup.regions.names, ["upper skin <1>", "tip"]);
            assert_eq!(soup.regions.of_face, regions.of_face);
        }
    }
    let unnamed = plain().replace("0 2 ", "0 3 ").replace("1 2 \nPOINTS", "1 1 \nPOINTS");
    assert_eq!(parse(unnamed).expect("it is valid").regions.names, ["Region_0", "Region_1"]);
    let floats = plain().replace("3 int", "3 float");
    assert_eq!(parse(floats).expect("it is valid").regions, Regions::default());
}

#[test]
fn quads_stay_quads_in_a_mesh() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for bytes in [legacy(&POINTS, &FACES, true, true), xml(&POINTS, &FACES, true, Arrays::Raw, true)] {
        let path = folder.path().join("wing");
        std::fs::write(&path, bytes).expect("it can be written");
        let mesh = read_mesh(&path).expect("it is a mesh");
        assert_eq!(mesh.faces().map(<[u32]>::len).collect::<Vec<_>>(), [4, 3]);
        assert_eq!(mesh.regions.of_face, [0, 1]);
    }
}

#[test]
fn poly_data_has_polygons_and_strips() {
    let head = "# vtk DataFile Version 2.0\n\nascii\ndataset polydata\npoints 4 int\n0 0 0 1 0 0 0 1 0 1 1 0\n";
    let cells = "TRIANGLE_STRIPS 1 5\n4 0 1 2 3\nPOLYGONS 1 4\n3 1 3\n2\nLINES 1 3\n2 0 1\nMETADATA\nINFORMATION 0\n\n";
    let data = "CELL_DATA 3\nSCALARS label long\n9 7 8\nPOINT_DATA 4\nCOLOR_SCALARS c 2\n0 0 0 0 0 0 0 0.5\n\
                LOOKUP_TABLE t 1\n0 0 0 1\nTEXTURE_COORDINATES uv 2 float\n0 0 0 0 0 0 0 0\n";
    let soup = parse(head.to_owned() + cells + data).expect("it is valid");
    assert_eq!(soup.triangles, [[1, 3, 2], [0, 1, 2], [2, 1, 3]]);
    let regions = Regions { names: vec!["label_7".into(), "label_8".into()], of_face: vec![0, 1, 1] };
    assert_eq!(soup.regions, regions, "cells are lines, polygons, strips in this order");
    assert!(matches!(parse(head), Err(LoadError::NoFaces { vertices: 4, .. })));
}

#[test]
fn wrong_places_are_named() {
    use Fault::*;
    let word = |word: &str| word.to_owned();
    let section = word("a section such as POINTS, CELLS or CELL_DATA");
    let text = plain();
    let line = |part: &str, text: &str| 1 + text[..text.find(part).expect("it is there")].matches('\n').count();
    for (from, to, at, fault) in [
        ("ASCII", "ASKII", "ASCII", WrongWord { word: word("ASKII"), wanted: word("ASCII or BINARY") }),
        ("CELL_TYPES", "CELL_KINDS", "CELL_TYPES", WrongWord { word: word("CELL_KINDS"), wanted: section }),
        ("4 0 1 2 3", "4 0 1 2 5", "4 0 1 2 3", NoSuchVertex { index: 5.0, vertices: 5 }),
        ("4 0 1 2 3", "4 0 1 2 -1", "4 0 1 2 3", NoSuchVertex { index: -1.0, vertices: 5 }),
        ("4 0 1 2 3", "4 0 1 2 x", "4 0 1 2 3", NotAValue { word: word("x") }),
        ("POINTS 5", "POINTS -5", "POINTS", NotACount { count: word("-5") }),
        ("2e0", "inf", "2e0", NotFinite { word: word("inf") }),
    ] {
        let wrong = text.replacen(from, to, 1);
        assert_ne!(wrong, text, "{from}");
        match parse(&wrong) {
            Err(LoadError::At { place, fault: why, .. }) => {
                assert_eq!((place, why), (Place::Line(line(at, &text)), fault))
            }
            other => panic!("{to}: {other:?}"),
        }
    }
    for (from, to, message) in [
        (
            "UNSTRUCTURED_GRID",
            "STRUCTURED_GRID",
            "line 4: the VTK data set \"STRUCTURED_GRID\" is not read; extract its surface",
        ),
        ("3 9 5", "3 9", "is not a number"),
        ("3 9 5", "3 9 9", "cell 2 (counted from 0): the face has 3 corners but needs at least"),
        ("Region 1 3", "Region 1 4000000000", "wing ends within FIELD; copy or export it again"),
        ("POINTS 5", "POINTS 4000000000", "the value \"CELLS\" is not a number"),
    ] {
        let wrong = text.replacen(from, to, 1);
        assert_ne!(wrong, text, "{from}");
        let error = parse(&wrong).expect_err(to).to_string();
        assert!(error.contains(message), "{error}");
    }
    let cut = &text[..text.find("CELL_TYPES").expect("it is there")];
    let error = parse(cut).expect_err("no cell has a type").to_string();
    assert!(error.contains("the header says 3 types of cells, but the file ends after 0"), "{error}");
}

#[test]
fn wrong_elements_are_named() {
    let text = plain_xml();
    for (from, to, message) in [
        (
            "\"UnstructuredGrid\"",
            "\"ImageData\"",
            "line 2: the VTK data set \"ImageData\" is not read; extract its surface",
        ),
        (
            "header_type",
            "compressor=\"vtkLZ4DataCompressor\" header_type",
            "compressed by \"vtkLZ4DataCompressor\" is not read",
        ),
        ("</Points>", "</Point>", "the file is no XML ("),
        ("</VTKFile>", "", "wing ends within the element VTKFile; copy or export it again"),
        ("3 2 4", "3 2 5", "the face uses vertex 5, but there are 5, counted from 0"),
        ("3 2 4", "3 2 x", "the value \"x\" is not a number"),
        ("2 5 \n", "2 7 \n", "a cell ends at corner 7, but it begins at 2, and there are"),
        ("3 5 \n", "3 9 \n", "cell 3 (counted from 0): the face has 3 corners but needs"),
        ("3 5 \n", "3 \n", "the header says 2 types of cells, but the file ends after 1"),
        ("2e0", "nan", "point 9 (counted from 0): the coordinate \"NaN\" is not finite"),
    ] {
        // The last place: the second piece.
        let at = text.rfind(from).unwrap_or_else(|| panic!("{from}"));
        let at = if message.contains("line 2") { text.find(from).unwrap_or(at) } else { at };
        let wrong = [&text[..at], to, &text[at + from.len()..]].concat();
        let error = parse(wrong).expect_err(to).to_string();
        assert!(error.contains(message), "{to}: {error}");
    }
    let raw = xml(&POINTS, &FACES, false, Arrays::Raw, false);
    let error = parse(&raw[..raw.len() - 60]).expect_err("it is cut off").to_string();
    assert!(error.contains("the data of the array is damaged or shorter than it says"), "{error}");
}

#[test]
fn formats_are_those_of_the_data_set() {
    for (is_poly, format) in [(false, Format::Vtu), (true, Format::Vtp)] {
        let bytes = xml(&POINTS, &FACES, is_poly, Arrays::Raw, false);
        assert!(read_stream(&bytes[..], "wing", Some(format)).is_ok());
        assert!(
            matches!(read_stream(&bytes[..], "wing", Some(Format::Vtk)), Err(LoadError::OtherFormat { found, .. }) if found == format)
        );
    }
}
