//! What is drawn: faces, lines and dots.

use super::array::{Floats, Indices};
use crate::export::tile_mesh;
use crate::field::Field;
use crate::mesh::quality::valences;
use crate::mesh::{Edge, Mesh};
use crate::mosaic::Mosaic;
use crate::picture::{Colour, FieldStyle, field_lines};
use crate::surface::{Frame, Surface};
use serde::Serialize;

/// Faces of any number of corners.
#[derive(Serialize)]
pub(super) struct Faces {
    /// Three numbers a vertex.
    points: Floats,
    /// The vertices of all faces, one face after the other; absent: each vertex once, in order.
    corners: Option<Indices>,
    /// The end of each face in `corners`; absent: all faces are triangles.
    ends: Option<Indices>,
}

/// Straight lines on the surface.
#[derive(Serialize)]
pub(super) struct Lines {
    name: &'static str,
    colour: String,
    /// In pixels.
    width: f32,
    /// Whether they are shown at first.
    shown: bool,
    /// Six numbers a line: its two ends.
    ends: Floats,
}

/// Dots on the surface.
#[derive(Serialize)]
pub(super) struct Dots {
    name: &'static str,
    colour: String,
    /// Their diameter in pixels.
    width: f32,
    /// Whether they are rings.
    ring: bool,
    /// Whether they are shown at first.
    shown: bool,
    /// Three numbers a dot.
    points: Floats,
}

/// The name and the colour of a kind of dots, and whether a number is of the kind.
type Kind<T> = (&'static str, Colour, fn(T) -> bool);

/// Places, in model units, as positions.
fn positions(frame: &Frame, places: impl IntoIterator<Item = [f64; 3]>) -> Floats {
    Floats(places.into_iter().flat_map(|place| frame.to_unit(place)).map(|x| x as f32).collect())
}

impl Faces {
    /// The faces of a mesh.
    pub fn of_mesh(frame: &Frame, mesh: &Mesh) -> Self {
        let mut end = 0;
        let ends = mesh.faces().map(|face| {
            end += face.len() as u32;
            end
        });
        Self {
            points: positions(frame, mesh.points.iter().copied()),
            ends: Some(Indices(ends.collect())),
            corners: Some(Indices(mesh.faces().flatten().copied().collect())),
        }
    }

    /// The triangles of a surface.
    pub fn of_surface(frame: &Frame, surface: &Surface) -> Self {
        let vertices = 0..surface.vertex_count() as u32;
        Self {
            points: positions(frame, vertices.map(|v| surface.frame().to_model(surface.point(v)))),
            corners: Some(Indices(surface.triangles.as_flattened().to_vec())),
            ends: None,
        }
    }

    /// The tiles of a mosaic, with grout between them.
    pub fn of_tiles(frame: &Frame, surface: &Surface, mosaic: &Mosaic, grout: f32) -> Self {
        let mesh = tile_mesh(surface, mosaic, grout).0;
        Self { corners: None, ..Self::of_mesh(frame, &mesh) }
    }
}

/// The interior vertices whose valence is not 4.
pub(super) fn irregular(frame: &Frame, mesh: &Mesh, edges: &[Edge]) -> Vec<Dots> {
    let (valence, boundary) = valences(mesh, edges);
    let kinds: [Kind<u32>; 3] = [
        ("valence 3", Colour::RED, |valence| valence == 3),
        ("valence 5", Colour::BLUE, |valence| valence == 5),
        ("other irregular valence", Colour::VIOLET, |valence| ![0, 3, 4, 5].contains(&valence)),
    ];
    let triangles_alone = mesh.faces().all(|face| face.len() == 3);
    let dots = kinds.map(|(name, colour, is_kind)| {
        let of_kind = (0..mesh.points.len()).filter(|&v| !boundary[v] && is_kind(valence[v]));
        Dots {
            name,
            colour: colour.hex(),
            width: 8.0,
            ring: false,
            // In a mesh of triangles most vertices are irregular.
            shown: !triangles_alone,
            points: positions(frame, of_kind.map(|v| mesh.points[v])),
        }
    });
    dots.into()
}

/// The feature curves of a surface, and the creases that are none.
pub(super) fn features(frame: &Frame, surface: &Surface) -> Vec<Lines> {
    let place = |v: u32| surface.frame().to_model(surface.point(v));
    let curves = surface.features().curves().iter().flat_map(|curve| curve.vertices.windows(2));
    let kept: Vec<[f64; 3]> = curves.flatten().map(|&v| place(v)).collect();
    let edges = surface.dropped_edges().iter().map(|edge| edge.half_edge);
    let dropped: Vec<[f64; 3]> = edges.flat_map(|h| [surface.origin(h), surface.target(h)]).map(place).collect();
    vec![
        Lines {
            name: "feature curves",
            colour: Colour::INK.hex(),
            width: 2.5,
            shown: true,
            ends: positions(frame, kept),
        },
        Lines {
            name: "dropped creases",
            colour: Colour::ORANGE.hex(),
            width: 1.5,
            shown: false,
            ends: positions(frame, dropped),
        },
    ]
}

/// Lines that follow a field.
pub(super) fn field(frame: &Frame, surface: &Surface, field: &Field) -> Lines {
    let lines = field_lines(surface, field, FieldStyle::Streamlines);
    Lines {
        name: "cross field",
        colour: Colour::BLUE.hex(),
        width: 1.3,
        shown: false,
        ends: positions(frame, lines.flat_map(|(ends, _)| ends)),
    }
}

/// The singularities of a field.
pub(super) fn singularities(frame: &Frame, surface: &Surface, field: &Field) -> Vec<Dots> {
    let found = field.singularities(surface);
    let kinds: [Kind<i32>; 2] = [
        ("singularities of positive index", Colour::RED, |quarters| quarters > 0),
        ("singularities of negative index", Colour::BLUE, |quarters| quarters < 0),
    ];
    let dots = kinds.map(|(name, colour, is_kind)| {
        let of_kind = found.iter().filter(|singularity| is_kind(singularity.quarters));
        let places = of_kind.map(|singularity| surface.frame().to_model(singularity.position));
        Dots { name, colour: colour.hex(), width: 15.0, ring: true, shown: false, points: positions(frame, places) }
    });
    dots.into()
}
