//! Lamps of glTF: KHR_lights_punctual.

use super::container::Gltf;
use super::document::{Light, LightRef, Lights, Node};
use super::material::extension;
use super::notes::{Notes, shown};
use crate::error::Result;
use crate::scene::text::shortened;
use crate::scene::{PunctualKind, PunctualLight};
use glam::{DAffine3, DVec3};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

pub(super) const NAME: &str = "KHR_lights_punctual";

/// The lamps that a file describes, whether a node has them or not.
pub(super) fn read(gltf: &Gltf) -> Result<Vec<Light>> {
    let lights: Option<Lights> = extension(gltf, &gltf.json.extensions, NAME, "file")?;
    Ok(lights.unwrap_or_default().lights)
}

/// The lamp of a node. One that gives no valid light is named and left out.
pub(super) fn of_node(
    gltf: &Gltf,
    lights: &[Light],
    node: &Node,
    to_scene: DAffine3,
    place: &str,
    notes: &mut Notes,
) -> Result<Option<PunctualLight>> {
    let Some(LightRef { light: index }) = extension(gltf, &node.extensions, NAME, place)? else {
        return Ok(None);
    };
    let entry = gltf.get(lights, "lights", index, place)?;
    if entry.range.is_some() {
        notes.leave_out("range of a lamp");
    }
    let name = node.name.as_ref().or(entry.name.as_ref());
    let name = name
        .map(|name| shortened(name))
        .unwrap_or_else(|| format!("light {index}"));
    let lamp = lamp(entry, name, to_scene);
    Ok(lamp
        .map_err(|problem| {
            notes.mend(
                gltf.at(format_args!("lights[{index}]: {problem}")),
                "left out",
            )
        })
        .ok())
}

fn lamp(entry: &Light, name: String, to_scene: DAffine3) -> Result<PunctualLight, String> {
    let kind = match entry.r#type.as_str() {
        "directional" => PunctualKind::Directional,
        "point" => PunctualKind::Point,
        "spot" => {
            // A right angle in f32 is a little more than one.
            let outer = entry.spot.outer_cone_angle.unwrap_or(FRAC_PI_4);
            let inner = entry.spot.inner_cone_angle.unwrap_or(0.0);
            let is_cone = 0.0 <= inner && inner <= outer && outer <= 1e-6 + FRAC_PI_2;
            if !is_cone {
                return Err(format!(
                    "its cone from {inner} to {outer} rad is not one of 0 to pi / 2"
                ));
            }
            PunctualKind::Spot {
                inner: inner.min(FRAC_PI_2),
                outer: outer.min(FRAC_PI_2),
            }
        }
        other => return Err(format!("there is no type `{}`", shown(other))),
    };
    let color = DVec3::from(entry.color.unwrap_or([1.0; 3])) * entry.intensity.unwrap_or(1.0);
    let direction = to_scene.transform_vector3(DVec3::NEG_Z).normalize_or_zero();
    if !(color.min_element() >= 0.0 && color.is_finite()) || direction == DVec3::ZERO {
        return Err("its colour, intensity or direction is not valid".into());
    }
    Ok(PunctualLight {
        name,
        color,
        position: to_scene.translation,
        direction,
        kind,
    })
}
