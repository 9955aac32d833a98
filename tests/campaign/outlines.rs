//! Plane outlines: profiles, gears, stars, notched and rounded plates, and holes in them.

use super::builder::{Loop, circle, distance, enclosed};
use super::random::Random;
use glam::DVec2;
use std::f64::consts::TAU;

fn corners(points: &[[f64; 2]]) -> Loop {
    points.iter().map(|&p| p.into()).collect()
}

pub fn rectangle(width: f64, height: f64) -> Loop {
    corners(&[[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]])
}

/// An L, T, U, I or cross whose arms are `t` thick.
pub fn profile(random: &mut Random) -> Loop {
    let t = random.scale(0.04, 0.3);
    let [w, h] = [random.real(0.7, 1.3), random.real(0.7, 1.3)];
    let [m, n] = [(w - t) / 2.0, (h - t) / 2.0];
    match random.whole(0, 4) {
        0 => corners(&[[0.0, 0.0], [w, 0.0], [w, t], [t, t], [t, h], [0.0, h]]),
        1 => corners(&[[m, 0.0], [m + t, 0.0], [m + t, h - t], [w, h - t], [w, h], [0.0, h], [0.0, h - t], [m, h - t]]),
        2 => corners(&[[0.0, 0.0], [w, 0.0], [w, h], [w - t, h], [w - t, t], [t, t], [t, h], [0.0, h]]),
        3 => corners(&[
            [0.0, 0.0],
            [w, 0.0],
            [w, t],
            [m + t, t],
            [m + t, h - t],
            [w, h - t],
            [w, h],
            [0.0, h],
            [0.0, h - t],
            [m, h - t],
            [m, t],
            [0.0, t],
        ]),
        _ => corners(&[
            [m, 0.0],
            [m + t, 0.0],
            [m + t, n],
            [w, n],
            [w, n + t],
            [m + t, n + t],
            [m + t, h],
            [m, h],
            [m, n + t],
            [0.0, n + t],
            [0.0, n],
            [m, n],
        ]),
    }
}

/// A gear of trapezoid teeth about the origin, its tips at radius 1.
pub fn gear(random: &mut Random) -> Loop {
    let teeth = random.whole(5, 40);
    let root = 1.0 - random.real(0.5, 2.5) / teeth as f64;
    let tooth = [(0.0, root), (0.35, root), (0.5, 1.0), (0.85, 1.0)];
    let at =
        |(i, (share, radius)): (usize, (f64, f64))| radius * DVec2::from_angle(TAU * (i as f64 + share) / teeth as f64);
    (0..teeth).flat_map(|i| tooth.map(|place| (i, place))).map(at).collect()
}

/// A star of spikes about the origin, its tips at radius 1.
pub fn star(random: &mut Random) -> Loop {
    let spikes = random.whole(3, 12);
    let inner = random.real(0.2, 0.8);
    (0..2 * spikes).map(|i| [1.0, inner][i % 2] * DVec2::from_angle(TAU * i as f64 / (2 * spikes) as f64)).collect()
}

/// A plate with slits from its boundary.
pub fn slit_plate(random: &mut Random) -> Loop {
    let count = random.whole(1, 5);
    let width = random.scale(0.002, 0.08);
    let depth = random.real(0.2, 0.9);
    let mut slit = vec![DVec2::ZERO, DVec2::new(1.0, 0.0), DVec2::new(1.0, 1.0)];
    for i in (1..=count).rev() {
        let x = i as f64 / (count + 1) as f64 + random.real(-0.02, 0.02);
        let half = width / 2.0;
        slit.extend(corners(&[
            [x + half, 1.0],
            [x + half * 0.9, 1.0 - depth],
            [x - half * 0.9, 1.0 - depth],
            [x - half, 1.0],
        ]));
    }
    slit.push(DVec2::new(0.0, 1.0));
    slit
}

/// A ring of 1 and an inner radius that is nearly closed.
pub fn open_ring(random: &mut Random) -> Loop {
    let inner = random.real(0.3, 0.9);
    let angle = TAU * random.real(0.5, 0.99);
    let steps = random.whole(12, 60);
    let arc = |i: usize| DVec2::from_angle(angle * i as f64 / steps as f64);
    (0..=steps).map(arc).chain((0..=steps).rev().map(|i| inner * arc(i))).collect()
}

pub fn rounded(width: f64, height: f64, radius: f64, steps: usize) -> Loop {
    let centres = [[width, height], [0.0, height], [0.0, 0.0], [width, 0.0]];
    let inward = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    (0..4)
        .flat_map(|k| {
            let centre = DVec2::from(centres[k]) + radius * DVec2::from(inward[k]);
            (0..=steps)
                .map(move |i| centre + radius * DVec2::from_angle(TAU / 4.0 * (k as f64 + i as f64 / steps as f64)))
        })
        .collect()
}

/// An outline of any of these.
pub fn any(random: &mut Random) -> Loop {
    match random.whole(0, 6) {
        0 => profile(random),
        1 => gear(random),
        2 => star(random),
        3 => slit_plate(random),
        4 => open_ring(random),
        5 => circle(DVec2::ZERO, 1.0, random.whole(3, 80)),
        _ => rounded(random.real(0.3, 1.0), 1.0, random.real(0.02, 0.14), random.whole(1, 8)),
    }
}

/// Up to `count` round holes within an outline, apart from it and from each other.
pub fn holes(outline: &Loop, count: usize, random: &mut Random) -> Vec<Loop> {
    let low = outline.iter().copied().reduce(DVec2::min).unwrap_or_default();
    let high = outline.iter().copied().reduce(DVec2::max).unwrap_or_default();
    let mut found: Vec<(DVec2, f64)> = Vec::new();
    for _ in 0..40 * count {
        let centre = DVec2::new(random.real(low.x, high.x), random.real(low.y, high.y));
        let radius = (high - low).min_element() * random.scale(0.02, 0.3);
        let rim = circle(centre, radius * 1.25, 24);
        let inside = rim.iter().all(|p| enclosed(std::slice::from_ref(outline), *p))
            && outline.iter().all(|p| p.distance(centre) > radius * 1.25)
            && distance(centre, outline) > radius * 1.2;
        if inside && found.iter().all(|(c, r)| c.distance(centre) > 1.2 * (r + radius)) && found.len() < count {
            found.push((centre, radius));
        }
    }
    found.into_iter().map(|(centre, radius)| circle(centre, radius, random.whole(3, 40))).collect()
}
