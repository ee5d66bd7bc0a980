//! Tier `arcsecond`: VSOP87, light time, long-term precession, nutation IAU 2000B.
//!
//! Direction within 0.2 arcseconds from 1900 to 2100 (0.1 measured against IAU 2000A and ERFA's epv00) and within
//! 10 arcseconds from -2000 to 6000, of which most is the extrapolated nutation and the rotation of the earth; what delta-T does
//! not know comes on top. Polar motion is left out (0.5 arcseconds at most), as are the bending of light and TDB - TT.
//!
//! Source: Bretagnon & Francou 1988 (906 terms of version B); Vondrak, Capitaine & Wallace 2011 (Astronomy and
//! Astrophysics 534, A22, tables 1 and 2); McCarthy & Luzum 2003 (IAU 2000B); Capitaine, Guinot & McCarthy 2000 (the
//! earth rotation angle).

use std::f64::consts::TAU;

use super::julian::{CENTURY, Julian};
use super::place::Place;
use super::series::periodic;
use super::spa;
use super::trigonometry::sin_cos;
use super::vsop87::{B, L, R};
use crate::units::ARCSEC;

/// Light time over one astronomical unit [days] (IAU 2012).
const LIGHT_TIME: f64 = 0.005775518331;

/// The sun's geocentric apparent place at a terrestrial time.
pub(super) fn place(tt: Julian) -> Place {
    let t = tt.centuries();
    // The earth as it stood when the light left the sun: this holds light time and aberration together, to second
    // order in the earth's speed (0.001 arcseconds). The distance is known from an ellipse to 1e-4.
    let mean_anomaly = (357.529 + 35999.050 * t).to_radians();
    let rough = 1.0001 - 0.0167 * mean_anomaly.cos();
    let emitted = (t - rough * LIGHT_TIME / CENTURY) / 10.0;
    let (sin_l, cos_l) = periodic(&L, emitted).sin_cos();
    let (sin_b, cos_b) = periodic(&B, emitted).sin_cos();
    // The distance is the one now: what the ellipse adds to it while the light travels.
    let distance_au = periodic(&R, emitted) + 0.0167 * mean_anomaly.sin() * 0.0172 * LIGHT_TIME;
    // The earth's from the sun, seen backwards, in the dynamical ecliptic of J2000.0.
    let (x, y, z) = (-cos_b * cos_l, -cos_b * sin_l, -sin_b);
    // To the mean equator and equinox of J2000.0: the rotation that comes with VSOP87.
    let j2000 = [
        x + 0.000000440360 * y - 0.000000190919 * z,
        -0.000000479966 * x + 0.917482137087 * y - 0.397776982902 * z,
        0.397776982902 * y + 0.917482137087 * z,
    ];

    let (equator, ecliptic) = (equator_pole(t), ecliptic_pole(t));
    let node = cross(equator, ecliptic);
    let sin_obliquity = dot(node, node).sqrt();
    let equinox = node.map(|c| c / sin_obliquity);
    let obliquity = sin_obliquity.atan2(dot(equator, ecliptic));
    // Ecliptic coordinates of date, to which the nutation is added.
    let summer = cross(ecliptic, equinox);
    let (x, y, z) = (
        dot(j2000, equinox),
        dot(j2000, summer),
        dot(j2000, ecliptic),
    );
    let (d_psi, d_eps, node_longitude) = nutation(t);
    let true_obliquity = obliquity + d_eps;
    // The two largest complementary terms of the equation of the equinoxes (IERS Conventions 2010, 5.31).
    let complementary =
        (0.00264096 * node_longitude.sin() + 0.00006352 * (2.0 * node_longitude).sin()) * ARCSEC;
    Place::from_ecliptic(
        y.atan2(x) + d_psi,
        z.atan2(x.hypot(y)),
        true_obliquity,
        distance_au,
        d_psi * obliquity.cos() + complementary,
        spa::mean_longitude(t / 10.0),
    )
}

/// The mean sidereal time at Greenwich [rad], of the part of the day and the days since J2000.0 (UT, then TT).
///
/// Differs: IAU 2006 gives its precession in right ascension as a polynomial that is made for some centuries. This one
/// is the integral of the same quantity along the long-term precession: equal to 5 mas from 1900 to 2100, 4 arcseconds
/// away in year -2000 and 11 in 6000.
#[inline(always)]
pub(super) fn sidereal_time(fraction: f64, ut_days: f64, tt_days: f64) -> f64 {
    const PRECESSION: [f64; 10] = [
        0.014506,
        4612.16471758,
        1.39135267396,
        3.24689501186e-5,
        -2.84792942663e-5,
        1.91266406993e-8,
        3.38724173806e-11,
        -2.86057087306e-12,
        7.77027359523e-15,
        1.19451841024e-16,
    ];
    let t = tt_days * (1.0 / CENTURY);
    // ERA = 2 pi (0.779... + 1.0027... days): whole turns are left out before they cost digits.
    let rotation = TAU * (0.7790572732640 + (fraction - 0.5) + 0.00273781191135448 * ut_days);
    rotation + PRECESSION.iter().rev().fold(0.0, |sum, c| sum * t + c) * ARCSEC
}

/// The pole of the ecliptic on the axes of J2000.0 (Vondrak et al. 2011, table 1).
fn ecliptic_pole(t: f64) -> [f64; 3] {
    #[rustfmt::skip]
    const PERIODIC: [[f64; 5]; 8] = [
        [ 708.15, -5486.751211, -684.661560,   667.666730, -5523.863691],
        [2309.00,   -17.127623, 2446.283880, -2354.886252,  -549.747450],
        [1620.00,  -617.517403,  399.671049,  -428.152441,  -310.998056],
        [ 492.20,   413.442940, -356.652376,   376.202861,   421.535876],
        [1183.00,    78.614193, -186.387003,   184.778874,   -36.776172],
        [ 622.00,  -180.732815, -316.800070,   335.321713,  -145.278396],
        [ 882.00,   -87.676083,  198.296701,  -185.138669,   -34.744450],
        [ 547.00,    46.140315,  101.135679,  -120.972830,    22.885731],
    ];
    let (p, q) = long_term(
        t,
        &PERIODIC,
        [5851.607687, -0.1189000, -0.00028913, 0.000000101],
        [-1600.886300, 1.1689818, -0.00000020, -0.000000437],
    );
    let w = (1.0 - p * p - q * q).sqrt();
    let (sin, cos) = (84381.406 * ARCSEC).sin_cos();
    [p, -q * cos - w * sin, -q * sin + w * cos]
}

/// The pole of the mean equator on the axes of J2000.0 (Vondrak et al. 2011, table 2).
fn equator_pole(t: f64) -> [f64; 3] {
    #[rustfmt::skip]
    const PERIODIC: [[f64; 5]; 14] = [
        [ 256.75,  -819.940624, 75004.344875, 81491.287984,  1558.515853],
        [ 708.15, -8444.676815,    624.033993,    787.163481,  7774.939698],
        [ 274.20,  2600.009459,   1251.136893,   1251.296102, -2219.534038],
        [ 241.45,  2755.175630,  -1102.212834,  -1257.950837, -2523.969396],
        [2309.00,  -167.659835,  -2660.664980,  -2966.799730,   247.850422],
        [ 492.20,   871.855056,    699.291817,    639.744522,  -846.485643],
        [ 396.10,    44.769698,    153.167220,    131.600209, -1393.124055],
        [ 288.90,  -512.313065,   -950.865637,   -445.040117,   368.526116],
        [ 231.10,  -819.415595,    499.754645,    584.522874,   749.045012],
        [1610.00,  -538.071099,   -145.188210,    -89.756563,   444.704518],
        [ 620.00,  -189.793622,    558.116553,    524.429630,   235.934465],
        [ 157.87,  -402.922932,    -23.923029,    -13.549067,   374.049623],
        [ 220.30,   179.516345,   -165.405086,   -210.157124,  -171.330180],
        [1200.00,    -9.814756,      9.344131,    -44.919798,   -22.899655],
    ];
    let (x, y) = long_term(
        t,
        &PERIODIC,
        [5453.282155, 0.4252841, -0.00037173, -0.000000152],
        [-73750.930350, -0.7675452, -0.00018725, 0.000000231],
    );
    [x, y, (1.0 - x * x - y * y).sqrt()]
}

/// Two series of period [centuries], cosine and cosine, sine and sine amplitudes ["], and their polynomials [rad].
fn long_term(t: f64, periodic: &[[f64; 5]], first: [f64; 4], second: [f64; 4]) -> (f64, f64) {
    let polynomial = |c: [f64; 4]| c[0] + t * (c[1] + t * (c[2] + t * c[3]));
    let sums = periodic.iter().fold(
        (polynomial(first), polynomial(second)),
        |(p, q), [period, c1, c2, s1, s2]| {
            let (sin, cos) = (TAU * t / period).sin_cos();
            (p + cos * c1 + sin * s1, q + cos * c2 + sin * s2)
        },
    );
    (sums.0 * ARCSEC, sums.1 * ARCSEC)
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Nutation in longitude and obliquity, and the longitude of the moon's node [rad] (IAU 2000B).
fn nutation(t: f64) -> (f64, f64, f64) {
    let argument = |at_j2000: f64, rate: f64| ((at_j2000 + rate * t) % 1296000.0) * ARCSEC;
    let arguments = [
        argument(485868.249036, 1717915923.2178),
        argument(1287104.79305, 129596581.0481),
        argument(335779.526232, 1739527262.8478),
        argument(1072260.70369, 1602961601.2090),
        argument(450160.398036, -6962890.5431),
    ];
    let (mut d_psi, mut d_eps) = (0.0, 0.0);
    for (multiples, [ps, pst, pc, ec, ect, es]) in &NUTATION {
        let angle: f64 = multiples
            .iter()
            .zip(arguments)
            .map(|(&n, x)| f64::from(n) * x)
            .sum();
        let [(sin, cos)] = sin_cos([angle]);
        d_psi += (ps + pst * t) * sin + pc * cos;
        d_eps += (ec + ect * t) * cos + es * sin;
    }
    // Constants stand in for the planets' part.
    (
        (d_psi * 1e-7 - 0.000135) * ARCSEC,
        (d_eps * 1e-7 + 0.000388) * ARCSEC,
        arguments[4],
    )
}

/// Multiples of the mean anomalies of moon and sun, the moon's argument of latitude, elongation and node; then
/// longitude sin, t sin, cos and obliquity cos, t cos, sin [1e-7"].
#[rustfmt::skip]
const NUTATION: [([i8; 5], [f64; 6]); 77] = [
    ([0, 0, 0, 0, 1], [-172064161.0, -174666.0, 33386.0, 92052331.0, 9086.0, 15377.0]),
    ([0, 0, 2, -2, 2], [-13170906.0, -1675.0, -13696.0, 5730336.0, -3015.0, -4587.0]),
    ([0, 0, 2, 0, 2], [-2276413.0, -234.0, 2796.0, 978459.0, -485.0, 1374.0]),
    ([0, 0, 0, 0, 2], [2074554.0, 207.0, -698.0, -897492.0, 470.0, -291.0]),
    ([0, 1, 0, 0, 0], [1475877.0, -3633.0, 11817.0, 73871.0, -184.0, -1924.0]),
    ([0, 1, 2, -2, 2], [-516821.0, 1226.0, -524.0, 224386.0, -677.0, -174.0]),
    ([1, 0, 0, 0, 0], [711159.0, 73.0, -872.0, -6750.0, 0.0, 358.0]),
    ([0, 0, 2, 0, 1], [-387298.0, -367.0, 380.0, 200728.0, 18.0, 318.0]),
    ([1, 0, 2, 0, 2], [-301461.0, -36.0, 816.0, 129025.0, -63.0, 367.0]),
    ([0, -1, 2, -2, 2], [215829.0, -494.0, 111.0, -95929.0, 299.0, 132.0]),
    ([0, 0, 2, -2, 1], [128227.0, 137.0, 181.0, -68982.0, -9.0, 39.0]),
    ([-1, 0, 2, 0, 2], [123457.0, 11.0, 19.0, -53311.0, 32.0, -4.0]),
    ([-1, 0, 0, 2, 0], [156994.0, 10.0, -168.0, -1235.0, 0.0, 82.0]),
    ([1, 0, 0, 0, 1], [63110.0, 63.0, 27.0, -33228.0, 0.0, -9.0]),
    ([-1, 0, 0, 0, 1], [-57976.0, -63.0, -189.0, 31429.0, 0.0, -75.0]),
    ([-1, 0, 2, 2, 2], [-59641.0, -11.0, 149.0, 25543.0, -11.0, 66.0]),
    ([1, 0, 2, 0, 1], [-51613.0, -42.0, 129.0, 26366.0, 0.0, 78.0]),
    ([-2, 0, 2, 0, 1], [45893.0, 50.0, 31.0, -24236.0, -10.0, 20.0]),
    ([0, 0, 0, 2, 0], [63384.0, 11.0, -150.0, -1220.0, 0.0, 29.0]),
    ([0, 0, 2, 2, 2], [-38571.0, -1.0, 158.0, 16452.0, -11.0, 68.0]),
    ([0, -2, 2, -2, 2], [32481.0, 0.0, 0.0, -13870.0, 0.0, 0.0]),
    ([-2, 0, 0, 2, 0], [-47722.0, 0.0, -18.0, 477.0, 0.0, -25.0]),
    ([2, 0, 2, 0, 2], [-31046.0, -1.0, 131.0, 13238.0, -11.0, 59.0]),
    ([1, 0, 2, -2, 2], [28593.0, 0.0, -1.0, -12338.0, 10.0, -3.0]),
    ([-1, 0, 2, 0, 1], [20441.0, 21.0, 10.0, -10758.0, 0.0, -3.0]),
    ([2, 0, 0, 0, 0], [29243.0, 0.0, -74.0, -609.0, 0.0, 13.0]),
    ([0, 0, 2, 0, 0], [25887.0, 0.0, -66.0, -550.0, 0.0, 11.0]),
    ([0, 1, 0, 0, 1], [-14053.0, -25.0, 79.0, 8551.0, -2.0, -45.0]),
    ([-1, 0, 0, 2, 1], [15164.0, 10.0, 11.0, -8001.0, 0.0, -1.0]),
    ([0, 2, 2, -2, 2], [-15794.0, 72.0, -16.0, 6850.0, -42.0, -5.0]),
    ([0, 0, -2, 2, 0], [21783.0, 0.0, 13.0, -167.0, 0.0, 13.0]),
    ([1, 0, 0, -2, 1], [-12873.0, -10.0, -37.0, 6953.0, 0.0, -14.0]),
    ([0, -1, 0, 0, 1], [-12654.0, 11.0, 63.0, 6415.0, 0.0, 26.0]),
    ([-1, 0, 2, 2, 1], [-10204.0, 0.0, 25.0, 5222.0, 0.0, 15.0]),
    ([0, 2, 0, 0, 0], [16707.0, -85.0, -10.0, 168.0, -1.0, 10.0]),
    ([1, 0, 2, 2, 2], [-7691.0, 0.0, 44.0, 3268.0, 0.0, 19.0]),
    ([-2, 0, 2, 0, 0], [-11024.0, 0.0, -14.0, 104.0, 0.0, 2.0]),
    ([0, 1, 2, 0, 2], [7566.0, -21.0, -11.0, -3250.0, 0.0, -5.0]),
    ([0, 0, 2, 2, 1], [-6637.0, -11.0, 25.0, 3353.0, 0.0, 14.0]),
    ([0, -1, 2, 0, 2], [-7141.0, 21.0, 8.0, 3070.0, 0.0, 4.0]),
    ([0, 0, 0, 2, 1], [-6302.0, -11.0, 2.0, 3272.0, 0.0, 4.0]),
    ([1, 0, 2, -2, 1], [5800.0, 10.0, 2.0, -3045.0, 0.0, -1.0]),
    ([2, 0, 2, -2, 2], [6443.0, 0.0, -7.0, -2768.0, 0.0, -4.0]),
    ([-2, 0, 0, 2, 1], [-5774.0, -11.0, -15.0, 3041.0, 0.0, -5.0]),
    ([2, 0, 2, 0, 1], [-5350.0, 0.0, 21.0, 2695.0, 0.0, 12.0]),
    ([0, -1, 2, -2, 1], [-4752.0, -11.0, -3.0, 2719.0, 0.0, -3.0]),
    ([0, 0, 0, -2, 1], [-4940.0, -11.0, -21.0, 2720.0, 0.0, -9.0]),
    ([-1, -1, 0, 2, 0], [7350.0, 0.0, -8.0, -51.0, 0.0, 4.0]),
    ([2, 0, 0, -2, 1], [4065.0, 0.0, 6.0, -2206.0, 0.0, 1.0]),
    ([1, 0, 0, 2, 0], [6579.0, 0.0, -24.0, -199.0, 0.0, 2.0]),
    ([0, 1, 2, -2, 1], [3579.0, 0.0, 5.0, -1900.0, 0.0, 1.0]),
    ([1, -1, 0, 0, 0], [4725.0, 0.0, -6.0, -41.0, 0.0, 3.0]),
    ([-2, 0, 2, 0, 2], [-3075.0, 0.0, -2.0, 1313.0, 0.0, -1.0]),
    ([3, 0, 2, 0, 2], [-2904.0, 0.0, 15.0, 1233.0, 0.0, 7.0]),
    ([0, -1, 0, 2, 0], [4348.0, 0.0, -10.0, -81.0, 0.0, 2.0]),
    ([1, -1, 2, 0, 2], [-2878.0, 0.0, 8.0, 1232.0, 0.0, 4.0]),
    ([0, 0, 0, 1, 0], [-4230.0, 0.0, 5.0, -20.0, 0.0, -2.0]),
    ([-1, -1, 2, 2, 2], [-2819.0, 0.0, 7.0, 1207.0, 0.0, 3.0]),
    ([-1, 0, 2, 0, 0], [-4056.0, 0.0, 5.0, 40.0, 0.0, -2.0]),
    ([0, -1, 2, 2, 2], [-2647.0, 0.0, 11.0, 1129.0, 0.0, 5.0]),
    ([-2, 0, 0, 0, 1], [-2294.0, 0.0, -10.0, 1266.0, 0.0, -4.0]),
    ([1, 1, 2, 0, 2], [2481.0, 0.0, -7.0, -1062.0, 0.0, -3.0]),
    ([2, 0, 0, 0, 1], [2179.0, 0.0, -2.0, -1129.0, 0.0, -2.0]),
    ([-1, 1, 0, 1, 0], [3276.0, 0.0, 1.0, -9.0, 0.0, 0.0]), ([1, 1, 0, 0, 0], [-3389.0, 0.0, 5.0, 35.0, 0.0, -2.0]),
    ([1, 0, 2, 0, 0], [3339.0, 0.0, -13.0, -107.0, 0.0, 1.0]),
    ([-1, 0, 2, -2, 1], [-1987.0, 0.0, -6.0, 1073.0, 0.0, -2.0]),
    ([1, 0, 0, 0, 2], [-1981.0, 0.0, 0.0, 854.0, 0.0, 0.0]),
    ([-1, 0, 0, 1, 0], [4026.0, 0.0, -353.0, -553.0, 0.0, -139.0]),
    ([0, 0, 2, 1, 2], [1660.0, 0.0, -5.0, -710.0, 0.0, -2.0]),
    ([-1, 0, 2, 4, 2], [-1521.0, 0.0, 9.0, 647.0, 0.0, 4.0]),
    ([-1, 1, 0, 1, 1], [1314.0, 0.0, 0.0, -700.0, 0.0, 0.0]),
    ([0, -2, 2, -2, 1], [-1283.0, 0.0, 0.0, 672.0, 0.0, 0.0]),
    ([1, 0, 2, 2, 1], [-1331.0, 0.0, 8.0, 663.0, 0.0, 4.0]),
    ([-2, 0, 2, 2, 2], [1383.0, 0.0, -2.0, -594.0, 0.0, -2.0]),
    ([-1, 0, 0, 0, 2], [1405.0, 0.0, 4.0, -610.0, 0.0, 2.0]),
    ([1, 1, 2, -2, 2], [1290.0, 0.0, 0.0, -556.0, 0.0, 0.0]),
];

#[cfg(test)]
mod tests {
    use super::*;

    /// Julian centuries since J2000.0, nutation in longitude and obliquity ["]. Source: `nut00b` of ERFA 2.0.1.
    const NUTATION_BY_ERFA: [[f64; 3]; 6] = [
        [-1.0, 17.34596395041413, -2.293000934274587],
        [-0.497, -3.0519197988300286, 9.277388846599305],
        [0.0, -13.931663888969783, -5.769417077292847],
        [0.269, 8.477138952561605, 7.027951152244324],
        [0.7555, -16.007719317977724, -2.3609293798549804],
        [1.0, 3.272757918699833, 8.584860083110494],
    ];

    #[test]
    fn nutation_is_that_of_erfa_to_the_last_of_its_terms() {
        for [t, d_psi, d_eps] in NUTATION_BY_ERFA {
            let (psi, eps, _) = nutation(t);
            for (got, expected) in [(psi, d_psi), (eps, d_eps)] {
                // The smallest figures of the table are 1e-7.
                let off = got / ARCSEC - expected;
                assert!(off.abs() < 1e-8, "{t}: {off:e} arcseconds");
            }
        }
    }

    /// Julian centuries, the poles of ecliptic and equator. Source: `ltpecl` and `ltpequ` of ERFA 2.0.1.
    #[rustfmt::skip]
    const POLES_BY_ERFA: [(f64, [f64; 3], [f64; 3]); 4] = [
        (-40.0, [0.0007443878658365737, -0.406296321735327, 0.9137410709993553],
            [-0.3331248386206627, -0.1610969085511166, 0.9290186370300817]),
        (-1.0, [-1.9416220619776105e-05, -0.3979854025377621, 0.9173917478317895],
            [-0.00971771784453175, -0.00010850968077055874, 0.9999527759777175]),
        (7.3, [0.00019830979266567174, -0.39626942060824427, 0.9181342532353493],
            [0.0704462658854226, -0.005771007817824672, 0.997498881749532]),
        (40.0, [0.0022400769210225114, -0.38993742992452135, 0.9208386301623357],
            [0.32670865991702663, -0.15980354229109592, 0.9315171922226871]),
    ];

    #[test]
    fn poles_of_millennia_are_those_of_erfa() {
        for (t, ecliptic, equator) in POLES_BY_ERFA {
            for (got, expected) in [(ecliptic_pole(t), ecliptic), (equator_pole(t), equator)] {
                for (got, expected) in got.iter().zip(expected) {
                    assert!((got - expected).abs() < 1e-11, "{t}: {got} {expected}");
                }
            }
        }
    }
}
