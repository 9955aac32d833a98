//! Rows of quads between two triangles: one that can be taken out, one that can be put in.

use super::draft::Draft;
use glam::DVec3;

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
pub(super) fn take_out<'a>(draft: &Draft<'a>, triangle: u32, side: usize, longest: usize) -> Option<Draft<'a>> {
    let corners = draft.face(triangle);
    let (mut a, mut b) = (corners[side], corners[(side + 1) % 3]);
    let mut pairs = vec![(a, b)];
    let mut row = vec![triangle];
    loop {
        let face = draft.across(a, b)?;
        let corners = draft.face(face);
        if row.contains(&face) || corners.len() > 4 {
            return None;
        }
        row.push(face);
        if corners.len() == 3 {
            break;
        }
        if pairs.len() > longest {
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
    Some(result)
}

/// Gives `to` the faces of `from` that `which` names; `None` where one has more than four sides.
fn rename(draft: &mut Draft, from: u32, to: u32, which: impl Fn(u32) -> bool) -> Option<()> {
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
pub(super) fn put_in<'a>(draft: &Draft<'a>, triangle: u32, apex: u32, longest: usize) -> Vec<Draft<'a>> {
    if draft.is_fixed(apex) {
        return Vec::new();
    }
    let Some(fan) = draft.fan(apex, triangle) else { return Vec::new() };
    let mut rows = Vec::new();
    for first in 1..fan.len() {
        if draft.face(fan[first]).len() == 3 && first > 1 && first + 1 < fan.len() {
            let opening = Opening { vertex: apex, right: fan[1..first].to_vec(), left: fan[first + 1..].to_vec() };
            rows.extend(open(draft, triangle, fan[first], &[opening]));
        }
        if first + 1 < fan.len() && draft.face(fan[first]).len() == 4 {
            let opening = Opening { vertex: apex, right: fan[1..=first].to_vec(), left: fan[first + 1..].to_vec() };
            rows.extend(follow(draft, triangle, opening, longest));
        }
    }
    rows
}

/// The row along the straight line that leaves the apex between its right and left faces, if it comes to a triangle.
fn follow<'a>(draft: &Draft<'a>, triangle: u32, apex: Opening, longest: usize) -> Option<Draft<'a>> {
    let mut line = vec![apex];
    loop {
        let Opening { vertex: from, left, .. } = &line[line.len() - 1];
        let at = draft.wings(*left.first()?, *from)[1];
        if draft.is_fixed(at) || line.len() > longest || line.iter().any(|opening| opening.vertex == at) {
            return None;
        }
        let fan = draft.fan(at, draft.left(at, *from)?)?;
        let end = (1..fan.len() - 1).find(|&k| draft.face(fan[k]).len() == 3 && fan[k] != triangle);
        if let Some(end) = end {
            line.push(Opening { vertex: at, right: fan[..end].to_vec(), left: fan[end + 1..].to_vec() });
            return open(draft, triangle, fan[end], &line);
        }
        if fan.len() != 4 {
            return None;
        }
        line.push(Opening { vertex: at, right: fan[..2].to_vec(), left: fan[2..].to_vec() });
    }
}

/// Opens a line between two triangles.
fn open<'a>(draft: &Draft<'a>, start: u32, end: u32, line: &[Opening]) -> Option<Draft<'a>> {
    let mut result = draft.clone();
    let mut pairs = Vec::new();
    for Opening { vertex, right, left } in line {
        let copy = result.copy(*vertex);
        let middle = |faces: &[u32]| {
            let corners = faces.iter().flat_map(|face| draft.face(*face));
            corners.clone().map(|v| draft.point(*v)).sum::<DVec3>() / corners.count().max(1) as f64
        };
        let (here, share) = (draft.point(*vertex), 0.5);
        let places = [here.lerp(middle(left), share), here.lerp(middle(right), share)];
        rename(&mut result, *vertex, copy, |face| right.contains(&face))?;
        result.place(*vertex, places[0]);
        result.place(copy, places[1]);
        pairs.push((*vertex, copy));
    }
    for pair in pairs.windows(2) {
        let [(a, a_right), (b, b_right)] = [pair[0], pair[1]];
        result.add_face(&[a, a_right, b_right, b]);
    }
    let ((first, first_right), (last, last_right)) = (pairs[0], pairs[pairs.len() - 1]);
    let [y, x] = draft.wings(start, first);
    result.set_face(start, &[first_right, first, x, y]);
    let [q, p] = draft.wings(end, last);
    result.set_face(end, &[last, last_right, p, q]);
    Some(result)
}
