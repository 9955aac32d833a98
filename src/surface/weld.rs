//! Merges points at one place, and drops degenerate triangles and parts that are too small for f32.

use super::{Frame, Repairs, Soup, SurfaceError};
use crate::sets::Sets;
use glam::{DVec3, Vec3};
use rustc_hash::{FxHashMap, FxHashSet};

/// Points nearer than this, in diagonals of the bounding box, are merged: the resolution of f32 in unit-sized coordinates.
const WELD: f64 = 1e-7;

/// A part that is smaller than this along every axis, in diagonals of the bounding box, is dropped: it has some hundred steps of
/// f32.
const SPECK: f64 = 1e-5;

/// Unit-sized points without duplicates, and the triangles with three different corners.
pub(super) struct Welded {
    pub frame: Frame,
    pub points: Vec<Vec3>,
    pub triangles: Vec<[u32; 3]>,
    /// The index of each triangle in the soup.
    pub sources: Vec<u32>,
    pub repairs: Repairs,
}

/// Merges points at one place, and drops triangles without area and duplicates.
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
    for (point, _) in soup.points.iter().zip(&used).filter(|&(_, &used)| !used) {
        repairs.unused_points.note(|| *point);
    }
    let frame = frame_of(soup, &used)?;

    let (place, points) = join(soup, &used, &frame, &mut repairs);
    let mut seen = FxHashSet::default();
    let mut triangles = Vec::with_capacity(soup.triangles.len());
    let mut sources = Vec::with_capacity(soup.triangles.len());
    for (source, given) in (0..).zip(&soup.triangles) {
        let corners = given.map(|index| place[index as usize]);
        let [a, b, c] = corners;
        let first = || soup.points[given[0] as usize];
        if a == b || b == c || c == a {
            repairs.degenerate_triangles.note(first);
            continue;
        }
        let mut key = corners;
        key.sort_unstable();
        if seen.insert(key) {
            triangles.push(corners);
            sources.push(source);
        } else {
            repairs.duplicate_triangles.note(first);
        }
    }
    let speck = specks(&points, &triangles);
    let part_place = |t: usize| soup.points[soup.triangles[sources[t] as usize][0] as usize];
    for (part, _) in speck.firsts.iter().zip(&speck.is_speck).filter(|&(_, &speck)| speck) {
        repairs.dropped_specks.note(|| part_place(*part as usize));
    }
    let keep = |t: &usize| !speck.is_speck[speck.part[*t] as usize];
    if repairs.dropped_specks.count > 0 {
        sources = (0..triangles.len()).filter(keep).map(|t| sources[t]).collect();
        triangles = (0..triangles.len()).filter(keep).map(|t| triangles[t]).collect();
    }
    let any_area = triangles.iter().any(|t| {
        let [a, b, c] = t.map(|v| points[v as usize]);
        (b - a).cross(c - a).length() > f64::EPSILON
    });
    if !any_area {
        return Err(SurfaceError::NoArea { given: soup.triangles.len() });
    }
    Ok(Welded { frame, points: points.iter().map(|&p| on_grid(p)).collect(), triangles, sources, repairs })
}

/// The nearest point whose coordinates are multiples of 2^-24, the resolution of f32 at the rim of the bounding box. With a finer
/// middle, the mesh of a model would depend on its distance from the origin.
fn on_grid(p: DVec3) -> Vec3 {
    const STEPS: f64 = (1 << 24) as f64;
    ((p * STEPS).round() / STEPS).as_vec3()
}

/// The connected parts.
struct Parts {
    /// The part of each triangle.
    part: Vec<u32>,
    /// A triangle of each part.
    firsts: Vec<u32>,
    /// Whether each part is too small to have a shape.
    is_speck: Vec<bool>,
}

fn specks(points: &[DVec3], triangles: &[[u32; 3]]) -> Parts {
    let mut sets = Sets::new(points.len());
    for &[a, b, c] in triangles {
        sets.join(a, b);
        sets.join(b, c);
    }
    let mut number = vec![super::NONE; points.len()];
    let mut parts = Parts { part: Vec::with_capacity(triangles.len()), firsts: Vec::new(), is_speck: Vec::new() };
    let mut boxes: Vec<[DVec3; 2]> = Vec::new();
    for (t, corners) in triangles.iter().enumerate() {
        let id = &mut number[sets.root(corners[0]) as usize];
        if *id == super::NONE {
            *id = boxes.len() as u32;
            boxes.push([DVec3::INFINITY, DVec3::NEG_INFINITY]);
            parts.firsts.push(t as u32);
        }
        let [low, high] = &mut boxes[*id as usize];
        for &v in corners {
            (*low, *high) = (low.min(points[v as usize]), high.max(points[v as usize]));
        }
        parts.part.push(*id);
    }
    parts.is_speck = boxes.iter().map(|[low, high]| (*high - *low).max_element() < SPECK).collect();
    parts
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
    if soup.triangles.is_empty() {
        return Err(SurfaceError::Empty);
    }
    if largest <= 0.0 {
        return Err(SurfaceError::NoArea { given: soup.triangles.len() });
    }
    let diagonal = largest * (extent / largest).length();
    Ok(Frame { centre: (low + extent / 2.0).into(), diagonal })
}

/// The index of each used point among the joined points, and these, in unit-sized coordinates.
fn join(soup: &Soup, used: &[bool], frame: &Frame, repairs: &mut Repairs) -> (Vec<u32>, Vec<DVec3>) {
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
        place[index] = if let Some(found) = found {
            repairs.welded_points.note(|| *point);
            found
        } else {
            points.push(p);
            let new = points.len() as u32 - 1;
            cells.entry((p / cell).floor().as_i64vec3().to_array()).or_default().push(new);
            new
        };
    }
    (place, points)
}
