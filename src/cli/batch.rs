//! `quadmosaic batch`.

use super::backend::Machine;
use super::config::ConfigArguments;
use super::input::Input;
use super::method::MethodArguments;
use super::output::print;
use super::sentence;
use anyhow::{Context, bail, ensure};
use clap::Args;
use quadmosaic::Mesher;
use quadmosaic::export::{Format, MeshFile, atomic, write_mesh};
use quadmosaic::options::up_to;
use quadmosaic::pipeline::Options;
use rayon::prelude::*;
use rustc_hash::FxHashSet;
use serde::{Deserialize, Serialize};
use std::fs::{self, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// Meshes many surfaces with the same options
///
/// Each mesh goes to the folder under the name of its surface. The folder gets results.jsonl, a line for each surface as soon as it is
/// done, and at the end results.csv, the same as a table. A surface that fails does not stop the others. An interrupted batch goes on
/// when it is called again: a surface is passed over that has a mesh by the same options and the same version of the program, and whose
/// file has not changed. The exit code is 0 where each surface has a mesh without fault or difference, else 1.
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// The surfaces: files, or examples (example:m6)
    #[arg(value_name = "IN", required_unless_present_any = ["list", "print_config"])]
    surfaces: Vec<Input>,
    /// More surfaces from a file, one a line
    ///
    /// Empty lines and those that begin with # are passed over
    #[arg(long, value_name = "FILE", help_heading = "Input")]
    list: Option<PathBuf>,
    /// The folder of the results, created where it is missing
    #[arg(short, long, value_name = "DIR", help_heading = "Output")]
    output: PathBuf,
    /// The format of the meshes
    ///
    /// obj, ply, stl, off, vtk, vtu, msh (4.1), msh22, su2, inp, bdf or glb
    #[arg(long, value_name = "FORMAT", default_value = "obj", help_heading = "Output")]
    to: Format,
    /// Surfaces meshed at the same time; 0: as many as there are threads
    ///
    /// At most 1024
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = up_to::<1024>, help_heading = "Machine")]
    jobs: usize,
    #[command(flatten)]
    _config: ConfigArguments,
    #[command(flatten)]
    method: MethodArguments,
    #[command(flatten)]
    machine: Machine,
    /// Print errors only
    #[arg(short, long, help_heading = "Output")]
    quiet: bool,
}

const EXAMPLES: &str = "\
Examples:
  quadmosaic batch parts/*.stl --points 2000 -o meshes
  quadmosaic batch --list parts.txt --size 0.02 --to vtu --jobs 4 -o meshes";

/// The file of rows.
const ROWS: &str = "results.jsonl";
/// The table.
const TABLE: &str = "results.csv";

/// The result of one surface.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
struct Row {
    surface: String,
    /// The name of the mesh's file in the folder; empty where there is none.
    mesh: String,
    /// `ok`, `wrong`: the mesh has a fault or a difference, or `failed`: there is no mesh.
    status: String,
    /// What is wrong, or could be better with more time.
    message: String,
    vertices: usize,
    quads: usize,
    triangles: usize,
    qr: Option<f64>,
    qg: Option<f64>,
    least_jacobian: Option<f64>,
    irregular: usize,
    seconds: f64,
    /// A hash of the surface's file, the options and the version.
    digest: String,
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let Arguments { output, machine, method, quiet, jobs, .. } = arguments;
    if method.leaves_holes() && !arguments.to.takes_polygons() {
        bail!("{} has no faces of more than four corners; --holes leave does not go with it", arguments.to);
    }
    let options = method.options()?;
    let items = items(arguments)?;
    machine.start_threads()?;
    fs::create_dir_all(output).with_context(|| format!("the folder {} cannot be made", output.display()))?;
    let mesher = machine.mesher()?;

    let known = known(&output.join(ROWS))?;
    let rows = OpenOptions::new().create(true).append(true).open(output.join(ROWS));
    let rows = Mutex::new(rows.with_context(|| format!("{} cannot be written", output.join(ROWS).display()))?);
    let one = |item: &Item| -> anyhow::Result<Row> {
        let digest = item.digest(&options, arguments.to);
        let done = known.iter().rev().find(|row| row.surface == item.name && row.digest == digest);
        if let Some(row) = done.filter(|row| row.status != FAILED && output.join(&row.mesh).is_file()) {
            return Ok(row.clone());
        }
        let row = Row { digest, ..item.mesh(&mesher, &options, arguments.to, output) };
        let mut line = serde_json::to_vec(&row)?;
        line.push(b'\n');
        let mut rows = rows.lock().unwrap_or_else(PoisonError::into_inner);
        rows.write_all(&line).with_context(|| format!("{} cannot be written", output.join(ROWS).display()))?;
        if row.status == FAILED {
            eprintln!("error: {}: {}", row.surface, row.message);
        } else if !quiet {
            let Row { surface, vertices, quads, triangles, seconds, .. } = &row;
            eprintln!("{surface}: {vertices} vertices, {quads} quads, {triangles} triangles in {seconds:.2} s");
        }
        Ok(row)
    };
    let all = || items.par_iter().with_max_len(1).map(one).collect::<anyhow::Result<Vec<Row>>>();
    let rows = match jobs {
        0 => all(),
        // The loops of all surfaces share the threads of this pool.
        _ => rayon::ThreadPoolBuilder::new()
            .num_threads(*jobs)
            .build()
            .context("the jobs cannot be started")?
            .install(all),
    }?;

    write_table(&output.join(TABLE), &rows)?;
    let count = |status: &str| rows.iter().filter(|row| row.status == status).count();
    let (wrong, failed) = (count(WRONG), count(FAILED));
    if !quiet {
        print(&format!(
            "{} surfaces, {} meshes without fault, {}\n",
            rows.len(),
            count(OK),
            output.join(TABLE).display()
        ))?;
    }
    ensure!(wrong + failed == 0, "of {} surfaces {failed} have no mesh, and {wrong} one with a fault", rows.len());
    Ok(())
}

const OK: &str = "ok";
const WRONG: &str = "wrong";
const FAILED: &str = "failed";

/// A surface, and the name of its mesh without extension.
struct Item {
    input: Input,
    name: String,
    stem: String,
}

/// The surfaces of the arguments and of the list, each with a name of its own.
fn items(arguments: &Arguments) -> anyhow::Result<Vec<Item>> {
    let mut inputs = arguments.surfaces.clone();
    if let Some(list) = &arguments.list {
        let text = fs::read_to_string(list).with_context(|| format!("{} cannot be read", list.display()))?;
        let lines = text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#'));
        for line in lines {
            inputs.push(line.parse().map_err(|error: String| anyhow::anyhow!("{}: {line}: {error}", list.display()))?);
        }
    }
    let (mut names, mut stems) = (FxHashSet::default(), FxHashSet::default());
    let mut items = Vec::new();
    for input in inputs {
        let name = input.to_string();
        ensure!(!matches!(input, Input::Standard), "a batch reads files, not standard input; name them");
        ensure!(names.insert(name.clone()), "{name} is given twice; name each surface once");
        // Files in two folders may have the same name.
        let plain = input.stem();
        let numbered = |number: usize| if number == 1 { plain.clone() } else { format!("{plain}-{number}") };
        let stem = (1..).map(numbered).find(|stem| stems.insert(stem.clone())).unwrap_or_default();
        items.push(Item { input, name, stem });
    }
    ensure!(!items.is_empty(), "there is no surface; name one at least");
    Ok(items)
}

impl Item {
    /// A hash of the surface's file, the options, the format and the version. It takes the options as debug text, which is the same for
    /// one version of the program.
    fn digest(&self, options: &Options, format: Format) -> String {
        let mut hasher = blake3::Hasher::new();
        hasher.update(format!("{} {format} {options:?}", env!("CARGO_PKG_VERSION")).as_bytes());
        if let Input::File(path) = &self.input {
            // Of a file that cannot be read, the reader tells why.
            hasher.update(&fs::read(path).unwrap_or_default());
        }
        hasher.finalize().to_string()
    }

    /// Meshes the surface; a failure is a row too.
    fn mesh(&self, mesher: &Mesher, options: &Options, format: Format, folder: &Path) -> Row {
        let started = Instant::now();
        let file = format!("{}.{}", self.stem, format.extension());
        let row = self.try_mesh(mesher, options, format, folder, &file);
        let failed = |error: anyhow::Error| Row {
            surface: self.name.clone(),
            status: FAILED.to_owned(),
            message: sentence(&error),
            ..Row::default()
        };
        Row { seconds: started.elapsed().as_secs_f64(), ..row.unwrap_or_else(failed) }
    }

    fn try_mesh(
        &self,
        mesher: &Mesher,
        options: &Options,
        format: Format,
        folder: &Path,
        file: &str,
    ) -> anyhow::Result<Row> {
        let soup = self.input.read(None)?;
        let outcome = mesher.mesh(&soup, options)?;
        let report = mesher.report(&self.name, options, &outcome);
        let meshed = &outcome.meshed;
        write_mesh(
            &folder.join(file),
            format,
            &MeshFile::new(&meshed.mesh, &meshed.vertices).with_input(&soup, false),
        )?;
        let wrong = report.wrong();
        let quality = &report.mesh;
        Ok(Row {
            surface: self.name.clone(),
            mesh: file.to_owned(),
            status: if wrong.is_some() { WRONG } else { OK }.to_owned(),
            message: wrong.into_iter().chain(report.late_warning()).collect::<Vec<_>>().join("; "),
            vertices: quality.vertices,
            quads: quality.quads,
            triangles: quality.triangles,
            qr: Some(quality.qr),
            qg: quality.qg.map(|spread| spread.mean),
            least_jacobian: quality.scaled_jacobian.map(|spread| spread.min),
            irregular: quality.irregular_vertices,
            ..Row::default()
        })
    }
}

/// The rows of an earlier run; the last one may be cut off.
fn known(path: &Path) -> anyhow::Result<Vec<Row>> {
    if !path.exists() {
        return Ok(Vec::new());
    }
    let text = fs::read_to_string(path).with_context(|| format!("{} cannot be read", path.display()))?;
    // What was cut off must not be the beginning of the next row.
    if !text.is_empty() && !text.ends_with('\n') {
        let whole = text.rfind('\n').map_or(0, |end| end + 1);
        atomic(path, |writer| writer.write_all(&text.as_bytes()[..whole]))?;
    }
    Ok(text.lines().filter_map(|line| serde_json::from_str(line).ok()).collect())
}

fn write_table(path: &Path, rows: &[Row]) -> anyhow::Result<()> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    rows.iter().try_for_each(|row| writer.serialize(row))?;
    let table = writer.into_inner().map_err(|error| error.into_error())?;
    Ok(atomic(path, |writer| writer.write_all(&table))?)
}
