//! Wavefront OBJ: odd but valid texts load, wrong ones are refused with the line and the remedy.

use quadmosaic::export::{self, MeshFile, write_mesh};
use quadmosaic::mesh::Mesh;
use quadmosaic::surface::examples::Example;
use quadmosaic::surface::load::{Fault, Format, LoadError, Place, read, read_stream};
use quadmosaic::surface::{Attributes, Regions, Soup};

pub const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

pub fn square() -> Soup {
    Soup {
        points: vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Default::default()
    }
}

fn parse(text: impl AsRef<[u8]>, name: &str) -> Result<Soup, LoadError> {
    read_stream(text.as_ref(), name, Some(Format::Obj))
}

#[test]
fn odd_but_valid_texts_load() {
    let faces = "f 1 2 3\nf 1 3 4";
    let cases = [
        ("plain", format!("{SQUARE}{faces}\n")),
        ("no newline at the end", format!("{SQUARE}{faces}")),
        ("carriage returns", format!("{SQUARE}{faces}\n").replace('\n', "\r\n")),
        ("negative indices", format!("{SQUARE}f -4 -3 -2\nf -4 -2 -1\n")),
        ("negative indices count from the face", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf -3 -2 -1\nv 0 1 0\nf -4 -2 -1\n".into()),
        ("slashes", format!("{SQUARE}vt 0 0\nvn 0 0 1\nf 1/1 2/1/1 3//1\nf 1/ 3/1 4\n")),
        (
            "texture indices that do not exist",
            format!("{SQUARE}vt 0 0\nf 1/9 2/-9223372036854775807 3/1\n{faces}",).replace(faces, "f 1 3 4"),
        ),
        ("texture coordinates that are no numbers", format!("vt u v\nvn x\n{SQUARE}{faces}")),
        ("continued line", format!("{SQUARE}f 1 2 \\\n3\nf \\\n 1 \\\r\n 3 4\n")),
        ("weights", format!("v 0 0 0 2\nv 2 0 0 2.0\nv 1 1 0 1\nv 0 1 0\n{faces}")),
        ("colours", format!("v 0 0 0 1 0 0\nv 1 0 0\nv 1 1 0 0.5 0.5 0.5 1\nv 0 1 0 red green blue\n{faces}")),
        ("materials, smoothing", format!("mtllib none.mtl\n{SQUARE}usemtl\ns 1\nf 1 2 3\nusemtl  \nf 1 3 4\nusemtl c")),
        ("lines and points", format!("{SQUARE}l 1 2 3 4\np 1\nl 1\nl 9 9\n{faces}")),
        ("comments", format!("# head\n#head\n{SQUARE}f 1 2 3 # first\n\n   \nf 1 3 4# second \\\n#f 1\n")),
        ("tabs and blanks", "  v\t0 0  0\nv 1 0 0 \nv 1 1 0\nv 0 1 0\n\tf 1\t2 3\nf  1 3 4".into()),
        ("byte order mark", format!("\u{feff}{SQUARE}{faces}")),
        ("faces first", format!("{faces}\n{SQUARE}")),
        ("exponents", format!("{SQUARE}{faces}").replace("v 1 1 0", "v +1.0E0 10e-1 -.0")),
        ("a quad", format!("{SQUARE}f 1 2 3 4\n")),
    ];
    for (name, text) in cases {
        let soup = parse(&text, name).unwrap_or_else(|error| panic!("{name}: {error}"));
        if name == "a quad" {
            assert_eq!((soup.points, soup.triangles.len()), (square().points, 2));
        } else {
            assert_eq!(Soup { attributes: Attributes::default(), ..soup }, square(), "{name}");
        }
    }
    let latin = [SQUARE.as_bytes(), b"# Fl\xFCgel\nf 1 2 3\nf 1 3 4\n"].concat();
    assert_eq!(parse(&latin, "latin").expect("only a comment is no UTF-8"), square());
}

#[test]
fn vertices_stay_as_the_file_has_them() {
    let soup = parse("v 9 9 9\nv nan 0 0\nv 0 0 0\nv 0 0 0\nv 1 0 0\nf 5 4 3\n", "unused").expect("it is valid");
    assert_eq!(soup.triangles, [[4, 3, 2]]);
    assert_eq!(soup.points.len(), 5);
    assert_eq!(soup.points[0], [9.0; 3]);
    assert!(soup.points[1][0].is_nan(), "no face uses it");
}

/// Faces use the vertices backwards, in groups that share some of them, and two vertices are at one place.
#[test]
fn vertices_keep_the_order_of_the_file() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 1 0\nv 1 1 0\ng a\nf 5 4 2\ng b\nf 3 2 1\n";
    let soup = parse(text, "backwards").expect("it is valid");
    assert_eq!(soup.points, [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]]);
    assert_eq!(soup.triangles, [[4, 3, 1], [2, 1, 0]]);
    let forwards = parse(text.replace("f 3 2 1", "f 1 2 3"), "forwards").expect("it is valid");
    assert_ne!(forwards.triangles, soup.triangles);
}

#[test]
fn coordinates_are_doubles() {
    let third = 1.0 / 3.0;
    let soup = parse(format!("v {third} 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), "thirds").expect("it is valid");
    assert_eq!(soup.points[0][0], third);
    assert_ne!(soup.points[0][0], f64::from(third as f32), "single precision would show");
}

#[test]
fn groups_are_regions() {
    let triangles = ["f 1 2 3", "f 1 3 4", "f 2 3 4"];
    let [a, b, c] = triangles;
    let cases = [
        (format!("{a}\n{b}\n{c}"), "", vec![]),
        (format!("g\n{a}\ng\n{b}\n{c}"), "", vec![]),
        (format!("g all\n{a}\n{b}\n{c}"), "all", vec![0, 0, 0]),
        (format!("{a}\ng nose\n{b}\n{c}"), "|nose", vec![0, 1, 1]),
        (format!("{a}\ng  upper \t skin \n{b}\ng\n{c}"), "|upper skin", vec![0, 1, 0]),
        (format!("g unused\ng b # side\n{a}\ng a\n{b}\ng b\n{c}"), "b|a", vec![0, 1, 0]),
        (format!("o wing\n{a}\no tail\n{b}\n{c}"), "wing|tail", vec![0, 1, 1]),
        (format!("o wing\n{a}\ng skin\n{b}\no tail\n{c}"), "wing|skin", vec![0, 1, 1]),
        (format!("o wing\ng skin\n{a}\no tail\ng tip\n{b}\n{c}"), "skin|tip", vec![0, 1, 1]),
        // A polygon's triangles all have its region.
        ("g b\nf 1 2 3 4\ng a\nf 2 3 4".to_owned(), "b|a", vec![0, 0, 1]),
        ("f 1 2 3 4\ng late".to_owned(), "", vec![]),
        (format!("usemtl steel\n{a}\nusemtl\n{b}\nusemtl  red  rubber\n{c}"), "steel||red rubber", vec![0, 1, 2]),
        (
            format!("o plate\nusemtl steel\n{a}\nusemtl rubber\n{b}\no rim\n{c}"),
            "plate steel|plate rubber|rim rubber",
            vec![0, 1, 2],
        ),
        (format!("o wing\ng skin\n{a}\nusemtl steel\n{b}\ng\n{c}"), "skin|skin steel|steel", vec![0, 1, 2]),
        // Some programs make a group of each material.
        (
            format!("g steel\nusemtl steel\n{a}\ng rubber\nusemtl rubber\n{b}\nusemtlib\n{c}"),
            "steel|rubber",
            vec![0, 1, 1],
        ),
    ];
    for (faces, names, of_face) in cases {
        let names: Vec<_> = if of_face.is_empty() { vec![] } else { names.split('|').map(str::to_owned).collect() };
        let soup = parse(format!("{SQUARE}{faces}\n"), "groups").expect("it is valid");
        assert_eq!(soup.regions, Regions { names, of_face }, "{faces}");
    }
    let latin = [SQUARE.as_bytes(), b"g Fl\xFCgel\nf 1 2 3\n"].concat();
    assert_eq!(parse(&latin, "latin").expect("it is valid").regions.names, ["Fl\u{fffd}gel"]);
}

/// Splitting a polygon that crosses itself could take the cube of its corners in time: it must not take hours.
#[test]
fn faces_of_too_many_corners_are_refused() {
    let points: String = (0..20_001).map(|v| format!("v {} {} 0\n", v * v % 4099, v * 31 % 5003)).collect();
    let face = |corners: usize| (1..=corners).map(|index| format!(" {index}")).collect::<String>();
    let soup = parse(format!("{points}f{}\n", face(3_000)), "wild").expect("no polygon, but small");
    assert_eq!(soup.triangles.len(), 2_998);
    let soup = parse(format!("{points}f{}\n", face(20_000)), "wild").expect("no polygon, but not too large");
    assert_eq!(soup.triangles.len(), 19_998);
    let error = parse(format!("{points}f{}\n", face(20_001)), "wild").expect_err("it is too large").to_string();
    assert_eq!(error, "wild, line 20002: the face has 20001 corners but may have 20000 at most; split it");
}

/// A large text is cut into pieces; whatever its lines are, none may be cut, and numbers go on from piece to piece.
#[test]
fn large_texts_are_read_as_small_ones() {
    let count = 60_000;
    let vertices: String = (0..count).map(|v| format!("v {v} \\ # of {count}\n  {} \\\r\n\t\\\n0\n", v % 7)).collect();
    let faces: String = (1..count - 1)
        .map(|v| match v % 3 {
            0 => format!("f {v} {} \\\n{}\n", v + 1, v + 2),
            1 => format!("g {}\n\nf {v} {} {}\n", v % 5, v + 1, v + 2),
            _ => format!("f {} {} {}\n", v - count - 1, v - count, v - count + 1),
        })
        .collect();
    let text = vertices + &faces;
    assert!(text.len() > 3 << 20, "it would not be cut");
    let soup = parse(&text, "large").expect("it is valid");
    let points: Vec<_> = (0..count).map(|v| [f64::from(v), f64::from(v % 7), 0.0]).collect();
    assert_eq!(soup.points, points);
    assert_eq!(soup.triangles, (0..count as u32 - 2).map(|v| [v, v + 1, v + 2]).collect::<Vec<_>>());
    let region = |triangle: usize| soup.regions.names[soup.regions.of_face[triangle] as usize].as_str();
    assert_eq!([region(0), region(2), region(3), region(50_000)], ["1", "1", "4", "4"]);

    let lines = text.matches('\n').count();
    let wrong = parse(text + "f 1 2 60001\n", "large.obj").expect_err("there is no such vertex").to_string();
    assert!(wrong.contains(&format!("large.obj, line {}: the face uses vertex 60001", lines + 1)), "{wrong}");
}

#[test]
fn concave_polygons_keep_their_area() {
    let text = "v 4 0 0\nv 4 4 0\nv 2 1 0\nv 0 4 0\nv 0 0 0\nv 9 9 9\nf 1 2 3 4 5\nf 1 2 6\n";
    let soup = parse(text, "concave").expect("it is valid");
    assert_eq!(soup.triangles.len(), 4);
    assert_eq!(soup.triangles[3], [0, 1, 5]);
    let doubled = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|index| soup.points[index as usize]);
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    };
    let areas: Vec<f64> = soup.triangles[..3].iter().map(doubled).collect();
    assert!(areas.iter().all(|&area| area > 0.0) && areas.iter().sum::<f64>() == 20.0, "{areas:?}");
}

#[test]
fn wrong_lines_are_named() {
    use Fault::*;
    let word = |word: &str| word.to_owned();
    let long = "7".repeat(50) + "x";
    // Text, line, what is wrong, whether it is the last and has no end.
    let cases = [
        (format!("{SQUARE}v 1 abc 0\nf 1 2 5\n"), 5, NotANumber { word: word("abc") }, false),
        (format!("# head\n\n{SQUARE}v 1,5 0 0\nf 1 2 5\n"), 7, NotANumber { word: word("1,5") }, false),
        (format!("v {long} 0 0\nf 1 1 1\n"), 1, NotANumber { word: "7".repeat(32) + "..." }, false),
        (format!("v nan 0 0\n{SQUARE}f 1 2 3\n"), 1, NotFinite { word: word("nan") }, false),
        (format!("{SQUARE}v 0 -inf 0\nf 1 2 5\n"), 5, NotFinite { word: word("-inf") }, false),
        (format!("{SQUARE}v 0 0 1e400\nf 1 2 5\n"), 5, NotFinite { word: word("1e400") }, false),
        ("v 0 0\nv 1 0\nv 0 1\nf 1 2 3\n".into(), 1, TooFewCoordinates { count: 2 }, false),
        ("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 1".into(), 4, TooFewCoordinates { count: 1 }, true),
        ("v 0 0 0\nv\nf 1 1 1".into(), 2, TooFewCoordinates { count: 0 }, false),
        (format!("{SQUARE}v 1 1 1 0\nf 1 2 5"), 5, ZeroWeight, false),
        (format!("{SQUARE}v 1e300 1 1 1e-300\nf 1 2 5"), 5, ZeroWeight, false),
        (format!("{SQUARE}v 1 1 1 inf\nv 0 0 0 nan\nf 1 2 6\n"), 6, NotFinite { word: word("nan") }, false),
        (format!("{SQUARE}f 1 2 3\nf 1 2 5\nf 1 2 3"), 6, IndexOutOfRange { index: 5, vertices: 4 }, false),
        (format!("{SQUARE}f 1 2 -5\n"), 5, IndexOutOfRange { index: -5, vertices: 4 }, false),
        ("v 0 0 0\nv 1 0 0\nf -1 -2 -3\nv 0 1 0\n".into(), 3, IndexOutOfRange { index: -3, vertices: 2 }, false),
        (format!("{SQUARE}f 1 2 \\\n\n\nf 1 0 2\n"), 5, TooFewIndices { count: 2 }, false),
        (format!("{SQUARE}f 1 2 3\nf 1 0 2\nf 1 2 3\n"), 6, IndexZero, false),
        (format!("{SQUARE}f 1 2 3\nf 1 2"), 6, TooFewIndices { count: 2 }, true),
        (format!("{SQUARE}f 1 2 3\nf\nf 1 2 3\n"), 6, TooFewIndices { count: 0 }, false),
        (format!("{SQUARE}f 1 2 3\nf 1 2 x\nf 1 2 3\n"), 6, NotAnIndex { word: word("x") }, false),
        (format!("{SQUARE}f 1 2 3.0\n"), 5, NotAnIndex { word: word("3.0") }, false),
        (format!("{SQUARE}f 1 2 3 /1\n"), 5, NotAnIndex { word: word("/1") }, false),
        (format!("{SQUARE}f 1 2 3/x\n"), 5, NotAnIndex { word: word("3/x") }, false),
        (format!("{SQUARE}f 1 2 3/1/1/1\n"), 5, NotAnIndex { word: word("3/1/1/1") }, false),
        (format!("v 9 9 9 0\n{SQUARE}f 2 3 4\n"), 1, ZeroWeight, false),
        (format!("{SQUARE}f 1 2 99999999999999999999\n"), 5, NotAnIndex { word: word("99999999999999999999") }, false),
        (format!("{SQUARE}f 1 2 3{}\n", "\r\nf 1 2 7"), 6, IndexOutOfRange { index: 7, vertices: 4 }, false),
    ];
    for (text, line, fault, cut) in cases {
        match parse(&text, "wing.obj") {
            Err(LoadError::At { file, place, fault: why, unended }) => {
                let expected = ("wing.obj", Place::Line(line), fault, cut);
                assert_eq!((file.as_str(), place, why, unended), expected, "{text:?}");
            }
            other => panic!("{text:?}: {other:?}"),
        }
    }
}

#[test]
fn texts_without_a_surface_are_refused() {
    type Expected = fn(&LoadError) -> bool;
    let cases: [(&[u8], Expected); 7] = [
        (b"", |error| matches!(error, LoadError::Empty { .. })),
        (b"\n", |error| matches!(error, LoadError::NoVertices { .. })),
        (b"# nothing here\n", |error| matches!(error, LoadError::NoVertices { .. })),
        (b"int main() { return 0; }\n", |error| matches!(error, LoadError::NoVertices { .. })),
        (b"v 0 0 0\nv 1 0 0\nv 0 1 0\n", |error| matches!(error, LoadError::NoFaces { vertices: 3, .. })),
        (b"v 0 0 0\nl 1 1 1\n", |error| matches!(error, LoadError::NoFaces { vertices: 1, .. })),
        (b"v 0 0 0\nf 1 1 1\n\0\xFF", |error| matches!(error, LoadError::Binary { offset: 16, .. })),
    ];
    for (text, expected) in cases {
        let error = parse(text, "wing.obj").expect_err("there is no surface");
        assert!(expected(&error), "{error:?}");
        assert!(error.to_string().starts_with("wing.obj "), "{error}");
    }
}

#[test]
fn messages_say_what_where_and_what_to_do() {
    let message = |text: &str| parse(text, "wing.obj").expect_err("it is wrong").to_string();
    assert_eq!(
        message("v 0 0 abc\nv 1 0 0\nf 1 2 2\n"),
        "wing.obj, line 1: the coordinate \"abc\" is not a number; write it like 0.25 or 2.5e-1"
    );
    assert_eq!(
        message("v 0 0 0\nf 1 1"),
        "wing.obj, line 2: the face has 2 corners but needs at least 3; complete it or take it out; \
         it is the last line and has no end, so the file may be cut off"
    );
    // Whatever a file holds, the message is one line of plain text.
    assert!(!message("v 0 0 \u{1b}[31m\n").contains('\u{1b}'));
}

#[test]
fn what_is_written_is_read_again() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("torus.obj");
    let soup = Example::Torus.generate(2_000);
    write_mesh(&path, export::Format::Obj, &MeshFile::from(&Mesh::from(soup.clone()))).expect("it can be written");
    let again = read(&path).expect("it can be read");
    assert_eq!(again.triangles.len(), soup.triangles.len());
    let corners = |soup: &Soup| -> Vec<[f64; 3]> {
        soup.triangles.iter().flatten().map(|&index| soup.points[index as usize]).collect()
    };
    assert_eq!(corners(&soup), corners(&again));
}
