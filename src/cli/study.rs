//! `quadmosaic study`.

use super::backend::Machine;
use super::field_arguments::FieldArguments;
use super::input::Input;
use super::layout::LayoutArguments;
use super::output::print;
use anyhow::{Context, ensure};
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use quadmosaic::mesh::connect::ConnectOptions;
use quadmosaic::options::{degrees, dial, distance, points};
use quadmosaic::study::{self, Plan, Subject, Table};
use std::fs;
use std::path::PathBuf;

/// Meshes surfaces by many angles and distances, as the paper's section 4 does, and draws charts
///
/// For each surface and number of points one mosaic is made and connected many times: by each theta with L = 1.6, and by each L
/// with theta = 30. Meshes are measured before clean-up, after the paper's clean-up (`mesh --quads paper`), and as `mesh` writes
/// them. The folder gets study.csv and study.json (a row for each mesh), charts of Qr, Qg, Tg and irregular vertices (SVG),
/// pictures of mosaics and meshes, and study.html, which shows them all. An interrupted study goes on when it is called again.
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// The surfaces: files, or examples (example:m6)
    #[arg(value_name = "SURFACE", required = true)]
    surfaces: Vec<Input>,
    /// The folder of the results; it is created where it is missing
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Numbers of vertices
    #[arg(long, value_name = "N,...", value_delimiter = ',', value_parser = points, default_value = "6000,30000,60000")]
    points: Vec<usize>,
    /// Theta, in degrees
    #[arg(
        long,
        value_name = "THETA,...",
        value_delimiter = ',',
        value_parser = degrees::<45>,
        default_value = "10,15,20,25,30,35,40,45"
    )]
    angles: Vec<f64>,
    /// L, in tile sides
    #[arg(
        long,
        value_name = "L,...",
        value_delimiter = ',',
        value_parser = distance,
        default_value = "1.2,1.4,1.6,1.8,2,2.2,2.4"
    )]
    distances: Vec<f64>,
    /// Dials of --fit, with theta = 30 and L = 1.6; each takes a mosaic of its own [default: none but --fit]
    #[arg(long, value_name = "DIAL,...", value_delimiter = ',', value_parser = dial)]
    fits: Vec<f64>,
    #[command(flatten)]
    directions: FieldArguments,
    #[command(flatten)]
    layout: LayoutArguments,
    #[command(flatten)]
    machine: Machine,
    /// Print warnings and errors only
    #[arg(short, long)]
    quiet: bool,
}

const EXAMPLES: &str = "\
Examples:
  quadmosaic study example:m6 -o study
  quadmosaic study fish.obj car.stl --points 6000 --angles 20,30,40 --distances 1.6 -o study
  quadmosaic study example:m6 --points 6000 --angles 30 --distances 1.6 --fits 0,0.5,1 --rows continuous -o fits";

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let Arguments { surfaces, output, machine, quiet, .. } = arguments;
    let plan = arguments.plan()?;
    machine.start_threads()?;
    let subjects = subjects(surfaces)?;
    fs::create_dir_all(output).with_context(|| format!("the folder {} cannot be made", output.display()))?;
    let mesher = machine.mesher()?;
    let backend = mesher.backend();

    let bar = if *quiet { ProgressBar::hidden() } else { ProgressBar::new(1000) };
    let style = ProgressStyle::with_template("{bar:30} {percent:>3} %, about {eta} left: {wide_msg}");
    let bar = bar.with_style(style.expect("the template is right"));
    let progress = |share: f64, what: &str| {
        bar.set_message(what.to_owned());
        bar.set_position((1000.0 * share) as u64);
    };
    let table = study::run(output, &subjects, &plan, backend, &progress);
    bar.finish_and_clear();
    let table = table?;
    if !quiet {
        print(&summary(&table))?;
        print(&format!("{} shows it all\n", output.join("study.html").display()))?;
    }
    // A guide has the same warning for many meshes.
    let mut warnings: Vec<String> = Vec::new();
    for row in &table.rows {
        for warning in row.warnings.iter().map(|told| format!("{}: {told}", row.surface)) {
            if !warnings.contains(&warning) {
                eprintln!("warning: {warning}");
                warnings.push(warning);
            }
        }
    }
    Ok(())
}

impl Arguments {
    fn plan(&self) -> anyhow::Result<Plan> {
        let plan = Plan::default();
        Ok(Plan {
            points: self.points.clone(),
            angles: self.angles.clone(),
            distances: self.distances.clone(),
            fits: self.fits.clone(),
            options: self.layout.options(&self.directions, plan.options)?,
            ..plan
        })
    }
}

fn subjects(surfaces: &[Input]) -> anyhow::Result<Vec<Subject>> {
    let mut subjects: Vec<Subject> = Vec::new();
    for input in surfaces {
        let name = input.to_string();
        ensure!(!subjects.iter().any(|other| other.name == name), "{name} is given twice; name each surface once");
        // Files in two folders may have the same name.
        let plain = input.stem();
        let taken = |stem: &str| subjects.iter().any(|other| other.stem == stem);
        let mut stem = plain.clone();
        for number in 2.. {
            if !taken(&stem) {
                break;
            }
            stem = format!("{plain}-{number}");
        }
        subjects.push(Subject { name, stem, soup: input.read(None)? });
    }
    Ok(subjects)
}

/// A line for each mosaic with the default constraints, and the range of Qr over all constraints.
fn summary(table: &Table) -> String {
    let usual = ConnectOptions::default();
    let of_usual = |row: &&study::Row| row.max_angle == usual.max_angle && row.max_distance == usual.max_distance;
    let fitted = table.rows.iter().any(|row| row.fit != table.rows[0].fit);
    let line = |row: &study::Row| {
        let same =
            |other: &&study::Row| (&other.surface, other.points, other.fit) == (&row.surface, row.points, row.fit);
        let same: Vec<f64> = table.rows.iter().filter(same).map(|other| other.after.qr).collect();
        let (least, most) = same.iter().fold((1.0_f64, 0.0_f64), |(least, most), &qr| (least.min(qr), most.max(qr)));
        let over_all = match same.len() {
            1 => String::new(),
            _ => format!(" ({least:.3} to {most:.3} over all theta and L)"),
        };
        let fit = if fitted { format!(", fit {}", row.fit) } else { String::new() };
        format!(
            "{}, {} points{fit}: Qr {:.3} before clean-up, {:.3} after the paper's, {:.3} in the end{over_all}\n",
            row.surface, row.points, row.before.qr, row.cleaned.qr, row.after.qr
        )
    };
    table.rows.iter().filter(of_usual).map(line).collect()
}
