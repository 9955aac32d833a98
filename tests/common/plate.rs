//! A grid of squares on a square plate, some of its vertices elsewhere.

use quadmosaic::mesh::Mesh;
use quadmosaic::mesh::smooth::Smoothed;
use quadmosaic::surface::{FeatureOptions, Soup, Surface};

/// Squares along a side of the grid.
pub const SIDE: usize = 6;

/// A square plate of two triangles, the lower right one first.
pub fn plate() -> Surface {
    let n = SIDE as f64;
    let points = vec![[0.0; 3], [n, 0.0, 0.0], [n, n, 0.0], [0.0, n, 0.0]];
    let soup = Soup { points, triangles: vec![[0, 1, 2], [0, 2, 3]], ..Soup::default() };
    Surface::new(&soup, &FeatureOptions::default()).unwrap()
}

pub fn at(i: usize, j: usize) -> usize {
    j * (SIDE + 1) + i
}

/// A grid of squares on the plate with some vertices elsewhere.
pub fn grid(surface: &Surface, moved: &[(usize, [f64; 2])]) -> Smoothed {
    let mut places: Vec<[f64; 2]> = (0..=SIDE).flat_map(|j| (0..=SIDE).map(move |i| [i as f64, j as f64])).collect();
    moved.iter().for_each(|&(v, place)| places[v] = place);
    let mut mesh = Mesh::new(places.iter().map(|&[x, y]| surface.frame().to_unit([x, y, 0.0])).collect());
    for (i, j) in (0..SIDE).flat_map(|j| (0..SIDE).map(move |i| (i, j))) {
        mesh.push_face(&[at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)].map(|v| v as u32));
    }
    let n = SIDE as f64;
    let on_rim = |&[x, y]: &[f64; 2]| x == 0.0 || y == 0.0 || x == n || y == n;
    let below = places.iter().map(|place| (!on_rim(place)).then_some(u32::from(place[1] > place[0]))).collect();
    Smoothed { mesh, below }
}
