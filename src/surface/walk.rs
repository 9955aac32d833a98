//! Geodesic walks: a displacement lies in its triangle's plane and is unfolded across each edge that it crosses.
//!
//! The twin of `walk` in `shaders/relax.wgsl`: the same operations in the same order. A walk never jumps to the other side of a
//! thin part, as a closest-point projection does. At a feature it continues along the feature.

use super::{NONE, Surface, SurfacePoint, next, previous};
use crate::geometry::{cross, dot, triangle_normal, unit};
use glam::Vec3;

/// The edges that one walk may cross; a longer one ends early.
pub(crate) const WALK_EDGES: u32 = 256;

/// Triangles that can be walked on.
pub(crate) trait Walkable {
    fn corners(&self, triangle: usize) -> [Vec3; 3];

    /// The opposite half-edge; [`NONE`] where it may not be crossed.
    fn beyond(&self, half_edge: u32) -> u32;
}

/// A surface of which some half-edges may not be crossed.
struct Barred<'a, F> {
    surface: &'a Surface,
    barrier: F,
}

impl<F: Fn(u32) -> bool> Walkable for Barred<'_, F> {
    fn corners(&self, triangle: usize) -> [Vec3; 3] {
        self.surface.corners(triangle)
    }

    fn beyond(&self, half_edge: u32) -> u32 {
        if (self.barrier)(half_edge) { NONE } else { self.surface.twins[half_edge as usize] }
    }
}

/// Walks from `position` in `triangle` by `displacement`, at most over `edges` edges.
///
/// `barrier(h)` tells whether half-edge `h` may not be crossed; boundary half-edges never are.
pub(crate) fn walk(
    surface: &Surface,
    barrier: impl Fn(u32) -> bool,
    triangle: u32,
    position: Vec3,
    displacement: Vec3,
    edges: u32,
) -> SurfacePoint {
    walk_on(&Barred { surface, barrier }, triangle, position, displacement, edges)
}

/// As [`walk`].
pub(crate) fn walk_on(
    triangles: &impl Walkable,
    triangle: u32,
    position: Vec3,
    displacement: Vec3,
    edges: u32,
) -> SurfacePoint {
    walk_through(triangles, triangle, position, displacement, edges, |_| true)
}

/// A part of a walk, in one triangle.
pub(super) struct Passed {
    /// The triangle's unit normal.
    pub normal: Vec3,
    /// The share of the displacement that lies in it.
    pub share: f32,
    /// Where the walk leaves it, or ends.
    pub to: Vec3,
    /// The direction of the walk in it, as long as the displacement.
    pub heading: Vec3,
}

/// As [`walk`]. `passed` receives the parts of the walk in turn and says whether it goes on.
pub(super) fn walk_through(
    triangles: &impl Walkable,
    triangle: u32,
    position: Vec3,
    displacement: Vec3,
    edges: u32,
    mut passed: impl FnMut(Passed) -> bool,
) -> SurfacePoint {
    let mut t = triangle;
    let mut p = position;
    let mut heading = displacement;
    let mut left = 1.0f32;
    let mut entered = NONE;
    let with_normal = |corners: [Vec3; 3]| (corners, triangle_normal(corners));
    let (mut corners, mut normal) = with_normal(triangles.corners(t as usize));
    for _ in 0..edges {
        let step = heading * left;
        // The first edge by which the rest of the walk leaves the triangle.
        let (mut exit, mut share) = (NONE, 1.0f32);
        for k in 0..3u32 {
            let h = 3 * t + k;
            if h == entered {
                continue;
            }
            let (a, b) = (corners[k as usize], corners[(k as usize + 1) % 3]);
            let inward = cross(normal, b - a);
            let speed = dot(inward, step);
            if speed < 0.0 {
                let reach = dot(inward, p - a).max(0.0) / (-speed);
                if reach < share {
                    share = reach;
                    exit = h;
                }
            }
        }
        p += step * share;
        let goes_on = passed(Passed { normal, share: left * share, to: p, heading });
        if exit == NONE || !goes_on {
            break;
        }
        left *= 1.0 - share;
        let k = exit as usize % 3;
        let along = unit(corners[(k + 1) % 3] - corners[k]);
        let forward = dot(heading, along);
        let twin = triangles.beyond(exit);
        if twin == NONE {
            heading = along * forward;
            entered = exit;
            continue;
        }
        let across = -dot(heading, cross(normal, along));
        t = twin / 3;
        entered = twin;
        (corners, normal) = with_normal(triangles.corners(t as usize));
        // Seen from the other side the edge runs backwards, so its inward normal is that of `-along`.
        heading = along * forward + cross(along, normal) * across;
    }
    SurfacePoint { triangle: t, position: onto_plane(p, corners[0], normal) }
}

fn onto_plane(p: Vec3, through: Vec3, normal: Vec3) -> Vec3 {
    p - normal * dot(normal, p - through)
}

/// The corner of the fan round a corner's vertex that follows it counter-clockwise; `None` past a barrier.
pub(crate) fn next_corner(surface: &Surface, barrier: impl Fn(u32) -> bool, corner: u32) -> Option<u32> {
    let edge = previous(corner);
    if barrier(edge) { None } else { surface.twin(edge) }
}

/// The corner that precedes it counter-clockwise; `None` past a barrier.
pub(crate) fn previous_corner(surface: &Surface, barrier: impl Fn(u32) -> bool, corner: u32) -> Option<u32> {
    if barrier(corner) { None } else { surface.twin(corner).map(next) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::examples::Example;
    use crate::surface::{FeatureOptions, Soup};
    use glam::Vec2;
    use std::f64::consts::{FRAC_PI_2, TAU};

    fn surface(soup: &Soup) -> Surface {
        Surface::new(soup, &FeatureOptions::default()).unwrap_or_else(|error| panic!("{error}"))
    }

    fn open(_: u32) -> bool {
        false
    }

    /// A grid of `columns` by `rows` cells bent by `place`; closed round the columns where asked.
    fn grid(columns: usize, rows: usize, closed: bool, place: impl Fn(usize, usize) -> [f64; 3]) -> Soup {
        let across = columns + usize::from(!closed);
        let at = |i: usize, j: usize| (j * across + i % across) as u32;
        let mut soup = Soup::default();
        for j in 0..=rows {
            soup.points.extend((0..across).map(|i| place(i, j)));
        }
        for j in 0..rows {
            for i in 0..columns {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                soup.triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
        soup
    }

    /// A flat square of 16 x 16 cells, inner points pushed about within a third of a cell.
    fn plate() -> Surface {
        surface(&grid(16, 16, false, |i, j| {
            let inner = (1..16).contains(&i) && (1..16).contains(&j);
            let push = |seed: usize| if inner { (seed * 7919 % 101) as f64 / 101.0 * 0.6 - 0.3 } else { 0.0 };
            [i as f64 + push(17 * i + j + 1), j as f64 + push(31 * j + 5 * i + 2), 0.0]
        }))
    }

    fn middle(surface: &Surface, triangle: u32) -> Vec3 {
        surface.corners(triangle as usize).iter().sum::<Vec3>() / 3.0
    }

    /// The distance of a point from its triangle, beyond its sides or off its plane.
    fn off(surface: &Surface, foot: &SurfacePoint) -> f32 {
        let [a, b, c] = surface.corners(foot.triangle as usize);
        let normal = surface.normal(foot.triangle as usize);
        let outside = |s: Vec3, e: Vec3| -dot(unit(cross(normal, e - s)), foot.position - s);
        let plane = dot(normal, foot.position - a).abs();
        [(a, b), (b, c), (c, a)].iter().map(|&(s, e)| outside(s, e)).fold(plane, f32::max)
    }

    /// Each edge crossed rounds a coordinate below 1 a few times by 6e-8; no walk here crosses more than 150.
    const TOLERANCE: f32 = 2e-5;

    #[test]
    fn on_a_plate_a_walk_is_a_straight_line() {
        let plate = plate();
        let mut walked = 0;
        for triangle in (0..plate.triangle_count() as u32).step_by(7) {
            for turn in 0..11 {
                let way = Vec2::from_angle(turn as f32 * 0.57).extend(0.0) * 0.25;
                let from = middle(&plate, triangle);
                let to = from + way;
                // The plate's half side in unit-sized coordinates is 1 / sqrt 8.
                if to.abs().max_element() > 0.35 {
                    continue;
                }
                let foot = walk(&plate, open, triangle, from, way, WALK_EDGES);
                assert!(foot.position.distance(to) < TOLERANCE, "{triangle} {turn}: {}", foot.position.distance(to));
                assert!(off(&plate, &foot) < TOLERANCE, "{triangle} {turn}: {}", off(&plate, &foot));
                walked += 1;
            }
        }
        assert!(walked > 300, "{walked}");
        // A walk that may cross one edge only ends short.
        let foot = walk(&plate, open, 200, middle(&plate, 200), Vec3::X * 0.25, 1);
        assert!(foot.position.distance(middle(&plate, 200) + Vec3::X * 0.25) > 0.1);
    }

    #[test]
    fn on_a_tube_a_helix_unrolls() {
        // Twelve flat facets a quarter: the unrolled tube is exactly flat, its perimeter that of the polygon.
        let (facets, rows) = (48, 40);
        let height = 4.0;
        let tube = surface(&grid(facets, rows, true, |i, j| {
            let t = TAU * i as f64 / facets as f64;
            [t.cos(), t.sin(), height * j as f64 / rows as f64 - height / 2.0]
        }));
        let scale = tube.frame().diagonal;
        let side = 2.0 * (TAU / facets as f64 / 2.0).sin() / scale;
        let perimeter = side * facets as f64;
        // The outside of facet 0, whose edges run along y at its middle.
        let triangle = (0..tube.triangle_count() as u32)
            .find(|&t| middle(&tube, t).z > 0.0 && tube.normal(t as usize).y > 0.0 && tube.normal(t as usize).x > 0.99)
            .expect("a facet near x = 1");
        let from = middle(&tube, triangle);
        let facet_of = |p: Vec3| {
            let turn = f64::from(p.y).atan2(f64::from(p.x)).rem_euclid(TAU) / TAU * facets as f64;
            let k = turn.floor();
            // Along the facet from its first vertex.
            let t = TAU * k / facets as f64;
            let first = glam::DVec2::new(t.cos(), t.sin()) / scale;
            k * side + p.as_dvec3().truncate().distance(first)
        };
        let round = unit(cross(Vec3::Z, tube.normal(triangle as usize)));
        for (around, up) in [(0.3, 0.0), (0.5, 0.1), (1.0, -0.2), (1.6, 0.05), (-1.1, -0.1)] {
            let way = round * (around * perimeter) as f32 + Vec3::Z * up;
            let foot = walk(&tube, open, triangle, from, way, 400);
            let wanted = (facet_of(from) + around * perimeter).rem_euclid(perimeter);
            let found = facet_of(foot.position);
            let miss = (found - wanted + perimeter / 2.0).rem_euclid(perimeter) - perimeter / 2.0;
            assert!(miss.abs() < f64::from(TOLERANCE), "{around} round: {miss:e}");
            assert!((foot.position.z - from.z - up).abs() < TOLERANCE, "{around} round, {up} up");
            assert!(off(&tube, &foot) < TOLERANCE);
        }
        // A chord laid off in space leaves the tube.
        let leapt = from + round * (0.3 * perimeter) as f32;
        assert!(leapt.truncate().length() > 1.2 / scale as f32);
    }

    #[test]
    fn a_quarter_of_a_great_circle_ends_a_quarter_round() {
        let sphere = surface(&Example::Sphere.generate(20_000));
        let radius = 1.0 / sphere.frame().diagonal;
        for triangle in (0..sphere.triangle_count() as u32).step_by(997) {
            let from = middle(&sphere, triangle);
            let normal = sphere.normal(triangle as usize);
            let along = unit(cross(normal, Vec3::new(0.3, -0.5, 0.8)));
            let foot = walk(&sphere, open, triangle, from, along * (radius * FRAC_PI_2) as f32, WALK_EDGES);
            let miss = f64::from(foot.position.distance(along * radius as f32)) / radius;
            // Passing a vertex on one side and not the other turns a straight line by that vertex's angle defect, 4 pi /
            // 10,000; some 50 are passed, and where all turned it alike it would miss by half of their sum, 0.03.
            assert!(miss < 0.03, "{triangle}: {miss}");
            assert!(off(&sphere, &foot) < TOLERANCE);
            let eighth = walk(&sphere, open, triangle, from, along * (radius * FRAC_PI_2 * 0.9) as f32, WALK_EDGES);
            assert!(eighth.position.distance(along * radius as f32) > (0.1 * radius) as f32);
        }
    }

    #[test]
    fn at_a_crease_a_walk_slides_and_without_barrier_it_crosses() {
        let block = surface(&Example::Block.generate(4_000));
        let scale = block.frame().diagonal as f32;
        let (edge, top) = (1.0 / scale, 0.5 / scale);
        let barrier = |h| block.features().is_feature(h);
        let mut tried = 0;
        for triangle in 0..block.triangle_count() as u32 {
            let from = middle(&block, triangle);
            if block.normal(triangle as usize).z < 0.99 || from.x < 0.85 / scale || from.y.abs() > 0.4 / scale {
                continue;
            }
            for aside in [-0.35f32, -0.1, 0.0, 0.2, 0.4] {
                let way = Vec3::new(0.4, aside, 0.0) / scale;
                let slid = walk(&block, barrier, triangle, from, way, WALK_EDGES);
                let along = Vec3::new(edge, from.y + way.y, top);
                assert!(slid.position.distance(along) < TOLERANCE, "{triangle} {aside}: {:?}", slid.position * scale);
                assert!(block.normal(slid.triangle as usize).z > 0.99, "{triangle} {aside}: off the top");
                let crossed = walk(&block, open, triangle, from, way, WALK_EDGES);
                let down = Vec3::new(edge, from.y + way.y, top - (from.x + way.x - edge));
                assert!(crossed.position.distance(down) < TOLERANCE, "{triangle} {aside}: {:?}", crossed.position);
                assert!(block.normal(crossed.triangle as usize).x > 0.99, "{triangle} {aside}: still on the top");
                tried += 1;
            }
        }
        assert!(tried > 100, "{tried}");
    }

    #[test]
    fn at_a_boundary_a_walk_slides_and_in_a_corner_it_stops() {
        let plate = plate();
        let edge = 0.5 / 2f32.sqrt();
        for triangle in 0..plate.triangle_count() as u32 {
            let from = middle(&plate, triangle);
            for way in [[0.5, 0.1], [-0.9, 0.2], [0.02, -0.7], [2.0, 2.0], [-3.0, 0.9]] {
                let way = Vec3::new(way[0], way[1], 0.0);
                let foot = walk(&plate, open, triangle, from, way, WALK_EDGES);
                let wanted = (from + way).clamp(Vec3::new(-edge, -edge, 0.0), Vec3::new(edge, edge, 0.0));
                assert!(foot.position.distance(wanted) < TOLERANCE, "{triangle} {way}: {} {wanted}", foot.position);
                assert!(off(&plate, &foot) < TOLERANCE);
            }
        }
    }

    #[test]
    fn the_corners_round_a_vertex_follow_each_other_up_to_a_barrier() {
        let block = surface(&Example::Block.generate(1_000));
        let barrier = |h| block.features().is_feature(h);
        let mut stopped = 0;
        for corner in 0..3 * block.triangle_count() as u32 {
            let after = next_corner(&block, open, corner).expect("the block is closed");
            assert_eq!(block.origin(after), block.origin(corner));
            assert_eq!(previous_corner(&block, open, after), Some(corner));
            match next_corner(&block, barrier, corner) {
                Some(same) => assert_eq!(same, after),
                None => stopped += 1,
            }
        }
        let marked = (0..3 * block.triangle_count() as u32).filter(|&h| barrier(h)).count();
        assert_eq!(stopped, marked, "each side of a feature edge ends one fan");
    }
}
