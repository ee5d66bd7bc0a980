//! The sky dome cut into patches: ReLiShaft's 5 728 triangles, Tregenza's 145 patches and Reinhart's subdivisions.

use super::Sky;
use crate::colour::luminance;
use crate::error::{Error, Result};
use crate::units::DEG;
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI};
use std::iter::Sum;
use std::ops::{Add, Div, Mul};

/// How the dome is cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Subdivision {
    /// 5 728 spherical triangles of nearly equal size (Kolivand et al. 2018, section 3.2, whose own layout is not stated).
    Triangles,
    /// Tregenza 1987: seven rows of 12 degrees and a cap, 145 patches.
    Tregenza,
    /// Reinhart: every Tregenza patch split `n` times each way, 144 n^2 + 1 patches; 1 to 16. Rows are 90 / (7 n + 1/2) degrees.
    Reinhart(u32),
}

/// One piece of the dome.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Patch {
    /// Unit vector toward its middle.
    pub direction: DVec3,
    /// Its solid angle [sr].
    pub solid_angle: f64,
    /// Its solid angle projected on the ground, the integral of (w . up) dw [sr].
    pub projected: f64,
    area: Area,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Area {
    Triangle([DVec3; 3]),
    /// Azimuths from -Z toward +X [rad] and sines of elevation, from and to.
    Cell {
        azimuth: [f64; 2],
        sine: [f64; 2],
    },
}

/// Patches in a row of Tregenza's, from the horizon up.
const TREGENZA: [u32; 7] = [30, 30, 24, 24, 18, 12, 6];

/// Rings of the triangle mesh, and points in the ring on the horizon.
const RINGS: usize = 36;
const HORIZON_POINTS: usize = 124;

/// Triangles in ReLiShaft's dome.
pub const TRIANGLES: usize = 5728;

/// Cuts the dome: solid angles sum to 2 pi, projected ones to pi, to rounding.
///
/// Errors: [`Error::Domain`] for a Reinhart factor outside 1 to 16.
pub fn dome(subdivision: Subdivision) -> Result<Vec<Patch>> {
    match subdivision {
        Subdivision::Triangles => Ok(triangles()),
        Subdivision::Tregenza => Ok(cells(1)),
        Subdivision::Reinhart(n @ 1..=16) => Ok(cells(n)),
        Subdivision::Reinhart(n) => Err(Error::domain(
            "Reinhart's factor",
            n,
            "1 to 16",
            "1 is Tregenza's 145 patches, 2 gives 577, 4 gives 2305",
        )),
    }
}

/// Mean radiance of each patch, RGB in the working space [cd/m2].
///
/// Means over the patch by quadrature (steps of at most 1.5 degrees), then all times one factor per channel so that
/// the radiances times the projected solid angles sum to the sky's horizontal illuminance: within 1e-4 of 1 for the
/// triangles, within some per cent for 145 patches, where radiance and cosine vary together.
pub fn radiances(sky: &Sky, patches: &[Patch]) -> Vec<DVec3> {
    let means: Vec<DVec3> = patches
        .iter()
        .map(|p| p.mean(|w| sky.radiance(w)))
        .collect();
    let sum: DVec3 = means
        .iter()
        .zip(patches)
        .map(|(l, p)| *l * p.projected)
        .sum();
    let whole = sky.horizontal_illuminance();
    let factor = |sum: f64, whole: f64| if sum > 0.0 { whole / sum } else { 1.0 };
    let factor = DVec3::new(
        factor(sum.x, whole.x),
        factor(sum.y, whole.y),
        factor(sum.z, whole.z),
    );
    means.into_iter().map(|l| l * factor).collect()
}

/// Their luminances [cd/m2]: those of [`radiances`], but that one factor makes the sum that of the sky.
pub fn luminances(sky: &Sky, patches: &[Patch]) -> Vec<f64> {
    let mut means: Vec<f64> = patches
        .iter()
        .map(|p| p.mean(|w| sky.luminance(w)))
        .collect();
    let sum: f64 = means
        .iter()
        .zip(patches)
        .map(|(l, p)| l * p.projected)
        .sum();
    if sum > 0.0 {
        let factor = luminance(sky.horizontal_illuminance()) / sum;
        means.iter_mut().for_each(|l| *l *= factor);
    }
    means
}

impl Patch {
    /// How far within the planes of its sides a direction lies: not below 0 where a triangle contains it. Cells contain nothing.
    fn within(&self, toward: DVec3) -> f64 {
        let Area::Triangle([a, b, c]) = self.area else {
            return f64::NEG_INFINITY;
        };
        let sides = [a.cross(b), b.cross(c), c.cross(a)];
        let inside = sides.map(|side| side.dot(toward));
        let turned = a.dot(sides[1]).signum();
        inside
            .into_iter()
            .map(|s| turned * s)
            .fold(f64::INFINITY, f64::min)
    }

    /// Mean of a function of direction over the patch.
    fn mean<T>(&self, f: impl Fn(DVec3) -> T) -> T
    where
        T: Default + Sum + Add<Output = T> + Mul<f64, Output = T> + Div<f64, Output = T>,
    {
        match self.area {
            Area::Triangle(corners) => {
                let (sum, weight) = split(corners, 2).fold((T::default(), 0.0), |(sum, all), t| {
                    let weight = solid_angle(t);
                    (sum + f(centre(t)) * weight, all + weight)
                });
                sum / weight
            }
            Area::Cell { azimuth, sine } => {
                let step = 1.5 * DEG;
                let height = sine[1].min(1.0).asin() - sine[0].asin();
                let rows = (height / step).ceil().max(2.0) as u32;
                let columns = ((azimuth[1] - azimuth[0]) * (1.0 - sine[0] * sine[0]).sqrt() / step)
                    .ceil()
                    .max(2.0) as u32;
                let at = |k: u32, count: u32, [a, b]: [f64; 2]| {
                    a + (b - a) * (f64::from(k) + 0.5) / f64::from(count)
                };
                let all = (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j)));
                let values =
                    all.map(|(i, j)| f(toward(at(j, columns, azimuth), at(i, rows, sine))));
                values.sum::<T>() / f64::from(rows * columns)
            }
        }
    }
}

fn toward(azimuth: f64, sine: f64) -> DVec3 {
    let (s, c) = azimuth.sin_cos();
    let r = (1.0 - sine * sine).max(0.0).sqrt();
    DVec3::new(r * s, sine, -r * c)
}

fn cells(n: u32) -> Vec<Patch> {
    let height = 90.0 / (7.0 * f64::from(n) + 0.5) * DEG;
    let mut patches = Vec::new();
    let mut cell = |azimuth: [f64; 2], sine: [f64; 2], middle: DVec3| {
        let turn = azimuth[1] - azimuth[0];
        patches.push(Patch {
            direction: middle,
            solid_angle: turn * (sine[1] - sine[0]),
            projected: 0.5 * turn * (sine[1] * sine[1] - sine[0] * sine[0]),
            area: Area::Cell { azimuth, sine },
        });
    };
    for row in 0..7 * n {
        let count = n * TREGENZA[(row / n) as usize];
        let turn = 2.0 * PI / f64::from(count);
        let sine = [0.0, 1.0].map(|up| (height * (f64::from(row) + up)).sin());
        let middle = (height * (f64::from(row) + 0.5)).sin();
        for k in 0..count {
            // The first patch of a row is centred on azimuth 0.
            let azimuth = turn * f64::from(k);
            cell(
                [azimuth - 0.5 * turn, azimuth + 0.5 * turn],
                sine,
                toward(azimuth, middle),
            );
        }
    }
    let top = (height * f64::from(7 * n)).sin();
    cell([-PI, PI], [top, 1.0], DVec3::Y);
    patches
}

/// Finds the patch of a direction.
#[derive(Debug, Clone)]
pub(crate) enum Finder {
    /// Among cells of Reinhart's factor.
    Cells(u32),
    /// Among the triangles.
    Triangles(Box<Rings>),
}

/// The strips of triangles between rings of points: points in each ring, and the number of each strip's first triangle.
#[derive(Debug, Clone)]
pub(crate) struct Rings {
    points: [usize; RINGS],
    first: [usize; RINGS],
}

impl Finder {
    /// For the patches of a subdivision.
    pub(crate) fn new(subdivision: Subdivision) -> Self {
        match subdivision {
            Subdivision::Triangles => Finder::Triangles(Box::new(Rings::new())),
            Subdivision::Tregenza => Finder::Cells(1),
            Subdivision::Reinhart(n) => Finder::Cells(n),
        }
    }

    /// The number, in the order of [`dome`], of the one of its `patches` that a unit direction points to; below the horizon that of the
    /// lowest row or strip.
    pub(crate) fn patch_of(&self, patches: &[Patch], toward: DVec3) -> u32 {
        match self {
            Finder::Cells(n) => row_of(*n, toward),
            Finder::Triangles(rings) => rings.triangle_of(patches, toward),
        }
    }
}

impl Rings {
    fn new() -> Self {
        let points = ring_points();
        let mut first = [0; RINGS];
        for ring in 1..RINGS {
            let inner = if ring == 1 { 0 } else { points[ring - 2] };
            first[ring] = first[ring - 1] + inner + points[ring - 1];
        }
        Rings { points, first }
    }

    fn triangle_of(&self, patches: &[Patch], toward: DVec3) -> u32 {
        let toward = DVec3::new(toward.x, toward.y.max(0.0), toward.z);
        let theta = toward.x.hypot(toward.z).atan2(toward.y);
        let turn = (toward.x.atan2(-toward.z) / (2.0 * PI)).rem_euclid(1.0);
        let strip = (theta / FRAC_PI_2 * RINGS as f64) as usize;
        // Sides are arcs of great circles and rise above the rings: there the strip below begins.
        let strips = strip.min(RINGS - 1)..(strip + 2).min(RINGS);
        let mut best = (f64::NEG_INFINITY, 0);
        for number in strips.flat_map(|strip| self.near(strip, turn)) {
            let within = patches
                .get(number)
                .map_or(f64::NEG_INFINITY, |p| p.within(toward));
            if within >= 0.0 {
                return number as u32;
            }
            if within > best.0 {
                best = (within, number);
            }
        }
        best.1 as u32
    }

    /// The triangles of a strip that may contain a direction of an azimuth [turns]: those that have a side on the outer or the
    /// inner ring there or beside it.
    fn near(&self, strip: usize, turn: f64) -> impl Iterator<Item = usize> {
        let outer = self.points[strip];
        let inner = if strip == 0 {
            0
        } else {
            self.points[strip - 1]
        };
        let first = self.first[strip];
        let sides = move |count: usize| {
            let side = (turn * count as f64) as usize + count;
            let some = if count == 0 { 0 } else { 3 };
            [side, side + count - count.min(1), side + 1]
                .into_iter()
                .map(move |side| side % count.max(1))
                .take(some)
        };
        // Both rings' triangles stand in the order of the middles of their sides, the outer one's first where two agree.
        let on_outer = sides(outer).map(move |o| match inner {
            0 => first + o,
            _ => first + o + ((2 * o + 1) * inner + outer - 1) / (2 * outer),
        });
        let on_inner =
            sides(inner).map(move |i| first + i + ((2 * i + 1) * outer + inner) / (2 * inner));
        on_outer.chain(on_inner)
    }
}

/// The number, in the order of [`dome`], of the patch of Reinhart's factor `n` that a unit direction points to; below the horizon that
/// of the lowest row.
fn row_of(n: u32, toward: DVec3) -> u32 {
    let height = 90.0 / (7.0 * f64::from(n) + 0.5) * DEG;
    let elevation = toward.y.clamp(0.0, 1.0).asin();
    let row = (elevation / height) as u32;
    let before: u32 = (0..row.min(7 * n))
        .step_by(n as usize)
        .map(|first| n * TREGENZA[(first / n) as usize] * (row.min(7 * n) - first).min(n))
        .sum();
    if row >= 7 * n {
        return before;
    }
    let count = n * TREGENZA[(row / n) as usize];
    let azimuth = toward.x.atan2(-toward.z);
    let place = (azimuth / (2.0 * PI) * f64::from(count)).round() as i64;
    before + place.rem_euclid(i64::from(count)) as u32
}

/// Points in each ring of the triangle mesh, from the top down: in proportion to the ring's circumference; 2 (m1 + ... + m35) + m36
/// triangles, made 5 728 in the widest rings.
fn ring_points() -> [usize; RINGS] {
    let mut counts: [usize; RINGS] = std::array::from_fn(|k| {
        let theta = FRAC_PI_2 * (k + 1) as f64 / RINGS as f64;
        (HORIZON_POINTS as f64 * theta.sin()).round() as usize
    });
    counts[RINGS - 1] = HORIZON_POINTS;
    let mut missing = (TRIANGLES as i64 - HORIZON_POINTS as i64) / 2
        - counts[..RINGS - 1].iter().sum::<usize>() as i64;
    for k in (0..RINGS - 1).rev().cycle() {
        if missing == 0 {
            break;
        }
        counts[k] = (counts[k] as i64 + missing.signum()) as usize;
        missing -= missing.signum();
    }
    counts
}

fn triangles() -> Vec<Patch> {
    let counts = ring_points();
    let point = |ring: usize, k: usize| {
        let count = counts[ring];
        if ring == RINGS - 1 {
            return toward(2.0 * PI * (k % count) as f64 / count as f64, 0.0);
        }
        let theta = FRAC_PI_2 * (ring + 1) as f64 / RINGS as f64;
        toward(2.0 * PI * (k % count) as f64 / count as f64, theta.cos())
    };
    let mut patches = Vec::with_capacity(TRIANGLES);
    let mut push = |corners: [DVec3; 3]| {
        patches.push(Patch {
            direction: centre(corners),
            solid_angle: solid_angle(corners),
            projected: projected(corners),
            area: Area::Triangle(corners),
        });
    };
    for k in 0..counts[0] {
        push([DVec3::Y, point(0, k), point(0, k + 1)]);
    }
    for ring in 1..RINGS {
        let (inner, outer) = (counts[ring - 1], counts[ring]);
        let (mut i, mut o) = (0, 0);
        while i < inner || o < outer {
            // Walk around both rings; the side whose next point comes first takes the next triangle.
            if o < outer && (i == inner || (2 * o + 1) * inner <= (2 * i + 1) * outer) {
                push([point(ring - 1, i), point(ring, o), point(ring, o + 1)]);
                o += 1;
            } else {
                push([point(ring - 1, i), point(ring, o), point(ring - 1, i + 1)]);
                i += 1;
            }
        }
    }
    patches
}

fn centre(t: [DVec3; 3]) -> DVec3 {
    (t[0] + t[1] + t[2]).normalize()
}

/// Solid angle [sr] of a spherical triangle (Van Oosterom & Strackee 1983).
fn solid_angle([a, b, c]: [DVec3; 3]) -> f64 {
    let d = 1.0 + a.dot(b) + b.dot(c) + c.dot(a);
    2.0 * a.dot(b.cross(c)).abs().atan2(d)
}

/// Projected solid angle [sr] on the ground: half the sum over the sides of arc times the side's normal (Lambert).
fn projected([a, b, c]: [DVec3; 3]) -> f64 {
    let side = |p: DVec3, q: DVec3| {
        let n = p.cross(q);
        let sin = n.length();
        if sin == 0.0 {
            0.0
        } else {
            sin.atan2(p.dot(q)) * n.y / sin
        }
    };
    (0.5 * (side(a, b) + side(b, c) + side(c, a))).abs()
}

/// The 4^n triangles of a spherical triangle halved n times along its sides.
fn split(t: [DVec3; 3], n: u32) -> Box<dyn Iterator<Item = [DVec3; 3]>> {
    if n == 0 {
        return Box::new(std::iter::once(t));
    }
    let [a, b, c] = t;
    let (ab, bc, ca) = (
        (a + b).normalize(),
        (b + c).normalize(),
        (c + a).normalize(),
    );
    Box::new(
        [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            .into_iter()
            .flat_map(move |t| split(t, n - 1)),
    )
}

/// What the patches of a subdivision would sum to without the common factor, over the exact horizontal illuminance [1].
pub fn raw_share(sky: &Sky, patches: &[Patch]) -> f64 {
    let sum: DVec3 = patches
        .iter()
        .map(|p| p.mean(|w| sky.radiance(w)) * p.projected)
        .sum();
    crate::colour::luminance(sum) / crate::colour::luminance(sky.horizontal_illuminance())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_patch_is_found_by_its_middle() {
        let factors = [1, 2, 4, 7].map(Subdivision::Reinhart);
        for subdivision in factors.into_iter().chain([Subdivision::Triangles]) {
            let patches = dome(subdivision).expect("the factors are sound");
            let finder = Finder::new(subdivision);
            for (k, patch) in patches.iter().enumerate() {
                assert_eq!(finder.patch_of(&patches, patch.direction), k as u32);
            }
        }
        for n in [1, 2, 4, 7] {
            assert_eq!(row_of(n, DVec3::new(0.0, -0.1, -1.0).normalize()), 0);
        }
    }

    /// Directions over the upper half, many of them near rings and meridians of points.
    fn directions() -> impl Iterator<Item = DVec3> {
        (0..10_000).map(|i| {
            // Roberts 2018.
            let [u, v] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2]
                .map(|step| (0.5 + f64::from(i) * step).fract());
            match i % 4 {
                0 => {
                    let theta = FRAC_PI_2 / RINGS as f64 * (u * RINGS as f64).round();
                    toward(2.0 * PI * v, (theta * (1.0 - 1e-6 * v)).cos())
                }
                1 => toward(2.0 * PI * ((v * 60.0).round() / 60.0 + 1e-12), u),
                _ => toward(2.0 * PI * v, u),
            }
        })
    }

    #[test]
    fn a_direction_lies_in_the_triangle_that_is_found_and_in_no_other() {
        let patches = triangles();
        let finder = Finder::new(Subdivision::Triangles);
        for (i, toward) in directions().enumerate() {
            let found = finder.patch_of(&patches, toward) as usize;
            // Corners and sides have a rounding's width.
            assert!(patches[found].within(toward) > -1e-15, "{toward}");
            if i % 16 == 2 {
                let others = (0..TRIANGLES).filter(|k| *k != found);
                let beside = others.map(|k| patches[k].within(toward));
                assert!(beside.fold(-1.0, f64::max) < 1e-15, "{toward}");
            }
        }
        // Of what lies below the horizon, the strip above it.
        for k in 0..100 {
            let azimuth = 2.0 * PI * f64::from(k) / 100.0;
            let down = toward(azimuth, 0.0) - 0.3 * DVec3::Y;
            let found = finder.patch_of(&patches, down.normalize()) as usize;
            assert!(patches[found].within(toward(azimuth, 0.0)) > -1e-15);
        }
    }
}
