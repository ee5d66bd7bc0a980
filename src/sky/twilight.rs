//! From day into night: the illuminance that the sky follows below 10 degrees, and what it looks like there.

use crate::colour::{into_gamut, working_from_xyz};
use crate::units::DEG;
use glam::DVec3;
use std::f64::consts::PI;
use std::sync::LazyLock;

/// True elevation of the sun [rad] above which a sky is its model alone.
pub const BEGIN: f64 = 10.0 * DEG;

/// True elevation of the sun [rad] at and below which the sky's illuminance is the published curve's alone.
pub const LEVEL: f64 = 5.0 * DEG;

/// True elevation of the sun [rad] at and below which the sky's distribution and colour are the twilight's alone.
///
/// The models' fits are not usable below: Perez's coefficients give the horizon spikes.
pub const SHAPE: f64 = 2.0 * DEG;

/// True elevation of the sun [rad] below which the night shows.
pub const NIGHTFALL: f64 = -12.0 * DEG;

/// True elevation of the sun [rad] at and below which it is night.
pub const END: f64 = -18.0 * DEG;

/// Pieces of log10 E = l0 + l1 x + l2 x^2 + l3 x^3, x = elevation / 90 degrees, and where each begins [degrees].
const PIECES: [(f64, [f64; 4]); 6] = [
    (20.0, [3.74, 3.97, -4.07, 1.47]),
    (5.0, [3.05, 13.28, -45.98, 64.33]),
    (-0.8, [2.88, 22.26, -207.64, 1034.30]),
    (-5.0, [2.88, 21.81, -258.11, -858.36]),
    (-12.0, [2.70, 12.17, -431.69, -1899.83]),
    (-18.0, [13.84, 262.72, 1447.42, 2797.93]),
];

/// Half the width [degrees] over which two pieces, which meet within 1.5 %, are blended into one smooth curve.
const JOIN_DEG: f64 = 0.4;

/// Where the curve begins to level out into the night [degrees].
const EASE_DEG: f64 = -17.0;

/// Horizontal illuminance [lx] of sun and clear sky at sea level against the sun's true elevation [rad].
///
/// Domain: -90 to 90 degrees; below -18 degrees it stays at what the stars and the airglow give, 6.4e-4 lx.
/// Source: Janiczek & DeYoung 1987, US Naval Observatory Circular 171.
/// Differs: neighbouring pieces are blended over 0.8 degrees and the last degree levels out, so that the curve has no step or kink.
pub fn clear_illuminance(elevation: f64) -> f64 {
    let degrees = (elevation / DEG).clamp(-18.0, 90.0);
    let x = degrees / 90.0;
    let piece = |l: &[f64; 4]| ((l[3] * x + l[2]) * x + l[1]) * x + l[0];
    if degrees < EASE_DEG {
        // From the curve's slope at -17 degrees to none at -18.
        let l = &PIECES[5].1;
        let start = EASE_DEG / 90.0;
        let value = |x: f64| ((l[3] * x + l[2]) * x + l[1]) * x + l[0];
        let slope = (3.0 * l[3] * start + 2.0 * l[2]) * start + l[1];
        let t = EASE_DEG - degrees;
        let (v0, v1, s0) = (value(start), value(-0.2), -slope / 90.0);
        let (t2, t3) = (t * t, t * t * t);
        let log = v0 * (2.0 * t3 - 3.0 * t2 + 1.0)
            + s0 * (t3 - 2.0 * t2 + t)
            + v1 * (3.0 * t2 - 2.0 * t3);
        return 10f64.powf(log);
    }
    let mut log = piece(&PIECES[0].1);
    for pair in PIECES.windows(2) {
        let above = smoothstep(pair[0].0 - JOIN_DEG, pair[0].0 + JOIN_DEG, degrees);
        if above == 1.0 {
            break;
        }
        log = piece(&pair[1].1) * (1.0 - above) + log * above;
    }
    10f64.powf(log)
}

/// Shares of horizontal illuminance [1] that a sky takes from its model, its twilight and the night.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shares {
    /// The daylight model's.
    pub day: f64,
    /// The twilight's.
    pub twilight: f64,
    /// The night's.
    pub night: f64,
}

/// The shares at a true elevation of the sun [rad]; they sum to 1.
pub fn shares(elevation: f64) -> Shares {
    let day = smoothstep(SHAPE, BEGIN, elevation);
    let night = 1.0 - smoothstep(END, NIGHTFALL, elevation);
    Shares {
        day,
        twilight: 1.0 - day - night,
        night,
    }
}

/// The sun's elevations [degrees] in the table, falling.
const SUNS: [f64; 20] = [
    10.0, 8.0, 6.0, 4.5, 3.0, 2.0, 1.0, 0.0, -1.0, -2.0, -3.0, -4.0, -5.0, -6.0, -7.0, -8.5, -10.0,
    -12.0, -15.0, -18.0,
];

/// The azimuths from the sun [degrees] in the table.
const AZIMUTHS: [f64; 11] = [
    0.0, 8.0, 16.0, 26.0, 38.0, 55.0, 75.0, 100.0, 130.0, 155.0, 180.0,
];

/// Steps in sqrt(sin(view elevation)), 0 to 1, in the table.
const HEIGHTS: usize = 15;

/// Logarithms of XYZ of the smooth part and of singly scattered aerosol light with its phase taken out.
static TABLE: LazyLock<Vec<[f64; 6]>> = LazyLock::new(|| {
    let bytes = include_bytes!("../../data/twilight.bin");
    bytes
        .as_chunks::<24>()
        .0
        .iter()
        .map(|row| {
            std::array::from_fn(|i| {
                f64::from(f32::from_le_bytes(std::array::from_fn(|k| row[4 * i + k])))
            })
        })
        .collect()
});

/// Asymmetry of the aerosol's phase function in the table.
pub(super) const AEROSOL_G: f64 = 0.76;

/// Points of the grid that is read per direction: over sqrt(sin(view elevation)) and over azimuth.
pub(super) const GRID: [usize; 2] = [64, 49];

/// The clear sky while the sun is low or down, as radiance of no particular level.
///
/// From a table of spectral scattering in a spherical atmosphere with ozone (`data/twilight.py`): the zenith is blue
/// because ozone takes the orange out of the long path, the bright arch narrows over the sunken sun, and the earth's shadow
/// rises opposite under a rosy band. The table is interpolated in the logarithm by cubic curves, so that no step shows.
/// Domain: true solar elevations from 10 to -18 degrees; one fixed clear atmosphere (aerosol optical depth 0.1, 300 DU of
/// ozone), whatever the turbidity. Model error: its illuminance is not used, only its distribution and colour.
#[derive(Debug, Clone, PartialEq)]
pub struct Twilight {
    grid: Vec<[DVec3; 2]>,
}

impl Twilight {
    /// The twilight for a sun at a true elevation [rad], 10 to -18 degrees; outside, that of the nearer end.
    pub fn new(elevation: f64) -> Self {
        let degrees = (elevation / DEG).clamp(-18.0, 10.0);
        // Over the sun's elevation, then over height, then over azimuth, each time by a curve through the table's values.
        let (columns, rows) = (AZIMUTHS.len(), HEIGHTS);
        let sun = Curve::new(&SUNS.map(|s| -s), -degrees, Ends::Free);
        let slice: Vec<[f64; 6]> = (0..rows * columns)
            .map(|i| sun.value(|k| TABLE[k * rows * columns + i]))
            .collect();
        let heights: [f64; HEIGHTS] = std::array::from_fn(|i| i as f64 / (HEIGHTS - 1) as f64);
        let azimuths: Vec<Curve> = (0..GRID[1])
            .map(|i| {
                Curve::new(
                    &AZIMUTHS,
                    180.0 * i as f64 / (GRID[1] - 1) as f64,
                    Ends::Mirror,
                )
            })
            .collect();
        let mut grid = Vec::with_capacity(GRID[0] * GRID[1]);
        for i in 0..GRID[0] {
            // Level in sqrt(y) at the horizon is linear in y: no cusp there.
            let height = Curve::new(&heights, i as f64 / (GRID[0] - 1) as f64, Ends::MirrorFirst);
            let row: [[f64; 6]; AZIMUTHS.len()] =
                std::array::from_fn(|a| height.value(|k| slice[k * columns + a]));
            for azimuth in &azimuths {
                let v = azimuth.value(|k| row[k]).map(f64::exp);
                grid.push([
                    working_from_xyz(DVec3::new(v[0], v[1], v[2])),
                    working_from_xyz(DVec3::new(v[3], v[4], v[5])),
                ]);
            }
        }
        Twilight { grid }
    }

    /// Relative radiance, RGB in the working space, toward a unit direction.
    ///
    /// `toward_azimuth` is the horizontal unit vector toward the sun's azimuth, `cos_gamma` the cosine of the angle from the sun.
    pub fn radiance(&self, direction: DVec3, toward_azimuth: DVec3, cos_gamma: f64) -> DVec3 {
        let along = direction.dot(toward_azimuth);
        let across = (direction.x * toward_azimuth.z - direction.z * toward_azimuth.x).abs();
        let (i, u) = cell(height(direction.y), GRID[0]);
        let (j, v) = azimuth_cell(across.atan2(along));
        let at = |j: usize| {
            mix(
                self.grid[i * GRID[1] + j],
                self.grid[(i + 1) * GRID[1] + j],
                u,
            )
        };
        with_phase(mix(at(j), at(j + 1), v), cos_gamma)
    }

    /// The whole grid, height by height: the smooth part and the aerosol's at each azimuth.
    pub(super) fn grid(&self) -> impl Iterator<Item = DVec3> + '_ {
        self.grid.iter().flatten().copied()
    }

    /// The grid at a height, by the sine of the elevation: to be read over azimuth by [`read`].
    pub fn circle(&self, sine: f64) -> Vec<[DVec3; 2]> {
        let (i, u) = cell(height(sine), GRID[0]);
        (0..GRID[1])
            .map(|j| {
                mix(
                    self.grid[i * GRID[1] + j],
                    self.grid[(i + 1) * GRID[1] + j],
                    u,
                )
            })
            .collect()
    }
}

/// Where an azimuth from the sun [rad], 0 to pi, falls in a [`Twilight::circle`]: the point before it, and the way to the next.
pub fn azimuth_cell(azimuth: f64) -> (usize, f64) {
    cell(azimuth / PI * (GRID[1] - 1) as f64, GRID[1])
}

/// What [`Twilight::radiance`] gives, read from a circle.
#[inline]
pub fn read(circle: &[[DVec3; 2]], (j, v): (usize, f64), cos_gamma: f64) -> DVec3 {
    with_phase(mix(circle[j], circle[j + 1], v), cos_gamma)
}

fn height(sine: f64) -> f64 {
    sine.clamp(0.0, 1.0).sqrt() * (GRID[0] - 1) as f64
}

fn mix(a: [DVec3; 2], b: [DVec3; 2], share: f64) -> [DVec3; 2] {
    [a[0].lerp(b[0], share), a[1].lerp(b[1], share)]
}

fn with_phase([smooth, aerosol]: [DVec3; 2], cos_gamma: f64) -> DVec3 {
    let d = 1.0 + AEROSOL_G * AEROSOL_G - 2.0 * AEROSOL_G * cos_gamma;
    let phase = (1.0 - AEROSOL_G * AEROSOL_G) / (4.0 * PI * d * d.sqrt());
    into_gamut(smooth + aerosol * phase)
}

/// The cell of a grid of `n` points that `x` falls in, and where in it.
fn cell(x: f64, n: usize) -> (usize, f64) {
    let below = (x as usize).min(n - 2);
    (below, x - below as f64)
}

/// What a curve does at its ends.
#[derive(Clone, Copy, PartialEq)]
enum Ends {
    /// It keeps the slope of its last piece.
    Free,
    /// It is mirrored: no slope.
    Mirror,
    /// Mirrored at the first, free at the last.
    MirrorFirst,
}

/// Weights of a cubic through values at rising nodes (Hermite, with slopes through the neighbours), at one place.
struct Curve {
    first: usize,
    weights: [f64; 4],
}

impl Curve {
    fn new(nodes: &[f64], x: f64, ends: Ends) -> Self {
        let last = nodes.len() - 1;
        let i = nodes[1..last].iter().take_while(|n| **n <= x).count();
        let h = nodes[i + 1] - nodes[i];
        let t = (x - nodes[i]) / h;
        let (t2, t3) = (t * t, t * t * t);
        // Weights on the values at i - 1 .. i + 2.
        let mut w = [0.0, 2.0 * t3 - 3.0 * t2 + 1.0, 3.0 * t2 - 2.0 * t3, 0.0];
        let mut slope = |node: usize, weight: f64| {
            let at = node + 1 - i;
            if node == 0 || node == last {
                if ends == Ends::Free || (ends == Ends::MirrorFirst && node == last) {
                    let inner = if node == 0 { 1 } else { last - 1 };
                    let gap = nodes[node] - nodes[inner];
                    w[at] += weight * h / gap;
                    w[inner + 1 - i] -= weight * h / gap;
                }
            } else {
                // The parabola's slope through three nodes.
                let (l, r) = (nodes[node] - nodes[node - 1], nodes[node + 1] - nodes[node]);
                w[at - 1] -= weight * h * r / (l * (l + r));
                w[at + 1] += weight * h * l / (r * (l + r));
                w[at] += weight * h * (r - l) / (l * r);
            }
        };
        slope(i, t3 - 2.0 * t2 + t);
        slope(i + 1, t3 - t2);
        Curve {
            first: i,
            weights: w,
        }
    }

    fn value<const N: usize>(&self, values: impl Fn(usize) -> [f64; N]) -> [f64; N] {
        let mut sum = [0.0; N];
        for (k, weight) in self.weights.iter().enumerate() {
            if *weight != 0.0 {
                let v = values(self.first + k - 1);
                for n in 0..N {
                    sum[n] += weight * v[n];
                }
            }
        }
        sum
    }
}

/// 0 below `low`, 1 above `high`, 3 t^2 - 2 t^3 between.
pub(crate) fn smoothstep(low: f64, high: f64, x: f64) -> f64 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
