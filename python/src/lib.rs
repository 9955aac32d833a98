//! The native part of the Python package: arrays in, arrays out. Names, defaults and classes are Python's.

mod convert;
mod error;
mod run;

use convert::{Given, Named, Regions, at_corners, at_vertices, flat, integers, named, points, rows};
use error::{Cancelled, SurfaceError, of_load, of_pipeline, of_value};
use numpy::{PyArray1, PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;
use quadmosaic::export::{Format, MeshFile, WriteError, write_mesh};
use quadmosaic::field::{parse_guides, read_guides};
use quadmosaic::mesh::VertexAttributes;
use quadmosaic::mesh::transfer::{Source, SourceTree};
use quadmosaic::pipeline::Meshed as Finished;
use quadmosaic::sizes::{read_sizes, samples};
use quadmosaic::surface::examples::Example;
use quadmosaic::surface::{AttributeKind, Attributes, Ends, NamedEdge, load as loading, read_edges};
use quadmosaic::warnings::{of_attributes, of_precision, of_seams};
use quadmosaic::{Fineness, Options, Soup};
use std::path::{Path, PathBuf};

/// A finished mesh, with its report as JSON.
#[pyclass(frozen)]
struct Meshed {
    file: MeshFile,
    vertices: Vec<VertexAttributes>,
    sources: Vec<Source>,
    attributes: Attributes,
    #[pyo3(get)]
    report: String,
    #[pyo3(get)]
    warnings: Vec<String>,
}

#[pymethods]
impl Meshed {
    fn vertices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        flat(py, self.file.mesh().points.as_flattened().to_vec(), 3)
    }

    /// The faces of so many corners.
    fn faces<'py>(&self, py: Python<'py>, corners: usize) -> PyResult<Bound<'py, PyArray2<i64>>> {
        let faces = self.file.mesh().faces().filter(|face| face.len() == corners);
        flat(py, faces.flatten().map(|&v| i64::from(v)).collect(), corners)
    }

    /// The faces of more than four corners.
    fn polygons<'py>(&self, py: Python<'py>) -> Vec<Bound<'py, PyArray1<i64>>> {
        let faces = self.file.mesh().faces().filter(|face| face.len() > 4);
        faces.map(|face| integers(py, face.iter().map(|&v| i64::from(v)))).collect()
    }

    /// The region of each face: quads, triangles, larger faces.
    fn regions<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        let mesh = self.file.mesh();
        let region = |face: usize| i64::from(mesh.regions.of_face.get(face).copied().unwrap_or(0));
        let of_kind = |is_kind: fn(usize) -> bool| {
            mesh.faces().enumerate().filter(move |(_, face)| is_kind(face.len())).map(move |(face, _)| region(face))
        };
        integers(py, of_kind(|n| n == 4).chain(of_kind(|n| n == 3)).chain(of_kind(|n| n > 4)))
    }

    fn region_names(&self) -> Vec<String> {
        self.file.mesh().regions.names.clone()
    }

    /// The triangle of the input that each vertex lies on.
    fn source<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        integers(py, self.sources.iter().map(|source| i64::from(source.triangle)))
    }

    /// The barycentric coordinates of each vertex in that triangle.
    fn barycentric<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        flat(py, self.sources.iter().flat_map(|source| source.barycentric).collect(), 3)
    }

    /// 0 free, 1 on a boundary, 2 on a feature curve, 3 a corner.
    fn kind<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        integers(py, self.vertices.iter().map(|vertex| vertex.kind as i64))
    }

    /// The attributes of the surface at each vertex.
    fn attributes<'py>(&self, py: Python<'py>) -> PyResult<Named<'py>> {
        let array = |attribute| at_vertices(py, attribute, self.file.mesh());
        self.attributes.list.iter().map(|attribute| Ok((attribute.name.clone(), array(attribute)?))).collect()
    }

    /// Those that corners of faces have of their own.
    fn corner_attributes<'py>(&self, py: Python<'py>) -> PyResult<Named<'py>> {
        let own = self.attributes.list.iter().filter(|attribute| !attribute.of_corners.is_empty());
        own.map(|attribute| Ok((attribute.name.clone(), at_corners(py, attribute, self.file.mesh())?))).collect()
    }

    /// Writes the mesh; the answer is a warning.
    fn save(&self, py: Python<'_>, path: PathBuf, format: Option<&str>, with_source: bool) -> PyResult<Option<String>> {
        let format = format_of(&path, format)?;
        if with_source && !format.takes(AttributeKind::Numbers) {
            return Err(of_value(format!(
                "{format} has no arrays of vertices; with_source goes with ply, vtk and vtu"
            )));
        }
        let write = || match with_source {
            true => write_mesh(&path, format, &self.file.clone().with_sources(self.sources.clone())),
            false => write_mesh(&path, format, &self.file),
        };
        written(py, &path, format, &self.attributes, write)
    }
}

/// Meshes triangles.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "each is an argument of Python's function")]
fn mesh(
    py: Python<'_>,
    vertices: PyReadonlyArray2<'_, f64>,
    triangles: PyReadonlyArray2<'_, i64>,
    regions: Option<Regions<'_>>,
    attributes: Vec<Given<'_>>,
    options: Vec<(String, String)>,
    guides: Option<(bool, String)>,
    sizes: Option<Sizes<'_>>,
    edges: Option<Edges<'_>>,
    machine: run::Machine,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<Meshed> {
    let soup = soup(&vertices, &triangles, regions, attributes)?;
    let mut all = Options::new(Fineness::Points(6_000));
    all.sizes.samples = match sizes {
        None => Vec::new(),
        Some(Sizes::Rows(rows)) => samples(&points::<4>(&rows, "sizes")?, "sizes").map_err(of_value)?,
        Some(Sizes::File(path)) => read_sizes(&path).map_err(of_value)?,
    };
    if !all.sizes.samples.is_empty() {
        all.fineness = Fineness::Sampled;
    }
    for (name, value) in &options {
        all.set(name, value).map_err(of_value)?;
    }
    all.field.guides = match guides {
        None => Vec::new(),
        Some((true, path)) => read_guides(Path::new(&path)).map_err(of_value)?,
        Some((false, text)) => parse_guides(&text, "guides").map_err(of_value)?,
    };
    all.edges = match edges {
        None => Vec::new(),
        Some(Edges::Pairs(pairs)) => named_edges(&rows::<2>(&pairs, soup.points.len(), "feature_edges")?),
        Some(Edges::File(path)) => read_edges(&path).map_err(of_value)?,
    };

    let mesher = machine.mesher(py)?;
    let done = run::watched(py, progress.as_ref(), |watch| {
        machine.on_threads(|| {
            let outcome = mesher.mesh_watched(&soup, &all, watch)?;
            let report = mesher.report("arrays", &all, &outcome);
            let Finished { mesh, vertices, .. } = outcome.meshed;
            let tree = SourceTree::new(&soup);
            let sources = tree.sources(&mesh.points);
            let file = MeshFile::new(&mesh, &vertices);
            let list = tree.attributes(file.mesh(), &sources);
            let file = file.with_attributes(list.clone());
            Ok((file, vertices, sources, Attributes { list, ..Attributes::default() }, report))
        })
    })?;
    let (file, vertices, sources, attributes, mut report) = done?.map_err(of_pipeline)?;
    // What a preset sets need not have an effect.
    report.ineffective.retain(|option| options.iter().any(|(name, _)| name == option.option()));
    let coarse = of_precision(&soup, file.mesh().points.len());
    let idle = of_seams(&soup, &all);
    let warnings = report.warnings().into_iter().chain(report.wrong()).chain(coarse).chain(idle).collect();
    let report = serde_json::to_string(&report).map_err(of_value)?;
    Ok(Meshed { file, vertices, sources, attributes, report, warnings })
}

/// Sizes at points: rows of x, y, z and the size, or a file.
#[derive(FromPyObject)]
enum Sizes<'py> {
    Rows(PyReadonlyArray2<'py, f64>),
    File(PathBuf),
}

/// Edges that are features: pairs of vertices, or a file.
#[derive(FromPyObject)]
enum Edges<'py> {
    Pairs(PyReadonlyArray2<'py, i64>),
    File(PathBuf),
}

fn named_edges(pairs: &[[u32; 2]]) -> Vec<NamedEdge> {
    let named =
        |(k, &ends): (usize, &[u32; 2])| NamedEdge { ends: Ends::Vertices(ends), name: format!("feature_edges[{k}]") };
    pairs.iter().enumerate().map(named).collect()
}

fn soup(
    vertices: &PyReadonlyArray2<'_, f64>,
    triangles: &PyReadonlyArray2<'_, i64>,
    regions: Option<Regions<'_>>,
    attributes: Vec<Given<'_>>,
) -> PyResult<Soup> {
    let points = points(vertices, "vertices")?;
    let triangles = rows(triangles, points.len(), "triangles")?;
    let mut soup = Soup::new(points, triangles);
    if let Some(regions) = regions {
        soup.regions = regions.of(soup.triangles.len())?;
    }
    let counts = [soup.points.len(), soup.triangles.len()];
    soup.attributes.list =
        attributes.into_iter().map(|given| given.of(counts[0], counts[1])).collect::<PyResult<_>>()?;
    Ok(soup)
}

/// Triangles as Python's `Surface` has them: vertices, triangles, regions, names of regions, attributes of vertices and of corners.
type Arrays<'py> = (
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<i64>>,
    Bound<'py, PyArray1<i64>>,
    Vec<String>,
    Named<'py>,
    Named<'py>,
);

fn arrays(py: Python<'_>, soup: Soup) -> PyResult<Arrays<'_>> {
    let triangles = soup.triangles.as_flattened().iter().map(|&v| i64::from(v)).collect();
    let mut regions = soup.regions.of_face;
    regions.resize(soup.triangles.len(), 0);
    let (of_vertices, of_corners) = named(py, soup.attributes.list, &soup.triangles)?;
    Ok((
        flat(py, soup.points.into_flattened(), 3)?,
        flat(py, triangles, 3)?,
        integers(py, regions.into_iter().map(i64::from)),
        soup.regions.names,
        of_vertices,
        of_corners,
    ))
}

/// The triangles of a file, and the names of what was not read.
#[pyfunction]
fn load<'py>(py: Python<'py>, path: PathBuf, format: Option<&str>) -> PyResult<(Arrays<'py>, Vec<String>)> {
    let format = format.map(str::parse).transpose().map_err(of_value)?;
    let mut soup = py.detach(|| run::on_threads(0, || loading::read_as(&path, format)))?.map_err(of_load)?;
    let left_out = std::mem::take(&mut soup.attributes.left_out);
    Ok((arrays(py, soup)?, left_out))
}

/// An example surface.
#[pyfunction]
fn example<'py>(py: Python<'py>, name: &str, triangles: usize) -> PyResult<Arrays<'py>> {
    let example = name.parse::<Example>().map_err(of_value)?;
    if !Example::TRIANGLES.contains(&triangles) {
        let (least, most) = Example::TRIANGLES.into_inner();
        return Err(of_value(format!(
            "invalid value '{triangles}' for triangles: ask for {least} to {most} triangles"
        )));
    }
    arrays(py, py.detach(|| run::on_threads(0, || example.generate(triangles)))?)
}

/// Writes triangles to a file; the answer is a warning.
#[pyfunction]
fn save(
    py: Python<'_>,
    path: PathBuf,
    format: Option<&str>,
    vertices: PyReadonlyArray2<'_, f64>,
    triangles: PyReadonlyArray2<'_, i64>,
    regions: Option<Regions<'_>>,
    attributes: Vec<Given<'_>>,
) -> PyResult<Option<String>> {
    let format = format_of(&path, format)?;
    let soup = soup(&vertices, &triangles, regions, attributes)?;
    written(py, &path, format, &soup.attributes, || write_mesh(&path, format, &MeshFile::from(&soup)))
}

fn format_of(path: &Path, format: Option<&str>) -> PyResult<Format> {
    format.map_or_else(|| Format::from_extension(path), str::parse).map_err(of_value)
}

/// Writes a file; the answer tells which attributes it does not hold.
fn written(
    py: Python<'_>,
    path: &Path,
    format: Format,
    attributes: &Attributes,
    write: impl FnOnce() -> Result<(), WriteError> + Send,
) -> PyResult<Option<String>> {
    py.detach(|| run::on_threads(0, write))?.map_err(error::of_write)?;
    Ok(of_attributes(attributes, format, &path.display().to_string()))
}

/// The command line: does what the arguments ask for, and returns the exit code.
#[pyfunction]
fn command_line(py: Python<'_>, arguments: Vec<String>) -> u8 {
    py.detach(|| quadmosaic::cli::main(arguments))
}

/// The names of the options of `mesh`.
#[pyfunction]
fn option_names() -> Vec<&'static str> {
    quadmosaic::options::NAMES.to_vec()
}

#[pymodule]
mod _native {
    #[pymodule_export]
    use super::{Cancelled, Meshed, SurfaceError, command_line, example, load, mesh, option_names, save};
}
