//! Surfaces of cells of a grid: blocks of any genus, the same rounded, boxes with round edges, and rooms.

use super::super::builder::Builder;
use super::super::random::Random;
use glam::{DVec3, IVec3};
use std::collections::{BTreeMap, BTreeSet};

const AXES: [IVec3; 3] = [IVec3::X, IVec3::Y, IVec3::Z];

/// Cells that grow from one, where faces meet only at edges of two faces and at vertices of one fan.
fn grown(random: &mut Random) -> BTreeSet<[i32; 3]> {
    let extent = random.whole(1, 4) as i32;
    let wanted = random.whole(2, 30);
    let mut cells = BTreeSet::from([[0; 3]]);
    for _ in 0..12 * wanted {
        let from: IVec3 = random.pick(&cells.iter().copied().collect::<Vec<_>>()).into();
        let next = from + random.pick(&AXES) * random.pick(&[-1, 1]);
        if next.abs().max_element() <= extent && cells.insert(next.to_array()) && !is_manifold_about(&cells, next) {
            cells.remove(&next.to_array());
        }
        if cells.len() >= wanted {
            break;
        }
    }
    cells
}

/// Whether at each vertex of a cell the full cells are connected through walls, and the empty ones too.
fn is_manifold_about(cells: &BTreeSet<[i32; 3]>, cell: IVec3) -> bool {
    let corners = (0..8).map(|k| cell + IVec3::new(k & 1, k >> 1 & 1, k >> 2));
    corners.into_iter().all(|corner| {
        let full = |k: i32| cells.contains(&(corner - IVec3::new(k & 1, k >> 1 & 1, k >> 2)).to_array());
        [true, false].into_iter().all(|state| {
            let alike: Vec<i32> = (0..8).filter(|&k| full(k) == state).collect();
            let Some(&first) = alike.first() else { return true };
            let mut reached = BTreeSet::from([first]);
            let mut queue = vec![first];
            while let Some(k) = queue.pop() {
                queue.extend([k ^ 1, k ^ 2, k ^ 4].into_iter().filter(|&n| full(n) == state && reached.insert(n)));
            }
            reached.len() == alike.len()
        })
    })
}

/// The walls of cells, each of `m` by `m` quads, in the coordinates of the grid.
fn walls(cells: &BTreeSet<[i32; 3]>, m: usize) -> Builder {
    let mut builder = Builder::default();
    for cell in cells.iter().map(|&cell| IVec3::from(cell)) {
        for (axis, side) in (0..3).flat_map(|axis| [(axis, 0), (axis, 1)]) {
            let normal = AXES[axis] * (2 * side - 1);
            if cells.contains(&(cell + normal).to_array()) {
                continue;
            }
            let [u, v] = [AXES[(axis + 1) % 3], AXES[(axis + 2) % 3]].map(|a| a.as_dvec3());
            let [u, v] = if side == 1 { [u, v] } else { [v, u] };
            let origin = (cell + AXES[axis] * side).as_dvec3();
            builder.grid([m, m], |s, t| origin + u * s + v * t);
        }
    }
    builder
}

/// A map of the grid's coordinates to planes at random distances, along each axis.
fn spaced(random: &mut Random) -> impl Fn(DVec3) -> DVec3 {
    let planes = [0; 3].map(|_| {
        let mut at = 0.0;
        let mut step = || {
            at += random.scale(0.15, 1.5);
            at
        };
        (0..12).map(|_| step()).collect::<Vec<f64>>()
    });
    move |p| {
        let along = |x: f64, planes: &[f64]| {
            let low = ((x + 5.0).floor() as usize).min(planes.len() - 2);
            let share = x + 5.0 - low as f64;
            planes[low] * (1.0 - share) + planes[low + 1] * share
        };
        DVec3::new(along(p.x, &planes[0]), along(p.y, &planes[1]), along(p.z, &planes[2]))
    }
}

pub fn blocks(random: &mut Random) -> Builder {
    let cells = grown(random);
    let m = random.whole(1, 4);
    walls(&cells, m).mapped(spaced(random))
}

/// Blocks whose points move to the mean of their neighbours, a few times.
pub fn rounded_blocks(random: &mut Random) -> Builder {
    let cells = grown(random);
    let mut surface = walls(&cells, random.whole(2, 5)).welded();
    for _ in 0..random.whole(1, 8) {
        let mut sums: BTreeMap<u32, (DVec3, f64)> = BTreeMap::new();
        for &[a, b, c] in &surface.triangles {
            for (v, w) in [(a, b), (b, c), (c, a)] {
                let sum = sums.entry(v).or_default();
                *sum = (sum.0 + surface.points[w as usize], sum.1 + 1.0);
            }
        }
        for (v, (sum, count)) in sums {
            let point = &mut surface.points[v as usize];
            *point = *point * 0.5 + sum / count * 0.5;
        }
    }
    surface
}

/// A floor, and walls that stand on lines of its grid over its whole width; they cross each other.
pub fn floor_and_walls(random: &mut Random) -> Builder {
    let mut builder = Builder::default();
    let [m, n] = [0; 2].map(|_| random.whole(4, 14));
    let height = random.whole(2, 8);
    let step = random.real(0.05, 0.2);
    let depth = if random.chance(0.3) { height } else { 0 };
    let [m_, n_, low, high] = [m as f64, n as f64, -(depth as f64), height as f64];
    builder.grid([m, n], |u, v| step * DVec3::new(u * m_, v * n_, 0.0));
    for _ in 0..random.whole(1, 2) {
        let x = random.whole(1, m - 1) as f64;
        builder.grid([n, height + depth], |u, v| step * DVec3::new(x, u * n_, low + v * (high - low)));
    }
    if random.chance(0.5) {
        let y = random.whole(1, n - 1) as f64;
        builder.grid([m, height + depth], |u, v| step * DVec3::new(u * m_, y, low + v * (high - low)));
    }
    // Two walls at one place are one.
    let mut surface = builder.welded();
    let mut seen = BTreeSet::new();
    surface.triangles.retain(|t| {
        let mut sorted = *t;
        sorted.sort_unstable();
        seen.insert(sorted)
    });
    surface
}

/// A box all of whose edges are rounded with one radius.
pub fn rounded_box(random: &mut Random) -> Builder {
    let half = DVec3::from([0; 3].map(|_| random.scale(0.05, 1.0)));
    let radius = half.min_element() * random.scale(0.02, 0.9);
    let [arc, straight] = [random.whole(1, 5), random.whole(1, 6)];
    let steps = 2 * arc + straight;
    // A coordinate of the grid, from -1 to 1, as one of the inner box and an angle beyond it.
    let split = |x: f64, inner: f64| {
        let k = (x + 1.0) / 2.0 * steps as f64;
        let beyond =
            if k < arc as f64 { k / arc as f64 - 1.0 } else { ((k - (arc + straight) as f64) / arc as f64).max(0.0) };
        let within = ((k - arc as f64) / straight as f64).clamp(0.0, 1.0) * 2.0 - 1.0;
        (within * inner, (beyond * std::f64::consts::FRAC_PI_4).tan())
    };
    let inner = half - radius;
    let mut builder = Builder::default();
    for (axis, side) in (0..3).flat_map(|axis| [(axis, -1.0), (axis, 1.0)]) {
        let [i, j] = [(axis + 1) % 3, (axis + 2) % 3];
        builder.grid([steps, steps], |u, v| {
            let [u, v] = if side > 0.0 { [u, v] } else { [v, u] };
            let [(x, s), (y, t)] = [split(2.0 * u - 1.0, inner[i]), split(2.0 * v - 1.0, inner[j])];
            let mut place = DVec3::ZERO;
            let mut normal = DVec3::ZERO;
            (place[axis], place[i], place[j]) = (side * inner[axis], x, y);
            (normal[axis], normal[i], normal[j]) = (side, s, t);
            place + radius * normal.normalize()
        });
    }
    builder
}
