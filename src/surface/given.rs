//! The input behind a surface: the f64 coordinates of its vertices, and its triangles where noise was smoothed or they were coarsened.

use super::split::Split;
use super::{Frame, Soup, Surface};
use glam::{DVec3, Vec3};

/// A vertex nearer than this to a corner of the input, in diagonals, is that corner: some roundings of f32.
pub(super) const SAME: f64 = 1e-6;

/// Triangles, unit-sized: those of a surface as they were given, or before it was coarsened.
#[derive(Clone, Debug)]
pub(crate) struct Sheets {
    pub points: Vec<Vec3>,
    pub triangles: Vec<[u32; 3]>,
    /// How far the surface may be from them.
    pub off: f64,
}

/// What a surface has of its input.
#[derive(Clone, Debug, Default)]
pub(super) struct Given {
    /// The vertices, in model units.
    pub points: Vec<[f64; 3]>,
}

impl Given {
    /// That of welded triangles, of which `sources` gives the triangles of the soup.
    pub fn new(soup: &Soup, sources: &[u32], triangles: &[[u32; 3]], points: &[Vec3], frame: &Frame) -> Self {
        let mut found = vec![(f64::INFINITY, [0.0; 3]); points.len()];
        for (corners, &source) in triangles.iter().zip(sources) {
            // Orientation may have exchanged corners, and welding may have moved them: the nearest one is meant.
            for &given in &soup.triangles[source as usize] {
                let given = soup.points[given as usize];
                let unit = DVec3::from(frame.to_unit(given));
                for &v in corners {
                    let distance = points[v as usize].as_dvec3().distance_squared(unit);
                    if distance < found[v as usize].0 {
                        found[v as usize] = (distance, given);
                    }
                }
            }
        }
        // Vertices that repairs add have no corner of the input.
        let model = |(&point, (distance, given)): (&Vec3, (f64, [f64; 3]))| match distance <= SAME * SAME {
            true => given,
            false => frame.to_model(point.as_dvec3().into()),
        };
        Self { points: points.iter().zip(found).map(model).collect() }
    }

    /// That of the parts of a surface's triangles.
    pub fn split(surface: &Surface, split: &Split) -> Self {
        let mut points = surface.given.points.clone();
        points.extend(split.cuts.iter().map(|&(h, share)| surface.model_point_on(h, share)));
        Self { points }
    }

    /// The weighted mean of vertices, in model units; exact where the vertices have the same coordinate.
    pub fn mean<const N: usize>(&self, vertices: &[u32; N], weights: &[f64; N]) -> [f64; 3] {
        let first = DVec3::from(self.points[vertices[0] as usize]);
        let offset = |(&v, &weight): (&u32, &f64)| (DVec3::from(self.points[v as usize]) - first) * weight;
        (first + vertices.iter().zip(weights).map(offset).sum::<DVec3>()).into()
    }

    /// Replaces the coordinates of the points that moved from `before`, in unit-sized coordinates.
    pub fn follow(&mut self, before: &[Vec3], after: &[Vec3], frame: &Frame) {
        for ((given, before), after) in self.points.iter_mut().zip(before).zip(after) {
            if before != after {
                *given = frame.to_model(after.as_dvec3().into());
            }
        }
    }
}

impl Surface {
    /// A vertex in model units; one of the input has its coordinates, but where the surface was smoothed.
    pub fn model_point(&self, vertex: u32) -> [f64; 3] {
        self.given.points[vertex as usize]
    }

    /// The point at a share of the way along a half-edge, in model units. Its coordinates are those of the ends where these have
    /// the same.
    pub(crate) fn model_point_on(&self, half_edge: u32, share: f64) -> [f64; 3] {
        let [a, b] = [self.origin(half_edge), self.target(half_edge)].map(|v| DVec3::from(self.model_point(v)));
        (a + (b - a) * share).into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::FeatureOptions;

    /// A tilted square far from the origin, of two triangles, one of them turned over.
    fn square() -> Soup {
        let points = vec![[1e3 + 0.1, 0.2, 0.3], [1e3 + 1.1, 0.2, 0.7], [1e3 + 1.1, 1.3, 0.7], [1e3 + 0.1, 1.3, 0.3]];
        Soup { points, triangles: vec![[0, 1, 2], [0, 3, 2]], ..Soup::default() }
    }

    #[test]
    fn vertices_have_the_coordinates_of_the_input_and_middles_lie_between() {
        let soup = square();
        let options = FeatureOptions::default();
        let surface = Surface::new(&soup, &options).expect("a surface");
        let is_given = |surface: &Surface, v: u32| soup.points.contains(&surface.model_point(v));
        assert!((0..4).all(|v| is_given(&surface, v)));
        let lossy = |v: u32| surface.frame().to_model(surface.point(v)) != surface.model_point(v);
        assert!((0..4).any(lossy), "f32 would not have kept them");
        let (divided, _) = surface.divided(vec![0.2; 4], &options);
        assert!((0..4).all(|v| is_given(&divided, v)));
        for v in 0..divided.vertex_count() as u32 {
            let [x, y, z] = divided.model_point(v);
            assert!((z - 0.3 - 0.4 * (x - 1e3 - 0.1)).abs() < 1e-12, "{x} {z}");
            let [x0, y0, _] = divided.frame().to_model(divided.point(v));
            assert!((x - x0).abs() < 1e-6 && (y - y0).abs() < 1e-6);
        }
    }
}
