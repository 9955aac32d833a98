//! Where rectangles count as squares: shapes are measured in the tiles' own sides.

use super::clean::Anchors;
use glam::{DMat3, DVec3, Vec3};

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
    /// That of tiles whose crosses and factors are known.
    pub fn new(anchors: &Anchors) -> Self {
        let map = |(v, &factor): (usize, &f32)| {
            let [x, n] = [anchors.axes[v], anchors.normals[v]].map(|way| Vec3::from(way).as_dvec3());
            let y = n.cross(x);
            let factor = f64::from(factor);
            let along = |way: DVec3, by: f64| DMat3::from_cols(way * way.x, way * way.y, way * way.z) * (by - 1.0);
            DMat3::IDENTITY + along(x, 1.0 / factor) + along(y, factor)
        };
        let maps: Vec<DMat3> = anchors.factors.iter().enumerate().map(map).collect();
        Self { rough: if maps.is_empty() { Vec::new() } else { anchors.fixed.clone() }, maps }
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
