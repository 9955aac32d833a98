//! The study of the paper's section 4: measures of the connected mosaic by angle and by distance.
//!
//! # Theory
//! The paper's figure 6: Qr of the ONERA M6 wing at 6,000, 30,000 and 60,000 points, as theta changes with L fixed at 1.6, and
//! as L changes with theta fixed at 30 degrees. Its section 4.2: the same before and after clean-up.
//!
//! # Changes versus the paper
//! Each mesh is measured three times: before the connectivity optimisation; after the paper's clean-up with relocation, which
//! the paper does not have; and as [`pipeline::run`] returns it. A third sweep varies the fit of tiles to the field.
//!
//! # Practice
//! A mosaic is made once and connected many times. The table of all rows is written after each connection. Run an interrupted
//! study again in the same folder: it goes on where it was, if the surfaces, the options and the program's version are the same.

mod charts;
mod page;
mod table;

pub use table::{Figures, Row, Table};

use crate::compute::{Backend, ComputeError};
use crate::export::WriteError;
use crate::field::GuideReport;
use crate::mesh::connect::ConnectOptions;
use crate::mesh::triangulate::triangulate;
use crate::picture::{Paint, PictureError, Scene, View, mesh_scene, mosaic_scene, write_picture};
use crate::pipeline::{self, Fineness, Meshed, Options, PipelineError, prepare, unwatched};
use crate::surface::{Regions, Soup};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use thiserror::Error;

/// The table's file.
pub const TABLE: &str = "study.json";

/// The reason why a study was not finished. Its rows are kept; run it again to go on.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum StudyError {
    /// A surface cannot be meshed.
    #[error("{surface} at {points} points: {source}")]
    Pipeline {
        /// The surface's name.
        surface: String,
        /// The vertices asked for.
        points: usize,
        /// Why.
        source: PipelineError,
    },
    /// A picture cannot be drawn.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// A chart cannot be drawn.
    #[error("the chart {} cannot be drawn: {reason}", .path.display())]
    Chart {
        /// Where it was to go.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// A file of the study cannot be read again.
    #[error("{} cannot be read ({reason}); remove it to begin anew, or choose another folder", .path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
}

/// The sweeps of a study.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Numbers of vertices.
    pub points: Vec<usize>,
    /// Values of theta, in degrees, each with the default L.
    pub angles: Vec<f64>,
    /// Values of L, in tile sides, each with the default theta.
    pub distances: Vec<f64>,
    /// Values of [`Options::fit`], each with the default theta and L; each needs a mosaic of its own.
    pub fits: Vec<f64>,
    /// The other options; [`Options::fineness`] and [`Options::connect`] are not used.
    pub options: Options,
    /// Pixels of the pictures of meshes and mosaics.
    pub picture: [u32; 2],
}

impl Default for Plan {
    /// The paper's.
    fn default() -> Self {
        Self {
            points: vec![6_000, 30_000, 60_000],
            angles: (2..=9).map(|step| 5.0 * f64::from(step)).collect(),
            distances: (6..=12).map(|step| f64::from(step) / 5.0).collect(),
            fits: Vec::new(),
            options: Options::new(Fineness::Points(6_000)),
            picture: [1200, 900],
        }
    }
}

/// Theta, L and the fit.
type Setting = [f64; 3];

impl Plan {
    /// The setting that all sweeps share.
    fn usual(&self) -> Setting {
        let ConnectOptions { max_angle, max_distance } = ConnectOptions::default();
        [max_angle, max_distance, self.options.fit]
    }

    /// The values of theta, L and the fit.
    fn swept(&self) -> [&[f64]; 3] {
        [&self.angles, &self.distances, &self.fits]
    }

    /// Each setting once; the first is the usual one.
    fn settings(&self) -> Vec<Setting> {
        let usual = self.usual();
        let mut all = vec![usual];
        for (sweep, values) in self.swept().into_iter().enumerate() {
            for &value in values {
                let mut setting = usual;
                setting[sweep] = value;
                if !all.contains(&setting) {
                    all.push(setting);
                }
            }
        }
        all
    }

    /// The settings by mosaic: those of the same fit are together.
    fn mosaics(&self) -> Vec<Vec<Setting>> {
        let mut mosaics: Vec<Vec<Setting>> = Vec::new();
        for setting in self.settings() {
            match mosaics.iter_mut().find(|mosaic| mosaic[0][2] == setting[2]) {
                Some(mosaic) => mosaic.push(setting),
                None => mosaics.push(vec![setting]),
            }
        }
        mosaics
    }
}

/// A surface of a study.
#[derive(Clone, Debug)]
pub struct Subject {
    /// Its name in tables and on charts.
    pub name: String,
    /// The beginning of the names of its files.
    pub stem: String,
    /// Its triangles.
    pub soup: Soup,
}

impl Subject {
    /// A hash of the surface and the options. It takes the options as debug text, which is the same for one version of the
    /// program; rows of another version are not read again.
    fn digest(&self, plan: &Plan) -> String {
        let connect = ConnectOptions::default();
        let options = Options { fineness: Fineness::Points(0), fit: 0.0, connect, ..plan.options.clone() };
        let Soup { points, triangles, regions: Regions { names, of_face }, attributes } = &self.soup;
        let mut hasher = blake3::Hasher::new();
        hasher.update(format!("{options:?} {names:?} {} {}", points.len(), triangles.len()).as_bytes());
        hasher.update(bytemuck::cast_slice(points));
        hasher.update(bytemuck::cast_slice(triangles));
        hasher.update(bytemuck::cast_slice(of_face));
        // Seams of texture coordinates may be features.
        for attribute in &attributes.list {
            hasher.update(bytemuck::cast_slice(&attribute.values));
            hasher.update(bytemuck::cast_slice(&attribute.of_corners));
        }
        hasher.finalize().to_string()
    }

    fn file(&self, points: usize, what: &str) -> String {
        format!("{}-{points}-{what}.png", self.stem)
    }
}

/// Runs a study in an existing folder, or goes on with one: it writes rows, charts, pictures and a page that shows them.
///
/// `progress` receives the share that is done, from 0 to 1, and the next step.
///
/// # Errors
/// [`StudyError`]; finished rows are kept.
pub fn run(
    folder: &Path,
    subjects: &[Subject],
    plan: &Plan,
    backend: &dyn Backend,
    progress: &dyn Fn(f64, &str),
) -> Result<Table, StudyError> {
    let old = table::read(&folder.join(TABLE))?;
    let mut study = Study { folder, plan, backend, progress, table: Table::default(), done: 0.0, all: 0.0 };
    let mosaics = plan.mosaics();
    for subject in subjects {
        let digest = subject.digest(plan);
        let wanted = |row: &Row| row.digest == digest && row.surface == subject.name;
        study.table.rows.extend(old.rows.iter().filter(|row| wanted(row)).cloned());
    }
    let points = plan.points.iter().sum::<usize>() as f64 * subjects.len() as f64;
    study.all = points * mosaics.iter().map(|settings| LAYING + settings.len() as f64).sum::<f64>();
    for subject in subjects {
        for &points in &plan.points {
            for settings in &mosaics {
                study.mosaic(subject, points, settings)?;
            }
        }
    }
    let settings = plan.settings();
    study.table.rows.retain(|row| plan.points.contains(&row.points) && settings.contains(&row.setting()));
    study.table.sort(subjects, plan);
    study.save()?;
    for subject in subjects {
        charts::write(folder, subject, plan, &study.table)?;
    }
    page::write(folder, subjects, plan, &study.table)?;
    Ok(study.table)
}

/// The time of laying a mosaic, in connections of it; for the progress alone.
const LAYING: f64 = 2.0;

/// A study while it runs.
struct Study<'a> {
    folder: &'a Path,
    plan: &'a Plan,
    backend: &'a dyn Backend,
    progress: &'a dyn Fn(f64, &str),
    table: Table,
    done: f64,
    all: f64,
}

impl Study<'_> {
    /// Makes the rows and pictures of one mosaic, connected by these settings.
    fn mosaic(&mut self, subject: &Subject, points: usize, settings: &[Setting]) -> Result<(), StudyError> {
        let digest = subject.digest(self.plan);
        let usual = self.plan.usual();
        let known = |table: &Table, setting: &Setting| {
            let same = |row: &Row| row.points == points && row.digest == digest && row.setting() == *setting;
            table.rows.iter().any(same)
        };
        let missing: Vec<Setting> = settings.iter().filter(|setting| !known(&self.table, setting)).copied().collect();
        let pictures = ["mosaic", "before", "after"].map(|what| self.folder.join(subject.file(points, what)));
        let pictured = settings[0] == usual;
        let drawn = !pictured || !missing.contains(&usual) && pictures.iter().all(|picture| picture.is_file());
        self.done += (settings.len() - missing.len()) as f64 * points as f64;
        if missing.is_empty() && drawn {
            self.done += LAYING * points as f64;
            return Ok(());
        }
        let report = |study: &Self, what: String| (study.progress)(study.done / study.all, &what);
        let (name, fit) = (&subject.name, settings[0][2]);
        let of_fit = if self.plan.fits.is_empty() { String::new() } else { format!(", fit {fit}") };
        report(self, format!("{name}, {points} points{of_fit}: mosaic"));
        let failed = |source: PipelineError| StudyError::Pipeline { surface: name.clone(), points, source };
        let compute = |source: ComputeError| failed(source.into());
        let options = Options { fineness: Fineness::Points(points), fit, ..self.plan.options.clone() };
        let started = Instant::now();
        let (surface, sizes, count) = prepare(&subject.soup, &options).map_err(failed)?;
        let field = pipeline::field(&surface, sizes, count, &options, self.backend).map_err(failed)?;
        let mosaic = pipeline::lay(&surface, &field, self.backend, count, &options, &|_| ()).map_err(compute)?;
        let triangulation = triangulate(&surface, &field, &mosaic);
        let laid = started.elapsed();
        self.done += LAYING * points as f64;

        let connected = |[max_angle, max_distance, _]: Setting, paper: bool| {
            let connect = ConnectOptions { max_distance, max_angle };
            let options = Options { connect, ..options.clone() };
            let options = if paper { options.with_paper_clean_up() } else { options };
            pipeline::connected(&surface, &mosaic, &triangulation, &options, &unwatched).map_err(|e| failed(e.into()))
        };
        if !drawn {
            let Meshed { before, mesh, .. } = connected(usual, false)?;
            self.draw(&pictures[0], &mosaic_scene(&surface, &mosaic, 0.1, None))?;
            self.draw(&pictures[1], &mesh_scene(&before, Paint::Sides))?;
            self.draw(&pictures[2], &mesh_scene(&mesh, Paint::Sides))?;
        }
        let sides = mosaic.tiles.iter().map(|tile| f64::from(tile.h));
        let (least, most) = sides.fold((f64::INFINITY, 0.0_f64), |(least, most), h| (least.min(h), most.max(h)));
        let trouble = |guide: &GuideReport| Some(format!("{}: {}", guide.name, guide.trouble.as_ref()?));
        let warnings: Vec<String> = field.guides().iter().filter_map(trouble).collect();
        for setting in missing {
            let [max_angle, max_distance, fit] = setting;
            report(self, format!("{name}, {points} points{of_fit}: theta {max_angle}, L {max_distance}"));
            let cleaned = connected(setting, true)?.mesh;
            let started = Instant::now();
            let meshed = connected(setting, false)?;
            let time = started.elapsed();
            let milliseconds = |time: Duration| (time.as_secs_f64() * 1e4).round() / 10.0;
            self.table.rows.push(Row {
                surface: name.clone(),
                digest: digest.clone(),
                points,
                max_angle,
                max_distance,
                fit,
                before: Figures::of(&meshed.before),
                cleaned: Figures::of(&cleaned),
                after: Figures::of(&meshed.mesh),
                holes: meshed.holes,
                faults: meshed.faults.list.len() + meshed.differences.len(),
                side_range: most / least,
                mosaic_ms: milliseconds(laid),
                mesh_ms: milliseconds(time),
                warnings: warnings.clone(),
            });
            self.save()?;
            self.done += points as f64;
        }
        Ok(())
    }

    fn save(&self) -> Result<(), StudyError> {
        Ok(table::write(self.folder, &self.table)?)
    }

    fn draw(&self, path: &Path, scene: &Scene) -> Result<(), StudyError> {
        Ok(write_picture(path, scene, &View::default(), self.plan.picture)?)
    }
}
