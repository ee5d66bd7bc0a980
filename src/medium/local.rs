//! Light of a local beam scattered once toward the eye along one ray.
//!
//! L = I integral of sum_i sigma_s,i(t) p_i(mu(t)) e^-(tau_eye + tau_beam) / d(t)^2 dt over the lit part of the ray, d the distance
//! to where the light comes from, at least the beam's radius. With h its distance from the ray, t_0 its foot on it and t = t_0 + h tan(theta),
//! dt / d^2 = d theta / h: in theta there is no peak however near the light is (Nishita, Miyawaki & Nakamae 1987; Pegoraro & Parker
//! 2009). Between the faces of media the integrand is smooth: Gauss-Kronrod quadrature on parts that are halved until both rules agree.

use super::body::Body;
use super::exponential::kronrod;
use super::height::HeightTerm;
use super::line::Line;
use super::{Air, FARTHEST, Medium};
use glam::DVec3;
use std::f64::consts::PI;

/// Parts on which both rules agree this well are not halved any more, where nothing else is asked for.
const TOLERANCE: f64 = 1e-9;

/// A part is halved at most so often.
const HALVINGS: u32 = 40;

/// A lit run begins with no more parts than this, whatever the pattern.
const MOST_PARTS: f64 = 256.0;

/// An optical depth through which nothing is seen.
const OPAQUE: f64 = 100.0;

/// Parts over which the optical depth from the eye grows by more than this are halved.
const STEEP: f64 = 4.0;

/// Where a ray enters and leaves the sphere around the light inside of which it gets no brighter, if it does.
fn within(foot: f64, aside: f64, radius: f64) -> Vec<f64> {
    let square = radius * radius - aside * aside;
    match square > 0.0 {
        true => vec![foot - square.sqrt(), foot + square.sqrt()],
        false => Vec::new(),
    }
}

/// How luminous intensity goes by direction.
#[derive(Clone, Copy)]
pub struct Pattern<'a> {
    /// That along a unit vector away from the light [1].
    pub shape: &'a (dyn Fn(DVec3) -> f64 + Sync),
    /// About how wide the finest of it is [rad].
    pub detail: f64,
}

/// A medium along the ray.
struct Term<'a> {
    medium: &'a Medium,
    extinction: DVec3,
    profile: Profile,
    /// Where it begins and ends along the ray, and between them often enough that no wave of it goes by unseen [m].
    borders: Vec<f64>,
}

/// How dense a medium is along the ray.
enum Profile {
    Within(Line),
    Thinning(HeightTerm),
}

impl<'a> Term<'a> {
    fn new(
        air: &Air,
        medium: &'a Medium,
        origin: DVec3,
        direction: DVec3,
        distance: f64,
    ) -> Option<Self> {
        let extinction = medium.extinction();
        let mut borders = Vec::new();
        let profile = match air.body(medium) {
            Some(body) => {
                let chords = body.chords(origin, direction, distance);
                borders.extend(chords.iter().flat_map(|chord| [chord.from, chord.to]));
                if let Body::Layer(layer) = body
                    && let (Some(first), Some(last)) = (chords.first(), chords.last())
                {
                    borders.extend(layer.grid(first.from, last.to));
                }
                Profile::Within(Line::new(chords))
            }
            None => Profile::Thinning(HeightTerm::new(
                medium,
                origin,
                direction,
                DVec3::Y,
                DVec3::ZERO,
            )?),
        };
        Some(Term {
            medium,
            extinction,
            profile,
            borders,
        })
    }

    /// Optical depth from the eye [1].
    fn depth(&self, t: f64) -> DVec3 {
        match &self.profile {
            Profile::Within(line) => self.extinction * line.length(t),
            Profile::Thinning(term) => term.eye_depth(t),
        }
    }

    /// Density at `t`, in a part of the ray whose middle says whether it is there.
    fn density(&self, t: f64, middle: f64) -> f64 {
        match &self.profile {
            Profile::Within(line) => line.density_beside(t, middle),
            Profile::Thinning(term) => term.profile.density(t),
        }
    }
}

/// A ray under the light of a place near by.
pub struct LocalScattering<'a> {
    air: &'a Air,
    media: Vec<Term<'a>>,
    pattern: Option<Pattern<'a>>,
    tolerance: f64,
    origin: DVec3,
    direction: DVec3,
    position: DVec3,
    /// Distance along the ray of the foot of `position`, and how far that is from the ray, at least the radius [m].
    foot: f64,
    aside: f64,
    /// Where the ray enters or leaves a medium, or the pattern bends [m].
    borders: Vec<f64>,
}

impl<'a> LocalScattering<'a> {
    /// The first `distance` metres of a ray under light from a place, the same in all directions; nearer to it than `radius` [m] it
    /// gets no brighter.
    pub fn new(
        air: &'a Air,
        origin: DVec3,
        direction: DVec3,
        distance: f64,
        position: DVec3,
        radius: f64,
    ) -> Self {
        let foot = (position - origin).dot(direction);
        let aside = (position - origin).cross(direction).length();
        let media: Vec<Term> = air
            .media
            .iter()
            .filter_map(|medium| Term::new(air, medium, origin, direction, distance.min(FARTHEST)))
            .collect();
        let mut borders: Vec<f64> = media
            .iter()
            .flat_map(|term| &term.borders)
            .copied()
            .chain(within(foot, aside, radius))
            .filter(|t| (0.0..=distance).contains(t))
            .collect();
        borders.sort_unstable_by(f64::total_cmp);
        LocalScattering {
            air,
            media,
            pattern: None,
            tolerance: TOLERANCE,
            origin,
            direction,
            position,
            foot,
            // On a ray through the light there is no angle.
            aside: aside.max(radius).max(1e-9 * (1.0 + foot.abs())),
            borders,
        }
    }

    /// The same under light whose intensity goes by a pattern with kinks at `bends` [m along the ray], to a relative error of about
    /// `tolerance`.
    pub fn shaped(mut self, pattern: Pattern<'a>, bends: &[f64], tolerance: f64) -> Self {
        self.pattern = Some(pattern);
        self.tolerance = tolerance;
        self.borders.extend_from_slice(bends);
        self.borders.sort_unstable_by(f64::total_cmp);
        self
    }

    /// The integral over the lit part [from, to] of the ray [1/(m2 sr)]: times the luminous intensity it is luminance.
    pub fn integrate(&self, from: f64, to: f64) -> DVec3 {
        let parts = self.parts(from, to);
        parts.map(|[from, to]| self.part(from, to)).sum()
    }

    /// The same by a few nodes of each part, evenly in the angle that the light sees (Kulla & Fajardo 2012), whatever that
    /// misses; each node is a place between -1 and 1 with its weight.
    pub fn sample(&self, from: f64, to: f64, nodes: &[[f64; 2]]) -> DVec3 {
        let parts = self.parts(from, to);
        let sum = |[from, to]: [f64; 2]| {
            let middle = 0.5 * (from + to);
            let (first, last) = (self.angle(from), self.angle(to));
            let (mean, half) = (0.5 * (first + last), 0.5 * (last - first));
            let node = |[x, weight]: &[f64; 2]| {
                let t = self.place(mean + half * x).clamp(from, to);
                half * weight * self.rate(t) * self.scattered(t, middle)
            };
            nodes.iter().map(node).sum::<DVec3>()
        };
        parts.map(sum).sum()
    }

    /// The parts of a lit run between borders.
    fn parts(&self, from: f64, to: f64) -> impl Iterator<Item = [f64; 2]> {
        let to = to.min(FARTHEST);
        let inner = self.borders.iter().copied();
        let mut from = from;
        inner
            .filter(move |t| (from..to).contains(t))
            .chain([to])
            .map(move |end| [std::mem::replace(&mut from, end), end])
            .filter(|[from, to]| to > from)
    }

    /// The angle under which the light sees a place of the ray, from the nearest on [rad].
    fn angle(&self, t: f64) -> f64 {
        (t - self.foot).atan2(self.aside)
    }

    fn place(&self, angle: f64) -> f64 {
        self.foot + self.aside * angle.tan()
    }

    /// How fast places go by the angle [m/rad].
    fn rate(&self, t: f64) -> f64 {
        self.aside + (t - self.foot).powi(2) / self.aside
    }

    fn part(&self, from: f64, to: f64) -> DVec3 {
        let place = |theta: f64| self.place(theta).clamp(from, to);
        let middle = 0.5 * (from + to);
        let value = |theta: f64| {
            let t = place(theta);
            self.rate(t) * self.scattered(t, middle)
        };
        let (first, last) = (self.angle(from), self.angle(to));
        // Nothing that is as wide as a half of a part falls between the points.
        let wide = self.pattern.map_or(PI, |pattern| pattern.detail);
        let count = ((last - first) / (2.0 * wide))
            .ceil()
            .clamp(1.0, MOST_PARTS) as u32;
        let cut = |i: u32| first + (last - first) * f64::from(i) / f64::from(count);
        let mut sum = DVec3::ZERO;
        let mut scale = 0.0f64;
        let mut parts: Vec<(f64, f64, u32)> = (0..count)
            .rev()
            .map(|i| (cut(i), cut(i + 1), HALVINGS))
            .collect();
        while let Some((a, b, halvings)) = parts.pop() {
            let (before, after) = (self.eye_depth(place(a)), self.eye_depth(place(b)));
            if before.min_element() > OPAQUE {
                continue;
            }
            // Where only the first skin of a part is seen, both rules may agree that they saw nothing.
            let rise = |i: usize| after[i].min(OPAQUE) - before[i].min(OPAQUE);
            let is_steep = (0..3).any(|i| rise(i) > STEEP);
            if halvings == 0 || !is_steep {
                let (found, off) = kronrod(a, b, &value);
                scale = scale.max(found.max_element());
                let agree = off <= self.tolerance * scale.max(sum.max_element());
                if halvings == 0 || agree || !off.is_finite() {
                    sum += found;
                    continue;
                }
            }
            let m = 0.5 * (a + b);
            parts.push((m, b, halvings - 1));
            parts.push((a, m, halvings - 1));
        }
        sum
    }

    /// What the media send from a place of the ray for a luminous intensity of 1, in a part of the ray whose middle says which of
    /// them are there [1/(m3 sr)]. Nearer to the light than its radius they get no more than there, as
    /// [`crate::beam::Beam::illuminance_at`] has it.
    fn scattered(&self, t: f64, middle: f64) -> DVec3 {
        let point = self.origin + t * self.direction;
        let way = self.position - point;
        let distance = way.length();
        // On a ray through a point of light, no nearer than the ray is taken to pass it.
        let square = way.length_squared().max(self.aside * self.aside);
        let toward = way.try_normalize().unwrap_or(DVec3::Y);
        let shape = self.pattern.map_or(1.0, |pattern| (pattern.shape)(-toward));
        if shape == 0.0 {
            return DVec3::ZERO;
        }
        let one_minus_mu = 0.5 * (self.direction - toward).length_squared();
        let source: DVec3 = self
            .media
            .iter()
            .map(|term| {
                let medium = term.medium;
                medium.scattering * (medium.phase.value(one_minus_mu) * term.density(t, middle))
            })
            .sum();
        if source == DVec3::ZERO {
            return DVec3::ZERO;
        }
        let depth = self.eye_depth(t) + self.air.optical_depth(point, toward, distance);
        shape * source * (-depth).exp() / square
    }

    /// Optical depth from the eye to a place of the ray [1].
    fn eye_depth(&self, t: f64) -> DVec3 {
        self.media.iter().map(|term| term.depth(t)).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::beam::Beam;
    use crate::medium::{Phase, Scattering, Shape};

    fn cube(scattering: f64, absorption: f64) -> Air {
        Air {
            media: vec![Medium {
                shape: Shape::Box {
                    min: DVec3::splat(-50.0),
                    max: DVec3::splat(50.0),
                },
                scattering: DVec3::splat(scattering),
                absorption: DVec3::splat(absorption),
                phase: Phase::Isotropic,
            }],
            ground: -50.0,
        }
    }

    #[test]
    fn in_thin_isotropic_air_it_is_the_angle_that_the_lamp_sees() {
        // L = sigma I / (4 pi) (theta_2 - theta_1) / h.
        let air = cube(1e-9, 0.0);
        for (aside, from, to) in [(3.0, 0.0, 20.0), (1e-4, 1.0, 30.0), (7.0, 12.0, 13.0)] {
            let lamp = DVec3::new(aside, 0.0, 10.0);
            let beam = Beam::local(lamp, DVec3::ONE);
            let found =
                Scattering::new(&air, DVec3::ZERO, DVec3::Z, 40.0, &beam).integrate(from, to);
            let angle = |t: f64| ((t - 10.0) / aside).atan();
            let exact = 1e-9 / (4.0 * PI) * (angle(to) - angle(from)) / aside;
            assert!(
                (found.x / exact - 1.0).abs() < 1e-6,
                "{aside}: {} {exact}",
                found.x
            );
        }
    }

    #[test]
    fn a_ray_through_a_lamp_is_finite() {
        let air = cube(0.1, 0.02);
        for radius in [0.0, 1e-3, 0.5] {
            let beam = Beam::Local {
                position: DVec3::new(0.0, 0.0, 10.0),
                intensity: DVec3::ONE,
                radius,
            };
            let found =
                Scattering::new(&air, DVec3::ZERO, DVec3::Z, 40.0, &beam).integrate(0.0, 40.0);
            assert!(found.is_finite() && found.x > 0.0, "{radius}: {found}");
            assert!(found.as_vec3().is_finite(), "{radius}: {found}");
        }
    }

    #[test]
    fn a_far_lamp_in_front_of_the_fog_is_a_sun() {
        // Compared before the fog, since the way from a far lamp through it is that of parallel light.
        let mut air = cube(0.02, 0.005);
        air.media[0].phase = Phase::HenyeyGreenstein { g: 0.5 };
        let toward = DVec3::new(0.6, 0.64, 0.48);
        let far = 1e7;
        let (origin, direction) = (DVec3::new(-3.0, 1.0, -20.0), DVec3::new(0.0, 0.6, 0.8));
        let of =
            |beam: &Beam| Scattering::new(&air, origin, direction, 30.0, beam).integrate(2.0, 30.0);
        let sun = of(&Beam::parallel(toward, DVec3::ONE));
        let lamp = of(&Beam::local(far * toward, DVec3::ONE)) * far * far;
        assert!((lamp.x / sun.x - 1.0).abs() < 1e-5, "{} {}", lamp.x, sun.x);
    }
}
