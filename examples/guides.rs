//! Rows along a direction and along a stroke: `cargo run --release --example guides`.

use quadmosaic::field::{FieldOptions, Guide};
use quadmosaic::surface::examples::Example;
use quadmosaic::{Fineness, Mesher, Options, PipelineError};

fn main() -> Result<(), PipelineError> {
    let soup = Example::Sphere.generate(5_000);
    let equator =
        (0..=16).map(|k| f64::from(k) * std::f64::consts::TAU / 16.0).map(|t| [t.cos(), t.sin(), 0.0]).collect();
    let guides = [
        Guide::stroke(equator).named("the equator"),
        Guide::vector([0.0, 0.0, 1.0], [1.0, 1.0, 0.0]).within(0.2).named("the pole"),
    ];
    let options = Options { field: FieldOptions::guided(guides), ..Options::new(Fineness::Points(2_000)) };

    let mesher = Mesher::cpu();
    let outcome = mesher.mesh(&soup, &options)?;

    let report = mesher.report("sphere", &options, &outcome);
    for guide in &report.field.guides {
        println!("{} constrains {} crosses", guide.name, guide.crosses);
    }
    report.warnings().iter().for_each(|warning| println!("warning: {warning}"));
    Ok(())
}
