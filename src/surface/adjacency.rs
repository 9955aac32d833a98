//! Which triangles meet at which edges; consistent orientation; one fan of triangles a vertex.
//!
//! # Practice
//! Where more than two triangles meet at an edge, they are paired as the walls of solids ([`Joint::pair`]). Where that fails, the
//! surface is cut into sheets along the edge, and each sheet has its own vertices. Sheets are oriented before they are paired
//! with others, so that all edges of a seam are paired alike. Fans that touch in a vertex alone have a vertex each. The
//! vertices at one place are remembered, so that the mesh can be joined there again. Solids in contact along a flat wall are
//! not joined inside the wall.

use super::boxes::Bounds;
use super::{Frame, NONE, Repairs, SurfaceError, next, previous};
use crate::progress::{ASKED_EVERY, Cancelled, Progress};
use glam::Vec3;
use rayon::prelude::*;
use rstar::RTree;
use rstar::primitives::{GeomWithData, Rectangle};
use std::collections::VecDeque;
use std::f64::consts::{PI, TAU};

/// The result of [`orient`].
pub(super) struct Adjacency {
    /// The opposite half-edge of each half-edge.
    pub twins: Vec<u32>,
    /// The half-edges along which sheets or solids meet, sorted.
    pub seams: Vec<u32>,
    /// The first of the vertices at the place of each vertex.
    pub same_place: Vec<u32>,
}

/// Orients the triangles alike, closed components outward and cavities inward, gives each fan a vertex of its own and drops unused points.
pub(super) fn orient(
    points: &mut Vec<Vec3>,
    triangles: &mut [[u32; 3]],
    frame: &Frame,
    repairs: &mut Repairs,
    progress: &Progress,
) -> Result<Adjacency, SurfaceError> {
    let Pairs { mut pairs, mut joints, inside_walls } = pair(points, triangles, frame, repairs, progress)?;
    progress.check()?;
    let mut turned = turn_alike(points, triangles, &mut pairs, &mut joints, frame, progress)?;
    if !joints.is_empty() {
        for joint in &joints {
            for (&h, partner) in joint.iter().zip(Joint::new(points, triangles, joint).pair()) {
                pairs[h as usize] = partner.map_or(NONE, |k| joint[k]);
            }
        }
        let again = turn_alike(points, triangles, &mut pairs, &mut joints, frame, progress)?;
        turned.iter_mut().zip(again).for_each(|(turned, again)| *turned ^= again);
    }
    for (triangle, _) in triangles.iter().zip(&turned).filter(|&(_, &turned)| turned) {
        repairs.flipped_triangles.note(|| frame.near(points[triangle[0] as usize].as_dvec3().into()));
    }
    progress.check()?;
    let twins = pairs;
    let mut seams = joints.concat();
    seams.sort_unstable();
    let same_place = one_fan_each(points, triangles, &twins, |vertex, place| {
        let joined = inside_walls.binary_search(&vertex).is_err();
        if joined {
            repairs.joined_vertices.note(|| frame.near(place.as_dvec3().into()));
        }
        joined
    });
    Ok(Adjacency { twins, seams, same_place })
}

/// The pairs of half-edges.
struct Pairs {
    /// The other half-edge on the same two vertices, whatever its direction; [`NONE`] where there is none.
    pairs: Vec<u32>,
    /// The half-edges of each edge along which sheets or solids meet; none is paired yet.
    joints: Vec<Vec<u32>>,
    /// The points inside flat walls between solids, sorted.
    inside_walls: Vec<u32>,
}

fn pair(
    points: &[Vec3],
    triangles: &[[u32; 3]],
    frame: &Frame,
    repairs: &mut Repairs,
    progress: &Progress,
) -> Result<Pairs, Cancelled> {
    let mut edges: Vec<(u64, u32)> = (0..3 * triangles.len() as u32)
        .into_par_iter()
        .map(|h| {
            let t = triangles[h as usize / 3];
            (edge_key(t[h as usize % 3], t[next(h) as usize % 3]), h)
        })
        .collect();
    progress.check()?;
    edges.par_sort_unstable();
    let mut pairs = vec![NONE; edges.len()];
    let (mut joints, mut in_walls, mut on_seams) = (Vec::new(), Vec::new(), Vec::new());
    for (k, run) in edges.chunk_by(|a, b| a.0 == b.0).enumerate() {
        if k.is_multiple_of(ASKED_EVERY) {
            progress.check()?;
        }
        match *run {
            [_] => {}
            [(_, g), (_, h)] => {
                pairs[g as usize] = h;
                pairs[h as usize] = g;
            }
            _ => {
                let ends = [run[0].0 >> 32, run[0].0 & 0xffff_ffff].map(|v| v as u32);
                let half_edges: Vec<u32> = run.iter().map(|edge| edge.1).collect();
                if let Some(partners) = Joint::new(points, triangles, &half_edges).walls() {
                    in_walls.extend(ends);
                    for (&h, partner) in half_edges.iter().zip(partners) {
                        pairs[h as usize] = partner.map_or(NONE, |k| half_edges[k]);
                    }
                } else {
                    on_seams.extend(ends);
                    joints.push(half_edges);
                    let [a, b] = ends.map(|v| points[v as usize].as_dvec3());
                    repairs.joined_edges.note(|| frame.near(a.midpoint(b).into()));
                }
            }
        }
    }
    on_seams.sort_unstable();
    in_walls.retain(|v| on_seams.binary_search(v).is_err());
    in_walls.sort_unstable();
    Ok(Pairs { pairs, joints, inside_walls: in_walls })
}

/// An edge where more than two triangles meet.
struct Joint {
    /// The angle of each triangle around the edge, and whether its front faces greater angles.
    sides: Vec<(f64, bool)>,
}

/// Triangles at a smaller angle, in radians, enclose nothing.
const LEAST_WEDGE: f64 = 1e-5;
/// Triangles that meet at an angle within this of 180 degrees, in radians, are one wall.
const FLAT: f64 = 0.1;

impl Joint {
    fn new(points: &[Vec3], triangles: &[[u32; 3]], half_edges: &[u32]) -> Self {
        let origin = |h: u32| triangles[h as usize / 3][h as usize % 3];
        let start = origin(half_edges[0]);
        let [a, b] = [start, origin(next(half_edges[0]))].map(|v| points[v as usize].as_dvec3());
        let along = (b - a).normalize_or_zero();
        let x = along.any_orthonormal_vector();
        let y = along.cross(x);
        let side = |&h: &u32| {
            let away = points[origin(previous(h)) as usize].as_dvec3() - a;
            (away.dot(y).atan2(away.dot(x)), origin(h) == start)
        };
        Self { sides: half_edges.iter().map(side).collect() }
    }

    /// The angle from one side to another on the back of the first, from 0 to 2 pi.
    fn behind(&self, from: usize, to: usize) -> f64 {
        let turn = self.sides[to].0 - self.sides[from].0;
        let turn = if self.sides[from].1 { -turn } else { turn };
        let turn = turn.rem_euclid(TAU);
        if turn < LEAST_WEDGE { turn + TAU } else { turn }
    }

    /// The partner of each side: the first one behind it that faces away as well. All are paired, or none.
    fn pair(&self) -> Vec<Option<usize>> {
        let count = self.sides.len();
        let partner = |from: usize| {
            (0..count)
                .filter(|&to| self.sides[to].1 != self.sides[from].1)
                .min_by(|&s, &t| self.behind(from, s).total_cmp(&self.behind(from, t)))
        };
        let partners: Vec<_> = (0..count).map(partner).collect();
        let mutual = (0..count).all(|k| partners[k].is_some_and(|other| partners[other] == Some(k)));
        if mutual { partners } else { vec![None; count] }
    }

    /// The partners where each pair is one flat wall.
    fn walls(&self) -> Option<Vec<Option<usize>>> {
        let partners = self.pair();
        let flat = |(from, to): (usize, &Option<usize>)| to.is_some_and(|to| (self.behind(from, to) - PI).abs() < FLAT);
        if partners.iter().enumerate().all(flat) { Some(partners) } else { self.across() }
    }

    /// The partners where all sides lie in one plane, as many on either side of the edge. They may face either way, as the wall
    /// of an inverted solid does.
    fn across(&self) -> Option<Vec<Option<usize>>> {
        let off = |k: usize| self.behind(0, k).rem_euclid(TAU);
        let (far, near): (Vec<usize>, Vec<usize>) = (0..self.sides.len()).partition(|&k| (off(k) - PI).abs() < FLAT);
        let flat = near.iter().all(|&k| off(k).min(TAU - off(k)) < FLAT) && far.len() == near.len();
        let mut partners = vec![None; self.sides.len()];
        for (&k, &other) in near.iter().zip(&far) {
            (partners[k], partners[other]) = (Some(other), Some(k));
        }
        flat.then_some(partners)
    }
}

fn edge_key(a: u32, b: u32) -> u64 {
    (u64::from(a.min(b)) << 32) | u64::from(a.max(b))
}

/// A closed component.
struct Solid {
    triangles: Vec<usize>,
    /// Six times its volume: negative where its triangles look inward.
    volume: f64,
    bounds: Bounds,
}

impl Solid {
    fn new(points: &[Vec3], triangles: &[[u32; 3]], turned: &[bool], component: Vec<usize>) -> Self {
        let corners = |t: usize| triangles[t].map(|v| points[v as usize]);
        let volume = |&t: &usize| {
            let [a, b, c] = corners(t).map(|p| p.as_dvec3());
            a.dot(b.cross(c)) * if turned[t] { -1.0 } else { 1.0 }
        };
        Self {
            volume: component.iter().map(volume).sum(),
            bounds: component.iter().map(|&t| Bounds::of(&corners(t))).fold(Bounds::EMPTY, Bounds::joined),
            triangles: component,
        }
    }
}

/// For each closed component whether it, or the largest one whose bounding box holds its own, looks inward.
fn look_inward(solids: &[Solid]) -> Vec<bool> {
    if solids.iter().all(|solid| solid.volume >= 0.0) {
        return vec![false; solids.len()];
    }
    let boxed = |(k, solid): (usize, &Solid)| {
        let Bounds { low, high } = solid.bounds;
        GeomWithData::new(Rectangle::from_corners(low.to_array(), high.to_array()), k)
    };
    let boxes = RTree::bulk_load(solids.iter().enumerate().map(boxed).collect());
    let outermost = |solid: &Solid| {
        let around =
            boxes.locate_all_at_point(solid.bounds.low.to_array()).map(|found| (&solids[found.data], found.data));
        let outer = around.filter(|(outer, _)| solid.bounds.is_inside(&outer.bounds));
        outer
            .max_by(|a, b| a.0.volume.abs().total_cmp(&b.0.volume.abs()).then(b.1.cmp(&a.1)))
            .map(|(outer, _)| outer.volume)
    };
    solids.iter().map(|solid| outermost(solid).unwrap_or(solid.volume) < 0.0).collect()
}

/// The triangles that must be reversed: those of a component look the same way, and outward where it is closed. One inside another
/// is turned with that one alone, as it may bound a cavity.
fn turn(
    points: &[Vec3],
    triangles: &[[u32; 3]],
    pairs: &[u32],
    frame: &Frame,
    progress: &Progress,
) -> Result<Vec<bool>, SurfaceError> {
    let mut turned = vec![false; triangles.len()];
    let mut seen = vec![false; triangles.len()];
    let mut solids = Vec::new();
    let origin = |h: u32| triangles[h as usize / 3][h as usize % 3];
    for first in 0..triangles.len() {
        if seen[first] {
            continue;
        }
        seen[first] = true;
        let mut component = vec![first];
        let mut queue = VecDeque::from([first]);
        let mut open = Vec::new();
        while let Some(t) = queue.pop_front() {
            if t.is_multiple_of(ASKED_EVERY) {
                progress.check()?;
            }
            for h in [0, 1, 2].map(|k| 3 * t as u32 + k) {
                let pair = pairs[h as usize];
                if pair == NONE {
                    open.push(h);
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
                    let at = frame.near(points[origin(h) as usize].as_dvec3().into());
                    return Err(SurfaceError::NotOrientable { triangle: t, at });
                }
            }
        }
        // As most of its triangles are given.
        if component.iter().filter(|&&t| turned[t]).count() * 2 > component.len() {
            component.iter().for_each(|&t| turned[t] ^= true);
        }
        if encloses(triangles, &turned, &open) {
            solids.push(Solid::new(points, triangles, &turned, component));
        }
    }
    for (solid, _) in solids.iter().zip(look_inward(&solids)).filter(|(_, looks_inward)| *looks_inward) {
        solid.triangles.iter().for_each(|&t| turned[t] ^= true);
    }
    Ok(turned)
}

/// Whether open edges cancel: each is traversed as often in one direction as in the other. This holds for a closed part that
/// shares an edge with others.
fn encloses(triangles: &[[u32; 3]], turned: &[bool], open: &[u32]) -> bool {
    let mut passes: Vec<(u64, i32)> = open
        .iter()
        .map(|&h| {
            let t = triangles[h as usize / 3];
            let (a, b) = (t[h as usize % 3], t[next(h) as usize % 3]);
            (edge_key(a, b), if (a < b) ^ turned[h as usize / 3] { 1 } else { -1 })
        })
        .collect();
    passes.sort_unstable();
    passes.chunk_by(|a, b| a.0 == b.0).all(|run| run.iter().map(|pass| pass.1).sum::<i32>() == 0)
}

/// Reverses triangles so that paired ones face the same way; returns which.
fn turn_alike(
    points: &[Vec3],
    triangles: &mut [[u32; 3]],
    pairs: &mut Vec<u32>,
    joints: &mut [Vec<u32>],
    frame: &Frame,
    progress: &Progress,
) -> Result<Vec<bool>, SurfaceError> {
    let turned = turn(points, triangles, pairs, frame, progress)?;
    *pairs = turn_over(triangles, pairs, &turned);
    joints.iter_mut().flatten().for_each(|h| *h = renumbered(*h, &turned));
    Ok(turned)
}

/// Reverses triangles (exchanges corners 1 and 2) and renumbers the pairs of half-edges accordingly.
fn turn_over(triangles: &mut [[u32; 3]], pairs: &[u32], turned: &[bool]) -> Vec<u32> {
    let mut twins = vec![NONE; pairs.len()];
    for (h, &pair) in pairs.iter().enumerate() {
        if pair != NONE {
            twins[renumbered(h as u32, turned) as usize] = renumbered(pair, turned);
        }
    }
    for (triangle, &turned) in triangles.iter_mut().zip(turned) {
        if turned {
            triangle.swap(1, 2);
        }
    }
    twins
}

/// With corners 1 and 2 exchanged, edge 0 becomes edge 2 and edge 2 becomes edge 0.
fn renumbered(half_edge: u32, turned: &[bool]) -> u32 {
    if turned[half_edge as usize / 3] && half_edge % 3 != 1 {
        half_edge / 3 * 3 + (2 - half_edge % 3)
    } else {
        half_edge
    }
}

/// Gives every fan of triangles its own vertex and drops points without triangles. Returns the first of the vertices at
/// the place of each; `joins` is asked whether a further fan at a point is to be joined to the first.
fn one_fan_each(
    points: &mut Vec<Vec3>,
    triangles: &mut [[u32; 3]],
    twins: &[u32],
    mut joins: impl FnMut(u32, Vec3) -> bool,
) -> Vec<u32> {
    let corners = 3 * triangles.len();
    let mut fan = vec![NONE; corners];
    let mut fresh: Vec<Vec3> = Vec::with_capacity(points.len());
    let mut same_place = Vec::with_capacity(points.len());
    let mut first_fan = vec![NONE; points.len()];
    for corner in 0..corners as u32 {
        if fan[corner as usize] != NONE {
            continue;
        }
        let vertex = triangles[corner as usize / 3][corner as usize % 3] as usize;
        let id = fresh.len() as u32;
        if first_fan[vertex] == NONE {
            first_fan[vertex] = id;
            same_place.push(id);
        } else {
            same_place.push(if joins(vertex as u32, points[vertex]) { first_fan[vertex] } else { id });
        }
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
    same_place
}
