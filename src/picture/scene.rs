//! What is drawn: faces with sides, and lines, in model units.

use super::{Colour, Legend};
use glam::{DVec3, Vec3};

/// How a line or a face's side is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pen {
    /// Its colour.
    pub colour: Colour,
    /// Its width, in thousandths of the picture's shorter side.
    pub width: f32,
    /// No side is drawn wider than this share of the mean length of all sides drawn with this pen: a fine mesh has fine lines.
    pub most: f32,
}

/// A side without a pen is not drawn.
pub(super) const NO_PEN: u8 = u8::MAX;

/// A corner of a face, and the side from it to the next corner.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    pub point: u32,
    pub normal: Vec3,
    pub pen: u8,
}

/// A run of corners.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face {
    pub first: u32,
    pub sides: u32,
    pub colour: Colour,
}

/// A straight line on a surface; a dot where its ends are the same.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    pub ends: [DVec3; 2],
    /// That of the surface below: from behind the line is not drawn. Zero: it is seen from everywhere.
    pub normal: Vec3,
    pub pen: u8,
}

/// Faces, lines on them, and a legend.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    pub(super) points: Vec<DVec3>,
    pub(super) corners: Vec<Corner>,
    pub(super) faces: Vec<Face>,
    pub(super) lines: Vec<Line>,
    pub(super) pens: Vec<Pen>,
    /// How many faces, the first ones, are what the others lie on; 0: none lies on another.
    pub(super) ground: usize,
    /// What the colours mean.
    pub legend: Option<Legend>,
}

impl Scene {
    /// Adds a pen; its number.
    pub(super) fn pen(&mut self, pen: Pen) -> u8 {
        self.pens.push(pen);
        (self.pens.len() - 1) as u8
    }

    /// Adds points; the number of the first.
    pub(super) fn place(&mut self, points: impl IntoIterator<Item = [f64; 3]>) -> u32 {
        let first = self.points.len() as u32;
        self.points.extend(points.into_iter().map(DVec3::from));
        first
    }

    /// Adds a face, counter-clockwise seen from outside.
    pub(super) fn face(&mut self, corners: &[Corner], colour: Colour) {
        let first = self.corners.len() as u32;
        let start = self.fan_start(corners);
        self.corners.extend_from_slice(&corners[start..]);
        self.corners.extend_from_slice(&corners[..start]);
        self.faces.push(Face { first, sides: corners.len() as u32, colour });
    }

    /// Adds a flat face; `pens` tells the pen of the side after each corner.
    pub(super) fn flat_face(&mut self, points: &[u32], colour: Colour, pens: impl Fn(usize) -> u8) {
        let normal = self.normal(points);
        let corners: Vec<Corner> =
            points.iter().enumerate().map(|(k, &point)| Corner { point, normal, pen: pens(k) }).collect();
        self.face(&corners, colour);
    }

    pub(super) fn line(&mut self, ends: [[f64; 3]; 2], normal: Vec3, pen: u8) {
        self.lines.push(Line { ends: ends.map(DVec3::from), normal, pen });
    }

    /// The same scene with its lines cut into pieces that are no longer than `longest` allows for each.
    pub(super) fn with_lines_cut(&self, longest: f64, length: impl Fn(&Line) -> f64) -> Self {
        let pieces = |line: &Line| {
            let count = (length(line) / longest).ceil().max(1.0);
            let ([a, b], line) = (line.ends, *line);
            let end = move |k: usize| a.lerp(b, k as f64 / count);
            (0..count as usize).map(move |k| Line { ends: [end(k), end(k + 1)], ..line })
        };
        Self { lines: self.lines.iter().flat_map(pieces).collect(), ..self.clone() }
    }

    pub(super) fn corners_of(&self, face: &Face) -> &[Corner] {
        &self.corners[face.first as usize..(face.first + face.sides) as usize]
    }

    /// The unit normal of a polygon, flat or not.
    pub(super) fn normal(&self, points: &[u32]) -> Vec3 {
        let first = self.points[points[0] as usize];
        let ways: Vec<DVec3> = points.iter().map(|&point| self.points[point as usize] - first).collect();
        ways.windows(2).map(|pair| pair[0].cross(pair[1])).sum::<DVec3>().normalize_or_zero().as_vec3()
    }

    /// The corner from which a fan of triangles covers the face best: the reflex one of a concave quad.
    fn fan_start(&self, corners: &[Corner]) -> usize {
        if corners.len() < 4 {
            return 0;
        }
        let places: Vec<DVec3> = corners.iter().map(|corner| self.points[corner.point as usize]).collect();
        let count = places.len();
        let numbers: Vec<u32> = corners.iter().map(|corner| corner.point).collect();
        let normal = self.normal(&numbers).as_dvec3();
        let worst = |start: usize| {
            let at = |k: usize| places[(start + k) % count] - places[start];
            (1..count - 1).map(|k| at(k).cross(at(k + 1)).dot(normal)).fold(f64::INFINITY, f64::min)
        };
        (0..count).fold((0, f64::NEG_INFINITY), |best, k| if worst(k) > best.1 { (k, worst(k)) } else { best }).0
    }
}
