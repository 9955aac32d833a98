//! Singularities near features, moved onto them.
//!
//! # Theory
//! Rows that pass over the whole surface meet a feature at a whole number of tiles from each singularity. A singularity that is
//! nearer than about a tile has no room for a row between itself and the feature: it lies on the feature. There the sector of the
//! nearest vertex gets one quarter turn more (fewer for a positive index), and the field that is solved for again has the singularity
//! no more: by Poincaré and Hopf the index moves from the triangle to the vertex.

use super::Sectors;
use super::singularities::{Singularity, SingularityLocation};
use crate::surface::{Surface, next};
use glam::DVec3;
use rustc_hash::{FxHashMap, FxHashSet};
use std::f64::consts::FRAC_PI_2;

/// The angles that a quarter turn of a sector may stand for, in radians.
const QUARTER: std::ops::RangeInclusive<f64> = 0.55 * FRAC_PI_2..=1.45 * FRAC_PI_2;

/// Singularities beside a closed curve that holds another one move onto it from so many times as far away.
const FOLLOWING: f64 = 2.0;

impl Sectors {
    /// Moves singularities onto features that are nearer than `reach`, in unit-sized coordinates; whether there were any. Where one lies
    /// on a closed curve, the others beside it follow from farther away, so that the rows round a hole fit.
    pub(super) fn absorb(&mut self, surface: &Surface, singularities: &[Singularity], reach: f64) -> bool {
        let shared = surface.shared_places();
        let mut curve_of = FxHashMap::default();
        let mut holding = FxHashSet::default();
        for (number, curve) in surface.features().curves().iter().enumerate().filter(|(_, curve)| curve.closed) {
            curve_of.extend(curve.vertices.iter().map(|&vertex| (vertex, number)));
            if curve.vertices.iter().any(|vertex| self.absorbing().binary_search(vertex).is_ok()) {
                holding.insert(number);
            }
        }
        let near: Vec<(i32, Vec<(u32, f64)>)> = singularities
            .iter()
            .filter_map(|singularity| match singularity.location {
                SingularityLocation::Triangle(triangle) => {
                    let position = DVec3::from(singularity.position);
                    let near = self.near_features(surface, triangle, position, FOLLOWING * reach);
                    Some((singularity.quarters, near))
                }
                SingularityLocation::Corner(_) => None,
            })
            .collect();
        let curve = |corner: u32| curve_of.get(&surface.origin(corner)).copied();
        let nearest = near.iter().filter_map(|(_, near)| near.first().filter(|&&(_, distance)| distance < reach));
        holding.extend(nearest.filter_map(|&(corner, _)| curve(corner)));
        let mut taken = FxHashSet::default();
        for (index, near) in near {
            let free = near.into_iter().find_map(|(corner, distance)| {
                let vertex = surface.origin(corner);
                let is_near = distance < reach || curve(corner).is_some_and(|curve| holding.contains(&curve));
                let is_free = !taken.contains(&vertex) && !shared[vertex as usize];
                let quarters = self.turned(surface, corner, index).filter(|_| is_near && is_free)?;
                Some((corner, quarters))
            });
            if let Some((corner, quarters)) = free {
                taken.insert(surface.origin(corner));
                self.set_quarters(surface, self.of_corner[corner as usize], quarters);
            }
        }
        !taken.is_empty()
    }

    /// The quarters of a corner's sector that takes in a singularity; `None` where angles would become too sharp or too flat.
    fn turned(&self, surface: &Surface, corner: u32, index: i32) -> Option<u8> {
        let sector = self.of_corner[corner as usize];
        let before = self.quarters[sector as usize];
        let quarters = u8::try_from(i32::from(before) - index).ok().filter(|&quarters| before > 0 && quarters > 0)?;
        let angle: f64 = self.corners(surface, sector).map(|corner| self.corner_angle(corner)).sum();
        QUARTER.contains(&(angle / f64::from(quarters))).then_some(quarters)
    }

    /// A corner of each sector on a feature that can be reached from a point of a triangle within a distance, the nearest first.
    fn near_features(&self, surface: &Surface, triangle: u32, position: DVec3, reach: f64) -> Vec<(u32, f64)> {
        let mut found: Vec<(u32, f64)> = Vec::new();
        let (mut seen, mut sectors) = (FxHashSet::from_iter([triangle]), FxHashSet::default());
        let mut queue = vec![triangle];
        while let Some(t) = queue.pop() {
            for h in 3 * t..3 * t + 3 {
                let [a, b] = [h, next(h)].map(|h| surface.points[surface.origin(h) as usize].as_dvec3());
                let sector = self.of_corner[h as usize];
                if self.quarters[sector as usize] > 0 && position.distance(a) < reach && sectors.insert(sector) {
                    found.push((h, position.distance(a)));
                }
                let Some(twin) = surface.twin(h).filter(|_| !surface.features().is_feature(h)) else { continue };
                let along = (b - a).normalize_or_zero();
                let nearest = a + along * (position - a).dot(along).clamp(0.0, a.distance(b));
                if position.distance(nearest) < reach && seen.insert(twin / 3) {
                    queue.push(twin / 3);
                }
            }
        }
        found.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compute::Cpu;
    use crate::field::{Field, FieldOptions};
    use crate::surface::FeatureOptions;
    use crate::surface::examples::Example;

    /// Distances of the singularities inside triangles to the nearest vertex of a feature, ascending, and the sum of all
    /// quarters.
    fn near_features(surface: &Surface, absorb: f64) -> (Vec<f64>, i32) {
        let options = FieldOptions { absorb, ..FieldOptions::default() };
        let field = Field::new(surface, &options, &Cpu).expect("the CPU does not fail");
        let on_features: Vec<DVec3> = surface
            .features()
            .curves()
            .iter()
            .flat_map(|curve| &curve.vertices)
            .map(|&v| surface.points[v as usize].as_dvec3())
            .collect();
        let all = field.singularities(surface);
        let inside = all.iter().filter(|singularity| matches!(singularity.location, SingularityLocation::Triangle(_)));
        let mut distances: Vec<f64> = inside
            .map(|singularity| {
                let place = DVec3::from(singularity.position);
                on_features.iter().map(|point| point.distance(place)).fold(f64::INFINITY, f64::min)
            })
            .collect();
        distances.sort_by(f64::total_cmp);
        (distances, all.iter().map(|singularity| singularity.quarters).sum())
    }

    #[test]
    fn singularities_beside_bolt_holes_move_onto_them_and_indices_keep_their_sum() {
        let surface = Surface::new(&Example::Flange.generate(6_000), &FeatureOptions::default())
            .unwrap_or_else(|error| panic!("{error}"));
        let diagonal = surface.frame().diagonal;
        let reach = 0.06 / diagonal;
        let (before, sum) = near_features(&surface, 0.0);
        assert!(before[0] < reach, "without it some are near: {before:?}");
        let (after, sum_after) = near_features(&surface, 0.06);
        assert!(after.first().is_none_or(|&least| least >= reach), "{after:?}");
        // Four times the Euler characteristic.
        assert_eq!((sum, sum_after), (-96, -96));
    }

    #[test]
    fn an_edge_takes_in_a_negative_index_alone_and_a_right_angle_none() {
        let surface = Surface::new(&Example::Plate.generate(3_000), &FeatureOptions::default())
            .unwrap_or_else(|error| panic!("{error}"));
        let sectors = Sectors::new(&surface);
        let of_quarters = |quarters: u8| {
            let sector = sectors.quarters.iter().position(|&own| own == quarters).expect("the plate has such a sector");
            [-2, -1, 1].map(|index| sectors.turned(&surface, sectors.first_corner[sector], index))
        };
        // Half a turn is three quarters of 60 degrees, but not four of 45 or one of 180; a right angle is nothing else.
        assert_eq!(of_quarters(2), [None, Some(3), None]);
        assert_eq!(of_quarters(1), [None; 3]);
        assert_eq!(of_quarters(0), [None; 3], "a vertex within the surface takes none in");
    }
}
