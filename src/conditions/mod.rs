//! What physics makes of a scene: the sun, the sky, the air, all in their domains.
//!
//! This is the one place where domains are checked; everything behind it may rely on them.

mod assemble;
mod brightest;
mod checks;
mod evenly;
pub mod exposed;
mod faces;
mod inputs;
pub mod lamps;
mod lines;
mod openness;
mod penumbra;
pub mod received;
mod request;
mod spot;
mod sun;
mod unused;
mod view;
pub mod volumes;

pub use assemble::SolarGeometry;
pub use brightest::Brightest;
pub use inputs::{Input, Snapshot};
pub use lamps::Lamp;
pub use penumbra::{DiscInAir, Told};
pub(crate) use received::Lit;
pub use request::{CameraChoice, DEFAULT_SIZE, Request};
pub use sun::Sun;
pub use view::{Receiver, Receivers, View, sample_positions, spread};

use crate::colour::luminance;
use crate::frame::Field;
use crate::medium::{Air, Shape};
use crate::scene::{Geometry, Scene};
use crate::sky::Sky;
use crate::warning::Warning;
use glam::DVec3;
use std::any::Any;
use std::f64::consts::PI;
use std::sync::{Arc, Mutex};

/// Everything that effects need to know, in SI units and scene axes: a scene at a moment, from a view.
///
/// What is expensive is shared: [`Conditions::at`] gives those of another moment and [`Conditions::seen_from`] those of another
/// view, over the same scene and geometry, and a clone costs next to nothing. Whoever keeps results asks
/// [`Conditions::snapshot`] whether what they were made of has changed.
#[derive(Clone)]
pub struct Conditions {
    /// The scene: meshes, materials, textures.
    pub scene: Arc<Scene>,
    /// What stands in the way of light.
    pub geometry: Arc<Geometry>,
    /// From where it is looked at.
    pub view: View,
    /// The sun.
    pub sun: Sun,
    /// The sky, if there is one.
    pub sky: Option<Arc<Sky>>,
    /// Place and time, unless the user put the sun where it is.
    pub instant: Option<SolarGeometry>,
    /// The endless ground, if there is one.
    pub ground: Option<GroundPlane>,
    /// The media.
    pub air: Air,
    /// The lamps that give light.
    pub lamps: Arc<[Lamp]>,
    /// Where they shine on surfaces.
    lit: Arc<Lit>,
    /// All of them, and those surfaces that shine too faintly to be seen now.
    all_lamps: Arc<[Lamp]>,
    /// What was left out, is doubtful or approximate.
    pub warnings: Vec<Warning>,
    /// What was asked for, so that it can be asked of another moment.
    request: Request,
    /// What was found last of the sun's disc in the air, and of which inputs: see `penumbra`.
    disc: Arc<Mutex<Option<Arc<dyn Any + Send + Sync>>>>,
}

/// The endless plane below everything.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GroundPlane {
    /// Height [m].
    pub height: f64,
    /// Reflectance, 0 to 1.
    pub albedo: DVec3,
}

/// Unit vector toward an azimuth and an elevation [rad] in the axes of a scene whose -Z faces the azimuth `north` [rad].
pub fn toward(azimuth: f64, elevation: f64, north: f64) -> DVec3 {
    let (sin_a, cos_a) = (azimuth - north).sin_cos();
    let (sin_e, cos_e) = elevation.sin_cos();
    DVec3::new(cos_e * sin_a, sin_e, -cos_e * cos_a)
}

/// Surfaces that shine with less than this share of the luminance beside which they are seen are left out.
const TOO_FAINT: f64 = 1e-3;

/// A typical luminance under sun and sky alone [cd/m2]: open ground of albedo 0.2.
fn typical_luminance(sun: &Sun, sky: Option<&Sky>) -> f64 {
    let by_sun = sun.illuminance_lux() * sun.toward.y.max(0.0);
    let by_sky = sky.map_or(0.0, |sky| luminance(sky.horizontal_illuminance()));
    0.2 / PI * (by_sun + by_sky)
}

impl Conditions {
    /// What was asked of the scene beside what it says itself.
    pub fn request(&self) -> &Request {
        &self.request
    }

    /// Whether anything gives light: sky, sun or lamps.
    pub fn is_lit(&self) -> bool {
        self.sky.is_some() || self.sun.shines() || !self.lamps.is_empty()
    }

    /// Whether a picture of the scene can hold anything in a field, whatever the hour: what has to be there for that is there at all hours.
    pub fn may_hold(&self, field: Field) -> bool {
        let natural = self.sky.is_some() || self.sun != Sun::ABSENT;
        let air = !self.air.media.is_empty();
        let lamps = !self.all_lamps.is_empty() || !self.scene.emissions.is_empty();
        match field {
            Field::Surface | Field::Indirect => true,
            Field::Transmittance => air || self.geometry.panes().is_some(),
            Field::Sun => self.sun != Sun::ABSENT,
            Field::Sky => self.sky.is_some(),
            Field::Lights => lamps,
            Field::Background => natural,
            Field::InscatterSun => air && self.sun != Sun::ABSENT,
            Field::InscatterSky => air,
            Field::InscatterLights => air && lamps,
        }
    }

    /// A typical illuminance by lamps [lx]: theirs where the eye is, each as if it shone that way with all its strength, from a metre
    /// or more. An estimate.
    pub fn typical_lamp_light(&self) -> f64 {
        let eye = self.view.camera.eye;
        let of =
            |lamp: &Lamp| lamp.greatest_intensity() / lamp.middle().distance_squared(eye).max(1.0);
        self.lamps.iter().map(of).sum()
    }

    /// No surface and no air gets brighter by light straight from lamps [cd/m2]: what surfaces shine with bounds what they make of others,
    /// near a lamp there is no bound, and without lamps there is no light.
    pub fn greatest_lamp_luminance(&self) -> f64 {
        let of = |lamp: &Lamp| lamp.glow().unwrap_or(f64::INFINITY);
        self.lamps.iter().map(of).sum()
    }

    /// A typical luminance of the picture [cd/m2]: open ground of albedo 0.2. An estimate to compare contributions with.
    pub fn typical_luminance(&self) -> f64 {
        // A lamp beside the eye says nothing of what sun and sky light.
        match typical_luminance(&self.sun, self.sky.as_deref()) {
            0.0 => 0.2 / PI * self.typical_lamp_light(),
            natural => natural,
        }
    }

    /// Beside which luminance something has to be seen to matter [cd/m2]: the typical one, or a lower one where a surface shines that less
    /// daylight meets than open ground; in a room without windows a thousandth of its own.
    pub fn least_luminance(&self) -> f64 {
        let typical = self.typical_luminance();
        match typical_luminance(&self.sun, self.sky.as_deref()) {
            // Only lamps are there to be compared with.
            0.0 => typical,
            natural => {
                let beside = self.lamps.iter().filter_map(|lamp| {
                    // Where nothing else is, its own light is what others are compared with.
                    let own = TOO_FAINT * lamp.glow()?;
                    Some(lamp.seen_beside(natural)?.max(own))
                });
                beside.fold(typical, f64::min)
            }
        }
    }

    /// No ray through the air has a greater optical depth [1].
    pub fn greatest_optical_depth(&self) -> f64 {
        self.air
            .media
            .iter()
            .map(|medium| {
                let extinction = medium.extinction().max_element();
                if extinction == 0.0 {
                    0.0
                } else {
                    extinction * medium.greatest_length()
                }
            })
            .sum()
    }

    /// The media in words.
    pub fn media_phrase(&self) -> String {
        let count = |name: &str, is: fn(&Shape) -> bool| match self
            .air
            .media
            .iter()
            .filter(|m| is(&m.shape))
            .count()
        {
            0 => None,
            1 => Some(name.to_owned()),
            n => Some(format!("{n} x {name}")),
        };
        [
            count("a box of haze", |s| matches!(s, Shape::Box { .. })),
            count("haze", |s| matches!(s, Shape::Haze { .. })),
            count("air that thins with height", |s| {
                matches!(s, Shape::Height { .. })
            }),
            count("a layer of fog", |s| matches!(s, Shape::Layer { .. })),
            count("an ellipsoid of smoke", |s| {
                matches!(s, Shape::Ellipsoid { .. })
            }),
        ]
        .into_iter()
        .flatten()
        .chain(self.scene.air.map(|_| "the clear air".to_owned()))
        .collect::<Vec<_>>()
        .join(" and ")
    }
}
