//! The rows of a study, as CSV and as JSON.

use super::{Plan, Setting, StudyError, Subject, TABLE};
use crate::export::{WriteError, atomic};
use crate::mesh::Mesh;
use crate::mesh::quality::Quality;
use serde::{Deserialize, Serialize};
use std::fs;
use std::io::{self, Write};
use std::path::Path;

const PROGRAM: &str = concat!("quadmosaic ", env!("CARGO_PKG_VERSION"));

/// The results of a study.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Table {
    /// The program's name and version.
    pub program: String,
    /// By surface, points, fit, theta and L.
    pub rows: Vec<Row>,
}

impl Default for Table {
    fn default() -> Self {
        Self { program: PROGRAM.to_owned(), rows: Vec::new() }
    }
}

/// One mosaic, connected once.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// The surface's name.
    pub surface: String,
    /// The BLAKE3 hash of its triangles, its regions and the options.
    pub digest: String,
    /// The vertices asked for.
    pub points: usize,
    /// Theta, in degrees.
    pub max_angle: f64,
    /// L, in tile sides.
    pub max_distance: f64,
    /// How far the sides of tiles follow the field.
    pub fit: f64,
    /// The mesh before the connectivity optimisation.
    pub before: Figures,
    /// The mesh after the paper's clean-up and relocation.
    pub cleaned: Figures,
    /// The mesh of the program.
    pub after: Figures,
    /// Holes of the connected mosaic before filling.
    pub holes: usize,
    /// Broken invariants of the mesh, and its differences from the surface.
    pub faults: usize,
    /// The largest side of a tile over the smallest.
    pub side_range: f64,
    /// Milliseconds from triangles to a triangulated mosaic, which is made once for many rows.
    pub mosaic_ms: f64,
    /// Milliseconds from there to the mesh.
    pub mesh_ms: f64,
    /// Warnings of guides without full effect.
    pub warnings: Vec<String>,
}

impl Row {
    pub(super) fn setting(&self) -> Setting {
        [self.max_angle, self.max_distance, self.fit]
    }

    /// Those before the optimisation, after the paper's clean-up, and of the program.
    pub(super) fn figures(&self) -> [&Figures; 3] {
        [&self.before, &self.cleaned, &self.after]
    }
}

/// The measures of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Figures {
    /// Vertices.
    pub vertices: usize,
    /// Quads.
    pub quads: usize,
    /// Triangles.
    pub triangles: usize,
    /// The paper's Qr: quads among all elements.
    pub qr: f64,
    /// The paper's mean Qg; absent where there are no quads.
    pub qg: Option<f64>,
    /// The paper's mean Tg; absent where there are no triangles.
    pub tg: Option<f64>,
    /// Interior vertices without four edges.
    pub irregular: usize,
}

impl Figures {
    pub(super) fn of(mesh: &Mesh) -> Self {
        let Quality { vertices, quads, triangles, qr, qg, tg, irregular_vertices, .. } = Quality::of(mesh);
        let mean = |spread: crate::mesh::quality::Spread| spread.mean;
        Self { vertices, quads, triangles, qr, qg: qg.map(mean), tg: tg.map(mean), irregular: irregular_vertices }
    }
}

impl Table {
    /// In the order of the subjects, of the plan's points, and then by fit, theta and L.
    pub(super) fn sort(&mut self, subjects: &[Subject], plan: &Plan) {
        let subject = |row: &Row| subjects.iter().position(|subject| subject.name == row.surface);
        let points = |row: &Row| plan.points.iter().position(|&points| points == row.points);
        self.rows.sort_by(|a, b| {
            (subject(a), points(a))
                .cmp(&(subject(b), points(b)))
                .then(a.fit.total_cmp(&b.fit))
                .then(a.max_angle.total_cmp(&b.max_angle))
                .then(a.max_distance.total_cmp(&b.max_distance))
        });
    }
}

/// Reads the table of an earlier run; empty where there is none, or it is of another version of the program.
pub(super) fn read(path: &Path) -> Result<Table, StudyError> {
    let failed = |reason: String| StudyError::Read { path: path.to_owned(), reason };
    match fs::read(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(Table::default()),
        Err(error) => Err(failed(error.to_string())),
        Ok(bytes) => {
            let table: Table = serde_json::from_slice(&bytes).map_err(|error| failed(error.to_string()))?;
            Ok(if table.program == PROGRAM { table } else { Table::default() })
        }
    }
}

/// Writes a table as `study.csv` and `study.json`.
pub(super) fn write(folder: &Path, table: &Table) -> Result<(), WriteError> {
    atomic(&folder.join("study.csv"), |writer| csv(writer, table))?;
    atomic(&folder.join(TABLE), |writer| {
        serde_json::to_writer_pretty(&mut *writer, table)?;
        writeln!(writer)
    })
}

fn csv(writer: &mut dyn Write, table: &Table) -> io::Result<()> {
    let mut writer = csv::Writer::from_writer(writer);
    let mut header = ["surface", "points", "theta", "L", "fit"].map(str::to_owned).to_vec();
    for of in ["_before", "_cleaned", ""] {
        let names = ["vertices", "quads", "triangles", "Qr", "Qg", "Tg", "irregular"];
        header.extend(names.map(|name| format!("{name}{of}")));
    }
    header.extend(["holes", "faults", "side_range", "mosaic_ms", "mesh_ms"].map(str::to_owned));
    writer.write_record(&header)?;
    for row in &table.rows {
        let Row { surface, points, max_angle, max_distance, fit, .. } = row;
        let mut values = vec![surface.clone(), points.to_string()];
        values.extend([max_angle, max_distance, fit].map(f64::to_string));
        for Figures { vertices, quads, triangles, qr, qg, tg, irregular } in row.figures() {
            let mean = |mean: Option<f64>| mean.map_or(String::new(), |mean| format!("{mean:.5}"));
            values.extend([vertices, quads, triangles].map(usize::to_string));
            values.extend([mean(Some(*qr)), mean(*qg), mean(*tg), irregular.to_string()]);
        }
        let Row { holes, faults, side_range, mosaic_ms, mesh_ms, .. } = row;
        values.extend([holes.to_string(), faults.to_string(), format!("{side_range:.3}")]);
        values.extend([mosaic_ms, mesh_ms].map(f64::to_string));
        writer.write_record(&values)?;
    }
    writer.flush()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_has_the_columns_of_the_header() {
        let figures = Figures { vertices: 9, quads: 4, triangles: 0, qr: 1.0, qg: Some(0.5), tg: None, irregular: 1 };
        let row = Row {
            surface: "a \"wing\", half".to_owned(),
            digest: String::new(),
            points: 10,
            max_angle: 30.0,
            max_distance: 1.6,
            fit: 0.0,
            before: figures,
            cleaned: figures,
            after: figures,
            holes: 2,
            faults: 0,
            side_range: 1.5,
            mosaic_ms: 3.1,
            mesh_ms: 4.0,
            warnings: Vec::new(),
        };
        let table = Table { rows: vec![row], ..Table::default() };
        let mut bytes = Vec::new();
        csv(&mut bytes, &table).expect("memory can be written");
        let text = String::from_utf8(bytes).expect("it is text");
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let header = reader.headers().expect("there is one").clone();
        let rows: Vec<_> = reader.records().collect::<Result<_, _>>().expect("all rows are as long as the header");
        let value = |name: &str| rows[0].get(header.iter().position(|column| column == name)?);
        for (name, wanted) in [("surface", "a \"wing\", half"), ("L", "1.6"), ("Qg_before", "0.50000"), ("Tg", "")] {
            assert_eq!(value(name), Some(wanted), "{name}");
        }
        assert_eq!((rows.len(), value("irregular"), value("mesh_ms")), (1, Some("1"), Some("4")));
        assert_ne!(text.lines().nth(1).map(|line| line.split(',').count()), Some(header.len()), "the name has a comma");
    }
}
