//! A ring with bolt holes: round faces whose holes are near each other and near the rims, as on the casing of a turbine.

use std::collections::HashMap;
use std::f64::consts::PI;

use glam::{DVec2, DVec3};

use super::Soup;
use super::strip::{Strips, nearest_size};

/// Radius of the bore.
const INNER: f64 = 0.5;
/// Radius of the outer rim.
const OUTER: f64 = 1.0;
/// Thickness, along the axis.
const THICKNESS: f64 = 0.2;
/// Bolt holes.
const BOLTS: usize = 12;
/// Radius of a bolt hole.
const BOLT_RADIUS: f64 = 0.07;
/// Distance of the bolt holes from the axis.
const BOLT_CIRCLE: f64 = 0.75;

/// The points' spacing on a sector's outline over that on its hole.
const GROWTH: f64 = 4.0;

/// The numbers of points of one sector, one of which each bolt hole has, and of strips.
struct Sector {
    /// Intervals along a radius from the bore to the rim, along the rim and along the bore.
    radial: usize,
    outer: usize,
    inner: usize,
    /// Strips between the outline and the hole.
    across: usize,
    /// Strips between the two faces.
    rows: usize,
}

impl Sector {
    fn new(radial: usize) -> Self {
        let spacing = (OUTER - INNER) / radial as f64;
        let strips = |length: f64, spacing: f64| ((length / spacing).round() as usize).max(1);
        let arc = |radius: f64| strips(2.0 * PI * radius / BOLTS as f64, spacing);
        let mean = spacing / GROWTH.sqrt();
        let way = (OUTER - INNER) / 2.0 - BOLT_RADIUS;
        Self { radial, outer: arc(OUTER), inner: arc(INNER), across: strips(way, mean), rows: strips(THICKNESS, mean) }
    }

    /// The points of its outline.
    fn points(&self) -> usize {
        2 * self.radial + self.outer + self.inner
    }

    /// The number of triangles of the whole ring.
    fn triangles(&self) -> usize {
        let faces = 2 * 2 * self.points() * self.across;
        let walls = 2 * self.rows * (self.outer + self.inner + self.points());
        BOLTS * (faces + walls)
    }

    /// Points along the rim or the bore over all sectors, counter-clockwise.
    fn rim(radius: f64, along: usize) -> impl Iterator<Item = DVec2> {
        let first = -PI / BOLTS as f64;
        (0..BOLTS * along)
            .map(move |i| radius * DVec2::from_angle(first + 2.0 * PI * i as f64 / (BOLTS * along) as f64))
    }

    /// The outline of a sector, counter-clockwise from the corner on the rim.
    fn outline(&self, sector: usize) -> Vec<DVec2> {
        let arc = |radius: f64, along: usize| {
            let all: Vec<DVec2> = Self::rim(radius, along).collect();
            (0..=along).map(|i| all[(sector * along + i) % all.len()]).collect::<Vec<_>>()
        };
        let (outer, inner) = (arc(OUTER, self.outer), arc(INNER, self.inner));
        let radius =
            |from: DVec2, to: DVec2| (0..=self.radial).map(move |i| from.lerp(to, i as f64 / self.radial as f64));
        // Both sectors at a radius have the same points there.
        let before: Vec<DVec2> = radius(outer[0], inner[0]).collect();
        let after = radius(outer[self.outer], inner[self.inner]);
        let mut points = outer;
        points.extend(after.skip(1));
        points.extend(inner.into_iter().rev().skip(1));
        points.extend(before.into_iter().rev().skip(1));
        points.pop();
        points
    }

    /// A ring of a sector: 0 is the outline, [`Sector::across`] is the hole.
    fn ring(&self, sector: usize, index: usize) -> Vec<DVec2> {
        let centre = BOLT_CIRCLE * DVec2::from_angle(2.0 * PI * sector as f64 / BOLTS as f64);
        let inward = 1.0 - index as f64 / self.across as f64;
        let outside = (GROWTH.powf(inward) - 1.0) / (GROWTH - 1.0);
        let point = |place: DVec2| {
            let on_hole = centre + BOLT_RADIUS * (place - centre).normalize();
            if index == 0 { place } else { on_hole.lerp(place, outside) }
        };
        self.outline(sector).into_iter().map(point).collect()
    }
}

/// Strips whose points at the same place are one.
#[derive(Default)]
struct Welded {
    strips: Strips,
    known: HashMap<[u64; 3], u32>,
}

impl Welded {
    fn ring(&mut self, points: impl IntoIterator<Item = DVec2>, z: f64) -> Vec<u32> {
        let mut index = |point: DVec3| {
            let key = point.to_array().map(f64::to_bits);
            *self.known.entry(key).or_insert_with(|| self.strips.point(point))
        };
        let mut ring: Vec<u32> = points.into_iter().map(|point| index(point.extend(z))).collect();
        ring.extend(ring.first().copied());
        ring
    }

    /// Joins rings of the same points at these heights.
    fn wall(&mut self, points: &[DVec2], heights: impl Iterator<Item = f64>) {
        let rings: Vec<Vec<u32>> = heights.map(|z| self.ring(points.iter().copied(), z)).collect();
        self.strips.chain(&rings);
    }
}

/// About `triangles` triangles, finer at the bolt holes.
pub fn generate(triangles: usize) -> Soup {
    let sector = Sector::new(nearest_size(2, triangles, |radial| Sector::new(radial).triangles()));
    let height = |row: usize| THICKNESS * (row as f64 / sector.rows as f64 - 0.5);
    let (up, down) = (|| (0..=sector.rows).map(height), || (0..=sector.rows).rev().map(height));

    let mut welded = Welded::default();
    for number in 0..BOLTS {
        let rings: Vec<Vec<DVec2>> = (0..=sector.across).map(|index| sector.ring(number, index)).collect();
        for (z, is_top) in [(height(sector.rows), true), (height(0), false)] {
            let mut lines: Vec<Vec<u32>> = rings.iter().map(|ring| welded.ring(ring.iter().copied(), z)).collect();
            if !is_top {
                lines.reverse();
            }
            welded.strips.chain(&lines);
        }
        welded.wall(&rings[sector.across], down());
    }
    welded.wall(&Sector::rim(OUTER, sector.outer).collect::<Vec<_>>(), up());
    welded.wall(&Sector::rim(INNER, sector.inner).collect::<Vec<_>>(), down());
    welded.strips.finish()
}
