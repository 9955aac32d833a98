//! Scenes of cross fields: streamlines or crosses on the surface, and singularities.
//!
//! # Theory
//! Streamlines are spaced after Jobard and Lefer (*Creating evenly-spaced streamlines of arbitrary density*, 1997): one begins
//! where no other in the same direction is near, and ends where it comes near to one. The lines of a cross field do not fall into
//! two families, so that only directions are compared.

use super::mesh::surface_scene;
use super::{Colour, Pen, Scene};
use crate::field::{Field, SingularityLocation};
use crate::geometry::{cross, dot};
use crate::surface::sampling::sample_evenly;
use crate::surface::{Surface, SurfacePoint, WALK_EDGES, walk};
use glam::Vec3;
use rustc_hash::FxHashMap;

/// How a field is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FieldStyle {
    /// Lines that follow it.
    #[default]
    Streamlines,
    /// A cross here and there.
    Crosses,
}

/// The crosses on a surface, and the squares of the distance between streamlines that cover it.
const CROSSES: f64 = 1_500.0;
const STREAMS: f64 = 4_000.0;
/// Points at which a cross, or a line, is tried, for each that may be drawn.
const TRIES: f64 = 12.0;
/// Half the length of a cross's arm, in distances between crosses.
const ARM: f32 = 0.38;
/// Steps of a streamline for each distance to the next.
const STEPS: i32 = 4;
/// The longest half of a streamline, in steps.
const LONGEST: i32 = 400;
/// A streamline ends where it is nearer than this to another, in distances.
const NEAREST: f32 = 0.6;
/// The height of lines above the surface, in distances.
const LIFT: f32 = 0.03;
/// Directions and normals that are alike have at least this cosine.
const ALIKE: f32 = 0.7;

/// A field on its surface, with its singularities: red where rows bend round a point, blue where they part.
pub fn field_scene(surface: &Surface, field: &Field, style: FieldStyle) -> Scene {
    let mut scene = surface_scene(surface, Colour::CLAY);
    let pen = scene.pen(Pen { colour: Colour::BLUE, width: 1.5, most: f32::INFINITY });
    for (ends, normal) in field_lines(surface, field, style) {
        scene.line(ends, normal, pen);
    }
    let dot = |colour| Pen { colour, width: 11.0, most: f32::INFINITY };
    let pens = [dot(Colour::RED), dot(Colour::BLUE)].map(|pen| scene.pen(pen));
    for singularity in field.singularities(surface) {
        let place = surface.frame().to_model(singularity.position);
        let normal = match singularity.location {
            SingularityLocation::Triangle(triangle) => surface.normal(triangle as usize),
            SingularityLocation::Corner(_) => Vec3::ZERO,
        };
        scene.line([place; 2], normal, pens[usize::from(singularity.quarters < 0)]);
    }
    scene
}

/// The lines of a field a little above its surface: the ends of each, in model units, and the normal of the surface.
pub(crate) fn field_lines(
    surface: &Surface,
    field: &Field,
    style: FieldStyle,
) -> impl Iterator<Item = ([[f64; 3]; 2], Vec3)> {
    let segments = match style {
        FieldStyle::Streamlines => streamlines(surface, field),
        FieldStyle::Crosses => crosses(surface, field),
    };
    let model = |place: Vec3| surface.frame().to_model(place.as_dvec3().into());
    segments.into_iter().map(move |[a, b]| {
        let normal = (a.normal + b.normal).normalize_or_zero();
        ([a.raised, b.raised].map(model), normal)
    })
}

/// A point of a line: in a triangle, and raised above it.
#[derive(Clone, Copy)]
struct RaisedPoint {
    point: SurfacePoint,
    normal: Vec3,
    raised: Vec3,
}

impl RaisedPoint {
    fn new(surface: &Surface, point: SurfacePoint, lift: f32) -> Self {
        let normal = surface.normal(point.triangle as usize);
        Self { point, normal, raised: point.position + normal * lift }
    }

    /// One step further; `None` where a feature or a boundary ends it.
    fn step(&self, surface: &Surface, way: Vec3, lift: f32) -> Option<Self> {
        let barrier = |h: u32| surface.features().is_feature(h);
        let end = walk(surface, barrier, self.point.triangle, self.point.position, way, WALK_EDGES);
        let moved = end.position - self.point.position;
        // Turned aside, it slides along a feature.
        let straight = dot(moved, way) > 0.8 * dot(way, way);
        straight.then(|| Self::new(surface, end, lift))
    }

    /// The direction of the cross that is nearest to this one.
    fn direction(&self, surface: &Surface, field: &Field, near: Vec3) -> Vec3 {
        let axis = field.axis(surface, self.point.triangle, self.point.position);
        let other = cross(self.normal, axis);
        let nearest = if dot(axis, near).abs() >= dot(other, near).abs() { axis } else { other };
        if dot(nearest, near) < 0.0 { -nearest } else { nearest }
    }
}

/// Points in an order that fills the surface evenly from the first on.
fn candidates(surface: &Surface, count: f64) -> Vec<SurfacePoint> {
    let points = sample_evenly(surface, (count * TRIES) as usize);
    let bits = points.len().next_power_of_two().trailing_zeros().max(1);
    let order = (0..1_usize << bits).map(|number| number.reverse_bits() >> (usize::BITS - bits));
    order.filter_map(|number| points.get(number).copied()).collect()
}

fn crosses(surface: &Surface, field: &Field) -> Vec<[RaisedPoint; 2]> {
    let apart = (surface.area() / CROSSES).sqrt() as f32;
    let mut marks = MarkGrid::new(apart);
    let mut segments = Vec::new();
    for point in candidates(surface, CROSSES) {
        let post = RaisedPoint::new(surface, point, LIFT * apart);
        let mark = Mark { position: point.position, normal: post.normal, way: Vec3::ZERO, line: 0, step: 0 };
        if marks.any_near(point.position, 0.85 * apart, |other| dot(other.normal, post.normal) > 0.0) {
            continue;
        }
        marks.add(mark);
        let axis = field.axis(surface, point.triangle, point.position);
        let other = cross(post.normal, axis);
        for way in [axis, other, -axis, -other] {
            segments.extend(post.step(surface, way * (ARM * apart), LIFT * apart).map(|end| [post, end]));
        }
    }
    segments
}

fn streamlines(surface: &Surface, field: &Field) -> Vec<[RaisedPoint; 2]> {
    let apart = (surface.area() / STREAMS).sqrt() as f32;
    let (step, lift) = (apart / STEPS as f32, LIFT * apart);
    let mut marks = MarkGrid::new(apart);
    let mut segments = Vec::new();
    let mut line = 0;
    for point in candidates(surface, STREAMS) {
        let seed = RaisedPoint::new(surface, point, lift);
        let axis = field.axis(surface, point.triangle, point.position);
        for way in [axis, cross(seed.normal, axis)] {
            let begin = Mark { position: point.position, normal: seed.normal, way, line, step: 0 };
            if marks.any_near(point.position, 0.9 * apart, |other| other.runs_as(&begin)) {
                continue;
            }
            marks.add(begin);
            for sign in [1, -1] {
                let (mut post, mut way) = (seed, way * sign as f32);
                for number in 1..=LONGEST {
                    let Some(next) = post.step(surface, way * step, lift) else { break };
                    way = next.direction(surface, field, way);
                    let mark =
                        Mark { position: next.point.position, normal: next.normal, way, line, step: sign * number };
                    let hindered = |other: &Mark| {
                        other.runs_as(&mark) && (other.line != line || (other.step - mark.step).abs() > 3 * STEPS)
                    };
                    if marks.any_near(mark.position, NEAREST * apart, hindered) {
                        break;
                    }
                    marks.add(mark);
                    segments.push([post, next]);
                    post = next;
                }
            }
            line += 1;
        }
    }
    segments
}

/// A point of a line that is drawn already.
#[derive(Clone, Copy)]
struct Mark {
    position: Vec3,
    normal: Vec3,
    way: Vec3,
    line: u32,
    step: i32,
}

impl Mark {
    /// Whether a line runs nearly as another, on the same sheet.
    fn runs_as(&self, other: &Self) -> bool {
        dot(self.normal, other.normal) > ALIKE && dot(self.way, other.way).abs() > ALIKE
    }
}

/// Marks by the cells of a grid.
struct MarkGrid {
    cell: f32,
    cells: FxHashMap<[i32; 3], Vec<Mark>>,
}

impl MarkGrid {
    fn new(cell: f32) -> Self {
        Self { cell, cells: FxHashMap::default() }
    }

    fn cell_of(&self, position: Vec3) -> [i32; 3] {
        (position / self.cell).floor().to_array().map(|x| x as i32)
    }

    fn add(&mut self, mark: Mark) {
        self.cells.entry(self.cell_of(mark.position)).or_default().push(mark);
    }

    /// Whether any mark nearer than `reach`, at most a cell, is of that kind.
    fn any_near(&self, position: Vec3, reach: f32, of_kind: impl Fn(&Mark) -> bool) -> bool {
        let [x, y, z] = self.cell_of(position);
        let cells = (0..27).map(|k| [x + k % 3 - 1, y + k / 3 % 3 - 1, z + k / 9 - 1]);
        let marks = cells.filter_map(|cell| self.cells.get(&cell)).flatten();
        marks.into_iter().any(|mark| mark.position.distance_squared(position) < reach * reach && of_kind(mark))
    }
}
