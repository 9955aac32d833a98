//! The order of painting: faces that are seen are painted over those that they hide.
//!
//! # Theory
//! Newell's algorithm needs to know which of two faces hides the other. The depth buffer tells: where a face is seen, all deeper
//! faces that cover the sample come first. These constraints are sorted topologically.
//!
//! # Practice
//! Faces that intersect, or hide each other in a cycle, have no such order. Of two, the one that is seen at more samples is above;
//! a cycle is opened at its farthest face. No face is divided.

use super::raster::Sight;
use rustc_hash::FxHashMap;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Faces that share a side are equally deep there, but for the last digits; in samples.
const EQUAL: f32 = 0.05;

/// The faces of this sorted list in the order of painting.
pub(super) fn painting_order(sight: &Sight, drawn: &[u32]) -> Vec<u32> {
    let far_first = far_first(sight, drawn);
    let mut place = vec![None; sight.scene.faces.len()];
    far_first.iter().enumerate().for_each(|(at, &face)| place[face as usize] = Some(at as u32));
    let hidings = hidings(sight, &place);

    let mut below = vec![0_u32; drawn.len()];
    hidings.iter().for_each(|&[_, above]| below[above as usize] += 1);
    let first = |at: u32| hidings.partition_point(|hiding| hiding[0] < at);
    let mut ready: BinaryHeap<Reverse<u32>> =
        (0..drawn.len() as u32).filter(|&at| below[at as usize] == 0).map(Reverse).collect();
    let mut done = vec![false; drawn.len()];
    let mut order = Vec::with_capacity(drawn.len());
    let mut farthest = 0..drawn.len() as u32;
    while order.len() < drawn.len() {
        let next = ready.pop().map(|next| next.0).or_else(|| farthest.find(|&at| !done[at as usize]));
        let Some(at) = next else { break };
        if std::mem::replace(&mut done[at as usize], true) {
            continue;
        }
        order.push(far_first[at as usize]);
        for &[_, above] in hidings[first(at)..].iter().take_while(|hiding| hiding[0] == at) {
            below[above as usize] -= 1;
            if below[above as usize] == 0 {
                ready.push(Reverse(above));
            }
        }
    }
    order
}

/// By the mean depth of their corners, what lies on the ground after the ground.
fn far_first(sight: &Sight, drawn: &[u32]) -> Vec<u32> {
    let depth = |face: u32| {
        let outline = sight.outline(&sight.scene.faces[face as usize]);
        let count = outline.len() as f64;
        outline.map(|corner| corner.z).sum::<f64>() / count
    };
    let mut keyed: Vec<(bool, f64, u32)> =
        drawn.iter().map(|&face| (face as usize >= sight.scene.ground, depth(face), face)).collect();
    keyed.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
    keyed.into_iter().map(|(.., face)| face).collect()
}

/// Pairs of places, sorted: the face at the first is hidden by the one at the second, more than the other way round.
fn hidings(sight: &Sight, place: &[Option<u32>]) -> Vec<[u32; 2]> {
    let found = sight.each_band(|band| {
        let mut pairs: FxHashMap<[u32; 2], i64> = FxHashMap::default();
        for &face in &band.faces {
            let Some(hidden) = place[face as usize] else { continue };
            sight.each_sample([band.top, band.seen.len()], face, |at, depth| {
                // A line has no depth of its own.
                let above = place.get(band.seen[at] as usize).copied().flatten();
                let Some(above) = above.filter(|&above| above != hidden && band.depth[at] > depth + EQUAL) else {
                    return;
                };
                *pairs.entry([hidden, above]).or_default() += 1;
            });
        }
        pairs
    });
    let mut samples: FxHashMap<[u32; 2], i64> = FxHashMap::default();
    found.into_iter().flatten().for_each(|(pair, count)| *samples.entry(pair).or_default() += count);
    let mut hidings: Vec<[u32; 2]> = samples
        .iter()
        .filter(|&(&[hidden, above], &count)| {
            let back = samples.get(&[above, hidden]).copied().unwrap_or(0);
            count > back || count == back && hidden < above
        })
        .map(|(&pair, _)| pair)
        .collect();
    hidings.sort_unstable();
    hidings
}
