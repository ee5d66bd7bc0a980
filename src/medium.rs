//! What fills the air: shapes, scattering and absorption coefficients, phase functions.

use glam::DVec3;

/// A participating medium. Coefficients of media that overlap add.
#[derive(Debug, Clone, PartialEq)]
pub struct Medium {
    /// Where it is.
    pub shape: Shape,
    /// Scattering coefficient [1/m] of each channel of the working space, finite and not negative.
    pub scattering: DVec3,
    /// Absorption coefficient [1/m] of each channel of the working space, finite and not negative.
    pub absorption: DVec3,
    /// How scattered light spreads over directions.
    pub phase: Phase,
}

/// Where a medium is and how its coefficients vary.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// Homogeneous inside an axis-aligned box [m]; sunlight is attenuated from the box's face.
    Box {
        /// The corner of least coordinates [m].
        min: DVec3,
        /// The corner of greatest coordinates [m].
        max: DVec3,
    },
    /// Homogeneous from the ground up to `top` [m]; sunlight is attenuated from there along the slant.
    Haze {
        /// Height of the upper boundary [m].
        top: f64,
    },
    /// Coefficients fall as exp(-(y - base) / scale_height) over a flat earth.
    Height {
        /// Height at which the coefficients are those given [m].
        base: f64,
        /// Height over which they fall by a factor e [m], positive.
        scale_height: f64,
        /// Distance at which rays that meet nothing end [m], positive.
        far: f64,
    },
}

/// A phase function, normalised: its integral over the sphere is 1 [1/sr].
///
/// `mu` is the cosine between the ray from the eye and the direction toward the sun: +1 looks into the sun.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Phase {
    /// The same in every direction.
    Isotropic,
    /// Molecules.
    Rayleigh,
    /// Henyey & Greenstein 1941, |g| < 1.
    HenyeyGreenstein {
        /// Mean cosine.
        g: f64,
    },
    /// Cornette & Shanks 1992, |g| < 1.
    CornetteShanks {
        /// Parameter; the mean cosine is 3 g (4 + g^2) / (5 (2 + g^2)).
        g: f64,
    },
    /// Nishita et al. 1987, 1 + 9 cos^16(alpha / 2), normalised.
    NishitaHazy,
    /// Nishita et al. 1987, 1 + 50 cos^64(alpha / 2), normalised.
    NishitaMurky,
}

/// No path through the air is followed further than this [m]; a flat, endless haze is as good as opaque long before.
pub const FARTHEST: f64 = 1e9;

/// (1 - e^-x) / x for any x, 1 at 0; stable near 0.
pub fn phi1(x: f64) -> f64 {
    if x.abs() < 1e-8 {
        1.0 - 0.5 * x
    } else {
        -(-x).exp_m1() / x
    }
}

/// source e^-depth, and 0 where nothing gets through however strong (or infinite) the source.
fn attenuated(source: DVec3, depth: DVec3) -> DVec3 {
    let channel = |i: usize| match (-depth[i]).exp() {
        0.0 => 0.0,
        transmittance => source[i] * transmittance,
    };
    DVec3::new(channel(0), channel(1), channel(2))
}

/// The integral of exp(-(start + slope t)) over t from 0 to `length`, whatever the slope's sign.
fn exponential_integral(start: f64, slope: f64, length: f64) -> f64 {
    let change = slope * length;
    if change >= 0.0 {
        (-start).exp() * length * phi1(change)
    } else {
        (-(start + change)).exp() * length * phi1(-change)
    }
}

impl Phase {
    /// The phase function [1/sr] for light that turns by an angle of cosine mu, from 1 - mu (0 to 2).
    ///
    /// `one_minus_mu` is half the squared distance between the ray's direction and the sun's, which keeps its digits
    /// where mu itself is 1 within rounding.
    ///
    /// Sources: Henyey & Greenstein 1941; Cornette & Shanks 1992; Nishita, Miyawaki & Nakamae 1987 (their K left open:
    /// normalised over the sphere it is 1/(8 pi) for hazy and 33/(332 pi) for murky air).
    pub fn value(&self, one_minus_mu: f64) -> f64 {
        use std::f64::consts::PI;
        let mu = 1.0 - one_minus_mu;
        let stretched = |g: f64| {
            let below = 1.0 - g;
            let square = below * below + 2.0 * g * one_minus_mu;
            square * square.sqrt()
        };
        match *self {
            Phase::Isotropic => 1.0 / (4.0 * PI),
            Phase::Rayleigh => 3.0 / (16.0 * PI) * (1.0 + mu * mu),
            Phase::HenyeyGreenstein { g } => (1.0 - g * g) / (4.0 * PI * stretched(g)),
            Phase::CornetteShanks { g } => {
                3.0 * (1.0 - g * g) * (1.0 + mu * mu) / (8.0 * PI * (2.0 + g * g) * stretched(g))
            }
            Phase::NishitaHazy => (1.0 + 9.0 * (0.5 * (1.0 + mu)).powi(8)) / (8.0 * PI),
            Phase::NishitaMurky => 33.0 / (332.0 * PI) * (1.0 + 50.0 * (0.5 * (1.0 + mu)).powi(32)),
        }
    }

    /// The greatest value over all angles [1/sr].
    pub fn peak(&self) -> f64 {
        self.value(0.0).max(self.value(2.0))
    }
}

impl Medium {
    /// Extinction coefficient [1/m]: scattering plus absorption.
    pub fn extinction(&self) -> DVec3 {
        self.scattering + self.absorption
    }
}

/// The air of a scene: its media above its ground.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Air {
    /// The media. Those of the shape haze begin at the ground.
    pub media: Vec<Medium>,
    /// Height of the ground [m].
    pub ground: f64,
}

/// A homogeneous medium as an axis-aligned region, endless where its bounds are infinite.
#[derive(Clone, Copy)]
struct Region {
    min: DVec3,
    max: DVec3,
}

impl Region {
    /// The part of a half-line inside, as distances; an empty one has its end before its start.
    fn chord(&self, origin: DVec3, direction: DVec3) -> (f64, f64) {
        let (mut enter, mut leave) = (0.0f64, f64::INFINITY);
        for axis in 0..3 {
            let (o, d) = (origin[axis], direction[axis]);
            if d == 0.0 {
                if o < self.min[axis] || o > self.max[axis] {
                    return (0.0, -1.0);
                }
                continue;
            }
            let (a, b) = ((self.min[axis] - o) / d, (self.max[axis] - o) / d);
            enter = enter.max(a.min(b));
            leave = leave.min(a.max(b));
        }
        (enter, leave)
    }

    /// Length of the half-line from a point toward the sun inside.
    fn depth(&self, point: DVec3, toward_sun: DVec3) -> f64 {
        let (enter, leave) = self.chord(point, toward_sun);
        (leave - enter).clamp(0.0, FARTHEST)
    }

    /// Distances along a ray at which [`Region::depth`] bends: where the plane of ray and sun meets the region's edges,
    /// and where the ray meets its faces.
    fn bends(&self, origin: DVec3, direction: DVec3, toward_sun: DVec3, out: &mut Vec<f64>) {
        let (enter, leave) = self.chord(origin, direction);
        if leave > enter {
            out.extend([enter, leave]);
        }
        for (a, b, c) in [(0, 1, 2), (0, 2, 1), (1, 2, 0)] {
            let determinant = direction[a] * toward_sun[b] - direction[b] * toward_sun[a];
            if determinant == 0.0 {
                continue;
            }
            for face_a in [self.min[a], self.max[a]] {
                for face_b in [self.min[b], self.max[b]] {
                    let (p, q) = (face_a - origin[a], face_b - origin[b]);
                    let t = (p * toward_sun[b] - q * toward_sun[a]) / determinant;
                    let s = (direction[a] * q - direction[b] * p) / determinant;
                    let third = origin[c] + t * direction[c] + s * toward_sun[c];
                    let slack = 1e-9 * (self.max[c] - self.min[c]);
                    let met = third >= self.min[c] - slack && third <= self.max[c] + slack;
                    if t.is_finite() && s >= 0.0 && (met || slack.is_infinite()) {
                        out.push(t);
                    }
                }
            }
        }
    }
}

impl Air {
    fn region(&self, medium: &Medium) -> Option<Region> {
        match medium.shape {
            Shape::Box { min, max } => Some(Region { min, max }),
            Shape::Haze { top } => Some(Region {
                min: DVec3::new(f64::NEG_INFINITY, self.ground, f64::NEG_INFINITY),
                max: DVec3::new(f64::INFINITY, top, f64::INFINITY),
            }),
            Shape::Height { .. } => None,
        }
    }

    /// Distance beyond which a ray that meets nothing sees no more air [m].
    pub fn end(&self, ray_origin: DVec3, ray_direction: DVec3) -> f64 {
        self.media
            .iter()
            .map(|medium| match (medium.shape, self.region(medium)) {
                (Shape::Height { far, .. }, _) => far,
                (_, Some(region)) => {
                    let (enter, leave) = region.chord(ray_origin, ray_direction);
                    if leave > enter { leave } else { 0.0 }
                }
                _ => 0.0,
            })
            .fold(0.0, f64::max)
            .min(FARTHEST)
    }

    /// Optical depth of the first `distance` metres of a ray [1].
    pub fn optical_depth(&self, origin: DVec3, direction: DVec3, distance: f64) -> DVec3 {
        let mut depth = DVec3::ZERO;
        for medium in &self.media {
            let length = match (medium.shape, self.region(medium)) {
                (
                    Shape::Height {
                        base, scale_height, ..
                    },
                    _,
                ) => Height::new(base, scale_height, origin, direction).length(0.0, distance),
                (_, Some(region)) => {
                    let (enter, leave) = region.chord(origin, direction);
                    (leave.min(distance) - enter).max(0.0)
                }
                _ => 0.0,
            };
            depth += medium.extinction() * length;
        }
        depth
    }

    /// Optical depth from a point to the sun [1]; infinite where a haze or height medium is met by a sun that is not above
    /// the horizon.
    pub fn sun_optical_depth(&self, point: DVec3, toward_sun: DVec3) -> DVec3 {
        let mut depth = DVec3::ZERO;
        for medium in &self.media {
            let length = match (medium.shape, self.region(medium)) {
                (
                    Shape::Height {
                        base, scale_height, ..
                    },
                    _,
                ) => Height::new(base, scale_height, point, DVec3::X).above(0.0, toward_sun.y),
                (_, Some(region)) => region.depth(point, toward_sun),
                _ => 0.0,
            };
            depth += medium.extinction() * length;
        }
        depth
    }
}

/// The exponential profile of a height medium along a ray; lengths are those of air as dense as at the base.
#[derive(Debug, Clone, Copy)]
struct Height {
    start: f64,
    rise: f64,
    scale_height: f64,
}

impl Height {
    fn new(base: f64, scale_height: f64, origin: DVec3, direction: DVec3) -> Self {
        Height {
            start: (origin.y - base) / scale_height,
            rise: direction.y / scale_height,
            scale_height,
        }
    }

    /// Density relative to the base. Far below the base e^600 stands for more (so that lengths stay finite): nothing is
    /// seen through either.
    fn density(&self, t: f64) -> f64 {
        (-(self.start + self.rise * t)).min(600.0).exp()
    }

    /// Length of base air between two distances, from the denser end (so that nothing overflows against a zero).
    fn length(&self, from: f64, to: f64) -> f64 {
        let dense = self.density(from).max(self.density(to));
        dense * (to - from) * phi1((self.rise * (to - from)).abs())
    }

    /// Length of base air from the ray's point at `t` to the sun.
    fn above(&self, t: f64, sun_y: f64) -> f64 {
        if sun_y > 0.0 {
            self.density(t) * self.scale_height / sun_y
        } else {
            f64::INFINITY
        }
    }
}

/// A piece of a ray on which every homogeneous medium is either there or not and its depth toward the sun is linear.
#[derive(Debug, Clone)]
struct Piece {
    from: f64,
    to: f64,
    /// Optical depth eye to point to sun, of the homogeneous media: at `from` and its slope.
    depth: DVec3,
    slope: DVec3,
    /// Sum of scattering coefficient times phase function [1/(m sr)] of the homogeneous media.
    source: DVec3,
}

struct HeightTerm {
    profile: Height,
    extinction: DVec3,
    source: DVec3,
}

/// Sunlight scattered once toward the eye along one ray, ready to be integrated over lit runs.
///
/// The integrand is the sum over media of sigma_s p(mu) e^-(tau_eye + tau_sun). Homogeneous media make the exponent piecewise
/// linear; a height medium alone has a closed form too (its exponent is linear in its own optical depth); mixtures are
/// integrated by Gauss-Legendre quadrature on short enough parts.
pub struct Scattering {
    pieces: Vec<Piece>,
    heights: Vec<HeightTerm>,
    sun_y: f64,
}

impl Scattering {
    /// Prepares the first `distance` metres of a ray under a sun.
    pub fn new(
        air: &Air,
        origin: DVec3,
        direction: DVec3,
        distance: f64,
        toward_sun: DVec3,
    ) -> Self {
        let one_minus_mu = 0.5 * (direction - toward_sun).length_squared();
        let distance = distance.min(FARTHEST);
        let mut borders = vec![0.0, distance];
        let mut heights = Vec::new();
        let mut regions = Vec::new();
        for medium in &air.media {
            let source = medium.scattering * medium.phase.value(one_minus_mu);
            let extinction = medium.extinction();
            match (medium.shape, air.region(medium)) {
                (
                    Shape::Height {
                        base, scale_height, ..
                    },
                    _,
                ) => heights.push(HeightTerm {
                    profile: Height::new(base, scale_height, origin, direction),
                    extinction,
                    source,
                }),
                (_, Some(region)) => {
                    region.bends(origin, direction, toward_sun, &mut borders);
                    regions.push((region, extinction, source));
                }
                _ => {}
            }
        }
        borders.retain(|t| (0.0..=distance).contains(t));
        borders.sort_unstable_by(f64::total_cmp);
        let mut pieces = Vec::with_capacity(borders.len());
        let mut eye_depth = DVec3::ZERO;
        for pair in borders.windows(2) {
            let (from, to) = (pair[0], pair[1]);
            let length = to - from;
            if length <= 0.0 {
                continue;
            }
            let mut piece = Piece {
                from,
                to,
                depth: eye_depth,
                slope: DVec3::ZERO,
                source: DVec3::ZERO,
            };
            // Both samples lie inside the piece: at its ends the depth may jump (a face parallel to the sun's rays).
            let inner = [0.25, 0.75].map(|f| origin + (from + f * length) * direction);
            let middle = origin + (from + 0.5 * length) * direction;
            for (region, extinction, source) in &regions {
                let [a, b] = inner.map(|p| region.depth(p, toward_sun));
                let inside = middle.cmpge(region.min).all() && middle.cmple(region.max).all();
                let slope = (b - a) / (0.5 * length);
                piece.depth += *extinction * (a - 0.25 * length * slope).max(0.0);
                piece.slope += *extinction * slope;
                if inside {
                    piece.slope += *extinction;
                    piece.source += *source;
                    eye_depth += *extinction * length;
                }
            }
            pieces.push(piece);
        }
        Scattering {
            pieces,
            heights,
            sun_y: toward_sun.y,
        }
    }

    /// The integral over the lit part [from, to] of the ray [1/sr]: times the sun's illuminance it is radiance.
    pub fn integrate(&self, from: f64, to: f64) -> DVec3 {
        let mut sum = DVec3::ZERO;
        for piece in &self.pieces {
            let (a, b) = (from.max(piece.from), to.min(piece.to));
            if b > a {
                sum += self.integrate_piece(piece, a, b);
            }
        }
        sum
    }

    fn integrate_piece(&self, piece: &Piece, a: f64, b: f64) -> DVec3 {
        let start = piece.depth + piece.slope * (a - piece.from);
        if self.heights.is_empty() {
            if piece.source == DVec3::ZERO {
                return DVec3::ZERO;
            }
            let channel =
                |i: usize| exponential_integral(start[i], piece.slope[i], b - a) * piece.source[i];
            let first = channel(0);
            let grey = |v: DVec3| v.x == v.y && v.y == v.z;
            return if grey(start) && grey(piece.slope) && grey(piece.source) {
                DVec3::splat(first)
            } else {
                DVec3::new(first, channel(1), channel(2))
            };
        }
        if let [term] = &self.heights[..]
            && start == DVec3::ZERO
            && piece.slope == DVec3::ZERO
            && piece.source == DVec3::ZERO
        {
            return term.integrate(a, b, self.sun_y);
        }
        self.quadrature(piece, a, b)
    }

    /// Optical depth from the eye to the point at `t` and on to the sun.
    fn depth(&self, piece: &Piece, t: f64) -> DVec3 {
        let homogeneous = piece.depth + piece.slope * (t - piece.from);
        self.heights.iter().fold(homogeneous, |depth, term| {
            let length = term.profile.length(0.0, t) + term.profile.above(t, self.sun_y);
            depth + term.extinction * length
        })
    }

    fn integrand(&self, piece: &Piece, t: f64) -> DVec3 {
        let source = self.heights.iter().fold(piece.source, |source, term| {
            source + term.source * term.profile.density(t)
        });
        attenuated(source, self.depth(piece, t))
    }

    /// Gauss-Legendre quadrature on parts over which neither the optical depth nor a density changes by more than a factor
    /// e, found by halving; where the optical depth is beyond [`OPAQUE`] nothing is added. On such parts the integrand is
    /// nearly a polynomial, and eight points leave a relative error below 1e-11.
    fn quadrature(&self, piece: &Piece, a: f64, b: f64) -> DVec3 {
        const START: usize = 8;
        let densities = |t: f64| self.heights.iter().map(move |h| h.profile.density(t));
        let cut = |i: usize| a + (b - a) * i as f64 / START as f64;
        let mut parts: Vec<(f64, f64, u32)> =
            (0..START).map(|i| (cut(i), cut(i + 1), 64)).collect();
        let mut sum = DVec3::ZERO;
        while let Some((from, to, halvings)) = parts.pop() {
            let (first, last) = (self.depth(piece, from), self.depth(piece, to));
            let seen = first.min(last).cmplt(DVec3::splat(OPAQUE));
            if !seen.any() {
                continue;
            }
            let uneven = (0..3).any(|i| seen.test(i) && (last[i] - first[i]).abs() > 1.0);
            let steep = densities(from)
                .zip(densities(to))
                .any(|(p, q)| p.max(q) > std::f64::consts::E * p.min(q));
            if halvings > 0 && (uneven || steep) {
                let middle = 0.5 * (from + to);
                parts.push((from, middle, halvings - 1));
                parts.push((middle, to, halvings - 1));
                continue;
            }
            sum += gauss(from, to, &|t| self.integrand(piece, t));
        }
        sum
    }
}

/// An optical depth through which nothing is seen: e^-100 of the sun is less than a photon.
const OPAQUE: f64 = 100.0;

impl HeightTerm {
    /// The closed form: with Psi = tau_eye + beta H / w_y, the integral of beta e^-Psi over the run is
    /// e^-Psi(a) dTau phi1(dTau (1 - r_y / w_y)), dTau the run's own optical depth.
    fn integrate(&self, a: f64, b: f64, sun_y: f64) -> DVec3 {
        if sun_y <= 0.0 {
            return DVec3::ZERO;
        }
        let run = self.profile.length(a, b);
        let ahead = self.profile.length(0.0, a) + self.profile.above(a, sun_y);
        let turn = 1.0 - self.profile.rise * self.profile.scale_height / sun_y;
        let channel = |i: usize| {
            let extinction = self.extinction[i];
            // Per unit of optical depth, the exponent changes by `turn`.
            exponential_integral(extinction * ahead, turn * extinction, run) * self.source[i]
        };
        DVec3::new(channel(0), channel(1), channel(2))
    }
}

/// Eight-point Gauss-Legendre quadrature.
fn gauss(a: f64, b: f64, f: &impl Fn(f64) -> DVec3) -> DVec3 {
    const NODES: [[f64; 2]; 4] = [
        [0.183_434_642_495_649_8, 0.362_683_783_378_362],
        [0.525_532_409_916_329, 0.313_706_645_877_887_3],
        [0.796_666_477_413_626_7, 0.222_381_034_453_374_48],
        [0.960_289_856_497_536_3, 0.101_228_536_290_376_26],
    ];
    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
    NODES
        .iter()
        .map(|[x, w]| *w * (f(middle - half * x) + f(middle + half * x)))
        .sum::<DVec3>()
        * half
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A dull midpoint rule over what the definition says, to judge the closed forms by.
    fn midpoint(air: &Air, o: DVec3, r: DVec3, a: f64, b: f64, sun: DVec3, n: usize) -> DVec3 {
        let one_minus_mu = 0.5 * (r - sun).length_squared();
        (0..n)
            .map(|i| {
                let t = a + (b - a) * (i as f64 + 0.5) / n as f64;
                let p = o + t * r;
                let mut source = DVec3::ZERO;
                for medium in &air.media {
                    let density = match medium.shape {
                        Shape::Box { min, max } => {
                            f64::from(u8::from(p.cmpge(min).all() && p.cmple(max).all()))
                        }
                        Shape::Haze { top } => f64::from(u8::from(p.y >= air.ground && p.y <= top)),
                        Shape::Height {
                            base, scale_height, ..
                        } => (-(p.y - base) / scale_height).exp(),
                    };
                    source += medium.scattering * density * medium.phase.value(one_minus_mu);
                }
                let depth = air.optical_depth(o, r, t) + air.sun_optical_depth(p, sun);
                source * (-depth).exp()
            })
            .sum::<DVec3>()
            * ((b - a) / n as f64)
    }

    fn medium(shape: Shape, scattering: DVec3) -> Medium {
        Medium {
            shape,
            scattering,
            absorption: DVec3::splat(0.003),
            phase: Phase::HenyeyGreenstein { g: 0.6 },
        }
    }

    #[test]
    fn every_phase_function_integrates_to_one() {
        let phases = [
            Phase::Isotropic,
            Phase::Rayleigh,
            Phase::HenyeyGreenstein { g: 0.9 },
            Phase::HenyeyGreenstein { g: -0.5 },
            Phase::CornetteShanks { g: 0.8 },
            Phase::NishitaHazy,
            Phase::NishitaMurky,
        ];
        for phase in phases {
            let n = 4000;
            let sum: f64 = (0..n)
                .map(|i| {
                    let (a, b) = (i as f64 / n as f64, (i + 1) as f64 / n as f64);
                    // Cubed, so that the peak at 0 is well covered.
                    let f = |x: f64| DVec3::splat(phase.value(2.0 * x * x * x) * 6.0 * x * x);
                    gauss(a, b, &f).x
                })
                .sum();
            let total = 2.0 * std::f64::consts::PI * sum;
            assert!((total - 1.0).abs() < 1e-10, "{phase:?}: {total}");
        }
    }

    #[test]
    fn pieces_agree_with_the_definition_for_boxes_haze_and_height() {
        let room = Shape::Box {
            min: DVec3::new(-4.0, 0.0, -5.0),
            max: DVec3::new(4.0, 4.0, 5.0),
        };
        let height = Shape::Height {
            base: 0.0,
            scale_height: 7.0,
            far: 1e3,
        };
        let grey = DVec3::splat(0.04);
        let colored = DVec3::new(0.02, 0.05, 0.11);
        let airs = [
            vec![medium(room, grey)],
            vec![medium(Shape::Haze { top: 6.0 }, colored)],
            vec![medium(height, colored)],
            vec![
                medium(room, grey),
                medium(Shape::Haze { top: 3.0 }, colored),
                medium(height, grey),
            ],
        ];
        let suns = [
            DVec3::new(0.3, 0.5, -0.8),
            DVec3::new(-0.9, 0.1, 0.2),
            DVec3::Y,
        ];
        let rays = [
            (DVec3::new(0.5, 1.5, 9.0), DVec3::new(0.1, 0.02, -1.0)),
            (DVec3::new(-7.0, 2.0, 1.0), DVec3::new(1.0, 0.0, 0.0)),
            (DVec3::new(0.0, 2.0, 0.0), DVec3::new(0.0, -1e-9, 1.0)),
            (DVec3::new(0.0, 9.0, 0.0), DVec3::new(0.2, -1.0, 0.3)),
        ];
        for media in airs {
            let air = Air { media, ground: 0.0 };
            for sun in suns.map(DVec3::normalize) {
                for (o, r) in rays {
                    let r = r.normalize();
                    for (a, b) in [(0.0, 8.0), (1.3, 15.7)] {
                        let exact = Scattering::new(&air, o, r, 20.0, sun).integrate(a, b);
                        let dull = midpoint(&air, o, r, a, b, sun, 40_000);
                        let error = (exact - dull).abs().max_element();
                        // The midpoint rule misses a box's edge by up to half a step.
                        let allowed = 2e-4 * dull.max_element() + 1e-12;
                        assert!(error <= allowed, "{air:?} {o} {r} {sun}: {exact} {dull}");
                    }
                }
            }
        }
    }

    #[test]
    fn extreme_optical_depths_stay_finite() {
        let sun = DVec3::new(0.0, 1e-9, 1.0).normalize();
        for scattering in [0.0, 1e-300, 1e-12, 1e5, 1e300] {
            for r in [DVec3::Z, DVec3::X, DVec3::NEG_Y, sun, -sun] {
                let mut fog = medium(Shape::Haze { top: 1e3 }, DVec3::splat(scattering));
                fog.absorption = DVec3::ZERO;
                let mut thin = fog.clone();
                thin.shape = Shape::Height {
                    base: 0.0,
                    scale_height: 50.0,
                    far: 1e5,
                };
                for media in [vec![fog.clone()], vec![thin.clone()], vec![fog, thin]] {
                    let air = Air {
                        media,
                        ground: -10.0,
                    };
                    let sum = Scattering::new(&air, DVec3::Y * 9e3, r, FARTHEST, sun)
                        .integrate(0.0, FARTHEST);
                    assert!(
                        sum.is_finite() && sum.min_element() >= 0.0,
                        "{scattering} {r} {sum}"
                    );
                    let depth = air.optical_depth(DVec3::Y * 9e3, r, FARTHEST);
                    assert!(!(-depth).exp().is_nan(), "{depth}");
                }
            }
        }
    }
}
