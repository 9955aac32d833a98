//! The surface as it was before it was coarsened, onto which the vertices of the finished mesh are projected.
//!
//! # Theory
//! A coarse surface is within a small part of a tile of the fine one, so the nearest triangle of the fine one, or the nearest
//! segment of its features, is found among those whose bounding box, so much larger, holds the vertex.

use super::Surface;
use super::given::{Given, Sheets};
use super::nearest::{nearest_on_segment, nearest_weights};
use crate::geometry::triangle_normal;
use glam::{DVec3, IVec3};
use rustc_hash::FxHashMap;
use std::sync::Arc;

/// The farthest projection, in tile sides.
pub(super) const FARTHEST: f64 = 0.02;
/// The size of the cells in which vertices are found, in tile sides.
const CELL: f64 = 0.5;
/// The cosine of the largest angle between a vertex's normal and that of a triangle onto which it is projected.
const ALIKE: f32 = 0.3;

/// The triangles and the feature edges of a surface.
#[derive(Clone, Debug)]
pub(super) struct Fine {
    sheets: Arc<Sheets>,
    features: Vec<[u32; 2]>,
    given: Given,
    /// The side of tiles, unit-sized.
    side: f64,
}

/// A vertex to project.
pub(crate) struct Projected {
    /// Its place, unit-sized.
    pub point: DVec3,
    /// The normal of its sheet.
    pub normal: DVec3,
    /// Whether it lies on a feature: then it goes onto the nearest feature.
    pub is_on_feature: bool,
}

impl Fine {
    /// That of a surface with these triangles, for tiles of a side, unit-sized.
    pub fn new(surface: &Surface, sheets: Arc<Sheets>, side: f64) -> Self {
        let features = (0..3 * surface.triangle_count() as u32)
            .filter(|&h| surface.features.is_feature(h) && surface.twin(h).is_none_or(|twin| h < twin));
        Self {
            sheets,
            features: features.map(|h| [surface.origin(h), surface.target(h)]).collect(),
            given: surface.given.clone(),
            side,
        }
    }

    fn place(&self, v: u32) -> DVec3 {
        self.sheets.points[v as usize].as_dvec3()
    }

    /// The places of vertices on this surface, in model units; `None` where it is not near.
    pub fn project(&self, vertices: &[Projected]) -> Vec<Option<[f64; 3]>> {
        let (cell, farthest) = (CELL * self.side, FARTHEST * self.side);
        let at = |p: DVec3| (p / cell).floor().as_ivec3();
        let mut cells: FxHashMap<IVec3, Vec<u32>> = FxHashMap::default();
        for (v, vertex) in (0..).zip(vertices) {
            cells.entry(at(vertex.point)).or_default().push(v);
        }
        let mut best: Vec<(f64, Option<[f64; 3]>)> = vec![(farthest * farthest, None); vertices.len()];
        let mut near = Vec::new();
        let nearby = |corners: &[DVec3], near: &mut Vec<u32>| {
            near.clear();
            let low = corners.iter().copied().fold(DVec3::INFINITY, DVec3::min) - farthest;
            let high = corners.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max) + farthest;
            let is_inside = |v: &u32| {
                let p = vertices[*v as usize].point;
                p.cmpge(low).all() && p.cmple(high).all()
            };
            let (first, last) = (at(low), at(high));
            if (last - first + 1).as_i64vec3().element_product() > cells.len() as i64 {
                near.extend((0..vertices.len() as u32).filter(is_inside));
                return;
            }
            for x in first.x..=last.x {
                for y in first.y..=last.y {
                    for z in first.z..=last.z {
                        near.extend(cells.get(&IVec3::new(x, y, z)).into_iter().flatten().copied().filter(is_inside));
                    }
                }
            }
        };
        for corners in &self.sheets.triangles {
            let places = corners.map(|v| self.place(v));
            nearby(&places, &mut near);
            if near.is_empty() {
                continue;
            }
            let normal = triangle_normal(corners.map(|v| self.sheets.points[v as usize]));
            for &v in &near {
                let vertex = &vertices[v as usize];
                if vertex.is_on_feature || normal.dot(vertex.normal.as_vec3()) < ALIKE {
                    continue;
                }
                let weights = nearest_weights(vertex.point, places);
                let nearest: DVec3 = places.iter().zip(weights).map(|(&p, w)| p * w).sum();
                let distance = nearest.distance_squared(vertex.point);
                if distance < best[v as usize].0 {
                    best[v as usize] = (distance, Some(self.given.mean(corners, &weights)));
                }
            }
        }
        for ends in &self.features {
            let [a, b] = ends.map(|v| self.place(v));
            nearby(&[a, b], &mut near);
            for &v in near.iter().filter(|&&v| vertices[v as usize].is_on_feature) {
                let point = vertices[v as usize].point;
                let nearest = nearest_on_segment(point, a, b);
                let distance = nearest.distance_squared(point);
                if distance < best[v as usize].0 {
                    let share = nearest.distance(a) / a.distance(b).max(f64::MIN_POSITIVE);
                    best[v as usize] = (distance, Some(self.given.mean(ends, &[1.0 - share, share])));
                }
            }
        }
        best.into_iter().map(|(_, place)| place).collect()
    }
}

impl Surface {
    /// The places of vertices on the surface as it was before it was coarsened, in model units; `None` where it was not coarsened.
    pub(crate) fn projected(&self, vertices: &[Projected]) -> Option<Vec<Option<[f64; 3]>>> {
        self.fine.as_ref().map(|fine| fine.project(vertices))
    }
}
