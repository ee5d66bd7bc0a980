//! Beams that effects run for.

use super::settings::Settings;
use crate::beam::Beam;
use crate::conditions::Conditions;

/// The beams of the sun's disc, as many as the knob `suns` says, or one where no penumbra is as wide as a pixel.
pub fn sun_beams(conditions: &Conditions, settings: &Settings<'_>) -> Vec<Beam> {
    conditions.sun_beams(settings.get("suns") as usize)
}
