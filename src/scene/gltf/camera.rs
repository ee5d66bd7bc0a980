//! Cameras of glTF.

use super::container::Gltf;
use super::document::{CameraEntry, Node};
use super::notes::{Notes, number};
use crate::error::Result;
use crate::scene::text::shortened;
use crate::scene::{Camera, NamedCamera, Projection};
use crate::warning::Warning;
use glam::{DAffine3, DVec2, DVec3};
use std::collections::BTreeMap;

/// The cameras of a scene, in the file's order.
#[derive(Default)]
pub(super) struct Cameras(pub Vec<NamedCamera>);

impl Cameras {
    /// Adds a node's camera. One that sees nothing is named and left out.
    pub fn add(
        &mut self,
        gltf: &Gltf,
        index: usize,
        node: &Node,
        to_scene: DAffine3,
        place: &str,
        notes: &mut Notes,
    ) -> Result<()> {
        let entry = gltf.get(&gltf.json.cameras, "cameras", index, place)?;
        let name = node.name.as_ref().or(entry.name.as_ref());
        match camera(entry, to_scene) {
            Ok(camera) => self.0.push(NamedCamera {
                name: name
                    .map(|name| shortened(name))
                    .unwrap_or_else(|| format!("camera {}", self.0.len())),
                camera,
            }),
            Err(problem) => notes.mend(
                gltf.at(format_args!("cameras[{index}]: {problem}")),
                "left out",
            ),
        }
        Ok(())
    }

    /// Names that several cameras have, of which a name chooses the first.
    pub fn name_doubles(&self, gltf: &Gltf, notes: &mut Notes) {
        let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
        for camera in &self.0 {
            *counts.entry(&camera.name).or_default() += 1;
        }
        for (name, count) in counts.into_iter().filter(|&(_, count)| count > 1) {
            notes.warn(Warning::SameCameraName {
                file: gltf.path.display().to_string(),
                name: name.to_owned(),
                count,
            });
        }
    }
}

fn camera(entry: &CameraEntry, to_scene: DAffine3) -> Result<Camera, String> {
    let projection = match (&entry.perspective, &entry.orthographic) {
        (Some(p), _) if p.yfov > 0.0 && p.yfov < std::f64::consts::PI => {
            Projection::Perspective { fov_y: p.yfov }
        }
        (Some(p), _) => return Err(format!("yfov is {}, outside 0 to pi", number(p.yfov))),
        (None, Some(o)) if o.ymag.abs() > 0.0 => Projection::Orthographic {
            height: 2.0 * o.ymag.abs(),
        },
        (None, Some(_)) => return Err("ymag is 0".into()),
        (None, None) => return Err("it is neither perspective nor orthographic".into()),
    };
    let forward = to_scene.transform_vector3(DVec3::NEG_Z).normalize_or_zero();
    let up = to_scene.transform_vector3(DVec3::Y).normalize_or_zero();
    if forward == DVec3::ZERO || up.cross(forward) == DVec3::ZERO || !to_scene.is_finite() {
        return Err("its node is squashed flat".into());
    }
    Ok(Camera {
        eye: to_scene.translation,
        forward,
        up,
        projection,
        shift: DVec2::ZERO,
    })
}
