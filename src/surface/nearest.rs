//! The triangle nearest to a point: a uniform grid of the triangles' boxes.

use super::Surface;
use glam::DVec3;

/// Most cells along an axis.
const MOST_CELLS: f64 = 128.0;

/// The triangles of a surface by the cells of a cubic grid that their boxes touch.
pub(crate) struct TriangleGrid<'a> {
    surface: &'a Surface,
    low: DVec3,
    cell: f64,
    cells: [usize; 3],
    starts: Vec<u32>,
    triangles: Vec<u32>,
}

impl<'a> TriangleGrid<'a> {
    /// Sorts the triangles of a surface into cells.
    pub fn new(surface: &'a Surface) -> Self {
        let places = || surface.points.iter().map(|p| p.as_dvec3());
        let low = places().fold(DVec3::INFINITY, DVec3::min);
        let size = places().fold(DVec3::NEG_INFINITY, DVec3::max) - low;
        // A few triangles a cell where they are even: a surface crosses about the square of the cells along an axis.
        let along = (surface.triangle_count() as f64 / 4.0).sqrt().clamp(1.0, MOST_CELLS);
        let cell = size.max_element() / along;
        let cells = size.to_array().map(|length| (length / cell) as usize + 1);
        let mut grid = Self { surface, low, cell, cells, starts: Vec::new(), triangles: Vec::new() };
        let mut starts = vec![0u32; cells.iter().product::<usize>() + 1];
        let boxes = || (0..surface.triangle_count()).map(|t| grid.of_face(t));
        boxes().for_each(|range| grid.each(range, |cell| starts[cell + 1] += 1));
        for cell in 1..starts.len() {
            starts[cell] += starts[cell - 1];
        }
        let mut place = starts.clone();
        let mut triangles = vec![0; starts[starts.len() - 1] as usize];
        for (t, range) in boxes().enumerate() {
            grid.each(range, |cell| {
                triangles[place[cell] as usize] = t as u32;
                place[cell] += 1;
            });
        }
        (grid.starts, grid.triangles) = (starts, triangles);
        grid
    }

    /// The triangle nearest to a point, and how far it is; of several the first.
    pub fn nearest(&self, point: DVec3) -> (u32, f64) {
        let centre = self.coordinates(point);
        let mut best = (f64::INFINITY, u32::MAX);
        for ring in 0..=self.cells.into_iter().max().unwrap_or(0) {
            let range = [0, 1, 2].map(|k| [centre[k].saturating_sub(ring), (centre[k] + ring).min(self.cells[k] - 1)]);
            self.each(range, |cell| {
                // Cells inside the ring have been seen.
                let at = self.place(cell);
                if (0..3).any(|k| at[k].abs_diff(centre[k]) == ring) {
                    for &t in self.of_cell(cell) {
                        let corners = self.surface.corners(t as usize).map(|p| p.as_dvec3());
                        let found = (squared_distance(point, corners), t);
                        if found < best {
                            best = found;
                        }
                    }
                }
            });
            if best.0 <= (ring as f64 * self.cell).powi(2) {
                break;
            }
        }
        (best.1, best.0.sqrt())
    }

    fn of_cell(&self, cell: usize) -> &[u32] {
        &self.triangles[self.starts[cell] as usize..self.starts[cell + 1] as usize]
    }

    fn of_face(&self, triangle: usize) -> [[usize; 2]; 3] {
        let corners = self.surface.corners(triangle).map(|p| p.as_dvec3());
        let low = self.coordinates(corners.into_iter().fold(DVec3::INFINITY, DVec3::min));
        let high = self.coordinates(corners.into_iter().fold(DVec3::NEG_INFINITY, DVec3::max));
        [0, 1, 2].map(|k| [low[k], high[k]])
    }

    /// The cell of a point, or the one nearest to it.
    fn coordinates(&self, point: DVec3) -> [usize; 3] {
        let at = ((point - self.low) / self.cell).to_array();
        // A cast takes numbers below zero to zero.
        [0, 1, 2].map(|k| (at[k] as usize).min(self.cells[k] - 1))
    }

    fn place(&self, cell: usize) -> [usize; 3] {
        let [nx, ny, _] = self.cells;
        [cell % nx, cell / nx % ny, cell / nx / ny]
    }

    fn each(&self, [x, y, z]: [[usize; 2]; 3], mut visit: impl FnMut(usize)) {
        for k in z[0]..=z[1] {
            for j in y[0]..=y[1] {
                (x[0]..=x[1]).for_each(|i| visit((k * self.cells[1] + j) * self.cells[0] + i));
            }
        }
    }
}

/// The squared distance of a point from a triangle.
pub(crate) fn squared_distance(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let (ab, ac) = (b - a, c - a);
    let normal = ab.cross(ac);
    let inside = [(a, b), (b, c), (c, a)].iter().all(|&(s, e)| (e - s).cross(p - s).dot(normal) >= 0.0);
    if inside && normal.length_squared() > 0.0 {
        return (p - a).dot(normal).powi(2) / normal.length_squared();
    }
    let to_side = |s, e| nearest_on_segment(p, s, e).distance_squared(p);
    to_side(a, b).min(to_side(b, c)).min(to_side(c, a))
}

/// The point of a segment, perhaps of no length, that is nearest to `p`.
pub(crate) fn nearest_on_segment(p: DVec3, start: DVec3, end: DVec3) -> DVec3 {
    let way = end - start;
    let share = (p - start).dot(way) / way.length_squared().max(f64::MIN_POSITIVE);
    start + way * share.clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::FeatureOptions;
    use crate::surface::examples::Example;

    #[test]
    fn the_grid_finds_what_a_search_of_all_finds() {
        for (name, triangles) in [("m6", 2_000), ("block", 3_000), ("plate", 10)] {
            let soup = name.parse::<Example>().expect("an example's name").generate(triangles);
            let surface = Surface::new(&soup, &FeatureOptions::default()).unwrap_or_else(|error| panic!("{error}"));
            let grid = TriangleGrid::new(&surface);
            let corners = |t: usize| surface.corners(t).map(|p| p.as_dvec3());
            let mut state = 1u32;
            let mut random = || {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                f64::from(state) / f64::from(u32::MAX) - 0.5
            };
            for number in 0..500 {
                // Inside the surface's box, and up to three times as far.
                let scale = [1.0, 3.0][number % 2];
                let point = DVec3::new(random(), random(), random()) * scale;
                let all = (0..surface.triangle_count()).map(|t| (squared_distance(point, corners(t)), t as u32));
                let (square, t) = all.min_by(|a, b| a.0.total_cmp(&b.0)).expect("a triangle");
                assert_eq!(grid.nearest(point), (t, square.sqrt()), "{name}, {point}");
            }
        }
    }
}
