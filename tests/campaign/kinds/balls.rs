//! Balls, smooth, noisy and spiked, and crystals.

use super::super::builder::Builder;
use super::super::random::Random;
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// A ball of radius 1: six grids, or a turned half circle.
fn ball(random: &mut Random) -> Builder {
    let mut builder = Builder::default();
    if random.chance(0.5) {
        let steps = random.whole(6, 40);
        let side = |i: usize| {
            let (s, c) = (PI * i as f64 / steps as f64).sin_cos();
            DVec2::new(if i == 0 || i == steps { 0.0 } else { s }, -c)
        };
        builder.turned(&(0..=steps).map(side).collect::<Vec<_>>(), 2 * steps);
        return builder.welded();
    }
    let steps = random.whole(3, 25);
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            builder.grid([steps; 2], |u, v| {
                let [u, v] = if side > 0.0 { [u, v] } else { [v, u] };
                let mut place = DVec3::splat(side);
                place[(axis + 1) % 3] = ((2.0 * u - 1.0) * PI / 4.0).tan();
                place[(axis + 2) % 3] = ((2.0 * v - 1.0) * PI / 4.0).tan();
                place.normalize()
            });
        }
    }
    builder.welded()
}

fn stretched(builder: Builder, random: &mut Random) -> Builder {
    let stretch = if random.chance(0.5) { DVec3::ONE } else { DVec3::from([0; 3].map(|_| random.scale(0.1, 1.0))) };
    builder.mapped(|p| p * stretch)
}

/// A ball with waves, and with noise at each point.
pub fn noisy_sphere(random: &mut Random) -> Builder {
    let waves: Vec<(DVec3, f64)> = (0..random.whole(0, 6))
        .map(|_| (DVec3::from([0; 3].map(|_| random.real(-8.0, 8.0))), random.real(0.0, 0.12)))
        .collect();
    let noise = if random.chance(0.5) { 0.0 } else { random.scale(1e-4, 0.1) };
    let mut ball = ball(random);
    for p in &mut ball.points {
        let wave: f64 = waves.iter().map(|(k, height)| height * k.dot(*p).sin()).sum();
        *p *= 1.0 + wave + noise * random.real(-1.0, 1.0);
    }
    stretched(ball, random)
}

pub fn spiked_ball(random: &mut Random) -> Builder {
    let spikes: Vec<DVec3> = (0..random.whole(1, 12)).map(|_| direction(random)).collect();
    let [length, width] = [random.real(0.2, 2.0), random.real(0.1, 0.5)];
    let ball = ball(random).mapped(|p| {
        let nearest = spikes.iter().map(|spike| spike.distance(p)).fold(f64::MAX, f64::min);
        p * (1.0 + length * (1.0 - nearest / width).max(0.0))
    });
    stretched(ball, random)
}

pub fn nested_spheres(random: &mut Random) -> Builder {
    let mut all = Builder::default();
    let mut radius = 1.0;
    for _ in 0..random.whole(2, 3) {
        all.add(&ball(random).mapped(|p| p * radius), DVec3::ZERO);
        radius *= random.real(0.3, 0.9);
    }
    all
}

fn direction(random: &mut Random) -> DVec3 {
    let z: f64 = random.real(-1.0, 1.0);
    let (s, c) = random.real(0.0, TAU).sin_cos();
    let r = (1.0 - z * z).sqrt();
    DVec3::new(r * c, r * s, z)
}

/// The convex hull of points on an ellipsoid.
pub fn crystal(random: &mut Random) -> Builder {
    let mut points: Vec<DVec3> = vec![direction(random)];
    let wanted = random.whole(4, 26);
    for _ in 0..20 * wanted {
        let next = direction(random);
        if points.len() < wanted && points.iter().all(|p| p.distance(next) > 0.1) {
            points.push(next);
        }
    }
    let mut builder = Builder::default();
    let count = points.len();
    for (i, j, k) in (0..count).flat_map(|i| (0..i).flat_map(move |j| (0..j).map(move |k| (i, j, k)))) {
        let [a, b, c] = [points[i], points[j], points[k]];
        let normal = (b - a).cross(c - a);
        let outside = |sign: f64| {
            let others = points.iter().enumerate().filter(|(l, _)| ![i, j, k].contains(l));
            others.map(|(_, p)| sign * normal.dot(p - a)).all(|height| height < 0.0)
        };
        if outside(1.0) {
            builder.triangle([a, b, c]);
        } else if outside(-1.0) {
            builder.triangle([a, c, b]);
        }
    }
    stretched(builder, random)
}
