//! Surfaces whose sheets meet, made of patches that do not know of each other: welding finds what they share.

use crate::common::surfaces::example;
use quadmosaic::surface::Soup;
use std::f64::consts::TAU;

/// A surface whose sheets meet.
pub struct Shape {
    pub name: &'static str,
    pub soup: Soup,
    /// What its mesh is to be like: the soup itself, but where it has two walls at one place.
    pub meant: Soup,
    /// How far chords of round seams may be from the seam, as a share of its length.
    pub roundness: f64,
}

pub fn all() -> Vec<Shape> {
    let like = |name, soup: Soup, roundness| Shape { name, meant: soup.clone(), soup, roundness };
    let straight = |name, soup| like(name, soup, 0.0);
    vec![
        straight("three pages at a spine", book(&[0.0, 100.0, 220.0])),
        straight("four pages at a spine", book(&[0.0, 80.0, 170.0, 260.0])),
        straight("pages at a part of their edges", part_of_a_spine()),
        straight("a plate standing across a plate", standing([0.0, 1.0])),
        straight("a plate standing within a plate", standing([0.25, 0.75])),
        straight("a plate standing from a plate's side to its middle", standing([0.0, 0.5])),
        straight("two plates that cross", crossing()),
        straight("two boxes at one edge", boxes_at_an_edge()),
        straight("two boxes at one wall", boxes_at_a_wall()),
        Shape {
            meant: boxes_at_a_wall(),
            ..straight("two boxes at one wall given twice", boxes_at_a_wall_given_twice())
        },
        Shape { meant: boxes_with_walls(0.1), ..straight("two boxes at two walls", boxes_with_walls(0.0)) },
        straight("eight cells of a box", cells()),
        straight("two tetrahedra at one corner", tetrahedra()),
        straight("two spheres at one point", spheres()),
        straight("a pyramid's tip on a plate", tip_on_a_plate()),
        like("a disc in a tube", disc_in_a_tube(), 0.02),
        like("a disc in a sphere", disc_in_a_sphere(), 0.02),
    ]
}

/// Adds a parallelogram of `m` by `n` cells; `other` takes their other diagonals.
fn patch(soup: &mut Soup, origin: [f64; 3], [u, v]: [[f64; 3]; 2], [m, n]: [usize; 2], other: bool) {
    let first = soup.points.len() as u32;
    let at = |i: usize, j: usize| first + (j * (m + 1) + i) as u32;
    let place = |i: usize, j: usize, k: usize| origin[k] + u[k] * i as f64 / m as f64 + v[k] * j as f64 / n as f64;
    for j in 0..=n {
        soup.points.extend((0..=m).map(|i| [0, 1, 2].map(|k| place(i, j, k))));
    }
    for (i, j) in (0..n).flat_map(|j| (0..m).map(move |i| (i, j))) {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        soup.triangles.extend(if other { [[a, b, d], [b, c, d]] } else { [[a, b, c], [a, c, d]] });
    }
}

/// Origin, sides and numbers of cells of a patch.
type Patch = ([f64; 3], [[f64; 3]; 2], [usize; 2]);

fn of(patches: &[Patch]) -> Soup {
    let mut soup = Soup::default();
    patches.iter().for_each(|&(origin, sides, cells)| patch(&mut soup, origin, sides, cells, false));
    soup
}

/// Pages of 1 by 1.2 that leave the z axis at these angles, in degrees.
pub fn book(angles: &[f64]) -> Soup {
    let page = |&angle: &f64| {
        let (s, c) = angle.to_radians().sin_cos();
        ([0.0; 3], [[c, s, 0.0], [0.0, 0.0, 1.2]], [9, 11])
    };
    of(&angles.iter().map(page).collect::<Vec<_>>())
}

fn part_of_a_spine() -> Soup {
    let mut soup = book(&[0.0, 180.0]);
    patch(&mut soup, [0.0; 3], [[0.0, 1.0, 0.0], [0.0, 0.0, 1.2 * 6.0 / 11.0]], [9, 6], false);
    patch(&mut soup, [0.0, 0.0, 1.2 * 6.0 / 11.0], [[0.0, 1.0, 0.8], [0.0, 0.0, 1.2 * 5.0 / 11.0]], [9, 5], false);
    soup
}

/// A plate of 2 by 1, and one on its middle line over this part of it.
fn standing([from, to]: [f64; 2]) -> Soup {
    let rows = (12.0 * (to - from)) as usize;
    of(&[
        ([-1.0, 0.0, 0.0], [[2.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [20, 12]),
        ([0.0, from, 0.0], [[0.3, 0.0, 0.7], [0.0, to - from, 0.0]], [6, rows]),
    ])
}

fn crossing() -> Soup {
    of(&[
        ([-1.0, 0.0, 0.0], [[2.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [20, 12]),
        ([-0.2, 0.0, -0.6], [[0.4, 0.0, 1.2], [0.0, 1.0, 0.0]], [12, 12]),
    ])
}

/// The walls of a box of `m` cells along each axis, outward; `without` leaves out those at the low (0) or high (1) end of x.
fn walls(soup: &mut Soup, low: [f64; 3], size: [f64; 3], m: usize, without: Option<usize>) {
    for axis in 0..3 {
        let [u, v] = [(axis + 1) % 3, (axis + 2) % 3].map(|k| [0, 1, 2].map(|i| if i == k { size[k] } else { 0.0 }));
        let mut far = low;
        far[axis] += size[axis];
        for (end, origin, sides) in [(0, low, [v, u]), (1, far, [u, v])] {
            if axis != 0 || without != Some(end) {
                patch(soup, origin, sides, [m, m], false);
            }
        }
    }
}

fn boxes_at_an_edge() -> Soup {
    let mut soup = Soup::default();
    walls(&mut soup, [0.0; 3], [1.0; 3], 6, None);
    walls(&mut soup, [1.0, 1.0, 0.0], [1.2, 0.8, 1.0], 6, None);
    soup
}

pub fn boxes_at_a_wall() -> Soup {
    let mut soup = Soup::default();
    walls(&mut soup, [0.0; 3], [1.0; 3], 6, None);
    walls(&mut soup, [1.0, 0.0, 0.0], [1.2, 1.0, 1.0], 6, Some(0));
    soup
}

fn boxes_at_a_wall_given_twice() -> Soup {
    let mut soup = Soup::default();
    walls(&mut soup, [0.0; 3], [1.0; 3], 6, None);
    walls(&mut soup, [1.0, 0.0, 0.0], [1.2, 1.0, 1.0], 6, None);
    soup
}

/// The second box has a wall of its own with other diagonals, which bulges inward by `bulge`.
fn boxes_with_walls(bulge: f64) -> Soup {
    let mut soup = boxes_at_a_wall();
    let begun = soup.points.len();
    patch(&mut soup, [1.0, 0.0, 0.0], [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0]], [6, 6], true);
    for p in &mut soup.points[begun..] {
        p[0] += bulge * p[1] * (1.0 - p[1]) * p[2] * (1.0 - p[2]);
    }
    soup
}

/// A box cut in eight, each inner wall there once.
fn cells() -> Soup {
    let mut soup = Soup::default();
    for at in 0..3 {
        for axis in 0..3 {
            let [u, v] = [(axis + 1) % 3, (axis + 2) % 3].map(|k| [0, 1, 2].map(|i| if i == k { 2.0 } else { 0.0 }));
            let origin = [0, 1, 2].map(|k| if k == axis { f64::from(at) } else { 0.0 });
            patch(&mut soup, origin, [u, v], [8, 8], false);
        }
    }
    soup
}

fn tetrahedra() -> Soup {
    let mut soup = Soup::default();
    for sign in [1.0, -1.0] {
        let first = soup.points.len() as u32;
        soup.points.extend([[0.0, 0.0, 0.0], [sign, 0.0, 0.0], [0.0, sign, 0.0], [0.0, 0.0, sign]]);
        let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        soup.triangles.extend(faces.map(|t: [u32; 3]| t.map(|v| v + first)));
    }
    soup
}

fn spheres() -> Soup {
    let mut soup = example("sphere", 1_000);
    let pole = soup.points.iter().copied().fold([0.0, 0.0, f64::MIN], |a, b| if b[2] > a[2] { b } else { a });
    let count = soup.points.len() as u32;
    let other: Vec<_> = soup.points.iter().map(|p| [0, 1, 2].map(|k| 2.0 * pole[k] - p[k])).collect();
    soup.points.extend(other);
    let other: Vec<_> = soup.triangles.iter().map(|t| t.map(|v| v + count)).collect();
    soup.triangles.extend(other);
    soup
}

fn tip_on_a_plate() -> Soup {
    let mut soup = of(&[([-1.0, -1.0, 0.0], [[2.0, 0.0, 0.0], [0.0, 2.0, 0.0]], [12, 12])]);
    let first = soup.points.len() as u32;
    soup.points.extend([[0.0, 0.0, 0.0], [0.8, 0.0, 1.0], [0.0, 0.8, 1.0], [-0.8, 0.0, 1.0], [0.0, -0.8, 1.0]]);
    let faces = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1], [1, 3, 2], [1, 4, 3]];
    soup.triangles.extend(faces.map(|t: [u32; 3]| t.map(|v| v + first)));
    soup
}

/// Adds rings of points, each a radius and a height, and the bands between them; a ring of radius 0 is a point.
fn turned(soup: &mut Soup, rings: &[[f64; 2]]) {
    const AROUND: u32 = 36;
    let first = soup.points.len() as u32;
    for &[radius, z] in rings {
        let angles = (0..AROUND).map(|i| TAU * f64::from(i) / f64::from(AROUND));
        soup.points.extend(angles.map(|angle| [radius * angle.cos(), radius * angle.sin(), z]));
    }
    for (j, pair) in (0..).zip(rings.windows(2)) {
        for i in 0..AROUND {
            let at = |i: u32, j: u32| first + j * AROUND + i % AROUND;
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            if pair[0][0] > 0.0 {
                soup.triangles.push([a, b, c]);
            }
            if pair[1][0] > 0.0 {
                soup.triangles.push([a, c, d]);
            }
        }
    }
}

fn disc(soup: &mut Soup, z: f64) {
    turned(soup, &[0.0, 0.2, 0.4, 0.6, 0.8, 1.0].map(|radius| [radius, z]));
}

pub fn disc_in_a_tube() -> Soup {
    let mut soup = Soup::default();
    turned(&mut soup, &(0..=12).map(|j| [1.0, f64::from(j) / 6.0]).collect::<Vec<_>>());
    disc(&mut soup, 5.0 / 6.0);
    soup
}

fn disc_in_a_sphere() -> Soup {
    let mut soup = Soup::default();
    let ring = |j: i32| {
        let (s, c) = (TAU * f64::from(j) / 36.0).sin_cos();
        [if j.abs() == 9 { 0.0 } else { c }, s]
    };
    turned(&mut soup, &(-9..=9).map(ring).collect::<Vec<_>>());
    disc(&mut soup, 0.0);
    soup
}
