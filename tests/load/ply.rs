//! PLY, ASCII and binary.

use quadmosaic::surface::load::{Fault, Format, LoadError, Place, read_stream};
use quadmosaic::surface::{Regions, Soup};

/// The header of a file with properties and elements that nobody is to look at.
fn header(encoding: &str, points: usize, faces: usize) -> String {
    format!(
        "ply\nformat {encoding} 1.0\ncomment by hand\nobj_info none\nelement origin 1\nproperty double at\n\
         element vertex {points}\nproperty uchar red\nproperty float x\nproperty list uchar short weights\n\
         property float32 y\nproperty double z\nelement nothing 4000000000\nelement face {faces}\n\
         property list uint16 float uv\nproperty list uint8 int vertex_indices\nproperty int16 spare\nend_header\n"
    )
}

pub fn ascii(points: &[[f32; 3]], faces: &[[u32; 3]]) -> String {
    let mut text = header("ascii", points.len(), faces.len()) + "12.5\n";
    for [x, y, z] in points {
        text += &format!("255 {x} 2 -1 -2 {y} {:e}\n", f64::from(*z));
    }
    for [a, b, c] in faces {
        text += &format!("1 0.5 3 {a} {b} {c} -7\n");
    }
    text
}

pub fn binary(points: &[[f32; 3]], faces: &[[u32; 3]], big: bool) -> Vec<u8> {
    let encoding = if big { "binary_big_endian" } else { "binary_little_endian" };
    let mut bytes = header(encoding, points.len(), faces.len()).into_bytes();
    let mut put = |mut number: Vec<u8>| {
        if big {
            number.reverse();
        }
        bytes.extend(number);
    };
    put(12.5_f64.to_le_bytes().into());
    for [x, y, z] in points {
        put(vec![255]);
        put(x.to_le_bytes().into());
        put(vec![2]);
        put((-1_i16).to_le_bytes().into());
        put((-2_i16).to_le_bytes().into());
        put(y.to_le_bytes().into());
        put(f64::from(*z).to_le_bytes().into());
    }
    for face in faces {
        put(1_u16.to_le_bytes().into());
        put(0.5_f32.to_le_bytes().into());
        put(vec![3]);
        face.iter().for_each(|index| put(index.to_le_bytes().into()));
        put((-7_i16).to_le_bytes().into());
    }
    bytes
}

const HEAD: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
                    element face 1\nproperty list uchar int vertex_indices\nend_header\n";
const SQUARE: &str = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";

fn parse(bytes: impl AsRef<[u8]>) -> Result<Soup, LoadError> {
    read_stream(bytes.as_ref(), "wing.ply", Some(Format::Ply))
}

#[test]
fn odd_but_valid_files_load() {
    let plain = format!("{HEAD}{SQUARE}4 0 1 2 3\n");
    let whole = parse(&plain).expect("it is valid");
    assert_eq!((whole.points.len(), whole.triangles.len()), (4, 2), "polygons are triangulated");
    for (name, text) in [
        ("carriage returns", plain.replace('\n', "\r\n")),
        ("other name of the list", plain.replace("vertex_indices", "vertex_index")),
        ("blank lines", plain.replace("1 0 0\n", "\n \n 1\t0 0 \n")),
        ("no line end", plain.trim_end().to_owned()),
        ("more after the end", plain.clone() + "and so on\n"),
        (
            "indices as floating numbers",
            plain.replace("uchar int", "uchar float").replace("4 0 1 2 3", "4 0.0 1 2 3e0"),
        ),
        ("other types", plain.replace("float", "short").replace("uchar int", "int8 int64").replace("64", "16")),
    ] {
        assert_eq!(parse(text).unwrap_or_else(|error| panic!("{name}: {error}")), whole, "{name}");
    }
    let (head, faces) = (HEAD.replace("vertex 4", "vertex 5"), "4 0 1 2 3\n");
    let unused = parse(format!("{head}{SQUARE}nan nan nan\n{faces}")).expect("no face uses the vertex without a place");
    assert_eq!((unused.points.len(), unused.triangles), (5, whole.triangles));
}

#[test]
fn faces_may_come_before_vertices() {
    let text = "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\nelement vertex 3\n\
                property double x\nproperty double y\nproperty double z\nend_header\n3 2 1 0\n0 0 0.1\n1 0 0\n0 1 0\n";
    let soup = parse(text).expect("it is valid");
    assert_eq!((soup.points[0], soup.triangles), ([0.0, 0.0, 0.1], vec![[2, 1, 0]]));
}

#[test]
fn wrong_headers_are_refused() {
    use Fault::*;
    let word = |word: &str| word.to_owned();
    for (from, to, line, fault) in [
        ("ascii 1.0", "ascii 1.1", 2, UnknownEncoding { format: word("ascii 1.1") }),
        ("ascii 1.0", "binary 1.0", 2, UnknownEncoding { format: word("binary 1.0") }),
        ("float x", "real x", 4, UnknownType { word: word("real") }),
        ("uchar int", "float int", 8, UnknownType { word: word("float") }),
        ("uchar int", "uchar long", 8, UnknownType { word: word("long") }),
        ("vertex 4", "vertex many", 3, HeaderLine { line: word("element vertex many") }),
        ("vertex 4", "vertex -4", 3, HeaderLine { line: word("element vertex -4") }),
        ("element vertex 4\n", "", 3, HeaderLine { line: word("property float x") }),
        ("element face", "elephant face", 7, HeaderLine { line: word("elephant face 1") }),
        ("list uchar int", "list uchar", 8, HeaderLine { line: word("property list uchar vertex_indic...") }),
        ("format ascii 1.0\n", "", 8, HeaderLacks { what: "a line format" }),
        ("float y", "float v", 9, HeaderLacks { what: "the properties x, y and z of the element vertex" }),
        ("_indices", "s", 9, HeaderLacks { what: "the list vertex_indices of the element face" }),
        ("list uchar int", "int", 9, HeaderLacks { what: "the list vertex_indices of the element face" }),
        ("end_header\n", "", 9, HeaderLine { line: word("0 0 0") }),
    ] {
        let text = format!("{HEAD}{SQUARE}4 0 1 2 3\n");
        assert!(text.contains(from));
        match parse(text.replacen(from, to, 1)) {
            Err(LoadError::At { place, fault: why, .. }) => {
                assert_eq!((place, why), (Place::Line(line), fault), "{to}")
            }
            other => panic!("{to}: {other:?}"),
        }
    }
    assert!(matches!(parse("ply\nformat ascii 1.0\n"), Err(LoadError::At { fault: EndlessHeader, .. })));
    assert!(matches!(parse(HEAD.replace("vertex 4", "vertex 0")), Err(LoadError::NoVertices { .. })));
    for none in ["face 0", "edge 1"] {
        let text = HEAD.replace("face 1", none) + SQUARE;
        assert!(matches!(parse(text), Err(LoadError::NoFaces { vertices: 4, .. })));
    }
}

#[test]
fn wrong_rows_are_named() {
    use Fault::*;
    let word = |word: &str| word.to_owned();
    let text = format!("{HEAD}{SQUARE}4 0 1 2 3\n");
    for (from, to, line, fault) in [
        ("1 1 0", "1 1", 12, WrongRow { more: false }),
        ("1 1 0", "1 1 0 0", 12, WrongRow { more: true }),
        ("1 1 0", "1 x 0", 12, NotAValue { word: word("x") }),
        ("1 1 0", "1 nan 0", 12, NotFinite { word: word("NaN") }),
        ("1 1 0", "1 1 1e999", 12, NotFinite { word: word("inf") }),
        ("4 0 1 2 3", "4 0 1 2 4", 14, NoSuchVertex { index: 4.0, vertices: 4 }),
        ("4 0 1 2 3", "4 0 1 2 -1", 14, NoSuchVertex { index: -1.0, vertices: 4 }),
        ("4 0 1 2 3", "4 0 1 2 2.5", 14, NoSuchVertex { index: 2.5, vertices: 4 }),
        ("4 0 1 2 3", "4 0 1 2", 14, WrongRow { more: false }),
        ("4 0 1 2 3", "3 0 1 2 3", 14, WrongRow { more: true }),
        ("4 0 1 2 3", "2 0 1", 14, TooFewIndices { count: 2 }),
        ("4 0 1 2 3", "-1", 14, NotACount { count: word("-1") }),
        ("4 0 1 2 3", "1e18 0 1 2", 14, WrongRow { more: false }),
    ] {
        assert!(text.contains(from));
        match parse(text.replacen(from, to, 1)) {
            Err(LoadError::At { place, fault: why, .. }) => {
                assert_eq!((place, why), (Place::Line(line), fault), "{to}")
            }
            other => panic!("{to}: {other:?}"),
        }
    }
}

#[test]
fn wrong_places_of_binary_files_are_named() {
    let points = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    for big in [false, true] {
        let message = |points: &[[f32; 3]], faces: &[[u32; 3]]| {
            parse(binary(points, faces, big)).expect_err("it is wrong").to_string()
        };
        let body = header(if big { "binary_big_endian" } else { "binary_little_endian" }, 3, 2).len();
        // The element origin has 8 bytes, a vertex 22 and a face 21.
        let wrong = message(&points, &[[0, 1, 2], [0, 1, 3]]);
        let place = format!("wing.ply, face 1 (counted from 0) at byte {}: the face uses vertex 3", body + 8 + 66 + 21);
        assert!(wrong.starts_with(&place), "{wrong}");
        let wrong = message(&[points[0], [0.0, f32::NAN, 0.0], points[2]], &[[0, 1, 2]; 2]);
        let place = format!("wing.ply, vertex 1 (counted from 0) at byte {}: the coordinate \"NaN\"", body + 8 + 22);
        assert!(wrong.starts_with(&place), "{wrong}");
    }
}

/// The promises of a header cost neither memory nor time.
#[test]
fn promises_that_are_not_kept_are_refused() {
    let points = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let replaced = |bytes: Vec<u8>, from: &str, to: &str| {
        let place = bytes.windows(from.len()).position(|part| part == from.as_bytes()).expect("it is there");
        [&bytes[..place], to.as_bytes(), &bytes[place + from.len()..]].concat()
    };
    for bytes in [
        ascii(&points, &[[0, 1, 2]]).into_bytes(),
        binary(&points, &[[0, 1, 2]], false),
        binary(&points, &[[0, 1, 2]], true),
    ] {
        let promising = replaced(bytes.clone(), "face 1", "face 18446744073709551615");
        let error = parse(promising).expect_err("there is one").to_string();
        let message = "is cut off: the header says 18446744073709551615 faces, but the file ends after 1;";
        assert!(error.contains(message), "{error}");
        let error = parse(&bytes[..bytes.len() - 4]).expect_err("it is cut off").to_string();
        assert!(error.contains("1 faces, but the file ends after 0") || error.contains("too few values"), "{error}");
    }
    // A list of four billion entries.
    let text =
        HEAD.replace("ascii", "binary_little_endian").replace("uchar int vertex_indices", "uint int vertex_indices");
    let bytes = [text.as_bytes(), &[0; 48], &[255; 4], &[0; 400]].concat();
    let error = parse(&bytes).expect_err("it is shorter").to_string();
    assert!(error.contains("the header says 1 faces, but the file ends after 0"), "{error}");
    let text = HEAD.replace("vertex_indices", "others\nproperty list uchar int vertex_indices");
    let text = text.replace("ascii", "binary_little_endian").replace("uchar int others", "uint double others");
    let bytes = [text.as_bytes(), &[0; 48], &[255; 4], &[0; 400]].concat();
    let error = parse(&bytes).expect_err("it is shorter").to_string();
    assert!(error.contains("the header says 1 faces, but the file ends after 0"), "{error}");
}

#[test]
fn strips_are_triangles() {
    let text = HEAD.replace("face 1", "tristrips 1") + SQUARE + "9 0 1 3 2 -1 3 3 1 2\n";
    let soup = parse(&text).expect("it is valid");
    assert_eq!(soup.triangles, [[0, 1, 3], [3, 1, 2], [1, 3, 2]]);
    let both =
        text.replace("end_header", "element face 1\nproperty list uchar int vertex_index\nend_header") + "3 0 1 2\n";
    assert_eq!(parse(both).expect("it is valid").triangles[3..], [[0, 1, 2]]);
    for (strips, message) in [
        ("9 0 1 4 2 -1 3 3 1 2", "line 14: the face uses vertex 4"),
        ("9 0 1 -2 2 -1 3 3 1 2", "line 14: the face uses vertex -2"),
        ("4 0 0 1 1", "has 4 vertices but no faces"),
        ("2 0 1", "has 4 vertices but no faces"),
    ] {
        let error = parse(text.replace("9 0 1 3 2 -1 3 3 1 2", strips)).expect_err("there is no triangle").to_string();
        assert!(error.contains(message), "{error}");
    }
    let nothing = text.replace("vertex_indices", "corners");
    assert!(parse(nothing).expect_err("no list").to_string().contains("the element tristrips"));
}

#[test]
fn whole_numbers_of_faces_are_regions() {
    let head = HEAD.replace("face 1\n", "face 3\nproperty uchar red\n");
    let text =
        |properties: &str, rows: &str| head.replace("end_header", &format!("{properties}\nend_header")) + SQUARE + rows;
    let regions = |properties: &str, rows: &str| parse(text(properties, rows)).expect("it is valid").regions;
    let rows = "1 4 0 1 2 3 8 5\n2 3 0 1 2 -1 5\n3 3 0 2 3 8 6\n";
    let named = |names: [&str; 2], of_face| Regions { names: names.map(str::to_owned).to_vec(), of_face };
    let first = named(["material_index_8", "material_index_-1"], vec![0, 0, 1, 0]);
    assert_eq!(regions("property int material_index\nproperty int flags", rows), first);
    let second = named(["region_5", "region_6"], vec![0, 0, 0, 1]);
    assert_eq!(regions("property int material_index\nproperty int region", rows), second);
    // Names are comments.
    let named_text = text("property int region\nproperty int flags", rows)
        .replace("element face", "comment region 8 the  nose\ncomment region\nelement face");
    assert_eq!(parse(named_text).expect("it is valid").regions, named(["the nose", "region_-1"], vec![0, 0, 1, 0]));
    assert_eq!(regions("property float region\nproperty int flags", rows), Regions::default());
}

/// Whatever the number of elements, each is looked at once.
#[test]
fn many_elements_take_no_long_time() {
    let count = 100_000;
    let elements: String = (0..count).map(|number| format!("element e{number} 1\nproperty uchar x\n")).collect();
    let head = HEAD.replace("end_header", &(elements + "end_header"));
    let text = format!("{head}{SQUARE}4 0 1 2 3\n{}", "7\n".repeat(count));
    let begun = std::time::Instant::now();
    assert_eq!(parse(text).expect("it is valid").triangles.len(), 2);
    assert!(begun.elapsed().as_secs() < 10, "{:?}", begun.elapsed());
}
