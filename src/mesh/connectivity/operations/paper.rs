//! The paper's clean-up: it removes triangles, vertices of valence 2, and vertices of valence 3 among triangles.
//!
//! # Theory
//! The paper, section 3 and figure 5: four patterns are searched for and replaced, in the order (b), (c), (a), (d), over all
//! elements, in two rounds.
//!
//! # Changes versus the paper
//! The figure is not in the text that this program was written from, so the patterns follow the text:
//! - (a) two triangles that share an edge become a quad;
//! - (b) triangle, quad, triangle in a row become two quads, cut along the field;
//! - (c) two triangles at one vertex with one or two quads between them become quads;
//! - (d) a vertex whose faces have an outline of three or four vertices is removed, and one face replaces its faces: two quads
//!   that share two edges, three triangles, two triangles and a quad, four triangles.
//!
//! (a), (b) and (c) are one operation, for 0, 1 and 2 quads: it cuts the outline of two triangles and the quads between them
//! into quads at least cost.
//!
//! An edit is made where the value of the elements grows. The value of a quad is its shape (Qg), that of a triangle half its
//! shape (Tg) less a price; an inner edge at an angle to the cross field has a cost. Vertices do not move.
//!
//! # Practice
//! For comparison with the paper; the other operations leave fewer triangles.

use super::super::edit::Edit;
use super::super::{Engine, Kind};
use crate::mesh::incidence::{sides, undirected};
use crate::mesh::metric::to_metric;
use crate::mesh::objective::shape;
use crate::mesh::orientation;
use crate::mesh::polygon;
use glam::DVec3;

/// Rounds over all patterns, as in the paper.
const ROUNDS: usize = 2;
/// The price of a triangle, in perfect quads.
const TRIANGLE_PRICE: f64 = 0.25;
/// The weight of a triangle's shape: two triangles make a quad.
const TRIANGLE_WEIGHT: f64 = 0.5;
/// The cost of an edge at 45 degrees to the cross, in perfect quads.
const ALIGNMENT: f64 = 0.25;
/// The least shape (Qg) of a new quad.
const LEAST_SHAPE: f64 = 0.3;
/// The least gain of an edit: smaller ones are roundings, and two states could alternate.
const LEAST_GAIN: f64 = 1e-9;

/// A pattern: it proposes edits about a face or a vertex.
type Proposal = for<'e> fn(&'e Engine, u32) -> Vec<(Kind, Edit<'e>)>;

/// Searches for the four patterns over all elements in the order of their ids, and replaces them.
pub(in super::super) fn clean_up(engine: &mut Engine) {
    for _ in 0..ROUNDS {
        for pattern in [row as Proposal, fan_of_triangles, two_triangles] {
            (0..engine.mesh.face_bound() as u32).for_each(|face| replace(engine, face, pattern));
        }
        (0..engine.mesh.vertices().len() as u32).for_each(|v| replace(engine, v, removal));
    }
}

/// Makes the best edit of a pattern about an element, if its value grows.
fn replace(engine: &mut Engine, element: u32, pattern: Proposal) {
    if engine.context.is_cancelled() {
        return;
    }
    let best = pattern(engine, element)
        .into_iter()
        .filter_map(|(kind, edit)| Some((gain(engine, &edit)?, kind, edit)))
        .reduce(|best, other| if other.0 > best.0 { other } else { best });
    let Some((_, kind, edit)) = best else { return };
    let growth = edit.growth();
    let change = edit.into_change();
    engine.excess += growth;
    engine.make(&change, &[]);
    engine.counts.count(kind);
}

/// (a): a triangle and one beside it.
fn two_triangles<'e>(engine: &'e Engine, face: u32) -> Vec<(Kind, Edit<'e>)> {
    let edit = Edit::new(engine.mesh);
    let rows = triangles_beside(&edit, face).into_iter().map(|other| vec![face, other]);
    cut_into_quads(engine, &edit, Kind::Merge, rows)
}

/// (b): a quad and two triangles on opposite sides.
fn row<'e>(engine: &'e Engine, face: u32) -> Vec<(Kind, Edit<'e>)> {
    let edit = Edit::new(engine.mesh);
    let &[a, b, c, d] = edit.face(face) else { return Vec::new() };
    let triangle = |[from, to]: [u32; 2]| edit.across(from, to).filter(|&other| edit.face(other).len() == 3);
    let rows = [[[a, b], [c, d]], [[b, c], [d, a]]].into_iter();
    let rows = rows.filter_map(|[first, last]| Some(vec![triangle(first)?, face, triangle(last)?]));
    cut_into_quads(engine, &edit, Kind::RecutRow, rows)
}

/// (c): a triangle, one or two quads after it round one of its vertices, and another triangle there.
fn fan_of_triangles<'e>(engine: &'e Engine, face: u32) -> Vec<(Kind, Edit<'e>)> {
    let edit = Edit::new(engine.mesh);
    if edit.face(face).len() != 3 {
        return Vec::new();
    }
    let next = |at: u32, v: u32, side: usize| {
        let end = edit.beside(at, v)[side];
        let next = if side == 0 { edit.left(v, end) } else { edit.left(end, v) };
        next.filter(|_| edit.curve([v, end]).is_none())
    };
    let fans = (0..3).flat_map(|k| [(k, 0), (k, 1)]).filter_map(|(k, side)| {
        let v = edit.face(face)[k];
        let mut fan = vec![face];
        for _ in 0..3 {
            let other = next(fan[fan.len() - 1], v, side)?;
            fan.push(other);
            match edit.face(other).len() {
                3 => return (fan.len() > 2 && other != face).then_some(fan),
                4 => {}
                _ => return None,
            }
        }
        None
    });
    cut_into_quads(engine, &edit, Kind::RecutFan, fans)
}

/// (d): one face replaces the faces at a vertex.
fn removal<'e>(engine: &'e Engine, v: u32) -> Vec<(Kind, Edit<'e>)> {
    let edit = Edit::new(engine.mesh);
    let star: Vec<u32> = edit.around(v).collect();
    let corners: usize = star.iter().map(|&face| edit.face(face).len().saturating_sub(2)).sum();
    if !(2..=4).contains(&star.len()) || corners > 4 || !edit.is_free(v) || edit.on_boundary(v) {
        return Vec::new();
    }
    let Some(outline) = outline(&edit, &star).filter(|outline| (3..=4).contains(&outline.len())) else {
        return Vec::new();
    };
    vec![(Kind::Remove, replaced(&edit, &star, &[outline]))]
}

/// The growth of the elements' value by an edit; `None` where it does not grow, or a new face is a fault or has too small a
/// shape.
fn gain(engine: &Engine, edit: &Edit) -> Option<f64> {
    let old: Vec<&[u32]> = edit.changed().map(|(face, _)| edit.before(face)).collect();
    let new: Vec<&[u32]> = edit.changed().map(|(_, corners)| corners).filter(|corners| !corners.is_empty()).collect();
    let is_allowed = |face: u32| {
        let measure = edit.measure(engine.context, face);
        !measure.is_fault && (edit.face(face).len() == 3 || measure.shape >= LEAST_SHAPE)
    };
    let mut added = edit.changed().filter(|(_, corners)| !corners.is_empty()).map(|(face, _)| face);
    let gain = value(engine, edit, &new) - value(engine, edit, &old);
    (gain > LEAST_GAIN && edit.is_sound() && added.all(is_allowed)).then_some(gain)
}

/// The value of some faces and of the edges between them. The edges of their outline stay, so they do not count.
fn value(engine: &Engine, edit: &Edit, faces: &[&[u32]]) -> f64 {
    let face = |corners: &&[u32]| {
        let points: Vec<DVec3> = corners.iter().map(|&v| edit.point(v)).collect();
        let shape = shape(&points, engine.mesh.metric().map_of(corners).as_ref());
        if corners.len() == 3 { TRIANGLE_WEIGHT * shape - TRIANGLE_PRICE } else { shape }
    };
    let mut edges: Vec<[u32; 2]> = faces.iter().flat_map(|corners| sides(corners)).map(undirected).collect();
    edges.sort_unstable();
    let inner = edges.windows(2).filter(|pair| pair[0] == pair[1]).map(|pair| misalignment(engine, edit, pair[0]));
    faces.iter().map(face).sum::<f64>() - inner.sum::<f64>()
}

/// The cost of the angle between an edge and the cross field: `ALIGNMENT (1 - cos 4 angle) / 2`.
///
/// Crosses on features are rough, so they count only where both ends lie on features.
fn misalignment(engine: &Engine, edit: &Edit, [a, b]: [u32; 2]) -> f64 {
    let map = engine.mesh.metric().map_of(&[a, b]);
    let along = to_metric(map.as_ref(), edit.point(b) - edit.point(a));
    let is_rough = |v: u32| !edit.is_free(v);
    let ends = [a, b].into_iter().filter(|&end| !is_rough(end) || (is_rough(a) && is_rough(b)));
    let (loss, count) = ends.fold((0.0, 0.0), |(loss, count), end| {
        let vertex = edit.vertex(end);
        let flat = (along - vertex.normal * along.dot(vertex.normal)).normalize_or_zero();
        let square = flat.dot(vertex.axis).powi(2);
        (loss + 4.0 * square * (1.0 - square), count + 1.0)
    });
    ALIGNMENT * loss / count
}

/// The triangles beside a triangle.
fn triangles_beside(edit: &Edit, face: u32) -> Vec<u32> {
    let corners = edit.face(face);
    if corners.len() != 3 {
        return Vec::new();
    }
    let beside = sides(corners).filter_map(|[a, b]| edit.across(a, b));
    beside.filter(|&other| edit.face(other).len() == 3).collect()
}

/// The edits that cut the outlines of rows of faces into quads, each at least cost.
fn cut_into_quads<'e>(
    engine: &Engine,
    edit: &Edit<'e>,
    kind: Kind,
    rows: impl Iterator<Item = Vec<u32>>,
) -> Vec<(Kind, Edit<'e>)> {
    rows.filter_map(|row| {
        let outline = outline(edit, &row)?;
        let corners: usize = row.iter().map(|&face| edit.face(face).len().saturating_sub(2)).sum();
        if outline.len() % 2 == 1 || outline.len() != corners + 2 {
            return None;
        }
        let vertices = |places: &[usize]| places.iter().map(|&k| outline[k]).collect::<Vec<u32>>();
        let points = |places: &[usize]| places.iter().map(|&k| edit.point(outline[k])).collect::<Vec<DVec3>>();
        let up = orientation::normal(&points(&(0..outline.len()).collect::<Vec<_>>()));
        let face = |places: &[usize]| {
            let points = points(places);
            let shape = shape(&points, engine.mesh.metric().map_of(&vertices(places)).as_ref());
            let may_be = places.len() == 4 && shape >= LEAST_SHAPE && orientation::normal(&points).dot(up) > 0.0;
            if may_be { 1.0 - shape } else { f64::INFINITY }
        };
        let chord = |i: usize, j: usize| misalignment(engine, edit, [outline[i], outline[j]]);
        let (_, cut) = polygon::cut(outline.len(), face, chord)?;
        let faces: Vec<Vec<u32>> = cut.iter().map(|places| vertices(places)).collect();
        Some((kind, replaced(edit, &row, &faces)))
    })
    .collect()
}

/// The edit that replaces old faces by new ones, of which there are no more.
fn replaced<'e>(edit: &Edit<'e>, old: &[u32], new: &[Vec<u32>]) -> Edit<'e> {
    let mut result = edit.clone();
    for (k, &face) in old.iter().enumerate() {
        result.set_face(face, new.get(k).map_or(&[], Vec::as_slice));
    }
    result
}

/// The outline of some faces, counter-clockwise; `None` unless it is one simple loop without features inside.
fn outline(edit: &Edit, faces: &[u32]) -> Option<Vec<u32>> {
    let all: Vec<[u32; 2]> = faces.iter().flat_map(|&face| sides(edit.face(face))).collect();
    let (inner, outer): (Vec<[u32; 2]>, Vec<[u32; 2]>) = all.iter().partition(|&&[a, b]| all.contains(&[b, a]));
    if inner.iter().any(|&side| edit.curve(side).is_some()) {
        return None;
    }
    let mut outline = vec![outer.first()?[0]];
    loop {
        let mut next = outer.iter().filter(|side| side[0] == outline[outline.len() - 1]);
        let side = next.next()?;
        if next.next().is_some() {
            return None;
        }
        if side[1] == outline[0] {
            break;
        }
        if outline.len() == outer.len() {
            return None;
        }
        outline.push(side[1]);
    }
    (outline.len() == outer.len()).then_some(outline)
}
