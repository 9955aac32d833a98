//! The connectivity of a mesh: each operation on the smallest mesh that shows it, where it must refuse, and what it leaves.

#[path = "../common/plate.rs"]
mod plate;

mod invariants;
mod pair;
mod paper;
mod untangle;

use quadmosaic::mesh::connectivity::{ConnectivityOptions, EditCounts, Quads, optimise};
use quadmosaic::mesh::{Context, Mesh, SurfaceMesh};
use quadmosaic::surface::Surface;

/// A mesh before and after.
struct Optimised {
    before: Mesh,
    after: Mesh,
    /// The vertex before that each one was; `u32::MAX` for one that is new.
    origins: Vec<u32>,
    counts: EditCounts,
}

/// Optimises a mesh, in model units, on a surface.
fn optimised(surface: &Surface, mesh: &Mesh, options: &ConnectivityOptions) -> Optimised {
    let context = Context::new(surface);
    optimised_on(&context, SurfaceMesh::of(&context, mesh), options)
}

fn optimised_on(context: &Context, mut mesh: SurfaceMesh, options: &ConnectivityOptions) -> Optimised {
    let before = mesh.in_model_units(context);
    let counts = optimise(context, &mut mesh, options);
    let origins = mesh.compacted().vertices().iter().map(|vertex| vertex.origin).collect();
    Optimised { before, after: mesh.in_model_units(context), origins, counts }
}

/// What becomes of which triangles, all else by default.
fn with(quads: Quads) -> ConnectivityOptions {
    ConnectivityOptions { quads, ..ConnectivityOptions::default() }
}

/// A mesh in the plane.
fn flat(points: &[[f64; 2]], faces: &[&[u32]]) -> Mesh {
    let mut mesh = Mesh::new(points.iter().map(|[x, y]| [*x, *y, 0.0]).collect());
    faces.iter().for_each(|face| mesh.push_face(face));
    mesh
}

/// The faces, each turned so that its smallest vertex comes first, sorted.
fn faces(mesh: &Mesh) -> Vec<Vec<u32>> {
    let mut faces: Vec<Vec<u32>> = mesh
        .faces()
        .map(|face| {
            let first = (0..face.len()).min_by_key(|k| face[*k]).expect("it has corners");
            face[first..].iter().chain(&face[..first]).copied().collect()
        })
        .collect();
    faces.sort();
    faces
}

/// The signed area of a mesh in the plane.
fn area(mesh: &Mesh) -> f64 {
    mesh.faces().map(|face| area_of(mesh, face)).sum()
}

fn area_of(mesh: &Mesh, face: &[u32]) -> f64 {
    let cross = |a: u32, b: u32| {
        let ([ax, ay, _], [bx, by, _]) = (mesh.points[a as usize], mesh.points[b as usize]);
        (ax * by - ay * bx) / 2.0
    };
    (0..face.len()).map(|k| cross(face[k], face[(k + 1) % face.len()])).sum()
}

/// SplitMix64, in [0, 1).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// A face of four corners, or two triangles by one of its diagonals, as chance has it.
fn push_split(mesh: &mut Mesh, [a, b, c, d]: [u32; 4], split: f64, random: &mut Random) {
    if random.next() >= split {
        mesh.push_face(&[a, b, c, d]);
    } else if random.next() < 0.5 {
        mesh.push_face(&[a, b, c]);
        mesh.push_face(&[a, c, d]);
    } else {
        mesh.push_face(&[a, b, d]);
        mesh.push_face(&[b, c, d]);
    }
}
