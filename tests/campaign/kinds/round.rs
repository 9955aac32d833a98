//! Turned surfaces, and tubes along curves.

use super::super::builder::Builder;
use super::super::random::Random;
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// The sides of a profile divided into parts of at most a length.
fn divided(profile: &[[f64; 2]], longest: f64) -> Vec<DVec2> {
    let points: Vec<DVec2> = profile.iter().map(|&p| p.into()).collect();
    let mut all = vec![points[0]];
    for pair in points.windows(2) {
        let parts = (pair[0].distance(pair[1]) / longest).ceil().max(1.0) as usize;
        all.extend((1..=parts).map(|i| pair[0].lerp(pair[1], i as f64 / parts as f64)));
    }
    all
}

fn turned(profile: &[DVec2], random: &mut Random) -> Builder {
    let mut builder = Builder::default();
    builder.turned(profile, random.whole(8, 64));
    builder
}

pub fn open_tube(random: &mut Random) -> Builder {
    let [low, high] = [random.real(0.2, 1.0), random.real(0.2, 1.0)];
    let profile = divided(&[[low, 0.0], [high, random.scale(0.1, 10.0)]], random.scale(0.05, 1.0));
    turned(&profile, random)
}

pub fn thick_tube(random: &mut Random) -> Builder {
    let inner = 1.0 - random.scale(0.01, 0.8);
    let height = random.scale(0.05, 5.0);
    let profile = [[inner, 0.0], [1.0, 0.0], [1.0, height], [inner, height], [inner, 0.0]];
    turned(&divided(&profile, random.scale(0.08, 1.0)), random)
}

/// A part of a spherical shell of some thickness with a rim.
pub fn bowl(random: &mut Random) -> Builder {
    let inner = 1.0 - random.scale(0.005, 0.4);
    let opening = random.real(0.2, 0.9) * PI;
    let steps = random.whole(6, 30);
    let arc = |radius: f64, i: usize| {
        let angle = opening * i as f64 / steps as f64;
        DVec2::new(if i == 0 { 0.0 } else { radius * angle.sin() }, -radius * angle.cos())
    };
    let profile: Vec<DVec2> =
        (0..=steps).map(|i| arc(1.0, i)).chain((0..=steps).rev().map(|i| arc(inner, i))).collect();
    turned(&profile, random)
}

pub fn needles(random: &mut Random) -> Builder {
    let height = random.scale(1.0, 20.0);
    let profile: &[[f64; 2]] = match random.whole(0, 3) {
        0 => &[[0.0, 0.0], [1.0, 0.0], [1.0, height], [0.0, height]],
        1 => &[[0.0, 0.0], [1.0, 0.0], [0.0, height]],
        2 => &[[0.0, -height], [1.0, 0.0], [0.0, height]],
        _ => &[[0.0, 0.0], [0.6, 0.0], [0.6, height / 2.0], [1.0, height / 2.0], [1.0, height], [0.0, height]],
    };
    let points: Vec<DVec2> = profile.iter().map(|&p| p.into()).collect();
    let mut builder = Builder::default();
    builder.turned(&points, random.whole(20, 200));
    builder
}

/// Cones, frusta, spindles and spikes, open or closed.
pub fn cone(random: &mut Random) -> Builder {
    let height = random.scale(0.2, 8.0);
    let power = random.scale(0.5, 3.0);
    let steps = random.whole(3, 30);
    let top = if random.chance(0.3) { random.real(0.02, 0.5) } else { 0.0 };
    let side = |i: usize| {
        let share = i as f64 / steps as f64;
        DVec2::new(top + (1.0 - top) * (1.0 - share).powf(power), height * share)
    };
    let mut profile: Vec<DVec2> = (0..=steps).map(side).collect();
    if random.chance(0.6) {
        profile.splice(0..0, divided(&[[0.0, 0.0], [1.0, 0.0]], 0.3).into_iter().filter(|p| p.x < 1.0));
    }
    turned(&profile, random)
}

pub fn vase(random: &mut Random) -> Builder {
    let height = random.real(0.5, 4.0);
    let waves = random.real(0.5, 4.0);
    let [depth, phase] = [random.real(0.0, 0.8), random.real(0.0, TAU)];
    let steps = random.whole(10, 60);
    let side = |i: usize| {
        let share = i as f64 / steps as f64;
        DVec2::new(0.5 + 0.5 * depth * (TAU * waves * share + phase).sin(), height * share)
    };
    let mut profile: Vec<DVec2> = (0..=steps).map(side).collect();
    if random.chance(0.6) {
        profile.insert(0, DVec2::ZERO);
    }
    if random.chance(0.6) {
        profile.push(DVec2::new(0.0, height));
    }
    turned(&profile, random)
}

/// A tube along a curve over 0 to 1; `side` is not along the curve. Ends that do not meet are closed by flat discs.
fn tube(
    curve: impl Fn(f64) -> DVec3,
    side: impl Fn(f64) -> DVec3,
    radius: impl Fn(f64) -> f64,
    [along, around]: [usize; 2],
) -> Builder {
    let place = |u: f64, v: f64| {
        let tangent = (curve(u + 1e-4) - curve(u - 1e-4)).normalize();
        let normal = side(u).reject_from(tangent).normalize();
        let (s, c) = (TAU * v).sin_cos();
        curve(u) + radius(u) * (normal * c - tangent.cross(normal) * s)
    };
    let mut builder = Builder::default();
    builder.grid([along, around], place);
    if curve(0.0).distance(curve(1.0)) > 1e-6 {
        for i in 0..around {
            let [v, w] = [i, i + 1].map(|k| k as f64 / around as f64);
            builder.triangle([curve(0.0), place(0.0, v), place(0.0, w)]);
            builder.triangle([curve(1.0), place(1.0, w), place(1.0, v)]);
        }
    }
    builder
}

pub fn torus(random: &mut Random) -> Builder {
    let radius = random.scale(0.03, 0.8);
    let [bulge, bulges] = [random.real(0.0, 0.4) * (1.0 - radius), random.whole(1, 6) as f64];
    let counts = [random.whole(20, 80), random.whole(6, 30)];
    tube(
        |u| DVec3::new((TAU * u).cos(), (TAU * u).sin(), 0.0),
        |u| DVec3::new((TAU * u).cos(), (TAU * u).sin(), 0.0),
        |u| radius * (1.0 + bulge * (TAU * bulges * u).sin()),
        counts,
    )
}

pub fn torus_knot(random: &mut Random) -> Builder {
    let [p, q] = random.pick(&[[2.0, 3.0], [3.0, 2.0], [2.0, 5.0], [3.0, 4.0], [1.0, 3.0], [2.0, 1.0]]);
    let radius = random.real(0.03, 0.1);
    let across = move |u: f64| {
        let ((s, c), (height, out)) = ((TAU * p * u).sin_cos(), (TAU * q * u).sin_cos());
        DVec3::new(c * out, s * out, height)
    };
    let ring = move |u: f64| DVec3::new((TAU * p * u).cos(), (TAU * p * u).sin(), 0.0);
    let counts = [random.whole(100, 240), random.whole(6, 16)];
    tube(move |u| ring(u) + 0.45 * across(u), across, |_| radius, counts)
}

pub fn spring(random: &mut Random) -> Builder {
    let turns = random.real(0.7, 5.0);
    let pitch = random.real(0.25, 1.0);
    let radius = pitch * random.real(0.1, 0.35);
    let counts = [(random.real(16.0, 40.0) * turns) as usize + 4, random.whole(6, 20)];
    let out = move |u: f64| DVec3::new((TAU * turns * u).cos(), (TAU * turns * u).sin(), 0.0);
    tube(move |u| out(u) + DVec3::Z * (pitch * turns * u), out, |_| radius, counts)
}

/// A rod that is straight or bent to an arc, of a constant or a varying radius.
pub fn rod(random: &mut Random) -> Builder {
    let radius = random.scale(0.005, 0.1);
    let bend = if random.chance(0.5) { 0.01 } else { random.real(0.2, 5.0) };
    let waves = if random.chance(0.5) { 0.0 } else { random.real(0.1, 0.6) };
    let counts = [random.whole(1, 60).max(if bend > 0.1 { 20 } else { 1 }), random.whole(5, 24)];
    tube(
        |u| DVec3::new((bend * u).sin(), 0.0, 1.0 - (bend * u).cos()) / bend,
        |_| DVec3::Y,
        |u| radius * (1.0 + waves * (TAU * 3.0 * u).sin()),
        counts,
    )
}
