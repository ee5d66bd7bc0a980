//! Sums of periodic terms, of which every tier above `minute` is made.

use std::f64::consts::FRAC_1_PI;

/// Amplitude, phase [rad] and rate [rad per unit of time].
pub(super) type Term = [f64; 3];

/// The polynomial in `t` whose coefficients are sums of a cos(b + c t).
///
/// The phases may reach 3e6 radians; each cosine is good to 2e-12 (of phases known to 1e-10 then).
pub(super) fn periodic(powers: &[&[Term]], t: f64) -> f64 {
    powers.iter().rev().fold(0.0, |sum, terms| {
        sum * t
            + terms
                .iter()
                .map(|[a, b, c]| a * cosine(b + c * t))
                .sum::<f64>()
    })
}

/// The cosine, without a branch or a call, so that a loop over terms runs in vector registers.
///
/// Within 1e-12 of the standard library's for phases below 6e6, which is what series of 1e-9 radians need.
#[inline]
fn cosine(x: f64) -> f64 {
    // pi in two parts of 32 bits: their products with a whole number below 2^21 are exact, and the rest is 4e-21.
    const PI_HIGH: f64 = f64::from_bits(0x4009_21fb_5440_0000);
    const PI_LOW: f64 = f64::from_bits(0x3de0_b461_1a60_0000);
    // 1.5 * 2^52: a number added to it is rounded to a whole one, which then stands in the lowest bits.
    const ROUND: f64 = 6_755_399_441_055_744.0;
    let shifted = x * FRAC_1_PI + ROUND;
    let k = shifted - ROUND;
    let r = (x - k * PI_HIGH) - k * PI_LOW;
    // Taylor's series to r^16, good to 6e-13 at pi/2; minus for odd k.
    let q = r * r;
    let series = 1.0
        + q * (-1.0 / 2.0
            + q * (1.0 / 24.0
                + q * (-1.0 / 720.0
                    + q * (1.0 / 40_320.0
                        + q * (-1.0 / 3_628_800.0
                            + q * (1.0 / 479_001_600.0
                                + q * (-1.0 / 87_178_291_200.0 + q / 20_922_789_888_000.0)))))));
    f64::from_bits(series.to_bits() ^ (shifted.to_bits() << 63))
}

/// Sines and cosines by [`cosine`], of several angles at once: the sine is the cosine a quarter turn back.
#[inline]
pub(super) fn sin_cos<const N: usize>(angles: [f64; N]) -> [(f64, f64); N] {
    let back = angles.map(|x| x - std::f64::consts::FRAC_PI_2);
    let (mut sines, mut cosines) = ([0.0; N], [0.0; N]);
    for i in 0..N {
        sines[i] = cosine(back[i]);
        cosines[i] = cosine(angles[i]);
    }
    std::array::from_fn(|i| (sines[i], cosines[i]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cosine_is_the_cosine() {
        let mut worst = 0.0_f64;
        for i in -2_000_000..2_000_000 {
            // Steps that meet no multiple of pi, out to 6e6.
            let x = f64::from(i) * 2.999_123;
            worst = worst
                .max((cosine(x) - x.cos()).abs())
                .max((sin_cos([x])[0].0 - x.sin()).abs());
        }
        // The argument itself, and x minus a quarter turn, are rounded at 6e6 to 9e-10 / 2^...: 5e-10 at most.
        assert!(worst < 1e-9, "{worst}");
        for i in -4000..4000 {
            let x = f64::from(i) * 0.01;
            assert!((cosine(x) - x.cos()).abs() < 1e-12);
        }
    }
}
