//! Finds the edges of the surface that the user names.

use super::{Ends, NamedEdge, Soup, Surface, SurfaceError};
use glam::DVec3;
use rustc_hash::FxHashMap;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// The largest distance of an end from its vertex, in diagonals of the bounding box.
const NEAR: f64 = 1e-5;
/// The largest length of a line of edges over the distance of its ends.
const STRAIGHT: f64 = 1.05;

/// The half-edges that the edges name: the edge between the two ends, or the shortest line of edges if that is straight.
///
/// # Errors
/// Where there is no vertex at an end, or no straight line of edges between two.
pub(super) fn find(surface: &Surface, soup: &Soup, edges: &[NamedEdge]) -> Result<Vec<u32>, SurfaceError> {
    let paths = Paths::new(surface);
    let mut named = Vec::new();
    for edge in edges {
        let mut places = [[0.0; 3]; 2];
        for (k, place) in places.iter_mut().enumerate() {
            *place = match edge.ends {
                Ends::Points(points) => points[k],
                Ends::Vertices(numbers) => {
                    let number = numbers[k] as usize;
                    let missing = || SurfaceError::NoSuchVertex { name: edge.name.clone(), number: number + 1 };
                    *soup.points.get(number).ok_or_else(missing)?
                }
            };
        }
        let mut starts = [Vec::new(), Vec::new()];
        for (start, &at) in starts.iter_mut().zip(&places) {
            *start = paths.vertices_at(DVec3::from(surface.frame().to_unit(at)));
            if start.is_empty() {
                return Err(SurfaceError::NoVertexAt { name: edge.name.clone(), at });
            }
        }
        let found = paths.between(&starts[0], &starts[1]);
        named.extend(found.ok_or(SurfaceError::NoEdges { name: edge.name.clone(), from: places[0], to: places[1] })?);
    }
    Ok(named)
}

/// Vertices by place, and the edges that leave them.
struct Paths<'a> {
    surface: &'a Surface,
    cells: FxHashMap<[i64; 3], Vec<u32>>,
    /// Half-edges that leave or enter each vertex.
    edges: Vec<Vec<u32>>,
}

impl<'a> Paths<'a> {
    fn new(surface: &'a Surface) -> Self {
        let mut cells: FxHashMap<[i64; 3], Vec<u32>> = FxHashMap::default();
        for (v, point) in (0..).zip(&surface.points) {
            cells.entry(cell(point.as_dvec3())).or_default().push(v);
        }
        let mut edges = vec![Vec::new(); surface.vertex_count()];
        for h in 0..3 * surface.triangle_count() as u32 {
            edges[surface.origin(h) as usize].push(h);
            if surface.twin(h).is_none() {
                edges[surface.target(h) as usize].push(h);
            }
        }
        Self { surface, cells, edges }
    }

    /// The nearest vertices to a place, all of them where sheets meet.
    fn vertices_at(&self, place: DVec3) -> Vec<u32> {
        let [low, high] = [place - NEAR, place + NEAR].map(cell);
        let mut found: Vec<(f64, u32)> = Vec::new();
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                for z in low[2]..=high[2] {
                    let near = self.cells.get(&[x, y, z]).into_iter().flatten();
                    found.extend(near.map(|&v| (self.surface.points[v as usize].as_dvec3().distance(place), v)));
                }
            }
        }
        found.retain(|&(distance, _)| distance <= NEAR);
        found.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let nearest = found.first().map_or(0.0, |first| first.0);
        found.into_iter().take_while(|&(distance, _)| distance <= nearest).map(|(_, v)| v).collect()
    }

    /// The half-edges of the shortest paths between two places, one for each sheet that has one; `None` where no path is
    /// straight.
    fn between(&self, from: &[u32], to: &[u32]) -> Option<Vec<u32>> {
        let ways = from.iter().filter_map(|&start| self.shortest(start, to));
        let ways: Vec<Vec<u32>> = ways.filter(|way| !way.is_empty()).collect();
        let both = |h: u32| [Some(h), self.surface.twin(h)].into_iter().flatten();
        (!ways.is_empty()).then(|| ways.into_iter().flatten().flat_map(both).collect())
    }

    fn shortest(&self, start: u32, to: &[u32]) -> Option<Vec<u32>> {
        let point = |v: u32| self.surface.points[v as usize].as_dvec3();
        let goal = point(to[0]);
        let limit = STRAIGHT * point(start).distance(goal);
        // The length of the path to each vertex reached, and the path's last half-edge.
        let mut reached: FxHashMap<u32, (f64, u32)> = FxHashMap::default();
        let mut queue = BinaryHeap::from([(Reverse(0u64), start)]);
        reached.insert(start, (0.0, super::NONE));
        while let Some((_, v)) = queue.pop() {
            let so_far = reached[&v].0;
            if to.contains(&v) {
                return Some(self.way_back(&reached, start, v));
            }
            for &h in &self.edges[v as usize] {
                let w = self.other_end(h, v);
                let length = so_far + self.surface.length(h);
                let hope = length + point(w).distance(goal);
                if hope <= limit && reached.get(&w).is_none_or(|&(known, _)| length < known) {
                    reached.insert(w, (length, h));
                    queue.push((Reverse(hope.to_bits()), w));
                }
            }
        }
        None
    }

    fn way_back(&self, reached: &FxHashMap<u32, (f64, u32)>, start: u32, mut v: u32) -> Vec<u32> {
        let mut way = Vec::new();
        while v != start {
            let h = reached[&v].1;
            way.push(h);
            v = self.other_end(h, v);
        }
        way
    }

    fn other_end(&self, half_edge: u32, vertex: u32) -> u32 {
        let origin = self.surface.origin(half_edge);
        if origin == vertex { self.surface.target(half_edge) } else { origin }
    }
}

fn cell(place: DVec3) -> [i64; 3] {
    (place / (4.0 * NEAR)).floor().as_i64vec3().to_array()
}
