//! Reading Wavefront OBJ: odd but valid files load, wrong ones are refused with the file, the line and the remedy.

use std::fs;
use std::path::Path;

use quadmosaic::export::write_soup;
use quadmosaic::surface::Soup;
use quadmosaic::surface::examples::Example;
use quadmosaic::surface::load::{LineFault, LoadError, parse_obj, read};

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

fn square() -> Soup {
    Soup {
        points: vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
    }
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
        (
            "groups, materials, smoothing",
            format!("mtllib none.mtl\n{SQUARE}o a\ng b\nusemtl c\ns 1\nf 1 2 3\ng d\nusemtl\nf 1 3 4"),
        ),
        ("lines and points", format!("{SQUARE}l 1 2 3 4\np 1\nl 1\nl 9 9\n{faces}")),
        ("comments", format!("# head\n#head\n{SQUARE}f 1 2 3 # first\n\n   \nf 1 3 4# second \\\n#f 1\n")),
        ("tabs and blanks", "  v\t0 0  0\nv 1 0 0 \nv 1 1 0\nv 0 1 0\n\tf 1\t2 3\nf  1 3 4".into()),
        ("byte order mark", format!("\u{feff}{SQUARE}{faces}")),
        ("faces first", format!("{faces}\n{SQUARE}")),
        ("exponents", format!("{SQUARE}{faces}").replace("v 1 1 0", "v +1.0E0 10e-1 -.0")),
        ("unused vertices, one of them not finite", format!("{SQUARE}v 9 9 9\nv nan 0 0\n{faces}")),
        ("a quad", format!("{SQUARE}f 1 2 3 4\n")),
    ];
    for (name, text) in cases {
        let soup = parse_obj(text.as_bytes(), name).unwrap_or_else(|error| panic!("{name}: {error}"));
        if name == "a quad" {
            assert_eq!((soup.points, soup.triangles.len()), (square().points, 2));
        } else {
            assert_eq!(soup, square(), "{name}");
        }
    }
    let latin = [SQUARE.as_bytes(), b"# Fl\xFCgel\ng \xE4\nf 1 2 3\nf 1 3 4\n"].concat();
    assert_eq!(parse_obj(&latin, "latin").expect("only a comment is no UTF-8"), square());
}

#[test]
fn concave_polygons_keep_their_area() {
    let text = "v 4 0 0\nv 4 4 0\nv 2 1 0\nv 0 4 0\nv 0 0 0\nv 9 9 9\nf 1 2 3 4 5\nf 1 2 6\n";
    let soup = parse_obj(text.as_bytes(), "concave").expect("it is valid");
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
    use LineFault::*;
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
        (format!("{SQUARE}f 1 2 99999999999999999999\n"), 5, NotAnIndex { word: word("99999999999999999999") }, false),
        (format!("{SQUARE}f 1 2 3{}\n", "\r\nf 1 2 7"), 6, IndexOutOfRange { index: 7, vertices: 4 }, false),
    ];
    for (text, line, fault, cut) in cases {
        match parse_obj(text.as_bytes(), "wing.obj") {
            Err(LoadError::Line { file, line: found, fault: why, unended }) => {
                assert_eq!((file.as_str(), found, why, unended), ("wing.obj", line, fault, cut), "{text:?}");
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
        (b"solid wing\nfacet normal 0 0 1\nendsolid\n", |error| matches!(error, LoadError::NoVertices { .. })),
        (b"v 0 0 0\nv 1 0 0\nv 0 1 0\n", |error| matches!(error, LoadError::NoFaces { vertices: 3, .. })),
        (b"v 0 0 0\nl 1 1 1\n", |error| matches!(error, LoadError::NoFaces { vertices: 1, .. })),
        (b"v 0 0 0\nf 1 1 1\n\0\xFF", |error| matches!(error, LoadError::Binary { offset: 16, .. })),
    ];
    for (text, expected) in cases {
        let error = parse_obj(text, "wing.obj").expect_err("there is no surface");
        assert!(expected(&error), "{error:?}");
        assert!(error.to_string().starts_with("wing.obj "), "{error}");
    }
}

#[test]
fn messages_say_what_where_and_what_to_do() {
    let message = |text: &str| parse_obj(text.as_bytes(), "wing.obj").expect_err("it is wrong").to_string();
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
fn paths_that_cannot_be_read_are_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = |name: &str| folder.path().join(name);
    assert!(matches!(read(folder.path()), Err(LoadError::Directory { .. })));
    assert!(matches!(read(&path("none.obj")), Err(LoadError::Missing { .. })));
    fs::write(path("wing.stl"), "solid").expect("it can be written");
    assert!(matches!(read(&path("wing.stl")), Err(LoadError::UnknownFormat { .. })));
    fs::write(path("empty.obj"), "").expect("it can be written");
    assert!(matches!(read(&path("empty.obj")), Err(LoadError::Empty { .. })));
    fs::write(path("wing.OBJ"), format!("{SQUARE}f 1 2 3\nf 1 3 4\n")).expect("it can be written");
    assert_eq!(read(&path("wing.OBJ")).expect("it is good"), square());
}

#[test]
fn what_is_written_is_read_again() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("torus.obj");
    let soup = Example::Torus.generate(2_000);
    write_soup(&path, &soup).expect("it can be written");
    let again = read(&path).expect("it can be read");
    assert_eq!(again.triangles.len(), soup.triangles.len());
    let corners = |soup: &Soup| -> Vec<[f64; 3]> {
        soup.triangles.iter().flatten().map(|&index| soup.points[index as usize]).collect()
    };
    for (a, b) in corners(&soup).iter().flatten().zip(corners(&again).iter().flatten()) {
        // Nine digits of coordinates up to 1.4: half a unit of the ninth.
        assert!((a - b).abs() <= 5e-9, "{a} became {b}");
    }
}

/// Every bad file either gives a finite surface or is refused with a message that names it.
#[test]
fn bad_folder() {
    let Ok(entries) = fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/bad")) else {
        println!("SKIPPED load::bad_folder: ../shared/bad is not here");
        return;
    };
    const REFUSED: [(&str, &str); 14] = [
        ("binary_junk", "not a text file"),
        ("empty", "is empty"),
        ("garbage_number", "line 1: the coordinate \"zero\" is not a number"),
        ("index_out_of_range", "line 4: the face uses vertex 7, but there are 3"),
        ("index_too_few", "line 3: the face has 2 corners"),
        ("index_zero", "line 4: the face uses vertex 0"),
        ("inf", "line 2: the coordinate \"inf\" is not finite"),
        ("nan", "line 2: the coordinate \"nan\" is not finite"),
        ("only_comment", "no vertices"),
        ("only_vertices", "no faces"),
        ("overflow", "line 2: the coordinate \"1e400\" is not finite"),
        ("short_vertex", "line 1: the vertex has 2 of 3 coordinates"),
        ("truncated", "line 6: the face has 2 corners"),
        ("truncated", "may be cut off"),
    ];
    let (mut loaded, mut refused) = (0, Vec::new());
    for entry in entries {
        let path = entry.expect("it can be listed").path();
        let Some(stem) = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()) else { continue };
        if path.extension().is_none_or(|ending| ending != "obj") {
            continue;
        }
        match read(&path) {
            Ok(soup) => {
                assert!(!soup.triangles.is_empty() && soup.points.iter().flatten().all(|number| number.is_finite()));
                assert!(soup.triangles.iter().flatten().all(|&index| (index as usize) < soup.points.len()));
                loaded += 1;
            }
            Err(error) => {
                let message = error.to_string();
                println!("{message}");
                assert!(message.contains(&format!("{stem}.obj")));
                let parts: Vec<_> = REFUSED.iter().filter(|(name, _)| *name == stem).collect();
                assert!(!parts.is_empty(), "{stem} is refused though it is readable: {message}");
                assert!(parts.iter().all(|(_, part)| message.contains(part)), "{stem}: {message}");
                refused.push(stem);
            }
        }
    }
    assert_eq!(refused.len(), 13, "refused only {refused:?}");
    assert!(loaded > 40, "only {loaded} files loaded");
}
