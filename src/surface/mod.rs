//! The input: triangles read or generated, welded, oriented, with adjacency and features.
//!
//! # Practice
//! Coordinates are read as f64, recentred, divided by the diagonal of their bounding box, and computed with as f32; [`Frame`] reverts
//! the transform. For writing, the input's own coordinates stay beside them ([`Surface::model_point`]). So a surface far from the
//! origin, or very small or large, is meshed as its recentred, unit-sized copy is.

mod adjacency;
mod apexes;
pub(crate) mod attributes;
mod boundary;
mod boxes;
mod bridges;
mod caps;
mod coarsen;
mod constrained;
mod contacts;
pub(crate) mod curvature;
mod curve;
mod cuts;
mod denoise;
mod divide;
mod edge_file;
mod edges;
mod error;
pub mod examples;
mod features;
mod fine;
pub(crate) mod girth;
mod given;
mod holes;
mod imprint;
pub mod load;
mod mend;
mod named_edges;
pub(crate) mod nearest;
mod parts;
mod persistence;
pub(crate) mod polygon;
pub(crate) mod records;
mod regions;
mod repairs;
mod ridges;
pub(crate) mod sampling;
mod seams;
mod sew;
mod split;
mod turning;
mod walk;
mod weld;

pub use attributes::{Attribute, AttributeKind, Attributes};
pub use boundary::{BoundaryError, KeptBoundary, NoKeptBoundary};
pub use contacts::{Contacts, NearRims};
pub use curve::Curve;
pub(crate) use curve::shared_curves;
pub use denoise::Denoised;
pub use edge_file::{EdgeFileError, Ends, NamedEdge, read_edges};
pub(crate) use error::short;
pub use error::{SurfaceError, shown};
pub use features::{DroppedEdge, FeatureOptions, Features, Reason};
pub(crate) use fine::Projected;
pub(crate) use given::Sheets;
pub use regions::Regions;
pub use repairs::{Length, LengthError, Places, RepairOptions, Repairs};
pub(crate) use walk::{WALK_EDGES, Walkable, next_corner, previous_corner, walk, walk_on};

use crate::geometry::{cross, dot, scattered, triangle_normal};
use crate::progress::{Progress, unwatched};
use crate::sets::Sets;
use adjacency::Adjacency;
use fine::Fine;
use given::Given;
use glam::{DVec3, Vec3};
use std::sync::Arc;
use weld::Welded;

/// No half-edge, triangle or vertex.
pub const NONE: u32 = u32::MAX;

/// Triangles as a file or a generator gives them: not welded, not oriented, in model units.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Soup {
    /// Corner positions, in model units.
    pub points: Vec<[f64; 3]>,
    /// Indices into `points`, three a triangle.
    pub triangles: Vec<[u32; 3]>,
    /// Which named part each triangle belongs to.
    pub regions: Regions,
    /// Colours, texture coordinates and other numbers of points or corners.
    pub attributes: Attributes,
}

impl Soup {
    /// Triangles of one region: points in model units, and three indices into them a triangle, counted from 0.
    pub fn new(points: Vec<[f64; 3]>, triangles: Vec<[u32; 3]>) -> Self {
        Self { points, triangles, ..Self::default() }
    }

    /// The same triangles with noise, as those of a scan have: each coordinate moves by up to `size`, by the same way each time.
    pub fn with_noise(mut self, size: f64) -> Self {
        for (number, x) in (0..).zip(self.points.as_flattened_mut()) {
            *x += size * f64::from(2.0 * scattered(number) - 1.0);
        }
        self
    }

    /// The area of the triangles whose corners are there, in model units squared.
    pub fn area(&self) -> f64 {
        let area = |&[a, b, c]: &[DVec3; 3]| (b - a).cross(c - a).length() / 2.0;
        let corner = |index: u32| self.points.get(index as usize).copied().map(DVec3::from);
        let corners = self.triangles.iter().filter_map(|&[a, b, c]| Some([corner(a)?, corner(b)?, corner(c)?]));
        corners.map(|corners| area(&corners)).sum()
    }
}

impl Soup {
    /// The step of f32 at the largest coordinate, in model units, where all coordinates are f32 and need it; `None` where they are
    /// finer, or multiples of larger steps, as whole numbers are.
    pub fn f32_step(&self) -> Option<f64> {
        let used = || self.triangles.iter().flatten().flat_map(|&v| self.points[v as usize]);
        let step = f64::from(weld::single_step(used())?);
        let largest = used().map(f64::abs).fold(0.0, f64::max);
        let large: Vec<f64> = used().filter(|x| x.abs() > largest / 2.0).collect();
        let odd = large.iter().filter(|&x| (x / step).rem_euclid(2.0) == 1.0).count();
        (odd > large.len() / ODD).then_some(step)
    }
}

/// Of coordinates that are rounded to a step, half are odd multiples; one in so many is enough.
const ODD: usize = 8;

/// The map between model units and the unit-sized coordinates that the mesher computes in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Centre of the model's bounding box, in model units.
    pub centre: [f64; 3],
    /// Diagonal of the model's bounding box, in model units.
    pub diagonal: f64,
}

impl Frame {
    /// The frame of a bounding box, which has an extent.
    pub(crate) fn of_box(low: DVec3, high: DVec3) -> Self {
        // Scaled first, so that squares of very small extents do not underflow.
        let extent = high - low;
        let largest = extent.max_element();
        Self { centre: (low + extent / 2.0).into(), diagonal: largest * (extent / largest).length() }
    }

    /// From model units to unit-sized coordinates.
    pub fn to_unit(&self, point: [f64; 3]) -> [f64; 3] {
        ((DVec3::from(point) - DVec3::from(self.centre)) / self.diagonal).into()
    }

    /// As [`Frame::to_model`], rounded to about a millionth of the diagonal, the precision of a place.
    pub(crate) fn near(&self, point: [f64; 3]) -> [f64; 3] {
        let step = 10f64.powf(self.diagonal.log10().floor() - 6.0);
        self.to_model(point).map(|x| if step > 0.0 { (x / step).round() * step } else { x })
    }

    /// From unit-sized coordinates to model units.
    pub fn to_model(&self, point: [f64; 3]) -> [f64; 3] {
        (DVec3::from(point) * self.diagonal + DVec3::from(self.centre)).into()
    }
}

/// A welded, consistently oriented triangle surface, each sheet of it a manifold, with adjacency and features, in unit-sized coordinates.
///
/// Half-edge `3 t + k` runs from corner `k` of triangle `t` to corner `k + 1`.
#[derive(Clone, Debug)]
pub struct Surface {
    pub(crate) points: Vec<Vec3>,
    pub(crate) triangles: Vec<[u32; 3]>,
    /// The opposite half-edge of each half-edge; [`NONE`] on the boundary.
    pub(crate) twins: Vec<u32>,
    /// The half-edges that are features whatever their angle, sorted: where sheets or solids meet, ridges.
    named: Vec<u32>,
    /// The vertices of a boundary that the mesh keeps, sorted; none where it keeps none.
    kept: Vec<u32>,
    /// The first of the vertices at the place of each vertex: there are several where sheets meet or fans touch.
    same_place: Vec<u32>,
    regions: Regions,
    features: Features,
    /// The edges of the creases that are no features.
    dropped: Vec<DroppedEdge>,
    denoised: Option<Denoised>,
    given: Given,
    /// The triangles as they were given; `None` where neither noise was smoothed nor they were coarsened.
    as_given: Option<Arc<Sheets>>,
    /// The surface before it was coarsened; `None` where it was not.
    fine: Option<Arc<Fine>>,
    undivided: Undivided,
    frame: Frame,
    repairs: Repairs,
    contacts: Contacts,
}

impl Surface {
    /// Welds, cleans and orients the soup and finds its features.
    ///
    /// # Errors
    /// Where nothing is left to mesh, or where triangles cannot be oriented alike.
    pub fn new(soup: &Soup, options: &FeatureOptions) -> Result<Self, SurfaceError> {
        Self::repaired(soup, options, &RepairOptions::default(), 0.0)
    }

    /// As [`Surface::new`], with repairs; `side`, the side of a tile in model units, is the unit of [`Length::Tiles`].
    ///
    /// # Errors
    /// As [`Surface::new`], and where a length of the repairs is none.
    pub fn repaired(
        soup: &Soup,
        options: &FeatureOptions,
        repairs: &RepairOptions,
        side: f64,
    ) -> Result<Self, SurfaceError> {
        Self::repaired_watched(soup, options, repairs, side, &Progress::new(&unwatched))
    }

    /// As [`Surface::repaired`]; cancelled, it is an error.
    pub(crate) fn repaired_watched(
        soup: &Soup,
        options: &FeatureOptions,
        repairs: &RepairOptions,
        side: f64,
        progress: &Progress,
    ) -> Result<Self, SurfaceError> {
        let Welded { frame, points, mut triangles, sources, mut repairs } =
            mend::mended(soup, repairs, side, progress)?;
        let mut points: Vec<Vec3> = points.iter().map(|&p| on_grid(p)).collect();
        let Adjacency { mut twins, seams: mut named, same_place } =
            adjacency::orient(&mut points, &mut triangles, &frame, &mut repairs, progress)?;
        progress.check()?;
        if options.texture_seams {
            named.extend(seams::seams(soup, &sources, &triangles, &twins, &points, &frame));
            named.sort_unstable();
            named.dedup();
        }
        let regions = soup.regions.of(&sources);
        let given = Given::new(soup, &sources, &triangles, &points, &frame);
        progress.check()?;
        caps::flip(&points, &mut triangles, &mut twins, &named, &frame, &mut repairs);
        progress.check()?;
        let features = Features::default();
        let mut surface = Self {
            points,
            triangles,
            twins,
            named,
            kept: Vec::new(),
            same_place,
            regions,
            features,
            dropped: Vec::new(),
            denoised: None,
            given,
            as_given: None,
            fine: None,
            undivided: Undivided::default(),
            frame,
            repairs,
            contacts: Contacts::default(),
        };
        if options.region_borders {
            surface.name(surface.region_borders());
        }
        surface.features = Features::find(&surface, options);
        surface.undivided = Undivided { triangles: surface.triangle_count(), vertices: surface.vertex_count() };
        Ok(surface)
    }

    /// The same surface after a search for contacts; `side` is that of a tile, unit-sized.
    pub fn with_contacts(self, side: f64) -> Self {
        self.with_contacts_watched(side, &Progress::new(&unwatched))
    }

    /// As [`Surface::with_contacts`]; cancelled, it finds none.
    pub(crate) fn with_contacts_watched(mut self, side: f64, progress: &Progress) -> Self {
        self.contacts = contacts::contacts(&self, side, &|| progress.is_cancelled());
        self
    }

    /// The same surface with these edges as features; `soup` is what it was made of.
    ///
    /// # Errors
    /// Where an edge is none of the surface's.
    pub fn with_edges(
        mut self,
        soup: &Soup,
        edges: &[NamedEdge],
        options: &FeatureOptions,
    ) -> Result<Self, SurfaceError> {
        if !edges.is_empty() {
            self.name(named_edges::find(&self, soup, edges)?);
            self.features = Features::find(&self, options);
        }
        Ok(self)
    }

    /// The same surface with the features for tiles of side `h`, unit-sized: noise is smoothed, creases that do not persist are
    /// dropped, turns that a curve takes back within a tile are no corners, and ridges become edges.
    pub fn fitted(self, options: &FeatureOptions, h: f32) -> Self {
        self.fitted_to(options, h, None, &Progress::new(&unwatched))
    }

    /// As [`Surface::fitted`], with creases that persist for tiles of `sides`, unit-sized, at the vertices, where these are given.
    /// Cancelled, it leaves out what is left to do.
    pub(crate) fn fitted_to(
        mut self,
        options: &FeatureOptions,
        h: f32,
        sides: Option<&[f64]>,
        progress: &Progress,
    ) -> Self {
        // Creases tell noise also where none is to be a feature.
        let telling = if options.crease < 180.0 {
            *options
        } else {
            FeatureOptions { crease: FeatureOptions::default().crease, every_crease: false, ..*options }
        };
        if telling != *options {
            self.features = Features::find(&self, &telling);
        }
        self.drop_creases(&telling, f64::from(h), sides, progress);
        let before = self.points.clone();
        for _ in 0..denoise::MOST_ROUNDS {
            if telling.every_crease || progress.is_cancelled() || !denoise::is_noisy(&self, &self.dropped, f64::from(h))
            {
                break;
            }
            self.points = denoise::smoothed(&self, f64::from(h));
            self.denoised = Some(Denoised::of(&before, &self));
            self.features = Features::find(&self, &telling);
            self.drop_creases(&telling, f64::from(h), sides, progress);
        }
        if telling != *options {
            self.features = Features::find(&self, options);
            self.drop_creases(options, f64::from(h), sides, progress);
        }
        if progress.is_cancelled() {
            return self;
        }
        self.given.follow(&before, &self.points, &self.frame);
        if let Some(denoised) = self.denoised {
            let off = denoised.largest / self.frame.diagonal;
            self.as_given = Some(Arc::new(Sheets { points: before, triangles: self.triangles.clone(), off }));
        }
        self.features.apexes = apexes::apexes(&self, f64::from(h), &|| progress.is_cancelled());
        if progress.is_cancelled() {
            return self;
        }
        self.features = Features::along(&self, self.features.marked(), options.corner, f64::from(h));
        if options.ridge < 180.0 && !progress.is_cancelled() {
            let lines = ridges::ridges(&self, f64::from(h), options.ridge, &|| progress.is_cancelled());
            if !lines.is_empty() {
                let split = split::Split::along(&self, &lines);
                let places = self.points.len() as u32..split.points.len() as u32;
                self.replace(split, places, options);
            }
        }
        self
    }

    /// Drops the creases that do not persist for tiles of a side, unit-sized, and bridges gaps between the others.
    fn drop_creases(&mut self, options: &FeatureOptions, side: f64, sides: Option<&[f64]>, progress: &Progress) {
        self.dropped.clear();
        let mut marked = self.features.marked();
        for is_last in [false, true] {
            if progress.is_cancelled() {
                return;
            }
            self.features = Features::along(self, marked, options.corner, side);
            if progress.is_cancelled() {
                return;
            }
            let persistent = persistence::persistent(self, options, side, sides);
            let known = self.dropped.iter().map(|edge| edge.crease + 1).max().unwrap_or(0);
            let dropped = persistent.dropped.into_iter();
            self.dropped.extend(dropped.map(|edge| DroppedEdge { crease: known + edge.crease, ..edge }));
            marked = persistent.marked;
            if progress.is_cancelled() {
                return;
            }
            self.features = Features::along(self, marked.clone(), options.corner, side);
            if is_last || options.every_crease || progress.is_cancelled() {
                break;
            }
            for h in bridges::bridges(self, side) {
                marked[h as usize] = true;
                marked[self.twins[h as usize] as usize] = true;
            }
            // A bridge may lead over an edge that was dropped.
            self.dropped.retain(|edge| !marked[edge.half_edge as usize]);
        }
    }

    /// The half-edges between triangles of different regions.
    fn region_borders(&self) -> Vec<u32> {
        let of = &self.regions.of_face;
        let differ = |&h: &u32| self.twin(h).is_some_and(|twin| of[h as usize / 3] != of[twin as usize / 3]);
        if of.is_empty() { Vec::new() } else { (0..3 * self.triangle_count() as u32).filter(differ).collect() }
    }

    /// Makes half-edges features whatever their angle.
    fn name(&mut self, half_edges: impl IntoIterator<Item = u32>) {
        self.named.extend(half_edges);
        self.named.sort_unstable();
        self.named.dedup();
    }

    /// The map from model units.
    pub fn frame(&self) -> &Frame {
        &self.frame
    }

    /// The named regions of the triangles.
    pub fn regions(&self) -> &Regions {
        &self.regions
    }

    /// The repairs that were made.
    pub fn repairs(&self) -> &Repairs {
        &self.repairs
    }

    /// Places where sheets touch or cross each other without being joined, as [`Surface::with_contacts`] found them.
    pub fn contacts(&self) -> &Contacts {
        &self.contacts
    }

    /// Feature edges, curves and corners.
    pub fn features(&self) -> &Features {
        &self.features
    }

    /// The edges of the creases that are no features, as they do not persist at the scale of a tile.
    pub fn dropped_edges(&self) -> &[DroppedEdge] {
        &self.dropped
    }

    /// The triangles as they were given; `None` where they are those of this surface, perhaps divided.
    pub(crate) fn as_given(&self) -> Option<&Sheets> {
        self.as_given.as_deref()
    }

    /// How far the points of a noisy surface moved when it was smoothed; `None` where it is not noisy.
    pub fn denoised(&self) -> Option<Denoised> {
        self.denoised
    }

    /// The numbers of triangles and vertices before triangles were divided.
    pub fn undivided(&self) -> Undivided {
        self.undivided
    }

    /// The number of triangles.
    pub fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// The number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.points.len()
    }

    /// The place of a vertex, in unit-sized coordinates.
    pub fn point(&self, vertex: u32) -> [f64; 3] {
        self.points[vertex as usize].as_dvec3().into()
    }

    /// The area, in unit-sized coordinates.
    pub fn area(&self) -> f64 {
        (0..self.triangles.len()).map(|t| f64::from(self.double_area(t)) / 2.0).sum()
    }

    /// For each vertex the area of the connected part that it belongs to, in unit-sized coordinates.
    pub(crate) fn areas_of_parts(&self) -> Vec<f64> {
        let mut parts = Sets::new(self.points.len());
        for &[a, b, c] in &self.triangles {
            parts.join(a, b);
            parts.join(b, c);
        }
        let mut areas = vec![0.0; self.points.len()];
        for (t, corners) in self.triangles.iter().enumerate() {
            areas[parts.root(corners[0]) as usize] += f64::from(self.double_area(t)) / 2.0;
        }
        (0..self.points.len() as u32).map(|v| areas[parts.root(v) as usize]).collect()
    }

    /// The length of all open boundaries, in unit-sized coordinates.
    pub fn boundary_length(&self) -> f64 {
        (0..self.twins.len() as u32).filter(|&h| self.twins[h as usize] == NONE).map(|h| self.length(h)).sum()
    }

    pub(crate) fn double_area(&self, triangle: usize) -> f32 {
        let [a, b, c] = self.corners(triangle);
        let n = cross(b - a, c - a);
        dot(n, n).sqrt()
    }

    pub(crate) fn corners(&self, triangle: usize) -> [Vec3; 3] {
        self.triangles[triangle].map(|v| self.points[v as usize])
    }

    /// The unit normal of a triangle.
    pub(crate) fn normal(&self, triangle: usize) -> Vec3 {
        triangle_normal(self.corners(triangle))
    }

    /// Whether a half-edge is a feature whatever its angle.
    pub(crate) fn is_named(&self, half_edge: u32) -> bool {
        self.named.binary_search(&half_edge).is_ok()
    }

    /// The first of the vertices at the place of this one: itself, but where sheets meet or fans touch.
    pub(crate) fn same_place(&self, vertex: u32) -> u32 {
        self.same_place[vertex as usize]
    }

    /// Whether each vertex shares its place with others, where sheets meet or fans touch.
    pub(crate) fn shared_places(&self) -> Vec<bool> {
        let mut count = vec![0; self.points.len()];
        self.same_place.iter().for_each(|&first| count[first as usize] += 1);
        self.same_place.iter().map(|&first| count[first as usize] > 1).collect()
    }

    pub(crate) fn origin(&self, half_edge: u32) -> u32 {
        self.triangles[half_edge as usize / 3][half_edge as usize % 3]
    }

    pub(crate) fn target(&self, half_edge: u32) -> u32 {
        self.origin(next(half_edge))
    }

    pub(crate) fn twin(&self, half_edge: u32) -> Option<u32> {
        Some(self.twins[half_edge as usize]).filter(|&twin| twin != NONE)
    }

    /// The length of a half-edge, in f64.
    pub(crate) fn length(&self, half_edge: u32) -> f64 {
        let [a, b] = [self.origin(half_edge), self.target(half_edge)].map(|v| self.points[v as usize].as_dvec3());
        a.distance(b)
    }
}

/// The nearest point whose coordinates are multiples of 2^-24, the resolution of f32 at the rim of the bounding box. With a finer
/// middle, the mesh of a model would depend on its distance from the origin.
fn on_grid(p: DVec3) -> Vec3 {
    const STEPS: f64 = (1 << 24) as f64;
    ((p * STEPS).round() / STEPS).as_vec3()
}

/// The numbers of triangles and vertices of a surface after repairs, before triangles were divided along ridges and where they
/// are long.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Undivided {
    /// Triangles.
    pub triangles: usize,
    /// Vertices.
    pub vertices: usize,
}

/// A point of a surface: its triangle, and its place in unit-sized coordinates.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SurfacePoint {
    pub triangle: u32,
    pub position: Vec3,
}

/// The half-edge after this one in its triangle.
pub(crate) fn next(half_edge: u32) -> u32 {
    if half_edge % 3 == 2 { half_edge - 2 } else { half_edge + 1 }
}

/// The half-edge before this one in its triangle.
pub(crate) fn previous(half_edge: u32) -> u32 {
    if half_edge.is_multiple_of(3) { half_edge + 2 } else { half_edge - 1 }
}
