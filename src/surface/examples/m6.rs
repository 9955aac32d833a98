//! The ONERA M6 wing.
//!
//! # Theory
//! Planform and section are the published ones: V. Schmitt and F. Charpin, "Pressure distributions on the ONERA M6 wing at
//! transonic Mach numbers", AGARD AR-138, 1979, B1; the sharp trailing edge and the tip cap follow NASA's CAD of the wing
//! (Turbulence Modeling Resource). The wing is linear along its span, without twist or dihedral.
//!
//! # Practice
//! Lines run along the span, from root to tip, at stations that crowd at the leading edge by curvature. Every line has its
//! own number of points, closer where the chord is shorter, so that triangles are near right-isosceles or equilateral at
//! the nose, too. Where the geometry itself is thinner than the triangles they are slender: round the last points of the
//! tip cap before the trailing edge, and on the face of a blunt trailing edge. Below some 6,500 triangles to a half wing
//! the nose is so coarse that its edges turn by more than 40 degrees and count as creases.

use std::f64::consts::PI;

use glam::DVec3;

use super::Soup;
use super::section::{Section, Station};
use super::strip::{Strips, nearest_size};

/// Root chord with the published blunt trailing edge, metres.
const ROOT_CHORD: f64 = 0.8059;
/// Tip chord over root chord.
const TAPER: f64 = 0.5625;
/// Semi-span without the tip cap, metres.
const SEMI_SPAN: f64 = 1.1963;
/// Leading-edge sweep, degrees.
const LEADING_EDGE_SWEEP: f64 = 30.0;
/// Chords of arc length that a turn by one radian counts for: the nose, of radius 0.007 chord, gets points about six
/// times as close as a flat part.
const TURN_WEIGHT: f64 = 0.04;
/// Fewest steps round the tip cap: 30 degrees each, less than what counts as a crease.
const FEWEST_ROUND_STEPS: usize = 6;

/// What the ONERA M6 wing looks like. In metres: x streamwise, y along the span, z up; root leading edge at the origin.
/// By default a half wing with an open root, a sharp trailing edge and a round tip.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct M6Options {
    /// Keep the published blunt trailing edge, 0.14 % of the chord thick, and close it by a face. Otherwise both sides are
    /// extended linearly until they meet: the root chord grows from 0.8059 to 0.8105.
    pub blunt: bool,
    /// Close the tip by a flat face. Otherwise by half a body of revolution of the tip section about its chord line.
    pub flat_tip: bool,
    /// Mirror the wing at its root: a closed surface of both halves. Otherwise one half with an open root.
    pub whole_span: bool,
}

/// About `triangles` triangles.
pub fn generate(options: &M6Options, triangles: usize) -> Soup {
    let section = Section::onera_d(options.blunt);
    let placing = section.placing(TURN_WEIGHT);
    let half = if options.whole_span { triangles / 2 } else { triangles };
    let layout = |parts| Layout { options: *options, stations: placing.stations(parts) };
    let half_wing = layout(nearest_size(4, half, |parts| layout(parts).triangles())).build();
    if options.whole_span { mirrored(half_wing) } else { half_wing }
}

/// Where the points of a half wing go.
struct Layout {
    options: M6Options,
    /// Leading edge to trailing edge.
    stations: Vec<Station>,
}

impl Layout {
    /// Steps of a station's line from root to tip, each about as long as the local chord's share of the spacing.
    fn along_span(&self, station: &Station) -> usize {
        let slope = LEADING_EDGE_SWEEP.to_radians().tan() - station.point.x * ROOT_CHORD * (1.0 - TAPER) / SEMI_SPAN;
        let way = SEMI_SPAN * slope.hypot(1.0);
        let mean_chord = ROOT_CHORD * (TAPER - 1.0) / TAPER.ln();
        ((way / mean_chord / station.spacing).round() as usize).max(2)
    }

    /// The station of the trailing edge.
    fn tail(&self) -> &Station {
        &self.stations[self.stations.len() - 1]
    }

    /// Steps of a station's line over the tip, from the upper to the lower side; none where the sides meet.
    fn over_tip(&self, station: &Station) -> usize {
        let height = station.point.y;
        let steps = |way: f64| (way / station.spacing).round() as usize;
        if height == 0.0 {
            0
        } else if self.options.flat_tip {
            // The face of a blunt tail has one step, too.
            if station.point.x == self.tail().point.x { 1 } else { steps(2.0 * height).max(1) }
        } else {
            // An even number has points in the chord plane, so that the wing is as wide as it should be.
            (2 * steps(PI * height / 2.0)).max(FEWEST_ROUND_STEPS)
        }
    }

    /// The number of triangles that [`Layout::build`] makes.
    fn triangles(&self) -> usize {
        let strips = |steps: &dyn Fn(&Station) -> usize| -> usize {
            self.stations.windows(2).map(|pair| steps(&pair[0]) + steps(&pair[1])).sum()
        };
        let tail = self.tail();
        let tail_face =
            if self.options.blunt { 2 * self.along_span(tail) + self.over_tip(tail).saturating_sub(1) } else { 0 };
        2 * strips(&|station| self.along_span(station)) + strips(&|station| self.over_tip(station)) + tail_face
    }

    fn build(&self) -> Soup {
        let mut strips = Strips::default();
        let mut side = |sign: f64, stations: &mut dyn Iterator<Item = &Station>| -> Vec<Vec<u32>> {
            stations
                .map(|station| {
                    let steps = self.along_span(station);
                    strips.line((0..=steps).map(|step| on_wing(station, sign, step as f64 / steps as f64)))
                })
                .collect()
        };
        // One chain of lines: forward over the upper side, round the nose, back over the lower side.
        let mut lines = side(1.0, &mut self.stations.iter().rev());
        let shared_tail = usize::from(!self.options.blunt);
        lines.extend(side(-1.0, &mut self.stations[1..self.stations.len() - shared_tail].iter()));
        lines.push(lines[0].clone());
        strips.chain(&lines);

        let arcs = self.tip_arcs(&mut strips, &lines);
        strips.chain(&arcs);
        // A blunt tail ends the round tip in half a disc.
        strips.join(&arcs[0][..1], &arcs[0][1..]);
        strips.finish()
    }

    /// The lines over the tip, upper to lower side, trailing edge first.
    fn tip_arcs(&self, strips: &mut Strips, lines: &[Vec<u32>]) -> Vec<Vec<u32>> {
        let parts = self.stations.len() - 1;
        let tip = |line: &[u32]| line[line.len() - 1];
        (0..=parts)
            .map(|part| {
                let station = &self.stations[parts - part];
                let upper = tip(&lines[part]);
                let steps = self.over_tip(station);
                if steps == 0 {
                    return vec![upper];
                }
                let mut arc = vec![upper];
                arc.extend((1..steps).map(|step| strips.point(self.on_tip(station, step as f64 / steps as f64))));
                arc.push(tip(&lines[2 * parts - part]));
                arc
            })
            .collect()
    }

    /// The point a given part of the way over the tip, from the upper (0) to the lower side (1).
    fn on_tip(&self, station: &Station, part: f64) -> DVec3 {
        let upper = on_wing(station, 1.0, 1.0);
        if self.options.flat_tip {
            return upper.with_z(upper.z * (1.0 - 2.0 * part));
        }
        let (sin, cos) = (PI * part).sin_cos();
        DVec3::new(upper.x, upper.y + upper.z * sin, upper.z * cos)
    }
}

/// The point of the upper (`sign` 1) or lower side (-1) at a station, a given part of the steps from root (0) to tip (1):
/// equal steps are in proportion to the chord.
fn on_wing(station: &Station, sign: f64, part: f64) -> DVec3 {
    let shrink = TAPER.powf(part);
    let y = SEMI_SPAN * (1.0 - shrink) / (1.0 - TAPER);
    let chord = ROOT_CHORD * shrink;
    let leading_edge = y * LEADING_EDGE_SWEEP.to_radians().tan();
    DVec3::new(leading_edge + chord * station.point.x, y, sign * chord * station.point.y)
}

/// A half wing together with its mirror image, whose root points are the same.
fn mirrored(mut soup: Soup) -> Soup {
    let points = soup.points.len();
    let mut twin = Vec::with_capacity(points);
    for index in 0..points {
        let [x, y, z] = soup.points[index];
        if y == 0.0 {
            twin.push(index as u32);
        } else {
            twin.push(soup.points.len() as u32);
            soup.points.push([x, -y, z]);
        }
    }
    for index in 0..soup.triangles.len() {
        let [a, b, c] = soup.triangles[index].map(|corner| twin[corner as usize]);
        soup.triangles.push([a, c, b]);
    }
    soup
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_count_is_foretold() {
        let all = [false, true];
        for (blunt, flat_tip) in all.into_iter().flat_map(|blunt| all.map(|flat_tip| (blunt, flat_tip))) {
            let section = Section::onera_d(blunt);
            let options = M6Options { blunt, flat_tip, whole_span: false };
            for parts in [4, 17, 60] {
                let layout = Layout { options, stations: section.placing(TURN_WEIGHT).stations(parts) };
                assert_eq!(layout.build().triangles.len(), layout.triangles(), "{options:?}, {parts} parts");
            }
        }
    }
}
