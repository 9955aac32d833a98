//! Rows of quads between two triangles: one that can be taken out, one that can be put in.

use super::draft::Draft;
use glam::DVec3;

/// What each quad of a row costs beside the valences that it changes.
const LENGTH: f64 = 0.2;
/// What the last vertex of a row may make good.
const GAIN: f64 = 2.0;

/// Which rows are worth a draft.
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
pub(super) fn take_out<'a>(draft: &Draft<'a>, triangle: u32, side: usize, within: Within) -> Option<(f64, Draft<'a>)> {
    let corners = draft.face(triangle);
    let [mut a, mut b, apex] = [0, 1, 2].map(|k| corners[(side + k) % 3]);
    let mut pairs = vec![(a, b)];
    let mut row = vec![triangle];
    let mut cost = less(draft, apex);
    loop {
        // The faces on both sides of a pair go, from both of its ends.
        let merged = draft.valence(a) as i32 + draft.valence(b) as i32 - 4;
        let ideal = if draft.is_fixed(b) { draft.ideal(b) } else { draft.ideal(a) };
        cost += f64::from(merged - ideal).powi(2) - draft.irregularity(a, 0) - draft.irregularity(b, 0) + LENGTH;
        if cost - GAIN > within.most {
            return None;
        }
        let face = draft.across(a, b)?;
        let corners = draft.face(face);
        if row.contains(&face) || corners.len() > 4 {
            return None;
        }
        row.push(face);
        if corners.len() == 3 {
            let last = *corners.iter().find(|v| ![a, b].contains(v))?;
            cost += less(draft, last);
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
    let mut result = draft.clone();
    row.iter().for_each(|&face| result.set_face(face, &[]));
    for (a, b) in pairs {
        let (stays, goes) = match (draft.is_fixed(a), draft.is_fixed(b)) {
            (true, true) => return None,
            (false, true) => (b, a),
            _ => (a, b),
        };
        if !draft.is_fixed(stays) {
            result.place(stays, (draft.point(a) + draft.point(b)) / 2.0);
        }
        rename(&mut result, goes, stays, |_| true)?;
    }
    Some((cost, result))
}

/// What it costs a vertex to have a face less.
fn less(draft: &Draft, vertex: u32) -> f64 {
    draft.irregularity(vertex, -1) - draft.irregularity(vertex, 0)
}

/// Gives `to` the faces of `from` that `which` names; `None` where one has more than four sides.
pub(super) fn rename(draft: &mut Draft, from: u32, to: u32, which: impl Fn(u32) -> bool) -> Option<()> {
    let faces: Vec<u32> = draft.around(from).filter(|face| which(*face)).collect();
    for face in faces {
        let mut corners = draft.face(face).to_vec();
        if corners.len() > 4 || corners.contains(&to) {
            return None;
        }
        corners.iter_mut().filter(|v| **v == from).for_each(|v| *v = to);
        draft.set_face(face, &corners);
    }
    Some(())
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
pub(super) fn put_in<'a>(draft: &Draft<'a>, triangle: u32, apex: u32, within: Within) -> Vec<(f64, Draft<'a>)> {
    Lines::from(draft, triangle, apex, within).rows
}

/// The search for lines, as straight as the vertices on them allow.
struct Lines<'a, 'b> {
    draft: &'b Draft<'a>,
    triangle: u32,
    within: Within,
    line: Vec<Opening>,
    rows: Vec<(f64, Draft<'a>)>,
}

impl<'a, 'b> Lines<'a, 'b> {
    fn from(draft: &'b Draft<'a>, triangle: u32, apex: u32, within: Within) -> Self {
        let mut lines = Self { draft, triangle, within, line: Vec::new(), rows: Vec::new() };
        if !draft.is_fixed(apex)
            && let Some(fan) = draft.fan(apex, triangle)
        {
            lines.leave(apex, &fan[1..], 0.0);
        }
        lines
    }

    /// Tries all ways between the faces, counter-clockwise, of a vertex that the line has come to; `cost` is that of the
    /// line so far.
    fn leave(&mut self, vertex: u32, fan: &[u32], cost: f64) {
        let cost = cost + LENGTH - self.draft.irregularity(vertex, 0);
        let halves = |right: usize, left: usize| {
            // Each copy has a quad of the row, or a triangle that becomes one, on either side.
            cost + (right as f64 - 2.0).powi(2) + (left as f64 - 2.0).powi(2)
        };
        for end in 1..fan.len().saturating_sub(1) {
            let cost = halves(end, fan.len() - end - 1);
            if cost <= self.within.most && self.draft.face(fan[end]).len() == 3 && fan[end] != self.triangle {
                self.line.push(Opening { vertex, right: fan[..end].to_vec(), left: fan[end + 1..].to_vec() });
                self.rows.extend(open(self.draft, self.triangle, fan[end], &self.line).map(|row| (cost, row)));
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
        let at = self.draft.wings(left[0], *from)[1];
        if self.draft.is_fixed(at) || self.line.iter().any(|opening| opening.vertex == at) {
            return;
        }
        if let Some(fan) = self.draft.left(at, *from).and_then(|first| self.draft.fan(at, first)) {
            self.leave(at, &fan, cost);
        }
    }
}

/// Opens a line between two triangles: a quad for each of its edges, and one for each triangle.
fn open<'a>(draft: &Draft<'a>, start: u32, end: u32, line: &[Opening]) -> Option<Draft<'a>> {
    let mut result = draft.clone();
    let mut pairs = Vec::new();
    for Opening { vertex, right, left } in line {
        let copy = result.copy(*vertex);
        let here = draft.point(*vertex);
        let towards = |faces: &[u32]| {
            let corners = faces.iter().flat_map(|face| draft.face(*face));
            let middle = corners.clone().map(|v| draft.point(*v)).sum::<DVec3>() / corners.count().max(1) as f64;
            (here + middle) / 2.0
        };
        rename(&mut result, *vertex, copy, |face| right.contains(&face))?;
        result.place(*vertex, towards(left));
        result.place(copy, towards(right));
        pairs.push([*vertex, copy]);
    }
    for pair in pairs.windows(2) {
        let [[a, a_right], [b, b_right]] = [pair[0], pair[1]];
        result.add_face(&[a, a_right, b_right, b]);
    }
    let [first, first_right] = pairs[0];
    let [y, x] = draft.wings(start, first);
    result.set_face(start, &[first_right, first, x, y]);
    let [last, last_right] = pairs[pairs.len() - 1];
    let [q, p] = draft.wings(end, last);
    result.set_face(end, &[last, last_right, p, q]);
    Some(result)
}
