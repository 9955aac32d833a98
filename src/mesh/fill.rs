//! From the connected mosaic to faces: quads as they are, holes split at least cost (the paper, section 3, figure 4).
//!
//! # Theory
//! A hole is a face of more than four sides. One of `k` sides is split by chords into quads and, where `k` is odd, one
//! triangle; dynamic programming over chords finds the split of least cost. Where shape is even, these are the patterns:
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
//! and so on: `k / 2 - 1` quads where `k` is even, `(k - 3) / 2` and a triangle where it is odd. A quad that would fold
//! gives way to triangles. The tile `x` had no edge: it is given two, and what is left on either side is split in its turn.
//!
//! # Changes versus the paper
//! Figure 4's patterns are not in our text, and other holes were left or triangulated; here every hole is split, of any
//! degree. What lies inside a face is known from the [triangulation](super::triangulate): a face that is no disc, or of more
//! sides than can be split at once, is cut along edges of the triangulation until it is.

use super::Mesh;
use super::intrinsic::{Intrinsic, next};
use super::metric::{Metric, laid};
use super::quality::{quad_shape, triangle_shape};
use super::triangulate::Triangulation;
use crate::surface::NONE;
use glam::DVec3;
use rustc_hash::FxHashSet;

/// What to do with holes.
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
/// The cost of a triangle, against that of a quad of shape 0.
const TRIANGLE: f64 = 1.0;
/// The cost of a face that is concave or nearly so.
const FOLDED: f64 = 10.0;
/// The cost of a face that faces away from its tiles: where the surface bends within a tile, all faces may have to.
const AVERTED: f64 = 3.0;

/// The faces that the edges of the mesh enclose, holes treated as asked; and how many holes there were.
pub fn fill(triangulation: &Triangulation, edges: &[bool], holes: Holes) -> (Mesh, usize) {
    let mut filler = Filler::new(triangulation, edges);
    let mut mesh = Mesh::new(triangulation.points.iter().map(|p| p.to_array()).collect());
    let faces = &triangulation.faces;
    let mut count = 0;
    for face in 0..faces.face_count() as u32 {
        if !filler.seen[face as usize] {
            let region = filler.region(face);
            count += filler.treat(region, holes, &mut mesh);
        }
    }
    (mesh, count)
}

struct Filler<'a> {
    triangulation: &'a Triangulation,
    faces: &'a Intrinsic,
    edges: Vec<bool>,
    /// Triangles that a region has taken.
    seen: Vec<bool>,
    chords: FxHashSet<[u32; 2]>,
    metric: Metric,
}

impl<'a> Filler<'a> {
    fn new(triangulation: &'a Triangulation, edges: &[bool]) -> Self {
        let faces = &triangulation.faces;
        let seen = vec![false; faces.face_count()];
        let metric = Metric::new(&triangulation.anchors());
        Self { triangulation, faces, edges: edges.to_vec(), seen, chords: FxHashSet::default(), metric }
    }

    /// The triangles that are joined to this one across no edge of the mesh.
    fn region(&mut self, face: u32) -> Vec<u32> {
        self.seen[face as usize] = true;
        let mut region = vec![face];
        let mut at = 0;
        while at < region.len() {
            for h in 3 * region[at]..3 * region[at] + 3 {
                let twin = self.faces.twin[h as usize];
                if !self.edges[h as usize] && twin != NONE && !self.seen[twin as usize / 3] {
                    self.seen[twin as usize / 3] = true;
                    region.push(twin / 3);
                }
            }
            at += 1;
        }
        region
    }

    /// Adds the region's faces to the mesh; returns how many holes it was, more than one where it was no disc.
    fn treat(&mut self, region: Vec<u32>, holes: Holes, mesh: &mut Mesh) -> usize {
        let Some(polygon) = self.polygon(&region) else {
            return self.split_region(region, holes, mesh);
        };
        match (polygon.len(), holes) {
            (3, _) => mesh.push_face(&polygon),
            (4, _) if self.face_cost(&polygon) < FOLDED => mesh.push_face(&polygon),
            (4, _) => self.split_polygon(&polygon, holes, mesh),
            (_, Holes::Leave) => mesh.push_face(&polygon),
            (_, Holes::Triangles) => self.split_polygon(&polygon, holes, mesh),
            (k, Holes::Patterns) if k <= LARGEST => self.split_polygon(&polygon, holes, mesh),
            _ => {
                self.split_region(region, holes, mesh);
            }
        }
        usize::from(polygon.len() > 4)
    }

    /// The border of a region, where that is one loop that meets no vertex twice and leaves none inside.
    fn polygon(&self, region: &[u32]) -> Option<Vec<u32>> {
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

    /// Makes the inner edge of a region that suits best an edge of the mesh and treats what is left on either side.
    fn split_region(&mut self, region: Vec<u32>, holes: Holes, mesh: &mut Mesh) -> usize {
        let lonely = |v: u32, s: &Self| {
            let mut ring = Vec::new();
            s.faces.ring(v, &mut ring);
            ring.iter().filter(|&&h| s.edges[h as usize]).count()
        };
        let inner = region.iter().flat_map(|&f| 3 * f..3 * f + 3).filter(|&h| !self.edges[h as usize]);
        // Tiles with few edges first; then the edge along the rows that is nearest to a tile side.
        let best = inner
            .map(|h| {
                let (a, b) = (self.faces.origin[h as usize], self.faces.target(h));
                let needed = lonely(a, self).min(lonely(b, self)).min(2);
                let side = self.triangulation.sides[a as usize];
                let off = |e: u32| {
                    let quarter = self.faces.begin[e as usize] / std::f64::consts::FRAC_PI_2;
                    (quarter - quarter.round()).abs()
                };
                let cost =
                    off(h) + off(self.faces.twin[h as usize]) + (self.faces.length[h as usize] / side - 1.0).abs();
                (needed, cost, h)
            })
            .min_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
        let Some((_, _, h)) = best else {
            // Only triangles are left.
            for &f in &region {
                mesh.push_face(&[0, 1, 2].map(|k| self.faces.origin[3 * f as usize + k]));
            }
            return 0;
        };
        let twin = self.faces.twin[h as usize];
        self.edges[h as usize] = true;
        self.edges[twin as usize] = true;
        region.iter().for_each(|&f| self.seen[f as usize] = false);
        let mut count = 0;
        for face in region {
            if !self.seen[face as usize] {
                let part = self.region(face);
                count += self.treat(part, holes, mesh);
            }
        }
        count
    }

    fn split_polygon(&mut self, polygon: &[u32], holes: Holes, mesh: &mut Mesh) {
        let mut parts = Vec::new();
        self.cut(polygon, holes != Holes::Triangles, &mut parts);
        for part in parts {
            for i in 0..part.len() {
                let (a, b) = (part[i], part[(i + 1) % part.len()]);
                self.chords.insert([a.min(b), a.max(b)]);
            }
            mesh.push_face(&part);
        }
    }

    /// Dynamic programming over chords: the least cost of the part of the polygon from `i` to `j`, and how it is cut.
    fn cut(&self, polygon: &[u32], quads: bool, parts: &mut Vec<Vec<u32>>) {
        let k = polygon.len();
        let at = |i: usize, j: usize| i * k + j;
        let mut cost = vec![0.0; k * k];
        let mut cuts: Vec<[usize; 2]> = vec![[usize::MAX; 2]; k * k];
        for span in 2..k {
            for i in 0..k - span {
                let j = i + span;
                let mut best = (f64::INFINITY, [usize::MAX; 2]);
                for m in i + 1..j {
                    let face = [polygon[i], polygon[m], polygon[j]];
                    let total = cost[at(i, m)] + cost[at(m, j)] + self.face_cost(&face);
                    if total < best.0 {
                        best = (total, [m, usize::MAX]);
                    }
                    for n in m + 1..if quads { j } else { m + 1 } {
                        let face = [polygon[i], polygon[m], polygon[n], polygon[j]];
                        let total = cost[at(i, m)] + cost[at(m, n)] + cost[at(n, j)] + self.face_cost(&face);
                        if total < best.0 {
                            best = (total, [m, n]);
                        }
                    }
                }
                let chord = if span + 1 < k { self.chord_cost(polygon[i], polygon[j]) } else { 0.0 };
                cost[at(i, j)] = best.0 + chord;
                cuts[at(i, j)] = best.1;
            }
        }
        let mut open = vec![[0, k - 1]];
        while let Some([i, j]) = open.pop() {
            if j < i + 2 {
                continue;
            }
            let [m, n] = cuts[at(i, j)];
            if n == usize::MAX {
                parts.push(vec![polygon[i], polygon[m], polygon[j]]);
                open.extend([[m, j], [i, m]]);
            } else {
                parts.push(vec![polygon[i], polygon[m], polygon[n], polygon[j]]);
                open.extend([[n, j], [m, n], [i, m]]);
            }
        }
    }

    /// A chord that would be a second edge between its ends costs more than any split without it.
    fn chord_cost(&self, a: u32, b: u32) -> f64 {
        let taken = self.chords.contains(&[a.min(b), a.max(b)]) || {
            let mut ring = Vec::new();
            self.faces.ring(a, &mut ring);
            ring.iter().any(|&h| {
                let outer = super::intrinsic::previous(h);
                (self.faces.target(h) == b && self.edges[h as usize])
                    || (self.faces.origin[outer as usize] == b && self.edges[outer as usize])
            })
        };
        if taken { 1e6 } else { 0.0 }
    }

    fn face_cost(&self, face: &[u32]) -> f64 {
        let frame = self.metric.frame(face);
        let points = |i: usize| self.triangulation.points[face[i] as usize];
        let shaped = |q: DVec3| laid(frame.as_ref(), q).to_array();
        let up: DVec3 = face.iter().map(|&v| self.triangulation.tiles[v as usize].normal().as_dvec3()).sum();
        let (shape, face_normal, base) = match face.len() {
            3 => {
                let p = [points(0), points(1), points(2)];
                (triangle_shape(p.map(shaped)), (p[1] - p[0]).cross(p[2] - p[0]), TRIANGLE)
            }
            _ => {
                let p = [points(0), points(1), points(2), points(3)];
                (quad_shape(p.map(shaped)), (p[2] - p[0]).cross(p[3] - p[1]), 0.0)
            }
        };
        let folded = if shape <= 0.05 { FOLDED } else { 0.0 };
        let averted = if face_normal.dot(up) <= 0.0 { AVERTED } else { 0.0 };
        base + (1.0 - shape) + folded + averted
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::intrinsic::tests::plane;
    use crate::mosaic::Tile;
    use bytemuck::Zeroable;

    /// One hole in the plane, its tiles of side 1 turned along x and y.
    fn hole(points: &[[f64; 2]], triangles: &[[u32; 3]]) -> Triangulation {
        let tile = Tile { normal: [0.0, 0.0, 1.0], axis: [1.0, 0.0, 0.0], h: 1.0, ..Tile::zeroed() };
        Triangulation {
            faces: plane(points, triangles),
            tiles: vec![tile; points.len()],
            sides: vec![1.0; points.len()],
            points: points.iter().map(|&[x, y]| DVec3::new(x, y, 0.0)).collect(),
            sites: 0,
            extra: 0,
            factors: Vec::new(),
            same_place: (0..points.len() as u32).collect(),
        }
    }

    /// The faces that the outline of the hole, all of its edges, is filled with: vertices and faces in ascending order.
    fn filled(hole: &Triangulation, holes: Holes) -> Vec<Vec<u32>> {
        let outline: Vec<bool> = hole.faces.twin.iter().map(|twin| *twin == NONE).collect();
        let (mesh, count) = fill(hole, &outline, holes);
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
