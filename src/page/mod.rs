//! One HTML file that shows a mesh, its surface, field and tiles, and on which strokes and sizes are drawn. It needs neither a
//! network nor a library: WebGL 2 draws.
//!
//! # Practice
//! Make a [`Page`] of a mesh, add what else is to be seen, and [write](write_page) it. What is drawn is saved from the page as a
//! file of guides ([`read_guides`](crate::field::read_guides)) and a file of sizes ([`read_sizes`](crate::sizes::read_sizes)), in
//! model units.
//!
//! The file holds an element `data` of JSON. Positions are `f32` from the centre of the mesh, in diagonals of its bounding box;
//! arrays are little-endian bytes in base64.

mod array;
mod html;
mod layers;
mod measures;

use crate::export::{WriteError, atomic};
use crate::field::Field;
use crate::mesh::{Mesh, quality::Quality};
use crate::mosaic::Mosaic;
use crate::picture::{Colour, STONES, named_turns};
use crate::surface::{Frame, Surface, shown};
use array::Indices;
use glam::DVec3;
use layers::{Dots, Faces, Lines};
use measures::{Histogram, Scale};
use serde::Serialize;
use std::path::Path;
use thiserror::Error;

/// A surface of more triangles is left out of a page.
pub const MOST_TRIANGLES: usize = 200_000;
/// More tiles are left out of a page.
pub const MOST_TILES: usize = 200_000;
/// The share of a tile's side between it and the next.
const GROUT: f32 = 0.1;

/// Why a mesh cannot be shown.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum PageError {
    /// There is no face, or all vertices are at one place.
    #[error("the mesh has no extent; check that the file holds faces")]
    Empty,
    /// A face names a vertex that is not there.
    #[error("face {face} uses vertex {vertex}, but there are only {vertices} vertices (counted from 0)")]
    MissingVertex {
        /// The face, counted from 0.
        face: usize,
        /// The vertex that it names.
        vertex: u32,
        /// The number of vertices.
        vertices: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} (counted from 0) is at {}, which is not finite", shown(.at))]
    NotFinite {
        /// The vertex, counted from 0.
        vertex: u32,
        /// Its place.
        at: [f64; 3],
    },
}

/// What a page shows.
pub struct Page {
    frame: Frame,
    data: Data,
}

/// The JSON of a page.
#[derive(Serialize)]
struct Data {
    program: &'static str,
    name: String,
    /// The centre, in model units, that positions are counted from.
    centre: [f64; 3],
    /// The unit of positions, in model units.
    diagonal: f64,
    /// The mean length of the mesh's edges, in model units.
    edge: f64,
    palette: Palette,
    /// Names, each with the directions that are to the right, up, and towards the eye.
    views: Vec<(&'static str, [[f64; 3]; 3])>,
    mesh: Faces,
    scales: Vec<Scale>,
    /// The scale of painted sizes.
    sizes: Scale,
    regions: Option<Regions>,
    surface: Option<Faces>,
    tiles: Option<Faces>,
    lines: Vec<Lines>,
    dots: Vec<Dots>,
    histograms: Vec<Histogram>,
    /// Names and values.
    figures: Vec<(String, String)>,
    notes: Vec<String>,
}

/// The colours of faces that no scale colours.
#[derive(Serialize)]
struct Palette {
    surface: String,
    grout: String,
    quad: String,
    triangle: String,
    polygon: String,
    back: String,
    ink: String,
    tiles: Vec<String>,
}

/// The named regions of the mesh's faces.
#[derive(Serialize)]
struct Regions {
    names: Vec<String>,
    colours: Vec<String>,
    of_face: Indices,
}

impl Page {
    /// A page of a mesh in model units, which its title calls `name`.
    ///
    /// # Errors
    /// Where the mesh has no extent, a vertex is missing, or a coordinate is not finite.
    pub fn new(name: &str, mesh: &Mesh) -> Result<Self, PageError> {
        let (frame, extent) = frame_of(mesh)?;
        let edges = mesh.edges();
        let regions = (!mesh.regions.of_face.is_empty()).then(|| Regions {
            names: mesh.regions.names.clone(),
            colours: (0..mesh.regions.names.len()).map(|number| Colour::of_region(number).hex()).collect(),
            of_face: Indices(mesh.regions.of_face.clone()),
        });
        let data = Data {
            program: concat!("quadmosaic ", env!("CARGO_PKG_VERSION")),
            name: name.to_owned(),
            centre: frame.centre,
            diagonal: frame.diagonal,
            edge: Quality::of(mesh).mean_edge,
            palette: Palette {
                surface: Colour::CLAY.hex(),
                grout: Colour::GROUT.hex(),
                quad: Colour::PALE.hex(),
                triangle: Colour::ORANGE.hex(),
                polygon: Colour::VIOLET.hex(),
                back: Colour::BACK.hex(),
                ink: Colour::INK.hex(),
                tiles: STONES.map(Colour::hex).into(),
            },
            views: named_turns(extent),
            mesh: Faces::of_mesh(&frame, mesh),
            scales: measures::scales(mesh, &edges),
            sizes: measures::scale_of_sizes(),
            regions,
            surface: None,
            tiles: None,
            lines: Vec::new(),
            dots: layers::irregular(&frame, mesh, &edges),
            histograms: measures::histograms(mesh, &edges),
            figures: Vec::new(),
            notes: Vec::new(),
        };
        Ok(Self { frame, data })
    }

    /// The same page with the triangles of a surface; a note tells where there are more than [`MOST_TRIANGLES`].
    pub fn with_surface(mut self, surface: &Surface) -> Self {
        let triangles = surface.triangle_count();
        if triangles > MOST_TRIANGLES {
            self.data.notes.push(format!(
                "The surface has {triangles} triangles. This page shows at most {MOST_TRIANGLES}, so the surface is left out, \
                 and strokes are drawn on the mesh."
            ));
            return self;
        }
        self.data.surface = Some(Faces::of_surface(&self.frame, surface));
        self
    }

    /// The same page with the features of a surface, and the creases that are none.
    pub fn with_features(mut self, surface: &Surface) -> Self {
        self.data.lines.extend(layers::features(&self.frame, surface));
        self
    }

    /// The same page with a cross field: lines that follow it, and its singularities.
    pub fn with_field(mut self, surface: &Surface, field: &Field) -> Self {
        self.data.lines.insert(0, layers::field(&self.frame, surface, field));
        self.data.dots.extend(layers::singularities(&self.frame, surface, field));
        self
    }

    /// The same page with the tiles of a mosaic; a note tells where there are more than [`MOST_TILES`].
    pub fn with_tiles(mut self, surface: &Surface, mosaic: &Mosaic) -> Self {
        let tiles = mosaic.tiles.len();
        if tiles > MOST_TILES {
            self.data.notes.push(format!(
                "There are {tiles} tiles. This page shows at most {MOST_TILES}, so the tiles are left out."
            ));
            return self;
        }
        self.data.tiles = Some(Faces::of_tiles(&self.frame, surface, mosaic, GROUT));
        self
    }

    /// The same page with a table of figures, each a name and its value.
    pub fn with_figures(mut self, figures: impl IntoIterator<Item = (String, String)>) -> Self {
        self.data.figures.extend(figures);
        self
    }

    /// The same page with a sentence, as a warning is one.
    pub fn with_note(mut self, note: impl Into<String>) -> Self {
        self.data.notes.push(note.into());
        self
    }

    /// The page as text.
    pub fn html(&self) -> String {
        html::html(&self.data.name, &self.json(), false)
    }

    /// The data of the page as JSON, for [`served_html`] and for the script of a page that shows another one.
    pub fn json(&self) -> String {
        html::json(&self.data)
    }
}

/// A page with the data of another one ([`Page::json`]) that asks the server it comes from for meshes: it posts to `run` and `cancel`,
/// and gets `status`, `data` and `mesh`, all beside its own address. It asks no other server.
pub fn served_html(title: &str, json: &str) -> String {
    html::html(title, json, true)
}

/// Writes a page to a file.
///
/// # Errors
/// [`WriteError`] names the file and the reason; no half written file is left.
pub fn write_page(path: &Path, page: &Page) -> Result<(), WriteError> {
    let text = page.html();
    atomic(path, |writer| writer.write_all(text.as_bytes()))
}

/// The frame of a mesh, by the vertices that its faces use, and the extent of its bounding box.
fn frame_of(mesh: &Mesh) -> Result<(Frame, [f64; 3]), PageError> {
    let vertices = mesh.points.len();
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for (face, corners) in mesh.faces().enumerate() {
        for &vertex in corners {
            let at = *mesh.points.get(vertex as usize).ok_or(PageError::MissingVertex { face, vertex, vertices })?;
            if !at.iter().all(|x| x.is_finite()) {
                return Err(PageError::NotFinite { vertex, at });
            }
            (low, high) = (low.min(at.into()), high.max(at.into()));
        }
    }
    let extent = high - low;
    // Of no face the extent is minus infinity.
    if extent.max_element() <= 0.0 {
        return Err(PageError::Empty);
    }
    Ok((Frame { centre: (low / 2.0 + high / 2.0).into(), diagonal: extent.length() }, extent.into()))
}
