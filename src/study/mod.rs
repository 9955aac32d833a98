//! The paper's section 4: what connecting a mosaic gives, by angle and by distance.
//!
//! # Theory
//! The paper's figure 6: Qr of the ONERA M6 wing at 6,000, 30,000 and 60,000 points, as theta changes with L fixed at 1.6, and
//! as L changes with theta fixed at 30 degrees; before and after clean-up.
//!
//! # Practice
//! A mosaic is made once and connected many times. After each connection the table of all rows is written: a study that was
//! interrupted goes on where it was, as long as the surfaces and the program's version are the same.

mod canvas;
mod charts;
mod page;
mod table;

pub use table::{Figures, Row, Table};

use crate::compute::{Backend, ComputeError};
use crate::export::WriteError;
use crate::mesh::check::check_joined;
use crate::mesh::connect::ConnectOptions;
use crate::mesh::triangulate::triangulate;
use crate::picture::{Paint, PictureError, Scene, View, mesh_scene, mosaic_scene, write_picture};
use crate::pipeline::{self, Fineness, Meshed, Options, PipelineError, prepare};
use crate::surface::Soup;
use rustc_hash::FxHasher;
use std::hash::{Hash, Hasher};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use thiserror::Error;

/// The table's file.
pub const TABLE: &str = "study.json";

/// Why a study was not finished. What it has made stays, and it can be gone on with.
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

/// What is varied.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Numbers of vertices.
    pub points: Vec<usize>,
    /// Theta, in degrees, each with L as it is by default.
    pub angles: Vec<f64>,
    /// L, in tile sides, each with theta as it is by default.
    pub distances: Vec<f64>,
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
            picture: [1200, 900],
        }
    }
}

impl Plan {
    /// Each pair of theta and L once; the first is that of the default.
    fn constraints(&self) -> Vec<ConnectOptions> {
        let usual = ConnectOptions::default();
        let by_angle = self.angles.iter().map(|&max_angle| ConnectOptions { max_angle, ..usual });
        let by_distance = self.distances.iter().map(|&max_distance| ConnectOptions { max_distance, ..usual });
        let mut all = vec![usual];
        for constraint in by_angle.chain(by_distance) {
            if !all.contains(&constraint) {
                all.push(constraint);
            }
        }
        all
    }
}

/// A surface to be studied.
#[derive(Clone, Debug)]
pub struct Subject {
    /// Its name in tables and on charts.
    pub name: String,
    /// How the names of its files begin.
    pub stem: String,
    /// Its triangles.
    pub soup: Soup,
}

impl Subject {
    /// A number that another surface hardly has.
    fn digest(&self) -> String {
        let mut hasher = FxHasher::default();
        self.soup.points.as_flattened().iter().for_each(|x| x.to_bits().hash(&mut hasher));
        self.soup.triangles.hash(&mut hasher);
        format!("{:016x}", hasher.finish())
    }

    fn file(&self, points: usize, what: &str) -> String {
        format!("{}-{points}-{what}.png", self.stem)
    }
}

/// Does a study in a folder that is there, or goes on with it: rows, charts, pictures and a page that shows them.
///
/// `progress` is told what is done next, and the share of the work that is behind, from 0 to 1.
///
/// # Errors
/// [`StudyError`]; the rows that are done are kept.
pub fn run(
    folder: &Path,
    subjects: &[Subject],
    plan: &Plan,
    backend: &dyn Backend,
    progress: &dyn Fn(f64, &str),
) -> Result<Table, StudyError> {
    let old = table::read(&folder.join(TABLE))?;
    let mut work =
        Work { folder, picture: plan.picture, backend, progress, table: Table::default(), done: 0.0, all: 0.0 };
    let constraints = plan.constraints();
    for subject in subjects {
        let digest = subject.digest();
        let wanted = |row: &Row| row.digest == digest && row.surface == subject.name;
        work.table.rows.extend(old.rows.iter().filter(|row| wanted(row)).cloned());
    }
    let runs: f64 = plan.points.iter().map(|&points| weight(points, constraints.len())).sum();
    work.all = runs * subjects.len() as f64;
    for subject in subjects {
        for &points in &plan.points {
            work.group(subject, points, &constraints)?;
        }
    }
    work.table.rows.retain(|row| plan.points.contains(&row.points) && constraints.contains(&row.constraint()));
    work.table.sort(subjects, plan);
    work.save()?;
    for subject in subjects {
        charts::write(folder, subject, plan, &work.table)?;
    }
    page::write(folder, subjects, plan, &work.table)?;
    Ok(work.table)
}

/// How much work a mosaic and so many connections are: one connection of a point is one, and laying it four.
fn weight(points: usize, connections: usize) -> f64 {
    points as f64 * (4.0 + connections as f64)
}

struct Work<'a> {
    folder: &'a Path,
    picture: [u32; 2],
    backend: &'a dyn Backend,
    progress: &'a dyn Fn(f64, &str),
    table: Table,
    done: f64,
    all: f64,
}

impl Work<'_> {
    /// All that is wanted of one surface at one number of points.
    fn group(&mut self, subject: &Subject, points: usize, constraints: &[ConnectOptions]) -> Result<(), StudyError> {
        let digest = subject.digest();
        let known = |table: &Table, constraint: &ConnectOptions| {
            let same = |row: &&Row| row.points == points && row.digest == digest && row.constraint() == *constraint;
            table.rows.iter().any(|row| same(&row))
        };
        let pictures = ["mosaic", "before", "after"].map(|what| self.folder.join(subject.file(points, what)));
        let missing: Vec<ConnectOptions> =
            constraints.iter().filter(|constraint| !known(&self.table, constraint)).copied().collect();
        self.done += weight(points, constraints.len() - missing.len()) - weight(points, 0);
        if missing.is_empty() && pictures.iter().all(|picture| picture.is_file()) {
            self.done += weight(points, 0);
            return Ok(());
        }
        let say = |work: &Self, what: String| (work.progress)(work.done / work.all, &what);
        let name = &subject.name;
        // The paper has no pairing of triangles.
        let usual = Options { pairing: None, ..Options::new(Fineness::Points(points)) };
        say(self, format!("{name}, {points} points: mosaic"));
        let failed = |source: PipelineError| StudyError::Pipeline { surface: name.clone(), points, source };
        let compute = |source: ComputeError| failed(source.into());
        let started = Instant::now();
        let (surface, sizes, count) = prepare(&subject.soup, &usual).map_err(failed)?;
        let field = pipeline::field(&surface, sizes, count, &usual, self.backend).map_err(failed)?;
        let mosaic = pipeline::lay(&surface, &field, self.backend, count, &usual, &|_| ()).map_err(compute)?;
        let triangulation = triangulate(&surface, &field, &mosaic);
        let laid = started.elapsed();
        self.done += weight(points, 0);

        self.draw(&pictures[0], &mosaic_scene(&surface, &mosaic, 0.1, None))?;
        let connected = |connect| {
            let started = Instant::now();
            let options = Options { connect, ..usual.clone() };
            (pipeline::connected(&surface, &mosaic, &triangulation, &options), started.elapsed())
        };
        let Meshed { before, mesh, .. } = connected(usual.connect).0;
        self.draw(&pictures[1], &mesh_scene(&before, Paint::Sides))?;
        self.draw(&pictures[2], &mesh_scene(&mesh, Paint::Sides))?;
        for connect in missing {
            let ConnectOptions { max_distance, max_angle } = connect;
            say(self, format!("{name}, {points} points: theta {max_angle}, L {max_distance}"));
            let (meshed, time) = connected(connect);
            let milliseconds = |time: Duration| (time.as_secs_f64() * 1e4).round() / 10.0;
            self.table.rows.push(Row {
                surface: name.clone(),
                digest: digest.clone(),
                points,
                max_angle,
                max_distance,
                before: Figures::of(&meshed.before),
                after: Figures::of(&meshed.mesh),
                holes: meshed.holes,
                faults: check_joined(&meshed.mesh, &meshed.branches).list.len(),
                mosaic_ms: milliseconds(laid),
                mesh_ms: milliseconds(time),
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
        Ok(write_picture(path, scene, &View::default(), self.picture)?)
    }
}
