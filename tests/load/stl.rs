//! STL, binary and ASCII.

use quadmosaic::surface::load::{Fault, Format, LoadError, Place, read_stream};
use quadmosaic::surface::{Regions, Soup};

type Triangle = [[f32; 3]; 3];

const PAIR: [Triangle; 2] =
    [[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [-0.0, 1.0, -0.0]]];

/// A binary file. Its normals are not finite and its attributes not zero: nobody is to look at them.
pub fn binary(head: &[u8], triangles: &[Triangle]) -> Vec<u8> {
    let mut bytes = head.to_vec();
    bytes.resize(80, 0);
    bytes.extend((triangles.len() as u32).to_le_bytes());
    for triangle in triangles {
        bytes.extend([f32::NAN; 3].into_iter().flat_map(f32::to_le_bytes));
        bytes.extend(triangle.iter().flatten().flat_map(|number| number.to_le_bytes()));
        bytes.extend([7, 0]);
    }
    bytes
}

/// An ASCII file of several solids.
pub fn ascii(solids: &[(&str, &[Triangle])]) -> String {
    let facet = |triangle: &Triangle| {
        let vertices = triangle.map(|[x, y, z]| format!("      vertex {x:e} {y} {z}\n")).concat();
        format!("  facet normal 0 0 0\n    outer loop\n{vertices}    endloop\n  endfacet\n")
    };
    let solid = |(name, triangles): &(&str, &[Triangle])| {
        let facets: String = triangles.iter().map(facet).collect();
        format!("solid {name}\n{facets}endsolid {name}\n")
    };
    solids.iter().map(solid).collect()
}

fn parse(bytes: impl AsRef<[u8]>) -> Result<Soup, LoadError> {
    read_stream(bytes.as_ref(), "wing.stl", Some(Format::Stl))
}

fn pair() -> Soup {
    let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
    Soup { points, triangles: vec![[0, 1, 2], [1, 3, 2]], ..Default::default() }
}

#[test]
fn corners_at_the_same_point_are_one_vertex() {
    assert_eq!(parse(binary(b"", &PAIR)).expect("it is valid"), pair());
    assert_eq!(parse(ascii(&[("", &PAIR)])).expect("it is valid"), pair());
    let mut apart = PAIR;
    apart[1][0][0] = 1.0 + f32::EPSILON;
    assert_eq!(parse(binary(b"", &apart)).expect("it is valid").points.len(), 5);
}

#[test]
fn odd_but_valid_texts_load() {
    let plain = ascii(&[("", &PAIR)]);
    for (name, text) in [
        ("carriage returns", plain.replace('\n', "\r\n")),
        ("upper case", plain.to_uppercase()),
        ("no blanks before words", plain.replace("  ", "")),
        ("few lines", plain.replace("\n    outer", " outer").replace("\n      vertex", " vertex")),
        ("blank lines", plain.replace('\n', "\n\n \n")),
        ("a byte order mark", format!("\u{feff}\n{plain}")),
        ("no line end", plain.trim_end().to_owned()),
        ("normals that are no numbers", plain.replace("normal 0 0 0", "normal -nan(ind) x 1.#QNAN")),
        ("one line", plain.replace('\n', " ")),
        ("carriage returns alone", plain.replace('\n', "\r")),
        ("no endfacet", plain.replace("  endfacet\n", "")),
    ] {
        assert_eq!(parse(text).unwrap_or_else(|error| panic!("{name}: {error}")), pair(), "{name}");
    }
    let precise = ascii(&[("", &PAIR)]).replace("1e0", "0.1234567890123456");
    assert!(parse(precise).expect("it is valid").points.contains(&[0.1234567890123456, 0.0, 0.0]));
}

#[test]
fn solids_are_regions() {
    let [first, second] = [&PAIR[..1], &PAIR[1..]];
    let cases = [
        (ascii(&[("", first), ("", second)]), vec![], vec![]),
        (ascii(&[("wing", &PAIR)]), vec!["wing"], vec![0, 0]),
        (ascii(&[("upper  skin", first), ("", second)]), vec!["upper skin", ""], vec![0, 1]),
        (ascii(&[("none", &[]), ("a", second), ("b", first), ("a", first)]), vec!["a", "b"], vec![0, 1, 0]),
    ];
    for (text, names, of_face) in cases {
        let names = names.into_iter().map(str::to_owned).collect();
        assert_eq!(parse(&text).expect("it is valid").regions, Regions { names, of_face }, "{text}");
    }
    assert_eq!(parse(binary(b"solid wing", &PAIR)).expect("it is valid").regions, Regions::default());
}

/// Also where names hold words that mean something elsewhere, and where the end repeats no name.
#[test]
fn solids_may_stand_on_one_line() {
    let text = ascii(&[("Body 1; mm", &PAIR[..1]), ("a solid facet", &PAIR[1..])]);
    let whole = parse(&text).expect("it is valid");
    assert_eq!(
        whole.regions,
        Regions { names: vec!["Body 1; mm".into(), "a solid facet".into()], of_face: vec![0, 1] }
    );
    assert_eq!(parse(text.replace('\n', " ")).expect("it is valid"), whole);
    let unnamed = text.replace("endsolid Body 1; mm", "endsolid").replace('\n', "\t");
    assert_eq!(parse(unnamed).expect("it is valid"), whole);
    let open = text.replace("endsolid a solid facet", "").replace('\n', " ");
    assert!(matches!(parse(open), Err(LoadError::At { fault: Fault::EndlessSolid, .. })));
}

#[test]
fn binary_files_of_the_wrong_size_are_refused() {
    let good = binary(b"solid", &[PAIR[0]; 9]);
    let promising = |count: u32| {
        let mut bytes = good.clone();
        bytes[80..84].copy_from_slice(&count.to_le_bytes());
        bytes
    };
    for (bytes, message) in [
        (good[..good.len() - 1].to_vec(), "is cut off: the header says 9 triangles, but the file ends after 8;"),
        (good[..100].to_vec(), "is cut off: the header says 9 triangles, but the file ends after 0;"),
        (promising(u32::MAX), "the header says 4294967295 triangles, but the file ends after 9;"),
        (promising(7), "the header says 7 triangles, but 100 bytes follow them"),
        (promising(0), "the header says 0 triangles, but 450 bytes follow them"),
        (good[..83].to_vec(), "the file ends within the header"),
        (binary(b"", &[]), "has no vertices"),
    ] {
        let error = parse(&bytes).expect_err("its size is wrong").to_string();
        assert!(error.starts_with("wing.stl") && error.contains(message), "{error}");
    }
    // Padding is no triangle, but what is neither zero nor blank may be the rest of one.
    let padded = |byte: u8| [&good[..], &[byte; 49]].concat();
    for byte in [0, b'\n'] {
        assert_eq!(parse(padded(byte)).expect("it is valid").triangles.len(), 9);
    }
    let error = parse(padded(7)).expect_err("it goes on").to_string();
    assert!(error.contains("the header says 9 triangles, but 49 bytes follow them"), "{error}");
}

/// Also without a format asked for, and without `solid`, what is left of a file is known to be STL.
#[test]
fn cut_binary_files_are_recognised() {
    let finite = |head: &[u8]| {
        let mut bytes = binary(head, &[PAIR[0]; 9]);
        bytes[84..].chunks_exact_mut(50).for_each(|triangle| triangle[..12].fill(0));
        bytes
    };
    for head in [&b"solid"[..], b"made by hand"] {
        let bytes = finite(head);
        let error = read_stream(&bytes[..bytes.len() - 60], "wing", None).expect_err("it is cut off").to_string();
        assert!(error.contains("the header says 9 triangles, but the file ends after 7"), "{error}");
    }
    let mut junk = finite(b"made by hand");
    junk[84..]
        .iter_mut()
        .zip(0_u32..)
        .for_each(|(byte, place)| *byte = (place.wrapping_mul(2_654_435_761) >> 13) as u8);
    assert!(matches!(read_stream(&junk[1..], "junk", None), Err(LoadError::Binary { .. })));
}

#[test]
fn wrong_places_are_named() {
    let mut bytes = binary(b"", &PAIR);
    bytes[84 + 50 + 12 + 4..][..4].copy_from_slice(&f32::INFINITY.to_le_bytes());
    let error = parse(&bytes).expect_err("a coordinate is infinite").to_string();
    let place = "wing.stl, triangle 1 (counted from 0) at byte 134: the coordinate \"inf\" is not finite";
    assert!(error.starts_with(place), "{error}");

    use Fault::*;
    let word = |word: &str| word.to_owned();
    let text = ascii(&[("wing", &PAIR)]);
    for (wrong, line, fault, cut) in [
        (text.replace("1e0 1 0", "1e0 nan 0"), 12, NotFinite { word: word("nan") }, false),
        (text.replace("1e0 1 0", "1e0 1 1e999"), 12, NotFinite { word: word("1e999") }, false),
        (text.replace("1e0 1 0", "1e0 1,5 0"), 12, NotANumber { word: word("1,5") }, false),
        (text.replace("1e0 1 0", "1e0"), 12, TooFewCoordinates { count: 1 }, false),
        (text.replace("      vertex 1e0 1 0\n", ""), 14, NotATriangle { count: 2 }, false),
        (text.replace("vertex 1e0 1 0", "vertex 0 0 0\nvertex 0 1 0"), 16, NotATriangle { count: 4 }, false),
        (text.replace("vertex 1e0 1 0", "vortex 1e0 1 0"), 12, UnknownWord { word: word("vortex") }, false),
        (text.replace("endsolid wing\n", ""), 1, EndlessSolid, false),
        (text.replace("  endfacet\nendsolid wing\n", "  endfa"), 15, UnknownWord { word: word("endfa") }, true),
    ] {
        match parse(&wrong) {
            Err(LoadError::At { file, place, fault: why, unended }) => {
                let expected = ("wing.stl", Place::Line(line), fault, cut);
                assert_eq!((file.as_str(), place, why, unended), expected, "{wrong}");
            }
            other => panic!("{wrong}: {other:?}"),
        }
    }
}

#[test]
fn a_facet_outside_of_solids_is_ended_by_the_file() {
    let facet = "vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n";
    let part = "vertex 0 0 0\nvertex 1 0 0\n";
    for before in [String::new(), ascii(&[("wing", &PAIR)])] {
        let count = if before.is_empty() { 0 } else { 2 };
        let soup = parse(before.clone() + facet).expect("it is whole");
        assert_eq!(soup.triangles.len(), count + 1);
        let line = before.lines().count() + 2;
        match parse(before + part) {
            Err(LoadError::At { place: Place::Line(place), fault: Fault::NotATriangle { count: 2 }, .. }) => {
                assert_eq!(place, line)
            }
            other => panic!("{other:?}"),
        }
    }
}
