//! What the air at a place scatters toward the eye of the light that comes to it from all sides.

use super::lobe::Lobe;
use super::sphere::Lit;
use crate::medium::Kind;
use glam::DVec3;

/// The phase functions of the kinds of media.
pub struct Lobes(Vec<Lobe>);

impl Lobes {
    pub fn new(kinds: &[Kind]) -> Self {
        Lobes(kinds.iter().map(|kind| Lobe::new(kind.phase)).collect())
    }

    /// J of each kind [cd/m2, RGB]: what media of that kind send toward the eye for each unit of their scattering coefficient,
    /// at the end of a ray of this direction, the integral of p L over all directions that light comes from.
    pub fn source(&self, lit: &[Lit], direction: DVec3) -> Vec<DVec3> {
        let direction = direction.as_vec3();
        let of = |lobe: &Lobe| {
            let (mut sum, mut whole) = (DVec3::ZERO, 0.0);
            for one in lit {
                let one_minus_mu = 0.5 * (direction - one.toward).length_squared();
                let p = f64::from(lobe.mean(one_minus_mu, one.share));
                whole += p * f64::from(one.share);
                sum += p * one.light.as_dvec3();
            }
            match whole > 0.0 {
                true => sum / whole,
                false => DVec3::ZERO,
            }
        };
        self.0.iter().map(of).collect()
    }
}
