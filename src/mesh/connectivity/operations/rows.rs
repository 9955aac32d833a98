//! Rows of quads between two triangles: removal of a row, insertion of a row.

use super::super::edit::Edit;
use glam::DVec3;

/// The price of each quad of a row, in squared valences.
const QUAD_PRICE: f64 = 0.2;
/// The most that the last vertex of a row can reduce the cost by.
const LAST_VERTEX_REDUCTION: f64 = 2.0;
/// The most vertices that a search for lines visits. A vertex of high valence lowers the cost of all lines through it, so that their
/// cost alone does not bound their number.
const MOST_VISITED: usize = 200;

/// Limits of the rows that are proposed.
#[derive(Clone, Copy)]
pub(super) struct RowLimits {
    /// In quads.
    pub(super) longest: usize,
    /// In squared valences.
    pub(super) most_cost: f64,
}

/// Removes the row from the side `x` to `y` of a triangle to another triangle: the short sides of its quads are collapsed.
/// Returns the cost and the edit.
///
/// ```text
///      x---o---o           x
///    / |   |   | \        / \
///   z  |   |   |  w  ->  z---o---o---w      (each pair of the row becomes one vertex)
///    \ |   |   | /
///      y---o---o
/// ```
pub(super) fn remove_row<'a>(
    edit: &Edit<'a>,
    triangle: u32,
    side: usize,
    limits: RowLimits,
) -> Option<(f64, Edit<'a>)> {
    let corners = edit.face(triangle);
    let [mut a, mut b, apex] = [0, 1, 2].map(|k| corners[(side + k) % 3]);
    let mut pairs = vec![(a, b)];
    let mut row = vec![triangle];
    let mut cost = face_removal_cost(edit, apex);
    loop {
        // Both ends of a pair lose the faces on its two sides.
        let merged = edit.valence(a) as i32 + edit.valence(b) as i32 - 4;
        let wanted = if edit.is_free(b) { edit.wanted_valence(a) } else { edit.wanted_valence(b) };
        cost += f64::from(merged - wanted).powi(2) - edit.irregularity(a, 0) - edit.irregularity(b, 0) + QUAD_PRICE;
        if cost - LAST_VERTEX_REDUCTION > limits.most_cost {
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
            cost += face_removal_cost(edit, last);
            break;
        }
        if pairs.len() > limits.longest {
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
    if cost > limits.most_cost {
        return None;
    }
    let mut result = edit.clone();
    row.iter().for_each(|&face| result.set_face(face, &[]));
    for (a, b) in pairs {
        result.merge(a, b)?;
    }
    Some((cost, result))
}

/// The cost of one face less at a vertex.
fn face_removal_cost(edit: &Edit, vertex: u32) -> f64 {
    edit.irregularity(vertex, -1) - edit.irregularity(vertex, 0)
}

/// A vertex of the line that a new row opens, with its faces to the right and to the left of the line.
#[derive(Clone)]
struct Opening {
    vertex: u32,
    right: Vec<u32>,
    left: Vec<u32>,
}

/// Inserts rows between the corner `apex` of a triangle and a triangle that points the other way: each vertex of the line between
/// the two becomes a pair, and the triangles become quads. `found` receives the cost and the edit of each row within the limits, and
/// returns the largest cost from then on.
///
/// ```text
///   o           o           o---z---o---w---o
///   | \       / |           |   |   |   |   |
///   |  z--o--w  |      ->   |   |   |   |   |
///   | /       \ |           |   |   |   |   |
///   o           o           o---z'--o---w'--o
/// ```
pub(super) fn insert_rows<'a>(
    edit: &Edit<'a>,
    triangle: u32,
    apex: u32,
    limits: RowLimits,
    found: impl FnMut(f64, Edit<'a>) -> f64,
) {
    let mut lines = Lines { edit, triangle, limits, line: Vec::new(), visited: 0, found };
    if edit.is_free(apex)
        && let Some(fan) = edit.fan(apex, triangle)
    {
        lines.extend(apex, &fan[1..], 0.0);
    }
}

/// The search for lines between two triangles, as straight as the vertices on them allow.
struct Lines<'a, 'b, F> {
    edit: &'b Edit<'a>,
    triangle: u32,
    limits: RowLimits,
    line: Vec<Opening>,
    visited: usize,
    found: F,
}

impl<'a, F: FnMut(f64, Edit<'a>) -> f64> Lines<'a, '_, F> {
    /// Continues the line from a vertex between any two of its faces, `fan`, counter-clockwise; `cost` is the cost of the line
    /// up to the vertex.
    fn extend(&mut self, vertex: u32, fan: &[u32], cost: f64) {
        if fan.len() < 2 || self.visited == MOST_VISITED {
            return;
        }
        self.visited += 1;
        let cost = cost + QUAD_PRICE - self.edit.irregularity(vertex, 0);
        let halves = |right: usize, left: usize| {
            // Each copy gets a quad of the row, or a triangle that becomes one, on both sides.
            cost + (right as f64 - 2.0).powi(2) + (left as f64 - 2.0).powi(2)
        };
        for end in 1..fan.len().saturating_sub(1) {
            let cost = halves(end, fan.len() - end - 1);
            if cost <= self.limits.most_cost && self.edit.face(fan[end]).len() == 3 && fan[end] != self.triangle {
                self.line.push(Opening { vertex, right: fan[..end].to_vec(), left: fan[end + 1..].to_vec() });
                if let Some(row) = open(self.edit, self.triangle, fan[end], &self.line) {
                    self.limits.most_cost = (self.found)(cost, row);
                }
                self.line.pop();
            }
        }
        // At the first vertex the triangle is not in the fan, so the line may leave on either side of the middle.
        let slack = usize::from(self.line.is_empty());
        for half in (fan.len() / 2 - slack).max(1)..=(fan.len().div_ceil(2) + slack).min(fan.len() - 1) {
            let cost = halves(half, fan.len() - half);
            if cost - 1.0 <= self.limits.most_cost && self.line.len() < self.limits.longest {
                self.line.push(Opening { vertex, right: fan[..half].to_vec(), left: fan[half..].to_vec() });
                self.advance(cost);
                self.line.pop();
            }
        }
    }

    /// Continues the line along the edge between the right and the left faces of its last vertex.
    fn advance(&mut self, cost: f64) {
        let Opening { vertex: from, left, .. } = &self.line[self.line.len() - 1];
        let at = self.edit.beside(left[0], *from)[1];
        if !self.edit.is_free(at) || self.line.iter().any(|opening| opening.vertex == at) {
            return;
        }
        if let Some(fan) = self.edit.left(at, *from).and_then(|first| self.edit.fan(at, first)) {
            self.extend(at, &fan, cost);
        }
    }
}

/// Opens a line between two triangles: each of its edges and each of the triangles becomes a quad.
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
        result.move_faces(*vertex, copy, |face| right.contains(&face))?;
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
