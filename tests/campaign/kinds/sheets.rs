//! Sheets over a plane, ruled sheets, wings, and sheets that meet.

use super::super::builder::Builder;
use super::super::random::Random;
use glam::DVec3;
use std::f64::consts::TAU;

/// A sum of plane waves.
fn waves(random: &mut Random) -> impl Fn(f64, f64) -> f64 + use<> {
    let waves: Vec<[f64; 4]> = (0..random.whole(1, 5))
        .map(|_| {
            let frequency = random.scale(0.5, 12.0);
            let (s, c) = random.real(0.0, TAU).sin_cos();
            [frequency * c, frequency * s, random.real(0.0, TAU), random.real(0.0, 0.8) / (1.0 + frequency)]
        })
        .collect();
    move |x, y| waves.iter().map(|[a, b, phase, height]| height * (a * x + b * y + phase).sin()).sum()
}

fn counts(random: &mut Random) -> [usize; 2] {
    [random.whole(4, 50), random.whole(4, 50)]
}

pub fn height_field(random: &mut Random) -> Builder {
    let height = waves(random);
    let width = random.scale(0.1, 2.0);
    let noise = if random.chance(0.6) { 0.0 } else { random.scale(1e-4, 0.01) };
    let mut builder = Builder::default();
    builder.grid(counts(random), |u, v| DVec3::new(u * width, v, height(u * width, v)));
    let mut field = builder.welded();
    field.points.iter_mut().for_each(|p| p.z += noise * random.real(-1.0, 1.0));
    field
}

/// A height field of steps whose risers are steep.
pub fn terraces(random: &mut Random) -> Builder {
    let [steps, rise, sharpness] = [random.whole(1, 5) as f64, random.real(0.05, 0.5), random.scale(5.0, 60.0)];
    let tilt = random.real(-0.5, 0.5);
    let mut builder = Builder::default();
    let columns = random.whole(20, 80);
    builder.grid([columns, random.whole(8, 40)], |u, v| {
        let t = steps * (u + tilt * (v - 0.5));
        let share = t - t.floor() - 0.5;
        DVec3::new(u, v, rise * (t.floor() + 0.5 + 0.5 * (sharpness * share).tanh() / (sharpness * 0.5).tanh()))
    });
    builder
}

/// A height field of a thickness, with walls round it.
pub fn thin_shell(random: &mut Random) -> Builder {
    let height = waves(random);
    let thickness = random.scale(0.003, 0.2);
    let [m, n] = counts(random);
    let place = |u: f64, v: f64, w: f64| DVec3::new(u, v, height(u, v) + thickness * w);
    let mut builder = Builder::default();
    builder.grid([m, n], |u, v| place(u, v, 1.0));
    builder.grid([n, m], |u, v| place(v, u, 0.0));
    builder.grid([m, 1], |u, v| place(u, 0.0, v));
    builder.grid([1, m], |u, v| place(v, 1.0, u));
    builder.grid([1, n], |u, v| place(0.0, v, u));
    builder.grid([n, 1], |u, v| place(1.0, u, v));
    builder
}

/// Helicoids, hyperboloids, hyperbolic paraboloids, and strips that are closed after full turns.
pub fn ruled_strip(random: &mut Random) -> Builder {
    let [m, n] = [random.whole(16, 100), random.whole(2, 12)];
    let turns = random.real(0.2, 2.0);
    let [inner, pitch] = [random.real(0.0, 0.7), random.real(0.3, 2.0)];
    let twists = random.whole(0, 2) as f64;
    let mut builder = Builder::default();
    match random.whole(0, 3) {
        0 => builder.grid([m, n], |u, v| {
            let (s, c) = (TAU * turns * u).sin_cos();
            let r = (inner - 0.5) * (1.0 - v) + v;
            DVec3::new(r * c, r * s, pitch * turns * u)
        }),
        1 => builder.grid([m, n], |u, v| {
            let end = |angle: f64, z: f64| DVec3::new((TAU * angle).cos(), (TAU * angle).sin(), z);
            end(u, 0.0).lerp(end(u + 0.35 * inner, pitch), v)
        }),
        2 => builder.grid([m, n], |u, v| DVec3::new(u, v, pitch * (2.0 * u - 1.0) * (2.0 * v - 1.0))),
        _ => builder.grid([m, n], |u, v| {
            let (around, tilt) = (TAU * u, TAU * twists * u);
            let side = 0.1 + 0.5 * inner;
            let r = 1.0 + side * (v - 0.5) * tilt.cos();
            DVec3::new(r * around.cos(), r * around.sin(), side * (v - 0.5) * tilt.sin())
        }),
    }
    builder
}

/// A tapered wing with a sharp trailing edge and a flat tip; the root is open or flat.
pub fn wing(random: &mut Random) -> Builder {
    let [thickness, taper, sweep] = [random.scale(0.02, 0.3), random.real(0.15, 1.0), random.real(-0.3, 0.8)];
    let [span, twist] = [random.real(0.5, 5.0), random.real(-0.4, 0.4)];
    let around = 2 * random.whole(8, 40);
    let place = |u: f64, z: f64| {
        let x = (1.0 + (TAU * u).cos()) / 2.0;
        let half = 0.2969 * x.sqrt() - 0.126 * x - 0.3516 * x.powi(2) + 0.2843 * x.powi(3) - 0.1036 * x.powi(4);
        let y = 5.0 * thickness * half * if u > 0.5 { -1.0 } else { 1.0 };
        let chord = 1.0 - (1.0 - taper) * z;
        let (s, c) = (twist * z).sin_cos();
        DVec3::new(chord * (x * c - y * s) + sweep * z, chord * (x * s + y * c), span * z)
    };
    let mut builder = Builder::default();
    builder.grid([around, random.whole(3, 40)], place);
    let mut cap = |z: f64| {
        for i in 0..around / 2 {
            let corners = [i, i + 1, around - i - 1, around - i].map(|k| place(k as f64 / around as f64, z));
            builder.quad(if z > 0.0 { corners } else { [corners[3], corners[2], corners[1], corners[0]] }, false);
        }
    };
    cap(1.0);
    if random.chance(0.5) {
        cap(0.0);
    }
    builder
}

/// Pages at a spine.
pub fn book(random: &mut Random) -> Builder {
    let pages = random.whole(3, 6);
    let rows = random.whole(4, 20);
    let height = random.real(0.3, 3.0);
    let mut builder = Builder::default();
    for i in 0..pages {
        let angle = TAU * (i as f64 + random.real(-0.3, 0.3)) / pages as f64;
        let [width, bend] = [random.real(0.3, 1.2), random.real(-0.15, 0.15)];
        let columns = random.whole(3, 14);
        builder.grid([columns, rows], |u, v| {
            let (s, c) = (angle + bend * u).sin_cos();
            DVec3::new(width * u * c, width * u * s, height * v)
        });
    }
    builder
}

/// A tube with walls across it.
pub fn tube_with_walls(random: &mut Random) -> Builder {
    let around = random.whole(10, 40);
    let rows = random.whole(4, 20);
    let height = random.scale(0.5, 6.0);
    let rings = random.whole(1, 6);
    let level = |j: usize| height * j as f64 / rows as f64;
    let mut builder = Builder::default();
    builder.turned(&(0..=rows).map(|j| [1.0, level(j)].into()).collect::<Vec<_>>(), around);
    for _ in 0..random.whole(1, 3) {
        let z = level(random.whole(0, rows - 1));
        let disc: Vec<_> = (0..=rings).map(|i| [i as f64 / rings as f64, z].into()).collect();
        let mut with_disc = Builder::default();
        with_disc.turned(&disc, around);
        if !builder.points.iter().any(|p| p.z == z && p.truncate().length() < 1e-9) {
            builder.add(&with_disc, DVec3::ZERO);
        }
    }
    builder
}
