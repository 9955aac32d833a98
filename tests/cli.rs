//! The program as a user meets it: what it writes, what it says, and how it ends.

#[path = "common/desk.rs"]
mod desk;

use desk::{Desk, text};
use quadmosaic::mesh::{Edge, Mesh, read_mesh};
use quadmosaic::surface::examples::Example;
use quadmosaic::surface::load::read;
use serde_json::Value;
use std::fs;
use std::process::Output;

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

fn faces(mesh: &Mesh, sides: usize) -> usize {
    mesh.faces().filter(|face| face.len() == sides).count()
}

#[test]
fn a_sphere_from_end_to_end() {
    let desk = Desk::new();
    let said = desk.said(&["mesh", "example:sphere:2000", "--points", "500", "-o", "out.obj", "--report", "out.json"]);
    assert_eq!(desk.names(), ["out.json", "out.obj"]);
    let mesh = read_mesh(&desk.path("out.obj")).expect("it is a mesh");
    let report: Value = serde_json::from_slice(&desk.bytes("out.json")).expect("it is JSON");

    assert_eq!(report["version"], 4);
    assert_eq!(report["surface"]["name"], "example:sphere:2000");
    assert_eq!(report["asked"]["points"], 500);
    assert_eq!(report["mesh"]["vertices"], mesh.points.len());
    assert_eq!(report["mesh"]["quads"], faces(&mesh, 4));
    assert_eq!(report["mesh"]["triangles"], faces(&mesh, 3));
    assert_eq!(mesh.face_count(), faces(&mesh, 4) + faces(&mesh, 3));
    assert_eq!(report["faults"]["euler"], 2);
    assert_eq!(report["edits"]["triangles_after"], faces(&mesh, 3));
    assert_eq!((report["faults"]["list"].as_array(), report["differences"].as_array()), (Some(&vec![]), Some(&vec![])));
    assert!(mesh.points.len().abs_diff(500) <= 25, "{} vertices", mesh.points.len());

    let stages: Vec<_> = report["times"].as_array().expect("a list").iter().map(|time| &time["stage"]).collect();
    let expected = [
        "read",
        "device",
        "surface",
        "field",
        "mosaic",
        "connect",
        "fill",
        "connectivity",
        "relocate",
        "finish",
        "measure",
        "write",
    ];
    assert_eq!(stages, expected);

    for part in [
        format!("vertices   {} (500 asked for)", mesh.points.len()),
        format!("{} quads", faces(&mesh, 4)),
        "features   0 curves, 0 corners".to_owned(),
    ] {
        assert!(said.contains(&part), "no {part:?} in\n{said}");
    }
}

#[test]
fn the_same_bytes_again_and_with_any_number_of_threads() {
    let desk = Desk::new();
    let mesh = |name, threads, points| {
        desk.said(&["mesh", "example:block:2000", "--points", points, "--threads", threads, "-o", name]);
        desk.bytes(name)
    };
    let first = mesh("first.obj", "1", "600");
    assert_eq!(mesh("first.obj", "1", "600"), first, "over the file of the first run");
    assert_eq!(mesh("two.obj", "2", "600"), first);
    assert_ne!(mesh("other.obj", "2", "700"), first, "equality would say nothing");
}

/// The OBJ file of a sphere of radius 1 and of a smaller one inside it, by `thickness`, that looks inwards.
fn shell(thickness: f64) -> String {
    let sphere = "sphere".parse::<Example>().expect("an example").generate(2_000);
    let scaled = |scale: f64| sphere.points.iter().map(move |p| p.map(|x| scale * x));
    let vertices = scaled(1.0).chain(scaled(1.0 - thickness)).map(|[x, y, z]| format!("v {x} {y} {z}\n"));
    let second = sphere.points.len() as u32 + 1;
    let outer = sphere.triangles.iter().map(|t| t.map(|v| v + 1));
    let inner = sphere.triangles.iter().map(|&[a, b, c]| [a, c, b].map(|v| v + second));
    vertices.chain(outer.chain(inner).map(|[a, b, c]| format!("f {a} {b} {c}\n"))).collect()
}

#[test]
fn a_mesh_that_is_wrong_is_a_warning_or_with_strict_no_mesh() {
    let desk = Desk::new();
    // A shell so thin that tiles would have to be many times smaller.
    let inputs = Desk::new();
    let [thin, thick] = [("thin.obj", 1e-4), ("thick.obj", 0.3)].map(|(name, thickness)| {
        inputs.put(name, shell(thickness));
        inputs.path(name).display().to_string()
    });
    let thin = ["mesh", &thin, "--points", "100", "-o", "out.obj", "--quiet"];
    let thick = ["mesh", &thick, "--points", "300", "-o", "out.obj", "--quiet"];
    let files = ["--report", "out.json", "--picture", "out.png"];
    let run = |arguments: &[&str], more: &[&str]| {
        let output = desk.run(&[arguments, more].concat());
        (output.status.code(), text(&output.stderr))
    };
    let strict = [&["--strict"], &files[..]].concat();
    let (code, said) = run(&thin, &strict);
    let refused = said.strip_prefix("error: out.obj was not written: ").unwrap_or_else(|| panic!("{said}"));
    assert_eq!((code, desk.names()), (Some(3), vec!["out.json".to_owned()]), "{said}");
    let report: Value = serde_json::from_slice(&desk.bytes("out.json")).expect("it is JSON");
    assert_eq!(report["error"].as_str().map(|error| format!("error: {error}\n")), Some(said.clone()));
    assert!(report["faults"]["list"].as_array().is_some_and(|faults| !faults.is_empty()));
    assert!(
        refused.contains(" faults; Euler characteristic 4") && refused.contains(" looks away from the surface"),
        "{said}"
    );
    // What stands there already stays.
    desk.put("out.obj", SQUARE);
    assert_eq!(run(&thin, &strict).0, Some(3));
    assert_eq!((text(&desk.bytes("out.obj")).as_str(), desk.names().len()), (SQUARE, 2));

    let (code, said) = run(&thin, &files);
    assert_eq!((code, desk.names()), (Some(0), ["out.json", "out.obj", "out.png"].map(str::to_owned).to_vec()));
    assert!(said.starts_with(&format!("warning: out.obj: {refused}")), "{said}");
    let report: Value = serde_json::from_slice(&desk.bytes("out.json")).expect("it is JSON");
    assert!(report["error"].is_null(), "a mesh was written");
    let faults = report["faults"]["list"].as_array().expect("a list");
    assert!(faults.iter().any(|fault| fault["kind"]["FlippedFace"]["face"].is_u64()), "{report}");
    assert_ne!(text(&desk.bytes("out.obj")), SQUARE);

    let (code, said) = run(&thick, &strict);
    assert_eq!((code, said.as_str()), (Some(0), ""), "a mesh without faults is written");
}

#[test]
fn options_reach_the_mesher() {
    let desk = Desk::new();
    desk.put("guides.csv", "x,y,z,dx,dy,dz,r\n# across the corner\n0.2,0.2,0,1,0.5,0,0.1\n");
    let base = ["mesh", "example:plate:2000", "--points", "400", "-o", "out.obj"];
    let mesh = |more: &[&str]| {
        desk.said(&[&base, more].concat());
        desk.bytes("out.obj")
    };
    let plain = mesh(&[]);
    let guided = mesh(&["--guide", "0.2,0.2,0,1,0.5,0,0.1"]);
    assert_eq!(mesh(&["--guides", "guides.csv"]), guided);
    for (name, changed) in [
        ("guide", guided),
        ("guide below zero", mesh(&["--guide", "-0.05,0.2,0,-1,0.5,0,0.1"])),
        ("max-distance", mesh(&["--max-distance", "1.1"])),
        ("max-angle", mesh(&["--max-angle", "10"])),
        ("holes", mesh(&["--holes", "leave", "--max-angle", "10"])),
        ("smoothing", mesh(&["--smoothing", "0"])),
        ("aspect", mesh(&["--aspect", "2", "--guide", "0.1,0.5,0,1,0,0"])),
    ] {
        assert_ne!(changed, plain, "{name} changes nothing");
    }
    // On the plate there is nothing to clean.
    let wing = |more: &[&str]| {
        desk.said(&[&["mesh", "example:m6:2000", "--points", "400", "-o", "out.obj"], more].concat());
        desk.bytes("out.obj")
    };
    assert_ne!(wing(&["--no-cleanup"]), wing(&[]), "no-cleanup changes nothing");
    let report = |crease: &str| {
        desk.said(&["mesh", "example:block:2000", "--crease", crease, "-o", "out.obj", "--report", "out.json"]);
        serde_json::from_slice::<Value>(&desk.bytes("out.json")).expect("it is JSON")
    };
    assert_eq!(report("40")["surface"]["corners"], 8);
    assert_eq!(report("180")["surface"]["corners"], 0);
}

#[test]
fn standard_input_is_a_surface_as_any_file() {
    let desk = Desk::new();
    desk.said(&["example", "sphere", "--triangles", "600", "-o", "in.obj"]);
    let surface = desk.bytes("in.obj");
    let mesh = |input: &str, more: &[&str], fed: &[u8]| {
        desk.fed(&[&["mesh", input, "--points", "100", "--quiet", "-o", "out.obj"], more].concat(), fed)
    };
    let good = |output: Output| {
        assert!(output.status.success(), "{}", text(&output.stderr));
        desk.bytes("out.obj")
    };
    let named = good(mesh("in.obj", &[], b""));
    for more in [&[][..], &["--format", "obj"], &["--format", "OBJ"]] {
        assert_eq!(good(mesh("-", more, &surface)), named);
    }
    assert_eq!(good(mesh("in.obj", &["--format", "obj"], b"")), named);
    fs::remove_file(desk.path("out.obj")).expect("it is there");

    for (input, format, fed, code, message) in [
        (
            "-",
            "stl",
            &surface[..],
            1,
            "standard input was to be read as STL, but it is OBJ; leave the format out or say obj",
        ),
        ("in.obj", "ply", b"", 1, "in.obj was to be read as PLY, but it is OBJ"),
        ("-", "obj", b"", 1, "standard input is empty"),
        ("-", "obj", b"v 0 0 0\nf 1 1 2\n", 1, "standard input, line 2: the face uses vertex 2"),
        ("-", "step", b"", 2, "the formats are obj, stl, ply, off"),
        ("example:m6", "obj", b"", 2, "--format goes with a file or standard input only"),
    ] {
        let output = mesh(input, &["--format", format], fed);
        assert_eq!(output.status.code(), Some(code), "{message}");
        assert!(text(&output.stderr).contains(message), "{message}: {}", text(&output.stderr));
        assert_eq!(desk.names(), ["in.obj"]);
    }
}

#[test]
fn quiet_says_nothing_but_the_mesh_is_there() {
    let desk = Desk::new();
    let output = desk.run(&["mesh", "example:sphere:2000", "--size", "0.2", "--quiet", "-o", "out.obj"]);
    assert!(output.status.success());
    assert_eq!(text(&output.stdout), "");
    assert_eq!(desk.names(), ["out.obj"]);
}

#[test]
fn bad_inputs_are_refused_with_their_place() {
    let desk = Desk::new();
    let files = [
        ("empty.obj", String::new(), "empty.obj is empty"),
        ("comment.obj", "# nothing\n".to_owned(), "comment.obj has no vertices"),
        ("points.obj", SQUARE.to_owned(), "points.obj has 4 vertices but no faces"),
        ("nan.obj", format!("{SQUARE}v 0 nan 0\nf 1 2 5\n"), "nan.obj, line 5: the coordinate \"nan\" is not finite"),
        ("index.obj", format!("{SQUARE}f 1 2 3\nf 1 2 9\n"), "index.obj, line 6: the face uses vertex 9"),
        (
            "flat.obj",
            "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n".to_owned(),
            "flat.obj: none of the 1 triangles has any area",
        ),
        (
            "band.obj",
            format!("{SQUARE}v 0 0 1\nf 1 2 3\nf 2 3 4\nf 3 4 5\nf 4 5 1\nf 5 1 2\n"),
            "band.obj: the surface is not orientable",
        ),
        (
            "surface.obj",
            "solid\nfacet normal 0 0 1\n".to_owned(),
            "surface.obj, line 1: the file ends within the solid",
        ),
        ("cut.ply", "ply\nformat ascii 1.0\nelement".to_owned(), "cut.ply, line 1: the header begins here"),
    ];
    for (name, content, message) in files {
        desk.put(name, content);
        let said = desk.refusal(1, &["mesh", name, "-o", "out.obj"]);
        assert!(said.contains(message), "{name}: {said}");
    }
    fs::create_dir(desk.path("folder.obj")).expect("a folder");
    for (name, message) in [("none.obj", "there is no file none.obj"), ("folder.obj", "folder.obj is a directory")] {
        let said = desk.refusal(1, &["mesh", name, "-o", "out.obj"]);
        assert!(said.contains(message), "{name}: {said}");
    }
    let said = desk.refusal(1, &["mesh", "example:sphere", "--size", "100", "-o", "out.obj"]);
    assert!(said.contains("example:sphere: tiles of side 100 cannot cover this surface"), "{said}");
}

#[test]
fn bad_guides_are_refused_with_their_line() {
    let desk = Desk::new();
    desk.put("short.csv", "0,0,0,1,0,0\n0,0,0,1,0\n");
    desk.put("none.csv", "# x, y, z\n");
    for (name, message) in [
        ("short.csv", "short.csv, line 2: a guide has 6 to 8 numbers"),
        ("none.csv", "none.csv holds no guide"),
        ("missing.csv", "missing.csv cannot be read"),
    ] {
        let said = desk.refusal(1, &["mesh", "example:plate", "--guides", name, "-o", "out.obj"]);
        assert!(said.contains(message), "{name}: {said}");
    }
}

#[test]
fn the_program_says_where_tiles_are_no_rectangles() {
    let desk = Desk::new();
    desk.put("square.obj", format!("{SQUARE}f 1 2 3 4\n"));
    for command in ["mesh", "mosaic"] {
        let surface = |name: &'static str| [command, name, "--points", "400", "--aspect", "3", "-o", "out.obj"];
        let said = desk.refusal(1, &surface("example:sphere:2000"));
        assert!(said.contains("example:sphere:2000: rectangular tiles need a guide"), "{command}: {said}");
        let guided =
            [&surface("example:sphere:2000")[..], &["--guide", "1,0,0,0,0,1", "--report", "out.json"]].concat();
        let output = desk.run(&guided);
        let warning = text(&output.stderr);
        assert!(output.status.success() && warning.starts_with("warning: on "), "{command}: {warning}");
        assert!(
            warning.contains("instead of 3 to 1: the field is only a cross about 8 points"),
            "{command}: {warning}"
        );
        assert!(text(&output.stdout).contains("; tiles 3 to 1, squares on "), "{command}");
        let report: Value = serde_json::from_slice(&desk.bytes("out.json")).expect("it is JSON");
        assert_eq!(report["field"]["stretch"]["odd_singularities"], 8);
        // On a square there is no singularity.
        let silent = [&surface("square.obj")[..], &["--guide", "0.5,0.5,0,1,0,0"]].concat();
        assert_eq!(text(&desk.run(&silent).stderr), "", "{command}");
        fs::remove_file(desk.path("out.obj")).expect("it was written");
        fs::remove_file(desk.path("out.json")).expect("it was written");
    }
    let fitted =
        ["mesh", "example:torus:2000", "--aspect", "3", "--guide", "1.4,0,0,0,0,1", "--fit", "1", "-o", "out.obj"];
    assert!(desk.refusal(1, &fitted).contains("leave out the aspect or the fit"));
}

#[test]
fn guides_without_effect_are_warned_of() {
    let desk = Desk::new();
    desk.put("guides.csv", "weight,x,y,z,dx,dy,dz\n# good\n,0.2,0.2,0,1,0.5,0\n2,0.2,0.2,0,0,0,1\n");
    desk.put("strokes.json", "{\"strokes\": [{\"points\": [[0.1, 0.1, 5], [0.2, 0.1, 5]], \"radius\": 0.5}]}");
    let run = |command: &str, output: &str| {
        let far = "--guide=0.2,0.2,-2,1,0,0";
        let more = ["--guides", "guides.csv", "--guides", "strokes.json", "--report", "out.json", "-q", "-o", output];
        let output =
            desk.run(&[&[command, "example:plate:2000", "--guide", "0.2,0.2,0,1,0,0,0.1,3", far], &more[..]].concat());
        assert!(output.status.success());
        text(&output.stderr)
    };
    for (command, output) in [("field", "out.vtk"), ("mesh", "out.obj")] {
        let said = run(command, output);
        let expected = [
            "warning: --guide number 2: it is 2 away from the surface, more than 0.0283, and has no effect",
            "warning: guides.csv, line 4: it points along the normal of the surface",
            "warning: strokes.json, strokes[0]: it is 5 away from the surface, more than 0.5,",
        ];
        let warnings: Vec<&str> = said.lines().filter(|line| line.contains(": it ")).collect();
        assert_eq!(warnings.len(), expected.len(), "{said}");
        assert!(warnings.iter().zip(expected).all(|(line, part)| line.starts_with(part)), "{said}");
        let report: Value = serde_json::from_slice(&desk.bytes("out.json")).expect("it is JSON");
        let guides = report["field"]["guides"].as_array().expect("a list");
        let kinds: Vec<_> = guides.iter().map(|guide| guide["trouble"]["kind"].as_str()).collect();
        assert_eq!(kinds, [None, Some("far"), None, Some("along_normal"), Some("far")]);
        assert!(guides[0]["crosses"].as_u64() > Some(3) && guides[1]["crosses"] == 0);
    }
}

#[test]
fn the_field_is_written_for_paraview() {
    let desk = Desk::new();
    let said = desk.said(&["field", "example:sphere:2000", "-o", "out.vtk", "--report", "out.json"]);
    assert!(said.contains("field     8 singularities, the sum of indices is 2"), "{said}");
    assert!(desk.bytes("out.vtk").starts_with(b"# vtk DataFile Version 3.0\n"));
    let report: Value = serde_json::from_slice(&desk.bytes("out.json")).expect("it is JSON");
    let list = report["field"]["singularities"].as_array().expect("a list");
    assert_eq!(list.len(), 8);
    for singularity in list {
        let at: Vec<f64> = singularity["at"].as_array().expect("a place").iter().filter_map(Value::as_f64).collect();
        let radius = at.iter().map(|x| x * x).sum::<f64>().sqrt();
        // On the unit sphere, in the middle of a triangle.
        assert!(singularity["index"] == 0.25 && (0.98..=1.0).contains(&radius), "{singularity}");
    }
    desk.said(&["field", "example:sphere:2000", "-o", "out.PLY"]);
    assert!(desk.bytes("out.PLY").starts_with(b"ply\n"));
    desk.said(&["field", "example:block:2000", "-o", "out.vtk"]);
    let plain = desk.bytes("out.vtk");
    for more in [&["--align", "curvature:2"][..], &["--crease", "5"], &["--guide", "0.85,0,0.5,1,0.3,0"]] {
        desk.said(&[&["field", "example:block:2000", "-o", "out.vtk"], more].concat());
        assert!(desk.bytes("out.vtk") != plain, "{more:?} change nothing");
    }
    for (more, message) in [
        (&["--align", "2"][..], "write curvature:WEIGHT"),
        (&["--align", "curvature:-1"], "write curvature:WEIGHT"),
        (&["-o", "out.obj"], "it does not end in .vtk or .ply"),
    ] {
        let output: &[&str] = if more[0] == "-o" { &[] } else { &["-o", "out.vtk"] };
        let arguments = [&["field", "example:sphere"], output, more];
        let said = desk.refusal(2, &arguments.concat());
        assert!(said.contains(message), "{said}");
    }
}

#[test]
fn a_mesh_that_cannot_be_kept_is_not_begun() {
    let desk = Desk::new();
    desk.put("file", "");
    desk.put("in.obj", format!("{SQUARE}f 1 2 3 4\n"));
    fs::create_dir(desk.path("folder.obj")).expect("a folder");
    let large = "example:m6:1000000";
    let mut cases = vec![
        (large, "none/out.obj", "none/out.obj cannot be written: there is no such folder"),
        (large, "file/out.obj", "file/out.obj cannot be written: there is no such folder"),
        (large, "folder.obj", "folder.obj cannot be written: it is a folder"),
        ("in.obj", "in.obj", "in.obj cannot be written: it is the same file as in.obj"),
        ("in.obj", "folder.obj/../in.obj", "it is the same file as in.obj"),
    ];
    if cfg!(target_os = "linux") {
        cases.push((large, "/proc/out.obj", "/proc/out.obj cannot be written, its folder takes no new file"));
    }
    for (input, output, message) in cases {
        let said = desk.refusal(1, &["mesh", input, "-o", output]);
        assert!(said.contains(message), "{output}: {said}");
    }
    let said = desk.refusal(1, &["mesh", large, "-o", "out.obj", "--report", "none/out.json"]);
    assert!(said.contains("none/out.json cannot be written"), "{said}");
    let said = desk.refusal(1, &["mesh", large, "-o", "out.obj", "--report", "./out.obj"]);
    assert!(said.contains("./out.obj cannot be written: it is the same file as out.obj"), "{said}");
    for (dash, message) in [
        (&["mesh", large, "-o", "-"][..], "name the format of standard output: --to obj|ply"),
        (
            &["mesh", large, "-o", "/dev/null"],
            "/dev/null: there is no extension that tells the format; name it, as by --to obj",
        ),
        (&["mesh", large, "-o", "-", "--to", "obj", "--report", "-"], "cannot both go to standard output"),
        (&["mosaic", large, "-o", "-"], "this result goes to a file"),
    ] {
        let said = desk.refusal(2, dash);
        assert!(said.contains(message), "{said}");
    }
    let said = desk.refusal(1, &["example", "m6", "-o", "none/out.obj"]);
    assert!(said.contains("none/out.obj cannot be written"), "{said}");
}

#[test]
fn no_report_of_an_earlier_run_stays_beside_a_run_that_fails() {
    let desk = Desk::new();
    let surface = "example:sphere:2000";
    let mesh = ["mesh", surface, "--points", "100", "-o", "out.obj", "--report", "out.json"];
    let error = || -> Option<String> {
        let report: Value = serde_json::from_slice(&fs::read(desk.path("out.json")).ok()?).ok()?;
        Some(report["error"].as_str().unwrap_or("none").to_owned())
    };
    let refused = |code: i32, arguments: &[&str]| {
        let output = desk.run(arguments);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}");
        text(&output.stderr)
    };
    let fresh = || {
        desk.said(&mesh);
        assert_eq!(error().as_deref(), Some("none"));
    };
    // An output that is refused is a failure like others.
    fresh();
    let said = refused(1, &["mesh", surface, "-o", "none/out.obj", "--report", "out.json"]);
    assert_eq!(error().map(|error| format!("error: {error}\n")), Some(said));
    // Wrong usage is no run, and has no report.
    for more in [&["--layout", "quads", "--quads", "paper"][..], &["--points=few"], &["--crease", "40", "--foo"]] {
        fresh();
        refused(2, &[&mesh[..2], &mesh[4..], more].concat());
        assert_eq!(error(), None, "{more:?}");
    }
    fresh();
    refused(2, &["mesh", surface, "--size", "x", "--report=out.json", "-o", "out.obj"]);
    assert_eq!(error(), None);
    fresh();
    refused(1, &["check", "none.obj", "--report", "out.json"]);
    assert_eq!(error(), None);
    // What asks for no run leaves it; so does a file that is no report.
    fresh();
    desk.said(&[&mesh[..], &["--help"]].concat());
    desk.said(&[&mesh[..], &["--print-config"]].concat());
    assert!(error().is_some());
    desk.put("out.json", SQUARE);
    refused(2, &[&mesh[..], &["--foo"]].concat());
    refused(1, &["mesh", "out.json", "-o", "other.obj", "--report", "out.json"]);
    assert_eq!(text(&desk.bytes("out.json")), SQUARE);
}

#[test]
fn usage_names_the_users_own_options_alone() {
    let desk = Desk::new();
    let usage = |more: &[&str]| {
        let said = text(&desk.run(&[&["mesh", "example:sphere"], more].concat()).stderr);
        said.lines().find(|line| line.starts_with("Usage: ")).unwrap_or_else(|| panic!("{said}")).to_owned()
    };
    for chosen in [["--layout", "quads"], ["--preset", "scan"]] {
        for wrong in [&[][..], &["-o", "out.obj", "--points", "100", "--size", "1"], &["-o", "out.obj", "--foo"]] {
            let usage = usage(&[&chosen, wrong].concat());
            assert!(usage.contains(chosen[0]), "{usage}");
            for set in ["--fit", "--rows", "--quads", "--crease", "--weld"] {
                assert!(!usage.contains(set), "{wrong:?}: {usage}");
            }
        }
    }
    let own = usage(&["--layout", "quads", "--rows", "paper", "-o", "out.obj", "--foo"]);
    assert!(own.contains("--rows"), "{own}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_an_error() {
    let desk = Desk::new();
    std::os::unix::fs::symlink("/dev/full", desk.path("out.obj")).expect("it can be linked");
    let said = desk.refusal(1, &["mesh", "example:sphere:2000", "--points", "200", "-o", "out.obj"]);
    assert!(said.contains("out.obj cannot be written (No space left"), "{said}");
}

#[test]
fn wrong_usage_is_told_from_failure() {
    let desk = Desk::new();
    let mesh = |more: &[&str]| desk.refusal(2, &[&["mesh", "example:sphere", "-o", "out.obj"], more].concat());
    for (more, message) in [
        (&["--points", "0"][..], "ask for 4 to 50000000 vertices"),
        (&["--points", "-5"], "invalid value '-5' for '--points <N>': ask for 4 to 50000000 vertices"),
        (&["--size", "-0.5"], "invalid value '-0.5' for '--size <H>': a length is a number above 0"),
        (&["--weld", "-1%"], "invalid value '-1%' for '--weld <TOL>': write a number above 0"),
        (&["-5"], "unexpected argument '-5'"),
        (&["--points", "100", "--size", "1"], "cannot be used with"),
        (&["--refine-curvature", "0"], "from 1 to 90"),
        (&["--max-growth", "1"], "from 1.01 to 10"),
        (&["--aspect", "0.5"], "the longer side over the shorter one, a number from 1 to 20"),
        (&["--size", "0"], "a length is a number above 0"),
        (&["--size", "inf"], "a length is a number above 0"),
        (&["--weld", "0"], "write a number above 0"),
        (&["--fill-holes", "2t"], "write a number above 0"),
        (&["--crease", "200"], "the angle is a number from 1 to 180"),
        (&["--crease", "nan"], "the angle is a number from 1 to 180"),
        (&["--max-angle", "60"], "the angle is a number from 1 to 45"),
        (&["--max-distance", "0.5"], "the distance is a number from 1 to 10"),
        (&["--smoothing", "100000"], "write a whole number from 0 to 1000"),
        (&["--guide", "0,0,0,1,0"], "a guide has 6 to 8 numbers"),
        (&["--guide", "0,0,0,0,0,0"], "the direction (dx, dy, dz) is zero"),
        (&["--holes", "some"], "patterns, triangles, leave"),
    ] {
        let output = desk.run(&[&["mesh", "example:sphere", "-o", "out.obj"], more].concat());
        assert!(text(&output.stderr).contains(message), "{more:?}: {}", text(&output.stderr));
        mesh(more);
    }
    for (arguments, message) in [
        (&["mesh", "example:cow", "-o", "out.obj"][..], "there is no example surface \"cow\""),
        (&["mesh", "example:m6:many", "-o", "out.obj"], "ask for 1 to 20000000 triangles"),
        (
            &["mesh", "example:m6", "-o", "out.stp"],
            "out.stp: \"stp\" is no format of meshes; the formats are obj, ply, stl",
        ),
        (
            &["mesh", "example:m6", "-o", "obj"],
            "obj: there is no extension that tells the format; name it, as by --to obj (or ply, stl, ",
        ),
        (&["mesh", "example:m6", "-o", "out.msh", "--holes", "leave"], "msh has no faces of more than four corners"),
        (&["mesh", "example:m6", "-o", "out.obj", "--to", "cgns"], "\"cgns\" is no format of meshes"),
        (&["example", "torus", "--blunt", "-o", "out.obj"], "go with the example m6 only"),
    ] {
        let said = desk.refusal(2, arguments);
        assert!(said.contains(message), "{arguments:?}: {said}");
    }
}

#[test]
fn results_go_to_standard_output_and_the_summary_beside_it() {
    let desk = Desk::new();
    let mesh = ["mesh", "example:block", "--points", "300", "-o"];
    let summary = desk.said(&[&mesh[..], &["out.vtu"]].concat());
    let output = desk.run(&[&mesh[..], &["-", "--to", "vtu"]].concat());
    assert_eq!(output.stdout, desk.bytes("out.vtu"));
    let without_times = |text: &str| text.lines().next().map(str::to_owned);
    assert_eq!(without_times(&text(&output.stderr)), without_times(&summary));
    let output = desk.run(&[&mesh[..], &["out.obj", "--report", "-"]].concat());
    let report: Value = serde_json::from_slice(&output.stdout).expect("it is JSON");
    assert_eq!(report["mesh"]["vertices"], read_mesh(&desk.path("out.obj")).expect("a mesh").points.len());
    assert_eq!(without_times(&text(&output.stderr)), without_times(&summary));
    let output = desk.run(&["example", "torus", "--triangles", "600", "-o", "-", "--to", "obj"]);
    desk.said(&["example", "torus", "--triangles", "600", "-o", "torus.obj"]);
    assert_eq!(output.stdout, desk.bytes("torus.obj"));
}

#[test]
fn examples_are_surfaces_that_can_be_read_again() {
    let desk = Desk::new();
    for name in ["m6", "torus", "sphere", "plate", "block"] {
        let said = desk.said(&["example", name, "--triangles", "600", "-o", "out.obj"]);
        let mesh = read_mesh(&desk.path("out.obj")).expect("it is a mesh");
        assert_eq!(said, format!("out.obj: {} triangles, {} vertices\n", mesh.face_count(), mesh.points.len()));
    }
    let wing = |more: &[&str]| {
        desk.said(&[&["example", "m6", "--triangles", "600", "-o", "out.obj"], more].concat());
        desk.bytes("out.obj")
    };
    let plain = wing(&[]);
    for flag in ["--blunt", "--flat-tip", "--whole-span"] {
        assert_ne!(wing(&[flag]), plain, "{flag}");
    }
}

#[test]
fn a_noisy_scan_is_meshed_along_a_few_strokes() {
    let desk = Desk::new();
    let scan = |noise: &str| {
        desk.said(&["example", "torus", "--triangles", "8000", "--noise", noise, "-o", "scan.ply"]);
        read_mesh(&desk.path("scan.ply")).expect("a surface").points
    };
    let [first, again, other] = ["0.01", "0.01", "0.02"].map(scan);
    assert_eq!(first, again, "the same noise each time");
    let plain = Example::Torus.generate(8_000).points;
    let farthest = |points: &[[f64; 3]]| {
        let moved = points.as_flattened().iter().zip(plain.as_flattened()).map(|(x, y)| (x - y).abs());
        moved.fold(0.0, f64::max)
    };
    assert!((0.0099..0.0101).contains(&farthest(&first)) && (0.0198..0.0202).contains(&farthest(&other)));
    desk.refusal(2, &["example", "torus", "--noise", "-1", "-o", "out.obj"]);

    // Rows along the outside; they turn with the strokes.
    let mesh = |points: &str| {
        desk.put("strokes.json", format!("{{\"strokes\": [{{\"points\": [{points}]}}]}}"));
        let files = ["-o", "out.obj", "--report", "out.json"];
        let mesh = ["mesh", "scan.ply", "--preset", "scan", "--points", "600", "--guides", "strokes.json"];
        desk.said(&[&mesh[..], &files].concat());
        let report: Value = serde_json::from_slice(&desk.bytes("out.json")).expect("it is JSON");
        assert_eq!((&report["surface"]["curves"], &report["faults"]["list"]), (&0.into(), &Value::Array(vec![])));
        assert!(report["mesh"]["qr"].as_f64().is_some_and(|qr| qr > 0.9), "{}", report["mesh"]["qr"]);
        desk.bytes("out.obj")
    };
    let along = mesh("[1.4, 0, 0], [1.21, 0.7, 0], [0.7, 1.21, 0]");
    assert_ne!(along, mesh("[1.4, 0, 0], [1.35, 0.4, 0.15], [1.1, 0.7, 0.3]"), "a stroke has an effect");
}

#[test]
fn check_tells_good_from_broken() {
    let desk = Desk::new();
    desk.put("good.obj", format!("{SQUARE}f 1 2 3 4\n"));
    let said = desk.said(&["check", "good.obj"]);
    for part in ["1 quad, 0 triangles", "Qr         1.000", "no faults; Euler characteristic 1"] {
        assert!(said.contains(part), "no {part:?} in\n{said}");
    }
    desk.put("broken.obj", format!("v 5 5 5\n{SQUARE}f 2 3 4 5\nf 2 3 4 5\n"));
    let output = desk.run(&["check", "broken.obj"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stdout).contains("vertex 0 lies on no face at (5, 5, 5)"));
    assert!(text(&output.stdout).contains("edge 1-2 has two faces on the same side"));
    assert!(text(&output.stderr).starts_with("error: broken.obj: 6 faults"), "{}", text(&output.stderr));
    // STL repeats points; what is one vertex is checked as one.
    let facets = [["0 0 0", "1 0 0", "0 1 0"], ["1 0 0", "1 1 0", "0 1 0"]].map(|corners| {
        format!(
            "facet normal 0 0 1\nouter loop\n{}endloop\nendfacet\n",
            corners.map(|at| format!("vertex {at}\n")).concat()
        )
    });
    desk.put("good", format!("solid\n{}endsolid\n", facets.concat()));
    let said = desk.said(&["check", "good"]);
    assert!(said.contains("vertices   4\n") && said.contains("no faults; Euler characteristic 1"), "{said}");
    let said = desk.refusal(1, &["check", "none.obj"]);
    assert!(said.contains("none.obj"), "{said}");
}

/// A floor of `n` by `n` squares, and a wall of `n` by one on its first inner line.
fn joined_sheets(n: usize) -> String {
    let floor = (0..=n).flat_map(|j| (0..=n).map(move |i| format!("v {i} {j} 0\n")));
    let top = (0..=n).map(|i| format!("v {i} 1 1\n"));
    let at = |i: usize, j: usize| j * (n + 1) + i + 1;
    let squares =
        (0..n * n).map(|k| (k % n, k / n)).map(|(i, j)| [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
    let wall = (0..n).map(|i| [at(i, 1), at(i + 1, 1), at(i + 1, n + 1), at(i, n + 1)]);
    floor.chain(top).chain(squares.chain(wall).map(|[a, b, c, d]| format!("f {a} {b} {c} {d}\n"))).collect()
}

#[test]
fn sheets_that_meet_are_no_faults_of_a_mesh() {
    let desk = Desk::new();
    desk.put("joined.obj", joined_sheets(4));
    let said = desk.said(&["check", "joined.obj"]);
    assert!(said.contains("sheets meet along 4 edges\n") && said.contains("no faults"), "{said}");
    // Two tetrahedra with one edge in common.
    let points = "v 0 0 0\nv 0 0 1\nv 1 0 0\nv 1 1 0\nv -1 0 0\nv -1 -1 0\n";
    desk.put(
        "touching.obj",
        format!("{points}f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\nf 1 5 2\nf 1 2 6\nf 1 6 5\nf 2 5 6\n"),
    );
    let output = desk.run(&["check", "touching.obj"]);
    let said = text(&output.stdout);
    assert!(!said.contains("sheets meet") && said.contains("edge 0-1 has 4 faces at"), "{said}");
    assert_eq!(output.status.code(), Some(1));
}

#[test]
fn the_report_tells_options_regions_and_the_worst_faces() {
    let desk = Desk::new();
    desk.put("in.stl", two_solids(["left", "right"]));
    let arguments = ["mesh", "in.stl", "--points", "60", "--crease", "30", "-o", "out.obj", "--report", "out.json"];
    desk.said(&arguments);
    let report: Value = serde_json::from_slice(&desk.bytes("out.json")).expect("it is JSON");
    let options = &report["options"];
    assert_eq!((&options["points"], &options["crease"], &options["quads"]), (&60.into(), &30.into(), &"most".into()));
    assert!(options["size"].is_null(), "what is not given and has no default is not there");
    let mesh = read_mesh(&desk.path("out.obj")).expect("a mesh");
    let regions = report["regions"].as_array().expect("a list");
    let names: Vec<_> = regions.iter().map(|region| region["name"].as_str()).collect();
    assert_eq!(names, [Some("left"), Some("right")]);
    let faces: u64 =
        regions.iter().flat_map(|one| ["quads", "triangles", "polygons"].map(|k| one[k].as_u64())).flatten().sum();
    assert_eq!(faces, mesh.face_count() as u64);
    let worst = report["worst"].as_array().expect("a list");
    let shapes: Vec<f64> = worst.iter().filter_map(|face| face["shape"].as_f64()).collect();
    assert!(shapes.len() == 10 && shapes.is_sorted(), "{shapes:?}");
    let least = ["qg", "tg"].iter().filter_map(|measure| report["mesh"][measure]["min"].as_f64()).reduce(f64::min);
    assert_eq!(least, Some(shapes[0]));
    // A run that fails has a report as well, but none where wrong usage began none.
    desk.put("bad.obj", format!("{SQUARE}f 1 2 9\n"));
    let refused = |more: &[&str]| {
        let file = ["mesh", "bad.obj", "-o", "bad_out.obj", "--report", "bad.json"];
        let output = desk.run(&[&file, more].concat());
        assert!(!output.status.success() && !desk.names().contains(&"bad_out.obj".to_owned()));
        text(&output.stderr)
    };
    refused(&["--layout", "quads", "--quads", "paper"]);
    assert!(!desk.names().contains(&"bad.json".to_owned()));
    let said = refused(&["--points", "70"]);
    let report: Value = serde_json::from_slice(&desk.bytes("bad.json")).expect("it is JSON");
    assert_eq!(report["error"].as_str().map(|error| format!("error: {error}\n")), Some(said));
    assert_eq!((&report["options"]["points"], &report["name"]), (&70.into(), &"bad.obj".into()));
}

#[test]
fn check_compares_with_a_surface() {
    let desk = Desk::new();
    desk.said(&["mesh", "example:block", "--points", "500", "-o", "mesh.obj"]);
    let against = |more: &[&str]| desk.run(&[&["check", "mesh.obj", "--against", "example:block"], more].concat());
    let output = against(&["--report", "good.json"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let said = text(&output.stdout);
    assert!(said.contains("example:block: ") && said.contains("\ndifferences    none\n"), "{said}");
    let report: Value = serde_json::from_slice(&desk.bytes("good.json")).expect("it is JSON");
    let comparison = &report["against"]["comparison"];
    assert_eq!(comparison["topology"]["euler"], report["faults"]["euler"]);
    assert!(comparison["hausdorff"].as_f64().is_some_and(|distance| distance < 0.5), "{comparison}");
    let edges = |comparison: &Value| comparison["features"]["edges"].as_u64().unwrap_or(0);
    assert!(edges(comparison) > 0);
    // With no crease the block has no feature.
    assert!(against(&["--crease", "180", "--report", "smooth.json"]).status.success());
    let report: Value = serde_json::from_slice(&desk.bytes("smooth.json")).expect("it is JSON");
    assert_eq!(edges(&report["against"]["comparison"]), 0);

    // Without its last face it has a hole, and the report has its place.
    let whole = text(&desk.bytes("mesh.obj"));
    let (cut, _) = whole.trim_end().rsplit_once('\n').expect("it has lines");
    desk.put("mesh.obj", cut);
    let output = against(&["--report", "hole.json"]);
    assert_eq!(output.status.code(), Some(1));
    let said = text(&output.stderr);
    assert!(said.starts_with("error: mesh.obj: 1 fault; the Euler characteristic is -1, the surface's 0"), "{said}");
    let report: Value = serde_json::from_slice(&desk.bytes("hole.json")).expect("it is JSON");
    assert!(report["faults"]["list"][0]["kind"]["Hole"]["sides"].is_u64(), "{report}");

    let said = desk.refusal(1, &["check", "mesh.obj", "--report", "mesh.obj"]);
    assert!(said.contains("the same file"), "{said}");
    let said = desk.refusal(2, &["check", "mesh.obj", "--against", "example:bock"]);
    assert!(said.contains("no example surface"), "{said}");
    // Features are a surface's: without one the option would do nothing.
    let alone = desk.run(&["check", "mesh.obj", "--crease", "30"]);
    assert_eq!(alone.status.code(), Some(2));
    assert!(text(&alone.stderr).contains("--against <SURFACE>"), "{}", text(&alone.stderr));
}

/// The triangles of two squares side by side as ASCII STL: solids of these names.
fn two_solids(names: [&str; 2]) -> String {
    let solid = |(x, name): (usize, &str)| {
        let corner = |[i, j]: [usize; 2]| format!("vertex {} {j} 0\n", x + i);
        let facet = |corners: [[usize; 2]; 3]| {
            format!("facet normal 0 0 1\nouter loop\n{}endloop\nendfacet\n", corners.map(corner).concat())
        };
        let halves = [[[0, 0], [1, 0], [1, 1]], [[0, 0], [1, 1], [0, 1]]].map(facet).concat();
        format!("solid {name}\n{halves}endsolid {name}\n")
    };
    (0..).zip(names).map(solid).collect()
}

#[test]
fn solids_of_an_stl_file_are_groups_of_the_mesh() {
    let desk = Desk::new();
    desk.put("in.stl", two_solids(["left half", "right"]));
    for more in [&[][..], &["--ignore-regions"]] {
        desk.said(&[&["mesh", "in.stl", "--points", "200", "-o", "out.obj"], more].concat());
        let written = text(&desk.bytes("out.obj"));
        let groups: Vec<&str> = written.lines().filter(|line| line.starts_with('g')).collect();
        assert_eq!(groups, ["g left half", "g right"], "{more:?}");
        let before = |mark: &str| written.split_once(mark).expect("it is there").0;
        assert!(!before("\ng left half\n").contains("\nf "), "all faces have a name");
        // Faces before the second group lie on the left, the others on the right, up to one across the border.
        let points: Vec<f64> = written
            .lines()
            .filter_map(|line| line.strip_prefix("v "))
            .map(|at| at.split(' ').next().and_then(|x| x.parse().ok()).expect("a number"))
            .collect();
        let middles = |faces: &str| -> Vec<f64> {
            let face = |line: &str| -> Vec<f64> {
                line.split(' ').map(|v| points[v.parse::<usize>().expect("a vertex") - 1]).collect()
            };
            let faces = faces.lines().filter_map(|line| line.strip_prefix("f ")).map(face);
            faces.map(|xs| xs.iter().sum::<f64>() / xs.len() as f64).collect()
        };
        let (left, right) = written.split_once("\ng right\n").expect("two groups");
        let slack = if more.is_empty() { 0.0 } else { 0.15 };
        let [left, right] = [left, right].map(middles);
        assert!(left.iter().all(|&x| x < 1.0 + slack) && right.iter().all(|&x| x > 1.0 - slack), "{more:?}");
        assert!(left.len() > 60 && right.len() > 60, "{more:?}");
    }
    // Without names there are no groups.
    desk.put("in.stl", two_solids(["", ""]));
    desk.said(&["mesh", "in.stl", "--points", "200", "-o", "out.obj"]);
    assert!(!text(&desk.bytes("out.obj")).contains("\ng"));
}

#[test]
fn named_edges_reach_the_mesher() {
    let desk = Desk::new();
    desk.put("in.obj", format!("{SQUARE}v 0.5 0.15 0\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n"));
    desk.put("edges.txt", "# to the middle\n1 5\n1 1 0, 0.5 0.15 0\n");
    let curves = |more: &[&str]| {
        let said = [&["mesh", "in.obj", "--points", "100", "-o", "out.obj", "--report", "out.json"], more].concat();
        desk.said(&said);
        serde_json::from_slice::<Value>(&desk.bytes("out.json")).expect("it is JSON")["surface"]["curves"].clone()
    };
    // Vertices on the way from the first corner to the middle.
    let on_the_way = || {
        let mesh = read_mesh(&desk.path("out.obj")).expect("it is a mesh");
        mesh.points.iter().filter(|p| p[0] < 0.5 && (p[1] - 0.3 * p[0]).abs() < 1e-6).count()
    };
    assert_eq!(curves(&[]), 4);
    assert!(on_the_way() < 3, "the corner, and what lies there by chance");
    assert_eq!(curves(&["--feature-edges", "edges.txt"]), 4 + 1, "the two edges are one curve");
    // The way is 0.52 long, and tiles are 0.1.
    assert!(on_the_way() >= 5, "{}", on_the_way());
    for (line, message) in [
        ("1 9", "edges.txt, line 2: there is no vertex 9 in the surface's file"),
        ("0 0 0 0.3 0.3 0", "edges.txt, line 2: the surface has no vertex at (0.3, 0.3, 0)"),
        ("1 3", "edges.txt, line 2: no edge, and no straight line of edges, joins (0, 0, 0) and (1, 1, 0)"),
        ("1 1", "edges.txt, line 2: no edge"),
        ("1 2 3", "edges.txt, line 2: the edge has 3 numbers"),
    ] {
        desk.put("edges.txt", format!("1 5\n{line}\n"));
        let said = desk.refusal(1, &["mesh", "in.obj", "--feature-edges", "edges.txt", "-o", "other.obj"]);
        assert!(said.contains(message), "{line}: {said}");
    }
}

#[test]
fn seams_are_reported_with_their_places() {
    let desk = Desk::new();
    // Three pages at a spine along z, far from the origin.
    desk.put("in.obj", "v 70 0 0\nv 70 0 2\nv 73 0 0\nv 68 2 0\nv 68 -2 0\nf 1 2 3\nf 2 1 4\nf 1 2 5\n");
    desk.said(&["mesh", "in.obj", "--points", "200", "-o", "out.obj", "--report", "out.json"]);
    let report: Value = serde_json::from_slice(&desk.bytes("out.json")).expect("it is JSON");
    let joined = &report["surface"]["repairs"]["joined_edges"];
    assert_eq!((&joined["count"], joined["at"].as_array().map(Vec::len)), (&1.into(), Some(1)));
    for (found, wanted) in joined["at"][0].as_array().expect("a place").iter().zip([70.0, 0.0, 1.0]) {
        assert!((found.as_f64().expect("a number") - wanted).abs() < 1e-5, "{joined}");
    }
    assert_eq!(report["surface"]["repairs"]["dropped_specks"]["count"], 0);
    assert_eq!(report["faults"]["list"].as_array().map(Vec::len), Some(0), "the mesh branches as the surface does");
}

#[test]
fn a_gap_is_told_with_the_tolerance_that_sews_it() {
    let desk = Desk::new();
    // A unit square, and beside it another one with a side in two parts; the gap is 0.0001.
    let squares = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 1.0001 0 0\nv 2 0 0\nv 2 1 0\nv 1.0001 1 0\nv 1.0001 0.4 0\n";
    desk.put("in.obj", format!("{squares}f 1 2 3 4\nf 5 6 7 8 9\n"));
    let mesh = ["mesh", "in.obj", "--points", "100", "-o", "out.obj", "--report", "out.json"];
    let run = |more: &[&str]| {
        let output = desk.run(&[&mesh[..], more].concat());
        assert!(output.status.success(), "{}", text(&output.stderr));
        let report: Value = serde_json::from_slice(&desk.bytes("out.json")).expect("it is JSON");
        (report, text(&output.stdout), text(&output.stderr))
    };
    let (report, _, said) = run(&[]);
    assert_eq!(report["faults"]["components"], 2);
    let (_, tolerance) = said.split_once("ask for --weld ").expect(&said);
    let tolerance = tolerance.split_whitespace().next().expect("a number");
    let (report, figures, said) = run(&["--weld", tolerance]);
    assert_eq!((&report["faults"]["components"], said.as_str()), (&1.into(), ""));
    assert!(figures.contains("1 vertex inserted in rims, over gaps of at most 1.000e-4"), "{figures}");
    assert_eq!(report["surface"]["repairs"]["sewn_vertices"]["count"], 1);
    assert_eq!(report["surface"]["contacts"]["near_rims"], Value::Null);

    // The mesh is one piece: the surface is, if it is sewn as well.
    let check =
        |more: &[&str]| desk.run(&[&["check", "out.obj", "--against", "in.obj"][..], more].concat()).status.code();
    assert_eq!((check(&["--weld", tolerance]), check(&[])), (Some(0), Some(1)));
    assert_eq!(desk.run(&["check", "out.obj", "--weld", tolerance]).status.code(), Some(2), "nothing is welded");
    assert!(desk.refusal(1, &["mesh", "in.obj", "--weld", "1", "-o", "other.obj"]).contains("for welding"));
}

#[test]
fn sizes_come_from_a_file_and_from_curvature() {
    let desk = Desk::new();
    desk.put("sizes.csv", "x,y,z,size\n-0.5,0,0,0.03\n0.5,0,0,0.06\n");
    let sized = ["mesh", "example:plate:2000", "--size-field", "sizes.csv", "-o", "out.obj"];
    let vertices = |more: &[&str]| {
        desk.said(&[&sized[..], &["--report", "out.json"], more].concat());
        let report: Value = serde_json::from_slice(&desk.bytes("out.json")).expect("the report is JSON");
        report["mesh"]["vertices"].as_u64().expect("a count")
    };
    // The plate is a unit square with a hole, and takes 1 / 0.06^2 tiles at least and 1 / 0.03^2 at most but for its rim.
    let absolute = vertices(&[]);
    assert!((200..1_200).contains(&absolute), "{absolute}");
    let relative = vertices(&["--points", "2000"]);
    assert!(relative.abs_diff(2_000) < 100, "{relative}");

    let wing = ["mesh", "example:m6:2000", "--points", "500", "-o", "out.obj"];
    let mesh = |more: &[&str]| {
        desk.said(&[&wing[..], more].concat());
        desk.bytes("out.obj")
    };
    let twenty = mesh(&["--refine-curvature"]);
    assert_eq!(twenty, mesh(&["--refine-curvature", "20", "--max-growth", "1.2"]));
    assert_ne!(twenty, mesh(&["--refine-curvature", "20", "--max-growth", "1.1"]));
    assert_ne!(twenty, mesh(&[]));

    desk.put("sizes.csv", "0,0,0,0.1\n0,0,0,-1\n");
    let said = desk.refusal(1, &sized);
    assert!(said.contains("sizes.csv, line 2: the size -1 is not above 0"), "{said}");
}

const COMMANDS: [&str; 13] = [
    "mesh",
    "batch",
    "field",
    "mosaic",
    "picture",
    "study",
    "example",
    "check",
    "view",
    "serve",
    "devices",
    "completions",
    "man",
];

#[test]
fn completions_and_manual_know_every_subcommand() {
    let desk = Desk::new();
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let script = desk.said(&["completions", shell]);
        for word in COMMANDS.iter().chain(&["points", "refine-curvature"]) {
            assert!(script.contains(word), "{shell}: {word}");
        }
        assert!(!script.contains("refine-nothing"));
    }
    assert!(desk.refusal(2, &["completions", "abacus"]).contains("abacus"));

    desk.said(&["man", "-o", "pages"]);
    let page = |name: &str| text(&desk.bytes(&format!("pages/quadmosaic{name}.1")));
    for name in COMMANDS {
        assert!(page("").contains(name), "{name}");
        assert!(page(&format!("-{name}")).contains("SYNOPSIS"), "{name}");
    }
    assert!(page("-mesh").contains("refine\\-curvature") && !page("-check").contains("refine\\-curvature"));
    desk.put("file", "");
    assert!(desk.refusal(1, &["man", "-o", "file/pages"]).contains("file/pages"));
}

#[test]
fn help_explains_every_subcommand() {
    let desk = Desk::new();
    let help = desk.said(&["--help"]);
    for name in COMMANDS {
        assert!(help.contains(&format!("\n  {name}")), "{help}");
        assert!(desk.said(&[name, "--help"]).contains("Usage: quadmosaic"));
    }
    assert!(desk.said(&["--version"]).starts_with("quadmosaic "));
    desk.said(&["devices"]);
}

#[test]
fn pictures_of_all_kinds_are_drawn() {
    let desk = Desk::new();
    desk.put("square.obj", format!("{SQUARE}f 1 2 3 4\n"));
    let small = ["--size", "120x90"];
    let draw = |arguments: &[&str]| {
        let said = desk.said(&[&["picture"], arguments, &small[..]].concat());
        assert_eq!(said, "", "a picture says nothing");
    };
    draw(&["square.obj", "-o", "mesh.png"]);
    draw(&["square.obj", "-o", "mesh.svg", "--view", "top", "--colour", "quality", "--zoom-to", "0.5,0.5,0,0.2"]);
    draw(&["example:sphere:500", "-o", "surface.png", "--view", "-1,0.5,0.2", "--up", "0,1,0"]);
    draw(&["example:torus:500", "-o", "field.png", "--field", "--backend", "cpu"]);
    draw(&["example:torus:500", "-o", "crosses.svg", "--field=crosses", "--backend", "cpu", "--crease", "30"]);
    let mosaic = ["example:torus:500", "--mosaic", "--points", "200", "--backend", "cpu"];
    draw(&[&mosaic[..], &["--grout", "0.2", "-o", "mosaic.png"]].concat());
    draw(&[&mosaic[..], &["--grout", "0.2", "--fit", "1", "-o", "fitted.png"]].concat());
    assert_ne!(desk.bytes("mosaic.png"), desk.bytes("fitted.png"));
    for name in desk.names().iter().filter(|name| name.ends_with(".png")) {
        let bytes = desk.bytes(name);
        assert_eq!(bytes[..8], *b"\x89PNG\r\n\x1a\n", "{name}");
        assert_eq!(bytes[16..24], [0, 0, 0, 120, 0, 0, 0, 90], "{name}");
    }
    let svg = text(&desk.bytes("mesh.svg"));
    assert!(svg.contains("viewBox=\"0 0 120 90\"") && svg.contains("shape: Qg, Tg"), "{svg}");
    assert_eq!(desk.names().len(), 8);
    desk.said(&["mesh", "example:sphere:500", "--points", "100", "-o", "out.obj", "--picture", "out.png", "-q"]);
    assert_eq!(desk.bytes("out.png")[16..24], [0, 0, 6, 64, 0, 0, 4, 176]);
}

#[test]
fn pictures_that_cannot_be_are_refused() {
    let desk = Desk::new();
    desk.put("square.obj", format!("{SQUARE}f 1 2 3 4\n"));
    let refused = |code, arguments: &[&str], part: &str| {
        let message = desk.refusal(code, &[&["picture", "square.obj"], arguments].concat());
        assert!(message.contains(part), "{message}");
    };
    refused(2, &["-o", "a.jpg"], ".png or .svg");
    refused(2, &["-o", "a.png", "--size", "1600"], "1600x1200");
    refused(1, &["-o", "a.png", "--size", "1600x1"], "16 to 16384");
    refused(2, &["-o", "a.png", "--view", "sideways"], "three-quarter");
    refused(2, &["-o", "a.png", "--zoom-to", "0,0,1"], "4 numbers");
    refused(1, &["-o", "a.png", "--zoom-to", "0,0,0,0"], "radius");
    refused(1, &["-o", "a.png", "--view", "0,0,0"], "leads nowhere");
    refused(1, &["-o", "a.png", "--view", "top", "--up", "0,0,1"], "line of sight");
    refused(1, &["-o", "none/a.png"], "no such folder");
    refused(2, &["-o", "a.png", "--grout", "0.1"], "required arguments");
    refused(2, &["-o", "a.png", "--mosaic", "--field"], "cannot be used with");
}

#[test]
fn the_tiles_of_a_mesh_are_its_vertices() {
    let desk = Desk::new();
    let common = ["example:torus:2000", "--points", "600"];
    desk.said(&[&["mesh"], &common[..], &["-o", "mesh.obj", "--report", "mesh.json", "-q"]].concat());
    let said = desk.said(&[&["mosaic"], &common[..], &["-o", "tiles.obj", "--report", "tiles.json"]].concat());
    let [mesh, tiles]: [Value; 2] =
        ["mesh.json", "tiles.json"].map(|name| serde_json::from_slice(&desk.bytes(name)).expect("it is JSON"));
    assert_eq!(mesh["mosaic"]["tiles"], tiles["tiles"]);
    let squares = read_mesh(&desk.path("tiles.obj")).expect("it is a mesh");
    assert_eq!(tiles["tiles"], squares.face_count());
    assert_eq!(faces(&squares, 4), squares.face_count(), "a torus has no features");
    let coverage = tiles["fit"]["coverage"].as_f64().expect("a number");
    assert!(coverage > 0.85 && coverage <= 1.0, "{coverage}");
    for part in [format!("coverage  {coverage:.4}"), "overlap".to_owned(), "degrees between neighbours".to_owned()] {
        assert!(said.contains(&part), "no {part:?} in:\n{said}");
    }

    desk.said(&[&["mosaic"], &common[..], &["-o", "tiles.ply", "--picture", "tiles.png", "-q"]].concat());
    let coloured = read_mesh(&desk.path("tiles.ply")).expect("it is a mesh");
    assert_eq!(coloured.face_count(), squares.face_count());
    assert!(desk.refusal(2, &["mosaic", "example:torus", "-o", "tiles.stl"]).contains(".obj or .ply"));
    assert!(desk.refusal(2, &["mosaic", "example:torus", "-o", "a.obj", "--grout", "1"]).contains("0 to 0.9"));
}

#[test]
fn a_study_fills_its_folder_and_says_what_it_found() {
    let desk = Desk::new();
    let arguments = ["study", "example:torus:500", "example:torus:500", "-o", "new/study", "--points", "150"];
    assert!(desk.refusal(1, &arguments).contains("given twice"));
    let sweep = ["--angles", "20,30", "--distances", "1.6"];
    let said = desk.said(&[&arguments[..2], &arguments[3..], &sweep].concat());
    assert!(said.starts_with("example:torus:500, 150 points: Qr ") && said.contains("study.html"), "{said}");
    let csv = text(&desk.bytes("new/study/study.csv"));
    assert_eq!(csv.lines().count(), 3, "{csv}");
    assert!(desk.path("new/study/torus_500-qr.svg").is_file());
    for (option, wrong) in [("--points", "6000,1"), ("--angles", "30,50"), ("--distances", "0.5"), ("--angles", "")] {
        desk.refusal(2, &["study", "example:torus", "-o", "s", option, wrong]);
    }

    let fits = ["study", "example:torus:500", "-o", "fits", "--points", "150", "--angles", "30", "--distances", "1.6"];
    let more = ["--fits", "0,1", "--rows", "continuous", "--guide", "9,9,9,0,0,1"];
    let output = desk.run(&[&fits[..], &more].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(text(&output.stdout).contains("150 points, fit 1: Qr "), "{}", text(&output.stdout));
    assert!(desk.path("fits/torus_500-sides.svg").is_file());
    let said = text(&output.stderr);
    assert_eq!(said.matches("warning: ").count(), 1, "one for all rows: {said}");
    assert!(said.contains("--guide number 1: it is") && said.contains("away from the surface"), "{said}");
}

/// A unit square of 16 columns of quads with colours and texture coordinates: red is x, `u` is x and jumps by 10 at a column.
fn textured_square(jump_after: usize) -> String {
    const COLUMNS: usize = 16;
    let mut text = String::from("usemtl paint\n");
    for k in 0..=COLUMNS {
        let x = k as f64 / COLUMNS as f64;
        text += &format!("v {x} 0 0 {x} 0 1\nv {x} 1 0 {x} 0 1\n");
        text += &format!("vt {x} 0\nvt {x} 1\nvt {} 0\nvt {} 1\n", x + 10.0, x + 10.0);
    }
    for k in 0..COLUMNS {
        let [v, t] = [2 * k + 1, 4 * k + if k < jump_after { 1 } else { 3 }];
        text += &format!("f {v}/{t} {}/{} {}/{} {}/{}\n", v + 2, t + 4, v + 3, t + 5, v + 1, t + 1);
    }
    text
}

/// The values that corners have of an OBJ text: the place, red and the texture coordinates; a face a list.
fn textured_corners(text: &str) -> Vec<Vec<[f64; 4]>> {
    let rows = |keyword: &str| -> Vec<Vec<String>> {
        let lines = text.lines().map(|line| line.split_whitespace().map(str::to_owned).collect::<Vec<_>>());
        lines.filter(|words| words.first().is_some_and(|word| word == keyword)).collect()
    };
    let number = |word: &String| word.parse::<f64>().expect("a number");
    let (vertices, textures) = (rows("v"), rows("vt"));
    let corner = |word: &String| {
        let (v, t) = word.split_once('/').expect("texture coordinates");
        let [v, t] = [v, t].map(|word| word.parse::<usize>().expect("an index") - 1);
        let (v, t) = (&vertices[v], &textures[t]);
        [number(&v[1]), number(&v[4]), number(&t[1]), number(&t[2]) - number(&v[2])]
    };
    rows("f").iter().map(|face| face[1..].iter().map(corner).collect()).collect()
}

#[test]
fn colours_and_texture_coordinates_are_carried_and_seams_kept() {
    let desk = Desk::new();
    desk.put("in.obj", textured_square(5));
    let seam = 5.0 / 16.0;
    let meshed = |keep: bool| {
        let arguments = ["mesh", "in.obj", "--points", "150", "-o", "out.obj", "--keep-uv"];
        let done = desk.run(&arguments[..if keep { 7 } else { 6 }]);
        assert!(done.status.success() && done.stderr.is_empty(), "{}", text(&done.stderr));
        textured_corners(&text(&desk.bytes("out.obj")))
    };
    let is_across = |face: &Vec<[f64; 4]>| {
        face.iter().any(|corner| corner[0] < seam - 1e-9) && face.iter().any(|corner| corner[0] > seam + 1e-9)
    };
    let faces = meshed(true);
    assert!(faces.len() > 100 && !faces.iter().any(is_across));
    for face in &faces {
        let middle = face.iter().map(|corner| corner[0]).sum::<f64>() / face.len() as f64;
        for &[x, red, u, v_off] in face {
            let wanted = if middle < seam { x } else { x + 10.0 };
            assert!((red - x).abs() < 1e-9 && (u - wanted).abs() < 1e-9 && v_off.abs() < 1e-9, "{face:?}");
        }
    }
    assert!(meshed(false).iter().any(is_across), "without the option the seam is no feature");
}

#[test]
fn what_is_not_carried_is_told_in_a_line() {
    let desk = Desk::new();
    desk.put("in.obj", textured_square(16));
    let told = |arguments: &[&str]| {
        let done = desk.run(&[&["mesh", "in.obj", "--size", "0.1"], arguments].concat());
        assert!(done.status.success(), "{}", text(&done.stderr));
        text(&done.stderr)
    };
    for format in ["obj", "ply", "vtk", "vtu", "glb"] {
        assert_eq!(told(&["-o", &format!("out.{format}")]), "");
    }
    let message = told(&["-o", "out.stl"]);
    let wanted =
        "warning: not carried to out.stl: colours, texture coordinates; ply, vtk and vtu hold numbers of vertices\n";
    assert_eq!(message, wanted);
    // What was carried is carried again from the results.
    for (from, to) in [("ply", "vtu"), ("vtk", "ply"), ("vtu", "vtk")] {
        let arguments = ["mesh", &format!("out.{from}"), "--size", "0.1", "-o", &format!("again.{to}")];
        let done = desk.run(&arguments);
        let message = text(&done.stderr);
        let cells = if from == "ply" { "" } else { "not carried to" };
        assert!(done.status.success() && message.contains(cells) && !message.contains("colours"), "{message}");
        let again = read(&desk.path(&format!("again.{to}"))).expect("a surface").attributes;
        let names: Vec<&str> = again.list.iter().map(|attribute| &*attribute.name).collect();
        assert!(names.contains(&"RGB") && names.contains(&"TCoords"), "{names:?}");
    }
    let refused = desk.refusal(2, &["mesh", "in.obj", "--size", "0.1", "-o", "source.obj", "--with-source"]);
    assert!(refused.contains("--with-source goes with ply, vtk and vtu"), "{refused}");
}

/// A cube of side 10 as binary STL, a corner of it at (x, x, x).
fn far_cube(x: f32) -> Vec<u8> {
    let corner = |k: usize| [k & 1, k >> 1 & 1, k >> 2].map(|bit| x + 10.0 * bit as f32);
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles: Vec<_> = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    let mut bytes = vec![b' '; 80];
    bytes.extend((triangles.len() as u32).to_le_bytes());
    for triangle in triangles {
        bytes.extend([0; 12]);
        bytes.extend(triangle.iter().flat_map(|&k| corner(k)).flat_map(f32::to_le_bytes));
        bytes.extend([0; 2]);
    }
    bytes
}

#[test]
fn coordinates_too_coarse_for_the_tiles_are_told() {
    let desk = Desk::new();
    // Steps are 0.0625 at the first place, and tiles have sides of about 0.8. At the second, coordinates are whole numbers.
    for (x, is_told) in [(1_000_000.06, true), (1_000_000.0, false), (0.062_5, false)] {
        desk.put("in.stl", far_cube(x));
        let done = desk.run(&["mesh", "in.stl", "--points", "1000", "-o", "out.obj"]);
        let message = text(&done.stderr);
        assert!(done.status.success(), "{message}");
        assert_eq!(message.contains("multiples of 6.2e-2, as f32 has them"), is_told, "{x}: {message}");
        assert_eq!(message.contains("move the model to the origin"), is_told, "{x}: {message}");
    }
}

#[test]
fn materials_are_regions_of_the_mesh() {
    let desk = Desk::new();
    let plate = "o plate\nv 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0\n";
    desk.put("in.obj", format!("{plate}usemtl steel\nf 1 2 5 4\nusemtl rubber\nf 2 3 6 5\n"));
    desk.said(&["mesh", "in.obj", "--points", "60", "-o", "out.obj"]);
    let mesh = read_mesh(&desk.path("out.obj")).expect("it is a mesh");
    assert_eq!(mesh.regions.names, ["plate steel", "plate rubber"]);
    for (face, region) in mesh.faces().zip(&mesh.regions.of_face) {
        let middle = face.iter().map(|&v| mesh.points[v as usize][0]).sum::<f64>() / face.len() as f64;
        assert_eq!(*region == 0, middle < 1.0, "the border is kept");
    }
}

#[test]
fn the_boundary_of_the_surface_is_kept_in_the_file() {
    let desk = Desk::new();
    desk.said(&["example", "plate", "--triangles", "1000", "-o", "plate.obj"]);
    let rim = |file: &str| {
        let mesh = read_mesh(&desk.path(file)).expect("it is a mesh");
        let open = mesh.edges().into_iter().filter(Edge::is_boundary).flat_map(|edge| edge.ends);
        open.map(|v| mesh.points[v as usize].map(f64::to_bits)).collect::<std::collections::BTreeSet<_>>()
    };
    let mesh = ["mesh", "plate.obj", "--points", "300", "-o", "out.obj", "--report", "out.json"];
    let said = desk.said(&[&mesh[..], &["--keep-boundary"]].concat());
    assert_eq!(rim("out.obj"), rim("plate.obj"));
    let report: Value = serde_json::from_slice(&desk.bytes("out.json")).expect("it is JSON");
    assert_eq!(report["boundary"]["edges"], rim("plate.obj").len());
    assert!(said.contains(&format!("boundary   {} edges kept", rim("plate.obj").len())), "{said}");
    desk.said(&[&mesh[..], &["--keep-boundary=0.05"]].concat());
    // 20 intervals on each side of length 1, and an even number near 8 pi round the hole.
    assert_eq!(rim("out.obj").len(), 4 * 20 + 26);
    assert!(!desk.said(&mesh).contains("boundary   "));
    assert_ne!(rim("out.obj"), rim("plate.obj"));
    for (refused, message) in [
        (["--keep-boundary=0"].as_slice(), "write exact"),
        (&["--keep-boundary", "--symmetry=x"], "cannot be used with"),
    ] {
        let said = desk.refusal(2, &[&mesh[..6], refused].concat());
        assert!(said.contains(message), "{said}");
    }
}

#[test]
fn a_symmetric_mesh_is_written_bit_for_bit() {
    let desk = Desk::new();
    let mesh = ["mesh", "example:m6:2000", "--points", "300", "-o", "out.obj", "--report", "out.json", "--symmetry"];
    let said = |symmetry: &str| desk.said(&[&mesh[..], &[symmetry]].concat());
    assert!(said("auto").contains("symmetry   about z = 0, found; "));
    let report: Value = serde_json::from_slice(&desk.bytes("out.json")).expect("it is JSON");
    assert_eq!((&report["symmetry"]["plane"]["axis"], &report["symmetry"]["is_found"]), (&"z".into(), &true.into()));
    let points = read_mesh(&desk.path("out.obj")).expect("it is a mesh").points;
    assert!(points.iter().all(|&[x, y, z]| points.contains(&[x, y, -z])), "0 and -0 are the same");
    assert!(said("z").contains("symmetry   about z = 0; "));
    for (symmetry, refusal) in [("y", "lies wholly on one side of the plane y = 0, from 0.0"), ("w", "write x, y or z")]
    {
        let message = text(&desk.run(&[&mesh[..], &[symmetry]].concat()).stderr);
        assert!(message.contains(refusal), "{message}");
    }
}
