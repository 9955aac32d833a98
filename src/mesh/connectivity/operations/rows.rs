//! Rows of quads between two triangles: one that can be taken out, one that can be put in.

use super::super::edit::Edit;
use glam::DVec3;

/// What each quad of a row costs beside the valences that it changes.
const LENGTH: f64 = 0.2;
/// What the last vertex of a row may make good.
const GAIN: f64 = 2.0;

/// Which rows are worth an edit.
#[derive(Clone, Copy)]
pub(super) struct Within {
    /// Quads.
    pub(super) longest: usize,
    /// Cost.
    pub(super) most: f64,
}

/// Takes out the row that begins beyond the side `x` to `y` of a triangle and ends with another triangle: its quads'
/// short sides are drawn together.
///
/// ```text
///      x---o---o           x
///    / |   |   | \        / \
///   z  |   |   |  w  ->  z---o---o---w      (each pair of the row becomes one vertex)
///    \ |   |   | /
///      y---o---o
/// ```
pub(super) fn take_out<'a>(edit: &Edit<'a>, triangle: u32, side: usize, within: Within) -> Option<(f64, Edit<'a>)> {
    let corners = edit.face(triangle);
    let [mut a, mut b, apex] = [0, 1, 2].map(|k| corners[(side + k) % 3]);
    let mut pairs = vec![(a, b)];
    let mut row = vec![triangle];
    let mut cost = less(edit, apex);
    loop {
        // The faces on both sides of a pair go, from both of its ends.
        let merged = edit.valence(a) as i32 + edit.valence(b) as i32 - 4;
        let wanted = if edit.is_free(b) { edit.wanted_valence(a) } else { edit.wanted_valence(b) };
        cost += f64::from(merged - wanted).powi(2) - edit.irregularity(a, 0) - edit.irregularity(b, 0) + LENGTH;
        if cost - GAIN > within.most {
            return None;
        }
        let face = edit.across(a, b)?;
        let corners = edit.face(face);
        if row.contains(&face) || corners.len() > 4 {
            return None;
        }
        row.push(face);
        if corners.len() == 3 {
            let last = *corners.iter().find(|v| ![a, b].contains(v))?;
            cost += less(edit, last);
            break;
        }
        if pairs.len() > within.longest {
            return None;
        }
        // The face runs from b to a, on to the next pair, and back.
        let at = corners.iter().position(|&v| v == b)?;
        (a, b) = (corners[(at + 2) % 4], corners[(at + 3) % 4]);
        if pairs.iter().any(|&(p, q)| [a, b].contains(&p) || [a, b].contains(&q)) {
            return None;
        }
        pairs.push((a, b));
    }
    if cost > within.most {
        return None;
    }
    let mut result = edit.clone();
    row.iter().for_each(|&face| result.set_face(face, &[]));
    for (a, b) in pairs {
        result.merge(a, b)?;
    }
    Some((cost, result))
}

/// What it costs a vertex to have a face less.
fn less(edit: &Edit, vertex: u32) -> f64 {
    edit.irregularity(vertex, -1) - edit.irregularity(vertex, 0)
}

/// A vertex of the line that a new row opens: its faces to the right and to the left of the way.
#[derive(Clone)]
struct Opening {
    vertex: u32,
    right: Vec<u32>,
    left: Vec<u32>,
}

/// All rows of at most `longest` quads that can be put in between a triangle's corner `apex` and another triangle that
/// looks the other way: each vertex of the line between the two becomes a pair, and the triangles become quads.
///
/// ```text
///   o           o           o---z---o---w---o
///   | \       / |           |   |   |   |   |
///   |  z--o--w  |      ->   |   |   |   |   |
///   | /       \ |           |   |   |   |   |
///   o           o           o---z'--o---w'--o
/// ```
pub(super) fn put_in<'a>(edit: &Edit<'a>, triangle: u32, apex: u32, within: Within) -> Vec<(f64, Edit<'a>)> {
    Lines::from(edit, triangle, apex, within).rows
}

/// The search for lines, as straight as the vertices on them allow.
struct Lines<'a, 'b> {
    edit: &'b Edit<'a>,
    triangle: u32,
    within: Within,
    line: Vec<Opening>,
    rows: Vec<(f64, Edit<'a>)>,
}

impl<'a, 'b> Lines<'a, 'b> {
    fn from(edit: &'b Edit<'a>, triangle: u32, apex: u32, within: Within) -> Self {
        let mut lines = Self { edit, triangle, within, line: Vec::new(), rows: Vec::new() };
        if edit.is_free(apex)
            && let Some(fan) = edit.fan(apex, triangle)
        {
            lines.leave(apex, &fan[1..], 0.0);
        }
        lines
    }

    /// Tries all ways between the faces, counter-clockwise, of a vertex that the line has come to; `cost` is that of the
    /// line so far.
    fn leave(&mut self, vertex: u32, fan: &[u32], cost: f64) {
        let cost = cost + LENGTH - self.edit.irregularity(vertex, 0);
        let halves = |right: usize, left: usize| {
            // Each copy has a quad of the row, or a triangle that becomes one, on either side.
            cost + (right as f64 - 2.0).powi(2) + (left as f64 - 2.0).powi(2)
        };
        for end in 1..fan.len().saturating_sub(1) {
            let cost = halves(end, fan.len() - end - 1);
            if cost <= self.within.most && self.edit.face(fan[end]).len() == 3 && fan[end] != self.triangle {
                self.line.push(Opening { vertex, right: fan[..end].to_vec(), left: fan[end + 1..].to_vec() });
                self.rows.extend(open(self.edit, self.triangle, fan[end], &self.line).map(|row| (cost, row)));
                self.line.pop();
            }
        }
        // The first vertex has the triangle beside these faces, and may be left to either side.
        let slack = usize::from(self.line.is_empty());
        for half in (fan.len() / 2 - slack).max(1)..=(fan.len().div_ceil(2) + slack).min(fan.len() - 1) {
            let cost = halves(half, fan.len() - half);
            if cost - 1.0 <= self.within.most && self.line.len() < self.within.longest {
                self.line.push(Opening { vertex, right: fan[..half].to_vec(), left: fan[half..].to_vec() });
                self.follow(cost);
                self.line.pop();
            }
        }
    }

    /// Goes on from the last vertex of the line, between its right and left faces.
    fn follow(&mut self, cost: f64) {
        let Opening { vertex: from, left, .. } = &self.line[self.line.len() - 1];
        let at = self.edit.beside(left[0], *from)[1];
        if !self.edit.is_free(at) || self.line.iter().any(|opening| opening.vertex == at) {
            return;
        }
        if let Some(fan) = self.edit.left(at, *from).and_then(|first| self.edit.fan(at, first)) {
            self.leave(at, &fan, cost);
        }
    }
}

/// Opens a line between two triangles: a quad for each of its edges, and one for each triangle.
fn open<'a>(edit: &Edit<'a>, start: u32, end: u32, line: &[Opening]) -> Option<Edit<'a>> {
    let mut result = edit.clone();
    let mut pairs = Vec::new();
    for Opening { vertex, right, left } in line {
        let copy = result.copy(*vertex);
        let here = edit.point(*vertex);
        let towards = |faces: &[u32]| {
            let corners = faces.iter().flat_map(|face| edit.face(*face));
            let middle = corners.clone().map(|v| edit.point(*v)).sum::<DVec3>() / corners.count().max(1) as f64;
            (here + middle) / 2.0
        };
        result.rename(*vertex, copy, |face| right.contains(&face))?;
        result.set_point(*vertex, towards(left));
        result.set_point(copy, towards(right));
        pairs.push([*vertex, copy]);
    }
    for pair in pairs.windows(2) {
        let [[a, a_right], [b, b_right]] = [pair[0], pair[1]];
        result.add_face(&[a, a_right, b_right, b]);
    }
    let [first, first_right] = pairs[0];
    let [y, x] = edit.beside(start, first);
    result.set_face(start, &[first_right, first, x, y]);
    let [last, last_right] = pairs[pairs.len() - 1];
    let [q, p] = edit.beside(end, last);
    result.set_face(end, &[last, last_right, p, q]);
    Some(result)
}
