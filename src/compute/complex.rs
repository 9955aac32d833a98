//! Complex numbers in single precision.

/// A complex number: real part, imaginary part.
pub type Complex = [f32; 2];

/// Values of a smaller modulus have no direction.
pub const NEGLIGIBLE: f32 = 1e-18;

pub(crate) fn modulus_squared(z: Complex) -> f32 {
    z[0] * z[0] + z[1] * z[1]
}

pub(crate) fn modulus(z: Complex) -> f32 {
    modulus_squared(z).sqrt()
}

pub(crate) fn add(a: Complex, b: Complex) -> Complex {
    [a[0] + b[0], a[1] + b[1]]
}

pub(crate) fn scaled(z: Complex, factor: f32) -> Complex {
    z.map(|x| x * factor)
}

pub(crate) fn conjugate(z: Complex) -> Complex {
    [z[0], -z[1]]
}

/// Divided by its modulus; negligible values stay.
pub(crate) fn normalised(z: Complex) -> Complex {
    let length = modulus(z);
    if length > NEGLIGIBLE { [z[0] / length, z[1] / length] } else { z }
}
