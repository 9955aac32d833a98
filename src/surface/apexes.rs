//! Apexes: tips of cones and spikes that are sharp at the scale of a tile, without an edge that leads to them.
//!
//! # Theory
//! The total curvature of a disc is the sum of the angle defects of its vertices (Gauss-Bonnet). Where it is large about a vertex,
//! at the scale of a tile, the surface has a tip there, and a mesh without a vertex at the tip cuts it off. The tip is the vertex of
//! the largest defect. The defects of noise cancel.

use super::Surface;
use super::walk::next_corner;
use crate::progress::{IsCancelled, until_cancelled};
use glam::DVec3;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// The total curvature of an apex, in degrees: that of a cone that opens by 83 degrees.
const APEX: f64 = 120.0;
/// The radius of the disc, in tile sides.
const RADIUS: f64 = 0.25;
/// A vertex of a smaller defect, in degrees, is not the tip.
const LEAST_DEFECT: f64 = 3.0;

/// The apexes of a surface for tiles of a side, unit-sized, in order. Vertices on features are none.
pub(super) fn apexes(surface: &Surface, side: f64, is_cancelled: &IsCancelled) -> Vec<u32> {
    let is_on_feature = on_features(surface);
    let defects = defects(surface, is_cancelled);
    if is_cancelled() {
        return Vec::new();
    }
    let corner_of = first_corners(surface);
    let radius = RADIUS * side;
    let is_apex = |&v: &u32| {
        let own = defects[v as usize];
        if is_on_feature[v as usize] || own < LEAST_DEFECT.to_radians() {
            return false;
        }
        let disc = disc(surface, &corner_of, v, radius);
        // Of equal defects that of the first vertex counts.
        let is_largest = disc.iter().all(|&w| defects[w as usize] < own || (defects[w as usize] == own && v <= w));
        let has_feature = disc.iter().any(|&w| is_on_feature[w as usize]);
        is_largest && !has_feature && disc.iter().map(|&w| defects[w as usize]).sum::<f64>() >= APEX.to_radians()
    };
    (0..surface.vertex_count() as u32).into_par_iter().with_min_len(1024).filter(is_apex).collect()
}

fn on_features(surface: &Surface) -> Vec<bool> {
    let mut is_on_feature = surface.shared_places();
    for h in (0..3 * surface.triangle_count() as u32).filter(|&h| surface.features.is_feature(h)) {
        is_on_feature[surface.origin(h) as usize] = true;
        is_on_feature[surface.target(h) as usize] = true;
    }
    is_on_feature
}

/// A full turn less the angles at each vertex.
fn defects(surface: &Surface, is_cancelled: &IsCancelled) -> Vec<f64> {
    let mut defects = vec![TAU; surface.vertex_count()];
    for (t, triangle) in until_cancelled(surface.triangles.iter().enumerate(), is_cancelled) {
        let corners = surface.corners(t).map(|p| p.as_dvec3());
        for k in 0..3 {
            let [a, b] = [1, 2].map(|j| corners[(k + j) % 3] - corners[k]);
            defects[triangle[k] as usize] -= a.cross(b).length().atan2(a.dot(b));
        }
    }
    defects
}

/// A half-edge from each vertex.
fn first_corners(surface: &Surface) -> Vec<u32> {
    let mut corners = vec![super::NONE; surface.vertex_count()];
    (0..3 * surface.triangle_count() as u32).for_each(|h| corners[surface.origin(h) as usize] = h);
    corners
}

/// The vertices that edges join to a vertex within a distance of it, itself included.
fn disc(surface: &Surface, corner_of: &[u32], v: u32, radius: f64) -> Vec<u32> {
    let place = |v: u32| DVec3::from(surface.point(v));
    let mut disc = vec![v];
    let mut at = 0;
    while at < disc.len() {
        let first = corner_of[disc[at] as usize];
        let mut corner = Some(first);
        while let Some(h) = corner {
            let w = surface.target(h);
            if place(w).distance(place(v)) <= radius && !disc.contains(&w) {
                disc.push(w);
            }
            corner = next_corner(surface, |h| surface.twin(h).is_none(), h).filter(|&next| next != first);
        }
        at += 1;
    }
    disc
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::{FeatureOptions, Soup};

    /// A cone of this half angle, in degrees, and slant height 1, in 48 sectors and so many rings; its rim is open. The tip is cut
    /// off at `cut` and closed by a flat fan.
    fn cone(half_angle: f64, rings: u32, cut: f64) -> Surface {
        const SECTORS: u32 = 48;
        let (sine, cosine) = half_angle.to_radians().sin_cos();
        let place = |slant: f64, sector: u32| {
            let (s, c) = (TAU * f64::from(sector) / f64::from(SECTORS)).sin_cos();
            [slant * sine * c, slant * sine * s, -slant * cosine]
        };
        let mut points = vec![[0.0, 0.0, -cut * cosine]];
        let at = |ring: u32, sector: u32| 1 + ring * SECTORS + sector % SECTORS;
        for ring in 0..=rings {
            let slant = cut.max(1e-3) + (1.0 - cut.max(1e-3)) * f64::from(ring) / f64::from(rings);
            points.extend((0..SECTORS).map(|sector| place(slant, sector)));
        }
        let tip = (0..SECTORS).map(|s| [0, at(0, s), at(0, s + 1)]);
        let cell =
            |r: u32, s: u32| [[at(r, s), at(r + 1, s), at(r + 1, s + 1)], [at(r, s), at(r + 1, s + 1), at(r, s + 1)]];
        let sides = (0..rings).flat_map(|r| (0..SECTORS).flat_map(move |s| cell(r, s)));
        let soup = Soup { points, triangles: tip.chain(sides).collect(), ..Soup::default() };
        Surface::new(&soup, &FeatureOptions { crease: 180.0, ..FeatureOptions::default() })
            .unwrap_or_else(|error| panic!("{error}"))
    }

    fn found(surface: &Surface, side: f64) -> Vec<[f64; 3]> {
        let apexes = apexes(surface, side / surface.frame().diagonal, &|| false);
        apexes.into_iter().map(|v| surface.frame().to_model(surface.point(v))).collect()
    }

    #[test]
    fn the_tip_of_a_sharp_cone_is_an_apex_and_that_of_a_blunt_one_is_none() {
        // Its total curvature is a full turn times one less the sine of the half angle: 120 degrees at 41.8.
        for (half_angle, is_sharp) in [(10.0, true), (40.0, true), (43.0, false), (70.0, false)] {
            let apexes = found(&cone(half_angle, 8, 0.0), 0.4);
            assert_eq!(apexes.len(), usize::from(is_sharp), "{half_angle}: {apexes:?}");
            assert!(apexes.iter().all(|tip| DVec3::from(*tip).length() < 1e-5));
        }
    }

    #[test]
    fn a_tip_that_is_cut_off_is_an_apex_of_tiles_larger_than_the_cut_alone() {
        let blunt = cone(15.0, 40, 0.05);
        assert_eq!(found(&blunt, 0.4).len(), 1);
        assert_eq!(found(&blunt, 0.04).len(), 0);
    }
}
