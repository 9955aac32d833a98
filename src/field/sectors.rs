//! Sectors: the parts into which feature edges cut the triangles round a vertex, with their angles.

use crate::compute::Complex;
use crate::surface::{NONE, Surface, next, next_corner, previous, previous_corner};
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Cotangent weights are kept above this share of their typical size, so that a sweep is a mean.
const LEAST_WEIGHT: f64 = 0.02;

/// The sectors of a surface. A corner is named by the half-edge that leaves it.
#[derive(Clone, Debug)]
pub struct Sectors {
    /// The sector of each corner of a triangle (three a triangle).
    pub of_corner: Vec<u32>,
    /// The first corner of each sector, counter-clockwise: its half-edge is direction zero.
    pub first_corner: Vec<u32>,
    /// Quarter turns that a sector's angles are scaled to; 0: a whole vertex without features.
    pub quarters: Vec<u8>,
    /// Where the sectors of each vertex start in `at_vertex`; one more than vertices.
    vertex_starts: Vec<u32>,
    at_vertex: Vec<u32>,
    /// Scaled angle, in radians from the sector's direction zero, at which each corner begins.
    begin: Vec<f64>,
    /// Scaled angle at which it ends.
    end: Vec<f64>,
    /// Unscaled angle of each corner.
    corner_angle: Vec<f64>,
    /// Vertices within feature curves that singularities were moved onto, in order.
    absorbing: Vec<u32>,
}

impl Sectors {
    /// Cuts the surroundings of each vertex along feature edges and measures the parts.
    pub fn new(surface: &Surface) -> Self {
        let features = surface.features();
        let barrier = |h: u32| features.is_feature(h);
        let count = 3 * surface.triangle_count();
        let corner_angle: Vec<f64> = (0..count as u32).into_par_iter().map(|h| corner_angle(surface, h)).collect();
        let mut sectors = Self {
            of_corner: vec![NONE; count],
            first_corner: Vec::new(),
            quarters: Vec::new(),
            vertex_starts: vec![0; surface.vertex_count() + 1],
            at_vertex: Vec::new(),
            begin: vec![0.0; count],
            end: vec![0.0; count],
            corner_angle,
            absorbing: Vec::new(),
        };
        for corner in 0..count as u32 {
            if sectors.of_corner[corner as usize] == NONE {
                let mut first = corner;
                while let Some(before) = previous_corner(surface, barrier, first) {
                    first = before;
                    if first == corner {
                        break;
                    }
                }
                sectors.add(surface, first);
            }
        }
        sectors.group_by_vertex(surface);
        sectors
    }

    fn group_by_vertex(&mut self, surface: &Surface) {
        let vertex: Vec<usize> = self.first_corner.iter().map(|&c| surface.origin(c) as usize).collect();
        vertex.iter().for_each(|&v| self.vertex_starts[v + 1] += 1);
        for v in 1..self.vertex_starts.len() {
            self.vertex_starts[v] += self.vertex_starts[v - 1];
        }
        let mut place = self.vertex_starts.clone();
        self.at_vertex = vec![0; vertex.len()];
        for (sector, &v) in vertex.iter().enumerate() {
            self.at_vertex[place[v] as usize] = sector as u32;
            place[v] += 1;
        }
    }

    /// The sectors at a vertex, in order.
    pub fn of_vertex(&self, vertex: u32) -> &[u32] {
        let v = vertex as usize;
        &self.at_vertex[self.vertex_starts[v] as usize..self.vertex_starts[v + 1] as usize]
    }

    fn add(&mut self, surface: &Surface, first: u32) {
        let features = surface.features();
        let barrier = |h: u32| features.is_feature(h);
        let id = self.first_corner.len() as u32;
        let mut total = 0.0;
        let mut at = first;
        loop {
            self.of_corner[at as usize] = id;
            self.begin[at as usize] = total;
            total += self.corner_angle[at as usize];
            self.end[at as usize] = total;
            match next_corner(surface, barrier, at) {
                Some(corner) if corner != first => at = corner,
                _ => break,
            }
        }
        let whole = !barrier(first);
        let quarters = if whole {
            0
        } else if features.is_corner(surface.origin(first)) {
            ((total / FRAC_PI_2).round() as u8).clamp(1, 8)
        } else {
            2
        };
        self.first_corner.push(first);
        self.quarters.push(quarters);
        let target = if whole { TAU } else { f64::from(quarters) * FRAC_PI_2 };
        self.scale(surface, id, if total > 0.0 { target / total } else { 0.0 });
    }

    fn scale(&mut self, surface: &Surface, sector: u32, scale: f64) {
        let corners: Vec<u32> = self.corners(surface, sector).collect();
        for corner in corners {
            self.begin[corner as usize] *= scale;
            self.end[corner as usize] *= scale;
        }
    }

    /// Scales the angles of a sector on a feature to so many quarter turns; its vertex becomes a corner of rows.
    pub(super) fn set_quarters(&mut self, surface: &Surface, sector: u32, quarters: u8) {
        let before = std::mem::replace(&mut self.quarters[sector as usize], quarters);
        self.scale(surface, sector, f64::from(quarters) / f64::from(before));
        let vertex = surface.origin(self.first_corner[sector as usize]);
        if let Err(place) = self.absorbing.binary_search(&vertex)
            && !surface.features().is_corner(vertex)
        {
            self.absorbing.insert(place, vertex);
        }
    }

    /// Whether rows have a corner at a vertex: a corner of features, or a vertex that a singularity was moved onto.
    pub(crate) fn is_corner(&self, surface: &Surface, vertex: u32) -> bool {
        surface.features().is_corner(vertex) || self.absorbing.binary_search(&vertex).is_ok()
    }

    /// Vertices within feature curves that singularities were moved onto, in order.
    pub(crate) fn absorbing(&self) -> &[u32] {
        &self.absorbing
    }

    /// The number of sectors.
    pub fn count(&self) -> usize {
        self.first_corner.len()
    }

    /// The corners of a sector, counter-clockwise.
    pub(crate) fn corners<'a>(&'a self, surface: &'a Surface, sector: u32) -> impl Iterator<Item = u32> + 'a {
        let first = self.first_corner[sector as usize];
        let mut at = Some(first);
        std::iter::from_fn(move || {
            let corner = at?;
            at = next_corner(surface, |h| surface.features().is_feature(h), corner).filter(|&c| c != first);
            Some(corner)
        })
    }

    /// The unscaled angle of a corner, in radians.
    pub(crate) fn corner_angle(&self, corner: u32) -> f64 {
        self.corner_angle[corner as usize]
    }

    /// The scaled angle of a direction that lies `angle` radians (unscaled) past a corner's half-edge.
    pub(crate) fn direction(&self, corner: u32, angle: f64) -> f64 {
        let c = corner as usize;
        let share = if self.corner_angle[c] > 0.0 { angle / self.corner_angle[c] } else { 0.0 };
        self.begin[c] + share * (self.end[c] - self.begin[c])
    }

    /// The cotangent of a corner's unscaled angle.
    pub(crate) fn cotangent(&self, corner: u32) -> f64 {
        let (s, c) = self.corner_angle[corner as usize].sin_cos();
        c / s.max(1e-9)
    }

    /// The cotangent weight of a half-edge's link: half the cotangent of the angle opposite to it, within bounds.
    pub(crate) fn edge_weight(&self, half_edge: u32) -> f64 {
        (self.cotangent(previous(half_edge)) / 2.0).clamp(LEAST_WEIGHT, 1.0 / LEAST_WEIGHT)
    }

    /// The angle that reads a cross at the far end of a half-edge in the frame of the sector it leaves: add it.
    pub(crate) fn transport(&self, half_edge: u32) -> f64 {
        self.begin[half_edge as usize] - self.end[next(half_edge) as usize]
    }

    /// The representation numbers at the three corners of each triangle, against the triangle's first edge: 4 times the angle
    /// for crosses, `times` in general.
    pub(crate) fn in_triangles(&self, numbers: &[Complex], times: f64) -> Vec<[Complex; 3]> {
        (0..self.of_corner.len() / 3)
            .into_par_iter()
            .map(|t| {
                let turn_at = [1, 2].map(|k| std::f64::consts::PI - self.corner_angle[3 * t + k]);
                let edge = [0.0, turn_at[0], turn_at[0] + turn_at[1]];
                [0, 1, 2].map(|k| {
                    let c = 3 * t + k;
                    let middle = (self.begin[c] + self.end[c]) / 2.0;
                    let turn = edge[k] + self.corner_angle[c] / 2.0 - middle;
                    turned(numbers[self.of_corner[c] as usize], times * turn)
                })
            })
            .collect()
    }
}

/// A complex number turned by an angle in radians.
fn turned(z: Complex, angle: f64) -> Complex {
    let (s, c) = angle.sin_cos();
    let [x, y] = z.map(f64::from);
    [(x * c - y * s) as f32, (x * s + y * c) as f32]
}

fn corner_angle(surface: &Surface, corner: u32) -> f64 {
    let [o, p, q] =
        [corner, next(corner), previous(corner)].map(|h| surface.points[surface.origin(h) as usize].as_dvec3());
    let (u, v) = (p - o, q - o);
    u.cross(v).length().atan2(u.dot(v))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compute::Cpu;
    use crate::field::{Field, FieldOptions};
    use crate::surface::FeatureOptions;
    use crate::surface::examples::Example;

    const EXAMPLES: [(&str, i64); 5] = [("sphere", 2), ("torus", 0), ("block", 0), ("plate", 0), ("m6", 1)];

    fn surface(name: &str) -> Surface {
        let soup = name.parse::<Example>().expect("an example's name").generate(3_000);
        Surface::new(&soup, &FeatureOptions::default()).unwrap_or_else(|error| panic!("{error}"))
    }

    /// The angle between an angle and the nearest multiple of a quarter turn.
    fn off_quarters(angle: f64) -> f64 {
        (angle - (angle / FRAC_PI_2).round() * FRAC_PI_2).abs()
    }

    #[test]
    fn the_corners_of_a_sector_fill_its_quarters() {
        for (name, _) in EXAMPLES {
            let surface = surface(name);
            let sectors = Sectors::new(&surface);
            let mut seen = vec![false; 3 * surface.triangle_count()];
            for sector in 0..sectors.count() as u32 {
                let quarters = sectors.quarters[sector as usize];
                let mut at = 0.0;
                for corner in sectors.corners(&surface, sector) {
                    assert!(!std::mem::replace(&mut seen[corner as usize], true), "{name}: corner {corner} twice");
                    assert_eq!(sectors.of_corner[corner as usize], sector, "{name}");
                    assert!((sectors.direction(corner, 0.0) - at).abs() < 1e-12, "{name}: a gap before {corner}");
                    at = sectors.direction(corner, sectors.corner_angle(corner));
                }
                let whole = if quarters == 0 { TAU } else { f64::from(quarters) * FRAC_PI_2 };
                assert!((at - whole).abs() < 1e-9, "{name}: sector {sector} spans {at}, not {whole}");
                assert!(sectors.of_vertex(surface.origin(sectors.first_corner[sector as usize])).contains(&sector));
            }
            assert!(seen.iter().all(|&s| s), "{name}: a corner without sector");
            let marked = (0..3 * surface.triangle_count() as u32).any(|h| surface.features().is_feature(h));
            assert_eq!(sectors.quarters.iter().any(|&q| q > 0), marked, "{name}");
        }
    }

    #[test]
    fn reading_there_and_back_changes_nothing() {
        for (name, _) in EXAMPLES {
            let surface = surface(name);
            let sectors = Sectors::new(&surface);
            let inner = |h: &u32| surface.twin(*h).is_some() && !surface.features().is_feature(*h);
            let mut wrong = 0;
            for h in (0..3 * surface.triangle_count() as u32).filter(inner) {
                let twin = surface.twin(h).expect("an inner edge");
                let round = sectors.transport(h) + sectors.transport(twin);
                assert!(off_quarters(round) < 1e-9, "{name}, half-edge {h}: {round}");
                // Another edge of the same triangle leads elsewhere.
                wrong += usize::from(off_quarters(sectors.transport(h) + sectors.transport(next(twin))) > 1e-3);
            }
            assert!(wrong > 100, "{name}: {wrong}");
        }
    }

    /// The quarters of a turn that a field makes round each triangle: what the crosses' differences along its edges leave
    /// of the excess of its scaled angles.
    fn quarters(surface: &Surface, sectors: &Sectors, crosses: &[Complex]) -> Vec<f64> {
        let angle = |c: u32| {
            let z = crosses[sectors.of_corner[c as usize] as usize];
            f64::from(z[1]).atan2(f64::from(z[0])) / 4.0
        };
        let difference = |h: u32| {
            let d = angle(next(h)) + sectors.transport(h) - angle(h);
            d - (d / FRAC_PI_2).round() * FRAC_PI_2
        };
        (0..surface.triangle_count() as u32)
            .map(|t| {
                let h = [3 * t, 3 * t + 1, 3 * t + 2];
                let scaled: f64 =
                    h.iter().map(|&c| sectors.direction(c, sectors.corner_angle(c)) - sectors.direction(c, 0.0)).sum();
                let turned: f64 = h
                    .iter()
                    .map(|&h| match surface.twin(h) {
                        // Both sides of an edge must fall on the same side of an eighth of a turn.
                        Some(twin) if twin < h && !surface.features().is_feature(h) => -difference(twin),
                        _ => difference(h),
                    })
                    .sum();
                (turned + scaled - std::f64::consts::PI) / FRAC_PI_2
            })
            .collect()
    }

    #[test]
    fn singularities_add_up_to_the_euler_characteristic() {
        for (name, characteristic) in EXAMPLES {
            let surface = surface(name);
            let field = Field::new(&surface, &FieldOptions::default(), &Cpu).expect("the CPU does not fail");
            let sectors = field.sectors();
            let found = quarters(&surface, sectors, field.crosses());
            for (t, q) in found.iter().enumerate() {
                assert!((q - q.round()).abs() < 1e-4, "{name}, triangle {t}: {q} quarters");
            }
            let total: f64 = found.iter().sum();
            // Corners turn a share themselves: a flat vertex has four quarters, one on the boundary two.
            let open: Vec<bool> = {
                let mut open = vec![false; surface.vertex_count()];
                for h in (0..3 * surface.triangle_count() as u32).filter(|&h| surface.twin(h).is_none()) {
                    open[surface.origin(h) as usize] = true;
                    open[surface.target(h) as usize] = true;
                }
                open
            };
            let at_corners: i64 = surface
                .features()
                .corners()
                .map(|v| {
                    let here: i64 = sectors.of_vertex(v).iter().map(|&s| i64::from(sectors.quarters[s as usize])).sum();
                    if open[v as usize] { 2 - here } else { 4 - here }
                })
                .sum();
            assert_eq!(total.round() as i64, 4 * characteristic - at_corners, "{name}");

            let mut wrong = sectors.clone();
            // On one side of an inner edge only.
            let inner = |h: &u32| surface.twin(*h).is_some_and(|t| *h < t) && !surface.features().is_feature(*h);
            let edge = (0..3 * surface.triangle_count() as u32).find(inner).expect("an inner edge");
            wrong.end[next(edge) as usize] += 0.1;
            let found = quarters(&surface, &wrong, field.crosses());
            assert!(found.iter().any(|q| (q - q.round()).abs() > 1e-2), "{name}: a wrong angle is seen");
        }
    }

    #[test]
    fn a_sphere_has_eight_singularities_and_a_torus_none() {
        for (name, wanted) in [("sphere", 8), ("torus", 0)] {
            for triangles in [3_000, 20_000] {
                let soup = name.parse::<Example>().expect("an example's name").generate(triangles);
                let surface = Surface::new(&soup, &FeatureOptions::default()).unwrap_or_else(|error| panic!("{error}"));
                let field =
                    Field::new(&surface, &crate::field::FieldOptions::default(), &Cpu).expect("the CPU does not fail");
                let singular = |crosses: &[Complex]| {
                    let found = quarters(&surface, field.sectors(), crosses);
                    found.into_iter().map(|q| q.round() as i64).filter(|&q| q != 0).collect::<Vec<_>>()
                };
                assert_eq!(singular(field.crosses()), vec![1; wanted], "{name} of {triangles} triangles");
                let mut other = field.crosses().to_vec();
                other[1_000] = turned(other[1_000], TAU / 2.0);
                assert_ne!(singular(&other), vec![1; wanted], "{name}: a wrong cross is seen");
            }
        }
    }

    #[test]
    fn a_cross_turned_by_a_quarter_is_the_same() {
        let cross = |angle: f64| turned([1.0, 0.0], 4.0 * angle);
        let z = cross(0.3);
        let quarter = cross(0.3 + FRAC_PI_2);
        assert!((z[0] - quarter[0]).abs() < 1e-6 && (z[1] - quarter[1]).abs() < 1e-6);
        let eighth = cross(0.3 + FRAC_PI_2 / 2.0);
        assert!((z[0] + eighth[0]).abs() < 1e-6 && (z[1] + eighth[1]).abs() < 1e-6, "an eighth is the farthest");
    }
}
