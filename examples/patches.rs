//! A large surface in patches: cut, meshed apart on several threads with one backend, and joined: `cargo run --release --example
//! patches [MESH.obj]`.
//!
//! The boundaries of the patches are resampled, so the points on a seam are the same on both of its sides, bit for bit.

use quadmosaic::Mesh;
use quadmosaic::export::{Format, MeshFile, write_mesh};
use quadmosaic::mesh::compare::check_against;
use quadmosaic::surface::examples::Example;
use quadmosaic::surface::{FeatureOptions, KeptBoundary};
use quadmosaic::{Fineness, Mesher, Options, PipelineError, Soup, Surface};
use rayon::prelude::*;
use std::collections::HashMap;
use std::path::PathBuf;
use std::time::Instant;

/// The plane of the points whose product with the normal is the offset.
#[derive(Clone, Copy)]
pub struct Plane {
    pub normal: [f64; 3],
    pub offset: f64,
}

/// A vertex nearer to a plane than this lies on it, in model units.
const ON_PLANE: f64 = 1e-9;

impl Plane {
    fn height(&self, p: [f64; 3]) -> f64 {
        let height = (0..3).map(|k| self.normal[k] * p[k]).sum::<f64>() - self.offset;
        if height.abs() < ON_PLANE { 0.0 } else { height }
    }
}

/// The parts of a surface below a plane and above it. Their points on the plane are the same.
pub fn cut(soup: &Soup, plane: Plane) -> [Soup; 2] {
    let mut points = soup.points.clone();
    let heights: Vec<f64> = points.iter().map(|&p| plane.height(p)).collect();
    let mut crossings: HashMap<[u32; 2], u32> = HashMap::new();
    let mut crossing = |a: u32, b: u32| {
        *crossings.entry([a.min(b), a.max(b)]).or_insert_with(|| {
            // In the order of the coordinates, so that both parts of an earlier cut are cut at the same point.
            let [p, q] = [soup.points[a as usize], soup.points[b as usize]];
            let (p, q) = if p < q { (p, q) } else { (q, p) };
            let share = plane.height(p) / (plane.height(p) - plane.height(q));
            points.push([0, 1, 2].map(|k| p[k] + (q[k] - p[k]) * share));
            points.len() as u32 - 1
        })
    };
    let mut parts = [Vec::new(), Vec::new()];
    for corners in &soup.triangles {
        for (part, side) in parts.iter_mut().zip([-1.0, 1.0]) {
            // The corners on this side, and the points where the triangle's sides cross the plane.
            let mut outline = Vec::new();
            for k in 0..3 {
                let [a, b] = [corners[k], corners[(k + 1) % 3]];
                let [from, to] = [a, b].map(|v| side * heights[v as usize]);
                if from >= 0.0 {
                    outline.push(a);
                }
                if from * to < 0.0 {
                    outline.push(crossing(a, b));
                }
            }
            let is_above = corners.iter().any(|&v| side * heights[v as usize] > 0.0);
            if is_above {
                part.extend((2..outline.len()).map(|k| [outline[0], outline[k - 1], outline[k]]));
            }
        }
    }
    parts.map(|triangles| Soup::new(points.clone(), triangles))
}

/// The patches between some planes.
pub fn patches(soup: &Soup, planes: &[Plane]) -> Vec<Soup> {
    let mut patches = vec![soup.clone()];
    for &plane in planes {
        patches = patches.iter().flat_map(|patch| cut(patch, plane)).collect();
        patches.retain(|patch| !patch.triangles.is_empty());
    }
    patches
}

/// The meshes of patches, with tiles of a side, made on several threads.
pub fn meshed(mesher: &Mesher, patches: &[Soup], options: &Options) -> Result<Vec<Mesh>, PipelineError> {
    patches.par_iter().map(|patch| Ok(mesher.mesh(patch, options)?.meshed.mesh)).collect()
}

/// One mesh, in which vertices with the same coordinates are one.
pub fn joined(meshes: &[Mesh]) -> Mesh {
    let mut numbers: HashMap<[u64; 3], u32> = HashMap::new();
    let mut whole = Mesh::default();
    for mesh in meshes {
        let number = |&point: &[f64; 3]| {
            *numbers.entry(point.map(|x| (x + 0.0).to_bits())).or_insert_with(|| {
                whole.points.push(point);
                whole.points.len() as u32 - 1
            })
        };
        let vertices: Vec<u32> = mesh.points.iter().map(number).collect();
        for face in mesh.faces() {
            whole.push_face(&face.iter().map(|&v| vertices[v as usize]).collect::<Vec<u32>>());
        }
    }
    whole
}

/// The M6 wing, and planes that cut it across its span and along its middle.
pub fn wing() -> (Soup, Vec<Plane>) {
    let soup = "m6".parse::<Example>().map_or_else(|error| unreachable!("{error}"), |wing| wing.generate(60_000));
    let across = [0.3, 0.6, 0.9].map(|offset| Plane { normal: [0.0, 1.0, 0.0], offset });
    let along = Plane { normal: [1.0, -0.5, 0.0], offset: 0.28 };
    (soup, across.into_iter().chain([along]).collect())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (soup, planes) = wing();
    let side = 0.02;
    let patches = patches(&soup, &planes);
    let options = Options { keep_boundary: Some(KeptBoundary::Resampled(side)), ..Options::new(Fineness::Size(side)) };

    let started = Instant::now();
    let mesh = joined(&meshed(&Mesher::cpu(), &patches, &options)?);
    println!("{} patches with {} vertices in {:.2?}", patches.len(), mesh.points.len(), started.elapsed());

    let (faults, comparison) = check_against(&mesh, &Surface::new(&soup, &FeatureOptions::default())?);
    let comparison = comparison.ok_or("the mesh has no extent")?;
    println!("{} faults, {} differences", faults.list.len(), comparison.differences.len());
    println!("Euler characteristic {}, of the surface {}", faults.topology().euler, comparison.topology.euler);
    if let Some(path) = std::env::args_os().nth(1).map(PathBuf::from) {
        write_mesh(&path, Format::Obj, &MeshFile::from(&mesh))?;
    }
    Ok(())
}
