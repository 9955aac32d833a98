//! Reading files: the same surface from every format, the format told by the content, and what is refused.

mod attributes;
mod msh;
mod obj;
mod off;
mod ply;
mod stl;
mod vtk;

use flate2::Compression;
use flate2::write::GzEncoder;
use obj::{SQUARE, square};
use quadmosaic::mesh::check::check;
use quadmosaic::mesh::read_mesh;
use quadmosaic::surface::load::{Format, LoadError, read, read_as, read_stream};
use quadmosaic::surface::{Attributes, Regions, Soup};
use std::fs;
use std::io::Write;
use std::path::Path;

/// A tetrahedron, with coordinates that f32 holds.
const POINTS: [[f32; 3]; 4] = [[0.5, -0.25, 0.0], [4.0, 0.0, 0.125], [0.0, 3.0, 0.0], [-1.0, 0.0, 2.5]];
const FACES: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

fn tetrahedron() -> Soup {
    let points = POINTS.map(|point| point.map(f64::from)).to_vec();
    Soup { points, triangles: FACES.to_vec(), ..Default::default() }
}

fn tetrahedron_as_obj() -> String {
    let points = POINTS.map(|[x, y, z]| format!("v {} {} {}\n", f64::from(x), f64::from(y), f64::from(z)));
    let faces = FACES.map(|[a, b, c]| format!("f {} {} {}\n", a + 1, b + 1, c + 1));
    points.concat() + &faces.concat()
}

/// The positions of all corners: what is left to compare where the order of vertices differs.
fn corners(soup: &Soup) -> Vec<[f64; 3]> {
    soup.triangles.iter().flatten().map(|&index| soup.points[index as usize]).collect()
}

/// A tetrahedron in every format, with the ending that belongs to it.
fn tetrahedra() -> Vec<(&'static str, Vec<u8>)> {
    let corners = FACES.map(|face| face.map(|index| POINTS[index as usize]));
    let faces = FACES.each_ref().map(|face| &face[..]);
    let mut all = vec![
        ("obj", tetrahedron_as_obj().into()),
        ("stl", stl::ascii(&[("", &corners)]).into()),
        ("stl", stl::binary(b"made by hand", &corners)),
        ("stl", stl::binary(b"solid wing\nfacet normal 0 0 1", &corners)),
        ("ply", ply::ascii(&POINTS, &FACES).into()),
        ("ply", ply::binary(&POINTS, &FACES, false)),
        ("ply", ply::binary(&POINTS, &FACES, true)),
        ("off", off::ascii(&POINTS, &FACES).into()),
    ];
    for encoding in msh::ENCODINGS {
        all.push(("msh", msh::two(&POINTS, &faces, encoding)));
        all.push(("msh", msh::four(&POINTS, &faces, &[&[7], &[7, 8]], encoding)));
    }
    for (is_binary, is_new) in [(false, false), (false, true), (true, false), (true, true)] {
        all.push(("vtk", vtk::legacy(&POINTS, &faces, is_binary, is_new)));
    }
    all
}

/// Grids in all encodings. Their points come once for each of two pieces.
fn grids() -> Vec<(&'static str, Vec<u8>)> {
    let faces = FACES.each_ref().map(|face| &face[..]);
    let grid = |is_poly, arrays, is_packed| vtk::xml(&POINTS, &faces, is_poly, arrays, is_packed);
    let both = |arrays| {
        [
            ("vtu", grid(false, arrays, false)),
            ("vtu", grid(false, arrays, true)),
            ("vtp", grid(true, arrays, false)),
            ("vtp", grid(true, arrays, true)),
        ]
    };
    vtk::ARRAYS.into_iter().flat_map(both).collect()
}

#[test]
fn every_format_gives_the_same_surface() {
    for (ending, bytes) in tetrahedra() {
        for format in [None, Some(ending.parse().expect("a format"))] {
            let soup = read_stream(&bytes[..], ending, format).unwrap_or_else(|error| panic!("{ending}: {error}"));
            assert_eq!(corners(&soup), corners(&tetrahedron()), "{ending}");
            // STL has no vertices of its own: those at the same point are one.
            assert_eq!(soup.points.len(), 4, "{ending}");
            if ending != "stl" {
                let shape = Soup { regions: Regions::default(), attributes: Attributes::default(), ..soup };
                assert_eq!(shape, tetrahedron(), "{ending}");
            }
        }
    }
}

fn packed(bytes: &[u8]) -> Vec<u8> {
    let mut packer = GzEncoder::new(Vec::new(), Compression::fast());
    packer.write_all(bytes).expect("a vector takes all");
    packer.finish().expect("a vector takes all")
}

#[test]
fn files_in_gzip_are_unpacked() {
    for (ending, bytes) in tetrahedra() {
        let plain = read_stream(&bytes[..], ending, None).expect("it is good");
        let whole = packed(&bytes);
        for format in [None, Some(ending.parse().expect("a format"))] {
            assert_eq!(read_stream(&whole[..], ending, format).expect("it is good"), plain, "{ending}");
        }
        // The two halves, each packed, one after the other.
        let (first, second) = bytes.split_at(bytes.len() / 2);
        assert_eq!(
            read_stream(&[packed(first), packed(second)].concat()[..], ending, None).expect("it is good"),
            plain
        );
        let error = read_stream(&whole[..whole.len() - 9], "it", None).expect_err("it is cut off");
        assert!(matches!(error, LoadError::Packed { .. }), "{error}");
    }
    let error = read_stream(&packed(b"")[..], "it", None).expect_err("nothing is in it");
    assert!(matches!(error, LoadError::Empty { .. }), "{error}");
}

#[test]
fn other_kinds_of_files_are_named() {
    for (text, message) in [
        ("ISO-10303-21;\nHEADER;\nv 0 0 0\n", "part is a STEP file, a CAD model, which is not read; mesh its faces in"),
        ("PK\x03\x04\x14\0\0\x003D/3dmodel.model\0", "part is a 3MF file, which is not read; open it in the slicer"),
        ("Point(1) = {0, 0, 0, 1};\n", "part is a Gmsh script, which is not read; mesh it in Gmsh"),
    ] {
        let error = read_stream(text.as_bytes(), "part", None).expect_err("it is no mesh").to_string();
        assert!(error.starts_with(message), "{error}");
    }
}

#[test]
fn every_grid_gives_the_same_surface() {
    for (ending, bytes) in grids() {
        for format in [None, Some(ending.parse().expect("a format"))] {
            let soup = read_stream(&bytes[..], ending, format).unwrap_or_else(|error| panic!("{ending}: {error}"));
            assert_eq!(corners(&soup), corners(&tetrahedron()), "{ending}");
        }
    }
}

#[test]
fn names_of_files_say_nothing() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (_, bytes) in tetrahedra() {
        for name in ["wing.obj", "wing.STL", "wing.ply", "wing.txt", "wing"] {
            let path = folder.path().join(name);
            fs::write(&path, &bytes).expect("it can be written");
            assert_eq!(corners(&read(&path).expect("it is good")), corners(&tetrahedron()), "{name}");
            let faults = check(&read_mesh(&path).expect("it is a mesh"));
            assert!(faults.is_clean() && faults.euler == 2, "{name}: {faults}");
        }
    }
}

#[test]
fn a_format_that_the_content_contradicts_is_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("wing");
    for (ending, bytes) in tetrahedra() {
        fs::write(&path, &bytes).expect("it can be written");
        for asked in Format::ALL.into_iter().filter(|format| format.name() != ending) {
            let error = read_as(&path, Some(asked)).expect_err("it is another format").to_string();
            let found = ending.to_uppercase();
            let expected =
                format!("wing was to be read as {asked}, but it is {found}; leave the format out or say {ending}");
            assert!(error.ends_with(&expected), "{error}");
        }
    }
    // Where nothing tells, what was asked for is tried.
    for (asked, message) in
        [("obj", "no vertices"), ("stl", "is no word of an STL file"), ("ply", "begins here"), ("off", "is no count")]
    {
        let error = read_stream(&b"rubbish"[..], "it", Some(asked.parse().expect("a format"))).expect_err("it is none");
        assert!(error.to_string().contains(message), "{error}");
    }
}

/// Cut anywhere, a file never gives a part of the surface that is not told from the whole.
#[test]
fn cut_files_are_refused() {
    for (ending, bytes) in tetrahedra().into_iter().chain(grids()) {
        let whole = read_stream(&bytes[..], "whole", None).expect("it is whole");
        let end = bytes.trim_ascii_end().len();
        for length in 0..end {
            let Ok(part) = read_stream(&bytes[..length], "cut", None) else { continue };
            // A text may end with a number that is shorter than it was, or, OBJ and PLY, where a face or a digit ends.
            // VTK has no end: its attributes may be left out, and what closes an appended section.
            let has_end = bytes.contains(&0) && !ending.starts_with("vt");
            assert!(!has_end, "{ending}: {length} of {end} bytes gave a surface");
            assert!(ending == "obj" || part.triangles.len() == whole.triangles.len(), "{ending}: {length} of {end}");
        }
    }
}

/// Any byte of a file may be any other: what is read is sound or refused with one line that names it.
#[test]
fn damaged_files_do_no_harm() {
    let mut state = 1_u64;
    let mut random = move |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    let (mut read, mut refused) = (0, 0);
    for (ending, bytes) in tetrahedra().into_iter().chain(grids()) {
        for _ in 0..1000 {
            let mut damaged = bytes.clone();
            for _ in 0..1 + random(3) {
                let (place, byte) = (random(damaged.len()), random(256) as u8);
                damaged[place] = byte;
            }
            match read_stream(&damaged[..], "damaged", None) {
                Ok(soup) => {
                    assert!(soup.triangles.iter().flatten().all(|&index| (index as usize) < soup.points.len()));
                    assert!(corners(&soup).iter().flatten().all(|number| number.is_finite()));
                    assert!([0, soup.triangles.len()].contains(&soup.regions.of_face.len()));
                    read += 1;
                }
                Err(error) => {
                    let message = error.to_string();
                    assert!(message.starts_with("damaged") && !message.contains('\n'), "{ending}: {message}");
                    refused += 1;
                }
            }
        }
    }
    assert!(read > 1000 && refused > 1000, "{read} were read and {refused} refused: the damage is no test");
}

#[test]
fn paths_that_cannot_be_read_are_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = |name: &str| folder.path().join(name);
    assert!(matches!(read(folder.path()), Err(LoadError::Directory { .. })));
    assert!(matches!(read(&path("none.obj")), Err(LoadError::Missing { .. })));
    fs::write(path("empty.obj"), "").expect("it can be written");
    assert!(matches!(read(&path("empty.obj")), Err(LoadError::Empty { .. })));
    fs::write(path("wing.OBJ"), format!("{SQUARE}f 1 2 3\nf 1 3 4\n")).expect("it can be written");
    assert_eq!(read(&path("wing.OBJ")).expect("it is good"), square());
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
