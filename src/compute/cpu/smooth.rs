//! The equations of one level: residuals and Jacobi sweeps.
//!
//! # Practice
//! Sums are written term by term, `s + a * b - c * d`: lavapipe (Mesa 22.3.6) takes `s + (a * b - c * d)` apart in just that
//! way, and would give other bits than Rust. `s + a * b + c * -d` has the same bits; with it both parts of a number are
//! computed at once.

use crate::compute::{Complex, Level, MIRRORED, target};

/// A value, conjugate where a link is mirrored: no branch, as which it is changes from link to link.
#[inline]
fn read([x, y]: Complex, neighbour: u32) -> Complex {
    [x, f32::from_bits(y.to_bits() ^ (neighbour & MIRRORED))]
}

/// What is left of `wanted` once a row's part of the values is taken off; nothing on a fixed one.
#[inline]
pub(crate) fn remainder(wanted: Complex, level: &Level, values: &[Complex], i: usize) -> Complex {
    let diagonal = level.rows[i].diagonal;
    if diagonal == 0.0 {
        return [0.0, 0.0];
    }
    let z = values[i];
    let [mut x, mut y] = [wanted[0] - diagonal * z[0], wanted[1] - diagonal * z[1]];
    for link in level.links_of(i) {
        let (w, z) = (link.weight, read(values[link.index()], link.neighbour));
        x = x + w[0] * z[0] + w[1] * -z[1];
        y = y + w[0] * z[1] + w[1] * z[0];
    }
    [x, y]
}

/// A row of the matrix times the values.
pub(crate) fn applied(level: &Level, values: &[Complex], i: usize) -> Complex {
    let [x, y] = remainder([0.0, 0.0], level, values, i);
    [-x, -y]
}

/// The residual of values that mass terms draw to themselves.
pub(crate) fn residual(level: &Level, values: &[Complex], i: usize) -> Complex {
    let (b, mass) = (level.right_hand_side[i], level.rows[i].mass);
    let z = target(values[i]);
    remainder([b[0] + mass * z[0], b[1] + mass * z[1]], level, values, i)
}

/// A value moved by `step` times its residual over the diagonal.
pub(crate) fn stepped(z: Complex, level: &Level, residual: Complex, i: usize, step: f32) -> Complex {
    let diagonal = level.rows[i].diagonal;
    if diagonal == 0.0 {
        return z;
    }
    let factor = step / diagonal;
    [z[0] + factor * residual[0], z[1] + factor * residual[1]]
}
