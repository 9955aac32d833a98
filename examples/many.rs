//! Many meshes on several threads with one backend: `cargo run --release --example many`.

use quadmosaic::surface::examples::Example;
use quadmosaic::{Fineness, Mesher, Options, PipelineError};
use rayon::prelude::*;
use std::time::Instant;

fn main() -> Result<(), PipelineError> {
    // On a GPU the kernels are compiled here, once.
    let mesher = Mesher::cpu();
    let soups: Vec<_> = (0..50).map(|k| [Example::Sphere, Example::Torus][k % 2].generate(1_000 + 10 * k)).collect();
    let options = Options::new(Fineness::Points(500));

    let started = Instant::now();
    let quads: Result<Vec<usize>, PipelineError> =
        soups.par_iter().map(|soup| Ok(mesher.mesh(soup, &options)?.meshed.mesh.quads().count())).collect();

    let quads: usize = quads?.iter().sum();
    println!("{} meshes with {quads} quads in {:.2?}", soups.len(), started.elapsed());
    Ok(())
}
