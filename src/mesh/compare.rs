//! The comparison of a mesh with the surface that it approximates.
//!
//! # Theory
//! The topologies are compared by their Euler characteristics, boundary loops and components. The Hausdorff distance is
//! estimated in both directions: from the mesh's vertices and the middles of its edges and faces to the surface, and from the
//! surface's vertices and the middles of its triangles to the mesh, polygons being fans of triangles. Feature edges are
//! sampled at their ends and at three points between. The surface is welded and oriented first, so a surface that is given
//! inside out is no fault of its mesh. Where its sheets meet, the mesh may branch as the surface does.
//!
//! # Practice
//! Distances are in mean edge lengths of the mesh, with the accuracy of f32 over the bounding box. Each fault is listed once: an
//! edge of more than two faces is not listed as misoriented too, nor a degenerate quad as concave.

use super::check::{Fault, Faults, Kind, check, check_joined, sort};
use super::incidence::undirected;
use super::orientation::Orientation;
use super::quality::percentile;
use super::topology::Connectivity;
use super::uncovered::{UNCOVERED, fan, uncovered_points};
use super::{Mesh, Topology};
use crate::surface::nearest::Simplices;
use crate::surface::{Frame, Surface, shown};
use glam::DVec3;
use rayon::prelude::*;
use rustc_hash::{FxHashMap, FxHashSet};
use serde::Serialize;
use std::fmt;

/// A vertex that is nearer to a place where sheets of the surface meet, in mean edge lengths, lies on it.
const ON_JOINT: f64 = 0.25;
/// A boundary loop of the mesh with a larger mean distance from the boundaries of the surface, in mean edge lengths, is a hole.
const OFF_BOUNDARY: f64 = 0.75;
/// A vertex that is farther than this from the surface, in mean edge lengths, is a fault.
const OFF_SURFACE: f64 = 1.0;
/// Diagonals that differ by more than this factor are of other units.
const OTHER_UNIT: f64 = 2.0;

/// A largest distance and its place.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Farthest {
    /// In mean edge lengths of the mesh.
    pub distance: f64,
    /// In model units.
    pub at: [f64; 3],
}

impl Farthest {
    /// The farther of the two.
    fn or(self, other: Self) -> Self {
        if other.distance > self.distance { other } else { self }
    }
}

/// Distances of the surface's features from the mesh's edges, in mean edge lengths of the mesh.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FeatureDistance {
    /// Number of feature edges of the surface.
    pub edges: usize,
    /// Arithmetic mean.
    pub mean: f64,
    /// 99th percentile.
    pub p99: f64,
    /// The largest.
    pub max: Farthest,
}

/// A mesh against a surface. The mesh's own [`Topology`] is that of its [`Faults`].
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// The topology of the surface.
    pub topology: Topology,
    /// Global differences between the mesh and the surface.
    pub differences: Vec<Difference>,
    /// From vertices of the mesh to the surface.
    pub vertices_to_surface: Farthest,
    /// From vertices and middles of edges and faces of the mesh to the surface.
    pub to_surface: Farthest,
    /// From vertices and middles of triangles of the surface to the mesh.
    pub to_mesh: Farthest,
    /// The larger of the two, in mean edge lengths.
    pub hausdorff: f64,
    /// The same as a share of the diagonal of the surface's bounding box.
    pub hausdorff_over_diagonal: f64,
    /// From the features of the surface to the edges of the mesh; `None` where there are no features.
    pub features: Option<FeatureDistance>,
}

/// A global difference between a mesh and a surface.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub enum Difference {
    /// The diagonal of the mesh's bounding box over the surface's: more than 2, or less than 1/2.
    Size {
        /// The ratio.
        ratio: f64,
    },
    /// The Euler characteristics differ.
    Euler {
        /// The mesh's.
        mesh: i64,
        /// The surface's.
        surface: i64,
    },
    /// The numbers of boundary loops differ.
    BoundaryLoops {
        /// The mesh's.
        mesh: usize,
        /// The surface's.
        surface: usize,
    },
    /// The numbers of connected components differ.
    Components {
        /// The mesh's.
        mesh: usize,
        /// The surface's.
        surface: usize,
    },
    /// A point of the surface, in model units, is more than one mean edge length from the mesh: a part is missing.
    Uncovered {
        /// The distance.
        distance: f64,
        /// The point.
        at: [f64; 3],
    },
    /// Edges of a boundary that was to be kept are no boundary edges of the mesh.
    KeptBoundary {
        /// Their number.
        missing: usize,
        /// The middle of one of them, in model units.
        at: [f64; 3],
    },
}

impl Difference {
    /// The difference where the farthest point of the surface from the mesh makes one.
    fn uncovered(farthest: Farthest) -> Option<Self> {
        let Farthest { distance, at } = farthest;
        (distance > UNCOVERED).then_some(Self::Uncovered { distance, at })
    }
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Size { ratio } => {
                let (ratio, than) = if ratio > 1.0 { (ratio, "larger") } else { (1.0 / ratio, "smaller") };
                // Two significant digits identify a unit.
                let ratio: f64 = format!("{ratio:.1e}").parse().unwrap_or(ratio);
                write!(f, "the mesh is {ratio} times {than} than the surface; are the units the same?")
            }
            Self::Euler { mesh, surface } => write!(f, "the Euler characteristic is {mesh}, the surface's {surface}"),
            Self::BoundaryLoops { mesh, surface } => {
                write!(f, "the number of boundary loops is {mesh}, the surface's {surface}")
            }
            Self::Components { mesh, surface } => {
                write!(f, "the number of components is {mesh}, the surface's {surface}")
            }
            Self::Uncovered { distance, at } => {
                write!(f, "the surface at {} is {distance:.1} edge lengths from the mesh", shown(&at))
            }
            Self::KeptBoundary { missing, at } => {
                let (edges, are) = if missing == 1 { ("edge", "is") } else { ("edges", "are") };
                write!(f, "{missing} {edges} of the boundary, which was to be kept, {are} missing, at {}", shown(&at))
            }
        }
    }
}

/// Lists the broken invariants of a mesh as [`check`] does, and those that need the surface: inverted faces, holes, and
/// vertices off the surface. Both are in model units.
///
/// The comparison is `None` where all edges have length 0, or faces name vertices that are missing or not finite.
pub fn check_against(mesh: &Mesh, surface: &Surface) -> (Faults, Option<Comparison>) {
    let frame = surface.frame();
    let Some(tested) = TestedMesh::new(mesh, frame) else { return (check(mesh), None) };
    let (reference, faces) = rayon::join(|| ReferenceSurface::new(surface), || fan(&tested.mesh));

    let mut faults = check_joined(mesh, &tested.branches(&reference));
    let from_vertices = tested.vertices(&reference);
    let (from_faces, flipped) = tested.faces(&reference);
    let fault = |kind, vertices: &[u32]| Fault { kind, at: mesh.middle(vertices).to_array() };
    let flipped = flipped.iter().map(|&face| fault(Kind::FlippedFace { face }, mesh.face(face as usize)));
    faults.list.extend(flipped);
    let hole = |hole: &[u32]| fault(Kind::Hole { vertex: hole[0], sides: hole.len() as u32 }, hole);
    faults.list.extend(tested.holes(&reference).map(hole));
    let strays = tested.used.iter().zip(&from_vertices.distances).filter(|(_, distance)| **distance > OFF_SURFACE);
    faults.list.extend(strays.map(|(&vertex, &distance)| fault(Kind::StrayVertex { vertex, distance }, &[vertex])));
    sort(&mut faults.list);

    let [vertices_to_surface, from_faces] = [from_vertices, from_faces].map(|from| from.farthest(frame));
    let to_surface = vertices_to_surface.or(tested.edges(&reference).farthest(frame)).or(from_faces);
    let to_mesh = tested.distances(reference.points(), |point| faces.distance(point)).farthest(frame);
    let hausdorff = to_surface.distance.max(to_mesh.distance);
    let mut differences = tested.differences(&reference);
    differences.extend(Difference::uncovered(to_mesh));
    let comparison = Comparison {
        topology: reference.topology,
        differences,
        vertices_to_surface,
        to_surface,
        to_mesh,
        hausdorff,
        hausdorff_over_diagonal: hausdorff * tested.mean_edge,
        features: tested.features(surface),
    };
    (faults, Some(comparison))
}

/// The topological differences between a mesh, unit-sized, and the surface that it was made of.
pub(crate) fn differences_from(mesh: Topology, surface: &Surface) -> Vec<Difference> {
    let reference = match surface.shared_places().contains(&true) {
        true => Connectivity::of(&as_mesh(surface)).topology,
        false => Topology::of(surface),
    };
    differences(mesh, reference)
}

/// The point of a surface that is the farthest from a unit-sized mesh that was made of it, where it is missing.
pub(crate) fn uncovered(mesh: &Mesh, surface: &Surface) -> Option<Difference> {
    let farthest = *uncovered_points(mesh, surface).first()?;
    let distance = farthest.distance / farthest.edge;
    Difference::uncovered(Farthest { distance, at: surface.frame().near(farthest.point.to_array()) })
}

/// The edges of a boundary that was to be kept which are no boundary edges of a mesh; `None` where all are. `vertices` has the mesh's
/// vertices at the kept ones of the surface.
pub(crate) fn missing_kept_edges(surface: &Surface, vertices: &FxHashMap<u32, u32>, mesh: &Mesh) -> Option<Difference> {
    if !surface.keeps_boundary() {
        return None;
    }
    let edges = mesh.edges();
    let boundary: FxHashSet<[u32; 2]> = edges.iter().filter(|edge| edge.is_boundary()).map(|edge| edge.ends).collect();
    let is_there = |ends: [u32; 2]| {
        let [a, b] = ends.map(|v| vertices.get(&v));
        a.zip(b).is_some_and(|(&a, &b)| boundary.contains(&undirected([a, b])))
    };
    let missing: Vec<[u32; 2]> = surface.kept_edges().filter(|&ends| !is_there(ends)).collect();
    let [a, b] = missing.first()?.map(|v| DVec3::from(surface.model_point(v)));
    Some(Difference::KeptBoundary { missing: missing.len(), at: ((a + b) / 2.0).into() })
}

/// The surface as a mesh, its sheets joined.
fn as_mesh(surface: &Surface) -> Mesh {
    let mut mesh = Mesh::new((0..surface.vertex_count() as u32).map(|v| surface.point(v)).collect());
    for triangle in &surface.triangles {
        mesh.push_face(&triangle.map(|v| surface.same_place(v)));
    }
    mesh
}

fn differences(mesh: Topology, surface: Topology) -> Vec<Difference> {
    let euler = Difference::Euler { mesh: mesh.euler, surface: surface.euler };
    let loops = Difference::BoundaryLoops { mesh: mesh.boundary_loops, surface: surface.boundary_loops };
    let components = Difference::Components { mesh: mesh.components, surface: surface.components };
    [
        (euler, mesh.euler != surface.euler),
        (loops, mesh.boundary_loops != surface.boundary_loops),
        (components, mesh.components != surface.components),
    ]
    .into_iter()
    .filter_map(|(difference, is_one)| is_one.then_some(difference))
    .collect()
}

/// Points and their distances, in mean edge lengths.
struct Distances {
    points: Vec<DVec3>,
    distances: Vec<f64>,
}

impl Distances {
    fn farthest(&self, frame: &Frame) -> Farthest {
        let mut farthest = (0, 0.0);
        for (place, &distance) in self.distances.iter().enumerate() {
            if distance > farthest.1 {
                farthest = (place, distance);
            }
        }
        Farthest { distance: farthest.1, at: frame.near(self.points[farthest.0].to_array()) }
    }
}

/// The surface, its sheets joined, in unit-sized coordinates.
struct ReferenceSurface<'a> {
    mesh: Mesh,
    orientation: Orientation<'a>,
    /// Its boundary edges.
    boundaries: Simplices<2>,
    /// Edges of more than two triangles, and vertices of more than one fan as segments of length 0.
    joints: Simplices<2>,
    topology: Topology,
}

impl<'a> ReferenceSurface<'a> {
    fn new(surface: &'a Surface) -> Self {
        let (mesh, orientation) = rayon::join(|| as_mesh(surface), || Orientation::new(surface));
        let Connectivity { edges, fans, topology, .. } = Connectivity::of(&mesh);
        let segment = |ends: [u32; 2]| ends.map(|end| mesh.place(end));
        let boundaries = edges.iter().filter(|edge| edge.is_boundary()).map(|edge| segment(edge.ends));
        let branching = edges.iter().filter(|edge| edge.along + edge.against > 2).map(|edge| segment(edge.ends));
        let pinched = (0..).zip(&fans).filter(|(_, fans)| **fans > 1).map(|(v, _)| segment([v; 2]));
        Self {
            orientation,
            boundaries: Simplices::new(boundaries),
            joints: Simplices::new(branching.chain(pinched)),
            topology,
            mesh,
        }
    }

    /// The distance of a point.
    fn distance(&self, point: DVec3) -> f64 {
        self.orientation.triangles().nearest(point).1
    }

    /// Its vertices and the middles of its triangles.
    fn points(&self) -> Vec<DVec3> {
        let middles = self.mesh.faces().map(|face| self.mesh.middle(face));
        self.mesh.points.iter().map(|&point| DVec3::from(point)).chain(middles).collect()
    }
}

/// The mesh, in unit-sized coordinates of the surface.
struct TestedMesh {
    mesh: Mesh,
    /// The vertices that faces use.
    used: Vec<u32>,
    connectivity: Connectivity,
    mean_edge: f64,
}

impl TestedMesh {
    fn new(mesh: &Mesh, frame: &Frame) -> Option<Self> {
        // The distance from a triangle takes products of eight lengths.
        const LARGEST: f64 = 1e30;
        let points: Vec<_> = mesh.points.iter().map(|&point| frame.to_unit(point)).collect();
        let somewhere = |v: &u32| points.get(*v as usize).is_some_and(|p| p.iter().all(|x| x.abs() < LARGEST));
        if !mesh.faces().flatten().all(somewhere) {
            return None;
        }
        let mesh = Mesh { points, ..mesh.clone() };
        let connectivity = Connectivity::of(&mesh);
        let lengths = mesh.lengths(&connectivity.edges);
        let mean_edge = lengths.iter().sum::<f64>() / lengths.len() as f64;
        let used = (0..).zip(&connectivity.fans).filter(|(_, fans)| **fans > 0).map(|(v, _)| v).collect();
        (mean_edge > 0.0).then_some(Self { mesh, used, connectivity, mean_edge })
    }

    /// Whether each vertex lies where sheets of the surface meet.
    fn branches(&self, reference: &ReferenceSurface) -> Vec<bool> {
        let mut branches = vec![false; self.mesh.points.len()];
        for &v in &self.used {
            branches[v as usize] = reference.joints.distance(self.mesh.place(v)) < ON_JOINT * self.mean_edge;
        }
        branches
    }

    /// The boundary loops that are no boundaries of the surface.
    fn holes<'a>(&'a self, reference: &ReferenceSurface) -> impl Iterator<Item = &'a [u32]> {
        let is_hole = |vertices: &&[u32]| {
            let total: f64 = vertices.iter().map(|&v| reference.boundaries.distance(self.mesh.place(v))).sum();
            total > OFF_BOUNDARY * self.mean_edge * vertices.len() as f64
        };
        self.connectivity.loops.iter().map(Vec::as_slice).filter(is_hole)
    }

    /// Distances of the vertices in use from the surface.
    fn vertices(&self, reference: &ReferenceSurface) -> Distances {
        let points = self.used.iter().map(|&v| self.mesh.place(v)).collect();
        self.distances(points, |point| reference.distance(point))
    }

    /// Distances of the middles of edges from the surface.
    fn edges(&self, reference: &ReferenceSurface) -> Distances {
        let middles = self.connectivity.edges.iter().map(|edge| self.mesh.middle(&edge.ends)).collect();
        self.distances(middles, |point| reference.distance(point))
    }

    /// Distances of the middles of faces from the surface, and the inverted faces.
    fn faces(&self, reference: &ReferenceSurface) -> (Distances, Vec<u32>) {
        let of_face = |face: u32| {
            let corners = self.mesh.face(face as usize);
            let middle = self.mesh.middle(corners);
            let nearest = reference.orientation.nearest_sheets(self.normal(corners), middle);
            (middle, nearest.distance / self.mean_edge, nearest.are_opposed.then_some(face))
        };
        let found: Vec<_> = (0..self.mesh.face_count() as u32).into_par_iter().map(of_face).collect();
        let flipped = found.iter().filter_map(|found| found.2).collect();
        let (points, distances) = found.into_iter().map(|(point, distance, _)| (point, distance)).unzip();
        (Distances { points, distances }, flipped)
    }

    /// Twice the vector area of a face.
    fn normal(&self, corners: &[u32]) -> DVec3 {
        let middle = self.mesh.middle(corners);
        let from_middle = |v: &u32| self.mesh.place(*v) - middle;
        corners.iter().zip(corners.iter().cycle().skip(1)).map(|(a, b)| from_middle(a).cross(from_middle(b))).sum()
    }

    fn distances(&self, points: Vec<DVec3>, distance: impl Fn(DVec3) -> f64 + Sync) -> Distances {
        let distances = points.par_iter().map(|&point| distance(point) / self.mean_edge).collect();
        Distances { points, distances }
    }

    fn differences(&self, reference: &ReferenceSurface) -> Vec<Difference> {
        let places = || self.used.iter().map(|&v| self.mesh.place(v));
        let low = places().fold(DVec3::INFINITY, DVec3::min);
        let high = places().fold(DVec3::NEG_INFINITY, DVec3::max);
        // The surface's diagonal is 1 in unit-sized coordinates.
        let ratio = low.distance(high);
        let size = (!(1.0 / OTHER_UNIT..=OTHER_UNIT).contains(&ratio)).then_some(Difference::Size { ratio });
        size.into_iter().chain(differences(self.connectivity.topology, reference.topology)).collect()
    }

    /// Distances of points on the surface's features from the mesh's edges.
    fn features(&self, surface: &Surface) -> Option<FeatureDistance> {
        let ends = |h: u32| [surface.origin(h), surface.target(h)].map(|v| surface.same_place(v));
        let half_edges = 0..3 * surface.triangle_count() as u32;
        let mut edges: Vec<[u32; 2]> = half_edges
            .filter(|&h| surface.features().is_feature(h))
            .map(ends)
            .map(|[a, b]| [a.min(b), a.max(b)])
            .collect();
        edges.sort_unstable();
        edges.dedup();
        let mut vertices = edges.concat();
        vertices.sort_unstable();
        vertices.dedup();
        let place = |v: u32| DVec3::from(surface.point(v));
        let between = |&[a, b]: &[u32; 2]| [0.25, 0.5, 0.75].map(|share| place(a).lerp(place(b), share));
        let samples: Vec<DVec3> = vertices.iter().map(|&v| place(v)).chain(edges.iter().flat_map(between)).collect();
        if samples.is_empty() {
            return None;
        }
        let of_mesh = Simplices::new(self.connectivity.edges.iter().map(|edge| edge.ends.map(|v| self.mesh.place(v))));
        let found = self.distances(samples, |point| of_mesh.distance(point));
        let max = found.farthest(surface.frame());
        let mut distances = found.distances;
        distances.sort_unstable_by(f64::total_cmp);
        let mean = distances.iter().sum::<f64>() / distances.len() as f64;
        Some(FeatureDistance { edges: edges.len(), mean, p99: percentile(&distances, 0.99), max })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::examples::Example;
    use crate::surface::{FeatureOptions, KeptBoundary, Soup};

    fn surface(soup: &Soup) -> Surface {
        Surface::new(soup, &FeatureOptions::default()).unwrap_or_else(|error| panic!("{error}"))
    }

    fn example(name: &str) -> Soup {
        name.parse::<Example>().expect("an example's name").generate(500)
    }

    /// A square of 10 by 10 cells, each of two triangles.
    fn square() -> Soup {
        let cells = (0..100).map(|cell| cell / 10 * 11 + cell % 10);
        Soup {
            points: (0..121).map(|v| [f64::from(v % 11), f64::from(v / 11), 0.0]).collect(),
            triangles: cells.flat_map(|a| [[a, a + 1, a + 12], [a, a + 12, a + 11]]).collect(),
            ..Soup::default()
        }
    }

    fn differences_of(mesh: &Mesh, surface: &Surface) -> Vec<Difference> {
        differences_from(Connectivity::of(mesh).topology, surface)
    }

    /// What a mesh has otherwise than a surface, lost parts included.
    fn all_differences(mesh: &Mesh, surface: &Surface) -> Vec<Difference> {
        differences_of(mesh, surface).into_iter().chain(uncovered(mesh, surface)).collect()
    }

    /// The mesh without the faces that `goes` names by their index and middle.
    fn without(mesh: &Mesh, goes: impl Fn(usize, DVec3) -> bool) -> Mesh {
        let mut rest = Mesh::new(mesh.points.clone());
        let kept = (0..).zip(mesh.faces()).filter(|&(index, face)| !goes(index, mesh.middle(face)));
        kept.for_each(|(_, face)| rest.push_face(face));
        // Vertices without a face would cover what is lost.
        let mut is_used = vec![false; rest.points.len()];
        rest.faces().flatten().for_each(|&v| is_used[v as usize] = true);
        rest.points.iter_mut().zip(is_used).filter(|(_, is_used)| !is_used).for_each(|(point, _)| *point = [9.0; 3]);
        rest
    }

    #[test]
    fn the_surface_itself_has_no_difference() {
        for name in Example::NAMES {
            let surface = surface(&example(name));
            assert_eq!(all_differences(&as_mesh(&surface), &surface), [], "{name}");
        }
    }

    #[test]
    fn a_hole_and_a_handle_are_told_by_the_topology() {
        let [sphere, torus] = ["sphere", "torus"].map(|name| surface(&example(name)));
        let holed = without(&as_mesh(&torus), |index, _| index == 7);
        let (euler, loops) =
            (Difference::Euler { mesh: -1, surface: 0 }, Difference::BoundaryLoops { mesh: 1, surface: 0 });
        assert_eq!(all_differences(&holed, &torus), [euler, loops]);
        assert_eq!(differences_of(&as_mesh(&torus), &sphere), [Difference::Euler { mesh: 0, surface: 2 }]);
    }

    #[test]
    fn an_edge_of_a_kept_boundary_that_is_missing_is_told_with_its_place() {
        let plain = surface(&square());
        let mesh = as_mesh(&plain);
        let all: FxHashMap<u32, u32> = (0..121).map(|v| (v, v)).collect();
        let corner = without(&mesh, |_, middle| middle.x + middle.y < -0.6);
        assert_eq!(missing_kept_edges(&plain, &all, &corner), None, "none was to be kept");
        let kept = plain.with_kept_boundary(KeptBoundary::Exact, &FeatureOptions::default()).expect("a boundary");
        assert_eq!(kept.kept_edges().count(), 40);
        assert_eq!(missing_kept_edges(&kept, &all, &mesh), None);
        assert_eq!(corner.face_count(), 198, "the cell at the corner goes");
        let told = missing_kept_edges(&kept, &all, &corner);
        assert!(
            matches!(told, Some(Difference::KeptBoundary { missing: 2, at: [x, y, _] }) if x + y == 0.5),
            "{told:?}"
        );
        // A vertex that the mesh lacks takes both its edges along.
        let [lost, _] = kept.kept_edges().next().expect("an edge");
        let rest = all.into_iter().filter(|&(v, _)| v != lost).collect();
        let told = missing_kept_edges(&kept, &rest, &mesh);
        assert!(matches!(told, Some(Difference::KeptBoundary { missing: 2, .. })), "{told:?}");
    }

    #[test]
    fn a_lost_part_is_told_with_its_place() {
        // Of a second sphere nothing is left.
        let mut soup = example("sphere");
        let count = soup.points.len() as u32;
        soup.points.extend_from_within(..);
        soup.points[count as usize..].iter_mut().for_each(|point| point[0] += 5.0);
        soup.triangles.extend_from_within(..);
        let half = soup.triangles.len() / 2;
        soup.triangles[half..].iter_mut().flatten().for_each(|v| *v += count);
        let two = surface(&soup);
        let one = without(&as_mesh(&two), |_, middle| middle.x > 0.0);
        let found = all_differences(&one, &two);
        let [Difference::Euler { .. }, Difference::Components { mesh: 1, surface: 2 }, lost] = found[..] else {
            panic!("{found:?}")
        };
        let Difference::Uncovered { distance, at: [x, ..] } = lost else { panic!("{lost:?}") };
        assert!(distance > 10.0 && (x - 6.0).abs() < 0.1, "the far side: {lost:?}");
        // Of a square without its last rows the topology says nothing.
        let square = surface(&square());
        let low = without(&as_mesh(&square), |_, middle| middle.x > 0.13);
        assert_eq!(differences_of(&low, &square), []);
        assert!(matches!(uncovered(&low, &square), Some(Difference::Uncovered { distance, .. }) if distance > 2.0));
        // A corner that lies less than an edge length away is covered.
        let rest = without(&as_mesh(&square), |_, middle| middle.y - middle.x > 0.64);
        assert_eq!((rest.face_count(), all_differences(&rest, &square)), (199, vec![]));
    }
}
