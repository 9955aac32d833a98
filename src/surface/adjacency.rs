//! Which triangles meet at which edges; consistent orientation; one fan of triangles a vertex.

use super::{Frame, NONE, Repairs, SurfaceError, next, previous};
use glam::Vec3;
use rayon::prelude::*;
use std::collections::VecDeque;

/// Orients the triangles alike, closed components outward, gives each fan a vertex of its own and drops unused points.
///
/// Returns the opposite half-edge of each half-edge.
pub(super) fn orient(
    points: &mut Vec<Vec3>,
    triangles: &mut [[u32; 3]],
    frame: &Frame,
    repairs: &mut Repairs,
) -> Result<Vec<u32>, SurfaceError> {
    let pairs = pair(points, triangles, frame)?;
    let turned = turn(points, triangles, &pairs, frame)?;
    repairs.flipped_triangles = turned.iter().filter(|&&t| t).count();
    let twins = turn_over(triangles, pairs, &turned);
    repairs.split_vertices = one_fan_each(points, triangles, &twins);
    Ok(twins)
}

/// The other half-edge on the same two vertices, whatever its direction.
fn pair(points: &[Vec3], triangles: &[[u32; 3]], frame: &Frame) -> Result<Vec<u32>, SurfaceError> {
    let mut edges: Vec<(u64, u32)> = (0..3 * triangles.len() as u32)
        .into_par_iter()
        .map(|h| {
            let t = triangles[h as usize / 3];
            let (a, b) = (t[h as usize % 3], t[next(h) as usize % 3]);
            ((u64::from(a.min(b)) << 32) | u64::from(a.max(b)), h)
        })
        .collect();
    edges.par_sort_unstable();
    let mut pairs = vec![NONE; edges.len()];
    let mut crowded = Vec::new();
    for run in edges.chunk_by(|a, b| a.0 == b.0) {
        match *run {
            [_] => {}
            [(_, g), (_, h)] => {
                pairs[g as usize] = h;
                pairs[h as usize] = g;
            }
            _ => crowded.push(run[0].0),
        }
    }
    match crowded.first() {
        None => Ok(pairs),
        Some(key) => {
            let place = |v: u64| frame.to_model(points[v as usize].as_dvec3().into());
            Err(SurfaceError::NonManifoldEdge {
                count: crowded.len(),
                from: place(key >> 32),
                to: place(key & 0xffff_ffff),
            })
        }
    }
}

/// Which triangles have to be turned over.
fn turn(points: &[Vec3], triangles: &[[u32; 3]], pairs: &[u32], frame: &Frame) -> Result<Vec<bool>, SurfaceError> {
    let mut turned = vec![false; triangles.len()];
    let mut seen = vec![false; triangles.len()];
    let origin = |h: u32| triangles[h as usize / 3][h as usize % 3];
    for first in 0..triangles.len() {
        if seen[first] {
            continue;
        }
        seen[first] = true;
        let mut component = vec![first];
        let mut queue = VecDeque::from([first]);
        let mut closed = true;
        while let Some(t) = queue.pop_front() {
            for h in [0, 1, 2].map(|k| 3 * t as u32 + k) {
                let pair = pairs[h as usize];
                if pair == NONE {
                    closed = false;
                    continue;
                }
                let other = pair as usize / 3;
                let same_direction = origin(h) == origin(pair);
                let wanted = turned[t] ^ same_direction;
                if !seen[other] {
                    seen[other] = true;
                    turned[other] = wanted;
                    component.push(other);
                    queue.push_back(other);
                } else if turned[other] != wanted {
                    let at = frame.to_model(points[origin(h) as usize].as_dvec3().into());
                    return Err(SurfaceError::NotOrientable { triangle: t, at });
                }
            }
        }
        if closed {
            let volume: f64 = component
                .iter()
                .map(|&t| {
                    let [a, b, c] = triangles[t].map(|v| points[v as usize].as_dvec3());
                    a.dot(b.cross(c)) * if turned[t] { -1.0 } else { 1.0 }
                })
                .sum();
            if volume < 0.0 {
                component.iter().for_each(|&t| turned[t] ^= true);
            }
        } else if component.iter().filter(|&&t| turned[t]).count() * 2 > component.len() {
            component.iter().for_each(|&t| turned[t] ^= true);
        }
    }
    Ok(turned)
}

/// Turns triangles over (corners 1 and 2 change places) and renumbers the pairs of half-edges accordingly.
fn turn_over(triangles: &mut [[u32; 3]], pairs: Vec<u32>, turned: &[bool]) -> Vec<u32> {
    // With corners 1 and 2 exchanged, edge 0 becomes edge 2 and edge 2 becomes edge 0.
    let renumber = |h: u32| if turned[h as usize / 3] && h % 3 != 1 { h / 3 * 3 + (2 - h % 3) } else { h };
    let mut twins = vec![NONE; pairs.len()];
    for (h, &pair) in pairs.iter().enumerate() {
        if pair != NONE {
            twins[renumber(h as u32) as usize] = renumber(pair);
        }
    }
    for (triangle, &turned) in triangles.iter_mut().zip(turned) {
        if turned {
            triangle.swap(1, 2);
        }
    }
    twins
}

/// Gives every fan of triangles its own vertex and drops points without triangles; returns how many were added.
fn one_fan_each(points: &mut Vec<Vec3>, triangles: &mut [[u32; 3]], twins: &[u32]) -> usize {
    let corners = 3 * triangles.len();
    let mut fan = vec![NONE; corners];
    let mut fresh: Vec<Vec3> = Vec::with_capacity(points.len());
    let mut first_fan = vec![false; points.len()];
    let mut split = 0;
    for corner in 0..corners as u32 {
        if fan[corner as usize] != NONE {
            continue;
        }
        let vertex = triangles[corner as usize / 3][corner as usize % 3] as usize;
        split += usize::from(std::mem::replace(&mut first_fan[vertex], true));
        let id = fresh.len() as u32;
        fresh.push(points[vertex]);
        let mut at = corner;
        loop {
            fan[at as usize] = id;
            at = twins[previous(at) as usize];
            if at == NONE || at == corner {
                break;
            }
        }
        let mut at = corner;
        while at != NONE {
            fan[at as usize] = id;
            let twin = twins[at as usize];
            at = if twin == NONE { NONE } else { next(twin) };
            if at == corner {
                break;
            }
        }
    }
    for (t, triangle) in triangles.iter_mut().enumerate() {
        *triangle = [0, 1, 2].map(|k| fan[3 * t + k]);
    }
    *points = fresh;
    split
}
