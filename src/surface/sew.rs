//! Sews rims (open boundaries) that run side by side.
//!
//! # Practice
//! A vertex on a rim is inserted in the rims' other edges that are no farther from it than the tolerance, and the triangles there
//! are divided. Two rims side by side have the same edges then, whatever their chords were. No vertex moves.

use super::cuts::Cuts;
use super::edges::Edges;
use super::nearest::{Simplices, nearest_on_segment};
use super::weld::Welded;

/// Sews rims no farther apart than `tolerance`, in diagonals; welded points are farther apart than that.
pub(super) fn sew(welded: &mut Welded, tolerance: f64) {
    let edges = Edges::new(&welded.triangles);
    let (open, points) = (edges.open(), &welded.points);
    let tree = Simplices::<2>::new(open.iter().map(|edge| edge.map(|v| points[v as usize])));
    let mut rim = open.as_flattened().to_vec();
    rim.sort_unstable();
    rim.dedup();
    let mut cuts = Cuts::default();
    let mut widest: f64 = 0.0;
    for vertex in rim {
        let place = points[vertex as usize];
        let mut inserted = false;
        for found in tree.within(place, tolerance) {
            let edge = open[found.id as usize];
            if !edge.contains(&vertex) {
                let [start, end] = found.corners;
                widest = widest.max(nearest_on_segment(place, start, end).distance(place));
                cuts.insert(edge, vertex);
                inserted = true;
            }
        }
        if inserted {
            welded.repairs.sewn_vertices.note(|| welded.frame.near(place.into()));
        }
    }
    let gap = &mut welded.repairs.largest_gap;
    *gap = gap.max(widest * welded.frame.diagonal);
    cuts.apply(welded);
}
