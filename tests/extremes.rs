//! Inputs at the ends of what can be: nested without end, and surfaces a billion times as long as wide.

#[path = "common/desk.rs"]
mod desk;

use desk::{Desk, text};
use quadmosaic::{Fineness, Mesher, Options, PipelineError, Soup};

#[test]
fn nesting_is_bounded() {
    let desk = Desk::new();
    let deep = 1_000_000;
    let [open, close] = ["[", "]"].map(|bracket| bracket.repeat(deep));
    desk.put("guides.json", format!("{{\"guides\": {open}{close}}}"));
    desk.put("options.toml", format!("guide = {open}{close}\n"));
    desk.put(
        "surface.vtu",
        format!("<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\">{}", "<Piece>".repeat(deep)),
    );
    desk.put("plain.json", "{\"guides\": [{\"point\": [1, 0, 0], \"direction\": [0, 0, 1]}]}");
    let plain = ["mesh", "example:sphere:500", "--points", "100", "-q", "-o", "out.obj"];
    for (arguments, file) in [
        ([&plain[..], &["--guides", "guides.json"]].concat(), "guides.json"),
        ([&plain[..], &["--config", "options.toml"]].concat(), "options.toml"),
        (vec!["mesh", "surface.vtu", "-o", "out.obj"], "surface.vtu"),
    ] {
        let output = desk.run(&arguments);
        let told = text(&output.stderr);
        assert!(
            matches!(output.status.code(), Some(1 | 2)) && told.starts_with("error: "),
            "{file}: {:?}",
            output.status
        );
        assert!(told.lines().next().is_some_and(|line| line.contains(file)), "{told}");
    }
    desk.said(&[&plain[..], &["--guides", "plain.json"]].concat());
}

/// A plate of so many rows of two triangles, a billion times as long as wide or less.
fn plate(length: f64, rows: u32) -> Soup {
    let ends = |k: u32| [0.0, 1.0].map(|y| [length * f64::from(k) / f64::from(rows), y, 0.0]);
    let points = (0..=rows).flat_map(ends).collect();
    let triangles = (0..rows).flat_map(|k| [[2 * k, 2 * k + 2, 2 * k + 3], [2 * k, 2 * k + 3, 2 * k + 1]]).collect();
    Soup::new(points, triangles)
}

#[test]
fn a_surface_a_billion_times_as_long_as_wide_is_meshed_or_refused() {
    let mesh = |length, rows| Mesher::cpu().mesh(&plate(length, rows), &Options::new(Fineness::Points(100)));
    let sound = mesh(20.0, 10).unwrap_or_else(|error| panic!("{error}"));
    assert!(sound.meshed.faults.is_clean());
    for rows in [1, 10, 1_000] {
        for length in [1e4, 1e6, 1e9] {
            match mesh(length, rows) {
                Ok(outcome) => assert!(outcome.meshed.mesh.face_count() > 0, "{length:e}, {rows} rows"),
                Err(error) => assert!(matches!(error, PipelineError::Surface(_)), "{length:e}, {rows} rows: {error}"),
            }
        }
    }
}
