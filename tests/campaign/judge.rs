//! Topology, orientation and crossings, by the definitions and apart from the library.

use glam::DVec3;
use quadmosaic::surface::Soup;
use rstar::{AABB, PointDistance, RTree, RTreeObject};
use std::collections::{BTreeMap, BTreeSet};

/// The Euler characteristic of faces: vertices in use - edges + faces.
pub fn euler<'a>(faces: impl Iterator<Item = &'a [u32]>) -> i64 {
    let (mut vertices, mut edges, mut count) = (BTreeSet::new(), BTreeSet::new(), 0);
    for face in faces {
        count += 1;
        for (a, b) in sides(face) {
            vertices.insert(a);
            edges.insert([a.min(b), a.max(b)]);
        }
    }
    vertices.len() as i64 - edges.len() as i64 + count
}

fn sides(face: &[u32]) -> impl Iterator<Item = (u32, u32)> {
    face.iter().copied().zip(face.iter().copied().cycle().skip(1))
}

/// Which side of a mesh is outside.
#[derive(Clone, Copy, PartialEq)]
pub enum Sense {
    /// That of the surface.
    OfSurface,
    /// That of the surface or the other one, one for each sheet: the part that edges of two faces connect.
    OfSheets,
}

/// The sense in which the mesh of a surface is oriented: that of an open one is free.
pub fn sense(soup: &Soup) -> Sense {
    let closed = edges(soup.triangles.iter().map(|t| &t[..])).values().all(|faces| faces.len() == 2);
    if closed { Sense::OfSurface } else { Sense::OfSheets }
}

/// The faces at each edge.
fn edges<'a>(faces: impl Iterator<Item = &'a [u32]>) -> BTreeMap<[u32; 2], Vec<usize>> {
    let mut edges: BTreeMap<[u32; 2], Vec<usize>> = BTreeMap::new();
    for (index, face) in faces.enumerate() {
        sides(face).for_each(|(a, b)| edges.entry([a.min(b), a.max(b)]).or_default().push(index));
    }
    edges
}

struct Triangle {
    corners: [DVec3; 3],
    normal: DVec3,
    index: usize,
}

impl RTreeObject for Triangle {
    type Envelope = AABB<[f64; 3]>;

    fn envelope(&self) -> Self::Envelope {
        AABB::from_points(&self.corners.map(|p| p.to_array()))
    }
}

impl PointDistance for Triangle {
    fn distance_2(&self, point: &[f64; 3]) -> f64 {
        let p = DVec3::from(*point);
        let [a, b, c] = self.corners;
        let sides = [(a, b), (b, c), (c, a)];
        if sides.iter().all(|&(a, b)| (b - a).cross(p - a).dot(self.normal) >= 0.0) && self.normal != DVec3::ZERO {
            return (p - a).dot(self.normal).powi(2);
        }
        let to_side = |(a, b): (DVec3, DVec3)| {
            let along = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
            p.distance_squared(a + (b - a) * along)
        };
        sides.map(to_side).into_iter().fold(f64::MAX, f64::min)
    }
}

fn tree(soup: &Soup) -> RTree<Triangle> {
    let triangle = |(index, t): (usize, &[u32; 3])| {
        let corners = t.map(|v| DVec3::from(soup.points[v as usize]));
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or_zero();
        Triangle { corners, normal, index }
    };
    RTree::bulk_load(soup.triangles.iter().enumerate().map(triangle).collect())
}

/// A triangle of the surface is near a face where it is farther than the nearest one by at most this, in mean sides of the face.
const NEAR: f64 = 0.25;
/// A face is opposed to a triangle where the cosine of the angle between their normals is below this.
const AGAINST: f64 = -0.1;

/// The number of faces whose normals oppose those of all triangles near their middles.
pub fn opposed(points: &[[f64; 3]], faces: &[&[u32]], soup: &Soup, sense: Sense) -> usize {
    let tree = tree(soup);
    let against = |face: &&[u32]| {
        let corners: Vec<DVec3> = face.iter().map(|&v| points[v as usize].into()).collect();
        let middle = corners.iter().sum::<DVec3>() / corners.len() as f64;
        let pairs = || corners.iter().zip(corners.iter().cycle().skip(1));
        let normal = pairs().map(|(a, b)| (a - middle).cross(b - middle)).sum::<DVec3>().normalize_or_zero();
        let reach = NEAR * pairs().map(|(a, b)| a.distance(*b)).sum::<f64>() / corners.len() as f64;
        let mut nearest = tree.nearest_neighbor_iter_with_distance_2(middle.to_array()).peekable();
        let limit = nearest.peek().map_or(0.0, |(_, squared)| squared.sqrt()) + reach;
        let near = nearest.take_while(|(_, squared)| squared.sqrt() <= limit);
        let cosines: Vec<f64> = near.map(|(triangle, _)| normal.dot(triangle.normal)).collect();
        // Against the normals, and against the other side's.
        [1.0, -1.0].map(|side| cosines.iter().all(|cosine| side * cosine < AGAINST))
    };
    let found: Vec<[bool; 2]> = faces.iter().map(against).collect();
    if sense == Sense::OfSurface {
        return found.iter().filter(|[against, _]| *against).count();
    }
    let mut counts: BTreeMap<usize, [usize; 2]> = BTreeMap::new();
    for (sheet, against) in sheets(faces).into_iter().zip(found) {
        let count = counts.entry(sheet).or_default();
        (0..2).for_each(|side| count[side] += usize::from(against[side]));
    }
    counts.values().map(|[a, b]| a.min(b)).sum()
}

/// The sheet of each face.
fn sheets(faces: &[&[u32]]) -> Vec<usize> {
    let mut parent: Vec<usize> = (0..faces.len()).collect();
    let mut root = |mut face: usize, join: Option<usize>| {
        while parent[face] != face {
            parent[face] = parent[parent[face]];
            face = parent[face];
        }
        if let Some(to) = join {
            parent[face] = to;
        }
        face
    };
    for pair in edges(faces.iter().copied()).values() {
        if let &[a, b] = &pair[..] {
            let to = root(b, None);
            root(a, Some(to));
        }
    }
    (0..faces.len()).map(|face| root(face, None)).collect()
}

/// Why a surface is not clean, as one of its places: sides that are not run along once each way, the wrong
/// side outside, triangles without area, triangles that cut each other. `joined`: more than two triangles may meet at an edge.
pub fn unclean(soup: &Soup, joined: bool) -> Option<String> {
    let mut ways: BTreeMap<(u32, u32), usize> = BTreeMap::new();
    soup.triangles.iter().flat_map(|t| sides(t)).for_each(|side| *ways.entry(side).or_default() += 1);
    let back = |&(a, b): &(u32, u32)| ways.get(&(b, a)).copied().unwrap_or_default();
    let wrong = |side: &(u32, u32), count: usize| count > 1 && !(joined && count + back(side) > 2);
    if let Some((side, count)) = ways.iter().find(|(side, count)| wrong(side, **count)) {
        return Some(format!("side {side:?} is run along {count} times"));
    }
    let corners = |t: &[u32; 3]| t.map(|v| DVec3::from(soup.points[v as usize]));
    let volume: f64 = soup.triangles.iter().map(corners).map(|[a, b, c]| a.dot(b.cross(c))).sum();
    if !joined && sense(soup) == Sense::OfSurface && volume <= 0.0 {
        return Some("its inside is outside".to_owned());
    }
    let tree = tree(soup);
    if let Some(flat) = tree.iter().find(|triangle| triangle.normal == DVec3::ZERO) {
        return Some(format!("triangle {} has no area", flat.index));
    }
    for triangle in &tree {
        let mine = soup.triangles[triangle.index];
        for other in tree.locate_in_envelope_intersecting(triangle.envelope()) {
            let theirs = soup.triangles[other.index];
            for (a, b) in sides(&theirs) {
                let ends = [a, b].map(|v| DVec3::from(soup.points[v as usize]));
                if !mine.contains(&a) && !mine.contains(&b) && cuts(ends, triangle) {
                    return Some(format!("triangle {} cuts triangle {}", other.index, triangle.index));
                }
            }
        }
    }
    None
}

/// Whether a side passes through a triangle.
fn cuts([p, q]: [DVec3; 2], triangle: &Triangle) -> bool {
    let [a, b, c] = triangle.corners;
    let [from, to] = [p, q].map(|end| (end - a).dot(triangle.normal));
    if from * to >= 0.0 {
        return false;
    }
    let at = p.lerp(q, from / (from - to));
    [(a, b), (b, c), (c, a)].iter().all(|&(a, b)| (b - a).cross(at - a).dot(triangle.normal) > 0.0)
}
