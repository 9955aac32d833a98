//! MSH of Gmsh.

use quadmosaic::surface::load::{Fault, Format, LoadError, Place, read_stream};
use quadmosaic::surface::{Regions, Soup};

/// How numbers are written.
#[derive(Clone, Copy, PartialEq)]
pub enum Encoding {
    Ascii,
    Little,
    Big,
}

pub const ENCODINGS: [Encoding; 3] = [Encoding::Ascii, Encoding::Little, Encoding::Big];

/// A file that is being written.
struct Writer {
    bytes: Vec<u8>,
    encoding: Encoding,
}

impl Writer {
    fn text(&mut self, text: &str) {
        self.bytes.extend(text.as_bytes());
    }

    fn number(&mut self, text: String, mut little: Vec<u8>) {
        match self.encoding {
            Encoding::Ascii => self.bytes.extend((text + " ").into_bytes()),
            Encoding::Little => self.bytes.extend(little),
            Encoding::Big => {
                little.reverse();
                self.bytes.extend(little);
            }
        }
    }

    fn ints(&mut self, numbers: &[i32]) {
        numbers.iter().for_each(|number| self.number(number.to_string(), number.to_le_bytes().into()));
    }

    fn sizes(&mut self, numbers: &[u64]) {
        numbers.iter().for_each(|number| self.number(number.to_string(), number.to_le_bytes().into()));
    }

    fn floats(&mut self, numbers: &[f64]) {
        numbers.iter().for_each(|number| self.number(format!("{number:e}"), number.to_le_bytes().into()));
    }

    fn end_line(&mut self) {
        if self.encoding == Encoding::Ascii {
            self.text("\n");
        }
    }
}

fn begun(version: &str, encoding: Encoding) -> Writer {
    let mut file = Writer { bytes: Vec::new(), encoding };
    file.text(&format!("$MeshFormat\n{version} {} 8\n", i32::from(encoding != Encoding::Ascii)));
    if encoding != Encoding::Ascii {
        file.ints(&[1]);
        file.text("\n");
    }
    file.text("$EndMeshFormat\n$Comments\nmade by hand $ 1\n$EndComments\n");
    file.text("$PhysicalNames\n3\n1 7 \"rim\"\n2 7 \"upper skin\"\n2 8 \"tip\"\n$EndPhysicalNames\n");
    file
}

/// A line, then the faces, the first half of them in the physical group 7 and the others in none. Tags of nodes are 10 apart.
pub fn two(points: &[[f32; 3]], faces: &[&[u32]], encoding: Encoding) -> Vec<u8> {
    let mut file = begun("2.2", encoding);
    file.text(&format!("$Nodes\n{}\n", points.len()));
    for (point, tag) in points.iter().zip(1..) {
        file.ints(&[10 * tag]);
        file.floats(&point.map(f64::from));
        file.end_line();
    }
    file.text(&format!("\n$EndNodes\n$Elements\n{}\n", faces.len() + 1));
    let mut element = |number: usize, kind: i32, group: i32, nodes: &[u32]| {
        let number = number as i32;
        file.ints(&if encoding == Encoding::Ascii {
            vec![number, kind, 2, group, 1]
        } else {
            vec![kind, 1, 2, number, group, 1]
        });
        nodes.iter().for_each(|&node| file.ints(&[10 * (node as i32 + 1)]));
        file.end_line();
    };
    element(1, 1, 7, &[0, 1]);
    for (number, face) in faces.iter().enumerate() {
        element(number + 2, if face.len() == 3 { 2 } else { 3 }, if number < faces.len() / 2 { 7 } else { 0 }, face);
    }
    file.text("\n$EndElements\n");
    file.bytes
}

/// The same, each face a surface of its own, which may be in several groups.
pub fn four(points: &[[f32; 3]], faces: &[&[u32]], groups: &[&[i32]], encoding: Encoding) -> Vec<u8> {
    let mut file = begun("4.1", encoding);
    file.text("$Entities\n");
    file.sizes(&[1, 1, faces.len() as u64, 0]);
    file.end_line();
    file.ints(&[1]);
    file.floats(&[0.0; 3]);
    file.sizes(&[0]);
    file.end_line();
    for surface in 0..=faces.len() {
        file.ints(&[surface.max(1) as i32]);
        file.floats(&[0.0; 6]);
        let groups = if surface == 0 { &[7] } else { groups.get(surface - 1).copied().unwrap_or_default() };
        file.sizes(&[groups.len() as u64]);
        file.ints(groups);
        file.sizes(&[2]);
        file.ints(&[1, -1]);
        file.end_line();
    }
    file.text("\n$EndEntities\n$Nodes\n");
    let (first, others) = points.split_at(1);
    file.sizes(&[2, points.len() as u64, 10, 10 * points.len() as u64]);
    file.end_line();
    let mut tag = 0;
    for (block, dimension) in [(first, 0), (others, 2)] {
        file.ints(&[dimension, 1, i32::from(dimension == 2)]);
        file.sizes(&[block.len() as u64]);
        file.end_line();
        for _ in block {
            tag += 10;
            file.sizes(&[tag]);
        }
        file.end_line();
        for point in block {
            file.floats(&point.map(f64::from));
            file.floats(&[0.5, 0.25][..dimension as usize]);
            file.end_line();
        }
    }
    file.text("\n$EndNodes\n$Elements\n");
    file.sizes(&[faces.len() as u64 + 1, faces.len() as u64 + 1, 1, faces.len() as u64 + 1]);
    file.end_line();
    file.ints(&[1, 1, 1]);
    file.sizes(&[1, 1, 10, 20]);
    file.end_line();
    for (face, tag) in faces.iter().zip(1..) {
        file.ints(&[2, tag, if face.len() == 3 { 2 } else { 3 }]);
        file.sizes(&[1, tag as u64 + 1]);
        face.iter().for_each(|&node| file.sizes(&[10 * (u64::from(node) + 1)]));
        file.end_line();
    }
    file.text("\n$EndElements\n");
    file.bytes
}

const POINTS: [[f32; 3]; 5] = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.5, 2.0, 0.0]];
const FACES: [&[u32]; 2] = [&[0, 1, 2, 3], &[3, 2, 4]];

fn parse(bytes: impl AsRef<[u8]>) -> Result<Soup, LoadError> {
    read_stream(bytes.as_ref(), "wing.msh", Some(Format::Msh))
}

fn named(names: &[&str], of_face: &[u32]) -> Regions {
    Regions { names: names.iter().map(|&name| name.to_owned()).collect(), of_face: of_face.to_vec() }
}

#[test]
fn physical_groups_are_regions() {
    for encoding in ENCODINGS {
        let soup = parse(two(&POINTS, &FACES, encoding)).expect("it is valid");
        assert_eq!((soup.points.len(), soup.triangles.len()), (5, 3));
        assert_eq!(soup.triangles[2], [3, 2, 4]);
        assert_eq!(soup.regions, named(&["upper skin", ""], &[0, 0, 1]));
        let regions = |groups: &[&[i32]]| parse(four(&POINTS, &FACES, groups, encoding)).expect("it is valid").regions;
        assert_eq!(regions(&[&[7], &[-8]]), named(&["upper skin", "tip"], &[0, 0, 1]));
        assert_eq!(regions(&[&[7, 9], &[7]]), named(&["upper skin physical_9", "upper skin"], &[0, 0, 1]));
        assert_eq!(regions(&[&[9], &[10]]), named(&["physical_9", "physical_10"], &[0, 0, 1]));
        assert_eq!(regions(&[&[], &[]]), Regions::default());
    }
}

/// MSH 2.2 has a face once for each of its groups.
#[test]
fn a_face_in_two_groups_is_one() {
    let text = String::from_utf8(two(&POINTS, &FACES, Encoding::Ascii)).expect("it is text");
    let thrice = text.replace("3 2 2 0 1 40 30 50 ", "3 2 2 7 1 40 30 50\n4 2 2 8 1 40 30 50\n5 2 2 9 1 40 30 50");
    let soup = parse(thrice.replace("Elements\n3", "Elements\n5")).expect("it is valid");
    assert_eq!(soup.triangles.len(), 3);
    assert_eq!(soup.regions, named(&["upper skin", "upper skin tip physical_9"], &[0, 0, 1]));
    let turned = text.replace("3 2 2 0 1 40 30 50 ", "3 2 2 7 1 40 30 50\n4 2 2 8 1 30 50 40");
    let soup = parse(turned.replace("Elements\n3", "Elements\n4")).expect("it is valid");
    assert_eq!(soup.triangles.len(), 4, "other corners, or another first one, are another face");
}

#[test]
fn faces_of_higher_order_have_their_corners() {
    let text = String::from_utf8(two(&POINTS, &FACES, Encoding::Ascii)).expect("it is text");
    let plain = parse(&text).expect("it is valid");
    let second = text.replace("3 2 2 0 1 40 30 50", "3 9 2 0 1 40 30 50 10 20 10");
    assert_ne!(second, text);
    assert_eq!(parse(second).expect("it is valid"), plain);
}

#[test]
fn wrong_places_are_named() {
    use Fault::*;
    let text = String::from_utf8(two(&POINTS, &FACES, Encoding::Ascii)).expect("it is text");
    let word = |word: &str| word.to_owned();
    for (from, to, line, fault) in [
        ("40 30 50", "40 30 60", 26, NoSuchNode { tag: 60.0 }),
        ("40 30 50", "40 30 x", 26, NotAValue { word: word("x") }),
        ("5e-1 2e0", "5e-1 inf", 19, NotFinite { word: word("inf") }),
        ("5e-1 2e0", "5e-1 2e0 9", 19, WrongWord { word: word("0e0"), wanted: word("$EndNodes") }),
        ("$Nodes\n5", "$Nodes\n-5", 14, NotACount { count: word("-5") }),
        ("$Nodes\n5", "$Nodes\n4", 19, WrongWord { word: word("50"), wanted: word("$EndNodes") }),
        ("$EndElements", "$EndNodes", 28, WrongWord { word: word("$EndNodes"), wanted: word("$EndElements") }),
        ("$Comments", "Comments", 4, WrongWord { word: word("Comments"), wanted: word("a section such as $Nodes") }),
        ("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n", "", 11, HeaderLacks { what: "a section $MeshFormat" }),
    ] {
        assert!(text.contains(from), "{from}");
        match parse(text.replacen(from, to, 1)) {
            Err(LoadError::At { place, fault: why, .. }) => {
                assert_eq!((place, why), (Place::Line(line), fault), "{to}")
            }
            other => panic!("{to}: {other:?}"),
        }
    }
    let cut = parse(text.replace("$EndElements\n", "")).expect_err("it is cut off").to_string();
    assert_eq!(cut, "wing.msh ends within $Elements; copy or export it again");
    for (from, to, message) in [
        ("2.2 0 8", "4 0 8", "line 2: version \"4\" of MSH is not read; write it as 4.1 or 2.2"),
        ("2.2 0 8", "2.2 0 4", "line 2: MSH with numbers of 4 bytes is not read"),
        ("$Nodes\n5", "$Nodes\n4000000000000", "line 21: the value \"$EndNodes\" is not a number"),
        ("3 2 2 0 1 40 30 50", "3 4 2 0 1 40 30 50 10", ""),
    ] {
        let result = parse(text.replacen(from, to, 1));
        match message {
            "" => assert_eq!(result.expect("a volume is passed over").triangles.len(), 2),
            _ => assert!(result.as_ref().expect_err(to).to_string().contains(message), "{result:?}"),
        }
    }
    assert!(matches!(parse("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"), Err(LoadError::NoVertices { .. })));
}

/// The promises of a binary file cost neither memory nor time.
#[test]
fn wrong_places_of_binary_files_are_named() {
    for encoding in [Encoding::Little, Encoding::Big] {
        let message = |bytes: Vec<u8>| parse(bytes).expect_err("it is wrong").to_string();
        let wrong = message(two(&POINTS, &[&[0, 1, 2], &[0, 1, 5]], encoding));
        assert!(wrong.contains("element 2 (counted from 0) at byte"), "{wrong}");
        assert!(wrong.contains("the face uses node 60, which is not among"), "{wrong}");
        let mut points = POINTS;
        points[2][1] = f32::NAN;
        let wrong = message(four(&points, &FACES, &[], encoding));
        assert!(wrong.contains("node 2 (counted from 0) at byte"), "{wrong}");
        // The counts after $Nodes and after $Elements, one byte of which becomes 255.
        for section in ["$Entities\n", "$Nodes\n", "$Elements\n"] {
            for place in 0..60 {
                let mut bytes = four(&POINTS, &FACES, &[&[7], &[8]], encoding);
                let at = bytes.windows(section.len()).position(|part| part == section.as_bytes()).expect("it is there");
                bytes[at + section.len() + place] = 255;
                if let Err(error) = parse(bytes) {
                    assert!(error.to_string().starts_with("wing.msh"), "{error}");
                }
            }
        }
    }
}
