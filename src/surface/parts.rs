//! Connected parts of welded triangles, and the dropping of small ones.

use super::weld::Welded;
use super::{NONE, SurfaceError};
use crate::sets::Sets;
use glam::DVec3;

/// A part that is smaller than this along every axis, in diagonals of the bounding box, is dropped: it has some hundred steps of
/// f32.
const SPECK: f64 = 1e-5;

/// The connected parts; triangles that share a vertex are connected.
pub(super) struct Parts {
    /// The part of each triangle.
    pub of_triangle: Vec<u32>,
    /// The first triangle of each part.
    firsts: Vec<u32>,
    /// The extent of each part's bounding box.
    extents: Vec<DVec3>,
}

impl Parts {
    pub fn new(points: &[DVec3], triangles: &[[u32; 3]]) -> Self {
        let mut sets = Sets::new(points.len());
        for &[a, b, c] in triangles {
            sets.join(a, b);
            sets.join(b, c);
        }
        let mut number = vec![NONE; points.len()];
        let (mut of_triangle, mut firsts) = (Vec::with_capacity(triangles.len()), Vec::new());
        let mut boxes: Vec<[DVec3; 2]> = Vec::new();
        for (t, corners) in (0..).zip(triangles) {
            let id = &mut number[sets.root(corners[0]) as usize];
            if *id == NONE {
                *id = boxes.len() as u32;
                boxes.push([DVec3::INFINITY, DVec3::NEG_INFINITY]);
                firsts.push(t);
            }
            let [low, high] = &mut boxes[*id as usize];
            for &v in corners {
                (*low, *high) = (low.min(points[v as usize]), high.max(points[v as usize]));
            }
            of_triangle.push(*id);
        }
        Self { of_triangle, firsts, extents: boxes.iter().map(|[low, high]| *high - *low).collect() }
    }

    /// The number of parts.
    pub fn count(&self) -> usize {
        self.firsts.len()
    }
}

/// Drops parts that are too small for f32, and those with a bounding box whose diagonal is below `limit`.
///
/// # Errors
/// Where `limit` leaves none.
pub(super) fn drop_small(welded: &mut Welded, limit: Option<f64>) -> Result<(), SurfaceError> {
    let parts = Parts::new(&welded.points, &welded.triangles);
    let is_speck: Vec<bool> = parts.extents.iter().map(|extent| extent.max_element() < SPECK).collect();
    let is_small: Vec<bool> =
        parts.extents.iter().map(|extent| limit.is_some_and(|least| extent.length() < least)).collect();
    if let Some(limit) = limit
        && !parts.extents.is_empty()
        && is_small.iter().all(|&small| small)
    {
        let largest = parts.extents.iter().map(|extent| extent.length()).fold(0.0, f64::max);
        let [limit, largest] = [limit, largest].map(|length| length * welded.frame.diagonal);
        return Err(SurfaceError::AllPartsSmall { limit, largest });
    }
    for part in 0..parts.count() {
        let place = welded.points[welded.triangles[parts.firsts[part] as usize][0] as usize];
        let frame = welded.frame;
        match (is_speck[part], is_small[part]) {
            (true, _) => welded.repairs.dropped_specks.note(|| frame.near(place.into())),
            (false, true) => welded.repairs.dropped_parts.note(|| frame.near(place.into())),
            (false, false) => {}
        }
    }
    let goes = |part: u32| is_speck[part as usize] || is_small[part as usize];
    if (0..parts.count() as u32).any(goes) {
        let kept: Vec<usize> = (0..welded.triangles.len()).filter(|&t| !goes(parts.of_triangle[t])).collect();
        welded.triangles = kept.iter().map(|&t| welded.triangles[t]).collect();
        welded.sources = kept.iter().map(|&t| welded.sources[t]).collect();
    }
    Ok(())
}
