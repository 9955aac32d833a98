//! Joins points that are the same place and drops triangles that are none.

use super::{Frame, Soup, SurfaceError};
use glam::{DVec3, Vec3};
use rustc_hash::{FxHashMap, FxHashSet};
use serde::Serialize;

/// Points nearer than this, in diagonals of the bounding box, are one: the resolution of f32 in unit-sized coordinates.
const WELD: f64 = 1e-7;

/// What was mended on the way from soup to surface.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Repairs {
    /// Points that were joined to another at the same place.
    pub welded_points: usize,
    /// Points that no triangle uses.
    pub unused_points: usize,
    /// Triangles without area that were dropped.
    pub degenerate_triangles: usize,
    /// Triangles that were given more than once, orientation aside.
    pub duplicate_triangles: usize,
    /// Triangles that were turned over.
    pub flipped_triangles: usize,
    /// Vertices where separate fans of triangles touched, now one vertex a fan.
    pub split_vertices: usize,
}

type Welded = (Frame, Vec<Vec3>, Vec<[u32; 3]>, Repairs);

/// Unit-sized points without doubles, and the triangles that keep three different corners.
pub(super) fn weld(soup: &Soup) -> Result<Welded, SurfaceError> {
    let mut repairs = Repairs::default();
    let mut used = vec![false; soup.points.len()];
    for (triangle, corners) in soup.triangles.iter().enumerate() {
        for &index in corners {
            *used.get_mut(index as usize).ok_or(SurfaceError::IndexOutOfRange {
                triangle,
                index,
                points: soup.points.len(),
            })? = true;
        }
    }
    repairs.unused_points = used.iter().filter(|&&u| !u).count();
    let frame = frame_of(soup, &used)?;

    let (place, points) = join(soup, &used, &frame);
    repairs.welded_points = soup.points.len() - repairs.unused_points - points.len();

    let mut seen = FxHashSet::default();
    let mut triangles = Vec::with_capacity(soup.triangles.len());
    for corners in &soup.triangles {
        let corners = corners.map(|index| place[index as usize]);
        let [a, b, c] = corners;
        if a == b || b == c || c == a {
            repairs.degenerate_triangles += 1;
            continue;
        }
        let mut key = corners;
        key.sort_unstable();
        if seen.insert(key) {
            triangles.push(corners);
        } else {
            repairs.duplicate_triangles += 1;
        }
    }
    let any_area = triangles.iter().any(|t| {
        let [a, b, c] = t.map(|v| points[v as usize]);
        (b - a).cross(c - a).length() > f64::EPSILON
    });
    if !any_area {
        return Err(SurfaceError::Empty { given: soup.triangles.len() });
    }
    Ok((frame, points.iter().map(|p| p.as_vec3()).collect(), triangles, repairs))
}

fn frame_of(soup: &Soup, used: &[bool]) -> Result<Frame, SurfaceError> {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for (point, p) in soup.points.iter().enumerate().filter(|&(i, _)| used[i]) {
        let p = DVec3::from(*p);
        if !p.is_finite() || p.abs().max_element() > 1e150 {
            return Err(SurfaceError::NotFinite { point });
        }
        (low, high) = (low.min(p), high.max(p));
    }
    // Scaled first, so that squares of very small extents do not underflow.
    let extent = high - low;
    let largest = extent.max_element();
    if largest.is_nan() || largest <= 0.0 {
        return Err(SurfaceError::Empty { given: soup.triangles.len() });
    }
    let diagonal = largest * (extent / largest).length();
    Ok(Frame { centre: (low + extent / 2.0).into(), diagonal })
}

/// The index of each used point among the joined points, and these, in unit-sized coordinates.
fn join(soup: &Soup, used: &[bool], frame: &Frame) -> (Vec<u32>, Vec<DVec3>) {
    let cell = 4.0 * WELD;
    let mut points: Vec<DVec3> = Vec::new();
    let mut cells: FxHashMap<[i64; 3], Vec<u32>> = FxHashMap::default();
    let mut place = vec![super::NONE; soup.points.len()];
    for (index, point) in soup.points.iter().enumerate().filter(|&(i, _)| used[i]) {
        let p = DVec3::from(frame.to_unit(*point));
        let [low, high] = [p - WELD, p + WELD].map(|q| (q / cell).floor().as_i64vec3().to_array());
        let mut found = None;
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                for z in low[2]..=high[2] {
                    let near = cells.get(&[x, y, z]).into_iter().flatten().copied();
                    found = near.filter(|&i| points[i as usize].distance(p) <= WELD).chain(found).min();
                }
            }
        }
        place[index] = found.unwrap_or_else(|| {
            points.push(p);
            let new = points.len() as u32 - 1;
            cells.entry((p / cell).floor().as_i64vec3().to_array()).or_default().push(new);
            new
        });
    }
    (place, points)
}
