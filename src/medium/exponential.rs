//! Integrals of exponentials that keep their digits where the usual forms divide nearly nothing by nearly nothing.

use glam::DVec3;
use std::f64::consts::PI;

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

/// Gauss-Legendre quadrature of any number of points on [-1, 1]: each place and its weight.
pub fn gauss_nodes(count: u32) -> Vec<[f64; 2]> {
    let n = f64::from(count);
    let node = |i: u32| {
        // Newton's iteration for the zeros of the Legendre polynomial, from a start that is close to each (Abramowitz & Stegun 22.16.6).
        let mut x = (PI * (f64::from(i) + 0.75) / (n + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..20 {
            let (mut before, mut value) = (1.0, x);
            for k in 2..=count {
                let k = f64::from(k);
                (before, value) = (
                    value,
                    ((2.0 * k - 1.0) * x * value - (k - 1.0) * before) / k,
                );
            }
            slope = n * (x * value - before) / (x * x - 1.0);
            let step = value / slope;
            x -= step;
            if step.abs() < 1e-15 {
                break;
            }
        }
        [x, 2.0 / ((1.0 - x * x) * slope * slope)]
    };
    match count {
        0 | 1 => vec![[0.0, 2.0]],
        _ => (0..count).map(node).collect(),
    }
}

/// Eight-point Gauss-Legendre quadrature of a function over [a, b].
pub(super) fn gauss(a: f64, b: f64, f: &impl Fn(f64) -> DVec3) -> DVec3 {
    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
    NODES
        .iter()
        .map(|[x, w]| *w * (f(middle - half * x) + f(middle + half * x)))
        .sum::<DVec3>()
        * half
}

/// Nodes of Kronrod's fifteen points that go with Gauss' seven, and the weights of both (Kronrod 1965; Piessens et al. 1983): by pairs
/// around the middle, which comes last.
const KRONROD: [[f64; 3]; 8] = [
    [0.991_455_371_120_812_6, 0.022_935_322_010_529_224, 0.0],
    [
        0.949_107_912_342_758_5,
        0.063_092_092_629_978_56,
        0.129_484_966_168_869_7,
    ],
    [0.864_864_423_359_769_1, 0.104_790_010_322_250_18, 0.0],
    [
        0.741_531_185_599_394_4,
        0.140_653_259_715_525_92,
        0.279_705_391_489_276_7,
    ],
    [0.586_087_235_467_691_1, 0.169_004_726_639_267_9, 0.0],
    [
        0.405_845_151_377_397_2,
        0.190_350_578_064_785_4,
        0.381_830_050_505_118_9,
    ],
    [0.207_784_955_007_898_47, 0.204_432_940_075_298_89, 0.0],
    [0.0, 0.209_482_141_084_727_82, 0.417_959_183_673_469_4],
];

/// The integral of a function over [a, b] by fifteen points, and how far that by seven of them is from it.
pub(super) fn kronrod(a: f64, b: f64, f: &impl Fn(f64) -> DVec3) -> (DVec3, f64) {
    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
    let (mut fine, mut coarse) = (DVec3::ZERO, DVec3::ZERO);
    for [x, by_fifteen, by_seven] in KRONROD {
        let values = match x {
            0.0 => f(middle),
            x => f(middle - half * x) + f(middle + half * x),
        };
        fine += by_fifteen * values;
        coarse += by_seven * values;
    }
    (half * fine, (half * (fine - coarse)).abs().max_element())
}
