//! Plane outlines: plates, and prisms with holes, bosses and pockets.

use super::super::builder::{Builder, Loop, circle, enclosed, filling, reversed};
use super::super::outlines;
use super::super::random::Random;
use glam::{DVec2, DVec3};

/// No points inside, so that triangles are as long as the outline, or a filling.
fn inside(loops: &[Loop], random: &mut Random) -> Vec<DVec2> {
    if random.chance(0.4) {
        return Vec::new();
    }
    let step = random.scale(0.03, 0.2);
    filling(loops, step, random)
}

fn with_holes(outline: Loop, count: usize, random: &mut Random) -> Vec<Loop> {
    let holes = outlines::holes(&outline, count, random);
    [vec![outline], holes].concat()
}

fn prism(loops: &[Loop], random: &mut Random) -> Builder {
    let mut builder = Builder::default();
    let inside = inside(loops, random);
    let [height, rows] = [random.scale(0.01, 4.0), random.whole(1, 8) as f64];
    builder.extruded(loops, &inside, [0.0, height], rows as usize);
    builder
}

pub fn gear(random: &mut Random) -> Builder {
    let outline = outlines::gear(random);
    let mut loops = vec![outline];
    if random.chance(0.6) {
        loops.push(circle(DVec2::ZERO, random.real(0.05, 0.3), random.whole(6, 48)));
    }
    prism(&loops, random)
}

pub fn flat(random: &mut Random) -> Builder {
    let outline = outlines::any(random);
    let count = random.whole(0, 5);
    let loops = with_holes(outline, count, random);
    let mut builder = Builder::default();
    let inside = inside(&loops, random);
    builder.flat(&loops, &inside, 0.0, true);
    builder
}

pub fn bent(random: &mut Random) -> Builder {
    let width = random.real(0.5, 2.0);
    let count = random.whole(0, 5);
    let loops = with_holes(outlines::rectangle(width, 1.0), count, random);
    let points = filling(&loops, random.scale(0.03, 0.1), random);
    let mut builder = Builder::default();
    builder.flat(&loops, &points, 0.0, true);
    // Rolled about the y axis to less than a full turn.
    let radius = width / random.real(0.3, 5.5);
    builder.mapped(|p| {
        let (s, c) = (p.x / radius).sin_cos();
        DVec3::new(radius * s, p.y, radius * (1.0 - c))
    })
}

pub fn thick(random: &mut Random) -> Builder {
    let outline = outlines::any(random);
    let count = random.whole(0, 5);
    let loops = with_holes(outline, count, random);
    prism(&loops, random)
}

pub fn profile(random: &mut Random) -> Builder {
    let outline = outlines::profile(random);
    prism(&[outline], random)
}

pub fn slits(random: &mut Random) -> Builder {
    let outline = if random.chance(0.7) { outlines::slit_plate(random) } else { outlines::open_ring(random) };
    if random.chance(0.5) {
        return prism(&[outline], random);
    }
    let mut builder = Builder::default();
    let loops = [outline];
    let inside = inside(&loops, random);
    builder.flat(&loops, &inside, 0.0, true);
    builder
}

/// A block with round bosses on it, round pockets in it and round holes through it.
pub fn bosses(random: &mut Random) -> Builder {
    let outline = outlines::rectangle(random.real(0.5, 2.0), 1.0);
    let thickness = random.real(0.1, 0.6);
    let count = random.whole(1, 6);
    let rims = outlines::holes(&outline, count, random);
    let mut builder = Builder::default();
    let [mut above, mut below] = [vec![outline.clone()], vec![outline.clone()]];
    for rim in rims {
        above.push(rim.clone());
        let rows = random.whole(1, 4);
        let within: Vec<DVec2> = if random.chance(0.5) { Vec::new() } else { centre_of(&rim) };
        match random.whole(0, 2) {
            0 => {
                let top = thickness + random.real(0.02, 0.8);
                builder.wall(&rim, [thickness, top], rows);
                builder.flat(&[rim], &within, top, true);
            }
            1 => {
                let floor = thickness * random.real(0.1, 0.9);
                builder.wall(&reversed(&rim), [floor, thickness], rows);
                builder.flat(&[rim], &within, floor, true);
            }
            _ => {
                builder.wall(&reversed(&rim), [0.0, thickness], rows);
                below.push(rim);
            }
        }
    }
    let rows = random.whole(1, 4);
    builder.wall(&outline, [0.0, thickness], rows);
    let [on, under] = [inside(&above, random), inside(&below, random)];
    builder.flat(&above, &on, thickness, true);
    builder.flat(&below, &under, 0.0, false);
    builder
}

fn centre_of(rim: &Loop) -> Vec<DVec2> {
    let centre = rim.iter().sum::<DVec2>() / rim.len() as f64;
    if enclosed(std::slice::from_ref(rim), centre) { vec![centre] } else { Vec::new() }
}

/// A box whose sides differ by a factor of up to 100.
pub fn long_box(random: &mut Random) -> Builder {
    let sides = [0, 1, 2].map(|_| random.scale(0.01, 1.0));
    let loops = [outlines::rectangle(sides[0], sides[1])];
    let mut builder = Builder::default();
    let points = if random.chance(0.5) { Vec::new() } else { filling(&loops, sides[0].min(sides[1]) / 3.0, random) };
    let rows = random.whole(1, 20);
    builder.extruded(&loops, &points, [0.0, sides[2]], rows);
    builder
}
