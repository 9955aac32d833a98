//! Layouts, presets and files of options: what they set, what overrides them, and what is refused.

#[path = "common/desk.rs"]
mod desk;

use desk::{Desk, text};
use quadmosaic::options::Preset;
use quadmosaic::pipeline::Contradiction;
use quadmosaic::surface::examples::Example;
use quadmosaic::{Fineness, Layout, Mesher, Options, PipelineError};

/// The bytes of a small mesh by these options.
fn mesh(desk: &Desk, options: &[&str]) -> Vec<u8> {
    let mut arguments = vec!["mesh", "example:torus:1000", "--quiet", "-o", "out.obj"];
    if !options.iter().any(|option| ["--config", "--preset"].contains(option)) {
        arguments.extend(["--points", "300"]);
    }
    arguments.extend(options);
    desk.said(&arguments);
    desk.bytes("out.obj")
}

/// What `--print-config` prints, without the options of no effect.
fn printed(desk: &Desk, options: &[&str]) -> Vec<String> {
    let text = desk.said(&[&["mesh", "--print-config"], options].concat());
    text.lines().filter(|line| !line.starts_with('#')).map(str::to_owned).collect()
}

#[test]
fn a_layout_is_its_options_and_each_of_them_overrides_it() {
    let desk = Desk::new();
    let quads = mesh(&desk, &["--layout", "quads"]);
    let even = mesh(&desk, &["--layout", "even"]);
    let mosaic = mesh(&desk, &["--layout", "mosaic"]);
    assert_eq!(quads, mesh(&desk, &["--fit", "1", "--rows", "continuous", "--quads", "all"]));
    assert_eq!(even, mesh(&desk, &["--fit", "1"]));
    assert_eq!(mosaic, mesh(&desk, &[]));
    assert!(quads != even && even != mosaic && mosaic != quads);

    let half = mesh(&desk, &["--fit", "0.5", "--layout", "quads"]);
    assert_eq!(half, mesh(&desk, &["--fit", "0.5", "--rows", "continuous", "--quads", "all"]));
    assert_ne!(half, quads);
}

#[test]
fn the_library_has_the_layouts_of_the_command_line() {
    let made = |options: &Options| {
        let outcome = Mesher::cpu().mesh(&Example::Torus.generate(1_000), options);
        outcome.map(|outcome| outcome.meshed.mesh.quads().collect::<Vec<_>>())
    };
    let plain = || Options::new(Fineness::Points(300));
    let quads = plain().with_layout(Layout::Quads);
    let mut by_hand = plain();
    for (name, value) in [("fit", "1"), ("rows", "continuous"), ("quads", "all")] {
        by_hand.set(name, value).expect("it is a value");
    }
    assert_eq!(made(&quads).expect("a mesh"), made(&by_hand).expect("a mesh"));
    assert_ne!(made(&quads).expect("a mesh"), made(&plain()).expect("a mesh"));

    let refused = made(&Options { connectivity: None, ..quads });
    assert!(matches!(refused, Err(PipelineError::Contradiction(Contradiction::NoCleanUp))));
    assert!(made(&Options { connectivity: None, ..plain().with_layout(Layout::Even) }).is_ok());
}

#[test]
fn what_contradicts_a_layout_is_refused() {
    let desk = Desk::new();
    let refused = |options: &[&str]| {
        let file = ["mesh", "example:torus:1000", "--points", "300", "-o", "out.ply"];
        desk.refusal(2, &[&file, options].concat())
    };
    for (options, message) in [
        (
            ["--layout", "quads", "--quads", "paper"].as_slice(),
            "the layout quads has no triangles, but quads paper keeps",
        ),
        (&["--layout", "quads", "--quads", "most"], "the layout quads has no triangles, but quads most keeps some"),
        (&["--layout", "quads", "--no-cleanup"], "the layout quads needs the clean-up"),
        (&["--layout", "quads", "--holes", "leave"], "the layout quads has no polygons, but holes leave keeps some"),
        (
            &["--layout", "even", "--fit", "0"],
            "the layout even has sides that fit the field, but fit 0 makes them equal",
        ),
        (
            &["--layout", "even", "--aspect", "2"],
            "the layout even has sides that fit the field, which rectangular tiles",
        ),
        (&["--layout", "odd"], "invalid value 'odd' for '--layout <LAYOUT>'"),
    ] {
        let said = refused(options);
        assert!(said.contains(message), "{options:?}: {said}");
    }
    // Each has a partner that is none.
    for options in [
        ["--layout", "even", "--quads", "paper"].as_slice(),
        &["--layout", "even", "--no-cleanup"],
        &["--layout", "quads", "--fit", "0.5"],
    ] {
        mesh(&desk, options);
    }
}

#[test]
fn a_preset_is_its_options_and_each_of_them_overrides_it() {
    let desk = Desk::new();
    for preset in Preset::ALL {
        let lines = printed(&desk, &["--preset", preset.name()]);
        let origin = format!("# preset {}", preset.name());
        for (name, value) in preset.settings() {
            let line = lines.iter().find(|line| line.starts_with(&format!("{name} = ")));
            let line = line.unwrap_or_else(|| panic!("{name} is not in {lines:?}"));
            assert!(line.contains(value) && line.ends_with(&origin), "{line}");
        }
    }
    let overridden = printed(&desk, &["--preset", "retopo", "--size", "0.5", "--layout", "even"]);
    assert!(overridden.contains(&"size = 0.5  # command line".to_owned()), "{overridden:?}");
    assert!(overridden.contains(&"fit = 1  # layout even".to_owned()), "{overridden:?}");
    assert!(!overridden.iter().any(|line| line.contains("preset") || line.starts_with("points")), "{overridden:?}");

    let overridden = printed(&desk, &["--preset", "fem", "--layout", "mosaic"]);
    assert!(overridden.contains(&"quads = \"most\"  # layout mosaic".to_owned()), "{overridden:?}");

    let small = ["--points", "300"];
    let fem = mesh(&desk, &[&["--preset", "fem"], small.as_slice()].concat());
    assert_eq!(fem, mesh(&desk, &["--layout", "even", "--quads", "all"]));
    assert_ne!(fem, mesh(&desk, &[]));
}

#[test]
fn the_command_line_overrides_a_file_and_a_file_a_preset() {
    let desk = Desk::new();
    desk.put("own.toml", "preset = \"scan\"\ncrease = 50\nquads = \"all\"\nstrict = true\npoints = 400\n");
    let lines = printed(&desk, &["--config", "own.toml"]);
    for line in [
        "crease = 50  # own.toml",
        "ridge = 180  # preset scan",
        "quads = \"all\"  # own.toml",
        "strict = true  # own.toml",
    ] {
        assert!(lines.contains(&line.to_owned()), "{line} is not in {lines:?}");
    }
    let lines =
        printed(&desk, &["--config", "own.toml", "--preset", "fem", "--size", "0.5", "--no-cleanup", "--strict=false"]);
    for line in [
        "layout = \"even\"  # preset fem",
        "size = 0.5  # command line",
        "no-cleanup = true  # command line",
        "strict = false  # command line",
    ] {
        assert!(lines.contains(&line.to_owned()), "{line} is not in {lines:?}");
    }
    for gone in ["points", "quads", "ridge"] {
        assert!(!lines.iter().any(|line| line.starts_with(gone)), "{gone} is in {lines:?}");
    }
}

#[test]
fn what_is_printed_can_be_read_and_gives_the_same_bytes() {
    let desk = Desk::new();
    desk.put("guides.csv", "0.7,0,0,0,0,1\n");
    let options = [
        "--preset",
        "fem",
        "--points",
        "300",
        "--refine-curvature",
        "--guide",
        "0,0.7,0,0,0,1,0.3",
        "--guide",
        "-0.7,0,0,0,0,1",
        "--guides",
        "guides.csv",
        "--weld",
        "0.1%",
        "--crease",
        "35.5",
        "--keep-uv",
    ];
    let first = mesh(&desk, &options);
    desk.put("printed.toml", desk.said(&[&["mesh", "--print-config"], options.as_slice()].concat()));
    assert_eq!(mesh(&desk, &["--config", "printed.toml"]), first);
    let bare = |lines: Vec<String>| -> Vec<String> {
        lines.iter().filter_map(|line| Some(line.rsplit_once("  # ")?.0.to_owned())).collect()
    };
    assert_eq!(bare(printed(&desk, &["--config", "printed.toml"])), bare(printed(&desk, &options)));
    assert_ne!(mesh(&desk, &["--config", "printed.toml", "--fit", "0.3"]), first);
}

#[test]
fn faulty_files_are_refused_with_the_line() {
    let desk = Desk::new();
    let refused = |content: &str, code: i32| {
        desk.put("own.toml", content);
        desk.refusal(code, &["mesh", "example:torus:1000", "--config", "own.toml", "-o", "out.obj"])
    };
    for (content, message) in [
        ("# first\n\nquad = \"all\"\n", "own.toml, line 3: there is no option quad for a file; perhaps quads is meant"),
        ("config = \"own.toml\"\n", "own.toml, line 1: there is no option config for a file"),
        ("points = 3\n", "own.toml, line 1: invalid value '3' for '--points <N>': ask for 4 to 50000000 vertices"),
        (
            "fit = 1\nquads = \"few\"\n",
            "own.toml, line 2: invalid value 'few' for '--quads <QUADS>' [possible values: paper, most",
        ),
        ("strict = 1\n", "own.toml, line 1: strict takes true or false, not what TOML calls integer"),
        ("fit = true\n", "own.toml, line 1: fit takes a number or a text in quotes, not what TOML calls boolean"),
        ("fit = [0.5]\n", "own.toml, line 1: fit takes a number or a text in quotes, not what TOML calls array"),
        ("[fit]\nx = 1\n", "own.toml, line 1: fit takes a number or a text in quotes, not what TOML calls table"),
        ("points = 300\nsize = 1\n", "own.toml, line 2: the argument '--"),
        ("points = 300\n\nfit = \n", "own.toml, line 3: "),
        ("fit = 1\nfit = 0\n", "own.toml, line 2: duplicate key"),
        ("layout = \"quads\"\nquads = \"paper\"\n", "the layout quads has no triangles"),
    ] {
        let said = refused(content, 2);
        assert!(said.contains(message), "{content:?}: {said}");
    }
    desk.put("own.toml", "# first\n\nquads = \"all\"\nfit = 1\nguide = [\"0.7,0,0,0,0,1\"]\npoints = 300\n");
    mesh(&desk, &["--config", "own.toml"]);
    let missing = desk.refusal(1, &["mesh", "example:torus", "--config", "none.toml", "-o", "out.obj"]);
    assert!(missing.starts_with("error: none.toml cannot be read"), "{missing}");
}

#[test]
fn a_boundary_is_kept_by_a_file() {
    let desk = Desk::new();
    for line in ["keep-boundary = \"exact\"", "keep-boundary = 0.25"] {
        desk.put("own.toml", line);
        assert!(printed(&desk, &["--config", "own.toml"]).contains(&format!("{line}  # own.toml")), "{line}");
    }
    desk.put("own.toml", "keep-boundary = true");
    let said = desk.refusal(2, &["mesh", "example:plate:500", "--config", "own.toml", "-o", "out.obj"]);
    assert!(said.contains("own.toml, line 1: keep-boundary takes a number or a text in quotes"), "{said}");
}

#[test]
fn a_batch_has_them_too() {
    let desk = Desk::new();
    desk.put("own.toml", "layout = \"even\"\npoints = 300\noutput = \"meshes\"\n");
    desk.said(&["batch", "example:torus:1000", "--backend", "cpu", "--config", "own.toml"]);
    assert_eq!(desk.bytes("meshes/torus_1000.obj"), mesh(&desk, &["--layout", "even"]));
    let lines = desk.said(&["batch", "--print-config", "--config", "own.toml", "--layout", "mosaic"]);
    assert!(lines.contains("\nlayout = \"mosaic\"  # command line\n"), "{lines}");
    let refused =
        desk.refusal(2, &["batch", "example:torus:1000", "-o", "meshes", "--layout", "quads", "--no-cleanup"]);
    assert!(refused.contains("the layout quads needs the clean-up"), "{refused}");
}

#[test]
fn short_help_has_a_line_an_option_and_long_help_all() {
    let desk = Desk::new();
    let [short, long] = ["-h", "--help"].map(|help| desk.said(&["mesh", help]));
    for heading in [
        "Options together:",
        "Input:",
        "Output:",
        "Fineness:",
        "Rows:",
        "Features:",
        "Repairs:",
        "Connection:",
        "Machine:",
    ] {
        assert!(short.contains(&format!("\n{heading}\n")) && long.contains(&format!("\n{heading}\n")), "{heading}");
    }
    let is_option = |line: &&str| line.starts_with("  -") || line.starts_with("      --");
    let options = |text: &str| text.lines().filter(is_option).count();
    assert!(options(&short) > 40, "{short}");
    assert_eq!(options(&short), options(&long));
    let advice = "`even` on smooth";
    assert!(long.contains(advice) && !short.contains(advice));
    let lines = [&short, &long].map(|text| text.lines().count());
    assert!(lines[0] < 2 * options(&short) + 30 && lines[1] > 2 * lines[0], "{lines:?}");
}

#[test]
fn options_without_effect_are_warned_of() {
    let desk = Desk::new();
    let warned = |options: &[&str]| {
        let file = ["mesh", "example:sphere:2000", "--points", "300", "-o", "out.obj", "--report", "out.json"];
        let output = desk.run(&[&file, options].concat());
        assert!(output.status.success(), "{}", text(&output.stderr));
        text(&output.stderr)
    };
    for (idle, told, partner) in [
        (
            ["--fit-range", "3"].as_slice(),
            "warning: the fit range had no effect",
            ["--fit", "1", "--fit-range", "3"].as_slice(),
        ),
        (&["--max-growth", "1.5"], "warning: the largest growth had no effect", &["--max-growth", "1.5", "--fit", "1"]),
        (&["--ignore-regions"], "warning: ignoring regions had no effect", &[]),
        (&["--keep-uv"], "warning: keeping seams had no effect", &[]),
        (&["--keep-boundary"], "warning: keeping the boundary had no effect", &[]),
        (&["--refine-curvature", "80"], "warning: refining by curvature had no effect", &[]),
        (&["--around", "4"], "warning: the number of edges round thin parts had no effect", &["--around", "2"]),
        (&["--around-holes", "9"], "warning: the number of edges round holes had no effect", &[]),
        (&["--size-at", "-9,-9,-9,9,9,9:9"], "warning: the sizes at places", &["--size-at", "0,0,0,9,9,9:0.1"]),
        (
            &["--min-size", "1e-4"],
            "warning: the least size had no effect",
            &["--min-size", "0.1", "--size-at", "0,0,0,9,9,9:0.02"],
        ),
        (&["--max-size", "9"], "warning: the largest size had no effect", &["--max-size", "0.1"]),
        (&["--weld", "1e-6"], "warning: welding had no effect", &[]),
        (&["--imprint"], "warning: imprinting had no effect", &[]),
        (&["--drop-parts", "0.1"], "warning: dropping parts had no effect", &[]),
        (&["--fill-holes", "0.1"], "warning: filling holes had no effect", &["--preset", "scan"]),
        (&["--adapter", "none"], "warning: --adapter had no effect with --backend cpu", &[]),
    ] {
        let said = warned(idle);
        assert!(said.contains(told), "{idle:?}: {said}");
        let said = warned(partner);
        assert!(!said.contains("no effect"), "{partner:?}: {said}");
    }
    warned(&["--fit-range", "3"]);
    assert!(text(&desk.bytes("out.json")).contains("\"fit_range\""));
}
