//! A grid of squares on a square plate, some of its faces, vertices and features otherwise.
#![allow(dead_code, reason = "each test binary compiles this file, and not all use all of it")]

use quadmosaic::mesh::Mesh;
use quadmosaic::surface::{Ends, FeatureOptions, NamedEdge, Soup, Surface};

/// Squares along a side of the grid.
pub const SIDE: u32 = 12;

/// The vertex in a column and a row of the grid.
pub fn at(i: u32, j: u32) -> u32 {
    j * (SIDE + 1) + i
}

/// A mesh on a plate of width `SIDE`.
#[derive(Clone)]
pub struct Grid {
    /// The vertices, where the plate has vertices too.
    pub points: Vec<[f64; 2]>,
    pub faces: Vec<Vec<u32>>,
    /// Edges of the mesh that are features of the plate.
    pub features: Vec<[u32; 2]>,
    /// Vertices that lie elsewhere in the mesh than in the plate.
    pub moved: Vec<(u32, [f64; 2])>,
}

impl Grid {
    /// Squares alone.
    pub fn new() -> Self {
        let points = (0..=SIDE).flat_map(|j| (0..=SIDE).map(move |i| [f64::from(i), f64::from(j)])).collect();
        let cells = (0..SIDE).flat_map(|j| (0..SIDE).map(move |i| (i, j)));
        let faces = cells.map(|(i, j)| vec![at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]).collect();
        Self { points, faces, features: Vec::new(), moved: Vec::new() }
    }

    /// Other faces in the place of some squares, which their first corners name.
    pub fn recut(mut self, gone: &[[u32; 2]], come: &[&[u32]]) -> Self {
        self.faces.retain(|face| !gone.iter().any(|&[i, j]| face[0] == at(i, j)));
        self.faces.extend(come.iter().map(|face| face.to_vec()));
        self
    }

    pub fn moved(mut self, vertex: u32, to: [f64; 2]) -> Self {
        self.moved.push((vertex, to));
        self
    }

    pub fn with_features(mut self, edges: &[[u32; 2]]) -> Self {
        self.features.extend(edges);
        self
    }

    pub fn mesh(&self) -> Mesh {
        let mut mesh = self.unmoved();
        self.moved.iter().for_each(|&(v, [x, y])| mesh.points[v as usize] = [x, y, 0.0]);
        mesh
    }

    /// The plate: two triangles, or where it has features those of the mesh.
    pub fn surface(&self) -> Surface {
        if !self.features.is_empty() {
            return covered(&self.unmoved(), &self.features);
        }
        let n = f64::from(SIDE);
        let points = vec![[0.0; 3], [n, 0.0, 0.0], [n, n, 0.0], [0.0, n, 0.0]];
        let soup = Soup { points, triangles: vec![[0, 1, 2], [0, 2, 3]], ..Soup::default() };
        Surface::new(&soup, &FeatureOptions::default()).unwrap_or_else(|error| panic!("{error}"))
    }

    fn unmoved(&self) -> Mesh {
        let mut mesh = Mesh::new(self.points.iter().map(|&[x, y]| [x, y, 0.0]).collect());
        self.faces.iter().for_each(|face| mesh.push_face(face));
        mesh
    }
}

/// The surface that a flat mesh covers, its polygons cut into triangles; some edges of the mesh are features of it.
pub fn covered(mesh: &Mesh, features: &[[u32; 2]]) -> Surface {
    let mut soup = Soup { points: mesh.points.clone(), ..Soup::default() };
    for face in mesh.faces() {
        // A quad is cut from one of its corners or from the next one.
        let first = usize::from(face.len() == 4 && !sees_all(mesh, face));
        let corner = |k: usize| face[(first + k) % face.len()];
        soup.triangles.extend((2..face.len()).map(|k| [corner(0), corner(k - 1), corner(k)]));
    }
    let edge = |&ends: &[u32; 2]| NamedEdge { ends: Ends::Vertices(ends), name: format!("{ends:?}") };
    let edges: Vec<NamedEdge> = features.iter().map(edge).collect();
    let options = FeatureOptions { crease: 180.0, ..FeatureOptions::default() };
    let surface = Surface::new(&soup, &options).and_then(|surface| surface.with_edges(&soup, &edges, &options));
    surface.unwrap_or_else(|error| panic!("{error}"))
}

/// Whether both halves of a flat quad, cut from its first corner, have an area.
fn sees_all(mesh: &Mesh, quad: &[u32]) -> bool {
    let twice_area = |corners: [usize; 3]| {
        let [p, q, r] = corners.map(|k| mesh.points[quad[k] as usize]);
        (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
    };
    [[0, 1, 2], [0, 2, 3]].map(twice_area).iter().all(|area| *area > 1e-9)
}
