//! Where rectangles count as squares: shapes are measured in the tiles' own sides.

use super::surface_mesh::Vertex;
use glam::{DMat3, DVec3};

/// At each vertex, the linear map of space that makes the tile wanted there a square of the same area.
#[derive(Clone, Debug, Default)]
pub struct Metric {
    /// None where tiles are squares anyway.
    maps: Vec<DMat3>,
    /// Vertices whose map is rough, as crosses on features are: they have a say among themselves alone.
    rough: Vec<bool>,
}

/// The map of a face, and back.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    forth: DMat3,
    back: DMat3,
}

impl Metric {
    /// That of vertices whose tiles have these sides along their axes, over their mean sides; empty where tiles are squares.
    pub(crate) fn new(vertices: &[Vertex], factors: &[f32]) -> Self {
        let map = |(vertex, &factor): (&Vertex, &f32)| {
            let Vertex { axis: x, normal, .. } = *vertex;
            let y = normal.cross(x);
            let factor = f64::from(factor);
            let along = |way: DVec3, by: f64| DMat3::from_cols(way * way.x, way * way.y, way * way.z) * (by - 1.0);
            DMat3::IDENTITY + along(x, 1.0 / factor) + along(y, factor)
        };
        let rough = |(vertex, _): (&Vertex, &f32)| !vertex.is_free();
        Self {
            maps: vertices.iter().zip(factors).map(map).collect(),
            rough: vertices.iter().zip(factors).map(rough).collect(),
        }
    }

    /// Takes note of a new vertex, which is a copy of another.
    pub(super) fn copy(&mut self, source: u32) {
        if let Some(&map) = self.maps.get(source as usize) {
            self.maps.push(map);
            self.rough.push(self.rough[source as usize]);
        }
    }

    /// That of some of the vertices, in order.
    pub(super) fn of(&self, kept: &[u32]) -> Self {
        if self.maps.is_empty() {
            return Self::default();
        }
        Self {
            maps: kept.iter().map(|&v| self.maps[v as usize]).collect(),
            rough: kept.iter().map(|&v| self.rough[v as usize]).collect(),
        }
    }

    /// The map of a face: the mean of its vertices'; `None` where tiles are squares.
    pub(crate) fn frame(&self, face: &[u32]) -> Option<Frame> {
        if self.maps.is_empty() {
            return None;
        }
        let all_rough = face.iter().all(|&v| self.rough[v as usize]);
        let mean = |own: &mut dyn Iterator<Item = &u32>| {
            let (sum, count) =
                own.fold((DMat3::ZERO, 0.0), |(sum, count), &v| (sum + self.maps[v as usize], count + 1.0));
            sum * (1.0 / count)
        };
        let forth = mean(&mut face.iter().filter(|&&v| all_rough || !self.rough[v as usize]));
        Some(Frame { forth, back: forth.inverse() })
    }

    /// The frames of faces, in order; none where tiles are squares.
    pub(super) fn frames(&self, faces: impl Iterator<Item = impl AsRef<[u32]>>) -> Vec<Frame> {
        if self.maps.is_empty() { Vec::new() } else { faces.filter_map(|face| self.frame(face.as_ref())).collect() }
    }
}

/// A place as its face measures it.
pub(crate) fn laid(frame: Option<&Frame>, place: DVec3) -> DVec3 {
    frame.map_or(place, |frame| frame.forth * place)
}

/// The place that a face measures so.
pub(crate) fn lifted(frame: Option<&Frame>, place: DVec3) -> DVec3 {
    frame.map_or(place, |frame| frame.back * place)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::quality::quad_shape;
    use crate::mesh::surface_mesh::Place;

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
            origin: v as u32,
        };
        let vertices: Vec<Vertex> = axes.iter().enumerate().map(vertex).collect();
        Metric::new(&vertices, &[2.0, 0.5, 2.0, 0.5])
    }

    fn shape(frame: Option<&Frame>, [x, y]: [f64; 2]) -> f64 {
        let corners = [[0.0, 0.0, 0.0], [x, 0.0, 0.0], [x, y, 0.0], [0.0, y, 0.0]];
        quad_shape(corners.map(|corner| laid(frame, corner.into()).into()))
    }

    #[test]
    fn the_wanted_rectangle_is_a_square() {
        let frame = metric(0).frame(&[0, 1, 2, 3]);
        assert!((shape(frame.as_ref(), [4.0, 1.0]) - 1.0).abs() < 1e-12);
        assert!(shape(frame.as_ref(), [1.0, 1.0]) < 0.5, "a square is four times too wide");
        assert!(shape(frame.as_ref(), [1.0, 4.0]) < 0.2, "and the rectangle laid across is worse");
        assert!(shape(None, [4.0, 1.0]) < 0.5);
        let place = DVec3::new(0.3, -0.7, 2.0);
        assert!(lifted(frame.as_ref(), laid(frame.as_ref(), place)).distance(place) < 1e-12);
        assert!((laid(frame.as_ref(), place).z - place.z).abs() < 1e-12, "heights stay");
    }

    #[test]
    fn vertices_on_features_have_a_say_among_themselves_alone() {
        let mut anchored = metric(2);
        anchored.maps[0] = DMat3::IDENTITY;
        anchored.maps[1] = DMat3::IDENTITY;
        let wanted = |face: &[u32]| shape(anchored.frame(face).as_ref(), [4.0, 1.0]);
        assert!((wanted(&[0, 1, 2, 3]) - 1.0).abs() < 1e-12);
        assert!(wanted(&[0, 1]) < 0.5, "both on features");
    }

    #[test]
    fn squares_take_no_map() {
        let squares = Metric::default();
        assert!(squares.frame(&[0, 1, 2]).is_none());
        assert!(squares.frames([[0u32, 1, 2]].iter()).is_empty());
        assert!(squares.of(&[0, 3]).maps.is_empty());
    }
}
