//! Topological invariants of meshes and surfaces.

use super::{Edge, Mesh};
use crate::sets::Sets;
use crate::surface::Surface;
use rayon::prelude::*;
use serde::Serialize;

/// Invariants under deformation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Topology {
    /// The Euler characteristic: vertices in use - edges + faces.
    pub euler: i64,
    /// Number of boundary curves. Where curves meet or branch at a vertex, those that are connected count once.
    pub boundary_loops: usize,
    /// Number of connected components; faces that share a vertex are connected.
    pub components: usize,
}

impl Topology {
    /// The topology of a surface whose vertices all have different points.
    pub(super) fn of(surface: &Surface) -> Self {
        let half_edges = 0..3 * surface.triangle_count() as u32;
        let open: Vec<u32> = half_edges.filter(|&h| surface.twin(h).is_none()).collect();
        let edges = (3 * surface.triangle_count() + open.len()) / 2;
        let mut parts = Sets::new(surface.vertex_count());
        surface.triangles.iter().for_each(|&[a, b, c]| {
            parts.join(a, b);
            parts.join(b, c);
        });
        // One boundary edge begins at each boundary vertex.
        let mut loops = Sets::new(surface.vertex_count());
        open.iter().for_each(|&h| loops.join(surface.origin(h), surface.target(h)));
        let inner = surface.vertex_count() - open.len();
        Self {
            euler: surface.vertex_count() as i64 - edges as i64 + surface.triangle_count() as i64,
            boundary_loops: loops.count() - inner,
            components: parts.count(),
        }
    }
}

/// The connectivity of a mesh whose faces name no missing vertex.
pub(super) struct Connectivity {
    /// All edges, as [`Mesh::edges`] lists them.
    pub edges: Vec<Edge>,
    /// For each vertex, the number of fans that its faces form.
    pub fans: Vec<u32>,
    /// The vertices of each closed boundary curve, in order, the mesh to the right.
    pub loops: Vec<Vec<u32>>,
    /// The invariants.
    pub topology: Topology,
}

impl Connectivity {
    pub fn of(mesh: &Mesh) -> Self {
        let ((edges, components), fans) = rayon::join(|| (mesh.edges(), components(mesh)), || fans(mesh));
        let loops = boundary_loops(mesh, &edges);
        let used = fans.iter().filter(|fans| **fans > 0).count();
        let topology = Topology {
            euler: used as i64 - edges.len() as i64 + mesh.face_count() as i64,
            boundary_loops: loop_count(mesh, &edges),
            components,
        };
        Self { edges, fans, loops, topology }
    }
}

/// For each vertex, the number of fans that its faces form: the components under adjacency across the edges at it.
fn fans(mesh: &Mesh) -> Vec<u32> {
    let mut starts = vec![0_u32; mesh.points.len() + 1];
    for &vertex in &mesh.corners {
        starts[vertex as usize + 1] += 1;
    }
    for vertex in 1..starts.len() {
        starts[vertex] += starts[vertex - 1];
    }
    // The neighbours of each vertex in each of its faces, before and after it.
    let mut neighbours = vec![[0_u32; 2]; mesh.corners.len()];
    let mut place = starts.clone();
    for face in mesh.faces() {
        for (k, &vertex) in face.iter().enumerate() {
            let slot = &mut place[vertex as usize];
            neighbours[*slot as usize] = [face[(k + face.len() - 1) % face.len()], face[(k + 1) % face.len()]];
            *slot += 1;
        }
    }
    starts
        .par_windows(2)
        .map(|range| {
            let neighbours = &neighbours[range[0] as usize..range[1] as usize];
            let mut spokes: Vec<(u32, u32)> =
                (0..).zip(neighbours).flat_map(|(id, [before, after])| [(*before, id), (*after, id)]).collect();
            spokes.sort_unstable();
            let mut sets = Sets::new(neighbours.len());
            for pair in spokes.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
                sets.join(pair[0].1, pair[1].1);
            }
            sets.count() as u32
        })
        .collect()
}

/// Follows the free sides of the boundary edges. Where several leave a vertex, the one with the smallest end comes first.
fn boundary_loops(mesh: &Mesh, edges: &[Edge]) -> Vec<Vec<u32>> {
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
    let mut loops = Vec::new();
    for start in 0..free.len() {
        if seen[start] {
            continue;
        }
        let (mut place, mut vertices) = (start, Vec::new());
        loop {
            seen[place] = true;
            vertices.push(free[place][0]);
            let end = free[place][1];
            let next = first[end as usize] as usize;
            let Some(unseen) = (next..free.len()).take_while(|k| free[*k][0] == end).find(|k| !seen[*k]) else { break };
            place = unseen;
        }
        loops.push(vertices);
    }
    loops
}

/// The number of boundary curves; those that are connected count once.
fn loop_count(mesh: &Mesh, edges: &[Edge]) -> usize {
    let mut curves = Sets::new(mesh.points.len());
    let mut on_boundary = vec![false; mesh.points.len()];
    for [a, b] in edges.iter().filter(|edge| edge.is_boundary()).map(|edge| edge.ends) {
        curves.join(a, b);
        (on_boundary[a as usize], on_boundary[b as usize]) = (true, true);
    }
    curves.count() - on_boundary.iter().filter(|is_on| !**is_on).count()
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
    sets.count() - used.iter().filter(|used| !**used).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// So many squares at one edge, as the pages of a book at its spine, whose numbers are in this order.
    fn book(pages: u32, numbers: [u32; 2]) -> Mesh {
        let mut mesh = Mesh::new(vec![[0.0; 3]; 2 + 2 * pages as usize]);
        for page in 0..pages {
            let outer = 2 + 2 * page;
            mesh.push_face(&[numbers[0], numbers[1], outer + 1, outer]);
        }
        mesh
    }

    #[test]
    fn boundaries_that_branch_count_once_whatever_the_numbers_of_vertices() {
        for pages in 3..8 {
            for numbers in [[0, 1], [1, 0]] {
                assert_eq!(Connectivity::of(&book(pages, numbers)).topology.boundary_loops, 1, "{pages} pages");
            }
        }
        // Those of two triangles that touch at a vertex are one.
        for petals in [[0, 1, 2, 0, 3, 4], [4, 3, 2, 4, 1, 0]] {
            let mut flower = Mesh::new(vec![[0.0; 3]; 5]);
            petals.chunks(3).for_each(|petal| flower.push_face(petal));
            assert_eq!(Connectivity::of(&flower).topology.boundary_loops, 1);
        }
        // Two that do not touch are two, and those of a strip of two squares are one.
        let mut two = book(3, [0, 1]);
        two.points.extend([[0.0; 3]; 4]);
        two.push_face(&[8, 9, 10, 11]);
        assert_eq!(Connectivity::of(&two).topology.boundary_loops, 2);
    }
}
