//! The sRGB transfer function (IEC 61966-2-1).

/// Encoded value [1] of a linear one; 0 to 1 maps to 0 to 1, negative values are mirrored.
pub fn srgb_encode(linear: f64) -> f64 {
    let v = linear.abs();
    let encoded = if v <= 0.003_130_8 {
        12.92 * v
    } else {
        1.055 * v.powf(1.0 / 2.4) - 0.055
    };
    encoded.copysign(linear)
}

/// Linear value [1] of an encoded one: the inverse of [`srgb_encode`] to 1e-7 (the standard's two pieces meet no better).
pub fn srgb_decode(encoded: f64) -> f64 {
    let v = encoded.abs();
    let linear = if v <= 0.040_45 {
        v / 12.92
    } else {
        ((v + 0.055) / 1.055).powf(2.4)
    };
    linear.copysign(encoded)
}
