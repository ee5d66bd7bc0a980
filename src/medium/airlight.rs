//! Light of a point lamp scattered once toward the eye by homogeneous air that scatters alike in all directions, in closed form.
//!
//! With t along the ray, t_0 the foot of the lamp on it, p its distance from it, y = t - t_0 and d = sqrt(p^2 + y^2), the luminance of the
//! run from t_1 to t_2 is sigma_s I / (4 pi) times the integral of e^(-sigma (t + d)) / d^2 dt. The substitution w = y + d (the tangent of
//! half the lamp's angle, times p: Sun et al. 2005, Pegoraro & Parker 2009) makes t + d = t_0 + w and dt / d^2 = 2 dw / (w^2 + p^2), so that
//!
//! integral = 2 e^(-sigma (t_1 + d_1)) (H(w_1) - e^(-sigma (w_2 - w_1)) H(w_2)),
//!
//! H(w) = integral from w on of e^(-sigma (u - w)) / (u^2 + p^2) du = Im(e^z E_1(z)) / p at z = sigma (w - i p).
//!
//! This is Sun's F(sigma p, v) with tan v = w / p; scaled like that nothing overflows or becomes 0 too early, wherever the lamp is.

use super::shape::FARTHEST;
use glam::DVec3;
use std::ops::{Add, Div, Mul, Sub};

/// A lamp is never nearer to a ray than this [m]: on a ray through a point of light there is no finite luminance.
const NEAREST: f64 = 1e-9;

/// On runs shorter than this share of all lengths of the integrand it is nearly a polynomial.
const SHORT: f64 = 0.1;

/// Optical depths along which nothing is lost.
const CLEAR: f64 = 1e-12;

/// A ray beside a point lamp.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Airlight {
    /// Distance along the ray of the lamp's foot on it [m].
    foot: f64,
    /// Distance of the lamp from the ray [m].
    aside: f64,
}

/// A run of a ray in the variable w.
struct Run {
    /// The way from the eye over the run's first point to the lamp [m].
    way: f64,
    /// w at both ends, and what lies between them without taking one from the other [m].
    first: f64,
    last: f64,
    length: f64,
}

impl Airlight {
    /// Of a ray from `origin` along the unit vector `direction` beside a lamp at a position [m], which it is taken to pass no nearer
    /// than `least` [m] (a lamp's radius, or 0).
    pub fn new(origin: DVec3, direction: DVec3, lamp: DVec3, least: f64) -> Self {
        let toward = lamp - origin;
        let foot = toward.dot(direction);
        // The rejection keeps digits that the square of the distance less that of the foot would lose.
        let aside = toward.cross(direction).length();
        Airlight {
            foot,
            aside: aside.max(least).max(NEAREST),
        }
    }

    fn run(&self, from: f64, to: f64) -> Run {
        let p = self.aside;
        let [a, b] = [from - self.foot, to - self.foot];
        let [near, far] = [a, b].map(|y| y.hypot(p));
        let w = |y: f64, d: f64| if y < 0.0 { p * (p / (d - y)) } else { y + d };
        let (first, last) = (w(a, near), w(b, far));
        Run {
            way: from + near,
            first,
            last,
            length: (to - from) * ((first + last) / (near + far)),
        }
    }

    /// The integral of e^(-extinction (t + d)) / d^2 over the run of the ray between two distances [1/m]: times scattering coefficient
    /// and luminous intensity over 4 pi it is luminance. `extinction` from 0 [1/m], distances from 0 [m].
    ///
    /// Within 1e-9 for extinctions up to 1e5 / m and lamps from 1e-9 m to 10 km beside the ray, and 0 where that is below all numbers.
    pub fn exact(&self, extinction: f64, from: f64, to: f64) -> f64 {
        let to = to.min(FARTHEST);
        if to <= from {
            return 0.0;
        }
        let (p, run) = (self.aside, self.run(from, to));
        let reaching = 2.0 * (-extinction * run.way).exp();
        if reaching == 0.0 {
            return 0.0;
        }
        let scale = run.first.hypot(p);
        if run.length * extinction < SHORT && run.length < SHORT * scale {
            let inside = |share: f64| {
                let u = run.length * share;
                let w = run.first + u;
                (-extinction * u).exp() / (w * w + p * p)
            };
            let sum: f64 = super::exponential::NODES
                .iter()
                .map(|[x, weight]| weight * (inside(0.5 * (1.0 - x)) + inside(0.5 * (1.0 + x))))
                .sum();
            return reaching * 0.5 * run.length * sum;
        }
        if extinction * (run.last + p) < CLEAR {
            return 0.5 * reaching * self.angle(&run);
        }
        let rest = |w: f64| scaled_e1(Complex(extinction * w, -extinction * p)).1 / p;
        let passed = (-extinction * run.length).exp();
        let beyond = if passed > 0.0 {
            passed * rest(run.last)
        } else {
            0.0
        };
        reaching * (rest(run.first) - beyond).max(0.0)
    }

    /// The integral of 1 / d^2 over a run [1/m]: the angle under which the lamp sees it, over p.
    fn angle(&self, run: &Run) -> f64 {
        let p = self.aside;
        // Twice the angle of tangents w / p; a run of a few p is far from where an arc tangent loses digits.
        2.0 * (p * run.length).atan2(p * p + run.first * run.last) / p
    }

    /// Packard's glow (2004), corrected, for [`Airlight::exact`]: the angle under which the lamp sees the run, over its distance from the ray.
    ///
    /// The paper drops 1 / p, swaps the ends, takes the eye's side without its sign, and leaves out what the air swallows on the way.
    /// Here the run is as bright as if all of its light had gone the mean way m, which light without loss goes:
    ///
    /// e^(-sigma m) (angle / p), m = t_0 + ln((w_2^2 + p^2) / (w_1^2 + p^2)) / (angle / p).
    ///
    /// It is never above the exact integral (by Jensen's inequality), and below by no more than [`Airlight::glow_error`].
    pub fn glow(&self, extinction: f64, from: f64, to: f64) -> f64 {
        let to = to.min(FARTHEST);
        if to <= from {
            return 0.0;
        }
        let run = self.run(from, to);
        let angle = self.angle(&run);
        angle * (-extinction * (run.way + self.mean(&run, angle))).exp()
    }

    /// A bound of the relative error of [`Airlight::glow`] [1]: sigma^2 / 2 times the variance of the way, times e^(sigma (mean - least
    /// way)), and never more than what is lost between the least and the mean way. Choose the glow only where this is within tolerance.
    pub fn glow_error(&self, extinction: f64, from: f64, to: f64) -> f64 {
        let to = to.min(FARTHEST);
        if to <= from {
            return 0.0;
        }
        let (p, run) = (self.aside, self.run(from, to));
        let angle = self.angle(&run);
        let mean = self.mean(&run, angle);
        // The mean of w^2 - w_1^2, less what belongs to the mean of w.
        let square = 2.0 * run.length / angle - (run.first * run.first + p * p);
        let variance = (square - mean * (mean + 2.0 * run.first)).max(0.0);
        let lost = extinction * mean;
        let bound = 0.5 * extinction * extinction * variance * lost.exp();
        bound.min(-(-lost).exp_m1())
    }

    /// The mean over a run of the way's excess over that of its first point, w - w_1 [m].
    fn mean(&self, run: &Run, angle: f64) -> f64 {
        let p = self.aside;
        let grown = run.length * (run.first + run.last) / (run.first * run.first + p * p);
        (grown.ln_1p() / angle - run.first).clamp(0.0, run.length)
    }
}

/// A complex number.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Complex(f64, f64);

impl Complex {
    fn size(self) -> f64 {
        self.0.hypot(self.1)
    }
}

impl Add for Complex {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Complex(self.0 + other.0, self.1 + other.1)
    }
}

impl Sub for Complex {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Complex(self.0 - other.0, self.1 - other.1)
    }
}

impl Mul for Complex {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Complex(
            self.0 * other.0 - self.1 * other.1,
            self.0 * other.1 + self.1 * other.0,
        )
    }
}

impl Div for Complex {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        // Scaled, so that the square of what divides stays a number.
        let scale = other.size();
        let unit = Complex(other.0 / scale, -other.1 / scale);
        let Complex(re, im) = self * unit;
        Complex(re / scale, im / scale)
    }
}

/// e^z E_1(z) for a real part from 0 and a z that is not 0.
///
/// By its power series up to |z| = 2 and by its continued fraction (modified Lentz) beyond (Abramowitz & Stegun 5.1.11, 5.1.22).
fn scaled_e1(z: Complex) -> Complex {
    const EULER: f64 = 0.577_215_664_901_532_9;
    const TERMS: i32 = 500;
    if z.size() <= 2.0 {
        let mut sum = Complex(-EULER - z.size().ln(), -z.1.atan2(z.0));
        let mut power = Complex(1.0, 0.0);
        for k in 1..TERMS {
            let k = f64::from(k);
            // -(-z)^k / k!, over k.
            power = power * Complex(-z.0 / k, -z.1 / k);
            let term = Complex(power.0 / k, power.1 / k);
            sum = sum - term;
            if term.size() <= f64::EPSILON * 1e-2 * sum.1.abs().min(sum.0.abs()) {
                break;
            }
        }
        let (sin, cos) = z.1.sin_cos();
        let grown = z.0.exp();
        return Complex(grown * cos, grown * sin) * sum;
    }
    let one = Complex(1.0, 0.0);
    let mut b = z + one;
    let mut c = Complex(1e300, 0.0);
    let mut d = one / b;
    let mut h = d;
    for i in 1..TERMS {
        let a = Complex(-f64::from(i * i), 0.0);
        b = b + Complex(2.0, 0.0);
        d = one / (a * d + b);
        c = b + a / c;
        let change = c * d;
        h = h * change;
        if (change - one).size() <= 4.0 * f64::EPSILON {
            break;
        }
    }
    h
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::medium::exponential::gauss;
    use std::f64::consts::{FRAC_PI_2, PI};

    fn beside(foot: f64, aside: f64) -> Airlight {
        Airlight { foot, aside }
    }

    /// The integral by Gauss-Legendre quadrature in the lamp's angle theta (dt / d^2 = d theta / p), on parts that end where the run is
    /// p times a power of two from the foot, and a power of two of free paths from the eye's end.
    fn counted(light: &Airlight, extinction: f64, from: f64, to: f64) -> f64 {
        let Airlight { foot, aside: p } = *light;
        let mut ends = vec![from, to, foot];
        for k in -40..=70 {
            let step = 2.0f64.powi(k);
            ends.extend([foot - step * p, foot + step * p]);
            ends.extend([from + step / extinction, foot + step / extinction]);
        }
        ends.retain(|t| t.is_finite() && (from..=to).contains(t));
        ends.sort_unstable_by(f64::total_cmp);
        ends.dedup();
        let part = |pair: &[f64]| {
            // Relative to the first point of the part, so that short parts far away keep their digits.
            let (y, d) = (pair[0] - foot, (pair[0] - foot).hypot(p));
            let end = ((pair[1] - pair[0]) * p).atan2(p * p + y * (pair[1] - foot));
            let value = |theta: f64| {
                let (sin, cos) = theta.sin_cos();
                // How far along the ray an angle at the lamp from the part's first point reaches.
                let t = d * sin / ((p / d) * cos - (y / d) * sin);
                let way = pair[0] + t + (y + t).hypot(p);
                DVec3::splat((-extinction * way).exp() / p)
            };
            gauss(0.0, end, &value).x
        };
        ends.windows(2).map(part).sum()
    }

    /// Lamps before, beside and behind the eye and the run's end, near and far.
    fn cases() -> Vec<(Airlight, f64, f64)> {
        let mut cases = Vec::new();
        for p in [1e-9, 1e-6, 1e-3, 0.03, 1.0, 40.0, 1000.0, 10_000.0] {
            for foot in [
                -500.0, -1.0, -1e-3, 0.0, 1e-3, 2.0, 99.9, 100.0, 100.1, 5000.0,
            ] {
                for (from, to) in [
                    (0.0, 100.0),
                    (0.0, 1e-3),
                    (1.9, 2.1),
                    (3.0, 3.001),
                    (0.0, 10_000.0),
                    (20.0, 99.0),
                ] {
                    cases.push((beside(foot, p), from, to));
                }
            }
        }
        cases
    }

    #[test]
    fn the_closed_form_is_the_integral() {
        for (light, from, to) in cases() {
            for extinction in [0.0, 1e-15, 1e-9, 1e-4, 0.01, 0.1, 1.0, 30.0, 1e3, 1e5] {
                let found = light.exact(extinction, from, to);
                let exact = counted(&light, extinction, from, to);
                assert!(
                    found.is_finite() && found >= 0.0,
                    "{light:?} {extinction} {from} {to}"
                );
                let off = (found - exact).abs();
                assert!(
                    off <= 1e-9 * exact + 1e-280,
                    "{light:?} {extinction} [{from}, {to}]: {found:e} {exact:e}"
                );
            }
        }
    }

    #[test]
    fn in_clear_air_it_is_the_angle_over_the_distance() {
        for (light, from, to) in cases() {
            let Airlight { foot, aside: p } = light;
            let angle = |t: f64| ((t - foot) / p).atan();
            let exact = (angle(to) - angle(from)) / p;
            let found = light.exact(0.0, from, to);
            // The difference of arc tangents has lost what is below 1e-16 of them.
            let tolerance = 1e-12 * exact + 4e-16 * FRAC_PI_2 / p;
            assert!(
                (found - exact).abs() <= tolerance,
                "{light:?} {found} {exact}"
            );
            let glow = light.glow(0.0, from, to);
            assert!(
                (glow / found - 1.0).abs() < 1e-12,
                "{light:?} {glow} {found}"
            );
            assert_eq!(light.glow_error(0.0, from, to), 0.0);
        }
        // On a line through the lamp, outside of the run: (b - a) / (a b).
        let through = beside(-1e3, NEAREST);
        let exact = 1e3 / (1e3 * 2e3);
        assert!((through.exact(0.0, 0.0, 1e3) / exact - 1.0).abs() < 1e-14);
        let ahead = beside(2e3, NEAREST);
        assert!((ahead.exact(0.0, 0.0, 1e3) / exact - 1.0).abs() < 1e-14);
        // Over the whole of a line: pi / p.
        let whole = beside(1e6, 2.0).exact(0.0, 0.0, 2e6);
        assert!((whole * 2.0 / PI - 1.0).abs() < 1e-5);
    }

    #[test]
    fn the_glow_is_within_its_bound_and_below() {
        let (mut close, mut all) = (0, 0);
        for (light, from, to) in cases() {
            for extinction in [1e-9, 1e-5, 1e-3, 0.01, 0.1, 1.0, 30.0] {
                let exact = light.exact(extinction, from, to);
                if exact < 1e-200 {
                    continue;
                }
                let off = 1.0 - light.glow(extinction, from, to) / exact;
                let bound = light.glow_error(extinction, from, to);
                assert!((0.0..=1.0).contains(&bound), "{bound}");
                let rounding = 1e-9;
                assert!(
                    (-rounding..=bound + rounding).contains(&off),
                    "{light:?} {extinction} [{from}, {to}]: {off} {bound}"
                );
                all += 1;
                close += usize::from(bound < 1e-3);
            }
        }
        // It is chosen often enough to be of use, and the bound is no idle one.
        assert!(10 * close > 3 * all, "{close} of {all}");
        let light = beside(5.0, 1.0);
        let off = 1.0 - light.glow(0.02, 0.0, 20.0) / light.exact(0.02, 0.0, 20.0);
        let bound = light.glow_error(0.02, 0.0, 20.0);
        assert!(off > 0.2 * bound && bound < 0.01, "{off} {bound}");
    }

    #[test]
    fn runs_add_up_and_nothing_jumps() {
        for (light, from, to) in cases() {
            for extinction in [0.0, 1e-3, 0.3, 100.0] {
                let of = |a: f64, b: f64| light.exact(extinction, a, b);
                let whole = of(from, to);
                let middle = from + 0.37 * (to - from);
                let parts = of(from, middle) + of(middle, to);
                assert!(
                    (whole - parts).abs() <= 1e-9 * whole + 1e-280,
                    "{light:?} {whole} {parts}"
                );
                assert!(of(from, middle) <= whole * (1.0 + 1e-12));
                assert_eq!(of(to, from), 0.0);
                // A little more air, or the lamp a little farther away, changes little.
                let near = light.exact(extinction * (1.0 + 1e-9) + 1e-15, from, to);
                let ways = extinction * 1e-9 * (to + light.foot.abs() + light.aside + to);
                assert!(
                    (near - whole).abs() <= (ways + 1e-8) * whole + 1e-280,
                    "{light:?} {extinction}"
                );
            }
        }
        assert!(beside(3.0, 0.5).exact(1e-3, 0.0, f64::INFINITY).is_finite());
    }

    #[test]
    fn a_ray_keeps_the_digits_of_how_near_it_passes() {
        // A kilometre away and a centimetre beside: by the difference of squares 3 % would be left of a single's digits.
        let direction = DVec3::new(0.48, 0.6, 0.64);
        let across = direction.any_orthonormal_vector();
        let lamp = 1000.0 * direction + 0.01 * across;
        let light = Airlight::new(DVec3::ZERO, direction, lamp, 0.0);
        assert!((light.aside / 0.01 - 1.0).abs() < 1e-10 && (light.foot - 1000.0).abs() < 1e-9);
        assert_eq!(
            Airlight::new(DVec3::ZERO, direction, DVec3::ZERO, 0.0).aside,
            NEAREST
        );
        assert_eq!(
            Airlight::new(DVec3::ZERO, direction, DVec3::ZERO, 0.1).aside,
            0.1
        );
    }
}
