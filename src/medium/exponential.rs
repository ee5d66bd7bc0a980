//! Integrals of exponentials that keep their digits where the usual forms divide nearly nothing by nearly nothing.

use glam::DVec3;

/// (1 - e^-x) / x for any x, 1 at 0; stable near 0.
pub fn phi1(x: f64) -> f64 {
    if x.abs() < 1e-8 {
        1.0 - 0.5 * x
    } else {
        -(-x).exp_m1() / x
    }
}

/// source e^-depth, and 0 where nothing gets through however strong (or infinite) the source.
pub(super) fn attenuated(source: DVec3, depth: DVec3) -> DVec3 {
    let channel = |i: usize| match (-depth[i]).exp() {
        0.0 => 0.0,
        transmittance => source[i] * transmittance,
    };
    DVec3::new(channel(0), channel(1), channel(2))
}

/// The integral of exp(-(start + slope t)) over t from 0 to `length`, whatever the slope's sign.
pub(super) fn exponential_integral(start: f64, slope: f64, length: f64) -> f64 {
    let change = slope * length;
    if change >= 0.0 {
        (-start).exp() * length * phi1(change)
    } else {
        (-(start + change)).exp() * length * phi1(-change)
    }
}

/// Eight-point Gauss-Legendre quadrature on [-1, 1]: each place, which is one of two at both sides of 0, and its weight.
pub(super) const NODES: [[f64; 2]; 4] = [
    [0.183_434_642_495_649_8, 0.362_683_783_378_362],
    [0.525_532_409_916_329, 0.313_706_645_877_887_3],
    [0.796_666_477_413_626_7, 0.222_381_034_453_374_48],
    [0.960_289_856_497_536_3, 0.101_228_536_290_376_26],
];

/// Eight-point Gauss-Legendre quadrature of a function over [a, b].
pub(super) fn gauss(a: f64, b: f64, f: &impl Fn(f64) -> DVec3) -> DVec3 {
    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
    NODES
        .iter()
        .map(|[x, w]| *w * (f(middle - half * x) + f(middle + half * x)))
        .sum::<DVec3>()
        * half
}
