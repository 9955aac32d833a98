//! What is done with the bytes, and what must hold then beside that nothing panics.

use crate::bytes::Bytes;
use quadmosaic::export::{MeshFile, write_mesh_to};
use quadmosaic::field::parse_guides;
use quadmosaic::mesh::check::check as faults_of;
use quadmosaic::mesh::compare::check_against;
use quadmosaic::mesh::quality::Quality;
use quadmosaic::mesh::{Mesh, read_mesh};
use quadmosaic::options::NAMES;
use quadmosaic::report::CheckReport;
use quadmosaic::sizes::read_sizes;
use quadmosaic::surface::examples::Example;
use quadmosaic::surface::load::{Format, read_stream};
use quadmosaic::surface::{FeatureOptions, read_edges};
use quadmosaic::{Fineness, Mesher, Options, Soup, Surface};
use std::cell::LazyCell;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

pub fn obj(data: &[u8]) {
    read(data, Some(Format::Obj));
}

pub fn stl(data: &[u8]) {
    read(data, Some(Format::Stl));
}

pub fn ply(data: &[u8]) {
    read(data, Some(Format::Ply));
}

pub fn off(data: &[u8]) {
    read(data, Some(Format::Off));
}

pub fn msh(data: &[u8]) {
    read(data, Some(Format::Msh));
}

pub fn vtk(data: &[u8]) {
    read(data, Some(Format::Vtk));
}

pub fn vtu(data: &[u8]) {
    read(data, Some(Format::Vtu));
}

pub fn vtp(data: &[u8]) {
    read(data, Some(Format::Vtp));
}

/// A file whose content tells the format: as a surface, and as a mesh that is checked.
pub fn any(data: &[u8]) {
    read(data, None);
    let mesh = in_file(data, read_mesh);
    if let Ok(mesh) = mesh {
        let _ = faults_of(&mesh);
        let _ = Quality::of(&mesh);
    }
}

/// A soup that is read is whole: corners name points that are there and finite. Points that no face uses may be anything.
fn read(data: &[u8], format: Option<Format>) {
    match read_stream(data, "fuzz", format) {
        Ok(soup) => expect_whole(&soup),
        Err(error) => {
            let told = error.to_string();
            assert!(!told.is_empty() && told.contains("fuzz"), "the error names the file: {told}");
        }
    }
}

fn expect_whole(soup: &Soup) {
    assert!(!soup.triangles.is_empty(), "a file without faces is an error");
    let count = soup.points.len();
    assert!(soup.triangles.as_flattened().iter().all(|&v| (v as usize) < count), "a corner is a point");
    let mut used = soup.triangles.as_flattened().iter().flat_map(|&v| soup.points[v as usize]);
    assert!(used.all(f64::is_finite), "a corner is finite");
    let of_triangles = soup.regions.of_face.len();
    assert!(of_triangles == 0 || of_triangles == soup.triangles.len(), "each triangle has a region, or none has");
}

pub fn guides(data: &[u8]) {
    let _ = parse_guides(&String::from_utf8_lossy(data), "fuzz");
}

pub fn sizes(data: &[u8]) {
    if let Ok(samples) = in_file(data, read_sizes) {
        assert!(samples.iter().all(|sample| sample.size > 0.0 && sample.size.is_finite()), "a size is above 0");
    }
}

pub fn edges(data: &[u8]) {
    let _ = in_file(data, read_edges);
}

/// Lines of a name and a value. What is refused changes nothing.
pub fn options(data: &[u8]) {
    let mut options = Options::new(Fineness::Points(100));
    for line in String::from_utf8_lossy(data).lines() {
        let (name, value) = line.split_once('=').unwrap_or((line, ""));
        let before = format!("{options:?}");
        let done = options.set(name, value);
        assert!(done.is_err() || NAMES.contains(&name), "{name} is no option");
        assert!(done.is_ok() || format!("{options:?}") == before, "{line}: a refused value has an effect");
    }
}

/// A file for `--config`.
pub fn config(data: &[u8]) {
    let _ = in_file(data, |path| {
        let arguments = ["quadmosaic", "mesh", "example:m6", "-o", "out.obj", "--config"];
        let arguments = arguments.map(Into::into).into_iter().chain([path.as_os_str().to_owned()]);
        quadmosaic::cli::expect_valid(arguments)
    });
}

thread_local! {
    /// The surface that meshes are compared with.
    static SURFACE: LazyCell<Surface> = LazyCell::new(|| {
        let soup = Example::Block.generate(60);
        Surface::new(&soup, &FeatureOptions::default()).expect("an example is a surface")
    });
}

/// Any polygons: checked, measured, compared with a surface, written.
pub fn check(data: &[u8]) {
    let mesh = Bytes(data).mesh();
    let faults = faults_of(&mesh);
    SURFACE.with(|surface| {
        let (against, _) = check_against(&mesh, surface);
        assert!(faults.is_clean() || !against.is_clean(), "a surface takes no fault away");
        let report = CheckReport::new("fuzz", &mesh, Some(("block", &**surface)));
        // A place may be NaN, which is equal to nothing.
        assert!(format!("{:?}", report.faults) == format!("{against:?}"), "the report has what the check finds");
        assert!(report.mesh.is_none_or(|quality| !quality.qr.is_nan()), "the share of quads is a number");
    });
}

/// The whole method on a few triangles, and the mesh written and read.
pub fn pipeline(data: &[u8]) {
    let mut bytes = Bytes(data);
    let options = options_of(&mut bytes);
    let soup = bytes.soup();
    let Ok(outcome) = Mesher::cpu().mesh(&soup, &options) else { return };
    let mesh = &outcome.meshed.mesh;
    expect_sound(mesh);
    let file = MeshFile::new(mesh, &outcome.meshed.vertices);
    let mut text = Vec::new();
    write_mesh_to(&mut text, quadmosaic::export::Format::Obj, &file).expect("a vector takes all");
    let again = read_stream(&text[..], "fuzz", Some(Format::Obj)).expect("what is written can be read");
    assert_eq!(again.points, mesh.points, "the points are as they were written");
}

fn options_of(bytes: &mut Bytes) -> Options {
    let mut options = Options::new(Fineness::Points(4 + bytes.below(60)));
    let settings = [
        ("quads", ["paper", "most", "all"]),
        ("rows", ["paper", "continuous", "paper"]),
        ("fit", ["0", "0.5", "1"]),
        ("holes", ["patterns", "triangles", "leave"]),
        ("layout", ["mosaic", "even", "quads"]),
        ("crease", ["40", "5", "175"]),
    ];
    // Each setting that a bit chooses.
    let chosen = bytes.byte();
    for (bit, (name, values)) in settings.into_iter().enumerate() {
        if chosen >> bit & 1 == 1 {
            let value = values[bytes.below(values.len())];
            options.set(name, value).expect("it is a value");
        }
    }
    options
}

fn expect_sound(mesh: &Mesh) {
    assert!(mesh.points.as_flattened().iter().all(|x| x.is_finite()), "a vertex is finite");
    for face in mesh.faces() {
        assert!(face.len() >= 3, "a face has three corners");
        assert!(face.iter().all(|&v| (v as usize) < mesh.points.len()), "a corner is a vertex");
    }
}

thread_local! {
    static FOLDER: LazyCell<TempDir> = LazyCell::new(|| tempfile::tempdir().expect("a temporary folder"));
}

/// What a function makes of a file with this content.
fn in_file<T>(data: &[u8], read: impl FnOnce(&Path) -> T) -> T {
    FOLDER.with(|folder| {
        let path = folder.path().join("fuzz");
        fs::write(&path, data).expect("it can be written");
        read(&path)
    })
}
