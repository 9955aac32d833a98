//! A seed's surface and options, and what the method makes of them.

use super::judge::{Sense, euler, opposed, sense};
use super::kinds::{KINDS, Kind};
use super::random::Random;
use quadmosaic::compute::Cpu;
use quadmosaic::field::Align;
use quadmosaic::mesh::connectivity::{ConnectivityOptions, Quads};
use quadmosaic::parametrize::Rows;
use quadmosaic::pipeline::{Fineness, Options, run, unwatched};
use quadmosaic::surface::{FeatureOptions, Soup};
use std::collections::BTreeMap;
use std::fmt::Debug;
use std::fs;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::time::{Duration, Instant};

/// Options of `quadmosaic mesh`, and what they change.
pub struct Choice {
    pub arguments: &'static str,
    apply: fn(&mut Options),
}

const fn choice(arguments: &'static str, apply: fn(&mut Options)) -> Choice {
    Choice { arguments, apply }
}

fn with_quads(options: &mut Options, quads: Quads) {
    options.connectivity = Some(ConnectivityOptions { quads, ..ConnectivityOptions::default() });
}

fn with_fit(options: &mut Options) {
    (options.fit, options.rows) = (1.0, Rows::Continuous);
}

const CHOICES: [Choice; 12] = [
    choice("", |_| ()),
    choice("--quads all", |options| with_quads(options, Quads::All)),
    choice("--quads paper", |options| with_quads(options, Quads::Paper)),
    choice("--fit 1 --rows continuous", with_fit),
    choice("--rows continuous", |options| options.rows = Rows::Continuous),
    choice("--fit 1", |options| options.fit = 1.0),
    choice("--refine-curvature 15", |options| options.sizes.curvature = Some(15.0)),
    choice("--around 0", |options| options.sizes.around = 0.0),
    choice("--align curvature:1", |options| options.field.align = Some(Align { weight: 1.0, side: None })),
    choice("--crease 30", |options| {
        options.features = FeatureOptions { crease: 30.0, every_crease: true, ..FeatureOptions::default() };
    }),
    choice("--quads all --fit 1 --rows continuous", |options| {
        with_quads(options, Quads::All);
        with_fit(options);
    }),
    choice("--quads all --refine-curvature 15", |options| {
        with_quads(options, Quads::All);
        options.sizes.curvature = Some(15.0);
    }),
];

pub struct Trial {
    pub seed: u64,
    pub kind: &'static Kind,
    pub soup: Soup,
    pub points: usize,
    pub choice: &'static Choice,
}

/// What a trial gave.
pub struct Verdict {
    /// The number of failures of each name: faults and differences that the method tells, `Panic` and `Error`, and
    /// `WrongEuler` and `Opposed` by [`super::judge`]. None where the mesh is right.
    pub failures: BTreeMap<String, usize>,
    pub time: Duration,
}

impl Trial {
    /// The trial of a seed.
    pub fn new(seed: u64) -> Self {
        let mut random = Random::new(seed);
        let kind = &KINDS[random.whole(0, KINDS.len() - 1)];
        let points = match random.whole(0, 99) {
            0..10 => random.scale(20.0, 50.0),
            10..70 => random.scale(50.0, 600.0),
            70..97 => random.scale(600.0, 3_000.0),
            _ => random.scale(3_000.0, 20_000.0),
        };
        let choice = if random.chance(0.3) { &CHOICES[0] } else { &CHOICES[random.whole(1, CHOICES.len() - 1)] };
        let soup = (kind.generate)(&mut random).placed(&mut random);
        Self { seed, kind, soup, points: points as usize, choice }
    }

    /// The command that repeats the trial on a file.
    pub fn command(&self, file: &Path) -> String {
        let arguments = self.choice.arguments;
        format!("quadmosaic mesh {} --points {} {arguments} -o mesh.obj", file.display(), self.points)
    }

    pub fn write(&self, file: &Path) -> io::Result<()> {
        let points = self.soup.points.iter().map(|[x, y, z]| format!("v {x:?} {y:?} {z:?}\n"));
        let triangles = self.soup.triangles.iter().map(|[a, b, c]| format!("f {} {} {}\n", a + 1, b + 1, c + 1));
        fs::write(file, points.chain(triangles).collect::<String>())
    }

    /// Meshes the surface on this thread's pool and judges the mesh.
    pub fn judged(&self) -> Verdict {
        let mut options = Options::new(Fineness::Points(self.points));
        (self.choice.apply)(&mut options);
        let start = Instant::now();
        let outcome = catch_unwind(AssertUnwindSafe(|| run(&self.soup, &options, &Cpu, &unwatched)));
        let time = start.elapsed();
        let mut failures = BTreeMap::new();
        let mut fail = |name: String, count: usize| *failures.entry(name).or_default() += count;
        match outcome {
            Err(_) => fail("Panic".to_owned(), 1),
            Ok(Err(error)) => {
                println!("seed {}: {error}", self.seed);
                fail("Error".to_owned(), 1);
            }
            Ok(Ok(outcome)) => {
                let meshed = outcome.meshed;
                meshed.faults.list.iter().for_each(|fault| fail(name_of(&fault.kind), 1));
                meshed.differences.iter().for_each(|difference| fail(name_of(difference), 1));
                let faces: Vec<&[u32]> = meshed.mesh.faces().collect();
                if euler(faces.iter().copied()) != euler(self.soup.triangles.iter().map(|t| &t[..])) {
                    fail("WrongEuler".to_owned(), 1);
                }
                let sense = if self.kind.joined { Sense::OfSheets } else { sense(&self.soup) };
                match opposed(&meshed.mesh.points, &faces, &self.soup, sense) {
                    0 => (),
                    count => fail("Opposed".to_owned(), count),
                }
            }
        }
        Verdict { failures, time }
    }
}

/// The name of a variant.
fn name_of(value: &impl Debug) -> String {
    let text = format!("{value:?}");
    text.split(' ').next().unwrap_or_default().to_owned()
}
