//! Hole filling: from the edges of the connected mosaic to faces (the paper, section 3, figure 4).
//!
//! # Theory
//! A hole is a face of more than four sides. A hole of `k` sides is split by chords into quads and, where `k` is odd, one
//! triangle; dynamic programming over the chords finds the split of least cost. Regular holes get these patterns:
//!
//! ```text
//!    5 sides        6 sides         7 sides             8 sides          8, a tile inside
//!
//!       o          o---o---o      o---o---o         o---o---o---o          o---o---o
//!      / \         |   |   |      |   |   |\        |   |   |   |          |   |   |
//!     o---o        |   |   |      |   |   | o       |   |   |   |          o---x---o
//!     |   |        |   |   |      |   |   |/        |   |   |   |          |   |   |
//!     o---o        o---o---o      o---o---o         o---o---o---o          o---o---o
//!
//!   a quad and     two quads    two quads and        three quads          four quads
//!   a triangle                    a triangle
//! ```
//!
//! An even `k` gives `k / 2 - 1` quads; an odd one gives `(k - 3) / 2` quads and a triangle. Triangles replace a quad that
//! would be inverted or concave. The tile `x` has no edge; it gets two, and the parts on either side are split in turn.
//!
//! # Changes versus the paper
//! The text does not show the patterns of figure 4, and the paper leaves or triangulates other holes. Here every hole is split.
//! The [triangulation](super::triangulate) tells what lies inside a face: a face that is no disc, or has too many
//! sides for one dynamic programme, is first cut along edges of the triangulation.
//!
//! # Practice
//! Keep [`Holes::Patterns`]. [`Holes::Triangles`] and [`Holes::Leave`] are the paper's other two ways, for comparison.

use super::incidence::{sides, undirected};
use super::intrinsic::{Intrinsic, next, previous};
use super::metric::{Metric, to_metric};
use super::objective::{Context, Measure};
use super::polygon;
use super::quality::least_corner_share;
use super::surface_mesh::SurfaceMesh;
use super::triangulate::Triangulation;
use super::vertex::Place;
use crate::surface::NONE;
use glam::DVec3;
use rayon::prelude::*;
use rustc_hash::FxHashSet;

/// The way in which holes are filled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Holes {
    /// Split into quads and at most one triangle each.
    #[default]
    Patterns,
    /// Split into triangles (the paper's "trivial strategy").
    Triangles,
    /// Left as faces of more than four sides.
    Leave,
}

/// Holes of more sides are cut in two first.
const LARGEST: usize = 14;
/// The cost of a triangle; 1 is the cost of a quad of shape 0.
const TRIANGLE_COST: f64 = 1.0;
/// The cost of a face that is a fault, or nearly concave.
const FAULT_COST: f64 = 10.0;
/// A quad of a smaller shape is nearly concave, or only thin.
const NEARLY_CONCAVE: f64 = 0.05;
/// A thin quad has a larger share of its area at each corner, unless all corners lie on one curve: it is nearly a rectangle.
const THIN_RECTANGLE: f64 = 0.5;

/// The mesh of the faces that the edges enclose, its holes filled, and the number of holes.
pub fn fill(context: &Context, triangulation: &Triangulation, edges: &[bool], holes: Holes) -> (SurfaceMesh, usize) {
    let mut filler = Filler::new(context, triangulation, edges, holes);
    let starts = 0..triangulation.faces.face_count() as u32;
    let regions: Vec<Vec<u32>> = starts.map(|face| filler.region(face)).filter(|region| !region.is_empty()).collect();
    // Nearly all regions are quads, or triangles, and stay as they are.
    let kept: Vec<Option<Vec<u32>>> = regions
        .par_iter()
        .with_min_len(1024)
        .map(|region| filler.outline(region).filter(|face| filler.is_kept(face)))
        .collect();
    let mut count = 0;
    for (region, kept) in regions.iter().zip(kept) {
        match kept {
            Some(face) => {
                count += usize::from(face.len() > 4);
                filler.polygons.push(face);
            }
            None if context.is_cancelled() => {}
            None => count += filler.fill(region),
        }
    }
    (triangulation.surface_mesh(&filler.polygons), count)
}

/// The state of a filling.
struct Filler<'a> {
    context: &'a Context<'a>,
    triangulation: &'a Triangulation,
    faces: &'a Intrinsic,
    holes: Holes,
    edges: Vec<bool>,
    /// The triangles that a region has.
    visited: Vec<bool>,
    /// The edges of the mesh that are no edges of the triangulation, the smaller end first.
    chords: FxHashSet<[u32; 2]>,
    metric: Metric,
    /// The faces of the mesh.
    polygons: Vec<Vec<u32>>,
}

impl<'a> Filler<'a> {
    fn new(context: &'a Context, triangulation: &'a Triangulation, edges: &[bool], holes: Holes) -> Self {
        let faces = &triangulation.faces;
        Self {
            context,
            triangulation,
            faces,
            holes,
            edges: edges.to_vec(),
            visited: vec![false; faces.face_count()],
            chords: FxHashSet::default(),
            metric: Metric::new(&triangulation.vertices, &triangulation.factors),
            polygons: Vec::new(),
        }
    }

    /// The triangles that can be reached from a triangle without crossing an edge of the mesh; none where it has a region.
    fn region(&mut self, face: u32) -> Vec<u32> {
        if self.visited[face as usize] {
            return Vec::new();
        }
        self.visited[face as usize] = true;
        let mut region = vec![face];
        let mut at = 0;
        while at < region.len() {
            for h in 3 * region[at]..3 * region[at] + 3 {
                let twin = self.faces.twin[h as usize];
                if !self.edges[h as usize] && twin != NONE && !self.visited[twin as usize / 3] {
                    self.visited[twin as usize / 3] = true;
                    region.push(twin / 3);
                }
            }
            at += 1;
        }
        region
    }

    /// Adds the faces of a region to the mesh; returns the number of its holes, more than one where it is no disc.
    fn fill(&mut self, region: &[u32]) -> usize {
        let Some(polygon) = self.outline(region) else { return self.split_region(region) };
        let is_hole = polygon.len() > 4;
        if self.is_kept(&polygon) {
            self.polygons.push(polygon);
        } else if polygon.len() <= LARGEST || self.holes == Holes::Triangles {
            self.split_polygon(&polygon, region);
        } else {
            self.split_region(region);
        }
        usize::from(is_hole)
    }

    /// Whether an outline is a face as it is.
    fn is_kept(&self, polygon: &[u32]) -> bool {
        match polygon.len() {
            3 => true,
            4 => self.face_cost(polygon) < FAULT_COST,
            _ => self.holes == Holes::Leave,
        }
    }

    /// The outline of a region; `None` unless it is one simple loop and no vertex lies inside.
    fn outline(&self, region: &[u32]) -> Option<Vec<u32>> {
        let first = region.iter().flat_map(|&f| 3 * f..3 * f + 3).find(|&h| self.edges[h as usize])?;
        let mut polygon = Vec::with_capacity(region.len() + 2);
        let mut h = first;
        loop {
            polygon.push(self.faces.origin[h as usize]);
            h = next(h);
            while !self.edges[h as usize] {
                h = next(self.faces.twin[h as usize]);
            }
            if h == first {
                break;
            }
            if polygon.len() > region.len() + 2 {
                return None;
            }
        }
        let mut sorted = polygon.clone();
        sorted.sort_unstable();
        let simple = sorted.windows(2).all(|w| w[0] != w[1]);
        (simple && polygon.len() == region.len() + 2).then_some(polygon)
    }

    /// Makes the best inner edge of a region an edge of the mesh, and fills the parts.
    fn split_region(&mut self, region: &[u32]) -> usize {
        let edge_count = |v: u32, s: &Self| {
            let mut ring = Vec::new();
            s.faces.ring(v, &mut ring);
            ring.iter().filter(|&&h| s.edges[h as usize]).count()
        };
        let inner = region.iter().flat_map(|&f| 3 * f..3 * f + 3).filter(|&h| !self.edges[h as usize]);
        // An edge of a tile with fewer than two edges comes first; then the edge nearest to a tile side in direction and length.
        let best = inner
            .map(|h| {
                let (a, b) = (self.faces.origin[h as usize], self.faces.target(h));
                let fewest = edge_count(a, self).min(edge_count(b, self)).min(2);
                let side = self.triangulation.sides[a as usize];
                let off = |e: u32| {
                    let quarter = self.faces.begin[e as usize] / std::f64::consts::FRAC_PI_2;
                    (quarter - quarter.round()).abs()
                };
                let cost =
                    off(h) + off(self.faces.twin[h as usize]) + (self.faces.length[h as usize] / side - 1.0).abs();
                (fewest, cost, h)
            })
            .min_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
        let Some((_, _, h)) = best else {
            // The region is one triangle.
            let corners = |f: &u32| [0, 1, 2].map(|k| self.faces.origin[3 * *f as usize + k]).to_vec();
            self.polygons.extend(region.iter().map(corners));
            return 0;
        };
        let twin = self.faces.twin[h as usize];
        self.edges[h as usize] = true;
        self.edges[twin as usize] = true;
        region.iter().for_each(|&f| self.visited[f as usize] = false);
        let mut count = 0;
        for &face in region {
            let part = self.region(face);
            if !part.is_empty() {
                count += self.fill(&part);
            }
        }
        count
    }

    /// Cuts the outline of a region into quads and triangles at least cost; into the region's triangles where no cut is allowed.
    fn split_polygon(&mut self, polygon: &[u32], region: &[u32]) {
        let vertices = |places: &[usize]| places.iter().map(|&k| polygon[k]).collect::<Vec<u32>>();
        let face = |places: &[usize]| match places.len() {
            4 if self.holes == Holes::Triangles => f64::INFINITY,
            _ => self.face_cost(&vertices(places)),
        };
        let chord =
            |i: usize, j: usize| if self.may_join(polygon[i], polygon[j], region) { 0.0 } else { f64::INFINITY };
        let cut = polygon::cut(polygon.len(), face, chord);
        let triangles = || region.iter().map(|&f| [0, 1, 2].map(|k| self.faces.origin[3 * f as usize + k]).to_vec());
        let parts: Vec<Vec<u32>> =
            cut.map_or_else(|| triangles().collect(), |(_, parts)| parts.iter().map(|part| vertices(part)).collect());
        self.chords.extend(parts.iter().flat_map(|part| sides(part)).map(undirected));
        self.polygons.extend(parts);
    }

    /// Whether a chord of a polygon may be an edge. It must be the only edge between its ends in the mesh and in the
    /// triangulation outside the region, as any edge of the triangulation may become an edge of the mesh.
    fn may_join(&self, a: u32, b: u32, region: &[u32]) -> bool {
        let mut ring = Vec::new();
        self.faces.ring(a, &mut ring);
        let outside = |h: u32| {
            let twin = self.faces.twin[h as usize];
            self.edges[h as usize] || twin == NONE || !region.contains(&(h / 3))
        };
        let last = previous(ring[ring.len() - 1]);
        let joins = |&h: &u32| self.faces.target(h) == b || (h == last && self.faces.origin[h as usize] == b);
        let is_taken = ring.iter().chain([&last]).filter(|h| joins(h)).any(|&h| outside(h));
        !is_taken && !self.chords.contains(&undirected([a, b]))
    }

    /// Whether all vertices of a face lie on one feature curve, or at its ends.
    fn lies_on_one_curve(&self, face: &[u32]) -> bool {
        let places = || face.iter().map(|&v| self.triangulation.vertices[v as usize].place);
        let curve = places().find_map(|place| match place {
            Place::OnCurve { curve, .. } => Some(curve),
            _ => None,
        });
        curve.is_some_and(|curve| {
            places().all(|place| match place {
                Place::Free => false,
                Place::OnCurve { curve: own, .. } => own == curve,
                Place::Corner => true,
            })
        })
    }

    /// The cost of a face: what its shape lacks, and a penalty for a triangle and for a fault.
    fn face_cost(&self, face: &[u32]) -> f64 {
        let mut points = [DVec3::ZERO; 4];
        face.iter().zip(&mut points).for_each(|(&v, point)| *point = self.triangulation.vertices[v as usize].point);
        let corners = &points[..face.len()];
        let sheets = face.iter().map(|&v| self.triangulation.vertices[v as usize].triangles);
        let map = self.metric.map_of(face);
        let orientation = &self.context.orientation;
        let measure = Measure::of(corners, map.as_ref(), None, || orientation.is_inverted(corners, sheets));
        let base = if face.len() == 3 { TRIANGLE_COST } else { 0.0 };
        let is_thin = |quad: [DVec3; 4]| least_corner_share(quad) > THIN_RECTANGLE && !self.lies_on_one_curve(face);
        let is_nearly_concave = match *corners {
            [a, b, c, d] if measure.shape <= NEARLY_CONCAVE => {
                !is_thin([a, b, c, d].map(|corner| to_metric(map.as_ref(), corner)))
            }
            _ => false,
        };
        let is_bad = measure.is_fault || is_nearly_concave;
        let fault = if is_bad { FAULT_COST } else { 0.0 };
        base + (1.0 - measure.shape) + fault
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Vertex;
    use crate::mesh::intrinsic::tests::plane;
    use crate::mosaic::Tile;
    use crate::surface::{FeatureOptions, Soup, Surface};
    use bytemuck::Zeroable;

    /// One hole in the plane, its tiles of side 1 turned along x and y, all of them on the surface's triangle 0.
    fn hole(points: &[[f64; 2]], triangles: &[[u32; 3]]) -> Triangulation {
        let tile = Tile { normal: [0.0, 0.0, 1.0], axis: [1.0, 0.0, 0.0], h: 1.0, ..Tile::zeroed() };
        let vertex = |(v, &[x, y]): (u32, &[f64; 2])| Vertex {
            point: DVec3::new(x, y, 0.0),
            place: Place::Free,
            triangles: [0; 2],
            normal: DVec3::Z,
            axis: DVec3::X,
            valence: 4,
            is_kept: false,
            origin: v,
        };
        Triangulation {
            faces: plane(points, triangles),
            tiles: vec![tile; points.len()],
            sides: vec![1.0; points.len()],
            vertices: (0..).zip(points).map(vertex).collect(),
            feature_samples: 0,
            extra: 0,
            factors: Vec::new(),
            same_place: (0..points.len() as u32).collect(),
        }
    }

    /// A triangle that looks along z.
    fn triangle() -> Surface {
        let points = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let soup = Soup { points, triangles: vec![[0, 1, 2]], ..Soup::default() };
        Surface::new(&soup, &FeatureOptions::default()).unwrap()
    }

    /// The faces that the outline of the hole, all of its edges, is filled with: vertices and faces in ascending order.
    fn filled(hole: &Triangulation, holes: Holes) -> Vec<Vec<u32>> {
        let outline: Vec<bool> = hole.faces.twin.iter().map(|twin| *twin == NONE).collect();
        let surface = triangle();
        let (mesh, count) = fill(&Context::new(&surface), hole, &outline, holes);
        assert!(count >= 1);
        let sorted = |face: &[u32]| {
            let mut face = face.to_vec();
            face.sort_unstable();
            face
        };
        let mut faces: Vec<_> = mesh.faces().map(sorted).collect();
        faces.sort();
        faces
    }

    /// Points in a row, 1 apart.
    fn row(count: usize, y: f64) -> impl DoubleEndedIterator<Item = [f64; 2]> + ExactSizeIterator {
        (0..count).map(move |x| [x as f64, y])
    }

    /// Two rows of this many points, counter-clockwise, and triangles between them.
    fn strip(count: u32) -> (Vec<[f64; 2]>, Vec<[u32; 3]>) {
        let points = row(count as usize, 0.0).chain(row(count as usize, 1.0).rev()).collect();
        let top = |k: u32| 2 * count - 1 - k;
        let cell = |k: u32| [[k, k + 1, top(k + 1)], [k, top(k + 1), top(k)]];
        (points, (0..count - 1).flat_map(cell).collect())
    }

    #[test]
    fn holes_are_split_by_their_patterns() {
        let (square, (six, two_cells), (eight, three_cells)) = (strip(2), strip(3), strip(4));
        let tip = |mut points: Vec<[f64; 2]>, at: usize, mut triangles: Vec<[u32; 3]>| {
            let (a, b) = (points[at], points[at + 1]);
            // An equilateral triangle on the side from `a` to `b`.
            let [dx, dy] = [b[0] - a[0], b[1] - a[1]];
            let height = 3.0_f64.sqrt() / 2.0;
            points.push([(a[0] + b[0]) / 2.0 + height * dy, (a[1] + b[1]) / 2.0 - height * dx]);
            triangles.push([at as u32, points.len() as u32 - 1, at as u32 + 1]);
            hole(&points, &triangles)
        };
        let house = tip(square.0, 2, square.1);
        let seven = tip(six.clone(), 2, two_cells.clone());
        let (six, eight) = (hole(&six, &two_cells), hole(&eight, &three_cells));
        let nine: Vec<[f64; 2]> = (0..3).flat_map(|y| row(3, f64::from(y))).collect();
        let cells = [0, 1, 3, 4].iter().flat_map(|&v| [[v, v + 1, v + 4], [v, v + 4, v + 3]]);
        let ring = hole(&nine, &cells.collect::<Vec<_>>());
        let patterns: [(&Triangulation, &[&[u32]]); 5] = [
            (&house, &[&[0, 1, 2, 3], &[2, 3, 4]]),
            (&six, &[&[0, 1, 4, 5], &[1, 2, 3, 4]]),
            (&seven, &[&[0, 1, 4, 5], &[1, 2, 3, 4], &[2, 3, 6]]),
            (&eight, &[&[0, 1, 6, 7], &[1, 2, 5, 6], &[2, 3, 4, 5]]),
            (&ring, &[&[0, 1, 3, 4], &[1, 2, 4, 5], &[3, 4, 6, 7], &[4, 5, 7, 8]]),
        ];
        for (hole, pattern) in patterns {
            assert_eq!(filled(hole, Holes::Patterns), pattern);
            // Beside the tile of the ring a part of four sides may be left, which is no hole.
            let quads = |faces: &[Vec<u32>]| faces.iter().filter(|face| face.len() == 4).count();
            let triangles = filled(hole, Holes::Triangles);
            assert!(quads(&triangles) + 1 < pattern.len(), "{pattern:?} must not come of triangles alone");
        }
        assert_eq!(filled(&six, Holes::Leave), [[0, 1, 2, 3, 4, 5]]);
    }

    #[test]
    fn a_pattern_that_would_fold_gives_way() {
        let (mut points, triangles) = strip(3);
        // Vertex 1 is pushed up nearly to the top: between two of the quads of the pattern there is no room.
        points[1] = [1.0, 0.97];
        let split = filled(&hole(&points, &triangles), Holes::Patterns);
        assert_ne!(split, [[0, 1, 4, 5], [1, 2, 3, 4]]);
    }
}
