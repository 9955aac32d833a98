//! Noise: a surface that is rough at a scale much smaller than a tile is smoothed before it is meshed.
//!
//! # Theory
//! A surface is noisy where it has many creases of one or two edges that do not persist at the scale of a tile. Its points are then filtered by implicit
//! diffusion: `(M + r^2 L) x = M x0`, with the vertices' areas `M` and a Laplacian `L` of positive weights, is the low-pass filter
//! `S` of a radius `r`. `2 S - S^2` keeps more of the shape: of waves two tiles long it takes an eighth. (Desbrun et al.,
//! *Implicit fairing of irregular meshes using diffusion and curvature flow*, 1999.)
//!
//! # Practice
//! Boundaries, named edges, places where sheets meet, and parts smaller than a few tiles stay. Points move by no more than a share of
//! the thickness of a wall. [`Denoised`] tells how far points moved.
//! The radius is the same everywhere: thin parts are found where a surface is noisy, too (docs/experiments.md, features at the scale of a tile).

use super::nearest::Triangles;
use super::{DroppedEdge, NONE, Reason, Surface};
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use rustc_hash::FxHashMap;
use serde::Serialize;

/// A dropped crease of no more edges is one of noise.
const MOST_EDGES: usize = 2;
/// The length of such creases in a square of a tile, in tile sides, from which a surface is noisy.
const NOISY: f64 = 0.4;
/// The radius of the filter, in tile sides.
const RADIUS: f64 = 0.25;
/// A part of a smaller area, in squares of a tile, keeps its points: the filter would make a point of it.
const LEAST_AREA: f64 = 4.0;
/// A point moves by no more than this share of the thickness of the wall there: both sides move.
const SHARE_OF_THICKNESS: f64 = 0.1;
/// The largest cosine of the normals of a wall's two sides.
const OPPOSED: f64 = -0.5;
/// The most rounds of smoothing: one is made where the surface is noisy still.
pub(super) const MOST_ROUNDS: usize = 3;
/// The residual at which the solve ends, as a share of the first one.
const RESIDUAL: f64 = 1e-4;
/// The most iterations of the solve.
const MOST_ITERATIONS: usize = 400;
/// The number of rows whose products are summed in order, so that the result does not depend on the number of threads.
const BLOCK: usize = 4096;

/// The displacements of the points of a surface that was smoothed, in model units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Denoised {
    /// The mean displacement.
    pub mean: f64,
    /// The largest displacement.
    pub largest: f64,
}

impl Denoised {
    /// The displacements of the points of a surface, whose unit-sized coordinates were `given`.
    pub(super) fn of(given: &[Vec3], surface: &Surface) -> Self {
        let unit = surface.frame.diagonal;
        let distances = given.iter().zip(&surface.points).map(|(a, b)| unit * a.as_dvec3().distance(b.as_dvec3()));
        let (sum, largest) = distances.fold((0.0, 0.0_f64), |(sum, largest), d| (sum + d, largest.max(d)));
        Self { mean: sum / given.len().max(1) as f64, largest }
    }
}

/// Whether a surface with these dropped creases is noisy for tiles of a side, unit-sized.
pub(super) fn is_noisy(surface: &Surface, dropped: &[DroppedEdge], side: f64) -> bool {
    let mut edges: FxHashMap<u32, usize> = FxHashMap::default();
    dropped.iter().for_each(|edge| *edges.entry(edge.crease).or_default() += 1);
    let of_noise = dropped.iter().filter(|edge| edge.reason != Reason::Double && edges[&edge.crease] <= MOST_EDGES);
    of_noise.map(|edge| surface.length(edge.half_edge)).sum::<f64>() * side >= NOISY * surface.area()
}

/// The smoothed points of a surface for tiles of a side, unit-sized.
pub(super) fn smoothed(surface: &Surface, side: f64) -> Vec<Vec3> {
    let given: Vec<DVec3> = surface.points.iter().map(|point| point.as_dvec3()).collect();
    let filtered = filtered(surface, &given, side);
    within_walls(surface, &given, &filtered).into_iter().map(|point| point.as_vec3()).collect()
}

/// The given points after the filter.
fn filtered(surface: &Surface, given: &[DVec3], side: f64) -> Vec<DVec3> {
    let diffusion = Diffusion::new(surface, side);
    let once = diffusion.solve(given);
    let rest: Vec<DVec3> = given.iter().zip(&once).map(|(given, once)| *given - *once).collect();
    let again = diffusion.solve(&rest);
    once.iter().zip(&again).map(|(once, again)| *once + *again).collect()
}

/// The smooth points, moved back where they have moved by more than a share of the thickness of a wall: the distance of a given point
/// from a triangle that is opposed once it is smooth.
fn within_walls(surface: &Surface, given: &[DVec3], smooth: &[DVec3]) -> Vec<DVec3> {
    let vector_area = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|v| smooth[v as usize]);
        (b - a).cross(c - a)
    };
    let mut normals = vec![DVec3::ZERO; smooth.len()];
    for triangle in &surface.triangles {
        let area = vector_area(triangle);
        triangle.iter().for_each(|&v| normals[v as usize] += area);
    }
    let tree = Triangles::new(surface);
    let of_triangles = surface.triangles.par_iter().map(|t| vector_area(t).normalize_or_zero());
    let of_triangles = tree.with_normals(of_triangles.collect());
    let point = |v: usize| {
        let (way, normal) = (smooth[v] - given[v], normals[v].normalize_or_zero());
        let length = way.length();
        let farthest = length / SHARE_OF_THICKNESS;
        match tree.nearest_opposed(given[v], farthest, normal, OPPOSED, &of_triangles) {
            Some(thickness) => given[v] + way * (SHARE_OF_THICKNESS * thickness / length),
            None => smooth[v],
        }
    };
    (0..smooth.len()).into_par_iter().with_min_len(BLOCK).map(point).collect()
}

/// The equations of implicit diffusion; the values of some vertices are fixed.
struct Diffusion {
    /// The area of each vertex; 0 where its value is fixed.
    mass: Vec<f64>,
    diagonal: Vec<f64>,
    /// For each vertex, the place of its first neighbour, and the end of the last.
    starts: Vec<usize>,
    /// The neighbours with their weights.
    links: Vec<(u32, f64)>,
}

impl Diffusion {
    fn new(surface: &Surface, side: f64) -> Self {
        let count = surface.vertex_count();
        let radius = RADIUS * side;
        let mut is_fixed = surface.shared_places();
        let is_small = surface.areas_of_parts().into_iter().map(|area| area < LEAST_AREA * side * side);
        is_fixed.iter_mut().zip(is_small).for_each(|(is_fixed, is_small)| *is_fixed |= is_small);
        let mut mass = vec![0.0; count];
        // The area beside an edge over its squared length: for equilateral triangles that of the cotangents.
        let mut sides: Vec<(u32, u32, f64)> = Vec::with_capacity(6 * surface.triangle_count());
        for h in 0..3 * surface.triangle_count() as u32 {
            let (a, b) = (surface.origin(h), surface.target(h));
            let area = f64::from(surface.double_area(h as usize / 3)) / 2.0;
            let length = surface.length(h).max(f64::MIN_POSITIVE);
            let weight = radius * radius * 2.0 * area / (3.0 * length * length);
            sides.extend([(a, b, weight), (b, a, weight)]);
            mass[a as usize] += area / 3.0;
            if surface.twins[h as usize] == NONE || surface.is_named(h) {
                (is_fixed[a as usize], is_fixed[b as usize]) = (true, true);
            }
        }
        sides.par_sort_unstable_by_key(|&(a, b, _)| (a, b));
        let mut starts = vec![0; count + 1];
        let mut links = Vec::with_capacity(sides.len() / 2);
        let mut diagonal = mass.clone();
        for same in sides.chunk_by(|x, y| (x.0, x.1) == (y.0, y.1)) {
            let (a, b, weight) = (same[0].0 as usize, same[0].1, same.iter().map(|side| side.2).sum::<f64>());
            links.push((b, weight));
            diagonal[a] += weight;
            starts[a + 1] = links.len();
        }
        (0..count).for_each(|v| starts[v + 1] = starts[v + 1].max(starts[v]));
        is_fixed.iter().zip(&mut mass).filter(|(fixed, _)| **fixed).for_each(|(_, mass)| *mass = 0.0);
        Self { mass, diagonal, starts, links }
    }

    fn is_fixed(&self, v: usize) -> bool {
        self.mass[v] == 0.0
    }

    /// The left-hand side; 0 in the rows of fixed values.
    fn times(&self, x: &[DVec3]) -> Vec<DVec3> {
        let row = |v: usize| match self.is_fixed(v) {
            true => DVec3::ZERO,
            false => {
                let links = &self.links[self.starts[v]..self.starts[v + 1]];
                x[v] * self.diagonal[v] - links.iter().map(|&(w, weight)| x[w as usize] * weight).sum::<DVec3>()
            }
        };
        (0..x.len()).into_par_iter().with_min_len(BLOCK).map(row).collect()
    }

    /// Conjugate gradients for all coordinates, with the diagonal as the preconditioner. Fixed values are those of `given`.
    fn solve(&self, given: &[DVec3]) -> Vec<DVec3> {
        let mut x = given.to_vec();
        let left = self.times(&x);
        let mut residual: Vec<DVec3> = (0..x.len()).map(|v| given[v] * self.mass[v] - left[v]).collect();
        let scaled = |residual: &[DVec3]| -> Vec<DVec3> {
            residual.iter().zip(&self.diagonal).map(|(r, d)| *r / d.max(f64::MIN_POSITIVE)).collect()
        };
        let mut preconditioned = scaled(&residual);
        let mut direction = preconditioned.clone();
        let mut product = inner(&residual, &preconditioned);
        let first = product;
        for _ in 0..MOST_ITERATIONS {
            if product.max_element() <= RESIDUAL * RESIDUAL * first.max_element() {
                break;
            }
            let image = self.times(&direction);
            let step = divided(product, inner(&direction, &image));
            x.par_iter_mut().zip(&direction).with_min_len(BLOCK).for_each(|(x, d)| *x += step * *d);
            residual.par_iter_mut().zip(&image).with_min_len(BLOCK).for_each(|(r, i)| *r -= step * *i);
            preconditioned = scaled(&residual);
            let next = inner(&residual, &preconditioned);
            let share = divided(next, product);
            direction.par_iter_mut().zip(&preconditioned).with_min_len(BLOCK).for_each(|(d, p)| *d = *p + share * *d);
            product = next;
        }
        x
    }
}

/// The inner product of each coordinate, summed in the same order on any number of threads.
fn inner(a: &[DVec3], b: &[DVec3]) -> DVec3 {
    let blocks = a.par_chunks(BLOCK).zip(b.par_chunks(BLOCK));
    let sums: Vec<DVec3> = blocks.map(|(a, b)| a.iter().zip(b).map(|(a, b)| *a * *b).sum()).collect();
    sums.into_iter().sum()
}

/// The quotient of each coordinate; 0 where the divisor is 0.
fn divided(a: DVec3, b: DVec3) -> DVec3 {
    DVec3::from_array([0, 1, 2].map(|k| if b[k] > 0.0 { a[k] / b[k] } else { 0.0 }))
}

#[cfg(test)]
mod tests {
    use super::super::turning::tests::drawn_out;
    use super::*;
    use crate::surface::examples::Example;
    use crate::surface::{FeatureOptions, Soup};
    use std::f64::consts::TAU;

    fn surface(soup: &Soup) -> Surface {
        Surface::new(soup, &FeatureOptions::default()).unwrap_or_else(|error| panic!("{error}"))
    }

    /// Reproducible numbers from -1 to 1.
    fn noise(seed: usize) -> f64 {
        let x = (seed as f64 * 12.9898).sin() * 43_758.547;
        2.0 * (x - x.floor()) - 1.0
    }

    /// A sphere of radius 1 whose points are moved along its radii by up to `amplitude`.
    fn sphere(amplitude: f64) -> Soup {
        let mut soup = Example::Sphere.generate(20_000);
        soup.points.iter_mut().enumerate().for_each(|(k, p)| *p = p.map(|x| x * (1.0 + amplitude * noise(k))));
        soup
    }

    /// The mean and the standard deviation of the distances of the points from the origin.
    fn radii(surface: &Surface) -> (f64, f64) {
        let place = |p: &Vec3| DVec3::from(surface.frame().to_model(p.as_dvec3().into())).length();
        let radii: Vec<f64> = surface.points.iter().map(place).collect();
        let mean = radii.iter().sum::<f64>() / radii.len() as f64;
        let variance = radii.iter().map(|r| (r - mean).powi(2)).sum::<f64>() / radii.len() as f64;
        (mean, variance.sqrt())
    }

    #[test]
    fn waves_are_damped_as_the_filter_says() {
        // Waves along x, 16 cells long, on a plate of 128 x 32 cells; the ends are fixed, so the middle is compared.
        let (columns, wavelength, height) = (128, 16.0, 0.01);
        let wave = |x: f64| height * (TAU * x / wavelength).cos();
        let profile: Vec<[f64; 2]> = (0..=columns).map(f64::from).map(|x| [x, wave(x)]).collect();
        let surface = surface(&drawn_out(&profile, 32, 1.0));
        for side in [4.0, 8.0, 16.0] {
            let share = (TAU * RADIUS * side / wavelength).powi(2);
            let once = 1.0 / (1.0 + share);
            let expected = 2.0 * once - once * once;
            let points = smoothed(&surface, side / surface.frame().diagonal);
            let middle = |p: &DVec3| (p.x - 64.0).abs() < 0.01 && (p.y - 16.0).abs() < 0.01;
            let places = points.iter().map(|p| DVec3::from(surface.frame().to_model(p.as_dvec3().into())));
            let top = places.into_iter().find(middle).expect("a point in the middle").z;
            assert!((top / height - expected).abs() < 0.03, "side {side}: {} for {expected}", top / height);
        }
    }

    #[test]
    fn noise_goes_and_the_shape_stays() {
        let noisy = surface(&sphere(0.01));
        let side = 0.4;
        let fitted = noisy.clone().fitted(&FeatureOptions::default(), (side / noisy.frame().diagonal) as f32);
        let ((_, before), (mean, after)) = (radii(&noisy), radii(&fitted));
        assert!(before > 0.005 && after < before / 4.0, "{before} to {after}");
        assert!((mean - 1.0).abs() < 0.001, "{mean}");
        assert_eq!(fitted.features().curves().len(), 0);
        let moved = fitted.denoised().expect("it is noisy");
        assert!(moved.mean > 0.003 && moved.largest < 0.02, "{moved:?}");
        let given = fitted.as_given().expect("its points moved");
        assert!(given.points == noisy.points && given.triangles == noisy.triangles);
        // Also where no crease is to be a feature; where each is one, none is noise.
        let side = (side / noisy.frame().diagonal) as f32;
        let without = FeatureOptions { crease: 180.0, every_crease: true, ..FeatureOptions::default() };
        assert_eq!(noisy.clone().fitted(&without, side).denoised(), Some(moved));
        let each = FeatureOptions { every_crease: true, ..FeatureOptions::default() };
        assert_eq!(noisy.fitted(&each, side).denoised(), None);
    }

    #[test]
    fn a_rod_thinner_than_the_filter_keeps_its_thickness() {
        let (sectors, rings, radius) = (12, 300, 0.1);
        let point = |k: usize| {
            let angle = TAU * (k % sectors) as f64 / sectors as f64;
            let here = radius * (1.0 + 0.2 * noise(k));
            [here * angle.cos(), here * angle.sin(), 10.0 * (k / sectors) as f64 / rings as f64]
        };
        let at = |ring: usize, k: usize| (ring * sectors + k % sectors) as u32;
        let cell = |k: usize| {
            let [a, b] = [0, 1].map(|up| [0, 1].map(|along| at(k / sectors + up, k + along)));
            [[a[0], a[1], b[1]], [a[0], b[1], b[0]]]
        };
        let points = (0..sectors * (rings + 1)).map(point).collect();
        let rod =
            surface(&Soup { points, triangles: (0..sectors * rings).flat_map(cell).collect(), ..Soup::default() });
        let side = 1.0 / rod.frame.diagonal;
        // In the middle; the rims stay.
        let thinnest = |points: &[DVec3]| {
            let places = points.iter().map(|p| DVec3::from(rod.frame().to_model((*p).into())));
            places.filter(|p| (p.z - 5.0).abs() < 3.0).map(|p| p.truncate().length()).fold(f64::INFINITY, f64::min)
        };
        let smooth: Vec<DVec3> = smoothed(&rod, side).iter().map(|p| p.as_dvec3()).collect();
        assert!(thinnest(&smooth) > 0.5 * radius, "{}", thinnest(&smooth));
        let given: Vec<DVec3> = rod.points.iter().map(|point| point.as_dvec3()).collect();
        let unbounded = filtered(&rod, &given, side);
        assert!(thinnest(&unbounded) < 0.3 * radius, "{}", thinnest(&unbounded));
    }

    #[test]
    fn clean_surfaces_and_boundaries_stay() {
        for example in [Example::Sphere, Example::Torus, Example::Plate, Example::Block] {
            let clean = surface(&example.generate(5_000));
            for side in [0.02, 0.1] {
                let fitted = clean.clone().fitted(&FeatureOptions { ridge: 180.0, ..FeatureOptions::default() }, side);
                assert!(fitted.denoised().is_none() && fitted.points == clean.points, "{example:?}, {side}");
            }
        }
        let profile: Vec<[f64; 2]> = (0..=40).map(|i| [0.1 * f64::from(i), 0.0]).collect();
        let mut soup = drawn_out(&profile, 40, 0.1);
        soup.points.iter_mut().enumerate().for_each(|(k, p)| p[2] += 0.06 * noise(k));
        let rough = surface(&soup);
        let points = smoothed(&rough, 0.5 / rough.frame().diagonal);
        let is_open = |h: &u32| rough.twin(*h).is_none();
        let mut rim = (0..3 * rough.triangle_count() as u32).filter(is_open).map(|h| rough.origin(h) as usize);
        assert!(rim.all(|v| points[v] == rough.points[v]));
        assert!((0..points.len()).any(|v| points[v] != rough.points[v]));
    }

    #[test]
    fn a_part_smaller_than_tiles_keeps_its_points_and_a_larger_one_does_not() {
        for (extent, is_kept) in [(0.1, true), (1.0, false)] {
            let mut soup = sphere(0.01);
            let first = soup.points.len() as u32;
            let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
            soup.points.extend(corners.map(|corner| corner.map(|x| 3.0 + extent * x)));
            let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
            soup.triangles.extend(faces.map(|face| face.map(|v| first + v)));
            let noisy = surface(&soup);
            let points = smoothed(&noisy, 0.4 / noisy.frame().diagonal);
            let is_same = (first as usize..points.len()).all(|v| points[v] == noisy.points[v]);
            assert_eq!(is_same, is_kept, "{extent}");
            assert!(points[..first as usize] != noisy.points[..first as usize]);
        }
    }

    #[test]
    fn the_number_of_threads_does_not_matter() {
        let noisy = surface(&sphere(0.01));
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            pool.install(|| smoothed(&noisy, 0.06))
        };
        assert_eq!(on(1), on(4));
    }
}
