//! Scenes of surfaces and of meshes.

use super::normals::{CREASE_COSINE, corner_normals};
use super::scene::{Corner, NO_PEN};
use super::{Colour, Legend, Pen, Scene};
use crate::mesh::Mesh;
use crate::mesh::quality::measures_of;
use crate::surface::Surface;
use glam::{DVec3, Vec3};

/// What the colours of a mesh's faces tell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Paint {
    /// How many sides a face has: quads pale, triangles orange, larger faces violet; a mesh of triangles alone has one colour.
    #[default]
    Sides,
    /// Its shape: Qg of quads, Tg of triangles; larger faces are worth 0.
    Quality,
}

/// The sides of a mesh's faces.
const SIDE: Pen = Pen { colour: Colour::INK, width: 1.6, most: 0.1 };
/// The sides of a surface's triangles.
const TRIANGLE_SIDE: Pen = Pen { colour: Colour::PENCIL, width: 1.0, most: 0.06 };
/// Creases, boundaries and features.
const FEATURE: Pen = Pen { colour: Colour::INK, width: 2.6, most: f32::INFINITY };
/// Creases that are no features.
const DROPPED: Pen = Pen { colour: Colour::ORANGE, width: 1.3, most: f32::INFINITY };

/// A mesh and the sides of its faces. One of triangles alone is shaded smoothly, with its creases and boundaries drawn heavier.
pub fn mesh_scene(mesh: &Mesh, paint: Paint) -> Scene {
    let mut scene = Scene::default();
    scene.place(mesh.points.iter().copied());
    let all_triangles = mesh.faces().all(|face| face.len() == 3);
    let colour = |face: &[u32]| match (paint, face.len()) {
        (Paint::Quality, _) => Colour::of_quality(measures_of(mesh, face).0.max(0.0)),
        (Paint::Sides, 3) if all_triangles => Colour::CLAY,
        (Paint::Sides, 3) => Colour::ORANGE,
        (Paint::Sides, 4) => Colour::PALE,
        (Paint::Sides, _) => Colour::VIOLET,
    };
    if all_triangles {
        let triangles: Vec<[u32; 3]> = mesh.faces().map(|face| [face[0], face[1], face[2]]).collect();
        let creases = creases(&scene, &triangles);
        let pen = scene.pen(TRIANGLE_SIDE);
        smooth(&mut scene, &triangles, |t| colour(&triangles[t]), pen);
        let features = (0..creases.len()).filter(|&h| creases[h]);
        lines(&mut scene, &triangles, features, FEATURE);
    } else {
        let pen = scene.pen(SIDE);
        for face in mesh.faces().filter(|face| face.len() > 2) {
            scene.flat_face(face, colour(face), |_| pen);
        }
    }
    scene.legend = (paint == Paint::Quality).then(|| Legend { title: "shape: Qg, Tg".to_owned() });
    scene
}

/// A surface, smooth, with its features, and thin the creases that are none.
pub fn surface_scene(surface: &Surface, colour: Colour) -> Scene {
    let mut scene = Scene::default();
    let vertices = 0..surface.vertex_count() as u32;
    scene.place(vertices.map(|vertex| surface.frame().to_model(surface.point(vertex))));
    smooth(&mut scene, &surface.triangles, |_| colour, NO_PEN);
    let dropped = surface.dropped_edges().iter().map(|edge| edge.half_edge as usize);
    let features = (0..3 * surface.triangle_count()).filter(|&h| surface.features().is_feature(h as u32));
    lines(&mut scene, &surface.triangles, dropped, DROPPED);
    lines(&mut scene, &surface.triangles, features, FEATURE);
    scene
}

/// Adds triangles of a smooth surface.
fn smooth(scene: &mut Scene, triangles: &[[u32; 3]], colour: impl Fn(usize) -> Colour, pen: u8) {
    let normals: Vec<Vec3> = corner_normals(&scene.points, triangles);
    for (t, triangle) in triangles.iter().enumerate() {
        let corner = |k: usize| Corner { point: triangle[k], normal: normals[3 * t + k], pen };
        scene.face(&[0, 1, 2].map(corner), colour(t));
    }
}

/// Draws half-edges: as lines, since triangles beside them may be narrower than the pen.
fn lines(scene: &mut Scene, triangles: &[[u32; 3]], half_edges: impl Iterator<Item = usize>, pen: Pen) {
    let pen = scene.pen(pen);
    for h in half_edges {
        let ends = ends(triangles, h).map(|v| scene.points[v as usize].to_array());
        scene.line(ends, Vec3::ZERO, pen);
    }
}

/// The vertices that a half-edge joins.
fn ends(triangles: &[[u32; 3]], h: usize) -> [u32; 2] {
    [triangles[h / 3][h % 3], triangles[h / 3][(h + 1) % 3]]
}

/// Whether each side of triangles is a crease, a boundary, or one of more than two.
fn creases(scene: &Scene, triangles: &[[u32; 3]]) -> Vec<bool> {
    let key = |h: usize| {
        let [a, b] = ends(triangles, h);
        [a.min(b), a.max(b)]
    };
    let normals: Vec<DVec3> = triangles.iter().map(|triangle| scene.normal(triangle).as_dvec3()).collect();
    let mut sides: Vec<usize> = (0..3 * triangles.len()).collect();
    sides.sort_by_key(|&h| (key(h), h));
    let mut creases = vec![true; sides.len()];
    for same in sides.chunk_by(|&a, &b| key(a) == key(b)) {
        if let [a, b] = *same {
            // Two that run alike are turned against each other: their normals are to be opposite.
            let turned = if ends(triangles, a) == ends(triangles, b) { -1.0 } else { 1.0 };
            let crease = normals[a / 3].dot(normals[b / 3]) * turned < CREASE_COSINE;
            (creases[a], creases[b]) = (crease, crease);
        }
    }
    creases
}
