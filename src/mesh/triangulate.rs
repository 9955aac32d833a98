//! A triangulation of the surface whose vertices are the tiles' centres.
//!
//! # Theory
//! The triangulation begins as the surface's own triangles. The tiles are inserted as vertices, the surface's vertices are
//! removed one after the other, and edges are flipped until they are intrinsically Delaunay. Each step keeps the topology, so
//! the result is a manifold with the Euler characteristic and the boundaries of the surface. No step uses distances in space,
//! so the two sides of a thin part stay apart.
//!
//! # Changes versus the paper
//! The paper (section 2) searches the eight nearest tiles with similar normals. This loses neighbours, or finds false ones,
//! where the surface turns sharply within a tile or folds back on itself. Here the neighbours are those of this
//! triangulation.
//!
//! # Practice
//! A handle or a gap smaller than a tile needs vertices of the surface. These stay as vertices of the mesh;
//! [`Triangulation::extra`] counts them. Ask for more tiles where there are many.

use super::Metric;
use super::incidence::undirected;
use super::intrinsic::Intrinsic;
use super::surface_mesh::SurfaceMesh;
use super::vertex::{Place, REGULAR, Vertex};
use crate::field::Field;
use crate::geometry::cross;
use crate::mosaic::anisotropic::factors;
use crate::mosaic::{FeaturePoint, Mosaic, Tile};
use crate::parametrize::{Cone, GridMetric, PlacedCone};
use crate::surface::{NONE, Surface, shared_curves};
use glam::{DVec3, Vec3};
use rustc_hash::FxHashMap;
use std::f64::consts::{PI, TAU};

/// The least barycentric coordinate of a tile in its triangle of the surface: tiles keep off the edges.
const INSET: f64 = 1e-5;

/// The tiles' centres, triangulated.
#[derive(Clone, Debug)]
pub struct Triangulation {
    pub(crate) faces: Intrinsic,
    /// The tile of each vertex; of a tile on a feature, its first side.
    pub tiles: Vec<Tile>,
    /// The side of each tile in the metric of the triangulation; 1 in the metric of the integer grid.
    pub(crate) sides: Vec<f64>,
    /// Where on the surface each vertex is.
    pub(crate) vertices: Vec<Vertex>,
    /// The number of tiles on features: the first vertices.
    pub feature_samples: usize,
    /// The number of vertices of the surface that its topology needs: the last vertices.
    pub extra: usize,
    /// See [`Mosaic::factor`]; empty where tiles are squares.
    pub(crate) factors: Vec<f32>,
    /// For each vertex, the first vertex at the same point. Several vertices share a point where sheets of the surface meet.
    pub(crate) same_place: Vec<u32>,
}

/// Triangulates the tiles of a mosaic.
pub fn triangulate(surface: &Surface, field: &Field, mosaic: &Mosaic) -> Triangulation {
    triangulate_while(surface, field, mosaic, &|| true).unwrap_or_else(|| unreachable!("it goes on"))
}

/// As [`triangulate`], as long as `goes_on`; `None` where it does not.
pub(crate) fn triangulate_while(
    surface: &Surface,
    field: &Field,
    mosaic: &Mosaic,
    goes_on: &dyn Fn() -> bool,
) -> Option<Triangulation> {
    let mut builder = TriangulationBuilder::new(surface, field, mosaic.metric.as_ref());
    let cones = builder.insert_cones();
    let samples = builder.insert_feature_samples(surface, mosaic);
    builder.release_ends(mosaic, &samples);
    let free = builder.insert_free_tiles(surface, mosaic, &cones, goes_on)?;
    let mut is_tile = vec![false; builder.faces.leaving.len()];
    samples.iter().chain(&free).for_each(|&vertex| is_tile[vertex as usize] = true);
    let extra = builder.remove_surface_vertices(&is_tile, surface.keeps_boundary(), goes_on)?;
    let order: Vec<u32> = samples.iter().chain(&free).chain(&extra).copied().collect();
    let mut tiles: Vec<Tile> =
        mosaic.feature_samples.iter().map(|sample| mosaic.tiles[sample.first_side as usize]).collect();
    tiles.extend_from_slice(mosaic.free());
    tiles.extend(extra.iter().map(|&v| {
        let point = builder.points[v as usize].as_vec3();
        Tile::free(surface, field, builder.triangles[v as usize], point, mosaic.scale)
    }));
    let sides = tiles.iter().map(|tile| if mosaic.metric.is_some() { 1.0 } else { f64::from(tile.h) }).collect();
    let faces = builder.faces.compacted(&order);
    let mut same_place: Vec<u32> = (0..order.len() as u32).collect();
    for (v, sample) in mosaic.feature_samples.iter().enumerate() {
        same_place[v] = sample.same_place;
    }
    let factors = factors(surface, field, &tiles);
    let locations = FeatureLocations::new(surface);
    let vertex = |(v, tile): (usize, &Tile)| {
        let (place, triangles) = match mosaic.feature_samples.get(v) {
            Some(sample) => locations.of(sample.point, mosaic.sides_of(v)),
            None if v < order.len() - extra.len() => (Place::Free, [tile.triangle; 2]),
            None => (Place::Corner, [NONE; 2]),
        };
        Vertex {
            // Each sheet divides a shared curve by itself; all take the point of the first.
            point: builder.points[order[same_place[v] as usize] as usize],
            place,
            triangles,
            normal: tile.normal().as_dvec3(),
            axis: Vec3::from(tile.axis).as_dvec3(),
            valence: REGULAR,
            is_kept: mosaic.feature_samples.get(v).is_some_and(|sample| is_kept(surface, sample.point)),
            origin: v as u32,
        }
    };
    let vertices = tiles.iter().enumerate().map(vertex).collect();
    let (feature_samples, extra) = (samples.len(), extra.len());
    Some(Triangulation { faces, tiles, sides, vertices, factors, feature_samples, extra, same_place })
}

/// Whether a sample is a vertex of a boundary that the mesh keeps.
fn is_kept(surface: &Surface, point: FeaturePoint) -> bool {
    matches!(point, FeaturePoint::Vertex(v) if surface.is_kept(v))
}

/// The locations of half-edges and vertices on the feature curves of a surface.
struct FeatureLocations<'a> {
    surface: &'a Surface,
    /// Whether several sheets share each curve.
    shared: Vec<bool>,
    /// The curve and the segment of each half-edge on a feature.
    segments: FxHashMap<u32, (u32, usize)>,
    /// The curve through each vertex on a feature, and the vertex's index on it.
    vertices: FxHashMap<u32, (u32, usize)>,
}

impl<'a> FeatureLocations<'a> {
    fn new(surface: &'a Surface) -> Self {
        let (mut segments, mut vertices) = (FxHashMap::default(), FxHashMap::default());
        for (id, curve) in (0..).zip(surface.features().curves()) {
            for (k, &h) in curve.half_edges.iter().enumerate() {
                for h in [Some(h), surface.twin(h)].into_iter().flatten() {
                    segments.insert(h, (id, k));
                }
            }
            curve.vertices.iter().enumerate().for_each(|(k, &v)| {
                vertices.insert(v, (id, k));
            });
        }
        Self { surface, shared: shared_curves(surface), segments, vertices }
    }

    /// The place of a tile on a feature, and the triangles on its two sides; `sides` are its copies on these sides.
    fn of(&self, point: FeaturePoint, sides: &[Tile]) -> (Place, [u32; 2]) {
        let triangles = match *sides {
            [one] => [one.triangle; 2],
            [one, other] => [one.triangle, other.triangle],
            _ => [NONE; 2],
        };
        let curves = self.surface.features().curves();
        let place = match point {
            FeaturePoint::Edge(h, share) => self.segments.get(&h).map(|&(curve, k)| {
                let s = curves[curve as usize].arc(self.surface, k, h, share);
                (curve, s)
            }),
            FeaturePoint::Vertex(v) if self.surface.features().is_corner(v) => None,
            FeaturePoint::Vertex(v) => self.vertices.get(&v).map(|&(curve, k)| (curve, curves[curve as usize].arcs[k])),
        };
        let place = place.filter(|(curve, _)| !self.shared[*curve as usize]);
        (place.map_or(Place::Corner, |(curve, s)| Place::OnCurve { curve, s }), triangles)
    }
}

impl Triangulation {
    /// The mesh of these faces; its vertices are those of the triangulation.
    pub(crate) fn surface_mesh(&self, faces: &[Vec<u32>]) -> SurfaceMesh {
        let half_edges = (0..self.faces.origin.len() as u32).filter(|&h| self.faces.is_feature(h));
        let edge = |h: u32| [self.faces.origin[h as usize], self.faces.target(h)];
        let features = half_edges.map(|h| (undirected(edge(h)), self.faces.curve[h as usize])).collect();
        let metric = Metric::new(&self.vertices, &self.factors);
        SurfaceMesh::new(self.vertices.clone(), faces, features, metric)
    }

    /// For each vertex of a mesh, the first vertex at the same point. `origins` names the vertex of the triangulation that each
    /// vertex is, [`NONE`] for a vertex that an edit has added.
    pub fn joints(&self, origins: impl Iterator<Item = u32>) -> Vec<u32> {
        let mut first = vec![NONE; self.same_place.len()];
        (0..)
            .zip(origins)
            .map(|(v, old)| {
                let Some(&place) = self.same_place.get(old as usize) else { return v };
                let first = &mut first[place as usize];
                *first = v.min(*first);
                *first
            })
            .collect()
    }

    /// The ends of the edges, each edge once.
    pub(crate) fn edges(&self) -> impl Iterator<Item = [u32; 2]> {
        let faces = &self.faces;
        let is_first = move |&h: &u32| faces.twin[h as usize] == NONE || h < faces.twin[h as usize];
        (0..faces.origin.len() as u32).filter(is_first).map(move |h| [faces.origin[h as usize], faces.target(h)])
    }
}

/// A triangulation while vertices are inserted and removed.
struct TriangulationBuilder<'a> {
    /// The metric of the integer grid, where the mosaic has one.
    grid: Option<&'a GridMetric>,
    faces: Intrinsic,
    /// The triangle of the surface that each face lies in, while no edge of the surface has been flipped.
    triangle_of_face: Vec<u32>,
    points: Vec<DVec3>,
    /// A triangle of the surface at each vertex.
    triangles: Vec<u32>,
}

impl<'a> TriangulationBuilder<'a> {
    fn new(surface: &Surface, field: &Field, grid: Option<&'a GridMetric>) -> Self {
        let sectors = field.sectors();
        let count = 3 * surface.triangle_count();
        let mut faces = Intrinsic {
            origin: surface.triangles.iter().flatten().copied().collect(),
            twin: surface.twins.clone(),
            length: (0..count as u32).map(|h| grid.map_or_else(|| surface.length(h), |c| c.length(h))).collect(),
            curve: vec![NONE; count],
            begin: Vec::with_capacity(count),
            end: Vec::with_capacity(count),
            leaving: vec![NONE; surface.vertex_count()],
        };
        for (id, curve) in (0..).zip(surface.features().curves()) {
            for h in curve.half_edges.iter().flat_map(|&h| [Some(h), surface.twin(h)]).flatten() {
                faces.curve[h as usize] = id;
            }
        }
        for h in 0..count as u32 {
            let sector = sectors.of_corner[h as usize] as usize;
            // On a feature directions count from the feature, elsewhere from the cross.
            let zero = if sectors.quarters[sector] > 0 {
                0.0
            } else {
                let [x, y] = field.crosses()[sector].map(f64::from);
                y.atan2(x) / 4.0
            };
            faces.begin.push(sectors.direction(h, 0.0) - zero);
            faces.end.push(sectors.direction(h, sectors.corner_angle(h)) - zero);
            faces.leaving[faces.origin[h as usize] as usize] = h;
        }
        if let Some(grid) = grid {
            set_grid_directions(&mut faces, surface, field, grid);
        }
        Self {
            grid,
            triangle_of_face: (0..surface.triangle_count() as u32).collect(),
            points: surface.points.iter().map(|p| p.as_dvec3()).collect(),
            triangles: faces.leaving.iter().map(|&corner| corner / 3).collect(),
            faces,
        }
    }

    /// Inserts the cones into the triangles that hold them; returns their vertices.
    fn insert_cones(&mut self) -> Vec<u32> {
        let Some(grid) = self.grid else { return Vec::new() };
        let insert = |placed: &PlacedCone| {
            let Cone { triangle, from_corners } = placed.cone;
            let h = [0, 1, 2].map(|k| 3 * triangle as usize + k);
            // The angle of each side at the cone, in the frame of the corner where the side begins.
            let turns = [0, 1, 2].map(|k| {
                let ([u, v], [x, y]) = (from_corners[k], grid.steps[h[k]]);
                let (from, to) = ([-u, -v], [x - u, y - v]);
                (from[0] * to[1] - from[1] * to[0]).atan2(from[0] * to[0] + from[1] * to[1]).abs()
            });
            let first = (-from_corners[0][1]).atan2(-from_corners[0][0]);
            let directions = [first, first + turns[0], first + turns[0] + turns[1]];
            let vertex = self.faces.split_face(triangle, from_corners.map(|[u, v]| u.hypot(v)), directions);
            let last = self.faces.leaving.len();
            debug_assert_eq!(vertex as usize + 1, last);
            let closing = 3 * (self.faces.face_count() - 1) + 2;
            self.faces.end[closing] = directions[2] + turns[2];
            self.triangle_of_face.extend([triangle; 2]);
            self.points.push(placed.position);
            self.triangles.push(triangle);
            vertex
        };
        grid.cones.iter().map(insert).collect()
    }

    /// Inserts the feature samples; returns their vertices.
    fn insert_feature_samples(&mut self, surface: &Surface, mosaic: &Mosaic) -> Vec<u32> {
        let mut vertices = vec![NONE; mosaic.feature_samples.len()];
        let mut on_edges: Vec<(u32, f64, usize)> = Vec::new();
        for (i, sample) in mosaic.feature_samples.iter().enumerate() {
            match sample.point {
                FeaturePoint::Vertex(v) => vertices[i] = v,
                FeaturePoint::Edge(h, share) => on_edges.push((h, share, i)),
            }
        }
        let mut ring = Vec::new();
        on_edges.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        for run in on_edges.chunk_by(|a, b| a.0 == b.0) {
            let ends = [surface.origin(run[0].0), surface.target(run[0].0)];
            let [a, b] = ends.map(|v| surface.points[v as usize].as_dvec3());
            // A split of another edge of the triangle may have given this edge another half-edge.
            self.faces.ring(ends[0], &mut ring);
            let whole = ring.iter().copied().find(|&h| self.faces.target(h) == ends[1]);
            let mut h = whole.expect("an edge that is not split joins its ends");
            let mut passed = 0.0;
            for &(_, share, i) in run {
                let part = ((share - passed) / (1.0 - passed)).clamp(1e-6, 1.0 - 1e-6);
                let twin = self.faces.twin[h as usize];
                vertices[i] = self.faces.split_edge(h, part);
                self.triangle_of_face.push(self.triangle_of_face[h as usize / 3]);
                if twin != NONE {
                    self.triangle_of_face.push(self.triangle_of_face[twin as usize / 3]);
                }
                self.points.push(a + (b - a) * share);
                self.triangles.push(run[0].0 / 3);
                h = self.faces.leaving[vertices[i] as usize];
                passed = share;
            }
        }
        vertices
    }

    /// Releases the parts of features beyond their last samples: their edges may be flipped.
    fn release_ends(&mut self, mosaic: &Mosaic, samples: &[u32]) {
        let mut is_sample = vec![false; self.faces.leaving.len()];
        samples.iter().for_each(|&vertex| is_sample[vertex as usize] = true);
        let mut ring = Vec::new();
        let mut ends: Vec<u32> = mosaic.curve_parameters.released_ends.iter().copied().collect();
        ends.sort_unstable();
        for end in ends {
            let mut vertex = end;
            while !is_sample[vertex as usize] {
                self.faces.ring(vertex, &mut ring);
                let Some(&h) = ring.iter().find(|&&h| self.faces.is_feature(h)) else { break };
                let twin = self.faces.twin[h as usize];
                [h, twin].into_iter().filter(|&h| h != NONE).for_each(|h| self.faces.curve[h as usize] = NONE);
                vertex = self.faces.target(h);
            }
        }
    }

    /// Inserts the tiles off features; returns their vertices.
    fn insert_free_tiles(
        &mut self,
        surface: &Surface,
        mosaic: &Mosaic,
        cones: &[u32],
        goes_on: &dyn Fn() -> bool,
    ) -> Option<Vec<u32>> {
        let tiles = mosaic.free();
        let mut vertices = vec![NONE; tiles.len()];
        if let Some(grid) = self.grid {
            // Tiles on cones are the first.
            let placed = cones.iter().zip(&grid.cones).filter(|(_, placed)| placed.is_tile);
            vertices.iter_mut().zip(placed).for_each(|(vertex, (&cone, _))| *vertex = cone);
        }
        let mut order: Vec<u32> = (0..tiles.len() as u32).filter(|&i| vertices[i as usize] == NONE).collect();
        order.sort_by_key(|&i| tiles[i as usize].triangle);
        // A walk towards a point ends in a Delaunay triangulation.
        let mut stack: Vec<u32> = (0..self.faces.origin.len() as u32).collect();
        self.legalize_within(surface, &mut stack);
        let mut face = 0;
        let mut triangle = NONE;
        for i in order {
            if !goes_on() {
                return None;
            }
            let tile = &tiles[i as usize];
            if tile.triangle != triangle {
                triangle = tile.triangle;
                face = triangle;
            }
            let corners = surface.corners(triangle as usize).map(|p| p.as_dvec3());
            let point = inset(corners, tile.at().as_dvec3());
            let normal = tile.normal().as_dvec3();
            face = self.locate(face, point, normal);
            let origins = [0, 1, 2].map(|k| self.faces.origin[3 * face as usize + k]);
            let offsets = origins.map(|v| self.points[v as usize] - point);
            let x = Vec3::from(tile.axis);
            let (x, y) = match self.grid {
                Some(grid) => grid.gradients(surface, triangle, point).into(),
                None => (x.as_dvec3(), cross(tile.normal(), x).as_dvec3()),
            };
            let offsets = offsets.map(|offset| [offset.dot(x), offset.dot(y)]);
            let (lengths, directions) = (offsets.map(|[u, v]| u.hypot(v)), offsets.map(|[u, v]| v.atan2(u)));
            let vertex = self.faces.split_face(face, lengths, directions);
            self.points.push(point);
            self.triangles.push(triangle);
            vertices[i as usize] = vertex;
            self.triangle_of_face.extend([triangle; 2]);
            let new = self.faces.leaving[vertex as usize];
            self.faces.ring(vertex, &mut stack);
            let mut sides: Vec<u32> = stack.iter().map(|&h| super::intrinsic::next(h)).collect();
            self.legalize_within(surface, &mut sides);
            face = new / 3;
        }
        Some(vertices)
    }

    /// Flips edges until they are Delaunay, but for edges of the surface.
    ///
    /// Lengths inside a triangle of the surface follow from the points: lengths of flips would lose their digits in the slivers
    /// beside its edges.
    fn legalize_within(&mut self, surface: &Surface, stack: &mut Vec<u32>) {
        let (triangle_of_face, points, grid) = (&self.triangle_of_face, &self.points, self.grid);
        self.faces.legalize(
            stack,
            |faces, h| triangle_of_face[h as usize / 3] == triangle_of_face[faces.twin[h as usize] as usize / 3],
            |a, b, f, length| match grid {
                Some(grid) => {
                    let [a, b] = [a, b].map(|v| points[v as usize]);
                    let parts = grid.pieces(surface, triangle_of_face[f as usize]);
                    // Coordinates are not linear across the parts of a triangle with a cone.
                    if parts.len() > 1 {
                        return length;
                    }
                    let [u, v] =
                        grid.gradients(surface, triangle_of_face[f as usize], (a + b) / 2.0).map(|g| g.dot(b - a));
                    u.hypot(v)
                }
                None => points[a as usize].distance(points[b as usize]),
            },
        );
    }

    /// The face that holds a point, of those in the same triangle of the surface.
    fn locate(&self, from: u32, point: DVec3, normal: DVec3) -> u32 {
        let mut face = from;
        let mut entered = NONE;
        for _ in 0..self.faces.face_count() {
            let outside = (3 * face..3 * face + 3).filter(|&h| h != entered).find(|&h| {
                let [a, b] = [self.faces.origin[h as usize], self.faces.target(h)].map(|v| self.points[v as usize]);
                let twin = self.faces.twin[h as usize];
                (b - a).cross(point - a).dot(normal) < 0.0
                    && twin != NONE
                    && self.triangle_of_face[twin as usize / 3] == self.triangle_of_face[face as usize]
            });
            let Some(h) = outside else { break };
            entered = self.faces.twin[h as usize];
            face = entered / 3;
        }
        face
    }

    /// Removes the vertices that are no tiles; returns those that the topology needs. Those of a boundary that is kept go last, if need
    /// be by flips of faces that lie as no convex quads.
    fn remove_surface_vertices(
        &mut self,
        is_tile: &[bool],
        keeps_boundary: bool,
        goes_on: &dyn Fn() -> bool,
    ) -> Option<Vec<u32>> {
        let faces = &mut self.faces;
        let mut stack: Vec<u32> = (0..faces.origin.len() as u32).collect();
        faces.legalize(&mut stack, |_, _| true, |_, _, _, length| length);
        let mut waiting: Vec<u32> = (0..is_tile.len() as u32).filter(|&v| !is_tile[v as usize]).collect();
        let (mut ring, mut near) = (Vec::new(), Vec::new());
        let mut is_forced = false;
        loop {
            let before = waiting.len();
            waiting.retain(|&v| {
                if !goes_on() {
                    return true;
                }
                near.clear();
                faces.visit_neighbours(v, |w| near.push(w));
                let is_removed = match is_forced {
                    true => faces.remove_from_boundary(v, &mut ring),
                    false => faces.remove(v, &mut ring),
                };
                if !is_removed {
                    return true;
                }
                // The changed edges lie between the neighbours.
                for &w in &near {
                    faces.ring(w, &mut ring);
                    stack.extend(ring.iter().filter(|&&h| near.contains(&faces.target(h))));
                }
                faces.legalize(&mut stack, |_, _| true, |_, _, _, length| length);
                false
            });
            let is_stuck = waiting.len() == before;
            if waiting.is_empty() || is_stuck && (is_forced || !keeps_boundary) {
                return goes_on().then_some(waiting);
            }
            is_forced = is_stuck;
        }
    }
}

/// Sets the directions of corners to those of the integer grid, in the sectors where these keep the order of the triangles.
fn set_grid_directions(faces: &mut Intrinsic, surface: &Surface, field: &Field, grid: &GridMetric) {
    let sectors = field.sectors();
    let wrapped = |angle: f64| angle - (angle / TAU).round() * TAU;
    let corner = |h: u32| {
        let [begin, end] = grid.corner_directions(h);
        let begin = faces.begin[h as usize] + wrapped(begin - faces.begin[h as usize]);
        let end = faces.end[h as usize] + wrapped(end - faces.end[h as usize]);
        [begin, end]
    };
    let in_order: Vec<bool> = (0..sectors.count() as u32)
        .map(|sector| {
            sectors.corners(surface, sector).map(corner).all(|[begin, end]| (0.02..PI - 0.02).contains(&(end - begin)))
        })
        .collect();
    let corners: Vec<[f64; 2]> = (0..faces.begin.len() as u32).map(corner).collect();
    for (h, [begin, end]) in corners.into_iter().enumerate() {
        if in_order[sectors.of_corner[h] as usize] {
            (faces.begin[h], faces.end[h]) = (begin, end);
        }
    }
}

/// The point projected into a triangle, with barycentric coordinates of at least [`INSET`].
fn inset([a, b, c]: [DVec3; 3], p: DVec3) -> DVec3 {
    let normal = (b - a).cross(c - a);
    let area = normal.length_squared().max(f64::MIN_POSITIVE);
    let weight = |q: DVec3, r: DVec3| ((q - p).cross(r - p).dot(normal) / area).max(INSET);
    let (wa, wb, wc) = (weight(b, c), weight(c, a), weight(a, b));
    (a * wa + b * wb + c * wc) / (wa + wb + wc)
}

impl Intrinsic {
    /// The faces that are alive, with vertices numbered in the given order.
    fn compacted(&self, order: &[u32]) -> Self {
        let mut number = vec![NONE; self.leaving.len()];
        for (i, &v) in order.iter().enumerate() {
            number[v as usize] = i as u32;
        }
        let alive: Vec<u32> = (0..self.face_count() as u32).filter(|&f| self.is_alive(f)).collect();
        let mut place = vec![NONE; self.face_count()];
        for (i, &f) in alive.iter().enumerate() {
            place[f as usize] = i as u32;
        }
        let mut result = Self { leaving: vec![NONE; order.len()], ..Self::default() };
        for &f in &alive {
            let first = result.push_face([0, 1, 2].map(|k| number[self.origin[3 * f as usize + k] as usize]));
            for k in 0..3 {
                let (from, to) = (3 * f as usize + k, first as usize + k);
                let twin = self.twin[from];
                result.twin[to] = if twin == NONE { NONE } else { 3 * place[twin as usize / 3] + twin % 3 };
                result.length[to] = self.length[from];
                result.begin[to] = self.begin[from];
                result.end[to] = self.end[from];
                result.curve[to] = self.curve[from];
                result.leaving[result.origin[to] as usize] = to as u32;
            }
        }
        result
    }
}
