//! Pages: what is written is read back here as the page's script reads it, and compared with the mesh.

mod common;

use base64::prelude::{BASE64_STANDARD, Engine};
use common::surfaces::{example, surface};
use quadmosaic::mesh::Mesh;
use quadmosaic::mesh::quality::Quality;
use quadmosaic::page::{MOST_TRIANGLES, Page, PageError, served_html, write_page};
use quadmosaic::surface::Regions;
use quadmosaic::{Fineness, Mesher, Options, Outcome};
use serde_json::Value;
use std::fs;
use std::process::Command;

/// The data of a page.
fn data(html: &str) -> Value {
    let start = html.find("id=\"data\">").expect("there is data") + "id=\"data\">".len();
    let length = html[start..].find("</script>").expect("the data ends");
    serde_json::from_str(&html[start..start + length]).expect("it is JSON")
}

fn words(value: &Value) -> Vec<[u8; 4]> {
    let bytes = BASE64_STANDARD.decode(value.as_str().expect("it is text")).expect("it is base64");
    let (words, rest) = bytes.as_chunks::<4>();
    assert!(rest.is_empty());
    words.to_vec()
}

fn floats(value: &Value) -> Vec<f32> {
    words(value).into_iter().map(f32::from_le_bytes).collect()
}

fn indices(value: &Value) -> Vec<u32> {
    words(value).into_iter().map(u32::from_le_bytes).collect()
}

/// Faces of a page.
#[derive(Clone)]
struct Faces {
    points: Vec<f32>,
    corners: Vec<u32>,
    ends: Vec<u32>,
}

impl Faces {
    fn of(value: &Value) -> Self {
        let points = floats(&value["points"]);
        let corners = match &value["corners"] {
            Value::Null => (0..points.len() as u32 / 3).collect(),
            corners => indices(corners),
        };
        let ends = match &value["ends"] {
            Value::Null => (3..=corners.len() as u32).step_by(3).collect(),
            ends => indices(ends),
        };
        Self { points, corners, ends }
    }

    /// What is wrong with them.
    fn fault(&self) -> Option<&'static str> {
        let vertices = self.points.len() / 3;
        if !self.points.len().is_multiple_of(3) {
            return Some("a vertex without three coordinates");
        }
        if self.corners.iter().any(|&corner| corner as usize >= vertices) {
            return Some("a corner out of range");
        }
        if self.ends.last().copied() != Some(self.corners.len() as u32) {
            return Some("corners without a face");
        }
        let starts = [0].iter().chain(&self.ends);
        let is_small = starts.zip(&self.ends).any(|(&start, &end)| end < start + 3);
        is_small.then_some("a face of less than three corners")
    }

    fn points_near(&self, data: &Value, points: &[[f64; 3]]) -> bool {
        let [diagonal, centre] = ["diagonal", "centre"].map(|name| &data[name]);
        let diagonal = diagonal.as_f64().expect("a number");
        let model = |k: usize, x: f32| f64::from(x) * diagonal + centre[k].as_f64().expect("a number");
        let places = self.points.chunks(3).zip(points);
        self.points.len() == 3 * points.len()
            && places
                .into_iter()
                .all(|(place, point)| (0..3).all(|k| (model(k, place[k]) - point[k]).abs() < 1e-7 * diagonal))
    }
}

fn run(name: &str, points: usize) -> Outcome {
    let soup = example(name, 4_000);
    let options = Options::new(Fineness::Points(points));
    Mesher::cpu().mesh(&soup, &options).unwrap_or_else(|error| panic!("{error}"))
}

fn page(outcome: &Outcome) -> Page {
    let Outcome { surface, field, mosaic, meshed, .. } = outcome;
    let page = Page::new("a block", &meshed.mesh).unwrap_or_else(|error| panic!("{error}"));
    page.with_surface(surface).with_features(surface).with_field(surface, field).with_tiles(surface, mosaic)
}

#[test]
fn a_page_holds_the_mesh_and_what_it_was_made_of() {
    let outcome = run("block", 1_000);
    let data = data(&page(&outcome).html());
    let mesh = &outcome.meshed.mesh;

    let faces = Faces::of(&data["mesh"]);
    assert_eq!(faces.fault(), None);
    assert_eq!(faces.corners, mesh.faces().flatten().copied().collect::<Vec<u32>>());
    assert_eq!(faces.ends.len(), mesh.face_count());
    assert!(faces.points_near(&data, &mesh.points));
    let mut moved = mesh.points.clone();
    moved[7][1] += 1e-3;
    assert!(!faces.points_near(&data, &moved), "a vertex elsewhere is seen");

    let triangles = Faces::of(&data["surface"]);
    assert_eq!(triangles.fault(), None);
    assert_eq!(triangles.ends.len(), outcome.surface.triangle_count());
    let tiles = Faces::of(&data["tiles"]);
    assert_eq!(tiles.fault(), None);
    assert!(tiles.ends.len() >= outcome.mosaic.count());

    let lines: Vec<(&str, usize)> = data["lines"]
        .as_array()
        .expect("a list")
        .iter()
        .map(|lines| {
            let ends = floats(&lines["ends"]);
            assert!(ends.len().is_multiple_of(6) && ends.iter().all(|x| x.abs() < 0.6), "all is near the mesh");
            (lines["name"].as_str().expect("a name"), ends.len() / 6)
        })
        .collect();
    let edges: usize = outcome.surface.features().curves().iter().map(|curve| curve.half_edges.len()).sum();
    assert_eq!(lines[1..], [("feature curves", edges), ("dropped creases", 0)]);
    assert!(lines[0].0 == "cross field" && lines[0].1 > 1_000);

    let counts: Vec<usize> =
        data["dots"].as_array().expect("a list").iter().map(|dots| floats(&dots["points"]).len() / 3).collect();
    assert_eq!(counts[..3].iter().sum::<usize>(), Quality::of(mesh).irregular_vertices);
    assert_eq!(counts[3..].iter().sum::<usize>(), outcome.field.singularities(&outcome.surface).len());

    let sums: Vec<u64> = data["histograms"]
        .as_array()
        .expect("a list")
        .iter()
        .map(|histogram| histogram["counts"].as_array().expect("a list").iter().filter_map(Value::as_u64).sum())
        .collect();
    let quality = Quality::of(mesh);
    let corners = mesh.faces().flatten().count();
    let expected = [mesh.face_count(), quality.quads, corners, mesh.edges().len(), quality.interior_vertices];
    assert_eq!(sums, expected.map(|count| count as u64));
    for scale in data["scales"].as_array().expect("a list") {
        assert_eq!(floats(&scale["shares"]).len(), mesh.face_count());
    }
}

#[test]
fn faces_that_are_wrong_are_seen_to_be() {
    let outcome = run("block", 300);
    let faces = Faces::of(&data(&page(&outcome).html())["mesh"]);
    assert_eq!(faces.fault(), None);
    let with = |change: &dyn Fn(&mut Faces)| {
        let mut changed = faces.clone();
        change(&mut changed);
        changed.fault()
    };
    let vertices = faces.points.len() as u32 / 3;
    assert_eq!(with(&|faces| faces.corners[5] = vertices), Some("a corner out of range"));
    assert_eq!(with(&|faces| faces.corners.push(0)), Some("corners without a face"));
    assert_eq!(with(&|faces| faces.ends[0] = 2), Some("a face of less than three corners"));
    assert_eq!(with(&|faces| faces.points.push(0.0)), Some("a vertex without three coordinates"));
}

#[test]
fn names_and_regions_end_neither_the_data_nor_the_title() {
    let mut mesh = Mesh::new(vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]);
    mesh.push_face(&[0, 1, 2]);
    mesh.push_face(&[0, 2, 3]);
    let name = "</script></title>{{data}}<b>";
    mesh.regions = Regions { names: vec![name.to_owned(), "b".to_owned()], of_face: vec![0, 1] };
    let page = Page::new(name, &mesh).unwrap_or_else(|error| panic!("{error}"));
    let html = page.with_figures([(name.to_owned(), name.to_owned())]).with_note(name).html();
    let data = data(&html);
    let told = [&data["name"], &data["regions"]["names"][0], &data["figures"][0][1], &data["notes"][0]];
    assert_eq!(told, [name; 4]);
    assert_eq!(indices(&data["regions"]["of_face"]), [0, 1]);
    assert_eq!(["</script>", "</title>"].map(|end| html.matches(end).count()), [2, 1]);
}

#[test]
fn a_page_names_no_other_place() {
    let html = page(&run("sphere", 300)).html();
    // The namespace of SVG is a name, and nothing is fetched from there.
    assert_eq!(html.matches("://").count(), html.matches("http://www.w3.org/2000/svg").count());
    assert!(html.contains("default-src 'none'"), "and the browser refuses any");
    assert!(!html.contains("connect-src") && !html.contains("fetch("), "a file asks nobody");
    let served = served_html("a sphere", &page(&run("sphere", 300)).json());
    assert_eq!(served.matches("://").count(), html.matches("://").count());
    assert_eq!(served.matches("connect-src 'self'").count(), 1, "a page that is served asks its server alone");
    assert!(data(&served)["mesh"].is_object());
}

#[test]
fn what_is_too_large_is_left_out_and_told() {
    let mesh = Mesh::from(example("sphere", 1_000));
    let notes = |triangles: usize| {
        let page = Page::new("a sphere", &mesh).unwrap_or_else(|error| panic!("{error}"));
        let data = data(&page.with_surface(&surface(&example("sphere", triangles))).html());
        (data["surface"].is_null(), data["notes"].as_array().map(Vec::len))
    };
    assert_eq!(notes(2_000), (false, Some(0)));
    assert_eq!(notes(MOST_TRIANGLES + 5_000), (true, Some(1)));
}

#[test]
fn what_cannot_be_shown_is_refused() {
    let error = |mesh: &Mesh| Page::new("a mesh", mesh).err();
    assert_eq!(error(&Mesh::default()), Some(PageError::Empty));
    let mut mesh = Mesh::new(vec![[2.0; 3]; 3]);
    mesh.push_face(&[0, 1, 2]);
    assert_eq!(error(&mesh), Some(PageError::Empty));
    mesh.points[1][0] = f64::NAN;
    assert!(matches!(error(&mesh), Some(PageError::NotFinite { vertex: 1, .. })));
    mesh.points[1] = [3.0; 3];
    mesh.points.push([f64::NAN; 3]);
    assert_eq!(error(&mesh), None, "no face uses the last vertex");
    mesh.push_face(&[0, 1, 9]);
    assert_eq!(error(&mesh), Some(PageError::MissingVertex { face: 1, vertex: 9, vertices: 4 }));
}

#[test]
fn the_same_page_has_the_same_bytes() {
    let outcome = run("block", 500);
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("page.html");
    write_page(&path, &page(&outcome)).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(fs::read_to_string(&path).expect("it is there"), page(&outcome).html());
}

#[test]
fn the_program_writes_pages_of_runs_and_of_files() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let [quads, page, view] = ["quads.obj", "page.html", "view.html"].map(|name| folder.path().join(name));
    let program = |arguments: &[&str]| {
        let output = Command::new(env!("CARGO_BIN_EXE_quadmosaic")).args(arguments).output().expect("it starts");
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let [quads, page, view] = [&quads, &page, &view].map(|path| path.to_str().expect("it is text"));
    let done = program(&[
        "mesh",
        "example:block:4000",
        "--backend",
        "cpu",
        "--points",
        "500",
        "-o",
        quads,
        "--html",
        page,
        "--quiet",
    ]);
    assert_eq!(done, (Some(0), String::new()));
    let of_run = data(&fs::read_to_string(page).expect("it is there"));
    assert_eq!(program(&["view", quads, "--input", "example:block:4000", "-o", view]), (Some(0), String::new()));
    let of_file = data(&fs::read_to_string(view).expect("it is there"));
    // Coordinates of a file have all their digits.
    assert_eq!(of_run["mesh"]["points"], of_file["mesh"]["points"]);
    assert_eq!(of_run["lines"].as_array().map(Vec::len), Some(3));
    assert_eq!(of_file["lines"].as_array().map(Vec::len), Some(2));
    assert!(of_run["figures"].as_array().is_some_and(|figures| figures.len() > 10));
    assert_eq!(Faces::of(&of_file["surface"]).fault(), None);
    // A surface of more triangles than a page shows is shown as it was coarsened.
    let many = format!("example:sphere:{}", MOST_TRIANGLES + 5_000);
    let done = program(&["mesh", &many, "--backend", "cpu", "--points", "500", "-o", quads, "--html", page, "--quiet"]);
    assert_eq!(done, (Some(0), String::new()));
    let coarse = data(&fs::read_to_string(page).expect("it is there"));
    assert!(Faces::of(&coarse["surface"]).ends.len() < MOST_TRIANGLES);
    assert!(coarse["notes"][0].as_str().is_some_and(|note| note.contains("coarsened")));
    let refused = |arguments: &[&str], part: &str| {
        let (code, told) = program(arguments);
        assert!(code != Some(0) && told.contains(part), "{told}");
    };
    refused(&["view", quads, "-o", "page.png"], "does not end in .html");
    refused(&["view", quads, "--crease", "30", "-o", view], "--input");
    refused(&["mesh", "example:block", "-o", quads, "--html", "no/page.html"], "no such folder");
}
