//! Vertices on feature curves slide to where the edges between them are nearest to the curve.
//!
//! # Theory
//! Where a curve bends within a tile, as at the nose of a wing's section, the edge between two vertices cuts the bend off; by
//! how much depends on where the two lie. A vertex between two others on its curve tries places between them and goes where
//! the curve leaves the two edges least.
//!
//! # Practice
//! A vertex goes only where its faces keep a shape of 0.5 or get no worse. One whose edges follow the curve to 0.12 of their
//! length stays; with 0.05 Qg fell by 0.007 on plane and by 0.004 on anchor and pinion at 6,000 points.
//!
//! Done before the last touch and after it, the farthest point of the features and their 99th percentile come from 0.277 and
//! 0.258 edges to 0.203 and 0.167 on m6_gen, whose wing has a nose narrower than a tile; done once, before or after, to 0.222
//! and 0.204. On plane p99 comes from 0.137 to 0.117, and Qg from 0.912 to 0.910.

use super::curves::Curves;
use super::smooth::{Smoothed, Standing};
use super::{Mesh, Metric};
use crate::surface::Surface;
use glam::DVec3;

/// Rounds over the vertices.
const ROUNDS: usize = 4;
/// Edges may be so far from their curve, in edges.
const CLOSE: f64 = 0.12;
/// A move must bring the edges nearer by this share.
const GAIN: f64 = 0.05;
/// Shapes above this may fall to it.
const FLOOR: f64 = 0.5;

/// Slides vertices along feature curves that edges are far from; shapes are measured in a metric.
pub fn follow(metric: &Metric, surface: &Surface, smoothed: &Smoothed) -> Smoothed {
    let mut result = smoothed.clone();
    let on_curves: Vec<u32> = (0..).zip(&result.below).filter(|(_, below)| below.is_none()).map(|(v, _)| v).collect();
    if on_curves.is_empty() {
        return result;
    }
    let curves = Curves::new(surface);
    let mut standing = Standing::new(metric, &result.mesh);
    let mut waiting = on_curves;
    for _ in 0..ROUNDS {
        waiting.retain(|&v| {
            let Some(place) = better(&curves, &standing, &result, v) else { return false };
            result.mesh.points[v as usize] = place.into();
            standing.update(&result.mesh, &[], &[v]);
            true
        });
        let about = waiting.iter().flat_map(|&v| standing.incidence.faces_at(v as usize));
        let mut next: Vec<u32> = about.flat_map(|&f| result.mesh.face(f as usize)).copied().collect();
        next.retain(|&v| result.below[v as usize].is_none());
        next.sort_unstable();
        next.dedup();
        waiting = next;
    }
    result
}

/// The place on its curve where a vertex's edges follow it better.
fn better(curves: &Curves, standing: &Standing, Smoothed { mesh, below }: &Smoothed, v: u32) -> Option<DVec3> {
    let faces = standing.incidence.faces_at(v as usize);
    let about = faces.iter().flat_map(|&f| mesh.face(f as usize));
    let others = about.filter(|&&w| w != v && below[w as usize].is_none()).map(|&w| point(mesh, w));
    let places = curves.chords(point(mesh, v), others);
    let &(_, own) = places.first()?;
    if own < CLOSE * standing.incidence.edge(mesh, v) {
        return None;
    }
    let (least, _) = standing.judge(mesh, v);
    let may_go = |&&(place, off): &&(DVec3, f64)| {
        off < (1.0 - GAIN) * own && standing.judge_at(mesh, v, place).0 >= least.min(FLOOR)
    };
    places.iter().filter(may_go).min_by(|a, b| a.1.total_cmp(&b.1)).map(|&(place, _)| place)
}

fn point(mesh: &Mesh, v: u32) -> DVec3 {
    DVec3::from(mesh.points[v as usize])
}
