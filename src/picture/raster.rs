//! What is visible: for each sample of the picture the nearest face, or the line on it.
//!
//! # Practice
//! A pixel has [`FINE`] by [`FINE`] samples, evenly spread. The picture is cut into bands of rows, each with a depth buffer
//! of its own, that are worked on at once; a sample's answer depends on no other, so their number does not matter. Of
//! faces at the same depth the first is seen. Lines are tested against faces only, and the last of them is seen.

use super::scene::{Face, Line, NO_PEN, Scene};
use super::view::Camera;
use glam::{DVec2, DVec3, Vec3, Vec3Swizzles};
use rayon::prelude::*;

/// Samples along each side of a pixel.
pub(super) const FINE: usize = 3;
/// Rows of pixels in a band.
const BAND: usize = 16;
/// Lines on a surface that turns away so far are not drawn: they would stand out beyond it like hairs.
const EDGE_ON: f64 = 0.08;
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
    depth: Vec<f32>,
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
                let mut band = Band { top, seen: vec![EMPTY; samples], depth: vec![f32::NEG_INFINITY; samples] };
                faces[number].iter().for_each(|&face| self.fill(&mut band, face));
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
    fn within(&self, band: &Band, low: DVec2, high: DVec2) -> [std::ops::Range<usize>; 2] {
        let rows = band.seen.len() / self.columns;
        let span = |low: f64, high: f64, first: usize, count: usize| {
            let at = |x: f64| (x - first as f64).clamp(0.0, count as f64) as usize;
            at((low - 0.5).ceil())..at((high - 0.5).floor() + 1.0)
        };
        [span(low.y, high.y, band.top, rows), span(low.x, high.x, 0, self.columns)]
    }

    fn fill(&self, band: &mut Band, number: u32) {
        let mut outline = self.outline(&self.scene.faces[number as usize]);
        let Some(first) = outline.next() else { return };
        let rest = outline.clone().skip(1);
        for (a, b) in outline.zip(rest) {
            self.fill_triangle(band, number, [first, a, b]);
        }
    }

    fn fill_triangle(&self, band: &mut Band, number: u32, [a, b, c]: [DVec3; 3]) {
        let area = (b - a).xy().perp_dot((c - a).xy());
        if area == 0.0 || !area.is_finite() {
            return;
        }
        let [rows, columns] = self.within(band, a.min(b).min(c).xy(), a.max(b).max(c).xy());
        for row in rows {
            for column in columns.clone() {
                let p = DVec2::new(column as f64 + 0.5, (band.top + row) as f64 + 0.5);
                // Each is computed alike from either side of an edge, but for its sign: no sample falls between two faces.
                let [wa, wb, wc] = [(b, c), (c, a), (a, b)].map(|(s, e)| side(s.xy(), e.xy(), p) / area);
                if wa >= 0.0 && wb >= 0.0 && wc >= 0.0 {
                    let depth = ((wa * a.z + wb * b.z + wc * c.z) / (wa + wb + wc)) as f32;
                    let at = row * self.columns + column;
                    if depth > band.depth[at] {
                        band.depth[at] = depth;
                        band.seen[at] = number;
                    }
                }
            }
        }
    }

    fn stroke(&self, band: &mut Band, number: u32) {
        let [a, b] = self.ends[number as usize];
        let width = self.widths[self.scene.lines[number as usize].pen as usize];
        let reach = DVec2::splat(width / 2.0);
        let [rows, columns] = self.within(band, a.min(b).xy() - reach, a.max(b).xy() + reach);
        for row in rows {
            for column in columns.clone() {
                let p = DVec2::new(column as f64 + 0.5, (band.top + row) as f64 + 0.5);
                let share = nearest(a.xy(), b.xy(), p);
                let on = a.lerp(b, share);
                let at = row * self.columns + column;
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

/// How far along a segment, from 0 to 1, it is nearest to a point.
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
