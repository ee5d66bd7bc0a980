//! What is said of a scene and has no effect.

use super::request::Request;
use crate::ephemeris::{Tier, TimeScale};
use crate::medium::{Medium, Shape};
use crate::scene::{Ground, PunctualKind, PunctualLight, Scene};
use crate::warning::{UnusedLight, Warning};
use glam::DVec3;

/// One warning for each part of a scene and of what is asked of it that has no effect. `ground` is the ground's height [m].
pub(super) fn of(scene: &Scene, request: &Request, has_sky: bool, ground: f64) -> Vec<Warning> {
    let of_sky = match has_sky {
        true => None,
        false => of_sky(scene),
    };
    of_sky
        .into_iter()
        .chain(of_place_and_time(scene, request))
        .chain(of_ground(scene))
        .chain(of_media(scene, ground))
        .chain(of_lights(scene))
        .collect()
}

/// Place, time and the ephemeris, where a sun stands in for them.
fn of_place_and_time(scene: &Scene, request: &Request) -> Option<Warning> {
    let by_lamps = scene.site.is_none() && scene.time.is_none() && scene.has_lamps();
    if scene.sun.is_none() && !by_lamps {
        return None;
    }
    let names = named([
        ("place", scene.site.is_some()),
        ("time", scene.time.is_some()),
        ("time zone", request.timezone.is_some()),
        ("fold", request.fold.is_some()),
        ("time scale", request.time_scale != TimeScale::default()),
        ("delta T", request.delta_t.is_some()),
        ("tier", request.tier != Tier::default()),
        ("pressure", request.pressure_hpa.is_some()),
        ("temperature", request.temperature_c.is_some()),
    ]);
    if names.is_empty() {
        return None;
    }
    Some(match scene.sun {
        Some(_) => Warning::UnusedWithSun { names },
        None => Warning::UnusedWithoutSun { names },
    })
}

/// Keys of a ground that is not there. Haze reaches down to its height all the same, and clear air is counted from it.
fn of_ground(scene: &Scene) -> Option<Warning> {
    if scene.ground.enabled {
        return None;
    }
    let reaches_down = |medium: &Medium| matches!(medium.shape, Shape::Haze { .. });
    let counted = scene.air.as_ref().is_some_and(|air| air.base.is_none());
    let height_is_used = counted || scene.media.iter().any(reaches_down);
    let keys = named([
        ("height", scene.ground.height.is_some() && !height_is_used),
        ("albedo", scene.ground.albedo != Ground::default().albedo),
    ]);
    (!keys.is_empty()).then_some(Warning::UnusedGround { keys })
}

/// The height above which a medium with an upper border is not [m].
fn highest(medium: &Medium) -> f64 {
    match &medium.shape {
        Shape::Layer { top, waves, .. } => {
            top + waves.iter().map(|wave| wave.amplitude.abs()).sum::<f64>()
        }
        _ => medium.bounds().map_or(f64::INFINITY, |[_, high]| high.y),
    }
}

/// Media that neither scatter nor absorb, and those under the ground.
fn of_media(scene: &Scene, ground: f64) -> Option<Warning> {
    let why = |medium: &Medium| {
        let has_effect = medium.extinction() != DVec3::ZERO;
        let is_under = scene.ground.enabled && highest(medium) <= ground;
        match (has_effect, is_under) {
            (false, _) => Some("it neither scatters nor absorbs"),
            (true, true) => Some("it lies under the ground"),
            (true, false) => None,
        }
    };
    let media: Vec<(usize, &'static str)> = (1..)
        .zip(&scene.media)
        .filter_map(|(number, medium)| Some((number, why(medium)?)))
        .collect();
    (!media.is_empty()).then_some(Warning::UnusedMedia { media })
}

/// The names of what is given.
fn named<const N: usize>(all: [(&'static str, bool); N]) -> Vec<&'static str> {
    all.into_iter()
        .filter_map(|(name, given)| given.then_some(name))
        .collect()
}

/// The keys of a sky that there is not. Clear air between eye and mountains takes the turbidity.
fn of_sky(scene: &Scene) -> Option<Warning> {
    let entry = &scene.sky;
    let keys = named([
        ("model", entry.model.is_some()),
        (
            "turbidity",
            entry.turbidity.is_some() && scene.air.is_none(),
        ),
        ("direct_normal", entry.direct_normal.is_some()),
        ("diffuse_horizontal", entry.diffuse_horizontal.is_some()),
    ]);
    (!keys.is_empty()).then_some(Warning::UnusedSky { keys })
}

/// The directional lights of the file: the sun comes from elsewhere.
fn of_lights(scene: &Scene) -> Option<Warning> {
    let is_sun = |light: &&PunctualLight| light.kind == PunctualKind::Directional;
    let lights = scene.lights.iter().filter(is_sun).map(|light| UnusedLight {
        name: light.name.clone(),
        kind: "directional",
        intensity: light.color.max_element(),
        unit: "lx",
    });
    let lights: Vec<UnusedLight> = lights.collect();
    (!lights.is_empty()).then_some(Warning::UnusedLights { lights })
}
