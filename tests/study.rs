//! The study: every pair of theta and L once, charts and a page, and nothing done twice.

mod common;

use common::surfaces::example;
use quadmosaic::compute::Cpu;
use quadmosaic::field::{FieldOptions, Guide};
use quadmosaic::mesh::connect::ConnectOptions;
use quadmosaic::mesh::quality::Quality;
use quadmosaic::parametrize::Rows;
use quadmosaic::pipeline::{self, Fineness, Options};
use quadmosaic::study::{self, Plan, StudyError, Subject, Table};
use quadmosaic::surface::Regions;
use std::cell::RefCell;
use std::fs;
use std::path::Path;

fn plan() -> Plan {
    let (angles, distances) = (vec![20.0, 30.0], vec![1.6, 2.0]);
    Plan { points: vec![150, 300], angles, distances, picture: [120, 90], ..Plan::default() }
}

fn subject(name: &str) -> Subject {
    Subject { name: format!("a <{name}>"), stem: name.to_owned(), soup: example(name, 600) }
}

fn studied(folder: &Path, subjects: &[Subject], plan: &Plan) -> (Table, Vec<String>) {
    let said = RefCell::new(Vec::new());
    let last = RefCell::new(0.0);
    let table = study::run(folder, subjects, plan, &Cpu, &|share, what| {
        assert!((0.0..=1.0).contains(&share) && share >= *last.borrow(), "{share} after {}", last.borrow());
        *last.borrow_mut() = share;
        said.borrow_mut().push(what.to_owned());
    });
    (table.unwrap_or_else(|error| panic!("{error}")), said.into_inner())
}

#[test]
fn every_pair_is_a_row_with_the_figures_of_a_run() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let subjects = [subject("torus"), subject("plate")];
    let (table, _) = studied(folder.path(), &subjects, &plan());
    // 30 degrees and 1.6 are in both sweeps, and done once.
    let pairs: Vec<_> = table.rows[..3].iter().map(|row| (row.max_angle, row.max_distance)).collect();
    assert_eq!(pairs, [(20.0, 1.6), (30.0, 1.6), (30.0, 2.0)]);
    assert_eq!(table.rows.len(), 2 * 2 * 3);

    let row = &table.rows[9];
    assert_eq!((row.surface.as_str(), row.points, row.max_angle), ("a <plate>", 300, 20.0));
    let connect = ConnectOptions { max_angle: 20.0, max_distance: 1.6 };
    let options = Options { connect, ..Options::new(Fineness::Points(300)) };
    let paper = options.clone().with_paper_clean_up();
    let [outcome, paper] = [options, paper].map(|options| {
        pipeline::run(&subjects[1].soup, &options, &Cpu, &pipeline::unwatched).unwrap_or_else(|error| panic!("{error}"))
    });
    for (found, mesh) in
        [(row.before, &outcome.meshed.before), (row.cleaned, &paper.meshed.mesh), (row.after, &outcome.meshed.mesh)]
    {
        let Quality { vertices, quads, qr, qg, tg, .. } = Quality::of(mesh);
        assert_eq!((found.vertices, found.quads, found.qr), (vertices, quads, qr));
        assert_eq!((found.qg, found.tg), (qg.map(|spread| spread.mean), tg.map(|spread| spread.mean)));
    }
    assert!(row.before.qg != row.cleaned.qg && row.cleaned.qr != row.after.qr, "three meshes that differ: {row:?}");
    assert_eq!((row.holes, row.faults), (outcome.meshed.holes, 0));

    let csv = fs::read_to_string(folder.path().join("study.csv")).expect("it is there");
    let lines: Vec<&str> = csv.lines().collect();
    assert_eq!(lines.len(), 13);
    assert!(lines[10].starts_with("a <plate>,300,20,1.6,0,"), "{}", lines[10]);
    assert!(lines.iter().all(|line| line.split(',').count() == lines[0].split(',').count()));
    let page = fs::read_to_string(folder.path().join("study.html")).expect("it is there");
    assert_eq!(page.matches("<svg").count(), 2 * 4, "a chart for each measure");
    assert_eq!(page.matches("data:image/png;base64,").count(), 2 * 2 * 3, "mosaic, mesh before, mesh after");
    assert!(page.contains("a &lt;plate>") && !page.contains("src=\"http"));
    let made = |name: &str| folder.path().join(name).is_file();
    assert!(["torus-qr.svg", "plate-irregular.svg", "plate-300-mosaic.png"].into_iter().all(made));
    assert!(!made("torus-qr.png"), "charts are SVG alone");
}

#[test]
fn what_is_done_is_not_done_again() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join(study::TABLE);
    let subjects = [subject("torus")];
    let (whole, said) = studied(folder.path(), &subjects, &plan());
    assert_eq!(said.len(), 2 + 6);
    // Times are never the same twice: an equal table was not made again.
    let (again, said) = studied(folder.path(), &subjects, &plan());
    assert_eq!((&again, said.len()), (&whole, 0));

    // As if it had been interrupted.
    let mut part = whole.clone();
    let lost = part.rows.remove(4);
    fs::write(&file, serde_json::to_vec(&part).expect("it is JSON")).expect("it can be written");
    let (mended, said) = studied(folder.path(), &subjects, &plan());
    assert_eq!(said, ["a <torus>, 300 points: mosaic", "a <torus>, 300 points: theta 30, L 1.6"]);
    assert_eq!(mended.rows.iter().filter(|row| whole.rows.contains(row)).count(), 5);
    assert_eq!((mended.rows[4].before, mended.rows[4].after), (lost.before, lost.after));

    // More angles are added to what is there; fewer are left out of the table.
    let more = Plan { angles: vec![20.0, 25.0, 30.0], ..plan() };
    assert_eq!(studied(folder.path(), &subjects, &more).1.len(), 2 + 2);
    let (fewer, said) = studied(folder.path(), &subjects, &Plan { points: vec![150], ..plan() });
    assert_eq!((fewer.rows.len(), said.len()), (3, 0));

    // Another surface of the same name is another one.
    let other = Subject { soup: example("sphere", 600), ..subjects[0].clone() };
    let (table, said) = studied(folder.path(), &[other], &Plan { points: vec![150], ..plan() });
    assert_eq!(said.len(), 1 + 3);
    assert_ne!(table.rows[0].digest, whole.rows[0].digest);
    // So is one with other regions, whose borders would be features.
    let mut parted = subjects[0].clone();
    let triangles = parted.soup.triangles.len();
    let of_face = (0..triangles).map(|triangle| u32::from(2 * triangle > triangles)).collect();
    parted.soup.regions = Regions { names: vec!["near".to_owned(), "far".to_owned()], of_face };
    let (table, said) = studied(folder.path(), &[parted.clone()], &Plan { points: vec![150], ..plan() });
    assert_eq!(said.len(), 1 + 3);
    assert_ne!(table.rows[0].digest, whole.rows[0].digest);
    assert_eq!(studied(folder.path(), &[parted], &Plan { points: vec![150], ..plan() }).1.len(), 0);
}

#[test]
fn each_fit_has_a_mosaic_and_all_options_count() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let subjects = [subject("sphere")];
    let fits = Plan { points: vec![300], angles: vec![30.0], distances: vec![1.6], fits: vec![0.0, 1.0], ..plan() };
    let (table, said) = studied(folder.path(), &subjects, &fits);
    assert_eq!(said.len(), 2 + 2);
    let [none, all] = &table.rows[..] else { panic!("two rows, not {}", table.rows.len()) };
    assert_eq!((none.fit, all.fit), (0.0, 1.0));
    assert!(none.side_range < all.side_range && none.side_range >= 1.0, "{} {}", none.side_range, all.side_range);
    let page = fs::read_to_string(folder.path().join("study.html")).expect("it is there");
    assert_eq!(page.matches("<svg").count(), 5, "one of the range of sides too");
    assert!(page.contains("fit (theta = 30, L = 1.6)") && !page.contains("theta in degrees (L"), "what is not varied");
    assert_eq!(page.matches("data:image/png;base64,").count(), 3, "pictures without fit alone");

    // Other options make it another study.
    let options = Options { rows: Rows::Continuous, ..fits.options.clone() };
    let (other, said) = studied(folder.path(), &subjects, &Plan { options, ..fits.clone() });
    assert_eq!(said.len(), 2 + 2);
    assert_ne!(other.rows[1].after, all.after);
    // A guide that is far away is told of for each row, also when it is read again.
    let far = Guide::vector([9.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
    let field = FieldOptions { guides: vec![far], ..FieldOptions::default() };
    let guided = Plan { options: Options { field, ..fits.options.clone() }, fits: Vec::new(), ..fits };
    for _ in 0..2 {
        let (table, _) = studied(folder.path(), &subjects, &guided);
        assert!(table.rows[0].warnings[0].contains("away from the surface"), "{:?}", table.rows[0].warnings);
    }
    assert!(all.warnings.is_empty());
}

#[test]
fn a_table_that_is_none_is_refused_and_one_of_another_version_made_anew() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join(study::TABLE);
    fs::write(&file, "{").expect("it can be written");
    let small = Plan { points: vec![100], angles: Vec::new(), distances: Vec::new(), ..plan() };
    let refused = study::run(folder.path(), &[subject("sphere")], &small, &Cpu, &|_, _| ());
    assert!(matches!(refused, Err(StudyError::Read { path, .. }) if path == file));
    fs::write(&file, r#"{"program": "quadmosaic 0.0.0", "rows": []}"#).expect("it can be written");
    let (table, _) = studied(folder.path(), &[subject("sphere")], &small);
    assert_eq!(table.rows.len(), 1, "the default pair is always there");
    assert_ne!(table.program, "quadmosaic 0.0.0");

    let empty = Subject { soup: quadmosaic::surface::Soup::default(), ..subject("torus") };
    let error = study::run(folder.path(), &[empty], &small, &Cpu, &|_, _| ()).expect_err("there is nothing to mesh");
    assert!(error.to_string().starts_with("a <torus> at 100 points: "), "{error}");
    let lost = study::run(&folder.path().join("none"), &[subject("sphere")], &small, &Cpu, &|_, _| ());
    assert!(matches!(lost, Err(StudyError::Picture(_) | StudyError::Write(_))));
}
