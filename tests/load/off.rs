//! OFF.

use quadmosaic::surface::Soup;
use quadmosaic::surface::load::{Fault, Format, LoadError, Place, read_stream};

pub fn ascii(points: &[[f32; 3]], faces: &[[u32; 3]]) -> String {
    let mut text = format!("OFF\n# made by hand\n{} {} 0\n", points.len(), faces.len());
    for [x, y, z] in points {
        text += &format!("{x} {y} {:e}\n", f64::from(*z));
    }
    for [a, b, c] in faces {
        text += &format!("3  {a} {b} {c}\n");
    }
    text
}

const SQUARE: &str = "OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";

fn parse(text: impl AsRef<[u8]>) -> Result<Soup, LoadError> {
    read_stream(text.as_ref(), "wing.off", Some(Format::Off))
}

#[test]
fn odd_but_valid_texts_load() {
    let whole = parse(SQUARE).expect("it is valid");
    assert_eq!((whole.points.len(), whole.triangles.len()), (4, 2), "polygons are triangulated");
    for (name, text) in [
        ("carriage returns", SQUARE.replace('\n', "\r\n")),
        ("comments and blank lines", SQUARE.replace('\n', " # here\n\n# there\n")),
        ("counts behind the word", SQUARE.replace("OFF\n", "OFF ")),
        ("counts glued to the word", SQUARE.replace("OFF\n", "OFF")),
        ("no word", SQUARE.replace("OFF\n", "")),
        ("no number of edges", SQUARE.replace("4 1 0", "4 1")),
        (
            "colours",
            SQUARE.replace("OFF", "COFF").replace("0 0\n", "0 0 255 0 0 255\n").replace("2 3", "2 3 3 0.1 0.2 0.3"),
        ),
        (
            "normals",
            SQUARE
                .replace("OFF", "STCNOFF")
                .replace("1 0\n", "1 0 0 0 1 0.5 0.5\n")
                .replace("4 1 0 0 0 1 0.5 0.5", "4 1 0"),
        ),
        ("no line end", SQUARE.trim_end().to_owned()),
        ("more after the end", SQUARE.to_owned() + "and so on\n"),
    ] {
        assert_eq!(parse(text).unwrap_or_else(|error| panic!("{name}: {error}")), whole, "{name}");
    }
    let unused = SQUARE.replace("4 1 0\n", "5 1 0\nnan nan inf\n").replace("4 0 1 2 3", "4 1 2 3 4");
    assert_eq!(parse(unused).expect("no face uses the vertex without a place").points.len(), 5);
}

#[test]
fn wrong_lines_are_named() {
    use Fault::*;
    let word = |word: &str| word.to_owned();
    let lacks = HeaderLacks { what: "the numbers of vertices and of faces" };
    for (from, to, line, fault) in [
        ("4 1 0", "4", 2, lacks),
        ("4 1 0", "4 -1 0", 2, NotACount { count: word("-1") }),
        ("1 1 0", "1 x 0", 5, NotANumber { word: word("x") }),
        ("1 1 0", "1 1", 5, TooFewCoordinates { count: 2 }),
        ("1 1 0", "1 1e999 0", 5, NotFinite { word: word("1e999") }),
        ("2 3", "2 4", 7, NoSuchVertex { index: 4.0, vertices: 4 }),
        ("2 3", "2 -1", 7, NoSuchVertex { index: -1.0, vertices: 4 }),
        ("2 3", "2", 7, WrongRow { more: false }),
        ("4 0 1 2 3", "2 0 1", 7, TooFewIndices { count: 2 }),
        ("4 0 1 2 3", "four 0 1 2 3", 7, NotACount { count: word("four") }),
        ("4 0 1 2 3", "4000000000 0 1 2 3", 7, WrongRow { more: false }),
    ] {
        assert!(SQUARE.contains(from));
        match parse(SQUARE.replacen(from, to, 1)) {
            Err(LoadError::At { place, fault: why, .. }) => {
                assert_eq!((place, why), (Place::Line(line), fault), "{to}")
            }
            other => panic!("{to}: {other:?}"),
        }
    }
}

#[test]
fn what_is_not_there_or_not_read_is_told() {
    for (from, to, message) in [
        ("4 1 0", "4 99999999999 0", "the header says 99999999999 faces, but the file ends after 1;"),
        ("4 1 0", "99999999999 1 0", "the header says 99999999999 vertices, but the file ends after 5"),
        ("4 1 0", "4 0 0", "has 4 vertices but no faces"),
        ("4 1 0", "0 0 0", "has no vertices"),
        ("OFF", "OFF BINARY", "is not read; export it in ASCII"),
        ("OFF", "4OFF", "is not read; export it in ASCII"),
    ] {
        let error = parse(SQUARE.replacen(from, to, 1)).expect_err(to).to_string();
        assert!(error.starts_with("wing.off") && error.contains(message), "{error}");
    }
}
