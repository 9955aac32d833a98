//! The metric in which shapes are measured: the wanted rectangles are squares in it.
//!
//! # Theory
//! The tile of a vertex has a longer and a shorter side along its cross. A linear map of space scales both to the side of the
//! square of the same area. A face is measured under the mean of its vertices' maps. Where all tiles are squares, every map is
//! the identity and none is stored.

use super::vertex::Vertex;
use glam::{DMat3, DVec3};

/// For each vertex, the linear map of space that makes its tile a square of the same area.
#[derive(Clone, Debug, Default)]
pub struct Metric {
    /// Empty where tiles are squares.
    maps: Vec<DMat3>,
    /// Whether each vertex lies on a feature: its cross is rough, so its map counts only in faces without other vertices.
    rough: Vec<bool>,
}

/// The linear map of a face, and its inverse.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MetricMap {
    forward: DMat3,
    inverse: DMat3,
}

impl Metric {
    /// The metric of vertices. `factors` are the sides of their tiles along their axes over the mean sides; none where tiles are
    /// squares.
    pub(crate) fn new(vertices: &[Vertex], factors: &[f32]) -> Self {
        let map = |(vertex, &factor): (&Vertex, &f32)| {
            let Vertex { axis: x, normal, .. } = *vertex;
            let y = normal.cross(x);
            let factor = f64::from(factor);
            let along = |d: DVec3, by: f64| DMat3::from_cols(d * d.x, d * d.y, d * d.z) * (by - 1.0);
            DMat3::IDENTITY + along(x, 1.0 / factor) + along(y, factor)
        };
        let rough = |(vertex, _): (&Vertex, &f32)| !vertex.is_free();
        Self {
            maps: vertices.iter().zip(factors).map(map).collect(),
            rough: vertices.iter().zip(factors).map(rough).collect(),
        }
    }

    /// Adds a vertex with the map of another one.
    pub(super) fn copy(&mut self, source: u32) {
        if let Some(&map) = self.maps.get(source as usize) {
            self.maps.push(map);
            self.rough.push(self.rough[source as usize]);
        }
    }

    /// The metric of some of the vertices, in order.
    pub(super) fn of(&self, kept: &[u32]) -> Self {
        if self.maps.is_empty() {
            return Self::default();
        }
        Self {
            maps: kept.iter().map(|&v| self.maps[v as usize]).collect(),
            rough: kept.iter().map(|&v| self.rough[v as usize]).collect(),
        }
    }

    /// The map of a face: the mean of its vertices' maps; `None` where tiles are squares.
    pub(crate) fn map_of(&self, face: &[u32]) -> Option<MetricMap> {
        if self.maps.is_empty() {
            return None;
        }
        let all_rough = face.iter().all(|&v| self.rough[v as usize]);
        let mean = |own: &mut dyn Iterator<Item = &u32>| {
            let (sum, count) =
                own.fold((DMat3::ZERO, 0.0), |(sum, count), &v| (sum + self.maps[v as usize], count + 1.0));
            sum * (1.0 / count)
        };
        let forward = mean(&mut face.iter().filter(|&&v| all_rough || !self.rough[v as usize]));
        Some(MetricMap { forward, inverse: forward.inverse() })
    }

    /// The maps of faces, in order; none where tiles are squares.
    pub(super) fn maps_of(&self, faces: impl Iterator<Item = impl AsRef<[u32]>>) -> Vec<MetricMap> {
        if self.maps.is_empty() { Vec::new() } else { faces.filter_map(|face| self.map_of(face.as_ref())).collect() }
    }
}

/// A point under the map of a face.
pub(crate) fn to_metric(map: Option<&MetricMap>, point: DVec3) -> DVec3 {
    map.map_or(point, |map| map.forward * point)
}

/// The point whose image under the map of a face is given.
pub(crate) fn from_metric(map: Option<&MetricMap>, point: DVec3) -> DVec3 {
    map.map_or(point, |map| map.inverse * point)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::quality::quad_shape;
    use crate::mesh::vertex::Place;

    /// Four vertices whose tiles are four times as long as wide along x, the first `rough` of them on features.
    fn metric(rough: usize) -> Metric {
        // Of the same tile, along it or across.
        let axes = [DVec3::X, DVec3::Y, DVec3::NEG_X, DVec3::NEG_Y];
        let vertex = |(v, &axis): (usize, &DVec3)| Vertex {
            point: DVec3::ZERO,
            place: if v < rough { Place::Corner } else { Place::Free },
            triangles: [0; 2],
            normal: DVec3::Z,
            axis,
            valence: 4,
            is_kept: false,
            origin: v as u32,
        };
        let vertices: Vec<Vertex> = axes.iter().enumerate().map(vertex).collect();
        Metric::new(&vertices, &[2.0, 0.5, 2.0, 0.5])
    }

    fn shape(map: Option<&MetricMap>, [x, y]: [f64; 2]) -> f64 {
        let corners = [[0.0, 0.0, 0.0], [x, 0.0, 0.0], [x, y, 0.0], [0.0, y, 0.0]];
        quad_shape(corners.map(|corner| to_metric(map, corner.into()).into()))
    }

    #[test]
    fn the_wanted_rectangle_is_a_square() {
        let map = metric(0).map_of(&[0, 1, 2, 3]);
        assert!((shape(map.as_ref(), [4.0, 1.0]) - 1.0).abs() < 1e-12);
        assert!(shape(map.as_ref(), [1.0, 1.0]) < 0.5, "a square is four times too wide");
        assert!(shape(map.as_ref(), [1.0, 4.0]) < 0.2, "and the rectangle laid across is worse");
        assert!(shape(None, [4.0, 1.0]) < 0.5);
        let place = DVec3::new(0.3, -0.7, 2.0);
        assert!(from_metric(map.as_ref(), to_metric(map.as_ref(), place)).distance(place) < 1e-12);
        assert!((to_metric(map.as_ref(), place).z - place.z).abs() < 1e-12, "heights stay");
    }

    #[test]
    fn vertices_on_features_have_a_say_among_themselves_alone() {
        let mut anchored = metric(2);
        anchored.maps[0] = DMat3::IDENTITY;
        anchored.maps[1] = DMat3::IDENTITY;
        let wanted = |face: &[u32]| shape(anchored.map_of(face).as_ref(), [4.0, 1.0]);
        assert!((wanted(&[0, 1, 2, 3]) - 1.0).abs() < 1e-12);
        assert!(wanted(&[0, 1]) < 0.5, "both on features");
    }

    #[test]
    fn squares_take_no_map() {
        let squares = Metric::default();
        assert!(squares.map_of(&[0, 1, 2]).is_none());
        assert!(squares.maps_of([[0u32, 1, 2]].iter()).is_empty());
        assert!(squares.of(&[0, 3]).maps.is_empty());
    }
}
