//! `quadmosaic study`.

use super::backend::Machine;
use super::fineness::points;
use super::input::Input;
use super::mesh::{degrees, distance};
use super::output::print;
use anyhow::{Context, ensure};
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use quadmosaic::mesh::connect::ConnectOptions;
use quadmosaic::study::{self, Plan, Subject, Table};
use std::fs;
use std::path::PathBuf;

/// Meshes surfaces by many angles and distances, as the paper's section 4 does, and draws charts
///
/// For each surface and number of points one mosaic is made and connected many times: by each theta with L = 1.6, and by each L
/// with theta = 30. The folder gets study.csv and study.json (a row each), charts of Qr, Qg, Tg and irregular vertices (SVG and
/// PNG), pictures of mosaics and meshes, and study.html, which shows them all. Interrupted, and called again, it goes on.
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// The surfaces: files, or examples (example:m6)
    #[arg(value_name = "SURFACE", required = true)]
    surfaces: Vec<Input>,
    /// The folder that results go to; it is made where it is missing
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
    #[command(flatten)]
    machine: Machine,
    /// Print warnings and errors only
    #[arg(short, long)]
    quiet: bool,
}

const EXAMPLES: &str = "\
Examples:
  quadmosaic study example:m6 -o study
  quadmosaic study fish.obj car.stl --points 6000 --angles 20,30,40 --distances 1.6 -o study";

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let Arguments { surfaces, output, points, angles, distances, machine, quiet } = arguments;
    machine.start_threads()?;
    let subjects = subjects(surfaces)?;
    fs::create_dir_all(output).with_context(|| format!("the folder {} cannot be made", output.display()))?;
    let device = machine.open()?;
    let backend = device.backend()?;
    let plan = Plan { points: points.clone(), angles: angles.clone(), distances: distances.clone(), ..Plan::default() };

    let bar = if *quiet { ProgressBar::hidden() } else { ProgressBar::new(1000) };
    let style = ProgressStyle::with_template("{bar:30} {percent:>3} %, about {eta} left: {wide_msg}");
    let bar = bar.with_style(style.expect("the template is right"));
    let progress = |share: f64, what: &str| {
        bar.set_message(what.to_owned());
        bar.set_position((1000.0 * share) as u64);
    };
    let table = study::run(output, &subjects, &plan, &*backend, &progress);
    bar.finish_and_clear();
    let table = table?;
    if !quiet {
        print(&summary(&table))?;
        print(&format!("{} shows it all\n", output.join("study.html").display()))?;
    }
    Ok(())
}

fn subjects(surfaces: &[Input]) -> anyhow::Result<Vec<Subject>> {
    let mut subjects: Vec<Subject> = Vec::new();
    for input in surfaces {
        let name = input.to_string();
        ensure!(!subjects.iter().any(|other| other.name == name), "{name} is given twice; name each surface once");
        // Two files of one name in two folders.
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

/// A line for each mosaic, by the default constraints, and how far the share of quads goes over all of them.
fn summary(table: &Table) -> String {
    let usual = ConnectOptions::default();
    let of_usual = |row: &&study::Row| row.max_angle == usual.max_angle && row.max_distance == usual.max_distance;
    let line = |row: &study::Row| {
        let same = table.rows.iter().filter(|other| other.surface == row.surface && other.points == row.points);
        let (least, most) =
            same.fold((1.0_f64, 0.0_f64), |(least, most), other| (least.min(other.after.qr), most.max(other.after.qr)));
        format!(
            "{}, {} points: Qr {:.3} before clean-up, {:.3} after ({least:.3} to {most:.3} over all theta and L)\n",
            row.surface, row.points, row.before.qr, row.after.qr
        )
    };
    table.rows.iter().filter(of_usual).map(line).collect()
}
