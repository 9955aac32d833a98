//! The measures of a finished mesh.
//!
//! # Theory
//!
//! The paper, section 4: Qr is the share of quads among all elements, Qg and Tg are the mean shapes of quads and triangles
//! (Lee and Lo's measures there). Scaled Jacobian and the share of irregular vertices are the field's common additions.
//!
//! # Changes versus the paper
//!
//! The paper defines Qg and Tg so that larger is worse, but prints values below 1. Here both are reciprocals, as in its
//! figures: 1 is a square or an equilateral triangle, 0 a collapsed or reflex element.
//!
//! # Practice
//!
//! Read the least scaled Jacobian beside the means: one bad element spoils a simulation and does not show in a mean.

use super::{Edge, Mesh};
use glam::DVec3;
use serde::Serialize;

/// The distribution of a measure over the elements.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spread {
    /// Arithmetic mean.
    pub mean: f64,
    /// First percentile, linear between the two nearest elements.
    pub p01: f64,
    /// The worst element.
    pub min: f64,
}

impl Spread {
    fn of(mut values: Vec<f64>) -> Option<Self> {
        values.sort_unstable_by(f64::total_cmp);
        let min = *values.first()?;
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        Some(Self { mean, p01: percentile(&values, 0.01), min })
    }
}

/// The least, mean and largest value of a measure.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Range {
    /// The least value.
    pub min: f64,
    /// Arithmetic mean.
    pub mean: f64,
    /// The largest value.
    pub max: f64,
}

impl Range {
    /// That of some values; `None` where there are none.
    fn of(values: &[f64]) -> Option<Self> {
        let min = values.iter().copied().reduce(f64::min)?;
        let max = values.iter().copied().reduce(f64::max)?;
        Some(Self { min, mean: values.iter().sum::<f64>() / values.len() as f64, max })
    }
}

/// The percentile of sorted values, at least one, at a share; linear between the two nearest.
pub(super) fn percentile(sorted: &[f64], share: f64) -> f64 {
    let place = share * (sorted.len() - 1) as f64;
    let (low, rest) = (place as usize, place.fract());
    let high = (low + 1).min(sorted.len() - 1);
    sorted[low] * (1.0 - rest) + sorted[high] * rest
}

/// The measures of a mesh. A measure over elements that the mesh does not have is `None`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Quality {
    /// Number of vertices.
    pub vertices: usize,
    /// Number of quads.
    pub quads: usize,
    /// Number of triangles.
    pub triangles: usize,
    /// Number of faces with more than four sides.
    pub polygons: usize,
    /// Quads over elements; a face of k > 4 sides counts as k - 2 triangles, and so does an interior hole.
    pub qr: f64,
    /// Shape of the quads, see [`quad_shape`].
    pub qg: Option<Spread>,
    /// Shape of the triangles, see [`triangle_shape`].
    pub tg: Option<Spread>,
    /// Scaled Jacobian of the quads, see [`scaled_jacobian`].
    pub scaled_jacobian: Option<Spread>,
    /// Number of vertices that lie on a face and not on the boundary.
    pub interior_vertices: usize,
    /// Number of interior vertices whose valence is not 4.
    pub irregular_vertices: usize,
    /// Mean edge length.
    pub mean_edge: f64,
    /// Standard deviation of the edge length over its mean.
    pub edge_cv: f64,
    /// Edge lengths.
    pub edge: Option<Range>,
    /// Angles at the corners of the faces, in degrees, see [`corner_angles`].
    pub angle: Option<Range>,
    /// Warp of the quads, in degrees, see [`warp`].
    pub warp: Option<Range>,
}

impl Quality {
    /// The measures of a mesh without interior holes.
    pub fn of(mesh: &Mesh) -> Self {
        Self::with_holes(mesh, 0)
    }

    /// The measures of a mesh whose interior holes would take `hole_triangles` triangles to cover.
    pub fn with_holes(mesh: &Mesh, hole_triangles: usize) -> Self {
        let point = |vertex: u32| mesh.points[vertex as usize];
        let (mut triangle_shapes, mut quad_shapes, mut jacobians) = (Vec::new(), Vec::new(), Vec::new());
        let (mut angles, mut warps) = (Vec::with_capacity(mesh.corners.len()), Vec::new());
        let (mut polygons, mut covering) = (0, hole_triangles);
        for face in mesh.faces() {
            angles.extend(corner_angles(&face.iter().map(|&v| point(v)).collect::<Vec<_>>()));
            match *face {
                [a, b, c] => triangle_shapes.push(triangle_shape([a, b, c].map(point))),
                [a, b, c, d] => {
                    let corners = [a, b, c, d].map(point);
                    quad_shapes.push(quad_shape(corners));
                    jacobians.push(scaled_jacobian(corners));
                    warps.push(warp(corners));
                }
                _ => {
                    polygons += 1;
                    covering += face.len().saturating_sub(2);
                }
            }
        }
        let (quads, triangles) = (quad_shapes.len(), triangle_shapes.len());

        let edges = mesh.edges();
        let (valence, boundary) = valences(mesh, &edges);
        let lengths = mesh.lengths(&edges);
        let interior = || valence.iter().zip(&boundary).filter(|(valence, boundary)| **valence > 0 && !**boundary);
        let count = lengths.len().max(1) as f64;
        let mean_edge = lengths.iter().sum::<f64>() / count;
        let variance = lengths.iter().map(|length| (length - mean_edge).powi(2)).sum::<f64>() / count;

        Self {
            vertices: mesh.points.len(),
            quads,
            triangles,
            polygons,
            qr: quads as f64 / (quads + triangles + covering).max(1) as f64,
            qg: Spread::of(quad_shapes),
            tg: Spread::of(triangle_shapes),
            scaled_jacobian: Spread::of(jacobians),
            interior_vertices: interior().count(),
            irregular_vertices: interior().filter(|(valence, _)| **valence != 4).count(),
            mean_edge,
            edge_cv: if mean_edge > 0.0 { variance.sqrt() / mean_edge } else { 0.0 },
            edge: Range::of(&lengths),
            angle: Range::of(&angles),
            warp: Range::of(&warps),
        }
    }

    /// Irregular vertices as a share of the interior vertices.
    pub fn irregular(&self) -> f64 {
        self.irregular_vertices as f64 / self.interior_vertices.max(1) as f64
    }
}

/// The shape of a face (Qg of a quad, Tg of a triangle) and the scaled Jacobian of a quad; NaN for other faces.
pub(crate) fn measures_of(mesh: &Mesh, face: &[u32]) -> (f64, f64) {
    let point = |vertex: u32| mesh.points[vertex as usize];
    match *face {
        [a, b, c] => (triangle_shape([a, b, c].map(point)), f64::NAN),
        [a, b, c, d] => {
            let corners = [a, b, c, d].map(point);
            (quad_shape(corners), scaled_jacobian(corners))
        }
        _ => (f64::NAN, f64::NAN),
    }
}

/// The number of edges at each vertex, and whether it lies on the boundary.
pub(crate) fn valences(mesh: &Mesh, edges: &[Edge]) -> (Vec<u32>, Vec<bool>) {
    let mut valence = vec![0; mesh.points.len()];
    let mut boundary = vec![false; mesh.points.len()];
    for edge in edges {
        for end in edge.ends.map(|end| end as usize) {
            valence[end] += 1;
            boundary[end] |= edge.is_boundary();
        }
    }
    (valence, boundary)
}

/// Twice the signed area of each corner triangle against the quad's normal, which is the cross product of its diagonals.
fn corner_areas(q: [DVec3; 4]) -> [f64; 4] {
    let normal = (q[2] - q[0]).cross(q[3] - q[1]).normalize_or_zero();
    std::array::from_fn(|k| (q[(k + 1) % 4] - q[k]).cross(q[(k + 3) % 4] - q[k]).dot(normal))
}

/// The least area of a quad's corner triangles over their mean: 1 for a parallelogram, small where an edge is short or a corner is
/// nearly straight, negative where one is reflex.
pub(super) fn least_corner_share(corners: [DVec3; 4]) -> f64 {
    let areas = corner_areas(corners);
    let mean = areas.iter().sum::<f64>() / 4.0;
    if mean > 0.0 { areas.into_iter().fold(f64::INFINITY, f64::min) / mean } else { 0.0 }
}

/// The paper's Qg of one quad, as a reciprocal: 8 S_min / (sqrt2 h_max h_s), with h_max the longest side or diagonal, h_s
/// the root of the sum of squared sides and S_min the smallest signed area of the four corner triangles.
///
/// 1 for a square, 0 where a corner is reflex or the quad has collapsed.
pub fn quad_shape(corners: [[f64; 3]; 4]) -> f64 {
    let q = corners.map(DVec3::from);
    let sides: [DVec3; 4] = std::array::from_fn(|k| q[(k + 1) % 4] - q[k]);
    let diagonals = [q[2] - q[0], q[3] - q[1]];
    let normal = diagonals[0].cross(diagonals[1]);
    // The areas of opposite corners sum to the quad's area; all are multiplied by the length of the normal.
    let whole = normal.length_squared();
    let [first, second] = [sides[3].cross(sides[0]), sides[0].cross(sides[1])].map(|area| area.dot(normal));
    let smallest = first.min(whole - first).min(second.min(whole - second)) / 2.0;
    let squares = sides.map(|side| side.length_squared());
    let longest = squares.into_iter().chain(diagonals.map(|d| d.length_squared())).fold(0.0, f64::max);
    let scale = whole.sqrt() * (longest * squares.iter().sum::<f64>()).sqrt();
    if smallest > 0.0 && scale > 0.0 { 8.0 * smallest / (std::f64::consts::SQRT_2 * scale) } else { 0.0 }
}

/// The paper's Tg of one triangle, as a reciprocal: 4 sqrt3 S / (sum of squared sides).
///
/// 1 for an equilateral triangle, 0 for a collapsed one.
pub fn triangle_shape(corners: [[f64; 3]; 3]) -> f64 {
    let [a, b, c] = corners.map(DVec3::from);
    let squares = a.distance_squared(b) + b.distance_squared(c) + c.distance_squared(a);
    let area = (b - a).cross(c - a).length() / 2.0;
    if squares > 0.0 { 4.0 * 3.0_f64.sqrt() * area / squares } else { 0.0 }
}

/// The smallest sine of a quad's corners against its normal: 1 for a rectangle, negative where a corner is reflex.
pub fn scaled_jacobian(corners: [[f64; 3]; 4]) -> f64 {
    let q = corners.map(DVec3::from);
    let sides: [f64; 4] = std::array::from_fn(|k| q[k].distance(q[(k + 1) % 4]));
    let areas = corner_areas(q);
    (0..4)
        .map(|k| {
            let product = sides[k] * sides[(k + 3) % 4];
            if product > 0.0 { areas[k] / product } else { 0.0 }
        })
        .fold(f64::INFINITY, f64::min)
}

/// The angle at each corner of a face, in degrees: below 180 where the corner is convex against the face's normal, above where it is
/// reflex; 0 beside a side without length.
pub fn corner_angles(corners: &[[f64; 3]]) -> impl Iterator<Item = f64> {
    let count = corners.len();
    let at = move |k: usize| DVec3::from(corners[k % count]);
    let normal: DVec3 = (0..count).map(|k| (at(k) - at(0)).cross(at(k + 1) - at(0))).sum();
    (0..count).map(move |k| {
        let [next, last] = [at(k + 1) - at(k), at(k + count - 1) - at(k)];
        let angle = next.cross(last).length().atan2(next.dot(last)).to_degrees();
        if next.cross(last).dot(normal) < 0.0 { 360.0 - angle } else { angle }
    })
}

/// The angle, in degrees, between the normals of the triangles that a diagonal cuts a quad into, the larger one of both diagonals:
/// 0 where the quad is flat.
pub fn warp(corners: [[f64; 3]; 4]) -> f64 {
    let q = corners.map(DVec3::from);
    // The normal at each corner; a diagonal separates two opposite ones.
    let normals: [DVec3; 4] = std::array::from_fn(|k| (q[(k + 1) % 4] - q[k]).cross(q[(k + 3) % 4] - q[k]));
    let between = |a: DVec3, b: DVec3| a.cross(b).length().atan2(a.dot(b)).to_degrees();
    between(normals[0], normals[2]).max(between(normals[1], normals[3]))
}
