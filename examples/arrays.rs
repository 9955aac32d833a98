//! From arrays to quads: `cargo run --release --example arrays`.

use quadmosaic::{Fineness, Mesher, Options, PipelineError, Soup};

fn main() -> Result<(), PipelineError> {
    // A cube of two triangles a side.
    let corner = |k: usize| [0, 1, 2].map(|axis| f64::from(u8::from(k >> axis & 1 == 1)));
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    let soup = Soup::new((0..8).map(corner).collect(), triangles);

    let outcome = Mesher::cpu().mesh(&soup, &Options::new(Fineness::Points(600)))?;

    let mesh = &outcome.meshed.mesh;
    println!("{} vertices, {} quads, {} triangles", mesh.points.len(), mesh.quads().count(), mesh.triangles().count());
    let first: Vec<[f64; 3]> = mesh.quads().take(1).flatten().map(|v| mesh.points[v as usize]).collect();
    println!("the first quad: {first:?}");
    Ok(())
}
