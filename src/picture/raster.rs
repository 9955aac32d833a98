//! Visibility: the nearest face at each sample of the picture, or the line on it.
//!
//! # Practice
//! A pixel has [`FINE`] by [`FINE`] samples, evenly spread. The picture is cut into bands of rows, each with a depth buffer
//! of its own, that are worked on at once; a sample's answer depends on no other, so their number does not matter. Of
//! faces at the same depth the first is seen. Lines are tested against faces only, and the last of them is seen.
//!
//! What lies on the ground is flat, and the ground may rise above it: from in front it is taken to be nearer than it is.

use super::scene::{Face, Line, NO_PEN, Scene};
use super::view::Camera;
use glam::{DVec2, DVec3, Vec3, Vec3Swizzles};
use rayon::prelude::*;

/// Samples along each side of a pixel.
pub(super) const FINE: usize = 3;
/// Rows of pixels in a band.
const BAND: usize = 16;
/// The least cosine between the eye and the surface below a line that is drawn.
const EDGE_ON: f64 = 0.08;
/// What lies on the ground is seen through so much of it, in longest sides of the face that lies there.
const SUNK: f64 = 0.5;
/// Nothing is there.
pub(super) const EMPTY: u32 = u32::MAX;

/// A scene as a camera sees it, measured in samples.
pub(super) struct Sight<'a> {
    pub scene: &'a Scene,
    pub camera: &'a Camera,
    /// The scene's points: from the left, from the top, towards the eye.
    pub points: Vec<DVec3>,
    /// The ends of its lines.
    ends: Vec<[DVec3; 2]>,
    /// Width of its pens.
    pub widths: Vec<f64>,
    columns: usize,
    rows: usize,
}

/// A few rows of pixels: of each sample, row by row, the number of the face, or the number of faces and that of a line.
pub(super) struct Band {
    /// The first row of samples.
    pub top: usize,
    pub seen: Vec<u32>,
    /// The depth of the nearest face.
    pub depth: Vec<f32>,
    /// The faces that may reach into it.
    pub faces: Vec<u32>,
}

impl<'a> Sight<'a> {
    pub fn new(scene: &'a Scene, camera: &'a Camera) -> Self {
        let fine = FINE as f64;
        let project = |point: &DVec3| camera.project(*point) * fine;
        let points: Vec<DVec3> = scene.points.par_iter().map(project).collect();
        let ends = scene.lines.par_iter().map(|line| line.ends.map(|end| project(&end))).collect();
        let [columns, rows] = camera.size.map(|side| side as usize * FINE);
        let page = columns.min(rows) as f64 / 1000.0;
        let means = mean_sides(scene, &points);
        let width = |(pen, mean): (&super::Pen, &Option<f64>)| {
            let most = mean.map_or(f64::INFINITY, |mean| mean * f64::from(pen.most));
            (f64::from(pen.width) * page).min(most)
        };
        let widths = scene.pens.iter().zip(&means).map(width).collect();
        Self { scene, camera, points, ends, widths, columns, rows }
    }

    /// The projected corners of a face.
    pub fn outline(&self, face: &Face) -> impl ExactSizeIterator<Item = DVec3> + Clone + '_ {
        self.scene.corners_of(face).iter().map(|corner| self.points[corner.point as usize])
    }

    /// Whether a face is seen from in front.
    pub fn is_front(&self, face: &Face) -> bool {
        let mut places = self.outline(face).map(|corner| corner.xy());
        let Some(first) = places.next() else { return true };
        let ways = places.map(|place| place - first);
        // From the top of the picture down is positive: counter-clockwise is negative.
        ways.clone().zip(ways.skip(1)).map(|(a, b)| a.perp_dot(b)).sum::<f64>() <= 0.0
    }

    /// The projected ends of a line.
    pub fn ends(&self, line: usize) -> [DVec3; 2] {
        self.ends[line]
    }

    /// Finds what is visible and gives it to `work`, a band after the other; the answers in order.
    pub fn each_band<T: Send>(&self, work: impl Fn(&Band) -> T + Sync) -> Vec<T> {
        let height = BAND * FINE;
        let count = self.rows.div_ceil(height);
        let mut faces = vec![Vec::new(); count];
        let mut lines = vec![Vec::new(); count];
        let bands = |low: f64, high: f64| {
            let band = |y: f64| (y / height as f64).floor();
            let (low, high) = (band(low).max(0.0), band(high).min(count as f64 - 1.0));
            if low <= high { low as usize..high as usize + 1 } else { 0..0 }
        };
        for (number, face) in self.scene.faces.iter().enumerate() {
            let (low, high) = range(self.outline(face).map(|place| place.y));
            faces[bands(low, high)].iter_mut().for_each(|band| band.push(number as u32));
        }
        for (number, line) in self.scene.lines.iter().enumerate() {
            if line.normal == Vec3::ZERO || self.camera.seen(line.normal.as_dvec3()).z > EDGE_ON {
                let reach = self.widths[line.pen as usize] / 2.0;
                let (low, high) = range(self.ends[number].iter().map(|place| place.y));
                lines[bands(low - reach, high + reach)].iter_mut().for_each(|band| band.push(number as u32));
            }
        }
        (0..count)
            .into_par_iter()
            .map(|number| {
                let top = number * height;
                let samples = height.min(self.rows - top) * self.columns;
                let (seen, depth) = (vec![EMPTY; samples], vec![f32::NEG_INFINITY; samples]);
                let mut band = Band { top, seen, depth, faces: Vec::new() };
                faces[number].iter().for_each(|&face| self.fill(&mut band, face));
                band.faces.clone_from(&faces[number]);
                lines[number].iter().for_each(|&line| self.stroke(&mut band, line));
                work(&band)
            })
            .collect()
    }

    /// Samples in a row.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// The samples, as rows and columns, whose centres may lie in this box.
    fn within(&self, [top, samples]: [usize; 2], low: DVec2, high: DVec2) -> [std::ops::Range<usize>; 2] {
        let rows = samples / self.columns;
        let span = |low: f64, high: f64, first: usize, count: usize| {
            let at = |x: f64| (x - first as f64).clamp(0.0, count as f64) as usize;
            at((low - 0.5).ceil())..at((high - 0.5).floor() + 1.0)
        };
        [span(low.y, high.y, top, rows), span(low.x, high.x, 0, self.columns)]
    }

    fn fill(&self, band: &mut Band, number: u32) {
        let Band { seen, depth: depths, top, .. } = band;
        self.each_sample([*top, seen.len()], number, |at, depth| {
            if depth > depths[at] {
                depths[at] = depth;
                seen[at] = number;
            }
        });
    }

    /// Visits the samples that a face covers in a band, seen or not, with its depth there.
    pub fn each_sample(&self, [top, samples]: [usize; 2], number: u32, mut tell: impl FnMut(usize, f32)) {
        let face = &self.scene.faces[number as usize];
        let mut outline = self.outline(face);
        let Some(first) = outline.next() else { return };
        let lift = self.lift(number, face);
        let rest = outline.clone().skip(1);
        for (a, b) in outline.zip(rest) {
            self.each_sample_of([top, samples], [first, a, b], |at, depth| tell(at, (depth + lift) as f32));
        }
    }

    /// By how much a face is moved towards the eye.
    fn lift(&self, number: u32, face: &Face) -> f64 {
        if self.scene.ground == 0 || (number as usize) < self.scene.ground {
            return 0.0;
        }
        let places: Vec<DVec3> = self.outline(face).collect();
        let sides = places.iter().zip(places.iter().cycle().skip(1)).map(|(a, b)| a.distance(*b));
        let longest = sides.fold(0.0, f64::max);
        SUNK * longest * if self.is_front(face) { 1.0 } else { -1.0 }
    }

    fn each_sample_of(&self, [top, samples]: [usize; 2], [a, b, c]: [DVec3; 3], mut tell: impl FnMut(usize, f64)) {
        let area = (b - a).xy().perp_dot((c - a).xy());
        if area == 0.0 || !area.is_finite() {
            return;
        }
        let [rows, columns] = self.within([top, samples], a.min(b).min(c).xy(), a.max(b).max(c).xy());
        for row in rows {
            for column in columns.clone() {
                let p = DVec2::new(column as f64 + 0.5, (top + row) as f64 + 0.5);
                // Each is computed alike from either side of an edge, but for its sign: no sample falls between two faces.
                let [wa, wb, wc] = [(b, c), (c, a), (a, b)].map(|(s, e)| side(s.xy(), e.xy(), p) / area);
                if wa >= 0.0 && wb >= 0.0 && wc >= 0.0 {
                    tell(row * self.columns + column, (wa * a.z + wb * b.z + wc * c.z) / (wa + wb + wc));
                }
            }
        }
    }

    fn stroke(&self, band: &mut Band, number: u32) {
        let [a, b] = self.ends[number as usize];
        let line = &self.scene.lines[number as usize];
        let width = self.widths[line.pen as usize];
        // On a surface that is seen edge-on, lines would reach beyond it.
        let lies = line.normal != Vec3::ZERO;
        let reach = DVec2::splat(width / 2.0);
        let [rows, columns] = self.within([band.top, band.seen.len()], a.min(b).xy() - reach, a.max(b).xy() + reach);
        for row in rows {
            for column in columns.clone() {
                let p = DVec2::new(column as f64 + 0.5, (band.top + row) as f64 + 0.5);
                let share = nearest(a.xy(), b.xy(), p);
                let on = a.lerp(b, share);
                let at = row * self.columns + column;
                if lies && band.seen[at] == EMPTY {
                    continue;
                }
                // A line lies on faces that may rise beside its middle by about its width.
                if on.xy().distance_squared(p) <= width * width / 4.0 && (on.z + width) as f32 > band.depth[at] {
                    band.seen[at] = self.scene.faces.len() as u32 + number;
                }
            }
        }
    }

    /// The line of that number among what is seen.
    pub fn line(&self, seen: u32) -> Option<(usize, &'a Line)> {
        let number = (seen as usize).checked_sub(self.scene.faces.len())?;
        self.scene.lines.get(number).map(|line| (number, line))
    }
}

/// The parameter along a segment, from 0 to 1, of the point nearest to a point.
pub(super) fn nearest(start: DVec2, end: DVec2, point: DVec2) -> f64 {
    let way = end - start;
    ((point - start).dot(way) / way.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0)
}

/// Twice the signed area of a segment and a point; exactly the negative where the segment is turned round.
fn side(start: DVec2, end: DVec2, point: DVec2) -> f64 {
    if (start.x, start.y) < (end.x, end.y) {
        (end - start).perp_dot(point - start)
    } else {
        -(start - end).perp_dot(point - end)
    }
}

fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
}

/// The mean length of the sides that each pen draws; `None` for a pen of lines only.
fn mean_sides(scene: &Scene, points: &[DVec3]) -> Vec<Option<f64>> {
    let mut sums = vec![(0.0, 0_u32); scene.pens.len()];
    for face in &scene.faces {
        let corners = scene.corners_of(face);
        for (corner, next) in corners.iter().zip(corners.iter().cycle().skip(1)).filter(|pair| pair.0.pen != NO_PEN) {
            let [a, b] = [corner, next].map(|corner| points[corner.point as usize].xy());
            let sum = &mut sums[corner.pen as usize];
            *sum = (sum.0 + a.distance(b), sum.1 + 1);
        }
    }
    sums.into_iter().map(|(length, count)| (count > 0).then(|| length / f64::from(count))).collect()
}
