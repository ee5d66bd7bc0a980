//! Why a picture is darker or brighter than pictures are: what its exposure says, and the likely cause.

use super::{Conditions, Sun};
use crate::colour::luminance;
use crate::scene::Ray;
use crate::sky::sun::fibonacci_sphere;
use crate::warning::Warning;
use glam::DVec3;

/// Exposures that are usual [EV100]: below is less than a room has by moonlight, above more than snow has by sunlight.
pub const USUAL: [f64; 2] = [-6.0, 18.0];

/// Rays to all sides from the eye.
const RAYS: usize = 512;

/// Illuminance above any that sun and sky give together on the Earth [lx].
const BRIGHTEST_DAY: f64 = 150_000.0;

impl Conditions {
    /// What is said of a picture under these conditions that is metered at `ev100` (nothing: it is black), where that is not
    /// [`USUAL`]. `picture` is what it is called, `this picture` for one; `left_out` names effects that would have given light.
    pub fn odd_exposure(
        &self,
        ev100: Option<f64>,
        picture: &str,
        left_out: &[&str],
    ) -> Option<Warning> {
        let [least, most] = USUAL;
        let is_dark = match ev100 {
            None => true,
            Some(ev100) if ev100 < least => true,
            Some(ev100) if ev100 > most => false,
            Some(_) => return None,
        };
        let causes = match is_dark {
            true => self.why_dark(left_out),
            false => self.why_bright(),
        };
        Some(Warning::OddExposure {
            picture: picture.to_owned(),
            ev100,
            is_dark,
            causes,
        })
    }

    /// Likely causes of darkness, one at least.
    fn why_dark(&self, left_out: &[&str]) -> Vec<String> {
        let mut causes = Vec::new();
        if !left_out.is_empty() {
            let names = left_out.join(", ");
            causes.push(format!("--without leaves out light: {names}"));
        }
        let night = self.sun != Sun::ABSENT && self.sun_elevation_deg() < -6.0;
        if self.sky.is_none() && self.lamps.is_empty() && !self.sun.shines() {
            let why = self.sun.missing().unwrap_or("the sun is not there");
            causes.push(format!("{why}, and there is no sky and no lamp"));
        } else if night && self.lamps.is_empty() {
            causes.push(format!(
                "the sun is {:.1} degrees below the horizon, the night has no moon, and there is no lamp",
                -self.sun_elevation_deg()
            ));
        }
        causes.extend(self.shut_in());
        if causes.is_empty() {
            causes.push(
                "what is seen gets or reflects next to none of the light: is it black, or in another room?"
                    .into(),
            );
        }
        causes
    }

    /// Why no light comes straight to the eye, if none does.
    fn shut_in(&self) -> Option<String> {
        if self.view.points().is_some() {
            return None;
        }
        let eye = self.view.camera.eye;
        let passes = |direction: DVec3, far: f64| {
            let ray = Ray {
                origin: eye,
                direction,
            };
            self.geometry.transmittance(&ray, 0.0, far).max_element() > 0.0
        };
        let open = |i: usize| {
            let direction = fibonacci_sphere(i, RAYS);
            // Who sees nothing but the ground stands on it.
            let falls = self.ground.is_some() && direction.y < 0.0;
            !falls && passes(direction, f64::INFINITY)
        };
        let sees = |lamp: &super::Lamp| {
            let way = lamp.middle() - eye;
            let distance = way.length();
            distance == 0.0 || passes(way / distance, 0.99 * distance)
        };
        if (0..RAYS).any(open) || self.lamps.iter().any(sees) {
            return None;
        }
        Some(format!(
            "none of {RAYS} rays from the eye to all sides meets a window or a lamp: it is inside something, or in a closed room"
        ))
    }

    /// Likely causes of brightness, one at least.
    fn why_bright(&self) -> Vec<String> {
        let mut causes = Vec::new();
        let lux = self.sun.illuminance_lux();
        if lux > BRIGHTEST_DAY {
            causes.push(format!("the sun is given {lux:.3e} lx"));
        }
        let dome = self.sky.as_ref();
        let dome = dome.map_or(0.0, |sky| luminance(sky.horizontal_illuminance()));
        if dome > BRIGHTEST_DAY {
            causes.push(format!("the sky gives {dome:.3e} lx"));
        }
        let glow = self.lamps.iter().filter_map(super::Lamp::glow);
        let glow = glow.fold(0.0, f64::max);
        if glow > 1e5 {
            causes.push(format!("a surface shines with {glow:.3e} cd/m2"));
        }
        if causes.is_empty() {
            causes.push("the sun's disc or a lamp fills most of it".into());
        }
        causes
    }
}
