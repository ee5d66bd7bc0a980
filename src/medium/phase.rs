//! Phase functions: how scattered light spreads over directions.

use std::f64::consts::PI;

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
    /// Draine 2003, |g| < 1, a >= 0: a = 0 is Henyey-Greenstein, a = 1 Cornette-Shanks, g = 0 with a = 1 Rayleigh.
    Draine {
        /// Parameter; the mean cosine is g (1 + a (3 + 2 g^2) / 5) / (1 + a (1 + 2 g^2) / 3).
        g: f64,
        /// Weight of cos^2 [1].
        a: f64,
    },
    /// Water droplets, Jendersie & d'Eon 2023: see [`Fog`].
    Fog {
        /// Diameter of the droplets [m], within [`Fog::DIAMETER`].
        droplet: f64,
    },
}

/// Scattering by water droplets: (1 - weight) HG(g) + weight Draine(g_draine, a), fitted to Mie theory by diameter.
///
/// Source: Jendersie & d'Eon 2023, An Approximate Mie Scattering Function for Fog and Cloud Rendering, equations 4 to 7 (5 to
/// 50 micrometres) and the supplement (below). For d <= 0.1 micrometres the weight is printed (and coded by others) as
/// 0.252977 - (312.983 d)^4.3, which is -2.7e6 at 0.1; 0.252977 - 312.983 d^4.3 joins the next piece (0.237 against 0.258)
/// and is what this uses. The pieces do not meet exactly: the mean cosine jumps by 0.0022 at 1.5 micrometres.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Fog {
    /// Parameter of the Henyey-Greenstein part, 0 to 1.
    pub g: f64,
    /// Parameter of Draine's part, -0.036 to 1.
    pub g_draine: f64,
    /// Weight of cos^2 in Draine's part, above 0.
    pub a: f64,
    /// Share of Draine's part, 0 to 1.
    pub weight: f64,
}

impl Fog {
    /// The diameters for which the fit holds [m].
    pub const DIAMETER: [f64; 2] = [0.01e-6, 50e-6];

    /// Draine's function alone.
    pub(crate) fn of_draine(g: f64, a: f64) -> Self {
        Fog {
            g: 0.0,
            g_draine: g,
            a,
            weight: 1.0,
        }
    }

    /// The fit for a droplet's diameter [m] within [`Fog::DIAMETER`].
    pub fn of_droplet(diameter: f64) -> Self {
        let d = 1e6 * diameter;
        let l = d.ln();
        if d <= 0.1 {
            Fog {
                g: 13.8 * d * d,
                g_draine: 1.1456 * d * (9.29044 * d).sin(),
                a: 250.0,
                weight: 0.252977 - 312.983 * d.powf(4.3),
            }
        } else if d < 1.5 {
            let inner = ((l - 0.238604) * (l + 1.00667) / (0.507522 - 0.15677 * l)).cos();
            Fog {
                g: 0.862 - 0.143 * l * l,
                g_draine: 0.379685 * (1.19692 * inner + 1.37932 * l + 0.0625835).cos() + 0.344213,
                a: 250.0,
                weight: 0.146209 * (3.38707 * l + 2.11193).cos() + 0.316072 + 0.0778917 * l,
            }
        } else if d < 5.0 {
            // The published 0.081287 / (-2 l + tan l + 1.27551), times cos l above and below: tan has a pole at 4.81.
            let (sin, cos) = l.sin_cos();
            Fog {
                g: 0.0604931 * l.ln() + 0.940256,
                g_draine: 0.500411 - 0.081287 * cos / ((1.27551 - 2.0 * l) * cos + sin),
                a: 7.30354 * l + 6.31675,
                weight: 0.026914 * (l - (5.68947 * (l.ln() - 0.0292149)).cos()) + 0.376475,
            }
        } else {
            Fog {
                g: (-0.0990567 / (d - 1.67154)).exp(),
                g_draine: (-2.20679 / (d + 3.91029) - 0.428934).exp(),
                a: (3.62489 - 8.29288 / (d + 5.52825)).exp(),
                weight: (-0.599085 / (d - 0.641583) - 0.665888).exp(),
            }
        }
    }
}

/// Henyey & Greenstein's function [1/sr] from 1 - mu: (1 - g)^2 + 2 g (1 - mu) keeps its digits where mu is nearly 1.
fn henyey_greenstein(g: f64, one_minus_mu: f64) -> f64 {
    let below = 1.0 - g;
    let square = below * below + 2.0 * g * one_minus_mu;
    below * (1.0 + g) / (4.0 * PI * square * square.sqrt())
}

/// Draine's function [1/sr] from 1 - mu (Draine 2003, ApJ 598, 1017, equation 3).
fn draine(g: f64, a: f64, one_minus_mu: f64) -> f64 {
    let mu = 1.0 - one_minus_mu;
    henyey_greenstein(g, one_minus_mu) * (1.0 + a * mu * mu) / (1.0 + a * (1.0 + 2.0 * g * g) / 3.0)
}

impl Phase {
    /// The phase function [1/sr] for light that turns by an angle of cosine mu, from 1 - mu (0 to 2).
    ///
    /// `one_minus_mu` is half the squared distance between the ray's direction and the sun's, which keeps its digits
    /// where mu itself is 1 within rounding.
    ///
    /// Sources: Henyey & Greenstein 1941; Cornette & Shanks 1992; Draine 2003; Jendersie & d'Eon 2023; Nishita, Miyawaki &
    /// Nakamae 1987 (their K left open: normalised over the sphere it is 1/(8 pi) for hazy and 33/(332 pi) for murky air).
    pub fn value(&self, one_minus_mu: f64) -> f64 {
        let mu = 1.0 - one_minus_mu;
        match *self {
            Phase::Isotropic => 1.0 / (4.0 * PI),
            Phase::Rayleigh => 3.0 / (16.0 * PI) * (1.0 + mu * mu),
            Phase::HenyeyGreenstein { g } => henyey_greenstein(g, one_minus_mu),
            Phase::CornetteShanks { g } => draine(g, 1.0, one_minus_mu),
            Phase::NishitaHazy => (1.0 + 9.0 * (0.5 * (1.0 + mu)).powi(8)) / (8.0 * PI),
            Phase::NishitaMurky => 33.0 / (332.0 * PI) * (1.0 + 50.0 * (0.5 * (1.0 + mu)).powi(32)),
            Phase::Draine { g, a } => draine(g, a, one_minus_mu),
            Phase::Fog { droplet } => {
                let fog = Fog::of_droplet(droplet);
                (1.0 - fog.weight) * henyey_greenstein(fog.g, one_minus_mu)
                    + fog.weight * draine(fog.g_draine, fog.a, one_minus_mu)
            }
        }
    }

    /// The greatest value over all angles [1/sr]: straight forward or straight back.
    pub fn peak(&self) -> f64 {
        self.value(0.0).max(self.value(2.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::medium::exponential::gauss;
    use glam::DVec3;

    /// The integrals of p and of p mu over the sphere; nodes crowd at mu = 1, where fog has a peak.
    fn moments(phase: Phase) -> [f64; 2] {
        let n = 4000;
        let sum: DVec3 = (0..n)
            .map(|i| {
                let (a, b) = (i as f64 / n as f64, (i + 1) as f64 / n as f64);
                gauss(a, b, &|x: f64| {
                    let one_minus_mu = 2.0 * x.powi(4);
                    let p = phase.value(one_minus_mu) * 8.0 * x.powi(3);
                    DVec3::new(p, p * (1.0 - one_minus_mu), 0.0)
                })
            })
            .sum();
        [2.0 * PI * sum.x, 2.0 * PI * sum.y]
    }

    fn draine_mean(g: f64, a: f64) -> f64 {
        g * (1.0 + a * (3.0 + 2.0 * g * g) / 5.0) / (1.0 + a * (1.0 + 2.0 * g * g) / 3.0)
    }

    #[test]
    fn every_phase_function_integrates_to_one_and_has_its_mean_cosine() {
        let cornette_shanks = |g: f64| 3.0 * g * (4.0 + g * g) / (5.0 * (2.0 + g * g));
        let mut phases = vec![
            (Phase::Isotropic, 0.0),
            (Phase::Rayleigh, 0.0),
            (Phase::HenyeyGreenstein { g: 0.9 }, 0.9),
            (Phase::HenyeyGreenstein { g: -0.5 }, -0.5),
            (Phase::CornetteShanks { g: 0.8 }, cornette_shanks(0.8)),
            // The mean cosine of ((1 + mu) / 2)^n is n / (n + 2), its integral 2 / (n + 1) that of 1.
            (Phase::NishitaHazy, 0.4),
            (Phase::NishitaMurky, 50.0 / 83.0 * (32.0 / 34.0)),
        ];
        for (g, a) in [
            (0.0, 1.0),
            (0.7, 0.4),
            (-0.6, 3.0),
            (0.4, 250.0),
            (0.95, 20.0),
        ] {
            phases.push((Phase::Draine { g, a }, draine_mean(g, a)));
        }
        for d in [
            0.01, 0.05, 0.1, 0.11, 0.5, 1.0, 1.49, 1.5, 2.0, 4.0, 4.81, 4.9, 5.0, 8.0, 20.0, 50.0,
        ] {
            let fog = Fog::of_droplet(d * 1e-6);
            let mean = (1.0 - fog.weight) * fog.g + fog.weight * draine_mean(fog.g_draine, fog.a);
            phases.push((Phase::Fog { droplet: d * 1e-6 }, mean));
        }
        for (phase, mean) in phases {
            let [total, cosine] = moments(phase);
            assert!((total - 1.0).abs() < 1e-8, "{phase:?}: {total}");
            assert!((cosine - mean).abs() < 1e-8, "{phase:?}: {cosine} {mean}");
        }
    }

    #[test]
    fn draine_has_its_three_limits() {
        for i in 0..=200 {
            let x = f64::from(i) / 100.0;
            for g in [-0.8, 0.0, 0.3, 0.99] {
                let draine = |a: f64| Phase::Draine { g, a }.value(x);
                let hg = Phase::HenyeyGreenstein { g }.value(x);
                // Written out, since one is computed by way of the other.
                let mu = 1.0 - x;
                let square: f64 = 1.0 + g * g - 2.0 * g * mu;
                let cs = 3.0 * (1.0 - g * g) * (1.0 + mu * mu)
                    / (8.0 * PI * (2.0 + g * g) * square.powf(1.5));
                assert!((draine(0.0) / hg - 1.0).abs() < 1e-14);
                assert!((draine(1.0) / cs - 1.0).abs() < 1e-8, "{x} {g}");
                assert!(
                    (draine(0.5) / hg - 1.0).abs() > 1e-3
                        || (mu * mu - (1.0 + 2.0 * g * g) / 3.0).abs() < 0.01
                );
            }
            let rayleigh = Phase::Rayleigh.value(x);
            assert!((Phase::Draine { g: 0.0, a: 1.0 }.value(x) / rayleigh - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn no_angle_is_brighter_than_the_peak_and_the_peak_of_fog_grows_with_its_droplets() {
        let mut last = 0.0;
        for d in [5.0, 8.0, 12.0, 20.0, 50.0] {
            let phase = Phase::Fog { droplet: d * 1e-6 };
            assert!((0..=1000).all(|i| phase.value(f64::from(i) / 500.0) <= phase.peak()));
            assert!(phase.peak() > last);
            last = phase.peak();
        }
        let backward = Phase::Draine { g: -0.7, a: 2.0 };
        assert_eq!(backward.peak(), backward.value(2.0));
    }

    #[test]
    fn the_fit_of_fog_stays_in_its_domain_for_every_diameter() {
        let [least, greatest] = Fog::DIAMETER;
        let n = 20_000;
        let mut last: Option<f64> = None;
        for i in 0..=n {
            let d = least * (greatest / least).powf(f64::from(i) / f64::from(n));
            let fog = Fog::of_droplet(d);
            assert!((0.0..=1.0).contains(&fog.weight), "{d}: {fog:?}");
            assert!(
                (0.0..1.0).contains(&fog.g) && (-0.036..1.0).contains(&fog.g_draine),
                "{d}: {fog:?}"
            );
            assert!(fog.a > 0.0 && fog.a.is_finite());
            let mean = (1.0 - fog.weight) * fog.g + fog.weight * draine_mean(fog.g_draine, fog.a);
            if let Some(before) = last {
                // The pieces' joints are the largest steps there are; the pole of tan at 4.81 is none.
                assert!((mean - before).abs() < 0.04, "{d}: {mean} {before}");
                if d > 2e-6 {
                    assert!((mean - before).abs() < 1e-3, "{d}: {mean} {before}");
                }
            }
            last = Some(mean);
        }
    }
}
