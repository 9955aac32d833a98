//! What a mesh must hold, and where it does not.

use super::Mesh;
use crate::mesh::quality::quad_shape;
use glam::DVec3;
use rayon::prelude::*;
use serde::Serialize;
use std::fmt;

/// One broken invariant.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub enum Kind {
    /// A coordinate of the vertex is infinite or not a number.
    NonFinite { vertex: u32 },
    /// No face uses the vertex.
    IsolatedVertex { vertex: u32 },
    /// The faces round the vertex form more than one fan.
    NonManifoldVertex { vertex: u32, fans: u32 },
    /// More than two faces meet at the edge.
    NonManifoldEdge { edge: [u32; 2], faces: u32 },
    /// Two faces run along the edge in the same direction.
    MisorientedEdge { edge: [u32; 2] },
    /// The face names a vertex that the mesh does not have.
    MissingVertex { face: u32, vertex: u32 },
    /// The face names a vertex twice.
    RepeatedVertex { face: u32, vertex: u32 },
    /// The face has the vertices of an earlier face.
    DuplicateFace { face: u32, earlier: u32 },
    /// The face has fewer than three sides, or its area is below 1e-6 of the squared mean edge length.
    DegenerateFace { face: u32, area: f64 },
    /// A corner of the quad is straight or reflex against the quad's normal.
    ConcaveQuad { face: u32 },
}

/// A broken invariant and its place.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Fault {
    /// What is broken, with the ids of vertices, edge or face.
    pub kind: Kind,
    /// The vertex, the middle of the edge or the mean of the face's vertices.
    pub at: [f64; 3],
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.kind {
            Kind::NonFinite { vertex } => write!(f, "vertex {vertex} has a coordinate that is not finite")?,
            Kind::IsolatedVertex { vertex } => write!(f, "vertex {vertex} lies on no face")?,
            Kind::NonManifoldVertex { vertex, fans } => write!(f, "vertex {vertex} joins {fans} fans of faces")?,
            Kind::NonManifoldEdge { edge: [a, b], faces } => write!(f, "edge {a}-{b} has {faces} faces")?,
            Kind::MisorientedEdge { edge: [a, b] } => write!(f, "edge {a}-{b} has two faces on the same side")?,
            Kind::MissingVertex { face, vertex } => write!(f, "face {face} names vertex {vertex}, which is missing")?,
            Kind::RepeatedVertex { face, vertex } => write!(f, "face {face} has vertex {vertex} twice")?,
            Kind::DuplicateFace { face, earlier } => write!(f, "face {face} repeats face {earlier}")?,
            Kind::DegenerateFace { face, area } => write!(f, "face {face} is degenerate (area {area:.3e})")?,
            Kind::ConcaveQuad { face } => write!(f, "quad {face} is concave")?,
        }
        let [x, y, z] = self.at;
        write!(f, " at ({x:.6}, {y:.6}, {z:.6})")
    }
}

/// What [`check`] found.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Faults {
    /// Every broken invariant, by kind and then by id.
    pub list: Vec<Fault>,
    /// Vertices in use - edges + faces.
    pub euler: i64,
    /// Number of closed boundary curves.
    pub boundary_loops: usize,
    /// Number of pieces that no edge or vertex joins.
    pub components: usize,
}

impl Faults {
    /// Whether nothing is broken.
    pub fn is_clean(&self) -> bool {
        self.list.is_empty()
    }

    /// How many faults satisfy `which`.
    pub fn count(&self, which: impl Fn(&Kind) -> bool) -> usize {
        self.list.iter().filter(|fault| which(&fault.kind)).count()
    }
}

impl fmt::Display for Faults {
    /// One line, and one more for each of the first few faults.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const SHOWN: usize = 5;
        match self.list.len() {
            0 => write!(f, "no faults")?,
            1 => write!(f, "1 fault")?,
            n => write!(f, "{n} faults")?,
        }
        write!(
            f,
            "; Euler characteristic {}, boundary loops {}, components {}",
            self.euler, self.boundary_loops, self.components
        )?;
        for fault in self.list.iter().take(SHOWN) {
            write!(f, "\n  {fault}")?;
        }
        match self.list.len().saturating_sub(SHOWN) {
            0 => Ok(()),
            more => write!(f, "\n  and {more} more"),
        }
    }
}

/// Lists every broken invariant of a mesh, each with its place.
///
/// Where a face names a missing vertex, only such faces are listed: nothing else can be told.
pub fn check(mesh: &Mesh) -> Faults {
    check_joined(mesh, &[])
}

/// As [`check`], but vertices that `branches` marks may have several fans, and edges between two of them any faces.
pub fn check_joined(mesh: &Mesh, branches: &[bool]) -> Faults {
    let may_branch = |vertex: u32| branches.get(vertex as usize).copied().unwrap_or_default();
    let missing = missing_vertices(mesh);
    if !missing.is_empty() {
        return Faults { list: missing, ..Faults::default() };
    }
    let edges = mesh.edges();
    let point = |vertex: u32| DVec3::from(mesh.points[vertex as usize]);
    let middle = |ends: [u32; 2]| ((point(ends[0]) + point(ends[1])) / 2.0).to_array();

    let mut list: Vec<Fault> = (0_u32..)
        .zip(&mesh.points)
        .filter(|(_, point)| !point.iter().all(|x| x.is_finite()))
        .map(|(vertex, &at)| Fault { kind: Kind::NonFinite { vertex }, at })
        .collect();
    let fans = fans(mesh);
    list.extend((0_u32..).zip(&fans).filter_map(|(vertex, &fans)| {
        let kind = match fans {
            0 => Kind::IsolatedVertex { vertex },
            1 => return None,
            _ if may_branch(vertex) => return None,
            _ => Kind::NonManifoldVertex { vertex, fans },
        };
        Some(Fault { kind, at: mesh.points[vertex as usize] })
    }));
    for edge in &edges {
        let (ends, faces) = (edge.ends, edge.along + edge.against);
        if ends.iter().all(|&end| may_branch(end)) {
            continue;
        }
        if faces > 2 {
            list.push(Fault { kind: Kind::NonManifoldEdge { edge: ends, faces }, at: middle(ends) });
        } else if edge.along.max(edge.against) > 1 {
            list.push(Fault { kind: Kind::MisorientedEdge { edge: ends }, at: middle(ends) });
        }
    }
    let length = edges.iter().map(|edge| point(edge.ends[0]).distance(point(edge.ends[1]))).sum::<f64>();
    let mean_edge = length / edges.len().max(1) as f64;
    list.extend(face_faults(mesh, 1e-6 * mean_edge * mean_edge));

    let used = fans.iter().filter(|fans| **fans > 0).count();
    Faults {
        list,
        euler: used as i64 - edges.len() as i64 + mesh.face_count() as i64,
        boundary_loops: boundary_loops(mesh, &edges),
        components: components(mesh),
    }
}

fn center(mesh: &Mesh, face: &[u32]) -> [f64; 3] {
    let known = face.iter().filter_map(|vertex| mesh.points.get(*vertex as usize));
    let sum: DVec3 = known.clone().map(|point| DVec3::from(*point)).sum();
    (sum / known.count().max(1) as f64).to_array()
}

fn missing_vertices(mesh: &Mesh) -> Vec<Fault> {
    let mut list = Vec::new();
    for (id, face) in (0..).zip(mesh.faces()) {
        if let Some(&vertex) = face.iter().find(|vertex| **vertex as usize >= mesh.points.len()) {
            list.push(Fault { kind: Kind::MissingVertex { face: id, vertex }, at: center(mesh, face) });
        }
    }
    list
}

/// For each vertex, into how many fans its faces fall when they are joined across the edges at it.
fn fans(mesh: &Mesh) -> Vec<u32> {
    let mut starts = vec![0_u32; mesh.points.len() + 1];
    for &vertex in &mesh.corners {
        starts[vertex as usize + 1] += 1;
    }
    for vertex in 1..starts.len() {
        starts[vertex] += starts[vertex - 1];
    }
    // The neighbours of each vertex before and after it in each of its faces.
    let mut wings = vec![[0_u32; 2]; mesh.corners.len()];
    let mut place = starts.clone();
    for face in mesh.faces() {
        for (k, &vertex) in face.iter().enumerate() {
            let slot = &mut place[vertex as usize];
            wings[*slot as usize] = [face[(k + face.len() - 1) % face.len()], face[(k + 1) % face.len()]];
            *slot += 1;
        }
    }
    starts
        .par_windows(2)
        .map(|range| {
            let wings = &wings[range[0] as usize..range[1] as usize];
            let mut spokes: Vec<(u32, u32)> =
                (0..).zip(wings).flat_map(|(id, [before, after])| [(*before, id), (*after, id)]).collect();
            spokes.sort_unstable();
            let mut sets = Sets::new(wings.len());
            for pair in spokes.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
                sets.join(pair[0].1, pair[1].1);
            }
            sets.count as u32
        })
        .collect()
}

fn face_faults(mesh: &Mesh, least_area: f64) -> Vec<Fault> {
    let mut corners = mesh.corners.clone();
    let mut slices: Vec<(&[u32], u32)> = Vec::with_capacity(mesh.face_count());
    let mut rest = corners.as_mut_slice();
    for (id, face) in (0..).zip(mesh.faces()) {
        let (slice, after) = rest.split_at_mut(face.len());
        slice.sort_unstable();
        slices.push((slice, id));
        rest = after;
    }
    let mut list = Vec::new();
    let mut report = |kind, id: u32| list.push(Fault { kind, at: center(mesh, mesh.face(id as usize)) });
    for (slice, face) in &slices {
        if let Some(pair) = slice.windows(2).find(|pair| pair[0] == pair[1]) {
            report(Kind::RepeatedVertex { face: *face, vertex: pair[0] }, *face);
        }
    }
    slices.par_sort_unstable();
    let mut repeats: Vec<[u32; 2]> = slices
        .chunk_by(|a, b| a.0 == b.0)
        .flat_map(|same| same[1..].iter().map(|repeat| [repeat.1, same[0].1]))
        .collect();
    repeats.sort_unstable();
    for [face, earlier] in repeats {
        report(Kind::DuplicateFace { face, earlier }, face);
    }
    for (id, face) in (0..).zip(mesh.faces()) {
        let point = |k: usize| DVec3::from(mesh.points[face[k] as usize]);
        let area: f64 =
            (2..face.len()).map(|k| (point(k - 1) - point(0)).cross(point(k) - point(0)).length() / 2.0).sum();
        if face.len() < 3 || area < least_area {
            report(Kind::DegenerateFace { face: id, area }, id);
        } else if let [a, b, c, d] = *face
            && quad_shape([a, b, c, d].map(|vertex| mesh.points[vertex as usize])) == 0.0
        {
            report(Kind::ConcaveQuad { face: id }, id);
        }
    }
    list
}

/// Walks the free sides of the boundary edges; where several leave a vertex, the smallest id first.
fn boundary_loops(mesh: &Mesh, edges: &[super::Edge]) -> usize {
    let mut free: Vec<[u32; 2]> = edges
        .iter()
        .filter(|edge| edge.is_boundary())
        .map(|edge| if edge.along > 0 { [edge.ends[1], edge.ends[0]] } else { edge.ends })
        .collect();
    free.sort_unstable();
    let mut first = vec![u32::MAX; mesh.points.len()];
    for (place, side) in free.iter().enumerate().rev() {
        first[side[0] as usize] = place as u32;
    }
    let mut seen = vec![false; free.len()];
    let mut loops = 0;
    for start in 0..free.len() {
        if seen[start] {
            continue;
        }
        loops += 1;
        let mut place = start;
        loop {
            seen[place] = true;
            let end = free[place][1];
            let next = first[end as usize] as usize;
            let Some(unseen) = (next..free.len()).take_while(|k| free[*k][0] == end).find(|k| !seen[*k]) else { break };
            place = unseen;
        }
    }
    loops
}

fn components(mesh: &Mesh) -> usize {
    let mut used = vec![false; mesh.points.len()];
    let mut sets = Sets::new(mesh.points.len());
    for face in mesh.faces() {
        for &vertex in face {
            used[vertex as usize] = true;
            sets.join(face[0], vertex);
        }
    }
    sets.count - used.iter().filter(|used| !**used).count()
}

/// Disjoint sets with path halving.
struct Sets {
    parent: Vec<u32>,
    count: usize,
}

impl Sets {
    fn new(count: usize) -> Self {
        Self { parent: (0..count as u32).collect(), count }
    }

    fn root(&mut self, mut item: u32) -> u32 {
        while self.parent[item as usize] != item {
            let above = self.parent[item as usize];
            self.parent[item as usize] = self.parent[above as usize];
            item = self.parent[item as usize];
        }
        item
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        if a != b {
            self.parent[a.max(b) as usize] = a.min(b);
            self.count -= 1;
        }
    }
}
