//! What comes to sensors straight from the sun: the whole disc, past all edges and through all panes.

use crate::beam::Beam;
use crate::conditions::{Conditions, Receiver};
use crate::scene::Ray;
use crate::scene::disc::{Disc, DiscWork, Facing};
use glam::DVec3;

/// Points of the disc where it does not do as a whole: of a very low sun.
const POINTS: usize = 16;

/// The sun of a moment, ready for many sensors.
pub struct DirectSun<'a> {
    conditions: &'a Conditions,
    whole: Option<(Beam, Disc)>,
    points: Vec<Beam>,
}

impl<'a> DirectSun<'a> {
    /// The sun of conditions that are seen by sensors; `None` where it gives no light.
    pub fn new(conditions: &'a Conditions) -> Option<Self> {
        let sun = &conditions.sun;
        sun.shines().then(|| {
            let whole = conditions.whole_sun().zip(sun.disc());
            let points = match &whole {
                Some(_) => Vec::new(),
                None => sun.beams(POINTS),
            };
            DirectSun {
                conditions,
                whole,
                points,
            }
        })
    }

    /// Its illuminance on a sensor [lx, RGB].
    pub fn on(&self, sensor: &Receiver, work: &mut DiscWork) -> DVec3 {
        let Receiver { position, normal } = *sensor;
        let Conditions { geometry, air, .. } = self.conditions;
        let near = clearance(self.conditions, position);
        let origin = position + near * normal;
        if let Some((beam, disc)) = &self.whole {
            let facing = Facing {
                facet: normal,
                normal,
            };
            if !disc.is_before(normal) {
                return DVec3::ZERO;
            }
            let share = geometry.disc_through(disc, origin, Some(&facing), work);
            if share == DVec3::ZERO {
                return share;
            }
            return share * beam.strength() * (-air.beam_optical_depth(position, beam)).exp();
        }
        let of = |beam: &Beam| {
            let toward = beam.toward_from(position);
            let cosine = normal.dot(toward);
            if cosine <= 0.0 {
                return DVec3::ZERO;
            }
            let ray = Ray {
                origin,
                direction: toward,
            };
            let through = geometry.transmittance(&ray, near, f64::INFINITY);
            if through == DVec3::ZERO {
                return through;
            }
            through * beam.strength() * cosine * (-air.beam_optical_depth(position, beam)).exp()
        };
        self.points.iter().map(of).sum()
    }
}

/// How far a shadow ray must go before it counts what it meets [m]: above the rounding of the position that it leaves from.
pub(super) fn clearance(conditions: &Conditions, position: DVec3) -> f64 {
    1e-11 * conditions.geometry.extent() + 1e-12 * position.length()
}
