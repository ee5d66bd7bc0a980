//! The list of effects.

use super::definition::Effect;
use super::{
    air_lamps, air_shadow, air_sky, compose, emission, lamp_faces, radiosity, shadow,
    shafts_epipolar, shafts_march, shafts_planes, shafts_prefiltered, shafts_rectified, sky_dome,
    sun_disc, surface_lamps, surface_sun, transmittance, visibility,
};

/// Every effect, in the order in which they run: each after those whose fields it reads.
pub const ALL: &[&Effect] = &[
    &visibility::VISIBILITY,
    &transmittance::TRANSMITTANCE,
    &sky_dome::SKY_DOME,
    &sun_disc::SUN_DISC,
    &shadow::SHADOW,
    &surface_sun::SURFACE_SUN,
    &surface_lamps::SURFACE_LAMPS,
    &emission::EMISSION,
    &radiosity::RADIOSITY,
    &shafts_rectified::SHAFTS_RECTIFIED,
    &shafts_epipolar::SHAFTS_EPIPOLAR,
    &shafts_prefiltered::SHAFTS_PREFILTERED,
    &shafts_march::SHAFTS_MARCH,
    &shafts_planes::SHAFTS_PLANES,
    &air_sky::AIR_SKY,
    &air_lamps::AIR_LAMPS,
    &air_shadow::AIR_SHADOW,
    &compose::COMPOSE,
    // It takes account of the air between lamp and eye itself.
    &lamp_faces::LAMP_FACES,
];
