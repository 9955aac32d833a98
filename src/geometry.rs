//! Vector arithmetic in the exact order of operations that the WGSL kernels use.
//!
//! `glam`'s `normalize` multiplies by a reciprocal, which differs from WGSL's in the last bit; these do not.

use glam::{IVec3, Vec3};

/// `a · b`, summed left to right.
#[inline]
pub(crate) fn dot(a: Vec3, b: Vec3) -> f32 {
    a.x * b.x + a.y * b.y + a.z * b.z
}

/// `a × b`.
#[inline]
pub(crate) fn cross(a: Vec3, b: Vec3) -> Vec3 {
    Vec3::new(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)
}

/// `a / |a|`; the zero vector stays zero.
#[inline]
pub(crate) fn unit(a: Vec3) -> Vec3 {
    let length = dot(a, a).sqrt();
    if length > 0.0 { a / length } else { a }
}

/// The half of a plane angle: `(cos t, sin t)` to `(cos t/2, sin t/2)`, with the result in the right half plane.
#[inline]
fn half_angle(c: f32, s: f32) -> (f32, f32) {
    if c >= 0.0 {
        let x = ((1.0 + c) * 0.5).sqrt();
        (x, s / (2.0 * x))
    } else {
        let y = ((1.0 - c) * 0.5).sqrt();
        let x = s.abs() / (2.0 * y);
        (x, if s < 0.0 { -y } else { y })
    }
}

/// The unit normal of a triangle.
pub(crate) fn triangle_normal([a, b, c]: [Vec3; 3]) -> Vec3 {
    unit(cross(b - a, c - a))
}

/// One of the four directions of a cross from its representation `z = (cos 4t, sin 4t)`: `(cos t, sin t)`.
///
/// No trigonometry, so that the kernels can do the same bit for bit. A `z` of length zero gives direction `(1, 0)`.
#[inline]
pub(crate) fn fourth_root(z: [f32; 2]) -> (f32, f32) {
    let length = (z[0] * z[0] + z[1] * z[1]).sqrt();
    if length > 0.0 {
        let (c, s) = half_angle(z[0] / length, z[1] / length);
        half_angle(c, s)
    } else {
        (1.0, 0.0)
    }
}

/// How far a point of a triangle is towards its second and third corner: its barycentric coordinates there, from 0 to 1.
pub(crate) fn barycentric([a, b, c]: [Vec3; 3], position: Vec3) -> [f32; 2] {
    let double_area = cross(b - a, c - a);
    let normal = unit(double_area);
    let total = dot(double_area, normal);
    let to_b = (-dot(cross(c - a, position - a), normal) / total).clamp(0.0, 1.0);
    let to_c = (dot(cross(b - a, position - a), normal) / total).clamp(0.0, 1.0);
    [to_b, to_c]
}

/// One direction of the cross at a point of a triangle with these barycentric coordinates at its second and third corner;
/// `z` are the crosses at its corners, against its first edge.
pub(crate) fn axis_at([a, b, c]: [Vec3; 3], z: [[f32; 2]; 3], [wb, wc]: [f32; 2]) -> Vec3 {
    let normal = triangle_normal([a, b, c]);
    let wa = (1.0 - wb - wc).max(0.0);
    let blend = [z[0][0] * wa + z[1][0] * wb + z[2][0] * wc, z[0][1] * wa + z[1][1] * wb + z[2][1] * wc];
    let (x, y) = fourth_root(blend);
    let first = unit(b - a);
    first * x + cross(normal, first) * y
}

/// A number from 0 to 1 that looks random in `number` (SplitMix64's finalizer).
pub(crate) fn scattered(number: u64) -> f32 {
    let mut x = number.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^= x >> 31;
    (x >> 40) as f32 / (1u64 << 24) as f32
}

/// A cell of a grid and the 26 that touch it, itself first.
pub(crate) fn cells_around(cell: IVec3) -> impl Iterator<Item = IVec3> {
    let offset = |k: i32| IVec3::new(k / 9 - 1, k / 3 % 3 - 1, k % 3 - 1);
    (0..27).map(move |k| cell + offset((k + 13) % 27))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fourth_root_inverts_the_fourth_power() {
        for degree in -44..=44 {
            let t = (degree as f32).to_radians();
            let (c, s) = fourth_root([(4.0 * t).cos(), (4.0 * t).sin()]);
            assert!((c - t.cos()).abs() < 1e-5 && (s - t.sin()).abs() < 1e-5, "{degree} degrees: {c} {s}");
        }
        assert_eq!(fourth_root([0.0, 0.0]), (1.0, 0.0));
    }
}
