//! Values carried between a level and the next coarser one.

use crate::compute::{Complex, Level};

/// The sum of what an aggregate's members have, in the aggregate's frame.
pub(super) fn gathered(level: &Level, aggregate: usize, value: impl Fn(usize) -> Complex) -> Complex {
    let [mut x, mut y] = [0.0, 0.0];
    for &i in level.members_of(aggregate) {
        let r = value(i as usize);
        // The parent's link reads the aggregate's value in the member's frame; its adjoint leads back.
        let parent = level.parents[i as usize];
        let t = parent.weight;
        x = x + t[0] * r[0] + t[1] * r[1];
        let r = if parent.is_mirrored() { [-r[0], -r[1]] } else { r };
        y = y + t[0] * r[1] - t[1] * r[0];
    }
    [x, y]
}

/// A value plus that of its aggregate, read in its frame.
pub(super) fn interpolated(z: Complex, level: &Level, coarse: &[Complex], i: usize) -> Complex {
    let parent = level.parents[i];
    let (t, c) = (parent.weight, coarse[parent.index()]);
    let c = [c[0], if parent.is_mirrored() { -c[1] } else { c[1] }];
    [z[0] + t[0] * c[0] - t[1] * c[1], z[1] + t[0] * c[1] + t[1] * c[0]]
}
