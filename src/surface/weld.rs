//! Merges points at one place, and drops degenerate triangles and repeated ones.

use super::{Frame, Repairs, Soup, SurfaceError, caps};
use crate::progress::{ASKED_EVERY, Cancelled, Progress};
use glam::DVec3;
use rustc_hash::{FxHashMap, FxHashSet};
use std::collections::hash_map::Entry;

/// Points nearer than this, in diagonals of the bounding box, are merged: the resolution of f32 in unit-sized coordinates.
const WELD: f64 = 1e-7;
/// Coordinates that differ by so many steps of f32 are the same, where all of a file have single precision.
const STEPS: f32 = 4.0;
/// The most that these steps are, in diagonals: far from the origin they are larger than a shape's details.
const MOST_ROUNDING: f64 = 1e-6;

/// Unit-sized points without duplicates, and the triangles with three different corners.
pub(super) struct Welded {
    pub frame: Frame,
    pub points: Vec<DVec3>,
    pub triangles: Vec<[u32; 3]>,
    /// The index of each triangle in the soup.
    pub sources: Vec<u32>,
    pub repairs: Repairs,
}

impl Welded {
    /// Drops triangles that are there more than once.
    pub fn drop_repeated(&mut self) {
        let Self { frame, points, triangles, sources, repairs } = self;
        let mut seen = FxHashSet::default();
        let kept: Vec<usize> = (0..triangles.len())
            .filter(|&t| {
                let mut key = triangles[t];
                key.sort_unstable();
                let is_new = seen.insert(key);
                if !is_new {
                    repairs.duplicate_triangles.note(|| frame.near(points[key[0] as usize].into()));
                }
                is_new
            })
            .collect();
        *triangles = kept.iter().map(|&t| triangles[t]).collect();
        *sources = kept.iter().map(|&t| sources[t]).collect();
    }

    /// Whether any triangle has an area.
    pub fn has_area(&self) -> bool {
        self.triangles.iter().any(|t| {
            let [a, b, c] = t.map(|v| self.points[v as usize]);
            (b - a).cross(c - a).length() > f64::EPSILON
        })
    }
}

/// The frame of the points that triangles use, and which these are.
///
/// # Errors
/// Where there are no triangles, or coordinates cannot be computed with.
pub(super) fn frame(soup: &Soup) -> Result<(Frame, Vec<bool>), SurfaceError> {
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
    Ok((frame_of(soup, &used)?, used))
}

/// Merges used points no farther apart than `tolerance`, in diagonals, or at one place; drops triangles without area and
/// repeated ones.
pub(super) fn weld(
    soup: &Soup,
    frame: Frame,
    used: &[bool],
    tolerance: Option<f64>,
    progress: &Progress,
) -> Result<Welded, Cancelled> {
    let mut repairs = Repairs::default();
    for (point, _) in soup.points.iter().zip(used).filter(|&(_, &used)| !used) {
        repairs.unused_points.note(|| *point);
    }
    let tolerance = tolerance.unwrap_or_else(|| rounding(soup, used, &frame)).max(WELD);
    let (place, points) = join(soup, used, &frame, tolerance, &mut repairs, progress)?;
    let mut seen: FxHashMap<[u32; 3], usize> = FxHashMap::default();
    let mut triangles: Vec<[u32; 3]> = Vec::with_capacity(soup.triangles.len());
    let mut sources = Vec::with_capacity(soup.triangles.len());
    let mut doubled = Vec::new();
    for (source, given) in (0..).zip(&soup.triangles) {
        if (source as usize).is_multiple_of(ASKED_EVERY) {
            progress.check()?;
        }
        let corners = given.map(|index| place[index as usize]);
        let [a, b, c] = corners;
        let first = || soup.points[given[0] as usize];
        if a == b || b == c || c == a {
            repairs.degenerate_triangles.note(first);
            continue;
        }
        let mut key = corners;
        key.sort_unstable();
        match seen.entry(key) {
            Entry::Vacant(entry) => {
                entry.insert(triangles.len());
                triangles.push(corners);
                sources.push(source);
            }
            // Two sides of a line enclose nothing.
            Entry::Occupied(entry) if caps::is_cap(corners.map(|v| points[v as usize])) => {
                repairs.degenerate_triangles.note(first);
                doubled.push(*entry.get());
            }
            Entry::Occupied(_) => repairs.duplicate_triangles.note(first),
        }
    }
    if !doubled.is_empty() {
        doubled.sort_unstable();
        doubled.dedup();
        for &t in &doubled {
            repairs.degenerate_triangles.note(|| soup.points[soup.triangles[sources[t] as usize][0] as usize]);
        }
        let kept = |t: &usize| doubled.binary_search(t).is_err();
        (triangles, sources) = (0..triangles.len()).filter(kept).map(|t: usize| (triangles[t], sources[t])).unzip();
    }
    Ok(Welded { frame, points, triangles, sources, repairs })
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
    if soup.triangles.is_empty() {
        return Err(SurfaceError::Empty);
    }
    if (high - low).max_element() <= 0.0 {
        return Err(SurfaceError::NoArea { given: soup.triangles.len() });
    }
    Ok(Frame::of_box(low, high))
}

/// The distance, in diagonals, over which coordinates of single precision differ by rounding; 0 for others.
fn rounding(soup: &Soup, used: &[bool], frame: &Frame) -> f64 {
    let coordinates = soup.points.iter().zip(used).filter(|&(_, &used)| used).flat_map(|(point, _)| *point);
    let step = single_step(coordinates).unwrap_or(0.0);
    (f64::from(STEPS * step) / frame.diagonal).min(MOST_ROUNDING)
}

/// The step of single precision at the largest of some coordinates; `None` where one is finer.
pub(super) fn single_step(mut coordinates: impl Iterator<Item = f64>) -> Option<f32> {
    let larger = |most: f32, x: f64| (f64::from(x as f32) == x).then_some(most.max((x as f32).abs()));
    coordinates.try_fold(0.0, larger).map(|largest| largest.next_up() - largest)
}

/// The index of each used point among the joined points, and these, in unit-sized coordinates. Joined points are farther
/// apart than the tolerance.
fn join(
    soup: &Soup,
    used: &[bool],
    frame: &Frame,
    tolerance: f64,
    repairs: &mut Repairs,
    progress: &Progress,
) -> Result<(Vec<u32>, Vec<DVec3>), Cancelled> {
    let cell = 4.0 * tolerance;
    let mut points: Vec<DVec3> = Vec::new();
    let mut cells: FxHashMap<[i64; 3], Vec<u32>> = FxHashMap::default();
    let mut place = vec![super::NONE; soup.points.len()];
    let mut widest: f64 = 0.0;
    for (index, point) in soup.points.iter().enumerate().filter(|&(i, _)| used[i]) {
        if index.is_multiple_of(ASKED_EVERY) {
            progress.check()?;
        }
        let p = DVec3::from(frame.to_unit(*point));
        let [low, high] = [p - tolerance, p + tolerance].map(|q| (q / cell).floor().as_i64vec3().to_array());
        let mut found = None;
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                for z in low[2]..=high[2] {
                    let near = cells.get(&[x, y, z]).into_iter().flatten().copied();
                    found = near.filter(|&i| points[i as usize].distance(p) <= tolerance).chain(found).min();
                }
            }
        }
        place[index] = if let Some(found) = found {
            repairs.welded_points.note(|| *point);
            widest = widest.max(points[found as usize].distance(p));
            found
        } else {
            points.push(p);
            let new = points.len() as u32 - 1;
            cells.entry((p / cell).floor().as_i64vec3().to_array()).or_default().push(new);
            new
        };
    }
    repairs.largest_gap = widest * frame.diagonal;
    Ok((place, points))
}
