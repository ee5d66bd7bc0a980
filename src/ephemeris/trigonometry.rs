//! Sine, cosine and arctangent without a branch or a call, so that a loop over them runs in vector registers.

use std::f64::consts::{FRAC_1_PI, FRAC_PI_2, FRAC_PI_4, PI};

/// The cosine, without a branch or a call, so that a loop over terms runs in vector registers.
///
/// Within 1e-12 of the standard library's for phases below 6e6, which is what series of 1e-9 radians need.
#[inline(always)]
pub(super) fn cosine(x: f64) -> f64 {
    let [cosine] = cosines([x]);
    cosine
}

/// The same of several phases side by side, where no loop is long enough to be made so by the compiler.
#[inline(always)]
pub(super) fn cosines<const N: usize>(x: [f64; N]) -> [f64; N] {
    // pi in two parts of 32 bits: their products with a whole number below 2^21 are exact, and the rest is 4e-21.
    const PI_HIGH: f64 = f64::from_bits(0x4009_21fb_5440_0000);
    const PI_LOW: f64 = f64::from_bits(0x3de0_b461_1a60_0000);
    // 1.5 * 2^52: a number added to it is rounded to a whole one, which is then in the lowest bits.
    const ROUND: f64 = 6_755_399_441_055_744.0;
    // Taylor's series to r^16, good to 6e-13 at pi/2.
    const TAYLOR: [f64; 8] = [
        -1.0 / 87_178_291_200.0,
        1.0 / 479_001_600.0,
        -1.0 / 3_628_800.0,
        1.0 / 40_320.0,
        -1.0 / 720.0,
        1.0 / 24.0,
        -1.0 / 2.0,
        1.0,
    ];
    let (mut shifted, mut squares) = ([0.0; N], [0.0; N]);
    for i in 0..N {
        shifted[i] = x[i] * FRAC_1_PI + ROUND;
        let k = shifted[i] - ROUND;
        let r = (x[i] - k * PI_HIGH) - k * PI_LOW;
        squares[i] = r * r;
    }
    let mut series = [1.0 / 20_922_789_888_000.0; N];
    for term in TAYLOR {
        for i in 0..N {
            series[i] = series[i] * squares[i] + term;
        }
    }
    // Minus for odd k.
    std::array::from_fn(|i| f64::from_bits(series[i].to_bits() ^ (shifted[i].to_bits() << 63)))
}

/// Sines and cosines by [`cosine`], of several angles at once: the sine is the cosine a quarter turn back.
#[inline]
pub(super) fn sin_cos<const N: usize>(angles: [f64; N]) -> [(f64, f64); N] {
    let back = angles.map(|x| x - FRAC_PI_2);
    let (mut sines, mut cosines) = ([0.0; N], [0.0; N]);
    for i in 0..N {
        sines[i] = cosine(back[i]);
        cosines[i] = cosine(angles[i]);
    }
    std::array::from_fn(|i| (sines[i], cosines[i]))
}

/// The angle of the vector (x, y) from the x axis [rad], in [-pi, pi], as [`f64::atan2`] gives it except for the signs of
/// zeros; some finite angle where both are zero.
///
/// Within 1e-13 of the standard library's: the arctangent's odd polynomial, of a ratio below tan(pi/8).
#[inline(always)]
pub(super) fn arctangent(y: f64, x: f64) -> f64 {
    const TAN_PI_8: f64 = 0.414_213_562_373_095_03;
    let (height, width) = (y.abs(), x.abs());
    let (less, more) = if height > width {
        (width, height)
    } else {
        (height, width)
    };
    // atan(q) = pi/4 + atan((q - 1) / (q + 1)); the division is the one of either form.
    let (over, under, start) = if less > TAN_PI_8 * more {
        (less - more, less + more, FRAC_PI_4)
    } else {
        (less, more, 0.0)
    };
    let r = over / if under > 0.0 { under } else { 1.0 };
    let q = r * r;
    // The best polynomial in q from 0 to tan^2(pi/8), good to 3e-14.
    let series = 0.999_999_999_999_973_2
        + q * (-0.333_333_333_308_015_8
            + q * (0.199_999_996_046_397_04
                + q * (-0.142_856_904_109_692_62
                    + q * (0.111_103_847_260_942_07
                        + q * (-0.090_783_877_779_207_31
                            + q * (0.075_636_717_936_058_89
                                + q * (-0.058_743_839_156_979_755
                                    + q * 0.030_660_553_362_531_068)))))));
    let acute = start + r * series;
    let right = if height > width {
        FRAC_PI_2 - acute
    } else {
        acute
    };
    let upper = if x < 0.0 { PI - right } else { right };
    if y < 0.0 { -upper } else { upper }
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

    #[test]
    fn the_arctangent_is_the_arctangent() {
        for i in 0..400_000 {
            let angle = (f64::from(i) - 200_000.5) * (PI / 200_001.0);
            for length in [1e-150, 1.0, 3e7] {
                let (sin, cos) = angle.sin_cos();
                let (y, x) = (length * sin, length * cos);
                let error = arctangent(y, x) - y.atan2(x);
                assert!(error.abs() < 1e-13, "{angle}: {error}");
            }
        }
        for (y, x) in [
            (0.0, 1.0),
            (1.0, 0.0),
            (-1.0, 0.0),
            (0.0, -1.0),
            (1.0, -1.0),
        ] {
            assert!((arctangent(y, x) - f64::atan2(y, x)).abs() < 1e-15);
        }
        assert!(arctangent(0.0, 0.0).is_finite());
    }
}
