//! The invariants of a mesh, and where it breaks them.

use super::Mesh;
use super::quality::quad_shape;
use super::topology::{Connectivity, Topology};
use crate::surface::shown;
use rayon::prelude::*;
use serde::Serialize;
use std::cmp::Ordering;
use std::fmt;
use std::mem::discriminant;

/// One broken invariant.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd, Serialize)]
#[non_exhaustive]
pub enum Kind {
    /// A coordinate of the vertex is infinite or not a number.
    NonFinite {
        /// The vertex.
        vertex: u32,
    },
    /// No face uses the vertex.
    IsolatedVertex {
        /// The vertex.
        vertex: u32,
    },
    /// The faces round the vertex form more than one fan.
    NonManifoldVertex {
        /// The vertex.
        vertex: u32,
        /// The number of fans.
        fans: u32,
    },
    /// More than two faces meet at the edge.
    NonManifoldEdge {
        /// The ends of the edge.
        edge: [u32; 2],
        /// The number of faces.
        faces: u32,
    },
    /// Two faces run along the edge in the same direction.
    MisorientedEdge {
        /// The ends of the edge.
        edge: [u32; 2],
    },
    /// The face names a vertex that the mesh does not have.
    MissingVertex {
        /// The face.
        face: u32,
        /// The vertex.
        vertex: u32,
    },
    /// The face names a vertex twice.
    RepeatedVertex {
        /// The face.
        face: u32,
        /// The vertex.
        vertex: u32,
    },
    /// The face has the vertices of an earlier face.
    DuplicateFace {
        /// The face.
        face: u32,
        /// The earlier face.
        earlier: u32,
    },
    /// The face has fewer than three sides, or its area is no more than 1e-6 of the squared mean edge length.
    DegenerateFace {
        /// The face.
        face: u32,
        /// Its area.
        area: f64,
    },
    /// A corner of the quad is straight or reflex against the quad's normal.
    ConcaveQuad {
        /// The face.
        face: u32,
    },
    /// The face is inverted: its normal points against the nearest sheet of the surface.
    FlippedFace {
        /// The face.
        face: u32,
    },
    /// A boundary loop of the mesh is no boundary of the surface: its first vertex, and the number of its sides.
    Hole {
        /// The vertex.
        vertex: u32,
        /// The number of sides.
        sides: u32,
    },
    /// The vertex is more than one mean edge length from the surface; the distance is in mean edge lengths.
    StrayVertex {
        /// The vertex.
        vertex: u32,
        /// The distance.
        distance: f64,
    },
}

/// A broken invariant with its place.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Fault {
    /// The invariant, with the ids of vertices, edge or face.
    pub kind: Kind,
    /// The vertex, the middle of the edge or the mean of the vertices of the face or the hole.
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
            Kind::FlippedFace { face } => write!(f, "face {face} looks away from the surface")?,
            Kind::StrayVertex { vertex, distance } => {
                write!(f, "vertex {vertex} is {distance:.3} edge lengths off the surface")?;
            }
            Kind::Hole { vertex, sides } => write!(f, "a hole of {sides} sides, one at vertex {vertex},")?,
        }
        write!(f, " at {}", shown(&self.at))
    }
}

/// The result of [`check`].
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Faults {
    /// Every broken invariant, by kind and then by id.
    pub list: Vec<Fault>,
    /// The Euler characteristic: vertices in use - edges + faces.
    pub euler: i64,
    /// Number of closed boundary curves.
    pub boundary_loops: usize,
    /// Number of connected components; faces that share a vertex are connected.
    pub components: usize,
}

impl Faults {
    /// Whether there are no faults.
    pub fn is_clean(&self) -> bool {
        self.list.is_empty()
    }

    /// The topology of the mesh.
    pub fn topology(&self) -> Topology {
        Topology { euler: self.euler, boundary_loops: self.boundary_loops, components: self.components }
    }

    /// The number of faults that satisfy `which`.
    pub fn count(&self, which: impl Fn(&Kind) -> bool) -> usize {
        self.list.iter().filter(|fault| which(&fault.kind)).count()
    }

    /// The number of triangles that would cover all holes.
    pub fn hole_triangles(&self) -> usize {
        let covering = |fault: &Fault| match fault.kind {
            Kind::Hole { sides, .. } => (sides as usize).saturating_sub(2).max(1),
            _ => 0,
        };
        self.list.iter().map(covering).sum()
    }
}

impl fmt::Display for Faults {
    /// One line, and one more for each of the first few faults of each kind.
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
        for alike in self.list.chunk_by(|a, b| discriminant(&a.kind) == discriminant(&b.kind)) {
            for fault in alike.iter().take(SHOWN) {
                write!(f, "\n  {fault}")?;
            }
            if alike.len() > SHOWN {
                write!(f, "\n  and {} more", alike.len() - SHOWN)?;
            }
        }
        Ok(())
    }
}

/// Lists the broken invariants of a mesh, each with its place.
///
/// Where faces name missing vertices, only these faces are listed: the other invariants are undefined.
pub fn check(mesh: &Mesh) -> Faults {
    check_joined(mesh, &[])
}

/// As [`check`], for a mesh that may branch: vertices that `branches` marks may have several fans, and edges between two such
/// vertices may have any number of faces.
pub fn check_joined(mesh: &Mesh, branches: &[bool]) -> Faults {
    let may_branch = |vertex: u32| branches.get(vertex as usize).copied().unwrap_or_default();
    let missing = missing_vertices(mesh);
    if !missing.is_empty() {
        return Faults { list: missing, ..Faults::default() };
    }
    let Connectivity { edges, fans, topology, .. } = Connectivity::of(mesh);
    let middle = |ends: [u32; 2]| mesh.middle(&ends).to_array();

    let mut list: Vec<Fault> = (0_u32..)
        .zip(&mesh.points)
        .filter(|(_, point)| !point.iter().all(|x| x.is_finite()))
        .map(|(vertex, &at)| Fault { kind: Kind::NonFinite { vertex }, at })
        .collect();
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
    let mean_edge = mesh.lengths(&edges).iter().sum::<f64>() / edges.len().max(1) as f64;
    list.extend(face_faults(mesh, 1e-6 * mean_edge * mean_edge));
    sort(&mut list);

    let Topology { euler, boundary_loops, components } = topology;
    Faults { list, euler, boundary_loops, components }
}

/// Sorts faults as in [`Faults::list`].
pub(crate) fn sort(list: &mut [Fault]) {
    list.sort_by(|a, b| a.kind.partial_cmp(&b.kind).unwrap_or(Ordering::Equal));
}

fn missing_vertices(mesh: &Mesh) -> Vec<Fault> {
    let mut list = Vec::new();
    for (id, face) in (0..).zip(mesh.faces()) {
        if let Some(&vertex) = face.iter().find(|vertex| **vertex as usize >= mesh.points.len()) {
            let known: Vec<u32> = face.iter().copied().filter(|v| (*v as usize) < mesh.points.len()).collect();
            let kind = Kind::MissingVertex { face: id, vertex };
            list.push(Fault { kind, at: mesh.middle(&known).to_array() });
        }
    }
    list
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
    let mut report = |kind, id: u32| list.push(Fault { kind, at: mesh.middle(mesh.face(id as usize)).to_array() });
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
    let shape_fault = |id: u32| {
        let face = mesh.face(id as usize);
        let point = |k: usize| mesh.place(face[k]);
        let area: f64 =
            (2..face.len()).map(|k| (point(k - 1) - point(0)).cross(point(k) - point(0)).length() / 2.0).sum();
        if face.len() < 3 || area <= least_area {
            return Some((Kind::DegenerateFace { face: id, area }, id));
        }
        let [a, b, c, d] = *face else { return None };
        let shape = quad_shape([a, b, c, d].map(|vertex| mesh.points[vertex as usize]));
        (shape == 0.0).then_some((Kind::ConcaveQuad { face: id }, id))
    };
    let all = (0..mesh.face_count() as u32).into_par_iter().with_min_len(1024);
    let found: Vec<(Kind, u32)> = all.filter_map(shape_fault).collect();
    found.into_iter().for_each(|(kind, id)| report(kind, id));
    list
}
