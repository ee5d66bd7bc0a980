//! Phase functions averaged over what one arrival stands for.
//!
//! An arrival carries the light of a solid angle. Where a phase function changes over it, as the forward peak of fog does, its
//! value in the middle says little; its mean over a round cap of the same size stands for it. Sizes go in steps of a factor of
//! two, and sums over all arrivals are divided by the sum of the means, so that light from everywhere alike stays what it is.

use crate::medium::Phase;
use std::f64::consts::PI;
use std::sync::OnceLock;

/// Nodes of a table over each half of the angles: from straight forward, and from straight back.
const NODES: usize = 96;

/// The whole sphere is halved so often to get the least cap that is averaged over: 0.4 degrees across.
const SIZES: usize = 19;

/// A phase function and its means over caps.
pub struct Lobe {
    phase: Phase,
    /// By size of the cap: values at the angles of [`angle_at`], forward first.
    means: [OnceLock<Vec<f32>>; SIZES],
}

impl Lobe {
    /// Prepares one; the means are found when they are first asked for.
    pub fn new(phase: Phase) -> Self {
        Lobe {
            phase,
            means: [const { OnceLock::new() }; SIZES],
        }
    }

    /// The mean [1/sr] over a cap of a solid angle [sr] whose middle is an angle of cosine mu from straight on, from 1 - mu.
    pub fn mean(&self, one_minus_mu: f32, solid_angle: f32) -> f32 {
        if self.phase == Phase::Isotropic {
            return (0.25 / PI) as f32;
        }
        let halvings = (4.0 * PI as f32 / solid_angle).log2().round();
        let size = (halvings.max(0.0) as usize).min(SIZES - 1);
        let means = self.means[size].get_or_init(|| self.means_over(size));
        let (start, small) = match one_minus_mu < 1.0 {
            true => (0, one_minus_mu),
            false => (NODES + 1, 2.0 - one_minus_mu),
        };
        let at = NODES as f32 * small.max(0.0).sqrt().sqrt();
        let node = (at as usize).min(NODES - 1);
        let share = at - node as f32;
        means[start + node] * (1.0 - share) + means[start + node + 1] * share
    }

    fn means_over(&self, size: usize) -> Vec<f32> {
        let forward = (0..=NODES).map(angle_at);
        let back = (0..=NODES).map(|node| PI - angle_at(node));
        // 2 pi (1 - cos) is the cap's share of the sphere.
        let cos = 1.0 - 2.0 * 0.5f64.powi(size as i32);
        forward
            .chain(back)
            .map(|angle| cap_mean(&self.phase, angle, cos.clamp(-1.0, 1.0).acos()) as f32)
            .collect()
    }
}

/// The angle at a node of the forward half [rad]: 1 - mu is the fourth power of the node's share, so that peaks are resolved.
fn angle_at(node: usize) -> f64 {
    let share = node as f64 / NODES as f64;
    2.0 * (0.5 * share.powi(4)).sqrt().asin()
}

/// The mean of a phase function [1/sr] over a cap around a direction at `angle` from straight on, of angular radius `radius`
/// [rad]: over rings around straight on, of which the cap holds an arc.
fn cap_mean(phase: &Phase, angle: f64, radius: f64) -> f64 {
    const RINGS: usize = 48;
    let nearest = (angle - radius).max(0.0);
    let farthest = (angle + radius).min(PI);
    let (mut sum, mut whole) = (0.0, 0.0);
    for i in 0..RINGS {
        let u = (i as f64 + 0.5) / RINGS as f64;
        // Finer at both ends, where the phase function has its peaks and arcs begin.
        let ring = nearest + (farthest - nearest) * u * u * (3.0 - 2.0 * u);
        let rate = 6.0 * u * (1.0 - u);
        let across = angle.sin() * ring.sin();
        let arc = match across > 1e-12 {
            true => ((radius.cos() - angle.cos() * ring.cos()) / across)
                .clamp(-1.0, 1.0)
                .acos(),
            false => PI,
        };
        let weight = rate * arc * ring.sin();
        sum += weight * phase.value(2.0 * (0.5 * ring).sin().powi(2));
        whole += weight;
    }
    match whole > 0.0 {
        true => sum / whole,
        false => phase.value(2.0 * (0.5 * angle).sin().powi(2)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_over_small_caps_are_the_function_and_over_the_sphere_one() {
        for phase in [
            Phase::HenyeyGreenstein { g: 0.7 },
            Phase::HenyeyGreenstein { g: -0.5 },
            Phase::Rayleigh,
            Phase::NishitaMurky,
        ] {
            let lobe = Lobe::new(phase);
            for i in 0..=40 {
                let one_minus_mu = 0.05 * f64::from(i);
                let whole = f64::from(lobe.mean(one_minus_mu as f32, 4.0 * PI as f32));
                assert!((whole * 4.0 * PI - 1.0).abs() < 0.02, "{phase:?} {whole}");
                let small = f64::from(lobe.mean(one_minus_mu as f32, 5e-5));
                let exact = phase.value(one_minus_mu);
                assert!(
                    (small / exact - 1.0).abs() < 0.01,
                    "{phase:?} {i}: {small} {exact}"
                );
            }
        }
    }

    #[test]
    fn a_peak_narrower_than_the_cap_is_spread_over_it() {
        // The mean over a cap straight on is the light that a cone gets, which has a closed form.
        let g = 0.98;
        let lobe = Lobe::new(Phase::HenyeyGreenstein { g });
        let solid_angle = 4.0 * PI / 1024.0;
        let mu = 1.0 - solid_angle / (2.0 * PI);
        let within = (1.0 - g * g) / (2.0 * g)
            * (1.0 / (1.0 - g) - 1.0 / (1.0 + g * g - 2.0 * g * mu).sqrt());
        let mean = f64::from(lobe.mean(0.0, solid_angle as f32));
        assert!(
            (mean * solid_angle / within - 1.0).abs() < 0.02,
            "{} {within}",
            mean * solid_angle
        );
    }
}
