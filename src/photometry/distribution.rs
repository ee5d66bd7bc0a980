//! Luminous intensity by direction: formulas and tables.

use super::{Pose, Table};
use crate::error::{Error, Result};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::Arc;

/// How the light of a lamp spreads over directions, in the lamp's own frame.
///
/// A direction has an angle theta from the lamp's axis (0 to pi) and an azimuth phi, which turns from [`Pose::around`] about the axis by
/// the right-hand rule (any angle; whole turns do not matter). See [`Pose::angles`]. Angles are in radians.
///
/// `spread` is the half angle gamma of the beam, 0 to pi: outside there is nothing, and a beam of 0 is its axis alone. `sharpness` is q, 0
/// (fading to nothing at the edge) to 1 (the same up to the edge). Both are those of Nishita, Miyawaki & Nakamae 1987, equation 7,
/// which is negative outside its beam and taken as 0 there:
///
/// S(theta) = (1 - q) (cos theta - cos gamma) / (1 - cos gamma) + q.
///
/// Patterns vary by k(x) = max(1 - (1 - p) (1 - |2 mod(x, 1) - 1|), 0) (their equation 8, x in periods): 1 at whole periods, `ratio` p
/// between them. A negative ratio, however low, narrows petals and dots.
#[derive(Debug, Clone, PartialEq)]
pub enum Distribution {
    /// The same in every direction.
    Isotropic,
    /// Equation 7: a spotlight.
    NishitaSpot {
        /// Half angle gamma [rad].
        spread: f64,
        /// Sharpness q of the edge [1].
        sharpness: f64,
    },
    /// Equation 9, S(theta) k(phi): petals around the axis, one of them at phi = 0.
    Daisy {
        /// Half angle gamma [rad].
        spread: f64,
        /// Sharpness q of the edge [1].
        sharpness: f64,
        /// Periods in a turn, 1 to [`Distribution::MOST`].
        petals: u32,
        /// Least intensity of greatest p [1], at most 1.
        ratio: f64,
    },
    /// Equation 10, S(theta) k(phi) k(theta) v: whole dots where periods of phi and of theta cross, every other of which
    /// (v = 0 or 1) is left out. The cell of a dot reaches half a period to each side of it.
    ///
    /// Around the axis dots are wedges; those at the edge of the beam are cut by it.
    PolkaDots {
        /// Half angle gamma [rad].
        spread: f64,
        /// Sharpness q of the edge [1].
        sharpness: f64,
        /// Periods of phi in a turn, even, 2 to [`Distribution::MOST`].
        petals: u32,
        /// Least intensity of greatest p [1], at most 1, in both directions.
        ratio: f64,
        /// Periods of theta from the axis to the edge, 1 to [`Distribution::MOST`].
        rings: u32,
    },
    /// Equation 7 with an elliptical cone, 1 / tan^2 gamma(phi) = cos^2 phi / tan^2 a + sin^2 phi / tan^2 b: a headlight.
    Elliptical {
        /// Half angles a toward [`Pose::around`] and b across [rad]: both up to pi/2, or both from there on.
        spread: [f64; 2],
        /// Sharpness q of the edge [1].
        sharpness: f64,
    },
    /// The cone of a spot light of glTF (KHR_lights_punctual): full strength within `inner`, nothing outside `outer`, and in between
    /// ((cos theta - cos outer) / max(0.001, cos inner - cos outer))^2, as the extension has it.
    Cone {
        /// Half angle of full strength [rad], 0 to `outer`.
        inner: f64,
        /// Half angle at which it ends [rad], 0 to pi / 2.
        outer: f64,
    },
    /// Measured values, [cd] instead of relative ones.
    Table(Arc<Table>),
}

impl Distribution {
    /// The greatest number of petals, and of rings.
    pub const MOST: u32 = 1000;

    /// Whether its numbers are in the domain of its formula.
    ///
    /// # Errors
    /// [`Error::Domain`], angles in degrees.
    pub fn check(&self) -> Result<()> {
        match *self {
            Distribution::Isotropic | Distribution::Table(_) => Ok(()),
            Distribution::Cone { inner, outer } => {
                match 0.0 <= inner && inner <= outer && outer <= FRAC_PI_2 {
                    true => Ok(()),
                    false => Err(Error::domain(
                        "the cone",
                        format!("{} to {} degrees", inner.to_degrees(), outer.to_degrees()),
                        "0 to 90 degrees, the inner angle not above the outer one",
                        "give the angles of the spot light in this order",
                    )),
                }
            }
            Distribution::NishitaSpot { spread, sharpness } => {
                check_spread(spread).and_then(|()| check_sharpness(sharpness))
            }
            Distribution::Daisy {
                spread,
                sharpness,
                petals,
                ratio,
            } => {
                check_spread(spread)?;
                check_sharpness(sharpness)?;
                check_ratio(ratio)?;
                check_count("petals", petals, 1)
            }
            Distribution::PolkaDots {
                spread,
                sharpness,
                petals,
                ratio,
                rings,
            } => {
                check_spread(spread)?;
                check_sharpness(sharpness)?;
                check_ratio(ratio)?;
                check_count("rings", rings, 1)?;
                check_count("petals", petals, 2)?;
                match petals % 2 {
                    0 => Ok(()),
                    _ => Err(Error::domain(
                        "petals",
                        petals,
                        "the even numbers",
                        "give an even number: every other dot is left out, and the last of a turn lies beside the first",
                    )),
                }
            }
            Distribution::Elliptical { spread, sharpness } => {
                spread.into_iter().try_for_each(check_spread)?;
                check_sharpness(sharpness)?;
                let [a, b] = spread;
                match (a > FRAC_PI_2 && b < FRAC_PI_2) || (a < FRAC_PI_2 && b > FRAC_PI_2) {
                    false => Ok(()),
                    true => Err(Error::domain(
                        "spread",
                        format!("[{}, {}] degrees", a.to_degrees(), b.to_degrees()),
                        "two angles up to 90 degrees, or two from 90 to 180",
                        "give both at most 90 degrees: an elliptical cone is not wider in one direction and narrower in the other",
                    )),
                }
            }
        }
    }

    /// Intensity in a direction, theta from 0 to pi from the axis and any phi [rad]: relative to the greatest that the formula has
    /// [1], or that of a table [cd]. Finite and not negative.
    pub fn relative(&self, theta: f64, phi: f64) -> f64 {
        match *self {
            Distribution::Isotropic => 1.0,
            Distribution::NishitaSpot { spread, sharpness } => beam(theta, spread, sharpness),
            Distribution::Daisy {
                spread,
                sharpness,
                petals,
                ratio,
            } => {
                let along = phi / TAU * f64::from(petals);
                beam(theta, spread, sharpness) * pattern(along, ratio)
            }
            Distribution::PolkaDots {
                spread,
                sharpness,
                petals,
                ratio,
                rings,
            } => {
                let along = phi / TAU * f64::from(petals);
                let out = match spread > 0.0 {
                    true => theta / spread * f64::from(rings),
                    false => 0.0,
                };
                let cell = (along + 0.5).floor() + (out + 0.5).floor();
                match cell.rem_euclid(2.0) == 1.0 {
                    true => {
                        beam(theta, spread, sharpness) * pattern(along, ratio) * pattern(out, ratio)
                    }
                    false => 0.0,
                }
            }
            Distribution::Elliptical { spread, sharpness } => {
                beam(theta, elliptical_spread(spread, phi), sharpness)
            }
            Distribution::Cone { inner, outer } => falloff(theta, inner, outer),
            Distribution::Table(ref table) => table.intensity(theta, phi),
        }
    }

    /// [`Distribution::relative`] in a direction of the scene, away from a lamp that hangs in a pose; of any length.
    pub fn intensity(&self, pose: &Pose, direction: DVec3) -> f64 {
        if let Distribution::Isotropic = self {
            return 1.0;
        }
        let (theta, phi) = pose.angles(direction);
        self.relative(theta, phi)
    }

    /// The half angle of the cone around the axis outside which there is nothing [rad]; pi where there is none.
    pub fn cone(&self) -> f64 {
        match *self {
            Distribution::Isotropic => PI,
            Distribution::NishitaSpot { spread, .. }
            | Distribution::Daisy { spread, .. }
            | Distribution::PolkaDots { spread, .. } => spread,
            Distribution::Elliptical { spread: [a, b], .. } => a.max(b),
            Distribution::Cone { outer, .. } => outer,
            Distribution::Table(ref table) => table.cone(),
        }
    }

    /// About how wide the finest of what it shows is, for whoever samples it [rad]; pi where it is smooth inside its cone.
    pub fn detail(&self) -> f64 {
        match *self {
            Distribution::Isotropic
            | Distribution::NishitaSpot { .. }
            | Distribution::Elliptical { .. }
            | Distribution::Cone { .. } => PI,
            Distribution::Daisy { petals, ratio, .. } => PI / f64::from(petals) / narrowed(ratio),
            Distribution::PolkaDots {
                spread,
                petals,
                ratio,
                rings,
                ..
            } => (PI / f64::from(petals)).min(0.5 * spread / f64::from(rings)) / narrowed(ratio),
            Distribution::Table(ref table) => {
                // The way from its peak to half of it.
                let peak = table.peak();
                let falls = |deg: &f64| table.at(peak.horizontal_deg, *deg) < 0.5 * peak.candela;
                let vertical = table.vertical().iter().filter(|deg| falls(deg));
                let away = vertical.map(|deg| (deg - peak.vertical_deg).abs());
                away.fold(f64::INFINITY, f64::min)
                    .to_radians()
                    .clamp(1e-3, TABLE_DETAIL)
            }
        }
    }

    /// No direction has more than this: of formulas 1, of a table its greatest value [cd].
    pub fn peak(&self) -> f64 {
        match self {
            Distribution::Table(table) => table.peak().candela,
            _ => 1.0,
        }
    }

    /// Luminous flux for an intensity of 1 cd [lm], of a table its own: the integral of [`Distribution::relative`] over the sphere.
    ///
    /// In closed form; for dots and ellipses by quadrature to 1e-12.
    pub fn flux(&self) -> f64 {
        // The integral of equation 7: half (1 + q) of the cone's solid angle, 2 pi (1 - cos gamma).
        let cone = |spread: f64, q: f64| TAU * (0.5 * spread).sin().powi(2) * (1.0 + q);
        match *self {
            Distribution::Isotropic => 4.0 * PI,
            Distribution::NishitaSpot { spread, sharpness } => cone(spread, sharpness),
            Distribution::Daisy {
                spread,
                sharpness,
                ratio,
                ..
            } => cone(spread, sharpness) * mean_of_pattern(ratio),
            Distribution::PolkaDots {
                spread,
                sharpness,
                ratio,
                rings,
                ..
            } => {
                // Each ring has dots in every other cell of a turn, so that phi and theta part.
                let half = 0.5 * spread / f64::from(rings);
                let out = |theta: f64| {
                    beam(theta, spread, sharpness)
                        * pattern(0.5 * theta / half, ratio)
                        * theta.sin()
                };
                // The pattern bends at half and whole periods, and where it reaches 0 between them.
                let bend = half / (1.0 - ratio).max(1.0);
                let rising = |i: u32| {
                    let (from, to) = (f64::from(i) * half, f64::from(i + 1) * half);
                    let whole = i.is_multiple_of(2);
                    let inner = if whole { from + bend } else { to - bend };
                    integral(from, inner, &out) + integral(inner, to, &out)
                };
                let sum: f64 = (0..2 * rings).map(rising).sum();
                0.5 * mean_of_pattern(ratio) * TAU * sum
            }
            Distribution::Elliptical { spread, sharpness } => {
                let solid = |phi: f64| 2.0 * (0.5 * elliptical_spread(spread, phi)).sin().powi(2);
                0.5 * (1.0 + sharpness) * 4.0 * integral(0.0, FRAC_PI_2, &solid)
            }
            Distribution::Cone { inner, outer } => {
                // With x = cos theta the falloff is the square of a line from cos outer to where it is 1.
                let width = difference_of_cosines(inner, outer).max(LEAST_FALLOFF);
                let whole = 2.0 * (0.5 * outer).sin().powi(2);
                let sloped = whole.min(width);
                TAU * (sloped.powi(3) / (3.0 * width * width) + (whole - sloped))
            }
            Distribution::Table(ref table) => table.flux(),
        }
    }
}

/// Equation 7 at an angle from the axis, nothing outside the beam.
fn beam(theta: f64, spread: f64, sharpness: f64) -> f64 {
    if theta > spread {
        return 0.0;
    }
    if spread <= 0.0 {
        return 1.0;
    }
    // (cos theta - cos gamma) / (1 - cos gamma) without taking nearly equal numbers from each other.
    let half = (0.5 * spread).sin();
    let inside = (0.5 * (spread + theta)).sin() / half * ((0.5 * (spread - theta)).sin() / half);
    (1.0 - sharpness) * inside + sharpness
}

/// By how much a ratio below 0 narrows petals and dots [1].
fn narrowed(ratio: f64) -> f64 {
    (1.0 - ratio).max(1.0)
}

/// Of a table whose peak is wide nothing is finer than this that matters [rad].
const TABLE_DETAIL: f64 = 0.25;

/// The least difference of cosines over which a spot of glTF fades [1], from the extension's text.
const LEAST_FALLOFF: f64 = 1e-3;

/// cos(a) - cos(b) without taking nearly equal numbers from each other.
fn difference_of_cosines(a: f64, b: f64) -> f64 {
    2.0 * (0.5 * (a + b)).sin() * (0.5 * (b - a)).sin()
}

/// The falloff of a spot of glTF.
fn falloff(theta: f64, inner: f64, outer: f64) -> f64 {
    let width = difference_of_cosines(inner, outer).max(LEAST_FALLOFF);
    let share = difference_of_cosines(theta, outer) / width;
    share.clamp(0.0, 1.0).powi(2)
}

/// Equation 8, a distance from where it is 1 in periods.
fn pattern(periods: f64, ratio: f64) -> f64 {
    let from_middle = (2.0 * periods.rem_euclid(1.0) - 1.0).abs();
    (1.0 - (1.0 - ratio) * (1.0 - from_middle)).max(0.0)
}

/// The mean of equation 8 over a period.
fn mean_of_pattern(ratio: f64) -> f64 {
    match ratio >= 0.0 {
        true => 0.5 * (1.0 + ratio),
        false => 0.5 / (1.0 - ratio),
    }
}

/// Half angle of an elliptical cone at an azimuth, from 1 / tan^2 of it without dividing by a tangent.
fn elliptical_spread([a, b]: [f64; 2], phi: f64) -> f64 {
    let (sin, cos) = phi.sin_cos();
    let along = (cos * a.cos() * b.sin()).hypot(sin * a.sin() * b.cos());
    let wide = a > FRAC_PI_2 || b > FRAC_PI_2;
    (a.sin() * b.sin()).atan2(if wide { -along } else { along })
}

/// Parts whose halves agree this well are not halved any more.
const TOLERANCE: f64 = 1e-14;

/// A part is halved at most so often.
const HALVINGS: u32 = 48;

/// The integral of a function over [a, b]: Gauss-Legendre quadrature of four points on parts that are halved until they agree.
fn integral(a: f64, b: f64, f: &impl Fn(f64) -> f64) -> f64 {
    const NODES: [[f64; 2]; 2] = [
        [0.339_981_043_584_856_26, 0.652_145_154_862_546_2],
        [0.861_136_311_594_052_6, 0.347_854_845_137_453_85],
    ];
    let part = |a: f64, b: f64| {
        let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
        let pair = |[x, w]: &[f64; 2]| w * (f(middle - half * x) + f(middle + half * x));
        half * NODES.iter().map(pair).sum::<f64>()
    };
    let mut sum = 0.0;
    let mut parts = vec![(a, b, part(a, b), HALVINGS)];
    while let Some((a, b, found, halvings)) = parts.pop() {
        let middle = 0.5 * (a + b);
        let (left, right) = (part(a, middle), part(middle, b));
        let finer = left + right;
        if halvings == 0 || (finer - found).abs() <= TOLERANCE * finer.abs().max(sum) {
            sum += finer;
        } else {
            parts.push((a, middle, left, halvings - 1));
            parts.push((middle, b, right, halvings - 1));
        }
    }
    sum
}

fn check_spread(spread: f64) -> Result<()> {
    match (0.0..=PI).contains(&spread) {
        true => Ok(()),
        false => Err(Error::domain(
            "spread",
            format!("{} degrees", spread.to_degrees()),
            "0 to 180 degrees",
            "give the angle from the axis to the edge of the beam",
        )),
    }
}

fn check_sharpness(sharpness: f64) -> Result<()> {
    match (0.0..=1.0).contains(&sharpness) {
        true => Ok(()),
        false => Err(Error::domain(
            "sharpness",
            sharpness,
            "0 to 1",
            "give 0 for a beam that fades out, 1 for one with an edge",
        )),
    }
}

fn check_ratio(ratio: f64) -> Result<()> {
    match ratio.is_finite() && ratio <= 1.0 {
        true => Ok(()),
        false => Err(Error::domain(
            "ratio",
            ratio,
            "the finite numbers up to 1",
            "give the least intensity of a pattern in units of its greatest; below 0 it narrows petals and dots",
        )),
    }
}

fn check_count(name: &str, count: u32, least: u32) -> Result<()> {
    match (least..=Distribution::MOST).contains(&count) {
        true => Ok(()),
        false => Err(Error::domain(
            name,
            count,
            format!("{least} to {}", Distribution::MOST),
            "give the number of periods, in a turn or from the axis to the edge",
        )),
    }
}
