//! Small quads at one place: `cargo run --release --example sizes`.

use quadmosaic::sizes::{SizeOptions, SizeSample};
use quadmosaic::surface::examples::Example;
use quadmosaic::{Fineness, Mesher, Options, PipelineError};

fn main() -> Result<(), PipelineError> {
    let soup = Example::Torus.generate(5_000);
    // With a number of points the sizes are relative.
    let sample = |x: f64, size: f64| SizeSample { point: [x, 0.0, 0.0], size };
    let sizes = SizeOptions { samples: vec![sample(1.4, 1.0), sample(-1.4, 4.0)], ..SizeOptions::default() };
    let options = Options { sizes, ..Options::new(Fineness::Points(3_000)) };

    let outcome = Mesher::cpu().mesh(&soup, &options)?;

    let mesh = &outcome.meshed.mesh;
    let length = |[a, b, ..]: [u32; 4]| {
        let [a, b] = [a, b].map(|v| mesh.points[v as usize]);
        (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
    };
    for (side, is_there) in [("right", 1.0), ("left", -1.0)] {
        let quads = mesh.quads().filter(|quad| is_there * mesh.points[quad[0] as usize][0] > 1.2);
        let lengths: Vec<f64> = quads.map(length).collect();
        println!("{side}: edges of {:.4} in the mean", lengths.iter().sum::<f64>() / lengths.len() as f64);
    }
    Ok(())
}
